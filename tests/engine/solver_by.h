/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solvers of systems that follow edits or outlines, and of solids, by the way that they work. */
#ifndef SOLVER_BY_H
#define SOLVER_BY_H

#include "check.h"

/* How systems that follow edits solve. */
typedef enum edit_way { WAY_AUTO, WAY_REFACTOR, WAY_ITERATE, WAY_FULL, WAY_PCG } edit_way;

/* What a reuse says of it. */
static inline edit_way way_of(const bw_reuse *reuse) {
  if (!reuse->solver)
    return WAY_AUTO;
  if (strcmp(reuse->solver, "cholesky") == 0)
    return reuse->full ? WAY_FULL : WAY_REFACTOR;
  return strcmp(reuse->preconditioner, "two_level") == 0 ? WAY_PCG : WAY_ITERATE;
}

/* The solver of a way; borrowed for ever. */
static inline const bw_solver *solver_by(edit_way way) {
  static const bw_solver factor = {.options = {.kind = BW_SOLVER_CHOLESKY}};
  static const bw_solver full = {.options = {.kind = BW_SOLVER_CHOLESKY, .full = true}};
  static const bw_solver two_level = {.options = {.kind = BW_SOLVER_PCG}};
  static const bw_solver iterate = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &factor}};
  const bw_solver *by[] = {[WAY_AUTO] = NULL,
                           [WAY_REFACTOR] = &factor,
                           [WAY_ITERATE] = &iterate,
                           [WAY_FULL] = &full,
                           [WAY_PCG] = &two_level};
  return by[way];
}

/* How plane meshes solve: those with the factor that is there, with a new one each time, and with a
 * new analysis too. */
typedef enum lagged_way { LAGGED_AUTO, LAGGED_ITERATE, LAGGED_REFACTOR, LAGGED_FULL } lagged_way;

static inline const bw_solver *lagged_by(bool symmetric, lagged_way way) {
  static const bw_solver cholesky = {.options = {.kind = BW_SOLVER_CHOLESKY}},
                         lu = {.options = {.kind = BW_SOLVER_LU}},
                         pcg = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &cholesky}},
                         bicgstab = {.options = {.kind = BW_SOLVER_BICGSTAB}},
                         full = {.options = {.kind = BW_SOLVER_CHOLESKY, .full = true}},
                         full_lu = {.options = {.kind = BW_SOLVER_LU, .full = true}};
  const bw_solver *by[2][4] = {{NULL, &bicgstab, &lu, &full_lu}, {NULL, &pcg, &cholesky, &full}};
  return by[symmetric][way];
}

/* How Newton's method on solids solves. */
typedef enum newton_way { NEWTON_DIRECT, NEWTON_JACOBI, NEWTON_COARSE } newton_way;

static inline const bw_solver *newton_by(int way) {
  static const bw_solver factor = {.options = {.kind = BW_SOLVER_CHOLESKY}},
                         blocks = {.options = {.kind = BW_SOLVER_JACOBI}},
                         jacobi = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &blocks}},
                         two_level = {.options = {.kind = BW_SOLVER_PCG}};
  const bw_solver *by[] = {&factor, &jacobi, &two_level};
  return by[way];
}

/* The same as objects, which a transient retains. */
static inline bw_solver *newton_solver(bw_context *context, newton_way way) {
  bw_solver *inner = NULL, *solver = NULL;
  bw_solver_options options = newton_by((int)way)->options;
  if (options.preconditioner) {
    check_ok(context, bw_solver_create(context, &options.preconditioner->options, &inner));
    options.preconditioner = inner;
  }
  check_ok(context, bw_solver_create(context, &options, &solver));
  bw_release(inner);
  return solver;
}

#endif
