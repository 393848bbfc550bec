/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The cycle over coarse solids; what it is stands in precondition.h.
 *
 * Invariants: level 0 is the solid itself, its `linear` not its own; the last level has a `direct`
 * where there is more than one, and levels between have a `linear`. Vectors of a level are 0 where
 * it is constrained. */
#include "nonlinear/precondition.h"

#include <math.h>
#include <string.h>

#include "nonlinear/internal.h"

enum { DEGREE = 2, POWER = 8, POWER_AGAIN = 2 };
/* The part of the spectrum that the smoother works on: from the largest eigenvalue down to this
 * part of it. What lies below is left to the coarse solid. */
#define LOWEST 0.2
#define ABOVE 1.1 /* over the estimate of the largest eigenvalue, which is from below */

typedef struct level {
  const bw_solid *solid;
  const bw_coarsening *coarsening; /* to the next level, or NULL */
  int32_t *same;                   /* node_count of the next level: fine node at the same place */
  const uint8_t *constrained;
  uint8_t *own_constrained; /* constrained, but on level 0 */
  const bw_solid_linear *linear;
  bw_solid_linear *own_linear;
  const bwi_contact *contact; /* or NULL */
  bwi_contact *own_contact;
  bwi_direct *direct;
  double *stiffness; /* for direct: 9 per block */
  bool usable;       /* direct can solve */
  double *inverse;   /* 9 per node: of the blocks */
  double *u, *r, *z, *t, *d, *q;
  double *power; /* the vector that the largest eigenvalue was found with */
  double largest;
  int64_t size;
} level;

struct bwi_precondition {
  int count;
  level *level;
  int factorisations;
};

static void level_clear(level *l) {
  bw_free(l->same);
  bw_free(l->own_constrained);
  bw_solid_linear_destroy(l->own_linear);
  bwi_contact_destroy(l->own_contact);
  bwi_direct_destroy(l->direct);
  bw_free(l->stiffness);
  bw_free(l->inverse);
  bw_free(l->u);
  bw_free(l->r);
  bw_free(l->z);
  bw_free(l->t);
  bw_free(l->d);
  bw_free(l->q);
  bw_free(l->power);
}

void bwi_precondition_destroy(bwi_precondition *m) {
  if (!m)
    return;
  for (int k = 0; m->level && k < m->count; k++)
    level_clear(&m->level[k]);
  bw_free(m->level);
  bw_free(m);
}

int bwi_precondition_factorisations(const bwi_precondition *m) {
  return m->factorisations;
}

/* About: what is as large as a field or larger. */
size_t bwi_precondition_bytes(const bwi_precondition *m) {
  size_t numbers = 0, bytes = 0;
  for (int k = 0; m && k < m->count; k++) {
    const level *l = &m->level[k];
    numbers += 10 * (size_t)l->size;
    if (l->own_linear)
      numbers += (BWI_ELEMENT_NUMBERS + BWI_ELEMENT_FORCES) * (size_t)l->solid->grid->element_count;
    numbers += l->stiffness ? 9 * (size_t)l->solid->pattern->block_count : 0;
    bytes += bwi_direct_bytes(l->direct);
  }
  return bytes + numbers * sizeof(double);
}

static bw_status level_create(bw_context *context, const bw_solid *solid, level *l) {
  int64_t n = l->size = 3 * (int64_t)solid->grid->node_count;
  l->solid = solid;
  l->inverse = BW_NEW(context, double, 3 * n);
  l->r = BW_NEW0(context, double, n);
  l->z = BW_NEW0(context, double, n);
  l->t = BW_NEW0(context, double, n);
  l->d = BW_NEW0(context, double, n);
  l->q = BW_NEW0(context, double, n);
  l->power = BW_NEW0(context, double, n);
  l->u = BW_NEW0(context, double, n);
  return l->inverse && l->r && l->z && l->t && l->d && l->q && l->power && l->u ? BW_OK : BW_MEMORY;
}

/* For every coarse node the fine node at the same place, or -1: where it has the whole stencil. */
static bw_status find_same(bw_context *context, level *fine) {
  const bw_coarsening *c = fine->coarsening;
  fine->same = BW_NEW(context, int32_t, c->coarse->node_count);
  if (!fine->same)
    return BW_MEMORY;
  memset(fine->same, -1, (size_t)c->coarse->node_count * sizeof *fine->same);
  for (int32_t n = 0; n < c->fine->node_count; n++) {
    const int32_t *s = c->stencil + 8 * (int64_t)n;
    bool one = true;
    for (int q = 1; q < 8; q++)
      one = one && s[q] == s[0];
    if (one)
      fine->same[s[0]] = n;
  }
  return BW_OK;
}

static bw_status constrain_coarse(bw_context *context, const level *fine, level *coarse) {
  coarse->own_constrained = BW_NEW0(context, uint8_t, coarse->size);
  coarse->constrained = coarse->own_constrained;
  if (!coarse->own_constrained)
    return BW_MEMORY;
  for (int64_t n = 0; n < coarse->size / 3; n++)
    for (int c = 0; c < 3; c++)
      coarse->own_constrained[3 * n + c] =
          fine->same[n] >= 0 && fine->constrained[3 * (int64_t)fine->same[n] + c];
  return BW_OK;
}

bw_status bwi_precondition_create(bw_context *context, const bw_solid *solid,
                                  const uint8_t *constrained, const bw_newton_options *options,
                                  const bwi_contact *contact, bwi_precondition **out) {
  bw_status status = BW_OK;
  bwi_precondition *m = BW_NEW0(context, bwi_precondition, 1);
  if (!m)
    return BW_MEMORY;
  m->count = options ? 1 + options->coarse_count : 1;
  m->level = BW_NEW0(context, level, m->count);
  BW_TRY_MEMORY(m->level);
  for (int k = 0; k < m->count; k++) {
    level *l = &m->level[k];
    BW_TRY(level_create(context, k == 0 ? solid : options->coarse[k - 1], l));
    if (k == 0) {
      l->constrained = constrained;
      l->contact = contact;
    } else {
      BW_TRY(constrain_coarse(context, l - 1, l));
      if (l[-1].contact)
        BW_TRY(bwi_contact_coarse(context, l[-1].contact, l[-1].coarsening, &l->own_contact));
      l->contact = l->own_contact;
    }
    if (k + 1 < m->count) {
      l->coarsening = options->coarsening[k];
      BW_TRY(find_same(context, l));
    }
    if (k > 0 && k + 1 == m->count) {
      BW_TRY(bwi_direct_create(context, &l->direct));
      l->stiffness = BW_NEW(context, double, 9 * l->solid->pattern->block_count);
      BW_TRY_MEMORY(l->stiffness);
    } else if (k > 0)
      BW_TRY(bw_solid_linear_create(context, l->solid, &l->own_linear));
  }
  *out = m;
  m = NULL;
done:
  bwi_precondition_destroy(m);
  return status;
}

/* ---- node blocks ---------------------------------------------------------------------------- */

/* The inverse of a symmetric block with constrained components left out and eigenvalues made
 * positive. */
static void invert_block(const double *block, const uint8_t *constrained, double *inverse) {
  double tensor[6], value[3], vector[9], max = 0;
  static const int place[6] = {0, 4, 8, 5, 2, 1};
  for (int i = 0; i < 6; i++)
    tensor[i] = block[place[i]];
  for (int c = 0; c < 3; c++)
    if (constrained[c]) {
      static const int others[3][2] = {{4, 5}, {3, 5}, {3, 4}};
      tensor[c] = tensor[others[c][0]] = tensor[others[c][1]] = 0;
    }
  memset(inverse, 0, 9 * sizeof *inverse);
  bw_eigen3(tensor, value, vector);
  for (int k = 0; k < 3; k++)
    max = fmax(max, fabs(value[k]));
  if (!(max > 0))
    return;
  for (int k = 0; k < 3; k++) {
    double size = fmax(fabs(value[k]), 1e-9 * max);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        inverse[3 * i + j] += vector[3 * k + i] * vector[3 * k + j] / size;
  }
  for (int c = 0; c < 3; c++)
    if (constrained[c])
      for (int i = 0; i < 3; i++)
        inverse[3 * c + i] = inverse[3 * i + c] = 0;
}

static void times_inverse(const level *l, const double *r, double *z) {
  for (int64_t n = 0; n < l->size / 3; n++) {
    const double *m = l->inverse + 9 * n, x[3] = {r[3 * n], r[3 * n + 1], r[3 * n + 2]};
    for (int i = 0; i < 3; i++)
      z[3 * n + i] = m[3 * i] * x[0] + m[3 * i + 1] * x[1] + m[3 * i + 2] * x[2];
  }
}

static bw_status set_blocks(bw_context *context, level *l, const double *blocks) {
  bw_status status = BW_OK;
  double *own = BW_NEW(context, double, 3 * l->size);
  if (!own)
    return BW_MEMORY;
  if (blocks)
    memcpy(own, blocks, 3 * (size_t)l->size * sizeof *own);
  else
    BW_TRY(bw_solid_linear_diagonal(context, l->linear, own));
  if (l->contact)
    bwi_contact_blocks(l->contact, own);
  for (int64_t n = 0; n < l->size / 3; n++)
    invert_block(own + 9 * n, l->constrained + 3 * n, l->inverse + 9 * n);
done:
  bw_free(own);
  return status;
}

/* ---- the smoother --------------------------------------------------------------------------- */

/* y = K x, 0 where constrained */
static bw_status multiply(bw_context *context, const level *l, const double *x, double *y) {
  bw_status status = bw_solid_linear_multiply(context, l->linear, x, y);
  if (l->contact)
    bwi_contact_multiply(l->contact, x, y);
  for (int64_t i = 0; i < l->size; i++)
    if (l->constrained[i])
      y[i] = 0;
  return status;
}

static double dot(const level *l, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < l->size; i++)
    sum += a[i] * b[i];
  return sum;
}

/* The largest eigenvalue of D^-1 K, by powers of it, from where the last search ended. */
static bw_status find_largest(bw_context *context, level *l) {
  bw_status status = BW_OK;
  int steps = l->largest > 0 ? POWER_AGAIN : POWER;
  if (!(l->largest > 0)) {
    bw_random random;
    bw_random_seed(&random, 1);
    for (int64_t i = 0; i < l->size; i++)
      l->power[i] = l->constrained[i] ? 0 : bw_random_uniform(&random) - 0.5;
  }
  l->largest = 0;
  for (int k = 0; k < steps; k++) {
    double size = sqrt(dot(l, l->power, l->power));
    if (!(size > 0) || !isfinite(size))
      break;
    for (int64_t i = 0; i < l->size; i++)
      l->power[i] /= size;
    BW_TRY(multiply(context, l, l->power, l->t));
    times_inverse(l, l->t, l->power);
    l->largest = fmax(l->largest, sqrt(dot(l, l->power, l->power)));
  }
done:
  return status;
}

/* z, from 0 or from what it is, closer to K^-1 r. */
static bw_status smooth(bw_context *context, level *l, bool from_zero, const double *r, double *z) {
  bw_status status = BW_OK;
  double high = ABOVE * l->largest, low = LOWEST * l->largest;
  double middle = 0.5 * (high + low), half = 0.5 * (high - low), rho = half / middle;
  const double *rest = r;
  if (!(high > 0)) {
    times_inverse(l, r, z);
    return BW_OK;
  }
  for (int k = 0; k < DEGREE; k++) {
    if (k > 0 || !from_zero) {
      BW_TRY(multiply(context, l, z, l->t));
      for (int64_t i = 0; i < l->size; i++)
        l->t[i] = r[i] - l->t[i];
      rest = l->t;
    }
    times_inverse(l, rest, l->q);
    double next = k == 0 ? 0 : 1 / (2 * middle / half - rho);
    double keep = k == 0 ? 0 : next * rho, take = k == 0 ? 1 / middle : 2 * next / half;
    for (int64_t i = 0; i < l->size; i++) {
      l->d[i] = keep * l->d[i] + take * l->q[i];
      z[i] = (k == 0 && from_zero ? 0 : z[i]) + l->d[i];
    }
    if (k > 0)
      rho = next;
  }
done:
  return status;
}

/* ---- the cycle ------------------------------------------------------------------------------ */

/* z = M r of level k; r and z are not the level's own r and z where k = 0. */
static bw_status cycle(bw_context *context, bwi_precondition *m, int k, const double *r,
                       double *z) {
  bw_status status = BW_OK;
  level *l = &m->level[k];
  if (l->direct) {
    if (l->usable)
      return bwi_direct_solve(context, l->direct, r, z);
    memset(z, 0, (size_t)l->size * sizeof *z);
    return BW_OK;
  }
  if (!l->coarsening) {
    times_inverse(l, r, z);
    return BW_OK;
  }
  level *next = l + 1;
  BW_TRY(smooth(context, l, true, r, z));
  BW_TRY(multiply(context, l, z, l->t));
  for (int64_t i = 0; i < l->size; i++)
    l->t[i] = r[i] - l->t[i];
  bw_coarsening_restrict(l->coarsening, 3, l->t, next->r);
  for (int64_t i = 0; i < next->size; i++)
    if (next->constrained[i])
      next->r[i] = 0;
  BW_TRY(cycle(context, m, k + 1, next->r, next->z));
  bw_coarsening_prolong(l->coarsening, 3, next->z, l->t);
  for (int64_t i = 0; i < l->size; i++)
    if (!l->constrained[i])
      z[i] += l->t[i];
  BW_TRY(smooth(context, l, false, r, z));
done:
  return status;
}

bw_status bwi_precondition_apply(bw_context *context, bwi_precondition *m, const double *r,
                                 double *z) {
  return cycle(context, m, 0, r, z);
}

/* ---- following the tangent ------------------------------------------------------------------- */

/* Coarse displacements: those of the fine nodes at the same places; elsewhere means around. */
static bw_status coarse_displacements(bw_context *context, const level *fine, const double *u,
                                      level *coarse) {
  const bw_coarsening *c = fine->coarsening;
  int64_t nodes = coarse->size / 3;
  double *sum = BW_NEW0(context, double, 4 * nodes);
  if (!sum)
    return BW_MEMORY;
  for (int64_t n = 0; n < fine->size / 3; n++)
    for (int q = 0; q < 8; q++) {
      double *at = sum + 4 * (int64_t)c->stencil[8 * n + q];
      for (int d = 0; d < 3; d++)
        at[d] += u[3 * n + d];
      at[3]++;
    }
  for (int64_t n = 0; n < nodes; n++)
    for (int d = 0; d < 3; d++)
      coarse->u[3 * n + d] = fine->same[n] >= 0 ? u[3 * (int64_t)fine->same[n] + d]
                                                : sum[4 * n + d] / fmax(1, sum[4 * n + 3]);
  bw_free(sum);
  return BW_OK;
}

static bool is_defined(bw_context *context, const level *l, bw_status *status) {
  bw_solid_shape shape = {0};
  double energy;
  *status = bw_solid_evaluate(context, l->solid, l->u, false, &energy, NULL, NULL, &shape);
  return *status != BW_OK || (shape.defined && isfinite(energy));
}

static bw_status factor_coarsest(bw_context *context, bwi_precondition *m, level *l) {
  bw_status status = BW_OK;
  const bw_block_pattern *pattern = l->solid->pattern;
  bw_solid_shape shape;
  double mean = 0, shift = 0;
  bool free = false;
  l->usable = false;
  for (int64_t i = 0; i < l->size; i++)
    free = free || !l->constrained[i];
  if (!free)
    return BW_OK;
  BW_TRY(bw_solid_evaluate(context, l->solid, l->u, true, NULL, NULL, l->stiffness, &shape));
  for (int64_t i = 0; i < l->size; i++)
    mean += l->stiffness[9 * (pattern->start[i / 3 + 1] - 1) + 4 * (i % 3)] / (double)l->size;
  if (l->contact)
    bwi_contact_stiffness(l->contact, pattern, l->stiffness);
  for (double part = 0; part <= 1 && !l->usable; part = part > 0 ? 30 * part : 1e-8) {
    for (int64_t n = 0; n < pattern->node_count; n++)
      for (int c = 0; c < 3; c++)
        l->stiffness[9 * (pattern->start[n + 1] - 1) + 4 * c] += part * mean - shift;
    shift = part * mean;
    BW_TRY(bwi_direct_factor(context, l->direct, pattern, l->constrained, l->stiffness, &l->usable,
                             NULL));
    m->factorisations++;
  }
done:
  return status;
}

bw_status bwi_precondition_set(bw_context *context, bwi_precondition *m,
                               const bw_solid_linear *linear, const double *u,
                               const double *blocks) {
  bw_status status = BW_OK;
  for (int k = 0; k < m->count; k++) {
    level *l = &m->level[k];
    if (k == 0) {
      l->linear = linear;
      memcpy(l->u, u, (size_t)l->size * sizeof *u);
    } else {
      BW_TRY(coarse_displacements(context, l - 1, l[-1].u, l));
      if (!is_defined(context, l, &status)) /* a coarse shape may be bad where the fine is not */
        memset(l->u, 0, (size_t)l->size * sizeof *l->u);
      BW_TRY(status);
    }
    if (l->direct) {
      BW_TRY(factor_coarsest(context, m, l));
      continue;
    }
    if (k > 0) {
      BW_TRY(bw_solid_linear_set(context, l->own_linear, l->u, true));
      l->linear = l->own_linear;
    }
    BW_TRY(set_blocks(context, l, k == 0 ? blocks : NULL));
    if (l->coarsening)
      BW_TRY(find_largest(context, l));
  }
done:
  return status;
}

bw_status bwi_precondition_multiply(bw_context *context, const bwi_precondition *m, const double *x,
                                    double *y) {
  return multiply(context, &m->level[0], x, y);
}

const uint8_t *bwi_precondition_constrained(const bwi_precondition *m, int64_t *size) {
  *size = m->level[0].size;
  return m->level[0].constrained;
}
