-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Input files with their SHA-256. A .pvtu file names pieces, which are inputs as well.
local core = require "barwright.core"
local read_file = require "barwright.read_file"

local input_files = {}

local letters = {amp = "&", lt = "<", gt = ">", quot = '"', apos = "'"}

-- Appends {file, sha256}. True, or nil, message, details.
local function append(list, path)
  local digest, message, details = core.sha256(path)
  if not digest then return nil, message, details end
  list[#list + 1] = {file = path, sha256 = digest}
  return true
end

-- Likewise of the pieces that a .pvtu file names.
local function append_pieces(list, path)
  local text, why = read_file(path)
  if not text then return nil, why, {status = "io", file = path} end
  for _, source in text:gmatch "<Piece%s[^>]-Source%s*=%s*([\"'])(.-)%1" do
    local piece = source:gsub("&(%a+);", letters)
    if piece:sub(1, 1) ~= "/" then piece = (path:match "^(.*/)" or "") .. piece end
    local ok, message, details = append(list, piece)
    if not ok then return nil, message, details end
  end
  return true
end

--- {file, sha256} of each file, and of the pieces that .pvtu files name. Or nil, message, details.
function input_files.digests(paths)
  local list = {}
  for _, path in ipairs(paths) do
    local ok, message, details = append(list, path)
    if ok and path:lower():find "%.pvtu$" then ok, message, details = append_pieces(list, path) end
    if not ok then return nil, message, details end
  end
  return list
end

return input_files
