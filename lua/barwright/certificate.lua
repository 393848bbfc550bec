-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Certificates of the worst case's upper bound: writing and reading them. docs/formats.md has the format,
-- certificate_check.lua the check.
local core = require "barwright.core"
local read_file = require "barwright.read_file"

local certificate = {}

local HEAD = "barwright certificate 2"

local function row(...)
  local texts = table.pack(...)
  for i = 1, texts.n do
    texts[i] = math.type(texts[i]) == "float" and ("%.17g"):format(texts[i]) or tostring(texts[i])
  end
  return table.concat(texts, " ")
end

local function numbers(array)
  return array.row_count > 0 and table.concat(array:totable(), " ") or ""
end

-- ---- writing ---------------------------------------------------------------------------------------

local function add_rows(lines, name, array)
  lines[#lines + 1] = row(name, array.row_count)
  for _, values in ipairs(array:totable()) do lines[#lines + 1] = row(table.unpack(values)) end
end

local function material_line(material)
  if material.isotropic then return row("material isotropic", material.young, material.poisson) end
  local list = {}
  for _, key in ipairs {"young", "poisson", "shear"} do table.move(material[key], 1, 3, #list + 1, list) end
  for _, axis in ipairs(material.axes:totable()) do table.move(axis, 1, 3, #list + 1, list) end
  return row("material orthotropic", table.unpack(list))
end

local function add_supports(lines, part)
  local supports = part.supports
  lines[#lines + 1] = row("supports", #supports)
  for _, support in ipairs(supports) do
    local along = support.direction
    local kind = support.slide and (along and row("along", table.unpack(along)) or "normal")
    if not kind then
      local fixed = {}
      for k = 1, 3 do fixed[k] = support.displacement[k] and 1 or 0 end
      kind = row("fixed", table.unpack(fixed))
    end
    lines[#lines + 1] = kind
    lines[#lines + 1] = row("facets", support.on.facet_count, numbers(support.on.facets))
    lines[#lines + 1] = row("nodes", support.on.node_count, numbers(support.on.nodes))
  end
end

-- Number of a cell to text: "all", or the face and the parts below it, as in "3.021".
local function cell_text(cell)
  if cell == 0 then return "all" end
  local parts = ""
  while cell >= 20 do
    parts = (cell & 3) .. parts
    cell = cell >> 2
  end
  return (cell - 10) .. "." .. parts
end

local function add_leaves(lines, leaves)
  local elements, cells, bounds = leaves.elements:totable(), leaves.cells:totable(), leaves.bounds:totable()
  local starts, list = leaves.starts:totable(), leaves.numbers:totable()
  lines[#lines + 1] = row("leaves", #elements)
  for i, element in ipairs(elements) do
    lines[#lines + 1] = ("%d %s %.12g %s"):format(element, cell_text(cells[i]), bounds[i],
      table.concat(list, " ", starts[i], starts[i + 1] - 1))
  end
end

--- The text of a certificate of a worst case with an upper bound and the leaves that prove it, or nil, message,
--- details.
function certificate.text(worst, part, leaves)
  local mesh, opts, loads = part.mesh, worst.options, worst.loads
  if part.material.rotated_by_element then
    return nil, "a certificate for a material whose axes differ by element is not implemented",
      {status = "unsupported"}
  end
  local lines = {HEAD, material_line(part.material), row("formulation", part.formulation),
    row("order", mesh.order)}
  add_rows(lines, "nodes", mesh.nodes)
  add_rows(lines, "elements", mesh.elements)
  add_supports(lines, part)
  local forbidden = opts.forbidden
  lines[#lines + 1] = row("forbidden", forbidden and forbidden.facet_count or 0,
    forbidden and numbers(forbidden.facets) or "")
  lines[#lines + 1] = row("loads", opts.force, opts.pressure, opts.force_is_max and "max" or "exactly",
    opts.friction, opts.friction_facets)
  local motions = assert(part:rigid_modes())
  lines[#lines + 1] = row("motions", #motions)
  for _, motion in ipairs(motions) do
    local c, t, r = motion.centre, motion.translation, motion.rotation
    lines[#lines + 1] = row(motion.component, c[1], c[2], c[3], t[1], t[2], t[3], r[1], r[2], r[3])
  end
  local best = loads.peaks:argmax()
  lines[#lines + 1] = row("reached", loads.peaks[best], loads.peak_elements[best])
  local pressure, list = loads.pressures[best], {}
  for j, p in ipairs(pressure:totable()) do
    if p ~= 0 then list[#list + 1] = row(j, p) end
  end
  lines[#lines + 1] = row("pressures", pressure.row_count, #list)
  table.move(list, 1, #list, #lines + 1, lines)
  lines[#lines + 1] = row("upper_bound", worst.upper_bound)
  add_leaves(lines, leaves)
  lines[#lines + 1] = "end\n"
  return table.concat(lines, "\n")
end

--- Writes it: true, or nil, message, details.
function certificate.write(worst, part, leaves, path)
  local text, message, details = certificate.text(worst, part, leaves)
  if not text then return nil, message, details end
  return core.write_file(path, text)
end

-- ---- reading ---------------------------------------------------------------------------------------

local reader = {}
reader.__index = reader

local function refuse(self, what)
  error({message = ("%s: line %d: %s"):format(self.path, self.line, what), line = self.line}, 0)
end

function reader:next()
  self.line = self.line + 1
  local text = self.lines()
  if not text then refuse(self, "the file ends here, before its last line 'end'") end
  return text
end

-- The words of a line behind its first one, which must be `name`.
function reader:words(name)
  local text, list = self:next(), {}
  for word in text:gmatch "%S+" do list[#list + 1] = word end
  if name then
    if list[1] ~= name then refuse(self, ("'%s' expected, got '%s'"):format(name, text:sub(1, 40))) end
    table.remove(list, 1)
  end
  return list
end

function reader:number(word)
  local value = tonumber(word)
  if not value or value ~= value or math.abs(value) == math.huge then
    refuse(self, ("a finite number expected, got '%s'"):format(word or "nothing"))
  end
  return value
end

function reader:whole(word, min, max)
  local value = math.tointeger(self:number(word))
  if not value or value < min or value > max then
    refuse(self, ("a whole number from %d to %d expected, got '%s'"):format(min, max, word))
  end
  return value
end

-- All words as numbers, so many of them.
function reader:list(words, count, min, max)
  if #words ~= count then refuse(self, ("%d numbers expected, got %d"):format(count, #words)) end
  local list = {}
  for i, word in ipairs(words) do
    list[i] = min and self:whole(word, min, max) or self:number(word)
  end
  return list
end

local MAX = 2 ^ 31 - 1

function reader:rows(name, width, min, max)
  local count, list = self:whole(self:words(name)[1], 1, MAX), {}
  for i = 1, count do list[i] = self:list(self:words(), width, min, max) end
  return list
end

-- "name COUNT n n n"
function reader:indices(name)
  local words = self:words(name)
  local count = self:whole(table.remove(words, 1), 0, MAX)
  return self:list(words, count, 1, MAX)
end

function reader:material()
  local words = self:words "material"
  local kind = table.remove(words, 1)
  if kind == "isotropic" then
    local list = self:list(words, 2)
    return {kind = kind, constants = {young = list[1], poisson = list[2]}}
  elseif kind == "orthotropic" then
    local list = self:list(words, 18)
    local function three(i) return {list[i], list[i + 1], list[i + 2]} end
    return {kind = kind, constants = {young = three(1), poisson = three(4), shear = three(7),
      axes = {three(10), three(13), three(16)}}}
  end
  refuse(self, ("material isotropic or orthotropic expected, got '%s'"):format(kind))
end

function reader:supports()
  local list = {}
  for i = 1, self:whole(self:words "supports"[1], 0, MAX) do
    local words = self:words()
    local support = {kind = table.remove(words, 1)}
    if support.kind ~= "normal" and support.kind ~= "along" and support.kind ~= "fixed" then
      refuse(self, ("a support 'fixed', 'along' or 'normal' expected, got '%s'"):format(support.kind))
    end
    support.vector = self:list(words, support.kind == "normal" and 0 or 3)
    support.facets, support.nodes = self:indices "facets", self:indices "nodes"
    list[i] = support
  end
  return list
end

function reader:leaves(elements, motions)
  local list = {}
  for i = 1, self:whole(self:words "leaves"[1], 0, MAX) do
    local words = self:words()
    local leaf = {element = self:whole(words[1], 1, elements), cell = words[2], bound = self:number(words[3])}
    if leaf.cell ~= "all" and not (leaf.cell or ""):match "^%d%.[0-3]*$" then
      refuse(self, ("a cell such as all or 3.021 expected, got '%s'"):format(leaf.cell))
    end
    local at, vectors = 4, {}
    local function vector(size)
      local scale, v = 2.0 ^ self:whole(words[at], -1000, 1000), {}
      for k = 1, size do v[k] = self:whole(words[at + k], -2 ^ 15, 2 ^ 15) * scale end
      at = at + size + 1
      return v
    end
    for k = 1, leaf.cell == "all" and 6 or 2 do
      vectors[k] = vector(motions)
      if leaf.cell ~= "all" then vectors[k].total = vector(1)[1] end
    end
    if leaf.cell == "all" then vectors.total = vector(1)[1] end
    if at ~= #words + 1 then refuse(self, ("%d words expected, got %d"):format(at - 1, #words)) end
    leaf.multipliers, list[i] = vectors, leaf
  end
  return list
end

local function parse(self)
  local found = {path = self.path}
  if self:next() ~= HEAD then
    refuse(self, ("'%s' expected: this is no certificate of this version"):format(HEAD))
  end
  found.material = self:material()
  found.formulation = self:words "formulation"[1]
  found.order = self:whole(self:words "order"[1], 1, 2)
  found.nodes = self:rows("nodes", 3)
  found.elements = self:rows("elements", found.order == 1 and 4 or 10, 1, #found.nodes)
  found.supports = self:supports()
  found.forbidden = self:indices "forbidden"
  local words = self:words "loads"
  found.force, found.pressure = self:number(words[1]), self:number(words[2])
  found.force_is_max = words[3] == "max"
  found.friction, found.friction_facets = self:number(words[4]), self:whole(words[5], 3, 64)
  found.motions = {}
  for i = 1, self:whole(self:words "motions"[1], 0, MAX) do found.motions[i] = self:list(self:words(), 10) end
  words = self:words "reached"
  found.reached, found.element = self:number(words[1]), self:whole(words[2], 1, #found.elements)
  words = self:words "pressures"
  found.columns, found.load = self:whole(words[1], 1, MAX), {}
  for _ = 1, self:whole(words[2], 0, found.columns) do
    words = self:words()
    found.load[self:whole(words[1], 1, found.columns)] = self:number(words[2])
  end
  found.upper_bound = self:number(self:words "upper_bound"[1])
  found.leaves = self:leaves(#found.elements, #found.motions)
  if self:next() ~= "end" then refuse(self, "'end' expected") end
  return found
end

--- What a file states, or nil, message, details.
function certificate.read(path)
  local text, why = read_file(path)
  if not text then return nil, why, {status = "io", file = path} end
  local self = setmetatable({path = path, line = 0, lines = text:gmatch "([^\n]*)\n"}, reader)
  local ok, found = pcall(parse, self)
  if ok then return found end
  if type(found) ~= "table" then error(found, 0) end
  return nil, found.message, {status = "format", file = path, line = found.line}
end

return certificate
