-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The drag of the paper responsive (figure 2: a hole taken from left to right, 159 frames) replayed
-- with elastic sheets, a vibrating plate, and flow and heat around the hole, beside its tables 2 and 3:
-- how often each level of reuse ran, what a frame of each costs and in which part, frames per second with
-- reuse and without (everything computed again in every frame), median and slowest hundredth. Seconds of the
-- clock, and of the processor (all threads), which is what to trust on a busy machine.
local bw = require "barwright"

local paper = {
  levels = {relocation = 117, reconnecting = 39, reconstruction = 3},
  vibration = {elements = 1962, reuse = 105.0, rebuilt = 41.8},
  cantilever = {elements = 990, reuse = 37.6, rebuilt = 7.1},
  flow = {elements = 1971, reuse = 30.0, rebuilt = 18.2},
  thermal = {elements = 1938, reuse = 21.3, rebuilt = 14.3},
}

package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local script = require "barwright.command.script"

local opts = script.read {
  summary = "a hole dragged through sheets, plates and flows, beside tables 2 and 3 of the paper responsive",
  options = {script.option.out,
    {name = "frames", value = "N", type = "integer", default = 159, min = 1, what = "frames of the drag"},
    {name = "only", value = "NAME", one_of = {"vibration", "cantilever", "flow", "thermal", "metallophone",
      "steady"}, what = "only this application"},
    {name = "paper", type = "flag", what = "the paper's numbers of elements alone"},
  },
}
local frames = opts.frames

local results = opts.out and assert(bw.results.open(opts.out, {script = "scripts/bench/responsive.lua",
  options = {frames = frames, only = opts.only, paper = opts.paper}}))

local rubber = bw.material.isotropic {name = "rubber", young = 5e6, poisson = 0.3, density = 1000}

local function plate()
  return assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
    tags = {left = 4, right = 2, bottom = 1, top = 3},
    holes = {bw.outline.circle {centre = {0.4, 0.5}, radius = 0.2, name = "hole", tag = "hole"}}})
end

local make = {
  vibration = function(options)
    options.ground, options.ground_motion, options.step = "bottom", {x = "0.01*sin(60*t)"}, 2e-3
    return bw.responsive.vibration(options)
  end,
  cantilever = function(options)
    options.conditions, options.gravity = {left = "fixed"}, {0, -9.81}
    return bw.responsive.cantilever(options)
  end,
  flow = function(options) -- Reynolds number 200
    options.material, options.viscosity, options.step = nil, 2e-3, 0.02
    options.conditions = {left = {x = 1, y = 0}, bottom = {y = 0}, top = {y = 0}, hole = "wall"}
    return bw.responsive.flow(options)
  end,
  thermal = function(options) -- Rayleigh number 1e6
    local cold = {x = 0, y = 0, temperature = 0}
    options.material, options.viscosity, options.diffusivity, options.step = nil, 1e-3, 1e-3, 0.05
    options.gravity, options.expansion = {0, -1}, 1
    options.conditions = {bottom = {x = 0, y = 0, temperature = 1}, left = cold, right = cold, top = cold,
      hole = "wall"}
    return bw.responsive.thermal(options)
  end,
  metallophone = function(options) -- the lowest mode; "rebuilt" begins with the mode before, on a new factor
    options.solver, options.thickness = nil, 0.02
    return bw.responsive.metallophone(options)
  end,
  steady = function(options)
    options.conditions = {left = "fixed", right = {traction = {0, -1e3}}}
    return bw.responsive.steady(options)
  end,
}

-- The value below which a fraction of the list lies.
local function quantile(list, fraction)
  if #list == 0 then return 0 / 0 end
  local sorted = table.move(list, 1, #list, 1, {})
  table.sort(sorted)
  return sorted[math.max(1, math.ceil(fraction * #sorted))]
end

local parts = {"mesh", "assemble", "factor", "solve"}
local marches = {vibration = true, flow = true, thermal = true}

-- A factor from scratch for each solution.
local full = bw.solver.cholesky {full = true}
local full_lu = bw.solver.lu {full = true}

local function replay(name, elements, rebuilt)
  local unsymmetric = name == "flow" or name == "thermal"
  local sheet = assert(make[name] {outline = plate(), material = rubber, elements = elements,
    follow = rebuilt and {level = "reconstruction"} or {},
    solver = not rebuilt and "auto" or unsymmetric and full_lu or full})
  local clock, processor, levels, iterations, factors = {}, {}, {}, 0, 0
  local made = sheet.element_count
  -- what is rebuilt costs the same however far the hole has moved: fewer frames do
  local count = rebuilt and math.max(frames // 10, 10) or frames
  for _ = 1, count do
    collectgarbage()
    local start, cpu = bw.seconds(), os.clock()
    assert(sheet:drag({loop = "hole"}, {1.2 / count, 0}))
    if marches[name] then assert(sheet:step()) end
    clock[#clock + 1], processor[#processor + 1] = bw.seconds() - start, os.clock() - cpu
    local reused = sheet.reused
    local level = levels[reused.level] or {clock = {}, processor = {}}
    levels[reused.level] = level
    table.insert(level.clock, clock[#clock])
    table.insert(level.processor, processor[#processor])
    for _, part in ipairs(parts) do
      level[part] = level[part] or {}
      table.insert(level[part], reused["seconds_" .. part])
    end
    iterations, factors = iterations + reused.iterations, factors + reused.factorisations
  end
  local total, passed = 0, 0
  for i, t in ipairs(processor) do total, passed = total + t, passed + clock[i] end
  local out = {application = name, elements = made, rebuilt = rebuilt or false, frames = count,
    frames_per_second = 1 / quantile(clock, 0.5), slowest_hundredth_per_second = 1 / quantile(clock, 0.99),
    frames_per_second_processor = 1 / quantile(processor, 0.5),
    slowest_hundredth_per_second_processor = 1 / quantile(processor, 0.99),
    mean_per_second = count / passed, mean_per_second_processor = count / total,
    iterations_per_frame = iterations / count, factorisations = factors,
    levels = {}}
  for level, seen in pairs(levels) do
    local row = {count = #seen.clock, seconds = quantile(seen.clock, 0.5),
      seconds_processor = quantile(seen.processor, 0.5)}
    for _, part in ipairs(parts) do row["seconds_" .. part] = quantile(seen[part], 0.5) end
    out.levels[level] = row
  end
  return out
end

local runs = {{"vibration", 1962}, {"cantilever", 990}, {"flow", 1971}, {"thermal", 1938},
  {"metallophone", 600}, {"metallophone", 2000}, {"vibration", 20000}, {"steady", 20000}}
local rows = bw.json.list {}
for _, run in ipairs(runs) do
  local name, elements = run[1], run[2]
  local as_printed = paper[name] and paper[name].elements == elements
  if (not opts.only or opts.only == name) and (as_printed or not opts.paper) then
    local reuse, rebuilt = replay(name, elements), replay(name, elements, true)
    rows[#rows + 1] = reuse
    rows[#rows + 1] = rebuilt
    print(("\n%s, %d triangles"):format(name, reuse.elements))
    print "  level            frames | ms a frame (processor) |  mesh  assemble  factor   solve"
    for _, level in ipairs {"none", "relocation", "reconnecting", "reconstruction"} do
      local row = reuse.levels[level]
      if row then
        print(("  %-14s %5d%s | %8.2f (%.2f) | %6.2f %8.2f %8.2f %8.2f"):format(level, row.count,
          paper.levels[level] and (" (%d)"):format(paper.levels[level]) or "", 1e3 * row.seconds,
          1e3 * row.seconds_processor, 1e3 * row.seconds_mesh, 1e3 * row.seconds_assemble,
          1e3 * row.seconds_factor, 1e3 * row.seconds_solve))
      end
    end
    local function say(what, row, published)
      print(("  %-8s %7.1f frames/s, slowest hundredth %7.1f; processor %7.1f, %7.1f, mean %.1f%s"):format(what,
        row.frames_per_second, row.slowest_hundredth_per_second, row.frames_per_second_processor,
        row.slowest_hundredth_per_second_processor, row.mean_per_second_processor,
        published and (" (paper: %.1f)"):format(published) or ""))
    end
    local published = as_printed and paper[name] or {}
    say("reuse", reuse, published.reuse)
    say("rebuilt", rebuilt, published.rebuilt)
    print(("  gain of reuse %.1f%s; %.1f iterations and %.2f factorisations a frame"):format(
      reuse.mean_per_second_processor / rebuilt.mean_per_second_processor,
      published.rebuilt and (" (paper: %.1f)"):format(published.reuse / published.rebuilt) or "",
      reuse.iterations_per_frame, reuse.factorisations / frames))
  end
end
if results then assert(results:write {frames = frames, runs = rows}) end
