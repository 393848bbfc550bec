/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions, however K v = f is solved: u = u0 + v with u0 the prescribed values, K v = f -
 * K u0 at the unknowns. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"
#include "statics/internal.h"

enum { REFINEMENTS = 3 };

/* A solution that leaves more of the load is none. */
static const double max_residual = 0.1;

static void static_destroy(void *object) {
  bw_static *result = object;
  bw_release(result->model);
  bw_release(result->system);
  bw_release(result->cyclic);
  bw_free(result->displacement);
  bw_free(result->force);
  bw_free(result->reaction);
  bw_free(result->bond);
  bw_free(result->attachment);
  bw_free(result->coupling);
  bw_free(result->joint_force);
  bw_free(result->external);
  bw_free(result);
}

static size_t static_bytes(const void *object) {
  const bw_static *result = object;
  size_t fields = result->joint_force ? 12 : 9;
  return sizeof *result + fields * (size_t)result->model->mesh->node_count * sizeof(double);
}

static const bw_kind static_kind = {"static solution", static_destroy, static_bytes};

/* The load's work on each rigid-body mode, against the work it would do were all of it along the
 * motion. */
static bw_status check_balance(bw_context *context, const bw_dof_map *dof_map, const double *force,
                               double tolerance) {
  bw_status status = BW_OK;
  char *text = NULL;
  int32_t nodes = dof_map->mesh->node_count, motions = dof_map->rigid_mode_count;
  double *part = BW_NEW(context, double, motions);
  if (!part)
    return BW_MEMORY;
  bw_rigid_modes_dot(dof_map, force, part);
  int worst = -1;
  double excess = tolerance, resultant[3] = {0};
  for (int m = 0; m < motions; m++) {
    const bw_rigid_mode *motion = &dof_map->rigid_mode[m];
    double size = 0;
    for (int64_t i = 0; i < nodes; i++) {
      if (dof_map->mesh->component[i] != motion->component)
        continue;
      double shift[3];
      bwi_motion_at(motion, dof_map->mesh->node + 3 * i, shift);
      size += bw_norm(shift) * bw_norm(force + 3 * i);
    }
    if (size > 0 && fabs(part[m]) / size > excess) {
      excess = fabs(part[m]) / size;
      worst = m;
    }
  }
  if (worst >= 0) {
    for (int64_t i = 0; i < nodes; i++)
      for (int c = 0; c < 3; c++)
        resultant[c] += force[3 * i + c];
    BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
    status = bw_fail(context, BW_UNCONSTRAINED,
                     "the load is not in equilibrium on a body that can move freely; %s. The load "
                     "acts on rigid-body mode %d, %s: the fraction %.3g of its magnitude is along "
                     "that mode (allowed: %.3g); its resultant is (%g, %g, %g) N. Add supports, "
                     "balance the load, or use inertia relief",
                     text, worst + 1, dof_map->rigid_mode[worst].text, excess, tolerance,
                     resultant[0], resultant[1], resultant[2]);
    bw_detail_number(context, "motions", motions);
    bw_detail_text(context, "motion", dof_map->rigid_mode[worst].text);
  }
done:
  bw_free(part);
  bw_free(text);
  return status;
}

bw_status bwi_static_new(bw_context *context, const bw_model *model, bw_static **out) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  bw_static *result = BW_NEW0(context, bw_static, 1);
  if (!result)
    return BW_MEMORY;
  bw_object_init(result, &static_kind);
  result->report.solver = result->report.backend = result->report.preconditioner = "";
  result->model = bw_retain(model);
  result->revision = model->object.revision;
  result->cyclic = bw_retain(model->cyclic);
  result->displacement = BW_NEW(context, double, size);
  result->force = BW_NEW(context, double, size);
  BW_TRY_MEMORY(result->displacement && result->force);
  *out = result;
  result = NULL;
done:
  bw_release(result);
  return status;
}

bw_status bwi_static_begin(bw_context *context, const bw_model *model,
                           const bw_statics_options *options, const bw_dof_map *dof_map,
                           bw_static **out) {
  bw_status status = BW_OK;
  bw_statics_options opts = options ? *options : (bw_statics_options){0};
  if (opts.tolerance == 0)
    opts.tolerance = 1e-6;
  if (!(opts.tolerance > 0))
    return bw_fail(context, BW_INVALID, "the tolerance on balance is %g; it must be positive",
                   opts.tolerance);
  bw_static *result = NULL;
  BW_TRY(bwi_static_new(context, model, &result));
  BW_TRY(bw_model_check_absorbed(context, model, dof_map));
  BW_TRY(bw_model_force_vector(context, model, result->force));
  if (dof_map->rigid_mode_count > 0 && !opts.inertia_relief)
    BW_TRY(check_balance(context, dof_map, result->force, opts.tolerance));
done:
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}

/* product = K x, by the system or else the solver; noise may be NULL. */
static bw_status multiply(bw_context *context, bw_system *system, const bwi_static_solver *solver,
                          const double *x, double *product, double *noise) {
  return system ? bwi_system_multiply(context, system, 1, x, product, noise)
                : solver->multiply(context, solver->data, x, product, noise);
}

/* Where K is nearly singular, every solver may end with displacements whose forces rounding hides.
 * Of a load that inertia balances to nothing (a body that falls) only rounding is left. */
static bw_status check_residual(bw_context *context, const bwi_static_solver *solver, double scale,
                                const bw_static *result) {
  int64_t size = 3 * (int64_t)result->model->mesh->node_count;
  if (solver->once || solver->multiply || result->residual <= fmax(max_residual, solver->refine_to))
    return BW_OK;
  if (result->residual * scale < 1e-13 * sqrt(bwi_dot(size, result->force, result->force)))
    return BW_OK;
  bw_fail(context, BW_SINGULAR,
          "the stiffness is so nearly singular that double precision cannot tell: the residual of "
          "the solution is %.2g of the load. Parts that touch only in a node or an edge rotate "
          "there, and elements almost without volume have almost no stiffness. Join the parts "
          "properly, or mesh again",
          result->residual);
  bw_detail_number(context, "residual", result->residual);
  return BW_SINGULAR;
}

/* Room for numbers where there is none yet. */
static bw_status reserve(bw_context *context, int64_t size, double **numbers) {
  if (!*numbers)
    *numbers = BW_NEW(context, double, size);
  return *numbers ? BW_OK : BW_MEMORY;
}

static void swap(double **a, double **b) {
  double *first = *a;
  *a = *b;
  *b = first;
}

bw_status bwi_static_solve(bw_context *context, const bw_dof_map *dof_map, bw_system *system,
                           const bwi_static_solver *solver, bw_static *result) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  bool balanced = dof_map->rigid_mode_count > 0;
  double *load = balanced ? BW_NEW(context, double, size) : result->force;
  double *work = BW_NEW(context, double, size);
  double *step = BW_NEW(context, double, size);
  double *product = NULL; /* K step; K u is then in the reactions' place */
  BW_TRY_MEMORY(load && work && step);
  if (balanced) {
    memcpy(load, result->force, (size_t)size * sizeof(double));
    bw_rigid_modes_balance(dof_map, load);
  }
  /* work = load - K u at the unknowns, for u = u0 at first and the solution later */
  bwi_prescribed_field(dof_map, result->displacement);
  memcpy(work, load, (size_t)size * sizeof(double));
  if (dof_map->prescribed) {
    BW_TRY(multiply(context, system, solver, result->displacement, step, NULL));
    for (int64_t i = 0; i < size; i++)
      work[i] -= step[i];
  }
  bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, work);
  double scale = sqrt(bwi_dot(size, work, work));
  result->residual = scale > 0 ? 1 : 0;
  int max = solver->once ? 0 : REFINEMENTS;
  for (int pass = 0; scale > 0 && pass <= max && result->residual > solver->refine_to; pass++) {
    BW_TRY(solver->solve(context, solver->data, work, step));
    for (int64_t i = 0; i < size; i++)
      step[i] += result->displacement[i];
    if (balanced && !dof_map->prescribed)
      bw_rigid_modes_remove(dof_map, step);
    double noise = 0;
    BW_TRY(reserve(context, size, &product)); /* the solver's own room is free by now */
    BW_TRY(multiply(context, system, solver, step, product, &noise));
    for (int64_t i = 0; i < size; i++)
      work[i] = load[i] - product[i];
    bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, work);
    double residual = sqrt(bwi_dot(size, work, work)) / scale;
    if (!isfinite(residual))
      BW_TRY(bw_fail(context, BW_SINGULAR, "the solution is not finite"));
    if (residual >= result->residual && pass > 0)
      break;
    bool enough = residual > 0.25 * result->residual || residual * scale <= noise;
    result->residual = residual;
    swap(&result->displacement, &step);
    swap(&result->reaction, &product);
    if (enough)
      break;
  }
  BW_TRY(check_residual(context, solver, scale, result));
  if (!result->reaction) {
    BW_TRY(reserve(context, size, &result->reaction));
    BW_TRY(multiply(context, system, solver, result->displacement, result->reaction, NULL));
  }
  for (int64_t i = 0; i < size; i++) {
    result->energy += 0.5 * result->displacement[i] * result->reaction[i];
    result->reaction[i] -= load[i];
  }
  bwi_keep_states(dof_map, 1u << BW_DOF_PRESCRIBED, result->reaction);
done:
  if (balanced)
    bw_free(load);
  bw_free(work);
  bw_free(step);
  bw_free(product);
  return status;
}
