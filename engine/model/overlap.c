/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where two surfaces lie on each other whose meshes do not match (docs/theory/joints.md): overlaps
 * of their facets, cut out in the plane of the facet of side a, and quadratures over them. A facet
 * whose corners are those of a facet of side b overlaps that one alone, also beside a fold. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

enum { LEAF = 8, CORNERS_OF_OVERLAP = 9 };

/* A gap is closed without being asked for up to this part of the mean edge. */
static const double closed_gap = 0.05;
/* Corners are at one place within this part of an edge. */
static const double same_place = 1e-6;
/* Overlaps below this part of the facet are rounding. */
static const double rounding = 1e-14;

/* The plane of a facet. */
typedef struct plane {
  double origin[3], along[3], across[3], normal[3], corner[3][2], area;
} plane;

static const double *corner_of(const bw_mesh *mesh, int32_t facet, int k) {
  return mesh->node + 3 * (int64_t)mesh->facet[(int64_t)facet * mesh->nodes_per_facet + k];
}

static double cross2(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void barycentric_of(const double corner[3][2], const double p[2], double at[3]) {
  double whole = cross2(corner[0], corner[1], corner[2]);
  at[0] = cross2(p, corner[1], corner[2]) / whole;
  at[1] = cross2(p, corner[2], corner[0]) / whole;
  at[2] = 1 - at[0] - at[1];
}

static void open_plane(const bw_mesh *mesh, int32_t facet, plane *s) {
  const double *p = corner_of(mesh, facet, 0), *q = corner_of(mesh, facet, 1),
               *r = corner_of(mesh, facet, 2);
  double u[3], v[3];
  *s = (plane){0};
  for (int k = 0; k < 3; k++) {
    s->origin[k] = p[k];
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
  }
  bw_cross(u, v, s->normal);
  double twice = bw_norm(s->normal), edge = bw_norm(u);
  s->area = twice / 2;
  for (int k = 0; k < 3 && twice > 0; k++) {
    s->normal[k] /= twice;
    s->along[k] = u[k] / edge;
  }
  bw_cross(s->normal, s->along, s->across);
  s->corner[1][0] = edge;
  s->corner[2][0] = bw_dot(v, s->along);
  s->corner[2][1] = bw_dot(v, s->across);
}

/* What polygon `in` has on the left of the line from `from` to `to`. */
static int cut(int count, const double (*in)[2], const double from[2], const double to[2],
               double (*out)[2]) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    const double *p = in[i], *q = in[(i + 1) % count];
    double a = cross2(from, to, p), b = cross2(from, to, q);
    if (a >= 0) {
      out[kept][0] = p[0];
      out[kept++][1] = p[1];
    }
    if ((a < 0) != (b < 0)) {
      double t = a / (a - b);
      out[kept][0] = p[0] + t * (q[0] - p[0]);
      out[kept++][1] = p[1] + t * (q[1] - p[1]);
    }
  }
  return kept;
}

/* Visits the overlap with a facet of side b: where both look along the normal of side a. */
static bw_status visit_overlap(bwi_overlaps *o, const plane *s, int32_t facet,
                               bwi_overlap_function *visit, void *data) {
  bw_status status = BW_OK;
  plane other;
  double corner[3][2], height[3], polygon[CORNERS_OF_OVERLAP][2], next[CORNERS_OF_OVERLAP][2];
  open_plane(o->mesh, facet, &other);
  if (!(other.area > 0) || bw_dot(other.normal, s->normal) > BWI_FACING)
    return BW_OK;
  for (int k = 0; k < 3; k++) {
    double y[3];
    for (int i = 0; i < 3; i++)
      y[i] = corner_of(o->mesh, facet, k)[i] - s->origin[i];
    corner[k][0] = bw_dot(y, s->along);
    corner[k][1] = bw_dot(y, s->across);
    height[k] = bw_dot(y, s->normal);
    memcpy(polygon[2 - k], corner[k], sizeof corner[k]); /* seen from behind */
  }
  int count = 3;
  for (int e = 0; e < 3 && count > 0; e++) {
    count = cut(count, (const double(*)[2])polygon, s->corner[e], s->corner[(e + 1) % 3], next);
    memcpy(polygon, next, sizeof next);
  }
  for (int t = 1; t + 1 < count; t++) {
    double area = cross2(polygon[0], polygon[t], polygon[t + 1]) / 2;
    if (!(area > rounding * s->area))
      continue;
    for (int q = 0; q < o->points; q++) {
      const double *l = o->point[q];
      bwi_overlap_point point = {
          .facet = facet, .other_area = other.area, .weight = o->weight[q] * area};
      double p[2], distance = 0;
      for (int k = 0; k < 2; k++)
        p[k] = l[0] * polygon[0][k] + l[1] * polygon[t][k] + l[2] * polygon[t + 1][k];
      barycentric_of((const double(*)[2])s->corner, p, point.at);
      barycentric_of((const double(*)[2])corner, p, point.other_at);
      for (int k = 0; k < 3; k++)
        distance += point.other_at[k] * height[k];
      if (fabs(distance) > o->gap)
        continue;
      o->largest = fmax(o->largest, fabs(distance));
      BW_TRY(visit(data, &point));
    }
  }
done:
  return status;
}

/* ---- facets of side b near one of side a ------------------------------------------------------
 */

static void box_of(const void *data, int32_t facet, double *min, double *max) {
  bwi_boundary_box(((const bwi_overlaps *)data)->mesh, facet, min, max);
}

static double distance_to(void *data, int32_t facet, const double *p) {
  double weight[3];
  return bwi_boundary_nearest(((const bwi_overlaps *)data)->mesh, facet, p, weight);
}

static bw_status take_near(void *data, int32_t facet) {
  bwi_overlaps *o = (bwi_overlaps *)data;
  double box[6];
  box_of(o, facet, box, box + 3);
  for (int k = 0; k < 3; k++)
    if (box[k] > o->max[k] || box[3 + k] < o->min[k])
      return BW_OK;
  if (!bw_grow(o->context, (void **)&o->near, &o->capacity, o->near_count, 1, sizeof *o->near))
    return BW_MEMORY;
  o->near[o->near_count++] = facet;
  return BW_OK;
}

/* Whether the corners of two facets are the same places. */
static bool same_corners(const bw_mesh *mesh, int32_t facet, int32_t other, double distance) {
  for (int a = 0; a < 3; a++) {
    const double *x = corner_of(mesh, facet, a);
    bool found = false;
    for (int b = 0; b < 3 && !found; b++) {
      const double *y = corner_of(mesh, other, b);
      double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      found = bw_norm(d) <= distance;
    }
    if (!found)
      return false;
  }
  return true;
}

bw_status bwi_overlaps_of(bwi_overlaps *o, int32_t facet, bwi_overlap_function *visit, void *data) {
  bw_status status = BW_OK;
  plane s;
  open_plane(o->mesh, facet, &s);
  box_of(o, facet, o->min, o->max);
  for (int k = 0; k < 3; k++) {
    o->min[k] -= o->gap;
    o->max[k] += o->gap;
  }
  o->near_count = 0;
  BW_TRY(bwi_box_tree_in_box(&o->tree, o->min, o->max, take_near, o));
  o->area = s.area;
  memcpy(o->normal, s.normal, sizeof o->normal);
  for (size_t i = 0; i < o->near_count; i++)
    if (same_corners(o->mesh, facet, o->near[i], same_place * sqrt(2 * s.area)))
      return visit_overlap(o, &s, o->near[i], visit, data);
  for (size_t i = 0; i < o->near_count; i++)
    BW_TRY(visit_overlap(o, &s, o->near[i], visit, data));
done:
  return status;
}

static double mean_edge(const bw_selection *on) {
  return sqrt(2 * bw_selection_area(on) / on->facet_count);
}

bw_status bwi_overlaps_open(bw_context *context, const bw_selection *a, const bw_selection *b,
                            double gap, const char *what, bwi_overlaps *o) {
  int32_t count = b->facet_count, *item;
  *o = (bwi_overlaps){.context = context, .mesh = a->mesh, .a = a, .gap = gap};
  if (gap < 0)
    o->gap = closed_gap * fmin(mean_edge(a), mean_edge(b));
  o->points = bw_triangle_quadrature(2 * o->mesh->order, o->point, o->weight);
  bw_status status = bwi_check_sides(context, a, b, what);
  if (status != BW_OK)
    return status;
  item = BW_NEW(context, int32_t, count);
  if (!item)
    return BW_MEMORY;
  memcpy(item, b->facet, (size_t)count * sizeof *item);
  return bwi_box_tree_create(context, 3, LEAF, count, item, box_of, o, &o->tree);
}

void bwi_overlaps_clear(bwi_overlaps *o) {
  bwi_box_tree_clear(&o->tree);
  bw_free(o->near);
}

/* How far the nodes of side a are from side b. */
bw_status bwi_overlaps_fail_apart(bwi_overlaps *o, const char *what) {
  double nearest = INFINITY, square;
  for (int32_t i = 0; i < o->a->node_count; i++)
    if (bwi_box_tree_nearest(&o->tree, o->mesh->node + 3 * (int64_t)o->a->node[i], distance_to, o,
                             &square) >= 0)
      nearest = fmin(nearest, sqrt(square));
  bw_fail(o->context, BW_GEOMETRY,
          "the sides of the %s do not touch: they are %.4g m apart at the nearest node of side a, "
          "and the %s closes gaps up to %.4g m between facets that face each other; give a larger "
          "gap, or other selections",
          what, nearest, what, o->gap);
  bw_detail_number(o->context, "distance", nearest);
  bw_detail_number(o->context, "gap", o->gap);
  return BW_GEOMETRY;
}
