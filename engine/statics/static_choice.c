/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions of a model: by the factor of its system, or by two-level PCG without one.
 *
 * A factor serves whatever comes next: other loads, modes, the worst case. So it is left alone
 * where it costs little. Where it costs much, PCG is taken, which serves one solution; those
 * that follow are counted, and when they would come to more than the factor, that is made: whatever
 * comes, the cost is no more than twice that of the better way. */
#include <math.h>

#include "barwright/job.h"
#include "linear/cost.h"
#include "linear/system_two_level.h"
#include "statics/internal.h"

enum {
  ITERATIONS = 2000, /* no way to solve */
  SMALL = 30000      /* unknowns: always the factor */
};
/* Seconds of the model's machine that a factor may take, and bytes: there are machines with less
 * memory than this, but few. */
#define CHEAP 5.0
#define LARGE 4e9
/* Of the factor's cost that PCG may be at most: it may serve again. */
#define MAX_COST_RATIO 0.5

typedef struct statics {
  bw_context *context;
  const bw_model *model;
  bw_statics_options opts;
  double available;  /* bytes that a factor may take */
  bwi_symbolic *old; /* of a former system, or NULL */
  bw_static *result;
  int limit, passes;
  bool pcg;
} statics;

static bw_status check_options(bw_context *context, const bw_statics_options *given,
                               bw_statics_options *opts) {
  *opts = given ? *given : (bw_statics_options){0};
  if (opts->method < BW_STATICS_AUTO || opts->method > BW_STATICS_PCG)
    return bw_fail(context, BW_INVALID, "solution method %d is not known", (int)opts->method);
  if (opts->iterations == 0)
    opts->iterations = ITERATIONS;
  if (opts->iterations < 1)
    return bw_fail(context, BW_INVALID, "%d iterations: at least 1 expected", opts->iterations);
  if (!(opts->memory >= 0))
    return bw_fail(context, BW_INVALID,
                   "memory %g bytes: a positive number expected, or 0 for what is free",
                   opts->memory);
  return BW_OK;
}

/* The equations: those given where they fit, else new ones that reuse what they can. */
static bw_status prepare_system(statics *s, const bw_dof_map *dof_map, bw_system *given) {
  const bw_model *model = s->model;
  if (given && !bwi_same_topology(given->mesh, model->mesh))
    given = NULL;
  if (given && (given->factor || given->two_level) && bwi_system_serves(given, model, dof_map)) {
    s->result->system = bw_retain(given);
    return BW_OK;
  }
  s->old = given && given->factor ? given->factor->symbolic : NULL;
  return bwi_system_begin(s->context, model->mesh, model->material, dof_map, given,
                          &s->result->system);
}

/* ---- the choice ---------------------------------------------------------------------------- */

static double next_by_pcg(const bwi_cost_prediction *cost) {
  return (1 + BWI_TWO_LEVEL_RATE * log(2 / BWI_REFINE_TO)) * cost->one_iteration;
}

static bool has_memory(const statics *s, const bwi_cost_prediction *cost) {
  return cost->factor_bytes <= s->available;
}

static bool pcg_is_better(const statics *s, const bw_system *system) {
  const bwi_two_level_solver *two_level = system->two_level;
  const bwi_cost_prediction *cost = &two_level->prediction;
  if (cost->factor_bytes > LARGE || !has_memory(s, cost))
    return true;
  if (two_level->preconditioner)
    return two_level->spent + next_by_pcg(cost) <= cost->factor;
  return cost->factor >= CHEAP && cost->pcg <= MAX_COST_RATIO * cost->factor;
}

static bw_status choose(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  bw_statics_method method = s->opts.method;
  bool fit = bwi_two_level_applies(system);
  s->pcg = false;
  if (method == BW_STATICS_PCG && !fit)
    return bw_fail(s->context, BW_INVALID,
                   "a solution by two-level PCG needs quadratic elements, and supports that "
                   "constrain all rigid-body modes: %s",
                   system->mesh->order == 2 ? "this one is free to move" : "these are linear");
  if (method == BW_STATICS_FACTOR || !fit || (method == BW_STATICS_AUTO && system->factor) ||
      (method == BW_STATICS_AUTO && system->dof_map->unknown_count < SMALL))
    return BW_OK;
  if (!system->two_level)
    BW_TRY(bwi_two_level_predict(s->context, system));
  s->pcg = method == BW_STATICS_PCG || pcg_is_better(s, system);
done:
  return status;
}

/* As many iterations as the factor would have cost, where there is room for it. */
static int limit_of(const statics *s, const bwi_cost_prediction *cost) {
  if (s->opts.method == BW_STATICS_PCG || !has_memory(s, cost))
    return s->opts.iterations;
  double break_even = fmax(cost->factor, 2 * next_by_pcg(cost)) / cost->one_iteration;
  return break_even < s->opts.iterations ? (int)break_even : s->opts.iterations;
}

/* ---- by two-level PCG ------------------------------------------------------------------------ */

static bw_status fail_convergence(const statics *s, double reached) {
  const bw_system *system = s->result->system;
  int iterations = s->result->report.iterations;
  double bytes = system->two_level->prediction.factor_bytes;
  bw_fail(
      s->context, BW_CONVERGENCE,
      "two-level PCG reached a residual of %.2g of the load in %d iterations; %.0e was requested: "
      "elements are very flat, walls thinner than elements "
      "are long, the material is nearly incompressible, or the body nearly a mechanism. Solve "
      "by a factor (with = \"factor\"), which would take about %.3g GB of memory, or mesh again "
      "with elements as thick as long",
      reached, iterations, BWI_REFINE_TO, bytes / 1e9);
  bw_detail_number(s->context, "iterations", iterations);
  bw_detail_number(s->context, "residual", reached);
  bw_detail_number(s->context, "factor_bytes", bytes);
  return BW_CONVERGENCE;
}

static bw_status solve_over(bw_context *context, void *data, const double *force,
                            double *displacement) {
  bw_status status = BW_OK;
  statics *s = data;
  bw_system *system = s->result->system;
  bwi_two_level_solver *two_level = system->two_level;
  bwi_two_level_problem problem = {.tolerance = BWI_REFINE_TO, .limit = s->limit};
  double start = bw_seconds();
  BW_TRY(bwi_two_level_solve(context, two_level->preconditioner, &problem, 1, force, displacement));
  s->result->report.iterations += problem.iterations;
  two_level->spent += (1 + problem.iterations) * two_level->prediction.one_iteration;
  system->times.solve += bw_seconds() - start;
  if (!problem.converged && s->passes == 0) /* a refinement need not: it is taken if it helped */
    status = fail_convergence(s, problem.reached);
  s->passes++;
done:
  return status;
}

static bw_status run(statics *s, const bwi_static_solver *solver) {
  const bw_system *system = s->result->system;
  return bwi_static_solve(s->context, system->dof_map, system->pattern, system->stiffness, solver,
                          s->result);
}

static bw_status solve_by_pcg(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  bool usable;
  const bwi_static_solver solver = {.solve = solve_over, .data = s, .refine_to = BWI_REFINE_TO};
  BW_TRY(bwi_two_level_make(s->context, s->model, system, &usable));
  if (!usable) {
    status =
        bw_fail(s->context, BW_SINGULAR,
                "the stiffness of the linear elements is singular, or so nearly that double "
                "precision cannot tell, although the body cannot move freely: parts touch only "
                "in a node or an edge, or elements have almost no volume (with = \"factor\" "
                "says where)");
    goto done;
  }
  s->limit = limit_of(s, &system->two_level->prediction);
  BW_TRY(run(s, &solver));
  s->result->report.method = BW_STATICS_PCG;
  s->result->report.coarse_unknowns = bwi_coarse_unknowns(system->two_level->coarse);
done:
  return status;
}

/* ---- by a factor --------------------------------------------------------------------------- */

static bw_status solve_system(bw_context *context, void *data, const double *force,
                              double *displacement) {
  return bw_system_solve(context, data, 1, force, displacement);
}

static bw_status solve_by_factor(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  bw_statics_report *report = &s->result->report;
  const bwi_static_solver solver = {
      .solve = solve_system, .data = system, .refine_to = BWI_REFINE_TO};
  if (system->two_level) { /* their memory first */
    bw_release(system->two_level->preconditioner);
    system->two_level->preconditioner = NULL;
  }
  BW_TRY(bwi_system_factor(s->context, system, s->old, s->available));
  report->method = BW_STATICS_FACTOR;
  report->factor_flops = system->times.factor_flops;
  report->factor_bytes = (double)bwi_factor_bytes(system->factor);
  BW_TRY(run(s, &solver));
done:
  return status;
}

static void note_prediction(statics *s) {
  const bwi_two_level_solver *two_level = s->result->system->two_level;
  bw_statics_report *report = &s->result->report;
  if (!two_level)
    return;
  report->factor_flops = two_level->prediction.factor_flops;
  report->factor_bytes = two_level->prediction.factor_bytes;
  report->predicted_factor = two_level->prediction.factor;
  report->predicted_pcg = two_level->prediction.pcg;
}

/* Whether a failure of one way is no failure while the other may do. */
static bool other_way(const statics *s, bw_status status) {
  const bw_system *system = s->result->system;
  if (s->opts.method != BW_STATICS_AUTO)
    return false;
  if (s->pcg)
    return (status == BW_CONVERGENCE && has_memory(s, &system->two_level->prediction)) ||
           status == BW_SINGULAR;
  return status == BW_MEMORY && bwi_two_level_applies(system) &&
         system->dof_map->unknown_count >= SMALL;
}

static bw_status solve(statics *s) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  BW_TRY(choose(s));
  note_prediction(s);
  status = s->pcg ? solve_by_pcg(s) : solve_by_factor(s);
  if (status == BW_OK || !other_way(s, status))
    goto done;
  bw_clear_failure(context);
  if (s->pcg) {
    if (status == BW_CONVERGENCE)
      bw_warn(context,
              "two-level PCG did not converge in %d iterations; a Cholesky factorisation gives the "
              "solution",
              s->result->report.iterations);
    BW_TRY(solve_by_factor(s));
  } else {
    s->available = 0; /* there is none */
    if (!s->result->system->two_level)
      BW_TRY(bwi_two_level_predict(context, s->result->system));
    note_prediction(s);
    BW_TRY(solve_by_pcg(s));
  }
done:
  return status;
}

bw_status bw_statics(bw_context *context, const bw_model *model, bw_system *system,
                     const bw_statics_options *options, bw_static **out) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  statics s = {.context = context, .model = model};
  BW_TRY(check_options(context, options, &s.opts));
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  BW_TRY(bwi_static_begin(context, model, options, dof_map, &s.result));
  BW_TRY(prepare_system(&s, dof_map, system));
  s.available = s.opts.memory > 0 ? s.opts.memory : bw_available_memory();
  BW_TRY(solve(&s));
done:
  bw_release(dof_map);
  if (status == BW_OK)
    *out = s.result;
  else
    bw_release(s.result);
  return status;
}
