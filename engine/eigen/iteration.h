/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Iterations for the lowest eigenpairs of K x = lambda M x, behind one set of functions.
 *
 * An iteration finds pairs. What holds for all of them is the driver's (eigen.c): the Sturm count,
 * the recovery of missing modes, true residuals, tolerances. A method is a row of functions; adding
 * one is a file and a row in the table of eigensolver.c.
 *
 * Invariants between calls: `value` ascends over the `known` pairs; the converged ones are the
 * first of them, and their vectors are M-orthonormal and lie in the wanted space. What follows them
 * are approximations from above, by which the driver finds gaps. */
#ifndef BWI_EIGEN_ITERATION_H
#define BWI_EIGEN_ITERATION_H

#include "eigen/internal.h"

typedef struct bwi_eigen_iteration bwi_eigen_iteration;

/* What an iteration begins with. */
typedef struct bwi_eigen_setup {
  int count; /* pairs wanted at first, at most the dimension */
  int basis; /* vectors of the Krylov space; 0: by count */
  uint64_t seed;
} bwi_eigen_setup;

typedef struct bwi_eigen_method {
  const char *solver; /* its name in bw_solver_report */
  /* On failure what there is of the iteration, or NULL. */
  bw_status (*open)(bw_context *context, const bwi_eigen_problem *problem,
                    const bwi_eigen_setup *setup, bwi_eigen_iteration **iteration);
  /* Goes on until `wanted` pairs have converged, or the whole space is searched. */
  bw_status (*iterate)(bwi_eigen_iteration *iteration, int wanted, double tolerance);
  /* Leading pairs that have converged, at most `wanted`. */
  int (*converged)(const bwi_eigen_iteration *iteration, int wanted, double tolerance);
  /* Keeps the first `keep` pairs, and goes on from random vectors that are M-orthogonal to them. */
  bw_status (*deflate)(bwi_eigen_iteration *iteration, int keep);
  /* x: the first `count` vectors. */
  bw_status (*vectors)(const bwi_eigen_iteration *iteration, int count, double *x);
  void (*close)(bwi_eigen_iteration *iteration);
} bwi_eigen_method;

struct bwi_eigen_iteration {
  const bwi_eigen_method *method;
  bw_context *context;
  const bwi_eigen_problem *problem;
  int64_t size;
  int most; /* pairs that can be asked for */
  int known;
  double *value; /* `known` numbers, infinite where nothing is known */
  bw_random random;
  int solves;     /* right-hand sides solved for, or preconditioned */
  int iterations; /* restarts; of LOBPCG iterations */
  double bytes;   /* memory it takes */
  char stage[24]; /* of progress: "15 modes" */
};

const bwi_eigen_method *bwi_eigen_lanczos(void);
const bwi_eigen_method *bwi_eigen_arpack(void);
const bwi_eigen_method *bwi_eigen_lobpcg(void);

/* The iteration that serves a problem, its basis in `setup`, and why, in `report`. `solver` may be
 * NULL. */
bw_status bwi_eigen_choose(bw_context *context, const bwi_eigen_problem *problem,
                           const bw_eigensolver *solver, bwi_eigen_setup *setup,
                           const bwi_eigen_method **method, bw_solver_report *report);
/* Whether pair n (from 0) may have the eigenvalue of the one before it. */
bool bwi_eigen_may_be_equal(const bwi_eigen_iteration *iteration, int n);
/* Random fields in the wanted space. */
bw_status bwi_eigen_random(bwi_eigen_iteration *iteration, int count, double *x);
/* BW_CONVERGENCE: how many of the wanted pairs have converged. */
bw_status bwi_eigen_stopped(const bwi_eigen_iteration *iteration, int found, int wanted,
                            double tolerance);

#endif
