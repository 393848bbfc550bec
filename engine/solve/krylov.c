/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of K x = lambda M x by block Lanczos on the inverse, Op = K^+ M, which is
 * symmetric in the M inner product: eigenvalues theta = 1/lambda, the lowest lambda outermost.
 *
 * Why blocks: one pass over the factor serves a whole block of right-hand sides, and a block of b
 * vectors sees eigenvalues of multiplicity up to b at once, where a single-vector method sees
 * partners only by rounding.
 *
 * Invariants of the basis V (M-orthonormal, orthogonalised twice in full): T = V^T M Op V holds in
 * its upper triangle for all blocks that went through Op (`done` vectors); the vectors behind them
 * are the next block, with R its coupling, so that Op V = V T + V_next R. A restart keeps the best
 * Ritz vectors in front of the next block; the coupling comes back by the projection, which always
 * is taken on the whole basis. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "solve/blas.h"
#include "solve/internal.h"
#include "solve/multivector.h"

enum { BLOCK = 8, ATTEMPTS = 40, RECOVERIES = 6 };

/* A vector that loses all but this fraction of itself by orthogonalisation lay in the basis. */
static const double dependent = 1e-9;

typedef struct lanczos {
  bw_context *context;
  const bwi_eigen_problem *problem;
  int64_t size;
  int capacity, block;
  int used;       /* vectors in the basis, with the next block */
  int done;       /* of these, through Op */
  double *v, *mv; /* capacity x size: basis, and M times basis */
  double *t;      /* capacity x capacity, column-major, upper triangle */
  double *r;      /* coupling: (used - done) x the last `r_columns` done vectors, ld = block */
  int r_columns;
  double *theta, *s; /* Ritz values (descending) and coefficients, ld = capacity */
  bw_random random;
  int solves;
} lanczos;

static void lanczos_clear(lanczos *l) {
  bw_free(l->v);
  bw_free(l->mv);
  bw_free(l->t);
  bw_free(l->r);
  bw_free(l->theta);
  bw_free(l->s);
}

static bw_status lanczos_open(bw_context *context, const bwi_eigen_problem *problem, int capacity,
                              int block, uint64_t seed, lanczos *l) {
  *l = (lanczos){.context = context,
                 .problem = problem,
                 .size = problem->size,
                 .capacity = capacity,
                 .block = block};
  bw_random_seed(&l->random, seed);
  l->v = BW_NEW(context, double, capacity * l->size);
  l->mv = BW_NEW(context, double, capacity * l->size);
  l->t = BW_NEW0(context, double, (int64_t)capacity *capacity);
  l->r = BW_NEW0(context, double, (int64_t)block *block);
  l->theta = BW_NEW(context, double, capacity);
  l->s = BW_NEW(context, double, (int64_t)capacity *capacity);
  return l->v && l->mv && l->t && l->r && l->theta && l->s ? BW_OK : BW_MEMORY;
}

/* Orthogonalise `count` vectors w against the first `against` of the basis, twice; the sum of the
 * coefficients goes to h (against x count). */
static bw_status orthogonalise(lanczos *l, int against, int count, double *w, double *h) {
  bw_status status = BW_OK;
  double *part = BW_NEW(l->context, double, (int64_t)against *count);
  if (!part)
    return BW_MEMORY;
  memset(h, 0, (size_t)against * (size_t)count * sizeof(double));
  for (int pass = 0; pass < 2; pass++) {
    BW_TRY(bwi_multi_dot(l->context, l->size, against, l->mv, count, w, part));
    BW_TRY(bwi_multi_combine(l->context, l->size, against, l->v, count, part, against, -1, 1, w));
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
static bw_status append(lanczos *l, int count, double *w, const double *taken, double *r) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->problem;
  int first = l->used, kept = 0;
  memset(r, 0, (size_t)l->block * (size_t)l->block * sizeof(double));
  for (int j = 0; j < count && l->used < l->capacity; j++) {
    double *vector = w + j * l->size, *mv = l->mv + (int64_t)l->used * l->size, part[BLOCK], dot;
    for (int pass = 0; pass < 2 && kept > 0; pass++) {
      BW_TRY(bwi_multi_dot(l->context, l->size, kept, l->mv + (int64_t)first * l->size, 1, vector,
                           part));
      BW_TRY(bwi_multi_combine(l->context, l->size, kept, l->v + (int64_t)first * l->size, 1, part,
                               kept, -1, 1, vector));
      for (int k = 0; k < kept; k++)
        r[k + j * l->block] += part[k];
    }
    BW_TRY(problem->mass(l->context, problem->data, 1, vector, mv));
    BW_TRY(bwi_multi_dot(l->context, l->size, 1, vector, 1, mv, &dot));
    double norm = dot > 0 ? sqrt(dot) : 0;
    double whole = hypot(norm, taken[j]);
    for (int k = 0; k < kept; k++)
      whole = hypot(whole, r[k + j * l->block]);
    if (!(norm > dependent * whole))
      continue;
    double *v = l->v + (int64_t)l->used * l->size;
    for (int64_t i = 0; i < l->size; i++) {
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
static bw_status append_random(lanczos *l) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->problem;
  double taken[BLOCK];
  double *w = BW_NEW(l->context, double, l->block * l->size);
  double *h = BW_NEW(l->context, double, (int64_t)l->used * l->block);
  if (!w || !h) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < l->block * l->size; i++)
    w[i] = 2 * bw_random_uniform(&l->random) - 1;
  BW_TRY(problem->project(l->context, problem->data, l->block, w));
  BW_TRY(orthogonalise(l, l->used, l->block, w, h));
  lengths(l->used, l->block, h, taken);
  BW_TRY(append(l, l->block, w, taken, l->r));
  l->r_columns = 0;
done:
  bw_free(w);
  bw_free(h);
  return status;
}

/* Send the next block through Op. */
static bw_status step(lanczos *l) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->problem;
  int count = l->used - l->done, against = l->used;
  double taken[BLOCK];
  double *w = BW_NEW(l->context, double, count * l->size);
  double *h = BW_NEW(l->context, double, against *count);
  if (!w || !h) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(problem->solve(l->context, problem->data, count, l->mv + (int64_t)l->done * l->size, w));
  l->solves += count;
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
static bw_status ritz(lanczos *l) {
  int n = l->done, info = 0, length = 4 * n + 64;
  double *work = BW_NEW(l->context, double, length);
  if (!work)
    return BW_MEMORY;
  for (int j = 0; j < n; j++)
    memcpy(l->s + (int64_t)j * l->capacity, l->t + (int64_t)j * l->capacity,
           (size_t)(j + 1) * sizeof(double));
  dsyev_("V", "U", &n, l->s, &l->capacity, l->theta, work, &length, &info);
  bw_free(work);
  if (info != 0)
    return bw_fail(l->context, BW_INTERNAL, "dsyev failed on %d Ritz values (%d)", n, info);
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
  return BW_OK;
}

/* |Op x - theta x|_M of Ritz vector i: what the coupling lets through. */
static double ritz_residual(const lanczos *l, int i) {
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

/* Leading Ritz vectors that have converged. */
static int converged(const lanczos *l, int wanted, double tolerance) {
  int count = 0;
  while (count < wanted && count < l->done && l->theta[count] > 0 &&
         ritz_residual(l, count) <= tolerance * l->theta[count])
    count++;
  return count;
}

/* Keep the first `keep` Ritz vectors and the next block (or no next block). */
static bw_status restart(lanczos *l, int keep, bool next) {
  bw_status status = BW_OK;
  int behind = next ? l->used - l->done : 0;
  double *kept = BW_NEW(l->context, double, keep * l->size);
  if (!kept)
    return BW_MEMORY;
  for (int which = 0; which < 2; which++) {
    double *basis = which ? l->mv : l->v;
    BW_TRY(bwi_multi_combine(l->context, l->size, l->done, basis, keep, l->s, l->capacity, 1, 0,
                             kept));
    memcpy(basis, kept, (size_t)keep * (size_t)l->size * sizeof(double));
    memmove(basis + (int64_t)keep * l->size, basis + (int64_t)l->done * l->size,
            (size_t)behind * (size_t)l->size * sizeof(double));
  }
  memset(l->t, 0, (size_t)l->capacity * (size_t)l->capacity * sizeof(double));
  for (int k = 0; k < keep; k++)
    l->t[k + (int64_t)k * l->capacity] = l->theta[k];
  l->done = keep;
  l->used = keep + behind;
  l->r_columns = 0;
done:
  bw_free(kept);
  return status;
}

/* Go on until `wanted` Ritz vectors have converged, or the whole space is searched. */
static bw_status iterate(lanczos *l, int wanted, double tolerance) {
  bw_status status = BW_OK;
  for (int restarts = 0;;) {
    BW_TRY(bw_check_cancel(l->context));
    if (l->used == l->done) { /* closed under Op: look outside, or all is found */
      if (l->done >= l->problem->dimension || l->done >= l->capacity)
        break;
      int before = l->used;
      BW_TRY(append_random(l));
      if (l->used == before)
        break;
    }
    BW_TRY(step(l));
    bool full = l->used + l->block > l->capacity || l->used == l->done;
    if (l->done < wanted && !full)
      continue;
    BW_TRY(ritz(l));
    int found = converged(l, wanted, tolerance);
    bw_progress(l->context, "modes", (double)found / wanted);
    if (found >= wanted)
      break;
    if (l->used + l->block > l->capacity && l->done < l->problem->dimension) {
      if (++restarts > ATTEMPTS)
        return bw_fail(l->context, BW_CONVERGENCE,
                       "%d of %d modes converged to %g in %d triangular solves", found, wanted,
                       tolerance, l->solves);
      int keep = wanted + (l->capacity - l->block - wanted) / 3;
      if (keep < l->done)
        BW_TRY(restart(l, keep, true));
    }
  }
done:
  return status;
}

/* ---- results ------------------------------------------------------------------------------------
 */

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
static bw_status take_out(lanczos *l, int count, double tolerance, bwi_eigen_result *result) {
  bw_status status = BW_OK;
  bw_context *context = l->context;
  const bwi_eigen_problem *problem = l->problem;
  int64_t size = l->size;
  double *x = NULL, *kx = NULL, *mx = NULL, *gram = NULL, *turn = NULL, *work = NULL, *next = NULL;
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
  turn = BW_NEW(context, double, (int64_t)count *count);
  work = BW_NEW(context, double, length);
  if (!result->value || !result->residual || !x || !kx || !mx || !gram || !turn || !work) {
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
    BW_TRY(bwi_multi_dot(context, size, count, next, count, kx, turn));
    BW_TRY(bwi_multi_dot(context, size, count, next, count, mx, gram));
    int info = 0, kind = 1;
    double *value = work, *space = BW_NEW(context, double, length);
    if (!space) {
      status = BW_MEMORY;
      goto done;
    }
    dsygv_(&kind, "V", "L", &count, turn, &count, gram, &count, value, space, &length, &info);
    bw_free(space);
    if (info != 0)
      break;
    BW_TRY(bwi_multi_combine(context, size, count, next, count, turn, count, 1, 0, kx));
    memcpy(next, kx, (size_t)count * (size_t)size * sizeof(double));
    double *fresh = gram; /* count numbers of scratch */
    BW_TRY(true_residuals(context, problem, count, value, next, fresh, kx, mx));
    double now = 0;
    for (int k = 0; k < count; k++)
      now = fmax(now, fresh[k]);
    if (!(now < worst))
      break;
    bool slow = now > 0.2 * worst;
    worst = now;
    double *other = x;
    x = next;
    next = other;
    memcpy(result->value, value, (size_t)count * sizeof(double));
    memcpy(result->residual, fresh, (size_t)count * sizeof(double));
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
  bw_free(turn);
  bw_free(work);
  return status;
}

/* The end of the cluster that eigenvalue number `count` (from 1) belongs to, and a shift above it;
 * 0 when the known values do not show a gap. */
static int find_gap(const lanczos *l, int count, int known, double fraction, double *shift) {
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
  int64_t capacity = 3 * (int64_t)count + 6 * BLOCK;
  if (capacity > problem->dimension + BLOCK)
    capacity = problem->dimension + BLOCK;
  if (capacity * capacity > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d modes are more than this eigensolver takes", count);
  int block = problem->dimension < BLOCK ? (int)problem->dimension : BLOCK;
  double tolerance = fmin(options->tolerance, 1e-6);
  lanczos l;
  bwi_blas_serial();
  BW_TRY(lanczos_open(context, problem, (int)capacity, block, options->seed, &l));
  BW_TRY(append_random(&l));
  BW_TRY(iterate(&l, count, tolerance));
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
        status = iterate(&l, count + BLOCK, tolerance);
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
      if (converged(&l, n, tolerance) < n)
        BW_TRY(iterate(&l, n, tolerance));
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
      BW_TRY(restart(&l, keep, false));
      BW_TRY(append_random(&l));
      BW_TRY(iterate(&l, n + missing < l.capacity - block ? n + missing : l.capacity - block,
                     tolerance));
      result->recovered += missing;
    }
  BW_TRY(take_out(&l, count, options->tolerance, result));
  result->solves = l.solves;
done:
  lanczos_clear(&l);
  if (status != BW_OK)
    bwi_eigen_result_clear(result);
  return status;
}
