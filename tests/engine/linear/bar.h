/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A bar along x, from 0 to 3, on several supports. */
#ifndef TESTS_BAR_H
#define TESTS_BAR_H

#include "bodies.h"

/* Free; fixed at an end; which slides along oblique normals too; slides along one axis alone, so
 * that motions are left. */
enum { FREE, HELD, ALONG_NORMALS, TWO_MOTIONS, SCENES };

/* A scene of another number is free. */
static inline bw_model *bar_model(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, int scene) {
  bw_model *model = NULL;
  bw_selection *end = NULL, *side = NULL;
  const double origin[3] = {0, 0, 0}, x[3] = {1, 0, 0}, low[3] = {1.9, -1, -1},
               high[3] = {4, 1e-9, 2}, normal[3] = {0.1, 1, 0.2};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, x, 1e-9, &end));
  check_ok(context, bw_select_box(context, mesh, low, high, &side));
  if (scene == HELD || scene == ALONG_NORMALS)
    check_ok(context, bw_model_fix(context, model, end));
  if (scene == ALONG_NORMALS)
    check_ok(context, bw_model_slide(context, model, side, normal));
  if (scene == TWO_MOTIONS)
    check_ok(context, bw_model_slide(context, model, end, x));
  bw_release(end);
  bw_release(side);
  return model;
}

#endif
