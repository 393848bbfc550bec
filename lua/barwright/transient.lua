-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- part:transient {...}: a linear body in time, its loads and supports by histories; what is recorded on the way.
-- docs/theory/transient.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local history = require "barwright.history"
local options = require "barwright.options"
local transient_frames = require "barwright.transient_frames"
local writable = require "barwright.writable"

local raise = core.raise

local model, transient = core.classes.model.methods, core.classes.linear_transient.methods

-- By transient: {loads = {functions, of couplings behind those of loads}, names = {of these},
-- supports = function, rows = {of loads}, support_rows, by_modes = boolean,
-- base = step that looks at functions where steps adapt}
local histories_of = setmetatable({}, {__mode = "k"})

local function read_histories(opts, counts)
  local loads, rows, names, before = {}, {}, {}, 0
  for _, kind in ipairs {"load", "coupling"} do
    local option, count = kind .. "s", counts[kind]
    for index, given in pairs(opts[option]) do
      if math.type(index) ~= "integer" or index < 1 or index > count then
        raise(("transient: option '%s': there is no %s %s: the part has %d"):format(option, kind, tostring(index),
          count))
      end
      local name = ("transient: the history of %s %d"):format(kind, index)
      local f, more, details = history.read(name, given)
      if not f then return nil, more, details end
      loads[before + index], rows[before + index], names[before + index] = f, more, name
    end
    before = before + count
  end
  local supports, more, details = history.read("transient: the history of the supports", opts.supports)
  if not supports then return nil, more, details end
  return {loads = loads, names = names, supports = supports, rows = rows, support_rows = more}
end

local function load_value(histories, i, time)
  local f = histories.loads[i]
  return f and history.value(histories.names[i], f, time) or 1
end

local function support_value(histories, time)
  return history.value("transient: the history of the supports", histories.supports, time)
end

-- The mean of |f - the line between the ends| over a step to a time: what the step misses of a load.
local function load_missed(histories, i, time, h)
  local start, sum, before, last = time - h, 0, 0, time - h
  local from = load_value(histories, i, start)
  local to = load_value(histories, i, time)
  for _, at in ipairs(history.times(histories.rows[i], start, time, histories.base)) do
    local off = math.abs(load_value(histories, i, at) - from - (to - from) * (at - start) / h)
    sum, before, last = sum + 0.5 * (at - last) * (before + off), off, at
  end
  return (sum + 0.5 * (time - last) * before) / h
end

-- The largest distance of the supports' history from the cubic through the ends of a step and the points as far
-- outside; of the first step, from a parabola.
local function support_missed(histories, time, h)
  local points, most = {}, 0
  for k = time - h > 0.5 * h and -2 or -1, 1 do
    points[#points + 1] = {k, support_value(histories, time + k * h)}
  end
  for _, at in ipairs(history.times(histories.support_rows, time - h, time, histories.base)) do
    local x, value = (at - time) / h, 0
    for i, p in ipairs(points) do
      local part = p[2]
      for j, q in ipairs(points) do
        if j ~= i then part = part * (x - q[1]) / (p[1] - q[1]) end
      end
      value = value + part
    end
    most = math.max(most, math.abs(support_value(histories, at) - value))
  end
  return most
end

-- What a step to a time misses of the loads and the supports; nothing where steps do not adapt.
local function missed(histories, count, time, h)
  if not histories.base then return nil end
  local loads = {}
  for i = 1, count do loads[i] = histories.loads[i] and load_missed(histories, i, time, h) or 0 end
  return loads, support_missed(histories, time, h)
end

-- Factors of loads at a time, and that of the supports with its two derivatives: by differences over a step, of
-- second order as the method is, so that rows have the acceleration that a step sees.
local function factors(histories, count, time, h)
  local loads = {}
  for i = 1, count do loads[i] = load_value(histories, i, time) end
  local function s(at) return support_value(histories, at) end
  local now, after = s(time), s(time + h)
  if time < 0.5 * h then
    local later = s(time + 2 * h)
    return loads, now, (4 * after - 3 * now - later) / (2 * h), (now - 2 * after + later) / h ^ 2
  end
  local before = s(time - h)
  return loads, now, (after - before) / (2 * h), (after - 2 * now + before) / h ^ 2
end

--- The body at time 0; see lua/stubs/transient.lua.
function model:transient(given)
  local opts = options.read("transient", given, {
    step = {type = "number", needed = true, above = 0},
    rho = {type = "number", default = 0.9, min = 0, max = 1},
    error = {type = "number", above = 0},
    damping = {type = "any"}, -- read where it is used
    initial = {type = "table", default = {}},
    loads = {type = "table", default = {}},
    couplings = {type = "table", default = {}},
    supports = {type = "any"},
    modes = {type = "modes"},
  })
  local initial = options.read("transient: option 'initial'", opts.initial,
    {displacement = {type = "any"}, velocity = {type = "any"}})
  if opts.supports == nil then opts.supports = 1 end
  local loads, couplings = #self.loads, #self.couplings
  local count = loads + couplings
  local histories, why, about = read_histories(opts, {load = loads, coupling = couplings})
  if not histories then return nil, why, about end
  local made, message, details = core.linear_transient(self, {step = opts.step, rho = opts.rho, error = opts.error,
    damping = opts.damping, modes = opts.modes}, initial.displacement, initial.velocity,
    factors(histories, count, 0, opts.step))
  if not made then return nil, message, details end
  histories.by_modes = opts.modes ~= nil
  histories.base = opts.error and opts.step
  histories_of[made] = histories
  return made
end

--- One step, which is taken again with a shorter length where its error is too large.
function transient:step()
  local histories, count = histories_of[self], self.load_count + self.coupling_count
  while true do
    local h = self.step_length
    local time = self.time + h
    local loads, s, velocity, acceleration = factors(histories, count, time, h)
    local stands, message, details = core.linear_transient_step(self, loads, s, velocity, acceleration,
      missed(histories, count, time, h))
    if stands == nil then return nil, message, details end
    if stands then return self end
  end
end

-- ---- what is recorded ---------------------------------------------------------------------------

local recording = {}
recording.__index = recording

-- Recordings of superposed modes.
local superposed = setmetatable({}, {__mode = "k"})

local energies = {"kinetic_energy", "strain_energy", "work", "damping_energy", "lost_energy"}
local fields = {"displacement", "velocity", "acceleration"}

-- The nodes of probes: the boundary node nearest to each point.
local function find_probes(mesh, given)
  local probes = {}
  for name, point in pairs(given) do
    local kind = options.kind(point)
    if kind ~= "table" and kind ~= "array" then
      raise(("run: option 'probes': probe %s: a point {x, y, z} expected, got %s"):format(tostring(name),
        core.got(point)))
    end
    local node = mesh.boundary:nearest(point).nodes[1]
    local probe = {node = node, place = {table.unpack(mesh.nodes[node], 1, 3)}}
    for _, field in ipairs(fields) do probe[field] = {} end
    probes[name] = probe
  end
  return probes
end

local function record(rows, body)
  rows.time[#rows.time + 1] = body.time
  for _, name in ipairs(energies) do rows[name][#rows.time] = body[name] end
  if next(rows.probes) then
    for _, field in ipairs(fields) do
      local all = body[field]
      for _, probe in pairs(rows.probes) do
        probe[field][#rows.time] = {table.unpack(all[probe.node], 1, 3)}
      end
    end
  end
end

-- The largest von Mises stress at a node, and the state where it is largest of all. Gives the stress.
local function record_stress(stress, body)
  local static, message, details = body:static()
  if not static then return nil, message, details end
  local von_mises = static.von_mises
  local node = von_mises:argmax()
  local i = #stress.time + 1
  stress.time[i], stress.von_mises[i] = body.time, von_mises[node]
  if not stress.peak or von_mises[node] > stress.peak.von_mises then
    stress.peak = {von_mises = von_mises[node], time = body.time, node = node, static = static,
      place = {table.unpack(static.mesh.nodes[node], 1, 3)}}
  end
  local before = stress.envelope
  stress.envelope = before and core.array.map("max(a, b)", {a = before, b = von_mises}) or von_mises
  return von_mises
end

-- A file of the series, and the .pvd that lists those that are there.
local function write_state(series, body)
  local static, message, details = body:static()
  if not static then return nil, message, details end
  local file = ("%s_%04d.vtu"):format(series.stem, #series.lines)
  local ok, why, about = static:write(file, {fields = {velocity = {body.velocity, on = "nodes"},
    acceleration = {body.acceleration, on = "nodes"}}})
  if not ok then return nil, why, about end
  series.lines[#series.lines + 1] = ('    <DataSet timestep="%.17g" file="%s"/>\n'):format(body.time,
    file:match "[^/]*$")
  return core.write_file(series.path, '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  '
    .. "<Collection>\n" .. table.concat(series.lines) .. "  </Collection>\n</VTKFile>\n")
end

local function check_series(path)
  if not path:find "%.pvd$" then
    raise(("run: option 'write': the path of a .pvd file expected, got %s"):format(core.got(path)))
  end
  local fits, message, details = writable(path)
  if not fits then return nil, message, details end
  return {path = path, stem = path:gsub("%.pvd$", ""), lines = {}}
end

-- What is said of steps that adapt.
local function adaptive_steps(body, times)
  local shortest, longest
  for i = 2, #times do
    local h = times[i] - times[i - 1]
    shortest, longest = math.min(shortest or h, h), math.max(longest or h, h)
  end
  return {taken = #times - 1, shortest = shortest, longest = longest, rejected = body.rejected_steps,
    coarse = body.coarse_steps, factors = body.factors, error = body.error}
end

--- Steps to a time; see lua/stubs/transient.lua.
function transient:run(given)
  local opts = options.read("run", given, {
    time = {type = "number", needed = true, above = 0},
    probes = {type = "any", default = {}},
    stress_every = {type = "integer", min = 1},
    frames = {type = "integer", min = 2, max = 1000},
    write = {type = "string"},
    write_every = {type = "integer", min = 1, default = 1},
    each = {type = "function"},
  })
  if type(opts.probes) ~= "table" then
    raise(("run: option 'probes': a table of points {x, y, z} expected, got %s"):format(core.got(opts.probes)))
  end
  local rows, stress, series = {time = {}, probes = find_probes(self.mesh, opts.probes)},
    {time = {}, von_mises = {}}, nil
  for _, name in ipairs(energies) do rows[name] = {} end
  if opts.write then
    local why, about
    series, why, about = check_series(opts.write)
    if not series then return nil, why, about end
  end
  local first, h = self.time, self.step_length
  if opts.time < first - 1e-9 * h then
    raise(("run: the time %g s is before now, %g s: a later one expected"):format(opts.time, first))
  end
  local base = histories_of[self].base
  local left = math.ceil((opts.time - first) / (base or h) - 1e-9)
  if left > 1e8 then
    raise(("run: %.3g steps of %g s to %g s: at most 1e8 expected"):format(left, base or h, opts.time))
  end
  local kept
  if opts.frames then
    local why, about
    kept, why, about = transient_frames.new(self, opts.frames, first, opts.time)
    if not kept then return nil, why, about end
  end
  local from, begun, last = self.steps, false, self.steps + left
  local function is_there()
    if base then return self.time >= opts.time - 1e-9 * base end
    return self.steps >= last
  end
  while not begun or not is_there() do
    local ok, message, details = true, nil, nil
    if begun then
      ok, message, details = core.report_progress("time steps", (self.time - first) / (opts.time - first))
      if ok then ok, message, details = self:step() end
      if not ok then return nil, message, details end
    end
    begun = true
    record(rows, self)
    local done, is_frame = self.steps - from, kept and transient_frames.is_due(kept, self.time)
    local von_mises
    if opts.stress_every and (is_frame or done % opts.stress_every == 0) then
      von_mises, message, details = record_stress(stress, self)
      ok = von_mises ~= nil
    end
    if ok and is_frame then transient_frames.keep(kept, self, von_mises) end
    if ok and series and done % opts.write_every == 0 then ok, message, details = write_state(series, self) end
    if not ok then return nil, message, details end
    if opts.each then opts.each(self) end
  end
  local out = setmetatable({energy = {}, probes = rows.probes, time = core.array.new(rows.time)}, recording)
  superposed[out] = histories_of[self].by_modes
  if base then out.steps = adaptive_steps(self, rows.time) end
  out.steps_per_period, out.period_error = core.linear_transient_resolution(self)
  for _, name in ipairs(energies) do out.energy[name] = core.array.new(rows[name]) end
  out.energy.initial_energy = self.initial_energy
  for _, probe in pairs(out.probes) do
    for _, field in ipairs(fields) do probe[field] = core.array.new(probe[field]) end
  end
  if opts.stress_every then
    stress.time, stress.von_mises = core.array.new(stress.time), core.array.new(stress.von_mises)
    out.stress = stress
  end
  out.frames = kept and transient_frames.finish(kept)
  return out
end

local function sorted_names(probes)
  local names = {}
  for name in pairs(probes) do names[#names + 1] = name end
  table.sort(names, function(a, b) return tostring(a) < tostring(b) end)
  return names
end

--- Times, energies and probes as the columns of a CSV file.
function recording:write(path)
  local columns, heads = {self.time}, {"time_s"}
  for _, name in ipairs(energies) do
    columns[#columns + 1], heads[#heads + 1] = self.energy[name], name .. "_J"
  end
  local units = {displacement = "m", velocity = "m/s", acceleration = "m/s2"}
  for _, name in ipairs(sorted_names(self.probes)) do
    for _, field in ipairs(fields) do
      for c = 1, 3 do
        columns[#columns + 1] = self.probes[name][field]:column(c)
        heads[#heads + 1] = ("%s_%s_%s_%s"):format(tostring(name), field, ("xyz"):sub(c, c), units[field])
      end
    end
  end
  for k, head in ipairs(heads) do
    if head:find '[,"\r\n]' then heads[k] = '"' .. head:gsub('"', '""') .. '"' end
  end
  local lines = {table.concat(heads, ",")}
  for i = 1, #self.time do
    local row = {}
    for k, column in ipairs(columns) do row[k] = ("%.9g"):format(column[i]) end
    lines[#lines + 1] = table.concat(row, ",")
  end
  return core.write_file(path, table.concat(lines, "\n") .. "\n")
end

recording.report, recording.picture = transient_frames.report, transient_frames.picture

function recording:__tostring()
  local n, e = #self.time, self.energy
  local scale = 0
  for i = 1, n do scale = math.max(scale, e.kinetic_energy[i] + e.strain_energy[i]) end
  local lines = {("motion from %.6g to %.6g s, %d steps; energy at the end:"):format(self.time[1], self.time[n],
    n - 1)}
  local said = {kinetic_energy = "kinetic", strain_energy = "strain", work = "work of loads and supports",
    damping_energy = "taken by damping", lost_energy = "taken by the scheme"}
  lines[#lines + 1] = ("  %-28s %.6g J"):format("at the start", e.initial_energy)
  for _, name in ipairs(energies) do lines[#lines + 1] = ("  %-28s %.6g J"):format(said[name], e[name][n]) end
  lines[#lines + 1] = ("  the scheme took %.2g %% of the largest energy; %s"):format(
    scale > 0 and 100 * e.lost_energy[n] / scale or 0, superposed[self]
    and "by modes that is the rule of the work: compare with more modes" or "a large part asks for shorter steps")
  if superposed[self] then
    lines[#lines + 1] = "  error by the step: none for loads that are linear within a step"
  elseif self.steps then
    local s = self.steps
    lines[#lines + 1] = ("  error by the step: about %.2g %% of the largest displacement, the root mean square "
      .. "over the mass; an estimate, the sum of all steps"):format(100 * s.error)
    lines[#lines + 1] = ("  %s; since the start %d rejected, %d factors%s"):format(s.taken == 0 and "no step"
      or ("%d steps of %s to %s"):format(s.taken, core.quantity(s.shortest, "s"), core.quantity(s.longest, "s")),
      s.rejected, s.factors, s.coarse == 0 and ""
      or (", %d of the shortest length with a larger error than asked for"):format(s.coarse))
  elseif self.steps_per_period then
    lines[#lines + 1] = ("  error by the step: periods too long by %s %.2g %%, at %.3g steps per period in the "
      .. "mean over the strain energy%s"):format(self.period_error < 0.3 and "about" or "more than",
      100 * math.min(self.period_error, 0.3), self.steps_per_period,
      self.period_error > 0.03 and "; too large a step" or "")
  else
    lines[#lines + 1] = "  error by the step unknown: too few steps of a motion with strain"
  end
  for _, name in ipairs(sorted_names(self.probes)) do
    local probe, most, at = self.probes[name], 0, 1
    for i = 1, n do
      local u = probe.displacement[i]
      local length = math.sqrt(u[1] ^ 2 + u[2] ^ 2 + u[3] ^ 2)
      if length > most then most, at = length, i end
    end
    lines[#lines + 1] = ("  %s: largest displacement %.6g m at %.6g s; error of the mesh unknown"):format(
      tostring(name), most, self.time[at])
  end
  local peak = self.stress and self.stress.peak
  if peak then
    lines[#lines + 1] = ("  largest von Mises stress %.6g MPa at %.6g s, (%.4g, %.4g, %.4g) m, of %d times; error "
      .. "unknown: one mesh"):format(peak.von_mises / 1e6, peak.time, peak.place[1], peak.place[2], peak.place[3],
      #self.stress.time)
  end
  return table.concat(lines, "\n")
end

arguments.methods("model", model, nil, {transient = "options: options"})
arguments.methods("linear_transient", transient, nil, {step = "", run = "options: options"})
arguments.methods("recording", recording, recording, {write = "path: string",
  report = "path: string, options?: options", picture = "path: string, options?: options"})
