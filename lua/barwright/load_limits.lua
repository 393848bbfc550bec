-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which loads the worst case admits: options, what the engine takes of them, and the basis of pressures.
-- docs/theory/worst_case.md, section 15, has the mathematics.
local core = require "barwright.core"
local options = require "barwright.options"
local shown = require "barwright.shown"

local raise = core.raise

local load_limits = {}

local PRESSURE = 2e5 -- Pa
-- The edges of cells of constant pressure, by the root of the area that the largest pressure takes.
local SPACING = 0.2
-- (m) With cells that may be so large, each facet is one.
local ONE_CELL = 1e9

--- Adds the options of admissible loads to the rules of an analysis.
function load_limits.rules(rules)
  rules.force = {type = "number", default = 20, above = 0}
  rules.pressure = {type = "number", above = 0}
  rules.contact = {type = "number", above = 0}
  rules.force_is_max = {type = "boolean", default = false}
  rules.forbidden = {type = "any"}
  rules.hands = {type = "integer", min = 1, max = 16}
  rules.hand = {type = "number", above = 0}
  rules.friction = {type = "number", default = 0, min = 0, max = 100}
  rules.friction_facets = {type = "integer", default = 8, min = 3, max = 64}
  rules.lp = {type = "linear_program_solver", auto = true}
  return rules
end

-- A selection, or a list of them, as one.
local function selection_of(where, given, mesh)
  local list = options.kind(given) == "table" and given or {given}
  if not options.countable(list) or #list == 0 then
    raise(("%s: option 'forbidden': a selection or a list of selections expected, got %s"):format(where,
      core.got(given)))
  end
  local whole
  for i = 1, #list do
    local kind = options.kind(list[i])
    if kind ~= "selection" then
      raise(("%s: option 'forbidden': a selection or a list of selections expected, got %s"):format(where, kind))
    end
    if list[i].mesh ~= mesh then
      raise(("%s: option 'forbidden': a selection on the mesh of the part expected, got one on another "
        .. "mesh"):format(where))
    end
    whole = whole and whole:union(list[i]) or list[i]
  end
  return whole
end

-- Pressures are constant on cells where the mean over a patch is judged, and on facets for buckling; else they
-- stand at nodes (the paper).
local function spacing_of(opts)
  if opts.by_facet then return ONE_CELL end
  return opts.length and SPACING * math.sqrt(opts.force / opts.pressure) or 0
end

local function basis_of(opts, mesh, friction, facets)
  return core.pressure_basis(mesh, {forbidden = opts.forbidden, cuts = opts.cuts, spacing = spacing_of(opts),
    friction = friction, friction_facets = facets})
end

-- What cuts through a part, in words.
local function cut_words(part, covered)
  local words, planes = {}, false
  for _, support in ipairs(part.supports) do planes = planes or support.symmetry ~= nil end
  if #part.bonds > 0 then words[#words + 1] = "bonds" end
  if planes then words[#words + 1] = "planes of symmetry" end
  if covered then words[#words + 1] = "contact" end
  if part.cyclic_symmetry then words[#words + 1] = "cuts between sectors" end
  return table.concat(words, " and ")
end

--- The basis of the pressures that may act on a part; sets the largest pressure of `opts`, and `cuts`, which take
--- no pressure, with `cut_words`; `covered`: by contact, or nil. Returns nil, message, details where no surface is
--- left.
function load_limits.basis(where, part, opts, covered)
  local mesh = part.mesh
  if opts.pressure and opts.contact then
    raise(("%s: one of the options 'pressure' and 'contact' expected, got both"):format(where))
  end
  opts.pressure = opts.pressure or opts.contact and opts.force / opts.contact or PRESSURE
  if opts.hand and not opts.hands then
    raise(("%s: option 'hand', the area of each hand, needs option 'hands'"):format(where))
  end
  opts.hand = opts.hands and (opts.hand or opts.force / opts.pressure)
  opts.forbidden = opts.forbidden and selection_of(where, opts.forbidden, mesh)
  local cuts = core.cuts(part)
  opts.cuts, opts.cut_words = cuts and covered and cuts:union(covered) or cuts or covered, cut_words(part, covered)
  return basis_of(opts, mesh, opts.friction, opts.friction_facets)
end

--- The same without friction, for the screening.
function load_limits.without_friction(mesh, opts, basis)
  if basis.directions == 1 then return basis end
  return basis_of(opts, mesh)
end

--- Whether bonds, attachments or couplings join a part, or it is a sector.
function load_limits.is_joined(part)
  return #part.bonds + #part.attachments + #part.couplings > 0 or part.cyclic_symmetry ~= nil
end

--- The equations of a part, ready for many right-hand sides.
function load_limits.system(part, solver)
  if load_limits.is_joined(part) then return core.joined_system(part, {solver = solver}) end
  return part:system {solver = solver}
end

--- By how much the pyramid in Coulomb's cone may be narrower than the cone, as a fraction.
function load_limits.friction_error(opts)
  return opts.friction > 0 and 1 - math.cos(math.pi / opts.friction_facets) or 0
end

--- What of the admissible loads belongs into a sentence about the answer; "" for pressure alone.
function load_limits.describe(opts)
  local cuts = opts.cuts and ("; no pressure on %s of %s"):format(core.quantity(opts.cuts.area, "m2"),
    opts.cut_words) or ""
  local hands = cuts .. (opts.hands and ("; %d hand%s of %s"):format(opts.hands, opts.hands == 1 and "" or "s",
    core.quantity(opts.hand, "m2")) or "")
  if opts.friction == 0 then return hands end
  return ("%s; friction %s, the cone by %d facets (%s narrower at most)"):format(hands,
    shown.number(opts.friction), opts.friction_facets, shown.error(load_limits.friction_error(opts)))
end

--- What the upper bound bounds where that is not the largest stress of the loads asked for, or nil. Hands are left
--- out of it, which enlarges the set of loads; the pyramid of friction lies in Coulomb's cone, which is larger.
function load_limits.bounded(opts)
  local words = {}
  if opts.hands then words[#words + 1] = "for pressure anywhere instead of within hands" end
  if opts.friction > 0 then
    words[#words + 1] = ("for friction of the pyramid, %s less than Coulomb's at most"):format(
      shown.error(load_limits.friction_error(opts)))
  end
  return #words > 0 and table.concat(words, ", ") or nil
end

--- What the engine's linear programs take.
function load_limits.linear_program(opts)
  return {pressure = opts.pressure, force = opts.force, force_is_max = opts.force_is_max, lp = opts.lp,
    hands = opts.hands, hand_area = opts.hands and opts.hand}
end

return load_limits
