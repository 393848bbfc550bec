-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Modes by each of the eigensolvers in one run, on the same factors: seconds, processor seconds, right-hand sides,
-- and how far the eigenvalues are from those of the first. The row "factor" has the assembly and the factor that
-- Lanczos and ARPACK share. LOBPCG works without one, on a model of its own.
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local options = require "options"
local distance = require "barwright.points".distance
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the eigensolvers beside each other",
  about = "Prints a Markdown table. A BODY is block:N (free cube of N x N x N cells of six tet10), bar:N (8N x N "
    .. "x N cells, fixed at one end), or the path of a surface, which is scaled to 100 mm and filled with tet10.",
  arguments = {{name = "body", many = true, optional = true,
    what = "what to solve (default block:4 block:8 block:12 block:19)"}},
  options = {
    {name = "count", value = "N", type = "integer", default = 15, min = 1, max = 500, what = "number of modes"},
    {name = "repeats", value = "N", type = "integer", default = 3, min = 1, max = 100,
      what = "runs of each solver, in turn; the fastest counts"},
    {name = "solvers", value = "NAME,NAME,...", list = true, default = {"lanczos", "arpack", "lobpcg"},
      what = "what to compare, by the names of bw.eigensolver"},
    {name = "sturm", type = "flag", what = "count the eigenvalues as well"},
    options.elements(20000),
  },
}

local function model(text)
  local shape, cells = text:match "^(%a+):(%d+)$"
  local mesh
  if shape == "block" or shape == "bar" then
    local long = shape == "bar" and 8 or 1
    cells = tonumber(cells)
    mesh = assert(bw.mesh.box {max = {long, 1, 1}, cells = {long * cells, cells, cells}, order = 2})
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    return shape == "bar" and part:fix(mesh.boundary:below(1, 0)) or part
  end
  local surface = assert(bw.surface.read(text))
  surface = surface:scale(0.1 / distance(surface.box.min, surface.box.max))
  mesh = assert(bw.mesh.fill(surface, {elements = opts.elements, order = 2}))
  return bw.model {mesh = mesh, material = bw.material.steel}
end

local function processor()
  local fields = {}
  for field in io.open "/proc/self/stat":read "a":match "%) (.*)":gmatch "%S+" do fields[#fields + 1] = field end
  return (tonumber(fields[12]) + tonumber(fields[13])) / 100
end

local needs_factor = false
for _, name in ipairs(opts.solvers) do needs_factor = needs_factor or name ~= "lobpcg" end

print("| body | tet10 | unknowns | solver | seconds | processor seconds | right-hand sides | residual "
  .. "| difference |")
print "|---|---|---|---|---|---|---|---|---|"
for _, text in ipairs(#opts.body > 0 and opts.body or {"block:4", "block:8", "block:12", "block:19"}) do
  local part, without_factor = model(text), model(text)
  local seconds, spent = bw.seconds(), processor()
  local system = needs_factor and assert(part:system())
  if system then
    print(("| %s | %d | %d | factor | %.3f | %.2f | | | |"):format(text:match "[^/]+$", part.mesh.element_count,
      3 * part.mesh.node_count, bw.seconds() - seconds, processor() - spent))
  end
  local best, modes = {}, {}
  for _ = 1, opts.repeats do
    for _, name in ipairs(opts.solvers) do
      local what = name == "lobpcg" and without_factor or system
      seconds, spent = bw.seconds(), processor()
      modes[name] = assert(what:modes {count = opts.count, sturm = opts.sturm, solver = bw.eigensolver[name] {}})
      seconds, spent = bw.seconds() - seconds, processor() - spent
      if not best[name] or seconds < best[name][1] then best[name] = {seconds, spent} end
    end
  end
  for _, name in ipairs(opts.solvers) do
    local found, first = modes[name], modes[opts.solvers[1]]
    local difference = 0
    for i = 1, found.count do
      difference = math.max(difference, math.abs(found.eigenvalues(i, 1) / first.eigenvalues(i, 1) - 1))
    end
    print(("| %s | %d | %d | %s | %.3f | %.2f | %d | %.1e | %.1e |"):format(text:match "[^/]+$",
      part.mesh.element_count, 3 * part.mesh.node_count, name, best[name][1], best[name][2], found.solves,
      found.report.residual, difference))
  end
  if system then system:close() end
end
