/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stress of a static solution: that of its displacement, less what free expansion explains. */
#include "barwright/analysis.h"
#include "model/internal.h"

bw_status bw_static_stress(bw_context *context, const bw_static *result, bool on_nodes,
                           double *stress) {
  const bw_model *model = result->model;
  const bw_mesh *mesh = model->mesh;
  double *thermal = NULL;
  bw_status status;
  if (on_nodes)
    BW_TRY(bw_nodal_stress(context, mesh, model->material, result->displacement, stress));
  else
    BW_TRY(bw_element_stress(context, mesh, model->material, result->displacement, stress));
  if (!bwi_model_expands(model))
    goto done;
  size_t count = 6 * (size_t)(on_nodes ? mesh->node_count : mesh->element_count);
  thermal = BW_NEW(context, double, count);
  BW_TRY_MEMORY(thermal);
  BW_TRY(bw_model_thermal_stress(context, model, on_nodes, thermal));
  for (size_t i = 0; i < count; i++)
    stress[i] -= thermal[i];
done:
  bw_free(thermal);
  return status;
}
