/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rigid surfaces: planes, spheres and cylinders, and the gap to them. */
#include <math.h>
#include <string.h>

#include "contact/internal.h"

static void surface_destroy(void *object) {
  bw_free(object);
}

static size_t surface_bytes(const void *object) {
  (void)object;
  return sizeof(bw_rigid_surface);
}

static const bw_kind surface_kind = {"rigid surface", surface_destroy, surface_bytes};

static bw_status create(bw_context *context, const bw_rigid_surface *like,
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

bw_status bw_rigid_plane(bw_context *context, const double point[3], const double normal[3],
                         bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_PLANE};
  memcpy(like.point, point, sizeof like.point);
  memcpy(like.direction, normal, sizeof like.direction);
  return create(context, &like, surface);
}

bw_status bw_rigid_sphere(bw_context *context, const double centre[3], double radius, bool inside,
                          bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_SPHERE, .radius = radius, .inside = inside};
  memcpy(like.point, centre, sizeof like.point);
  return create(context, &like, surface);
}

bw_status bw_rigid_cylinder(bw_context *context, const double point[3], const double axis[3],
                            double radius, bool inside, bw_rigid_surface **surface) {
  bw_rigid_surface like = {.kind = BW_RIGID_CYLINDER, .radius = radius, .inside = inside};
  memcpy(like.point, point, sizeof like.point);
  memcpy(like.direction, axis, sizeof like.direction);
  return create(context, &like, surface);
}

double bwi_rigid_gap(const bw_rigid_surface *surface, const double x[3], double normal[3]) {
  double arm[3] = {x[0] - surface->point[0], x[1] - surface->point[1], x[2] - surface->point[2]};
  double along = bw_dot(arm, surface->direction), sign = surface->inside ? -1 : 1;
  if (surface->kind == BW_RIGID_PLANE) {
    memcpy(normal, surface->direction, sizeof surface->direction);
    return along;
  }
  for (int k = 0; k < 3; k++)
    arm[k] -= along * surface->direction[k];
  double distance = bw_norm(arm);
  for (int k = 0; k < 3; k++) /* on the axis all normals are alike: none */
    normal[k] = distance > 0 ? sign * arm[k] / distance : 0;
  return sign * (distance - surface->radius);
}
