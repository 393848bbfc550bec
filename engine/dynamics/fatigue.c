/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fatigue (docs/theory/dynamics.md): rainflow counting, and Miner's sum over the cycles of the
 * signed von Mises stress. */
#include <math.h>
#include <string.h>

#include "barwright/analysis.h"
#include "barwright/dynamics.h"
#include "dynamics/internal.h"

enum { PLACES_PER_CHUNK = 256 };

/* ---- rainflow counting ----------------------------------------------------------------------- */

/* The values where a history turns, with its first and last one, into `turn`, which may be the
 * history; how many. */
static int64_t turning_points(int64_t count, const double *history, double *turn) {
  int64_t n = 0;
  for (int64_t i = 0; i < count; i++) {
    double value = history[i];
    if (n > 0 && value == turn[n - 1])
      continue;
    if (n > 1 && (turn[n - 1] - turn[n - 2]) * (value - turn[n - 1]) > 0)
      turn[n - 1] = value;
    else
      turn[n++] = value;
  }
  return n;
}

static bw_cycle cycle_of(double a, double b, double count) {
  return (bw_cycle){.range = fabs(a - b), .mean = (a + b) / 2, .count = count};
}

/* Cycles of turning points, at most one for each; `turn` is overwritten: it holds the stack. */
static int64_t count_cycles(int64_t count, double *turn, bw_cycle *cycle) {
  int64_t n = 0, cycles = 0, top = 0;
  for (int64_t i = 0; i < count; i++) {
    turn[top++] = turn[i];
    while (top - n >= 3) { /* n: where the stack begins */
      double *s = turn + top - 3;
      if (fabs(s[2] - s[1]) < fabs(s[1] - s[0]))
        break;
      if (top - n == 3) {
        cycle[cycles++] = cycle_of(s[0], s[1], 0.5);
        n++;
      } else {
        cycle[cycles++] = cycle_of(s[0], s[1], 1);
        s[0] = s[2];
        top -= 2;
      }
    }
  }
  for (; n + 1 < top; n++)
    cycle[cycles++] = cycle_of(turn[n], turn[n + 1], 0.5);
  return cycles;
}

bw_status bw_rainflow(bw_context *context, int64_t count, const double *history, bw_cycle **cycle,
                      int64_t *cycle_count) {
  bw_status status = BW_OK;
  double *turn = BW_NEW(context, double, count + 1);
  bw_cycle *found = BW_NEW(context, bw_cycle, count + 1);
  BW_TRY_MEMORY(turn && found);
  for (int64_t i = 0; i < count; i++)
    if (!(fabs(history[i]) < INFINITY))
      BW_TRY(bw_fail(context, BW_INVALID, "value %lld of the history is not finite",
                     (long long)i + 1));
  *cycle_count = count_cycles(turning_points(count, history, turn), turn, found);
  *cycle = found;
  found = NULL;
done:
  bw_free(turn);
  bw_free(found);
  return status;
}

/* ---- damage ---------------------------------------------------------------------------------- */

void bw_life_curve_default(bw_life_curve *curve) {
  *curve = (bw_life_curve){.cycles = 1e6, .exponent = 5};
}

typedef struct damage_data {
  const bw_life_curve *curve;
  int case_count;
  const double *const *stress;
  int64_t steps;
  const double *factor;
  double *damage;
  double *tensor;  /* for each worker: steps x 6 */
  double *history; /* steps */
  bw_cycle *cycle; /* steps */
} damage_data;

static double damage_of(const bw_life_curve *curve, const bw_cycle *cycle) {
  double amplitude = cycle->range / 2;
  if (curve->strength > 0 && cycle->mean > 0) {
    if (cycle->mean >= curve->strength)
      return INFINITY;
    amplitude /= 1 - cycle->mean / curve->strength;
  }
  if (amplitude <= curve->limit)
    return 0;
  return cycle->count / curve->cycles * pow(amplitude / curve->amplitude, curve->exponent);
}

/* Von Mises stress with the sign by which it goes along the tensor where it is largest; negative
 * there under compression. */
static void sign_stress(int64_t steps, const double *tensor, double *history) {
  int64_t most = 0;
  for (int64_t t = 0; t < steps; t++) {
    history[t] = bw_von_mises(tensor + 6 * t);
    most = history[t] > history[most] ? t : most;
  }
  const double *peak = tensor + 6 * most;
  double trace = peak[0] + peak[1] + peak[2];
  double sign = trace < -1e-6 * history[most] ? -1 : 1;
  for (int64_t t = 0; t < steps; t++)
    history[t] *= bwi_von_mises_product(tensor + 6 * t, peak) < 0 ? -sign : sign;
}

static bw_status damage_places(void *data, int64_t begin, int64_t end, int worker) {
  const damage_data *d = data;
  double *tensor = d->tensor + 6 * d->steps * worker, *history = d->history + d->steps * worker;
  bw_cycle *cycle = d->cycle + d->steps * worker;
  for (int64_t i = begin; i < end; i++) {
    memset(tensor, 0, 6 * (size_t)d->steps * sizeof *tensor);
    for (int64_t t = 0; t < d->steps; t++)
      for (int c = 0; c < d->case_count; c++)
        for (int k = 0; k < 6; k++)
          tensor[6 * t + k] += d->factor[t * d->case_count + c] * d->stress[c][6 * i + k];
    sign_stress(d->steps, tensor, history);
    int64_t n = count_cycles(turning_points(d->steps, history, history), history, cycle);
    d->damage[i] = 0;
    for (int64_t k = 0; k < n; k++)
      d->damage[i] += damage_of(d->curve, &cycle[k]);
  }
  return BW_OK;
}

bw_status bwi_check_curve(bw_context *context, const bw_life_curve *c) {
  if (!(c->amplitude > 0 && c->amplitude < INFINITY))
    return bw_fail(context, BW_INVALID,
                   "the amplitude of the life curve is %g Pa; it must be above 0", c->amplitude);
  if (!(c->cycles > 0 && c->cycles < INFINITY))
    return bw_fail(context, BW_INVALID, "the cycles of the life curve are %g; they must be above 0",
                   c->cycles);
  if (!(c->exponent >= 1 && c->exponent < INFINITY))
    return bw_fail(context, BW_INVALID,
                   "the exponent of the life curve is %g; it must be 1 or more", c->exponent);
  if (!(c->limit >= 0 && c->limit < INFINITY && c->strength >= 0 && c->strength < INFINITY))
    return bw_fail(context, BW_INVALID,
                   "limit and strength of the life curve are %g and %g Pa; they must be 0 or more",
                   c->limit, c->strength);
  return BW_OK;
}

bw_status bw_fatigue_damage(bw_context *context, const bw_life_curve *curve, int64_t place_count,
                            int case_count, const double *const *stress, int64_t steps,
                            const double *factor, double *damage) {
  bw_status status = BW_OK;
  int64_t threads = bw_threads(context);
  damage_data d = {.curve = curve,
                   .case_count = case_count,
                   .stress = stress,
                   .steps = steps,
                   .factor = factor,
                   .damage = damage};
  BW_TRY(bwi_check_curve(context, curve));
  for (int c = 0; c < case_count; c++)
    for (int64_t i = 0; i < 6 * place_count; i++)
      if (!(fabs(stress[c][i]) < INFINITY))
        BW_TRY(bw_fail(context, BW_INVALID, "the stress of load case %d is not finite", c + 1));
  for (int64_t i = 0; i < steps * case_count; i++)
    if (!(fabs(factor[i]) < INFINITY))
      BW_TRY(bw_fail(context, BW_INVALID, "the history of load case %d is not finite",
                     (int)(i % case_count) + 1));
  d.tensor = BW_NEW(context, double, 6 * steps * threads + 1);
  d.history = BW_NEW(context, double, steps *threads + 1);
  d.cycle = BW_NEW(context, bw_cycle, steps * threads + 1);
  BW_TRY_MEMORY(d.tensor && d.history && d.cycle);
  BW_TRY(bw_parallel(context, place_count, PLACES_PER_CHUNK, damage_places, &d));
done:
  bw_free(d.tensor);
  bw_free(d.history);
  bw_free(d.cycle);
  return status;
}

/* ---- static solutions ------------------------------------------------------------------------ */

/* Points of two materials of one mesh are the same where their regions meet at the same nodes. */
static bool same_points(const bw_stress_points *a, const bw_stress_points *b) {
  bool same = a->count == b->count && !a->point == !b->point;
  for (int32_t i = 0; same && a->point && i < a->count; i++)
    same = a->point[i].node == b->point[i].node;
  return same;
}

bw_status bw_static_damage(bw_context *context, const bw_life_curve *curve, int case_count,
                           const bw_static *const *result, int64_t steps, const double *factor,
                           double *damage) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = result[0]->model->mesh;
  bw_stress_points points = {0}, own = {0};
  double *stress = NULL, *of_point = NULL;
  const double **of_case = BW_NEW(context, const double *, case_count);
  BW_TRY_MEMORY(of_case);
  BW_TRY(bw_stress_points_create(context, mesh, result[0]->model->material, &points));
  stress = BW_NEW(context, double, 6 * (int64_t)points.count * case_count);
  of_point = BW_NEW(context, double, points.count);
  BW_TRY_MEMORY(stress && of_point);
  for (int c = 0; c < case_count; c++) {
    const bw_model *model = result[c]->model;
    double *to = stress + 6 * (int64_t)points.count * c;
    if (model->mesh != mesh)
      BW_TRY(
          bw_fail(context, BW_INVALID, "load case %d is on another mesh than load case 1", c + 1));
    BW_TRY(bw_stress_points_create(context, mesh, model->material, &own));
    if (!same_points(&points, &own))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "load case %d has other regions of one material than load case 1: solve both "
                     "with the same materials",
                     c + 1));
    BW_TRY(bw_static_point_stress(context, result[c], &own, to));
    bw_stress_points_clear(&own);
    of_case[c] = to;
  }
  BW_TRY(bw_fatigue_damage(context, curve, points.count, case_count, of_case, steps, factor,
                           of_point));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    damage[i] = 0;
    for (int32_t k = i; k >= 0; k = points.point ? points.point[k].next : -1)
      damage[i] = fmax(damage[i], of_point[k]);
  }
done:
  bw_stress_points_clear(&points);
  bw_stress_points_clear(&own);
  bw_free(of_case);
  bw_free(stress);
  bw_free(of_point);
  return status;
}
