/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions of a model by the solver that is given, or by the one that costs less: the
 * factor of its system, or PCG without one, whose preconditioner is the two-level one on quadratic
 * elements and multigrid on linear ones.
 *
 * A factor serves whatever comes next: other loads, modes, the worst case. So it is left alone
 * where it costs little. Where it costs much, PCG is taken, which serves one solution; those
 * that follow are counted, and when they would come to more than the factor, that is made: whatever
 * comes, the cost is no more than twice that of the better way. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "base/cost.h"
#include "base/dense.h"
#include "linear/system_solver.h"
#include "statics/internal.h"

/* Seconds of the reference machine that a factor may take. */
#define CHEAP 1.0
/* Of the factor's cost that PCG may be at most: it may serve again. */
#define MAX_COST_RATIO 0.5

/* Where an earlier solution was asked to be by PCG. */
#define FORMER_LEFT "; the preconditioner of an earlier solution is left"

typedef struct statics {
  bw_context *context;
  const bw_model *model;
  bw_dof_map *dof_map; /* the model's: that of a given system may prescribe other displacements */
  bw_statics_options opts;
  bwi_request request;
  double available;  /* bytes that a factor may take */
  bwi_symbolic *old; /* of a former system, or NULL */
  bw_static *result;
  int limit, passes;
  double load; /* |f| of the first pass */
} statics;

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_options(statics *s, const bw_statics_options *given) {
  bw_status status = BW_OK;
  s->opts = given ? *given : (bw_statics_options){0};
  BW_TRY(bwi_solver_request(s->context, s->opts.solver, BWI_REFINE_TO, &s->request));
  if (!(s->opts.memory >= 0))
    status = bw_fail(s->context, BW_INVALID,
                     "memory %g bytes: a positive number expected, or 0 for what is free",
                     s->opts.memory);
done:
  return status;
}

/* The equations: those given where they fit, else new ones that reuse what they can. */
static bw_status prepare_system(statics *s, bw_system *given) {
  const bw_model *model = s->model;
  if (!bwi_system_reusable(given, model->mesh))
    given = NULL;
  if (given && (given->factor || given->two_level || given->preconditioner) &&
      bwi_system_serves(given, model, s->dof_map)) {
    s->result->system = bw_retain(given);
    return BW_OK;
  }
  s->old = given && given->factor ? given->factor->symbolic : NULL;
  return bwi_system_begin(s->context, model->mesh, model->material, s->dof_map, given,
                          &s->result->system);
}

/* ---- the choice ---------------------------------------------------------------------------- */

__attribute__((format(printf, 2, 3))) static void say(statics *s, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(s->result->report.reason, sizeof s->result->report.reason, format, arguments);
  va_end(arguments);
}

static void say_more(statics *s, const char *text) {
  char *reason = s->result->report.reason;
  size_t length = strlen(reason);
  snprintf(reason + length, sizeof s->result->report.reason - length, "%s", text);
}

static bool has_memory(const statics *s, const bwi_cost_prediction *cost) {
  return cost->factor_bytes <= s->available;
}

static bool pcg_is_better(statics *s, const bw_system *system) {
  const bwi_two_level_solver *two_level = system->two_level;
  const bwi_cost_prediction *cost = &two_level->prediction;
  if (cost->factor_bytes > BWI_LARGE_FACTOR || !has_memory(s, cost)) {
    say(s, "a factor is predicted to take %.2g GB, more than %.2g GB", cost->factor_bytes / 1e9,
        fmin(BWI_LARGE_FACTOR, s->available) / 1e9);
    return true;
  }
  const char *name = bwi_two_level_applies(system) ? "two-level PCG" : "multigrid PCG";
  bool made = two_level->preconditioner || (system->preconditioner && system->preconditioner->amg);
  double next = two_level->spent + bwi_predicted_next(two_level);
  bool better = made ? next <= cost->factor
                     : cost->factor >= CHEAP && cost->pcg <= MAX_COST_RATIO * cost->factor;
  if (made)
    say(s, "solutions by %s are predicted to have cost %.2g s with this one, a factor %.2g s", name,
        next, cost->factor);
  else
    say(s, "%s is predicted to cost %.2g s, a factor %.2g s of %.2g GB", name, cost->pcg,
        cost->factor, cost->factor_bytes / 1e9);
  return better;
}

static bw_status choose(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  if (s->opts.solver) {
    say(s, "it was given");
    return BW_OK;
  }
  s->request.way = BWI_BY_FACTOR;
  if (system->factor) {
    say(s, "the equations have a factor already");
    return BW_OK;
  }
  if (system->dof_map->unknown_count < BWI_SMALL_SYSTEM) {
    if (system->two_level && !has_memory(s, &system->two_level->prediction)) {
      say(s, "there is no memory for a factor"); /* as an earlier solution found */
      s->request.way = bwi_way_without_factor(system);
    } else {
      say(s, "the factor of fewer than %d unknowns is cheap", (int)BWI_SMALL_SYSTEM);
      if (system->preconditioner || (system->two_level && system->two_level->preconditioner))
        say_more(s, FORMER_LEFT);
    }
    return BW_OK;
  }
  if (!system->two_level)
    BW_TRY(bwi_two_level_predict(s->context, system));
  if (pcg_is_better(s, system))
    s->request.way = bwi_way_without_factor(system);
  else if (system->preconditioner || system->two_level->preconditioner)
    say_more(s, FORMER_LEFT);
done:
  return status;
}

/* As many iterations as the factor would have cost, where there is room for it. */
static int limit_of(const statics *s) {
  return s->opts.solver ? s->request.max_iterations
                        : bwi_pcg_break_even(s->result->system->two_level, s->available,
                                             s->request.max_iterations);
}

/* ---- by iterations --------------------------------------------------------------------------- */

static bw_status run(statics *s, const bwi_static_solver *solver) {
  return bwi_static_solve(s->context, s->dof_map, s->result->system, solver, s->result);
}

/* Of a pass: one that refines has only to remove what the last has left. */
static double tolerance_of(statics *s, const double *force) {
  int64_t size = 3 * (int64_t)s->model->mesh->node_count;
  double load = sqrt(bwi_dot(size, force, force));
  if (s->passes == 0)
    s->load = load;
  return s->passes == 0 ? s->request.tolerance
                        : fmin(0.1, 0.1 * s->request.tolerance * s->load / load);
}

static bw_status iterate(bw_context *context, void *data, const double *force,
                         double *displacement) {
  bw_status status = BW_OK;
  statics *s = data;
  bw_system *system = s->result->system;
  bool two_level = s->request.way == BWI_BY_TWO_LEVEL;
  bwi_system_pcg problem = {
      .way = s->request.way, .tolerance = tolerance_of(s, force), .limit = s->limit};
  double start = bw_seconds();
  status = bwi_system_iterate(context, system, &problem, 1, force, displacement);
  if (two_level) /* before the residual takes as much */
    bwi_two_level_release(system->two_level->preconditioner);
  if (status != BW_OK)
    goto done;
  s->result->report.iterations += problem.iterations;
  system->times.solve += bw_seconds() - start;
  if (!problem.converged && s->passes == 0) /* a refinement need not: it is taken if it helped */
    status = bwi_system_stopped(context, system, &problem);
  s->passes++;
done:
  return status;
}

static bw_status by_iterations(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  bw_solver_report *report = &s->result->report;
  const bwi_static_solver solver = {.solve = iterate, .data = s, .refine_to = s->request.tolerance};
  bool made;
  BW_TRY(bwi_system_make(s->context, s->model, system, s->request.way, s->request.preconditioner,
                         s->old, s->available, &made));
  s->limit = limit_of(s);
  BW_TRY(run(s, &solver));
  if (s->request.way == BWI_BY_TWO_LEVEL)
    bwi_two_level_say(system->two_level->preconditioner, report);
  bwi_report_way(system, s->request.way, s->opts.solver, report);
  report->flops = made ? report->flops : 0;
  report->reused = !made;
done:
  return status;
}

/* ---- by a factor --------------------------------------------------------------------------- */

static bw_status solve_system(bw_context *context, void *data, const double *force,
                              double *displacement) {
  return bw_system_solve(context, data, 1, force, displacement);
}

static bw_status by_factor(statics *s) {
  bw_status status = BW_OK;
  bw_system *system = s->result->system;
  bw_solver_report *report = &s->result->report;
  const bwi_factor *before = system->factor;
  const bwi_static_solver by_solves = {
      .solve = solve_system, .data = system, .refine_to = BWI_REFINE_TO};
  if (system->two_level && !s->opts.solver) {
    report->predicted_cost = system->two_level->prediction.factor;
    report->rival_cost = system->two_level->prediction.pcg;
  }
  if (system->two_level && !system->iterative) {     /* their memory first */
    if (system->two_level->object.references == 1) { /* else other equations are solved by it */
      bw_release(system->two_level->preconditioner);
      system->two_level->preconditioner = NULL;
    }
    bw_release(system->preconditioner);
    system->preconditioner = NULL;
  }
  const bw_solver *solver = s->request.way == BWI_BY_TWO_LEVEL ? NULL : s->opts.solver;
  bw_solver wide;
  if (s->request.way == BWI_BY_PCG) { /* in place of one in single precision */
    wide = *solver;
    wide.options.precision = 0;
    solver = &wide;
  }
  BW_TRY(bwi_system_factor(s->context, system, solver, s->old, s->available));
  BW_TRY(run(s, &by_solves));
  bwi_report_way(system, BWI_BY_FACTOR, s->opts.solver, report);
  if (system->factor == before) {
    report->reused = 1;
    report->flops = 0;
  }
done:
  return status;
}

/* ---- together -------------------------------------------------------------------------------- */

static bw_status by_request(statics *s) {
  return s->request.way == BWI_BY_FACTOR ? by_factor(s) : by_iterations(s);
}

/* A failure of one way is no failure while another may do. */
static bw_status solve(statics *s) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  bw_system *system = s->result->system;
  bw_solver_report *report = &s->result->report;
  BW_TRY(choose(s));
  status = by_request(s);
  if (status == BW_OK)
    goto done;
  if (s->opts.solver) { /* a factor in single precision may lack digits */
    if (s->request.way != BWI_BY_PCG || s->opts.solver->options.kind != BW_SOLVER_CHOLESKY ||
        (status != BW_CONVERGENCE && status != BW_SINGULAR))
      goto done;
    bw_clear_failure(context);
    bw_warn(context, "the factor in single precision lacks digits; one in double precision gives "
                     "the solution");
    bw_release(system->preconditioner);
    system->preconditioner = NULL;
    BW_TRY(by_factor(s));
  } else if (s->request.way != BWI_BY_FACTOR) {
    if (!bwi_factor_replaces(context, system, status, report->iterations, s->available,
                             report->reason))
      goto done;
    s->request.way = BWI_BY_FACTOR;
    BW_TRY(by_factor(s));
  } else if (status == BW_MEMORY) {
    bw_clear_failure(context);
    s->available = 0; /* there is none */
    if (!system->two_level)
      BW_TRY(bwi_two_level_predict(context, system));
    say(s, "there is no memory for a factor");
    s->request.way = bwi_way_without_factor(system);
    BW_TRY(by_request(s));
  }
done:
  return status;
}

bw_status bw_statics(bw_context *context, const bw_model *model, bw_system *system,
                     const bw_statics_options *options, bw_static **out) {
  bw_status status = BW_OK;
  statics s = {.context = context, .model = model};
  double start = bw_seconds();
  if (options && bwi_solver_is_external(options->solver))
    return bwi_statics_external(context, model, options, out);
  BW_TRY(check_options(&s, options));
  BW_TRY(bw_dof_map_create(context, model, &s.dof_map));
  BW_TRY(bwi_static_begin(context, model, options, s.dof_map, &s.result));
  BW_TRY(prepare_system(&s, system));
  s.available = s.opts.memory > 0 ? s.opts.memory : bw_available_memory();
  BW_TRY(solve(&s));
  s.result->report.residual = s.result->residual;
  s.result->report.seconds = bw_seconds() - start;
done:
  bw_release(s.dof_map);
  if (status == BW_OK)
    *out = s.result;
  else
    bw_release(s.result);
  return status;
}
