/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Admissible loads that are likely to buckle a body first. On the span of a few shapes x_i,
 * x_i . K_sigma(p) x_j is linear in the pressure p: one adjoint solve for each pair of shapes gives
 * its coefficients A_ij. After that a step of the ascent is a linear program and the largest
 * eigenvalue of a small matrix (docs/theory/stability.md, "Worst-case buckling"). */
#include <math.h>
#include <string.h>

#include "analysis/load_program.h"
#include "barwright/buckling.h"
#include "base/dense.h"

enum {
  MOST_SHAPES = 60,
  PAIRS = 16, /* that are solved for in one block */
  STEPS = 30, /* of an ascent at most */
  SWEEPS = 60 /* of Jacobi rotations */
};
/* A step that gains less ends an ascent. */
static const double gain = 1e-6;
/* Combinations of shapes of less strain energy, over that of the shapes, do not count. */
static const double dependent = 1e-8;
/* Loads whose pressures differ by less than this part of the largest one are the same. */
static const double same = 1e-6;

void bw_buckling_starts_options_default(bw_buckling_starts_options *options) {
  *options = (bw_buckling_starts_options){.restarts = 48, .seed = 1};
}

typedef struct reduced {
  bw_context *context;
  const bw_system *system;
  const bw_pressure_basis *basis;
  const double *shape;
  double sign; /* of x . K_sigma x in 1 / lambda: -1, or 1 for negative factors */
  int count, pairs, rank;
  int (*pair)[2];
  double *coefficient; /* pairs x pressures: sign A_ij */
  double *work;        /* pairs: x_i . K x_j */
  double *span;        /* rank x count: combinations of shapes of unit energy */
  double *block;       /* PAIRS x node_count x 3 */
  int first;
  /* ascents */
  int ascents, active;
  int *number;                          /* active */
  double *combination;                  /* ascents x rank, unit vectors */
  double *objective, *trial, *pressure; /* ascents x pressures; the first two by place */
  double *trial_value, *value;          /* ascents */
} reduced;

/* ---- coefficients ---------------------------------------------------------------------------- */

static double *field(const reduced *r, int64_t k) {
  return r->block + k * 3 * (int64_t)r->system->mesh->node_count;
}

static bw_status derive_pairs(void *data, int64_t begin, int64_t end, int worker) {
  const reduced *r = data;
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)r->system->mesh->node_count;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    const int *pair = r->pair[r->first + k];
    BW_TRY(bw_stress_stiffness_gradient(r->context, r->system->mesh, r->system->material,
                                        r->shape + pair[0] * size, r->shape + pair[1] * size,
                                        field(r, k), &r->work[r->first + k]));
  }
done:
  return status;
}

static bw_status gather_pairs(void *data, int64_t begin, int64_t end, int worker) {
  const reduced *r = data;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    double *to = r->coefficient + (r->first + k) * r->basis->count;
    bw_pressure_gradient(r->basis, field(r, k), to);
    for (int32_t j = 0; j < r->basis->count; j++)
      to[j] *= r->sign;
  }
  return BW_OK;
}

static bw_status find_coefficients(bw_context *context, bw_system *system, reduced *r) {
  bw_status status = BW_OK;
  for (r->first = 0; r->first < r->pairs; r->first += PAIRS) {
    int count = r->pairs - r->first < PAIRS ? r->pairs - r->first : PAIRS;
    bw_progress(context, "loads against pairs of shapes", (double)r->first / r->pairs);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_parallel(context, count, 1, derive_pairs, r));
    BW_TRY(bw_system_solve(context, system, count, r->block, r->block));
    BW_TRY(bw_parallel(context, count, 1, gather_pairs, r));
  }
  bw_progress(context, "loads against pairs of shapes", 1);
done:
  return status;
}

/* Combinations of the shapes, orthonormal in K. */
static bw_status find_span(bw_context *context, reduced *r) {
  int n = r->count;
  double gram[MOST_SHAPES * MOST_SHAPES], vector[MOST_SHAPES * MOST_SHAPES], scale[MOST_SHAPES];
  for (int k = 0; k < r->pairs; k++)
    if (r->pair[k][0] == r->pair[k][1])
      scale[r->pair[k][0]] = r->work[k] > 0 ? 1 / sqrt(r->work[k]) : 0;
  for (int k = 0; k < r->pairs; k++) {
    int i = r->pair[k][0], j = r->pair[k][1];
    gram[i * n + j] = gram[j * n + i] = scale[i] * scale[j] * r->work[k];
  }
  bwi_symmetric_eigen(n, n, gram, vector, 1e-30, SWEEPS);
  for (int k = 0; k < n; k++) {
    if (!(gram[k * n + k] > dependent))
      continue;
    for (int i = 0; i < n; i++)
      r->span[r->rank * n + i] = vector[k * n + i] * scale[i] / sqrt(gram[k * n + k]);
    r->rank++;
  }
  if (r->rank == 0)
    return bw_fail(context, BW_INVALID, "none of %d shapes has strain energy", n);
  return BW_OK;
}

/* ---- ascents --------------------------------------------------------------------------------- */

/* Gains of the pressures for the combination of an ascent. */
static bw_status make_objectives(void *data, int64_t begin, int64_t end, int worker) {
  const reduced *r = data;
  int32_t columns = r->basis->count;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    const double *z = r->combination + (int64_t)r->number[k] * r->rank;
    double *objective = r->objective + k * columns, x[MOST_SHAPES] = {0};
    for (int m = 0; m < r->rank; m++)
      for (int i = 0; i < r->count; i++)
        x[i] += z[m] * r->span[m * r->count + i];
    memset(objective, 0, (size_t)columns * sizeof *objective);
    for (int q = 0; q < r->pairs; q++) {
      int a = r->pair[q][0], b = r->pair[q][1];
      double weight = (a == b ? 1 : 2) * x[a] * x[b];
      const double *from = r->coefficient + (int64_t)q * columns;
      for (int32_t j = 0; j < columns; j++)
        objective[j] += weight * from[j];
    }
  }
  return BW_OK;
}

/* The largest 1 / lambda of a pressure on the span, and its combination. */
static double largest_on_span(const reduced *r, const double *pressure, double *z) {
  int n = r->rank, best = 0;
  double whole[MOST_SHAPES * MOST_SHAPES], half[MOST_SHAPES * MOST_SHAPES];
  double a[MOST_SHAPES * MOST_SHAPES], vector[MOST_SHAPES * MOST_SHAPES];
  for (int q = 0; q < r->pairs; q++) {
    int i = r->pair[q][0], j = r->pair[q][1];
    whole[i * r->count + j] = whole[j * r->count + i] =
        bwi_dot(r->basis->count, r->coefficient + (int64_t)q * r->basis->count, pressure);
  }
  for (int m = 0; m < n; m++)
    for (int j = 0; j < r->count; j++) {
      half[m * r->count + j] = 0;
      for (int i = 0; i < r->count; i++)
        half[m * r->count + j] += r->span[m * r->count + i] * whole[i * r->count + j];
    }
  for (int m = 0; m < n; m++)
    for (int k = 0; k <= m; k++)
      a[m * n + k] = a[k * n + m] = bwi_dot(r->count, half + m * r->count, r->span + k * r->count);
  bwi_symmetric_eigen(n, n, a, vector, 1e-30, SWEEPS);
  for (int k = 1; k < n; k++)
    best = a[k * n + k] > a[best * n + best] ? k : best;
  memcpy(z, vector + best * n, (size_t)n * sizeof *z);
  return a[best * n + best];
}

static bw_status take_steps(void *data, int64_t begin, int64_t end, int worker) {
  const reduced *r = data;
  int32_t columns = r->basis->count;
  (void)worker;
  for (int64_t k = begin; k < end; k++)
    r->trial_value[k] = largest_on_span(r, r->trial + k * columns,
                                        r->combination + (int64_t)r->number[k] * r->rank);
  return BW_OK;
}

/* Solves the linear programs of the ascents that go on, and drops those that gain no more. */
static bw_status step(bw_context *context, reduced *r, bwi_loads *loads, double *optimum) {
  bw_status status = BW_OK;
  size_t columns = (size_t)r->basis->count;
  int kept = 0;
  BW_TRY(bwi_loads_solve(context, loads, r->active, r->objective, r->trial, optimum, NULL));
  BW_TRY(bw_parallel(context, r->active, 1, take_steps, r));
  for (int k = 0; k < r->active; k++) {
    int number = r->number[k];
    double before = r->value[number], now = r->trial_value[k];
    if (!(now > before))
      continue;
    memcpy(r->pressure + (size_t)number * columns, r->trial + (size_t)k * columns,
           columns * sizeof *r->pressure);
    r->value[number] = now;
    if (now > before + gain * fabs(before))
      r->number[kept++] = number;
  }
  r->active = kept;
done:
  return status;
}

/* Ascents begin at the loads that move the body most along each shape and against it, at each
 * shape, and at random combinations. */
static bw_status ascend(bw_context *context, reduced *r, const bw_buckling_starts_options *options,
                        bwi_loads *loads) {
  bw_status status = BW_OK;
  int32_t columns = r->basis->count;
  int64_t size = 3 * (int64_t)r->system->mesh->node_count;
  bw_random random;
  double *optimum = BW_NEW(context, double, r->ascents);
  BW_TRY_MEMORY(optimum);
  bw_random_seed(&random, options->seed);
  for (int k = 0; k < r->ascents; k++) {
    double *z = r->combination + (int64_t)k * r->rank, square = 0;
    for (int m = 0; m < r->rank; m++) {
      z[m] = k < 2 * r->count             ? 0
             : k < 2 * r->count + r->rank ? m == k - 2 * r->count
                                          : bw_random_normal(&random);
      square += z[m] * z[m];
    }
    for (int m = 0; m < r->rank && square > 0; m++)
      z[m] /= sqrt(square);
    r->value[k] = -INFINITY;
  }
  /* those along shapes have no combination yet */
  r->active = 2 * r->count;
  for (int k = 0; k < r->active; k++) {
    double *objective = r->objective + (int64_t)k * columns;
    r->number[k] = k;
    bw_pressure_gradient(r->basis, r->shape + k / 2 * size, objective);
    for (int32_t j = 0; j < columns && k % 2; j++)
      objective[j] = -objective[j];
  }
  BW_TRY(step(context, r, loads, optimum));
  r->active = r->ascents;
  for (int k = 0; k < r->ascents; k++)
    r->number[k] = k;
  for (int s = 0; s < STEPS && r->active > 0; s++) {
    bw_progress(context, "starts of worst-case buckling", (double)s / STEPS);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_parallel(context, r->active, 1, make_objectives, r));
    BW_TRY(step(context, r, loads, optimum));
  }
  bw_progress(context, "starts of worst-case buckling", 1);
done:
  bw_free(optimum);
  return status;
}

/* ---- the result ------------------------------------------------------------------------------ */

static bool alike(const reduced *r, const double *a, const double *b, double pressure) {
  for (int32_t j = 0; j < r->basis->count; j++)
    if (fabs(a[j] - b[j]) > same * pressure)
      return false;
  return true;
}

/* The best of those not taken; ties by number. */
static int next_best(const reduced *r) {
  int best = -1;
  for (int k = 0; k < r->ascents; k++)
    if (r->value[k] > 0 && (best < 0 || r->value[k] > r->value[best]))
      best = k;
  return best;
}

static void take_best(reduced *r, double limit, int wanted, int *found, double *pressure,
                      double *value) {
  int32_t columns = r->basis->count;
  *found = 0;
  for (int best = next_best(r); *found < wanted && best >= 0; best = next_best(r)) {
    const double *from = r->pressure + (int64_t)best * columns;
    bool known = false;
    for (int k = 0; k < *found && !known; k++)
      known = alike(r, from, pressure + (int64_t)k * columns, limit);
    if (!known) {
      memcpy(pressure + (int64_t)*found * columns, from, (size_t)columns * sizeof *pressure);
      value[(*found)++] = r->value[best];
    }
    r->value[best] = -INFINITY;
  }
}

static bw_status check(bw_context *context, const bw_buckling_starts_options *options, int count) {
  if (count < 1 || count > MOST_SHAPES)
    return bw_fail(context, BW_INVALID, "%d shapes were given: 1 to %d expected", count,
                   MOST_SHAPES);
  if (options->restarts < 0 || options->restarts > 100000)
    return bw_fail(context, BW_INVALID, "%d restarts: 0 to 100000 expected", options->restarts);
  return BW_OK;
}

bw_status bw_buckling_starts(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                             const bw_buckling_starts_options *options, int count,
                             const double *shapes, int wanted, int *found, double *pressure,
                             double *value, bw_solver_report *report) {
  bw_status status = BW_OK;
  bwi_loads *loads = NULL;
  reduced r = {.context = context,
               .system = system,
               .basis = basis,
               .shape = shapes,
               .sign = options->reversed ? 1 : -1,
               .count = count,
               .pairs = count * (count + 1) / 2};
  *found = 0;
  BW_TRY(check(context, options, count));
  BW_TRY(bwi_loads_create(context, basis, system->dof_map, &options->loads, &loads));
  int64_t columns = basis->count, size = 3 * (int64_t)system->mesh->node_count;
  r.pair = bw_alloc(context, (size_t)r.pairs, sizeof *r.pair);
  r.work = BW_NEW(context, double, r.pairs);
  r.coefficient = BW_NEW(context, double, r.pairs *columns);
  r.span = BW_NEW(context, double, count *count);
  r.block = BW_NEW(context, double, PAIRS *size);
  BW_TRY_MEMORY(r.pair && r.work && r.coefficient && r.span && r.block);
  for (int j = 0, k = 0; j < count; j++)
    for (int i = 0; i <= j; i++, k++) {
      r.pair[k][0] = i;
      r.pair[k][1] = j;
    }
  BW_TRY(find_coefficients(context, system, &r));
  BW_TRY(find_span(context, &r));
  r.ascents = 2 * count + r.rank + options->restarts;
  r.number = BW_NEW(context, int, r.ascents);
  r.combination = BW_NEW(context, double, (int64_t)r.ascents *r.rank);
  r.objective = BW_NEW(context, double, r.ascents *columns);
  r.trial = BW_NEW(context, double, r.ascents *columns);
  r.pressure = BW_NEW(context, double, r.ascents *columns);
  r.trial_value = BW_NEW(context, double, r.ascents);
  r.value = BW_NEW(context, double, r.ascents);
  BW_TRY_MEMORY(r.number && r.combination && r.objective && r.trial && r.pressure &&
                r.trial_value && r.value);
  BW_TRY(ascend(context, &r, options, loads));
  take_best(&r, options->loads.pressure, wanted, found, pressure, value);
  if (report)
    bwi_loads_report(loads, NULL, report);
done:
  bwi_loads_destroy(loads);
  bw_free(r.pair);
  bw_free(r.work);
  bw_free(r.coefficient);
  bw_free(r.span);
  bw_free(r.block);
  bw_free(r.number);
  bw_free(r.combination);
  bw_free(r.objective);
  bw_free(r.trial);
  bw_free(r.pressure);
  bw_free(r.trial_value);
  bw_free(r.value);
  return status;
}
