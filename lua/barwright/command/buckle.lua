-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright buckle MODEL: how many times the load may grow before the part buckles.
local bw = require "barwright"
local core = require "barwright.core"
local buckle_page = require "barwright.command.buckle_page"
local buckle_worst = require "barwright.command.buckle_worst"
local loads_of = require "barwright.command.loads"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

-- One mesh leaves at least this open, beside the error of the shapes: that of the stress.
local MIN_ERROR = 0.02

local function analyse(opts, loads, out)
  if opts.threads then bw.threads(opts.threads) end
  local mesh, read, why = model.body(opts, out)
  if not mesh then return nil, read, why end
  local part, message, details = model.part(read, mesh, opts)
  if part then part, message, details = loads_of.set_up(part, opts, loads, out) end
  if not part then return nil, message, details end
  out:json {supported_area_m2 = message}
  local static, buckling, errors
  static, message, details = model.try(part.solve, part, {solver = bw.solver.cholesky()})
  if static then
    buckling, message, details = model.try(static.buckling, static, {count = opts.count, sign = opts.sign})
  end
  out:warnings()
  if not buckling then return nil, message, details end
  errors, message, details = buckling:error_estimate()
  if not errors then return nil, message, details end
  return {static = static, buckling = buckling, errors = errors:totable(), made = read.made,
    governing = made_of.governing(read.made, part, static.utilisation)}
end

local load_words = {positive = "this load", negative = "the reversed load",
  either = "this load or the reversed one"}

-- The verdict on the loads of the wanted sign, and its words. The first factor is the smallest in size; without a
-- count a smaller one may be missing.
local function judge(buckling, errors, sign)
  local size, error = buckling.searched, MIN_ERROR
  if buckling.count > 0 then
    size, error = math.abs(buckling.factors[1]), math.max(errors[1], MIN_ERROR)
    if size < 1 then return "buckles", "the part buckles under " .. load_words[sign] end
  elseif not buckling.counted then
    return "unsure", "no load factor was found, and none was excluded"
  end
  if size * (1 - error) > 1 and not buckling.counted then
    return "unsure", "it is not certain that the part does not buckle, as the load factors could not be counted"
  end
  if size * (1 - error) > 1 then return "holds", "the part does not buckle under " .. load_words[sign] end
  return "unsure", "the error leaves open whether the part buckles"
end

local function report(found, loads, opts, out)
  local buckling, errors, factors = found.buckling, found.errors, found.buckling.factors:totable()
  local verdict, words = judge(buckling, errors, opts.sign)
  local governing = found.governing
  if verdict == "holds" and governing and governing.used > 1 then
    verdict, words = "unsure", "the part does not buckle, and the material may fail under the load itself"
  end
  out:say("")
  local say, sentences = out:recorded()
  if #factors == 0 then
    say("There is no load factor of the wanted sign to %s times the load.", shown.number(buckling.searched))
  else
    say("It buckles at these multiples of the load%s:", opts.sign == "positive" and ""
      or " (negative: of the reversed load)")
  end
  for i, factor in ipairs(factors) do
    say("  %2d. %10s, about %s too large in size", i, shown.number(factor), shown.error(errors[i]))
  end
  say("With these errors, or %s where that is more, %s.", shown.error(MIN_ERROR), words)
  local used
  if governing and buckling.factor then
    used = governing.used * buckling.factor
    if used > 1 then
      say("The stress at the first factor is %s of the strength of %s, error unknown: the material may fail "
        .. "before.", shown.percent(used), made_of.governing_text(governing))
    end
  end
  say(buckling.counted and "A count of the load factors confirms that none is missing."
    or "Not counted: a smaller factor may be missing.")
  say "Linear theory: loads keep their directions, and shape and supports are perfect."
  out:json {verdict = verdict, load_factors = bw.json.list(factors), load_factor = buckling.factor,
    errors = bw.json.list(errors), counted = buckling.counted, searched = buckling.searched,
    utilisation_at_factor = used, governing_region = used and governing.region, fix = bw.json.list(opts.fix),
    solver = buckling.report.solver}
  local material, mass = page_head.part(found.made, opts, out)
  local head = buckle_page.head(verdict, factors[1], math.max(errors[1] or 0, MIN_ERROR), {
    {"Loads", loads_of.text(loads)}, page_head.constrained(opts.fix, out.object.supported_area_m2), material,
    mass},
    {searched = buckling.searched, counted = buckling.counted,
      used = factors[1] == buckling.factor and used or nil,
      now = governing and governing.used, asked = "this load"})
  return head, words, sentences
end

local function title(opts, words) return ("%s: %s"):format(model.name(opts.model), words) end

local function run_worst(opts, out)
  local worst, worst_made, details = buckle_worst.analyse(opts, out)
  if not worst then return out:fail(worst_made, details) end -- a message
  local verdict, words, sentences = buckle_worst.report(worst, opts, MIN_ERROR, out)
  if (opts.picture or opts.vtu or opts.report) and not worst.factor then
    out:say "No file is written, since no load was found."
  end
  local failed = out:write_files {{worst.factor and opts.vtu, function() return worst:write(opts.vtu) end},
    {worst.factor and opts.picture, function() return buckle_worst.picture(worst, opts, opts.picture) end},
    {worst.factor and opts.report, function()
      local displacement, message, more = worst:displacement()
      if not displacement then return nil, message, more end
      local load = {name = "pressure of the load", unit = "MPa", values = worst:pressure(), scale = 1e-6,
        displacement = displacement, arrows = worst:arrows()}
      local area = out.object.supported_area_m2
      local material, mass = page_head.part(worst_made, opts, out)
      local head = buckle_page.head(verdict, worst.factor, math.max(worst.mesh_error or 0, MIN_ERROR), {
        {"Force", core.quantity(opts.worst, "N")}, {"Contact, at least", core.quantity(opts.contact, "m2")},
        page_head.constrained(opts.fix, area), material, mass},
        {counted = worst.counted, asked = "this force, by the load that was found",
          found = "The search is heuristic: another load may buckle the part sooner."})
      return buckle_page.write(opts.report, title(opts, words), head, worst.buckling, load, sentences,
        function(name) return buckle_worst.picture(worst, opts, name) end)
    end}}
  if failed then return failed end
  return 1 -- a search proves that a part buckles, never that it does not
end

local options = {
  made_of.option,
  {name = "count", value = "N", type = "integer", default = 4, min = 1, max = 500, what = "how many factors"},
  {name = "sign", value = "positive|negative|either", type = "string", default = "positive",
    one_of = {"positive", "negative", "either"},
    what = "factors of the load as it is, of the reversed load, or the nearest to zero"},
  model.fix_option,
  loads_of.options.force,
  loads_of.options.pressure,
  loads_of.options.gravity,
  model.unit_option,
  model.elements_option,
  {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2},
    what = "linear or quadratic elements; linear ones are too stiff, and their factors too large"},
  {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
    what = "write a page with a 3D view of the shapes"},
  {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
    what = "write the shapes, for ParaView"},
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
    what = "a picture of the first shape"},
  model.threads_option,
}
for i, option in ipairs(buckle_worst.options) do table.insert(options, 7 + i, option) end

return {
  summary = "how many times a load may grow before the part buckles",
  about = "Constrains a part at places, applies loads at others, and finds the load factors of linear buckling. A "
    .. "surface is repaired where it must be and filled with tetrahedra. With --worst no load must be known: the "
    .. "load that buckles the part first is searched for.\n\n" .. places.help .. "\n\n"
    .. output.codes("it does not buckle", "it buckles, or that is not certain, as always with --worst where no "
      .. "load that buckles it is found"),
  arguments = {model.body_argument},
  options = options,
  examples = {"barwright buckle strut.stl --fix min:z --force max:z=0,0,-50 --material steel",
    {"barwright buckle shelf.stl --fix min:x --pressure max:z=2kPa --sign either --count 10",
      "of both directions"},
    {"barwright buckle strut.stl --fix min:z --forbid min:z --worst 50N", "by the load that does it first"}},
  run = function(opts, out)
    local misuse = buckle_worst.misuse(opts)
    if misuse then return out:misuse(misuse) end
    if opts.worst then return run_worst(opts, out) end
    local loads, message = loads_of.read(opts, "gravity")
    if not loads then return out:misuse(message) end
    local found, why, details = analyse(opts, loads, out)
    if not found then return out:fail(why, details) end
    local head, words, sentences = report(found, loads, opts, out)
    local buckling, static = found.buckling, found.static
    if opts.picture and buckling.count == 0 then out:say "No picture is written, since no shape was found." end
    local failed = out:write_files {{opts.vtu, function() return buckling:write(opts.vtu) end},
      {buckling.count > 0 and opts.picture, function() return buckling:picture(1, opts.picture) end},
      {opts.report, function()
        local load = {name = "von Mises stress under the load", unit = "MPa", values = static.von_mises,
          scale = 1e-6, displacement = static.displacement}
        return buckle_page.write(opts.report, title(opts, words), head, buckling, load, sentences,
          function(name) return static:picture(name) end)
      end}}
    if failed then return failed end
    return head.verdict == "holds" and 0 or 1
  end,
}
