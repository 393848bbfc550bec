/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Corrections: a few cheap Newton steps that show how far an equilibrium is away. */
#include "nonlinear/whole.h"
#include "solver_by.h"

static double distance(const double *a, const double *b, int64_t n) {
  double sum = 0;
  for (int64_t i = 0; i < n; i++)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

static bw_newton_options options_from(const double *start) {
  bw_newton_options options;
  bw_newton_options_default(&options);
  static bw_solver few;
  few = *newton_by(NEWTON_JACOBI);
  few.options.max_iterations = 30;
  options.solver = &few;
  options.iterations = 2;
  options.start = start;
  return options;
}

/* From a disturbed equilibrium the steps go back to it by most of the way; constrained nodes take
 * what is prescribed; from the equilibrium itself they do not move. */
static void test_goes_towards_equilibrium(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 8, 4, 4, 2, 1, 1, BW_NEO_HOOKEAN, 1e6, 0.4, 0);
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  push_side(context, load_case, 0, 2, 2e4, 0, 1e4);
  bw_solid_static *result = solve(context, &b, load_case, 1);
  int64_t n = 3 * (int64_t)b.nodes;
  double *start = BW_NEW(context, double, n), *moved = BW_NEW(context, double, n);
  bool defined = false;
  for (int64_t i = 0; i < n; i++)
    start[i] = 0.8 * result->displacement[i] + 0.004 * sin(1.7 * (double)i);
  bw_newton_options options = options_from(start);
  check_ok(context, bw_solid_correct(context, b.solid, load_case, &options, moved, &defined));
  assert_true(defined);
  assert_true(distance(moved, result->displacement, n) <
              0.2 * distance(start, result->displacement, n));
  for (int64_t i = 0; i < n; i++)
    if (load_case->constrained[i])
      assert_true(moved[i] == load_case->value[i]);
  options = options_from(result->displacement);
  check_ok(context, bw_solid_correct(context, b.solid, load_case, &options, moved, &defined));
  check_near(distance(moved, result->displacement, n), 0, 1e-8);
  bw_free(start);
  bw_free(moved);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

/* Where there is no energy at the start that is reported, and nothing is written; what is no
 * correction is refused. */
static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 2, 2, 2, 1, 1, 1, BW_NEO_HOOKEAN, 1e6, 0.4, 0);
  bw_load_case *load_case;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  int64_t n = 3 * (int64_t)b.nodes;
  double *start = BW_NEW0(context, double, n), moved = 7;
  bool defined = true;
  bw_newton_options options = options_from(start);
  assert_int_equal(bw_solid_correct(context, b.solid, load_case, &options, &moved, &defined),
                   BW_UNCONSTRAINED);
  hold_side(context, load_case, 0, 0, 7, 0, 0, 0);
  for (int64_t i = 0; i < n; i += 3) { /* turned inside out along x */
    double x[3];
    bw_grid_position(b.grid, (int32_t)(i / 3), x);
    start[i] = -2 * x[0];
  }
  check_ok(context, bw_solid_correct(context, b.solid, load_case, &options, &moved, &defined));
  assert_false(defined);
  assert_true(moved == 7);
  options.start = NULL;
  assert_int_equal(bw_solid_correct(context, b.solid, load_case, &options, &moved, &defined),
                   BW_INVALID);
  options = options_from(start);
  options.solver = newton_by(NEWTON_DIRECT);
  assert_int_equal(bw_solid_correct(context, b.solid, load_case, &options, &moved, &defined),
                   BW_INVALID);
  bw_free(start);
  bw_release(load_case);
  body_release(&b);
}

check_main(check_test(test_goes_towards_equilibrium), check_test(test_refusals))
