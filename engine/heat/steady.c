/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solutions of heat, their balance, and the steady state. */
#include "heat/internal.h"

#include <math.h>
#include <string.h>

static void solution_destroy(void *object) {
  bw_heat_solution *solution = object;
  bw_release(solution->mesh);
  bw_release(solution->material);
  bw_free(solution->temperature);
  bw_free(solution->reaction);
  bw_free(solution->heat_in);
  bw_free(solution);
}

static size_t solution_bytes(const void *object) {
  const bw_heat_solution *solution = object;
  return sizeof *solution + 2 * (size_t)solution->mesh->node_count * sizeof(double);
}

static const bw_kind solution_kind = {"heat solution", solution_destroy, solution_bytes};

bw_status bwi_heat_solution_create(bw_context *context, const bw_heat *heat,
                                   bw_heat_solution **solution) {
  bw_heat_solution *made = BW_NEW0(context, bw_heat_solution, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &solution_kind);
  made->mesh = bw_retain(heat->mesh);
  made->material = bw_retain(heat->material);
  made->condition_count = heat->condition_count;
  made->temperature = BW_NEW0(context, double, heat->mesh->node_count);
  made->reaction = BW_NEW0(context, double, heat->mesh->node_count);
  made->heat_in = BW_NEW0(context, double, heat->condition_count);
  if (!made->temperature || !made->reaction || !made->heat_in) {
    bw_release(made);
    return BW_MEMORY;
  }
  *solution = made;
  return BW_OK;
}

void bwi_heat_find_highest(bw_heat_solution *solution) {
  solution->highest = -INFINITY;
  solution->highest_error = -1;
  for (int32_t i = 0; i < solution->mesh->node_count; i++)
    if (solution->temperature[i] > solution->highest) {
      solution->highest = solution->temperature[i];
      solution->highest_node = i;
    }
}

void bwi_heat_balance(const bwi_heat_system *system, const double *remainder,
                      bw_heat_solution *solution) {
  bwi_heat_find_highest(solution);
  solution->throughput = fmax(-solution->stored, 0);
  for (int c = 0; c < solution->condition_count; c++)
    if (!bwi_heat_joins(&system->heat->condition[c])) /* it goes out again */
      solution->throughput += fmax(solution->heat_in[c], 0);
  for (int32_t i = 0; i < solution->mesh->node_count; i++) {
    int32_t by = system->prescribe[i];
    solution->reaction[i] = by >= 0 ? remainder[i] : 0;
    solution->throughput += fmax(solution->reaction[i], 0);
    if (by >= 0)
      solution->heat_in[by] += remainder[i];
  }
  solution->imbalance = -solution->stored;
  for (int c = 0; c < solution->condition_count; c++)
    if (bwi_heat_joins(&system->heat->condition[c]))
      solution->heat_in[c] += system->through[c];
    else
      solution->imbalance += solution->heat_in[c];
}

/* Where the iterations begin: between the temperatures that conditions name; with radiation at the
 * highest of them, from where Newton's method falls to the solution. */
static double first_temperature(const bwi_heat_system *system) {
  double sum = 0, highest = 0;
  int count = 0;
  for (int c = 0; c < system->heat->condition_count; c++) {
    const bw_heat_condition *condition = &system->heat->condition[c];
    if (condition->kind != BW_HEAT_TEMPERATURE && !bwi_heat_is_film(condition))
      continue;
    sum += condition->value;
    highest = fmax(highest, condition->value);
    count++;
  }
  if (system->radiates)
    return highest > 0 ? highest : 300;
  return count ? sum / count : 0;
}

/* work: node_count. */
static bw_status find_error(bw_context *context, bwi_heat_system *system, bw_heat_solution *made,
                            double *work) {
  bw_status status = bwi_heat_dual(context, system, made->temperature, made->highest_node, work);
  return status == BW_OK ? bwi_heat_highest_error(context, made, work, &made->highest_error)
                         : status;
}

bw_status bw_heat_steady(bw_context *context, const bw_heat *heat, const bw_heat_options *options,
                         bw_heat_solution **solution) {
  bw_status status = BW_OK;
  int32_t n = heat->mesh->node_count;
  bwi_heat_system system = {0};
  bw_heat_solution *made = NULL;
  double *work = BW_NEW(context, double, 2 * (size_t)n);
  const bwi_heat_task task = {.part = 1};
  BW_TRY_MEMORY(work);
  BW_TRY(bwi_heat_system_open(context, heat, options, false, false, &system));
  BW_TRY(bwi_heat_solution_create(context, heat, &made));
  double first = first_temperature(&system);
  for (int32_t i = 0; i < n; i++) {
    made->temperature[i] = system.options.guess ? system.options.guess[i] : first;
    if (!isfinite(made->temperature[i]))
      BW_TRY(bw_fail(context, BW_INVALID, "the guess at node %d is not a finite number", i + 1));
  }
  bwi_heat_prescribe(&system, made->temperature);
  BW_TRY(bwi_heat_solve(context, &system, &task, made->temperature, work, made->heat_in, work + n,
                        &made->stored, &made->iterations, &made->change));
  bwi_heat_balance(&system, work + n, made);
  made->report = system.report;
  if (system.options.error)
    BW_TRY(find_error(context, &system, made, work));
  *solution = made;
  made = NULL;
done:
  bw_release(made);
  bwi_heat_system_close(&system);
  bw_free(work);
  return status;
}
