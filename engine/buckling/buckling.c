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

#include "barwright/analysis.h"
#include "barwright/buckling.h"
#include "barwright/job.h"
#include "eigen/internal.h"
#include "linear/blas.h"
#include "linear/multivector.h"
#include "linear/system_solver.h"
#include "model/internal.h"

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

/* ---- products -------------------------------------------------------------------------------- */

typedef struct pencil {
  bw_system *system;
  double *stress; /* K_sigma */
  double *work;   /* size x SIDES */
  int solves;
} pencil;

enum { SIDES = 8 };

static int64_t size_of(const pencil *p) {
  return 3 * (int64_t)p->system->mesh->node_count;
}

static void keep_unknowns(const pencil *p, int64_t count, double *x) {
  for (int64_t k = 0; k < count; k++)
    bwi_keep_states(p->system->dof_map, 1u << BW_DOF_UNKNOWN, x + k * size_of(p));
}

static bw_status multiply(bw_context *context, const pencil *p, const double *values, int block,
                          int64_t count, const double *x, double *y) {
  bw_status status = bw_block_multiply(context, p->system->pattern, values, block, 3, count, x, y);
  keep_unknowns(p, count, y);
  return status;
}

static bw_status stiffness(bw_context *context, void *data, int64_t count, const double *x,
                           double *y) {
  const pencil *p = data;
  return multiply(context, p, p->system->stiffness, 9, count, x, y);
}

static bw_status solve(bw_context *context, void *data, int64_t count, const double *f, double *y) {
  pencil *p = data;
  p->solves += (int)count;
  return bw_system_solve(context, p->system, count, f, y);
}

/* y = S x */
static bw_status squared(bw_context *context, void *data, int64_t count, const double *x,
                         double *y) {
  bw_status status = BW_OK;
  pencil *p = data;
  int64_t size = size_of(p);
  for (int64_t first = 0; first < count; first += SIDES) {
    int64_t part = count - first < SIDES ? count - first : SIDES;
    BW_TRY(multiply(context, p, p->stress, 1, part, x + first * size, y + first * size));
    BW_TRY(solve(context, p, part, y + first * size, p->work));
    BW_TRY(multiply(context, p, p->stress, 1, part, p->work, y + first * size));
  }
done:
  return status;
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  (void)context;
  keep_unknowns(data, count, x);
  return BW_OK;
}

/* Factors between 0 and s, which may be negative. */
static bw_status count_to(bw_context *context, const pencil *p, double s, int64_t *count,
                          bool *trusted) {
  const bw_system *system = p->system;
  bwi_matrix matrix = {.pattern = system->pattern,
                       .stiffness = system->stiffness,
                       .mass = p->stress,
                       .shift = s,
                       .dof_map = system->dof_map};
  return bwi_count_negative(context, system->factor->symbolic, &matrix, count, trusted);
}

static bw_status below(bw_context *context, void *data, double square, int64_t *count,
                       bool *trusted) {
  bw_status status = BW_OK;
  int64_t reversed;
  bool also;
  BW_TRY(count_to(context, data, sqrt(square), count, trusted));
  BW_TRY(count_to(context, data, -sqrt(square), &reversed, &also));
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
static bw_status separate_signs(bw_context *context, pencil *p, int n, const double *x, found *f) {
  bw_status status = BW_OK;
  int64_t size = size_of(p);
  int info = 0, kind = 1, length = 8 * n + 64;
  double *product = BW_NEW(context, double, n *size), *a = BW_NEW(context, double, n *n);
  double *b = BW_NEW(context, double, n *n), *work = BW_NEW(context, double, length);
  f->factor = BW_NEW(context, double, n);
  f->error = BW_NEW(context, double, n);
  f->vector = BW_NEW(context, double, n *size);
  BW_TRY_MEMORY(product && a && b && work && f->factor && f->error && f->vector);
  f->count = n;
  BW_TRY(multiply(context, p, p->stress, 1, n, x, product));
  BW_TRY(bwi_multi_dot(context, size, n, x, n, product, a));
  BW_TRY(stiffness(context, p, n, x, product));
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
static bw_status make_canonical(bw_context *context, pencil *p, double tolerance, found *f) {
  bw_status status = BW_OK;
  int64_t size = size_of(p);
  bool changed;
  double *residual = BW_NEW0(context, double, f->count);
  BW_TRY_MEMORY(residual);
  bwi_eigen_problem problem = {.size = size, .mesh = p->system->mesh, .data = p, .mass = stiffness};
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
static bw_status find_errors(bw_context *context, pencil *p, found *f) {
  bw_status status = BW_OK;
  int64_t size = size_of(p);
  double *r = BW_NEW(context, double, SIDES *size);
  BW_TRY_MEMORY(r);
  for (int first = 0; first < f->count; first += SIDES) {
    int part = f->count - first < SIDES ? f->count - first : SIDES;
    const double *x = f->vector + first * size;
    BW_TRY(multiply(context, p, p->stress, 1, part, x, p->work));
    BW_TRY(solve(context, p, part, p->work, r));
    for (int k = 0; k < part; k++)
      for (int64_t i = k * size; i < (k + 1) * size; i++)
        r[i] = -r[i] - x[i] / f->factor[first + k];
    BW_TRY(stiffness(context, p, part, r, p->work));
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
static bw_status look_far(bw_context *context, const pencil *p, const bw_buckling_options *options,
                          const found *f, bw_buckling *out, bool *none) {
  bw_status status = BW_OK;
  int64_t count;
  bool trusted;
  double s = far * fabs(f->factor[0]);
  BW_TRY(count_to(context, p, options->sign == BW_BUCKLING_POSITIVE ? s : -s, &count, &trusted));
  *none = trusted && count == 0;
  if (*none) {
    out->searched = s;
    out->counted = true;
  }
done:
  return status;
}

/* More and more squares, until there are enough of the wanted sign. */
static bw_status search(bw_context *context, pencil *p, const bw_buckling_options *options,
                        found *f, bw_buckling *out) {
  bw_status status = BW_OK;
  bwi_eigen_result result = {0};
  bool none = false;
  int64_t dimension = p->system->dof_map->unknown_count;
  bwi_eigen_problem problem = {.size = size_of(p),
                               .mesh = p->system->mesh,
                               .data = p,
                               .solve = solve,
                               .mass = squared,
                               .stiffness = stiffness,
                               .project = project,
                               .below = below,
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
      if (wanted_among(f, options->sign) == 0 && options->sturm && !all)
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

static void take_shape(int64_t nodes, const double *vector, double *shape) {
  double largest = 0;
  for (int64_t i = 0; i < nodes; i++)
    largest = fmax(largest, hypot(hypot(vector[3 * i], vector[3 * i + 1]), vector[3 * i + 2]));
  for (int64_t i = 0; i < 3 * nodes; i++)
    shape[i] = vector[i] / largest;
  bwi_fix_sign(shape, 3 * nodes);
}

static bw_status take_result(bw_context *context, const pencil *p,
                             const bw_buckling_options *options, const found *f, bw_buckling *out) {
  int64_t size = size_of(p);
  int count = wanted_among(f, options->sign), taken[2] = {0, 0};
  out->count = count < options->count ? count : options->count;
  out->factor = BW_NEW(context, double, out->count);
  out->error = BW_NEW(context, double, out->count);
  out->shape = BW_NEW(context, double, out->count *size);
  if (!out->factor || !out->error || !out->shape)
    return BW_MEMORY;
  for (int k = 0; k < out->count; k++) {
    int from = next_of(f, taken, options->sign);
    taken[from >= f->positive]++;
    out->factor[k] = f->factor[from];
    out->error[k] = f->error[from];
    take_shape(size / 3, f->vector + from * size, out->shape + k * size);
    out->report.residual = fmax(out->report.residual, f->error[from] / fabs(f->factor[from]));
  }
  return BW_OK;
}

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_options(bw_context *context, const bw_buckling_options *options) {
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

static bw_status check_supports(bw_context *context, const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  char *text = NULL;
  if (dof_map->rigid_mode_count == 0)
    return BW_OK;
  BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  status = bw_fail(context, BW_UNCONSTRAINED,
                   "a body that can move freely has no load factors, because loads that keep their "
                   "directions turn it without resistance; %s. Add supports that constrain it",
                   text);
done:
  bw_free(text);
  return status;
}

static bw_status prepare(bw_context *context, const bw_static *solution, pencil *p) {
  bw_status status = BW_OK;
  bw_system *system = solution->system;
  BW_TRY(bwi_refuse_joints(context, solution->model));
  if (!system)
    return bw_fail(context, BW_UNSUPPORTED,
                   "buckling needs the equations of the static solution in this process: solve the "
                   "model by cholesky or pcg, not by an external solver or in an edit session");
  BW_TRY(check_supports(context, system->dof_map));
  p->system = system;
  p->stress = BW_NEW(context, double, system->pattern->block_count);
  p->work = BW_NEW(context, double, SIDES *size_of(p));
  BW_TRY_MEMORY(p->stress && p->work);
  BW_TRY(bw_stress_stiffness(context, system->pattern, solution->model, solution->displacement,
                             p->stress));
  BW_TRY(bwi_system_factor(context, system, NULL, NULL, bw_available_memory()));
  BW_TRY(bwi_need_factor(context, system));
done:
  return status;
}

bw_status bw_buckling_of_static(bw_context *context, const bw_static *solution,
                                const bw_buckling_options *given, bw_buckling **buckling) {
  bw_status status = BW_OK;
  bw_buckling_options options;
  pencil p = {0};
  found f = {0};
  bw_buckling *out = NULL;
  double start = bw_seconds();
  bw_buckling_options_default(&options);
  if (given)
    options = *given;
  bwi_blas_enter();
  BW_TRY(check_options(context, &options));
  BW_TRY(prepare(context, solution, &p));
  out = BW_NEW0(context, bw_buckling, 1);
  BW_TRY_MEMORY(out);
  bw_object_init(out, &buckling_kind);
  out->model = bw_retain(solution->model);
  BW_TRY(search(context, &p, &options, &f, out));
  BW_TRY(f.count ? find_errors(context, &p, &f) : BW_OK);
  BW_TRY(take_result(context, &p, &options, &f, out));
  out->solves = p.solves;
  out->report.bytes += (double)bwi_factor_bytes(p.system->factor);
  out->report.flops = 4.0 * (double)p.system->times.factor_entries * p.solves;
  out->report.seconds = bw_seconds() - start;
  *buckling = out;
  out = NULL;
done:
  bwi_blas_leave();
  bw_release(out);
  found_clear(&f);
  bw_free(p.stress);
  bw_free(p.work);
  return status;
}

bw_status bw_buckling_error(bw_context *context, const bw_buckling *buckling, double *relative) {
  bw_status status = BW_OK;
  const bw_model *model = buckling->model;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  for (int k = 0; k < buckling->count; k++)
    BW_TRY(bw_shape_error(context, model->mesh, model->material, buckling->shape + k * size,
                          &relative[k]));
done:
  return status;
}
