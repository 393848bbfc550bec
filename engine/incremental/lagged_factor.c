/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems of equations solved with what is left of an earlier factorisation (responsive, 3.2).
 *
 * When to refactorise: a lagged factor costs more iterations the farther the mesh has moved from
 * its shape; a new factor has a fixed cost. The average cost of a solve since the last
 * factorisation, with its cost included, decreases as long as a solve costs less than that average.
 * So the matrix is refactorised when the next solve with the lagged factor is predicted to cost
 * more. Costs are operations and bytes counted over the rates of one fixed machine, and iterations
 * as they were needed, so that the same drag takes the same decisions everywhere.
 *
 * A solve that needs much more than predicted stops, refactorises and continues from its present
 * iterate. */
#include <math.h>
#include <string.h>

#include "base/cost.h"
#include "incremental/lagged_factor.h"
#include "linear/pcg_space.h"
#include "linear/vectors.h"

/* Per node: analysis under a given order, and finding an order. */
#define ANALYSIS_SECONDS 2e-7
#define ORDER_SECONDS 3e-7
/* Iterations expected of the first solve with an old factor, and of the first after edges were
 * flipped: before any are counted, few, so that the former is made, and many, since flips
 * change entries altogether; and less by this fraction each time that the expectation ruled it out,
 * since drags slow down. */
#define FIRST_GUESS 2.0
#define FIRST_GUESS_FLIPPED 25.0
#define DISCOUNT 0.9

struct bw_lagged_factor {
  bool symmetric;
  int components;
  bwi_lagged_symmetric *cholesky;
  bwi_lagged_unsymmetric *lu;
  bwi_lagged_blocks *blocks;         /* unsymmetric ones too, */
  bool pivoting;                     /* until they were no good for these nodes: */
  const bw_plane_topology *topology; /* retained: of the factor; NULL: there is none */
  bwi_lagged_work work;              /* of the last factorisation */
  /* since it: */
  int solves;   /* with the factor old */
  int last;     /* iterations of the last of them */
  double spent; /* s of the reference machine, the factorisation included */
  const bw_plane_topology *last_topology; /* of the last solve, retained */
  double first, first_flipped; /* iterations expected of the first of them, and after flips */
  double *workspace;           /* vectors */
  size_t size;                 /* numbers in each */
};

/* Iterations on a new factor without pivoting before pivoting is called for. */
enum { ENOUGH = 15 };
enum { SYMMETRIC_VECTORS = 5, UNSYMMETRIC_VECTORS = 8 };

void bw_lagged_factor_options_default(bw_lagged_factor_options *options) {
  *options = (bw_lagged_factor_options){BW_LAGGED_FACTOR_AUTO, 1e-8, 60};
}

bw_status bw_lagged_factor_create(bw_context *context, bool symmetric, int components,
                                  bw_lagged_factor **out) {
  bw_status status = BW_OK;
  int max = symmetric ? 3 : BWI_MAX_COMPONENTS;
  if (components < 1 || components > max)
    return bw_fail(context, BW_INVALID, "%d components at a node; 1 to %d are possible", components,
                   max);
  bw_lagged_factor *lagged = BW_NEW0(context, bw_lagged_factor, 1);
  if (!lagged)
    return BW_MEMORY;
  lagged->symmetric = symmetric;
  lagged->components = components;
  lagged->first = FIRST_GUESS;
  lagged->first_flipped = FIRST_GUESS_FLIPPED;
  if (symmetric)
    BW_TRY(bwi_lagged_symmetric_create(context, components, &lagged->cholesky));
  else
    BW_TRY(bwi_lagged_unsymmetric_create(context, components, &lagged->lu));
  if (!symmetric)
    BW_TRY(bwi_lagged_blocks_create(context, components, &lagged->blocks));
done:
  if (status == BW_OK)
    *out = lagged;
  else
    bw_lagged_factor_destroy(lagged);
  return status;
}

/* Orders, analyses, numbers. */
static void reset_solvers(bw_lagged_factor *lagged) {
  if (lagged->cholesky)
    bwi_lagged_symmetric_reset(lagged->cholesky);
  if (lagged->lu)
    bwi_lagged_unsymmetric_reset(lagged->lu);
  if (lagged->blocks)
    bwi_lagged_blocks_reset(lagged->blocks);
}

static void forget_factor(bw_lagged_factor *lagged) {
  bw_release(lagged->topology);
  bw_release(lagged->last_topology);
  lagged->topology = lagged->last_topology = NULL;
  lagged->solves = lagged->last = 0;
  lagged->spent = 0;
}

void bw_lagged_factor_reset(bw_lagged_factor *lagged) {
  reset_solvers(lagged);
  forget_factor(lagged);
  lagged->pivoting = false;
  lagged->first = FIRST_GUESS;
  lagged->first_flipped = FIRST_GUESS_FLIPPED;
  bw_free(lagged->workspace);
  lagged->workspace = NULL;
  lagged->size = 0;
}

void bw_lagged_factor_destroy(bw_lagged_factor *lagged) {
  if (!lagged)
    return;
  bw_lagged_factor_reset(lagged);
  bwi_lagged_symmetric_destroy(lagged->cholesky);
  bwi_lagged_unsymmetric_destroy(lagged->lu);
  bwi_lagged_blocks_destroy(lagged->blocks);
  bw_free(lagged);
}

bw_status bw_lagged_factor_apply(bw_context *context, bw_lagged_factor *lagged, const double *r,
                                 double *z) {
  if (!lagged->symmetric && !lagged->pivoting && lagged->topology) {
    bwi_lagged_blocks_apply(lagged->blocks, r, z);
    return BW_OK;
  }
  return lagged->symmetric ? bwi_lagged_symmetric_apply(context, lagged->cholesky, false, r, z)
                           : bwi_lagged_unsymmetric_apply(context, lagged->lu, r, z);
}

/* ---- the model's costs --------------------------------------------------------------------- */

/* An old Cholesky factor is read twice in single precision, a new one twice in double and in
 * another order than it lies in; UMFPACK's once for each of two solves. */
static double iteration_seconds(const bw_lagged_factor *lagged, const bw_plane_pattern *pattern,
                                bool old) {
  double square = lagged->components * lagged->components;
  double matrix = (8 * square + 4) * (double)pattern->block_count;
  double vectors = 12 * 8.0 * (double)pattern->node_count * lagged->components;
  double factor = lagged->symmetric && !old ? 4 * lagged->work.bytes : lagged->work.bytes;
  return (lagged->symmetric ? 1 : 2) * (factor + matrix + vectors) /
         BWI_COST_PLANE_BYTES_PER_SECOND;
}

/* Copying a Cholesky factor to single precision, before it is first used as an old one. */
static double copy_seconds(const bw_lagged_factor *lagged) {
  return lagged->symmetric && lagged->solves == 0
             ? 1.5 * lagged->work.bytes / BWI_COST_PLANE_FACTOR_BYTES_PER_SECOND
             : 0;
}

/* With the analysis rebuilt where the topology is another than the factor's. */
static double factor_seconds(const bw_lagged_factor *lagged, const bw_plane_pattern *pattern,
                             bool analysis) {
  double seconds =
      lagged->symmetric ? lagged->work.flops / BWI_COST_PLANE_FLOPS_PER_SECOND +
                              2 * lagged->work.bytes / BWI_COST_PLANE_FACTOR_BYTES_PER_SECOND
      : !lagged->pivoting ? lagged->work.flops / BWI_COST_BLOCKS_FLOPS_PER_SECOND
                          : lagged->work.flops / BWI_COST_UMFPACK_FLOPS_PER_SECOND +
                                4 * lagged->work.bytes / BWI_COST_PLANE_FACTOR_BYTES_PER_SECOND;
  return seconds + (analysis ? ANALYSIS_SECONDS * pattern->node_count : 0);
}

/* Iterations that the next solve with the factor as it is should take. Meshes move on, the error
 * of the factor grows about in proportion to the number of moves, and iterations with it. */
static double expected_iterations(const bw_lagged_factor *lagged, const bw_plane_pattern *pattern) {
  if (lagged->last_topology != pattern->topology)
    return lagged->first_flipped;
  if (lagged->solves > 0)
    return lagged->last * (1 + 1.0 / lagged->solves);
  return lagged->first;
}

/* ---- factoring ----------------------------------------------------------------------------- */

static bw_status factor(bw_context *context, bw_lagged_factor *lagged,
                        const bw_plane_pattern *pattern, const double *values,
                        bw_lagged_factor_method method, bw_plane_reuse *reuse) {
  double start = bw_seconds();
  bwi_lagged_work work = {0};
  bw_status status = BW_OK;
  if (method == BW_LAGGED_FACTOR_FULL)
    reset_solvers(lagged);
  forget_factor(lagged);
  if (lagged->symmetric)
    status = bwi_lagged_symmetric_factor(context, lagged->cholesky, pattern, values, &work);
  else {
    if (!lagged->pivoting) {
      bool done = false;
      status = bwi_lagged_blocks_factor(context, lagged->blocks, pattern, values, &done, &work);
      lagged->pivoting = status == BW_OK && !done;
    }
    if (lagged->pivoting)
      status = bwi_lagged_unsymmetric_factor(context, lagged->lu, pattern, values, &work);
  }
  reuse->analyses += work.analysed;
  reuse->factorisations++;
  reuse->factor = false;
  reuse->seconds_factor += bw_seconds() - start;
  if (status != BW_OK)
    return status;
  lagged->topology = bw_retain(pattern->topology);
  lagged->work = work;
  lagged->spent = factor_seconds(lagged, pattern, work.analysed) +
                  (work.reordered ? ORDER_SECONDS * pattern->node_count : 0);
  return BW_OK;
}

/* ---- iterating ----------------------------------------------------------------------------- */

typedef struct iteration {
  bw_context *context;
  bw_lagged_factor *lagged;
  const bw_plane_pattern *pattern;
  const double *values, *rhs;
  double *x;       /* best so far */
  double size;     /* |b| */
  double residual; /* |b - A x| / |b| */
  double tolerance;
  int count; /* iterations done */
  bool zero; /* x is */
  bool old;  /* the factor is of another matrix */
} iteration;

static bw_status multiply(const iteration *it, const double *x, double *y) {
  return bw_plane_multiply(it->context, it->pattern, it->lagged->components, it->values, x, y);
}

/* r = b - A x, and its relative size */
static bw_status true_residual(iteration *it, double *r) {
  if (it->zero && it->count == 0) {
    memcpy(r, it->rhs, it->lagged->size * sizeof *r);
    it->residual = 1;
    return BW_OK;
  }
  it->zero = false;
  bw_status status = multiply(it, it->x, r);
  if (status == BW_OK)
    status = bwi_subtract_from(it->context, it->lagged->size, it->rhs, r, &it->residual);
  it->residual = sqrt(it->residual) / it->size;
  return status;
}

static bw_status multiply_one(bw_context *context, void *data, int64_t count, const double *x,
                              double *y) {
  (void)context;
  (void)count;
  return multiply(data, x, y);
}

static bw_status precondition_one(bw_context *context, void *data, int64_t count, const double *r,
                                  double *z) {
  const iteration *it = data;
  (void)count;
  return bwi_lagged_symmetric_apply(context, it->lagged->cholesky, it->old, r, z);
}

/* Conjugate gradients from x, for at most `limit` iterations; ends early where the factor is too
 * old, or the matrix not positive definite. */
static bw_status conjugate_gradients(iteration *it, int limit) {
  bw_status status = BW_OK;
  size_t n = it->lagged->size;
  const bwi_pcg_fields fields = {.size = (int64_t)n,
                                 .multiply = multiply_one,
                                 .multiply_data = it,
                                 .precondition = precondition_one,
                                 .precondition_data = it,
                                 .symmetric = true,
                                 .guess = !it->zero,
                                 .work = it->lagged->workspace + n};
  bwi_pcg_task task = {.columns = 1,
                       .energy_tolerance = INFINITY,
                       .residual_tolerance = it->tolerance,
                       .load = &it->size,
                       .limit = limit};
  BW_TRY(bwi_pcg_fields_run(it->context, &fields, &task, it->rhs, it->x));
  it->count = task.iterations;
  it->zero &= task.iterations == 0;
  it->residual = task.residual;
  /* The recurrence and the truth part slowly: what is reported is the truth. */
  if (!task.converged && task.iterations > 0)
    BW_TRY(true_residual(it, it->lagged->workspace + n));
done:
  return status;
}

/* BiCGSTAB with the factor on the right, so that the residual is the true one. An iteration is two
 * products and two solves. */
static bw_status stabilised(iteration *it, int limit) {
  bw_status status = BW_OK;
  bw_context *context = it->context;
  size_t n = it->lagged->size;
  double *r = it->lagged->workspace + n, *shadow = r + n, *p = shadow + n, *v = p + n, *t = v + n,
         *y = t + n, *z = y + n;
  double rho = 1, alpha = 1, omega = 1;
  BW_TRY(true_residual(it, r));
  memcpy(shadow, r, n * sizeof *r);
  memset(p, 0, n * sizeof *p);
  memset(v, 0, n * sizeof *v);
  for (int i = 0; i < limit && it->residual > it->tolerance; i++) {
    double next, dot, square, ts;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_blocked_dot(context, n, shadow, r, &next));
    double beta = i ? next / rho * (alpha / omega) : 0;
    if (next == 0 || !isfinite(beta))
      break;
    rho = next;
    BW_TRY(bwi_direction(context, n, beta, omega, r, v, p));
    BW_TRY(bw_lagged_factor_apply(context, it->lagged, p, y));
    BW_TRY(multiply(it, y, v));
    BW_TRY(bwi_blocked_dot(context, n, shadow, v, &dot));
    it->count++;
    alpha = rho / dot;
    if (!isfinite(alpha))
      break;
    BW_TRY(bwi_step(context, n, alpha, y, v, it->x, r, &square));
    it->residual = sqrt(square) / it->size;
    if (it->residual <= it->tolerance || !isfinite(it->residual))
      break;
    BW_TRY(bw_lagged_factor_apply(context, it->lagged, r, z));
    BW_TRY(multiply(it, z, t));
    BW_TRY(bwi_blocked_dot(context, n, t, t, &square));
    BW_TRY(bwi_blocked_dot(context, n, t, r, &ts));
    omega = ts / square;
    if (!isfinite(omega) || omega == 0)
      break;
    BW_TRY(bwi_step(context, n, omega, z, t, it->x, r, &square));
    it->residual = sqrt(square) / it->size;
    if (!isfinite(it->residual))
      break;
  }
  if (it->count > 0)
    BW_TRY(true_residual(it, r));
done:
  return status;
}

static bw_status iterate(iteration *it, int limit, bw_plane_reuse *reuse) {
  double start = bw_seconds();
  it->count = 0;
  bw_status status = it->lagged->symmetric ? conjugate_gradients(it, limit) : stabilised(it, limit);
  reuse->iterations += it->count;
  reuse->seconds_solve += bw_seconds() - start;
  return status;
}

/* ---- a solve ------------------------------------------------------------------------------- */

static bw_status prepare(bw_context *context, bw_lagged_factor *lagged,
                         const bw_plane_pattern *pattern) {
  size_t n = (size_t)pattern->node_count * (size_t)lagged->components;
  if (lagged->workspace && lagged->size == n)
    return BW_OK;
  double *workspace =
      BW_NEW(context, double, n *(lagged->symmetric ? SYMMETRIC_VECTORS : UNSYMMETRIC_VECTORS));
  if (!workspace)
    return BW_MEMORY;
  bw_free(lagged->workspace);
  lagged->workspace = workspace;
  lagged->size = n;
  return BW_OK;
}

bw_status bw_lagged_factor_solve(bw_context *context, bw_lagged_factor *lagged,
                                 const bw_plane_pattern *pattern, const double *values,
                                 const double *rhs, double *x,
                                 const bw_lagged_factor_options *options, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  bw_lagged_factor_options defaults;
  bw_plane_reuse ignored = {0};
  double square;
  bw_lagged_factor_options_default(&defaults);
  options = options ? options : &defaults;
  reuse = reuse ? reuse : &ignored;
  if (!(options->tolerance > 0) || options->iterations < 1)
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g and %d iterations: both above 0 expected", options->tolerance,
                   options->iterations);
  BW_TRY(prepare(context, lagged, pattern));
  size_t n = lagged->size;
  iteration it = {.context = context,
                  .lagged = lagged,
                  .pattern = pattern,
                  .values = values,
                  .rhs = rhs,
                  .x = lagged->workspace,
                  .tolerance = options->tolerance};
  reuse->solves++;
  BW_TRY(bwi_blocked_dot(context, n, rhs, rhs, &square));
  it.size = sqrt(square);
  if (!isfinite(it.size)) {
    status = bw_fail(context, BW_INVALID, "the right-hand side is not finite");
    goto done;
  }
  if (it.size == 0) {
    memset(x, 0, n * sizeof *x);
    goto done;
  }
  memcpy(it.x, x, n * sizeof *x);
  BW_TRY(bwi_blocked_dot(context, n, x, x, &square));
  it.zero = !(square > 0 && isfinite(square));
  if (it.zero)
    memset(it.x, 0, n * sizeof *x);

  bool fits = lagged->topology && lagged->topology->nodes == pattern->topology->nodes;
  bool flipped = fits && lagged->topology != pattern->topology;
  bool refactorise = !fits || options->method == BW_LAGGED_FACTOR_REFACTOR ||
                     options->method == BW_LAGGED_FACTOR_FULL;
  int limit = options->iterations;
  double one = 0, old = 0, rebuilt = 0;
  if (fits) {
    one = iteration_seconds(lagged, pattern, true);
    rebuilt = factor_seconds(lagged, pattern, flipped) + iteration_seconds(lagged, pattern, false);
    old = copy_seconds(lagged) + expected_iterations(lagged, pattern) * one;
    reuse->predicted_iterate += old;
    reuse->predicted_factor += rebuilt;
  }
  if (!refactorise && options->method == BW_LAGGED_FACTOR_AUTO) {
    double average = lagged->spent / (lagged->solves + 1); /* the first was with the factor new */
    double break_even = average < rebuilt ? average : rebuilt;
    refactorise = old > break_even;
    if (refactorise && lagged->last_topology != pattern->topology)
      lagged->first_flipped *= DISCOUNT;
    else if (refactorise && lagged->solves == 0)
      lagged->first *= DISCOUNT;
    /* No more than a new factor would have cost. */
    limit = (int)fmin(limit, 2 + rebuilt / one);
  }
  if (!refactorise) {
    reuse->factor = true;
    it.old = true;
    BW_TRY(iterate(&it, limit, reuse));
    it.old = false;
    lagged->spent += copy_seconds(lagged) + it.count * one;
    lagged->solves++;
    lagged->last = it.count;
    if (lagged->last_topology != pattern->topology)
      lagged->first_flipped = it.count > 0 ? it.count : 1;
    else if (lagged->solves == 1)
      lagged->first = it.count > 0 ? it.count : 1;
    refactorise = !(it.residual <= it.tolerance);
    if (refactorise && !isfinite(it.residual))
      memcpy(it.x, x, n * sizeof *x);
  }
  if (refactorise) {
    if (!fits)
      lagged->pivoting = false;
    BW_TRY(factor(context, lagged, pattern, values, options->method, reuse));
    bool blocks = !lagged->symmetric && !lagged->pivoting;
    BW_TRY(
        iterate(&it, blocks && options->iterations > ENOUGH ? ENOUGH : options->iterations, reuse));
    if (blocks && !(it.residual <= it.tolerance)) {
      lagged->pivoting = true;
      if (!isfinite(it.residual))
        memcpy(it.x, x, n * sizeof *x);
      BW_TRY(factor(context, lagged, pattern, values, options->method, reuse));
      BW_TRY(iterate(&it, options->iterations, reuse));
    }
    lagged->spent += it.count * iteration_seconds(lagged, pattern, false);
  }
  if (!(it.residual <= reuse->residual))
    reuse->residual = it.residual;
  if (!(it.residual <= it.tolerance)) {
    status =
        bw_fail(context, BW_CONVERGENCE,
                "the solution of %zu equations stopped at a relative residual of %.3g after %d "
                "iterations with a new factor; %.3g was requested: the matrix is close to singular",
                n, it.residual, it.count, it.tolerance);
    bw_detail_number(context, "residual", it.residual);
    bw_detail_number(context, "iterations", it.count);
    goto done;
  }
  memcpy(x, it.x, n * sizeof *x);
  bw_retain(pattern->topology);
  bw_release(lagged->last_topology);
  lagged->last_topology = pattern->topology;
done:
  return status;
}
