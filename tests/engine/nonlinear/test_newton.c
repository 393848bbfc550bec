/* Equilibrium of solids: closed forms, and what Newton's method promises. */
#include "solid_box.h"

static const int32_t bar_cells[3] = {2, 2, 4};
static const double bar_size[3] = {0.2, 0.2, 0.8};

static bw_solid_static *solve(bw_context *context, const box *b, bw_newton *newton,
                              const bw_newton_options *options) {
  bw_solid_static *result = NULL;
  check_ok(context, bw_solid_statics(context, b->solid, b->load_case, newton, options, &result));
  assert_true(result->complete);
  return result;
}

/* Compressible neo-Hookean bar with free sides, E = 1: nominal stress and lateral stretch. */
static void test_uniaxial(void **state) {
  bw_context *context = check_context(state);
  static const double table[][3] = {/* stretch, stress, lateral */
                                    {0.5, -0.9353520568881573, 1.2107673905},
                                    {0.9, -0.10872218513629549, 1.0317024344},
                                    {1.5, 0.3782801763943185, 0.8801745918},
                                    {3.0, 1.093141437317265, 0.6881110295}};
  for (int k = 0; k < 4; k++) {
    box b;
    bw_solid_static *result;
    box_make(context, &b, bar_cells, bar_size, BW_NEO_HOOKEAN, 1, 0.3, 0);
    box_symmetric(context, &b);
    box_hold(context, &b, 2, 1, false, false, true, (table[k][0] - 1) * bar_size[2]);
    result = solve(context, &b, NULL, NULL);
    double area = bar_size[0] * bar_size[1];
    check_near(box_sum(&b, result->reaction, 2, 1, 2) / area, table[k][1], 1e-7);
    check_near(1 + box_mean(&b, result->displacement, 0, 1, 0) / bar_size[0], table[k][2], 1e-7);
    assert_true(result->newton.residual <= 1e-6);
    bw_release(result);
    box_free(&b);
    if (table[k][0] < 0.6) /* a bar that is pressed so hard bulges to the side */
      continue;
    /* the same by a force */
    box_make(context, &b, bar_cells, bar_size, BW_NEO_HOOKEAN, 1, 0.3, 0);
    box_symmetric(context, &b);
    box_force(context, &b, 2, 1, 0, 0, table[k][1] * area);
    result = solve(context, &b, NULL, NULL);
    check_near(1 + box_mean(&b, result->displacement, 2, 1, 2) / bar_size[2], table[k][0], 1e-6);
    bw_release(result);
    box_free(&b);
  }
}

/* A cantilever under its weight: for small loads the deflection of linear elasticity, proportional
 * to the load. */
static void test_small_loads_are_linear(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {8, 2, 2};
  const double size[3] = {1, 0.2, 0.2};
  double deflection[2];
  for (int law = 0; law < BW_LAWS; law++) {
    for (int k = 0; k < 2; k++) {
      box b;
      double gravity[3] = {0, 0, k ? -2e-3 : -1e-3};
      box_make(context, &b, cells, size, (bw_law)law, 1e6, 0.3, 1000);
      box_hold(context, &b, 0, 0, true, true, true, 0);
      check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
      bw_solid_static *result = solve(context, &b, NULL, NULL);
      deflection[k] = box_mean(&b, result->displacement, 0, 1, 2);
      check_near(box_sum(&b, result->reaction, 0, 0, 2), 40 * -gravity[2], 1e-8);
      bw_release(result);
      box_free(&b);
    }
    check_near(deflection[1] / deflection[0], 2, 1e-3);
    static double first;
    if (law == 0)
      first = deflection[0];
    check_near(deflection[0] / first, 1, 1e-3);
  }
}

static void bend(bw_context *context, box *b, bw_law law, double force) {
  const int32_t cells[3] = {8, 2, 2};
  const double size[3] = {1, 0.2, 0.2};
  box_make(context, b, cells, size, law, 1e6, 0.3, 0);
  box_hold(context, b, 0, 0, true, true, true, 0);
  box_force(context, b, 0, 1, 0, 0, force);
}

static double difference(const box *b, const bw_solid_static *x, const bw_solid_static *y) {
  return bw_grid_difference(b->grid, x->displacement, y->displacement);
}

static void test_load_steps_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  bw_newton_options options;
  bw_newton_options_default(&options);
  options.tolerance = 1e-9;
  for (int law = 0; law < BW_LAWS; law++) {
    box b;
    bw_solid_static *once, *often;
    bend(context, &b, (bw_law)law, -400);
    options.steps = 1;
    once = solve(context, &b, NULL, &options);
    options.steps = 10;
    often = solve(context, &b, NULL, &options);
    assert_true(box_mean(&b, once->displacement, 0, 1, 2) < -0.3);
    check_near(difference(&b, once, often), 0, 1e-9);
    check_near(once->energy, often->energy, 1e-8 * once->energy);
    bw_release(once);
    bw_release(often);
    box_free(&b);
  }
}

static void test_same_bits(void **state) {
  bw_context *context = check_context(state);
  box b;
  bw_newton *newton;
  bw_solid_static *first, *other;
  bend(context, &b, BW_COROTATED, -400);
  check_ok(context, bw_newton_create(context, &newton));
  check_ok(context, bw_set_threads(context, 1));
  first = solve(context, &b, newton, NULL);
  for (int threads = 1; threads <= 4; threads *= 2) {
    check_ok(context, bw_set_threads(context, threads));
    other = solve(context, &b, newton, NULL);
    assert_memory_equal(first->displacement, other->displacement, 24 * (size_t)b.grid->node_count);
    bw_release(other);
  }
  other = solve(context, &b, NULL, NULL);
  assert_memory_equal(first->displacement, other->displacement, 24 * (size_t)b.grid->node_count);
  bw_release(other);
  bw_release(first);
  bw_release(newton);
  box_free(&b);
}

/* Another solid of the same elements finds order and analysis there. */
static void test_kept(void **state) {
  bw_context *context = check_context(state);
  bw_newton *newton;
  check_ok(context, bw_newton_create(context, &newton));
  for (int k = 0; k < 2; k++) {
    const int32_t cells[3] = {12, 8, 8};
    const double size[3] = {0.6, 0.4, 0.4};
    box b;
    box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e6 * (k + 1), 0.3, 0);
    box_hold(context, &b, 0, 0, true, true, true, 0);
    box_force(context, &b, 0, 1, 0, 0, -100);
    bw_solid_static *result = solve(context, &b, newton, NULL);
    assert_int_equal(result->newton.analyses, k == 0);
    assert_true(result->newton.history_count == result->newton.iterations);
    bw_release(result);
    box_free(&b);
  }
  bw_release(newton);
}

/* Loads that the stiffest elements' rounding hides are not balanced, and that is reported. */
static void test_hidden_loads(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    const int32_t cells[3] = {1, 1, 2}, material[2] = {1, 2};
    const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1}, force[3] = {0, 0, 1e-3};
    const int32_t low[4] = {0, 1, 2, 3}, high[4] = {8, 9, 10, 11};
    const bool all[3] = {true, true, true};
    bw_grid *grid;
    bw_solid_material *made[2];
    bw_material_table *material_table;
    bw_solid *solid;
    bw_load_case *load_case;
    bw_solid_static *result;
    check_ok(context, bw_grid_create(context, origin, spacing, cells, material, NULL, &grid));
    for (int m = 0; m < 2; m++)
      check_ok(context, bw_solid_material_create(context, "", BW_NEO_HOOKEAN,
                                                 m ? 1 : (k ? 1e20 : 1e8), 0.3, 0, &made[m]));
    check_ok(context, bw_material_table_create(context, 3, (const bw_solid_material *const *)made,
                                               &material_table));
    check_ok(context, bw_solid_create(context, grid, material_table, NULL, &solid));
    check_ok(context, bw_load_case_create(context, grid, &load_case));
    check_ok(context, bw_load_case_fix(context, load_case, 4, low, all, NULL));
    check_ok(context, bw_load_case_force(context, load_case, 4, high, force));
    bw_clear_warnings(context);
    check_ok(context, bw_solid_statics(context, solid, load_case, NULL, NULL, &result));
    if (k)
      assert_non_null(strstr(bw_warning_at(context, 0), "rounding"));
    else
      assert_null(bw_warning_at(context, 0));
    bw_release(result);
    bw_release(load_case);
    bw_release(solid);
    bw_release(material_table);
    bw_release(made[0]);
    bw_release(made[1]);
    bw_release(grid);
  }
}

check_main(check_test(test_uniaxial), check_test(test_small_loads_are_linear),
           check_test(test_load_steps_do_not_matter), check_test(test_same_bits),
           check_test(test_kept), check_test(test_hidden_loads))
