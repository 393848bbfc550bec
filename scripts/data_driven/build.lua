-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Builds the library of three rubbers that the experiments look materials up in, and nothing else.
--   build/barwright scripts/data_driven/build.lua --out DIR [--levels 1|2] [--directions 500]
--       [--magnitudes 5]
-- DIR gets three.bwm, result.json and manifest.json; a build that was interrupted carries on.
-- Exit status 0: built. 2: refused. 130: interrupted; what is done is kept.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"

local BUILT, REFUSED, INTERRUPTED = 0, 2, 130

local function stop(status, message)
  io.stdout:flush()
  io.stderr:write("build: ", (message:gsub("%s*\n%s*", " ")), "\n")
  os.exit(status, true)
end

local opts, i = {levels = 1, directions = 500, magnitudes = 5}, 1
while arg[i] do
  local name, value = arg[i]:match "^%-%-(%l+)$", arg[i + 1]
  if name == "out" and value then
    opts.out = value
  elseif name and opts[name] and math.tointeger(tonumber(value)) then
    opts[name] = math.tointeger(tonumber(value))
  else
    stop(REFUSED, ("'%s %s' is not known (--out DIR --levels N --directions N --magnitudes N)"):format(arg[i],
      tostring(value)))
  end
  i = i + 2
end
if not opts.out then stop(REFUSED, "--out DIR expected") end

local results, message = bw.results.open(opts.out, {script = "scripts/data_driven/build.lua", options = opts})
if not results then stop(REFUSED, message) end
local path, start = results:path "three.bwm", os.clock()
local made
made, message = bw.metamaterial.build(scenes.materials(), {levels = opts.levels, directions = opts.directions,
  magnitudes = opts.magnitudes, checkpoint = path .. ".checkpoint"})
if not made then stop(bw.interrupted() and INTERRUPTED or REFUSED, message) end
assert(made:write(path))
os.remove(path .. ".checkpoint")
local blocks = bw.json.list {}
for level, errors in ipairs(made.errors) do blocks[level] = #errors end
assert(results:write {levels = made.levels, blocks = blocks, seconds_clock = made.seconds,
  seconds_processor = os.clock() - start, sha256 = require "barwright.core".sha256(path)})
print(("built in %.0f s"):format(made.seconds))
os.exit(BUILT, true)
