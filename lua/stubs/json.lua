---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- JSON
--
-- Reading and writing JSON. Keys are sorted, numbers have the fewest digits that read back as the same number, NaN and infinities
-- are written as null.

---Reading and writing JSON.
---@class bw.JsonModule
---@field null bw.JsonNull stands for null
local json_module = {}

---The value that stands for null.
---@class bw.JsonNull

---The text of a value. Tables with the keys 1 to n are lists, others objects, whose keys must be strings. Functions, tables that
---contain themselves, and tables more than 200 deep raise.
---```lua
---local text = bw.json.encode {name = "bar", sizes = {1, 2.5}, empty = bw.json.list()}
---print(text) -- {"empty":[],"name":"bar","sizes":[1,2.5]}
---```
---@param value any a number, string, boolean, nil, `bw.json.null`, an array, or a table of these
---@param indent? string such as "  ", for a text of several lines. Default: one line
---@return string text the JSON
function json_module.encode(value, indent) end

---The value of a text. Whole numbers are integers, null is `bw.json.null`. Where the text is not JSON: nil, and a message with line
---and byte.
---```lua
---local value = assert(bw.json.decode '{"sizes": [1, 2.5]}')
---print(value.sizes[2]) -- 2.5
---```
---@param text string the JSON
---@return any value the value, or nil
---@return string? message
function json_module.decode(text) end

---Marks a table as a list, so that an empty one is written as [].
---```lua
---local none = bw.json.list {}
---print(bw.json.encode(none)) -- []
---```
---@param list? any[] the table. Default: a new one
---@return any[] list the same table
function json_module.list(list) end
