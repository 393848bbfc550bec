/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The point of a polyhedron nearest to the origin by NLopt's SLSQP: least 1/2 |z|^2 with
 * a_i . z <= beta_i. SLSQP starts with the identity for a Hessian, which here is the Hessian: its
 * first step is the solution.
 *
 * Its answer is then checked: the multipliers of the rows that are active come from non-negative
 * least squares, the rows with positive ones are made exactly active, and a point that fulfils all
 * rows with them is the optimum, because the linear program is strictly convex. */
#include "qp/nearest_point.h"

#include <math.h>
#include <nlopt.h>
#include <string.h>

static const double row_tolerance = 1e-9; /* a row holds, relative to 1 + |z| */
static const double near_active = 1e-6;   /* a row may be active */
static const double dependent = 1e-11;    /* pivot of unit vectors below which they depend */
enum { EVALUATIONS = 200 };

/* ---- SLSQP ----------------------------------------------------------------------------------- */

static double half_square(unsigned n, const double *z, double *gradient, void *data) {
  double sum = 0;
  (void)data;
  for (unsigned i = 0; i < n; i++) {
    sum += z[i] * z[i];
    if (gradient)
      gradient[i] = z[i];
  }
  return sum / 2;
}

static void rows_of(unsigned m, double *value, unsigned n, const double *z, double *gradient,
                    void *data) {
  const bwi_polyhedron *p = (const bwi_polyhedron *)data;
  for (unsigned i = 0; i < m; i++) {
    value[i] = -p->beta[i];
    for (unsigned j = 0; j < n; j++)
      value[i] += p->a[i * n + j] * z[j];
  }
  if (gradient)
    memcpy(gradient, p->a, (size_t)m * n * sizeof *gradient);
}

/* z from 0. *word says what NLopt said; its answer is for the caller to check. */
static bw_status slsqp(const bwi_polyhedron *p, double *z, const char **word) {
  bw_status status = BW_OK;
  double min;
  nlopt_opt opt = nlopt_create(NLOPT_LD_SLSQP, (unsigned)p->n);
  double *tolerance = BW_NEW0(p->context, double, p->rows);
  memset(z, 0, (size_t)p->n * sizeof *z);
  *word = "SUCCESS";
  if (!opt || !tolerance)
    BW_TRY(
        bw_fail(p->context, BW_MEMORY, "no memory for a quadratic program of %d unknowns", p->n));
  for (int i = 0; i < p->rows; i++)
    tolerance[i] = row_tolerance;
  nlopt_result result = nlopt_set_min_objective(opt, half_square, NULL);
  if (result > 0)
    result =
        nlopt_add_inequality_mconstraint(opt, (unsigned)p->rows, rows_of, (void *)p, tolerance);
  if (result > 0)
    result = nlopt_set_xtol_rel(opt, 1e-13);
  if (result > 0)
    result = nlopt_set_maxeval(opt, EVALUATIONS);
  if (result > 0)
    result = nlopt_optimize(opt, z, &min);
  *word = nlopt_result_to_string(result);
  if (result == NLOPT_OUT_OF_MEMORY)
    status =
        bw_fail(p->context, BW_MEMORY, "no memory for a quadratic program of %d unknowns", p->n);
  else if (result == NLOPT_INVALID_ARGS)
    status = bw_fail(p->context, BW_INTERNAL, "NLopt rejected a quadratic program: %s", *word);
  for (int j = 0; j < p->n; j++)
    if (!isfinite(z[j]))
      z[j] = 0;
done:
  if (opt)
    nlopt_destroy(opt);
  bw_free(tolerance);
  return status;
}

/* ---- judging --------------------------------------------------------------------------------- */

static double worst_row(const bwi_polyhedron *p, const double *z) {
  double worst = 0;
  for (int i = 0; i < p->rows; i++)
    worst = fmax(worst, bwi_dot(p->n, p->a + i * p->n, z) - p->beta[i]);
  return worst;
}

/* Rows of the active set, and workspace to solve with them. */
typedef struct active_rows {
  int count;
  int *row;     /* at most n, independent */
  double *gram; /* n x n */
  double *mu;   /* n */
} active_rows;

/* mu so that sum_i mu_i a_i = -z in the sense of least squares (target NULL), or so that the point
 * -sum_i mu_i a_i lies on all the rows. False when they depend on each other. */
static bool multipliers(const bwi_polyhedron *p, const double *z, active_rows *active) {
  int m = active->count;
  for (int i = 0; i < m; i++) {
    const double *ai = p->a + active->row[i] * p->n;
    for (int j = 0; j <= i; j++)
      active->gram[i * m + j] = bwi_dot(p->n, ai, p->a + active->row[j] * p->n);
    active->mu[i] = z ? -bwi_dot(p->n, ai, z) : -p->beta[active->row[i]];
  }
  if (!bwi_cholesky(m, active->gram, dependent))
    return false;
  bwi_lower_solve(m, active->gram, active->mu);
  bwi_upper_solve(m, active->gram, active->mu);
  return true;
}

/* Non-negative least squares |z + sum_i mu_i a_i| over the rows that may be active at z (Lawson and
 * Hanson): leaves the rows with positive multipliers in `active`, and the multipliers of all rows
 * in mu. `left_out` and `rest` are room for `rows` and n entries. */
static void least_squares(const bwi_polyhedron *p, const double *z, active_rows *active, double *mu,
                          bool *left_out, double *rest) {
  int n = p->n;
  double size = sqrt(bwi_dot(n, z, z));
  active->count = 0;
  for (int i = 0; i < p->rows; i++) {
    mu[i] = 0;
    left_out[i] = bwi_dot(n, p->a + i * n, z) - p->beta[i] < -near_active * (1 + size);
  }
  for (int step = 0; step < 4 * p->rows && active->count < n; step++) {
    int best = -1;
    double max = 1e-12 * size;
    memcpy(rest, z, (size_t)n * sizeof *rest);
    for (int i = 0; i < active->count; i++)
      for (int j = 0; j < n; j++)
        rest[j] += mu[active->row[i]] * p->a[active->row[i] * n + j];
    for (int i = 0; i < p->rows; i++) {
      double gain = mu[i] > 0 || left_out[i] ? 0 : -bwi_dot(n, p->a + i * n, rest);
      if (gain > max) {
        best = i;
        max = gain;
      }
    }
    if (best < 0)
      return;
    active->row[active->count++] = best;
    if (!multipliers(p, z, active)) {
      active->count--;
      left_out[best] = true;
      continue;
    }
    /* Towards the new multipliers until one would turn negative; without that one; again. */
    for (;;) {
      int blocking = -1;
      double way = 1;
      for (int i = 0; i < active->count; i++) {
        double old = mu[active->row[i]];
        double reach = active->mu[i] > 0 ? 1 : old > 0 ? old / (old - active->mu[i]) : 0;
        if (reach < way) {
          way = reach;
          blocking = i;
        }
      }
      for (int i = 0; i < active->count; i++)
        mu[active->row[i]] += way * (active->mu[i] - mu[active->row[i]]);
      if (blocking < 0)
        break;
      mu[active->row[blocking]] = 0;
      left_out[best] = left_out[best] || active->row[blocking] == best;
      active->count--;
      for (int i = blocking; i < active->count; i++)
        active->row[i] = active->row[i + 1];
      if (!multipliers(p, z, active))
        break;
    }
  }
}

/* The point nearest to the origin, and the rows' multipliers: z = -sum_i mu_i a_i. *found is false
 * when SLSQP's answer lies outside; *word is what it said. */
bw_status bwi_nearest_point(const bwi_polyhedron *p, double *z, double *mu, bool *found,
                            const char **word) {
  bw_status status = BW_OK;
  size_t n = (size_t)p->n;
  active_rows active = {.row = BW_NEW(p->context, int, n),
                        .gram = BW_NEW(p->context, double, n *n),
                        .mu = BW_NEW(p->context, double, n)};
  double *exact = BW_NEW(p->context, double, n);
  bool *left_out = BW_NEW(p->context, bool, p->rows);
  BW_TRY_MEMORY(active.row && active.gram && active.mu && exact && left_out);
  BW_TRY(slsqp(p, z, word));
  least_squares(p, z, &active, mu, left_out, exact);
  double allowed = row_tolerance * (1 + sqrt(bwi_dot(p->n, z, z)));
  if (multipliers(p, NULL, &active)) {
    bool optimal = true;
    memset(exact, 0, n * sizeof *exact);
    for (int i = 0; i < active.count; i++) {
      optimal = optimal && active.mu[i] >= 0;
      for (int j = 0; j < p->n; j++)
        exact[j] -= active.mu[i] * p->a[active.row[i] * p->n + j];
    }
    if (optimal && worst_row(p, exact) <= allowed) {
      memcpy(z, exact, n * sizeof *z);
      for (int i = 0; i < active.count; i++)
        mu[active.row[i]] = active.mu[i];
    }
  }
  *found = worst_row(p, z) <= 100 * allowed;
done:
  bw_free(active.row);
  bw_free(active.gram);
  bw_free(active.mu);
  bw_free(exact);
  bw_free(left_out);
  return status;
}
