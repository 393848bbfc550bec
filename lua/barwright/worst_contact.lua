-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst case over parts in contact: linear programs in fixed states of contact, whose loads are judged by the
-- solution with contact (docs/theory/worst_case.md, section 17).
local core = require "barwright.core"
local solver_reports = require "barwright.solver_reports"
local worst_search = require "barwright.worst_search"

local worst_contact = {}

local HALVINGS = 6

-- The search in one state takes the place of self.
local function in_state(self, state)
  local system, message, details = self.contact:in_state(state)
  if not system then return nil, message, details end
  return {system = system, mesh = self.mesh, basis = self.basis, options = self.options, reports = self.reports,
    signs = {1, -1}}
end

-- The state of contact under a load that was found.
local function state_of(self, loads, i)
  local u, state, details = self.contact:solve(self.basis:force(loads.pressures[i]))
  if not u then return nil, state, details end
  u:close()
  return state
end

local function key_of(state)
  return table.concat(state:totable())
end

-- The loads of weak regions, and with method "search" those of the screening, in a state.
local function explore(self, loads, origins, weak, limits, state)
  local one, message, details = in_state(self, state)
  if not one then return nil, message, details end
  -- what reaches more without regard to contact may reach less with it
  for _, other in ipairs(self.options.one_sign and {false} or {false, true}) do
    local earlier, opts = loads and loads.peaks.row_count or 0, {after = loads}
    for key, value in pairs(limits) do opts[key] = value end
    opts.one_sign, opts.other_sign = true, other
    loads, message, details = core.worst_loads(one.system, self.basis, weak, opts)
    if not loads then return nil, message, details end
    solver_reports.add(self.reports, "lp", loads.report)
    for k = 1, weak.count do origins[earlier + k] = {origin = "mode", weak = k} end
  end
  if self.options.method == "paper" then return loads end
  return worst_search.explore(one, loads, origins, limits)
end

local function pressure_of(loads, i)
  return loads.pressures:gather(core.array.new({i}, "i32"))
end

local function rows_of(pressure)
  return core.array.new(pressure:totable()[1])
end

-- Between a load and the best one of its state: with contact the stress is piecewise linear there and grows at
-- first, so where the far end has another state, a load on the way may have more.
local function between(self, loads, origins, limits, from, to)
  if self.options.hands then return loads end -- a load on the way has the hands of both
  local least, start = loads.peaks[from] * (1 + worst_search.GAIN), pressure_of(loads, from)
  local way, part = pressure_of(loads, to) - start, 1
  for _ = 1, HALVINGS do
    part = part / 2
    local pressure = start + way * part
    local u, message, details = self.contact:solve(self.basis:force(rows_of(pressure)))
    if not u then return nil, message, details end
    local stress = core.element_stress(self.mesh, self.material, u)
    if core.max_principal(stress):max() > least then
      local earlier = loads.peaks.row_count
      local opts = {given = pressure}
      for key, value in pairs(limits) do opts[key] = value end
      local element = loads.peak_elements[from]
      loads, message, details = worst_search.directed(self, loads, {element},
        loads.peak_stresses:gather(core.array.new({from}, "i32")), opts)
      if not loads then return nil, message, details end
      origins[earlier + 1] = {origin = "ascent", target = element, from = from}
      return loads
    end
  end
  return loads
end

-- A step of ascent from each load, in its own state of contact.
local function step(self, loads, origins, limits, chosen)
  local groups, order = {}, {}
  for _, i in ipairs(chosen) do
    local state, message, details = state_of(self, loads, i)
    if not state then return nil, message, details end
    local key = key_of(state)
    if not groups[key] then
      groups[key] = {state = state}
      order[#order + 1] = key
    end
    table.insert(groups[key], i)
  end
  for _, key in ipairs(order) do
    local group, earlier = groups[key], loads.peaks.row_count
    local one, message, details = in_state(self, group.state)
    if not one then return nil, message, details end
    loads, message, details = worst_search.step(one, loads, origins, limits, group)
    for k, i in ipairs(group) do
      if loads and loads.peaks[earlier + k] < loads.peaks[i] * (1 + worst_search.GAIN) then
        loads, message, details = between(self, loads, origins, limits, i, earlier + k)
      end
    end
    if not loads then return nil, message, details end
  end
  return loads
end

--- The worst loads that are found with contact, and their origins; nil, message, details.
function worst_contact.search(self, weak, limits)
  local origins, loads, message, details = {}
  limits.contact = self.contact
  for _, state in ipairs {"closed", "open"} do
    loads, message, details = explore(self, loads, origins, weak, limits, state)
    if not loads then return nil, message, details end
  end
  if self.options.method == "search" then
    loads, message, details = worst_search.ascend(self, loads, origins, limits, step)
    if not loads then return nil, message, details end
  end
  return loads, origins
end

--- What is known of the worst load: how much touches, and whether another load in this state of contact stresses
--- the element more along its direction.
function worst_contact.judge(self, limits)
  local state, message, details = state_of(self, self.loads, self.region)
  if not state then return nil, message, details end
  self.touching = math.tointeger(state:sum())
  local one
  one, message, details = in_state(self, state)
  if not one then return nil, message, details end
  local stress = self.loads.peak_stresses:gather(core.array.new({self.region}, "i32"))
  local best
  best, message, details = worst_search.directed(one, nil, {self.element}, stress, limits)
  if not best then return nil, message, details end
  local u
  u, message, details = one.system:solve(self.basis:force(best.pressures[1]) - self:force())
  if not u then return nil, message, details end
  local there = core.element_stress(self.mesh, self.material, u):gather(core.array.new({self.element}, "i32"))
  self.settled = not self.options.hands -- whose best load is not known
    and core.max_principal(stress + there)[1] <= self.max_principal * (1 + worst_search.GAIN)
  return self
end

--- What of contact belongs into a sentence about the answer.
function worst_contact.describe(self)
  return ("; contact without friction, %d of %d corners touch%s; a lower bound, which loads in other states of "
    .. "contact may exceed"):format(self.touching, self.contact.candidates,
    self.settled and "" or ", and loads in this state may exceed it too")
end

return worst_contact
