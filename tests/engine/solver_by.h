/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solvers of systems that follow edits, by the way that they work. */
#ifndef SOLVER_BY_H
#define SOLVER_BY_H

#include "check.h"

/* The solver of a way; borrowed for ever. */
static inline const bw_solver *solver_by(int method) {
  static const bw_solver factor = {.options = {.kind = BW_SOLVER_CHOLESKY}};
  static const bw_solver full = {.options = {.kind = BW_SOLVER_CHOLESKY, .full = true}};
  static const bw_solver two_level = {.options = {.kind = BW_SOLVER_PCG}};
  static const bw_solver iterate = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &factor}};
  const bw_solver *by[] = {[BW_INCREMENTAL_AUTO] = NULL,
                           [BW_INCREMENTAL_REFACTOR] = &factor,
                           [BW_INCREMENTAL_ITERATE] = &iterate,
                           [BW_INCREMENTAL_FULL] = &full,
                           [BW_INCREMENTAL_PCG] = &two_level};
  return by[method];
}

#endif
