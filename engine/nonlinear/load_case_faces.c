/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Loads on the free faces of a grid, chosen by their nodes. */
#include <math.h>

#include "grid/internal.h"
#include "nonlinear/load_case.h"

/* Which nodes are given, one byte each. */
static uint8_t *mark(bw_context *context, const bw_grid *grid, int64_t count, const int32_t *node) {
  uint8_t *given = BW_NEW0(context, uint8_t, grid->node_count);
  for (int64_t k = 0; given && k < count; k++)
    given[node[k]] = 1;
  return given;
}

/* The nodes of a free face, counter-clockwise from outside, if all four are given. */
static bool given_face(const bw_grid *grid, const uint8_t *given, int32_t element, int side,
                       int32_t node[4]) {
  for (int k = 0; k < 4; k++) {
    node[k] = grid->element[8 * (int64_t)element + bwi_grid_side_corner[side][k]];
    if (!given[node[k]])
      return false;
  }
  return bwi_grid_side_is_free(grid, element, side);
}

bw_status bw_load_case_force(bw_context *context, bw_load_case *it, int64_t count,
                             const int32_t *node, const double total[3]) {
  bw_status status = BW_OK;
  const bw_grid *grid = it->grid;
  double *weight = NULL, sum = 0;
  uint8_t *given = NULL;
  int32_t corner[4];
  BW_TRY(bwi_load_case_check_nodes(context, grid, count, node, "a force"));
  BW_TRY(bwi_load_case_check_finite(context, "the force", total));
  weight = BW_NEW0(context, double, grid->node_count);
  given = mark(context, grid, count, node);
  BW_TRY_MEMORY(weight && given);
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int side = 0; side < 6; side++) {
      if (!given_face(grid, given, e, side, corner))
        continue;
      double area = grid->spacing[(side / 2 + 1) % 3] * grid->spacing[(side / 2 + 2) % 3];
      for (int c = 0; c < 4; c++)
        weight[corner[c]] += area / 4;
      sum += area;
    }
  if (sum == 0)
    for (int32_t n = 0; n < grid->node_count; n++) {
      weight[n] = given[n];
      sum += given[n];
    }
  for (int32_t n = 0; n < grid->node_count; n++)
    for (int c = 0; c < 3; c++)
      it->force[3 * (int64_t)n + c] += weight[n] / sum * total[c];
  it->object.revision++;
done:
  bw_free(weight);
  bw_free(given);
  return status;
}

/* Pressures of faces become those of triangles: each face is cut along both of its diagonals, with
 * half of the pressure on either pair. A face's forces are p times the slope of the volume below
 * it, and the volume below a bilinear face is the mean of those below its two pairs of triangles:
 * so the forces are exactly those of the bilinear face, and a quarter of p A at every node of a
 * flat one. One pair alone gives a third and a sixth. */
typedef struct faces {
  int32_t *number; /* node_count: a node's point, or -1 */
  double *at;      /* point_count x 3 */
  int32_t *triangle;
  double *pressure;
  int64_t face_count, point_count;
} faces;

static bw_status reserve(bw_context *context, const bw_grid *grid, const uint8_t *given, faces *f) {
  int32_t corner[4];
  f->number = BW_NEW(context, int32_t, grid->node_count);
  if (!f->number)
    return BW_MEMORY;
  for (int32_t n = 0; n < grid->node_count; n++)
    f->number[n] = -1;
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int side = 0; side < 6; side++) {
      if (!given_face(grid, given, e, side, corner))
        continue;
      f->face_count++;
      for (int k = 0; k < 4; k++)
        f->number[corner[k]] = 0;
    }
  if (f->face_count == 0)
    return bw_fail(context, BW_EMPTY,
                   "a pressure without faces: no free face of the grid has all its four nodes in "
                   "the selection");
  for (int32_t n = 0; n < grid->node_count; n++)
    f->number[n] = f->number[n] < 0 ? -1 : (int32_t)f->point_count++;
  f->at = BW_NEW(context, double, 3 * f->point_count);
  f->triangle = BW_NEW(context, int32_t, 12 * f->face_count);
  f->pressure = BW_NEW(context, double, 4 * f->face_count);
  if (!f->at || !f->triangle || !f->pressure)
    return BW_MEMORY;
  for (int32_t n = 0; n < grid->node_count; n++)
    if (f->number[n] >= 0)
      bw_grid_position(grid, n, f->at + 3 * (int64_t)f->number[n]);
  return BW_OK;
}

bw_status bw_load_case_surface_pressure(bw_context *context, bw_load_case *it, int64_t count,
                                        const int32_t *node,
                                        double (*pressure)(void *, const double[3]), void *data,
                                        double factor, bool follower) {
  static const int both[12] = {0, 1, 2, 0, 2, 3, 1, 2, 3, 1, 3, 0};
  bw_status status = BW_OK;
  const bw_grid *grid = it->grid;
  faces f = {0};
  uint8_t *given = NULL;
  bw_embedding *embedding = NULL;
  int64_t at = 0;
  BW_TRY(bwi_load_case_check_nodes(context, grid, count, node, "a pressure"));
  given = mark(context, grid, count, node);
  BW_TRY_MEMORY(given);
  BW_TRY(reserve(context, grid, given, &f));
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int side = 0; side < 6; side++) {
      int32_t corner[4];
      double middle[3];
      if (!given_face(grid, given, e, side, corner))
        continue;
      for (int d = 0; d < 3; d++)
        middle[d] = 0.5 * (f.at[3 * (int64_t)f.number[corner[0]] + d] +
                           f.at[3 * (int64_t)f.number[corner[2]] + d]);
      double value = factor * (pressure ? pressure(data, middle) : 1);
      if (!isfinite(value))
        BW_TRY(bw_fail(context, BW_INVALID,
                       "the pressure at (%g, %g, %g) m is %g; it must be finite", middle[0],
                       middle[1], middle[2], value));
      for (int k = 0; k < 12; k++)
        f.triangle[12 * at + k] = f.number[corner[both[k]]];
      for (int k = 0; k < 4; k++)
        f.pressure[4 * at + k] = 0.5 * value;
      at++;
    }
  BW_TRY(bw_embedding_create(context, grid, f.point_count, f.at, 1, &embedding));
  BW_TRY(bw_load_case_pressure(context, it, embedding, 4 * f.face_count, f.triangle, f.pressure,
                               follower));
done:
  bw_release(embedding);
  bw_free(given);
  bw_free(f.number);
  bw_free(f.at);
  bw_free(f.triangle);
  bw_free(f.pressure);
  return status;
}
