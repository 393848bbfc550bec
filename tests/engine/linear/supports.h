/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies under their weight and a force, on all kinds of supports. */
#ifndef TESTS_SUPPORTS_H
#define TESTS_SUPPORTS_H

#include "incremental_bar.h"

typedef enum support { CLAMPED, SLIDING, OBLIQUE, FREE, SUPPORTS } support;

/* Supported at 0 of `axis`, and where it slides at y = 0 too; pulled at `far` of the axis. An
 * oblique support slides across `normal`. */
static inline bw_model *supported_body(bw_context *context, const bw_mesh *mesh,
                                       const bw_material *material, support how, int axis,
                                       double far, const double normal[3]) {
  bw_model *model = NULL;
  const double pull[3] = {3e3, 1e3, -2e3}, gravity[3] = {1, 2, -9.81};
  bw_selection *low = body_face(context, mesh, axis, 0),
               *high = body_face(context, mesh, axis, far);
  bw_selection *side = body_face(context, mesh, 1, 0);
  check_ok(context, bw_model_create(context, mesh, material, &model));
  if (how == CLAMPED)
    check_ok(context, bw_model_fix(context, model, low));
  if (how == SLIDING || how == OBLIQUE) {
    check_ok(context, bw_model_slide(context, model, low, how == OBLIQUE ? normal : NULL));
    check_ok(context, bw_model_slide(context, model, side, NULL));
  }
  check_ok(context, bw_model_gravity(context, model, gravity));
  check_ok(context, bw_model_force(context, model, high, pull));
  bw_release(low);
  bw_release(high);
  bw_release(side);
  return model;
}

#endif
