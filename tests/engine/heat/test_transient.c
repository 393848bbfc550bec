/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Heat in time against closed forms and NAFEMS T3; orders in time; what a step stores. */
#include "heat_bodies.h"

static bw_heat_transient *start(bw_context *context, const bw_heat *heat, double initial,
                                bw_heat_scheme scheme, bool lumped) {
  bw_heat_transient *transient = NULL;
  double *field = numbers(heat->mesh->node_count);
  for (int i = 0; i < heat->mesh->node_count; i++)
    field[i] = initial;
  const bw_heat_transient_options options = {.scheme = scheme, .lumped = lumped};
  check_ok(context, bw_heat_transient_create(context, heat, field, &options, &transient));
  free(field);
  return transient;
}

static void march(bw_context *context, bw_heat_transient *transient, double until, int steps) {
  for (int i = 0; i < steps; i++) {
    check_ok(context, bw_heat_transient_step(context, transient, until / steps, 0, NULL));
    const bw_heat_solution *now = transient->now;
    check_near(now->imbalance, 0, 1e-9 * (now->throughput + fabs(now->stored)));
  }
  check_near(transient->now->time, until, 1e-9 * until);
}

/* A small cube in a fluid: its temperature is uniform and falls as exp(-h A t / (rho c V)). Errors
 * in time fall as the step, and as its square. */
static void test_lumped_cooling(void **state) {
  bw_context *context = check_context(state);
  const double a = 0.01, h = 10, rate = h * 6 / (a * 2700 * 900), until = 1 / rate;
  for (int scheme = 0; scheme < 3; scheme++) {
    double error[2];
    for (int level = 0; level < 2; level++) {
      bw_heat *heat = heat_body(context, body_box(context, a, a, a, 2, 2, 2, 1 + scheme % 2),
                                heat_material(context, 1e4, 2700, 900));
      heat_on_all(context, heat,
                  (bw_heat_condition){.kind = BW_HEAT_CONVECTION, .value = 300, .coefficient = h});
      bw_heat_transient *t = start(context, heat, 400, (bw_heat_scheme)scheme, false);
      march(context, t, until, level ? 40 : 20);
      error[level] = heat_at(t->now, 0, 0, 0) - (300 + 100 * exp(-1));
      bw_release(t);
      bw_release(heat);
    }
    check_near(log2(fabs(error[0] / error[1])), scheme ? 2 : 1, scheme ? 0.25 : 0.1);
    assert_true(fabs(error[1]) < (scheme ? 0.2 : 0.6));
  }
}

/* A long bar whose end jumps: T = T0 + (T1 - T0) erfc(x / sqrt(4 alpha t)). */
static void test_half_space(void **state) {
  bw_context *context = check_context(state);
  const double alpha = 50 / (7800 * 500.0), until = 100;
  for (int scheme = 0; scheme < 3; scheme++) {
    bw_heat *heat = heat_body(context, body_box(context, 0.3, 0.01, 0.01, 60, 1, 1, 2),
                              heat_material(context, 50, 7800, 500));
    heat_on_plane(context, heat, 0, 0,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 400});
    bw_heat_transient *t = start(context, heat, 300, (bw_heat_scheme)scheme, false);
    march(context, t, until, 100);
    for (int i = 0; i < heat->mesh->node_count; i++) {
      double x = heat->mesh->node[3 * i];
      check_near(t->now->temperature[i], 300 + 100 * erfc(x / sqrt(4 * alpha * until)),
                 scheme ? 0.05 : 0.25);
    }
    bw_release(t);
    bw_release(heat);
  }
}

/* Two layers that differ in conductivity, density and heat capacity, one end at 400, the other
 * isolated: finite volumes in one dimension, of 400 cells and the same steps of backward Euler,
 * which Thomas' algorithm solves, give the temperatures. */
static void test_two_layers(void **state) {
  bw_context *context = check_context(state);
  enum { CELLS = 400, STEPS = 100 };
  const double k[2] = {50, 2}, c[2] = {7800 * 500.0, 1200 * 1500.0}, L = 0.1, until = 400;
  const double w = L / CELLS, h = until / STEPS;
  double cell[CELLS], lower[CELLS + 1], upper[CELLS], right[CELLS];
  for (int i = 0; i < CELLS; i++)
    cell[i] = 300;
  lower[0] = 2 * k[0] / w; /* (W/(m2 K)) from the end to the first cell */
  lower[CELLS] = 0;
  for (int i = 1; i < CELLS; i++) {
    double a = k[2 * (i - 1) >= CELLS], b = k[2 * i >= CELLS];
    lower[i] = 2 * a * b / (a + b) / w;
  }
  for (int s = 0; s < STEPS; s++) {
    for (int i = 0; i < CELLS; i++) {
      double capacity = c[2 * i >= CELLS] * w / h, before = i ? upper[i - 1] : 0;
      double pivot = capacity + lower[i] + lower[i + 1] - (i ? lower[i] * before : 0);
      upper[i] = lower[i + 1] / pivot;
      right[i] = (capacity * cell[i] + lower[i] * (i ? right[i - 1] : 400)) / pivot;
    }
    for (int i = CELLS - 1; i >= 0; i--)
      cell[i] = right[i] + (i < CELLS - 1 ? upper[i] * cell[i + 1] : 0);
  }
  for (int lumped = 0; lumped < 2; lumped++) {
    bw_mesh *mesh = body_box(context, L, 0.005, 0.005, lumped ? 120 : 60, 1, 1, lumped ? 1 : 2);
    bw_material *material =
        heat_layers(context, mesh, 0, L / 2, heat_material(context, k[0], 7800, 500),
                    heat_material(context, k[1], 1200, 1500));
    bw_heat *heat = heat_body(context, mesh, material);
    heat_on_plane(context, heat, 0, 0,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 400});
    bw_heat_transient *t = start(context, heat, 300, BW_HEAT_EULER, lumped);
    march(context, t, until, STEPS);
    for (int i = 0; i < mesh->node_count; i++) {
      double at = mesh->node[3 * i] / w - 0.5;
      int left = (int)fmin(fmax(at, 0), CELLS - 2);
      double expected = cell[left] + (cell[left + 1] - cell[left]) * (at - left);
      if (2 * left == CELLS - 2) /* on the interface the flux is the same from both sides */
        expected = (k[0] * cell[left] + k[1] * cell[left + 1]) / (k[0] + k[1]);
      check_near(t->now->temperature[i], expected, lumped ? 0.05 : 0.02);
    }
    bw_release(t);
    bw_release(heat);
  }
}

/* Short steps after a jump: the consistent capacity undershoots, the lumped one on a mesh without
 * obtuse angles does not. */
static void test_undershoot(void **state) {
  bw_context *context = check_context(state);
  double lowest[2];
  for (int lumped = 0; lumped < 2; lumped++) {
    bw_heat *heat = heat_body(context, body_box(context, 0.1, 0.01, 0.01, 10, 1, 1, 1),
                              heat_material(context, 50, 7800, 500));
    heat_on_plane(context, heat, 0, 0,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 400});
    bw_heat_transient *t = start(context, heat, 300, BW_HEAT_EULER, lumped);
    march(context, t, 0.1, 2);
    lowest[lumped] = INFINITY;
    for (int i = 0; i < heat->mesh->node_count; i++)
      lowest[lumped] = fmin(lowest[lumped], t->now->temperature[i]);
    bw_release(t);
    bw_release(heat);
  }
  assert_true(lowest[0] < 299);
  check_near(lowest[1], 300, 0.1);
}

/* NAFEMS T3: one end of a bar at 0, the other at 100 sin(pi t / 40): 36.60 degrees C at 0.08 m
 * after 32 s. */
static void test_nafems_t3(void **state) {
  bw_context *context = check_context(state);
  for (int scheme = 0; scheme < 3; scheme++) {
    bw_heat *heat = heat_body(context, body_box(context, 0.1, 0.01, 0.01, 20, 1, 1, 2),
                              heat_material(context, 35, 7200, 440.5));
    heat_on_plane(context, heat, 0, 0, (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE});
    heat_on_plane(context, heat, 0, 0.1, (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE});
    bw_heat_transient *t = start(context, heat, 0, (bw_heat_scheme)scheme, false);
    const int steps = 256;
    for (int i = 1; i <= steps; i++) {
      double time = 32.0 * i / steps;
      check_ok(context,
               bw_heat_set_value(context, heat, 1, 100 * sin(3.14159265358979 * time / 40)));
      check_ok(context, bw_heat_transient_step(context, t, 32.0 / steps, 0, NULL));
    }
    check_near(heat_at(t->now, 0.08, 0, 0), 36.60, scheme ? 0.03 : 0.1);
    bw_release(t);
    bw_release(heat);
  }
}

/* A plate that radiates in the dark: with a high conductivity T^-3 grows evenly in time. */
static void test_radiating_in_time(void **state) {
  bw_context *context = check_context(state);
  const double a = 0.01, mass = 2700 * 900 * a / 6; /* per area */
  bw_heat *heat = heat_body(context, body_box(context, a, a, a, 1, 1, 1, 2),
                            heat_material(context, 1e5, 2700, 900));
  heat_on_all(context, heat,
              (bw_heat_condition){.kind = BW_HEAT_RADIATION, .value = 0, .coefficient = 0.9});
  bw_heat_transient *t = start(context, heat, 1000, BW_HEAT_BDF2, false);
  march(context, t, 100, 400);
  double exact = pow(1e-9 + 3 * 0.9 * BW_STEFAN_BOLTZMANN * 100 / mass, -1 / 3.0);
  check_near(heat_at(t->now, 0, 0, 0), exact, 1e-4 * exact);
  bw_release(t);
  bw_release(heat);
}

/* The estimate of a step's error beside the true one, of a body that cools evenly, for steps that
 * grow; and a step that is refused leaves everything as it was. */
static void test_estimate(void **state) {
  bw_context *context = check_context(state);
  const double a = 0.01, h = 10, rate = h * 6 / (a * 2700 * 900);
  for (int scheme = 0; scheme < 3; scheme++) {
    bw_heat *heat = heat_body(context, body_box(context, a, a, a, 1, 1, 1, 1),
                              heat_material(context, 1e5, 2700, 900));
    heat_on_all(context, heat,
                (bw_heat_condition){.kind = BW_HEAT_CONVECTION, .value = 300, .coefficient = h});
    bw_heat_transient *t = start(context, heat, 400, (bw_heat_scheme)scheme, false);
    double step = 0.02 / rate;
    for (int i = 0; i < 8; i++) {
      double before = heat_at(t->now, 0, 0, 0) - 300;
      check_ok(context, bw_heat_transient_step(context, t, step, 0, NULL));
      double wrong = fabs(heat_at(t->now, 0, 0, 0) - 300 - before * exp(-rate * step));
      if (scheme == BW_HEAT_EULER && i > 3)
        check_near(t->error / wrong, 1, 0.15);
      if (i == 7) /* of second order the states before have errors of the same order */
        check_near(t->error / wrong, 1, 0.5);
      step *= 1.05;
    }
    double time = t->now->time;
    bool taken = true;
    check_ok(context, bw_heat_transient_step(context, t, 20 * step, 1e-6, &taken));
    assert_false(taken);
    check_near(t->now->time, time, 0);
    bw_release(t);
    bw_release(heat);
  }
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  bw_heat_transient *t = NULL;
  double *field = numbers(1000);
  bw_heat *heat = heat_body(context, body_box(context, 1, 1, 1, 1, 1, 1, 2),
                            heat_material(context, 1, 7800, 0));
  check_fails(context, BW_INVALID, "heat capacity",
              bw_heat_transient_create(context, heat, field, NULL, &t));
  bw_release(heat);
  heat = heat_body(context, body_box(context, 1, 1, 1, 1, 1, 1, 2),
                   heat_material(context, 1, 7800, 500));
  const bw_heat_transient_options lumped = {.lumped = true};
  check_fails(context, BW_INVALID, "lumped",
              bw_heat_transient_create(context, heat, field, &lumped, &t));
  check_allocations(context, t, bw_heat_transient_create(context, heat, field, NULL, &t));
  t = start(context, heat, 300, BW_HEAT_EULER, false);
  check_fails(context, BW_INVALID, "above 0", bw_heat_transient_step(context, t, 0, 0, NULL));
  const bw_heat_condition source = {.kind = BW_HEAT_SOURCE, .value = 1};
  check_ok(context, bw_heat_add(context, heat, &source));
  check_fails(context, BW_INVALID, "were added", bw_heat_transient_step(context, t, 1, 0, NULL));
  bw_release(t);
  bw_release(heat);
  free(field);
}

check_main(check_test(test_lumped_cooling), check_test(test_half_space),
           check_test(test_two_layers), check_test(test_undershoot), check_test(test_nafems_t3),
           check_test(test_radiating_in_time), check_test(test_estimate), check_test(test_misuse))
