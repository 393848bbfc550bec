/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Joints brought to their places inside the surface: tips drawn out to the ends of their limbs,
 * what lies outside taken in. The surface has a size of about one. */
#include <math.h>

#include "mesh/surface_topology.h"
#include "shape/curve.h"

typedef struct walls {
  const bw_surface *surface;
  bwi_topology *topology;
  bwi_tree *tree;
} walls;

typedef struct ray {
  const bw_surface *surface;
  double from[3], way[3];
  double t; /* the nearest hit so far, 0 to 1 */
} ray;

static bool hit(void *data, int32_t facet) {
  ray *r = data;
  const int32_t *corner = r->surface->triangle + 3 * (size_t)facet;
  const double *x[3];
  double e1[3], e2[3], s[3], p[3], q[3];
  for (int k = 0; k < 3; k++)
    x[k] = r->surface->point + 3 * (size_t)corner[k];
  for (int k = 0; k < 3; k++) {
    e1[k] = x[1][k] - x[0][k];
    e2[k] = x[2][k] - x[0][k];
    s[k] = r->from[k] - x[0][k];
  }
  bw_cross(r->way, e2, p);
  double det = bw_dot(e1, p);
  if (det == 0)
    return true;
  double u = bw_dot(s, p) / det;
  bw_cross(s, e1, q);
  double v = bw_dot(r->way, q) / det, t = bw_dot(e2, q) / det;
  if (u >= -1e-9 && v >= -1e-9 && u + v <= 1 + 2e-9 && t > 1e-9 && t < r->t)
    r->t = t;
  return true;
}

/* How far the wall is along a unit direction; `max` where none is nearer. */
static double to_wall(const walls *w, const double *from, const double *direction, double max) {
  ray r = {.surface = w->surface, .t = 1};
  double to[3];
  for (int k = 0; k < 3; k++) {
    r.from[k] = from[k];
    r.way[k] = max * direction[k];
    to[k] = from[k] + r.way[k];
  }
  bwi_tree_on_segment(w->tree, r.from, to, hit, &r);
  return r.t * max;
}

/* The end of a limb: on from the tip, along the way the curve comes, half a radius short of the
 * wall. */
static void draw_out(const walls *w, double *tip, const double *before) {
  double way[3];
  double length = bwi_gap(tip, before), place[3];
  int32_t facet;
  for (int k = 0; k < 3; k++)
    way[k] = (tip[k] - before[k]) / length;
  double radius = sqrt(bwi_tree_nearest(w->tree, tip, -1, 0, place, &facet));
  double far = 6 * fmax(radius, tip[3]);
  double clearance = to_wall(w, tip, way, far);
  if (clearance >= far)
    return;
  double on = clearance - 0.5 * fmin(radius, clearance);
  for (int k = 0; k < 3; k++)
    tip[k] += on * way[k];
}

/* A joint outside goes to the middle of the wall that it is nearest to. */
static bw_status take_in(bw_context *context, const walls *w, double *joint) {
  bool inside = false, unclear = false;
  double place[3], normal[3];
  int32_t facet;
  bw_status status = bwi_inside(context, w->topology, w->tree, joint, 2, &inside, &unclear);
  if (status != BW_OK || (inside && !unclear))
    return status;
  bwi_tree_nearest(w->tree, joint, -1, 0, place, &facet);
  if (facet < 0)
    return BW_OK;
  const int32_t *corner = w->surface->triangle + 3 * (size_t)facet;
  const double *x = w->surface->point;
  double e1[3], e2[3];
  for (size_t k = 0; k < 3; k++) {
    e1[k] = x[3 * (size_t)corner[1] + k] - x[3 * (size_t)corner[0] + k];
    e2[k] = x[3 * (size_t)corner[2] + k] - x[3 * (size_t)corner[0] + k];
  }
  bw_cross(e2, e1, normal); /* inwards */
  double size = bw_norm(normal);
  if (!(size > 0))
    return BW_OK;
  for (int k = 0; k < 3; k++)
    normal[k] /= size;
  double depth = to_wall(w, place, normal, 2);
  for (int k = 0; k < 3; k++)
    joint[k] = place[k] + 0.5 * depth * normal[k];
  return BW_OK;
}

bw_status bwi_sketch_settle(bw_context *context, const bw_surface *surface, bwi_sketch *sketch) {
  bw_status status = BW_OK;
  walls w = {.surface = surface};
  BW_TRY(bwi_topology_create(context, surface, &w.topology));
  BW_TRY(bwi_tree_create(context, surface->point, surface->triangle_count, surface->triangle, NULL,
                         &w.tree));
  for (int32_t b = 0; b < sketch->bone_count; b++)
    for (size_t e = 0; e < 2; e++) {
      int32_t tip = sketch->bone[2 * (size_t)b + e], other = sketch->bone[2 * (size_t)b + 1 - e];
      if (sketch->tip[tip])
        draw_out(&w, sketch->joint + 4 * (size_t)tip, sketch->joint + 4 * (size_t)other);
    }
  for (int32_t j = 0; j < sketch->joint_count; j++)
    BW_TRY(take_in(context, &w, sketch->joint + 4 * (size_t)j));
done:
  bwi_tree_destroy(w.tree);
  bwi_topology_destroy(w.topology);
  return status;
}

/* A body that contracts to a point: one bone along its longest direction. */
bw_status bwi_sketch_one_bone(bw_context *context, const bw_surface *surface, bwi_sketch *sketch) {
  double mean[3] = {0}, spread[6] = {0}, value[3], axis[9], low = HUGE_VAL, high = -HUGE_VAL;
  for (int64_t i = 0; i < surface->point_count; i++)
    for (int k = 0; k < 3; k++)
      mean[k] += surface->point[3 * i + k] / surface->point_count;
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  for (int64_t i = 0; i < surface->point_count; i++)
    for (int c = 0; c < 6; c++)
      spread[c] += (surface->point[3 * i + pair[c][0]] - mean[pair[c][0]]) *
                   (surface->point[3 * i + pair[c][1]] - mean[pair[c][1]]);
  bw_eigen3(spread, value, axis);
  for (int64_t i = 0; i < surface->point_count; i++) {
    double along = 0;
    for (int k = 0; k < 3; k++)
      along += (surface->point[3 * i + k] - mean[k]) * axis[k];
    low = fmin(low, along);
    high = fmax(high, along);
  }
  bwi_sketch_clear(sketch);
  sketch->joint = BW_NEW0(context, double, 8);
  sketch->tip = BW_NEW0(context, uint8_t, 2);
  sketch->bone = BW_NEW(context, int32_t, 2);
  if (!sketch->joint || !sketch->tip || !sketch->bone)
    return BW_MEMORY;
  sketch->joint_count = 2;
  sketch->bone_count = 1;
  sketch->bone[0] = 0;
  sketch->bone[1] = 1;
  for (size_t k = 0; k < 3; k++) {
    sketch->joint[k] = mean[k] + 0.5 * low * axis[k];
    sketch->joint[4 + k] = mean[k] + 0.5 * high * axis[k];
  }
  return BW_OK;
}
