/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear complementarity by principal pivoting in blocks (Judice and Pires 1994), with free
 * unknowns on springs (docs/theory/contact.md). */
#include <math.h>
#include <string.h>

#include "base/blas.h"
#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"

enum { CHANCES = 10 /* changes in blocks that do not lower the number of wrong candidates */ };

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

bw_status bwi_complementarity_solve(bw_context *context, bwi_complementarity *problem) {
  bw_status status = BW_OK;
  int count = problem->count, m = problem->motions, best = count + 1, chances = CHANCES;
  pivoting v = {.problem = problem};
  v.member = BW_NEW(context, int, count);
  v.factor = BW_NEW(context, double, (int64_t)count *count);
  v.reduced = BW_NEW(context, double, (int64_t)(m + 1) * count);
  v.matrix = BW_NEW(context, double, (int64_t)m *m);
  bwi_blas_enter();
  BW_TRY_MEMORY(v.member && v.factor && v.reduced && v.matrix);
  for (int64_t step = 0;; step++) {
    int wrong = 0, last = -1;
    double largest = 0;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(solve_active(context, &v));
    for (int i = 0; i < count; i++)
      largest = fmax(largest, fabs(problem->p[i]));
    for (int i = 0; i < count; i++)
      if (problem->active[i] ? problem->p[i] < -rounding * largest
                             : problem->w[i] < -problem->slack[i]) {
        wrong++;
        last = i;
      }
    if (wrong == 0)
      break;
    if (step > 100 + 20 * (int64_t)count)
      BW_TRY(bw_fail(context, BW_CONVERGENCE,
                     "the active set of contact does not come to an end: %d of %d candidates keep "
                     "changing",
                     wrong, count));
    bool all = wrong < best || chances-- > 0;
    if (wrong < best) {
      best = wrong;
      chances = CHANCES;
    }
    for (int i = 0; i < count; i++)
      if ((all || i == last) && (problem->active[i] ? problem->p[i] < -rounding * largest
                                                    : problem->w[i] < -problem->slack[i])) {
        problem->active[i] = !problem->active[i];
        problem->changes++;
      }
  }
  for (int i = 0; i < count; i++)
    problem->p[i] = fmax(problem->p[i], 0);
done:
  bwi_blas_leave();
  bw_free(v.member);
  bw_free(v.factor);
  bw_free(v.reduced);
  bw_free(v.matrix);
  return status;
}
