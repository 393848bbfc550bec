-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scale as one page: outlines with their modes, nodal lines and screws, the table, the sounds.
local core = require "barwright.core"
local report = require "barwright.report"

local page = {}

local WIDTH = 460 -- of a picture, in pixels

local style = [[
body{font:15px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse}td,th{padding:.25em .8em;text-align:right;border-bottom:1px solid #ddd}
figure{display:inline-block;margin:.5em;vertical-align:top}svg{background:#fafafa}
figcaption{font-size:13px;color:#555}]]

-- Blue below, white at rest, red above.
local function colour(value)
  local v = math.max(-1, math.min(1, value))
  local fade = math.floor(255 * (1 - math.abs(v)) + 0.5)
  if v >= 0 then return ("#ff%02x%02x"):format(fade, fade) end
  return ("#%02x%02xff"):format(fade, fade)
end

--- An <svg> of a bar: deflection of its lowest mode, outline, nodal lines.
function page.picture(bar, name)
  local box = bar.outline.box
  local scale = WIDTH / (box.high[1] - box.low[1])
  local margin = 8
  local height = (box.high[2] - box.low[2]) * scale
  local function x(value) return (value - box.low[1]) * scale + margin end
  local function y(value) return (box.high[2] - value) * scale + margin end
  local head = '<svg xmlns="http://www.w3.org/2000/svg" width="%.0f" height="%.0f" role="img" aria-label="%s">'
  local out = {head:format(
    WIDTH + 2 * margin, height + 2 * margin, report.escape(name))}
  local points, mode = bar.points:totable(), bar:mode(1):totable()
  local largest = 0
  for _, row in ipairs(mode) do largest = math.max(largest, math.abs(row[1])) end
  for _, e in ipairs(bar.elements:totable()) do
    local mean = (mode[e[4]][1] + mode[e[5]][1] + mode[e[6]][1]) / 3 / largest
    local corners = {}
    for _, k in ipairs {1, 4, 2, 5, 3, 6} do
      corners[#corners + 1] = ("%.1f,%.1f"):format(x(points[e[k]][1]), y(points[e[k]][2]))
    end
    local fill = colour(mean)
    out[#out + 1] = ('<polygon points="%s" fill="%s" stroke="%s" stroke-width=".6"/>'):format(
      table.concat(corners, " "), fill, fill)
  end
  for _, loop in ipairs(bar.outline:polygons(1e-5)) do
    local corners = {}
    for _, p in ipairs(loop:totable()) do
      corners[#corners + 1] = ("%.1f,%.1f"):format(x(p[1]), y(p[2]))
    end
    out[#out + 1] = ('<polygon points="%s" fill="none" stroke="#222"/>'):format(
      table.concat(corners, " "))
  end
  for _, l in ipairs(bar.nodal_lines:totable()) do
    out[#out + 1] = ('<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" stroke="#222" stroke-width="1.5"/>')
      :format(x(l[1]), y(l[2]), x(l[3]), y(l[4]))
  end
  out[#out + 1] = "</svg>"
  return table.concat(out, "\n")
end

--- Writes the page of a result, with the bars that were made.
function page.write(path, result, bars)
  local body = {"<!doctype html><meta charset=utf-8><title>Metallophone</title><style>", style,
    "</style><h1>Metallophone</h1><p>Outline: ", report.escape(result.shape), ", ",
    report.escape(result.material), (", %.1f mm thick. "):format(1e3 * result.thickness_m),
    "Tuned with the holes for the screws in place. Colour: deflection of the lowest mode; lines: where it "
    .. "is at rest; circles: screws.</p>"}
  local done = {}
  for _, made in ipairs(result.bars) do
    if made.cents then done[#done + 1] = made end
  end
  body[#body + 1] = "<table><tr><th>note<th>target Hz<th>before<th>tuned<th>cents<th>outline moved mm"
    .. "<th>paper: target<th>simulated<th>measured<th>adjusted</tr>"
  for _, made in ipairs(done) do
    local p = made.paper or {}
    body[#body + 1] = ("<tr><td>%s<td>%.2f<td>%.2f<td>%.2f<td>%+.2f<td>%.2f<td>%s<td>%s<td>%s<td>%s</tr>")
      :format(report.escape(made.note), made.target_hz, made.before_hz, made.simulated_hz,
        made.cents, 1e3 * made.moved_m,
        p.target or "",
        p.simulated or "", p.measured or "", p.adjusted or "")
  end
  body[#body + 1] = "</table>"
  for k, made in ipairs(done) do
    body[#body + 1] = ("<figure>%s<figcaption>%s, %.2f Hz, %.0f mm long<br>"
      .. "<audio controls src=\"%s.wav\"></audio></figcaption></figure>")
      :format(page.picture(bars[k], made.note), report.escape(made.note), made.simulated_hz,
        1e3 * (bars[k].outline.box.high[1] - bars[k].outline.box.low[1]), report.escape(made.note))
  end
  return core.write_file(path, table.concat(body))
end

return page
