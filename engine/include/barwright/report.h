/* report: what a solver did, and why it was chosen. */
#ifndef BARWRIGHT_REPORT_H
#define BARWRIGHT_REPORT_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One report for linear systems, eigenvalues and linear programs. The predicted costs are
 * operations and bytes, counted, over the rates of one reference machine, so that they are the same
 * everywhere. */
typedef struct bw_solver_report {
  const char *solver;         /* "cholesky", "pcg", "lanczos", ...; static */
  const char *backend;        /* "multifrontal", "cholmod", "petsc", "glpk", ...; static, ""
                                 where the solver has one only */
  const char *preconditioner; /* "two_level", "amg", "jacobi", "cholesky", "operator" of the
                                 caller's own; static, "" where there is none */
  char reason[160];           /* why this one was chosen: a sentence */
  double predicted_cost;      /* (s) of the reference machine; 0 where there was no choice */
  double rival_cost;          /* (s) likewise, of the next best solver */
  double flops;               /* (-) operations, counted */
  double bytes;               /* (bytes) memory of factor or preconditioner */
  double seconds;             /* (s) spent */
  int iterations;             /* 0 by a direct solver */
  double residual;            /* (-) relative, at the end */
  double reused;              /* (-) fraction of the work that an earlier solution had done */
} bw_solver_report;

#ifdef __cplusplus
}
#endif
#endif
