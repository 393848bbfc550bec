/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodal lines: where a mode's deflection vanishes. Each six-node triangle is cut into four, in
 * which the deflection is taken as linear; pieces are given along the elements, not joined. */
#include <stdlib.h>
#include <string.h>

#include "responsive/plate.h"

/* The crossing of an edge of the small triangle. Zero counts as positive, so that a line through a
 * node is found once. */
static bool crossing(const double a[3], const double b[3], double at[2]) {
  if ((a[2] >= 0) == (b[2] >= 0))
    return false;
  double t = a[2] / (a[2] - b[2]);
  for (int c = 0; c < 2; c++)
    at[c] = a[c] + t * (b[c] - a[c]);
  return true;
}

bw_status bw_plate_nodal_lines(bw_context *context, const bw_plate *plate, int mode, int32_t *count,
                               double **lines) {
  static const int part[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  if (mode < 0 || mode >= plate->mode_count)
    return bw_fail(context, BW_INVALID, "mode %d: the plate has modes 1 to %d", mode + 1,
                   plate->mode_count);
  const bw_plane_topology *topology = plate->mesh->topology;
  const double *shape = plate->shape + mode * 3 * (int64_t)topology->nodes->node_count;
  double *list = NULL;
  size_t capacity = 0, found = 0;
  for (int64_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + 6 * e;
    double corner[6][3]; /* x, y, deflection */
    for (int a = 0; a < 6; a++) {
      corner[a][0] = plate->mesh->point[2 * (int64_t)node[a]];
      corner[a][1] = plate->mesh->point[2 * (int64_t)node[a] + 1];
      corner[a][2] = shape[3 * (int64_t)node[a]];
    }
    for (int t = 0; t < 4; t++) {
      double end[4];
      int ends = 0;
      for (int i = 0; i < 3 && ends < 2; i++)
        ends += crossing(corner[part[t][i]], corner[part[t][(i + 1) % 3]], end + 2 * ends);
      if (ends < 2)
        continue;
      if (!bw_grow(context, (void **)&list, &capacity, found, 4, sizeof *list)) {
        bw_free(list);
        return BW_MEMORY;
      }
      memcpy(list + found, end, sizeof end);
      found += 4;
    }
  }
  *count = (int32_t)(found / 4);
  *lines = list;
  return BW_OK;
}
