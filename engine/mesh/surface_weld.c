/* Welding: merging points that are equal or nearly so.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Points are hashed by the cell of a grid they lie in (tolerance 0: by their coordinates). The
 * table holds cluster numbers; clusters of one cell are chained. Points are taken in order, so the
 * result depends on nothing but the input. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"

typedef struct weld_table {
  size_t mask;
  int32_t *head; /* mask + 1: a cluster, or -1 */
  int32_t *next; /* per cluster */
  double *at;    /* per cluster x 3: its first point */
} weld_table;

static uint64_t mix(uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93u;
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93u;
  return x ^ x >> 32;
}

static size_t cell_hash(const double cell[3], size_t mask) {
  uint64_t hash = 0;
  for (int k = 0; k < 3; k++) {
    double x = cell[k] + 0.0; /* -0 and 0 are the same place */
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    hash = mix(hash ^ bits) + (uint64_t)k;
  }
  return (size_t)hash & mask;
}

/* The nearest cluster within tolerance among those of a hash cell, or the one given. */
static int32_t nearest(const weld_table *table, const double cell[3], const double *x,
                       double *square, int32_t best) {
  for (int32_t c = table->head[cell_hash(cell, table->mask)]; c >= 0; c = table->next[c]) {
    const double *y = table->at + 3 * (int64_t)c;
    double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    double far = bw_dot(d, d);
    if (far < *square || (far == *square && (best < 0 || c < best))) {
      *square = far;
      best = c;
    }
  }
  return best;
}

bw_status bwi_weld_map(bw_context *context, int64_t points, const double *point,
                       const uint8_t *used, double tolerance, int32_t *to, int32_t *count) {
  bw_status status = BW_OK;
  weld_table table = {.mask = 1};
  while (table.mask < (size_t)points)
    table.mask = 2 * table.mask + 1;
  table.head = BW_NEW(context, int32_t, table.mask + 1);
  table.next = BW_NEW(context, int32_t, points);
  table.at = BW_NEW(context, double, points * 3);
  BW_TRY_MEMORY(table.head && table.next && table.at);
  memset(table.head, 0xff, (table.mask + 1) * sizeof *table.head);

  int32_t clusters = 0;
  for (int64_t i = 0; i < points; i++) {
    if (used && !used[i]) {
      to[i] = -1;
      continue;
    }
    const double *x = point + 3 * i;
    double cell[3] = {x[0], x[1], x[2]}, square = tolerance * tolerance;
    int32_t best = -1;
    if (tolerance > 0) {
      for (int k = 0; k < 3; k++)
        cell[k] = floor(x[k] / tolerance);
      for (int step = 0; step < 27; step++) {
        double by[3] = {cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1, cell[2] + step / 9 - 1};
        best = nearest(&table, by, x, &square, best);
      }
    } else {
      best = nearest(&table, cell, x, &square, best);
    }
    if (best < 0) {
      best = clusters++;
      memcpy(table.at + 3 * (int64_t)best, x, 3 * sizeof *x);
      size_t slot = cell_hash(cell, table.mask);
      table.next[best] = table.head[slot];
      table.head[slot] = best;
    }
    to[i] = best;
    if (i % 65536 == 65535)
      BW_TRY(bw_check_cancel(context));
  }
  *count = clusters;
done:
  bw_free(table.head);
  bw_free(table.next);
  bw_free(table.at);
  return status;
}

bw_status bw_surface_weld(bw_context *context, const bw_surface *surface, double tolerance,
                          bw_surface **welded) {
  if (!(tolerance >= 0) || !isfinite(tolerance))
    return bw_fail(context, BW_INVALID, "weld tolerance %g m: 0 or a positive length is needed",
                   tolerance);
  bw_status status = BW_OK;
  int64_t points = surface->point_count, corners = 3 * (int64_t)surface->triangle_count;
  double *point = NULL;
  int32_t *triangle = NULL, *group = NULL, count = 0;
  uint8_t *used = BW_NEW0(context, uint8_t, points);
  int32_t *to = BW_NEW(context, int32_t, points);
  BW_TRY_MEMORY(used && to);
  for (int64_t i = 0; i < corners; i++)
    used[surface->triangle[i]] = 1;
  BW_TRY(bwi_weld_map(context, points, surface->point, used, tolerance, to, &count));

  point = BW_NEW(context, double, (size_t)count * 3);
  triangle = BW_NEW(context, int32_t, corners);
  if (surface->group)
    group = BW_NEW(context, int32_t, surface->triangle_count);
  BW_TRY_MEMORY(point && triangle && (!surface->group || group));
  for (int64_t i = points - 1; i >= 0; i--) /* downwards: the first point of a cluster stays */
    if (to[i] >= 0)
      memcpy(point + 3 * (int64_t)to[i], surface->point + 3 * i, 3 * sizeof *point);
  for (int64_t i = 0; i < corners; i++)
    triangle[i] = to[surface->triangle[i]];
  if (group && corners)
    memcpy(group, surface->group, (size_t)surface->triangle_count * sizeof *group);
  BW_TRY(bw_surface_adopt(context, count, point, surface->triangle_count, triangle, group, welded));
  bwi_keep_names(surface, *welded);
  point = NULL;
  triangle = group = NULL;
done:
  bw_free(used);
  bw_free(to);
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  return status;
}
