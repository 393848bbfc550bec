/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A factor, or conjugate gradients over coarse solids: what either would cost.
 *
 * Costs are operations and bytes, counted, over the rates of one fixed machine, never time
 * measured: the same solution takes the same way everywhere. Those of the factor are known from its
 * analysis. An iteration of conjugate gradients is so many products, which read the elements'
 * stiffnesses, and a solution with the coarsest factor; how many there will be is what solutions of
 * the same elements have needed so far, and an estimate before there were any. The analysis costs
 * as much as some tens of iterations: it is put off until iterations have cost four times that, so
 * that short solutions go without. Then, and whenever it is kept from before, a Newton state takes
 * what is predicted to be cheaper; from iterations it goes over to the factor for good. No solution
 * may take more of them than a few factors cost.
 *
 * The search for a direction of negative curvature has to go on until its residual has fallen by
 * some sixteen factors of e, which is expensive where convergence is slow: one factor then does the
 * same if it comes out. */
#include "nonlinear/newton.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/cost.h"

/* Bytes for each entry of a factor that is made and solved with; of a product for each element; of
 * all vectors of an iteration for each node. */
#define ENTRY_BYTES 60.0
#define ELEMENT_BYTES 2800.0
#define NODE_BYTES 1200.0
enum { PRODUCTS = 5, PRODUCTS_BELOW = 4, PRODUCTS_TO_SET = 3 };
/* Factors of the coarsest solid, by its nodes (measured: 17 to 116, 170 to 970). */
#define COARSE_FLOPS 60.0
#define COARSE_ENTRIES 600.0
/* The analysis is done when it takes this part of what iterations took. */
#define ANALYSIS_FRACTION 0.25

/* Iterations of a solution before anything is known, which counts as so many solutions. */
#define GUESS 6.0
#define GUESS_WEIGHT 1.0
/* Iterations that cost as much as so many factors end a solution. */
#define LIMIT 3.0
#define MIN_ITERATIONS 10.0
/* Factors of e by which the search's residual falls: half of log(n 30 10^8), n some 10^4. */
#define SEARCH_NEPERS 16.0

/* Conjugate gradients in an iteration, where it is left open. */
#define MAX_CG 10000
/* Beyond so many nodes a factor is not even analysed. */
#define MANY_NODES 20000

static bw_status refused(bw_context *context, const bw_solver *solver) {
  char text[BW_SOLVER_TEXT];
  bw_solver_describe(solver, text);
  return bw_fail(context, BW_INVALID,
                 "the solver %s does not serve Newton's method: give cholesky of the backend "
                 "multifrontal in double precision without further options, or pcg with jacobi or, "
                 "in statics, two_level",
                 text);
}

bw_status bwi_newton_plan_make(bw_context *context, const bw_solver *solver, int coarse_count,
                               int32_t nodes, bwi_newton_plan *plan) {
  *plan = (bwi_newton_plan){.max_iterations = MAX_CG};
  if (!solver) {
    plan->iterative = plan->two_level = coarse_count > 0;
    plan->by_cost = coarse_count > 0 && nodes <= MANY_NODES;
    return BW_OK;
  }
  const bw_solver_options *o = &solver->options;
  if (o->kind == BW_SOLVER_CHOLESKY)
    return o->ordering == BW_ORDERING_AUTO && o->precision != 32 && !o->full &&
                   (o->backend == BW_BACKEND_AUTO || o->backend == BW_BACKEND_MULTIFRONTAL)
               ? BW_OK
               : refused(context, solver);
  bw_solver_kind m = o->preconditioner ? o->preconditioner->options.kind : BW_SOLVER_TWO_LEVEL;
  if (o->kind != BW_SOLVER_PCG || (m != BW_SOLVER_TWO_LEVEL && m != BW_SOLVER_JACOBI))
    return refused(context, solver);
  plan->iterative = true;
  plan->two_level = m == BW_SOLVER_TWO_LEVEL;
  plan->tolerance = o->tolerance;
  if (o->max_iterations > 0)
    plan->max_iterations = o->max_iterations;
  return BW_OK;
}

void bwi_newton_state_report(const bwi_newton_state *state, bw_solver_report *report) {
  const bw_newton_report *newton = state->report;
  const bwi_choice *c = &state->choice;
  const bwi_cg_statistics *cg = &state->newton->cg_statistics;
  bool pcg = state->iterative, given = state->options->solver != NULL;
  double flops = 0, entries = 0;
  *report = (bw_solver_report){
      .solver = bw_solver_word(pcg ? BW_SOLVER_PCG : BW_SOLVER_CHOLESKY),
      .backend = pcg ? "" : bw_backend_word(BW_BACKEND_MULTIFRONTAL),
      .preconditioner =
          !pcg ? ""
               : bw_solver_word(state->plan.two_level ? BW_SOLVER_TWO_LEVEL : BW_SOLVER_JACOBI),
      .bytes = (double)(bw_bytes(state->newton) + bwi_precondition_bytes(state->precondition)),
      .seconds = newton->seconds,
      .iterations = (int)fmin(INT32_MAX,
                              (double)newton->cg_iterations + (double)newton->stability_iterations),
      .residual = newton->residual};
  if (!pcg && bwi_direct_count(state->newton->direct, &flops, &entries))
    report->flops = flops * newton->factorisations;
  snprintf(report->reason, sizeof report->reason, "%s",
           given                    ? "it was given"
           : !state->plan.two_level ? "there are no coarse solids, which iterations would need"
           : !state->plan.by_cost   ? "a factor of so many nodes is predicted to cost more"
           : !pcg                   ? "iterations over coarse solids are predicted to cost more"
           : c->factor > 0          ? "a factor is predicted to cost more"
                                    : "iterations have cost too little to analyse a factor");
  if (state->plan.by_cost && c->open && c->factor > 0) {
    double iterations = c->set + c->iteration * cg->iterations / cg->solutions;
    report->predicted_cost = pcg ? iterations : c->factor;
    report->rival_cost = pcg ? c->factor : iterations;
  }
}

void bwi_choice_begin(bwi_newton_state *state) {
  const bw_newton_options *o = state->options;
  bwi_choice *c = &state->choice;
  const bw_grid *grid = state->solid->grid;
  if (!state->iterative || !state->plan.by_cost || state->free == 0)
    return;
  if (state->newton->cg_statistics.elements != grid->element_count)
    state->newton->cg_statistics = (bwi_cg_statistics){.elements = grid->element_count,
                                                       .solutions = GUESS_WEIGHT,
                                                       .iterations = GUESS * GUESS_WEIGHT,
                                                       .nepers = 3 * GUESS_WEIGHT};
  double product = ELEMENT_BYTES * (double)grid->element_count;
  double bytes = PRODUCTS * product + NODE_BYTES * (double)grid->node_count;
  c->set = PRODUCTS_TO_SET * product / BWI_COST_BYTES_PER_SECOND;
  for (int k = 0; k < o->coarse_count; k++) {
    const bw_grid *below = o->coarse[k]->grid;
    const bw_material_table *material_table = o->coarse[k]->material_table;
    double nodes = below->node_count;
    for (int64_t e = 0; e < below->element_count; e++)
      c->set += BWI_COST_TANGENT_POINT * material_table->material[below->material[e]]->rule->count;
    if (k + 1 < o->coarse_count)
      bytes += PRODUCTS_BELOW * ELEMENT_BYTES * (double)below->element_count;
    else {
      c->set += COARSE_FLOPS * nodes * nodes / BWI_COST_GRID_FLOPS_PER_SECOND;
      bytes += 2 * 8 * COARSE_ENTRIES * nodes;
    }
  }
  c->iteration = bytes / BWI_COST_BYTES_PER_SECOND;
  c->open = true;
}

/* What iterations with these elements took so far, over what an analysis takes. */
static double spent(const bwi_newton_state *state) {
  return state->choice.iteration * state->newton->cg_statistics.taken /
         (BWI_COST_GRID_ANALYSIS_NODE * state->solid->grid->node_count);
}

/* Analyses once that pays. */
static bw_status consider(bwi_newton_state *state) {
  bw_status status = BW_OK;
  bwi_choice *c = &state->choice;
  double flops, entries, before = bw_seconds();
  if (!c->open || c->factor > 0 || spent(state) * ANALYSIS_FRACTION < 1)
    return BW_OK;
  state->report->analyses += !bwi_direct_keeps(state->newton->direct, state->solid->pattern,
                                               state->load_case->constrained);
  BW_TRY(bwi_direct_analyse(state->context, state->newton->direct, state->solid->pattern,
                            state->load_case->constrained));
  state->report->seconds_analysis += bw_seconds() - before;
  bwi_direct_count(state->newton->direct, &flops, &entries);
  c->factor =
      flops / BWI_COST_GRID_FLOPS_PER_SECOND + ENTRY_BYTES * entries / BWI_COST_BYTES_PER_SECOND;
done:
  return status;
}

void bwi_choice_learn(bwi_newton_state *state, int32_t iterations, double residual) {
  bwi_cg_statistics *cg_statistics = &state->newton->cg_statistics;
  cg_statistics->solutions += 1;
  cg_statistics->iterations += iterations;
  cg_statistics->taken += iterations;
  cg_statistics->nepers += residual > 0 && residual < 1 ? -log(residual) : 0;
}

int32_t bwi_choice_limit(const bwi_newton_state *state) {
  const bwi_choice *c = &state->choice;
  double max = state->plan.max_iterations;
  if (c->factor > 0)
    max = fmin(max, fmax(MIN_ITERATIONS, LIMIT * c->factor / c->iteration));
  else if (c->open)
    max = fmin(max, fmax(MIN_ITERATIONS, (1 / ANALYSIS_FRACTION - spent(state)) *
                                             BWI_COST_GRID_ANALYSIS_NODE *
                                             state->solid->grid->node_count / c->iteration));
  return (int32_t)max;
}

bw_status bwi_choice_factor(bwi_newton_state *state, bool *factor) {
  const bwi_choice *c = &state->choice;
  const bwi_cg_statistics *cg_statistics = &state->newton->cg_statistics;
  bw_status status = consider(state);
  *factor =
      c->factor > 0 &&
      c->set + c->iteration * cg_statistics->iterations / cg_statistics->solutions > c->factor;
  return status;
}

bw_status bwi_choice_factor_search(bwi_newton_state *state, bool *factor) {
  const bwi_choice *c = &state->choice;
  const bwi_cg_statistics *cg_statistics = &state->newton->cg_statistics;
  bw_status status = consider(state);
  *factor = c->factor > 0 && c->iteration * SEARCH_NEPERS * cg_statistics->iterations /
                                     fmax(1, cg_statistics->nepers) >
                                 c->factor;
  return status;
}
