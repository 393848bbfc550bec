/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solving on quadratic elements without a factor of them: conjugate gradients, preconditioned by a
 * sweep forwards over the nodes (smoother.h), the linear elements on the same corners solved
 * directly (coarse.h), and a sweep backwards.
 *
 * Bodies that can move freely are solved with their singular K: residuals are orthogonal to the
 * rigid-body modes, directions are made so (rigid_space.h), and the isostatic constraints of the
 * DOF map do not count. */
#ifndef BWI_LINEAR_TWO_LEVEL_H
#define BWI_LINEAR_TWO_LEVEL_H

#include "linear/coarse.h"
#include "linear/pcg_packed.h"
#include "linear/rigid_space.h"
#include "linear/smoother.h"

/* corner_rotations.h and stars.h */
typedef struct bwi_corner_rotations bwi_corner_rotations;
typedef struct bwi_stars bwi_stars;

/* Times at which a solution is asked whether its iterations are slow. */
enum { BWI_TWO_LEVEL_ASKED = 8 };

typedef struct bwi_two_level {
  bw_object object;
  bwi_coarse *coarse;
  bwi_corner_rotations *rotations; /* in place of it, for the shape followed; or NULL */
  bwi_smoother *smoother;
  bwi_stars *stars; /* whose sweeps take the place of the smoother's, or NULL */
  /* By corner: the rows of its own node and of the mid-edge nodes next to it. */
  int64_t *child_start;
  int32_t *child;
  int32_t *parent;           /* by row x 2: corners; twice its own */
  bw_dof_map *dof_map;       /* retained: of the shape followed */
  bwi_rigid_space *rigid;    /* of the rows; NULL where the supports leave no mode free */
  int32_t constrained_count; /* rows with a prescribed component */
  int32_t *constrained;
  /* What solutions learn (two_level_adapt.c). */
  bwi_stiffness stiffness; /* of the shape followed: its user's, until the next one */
  double fewer; /* of iterations, those that are predicted with rotations; 0: these do not help */
  bool asked;   /* for rotations, which may have been singular */
  double done[BWI_TWO_LEVEL_ASKED]; /* of a solution, in digits, when it was asked whether that is
                                       slow */
  double slow; /* iterations that one took before they were made, of this shape or another; 0 */
  /* room for `width` fields */
  int width;
  double *u, *r, *p, *q, *ku; /* ku: K u, where residuals are recomputed; of one field in q */
  float *z, *residual, *floats;
  double *corner; /* SIDES x 3 corners */
} bwi_two_level;

/* What counting says of a solution, on the reference machine (base/cost.h). Iterations do
 * not depend on the shape, but on the mesh; on a good one an iteration halves the error. */
#define BWI_TWO_LEVEL_RATE 1.45
/* Beside reading matrices: sums over fields, rows between chunks, one after the other
 * (measured). */
#define BWI_TWO_LEVEL_PASS 2.0
/* Of each further right-hand side beside one (measured: 8 cost 2.8, 12 cost 4.1 to 4.3). */
#define BWI_TWO_LEVEL_SIDE 0.28
/* Of `count` right-hand sides over one, in blocks of as many as go side by side. */
static inline double bwi_two_level_sides(int64_t count) {
  int64_t left = count % BWI_SMOOTHER_SIDES;
  double whole = (double)(count / BWI_SMOOTHER_SIDES);
  return whole * (1 + BWI_TWO_LEVEL_SIDE * (BWI_SMOOTHER_SIDES - 1)) +
         (left > 0 ? 1 + BWI_TWO_LEVEL_SIDE * (bwi_smoother_width(left) - 1) : 0);
}
/* Of following a shape over an iteration, where there is no preconditioner yet to count. */
#define BWI_TWO_LEVEL_BEGIN 12.0

/* Of a mesh for which bwi_coarse_fits, with its pattern; even, stiffness: as in
 * bwi_smoother_create. Release with bw_release. */
bw_status bwi_two_level_create(bw_context *context, const bw_mesh *mesh,
                               const bw_block_pattern *pattern, bool even,
                               const bwi_stiffness *stiffness, bwi_two_level **out);
/* The same over a coarse space of that mesh that there is already, from now on its own. */
bw_status bwi_two_level_create_over(bw_context *context, bwi_coarse *coarse, const bw_mesh *mesh,
                                    const bw_block_pattern *pattern, bool even,
                                    const bwi_stiffness *stiffness, bwi_two_level **two_level);
/* The equations of a shape, whose stiffness (block_count x 9) stays until the next one. NULL: it is
 * that of the model, as in creating, and never made whole but for stars and rotations. *usable is
 * false where they are not positive definite. */
bw_status bwi_two_level_follow(bw_context *context, bwi_two_level *two_level, const bw_model *model,
                               const bw_dof_map *dof_map, const double *stiffness, bool *usable);
/* Room for `width` fields side by side (bwi_smoother_width). */
bw_status bwi_two_level_reserve(bw_context *context, bwi_two_level *two_level, int width);
/* Gives that room back. */
void bwi_two_level_release(bwi_two_level *two_level);
/* z of the residuals in `floats`, of which `used` are real: a sweep forwards, the corners, a sweep
 * backwards. */
bw_status bwi_two_level_precondition(bw_context *context, bwi_two_level *two_level, int width,
                                     int used);

/* ---- two_level_solve.c --------------------------------------------------------------------- */

typedef struct bwi_two_level_problem {
  double tolerance;
  /* as in bwi_pcg: what the tolerance is relative to where the force is a residual; or NULL */
  const double *load, *energy;
  bool energy_alone;
  int limit;        /* on iterations */
  int64_t expected; /* right-hand sides to come, where these are a probe; or 0 */
  /* out */
  int iterations;
  bool converged;
  double reached; /* where they did not: the largest residual, relative to the load */
} bwi_two_level_problem;
/* K u = f for `count` fields in global directions, those of force taken at the unknowns; u is 0
 * elsewhere. Of a body that can move freely forces have to be balanced, and u is one of the
 * solutions. Not converged is no failure. The two may not be the same block. Where iterations are
 * slow for a reason that rotations cure, corners rotate from there on. */
bw_status bwi_two_level_solve(bw_context *context, bwi_two_level *two_level,
                              bwi_two_level_problem *problem, int64_t count, const double *force,
                              double *displacement);
/* For iterations of others, of `count` fields: a few of a solution under random forces, to see
 * whether these are slow. */
bw_status bwi_two_level_probe(bw_context *context, bwi_two_level *two_level, int64_t count);

/* ---- two_level_adapt.c --------------------------------------------------------------------- */

/* What a shape that is followed says: before its first solution. */
void bwi_two_level_forget(bwi_two_level *two_level, const bw_model *model);
/* Stars (stars.h), and corners that rotate, where the body is so nearly incompressible that they
 * are predicted to pay for one solution. */
bw_status bwi_two_level_take_stars(bw_context *context, bwi_two_level *two_level,
                                   const bw_model *model);
/* Corners rotate (corner_rotations.h) where solutions of another shape were slow without, and that
 * is predicted to pay for `count` right-hand sides. */
bw_status bwi_two_level_remember(bw_context *context, bwi_two_level *two_level, int64_t count);
/* Seconds of the reference machine of an iteration for one right-hand side, with what it has by
 * now.
 */
double bwi_two_level_seconds(const bwi_two_level *two_level);
/* bwi_pcg_task.adapt. The same, where the iterations of this solution are slow. */
typedef struct bwi_two_level_watch {
  bwi_two_level *two_level;
  const int64_t *count; /* right-hand sides of this solution that are left, or to come */
} bwi_two_level_watch;
bw_status bwi_two_level_adapt(bw_context *context, void *watch, int iterations, double done);
/* Says in a report that corners rotate, where they do. */
void bwi_two_level_say(const bwi_two_level *two_level, bw_solver_report *report);

#endif
