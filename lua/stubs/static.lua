---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Static solutions
--
-- Displacements, stresses, reactions and errors of a static solution.

---A static solution. Fields are computed when they are first asked for. Names without `element_` are
---over nodes.
---@class bw.Static
---@field displacement bw.Array m
---@field force bw.Array applied, N
---@field reaction bw.Array at held nodes, N
---@field stress bw.Array node_count x 6, Pa
---@field von_mises bw.Array
---@field principal bw.Array descending
---@field principal_directions bw.Array node_count x 9: rows of unit vectors
---@field max_principal bw.Array largest in size
---@field element_stress bw.Array element_count x 6, Pa
---@field element_von_mises bw.Array
---@field element_principal bw.Array
---@field element_max_principal bw.Array
---@field element_energy bw.Array J
---@field utilisation bw.Array stress over strength, of elements
---@field energy number strain energy, J
---@field residual number |K u - f| / |f|
---@field locking string? as of bw.Model
---@field mesh bw.Mesh
---@field material bw.Material
---@field times table? seconds of graph, stiffness, order, factor, pcg, solve; factor_entries, factor_flops; nil in an edit session and of PETSc
---@field solver table? with ("factor", "pcg"), iterations (by two-level PCG), residual, factor_bytes and factor_flops (by two-level PCG: as predicted), coarse_unknowns (of the linear elements), and where a choice was made predicted_factor and predicted_pcg (s, of the model's machine); of PETSc: with, method, ranks, iterations, send_seconds, setup_seconds, solve_seconds, processor_seconds and peak_bytes of all ranks, largest_rank_bytes; nil in an edit session
---@field reused table? in an edit session: pattern, ordering, pieces, pieces_kept, pieces_turned, pieces_touched, method, factor_kept, iterations, precision (of the factor, bits: 32 or 64), refinements (iterations that a factor of 32 bits took), predicted_refactor, predicted_iterate, predicted_pcg, seconds_unknowns, seconds_stiffness, seconds_factor, seconds_solve, mesh, and with `check` difference_stiffness, difference_solution
local Static = {}

---Zienkiewicz-Zhu: relative error of the whole body in the energy norm, and the error energy of every element. It is
---a mean: the largest stress may be off by more, and facets that stand for a round face are not in it. The error
---of one quantity is that of `part:solve {error = , of = }`.
---@return number? relative
---@return bw.Array elements
function Static:error_estimate() end

---The sum of the reactions on a selection, N.
---@param selection bw.Selection
---@return bw.Vector
function Static:reaction_on(selection) end

---The effective stress of the theory of critical distances at singular edges, the largest first: the mean of the
---stress over 2 L from the edge along the bisector ("line"), or the stress at L / 2 ("point"). It converges where the
---largest stress does not. length: L in m (default: the material's critical_distance); places: those to look at
---(default: the re-entrant edges of the mesh's boundary). Of every place the station of the largest value counts:
---value (largest principal, Pa), stress (the tensor), utilisation, at, estimated_error (relative), edge_length (of the
---elements there, m). nil, a message and details where the length is not known or no line stays in the body.
---`static:effective_stress {places = part:singular_places(), length = 1e-3}`
---@param options? bw.EffectiveStressOptions
---@return bw.EffectiveStress[]?
---@return string? message
---@return bw.Details? details
function Static:effective_stress(options) end

---@class bw.EffectiveStressOptions
---@field places? bw.SingularPlaces
---@field length? number
---@field method? "line"|"point"

---@class bw.EffectiveStress
---@field place bw.SingularPlace
---@field number integer
---@field at number[]
---@field value number
---@field stress number[]
---@field utilisation number?
---@field length number
---@field method string
---@field edge_length number
---@field estimated_error number

---The notch stress intensity factor K of singular edges, the largest first: the normal stress across the bisector is
---K / sqrt(2 pi) r^(exponent - 1) at small distances r. value in Pa m^(1 - exponent). shear: that of the shear stress on
---the bisector, with its own exponent; radial: the stress along the bisector over that across it.
---@param options? bw.NotchStressIntensityOptions
---@return bw.NotchStressIntensity[]?
---@return string? message
---@return bw.Details? details
function Static:notch_stress_intensity(options) end

---@class bw.NotchStressIntensityOptions
---@field places? bw.SingularPlaces

---@class bw.NotchStressIntensity
---@field place bw.SingularPlace
---@field number integer
---@field at number[]
---@field value number
---@field exponent number
---@field shear number
---@field shear_exponent number
---@field radial number
---@field edge_length number
---@field estimated_error number

---The largest stress that re-entrant edges would have with a fillet of a radius (m), the largest first, from their
---notch stress intensity factors. For radii that are small beside the notch (docs/theory/singular.md). estimated_error
---(relative): that of the factor, and 0.1 for the formula.
---`print(static:fillet_stress({radius = 1e-3})[1].value)`
---@param options bw.FilletStressOptions
---@return bw.FilletStress[]?
---@return string? message
---@return bw.Details? details
function Static:fillet_stress(options) end

---@class bw.FilletStressOptions
---@field radius number
---@field places? bw.SingularPlaces

---@class bw.FilletStress
---@field place bw.SingularPlace
---@field number integer
---@field at number[]
---@field value number
---@field intensity number
---@field radius number
---@field estimated_error number

---Displacement and stresses as .vtu, with further fields.
---@param path string
---@param options? bw.StaticWriteOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Static:write(path, options) end

---@class bw.StaticWriteOptions
---@field fields? table<string, bw.Array>

---The deformed shape coloured by a field: "von_mises" (default), "max_principal", "displacement",
---"utilisation", ..., or an array over nodes or elements.
---@param path string
---@param options? bw.PictureOptions with `field`
---@return true?
function Static:picture(path, options) end

---Lets go at once.
function Static:close() end
