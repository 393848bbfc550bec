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
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/cost.h"
#include "incremental/lagged_factor.h"
#include "linear/pcg_space.h"
#include "linear/vectors.h"

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
  bwi_lagged *kind[2];               /* Cholesky, or LU of blocks and the one with pivoting: */
  bool pivoting;                     /* the other was no good for these nodes */
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
/* Iterations before refactoring. */
enum { MAX_ITERATIONS = 60 };

void bw_lagged_factor_options_default(bw_lagged_factor_options *options) {
  *options = (bw_lagged_factor_options){.tolerance = 1e-8, .max_lag = INT_MAX};
}

/* ---- what is asked for --------------------------------------------------------------------- */

/* What the options come to. */
typedef struct lag_plan {
  bool by_cost; /* whichever is predicted to cost less */
  bool each;    /* factor for each solution, */
  bool whole;   /* and analyse too */
  double tolerance;
  int max_iterations, max_lag;
} lag_plan;

static bw_status refused(bw_context *context, const bw_lagged_factor *lagged,
                         const bw_solver *solver) {
  char text[BW_SOLVER_TEXT];
  bw_solver_describe(solver, text);
  return bw_fail(context, BW_INVALID,
                 "the solver %s does not serve the equations of a plane mesh: give %s", text,
                 lagged->symmetric
                     ? "cholesky of the backend multifrontal in double precision, or pcg with that "
                       "as its preconditioner"
                     : "lu, or bicgstab with lu as its preconditioner: the matrix of a flow is "
                       "not symmetric");
}

/* A factor that is made here. */
static bool is_own(const bw_lagged_factor *lagged, const bw_solver *solver) {
  const bw_solver_options *o = &solver->options;
  return o->kind == (lagged->symmetric ? BW_SOLVER_CHOLESKY : BW_SOLVER_LU) &&
         (o->backend == BW_BACKEND_AUTO || o->backend == BW_BACKEND_MULTIFRONTAL) &&
         o->ordering == BW_ORDERING_AUTO && o->precision != 32;
}

static bw_status make_plan(bw_context *context, const bw_lagged_factor *lagged,
                           const bw_lagged_factor_options *options, lag_plan *plan) {
  const bw_solver *solver = options->solver;
  *plan = (lag_plan){.by_cost = !solver,
                     .tolerance = options->tolerance,
                     .max_iterations = MAX_ITERATIONS,
                     .max_lag = options->max_lag};
  if (!(options->tolerance > 0) || options->max_lag < 0)
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g and a lag of at most %d solutions: above 0, and 0 or more, "
                   "expected",
                   options->tolerance, options->max_lag);
  if (!solver)
    return BW_OK;
  const bw_solver *factor = solver, *m = solver->options.preconditioner;
  if (solver->options.kind == (lagged->symmetric ? BW_SOLVER_PCG : BW_SOLVER_BICGSTAB)) {
    if (m ? !is_own(lagged, m) : lagged->symmetric)
      return refused(context, lagged, solver);
    factor = m;
    if (solver->options.tolerance > 0)
      plan->tolerance = solver->options.tolerance;
    if (solver->options.max_iterations > 0)
      plan->max_iterations = solver->options.max_iterations;
  } else if (!is_own(lagged, solver))
    return refused(context, lagged, solver);
  else {
    plan->each = true;
    if (options->max_lag != INT_MAX)
      return bw_fail(context, BW_INVALID,
                     "max_lag has no effect with the solver %s, which factors for each solution: "
                     "leave one of them out",
                     bw_solver_word(solver->options.kind));
  }
  plan->whole = factor && factor->options.full;
  return BW_OK;
}

/* ---- life ---------------------------------------------------------------------------------- */

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
  BW_TRY(bwi_lagged_create(context, symmetric ? &bwi_lagged_symmetric : &bwi_lagged_blocks,
                           components, &lagged->kind[0]));
  if (!symmetric)
    BW_TRY(bwi_lagged_create(context, &bwi_lagged_unsymmetric, components, &lagged->kind[1]));
done:
  if (status == BW_OK)
    *out = lagged;
  else
    bw_lagged_factor_destroy(lagged);
  return status;
}

/* Orders, analyses, numbers. */
static void reset_solvers(bw_lagged_factor *lagged) {
  bwi_lagged_reset(lagged->kind[0]);
  bwi_lagged_reset(lagged->kind[1]);
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
  bwi_lagged_destroy(lagged->kind[0]);
  bwi_lagged_destroy(lagged->kind[1]);
  bw_free(lagged);
}

bw_status bw_lagged_factor_apply(bw_context *context, bw_lagged_factor *lagged, const double *r,
                                 double *z) {
  return bwi_lagged_apply(context, lagged->kind[lagged->pivoting], false, r, z);
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
  return (lagged->symmetric ? 1 : 2) * (factor + matrix + vectors) / BWI_COST_BYTES_PER_SECOND;
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
  return seconds + (analysis ? BWI_COST_PLANE_ANALYSIS_NODE * pattern->node_count : 0);
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
                        const bw_plane_pattern *pattern, const double *values, bool whole,
                        bw_plane_reuse *reuse) {
  double start = bw_seconds();
  bwi_lagged_work work = {0};
  bw_status status = BW_OK;
  if (whole)
    reset_solvers(lagged);
  forget_factor(lagged);
  if (!lagged->pivoting) {
    status = bwi_lagged_factor(context, lagged->kind[0], pattern, values, &work);
    lagged->pivoting = status == BW_OK && work.refused;
  }
  if (lagged->pivoting)
    status = bwi_lagged_factor(context, lagged->kind[1], pattern, values, &work);
  reuse->analyses += work.analysed;
  reuse->factorisations++;
  reuse->factor = false;
  reuse->seconds_factor += bw_seconds() - start;
  reuse->report.flops += work.flops;
  if (status != BW_OK)
    return status;
  lagged->topology = bw_retain(pattern->topology);
  lagged->work = work;
  lagged->spent = factor_seconds(lagged, pattern, work.analysed) +
                  (work.reordered ? BWI_COST_PLANE_ORDER_NODE * pattern->node_count : 0);
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
  return bwi_lagged_apply(context, it->lagged->kind[0], it->old, r, z);
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

/* What the solution with the factor as it is, and with a new one, are predicted to cost. */
typedef struct prediction {
  bool flipped;             /* edges were, since the factor */
  double one, old, rebuilt; /* s: an iteration, the solution, or 0 where there is no choice */
} prediction;

/* Why the factor is made again, or NULL: it is not. No iterations are allowed than a new factor
 * would cost. */
static const char *why_factor(bw_lagged_factor *lagged, const bw_plane_pattern *pattern,
                              const lag_plan *plan, prediction *cost, int *limit) {
  if (!lagged->topology || lagged->topology->nodes != pattern->topology->nodes)
    return "there is no factor of this mesh yet";
  cost->flipped = lagged->topology != pattern->topology;
  cost->one = iteration_seconds(lagged, pattern, true);
  cost->rebuilt =
      factor_seconds(lagged, pattern, cost->flipped) + iteration_seconds(lagged, pattern, false);
  cost->old = copy_seconds(lagged) + expected_iterations(lagged, pattern) * cost->one;
  if (plan->each)
    return "it was given";
  if (lagged->solves >= plan->max_lag)
    return "the factor has served as many solutions as max_lag allows";
  if (!plan->by_cost)
    return NULL;
  double average = lagged->spent / (lagged->solves + 1); /* the first was with the factor new */
  bool refactorise = cost->old > fmin(average, cost->rebuilt);
  if (refactorise && lagged->last_topology != pattern->topology)
    lagged->first_flipped *= DISCOUNT;
  else if (refactorise && lagged->solves == 0)
    lagged->first *= DISCOUNT;
  /* No more than a new factor would have cost. */
  *limit = (int)fmin(*limit, 2 + cost->rebuilt / cost->one);
  return refactorise ? "a new factor is predicted to cost least" : NULL;
}

/* With the factor that is there. */
static bw_status solve_lagged(iteration *it, int limit, const double *x, const prediction *cost,
                              bw_plane_reuse *reuse) {
  bw_lagged_factor *lagged = it->lagged;
  reuse->factor = true;
  it->old = true;
  bw_status status = iterate(it, limit, reuse);
  it->old = false;
  if (status != BW_OK)
    return status;
  lagged->spent += copy_seconds(lagged) + it->count * cost->one;
  lagged->solves++;
  lagged->last = it->count;
  if (lagged->last_topology != it->pattern->topology)
    lagged->first_flipped = it->count > 0 ? it->count : 1;
  else if (lagged->solves == 1)
    lagged->first = it->count > 0 ? it->count : 1;
  if (!isfinite(it->residual))
    memcpy(it->x, x, lagged->size * sizeof *x);
  return BW_OK;
}

/* With a new factor; pivoting only where that without does not do. */
static bw_status solve_factored(iteration *it, const lag_plan *plan, const double *x,
                                bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  bw_lagged_factor *lagged = it->lagged;
  BW_TRY(factor(it->context, lagged, it->pattern, it->values, plan->whole, reuse));
  bool blocks = !lagged->symmetric && !lagged->pivoting;
  int limit = plan->max_iterations;
  BW_TRY(iterate(it, blocks && limit > ENOUGH ? ENOUGH : limit, reuse));
  if (blocks && !(it->residual <= it->tolerance)) {
    lagged->pivoting = true;
    if (!isfinite(it->residual))
      memcpy(it->x, x, lagged->size * sizeof *x);
    BW_TRY(factor(it->context, lagged, it->pattern, it->values, plan->whole, reuse));
    BW_TRY(iterate(it, limit, reuse));
  }
  lagged->spent += it->count * iteration_seconds(lagged, it->pattern, false);
done:
  return status;
}

bw_plane_reuse *bwi_reuse_of(bw_plane_reuse *given, bw_plane_reuse *own) {
  bw_plane_reuse *reuse = given ? given : own;
  bw_solver_report *report = &reuse->report;
  if (!report->solver)
    report->solver = report->backend = report->preconditioner = "";
  return reuse;
}

static void fill_report(const bw_lagged_factor *lagged, const lag_plan *plan,
                        const prediction *cost, const char *reason, bool factored, double seconds,
                        bw_plane_reuse *reuse) {
  bw_solver_report *report = &reuse->report;
  const char *factor = bw_solver_word(lagged->symmetric ? BW_SOLVER_CHOLESKY : BW_SOLVER_LU);
  report->solver = factored            ? factor
                   : lagged->symmetric ? bw_solver_word(BW_SOLVER_PCG)
                                       : bw_solver_word(BW_SOLVER_BICGSTAB);
  report->preconditioner = factored ? "" : factor;
  report->backend = lagged->symmetric  ? bw_backend_word(BW_BACKEND_MULTIFRONTAL)
                    : lagged->pivoting ? "umfpack"
                                       : "barwright";
  snprintf(report->reason, sizeof report->reason, "%s", reason);
  if (plan->by_cost && cost->one > 0) {
    report->predicted_cost += factored ? cost->rebuilt : cost->old;
    report->rival_cost += factored ? cost->old : cost->rebuilt;
  }
  report->bytes = fmax(report->bytes, lagged->work.bytes);
  report->seconds += seconds;
  report->iterations = reuse->iterations;
  report->residual = reuse->residual;
  report->reused = fmax(0, 1 - (double)reuse->factorisations / reuse->solves);
}

bw_status bw_lagged_factor_solve(bw_context *context, bw_lagged_factor *lagged,
                                 const bw_plane_pattern *pattern, const double *values,
                                 const double *rhs, double *x,
                                 const bw_lagged_factor_options *options, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  bw_lagged_factor_options defaults;
  bw_plane_reuse ignored = {0};
  lag_plan plan;
  prediction cost = {0};
  double square, start = bw_seconds();
  bw_lagged_factor_options_default(&defaults);
  reuse = bwi_reuse_of(reuse, &ignored);
  BW_TRY(make_plan(context, lagged, options ? options : &defaults, &plan));
  BW_TRY(prepare(context, lagged, pattern));
  size_t n = lagged->size;
  iteration it = {.context = context,
                  .lagged = lagged,
                  .pattern = pattern,
                  .values = values,
                  .rhs = rhs,
                  .x = lagged->workspace,
                  .tolerance = plan.tolerance};
  reuse->solves++;
  BW_TRY(bwi_blocked_dot(context, n, rhs, rhs, &square));
  it.size = sqrt(square);
  if (!isfinite(it.size))
    BW_TRY(bw_fail(context, BW_INVALID, "the right-hand side is not finite"));
  if (it.size == 0) {
    memset(x, 0, n * sizeof *x);
    goto done;
  }
  memcpy(it.x, x, n * sizeof *x);
  BW_TRY(bwi_blocked_dot(context, n, x, x, &square));
  it.zero = !(square > 0 && isfinite(square));
  if (it.zero)
    memset(it.x, 0, n * sizeof *x);

  int limit = plan.max_iterations;
  const char *reason = why_factor(lagged, pattern, &plan, &cost, &limit);
  bool factored = reason != NULL;
  if (!factored) {
    reason = plan.by_cost ? "iterations on the lagged factor are predicted to cost least"
                          : "it was given";
    BW_TRY(solve_lagged(&it, limit, x, &cost, reuse));
    factored = !(it.residual <= it.tolerance);
    if (factored)
      reason = "iterations on the lagged factor did not converge";
  }
  if (factored) {
    if (cost.one == 0)
      lagged->pivoting = false;
    BW_TRY(solve_factored(&it, &plan, x, reuse));
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
  fill_report(lagged, &plan, &cost, reason, factored, bw_seconds() - start, reuse);
done:
  return status;
}
