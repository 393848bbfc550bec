-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pictures for the gallery: those of docs/images, whose makers are scripts/docs/*, and what the lessons draw.
local bw = require "barwright"
local escape = require "barwright.html".escape

local gallery = {}

-- docs/images: what made it, what it shows.
local kept = {
  ["foal.png"] = {"scripts/demo", "A toy foal, coloured by how highly each place can be stressed"},
  ["worst_foal.png"] = {"scripts/demo", "The foal, with a cross where it breaks and arrows for the push"},
  ["edit.png"] = {"scripts/docs/edit_picture.lua", "A horse as drawn, and grazing on legs made strong enough"},
  ["metallophone.svg"] = {"scripts/docs/metallophone_picture.lua", "Bars tuned to C, E and G, with their modes"},
  ["coarse.png"] = {"scripts/docs/coarse_picture.lua", "A layered bar, bent: fine, looked up, and without"},
  ["plots.png"] = {"scripts/docs/plots_picture.lua", "Plots of a study"},
  ["selections.png"] = {"scripts/docs/loads_picture.lua", "Six selections on the boundary of a bracket"},
  ["supports.png"] = {"scripts/docs/loads_picture.lua", "A bracket under three kinds of supports"},
  ["loads.png"] = {"scripts/docs/loads_picture.lua", "A bracket under six kinds of loads"},
  ["validity_deformation.svg"] = {"scripts/docs/validity_picture.lua", "Where linear theory ends"},
  ["validity_failure.svg"] = {"scripts/docs/validity_picture.lua", "Two failure criteria in plane stress"},
  ["validity_intervals.svg"] = {"scripts/docs/validity_picture.lua", "Intervals of breaking forces"},
  ["validity_loads.svg"] = {"scripts/docs/validity_picture.lua", "Which loads are searched"},
  ["validity_material.svg"] = {"scripts/docs/validity_picture.lua",
    "Young's modulus by direction, with its scatter"},
  ["validity_mean.svg"] = {"scripts/docs/validity_picture.lua", "Stress near a re-entrant edge, and its mean"},
}

local quoted = require "barwright.scenario.files".quoted

local function files(folder)
  local out, pipe = {}, assert(io.popen("ls " .. quoted(folder) .. " 2>/dev/null"))
  for line in pipe:lines() do out[#out + 1] = line end
  pipe:close()
  return out
end

local function copy(from, to)
  return os.execute(("cp %s %s"):format(quoted(from), quoted(to)))
end

-- Runs a lesson in a folder of its own; its pictures and pages go to examples/.
local function run(root, out, lesson, pictures)
  local name = lesson.path:match "([^/]*)%.lua$"
  local words = lesson.number and "" or " --quick"
  local folder = out .. "/run/" .. name
  os.execute("mkdir -p " .. quoted(folder))
  local command = ("%s/build/barwright %s %s%s >%s 2>&1"):format(quoted(root), quoted(lesson.path), quoted(folder),
    words, quoted(folder .. "/said.txt"))
  if not os.execute(command) then
    io.stderr:write(("site: %s failed; see %s/said.txt\n"):format(lesson.path, folder))
    return
  end
  for _, file in ipairs(files(folder)) do
    local kind = file:match "%.(%a+)$"
    local to = ("examples/%s_%s"):format(name, file)
    if (kind == "png" or kind == "svg" or kind == "html") and copy(folder .. "/" .. file, out .. "/" .. to) then
      local picture = {file = to, caption = lesson.title, lesson = lesson, page = kind == "html"}
      pictures[#pictures + 1] = picture
      if kind ~= "html" then
        pictures[lesson.path] = pictures[lesson.path] or {}
        table.insert(pictures[lesson.path], picture)
      end
    end
  end
end

--- The pictures: a list, and by path of a lesson the list of its own.
function gallery.make(root, out, run_lessons, all_lessons)
  local pictures = {}
  for _, file in ipairs(files(root .. "/docs/images")) do
    assert(copy(root .. "/docs/images/" .. file, out .. "/docs/images/" .. file))
    local about = kept[file]
    if about then
      pictures[#pictures + 1] = {file = "docs/images/" .. file, caption = about[2], made = about[1]}
    end
  end
  if run_lessons then
    for k, lesson in ipairs(all_lessons) do
      local start = bw.seconds()
      run(root, out, lesson, pictures)
      print(("%s, %d of %d: %.0f s"):format(lesson.path, k, #all_lessons, bw.seconds() - start))
    end
    os.execute("rm -rf " .. quoted(out .. "/run"))
  end
  return pictures
end

--- The gallery's page.
function gallery.html(pictures)
  local out = {"<h1>Gallery</h1><p>Every picture here was made by the script named under it.</p>",
    '<div class="tiles">'}
  for _, picture in ipairs(pictures) do
    local source = picture.lesson
      and ('<a href="%s">%s</a>'):format(picture.lesson.page.address,
        picture.lesson.number and "lesson " .. picture.lesson.number or "study")
      or "<code>" .. picture.made .. "</code>"
    if not picture.page then
      out[#out + 1] = ('<figure><a href="%s"><img src="%s" alt="%s" loading="lazy"></a><figcaption>%s (%s)'
        .. "</figcaption></figure>"):format(picture.file, picture.file, escape(picture.caption),
        escape(picture.caption), source)
    end
  end
  out[#out + 1] = "</div>"
  local reports = {}
  for _, picture in ipairs(pictures) do
    if picture.page then
      reports[#reports + 1] = ('<li><a href="%s">%s</a></li>'):format(picture.file,
        escape(picture.caption))
    end
  end
  if #reports > 0 then
    out[#out + 1] = "<h2>Reports to turn and click</h2><ul>" .. table.concat(reports) .. "</ul>"
  end
  return table.concat(out, "\n")
end

return gallery
