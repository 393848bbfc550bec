-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The answers of a workbench: a body with supports and loads is solved on meshes and judged as `barwright statics`
-- judges; without loads the breaking force under the worst load is found as `barwright worst` does.
local averaging_radius = require "barwright.averaging_radius"
local body = require "barwright.workbench.body"
local breaking_force = require "barwright.breaking_force"
local core = require "barwright.core"
local facet_error = require "barwright.facet_error"
local growth = require "barwright.singular_growth"
local lengths = require "barwright.command.lengths"
local model = require "barwright.command.model"
local patch_means = require "barwright.command.patch_means"
local shown = require "barwright.shown"

local judge = {}

-- Elements of the accuracies; those of a drag are linear in cost to a tenth of a second.
judge.elements = {drag = 1000, coarse = 3000, default = 20000, fine = 60000}

local colours = {holds = "green", breaks = "red", unsure = "amber"}

local function norm(v)
  return math.sqrt(v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2)
end

-- ---- the part --------------------------------------------------------------------------------------

local function refuse(text)
  return nil, text, {status = "unsupported"}
end

-- Applies a condition to a part; nil and a sentence where it cannot be.
local function apply(self, part, labels, condition)
  if condition.kind == "gravity" then
    if not part.material.density then
      return refuse(("Gravity needs the density of %s: give it with the material."):format(part.material.name))
    end
    return model.try(part.gravity, part, condition.vector)
  end
  local on = body.select(self, part.mesh, labels, condition.faces)
  if condition.kind == "all" then return model.try(part.fix, part, on) end
  if condition.kind == "normal" then return model.try(part.slide, part, on) end
  if condition.kind == "force" then return model.try(part.load, part, {on = on, force = condition.vector}) end
  if condition.kind == "pressure" then return model.try(part.load, part, {on = on, pressure = condition.value}) end
  return model.try(part.couple, part, {on = on, kind = "distributed", moment = condition.vector})
end

-- The size of all loads (N): what the factor of safety multiplies.
local function total(part)
  local sum = 0
  for _, load in ipairs(part.loads) do sum = sum + norm(load.resultant) end
  return sum
end

-- Why nothing can be solved, in a sentence that says what to do; nil where all is well.
local function fault(part, fixed, conditions)
  local covered = 0
  for _, support in ipairs(part.supports) do covered = covered + support.on.area end
  if fixed and covered >= (1 - 1e-9) * part.mesh.boundary.area then
    return "Every face is fixed: no load can stress the part. Press Remove beside the supports of faces that are "
      .. "not screwed or glued."
  end
  local free = part:rigid_modes()
  if fixed and free and #free > 0 and part.mesh.component_count > 1 then
    return ("The file has %d separate bodies, and not all of them are constrained: choose a face of each and "
      .. "press Fix, or join them in the program that made the file."):format(part.mesh.component_count)
  end
  if fixed and free and #free > 0 then
    return ("The supports leave the part free to move: %s. Choose one more face and press Fix."):format(
      free[1].text)
  end
  if fixed then return nil end
  local force, size = {0, 0, 0}, 0
  for _, load in ipairs(part.loads) do
    for k = 1, 3 do force[k] = force[k] + load.resultant[k] end
    size = size + norm(load.resultant)
  end
  if #conditions > 0 and norm(force) > 1e-6 * size then
    return ("No face is fixed, and the loads push the part away with %s: choose the faces where it is screwed or "
      .. "glued and press Fix, or add the load on the other side."):format(core.quantity(norm(force), "N"))
  end
end

local load_names = {force = "force", pressure = "pressure", gravity = "gravity"}

-- What the engine says of a solve, in the words of a page.
local function in_words(self, conditions, message, details)
  local number = tonumber(tostring(message):match "^load (%d+), an? ")
  for _, condition in ipairs(number and conditions or {}) do
    if load_names[condition.kind] then number = number - 1 end
    if number == 0 then
      return ("The %s on %s goes straight into the fixed faces beside it, and nothing deforms: press Change "
        .. "beside it and choose another face, or press Remove beside the support."):format(
        load_names[condition.kind], self.faces[condition.faces[1]].name), details
    end
  end
  return lengths(tostring(message)), details
end

--- The part on a mesh: model, whether it is constrained; or nil and why not.
function judge.part(self, material, conditions, mesh, labels)
  local part, message, details = model.try(core.model, {mesh = mesh, material = material})
  if not part then return nil, message, details end
  local fixed, loads = false, {}
  for _, condition in ipairs(conditions) do
    local ok
    ok, message, details = apply(self, part, labels, condition)
    if not ok then return nil, message, details end
    if condition.kind == "all" or condition.kind == "normal" then fixed = true
    else loads[#loads + 1] = condition end
  end
  local why = fault(part, fixed, loads)
  if why then return nil, why, {status = "unsupported"} end
  return part, fixed
end

-- ---- known loads -----------------------------------------------------------------------------------

-- The largest stress of a solution and stress over strength, at points and in the mean over patches.
local function measure(static, material, radius)
  local node = static.von_mises:argmax()
  local nodes = static.mesh.nodes
  local found = {elements = static.mesh.element_count, stress = static.von_mises[node],
    at = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}}
  if not material.strength then return found end
  found.used = static.utilisation:max()
  local mean = patch_means.governing({default = material, named = {}}, static, radius)
  found.used_mean = mean and mean.used or found.used
  return found
end

-- Whether the surface is round at a place, so that facets of the file are an error by themselves.
local function facets(static, surface, at)
  local curved = model.try(static.mesh.curved, static.mesh, surface)
  return facet_error(curved or static.mesh, at, growth.radius(growth.edge_length(static.mesh, at))) or 0
end

-- The lowest elastic frequency (Hz) on a mesh; nil where it cannot be computed.
local function frequency(part, fixed)
  if not part.material.density then return nil end
  local modes = model.try(part.modes, part, {count = fixed and 1 or 7})
  if not modes then return nil end
  for _, f in ipairs(modes.frequencies:totable()) do
    f = type(f) == "table" and f[1] or f
    if f > 1 then return f end
  end
end

local function sentence(answer, words)
  local used = ("stress over strength %s (%s to %s)"):format(shown.percent(answer.utilisation),
    shown.percent(answer.low), shown.percent(answer.high))
  local head = answer.verdict == "holds" and "It holds" or answer.verdict == "breaks" and "It breaks"
    or (words or "too close to decide"):gsub("^%l", string.upper)
  return ("%s: %s. It breaks at %s of all loads together."):format(head, used,
    shown.interval(answer.force, answer.force_low, answer.force_high, "N"))
end

--- Solves a body under known loads on a mesh of so many elements. `former`: the measure of a coarser mesh with its
--- elements, or nil. Returns the answer (a plain table), the solution, the measure; or nil, message, details.
function judge.statics(self, material, conditions, elements, former)
  local start = core.seconds()
  local mesh, labels, details = body.mesh(self, elements)
  if not mesh then return nil, labels, details end
  local part, fixed, about = judge.part(self, material, conditions, mesh, labels)
  if not part then return nil, fixed, about end
  local static, message, why = model.try(part.solve, part, {inertia_relief = not fixed or nil})
  if not static then return nil, in_words(self, conditions, message, why) end
  local radius = averaging_radius("workbench", nil, material, mesh.box)
  local fine, notes = measure(static, material, radius), {}
  local mean = static:error_estimate()
  local coarse = former and former.elements < fine.elements and former or nil
  local error = model.error_of(fine.stress, coarse and coarse.stress, mean)
  local used = fine.used
  if coarse then error = math.sqrt(error ^ 2 + facets(static, self.surface, fine.at) ^ 2) end
  local singular = model.find_singular(part, {surface = self.surface}, fine.at, fine, coarse)
  if singular and used then
    used, error = fine.used_mean, model.error_of(fine.used_mean, coarse and coarse.used_mean, mean)
    notes[#notes + 1] = ("The stress at the sharp edge at %s has no finite value; its mean over a patch of radius "
      .. "%s is judged."):format(core.point(fine.at), core.quantity(radius, "m"))
  end
  local verdict, words = model.verdict(used, error)
  local max = static.displacement:map "norm(a)":max()
  if model.beyond_linear(max, mesh.box) then
    notes[#notes + 1] = ("The part moves by %s: displacements are beyond the range of linear theory (%s)."):format(
      core.quantity(max, "m"), model.large_deflection)
  end
  local all = total(part)
  local answer = {kind = "statics", verdict = verdict, colour = colours[verdict], at = fine.at, notes = notes,
    max_displacement = max, max_stress = fine.stress, error = error, elements = fine.elements,
    mass = material.density and material.density * mesh.volume, singular = singular ~= nil, load = all}
  if used then
    answer.utilisation, answer.low, answer.high = used, used * math.max(0, 1 - error), used * (1 + error)
    answer.factor = 1 / used
    answer.force, answer.force_low = all / used, all / answer.high
    answer.force_high = answer.low > 0 and all / answer.low or nil
    answer.sentence = sentence(answer, words)
  else
    answer.sentence = ("The strength of %s is not known: the largest stress is %s."):format(material.name,
      shown.estimate(fine.stress, "Pa"))
  end
  answer.seconds = core.seconds() - start
  return answer, static, {measure = fine, part = part, fixed = fixed, labels = labels}
end

--- An answer from one coarse solution alone, without an estimate of its error: what is shown while a face is
--- dragged.
function judge.quick(static, material, seconds)
  local node = static.von_mises:argmax()
  local nodes = static.mesh.nodes
  local used = material.strength and static.utilisation:max() or nil
  return {kind = "statics", verdict = "none", notes = {}, utilisation = used,
    at = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}, max_stress = static.von_mises[node],
    max_displacement = static.displacement:map "norm(a)":max(), elements = static.mesh.element_count,
    mass = material.density and material.density * static.mesh.volume, seconds = seconds,
    sentence = used and ("About %s of the strength, on a coarse mesh."):format(shown.percent(used))
      or ("The largest stress is about %s, on a coarse mesh."):format(core.quantity(static.von_mises[node], "Pa"))}
end

--- The first natural frequency (Hz) of a body with its supports, or of the free body.
function judge.frequency(solved)
  return frequency(solved.part, solved.fixed)
end

-- ---- the worst load --------------------------------------------------------------------------------

--- The breaking force of a body under the worst load, fixed where conditions say so. Returns the answer and the
--- bw.breaking_force; or nil, message, details.
function judge.worst(self, material, conditions, elements, force)
  local start, fixed = core.seconds(), {}
  for _, condition in ipairs(conditions) do
    if condition.kind == "all" then fixed[#fixed + 1] = condition end
  end
  local fix = #fixed > 0 and function(mesh)
    local labels, message, details = core.face_labels(self.surface, self.labels, mesh)
    if not labels then return nil, message, details end
    local list = {}
    for i, condition in ipairs(fixed) do list[i] = body.select(self, mesh, labels, condition.faces) end
    return list
  end or nil
  local found, message, details = model.try(breaking_force, self.surface, {material = material, force = force,
    decide = force ~= nil, elements = elements, fix = fix})
  if not found then return nil, message, details end
  local verdict = force and found:verdict(force) or nil
  local notes = {}
  if found.singular then
    notes[1] = "The stress there has no finite value; its mean over a patch of the surface is judged."
  end
  local answer = {kind = "worst", verdict = verdict or "none", colour = colours[verdict] or "amber",
    force = found.force, force_low = found.low, force_high = found.high, at = found.at, notes = notes,
    contact = found.contact, mass = material.density and material.density * found.mesh.volume,
    elements = found.mesh.element_count, singular = found.singular ~= nil, error = found.estimated_error,
    max_displacement = found.worst.max_displacement, utilisation = force and force / found.force or nil,
    low = force and force / found.high or nil, high = force and found.low > 0 and force / found.low or nil,
    sentence = ("It breaks at %s, pushed in the worst way on %s at %s%s."):format(
      shown.interval(found.force, found.low, found.high, "N"), core.quantity(found.contact, "m2"),
      core.point(found.at), verdict and (": under %s %s"):format(core.quantity(force, "N"),
        verdict == "holds" and "it holds" or verdict == "breaks" and "it breaks" or "it is too close to decide")
        or "")}
  answer.seconds = core.seconds() - start
  return answer, found
end

return judge
