---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Materials
--
-- Linear elastic materials: those of the library, isotropic and orthotropic laws of one's own.

---Materials of the library by name, `bw.material.steel`, and laws of one's own. An unknown name raises an error that
---names the nearest.
---@class bw.MaterialModule
---@field steel bw.Material structural steel S235
---@field aluminium bw.Material the alloy EN AW-6061 T6
---@field pla bw.Material polylactic acid, values of the resin
---@field abs bw.Material acrylonitrile butadiene styrene, printed by fused deposition
---@field resin bw.Material photopolymer of stereolithography, post-cured
---@field green_state_stainless_steel bw.Material of Zhou, Panetta and Zorin 2013
---@field nylon_pa2200 bw.Material of Zhou, Panetta and Zorin 2013
---@field zp150 bw.Material of Zhou, Panetta and Zorin 2013: printed plaster, orthotropic
local material_module = {}

---An isotropic material. Constants outside their ranges raise.
---```lua
---local petg = bw.material.isotropic {young = 2.1e9, poisson = 0.38, strength = 47e6, density = 1270, name = "petg"}
---print(petg.shear) -- 760869565.21739
---```
---@param options bw.MaterialIsotropicOptions its constants
---@return bw.Material material the law
function material_module.isotropic(options) end

---Constants of an isotropic material.
---@class bw.MaterialIsotropicOptions
---@field young number (Pa) Young's modulus, above 0
---@field poisson? number (-) Poisson's ratio. Range: above -1, below 0.5. Default: 0
---@field density? number (kg/m3) 0: not known. Default: 0
---@field strength? number (Pa) tensile strength; 0: not known. Default: 0
---@field toughness? number (Pa m^0.5) fracture toughness K_Ic; 0: not known. Default: 0
---@field expansion? number (1/K) coefficient of linear expansion, alike in all directions. Default: 0
---@field conductivity? number|number[][] (W/(m K), n × 2) thermal conductivity, or up to 16 rows {temperature, conductivity} of ascending temperatures (K), linear between and constant outside; 0: not known. Default: 0
---@field heat_capacity? number (J/(kg K)) heat capacity per mass; 0: not known. Default: 0
---@field name? string for `print`. Default: none

---An orthotropic material, by nine constants along its axes 1, 2 and 3. Constants that do not belong to a stable material,
---or contradict each other, raise.
---
---Source: the default of the shear moduli, 1/G_ij = 1/Y_i + 1/Y_j + 2 nu_ij/Y_i, is that of Zhou, Panetta and Zorin 2013,
---section 6.
---```lua
---local wood = bw.material.orthotropic {young = {11e9, 0.9e9, 0.5e9}, poisson_t = {0.3, 0.02, 0.03}, name = "wood"}
---print(wood)
---```
---@param options bw.MaterialOrthotropicOptions its constants
---@return bw.Material material the law
function material_module.orthotropic(options) end

---Constants of an orthotropic material. nu_ij is the contraction along j under a load along i.
---@class bw.MaterialOrthotropicOptions
---@field young bw.Vector (Pa) Young's moduli Y1, Y2, Y3, above 0
---@field poisson? bw.Vector (-) Poisson's ratios nu23, nu31, nu12. Default: from `poisson_t` by nu_ij/Y_i = nu_ji/Y_j
---@field poisson_t? bw.Vector (-) Poisson's ratios nu32, nu13, nu21. Default: from `poisson`
---@field shear? bw.Vector (Pa) shear moduli G23, G31, G12. Default: from Y and nu, see above
---@field axes? number[][]|bw.Array (-, 3 × 3) a rotation, whose rows are the material axes. Default: x, y and z
---@field density? number (kg/m3) 0: not known. Default: 0
---@field strength? bw.Vector (Pa) tensile strengths along the axes; 0: not known. Default: 0
---@field toughness? number (Pa m^0.5) fracture toughness K_Ic; 0: not known. Default: 0
---@field expansion? number (1/K) coefficient of linear expansion, alike in all directions. Default: 0
---@field conductivity? number|bw.Vector (W/(m K)) thermal conductivity, or three along the axes; 0: not known. Default: 0
---@field heat_capacity? number (J/(kg K)) heat capacity per mass; 0: not known. Default: 0
---@field name? string for `print`. Default: none

---A material of the library. An unknown name raises an error that names the nearest.
---```lua
---local steel = bw.material.named "steel"
---print(steel.young, steel.sources.young_1.source)
---```
---@param name string as in `bw.material.names()`
---@return bw.Material material the law
function material_module.named(name) end

---The names of the library's materials.
---```lua
---local names = bw.material.names()
---print(table.concat(names, ", "))
---```
---@return string[] names in the order of the library
function material_module.names() end

---A linear elastic law. Constants are one number where the material is isotropic, else three, along its axes. `print` shows
---constants, scatter and sources.
---```lua
---local abs = bw.material.abs
---print(abs, abs.critical_distance)
---```
---@class bw.Material
---@field name string as it was given; "" where none was
---@field isotropic boolean whether it is
---@field young number|bw.Vector (Pa) Young's moduli Y1, Y2, Y3
---@field poisson number|bw.Vector (-) Poisson's ratios nu23, nu31, nu12
---@field shear number|bw.Vector (Pa) shear moduli G23, G31, G12
---@field density number? (kg/m3) nil where it is not known
---@field strength number|bw.Vector|nil (Pa) tensile strengths; nil where they are not known
---@field toughness number? (Pa m^0.5) fracture toughness K_Ic; nil where it is not known
---@field expansion number? (1/K) coefficient of linear expansion; nil where it is none. `steel` has that of EN 1993-1-1, 3.2.6, `aluminium` that of EN 1999-1-1, 3.2.5
---@field parts bw.Material[]? of a model with several materials: each of them once. Density, strength and toughness are then the least of them, and moduli are nil. nil where there is one material
---@field conductivity number|bw.Vector|nil (W/(m K)) thermal conductivity, along the axes of an orthotropic material; of a table its first row; nil where it is not known
---@field heat_capacity number? (J/(kg K)) per mass; nil where it is not known
---@field critical_distance number? (m) (toughness / strength)^2 / pi, by the largest strength; nil where it is not known
---@field axes bw.Array (-, 3 × 3) rows are the material axes
---@field rotated_by_element boolean whether the axes differ from element to element, as in an edit session with `rotate_material`; `axes` and `elasticity` are then those before
---@field elasticity bw.Array (Pa, 6 × 6) in the order xx yy zz yz zx xy, for engineering shear strains, in directions of space
---@field sources table<string, bw.MaterialSource> by value: young_1, poisson_12, strength_1, ..., conductivity_1, heat_capacity, density, toughness, critical_distance
local Material = {}

---Where a value of a material comes from, in the unit of the value.
---@class bw.MaterialSource
---@field mean number (any) the value
---@field scatter number? (any) its standard deviation; nil where it is not known
---@field source string? in words; nil where the user gave the value

---The material rotated: each of its axes goes to R times the axis. A matrix that is no rotation raises.
---@param rotation number[][]|bw.Array (-, 3 × 3) R
---@return bw.Material material the rotated law
function Material:rotated(rotation) end

---Tensile strength along a direction; nil where it is not known.
---@param direction bw.Vector (-) of any length but 0
---@return number? strength (Pa) the strength
function Material:strength_along(direction) end

---Stress over strength: the largest over the principal stresses, each by its magnitude over the tensile strength along its
---direction; 0 where the strength is not known. A material that differs from element to element takes the stresses of
---all elements in their order.
---@param stress bw.Array|number[][] (Pa, n × 6) stress tensors
---@return bw.Array utilisation (-, n × 1) 1 where the strength is reached
function Material:utilisation(stress) end

---Releases the material at once.
function Material:close() end
