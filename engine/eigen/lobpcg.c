/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The locally optimal block preconditioned conjugate gradient method (Knyazev 2001): Rayleigh-Ritz
 * on the span of the block X, the preconditioned residuals W = B (K X - M X Theta), and the
 * directions P of the last iteration.
 *
 * The basis S = [X P W] is M-orthonormal. Then Rayleigh-Ritz is an ordinary symmetric eigenproblem
 * of S^T K S, and nothing of it is ill-conditioned near convergence (Hetmaniuk and Lehoucq 2006,
 * Duersch et al. 2018): W is orthogonalised against X and P and among itself by the eigenvectors of
 * its Gram matrix, dependent vectors dropped, again where they are nearly dependent; the
 * coefficients of P are orthogonalised against those of X, so that P needs no product with M.
 *
 * Memory is that of the basis and of a block: no products of the basis with K and M are kept. Those
 * of X are computed in each iteration, for the residuals; S^T K S is known where X and P are
 * combinations of a former basis, and takes K W alone. Small bodies that follow an outline
 * (bwi_eigen_follow) have the memory: both products are carried along as combinations.
 *
 * Soft locking: pairs that have converged stay in X and take part in Rayleigh-Ritz, but have no W
 * and no P.
 *
 * Invariants between calls: the first `block` columns of the basis are X, M-orthonormal, in the
 * wanted space, with values ascending; P follows; `projected` is S^T K S of these columns. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "base/dense.h"
#include "eigen/iteration.h"
#include "linear/blas.h"
#include "linear/multivector.h"

enum { GUARDS = 4, LIMIT = 300, CHUNK = 512 };
/* Fields that a preconditioner works on side by side, and that products are taken of at once. */
enum { SIDES = 8 };

/* Relative size of an eigenvalue of a Gram matrix below which its vector depends on the others. */
static const double dependent = 1e-14;
/* Rounding that orthogonalisation enlarges by no more than the first is always let pass; by more
 * than the second it leaves nothing of the Gram matrix. */
static const double careful = 1e3, unusable = 1e8;
/* The loss of orthogonality that is let pass: in parts of the wanted residual, and at most. */
static const double share = 0.01, tolerable = 1e-10;
/* A residual that has not fallen to this fraction of its best in so many rounds stands still; below
 * this one it is rounding that stops it. */
static const double falls = 0.9, close_enough = 1e-4;
/* The residual of a guard that is good enough; and in the energy norm. */
#define GUARDED 1e-2
#define GUARDED_ENERGY 0.1
enum { STILL_ROUNDS = 8 };

typedef struct lobpcg {
  bwi_eigen_iteration base;
  int block;             /* columns of X */
  int directions;        /* columns of P, behind X */
  int width;             /* of the basis: 3 x block */
  double *basis;         /* width x size */
  double *image;         /* columns of products: block, and two times SIDES at least */
  double *stiff, *heavy; /* K and M times the basis, carried along; NULL: no memory for them */
  double *projected;     /* width x width */
  double *residual;      /* block: |K x - theta M x| / |theta M x| */
  double *value;         /* block: theta when that was computed */
  double *best;          /* block: the smallest residual so far */
  int *still;            /* block: rounds since it was found */
  double stuck;          /* the largest residual of a wanted column that rounding stops */
  bool energy;           /* residuals as in bwi_eigen_near, of wanted columns in every iteration */
  double guarded;        /* the residual of a guard that is good enough */
  double enlarged;       /* rounding that orthogonalisation enlarges by no more is let pass */
  int limit;             /* on iterations */
} lobpcg;

static void lobpcg_close(bwi_eigen_iteration *iteration) {
  lobpcg *l = (lobpcg *)iteration;
  bw_free(l->base.value);
  bw_free(l->basis);
  bw_free(l->image);
  bw_free(l->stiff);
  bw_free(l->heavy);
  bw_free(l->projected);
  bw_free(l->residual);
  bw_free(l->value);
  bw_free(l->best);
  bw_free(l->still);
  bw_free(l);
}

/* ---- bases ----------------------------------------------------------------------------------- */

/* The first `count` columns of each field become combinations of the first `from` ones. Rows are
 * worked on in chunks, so that results may take the place of their parts. */
typedef struct combination {
  double *field[3]; /* those behind the first may be NULL */
  int64_t size;
  int from, count;
  const double *weights; /* from x count, column-major */
  double *part;          /* by worker: CHUNK x count */
} combination;

static bw_status combine_rows(void *data, int64_t begin, int64_t end, int worker) {
  const combination *c = data;
  int rows = (int)(end - begin), ld = (int)c->size;
  const double one = 1, zero = 0;
  double *part = c->part + (int64_t)worker * CHUNK * c->count;
  for (int which = 0; which < 3 && c->field[which]; which++) {
    dgemm_("N", "N", &rows, &c->count, &c->from, &one, c->field[which] + begin, &ld, c->weights,
           &c->from, &zero, part, &rows);
    for (int k = 0; k < c->count; k++)
      memcpy(c->field[which] + k * c->size + begin, part + (int64_t)k * rows,
             (size_t)rows * sizeof(double));
  }
  return BW_OK;
}

static bw_status combine(lobpcg *l, combination c) {
  bw_context *context = l->base.context;
  c.size = l->base.size;
  c.part = BW_NEW(context, double, (int64_t)bw_threads(context) * CHUNK * c.count);
  if (!c.part)
    return BW_MEMORY;
  bw_status status = bw_parallel(context, c.size, CHUNK, combine_rows, &c);
  bw_free(c.part);
  return status;
}

/* Eigenvalues, ascending, and eigenvectors of a symmetric matrix (order x order), in its place. */
static bw_status symmetric(bw_context *context, int order, double *matrix, double *value) {
  int info = 0, length = 8 * order + 64;
  double *work = BW_NEW(context, double, length);
  if (!work)
    return BW_MEMORY;
  dsyev_("V", "U", &order, matrix, &order, value, work, &length, &info);
  bw_free(work);
  return info == 0 ? BW_OK
                   : bw_fail(context, BW_INTERNAL, "dsyev failed on a matrix of order %d (%d)",
                             order, info);
}

/* The columns from `first` on, `count` of them, made M-orthonormal among themselves by the
 * eigenvectors of their Gram matrix, which is lost; dependent ones are dropped. *least: the
 * smallest eigenvalue over the largest, of columns of norm 1. */
static bw_status orthonormalise(lobpcg *l, int first, double *gram, int *count, double *least) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  int64_t size = l->base.size;
  int n = *count, kept = 0;
  double *value = BW_NEW(context, double, 2 * (int64_t)n);
  double *w = l->basis + first * size;
  BW_TRY_MEMORY(value);
  double *scale = value + n;
  for (int j = 0; j < n; j++)
    scale[j] = gram[j + j * n] > 0 ? 1 / sqrt(gram[j + j * n]) : 0;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++)
      gram[i + j * n] *= scale[i] * scale[j];
  BW_TRY(symmetric(context, n, gram, value));
  *least = value[0] / value[n - 1];
  for (int j = n - 1; j >= 0 && value[j] > dependent * value[n - 1] && value[j] > 0; j--, kept++)
    for (int i = 0; i < n; i++)
      gram[i + j * n] *= scale[i] / sqrt(value[j]);
  if (kept > 0)
    BW_TRY(combine(l, (combination){.field = {w, l->heavy ? l->heavy + first * size : NULL},
                                    .from = n,
                                    .count = kept,
                                    .weights = gram + (int64_t)(n - kept) * n}));
  *count = kept;
done:
  bw_free(value);
  return status;
}

/* S^T K S of `count` columns behind the first `before` ones. */
static bw_status project_stiffness(lobpcg *l, int before, int count) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size, width = l->width;
  int columns = before + count;
  double *dots = BW_NEW(context, double, (int64_t)columns *(count + 1));
  double *image = l->stiff ? l->stiff + before * size : l->image;
  if (!dots)
    return BW_MEMORY;
  BW_TRY(problem->stiffness(context, problem->data, count, l->basis + before * size, image));
  BW_TRY(bwi_multi_dot(context, size, columns, l->basis, count, image, dots));
  for (int j = 0; j < count; j++)
    for (int i = 0; i < columns; i++)
      l->projected[i + (before + j) * width] = dots[i + j * columns];
  for (int j = before; j < columns; j++)
    for (int i = 0; i < j; i++) {
      double *one = &l->projected[i + j * width], *other = &l->projected[j + i * width];
      *one = *other = i < before ? *one : 0.5 * (*one + *other);
    }
done:
  bw_free(dots);
  return status;
}

/* The Gram matrix of `count` columns less their parts in `before` ones, from `dots`, the products
 * of both with M times the columns. Returns the largest of what is taken off a square of a norm
 * over what is left: so much larger is the rounding of that. */
static double gram_of_rest(int before, int count, const double *dots, double *gram) {
  int64_t rows = before + count;
  double largest = 0;
  for (int j = 0; j < count; j++) {
    const double *one = dots + j * rows;
    for (int i = 0; i <= j; i++) {
      const double *other = dots + i * rows;
      double whole = 0.5 * (one[before + i] + other[before + j]);
      gram[i + j * count] = gram[j + i * count] = whole - bwi_dot(before, one, other);
    }
    double removed = bwi_dot(before, one, one), left = gram[j + j * count];
    largest = fmax(largest, removed <= 0 ? 0 : left > 0 ? removed / left : INFINITY);
  }
  return largest;
}

/* Takes in `count` columns behind the first `before` ones, which are M-orthonormal: orthogonalised
 * against these and among themselves, and again where that enlarged rounding too much. One product
 * with M serves both. *count: those kept. */
static bw_status take_in(lobpcg *l, int before, int *count) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size, rows = before + *count;
  double *w = l->basis + before * size, *mw = l->heavy ? l->heavy + before * size : l->image;
  double *dots = BW_NEW(context, double, rows **count);
  double *gram = BW_NEW(context, double, (int64_t)*count **count);
  double enlarged = INFINITY;
  BW_TRY_MEMORY(dots && gram);
  BW_TRY(problem->project(context, problem->data, *count, w));
  for (int pass = 0; pass < 3 && *count > 0 && enlarged > l->enlarged; pass++) {
    if (pass == 0 || !l->heavy)
      BW_TRY(problem->mass(context, problem->data, *count, w, mw));
    rows = before + *count;
    BW_TRY(bwi_multi_dot(context, size, (int)rows, l->basis, *count, mw, dots));
    BW_TRY(bwi_multi_combine(context, size, before, l->basis, *count, dots, (int)rows, -1, 1, w));
    if (l->heavy)
      BW_TRY(
          bwi_multi_combine(context, size, before, l->heavy, *count, dots, (int)rows, -1, 1, mw));
    enlarged = 1 + gram_of_rest(before, *count, dots, gram);
    if (enlarged < unusable || pass == 2) {
      double least;
      BW_TRY(orthonormalise(l, before, gram, count, &least));
      enlarged = least > 0 ? enlarged / least : INFINITY;
    }
  }
  BW_TRY(project_stiffness(l, before, *count));
done:
  bw_free(dots);
  bw_free(gram);
  return status;
}

/* ---- Rayleigh-Ritz --------------------------------------------------------------------------- */

/* Coefficients of the next P behind those of the next X, of which `live` are not locked: the parts
 * of X that come from behind the old X, orthonormalised against X and among themselves. */
static int direction_weights(int columns, int block, const bool *live, double *weights) {
  int kept = 0;
  for (int j = 0; j < block; j++) {
    if (!live[j])
      continue;
    double *p = weights + (int64_t)(block + kept) * columns, before = 0, size = 0;
    for (int i = 0; i < columns; i++) {
      p[i] = i < block ? 0 : weights[i + j * columns];
      before += p[i] * p[i];
    }
    for (int pass = 0; pass < 3; pass++)
      for (int k = 0; k < block + kept; k++) {
        double along = 0;
        for (int i = 0; i < columns; i++)
          along += weights[i + k * columns] * p[i];
        for (int i = 0; i < columns; i++)
          p[i] -= along * weights[i + k * columns];
      }
    for (int i = 0; i < columns; i++)
      size += p[i] * p[i];
    if (!(size > 1e-12 * before) || !(size > 0))
      continue;
    for (int i = 0; i < columns; i++)
      p[i] /= sqrt(size);
    kept++;
  }
  return kept;
}

/* `projected` of the next X and P: the values, and P^T K P; P is orthogonal to all of X's
 * eigenvectors. `former`: of the basis before, columns x columns. `work`: columns. */
static void follow_projected(lobpcg *l, int columns, int block, const double *former,
                             const double *weights, double *work) {
  int64_t width = l->width;
  memset(l->projected, 0, (size_t)(width * width) * sizeof(double));
  for (int j = 0; j < block; j++)
    l->projected[j * (width + 1)] = l->base.value[j];
  for (int b = 0; b < l->directions; b++) {
    const double *q = weights + (int64_t)(block + b) * columns;
    memset(work, 0, (size_t)columns * sizeof *work);
    for (int j = 0; j < columns; j++)
      for (int i = 0; i < columns; i++)
        work[i] += former[i + (int64_t)j * columns] * q[j];
    for (int a = 0; a <= b; a++) {
      const double *p = weights + (int64_t)(block + a) * columns;
      double sum = 0;
      for (int i = 0; i < columns; i++)
        sum += p[i] * work[i];
      l->projected[block + a + (block + b) * width] = sum;
      l->projected[block + b + (block + a) * width] = sum;
    }
  }
}

/* The next X, of `block` columns, and P from the first `columns` of the basis. `live`: block, NULL:
 * no P. */
static bw_status rayleigh_ritz(lobpcg *l, int columns, const bool *live) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  int block = l->block < columns ? l->block : columns;
  double *matrix = BW_NEW(context, double, (int64_t)columns *(columns + block));
  double *former = BW_NEW(context, double, (int64_t)columns *columns);
  double *value = BW_NEW(context, double, columns);
  BW_TRY_MEMORY(matrix && former && value);
  for (int j = 0; j < columns; j++)
    memcpy(former + (int64_t)j * columns, l->projected + (int64_t)j * l->width,
           (size_t)columns * sizeof *former);
  memcpy(matrix, former, (size_t)columns * (size_t)columns * sizeof *matrix);
  BW_TRY(symmetric(context, columns, matrix, value));
  memcpy(l->base.value, value, (size_t)block * sizeof(double));
  l->directions = live && columns > block ? direction_weights(columns, block, live, matrix) : 0;
  BW_TRY(combine(l, (combination){.field = {l->basis, l->stiff, l->heavy},
                                  .from = columns,
                                  .count = block + l->directions,
                                  .weights = matrix}));
  follow_projected(l, columns, block, former, matrix, value);
  l->block = l->base.known = block;
done:
  bw_free(matrix);
  bw_free(former);
  bw_free(value);
  return status;
}

/* Random columns behind the first `keep` of X, so that there are `block` of them, and the Ritz
 * pairs of these. The preconditioner takes the high modes out of them. */
static bw_status fill(lobpcg *l, int keep, int block) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  bw_context *context = l->base.context;
  int64_t size = l->base.size;
  int count = block - keep;
  double *x = l->basis + keep * size, *y = l->image;
  memset(l->projected, 0, (size_t)l->width * (size_t)l->width * sizeof(double));
  for (int j = 0; j < keep; j++)
    l->projected[j * ((int64_t)l->width + 1)] = l->base.value[j];
  BW_TRY(bwi_eigen_random(&l->base, count, x));
  BW_TRY(problem->mass(context, problem->data, count, x, y));
  BW_TRY(problem->precondition(context, problem->data, count, y, x));
  l->base.solves += count;
  BW_TRY(take_in(l, keep, &count));
  l->block = keep + count;
  BW_TRY(rayleigh_ritz(l, l->block, NULL));
done:
  return status;
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* An array of `count` items, whose first `keep` are those of *old, in its place; others are zero
 * where there are few. */
static bw_status replace(bw_context *context, double **old, int64_t count, int64_t keep, bool few) {
  double *made = few ? BW_NEW0(context, double, count) : BW_NEW(context, double, count);
  if (!made)
    return BW_MEMORY;
  if (keep > 0)
    memcpy(made, *old, (size_t)keep * sizeof *made);
  bw_free(*old);
  *old = made;
  return BW_OK;
}

/* Arrays for a block of `block` columns; the first `keep` columns stay. */
static bw_status resize(lobpcg *l, int block, int keep) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  int64_t size = l->base.size, width = 3 * (int64_t)block;
  int64_t images = block < 2 * SIDES ? 2 * SIDES : block;
  double bytes = 8.0 * (double)(width + images) * (double)size, available = bw_available_memory();
  if (width * width > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "a block of %d vectors is more than LOBPCG can compute: ask for fewer modes",
                   block);
  if (bytes > available) {
    bw_fail(context, BW_MEMORY,
            "the basis of %d vectors takes %.3g GB of memory, more than the %.3g GB available",
            3 * block, bytes / 1e9, available / 1e9);
    bw_detail_number(context, "bytes", bytes);
    return BW_MEMORY;
  }
  bw_free(l->image);
  bw_free(l->projected);
  bw_free(l->still);
  l->image = l->projected = NULL;
  l->still = NULL;
  BW_TRY(replace(context, &l->basis, width * size, keep * size, false));
  BW_TRY(replace(context, &l->base.value, block, keep, true));
  BW_TRY(replace(context, &l->residual, block, keep, true));
  BW_TRY(replace(context, &l->value, block, keep, true));
  BW_TRY(replace(context, &l->best, block, keep, true));
  l->image = BW_NEW(context, double, images *size);
  l->projected = BW_NEW(context, double, width *width);
  l->still = BW_NEW0(context, int, block);
  if (!l->image || !l->projected || !l->still)
    return BW_MEMORY;
  l->width = (int)width;
  l->base.bytes = bytes;
done:
  return status;
}

static int block_of(const bwi_eigen_problem *problem, int wanted) {
  int64_t block = (int64_t)wanted + GUARDS;
  return (int)(block < problem->dimension ? block : problem->dimension);
}

static bw_status lobpcg_open(bw_context *context, const bwi_eigen_problem *problem,
                             const bwi_eigen_setup *setup, bwi_eigen_iteration **out) {
  (void)setup;
  if (problem->size > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%lld numbers in a field are more than BLAS can count",
                   (long long)problem->size);
  lobpcg *l = BW_NEW0(context, lobpcg, 1);
  if (!l)
    return BW_MEMORY;
  l->base.most = INT32_MAX - GUARDS;
  l->guarded = GUARDED;
  l->enlarged = careful;
  l->limit = LIMIT;
  *out = &l->base;
  return BW_OK;
}

/* ---- the iteration --------------------------------------------------------------------------- */

typedef struct part_of_block {
  lobpcg *l;
  int64_t first;         /* column of the block */
  const double *kx, *mx; /* K and M times it and those that follow */
} part_of_block;

/* Residuals of a part of the block, to the columns behind X and P. */
static bw_status residual_columns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const part_of_block *part = data;
  lobpcg *l = part->l;
  int64_t size = l->base.size;
  for (int64_t k = begin; k < end; k++) {
    int64_t j = part->first + k;
    const double *kx = part->kx + k * size, *mx = part->mx + k * size;
    double *r = l->basis + (l->block + l->directions + j) * size;
    double theta = l->base.value[j], difference = 0, whole = 0;
    for (int64_t i = 0; i < size; i++) {
      double m = theta * mx[i];
      r[i] = kx[i] - m;
      difference += r[i] * r[i];
      whole += m * m;
    }
    l->residual[j] = whole > 0 ? sqrt(difference / whole) : 0;
  }
  return BW_OK;
}

/* The residual above which a column is worked on: guards that are good enough widen the gap, except
 * those that may have the eigenvalue of the last one wanted: that converges no faster than they. */
static double threshold(const lobpcg *l, int j, int wanted, double tolerance) {
  int needed = wanted;
  while (!l->energy && needed <= j && bwi_eigen_may_be_equal(&l->base, needed))
    needed++;
  return j < needed ? tolerance : fmax(tolerance, l->guarded);
}

/* W = B R in the place of R, and residuals in the energy norm, of `count` columns from `first`. */
static bw_status energy_residuals(lobpcg *l, int first, int count) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size;
  double *r = l->basis + (l->block + l->directions + first) * size, *z = l->image;
  BW_TRY(problem->precondition(l->base.context, problem->data, count, r, z));
  l->base.solves += count;
  for (int j = 0; j < count; j++)
    l->residual[first + j] =
        sqrt(fmax(0, bwi_dot(size, r + j * size, z + j * size) / l->base.value[first + j]));
  memcpy(r, z, (size_t)count * (size_t)size * sizeof *r);
done:
  return status;
}

/* Residuals of the columns that are worked on, and of those into whose place another pair came; or
 * of all. `measured` says of which. */
static bw_status compute_residuals(lobpcg *l, int wanted, double tolerance, bool all,
                                   bool *measured) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size;
  for (int j = 0; j < l->block; j++)
    measured[j] = all || (l->energy && j < wanted) ||
                  l->residual[j] > threshold(l, j, wanted, tolerance) ||
                  fabs(l->base.value[j] - l->value[j]) > tolerance * fabs(l->value[j]);
  for (int first = 0, count; first<l->block; first += count> 0 ? count : 1) {
    for (count = 0; count < SIDES && first + count < l->block && measured[first + count];)
      count++;
    part_of_block part = {l, first, l->image, l->image + count * size};
    const double *x = l->basis + first * size;
    if (l->stiff) {
      part.kx = l->stiff + first * size;
      part.mx = l->heavy + first * size;
    } else {
      BW_TRY(problem->stiffness(context, problem->data, count, x, l->image));
      BW_TRY(problem->mass(context, problem->data, count, x, l->image + count * size));
    }
    BW_TRY(bw_parallel(context, count, 1, residual_columns, &part));
    if (l->energy && count > 0)
      BW_TRY(energy_residuals(l, first, count));
    for (int j = first; j < first + count; j++)
      l->value[j] = l->base.value[j];
  }
done:
  return status;
}

/* As many guards less as leave a whole number of passes of the preconditioner. */
static void skip_guards(const lobpcg *l, int wanted, bool *live) {
  int count = 0, guards = 0;
  for (int j = 0; j < l->block; j++) {
    count += live[j];
    guards += live[j] && j >= wanted;
  }
  int excess = count % SIDES;
  if (excess > guards || excess == count)
    return;
  for (int j = l->block - 1; excess > 0; j--)
    if (live[j]) {
      live[j] = false;
      excess--;
    }
}

/* Residuals K x - theta M x, and which columns are live. A column that has converged, or that
 * rounding keeps from it, is locked. So are guards that are good enough to widen the gap. */
static bw_status find_residuals(lobpcg *l, int wanted, double tolerance, bool all, bool *live) {
  bw_status status = compute_residuals(l, wanted, tolerance, all, live);
  l->stuck = 0;
  for (int j = 0; j < l->block; j++) {
    bool another = l->residual[j] > 10 * l->best[j]; /* a pair that came in below moved them up */
    if (live[j])
      l->still[j] = another || l->residual[j] < falls * l->best[j] ? 0 : l->still[j] + 1;
    if (live[j] && l->still[j] == 0)
      l->best[j] = l->residual[j];
    if (l->still[j] >= STILL_ROUNDS && l->best[j] < close_enough) {
      l->stuck = j < wanted ? fmax(l->stuck, l->best[j]) : l->stuck;
      l->residual[j] = fmin(l->residual[j], tolerance);
    }
    live[j] = l->residual[j] > threshold(l, j, wanted, tolerance);
  }
  return status;
}

/* W = B R of the live columns, behind X and P; *count: how many. */
static bw_status precondition(lobpcg *l, const bool *live, int *count) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size, behind = (l->block + l->directions) * size;
  double *w = l->basis + behind;
  *count = 0;
  for (int j = 0; j < l->block; j++)
    if (live[j] && (*count)++ != j)
      memcpy(w + (*count - 1) * size, w + j * size, (size_t)size * sizeof *w);
  if (l->energy) /* they are */
    return BW_OK;
  BW_TRY(problem->precondition(l->base.context, problem->data, *count, w, w));
  l->base.solves += *count;
done:
  return status;
}

static int lobpcg_converged(const bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  const lobpcg *l = (const lobpcg *)iteration;
  int count = 0;
  while (count < wanted && count < l->block && l->residual[count] <= tolerance)
    count++;
  return count;
}

static bw_status iterate(lobpcg *l, int wanted, double tolerance, bool *live) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = l->base.problem;
  bw_context *context = l->base.context;
  for (int j = 0; j < l->block; j++) {
    l->still[j] = 0;
    l->best[j] = INFINITY;
  }
  bool all = true;
  for (int round = 0;; round++) {
    int count;
    BW_TRY(find_residuals(l, wanted, tolerance, all, live));
    int found = lobpcg_converged(&l->base, wanted, tolerance);
    bw_progress(context, l->base.stage, (double)found / wanted);
    BW_TRY(bw_check_cancel(context));
    if (l->block >= problem->dimension || (found == wanted && (all || l->energy)))
      break;
    all = found == wanted; /* those locked long ago are measured once more at the end */
    if (all)
      continue;
    if (round >= l->limit) {
      status = bwi_eigen_stopped(&l->base, found, wanted, tolerance);
      goto done;
    }
    skip_guards(l, wanted, live);
    BW_TRY(precondition(l, live, &count));
    l->base.iterations++;
    BW_TRY(take_in(l, l->block + l->directions, &count));
    if (count == 0)
      break;
    BW_TRY(rayleigh_ritz(l, l->block + l->directions + count, live));
  }
  if (l->stuck > tolerance && !l->energy) /* there the caller reads the residuals */
    bw_warn(context,
            "residuals of modes by LOBPCG stopped at up to %.1e, where %.0e was requested: they "
            "stand still, as rounding makes them",
            l->stuck, tolerance);
done:
  return status;
}

/* A block of `block` columns, random ones behind the first `keep`. */
static bw_status widen(lobpcg *l, int keep, int block) {
  bw_status status = BW_OK;
  l->directions = 0;
  if (block > l->width / 3)
    BW_TRY(resize(l, block, keep));
  if (keep < block)
    BW_TRY(fill(l, keep, block));
done:
  return status;
}

static bw_status lobpcg_iterate(bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  bw_status status = BW_OK;
  lobpcg *l = (lobpcg *)iteration;
  bool *live = NULL;
  /* S^T M S = I + E changes Ritz values by at most |E| of them (Ostrowski), residuals by about as
   * much; rounding makes |E| of the size of epsilon times what it is enlarged by */
  l->enlarged = fmax(careful, fmin(tolerable, share * tolerance) / DBL_EPSILON);
  if (wanted >= l->block && l->block < iteration->problem->dimension)
    BW_TRY(widen(l, l->block, block_of(iteration->problem, wanted)));
  if (wanted > l->block)
    wanted = l->block;
  live = BW_NEW0(iteration->context, bool, l->block);
  BW_TRY_MEMORY(live);
  BW_TRY(iterate(l, wanted, tolerance, live));
done:
  bw_free(live);
  return status;
}

static bw_status lobpcg_deflate(bwi_eigen_iteration *iteration, int keep) {
  return widen((lobpcg *)iteration, keep, block_of(iteration->problem, keep + 1));
}

static bw_status lobpcg_vectors(const bwi_eigen_iteration *iteration, int count, double *x) {
  const lobpcg *l = (const lobpcg *)iteration;
  memcpy(x, l->basis, (size_t)count * (size_t)iteration->size * sizeof *x);
  return BW_OK;
}

const bwi_eigen_method *bwi_eigen_lobpcg(void) {
  static const bwi_eigen_method method = {"lobpcg",         lobpcg_open,    lobpcg_iterate,
                                          lobpcg_converged, lobpcg_deflate, lobpcg_vectors,
                                          lobpcg_close};
  return &method;
}

/* ---- from vectors that are near -------------------------------------------------------------- */

/* Of `count` columns behind the first `before`, those go that these span but for rounding: nothing
 * else is left of them. The columns are of M-norm 1. */
static bw_status drop_dependent(lobpcg *l, int before, int *count) {
  bw_status status = BW_OK;
  bw_context *context = l->base.context;
  const bwi_eigen_problem *problem = l->base.problem;
  int64_t size = l->base.size;
  double *w = l->basis + before * size, *mw = l->image;
  int kept = 0;
  double *part = BW_NEW(context, double, (int64_t)(before + 1) * *count);
  if (!part)
    return BW_MEMORY;
  BW_TRY(problem->project(context, problem->data, *count, w));
  BW_TRY(problem->mass(context, problem->data, *count, w, mw));
  BW_TRY(bwi_multi_dot(context, size, before, l->basis, *count, mw, part));
  BW_TRY(bwi_multi_combine(context, size, before, l->basis, *count, part, before, -1, 1, w));
  BW_TRY(problem->mass(context, problem->data, *count, w, mw));
  for (int j = 0; j < *count; j++)
    if (bwi_dot(size, w + j * size, mw + j * size) > 1e-20) {
      memmove(w + kept * size, w + j * size, (size_t)size * sizeof *w);
      kept++;
    }
  *count = kept;
done:
  bw_free(part);
  return status;
}

/* Ritz pairs of the span of the start; random columns where it has too few. */
static bw_status begin_near(lobpcg *l, const bwi_eigen_near *near) {
  bw_status status = BW_OK;
  int64_t size = l->base.size;
  int have = near->block;
  BW_TRY(resize(l, near->block, 0));
  l->stiff = BW_NEW(l->base.context, double, l->width *size);
  l->heavy = BW_NEW(l->base.context, double, l->width *size);
  if (!l->stiff || !l->heavy)
    return BW_MEMORY;
  l->block = near->block;
  memset(l->projected, 0, (size_t)l->width * (size_t)l->width * sizeof(double));
  memcpy(l->basis, near->start, (size_t)(have * size) * sizeof *l->basis);
  BW_TRY(take_in(l, 0, &have));
  for (int first = 0, count; first < near->more_count; first += near->block) {
    count = near->more_count - first < near->block ? near->more_count - first : near->block;
    memcpy(l->basis + have * size, near->more + first * size,
           (size_t)(count * size) * sizeof *l->basis);
    BW_TRY(drop_dependent(l, have, &count));
    if (count > 0)
      BW_TRY(take_in(l, have, &count));
    have += count;
  }
  if (have > 0)
    BW_TRY(rayleigh_ritz(l, have, NULL));
  if (have < near->block)
    BW_TRY(fill(l, have, near->block));
done:
  return status;
}

bw_status bwi_eigen_follow(bw_context *context, const bwi_eigen_problem *problem,
                           const bwi_eigen_near *near, double *vector, double *value,
                           double *residual, int *iterations) {
  bw_status status = BW_OK;
  bwi_eigen_iteration *it = NULL;
  bool *live = BW_NEW0(context, bool, near->block);
  if (!live)
    return BW_MEMORY;
  bwi_blas_enter();
  BW_TRY(lobpcg_open(context, problem, NULL, &it));
  lobpcg *l = (lobpcg *)it;
  it->context = context;
  it->problem = problem;
  it->size = problem->size;
  l->energy = true;
  l->guarded = GUARDED_ENERGY;
  l->limit = near->limit;
  bw_random_seed(&it->random, 1);
  BW_TRY(begin_near(l, near));
  status = iterate(l, near->wanted, near->tolerance, live);
  if (status == BW_CONVERGENCE) {
    int worst = 0;
    for (int k = 1; k < near->wanted; k++)
      worst = l->residual[k] > l->residual[worst] ? k : worst;
    bw_fail(context, status,
            "mode %d has a relative residual of %g after %d iterations; %g was requested",
            worst + 1, l->residual[worst], it->iterations, near->tolerance);
    bw_detail_number(context, "residual", l->residual[worst]);
  }
  BW_TRY(status);
  *iterations = it->iterations;
  memcpy(vector, l->basis, (size_t)(near->block * it->size) * sizeof *vector);
  memcpy(value, it->value, (size_t)near->block * sizeof *value);
  for (int k = 0; k < near->block; k++)
    residual[k] = l->still[k] >= STILL_ROUNDS ? l->best[k] : l->residual[k];
done:
  bwi_blas_leave();
  if (it)
    lobpcg_close(it);
  bw_free(live);
  return status;
}
