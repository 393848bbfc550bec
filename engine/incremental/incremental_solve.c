/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solving with a system that follows edits: directly, once the factor is updated, by
 * iterating with the factor as it is, or by two-level PCG without it, whichever is predicted
 * to cost less.
 *
 * Iterating is bounded by the cost of the direct way: with a factor that stays behind, as many
 * iterations are made for one shape, over all solves, as updating it would have cost;
 * then that is done. It is done earlier where the residual falls too slowly to get there. So the
 * choice never costs more than twice the better one. Iterations are counted, not timed, and the
 * same on every machine. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "incremental/incremental.h"

/* More than this is no way to solve; nor with a factor that lacks digits only. */
enum { MAX_ITERATIONS = 2000, MAX_REFINEMENTS = 40 };

void bw_incremental_options_default(bw_incremental_options *options) {
  *options = (bw_incremental_options){0};
}

/* A factor, alone or as preconditioner, by a backend on this machine, or two levels. */
static bw_status check_solver(bw_context *context, const bw_solver *solver) {
  const bw_solver *m = solver;
  if (!solver)
    return BW_OK;
  if (solver->options.kind == BW_SOLVER_PCG) {
    m = solver->options.preconditioner;
    if (!m || m->options.kind == BW_SOLVER_TWO_LEVEL)
      return BW_OK;
  } else if (solver->options.kind != BW_SOLVER_CHOLESKY)
    return bwi_solver_refused(context, solver);
  if (m->options.kind != BW_SOLVER_CHOLESKY)
    return bw_fail(context, BW_UNSUPPORTED,
                   "systems that follow edits have no preconditioner \"%s\": give two_level or "
                   "cholesky",
                   bw_solver_word(m->options.kind));
  if (m->options.backend == BW_BACKEND_PETSC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "systems that follow edits are not spread over processes: give the backend "
                   "multifrontal or cholmod");
  return BW_OK;
}

static bwi_incremental_way incremental_way_of(const bw_solver *solver) {
  if (!solver)
    return BWI_AUTO;
  if (solver->options.kind == BW_SOLVER_CHOLESKY)
    return solver->options.full ? BWI_FULL : BWI_REFACTOR;
  const bw_solver *m = solver->options.preconditioner;
  return m && m->options.kind == BW_SOLVER_CHOLESKY ? BWI_ITERATE : BWI_PCG;
}

/* The factor that a solver asks for, alone or as preconditioner; NULL: none. */
static const bw_solver *factor_of(const bw_solver *solver) {
  if (solver && solver->options.kind == BW_SOLVER_PCG)
    solver = solver->options.preconditioner;
  return solver && solver->options.kind == BW_SOLVER_CHOLESKY ? solver : NULL;
}

static void set_wanted(bwi_incremental *inner, const bw_incremental_options *options) {
  const bw_solver *factor = factor_of(options->solver);
  inner->wanted_bits = options->precision;
  inner->wanted_backend = factor ? factor->options.backend : BW_BACKEND_AUTO;
  inner->wanted_ordering = factor ? factor->options.ordering : BW_ORDERING_AUTO;
}

/* How many iterations, where they are asked for. */
static int max_iterations(const bw_incremental_options *options) {
  bool given = options->solver && options->solver->options.max_iterations > 0;
  return given ? options->solver->options.max_iterations : MAX_ITERATIONS;
}

static bw_status options_of(bw_context *context, const bw_incremental_options *given,
                            bw_incremental_options *options) {
  bw_incremental_options_default(options);
  if (given)
    *options = *given;
  const bw_solver *solver = options->solver;
  double own = solver && solver->options.kind == BW_SOLVER_PCG ? solver->options.tolerance : 0;
  if (options->tolerance == 0)
    options->tolerance = own > 0 ? own : BWI_INCREMENTAL_TOLERANCE;
  options->tolerance = fmax(options->tolerance, own);
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance of the iteration is %g; it must be between 0 and 1",
                   options->tolerance);
  if (options->further < 0 || !(options->max_iteration_ratio >= 0))
    return bw_fail(
        context, BW_INVALID,
        "%d further right-hand sides, max_iteration_ratio %g: 0 or more of both expected",
        options->further, options->max_iteration_ratio);
  if (options->precision != 0 && options->precision != 32 && options->precision != 64)
    return bw_fail(context, BW_INVALID, "the factor's precision is 32 or 64 bits, not %d",
                   options->precision);
  const bw_solver *factor = factor_of(solver);
  if (factor && factor->options.precision != 0)
    options->precision = factor->options.precision;
  return check_solver(context, solver);
}

/* ---- solving ------------------------------------------------------------------------------- */

/* By conjugate gradients, in `displacement`, where the balanced force is; where they do not
 * converge, it still is. */
static bw_status conjugate(bw_context *context, const bw_incremental_system *incremental,
                           const bwi_initial_guess *left, int64_t count, bwi_pcg *problem,
                           double *displacement) {
  bw_status status = BW_OK;
  const bw_system *system = incremental->system;
  size_t size = (size_t)count * 3 * (size_t)system->mesh->node_count;
  double *solution = NULL;
  bwi_factor_preconditioner factor = {incremental->inner->factor, system->dof_map};
  problem->pattern = system->pattern;
  problem->stiffness = system->stiffness;
  problem->dof_map = system->dof_map;
  problem->precondition = bwi_factor_precondition;
  problem->data = &factor;
  problem->load = left->load;
  problem->energy = left->energy;
  solution = BW_NEW(context, double, size);
  BW_TRY_MEMORY(solution);
  BW_TRY(
      bwi_pcg_solve(context, problem, count, left->force ? left->force : displacement, solution));
  if (problem->converged) {
    memcpy(displacement, solution, size * sizeof(double));
    for (size_t i = 0; left->guess && i < size; i++)
      displacement[i] += left->guess[i];
  }
done:
  bw_free(solution);
  return status;
}

/* With the factor of the present shape, in `displacement`, where the balanced force is. */
static bw_status solve_directly(bw_context *context, bw_incremental_system *incremental,
                                const bw_incremental_options *options, bwi_initial_guess *left,
                                int64_t count, double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  const bw_dof_map *dof_map = incremental->system->dof_map;
  bool solved = false;
  if (inner->factor->kernels->bits == 32) {
    bwi_pcg problem = {
        .tolerance = options->tolerance, .energy_alone = options->energy, .limit = MAX_REFINEMENTS};
    if (!left->force)
      BW_TRY(bwi_initial_guess_make(context, incremental, options, count, displacement, left));
    BW_TRY(conjugate(context, incremental, left, count, &problem, displacement));
    solved = problem.converged;
    if (reuse)
      reuse->refinements += problem.iterations;
    if (!solved)
      BW_TRY(bwi_incremental_use_double(context, incremental, reuse));
    else if (problem.iterations > 0 && !left->force && !options->energy) /* else it tells nothing */
      inner->refinements = problem.iterations * log(1e-10) / log(options->tolerance);
  }
  if (!solved)
    BW_TRY(bwi_solve_fields(context, inner->factor, dof_map, count, displacement, displacement));
  BW_TRY(bwi_steady_fields(context, dof_map, count, displacement));
done:
  return status;
}

/* With the factor of a former shape. *converged is false when the limit was reached;
 * `displacement` then still is the force. */
static bw_status iterate(bw_context *context, bw_incremental_system *incremental,
                         const bw_incremental_options *options, int limit, double max_remaining,
                         const bwi_incremental_cost *cost, const bwi_initial_guess *left,
                         int64_t count, double *displacement, int *iterations, bool *converged) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  bwi_pcg problem = {.tolerance = options->tolerance,
                     .energy_alone = options->energy,
                     .limit = limit,
                     .max_remaining = max_remaining};
  BW_TRY(conjugate(context, incremental, left, count, &problem, displacement));
  *iterations = problem.iterations;
  *converged = problem.converged;
  inner->spent += problem.iterations * cost->one_iteration;
  /* what is predicted errs to the high side: not to be believed for ever */
  double needed =
      problem.converged ? problem.iterations : fmax(problem.predicted_iterations, limit);
  double seen = cost->factor * needed / cost->iterations;
  inner->iteration_ratio = fmin(fmax(seen, 0.1), problem.converged ? 10 : 3);
  memcpy(inner->iterated_on, inner->touched, (size_t)inner->subdomain_count);
  if (problem.converged) {
    BW_TRY(bwi_steady_fields(context, incremental->system->dof_map, count, displacement));
  }
done:
  return status;
}

/* How many iterations to make with the factor as it is and by two-level PCG, 0: none. */
typedef struct limits {
  int iterate, pcg;
} limits;

static int within(double budget, double predicted, double one) {
  if (!(one > 0) || !(predicted <= budget) || budget < one)
    return 0;
  return budget / one > MAX_ITERATIONS ? MAX_ITERATIONS : (int)(budget / one);
}

static limits break_even_iterations(const bw_incremental_system *incremental,
                                    const bw_incremental_options *options,
                                    const bwi_incremental_cost *cost) {
  bwi_incremental_way method = incremental_way_of(options->solver);
  if (method == BWI_ITERATE)
    return (limits){.iterate = max_iterations(options)};
  if (method != BWI_AUTO)
    return (limits){0};
  double budget = cost->refactor - incremental->inner->spent;
  limits max = {0};
  double more = cost->pcg - cost->again; /* than with a factor that is always current */
  if ((more <= 0 || incremental->inner->excess_seconds + more < cost->refactor - cost->again) &&
      within(budget, cost->pcg, cost->one_pcg_iteration) > 0)
    max.pcg = (int)(2 * cost->pcg_iterations) + 8; /* what is close to its end is not given up */
  if (max.pcg > 0)
    budget = fmin(budget, cost->pcg);
  max.iterate = within(budget, cost->iterate, cost->one_iteration);
  return max;
}

static bw_status fail_convergence(bw_context *context, int iterations, double tolerance) {
  bw_fail(context, BW_CONVERGENCE,
          "conjugate gradients with the lagged factor of an earlier shape did not reach a relative "
          "residual of %g in %d iterations: the shape has changed too much for that factor, or the "
          "body is a mechanism; refactorise (the solver cholesky or auto)",
          tolerance, iterations);
  bw_detail_number(context, "iterations", iterations);
  return BW_CONVERGENCE;
}

static bw_status fail_levels(bw_context *context, const bw_incremental_system *incremental,
                             int iterations, double tolerance) {
  if (!bwi_incremental_has_two_level(incremental))
    return bwi_two_level_refused(context, "cholesky");
  bw_fail(context, BW_CONVERGENCE,
          "conjugate gradients over linear elements did not reach a relative residual of %g in %d "
          "iterations: the body is nearly a mechanism, or elements are very flat; solve directly "
          "(the solver cholesky or auto)",
          tolerance, iterations);
  bw_detail_number(context, "iterations", iterations);
  return BW_CONVERGENCE;
}

/* By iterations, where that is asked for or predicted to cost least. */
static bw_status solve_by_iterations(bw_context *context, bw_incremental_system *incremental,
                                     const bw_incremental_options *options, bwi_initial_guess *left,
                                     int64_t count, double *displacement, bw_reuse *reuse,
                                     bool *solved) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  bwi_incremental_way way = incremental_way_of(options->solver);
  bwi_incremental_cost cost = {.pcg = INFINITY};
  limits max = {0};
  int iterations = 0;
  double start = bw_seconds();
  bool usable = bwi_incremental_usable(incremental) && !bwi_incremental_current(incremental);
  if (way == BWI_PCG && !bwi_incremental_has_two_level(incremental))
    return fail_levels(context, incremental, 0, 0);
  if (way != BWI_PCG && !usable)
    return BW_OK;
  if (way == BWI_REFACTOR || way == BWI_FULL)
    left->tolerance = options->tolerance;
  else
    BW_TRY(bwi_initial_guess_make(context, incremental, options, count, displacement, left));
  if (usable) {
    bwi_incremental_predict(incremental, options, left->tolerance, count, &cost);
    max = break_even_iterations(incremental, options, &cost);
    if (reuse) {
      reuse->predicted_refactor = cost.refactor;
      reuse->predicted_iterate = cost.iterate;
      reuse->predicted_pcg = isfinite(cost.pcg) ? cost.pcg : 0;
    }
  }
  if (way == BWI_PCG)
    max.pcg = max_iterations(options);
  if (max.iterate > 0) {
    double instead = max.pcg > 0 ? fmin(cost.refactor, cost.pcg) : cost.refactor;
    BW_TRY(iterate(context, incremental, options, max.iterate,
                   way == BWI_AUTO ? instead / cost.one_iteration : 0, &cost, left, count,
                   displacement, &iterations, solved));
    if (!*solved && way == BWI_ITERATE)
      BW_TRY(fail_convergence(context, iterations, options->tolerance));
    if (*solved && reuse)
      bwi_incremental_note(BWI_ITERATE, reuse);
  }
  if (!*solved && max.pcg > 0) {
    int before = iterations;
    BW_TRY(bwi_incremental_by_two_level(context, incremental, options, max.pcg, left, count,
                                        displacement, &iterations, solved));
    int needed = iterations - before;
    inner->spent += needed * cost.one_pcg_iteration;
    if (needed > 1 && cost.pcg_iterations > 0) {
      double fair = 1 + BWI_TWO_LEVEL_RATE * log(2 / left->tolerance);
      inner->two_level_ratio[cost.near] = fmin(fmax((needed - 1) / (fair - 1), 0.2), 5);
    }
    if (!*solved && way == BWI_PCG)
      BW_TRY(fail_levels(context, incremental, iterations, options->tolerance));
    if (*solved && reuse)
      bwi_incremental_note(BWI_PCG, reuse);
    if (*solved && isfinite(cost.pcg))
      inner->excess_seconds = fmax(0, inner->excess_seconds + cost.pcg - cost.again);
  }
  if (reuse) {
    reuse->iterations += iterations;
    reuse->seconds_solve += bw_seconds() - start;
    if (*solved) {
      reuse->factor_reused = 1;
      reuse->precision = inner->factor ? inner->factor->kernels->bits : 64;
    }
  }
done:
  return status;
}

bw_status bw_incremental_system_solve(bw_context *context, bw_incremental_system *incremental,
                                      const bw_incremental_options *given, int64_t count,
                                      const double *force, double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = incremental->system->dof_map;
  size_t size = (size_t)count * 3 * (size_t)dof_map->mesh->node_count;
  double *load = NULL;
  bw_incremental_options options;
  bool solved = false;
  bwi_initial_guess left = {.tolerance = 0};
  BW_TRY(options_of(context, given, &options));
  set_wanted(incremental->inner, &options);
  if (options.check) { /* the force may be overwritten */
    load = BW_NEW(context, double, size);
    if (!load)
      return BW_MEMORY;
    memcpy(load, force, size * sizeof *load);
  }
  if (force != displacement)
    memmove(displacement, force, size * sizeof *force);
  BW_TRY(bwi_balance_fields(context, dof_map, count, displacement));
  BW_TRY(solve_by_iterations(context, incremental, &options, &left, count, displacement, reuse,
                             &solved));
  if (!solved) {
    BW_TRY(bwi_incremental_factor(context, incremental,
                                  incremental_way_of(options.solver) == BWI_FULL, reuse));
    double start = bw_seconds(), factor = reuse ? reuse->seconds_factor : 0;
    BW_TRY(solve_directly(context, incremental, &options, &left, count, displacement, reuse));
    if (reuse)
      reuse->seconds_solve += bw_seconds() - start - (reuse->seconds_factor - factor);
  }
  incremental->inner->answered = true;
  if (options.check)
    BW_TRY(bwi_incremental_check(context, incremental, options.tolerance, count, load, displacement,
                                 reuse));
done:
  bwi_initial_guess_clear(&left);
  bw_free(load);
  return status;
}

bw_status bw_incremental_system_refactor(bw_context *context, bw_incremental_system *incremental,
                                         bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_system *system = incremental->system;
  BW_TRY(bwi_incremental_factor(context, incremental, false, reuse));
  if (system->factor)
    return BW_OK;
  int64_t blocks = system->pattern->block_count;
  if (!system->mass && !(system->mass = BW_NEW(context, double, blocks)))
    return BW_MEMORY;
  BW_TRY(bw_mass(context, system->pattern, system->mesh, system->material, system->mass));
  const bwi_factor *own = incremental->inner->factor;
  if (own->kernels->bits == 64)
    system->factor = bw_retain(own);
  else {
    bwi_matrix matrix = {
        .pattern = system->pattern, .stiffness = system->stiffness, .dof_map = system->dof_map};
    int32_t bad = 0;
    status = bwi_factor_create(context, own->symbolic, &matrix, &system->factor, &bad);
    if (status == BW_SINGULAR)
      status = bwi_fail_singular(context, system->mesh, bad);
  }
done:
  return status;
}

/* ---- static solutions ---------------------------------------------------------------------- */

typedef struct static_data {
  bw_incremental_system *incremental;
  bw_incremental_options options;
  bw_reuse *reuse;
} static_data;

static bw_status solve_one(bw_context *context, void *data, const double *force,
                           double *displacement) {
  static_data *d = data;
  bw_status status = bw_incremental_system_solve(context, d->incremental, &d->options, 1, force,
                                                 displacement, d->reuse);
  d->options.guess_count = 0; /* what refines it is not near them */
  return status;
}

/* What the reuse says of this solution, as of any static one; `before`: as it was before. */
static void fill_report(const bw_incremental_system *incremental, const bw_solver *solver,
                        const bw_reuse *before, const bw_reuse *reuse, double seconds,
                        bw_static *result) {
  const bwi_factor *factor = incremental->inner->factor;
  bw_solver_report *report = &result->report;
  bool pcg = strcmp(reuse->preconditioner, bw_solver_word(BW_SOLVER_TWO_LEVEL)) == 0;
  bool iterate = !pcg && *reuse->preconditioner;
  report->solver = reuse->solver;
  report->preconditioner = reuse->preconditioner;
  if (!pcg && factor)
    report->backend = factor->kernels->backend;
  bool current = !pcg && !iterate && !(reuse->seconds_factor > before->seconds_factor);
  double cost[3] = {reuse->predicted_refactor, reuse->predicted_iterate, reuse->predicted_pcg};
  int chosen = pcg ? 2 : iterate ? 1 : 0;
  for (int k = 0; !current && k < 3; k++) {
    if (k == chosen)
      report->predicted_cost = cost[k];
    else if (cost[k] > 0 && !(report->rival_cost > 0 && report->rival_cost <= cost[k]))
      report->rival_cost = cost[k];
  }
  report->reused = current ? 1 : reuse->factor_reused;
  report->flops = factor && !pcg ? (1 - report->reused) * bwi_factor_flops(factor) : 0;
  report->bytes = pcg      ? (double)bw_bytes(incremental->inner->two_level)
                  : factor ? (double)bwi_factor_bytes(factor)
                           : 0;
  snprintf(report->reason, sizeof report->reason, "%s",
           solver                       ? "it was given"
           : current                    ? "the equations have a factor already"
           : report->predicted_cost > 0 ? "it is predicted to cost least"
                                        : "there was nothing to iterate with");
  if (pcg)
    bwi_two_level_say(incremental->inner->two_level, report);
  report->iterations =
      reuse->iterations + reuse->refinements - before->iterations - before->refinements;
  report->residual = result->residual;
  report->seconds = seconds;
}

bw_status bw_incremental_statics(bw_context *context, bw_incremental_system *incremental,
                                 const bw_model *model, const bw_statics_options *statics,
                                 const bw_incremental_options *given, bw_static **out,
                                 bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_static *result = NULL;
  bw_reuse own = {0};
  bw_incremental_options options;
  double start = bw_seconds();
  if (model != incremental->inner->model)
    return bw_fail(context, BW_INVALID,
                   "the model is not the one that the system last followed: update the system "
                   "first");
  BW_TRY(options_of(context, given, &options));
  bw_system *system = incremental->system;
  BW_TRY(bwi_static_begin(context, model, statics, system->dof_map, &result));
  static_data data = {incremental, options, reuse ? reuse : &own};
  const bw_reuse before = *data.reuse;
  bwi_static_solver solver = {
      .solve = solve_one, .data = &data, .refine_to = options.tolerance, .once = options.energy};
  BW_TRY(bwi_static_solve(context, system->dof_map, system, &solver, result));
  if (!data.reuse->solver) /* without a load there was nothing to solve */
    bwi_incremental_note(BWI_REFACTOR, data.reuse);
  fill_report(incremental, options.solver, &before, data.reuse, bw_seconds() - start, result);
done:
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}
