/* Holes: loops of open edges, and the triangles over them.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * The rim of a hole runs against the sides of the facets along it. Walking the rim, a loop is cut
 * off as soon as the walk comes back to one of its points, so that loops that touch in a point come
 * out as separate ones. */
#include <math.h>
#include <string.h>

#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_repair.h"
#include "mesh/surface_topology.h"

typedef struct loops {
  int32_t count;
  int64_t *start; /* count + 1 */
  int32_t *of;
  int64_t used, edges; /* rim edges in loops, and in all */
} loops;

static void loops_free(loops *rim) {
  bw_free(rim->start);
  bw_free(rim->of);
}

static bw_status find_loops(bw_context *context, const bwi_topology *topology, loops *rim) {
  bw_status status = BW_OK;
  int64_t edges = 0;
  for (int64_t e = 0; e < topology->edges; e++)
    edges += topology->start[e + 1] - topology->start[e] == 1;
  rim->edges = edges;
  /* rim edges leaving each point, as linked lists */
  int32_t *head = BW_NEW(context, int32_t, topology->points);
  int32_t *next = BW_NEW(context, int32_t, edges), *to = BW_NEW(context, int32_t, edges);
  int32_t *path = BW_NEW(context, int32_t, edges + 1);
  int32_t *index = BW_NEW(context, int32_t, topology->points); /* on the path, or -1 */
  rim->start = BW_NEW(context, int64_t, edges + 1);
  rim->of = BW_NEW(context, int32_t, edges + 1);
  BW_TRY_MEMORY(head && next && to && path && index && rim->start && rim->of);
  memset(head, 0xff, (size_t)topology->points * sizeof *head);
  memset(index, 0xff, (size_t)topology->points * sizeof *index);
  int32_t list = 0;
  for (int64_t e = 0; e < topology->edges; e++) {
    if (topology->start[e + 1] - topology->start[e] != 1)
      continue;
    int64_t s = topology->side[topology->start[e]];
    int32_t from = bwi_side_to(topology, s);
    to[list] = bwi_side_from(topology, s);
    next[list] = head[from];
    head[from] = list++;
  }
  rim->start[0] = 0;
  for (int32_t seed = 0; seed < topology->points; seed++)
    while (head[seed] >= 0) {
      int64_t length = 0;
      int32_t at = seed;
      path[length] = at;
      index[at] = 0;
      length = 1;
      while (head[at] >= 0) {
        int32_t edge = head[at];
        head[at] = next[edge];
        at = to[edge];
        if (index[at] >= 0) { /* a loop: from that index to the end of the path */
          int64_t from = index[at], end = rim->start[rim->count];
          for (int64_t i = from; i < length; i++) {
            rim->of[end++] = path[i];
            if (i > from)
              index[path[i]] = -1;
          }
          length = from + 1;
          rim->start[++rim->count] = end;
        } else {
          index[at] = (int32_t)length;
          path[length++] = at;
        }
      }
      for (int64_t i = 0; i < length; i++)
        index[path[i]] = -1;
    }
  rim->used = rim->start[rim->count];
done:
  bw_free(head);
  bw_free(next);
  bw_free(to);
  bw_free(path);
  bw_free(index);
  return status;
}

/* The diagonal of a loop's box, and how far it strays from its mean plane. */
static void measure_loop(const double *point, const int32_t *of, int64_t count, double *size,
                         double *stray) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double middle[3] = {0}, normal[3] = {0};
  for (int64_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) {
      double x = point[3 * (int64_t)of[i] + k];
      low[k] = fmin(low[k], x);
      high[k] = fmax(high[k], x);
      middle[k] += x / (double)count;
    }
  for (int64_t i = 0; i < count; i++) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
      u[k] = point[3 * (int64_t)of[i] + k] - middle[k];
      v[k] = point[3 * (int64_t)of[(i + 1) % count] + k] - middle[k];
    }
    bw_cross(u, v, n);
    for (int k = 0; k < 3; k++)
      normal[k] += n[k];
  }
  double d[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]}, length = bw_norm(normal);
  *size = bw_norm(d);
  *stray = 0;
  for (int64_t i = 0; i < count; i++) {
    double u[3];
    for (int k = 0; k < 3; k++)
      u[k] = point[3 * (int64_t)of[i] + k] - middle[k];
    double off = length > 0 ? fabs(bw_dot(u, normal)) / length : *size;
    *stray = off > *stray ? off : *stray;
  }
}

bw_status bwi_fill_holes(bw_context *context, const bw_surface *surface, double size,
                         const bwi_child_limits *limits, bw_surface **out, int64_t *changed,
                         int64_t *left) {
  bw_status status = BW_OK;
  bw_surface *welded = NULL;
  bwi_topology *topology = NULL;
  loops rim = {0};
  unsigned char *bytes = NULL;
  size_t count = 0, triangles = 0, by_hand = 0;
  int32_t *triangle = NULL, kept = 0;
  *changed = *left = 0;
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bwi_topology_create(context, welded, &topology));
  BW_TRY(find_loops(context, topology, &rim));
  triangle = BW_NEW(context, int32_t, 3 * (size_t)rim.count + 3);
  BW_TRY_MEMORY(triangle);
  *left = rim.used < rim.edges; /* edges that are on no loop */
  int64_t end = 0, start = 0;
  for (int32_t i = 0; i < rim.count; i++) {
    int64_t length = rim.start[i + 1] - start;
    const int32_t *of = rim.of + start;
    start = rim.start[i + 1];
    if (length < 3)
      continue; /* two open sides on each other: a wrong turn, left for orientation */
    double wide, stray;
    measure_loop(topology->point, of, length, &wide, &stray);
    if (wide > size && stray > 0.02 * wide) {
      ++*left;
      continue;
    }
    ++*changed;
    if (length == 3) {
      memcpy(triangle + 3 * by_hand++, of, 3 * sizeof *of);
      continue;
    }
    memmove(rim.of + end, of, (size_t)length * sizeof *of);
    end += length;
    rim.start[++kept] = end;
  }
  if (kept > 0) {
    bwi_hole_job job = {topology->point, kept, rim.start, rim.of};
    BW_TRY(bwi_child_run(context, "filling holes", limits, bwi_cgal_fill, &job, &bytes, &count));
  }
  triangles = count / (3 * sizeof(int32_t));
  int32_t *more =
      (int32_t *)bw_resize(context, triangle, 3 * (by_hand + triangles) + 3, sizeof *triangle);
  BW_TRY_MEMORY(more);
  triangle = more;
  if (triangles)
    memcpy(triangle + 3 * by_hand, bytes, triangles * 3 * sizeof *triangle);
  /* The topology numbers points as they first appear, and so does welding: the same numbers. */
  BW_TRY(bwi_surface_select(context, welded, NULL, (int64_t)(by_hand + triangles), triangle, NULL,
                            out));
done:
  bw_release(welded);
  bwi_topology_destroy(topology);
  loops_free(&rim);
  bw_free(bytes);
  bw_free(triangle);
  return status;
}
