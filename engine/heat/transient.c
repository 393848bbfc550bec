/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Heat in time, with an estimate of the error of each step.
 *
 * An estimate compares the step with the polynomial through the states before it. They lie on a
 * smooth curve like the new one, so that the difference is P times a derivative in time, and the
 * error of the step C times the same one. With backward Euler the line through the last two states
 * has the slope that the equation has at the last one, so that P is the square of the step. */
#include "heat/internal.h"

#include <math.h>
#include <string.h>

enum { STATES = 3 };

typedef struct bwi_heat_transient {
  bwi_heat_system system;
  bw_heat_scheme scheme;
  int conditions;
  int states;                                          /* that are known, up to STATES */
  double *state[STATES];                               /* (K, node_count) the present one first */
  double interval[STATES];                             /* (s) from state k + 1 to state k */
  double *next, *q, *next_q, *remainder, *base, *rest; /* node_count */
  double *heat_in; /* (W, condition_count) at the present time, without reactions */
} inner;

static void transient_destroy(void *object) {
  bw_heat_transient *t = object;
  inner *s = t->inner;
  if (s) {
    bwi_heat_system_close(&s->system);
    for (int k = 0; k < STATES; k++)
      bw_free(s->state[k]);
    bw_free(s->next);
    bw_free(s->q);
    bw_free(s->next_q);
    bw_free(s->remainder);
    bw_free(s->base);
    bw_free(s->rest);
    bw_free(s->heat_in);
    bw_free(s);
  }
  bw_release(t->now);
  bw_release(t->heat);
  bw_free(t);
}

static size_t transient_bytes(const void *object) {
  const bw_heat_transient *t = object;
  const bwi_heat_system *s = &t->inner->system;
  return sizeof *t + sizeof(inner) + 9 * (size_t)t->heat->mesh->node_count * sizeof(double) +
         2 * (size_t)s->pattern->block_count * sizeof(double) +
         (s->matrix ? bw_bytes(s->matrix) : 0);
}

static const bw_kind transient_kind = {"heat transient", transient_destroy, transient_bytes};

static bw_status check(bw_context *context, const bw_heat *heat,
                       const bw_heat_transient_options *options) {
  for (int32_t i = 0; i < bw_material_part_count(heat->material); i++) {
    const bw_material *part = bw_material_part(heat->material, i);
    if (!(part->density > 0) || !(part->thermal.heat_capacity > 0))
      return bw_fail(context, BW_INVALID,
                     "material %s has no %s, which heat in time needs: give one in %s", part->name,
                     part->density > 0 ? "heat capacity" : "density",
                     part->density > 0 ? "J/(kg K)" : "kg/m3");
  }
  if (options && options->lumped && heat->mesh->order == 2)
    return bw_fail(context, BW_INVALID,
                   "a lumped capacity is for linear elements: quadratic ones lose their accuracy");
  if (options && options->steps.error)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the error of the highest temperature is estimated of steady states: the error "
                   "of a step in time is that of the transient");
  if (options && (unsigned)options->scheme > BW_HEAT_BDF2)
    return bw_fail(context, BW_INVALID, "there is no scheme %d", (int)options->scheme);
  return BW_OK;
}

bw_status bw_heat_transient_create(bw_context *context, const bw_heat *heat, const double *initial,
                                   const bw_heat_transient_options *options,
                                   bw_heat_transient **transient) {
  bw_status status = BW_OK;
  size_t n = (size_t)heat->mesh->node_count;
  bw_heat_transient *made = NULL;
  bw_heat_solution *now = NULL;
  BW_TRY(check(context, heat, options));
  made = BW_NEW0(context, bw_heat_transient, 1);
  BW_TRY_MEMORY(made);
  bw_object_init(made, &transient_kind);
  made->heat = bw_retain(heat);
  inner *s = made->inner = BW_NEW0(context, inner, 1);
  BW_TRY_MEMORY(s);
  s->scheme = options ? options->scheme : BW_HEAT_EULER;
  s->conditions = heat->condition_count;
  BW_TRY(bwi_heat_system_open(context, heat, options ? &options->steps : NULL, true,
                              options && options->lumped, &s->system));
  s->system.options.guess = NULL;
  bool all = true;
  for (int k = 0; k < STATES; k++)
    all = (s->state[k] = BW_NEW(context, double, n)) && all;
  s->next = BW_NEW(context, double, n);
  s->q = BW_NEW(context, double, n);
  s->next_q = BW_NEW(context, double, n);
  s->remainder = BW_NEW(context, double, n);
  s->base = BW_NEW(context, double, n);
  s->rest = BW_NEW(context, double, n);
  s->heat_in = BW_NEW(context, double, heat->condition_count);
  BW_TRY_MEMORY(all && s->next && s->q && s->next_q && s->remainder && s->base && s->rest &&
                s->heat_in);
  for (size_t i = 0; i < n; i++)
    if (!isfinite(initial[i]))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "the temperature at the start is not a finite number at "
                     "node %lld",
                     (long long)i + 1));
  memcpy(s->state[0], initial, n * sizeof *initial);
  bwi_heat_prescribe(&s->system, s->state[0]);
  s->states = 1;
  BW_TRY(bwi_heat_inflow(context, &s->system, s->state[0], s->q, s->heat_in));
  BW_TRY(bwi_heat_solution_create(context, heat, &now));
  memcpy(now->temperature, s->state[0], n * sizeof *initial);
  bwi_heat_find_highest(now);
  now->report = s->system.report;
  made->now = now;
  *transient = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}

/* The terms of a step of length h. */
static bwi_heat_task task_of(inner *s, int64_t steps, double h, int *order) {
  size_t n = (size_t)s->system.heat->mesh->node_count;
  bwi_heat_task task = {.rate = 1 / h, .base = s->state[0], .part = 1};
  *order = 1;
  if (s->scheme == BW_HEAT_CRANK_NICOLSON && steps >= 2) {
    *order = 2;
    task.part = 0.5;
    for (size_t i = 0; i < n; i++)
      s->rest[i] = 0.5 * s->q[i];
    task.rest = s->rest;
  }
  if (s->scheme == BW_HEAT_BDF2 && s->states >= 2) {
    double w = h / s->interval[0], a = (1 + 2 * w) / (1 + w);
    *order = 2;
    task.rate = a / h;
    for (size_t i = 0; i < n; i++)
      s->base[i] = ((1 + w) * s->state[0][i] - w * w / (1 + w) * s->state[1][i]) / a;
    task.base = s->base;
  }
  return task;
}

/* The largest error of a step of length h at a node; 0 where too few states are known. */
static double estimate(const inner *s, int order, double h) {
  size_t n = (size_t)s->system.heat->mesh->node_count;
  double a = s->interval[0], b = s->interval[1], most = 0;
  if (s->states <= order)
    return 0;
  double P = h * h, C = 0.5 * h * h;
  if (order == 2) {
    P = h * (h + a) * (h + a + b) / 6;
    C = s->scheme == BW_HEAT_BDF2 ? h * h * (h + a) * (h + a) / (6 * (2 * h + a)) : h * h * h / 12;
  }
  for (size_t i = 0; i < n; i++) {
    double t0 = s->state[0][i], t1 = s->state[1][i], first = (t0 - t1) / a, value = t0 + h * first;
    if (order == 2) /* Newton's divided differences */
      value += h * (h + a) * (first - (t1 - s->state[2][i]) / b) / (a + b);
    most = fmax(most, fabs(s->next[i] - value));
  }
  return C / P * most;
}

bw_status bw_heat_transient_step(bw_context *context, bw_heat_transient *transient, double step,
                                 double limit, bool *taken) {
  bw_status status = BW_OK;
  inner *s = transient->inner;
  size_t n = (size_t)transient->heat->mesh->node_count;
  bw_heat_solution *made = NULL;
  int order;
  if (!(step > 0) || !isfinite(step))
    return bw_fail(context, BW_INVALID, "a step of time is above 0 s, not %g", step);
  if (transient->heat->condition_count != s->conditions)
    return bw_fail(context, BW_INVALID,
                   "%d conditions were added since the start: begin a new transient",
                   transient->heat->condition_count - s->conditions);
  BW_TRY(bwi_heat_solution_create(context, transient->heat, &made));
  bwi_heat_task task = task_of(s, transient->steps, step, &order);
  memcpy(s->next, s->state[0], n * sizeof *s->next);
  bwi_heat_prescribe(&s->system, s->next);
  const char *reason = s->system.report.reason;
  bw_solver_report clean = {0};
  memcpy(clean.reason, reason, sizeof clean.reason);
  s->system.report = clean;
  BW_TRY(bwi_heat_solve(context, &s->system, &task, s->next, s->next_q, made->heat_in, s->remainder,
                        &made->stored, &made->iterations, &made->change));
  transient->error = estimate(s, order, step);
  if (taken)
    *taken = !(limit > 0 && transient->error > limit);
  if (limit > 0 && transient->error > limit)
    goto done;
  for (int c = 0; c < s->conditions; c++) { /* means over the step, as its equation has them */
    double now = made->heat_in[c];
    made->heat_in[c] = task.part * now + (1 - task.part) * s->heat_in[c];
    s->heat_in[c] = now;
  }
  memcpy(made->temperature, s->next, n * sizeof *s->next);
  bwi_heat_balance(&s->system, s->remainder, made);
  made->time = transient->now->time + step;
  made->report = s->system.report;
  double *last = s->state[STATES - 1], *q = s->q;
  for (int k = STATES - 1; k > 0; k--) {
    s->state[k] = s->state[k - 1];
    s->interval[k] = s->interval[k - 1];
  }
  s->state[0] = s->next;
  s->next = last;
  s->interval[0] = step;
  s->q = s->next_q;
  s->next_q = q;
  if (s->states < STATES)
    s->states++;
  transient->steps++;
  transient->object.revision++;
  bw_release(transient->now);
  transient->now = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}
