-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drags a face of files in the workbench as a person would: the largest face is constrained, the face farthest
-- from it is loaded and then pushed, step by step. Prints processor and elapsed times of the preparation, of the
-- first step and of the later ones, and the coarse stress beside that of the answer after the drag.
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local bw = require "barwright"
local frame = require "barwright.workbench.frame"
local model = require "barwright.command.model"
local prepare = require "workbench_case"
local script = require "barwright.command.script"
local workbench = require "barwright.workbench"

local opts = script.read {
  summary = "drags a face in the workbench, with times",
  about = "Constrains the largest face of each file, loads the face farthest from it with 10 N along -z, and "
    .. "pushes that face in steps. A file without units is confirmed in millimetres, or the first likely unit.",
  arguments = {{name = "files", type = "file", many = true, what = "models"}},
  options = {
    {name = "steps", value = "N", type = "integer", default = 10, min = 2, max = 1000, what = "of each drag"},
    {name = "step", value = "X", type = "number", default = 5e-4, above = 0,
      what = "length of a step, of the diagonal of the part"},
    {name = "unprepared", type = "flag", what = "drag at once, before anything was prepared"},
    {name = "unconverged", type = "flag", what = "no answer after the drag"},
  },
}

-- What a call takes: processor and elapsed time (s), then its results.
local function timed(call, ...)
  local cpu, start = os.clock(), bw.seconds()
  local results = table.pack(call(...))
  return {cpu = os.clock() - cpu, elapsed = bw.seconds() - start}, table.unpack(results, 1, results.n)
end

local function median(list, key)
  local values = {}
  for i, time in ipairs(list) do values[i] = time[key] end
  table.sort(values)
  return values[(#values + 1) // 2]
end

-- A workbench with a constrained and a loaded face, and the loaded one.
local function opened(path)
  local bench = assert(workbench.open(path))
  return bench, assert(prepare(bench))
end

local function push(face, distance)
  return {push = {faces = {face}, distance = distance}}
end

-- One step as the controller does it: the answer and the scene.
local function step(bench, far, distance)
  local answer, static, more = bench:try(push(far, distance))
  if answer and static then frame.result(static, more.labels, 1) end
  return answer, static
end

local function run(path)
  local row = {file = path:match "[^/]+$"}
  local bench, far = opened(path)
  local surface = bench:current().body.surface
  local diagonal = model.diagonal(surface.box)
  row.triangles = surface.triangle_count
  if not opts.unprepared then row.prepared = timed(bench.prepare_drag, bench, push(far, 1e-3)) end
  local later, last = {}, nil
  for i = 1, opts.steps do
    local time, answer, message = timed(step, bench, far, opts.step * i * diagonal)
    if not answer then row.refused = message return row end
    if i == 1 then row.first = time else later[#later + 1] = time end
    last = answer
  end
  row.later = {cpu = median(later, "cpu"), elapsed = median(later, "elapsed")}
  row.elements, row.coarse = last.elements, last.utilisation
  if opts.unconverged then return row end
  local pushed, why = bench:push {faces = {far}, distance = opts.step * opts.steps * diagonal}
  if not pushed then row.refused = why return row end
  local time, answer, message = timed(bench.answer, bench)
  if not answer then row.refused = message return row end
  row.answer_time = time
  row.converged, row.low, row.high = answer.utilisation, answer.low, answer.high
  row.ratio = row.coarse / row.converged
  return row
end

local function ms(time)
  return time and ("%6.0f %6.0f"):format(1e3 * time.cpu, 1e3 * time.elapsed) or "     -      -"
end

local function stresses(row)
  if not row.converged then return ("%.4f"):format(row.coarse) end
  return ("%.4f / %.4f = %.2f (%.4f to %.4f), answer %.1f s"):format(row.coarse, row.converged, row.ratio, row.low,
    row.high, row.answer_time.cpu)
end

print "file                      triangles |  prepare ms | first step ms | later steps ms | coarse / converged"
print "                                    |   cpu  all  |   cpu   all   |   cpu   all    |"
local rows = {}
for i, path in ipairs(opts.files) do
  local ok, row = pcall(run, path)
  if not ok then row = {file = path:match "[^/]+$", fault = tostring(row)} end
  rows[i] = row
  print(("%-26s %8s | %s | %s | %s | %s"):format(row.file, row.triangles or "-", ms(row.prepared), ms(row.first),
    ms(row.later), row.fault or row.refused or stresses(row)))
  io.stdout:flush()
  collectgarbage()
end
print(bw.json.encode {rows = bw.json.list(rows)})
