/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places at the ends of bonds. */
#ifndef BWI_MODEL_SINGULAR_BOND_H
#define BWI_MODEL_SINGULAR_BOND_H

#include "model/singular_sector.h"

/* Adds the edges at which a bond ends on one body while the other one goes on: the angle is that of
 * both together. `border`: without a cyclic symmetry. */
bw_status bwi_bond_seams(bw_context *context, const bw_model *model,
                         const bwi_sector_border *border, bwi_seams *seams);

#endif
