/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Planes of symmetry and of antisymmetry: supports along the normal of the plane that a selection
 * lies in, or along two directions within it (docs/theory/joints.md). */
#include <math.h>
#include <string.h>

#include "model/internal.h"

/* Nodes within this part of the selection's size are in its plane. */
static const double flat = 1e-4;

/* The unit normal of the plane in which the facets of a selection lie. */
static bw_status find_plane(bw_context *context, const bw_selection *on, double normal[3]) {
  double centre[3], size = 0, deviation = 0;
  const double *farthest = on->mesh->node;
  bw_selection_normal(on, normal);
  double length = bw_norm(normal);
  if (!(length > 0.5))
    return bw_fail(context, BW_GEOMETRY,
                   "a plane of symmetry has one normal, but the %d facets of the selection look in "
                   "different directions: select one plane face",
                   on->facet_count);
  bw_selection_centre(on, centre);
  for (int32_t i = 0; i < on->node_count; i++) {
    const double *x = on->mesh->node + 3 * (int64_t)on->node[i];
    double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    double height = fabs(bw_dot(y, normal)) / length;
    size = fmax(size, bw_norm(y));
    if (height > deviation) {
      deviation = height;
      farthest = x;
    }
  }
  for (int k = 0; k < 3; k++)
    normal[k] /= length;
  if (deviation <= flat * size)
    return BW_OK;
  bw_fail(context, BW_GEOMETRY,
          "a plane of symmetry is plane, but the selection deviates by %.4g m from its mean plane "
          "at (%g, %g, %g) m, where %.4g m are allowed: select one plane face",
          deviation, farthest[0], farthest[1], farthest[2], flat * size);
  bw_detail_number(context, "deviation", deviation);
  return BW_GEOMETRY;
}

/* The unit vector across `normal` that is nearest to a global axis, the last one of equals. */
static void tangent_of(const double normal[3], double tangent[3]) {
  double best = -1;
  for (int axis = 0; axis < 3; axis++) {
    double rest[3] = {0, 0, 0};
    rest[axis] = 1;
    for (int k = 0; k < 3; k++)
      rest[k] -= normal[axis] * normal[k];
    double size = bw_norm(rest);
    if (size < best)
      continue;
    best = size;
    for (int k = 0; k < 3; k++)
      tangent[k] = rest[k] / size;
  }
}

bw_status bw_model_symmetry(bw_context *context, bw_model *model, const bw_selection *on,
                            bw_symmetry kind) {
  bw_status status = BW_OK;
  double normal[3], along[2][3];
  int count = kind == BW_SYMMETRIC ? 1 : 2, before = model->support_count;
  if (kind != BW_SYMMETRIC && kind != BW_ANTISYMMETRIC)
    return bw_fail(context, BW_INVALID, "a plane of symmetry is symmetric or antisymmetric");
  BW_TRY(bwi_check_selection(context, model, on, false, "a plane of symmetry"));
  BW_TRY(find_plane(context, on, normal));
  if (kind == BW_SYMMETRIC)
    memcpy(along[0], normal, sizeof normal);
  else {
    tangent_of(normal, along[0]);
    bw_cross(normal, along[0], along[1]);
  }
  for (int i = 0; i < count; i++) {
    bw_support support = {.on = on, .slide = true, .symmetry = kind};
    memcpy(support.normal, along[i], sizeof support.normal);
    BW_TRY(bwi_model_add_support(context, model, &support));
  }
done:
  if (status != BW_OK)
    bwi_model_drop_supports(model, before);
  return status;
}
