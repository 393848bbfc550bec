/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of a problem, by any of the iterations: a Sturm count that shows whether
 * one was missed, recovery, and true residuals. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "eigen/iteration.h"
#include "linear/blas.h"
#include "linear/multivector.h"

enum {
  RECOVERIES = 6, /* that bring nothing, one after the other */
  FURTHER = 8,    /* modes beyond those wanted, where these show no gap */
  DOUBLED = 3,    /* times that number is doubled where those show none either */
  SIDES = 8,      /* fields that residuals are computed of at once */
  CLUSTER = 12    /* modes beyond those wanted that the last one's frequency may have */
};

/* ---- results ------------------------------------------------------------------------------- */

void bwi_eigen_result_clear(bwi_eigen_result *result) {
  bw_free(result->value);
  bw_free(result->vector);
  bw_free(result->residual);
  *result = (bwi_eigen_result){0};
}

/* |K x - lambda M x| / |lambda M x|. `work`: space for twice SIDES fields. */
static bw_status true_residuals(bw_context *context, const bwi_eigen_problem *problem, int count,
                                const double *value, const double *vector, double *residual,
                                double *work) {
  bw_status status = BW_OK;
  int64_t size = problem->size;
  for (int first = 0; first < count; first += SIDES) {
    int part = count - first < SIDES ? count - first : SIDES;
    const double *x = vector + first * size;
    double *kx = work, *mx = work + part * size;
    BW_TRY(problem->stiffness(context, problem->data, part, x, kx));
    BW_TRY(problem->mass(context, problem->data, part, x, mx));
    for (int k = 0; k < part; k++) {
      double difference = 0, whole = 0;
      for (int64_t i = k * size; i < (k + 1) * size; i++) {
        double m = value[first + k] * mx[i], d = kx[i] - m;
        difference += d * d;
        whole += m * m;
      }
      residual[first + k] = whole > 0 ? sqrt(difference / whole) : 0;
    }
  }
done:
  return status;
}

/* Take the first `count` pairs out. Where a true residual is above the tolerance, the vectors go
 * through Op once more, which divides what is left of high modes by their eigenvalues, and through
 * a Rayleigh-Ritz step. */
static bw_status take_out(bwi_eigen_iteration *it, int count, double tolerance,
                          bwi_eigen_result *result) {
  bw_status status = BW_OK;
  bw_context *context = it->context;
  const bwi_eigen_problem *problem = it->problem;
  int64_t size = it->size;
  double *x = NULL, *kx = NULL, *mx = NULL, *gram = NULL, *coefficients = NULL, *work = NULL,
         *next = NULL, *pair_work = NULL; /* kx, mx and next: only where there is a pass */
  result->value = BW_NEW(context, double, count);
  result->residual = BW_NEW(context, double, count);
  x = BW_NEW(context, double, count *size);
  pair_work = BW_NEW(context, double, 2 * (count < SIDES ? count : SIDES) * size);
  int length = 8 * count + 64;
  gram = BW_NEW(context, double, (int64_t)count *count);
  coefficients = BW_NEW(context, double, (int64_t)count *count);
  work = BW_NEW(context, double, length);
  BW_TRY_MEMORY(result->value && result->residual && x && pair_work && gram && coefficients &&
                work);
  BW_TRY(it->method->vectors(it, count, x));
  memcpy(result->value, it->value, (size_t)count * sizeof(double));
  BW_TRY(true_residuals(context, problem, count, result->value, x, result->residual, pair_work));
  double worst = 0;
  for (int k = 0; k < count; k++)
    worst = fmax(worst, result->residual[k]);
  for (int pass = 0; pass < 2 && worst > tolerance && problem->solve; pass++) {
    if (!next) {
      kx = BW_NEW(context, double, count *size);
      mx = BW_NEW(context, double, count *size);
      next = BW_NEW(context, double, count *size);
      BW_TRY_MEMORY(kx && mx && next);
    }
    BW_TRY(problem->mass(context, problem->data, count, x, mx));
    BW_TRY(problem->solve(context, problem->data, count, mx, next));
    it->solves += count;
    for (int k = 0; k < count; k++)
      for (int64_t i = k * size; i < (k + 1) * size; i++)
        next[i] *= result->value[k];
    BW_TRY(problem->stiffness(context, problem->data, count, next, kx));
    BW_TRY(problem->mass(context, problem->data, count, next, mx));
    BW_TRY(bwi_multi_dot(context, size, count, next, count, kx, coefficients));
    BW_TRY(bwi_multi_dot(context, size, count, next, count, mx, gram));
    int info = 0, kind = 1;
    double *value = work, *space = BW_NEW(context, double, length);
    BW_TRY_MEMORY(space);
    dsygv_(&kind, "V", "L", &count, coefficients, &count, gram, &count, value, space, &length,
           &info);
    bw_free(space);
    if (info != 0)
      break;
    BW_TRY(bwi_multi_combine(context, size, count, next, count, coefficients, count, 1, 0, kx));
    memcpy(next, kx, (size_t)count * (size_t)size * sizeof(double));
    double *recomputed = gram; /* count numbers of workspace */
    BW_TRY(true_residuals(context, problem, count, value, next, recomputed, pair_work));
    double now = 0;
    for (int k = 0; k < count; k++)
      now = fmax(now, recomputed[k]);
    if (!(now < worst))
      break;
    bool slow = now > 0.2 * worst;
    worst = now;
    double *other = x;
    x = next;
    next = other;
    memcpy(result->value, value, (size_t)count * sizeof(double));
    memcpy(result->residual, recomputed, (size_t)count * sizeof(double));
    if (slow)
      break;
  }
  result->count = count;
  result->vector = x;
  x = NULL;
done:
  bw_free(x);
  bw_free(next);
  bw_free(pair_work);
  bw_free(kx);
  bw_free(mx);
  bw_free(gram);
  bw_free(coefficients);
  bw_free(work);
  return status;
}

/* ---- the count ------------------------------------------------------------------------------- */

/* The end of the cluster that eigenvalue number `count` (from 1) belongs to, and a shift above it;
 * 0 when the known values do not show a gap. */
static int find_gap(const bwi_eigen_iteration *it, int count, int known, double fraction,
                    double *shift) {
  for (int n = count; n < known; n++) {
    double low = it->value[n - 1], high = it->value[n];
    if (high < INFINITY && high - low > 1e-4 * low) {
      *shift = low + fraction * fmin(high - low, 0.03 * low);
      return n;
    }
  }
  return 0;
}

/* More modes than those wanted, until there is a gap. They need not converge. */
static bw_status go_further(bwi_eigen_iteration *it, int count, double tolerance) {
  bw_status status = BW_OK;
  double shift;
  for (int k = 0; k <= DOUBLED && find_gap(it, count, it->known, 0, &shift) == 0; k++) {
    int64_t wanted = count + (FURTHER << k);
    if (wanted > it->problem->dimension)
      wanted = it->problem->dimension;
    if (wanted > it->most)
      break;
    status = it->method->iterate(it, (int)wanted, tolerance);
    if (status == BW_CONVERGENCE) { /* the modes wanted are there all the same */
      bw_clear_failure(it->context);
      return BW_OK;
    }
    if (status != BW_OK)
      break;
  }
  return status;
}

/* Count eigenvalues below a shift above the modes wanted, and find those that are missing, until
 * the count agrees. The modes wanted stand where it cannot be made to. */
static bw_status confirm(bwi_eigen_iteration *it, int count, double tolerance,
                         bwi_eigen_result *result) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = it->problem;
  for (int vain = 0; vain < RECOVERIES;) {
    double shift = 0, fraction = 0.3 + 0.1 * vain;
    int known = it->known < problem->dimension ? it->known : count;
    int n = find_gap(it, count, known, fraction, &shift);
    if (n == 0) { /* everything there is was found */
      if (it->known >= problem->dimension) {
        result->counted = true;
        break;
      }
      BW_TRY(go_further(it, count, tolerance));
      n = find_gap(it, count, it->known, fraction, &shift);
      if (n == 0)
        break;
    }
    if (it->method->converged(it, n, tolerance) < n)
      BW_TRY(it->method->iterate(it, n, tolerance));
    int64_t below = 0;
    bool trusted = false;
    BW_TRY(problem->below(it->context, problem->data, shift, &below, &trusted));
    if (!trusted || below < n) { /* rounding: once more elsewhere in the gap */
      vain++;
      continue;
    }
    if (below == n) {
      result->counted = true;
      break;
    }
    /* twice as many at most, which may show a gap below this one */
    int64_t most = 2 * (int64_t)n < it->most ? 2 * (int64_t)n : it->most;
    int wanted = below < most ? (int)below : (int)most, found = n;
    BW_TRY(it->method->deflate(it, n));
    BW_TRY(it->method->iterate(it, wanted, tolerance));
    while (found < it->known && it->value[found] < shift)
      found++;
    vain = found > n ? 0 : vain + 1;
    result->recovered += found - n;
  }
done:
  return status;
}

/* ---- modes of one eigenvalue ----------------------------------------------------------------- */

/* Converges the pairs behind the first `count` that may have the eigenvalue of the last of them,
 * each until it does or until its residual is a tenth of the distance; and where no pair behind
 * them is known and they were not counted one more, which shows whether that was all. *whole counts
 * those that do too, *near those looked at. *split: there may be more of them. */
static bw_status complete_cluster(bwi_eigen_iteration *it, int count, double tolerance,
                                  bool counted, int *whole, int *near, bool *split) {
  int n = *whole = *near = count;
  *split = false;
  while (bwi_eigen_may_be_equal(it, n)) {
    double apart = 1 - it->value[n - 1] / it->value[n], enough = fmax(tolerance, 0.1 * apart);
    bool shown = counted || n + 1 < it->known || n + 1 >= it->problem->dimension;
    if (n - count < CLUSTER && shown && it->method->converged(it, n + 1, enough) == n + 1) {
      *near = n + 1;
      if (enough > tolerance)
        return BW_OK;
      *whole = ++n;
      continue;
    }
    int next = shown ? n + 1 : n + 2;
    *split = n - count >= CLUSTER || next > it->most;
    if (*split)
      return BW_OK;
    bw_status status = it->method->iterate(it, next, enough);
    if (status == BW_CONVERGENCE) { /* those wanted are there all the same */
      bw_clear_failure(it->context);
      *split = true;
      return BW_OK;
    }
    if (status != BW_OK)
      return status;
    if (it->known < next || it->method->converged(it, n + 1, enough) <= n)
      return BW_OK; /* the whole space is searched */
  }
  return BW_OK;
}

/* Where nothing counts: an iteration from random vectors that are orthogonal to the modes looks for
 * one below the last, until its lowest pair is good to 1 %. That it finds none makes a missing mode
 * improbable, not impossible. Those that may have the eigenvalue of the last are completed first,
 * while the iteration still has its guards. */
static bw_status look_for_missing(bwi_eigen_iteration *it, int count, double tolerance,
                                  bwi_eigen_result *result) {
  bw_status status = BW_OK;
  for (int attempt = 0; attempt < RECOVERIES && !result->tested; attempt++) {
    int whole, near;
    bool split;
    BW_TRY(complete_cluster(it, count, tolerance, false, &whole, &near, &split));
    double last = it->value[count - 1];
    BW_TRY(it->method->deflate(it, near));
    BW_TRY(it->method->iterate(it, near < it->problem->dimension ? near + 1 : near, 1e-2));
    BW_TRY(it->method->iterate(it, count, tolerance));
    result->tested = it->value[count - 1] > last * (1 - 1e-7);
    result->recovered += !result->tested;
  }
done:
  return status;
}

/* The canonical basis of pairs of one eigenvalue, and the first `count` pairs of it. */
static bw_status make_canonical(bw_context *context, const bwi_eigen_problem *problem, int count,
                                double tolerance, bwi_eigen_result *result) {
  bw_status status = BW_OK;
  bool changed;
  double *work = NULL;
  BW_TRY(bwi_eigen_canonical(context, problem, tolerance, result, &changed));
  result->count = count;
  if (!changed)
    return BW_OK;
  work = BW_NEW(context, double, 2 * (count < SIDES ? count : SIDES) * problem->size);
  BW_TRY_MEMORY(work);
  BW_TRY(true_residuals(context, problem, count, result->value, result->vector, result->residual,
                        work));
done:
  bw_free(work);
  return status;
}

/* ---- the driver ------------------------------------------------------------------------------ */

bw_status bwi_eigen_lowest(bw_context *context, const bwi_eigen_problem *given,
                           const bw_modes_options *options, bwi_eigen_result *result) {
  bw_status status = BW_OK;
  bwi_eigen_problem complete = *given;
  const bwi_eigen_problem *problem = &complete;
  if (!complete.precondition) {
    complete.precondition = complete.solve;
    complete.preconditioner = "cholesky";
  }
  double start = bw_seconds();
  *result = (bwi_eigen_result){.report = {.solver = "", .backend = "", .preconditioner = ""}};
  bwi_eigen_setup setup = {.count = options->count, .seed = options->seed};
  if (setup.count > problem->dimension)
    setup.count = (int)problem->dimension;
  if (setup.count == 0)
    return BW_OK;
  int count = setup.count, whole = count, near;
  bool split = false;
  double tolerance = fmin(options->tolerance, 1e-6);
  bwi_eigen_iteration *it = NULL;
  const bwi_eigen_method *method = NULL;
  bwi_blas_enter();
  BW_TRY(bwi_eigen_choose(context, problem, options->solver, &setup, &method, &result->report));
  status = method->open(context, problem, &setup, &it);
  if (it) {
    it->method = method;
    it->context = context;
    it->problem = problem;
    it->size = problem->size;
    bw_random_seed(&it->random, setup.seed);
    snprintf(it->stage, sizeof it->stage, "%d mode%s", count, count == 1 ? "" : "s");
    bw_progress(context, it->stage, 0);
  }
  if (status != BW_OK)
    goto done;
  BW_TRY(method->iterate(it, count, tolerance));
  if (it->known < count)
    count = it->known;
  if (options->sturm && problem->below)
    BW_TRY(confirm(it, count, tolerance, result));
  else if (options->sturm)
    BW_TRY(look_for_missing(it, count, tolerance, result));
  BW_TRY(complete_cluster(it, count, tolerance, result->counted, &whole, &near, &split));
  BW_TRY(take_out(it, whole, options->tolerance, result));
  BW_TRY(make_canonical(context, problem, count, options->tolerance, result));
  if (split) {
    size_t used = strlen(result->report.reason);
    snprintf(result->report.reason + used, sizeof result->report.reason - used,
             "%smore modes may have the last frequency", used ? "; " : "");
  }
  result->solves = it->solves;
  result->report.seconds = bw_seconds() - start;
  result->report.bytes = it->bytes;
  result->report.iterations = it->iterations;
  for (int k = 0; k < count; k++)
    result->report.residual = fmax(result->report.residual, result->residual[k]);
done:
  bwi_blas_leave();
  if (it)
    method->close(it);
  if (status != BW_OK)
    bwi_eigen_result_clear(result);
  return status;
}
