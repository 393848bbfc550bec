/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A pose of the surface that a mesh was made from: its own points and triangles, moved by the map
 * of pose_map.h. Triangles are split only where the map bends within them, or where bent edges
 * would fold them over. Flat parts that bend are first made Delaunay by edge flips. */
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"
#include "shape/pose_flips.h"
#include "shape/pose_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  GRAIN = 256,
  MAX_SAMPLES = 63, /* between the ends of an edge */
  MAX_LATTICE = 24, /* parts of a side, for places inside of a triangle */
  MAX_ROUNDS = 40,
  MAX_REPAIRS = 8, /* rounds of splitting triangles that cross each other */
};
/* Edges shorter than this fraction of the boundary's mean edge are not split for the tolerance: the
 * mesh knows no finer shape, and a bend that is left is a kink of the map between its elements. */
static const double shortest_part = 0.5;
/* Of a triangle's height over its longest side: how far this side may bend at the foot. */
static const double foldable_part = 0.25;
/* Of the surface's size: how far flips may change it. Coordinates of 32 bits have such errors. */
static const double flat_part = 2e-7;

/* Of the surface's size: triangles that are lower are as high. */
static const double least_height = 1e-9;

static double distance(const double *a, const double *b) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return bw_norm(d);
}

/* ---- the surface being refined --------------------------------------------------------------- */

typedef struct edge {
  int32_t a, b;     /* a < b */
  int32_t triangle; /* a triangle and which of its sides, for sorting */
  int32_t side;
  int32_t middle; /* the point that splits it, of the first in a run of equals; -1: is not split */
} edge;

typedef struct refined {
  bw_context *context;
  const bwi_pose_map *map;
  double size, tolerance, spacing;
  int32_t points, triangles;
  double *rest, *moved; /* (3 per point) */
  int32_t *triangle, *group;
  uint8_t *fresh;   /* (triangles) the sides and the inside were not looked at yet */
  uint8_t *crosses; /* (triangles) crosses another one: all sides are to be split */
  edge *edges;      /* all sides, sorted */
  int32_t *first;   /* (3 per triangle) of a side: the first of its run in edges */
  double *split;    /* (3 per triangle, by place in edges) where from a to b, 0: nowhere */
  double *urgency;  /* (3 per triangle, by place in edges) bend by what is allowed, of split */
  double *foot;     /* (triangles) where the longest side is to be split, 0: nowhere */
  double *folds;    /* (triangles) urgency of foot */
} refined;

typedef struct move_job {
  refined *r;
  int32_t begin;
} move_job;

static bw_status move_points(void *data, int64_t begin, int64_t end, int worker) {
  move_job *job = (move_job *)data;
  (void)worker;
  for (int64_t i = job->begin + begin; i < job->begin + end; i++)
    bwi_pose_map_point(job->r->map, job->r->rest + 3 * i, job->r->moved + 3 * i);
  return BW_OK;
}

static bw_status move_from(refined *r, int32_t begin) {
  move_job job = {r, begin};
  return bw_parallel(r->context, r->points - begin, GRAIN, move_points, &job);
}

/* How far the map of a place on a triangle is from the interpolated one of its corners. */
static double bend(const refined *r, const int32_t *corner, int corners, const double *weight) {
  double x[3] = {0, 0, 0}, linear[3] = {0, 0, 0}, y[3];
  for (int k = 0; k < corners; k++)
    for (int j = 0; j < 3; j++) {
      x[j] += weight[k] * r->rest[3 * (size_t)corner[k] + (size_t)j];
      linear[j] += weight[k] * r->moved[3 * (size_t)corner[k] + (size_t)j];
    }
  bwi_pose_map_point(r->map, x, y);
  return distance(y, linear);
}

static double length_of(const refined *r, int32_t a, int32_t b) {
  return distance(r->rest + 3 * (size_t)a, r->rest + 3 * (size_t)b);
}

static bool edge_bends(const refined *r, const edge *e) {
  double parts = length_of(r, e->a, e->b) / r->spacing;
  if (parts < shortest_part)
    return false;
  int samples = parts > MAX_SAMPLES ? MAX_SAMPLES : parts > 1 ? (int)parts : 1;
  int32_t corner[2] = {e->a, e->b};
  for (int s = 1; s <= samples; s++) {
    double weight[2] = {1 - (double)s / (samples + 1), (double)s / (samples + 1)};
    if (bend(r, corner, 2, weight) > r->tolerance)
      return true;
  }
  return false;
}

/* Only triangles larger than the facets of the mesh can bend inside and not on their sides. */
static bool inside_bends(const refined *r, const int32_t *corner, double longest) {
  double parts = longest / r->spacing;
  if (parts < 2)
    return false;
  int sides = parts > MAX_LATTICE ? MAX_LATTICE : (int)parts + 1;
  for (int i = 1; i < sides; i++)
    for (int j = 1; i + j < sides; j++) {
      double weight[3] = {(double)i / sides, (double)j / sides, (double)(sides - i - j) / sides};
      if (bend(r, corner, 3, weight) > r->tolerance)
        return true;
    }
  return false;
}

/* How much the edge from a to b bends at the foot of c, by what the height of c above it allows;
 * *foot: where from a to b. 0 where the foot is at an end. */
static double fold(const refined *r, int32_t a, int32_t b, int32_t c, double *foot) {
  const double *p = r->rest + 3 * (size_t)a, *q = r->rest + 3 * (size_t)b;
  const double *x = r->rest + 3 * (size_t)c;
  double pq[3], px[3], height[3];
  for (int k = 0; k < 3; k++) {
    pq[k] = q[k] - p[k];
    px[k] = x[k] - p[k];
  }
  double square = bw_dot(pq, pq), near_end = 1e-6;
  *foot = square > 0 ? bw_dot(px, pq) / square : 0;
  if (!(*foot > near_end && *foot < 1 - near_end))
    return 0;
  for (int k = 0; k < 3; k++)
    height[k] = px[k] - *foot * pq[k];
  double bent = bend(r, (int32_t[2]){a, b}, 2, (double[2]){1 - *foot, *foot});
  return bent / (foldable_part * fmax(bw_norm(height), least_height * r->size));
}

static bool same_edge(const edge *x, const edge *y) {
  return x->a == y->a && x->b == y->b;
}

static bw_status look_at_edges(void *data, int64_t begin, int64_t end, int worker) {
  refined *r = (refined *)data;
  int64_t all = 3 * (int64_t)r->triangles;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    const edge *e = r->edges + i;
    bool fresh = false, crosses = false;
    r->split[i] = r->urgency[i] = 0;
    if (i > 0 && same_edge(e - 1, e))
      continue;
    for (int64_t k = i; k < all && same_edge(r->edges + k, e); k++) {
      fresh |= r->fresh[r->edges[k].triangle];
      crosses |= r->crosses && r->crosses[r->edges[k].triangle];
    }
    if (crosses || (fresh && edge_bends(r, e)))
      r->split[i] = 0.5;
  }
  return BW_OK;
}

static int longest_side(const refined *r, const int32_t *corner, double *length) {
  int longest = 0;
  *length = 0;
  for (int k = 0; k < 3; k++) {
    double own = length_of(r, corner[k], corner[(k + 1) % 3]);
    if (own > *length) {
      *length = own;
      longest = k;
    }
  }
  return longest;
}

/* Whether a side of a triangle is to be split; after look_at_edges. */
static bool is_split(const refined *r, int64_t t) {
  for (int64_t k = 0; k < 3; k++)
    if (r->split[r->first[3 * t + k]] > 0)
      return true;
  return false;
}

static bw_status look_at_triangles(void *data, int64_t begin, int64_t end, int worker) {
  refined *r = (refined *)data;
  (void)worker;
  for (int64_t t = begin; t < end; t++) {
    const int32_t *c = r->triangle + 3 * t;
    double length, foot;
    r->foot[t] = r->folds[t] = 0;
    if (!r->fresh[t])
      continue;
    int k = longest_side(r, c, &length);
    double folds = fold(r, c[k], c[(k + 1) % 3], c[(k + 2) % 3], &foot);
    if (folds > 1) {
      r->foot[t] = foot;
      r->folds[t] = folds;
    } else if (!is_split(r, t) && inside_bends(r, c, length)) {
      r->foot[t] = 0.5;
    }
  }
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
  bw_free(r->crosses);
  bw_free(r->edges);
  bw_free(r->first);
  bw_free(r->split);
  bw_free(r->urgency);
  bw_free(r->foot);
  bw_free(r->folds);
  r->crosses = NULL;
  r->edges = NULL;
  r->first = NULL;
  r->split = r->urgency = r->foot = r->folds = NULL;
}

/* What triangles want of their longest sides: of two wishes the more urgent. */
static void ask_for_feet(refined *r) {
  for (int32_t t = 0; t < r->triangles; t++) {
    if (r->foot[t] == 0)
      continue;
    const int32_t *corner = r->triangle + 3 * (size_t)t;
    double length;
    int k = longest_side(r, corner, &length);
    int32_t head = r->first[3 * (size_t)t + (size_t)k];
    if (r->split[head] == 0 || r->folds[t] > r->urgency[head]) {
      r->split[head] = corner[k] == r->edges[head].a ? r->foot[t] : 1 - r->foot[t];
      r->urgency[head] = r->folds[t];
    }
  }
}

/* Marks the sides to split, and numbers the points that split them: *added of them. */
static bw_status mark(refined *r, int32_t *added) {
  bw_status status = BW_OK;
  int64_t all = 3 * (int64_t)r->triangles;
  *added = 0;
  r->edges = BW_NEW(r->context, edge, all);
  r->first = BW_NEW(r->context, int32_t, all);
  r->split = BW_NEW(r->context, double, all);
  r->urgency = BW_NEW(r->context, double, all);
  r->foot = BW_NEW(r->context, double, r->triangles);
  r->folds = BW_NEW(r->context, double, r->triangles);
  BW_TRY_MEMORY(r->edges && r->first && r->split && r->urgency && r->foot && r->folds);
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
  BW_TRY(bw_parallel(r->context, r->triangles, GRAIN, look_at_triangles, r));
  ask_for_feet(r);
  for (int64_t i = 0; i < all; i++)
    if (r->split[i] > 0)
      r->edges[i].middle = r->points + (*added)++;
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
    triangles += r->edges[r->first[i]].middle >= 0;
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
    if (r->split[i] > 0) {
      const edge *e = r->edges + i;
      double *middle = rest + 3 * (size_t)e->middle;
      for (size_t j = 0; j < 3; j++) {
        double a = rest[3 * (size_t)e->a + j], b = rest[3 * (size_t)e->b + j];
        middle[j] = a + r->split[i] * (b - a);
      }
    }
  bw_free(r->rest);
  r->rest = rest;
  rest = NULL;
  for (int32_t t = 0; t < r->triangles; t++) {
    int32_t middle[3], piece[4][3];
    for (int k = 0; k < 3; k++)
      middle[k] = r->edges[r->first[3 * (size_t)t + (size_t)k]].middle;
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

static bool flip_helps(void *data, int32_t a, int32_t b, int32_t c, int32_t d) {
  const refined *r = (const refined *)data;
  double foot;
  return fold(r, a, b, c, &foot) > 1 || fold(r, a, b, d, &foot) > 1;
}

static bw_status flip(refined *r) {
  return bwi_flip_flat_edges(r->context, r->rest, r->triangles, r->triangle, r->group, r->fresh,
                             flat_part * r->size, flip_helps, r);
}

/* Flips and splits until nothing bends too much. */
static bw_status refine(refined *r, int rounds) {
  bw_status status = BW_OK;
  int32_t added = 1;
  for (int round = 0; round < rounds && added > 0; round++) {
    BW_TRY(bw_check_cancel(r->context));
    BW_TRY(mark(r, &added));
    if (added > 0) {
      BW_TRY(split_sides(r, added));
      BW_TRY(flip(r));
    }
    forget_round(r);
  }
done:
  return status;
}

/* Pairs of triangles that cross each other, with `point` for their corners. */
static bw_status crossings_at(const refined *r, double *point, bwi_pair **pairs, int64_t *count) {
  bw_status status = BW_OK;
  bw_surface surface = {.point_count = r->points,
                        .point = point,
                        .triangle_count = r->triangles,
                        .triangle = r->triangle}; /* borrows */
  bwi_topology *topology = NULL;
  uint8_t *flat = BW_NEW(r->context, uint8_t, r->triangles);
  BW_TRY_MEMORY(flat);
  BW_TRY(bwi_topology_create(r->context, &surface, &topology));
  BW_TRY(bwi_flat_facets(r->context, topology, flat));
  BW_TRY(bwi_intersections(r->context, topology, flat, pairs, count));
done:
  bw_free(flat);
  bwi_topology_destroy(topology);
  return status;
}

/* Marks the triangles that cross others and did not before: *made pairs. */
static bw_status find_crossings(refined *r, int64_t *made) {
  bw_status status = BW_OK;
  bwi_pair *pairs = NULL, *before = NULL;
  int64_t count = 0, known = 0, at = 0;
  *made = 0;
  BW_TRY(crossings_at(r, r->moved, &pairs, &count));
  if (count > 0)
    BW_TRY(crossings_at(r, r->rest, &before, &known));
  r->crosses = BW_NEW0(r->context, uint8_t, r->triangles);
  BW_TRY_MEMORY(r->crosses);
  for (int64_t i = 0; i < count; i++) { /* both lists ascend */
    while (at < known &&
           (before[at].first < pairs[i].first ||
            (before[at].first == pairs[i].first && before[at].second < pairs[i].second)))
      at++;
    if (at < known && before[at].first == pairs[i].first && before[at].second == pairs[i].second)
      continue;
    r->crosses[pairs[i].first] = r->crosses[pairs[i].second] = 1;
    ++*made;
  }
done:
  bw_free(pairs);
  bw_free(before);
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
  bwi_pose_map *pose = NULL;
  double low[3], high[3], size = 0, farthest = 0;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    size = fmax(size, high[k] - low[k]);
  refined r = {
      .context = context, .tolerance = tolerance > 0 ? tolerance : 1e-4 * size, .size = size};
  BW_TRY(bwi_pose_map_create(context, subdomains, map, &pose));
  r.map = pose;
  r.spacing = bwi_pose_map_spacing(pose);
  BW_TRY(begin(&r, surface));
  BW_TRY(flip(&r));
  BW_TRY(refine(&r, MAX_ROUNDS));
  for (int k = 0; k < MAX_REPAIRS; k++) {
    int64_t crossings;
    BW_TRY(find_crossings(&r, &crossings));
    if (crossings == 0)
      break;
    BW_TRY(refine(&r, MAX_ROUNDS));
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
  bwi_pose_map_destroy(pose);
  return status;
}
