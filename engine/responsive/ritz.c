/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of K x = lambda M x by preconditioned iteration (Knyazev's LOBPCG): in
 * every round the Rayleigh-Ritz values of span [X, B R, P], X the block, R its residuals, P what
 * the last round added. With B = K^-1 it converges at least as fast as inverse iteration on the
 * block; with the factor of a former shape it still does, only slower, where inverse iteration
 * would need an inner iteration.
 *
 * The measure of convergence is sqrt(r . B r / lambda), the error of x in the energy norm where B
 * is near K^-1; that of lambda is its square. The residual's own norm would show the rounding of K
 * x instead, 1e-7 in a thin plate.
 *
 * The vectors beyond the wanted ones are guards: that they are in the basis widens the gap that
 * decides the convergence of the wanted ones, for which their being right to a tenth is enough.
 * Once they have it they are only combined, no more improved: most of the time is in B and K.
 *
 * The start is the best of the span of the vectors given and, where there are any, of further ones:
 * the modes of former frames of a drag, so that what the last frames changed may go on.
 *
 * Invariants: the basis is M-orthonormal and M-orthogonal to the rigid-body motions; `stiff` and
 * `heavy` are K and M times the basis, carried along as combinations. */
#include <math.h>
#include <string.h>

#include "linear/blas.h"
#include "responsive/plate.h"

typedef struct workspace {
  const bwi_ritz *problem;
  int count;                              /* of basis vectors */
  double *basis, *stiff, *heavy;          /* 3 block x size */
  double *next, *next_stiff, *next_heavy; /* 2 block x size: X and P of the next round */
  double *projected, *theta;              /* (3 block)^2, 3 block */
  double *scratch;                        /* for dsyev */
} workspace;

static void workspace_clear(workspace *w) {
  bw_free(w->basis);
  bw_free(w->stiff);
  bw_free(w->heavy);
  bw_free(w->next);
  bw_free(w->next_stiff);
  bw_free(w->next_heavy);
  bw_free(w->projected);
  bw_free(w->theta);
  bw_free(w->scratch);
}

static bw_status workspace_create(bw_context *context, const bwi_ritz *problem, workspace *w) {
  int64_t n = problem->size, max = 3 * problem->block;
  *w = (workspace){.problem = problem};
  w->basis = BW_NEW(context, double, max *n);
  w->stiff = BW_NEW(context, double, max *n);
  w->heavy = BW_NEW(context, double, max *n);
  w->next = BW_NEW(context, double, 2 * problem->block * n);
  w->next_stiff = BW_NEW(context, double, 2 * problem->block * n);
  w->next_heavy = BW_NEW(context, double, 2 * problem->block * n);
  w->projected = BW_NEW(context, double, max *max);
  w->theta = BW_NEW(context, double, max);
  w->scratch = BW_NEW(context, double, 8 * max);
  bool made = w->basis && w->stiff && w->heavy && w->next && w->next_stiff && w->next_heavy &&
              w->projected && w->theta && w->scratch;
  return made ? BW_OK : BW_MEMORY;
}

/* Error of a guard, in the energy norm, that is small enough. */
static const double GUARDED = 0.1;

/* Relative change of a value that counts as none. */
static const double STILL = 1e-13;

/* Eight sums side by side, for the vector registers; the order is fixed. */
static double dot(const double *a, const double *b, int64_t n) {
  double part[8] = {0}, sum = 0;
  int64_t i = 0;
  for (; i + 8 <= n; i += 8)
    for (int k = 0; k < 8; k++)
      part[k] += a[i + k] * b[i + k];
  for (; i < n; i++)
    sum += a[i] * b[i];
  for (int k = 0; k < 8; k++)
    sum += part[k];
  return sum;
}

static void subtract(double factor, const double *restrict a, double *restrict from, int64_t n) {
  for (int64_t i = 0; i < n; i++)
    from[i] -= factor * a[i];
}

/* Take basis[count] in, orthonormalised; leave it out where it depends on the others. Its images
 * under M and K go through the same combinations; K times a new vector is taken at the end, since
 * what K makes of rigid-body motions is rounding, and large beside the lowest modes of a thin
 * plate. `known`: the images are there already. */
static bw_status admit(workspace *w, bool known, bool *taken) {
  const bwi_ritz *p = w->problem;
  bw_status status = BW_OK;
  int64_t n = p->size;
  double *x = w->basis + w->count * n, *m = w->heavy + w->count * n, *s = w->stiff + w->count * n;
  *taken = false;
  if (!known)
    BW_TRY(p->mass(p->data, x, m));
  for (int round = 0; round < 3; round++) {
    double before = dot(x, m, n);
    if (!(before > 0) || !isfinite(before))
      goto done;
    for (int k = 0; k < p->rigid_count; k++) {
      double along = dot(p->mass_rigid + k * n, x, n);
      subtract(along, p->rigid + k * n, x, n);
      subtract(along, p->mass_rigid + k * n, m, n);
    }
    for (int k = 0; k < w->count; k++) {
      double along = dot(w->heavy + k * n, x, n);
      subtract(along, w->basis + k * n, x, n);
      subtract(along, w->heavy + k * n, m, n);
      if (known)
        subtract(along, w->stiff + k * n, s, n);
    }
    double size = dot(x, m, n);
    if (!(size > 1e-20 * before))
      goto done;
    double scale = 1 / sqrt(size);
    for (int64_t i = 0; i < n; i++) {
      x[i] *= scale;
      m[i] *= scale;
      if (known)
        s[i] *= scale;
    }
    if (size > 0.25 * before)
      break; /* little was taken off: what is left is exact enough */
  }
  if (!known)
    BW_TRY(p->stiffness(p->data, x, s));
  w->count++;
  *taken = true;
done:
  return status;
}

/* Columns of `from` combined by the projected eigenvectors from row `first` on. */
static void combine(const workspace *w, const double *from, int first, int columns, double *to) {
  int64_t n = w->problem->size;
  for (int c = 0; c < columns; c++) {
    double *result = to + c * n;
    memset(result, 0, (size_t)n * sizeof *result);
    for (int k = first; k < w->count; k++)
      subtract(-w->projected[(int64_t)c * w->count + k], from + k * n, result, n);
  }
}

/* Ritz values and vectors of the basis: theta ascending, vectors in the rows of `projected`. */
static bw_status project(bw_context *context, workspace *w) {
  int64_t n = w->problem->size;
  int m = w->count, capacity = 8 * 3 * w->problem->block, info = 0;
  for (int i = 0; i < m; i++)
    for (int j = 0; j <= i; j++)
      w->projected[i * m + j] = w->projected[j * m + i] =
          dot(w->basis + i * n, w->stiff + j * n, n);
  bwi_blas_enter();
  dsyev_("V", "U", &m, w->projected, &m, w->theta, w->scratch, &capacity, &info);
  bwi_blas_leave();
  if (info != 0)
    return bw_fail(context, BW_INTERNAL, "the projected eigenproblem of %d vectors failed (%d)", m,
                   info);
  return BW_OK;
}

/* X and, of the first `live`, P of the next round from the basis, whose first `block` vectors were
 * X; basis = X. */
static void advance(workspace *w, int block, int live, int *directions) {
  int64_t n = w->problem->size;
  int old = block < w->count ? block : w->count;
  size_t bytes = (size_t)n * sizeof(double);
  combine(w, w->basis, 0, block, w->next);
  combine(w, w->stiff, 0, block, w->next_stiff);
  combine(w, w->heavy, 0, block, w->next_heavy);
  *directions = w->count > old ? live : 0;
  if (*directions) {
    combine(w, w->basis, old, live, w->next + block * n);
    combine(w, w->stiff, old, live, w->next_stiff + block * n);
    combine(w, w->heavy, old, live, w->next_heavy + block * n);
  }
  memcpy(w->basis, w->next, bytes * (size_t)block);
  memcpy(w->stiff, w->next_stiff, bytes * (size_t)block);
  memcpy(w->heavy, w->next_heavy, bytes * (size_t)block);
  w->count = block;
}

static bw_status start(bw_context *context, workspace *w, const double *vector) {
  const bwi_ritz *p = w->problem;
  bw_status status = BW_OK;
  bw_random random;
  bw_random_seed(&random, 1);
  for (int k = 0; k < p->block; k++) {
    bool taken = false;
    for (int attempt = 0; !taken; attempt++) {
      double *x = w->basis + w->count * p->size;
      if (attempt == 0)
        memcpy(x, vector + k * p->size, (size_t)p->size * sizeof *x);
      else
        for (int64_t i = 0; i < p->size; i++)
          x[i] = bw_random_uniform(&random) - 0.5;
      BW_TRY(admit(w, false, &taken));
      if (attempt == 8 && !taken) {
        status =
            bw_fail(context, BW_INVALID,
                    "%d eigenpairs were requested of a problem with fewer elastic ones", p->wanted);
        goto done;
      }
    }
  }
  for (int k = 0; k < p->more_count; k++) {
    bool taken;
    memcpy(w->basis + w->count * p->size, p->more + k * p->size, (size_t)p->size * sizeof *p->more);
    BW_TRY(admit(w, false, &taken));
  }
  BW_TRY(project(context, w));
  int directions;
  advance(w, p->block, 0, &directions);
done:
  return status;
}

/* Whether standing still means rounding, not slowness. */
static bool close_enough(const bwi_ritz *p, const double *residual) {
  for (int k = 0; k < p->wanted; k++)
    if (!(residual[k] <= fmax(p->tolerance, 1e-4)))
      return false;
  return true;
}

bw_status bwi_ritz_solve(bw_context *context, const bwi_ritz *p, double *vector, double *value,
                         double *residual, int *iterations) {
  bw_status status = BW_OK;
  workspace w;
  int64_t n = p->size;
  int block = p->block, live = block, directions = 0, still = 0;
  double *r = BW_NEW(context, double, n), *z = BW_NEW(context, double, block *n);
  BW_TRY(workspace_create(context, p, &w));
  if (!r || !z) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(start(context, &w, vector));
  for (int round = 0;; round++) {
    BW_TRY(bw_check_cancel(context));
    bool done_all = true, moved = round == 0, guarded = true;
    for (int k = live; k < block; k++)
      value[k] = w.theta[k];
    for (int k = 0; k < live; k++) {
      moved |= k < p->wanted && fabs(w.theta[k] - value[k]) > STILL * fabs(w.theta[k]);
      value[k] = w.theta[k];
      for (int64_t i = 0; i < n; i++)
        r[i] = w.stiff[k * n + i] - value[k] * w.heavy[k * n + i];
      BW_TRY(p->precondition(p->data, r, z + k * n));
      double energy = dot(r, z + k * n, n);
      residual[k] = sqrt(fmax(energy, 0) / fabs(value[k]));
      done_all &= k >= p->wanted || residual[k] <= p->tolerance;
      guarded &= k < p->wanted || residual[k] <= GUARDED;
    }
    *iterations = round;
    still = moved ? 0 : still + 1;
    if (done_all || (still == 3 && close_enough(p, residual)))
      break;
    if (round == p->limit) {
      int worst = 0;
      for (int k = 1; k < p->wanted; k++)
        worst = residual[k] > residual[worst] ? k : worst;
      status =
          bw_fail(context, BW_CONVERGENCE,
                  "mode %d has a relative residual of %g after %d iterations; %g was requested",
                  worst + 1, residual[worst], round, p->tolerance);
      bw_detail_number(context, "residual", residual[worst]);
      goto done;
    }
    for (int k = 0; k < live; k++) {
      bool taken;
      memcpy(w.basis + w.count * n, z + k * n, (size_t)n * sizeof *z);
      if (residual[k] > 0.1 * p->tolerance)
        BW_TRY(admit(&w, false, &taken));
    }
    for (int k = 0; k < directions; k++) {
      bool taken;
      memcpy(w.basis + w.count * n, w.next + (block + k) * n, (size_t)n * sizeof *z);
      memcpy(w.stiff + w.count * n, w.next_stiff + (block + k) * n, (size_t)n * sizeof *z);
      memcpy(w.heavy + w.count * n, w.next_heavy + (block + k) * n, (size_t)n * sizeof *z);
      BW_TRY(admit(&w, true, &taken));
    }
    BW_TRY(project(context, &w));
    live = guarded ? p->wanted : live;
    advance(&w, block, live, &directions);
  }
  memcpy(vector, w.basis, (size_t)(block * n) * sizeof *vector);
done:
  workspace_clear(&w);
  bw_free(r);
  bw_free(z);
  return status;
}
