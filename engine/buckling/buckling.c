/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors of the equations of a body. Where supports leave rigid-body motions free, fields are
 * those without them, K_sigma is P^T K_sigma P, and nothing is counted
 * (docs/theory/stability.md, "Free bodies"). */
#include "barwright/analysis.h"
#include "barwright/job.h"
#include "buckling/internal.h"
#include "linear/blas.h"
#include "linear/system_solver.h"
#include "model/internal.h"

/* ---- products -------------------------------------------------------------------------------- */

typedef struct pencil {
  bw_system *system;
  double *stress; /* K_sigma */
} pencil;

static bw_status multiply(bw_context *context, const bw_system *system, const double *values,
                          int block, int64_t count, const double *x, double *y) {
  bw_status status = bw_block_multiply(context, system->pattern, values, block, 3, count, x, y);
  for (int64_t k = 0; k < count; k++)
    bwi_keep_states(system->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC,
                    y + k * 3 * (int64_t)system->mesh->node_count);
  return status;
}

static bw_status stiffness(bw_context *context, void *data, int64_t count, const double *x,
                           double *y) {
  const pencil *p = data;
  return multiply(context, p->system, p->system->stiffness, 9, count, x, y);
}

static bw_status stress(bw_context *context, void *data, int64_t count, const double *x,
                        double *y) {
  const pencil *p = data;
  bw_status status = multiply(context, p->system, p->stress, 1, count, x, y);
  return status == BW_OK ? bwi_balance_fields(context, p->system->dof_map, count, y) : status;
}

static bw_status solve(bw_context *context, void *data, int64_t count, const double *f, double *y) {
  return bw_system_solve(context, ((pencil *)data)->system, count, f, y);
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  const bw_system *system = ((pencil *)data)->system;
  for (int64_t k = 0; k < count; k++)
    bwi_keep_states(system->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC,
                    x + k * 3 * (int64_t)system->mesh->node_count);
  return bwi_steady_fields(context, system->dof_map, count, x);
}

static bw_status between(bw_context *context, void *data, double s, int64_t *count, bool *trusted) {
  const pencil *p = data;
  const bw_system *system = p->system;
  bwi_matrix matrix = {.pattern = system->pattern,
                       .stiffness = system->stiffness,
                       .mass = p->stress,
                       .shift = s,
                       .dof_map = system->dof_map};
  return bwi_count_negative(context, system->factor->symbolic, &matrix, count, trusted);
}

/* ---- the analysis ---------------------------------------------------------------------------- */

static bw_status check_supports(bw_context *context, const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  char *text = NULL;
  if (dof_map->rigid_mode_count == 0)
    return BW_OK;
  BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  status = bw_fail(context, BW_UNCONSTRAINED,
                   "a body that can move freely has no load factors, because loads that keep their "
                   "directions turn it without resistance; %s. Add supports that constrain it, or "
                   "say that the loads turn with the body",
                   text);
done:
  bw_free(text);
  return status;
}

static bw_status find(bw_context *context, const bw_model *model, bw_system *system,
                      const double *displacement, const bw_buckling_options *given,
                      bw_buckling **buckling) {
  bw_status status = BW_OK;
  bw_buckling_options options;
  pencil p = {.system = system};
  bw_buckling *out = NULL;
  double start = bw_seconds();
  bwi_blas_enter();
  BW_TRY(bwi_buckling_options_check(context, given, &options));
  BW_TRY(options.loads_turn ? BW_OK : check_supports(context, system->dof_map));
  BW_TRY(system->iterative ? bw_system_factor(context, system) : bwi_need_factor(context, system));
  p.stress = BW_NEW(context, double, system->pattern->block_count);
  BW_TRY_MEMORY(p.stress);
  BW_TRY(bw_stress_stiffness(context, system->pattern, model, displacement, p.stress));
  bool is_free = system->dof_map->rigid_mode_count > 0;
  bwi_stability problem = {.size = 3 * (int64_t)system->mesh->node_count,
                           .dimension = system->dof_map->unknown_count,
                           .mesh = system->mesh,
                           .data = &p,
                           .stiffness = stiffness,
                           .stress = stress,
                           .solve = solve,
                           .project = project,
                           .between = is_free ? NULL : between};
  BW_TRY(bwi_buckling_empty(context, model, &out));
  BW_TRY(bwi_buckling_find(context, &problem, &options, out));
  out->report.bytes += (double)bwi_factor_bytes(system->factor);
  out->report.flops = 4.0 * (double)system->times.factor_entries * problem.solves;
  out->report.seconds = bw_seconds() - start;
  *buckling = out;
  out = NULL;
done:
  bwi_blas_leave();
  bw_release(out);
  bw_free(p.stress);
  return status;
}

bw_status bwi_buckling_refuse_contact(bw_context *context, const bw_static *solution) {
  if (!solution->in_contact)
    return BW_OK;
  return bw_fail(context, BW_UNSUPPORTED,
                 "forces of contact are among the loads of this static solution, and load "
                 "factors do not know contact: replace it by supports or bonds");
}

bw_status bw_buckling_of_static(bw_context *context, const bw_static *solution,
                                const bw_buckling_options *options, bw_buckling **buckling) {
  bw_status status = bw_model_refuse_joints(context, solution->model);
  if (status != BW_OK)
    return status;
  status = bwi_buckling_refuse_contact(context, solution);
  if (status != BW_OK)
    return status;
  if (!solution->system)
    return bw_fail(context, BW_UNSUPPORTED,
                   "buckling needs the equations of the static solution in this process: solve the "
                   "model by cholesky or pcg, not by an external solver or in an edit session, "
                   "and again where its bonds have changed");
  return find(context, solution->model, solution->system, solution->displacement, options,
              buckling);
}

bw_status bw_buckling_of_displacement(bw_context *context, bw_system *system,
                                      const double *displacement,
                                      const bw_buckling_options *options, bw_buckling **buckling) {
  bw_status status = BW_OK;
  bw_model *model = NULL;
  BW_TRY(bw_model_create(context, system->mesh, system->material, &model));
  BW_TRY(find(context, model, system, displacement, options, buckling));
done:
  bw_release(model);
  return status;
}

bw_status bw_buckling_error(bw_context *context, const bw_buckling *buckling, double *relative) {
  bw_status status = BW_OK;
  const bw_model *model = buckling->model;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  for (int k = 0; k < buckling->count; k++)
    BW_TRY(bw_shape_error(context, model->mesh, model->material, buckling->shape + k * size,
                          &relative[k]));
done:
  return status;
}
