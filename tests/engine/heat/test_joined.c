/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact that resists and bonds, of meshes that do not match: patch tests, closed forms in time,
 * solvers, and what is refused. */
#include "../joint/pair.h"
#include "heat_bodies.h"

/* Two unit cubes, one on the other, of different cells; a small one on a plate where `partly`. */
static bw_heat *stack(bw_context *context, int order, bool partly, double conductivity,
                      double capacity) {
  double size = partly ? 0.55 : 1, offset[3] = {partly ? 0.2 : 0, partly ? 0.15 : 0, 1};
  bw_mesh *mesh = pair(context, body_box(context, 1, 1, 1, 3, 2, 2, order),
                       body_box(context, size, size, 1, 2, 3, 3, order), offset);
  return heat_body(context, mesh, heat_material(context, conductivity, 1, capacity));
}

static bw_status join(bw_context *context, bw_heat *heat, bool upper_first, double conductance) {
  bw_selection *low = face(context, heat->mesh, 0, 2, 1),
               *high = face(context, heat->mesh, 1, 2, 1);
  const bw_heat_condition joint = {.kind = conductance > 0 ? BW_HEAT_CONTACT : BW_HEAT_BOND,
                                   .on = upper_first ? high : low,
                                   .with = upper_first ? low : high,
                                   .coefficient = conductance};
  bw_status status = bw_heat_add(context, heat, &joint);
  bw_release(low);
  bw_release(high);
  return status;
}

static void load_face(bw_context *context, bw_heat *heat, int body, int k, double at,
                      bw_heat_condition condition) {
  bw_selection *on = face(context, heat->mesh, body, k, at);
  condition.on = on;
  check_ok(context, bw_heat_add(context, heat, &condition));
  bw_release(on);
}

/* T = g . x, and a jump of the flux over the conductance above the interface: the lowest face has
 * this temperature, all others the flux. */
static void linear_temperatures_pass(void **state) {
  bw_context *context = check_context(state);
  const double g[3] = {30, -20, 50}, k = 7;
  const double conductance[3] = {0, 3, 2e5};
  for (int variant = 0; variant < 12; variant++) {
    bool upper_first = variant % 2;
    double h = conductance[variant / 4], jump = h > 0 ? k * g[2] / h : 0;
    bw_heat *heat = stack(context, 1 + variant / 2 % 2, false, k, 0);
    const bw_mesh *mesh = heat->mesh;
    bw_array *exact = NULL;
    check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &exact));
    for (int32_t i = 0; i < mesh->node_count; i++)
      ((double *)exact->data)[i] =
          bw_dot(g, mesh->node + 3 * (int64_t)i) + jump * mesh->component[i];
    check_ok(context, join(context, heat, upper_first, h));
    check_near(heat->condition[0].size, 1, 1e-12);
    load_face(context, heat, 0, 2, 0,
              (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 1, .nodal = exact});
    for (int body = 0; body < 2; body++)
      for (int a = 0; a < 2; a++)
        for (int side = 0; side < 2; side++)
          load_face(context, heat, body, a, side,
                    (bw_heat_condition){.kind = BW_HEAT_FLUX, .value = (side ? k : -k) * g[a]});
    load_face(context, heat, 1, 2, 2, (bw_heat_condition){.kind = BW_HEAT_FLUX, .value = k * g[2]});
    bw_heat_solution *solution = heat_steady(context, heat, NULL);
    for (int32_t i = 0; i < mesh->node_count; i++)
      check_near(solution->temperature[i], bw_array_get(exact, i, 0), 1e-8 * (1 + jump));
    check_near(solution->heat_in[0], (upper_first ? -k : k) * g[2], 1e-8 * k * g[2]);
    bw_release(exact);
    bw_release(solution);
    bw_release(heat);
  }
}

/* Two bodies of nearly one temperature each: their difference decays with h A (1 / C1 + 1 / C2). */
static void contact_decays(void **state) {
  bw_context *context = check_context(state);
  const double h = 2, capacity = 10;
  for (int order = 1; order <= 2; order++) {
    bw_heat *heat = stack(context, order, true, 1e6, capacity);
    const bw_mesh *mesh = heat->mesh;
    double *initial = numbers(mesh->node_count), upper = 0.55 * 0.55 * capacity;
    for (int32_t i = 0; i < mesh->node_count; i++)
      initial[i] = mesh->component[i] ? 400 : 300;
    check_ok(context, join(context, heat, order == 1, h));
    check_near(heat->condition[0].size, 0.55 * 0.55, 1e-12);
    const bw_heat_transient_options options = {.scheme = BW_HEAT_BDF2};
    bw_heat_transient *transient = NULL;
    check_ok(context, bw_heat_transient_create(context, heat, initial, &options, &transient));
    for (int step = 0; step < 200; step++)
      check_ok(context, bw_heat_transient_step(context, transient, 0.02, 0, NULL));
    double rate = h * 0.55 * 0.55 * (1 / capacity + 1 / upper);
    double end = (300 * capacity + 400 * upper) / (capacity + upper);
    double mean = heat_at(transient->now, 0.4, 0.4, 2);
    check_near(mean, end + (400 - end) * exp(-rate * 4), 2e-4 * 100);
    check_near(transient->now->imbalance, 0, 1e-5); /* rounding of 1e6 W/(m K) */
    free(initial);
    bw_release(transient);
    bw_release(heat);
  }
}

/* cos(pi z / 2) along both cubes, insulated: it decays with alpha (pi / 2)^2 through the bond. */
static void a_mode_decays_through_a_bond(void **state) {
  bw_context *context = check_context(state);
  const double pi = 3.14159265358979323846, k = 3, capacity = 10;
  for (int upper_first = 0; upper_first < 2; upper_first++) {
    bw_heat *heat = stack(context, 2, false, k, capacity);
    const bw_mesh *mesh = heat->mesh;
    double *initial = numbers(mesh->node_count), stored = 0;
    for (int32_t i = 0; i < mesh->node_count; i++)
      initial[i] = 100 * cos(pi / 2 * mesh->node[3 * i + 2]);
    check_ok(context, join(context, heat, upper_first, 0));
    const bw_heat_transient_options options = {.scheme = BW_HEAT_CRANK_NICOLSON};
    bw_heat_transient *transient = NULL;
    check_ok(context, bw_heat_transient_create(context, heat, initial, &options, &transient));
    for (int step = 0; step < 100; step++) {
      check_ok(context, bw_heat_transient_step(context, transient, 0.01, 0, NULL));
      stored += 0.01 * transient->now->stored;
    }
    double decay = exp(-k / capacity * pi * pi / 4);
    check_near(heat_at(transient->now, 0.5, 0.5, 0), 100 * decay, 0.1);
    check_near(heat_at(transient->now, 0.5, 0.5, 2), -100 * decay, 0.1);
    check_near(stored, 0, 1e-6);
    /* what passes the middle at the end: k T' = 50 pi k exp(-...), down where T falls */
    check_near(transient->now->heat_in[0], (upper_first ? 1 : -1) * 50 * pi * k * decay,
               0.01 * 50 * pi * k);
    free(initial);
    bw_release(transient);
    bw_release(heat);
  }
}

/* A small cube on a plate by all solvers; the iterations do not grow with the conductance. */
static void solvers_agree(void **state) {
  bw_context *context = check_context(state);
  bw_solver *two_level = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_TWO_LEVEL});
  bw_solver *pcg = body_solver(
      context,
      (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = two_level, .tolerance = 1e-12});
  const double conductance[4] = {0, 1, 1e3, 1e7};
  for (int variant = 0; variant < 8; variant++) {
    bw_heat *heat = stack(context, 2, true, 5, 0);
    check_ok(context, join(context, heat, variant % 2 || conductance[variant / 2] == 0,
                           conductance[variant / 2]));
    load_face(context, heat, 0, 2, 0, (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 3});
    load_face(context, heat, 1, 2, 2, (bw_heat_condition){.kind = BW_HEAT_POWER, .value = 10});
    bw_heat_solution *first = heat_steady(context, heat, NULL);
    bw_heat_solution *other = heat_steady(context, heat, pcg);
    for (int32_t i = 0; i < heat->mesh->node_count; i++)
      check_near(other->temperature[i], first->temperature[i], 1e-6);
    check_near(fabs(first->heat_in[0]), 10, 1e-6);
    assert_string_equal(other->report.preconditioner, "two_level");
    /* 45 to 47 of the first six; about 70 at the largest conductance, where rounding delays 1e-12
     */
    assert_true(other->report.iterations <= 100);
    bw_release(first);
    bw_release(other);
    bw_release(heat);
  }
  bw_release(pcg);
  bw_release(two_level);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  bw_heat *heat = stack(context, 1, true, 5, 0);
  bw_selection *low = face(context, heat->mesh, 0, 2, 1),
               *high = face(context, heat->mesh, 1, 2, 1),
               *top = face(context, heat->mesh, 1, 2, 2);
  bw_heat_condition c = {.kind = BW_HEAT_BOND, .on = high};
  check_fails(context, BW_INVALID, "needs the selection", bw_heat_add(context, heat, &c));
  c.with = high;
  check_fails(context, BW_INVALID, "on both sides", bw_heat_add(context, heat, &c));
  c.with = low;
  c.gap = -1;
  check_fails(context, BW_INVALID, "the gap of a bond", bw_heat_add(context, heat, &c));
  c.gap = 0;
  c.on = top;
  c.with = low;
  check_fails(context, BW_GEOMETRY, "1 m apart", bw_heat_add(context, heat, &c));
  c.kind = BW_HEAT_CONTACT;
  c.coefficient = 1;
  check_fails(context, BW_GEOMETRY, "1 m apart", bw_heat_add(context, heat, &c));
  check_ok(context, join(context, heat, true, 0));
  check_fails(context, BW_INVALID, "in two bonds", join(context, heat, true, 0));
  check_fails(context, BW_INVALID, "has no value", bw_heat_set_value(context, heat, 0, 1));
  assert_int_equal(heat->condition_count, 1);
  bw_heat_solution *solution = NULL;
  check_fails(context, BW_UNCONSTRAINED, "or a bond with a body",
              bw_heat_steady(context, heat, NULL, &solution));
  bw_release(low);
  bw_release(high);
  bw_release(top);
  bw_release(heat);
}

/* With each allocation failing in turn, on the least meshes that do not match. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = pair(context, body_box(context, 1, 1, 1, 1, 1, 1, 2),
                       body_box(context, 1, 1, 1, 2, 1, 1, 2), (double[3]){0, 0, 1});
  bw_heat *heat = heat_body(context, mesh, heat_material(context, 5, 1, 1));
  bw_selection *low = face(context, heat->mesh, 0, 2, 1),
               *high = face(context, heat->mesh, 1, 2, 1);
  const bw_heat_condition joint[2] = {
      {.kind = BW_HEAT_BOND, .on = high, .with = low},
      {.kind = BW_HEAT_CONTACT, .on = high, .with = low, .coefficient = 1}};
  for (int k = 0; k < 2; k++)
    check_each_allocation(context, status, 1) {
      status = bw_heat_add(context, heat, &joint[k]);
      assert_int_equal(heat->condition_count, k + (status == BW_OK));
    }
  bw_release(low);
  bw_release(high);
  load_face(context, heat, 0, 2, 0, (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 3});
  bw_solver *two_level = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_TWO_LEVEL});
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = two_level});
  bw_heat_options options;
  bw_heat_options_default(&options);
  options.solver = pcg;
  options.error = true;
  bw_heat_solution *solution = NULL;
  check_allocations(context, solution, bw_heat_steady(context, heat, &options, &solution));
  bw_release(pcg);
  bw_release(two_level);
  bw_release(heat);
}

check_main(check_test(linear_temperatures_pass), check_test(contact_decays),
           check_test(a_mode_decays_through_a_bond), check_test(solvers_agree), check_test(refuses),
           check_test(memory_failures))
