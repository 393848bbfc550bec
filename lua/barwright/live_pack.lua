-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Binary messages of the live views: the length of a JSON text (u32), the text, padded to a multiple of
-- four, then the blocks that it lists, little-endian.
local core = require "barwright.core"
local json = require "barwright.json"

local live_pack = {}


--- A message of a header and blocks {{name, "f4" | "u4", bytes}, ...}.
function live_pack.pack(header, blocks)
  header.blocks = json.list {}
  local bytes = {}
  for i, block in ipairs(blocks) do
    header.blocks[i] = {name = block[1], type = block[2], count = #block[3] // 4}
    bytes[i] = block[3]
  end
  local text = json.encode(header)
  text = text .. (" "):rep(-#text % 4)
  return ("<I4"):pack(#text) .. text .. table.concat(bytes)
end

--- Colours of the map, for a page: 33 knots of red, green, blue from 0 to 255.
function live_pack.colours()
  local knots = json.list {}
  for i = 0, 32 do knots[i + 1] = {core.colour(i / 32)} end
  return knots
end

--- The header of such a message, and its blocks by name as text: for scripts that talk to a controller.
function live_pack.read(bytes)
  local length = ("<I4"):unpack(bytes)
  local header = assert(json.decode(bytes:sub(5, 4 + length)))
  local at, blocks = 5 + length, {}
  for _, block in ipairs(header.blocks) do
    blocks[block.name] = bytes:sub(at, at + 4 * block.count - 1)
    at = at + 4 * block.count
  end
  return header, blocks
end

return live_pack
