/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Descriptions of eigensolvers, and which iteration serves a problem. */
#include <stdio.h>

#include "eigen/block_lanczos.h"

/* A row for each kind: its name, and by how many vectors at least its basis is larger than the
 * number of modes. */
static const struct {
  const char *name;
  int beyond;
} kinds[] = {[BW_EIGENSOLVER_AUTO] = {"auto", 2 * BWI_BLOCK},
             [BW_EIGENSOLVER_LANCZOS] = {"lanczos", 2 * BWI_BLOCK},
             [BW_EIGENSOLVER_ARPACK] = {"arpack", 2},
             [BW_EIGENSOLVER_LOBPCG] = {"lobpcg", 0},
             [BW_EIGENSOLVER_SLEPC] = {"slepc", 0}};
enum { KINDS = sizeof kinds / sizeof *kinds };

void bw_eigensolver_options_default(bw_eigensolver_options *options) {
  *options = (bw_eigensolver_options){.kind = BW_EIGENSOLVER_AUTO};
}

static void eigensolver_destroy(void *object) {
  bw_eigensolver *solver = object;
  bw_release(solver->options.preconditioner);
  bw_release(solver->options.inner);
  bw_free(solver);
}

static size_t eigensolver_bytes(const void *object) {
  (void)object;
  return sizeof(bw_eigensolver);
}

static const bw_kind eigensolver_kind = {"eigensolver", eigensolver_destroy, eigensolver_bytes};

/* A factor over all processes, or conjugate gradients with multigrid over them. */
static bool serves_slepc(const bw_solver *inner) {
  const bw_solver *m = inner;
  if (inner->options.kind == BW_SOLVER_PCG)
    m = inner->options.preconditioner;
  return m && m->options.backend == BW_BACKEND_PETSC &&
         m->options.kind == (m == inner ? BW_SOLVER_CHOLESKY : BW_SOLVER_AMG);
}

static bw_status check_inner(bw_context *context, const bw_eigensolver_options *options) {
  char text[BW_SOLVER_TEXT];
  const bw_solver *inner = options->inner;
  if (!inner || (options->kind == BW_EIGENSOLVER_SLEPC && serves_slepc(inner)))
    return BW_OK;
  bw_solver_describe(inner, text);
  if (options->kind != BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_INVALID, "the eigensolver %s has no inner systems: leave %s out",
                   kinds[options->kind].name, text);
  return bw_fail(
      context, BW_INVALID,
      "the solver %s does not serve SLEPc: give cholesky, or pcg with amg, of the backend "
      "petsc",
      text);
}

bw_status bw_eigensolver_create(bw_context *context, const bw_eigensolver_options *given,
                                bw_eigensolver **out) {
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  if (given)
    options = *given;
  if ((int)options.kind < 0 || (int)options.kind >= KINDS)
    return bw_fail(context, BW_INVALID, "eigensolver %d is not known", (int)options.kind);
  if (options.basis < 0 || options.basis > 100000)
    return bw_fail(context, BW_INVALID, "a basis of %d vectors: 0 to 100000 expected",
                   options.basis);
  const bw_solver *m = options.preconditioner;
  bool serves = m && options.kind == BW_EIGENSOLVER_LOBPCG &&
                m->options.backend == BW_BACKEND_AUTO &&
                (m->options.kind == BW_SOLVER_TWO_LEVEL || m->options.kind == BW_SOLVER_AMG);
  if (m && !serves)
    return bw_fail(context, BW_INVALID,
                   "LOBPCG takes the preconditioners two_level and amg of the engine, and other "
                   "eigensolvers take none");
  bw_status status = check_inner(context, &options);
  if (status != BW_OK)
    return status;
  bw_eigensolver *solver = BW_NEW0(context, bw_eigensolver, 1);
  if (!solver)
    return BW_MEMORY;
  bw_object_init(solver, &eigensolver_kind);
  solver->options = options;
  bw_retain(m);
  bw_retain(options.inner);
  *out = solver;
  return BW_OK;
}

const char *bw_eigensolver_name(const bw_eigensolver *solver) {
  return kinds[solver ? solver->options.kind : BW_EIGENSOLVER_AUTO].name;
}

bw_status bwi_eigen_choose(bw_context *context, const bwi_eigen_problem *problem,
                           const bw_eigensolver *solver, bwi_eigen_setup *setup,
                           const bwi_eigen_method **method, bw_solver_report *report) {
  bw_eigensolver_kind kind = solver ? solver->options.kind : BW_EIGENSOLVER_AUTO;
  int basis = solver ? solver->options.basis : 0;
  setup->basis = basis;
  if (kind == BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "SLEPc computes elastic modes of a whole model, and no others");
  if (basis > 0 && basis < setup->count + kinds[kind].beyond)
    return bw_fail(context, BW_INVALID,
                   "a basis of %d vectors is too small for %d modes: at least %d expected", basis,
                   setup->count, setup->count + kinds[kind].beyond);
  const char *reason = kind == BW_EIGENSOLVER_AUTO ? "the default: blocks of eight right-hand sides"
                                                   : "it was given";
  int64_t vectors = basis > 0 ? basis : 2 * (int64_t)setup->count + 20;
  *method = kind == BW_EIGENSOLVER_ARPACK   ? bwi_eigen_arpack()
            : kind == BW_EIGENSOLVER_LOBPCG ? bwi_eigen_lobpcg()
                                            : bwi_eigen_lanczos();
  if (kind == BW_EIGENSOLVER_ARPACK && problem->dimension <= 2 * vectors) {
    *method = bwi_eigen_lanczos();
    setup->basis = 0;
    reason = "the space has too few dimensions for the basis of ARPACK";
  }
  report->solver = (*method)->solver;
  if (kind == BW_EIGENSOLVER_LOBPCG)
    report->preconditioner = problem->preconditioner;
  snprintf(report->reason, sizeof report->reason, "%s", reason);
  return BW_OK;
}
