/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of eigen/ share. */
#ifndef BWI_EIGEN_INTERNAL_H
#define BWI_EIGEN_INTERNAL_H

#include "barwright/eigen.h"
#include "linear/internal.h"

/* ---- eigenvalues (eigen.c) ----------------------------------------------------------------- */

/* A symmetric generalised problem K x = lambda M x seen through an operator. Fields are `size`
 * numbers each, one after the other. */
typedef struct bwi_eigen_problem {
  int64_t size;
  const bw_mesh *mesh; /* whose nodes the fields are given at; NULL: unknown */
  void *data;
  /* y = K^+ f, restricted to the wanted space; NULL: there is no factor */
  bw_status (*solve)(bw_context *context, void *data, int64_t count, const double *f, double *y);
  bw_status (*mass)(bw_context *context, void *data, int64_t count, const double *x, double *y);
  bw_status (*stiffness)(bw_context *context, void *data, int64_t count, const double *x,
                         double *y);
  /* y = B f with B near K^+, symmetric; for LOBPCG alone. NULL: solve. The two may be the same */
  bw_status (*precondition)(bw_context *context, void *data, int64_t count, const double *f,
                            double *y);
  const char *preconditioner; /* its name in the report */
  /* bring random fields into the wanted space */
  bw_status (*project)(bw_context *context, void *data, int64_t count, double *x);
  /* eigenvalues below sigma in the wanted space; *trusted as in bwi_count_negative. NULL: none */
  bw_status (*below)(bw_context *context, void *data, double sigma, int64_t *count, bool *trusted);
  int64_t dimension; /* of the wanted space */
} bwi_eigen_problem;

typedef struct bwi_eigen_result {
  int count;
  double *value;    /* ascending */
  double *vector;   /* count x size, M-norm 1 */
  double *residual; /* |K x - lambda M x| / |lambda M x| */
  int solves, recovered;
  bool counted, tested;
  bw_solver_report report;
} bwi_eigen_result;
void bwi_eigen_result_clear(bwi_eigen_result *result);
/* Pairs of one eigenvalue, within their errors or the relative tolerance, get the basis that
 * canonical.c describes, and their mean as value. *changed: residuals are those of the former
 * vectors. Of `problem` only size, mesh, data and mass are used. */
bw_status bwi_eigen_canonical(bw_context *context, const bwi_eigen_problem *problem,
                              double tolerance, bwi_eigen_result *result, bool *changed);
/* Makes the largest component of a vector positive; of several as large, the first decides. */
void bwi_fix_sign(double *shape, int64_t size);
bw_status bwi_eigen_lowest(bw_context *context, const bwi_eigen_problem *problem,
                           const bw_modes_options *options, bwi_eigen_result *result);

/* The lowest pairs from vectors that are near them, by LOBPCG alone. Residuals are sqrt(r . B r /
 * lambda): the error of a vector in the energy norm where B is near K^-1, and that of lambda is its
 * square. The residual's own norm shows the rounding of K x instead, 1e-7 in a thin plate. */
typedef struct bwi_eigen_near {
  int wanted, block;   /* pairs; vectors iterated: guards widen the gap behind the wanted ones */
  const double *start; /* block, one after the other; zero where nothing is known */
  int more_count;      /* at most 2 block: what the start may be moved along, */
  const double *more;  /* of about M-norm 1 */
  double tolerance;
  int limit; /* of iterations */
} bwi_eigen_near;
/* vector: block x size, M-orthonormal, ascending; value and residual: block. BW_CONVERGENCE where
 * the wanted ones are not within the tolerance after `limit` iterations. */
bw_status bwi_eigen_follow(bw_context *context, const bwi_eigen_problem *problem,
                           const bwi_eigen_near *near, double *vector, double *value,
                           double *residual, int *iterations);

#endif
