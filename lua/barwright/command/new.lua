-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright new KIND [FILE]: a commented script to begin from.
local core = require "barwright.core"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local skeletons = require "barwright.command.skeletons"

local KINDS <const> = {"part", "scenario", "study", "experiment"}

-- A text of a skeleton for a file, which it names so.
local function filled(text, path, file)
  local names = {FILE = file, NAME = (model.name(path):gsub("%.lua$", ""))}
  return (text:gsub("%f[%w]%u%u%u%u%f[%W]", names))
end

local function list_of_kinds()
  local texts = {}
  for i, kind in ipairs(KINDS) do texts[i] = ("  %-11s %s"):format(kind, skeletons[kind].summary) end
  return table.concat(texts, "\n")
end

return {
  summary = "a commented script to begin from: a part, a scenario, a study or an experiment",
  about = "Writes a small script that runs as it is. A file that is there already is never written over.\n\n"
    .. list_of_kinds() .. "\n\n" .. output.codes "done",
  arguments = {{name = "kind", one_of = KINDS, what = "what it is"},
    {name = "file", type = "file", optional = true, what = "where it goes, FILE.lua; left out: KIND.lua"}},
  examples = {"barwright new part bracket.lua", {"barwright new scenario && barwright test scenario.lua",
    "requirements that are met"}},
  run = function(opts, out)
    local path, skeleton = opts.file or opts.kind .. ".lua", skeletons[opts.kind]
    if not path:find "[^/]%.lua$" then
      return out:misuse(("FILE: a name that ends in .lua expected, got '%s'"):format(path))
    end
    if not model.name(path):find "^[%w_.-]+$" then
      return out:misuse(("FILE: a name of letters, digits and _ . - expected, got '%s'"):format(model.name(path)))
    end
    local there <close> = io.open(path, "rb")
    if there then
      return out:fail(path .. ": it is there already, and is not written over: give another FILE",
        {status = "misuse"})
    end
    local ok, message, details = core.write_file(path, filled(skeleton.text, path, model.name(path)))
    if not ok then return out:fail(message, details) end
    out:say("Written: %s, %s.", path, skeleton.summary)
    local words = {}
    for i, text in ipairs(skeleton.next) do words[i] = "`" .. filled(text, path, path) .. "`" end
    out:say("Next: %s.", table.concat(words, ", then "))
    out:json {kind = opts.kind, file = path}
  end,
}
