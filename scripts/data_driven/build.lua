-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Builds the library of three rubbers that the experiments look materials up in, and nothing else.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the library of three rubbers for the experiments of the paper data-driven",
  about = "DIR gets three.bwm, result.json and manifest.json; a build that was interrupted carries on.\n\n"
    .. "Exit status: 0 built; 2 the input was refused; 130 interrupted, what is done is kept.",
  options = {script.option.needed_out,
    scenes.option.levels(1), scenes.option.directions(500),
    {name = "magnitudes", value = "N", type = "integer", default = 5, min = 1,
      what = "magnitudes of deformation in each direction"},
  },
}

local results, message = script.results(opts.out, opts, {script = "scripts/data_driven/build.lua"})
if not results then script.refuse(message) end
local path, start = results:path "three.bwm", os.clock()
local made
made, message = bw.metamaterial.build(scenes.materials(), {levels = opts.levels, directions = opts.directions,
  magnitudes = opts.magnitudes, checkpoint = path .. ".checkpoint"})
if not made then script.fail(script.REFUSED, message) end
assert(made:write(path))
os.remove(path .. ".checkpoint")
local blocks = bw.json.list {}
for level, errors in ipairs(made.errors) do blocks[level] = #errors end
assert(results:write {levels = made.levels, blocks = blocks, seconds_clock = made.seconds,
  seconds_processor = os.clock() - start, sha256 = require "barwright.core".sha256(path)})
print(("built in %.0f s"):format(made.seconds))
