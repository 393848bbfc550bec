/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Points that go with the elements of a grid.
 *
 * The element of a point is that of its cell; where the cell is void, the nearest element is looked
 * for in rings of cells around it, and from RINGS on among all elements. Nearest is by distance to
 * the element's box, the first of equally near ones. */
#include "grid/internal.h"

#include <math.h>
#include <stdlib.h>

enum { RINGS = 6, GRAIN = 512 };

static void destroy(void *object) {
  bw_embedding *it = (bw_embedding *)object;
  bw_release(it->grid);
  bw_free(it->element);
  bw_free(it->local);
  bw_free(it->weight);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_embedding *it = (const bw_embedding *)object;
  return sizeof *it + (size_t)it->point_count * (sizeof(int32_t) + 11 * sizeof(double));
}

static const bw_kind embedding_kind = {"embedding", destroy, bytes};

typedef struct search {
  const bw_grid *grid;
  double place[3]; /* of the point, in cells */
  int32_t best;
  double distance; /* squared, m2 */
} search;

static void try_element(search *s, int32_t element) {
  int32_t at[3];
  double sum = 0;
  bwi_grid_place(s->grid->cells, s->grid->cell[element], at);
  for (int d = 0; d < 3; d++) {
    double t = s->place[d] - at[d], out = t < 0 ? -t : t > 1 ? t - 1 : 0;
    sum += out * s->grid->spacing[d] * (out * s->grid->spacing[d]);
  }
  if (sum < s->distance || (sum == s->distance && element < s->best)) {
    s->distance = sum;
    s->best = element;
  }
}

/* Cells whose largest offset from the centre is `ring`. */
static void try_ring(search *s, const int32_t centre[3], int ring) {
  const int32_t *n = s->grid->cells;
  for (int k = -ring; k <= ring; k++)
    for (int j = -ring; j <= ring; j++) {
      bool shell = abs(k) == ring || abs(j) == ring;
      for (int i = -ring; i <= ring; i += shell || ring == 0 ? 1 : 2 * ring) {
        int64_t x = (int64_t)centre[0] + i, y = (int64_t)centre[1] + j, z = (int64_t)centre[2] + k;
        if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2])
          continue;
        int32_t element = s->grid->at[x + n[0] * (y + n[1] * z)];
        if (element >= 0)
          try_element(s, element);
      }
    }
}

static void find(search *s) {
  const bw_grid *grid = s->grid;
  int32_t centre[3];
  double min = fmin(grid->spacing[0], fmin(grid->spacing[1], grid->spacing[2]));
  for (int d = 0; d < 3; d++) {
    /* Points beside the lattice search from the cell next to them. */
    double cell = fmin(fmax(floor(s->place[d]), 0), grid->cells[d] - 1);
    centre[d] = (int32_t)cell;
  }
  s->best = -1;
  s->distance = INFINITY;
  for (int ring = 0; ring < RINGS; ring++) {
    /* What lies in this ring is at least ring - 1 cells away. */
    double near = ring > 1 ? (ring - 1) * min : 0;
    if (s->best >= 0 && near * near > s->distance)
      return;
    try_ring(s, centre, ring);
    if (s->best >= 0 && s->distance == 0)
      return;
  }
  if (s->best >= 0 && (RINGS - 1) * min * ((RINGS - 1) * min) > s->distance)
    return;
  for (int32_t e = 0; e < grid->element_count; e++)
    try_element(s, e);
  if (s->best < 0)
    s->best = 0; /* squares overflowed: all are too far */
}

typedef struct job {
  bw_context *context;
  bw_embedding *it;
  const double *point;
  double reach;
} job;

static bw_status too_far(const job *j, int64_t p, const double local[3]) {
  const double *x = j->point + 3 * p;
  double max = 0, low[3], high[3];
  for (int d = 0; d < 3; d++)
    max = fmax(max, fmax(-local[d], local[d] - 1));
  bw_grid_box(j->it->grid, low, high);
  bw_status status = bw_fail(
      j->context, BW_GEOMETRY,
      "point %lld at (%g, %g, %g) m lies %.3g cells from the nearest element, more than %g; the "
      "elements are between (%g, %g, %g) and (%g, %g, %g) m",
      (long long)p + 1, x[0], x[1], x[2], max, j->reach, low[0], low[1], low[2], high[0], high[1],
      high[2]);
  bw_detail_number(j->context, "point", (double)p + 1);
  bw_detail_number(j->context, "cells", max);
  return status;
}

static bw_status embed(void *data, int64_t begin, int64_t end, int worker) {
  job *j = (job *)data;
  const bw_grid *grid = j->it->grid;
  (void)worker;
  for (int64_t p = begin; p < end; p++) {
    search s = {grid, {0}, -1, 0};
    double *local = j->it->local + 3 * p;
    int32_t at[3];
    bool far = false;
    for (int d = 0; d < 3; d++) {
      double x = j->point[3 * p + d];
      if (!isfinite(x))
        return bw_fail(j->context, BW_INVALID, "point %lld has %c = %g; it must be finite",
                       (long long)p + 1, "xyz"[d], x);
      s.place[d] = (x - grid->origin[d]) / grid->spacing[d];
    }
    find(&s);
    bwi_grid_place(grid->cells, grid->cell[s.best], at);
    for (int d = 0; d < 3; d++) {
      local[d] = s.place[d] - at[d];
      far |= local[d] < -j->reach || local[d] > 1 + j->reach;
    }
    if (far)
      return too_far(j, p, local);
    j->it->element[p] = s.best;
    for (int c = 0; c < 8; c++) {
      double w = 1;
      for (int d = 0; d < 3; d++)
        w *= c >> d & 1 ? local[d] : 1 - local[d];
      j->it->weight[8 * p + c] = w;
    }
  }
  return bw_check_cancel(j->context);
}

bw_status bw_embedding_create(bw_context *context, const bw_grid *grid, int64_t points,
                              const double *point, double reach, bw_embedding **out) {
  bw_status status = BW_OK;
  if (!(reach >= 0))
    return bw_fail(context, BW_INVALID, "a reach of %g cells; it must be 0 or more", reach);
  bw_embedding *it = BW_NEW0(context, bw_embedding, 1);
  if (!it)
    return BW_MEMORY;
  bw_object_init(it, &embedding_kind);
  it->grid = (const bw_grid *)bw_retain(grid);
  it->point_count = points;
  it->element = BW_NEW(context, int32_t, points);
  it->local = BW_NEW(context, double, 3 * points);
  it->weight = BW_NEW(context, double, 8 * points);
  BW_TRY_MEMORY(it->element && it->local && it->weight);
  job j = {context, it, point, reach};
  BW_TRY(bw_parallel(context, points, GRAIN, embed, &j));
  *out = it;
  it = NULL;
done:
  bw_release(it);
  return status;
}

void bw_embedding_values(const bw_embedding *it, int components, const double *values,
                         double *at_points) {
  for (int64_t p = 0; p < it->point_count; p++) {
    const int32_t *node = it->grid->element + 8 * (int64_t)it->element[p];
    const double *w = it->weight + 8 * p;
    for (int i = 0; i < components; i++) {
      double sum = 0;
      for (int c = 0; c < 8; c++)
        sum += w[c] * values[(int64_t)components * node[c] + i];
      at_points[components * p + i] = sum;
    }
  }
}

void bw_embedding_add(const bw_embedding *it, int components, const double *at_points,
                      double *values) {
  for (int64_t p = 0; p < it->point_count; p++) {
    const int32_t *node = it->grid->element + 8 * (int64_t)it->element[p];
    const double *w = it->weight + 8 * p;
    for (int c = 0; c < 8; c++)
      for (int i = 0; i < components; i++)
        values[(int64_t)components * node[c] + i] += w[c] * at_points[components * p + i];
  }
}
