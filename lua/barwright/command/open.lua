-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright open FILE: the workbench in the browser.
local browser = require "barwright.command.browser"
local controller = require "barwright.workbench.controller"
local live = require "barwright.live"
local model = require "barwright.command.model"
local read_file = require "barwright.read_file"
local workbench = require "barwright.workbench"

-- The longest file that the page may send.
local UPLOAD_BYTES = 256 << 20

-- A saved workbench is run, and goes on from there.
local function saved(path)
  if model.ending(path) ~= "lua" then return nil end
  local text = read_file(path)
  if not (text and text:find("bw.workbench.open", 1, true)) then return nil end
  local made, message, details = model.try(dofile, path)
  if getmetatable(made) == workbench.class then return made end
  return false, message or path .. ": the script returns no workbench", details
end

local function run(opts, out)
  local path, opened = opts.model, nil
  local bench, message, details
  if path then bench, message, details = saved(path) end
  if bench == false then return out:fail(message, details) end
  if path and not bench then
    local file, why = io.open(path, "rb")
    if not file then return out:fail(why, {status = "io"}) end
    local _, reason, number = file:read(0) -- a folder can be opened, and not read
    file:close()
    if number then return out:fail(("%s: %s"):format(path, reason), {status = "io"}) end
  end
  local function begin(server)
    local self = controller.new(server, {save = opts.save})
    if bench then self:show(bench) return self end
    if not path then return self end -- a file will be dropped
    local ok, text, about = self:open(path, opts.unit)
    if not ok then return nil, text, about end
    return self
  end
  local function ready(address)
    print(address) -- also under --quiet: nobody could open it else
    out:say "Open it in a browser of this machine. Ctrl-C ends."
    io.stdout:flush()
    if not opts.no_open then opened = browser.open(address) end
  end
  local ok
  ok, message, details = live.serve(opts.port, "workbench", begin, ready, UPLOAD_BYTES)
  if opened then opened:close() end
  if not ok then return out:fail(message, details) end
end

return {
  summary = "the workbench in the browser: pick faces, load them, ask whether it holds",
  about = "Opens a part in a page: its surface is repaired, faces are picked, constrained and loaded, and the "
    .. "page answers whether it holds, with its interval. Faces are pushed, holes resized, weak places thickened. "
    .. "A saved script goes on where it ended. Only this machine can reach the page, and only with the "
    .. "address that is printed.",
  server = true,
  arguments = {{name = "model", type = "file", optional = true,
    what = "surface (STL OBJ OFF PLY 3MF glTF STEP IGES), mesh, drawing (SVG DXF), a script that returns a "
      .. "surface, or a saved workbench; without one the page waits for a file to be dropped"}},
  options = {
    model.unit_option,
    {name = "port", value = "N", type = "integer", default = 0, min = 0, max = 65535,
      what = "the port to listen at; 0: any that is free"},
    {name = "save", value = "FILE.lua", type = "file", what = "where the page's script is saved; else "
      .. "MODEL.workbench.lua beside the file"},
    {name = "no-open", type = "flag", what = "print the address only, do not open a browser"},
  },
  examples = {"barwright open bracket.stl", "barwright open",
    {"barwright open bracket.workbench.lua", "goes on from a saved script"}},
  run = run,
}
