/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elastic modes K u = lambda M u of constrained and unconstrained bodies, with the system's own
 * factor.
 *
 * The operator is P K_c^-1 P^T M: symmetric in M, zero on rigid-body motions, so no rigid mode
 * appears and none has to be separated from an elastic one. The Sturm count takes the unconstrained
 * K - sigma M, which is regular for sigma > 0; the rigid-body modes are subtracted from it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "eigen/modes.h"
#include "linear/system_solver.h"

void bw_modes_options_default(bw_modes_options *options) {
  *options = (bw_modes_options){
      .count = 15, .tolerance = 1e-8, .sturm = true, .seed = 1, .nodal_diameter = -1};
}

static void modes_destroy(void *object) {
  bw_modes *modes = object;
  bw_release(modes->mesh);
  bw_release(modes->material);
  bw_free(modes->eigenvalue);
  bw_free(modes->frequency);
  bw_free(modes->shape);
  bw_free(modes->residual);
  bw_free(modes->external);
  bw_release(modes->cyclic);
  bw_free(modes->nodal_diameter);
  bw_free(modes->quadrature);
  bw_free(modes);
}

static size_t modes_bytes(const void *object) {
  const bw_modes *modes = object;
  return sizeof *modes + (size_t)modes->count *
                             ((modes->cyclic ? 2 : 1) * (size_t)modes->components *
                                  (size_t)modes->mesh->node_count +
                              3) *
                             sizeof(double);
}

static const bw_kind modes_kind = {"modes", modes_destroy, modes_bytes};

bw_status bwi_modes_options_check(bw_context *context, const bw_modes_options *given,
                                  bw_modes_options *options) {
  bw_modes_options_default(options);
  if (given)
    *options = *given;
  if (options->count < 1)
    return bw_fail(context, BW_INVALID, "%d modes were requested: at least 1 expected",
                   options->count);
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance on modes is %g; it must lie between 0 and 1",
                   options->tolerance);
  return BW_OK;
}

void bwi_fix_sign(double *shape, int64_t size) {
  double largest = 0;
  for (int64_t i = 0; i < size; i++)
    largest = fmax(largest, fabs(shape[i]));
  for (int64_t i = 0; i < size; i++)
    if (fabs(shape[i]) >= largest * (1 - 1e-6)) {
      if (shape[i] < 0)
        for (int64_t k = 0; k < size; k++)
          shape[k] = -shape[k];
      return;
    }
}

bw_status bwi_modes_from(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         int rigid_count, bwi_eigen_result *result, bw_modes **out) {
  int components = material ? 3 : 1;
  int64_t size = (int64_t)mesh->node_count * components;
  bw_modes *modes = BW_NEW0(context, bw_modes, 1);
  if (!modes)
    return BW_MEMORY;
  bw_object_init(modes, &modes_kind);
  modes->mesh = bw_retain(mesh);
  modes->material = bw_retain(material);
  modes->count = result->count;
  modes->components = components;
  modes->rigid_count = rigid_count;
  modes->solves = result->solves;
  modes->recovered = result->recovered;
  modes->counted = result->counted;
  modes->tested = result->tested;
  modes->report = result->report;
  if (material && material->density > 0) {
    modes->frequency = BW_NEW(context, double, result->count);
    if (!modes->frequency) {
      bw_release(modes);
      return BW_MEMORY;
    }
    for (int k = 0; k < result->count; k++)
      modes->frequency[k] = sqrt(fmax(result->value[k], 0)) / (2 * 3.14159265358979323846);
  }
  modes->eigenvalue = result->value;
  modes->shape = result->vector;
  modes->residual = result->residual;
  result->value = result->vector = result->residual = NULL;
  for (int k = 0; k < modes->count; k++)
    bwi_fix_sign(modes->shape + k * size, size);
  *out = modes;
  return BW_OK;
}

enum { SIDES = 8 }; /* fields whose products are taken at once: these are packed in between */

/* ---- the elastic problem ------------------------------------------------------------------- */

typedef struct elastic {
  bw_system *system;
  bwi_system_operator preconditioner; /* in place of the factor */
  bool constrained;                   /* some component is prescribed */
  bwi_symbolic *unconstrained;
} elastic;

static bw_status elastic_solve(bw_context *context, void *data, int64_t count, const double *f,
                               double *y) {
  return bw_system_solve(context, ((elastic *)data)->system, count, f, y);
}

static bw_status elastic_precondition(bw_context *context, void *data, int64_t count,
                                      const double *f, double *y) {
  return bwi_system_operator_apply(context, &((elastic *)data)->preconditioner, count, f, y);
}

static bw_status multiply(bw_context *context, const elastic *problem, bool mass, int64_t count,
                          const double *x, double *y) {
  bw_system *system = problem->system;
  const bw_dof_map *dof_map = system->dof_map;
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  for (int64_t first = 0; first < count && status == BW_OK; first += SIDES) {
    int64_t sides = count - first < SIDES ? count - first : SIDES;
    const double *from = x + first * size;
    double *to = y + first * size;
    status = mass ? bw_block_multiply(context, system->pattern, system->mass, 1, 3, sides, from, to)
                  : bwi_system_multiply(context, system, sides, from, to, NULL);
  }
  if (problem->constrained)
    for (int64_t k = 0; status == BW_OK && k < count; k++)
      bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, y + k * size);
  return status;
}

static bw_status elastic_mass(bw_context *context, void *data, int64_t count, const double *x,
                              double *y) {
  return multiply(context, data, true, count, x, y);
}

static bw_status elastic_stiffness(bw_context *context, void *data, int64_t count, const double *x,
                                   double *y) {
  return multiply(context, data, false, count, x, y);
}

typedef struct unknowns {
  const bw_dof_map *dof_map;
  double *x;
} unknowns;

static bw_status keep_unknowns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const unknowns *u = data;
  int64_t size = 3 * (int64_t)u->dof_map->mesh->node_count;
  for (int64_t k = begin; k < end; k++)
    bwi_keep_states(u->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, u->x + k * size);
  return BW_OK;
}

static bw_status elastic_project(bw_context *context, void *data, int64_t count, double *x) {
  unknowns u = {((elastic *)data)->system->dof_map, x};
  bw_status status = bw_parallel(context, count, 1, keep_unknowns, &u);
  return status == BW_OK ? bwi_steady_fields(context, u.dof_map, count, x) : status;
}

static bw_status elastic_below(bw_context *context, void *data, double sigma, int64_t *count,
                               bool *trusted) {
  bw_status status = BW_OK;
  elastic *problem = data;
  const bw_system *system = problem->system;
  const bw_dof_map *dof_map = system->dof_map;
  bwi_symbolic *symbolic = system->factor->symbolic;
  bwi_matrix matrix = {.pattern = system->pattern,
                       .stiffness = system->stiffness,
                       .mass = system->mass,
                       .shift = -sigma,
                       .dof_map = dof_map};
  int64_t negative = 0;
  if (dof_map->rigid_mode_count > 0 && !problem->unconstrained) {
    int64_t entries = 3 * (int64_t)system->mesh->node_count;
    int32_t *unknown = BW_NEW(context, int32_t, entries);
    if (!unknown)
      return BW_MEMORY;
    for (int64_t i = 0; i < entries; i++)
      unknown[i] = dof_map->state[i] == BW_DOF_PRESCRIBED ? -1 : 0;
    status = bwi_symbolic_create(context, symbolic->order, 3, unknown, &problem->unconstrained);
    bw_free(unknown);
    if (status != BW_OK)
      return status;
  }
  if (problem->unconstrained)
    symbolic = problem->unconstrained;
  BW_TRY(bwi_count_negative(context, symbolic, &matrix, &negative, trusted));
  *count = negative - dof_map->rigid_mode_count;
done:
  return status;
}

static bool is_constrained(const bw_system *system) {
  for (int64_t i = 0; i < 3 * (int64_t)system->mesh->node_count; i++)
    if (system->dof_map->state[i] == BW_DOF_PRESCRIBED)
      return true;
  return false;
}

static bwi_eigen_problem elastic_problem(elastic *problem) {
  const bw_dof_map *dof_map = problem->system->dof_map;
  return (bwi_eigen_problem){.size = 3 * (int64_t)dof_map->mesh->node_count,
                             .mesh = dof_map->mesh,
                             .data = problem,
                             .mass = elastic_mass,
                             .stiffness = elastic_stiffness,
                             .project = elastic_project,
                             .dimension = dof_map->unknown_count};
}

static bw_status modes_by_factor(bw_context *context, bw_system *system,
                                 const bw_modes_options *options, bw_modes **modes) {
  bw_status status = BW_OK;
  bwi_eigen_result result = {0};
  elastic problem = {.system = system, .constrained = is_constrained(system)};
  BW_TRY(bwi_need_factor(context, system));
  bwi_eigen_problem eigen = elastic_problem(&problem);
  eigen.solve = elastic_solve;
  eigen.below = elastic_below;
  BW_TRY(bwi_eigen_lowest(context, &eigen, options, &result));
  result.report.bytes += (double)bwi_factor_bytes(system->factor);
  result.report.flops = 4.0 * (double)system->times.factor_entries * result.solves;
  BW_TRY(bwi_modes_from(context, system->mesh, system->material, system->dof_map->rigid_mode_count,
                        &result, modes));
done:
  bw_release(problem.unconstrained);
  bwi_eigen_result_clear(&result);
  return status;
}

/* ---- without a factor ------------------------------------------------------------------------ */

static bool is_automatic(const bw_eigensolver *solver) {
  return !solver || solver->options.kind == BW_EIGENSOLVER_AUTO;
}

/* By LOBPCG with the preconditioner that the system has. */
static bw_status modes_by_pcg(bw_context *context, bw_system *system, bwi_way way,
                              const bw_modes_options *given, bw_modes **modes) {
  bw_status status = BW_OK;
  bwi_eigen_result result = {0};
  bw_modes_options options = *given;
  bw_eigensolver *solver = NULL;
  elastic problem = {.system = system, .constrained = is_constrained(system)};
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  how.kind = BW_EIGENSOLVER_LOBPCG;
  BW_TRY(bw_eigensolver_create(context, &how, &solver));
  BW_TRY(bwi_system_mass(context, system));
  if (way == BWI_BY_TWO_LEVEL)
    BW_TRY(bwi_two_level_probe(context, system->two_level->preconditioner, options.count));
  BW_TRY(bwi_system_operator_open(context, system, way, &problem.preconditioner));
  bwi_eigen_problem eigen = elastic_problem(&problem);
  eigen.precondition = elastic_precondition;
  eigen.preconditioner = bwi_system_operator_word(&problem.preconditioner);
  options.solver = solver;
  BW_TRY(bwi_eigen_lowest(context, &eigen, &options, &result));
  if (is_automatic(given->solver))
    snprintf(result.report.reason, sizeof result.report.reason, "%s",
             system->solver ? "the equations have a preconditioner and no factor"
                            : system->report.reason);
  if (way == BWI_BY_TWO_LEVEL)
    bwi_two_level_say(system->two_level->preconditioner, &result.report);
  result.report.bytes += way == BWI_BY_TWO_LEVEL ? (double)bw_bytes(system->two_level)
                                                 : (double)bw_bytes(system->preconditioner);
  BW_TRY(bwi_modes_from(context, system->mesh, system->material, system->dof_map->rigid_mode_count,
                        &result, modes));
done:
  bwi_system_operator_close(&problem.preconditioner);
  bw_release(solver);
  bwi_eigen_result_clear(&result);
  return status;
}

bw_status bwi_modes_elastic(bw_context *context, bw_system *system, const bw_modes_options *given,
                            bw_modes **modes) {
  bw_status status = BW_OK;
  bw_modes_options options;
  BW_TRY(bwi_modes_options_check(context, given, &options));
  if (!system->iterative)
    return modes_by_factor(context, system, &options, modes);
  if (!is_automatic(options.solver) && options.solver->options.kind != BW_EIGENSOLVER_LOBPCG)
    return bw_fail(context, BW_INVALID,
                   "the eigensolver %s needs a factor, and these equations are solved by pcg: take "
                   "lobpcg, or solve them by cholesky",
                   bw_eigensolver_name(options.solver));
  BW_TRY(bwi_system_restore(context, system));
  BW_TRY(modes_by_pcg(context, system, bwi_system_way(system), &options, modes));
done:
  return status;
}

/* The preconditioner of LOBPCG that a system gets where one was asked for, or it has none: *way.
 * *usable is false where the equations are singular for it. */
static bw_status give_preconditioner(bw_context *context, const bw_model *model, bw_system *system,
                                     const bw_solver *given, bwi_way *way, bool *usable) {
  bool made;
  *way = !given                                       ? bwi_way_without_factor(system)
         : given->options.kind == BW_SOLVER_TWO_LEVEL ? BWI_BY_TWO_LEVEL
                                                      : BWI_BY_PCG;
  bw_status status = bwi_system_make(context, model, system, *way, given, NULL, 0, &made);
  *usable = status == BW_OK;
  if (status == BW_SINGULAR) {
    bw_clear_failure(context);
    status = BW_OK;
  }
  return status;
}

/* By LOBPCG, as it was asked for. *found is false where the system has a factor, or its
 * preconditioner, and no other is asked for, and where the equations are singular for that. */
static bw_status modes_by_lobpcg(bw_context *context, const bw_model *model, bw_system *system,
                                 const bw_modes_options *given, bool *found, bw_modes **modes) {
  bw_status status = BW_OK;
  bw_modes_options options;
  bwi_way way;
  const bw_solver *preconditioner = given->solver->options.preconditioner;
  if (!preconditioner && (system->factor || system->iterative))
    return BW_OK;
  BW_TRY(bwi_modes_options_check(context, given, &options));
  BW_TRY(give_preconditioner(context, model, system, preconditioner, &way, found));
  if (*found)
    BW_TRY(modes_by_pcg(context, system, way, &options, modes));
done:
  return status;
}

bw_status bwi_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                             const bw_modes_options *options, bw_system **system,
                             bw_modes **modes) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  bw_system *used = NULL;
  bwi_symbolic *old = NULL;
  const bw_eigensolver *solver = options ? options->solver : NULL;
  bool found = false;
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  if (given && bwi_system_serves(given, model, dof_map))
    used = bw_retain(given);
  else {
    if (!bwi_system_reusable(given, model->mesh))
      given = NULL;
    BW_TRY(bwi_system_begin(context, model->mesh, model->material, dof_map, given, &used));
  }
  if (given && given->factor)
    old = given->factor->symbolic;
  if (is_automatic(solver)) {
    if (!used->iterative && !used->factor) /* else the report says by what, and why */
      BW_TRY(bwi_system_prepare(context, model, used, NULL, old));
  } else if (solver->options.kind == BW_EIGENSOLVER_LOBPCG)
    BW_TRY(modes_by_lobpcg(context, model, used, options, &found, modes));
  if (!found) {
    if (!is_automatic(solver) &&
        !(used->iterative && solver->options.kind == BW_EIGENSOLVER_LOBPCG))
      BW_TRY(bwi_system_factor(context, used, NULL, old, bw_available_memory()));
    BW_TRY(bwi_modes_elastic(context, used, options, modes));
  }
done:
  if (system)
    *system = bw_retain(used);
  bw_release(used);
  bw_release(dof_map);
  return status;
}
