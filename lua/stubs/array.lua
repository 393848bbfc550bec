---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Arrays
--
-- Views of rows and columns of numbers, with the operations that scripts need on fields.

---Making arrays; `bw.array{...}` is short for `bw.array.new{...}`.
---@class bw.ArrayModule
---@overload fun(rows: number[]|number[][], type?: string): bw.Array
local array_module = {}

---The same as `bw.array.new`.
---@param rows number[]|number[][]
---@param type? "f64"|"i32"|"i64"|"u8"
---@return bw.Array
function array_module:__call(rows, type) end

---From numbers, or from rows of numbers.
---@param rows number[]|number[][]
---@param type? "f64"|"i32"|"i64"|"u8"
---@return bw.Array
function array_module.new(rows, type) end

---@param rows integer
---@param columns? integer
---@param type? "f64"|"i32"|"i64"|"u8"
---@return bw.Array
function array_module.zeros(rows, columns, type) end

---first, first + step, ... up to last.
---@param first number
---@param last number
---@param step? number
---@return bw.Array
function array_module.range(first, last, step) end

---From bytes such as `array:tostring` gives.
---@param format string < or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8
---@param bytes string
---@param columns? integer
---@return bw.Array
function array_module.from_string(format, bytes, columns) end

---A formula over named arrays and numbers: `bw.array.map("x^2 + norm(u)*k", {x = ..., u = ..., k = 3})`.
---Operators of Lua (+ - * / % ^ == ~= < <= > >= and or not), name[k] or name.x for a column, sqrt abs
---exp log sin cos tan asin acos atan floor ceil sign min max atan2 hypot mod norm where(c, yes, no), pi.
---Comparisons make masks (u8).
---@param formula string
---@param variables table<string, bw.Array|number>
---@return bw.Array
function array_module.map(formula, variables) end

---A view of rows x columns numbers; it keeps the memory it looks at alive and cannot be changed.
---`#a` is the number of rows, `a[i]` a number or (with several columns) a row;
---+ - * / ^ work entry by entry with arrays and numbers.
---@class bw.Array
---@field row_count integer
---@field column_count integer
---@field type "f64"|"i32"|"i64"|"u8"
---@operator add(bw.Array|number): bw.Array
---@operator sub(bw.Array|number): bw.Array
---@operator mul(bw.Array|number): bw.Array
---@operator div(bw.Array|number): bw.Array
---@operator pow(bw.Array|number): bw.Array
---@operator unm: bw.Array
---@overload fun(row: integer, column?: integer): number
local Array = {}

---One entry.
---@param row integer
---@param column? integer
---@return number
function Array:__call(row, column) end

---Rows first to last by step, a view; negative ones count from the end.
---@param first? integer
---@param last? integer
---@param step? integer
---@return bw.Array
function Array:rows(first, last, step) end

---Columns first to last by step, a view.
---@param first? integer
---@param last? integer
---@param step? integer
---@return bw.Array
function Array:columns(first, last, step) end

---One column, a view.
---@param column integer
---@return bw.Array
function Array:column(column) end

---The smallest entry (NaN passed over); nil of none.
---@return number?
function Array:min() end

---The largest entry.
---@return number?
function Array:max() end

---Row and column of the smallest entry.
---@return integer? row
---@return integer? column
function Array:argmin() end

---Row and column of the largest entry.
---@return integer? row
---@return integer? column
function Array:argmax() end

---The sum of all entries, compensated.
---@return number
function Array:sum() end

---The mean of all entries, or of one column with weights.
---@param weights? bw.Array
---@return number
function Array:mean(weights) end

---The root of the sum of squares.
---@return number
function Array:norm() end

---The sum of products with an array of the same shape.
---@param other bw.Array
---@return number
function Array:dot(other) end

---One sum for each column.
---@return number[]
function Array:column_sums() end

---The p-th quantile, 0 to 1, of one column; weighted when weights are given.
---@param p number
---@param weights? bw.Array
---@return number?
function Array:quantile(p, weights) end

---One column in ascending order.
---@return bw.Array
function Array:sorted() end

---The numbers of the rows in ascending order of their entries.
---@return bw.Array
function Array:order() end

---A formula with this array as `a`; see `array.map`.
---@param formula string
---@param variables? table<string, bw.Array|number>
---@return bw.Array
function Array:map(formula, variables) end

---A mask: entries greater than x (a number or an array).
---@param x number|bw.Array
---@return bw.Array
function Array:above(x) end

---A mask: entries less than x.
---@param x number|bw.Array
---@return bw.Array
function Array:below(x) end

---The rows of the given numbers.
---@param rows bw.Array|integer[]
---@return bw.Array
function Array:gather(rows) end

---The rows whose mask is not 0.
---@param mask bw.Array
---@return bw.Array
function Array:select(mask) end

---The numbers of the rows whose entry is not 0.
---@return bw.Array
function Array:where() end

---Zeros of `count` rows with row i of this array put at rows[i].
---@param rows bw.Array|integer[]
---@param count integer
---@return bw.Array
function Array:scatter(rows, count) end

---The same numbers in memory of its own.
---@return bw.Array
function Array:copy() end

---Numbers, or rows of numbers.
---@return table
function Array:totable() end

---Bytes, row after row; `offset` is added to every number first.
---@param format string < or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8
---@param offset? number
---@return string
function Array:tostring(format, offset) end

---Lets go at once.
function Array:close() end
