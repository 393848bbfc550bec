/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of skeletons, weights and subdomains share. */
#ifndef BWI_SHAPE_INTERNAL_H
#define BWI_SHAPE_INTERNAL_H

#include <math.h>

#include "barwright/shape.h"

/* The nodes of element e. */
static inline const int32_t *bwi_nodes_of(const bw_mesh *mesh, int32_t e) {
  return mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
}

/* The distance of x from the segment from a to b, whose length may be zero. */
static inline double bwi_segment_distance(const double x[3], const double a[3], const double b[3]) {
  double ab[3], ax[3], d[3];
  for (int k = 0; k < 3; k++) {
    ab[k] = b[k] - a[k];
    ax[k] = x[k] - a[k];
  }
  double square = bw_dot(ab, ab), t = square > 0 ? bw_dot(ax, ab) / square : 0;
  t = fmin(fmax(t, 0), 1);
  for (int k = 0; k < 3; k++)
    d[k] = ax[k] - t * ab[k];
  return bw_norm(d);
}

/* ---- TGF from memory, for the reader and for fuzzing (skeleton_tgf.c) ------------------------ */

bw_status bwi_tgf_parse(bw_context *context, const char *name, const unsigned char *bytes,
                        size_t count, double unit, bw_skeleton **skeleton);

#endif
