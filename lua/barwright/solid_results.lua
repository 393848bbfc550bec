-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Equilibria of hyperelastic solids: fields, totals, errors against another, files and pictures.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local estimate = require "barwright.solid_estimate"
local members = require "barwright.members"
local solver_reports = require "barwright.solver_reports"

local result = {}

local function cached(name, make)
  return function(self)
    local cache = rawget(self, "cache")
    if cache[name] == nil then cache[name] = make(self) end
    return cache[name]
  end
end

local function sum_newton(all)
  local total = {}
  for _, each in ipairs(all) do
    for key, value in pairs(each.newton) do
      if type(value) == "number" then total[key] = (total[key] or 0) + value end
    end
  end
  local last = all[#all].newton
  total.load, total.residual, total.contacts = last.load, last.residual, last.contacts
  total.shape, total.history = last.shape, last.history
  return total
end

local properties = {
  displacement = function(self) return rawget(self, "inner").displacement end,
  reaction = function(self) return rawget(self, "inner").reaction end,
  energy = function(self) return rawget(self, "inner").energy end,
  complete = function(self) return rawget(self, "inner").complete end,
  grid = function(self) return rawget(self, "solid").grid end,
  newton = cached("newton", function(self) return sum_newton(self.all) end),
  report = cached("report", function(self)
    local reports = {}
    for _, each in ipairs(self.all) do solver_reports.add(reports, "linear", each.report) end
    return reports.linear
  end),
  stress = cached("stress", function(self)
    return self.solid.body:stress(self.displacement, true)
  end),
  element_stress = cached("element_stress", function(self)
    return self.solid.body:stress(self.displacement, false)
  end),
  von_mises = cached("von_mises", function(self) return core.von_mises(self.stress) end),
  movement = cached("movement", function(self)
    return self.displacement:map "sqrt(a.x*a.x + a.y*a.y + a.z*a.z)"
  end),
  estimated_error = cached("estimated_error", function(self) return (estimate.of(self)) end),
  choice = function(self) return rawget(self, "cache").choice end,
  fine_displacement = cached("fine_displacement", function(self)
    local coarse = self.solid.coarse
    return coarse and coarse:to_fine(self.displacement) or self.displacement
  end),
}
result.__index = members("result", result, properties)
result.__name = "barwright.solid_result"

--- Mean distance of the fine grid's nodes from those of a reference on the same fine grid, over the
--- reference's mean displacement; and the same over the longest side of the body (data-driven, section
--- 6.2), which is small wherever little moves.
function result:error(reference)
  if getmetatable(reference) ~= result then
    core.raise(("error: a result to compare with expected, got %s"):format(core.got(reference)))
  end
  local fine = self.solid.coarse and self.solid.coarse.fine or self.solid.grid
  local moved = reference.fine_displacement
  local distance = fine:difference(self.fine_displacement, moved)
  local size = fine:difference(moved, core.array.zeros(#moved, 3))
  return distance == 0 and 0.0 or distance / size, distance
end

--- About what `error` would say of a coarse result, without the fine solution: the same two numbers, and the
--- corrected displacements of the fine grid that they come from. nil, message, details where there is none.
function result:estimate_error()
  return estimate.of(self)
end

--- The sum of the reactions at nodes by place.
function result:total_reaction(where)
  return self.reaction:gather(self.solid.grid:nodes(where)):column_sums()
end

--- .vtu with displacement, reaction, stress and von Mises stress.
function result:write(path)
  return self.solid.grid:write(path, {fields = {
    displacement = {self.displacement, on = "nodes"}, reaction = {self.reaction, on = "nodes"},
    stress = {self.stress, on = "nodes"}, von_mises = {self.von_mises, on = "nodes"},
    element_stress = {self.element_stress, on = "elements"},
  }})
end

local named = {von_mises = true, movement = true}

local function values_of(self, values)
  if type(values) ~= "string" then return values end
  if not named[values] then
    core.raise(("picture: option 'values': \"von_mises\", \"movement\" or an array expected, got %s"):format(
      core.got(values)))
  end
  return self[values]
end

--- The deformed grid with its elements' edges: {values = "von_mises", "movement" or an array; without,
--- materials; other options as of grid:picture}.
function result:picture(path, given)
  if given ~= nil and type(given) ~= "table" then
    core.raise(("picture: a table of options expected, got %s"):format(core.got(given)))
  end
  local opts = {}
  for key, value in pairs(given or {}) do opts[key] = value end
  opts.values = values_of(self, opts.values)
  opts.displacement = opts.displacement or self.displacement
  return self.solid.grid:picture(path, opts)
end

--- A panel of bw.grid.picture, to be beside others.
function result:panel(title, values)
  return {title = title, grid = self.solid.grid, displacement = self.displacement,
    values = values_of(self, values)}
end

function result:__tostring()
  local r = self.newton
  return ("equilibrium%s: strain energy %s, %d iterations in %d load steps, residual %.1e, smallest det F "
    .. "%.4g; %s"):format(self.complete and "" or (" at load factor %.4g"):format(r.load),
    core.quantity(self.energy, "J"), r.iterations, r.load_steps, r.residual, r.shape.min_ratio,
    tostring(self.report))
end

arguments.methods("result", result, result, {error = "reference: any", estimate_error = "",
  total_reaction = "where: any",
  write = "path: string",
  picture = "path: string, options?: any", panel = "title?: string, values?: string|array"})

--- Around an engine result; `all`: those of the path that led to it, in order.
local function create(solid, inner, all)
  if inner ~= all[#all] then all = {table.unpack(all)}; all[#all + 1] = inner end
  return setmetatable({solid = solid, inner = inner, all = all, cache = {}}, result)
end

return {create = create, class = result, properties = properties}
