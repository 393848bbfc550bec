/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A coarse space for conjugate gradients on quadratic elements: the fields that are linear in every
 * element, which the corner nodes span. Their Galerkin matrix is the stiffness of the linear
 * elements; it has an eighth of the unknowns and is factored in a hundredth of the time.
 *
 * With P from corners to all nodes, A = P^T K P is exact because elements are straight and because
 * a corner takes part only with unknowns that the supports leave to the middle nodes around it too.
 */
#ifndef BWI_SOLVE_COARSE_H
#define BWI_SOLVE_COARSE_H

#include "solve/internal.h"

typedef struct bwi_coarse bwi_coarse;

/* Whether bodies have one: quadratic elements, none free to move (pins at single nodes, which make
 * those definite, would not let linear fields pass). */
bool bwi_coarse_fits(const bw_mesh *mesh, const bw_numbering *numbering);
/* Of a mesh of quadratic elements. Release with bw_release. */
bw_status bwi_coarse_create(bw_context *context, const bw_mesh *mesh, bwi_coarse **out);
/* The space on a shape, factored. *usable is false where its matrix is singular, and before. */
bw_status bwi_coarse_follow(bw_context *context, bwi_coarse *coarse, const bw_model *model,
                            const bw_numbering *numbering, bool *usable);
/* u += P A^-1 P^T r for `count` fields; `r` is not changed. */
bw_status bwi_coarse_add(bw_context *context, const bwi_coarse *coarse, int64_t count,
                         const double *r, double *u);

#endif
