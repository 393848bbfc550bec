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

-- By transient: {loads = {histories by number, of couplings behind those of loads}, motions = {histories that
-- supports and remote points follow}, support_motions, point_motions = {which of these each one follows},
-- by_modes = boolean, base = step that looks at functions where steps adapt}. A history is {name, f, rows, place}.
local histories_of = setmetatable({}, {__mode = "k"})

local function read_history(name, given)
  local f, rows, place = history.read(name, given)
  if not f then return nil, rows, place end
  return {name = name, f = f, rows = rows, place = place}
end

local function ascending(list)
  local sorted = {}
  for index in pairs(list) do sorted[#sorted + 1] = index end
  table.sort(sorted)
  return sorted
end

-- The numbers that a table of histories has.
local function numbers(option, kind, list, count)
  for index in pairs(list) do
    if math.type(index) ~= "integer" or index < 1 or index > count then
      raise(("transient: option '%s': there is no %s %s: the part has %d"):format(option, kind, tostring(index),
        count))
    end
  end
  return ascending(list)
end

-- Histories by number from 1, behind `before` others.
local function read_loads(option, kind, list, count, loads, before)
  for _, index in ipairs(numbers(option, kind, list, count)) do
    local read, message, details = read_history(("transient: the history of %s %d"):format(kind, index),
      list[index])
    if not read then return nil, message, details end
    loads[before + index] = read
  end
  return true
end

-- Whether a value is histories by number, not one history.
local function is_list(given)
  return type(given) == "table" and (type(given[1]) ~= "table" or type(given[1][1]) == "table")
end

-- Which history each support, and each remote point, follows: the same one where the same was given.
local function read_motions(opts, counts, histories)
  local each, motions, number = is_list(opts.supports), {}, {}
  local default = each and 1 or opts.supports
  local function follow(name, given)
    if not number[given] then
      local read, message, details = read_history("transient: the history of " .. name, given)
      if not read then return nil, message, details end
      motions[#motions + 1] = read
      number[given] = #motions
    end
    return number[given]
  end
  local function follow_all(option, kind, name, list)
    numbers(option, kind, list, counts[kind])
    local out = {}
    for i = 1, counts[kind] do
      local own = list[i] ~= nil
      local m, message, details = follow(own and name:format(i) or "the supports", own and list[i] or default)
      if not m then return nil, message, details end
      out[i] = m
    end
    return out
  end
  local ok, message, details = true, nil, nil
  if not each or counts.support + counts.coupling == 0 then
    ok, message, details = follow("the supports", default)
  end
  if ok then
    ok, message, details = follow_all("supports", "support", "support %d", each and opts.supports or {})
    histories.support_motions = ok
  end
  if ok then
    ok, message, details = follow_all("coupling_motions", "coupling", "the motion of coupling %d",
      opts.coupling_motions)
    histories.point_motions = ok
  end
  histories.motions = motions
  return ok, message, details
end

local function read_histories(opts, counts)
  local histories = {loads = {}}
  local ok, message, details = read_loads("loads", "load", opts.loads, counts.load, histories.loads, 0)
  if ok then
    ok, message, details = read_loads("couplings", "coupling", opts.couplings, counts.coupling, histories.loads,
      counts.load)
  end
  if ok then ok, message, details = read_motions(opts, counts, histories) end
  if not ok then return nil, message, details end
  return histories
end

local function value_of(one, time)
  return history.value(one.name, one.f, time)
end

-- The mean of |f - the line between the ends| over a step to a time: what the step misses of a load.
local function load_missed(one, time, h, base)
  local start, sum, before, last = time - h, 0, 0, time - h
  local from = value_of(one, start)
  local to = value_of(one, time)
  for _, at in ipairs(history.times(one.rows, start, time, base)) do
    local off = math.abs(value_of(one, at) - from - (to - from) * (at - start) / h)
    sum, before, last = sum + 0.5 * (at - last) * (before + off), off, at
  end
  return (sum + 0.5 * (time - last) * before) / h
end

-- The largest distance of the supports' history from the cubic through the ends of a step and the points as far
-- outside; of the first step, from a parabola.
local function support_missed(one, time, h, base)
  local points, most = {}, 0
  for k = time - h > 0.5 * h and -2 or -1, 1 do
    points[#points + 1] = {k, value_of(one, time + k * h)}
  end
  for _, at in ipairs(history.times(one.rows, time - h, time, base)) do
    local x, value = (at - time) / h, 0
    for i, p in ipairs(points) do
      local part = p[2]
      for j, q in ipairs(points) do
        if j ~= i then part = part * (x - q[1]) / (p[1] - q[1]) end
      end
      value = value + part
    end
    most = math.max(most, math.abs(value_of(one, at) - value))
  end
  return most
end

-- What a step to a time misses of the loads and the supports; nothing where steps do not adapt.
local function missed(histories, count, time, h)
  if not histories.base then return nil end
  local loads, supports, base = {}, {}, histories.base
  for i = 1, count do loads[i] = histories.loads[i] and load_missed(histories.loads[i], time, h, base) or 0 end
  for m, one in ipairs(histories.motions) do supports[m] = support_missed(one, time, h, base) end
  return loads, supports
end

-- The factor of supports at a time with its two derivatives: by differences over a step, of second order as the
-- method is, so that rows have the acceleration that a step sees.
local function motion(one, time, h)
  local now, after = value_of(one, time), value_of(one, time + h)
  if time < 0.5 * h then
    local later = value_of(one, time + 2 * h)
    return {now, (4 * after - 3 * now - later) / (2 * h), (now - 2 * after + later) / h ^ 2}
  end
  local before = value_of(one, time - h)
  return {now, (after - before) / (2 * h), (after - 2 * now + before) / h ^ 2}
end

-- Factors of loads at a time, and rows of the histories of supports.
local function factors(histories, count, time, h)
  local loads, supports = {}, {}
  for i = 1, count do loads[i] = histories.loads[i] and value_of(histories.loads[i], time) or 1 end
  for m, one in ipairs(histories.motions) do supports[m] = motion(one, time, h) end
  return loads, supports
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
    coupling_motions = {type = "table", default = {}},
    modes = {type = "modes"},
  })
  local initial = options.read("transient: option 'initial'", opts.initial,
    {displacement = {type = "any"}, velocity = {type = "any"}})
  if opts.supports == nil then opts.supports = 1 end
  local loads, couplings = #self.loads, #self.couplings
  local count = loads + couplings
  local histories, why, about = read_histories(opts, {load = loads, coupling = couplings,
    support = #self.supports})
  if not histories then return nil, why, about end
  local made, message, details = core.linear_transient(self, {step = opts.step, rho = opts.rho, error = opts.error,
    damping = opts.damping, modes = opts.modes}, initial.displacement, initial.velocity,
    histories.support_motions, histories.point_motions, factors(histories, count, 0, opts.step))
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
    local loads, supports = factors(histories, count, time, h)
    local stands, message, details = core.linear_transient_step(self, loads, supports,
      missed(histories, count, time, h))
    if stands == nil then return nil, message, details end
    if stands then return self end
  end
end

-- Warns, once for each file, of a history that ends before the motion does while its value changes.
local function check_ends(histories, time)
  local function check(one, is_load)
    local rows = one.place and one.rows
    if not rows or one.checked or rows[#rows][1] >= time then return end
    one.checked = true
    local last, before = rows[#rows][2], rows[#rows - 1]
    if before and last == before[2] or is_load and last == 0 then return end
    core.warn(("%s: the history ends at %g s, before the motion ends at %g s, and its last value, %g, stays: add "
      .. "rows, or give an earlier end"):format(one.place, rows[#rows][1], time, last))
  end
  for _, i in ipairs(ascending(histories.loads)) do check(histories.loads[i], true) end
  for _, one in ipairs(histories.motions) do check(one, false) end
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
  check_ends(histories_of[self], opts.time)
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

--- Times, energies and probes as the columns of a CSV file; the frames as .xdmf.
function recording:write(path)
  if path:lower():find "%.xdmf$" then return transient_frames.write(self, path) end
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
