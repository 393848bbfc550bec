-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The solid modeller: surfaces of solids whose faces have names (bw.surface).
require "barwright.modeller.solids"
require "barwright.modeller.primitives"
require "barwright.modeller.copies"
