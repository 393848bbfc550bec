/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rainflow counting and damage against ASTM's example and closed forms. */
#include "bodies.h"

#include "barwright/analysis.h"
#include "barwright/dynamics.h"

static double counted(const bw_cycle *cycle, int64_t n, double range) {
  double sum = 0;
  for (int64_t i = 0; i < n; i++)
    sum += fabs(cycle[i].range - range) < 1e-12 ? cycle[i].count : 0;
  return sum;
}

/* ASTM E1049-85, figure 6; values between the turning points change nothing. */
static void astm_example(void **state) {
  bw_context *context = check_context(state);
  const double history[] = {-2, 1, 1, -3, 5, -1, 3, 0, -4, 4, 1, -2};
  static const double expected[][2] = {{3, 0.5}, {4, 1.5}, {6, 0.5}, {8, 1}, {9, 0.5}};
  bw_cycle *cycle = NULL;
  int64_t n = 0;
  double sum = 0;
  check_ok(context, bw_rainflow(context, 12, history, &cycle, &n));
  for (int k = 0; k < 5; k++)
    check_near(counted(cycle, n, expected[k][0]), expected[k][1], 1e-15);
  for (int64_t i = 0; i < n; i++) {
    sum += cycle[i].count;
    if (cycle[i].count == 1)
      check_near(cycle[i].mean, 1, 1e-15); /* E-F, from -1 to 3 */
  }
  check_near(sum, 4, 1e-15);
  bw_free(cycle);
  const double bad[] = {1, NAN};
  check_fails(context, BW_INVALID, "value 2", bw_rainflow(context, 2, bad, &cycle, &n));
  check_ok(context, bw_rainflow(context, 0, bad, &cycle, &n));
  assert_int_equal(n, 0);
  bw_free(cycle);
}

/* The ranges of all cycles, twice counted, are the way of the history. */
static void ranges_sum_to_the_way(void **state) {
  bw_context *context = check_context(state);
  enum { COUNT = 5000 };
  double *history = numbers(COUNT), way = 0, sum = 0;
  bw_cycle *cycle = NULL;
  int64_t n = 0;
  random_field(3, COUNT, history);
  for (int i = 1; i < COUNT; i++)
    way += fabs(history[i] - history[i - 1]);
  check_ok(context, bw_rainflow(context, COUNT, history, &cycle, &n));
  for (int64_t i = 0; i < n; i++)
    sum += 2 * cycle[i].count * cycle[i].range;
  check_near(sum, way, 1e-10 * way);
  bw_free(cycle);
  free(history);
}

static double one_damage(bw_context *context, const bw_life_curve *curve, const double *stress,
                         int64_t steps, const double *factor) {
  double damage = -1;
  check_ok(context, bw_fatigue_damage(context, curve, 1, 1, &stress, steps, factor, &damage));
  return damage;
}

/* Five half cycles of the whole range and two of half of it: reversed tension and reversed shear of
 * one von Mises stress do the same damage; a mean raises it by Goodman; compression is its mirror
 * without a mean. */
static void constant_amplitude(void **state) {
  bw_context *context = check_context(state);
  const double tension[6] = {100e6}, shear[6] = {0, 0, 0, 100e6 / 1.7320508075688772};
  const double factor[] = {0, 1, -1, 1, -1, 1, -1, 0}, pulsing[] = {0, 1, 0};
  bw_life_curve curve;
  bw_life_curve_default(&curve);
  curve.amplitude = 200e6;
  double n = 1e6 * pow(2, 5);
  check_near(one_damage(context, &curve, tension, 8, factor) * n, 2.5 + pow(0.5, 5), 1e-9);
  check_near(one_damage(context, &curve, shear, 8, factor) * n, 2.5 + pow(0.5, 5), 1e-9);
  check_near(one_damage(context, &curve, tension, 3, pulsing) * n, pow(0.5, 5), 1e-9);
  curve.strength = 400e6;
  check_near(one_damage(context, &curve, tension, 3, pulsing) * n, pow(0.5 / (1 - 0.125), 5), 1e-9);
  const double pressed[6] = {-100e6};
  check_near(one_damage(context, &curve, pressed, 3, pulsing) * n, pow(0.5, 5), 1e-9);
  curve.limit = 101e6;
  assert_true(one_damage(context, &curve, tension, 8, factor) == 0);
  curve.strength = 40e6;
  assert_true(one_damage(context, &curve, tension, 3, pulsing) == INFINITY);
  const double *stress = tension;
  double damage;
  curve.exponent = 0.5;
  check_fails(context, BW_INVALID, "exponent",
              bw_fatigue_damage(context, &curve, 1, 1, &stress, 3, pulsing, &damage));
  bw_life_curve_default(&curve);
  check_fails(context, BW_INVALID, "amplitude of the life curve",
              bw_fatigue_damage(context, &curve, 1, 1, &stress, 3, pulsing, &damage));
}

/* Two cases that act together are one case of their sum, on any number of threads. */
static void cases_add_up(void **state) {
  bw_context *context = check_context(state);
  enum { PLACES = 1000, STEPS = 60 };
  double *a = numbers(6 * PLACES), *b = numbers(6 * PLACES), *sum = numbers(6 * PLACES);
  double *one = numbers(PLACES), *two = numbers(PLACES), *factor = numbers(STEPS);
  double *both = numbers(2 * STEPS);
  const double *cases[2] = {a, b}, *summed = sum;
  bw_life_curve curve;
  bw_life_curve_default(&curve);
  curve.amplitude = 1;
  random_field(1, 6 * PLACES, a);
  random_field(2, 6 * PLACES, b);
  random_field(3, STEPS, factor);
  for (int i = 0; i < 6 * PLACES; i++)
    sum[i] = a[i] + b[i];
  for (int i = 0; i < STEPS; i++)
    both[2 * i] = both[2 * i + 1] = factor[i];
  check_ok(context, bw_set_threads(context, 1));
  check_ok(context, bw_fatigue_damage(context, &curve, PLACES, 1, &summed, STEPS, factor, one));
  check_ok(context, bw_set_threads(context, 3));
  check_ok(context, bw_fatigue_damage(context, &curve, PLACES, 2, cases, STEPS, both, two));
  for (int i = 0; i < PLACES; i++)
    check_near(two[i], one[i], 1e-9 * one[i]);
  free(a);
  free(b);
  free(sum);
  free(one);
  free(two);
  free(factor);
  free(both);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  const double history[5] = {0, 2, -1, 3, 0}, tension[6] = {1e8}, *stress = tension;
  bw_cycle *cycle = NULL;
  bw_life_curve curve;
  int64_t n = -1;
  double damage;
  void *none = NULL;
  bw_life_curve_default(&curve);
  curve.amplitude = 1e8;
  check_ok(context, bw_set_threads(context, 1));
  bw_fail_allocation(1, true);
  bw_status counting = bw_rainflow(context, 5, history, &cycle, &n);
  bw_fail_allocation(1, true);
  bw_status damaging = bw_fatigue_damage(context, &curve, 1, 1, &stress, 5, history, &damage);
  bw_fail_allocation(0, false);
  assert_int_equal(counting, BW_MEMORY);
  assert_int_equal(damaging, BW_MEMORY);
  assert_true(cycle == NULL && n == -1); /* nothing is handed out on failure */
  check_allocations(context, none, bw_rainflow(context, 5, history, &cycle, &n));
  check_allocations(context, none,
                    bw_fatigue_damage(context, &curve, 1, 1, &stress, 5, history, &damage));
  bw_free(cycle);
}

/* Static solutions: those of another mesh are refused, and nothing is left behind without memory.
 */
static void static_solutions(void **state) {
  bw_context *context = check_context(state);
  const double history[5] = {0, 2, -1, 3, 0}, g[3] = {0, 0, -1e6}, origin[3] = {0}, axis[3] = {1};
  const bw_static *cases[2] = {NULL, NULL};
  bw_static *rest[2] = {NULL, NULL};
  void *none = NULL;
  bw_life_curve curve;
  bw_life_curve_default(&curve);
  curve.amplitude = 1e8;
  check_ok(context, bw_set_threads(context, 1));
  for (int k = 0; k < 2; k++) {
    bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.04, 3, 1, 1, 2);
    bw_material *material = body_material(context);
    bw_selection *held = NULL;
    bw_model *model = NULL;
    check_ok(context, bw_select_plane(context, mesh, origin, axis, 1e-9, &held));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_model_fix(context, model, held));
    check_ok(context, bw_model_gravity(context, model, g));
    check_ok(context, bw_statics(context, model, NULL, NULL, &rest[k]));
    cases[k] = rest[k];
    bw_release(held);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
  int nodes = rest[0]->model->mesh->node_count;
  double *damage = numbers(nodes), *expected = numbers(nodes), *stress = numbers(6 * nodes);
  const double twice[10] = {0, 0, 2, 2, -1, -1, 3, 3, 0, 0}, *of_nodes = stress;
  check_fails(context, BW_INVALID, "another mesh",
              bw_static_damage(context, &curve, 2, cases, 5, twice, damage));
  check_ok(context, bw_static_damage(context, &curve, 1, cases, 5, history, damage));
  check_ok(context, bw_static_stress(context, cases[0], true, stress));
  check_ok(context, bw_fatigue_damage(context, &curve, nodes, 1, &of_nodes, 5, history, expected));
  for (int i = 0; i < nodes; i++)
    check_near(damage[i], expected[i], 1e-12 * expected[i]);
  check_allocations(context, none, bw_static_damage(context, &curve, 1, cases, 5, history, damage));
  free(damage);
  free(expected);
  free(stress);
  bw_release(rest[0]);
  bw_release(rest[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(astm_example), check_test(ranges_sum_to_the_way), check_test(constant_amplitude),
      check_test(cases_add_up), check_test(memory_failures),       check_test(static_solutions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
