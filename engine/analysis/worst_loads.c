/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Worst loads: one linear program per objective, solved in parallel by the solver that lp/solver.h
 * chooses. Every linear program starts from the same place, so an answer depends neither on its
 * neighbours nor on the number of threads. */
#include "analysis/load_program.h"

#include <math.h>
#include <string.h>

static const double violation_limit = 1e-9; /* of the total force */

typedef struct loads_scratch {
  double *cost, *fraction, *multiplier;
  double *dual; /* of pressures anywhere, for hands */
  bwi_lp_workspace lp;
} loads_scratch;

struct bwi_loads {
  bwi_load_program *program;
  bwi_lp_choice choice;
  int32_t pressures;
  int workers;
  loads_scratch *scratch; /* per worker */
  bwi_hands *hands;       /* NULL: pressure may act anywhere */
};

typedef struct loads_work {
  bw_context *context;
  bwi_loads *loads;
  const double *objective;
  double *pressure, *value, *dual;
} loads_work;

static bw_status scratch_fill(const loads_work *work, loads_scratch *scratch) {
  size_t n = (size_t)work->loads->program->lp.columns, m = (size_t)work->loads->program->lp.rows;
  bw_context *context = work->context;
  if (!scratch->cost)
    scratch->cost = BW_NEW(context, double, n);
  if (!scratch->fraction)
    scratch->fraction = BW_NEW(context, double, n);
  if (!scratch->multiplier)
    scratch->multiplier = BW_NEW(context, double, m);
  if (!scratch->dual)
    scratch->dual = BW_NEW(context, double, (size_t)work->loads->program->rigid_mode_count + 1);
  if (!scratch->cost || !scratch->fraction || !scratch->multiplier || !scratch->dual)
    return BW_MEMORY;
  if (scratch->lp.program)
    return BW_OK;
  return bwi_lp_open(context, &work->loads->program->lp, &work->loads->choice, &scratch->lp);
}

static void scratch_clear(loads_scratch *scratch) {
  bw_free(scratch->cost);
  bw_free(scratch->fraction);
  bw_free(scratch->multiplier);
  bw_free(scratch->dual);
  bwi_lp_close(&scratch->lp);
}

/* Gains per share of the total force, scaled to a largest one of 1. Returns the scale. */
static bw_status gains(const loads_work *work, int64_t i, double *cost, double *scale) {
  const bwi_load_program *program = work->loads->program;
  const double *f = work->objective + (size_t)i * (size_t)work->loads->pressures;
  *scale = 0;
  for (int32_t j = 0; j < program->lp.columns; j++) {
    int32_t from = program->source[j];
    cost[j] = from < 0 ? 0 : f[from] / program->area[j];
    if (!isfinite(cost[j]))
      return bw_fail(work->context, BW_INVALID, "objective %lld has the entry %g for pressure %d",
                     (long long)i + 1, f[from], from + 1);
    *scale = fmax(*scale, fabs(cost[j]));
  }
  for (int32_t j = 0; j<program->lp.columns && * scale> 0; j++)
    cost[j] /= *scale;
  return BW_OK;
}

/* Pressures, value and raw multipliers from scaled ones. */
static void hand_over(const loads_work *work, int64_t i, const bwi_solution *solution, double scale,
                      double *dual) {
  const bwi_load_program *program = work->loads->program;
  double *p = work->pressure + (size_t)i * (size_t)work->loads->pressures;
  const double *f = work->objective + (size_t)i * (size_t)work->loads->pressures;
  double value = 0;
  for (int32_t j = 0; j < program->lp.columns; j++) {
    if (program->source[j] < 0)
      continue;
    /* At its bound a pressure is p_max exactly. */
    p[program->source[j]] =
        solution->fraction[j] >= program->lp.upper[j]
            ? program->pressure
            : fmin(program->pressure, solution->fraction[j] * program->force / program->area[j]);
  }
  for (int32_t j = 0; j < work->loads->pressures; j++)
    value += f[j] * p[j];
  work->value[i] = value;
  memset(dual, 0, ((size_t)program->rigid_mode_count + 1) * sizeof *dual);
  for (int32_t k = 0; k < program->body_count; k++) {
    const bwi_balance *body = &program->body[k];
    for (int m = 0; m < body->motions; m++) {
      double sum = 0;
      for (int l = 0; l < body->rows; l++)
        sum += solution->multiplier[body->row + l] * body->transform[l][m];
      dual[body->motion[m]] = sum * scale;
    }
  }
  dual[program->rigid_mode_count] = solution->multiplier[program->lp.rows - 1] * scale;
}

static bw_status solve_one(const loads_work *work, int64_t i, loads_scratch *scratch) {
  bw_status status = BW_OK;
  const bwi_loads *loads = work->loads;
  bwi_solution solution = {.fraction = scratch->fraction, .multiplier = scratch->multiplier};
  double scale, *dual = scratch->dual;
  if (work->dual)
    dual = work->dual + (size_t)i * ((size_t)loads->program->rigid_mode_count + 1);
  BW_TRY(bw_check_cancel(work->context));
  BW_TRY(gains(work, i, scratch->cost, &scale));
  status = bwi_lp_solve(work->context, &scratch->lp, scratch->cost, &solution);
  if (status == BW_CONVERGENCE)
    bw_detail_number(work->context, "objective", (double)i + 1);
  if (status != BW_OK)
    goto done;
  hand_over(work, i, &solution, scale, dual);
  if (loads->hands)
    BW_TRY(bwi_hands_solve(work->context, loads->hands,
                           work->objective + (size_t)i * (size_t)loads->pressures, dual,
                           work->pressure + (size_t)i * (size_t)loads->pressures, &work->value[i]));
done:
  return status;
}

static bw_status loads_body(void *data, int64_t begin, int64_t end, int worker) {
  const loads_work *work = (const loads_work *)data;
  bw_status status = BW_OK;
  loads_scratch *scratch = &work->loads->scratch[worker];
  BW_TRY(scratch_fill(work, scratch));
  for (int64_t i = begin; i < end; i++)
    BW_TRY(solve_one(work, i, scratch));
done:
  if (scratch->lp.program)
    bwi_lp_leave_thread(&scratch->lp);
  return status;
}

/* Uniform pressure is in balance. Where the basis does not hold it, the largest total force in
 * balance is a linear program of its own, which no pressure at all fulfils: it is always
 * feasible. */
static bw_status check_balance(bw_context *context, const bw_pressure_basis *basis,
                               const bw_dof_map *dof_map, const bw_worst_load_options *options) {
  bw_worst_load_options less = *options;
  bw_status status = BW_OK;
  double largest = 0;
  if (basis->complete || options->force_is_max || dof_map->rigid_mode_count == 0)
    return BW_OK;
  double *pressure = BW_NEW(context, double, basis->count);
  if (!pressure)
    return BW_MEMORY;
  less.force_is_max = true;
  less.hands = 0;
  BW_TRY(bw_worst_loads(context, basis, dof_map, &less, 1, basis->area, pressure, &largest, NULL,
                        NULL));
  if (largest < options->force * (1 - violation_limit)) {
    status = bw_fail(context, BW_INFEASIBLE,
                     "a total force of %g N was requested, but on the admissible surface pressures "
                     "up to %g Pa are in equilibrium up to a total of %g N only: forbid less, fix "
                     "the part, or allow a smaller force (force_is_max)",
                     options->force, options->pressure, largest);
    bw_detail_number(context, "force", options->force);
    bw_detail_number(context, "largest_force", largest);
  }
done:
  bw_free(pressure);
  return status;
}

bw_status bwi_loads_create(bw_context *context, const bw_pressure_basis *basis,
                           const bw_dof_map *dof_map, const bw_worst_load_options *options,
                           bwi_loads **result) {
  if (dof_map->prescribed)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a support prescribes a displacement that is not zero: the worst loads are "
                   "implemented for fixed supports only");
  bw_status status = check_balance(context, basis, dof_map, options);
  if (status != BW_OK)
    return status;
  if (basis->mesh->node_count != dof_map->mesh->node_count)
    return bw_fail(context, BW_INVALID, "the pressures have %d nodes and the DOF map has %d",
                   basis->mesh->node_count, dof_map->mesh->node_count);
  bwi_loads *loads = BW_NEW0(context, bwi_loads, 1);
  if (!loads)
    return BW_MEMORY;
  loads->pressures = basis->count;
  loads->workers = bw_threads(context);
  loads->scratch = BW_NEW0(context, loads_scratch, loads->workers);
  BW_TRY_MEMORY(loads->scratch);
  BW_TRY(bwi_load_program_create(context, basis, dof_map, options, &loads->program));
  bwi_lp_choose(&loads->program->lp, options->lp, &loads->choice);
  if (options->hands != 0)
    BW_TRY(bwi_hands_create(context, basis, dof_map, options, &loads->hands));
done:
  if (status == BW_OK)
    *result = loads;
  else
    bwi_loads_destroy(loads);
  return status;
}

void bwi_loads_destroy(bwi_loads *loads) {
  if (!loads)
    return;
  for (int w = 0; loads->scratch && w < loads->workers; w++)
    scratch_clear(&loads->scratch[w]);
  bw_free(loads->scratch);
  bwi_hands_destroy(loads->hands);
  bwi_load_program_destroy(loads->program);
  bw_free(loads);
}

bw_status bwi_loads_solve(bw_context *context, bwi_loads *loads, int64_t count,
                          const double *objective, double *pressure, double *value, double *dual) {
  loads_work work = {context, loads, objective, pressure, value, dual};
  return bw_parallel(context, count, bwi_lp_grain(&loads->choice, count), loads_body, &work);
}

void bwi_loads_count(const bwi_loads *loads, bwi_lp_counts *sum) {
  for (int w = 0; w < loads->workers; w++)
    bwi_lp_counts_add(sum, &loads->scratch[w].lp.counts);
}

void bwi_loads_report(const bwi_loads *loads, const bwi_lp_counts *counts,
                      bw_solver_report *report) {
  bwi_lp_counts own = {0};
  if (!counts)
    bwi_loads_count(loads, &own);
  bwi_lp_report(&loads->choice, &loads->program->lp, loads->workers, counts ? counts : &own,
                report);
}

bw_status bw_worst_loads(bw_context *context, const bw_pressure_basis *basis,
                         const bw_dof_map *dof_map, const bw_worst_load_options *options,
                         int64_t count, const double *objective, double *pressure, double *value,
                         double *dual, bw_solver_report *report) {
  bwi_loads *loads = NULL;
  bw_status status = BW_OK;
  BW_TRY(bwi_loads_create(context, basis, dof_map, options, &loads));
  BW_TRY(bwi_loads_solve(context, loads, count, objective, pressure, value, dual));
  if (report)
    bwi_loads_report(loads, NULL, report);
done:
  bwi_loads_destroy(loads);
  return status;
}
