/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What solves a system's equations: a factor, two-level PCG, or PCG with another preconditioner.
 * `analyse` and `update` are bwi_system_prepare, `solve` is bw_system_solve, and `report` is a
 * field of the system. */
#ifndef BWI_LINEAR_SYSTEM_SOLVER_H
#define BWI_LINEAR_SYSTEM_SOLVER_H

#include "linear/pcg.h"
#include "linear/system_two_level.h"
#include "linear/two_level_apply.h"

/* The error in energy that bw_system_solve leaves of a solution, unless its solver says otherwise.
 */
#define BWI_SOLVE_TO 1e-8

enum {
  BWI_PCG_ITERATIONS = 2000, /* no way to solve */
  BWI_SMALL_SYSTEM = 30000   /* unknowns: always a factor */
};
/* Bytes of a factor: there are machines with less memory than this, but few. */
#define BWI_LARGE_FACTOR 4e9

/* What a solver asks for. */
typedef struct bwi_request {
  bwi_way way;
  const bw_solver *preconditioner; /* of BWI_BY_PCG: block Jacobi, multigrid or a factor */
  double tolerance;                /* (-) of PCG */
  int max_iterations;
} bwi_request;
/* Of a solver; NULL: BWI_BY_FACTOR. `tolerance`: the default. BW_INVALID for a preconditioner in
 * the place of a solver. */
bw_status bwi_solver_request(bw_context *context, const bw_solver *solver, double tolerance,
                             bwi_request *request);
/* By what bw_system_solve solves. */
bwi_way bwi_system_way(const bw_system *system);
/* What takes the place of a factor: two levels on quadratic elements, multigrid on linear ones. */
bwi_way bwi_way_without_factor(const bw_system *system);
/* Gives a system the preconditioner of a way, unless it has it: *made. The others as in
 * bwi_two_level_make and bwi_system_precondition. */
bw_status bwi_system_make(bw_context *context, const bw_model *model, bw_system *system,
                          bwi_way way, const bw_solver *preconditioner, bwi_symbolic *old,
                          double available, bool *made);
/* Where nothing was asked for: whether a factor replaces what failed with `status`, which is no
 * failure then; `reason` says why. It warns where iterations did not converge. */
bool bwi_factor_replaces(bw_context *context, const bw_system *system, bw_status status,
                         int iterations, double available, char reason[160]);
/* The error in energy that it leaves, over that of the solution; 0 by a factor. */
double bwi_solve_tolerance(const bw_system *system);
/* Whether the external solver is asked for. */
bool bwi_solver_is_external(const bw_solver *solver);

/* What a system needs to be solved by a solver, and its report, as bw_system_of_model has it.
 * `old`: an order that may fit, or NULL. */
bw_status bwi_system_prepare(bw_context *context, const bw_model *model, bw_system *system,
                             const bw_solver *solver, bwi_symbolic *old);

/* Gives an iterative system the preconditioner that bw_system_solve takes: statics and modes may
 * have taken another one since. */
bw_status bwi_system_restore(bw_context *context, bw_system *system);

/* One call of PCG on a system. */
typedef struct bwi_system_pcg {
  bwi_way way;
  double tolerance;
  bool energy_alone; /* two-level PCG: the tolerance is on the error in energy alone. Other
                        preconditioners say less of that error: the residual counts as well */
  int limit;         /* on iterations */
  /* out */
  int iterations;
  bool converged;
  double residual; /* (-) where they did not converge */
} bwi_system_pcg;
/* As bwi_two_level_solve or bwi_pcg_solve, with the preconditioner that the system has. */
bw_status bwi_system_iterate(bw_context *context, bw_system *system, bwi_system_pcg *problem,
                             int64_t count, const double *force, double *displacement);
/* BW_CONVERGENCE: how far it came, and what to do. */
bw_status bwi_system_stopped(bw_context *context, const bw_system *system,
                             const bwi_system_pcg *problem);
/* As many iterations as a factor would have cost, where there is room for it; at most `max`. */
int bwi_pcg_break_even(const bwi_two_level_solver *solver, double available, int max);

/* ---- the preconditioner as an operator ------------------------------------------------------- */

/* z = B f of a system's preconditioner, near u = P K^+ P^T f up to a rigid-body motion. */
typedef struct bwi_system_operator {
  bw_system *system;
  bwi_way way;
  bwi_two_level_workspace workspace;
  double *balanced; /* of several fields, or NULL */
} bwi_system_operator;
bw_status bwi_system_operator_open(bw_context *context, bw_system *system, bwi_way way,
                                   bwi_system_operator *op);
void bwi_system_operator_close(bwi_system_operator *op);
/* For `count` fields; the two may be the same. */
bw_status bwi_system_operator_apply(bw_context *context, bwi_system_operator *op, int64_t count,
                                    const double *f, double *z);
/* Its name in a report. */
const char *bwi_system_operator_word(const bwi_system_operator *op);

#endif
