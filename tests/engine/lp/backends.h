/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The backends of linear programs: tests run once for each. */
#ifndef LP_BACKENDS_H
#define LP_BACKENDS_H

#include "check.h"

#include "lp/solver.h"

static const bwi_lp_method *const lp_backends[] = {&bwi_lp_dual_simplex, &bwi_lp_glpk};
enum { LP_BACKENDS = sizeof lp_backends / sizeof *lp_backends };

/* For the caller to release. */
static inline bw_lp_solver *lp_backend(bw_context *context, int which) {
  const bw_lp_options options = {0};
  bw_lp_solver *solver = NULL;
  check_ok(context, which == 0 ? bw_lp_dual_simplex(context, &options, &solver)
                               : bw_lp_glpk(context, NULL, &solver));
  assert_string_equal(solver->name, lp_backends[which]->name);
  return solver;
}

#endif
