/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of singular places share. */
#ifndef BWI_SINGULAR_INTERNAL_H
#define BWI_SINGULAR_INTERNAL_H

#include "barwright/singular.h"

/* An edge between two facets that is part of a singular place. Those of like keys hang together. */
typedef struct bwi_seam {
  int32_t end[2]; /* points */
  int32_t key[3];
  int32_t number; /* order of seams of like keys */
  double angle;   /* inside the material */
  double inward[3];
} bwi_seam;

typedef struct bwi_seams {
  size_t count, capacity;
  bwi_seam *seam;
} bwi_seams;

bw_status bwi_seams_add(bw_context *context, bwi_seams *seams, const bwi_seam *seam);

/* The angle inside the material at an edge from a to b along which facet 1 lies on the left and
 * facet 2 on the right, seen from outside, with these unit normals; and the bisector into the
 * material. */
double bwi_opening(const double a[3], const double b[3], const double normal1[3],
                   const double normal2[3], double inward[3]);

/* Empty places, to which polylines are appended. */
bw_status bwi_singular_create(bw_context *context, bw_singular_places **places);
/* Joins seams of like keys to polylines, which end where other than two of them meet. Sorts the
 * seams. Only those places are added whose exponent is below 1. */
bw_status bwi_singular_chain(bw_context *context, bw_singular_places *places, bwi_seams *seams,
                             int32_t point_count, const double *point, bw_singular_kind kind,
                             bw_corner corner, double poisson);
bw_status bwi_singular_add(bw_context *context, bw_singular_places *places,
                           const bw_singular_place *place, int32_t count, const double *point,
                           const double *inward);
/* By kind, then by descending length. */
void bwi_singular_sort(bw_singular_places *places);

#endif
