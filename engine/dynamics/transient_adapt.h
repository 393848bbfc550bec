/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Steps of a transient whose length follows the estimated error (docs/theory/transient.md). */
#ifndef BWI_DYNAMICS_TRANSIENT_ADAPT_H
#define BWI_DYNAMICS_TRANSIENT_ADAPT_H

#include "barwright/transient.h"
#include "dynamics/shifted.h"

/* Lengths are base times a power of 2. A step begins at a multiple of its own length, so that
 * times are whole numbers of the shortest one. */
typedef struct bwi_adaptive {
  double tolerance; /* (-) of a step's error, relative to the largest displacement */
  double base;      /* (s) */
  int level;        /* of the next step: its length is base 2^level */
  int64_t ticks;    /* time in the shortest steps */
  int waited;       /* steps since the length changed */
  double worst;     /* (-) largest error, which fades as the motion goes on */
  bool relative;    /* the motion as a rigid body does not count as displacement */
  double mass;      /* (kg) of the body */
  double largest;   /* norm of the largest displacement */
  double fastest;   /* norm of the largest velocity */
  double sum;       /* of the norms of all errors */
  double *rigid;    /* size x 6, orthonormal in M; NULL unless `relative` */
} bwi_adaptive;

/* A step that was computed, with the factor of K + shift M that it used. */
typedef struct bwi_computed_step {
  const bwi_shifted *shifted;
  bwi_factor *factor;
  double shift;
  double constant;         /* of the error h^2 constant (a_n+1 - a_n) */
  double h;                /* (s) */
  const double *u, *v, *a; /* at its end */
  double support_missed;   /* (m) prescribed displacement that the step did not see */
  double *change;          /* (m/s2) a_n+1 - a_n; becomes the error (m) */
  const double *missed;    /* (N) mean force that the step did not see */
  double *work;            /* size of a field, as the others */
} bwi_computed_step;

void bwi_adaptive_begin(bwi_adaptive *a, double tolerance, double base);
/* Leaves the motion as a rigid body out of the displacements that errors are compared with. */
bw_status bwi_adaptive_leave_out_rigid(bw_context *context, const bw_mesh *mesh,
                                       const bwi_equations *equations, bwi_adaptive *a);
void bwi_adaptive_clear(bwi_adaptive *a);
/* *error (-), relative to the largest displacement until now, and the norms in the mass of error,
 * displacement and velocity. */
bw_status bwi_adaptive_estimate(bw_context *context, const bwi_adaptive *a, bwi_computed_step *step,
                                double *error, double norm[3]);
/* Whether a step of this error stands. The next length becomes shorter if not. */
bool bwi_adaptive_accepts(bwi_adaptive *a, double error);
/* Goes to the end of a step that stands, and may make the next one longer. */
void bwi_adaptive_accept(bwi_adaptive *a, double error, const double norm[3]);
double bwi_adaptive_step(const bwi_adaptive *a);
double bwi_adaptive_time(const bwi_adaptive *a);
/* The estimated error of the displacement now (-). */
double bwi_adaptive_total(const bwi_adaptive *a);

#endif
