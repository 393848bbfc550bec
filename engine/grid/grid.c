/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Hexahedral grids from cells.
 *
 * Invariants: `cell` and `node` ascend; at[cell[e]] = e and at is -1 elsewhere; every node has an
 * element; element[8 e + c] is the node at corner c of cell[e]. Grids that differ in materials only
 * share the other lists; the one that owns them shares no one's. */
#include "grid/internal.h"

#include <math.h>
#include <string.h>

static void destroy(void *object) {
  bw_grid *grid = (bw_grid *)object;
  bw_free(grid->material);
  if (grid->lists) {
    bw_release(grid->lists);
  } else {
    bw_free(grid->cell);
    bw_free(grid->element);
    bw_free(grid->node);
    bw_free(grid->fraction);
    bw_free(grid->at);
  }
  bw_free(grid);
}

static size_t bytes(const void *object) {
  const bw_grid *grid = (const bw_grid *)object;
  size_t elements = (size_t)grid->element_count;
  if (grid->lists)
    return sizeof *grid + elements * sizeof(int32_t);
  return sizeof *grid + elements * (10 * sizeof(int32_t) + (grid->fraction ? sizeof(double) : 0)) +
         (size_t)grid->node_count * sizeof(int32_t) +
         (size_t)bwi_grid_cells(grid->cells) * sizeof(int32_t);
}

static const bw_kind grid_kind = {"grid", destroy, bytes};

static bw_status check(bw_context *context, const double origin[3], const double spacing[3],
                       const int32_t cells[3]) {
  static const char axis[] = "xyz";
  double points = 1;
  for (int d = 0; d < 3; d++) {
    if (!isfinite(origin[d]))
      return bw_fail(context, BW_INVALID, "the grid's origin has %c = %g; it must be finite",
                     axis[d], origin[d]);
    if (!isfinite(spacing[d]) || !(spacing[d] > 0))
      return bw_fail(context, BW_INVALID,
                     "the grid's spacing along %c is %g m; it must be positive", axis[d],
                     spacing[d]);
    if (cells[d] < 1)
      return bw_fail(context, BW_INVALID, "the grid has %d cells along %c; at least one is needed",
                     (int)cells[d], axis[d]);
    points *= (double)cells[d] + 1;
    double far = fmax(fabs(origin[d]), fabs(origin[d] + spacing[d] * cells[d]));
    if (!(spacing[d] > 1e-12 * far))
      return bw_fail(context, BW_INVALID,
                     "cells of %g m along %c, up to %g m from the origin, are lost in rounding: "
                     "move the grid nearer",
                     spacing[d], axis[d], far);
  }
  double cell = spacing[0] * spacing[1] * spacing[2];
  if (!isnormal(cell) || !isfinite(cell * points))
    return bw_fail(context, BW_INVALID,
                   "cells of %g x %g x %g m have a volume that no number holds: take another unit",
                   spacing[0], spacing[1], spacing[2]);
  if (points > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "a grid of %d x %d x %d cells has %.3g lattice points, more than 2^31: take "
                   "larger cells",
                   (int)cells[0], (int)cells[1], (int)cells[2], points);
  return BW_OK;
}

static bw_status count_elements(bw_context *context, bw_grid *grid, const int32_t *material,
                                const double *fraction) {
  int64_t cells = bwi_grid_cells(grid->cells);
  int32_t count = 0;
  for (int64_t c = 0; c < cells; c++) {
    int32_t m = material ? material[c] : 1;
    if (m < 0)
      return bw_fail(context, BW_INVALID, "cell %lld has material %d: at least 0 (void) expected",
                     (long long)c + 1, (int)m);
    if (m > 0 && fraction && !(fraction[c] > 0 && fraction[c] <= 1))
      return bw_fail(context, BW_INVALID,
                     "cell %lld has material %d and fraction %g; it must lie above 0 and at most 1",
                     (long long)c + 1, (int)m, fraction[c]);
    grid->at[c] = m > 0 ? count++ : -1;
  }
  grid->element_count = count;
  if (count == 0)
    return bw_fail(context, BW_EMPTY, "the grid has no element: all its %lld cells are void",
                   (long long)cells);
  return BW_OK;
}

/* Number the lattice points that elements have, in the lattice's order. */
static bw_status number_nodes(bw_context *context, bw_grid *grid) {
  bw_status status = BW_OK;
  int64_t points = bwi_grid_points(grid->cells), step[8];
  int32_t *number = BW_NEW0(context, int32_t, points), count = 0;
  if (!number)
    return BW_MEMORY;
  bwi_grid_corner_steps(grid->cells, step);
  for (int32_t e = 0; e < grid->element_count; e++) {
    int64_t first = bwi_grid_corner(grid->cells, grid->cell[e], 0);
    for (int c = 0; c < 8; c++)
      number[first + step[c]] = 1;
  }
  for (int64_t p = 0; p < points; p++)
    count += number[p];
  grid->node_count = count;
  grid->node = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(grid->node);
  count = 0;
  for (int64_t p = 0; p < points; p++)
    if (number[p]) {
      grid->node[count] = (int32_t)p;
      number[p] = count++;
    }
  for (int32_t e = 0; e < grid->element_count; e++) {
    int64_t first = bwi_grid_corner(grid->cells, grid->cell[e], 0);
    for (int c = 0; c < 8; c++)
      grid->element[8 * (int64_t)e + c] = number[first + step[c]];
  }
done:
  bw_free(number);
  return status;
}

bw_status bw_grid_create(bw_context *context, const double origin[3], const double spacing[3],
                         const int32_t cells[3], const int32_t *material, const double *fraction,
                         bw_grid **out) {
  bw_status status = check(context, origin, spacing, cells);
  if (status != BW_OK)
    return status;
  bw_grid *grid = BW_NEW0(context, bw_grid, 1);
  if (!grid)
    return BW_MEMORY;
  bw_object_init(grid, &grid_kind);
  for (int d = 0; d < 3; d++) {
    grid->origin[d] = origin[d];
    grid->spacing[d] = spacing[d];
    grid->cells[d] = cells[d];
  }
  int64_t total = bwi_grid_cells(cells);
  grid->at = BW_NEW(context, int32_t, total);
  BW_TRY_MEMORY(grid->at);
  BW_TRY(count_elements(context, grid, material, fraction));
  int32_t n = grid->element_count;
  grid->cell = BW_NEW(context, int32_t, n);
  grid->element = BW_NEW(context, int32_t, 8 * (int64_t)n);
  grid->material = BW_NEW(context, int32_t, n);
  grid->fraction = fraction ? BW_NEW(context, double, n) : NULL;
  BW_TRY_MEMORY(grid->cell && grid->element && grid->material && (!fraction || grid->fraction));
  for (int64_t c = 0; c < total; c++) {
    int32_t e = grid->at[c];
    if (e < 0)
      continue;
    grid->cell[e] = (int32_t)c;
    grid->material[e] = material ? material[c] : 1;
    if (fraction)
      grid->fraction[e] = fraction[c];
  }
  BW_TRY(number_nodes(context, grid));
  *out = grid;
  grid = NULL;
done:
  bw_release(grid);
  return status;
}

bw_status bw_grid_with_materials(bw_context *context, const bw_grid *grid, const int32_t *material,
                                 bw_grid **out) {
  for (int32_t e = 0; e < grid->element_count; e++)
    if (material[e] < 1)
      return bw_fail(context, BW_INVALID, "element %d has material %d: at least 1 expected",
                     (int)e + 1, (int)material[e]);
  bw_grid *made = BW_NEW(context, bw_grid, 1);
  int32_t *copy = BW_NEW(context, int32_t, grid->element_count);
  if (!made || !copy) {
    bw_free(made);
    bw_free(copy);
    return BW_MEMORY;
  }
  memcpy(copy, material, (size_t)grid->element_count * sizeof *copy);
  *made = *grid;
  bw_object_init(made, &grid_kind);
  made->lists = (const bw_grid *)bw_retain(grid->lists ? grid->lists : grid);
  made->material = copy;
  *out = made;
  return BW_OK;
}

bool bw_grid_same_elements(const bw_grid *a, const bw_grid *b) {
  if (a->at == b->at)
    return true;
  if (a->element_count != b->element_count || a->node_count != b->node_count)
    return false;
  for (int d = 0; d < 3; d++)
    if (a->cells[d] != b->cells[d])
      return false;
  for (int32_t e = 0; e < a->element_count; e++)
    if (a->cell[e] != b->cell[e])
      return false;
  return true;
}

void bw_grid_position(const bw_grid *grid, int32_t node, double at[3]) {
  int32_t place[3];
  bwi_grid_lattice(grid->cells, grid->node[node], place);
  for (int d = 0; d < 3; d++)
    at[d] = grid->origin[d] + grid->spacing[d] * place[d];
}

double bw_grid_volume(const bw_grid *grid) {
  double cell = grid->spacing[0] * grid->spacing[1] * grid->spacing[2], sum = 0;
  for (int32_t e = 0; e < grid->element_count; e++)
    sum += grid->fraction ? grid->fraction[e] : 1;
  return cell * sum;
}

void bw_grid_box(const bw_grid *grid, double min[3], double max[3]) {
  int32_t first[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, last[3] = {-1, -1, -1};
  for (int32_t e = 0; e < grid->element_count; e++) {
    int32_t place[3];
    bwi_grid_place(grid->cells, grid->cell[e], place);
    for (int d = 0; d < 3; d++) {
      first[d] = place[d] < first[d] ? place[d] : first[d];
      last[d] = place[d] > last[d] ? place[d] : last[d];
    }
  }
  for (int d = 0; d < 3; d++) {
    min[d] = grid->origin[d] + grid->spacing[d] * first[d];
    max[d] = grid->origin[d] + grid->spacing[d] * ((double)last[d] + 1);
  }
}

double bw_grid_difference(const bw_grid *grid, const double *u, const double *v) {
  double min[3], max[3], sum = 0;
  for (int64_t n = 0; n < grid->node_count; n++) {
    double d[3] = {u[3 * n] - v[3 * n], u[3 * n + 1] - v[3 * n + 1], u[3 * n + 2] - v[3 * n + 2]};
    sum += bw_norm(d);
  }
  bw_grid_box(grid, min, max);
  double longest = fmax(max[0] - min[0], fmax(max[1] - min[1], max[2] - min[2]));
  return sum / grid->node_count / longest;
}
