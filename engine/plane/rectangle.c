/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A rectangle of squares cut in two. */
#include "plane/internal.h"

#include <math.h>
#include <stdio.h>

/* Nodes are first thought of on the grid of half squares (2 nx + 1) x (2 ny + 1): corners at even
 * places, mid-edge nodes at the others; at order 2 all of them are nodes. */
typedef struct grid {
  int32_t nx, ny;
  int order;
} grid;

static int32_t corner_number(const grid *g, int32_t i, int32_t j) {
  return j * (g->nx + 1) + i;
}

/* Number of the place (i, j) of half squares. */
static int32_t place_number(const grid *g, int32_t i, int32_t j) {
  if (i % 2 == 0 && j % 2 == 0)
    return corner_number(g, i / 2, j / 2);
  int32_t corners = (g->nx + 1) * (g->ny + 1);
  /* an even row has nx mid-edge nodes, an odd one 2 nx + 1 */
  int32_t before = (j / 2) * (3 * g->nx + 1) + (j % 2) * g->nx;
  return corners + before + (j % 2 ? i : i / 2);
}

static void add_triangle(const grid *g, const int32_t at[3][2], int32_t *element) {
  for (int k = 0; k < 3; k++) {
    element[k] = place_number(g, at[k][0], at[k][1]);
    if (g->order == 2)
      element[3 + k] =
          place_number(g, (at[k][0] + at[(k + 1) % 3][0]) / 2, (at[k][1] + at[(k + 1) % 3][1]) / 2);
  }
}

static bw_status rectangle_outline(bw_context *context, const double min[2], const double max[2],
                                   bw_outline **outline) {
  static const bw_name tag[4] = {{"bottom"}, {"right"}, {"top"}, {"left"}};
  double point[8] = {min[0], min[1], max[0], min[1], max[0], max[1], min[0], max[1]};
  bw_segment segment[4];
  for (int i = 0; i < 4; i++)
    segment[i] = (bw_segment){{i, -1, -1, (i + 1) % 4}, i};
  bw_loop loop = {.first = 0, .count = 4, .region = 0, .parent = -1, .name = {"body"}};
  return bw_outline_create(context, 4, point, 4, segment, 1, &loop, 4, tag, outline);
}

bw_status bw_plane_rectangle(bw_context *context, int order, const double min[2],
                             const double max[2], int32_t nx, int32_t ny, bw_diagonal diagonal,
                             bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_outline *outline = NULL;
  double *point = NULL, *parameter = NULL;
  int32_t *segment = NULL, *element = NULL;
  grid g = {nx, ny, order};
  if (order != 1 && order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a plane mesh has order 1 or 2", order);
  if (nx < 1 || ny < 1 || (double)nx * ny > 5e7)
    return bw_fail(context, BW_INVALID, "%d x %d cells: from 1 x 1 to 50 million in all expected",
                   nx, ny);
  if (!(max[0] > min[0]) || !(max[1] > min[1]) || !isfinite(max[0] - min[0]) ||
      !isfinite(max[1] - min[1]))
    return bw_fail(context, BW_INVALID,
                   "a rectangle from (%g, %g) to (%g, %g): the second must lie above and to the "
                   "right of the first",
                   min[0], min[1], max[0], max[1]);
  BW_TRY(rectangle_outline(context, min, max, &outline));
  int32_t step = order == 2 ? 1 : 2, width = order == 2 ? 6 : 3;
  int32_t nodes = order == 2 ? (2 * nx + 1) * (2 * ny + 1) : (nx + 1) * (ny + 1);
  point = BW_NEW(context, double, 2 * (size_t)nodes);
  parameter = BW_NEW0(context, double, nodes);
  segment = BW_NEW(context, int32_t, nodes);
  element = BW_NEW(context, int32_t, 2 * (size_t)nx * (size_t)ny * (size_t)width);
  BW_TRY_MEMORY(point && parameter && segment && element);
  for (int32_t j = 0; j <= 2 * ny; j += step)
    for (int32_t i = 0; i <= 2 * nx; i += step) {
      int32_t n = place_number(&g, i, j);
      double r = (double)i / (2 * nx), s = (double)j / (2 * ny);
      segment[n] = -1;
      if (j == 0 && i < 2 * nx) {
        segment[n] = 0;
        parameter[n] = r;
      } else if (i == 2 * nx && j < 2 * ny) {
        segment[n] = 1;
        parameter[n] = s;
      } else if (j == 2 * ny && i > 0) {
        segment[n] = 2;
        parameter[n] = 1 - r;
      } else if (i == 0) {
        segment[n] = 3;
        parameter[n] = 1 - s;
      }
      if (segment[n] >= 0) { /* the same bits as the outline gives */
        bw_outline_evaluate(outline, segment[n], parameter[n], point + 2 * (size_t)n, NULL, NULL);
      } else {
        point[2 * (size_t)n] = (1 - r) * min[0] + r * max[0];
        point[2 * (size_t)n + 1] = (1 - s) * min[1] + s * max[1];
      }
    }
  int32_t *e = element;
  for (int32_t j = 0; j < ny; j++)
    for (int32_t i = 0; i < nx; i++) {
      int32_t l = 2 * i, r = l + 2, b = 2 * j, t = b + 2;
      bool right =
          diagonal == BW_DIAGONAL_RIGHT || (diagonal == BW_DIAGONAL_UNION_JACK && (i + j) % 2 == 0);
      add_triangle(&g,
                   right ? (int32_t[3][2]){{l, b}, {r, b}, {r, t}}
                         : (int32_t[3][2]){{l, b}, {r, b}, {l, t}},
                   e);
      add_triangle(&g,
                   right ? (int32_t[3][2]){{l, b}, {r, t}, {l, t}}
                         : (int32_t[3][2]){{r, b}, {r, t}, {l, t}},
                   e + width);
      e += 2 * width;
    }
  BW_TRY(bw_plane_mesh_on(context, outline, order, nodes, point, segment, parameter, 2 * nx * ny,
                          element, NULL, mesh));
done:
  bw_release(outline);
  bw_free(point);
  bw_free(parameter);
  bw_free(segment);
  bw_free(element);
  return status;
}
