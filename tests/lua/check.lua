-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the specs share: where things are, small bodies, checks on failures.
local bw = require "barwright"

local check = {}

local function root()
  local here = debug.getinfo(1, "S").source:match "^@(.*)/tests/lua/check%.lua$"
  return here or "."
end
check.root = root()
check.program = check.root .. "/build/barwright"
check.first_wall = check.root .. "/build/tests/first_wall" -- the program, its sandbox without the second wall

--- A beam along x of steel: 1 m x 0.1 m x 0.1 m.
function check.beam(cells, order)
  return assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = cells or {10, 2, 2},
    order = order})
end

--- A bar of PLA along x, 0.1 m x 0.02 m x 0.01 m: its mesh, the model without supports, and with one end fixed.
function check.bar()
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {8, 4, 2}})
  return mesh, bw.model {mesh = mesh, material = bw.material.pla},
    bw.model {mesh = mesh, material = bw.material.pla}:fix(mesh.boundary:below(1, 0))
end

--- A mesh of boxes that touch or not, without common nodes: `list` has {min, max, cells} of each, `place` says
--- where a node comes to lie.
function check.boxes(order, list, place)
  local nodes, elements = {}, {}
  for _, box in ipairs(list) do
    local mesh = bw.mesh.box {min = box[1], max = box[2], cells = box[3], order = order}
    local before = #nodes
    for _, p in ipairs(mesh.nodes:totable()) do nodes[#nodes + 1] = place and place(p) or p end
    for _, row in ipairs(mesh.elements:totable()) do
      for k = 1, #row do row[k] = row[k] + before end
      elements[#elements + 1] = row
    end
  end
  return bw.mesh.new {nodes = nodes, elements = elements, order = order}
end

--- |value - expected| <= tolerance * |expected|
function check.near(expected, value, tolerance)
  local error_of = math.abs(value - expected)
  if error_of ~= error_of or error_of > tolerance * math.abs(expected) then
    error(("%.17g is not within %g of %.17g"):format(value, tolerance, expected), 2)
  end
end

--- The largest magnitude in an array.
function check.largest(a) return math.max(a:max(), -a:min()) end

--- Arrays differ by at most `tolerance` of the largest magnitude.
function check.same(expected, found, tolerance)
  local off, most = check.largest(expected - found), check.largest(expected)
  if off > tolerance * most or off ~= off then error(("they differ by %g of %g"):format(off, most), 2) end
end

--- Numbers from 0 up to below 1, the same ones for the same seed.
function check.random(seed)
  return function()
    seed = (seed * 1103515245 + 12345) % 2147483648
    return seed / 2147483648
  end
end

--- The call raises a message that holds the text.
function check.raises(text, f, ...)
  local ok, message = pcall(f, ...)
  if ok then error("nothing was raised", 2) end
  if not tostring(message):find(text, 1, true) then
    error(("raised \"%s\", which lacks \"%s\""):format(tostring(message), text), 2)
  end
end

--- Each call, by the text that its message holds, raises where the calling file stands.
function check.misuses(calls)
  local file = debug.getinfo(2, "S").source:match "[^/]+$" .. ":"
  for text, call in pairs(calls) do
    local ok, message = pcall(call)
    if ok then error("nothing was raised: " .. text, 2) end
    for _, part in ipairs {text, file} do
      if not tostring(message):find(part, 1, true) then
        error(("raised \"%s\", which lacks \"%s\""):format(tostring(message), part), 2)
      end
    end
  end
end

--- nil, a message that holds the text, details with the status.
function check.fails(status, text, value, message, details)
  if value ~= nil then error("it did not fail", 2) end
  if type(details) ~= "table" or details.status ~= status then
    error(("status %s instead of %s: %s"):format(details and details.status, status,
      tostring(message)), 2)
  end
  if not message:find(text, 1, true) then
    error(("message \"%s\" lacks \"%s\""):format(message, text), 2)
  end
end

--- Text of a file.
function check.read(path)
  local file = assert(io.open(path, "rb"))
  local text = file:read "a"
  file:close()
  return text
end

--- Writes a text; returns the path.
function check.write(path, text)
  local file = assert(io.open(path, "wb"))
  file:write(text)
  file:close()
  return path
end

--- A word of the shell.
check.quoted = require "barwright.scenario.files".quoted

--- A folder that is removed at the end of the process.
local folders = setmetatable({}, {__gc = function(self)
  for _, path in ipairs(self) do os.execute("rm -rf '" .. path .. "'") end
end})
function check.folder()
  local path = os.tmpname()
  os.remove(path)
  assert(os.execute("mkdir -p '" .. path .. "'"))
  folders[#folders + 1] = path
  return path
end

--- The path of a script with a text.
function check.script(text)
  return check.write(check.folder() .. "/script.lua", text)
end

--- Runs the program, or another one; returns exit status, standard output, standard error.
function check.run(arguments, input, program)
  local folder = check.folder()
  local _, _, status = os.execute(("BARWRIGHT_QUIET=1 '%s' %s >%s/out 2>%s/err <%s"):format(
    program or check.program, arguments, folder, folder, input or "/dev/null"))
  return status, check.read(folder .. "/out"), check.read(folder .. "/err")
end

--- Runs a command with --json; returns exit status, the object, standard error.
function check.answer(words)
  local status, out, err = check.run(words .. " --json")
  local object, why = bw.json.decode(out)
  if not object then error(tostring(why) .. "\n" .. out .. err, 2) end
  if status ~= object.exit_code then error("exit_code " .. tostring(object.exit_code), 2) end
  if err:find("traceback", 1, true) or object.error and select(2, err:gsub("\n", "")) ~= 1 then error(err, 2) end
  return status, object, err
end

return check
