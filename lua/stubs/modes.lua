---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Modes
--
-- Natural frequencies and mode shapes.

---Modes of vibration, ascending; or of the Laplacian (components 1). `#modes` is their number.
---@class bw.Modes
---@field count integer
---@field components integer
---@field eigenvalues bw.Array (rad/s)^2; 1/m2 for the Laplacian
---@field frequencies bw.Array? Hz
---@field residuals bw.Array
---@field rigid_count integer rigid motions recognised and left out
---@field solves integer
---@field recovered integer found only after the Sturm count called for them
---@field counted boolean the Sturm count confirmed that none is missing
---@field mesh bw.Mesh
---@field solver table? of SLEPc: as bw.Static's; nil for the engine's own
local Modes = {}

---The i-th shape, a row for every node, of unit modal mass.
---@param i integer
---@return bw.Array
function Modes:shape(i) end

---By how many cents each frequency is too high: the recovered stress of the shape gives its error in energy, whose
---square is that of the eigenvalue (docs/theory/error_control.md). Not for Laplacian modes.
---`print(modes.frequencies[1], "Hz, too high by", modes:error_estimate()[1], "cents")`
---@return bw.Array? cents
---@return string? message
---@return bw.Details? details
function Modes:error_estimate() end

---All shapes as .vtu.
---@param path string
---@param options? table
---@return true?
function Modes:write(path, options) end

---@param i integer
---@param path string
---@param options? bw.PictureOptions
---@return true?
function Modes:picture(i, path, options) end

---Lets go at once.
function Modes:close() end
