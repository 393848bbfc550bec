-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Fewer pixels' worth of data: what many points look like, drawn with few. Lists are flat: x, y, x, y.
local thin = {}

--- Discs that would hide each other: one for each cell of half a pixel.
function thin.points(list)
  if #list <= 6000 then return list end
  local seen, out = {}, {}
  for i = 1, #list, 2 do
    local x, y = list[i], list[i + 1]
    if x == x and y == y then
      local key = math.floor(2 * x) * 1000003 + math.floor(2 * y)
      if not seen[key] then
        seen[key] = true
        out[#out + 1], out[#out + 2] = x, y
      end
    end
  end
  return out
end

--- A line: in each column of half a pixel that it stays in, its first, lowest, highest and last point.
function thin.line(list)
  if #list <= 6000 then return list end
  local out = {}
  local column, first, low, high, last
  local function add(i)
    out[#out + 1], out[#out + 2] = list[i], list[i + 1]
  end
  local function flush()
    if not column then return end
    local picks = {first, low, high, last}
    table.sort(picks)
    for k, i in ipairs(picks) do
      if k == 1 or picks[k - 1] ~= i then add(i) end
    end
    column = nil
  end
  for i = 1, #list, 2 do
    local x, y = list[i], list[i + 1]
    if x ~= x or y ~= y then
      flush()
      add(i)
    else
      local c = math.floor(2 * x)
      if c ~= column then
        flush()
        column, first, low, high = c, i, i, i
      end
      last = i
      if y < list[low + 1] then low = i end
      if y > list[high + 1] then high = i end
    end
  end
  flush()
  return out
end

--- The pieces of a line within a box {left, top, right, bottom}: what is far outside would lose its
--- slope where numbers are limited.
function thin.clipped(list, left, top, right, bottom)
  local far = false
  for i = 1, #list, 2 do
    local x, y = list[i], list[i + 1]
    far = far or x < left - 1e4 or x > right + 1e4 or y < top - 1e4 or y > bottom + 1e4
  end
  if not far then return list end
  local out, nan = {}, 0 / 0
  for i = 1, #list - 3, 2 do
    local ax, ay, bx, by = list[i], list[i + 1], list[i + 2], list[i + 3]
    if ax == ax and ay == ay and bx == bx and by == by then
      local t0, t1, dx, dy = 0, 1, bx - ax, by - ay
      for _, edge in ipairs {{-dx, ax - left}, {dx, right - ax}, {-dy, ay - top}, {dy, bottom - ay}} do
        local p, q = edge[1], edge[2]
        if p == 0 then
          if q < 0 then t0 = 2 end
        elseif p < 0 then t0 = math.max(t0, q / p)
        else t1 = math.min(t1, q / p) end
      end
      if t0 <= t1 then
        for _, v in ipairs {ax + t0 * dx, ay + t0 * dy, ax + t1 * dx, ay + t1 * dy, nan, nan} do
          out[#out + 1] = v
        end
      end
    end
  end
  return out
end

return thin
