-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The library that experiments look up materials in: read, or built once and kept; and the paper's
-- numbers.
local bw = require "barwright"
local files = require "barwright.scenario.files"

local library = {}

--- The library of `opts.library`, or of `opts.out`/three.bwm, built there when it is missing.
function library.get(opts, materials, levels)
  if opts.library then return bw.metamaterial.read(opts.library) end
  local path = opts.out .. "/three.bwm"
  local checkpoint = path .. ".checkpoint"
  opts.library = path
  if files.kind(path) then
    local found = bw.metamaterial.read(path)
    if found and found.levels >= levels then
      os.remove(checkpoint) -- of a run that was killed when it had written the library
      return found
    end
  end
  local opened, message = bw.results.open(opts.out, {})
  if not opened then return nil, message end
  print(("building a library of three materials with %d level%s into %s"):format(levels,
    levels > 1 and "s" or "", path))
  local made, details
  made, message, details = bw.metamaterial.build(materials, {levels = levels,
    checkpoint = checkpoint})
  if not made then return nil, message, details end
  local written
  written, message, details = made:write(path)
  if not written then return nil, message, details end
  os.remove(checkpoint)
  print(("built in %.0f s"):format(made.seconds))
  return made
end

-- Table 1 of the paper: rel sp, s/iteration, iterations, error, by level.
local TABLE_1 = {
  pushing = {[0] = {1.0, 1.010, 5}, {11.5, 0.087, 5, 8.91e-4}, {31.4, 0.032, 5, 1.36e-2}},
  bending = {[0] = {1.0, 0.270, 28}, {12.6, 0.028, 22, 5.60e-2}, {22.7, 0.015, 22, 8.88e-2}},
  twisting = {[0] = {1.0, 0.300, 16}, {15.2, 0.031, 10, 1.56e-2}, {20.7, 0.019, 12, 3.28e-2}},
  buckling = {[0] = {1.0, 8.85, 32}, {50.1, 0.28, 20, 7.24e-3}, {331.8, 0.12, 7, 3.14e-2}},
  fibers = {[0] = {1.0, 193.85, 17}, {51.2, 4.95, 13, 2.94e-2}, {489.5, 0.96, 7, 4.26e-2}},
  bridge = {[0] = {1.0, 43.44, 14}, {8.4, 4.88, 15, 4.39e-3}},
  bridge_arch = {[0] = {1.0, 54.99, 3}, {8.1, 7.84, 3, 3.68e-4}},
  george = {[0] = {1.0, 52.19, 23}, {16.4, 3.49, 21, 2.86e-2}},
  george_bone = {[0] = {1.0, 41.35, 12}, {13.2, 2.70, 14, 2.99e-2}},
}

--- {[level] = {speed_up =, seconds_per_iteration =, iterations =, error =}} of the paper, or nil.
function library.paper(name)
  local of = TABLE_1[name]
  if not of then return nil end
  local out = {}
  for level = 0, #of do
    local r = of[level]
    out["level_" .. level] = {speed_up = r[1], seconds_per_iteration = r[2], iterations = r[3],
      error = r[4]}
  end
  return out
end

return library
