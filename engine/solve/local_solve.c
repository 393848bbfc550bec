/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solving with a system that follows edits: directly, once the factor is brought up to date, or by
 * iterating with the factor as it is, whichever is predicted to cost less.
 *
 * Iterating is bounded by the cost of the other way: with a factor that stays behind, as many
 * iterations are made for one shape, over all solves, as bringing it up to date would have cost;
 * then that is done. It is done earlier where the residual falls too slowly to get there. So the
 * choice never costs more than twice the better one. Iterations are counted, not timed, and the
 * same on every machine. */
#include <math.h>
#include <string.h>

#include "solve/local.h"

/* More than this is no way to solve; nor with a factor that lacks digits only. */
enum { MOST_ITERATIONS = 2000, MOST_REFINEMENTS = 40 };

void bw_local_options_default(bw_local_options *options) {
  *options = (bw_local_options){.method = BW_LOCAL_AUTO, .tolerance = 1e-10};
}

static bw_status options_of(bw_context *context, const bw_local_options *given,
                            bw_local_options *options) {
  bw_local_options_default(options);
  if (given)
    *options = *given;
  if (options->tolerance == 0)
    options->tolerance = 1e-10;
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance of the iteration is %g; it must be between 0 and 1",
                   options->tolerance);
  if (options->precision != 0 && options->precision != 32 && options->precision != 64)
    return bw_fail(context, BW_INVALID, "the factor's precision is 32 or 64 bits, not %d",
                   options->precision);
  if (options->method < BW_LOCAL_AUTO || options->method > BW_LOCAL_SCRATCH)
    return bw_fail(context, BW_INVALID, "there is no method %d", (int)options->method);
  return BW_OK;
}

/* ---- solving ------------------------------------------------------------------------------- */

/* By conjugate gradients, in `displacement`, where the balanced force is; where they do not
 * converge, it still is. */
static bw_status conjugate(bw_context *context, const bw_local_system *local, const bwi_rest *left,
                           int64_t count, bwi_conjugate *problem, double *displacement) {
  bw_status status = BW_OK;
  const bw_system *system = local->system;
  size_t size = (size_t)count * 3 * (size_t)system->mesh->node_count;
  double *solution = NULL;
  bwi_local_aid aid = {0};
  problem->graph = system->graph;
  problem->stiffness = system->stiffness;
  problem->numbering = system->numbering;
  problem->factor = local->inner->factor;
  problem->load = left->load;
  problem->energy = left->energy;
  BW_TRY(bwi_local_aids(context, local, &aid));
  problem->coarse = aid.coarse;
  problem->directions = &aid.directions;
  solution = BW_NEW(context, double, size);
  if (!solution) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_conjugate_solve(context, problem, count, left->force ? left->force : displacement,
                             solution));
  if (problem->converged) {
    memcpy(displacement, solution, size * sizeof(double));
    for (size_t i = 0; left->guess && i < size; i++)
      displacement[i] += left->guess[i];
  }
done:
  bwi_local_aid_clear(&aid);
  bw_free(solution);
  return status;
}

/* With the factor of the present shape, in `displacement`, where the balanced force is. */
static bw_status solve_directly(bw_context *context, bw_local_system *local,
                                const bw_local_options *options, bwi_rest *left, int64_t count,
                                double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  const bw_numbering *numbering = local->system->numbering;
  bool solved = false;
  if (inner->factor->kernels->bits == 32) {
    bwi_conjugate problem = {.tolerance = options->tolerance,
                             .energy_alone = options->energy,
                             .limit = MOST_REFINEMENTS};
    if (!left->force)
      BW_TRY(bwi_rest_make(context, local, options, count, displacement, left));
    BW_TRY(conjugate(context, local, left, count, &problem, displacement));
    solved = problem.converged;
    if (reuse)
      reuse->refinements += problem.iterations;
    if (!solved)
      BW_TRY(bwi_local_lose_single(context, local, reuse));
    else if (problem.iterations > 0 && !left->force && !options->energy) /* else it tells nothing */
      inner->refinements = problem.iterations * log(1e-10) / log(options->tolerance);
  }
  if (!solved)
    BW_TRY(bwi_solve_fields(context, inner->factor, numbering, count, displacement, displacement));
  BW_TRY(bwi_steady_fields(context, numbering, count, displacement));
done:
  return status;
}

/* With the factor of a former shape. *converged is false when the limit was reached;
 * `displacement` then still is the force. */
static bw_status iterate(bw_context *context, bw_local_system *local,
                         const bw_local_options *options, int limit, double patience,
                         const bwi_local_cost *cost, const bwi_rest *left, int64_t count,
                         double *displacement, int *iterations, bool *converged) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  bwi_conjugate problem = {.tolerance = options->tolerance,
                           .energy_alone = options->energy,
                           .limit = limit,
                           .patience = patience};
  BW_TRY(conjugate(context, local, left, count, &problem, displacement));
  *iterations = problem.iterations;
  *converged = problem.converged;
  inner->spent += problem.iterations;
  /* what is foreseen errs to the high side: not to be believed for ever */
  double needed = problem.converged ? problem.iterations : fmax(problem.foreseen, limit);
  double seen = cost->factor * needed / cost->iterations;
  inner->experience = fmin(fmax(seen, 0.1), problem.converged ? 10 : 3);
  memcpy(inner->experienced, inner->touched, (size_t)inner->domain_count);
  if (problem.converged) {
    BW_TRY(bwi_steady_fields(context, local->system->numbering, count, displacement));
  }
done:
  return status;
}

/* How many iterations to make, 0: none. */
static int iterations_worth(const bw_local_system *local, bw_local_method method,
                            const bwi_local_cost *cost) {
  if (method == BW_LOCAL_ITERATE)
    return MOST_ITERATIONS;
  if (method != BW_LOCAL_AUTO || !(cost->one_iteration > 0))
    return 0;
  double spent = local->inner->spent * cost->one_iteration;
  double worth = (cost->refactor - spent) / cost->one_iteration;
  if (!(cost->iterate + spent <= cost->refactor) || worth < 1)
    return 0;
  return worth > MOST_ITERATIONS ? MOST_ITERATIONS : (int)worth;
}

static bw_status fail_convergence(bw_context *context, int iterations, double tolerance) {
  bw_fail(context, BW_CONVERGENCE,
          "conjugate gradients with the factor of an earlier shape did not reach a relative "
          "residual of %g in %d iterations: the shape has changed too much for that factor, or "
          "the body is a mechanism; bring the factor up to date (method refactor or auto)",
          tolerance, iterations);
  bw_detail_number(context, "iterations", iterations);
  return BW_CONVERGENCE;
}

bw_status bw_local_system_solve(bw_context *context, bw_local_system *local,
                                const bw_local_options *given, int64_t count, const double *force,
                                double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  const bw_numbering *numbering = local->system->numbering;
  size_t size = (size_t)count * 3 * (size_t)numbering->mesh->node_count;
  double start = bw_seconds(), *load = NULL;
  bw_local_options options;
  bool solved = false;
  bwi_rest left = {.tolerance = 0};
  BW_TRY(options_of(context, given, &options));
  local->inner->wanted_bits = options.precision;
  if (options.check) { /* the force may be overwritten */
    load = BW_NEW(context, double, size);
    if (!load)
      return BW_MEMORY;
    memcpy(load, force, size * sizeof *load);
  }
  if (force != displacement)
    memmove(displacement, force, size * sizeof *force);
  BW_TRY(bwi_balance_fields(context, numbering, count, displacement));
  if (bwi_local_usable(local) && !bwi_local_current(local)) {
    bwi_local_cost cost;
    int iterations = 0;
    if (options.method == BW_LOCAL_AUTO || options.method == BW_LOCAL_ITERATE)
      BW_TRY(bwi_rest_make(context, local, &options, count, displacement, &left));
    else
      left.tolerance = options.tolerance;
    bwi_local_predict(local, &options, left.tolerance, count, &cost);
    if (reuse) {
      reuse->predicted_refactor = cost.refactor;
      reuse->predicted_iterate = cost.iterate;
    }
    int limit = iterations_worth(local, options.method, &cost);
    if (limit > 0)
      BW_TRY(iterate(context, local, &options, limit,
                     options.method == BW_LOCAL_AUTO ? cost.refactor / cost.one_iteration : 0,
                     &cost, &left, count, displacement, &iterations, &solved));
    if (limit > 0 && !solved && options.method == BW_LOCAL_ITERATE) {
      status = fail_convergence(context, iterations, options.tolerance);
      goto done;
    }
    if (reuse) {
      reuse->iterations += iterations;
      reuse->seconds_solve += bw_seconds() - start;
      if (solved) {
        reuse->method = BW_LOCAL_ITERATE;
        reuse->factor_kept = 1;
        reuse->precision = local->inner->factor->kernels->bits;
      }
    }
    start = bw_seconds();
  }
  if (!solved) {
    BW_TRY(bwi_local_factor(context, local, options.method == BW_LOCAL_SCRATCH, reuse));
    start = bw_seconds();
    double factor = reuse ? reuse->seconds_factor : 0;
    BW_TRY(solve_directly(context, local, &options, &left, count, displacement, reuse));
    if (reuse)
      reuse->seconds_solve += bw_seconds() - start - (reuse->seconds_factor - factor);
  }
  if (options.check)
    BW_TRY(bwi_local_check(context, local, count, load, displacement, reuse));
done:
  bwi_rest_clear(&left);
  bw_free(load);
  return status;
}

bw_status bw_local_system_refactor(bw_context *context, bw_local_system *local, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_system *system = local->system;
  BW_TRY(bwi_local_factor(context, local, false, reuse));
  if (system->factor)
    return BW_OK;
  int64_t pairs = system->graph->pair_count;
  if (!system->mass && !(system->mass = BW_NEW(context, double, pairs)))
    return BW_MEMORY;
  BW_TRY(bw_mass(context, system->graph, system->mesh, system->mass));
  for (int64_t k = 0; k < pairs; k++)
    system->mass[k] *= system->density;
  const bwi_factor *own = local->inner->factor;
  if (own->kernels->bits == 64)
    system->factor = bw_retain(own);
  else {
    bwi_matrix matrix = {
        .graph = system->graph, .stiffness = system->stiffness, .numbering = system->numbering};
    int32_t bad = 0;
    status = bwi_factor_create(context, own->symbolic, &matrix, &system->factor, &bad);
    if (status == BW_SINGULAR)
      status = bwi_say_singular(context, system->mesh, bad);
  }
done:
  return status;
}

/* ---- static solutions ---------------------------------------------------------------------- */

typedef struct static_data {
  bw_local_system *local;
  bw_local_options options;
  bw_reuse *reuse;
} static_data;

static bw_status solve_one(bw_context *context, void *data, const double *force,
                           double *displacement) {
  static_data *d = data;
  bw_status status =
      bw_local_system_solve(context, d->local, &d->options, 1, force, displacement, d->reuse);
  d->options.guess_count = 0; /* what refines it is not near them */
  return status;
}

bw_status bw_local_statics(bw_context *context, bw_local_system *local, const bw_model *model,
                           const bw_statics_options *statics, const bw_local_options *given,
                           bw_static **out, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_static *result = NULL;
  bw_local_options options;
  if (model != local->inner->model)
    return bw_fail(context, BW_INVALID,
                   "the model is not the one that the system last followed: update the system "
                   "first");
  BW_TRY(options_of(context, given, &options));
  const bw_system *system = local->system;
  BW_TRY(bwi_static_begin(context, model, statics, system->numbering, &result));
  static_data data = {local, options, reuse};
  bwi_static_solver solver = {.solve = solve_one,
                              .data = &data,
                              .refine_to = fmax(bwi_refine_to, options.tolerance),
                              .once = options.energy};
  BW_TRY(bwi_static_solve(context, system->numbering, system->graph, system->stiffness, &solver,
                          result));
done:
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}
