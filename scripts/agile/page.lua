-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The report of an edit session: one HTML file with the pictures in it, before and after.
local core = require "barwright.core"
local html = require "barwright.html"

local page = {}

local STYLE <const> = [[
.pair { display: flex; flex-wrap: wrap; gap: 1rem } .pair figure { margin: 0; flex: 1 1 24rem }
.pair img { width: 100% }
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
  local parts = {
    ("<p>%d tetrahedra of order %d, %d bones, %d subdomains of type R with %d elements, %d of type F with %d."
      .. " Limit: %s.</p>"):format(result.elements, scene.mesh.order, result.bones,
      result.subdomains.type_r, result.subdomains.elements_r, result.subdomains.type_f,
      result.subdomains.elements_f, mpa(result.limit_pa)),
    "<h2>Before and after</h2><div class=\"pair\">",
    html.figure(results:path "before.png", ("before: %s at most"):format(mpa(result.before_max_von_mises_pa))),
    found and html.figure(results:path "after.png", ("after: %s at most, same colours"):format(
      mpa(result.after_max_von_mises_pa))) or "", "</div>"}
  if found then
    parts[#parts + 1] = ("<h2>Scaling factors</h2><p>%s Nodes moved by %.3g mm in the mean; %d steps, %d"
      .. " nodes constrained, %.1f s.</p>"):format(found.met and "The limit is met."
        or html.escape(found.message) .. ".", found.mean_move_m * 1e3, found.steps, found.constrained_nodes,
        found.seconds)
    parts[#parts + 1] = html.table({"bone", "across, y", "across, z"}, factors_of(found))
  end
  parts[#parts + 1] = "<h2>Edits</h2>"
  parts[#parts + 1] = html.table({"edit", "largest von Mises stress", "solved in", "reused"}, edits)
  parts[#parts + 1] = "<h2>Loads</h2>"
  parts[#parts + 1] = html.table({"what", "force"}, loads)
  parts[#parts + 1] = ("<p>Estimated error in the energy norm: %.1f %% before%s. barwright %s.</p>")
    :format(100 * result.before_error,
      found and (", %.1f %% after"):format(100 * result.after_error) or "", html.escape(core.version))
  return core.write_file(path, html.document {title = scene.title, body = table.concat(parts), style = STYLE})
end

return page
