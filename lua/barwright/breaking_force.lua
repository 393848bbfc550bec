-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The breaking force: the least force that breaks a part when it is pushed in the worst way through
-- contacts of a given size, as an interval. The worst case is analysed on a sequence of finer meshes; the
-- stress is assessed by its mean over a surface patch, which has a limit under refinement also at re-entrant
-- edges. docs/theory/breaking_force.md has the mathematics.
local advice = require "barwright.advice"
local arguments = require "barwright.arguments"
local averaging_radius = require "barwright.averaging_radius"
local breaking_loads = require "barwright.breaking_loads"
local core = require "barwright.core"
local growth = require "barwright.singular_growth"
local mesh_progress = require "barwright.mesh_progress"
local options = require "barwright.options"
local points = require "barwright.points"
local singular = require "barwright.singular"
local weak_places = require "barwright.weak_places"
local distance = points.distance
local worst_case = require "barwright.worst_case"
local shown = require "barwright.shown"
local solver_reports = require "barwright.solver_reports"

local breaking_force = {}
breaking_force.__index = breaking_force
breaking_force.__name = "barwright.breaking_force"

-- Elements that are asked for by default.
local ELEMENTS = 20000

local rules = breaking_loads.rules {
  material = {type = "material"},
  force = {type = "number", default = 20, above = 0},
  contact = {type = "number", default = 1e-4, above = 0},
  error = {type = "number", default = 0.05, above = 0, max = 1},
  decide = {type = "boolean", default = false},
  elements = {type = "integer", default = ELEMENTS, min = 1, max = 10000000},
  max_elements = {type = "integer", min = 1, max = 10000000},
  length = {type = "any"},
  failure = {type = "string", one_of = {"principal", "von_mises"}},
  modes = {type = "integer", default = 15, min = 1, max = 500},
  regions = {type = "integer", default = 5, min = 1, max = 1000},
  seed = {type = "integer", default = 1},
  solver = {type = "solver", auto = true},
  eigensolver = {type = "eigensolver", auto = true},
}

-- A sound surface that filling wrapped is filled again with FEWER times the elements, so often at most.
local OTHERS, FEWER = 2, 0.9
-- A contact takes at most this fraction of the surface; with more, few loads are admissible.
local MAX_SURFACE_FRACTION = 0.05
-- The first mesh is uniform and has this fraction of the elements that are asked for, but not fewer than FEWEST.
-- The others have so much of them, with BACKGROUND for the whole body, the rest near the weakest places.
local FIRST, FEWEST, BACKGROUND = 0.25, 300, 0.5
local FRACTIONS = {0.6, 1}
-- From there on, while the error is too large, the number of elements grows by this factor, by default to MORE
-- times the number asked for, but not beyond the default of that number.
local GROWTH, MORE = 2, 4
-- A force is clearly decided where it lies outside the interval by this factor.
local DECIDED = 1.5
-- Meshes whose weakest place was not refined are followed by one where it is: so many meshes in all.
local MAX_MESHES = 8
-- Places that are refined at once. Those that were refined before may be the weakest if their mean stress is so
-- near to the largest; others if it is NEARLY.
local REFINED, CLOSE, NEARLY = 8, 0.85, weak_places.NEARLY
-- About so many elements has a place whose edges are a patch's radius long; the number grows by this power of
-- radius over edge. Edges there are at most this fraction of the radius. From the mesh of this number on, those of
-- the first few places are shorter: the change from the meshes before shows what shorter edges change.
local ELEMENTS_OF_PLACE, POWER, LONGEST = 250, 2.8, 0.7
local SHORTER_FROM, SHORTER_AT, SHORTER = 3, 2, 0.5
-- The least error where the weakest place is not refined, for elements as large as the radius of a patch: there
-- the change from mesh to mesh says little.
local UNREFINED = 0.3
-- The background leaves the surface by at most this fraction of the radius, so that small features are seen.
local FOLLOWED = 0.3
-- So many meshes are screened for new places; the others start from the places that are known.
local SCREENED = 3
-- Elements that meshes have for each facet of the surface and each cube of the edge length; an equilateral
-- triangle's area over its squared edge.
local FOR_FACETS, FOR_VOLUME, EQUILATERAL = 2, 1.6, math.sqrt(3) / 4
-- The volume of a regular tetrahedron over its cubed edge.
local REGULAR = 1 / (6 * math.sqrt(2))
-- Places that are listed, and those of the mesh before that the search starts from.
local PLACES, KNOWN = 6, 12
-- What the search may miss of the largest stress (docs/benchmarks.md).
local SEARCH = 0.02
-- The relative error that a mean displacement of the surface by the radius of the patch stands for.
local MOVED = 2
-- No estimate from several meshes is trusted below this, and one mesh alone leaves so much open.
local MIN_ERROR, ALONE = 0.02, 0.5
-- The least fraction by which the force may be higher: meshes of the same numbers scatter by a few percent.
local HIGHER = 0.045
-- Backgrounds hide weak places of walls that are thinner than their edges are long: the force may be lower by this
-- fraction for each thickness that the edges are longer. The thickness is this quantile, from so many rays.
local THIN, WALL, RAYS = 0.025, 0.25, 2000
-- At re-entrant edges meshes of the sizes in use overestimate the mean by up to EXCESS, at those of EXCESS_FROM
-- inside the material or less not at all: the table of docs/theory/breaking_force.md.
local EXCESS, EXCESS_FROM, EXCESS_TO = 0.35, 1.25 * math.pi, 1.75 * math.pi
-- Metals whose strength in the library is the yield strength.
local ductile = {steel = true, aluminium = true}

-- Stress over strength of rows of tensors.
local function utilisation(self, stress)
  if self.failure == "von_mises" then return core.von_mises(stress) * (1 / self.material.strength) end
  return self.material:utilisation(stress)
end

local function is_near(areas, at)
  for _, area in ipairs(areas) do
    if distance(area.at, at) <= area.radius then return true end
  end
  return false
end

-- Whether a place has the short edges of this mesh around it, and whether it had those of this or a former one.
local function mark(self, place)
  place.refined = is_near(self.near, place.at)
  place.settled = place.refined
  for _, level in ipairs(self.history) do place.settled = place.settled or is_near(level.near, place.at) end
end

-- Appends the first places of a list that are at least so weak and of which no two lie in one patch, up to `count`
-- in all.
local function append_apart(self, chosen, list, count, min)
  return points.append_apart(chosen, list, count, self.length, function(place)
    return place.utilisation >= min
  end)
end

-- The places that the next mesh refines: the weakest of the last mesh, those that were refined and are about as
-- weak, then unsettled ones, then others of the last mesh.
local function to_refine(self)
  local last = self.history[#self.history]
  local chosen = append_apart(self, {}, last.places, 1, 0)
  append_apart(self, chosen, weak_places.settled(self.history), REFINED, CLOSE * last.utilisation)
  append_apart(self, chosen, weak_places.unsettled(self.history, self.length), REFINED, 0)
  return append_apart(self, chosen, last.places, REFINED, NEARLY * last.utilisation)
end

-- Edge lengths near places, of `count` elements in all.
local function sizes_near(self, places, count)
  local fraction, near = (#places * ELEMENTS_OF_PLACE / count) ^ (1 / POWER), {}
  for i, place in ipairs(places) do
    local shorter = #self.history + 1 >= SHORTER_FROM and i <= SHORTER_AT
    near[i] = {at = place.at, radius = self.length,
      length = math.min(fraction, shorter and SHORTER or LONGEST) * self.length}
  end
  return near
end

-- The edge length that fills a surface with about `count` elements: FOR_FACETS of them for each facet of the
-- surface and FOR_VOLUME for each cube of the length.
local function background_length(surface, count)
  local low, high = 1e-6, 1
  local scale = distance(surface.box.min, surface.box.max)
  for _ = 1, 60 do
    local fraction = math.sqrt(low * high)
    local length = fraction * scale
    local facets = surface.area / (EQUILATERAL * length ^ 2)
    local expected = FOR_FACETS * facets + FOR_VOLUME * math.abs(surface.volume) / length ^ 3
    if expected > count then low = fraction else high = fraction end
  end
  return math.sqrt(low * high) * scale
end

-- Whether filling had to wrap the surface, which closes slots and holes narrower than the edges.
local function is_wrapped(log)
  for _, step in ipairs(log.steps) do
    if step.name == "wrap" then return true end
  end
  return false
end

-- What filling is asked for: about so many elements, uniform ones at first, then finer near the weakest places.
local function to_ask(self, elements)
  local ask = {order = 2}
  if #self.history == 0 then
    ask.elements = elements
  else
    ask.near = sizes_near(self, to_refine(self), (1 - BACKGROUND) * elements)
    ask.surface_tolerance = FOLLOWED * self.length
    ask.edge_length = background_length(self.surface, BACKGROUND * elements)
  end
  return ask
end

-- A mesh of about so many elements, and whether a sound surface had to be wrapped for it: then other numbers of
-- elements are tried. Or nil, message, details.
local function make_mesh(self, elements)
  if self.given_mesh then return self.given_mesh, false end
  local mesh, log, details, wrapped
  for try = 0, OTHERS do
    local ask = to_ask(self, math.ceil(FEWER ^ try * elements))
    mesh, log, details = core.mesh.fill(self.surface, ask)
    if not mesh then return nil, log, details end
    self.log, self.near, self.background = log, ask.near or {}, ask.edge_length
    wrapped = self.volume ~= nil and is_wrapped(log)
    if not wrapped then break end
  end
  return mesh, wrapped
end

-- The mean distance of boundary nodes around a place from the surface that was filled.
local function moved_near(self, mesh, at)
  if not self.surface then return 0 end
  local nodes = mesh.boundary:near(at, self.length).nodes
  local offsets, message, details = self.surface:distance(mesh.nodes:gather(nodes))
  if not offsets then return nil, message, details end
  return offsets:sum() / offsets.row_count
end

-- One mesh: its worst case, with the places of its largest mean stresses.
local function analyse_on(self, mesh)
  local last = self.history[#self.history]
  local part, limits, details = breaking_loads.part(self, mesh)
  if not part then return nil, limits, details end
  local opts = self.options
  limits.length, limits.failure = self.length, self.failure
  limits.modes, limits.regions, limits.seed = opts.modes, opts.regions, opts.seed
  limits.solver, limits.eigensolver = opts.solver, opts.eigensolver
  limits.screening = #self.history < SCREENED
  limits.places = last and append_apart(self, to_refine(self), last.places, KNOWN, NEARLY * last.utilisation)
  local worst, message
  worst, message, details = worst_case(part, limits)
  if not worst then return nil, message, details end
  for name, report in pairs(worst.reports) do solver_reports.add(self.reports, name, report) end
  if self.worst then self.worst:close() end
  self.worst, self.mesh = worst, mesh
  local places = {}
  for i, place in ipairs(worst.places) do
    places[i] = {at = place.at, region = place.region, stress = place.stress,
      utilisation = place.utilisation / self.reference, point = place.point / self.reference}
    mark(self, places[i])
  end
  return places
end

-- The largest relative change from former meshes that refine their weakest place, back to one of fewer elements;
-- from the first mesh where there is none.
local function change_of(levels)
  local last, change = levels[#levels], nil
  for k = #levels - 1, 1, -1 do
    local former = levels[k]
    if former.refined or k == 1 and not change then
      change = math.max(change or 0, math.abs(last.utilisation / former.utilisation - 1))
    end
    if former.refined and former.asked < last.asked then break end
  end
  return change or ALONE
end

-- The relative error: the change, or what an unrefined place leaves open; at least what a surface that was moved
-- by filling may change. A sound surface that was wrapped is another part.
local function estimate(self)
  local last = self.history[#self.history]
  if last.wrapped then return 1 end
  local unrefined = last.refined and 0 or UNREFINED * math.max(1, last.size / self.length)
  local misfit = self.volume and math.abs(last.volume / self.volume - 1) or 0
  return math.max(change_of(self.history), unrefined, MOVED * last.moved / self.length, misfit, MIN_ERROR)
end

-- Whether the largest surface stress grows without end, from the last mesh with longer edges to the last one.
local function grows(levels)
  local last = levels[#levels]
  if not last.refined then return false end
  for k = #levels - 1, 1, -1 do
    local former = levels[k]
    local exponent = former.refined and growth.exponent({value = former.point, edge = former.edge},
      {value = last.point, edge = last.edge})
    if exponent then return exponent > growth.ALONE end
  end
  return false
end

-- Why the stress at the weakest place has no finite value, or nil. Edges shorter than the patch's radius are
-- facets of scans, mostly.
local function find_singular(self)
  local surface, long = self.volume and self.surface or self.mesh:surface(), {}
  for _, edge in ipairs(surface and surface:singular_edges() or {}) do
    if edge.length >= self.length then long[#long + 1] = edge end
  end
  return growth.check(singular.list(long), self.at, self.length, nil, grows(self.history))
end

-- The fraction by which the force is too small at a re-entrant edge, where the mean falls to its limit slowly.
local function excess_at(finding)
  local angle = finding and finding.place and finding.place.angle
  if not angle then return 0 end
  return EXCESS * math.min(math.max((angle - EXCESS_FROM) / (EXCESS_TO - EXCESS_FROM), 0), 1)
end

-- Other places that are as weak within the estimated error, no two of them in one patch.
local function ties(self, places)
  local list = append_apart(self, {}, places, PLACES, places[1].utilisation / (1 + self.estimated_error))
  return table.move(list, 2, #list + 1, 1)
end

-- The fraction by which the force may be lower at places that a background of this edge length hides.
local function hidden_by(background, mesh)
  local surface = background and mesh:surface()
  local walls = surface and surface:thickness(RAYS)
  walls = walls and walls:select(walls:below(1e300))
  if not walls or walls.row_count == 0 then return 0 end
  return THIN * math.max(0, background / walls:quantile(WALL) - 1)
end

-- Finer meshes show larger stresses, so the interval reaches further down than up. A surface that was moved may be
-- either, and so may stresses by a solver with a tolerance.
local function summarise(self)
  local last, former = self.history[#self.history], self.history[#self.history - 1]
  local change = estimate(self)
  local max = math.max(last.utilisation, former and former.utilisation or 0)
  self.force = 1 / last.utilisation
  local solve = self.worst.solve_error
  local higher = math.max(change / 2, MOVED * last.moved / self.length, HIGHER) + solve
  self.at, self.region = last.at, last.region
  self.singular = find_singular(self)
  self.excess = excess_at(self.singular)
  self.high = (1 + self.excess) / (last.utilisation * (1 - math.min(higher, 0.5)))
  local hidden, factor = weak_places.unsettled(self.history, self.length)
  local hidden_use = hidden[1] and factor * hidden[1].utilisation or 0
  local thin = hidden_by(self.background, self.mesh)
  self.low = 1 / math.max(max * (1 + change + SEARCH + thin + solve), hidden_use)
  self.estimated_error = math.max(self.high / self.force - 1, 1 - self.low / self.force)
  if self.estimated_error >= 1 then self.low = 0 end -- which decides nothing
  self.ties = ties(self, last.places)
end

-- Whether the verdict about the force is asked for alone, and further meshes would not change it.
local function is_decided(self)
  if not self.options.decide or #self.history <= #FRACTIONS then return false end
  summarise(self)
  return self.options.force * DECIDED < self.low or self.options.force > DECIDED * self.high
end

-- How many elements the next mesh has, or nil. Beyond the number asked for while the error is too large and there
-- is room; the same again where the weakest place is a new one.
local function next_count(self)
  local opts, levels = self.options, #self.history
  if self.given_mesh or levels >= MAX_MESHES then return nil end
  if levels == 0 then return math.min(opts.elements, math.max(FEWEST, math.ceil(FIRST * opts.elements))) end
  if FRACTIONS[levels] then return FRACTIONS[levels] * opts.elements end
  if is_decided(self) then return nil end
  local last = self.history[levels]
  local open = weak_places.unsettled(self.history, self.length)
  if #open > 0 and levels < #FRACTIONS + 3 then return last.asked end
  local next = last.asked * GROWTH
  local max = opts.max_elements or math.max(opts.elements, math.min(MORE * opts.elements, ELEMENTS))
  if estimate(self) <= opts.error or next > max then return nil end
  return next
end

-- Elements of the meshes that follow the next one for sure.
local function to_follow(self)
  local list = {}
  if self.given_mesh then return list end
  for k = #self.history + 1, #FRACTIONS do list[#list + 1] = FRACTIONS[k] * self.options.elements end
  return list
end

local function start_with(body)
  local kind = core.class_name(body)
  if kind == "surface" then return {surface = body, box = body.box} end
  if kind == "mesh" then return {box = body.box, given_mesh = body.order == 2 and body or body:with_order(2)} end
  core.raise(("breaking_force: body: a surface or a mesh expected, got %s"):format(kind or core.got(body)))
end

--- The least force that breaks a body. `body`: a surface, which is filled and refined, or a mesh, which
--- is taken as it is. Returns nil, message, details where it cannot be computed.
function breaking_force.analyse(body, given)
  local opts = options.read("breaking_force", given, rules)
  breaking_loads.check(opts)
  local self = setmetatable(start_with(body), breaking_force)
  self.options, self.material = opts, opts.material
  if not opts.material then core.raise "breaking_force: option 'material': a material expected, got nil" end
  if not opts.material.strength then
    return nil, "the strength of the material is not known", {status = "unsupported"}
  end
  if opts.failure == "von_mises" and type(opts.material.strength) ~= "number" then
    core.raise "breaking_force: failure 'von_mises' needs one strength; the material's differs with the direction"
  end
  self.failure = opts.failure or ductile[opts.material.name] and "von_mises" or "principal"
  local radius, why, about = averaging_radius("breaking_force", opts.length, opts.material, self.box)
  if not radius then return nil, why, about end
  self.length = radius
  self.reference, self.history, self.near, self.reports = opts.force, {}, {}, {}
  self.volume = self.surface and self.surface:check({limit = 1}).sound and self.surface.volume or nil
  local start = core.seconds()
  local asked = next_count(self) or self.given_mesh.element_count
  local progress <close> = mesh_progress.open "breaking force"
  while asked do
    progress:mesh(asked, to_follow(self), not self.given_mesh)
    local mesh, wrapped, details = make_mesh(self, asked)
    if not mesh then return nil, wrapped, details end
    -- A mesh of another part says nothing beside those of this one, and hides its places.
    local last = self.history[#self.history]
    if last and wrapped and not last.wrapped then break end
    if last and last.wrapped and not wrapped then self.history = {} end
    self.contact = self.contact or math.min(opts.contact, MAX_SURFACE_FRACTION * mesh.boundary.area)
    local places, message, moved
    places, message, details = analyse_on(self, mesh)
    if not places then return nil, message, details end
    local first = places[1]
    moved, message, details = moved_near(self, mesh, first.at)
    if not moved then return nil, message, details end
    self.history[#self.history + 1] = {elements = mesh.element_count, asked = asked,
      utilisation = first.utilisation, at = first.at, region = first.region, point = first.point,
      force = 1 / first.utilisation, places = places, moved = moved, refined = first.refined, volume = mesh.volume,
      size = (mesh.volume / (REGULAR * mesh.element_count)) ^ (1 / 3),
      wrapped = wrapped, near = self.near,
      edge = self.near[1] and self.near[1].length, seconds = core.seconds() - start}
    asked = next_count(self)
  end
  summarise(self)
  self.seconds = core.seconds() - start
  return self
end

--- "holds" where the whole interval lies above a force, "breaks" where it lies below, else "unsure". An error
--- as large as the value decides nothing.
function breaking_force:verdict(force)
  if self.estimated_error >= 1 then return "unsure" end
  if force < self.low then return "holds" end
  return force > self.high and "breaks" or "unsure"
end

--- What to thicken so that it carries {force = N}; see barwright.advice.
function breaking_force:advice(given)
  return advice.of(self, utilisation, given)
end

--- Releases the factor and the modes of the last mesh.
function breaking_force:close()
  if self.worst then self.worst:close() end
  self.worst = nil
end
breaking_force.__close = breaking_force.close

function breaking_force:__tostring()
  return ("breaks at %s at %s, pushed over at least %s%s"):format(
    shown.interval(self.force, self.low, self.high, "N"), core.point(self.at), core.quantity(self.contact, "m2"),
    self.singular and "; the stress there has no finite value" or "")
end

arguments.methods("breaking force", breaking_force, breaking_force, {verdict = "force: number",
  advice = "options: options", close = ""})

return setmetatable({class = breaking_force}, {
  __call = function(_, body, given) return breaking_force.analyse(body, given) end,
})
