/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preconditioned conjugate gradients on the stiffness of a body (pcg.c). */
#ifndef BWI_LINEAR_PCG_H
#define BWI_LINEAR_PCG_H

#include "linear/amg.h"
#include "linear/internal.h"

typedef struct bwi_pcg {
  const bw_block_pattern *pattern;
  const double *stiffness;
  const bw_dof_map *dof_map;
  /* z = M^-1 r of `count` fields in global directions, 0 off the unknowns. It need not be quite
     symmetric. */
  bw_status (*precondition)(bw_context *context, void *data, int64_t count, const double *r,
                            double *z);
  void *data;
  double tolerance;
  /* Where the force is what a guess has left of another one: |f| and f . M f of that one, for every
     right-hand side, which the tolerance is relative to. Or NULL. */
  const double *load, *energy;
  bool energy_alone; /* the tolerance is on the error in energy alone */
  int limit;         /* on iterations */
  /* Give up as soon as more iterations than this are predicted to be left; 0: never. */
  double max_remaining;
  /* out */
  int iterations;              /* of the right-hand side that took most */
  double predicted_iterations; /* iterations in all, where it was given up */
  double residual;             /* (-) where they did not converge: the largest, relative */
  bool converged; /* false: given up, the limit was reached, or the matrix is not positive
                     definite */
} bwi_pcg;
/* K u = f at the unknowns for fields in global directions; u is 0 elsewhere. Not converged is no
 * failure; `displacement` is then what was reached. The two may not be the same block. */
bw_status bwi_pcg_solve(bw_context *context, bwi_pcg *problem, int64_t count, const double *force,
                        double *displacement);

/* ---- preconditioner.c ------------------------------------------------------------------------ */

/* What a bw_solver says of the preconditioner of a body's equations. */
typedef struct bwi_preconditioner {
  bw_object object;
  const bw_solver *solver;   /* retained: BW_SOLVER_JACOBI, _AMG or _CHOLESKY */
  const bw_dof_map *dof_map; /* retained */
  bwi_factor *factor;        /* or NULL */
  bwi_amg *amg;              /* or NULL */
  double *block;             /* node_count x 9: inverse blocks in global directions, or NULL */
} bwi_preconditioner;
/* Release with bw_release. `symbolic`: for BW_SOLVER_CHOLESKY. BW_SINGULAR with *bad_node as
 * bwi_factor_create. */
bw_status bwi_preconditioner_create(bw_context *context, const bw_solver *solver,
                                    const bwi_matrix *matrix, bwi_symbolic *symbolic,
                                    bwi_preconditioner **preconditioner, int32_t *bad_node);
/* Whether a preconditioner (or NULL) is what a solver asks for; NULL: multigrid. */
bool bwi_preconditioner_serves(const bwi_preconditioner *preconditioner, const bw_solver *solver);
/* bwi_pcg.precondition; `data` is a bwi_preconditioner. Multigrid as bwi_amg_apply has it: bodies
 * that can move freely are for bwi_amg_solve. */
bw_status bwi_preconditioner_apply(bw_context *context, void *data, int64_t count, const double *r,
                                   double *z);
/* The same with a factor alone; `data` is one of these. */
typedef struct bwi_factor_preconditioner {
  const bwi_factor *factor;
  const bw_dof_map *dof_map;
} bwi_factor_preconditioner;
bw_status bwi_factor_precondition(bw_context *context, void *data, int64_t count, const double *r,
                                  double *z);
/* BW_INVALID for a solver that solves no symmetric equations: a preconditioner, LU, BiCGSTAB. */
bw_status bwi_solver_refused(bw_context *context, const bw_solver *solver);
/* BW_INVALID for two levels on linear elements; `instead` is what serves these. */
bw_status bwi_two_level_refused(bw_context *context, const char *instead);
/* The kernels that a solver of the kind BW_SOLVER_CHOLESKY asks for; NULL: the default's. */
const bwi_kernels *bwi_kernels_of(const bw_solver *solver);

#endif
