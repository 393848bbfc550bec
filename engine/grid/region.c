/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodes and cells chosen by geometry, and materials given by place.
 *
 * Every part of a region that is a shape has a distance, 0 inside; the largest one ranks what lies
 * outside, so that an empty choice can name what was nearest. */
#include "grid/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TOLERANCE 1e-6
enum { OFTEN = 1024 }; /* places between two looks at whether to stop: functions may be slow */

/* Points or cells of a lattice, seen alike: cells by their centres. */
typedef struct places {
  const bw_grid *grid;
  const bw_region *region;
  bool cells;
  double origin[3]; /* of the place (0, 0, 0) */
  int32_t counts[3];
  double within;
  double outermost;    /* BW_ON_SIDE: the coordinate */
  double normal[2][3]; /* of the planes, unit */
  uint8_t *at_boundary;
  double *inside; /* of the surface, by place */
} places;

static bool in(const bw_region *region, unsigned part) {
  return region->parts & part;
}

static bw_status check_normal(bw_context *context, const double normal[3], double unit[3]) {
  double size = bw_norm(normal);
  if (!(size > 0) || !isfinite(size))
    return bw_fail(context, BW_INVALID,
                   "the normal (%g, %g, %g) of a plane must be a finite vector that is not 0",
                   normal[0], normal[1], normal[2]);
  for (int d = 0; d < 3; d++)
    unit[d] = normal[d] / size;
  return BW_OK;
}

static bw_status check_region(bw_context *context, places *p) {
  bw_status status = BW_OK;
  const bw_region *r = p->region;
  for (int d = 0; d < 3 && in(r, BW_IN_BOX); d++)
    if (!(r->min[d] <= r->max[d]))
      return bw_fail(context, BW_INVALID,
                     "the box of the region runs from %g to %g m along %c: min must lie below max",
                     r->min[d], r->max[d], "xyz"[d]);
  if (in(r, BW_IN_BALL) && !(r->radius >= 0))
    return bw_fail(context, BW_INVALID, "a sphere of radius %g m: a positive radius expected",
                   r->radius);
  if (in(r, BW_ON_SIDE) && (r->side < 0 || r->side > 5))
    return bw_fail(context, BW_INVALID, "side %d: 0 to 5 expected", r->side);
  if (!(r->within >= 0))
    return bw_fail(context, BW_INVALID, "a region with a margin of %g m: at least 0 expected",
                   r->within);
  if (in(r, BW_ON_PLANE))
    BW_TRY(check_normal(context, r->plane_normal, p->normal[0]));
  if (in(r, BW_BEYOND))
    BW_TRY(check_normal(context, r->beyond_normal, p->normal[1]));
done:
  return status;
}

static bw_status mark_boundary(bw_context *context, places *p) {
  bw_grid_face *face;
  int64_t faces;
  bw_status status = bw_grid_boundary(context, p->grid, &face, &faces);
  if (status != BW_OK)
    return status;
  p->at_boundary =
      BW_NEW0(context, uint8_t, p->cells ? p->grid->element_count : p->grid->node_count);
  if (!p->at_boundary)
    status = BW_MEMORY;
  for (int64_t f = 0; f < faces && p->at_boundary; f++)
    if (p->cells)
      p->at_boundary[face[f].element] = 1;
    else
      for (int k = 0; k < 4; k++)
        p->at_boundary[face[f].node[k]] = 1;
  bw_free(face);
  return status;
}

/* Cells around the places of which at least half is inside. */
static bw_status fill_inside(bw_context *context, places *p) {
  double origin[3];
  p->inside = BW_NEW(context, double, bwi_grid_cells(p->counts));
  if (!p->inside)
    return BW_MEMORY;
  for (int d = 0; d < 3; d++)
    origin[d] = p->origin[d] - 0.5 * p->grid->spacing[d];
  return bw_grid_fractions(context, p->region->surface, origin, p->grid->spacing, p->counts,
                           p->inside);
}

static bw_status prepare(bw_context *context, places *p) {
  bw_status status = BW_OK;
  const bw_grid *grid = p->grid;
  double min = fmin(grid->spacing[0], fmin(grid->spacing[1], grid->spacing[2]));
  p->within = p->region->within > 0 ? p->region->within : TOLERANCE * min;
  for (int d = 0; d < 3; d++) {
    p->origin[d] = grid->origin[d] + (p->cells ? 0.5 * grid->spacing[d] : 0);
    p->counts[d] = grid->cells[d] + !p->cells;
  }
  BW_TRY(check_region(context, p));
  if (in(p->region, BW_ON_SIDE)) {
    double low[3], high[3];
    int side = p->region->side, d = side / 2;
    bw_grid_box(grid, low, high);
    p->outermost = side % 2 ? high[d] : low[d];
    if (p->cells)
      p->outermost += (side % 2 ? -0.5 : 0.5) * grid->spacing[d];
  }
  if (in(p->region, BW_ON_BOUNDARY))
    BW_TRY(mark_boundary(context, p));
  if (in(p->region, BW_IN_SURFACE))
    BW_TRY(fill_inside(context, p));
done:
  return status;
}

static void place_at(const places *p, int64_t place, double at[3]) {
  int32_t index[3];
  bwi_grid_place(p->counts, place, index);
  for (int d = 0; d < 3; d++)
    at[d] = p->origin[d] + p->grid->spacing[d] * index[d];
}

static double along(const double from[3], const double to[3], const double unit[3]) {
  return (to[0] - from[0]) * unit[0] + (to[1] - from[1]) * unit[1] + (to[2] - from[2]) * unit[2];
}

static double distance(const places *p, const double at[3]) {
  const bw_region *r = p->region;
  double max = 0;
  if (in(r, BW_IN_BOX)) {
    double out[3];
    for (int d = 0; d < 3; d++)
      out[d] = fmax(fmax(r->min[d] - at[d], at[d] - r->max[d]), 0);
    max = bw_norm(out);
  }
  if (in(r, BW_IN_BALL)) {
    double out[3] = {at[0] - r->centre[0], at[1] - r->centre[1], at[2] - r->centre[2]};
    max = fmax(max, bw_norm(out) - r->radius);
  }
  if (in(r, BW_ON_PLANE))
    max = fmax(max, fabs(along(r->plane_point, at, p->normal[0])));
  if (in(r, BW_BEYOND))
    max = fmax(max, -along(r->beyond_point, at, p->normal[1]));
  if (in(r, BW_ON_SIDE))
    max = fmax(max, fabs(at[r->side / 2] - p->outermost));
  return max;
}

/* `place` of the lattice, `item` the node or element there (-1: void). */
static bool holds(const places *p, int64_t place, int32_t item, const double at[3]) {
  const bw_region *r = p->region;
  if (in(r, BW_ON_BOUNDARY) && (item < 0 || !p->at_boundary[item]))
    return false;
  if (in(r, BW_IN_SURFACE) && !(p->inside[place] >= 0.5))
    return false;
  if (in(r, BW_WHERE)) {
    double value = r->where(r->where_data, at);
    return value < 0 || value > 0;
  }
  return true;
}

static bw_status nothing(bw_context *context, const places *p, double near, const double at[3]) {
  double low[3], high[3];
  const char *what = p->cells ? "cell" : "node";
  char text[160] = "";
  bw_grid_box(p->grid, low, high);
  if (near > p->within && isfinite(near))
    snprintf(text, sizeof text, "; the nearest %s is at (%.6g, %.6g, %.6g) m, %.3g m away", what,
             at[0], at[1], at[2], near);
  bw_status status = bw_fail(
      context, BW_EMPTY,
      "no %s lies in the region%s; the elements are between (%.6g, %.6g, %.6g) and (%.6g, %.6g, "
      "%.6g) m, cells %.3g x %.3g x %.3g m",
      what, text, low[0], low[1], low[2], high[0], high[1], high[2], p->grid->spacing[0],
      p->grid->spacing[1], p->grid->spacing[2]);
  bw_detail_number(context, "distance", near);
  return status;
}

static bw_status choose(bw_context *context, const bw_grid *grid, const bw_region *region,
                        bool cells, bool voids, int32_t **out, int32_t *count) {
  bw_status status = BW_OK;
  places p = {.grid = grid, .region = region, .cells = cells};
  int32_t *chosen = NULL, found = 0;
  double near = INFINITY, nearest[3] = {0};
  BW_TRY(prepare(context, &p));
  int64_t all = voids   ? bwi_grid_cells(grid->cells)
                : cells ? grid->element_count
                        : grid->node_count;
  chosen = BW_NEW(context, int32_t, all);
  BW_TRY_MEMORY(chosen);
  for (int64_t i = 0; i < all; i++) {
    int64_t place = voids ? i : cells ? grid->cell[i] : grid->node[i];
    int32_t item = voids ? grid->at[i] : (int32_t)i;
    double at[3];
    if (i % OFTEN == 0)
      BW_TRY(bw_check_cancel(context));
    place_at(&p, place, at);
    double away = distance(&p, at);
    if (away < near) {
      near = away;
      memcpy(nearest, at, sizeof at);
    }
    if (away <= p.within && holds(&p, place, item, at))
      chosen[found++] = cells ? (int32_t)place : item;
  }
  if (found == 0) {
    status = nothing(context, &p, near, nearest);
    goto done;
  }
  *out = chosen;
  *count = found;
  chosen = NULL;
done:
  bw_free(chosen);
  bw_free(p.at_boundary);
  bw_free(p.inside);
  return status;
}

bw_status bw_grid_nodes(bw_context *context, const bw_grid *grid, const bw_region *region,
                        int32_t **node, int32_t *count) {
  return choose(context, grid, region, false, false, node, count);
}

bw_status bw_grid_cells(bw_context *context, const bw_grid *grid, const bw_region *region,
                        bool voids, int32_t **cell, int32_t *count) {
  return choose(context, grid, region, true, voids, cell, count);
}

bw_status bw_cell_materials(bw_context *context, const double origin[3], const double spacing[3],
                            const int32_t cells[3], int64_t count, const int32_t *cell,
                            double (*value_at)(void *data, const double at[3]), void *data,
                            int32_t *material) {
  for (int64_t i = 0; i < count; i++) {
    int32_t place[3];
    double at[3];
    if (i % OFTEN == 0 && bw_check_cancel(context) != BW_OK)
      return BW_CANCELLED;
    bwi_grid_place(cells, cell ? cell[i] : i, place);
    for (int d = 0; d < 3; d++)
      at[d] = origin[d] + spacing[d] * (place[d] + 0.5);
    double value = value_at(data, at);
    if (!(value >= 0 && value <= INT32_MAX && value == floor(value)))
      return bw_fail(context, BW_INVALID,
                     "the material at (%g, %g, %g) m is %g: whole numbers are expected, 0 for void",
                     at[0], at[1], at[2], value);
    material[i] = (int32_t)value;
  }
  return BW_OK;
}
