/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Moving inner nodes towards the middle of their stars: Gauss-Seidel rounds in the order of the
 * nodes, each move checked against the elements around. */
#include "plane/edge_flips.h"

#include <math.h>
#include <string.h>

enum { MAX_AROUND = 64, WANTED = 2 };

/* The elements around an inner node, counter-clockwise. 0 when they do not close (or are too many
 * to be worth while). */
static int around(const bwi_edge_flips *flipping, int32_t node, int32_t element[MAX_AROUND],
                  int corner[MAX_AROUND]) {
  size_t width = flipping->order == 2 ? 6 : 3;
  int32_t first = flipping->star[node], e = first;
  int count = 0;
  do {
    const int32_t *n = flipping->element + width * (size_t)e;
    int k = n[0] == node ? 0 : n[1] == node ? 1 : 2;
    if (count == MAX_AROUND)
      return 0;
    element[count] = e;
    corner[count++] = k;
    e = flipping->neighbour[3 * (size_t)e + (size_t)((k + 2) % 3)];
    if (e < 0)
      return 0;
  } while (e != first);
  return count;
}

/* Qualities of the elements around as they are now; the worst. */
static double check(const bwi_edge_flips *flipping, int count, const int32_t *element,
                    double *quality) {
  size_t width = flipping->order == 2 ? 6 : 3;
  double worst = INFINITY;
  for (int i = 0; i < count; i++) {
    quality[i] = bwi_plane_quality(flipping->point, flipping->element + width * (size_t)element[i],
                                   flipping->order);
    worst = fmin(worst, quality[i]);
  }
  return worst;
}

/* The node and, at order 2, the mid-edge nodes of the edges to it. */
static void put(bwi_edge_flips *flipping, int32_t node, int count, const int32_t *element,
                const int *corner, const double at[2]) {
  memcpy(flipping->point + 2 * (size_t)node, at, 2 * sizeof *at);
  if (flipping->order == 1)
    return;
  for (int i = 0; i < count; i++) {
    const int32_t *n = flipping->element + 6 * (size_t)element[i];
    const double *other = flipping->point + 2 * (size_t)n[(corner[i] + 1) % 3];
    double *middle = flipping->point + 2 * (size_t)n[3 + corner[i]];
    for (int k = 0; k < 2; k++)
      middle[k] = (at[k] + other[k]) / 2;
  }
}

/* Mean of the centroids of the elements around, which is two thirds of the way to the mean of the
 * ring: it keeps a grading that is there, as weights by area would not. */
static void centroid_of(const bwi_edge_flips *flipping, int count, const int32_t *element,
                        const int *corner, double target[2]) {
  size_t width = flipping->order == 2 ? 6 : 3;
  target[0] = target[1] = 0;
  for (int i = 0; i < count; i++) {
    const int32_t *n = flipping->element + width * (size_t)element[i];
    const double *a = flipping->point + 2 * (size_t)n[(corner[i] + 1) % 3];
    for (int k = 0; k < 2; k++)
      target[k] += a[k] / count;
  }
}

static bool smooth_node(bwi_edge_flips *flipping, int32_t node, double below, double enough) {
  int32_t element[MAX_AROUND];
  int corner[MAX_AROUND];
  double quality[MAX_AROUND], before = INFINITY, old[2], target[2], part = 1;
  int count = around(flipping, node, element, corner);
  if (count < 3)
    return false;
  for (int i = 0; i < count; i++)
    before = fmin(before, flipping->quality[element[i]]);
  if (before >= below)
    return false;
  memcpy(old, flipping->point + 2 * (size_t)node, sizeof old);
  centroid_of(flipping, count, element, corner, target);
  for (int tries = 0; tries < 4; tries++, part /= 2) {
    double at[2] = {old[0] + part * (target[0] - old[0]), old[1] + part * (target[1] - old[1])};
    put(flipping, node, count, element, corner, at);
    double after = check(flipping, count, element, quality);
    if (!(after > before || after >= enough))
      continue;
    for (int i = 0; i < count; i++) {
      flipping->quality[element[i]] = quality[i];
      for (int k = 0; k < 3; k++)
        bwi_edge_flips_queue(flipping, element[i], k);
    }
    return true;
  }
  put(flipping, node, count, element, corner, old);
  return false;
}

int32_t bwi_edge_flips_smooth(bwi_edge_flips *flipping, double below, double enough) {
  size_t width = flipping->order == 2 ? 6 : 3;
  int32_t moved = 0;
  /* mark the nodes that are wanted, so that they come in their order */
  for (int32_t e = 0; e < flipping->element_count; e++)
    if (flipping->quality[e] < below)
      for (size_t k = 0; k < 3; k++)
        flipping->fixed[flipping->element[width * (size_t)e + k]] |= WANTED;
  for (int32_t node = 0; node < flipping->corner_count; node++) {
    uint8_t flags = flipping->fixed[node];
    flipping->fixed[node] = flags & 1;
    if (flags == WANTED)
      moved += smooth_node(flipping, node, below, enough);
  }
  return moved;
}
