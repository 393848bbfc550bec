-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drops: files and pictures of what happened. docs/theory/drop.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local obstacle = require "barwright.obstacle"
local options = require "barwright.options"

local raise = core.raise

local drop = core.classes.drop.methods

-- The columns of the history.
local columns = {{"times", "time_s"}, {"forces", "force_N"}, {"motion_energy", "motion_energy_J"},
  {"vibration_energy", "vibration_energy_J"}, {"strain_energy", "strain_energy_J"},
  {"potential_energy", "potential_energy_J"}, {"damping_energy", "damping_energy_J"}}

local function sampled(self, what)
  if not self.peak then raise(what .. ": the drop has no stress: give samples above 0") end
end

--- Times, force, energies and the stress of the element where it peaks as the columns of a CSV file.
function drop:write_history(path)
  local heads, values, lines, stress_at = {}, {}, {}, {}
  for k, column in ipairs(columns) do heads[k], values[k] = column[2], self[column[1]] end
  local stresses = self.peak_stresses
  if stresses then
    heads[#heads + 1] = "peak_stress_Pa"
    for i, time in ipairs(self.sample_times:totable()) do stress_at[time] = ("%.9g"):format(stresses[i]) end
  end
  lines[1] = table.concat(heads, ",")
  for i = 1, #values[1] do
    local row = {}
    for k = 1, #columns do row[k] = ("%.9g"):format(values[k][i]) end
    if stresses then row[#row + 1] = stress_at[values[1][i]] or "" end
    lines[i + 1] = table.concat(row, ",")
  end
  return core.write_file(path, table.concat(lines, "\n") .. "\n")
end

--- The largest stress of each element over time and the deformation at the peak, as .vtu or other files.
function drop:write(path)
  sampled(self, "write")
  return self.mesh:write(path, {fields = {displacement = {self.displacement, on = "nodes"},
    max_principal = {self.max_principal, on = "elements"},
    utilisation = self.utilisation and {self.utilisation, on = "elements"}}})
end

--- The part coloured by the largest stress over time, and what it falls on as lines; options of bw.picture.
function drop:picture(path, given)
  sampled(self, "picture")
  local opts = options.copied(given)
  local surface, nodes, details = fine_boundary(self.mesh)
  if not surface then return nil, nodes, details end
  opts.values = self.mesh:to_nodes(self.max_principal, "max"):gather(nodes)
  opts.unit = opts.unit or "largest principal stress, MPa"
  opts.scale = opts.scale or 1e-6
  if not opts.lines and self.impacts[1] then
    local drawn = obstacle.drawn(self.onto, self.mesh, self.impacts[1].place)
    opts.lines, opts.line_name = drawn.lines, drawn.line_name
  end
  return core.picture(surface, path, opts)
end

arguments.methods("drop", drop, nil, {write = "path: string", write_history = "path: string",
  picture = "path: string, options?: options"})
