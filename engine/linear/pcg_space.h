/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preconditioned conjugate gradients (pcg.c): A x = b for several right-hand sides side by side, on
 * a vector space that is given by its operations. How vectors are stored is its business; x, r, z,
 * p and q = A p are the vectors of Saad, algorithm 9.1. */
#ifndef BWI_LINEAR_PCG_SPACE_H
#define BWI_LINEAR_PCG_SPACE_H

#include "barwright/base.h"

enum { BWI_PCG_COLUMNS = 16 }; /* right-hand sides side by side, at most */

/* Each operation works on all columns; sums are by column. */
typedef struct bwi_pcg_space {
  void *data;
  /* r = b - A x of the columns `wanted`, and r . r of these */
  bw_status (*residual)(bw_context *context, void *data, const bool *wanted, double *r_dot_r);
  /* z = M^-1 r, r . z, and z . q with the last q where it is asked for (else NULL) */
  bw_status (*precondition)(bw_context *context, void *data, double *r_dot_z, double *z_dot_q);
  /* p = z + beta p, q = A p, p . q. Where beta is 0, p may be anything finite. */
  bw_status (*multiply)(bw_context *context, void *data, const double *beta, double *p_dot_q);
  /* x += alpha p, r -= alpha q, r . r */
  bw_status (*advance)(bw_context *context, void *data, const double *alpha, double *r_dot_r);
  /* The size of r that rounding leaves of a column; NULL: 0. */
  double (*noise)(void *data, int column);
  /* Column `last` takes the place of column k, which is done, and is the last one no more. NULL:
     columns that are done stay, with alpha = beta = 0. */
  void (*retire)(void *data, int k, int last);
  /* M is symmetric to rounding: beta = r . z / r . z of before (Fletcher and Reeves), and z . q is
     not asked for. Else by z . q (Polak and Ribiere). */
  bool symmetric;
} bwi_pcg_space;

/* In one iteration the energy of the error falls by at least this fraction of what |r| falls by
 * (its root; measured: 0.1 to 1.3); and mostly by this. */
#define BWI_ENERGY_FALLS 0.03
#define BWI_ENERGY_FALLS_MOSTLY 0.3

/* A column is done when r . z, which is near the energy of the error, is below the square of
 * energy_tolerance of its `energy`, and |r| below residual_tolerance of its `load`, or below what
 * rounding leaves. r is then computed again from x; where rounding has parted the two, the
 * iteration starts again from there until that no longer helps. */
typedef struct bwi_pcg_task {
  int columns;
  double energy_tolerance, residual_tolerance; /* INFINITY: that one is not asked for */
  /* BWI_ENERGY_FALLS, or _MOSTLY: a column whose |r| has fallen so far that r . z surely has too is
     done without another application of M. */
  double energy_fall;
  /* By column, what tolerances are relative to where b is what a first guess has left of another
     one: |b| and b . M^-1 b of that one. NULL: of r at the start; energies are not below that. */
  const double *load, *energy;
  int limit;            /* on iterations */
  double max_remaining; /* give up when more iterations are predicted to be left; 0: never */
  bool progress;        /* report how far it is */
  bool recurrence; /* r is not computed again: tolerances are far above what rounding adds to it */
  /* Called after iterations with their number and what is done in digits, 0 to 1: it may change M,
     where M is not said to be symmetric. Or NULL. */
  bw_status (*adapt)(bw_context *context, void *data, int iterations, double done);
  void *data;
  /* out */
  int iterations;
  double predicted_iterations; /* in all, where it was given up */
  double residual;             /* the largest |r| over the load */
  bool converged;
  bool
      indefinite; /* not converged since p . A p or r . z was not positive; x is as it was before */
} bwi_pcg_task;
bw_status bwi_pcg_run(bw_context *context, const bwi_pcg_space *space, bwi_pcg_task *task);

/* ---- pcg_fields.c ---------------------------------------------------------------------------- */

/* y = A x for `count` vectors, one after the other. The two are not the same. */
typedef bw_status bwi_pcg_apply(bw_context *context, void *data, int64_t count, const double *x,
                                double *y);

/* The space of vectors of `size` numbers, one after the other. */
typedef struct bwi_pcg_fields {
  int64_t size;
  bwi_pcg_apply *multiply, *precondition; /* both within the subspace */
  void *multiply_data, *precondition_data;
  /* b onto the subspace where the equations hold; NULL: all of it */
  bw_status (*project)(bw_context *context, void *data, int64_t count, double *x);
  void *project_data;
  double (*noise)(void *data, const double *x); /* as in the space; NULL: 0 */
  void *noise_data;
  bool symmetric; /* as in the space */
  bool guess;     /* x comes as a first guess; else it is set to 0 */
  double *work;   /* room for 4 x columns x size numbers, or NULL */
} bwi_pcg_fields;
/* A x = b for up to BWI_PCG_COLUMNS columns (task->columns x size). The two are not the same. */
bw_status bwi_pcg_fields_run(bw_context *context, const bwi_pcg_fields *fields, bwi_pcg_task *task,
                             const double *b, double *x);

#endif
