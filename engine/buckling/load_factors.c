/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors (K + lambda K_sigma) phi = 0 by the squares of them (docs/theory/stability.md):
 *     K phi = lambda^2 S phi,   S = K_sigma K^-1 K_sigma,
 * a problem with K positive definite and S positive, which the eigensolvers of eigen/ take as it
 * is. Factors of both signs come out by size. On a space of whole clusters of lambda^2 the operator
 * -K^-1 K_sigma separates the signs. K + s K_sigma has as many negative eigenvalues as there are
 * factors between 0 and s. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "buckling/internal.h"
#include "linear/blas.h"
#include "linear/multivector.h"

enum {
  MOST = 500,   /* factors */
  BEYOND = 2,   /* pairs beyond those wanted, which show the end of a cluster */
  SEARCHED = 64 /* pairs of the other sign, or eight times those wanted, before a search ends */
};

/* Squares nearer to each other than this may be one eigenvalue. */
static const double cluster = 1e-5;
/* How many times the smallest factor a count looks for one of the wanted sign. */
static const double far = 1000;

void bw_buckling_options_default(bw_buckling_options *options) {
  *options = (bw_buckling_options){.count = 4, .tolerance = 1e-8, .sturm = true, .seed = 1};
}

static void buckling_destroy(void *object) {
  bw_buckling *buckling = object;
  bw_release(buckling->model);
  bw_free(buckling->factor);
  bw_free(buckling->error);
  bw_free(buckling->shape);
  bw_free(buckling);
}

static size_t buckling_bytes(const void *object) {
  const bw_buckling *buckling = object;
  return sizeof *buckling + (size_t)buckling->count *
                                (3 * (size_t)buckling->model->mesh->node_count + 2) *
                                sizeof(double);
}

static const bw_kind buckling_kind = {"buckling", buckling_destroy, buckling_bytes};

bw_status bwi_buckling_empty(bw_context *context, const bw_model *model, bw_buckling **buckling) {
  bw_buckling *out = BW_NEW0(context, bw_buckling, 1);
  if (!out)
    return BW_MEMORY;
  bw_object_init(out, &buckling_kind);
  out->model = bw_retain(model);
  *buckling = out;
  return BW_OK;
}

/* ---- the squares ------------------------------------------------------------------------------
 */

static bw_status stiffness(bw_context *context, void *data, int64_t count, const double *x,
                           double *y) {
  const bwi_stability *p = data;
  return p->stiffness(context, p->data, count, x, y);
}

static bw_status solve(bw_context *context, void *data, int64_t count, const double *f, double *y) {
  bwi_stability *p = data;
  p->solves += (int)count;
  return p->solve(context, p->data, count, f, y);
}

/* y = S x */
static bw_status squared(bw_context *context, void *data, int64_t count, const double *x,
                         double *y) {
  bw_status status = BW_OK;
  bwi_stability *p = data;
  for (int64_t first = 0; first < count; first += BWI_STABILITY_SIDES) {
    int64_t part = count - first < BWI_STABILITY_SIDES ? count - first : BWI_STABILITY_SIDES;
    int64_t at = first * p->size;
    BW_TRY(p->stress(context, p->data, part, x + at, y + at));
    BW_TRY(solve(context, p, part, y + at, p->work));
    BW_TRY(p->stress(context, p->data, part, p->work, y + at));
  }
done:
  return status;
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  const bwi_stability *p = data;
  return p->project(context, p->data, count, x);
}

static bw_status below(bw_context *context, void *data, double square, int64_t *count,
                       bool *trusted) {
  bw_status status = BW_OK;
  const bwi_stability *p = data;
  int64_t reversed;
  bool also;
  BW_TRY(p->between(context, p->data, sqrt(square), count, trusted));
  BW_TRY(p->between(context, p->data, -sqrt(square), &reversed, &also));
  *count += reversed;
  *trusted = *trusted && also;
done:
  return status;
}

/* ---- signs ----------------------------------------------------------------------------------- */

/* Pairs in work: factors and vectors of K-norm 1, the positive factors first, each sign ascending
 * by size. */
typedef struct found {
  int count, positive;
  double *factor, *error, *vector; /* of count x size */
} found;

static void found_clear(found *f) {
  bw_free(f->factor);
  bw_free(f->error);
  bw_free(f->vector);
  *f = (found){0};
}

/* The first pairs of the squares that end with a whole cluster. */
static int whole_clusters(const bwi_eigen_result *result, bool all) {
  int n = result->count;
  while (
      !all && n > 0 &&
      (n == result->count || result->value[n] - result->value[n - 1] <= cluster * result->value[n]))
    n--;
  return n;
}

/* Eigenvectors of -K_sigma by K on the span of n vectors, from the largest eigenvalue to the
 * smallest: positive factors ascend, then negative ones descend. */
static bw_status separate_signs(bw_context *context, bwi_stability *p, int n, const double *x,
                                found *f) {
  bw_status status = BW_OK;
  int64_t size = p->size;
  int info = 0, kind = 1, length = 8 * n + 64;
  double *product = BW_NEW(context, double, n *size), *a = BW_NEW(context, double, n *n);
  double *b = BW_NEW(context, double, n *n), *work = BW_NEW(context, double, length);
  f->factor = BW_NEW(context, double, n);
  f->error = BW_NEW(context, double, n);
  f->vector = BW_NEW(context, double, n *size);
  BW_TRY_MEMORY(product && a && b && work && f->factor && f->error && f->vector);
  f->count = n;
  BW_TRY(p->stress(context, p->data, n, x, product));
  BW_TRY(bwi_multi_dot(context, size, n, x, n, product, a));
  BW_TRY(p->stiffness(context, p->data, n, x, product));
  BW_TRY(bwi_multi_dot(context, size, n, x, n, product, b));
  dsygv_(&kind, "V", "L", &n, a, &n, b, &n, f->error, work, &length, &info);
  if (info != 0)
    BW_TRY(bw_fail(context, BW_INTERNAL, "dsygv failed on %d buckling shapes (%d)", n, info));
  BW_TRY(bwi_multi_combine(context, size, n, x, n, a, n, 1, 0, f->vector));
  for (int k = 0; k < n; k++) { /* eigenvalues of K_sigma ascend: the first are of compression */
    f->factor[k] = -1 / f->error[k];
    f->positive += f->factor[k] > 0;
  }
  /* the negative ones: the largest eigenvalue of K_sigma, the smallest factor, first */
  for (int i = f->positive, j = n - 1; i < j; i++, j--) {
    double held = f->factor[i];
    f->factor[i] = f->factor[j];
    f->factor[j] = held;
    for (int64_t m = 0; m < size; m++) {
      held = f->vector[i * size + m];
      f->vector[i * size + m] = f->vector[j * size + m];
      f->vector[j * size + m] = held;
    }
  }
done:
  bw_free(product);
  bw_free(a);
  bw_free(b);
  bw_free(work);
  return status;
}

/* The basis of canonical.c for factors of one size, each sign by itself. */
static bw_status make_canonical(bw_context *context, bwi_stability *p, double tolerance, found *f) {
  bw_status status = BW_OK;
  int64_t size = p->size;
  bool changed;
  double *residual = BW_NEW0(context, double, f->count);
  BW_TRY_MEMORY(residual);
  bwi_eigen_problem problem = {
      .size = size, .mesh = p->mesh, .data = p->data, .mass = p->stiffness};
  bwi_eigen_result part[2] = {
      {.count = f->positive, .value = f->factor, .vector = f->vector, .residual = residual},
      {.count = f->count - f->positive,
       .value = f->factor + f->positive,
       .vector = f->vector + f->positive * size,
       .residual = residual}};
  for (int k = f->positive; k < f->count; k++)
    f->factor[k] = -f->factor[k];
  for (int sign = 0; sign < 2; sign++)
    BW_TRY(bwi_eigen_canonical(context, &problem, tolerance, &part[sign], &changed));
  for (int k = f->positive; k < f->count; k++)
    f->factor[k] = -f->factor[k];
done:
  bw_free(residual);
  return status;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* With r = -K^-1 K_sigma x - mu x and |x| = 1 in the norm of K, an eigenvalue lies within |r| of mu
 * = 1/lambda. */
static bw_status find_errors(bw_context *context, bwi_stability *p, found *f) {
  bw_status status = BW_OK;
  int64_t size = p->size;
  double *r = BW_NEW(context, double, BWI_STABILITY_SIDES *size);
  BW_TRY_MEMORY(r);
  for (int first = 0; first < f->count; first += BWI_STABILITY_SIDES) {
    int part = f->count - first < BWI_STABILITY_SIDES ? f->count - first : BWI_STABILITY_SIDES;
    const double *x = f->vector + first * size;
    BW_TRY(p->stress(context, p->data, part, x, p->work));
    BW_TRY(solve(context, p, part, p->work, r));
    for (int k = 0; k < part; k++)
      for (int64_t i = k * size; i < (k + 1) * size; i++)
        r[i] = -r[i] - x[i] / f->factor[first + k];
    BW_TRY(p->stiffness(context, p->data, part, r, p->work));
    for (int k = 0; k < part; k++) {
      double square = 0, size_of_factor = fabs(f->factor[first + k]);
      for (int64_t i = k * size; i < (k + 1) * size; i++)
        square += r[i] * p->work[i];
      double relative = sqrt(fmax(square, 0)) * size_of_factor;
      f->error[first + k] = relative < 1 ? size_of_factor * relative / (1 - relative) : INFINITY;
    }
  }
done:
  bw_free(r);
  return status;
}

/* ---- the search ------------------------------------------------------------------------------ */

static int wanted_among(const found *f, bw_buckling_sign sign) {
  return sign == BW_BUCKLING_POSITIVE   ? f->positive
         : sign == BW_BUCKLING_NEGATIVE ? f->count - f->positive
                                        : f->count;
}

/* Where none of the wanted sign was found: whether a count shows that there is none up to `far`
 * times the smallest factor. */
static bw_status look_far(bw_context *context, const bwi_stability *p,
                          const bw_buckling_options *options, const found *f, bw_buckling *out,
                          bool *none) {
  bw_status status = BW_OK;
  int64_t count;
  bool trusted;
  double s = far * fabs(f->factor[0]);
  BW_TRY(p->between(context, p->data, options->sign == BW_BUCKLING_POSITIVE ? s : -s, &count,
                    &trusted));
  *none = trusted && count == 0;
  if (*none) {
    out->searched = s;
    out->counted = true;
  }
done:
  return status;
}

/* More and more squares, until there are enough of the wanted sign. */
static bw_status search(bw_context *context, bwi_stability *p, const bw_buckling_options *options,
                        found *f, bw_buckling *out) {
  bw_status status = BW_OK;
  bwi_eigen_result result = {0};
  bool none = false;
  int64_t dimension = p->dimension;
  bwi_eigen_problem problem = {.size = p->size,
                               .mesh = p->mesh,
                               .data = p,
                               .solve = solve,
                               .mass = squared,
                               .stiffness = stiffness,
                               .project = project,
                               .below = p->between ? below : NULL,
                               .dimension = dimension};
  int most = 8 * options->count > SEARCHED ? 8 * options->count : SEARCHED;
  bw_modes_options ask = {.count = options->count + BEYOND,
                          .tolerance = options->tolerance,
                          .sturm = options->sturm,
                          .seed = options->seed,
                          .solver = options->solver};
  for (;; ask.count *= 2) {
    bwi_eigen_result_clear(&result);
    found_clear(f);
    BW_TRY(bwi_eigen_lowest(context, &problem, &ask, &result));
    bool all = result.count >= dimension;
    int n = whole_clusters(&result, all);
    out->recovered += result.recovered;
    if (n > 0) {
      BW_TRY(separate_signs(context, p, n, result.vector, f));
      out->searched = sqrt(result.value[n - 1]);
      out->counted = result.counted;
      if (wanted_among(f, options->sign) == 0 && options->sturm && p->between && !all)
        BW_TRY(look_far(context, p, options, f, out, &none));
    }
    if (all || none || wanted_among(f, options->sign) >= options->count || ask.count >= most)
      break;
  }
  out->report = result.report;
  BW_TRY(f->count ? make_canonical(context, p, options->tolerance, f) : BW_OK);
done:
  bwi_eigen_result_clear(&result);
  return status;
}

/* ---- the result ------------------------------------------------------------------------------ */

/* By size; of one size, the positive one first. */
static int next_of(const found *f, const int taken[2], bw_buckling_sign sign) {
  int p = taken[0] < f->positive && sign != BW_BUCKLING_NEGATIVE ? taken[0] : -1;
  int n = f->positive + taken[1] < f->count && sign != BW_BUCKLING_POSITIVE ? f->positive + taken[1]
                                                                            : -1;
  if (p < 0 || n < 0)
    return p < 0 ? n : p;
  return f->factor[p] <= -f->factor[n] * (1 + 1e-6) ? p : n;
}

static void scale_shape(int64_t nodes, double *shape) {
  double largest = 0;
  for (int64_t i = 0; i < nodes; i++)
    largest = fmax(largest, hypot(hypot(shape[3 * i], shape[3 * i + 1]), shape[3 * i + 2]));
  for (int64_t i = 0; i < 3 * nodes; i++)
    shape[i] /= largest;
  bwi_fix_sign(shape, 3 * nodes);
}

static bw_status take_result(bw_context *context, const bwi_stability *p,
                             const bw_buckling_options *options, const found *f, bw_buckling *out) {
  bw_status status = BW_OK;
  int64_t nodes = out->model->mesh->node_count;
  int count = wanted_among(f, options->sign), taken[2] = {0, 0};
  out->count = count < options->count ? count : options->count;
  out->factor = BW_NEW(context, double, out->count);
  out->error = BW_NEW(context, double, out->count);
  out->shape = BW_NEW(context, double, out->count * 3 * nodes);
  BW_TRY_MEMORY(out->factor && out->error && out->shape);
  for (int k = 0; k < out->count; k++) {
    int from = next_of(f, taken, options->sign);
    const double *vector = f->vector + from * p->size;
    double *shape = out->shape + k * 3 * nodes;
    taken[from >= f->positive]++;
    out->factor[k] = f->factor[from];
    out->error[k] = f->error[from];
    if (p->at_nodes)
      BW_TRY(p->at_nodes(context, p->data, vector, shape));
    else
      memcpy(shape, vector, (size_t)(3 * nodes) * sizeof *shape);
    scale_shape(nodes, shape);
    out->report.residual = fmax(out->report.residual, f->error[from] / fabs(f->factor[from]));
  }
done:
  return status;
}

/* ---- what is asked for ----------------------------------------------------------------------- */

bw_status bwi_buckling_options_check(bw_context *context, const bw_buckling_options *given,
                                     bw_buckling_options *options) {
  bw_buckling_options_default(options);
  if (given)
    *options = *given;
  const bw_eigensolver *solver = options->solver;
  if (options->count < 1 || options->count > MOST)
    return bw_fail(context, BW_INVALID, "%d load factors were requested: 1 to %d expected",
                   options->count, MOST);
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance on load factors is %g; it must lie between 0 and 1",
                   options->tolerance);
  if (solver && solver->options.kind == BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "SLEPc computes elastic modes alone: buckling takes lanczos, arpack or lobpcg");
  if (solver && solver->options.preconditioner)
    return bw_fail(context, BW_UNSUPPORTED,
                   "buckling has a factor of the stiffness: lobpcg takes no other preconditioner");
  return BW_OK;
}

bw_status bwi_buckling_find(bw_context *context, bwi_stability *p,
                            const bw_buckling_options *options, bw_buckling *out) {
  bw_status status = BW_OK;
  found f = {0};
  p->work = BW_NEW(context, double, BWI_STABILITY_SIDES * p->size);
  BW_TRY_MEMORY(p->work);
  BW_TRY(search(context, p, options, &f, out));
  BW_TRY(f.count ? find_errors(context, p, &f) : BW_OK);
  BW_TRY(take_result(context, p, options, &f, out));
  out->solves = p->solves;
done:
  bw_free(p->work);
  p->work = NULL;
  found_clear(&f);
  return status;
}
