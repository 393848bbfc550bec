/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of solids share. */
#ifndef BWI_NONLINEAR_INTERNAL_H
#define BWI_NONLINEAR_INTERNAL_H

#include "barwright/nonlinear.h"

/* The part of a cell that counts at least, so that a cell which is hardly cut holds its nodes. */
#define BWI_LEAST_FRACTION 1e-3

/* Volume of an element that energy and mass are multiplied with, m3. */
static inline double bwi_solid_volume(const bw_grid *grid, int32_t element) {
  double fraction = grid->fraction ? grid->fraction[element] : 1;
  return grid->spacing[0] * grid->spacing[1] * grid->spacing[2] *
         (fraction > BWI_LEAST_FRACTION ? fraction : BWI_LEAST_FRACTION);
}

#endif
