---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Pictures
--
-- Shaded pictures of surfaces and meshes as PNG files.

---@class bw
local bw = {}

---A shaded picture of a surface as a PNG file.
---@param surface bw.Surface
---@param path string
---@param options? bw.PictureOptions
---@return true?
---@return string? message
---@return bw.Details? details
function bw.picture(surface, path, options) end

---@class bw.PictureOptions
---@field values? bw.Array over points or facets
---@field displacement? bw.Array a row of three for every point
---@field deformation? number factor on it; 0: chosen
---@field ghost? boolean the undeformed outline behind
---@field arrows? bw.PictureArrow[]
---@field lines? bw.Array[] lists of points, drawn as violet lines over the surface: edges of surface:singular_edges() for instance
---@field line_name? string what the lines are, for the legend
---@field labels? bw.PictureLabel[] texts at places on the surface; left out where the body is in front and over labels before
---@field title? string
---@field unit? string name and unit of the colour bar: "von Mises stress, MPa"
---@field scale? number values are multiplied by it on the bar
---@field low? number lower end of the colours
---@field high? number upper end of the colours
---@field width? integer pixels; default 1200
---@field height? integer pixels; default 900
---@field direction? bw.Vector from the object to the viewer
---@field up? bw.Vector
---@field zoom? number
---@field edges? boolean draw the facets' edges

---@class bw.PictureArrow
---@field at bw.Vector
---@field force bw.Vector

---@class bw.PictureLabel
---@field at bw.Vector
---@field text string

---PNG files of one size, as pictures of grids and surfaces are, as an animated PNG: `seconds` for each
---(0.05), over again `rounds` times (0: for ever). Browsers play it.
---@param path string
---@param pictures string[] paths
---@param options? bw.AnimationOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function bw.animation(path, pictures, options) end

---@class bw.AnimationOptions
---@field seconds? number
---@field rounds? integer
