/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems of equations solved with what is left of an earlier factorisation (responsive, 3.2).
 *
 * When to factor anew is the question of when to replace a machine that wears out: an old factor
 * costs more iterations the farther the mesh has moved from it, a new one costs its making. The
 * average cost of a solve since (and with) the last factorisation falls as long as a solve costs
 * less than that average; so a new factor is made when the next solve with the old one is expected
 * to cost more. Costs are operations and bytes counted over the rates of one fixed machine, and
 * iterations as they were needed, so that the same drag takes the same way everywhere.
 *
 * Nothing is lost by a wrong guess: a solve that needs much more than expected stops, factors and
 * goes on from where it came to. */
#include <math.h>
#include <string.h>

#include "responsive/stale.h"
#include "responsive/vectors.h"

/* The model's machine: of the factorisation, operations and passes over the factor (fronts are
 * small, adding them up is memory traffic); of an iteration, reading. */
#define FLOPS_PER_SECOND 20e9
#define FACTOR_BYTES_PER_SECOND 4e9
#define BYTES_PER_SECOND 16e9
#define UMFPACK_FLOPS_PER_SECOND 1.5e9
#define BLOCKS_FLOPS_PER_SECOND 8e9
/* Per node: analysis under a given order, and finding an order. */
#define ANALYSIS_SECONDS 2e-7
#define ORDER_SECONDS 3e-7
/* Iterations expected of the first solve with an old factor, and of the first after edges were
 * flipped: before there is experience, few, so that the former is made, and many, since flips
 * change entries altogether; and less by this share each time that the expectation ruled it out,
 * since drags slow down. */
#define FIRST_GUESS 2.0
#define FIRST_GUESS_FLIPPED 25.0
#define FORGETTING 0.9

struct bw_stale {
  bool symmetric;
  int components;
  bwi_stale_symmetric *cholesky;
  bwi_stale_unsymmetric *lu;
  bwi_stale_blocks *blocks;          /* unsymmetric ones too, */
  bool pivoting;                     /* until they were no good for these nodes: */
  const bw_plane_topology *topology; /* retained: of the factor; NULL: there is none */
  bwi_stale_work work;               /* of the last factorisation */
  /* since it: */
  int solves;                             /* with the factor old */
  int last;                               /* iterations of the last of them */
  double spent;                           /* s of the model's machine, the factorisation included */
  const bw_plane_topology *last_topology; /* of the last solve, retained */
  double first, first_flipped; /* iterations expected of the first of them, and after flips */
  double *room;                /* vectors */
  size_t size;                 /* numbers in each */
};

/* Iterations on a new factor without pivoting before pivoting is called for. */
enum { ENOUGH = 15 };
enum { SYMMETRIC_VECTORS = 5, UNSYMMETRIC_VECTORS = 8 };

void bw_stale_options_default(bw_stale_options *options) {
  *options = (bw_stale_options){BW_STALE_AUTO, 1e-8, 60};
}

bw_status bw_stale_create(bw_context *context, bool symmetric, int components, bw_stale **out) {
  bw_status status = BW_OK;
  int most = symmetric ? 3 : BWI_MOST_COMPONENTS;
  if (components < 1 || components > most)
    return bw_fail(context, BW_INVALID, "%d components at a node; 1 to %d are possible", components,
                   most);
  bw_stale *stale = BW_NEW0(context, bw_stale, 1);
  if (!stale)
    return BW_MEMORY;
  stale->symmetric = symmetric;
  stale->components = components;
  stale->first = FIRST_GUESS;
  stale->first_flipped = FIRST_GUESS_FLIPPED;
  if (symmetric)
    BW_TRY(bwi_stale_symmetric_create(context, components, &stale->cholesky));
  else
    BW_TRY(bwi_stale_unsymmetric_create(context, components, &stale->lu));
  if (!symmetric)
    BW_TRY(bwi_stale_blocks_create(context, components, &stale->blocks));
done:
  if (status == BW_OK)
    *out = stale;
  else
    bw_stale_free(stale);
  return status;
}

/* Orders, analyses, numbers. */
static void forget_kept(bw_stale *stale) {
  if (stale->cholesky)
    bwi_stale_symmetric_forget(stale->cholesky);
  if (stale->lu)
    bwi_stale_unsymmetric_forget(stale->lu);
  if (stale->blocks)
    bwi_stale_blocks_forget(stale->blocks);
}

static void forget_factor(bw_stale *stale) {
  bw_release(stale->topology);
  bw_release(stale->last_topology);
  stale->topology = stale->last_topology = NULL;
  stale->solves = stale->last = 0;
  stale->spent = 0;
}

void bw_stale_forget(bw_stale *stale) {
  forget_kept(stale);
  forget_factor(stale);
  stale->pivoting = false;
  stale->first = FIRST_GUESS;
  stale->first_flipped = FIRST_GUESS_FLIPPED;
  bw_free(stale->room);
  stale->room = NULL;
  stale->size = 0;
}

void bw_stale_free(bw_stale *stale) {
  if (!stale)
    return;
  bw_stale_forget(stale);
  bwi_stale_symmetric_free(stale->cholesky);
  bwi_stale_unsymmetric_free(stale->lu);
  bwi_stale_blocks_free(stale->blocks);
  bw_free(stale);
}

bw_status bw_stale_apply(bw_context *context, bw_stale *stale, const double *r, double *z) {
  if (!stale->symmetric && !stale->pivoting && stale->topology) {
    bwi_stale_blocks_apply(stale->blocks, r, z);
    return BW_OK;
  }
  return stale->symmetric ? bwi_stale_symmetric_apply(context, stale->cholesky, false, r, z)
                          : bwi_stale_unsymmetric_apply(context, stale->lu, r, z);
}

/* ---- the model's costs --------------------------------------------------------------------- */

/* An old Cholesky factor is read twice in single precision, a new one twice in double and in
 * another order than it lies in; UMFPACK's once for each of two solves. */
static double iteration_seconds(const bw_stale *stale, const bw_plane_graph *graph, bool old) {
  double square = stale->components * stale->components;
  double matrix = (8 * square + 4) * (double)graph->pair_count;
  double vectors = 12 * 8.0 * (double)graph->node_count * stale->components;
  double factor = stale->symmetric && !old ? 4 * stale->work.bytes : stale->work.bytes;
  return (stale->symmetric ? 1 : 2) * (factor + matrix + vectors) / BYTES_PER_SECOND;
}

/* Copying a Cholesky factor to single precision, before it is first used as an old one. */
static double copy_seconds(const bw_stale *stale) {
  return stale->symmetric && stale->solves == 0 ? 1.5 * stale->work.bytes / FACTOR_BYTES_PER_SECOND
                                                : 0;
}

/* With the analysis made anew where the topology is another than the factor's. */
static double factor_seconds(const bw_stale *stale, const bw_plane_graph *graph, bool analysis) {
  double seconds = stale->symmetric ? stale->work.flops / FLOPS_PER_SECOND +
                                          2 * stale->work.bytes / FACTOR_BYTES_PER_SECOND
                   : !stale->pivoting ? stale->work.flops / BLOCKS_FLOPS_PER_SECOND
                                      : stale->work.flops / UMFPACK_FLOPS_PER_SECOND +
                                            4 * stale->work.bytes / FACTOR_BYTES_PER_SECOND;
  return seconds + (analysis ? ANALYSIS_SECONDS * graph->node_count : 0);
}

/* Iterations that the next solve with the factor as it is should take. Meshes move on, the error
 * of the factor grows about in proportion to the number of moves, and iterations with it. */
static double expected_iterations(const bw_stale *stale, const bw_plane_graph *graph) {
  if (stale->last_topology != graph->topology)
    return stale->first_flipped;
  if (stale->solves > 0)
    return stale->last * (1 + 1.0 / stale->solves);
  return stale->first;
}

/* ---- factoring ----------------------------------------------------------------------------- */

static bw_status factor(bw_context *context, bw_stale *stale, const bw_plane_graph *graph,
                        const double *values, bw_stale_method method, bw_kept *kept) {
  double start = bw_seconds();
  bwi_stale_work work = {0};
  bw_status status = BW_OK;
  if (method == BW_STALE_SCRATCH)
    forget_kept(stale);
  forget_factor(stale);
  if (stale->symmetric)
    status = bwi_stale_symmetric_factor(context, stale->cholesky, graph, values, &work);
  else {
    if (!stale->pivoting) {
      bool done = false;
      status = bwi_stale_blocks_factor(context, stale->blocks, graph, values, &done, &work);
      stale->pivoting = status == BW_OK && !done;
    }
    if (stale->pivoting)
      status = bwi_stale_unsymmetric_factor(context, stale->lu, graph, values, &work);
  }
  kept->analyses += work.analysed;
  kept->factorisations++;
  kept->factor = false;
  kept->seconds_factor += bw_seconds() - start;
  if (status != BW_OK)
    return status;
  stale->topology = bw_retain(graph->topology);
  stale->work = work;
  stale->spent = factor_seconds(stale, graph, work.analysed) +
                 (work.reordered ? ORDER_SECONDS * graph->node_count : 0);
  return BW_OK;
}

/* ---- iterating ----------------------------------------------------------------------------- */

typedef struct iteration {
  bw_context *context;
  bw_stale *stale;
  const bw_plane_graph *graph;
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
  return bw_plane_multiply(it->context, it->graph, it->stale->components, it->values, x, y);
}

/* r = b - A x, and its relative size */
static bw_status true_residual(iteration *it, double *r) {
  if (it->zero && it->count == 0) {
    memcpy(r, it->rhs, it->stale->size * sizeof *r);
    it->residual = 1;
    return BW_OK;
  }
  it->zero = false;
  bw_status status = multiply(it, it->x, r);
  if (status == BW_OK)
    status = bwi_subtract_from(it->context, it->stale->size, it->rhs, r, &it->residual);
  it->residual = sqrt(it->residual) / it->size;
  return status;
}

/* Conjugate gradients from x, for at most `limit` iterations; ends early on a breakdown. */
static bw_status conjugate_gradients(iteration *it, int limit) {
  bw_status status = BW_OK;
  bw_context *context = it->context;
  size_t n = it->stale->size;
  double *r = it->stale->room + n, *z = r + n, *p = z + n, *q = p + n;
  double rho = 0;
  BW_TRY(true_residual(it, r));
  for (int i = 0; i < limit && it->residual > it->tolerance; i++) {
    double next, curvature, square;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_stale_symmetric_apply(context, it->stale->cholesky, it->old, r, z));
    BW_TRY(bwi_dot(context, n, r, z, &next));
    BW_TRY(bwi_add_scaled(context, n, i ? next / rho : 0, z, p));
    rho = next;
    BW_TRY(multiply(it, p, q));
    BW_TRY(bwi_dot(context, n, p, q, &curvature));
    it->count++;
    if (!(rho > 0) || !(curvature > 0) || !isfinite(rho / curvature))
      break; /* the factor is too old, or the matrix not positive definite */
    BW_TRY(bwi_step(context, n, rho / curvature, p, q, it->x, r, &square));
    it->residual = sqrt(square) / it->size;
    if (!isfinite(it->residual))
      break;
  }
  /* The recurrence and the truth part slowly: what is reported is the truth. */
  if (it->count > 0)
    BW_TRY(true_residual(it, r));
done:
  return status;
}

/* BiCGSTAB with the factor on the right, so that the residual is the true one. An iteration is two
 * products and two solves. */
static bw_status stabilised(iteration *it, int limit) {
  bw_status status = BW_OK;
  bw_context *context = it->context;
  size_t n = it->stale->size;
  double *r = it->stale->room + n, *shadow = r + n, *p = shadow + n, *v = p + n, *t = v + n,
         *y = t + n, *z = y + n;
  double rho = 1, alpha = 1, omega = 1;
  BW_TRY(true_residual(it, r));
  memcpy(shadow, r, n * sizeof *r);
  memset(p, 0, n * sizeof *p);
  memset(v, 0, n * sizeof *v);
  for (int i = 0; i < limit && it->residual > it->tolerance; i++) {
    double next, dot, square, ts;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_dot(context, n, shadow, r, &next));
    double beta = i ? next / rho * (alpha / omega) : 0;
    if (next == 0 || !isfinite(beta))
      break;
    rho = next;
    BW_TRY(bwi_direction(context, n, beta, omega, r, v, p));
    BW_TRY(bw_stale_apply(context, it->stale, p, y));
    BW_TRY(multiply(it, y, v));
    BW_TRY(bwi_dot(context, n, shadow, v, &dot));
    it->count++;
    alpha = rho / dot;
    if (!isfinite(alpha))
      break;
    BW_TRY(bwi_step(context, n, alpha, y, v, it->x, r, &square));
    it->residual = sqrt(square) / it->size;
    if (it->residual <= it->tolerance || !isfinite(it->residual))
      break;
    BW_TRY(bw_stale_apply(context, it->stale, r, z));
    BW_TRY(multiply(it, z, t));
    BW_TRY(bwi_dot(context, n, t, t, &square));
    BW_TRY(bwi_dot(context, n, t, r, &ts));
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

static bw_status iterate(iteration *it, int limit, bw_kept *kept) {
  double start = bw_seconds();
  it->count = 0;
  bw_status status = it->stale->symmetric ? conjugate_gradients(it, limit) : stabilised(it, limit);
  kept->iterations += it->count;
  kept->seconds_solve += bw_seconds() - start;
  return status;
}

/* ---- a solve ------------------------------------------------------------------------------- */

static bw_status prepare(bw_context *context, bw_stale *stale, const bw_plane_graph *graph) {
  size_t n = (size_t)graph->node_count * (size_t)stale->components;
  if (stale->room && stale->size == n)
    return BW_OK;
  double *room =
      BW_NEW(context, double, n *(stale->symmetric ? SYMMETRIC_VECTORS : UNSYMMETRIC_VECTORS));
  if (!room)
    return BW_MEMORY;
  bw_free(stale->room);
  stale->room = room;
  stale->size = n;
  return BW_OK;
}

bw_status bw_stale_solve(bw_context *context, bw_stale *stale, const bw_plane_graph *graph,
                         const double *values, const double *rhs, double *x,
                         const bw_stale_options *options, bw_kept *kept) {
  bw_status status = BW_OK;
  bw_stale_options defaults;
  bw_kept ignored = {0};
  double square;
  bw_stale_options_default(&defaults);
  options = options ? options : &defaults;
  kept = kept ? kept : &ignored;
  if (!(options->tolerance > 0) || options->iterations < 1)
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g and %d iterations; both have to be positive",
                   options->tolerance, options->iterations);
  BW_TRY(prepare(context, stale, graph));
  size_t n = stale->size;
  iteration it = {.context = context,
                  .stale = stale,
                  .graph = graph,
                  .values = values,
                  .rhs = rhs,
                  .x = stale->room,
                  .tolerance = options->tolerance};
  kept->solves++;
  BW_TRY(bwi_dot(context, n, rhs, rhs, &square));
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
  BW_TRY(bwi_dot(context, n, x, x, &square));
  it.zero = !(square > 0 && isfinite(square));
  if (it.zero)
    memset(it.x, 0, n * sizeof *x);

  bool fits = stale->topology && stale->topology->nodes == graph->topology->nodes;
  bool flipped = fits && stale->topology != graph->topology;
  bool fresh = !fits || options->method == BW_STALE_REFACTOR || options->method == BW_STALE_SCRATCH;
  int limit = options->iterations;
  double one = 0, old = 0, anew = 0;
  if (fits) {
    one = iteration_seconds(stale, graph, true);
    anew = factor_seconds(stale, graph, flipped) + iteration_seconds(stale, graph, false);
    old = copy_seconds(stale) + expected_iterations(stale, graph) * one;
    kept->predicted_iterate += old;
    kept->predicted_factor += anew;
  }
  if (!fresh && options->method == BW_STALE_AUTO) {
    double average = stale->spent / (stale->solves + 1); /* the first was with the factor new */
    double worth = average < anew ? average : anew;
    fresh = old > worth;
    if (fresh && stale->last_topology != graph->topology)
      stale->first_flipped *= FORGETTING;
    else if (fresh && stale->solves == 0)
      stale->first *= FORGETTING;
    /* No more than a new factor would have cost. */
    limit = (int)fmin(limit, 2 + anew / one);
  }
  if (!fresh) {
    kept->factor = true;
    it.old = true;
    BW_TRY(iterate(&it, limit, kept));
    it.old = false;
    stale->spent += copy_seconds(stale) + it.count * one;
    stale->solves++;
    stale->last = it.count;
    if (stale->last_topology != graph->topology)
      stale->first_flipped = it.count > 0 ? it.count : 1;
    else if (stale->solves == 1)
      stale->first = it.count > 0 ? it.count : 1;
    fresh = !(it.residual <= it.tolerance);
    if (fresh && !isfinite(it.residual))
      memcpy(it.x, x, n * sizeof *x);
  }
  if (fresh) {
    if (!fits)
      stale->pivoting = false;
    BW_TRY(factor(context, stale, graph, values, options->method, kept));
    bool blocks = !stale->symmetric && !stale->pivoting;
    BW_TRY(
        iterate(&it, blocks && options->iterations > ENOUGH ? ENOUGH : options->iterations, kept));
    if (blocks && !(it.residual <= it.tolerance)) {
      stale->pivoting = true;
      if (!isfinite(it.residual))
        memcpy(it.x, x, n * sizeof *x);
      BW_TRY(factor(context, stale, graph, values, options->method, kept));
      BW_TRY(iterate(&it, options->iterations, kept));
    }
    stale->spent += it.count * iteration_seconds(stale, graph, false);
  }
  if (!(it.residual <= kept->residual))
    kept->residual = it.residual;
  if (!(it.residual <= it.tolerance)) {
    status =
        bw_fail(context, BW_CONVERGENCE,
                "the solution of %zu equations stopped at a relative residual of %.3g after %d "
                "iterations on a new factor; %.3g was wanted: the matrix is close to singular",
                n, it.residual, it.count, it.tolerance);
    bw_detail_number(context, "residual", it.residual);
    bw_detail_number(context, "iterations", it.count);
    goto done;
  }
  memcpy(x, it.x, n * sizeof *x);
  bw_retain(graph->topology);
  bw_release(stale->last_topology);
  stale->last_topology = graph->topology;
done:
  return status;
}
