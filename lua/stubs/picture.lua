---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Pictures
--
-- Shaded pictures of surfaces as PNG files, without a display. Meshes, solutions and modes have a method `picture` with
-- the same options.

---@class bw
local bw = {}

---Draws a surface as a PNG file: shaded, coloured by values, deformed, with arrows, lines and labels. The largest value is
---marked. The same input gives the same bytes for any number of threads.
---
---Errors: io (the file cannot be written), geometry (coordinates are too large), unsupported (the name of the file ends in
---neither .png nor .apng).
---```lua
---local ball = bw.surface.sphere {radius = 0.01, subdivisions = 4}
---local height = ball.points:column(3)
---assert(bw.picture(ball, "ball.png", {values = height, scale = 1e3, unit = "height, mm", width = 400, height = 300}))
---```
---@param surface bw.Surface what is drawn
---@param path string the PNG file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function bw.picture(surface, path, options) end

---How a picture is drawn.
---@class bw.PictureOptions
---@field values? bw.Array (any, n × 1, per point or per triangle) what colours the surface; grey where not finite. Methods `picture` of meshes take values of nodes or elements. Default: none
---@field displacement? bw.Array (m, n × 3, per point) how the surface is deformed. Default: none
---@field deformation? number (-) factor on `displacement`. Default: 0, such that the largest displacement is a twentieth of the box
---@field ghost? boolean draw the undeformed shape in grey behind. Default: false
---@field arrows? bw.PictureArrow[] forces. Range: at most 10000. The longest is a fifth of the box's diagonal, and its force is written beside it
---@field lines? (bw.Array|number[][])[] violet lines over the surface: lists of points, in m, such as the points of a `bw.SingularPlace`
---@field line_name? string what the lines are, for the legend
---@field labels? bw.PictureLabel[] texts at places; one is left out where the body hides the place or an earlier label is there
---@field title? string a line of text at the top
---@field unit? string name and unit for the colour bar, such as "von Mises stress, MPa"
---@field scale? number (-) values are multiplied by it for the colour bar. Default: 1
---@field min? number (any) lower end of the colours, before `scale`. Default: the smallest value
---@field max? number (any) upper end of the colours, before `scale`. Default: the largest value
---@field width? integer (pixels) of the picture. Range: 64 to 16384. Default: 1200
---@field height? integer (pixels) of the picture. Range: 64 to 16384. Default: 900
---@field direction? bw.Vector (-) from the object to the viewer. Default: from the front right and above, turned such that the largest value and the arrows show
---@field up? bw.Vector (-) the direction that is up in the picture. Default: {0, 0, 1}
---@field zoom? number (-) 1: the body fills the picture. Range: above 0 to 10000. Default: 1
---@field edges? boolean draw the edges of triangles. Default: false; of `mesh:picture`: true

---A force in a picture.
---@class bw.PictureArrow
---@field at bw.Vector (m) where it acts; an arrow that pushes ends there, one that pulls begins there
---@field force bw.Vector (N) the force
---@field area? number (m2) the area that it stands for

---A text in a picture.
---@class bw.PictureLabel
---@field at bw.Vector (m) the place
---@field text string what is written

---Makes an animated PNG of PNG files of one size, such as those of `bw.picture`. Browsers play it; other programs show the
---first picture. Pictures of different sizes raise.
---
---Errors: io (a file cannot be read or written), format (a file is no PNG, or damaged), unsupported (the name of the file ends in
---neither .png nor .apng).
---```lua
---local ball, names = bw.surface.sphere {radius = 0.01}, {"1.png", "2.png"}
---for i, name in ipairs(names) do assert(bw.picture(ball, name, {zoom = i / 2, width = 200, height = 150})) end
---assert(bw.animation("ball.png", names, {seconds = 0.5}))
---```
---@param path string the file that is written
---@param pictures string[] paths of PNG files. Range: 1 to 10000 of them
---@param options? bw.AnimationOptions how it plays
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function bw.animation(path, pictures, options) end

---How an animation plays.
---@class bw.AnimationOptions
---@field seconds? number (s) how long each picture is shown. Range: 0.001 to 60. Default: 0.05
---@field rounds? integer (count) how often it plays; 0: for ever. Default: 0
