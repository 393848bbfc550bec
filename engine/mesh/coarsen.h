/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The state of a surface that is being coarsened (coarsen.c), and what its steps share.
 *
 * Between steps every point has the list of its corners (corner 3 t + k is corner k of triangle t),
 * and every living triangle is entered in all cells of the grid that its box meets. Entries of
 * triangles that have changed since stay behind; boxes are compared before anything else. */
#ifndef BWI_COARSEN_H
#define BWI_COARSEN_H

#include "base/limit.h"
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_tree.h"

#include <math.h>
#include <string.h>

enum { BWI_RING = 64 }; /* triangles around a point, at most */

typedef struct bwi_coarsen_entry {
  int32_t triangle;
  int64_t next; /* in the same bucket, or -1 */
} bwi_coarsen_entry;

typedef struct bwi_coarsening {
  bw_context *context;
  const bwi_coarsen_options *options;
  bwi_tree *tree; /* of the facets that were given; NULL: not needed */
  double length;  /* of this step: the side of a cell of the grid; no edge grows much longer */
  double shorter; /* of this step: shorter edges are collapsed */
  double floor;   /* shapes as good as that are good enough */
  bwi_time_limit time;
  int32_t points, triangles;
  double *x; /* relative to `origin` */
  double origin[3];
  int32_t *corner; /* triangles x 3; the first is -1 in a dead triangle */
  double (*quadric)[10];
  int32_t *first, *next; /* corners of a point */
  int64_t *bucket;       /* grid: hash of the cell -> entry */
  uint64_t buckets;      /* a power of two */
  bwi_coarsen_entry *list;
  size_t entries, capacity;
  int32_t *big; /* triangles too large for the grid */
  size_t big_count, big_capacity;
  double *lost;  /* per point: how far what it stands for may lie from the facets */
  int32_t *hint; /* per point: a facet of the tree near it */
  int32_t *seen; /* per triangle: the last query that met it */
  int32_t query;
} bwi_coarsening;

static inline const double *place(const bwi_coarsening *c, int32_t point) {
  return c->x + 3 * (size_t)point;
}

/* New triangles that replace the living ones around an edge, all those at its points `kept` and
 * `gone` in a collapse, or the two `pair` in an exchange of the diagonal (kept and gone -1). */
typedef struct bwi_coarsen_change {
  int32_t kept, gone; /* the second point is merged into the first */
  int32_t pair[2];
  double at[3];               /* where a goes */
  double lost;                /* of `kept` afterwards */
  double worst, worst_before; /* shapes */
  int32_t count;              /* triangles that stay and change */
  int32_t triangle[2 * BWI_RING];
  int32_t corner[2 * BWI_RING][3]; /* with `kept` in the place of `gone` */
  const double *x[2 * BWI_RING][3];
  double normal[2 * BWI_RING][3];
} bwi_coarsen_change;

/* The fraction of the wanted length, and of all that goes with it, at a place. */
static inline double fraction_at(const bwi_coarsening *c, const double at[3]) {
  const bwi_coarsen_options *o = c->options;
  if (!o->field)
    return 1;
  double whole[3] = {at[0] + c->origin[0], at[1] + c->origin[1], at[2] + c->origin[2]};
  double bound = bwi_size_at(o->field, whole);
  return bound > 0 && bound < o->length ? bound / o->length : 1;
}

/* How far the surface may be left at a place. */
static inline double allowed_at(const bwi_coarsening *c, const double at[3]) {
  return fraction_at(c, at) * c->options->allowed;
}

static inline double error_at(const bwi_coarsening *c, const double at[3]) {
  return fraction_at(c, at) * c->options->error;
}

static inline void normal_of(const double *const x[3], double n[3]) {
  double a[3], b[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x[1][k] - x[0][k];
    b[k] = x[2][k] - x[0][k];
  }
  bw_cross(a, b, n);
}

static inline double distance_of(const double *x, const double *y) {
  double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
  return bw_norm(d);
}

/* 1 for an equilateral triangle, 0 for a flat one. */
static inline double shape_of(const double *const x[3], const double n[3]) {
  double sum = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      double d = x[(i + 1) % 3][k] - x[i][k];
      sum += d * d;
    }
  return sum > 0 ? 3.4641016 * bw_norm(n) / sum : 0;
}

/* coarsen_overlap.c: enter a triangle in the grid; do the new triangles stay near the surface that
 * was given and meet nothing? */
bool bwi_coarsen_enter(bwi_coarsening *c, int32_t triangle);
bool bwi_coarsen_is_free(bwi_coarsening *c, bwi_coarsen_change *now);

/* coarsen_collapse.c: remove points and short edges; move points to where their planes ask for. */
bool bwi_coarsen_ring(bwi_coarsening *c, int32_t point, int32_t *ring, int *count);
bw_status bwi_coarsen_check(bwi_coarsening *c, size_t step);
bw_status bwi_coarsen_collapse(bwi_coarsening *c, int64_t *collapsed);
bw_status bwi_coarsen_move(bwi_coarsening *c);

/* coarsen_exchange.c: exchange diagonals for better shapes. */
bw_status bwi_coarsen_exchange(bwi_coarsening *c);

#endif
