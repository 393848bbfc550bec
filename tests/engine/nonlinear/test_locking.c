/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Volumetric locking of hexahedra and its cure: a nearly incompressible cantilever against beam
 * theory, in the standard and in the B-bar formulation. */
#include "nonlinear/whole.h"

static void hold_at(bw_context *context, bw_load_case *load_case, const bw_grid *grid,
                    const double at[3], bool y, bool z) {
  const double zero[3] = {0, 0, 0};
  const bool fixed[3] = {false, y, z};
  for (int32_t i = 0; i < grid->node_count; i++) {
    double x[3];
    bw_grid_position(grid, i, x);
    if (fabs(x[0] - at[0]) + fabs(x[1] - at[1]) + fabs(x[2] - at[2]) < 1e-9)
      check_ok(context, bw_load_case_fix(context, load_case, 1, &i, fixed, zero));
  }
}

/* Deflection at the tip of 1 x 0.1 x 0.1 m under a small force over beam theory with Cowper's
 * shear; the root stays plane, and may change its width. The element sums of the work of the
 * stresses must be the energy. */
static double cantilever(bw_context *context, double poisson, int cells, bool b_bar, bool *warned) {
  const double young = 1e6, low[3] = {0, 0.05, 0.05}, side[3] = {0, 0.1, 0.05};
  const double force[3] = {0, 0, 1e-3}, zero[3] = {0, 0, 0};
  const bool along[3] = {true, false, false};
  double shear = young / (2 * (1 + poisson)), factor = 10 * (1 + poisson) / (12 + 11 * poisson);
  double theory = force[2] * (1 / (3 * young * 1e-4 / 12) + 1 / (factor * shear * 0.01));
  body b =
      body_box(context, 10 * cells, cells, cells, 1, 0.1, 0.1, BW_NEO_HOOKEAN, young, poisson, 0);
  bw_load_case *load_case;
  int64_t count;
  if (b_bar)
    body_take_b_bar(context, &b, BW_NEO_HOOKEAN, young, poisson);
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  int32_t *node = nodes_at(context, b.grid, 0, 0, &count);
  check_ok(context, bw_load_case_fix(context, load_case, count, node, along, zero));
  bw_free(node);
  hold_at(context, load_case, b.grid, low, true, true);
  hold_at(context, load_case, b.grid, side, false, true);
  node = nodes_at(context, b.grid, 0, 1, &count);
  check_ok(context, bw_load_case_force(context, load_case, count, node, force));
  bw_clear_warnings(context);
  bw_solid_static *result = solve(context, &b, load_case, 1);
  *warned = bw_warning_at(context, 0) && strstr(bw_warning_at(context, 0), "volumetric locking");
  double sum = 0, work = 0;
  for (int64_t k = 0; k < count; k++)
    sum += result->displacement[3 * (int64_t)node[k] + 2];
  work = 0.5 * force[2] * sum / (double)count;
  check_near(result->energy, work, 0.02 * work);
  bw_free(node);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
  return sum / (double)count / theory;
}

static void test_cantilever(void **state) {
  bw_context *context = check_context(state);
  bool warned;
  assert_true(cantilever(context, 0.4999, 4, false, &warned) < 0.7);
  assert_true(warned);
  check_near(cantilever(context, 0.4999, 4, true, &warned), 1, 0.02);
  assert_false(warned);
  cantilever(context, 0.47, 2, false, &warned);
  assert_false(warned);
}

/* At 0 there is nothing to project: the same element. */
static void test_compressible_is_standard(void **state) {
  bw_context *context = check_context(state);
  bool warned;
  assert_true(cantilever(context, 0, 2, false, &warned) ==
              cantilever(context, 0, 2, true, &warned));
}

/* A pressed block between plates that fix its ends: stress and reaction agree, and the mean
 * pressure of the elements is smooth, the ends apart. */
static void test_stress_is_that_of_the_reaction(void **state) {
  bw_context *context = check_context(state);
  body b = body_box(context, 4, 4, 4, 1, 1, 1, BW_NEO_HOOKEAN, 1e6, 0.499, 0);
  body_take_b_bar(context, &b, BW_NEO_HOOKEAN, 1e6, 0.499);
  const bool fixed[3] = {true, true, true};
  const double zero[3] = {0, 0, 0}, pressed[3] = {0, 0, -0.01};
  bw_load_case *load_case;
  int64_t count;
  check_ok(context, bw_load_case_create(context, b.grid, &load_case));
  for (int end = 0; end < 2; end++) {
    int32_t *node = nodes_at(context, b.grid, 2, end, &count);
    check_ok(context,
             bw_load_case_fix(context, load_case, count, node, fixed, end ? pressed : zero));
    bw_free(node);
  }
  bw_solid_static *result = solve(context, &b, load_case, 1);
  double *stress = BW_NEW(context, double, 6 * (int64_t)b.grid->element_count);
  check_ok(context, bw_solid_stress(context, b.solid, result->displacement, stress, NULL));
  double reaction = 0, through[4] = {0};
  for (int32_t i = 0; i < b.nodes; i++) {
    double x[3];
    bw_grid_position(b.grid, i, x);
    reaction += x[2] > 0.5 ? result->reaction[3 * (int64_t)i + 2] : 0;
  }
  /* the force through any layer of elements is that of the ends */
  for (int32_t e = 0; e < b.grid->element_count; e++)
    through[b.grid->cell[e] / 16] += stress[6 * (int64_t)e + 2] / 16;
  for (int k = 0; k < 4; k++)
    check_near(through[k], reaction, 0.02 * fabs(reaction));
  bw_free(stress);
  bw_release(result);
  bw_release(load_case);
  body_release(&b);
}

check_main(check_test(test_cantilever), check_test(test_compressible_is_standard),
           check_test(test_stress_is_that_of_the_reaction))
