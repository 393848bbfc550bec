-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Responses to a response spectrum: what print says, files and pictures. docs/theory/dynamics.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local nodal_files = require "barwright.nodal_files"
local shown = require "barwright.shown"

local class = core.classes.response_spectrum
local spectrum = class.methods

--- Largest displacements and von Mises stress, as .vtu (or what the ending says).
function spectrum:write(path, given)
  return nodal_files.write(self.mesh, {largest_displacement = self.displacement,
    largest_von_mises = self.von_mises}, path, given)
end

--- The body coloured by the largest von Mises stress; options of bw.picture.
function spectrum:picture(path, given)
  return nodal_files.picture(self.mesh, self.von_mises, "largest von Mises stress", path, given)
end

local combinations = {cqc = "complete quadratic combination (CQC)",
  srss = "square root of the sum of squares (SRSS)", absolute = "sum of magnitudes"}

function class.tostring(self)
  local masses, modes = self.effective_masses:totable(), self.modes
  local x, y, z = table.unpack(self.direction)
  local percent = function(mass) return shown.percent(mass / self.mass) end
  local lines = {("response spectrum along (%s, %s, %s), by the %s of %d modes (%s); %s"):format(
    shown.number(x), shown.number(y), shown.number(z), combinations[self.combination], #masses,
    modes.counted and "counted: none is missing" or "not counted",
    self.base_acceleration > 0 and ("the mass that they leave out, %s of %s, has the base's %s"):format(
      percent(self.missing_mass), core.quantity(self.mass, "kg"), core.quantity(self.base_acceleration, "m/s2"))
    or ("without the mass that they leave out, %s of %s"):format(percent(self.missing_mass),
      core.quantity(self.mass, "kg")))}
  for k, mass in ipairs(masses) do
    if mass >= 0.01 * self.mass then
      lines[#lines + 1] = ("  mode %d, %s Hz: participation %s kg^0.5, effective mass %s, spectrum %s"):format(k,
        shown.number(modes.frequencies[k]), shown.number(self.participation[k]), percent(mass),
        core.quantity(self.accelerations[k], "m/s2"))
    end
  end
  lines[#lines + 1] = ("  largest displacement component %s, von Mises stress %s, force on the supports %s; "
    .. "loads of the part are not in it; errors of the combination and of the mesh unknown"):format(
    core.quantity(self.displacement:max(), "m"), core.quantity(self.von_mises:max(), "Pa"),
    shown.vector(self.base_force, "N"))
  return table.concat(lines, "\n")
end

arguments.methods("response_spectrum", spectrum, nil, {write = "path: string, options?: options",
  picture = "path: string, options?: options"})
