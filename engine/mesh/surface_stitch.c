/* Closing cracks, and pulling apart what merely touches.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_repair.h"
#include "mesh/surface_topology.h"

static bool is_open(const bwi_topology *topology, int64_t side) {
  int64_t e = topology->edge_of[side];
  return e >= 0 && topology->start[e + 1] - topology->start[e] == 1;
}

static void mark_open(const bwi_topology *topology, uint8_t *open) {
  for (int64_t s = 0; s < 3 * (int64_t)topology->facets; s++)
    if (is_open(topology, s))
      open[bwi_side_from(topology, s)] = open[bwi_side_to(topology, s)] = 1;
}

/* Merge points of open edges. The surface is welded: its points are those of the topology. */
static bw_status merge_open(bw_context *context, const bw_surface *surface, double tolerance,
                            bw_surface **out, int64_t *merged) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bw_surface *loose = NULL;
  uint8_t *open = BW_NEW0(context, uint8_t, surface->point_count);
  int32_t *to = BW_NEW(context, int32_t, surface->point_count), count = 0;
  int32_t *stands_for = BW_NEW(context, int32_t, surface->point_count);
  BW_TRY_MEMORY(open && to && stands_for);
  BW_TRY(bwi_topology_create(context, surface, &topology));
  mark_open(topology, open);
  BW_TRY(bwi_weld_map(context, surface->point_count, surface->point, open, tolerance, to, &count));
  *merged = 0;
  memset(stands_for, 0xff, (size_t)surface->point_count * sizeof *stands_for);
  for (int32_t i = 0; i < surface->point_count; i++)
    if (to[i] >= 0) {
      if (stands_for[to[i]] < 0)
        stands_for[to[i]] = i;
      else
        ++*merged;
    }
  BW_TRY(bw_surface_copy(context, surface->point_count, surface->point, surface->triangle_count,
                         surface->triangle, surface->group, &loose));
  bwi_keep_names(surface, loose);
  for (int64_t i = 0; i < 3 * (int64_t)loose->triangle_count; i++)
    if (to[loose->triangle[i]] >= 0)
      loose->triangle[i] = stands_for[to[loose->triangle[i]]];
  int64_t dropped;
  BW_TRY(bwi_drop_repeated(context, loose, out, &dropped));
done:
  bw_release(loose);
  bwi_topology_destroy(topology);
  bw_free(open);
  bw_free(to);
  bw_free(stands_for);
  return status;
}

typedef struct on_edge {
  double along; /* from 0 to 1 */
  int32_t point;
} on_edge;

typedef struct split_search {
  const bw_surface *surface;
  const int32_t *spot; /* degenerate triangles: the open points */
  int32_t a, b, c;
  double tolerance;
  on_edge found[64];
  int count;
} split_search;

static bool find_on_edge(void *data, int32_t item) {
  split_search *search = (split_search *)data;
  int32_t p = search->spot[3 * (int64_t)item];
  if (p == search->a || p == search->b || p == search->c)
    return true;
  const double *a = search->surface->point + 3 * (int64_t)search->a,
               *b = search->surface->point + 3 * (int64_t)search->b,
               *x = search->surface->point + 3 * (int64_t)p;
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
         r[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
  double length = bw_norm(d), along = bw_dot(r, d) / (length * length);
  double off[3] = {r[0] - along * d[0], r[1] - along * d[1], r[2] - along * d[2]};
  if (bw_norm(off) > search->tolerance || along * length <= search->tolerance ||
      (1 - along) * length <= search->tolerance)
    return true;
  int i = search->count++;
  while (i > 0 && search->found[i - 1].along > along) {
    search->found[i] = search->found[i - 1];
    i--;
  }
  search->found[i] = (on_edge){along, p};
  return search->count < 64;
}

/* Split each facet along one open side at the open points that lie on it. */
static bw_status split_open(bw_context *context, const bw_surface *surface, double tolerance,
                            bw_surface **out, int64_t *splits) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bwi_tree *tree = NULL;
  size_t extra = 0, capacity = 0, from_capacity = 0;
  int32_t *triangle = NULL, *from = NULL;
  int32_t spots = 0;
  uint8_t *open = BW_NEW0(context, uint8_t, surface->point_count);
  uint8_t *keep = BW_NEW(context, uint8_t, surface->triangle_count);
  int32_t *spot = BW_NEW(context, int32_t, 3 * (size_t)surface->point_count);
  BW_TRY_MEMORY(open && keep && spot);
  BW_TRY(bwi_topology_create(context, surface, &topology));
  mark_open(topology, open);
  for (int32_t i = 0; i < surface->point_count; i++)
    if (open[i]) {
      spot[3 * (int64_t)spots] = spot[3 * (int64_t)spots + 1] = spot[3 * (int64_t)spots + 2] = i;
      spots++;
    }
  BW_TRY(bwi_tree_create(context, surface->point, spots, spot, NULL, &tree));
  memset(keep, 1, (size_t)surface->triangle_count);
  *splits = 0;
  for (int64_t t = 0; t < surface->triangle_count; t++)
    for (int k = 0; k < 3 && keep[t]; k++) {
      if (!is_open(topology, 3 * t + k))
        continue;
      const int32_t *corner = surface->triangle + 3 * t;
      split_search search = {
          surface,   spot,     corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3],
          tolerance, {{0, 0}}, 0};
      double low[3], high[3];
      for (int i = 0; i < 3; i++) {
        double x = surface->point[3 * (int64_t)search.a + i],
               y = surface->point[3 * (int64_t)search.b + i];
        low[i] = fmin(x, y) - tolerance;
        high[i] = fmax(x, y) + tolerance;
      }
      bwi_tree_in_box(tree, low, high, find_on_edge, &search);
      if (search.count == 0)
        continue;
      keep[t] = 0;
      size_t pieces = (size_t)search.count + 1;
      BW_TRY_MEMORY(
          bw_grow(context, (void **)&triangle, &capacity, extra, pieces, 3 * sizeof *triangle) &&
          bw_grow(context, (void **)&from, &from_capacity, extra, pieces, sizeof *from));
      int32_t last = search.a;
      for (size_t i = 0; i < pieces; i++) {
        int32_t next = i + 1 < pieces ? search.found[i].point : search.b;
        triangle[3 * extra] = last;
        triangle[3 * extra + 1] = next;
        triangle[3 * extra + 2] = search.c;
        from[extra++] = (int32_t)t;
        last = next;
      }
      *splits += search.count;
    }
  if (*splits == 0)
    *out = (bw_surface *)bw_retain(surface);
  else
    BW_TRY(bwi_surface_select(context, surface, keep, (int64_t)extra, triangle, from, out));
done:
  bwi_topology_destroy(topology);
  bwi_tree_destroy(tree);
  bw_free(open);
  bw_free(keep);
  bw_free(spot);
  bw_free(triangle);
  bw_free(from);
  return status;
}

bw_status bwi_stitch(bw_context *context, const bw_surface *surface, double tolerance,
                     bw_surface **out, int64_t *changed) {
  bw_status status = BW_OK;
  bw_surface *now = NULL, *next = NULL;
  *changed = 0;
  BW_TRY(bw_surface_weld(context, surface, 0, &now));
  for (int pass = 0; pass < 10; pass++) {
    int64_t merged = 0, splits = 0;
    BW_TRY(merge_open(context, now, tolerance, &next, &merged));
    bw_release(now);
    now = NULL;
    BW_TRY(bw_surface_weld(context, next, 0, &now));
    bw_release(next);
    next = NULL;
    BW_TRY(split_open(context, now, tolerance, &next, &splits));
    bw_release(now);
    now = NULL;
    BW_TRY(bw_surface_weld(context, next, 0, &now));
    bw_release(next);
    next = NULL;
    *changed += merged + splits;
    if (merged + splits == 0)
      break;
  }
  *out = now;
  now = NULL;
done:
  bw_release(now);
  bw_release(next);
  return status;
}

/* ---- apart --------------------------------------------------------------------------------- */

bw_status bwi_separate(bw_context *context, const bw_surface *surface, double gap, bw_surface **out,
                       int64_t *changed) {
  bw_status status = BW_OK;
  bw_surface *welded = NULL;
  bwi_topology *topology = NULL;
  int32_t *parent = NULL, *first = NULL, *copy = NULL;
  uint8_t *apart = NULL;
  double *normal = NULL, *point = NULL;
  int32_t *triangle = NULL;
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bwi_topology_create(context, welded, &topology));
  int64_t sides = 3 * (int64_t)welded->triangle_count;
  if (sides > INT32_MAX / 2)
    BW_TRY(bw_fail(context, BW_LIMIT, "a surface of %d facets is too large to be repaired",
                   welded->triangle_count));
  parent = BW_NEW(context, int32_t, sides);
  copy = BW_NEW(context, int32_t, sides);
  first = BW_NEW(context, int32_t, welded->point_count);
  apart = BW_NEW0(context, uint8_t, welded->point_count);
  normal = BW_NEW0(context, double, 3 * (size_t)sides);
  point = BW_NEW(context, double, 3 * ((size_t)welded->point_count + (size_t)sides));
  triangle = BW_NEW(context, int32_t, sides);
  BW_TRY_MEMORY(parent && copy && first && apart && normal && point && triangle);
  /* fans: corners joined across edges of two facets */
  for (int64_t s = 0; s < sides; s++)
    parent[s] = (int32_t)s;
  for (int64_t e = 0; e < topology->edges; e++) {
    if (topology->start[e + 1] - topology->start[e] != 2)
      continue;
    int64_t s = topology->side[topology->start[e]], t = topology->side[topology->start[e] + 1];
    int64_t s_next = s % 3 == 2 ? s - 2 : s + 1, t_next = t % 3 == 2 ? t - 2 : t + 1;
    bool along = bwi_side_from(topology, s) == bwi_side_from(topology, t);
    bwi_set_join(parent, (int32_t)s, (int32_t)(along ? t : t_next));
    bwi_set_join(parent, (int32_t)s_next, (int32_t)(along ? t_next : t));
  }
  memset(first, 0xff, (size_t)welded->point_count * sizeof *first);
  for (int64_t s = 0; s < sides; s++) {
    int32_t root = bwi_set_root(parent, (int32_t)s), p = welded->triangle[s];
    double n[3];
    bwi_facet_normal(welded->point, welded->triangle + s / 3 * 3, n);
    for (int k = 0; k < 3; k++)
      normal[3 * (int64_t)root + k] += n[k];
    if (first[p] < 0)
      first[p] = root;
    else if (first[p] != root)
      apart[p] = 1;
  }
  int32_t points = welded->point_count;
  *changed = 0;
  memcpy(point, welded->point, 3 * (size_t)points * sizeof *point);
  memset(copy, 0xff, (size_t)sides * sizeof *copy);
  for (int64_t s = 0; s < sides; s++) {
    int32_t root = bwi_set_root(parent, (int32_t)s), p = welded->triangle[s];
    triangle[s] = p;
    if (!apart[p])
      continue;
    if (copy[root] < 0) {
      const double *n = normal + 3 * (int64_t)root;
      double length = bw_norm(n);
      for (int k = 0; k < 3; k++)
        point[3 * (int64_t)points + k] =
            welded->point[3 * (int64_t)p + k] - (length > 0 ? gap * n[k] / length : 0);
      copy[root] = points++;
    }
    triangle[s] = copy[root];
  }
  for (int32_t i = 0; i < welded->point_count; i++)
    *changed += apart[i];
  BW_TRY(bw_surface_copy(context, points, point, welded->triangle_count, triangle, welded->group,
                         out));
  bwi_keep_names(welded, *out);
done:
  bw_release(welded);
  bwi_topology_destroy(topology);
  bw_free(parent);
  bw_free(copy);
  bw_free(first);
  bw_free(apart);
  bw_free(normal);
  bw_free(point);
  bw_free(triangle);
  return status;
}
