/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "dynamics/equations.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"

bw_status bwi_equations_begin(bw_context *context, const bw_model *model, bw_system *system,
                              bwi_equations *e) {
  bw_status status = BW_OK;
  *e = (bwi_equations){.size = 3 * (int64_t)model->mesh->node_count};
  if (!system) {
    BW_TRY(bwi_joined_fields_open(context, model, &e->joined));
    e->dof_map = e->joined.equations.reduction.dof_map;
    e->pattern = e->joined.equations.pattern;
    e->stiffness = e->joined.equations.stiffness;
    e->unknown_count = e->joined.equations.reduction.unknown_count;
    e->rigid_count = e->joined.equations.rigid_count;
    goto done;
  }
  e->system = bw_retain(system);
  BW_TRY(bwi_system_mass(context, system));
  BW_TRY(bw_system_stiffness(context, system));
  e->dof_map = system->dof_map;
  e->pattern = system->pattern;
  e->stiffness = system->stiffness;
  e->unknown_count = system->dof_map->unknown_count;
  e->rigid_count = system->dof_map->rigid_mode_count;
done:
  return status;
}

bw_status bwi_equations_open(bw_context *context, const bw_model *model, bw_system *system,
                             bwi_equations *e) {
  bw_status status = system && !system->factor ? bw_system_factor(context, system) : BW_OK;
  *e = (bwi_equations){0};
  if (status == BW_OK)
    status = bwi_equations_begin(context, model, system, e);
  if (status == BW_OK && !system)
    status = bwi_joined_factor(context, &e->joined);
  return status;
}

void bwi_equations_clear(bwi_equations *e) {
  bw_release(e->system);
  bwi_joined_fields_clear(&e->joined);
  *e = (bwi_equations){0};
}

static void keep_unknowns(const bwi_equations *e, double *f) {
  if (e->system)
    bwi_keep_states(e->system->dof_map, 1u << BW_DOF_UNKNOWN, f);
}

bw_status bwi_equations_mass(bw_context *context, const bwi_equations *e, const double *u,
                             double *f) {
  return e->system ? bw_block_multiply(context, e->pattern, e->system->mass, 1, 3, 1, u, f)
                   : bwi_joined_mass(context, &e->joined, u, f);
}

bw_status bwi_equations_stiffness(bw_context *context, const bwi_equations *e, const double *u,
                                  double *f) {
  bw_status status = e->system ? bwi_system_multiply(context, e->system, 1, u, f, NULL)
                               : bwi_joined_stiffness(context, &e->joined, u, f);
  keep_unknowns(e, f);
  return status;
}

bw_status bwi_equations_elastic(bw_context *context, const bwi_equations *e, const double *u,
                                double *f) {
  return e->system ? bw_block_multiply(context, e->pattern, e->stiffness, 9, 3, 1, u, f)
                   : bwi_joined_stiffness(context, &e->joined, u, f);
}

bw_status bwi_equations_values(bw_context *context, const bwi_equations *e, const double *values,
                               const double *u, double *f) {
  bw_status status = bw_block_multiply(context, e->pattern, values, 9, 3, 1, u, f);
  keep_unknowns(e, f);
  return status;
}

bw_status bwi_equations_solve(bw_context *context, const bwi_equations *e, const double *f,
                              double *u) {
  return e->system ? bw_system_solve(context, e->system, 1, f, u)
                   : bwi_joined_solve(context, &e->joined, f, u);
}

bw_status bwi_equations_force(bw_context *context, const bw_model *model, double *f) {
  bw_status status = bw_model_force_vector(context, model, f);
  bwi_point_loads(model, f);
  bwi_point_weights(model, f);
  return status;
}

bw_status bwi_equations_largest(bw_context *context, const bwi_equations *e, const double *f,
                                double *largest) {
  bw_status status = BW_OK;
  double *free = NULL;
  if (!e->system)
    return bwi_joined_largest(context, &e->joined, f, largest);
  free = BW_NEW(context, double, e->size);
  BW_TRY_MEMORY(free);
  memcpy(free, f, (size_t)e->size * sizeof *free);
  keep_unknowns(e, free);
  *largest = 0;
  for (int64_t i = 0; i < e->size; i++)
    *largest = fmax(*largest, fabs(free[i]));
done:
  bw_free(free);
  return status;
}

bw_status bwi_equations_left_out(bw_context *context, const bwi_equations *e, const double *given,
                                 const double *taken, double *part) {
  bw_status status = BW_OK;
  double *off = BW_NEW(context, double, e->size), *product = BW_NEW(context, double, e->size);
  BW_TRY_MEMORY(off && product);
  BW_TRY(bwi_equations_mass(context, e, given, product));
  double whole = bwi_dot(e->size, given, product);
  for (int64_t i = 0; i < e->size; i++)
    off[i] = given[i] - taken[i];
  bwi_keep_states(e->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, off);
  BW_TRY(bwi_equations_mass(context, e, off, product));
  *part = whole > 0 ? sqrt(fmax(bwi_dot(e->size, off, product), 0) / whole) : 0;
done:
  bw_free(off);
  bw_free(product);
  return status;
}

bw_status bwi_equations_system(bw_context *context, const bw_model *model,
                               const bw_dof_map *dof_map, bw_system *given, bw_system **system) {
  if (given && bwi_system_serves(given, model, dof_map)) {
    *system = bw_retain(given);
    return BW_OK;
  }
  return bwi_system_begin(context, model->mesh, model->material, dof_map,
                          bwi_system_reusable(given, model->mesh) ? given : NULL, system);
}

/* Of modal mass 1, held where the model is, and x = w^2 K^-1 M x: the difference in the norm of K,
 * where w is the size of each side. It also sees where x opens a bond. */
bw_status bwi_equations_check_modes(bw_context *context, const bw_model *model,
                                    const bwi_equations *e, const bw_modes *modes) {
  static const double residual_limit = 1e-4;
  bw_status status = BW_OK;
  int64_t size = e->size;
  double *work = BW_NEW(context, double, 3 * size);
  BW_TRY_MEMORY(work);
  double *product = work + size, *answer = product + size;
  bool fits =
      modes->mesh == model->mesh && modes->components == 3 && modes->frequency && modes->count > 0;
  for (int k = 0; fits && k < modes->count; k++) {
    const double *shape = modes->shape + k * size;
    double square = modes->eigenvalue[k];
    memcpy(work, shape, (size_t)size * sizeof *work);
    bwi_keep_states(e->dof_map, 1u << BW_DOF_PRESCRIBED, work);
    fits = bwi_dot(size, work, work) <= 1e-16 * bwi_dot(size, shape, shape);
    BW_TRY(bwi_equations_mass(context, e, shape, work));
    fits = fits && fabs(bwi_dot(size, shape, work) - 1) < 1e-6;
    BW_TRY(bwi_equations_solve(context, e, work, answer));
    for (int64_t i = 0; i < size; i++)
      answer[i] = square * answer[i] - shape[i];
    BW_TRY(bwi_equations_elastic(context, e, answer, product));
    fits = fits && bwi_dot(size, product, answer) <= residual_limit * residual_limit * square;
  }
  if (!fits)
    status =
        bw_fail(context, BW_INVALID,
                "the modes are not elastic modes of this model: compute them of the same mesh, "
                "material, supports and joints");
done:
  bw_free(work);
  return status;
}
