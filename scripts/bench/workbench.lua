-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Opens files in the workbench as a person would: the largest face is constrained, the face farthest from it is
-- loaded with a force, and the answer is asked for. Prints processor times to the first scene and to the answer.
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local bw = require "barwright"
local script = require "barwright.command.script"
local workbench = require "barwright.workbench"
local frame = require "barwright.workbench.frame"
local prepare = require "workbench_case"

local opts = script.read {
  summary = "opens files in the workbench, with times",
  about = "Constrains the largest face of each file, loads the face farthest from it with 10 N along -z, and "
    .. "answers. A file without units is confirmed in millimetres, or the first likely unit.",
  arguments = {{name = "files", type = "file", many = true, what = "models"}},
  options = {{name = "accuracy", value = "WORD", default = "default", one_of = {"coarse", "default", "fine"},
    what = "of the answer"}},
}

local function run(path)
  local start, row = os.clock(), {file = path:match "[^/]+$"}
  local bench, message = workbench.read(path)
  if not bench then row.refused = message return row end
  frame.raw(bench.source.read.surface, 0)
  row.seconds_scene, row.triangles = os.clock() - start, bench.source.read.surface.triangle_count
  local ok
  ok, message = bench:prepare()
  row.seconds_faces = os.clock() - start
  if not ok then row.refused = message return row end
  local far, why, count = prepare(bench)
  row.faces = far and why or count
  if not far then row.refused = why return row end
  local answer
  answer, message = bench:answer {accuracy = opts.accuracy}
  row.seconds_answer = os.clock() - start
  if answer then row.answer, row.verdict = answer.sentence, answer.verdict else row.refused = message end
  return row
end

local rows = {}
for i, path in ipairs(opts.files) do
  local ok, row = pcall(run, path)
  if not ok then row = {file = path:match "[^/]+$", fault = tostring(row)} end
  rows[i] = row
  print(("%-34s %8s %6s %7s %7s %7s  %s"):format(row.file, row.triangles or "-", row.faces or "-",
    row.seconds_scene and ("%.2f"):format(row.seconds_scene) or "-",
    row.seconds_faces and ("%.2f"):format(row.seconds_faces) or "-",
    row.seconds_answer and ("%.2f"):format(row.seconds_answer) or "-",
    row.fault and "FAULT " .. row.fault or row.answer or "refused: " .. tostring(row.refused)))
  io.stdout:flush()
  collectgarbage()
end
print(bw.json.encode {rows = bw.json.list(rows)})
