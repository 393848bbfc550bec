-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Responses to a response spectrum: what print says, files and pictures. docs/theory/dynamics.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local nodal_files = require "barwright.nodal_files"
local options = require "barwright.options"
local shown = require "barwright.shown"

local raise = core.raise

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

-- What a response is made of: the combination of its modes, and those with a hundredth of the mass or more.
local function parts_of(self)
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
  return lines
end

function class.tostring(self)
  local lines = parts_of(self)
  lines[#lines + 1] = ("  largest displacement component %s, von Mises stress %s, force on the supports %s; "
    .. "loads of the part are not in it; errors of the combination and of the mesh unknown"):format(
    core.quantity(self.displacement:max(), "m"), core.quantity(self.von_mises:max(), "Pa"),
    shown.vector(self.base_force, "N"))
  return table.concat(lines, "\n")
end

-- ---- several directions --------------------------------------------------------------------------

local combined = {}
combined.__index = combined

-- Of two and of three directions.
local rules = {srss = {[2] = "sqrt(a^2 + b^2)", [3] = "sqrt(a^2 + b^2 + c^2)"},
  ["100-40-40"] = {[2] = "max(a + 0.4 * b, b + 0.4 * a)",
    [3] = "max(max(a + 0.4 * (b + c), b + 0.4 * (a + c)), c + 0.4 * (a + b))"}}
local rule_words = {srss = "square root of the sum of squares (SRSS)",
  ["100-40-40"] = "100-40-40 rule: 100 % of one and 40 % of each other"}

-- Of two vectors of length 1.
local function at_right_angles(p, q)
  return math.abs(p[1] * q[1] + p[2] * q[2] + p[3] * q[3]) <= 1e-6
end

-- Of one model, along directions at right angles.
local function check_others(responses)
  if #responses < 2 or #responses > 3 then
    raise(("combine: 1 or 2 other responses expected, got %d"):format(#responses - 1))
  end
  for k = 2, #responses do
    if core.class_name(responses[k]) ~= "response_spectrum" then
      raise(("combine: argument 'others': a response spectrum expected at %d, got %s"):format(k - 1,
        core.got(responses[k])))
    end
    if not core.spectra_of_one_model(responses[1], responses[k]) then
      raise(("combine: response %d is of another model, or the model changed in between: compute the responses of "
        .. "one model; where its loads alone changed, give one of them the modes of the other"):format(k))
    end
    for j = 1, k - 1 do
      if not at_right_angles(responses[j].direction, responses[k].direction) then
        raise(("combine: responses %d and %d are not along directions at right angles"):format(j, k))
      end
    end
  end
end

--- The largest response to directions that shake at once; see lua/stubs/response_spectrum.lua.
function spectrum:combine(others, given)
  local opts = options.read("combine", given or {},
    {rule = {type = "string", default = "srss", one_of = {"srss", "100-40-40"}}})
  local responses = {self, table.unpack(others)}
  check_others(responses)
  local formula = rules[opts.rule][#responses]
  local function combine(of)
    local parts = {}
    local vector
    for k, r in ipairs(responses) do
      local value = of(r)
      vector = type(value) == "table"
      parts[("abc"):sub(k, k)] = vector and core.array.new(value) or value
    end
    local value = core.array.map(formula, parts)
    return vector and value:totable() or value
  end
  local out = {rule = opts.rule, responses = responses, mesh = self.mesh,
    displacement = combine(function(r) return r.displacement end),
    von_mises = combine(function(r) return r.von_mises end),
    base_force = combine(function(r) return r.base_force end), couplings = {}}
  for p = 1, #self.couplings do
    out.couplings[p] = {displacement = combine(function(r) return r.couplings[p].displacement end),
      rotation = combine(function(r) return r.couplings[p].rotation end)}
  end
  return setmetatable(out, combined)
end

combined.write, combined.picture = spectrum.write, spectrum.picture

function combined:__tostring()
  local lines = {("response spectra of %d directions at once, by the %s"):format(#self.responses,
    rule_words[self.rule])}
  for _, r in ipairs(self.responses) do
    local x, y, z = table.unpack(r.direction)
    lines[#lines + 1] = ("  along (%s, %s, %s): largest von Mises stress %s"):format(shown.number(x),
      shown.number(y), shown.number(z), core.quantity(r.von_mises:max(), "Pa"))
  end
  lines[#lines + 1] = ("  largest displacement component %s, von Mises stress %s, force on the supports %s; "
    .. "errors of the combination and of the mesh unknown"):format(core.quantity(self.displacement:max(), "m"),
    core.quantity(self.von_mises:max(), "Pa"), shown.vector(self.base_force, "N"))
  return table.concat(lines, "\n")
end

local files = {write = "path: string, options?: options", picture = "path: string, options?: options"}
arguments.methods("combined_spectrum", combined, combined, files)
arguments.methods("response_spectrum", spectrum, nil, {write = files.write, picture = files.picture,
  combine = "others: table, options?: options"})

return {parts = parts_of, rule_words = rule_words, at_right_angles = at_right_angles}
