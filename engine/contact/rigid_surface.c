/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rigid surfaces: planes, spheres and cylinders, the gap to them, and the way to them. */
#include <math.h>
#include <string.h>

#include "contact/internal.h"
#include "mesh/surface_tree.h"

static void surface_destroy(void *object) {
  bw_free(object);
}

static size_t surface_bytes(const void *object) {
  (void)object;
  return sizeof(bw_rigid_surface);
}

static const bw_kind surface_kind = {"rigid surface", surface_destroy, surface_bytes};

bw_status bwi_rigid_create(bw_context *context, const bw_rigid_surface *like,
                           bw_rigid_surface **surface) {
  double length = bw_norm(like->direction);
  for (int k = 0; k < 3; k++)
    if (!isfinite(like->point[k]))
      return bw_fail(context, BW_INVALID, "a rigid surface needs a point of three finite numbers");
  if (like->kind != BW_RIGID_SPHERE && !(length > 0 && isfinite(length)))
    return bw_fail(context, BW_INVALID, "a rigid %s needs %s of three finite numbers, not all zero",
                   like->kind == BW_RIGID_PLANE ? "plane" : "cylinder",
                   like->kind == BW_RIGID_PLANE ? "a normal" : "an axis");
  if (like->kind != BW_RIGID_PLANE && !(like->radius > 0 && isfinite(like->radius)))
    return bw_fail(context, BW_INVALID, "a rigid %s has the radius %g m; it must be positive",
                   like->kind == BW_RIGID_SPHERE ? "sphere" : "cylinder", like->radius);
  bw_rigid_surface *out = BW_NEW(context, bw_rigid_surface, 1);
  if (!out)
    return BW_MEMORY;
  *out = *like;
  bw_object_init(out, &surface_kind);
  for (int k = 0; k < 3 && length > 0; k++)
    out->direction[k] /= length;
  *surface = out;
  return BW_OK;
}

static void put(const double *point, bw_rigid_surface *surface) {
  surface->placed = point != NULL;
  if (point)
    memcpy(surface->point, point, sizeof surface->point);
}

bw_status bw_rigid_plane(bw_context *context, const double point[3], const double normal[3],
                         bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_PLANE};
  put(point, &like);
  memcpy(like.direction, normal, sizeof like.direction);
  return bwi_rigid_create(context, &like, surface);
}

bw_status bw_rigid_sphere(bw_context *context, const double centre[3], double radius, bool inside,
                          bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_SPHERE, .radius = radius, .inside = inside};
  put(centre, &like);
  return bwi_rigid_create(context, &like, surface);
}

bw_status bw_rigid_cylinder(bw_context *context, const double point[3], const double axis[3],
                            double radius, bool inside, bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_CYLINDER, .radius = radius, .inside = inside};
  put(point, &like);
  memcpy(like.direction, axis, sizeof like.direction);
  return bwi_rigid_create(context, &like, surface);
}

/* The part of a vector across the axis, if there is one. */
static void take_across(const bw_rigid_surface *surface, double x[3]) {
  double along = bw_dot(x, surface->direction);
  for (int k = 0; k < 3; k++)
    x[k] -= along * surface->direction[k];
}

static void arm_to(const bw_rigid_surface *surface, const double x[3], double arm[3]) {
  for (int k = 0; k < 3; k++)
    arm[k] = x[k] - surface->point[k];
}

double bwi_rigid_gap(const bw_rigid_surface *surface, const double x[3], double normal[3]) {
  double arm[3], sign = surface->inside ? -1 : 1;
  arm_to(surface, x, arm);
  if (surface->kind == BW_RIGID_PLANE) {
    memcpy(normal, surface->direction, sizeof surface->direction);
    return bw_dot(arm, normal);
  }
  take_across(surface, arm);
  double distance = bw_norm(arm);
  for (int k = 0; k < 3; k++) /* on the axis all normals are alike: none */
    normal[k] = distance > 0 ? sign * arm[k] / distance : 0;
  return sign * (distance - surface->radius);
}

/* Takes what `way` has of a vector off it; returns the factor of `way`. */
static double take_along(const double way[3], double x[3]) {
  double square = bw_dot(way, way), along = square > 0 ? bw_dot(x, way) / square : 0;
  for (int k = 0; k < 3; k++)
    x[k] -= along * way[k];
  return along;
}

double bwi_rigid_travel(const bw_rigid_surface *surface, const double x[3], const double way[3]) {
  double part[3] = {way[0], way[1], way[2]}, arm[3];
  arm_to(surface, x, arm);
  if (surface->kind == BW_RIGID_PLANE) {
    double slope = bw_dot(way, surface->direction);
    return slope < 0 ? -bw_dot(arm, surface->direction) / slope : INFINITY;
  }
  take_across(surface, arm);
  take_across(surface, part);
  double from = take_along(part, arm), square = bw_dot(part, part);
  double chord = surface->radius * surface->radius - bw_dot(arm, arm);
  return square > 0 && chord >= 0 ? -from - sqrt(chord / square) : INFINITY;
}

double bwi_rigid_depth(const bw_rigid_surface *surface, const double *const corner[3],
                       const double *way) {
  const double origin[3] = {0};
  double part[3] = {0}, x[3][3], place[3];
  if (surface->kind == BW_RIGID_PLANE)
    return 0;
  if (way)
    memcpy(part, way, sizeof part);
  take_across(surface, part);
  for (int i = 0; i < 3; i++) {
    arm_to(surface, corner[i], x[i]);
    take_across(surface, x[i]);
    take_along(part, x[i]);
  }
  return surface->radius - sqrt(bwi_nearest_on_triangle(origin, x[0], x[1], x[2], place));
}
