/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The faces of elements that have no neighbour, and the surface that they make. */
#include "grid/internal.h"

const int bwi_grid_side_corner[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

bool bwi_grid_side_is_free(const bw_grid *grid, int32_t element, int side) {
  int32_t place[3];
  bwi_grid_place(grid->cells, grid->cell[element], place);
  int d = side / 2;
  int64_t step = d == 0 ? 1 : d == 1 ? grid->cells[0] : (int64_t)grid->cells[0] * grid->cells[1];
  if (side % 2 == 0)
    return place[d] == 0 || grid->at[grid->cell[element] - step] < 0;
  return place[d] + 1 == grid->cells[d] || grid->at[grid->cell[element] + step] < 0;
}

bw_status bw_grid_boundary(bw_context *context, const bw_grid *grid, bw_grid_face **out,
                           int64_t *count) {
  int64_t faces = 0;
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int side = 0; side < 6; side++)
      faces += bwi_grid_side_is_free(grid, e, side);
  bw_grid_face *face = BW_NEW(context, bw_grid_face, faces), *at = face;
  if (!face)
    return BW_MEMORY;
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int side = 0; side < 6; side++) {
      if (!bwi_grid_side_is_free(grid, e, side))
        continue;
      at->element = e;
      at->side = side;
      for (int k = 0; k < 4; k++)
        at->node[k] = grid->element[8 * (int64_t)e + bwi_grid_side_corner[side][k]];
      at++;
    }
  *out = face;
  *count = faces;
  return BW_OK;
}

bw_status bw_grid_surface(bw_context *context, const bw_grid *grid, bw_surface **surface,
                          int32_t **node) {
  bw_status status = BW_OK;
  bw_grid_face *face = NULL;
  int64_t faces = 0;
  int32_t *number = NULL, *of = NULL, *triangle = NULL, *group = NULL, points = 0;
  double *point = NULL;
  BW_TRY(bw_grid_boundary(context, grid, &face, &faces));
  number = BW_NEW0(context, int32_t, grid->node_count);
  triangle = BW_NEW(context, int32_t, 6 * faces);
  group = BW_NEW(context, int32_t, 2 * faces);
  BW_TRY_MEMORY(number && triangle && group);
  for (int64_t f = 0; f < faces; f++)
    for (int k = 0; k < 4; k++)
      number[face[f].node[k]] = 1;
  for (int32_t n = 0; n < grid->node_count; n++)
    points += number[n];
  of = BW_NEW(context, int32_t, points);
  point = BW_NEW(context, double, 3 * (int64_t)points);
  BW_TRY_MEMORY(of && point);
  points = 0;
  for (int32_t n = 0; n < grid->node_count; n++)
    if (number[n]) {
      bw_grid_position(grid, n, point + 3 * (int64_t)points);
      of[points] = n;
      number[n] = points++;
    }
  for (int64_t f = 0; f < faces; f++) {
    static const int half[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; k++)
      triangle[6 * f + k] = number[face[f].node[half[k]]];
    group[2 * f] = group[2 * f + 1] = grid->material[face[f].element];
  }
  BW_TRY(bw_surface_adopt(context, points, point, 2 * faces, triangle, group, surface));
  point = NULL;
  triangle = group = NULL;
  if (node) {
    *node = of;
    of = NULL;
  }
done:
  bw_free(face);
  bw_free(number);
  bw_free(of);
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  return status;
}
