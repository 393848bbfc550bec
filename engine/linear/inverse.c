/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Inverses of sparse matrices as operators, and what can be asked of any operator. */
#include "linear/matrix_factor.h"

#include <math.h>
#include <string.h>

#include "linear/pcg.h"
#include "linear/vectors.h"

typedef struct inverse {
  bwi_factor *factor;   /* or NULL */
  bwi_matrix_pair pair; /* what it is of, where it is to follow another matrix */
  double *diagonal;     /* its reciprocals, of `size` rows, or NULL */
  int64_t size;
} inverse;

static void inverse_destroy(void *data) {
  inverse *m = data;
  if (!m)
    return;
  bw_release(m->factor);
  bwi_matrix_pair_clear(&m->pair);
  bw_free(m->diagonal);
  bw_free(m);
}

static bw_status inverse_apply(bw_context *context, void *data, int64_t count, const double *x,
                               double *y) {
  const inverse *m = data;
  if (m->factor)
    return bwi_solve_fields(context, m->factor, NULL, count, x, y);
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < m->size; i++)
      y[k * m->size + i] = m->diagonal[i] * x[k * m->size + i];
  return BW_OK;
}

const bwi_factor *bwi_operator_factor(const bw_operator *a) {
  return a && a->apply == inverse_apply ? ((const inverse *)a->data)->factor : NULL;
}

const char *bwi_operator_word(const bw_operator *a) {
  if (!a)
    return "";
  if (a->apply != inverse_apply)
    return "operator";
  return bw_solver_word(bwi_operator_factor(a) ? BW_SOLVER_CHOLESKY : BW_SOLVER_JACOBI);
}

static bw_status invert_diagonal(bw_context *context, const bw_sparse_matrix *a, inverse *m) {
  m->diagonal = BW_NEW(context, double, a->rows);
  if (!m->diagonal)
    return BW_MEMORY;
  for (int32_t i = 0; i < a->rows; i++) {
    double entry = 0;
    for (int64_t k = a->start[i]; k < a->start[i + 1]; k++)
      if (a->column[k] == i)
        entry = a->value[k];
    if (!(entry > 0) || !isfinite(1 / entry))
      return bw_fail(context, BW_SINGULAR,
                     "the matrix is not positive definite: entry (%d, %d) of its diagonal is %g",
                     i + 1, i + 1, entry);
    m->diagonal[i] = 1 / entry;
  }
  return BW_OK;
}

static bw_status check_solver(bw_context *context, const bw_solver *solver) {
  if (!solver || solver->options.kind == BW_SOLVER_JACOBI)
    return BW_OK;
  if (solver->options.kind == BW_SOLVER_LU || solver->options.kind == BW_SOLVER_BICGSTAB)
    return bw_fail(
        context, BW_INVALID,
        "\"%s\" is for the unsymmetric equations of flows, this matrix is symmetric: give "
        "cholesky or jacobi",
        bw_solver_word(solver->options.kind));
  if (solver->options.kind == BW_SOLVER_PCG)
    return bw_fail(context, BW_INVALID,
                   "conjugate gradients give no inverse: they are not linear. Give cholesky or "
                   "jacobi");
  if (solver->options.kind != BW_SOLVER_CHOLESKY)
    return bw_fail(context, BW_UNSUPPORTED,
                   "\"%s\" works on the elements of a body: a matrix takes cholesky or jacobi",
                   bw_solver_word(solver->options.kind));
  if (solver->options.backend == BW_BACKEND_PETSC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the backend \"petsc\" factors the equations of a model: a matrix takes "
                   "multifrontal or cholmod");
  return BW_OK;
}

bw_status bw_operator_inverse(bw_context *context, const bw_sparse_matrix *matrix,
                              const bw_solver *solver, bw_operator **result) {
  bw_status status = BW_OK;
  bw_operator *a = NULL, *made = NULL;
  bwi_matrix_pair pair = {0};
  bool jacobi = solver && solver->options.kind == BW_SOLVER_JACOBI;
  inverse *m = NULL;
  BW_TRY(check_solver(context, solver));
  BW_TRY(bw_operator_of_matrix(context, matrix, NULL, &a));
  BW_TRY(bwi_operator_check_symmetric(context, a, NULL));
  m = BW_NEW0(context, inverse, 1);
  BW_TRY_MEMORY(m);
  m->size = matrix->rows;
  if (jacobi)
    BW_TRY(invert_diagonal(context, matrix, m));
  else {
    BW_TRY(bwi_matrix_pair_open(context, matrix, NULL, &pair));
    BW_TRY(bwi_matrix_pair_factor(context, &pair, 0, solver, a->name.text,
                                  "conjugate gradients with jacobi need none", NULL, &m->factor));
  }
  BW_TRY(bw_operator_create(context, m->size, inverse_apply, m, inverse_destroy,
                            jacobi ? "jacobi" : "cholesky", &made));
  m = NULL;
  *result = made;
done:
  inverse_destroy(m);
  bwi_matrix_pair_clear(&pair);
  bw_release(a);
  return status;
}

/* ---- following another matrix ---------------------------------------------------------------- */

/* Opens the matrix on the former pattern where its entries lie there, otherwise on its own. */
static bw_status open_on(bw_context *context, const bw_sparse_matrix *matrix,
                         const bwi_matrix_pair *former, bwi_matrix_pair *pair, bool *same) {
  const bw_block_pattern *pattern = former->pattern;
  *same = pattern && pattern->node_count == matrix->rows;
  double *value = BW_NEW0(context, double, *same ? pattern->block_count : 0);
  if (!value)
    return BW_MEMORY;
  for (int32_t i = 0; *same && i < matrix->rows; i++) {
    int64_t at = pattern->start[i], end = pattern->start[i + 1];
    for (int64_t e = matrix->start[i]; *same && e < matrix->start[i + 1] && matrix->column[e] <= i;
         e++) {
      while (at < end && pattern->column[at] < matrix->column[e])
        at++;
      *same = at < end && pattern->column[at] == matrix->column[e];
      if (*same)
        value[at] = matrix->value[e];
    }
  }
  if (*same) {
    *pair = (bwi_matrix_pair){.pattern = bw_retain(pattern), .k = value};
    return BW_OK;
  }
  bw_free(value);
  return bwi_matrix_pair_open(context, matrix, NULL, pair);
}

bw_status bwi_operator_inverse_follow(bw_context *context, const bw_sparse_matrix *matrix,
                                      bw_operator **inverse_of, bwi_inverse_reuse *reused) {
  bw_status status = BW_OK;
  const inverse none = {0}, *former = *inverse_of ? (*inverse_of)->data : &none;
  bw_operator *made = NULL;
  bwi_symbolic *symbolic = NULL;
  bool same;
  inverse *m = BW_NEW0(context, inverse, 1);
  BW_TRY_MEMORY(m);
  m->size = matrix->rows;
  *reused = BWI_REUSED_NONE;
  BW_TRY(open_on(context, matrix, &former->pair, &m->pair, &same));
  if (same && memcmp(former->pair.k, m->pair.k,
                     (size_t)m->pair.pattern->block_count * sizeof *m->pair.k) == 0) {
    *reused = BWI_REUSED_FACTOR;
    inverse_destroy(m);
    return BW_OK;
  }
  if (same)
    symbolic = bw_retain(former->factor->symbolic);
  bw_release(*inverse_of); /* before another factor takes memory */
  *inverse_of = NULL;
  BW_TRY(bwi_matrix_pair_factor(context, &m->pair, 0, NULL, "stiffness of the joined bodies",
                                "a coarser mesh needs less", symbolic, &m->factor));
  if (symbolic)
    *reused = BWI_REUSED_ORDER;
  BW_TRY(
      bw_operator_create(context, m->size, inverse_apply, m, inverse_destroy, "cholesky", &made));
  m = NULL;
  *inverse_of = made;
done:
  inverse_destroy(m);
  bw_release(symbolic);
  if (status != BW_OK) {
    bw_release(*inverse_of);
    *inverse_of = NULL;
  }
  return status;
}

/* ---- symmetry -------------------------------------------------------------------------------- */

/* What x . A y and y . A x may differ by, relative to the vectors: an operator may hold a product
 * that is itself rounded, or found by an iteration. */
#define ASYMMETRY 1e-8

bw_status bwi_operator_check_symmetric(bw_context *context, const bw_operator *a, double *norm) {
  bw_status status = BW_OK;
  int64_t size = a->size;
  size_t n = (size_t)size;
  if (norm)
    *norm = 0;
  if (size == 0 || (!norm && a->matrix && bw_sparse_matrix_is_symmetric(a->matrix)))
    return BW_OK;
  bw_random random;
  double *x = BW_NEW(context, double, 2 * size), *ax = BW_NEW(context, double, 2 * size);
  BW_TRY_MEMORY(x && ax);
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < 2 * size; i++)
    x[i] = 2 * bw_random_uniform(&random) - 1;
  BW_TRY(bw_operator_apply(context, a, 2, x, ax));
  double first, second, xx, yy, axax, ayay;
  BW_TRY(bwi_blocked_dot(context, n, x, ax + size, &first));
  BW_TRY(bwi_blocked_dot(context, n, x + size, ax, &second));
  BW_TRY(bwi_blocked_dot(context, n, x, x, &xx));
  BW_TRY(bwi_blocked_dot(context, n, x + size, x + size, &yy));
  BW_TRY(bwi_blocked_dot(context, n, ax, ax, &axax));
  BW_TRY(bwi_blocked_dot(context, n, ax + size, ax + size, &ayay));
  if (norm)
    *norm = sqrt(fmax(axax / xx, ayay / yy));
  if (fabs(first - second) > ASYMMETRY * (sqrt(xx) * sqrt(ayay) + sqrt(yy) * sqrt(axax)))
    status =
        bw_fail(context, BW_INVALID,
                "\"%s\" is not symmetric: x . A y = %g and y . A x = %g for two random vectors",
                a->name.text, first, second);
done:
  bw_free(x);
  bw_free(ax);
  return status;
}
