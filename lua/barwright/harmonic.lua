-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Harmonic responses: curves and envelopes over the frequency, files, pictures and animations of a frequency.
-- docs/theory/dynamics.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local deflection = require "barwright.deflection"
local fine_boundary = require "barwright.fine_boundary"
local members = require "barwright.members"
local nodal_files = require "barwright.nodal_files"
local options = require "barwright.options"
local plot = require "barwright.plot"
local shown = require "barwright.shown"

local raise = core.raise
local map = core.array.map

local harmonic = core.classes.harmonic.methods

-- ---- curves --------------------------------------------------------------------------------------

local curve = {}
curve.__index = members("curve", curve, {})
curve.__name = "barwright.harmonic_curve"

local axes = {"x", "y", "z"}

local function nearest_node(mesh, at)
  return map("(a.x - x)^2 + (a.y - y)^2 + (a.z - z)^2", {a = mesh.nodes, x = at[1], y = at[2], z = at[3]}):argmin()
end

--- Columns `first` to `first` + 2 of a response, and `width` behind them, are its real and imaginary parts.
local function make(response, first, width, made)
  local real = response:columns(first, first + 2)
  local imaginary = response:columns(first + width, first + width + 2)
  made.real, made.imaginary = real, imaginary
  made.amplitude = map("sqrt(a*a + b*b)", {a = real, b = imaginary})
  made.phase = map("atan2(b, a) * 57.29577951308232", {a = real, b = imaginary})
  return setmetatable(made, curve)
end

-- Whether the response has no limit at a natural frequency among or between the frequencies.
local function unlimited(self, frequencies)
  local low, high = frequencies:min(), frequencies:max()
  for _, f in ipairs(self.damped and {} or self.modes.frequencies:totable()) do
    if low <= f and f <= high then return true end
  end
  return false
end

local function of_coupling(self, opts)
  local response, at, details = self:at_coupling(opts.coupling, opts.frequencies)
  if not response then return nil, at, details end
  local function part(first, made)
    made.coupling, made.at, made.frequencies = opts.coupling, at, opts.frequencies
    made.unlimited = unlimited(self, opts.frequencies)
    return make(response, first, 6, made)
  end
  return part(1, {unit = "m", rotation = part(4, {unit = "rad"})})
end

--- The response of the node nearest to a point, or of a remote point, over frequencies:
--- {at = {x, y, z} or coupling =, frequencies =}.
function harmonic:curve(given)
  local opts = options.read("curve", given, {
    at = {type = "any"},
    coupling = {type = "integer", min = 1},
    frequencies = {type = "any"},
  })
  if (opts.at == nil) == (opts.coupling == nil) then
    raise("curve: either 'at', a point {x, y, z}, or 'coupling', a number, expected")
  end
  opts.frequencies = opts.frequencies and core.array.new(opts.frequencies) or self.frequencies
  if opts.coupling then return of_coupling(self, opts) end
  if type(opts.at) ~= "table" or #opts.at ~= 3 then
    raise(("curve: option 'at': a point {x, y, z} expected, got %s"):format(core.got(opts.at)))
  end
  for i = 1, 3 do
    if type(opts.at[i]) ~= "number" then
      raise(("curve: option 'at': a point {x, y, z} expected, got %s at %d"):format(core.got(opts.at[i]), i))
    end
  end
  local node = nearest_node(self.mesh, opts.at)
  local response, message, details = self:at_node(node, opts.frequencies)
  if not response then return nil, message, details end
  return make(response, 1, 3, {node = node, at = self.mesh.nodes:rows(node, node):totable()[1], unit = "m",
    frequencies = opts.frequencies, unlimited = unlimited(self, opts.frequencies)})
end

local no_limit = "nothing damps the response, which has no limit at a natural frequency"

local function peak(self, i)
  local column = self.amplitude:column(i)
  local at = column:argmax()
  return self.frequencies[at], column[at]
end

--- The largest amplitude along an axis: its frequency (Hz) and amplitude (m, rad).
function curve:peak(axis)
  for i, name in ipairs(axes) do
    if name == axis then
      if self.unlimited then core.warn(no_limit .. ": the peak is that of the curve's frequencies alone") end
      return peak(self, i)
    end
  end
  raise(("peak: \"x\", \"y\" or \"z\" expected, got %s"):format(core.got(axis)))
end

--- The curve as CSV: frequency, then amplitude and phase along x, y and z.
function curve:write(path)
  local head = "frequency_hz,amplitude_x_m,amplitude_y_m,amplitude_z_m,phase_x_deg,phase_y_deg,phase_z_deg"
  local lines = {(head:gsub("_m,", "_" .. self.unit .. ","))}
  local amplitude, phase = self.amplitude:totable(), self.phase:totable()
  for i, f in ipairs(self.frequencies:totable()) do
    local a, p = amplitude[i], phase[i]
    lines[i + 1] = ("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g"):format(f, a[1], a[2], a[3], p[1], p[2], p[3])
  end
  return core.write_file(path, table.concat(lines, "\n") .. "\n")
end

--- A plot of the amplitudes, logarithmic upwards.
function curve:figure()
  local series = {}
  for i, name in ipairs(axes) do
    local values = self.amplitude:column(i)
    if values:max() > 0 then series[#series + 1] = {name = name, x = self.frequencies, y = values} end
  end
  return plot.lines {series = series, x = {label = "frequency", unit = "Hz", prefix = false},
    y = {label = "amplitude", unit = self.unit, scale = "log"}, title = ("%s at (%g, %g, %g) m"):format(
    self.unit == "m" and "displacement" or "rotation", self.at[1], self.at[2], self.at[3])}
end

local function frequencies(count)
  return ("%d frequenc%s"):format(count, count == 1 and "y" or "ies")
end

function curve:__tostring()
  local parts = {}
  for i, name in ipairs(axes) do
    local f, a = peak(self, i)
    parts[i] = ("%s %s at %s Hz"):format(name, core.quantity(a, self.unit), shown.number(f))
  end
  local node, coupling = rawget(self, "node"), rawget(self, "coupling")
  return ("%s of %s over %s, largest: %s%s; error of the mesh unknown"):format(
    self.unit == "m" and "displacement" or "rotation",
    node and "node " .. node or "the remote point of coupling " .. coupling,
    frequencies(#self.frequencies), table.concat(parts, ", "), self.unlimited and "; " .. no_limit or "")
end

arguments.methods("harmonic_curve", curve, curve, {peak = "axis: string", write = "path: string", figure = ""})

-- ---- the largest over frequencies -----------------------------------------------------------------

local envelope = {}
envelope.__index = members("envelope", envelope, {})
envelope.__name = "barwright.harmonic_envelope"

local largest_of = harmonic.envelope

--- The largest displacement and von Mises stress at each node, over frequencies and phases: {frequencies =}.
function harmonic:envelope(given)
  local opts = options.read("envelope", given, {frequencies = {type = "any"}})
  local made = {mesh = self.mesh, largest = {},
    frequencies = opts.frequencies and core.array.new(opts.frequencies) or self.frequencies}
  for _, name in ipairs {"displacement", "von_mises"} do
    local values, at, peaks, places = largest_of(self, name == "von_mises", made.frequencies)
    if not values then return nil, at, peaks end
    local i = peaks:argmax()
    made[name], made[name .. "_frequency"] = values, at
    made[name .. "_peaks"], made[name .. "_nodes"] = peaks, places
    local node = places[i]
    made.largest[name] = {value = peaks[i], frequency = made.frequencies[i], node = node,
      at = self.mesh.nodes:rows(node, node):totable()[1]}
  end
  return setmetatable(made, envelope)
end

--- The largest values and their frequencies as .vtu (or what the ending says).
function envelope:write(path, given)
  local values = {}
  for _, name in ipairs {"displacement", "von_mises"} do
    values["largest_" .. name], values[name .. "_frequency"] = self[name], self[name .. "_frequency"]
  end
  return nodal_files.write(self.mesh, values, path, given)
end

--- The body coloured by the largest von Mises stress; options of bw.picture.
function envelope:picture(path, given)
  return nodal_files.picture(self.mesh, self.von_mises, "largest von Mises stress over frequencies", path, given)
end

--- A plot of the largest von Mises stress of the body over the frequency, logarithmic upwards.
function envelope:figure()
  return plot.lines {series = {{x = self.frequencies, y = self.von_mises_peaks}},
    x = {label = "frequency", unit = "Hz", prefix = false},
    y = {label = "largest amplitude of von Mises stress", unit = "Pa", scale = "log"}}
end

function envelope:__tostring()
  local u, s = self.largest.displacement, self.largest.von_mises
  return ("envelope over %s: largest displacement %s at %s Hz, node %d; largest von Mises stress %s "
    .. "at %s Hz, node %d; error of the mesh unknown"):format(frequencies(#self.frequencies),
    core.quantity(u.value, "m"), shown.number(u.frequency), u.node,
    core.quantity(s.value, "Pa"), shown.number(s.frequency), s.node)
end

arguments.methods("harmonic_envelope", envelope, envelope, {write = "path: string, options?: options",
  picture = "path: string, options?: options", figure = ""})

-- ---- one frequency -------------------------------------------------------------------------------

--- Both parts of the displacement and the stress, and the amplitude of von Mises stress, as .vtu.
function harmonic:write(path, frequency, given)
  local values, details = {}
  values.displacement_real, values.displacement_imaginary, details = self:displacement(frequency)
  if not values.displacement_real then return nil, values.displacement_imaginary, details end
  values.stress_real, values.stress_imaginary = self:stress(frequency)
  values.von_mises = self:von_mises(frequency)
  return nodal_files.write(self.mesh, values, path, given)
end

-- Pictures of phases, all with the same colours and deformation.
local function draw(self, frequency, paths, phases, given)
  local opts = options.copied(given)
  local real, imaginary, details = self:displacement(frequency)
  if not real then return nil, imaginary, details end
  local surface, nodes, why = fine_boundary(self.mesh)
  if not surface then return nil, nodes, why end
  real, imaginary = real:gather(nodes), imaginary:gather(nodes)
  if not opts.values then
    opts.values = self:von_mises(frequency):gather(nodes)
    opts.unit, opts.scale = opts.unit or "amplitude of von Mises stress, MPa", opts.scale or 1e-6
  end
  opts.title = opts.title or ("operating deflection shape at %s Hz"):format(shown.number(frequency))
  local first = deflection.largest_phase(real, imaginary)
  if not opts.deformation then
    local moved = map("norm(a)", {a = deflection.at_phase(real, imaginary, first)}):max()
    local size = self.mesh.box.size
    opts.deformation = moved > 0 and 0.1 * math.max(size[1], size[2], size[3]) / moved or 1
  end
  for i, path in ipairs(paths) do
    opts.displacement = deflection.at_phase(real, imaginary, first + phases[i])
    local ok, message, more = core.picture(surface, path, opts)
    if not ok then return nil, message, more end
  end
  return true
end

--- The operating deflection shape where it is largest, coloured by the amplitude of von Mises stress.
function harmonic:picture(frequency, path, given)
  return draw(self, frequency, {path}, {0}, given)
end

--- A period of the operating deflection shape as an animated PNG: {pictures =, seconds =}, options of bw.picture.
function harmonic:animate(frequency, path, given)
  local opts = options.copied(given)
  local own = options.read("animate", {pictures = opts.pictures, seconds = opts.seconds}, {
    pictures = {type = "integer", default = 24, min = 4, max = 1000},
    seconds = {type = "number", default = 1.2, above = 0},
  })
  opts.pictures, opts.seconds = nil, nil
  local folder, message, details = core.temporary_folder()
  if not folder then return nil, message, details end
  local paths, phases = {}, {}
  for i = 1, own.pictures do
    paths[i] = ("%s/%04d.png"):format(folder.path, i)
    phases[i] = 2 * math.pi * (i - 1) / own.pictures
  end
  local ok
  ok, message, details = draw(self, frequency, paths, phases, opts)
  if ok then ok, message, details = core.animation(path, paths, {seconds = own.seconds / own.pictures}) end
  folder:close()
  return ok, message, details
end

arguments.methods("harmonic", harmonic, nil, {curve = "options: options",
  envelope = "options?: options",
  write = "path: string, frequency: number, options?: options",
  picture = "frequency: number, path: string, options?: options",
  animate = "frequency: number, path: string, options?: options"})
