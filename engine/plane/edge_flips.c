/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flips of edges towards Delaunay. Nodes are kept, also those in the middle of edges: the middle of
 * the edge that goes becomes the middle of the one that comes. */
#include "plane/edge_flips.h"

#include <math.h>
#include <string.h>

bw_status bwi_edge_flips_open(bw_context *context, const bw_plane_topology *topology,
                              const double *point, bwi_edge_flips *flipping) {
  const bw_plane_nodes *nodes = topology->nodes;
  size_t width = (size_t)bwi_plane_width(nodes), elements = (size_t)topology->element_count;
  *flipping = (bwi_edge_flips){.order = nodes->order,
                               .corner_count = nodes->corner_count,
                               .element_count = topology->element_count};
  flipping->element = BW_NEW(context, int32_t, width * elements);
  flipping->neighbour = BW_NEW(context, int32_t, 3 * elements);
  flipping->constrained = BW_NEW0(context, uint8_t, 3 * elements);
  flipping->fixed = BW_NEW0(context, uint8_t, nodes->corner_count);
  flipping->point = BW_NEW(context, double, 2 * (size_t)nodes->node_count);
  flipping->star = BW_NEW(context, int32_t, nodes->corner_count);
  flipping->quality = BW_NEW(context, double, elements);
  flipping->queue = BW_NEW(context, int32_t, 3 * elements);
  flipping->queued = BW_NEW0(context, uint8_t, 3 * elements);
  if (!flipping->element || !flipping->neighbour || !flipping->constrained || !flipping->fixed ||
      !flipping->point || !flipping->star || !flipping->quality || !flipping->queue ||
      !flipping->queued) {
    bwi_edge_flips_clear(flipping);
    return BW_MEMORY;
  }
  memcpy(flipping->element, topology->element, width * elements * sizeof(int32_t));
  memcpy(flipping->neighbour, topology->neighbour, 3 * elements * sizeof(int32_t));
  memcpy(flipping->point, point, 2 * (size_t)nodes->node_count * sizeof(double));
  for (size_t e = elements; e-- > 0;)
    for (size_t k = 0; k < 3; k++) {
      int32_t other = flipping->neighbour[3 * e + k], corner = flipping->element[width * e + k];
      flipping->star[corner] = (int32_t)e;
      flipping->fixed[corner] |= nodes->segment[corner] >= 0;
      if (other >= 0 && topology->region[e] == topology->region[other])
        continue;
      flipping->constrained[3 * e + k] = 1;
      flipping->fixed[corner] = flipping->fixed[flipping->element[width * e + (k + 1) % 3]] = 1;
    }
  for (size_t e = 0; e < elements; e++)
    flipping->quality[e] =
        bwi_plane_quality(flipping->point, flipping->element + width * e, flipping->order);
  /* a loop between two parts of one region is an outline's as well */
  for (int32_t s = 0; s < topology->side_count; s++)
    for (int i = 0; i < 2; i++) {
      int32_t e = topology->side_element[2 * s + i];
      if (e < 0)
        continue;
      int32_t from = topology->side[(width == 6 ? 3 : 2) * (size_t)s + (size_t)i];
      for (size_t k = 0; k < 3; k++)
        if (flipping->element[width * (size_t)e + k] == from)
          flipping->constrained[3 * (size_t)e + k] = 1;
    }
  return BW_OK;
}

void bwi_edge_flips_clear(bwi_edge_flips *flipping) {
  bw_free(flipping->element);
  bw_free(flipping->neighbour);
  bw_free(flipping->constrained);
  bw_free(flipping->fixed);
  bw_free(flipping->point);
  bw_free(flipping->star);
  bw_free(flipping->quality);
  bw_free(flipping->queue);
  bw_free(flipping->queued);
  memset(flipping, 0, sizeof *flipping);
}

/* The edge of an element that begins at a corner. */
static int edge_with(const bwi_edge_flips *flipping, int32_t e, int32_t from) {
  const int32_t *n = flipping->element + (flipping->order == 2 ? 6 : 3) * (size_t)e;
  return n[0] == from ? 0 : n[1] == from ? 1 : 2;
}

/* Corners a, b of edge k of element e, c opposite in e, d opposite in its neighbour f, there edge
 * m. */
typedef struct quad {
  int32_t e, f;
  int k, m;
  int32_t a, b, c, d;
} quad;

static quad quad_of(const bwi_edge_flips *flipping, int32_t e, int k) {
  size_t width = flipping->order == 2 ? 6 : 3;
  quad q = {.e = e, .k = k, .f = flipping->neighbour[3 * (size_t)e + (size_t)k]};
  const int32_t *n = flipping->element + width * (size_t)e;
  q.a = n[k];
  q.b = n[(k + 1) % 3];
  q.c = n[(k + 2) % 3];
  q.m = edge_with(flipping, q.f, q.b);
  q.d = flipping->element[width * (size_t)q.f + (size_t)((q.m + 2) % 3)];
  return q;
}

/* The sine of the sum of the angles opposite to the edge is negative: not Delaunay. */
static bool violates(const bwi_edge_flips *flipping, const quad *q) {
  const double *a = flipping->point + 2 * (size_t)q->a, *b = flipping->point + 2 * (size_t)q->b;
  const double *c = flipping->point + 2 * (size_t)q->c, *d = flipping->point + 2 * (size_t)q->d;
  double ca[2] = {a[0] - c[0], a[1] - c[1]}, cb[2] = {b[0] - c[0], b[1] - c[1]};
  double da[2] = {a[0] - d[0], a[1] - d[1]}, db[2] = {b[0] - d[0], b[1] - d[1]};
  double cross_c = ca[0] * cb[1] - ca[1] * cb[0], dot_c = ca[0] * cb[0] + ca[1] * cb[1];
  double cross_d = db[0] * da[1] - db[1] * da[0], dot_d = da[0] * db[0] + da[1] * db[1];
  if (!(cross_c > 0 && cross_d > 0))
    return false;
  double size = sqrt((ca[0] * ca[0] + ca[1] * ca[1]) * (cb[0] * cb[0] + cb[1] * cb[1])) *
                sqrt((da[0] * da[0] + da[1] * da[1]) * (db[0] * db[0] + db[1] * db[1]));
  return cross_c * dot_d + dot_c * cross_d < -1e-9 * size;
}

/* What the two elements become: e = c d b, f = d c a, the new edge first, with mid-edge nodes. */
static void turned(const bwi_edge_flips *flipping, const quad *q, int32_t e[6], int32_t f[6]) {
  e[0] = q->d;
  e[1] = q->c;
  e[2] = q->a;
  f[0] = q->c;
  f[1] = q->d;
  f[2] = q->b;
  if (flipping->order == 1)
    return;
  const int32_t *en = flipping->element + 6 * (size_t)q->e,
                *fn = flipping->element + 6 * (size_t)q->f;
  e[3] = f[3] = en[3 + q->k];
  e[4] = en[3 + (q->k + 2) % 3]; /* c a */
  e[5] = fn[3 + (q->m + 1) % 3]; /* a d */
  f[4] = fn[3 + (q->m + 2) % 3]; /* d b */
  f[5] = en[3 + (q->k + 1) % 3]; /* b c */
}

/* Both elements must come out right: convexity follows from the sum of the angles but for rounding,
 * curved sides (order 2) may fold the new ones. The middle goes to its new place, or stays. */
static bool comes_out_right(bwi_edge_flips *flipping, const int32_t e[6], const int32_t f[6],
                            double floor, double quality[2]) {
  double *middle = NULL, before[2] = {0, 0};
  if (flipping->order == 2) {
    middle = flipping->point + 2 * (size_t)e[3];
    const double *c = flipping->point + 2 * (size_t)e[0], *d = flipping->point + 2 * (size_t)e[1];
    memcpy(before, middle, sizeof before);
    for (int i = 0; i < 2; i++)
      middle[i] = (c[i] + d[i]) / 2;
  }
  quality[0] = bwi_plane_quality(flipping->point, e, flipping->order);
  quality[1] = bwi_plane_quality(flipping->point, f, flipping->order);
  if (quality[0] > floor && quality[1] > floor)
    return true;
  if (middle)
    memcpy(middle, before, sizeof before);
  return false;
}

/* After element `at` got other edges: its neighbour across edge k learns who is there. */
static void link(bwi_edge_flips *flipping, int32_t at, int k, int32_t other, int32_t was,
                 uint8_t constrained) {
  flipping->neighbour[3 * (size_t)at + (size_t)k] = other;
  flipping->constrained[3 * (size_t)at + (size_t)k] = constrained;
  if (other >= 0 && was != at) {
    /* the edge of `other` that begins where edge k of `at` ends */
    size_t width = flipping->order == 2 ? 6 : 3;
    int32_t from = flipping->element[width * (size_t)at + (size_t)((k + 1) % 3)];
    flipping->neighbour[3 * (size_t)other + (size_t)edge_with(flipping, other, from)] = at;
  }
}

static bool try_flip(bwi_edge_flips *flipping, int32_t e, int k) {
  size_t width = flipping->order == 2 ? 6 : 3;
  quad q = quad_of(flipping, e, k);
  int32_t en[6], fn[6];
  if (!violates(flipping, &q))
    return false;
  double floor = fmin(flipping->quality[q.e], flipping->quality[q.f]), quality[2];
  floor = flipping->order == 2 ? fmax(fmin(floor, 0.3), 0) : 0;
  turned(flipping, &q, en, fn);
  if (!comes_out_right(flipping, en, fn, floor, quality))
    return false;
  flipping->quality[q.e] = quality[0];
  flipping->quality[q.f] = quality[1];
  const int32_t *around_e = flipping->neighbour + 3 * (size_t)q.e;
  const int32_t *around_f = flipping->neighbour + 3 * (size_t)q.f;
  const uint8_t *constrained_e = flipping->constrained + 3 * (size_t)q.e,
                *constrained_f = flipping->constrained + 3 * (size_t)q.f;
  int32_t ca = around_e[(k + 2) % 3], bc = around_e[(k + 1) % 3];
  int32_t ad = around_f[(q.m + 1) % 3], db = around_f[(q.m + 2) % 3];
  uint8_t constrained_ca = constrained_e[(k + 2) % 3], constrained_bc = constrained_e[(k + 1) % 3];
  uint8_t constrained_ad = constrained_f[(q.m + 1) % 3],
          constrained_db = constrained_f[(q.m + 2) % 3];
  memcpy(flipping->element + width * (size_t)q.e, en, width * sizeof *en);
  memcpy(flipping->element + width * (size_t)q.f, fn, width * sizeof *fn);
  link(flipping, q.e, 1, ca, q.e, constrained_ca);
  link(flipping, q.e, 2, ad, q.f, constrained_ad);
  link(flipping, q.f, 1, db, q.f, constrained_db);
  link(flipping, q.f, 2, bc, q.e, constrained_bc);
  flipping->neighbour[3 * (size_t)q.e] = q.f;
  flipping->neighbour[3 * (size_t)q.f] = q.e;
  flipping->constrained[3 * (size_t)q.e] = flipping->constrained[3 * (size_t)q.f] = 0;
  flipping->star[q.a] = flipping->star[q.c] = q.e;
  flipping->star[q.b] = flipping->star[q.d] = q.f;
  return true;
}

void bwi_edge_flips_queue(bwi_edge_flips *flipping, int32_t element, int k) {
  int64_t h = 3 * (int64_t)element + k, edges = 3 * (int64_t)flipping->element_count;
  if (flipping->constrained[h] || flipping->neighbour[h] < 0 || flipping->queued[h])
    return;
  flipping->queued[h] = 1;
  flipping->queue[(flipping->head + flipping->waiting++) % edges] = (int32_t)h;
}

void bwi_edge_flips_queue_all(bwi_edge_flips *flipping) {
  for (int32_t e = 0; e < flipping->element_count; e++)
    for (int k = 0; k < 3; k++)
      if (flipping->neighbour[3 * (size_t)e + (size_t)k] > e)
        bwi_edge_flips_queue(flipping, e, k);
}

int32_t bwi_edge_flips_flip(bwi_edge_flips *flipping) {
  int64_t edges = 3 * (int64_t)flipping->element_count, flips = 0;
  while (flipping->waiting > 0) {
    int32_t h = flipping->queue[flipping->head];
    flipping->head = flipping->head + 1 < edges ? flipping->head + 1 : 0;
    flipping->waiting--;
    flipping->queued[h] = 0;
    /* rounding cannot make flips go round for ever: beyond any number that is needed they stop */
    if (flipping->constrained[h] || flipping->neighbour[h] < 0 || flips > 16 * edges ||
        !try_flip(flipping, h / 3, h % 3))
      continue;
    flips++;
    int32_t other = flipping->neighbour[3 * (size_t)(h / 3)];
    for (int k = 1; k < 3; k++) {
      bwi_edge_flips_queue(flipping, h / 3, k);
      bwi_edge_flips_queue(flipping, other, k);
    }
  }
  return (int32_t)flips;
}
