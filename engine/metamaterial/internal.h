/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of this folder share: fitting a coarse material to a block of finer ones, and
 * comparing materials. Everything here is a pure function of its arguments: the same bits on any
 * thread. */
#ifndef BWI_METAMATERIAL_INTERNAL_H
#define BWI_METAMATERIAL_INTERNAL_H

#include "barwright/metamaterial.h"

/* ---- fitting --------------------------------------------------------------------------------- */

/* One to eight equal cubes side by side. The child at (i, j, k) is number
 * i + size[0] (j + size[1] k), so that in a 2 x 2 x 2 block child c is in octant c. NULL is
 * void. */
typedef struct bwi_block {
  int32_t size[3]; /* 1 or 2 each */
  const bw_solid_material *child[8];
} bwi_block;

/* Memory of one fit at a time; kept from fit to fit, one for each thread. It does not influence
 * results. */
typedef struct bwi_fit_workspace bwi_fit_workspace;
bw_status bwi_fit_workspace_create(bw_context *context, const bw_library_options *options,
                                   bwi_fit_workspace **workspace);
void bwi_fit_workspace_destroy(bwi_fit_workspace *workspace);
/* What fits in this workspace report as progress, again and again, so that the caller can cancel
 * within one; stage NULL (at first): nothing. `stage` outlives the fits. */
void bwi_fit_workspace_report(bwi_fit_workspace *workspace, const char *stage, double fraction);

/* The material that a single cell in place of a 2 x 2 x 2 block is to be given: always of 8 points,
 * one for each octant, whatever the children's points; so it is again a child for the next level.
 * Other blocks are BW_INVALID, a block of void alone BW_EMPTY. Of the options, directions,
 * magnitudes, stretches, fibres, strain and ridge are used, and `seed` instead of theirs, so that
 * each block can have its own. The density is the mean. The rule of the fitted material is in
 * general narrower than Gauss's (see bw_rule::spread). `error` may be NULL.
 *
 * What the library relies on: a symmetry of the cube that takes the block into itself takes the
 * fitted material into itself, up to rounding (one fit serves all keys that turn into each other,
 * so that without this a body and its mirror image would differ). Points of void have
 * BWI_VOID_PART of the mean constants of the other points, and BWI_VOID_LAW, so that a coarse cell
 * with little in it holds its nodes, as partial cells of a solid do. */
#define BWI_VOID_PART 1e-3
/* Defined whatever the deformation. */
#define BWI_VOID_LAW ((uint8_t)BW_ST_VENANT_KIRCHHOFF)
bw_status bwi_fit(bw_context *context, const bwi_block *block, const bw_library_options *options,
                  uint64_t seed, bwi_fit_workspace *workspace, bw_solid_material **fitted,
                  bw_fit_error *error);
/* What naive coarsening gives: the constants of the children, point by point: 8 points where all
 * are uniform (or void), 64 where they have 8 points each: child c's are 8 c to 8 c + 7. */
bw_status bwi_fit_naive(bw_context *context, const bwi_block *block, bw_solid_material **naive);

/* ---- comparing ----------------------------------------------------------------------------------
 *
 * Materials are compared by their linear elasticity at rest: the stiffness of a unit cube, 24 x 24
 * row by row, corner by corner. Blocks are compared by the stiffness that their corners feel
 * through them when each cube is given by such a matrix, so that pairs need no fit of their own. */
enum { BWI_FEATURES = 32 };

void bwi_material_stiffness(const bw_solid_material *material, double stiffness[576]);
/* `child` as in bwi_block, each a 24 x 24 matrix or NULL for void. The corners of the block, which
 * may be longer in some directions, take the place of those of a cube; forces are spread over its
 * nodes as when the block is fitted. Zero for void alone. */
void bwi_block_stiffness(const int32_t size[3], const double *const child[8],
                         double stiffness[576]);
/* Logarithms of the energies in BWI_FEATURES deformations, the same for all: the coordinates in
 * which distance measures difference (the paper's formula 5). */
void bwi_features(const double stiffness[576], double feature[BWI_FEATURES]);

#endif
