/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear complementarity by principal pivoting in blocks (Judice and Pires 1994), or where that
 * goes round, by an active set that lowers the energy (Lawson and Hanson 1974), with free unknowns
 * on springs (docs/theory/contact.md). */
#include <math.h>
#include <string.h>

#include "base/blas.h"
#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"

enum {
  CHANCES = 10 /* changes in blocks that do not lower the number of wrong candidates, in a row */
};

/* Of the largest diagonal entry: redundant candidates are singular. */
static const double shift = 1e-13;
/* Of the largest pressure: what is below counts as none. */
static const double rounding = 1e-11;

typedef struct pivoting {
  bwi_complementarity *problem;
  int *member;     /* (count) the active ones */
  double *factor;  /* (count x count) of S_AA */
  double *reduced; /* ((motions + 1) x count) L^-1 of the columns of E_A, then of q_A */
  double *matrix;  /* (motions x motions) */
  double *from;    /* (count) pressures, none negative, from which the energy falls */
} pivoting;

/* p and a on the active set. */
static bw_status solve_active(bw_context *context, pivoting *v) {
  bwi_complementarity *problem = v->problem;
  int n = 0, m = problem->motions, info = 0, count = problem->count;
  double largest = 0;
  for (int i = 0; i < count; i++)
    if (problem->active[i]) {
      v->member[n++] = i;
      largest = fmax(largest, problem->s[(size_t)i * (size_t)count + (size_t)i]);
    }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j <= i; j++)
      v->factor[(size_t)i * (size_t)n + (size_t)j] =
          problem->s[(size_t)v->member[i] * (size_t)count + (size_t)v->member[j]];
    v->factor[(size_t)i * (size_t)n + (size_t)i] += shift * largest;
  }
  if (n > 0) /* the upper triangle by columns is the lower one by rows */
    dpotrf_("U", &n, v->factor, &n, &info);
  if (info != 0)
    return bw_fail(context, BW_SINGULAR,
                   "the compliance of %d candidates of contact is not positive definite: parts of "
                   "the body are nearly without stiffness, or nearly without a support",
                   n);
  for (int k = 0; k <= m; k++) {
    double *column = v->reduced + (size_t)k * (size_t)n;
    for (int i = 0; i < n; i++)
      column[i] = k < m ? problem->e[(size_t)v->member[i] * (size_t)m + (size_t)k]
                        : problem->q[v->member[i]];
    bwi_lower_solve(n, v->factor, column);
  }
  double *right = v->reduced + (size_t)m * (size_t)n;
  for (int k = 0; k < m; k++) {
    const double *column = v->reduced + (size_t)k * (size_t)n;
    for (int l = 0; l < m; l++) {
      double entry = bwi_dot(n, column, v->reduced + (size_t)l * (size_t)n);
      problem->h[(int64_t)k * m + l] = entry;
      v->matrix[(int64_t)k * m + l] = entry + (k == l ? problem->epsilon : 0);
    }
    problem->a[k] =
        problem->load[k] + problem->epsilon * problem->centre[k] - bwi_dot(n, column, right);
  }
  if (!bwi_cholesky(m, v->matrix, 0))
    return bw_fail(context, BW_SINGULAR, "the motions of bodies in contact are not finite");
  bwi_lower_solve(m, v->matrix, problem->a);
  bwi_upper_solve(m, v->matrix, problem->a);
  for (int k = 0; k < m; k++)
    for (int i = 0; i < n; i++)
      right[i] += v->reduced[(size_t)k * (size_t)n + (size_t)i] * problem->a[k];
  bwi_upper_solve(n, v->factor, right);
  memset(problem->p, 0, (size_t)count * sizeof *problem->p);
  for (int i = 0; i < n; i++)
    problem->p[v->member[i]] = -right[i];
  for (int i = 0; i < count; i++) {
    const double *row = problem->s + (size_t)i * (size_t)count;
    double w = problem->q[i] + bwi_dot(m, problem->e + (size_t)i * (size_t)m, problem->a);
    for (int j = 0; j < n; j++)
      w += row[v->member[j]] * problem->p[v->member[j]];
    problem->w[i] = problem->active[i] ? 0 : w;
  }
  return BW_OK;
}

static double largest_pressure(const bwi_complementarity *problem) {
  double largest = 0;
  for (int i = 0; i < problem->count; i++)
    largest = fmax(largest, fabs(problem->p[i]));
  return largest;
}

static bool is_wrong(const bwi_complementarity *problem, int i, double largest) {
  return problem->active[i] ? problem->p[i] < -rounding * largest
                            : problem->w[i] < -problem->slack[i];
}

static void change(bwi_complementarity *problem, int i) {
  problem->active[i] = !problem->active[i];
  problem->changes++;
}

/* Pressures go from `from` towards those of the active set until the first of them is none, which
 * leaves it. Whether one did. */
static bool leave_first(pivoting *v) {
  bwi_complementarity *problem = v->problem;
  double part = 1, largest = largest_pressure(problem);
  int first = -1;
  for (int i = 0; i < problem->count; i++) {
    if (!problem->active[i] || !is_wrong(problem, i, largest))
      continue;
    double to = v->from[i] / (v->from[i] - problem->p[i]);
    if (first < 0 || to < part) {
      part = to;
      first = i;
    }
  }
  for (int i = 0; i < problem->count; i++)
    v->from[i] = fmax(0, v->from[i] + part * (problem->p[i] - v->from[i]));
  if (first < 0)
    return false;
  v->from[first] = 0;
  change(problem, first);
  return true;
}

/* Pivoting one candidate at a time, from the pressures at hand that are not negative: the deepest
 * one enters, and each step lowers the energy, so that no active set comes back. */
static bw_status descend(bw_context *context, pivoting *v) {
  bw_status status = BW_OK;
  bwi_complementarity *problem = v->problem;
  int count = problem->count;
  for (int i = 0; i < count; i++) {
    v->from[i] = problem->active[i] ? fmax(problem->p[i], 0) : 0;
    problem->active[i] = v->from[i] > 0;
  }
  for (int64_t step = 0;; step++) {
    int deepest = -1;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(solve_active(context, v));
    if (step > 100 + 20 * (int64_t)count)
      BW_TRY(bw_fail(context, BW_CONVERGENCE,
                     "rounding keeps the active set of contact changing, of %d candidates", count));
    if (leave_first(v))
      continue;
    for (int i = 0; i < count; i++)
      if (!problem->active[i] && is_wrong(problem, i, 0) &&
          (deepest < 0 || problem->w[i] < problem->w[deepest]))
        deepest = i;
    if (deepest < 0)
      break;
    change(problem, deepest);
  }
done:
  return status;
}

bw_status bwi_complementarity_solve(bw_context *context, bwi_complementarity *problem) {
  bw_status status = BW_OK;
  int count = problem->count, m = problem->motions, best = count + 1, chances = CHANCES;
  pivoting v = {.problem = problem};
  v.member = BW_NEW(context, int, count);
  v.factor = BW_NEW(context, double, (int64_t)count *count);
  v.reduced = BW_NEW(context, double, (int64_t)(m + 1) * count);
  v.matrix = BW_NEW(context, double, (int64_t)m *m);
  v.from = BW_NEW(context, double, count);
  bwi_blas_enter();
  BW_TRY_MEMORY(v.member && v.factor && v.reduced && v.matrix && v.from);
  for (;;) {
    int wrong = 0;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(solve_active(context, &v));
    double largest = largest_pressure(problem);
    for (int i = 0; i < count; i++)
      wrong += is_wrong(problem, i, largest);
    if (wrong == 0)
      break;
    if (wrong < best) {
      best = wrong;
      chances = CHANCES;
    } else if (chances-- == 0) {
      BW_TRY(descend(context, &v));
      break;
    }
    for (int i = 0; i < count; i++)
      if (is_wrong(problem, i, largest))
        change(problem, i);
  }
  for (int i = 0; i < count; i++)
    problem->p[i] = fmax(problem->p[i], 0);
done:
  bwi_blas_leave();
  bw_free(v.member);
  bw_free(v.factor);
  bw_free(v.reduced);
  bw_free(v.matrix);
  bw_free(v.from);
  return status;
}
