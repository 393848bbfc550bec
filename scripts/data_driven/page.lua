-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pictures and HTML reports of the experiments: one for each scene, and one over all that were run into
-- the same folder.
local bw = require "barwright"
local core = require "barwright.core"
local html = require "barwright.html"
local read_file = require "barwright.read_file"

local page = {}

local escape = html.escape

local STYLE <const> = ".numbers th, .numbers td { white-space: nowrap }\n"

local function document(title, body)
  return html.document {title = title, width = 84, style = STYLE,
    body = ("%s<p><small>barwright %s</small></p>\n"):format(body, escape(core.version))}
end

local function table_of(head, rows)
  return html.table(head, rows, "numbers")
end

-- ---- tables --------------------------------------------------------------------------------------

local function find(rows, method, level)
  for _, row in ipairs(rows) do
    if row.method == method and row.level == level then return row end
  end
end

local function seconds(s)
  return s >= 100 and ("%.0f"):format(s) or s >= 1 and ("%.2f"):format(s) or ("%.4f"):format(s)
end

local function judged(text, met)
  return {text, class = met and "good" or "bad"}
end

--- Table 1 of the paper beside ours, one scene or many.
local function table_1(results)
  local rows = {}
  for _, result in ipairs(results) do
    local paper = result.paper or {}
    for i, row in ipairs(result.rows) do
      local fitted = row.method == "lookup" or row.method == "grown"
      local published = (row.method == "fine" or fitted)
        and paper["level_" .. row.level] or nil
      local naive = fitted and find(result.rows, "naive", row.level)
      local cells = {class = i == 1 and "first" or nil, ("%s, %s%s"):format(result.scene, row.method,
        row.level > 0 and (" %d"):format(row.level) or ""), tostring(row.elements)}
      if row.failed then
        cells[#cells + 1] = {"no equilibrium", class = "bad"}
      else
        cells[#cells + 1] = ("%.1f"):format(row.speed_up or 1)
        cells[#cells + 1] = published and ("%.1f"):format(published.speed_up) or ""
        local limit = published and published.seconds_per_iteration / (row.method == "fine" and 5 or 1)
        cells[#cells + 1] = limit and judged(seconds(row.seconds_per_iteration),
          row.seconds_per_iteration <= limit) or seconds(row.seconds_per_iteration)
        cells[#cells + 1] = published and seconds(published.seconds_per_iteration) or ""
        cells[#cells + 1] = tostring(row.iterations)
        cells[#cells + 1] = published and tostring(published.iterations) or ""
        cells[#cells + 1] = not row.error and "" or published
          and judged(("%.2e"):format(row.error), row.error <= published.error)
          or ("%.2e"):format(row.error)
        cells[#cells + 1] = published and published.error and ("%.2e"):format(published.error) or ""
        cells[#cells + 1] = naive and naive.error and ("%.1f"):format(naive.error / row.error) or ""
        cells[#cells + 1] = row.error and ("%.1f %%"):format(100 * row.error / result.rows[1].movement) or ""
      end
      rows[#rows + 1] = cells
    end
  end
  return table_of({"example, method, level", "elements", "faster than fine", "paper", "s / iteration", "paper",
    "iterations", "paper", "error", "paper", "naive / this error", "error of movement"}, rows)
end

local TABLE_1_WORDS = [[<p>Errors are mean distances of the fine grid's nodes over the longest side; the last
column has them in per cent of the fine solution's own mean movement. Seconds are of the processor, all
threads together. Green: the fine grid takes at most a fifth of the paper's seconds for an iteration, coarse
ones at most the paper's; errors are at most the paper's.</p>]]

-- Table 2 of the paper: {quadrature, whole} seconds of an iteration.
local TABLE_2 = {bending = {[0] = {0.11, 0.27}, {0.015, 0.028}, {0.014, 0.015}},
  buckling = {[0] = {1.0, 8.8}, {0.11, 0.28}, {0.10, 0.12}},
  fibers = {[0] = {10.0, 193}, {1.0, 4.9}, {0.68, 0.96}}}

--- Table 2 beside ours; nil when none of its scenes is there.
local function table_2(results)
  local rows = {}
  for _, result in ipairs(results) do
    local published = TABLE_2[result.scene]
    for _, row in ipairs(published and result.rows or {}) do
      if not row.failed and (row.method == "fine" or row.method == "lookup") then
        local p = published[row.level]
        rows[#rows + 1] = {class = row.level == 0 and "first" or nil,
          ("%s, level %d"):format(result.scene, row.level),
          seconds(row.quadrature_fraction * row.seconds_per_iteration), seconds(p[1]),
          seconds(row.seconds_per_iteration), seconds(p[2]),
          ("%.0f %%"):format(100 * row.quadrature_fraction), ("%.0f %%"):format(100 * p[1] / p[2])}
      end
    end
  end
  return #rows > 0 and table_of({"example", "quadrature, s / iteration", "paper", "whole, s / iteration",
    "paper", "quadrature / whole", "paper"}, rows) or nil
end

local function edits_of(result)
  if not result.edits then return "" end
  local rows = {}
  for i, edit in ipairs(result.edits) do
    rows[i] = {edit.words, edit.looked_up and tostring(edit.looked_up) or "",
      edit.seconds_coarsening and ("%.2f"):format(1e3 * edit.seconds_coarsening) or "",
      seconds(edit.seconds_fine), edit.seconds_coarse and seconds(edit.seconds_coarse) or "",
      edit.speed_up and ("%.1f"):format(edit.speed_up) or "",
      edit.error and ("%.2e"):format(edit.error) or "", ("%.2f"):format(1e3 * edit.deepest_m)}
  end
  return "<h2>Edits of the material</h2>" .. table_of({"edit", "blocks looked up", "coarsened in, ms",
    "fine, s", "coarse, s", "times faster", "error", "deepest, mm"}, rows)
end

local function energies_of(motion)
  local rows = {}
  for i, e in ipairs(motion.energies) do
    rows[i] = {("%.3f"):format(e.time_s), ("%.2f"):format(e.kinetic_j), ("%.2f"):format(e.strain_j),
      ("%.2f"):format(e.potential_j), ("%.2f"):format(e.dissipated_j)}
  end
  return table_of({"time, s", "kinetic, J", "strain, J", "of loads, J", "lost, J"}, rows)
end

-- ---- pictures ------------------------------------------------------------------------------------

--- Draws a scene: rest.png, by material, and shapes.png, the solutions beside each other, by how far
--- nodes went.
function page.pictures(out, scene, fine, solutions)
  local up = scene.up or {0, 0, 1}
  local view = {direction = scene.direction, up = up, names = {"soft", "medium", "hard"}}
  view.width, view.height = 640, 480
  local fine_, message, details = fine.grid:picture(out .. "/rest.png", view)
  if not fine_ then return nil, message, details end
  local panels = {}
  for _, method in ipairs {"fine", "lookup", "grown", "naive", "average"} do
    for _, done in ipairs(solutions) do
      local row = done.row
      if done.solution and row.method == method then
        local title = row.level == 0 and "fine" or ("%s, level %d: error %.1e"):format(method, row.level,
          row.error)
        panels[#panels + 1] = done.solution:panel(title, "movement")
      end
    end
  end
  return bw.grid.picture(out .. "/shapes.png", panels, {direction = scene.direction, up = up,
    width = 440, height = 360, columns = math.min(4, math.ceil(#panels / 2)), unit = "movement, mm",
    scale = 1e3, min = 0, ghost = true})
end

-- ---- pages ---------------------------------------------------------------------------------------

local function scene_part(folder, result)
  local parts = {("<p>%s.%s</p>"):format(escape(result.words),
    result.finished and "" or " <b>Not finished: " .. escape(result.message or "interrupted") .. "</b>")}
  if result.growing then
    parts[#parts + 1] = ("<p>The library was grown for this grid: %d blocks, %.1f s of the processor.</p>")
      :format(result.growing.blocks, result.growing.seconds)
  end
  parts[#parts + 1] = html.figure(folder .. "/rest.png", "at rest, by material")
  parts[#parts + 1] = html.figure(folder .. "/shapes.png",
    "deformed, by how far each place went; outline: at rest")
  for i = 1, #(result.edits or {}) do
    parts[#parts + 1] = html.figure(("%s/edit_%d.png"):format(folder, i), result.edits[i].words)
  end
  if result.transient then
    parts[#parts + 1] = html.figure(folder .. "/transient.png", result.transient.words)
  end
  return table.concat(parts)
end

--- The report of one scene, in its folder.
function page.write(folder, result)
  local body = {scene_part(folder, result), "<h2>Beside table 1 of the paper</h2>", table_1 {result},
    TABLE_1_WORDS, edits_of(result)}
  local second = table_2 {result}
  if second then body[#body + 1] = "<h2>Beside table 2</h2>" .. second end
  if result.transient then body[#body + 1] = "<h2>Energies in motion</h2>" .. energies_of(result.transient) end
  return core.write_file(folder .. "/report.html",
    document(("Data-driven: %s"):format(result.scene), table.concat(body)))
end

--- The report over all scenes whose results are in the folder: `order`: their names.
function page.overall(out, order)
  local results = {}
  for _, name in ipairs(order) do
    local text = read_file(("%s/%s/result.json"):format(out, name))
    local result = text and bw.json.decode(text)
    if type(result) == "table" and result.rows and #result.rows > 0 then results[#results + 1] = result end
  end
  local body = {"<h2>Table 1</h2>", table_1(results), TABLE_1_WORDS}
  local second = table_2(results)
  if second then body[#body + 1] = "<h2>Table 2</h2>" .. second end
  for _, result in ipairs(results) do
    body[#body + 1] = ("<h2>%s</h2>"):format(escape(result.scene))
    body[#body + 1] = scene_part(out .. "/" .. result.scene, result)
    body[#body + 1] = edits_of(result)
    if result.transient then body[#body + 1] = energies_of(result.transient) end
  end
  return core.write_file(out .. "/report.html",
    document("Data-driven finite elements: the experiments", table.concat(body)))
end

return page
