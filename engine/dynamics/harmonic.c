/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Harmonic response by modes and residual vectors (docs/theory/dynamics.md). With s = 1 + i h + i w
 * b and m = w^2 - i w a the equations without the modes' part are (s 1 - m K^-1 M) u = K^-1 f.
 * Lanczos's method on K^-1 M, in the inner product of K, solves them for all frequencies with one
 * basis, and knows the residual of each without a product. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/dynamics.h"
#include "dynamics/harmonic_regions.h"
#include "dynamics/internal.h"
#include "dynamics/shifted.h"
#include "joint/fields.h"
#include "linear/blas.h"
#include "linear/internal.h"
#include "linear/multivector.h"
#include "model/internal.h"

enum {
  MOST_VECTORS = 400,
  FIRST_MODES = 16,
  EVENLY = 200, /* frequencies of a range, beside those at peaks */
  MOST_FREQUENCIES = 1000000,
  MOST_MODES = 2000 /* that are computed because a range needs them */
};

static const double pi = 3.14159265358979323846;
/* All modes to this multiple of the highest frequency are in the basis. */
static const double beyond = 1.5;
/* A remainder of a vector below this part of it is rounding. */
static const double rounding = 1e-12;

void bw_harmonic_options_default(bw_harmonic_options *options) {
  *options = (bw_harmonic_options){.vectors = 40, .tolerance = 1e-8};
}

static void harmonic_destroy(void *object) {
  bw_harmonic *harmonic = object;
  bw_release(harmonic->model);
  bw_release(harmonic->modes);
  bw_free(harmonic->frequency);
  bw_free(harmonic->error);
  bw_free(harmonic->eigenvalue);
  bw_free(harmonic->load);
  bw_free(harmonic->tail);
  bw_free(harmonic->residual);
  bw_free(harmonic->loss);
  bw_free(harmonic->point);
  bw_free(harmonic->motion);
  bwi_coupling_destroy(harmonic->coupling);
  bw_free(harmonic);
}

static size_t harmonic_bytes(const void *object) {
  const bw_harmonic *h = object;
  size_t vectors = (size_t)(h->count - h->modes->count);
  return sizeof *h + bw_bytes(h->modes) + (h->coupling ? bwi_coupling_bytes(h->coupling) : 0) +
         (vectors * 3 * (size_t)h->model->mesh->node_count + 4 * (size_t)h->count +
          (6 * (size_t)h->count + 3) * (size_t)h->coupling_count + 2 * (size_t)h->frequency_count) *
             sizeof(double);
}

static const bw_kind harmonic_kind = {"harmonic", harmonic_destroy, harmonic_bytes};

/* ---- the coordinates ------------------------------------------------------------------------- */

typedef struct number {
  double re, im;
} number;

/* The stiffness's factor s and the mass's factor m of the equations s K - m M. */
static void factors(const bw_damping *damping, double omega, number *s, number *m) {
  *s = (number){1, damping->loss + omega * damping->stiffness};
  *m = (number){omega * omega, -omega * damping->mass};
}

/* The least of |s - m t| for t from 0 to `last`. */
static double distance(number s, number m, double last) {
  double square = m.re * m.re + m.im * m.im;
  double t = square > 0 ? (s.re * m.re + s.im * m.im) / square : 0;
  t = fmin(fmax(t, 0), last);
  return hypot(s.re - m.re * t, s.im - m.im * t);
}

bw_status bw_harmonic_coordinates(bw_context *context, const bw_harmonic *h, double frequency,
                                  double *coordinate, double *error) {
  double omega = 2 * pi * frequency, energy = 0;
  number s, m, tail = {0};
  if (!(frequency >= 0 && frequency < INFINITY))
    return bw_fail(context, BW_INVALID, "the frequency is %g Hz; it must be 0 or more, and finite",
                   frequency);
  double highest = h->frequency[h->frequency_count - 1];
  if (frequency > highest * (1 + 1e-12))
    return bw_fail(
        context, BW_INVALID,
        "the harmonic response is known to %g Hz, and %g Hz was asked for: make it with a "
        "larger range",
        highest, frequency);
  if (h->coupling)
    return bwi_coupling_coordinates(context, h, omega, coordinate, error);
  factors(&h->damping, omega, &s, &m);
  for (int k = 0; k < h->count; k++) {
    double lambda = h->eigenvalue[k], ratio = k < h->modes->count ? h->damping.ratio : 0;
    number d = {s.re * lambda - m.re,
                s.im * lambda - m.im + 2 * ratio * omega * sqrt(fmax(lambda, 0))};
    double square = d.re * d.re + d.im * d.im, *q = coordinate + 2 * (size_t)k;
    q[0] = q[1] = 0;
    if (h->load[k] == 0)
      continue;
    if (!(sqrt(square) > rounding * lambda))
      return bw_fail(context, BW_SINGULAR,
                     "%g Hz is the frequency of %s %d, which nothing damps: its response has no "
                     "limit. %s",
                     frequency, k < h->modes->count ? "mode" : "residual vector",
                     k < h->modes->count ? k + 1 : k - h->modes->count + 1,
                     k < h->modes->count ? "Give a damping" : "Take more modes");
    q[0] = h->load[k] * d.re / square;
    q[1] = -h->load[k] * d.im / square;
    energy += lambda * (q[0] * q[0] + q[1] * q[1]);
    tail.re += h->tail[k] * q[0];
    tail.im += h->tail[k] * q[1];
  }
  if (error) {
    double residual = h->remainder + hypot(m.re, m.im) * hypot(tail.re, tail.im);
    *error = residual > 0 ? residual / (distance(s, m, h->bound) * sqrt(energy)) : 0;
  }
  return BW_OK;
}

/* ---- residual vectors ------------------------------------------------------------------------ */

/* Lanczos's basis: K-orthonormal vectors and their products with K. */
typedef struct basis {
  int count, capacity;
  double *vector, *product;   /* capacity x size */
  double *alpha, *beta;       /* of the tridiagonal matrix, beta[k] behind alpha[k] */
  double first;               /* K-norm of the first vector before it was scaled */
  double *theta, *w, *work;   /* its eigenvalues, vectors (MOST x MOST) and work space */
  const double *shape;        /* the modes' */
  double *mass_shape, *along; /* M times these; inner products */
} basis;

static void basis_clear(basis *b) {
  bw_free(b->vector);
  bw_free(b->product);
  bw_free(b->alpha);
  bw_free(b->beta);
  bw_free(b->theta);
  bw_free(b->w);
  bw_free(b->work);
  bw_free(b->mass_shape);
  bw_free(b->along);
}

static bw_status basis_open(bw_context *context, const bwi_equations *equations,
                            const bw_modes *modes, int vectors, basis *b) {
  bw_status status = BW_OK;
  int64_t size = equations->size;
  b->shape = modes->shape;
  b->mass_shape = BW_NEW(context, double, modes->count *size);
  b->along = BW_NEW(context, double, modes->count + vectors + 1);
  b->alpha = BW_NEW0(context, double, vectors + 1);
  b->beta = BW_NEW0(context, double, vectors + 1);
  b->theta = BW_NEW0(context, double, vectors + 1);
  b->w = BW_NEW0(context, double, (int64_t)vectors *vectors + 1);
  b->work = BW_NEW0(context, double, 4 * vectors + 64);
  BW_TRY_MEMORY(b->mass_shape && b->along && b->alpha && b->beta && b->theta && b->w && b->work);
  for (int k = 0; k < modes->count; k++)
    BW_TRY(
        bwi_equations_mass(context, equations, modes->shape + k * size, b->mass_shape + k * size));
done:
  return status;
}

static bw_status basis_grow(bw_context *context, int64_t size, basis *b) {
  bw_status status = BW_OK;
  int capacity = b->capacity ? 2 * b->capacity : 8;
  double *vector = BW_NEW(context, double, capacity *size), *product = NULL;
  BW_TRY_MEMORY(vector);
  product = BW_NEW(context, double, capacity *size);
  BW_TRY_MEMORY(product);
  if (b->count > 0) {
    memcpy(vector, b->vector, (size_t)(b->count * size) * sizeof *vector);
    memcpy(product, b->product, (size_t)(b->count * size) * sizeof *product);
  }
  bw_free(b->vector);
  bw_free(b->product);
  b->vector = vector;
  b->product = product;
  b->capacity = capacity;
  vector = product = NULL;
done:
  bw_free(vector);
  bw_free(product);
  return status;
}

/* x becomes orthogonal to the modes and the basis, twice as it must be; x is behind the basis. */
static bw_status orthogonalise(bw_context *context, int64_t size, int modes, basis *b, double *x) {
  bw_status status = BW_OK;
  for (int pass = 0; pass < 2; pass++) {
    if (modes > 0) {
      BW_TRY(bwi_multi_dot(context, size, modes, b->mass_shape, 1, x, b->along));
      BW_TRY(bwi_multi_combine(context, size, modes, b->shape, 1, b->along, modes, -1, 1, x));
    }
    if (b->count > 0) {
      BW_TRY(bwi_multi_dot(context, size, b->count, b->product, 1, x, b->along));
      BW_TRY(
          bwi_multi_combine(context, size, b->count, b->vector, 1, b->along, b->count, -1, 1, x));
    }
  }
done:
  return status;
}

/* The next vector K^-1 f of the basis: its K-norm in *norm, which is 0 where only rounding of a
 * vector of the K-norm `before` is left; it is kept otherwise. */
static bw_status take_vector(bw_context *context, const bwi_equations *equations, int modes,
                             const double *f, basis *b, double *norm) {
  bw_status status = BW_OK;
  int64_t size = equations->size;
  double square, before;
  if (b->count == b->capacity)
    BW_TRY(basis_grow(context, size, b));
  double *x = b->vector + b->count * size, *y = b->product + b->count * size;
  BW_TRY(bwi_equations_solve(context, equations, f, x));
  BW_TRY(bwi_multi_dot(context, size, 1, x, 1, f, &before));
  BW_TRY(orthogonalise(context, size, modes, b, x));
  BW_TRY(bwi_equations_stiffness(context, equations, x, y));
  BW_TRY(bwi_multi_dot(context, size, 1, x, 1, y, &square));
  *norm = square > rounding * rounding * before ? sqrt(square) : 0;
  if (*norm == 0)
    goto done;
  for (int64_t i = 0; i < size; i++) {
    x[i] /= *norm;
    y[i] /= *norm;
  }
  b->count++;
done:
  return status;
}

/* Eigenpairs of the tridiagonal matrix of the first n vectors, and what the response needs. */
static bw_status take_pairs(bw_context *context, basis *b, int n, bw_harmonic *h) {
  int info = 0, length = 4 * n + 64, modes = h->modes->count;
  memset(b->w, 0, (size_t)n * (size_t)n * sizeof *b->w);
  for (int k = 0; k < n; k++) {
    b->w[k * n + k] = b->alpha[k];
    if (k + 1 < n)
      b->w[k * n + k + 1] = b->beta[k];
  }
  dsyev_("V", "L", &n, b->w, &n, b->theta, b->work, &length, &info);
  if (info != 0)
    return bw_fail(context, BW_INTERNAL, "dsyev failed on %d residual vectors (%d)", n, info);
  h->count = modes;
  for (int k = 0; k < n; k++) {
    if (!(b->theta[k] > 0))
      continue; /* rounding of a mass that the vectors hardly have: it moves nothing */
    const double *w = b->w + (size_t)k * (size_t)n;
    int at = h->count++;
    h->eigenvalue[at] = 1 / b->theta[k];
    h->load[at] = b->first * w[0] / sqrt(b->theta[k]);
    h->tail[at] = b->beta[n - 1] * w[n - 1] / sqrt(b->theta[k]);
  }
  return BW_OK;
}

static bw_status find_errors(bw_context *context, bw_harmonic *h, double *largest) {
  bw_status status = BW_OK;
  double *coordinate = BW_NEW(context, double, 2 * (h->count > 0 ? h->count : 1));
  BW_TRY_MEMORY(coordinate);
  *largest = 0;
  for (int k = 0; k < h->frequency_count; k++) {
    BW_TRY(bw_harmonic_coordinates(context, h, h->frequency[k], coordinate, &h->error[k]));
    *largest = fmax(*largest, h->error[k]);
  }
done:
  bw_free(coordinate);
  return status;
}

/* Residual vectors in the place of Lanczos's. */
static bw_status make_vectors(bw_context *context, int64_t size, basis *b, int n, bw_harmonic *h) {
  bw_status status = BW_OK;
  int kept = h->count - h->modes->count, skipped = n - kept; /* those skipped are the first */
  if (kept == 0)
    return BW_OK;
  h->residual = BW_NEW(context, double, kept *size);
  BW_TRY_MEMORY(h->residual);
  double *w = b->w + (size_t)skipped * (size_t)n;
  for (int k = 0; k < kept; k++)
    for (int i = 0; i < n; i++)
      w[k * n + i] /= sqrt(b->theta[skipped + k]);
  BW_TRY(bwi_multi_combine(context, size, n, b->vector, kept, w, n, 1, 0, h->residual));
done:
  return status;
}

/* Vectors until the error at all frequencies is below the tolerance. `force` is overwritten. */
static bw_status add_vectors(bw_context *context, const bwi_equations *equations,
                             const bw_harmonic_options *options, double *force, bw_harmonic *h) {
  bw_status status = BW_OK;
  basis b = {0};
  int64_t size = equations->size;
  int modes = h->modes->count, n = 0;
  double norm = 0, error = INFINITY;
  BW_TRY(basis_open(context, equations, h->modes, options->vectors, &b));
  if (modes > 0) {
    BW_TRY(bwi_multi_dot(context, size, modes, h->modes->shape, 1, force, h->load));
    BW_TRY(bwi_multi_combine(context, size, modes, b.mass_shape, 1, h->load, modes, -1, 1, force));
  }
  if (modes < equations->unknown_count) {
    BW_TRY(take_vector(context, equations, modes, force, &b, &norm));
    h->solves++;
  }
  b.first = norm;
  h->remainder = options->vectors > 0 ? 0 : norm;
  while (norm > 0 && n < options->vectors && error > options->tolerance) {
    BW_TRY(bw_check_cancel(context));
    const double *last = b.vector + n * size;
    BW_TRY(bwi_equations_mass(context, equations, last, force));
    BW_TRY(bwi_multi_dot(context, size, 1, last, 1, force, &b.alpha[n]));
    BW_TRY(take_vector(context, equations, modes, force, &b, &norm));
    h->solves++;
    b.beta[n++] = norm;
    BW_TRY(take_pairs(context, &b, n, h));
    BW_TRY(find_errors(context, h, &error));
    bw_progress(context, "residual vectors", (double)n / options->vectors);
  }
  BW_TRY(make_vectors(context, size, &b, n, h));
  if (n == 0)
    BW_TRY(find_errors(context, h, &error));
done:
  basis_clear(&b);
  return status;
}

/* ---- frequencies ----------------------------------------------------------------------------- */

int bwi_compare_numbers(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double bwi_half_width(const bw_harmonic *h, int k) {
  const bw_damping *d = &h->damping;
  double omega = sqrt(h->eigenvalue[k]), ratio = k < h->modes->count ? d->ratio : 0;
  return ratio + (d->mass / omega + d->stiffness * omega + h->loss[k]) / 2;
}

/* Even steps, and around each mode steps of the width of its peak. */
static bw_status choose_frequencies(bw_context *context, const bw_harmonic_options *options,
                                    bw_harmonic *h) {
  static const double step[] = {0, 0.25, 0.5, 1, 1.5, 2, 3, 5, 8, 13, 21};
  enum { STEPS = sizeof step / sizeof *step };
  bw_status status = BW_OK;
  int n = 0, most = EVENLY + 1 + h->modes->count * 2 * STEPS;
  h->frequency = BW_NEW(context, double, most);
  BW_TRY_MEMORY(h->frequency);
  for (int k = 0; k <= EVENLY; k++)
    h->frequency[n++] = options->from + (options->to - options->from) * k / EVENLY;
  for (int i = 0; i < h->modes->count; i++) {
    double f = h->modes->frequency[i], width = bwi_half_width(h, i);
    for (int k = 0; k < 2 * STEPS; k++) {
      double at = f * (1 + (k % 2 ? -1 : 1) * step[k / 2] * width);
      if (at >= options->from && at <= options->to && width > 0)
        h->frequency[n++] = at;
    }
  }
  qsort(h->frequency, (size_t)n, sizeof *h->frequency, bwi_compare_numbers);
  h->frequency_count = 0;
  for (int k = 0; k < n; k++)
    if (k == 0 || h->frequency[k] > h->frequency[h->frequency_count - 1])
      h->frequency[h->frequency_count++] = h->frequency[k];
done:
  return status;
}

static bw_status take_frequencies(bw_context *context, const bw_harmonic_options *options,
                                  bw_harmonic *h) {
  bw_status status = BW_OK;
  if (options->frequency_count == 0)
    BW_TRY(choose_frequencies(context, options, h));
  else {
    h->frequency = BW_NEW(context, double, options->frequency_count);
    BW_TRY_MEMORY(h->frequency);
    h->frequency_count = options->frequency_count;
    memcpy(h->frequency, options->frequency, (size_t)h->frequency_count * sizeof *h->frequency);
    qsort(h->frequency, (size_t)h->frequency_count, sizeof *h->frequency, bwi_compare_numbers);
  }
  h->error = BW_NEW0(context, double, h->frequency_count);
  BW_TRY_MEMORY(h->error);
done:
  return status;
}

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_damping(bw_context *context, const bw_damping *d) {
  const double value[] = {d->ratio, d->mass, d->stiffness, d->loss};
  static const char *const name[] = {"ratio", "mass", "stiffness", "loss"};
  for (int k = 0; k < 4; k++)
    if (!(value[k] >= 0 && value[k] < (k == 0 ? 1 : INFINITY)))
      return bw_fail(context, BW_INVALID, "damping: %s is %g; it must be 0 or more%s", name[k],
                     value[k], k == 0 ? ", and below 1" : "");
  return BW_OK;
}

static bw_status check_options(bw_context *context, const bw_mesh *mesh,
                               const bw_harmonic_options *o, double *highest) {
  bw_status status = BW_OK;
  BW_TRY(check_damping(context, &o->damping));
  if (o->frequency_count < 0 || o->frequency_count > MOST_FREQUENCIES)
    return bw_fail(context, BW_INVALID, "%d frequencies were given: 1 to %d expected",
                   o->frequency_count, MOST_FREQUENCIES);
  *highest = o->frequency_count ? 0 : o->to;
  if (o->frequency_count == 0 && !(o->from >= 0 && o->to > o->from && o->to < INFINITY))
    return bw_fail(context, BW_INVALID,
                   "the frequencies reach from %g to %g Hz; from 0 or more upwards expected",
                   o->from, o->to);
  for (int k = 0; k < o->frequency_count; k++) {
    if (!(o->frequency[k] >= 0 && o->frequency[k] < INFINITY))
      return bw_fail(context, BW_INVALID, "frequency %d is %g Hz; it must be 0 or more, and finite",
                     k + 1, o->frequency[k]);
    *highest = fmax(*highest, o->frequency[k]);
  }
  if (o->region_loss && mesh->region_count == 0)
    return bw_fail(context, BW_INVALID,
                   "the mesh has no regions to which loss factors could be given");
  for (int32_t r = 0; o->region_loss && r < mesh->region_count; r++)
    if (!(o->region_loss[r] >= 0 && o->region_loss[r] < INFINITY))
      return bw_fail(context, BW_INVALID,
                     "the loss factor of region %s is %g; it must be 0 or more, and finite",
                     mesh->regions[r].name.text, o->region_loss[r]);
  if (o->modes < 0)
    return bw_fail(context, BW_INVALID, "%d modes were requested: at least 1 expected", o->modes);
  if (o->vectors < 0 || o->vectors > MOST_VECTORS)
    return bw_fail(context, BW_INVALID, "%d residual vectors were requested: 0 to %d expected",
                   o->vectors, MOST_VECTORS);
  if (!(o->tolerance >= 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance on the response is %g; it must be 0 or more, and below 1",
                   o->tolerance);
  for (int k = 0; k < 3; k++)
    if (!(fabs(o->base[k]) < INFINITY))
      return bw_fail(context, BW_INVALID, "the acceleration of the base must be finite");
  if (o->solver && o->solver->options.kind == BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a harmonic response needs the equations in this process: SLEPc does not serve");
done:
  return status;
}

bw_status bwi_check_held_model(bw_context *context, const bw_model *model, const char *what) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  char *text = NULL;
  for (int k = 0; k < model->load_count; k++)
    if (model->load[k].kind == BW_LOAD_TEMPERATURE)
      BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                     "load %d is a temperature, which %s does not know: leave it out", k + 1,
                     what));
  if (!(model->material->density > 0))
    BW_TRY(bw_fail(context, BW_INVALID, "%s needs a mass: give the material a density", what));
  if (model->cyclic)
    BW_TRY(bw_model_refuse_joints(context, model));
  BW_TRY(bwi_points_refuse_motion(context, model,
                                  "what is held moves by an acceleration of the base alone"));
  BW_TRY(bwi_dof_map_apart(context, model, &dof_map));
  if (dof_map->prescribed)
    BW_TRY(
        bw_fail(context, BW_UNSUPPORTED,
                "a support prescribes a displacement that is not zero: in %s supports move by an "
                "acceleration of the base alone",
                what));
  if (dof_map->rigid_mode_count > 0 && !bw_model_joined(model)) {
    BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
    BW_TRY(bw_fail(context, BW_UNCONSTRAINED,
                   "%s of a body that can move freely is not computed; %s. Add supports that "
                   "constrain it",
                   what, text));
  }
done:
  bw_free(text);
  bw_release(dof_map);
  return status;
}

/* *count: modes below `reach` (Hz); -1 where no factor can say it. */
static bw_status count_modes(bw_context *context, const bw_model *model, bw_system *system,
                             double reach, int64_t *count) {
  bw_status status = BW_OK;
  bwi_equations equations = {0};
  bwi_shifted shifted = {0};
  double omega = 2 * pi * reach;
  bool trusted = false;
  *count = -1;
  if (!bw_model_joined(model) && !(system && system->factor))
    return BW_OK; /* an iterative solver found the first modes */
  BW_TRY(bwi_equations_begin(context, model, bw_model_joined(model) ? NULL : system, &equations));
  BW_TRY(bwi_shifted_open(context, &equations, &shifted));
  BW_TRY(bwi_shifted_below(context, &shifted, omega * omega, count, &trusted));
  if (!trusted)
    *count = -1;
done:
  bwi_shifted_clear(&shifted);
  bwi_equations_clear(&equations);
  return status;
}

bw_status bwi_modes_up_to(bw_context *context, const bw_model *model, bw_system *given,
                          const bw_eigensolver *solver, int count, double reach, bw_system **used,
                          bw_modes **modes) {
  bw_status status = BW_OK;
  bw_modes_options ask;
  double bound;
  int64_t below = -1;
  bw_modes_options_default(&ask);
  ask.count = count ? count : FIRST_MODES;
  ask.solver = solver;
  *used = bw_model_joined(model) ? NULL : bw_retain(given);
  for (;;) {
    bw_system *next = NULL;
    status = bw_model_joined(model) ? bw_joined_modes(context, model, &ask, modes)
                                    : bw_modes_of_model(context, model, *used, &ask, &next, modes);
    if (next) {
      bw_release(*used);
      *used = next;
    }
    BW_TRY(status);
    int n = (*modes)->count;
    if (count || n < ask.count || (*modes)->frequency[n - 1] >= reach)
      break;
    bw_release(*modes);
    *modes = NULL;
    if (ask.count == FIRST_MODES) {
      BW_TRY(bwi_frequency_bound(context, model, &bound));
      if (reach > bound)
        BW_TRY(bw_fail(context, BW_INVALID,
                       "all modes to %g Hz are needed, and this mesh has none above %g Hz: give "
                       "lower frequencies, or a number of modes",
                       reach, bound));
      BW_TRY(count_modes(context, model, *used, reach, &below));
    }
    int64_t wanted = below >= ask.count ? below + 1 : 2 * (int64_t)ask.count;
    if (wanted > MOST_MODES)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "all modes to %g Hz are needed, which are %s%lld, and at most %d are computed "
                     "for a range: give lower frequencies, or a number of modes",
                     reach, below >= ask.count ? "" : "more than ",
                     (long long)(below >= ask.count ? below : ask.count), MOST_MODES));
    ask.count = (int)wanted;
  }
done:
  return status;
}

/* The amplitude of the forces of unknowns, those of the base too. */
static bw_status force_of(bw_context *context, const bw_model *model,
                          const bwi_equations *equations, const double base[3], double *force) {
  bw_status status = BW_OK;
  int64_t size = equations->size;
  double largest = 0, *moved = BW_NEW(context, double, 2 * size);
  BW_TRY_MEMORY(moved);
  BW_TRY(bwi_equations_force(context, model, force));
  for (int64_t i = 0; i < size; i++)
    moved[i] = base[i % 3];
  BW_TRY(bwi_equations_mass(context, equations, moved, moved + size));
  for (int64_t i = 0; i < size; i++)
    force[i] -= moved[size + i];
  BW_TRY(bwi_equations_largest(context, equations, force, &largest));
  if (!(largest > 0))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "nothing excites the body: add a load, or an acceleration of the base"));
done:
  bw_free(moved);
  return status;
}

static bw_status vectors_new(bw_context *context, const bw_harmonic_options *options,
                             bw_harmonic *h) {
  int most = h->modes->count + options->vectors;
  h->eigenvalue = BW_NEW0(context, double, most);
  h->load = BW_NEW0(context, double, most);
  h->tail = BW_NEW0(context, double, most);
  h->loss = BW_NEW0(context, double, most);
  if (!h->eigenvalue || !h->load || !h->tail || !h->loss)
    return BW_MEMORY;
  h->count = h->modes->count;
  for (int k = 0; k < most; k++)
    h->loss[k] = h->damping.loss;
  memcpy(h->eigenvalue, h->modes->eigenvalue, (size_t)h->count * sizeof *h->eigenvalue);
  h->bound = h->count ? 1 / h->eigenvalue[h->count - 1] : INFINITY;
  return BW_OK;
}

/* The motions of remote points. The model may lose its couplings later, so the response keeps what
 * it needs of them. */
static bw_status take_points(bw_context *context, bw_harmonic *h) {
  bw_status status = BW_OK;
  int points = h->coupling_count = h->model->coupling_count;
  h->point = BW_NEW(context, double, 3 * (int64_t)points);
  h->motion = BW_NEW(context, double, 6 * (int64_t)h->count * points);
  BW_TRY_MEMORY(h->point && h->motion);
  for (int p = 0; p < points; p++)
    memcpy(h->point + 3 * (size_t)p, h->model->coupling[p].point.at, 3 * sizeof(double));
  for (int k = 0; k < h->count; k++)
    bwi_point_motions(h->model, bwi_harmonic_vector(h, k), h->motion + 6 * (int64_t)k * points);
done:
  return status;
}

bw_status bw_harmonic_of_model(bw_context *context, const bw_model *model, bw_system *given,
                               const bw_harmonic_options *options, bw_system **system,
                               bw_harmonic **harmonic) {
  bw_status status = BW_OK;
  bw_system *used = NULL;
  bw_harmonic *h = NULL;
  bwi_equations equations = {0};
  double *force = NULL, highest = 0, error;
  bwi_blas_enter();
  BW_TRY(check_options(context, model->mesh, options, &highest));
  BW_TRY(bwi_check_held_model(context, model, "a harmonic response"));
  h = BW_NEW0(context, bw_harmonic, 1);
  BW_TRY_MEMORY(h);
  bw_object_init(h, &harmonic_kind);
  h->model = bw_retain(model);
  h->damping = options->damping;
  memcpy(h->base, options->base, sizeof h->base);
  BW_TRY(bwi_modes_up_to(context, model, given, options->solver, options->modes, beyond * highest,
                         &used, &h->modes));
  BW_TRY(bwi_equations_open(context, model, used, &equations));
  force = BW_NEW(context, double, equations.size);
  BW_TRY_MEMORY(force);
  BW_TRY(force_of(context, model, &equations, h->base, force));
  BW_TRY(vectors_new(context, options, h));
  if (options->region_loss)
    BW_TRY(bwi_coupling_create(context, &equations, options, force, h));
  BW_TRY(take_frequencies(context, options, h));
  BW_TRY(options->region_loss ? bwi_coupling_grow(context, &equations, options, h)
                              : add_vectors(context, &equations, options, force, h));
  if (h->coupling)
    BW_TRY(find_errors(context, h, &error));
  BW_TRY(take_points(context, h));
  *harmonic = h;
  h = NULL;
done:
  bwi_blas_leave();
  if (system)
    *system = bw_retain(used);
  bwi_equations_clear(&equations);
  bw_release(used);
  bw_release(h);
  bw_free(force);
  return status;
}
