-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Coarse solids of random test geometries: bars whose materials, holes and loads come from numbers drawn
-- by a seed, fine, naive, by a library, and by that library grown for the bar.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local compare = require "compare"
local core = require "barwright.core"
local scenes = require "scenes"
local script = require "barwright.command.script"

local H, CELLS = 0.01, {8, 24, 8} -- m, a cell
local MOVEMENT = 0.03             -- mean, over the length

local opts = script.read {
  summary = "coarse solids of bars of random materials, holes and loads",
  about = "Prints a line for each body and level; then the median and the worst of naive errors over those of "
    .. "lookup. Without a library the grown one begins from nothing.\n\n"
    .. "Exit status: 0 done; 1 a body has no fine solution; 2 the input was refused.",
  options = {
    {name = "bodies", value = "N", type = "integer", default = 12, min = 1, what = "number of bodies"},
    {name = "first", value = "SEED", type = "integer", default = 1, min = 1, what = "seed of the first one"},
    scenes.option.library, scenes.option.directions(40), script.option.json, script.option.threads,
  },
}

-- Numbers from 0 to 1 (splitmix64).
local function generator(seed)
  local state = seed * 0x632be59bd9b4e019
  return function()
    state = state + 0x9e3779b97f4a7c15
    local z = (state ~ state >> 30) * 0xbf58476d1ce4e5b9
    z = (z ~ z >> 27) * 0x94d049bb133111eb
    return ((z ~ z >> 31) >> 11) * 2.0 ^ -53
  end
end

local function whole(draw, min, max) return min + math.floor(draw() * (max - min + 1)) end

local function direction(draw)
  while true do
    local x, y, z = 2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1
    local r = math.sqrt(x * x + y * y + z * z)
    if r > 0.1 and r <= 1 then return x / r, y / r, z / r end
  end
end

-- Each gives words and a function of a cell's place (in cells) to a material.
local kinds = {}

function kinds.patches(draw)
  local size, of = whole(draw, 1, 3), {}
  return ("patches of %d"):format(size), function(x, y, z)
    local key = (x // size) + 100 * (y // size) + 10000 * (z // size)
    of[key] = of[key] or whole(draw, 1, 3)
    return of[key]
  end
end

function kinds.layers(draw)
  local a, b, c = direction(draw)
  local thick, first = 1 + 3 * draw(), whole(draw, 0, 2)
  return ("layers of %.1f along (%.1f, %.1f, %.1f)"):format(thick, a, b, c), function(x, y, z)
    return (math.floor((a * x + b * y + c * z) / thick) + first) % 3 + 1
  end
end

function kinds.balls(draw)
  local matrix, ball = whole(draw, 1, 3), {}
  local count = whole(draw, 6, 14)
  for k = 1, count do
    ball[k] = {draw() * CELLS[1], draw() * CELLS[2], draw() * CELLS[3], 1 + 2.5 * draw(), whole(draw, 1, 3)}
  end
  return ("%d balls in %d"):format(count, matrix), function(x, y, z)
    for _, b in ipairs(ball) do
      if (x - b[1]) ^ 2 + (y - b[2]) ^ 2 + (z - b[3]) ^ 2 < b[4] ^ 2 then return b[5] end
    end
    return matrix
  end
end

-- Half of the bars have holes, away from their ends.
local function with_holes(draw, material)
  local hole = {}
  for k = 1, draw() < 0.5 and whole(draw, 1, 4) or 0 do
    hole[k] = {draw() * CELLS[1], 5 + draw() * (CELLS[2] - 10), draw() * CELLS[3], 1 + 1.5 * draw()}
  end
  return #hole, function(x, y, z)
    for _, b in ipairs(hole) do
      if (x - b[1]) ^ 2 + (y - b[2]) ^ 2 + (z - b[3]) ^ 2 < b[4] ^ 2 then return 0 end
    end
    return material(x, y, z)
  end
end

local function body(seed)
  local draw = generator(seed)
  local names = {"patches", "layers", "balls"}
  local words, material = kinds[names[whole(draw, 1, 3)]](draw)
  local holes
  holes, material = with_holes(draw, material)
  local grid = assert(bw.grid.box {cells = CELLS, spacing = H, material = function(x, y, z)
    return material(x / H, y / H, z / H)
  end})
  local a, b, c = direction(draw)
  return {grid = grid, pull = {a, b, c}, words = ("%s, %d holes, end pushed along (%.1f, %.1f, %.1f)"):format(
    words, holes, a, b, c)}
end

-- Held at one end, a force on the other that moves it by about MOVEMENT in linear elasticity.
local function solid_of(it)
  local function loaded(force)
    local solid = assert(bw.solid {grid = it.grid, materials = scenes.materials()})
    solid:fix {side = "min y"}
    local p = it.pull
    return solid:force({side = "max y"}, {force * p[1], force * p[2], force * p[3]})
  end
  local small = assert(loaded(1e-6):solve {solver = bw.solver.cholesky()})
  return loaded(1e-6 * MOVEMENT / compare.movement(small))
end

local general = opts.library and assert(bw.metamaterial.read(opts.library))
local rows, ratios, status, spent = bw.json.list {}, {}, 0, {fine = 0, growing = 0, blocks = 0}

local function ratio_of(method, level, value)
  local key = method .. " " .. level
  ratios[key] = ratios[key] or {}
  table.insert(ratios[key], value)
end

for seed = opts.first, opts.first + opts.bodies - 1 do
  local it = body(seed)
  local fine = solid_of(it)
  local took, reference, message = compare.timed(fine.solve, fine, {solver = bw.solver.cholesky()})
  print(("body %d: %s"):format(seed, it.words))
  if not reference then
    print("  no fine solution: " .. message)
    status = 1
  else
    spent.fine = spent.fine + took.processor
    local grown
    took, grown = compare.timed(bw.metamaterial.grow, general or scenes.materials(), it.grid,
      general and {levels = 2} or {levels = 2, directions = opts.directions})
    assert(grown)
    spent.growing, spent.blocks = spent.growing + took.processor, spent.blocks + grown.grown[1] + grown.grown[2]
    for level = 1, 2 do
      local row = {seed = seed, level = level, movement = compare.movement(reference)}
      local line = ("  level %d, moved %.1e:"):format(level, row.movement)
      for _, method in ipairs {"naive", "library", "grown"} do
        local by = ({naive = "naive", library = general, grown = grown})[method]
        if by == "naive" or by and by.levels >= level then
          local coarse, solution
          coarse = assert(fine:coarsen(by, level))
          solution, message = coarse:solve {choose = false}
          row[method] = solution and select(2, solution:error(reference)) or nil
          line = line .. ("  %s %s"):format(method, solution and ("%.2e"):format(row[method]) or message)
          if solution and method ~= "naive" and row.naive then
            ratio_of(method, level, row.naive / row[method])
          end
        end
      end
      print(line)
      rows[#rows + 1] = row
    end
  end
  io.stdout:flush()
end

local summary = {}
for _, key in ipairs {"library 1", "library 2", "grown 1", "grown 2"} do
  local list = ratios[key]
  if list then
    table.sort(list)
    local n = #list
    local median = n % 2 == 1 and list[n // 2 + 1] or 0.5 * (list[n // 2] + list[n // 2 + 1])
    summary[key] = {median = median, worst = list[1], best = list[n], bodies = n}
    print(("naive error over that of %s: median %.1f, worst %.1f, best %.0f, %d bodies"):format(
      (key:gsub(" ", ", level ")), median, list[1], list[n], n))
  end
end
print(("fine solutions took %.1f s of the processor, growing %.1f s for %d blocks"):format(spent.fine,
  spent.growing, spent.blocks))
if opts.json then
  assert(core.write_file(opts.json, bw.json.encode {rows = rows, summary = summary, seconds = spent}))
end
os.exit(status, true)
