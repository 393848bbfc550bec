/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Meshes without an outline: their boundary edges become one. */
#include "plane/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct rim {
  int32_t edges;
  int32_t *next;   /* nodes: the next boundary node, -1 */
  int32_t *middle; /* nodes: the middle of the edge that begins here, -1 */
} rim;

/* Edges with one element, directed with the element on the left. */
static bw_status find_border(bw_context *context, int order, int32_t nodes, int32_t elements,
                             const int32_t *element, rim *border) {
  bw_status status = BW_OK;
  size_t width = order == 2 ? 6 : 3;
  int64_t halves = 3 * (int64_t)elements;
  int64_t *start = BW_NEW0(context, int64_t, (size_t)nodes + 2);
  int32_t *end = BW_NEW(context, int32_t, halves); /* of directed edges, by their beginning */
  border->next = BW_NEW(context, int32_t, nodes);
  border->middle = BW_NEW(context, int32_t, nodes);
  BW_TRY_MEMORY(start && end && border->next && border->middle);
  memset(border->next, -1, (size_t)nodes * sizeof *border->next);
  memset(border->middle, -1, (size_t)nodes * sizeof *border->middle);
  for (int64_t h = 0; h < halves; h++)
    start[element[(size_t)(h / 3) * width + (size_t)(h % 3)] + 2]++;
  for (int32_t i = 0; i < nodes; i++)
    start[i + 2] += start[i + 1];
  for (int64_t h = 0; h < halves; h++) {
    const int32_t *n = element + (size_t)(h / 3) * width;
    end[start[n[h % 3] + 1]++] = n[(h % 3 + 1) % 3];
  }
  for (int64_t h = 0; h < halves; h++) {
    const int32_t *n = element + (size_t)(h / 3) * width;
    int32_t a = n[h % 3], b = n[(h % 3 + 1) % 3];
    bool inner = false;
    int same = 0;
    for (int64_t i = start[a]; i < start[a + 1]; i++)
      same += end[i] == b;
    if (same > 1) {
      bw_fail(context, BW_GEOMETRY,
              "%d elements lie on the same side of the edge from node %d to node %d: elements may "
              "not overlap",
              same, a + 1, b + 1);
      bw_detail_number(context, "element", (double)(h / 3 + 1));
      status = BW_GEOMETRY;
      goto done;
    }
    for (int64_t i = start[b]; i < start[b + 1] && !inner; i++)
      inner = end[i] == a;
    if (inner)
      continue;
    if (border->next[a] >= 0) {
      bw_fail(context, BW_GEOMETRY,
              "the boundary passes through node %d more than once: loops of an outline may not "
              "touch",
              a + 1);
      bw_detail_number(context, "node", a + 1.0);
      status = BW_GEOMETRY;
      goto done;
    }
    border->next[a] = b;
    border->middle[a] = order == 2 ? n[3 + h % 3] : -1;
    border->edges++;
  }
done:
  bw_free(start);
  bw_free(end);
  return status;
}

/* Segment by segment along the border. A middle off the chord gives the parabola through it,
 * written as a cubic. */
static bw_status border_outline(bw_context *context, int32_t nodes, const double *point,
                                const rim *border, int32_t *segment, double *parameter,
                                bw_outline **outline) {
  bw_status status = BW_OK;
  int32_t edges = border->edges, points = 0, segments = 0, loops = 0;
  double *place = BW_NEW(context, double, 6 * (size_t)edges);
  bw_segment *list = BW_NEW0(context, bw_segment, edges);
  bw_loop *loop = BW_NEW0(context, bw_loop, edges);
  bw_name tag = {"boundary"};
  BW_TRY_MEMORY(place && list && loop);
  for (int32_t first = 0; first < nodes; first++) {
    if (border->next[first] < 0 || segment[first] >= 0)
      continue;
    loop[loops].first = segments;
    snprintf(loop[loops].name.text, BW_NAME, "loop %d", loops + 1);
    int32_t at = first, first_point = points;
    double twice = 0;
    do {
      int32_t to = border->next[at], middle = border->middle[at];
      const double *a = point + 2 * (size_t)at, *b = point + 2 * (size_t)to;
      twice += a[0] * b[1] - a[1] * b[0];
      bw_segment *s = &list[segments];
      *s = (bw_segment){{points, -1, -1, points + 1}, 0};
      memcpy(place + 2 * (size_t)points++, a, 2 * sizeof *a);
      segment[at] = segments;
      parameter[at] = 0;
      if (middle >= 0) {
        const double *m = point + 2 * (size_t)middle;
        double off = hypot(m[0] - (a[0] + b[0]) / 2, m[1] - (a[1] + b[1]) / 2);
        if (off > 1e-10 * hypot(b[0] - a[0], b[1] - a[1])) {
          for (int c = 0; c < 2; c++)
            for (int k = 0; k < 2; k++) {
              double apex = 2 * m[k] - (a[k] + b[k]) / 2, end = c ? b[k] : a[k];
              place[2 * (points + c) + k] = end + 2 * (apex - end) / 3;
            }
          s->point[1] = points++;
          s->point[2] = points++;
          s->point[3] = points;
        }
        segment[middle] = segments;
        parameter[middle] = 0.5;
      }
      segments++;
      at = to;
      if (at != first && (border->next[at] < 0 || segment[at] >= 0)) {
        bw_fail(context, BW_GEOMETRY,
                "the boundary of the mesh is not closed at node %d: elements overlap there",
                at + 1);
        bw_detail_number(context, "node", at + 1.0);
        status = BW_GEOMETRY;
        goto done;
      }
    } while (at != first);
    list[segments - 1].point[3] = first_point;
    loop[loops].count = segments - loop[loops].first;
    loop[loops].region = twice > 0 ? 0 : -1;
    loops++;
  }
  BW_TRY(bw_outline_create(context, points, place, segments, list, loops, loop, 1, &tag, outline));
  for (int32_t s = 0; s < segments; s++) /* the order is that of the loops given */
    if (memcmp((*outline)->segment[s].point, list[s].point, sizeof list[s].point))
      BW_TRY(bw_fail(context, BW_INTERNAL, "segment %d of a mesh's boundary was reversed", s + 1));
done:
  bw_free(place);
  bw_free(list);
  bw_free(loop);
  return status;
}

bw_status bw_plane_mesh_copy(bw_context *context, int order, int32_t nodes, const double *point,
                             int32_t elements, const int32_t *element, const int32_t *region,
                             bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  int32_t *segment = NULL;
  double *parameter = NULL;
  rim border = {0, NULL, NULL};
  bw_outline *outline = NULL;
  BW_TRY(bwi_plane_check_arrays(context, order, nodes, point, elements, element));
  segment = BW_NEW(context, int32_t, nodes);
  parameter = BW_NEW0(context, double, nodes);
  BW_TRY_MEMORY(segment && parameter);
  memset(segment, -1, (size_t)nodes * sizeof *segment);
  int width = order == 2 ? 6 : 3;
  for (int32_t e = 0; e < elements; e++) {
    const int32_t *n = element + (size_t)e * (size_t)width;
    if (bwi_plane_quality(point, n, order) > 0)
      continue;
    const double *a = point + 2 * (size_t)n[0];
    bw_fail(
        context, BW_GEOMETRY,
        "element %d (corners %d %d %d) near (%g, %g) m is flat or inverted: its corners must run "
        "counter-clockwise",
        e + 1, n[0] + 1, n[1] + 1, n[2] + 1, a[0], a[1]);
    bw_detail_number(context, "element", e + 1.0);
    status = BW_GEOMETRY;
    goto done;
  }
  BW_TRY(find_border(context, order, nodes, elements, element, &border));
  if (border.edges == 0)
    BW_TRY(bw_fail(context, BW_GEOMETRY, "the mesh has no boundary: elements overlap"));
  BW_TRY(border_outline(context, nodes, point, &border, segment, parameter, &outline));
  BW_TRY(bw_plane_mesh_on(context, outline, order, nodes, point, segment, parameter, elements,
                          element, region, mesh));
done:
  bw_release(outline);
  bw_free(border.next);
  bw_free(border.middle);
  bw_free(segment);
  bw_free(parameter);
  return status;
}
