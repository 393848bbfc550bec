-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright modes MODEL: natural frequencies and modes, free or constrained.
local bw = require "barwright"
local core = require "barwright.core"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local modes_page = require "barwright.command.modes_page"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local pitch = require "barwright.pitch"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

local function analyse(opts, out)
  if opts.threads then bw.threads(opts.threads) end
  local mesh, read, why = model.body(opts.error and model.first_mesh(opts) or opts, out)
  if not mesh then return nil, read, why end
  local part, message, details = model.part(read, mesh, opts)
  if not part then return nil, message, details end
  local fixed = 0
  for _, place in ipairs(opts.fix) do
    local selection
    selection, message, details = places.select(mesh, place)
    if not selection then return nil, message, details end
    fixed = fixed + selection.area
    local ok
    ok, message = model.try(part.fix, part, selection)
    if not ok then return nil, place .. ": " .. message, {status = "invalid"} end
  end
  local modes, accuracy
  local how = {count = opts.count, sturm = opts.sure}
  if opts.solver ~= "auto" then how.solver = bw.eigensolver[opts.solver] {} end
  if opts.error then model.refined(read, opts, mesh, how) end
  modes, accuracy, details = model.try(part.modes, part, how)
  out:warnings()
  if not modes then return nil, accuracy, details end
  local errors
  errors, message, details = modes:error_estimate()
  if not errors then return nil, message, details end
  local about = {fixed = fixed, fix = opts.fix, part = {page_head.part(read.made, opts, out)}}
  return modes, about, errors:totable(), accuracy
end

local function report(modes, fixed, errors, accuracy, opts, out)
  if accuracy then model.report_accuracy(accuracy, out) end
  out:say("")
  local sentences = out:record() -- for the page as well
  if #opts.fix > 0 then
    out:say("Constrained at %s (%s), natural frequencies are:", table.concat(opts.fix, " and "),
      core.quantity(fixed, "m2"))
  else
    out:say("Without supports, its natural frequencies are (%d rigid-body modes are left out):", modes.rigid_count)
  end
  local list, cents_of = bw.json.list {}, bw.json.list(errors)
  for i, frequency in ipairs(modes.frequencies:totable()) do
    local note, cents = pitch.note(frequency)
    list[i] = frequency
    out:say("  %2d  %10s Hz   %-4s %+3.0f cents, about %s too high", i, shown.number(frequency), note, cents,
      shown.cents(errors[i]))
  end
  out:say("The mesh makes frequencies too high; the estimate is in cents, a hundredth of a semitone.")
  if accuracy then
    local cents = 1200 * math.log(1 + accuracy.estimated_error, 2)
    out:say("With what the last refinement changed, every frequency is within %s.", shown.cents(cents))
    out:json {estimated_error = accuracy.estimated_error, estimated_error_cents = cents}
  end
  out:json {frequencies_hz = list, error_cents = cents_of, rigid_motions = modes.rigid_count,
    fix = bw.json.list(opts.fix), counted = modes.counted, solver = modes.report.solver}
  if opts.sure then
    out:say(modes.counted and "A count of the eigenvalues confirms that none below the last is missing."
      or modes.tested and "No mode below the last was found from random vectors, which is no proof."
      or "The count of the eigenvalues could not confirm that none is missing.")
  end
  return sentences
end

return {
  summary = "natural frequencies and modes of a part",
  about = "The lowest modes of vibration of a part, free or constrained, with the nearest note to each. A "
    .. "surface is repaired where it must be and filled with tetrahedra.\n\n" .. places.help .. "\n\n"
    .. output.codes "done",
  arguments = {model.body_argument},
  options = {
    made_of.option,
    {name = "count", value = "N", type = "integer", default = 6, min = 1, max = 500, what = "how many"},
    model.fix_option,
    model.unit_option,
    model.elements_option,
    {name = "error", value = "FRACTION", type = "number", above = 0, max = 1,
      what = "refine until the estimated error of every frequency is this fraction, 0.02 (34 cents), say, or "
        .. "the mesh has ten times the elements; the first mesh has a quarter of them"},
    {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2},
      what = "linear or quadratic elements; linear ones are too stiff, and their frequencies too high"},
    {name = "solver", value = "NAME", type = "string", default = "auto",
      one_of = {"auto", "lanczos", "arpack", "lobpcg", "slepc"},
      what = "the eigensolver: block Lanczos, ARPACK, LOBPCG without a factor, or SLEPc over the processes of "
        .. "mpirun"},
    {name = "sure", type = "flag", what = "count the eigenvalues, so that none is missing (twice the time)"},
    {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
      what = "write a page with a 3D view of the shapes"},
    {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
      what = "write the shapes, for ParaView"},
    {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
      what = "a picture of the first shape"},
    model.threads_option,
  },
  examples = {"barwright modes bar.stl --material aluminium",
    {"barwright modes fork.stl --fix min:z --fix near:0,0,30mm:5mm --count 10",
      "constrained at its foot and at a point"}},
  run = function(opts, out)
    for _, place in ipairs(opts.fix) do
      local ok, message = places.check(place)
      if not ok then return out:misuse("option --fix: " .. message) end
    end
    local modes, about, errors, accuracy = analyse(opts, out)
    if not modes then return out:fail(about, errors) end -- a message and its details
    local sentences = report(modes, about.fixed, errors, accuracy, opts, out)
    local failed = out:write_files {{opts.vtu, function() return modes:write(opts.vtu) end},
      {opts.picture, function() return modes:picture(1, opts.picture) end},
      {opts.report, function()
        return modes_page.write(modes, opts.report, {title = "Natural frequencies of " .. model.name(opts.model),
          head = modes_page.head(modes, errors, about), answer = output.sentences(sentences)})
      end}}
    if failed then return failed end
  end,
}
