/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the search for load factors and those that set up its matrices share. */
#ifndef BWI_BUCKLING_INTERNAL_H
#define BWI_BUCKLING_INTERNAL_H

#include "barwright/buckling.h"
#include "eigen/internal.h"

/* (K + lambda K_sigma) phi = 0 seen through products. Fields are `size` numbers each, one after the
 * other, in a space on which K is positive definite. */
typedef struct bwi_stability {
  int64_t size, dimension; /* numbers of a field; dimension of the space */
  const bw_mesh *mesh;     /* whose nodes fields are given at; NULL: they are not */
  void *data;
  bw_status (*stiffness)(bw_context *context, void *data, int64_t count, const double *x,
                         double *y);
  bw_status (*stress)(bw_context *context, void *data, int64_t count, const double *x, double *y);
  bw_status (*solve)(bw_context *context, void *data, int64_t count, const double *f, double *y);
  bw_status (*project)(bw_context *context, void *data, int64_t count, double *x);
  /* factors between 0 and s, of either sign of s. NULL: none can be counted */
  bw_status (*between)(bw_context *context, void *data, double s, int64_t *count, bool *trusted);
  /* shape (node_count x 3) of a field; NULL: it is one */
  bw_status (*at_nodes)(bw_context *context, void *data, const double *x, double *shape);
  /* of the search */
  double *work; /* size x BWI_STABILITY_SIDES */
  int solves;
} bwi_stability;
enum { BWI_STABILITY_SIDES = 8 };

/* A result without load factors, of a model that it retains. */
bw_status bwi_buckling_empty(bw_context *context, const bw_model *model, bw_buckling **buckling);
/* BW_UNSUPPORTED for a static solution with forces of contact. */
bw_status bwi_buckling_refuse_contact(bw_context *context, const bw_static *solution);
bw_status bwi_buckling_options_check(bw_context *context, const bw_buckling_options *given,
                                     bw_buckling_options *options);
/* The load factors of smallest size, into `out`. */
bw_status bwi_buckling_find(bw_context *context, bwi_stability *problem,
                            const bw_buckling_options *options, bw_buckling *out);

#endif
