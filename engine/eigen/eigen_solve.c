/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The smallest eigenpairs of K x = lambda M x for sparse matrices and operators. The iterations
 * work on A = K - sigma M, which is positive definite, and on lambda - sigma. Matrices are factored
 * on one pattern (linear/matrix_factor.h), so that the Sturm count needs no other one. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "eigen/internal.h"
#include "linear/matrix_factor.h"

void bw_eigen_solve_options_default(bw_eigen_solve_options *options) {
  *options = (bw_eigen_solve_options){.count = 6, .tolerance = 1e-8, .test = true, .seed = 1};
}

static void pairs_destroy(void *object) {
  bw_eigenpairs *pairs = object;
  bw_free(pairs->value);
  bw_free(pairs->vector);
  bw_free(pairs->residual);
  bw_free(pairs->error);
  bw_free(pairs);
}

static size_t pairs_bytes(const void *object) {
  const bw_eigenpairs *pairs = object;
  return sizeof *pairs + (size_t)pairs->count * ((size_t)pairs->size + 3) * sizeof(double);
}

static const bw_kind pairs_kind = {"eigenpairs", pairs_destroy, pairs_bytes};

typedef struct pencil {
  const bw_operator *k, *m; /* m NULL: the identity */
  bw_eigen_solve_options options;
  bwi_matrix_pair pair; /* where both are matrices and a factor is wanted */
  bwi_factor *factor;   /* of A, or NULL */
  bw_operator *made;    /* the inverse of a diagonal, or NULL */
  const bw_operator *preconditioner;
  double *product; /* M x of one vector, where sigma is not 0 */
} pencil;

/* ---- products -------------------------------------------------------------------------------- */

/* A quotient of rounding size says nothing. */
#define ROUNDING 1e-10

/* BW_SINGULAR where x . y is negative; y is the product of x with `a`, or with `a` less its shift.
 */
static bw_status check_positive(bw_context *context, const bw_operator *a, bool shifted,
                                int64_t count, const double *x, const double *y) {
  int64_t size = a->size;
  for (int64_t k = 0; k < count; k++, x += size, y += size) {
    double xy = 0, xx = 0, yy = 0;
    for (int64_t i = 0; i < size; i++) {
      xy += x[i] * y[i];
      xx += x[i] * x[i];
      yy += y[i] * y[i];
    }
    if (xy < -ROUNDING * sqrt(xx) * sqrt(yy))
      return bw_fail(context, BW_SINGULAR,
                     "\"%s\"%s is not positive definite: x . A x = %g for a vector with x . x = "
                     "%g; of a stiffness, give a shift below its smallest eigenvalue",
                     a->name.text, shifted ? " less its shift" : "", xy, xx);
  }
  return BW_OK;
}

static bw_status pencil_mass(bw_context *context, void *data, int64_t count, const double *x,
                             double *y) {
  const pencil *p = data;
  if (!p->m) {
    memcpy(y, x, (size_t)count * (size_t)p->k->size * sizeof *y);
    return BW_OK;
  }
  bw_status status = bw_operator_apply(context, p->m, count, x, y);
  return status == BW_OK ? check_positive(context, p->m, false, count, x, y) : status;
}

/* y = K x - sigma M x */
static bw_status pencil_stiffness(bw_context *context, void *data, int64_t count, const double *x,
                                  double *y) {
  bw_status status = BW_OK;
  const pencil *p = data;
  int64_t size = p->k->size;
  BW_TRY(bw_operator_apply(context, p->k, count, x, y));
  for (int64_t k = 0; p->options.shift != 0 && k < count; k++) {
    BW_TRY(pencil_mass(context, data, 1, x + k * size, p->product));
    for (int64_t i = 0; i < size; i++)
      y[k * size + i] -= p->options.shift * p->product[i];
  }
  status = check_positive(context, p->k, p->options.shift != 0, count, x, y);
done:
  return status;
}

static bw_status pencil_solve(bw_context *context, void *data, int64_t count, const double *f,
                              double *y) {
  return bwi_solve_fields(context, ((pencil *)data)->factor, NULL, count, f, y);
}

static bw_status pencil_precondition(bw_context *context, void *data, int64_t count,
                                     const double *f, double *y) {
  const pencil *p = data;
  if (p->preconditioner)
    return bw_operator_apply(context, p->preconditioner, count, f, y);
  memcpy(y, f, (size_t)count * (size_t)p->k->size * sizeof *y);
  return BW_OK;
}

static bw_status pencil_project(bw_context *context, void *data, int64_t count, double *x) {
  (void)context, (void)data, (void)count, (void)x; /* the space is all of it */
  return BW_OK;
}

static bw_status pencil_below(bw_context *context, void *data, double lambda, int64_t *count,
                              bool *trusted) {
  pencil *p = data;
  bwi_matrix matrix = {.pattern = p->pair.pattern,
                       .stiffness = p->pair.k,
                       .mass = p->pair.m,
                       .shift = -(p->options.shift + lambda)};
  return bwi_count_negative(context, p->factor->symbolic, &matrix, count, trusted);
}

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_size(bw_context *context, const pencil *p, const bw_operator *other,
                            const char *what) {
  if (!other || other->size == p->k->size)
    return BW_OK;
  return bw_fail(context, BW_INVALID, "the %s \"%s\" has %lld rows, \"%s\" %lld", what,
                 other->name.text, (long long)other->size, p->k->name.text, (long long)p->k->size);
}

/* Without a mass there are no eigenvalues. */
static bw_status check_mass(bw_context *context, const bw_operator *m) {
  bw_status status = BW_OK;
  int64_t size = m->size;
  bool any = false;
  bw_random random;
  double *x = BW_NEW(context, double, 2 * size);
  if (!x)
    return BW_MEMORY;
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < size; i++)
    x[i] = bw_random_uniform(&random) - 0.5;
  BW_TRY(bw_operator_apply(context, m, 1, x, x + size));
  for (int64_t i = 0; i < size && !any; i++)
    any = x[size + i] != 0;
  if (!any)
    status = bw_fail(context, BW_SINGULAR, "the mass \"%s\" is zero: there are no eigenpairs",
                     m->name.text);
done:
  bw_free(x);
  return status;
}

static bw_status check_options(bw_context *context, const pencil *p) {
  bw_status status = BW_OK;
  const bw_eigen_solve_options *o = &p->options;
  if (o->count < 1)
    return bw_fail(context, BW_INVALID, "%d eigenpairs were requested: at least 1 expected",
                   o->count);
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance on eigenpairs is %g; it must lie between 0 and 1", o->tolerance);
  if (!isfinite(o->shift))
    return bw_fail(context, BW_INVALID, "the shift is %g: a finite number expected", o->shift);
  if (p->k->size > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%lld rows are more than an eigensolver can count",
                   (long long)p->k->size);
  BW_TRY(check_size(context, p, p->m, "mass"));
  BW_TRY(check_size(context, p, o->preconditioner, "preconditioner"));
  BW_TRY(bwi_operator_check_symmetric(context, p->k, NULL));
  if (p->m) {
    BW_TRY(bwi_operator_check_symmetric(context, p->m, NULL));
    BW_TRY(check_mass(context, p->m));
  }
  if (o->preconditioner)
    BW_TRY(bwi_operator_check_symmetric(context, o->preconditioner, NULL));
done:
  return status;
}

/* A factor of K - sigma M, for methods that work on the inverse. */
static bw_status make_factor(bw_context *context, pencil *p) {
  bw_status status = BW_OK;
  double sigma = p->options.shift;
  const bw_operator *lacks = !p->k->matrix                         ? p->k
                             : sigma != 0 && p->m && !p->m->matrix ? p->m
                                                                   : NULL;
  const bw_sparse_matrix *m = p->m ? p->m->matrix : NULL;
  if (lacks)
    return bw_fail(context, BW_INVALID,
                   "this eigensolver works on the inverse, which needs the entries of a sparse "
                   "matrix, and \"%s\" is an operator: give lobpcg",
                   lacks->name.text);
  BW_TRY(bwi_matrix_pair_open(context, p->k->matrix, m, &p->pair));
  BW_TRY(bwi_matrix_pair_factor(context, &p->pair, sigma, NULL, p->k->name.text,
                                "the eigensolver lobpcg needs none", NULL, &p->factor));
done:
  return status;
}

/* The preconditioner of LOBPCG: the caller's, that of the diagonal of A, or none. */
static bw_status make_preconditioner(bw_context *context, pencil *p) {
  p->preconditioner = p->options.preconditioner;
  if (p->preconditioner || !p->k->matrix || p->options.shift != 0)
    return BW_OK;
  bw_solver *jacobi = NULL;
  bw_solver_options options = {.kind = BW_SOLVER_JACOBI};
  bw_status status = bw_solver_create(context, &options, &jacobi);
  if (status == BW_OK)
    status = bw_operator_inverse(context, p->k->matrix, jacobi, &p->made);
  bw_release(jacobi);
  p->preconditioner = p->made;
  return status;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* |r| in the norm of M^-1, r = A x - (lambda - sigma) M x, for |x| = 1 in that of M: this near to
 * lambda lies an eigenvalue. M^-1 r need not be exact. */
static bw_status find_errors(bw_context *context, pencil *p, const bwi_eigen_result *result,
                             double *error) {
  bw_status status = BW_OK;
  int64_t size = p->k->size, count = result->count;
  bw_solver *pcg = NULL;
  bw_solver_options options = {.kind = BW_SOLVER_PCG, .tolerance = 1e-3, .max_iterations = 1000};
  double *r = BW_NEW(context, double, count *size), *z = BW_NEW(context, double, count *size);
  BW_TRY_MEMORY(r && z);
  BW_TRY(pencil_stiffness(context, p, count, result->vector, r));
  BW_TRY(pencil_mass(context, p, count, result->vector, z));
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = k * size; i < (k + 1) * size; i++)
      r[i] -= result->value[k] * z[i];
  if (p->m) {
    BW_TRY(bw_solver_create(context, &options, &pcg));
    status = bw_linear_solve(context, p->m, &(bw_linear_solve_options){.solver = pcg}, count, r, z,
                             NULL);
  }
  bool known = status != BW_CONVERGENCE; /* M is too ill-conditioned */
  if (!known) {
    bw_clear_failure(context);
    status = BW_OK;
  }
  for (int64_t k = 0; k < count; k++) {
    double square = 0;
    for (int64_t i = k * size; i < (k + 1) * size; i++)
      square += r[i] * (p->m ? z[i] : r[i]);
    error[k] = known ? sqrt(fmax(square, 0)) : INFINITY;
  }
done:
  bw_free(r);
  bw_free(z);
  bw_release(pcg);
  return status;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static bw_status make_pairs(bw_context *context, const pencil *p, bwi_eigen_result *result,
                            double **error, bw_eigenpairs **out) {
  bw_eigenpairs *pairs = BW_NEW0(context, bw_eigenpairs, 1);
  if (!pairs)
    return BW_MEMORY;
  bw_object_init(pairs, &pairs_kind);
  pairs->count = result->count;
  pairs->size = p->k->size;
  pairs->value = result->value;
  pairs->vector = result->vector;
  pairs->residual = result->residual;
  pairs->error = *error;
  pairs->recovered = result->recovered;
  pairs->counted = result->counted;
  pairs->tested = result->tested;
  pairs->report = result->report;
  result->value = result->vector = result->residual = *error = NULL;
  for (int k = 0; k < pairs->count; k++) {
    pairs->value[k] += p->options.shift;
    bwi_fix_sign(pairs->vector + k * pairs->size, pairs->size);
  }
  *out = pairs;
  return BW_OK;
}

/* The method, and what it works with. */
static bw_status prepare(bw_context *context, pencil *p, bwi_eigen_problem *problem) {
  bw_status status = BW_OK;
  const bw_eigensolver *solver = p->options.solver;
  bw_eigensolver_kind kind = solver ? solver->options.kind : BW_EIGENSOLVER_AUTO;
  if (kind == BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "SLEPc computes elastic modes of a whole model: matrices and operators take "
                   "lanczos, arpack or lobpcg");
  if (solver && solver->options.preconditioner)
    return bw_fail(context, BW_UNSUPPORTED,
                   "\"%s\" works on the elements of a body: give a preconditioner of your own, or "
                   "the inverse of a similar matrix",
                   bw_solver_word(solver->options.preconditioner->options.kind));
  bool lobpcg = kind == BW_EIGENSOLVER_LOBPCG;
  if (!lobpcg && p->options.preconditioner)
    return bw_fail(context, BW_INVALID,
                   "the preconditioner \"%s\" is for lobpcg: other eigensolvers work on the "
                   "inverse by a factor",
                   p->options.preconditioner->name.text);
  *problem = (bwi_eigen_problem){.size = p->k->size,
                                 .data = p,
                                 .mass = pencil_mass,
                                 .stiffness = pencil_stiffness,
                                 .project = pencil_project,
                                 .dimension = p->k->size};
  if (p->options.shift != 0) {
    p->product = BW_NEW(context, double, p->k->size);
    if (!p->product)
      return BW_MEMORY;
  }
  if (lobpcg) {
    BW_TRY(make_preconditioner(context, p));
    problem->precondition = pencil_precondition;
    problem->preconditioner = bwi_operator_word(p->preconditioner);
  } else {
    BW_TRY(make_factor(context, p));
    problem->solve = pencil_solve;
    if (!p->m || p->m->matrix)
      problem->below = pencil_below;
  }
done:
  return status;
}

/* Without a solver: LOBPCG where a factor is not possible, or a preconditioner is given. */
static bw_status choose(bw_context *context, pencil *p, bw_eigensolver **made) {
  const bw_eigen_solve_options *o = &p->options;
  bool automatic = !o->solver || o->solver->options.kind == BW_EIGENSOLVER_AUTO;
  bool matrices = p->k->matrix && (o->shift == 0 || !p->m || p->m->matrix);
  if (!automatic || (matrices && !o->preconditioner))
    return BW_OK;
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  how.kind = BW_EIGENSOLVER_LOBPCG;
  bw_status status = bw_eigensolver_create(context, &how, made);
  p->options.solver = *made;
  return status;
}

bw_status bw_eigen_solve(bw_context *context, const bw_operator *stiffness, const bw_operator *mass,
                         const bw_eigen_solve_options *given, bw_eigenpairs **pairs) {
  bw_status status = BW_OK;
  pencil p = {.k = stiffness, .m = mass};
  bwi_eigen_problem problem;
  bwi_eigen_result result = {0};
  bw_eigensolver *chosen = NULL;
  double *error = NULL;
  bw_eigen_solve_options_default(&p.options);
  if (given)
    p.options = *given;
  BW_TRY(check_options(context, &p));
  BW_TRY(choose(context, &p, &chosen));
  BW_TRY(prepare(context, &p, &problem));
  const bw_modes_options options = {.count = p.options.count,
                                    .tolerance = p.options.tolerance,
                                    .sturm = p.options.test,
                                    .seed = p.options.seed,
                                    .solver = p.options.solver};
  status = bwi_eigen_lowest(context, &problem, &options, &result);
  if (status == BW_CONVERGENCE)
    bw_fail(context, BW_CONVERGENCE,
            "the eigenpairs of \"%s\" did not converge to a relative residual of %g: give lobpcg a "
            "preconditioner nearer to the inverse, ask for a larger tolerance or fewer pairs",
            stiffness->name.text, p.options.tolerance);
  BW_TRY(status);
  if (chosen)
    snprintf(result.report.reason, sizeof result.report.reason, "%s",
             p.options.preconditioner ? "a preconditioner was given"
                                      : "an operator has products alone");
  if (p.factor) {
    result.report.backend = p.factor->kernels->backend;
    result.report.bytes += (double)bwi_factor_bytes(p.factor);
    result.report.flops = bwi_factor_flops(p.factor);
  }
  error = BW_NEW(context, double, result.count);
  BW_TRY_MEMORY(error);
  BW_TRY(find_errors(context, &p, &result, error));
  BW_TRY(make_pairs(context, &p, &result, &error, pairs));
done:
  bwi_matrix_pair_clear(&p.pair);
  bw_release(p.factor);
  bw_release(p.made);
  bw_free(p.product);
  bw_free(error);
  bw_release(chosen);
  bwi_eigen_result_clear(&result);
  return status;
}
