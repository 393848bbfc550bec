/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies that can move freely, between their singular stiffness and the regular one that isostatic
 * constraints leave (docs/theory/preconditioners.md).
 *
 * Let S u = u - R c be the field without the rigid-body motion that it has at the constraints, so
 * that S u is 0 there. Then S K^+ S^T is the inverse of the regular stiffness, and S B S^T is as
 * good a preconditioner of it as B is of K. */
#ifndef BWI_LINEAR_ISOSTATIC_H
#define BWI_LINEAR_ISOSTATIC_H

#include "barwright/model.h"

typedef struct bwi_isostatic bwi_isostatic;

/* Of a DOF map with rigid-body modes. Release with bw_release. */
bw_status bwi_isostatic_create(bw_context *context, const bw_dof_map *dof_map,
                               bwi_isostatic **isostatic);
/* r = S^T r for `count` fields: forces at the constraints balance those that are 0 there. */
bw_status bwi_isostatic_balance(bw_context *context, const bwi_isostatic *isostatic, int64_t count,
                                double *r);
/* u = S u, 0 at the constraints but for rounding. */
bw_status bwi_isostatic_remove(bw_context *context, const bwi_isostatic *isostatic, int64_t count,
                               double *u);

#endif
