/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Resultant arrows: a pressure's nodal shares summed into a few forces.
 *
 * The loaded pressure node with the largest force starts a cluster, which takes every loaded node
 * not taken yet within the radius whose push goes the same way (so that the two faces of a thin
 * wall do not cancel each other); then the largest of the rest starts the next. Together the arrows
 * carry the whole force of the pressure. Nodes are found through a grid of cells of the radius. */
#include "barwright/analysis.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double smallest_fraction = 1e-9; /* of the largest pressure: less is rounding */
static const double same_way = 0.5; /* cosine between a node's push and the cluster's first */

typedef struct loaded {
  double at[3], force[3], size, area;
  uint64_t cell;
  int32_t column;
  bool taken;
} loaded;

static int by_cell(const void *a, const void *b) {
  const loaded *x = (const loaded *)a, *y = (const loaded *)b;
  if (x->cell != y->cell)
    return x->cell < y->cell ? -1 : 1;
  return (x->column > y->column) - (x->column < y->column);
}

typedef struct rank {
  double size;
  int32_t index;
} rank;

static int by_size(const void *a, const void *b) {
  const rank *x = (const rank *)a, *y = (const rank *)b;
  if (x->size != y->size)
    return x->size > y->size ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

enum { CELL_BITS = 20 };

static uint64_t cell_number(const int64_t cell[3]) {
  return ((uint64_t)cell[0] << CELL_BITS | (uint64_t)cell[1]) << CELL_BITS | (uint64_t)cell[2];
}

static void cell_at(const double at[3], const double low[3], double width, int64_t cell[3]) {
  for (int k = 0; k < 3; k++)
    cell[k] = 1 + (int64_t)((at[k] - low[k]) / width);
}

static int32_t first_of_cell(const loaded *node, int32_t count, uint64_t cell) {
  int32_t low = 0, high = count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (node[middle].cell < cell)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* A node's columns together. */
static int32_t list_loaded(const bw_pressure_basis *basis, const double *pressure, loaded *node) {
  double largest = 0;
  int32_t count = 0;
  for (int32_t j = 0; j < basis->count; j++)
    largest = fmax(largest, fabs(pressure[j]));
  for (int32_t first = 0; first < basis->count; first += basis->directions) {
    loaded *l = &node[count];
    memset(l, 0, sizeof *l);
    l->column = first;
    for (int32_t j = first; j < first + basis->directions; j++) {
      if (!(fabs(pressure[j]) > smallest_fraction * largest))
        continue;
      l->area = basis->area[j];
      for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++)
        for (int c = 0; c < 3; c++)
          l->force[c] += pressure[j] * basis->coefficient[3 * k + c];
    }
    if (l->area == 0)
      continue;
    memcpy(l->at, basis->at + 3 * (size_t)first, sizeof l->at);
    l->size = bw_norm(l->force);
    count++;
  }
  return count;
}

/* Sums the cluster around node `start`. */
static bw_arrow gather(loaded *node, int32_t count, int32_t start, const double low[3],
                       double width, double radius) {
  bw_arrow arrow = {{0, 0, 0}, {0, 0, 0}, 0};
  const loaded first = node[start];
  double weight = 0;
  int64_t centre[3];
  cell_at(first.at, low, width, centre);
  for (int around = 0; around < 27; around++) {
    int64_t cell[3] = {centre[0] + around % 3 - 1, centre[1] + around / 3 % 3 - 1,
                       centre[2] + around / 9 - 1};
    uint64_t number = cell_number(cell);
    for (int32_t i = first_of_cell(node, count, number); i < count && node[i].cell == number; i++) {
      loaded *l = &node[i];
      double d[3] = {l->at[0] - first.at[0], l->at[1] - first.at[1], l->at[2] - first.at[2]};
      if (l->taken || bw_norm(d) > radius ||
          (i != start && bw_dot(l->force, first.force) < same_way * l->size * first.size))
        continue;
      l->taken = true;
      weight += l->size;
      arrow.area += l->area;
      for (int k = 0; k < 3; k++) {
        arrow.force[k] += l->force[k];
        arrow.at[k] += l->size * l->at[k];
      }
    }
  }
  for (int k = 0; k < 3; k++)
    arrow.at[k] = weight > 0 ? arrow.at[k] / weight : first.at[k];
  return arrow;
}

static int by_force(const void *a, const void *b) {
  const bw_arrow *s = (const bw_arrow *)a, *t = (const bw_arrow *)b;
  double x = bw_norm(s->force), y = bw_norm(t->force);
  for (int k = 0; k < 3 && x == y; k++) {
    x = s->at[k];
    y = t->at[k];
  }
  return (x < y) - (x > y);
}

bw_status bw_resultant_arrows(bw_context *context, const bw_pressure_basis *basis,
                              const double *pressure, double radius, int *arrow_count,
                              bw_arrow **arrows) {
  bw_status status = BW_OK;
  loaded *node = NULL;
  rank *order = NULL;
  bw_arrow *list = NULL;
  size_t capacity = 0, found = 0;
  double low[3], high[3], diagonal = 0;
  if (!(radius >= 0) || isinf(radius))
    return bw_fail(context, BW_INVALID, "arrows within a radius of %g m: a length above 0 expected",
                   radius);
  for (int32_t j = 0; j < basis->count; j++)
    if (!isfinite(pressure[j]))
      return bw_fail(context, BW_INVALID, "pressure %d is %g: it must be a finite number", j + 1,
                     pressure[j]);
  bw_mesh_box(basis->mesh, low, high);
  for (int k = 0; k < 3; k++)
    diagonal += (high[k] - low[k]) * (high[k] - low[k]);
  diagonal = sqrt(diagonal);
  if (radius == 0)
    radius = 0.05 * diagonal;
  double width = fmax(radius, diagonal / ((1 << CELL_BITS) - 4));
  node = BW_NEW(context, loaded, basis->count);
  order = BW_NEW(context, rank, basis->count);
  BW_TRY_MEMORY(node && order);
  int32_t count = list_loaded(basis, pressure, node);
  for (int32_t i = 0; i < count; i++) {
    int64_t cell[3];
    cell_at(node[i].at, low, width, cell);
    node[i].cell = cell_number(cell);
  }
  qsort(node, (size_t)count, sizeof *node, by_cell);
  for (int32_t i = 0; i < count; i++)
    order[i] = (rank){node[i].size, i};
  qsort(order, (size_t)count, sizeof *order, by_size);
  for (int32_t i = 0; i < count; i++) {
    if (node[order[i].index].taken)
      continue;
    BW_TRY_MEMORY(bw_grow(context, (void **)&list, &capacity, found, 1, sizeof *list));
    list[found++] = gather(node, count, order[i].index, low, width, radius);
  }
  if (found > 1)
    qsort(list, found, sizeof *list, by_force);
done:
  bw_free(node);
  bw_free(order);
  if (status == BW_OK) {
    *arrow_count = (int)found;
    *arrows = list;
  } else {
    bw_free(list);
  }
  return status;
}
