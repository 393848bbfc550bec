/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The error of eigenvalues: a Rayleigh quotient is too high by the square of the energy error of
 * its shape, which patch recovery estimates. */
#include "barwright/analysis.h"

/* On tet10 recovery falls short of the square of the error: at boundaries, where patches are
 * one-sided. docs/theory/error_control.md has the figures. */
static double correction(const bw_mesh *mesh) {
  return mesh->order == 1 ? 1 : 1.5;
}

bw_status bw_shape_error(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         const double *shape, double *relative) {
  bw_status status = BW_OK;
  double above = 0, all = 0;
  double *error = BW_NEW(context, double, mesh->element_count);
  double *energy = BW_NEW(context, double, mesh->element_count);
  BW_TRY_MEMORY(error && energy);
  BW_TRY(bw_error_product(context, mesh, material, shape, shape, error));
  BW_TRY(bw_element_energy(context, mesh, material, shape, energy));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    above += error[e];
    all += 2 * energy[e];
  }
  *relative = all > 0 ? correction(mesh) * above / all : 0;
done:
  bw_free(error);
  bw_free(energy);
  return status;
}

bw_status bw_modes_error(bw_context *context, const bw_modes *modes, double *relative) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)modes->mesh->node_count;
  if (modes->components != 3 || !modes->material)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "Laplacian modes have no stress: their error is not estimated"));
  if (modes->cyclic)
    BW_TRY(bw_fail(
        context, BW_UNSUPPORTED,
        "the error of a sector's modes is not estimated: that of the modes of the whole is"));
  for (int k = 0; k < modes->count; k++)
    BW_TRY(bw_shape_error(context, modes->mesh, modes->material, modes->shape + k * size,
                          &relative[k]));
done:
  return status;
}
