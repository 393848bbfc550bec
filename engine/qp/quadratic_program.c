/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Convex quadratic programs, small and dense.
 *
 * With H = L L^T, y = L^T x and c the point where the objective is least of all, the quadratic
 * program asks for the point of a polyhedron nearest to c. It is solved as such (nearest_point.h),
 * in z = (y - c) / size with `size` the distance of the farthest row that c violates; bounds are
 * rows like all others. */
#include "barwright/qp.h"
#include "qp/nearest_point.h"

#include <math.h>
#include <string.h>

enum { PROXIMAL_STEPS = 60 };

typedef struct program {
  bw_context *context;
  int n, m;
  const double *a, *b, *min, *max; /* as given */
  double *l;                       /* Cholesky factor of H */
  double *centre;                  /* x at c */
  double size;                     /* of z */
  bwi_polyhedron p;                /* rows, then bounds; what is always fulfilled left out */
  int *of;      /* p.rows: row 0..m-1 it stands for, m + j: x_j <= max, m + n + j: x_j >= min */
  double *norm; /* p.rows: of its a before scaling */
} program;

static void linear_program_clear(program *q) {
  bw_free(q->l);
  bw_free(q->centre);
  bw_free(q->p.a);
  bw_free(q->p.beta);
  bw_free(q->of);
  bw_free(q->norm);
}

static bw_status check_input(bw_context *context, int n, const double *H, const double *g, int m,
                             const double *A, const double *b, const double *min,
                             const double *max) {
  const char *bad = NULL;
  if (n < 1 || m < 0)
    return bw_fail(context, BW_INVALID, "a quadratic program of %d unknowns and %d rows", n, m);
  for (int i = 0; i < n * n && !bad; i++)
    bad = isfinite(H[i]) ? NULL : "matrix";
  for (int i = 0; i < n && !bad; i++)
    bad = !isfinite(g[i]) ? "gradient" : isnan(min[i]) || isnan(max[i]) ? "bounds" : NULL;
  for (int i = 0; i < n * m && !bad; i++)
    bad = isfinite(A[i]) ? NULL : "rows";
  for (int i = 0; i < m && !bad; i++)
    bad = isfinite(b[i]) ? NULL : "right-hand side";
  if (bad)
    return bw_fail(context, BW_INVALID,
                   "the %s of a quadratic program has an entry that is not finite", bad);
  for (int i = 0; i < n; i++)
    if (!(min[i] <= max[i]) || min[i] == INFINITY || max[i] == -INFINITY)
      return bw_fail(context, BW_INVALID,
                     "the bounds of unknown %d of a quadratic program are %g and %g", i + 1, min[i],
                     max[i]);
  return BW_OK;
}

static void add_row(program *q, int of, double norm, const double *a, double beta) {
  double *to = q->p.a + q->p.rows * q->n;
  for (int j = 0; j < q->n; j++)
    to[j] = a[j] / norm;
  q->p.beta[q->p.rows] = beta / norm;
  q->of[q->p.rows] = of;
  q->norm[q->p.rows++] = norm;
}

/* Everything in y - c; size still 1. */
static bw_status transform(program *q, const double *H, const double *g) {
  int n = q->n;
  size_t rows = (size_t)q->m + 2 * (size_t)n;
  bw_status status = BW_OK;
  double *row = BW_NEW0(q->context, double, n);
  q->l = BW_NEW(q->context, double, (size_t)n *(size_t)n);
  q->centre = BW_NEW(q->context, double, n);
  q->p.a = BW_NEW(q->context, double, rows *(size_t)n);
  q->p.beta = BW_NEW(q->context, double, rows);
  q->of = BW_NEW(q->context, int, rows);
  q->norm = BW_NEW(q->context, double, rows);
  BW_TRY_MEMORY(row && q->l && q->centre && q->p.a && q->p.beta && q->of && q->norm);
  memcpy(q->l, H, (size_t)n * (size_t)n * sizeof *H);
  if (!bwi_cholesky(n, q->l, 1e-14))
    BW_TRY(bw_fail(q->context, BW_INVALID,
                   "the matrix of a quadratic program is not positive definite"));
  for (int i = 0; i < n; i++)
    q->centre[i] = -g[i];
  bwi_lower_solve(n, q->l, q->centre);
  bwi_upper_solve(n, q->l, q->centre);
  for (int i = 0; i < q->m; i++) {
    const double *given = q->a + i * n;
    memcpy(row, given, (size_t)n * sizeof *row);
    bwi_lower_solve(n, q->l, row);
    double norm = sqrt(bwi_dot(n, row, row));
    if (norm > 0)
      add_row(q, i, norm, row, q->b[i] - bwi_dot(n, given, q->centre));
  }
  for (int j = 0; j < n; j++) {
    memset(row, 0, (size_t)n * sizeof *row);
    row[j] = 1;
    bwi_lower_solve(n, q->l, row);
    double norm = sqrt(bwi_dot(n, row, row));
    if (q->max[j] < INFINITY)
      add_row(q, q->m + j, norm, row, q->max[j] - q->centre[j]);
    for (int k = 0; k < n; k++)
      row[k] = -row[k];
    if (q->min[j] > -INFINITY)
      add_row(q, q->m + n + j, norm, row, q->centre[j] - q->min[j]);
  }
done:
  bw_free(row);
  return status;
}

/* x = c + size L^-T z, on the safe side of the bounds. */
static void to_unknowns(const program *q, const double *z, double *x) {
  for (int j = 0; j < q->n; j++)
    x[j] = q->size * z[j];
  bwi_upper_solve(q->n, q->l, x);
  for (int j = 0; j < q->n; j++)
    x[j] = fmin(fmax(q->centre[j] + x[j], q->min[j]), q->max[j]);
}

/* The least t so that all rows of A hold with b + t, within the bounds: proximal steps on the
 * linear program. In units of `unit` t is one more coordinate, and each step is the point of the
 * polyhedron nearest to one that lies far below the last, so that t counts for most; on a linear
 * program such steps end, not only converge. */
static bw_status min_violation(const program *q, double unit, double *t) {
  enum { FAR = 100 };
  int n = q->n + 1, rows = q->p.rows + 1; /* and t >= 0 */
  bw_status status = BW_OK;
  const char *word;
  bool found = true;
  bwi_polyhedron p = {.context = q->context, .n = n};
  double *whole = BW_NEW0(q->context, double, rows);
  double *z = BW_NEW(q->context, double, n), *mu = BW_NEW(q->context, double, rows);
  double *centre = BW_NEW0(q->context, double, n);
  p.a = BW_NEW0(q->context, double, (size_t)rows *(size_t)n);
  p.beta = BW_NEW(q->context, double, rows);
  BW_TRY_MEMORY(whole && z && mu && centre && p.a && p.beta);
  for (int i = 0; i < q->p.rows; i++) {
    double *a = p.a + p.rows * n, slack = q->of[i] < q->m ? unit / (q->norm[i] * q->size) : 0;
    double norm = sqrt(1 + slack * slack);
    for (int j = 0; j < q->n; j++)
      a[j] = q->p.a[i * q->n + j] / norm;
    a[q->n] = -slack / norm;
    whole[p.rows++] = q->p.beta[i] / norm;
  }
  double min = 0; /* of t, by the rows without coefficients */
  for (int i = 0; i < q->m; i++) {
    double size = 0;
    for (int j = 0; j < q->n; j++)
      size = fmax(size, fabs(q->a[i * q->n + j]));
    if (size == 0)
      min = fmax(min, -q->b[i] / unit);
  }
  p.a[p.rows * n + q->n] = -1;
  whole[p.rows++] = -min;
  double last = INFINITY;
  for (int step = 0; step < PROXIMAL_STEPS; step++) {
    BW_TRY(bw_check_cancel(q->context));
    centre[q->n] -= FAR;
    for (int i = 0; i < p.rows; i++)
      p.beta[i] = whole[i] - bwi_dot(n, p.a + i * n, centre);
    bool inside;
    BW_TRY(bwi_nearest_point(&p, z, mu, &inside, &word));
    if (!inside) {
      found = step > 0;
      break;
    }
    for (int j = 0; j < n; j++)
      centre[j] += z[j];
    if (step > 0 && !(centre[q->n] < last - 1e-11 * (1 + fabs(last))))
      break;
    last = centre[q->n];
  }
  if (!found)
    status = bw_fail(q->context, BW_CONVERGENCE,
                     "a quadratic program of %d unknowns and %d rows: the smallest violation of "
                     "its rows was not found (NLopt: %s)",
                     q->n, q->m, word);
  *t = unit * fmax(last, min);
done:
  bw_free(whole);
  bw_free(z);
  bw_free(mu);
  bw_free(centre);
  bw_free(p.a);
  bw_free(p.beta);
  return status;
}

/* Elastic mode: every row is relaxed by the minimum that allows a solution. */
static bw_status elastic(program *q, double *z, double *mu, bool *found, const char **word) {
  bw_status status;
  double unit = 0, way = 0;
  for (int i = 0; i < q->p.rows; i++)
    if (q->of[i] < q->m)
      unit = fmax(unit, q->norm[i] * q->size);
  for (int i = 0; i < q->m && unit == 0; i++)
    unit = fabs(q->b[i]);
  BW_TRY(min_violation(q, unit > 0 ? unit : 1, &way));
  *found = false;
  for (double slack = 1e-10; !*found && slack < 1e-4; slack *= 100) {
    double give = way + slack * (way + unit);
    for (int i = 0; i < q->p.rows; i++)
      if (q->of[i] < q->m)
        q->p.beta[i] += give / (q->norm[i] * q->size);
    BW_TRY(bwi_nearest_point(&q->p, z, mu, found, word));
    for (int i = 0; i < q->p.rows; i++)
      if (q->of[i] < q->m)
        q->p.beta[i] -= give / (q->norm[i] * q->size);
  }
done:
  return status;
}

bw_status bw_quadratic_program(bw_context *context, int n, const double *H, const double *g, int m,
                               const double *A, const double *b, const double *min,
                               const double *max, double *x, double *violation,
                               double *multiplier) {
  program q = {.context = context, .n = n, .m = m, .a = A, .b = b, .min = min, .max = max};
  bw_status status;
  const char *word = "";
  bool found = true, empty_row = false;
  double *z = NULL, *mu = NULL, largest = 0;
  q.p.context = context;
  q.p.n = n;
  q.size = 1;
  BW_TRY(check_input(context, n, H, g, m, A, b, min, max));
  BW_TRY(transform(&q, H, g));
  z = BW_NEW0(context, double, n);
  mu = BW_NEW0(context, double, q.p.rows);
  BW_TRY_MEMORY(z && mu);
  double reach = 0; /* |y| at c, below whose rounding no row is violated */
  for (int i = 0; i < n; i++)
    reach += q.centre[i] * (bwi_dot(n, H + i * n, q.centre));
  reach = sqrt(fmax(reach, 0));
  for (int i = 0; i < q.p.rows; i++)
    largest = fmax(largest, -q.p.beta[i]);
  for (int i = 0; i < m; i++) {
    bool zero = true;
    for (int j = 0; j < n; j++)
      zero = zero && A[i * n + j] == 0;
    empty_row = empty_row || (zero && b[i] < 0);
  }
  if (largest > 1e-14 * reach || empty_row) {
    q.size = largest > 0 ? largest : fmax(reach, 1);
    for (int i = 0; i < q.p.rows; i++)
      q.p.beta[i] /= q.size;
    if (!empty_row)
      BW_TRY(bwi_nearest_point(&q.p, z, mu, &found, &word));
    if (!found || empty_row)
      BW_TRY(elastic(&q, z, mu, &found, &word));
  }
  if (!found)
    BW_TRY(bw_fail(context, BW_CONVERGENCE,
                   "a quadratic program of %d unknowns and %d rows was not solved (NLopt: %s)", n,
                   m, word));
  to_unknowns(&q, z, x);
  *violation = 0;
  for (int i = 0; i < m; i++)
    *violation = fmax(*violation, bwi_dot(n, A + i * n, x) - b[i]);
  double rounding = 0;
  for (int i = 0; i < q.p.rows; i++)
    if (q.of[i] < m)
      rounding = fmax(rounding, 1e-7 * q.norm[i] * q.size);
  if (!empty_row && *violation < rounding)
    *violation = 0;
  if (multiplier) {
    memset(multiplier, 0, (size_t)m * sizeof *multiplier);
    for (int i = 0; i < q.p.rows; i++)
      if (q.of[i] < m)
        multiplier[q.of[i]] = q.size * mu[i] / q.norm[i];
  }
done:
  bw_free(z);
  bw_free(mu);
  linear_program_clear(&q);
  return status;
}
