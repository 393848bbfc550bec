-- SPDX-License-Identifier: MIT
-- Lesson 19: eight elements in one, by lookup.
--   build/barwright examples/19_coarse_by_lookup.lua [FOLDER]
--
-- Layers of soft and hard rubber, one element thick, make a bar. A grid of elements twice as large has
-- both in each element. What such an element should do is computed once for all mixtures, and looked up.
local bw = require "barwright"
local folder = arg and arg[1] or os.tmpname() .. "_coarse"

-- 1. The materials, and a library for all blocks of 2 x 2 x 2 of them. With `voids` (the default), more
-- directions, a third material it is built once for a night's work, and kept.
local results = assert(bw.results.open(folder, {script = "examples/19_coarse_by_lookup.lua"}))
local materials = {
  bw.hyperelastic {name = "soft", young = 1e5, poisson = 0.45, density = 1000},
  bw.hyperelastic {name = "hard", young = 5e6, poisson = 0.45, density = 1000},
}
local library = assert(bw.metamaterial.build(materials, {voids = false, directions = 30, magnitudes = 2,
  stretches = 100}))
print(library)
assert(library:write(results:path "two.bwm"))
library = assert(bw.metamaterial.read(results:path "two.bwm"))

-- 2. The bar, fine.
local H = 0.01
local grid = assert(bw.grid.box {cells = {8, 24, 8}, spacing = H,
  material = function(_, y) return math.floor(y / H) % 2 + 1 end})
local fine = assert(bw.solid {grid = grid, materials = materials})
fine:fix {side = "min y"}
fine:force({side = "max y"}, {0, 0, -20})
local clock = os.clock()
local reference = assert(fine:solve())
local spent = os.clock() - clock
print(("fine: %d elements, %.2f s"):format(fine.element_count, spent))

-- 3. The same bar with an eighth of the elements: by the library, and naively, where each point of an
-- element has the material that was there. That is far too stiff: it cannot deform where it is soft.
-- choose = false: the library answers for itself. Without it the naive solid is solved as well, and
-- answers where it is estimated to be nearer to the fine one.
local panels = {reference:panel("fine", "movement")}
for _, by in ipairs {library, "naive"} do
  local coarse = assert(fine:coarsen(by))
  clock = os.clock()
  local result = assert(coarse:solve {choose = false})
  local title = by == library and "lookup" or by
  print(("%s: %d elements, %.1f times faster, mean error %.1f %% of the displacement"):format(title,
    coarse.element_count, spent / (os.clock() - clock), 100 * result:error(reference)))
  panels[#panels + 1] = result:panel(title, "movement")
end

-- 4. An edit of the materials looks up only what it touches.
local coarse = assert(fine:coarsen(library))
local edited = assert(coarse:with(assert(grid:set({max = {1, 0.06, 1}}, 1))))
print(("edited: %d of %d blocks looked up"):format(edited.coarse.looked_up, edited.element_count))

assert(bw.grid.picture(results:path "bars.png", panels, {up = {0, 0, 1}, unit = "movement, mm",
  scale = 1e3, min = 0, ghost = true, columns = 3, width = 420, height = 360}))
print("wrote " .. folder)
