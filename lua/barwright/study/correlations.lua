-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Variables that scatter together (Nataf): values of given distributions and given correlations come from
-- correlated standard normal coordinates z = L y, with independent y. The correlation of z is not that of the
-- values, unless both are normal: it is the one that gives it.
local core = require "barwright.core"
local normal = require "barwright.study.normal"

local raise = core.raise

local correlations = {}

-- Sums over z by the trapezoidal rule, which converges faster than any power for what decays like a normal
-- density.
local STEP, REACH = 0.25, 8

local function moments(distribution)
  local mean, square = 0.0, 0.0
  for z = -REACH, REACH, STEP do mean = mean + STEP * normal.density(z) * distribution:value(z) end
  for z = -REACH, REACH, STEP do
    square = square + STEP * normal.density(z) * (distribution:value(z) - mean) ^ 2
  end
  return mean, math.sqrt(square)
end

--- The correlation of two values whose normal coordinates have the correlation r.
function correlations.of_values(a, b, r)
  local mean_a, deviation_a = moments(a)
  local mean_b, deviation_b = moments(b)
  local across, sum = math.sqrt(1 - r * r), 0.0
  for z = -REACH, REACH, STEP do
    local x, inner = (a:value(z) - mean_a) / deviation_a, 0.0
    for y = -REACH, REACH, STEP do
      inner = inner + STEP * normal.density(y) * b:value(r * z + across * y)
    end
    sum = sum + STEP * normal.density(z) * x * (inner - mean_b) / deviation_b
  end
  return sum
end

-- The correlation of normal coordinates that gives the values theirs. It grows with it.
local function of_normals(where, a, b, wanted)
  if a.name == "normal" and b.name == "normal" then return wanted end
  local low, high = -0.9999, 0.9999
  local least, most = correlations.of_values(a, b, low), correlations.of_values(a, b, high)
  if not (least <= wanted and wanted <= most) then
    raise(("%s: with these distributions from %.4f to %.4f is possible, got %.6g"):format(where, least, most,
      wanted))
  end
  for _ = 1, 48 do
    local middle = 0.5 * (low + high)
    if correlations.of_values(a, b, middle) < wanted then low = middle else high = middle end
  end
  return 0.5 * (low + high)
end

-- Cholesky's factor by rows; nil where the matrix is not positive definite.
local function factor(matrix)
  local L = {}
  for i = 1, #matrix do
    local row = {}
    for j = 1, i do
      local sum = matrix[i][j]
      for k = 1, j - 1 do sum = sum - row[k] * (L[j] or row)[k] end
      if i == j then
        if sum <= 1e-12 then return nil end
        row[j] = math.sqrt(sum)
      else
        row[j] = sum / L[j][j]
      end
    end
    L[i] = row
  end
  return L
end

local class = {}
class.__index = class

--- From {{"young", "strength", 0.6}, ...} and variables that have distributions; nil where the list is empty.
function correlations.read(where, list, variables)
  if type(list) ~= "table" then
    raise(("%s: correlations = {{NAME, NAME, number}, ...} expected, got %s"):format(where, core.got(list)))
  end
  for key in pairs(list) do
    if math.type(key) ~= "integer" then
      raise(("%s: correlations: a list {{NAME, NAME, number}, ...} expected, got the key %s"):format(where,
        core.got(key)))
    end
  end
  if #list == 0 then return nil end
  local number, matrix, text = {}, {}, {}
  for i, v in ipairs(variables) do
    number[v.name], matrix[i] = i, {}
    for j = 1, #variables do matrix[i][j] = i == j and 1.0 or 0.0 end
  end
  local seen = {}
  for i, given in ipairs(list) do
    local place = ("%s: correlation %d"):format(where, i)
    if type(given) ~= "table" or type(given[3]) ~= "number" then
      raise(("%s: {NAME, NAME, number} expected, got %s"):format(place, core.got(given)))
    end
    local a, b, r = number[given[1]], number[given[2]], given[3]
    for k = 1, 2 do
      if not number[given[k]] or not variables[number[given[k]]].distribution then
        raise(("%s: '%s' is no variable with a distribution"):format(place, tostring(given[k])))
      end
    end
    if a == b then raise(("%s: two variables expected, got '%s' twice"):format(place, given[1])) end
    if a > b then a, b = b, a end
    if seen[a .. " " .. b] then raise(("%s: '%s' and '%s' occur twice"):format(place, given[1], given[2])) end
    seen[a .. " " .. b] = true
    if not (r > -1 and r < 1) then
      raise(("%s: a number between -1 and 1 expected, got %.14g"):format(place, r))
    end
    local z = of_normals(place, variables[a].distribution, variables[b].distribution, r)
    matrix[a][b], matrix[b][a] = z, z
    text[#text + 1] = ("%s %s %.17g"):format(variables[a].name, variables[b].name, r)
  end
  local L = factor(matrix)
  if not L then
    raise(where .. ": correlations: no variables can have them all together (not positive definite)")
  end
  table.sort(text)
  return setmetatable({factor = L, text = table.concat(text, "; ")}, class)
end

--- Correlated coordinates of independent ones.
function class:correlated(y)
  local z = {}
  for i, row in ipairs(self.factor) do
    local sum = 0.0
    for j = 1, i do sum = sum + row[j] * y[j] end
    z[i] = sum
  end
  return z
end

--- Independent coordinates of correlated ones.
function class:independent(z)
  local y = {}
  for i, row in ipairs(self.factor) do
    local sum = z[i]
    for j = 1, i - 1 do sum = sum - row[j] * y[j] end
    y[i] = sum / row[i]
  end
  return y
end

--- A gradient by independent coordinates from one by correlated ones.
function class:gradient(by_z)
  local by_y = {}
  for j = 1, #by_z do
    local sum = 0.0
    for i = j, #by_z do sum = sum + self.factor[i][j] * by_z[i] end
    by_y[j] = sum
  end
  return by_y
end

return correlations
