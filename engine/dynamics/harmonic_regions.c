/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Harmonic response with loss factors of regions (docs/theory/dynamics.md): in the inner product of
 * K the equations are T u = g with T = s - m A + i D, A = K^-1 M, D = K^-1 H and g = K^-1 f. The
 * basis Q has the modes, g, and A and D times all vectors of the response, so that the coordinates
 * in Q of a residual are its size. The vectors are the modes and residuals where the error is
 * largest. */
#include "dynamics/harmonic_regions.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "barwright/assemble.h"
#include "dynamics/internal.h"
#include "linear/blas.h"
#include "linear/internal.h"
#include "linear/multivector.h"
#include "model/internal.h"

static const double pi = 3.14159265358979323846;
/* A remainder of a vector below this part of it is rounding. */
static const double rounding = 1e-10;

struct bwi_coupling {
  int modes, count, most; /* (count) of vectors, the first of them modes; at most */
  int span, width;        /* (count) of Q; at most */
  int64_t size;           /* of a field */
  double least;           /* (-) of the regions' losses */
  double *basis;          /* (span x size) Q, K-orthonormal */
  size_t capacity;        /* (count) of Q */
  double *values;         /* (block_count x 9) H */
  double *field;          /* (2 x size) work space */
  double *own;            /* (most x width) coordinates in Q of the vectors, K-orthonormal too */
  double *mass, *loss;    /* (most x width) of A and D times these: of what is outside their span */
  double *load;           /* (width) of g, likewise */
  double *inner_mass, *inner_loss; /* (most x most) products of A and D times these with them */
  double *inner_load;              /* (most) of g */
};

/* What only growing needs. */
static void close_basis(bwi_coupling *c) {
  bw_free(c->basis);
  bw_free(c->values);
  bw_free(c->field);
  c->basis = c->values = c->field = NULL;
}

void bwi_coupling_destroy(bwi_coupling *c) {
  if (!c)
    return;
  close_basis(c);
  bw_free(c->own);
  bw_free(c->mass);
  bw_free(c->loss);
  bw_free(c->load);
  bw_free(c->inner_mass);
  bw_free(c->inner_loss);
  bw_free(c->inner_load);
  bw_free(c);
}

size_t bwi_coupling_bytes(const bwi_coupling *c) {
  size_t most = (size_t)c->most, width = (size_t)c->width;
  return sizeof *c + (3 * most * width + width + 2 * most * most + most) * sizeof(double);
}

/* ---- the basis ------------------------------------------------------------------------------- */

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++)
    sum += a[i] * b[i];
  return sum;
}

/* K^-1 f joins Q: its coordinates there. f is overwritten. */
static bw_status take(bw_context *context, const bwi_equations *body, bwi_coupling *c, double *f,
                      double *coordinate) {
  bw_status status = BW_OK;
  double before, square = 0, *along = BW_NEW(context, double, c->width);
  BW_TRY_MEMORY(along);
  BW_TRY_MEMORY(bw_grow(context, (void **)&c->basis, &c->capacity, (size_t)c->span, 1,
                        (size_t)c->size * sizeof *c->basis));
  double *x = c->basis + c->span * c->size;
  memset(coordinate, 0, (size_t)c->width * sizeof *coordinate);
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_equations_solve(context, body, f, x));
  BW_TRY(bwi_multi_dot(context, c->size, 1, x, 1, f, &before));
  for (int pass = 0; pass < 2; pass++) { /* f is K x */
    if (c->span > 0) {
      BW_TRY(bwi_multi_dot(context, c->size, c->span, c->basis, 1, f, along));
      BW_TRY(bwi_multi_combine(context, c->size, c->span, c->basis, 1, along, c->span, -1, 1, x));
    }
    for (int k = 0; k < c->span; k++)
      coordinate[k] += along[k];
    BW_TRY(bwi_equations_stiffness(context, body, x, f));
  }
  BW_TRY(bwi_multi_dot(context, c->size, 1, x, 1, f, &square));
  if (!(square > rounding * rounding * before))
    goto done;
  for (int64_t i = 0; i < c->size; i++)
    x[i] /= sqrt(square);
  coordinate[c->span++] = sqrt(square);
done:
  bw_free(along);
  return status;
}

/* Takes what is along the vectors out of `outside`, and adds it to `inner`. */
static void project(const bwi_coupling *c, double *outside, double *inner) {
  for (int pass = 0; pass < 2; pass++)
    for (int j = 0; j < c->count; j++) {
      const double *own = c->own + (int64_t)j * c->width;
      double along = dot(c->span, own, outside);
      inner[j] += along;
      for (int k = 0; k < c->span; k++)
        outside[k] -= along * own[k];
    }
}

/* After vectors were added. */
static void project_all(bwi_coupling *c) {
  for (int i = 0; i < c->count; i++) {
    project(c, c->mass + (int64_t)i * c->width, c->inner_mass + (int64_t)i * c->most);
    project(c, c->loss + (int64_t)i * c->width, c->inner_loss + (int64_t)i * c->most);
  }
  project(c, c->load, c->inner_load);
}

/* The next vector, of which `own` has the coordinates: A and D times it join Q. */
static bw_status take_vector(bw_context *context, const bwi_equations *body, bwi_coupling *c) {
  bw_status status = BW_OK;
  int64_t at = (int64_t)c->count * c->width;
  double *v = c->field, *f = c->field + c->size;
  BW_TRY(bwi_multi_combine(context, c->size, c->span, c->basis, 1, c->own + at, c->span, 1, 0, v));
  BW_TRY(bwi_equations_mass(context, body, v, f));
  BW_TRY(take(context, body, c, f, c->mass + at));
  BW_TRY(bwi_equations_values(context, body, c->values, v, f));
  BW_TRY(take(context, body, c, f, c->loss + at));
  c->count++;
done:
  return status;
}

/* H: what the stiffness gains where the moduli of regions grow by their losses, scaled so that they
 * at most double. */
static bw_status make_loss(bw_context *context, const bwi_equations *body, const bw_model *model,
                           const double *region_loss, bwi_coupling *c) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  bw_material *material = NULL;
  int64_t entries = 9 * body->pattern->block_count;
  double largest = 0, *factor = BW_NEW(context, double, mesh->region_count);
  BW_TRY_MEMORY(factor);
  c->least = INFINITY;
  for (int32_t r = 0; r < mesh->region_count; r++) {
    c->least = fmin(c->least, region_loss[r]);
    largest = fmax(largest, region_loss[r]);
  }
  if (bwi_has_springs(model)) /* they lose nothing */
    c->least = 0;
  for (int32_t r = 0; r < mesh->region_count; r++)
    factor[r] = 1 + (largest > 0 ? region_loss[r] / largest : 0);
  BW_TRY(bw_material_stiffened(context, model->material, (int32_t)mesh->element_count,
                               mesh->region_count, mesh->region, factor, &material));
  c->values = BW_NEW(context, double, entries);
  BW_TRY_MEMORY(c->values);
  BW_TRY(bw_stiffness(context, body->pattern, mesh, material, c->values));
  bwi_add_attachments(model, body->pattern, 9, c->values);
  for (int64_t i = 0; i < entries; i++)
    c->values[i] = largest * (c->values[i] - body->stiffness[i]);
done:
  bw_free(factor);
  bw_release(material);
  return status;
}

/* The modes as vectors, and g. */
static bw_status take_modes(bw_context *context, const bwi_equations *body, const bw_modes *modes,
                            const double *force, bwi_coupling *c) {
  bw_status status = BW_OK;
  BW_TRY_MEMORY(bw_grow(context, (void **)&c->basis, &c->capacity, 0, (size_t)modes->count + 1,
                        (size_t)c->size * sizeof *c->basis));
  for (int k = 0; k < modes->count; k++) {
    double scale = 1 / sqrt(modes->eigenvalue[k]);
    for (int64_t i = 0; i < c->size; i++)
      c->basis[k * c->size + i] = scale * modes->shape[k * c->size + i];
    c->own[(int64_t)k * c->width + k] = 1;
    c->mass[(int64_t)k * c->width + k] = 1 / modes->eigenvalue[k];
  }
  c->span = modes->count;
  for (int k = 0; k < modes->count; k++) {
    double *f = c->field;
    BW_TRY(bwi_equations_values(context, body, c->values, c->basis + k * c->size, f));
    BW_TRY(take(context, body, c, f, c->loss + (int64_t)k * c->width));
  }
  memcpy(c->field, force, (size_t)c->size * sizeof *force);
  BW_TRY(take(context, body, c, c->field, c->load));
  c->count = modes->count;
  project_all(c);
done:
  return status;
}

static void take_losses(const bwi_coupling *c, bw_harmonic *h) {
  for (int k = 0; k < c->count; k++)
    h->loss[k] = h->damping.loss + c->inner_loss[(int64_t)k * c->most + k];
}

bw_status bwi_coupling_create(bw_context *context, const bwi_equations *body,
                              const bw_harmonic_options *options, const double *force,
                              bw_harmonic *h) {
  bw_status status = BW_OK;
  int vectors = options->vectors;
  bwi_coupling *c = BW_NEW0(context, bwi_coupling, 1);
  BW_TRY_MEMORY(c);
  c->modes = h->modes->count;
  c->most = c->modes + vectors;
  c->width = c->modes + 1 + c->most + vectors; /* a mode is A times itself */
  c->size = 3 * (int64_t)h->model->mesh->node_count;
  int64_t most = c->most, wide = most * c->width;
  c->field = BW_NEW(context, double, 2 * c->size);
  c->own = BW_NEW0(context, double, wide);
  c->mass = BW_NEW0(context, double, wide);
  c->loss = BW_NEW0(context, double, wide);
  c->load = BW_NEW0(context, double, c->width);
  c->inner_mass = BW_NEW0(context, double, most *most);
  c->inner_loss = BW_NEW0(context, double, most *most);
  c->inner_load = BW_NEW0(context, double, most);
  BW_TRY_MEMORY(c->field && c->own && c->mass && c->loss && c->load && c->inner_mass &&
                c->inner_loss && c->inner_load);
  BW_TRY(make_loss(context, body, h->model, options->region_loss, c));
  BW_TRY(take_modes(context, body, h->modes, force, c));
  take_losses(c, h);
  h->coupling = c;
  c = NULL;
done:
  bwi_coupling_destroy(c);
  return status;
}

/* ---- one frequency --------------------------------------------------------------------------- */

typedef struct number {
  double re, im;
} number;

/* The equations at a frequency, 2 n x 2 n real ones for n complex ones, and their right-hand sides:
 * first g, then as many as wanted of T's rows outside the span of the vectors. */
typedef struct equations {
  int n, columns;
  number s, m;
  double *matrix, *right;
} equations;

static void fill(const bwi_coupling *c, const bw_damping *damping, double omega, equations *e) {
  int n = e->n, two = 2 * n;
  e->s = (number){1, damping->loss + omega * damping->stiffness};
  e->m = (number){omega * omega, -omega * damping->mass};
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      double mass = c->inner_mass[(int64_t)j * c->most + i];
      double re = -e->m.re * mass;
      double im = -e->m.im * mass + c->inner_loss[(int64_t)j * c->most + i];
      if (i == j) {
        re += e->s.re;
        im += e->s.im + (i < c->modes ? 2 * damping->ratio * omega * sqrt(fmax(mass, 0)) : 0);
      }
      e->matrix[j * two + i] = e->matrix[(n + j) * two + n + i] = re;
      e->matrix[j * two + n + i] = im;
      e->matrix[(n + j) * two + i] = -im;
    }
  for (int i = 0; i < n; i++) {
    e->right[i] = c->inner_load[i];
    e->right[n + i] = 0;
    for (int k = 0; k + 1 < e->columns; k++) {
      double mass = c->mass[(int64_t)i * c->width + k], *own = e->right + (k + 1) * two;
      own[i] = -e->m.re * mass;
      own[n + i] = -e->m.im * mass + c->loss[(int64_t)i * c->width + k];
    }
  }
}

/* The residual of the solution y: (2 x width), real and imaginary parts. */
static void find_residual(const bwi_coupling *c, const equations *e, const double *y,
                          double *residual) {
  double *re = residual, *im = residual + c->width;
  memcpy(re, c->load, (size_t)c->width * sizeof *re);
  memset(im, 0, (size_t)c->width * sizeof *im);
  for (int i = 0; i < e->n; i++) {
    const double *mass = c->mass + (int64_t)i * c->width, *loss = c->loss + (int64_t)i * c->width;
    for (int k = 0; k < c->span; k++) {
      double a = -e->m.re * mass[k], b = -e->m.im * mass[k] + loss[k];
      re[k] -= a * y[i] - b * y[e->n + i];
      im[k] -= a * y[e->n + i] + b * y[i];
    }
  }
}

/* The least of |s + i d - m t| for t from 0 to `last` and d of `least` or more. */
static double distance(number s, number m, double least, double last) {
  double square = m.re * m.re + m.im * m.im;
  s.im += least;
  double t = square > 0 ? (s.re * m.re + s.im * m.im) / square : 0;
  t = fmin(fmax(t, 0), last);
  return hypot(s.re - m.re * t, s.im - m.im * t);
}

/* Solves at a frequency: y (2 x count), real and imaginary parts; residual (2 x width) may be NULL.
 * *error is that of the displacement over it, in energy: a bound, or where `roughly`, without what
 * the error outside the span of the vectors causes inside. */
static bw_status solve(bw_context *context, const bwi_coupling *c, const bw_harmonic *h,
                       double omega, bool roughly, double *y, double *residual, double *error) {
  bw_status status = BW_OK;
  int two = 2 * c->count, info = 0;
  equations e = {.n = c->count, .columns = error && !roughly ? 1 + c->span : 1};
  int *pivot = BW_NEW(context, int, two + 1);
  double *found = residual, outside = 0, inside = 0;
  e.matrix = BW_NEW(context, double, (int64_t)two *two + 1);
  e.right = BW_NEW(context, double, (int64_t)two *e.columns + 1);
  if (!found)
    found = BW_NEW(context, double, 2 * (int64_t)c->width);
  BW_TRY_MEMORY(pivot && e.matrix && e.right && found);
  fill(c, &h->damping, omega, &e);
  for (int64_t i = two; i < (int64_t)two * e.columns; i++)
    outside += e.right[i] * e.right[i];
  dgesv_(&two, &e.columns, e.matrix, &two, pivot, e.right, &two, &info);
  if (info != 0)
    BW_TRY(
        bw_fail(context, BW_SINGULAR,
                "%g Hz is the frequency of a mode that nothing damps: its response has no limit. "
                "Give a damping",
                omega / (2 * pi)));
  for (int64_t i = two; i < (int64_t)two * e.columns; i++)
    inside += e.right[i] * e.right[i];
  memcpy(y, e.right, (size_t)two * sizeof *y);
  find_residual(c, &e, y, found);
  if (error) {
    double left = sqrt(dot(2 * c->width, found, found)), whole = sqrt(dot(two, y, y));
    double apart = distance(e.s, e.m, c->least, h->bound) - sqrt(outside * inside);
    double lossy = e.s.im + c->least, bound = INFINITY;
    if (apart > 0)
      bound = left * sqrt(1 + inside) / apart;
    if (lossy > 0)
      bound = fmin(bound, left / lossy);
    *error = left > 0 ? bound / whole : 0;
  }
done:
  bw_free(pivot);
  bw_free(e.matrix);
  bw_free(e.right);
  if (found != residual)
    bw_free(found);
  return status;
}

bw_status bwi_coupling_coordinates(bw_context *context, const bw_harmonic *h, double omega,
                                   double *coordinate, double *error) {
  bw_status status = BW_OK;
  const bwi_coupling *c = h->coupling;
  double *y = BW_NEW(context, double, 2 * (int64_t)c->count + 1);
  BW_TRY_MEMORY(y);
  BW_TRY(solve(context, c, h, omega, false, y, NULL, error));
  for (int k = 0; k < c->count; k++) {
    coordinate[2 * k] = y[k] / sqrt(h->eigenvalue[k]);
    coordinate[2 * k + 1] = y[c->count + k] / sqrt(h->eigenvalue[k]);
  }
done:
  bw_free(y);
  return status;
}

/* ---- growing --------------------------------------------------------------------------------- */

/* The largest error over the frequencies, and the residual (2 x width) there. */
static bw_status worst(bw_context *context, const bwi_coupling *c, const bw_harmonic *h,
                       double *residual, double *largest) {
  bw_status status = BW_OK;
  double *own = BW_NEW(context, double, 2 * (int64_t)c->width);
  double *y = BW_NEW(context, double, 2 * (int64_t)c->most + 1), error;
  BW_TRY_MEMORY(own && y);
  *largest = -1;
  for (int i = 0; i < h->frequency_count; i++) {
    double omega = 2 * pi * h->frequency[i];
    BW_TRY(solve(context, c, h, omega, true, y, own, &error));
    if (error > *largest) {
      *largest = error;
      memcpy(residual, own, 2 * (size_t)c->width * sizeof *own);
    }
  }
done:
  bw_free(own);
  bw_free(y);
  return status;
}

/* A residual's part, of the size `whole` together with the other, becomes a vector. */
static bw_status add_residual(bw_context *context, const bwi_equations *body, double *part,
                              double whole, bwi_coupling *c) {
  double *own = c->own + (int64_t)c->count * c->width, *along = c->field;
  memset(along, 0, (size_t)c->count * sizeof *along);
  project(c, part, along);
  double size = sqrt(dot(c->span, part, part));
  if (!(size > rounding * whole))
    return BW_OK;
  for (int k = 0; k < c->span; k++)
    own[k] = part[k] / size;
  return take_vector(context, body, c);
}

/* The vectors themselves, of unit modal mass, and their numbers. */
static bw_status finish(bw_context *context, bwi_coupling *c, bw_harmonic *h) {
  bw_status status = BW_OK;
  int more = c->count - c->modes;
  h->count = c->count;
  take_losses(c, h);
  for (int k = 0; k < c->count; k++) {
    double mass = c->inner_mass[(int64_t)k * c->most + k];
    if (k >= c->modes)
      h->eigenvalue[k] = 1 / fmax(mass, DBL_MIN);
    h->load[k] = sqrt(h->eigenvalue[k]) * c->inner_load[k];
  }
  if (more == 0)
    goto done;
  h->residual = BW_NEW(context, double, more * c->size);
  BW_TRY_MEMORY(h->residual);
  BW_TRY(bwi_multi_combine(context, c->size, c->span, c->basis, more,
                           c->own + (int64_t)c->modes * c->width, c->width, 1, 0, h->residual));
  for (int k = 0; k < more; k++)
    for (int64_t i = 0; i < c->size; i++)
      h->residual[k * c->size + i] *= sqrt(h->eigenvalue[c->modes + k]);
done:
  close_basis(c);
  return status;
}

bw_status bwi_coupling_grow(bw_context *context, const bwi_equations *body,
                            const bw_harmonic_options *options, bw_harmonic *h) {
  bw_status status = BW_OK;
  bwi_coupling *c = h->coupling;
  double error, *residual = BW_NEW0(context, double, 2 * (int64_t)c->width);
  BW_TRY_MEMORY(residual);
  while (c->count < c->most) {
    int before = c->count;
    BW_TRY(worst(context, c, h, residual, &error));
    if (!(error > options->tolerance))
      break;
    double whole = sqrt(dot(2 * c->width, residual, residual));
    for (int part = 0; part < 2 && c->count < c->most; part++)
      BW_TRY(add_residual(context, body, residual + (int64_t)part * c->width, whole, c));
    project_all(c);
    if (c->count == before)
      break;
    bw_progress(context, "residual vectors", (double)(c->count - c->modes) / options->vectors);
  }
  h->solves = c->span - c->modes;
  BW_TRY(finish(context, c, h));
done:
  bw_free(residual);
  return status;
}
