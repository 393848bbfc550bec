/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A pressure basis of few columns: the boundary divided into patches with constant pressure.
 *
 * Farthest-point sampling: the next seed is the boundary node farthest from all seeds so far, ties
 * by number; every node belongs to the seed nearest to it. Distances between bodies are infinite,
 * so a body without a seed gets the next one. */
#include "analysis/worst_internal.h"

#include <math.h>
#include <string.h>

typedef struct patch_work {
  const bw_pressure_basis *basis;
  double *normal;   /* count x 3: mean outward normal around each node */
  double *distance; /* count: squared, to the nearest seed */
  int32_t *patch;   /* count */
  int32_t *seed;    /* patches */
  double length2; /* the squared distance that counts as much as unit normals at right angles / 2 */
} patch_work;

static void mean_normals(const bw_pressure_basis *basis, double *normal, double *area) {
  *area = 0;
  for (int32_t j = 0; j < basis->count; j++) {
    double sum[3] = {0, 0, 0};
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++)
      for (int i = 0; i < 3; i++)
        sum[i] -= basis->coefficient[3 * k + i];
    for (int i = 0; i < 3; i++)
      normal[3 * (size_t)j + (size_t)i] = basis->area[j] > 0 ? sum[i] / basis->area[j] : 0;
    *area += basis->area[j];
  }
}

static double distance2(const patch_work *w, int32_t i, int32_t j) {
  const bw_pressure_basis *basis = w->basis;
  const int32_t *body = basis->mesh->component;
  if (body[basis->node[i]] != body[basis->node[j]])
    return INFINITY;
  double sum = 0;
  for (size_t k = 0; k < 3; k++) {
    double d = basis->at[3 * (size_t)i + k] - basis->at[3 * (size_t)j + k];
    double n = w->normal[3 * (size_t)i + k] - w->normal[3 * (size_t)j + k];
    sum += d * d + w->length2 * n * n;
  }
  return sum;
}

/* Seeds and the patch of every column; returns the number of patches. */
static int32_t sample(const patch_work *w, int32_t patches) {
  int32_t n = w->basis->count, next = 0, count = 0;
  for (int32_t j = 0; j < n; j++)
    w->distance[j] = INFINITY;
  while (count < n && (count < patches || isinf(w->distance[next]))) {
    int32_t seed = next;
    w->seed[count] = seed;
    w->distance[seed] = 0;
    w->patch[seed] = count;
    for (int32_t j = 0; j < n; j++) {
      double d = distance2(w, seed, j);
      if (d < w->distance[j]) {
        w->distance[j] = d;
        w->patch[j] = count;
      }
      if (w->distance[j] > w->distance[next])
        next = j;
    }
    count++;
    if (next == seed || w->distance[next] == 0)
      break; /* the rest coincides with seeds */
  }
  return count;
}

/* The columns' sum: rows by a pass over the nodes' marks. */
static bw_status sum_columns(bw_context *context, const patch_work *w, int32_t patches,
                             bw_pressure_basis *coarse) {
  bw_status status = BW_OK;
  const bw_pressure_basis *basis = w->basis;
  int32_t n = basis->count;
  int64_t entries = basis->start[n], at = 0;
  int32_t *first = BW_NEW(context, int32_t, patches);
  int32_t *next = BW_NEW(context, int32_t, n);
  int64_t *place = BW_NEW(context, int64_t, basis->mesh->node_count);
  coarse->node = BW_NEW(context, int32_t, patches);
  coarse->at = BW_NEW(context, double, 3 * patches);
  coarse->area = BW_NEW0(context, double, patches);
  coarse->start = BW_NEW0(context, int64_t, (size_t)patches + 1);
  coarse->row = BW_NEW(context, int32_t, entries);
  coarse->coefficient = BW_NEW0(context, double, 3 * entries);
  BW_TRY_MEMORY(first && next && place && coarse->node && coarse->at && coarse->area &&
                coarse->start && coarse->row && coarse->coefficient);
  for (int32_t k = 0; k < patches; k++)
    first[k] = -1;
  for (int32_t j = n - 1; j >= 0; j--) {
    next[j] = first[w->patch[j]];
    first[w->patch[j]] = j;
  }
  for (int32_t i = 0; i < basis->mesh->node_count; i++)
    place[i] = -1;
  coarse->count = patches;
  for (int32_t k = 0; k < patches; k++) {
    coarse->node[k] = basis->node[w->seed[k]];
    memcpy(coarse->at + 3 * (size_t)k, basis->at + 3 * (size_t)w->seed[k], 3 * sizeof *coarse->at);
    coarse->start[k] = at;
    for (int32_t j = first[k]; j >= 0; j = next[j]) {
      coarse->area[k] += basis->area[j];
      for (int64_t l = basis->start[j]; l < basis->start[j + 1]; l++) {
        int32_t row = basis->row[l];
        if (place[row] < coarse->start[k]) {
          place[row] = at;
          coarse->row[at++] = row;
        }
        for (int i = 0; i < 3; i++)
          coarse->coefficient[3 * place[row] + i] += basis->coefficient[3 * l + i];
      }
    }
  }
  coarse->start[patches] = at;
done:
  bw_free(first);
  bw_free(next);
  bw_free(place);
  return status;
}

bw_status bwi_pressure_patches(bw_context *context, const bw_pressure_basis *basis, int32_t patches,
                               bw_pressure_basis **result) {
  bw_status status = BW_OK;
  bw_pressure_basis *coarse = NULL;
  size_t n = (size_t)basis->count;
  double area;
  if (basis->directions > 1)
    return bw_fail(context, BW_UNSUPPORTED,
                   "pressures constant on patches have no friction: give a basis without");
  patch_work w = {.basis = basis};
  w.normal = BW_NEW(context, double, 3 * n);
  w.distance = BW_NEW(context, double, n);
  w.patch = BW_NEW0(context, int32_t, n);
  w.seed = BW_NEW(context, int32_t, n);
  BW_TRY_MEMORY(w.normal && w.distance && w.patch && w.seed);
  mean_normals(basis, w.normal, &area);
  w.length2 = area / patches;
  int32_t count = sample(&w, patches);
  BW_TRY(bwi_pressure_basis_empty(context, basis->mesh, &coarse));
  coarse->complete = basis->complete;
  coarse->directions = 1;
  BW_TRY(sum_columns(context, &w, count, coarse));
  *result = coarse;
  coarse = NULL;
done:
  bw_release(coarse);
  bw_free(w.normal);
  bw_free(w.distance);
  bw_free(w.patch);
  bw_free(w.seed);
  return status;
}
