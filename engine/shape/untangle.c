/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Energies that untangle and smooth a patch of elements, and their minimisation.
 *
 * Of an element, J is the map from the regular tetrahedron of the wanted volume, D = det J, and
 * chi(D) = (D + sqrt(D^2 + eps^2)) / 2 a positive stand-in for D that tends to D as eps -> 0. The
 * energy
 *
 *   |J|^2 / (3 chi^(2/3)) + (1 + D^2) / (2 chi)
 *
 * is finite for inverted elements, and falls fastest where they turn right; its first term is one
 * over the mean ratio where D > 0, its second keeps elements from vanishing into points, where that
 * ratio would not see it. eps is lowered with the worst D, so that the energy grows into a barrier
 * (after Escobar et al. 2003, and Garanzha et al. 2021 for the choice of eps). Smoothing takes the
 * cube of the first term with eps = 0: high powers weigh the worst element most.
 *
 * All free nodes of a patch move together, by limited-memory BFGS. The same steps in the same order
 * every time: no threads here. */
#include "base/dense.h"
#include "shape/mesh_repair_internal.h"

#include <math.h>
#include <string.h>

enum { PAIRS = 6, MAX_TRIALS = 20 };

/* The columns of the inverse of W = [w1 - w0, w2 - w0, w3 - w0], a regular element of edge 1. */
static const double inverse_w[9] = {
    1, -0.57735026918962573, -0.40824829046386302, 0, 1.1547005383792515, -0.40824829046386302, 0,
    0, 1.2247448713915889};

typedef struct minimiser {
  bwi_patch *patch;
  double epsilon;
  bool smoothing;
  double lowest; /* the smallest D at the last evaluation */
} minimiser;

static const double *corner_at(const bwi_patch *p, const double *x, int32_t e, int k) {
  int32_t c = p->corner[4 * (size_t)e + (size_t)k];
  return c >= 0 ? x + 3 * (size_t)c : p->fixed + 12 * (size_t)e + 3 * (size_t)k;
}

double bwi_patch_quality(bwi_patch *patch) {
  patch->worst = INFINITY;
  patch->worst_place = -1;
  for (int32_t e = 0; e < patch->element_count; e++) {
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = corner_at(patch, patch->x, e, k);
    double quality = bwi_checked_quality((const double *const *)x);
    if (quality < patch->worst) {
      patch->worst = quality;
      patch->worst_place = e;
    }
  }
  return patch->worst;
}

/* Energy of one element; slope: its derivative by J. */
static double element_energy(const minimiser *m, const double j[9], double d, double slope[9]) {
  double square = 0, cofactor[9];
  for (int i = 0; i < 9; i++)
    square += j[i] * j[i];
  for (int r = 0; r < 3; r++)
    bw_cross(j + 3 * ((r + 1) % 3), j + 3 * ((r + 2) % 3), cofactor + 3 * r);
  if (m->smoothing) {
    double f = square / (3 * cbrt(d) * cbrt(d)), outer = 3 * f * f;
    for (int i = 0; i < 9; i++)
      slope[i] = outer * f * (2 * j[i] / square - 2 * cofactor[i] / (3 * d));
    return f * f * f;
  }
  double root = sqrt(d * d + m->epsilon * m->epsilon);
  /* no cancellation for negative d */
  double chi = d > 0 ? (d + root) / 2 : m->epsilon * m->epsilon / (2 * (root - d));
  double chi_slope = chi / root, third = cbrt(chi);
  double f = square / (3 * third * third), g = (1 + d * d) / (2 * chi);
  double by_d = -2 * f / (3 * chi) * chi_slope + d / chi - g / chi * chi_slope;
  for (int i = 0; i < 9; i++)
    slope[i] = 2 / (3 * third * third) * j[i] + by_d * cofactor[i];
  return f + g;
}

/* The patch's energy at x, infinite behind the barrier. */
static double energy(minimiser *m, const double *x, double *gradient) {
  const bwi_patch *p = m->patch;
  double sum = 0;
  memset(gradient, 0, 3 * (size_t)p->free_count * sizeof *gradient);
  m->lowest = INFINITY;
  for (int32_t e = 0; e < p->element_count; e++) {
    const double *c[4];
    double side[9], j[9], slope[9], by_side[9];
    for (int k = 0; k < 4; k++)
      c[k] = corner_at(p, x, e, k);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        side[3 * i + k] = (c[k + 1][i] - c[0][i]) / p->length[e];
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        double entry = 0;
        for (int l = 0; l <= k; l++)
          entry += side[3 * i + l] * inverse_w[3 * l + k];
        j[3 * i + k] = entry;
      }
    double cross[3];
    bw_cross(j + 3, j + 6, cross);
    double d = bw_dot(j, cross);
    m->lowest = fmin(m->lowest, d);
    if (!isfinite(d) || (m->smoothing && !(d > 0)))
      return INFINITY;
    sum += element_energy(m, j, d, slope);
    for (int i = 0; i < 3; i++)
      for (int l = 0; l < 3; l++) {
        double entry = 0;
        for (int k = l; k < 3; k++)
          entry += slope[3 * i + k] * inverse_w[3 * l + k];
        by_side[3 * i + l] = entry / p->length[e];
      }
    const int32_t *corner = p->corner + 4 * (size_t)e;
    for (int i = 0; i < 3; i++) {
      for (int l = 0; l < 3; l++)
        if (corner[l + 1] >= 0)
          gradient[3 * (size_t)corner[l + 1] + (size_t)i] += by_side[3 * i + l];
      if (corner[0] >= 0)
        gradient[3 * (size_t)corner[0] + (size_t)i] -=
            by_side[3 * i] + by_side[3 * i + 1] + by_side[3 * i + 2];
    }
  }
  return isfinite(sum) ? sum : INFINITY;
}

/* The largest step at which no node moves farther than half an edge. */
static double longest_step(const bwi_patch *p, const double *direction) {
  double step = INFINITY;
  for (int32_t e = 0; e < p->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t c = p->corner[4 * (size_t)e + (size_t)k];
      if (c < 0)
        continue;
      double size = bw_norm(direction + 3 * (size_t)c);
      if (size > 0)
        step = fmin(step, 0.5 * p->length[e] / size);
    }
  return step;
}

/* What one run of the minimiser needs: positions and gradients of the trial, the direction, and the
 * last PAIRS differences of both, in one block. */
typedef struct workspace {
  double *block, *trial, *gradient, *trial_gradient, *direction, *moved, *turned;
  double inner[PAIRS]; /* 1 / (moved . turned) */
} workspace;

static bw_status workspace_create(bw_context *context, size_t n, workspace *w) {
  w->block = BW_NEW(context, double, n *(4 + 2 * PAIRS));
  if (!w->block)
    return BW_MEMORY;
  w->trial = w->block;
  w->gradient = w->trial + n;
  w->trial_gradient = w->gradient + n;
  w->direction = w->trial_gradient + n;
  w->moved = w->direction + n;
  w->turned = w->moved + PAIRS * n;
  return BW_OK;
}

/* direction = -H gradient by the two loops over the pairs kept, newest first and last. */
static void find_direction(workspace *w, size_t n, int pairs, int newest) {
  double alpha[PAIRS];
  for (size_t i = 0; i < n; i++)
    w->direction[i] = -w->gradient[i];
  for (int k = 0; k < pairs; k++) {
    size_t at = (size_t)((newest - k + PAIRS) % PAIRS);
    alpha[at] = w->inner[at] * bwi_dot(n, w->moved + at * n, w->direction);
    for (size_t i = 0; i < n; i++)
      w->direction[i] -= alpha[at] * w->turned[at * n + i];
  }
  if (pairs > 0) {
    const double *y = w->turned + (size_t)newest * n;
    double scale = 1 / (w->inner[newest] * bwi_dot(n, y, y));
    for (size_t i = 0; i < n; i++)
      w->direction[i] *= scale;
  }
  for (int k = pairs - 1; k >= 0; k--) {
    size_t at = (size_t)((newest - k + PAIRS) % PAIRS);
    double beta = w->inner[at] * bwi_dot(n, w->turned + at * n, w->direction);
    for (size_t i = 0; i < n; i++)
      w->direction[i] += (alpha[at] - beta) * w->moved[at * n + i];
  }
}

/* Descend from patch->x for at most `max` steps, or until the smallest D exceeds `enough`. */
static bw_status descend(bw_context *context, minimiser *m, workspace *w, int max, double enough,
                         double *reached) {
  bwi_patch *p = m->patch;
  size_t n = 3 * (size_t)p->free_count;
  int pairs = 0, newest = PAIRS - 1;
  bw_status status = BW_OK;
  double now = energy(m, p->x, w->gradient);
  for (int step = 0; step < max && isfinite(now) && m->lowest < enough; step++) {
    BW_TRY(bw_check_cancel(context));
    p->iterations++;
    find_direction(w, n, pairs, newest);
    double fall = bwi_dot(n, w->direction, w->gradient);
    if (!(fall < 0)) { /* the pairs are of no use here: begin again */
      if (pairs == 0)
        break;
      pairs = 0;
      continue;
    }
    double size = fmin(pairs ? 1 : INFINITY, longest_step(p, w->direction));
    if (!isfinite(size))
      break;
    double next = INFINITY, before = now;
    int trial = 0;
    for (; trial < MAX_TRIALS; trial++, size *= 0.5) {
      for (size_t i = 0; i < n; i++)
        w->trial[i] = p->x[i] + size * w->direction[i];
      next = energy(m, w->trial, w->trial_gradient);
      if (next <= now + 1e-4 * size * fall)
        break;
    }
    if (trial == MAX_TRIALS) {
      if (pairs == 0)
        break;
      pairs = 0;
      energy(m, p->x, w->gradient);
      continue;
    }
    newest = (newest + 1) % PAIRS;
    double *moved = w->moved + (size_t)newest * n, *turned = w->turned + (size_t)newest * n;
    for (size_t i = 0; i < n; i++) {
      moved[i] = w->trial[i] - p->x[i];
      turned[i] = w->trial_gradient[i] - w->gradient[i];
    }
    double inner = bwi_dot(n, moved, turned);
    if (inner > 1e-12 * sqrt(bwi_dot(n, moved, moved) * bwi_dot(n, turned, turned))) {
      w->inner[newest] = 1 / inner;
      pairs = pairs < PAIRS ? pairs + 1 : PAIRS;
    } else {
      newest = (newest + PAIRS - 1) % PAIRS;
      if (pairs == PAIRS) /* its oldest pair was written over */
        pairs--;
    }
    memcpy(p->x, w->trial, n * sizeof *p->x);
    memcpy(w->gradient, w->trial_gradient, n * sizeof *p->x);
    now = next;
    if (before - now < 1e-5 * fabs(before))
      break;
  }
  *reached = now;
done:
  return status;
}

bw_status bwi_patch_untangle(bw_context *context, bwi_patch *patch, bool *done) {
  enum { ROUNDS = 60, MAX_IDLE = 8 };
  minimiser m = {.patch = patch};
  workspace w;
  bw_status status = workspace_create(context, 3 * (size_t)patch->free_count, &w);
  if (status != BW_OK)
    return status;
  double reached, best = -INFINITY;
  int idle = 0;
  *done = bwi_patch_quality(patch) > 0;
  if (!*done)
    energy(&m, patch->x, w.gradient); /* for m.lowest; the value does not matter */
  for (int round = 0; round < ROUNDS && !*done && isfinite(m.lowest); round++) {
    m.epsilon = sqrt(1e-6 + 0.04 * fmin(0, m.lowest) * fmin(0, m.lowest));
    BW_TRY(descend(context, &m, &w, 25, 0.02, &reached));
    *done = bwi_patch_quality(patch) > 0;
    energy(&m, patch->x, w.gradient);
    if (m.lowest > best + 1e-3 * fabs(best)) {
      best = m.lowest;
      idle = 0;
    } else if (++idle == MAX_IDLE) {
      break;
    }
  }
done:
  bw_free(w.block);
  return status;
}

bw_status bwi_patch_smooth(bw_context *context, bwi_patch *patch) {
  minimiser m = {.patch = patch, .smoothing = true};
  size_t n = 3 * (size_t)patch->free_count;
  double reached, before = bwi_patch_quality(patch);
  workspace w;
  double *kept = BW_NEW(context, double, n);
  if (!kept)
    return BW_MEMORY;
  bw_status status = workspace_create(context, n, &w);
  if (status != BW_OK) {
    bw_free(kept);
    return status;
  }
  for (int sweep = 0; sweep < 4; sweep++) {
    memcpy(kept, patch->x, n * sizeof *kept);
    BW_TRY(descend(context, &m, &w, 10, INFINITY, &reached));
    double after = bwi_patch_quality(patch);
    if (!(after > before)) {
      memcpy(patch->x, kept, n * sizeof *kept);
      bwi_patch_quality(patch);
      break;
    }
    if (after < 1.01 * before)
      break;
    before = after;
  }
done:
  bw_free(w.block);
  bw_free(kept);
  return status;
}
