-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The report of an edit session: one HTML file with the pictures in it, before and after.
local core = require "barwright.core"

local page = {}

local function escape(text)
  return (tostring(text):gsub("[&<>\"]", {["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;"}))
end

local function image(path, words)
  local file = io.open(path, "rb")
  if not file then return "" end
  local bytes = file:read "a"
  file:close()
  return ('<figure><img alt="%s" src="data:image/png;base64,%s"><figcaption>%s</figcaption></figure>')
    :format(escape(words), core.base64(bytes), escape(words))
end

local function table_of(head, rows)
  local out = {"<table><thead><tr>"}
  for _, cell in ipairs(head) do out[#out + 1] = ("<th>%s</th>"):format(escape(cell)) end
  out[#out + 1] = "</tr></thead><tbody>"
  for _, row in ipairs(rows) do
    out[#out + 1] = "<tr>"
    for _, cell in ipairs(row) do out[#out + 1] = ("<td>%s</td>"):format(escape(cell)) end
    out[#out + 1] = "</tr>"
  end
  out[#out + 1] = "</tbody></table>"
  return table.concat(out)
end

local STYLE = [[
body { font: 16px/1.5 system-ui, sans-serif; color: #1c2430; max-width: 68rem; margin: 2rem auto; padding: 0 1rem }
h1 { margin-bottom: 0 } h2 { margin-top: 2rem }
.pair { display: flex; flex-wrap: wrap; gap: 1rem } figure { margin: 0; flex: 1 1 24rem }
img { width: 100%; border: 1px solid #d8dee8; border-radius: 6px } figcaption { color: #556 }
table { border-collapse: collapse; width: 100% }
th, td { text-align: left; padding: .25rem .6rem; border-bottom: 1px solid #e4e8ef;
  font-variant-numeric: tabular-nums }
]]

local function mpa(pa) return ("%.2f MPa"):format(pa / 1e6) end

local function factors_of(optimisation)
  local names, rows = {}, {}
  for name in pairs(optimisation.factors) do names[#names + 1] = name end
  table.sort(names)
  for i, name in ipairs(names) do
    local f = optimisation.factors[name]
    rows[i] = {name, ("%.3f"):format(f[2]), ("%.3f"):format(f[3])}
  end
  return rows
end

--- Writes the report of a run: a scene and its result, beside the pictures.
function page.write(path, scene, result, results)
  local edits = {}
  for i, row in ipairs(result.edits) do
    if row.refused then
      edits[i] = {row.edit, "refused", ("%.3f s"):format(row.seconds_edit), row.refused}
    else
      edits[i] = {row.edit, mpa(row.max_von_mises_pa), ("%.3f s"):format(row.seconds_solve),
        row.reused.words}
    end
  end
  local found = result.optimisation
  local loads = {}
  for i, load in ipairs(scene.loads) do
    loads[i] = {load.what, ("(%g, %g, %g) N"):format(table.unpack(load.force))}
  end
  local parts = {'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>', escape(scene.title),
    "</title><style>", STYLE, "</style></head><body><h1>", escape(scene.title), "</h1>",
    ("<p>%d tetrahedra of order %d, %d bones, %d subdomains of type R with %d elements, %d of type F with %d."
      .. " Limit: %s.</p>"):format(result.elements, scene.mesh.order, result.bones,
      result.subdomains.type_r, result.subdomains.elements_r, result.subdomains.type_f,
      result.subdomains.elements_f, mpa(result.limit_pa)),
    "<h2>Before and after</h2><div class=pair>",
    image(results:path "before.png", ("before: %s at most"):format(mpa(result.before_max_von_mises_pa))),
    found and image(results:path "after.png", ("after: %s at most, same colours"):format(
      mpa(result.after_max_von_mises_pa))) or "", "</div>"}
  if found then
    parts[#parts + 1] = ("<h2>Scaling factors</h2><p>%s Nodes moved by %.3g mm in the mean; %d steps, %d"
      .. " nodes constrained, %.1f s.</p>"):format(found.met and "The limit is met."
        or escape(found.message) .. ".", found.mean_move_m * 1e3, found.steps, found.constrained_nodes,
        found.seconds)
    parts[#parts + 1] = table_of({"bone", "across, y", "across, z"}, factors_of(found))
  end
  parts[#parts + 1] = "<h2>Edits</h2>"
  parts[#parts + 1] = table_of({"edit", "largest von Mises stress", "solved in", "reused"}, edits)
  parts[#parts + 1] = "<h2>Loads</h2>"
  parts[#parts + 1] = table_of({"what", "force"}, loads)
  parts[#parts + 1] = ("<p>Estimated error in the energy norm: %.1f %% before%s. barwright %s.</p>"
    .. "</body></html>\n")
    :format(100 * result.before_error,
      found and (", %.1f %% after"):format(100 * result.after_error) or "", escape(core.version))
  return core.write_file(path, table.concat(parts))
end

return page
