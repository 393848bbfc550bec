/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Block Lanczos: the steps. What they keep true stands in block_lanczos.h. */
#include <math.h>
#include <string.h>

#include "eigen/block_lanczos.h"
#include "linear/blas.h"
#include "linear/multivector.h"

enum { BLOCK = BWI_BLOCK, ATTEMPTS = 40 };

/* A vector that loses all but this fraction of itself by orthogonalisation lay in the basis. */
static const double dependent = 1e-9;

static void lanczos_close(bwi_eigen_iteration *iteration) {
  bwi_lanczos *l = (bwi_lanczos *)iteration;
  bw_free(l->base.value);
  bw_free(l->v);
  bw_free(l->mv);
  bw_free(l->t);
  bw_free(l->r);
  bw_free(l->theta);
  bw_free(l->s);
  bw_free(l);
}

/* Orthogonalise `count` vectors w against the first `against` of the basis, twice; the sum of the
 * coefficients goes to h (against x count). */
static bw_status orthogonalise(bwi_lanczos *l, int against, int count, double *w, double *h) {
  bw_status status = BW_OK;
  double *part = BW_NEW(l->base.context, double, (int64_t)against *count);
  if (!part)
    return BW_MEMORY;
  memset(h, 0, (size_t)against * (size_t)count * sizeof(double));
  for (int pass = 0; pass < 2; pass++) {
    BW_TRY(bwi_multi_dot(l->base.context, l->base.size, against, l->mv, count, w, part));
    BW_TRY(bwi_multi_combine(l->base.context, l->base.size, against, l->v, count, part, against, -1,
                             1, w));
    for (int64_t i = 0; i < (int64_t)against * count; i++)
      h[i] += part[i];
  }
done:
  bw_free(part);
  return status;
}

/* Append `count` vectors w, orthogonal to the basis, as the next block: Gram-Schmidt among
 * themselves, those that depend on the others dropped. Coefficients to r (ld = block): row k for
 * the k-th vector kept. taken[j]: length of what orthogonalisation took from vector j. */
static bw_status append(bwi_lanczos *l, int count, double *w, const double *taken, double *r) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  int first = l->used, kept = 0;
  memset(r, 0, (size_t)l->block * (size_t)l->block * sizeof(double));
  for (int j = 0; j < count && l->used < l->capacity; j++) {
    double *vector = w + j * l->base.size, *mv = l->mv + (int64_t)l->used * l->base.size,
           part[BLOCK], dot;
    for (int pass = 0; pass < 2 && kept > 0; pass++) {
      BW_TRY(bwi_multi_dot(l->base.context, l->base.size, kept,
                           l->mv + (int64_t)first * l->base.size, 1, vector, part));
      BW_TRY(bwi_multi_combine(l->base.context, l->base.size, kept,
                               l->v + (int64_t)first * l->base.size, 1, part, kept, -1, 1, vector));
      for (int k = 0; k < kept; k++)
        r[k + j * l->block] += part[k];
    }
    BW_TRY(problem->mass(l->base.context, problem->data, 1, vector, mv));
    BW_TRY(bwi_multi_dot(l->base.context, l->base.size, 1, vector, 1, mv, &dot));
    double norm = dot > 0 ? sqrt(dot) : 0;
    double whole = hypot(norm, taken[j]);
    for (int k = 0; k < kept; k++)
      whole = hypot(whole, r[k + j * l->block]);
    if (!(norm > dependent * whole))
      continue;
    double *v = l->v + (int64_t)l->used * l->base.size;
    for (int64_t i = 0; i < l->base.size; i++) {
      v[i] = vector[i] / norm;
      mv[i] /= norm;
    }
    r[kept + j * l->block] = norm;
    kept++;
    l->used++;
  }
done:
  return status;
}

/* Lengths of the columns of h: how much orthogonalisation took away. */
static void lengths(int rows, int count, const double *h, double *out) {
  for (int j = 0; j < count; j++) {
    double sum = 0;
    for (int i = 0; i < rows; i++)
      sum += h[i + (int64_t)j * rows] * h[i + (int64_t)j * rows];
    out[j] = sqrt(sum);
  }
}

/* Random vectors as the next block: at the start, and where the space that was searched is closed
 * under Op but something is missing. */
static bw_status random_block(bwi_lanczos *l) {
  bw_status status = BW_OK;
  double taken[BLOCK];
  double *w = BW_NEW(l->base.context, double, l->block * l->base.size);
  double *h = BW_NEW(l->base.context, double, (int64_t)l->used * l->block);
  BW_TRY_MEMORY(w && h);
  BW_TRY(bwi_eigen_random(&l->base, l->block, w));
  BW_TRY(orthogonalise(l, l->used, l->block, w, h));
  lengths(l->used, l->block, h, taken);
  BW_TRY(append(l, l->block, w, taken, l->r));
  l->r_columns = 0;
done:
  bw_free(w);
  bw_free(h);
  return status;
}

static bw_status lanczos_open(bw_context *context, const bwi_eigen_problem *problem,
                              const bwi_eigen_setup *setup, bwi_eigen_iteration **out) {
  int64_t capacity = setup->basis > 0 ? setup->basis : 3 * (int64_t)setup->count + 6 * BLOCK;
  if (capacity > problem->dimension + BLOCK)
    capacity = problem->dimension + BLOCK;
  if (capacity * capacity > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d modes: more than this eigensolver can compute",
                   setup->count);
  bwi_lanczos *l = BW_NEW0(context, bwi_lanczos, 1);
  if (!l)
    return BW_MEMORY;
  *out = &l->base;
  l->capacity = (int)capacity;
  l->block = problem->dimension < BLOCK ? (int)problem->dimension : BLOCK;
  l->base.most = l->capacity - l->block;
  l->base.bytes = 8.0 * (double)problem->size * (2 * l->capacity + l->block);
  l->v = BW_NEW(context, double, capacity * problem->size);
  l->mv = BW_NEW(context, double, capacity * problem->size);
  l->t = BW_NEW0(context, double, capacity *capacity);
  l->r = BW_NEW0(context, double, (int64_t)l->block * l->block);
  l->theta = BW_NEW(context, double, capacity);
  l->base.value = BW_NEW(context, double, capacity);
  l->s = BW_NEW(context, double, capacity *capacity);
  return l->v && l->mv && l->t && l->r && l->theta && l->base.value && l->s ? BW_OK : BW_MEMORY;
}

/* Send the next block through Op. */
static bw_status step(bwi_lanczos *l) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  int count = l->used - l->done, against = l->used;
  double taken[BLOCK];
  double *w = BW_NEW(l->base.context, double, count * l->base.size);
  double *h = BW_NEW(l->base.context, double, against *count);
  BW_TRY_MEMORY(w && h);
  BW_TRY(problem->solve(l->base.context, problem->data, count,
                        l->mv + (int64_t)l->done * l->base.size, w));
  l->base.solves += count;
  BW_TRY(orthogonalise(l, against, count, w, h));
  for (int j = 0; j < count; j++)
    for (int i = 0; i <= l->done + j; i++)
      l->t[i + (int64_t)(l->done + j) * l->capacity] = h[i + j * against];
  l->done = l->used;
  l->r_columns = count;
  lengths(against, count, h, taken);
  BW_TRY(append(l, count, w, taken, l->r));
done:
  bw_free(w);
  bw_free(h);
  return status;
}

/* Ritz values and coefficients of the vectors done, descending. */
static bw_status ritz(bwi_lanczos *l) {
  int n = l->done, info = 0, length = 4 * n + 64;
  double *work = BW_NEW(l->base.context, double, length);
  if (!work)
    return BW_MEMORY;
  for (int j = 0; j < n; j++)
    memcpy(l->s + (int64_t)j * l->capacity, l->t + (int64_t)j * l->capacity,
           (size_t)(j + 1) * sizeof(double));
  dsyev_("V", "U", &n, l->s, &l->capacity, l->theta, work, &length, &info);
  bw_free(work);
  if (info != 0)
    return bw_fail(l->base.context, BW_INTERNAL, "dsyev failed on %d Ritz values (%d)", n, info);
  for (int i = 0, j = n - 1; i < j; i++, j--) {
    double value = l->theta[i];
    l->theta[i] = l->theta[j];
    l->theta[j] = value;
    double *a = l->s + (int64_t)i * l->capacity, *b = l->s + (int64_t)j * l->capacity;
    for (int k = 0; k < n; k++) {
      value = a[k];
      a[k] = b[k];
      b[k] = value;
    }
  }
  for (int i = 0; i < n; i++)
    l->base.value[i] = l->theta[i] > 0 ? 1 / l->theta[i] : INFINITY;
  l->base.known = n;
  return BW_OK;
}

/* |Op x - theta x|_M of Ritz vector i: what the coupling lets through. */
static double ritz_residual(const bwi_lanczos *l, int i) {
  int next = l->used - l->done;
  double sum = 0;
  const double *last = l->s + (int64_t)i * l->capacity + (l->done - l->r_columns);
  for (int k = 0; k < next; k++) {
    double part = 0;
    for (int j = 0; j < l->r_columns; j++)
      part += l->r[k + j * l->block] * last[j];
    sum += part * part;
  }
  return sqrt(sum);
}

static int lanczos_converged(const bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  const bwi_lanczos *l = (const bwi_lanczos *)iteration;
  int count = 0;
  while (count < wanted && count < l->done && l->theta[count] > 0 &&
         ritz_residual(l, count) <= tolerance * l->theta[count])
    count++;
  return count;
}

/* Keep the first `keep` Ritz vectors and the next block (or no next block). */
static bw_status restart(bwi_lanczos *l, int keep, bool next) {
  bw_status status = BW_OK;
  int behind = next ? l->used - l->done : 0;
  double *kept = BW_NEW(l->base.context, double, keep * l->base.size);
  if (!kept)
    return BW_MEMORY;
  for (int which = 0; which < 2; which++) {
    double *basis = which ? l->mv : l->v;
    BW_TRY(bwi_multi_combine(l->base.context, l->base.size, l->done, basis, keep, l->s, l->capacity,
                             1, 0, kept));
    memcpy(basis, kept, (size_t)keep * (size_t)l->base.size * sizeof(double));
    memmove(basis + (int64_t)keep * l->base.size, basis + (int64_t)l->done * l->base.size,
            (size_t)behind * (size_t)l->base.size * sizeof(double));
  }
  memset(l->t, 0, (size_t)l->capacity * (size_t)l->capacity * sizeof(double));
  for (int k = 0; k < keep; k++)
    l->t[k + (int64_t)k * l->capacity] = l->theta[k];
  l->done = l->base.known = keep;
  l->used = keep + behind;
  l->r_columns = 0;
done:
  bw_free(kept);
  return status;
}

static bw_status lanczos_deflate(bwi_eigen_iteration *iteration, int keep) {
  bwi_lanczos *l = (bwi_lanczos *)iteration;
  bw_status status = restart(l, keep, false);
  return status == BW_OK ? random_block(l) : status;
}

static bw_status lanczos_iterate(bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  bw_status status = BW_OK;
  bwi_lanczos *l = (bwi_lanczos *)iteration;
  for (int restarts = 0;;) {
    BW_TRY(bw_check_cancel(l->base.context));
    if (l->used == l->done) { /* closed under Op: look outside, or all is found */
      if (l->done >= l->base.problem->dimension || l->done >= l->capacity)
        break;
      int before = l->used;
      BW_TRY(random_block(l));
      if (l->used == before)
        break;
    }
    BW_TRY(step(l));
    bool full = l->used + l->block > l->capacity || l->used == l->done;
    if (l->done < wanted && !full)
      continue;
    BW_TRY(ritz(l));
    int found = lanczos_converged(iteration, wanted, tolerance);
    bw_progress(l->base.context, l->base.stage, (double)found / wanted);
    BW_TRY(bw_check_cancel(l->base.context));
    if (found >= wanted)
      break;
    if (l->used + l->block > l->capacity && l->done < l->base.problem->dimension) {
      if (++restarts > ATTEMPTS)
        return bwi_eigen_stopped(iteration, found, wanted, tolerance);
      int keep = wanted + (l->capacity - l->block - wanted) / 3;
      if (keep < l->done) {
        BW_TRY(restart(l, keep, true));
        l->base.iterations++;
      }
    }
  }
done:
  return status;
}

static bw_status lanczos_vectors(const bwi_eigen_iteration *iteration, int count, double *x) {
  const bwi_lanczos *l = (const bwi_lanczos *)iteration;
  return bwi_multi_combine(l->base.context, l->base.size, l->done, l->v, count, l->s, l->capacity,
                           1, 0, x);
}

const bwi_eigen_method *bwi_eigen_lanczos(void) {
  static const bwi_eigen_method method = {"lanczos",         lanczos_open,    lanczos_iterate,
                                          lanczos_converged, lanczos_deflate, lanczos_vectors,
                                          lanczos_close};
  return &method;
}
