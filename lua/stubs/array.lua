---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Arrays
--
-- Rows and columns of numbers: fields of nodes and elements, and the operations that scripts need on them. Arrays cannot be
-- changed; operations give new ones.

---Making arrays; called, it makes one of a table.
---@class bw.ArrayModule
---@overload fun(rows: number[]|number[][], type?: string): bw.Array
local array_module = {}

---The same as `bw.array.new`.
---```lua
---local points = bw.array {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}
---print(points.row_count, points.column_count) -- 3 3
---```
---@param rows number[]|number[][] (any, n or n × c) numbers, or rows of as many numbers each
---@param type? "f64"|"i32"|"i64"|"u8" of the numbers. Default: "f64"
---@return bw.Array array (any, n × 1 or n × c) the array
function array_module:__call(rows, type) end

---An array from a table. A number that its type cannot hold raises.
---```lua
---local mask = bw.array.new({1, 0, 1}, "u8")
---print(mask:sum()) -- 2.0
---```
---@param rows number[]|number[][] (any, n or n × c) numbers, or rows of as many numbers each
---@param type? "f64"|"i32"|"i64"|"u8" of the numbers: double precision, or whole numbers of 32, 64 or 8 bits. Default: "f64"
---@return bw.Array array (any, n × 1 or n × c) the array
function array_module.new(rows, type) end

---An array of zeros.
---```lua
---local none = bw.array.zeros(100, 3)
---print(none:norm()) -- 0.0
---```
---@param rows integer (count) of rows, 0 or more
---@param columns? integer (count) of columns, 1 or more. Default: 1
---@param type? "f64"|"i32"|"i64"|"u8" of the numbers. Default: "f64"
---@return bw.Array array (any, rows × columns) the zeros
function array_module.zeros(rows, columns, type) end

---The numbers first, first + step, ... up to last.
---```lua
---local numbers = bw.array.range(0, 1, 0.25)
---print(#numbers, numbers:sum()) -- 5 2.5
---```
---@param first number (any) the first number
---@param last number (any) the largest number; the smallest one where the step is negative
---@param step? number (any) not 0. Default: 1
---@return bw.Array array (any, n × 1) the numbers
function array_module.range(first, last, step) end

---An array from bytes such as `array:tostring` gives.
---```lua
---local bytes = bw.array({1, 2, 3, 4}):tostring "<f4"
---print(bw.array.from_string("<f4", bytes, 2)(2, 2)) -- 4.0
---```
---@param format string < (little-endian) or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8. Default of the sign: <
---@param bytes string a whole number of rows
---@param columns? integer (count) of columns. Default: 1
---@return bw.Array array (any, n × columns) the numbers
function array_module.from_string(format, bytes, columns) end

---A formula over named arrays and numbers, row by row.
---
---- Operators: `+ - * / % ^`, `== ~= != < <= > >=`, `and or not`, as in Lua. Comparisons give masks, of type u8.
---- Columns: `name[k]`, counted from 1; `name.x`, `name.y`, `name.z` are the first three. A variable of one column fits every
---  column of the others.
---- Functions: sqrt abs exp log sin cos tan asin acos atan floor ceil sign, min max atan2 hypot mod of two numbers, `norm(name)` of
---  a row, `where(condition, yes, no)`.
---- Constants: pi, inf, nan.
---
---A formula that is wrong raises.
---```lua
---local x = bw.array {{3, 4}, {0, 2}}
---print(bw.array.map("norm(x) * k", {x = x, k = 10})[1]) -- 50.0
---```
---@param formula string the formula
---@param variables table<string, bw.Array|number> arrays of as many rows, and numbers, by name. Range: at most 32
---@return bw.Array array (any, n × c) the values; of type u8 where the formula is a comparison
function array_module.map(formula, variables) end

---An array from a file: `.npy` of NumPy with one or two dimensions, or Matrix Market in array format. The content decides, not the
---name.
---
---Errors: io, format (the file is damaged, or a sparse matrix; `details.line` or `details.byte`), unsupported (more dimensions, complex
---numbers, texts), limit (4 GiB).
---```lua
---assert(bw.array.new {{1, 2}, {3, 4}}:write "a.npy")
---print(assert(bw.array.read "a.npy")(2, 1)) -- 3.0
---```
---@param path string the file
---@return bw.Array? array (any, rows × columns) what is in it
---@return string? message
---@return bw.Details? details
function array_module.read(path) end

---Rows and columns of numbers. It may be a view of the memory of another object, which it keeps alive. `#a` is the number of rows,
---`a[i]` a number or (with several columns) a row, `a(i, j)` an entry. `+ - * / ^` work entry by entry with arrays and numbers.
---```lua
---local a = bw.array {{1, 2}, {3, 4}}
---print(#a, a[2][1], a(2, 1), (2 * a + 1):max()) -- 2 3.0 3.0 9.0
---```
---@class bw.Array
---@field row_count integer (count) of rows
---@field column_count integer (count) of columns
---@field type "f64"|"i32"|"i64"|"u8" of the numbers
---@operator add(bw.Array|number): bw.Array
---@operator sub(bw.Array|number): bw.Array
---@operator mul(bw.Array|number): bw.Array
---@operator div(bw.Array|number): bw.Array
---@operator pow(bw.Array|number): bw.Array
---@operator unm: bw.Array
---@overload fun(row: integer, column?: integer): number
local Array = {}

---One entry. A row or column that is not there raises.
---@param row integer (index from 1) the row
---@param column? integer (index from 1) the column; needed where there are several
---@return number entry (any) an integer where the type is one
function Array:__call(row, column) end

---A view of some rows.
---@param first? integer (index from 1) the first row; negative: from the end. Default: 1
---@param last? integer (index from 1) the last row; negative: from the end. Default: the last one
---@param step? integer (count) not 0. Default: 1
---@return bw.Array view (any, n × column_count) the rows
function Array:rows(first, last, step) end

---A view of some columns.
---@param first? integer (index from 1) the first column; negative: from the end. Default: 1
---@param last? integer (index from 1) the last column; negative: from the end. Default: the last one
---@param step? integer (count) not 0. Default: 1
---@return bw.Array view (any, row_count × n) the columns
function Array:columns(first, last, step) end

---A view of one column.
---@param column integer (index from 1) the column
---@return bw.Array view (any, row_count × 1) the column
function Array:column(column) end

---The smallest entry, NaN passed over; nil where there is none.
---@return number? smallest (any) the entry
function Array:min() end

---The largest entry, NaN passed over; nil where there is none.
---@return number? largest (any) the entry
function Array:max() end

---Row and column of the smallest entry, NaN passed over; nil where there is none.
---@return integer? row (index from 1) its row
---@return integer? column (index from 1) its column
function Array:argmin() end

---Row and column of the largest entry, NaN passed over; nil where there is none.
---@return integer? row (index from 1) its row
---@return integer? column (index from 1) its column
function Array:argmax() end

---The sum of all entries, by compensated summation.
---@return number sum (any) the sum
function Array:sum() end

---The mean of all entries, or the weighted mean of one column.
---@param weights? bw.Array (any, row_count × 1) the weights. Default: all equal
---@return number mean (any) the mean
function Array:mean(weights) end

---The square root of the sum of the squares of all entries.
---@return number norm (any) the norm
function Array:norm() end

---The sum of the products with the entries of an array of the same shape.
---@param other bw.Array (any, row_count × column_count) the other array
---@return number product (any) the sum
function Array:dot(other) end

---The sum of each column.
---@return number[] sums (any, column_count) the sums
function Array:column_sums() end

---A quantile of one column; nil of no rows. It is linear between entries. With weights it is the smallest entry up to which the
---fraction of the weight lies.
---@param p number (-) the fraction. Range: 0 to 1
---@param weights? bw.Array (any, row_count × 1) the weights. Default: all equal
---@return number? quantile (any) the value
function Array:quantile(p, weights) end

---One column in ascending order. NaN raises.
---@return bw.Array sorted (any, row_count × 1) the entries
function Array:sorted() end

---The numbers of the rows in ascending order of the entries of one column; equal ones stay in their order. NaN raises.
---@return bw.Array order (index from 1, row_count × 1) numbers of rows
function Array:order() end

---A formula with this array as `a`: see `bw.array.map`.
---@param formula string the formula
---@param variables? table<string, bw.Array|number> further arrays and numbers, by name
---@return bw.Array array (any, row_count × c) the values
function Array:map(formula, variables) end

---Which entries are greater.
---@param x number|bw.Array (any, row_count × column_count) what they are compared with; one number for all
---@return bw.Array mask (-, row_count × column_count) 1 or 0, of type u8
function Array:above(x) end

---Which entries are less.
---@param x number|bw.Array (any, row_count × column_count) what they are compared with; one number for all
---@return bw.Array mask (-, row_count × column_count) 1 or 0, of type u8
function Array:below(x) end

---Rows by number. A number that is not there raises.
---@param rows bw.Array|integer[] (index from 1, n × 1) numbers of rows, in any order
---@return bw.Array gathered (any, n × column_count) these rows
function Array:gather(rows) end

---Rows by mask.
---@param mask bw.Array (-, row_count × 1) not 0: the row stays
---@return bw.Array selected (any, n × column_count) these rows
function Array:select(mask) end

---The numbers of the rows of one column whose entry is not 0.
---@return bw.Array rows (index from 1, n × 1) their numbers
function Array:where() end

---The opposite of `gather`: zeros, with row i of this array at row `rows[i]`.
---@param rows bw.Array|integer[] (index from 1, row_count × 1) where each row goes
---@param count integer (count) rows of the new array
---@return bw.Array scattered (any, count × column_count) the new array
function Array:scatter(rows, count) end

---The same numbers in memory of their own, so that the object they were a view of can be released.
---@return bw.Array copy (any, row_count × column_count) the copy
function Array:copy() end

---The numbers as a table: a list of one column, else a list of rows.
---@return number[]|number[][] table (any, row_count or row_count × column_count) the numbers
function Array:totable() end

---The numbers as bytes, row after row. A number that the format cannot hold raises.
---@param format string < (little-endian) or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8. Default of the sign: <
---@param offset? number (any) added to every number first; -1 makes numbers that count from 1 count from 0. Default: 0
---@return string bytes the numbers
function Array:tostring(format, offset) end

---Writes it, by the ending of the path: `.npy` is NumPy's format (one dimension where there is one column), `.mtx` is Matrix Market in
---array format.
---
---Errors: io, unsupported (another ending).
---@param path string the file
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function Array:write(path) end

---Releases the array at once.
function Array:close() end
