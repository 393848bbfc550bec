-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scale as one page: outlines with their modes, nodal lines and screws, the table, the sounds.
local core = require "barwright.core"
local html = require "barwright.html"

local page = {}

local WIDTH = 460 -- of a picture, in pixels

local STYLE <const> = [[
figure { display: inline-block; margin: .5em; vertical-align: top } svg { background: #fafafa }
]]

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
  local scale = WIDTH / (box.max[1] - box.min[1])
  local margin = 8
  local height = (box.max[2] - box.min[2]) * scale
  local function x(value) return (value - box.min[1]) * scale + margin end
  local function y(value) return (box.max[2] - value) * scale + margin end
  local head = '<svg xmlns="http://www.w3.org/2000/svg" width="%.0f" height="%.0f" role="img" aria-label="%s">'
  local out = {head:format(
    WIDTH + 2 * margin, height + 2 * margin, html.escape(name))}
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
  local rows, figures = {}, {}
  for _, made in ipairs(result.bars) do
    if made.cents then
      local p, bar = made.paper or {}, bars[#rows + 1]
      rows[#rows + 1] = {made.note, ("%.2f"):format(made.target_hz), ("%.2f"):format(made.before_hz),
        ("%.2f"):format(made.simulated_hz), ("%+.2f"):format(made.cents), ("%.2f"):format(1e3 * made.moved_m),
        p.target or "", p.simulated or "", p.measured or "", p.adjusted or ""}
      local name, box = html.escape(made.note), bar.outline.box
      figures[#figures + 1] = ("<figure>%s<figcaption>%s, %.2f Hz, %.0f mm long<br>"
        .. '<audio controls src="%s.wav"></audio></figcaption></figure>'):format(page.picture(bar, made.note),
        name, made.simulated_hz, 1e3 * (box.max[1] - box.min[1]), name)
    end
  end
  local about = ("Outline: %s, %s, %.1f mm thick. Tuned with the holes for the screws in place. Colour: "
    .. "deflection of the lowest mode; lines: where it is at rest; circles: screws."):format(result.shape,
    result.material, 1e3 * result.thickness_m)
  return core.write_file(path, html.document {title = "Metallophone", style = STYLE,
    body = "<p>" .. html.escape(about) .. "</p>\n" .. html.table({"note", "target, Hz", "before", "tuned",
      "cents", "outline moved, mm", "paper: target", "simulated", "measured", "adjusted"}, rows, "numbers")
      .. table.concat(figures, "\n")})
end

return page
