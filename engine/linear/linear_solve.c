/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A x = b for sparse matrices and operators: by a factor, refined until rounding stops it, or by
 * preconditioned conjugate gradients. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "linear/matrix_factor.h"
#include "linear/pcg.h"
#include "linear/pcg_space.h"
#include "linear/vectors.h"

enum { ITERATIONS = 2000, REFINEMENTS = 3, WIDTH = 8 };

/* Vectors that an operator was given, and what it made of them. */
typedef struct last_product {
  int64_t count;
  const double *x, *y;
} last_product;

typedef struct linear_solve {
  bw_context *context;
  const bw_operator *a;
  const bw_solver *solver; /* or NULL */
  bool direct;             /* by a factor */
  bw_operator *made;       /* a factor or a preconditioner that was made here, or NULL */
  const bw_operator *m;    /* the preconditioner, or NULL */
  const double *guess;     /* or NULL */
  double tolerance;        /* (-) relative residual */
  int max_iterations;
  double *work;            /* of the vectors of a block; of a factor r and z */
  last_product of_a, of_m; /* in `work` */
  int iterations;          /* of the right-hand side that took most */
  double residual;         /* (-) the largest, relative */
} linear_solve;

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_finite(bw_context *context, const char *what, int64_t count, int64_t size,
                              const double *x) {
  for (int64_t i = 0; x && i < count * size; i++)
    if (!isfinite(x[i]))
      return bw_fail(context, BW_INVALID, "row %lld of the %s is %s", (long long)(i % size) + 1,
                     what, isnan(x[i]) ? "nan" : "inf");
  return BW_OK;
}

static bw_status fail_entries(const linear_solve *s, const char *what) {
  return bw_fail(s->context, BW_INVALID,
                 "%s needs the entries of a sparse matrix, and \"%s\" is an operator: give pcg, "
                 "with a preconditioner of your own, or the inverse of a similar matrix",
                 what, s->a->name.text);
}

/* What the preconditioner is: the caller's, or one of the matrix as the solver describes. */
static bw_status read_preconditioner(linear_solve *s, const bw_operator *given) {
  const bw_solver *m = s->solver ? s->solver->options.preconditioner : NULL;
  s->m = given;
  if (given && m)
    return bw_fail(s->context, BW_INVALID,
                   "two preconditioners: one in the solver, and \"%s\"; leave one out",
                   given->name.text);
  if (given && given->size != s->a->size)
    return bw_fail(s->context, BW_INVALID, "the preconditioner \"%s\" has %lld rows, \"%s\" %lld",
                   given->name.text, (long long)given->size, s->a->name.text,
                   (long long)s->a->size);
  if (given || (!m && !s->a->matrix))
    return BW_OK;
  if (!s->a->matrix)
    return fail_entries(s, "a preconditioner that the solver makes");
  bw_solver *jacobi = NULL;
  bw_solver_options options = {.kind = BW_SOLVER_JACOBI};
  bw_status status = m ? BW_OK : bw_solver_create(s->context, &options, &jacobi);
  if (status == BW_OK)
    status = bw_operator_inverse(s->context, s->a->matrix, m ? m : jacobi, &s->made);
  bw_release(jacobi);
  s->m = s->made;
  return status;
}

/* The way, and what it needs. */
static bw_status prepare(linear_solve *s, const bw_linear_solve_options *options) {
  bw_status status = BW_OK;
  const bw_solver *solver = s->solver = options->solver;
  bw_solver_kind kind = solver ? solver->options.kind : BW_SOLVER_PCG;
  s->guess = options->guess;
  s->tolerance = solver && solver->options.tolerance > 0 ? solver->options.tolerance : 1e-10;
  s->max_iterations =
      solver && solver->options.max_iterations > 0 ? solver->options.max_iterations : ITERATIONS;
  if (!solver && s->a->matrix && !options->preconditioner)
    kind = BW_SOLVER_CHOLESKY;
  if (kind != BW_SOLVER_CHOLESKY && kind != BW_SOLVER_PCG)
    return bwi_solver_refused(s->context, solver);
  if (kind == BW_SOLVER_PCG)
    return read_preconditioner(s, options->preconditioner);
  if (options->preconditioner)
    return bw_fail(s->context, BW_INVALID,
                   "a factor needs no preconditioner: leave \"%s\" out, or give pcg",
                   options->preconditioner->name.text);
  if (!s->a->matrix)
    return fail_entries(s, "a factor");
  BW_TRY(bw_operator_inverse(s->context, s->a->matrix, solver, &s->made));
  s->m = s->made; /* in single precision it is a preconditioner */
  s->direct = bwi_operator_factor(s->made)->kernels->bits == 64;
done:
  return status;
}

/* ---- solutions ------------------------------------------------------------------------------- */

/* r = b - A x in the first of the working vectors, and its square. */
static bw_status find_residual(linear_solve *s, const double *b, const double *x, double *square) {
  bw_status status = bw_operator_apply(s->context, s->a, 1, x, s->work);
  return status == BW_OK ? bwi_subtract_from(s->context, (size_t)s->a->size, b, s->work, square)
                         : status;
}

/* x = A^-1 b by the factor, and refinement while each step takes half of the residual away. */
static bw_status solve_direct(linear_solve *s, const double *b, double load, double *x) {
  bw_status status = BW_OK;
  double square, before = INFINITY;
  int64_t size = s->a->size;
  double *r = s->work, *z = s->work + size;
  BW_TRY(bw_operator_apply(s->context, s->m, 1, b, x));
  for (int pass = 0; load > 0; pass++) {
    BW_TRY(find_residual(s, b, x, &square));
    if (square > before) { /* without the last correction */
      for (int64_t i = 0; i < size; i++)
        x[i] -= z[i];
      square = before;
    }
    bool enough = sqrt(square) <= s->tolerance * load || square > 0.25 * before;
    before = square;
    if (enough || pass == REFINEMENTS)
      break;
    BW_TRY(bw_operator_apply(s->context, s->m, 1, r, z));
    for (int64_t i = 0; i < size; i++)
      x[i] += z[i];
  }
  if (load > 0)
    s->residual = fmax(s->residual, sqrt(before) / load);
done:
  return status;
}

/* Why conjugate gradients ended where a product was not positive; the vectors are those of their
 * last products. */
static bw_status not_definite(const linear_solve *s, int iterations) {
  bw_status status = BW_OK;
  const bw_operator *culprit = s->a;
  double product = NAN;
  BW_TRY(bwi_operator_check_symmetric(s->context, s->a, NULL));
  for (int k = 0; k < 2 && !(product <= 0); k++) {
    const last_product *last = k ? &s->of_m : &s->of_a;
    for (int64_t c = 0; c < last->count && !(product <= 0); c++)
      BW_TRY(bwi_blocked_dot(s->context, (size_t)s->a->size, last->x + c * s->a->size,
                             last->y + c * s->a->size, &product));
    culprit = k && s->m ? s->m : s->a;
  }
  status =
      bw_fail(s->context, BW_SINGULAR,
              "\"%s\" is not positive definite: %s = %g for a vector of iteration %d of "
              "conjugate gradients",
              culprit->name.text, culprit == s->a ? "p . A p" : "r . M r", product, iterations);
  bw_detail_text(s->context, "operator", culprit->name.text);
done:
  return status;
}

/* A residual above the tolerance: where it is what rounding leaves of A x, there is no better one.
 */
static bw_status check_converged(const linear_solve *s, double load, double residual,
                                 const double *x, int iterations) {
  bw_status status = BW_OK;
  double norm, xx;
  if (residual <= s->tolerance * load)
    return BW_OK;
  BW_TRY(bwi_operator_check_symmetric(s->context, s->a, &norm));
  BW_TRY(bwi_blocked_dot(s->context, (size_t)s->a->size, x, x, &xx));
  if (residual <= BWI_RESIDUAL_NOISE * DBL_EPSILON * norm * sqrt(xx))
    return BW_OK;
  status = bw_fail(
      s->context, BW_CONVERGENCE,
      "conjugate gradients reached a residual of %.2g of the right-hand side in %d "
      "iterations; %.0e was requested: give a better preconditioner, a larger tolerance, or "
      "more iterations",
      residual / load, iterations, s->tolerance);
  bw_detail_number(s->context, "iterations", iterations);
  bw_detail_number(s->context, "residual", residual / load);
done:
  return status;
}

static bw_status multiply(bw_context *context, void *data, int64_t count, const double *x,
                          double *y) {
  linear_solve *s = data;
  s->of_a = (last_product){count, x, y};
  return bw_operator_apply(context, s->a, count, x, y);
}

static bw_status precondition(bw_context *context, void *data, int64_t count, const double *r,
                              double *z) {
  linear_solve *s = data;
  s->of_m = (last_product){count, r, z};
  if (s->m)
    return bw_operator_apply(context, s->m, count, r, z);
  memcpy(z, r, (size_t)count * (size_t)s->a->size * sizeof *z);
  return BW_OK;
}

/* `count` columns by conjugate gradients, from x on; load: |b| of each. */
static bw_status solve_pcg(linear_solve *s, int count, const double *b, const double *load,
                           double *x) {
  bw_status status = BW_OK;
  const bwi_pcg_fields fields = {.size = s->a->size,
                                 .multiply = multiply,
                                 .multiply_data = s,
                                 .precondition = precondition,
                                 .precondition_data = s,
                                 .guess = s->guess != NULL,
                                 .work = s->work};
  bwi_pcg_task task = {.columns = count,
                       .energy_tolerance = INFINITY,
                       .residual_tolerance = s->tolerance,
                       .energy_fall = 1,
                       .load = load,
                       .limit = s->max_iterations,
                       .progress = true};
  bw_status ran = bwi_pcg_fields_run(s->context, &fields, &task, b, x);
  if (ran == BW_INVALID) { /* where it is not symmetric, vectors may grow without bound */
    char message[500];
    snprintf(message, sizeof message, "%s", bw_message(s->context));
    BW_TRY(bwi_operator_check_symmetric(s->context, s->a, NULL));
    bw_fail(s->context, ran, "%s", message); /* the products may have replaced it */
  }
  BW_TRY(ran);
  s->iterations = task.iterations > s->iterations ? task.iterations : s->iterations;
  if (task.indefinite) {
    status = not_definite(s, task.iterations);
    goto done;
  }
  for (int k = 0; k < count; k++) {
    const double *column = x + k * s->a->size;
    double square;
    BW_TRY(find_residual(s, b + k * s->a->size, column, &square));
    if (load[k] > 0)
      s->residual = fmax(s->residual, sqrt(square) / load[k]);
    BW_TRY(check_converged(s, load[k], sqrt(square), column, task.iterations));
  }
done:
  return status;
}

/* Right-hand sides in blocks, so that matrix and preconditioner are read once for several. */
static bw_status solve_all(linear_solve *s, int64_t count, const double *b, double *x) {
  bw_status status = BW_OK;
  int64_t size = s->a->size, width = count < WIDTH ? count : WIDTH;
  s->work = BW_NEW(s->context, double, (s->direct ? 2 : 4 * width) * size);
  if (!s->work)
    return BW_MEMORY;
  for (int64_t first = 0; first < count; first += width) {
    int columns = (int)(count - first < width ? count - first : width);
    double load[WIDTH];
    for (int k = 0; k < columns; k++) {
      const double *side = b + (first + k) * size;
      BW_TRY(bwi_blocked_dot(s->context, (size_t)size, side, side, &load[k]));
      load[k] = sqrt(load[k]);
    }
    double *to = x + first * size;
    if (s->direct)
      for (int k = 0; k < columns; k++)
        BW_TRY(solve_direct(s, b + (first + k) * size, load[k], to + k * size));
    else {
      for (int k = 0; s->guess && k < columns; k++) /* where b is 0, so is x */
        for (int64_t i = k * size; i < (k + 1) * size; i++)
          to[i] = load[k] > 0 ? s->guess[first * size + i] : 0;
      BW_TRY(solve_pcg(s, columns, b + first * size, load, to));
    }
  }
done:
  return status;
}

static void write_report(const linear_solve *s, double seconds, bw_solver_report *report) {
  const bwi_factor *factor = bwi_operator_factor(s->m);
  *report =
      (bw_solver_report){.solver = bw_solver_word(s->direct ? BW_SOLVER_CHOLESKY : BW_SOLVER_PCG),
                         .backend = factor ? factor->kernels->backend : "",
                         .preconditioner = s->direct ? "" : bwi_operator_word(s->m),
                         .seconds = seconds,
                         .iterations = s->iterations,
                         .residual = s->residual};
  snprintf(report->reason, sizeof report->reason, "%s",
           s->solver      ? "it was given"
           : s->direct    ? "a factor serves sparse matrices"
           : s->a->matrix ? "a preconditioner was given"
                          : "an operator has products alone");
  if (factor) {
    report->bytes = (double)bwi_factor_bytes(factor);
    report->flops = s->made == s->m ? bwi_factor_flops(factor) : 0;
  }
}

bw_status bw_linear_solve(bw_context *context, const bw_operator *a,
                          const bw_linear_solve_options *given, int64_t count, const double *b,
                          double *x, bw_solver_report *report) {
  return bwi_linear_solve_by(context, a, given, NULL, count, b, x, report);
}

bw_status bwi_linear_solve_by(bw_context *context, const bw_operator *a,
                              const bw_linear_solve_options *given, const bw_operator *inverse,
                              int64_t count, const double *b, double *x, bw_solver_report *report) {
  bw_status status = BW_OK;
  double start = bw_seconds();
  bw_linear_solve_options options = given ? *given : (bw_linear_solve_options){0};
  linear_solve s = {
      .context = context, .a = a, .direct = inverse != NULL, .m = inverse, .tolerance = 1e-10};
  if (a->size > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%lld rows are more than the solver can count",
                   (long long)a->size);
  BW_TRY(check_finite(context, "right-hand side", count, a->size, b));
  BW_TRY(check_finite(context, "guess", count, a->size, options.guess));
  if (a->matrix)
    BW_TRY(bwi_operator_check_symmetric(context, a, NULL));
  if (!inverse)
    BW_TRY(prepare(&s, &options));
  BW_TRY(solve_all(&s, count, b, x));
  if (report)
    write_report(&s, bw_seconds() - start, report);
done:
  bw_free(s.work);
  bw_release(s.made);
  return status;
}
