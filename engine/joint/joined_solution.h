/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A joined model solved for many right-hand sides, and as a static solution in the end
 * (docs/theory/joints.md, "Many loads"; docs/theory/contact.md, "Joined bodies"). */
#ifndef BWI_JOINT_JOINED_SOLUTION_H
#define BWI_JOINT_JOINED_SOLUTION_H

#include "joint/internal.h"

typedef struct bwi_joined_solution bwi_joined_solution;
/* u = P T A^-1 T^T P^T f, where A is T^T K T with one unknown held for each motion.
 *
 * Invariant: the motions R span the null space of T^T K T, and T reproduces them. So A is positive
 * definite, and a balanced load exerts nothing at the unknowns that are held. */
struct bwi_joined_solution {
  bwi_joined_equations q;
  int motions;
  double *motion;       /* motions x 3 node_count: R */
  double *weighted;     /* motions x 3 node_count: W R, with R^T W R = 1 */
  uint8_t *held;        /* unknown_count: not 0 where an unknown is held instead of a motion */
  int64_t *at;          /* motions: the component (3 node + axis) that each of these unknowns is */
  bw_operator *inverse; /* A^-1 */
};
void bwi_joined_solution_destroy(void *solution);
/* Makes R^T W R = 1 with the weights of `mass` over `scale`, and W R. BW_GEOMETRY for bonds that
 * resist R: of bodies of the size `length`. */
bw_status bwi_joined_solution_weigh(bw_context *context, const bw_model *model, const double *mass,
                                    double scale, double length, bwi_joined_solution *solution);
/* The equations of a solution with its motions, which they keep; it is released on failure too.
 * `start` (s): when it was begun. BW_UNSUPPORTED for a solver that is no factor. */
bw_status bwi_joined_solution_system(bw_context *context, const bw_model *model,
                                     const bw_solver *solver, const bw_dof_map *dof_map,
                                     double start, bwi_joined_solution *solution, bw_system **out);

/* ---- joined_parts.c -------------------------------------------------------------------------- */

/* The equations of a joined model whose bodies may move against one another until contact stops
 * them. The DOF map is that of the bodies apart. *solution is kept by *system. BW_LIMIT for too
 * many motions; those of bw_joined_system but for preloads and prescribed displacements. */
bw_status bwi_joined_parts_system(bw_context *context, const bw_model *model,
                                  const bw_solver *solver, const bwi_joined_solution **solution,
                                  bw_system **system);
/* The loads of such a model with those of preloads and remote points, less what prescribed values
 * exert (N, node_count x 3), and the displacement by them, apart from R: result->force and
 * result->displacement of a new object. */
bw_status bwi_joined_parts_start(bw_context *context, const bw_model *model, bw_system *system,
                                 const bwi_joined_solution *solution, bw_static **result);
/* The static solution under balanced loads, with the place of the bodies along R as in `now`
 * (m, node_count x 3). `model` is the solution's with other loads. */
bw_status bwi_joined_parts_static(bw_context *context, const bw_model *model,
                                  const bwi_joined_solution *solution, const double *now,
                                  bw_static **result);
/* Whether both have the same displacements and the same stiffness. NULL: without joints. */
bool bwi_joined_parts_same(const bwi_joined_solution *a, const bwi_joined_solution *b);

#endif
