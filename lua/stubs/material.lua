---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Materials
--
-- Linear elastic materials: the library, isotropic and orthotropic laws.

---`bw.material.steel` and the others of the library by name.
---@class bw.MaterialModule
---@field steel bw.Material
---@field aluminium bw.Material
---@field pla bw.Material
---@field abs bw.Material
---@field resin bw.Material
---@field green_state_stainless_steel bw.Material of the worst-case paper
---@field nylon_pa2200 bw.Material of the worst-case paper
---@field zp150 bw.Material of the worst-case paper: printed plaster, three strengths
local material_module = {}

---Young's modulus and strength in Pa, density in kg/m3, toughness: the fracture toughness K_Ic in Pa m^0.5.
---@param options bw.MaterialIsotropicOptions
---@return bw.Material?
function material_module.isotropic(options) end

---@class bw.MaterialIsotropicOptions
---@field young number
---@field poisson number
---@field density? number
---@field strength? number
---@field toughness? number
---@field name? string

---Nine constants along the material axes 1 2 3: young Y1 Y2 Y3, poisson nu23 nu31 nu12 (or the
---transposed poisson_t nu32 nu13 nu21), shear G23 G31 G12 (left out: the worst-case paper's formula),
---axes as rows of a rotation.
---@param options bw.MaterialOrthotropicOptions
---@return bw.Material?
function material_module.orthotropic(options) end

---@class bw.MaterialOrthotropicOptions
---@field young bw.Vector
---@field poisson? bw.Vector
---@field poisson_t? bw.Vector
---@field shear? bw.Vector
---@field axes? number[][]
---@field density? number
---@field strength? bw.Vector
---@field toughness? number
---@field name? string

---A material of the library.
---@param name string
---@return bw.Material?
function material_module.named(name) end

---The names of the library.
---@return string[]
function material_module.names() end

---A linear elastic law. Constants are numbers where it is isotropic, else tables of three.
---@class bw.Material
---@field name string
---@field isotropic boolean
---@field young number|bw.Vector Pa
---@field poisson number|bw.Vector
---@field shear number|bw.Vector Pa
---@field density number? kg/m3
---@field strength number|bw.Vector|nil Pa
---@field toughness number? fracture toughness K_Ic, Pa m^0.5; nil where no published value fits the material
---@field critical_distance number? m: (toughness / strength)^2 / pi, by the largest strength
---@field axes bw.Array 3 x 3, rows are the material axes
---@field turned boolean whether axes differ from element to element (an edit session's, with material_turns); `axes` and `elasticity` are then those before
---@field elasticity bw.Array 6 x 6, Pa
---@field sources table<string, bw.MaterialSource> where values come from and their standard deviations: young_1, poisson_12, strength_1, ..., density, toughness, critical_distance
local Material = {}

---@class bw.MaterialSource
---@field mean number
---@field scatter number?
---@field source string?

---Turned by a rotation, three rows of three.
---@param rotation number[][]
---@return bw.Material?
function Material:rotated(rotation) end

---Tensile strength along a direction; nil when not known.
---@param direction bw.Vector
---@return number?
function Material:strength_along(direction) end

---Stress over strength, the largest over the principal stresses, of rows of stress tensors. Of a
---material turned by element: of the stresses of all elements.
---@param stress bw.Array
---@return bw.Array?
function Material:utilisation(stress) end

---Lets go at once.
function Material:close() end
