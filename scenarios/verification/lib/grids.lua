-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Mapped grids for benchmarks: a unit box of tetrahedra sent through a function, with its faces and
-- nodes found again by their places in the unit box. Mid-edge nodes are mapped too: edges are curved.
local bw = require "barwright"

local grids = {}
local Grid = {}
Grid.__index = Grid

local function near(a, b) return math.abs(a - b) < 1e-9 end

--- grid{cells, order, map}: map(u, v, w) gives a place {x, y, z} and keeps orientation.
function grids.mapped(cells, order, map)
  local box = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = cells, order = order}
  local unit, moved = box.nodes:totable(), {}
  for i, p in ipairs(unit) do moved[i] = map(p[1], p[2], p[3]) end
  return setmetatable({unit = unit, mesh = assert(box:moved(moved))}, Grid)
end

--- Several maps of one unit grid, welded where their nodes coincide.
function grids.patches(cells, order, maps)
  local box = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = cells, order = order}
  local unit, elements = box.nodes:totable(), box.elements:totable()
  local nodes, known, all, places = {}, {}, {}, {}
  for _, map in ipairs(maps) do
    local number = {}
    for i, p in ipairs(unit) do
      local x = map(p[1], p[2], p[3])
      local key = ("%.7f %.7f %.7f"):format(x[1] + 0.0, x[2] + 0.0, x[3] + 0.0):gsub("%-(0%.0+)%f[ \0]", "%1")
      if not known[key] then
        nodes[#nodes + 1], places[#places + 1] = x, p
        known[key] = #nodes
      end
      number[i] = known[key]
    end
    for _, e in ipairs(elements) do
      local row = {}
      for k, n in ipairs(e) do row[k] = number[n] end
      all[#all + 1] = row
    end
  end
  local mesh = assert(bw.mesh.new {nodes = nodes, elements = all, order = order})
  return setmetatable({unit = places, mesh = mesh}, Grid)
end

--- Divides the mesh into regions: name(x, y, z), at the mean of an element's corners, is that of its region.
function Grid:divide(name)
  local mesh = self.mesh
  local nodes, tags, names, known = mesh.nodes:totable(), {}, {}, {}
  for e, row in ipairs(mesh.elements:totable()) do
    local x = {0, 0, 0}
    for a = 1, 4 do
      for k = 1, 3 do x[k] = x[k] + nodes[row[a]][k] / 4 end
    end
    local own = name(x[1], x[2], x[3])
    if not known[own] then
      names[#names + 1] = own
      known[own] = #names
    end
    tags[e] = known[own]
  end
  self.mesh = assert(mesh:with_regions(tags, names))
  return self
end

--- The boundary nodes for which test(u, v, w) holds.
function Grid:where(test)
  local mask = {}
  for i, p in ipairs(self.unit) do mask[i] = test(p[1], p[2], p[3]) and 1 or 0 end
  return assert(self.mesh.boundary:where(bw.array.new(mask)))
end

--- The face where coordinate `axis` (1, 2, 3) of the unit box is `value`.
function Grid:face(axis, value)
  return self:where(function(...) return near(select(axis, ...), value) end)
end

--- The number of the node at a place of the unit box.
function Grid:node(u, v, w)
  for i, p in ipairs(self.unit) do
    if near(p[1], u) and near(p[2], v) and near(p[3], w) then return i end
  end
  error(("no node at (%g, %g, %g)"):format(u, v, w))
end

--- The number of the node nearest to a place in space.
function grids.nearest(mesh, at)
  return mesh.boundary:nearest(at, 1).nodes[1]
end

return grids
