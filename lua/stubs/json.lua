---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- JSON
--
-- Reading and writing JSON.

---JSON with sorted keys and the fewest digits that read back the same; NaN and infinities as null.
---@class bw.JsonModule
---@field null table stands for null
local json_module = {}

---@param value any
---@param indent? string
---@return string
function json_module.encode(value, indent) end

---@param text string
---@return any value or nil
---@return string? message with line and byte
function json_module.decode(text) end

---Marks a table as a list, so that an empty one is [].
---@param list? table
---@return table
function json_module.list(list) end
