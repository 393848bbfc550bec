/* How far two surfaces are apart, and the log of what was done to a shape.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_tree.h"

void bw_shape_log_add(bw_shape_log *log, const char *name, int64_t count, double moved,
                      const char *format, ...) {
  if (!log)
    return;
  log->moved += moved;
  if (log->count >= BW_SHAPE_STEPS)
    return;
  bw_shape_step *step = &log->step[log->count++];
  snprintf(step->name, sizeof step->name, "%s", name);
  step->count = count;
  step->moved = moved;
  va_list list;
  va_start(list, format);
  vsnprintf(step->text, sizeof step->text, format, list);
  va_end(list);
}

typedef struct one_sided {
  const bw_surface *from;
  const bwi_tree *tree;
  double *far; /* per chunk: the largest squared distance */
} one_sided;

enum { GRAIN = 512 };

/* Corners, midpoints of sides and the centroid of each facet. Since only the largest distance
 * counts, the search for a sample ends as soon as something nearer than the largest so far is
 * found. */
static bw_status measure(void *data, int64_t begin, int64_t end, int worker) {
  one_sided *side = (one_sided *)data;
  (void)worker;
  static const double weights[7][3] = {{1, 0, 0},     {0, 1, 0},     {0, 0, 1}, {0.5, 0.5, 0},
                                       {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0, 0, 0}};
  double worst = 0, place[3];
  int32_t hint = -1;
  for (int64_t t = begin; t < end; t++) {
    const double *corner[3];
    for (int k = 0; k < 3; k++)
      corner[k] = side->from->point + 3 * (int64_t)side->from->triangle[3 * t + k];
    for (int s = 0; s < 7; s++) {
      double x[3];
      for (int k = 0; k < 3; k++)
        x[k] = s < 6 ? weights[s][0] * corner[0][k] + weights[s][1] * corner[1][k] +
                           weights[s][2] * corner[2][k]
                     : (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
      double far = bwi_tree_nearest(side->tree, x, hint, worst, place, &hint);
      worst = far > worst ? far : worst;
    }
  }
  side->far[begin / GRAIN] = worst;
  return BW_OK;
}

double bwi_above_rounding(const bw_surface *surface, double distance) {
  double largest = 0;
  for (int64_t i = 0; i < 3 * (int64_t)surface->point_count; i++)
    largest = fmax(largest, fabs(surface->point[i]));
  return distance < 1e-12 * largest ? 0 : distance;
}

bw_status bwi_one_sided_distance(bw_context *context, const bw_surface *from, const bw_surface *to,
                                 double *distance) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  int64_t chunks = from->triangle_count / GRAIN + 1;
  double worst = 0, *far = BW_NEW0(context, double, chunks);
  if (!far)
    return BW_MEMORY;
  BW_TRY(bwi_tree_create(context, to->point, to->triangle_count, to->triangle, NULL, &tree));
  one_sided side = {from, tree, far};
  BW_TRY(bw_parallel(context, from->triangle_count, GRAIN, measure, &side));
  for (int64_t i = 0; i < chunks; i++)
    worst = far[i] > worst ? far[i] : worst;
  *distance = bwi_above_rounding(from, sqrt(worst));
done:
  bwi_tree_destroy(tree);
  bw_free(far);
  return status;
}

bw_status bw_surface_distance(bw_context *context, const bw_surface *a, const bw_surface *b,
                              double *distance) {
  bw_status status = BW_OK;
  double there = 0, back = 0;
  if (!a->triangle_count || !b->triangle_count)
    return bw_fail(context, BW_EMPTY,
                   "the distance to a surface without facets (%d and %d facets) is not defined",
                   a->triangle_count, b->triangle_count);
  BW_TRY(bwi_one_sided_distance(context, a, b, &there));
  BW_TRY(bwi_one_sided_distance(context, b, a, &back));
  *distance = there > back ? there : back;
done:
  return status;
}
