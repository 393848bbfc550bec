/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Descriptions of solvers of linear programs, the choice among them, and the loop over a solver's
 * attempts. Costs are bytes counted over the rate of one fixed machine, never time measured: the
 * choice is the same on every machine. */
#include "lp/solver.h"

#include "base/cost.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double violation_limit = 1e-9; /* of the sum of fractions */
static const double gap_limit = 1e-8;

/* A library is preferred up to this ratio of costs. */
static const double preference = 1.1;

/* ---- descriptions -------------------------------------------------------------------------- */

static void solver_destroy(void *object) {
  bw_free(object);
}
static size_t solver_bytes(const void *object) {
  (void)object;
  return sizeof(bw_lp_solver);
}
static const bw_kind solver_kind = {"solver of linear programs", solver_destroy, solver_bytes};

static bw_status describe(bw_context *context, const bwi_lp_method *method,
                          const bw_lp_options *options, bw_lp_solver **result) {
  int max_iterations = options ? options->max_iterations : 0;
  if (max_iterations < 0)
    return bw_fail(context, BW_INVALID,
                   "max_iterations is %d: a positive number expected, or 0 for one chosen by the "
                   "size of the program",
                   max_iterations);
  bw_lp_solver *solver = BW_NEW0(context, bw_lp_solver, 1);
  if (!solver)
    return BW_MEMORY;
  bw_object_init(solver, &solver_kind);
  solver->name = method->name;
  solver->max_iterations = max_iterations;
  *result = solver;
  return BW_OK;
}

bw_status bw_lp_dual_simplex(bw_context *context, const bw_lp_options *options,
                             bw_lp_solver **solver) {
  return describe(context, &bwi_lp_dual_simplex, options, solver);
}

bw_status bw_lp_glpk(bw_context *context, const bw_lp_options *options, bw_lp_solver **solver) {
  return describe(context, &bwi_lp_glpk, options, solver);
}

/* ---- the choice ---------------------------------------------------------------------------- */

/* Few chunks where a state serves one thread only: each opens its own. */
enum { CHUNKS = 8, MANY = 64, GRAIN = 4 };

int64_t bwi_lp_grain(const bwi_lp_choice *choice, int64_t count) {
  if (choice->method->of_thread)
    return (count + CHUNKS - 1) / CHUNKS;
  return count > MANY ? GRAIN : 1;
}

/* Of one program, and of the state that few of them share. */
static double predict(const bwi_lp_method *method, const bwi_linear_program *program) {
  double bytes = method->cost(program, method->iterations(program)).bytes;
  if (method->of_thread)
    bytes += method->open_cost(program).bytes / GRAIN;
  return bytes / BWI_COST_BYTES_PER_SECOND; /* products with all columns are bound by memory */
}

void bwi_lp_choose(const bwi_linear_program *program, const bw_lp_solver *solver,
                   bwi_lp_choice *choice) {
  *choice = (bwi_lp_choice){0};
  if (solver) {
    choice->method =
        strcmp(solver->name, bwi_lp_glpk.name) == 0 ? &bwi_lp_glpk : &bwi_lp_dual_simplex;
    choice->max_iterations = solver->max_iterations;
    snprintf(choice->reason, sizeof choice->reason, "%s was given", solver->name);
    return;
  }
  double own = predict(&bwi_lp_dual_simplex, program), library = predict(&bwi_lp_glpk, program);
  bool take_library = library <= preference * own;
  choice->method = take_library ? &bwi_lp_glpk : &bwi_lp_dual_simplex;
  choice->other = take_library ? &bwi_lp_dual_simplex : &bwi_lp_glpk;
  choice->predicted = take_library ? library : own;
  choice->rival = take_library ? own : library;
  snprintf(choice->reason, sizeof choice->reason,
           "%s is predicted to take %.2g s for a program of %d rows and %d columns, %s %.2g s",
           choice->method->name, choice->predicted, program->rows, program->columns,
           choice->other->name, choice->rival);
}

/* ---- reports ------------------------------------------------------------------------------- */

void bwi_lp_counts_add(bwi_lp_counts *sum, const bwi_lp_counts *term) {
  sum->programs += term->programs;
  sum->by_other += term->by_other;
  sum->iterations += term->iterations;
  sum->flops += term->flops;
  sum->seconds += term->seconds;
  sum->violation = fmax(sum->violation, term->violation);
}

void bwi_lp_report(const bwi_lp_choice *choice, const bwi_linear_program *program, int states,
                   const bwi_lp_counts *counts, bw_solver_report *report) {
  const bwi_lp_method *method = choice->method;
  *report = (bw_solver_report){.solver = method->solver,
                               .backend = method->backend,
                               .preconditioner = "",
                               .predicted_cost = choice->predicted * (double)counts->programs,
                               .rival_cost = choice->rival * (double)counts->programs,
                               .flops = counts->flops,
                               .bytes = states * method->memory(program),
                               .seconds = counts->seconds,
                               .iterations = (int)fmin((double)counts->iterations, INT32_MAX),
                               .residual = counts->violation};
  if (counts->by_other > 0)
    snprintf(
        report->reason, sizeof report->reason,
        "%s was chosen by predicted cost, but failed on %lld of %lld programs, which went to %s",
        method->name, (long long)counts->by_other, (long long)counts->programs,
        choice->other->name);
  else
    memcpy(report->reason, choice->reason, sizeof report->reason);
}

/* ---- solving ------------------------------------------------------------------------------- */

bw_status bwi_lp_open(bw_context *context, const bwi_linear_program *program,
                      const bwi_lp_choice *choice, bwi_lp_workspace *workspace) {
  *workspace = (bwi_lp_workspace){.program = program, .choice = choice};
  workspace->vertex.basic = BW_NEW(context, int32_t, program->rows);
  workspace->vertex.at_upper = BW_NEW(context, uint8_t, program->columns);
  if (workspace->vertex.basic && workspace->vertex.at_upper)
    return BW_OK;
  bwi_lp_close(workspace);
  return BW_MEMORY;
}

void bwi_lp_leave_thread(bwi_lp_workspace *workspace) {
  const bwi_lp_method *method[2] = {workspace->choice->method, workspace->choice->other};
  for (int i = 0; i < 2; i++)
    if (method[i] && method[i]->of_thread) {
      method[i]->close(workspace->state[i]);
      workspace->state[i] = NULL;
    }
}

void bwi_lp_close(bwi_lp_workspace *workspace) {
  if (!workspace->choice)
    return;
  const bwi_lp_method *method[2] = {workspace->choice->method, workspace->choice->other};
  for (int i = 0; i < 2; i++)
    if (method[i])
      method[i]->close(workspace->state[i]);
  bw_free(workspace->vertex.basic);
  bw_free(workspace->vertex.at_upper);
  *workspace = (bwi_lp_workspace){0};
}

static bool is_good(const bwi_solution *solution) {
  return solution->violation <= violation_limit && solution->gap <= gap_limit;
}

/* All attempts of one method; *found where one passes the check. */
static bw_status attempt_all(bw_context *context, bwi_lp_workspace *workspace, int which,
                             const double *cost, bwi_solution *solution, bool *found) {
  const bwi_lp_choice *choice = workspace->choice;
  const bwi_lp_method *method = which == 0 ? choice->method : choice->other;
  const bwi_linear_program *program = workspace->program;
  bw_status status = BW_OK;
  for (int attempt = 0; attempt < method->attempts; attempt++) {
    status = BW_OK;
    if (!workspace->state[which])
      status = method->open(context, program, choice->max_iterations, &workspace->state[which]);
    if (status == BW_OK)
      status = method->solve(context, workspace->state[which], cost, attempt, &workspace->vertex);
    if (status == BW_CONVERGENCE) {
      status = BW_OK;
      continue;
    }
    if (status != BW_OK)
      goto done;
    workspace->counts.iterations += workspace->vertex.iterations;
    workspace->counts.flops += method->cost(program, workspace->vertex.iterations).flops;
    BW_TRY(bwi_linear_program_evaluate(context, program, cost, &workspace->vertex, solution));
    if (is_good(solution)) {
      *found = true;
      goto done;
    }
  }
done:
  return status;
}

bw_status bwi_lp_solve(bw_context *context, bwi_lp_workspace *workspace, const double *cost,
                       bwi_solution *solution) {
  bw_status status = BW_OK;
  bool found = false;
  const char *name = workspace->choice->method->name;
  const bwi_lp_method *other = workspace->choice->other;
  double start = bw_seconds();
  solution->violation = solution->gap = INFINITY;
  for (int which = 0; which < 2 && !found; which++) {
    if (which == 1 && !other)
      break;
    BW_TRY(attempt_all(context, workspace, which, cost, solution, &found));
    workspace->counts.by_other += which;
  }
  workspace->counts.programs++;
  workspace->counts.seconds += bw_seconds() - start;
  if (!found && isinf(solution->violation)) {
    status = bw_fail(
        context, BW_CONVERGENCE,
        "a linear program of %d rows and %d columns was not solved by %s%s%s: it ran into "
        "its limit of iterations, out of memory, or into numerical difficulties%s",
        workspace->program->rows, workspace->program->columns, name, other ? " or " : "",
        other ? other->name : "", other ? "" : "; leave the choice of the solver to \"auto\"");
  } else if (!found) {
    status =
        bw_fail(context, BW_CONVERGENCE,
                "a linear program of %d rows and %d columns was not solved by %s%s%s: the "
                "last attempt misses its rows by %g of the sum of fractions and the optimum "
                "by %g of its value",
                workspace->program->rows, workspace->program->columns, name, other ? " or " : "",
                other ? other->name : "", solution->violation, solution->gap);
  } else {
    workspace->counts.violation = fmax(workspace->counts.violation, solution->violation);
  }
done:
  return status;
}
