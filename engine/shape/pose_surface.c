/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A pose of the surface that a mesh was made from: its own points and triangles, moved by the map
 * of the mesh's boundary. Triangles are split only where the map bends within them.
 *
 * Each boundary node of the mesh moves by an affine map, the blend of its bones' maps. At a point
 * of the surface the maps of the corners of the nearest boundary facet are interpolated, and the
 * result is applied to the point itself: where all maps agree, it moves by that map to the last
 * bit. */
#include "barwright/shape.h"
#include "mesh/locator.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  GRAIN = 256,
  MAX_SAMPLES = 63, /* between the ends of an edge */
  MAX_LATTICE = 24, /* parts of a side, for places inside of a triangle */
  MAX_ROUNDS = 40,
};
/* Edges shorter than this fraction of the boundary's mean edge are not split: the mesh knows no
 * finer shape, and a bend that is left is a kink of the map between its facets. */
static const double shortest_part = 0.5;

static double distance(const double *a, const double *b) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return bw_norm(d);
}

/* ---- the map --------------------------------------------------------------------------------- */

typedef struct transfer {
  const bw_surface *boundary; /* of the mesh at rest */
  bwi_tree *tree;
  double *map;    /* (12 per boundary point) */
  double spacing; /* mean edge of the boundary */
} transfer;

/* The blend of the maps of a node, which is the first one to the last bit where they agree. */
static void blend_maps(const bw_subdomains *d, const double *map, int32_t node, double *out) {
  int64_t first = d->influence_start[node], end = d->influence_start[node + 1];
  static const double rest[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const double *base = first == end ? rest : map + 12 * (size_t)d->influence_bone[first];
  memcpy(out, base, 12 * sizeof *out);
  for (int64_t k = first + 1; k < end; k++) {
    const double *other = map + 12 * (size_t)d->influence_bone[k];
    for (int j = 0; j < 12; j++)
      out[j] += d->influence_weight[k] * (other[j] - base[j]);
  }
}

/* Where x goes. Exactly x where the maps around it are the identity. */
static void move_point(const transfer *t, const double *x, int32_t *hint, double *y) {
  double place[3], weight[3], blended[12];
  const int32_t *corner;
  bwi_tree_nearest(t->tree, x, *hint, 0, place, hint);
  corner = t->boundary->triangle + 3 * (size_t)*hint;
  const double *a = t->boundary->point + 3 * (size_t)corner[0];
  const double *b = t->boundary->point + 3 * (size_t)corner[1];
  const double *c = t->boundary->point + 3 * (size_t)corner[2];
  bwi_triangle_weights(place, a, b, c, weight);
  const double *m[3];
  for (int k = 0; k < 3; k++)
    m[k] = t->map + 12 * (size_t)corner[k];
  for (int j = 0; j < 12; j++)
    blended[j] = m[0][j] + weight[1] * (m[1][j] - m[0][j]) + weight[2] * (m[2][j] - m[0][j]);
  for (int i = 0; i < 3; i++) {
    const double *row = blended + 4 * i;
    double d = row[3];
    for (int j = 0; j < 3; j++)
      d += (row[j] - (i == j)) * x[j];
    y[i] = x[i] + d;
  }
}

static bw_status make_transfer(bw_context *context, const bw_subdomains *d, const double *map,
                               transfer *t) {
  bw_surface *boundary = NULL;
  int32_t *node = NULL;
  double sum = 0;
  bw_status status = BW_OK;
  BW_TRY(bw_mesh_boundary(context, d->mesh, &boundary, &node));
  t->boundary = boundary;
  t->map = BW_NEW(context, double, 12 * (int64_t)boundary->point_count);
  BW_TRY_MEMORY(t->map);
  for (int32_t i = 0; i < boundary->point_count; i++)
    blend_maps(d, map, node[i], t->map + 12 * (size_t)i);
  for (int32_t f = 0; f < boundary->triangle_count; f++)
    for (int k = 0; k < 3; k++) {
      const int32_t *corner = boundary->triangle + 3 * (size_t)f;
      sum += distance(boundary->point + 3 * (size_t)corner[k],
                      boundary->point + 3 * (size_t)corner[(k + 1) % 3]);
    }
  t->spacing = sum / (3.0 * boundary->triangle_count);
  BW_TRY(bwi_tree_create(context, boundary->point, boundary->triangle_count, boundary->triangle,
                         NULL, &t->tree));
done:
  bw_free(node);
  return status;
}

/* ---- the surface being refined --------------------------------------------------------------- */

typedef struct edge {
  int32_t a, b;     /* a < b */
  int32_t triangle; /* a triangle and which of its sides, for sorting */
  int32_t side;
  int32_t midpoint; /* of the first in a run of equals; -1: is not split */
} edge;

typedef struct refined {
  bw_context *context;
  const transfer *map;
  double tolerance;
  int32_t points, triangles;
  double *rest, *moved; /* (3 per point) */
  int32_t *triangle, *group;
  uint8_t *fresh; /* (triangles) the sides and the inside were not looked at yet */
  edge *edges;    /* all sides, sorted */
  int32_t *first; /* (3 per triangle) of a side: the first of its run in edges */
  uint8_t *split; /* (3 per triangle, by place in edges) */
  uint8_t *inner; /* (triangles) the longest side is to be split */
} refined;

typedef struct move_job {
  refined *r;
  int32_t begin;
} move_job;

static bw_status move_points(void *data, int64_t begin, int64_t end, int worker) {
  move_job *job = (move_job *)data;
  int32_t hint = -1;
  (void)worker;
  for (int64_t i = job->begin + begin; i < job->begin + end; i++)
    move_point(job->r->map, job->r->rest + 3 * i, &hint, job->r->moved + 3 * i);
  return BW_OK;
}

static bw_status move_from(refined *r, int32_t begin) {
  move_job job = {r, begin};
  return bw_parallel(r->context, r->points - begin, GRAIN, move_points, &job);
}

/* How far the map of a place on a triangle is from the interpolated one of its corners. */
static double bend(const refined *r, const int32_t *corner, int corners, const double *weight,
                   int32_t *hint) {
  double x[3] = {0, 0, 0}, linear[3] = {0, 0, 0}, y[3];
  for (int k = 0; k < corners; k++)
    for (int j = 0; j < 3; j++) {
      x[j] += weight[k] * r->rest[3 * (size_t)corner[k] + (size_t)j];
      linear[j] += weight[k] * r->moved[3 * (size_t)corner[k] + (size_t)j];
    }
  move_point(r->map, x, hint, y);
  return distance(y, linear);
}

static double length_of(const refined *r, int32_t a, int32_t b) {
  return distance(r->rest + 3 * (size_t)a, r->rest + 3 * (size_t)b);
}

static bool edge_bends(const refined *r, const edge *e, int32_t *hint) {
  double parts = length_of(r, e->a, e->b) / r->map->spacing;
  if (parts < shortest_part)
    return false;
  int samples = parts > MAX_SAMPLES ? MAX_SAMPLES : parts > 1 ? (int)parts : 1;
  int32_t corner[2] = {e->a, e->b};
  for (int s = 1; s <= samples; s++) {
    double weight[2] = {1 - (double)s / (samples + 1), (double)s / (samples + 1)};
    if (bend(r, corner, 2, weight, hint) > r->tolerance)
      return true;
  }
  return false;
}

/* Only triangles larger than the facets of the mesh can bend inside and not on their sides. */
static bool inside_bends(const refined *r, const int32_t *corner, int32_t *hint) {
  double longest = 0;
  for (int k = 0; k < 3; k++)
    longest = fmax(longest, length_of(r, corner[k], corner[(k + 1) % 3]));
  double parts = longest / r->map->spacing;
  if (parts < 2)
    return false;
  int sides = parts > MAX_LATTICE ? MAX_LATTICE : (int)parts + 1;
  for (int i = 1; i < sides; i++)
    for (int j = 1; i + j < sides; j++) {
      double weight[3] = {(double)i / sides, (double)j / sides, (double)(sides - i - j) / sides};
      if (bend(r, corner, 3, weight, hint) > r->tolerance)
        return true;
    }
  return false;
}

static bool same_edge(const edge *x, const edge *y) {
  return x->a == y->a && x->b == y->b;
}

static bw_status look_at_edges(void *data, int64_t begin, int64_t end, int worker) {
  refined *r = (refined *)data;
  int32_t hint = -1;
  int64_t all = 3 * (int64_t)r->triangles;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    const edge *e = r->edges + i;
    bool fresh = false;
    r->split[i] = 0;
    if (i > 0 && same_edge(e - 1, e))
      continue;
    for (int64_t k = i; k < all && same_edge(r->edges + k, e); k++)
      fresh |= r->fresh[r->edges[k].triangle];
    r->split[i] = fresh && edge_bends(r, e, &hint);
  }
  return BW_OK;
}

static bw_status look_inside(void *data, int64_t begin, int64_t end, int worker) {
  refined *r = (refined *)data;
  int32_t hint = -1;
  (void)worker;
  for (int64_t t = begin; t < end; t++)
    r->inner[t] = r->fresh[t] && inside_bends(r, r->triangle + 3 * t, &hint);
  return BW_OK;
}

static int compare_edges(const void *first, const void *second) {
  const edge *x = (const edge *)first, *y = (const edge *)second;
  if (x->a != y->a)
    return x->a < y->a ? -1 : 1;
  if (x->b != y->b)
    return x->b < y->b ? -1 : 1;
  if (x->triangle != y->triangle)
    return x->triangle < y->triangle ? -1 : 1;
  return (x->side > y->side) - (x->side < y->side);
}

/* ---- a round --------------------------------------------------------------------------------- */

static void forget_round(refined *r) {
  bw_free(r->edges);
  bw_free(r->first);
  bw_free(r->split);
  bw_free(r->inner);
  r->edges = NULL;
  r->first = NULL;
  r->split = r->inner = NULL;
}

/* Marks the sides to split, and numbers their midpoints: *added of them. */
static bw_status mark(refined *r, int32_t *added) {
  bw_status status = BW_OK;
  int64_t all = 3 * (int64_t)r->triangles;
  *added = 0;
  r->edges = BW_NEW(r->context, edge, all);
  r->first = BW_NEW(r->context, int32_t, all);
  r->split = BW_NEW(r->context, uint8_t, all);
  r->inner = BW_NEW(r->context, uint8_t, r->triangles);
  BW_TRY_MEMORY(r->edges && r->first && r->split && r->inner);
  for (int32_t t = 0; t < r->triangles; t++)
    for (int k = 0; k < 3; k++) {
      int32_t a = r->triangle[3 * (size_t)t + (size_t)k];
      int32_t b = r->triangle[3 * (size_t)t + (size_t)(k + 1) % 3];
      r->edges[3 * (size_t)t + (size_t)k] = (edge){a < b ? a : b, a < b ? b : a, t, k, -1};
    }
  qsort(r->edges, (size_t)all, sizeof *r->edges, compare_edges);
  for (int64_t i = 0, head = 0; i < all; i++) {
    if (!same_edge(r->edges + head, r->edges + i))
      head = i;
    r->first[3 * (size_t)r->edges[i].triangle + (size_t)r->edges[i].side] = (int32_t)head;
  }
  BW_TRY(bw_parallel(r->context, all, GRAIN, look_at_edges, r));
  BW_TRY(bw_parallel(r->context, r->triangles, GRAIN, look_inside, r));
  for (int32_t t = 0; t < r->triangles; t++) {
    if (!r->inner[t])
      continue;
    const int32_t *corner = r->triangle + 3 * (size_t)t;
    int longest = 0;
    for (int k = 1; k < 3; k++)
      if (length_of(r, corner[k], corner[(k + 1) % 3]) >
          length_of(r, corner[longest], corner[longest + 1]))
        longest = k;
    r->split[r->first[3 * (size_t)t + (size_t)longest]] = 1;
  }
  for (int64_t i = 0; i < all; i++)
    if (r->split[i])
      r->edges[i].midpoint = r->points + (*added)++;
done:
  return status;
}

/* The pieces of a triangle with corners c whose sides have the midpoints m (-1: none). */
static int cut(const refined *r, const int32_t c[3], const int32_t m[3], int32_t piece[4][3]) {
  int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0), k = 0;
  if (count == 0) {
    memcpy(piece[0], c, 3 * sizeof *c);
  } else if (count == 3) {
    for (k = 0; k < 3; k++)
      memcpy(piece[k], (int32_t[3]){c[k], m[k], m[(k + 2) % 3]}, sizeof piece[k]);
    memcpy(piece[3], m, sizeof piece[3]);
  } else if (count == 1) {
    while (m[k] < 0)
      k++;
    int32_t a = c[k], b = c[(k + 1) % 3], top = c[(k + 2) % 3];
    memcpy(piece[0], (int32_t[3]){a, m[k], top}, sizeof piece[0]);
    memcpy(piece[1], (int32_t[3]){m[k], b, top}, sizeof piece[1]);
  } else {
    while (m[(k + 2) % 3] >= 0) /* the third side from k is whole */
      k++;
    int32_t a = c[k], b = c[(k + 1) % 3], top = c[(k + 2) % 3], p = m[k], q = m[(k + 1) % 3];
    memcpy(piece[0], (int32_t[3]){p, b, q}, sizeof piece[0]);
    bool first = length_of(r, a, q) < length_of(r, p, top);
    memcpy(piece[1], first ? (int32_t[3]){a, p, q} : (int32_t[3]){p, q, top}, sizeof piece[1]);
    memcpy(piece[2], first ? (int32_t[3]){a, q, top} : (int32_t[3]){a, p, top}, sizeof piece[2]);
  }
  return count + 1;
}

/* The arrays of the next round. */
static bw_status split_sides(refined *r, int32_t added) {
  bw_status status = BW_OK;
  int64_t points = (int64_t)r->points + added, triangles = r->triangles, at = 0;
  for (int64_t i = 0; i < 3 * (int64_t)r->triangles; i++)
    triangles += r->edges[r->first[i]].midpoint >= 0;
  double *rest = BW_NEW(r->context, double, 3 * points);
  double *moved = BW_NEW(r->context, double, 3 * points);
  int32_t *triangle = BW_NEW(r->context, int32_t, 3 * triangles);
  int32_t *group = r->group ? BW_NEW(r->context, int32_t, triangles) : NULL;
  uint8_t *fresh = BW_NEW(r->context, uint8_t, triangles);
  BW_TRY_MEMORY(rest && moved && triangle && fresh && (group || !r->group));
  if (3 * triangles > INT32_MAX)
    BW_TRY(bw_fail(r->context, BW_LIMIT,
                   "the surface would need more than %d triangles to follow the edit within %g m",
                   INT32_MAX / 3, r->tolerance));
  memcpy(rest, r->rest, 3 * (size_t)r->points * sizeof *rest);
  memcpy(moved, r->moved, 3 * (size_t)r->points * sizeof *moved);
  for (int64_t i = 0; i < 3 * (int64_t)r->triangles; i++)
    if (r->split[i])
      for (int j = 0; j < 3; j++)
        rest[3 * (size_t)r->edges[i].midpoint + (size_t)j] =
            (rest[3 * (size_t)r->edges[i].a + (size_t)j] +
             rest[3 * (size_t)r->edges[i].b + (size_t)j]) /
            2;
  bw_free(r->rest);
  r->rest = rest;
  rest = NULL;
  for (int32_t t = 0; t < r->triangles; t++) {
    int32_t middle[3], piece[4][3];
    for (int k = 0; k < 3; k++)
      middle[k] = r->edges[r->first[3 * (size_t)t + (size_t)k]].midpoint;
    int count = cut(r, r->triangle + 3 * (size_t)t, middle, piece);
    for (int k = 0; k < count; k++, at++) {
      memcpy(triangle + 3 * at, piece[k], sizeof piece[k]);
      fresh[at] = count > 1;
      if (group)
        group[at] = r->group[t];
    }
  }
  int32_t begin = r->points;
  bw_free(r->moved);
  bw_free(r->triangle);
  bw_free(r->group);
  bw_free(r->fresh);
  r->moved = moved;
  r->triangle = triangle;
  r->group = group;
  r->fresh = fresh;
  moved = NULL;
  triangle = group = NULL;
  fresh = NULL;
  r->points = (int32_t)points;
  r->triangles = (int32_t)triangles;
  status = move_from(r, begin);
done:
  bw_free(rest);
  bw_free(moved);
  bw_free(triangle);
  bw_free(group);
  bw_free(fresh);
  return status;
}

static bw_status begin(refined *r, const bw_surface *surface) {
  bw_status status = BW_OK;
  size_t triangles = (size_t)surface->triangle_count;
  r->points = surface->point_count;
  r->triangles = surface->triangle_count;
  r->rest = BW_NEW(r->context, double, 3 * (int64_t)r->points);
  r->moved = BW_NEW(r->context, double, 3 * (int64_t)r->points);
  r->triangle = BW_NEW(r->context, int32_t, 3 * (int64_t)r->triangles);
  r->group = surface->group ? BW_NEW(r->context, int32_t, r->triangles) : NULL;
  r->fresh = BW_NEW(r->context, uint8_t, r->triangles);
  BW_TRY_MEMORY(r->rest && r->moved && r->triangle && r->fresh && (r->group || !surface->group));
  memcpy(r->rest, surface->point, 3 * (size_t)r->points * sizeof *r->rest);
  memcpy(r->triangle, surface->triangle, 3 * triangles * sizeof *r->triangle);
  if (r->group)
    memcpy(r->group, surface->group, triangles * sizeof *r->group);
  memset(r->fresh, 1, triangles);
  BW_TRY(move_from(r, 0));
done:
  return status;
}

bw_status bw_pose_surface(bw_context *context, const bw_subdomains *subdomains, const double *map,
                          const bw_surface *surface, double tolerance, bw_surface **posed,
                          double *moved) {
  if (!(tolerance >= 0))
    return bw_fail(context, BW_INVALID, "the tolerance is %g m: 0 or more expected", tolerance);
  if (surface->triangle_count == 0)
    return bw_fail(context, BW_EMPTY, "the surface has no facets: nothing to pose");
  bw_status status = BW_OK;
  transfer t = {0};
  double low[3], high[3], size = 0, farthest = 0;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    size = fmax(size, high[k] - low[k]);
  refined r = {.context = context, .map = &t, .tolerance = tolerance > 0 ? tolerance : 1e-4 * size};
  BW_TRY(make_transfer(context, subdomains, map, &t));
  BW_TRY(begin(&r, surface));
  for (int round = 0; round < MAX_ROUNDS; round++) {
    int32_t added;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(mark(&r, &added));
    if (added > 0)
      BW_TRY(split_sides(&r, added));
    forget_round(&r);
    if (added == 0)
      break;
  }
  for (int32_t i = 0; i < r.points; i++)
    farthest = fmax(farthest, distance(r.rest + 3 * (size_t)i, r.moved + 3 * (size_t)i));
  if (moved)
    *moved = farthest;
  BW_TRY(bw_surface_adopt(context, r.points, r.moved, r.triangles, r.triangle, r.group, posed));
  bwi_keep_names(surface, *posed);
  r.moved = NULL;
  r.triangle = r.group = NULL;
done:
  forget_round(&r);
  bw_free(r.rest);
  bw_free(r.moved);
  bw_free(r.triangle);
  bw_free(r.group);
  bw_free(r.fresh);
  bwi_tree_destroy(t.tree);
  bw_free(t.map);
  bw_release(t.boundary);
  return status;
}
