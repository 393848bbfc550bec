/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What solves a system's equations (system_solver.h), and which of them where none is asked for.
 *
 * A factor serves any number of right-hand sides: each costs two passes over it, where iterations
 * cost some fifteen over the matrix. So it is taken unless it is large. */
#include "linear/system_solver.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "linear/external.h"

enum { SIDES = BWI_SMOOTHER_SIDES };

/* ---- what is asked for ----------------------------------------------------------------------- */

bw_status bwi_solver_request(bw_context *context, const bw_solver *solver, double tolerance,
                             bwi_request *request) {
  *request = (bwi_request){.tolerance = tolerance, .max_iterations = BWI_PCG_ITERATIONS};
  if (!solver)
    return BW_OK;
  const bw_solver *m = solver->options.preconditioner;
  switch (solver->options.kind) {
  case BW_SOLVER_CHOLESKY: /* in single precision it is a preconditioner */
    request->way = solver->options.precision == 32 ? BWI_BY_PCG : BWI_BY_FACTOR;
    request->preconditioner = solver;
    return BW_OK;
  case BW_SOLVER_PCG:
    if (solver->options.tolerance > 0)
      request->tolerance = solver->options.tolerance;
    if (solver->options.max_iterations > 0)
      request->max_iterations = solver->options.max_iterations;
    request->way = m && m->options.kind != BW_SOLVER_TWO_LEVEL ? BWI_BY_PCG : BWI_BY_TWO_LEVEL;
    request->preconditioner = m;
    return BW_OK;
  default:
    return bwi_solver_refused(context, solver);
  }
}

bool bwi_solver_is_external(const bw_solver *solver) {
  bw_solver_kind kind = BW_SOLVER_CHOLESKY;
  if (solver && solver->options.kind == BW_SOLVER_PCG) {
    solver = solver->options.preconditioner;
    kind = BW_SOLVER_AMG;
  }
  return solver && solver->options.kind == kind && solver->options.backend == BW_BACKEND_PETSC;
}

int bwi_pcg_break_even(const bwi_two_level_solver *solver, double available, int max) {
  const bwi_cost_prediction *cost = &solver->prediction;
  if (cost->factor_bytes > available)
    return max;
  double break_even = fmax(cost->factor, 2 * bwi_predicted_next(solver)) / cost->one_iteration;
  return break_even < max ? (int)break_even : max;
}

/* ---- preparation ----------------------------------------------------------------------------- */

bwi_way bwi_way_without_factor(const bw_system *system) {
  return bwi_two_level_applies(system) ? BWI_BY_TWO_LEVEL : BWI_BY_PCG;
}

bwi_way bwi_system_way(const bw_system *system) {
  if (!system->iterative)
    return BWI_BY_FACTOR;
  if (!system->solver)
    return bwi_way_without_factor(system);
  const bw_solver *m = system->solver->options.preconditioner;
  bool two_level = system->solver->options.kind == BW_SOLVER_PCG &&
                   (!m || m->options.kind == BW_SOLVER_TWO_LEVEL);
  return two_level ? BWI_BY_TWO_LEVEL : BWI_BY_PCG;
}

bw_status bwi_system_make(bw_context *context, const bw_model *model, bw_system *system,
                          bwi_way way, const bw_solver *preconditioner, bwi_symbolic *old,
                          double available, bool *made) {
  const bwi_two_level_solver *l = system->two_level;
  bwi_system_forget(system); /* its memory first */
  *made = way == BWI_BY_TWO_LEVEL
              ? !l || !l->preconditioner
              : !bwi_preconditioner_serves(system->preconditioner, preconditioner);
  return way == BWI_BY_TWO_LEVEL
             ? bwi_two_level_make(context, model, system)
             : bwi_system_precondition(context, system, preconditioner, old, available);
}

bool bwi_factor_replaces(bw_context *context, const bw_system *system, bw_status status,
                         int iterations, double available, char reason[160]) {
  const char *name = bwi_two_level_applies(system) ? "two-level PCG" : "multigrid PCG";
  bool slow = status == BW_CONVERGENCE && system->two_level->prediction.factor_bytes <= available;
  if (!slow && status != BW_SINGULAR && status != BW_LIMIT)
    return false;
  bw_clear_failure(context);
  if (slow)
    bw_warn(context,
            "%s did not converge in %d iterations; a Cholesky factorisation gives the solution",
            name, iterations);
  snprintf(reason, 160, slow ? "%s did not converge" : "the stiffness is not one for %s", name);
  return true;
}

double bwi_solve_tolerance(const bw_system *system) {
  double given = system->solver ? system->solver->options.tolerance : 0;
  if (system->external)
    return system->external->report.energy_error;
  return !system->iterative ? 0 : given > 0 ? given : BWI_SOLVE_TO;
}

static bw_status by_factor(bw_context *context, bw_system *system, const bw_solver *solver,
                           bwi_symbolic *old, double available, const char *reason) {
  bw_status status = BW_OK;
  BW_TRY(bwi_system_factor(context, system, solver, old, available));
  bwi_system_report(system, BWI_BY_FACTOR, solver, reason);
done:
  return status;
}

/* The system is solved by PCG from now on. */
static bw_status by_iterations(bw_context *context, const bw_model *model, bw_system *system,
                               const bw_solver *solver, bwi_way way,
                               const bw_solver *preconditioner, bwi_symbolic *old, double available,
                               const char *reason) {
  bw_status status = BW_OK;
  bool made;
  BW_TRY(bwi_system_make(context, model, system, way, preconditioner, old, available, &made));
  bw_retain(solver);
  bw_release(system->solver);
  system->solver = solver;
  system->iterative = true;
  bwi_system_report(system, way, solver, reason);
done:
  return status;
}

/* What an iterative system is solved by. */
static bw_status restore(bw_context *context, bw_system *system, bwi_request *request) {
  bw_status status = BW_OK;
  BW_TRY(bwi_solver_request(context, system->solver, BWI_SOLVE_TO, request));
  request->way = bwi_system_way(system);
  if (request->way == BWI_BY_PCG)
    BW_TRY(bwi_system_precondition(context, system, request->preconditioner, NULL,
                                   bw_available_memory()));
done:
  return status;
}

bw_status bwi_system_restore(bw_context *context, bw_system *system) {
  bwi_request request;
  return restore(context, system, &request);
}

static bw_status without_factor(bw_context *context, const bw_model *model, bw_system *system,
                                const char *reason) {
  return by_iterations(context, model, system, NULL, bwi_way_without_factor(system), NULL, NULL, 0,
                       reason);
}

/* Whether a factor is too large, and the sentence that says so. */
static bw_status is_large(bw_context *context, bw_system *system, double available, bool *large,
                          char reason[160]) {
  bw_status status = BW_OK;
  double max = fmin(BWI_LARGE_FACTOR, available);
  *large = false;
  if (system->factor || system->dof_map->unknown_count < BWI_SMALL_SYSTEM)
    return BW_OK;
  if (!system->two_level)
    BW_TRY(bwi_two_level_predict(context, system));
  double bytes = system->two_level->prediction.factor_bytes;
  *large = bytes > max;
  snprintf(reason, 160, "a factor is predicted to take %.2g GB, %s than %.2g GB", bytes / 1e9,
           *large ? "more" : "no more", max / 1e9);
done:
  return status;
}

static bw_status prepare_automatic(bw_context *context, const bw_model *model, bw_system *system,
                                   bwi_symbolic *old, double available) {
  bw_status status = BW_OK;
  char reason[160] = "a factor serves many right-hand sides";
  bool large = false;
  BW_TRY(is_large(context, system, available, &large, reason));
  if (!large) {
    status = by_factor(context, system, NULL, old, available, reason);
    if (status != BW_MEMORY)
      goto done;
    bw_clear_failure(context);
    if (!system->two_level)
      BW_TRY(bwi_two_level_predict(context, system));
    BW_TRY(without_factor(context, model, system, "there is no memory for a factor"));
  } else {
    status = without_factor(context, model, system, reason);
    if (status == BW_OK ||
        !bwi_factor_replaces(context, system, status, 0, available, reason)) /* or says where */
      goto done;
    BW_TRY(by_factor(context, system, NULL, old, available, reason));
  }
done:
  return status;
}

bw_status bwi_system_prepare(bw_context *context, const bw_model *model, bw_system *system,
                             const bw_solver *solver, bwi_symbolic *old) {
  bw_status status = BW_OK;
  bwi_request request;
  double available = bw_available_memory();
  BW_TRY(bwi_solver_request(context, solver, BWI_SOLVE_TO, &request));
  if (!solver)
    BW_TRY(prepare_automatic(context, model, system, old, available));
  else if (request.way == BWI_BY_FACTOR)
    BW_TRY(by_factor(context, system, solver, old, available, "it was given"));
  else
    BW_TRY(by_iterations(context, model, system, solver, request.way, request.preconditioner, old,
                         available, "it was given"));
  BW_TRY(bwi_system_mass(context, system));
done:
  return status;
}

bw_status bw_system_of_model(bw_context *context, const bw_model *model, const bw_solver *solver,
                             bw_system *given, bw_system **out) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  if (bwi_solver_is_external(solver)) {
    if (given && bwi_external_serves(given, model, dof_map, solver))
      BW_TRY(bwi_system_following(context, given, dof_map, &system));
    else
      BW_TRY(bwi_system_begin_external(context, model, dof_map, solver, &system));
    goto done;
  }
  if (given && bwi_system_serves(given, model, dof_map))
    BW_TRY(bwi_system_following(context, given, dof_map, &system));
  if (!system) {
    if (!bwi_system_reusable(given, model->mesh))
      given = NULL;
    BW_TRY(bwi_system_begin(context, model->mesh, model->material, dof_map, given, &system));
  }
  BW_TRY(bwi_system_prepare(context, model, system, solver,
                            given && given->factor ? given->factor->symbolic : NULL));
done:
  bw_release(dof_map);
  if (status == BW_OK)
    *out = system;
  else
    bw_release(system);
  return status;
}

/* ---- iterations ------------------------------------------------------------------------------ */

bw_status bwi_system_iterate(bw_context *context, bw_system *system, bwi_system_pcg *problem,
                             int64_t count, const double *force, double *displacement) {
  bw_status status = BW_OK;
  bwi_two_level_solver *two_level = system->two_level;
  if (problem->way == BWI_BY_TWO_LEVEL) {
    bwi_two_level_problem p = {.tolerance = problem->tolerance,
                               .energy_alone = problem->energy_alone,
                               .limit = problem->limit};
    BW_TRY(bwi_two_level_solve(context, two_level->preconditioner, &p, count, force, displacement));
    problem->iterations = p.iterations;
    problem->converged = p.converged;
    problem->residual = p.reached;
  } else if (system->preconditioner->amg) {
    bwi_amg_problem p = {.tolerance = problem->tolerance,
                         .energy_alone = problem->energy_alone,
                         .limit = problem->limit};
    BW_TRY(bwi_amg_solve(context, system->preconditioner->amg, &p, count, force, displacement));
    problem->iterations = p.iterations;
    problem->converged = p.converged;
    problem->residual = p.residual;
  } else {
    bwi_pcg p = {.pattern = system->pattern,
                 .stiffness = system->stiffness,
                 .dof_map = system->dof_map,
                 .precondition = bwi_preconditioner_apply,
                 .data = system->preconditioner,
                 .tolerance = problem->tolerance,
                 .limit = problem->limit};
    bw_progress(context, "conjugate gradients", 0);
    BW_TRY(bwi_pcg_solve(context, &p, count, force, displacement));
    problem->iterations = p.iterations;
    problem->converged = p.converged;
    problem->residual = p.residual;
  }
  if (two_level)
    two_level->spent +=
        (double)count * (1 + problem->iterations) * two_level->prediction.one_iteration;
done:
  return status;
}

bw_status bwi_system_stopped(bw_context *context, const bw_system *system,
                             const bwi_system_pcg *problem) {
  const bwi_two_level_solver *two_level = system->two_level;
  const char *word = bw_solver_word(problem->way == BWI_BY_TWO_LEVEL
                                        ? BW_SOLVER_TWO_LEVEL
                                        : system->preconditioner->solver->options.kind);
  char bytes[60] = "";
  bool energy = problem->way == BWI_BY_TWO_LEVEL && problem->energy_alone;
  if (two_level)
    snprintf(bytes, sizeof bytes, ", which would take about %.3g GB of memory",
             two_level->prediction.factor_bytes / 1e9);
  bw_fail(context, BW_CONVERGENCE,
          "PCG with the preconditioner %s reached a residual of %.2g of the load in %d iterations; "
          "%s%.0e was requested: elements are very flat, walls thinner than elements are long, the "
          "material is nearly incompressible, or the body nearly a mechanism. Solve by a factor "
          "(the solver cholesky)%s, or mesh again with elements as thick as long",
          word, problem->residual, problem->iterations, energy ? "an error in energy of " : "",
          problem->tolerance, bytes);
  bw_detail_number(context, "iterations", problem->iterations);
  bw_detail_number(context, "residual", problem->residual);
  if (two_level)
    bw_detail_number(context, "factor_bytes", two_level->prediction.factor_bytes);
  return BW_CONVERGENCE;
}

typedef struct residuals {
  const bw_system *system;
  double *force, *product; /* r = f - K u comes in the place of K u */
  double value[SIDES];
} residuals;

static bw_status measure_residual(void *data, int64_t begin, int64_t end, int worker) {
  residuals *r = data;
  int64_t size = 3 * (int64_t)r->system->mesh->node_count;
  unsigned states = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    double *f = r->force + k * size, *left = r->product + k * size, rest = 0, load = 0;
    for (int64_t i = 0; i < size; i++)
      left[i] = f[i] - left[i];
    bwi_keep_states(r->system->dof_map, states, left);
    bwi_keep_states(r->system->dof_map, states, f);
    for (int64_t i = 0; i < size; i++) {
      rest += left[i] * left[i];
      load += f[i] * f[i];
    }
    r->value[k] = load > 0 ? sqrt(rest / load) : 0;
  }
  return BW_OK;
}

/* Up to SIDES right-hand sides, of which `work` has two copies: balanced forces, and K u. */
static bw_status solve_block(bw_context *context, bw_system *system, bwi_system_pcg *problem,
                             int64_t count, double *work, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  residuals r = {.system = system, .force = work, .product = work + count * size};
  BW_TRY(bwi_balance_fields(context, system->dof_map, count, work));
  BW_TRY(bwi_system_iterate(context, system, problem, count, work, displacement));
  if (problem->iterations > system->report.iterations)
    system->report.iterations = problem->iterations;
  if (!problem->converged)
    return BW_OK;
  if (problem->way == BWI_BY_TWO_LEVEL)
    bwi_two_level_say(system->two_level->preconditioner, &system->report);
  BW_TRY(bwi_system_multiply(context, system, count, displacement, r.product, NULL));
  BW_TRY(bw_parallel(context, count, 1, measure_residual, &r));
  for (int64_t k = 0; k < count; k++)
    system->report.residual = fmax(system->report.residual, r.value[k]);
  BW_TRY(bwi_steady_fields(context, system->dof_map, count, displacement));
done:
  return status;
}

/* A factor in the place of iterations that do not converge, where nothing was asked for. */
static bw_status give_up(bw_context *context, bw_system *system, const bwi_system_pcg *problem) {
  double available = bw_available_memory();
  char reason[160];
  bw_status status = bwi_system_stopped(context, system, problem);
  if (system->solver ||
      !bwi_factor_replaces(context, system, status, problem->iterations, available, reason))
    return status;
  return by_factor(context, system, NULL, NULL, available, reason);
}

/* By the factor, or the external solver. */
static bw_status solve_whole(bw_context *context, const bw_system *system, int64_t count,
                             const double *force, double *displacement) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = system->dof_map;
  size_t size = 3 * (size_t)system->mesh->node_count;
  if (!system->external)
    BW_TRY(bwi_need_factor(context, system));
  if (dof_map->rigid_mode_count > 0) {
    if (force != displacement)
      memcpy(displacement, force, (size_t)count * size * sizeof(double));
    BW_TRY(bwi_balance_fields(context, dof_map, count, displacement));
    force = displacement;
  }
  BW_TRY(system->external
             ? bwi_external_solve(context, system->external, count, force, displacement)
             : bwi_solve_fields(context, system->factor, dof_map, count, force, displacement));
  BW_TRY(bwi_steady_fields(context, dof_map, count, displacement));
done:
  return status;
}

static bw_status solve_iterative(bw_context *context, bw_system *system, int64_t count,
                                 const double *force, double *displacement) {
  bw_status status = BW_OK;
  bwi_request request;
  int64_t size = 3 * (int64_t)system->mesh->node_count, width = count < SIDES ? count : SIDES;
  double *work = NULL;
  BW_TRY(restore(context, system, &request));
  bwi_system_pcg problem = {.way = request.way,
                            .tolerance = request.tolerance,
                            .energy_alone = true,
                            .limit = request.max_iterations};
  if (!system->solver)
    problem.limit = bwi_pcg_break_even(system->two_level, bw_available_memory(), problem.limit);
  work = BW_NEW(context, double, 2 * width * size);
  BW_TRY_MEMORY(work);
  for (int64_t first = 0; first < count; first += width) {
    int64_t left = count - first, block = left < width ? left : width;
    const double *f = force + first * size;
    double *u = displacement + first * size;
    memcpy(work, f, (size_t)(block * size) * sizeof *work);
    BW_TRY(solve_block(context, system, &problem, block, work, u));
    if (problem.converged)
      continue;
    BW_TRY(give_up(context, system, &problem));
    if (force == displacement)
      memcpy(u, work, (size_t)(block * size) * sizeof *work);
    BW_TRY(solve_whole(context, system, left, force == displacement ? u : f, u));
    break;
  }
done:
  bw_free(work);
  return status;
}

/* By an operator, of which both sides are blocks of their own. */
static bw_status solve_by_operator(bw_context *context, const bw_system *system, int64_t count,
                                   const double *force, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = count * system->solution->size;
  double *copy = NULL;
  if (force == displacement) {
    copy = BW_NEW(context, double, size);
    BW_TRY_MEMORY(copy);
    memcpy(copy, force, (size_t)size * sizeof *copy);
    force = copy;
  }
  BW_TRY(bw_operator_apply(context, system->solution, count, force, displacement));
done:
  bw_free(copy);
  return status;
}

bw_status bw_system_solve(bw_context *context, bw_system *system, int64_t count,
                          const double *force, double *displacement) {
  double start = bw_seconds();
  bw_status status =
      system->solution    ? solve_by_operator(context, system, count, force, displacement)
      : system->iterative ? solve_iterative(context, system, count, force, displacement)
                          : solve_whole(context, system, count, force, displacement);
  if (system->external && status == BW_OK) {
    bwi_external_update(context, system->external);
    bwi_external_fill_report(system->external, &system->report);
  }
  system->times.solve += bw_seconds() - start;
  system->report.seconds += bw_seconds() - start;
  return status;
}

/* ---- the preconditioner as an operator ------------------------------------------------------- */

bw_status bwi_system_operator_open(bw_context *context, bw_system *system, bwi_way way,
                                   bwi_system_operator *op) {
  *op = (bwi_system_operator){.system = system, .way = way};
  assert(way == BWI_BY_TWO_LEVEL ? system->two_level && system->two_level->preconditioner
                                 : system->preconditioner != NULL);
  if (way == BWI_BY_TWO_LEVEL)
    return bwi_two_level_workspace_open(context, system->two_level->preconditioner, &op->workspace);
  if (system->preconditioner->amg)
    return BW_OK;
  op->balanced = BW_NEW(context, double, SIDES * 3 * (int64_t)system->mesh->node_count);
  return op->balanced ? BW_OK : BW_MEMORY;
}

void bwi_system_operator_close(bwi_system_operator *op) {
  bwi_two_level_workspace_clear(&op->workspace);
  bw_free(op->balanced);
  op->balanced = NULL;
}

bw_status bwi_system_operator_apply(bw_context *context, bwi_system_operator *op, int64_t count,
                                    const double *f, double *z) {
  bw_status status = BW_OK;
  bw_system *system = op->system;
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  if (op->way == BWI_BY_TWO_LEVEL)
    return bwi_two_level_apply(context, system->two_level->preconditioner, &op->workspace, count, f,
                               z);
  if (system->preconditioner->amg)
    return bwi_amg_apply(context, system->preconditioner->amg, count, f, z);
  for (int64_t first = 0; first < count; first += SIDES) {
    int64_t block = count - first < SIDES ? count - first : SIDES;
    memcpy(op->balanced, f + first * size, (size_t)(block * size) * sizeof *z);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_balance_fields(context, system->dof_map, block, op->balanced));
    BW_TRY(bwi_preconditioner_apply(context, system->preconditioner, block, op->balanced,
                                    z + first * size));
  }
done:
  return status;
}

const char *bwi_system_operator_word(const bwi_system_operator *op) {
  return bw_solver_word(op->way == BWI_BY_TWO_LEVEL
                            ? BW_SOLVER_TWO_LEVEL
                            : op->system->preconditioner->solver->options.kind);
}
