-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the engine's tests of nonlinear solids print.
local bw = require "barwright"
local engine = require "engine"

local scenario = bw.scenario

scenario.about {title = "Nonlinear solids",
  text = [[Theory: [data_driven.md](theory/data_driven.md). These figures come from the engine's tests, which
check more than can be a row. Grids are the only meshes of nonlinear solids: bodies with other sides lie in
cells that count by the part inside.]]}

local function program(name, title, about)
  scenario(title, {about = about, tags = {"slow"}, seconds = 1800}, function(t) engine.run(t, name) end)
end

program("convergence_test_hex8", "Elements", "Hexahedra with eight nodes and 2 × 2 × 2 points at finite strain: "
  .. "patch tests, and manufactured solutions with the body forces that each law asks for.")
program("nonlinear_test_closed_forms", "Laws", "Whole solids pulled with free sides, sheared, and pressed by a "
  .. "pressure that follows.")
program("nonlinear_test_hex8_calculix", "CalculiX", "Displacements under tiny loads, where every law is linear. "
  .. "CalculiX prints seven digits. Not there where it is not installed.")
program("nonlinear_test_beams", "Slender solids", "Rods that are one row of cells, ν = 0. An element of length l "
  .. "and depth t resists bending too much, by the factor 1 + (G / E)(l / t)²: the error falls with order 2.")
program("nonlinear_test_embedded", "Cut cells", "Cook's membrane at finite strain, plane strain by holding z, "
  .. "beside quadratic elements along its sides; and a hollow sphere under a pressure inside that follows, beside "
  .. "the solution of its equation. Their sides are not the grid's.")
program("nonlinear_test_transient", "Transient dynamics",
  "Implicit Euler's method and Newmark's average acceleration.")
