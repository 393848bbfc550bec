/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Models, static solutions and modes of a whole wheel from those of one sector
 * (docs/theory/symmetry.md). */
#include <math.h>
#include <string.h>

#include "eigen/modes.h"
#include "joint/cyclic.h"
#include "statics/internal.h"

bw_status bw_model_whole(bw_context *context, const bw_model *sector, bw_model **whole) {
  bw_status status = BW_OK;
  bwi_wheel w = {0};
  BW_TRY(bwi_wheel_open(context, sector->cyclic, sector->material, &w));
  BW_TRY(bwi_wheel_model(context, &w, sector, whole));
done:
  bwi_wheel_close(&w);
  return status;
}

/* What the bonds of all sectors exert together; moments are about the origin. */
static bw_status add_bonds(bw_context *context, const bw_cyclic *cyclic, const bw_static *sector,
                           bw_static *whole) {
  whole->bond = BW_NEW0(context, bw_joint_force, sector->bond_count);
  if (!whole->bond)
    return BW_MEMORY;
  whole->bond_count = sector->bond_count;
  for (int b = 0; b < sector->bond_count; b++)
    for (int s = 0; s < cyclic->count; s++) {
      const bw_joint_force *own = &sector->bond[b];
      double rotation[9], force[3], moment[3], arm[3];
      bwi_cyclic_rotation(cyclic, s, rotation);
      bw_cross(cyclic->point, own->force, arm);
      for (int k = 0; k < 3; k++)
        arm[k] = own->moment[k] - arm[k]; /* about the axis's point */
      bwi_rotate(rotation, own->force, force);
      bwi_rotate(rotation, arm, moment);
      bw_cross(cyclic->point, force, arm);
      for (int k = 0; k < 3; k++) {
        whole->bond[b].force[k] += force[k];
        whole->bond[b].moment[k] += moment[k] + arm[k];
      }
    }
  return BW_OK;
}

bw_status bw_static_whole(bw_context *context, const bw_static *sector, bw_static **out) {
  bw_status status = BW_OK;
  bwi_wheel w;
  bw_model *model = NULL;
  bw_static *whole = NULL;
  BW_TRY(bwi_wheel_open(context, sector->cyclic, sector->model->material, &w));
  if (sector->model->object.revision != sector->revision)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the model has changed since it was solved: solve it again for the whole"));
  BW_TRY(bwi_wheel_model(context, &w, sector->model, &model));
  BW_TRY(bwi_static_new(context, model, &whole));
  whole->reaction = BW_NEW(context, double, 3 * (int64_t)w.mesh->node_count);
  BW_TRY_MEMORY(whole->reaction);
  bwi_wheel_expand(&w, 0, sector->displacement, NULL, 1, whole->displacement);
  bwi_wheel_add_forces(&w, sector->force, whole->force);
  bwi_wheel_add_forces(&w, sector->reaction, whole->reaction);
  BW_TRY(add_bonds(context, w.cyclic, sector, whole));
  whole->energy = w.cyclic->count * sector->energy;
  whole->residual = sector->residual;
  whole->report = sector->report;
  *out = whole;
  whole = NULL;
done:
  bw_release(whole);
  bw_release(model);
  bwi_wheel_close(&w);
  return status;
}

bw_status bw_modes_whole(bw_context *context, const bw_modes *sector, bw_modes **out) {
  bw_status status = BW_OK;
  bwi_wheel w;
  bwi_eigen_result result = {.count = sector->count,
                             .solves = sector->solves,
                             .recovered = sector->recovered,
                             .counted = sector->counted,
                             .tested = sector->tested,
                             .report = sector->report};
  BW_TRY(bwi_wheel_open(context, sector->cyclic, sector->material, &w));
  int64_t size = 3 * (int64_t)w.sector->node_count, whole = 3 * (int64_t)w.mesh->node_count;
  result.value = BW_NEW(context, double, result.count);
  result.residual = BW_NEW(context, double, result.count);
  result.vector = BW_NEW(context, double, result.count *whole);
  BW_TRY_MEMORY(result.value && result.residual && result.vector);
  for (int k = 0; k < sector->count; k++) {
    int diameter = sector->nodal_diameter[k];
    double norm = w.cyclic->count; /* the square of the wheel's, where the sector's is 1 */
    if (bwi_cyclic_parts(w.cyclic, diameter) == 2)
      norm /= 2;
    result.value[k] = sector->eigenvalue[k];
    result.residual[k] = sector->residual[k];
    bwi_wheel_expand(&w, diameter, sector->shape + k * size, sector->quadrature + k * size,
                     1 / sqrt(norm), result.vector + k * whole);
  }
  BW_TRY(bwi_modes_from(context, w.mesh, w.material, sector->rigid_count, &result, out));
done:
  bwi_eigen_result_clear(&result);
  bwi_wheel_close(&w);
  return status;
}
