/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs by ARPACK-ng: the implicitly restarted Lanczos method (Sorensen 1992) in
 * shift-invert mode with shift 0, one vector at a time.
 *
 * Three things are arranged around it.
 *
 * ARPACK keeps the state of a run in static variables. Runs of a process are therefore one at a
 * time: others wait, and can be cancelled while they do.
 *
 * ARPACK takes random vectors from a generator of its own, whose state outlives a run. It forces
 * each of them into the range of Op before use (ido = -1), and there gets Op of a vector of ours:
 * the same seed gives the same bits, whatever ran before.
 *
 * A Krylov space of one start vector has one vector of each eigenspace, but for rounding. Missing
 * partners are found by further runs on Op - X X^T M Op, with X the pairs found. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <arpack/arpack.h>

#include "eigen/iteration.h"
#include "linear/multivector.h"

enum { RESTARTS = 300, DIRECTION = -1, OPERATOR = 1, PRODUCT = 2 };

typedef struct arpack {
  bwi_eigen_iteration base;
  int basis;
  int found;      /* pairs that have converged */
  int capacity;   /* of x, mx */
  double *x, *mx; /* capacity x size: the pairs found, M times them */
} arpack;

static void arpack_close(bwi_eigen_iteration *iteration) {
  arpack *a = (arpack *)iteration;
  bw_free(a->base.value);
  bw_free(a->x);
  bw_free(a->mx);
  bw_free(a);
}

static bw_status arpack_open(bw_context *context, const bwi_eigen_problem *problem,
                             const bwi_eigen_setup *setup, bwi_eigen_iteration **out) {
  int64_t basis = setup->basis > 0 ? setup->basis : 2 * (int64_t)setup->count + 20;
  if (problem->size > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "ARPACK: %lld numbers in a field are more than it can count",
                   (long long)problem->size);
  if (basis * (basis + 8) > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d modes: more than ARPACK can compute", setup->count);
  arpack *a = BW_NEW0(context, arpack, 1);
  if (!a)
    return BW_MEMORY;
  a->base.most = INT32_MAX;
  a->basis = (int)basis;
  a->base.bytes = 8.0 * (double)problem->size * (a->basis + 2 * setup->count + 6);
  *out = &a->base;
  return BW_OK;
}

/* ---- one run at a time ----------------------------------------------------------------------- */

static pthread_mutex_t running = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local bool runs_here; /* in this thread, further out */

static bw_status enter(bw_context *context) {
  if (runs_here)
    return bw_fail(context, BW_UNSUPPORTED,
                   "ARPACK runs in this thread already, and its state is one for the process: "
                   "use the block Lanczos method in functions that are called meanwhile");
  const struct timespec pause = {.tv_nsec = 2000000};
  while (pthread_mutex_trylock(&running) == EBUSY) {
    bw_status status = bw_check_cancel(context);
    if (status != BW_OK)
      return status;
    nanosleep(&pause, NULL);
  }
  runs_here = true;
  return BW_OK;
}

static void leave(void) {
  runs_here = false;
  pthread_mutex_unlock(&running);
}

/* ---- a run ----------------------------------------------------------------------------------- */

typedef struct run {
  arpack *iteration;
  int size, wanted, basis; /* ARPACK's n, nev, ncv */
  double tolerance;
  double *v;                 /* basis x size */
  double *residual;          /* size */
  double *work;              /* 3 x size */
  double *space;             /* `length` numbers */
  double *product, *start;   /* size each */
  double *value, *projected; /* basis each */
  int *select;               /* basis */
  int starts;                /* random vectors taken */
  int length, parameter[11], pointer[14], info;
} run;

static void run_clear(run *r) {
  bw_free(r->v);
  bw_free(r->residual);
  bw_free(r->work);
  bw_free(r->space);
  bw_free(r->product);
  bw_free(r->start);
  bw_free(r->value);
  bw_free(r->projected);
  bw_free(r->select);
}

/* ARPACK's basis must fit into the space that is left. */
static int basis_left(const arpack *a) {
  int64_t left = a->base.problem->dimension - a->found;
  return left < a->basis ? (int)left : a->basis;
}

static bw_status run_open(arpack *a, int wanted, double tolerance, run *r) {
  bw_context *context = a->base.context;
  int64_t size = a->base.size;
  *r = (run){.iteration = a,
             .size = (int)size,
             .basis = basis_left(a),
             .tolerance = tolerance,
             .parameter = {1, 0, RESTARTS, 1, 0, 0, 3}};
  r->wanted = wanted < r->basis ? wanted : r->basis - 1;
  r->length = r->basis * (r->basis + 8);
  r->v = BW_NEW(context, double, r->basis *size);
  r->residual = BW_NEW(context, double, size);
  r->work = BW_NEW0(context, double, 3 * size);
  r->space = BW_NEW0(context, double, r->length);
  r->product = BW_NEW(context, double, size);
  r->start = BW_NEW(context, double, size);
  r->value = BW_NEW0(context, double, r->basis);
  r->projected = BW_NEW0(context, double, r->basis);
  r->select = BW_NEW0(context, int, r->basis);
  return r->v && r->residual && r->work && r->space && r->product && r->start && r->value &&
                 r->projected && r->select
             ? BW_OK
             : BW_MEMORY;
}

/* x -= X X^T M x, twice, since what is left of X would grow */
static bw_status take_off_found(arpack *a, double *x) {
  bw_status status = BW_OK;
  if (a->found == 0)
    return BW_OK;
  double *part = BW_NEW(a->base.context, double, a->found);
  if (!part)
    return BW_MEMORY;
  for (int pass = 0; pass < 2; pass++) {
    BW_TRY(bwi_multi_dot(a->base.context, a->base.size, a->found, a->mx, 1, x, part));
    BW_TRY(bwi_multi_combine(a->base.context, a->base.size, a->found, a->x, 1, part, a->found, -1,
                             1, x));
  }
done:
  bw_free(part);
  return status;
}

/* y = Op x with M x at hand */
static bw_status apply(arpack *a, const double *mx, double *y) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = a->base.problem;
  BW_TRY(problem->solve(a->base.context, problem->data, 1, mx, y));
  a->base.solves++;
  BW_TRY(take_off_found(a, y));
  bw_progress(a->base.context, a->base.stage, a->base.solves / (a->base.solves + 2.0 * a->basis));
  BW_TRY(bw_check_cancel(a->base.context));
done:
  return status;
}

static bw_status iterate_run(run *r) {
  bw_status status = BW_OK;
  arpack *a = r->iteration;
  bw_context *context = a->base.context;
  const bwi_eigen_problem *problem = a->base.problem;
  int ido = 0;
  r->info = 1; /* it begins with `residual`, whose place Op of a vector of ours takes */
  for (int i = 0; i < r->size; i++)
    r->residual[i] = 1;
  for (;;) {
    dsaupd_c(&ido, "G", r->size, "LM", r->wanted, r->tolerance, r->residual, r->basis, r->v,
             r->size, r->parameter, r->pointer, r->work, r->space, r->length, &r->info);
    double *x = r->work + r->pointer[0] - 1, *y = r->work + r->pointer[1] - 1;
    if (ido == DIRECTION) {
      r->starts++;
      BW_TRY(bwi_eigen_random(&a->base, 1, r->start));
      BW_TRY(take_off_found(a, r->start));
      BW_TRY(problem->mass(context, problem->data, 1, r->start, r->product));
      BW_TRY(apply(a, r->product, y));
    } else if (ido == OPERATOR)
      BW_TRY(apply(a, r->work + r->pointer[2] - 1, y));
    else if (ido == PRODUCT)
      BW_TRY(problem->mass(context, problem->data, 1, x, y));
    else
      break;
  }
  a->base.iterations += r->parameter[2];
done:
  return status;
}

static int descending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? 1 : x > y ? -1 : 0;
}

/* Values and vectors of the pairs that have converged, in `value` and `v`; the Ritz values of the
 * whole basis, descending, in `projected`. */
static bw_status extract(run *r) {
  bw_context *context = r->iteration->base.context;
  if (r->info != 0 && r->info != 1)
    return bw_fail(context, BW_INTERNAL, "ARPACK's dsaupd failed (%d)", r->info);
  if (r->info == 1 || r->parameter[4] < r->wanted)
    return bwi_eigen_stopped(&r->iteration->base, r->iteration->found + r->parameter[4],
                             r->iteration->found + r->wanted, r->tolerance);
  memcpy(r->projected, r->space + r->pointer[5] - 1, (size_t)r->basis * sizeof *r->projected);
  qsort(r->projected, (size_t)r->basis, sizeof *r->projected, descending);
  dseupd_c(1, "A", r->select, r->value, r->v, r->size, 0, "G", r->size, "LM", r->wanted,
           r->tolerance, r->residual, r->basis, r->v, r->size, r->parameter, r->pointer, r->work,
           r->space, r->length, &r->info);
  if (r->info != 0)
    return bw_fail(context, BW_INTERNAL, "ARPACK's dseupd failed (%d)", r->info);
  return BW_OK;
}

/* Where the Krylov space closed, ARPACK went on from another random vector and took its coupling to
 * what was there for zero. Rounding leaves 1e-10 of it, which the Ritz values lack and Rayleigh
 * quotients of Op have. */
static bw_status improve_values(run *r) {
  bw_status status = BW_OK;
  arpack *a = r->iteration;
  const bwi_eigen_problem *problem = a->base.problem;
  for (int k = 0; k < r->parameter[4] && r->starts > 1; k++) {
    double theta;
    const double *x = r->v + k * a->base.size;
    BW_TRY(problem->mass(a->base.context, problem->data, 1, x, r->product));
    BW_TRY(apply(a, r->product, r->start));
    BW_TRY(bwi_multi_dot(a->base.context, a->base.size, 1, r->product, 1, r->start, &theta));
    if (theta > 0)
      r->value[k] = 1 / theta;
  }
done:
  return status;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static bw_status reserve(arpack *a, int capacity) {
  if (capacity <= a->capacity)
    return BW_OK;
  bw_context *context = a->base.context;
  size_t kept = (size_t)a->found * (size_t)a->base.size * sizeof(double);
  double *x = BW_NEW(context, double, capacity * a->base.size);
  double *mx = BW_NEW(context, double, capacity * a->base.size);
  double *value = BW_NEW(context, double, capacity + a->basis);
  if (!x || !mx || !value) {
    bw_free(x);
    bw_free(mx);
    bw_free(value);
    return BW_MEMORY;
  }
  if (a->found > 0) {
    memcpy(x, a->x, kept);
    memcpy(mx, a->mx, kept);
    memcpy(value, a->base.value, (size_t)a->found * sizeof *value);
  }
  bw_free(a->x);
  bw_free(a->mx);
  bw_free(a->base.value);
  a->x = x;
  a->mx = mx;
  a->base.value = value;
  a->capacity = capacity;
  return BW_OK;
}

/* Put a pair in its place among those found. There is capacity for it. */
static bw_status insert(arpack *a, double value, const double *vector) {
  const bwi_eigen_problem *problem = a->base.problem;
  int place = a->found;
  int64_t size = a->base.size;
  while (place > 0 && a->base.value[place - 1] > value)
    place--;
  size_t behind = (size_t)(a->found - place), bytes = (size_t)size * sizeof(double);
  memmove(a->base.value + place + 1, a->base.value + place, behind * sizeof(double));
  memmove(a->x + (place + 1) * size, a->x + place * size, behind * bytes);
  memmove(a->mx + (place + 1) * size, a->mx + place * size, behind * bytes);
  a->base.value[place] = value;
  memcpy(a->x + place * size, vector, bytes);
  a->found++;
  return problem->mass(a->base.context, problem->data, 1, vector, a->mx + place * size);
}

static bw_status find_pairs(arpack *a, int wanted, double tolerance) {
  bw_status status = BW_OK;
  bwi_eigen_iteration *base = &a->base;
  run r = {0};
  BW_TRY(run_open(a, wanted, tolerance, &r));
  BW_TRY(iterate_run(&r));
  BW_TRY(extract(&r));
  BW_TRY(improve_values(&r));
  int count = r.parameter[4];
  BW_TRY(reserve(a, a->found + count));
  for (int k = 0; k < count; k++)
    BW_TRY(insert(a, r.value[k], r.v + k * base->size));
  base->known = a->found;
  for (int k = count; k < r.basis && r.projected[k] > 0; k++)
    if (1 / r.projected[k] > base->value[a->found - 1])
      base->value[base->known++] = 1 / r.projected[k];
done:
  run_clear(&r);
  return status;
}

static bw_status arpack_iterate(bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  arpack *a = (arpack *)iteration;
  bw_status status = enter(iteration->context);
  if (status != BW_OK)
    return status;
  while (status == BW_OK && a->found < wanted && basis_left(a) > 1)
    status = find_pairs(a, wanted - a->found, tolerance);
  leave();
  return status;
}

static int arpack_converged(const bwi_eigen_iteration *iteration, int wanted, double tolerance) {
  (void)tolerance;
  int found = ((const arpack *)iteration)->found;
  return found < wanted ? found : wanted;
}

static bw_status arpack_deflate(bwi_eigen_iteration *iteration, int keep) {
  arpack *a = (arpack *)iteration;
  a->found = iteration->known = keep < a->found ? keep : a->found;
  return BW_OK;
}

static bw_status arpack_vectors(const bwi_eigen_iteration *iteration, int count, double *x) {
  const arpack *a = (const arpack *)iteration;
  memcpy(x, a->x, (size_t)count * (size_t)iteration->size * sizeof *x);
  return BW_OK;
}

const bwi_eigen_method *bwi_eigen_arpack(void) {
  static const bwi_eigen_method method = {"arpack",         arpack_open,    arpack_iterate,
                                          arpack_converged, arpack_deflate, arpack_vectors,
                                          arpack_close};
  return &method;
}
