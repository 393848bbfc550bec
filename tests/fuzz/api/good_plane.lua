-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Good arguments (see good.lua) of outlines, plane meshes, and analyses whose outline is dragged.
local bw = require "barwright"
local good = require "good_lists"

local add, alike, pair, path = good.add, good.alike, good.pair, good.path

-- ---- outlines -----------------------------------------------------------------------------------

local function handle(_, r)
  return r:one_of {{vertex = r:integer(4)}, {edge = r:integer(4)}, {loop = 1}}, {0.02 * (r:uniform() - 0.5),
    0.02 * (r:uniform() - 0.5)}
end
local small_hole = {{0.45, 0.2}, {0.55, 0.2}, {0.5, 0.3}}
alike([[Outline:moved SteadySheet:drag LargeDeflectionSheet:drag
  TransientSheet:drag Metallophone:drag Flow:drag ThermalFlow:drag
  Bridge:drag]], handle)
alike("Outline:hole Outline:region", function(_, r)
  return r:one_of {small_hole, bw.outline.circle {radius = 0.05, centre = {0.5, 0.25}}} end)
alike("Outline:edges", function(_, r) return r:one_of {1, {1, 2}, {edges = {1}}, {near = {0, 0}, radius = 0.1},
  {loop = 1},
  {box = {{-1, -1}, {2, 2}}}} end)
add {
  ["bw.outline()"] = function() return {points = {{0, 0}, {1, 0}, {{1, 0.3}, {0.6, 0.6}, {0, 0.5}}}, name = "a",
    tags = {low = {1}}, holes = {}} end,
  ["bw.outline.rectangle"] = function(_, r) return {width = 2, height = 1, centre = pair(r), radius = 0.1,
    tags = {low = 1}} end,
  ["bw.outline.circle"] = function() return {radius = 1, centre = {0, 0}, tag = "rim"} end,
  ["bw.outline.ellipse"] = function() return {radii = {1, 2}, angle = 30} end,
  ["bw.outline.polygon"] = function() return {points = {{0, 0}, {1, 0}, {1, 1}}, name = "tri"} end,
  ["bw.outline.rounded"] = function(_, r) return {points = {{0, 0}, {1, 0}, {1, 1}}, radius = r:one_of {0.1,
    {0.1, 0.05, 0.1}}} end,
  ["bw.outline.read"] = function(_, r) return "good." .. r:one_of {"svg", "dxf"}, {unit = "mm",
    tolerance = 1e-4} end,
  ["Outline:write"] = function(_, r) return path {"svg", "dxf"} (r) end,
  ["Outline:picture"] = function() return "out.png", {width = 64, height = 64, numbers = true} end,
  ["Outline:weights"] = function() return {vertex = 1} end,
  ["Outline:with_points"] = function(p) return p.Outline.points end,
  ["Outline:same_topology"] = function(p) return p:variant("bw.Outline", 4) end,
  ["Outline:with_loop"] = function() return {{0.4, 0.2}, {0.6, 0.2}, {0.5, 0.3}}, {{1, 0, 0, 2, 1}, {2, 0, 0, 3,
    1}, {3, 0, 0, 1, 1}},
    {count = 3, region = 0, name = "new"} end,
  ["Outline:without"] = function(_, r) return r:one_of {1, 2, "hole"} end,
  ["Outline:smooth"] = function(_, r) return {loop = 1, strength = r:uniform(), rounds = r:integer(3),
    corner = 60} end,
  ["Outline:pull"] = function(_, r) return r:integer(4), {0.01, 0.01}, {pins = {3}, reach = 1} end,
  ["Outline:split"] = function(_, r) return r:integer(4), r:uniform() end,
  ["Outline:join"] = function(_, r) return r:integer(4) end,
  ["Outline:tag"] = function(_, r) return "new", r:one_of {1, {1, 2}, {loop = 1}} end,
  ["Outline:with_tag"] = function() return "new", {1, 2} end,
  ["Outline:shifted"] = function(_, r) return pair(r) end,
  ["Outline:rotated"] = function(_, r) return 90 * r:uniform(), pair(r) end,
  ["Outline:scaled"] = function(_, r) return r:one_of {2, {1, 2}}, pair(r) end,
  ["Outline:measure"] = function() return 1 end,
  ["Outline:loop"] = function() return 1 end,
  ["Outline:edge"] = function() return 1 end,
  ["Outline:at"] = function(_, r) return 1, r:uniform() end,
  ["Outline:nearest"] = function(_, r) return pair(r) end,
  ["Outline:edge_distance"] = function(_, r) return 1, pair(r) end,
  ["Outline:polygons"] = function() return 1e-2 end,
}

-- ---- analyses whose outline is dragged ----------------------------------------------------------

local function sheet(more)
  return function(p, r)
    local opts = {outline = p.Outline, material = bw.material.steel, thickness = 0.01,
      elements = 10 + r:integer(10), order = r:integer(2),
      conditions = {left = "fixed", right = {traction = {0, -1e5}}, top = {pressure = "x"}}, gravity = {0,
        -9.81},
      follow = {relocation = "springs"}, max_lag = 3,
      solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-8}}
    for key, value in pairs(more) do opts[key] = value end
    return opts
  end
end
local function flow(more)
  return function(p)
    local opts = {outline = p.Outline, viscosity = 0.1, elements = 20, step = 0.02,
      conditions = {left = {x = "4*y", y = 0}, top = "wall", bottom = "wall", right = {pressure = 0}}}
    for key, value in pairs(more) do opts[key] = value end
    return opts
  end
end
alike("bw.responsive.steady", sheet {})
alike("bw.responsive.cantilever", sheet {newton = {iterations = 20, load_steps = 2}})
alike("bw.responsive.vibration", sheet {ground = "left", ground_motion = {x = "0.01*sin(t)"}, step = 0.01,
  damping = {0.1, 0},
  conditions = {}})
alike("bw.responsive.flow", flow {bdf = 2, ale = true})
alike("bw.responsive.thermal", flow {diffusivity = 0.1, expansion = 0.01, conditions = {left = {x = 1, y = 0,
  temperature = 1},
  top = "wall", bottom = {x = 0, y = 0, convection = {coefficient = 1, temperature = 3}}}})
alike([[SteadySheet:become LargeDeflectionSheet:become TransientSheet:become Flow:become
  ThermalFlow:become]], function(p)
  return p:variant("bw.Outline", 4) end)
alike("Sheet:follow FlowBody:follow", function(p) return {}, p:variant("bw.Outline", 4) end)
alike("Sheet:static Sheet:large_deflection", function(_, r)
  return {}, {method = r:one_of {"auto", "full"}}, {} end)
alike("SteadySheet:stress_norm Sheet:stress_norm", function(_, r) return 1 + 10 * r:uniform() end)
alike("Metallophone:tone Metallophone:gains Plate:tone Plate:gains", function() return {seconds = 0.01,
  rate = 8000, at = {0.1, 0.015}} end)
alike([[Metallophone:gradient Metallophone:mode Metallophone:inplane Plate:mode Plate:gradient
  Plate:nodal_lines Plate:inplane]],  function() return 1 end)
alike("Flow:force ThermalFlow:force ThermalFlow:heat FlowBody:force FlowBody:heat", function(_, r)
  return r:one_of {"top", "left", "bottom"} end)
alike("Flow:coefficients ThermalFlow:coefficients", function() return "top", {velocity = 1, length = 0.1} end)
alike("ThermalFlow:nusselt", function() return "bottom", 2 end)
alike("Flow:at ThermalFlow:at FlowBody:at", function(_, r) return r:uniform(), r:uniform() / 2 end)
alike("Flow:pressure_drop ThermalFlow:pressure_drop", function(_, r) return pair(r), pair(r) end)
alike("Flow:record ThermalFlow:record", function() return "lift", function(f) return f:force "top" end end)
alike("Flow:frequency ThermalFlow:frequency", function() return "lift", 2 end)
alike("Flow:pace ThermalFlow:pace", function() return 0.01 end)
alike("Flow:step ThermalFlow:step TransientSheet:step SolidTransient:step", function(_, r) return r:integer(3) end)
add {
  ["bw.responsive.metallophone"] = function() return {outline = bw.outline.rectangle {width = 0.2,
    height = 0.03}, material = bw.material.aluminium,
    thickness = 0.004, elements = 12, modes = 2} end,
  ["bw.responsive.bridge"] = function(_, r) return {span = 0.2, load = 100, stress_limit = 30e6,
    material = bw.material.pla, thickness = 0.004,
    size = 0.02, wall = 0.01, start = r:one_of {"truss", "gable", "beam", "arch"}} end,
  ["Sheet:transient"] = function(_, r) return {}, {}, {step = 0.01, beta = 0.25, gamma = 0.5}, r:integer(3) end,
  ["Sheet:restore"] = function(p) return (p.Sheet:save()) end,
  ["Metallophone:become"] = function(_, r) return (bw.outline.rectangle {min = {0, 0}, max = {0.2,
    0.03 + 0.001 * r:uniform()}}) end,
  ["Metallophone:write_tone"] = function() return "out.wav", {seconds = 0.01, rate = 8000} end,
  ["Metallophone:tune"] = function(p) return p.Metallophone.frequency * 1.01, {finer = 1} end,
  ["Metallophone:trim"] = function(p) return p.Metallophone.frequency * 0.99, p.Metallophone.frequency,
    {places = 2, width = 0.002} end,
  ["Plate:follow"] = function() return {}, (bw.outline.rectangle {min = {0, 0}, max = {0.2, 0.031}}) end,
  ["Plate:solve"] = function(_, r) return {}, {modes = r:integer(3), tolerance = 1e-6} end,
  ["Bridge:pull"] = function(p, r) return r:integer(p.Bridge.outline.edge_count), {0.05, 0.02},
    {reach = 0.05} end,
  ["Bridge:smooth"] = function() return {strength = 0.2, rounds = 1} end,
  ["Bridge:hole"] = function() return {0.05, 0.03}, 0.005 end,
  ["Bridge:without"] = function() return 2 end,
  ["Bridge:become"] = function(p) return p.Bridge.outline end,
  ["Bridge:check"] = function() return 0.02, 1 end,
  ["Bridge:design"] = function() return {starts = {"beam"}, rounds = 1, holes = 0, polish = 0} end,
  ["Bridge:picture"] = function(_, r) return path {"svg", "png"} (r) end,
  ["FlowBody:step"] = function(_, r) return {}, {}, {step = 0.01, bdf = 1, iterations = 1}, r:integer(2) end,
  ["FlowBody:restore"] = function(p) return p.BodyState end,
}

-- ---- plane meshes -------------------------------------------------------------------------------

add {
  ["bw.plane.fill"] = function(p, r) return p:get("bw.Outline", r), {elements = 10 + r:integer(10),
    order = r:integer(2),
    field = r:chance(0.2) and "0.1 + x" or nil} end,
  ["bw.plane.new"] = function() return {points = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}, elements = {{1, 2, 3}, {2, 4,
    3}}, regions = {1, 1}} end,
  ["bw.plane.rectangle"] = function(_, r) return {min = {0, 0}, max = {1, 1}, cells = {2, 2},
    order = r:integer(2),
    diagonal = r:one_of {"left", "right", "union jack"}} end,
  ["bw.plane.mesh_motion"] = function(p, r) return p:variant("bw.PlaneMesh", 2), {
    relocation = r:one_of {"harmonic", "springs"}, rounds = 2,
    force = r:one_of {"relocation", "reconnecting", "reconstruction"}} end,
  ["PlaneMesh:moved"] = function(p) local m = p:variant("bw.PlaneMesh", 1) return m.outline, m.points end,
  ["PlaneMesh:transfer"] = function(p) return p:variant("bw.PlaneMesh", 2), bw.array.zeros(p.PlaneMesh.node_count,
    2) end,
  ["PlaneMesh:locate"] = function(_, r) return pair(r) end,
  ["PlaneMesh:shares"] = function(p, r) return p:get("bw.PlaneMesh", r) end,
  ["PlaneMesh:write"] = function(p) return "out.vtu", {fields = {a = bw.array.range(1,
    p.PlaneMesh.node_count)}} end,
  ["MeshMotion:follow"] = function(p, r) return r:one_of {p:variant("bw.Outline", 4),
    (assert(p.Outline:moved({vertex = 3}, {0.02, 0.02})))} end,
  ["MeshMotion:pull_back"] = function(p) return bw.array.zeros(p.MeshMotion.mesh.node_count, 2) end,
}
