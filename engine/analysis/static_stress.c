/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stress of a static solution: that of its displacement, less what free expansion explains. */
#include "analysis/strain.h"
#include "barwright/analysis.h"
#include "model/internal.h"

/* At points, or where `at` is NULL means of elements. */
static bw_status stress_at(bw_context *context, const bw_static *result, const bw_stress_points *at,
                           double *stress) {
  const bw_model *model = result->model;
  const bw_mesh *mesh = model->mesh;
  double *thermal = NULL;
  bw_status status;
  if (at)
    BW_TRY(bw_point_stress(context, mesh, model->material, result->displacement, at, stress));
  else
    BW_TRY(bw_element_stress(context, mesh, model->material, result->displacement, stress));
  if (!bwi_model_expands(model))
    goto done;
  size_t count = 6 * (size_t)(at ? at->count : mesh->element_count);
  thermal = BW_NEW(context, double, count);
  BW_TRY_MEMORY(thermal);
  BW_TRY(bw_model_thermal_stress(context, model, at, thermal));
  for (size_t i = 0; i < count; i++)
    stress[i] -= thermal[i];
done:
  bw_free(thermal);
  return status;
}

bw_status bw_static_point_stress(bw_context *context, const bw_static *result,
                                 const bw_stress_points *points, double *stress) {
  return stress_at(context, result, points, stress);
}

bw_status bw_static_stress(bw_context *context, const bw_static *result, bool on_nodes,
                           double *stress) {
  const bw_model *model = result->model;
  bw_status status;
  bw_stress_points points = {0};
  double *all = NULL;
  if (!on_nodes)
    return stress_at(context, result, NULL, stress);
  BW_TRY(bw_stress_points_create(context, model->mesh, model->material, &points));
  if (points.point)
    all = BW_NEW(context, double, 6 * (int64_t)points.count);
  BW_TRY_MEMORY(all || !points.point);
  BW_TRY(stress_at(context, result, &points, all ? all : stress));
  if (all)
    bwi_governing_stress(&points, model->mesh->node_count, all, stress);
done:
  bw_free(all);
  bw_stress_points_clear(&points);
  return status;
}
