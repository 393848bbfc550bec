/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of a problem: block Lanczos, a Sturm count that shows whether one was
 * missed, recovery, and true residuals. */
#include <math.h>
#include <string.h>

#include "eigen/block_lanczos.h"
#include "linear/blas.h"
#include "linear/multivector.h"

enum { RECOVERIES = 6 };

/* ---- results ------------------------------------------------------------------------------- */

void bwi_eigen_result_clear(bwi_eigen_result *result) {
  bw_free(result->value);
  bw_free(result->vector);
  bw_free(result->residual);
  *result = (bwi_eigen_result){0};
}

/* |K x - lambda M x| / |lambda M x|, and the part of it that rounding alone may cause. */
static bw_status true_residuals(bw_context *context, const bwi_eigen_problem *problem, int count,
                                const double *value, const double *vector, double *residual,
                                double *kx, double *mx) {
  bw_status status = BW_OK;
  BW_TRY(problem->stiffness(context, problem->data, count, vector, kx));
  BW_TRY(problem->mass(context, problem->data, count, vector, mx));
  for (int k = 0; k < count; k++) {
    double difference = 0, size = 0;
    for (int64_t i = k * problem->size; i < (k + 1) * problem->size; i++) {
      double m = value[k] * mx[i], d = kx[i] - m;
      difference += d * d;
      size += m * m;
    }
    residual[k] = size > 0 ? sqrt(difference / size) : 0;
  }
done:
  return status;
}

/* Take the first `count` Ritz pairs out. Where a true residual is above the tolerance, the vectors
 * go through Op once more, which divides what is left of high modes by their eigenvalues, and
 * through a Rayleigh-Ritz step. */
static bw_status take_out(bwi_lanczos *l, int count, double tolerance, bwi_eigen_result *result) {
  bw_status status = BW_OK;
  bw_context *context = l->context;
  const bwi_eigen_problem *problem = l->problem;
  int64_t size = l->size;
  double *x = NULL, *kx = NULL, *mx = NULL, *gram = NULL, *coefficients = NULL, *work = NULL,
         *next = NULL;
  bw_free(result->value);
  bw_free(result->vector);
  bw_free(result->residual);
  result->vector = result->value = result->residual = NULL;
  result->value = BW_NEW(context, double, count);
  result->residual = BW_NEW(context, double, count);
  x = BW_NEW(context, double, count *size);
  kx = BW_NEW(context, double, count *size);
  mx = BW_NEW(context, double, count *size);
  int length = 8 * count + 64;
  gram = BW_NEW(context, double, (int64_t)count *count);
  coefficients = BW_NEW(context, double, (int64_t)count *count);
  work = BW_NEW(context, double, length);
  if (!result->value || !result->residual || !x || !kx || !mx || !gram || !coefficients || !work) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_multi_combine(context, size, l->done, l->v, count, l->s, l->capacity, 1, 0, x));
  for (int k = 0; k < count; k++)
    result->value[k] = 1 / l->theta[k];
  BW_TRY(true_residuals(context, problem, count, result->value, x, result->residual, kx, mx));
  double worst = 0;
  for (int k = 0; k < count; k++)
    worst = fmax(worst, result->residual[k]);
  for (int pass = 0; pass < 2 && worst > tolerance; pass++) {
    if (!next) {
      next = BW_NEW(context, double, count *size);
      if (!next) {
        status = BW_MEMORY;
        goto done;
      }
    }
    BW_TRY(problem->solve(context, problem->data, count, mx, next));
    l->solves += count;
    for (int k = 0; k < count; k++)
      for (int64_t i = k * size; i < (k + 1) * size; i++)
        next[i] *= result->value[k];
    BW_TRY(problem->stiffness(context, problem->data, count, next, kx));
    BW_TRY(problem->mass(context, problem->data, count, next, mx));
    BW_TRY(bwi_multi_dot(context, size, count, next, count, kx, coefficients));
    BW_TRY(bwi_multi_dot(context, size, count, next, count, mx, gram));
    int info = 0, kind = 1;
    double *value = work, *space = BW_NEW(context, double, length);
    if (!space) {
      status = BW_MEMORY;
      goto done;
    }
    dsygv_(&kind, "V", "L", &count, coefficients, &count, gram, &count, value, space, &length,
           &info);
    bw_free(space);
    if (info != 0)
      break;
    BW_TRY(bwi_multi_combine(context, size, count, next, count, coefficients, count, 1, 0, kx));
    memcpy(next, kx, (size_t)count * (size_t)size * sizeof(double));
    double *recomputed = gram; /* count numbers of workspace */
    BW_TRY(true_residuals(context, problem, count, value, next, recomputed, kx, mx));
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
  bw_free(kx);
  bw_free(mx);
  bw_free(gram);
  bw_free(coefficients);
  bw_free(work);
  return status;
}

/* The end of the cluster that eigenvalue number `count` (from 1) belongs to, and a shift above it;
 * 0 when the known values do not show a gap. */
static int find_gap(const bwi_lanczos *l, int count, int known, double fraction, double *shift) {
  for (int n = count; n < known; n++) {
    double low = 1 / l->theta[n - 1], high = 1 / l->theta[n];
    if (l->theta[n] > 0 && high - low > 1e-4 * low) {
      *shift = low + fraction * fmin(high - low, 0.03 * low);
      return n;
    }
  }
  return 0;
}

bw_status bwi_eigen_lowest(bw_context *context, const bwi_eigen_problem *problem,
                           const bw_modes_options *options, bwi_eigen_result *result) {
  bw_status status = BW_OK;
  *result = (bwi_eigen_result){0};
  int count = options->count;
  if (count > problem->dimension)
    count = (int)problem->dimension;
  if (count == 0)
    return BW_OK;
  int64_t capacity = 3 * (int64_t)count + 6 * BWI_BLOCK;
  if (capacity > problem->dimension + BWI_BLOCK)
    capacity = problem->dimension + BWI_BLOCK;
  if (capacity * capacity > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d modes: more than this eigensolver can compute", count);
  int block = problem->dimension < BWI_BLOCK ? (int)problem->dimension : BWI_BLOCK;
  double tolerance = fmin(options->tolerance, 1e-6);
  bwi_lanczos l;
  bwi_blas_enter();
  BW_TRY(bwi_lanczos_open(context, problem, (int)capacity, block, options->seed, &l));
  BW_TRY(bwi_lanczos_random(&l));
  BW_TRY(bwi_lanczos_iterate(&l, count, tolerance));
  if (l.done < count)
    count = l.done;

  if (options->sturm && problem->below)
    for (int attempt = 0; attempt < RECOVERIES; attempt++) {
      double shift = 0, fraction = 0.3 + 0.1 * attempt;
      int known = l.done < (int)problem->dimension ? l.done : count;
      int n = find_gap(&l, count, known, fraction, &shift);
      if (n == 0) { /* everything there is was found */
        if (l.done >= problem->dimension) {
          result->counted = true;
          break;
        }
        status = bwi_lanczos_iterate(&l, count + BWI_BLOCK, tolerance);
        if (status == BW_CONVERGENCE) { /* the modes wanted are there all the same */
          bw_clear_failure(context);
          status = BW_OK;
          break;
        }
        if (status != BW_OK)
          goto done;
        n = find_gap(&l, count, l.done, fraction, &shift);
        if (n == 0)
          break;
      }
      if (bwi_lanczos_converged(&l, n, tolerance) < n)
        BW_TRY(bwi_lanczos_iterate(&l, n, tolerance));
      int64_t below = 0;
      bool trusted = false;
      BW_TRY(problem->below(context, problem->data, shift, &below, &trusted));
      if (!trusted || below < n) /* rounding: once more elsewhere in the gap */
        continue;
      if (below == n) {
        result->counted = true;
        break;
      }
      int missing = (int)(below - n), keep = n;
      BW_TRY(bwi_lanczos_restart(&l, keep, false));
      BW_TRY(bwi_lanczos_random(&l));
      BW_TRY(bwi_lanczos_iterate(
          &l, n + missing < l.capacity - block ? n + missing : l.capacity - block, tolerance));
      result->recovered += missing;
    }
  BW_TRY(take_out(&l, count, options->tolerance, result));
  result->solves = l.solves;
done:
  bwi_blas_leave();
  bwi_lanczos_clear(&l);
  if (status != BW_OK)
    bwi_eigen_result_clear(result);
  return status;
}
