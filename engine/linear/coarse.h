/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse space of two_level.h on quadratic elements: the fields that are linear in every
 * element, which the corner nodes span. Their Galerkin matrix is the stiffness of the linear
 * elements; it has an eighth of the unknowns and is factored in a hundredth of the time. Where the
 * factor costs more all the same, by count, a cycle of multigrid (amg.h) takes its place.
 *
 * With P from corners to all nodes, A = P^T K P is exact because elements are straight and because
 * a corner moves only in directions that the supports leave to the mid-edge nodes around it. On
 * curved supports these differ a little, and A approximates.
 *
 * Supports may leave rigid-body modes free. They are linear fields, so that A is singular as K is:
 * A^+ = Q A_c^-1 Q with isostatic constraints of its own in A_c, and Q the projector of
 * rigid_space.h. Those of K would not let linear fields pass. */
#ifndef BWI_LINEAR_COARSE_H
#define BWI_LINEAR_COARSE_H

#include "linear/internal.h"
#include "linear/rigid_space.h"

typedef struct bwi_coarse bwi_coarse;

/* Whether a body has one: quadratic elements. */
bool bwi_coarse_fits(const bw_mesh *mesh);
/* Of a mesh of quadratic elements. Release with bw_release. */
bw_status bwi_coarse_create(bw_context *context, const bw_mesh *mesh, bwi_coarse **out);
/* Unknowns, order and size of its factor for these supports; nothing is factored yet. */
bw_status bwi_coarse_count(bw_context *context, bwi_coarse *coarse, const bw_dof_map *dof_map);
/* The space on a shape, with its factor or multigrid. *usable is false where its matrix is
 * singular, and before. */
bw_status bwi_coarse_follow(bw_context *context, bwi_coarse *coarse, const bw_model *model,
                            const bw_dof_map *dof_map, bool *usable);
/* x = A^-1 x for `count` fields on the corners (count x corners x 3), to the digits of floats, or
 * near it by a cycle; of bodies that can move freely x = A^+ x, with the pseudo-inverse. At most
 * BWI_RIGID_FIELDS. */
bw_status bwi_coarse_solve(bw_context *context, const bwi_coarse *coarse, int64_t count, double *x);
int32_t bwi_coarse_corners(const bwi_coarse *coarse);
/* By corner: its node, ascending. */
const int32_t *bwi_coarse_nodes(const bwi_coarse *coarse);
/* By node x 2: the corners between which it lies; twice itself. */
const int32_t *bwi_coarse_parents(const bwi_coarse *coarse);
/* Bytes that a solution reads; 0 before a shape is followed. */
double bwi_coarse_bytes(const bwi_coarse *coarse);
/* The same predicted, and what factor or multigrid cost: s of the reference machine. Whether it is
 * multigrid. After they are counted. */
double bwi_coarse_pass_bytes(const bwi_coarse *coarse);
double bwi_coarse_seconds(const bwi_coarse *coarse);
bool bwi_coarse_iterative(const bwi_coarse *coarse);
/* Operations of its factor, numbers in it, unknowns: 0 before they are counted. */
double bwi_coarse_flops(const bwi_coarse *coarse);
double bwi_coarse_entries(const bwi_coarse *coarse);
int32_t bwi_coarse_unknowns(const bwi_coarse *coarse);

/* ---- what any space on the corners needs ----------------------------------------------------- */

/* The frames of the corners in `corners`, and `unknown` (corners x 3): 0, or -1 where the DOF map
 * of the body prescribes. Isostatic constraints are unknowns here. */
void bwi_coarse_supports(const bwi_coarse *coarse, const bw_dof_map *dof_map, bw_dof_map *corners,
                         int32_t *unknown);
/* Isostatic constraints of the corners where supports leave rigid-body modes free; else *rigid is
 * NULL. `former` and `unknown`: as in bwi_rigid_space_constrain. */
bw_status bwi_coarse_constrain(bw_context *context, const bwi_coarse *coarse,
                               const bw_dof_map *dof_map, const bwi_rigid_space *former,
                               int32_t *unknown, bwi_rigid_space **rigid);
/* x = A^-1 x for `count` fields. */
typedef bw_status bwi_coarse_solver(bw_context *context, const void *data, int64_t count,
                                    double *x);
/* Whether a factor has the digits: refinement changes little of its solution for a load. */
bw_status bwi_coarse_check_digits(bw_context *context, const bw_block_pattern *pattern,
                                  const double *stiffness, bwi_coarse_solver *solve,
                                  const void *data, const double *load, bool *enough);

#endif
