/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Steady conduction against closed forms, NAFEMS T2 and T4, a manufactured solution, and what holds
 * for every body: the balance of heat, and the same answer by every solver. */
#include "heat_bodies.h"

/* A slab of two layers between two fluids: 1/h1 + l/k + (L - l)/k' + 1/h2 in series. T is linear in
 * each layer, so that elements are exact. */
static void test_slab(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    const double k = 40, outside = 5, L = 0.05, l = 0.02, h1 = 200, h2 = 50, t1 = 400, t2 = 300;
    bw_mesh *mesh = body_box(context, L, 0.02, 0.03, 5, 2, 3, order);
    bw_material *material = heat_layers(context, mesh, 0, l, heat_material(context, k, 0, 0),
                                        heat_material(context, outside, 0, 0));
    bw_heat *heat = heat_body(context, mesh, material);
    heat_on_plane(context, heat, 0, 0,
                  (bw_heat_condition){.kind = BW_HEAT_CONVECTION, .value = t1, .coefficient = h1});
    heat_on_plane(context, heat, 0, L,
                  (bw_heat_condition){.kind = BW_HEAT_CONVECTION, .value = t2, .coefficient = h2});
    bw_heat_solution *solution = heat_steady(context, heat, NULL);
    double q = (t1 - t2) / (1 / h1 + l / k + (L - l) / outside + 1 / h2);
    for (int i = 0; i < mesh->node_count; i++) {
      double x = mesh->node[3 * i];
      check_near(solution->temperature[i],
                 t1 - q * (1 / h1 + fmin(x, l) / k + fmax(x - l, 0) / outside), 1e-9);
    }
    check_near(solution->heat_in[0], q * 0.02 * 0.03, 1e-9 * q);
    double *flux = numbers(3 * (int64_t)solution->mesh->node_count), relative;
    check_ok(context, bw_heat_flux(context, solution, flux));
    check_near(flux[0], q, 1e-7 * q);
    check_near(flux[1], 0, 1e-7 * q);
    check_ok(context, bw_heat_error(context, solution, NULL, &relative));
    check_near(relative, 0, 1e-8);
    free(flux);
    bw_release(solution);
    bw_release(heat);
  }
}

/* An orthotropic body turned by 30 degrees about z: T linear, the flux is -K grad T. */
static void test_orthotropic(void **state) {
  bw_context *context = check_context(state);
  bw_material *plain = NULL, *warm = NULL, *turned = NULL;
  const bw_orthotropic constants = {.name = "wood",
                                    .young = {10e9, 1e9, 1e9},
                                    .poisson = {0.3, 0, 0.3},
                                    .poisson_t = {0, 0.03, 0}};
  const bw_thermal thermal = {.conductivity = {3, 1, 0.5}};
  double c = sqrt(0.75), s = 0.5;
  const double rotation[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  check_ok(context, bw_material_orthotropic(context, &constants, &plain));
  check_ok(context, bw_material_with_thermal(context, plain, &thermal, &warm));
  check_ok(context, bw_material_rotated(context, warm, rotation, &turned));
  bw_release(plain);
  bw_release(warm);
  bw_heat *heat = heat_body(context, body_box(context, 1, 1, 1, 2, 3, 2, 2), turned);
  bw_array *field = NULL;
  check_ok(context, bw_array_create(context, BW_F64, heat->mesh->node_count, 1, &field));
  for (int i = 0; i < heat->mesh->node_count; i++)
    ((double *)field->data)[i] = heat->mesh->node[3 * i]; /* T = x */
  heat_on_all(context, heat,
              (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 1, .nodal = field});
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  double *flux = numbers(3 * (int64_t)heat->mesh->element_count);
  check_ok(context, bw_heat_element_flux(context, solution, flux));
  check_near(flux[0], -(3 * c * c + s * s), 1e-10);
  check_near(flux[1], -(3 - 1) * c * s, 1e-10);
  check_near(flux[2], 0, 1e-10);
  free(flux);
  bw_release(field);
  bw_release(solution);
  bw_release(heat);
}

static double wave(const double x[3]) {
  return exp(x[0]) * sin(2 * x[1]) * cos(x[2]);
}

/* T = exp(x) sin 2y cos z with the source that it needs, -k (1 - 4 - 1) T: errors fall as h^2 with
 * tet4 and h^3 with tet10. */
static void test_orders(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    double error[2];
    for (int level = 0; level < 2; level++) {
      const double k = 2.5;
      int cells = level ? 8 : 4;
      bw_heat *heat = heat_body(context, body_box(context, 1, 1, 1, cells, cells, cells, order),
                                heat_material(context, k, 0, 0));
      bw_array *field = NULL;
      check_ok(context, bw_array_create(context, BW_F64, heat->mesh->node_count, 1, &field));
      for (int i = 0; i < heat->mesh->node_count; i++)
        ((double *)field->data)[i] = wave(heat->mesh->node + 3 * i);
      heat_on_all(context, heat,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 1, .nodal = field});
      const bw_heat_condition source = {.kind = BW_HEAT_SOURCE, .value = 4 * k, .nodal = field};
      check_ok(context, bw_heat_add(context, heat, &source));
      bw_heat_solution *solution = heat_steady(context, heat, NULL);
      error[level] = heat_error(solution, wave);
      bw_release(field);
      bw_release(solution);
      bw_release(heat);
    }
    check_near(log2(error[0] / error[1]), order + 1, 0.15);
  }
}

/* A box of unit sides bent to the quarter of a hollow cylinder of these radii. */
static bw_mesh *bend(bw_context *context, const bw_mesh *box, double a, double b) {
  const double pi = 3.14159265358979323846;
  bw_mesh *mesh = NULL;
  double *node = numbers(3 * (int64_t)box->node_count);
  for (int i = 0; i < box->node_count; i++) {
    double r = a + (b - a) * box->node[3 * i], angle = pi / 2 * box->node[3 * i + 1];
    node[3 * i] = r * cos(angle);
    node[3 * i + 1] = r * sin(angle);
    node[3 * i + 2] = box->node[3 * i + 2];
  }
  check_ok(context, bw_mesh_moved(context, box, node, &mesh));
  free(node);
  return mesh;
}

static void hold_radius(bw_context *context, bw_heat *heat, double r, double temperature) {
  const bw_mesh *mesh = heat->mesh;
  uint8_t *facets = calloc((size_t)mesh->facet_count, 1);
  bw_selection *on = NULL;
  for (int f = 0; f < mesh->facet_count; f++) {
    facets[f] = 1;
    for (int c = 0; c < 3; c++) {
      const double *x = mesh->node + 3 * mesh->facet[mesh->nodes_per_facet * f + c];
      facets[f] = facets[f] && fabs(hypot(x[0], x[1]) - r) < 1e-9;
    }
  }
  check_ok(context, bw_select_mask(context, mesh, facets, NULL, &on));
  const bw_heat_condition held = {.kind = BW_HEAT_TEMPERATURE, .on = on, .value = temperature};
  check_ok(context, bw_heat_add(context, heat, &held));
  bw_release(on);
  free(facets);
}

/* A hollow cylinder, a quarter of it: the heat of a radian and metre is (T1 - T2) / (ln(m/a) / k +
 * ln(b/m) / k'), with T linear in ln(r) in each layer; tet10. */
static void hollow_cylinder(bw_context *context, bool layers) {
  const double a = 0.1, b = 0.3, m = 0.2, t1 = 500, t2 = 300, pi = 3.14159265358979323846;
  const double k = 15, outside = layers ? 60 : k;
  bw_mesh *box = body_box(context, 1, 1, 0.05, 20, 10, 1, 2), *mesh = bend(context, box, a, b);
  bw_material *material = heat_layers(context, box, 0, 0.5, heat_material(context, k, 0, 0),
                                      heat_material(context, outside, 0, 0));
  bw_release(box);
  bw_heat *heat = heat_body(context, mesh, material);
  hold_radius(context, heat, a, t1);
  hold_radius(context, heat, b, t2);
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  double q = (t1 - t2) / (log(m / a) / k + log(b / m) / outside);
  for (int i = 0; i < mesh->node_count; i++) {
    double r = hypot(mesh->node[3 * i], mesh->node[3 * i + 1]);
    double drop = log(fmin(r, m) / a) / k + log(fmax(r, m) / m) / outside;
    check_near(solution->temperature[i], t1 - q * drop, 0.05);
  }
  double through = 0.05 * pi / 2 * q;
  check_near(solution->heat_in[0], through, 2e-4 * through);
  bw_release(solution);
  bw_release(heat);
}

static void test_cylinder(void **state) {
  bw_context *context = check_context(state);
  hollow_cylinder(context, false);
  hollow_cylinder(context, true);
}

/* The energy norm of the error of the flux over that of the flux, where it is Q / r outwards. */
static double true_flux_error(const bw_heat_solution *solution, double Q, double k) {
  const bw_mesh *mesh = solution->mesh;
  double sum = 0, whole = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *element = mesh->element + e * mesh->nodes_per_element;
    double x[10][3], point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
    for (int n = 0; n < mesh->nodes_per_element; n++)
      memcpy(x[n], mesh->node + 3 * element[n], sizeof x[n]);
    int points = bw_tet_quadrature(4, point, weight);
    for (int p = 0; p < points; p++) {
      double slope[10][3], shape[10], at[3] = {0}, flux[3] = {0};
      double size =
          weight[p] * bw_tet_gradient(mesh->order, (const double(*)[3])x, point[p], slope);
      bw_tet_shape(mesh->order, point[p], shape);
      for (int n = 0; n < mesh->nodes_per_element; n++)
        for (int c = 0; c < 3; c++) {
          at[c] += shape[n] * x[n][c];
          flux[c] -= k * slope[n][c] * solution->temperature[element[n]];
        }
      double r2 = at[0] * at[0] + at[1] * at[1];
      sum += size * (pow(flux[0] - Q * at[0] / r2, 2) + pow(flux[1] - Q * at[1] / r2, 2) +
                     flux[2] * flux[2]);
      whole += size * (flux[0] * flux[0] + flux[1] * flux[1] + flux[2] * flux[2]);
    }
  }
  return sqrt(sum / whole);
}

/* The estimate of the error of the flux over the true one, as docs/theory/heat.md has it. */
static void test_error_of_cylinder(void **state) {
  bw_context *context = check_context(state);
  const double a = 0.1, b = 0.3, k = 15;
  for (int order = 1; order <= 2; order++)
    for (int cells = 4, wide = 0; cells <= 12; cells += 4 * wide, wide = !wide) {
      bw_mesh *box = body_box(context, 1, 1, 0.2, cells, cells, wide ? cells : 1, order);
      bw_heat *heat = heat_body(context, bend(context, box, a, b), heat_material(context, k, 0, 0));
      hold_radius(context, heat, a, 500);
      hold_radius(context, heat, b, 300);
      bw_heat_solution *solution = heat_steady(context, heat, NULL);
      double relative;
      check_ok(context, bw_heat_error(context, solution, NULL, &relative));
      double ratio = relative / true_flux_error(solution, k * 200 / log(b / a), k);
      assert_true(order == 1 ? ratio > 0.965 && ratio < 1.035 : ratio > 0.785 && ratio < 0.965);
      bw_release(solution);
      bw_release(heat);
      bw_release(box);
    }
}

/* Two layers side by side: T is the same line in both, and the flux along their interface jumps. */
static void test_flux_beside_interface(void **state) {
  bw_context *context = check_context(state);
  const double k[2] = {10, 40};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 0.1, 0.04, 0.02, 5, 4, 2, order);
    bw_material *material = heat_layers(context, mesh, 1, 0.02, heat_material(context, k[0], 0, 0),
                                        heat_material(context, k[1], 0, 0));
    bw_heat *heat = heat_body(context, mesh, material);
    heat_on_plane(context, heat, 0, 0,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 400});
    heat_on_plane(context, heat, 0, 0.1,
                  (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 300});
    bw_heat_solution *solution = heat_steady(context, heat, NULL);
    double *flux = numbers(3 * (int64_t)mesh->node_count), relative;
    check_ok(context, bw_heat_flux(context, solution, flux));
    for (int i = 0; i < mesh->node_count; i++)
      check_near(flux[3 * i], 1000 * k[mesh->node[3 * i + 1] > 0.02 - 1e-9], 1e-6);
    check_ok(context, bw_heat_error(context, solution, NULL, &relative));
    check_near(relative, 0, 1e-8);
    free(flux);
    bw_release(solution);
    bw_release(heat);
  }
}

/* A plate heated on one side that radiates from the other: sigma eps (T^4 - Ts^4) = q there, and
 * linear through the thickness. */
static void test_radiating_plate(void **state) {
  bw_context *context = check_context(state);
  const double q = 2e4, emissivity = 0.8, sink = 280, k = 20, L = 0.04;
  double surface = pow(q / (emissivity * BW_STEFAN_BOLTZMANN) + pow(sink, 4), 0.25);
  for (int order = 1; order <= 2; order++) {
    bw_heat *heat = heat_body(context, body_box(context, 0.1, 0.1, L, 2, 2, 2, order),
                              heat_material(context, k, 0, 0));
    heat_on_plane(context, heat, 2, 0, (bw_heat_condition){.kind = BW_HEAT_FLUX, .value = q});
    heat_on_plane(
        context, heat, 2, L,
        (bw_heat_condition){.kind = BW_HEAT_RADIATION, .value = sink, .coefficient = emissivity});
    bw_heat_solution *solution = heat_steady(context, heat, NULL);
    assert_true(solution->iterations > 2 && solution->change <= 1e-10);
    check_near(heat_at(solution, 0, 0, L), surface, 1e-7);
    check_near(heat_at(solution, 0, 0, 0), surface + q * L / k, 1e-7);
    bw_release(solution);
    bw_release(heat);
  }
  /* Linearised about the right temperature it gives the same, in one iteration. */
  bw_heat *heat = heat_body(context, body_box(context, 0.1, 0.1, L, 2, 2, 2, 1),
                            heat_material(context, k, 0, 0));
  heat_on_plane(context, heat, 2, 0, (bw_heat_condition){.kind = BW_HEAT_FLUX, .value = q});
  heat_on_plane(
      context, heat, 2, L,
      (bw_heat_condition){
          .kind = BW_HEAT_RADIATION, .value = sink, .coefficient = emissivity, .about = surface});
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  assert_int_equal(solution->iterations, 1);
  check_near(heat_at(solution, 0, 0, L), surface, 1e-7);
  bw_release(solution);
  bw_release(heat);
}

/* NAFEMS T2: a bar of 0.1 m at 1000 K that radiates from its end: 927.0 K there. */
static void test_nafems_t2(void **state) {
  bw_context *context = check_context(state);
  bw_heat *heat = heat_body(context, body_box(context, 0.1, 0.01, 0.01, 10, 1, 1, 2),
                            heat_material(context, 55.6, 0, 0));
  heat_on_plane(context, heat, 0, 0,
                (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 1000});
  heat_on_plane(context, heat, 0, 0.1,
                (bw_heat_condition){.kind = BW_HEAT_RADIATION, .value = 300, .coefficient = 0.98});
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  check_near(heat_at(solution, 0.1, 0, 0), 927.0, 0.1);
  bw_release(solution);
  bw_release(heat);
}

/* NAFEMS T4: 0.6 m x 1 m, one edge at 100, one insulated, two in convection: 18.25 degrees C. */
static void test_nafems_t4(void **state) {
  bw_context *context = check_context(state);
  bw_heat *heat = heat_body(context, body_box(context, 0.6, 1, 0.05, 12, 20, 1, 2),
                            heat_material(context, 52, 0, 0));
  const bw_heat_condition film = {.kind = BW_HEAT_CONVECTION, .value = 0, .coefficient = 750};
  heat_on_plane(context, heat, 0, 0.6, film);
  heat_on_plane(context, heat, 1, 1, film);
  heat_on_plane(context, heat, 1, 0,
                (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 100});
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  check_near(heat_at(solution, 0.6, 0.2, 0), 18.25, 0.1);
  bw_release(solution);
  bw_release(heat);
}

/* k = k0 (1 + b T) between two temperatures: the flux is that of k at their mean (Kirchhoff's
 * transformation), and k0 (T + b T^2 / 2) is linear. */
static void test_conductivity_by_temperature(void **state) {
  bw_context *context = check_context(state);
  bw_material *plain = heat_material(context, 10, 0, 0), *material = NULL;
  bw_thermal thermal = plain->thermal;
  thermal.rows = 2;
  thermal.temperature[0] = 0, thermal.factor[0] = 1;
  thermal.temperature[1] = 1000, thermal.factor[1] = 3;
  check_ok(context, bw_material_with_thermal(context, plain, &thermal, &material));
  bw_release(plain);
  bw_heat *heat = heat_body(context, body_box(context, 0.2, 0.05, 0.05, 16, 1, 1, 2), material);
  heat_on_plane(context, heat, 0, 0,
                (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 800});
  heat_on_plane(context, heat, 0, 0.2,
                (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 200});
  bw_heat_solution *solution = heat_steady(context, heat, NULL);
  double b = 2e-3, flux = 10 * (1 + b * 500) * 600 / 0.2;
  check_near(solution->heat_in[0], flux * 0.0025, 1e-5 * flux * 0.0025);
  for (int i = 0; i < heat->mesh->node_count; i++) {
    double t = solution->temperature[i], left = 800 + b / 2 * 800 * 800;
    check_near(t + b / 2 * t * t, left - flux / 10 * heat->mesh->node[3 * i], 0.05);
  }
  assert_true(solution->iterations > 2);
  bw_release(solution);
  bw_release(heat);
}

/* On a shaken box with every kind of condition: what goes in is what goes out, and solvers agree.
 */
static void test_balance_and_solvers(void **state) {
  bw_context *context = check_context(state);
  bw_solver *jacobi = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *two_level = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_TWO_LEVEL});
  for (int order = 1; order <= 2; order++)
    for (uint64_t seed = 1; seed <= 4; seed++) {
      bw_mesh *box = body_box(context, 0.1, 0.08, 0.06, 8, 6, 5, order), *mesh = NULL;
      double *node = numbers(3 * (int64_t)box->node_count), *shift = numbers(9);
      random_field(seed, 9, shift);
      for (int i = 0; i < box->node_count; i++)
        for (int c = 0; c < 3; c++) {
          const double *x = box->node + 3 * i;
          node[3 * i + c] = x[c] + 0.2 * (shift[3 * c] * x[0] + shift[3 * c + 1] * x[1] +
                                          shift[3 * c + 2] * x[2] * x[0] / 0.1);
        }
      bw_selection *on[3] = {NULL};
      check_ok(context, bw_mesh_moved(context, box, node, &mesh));
      bw_heat *heat = heat_body(context, mesh, heat_material(context, 1 + (double)seed, 0, 0));
      for (int part = 0; part < 3; part++) { /* facets in turn */
        uint8_t *facets = calloc((size_t)mesh->facet_count, 1);
        for (int f = 0; f < mesh->facet_count; f++)
          facets[f] = f * 5 / mesh->facet_count == part;
        check_ok(context, bw_select_mask(context, mesh, facets, NULL, &on[part]));
        free(facets);
      }
      const bw_heat_condition all[] = {
          {.kind = BW_HEAT_TEMPERATURE, .on = on[0], .value = 350},
          {.kind = BW_HEAT_CONVECTION, .on = on[1], .value = 290, .coefficient = 30},
          {.kind = BW_HEAT_RADIATION, .on = on[2], .value = 400, .coefficient = 0.5},
          {.kind = BW_HEAT_FLUX, .on = on[2], .value = -500},
          {.kind = BW_HEAT_POWER, .on = on[1], .value = 7},
          {.kind = BW_HEAT_POWER, .value = 3},
          {.kind = BW_HEAT_SOURCE, .value = 2000}};
      for (size_t c = 0; c < sizeof all / sizeof *all; c++)
        check_ok(context, bw_heat_add(context, heat, &all[c]));
      bw_heat_solution *first = heat_steady(context, heat, NULL);
      check_near(first->heat_in[4], 7, 1e-9);
      check_near(first->heat_in[5], 3, 1e-9);
      assert_string_equal(first->report.preconditioner, "cholesky"); /* kept while T changes */
      for (int way = 0; way < order; way++) {
        bw_solver *pcg =
            body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG,
                                                     .preconditioner = way ? two_level : jacobi});
        bw_heat_solution *other = heat_steady(context, heat, pcg);
        for (int i = 0; i < mesh->node_count; i++)
          check_near(other->temperature[i], first->temperature[i], 1e-6);
        assert_string_equal(other->report.preconditioner, way ? "two_level" : "jacobi");
        if (way) /* whatever the size: a few dozen for each iteration of Newton */
          assert_true(other->report.iterations <= 50 * other->iterations);
        bw_release(other);
        bw_release(pcg);
      }
      bw_release(first);
      bw_release(heat);
      bw_release(box);
      for (int part = 0; part < 3; part++)
        bw_release(on[part]);
      free(node), free(shift);
    }
  bw_release(jacobi);
  bw_release(two_level);
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_material *cold = body_material(context);
  bw_heat *heat = NULL;
  bw_heat_solution *solution = NULL;
  check_fails(context, BW_INVALID, "has no conductivity",
              bw_heat_create(context, mesh, cold, &heat));
  heat = heat_body(context, mesh, heat_material(context, 1, 0, 0));
  check_fails(context, BW_UNCONSTRAINED, "no steady temperature",
              bw_heat_steady(context, heat, NULL, &solution));
  bw_heat_condition wrong = {.kind = BW_HEAT_FLUX, .value = 1};
  check_fails(context, BW_INVALID, "needs a selection", bw_heat_add(context, heat, &wrong));
  wrong = (bw_heat_condition){.kind = BW_HEAT_SOURCE, .value = NAN};
  check_fails(context, BW_INVALID, "not a finite", bw_heat_add(context, heat, &wrong));
  bw_selection *on = NULL;
  check_ok(context, bw_select_all(context, heat->mesh, &on));
  wrong = (bw_heat_condition){.kind = BW_HEAT_RADIATION, .on = on, .value = 300, .coefficient = 2};
  check_fails(context, BW_INVALID, "emissivity", bw_heat_add(context, heat, &wrong));
  wrong.coefficient = 1, wrong.value = -20;
  check_fails(context, BW_INVALID, "kelvin", bw_heat_add(context, heat, &wrong));
  bw_release(on);
  /* more heat out than a body at absolute zero can give */
  heat_on_plane(context, heat, 0, 0,
                (bw_heat_condition){.kind = BW_HEAT_RADIATION, .value = 10, .coefficient = 1});
  heat_on_plane(context, heat, 0, 1, (bw_heat_condition){.kind = BW_HEAT_FLUX, .value = -1e4});
  assert_int_not_equal(bw_heat_steady(context, heat, NULL, &solution), BW_OK);
  bw_release(heat);
  bw_release(cold);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_solver *two_level = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_TWO_LEVEL});
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = two_level});
  bw_heat *heat =
      heat_body(context, body_box(context, 1, 1, 1, 1, 1, 1, 2), heat_material(context, 1, 0, 0));
  heat_on_plane(context, heat, 0, 0,
                (bw_heat_condition){.kind = BW_HEAT_RADIATION, .value = 300, .coefficient = 1});
  heat_on_plane(context, heat, 0, 1, (bw_heat_condition){.kind = BW_HEAT_POWER, .value = 10});
  bw_heat_solution *solution = NULL;
  const bw_heat_options options = {.solver = pcg};
  check_allocations(context, solution, bw_heat_steady(context, heat, NULL, &solution));
  check_allocations(context, solution, bw_heat_steady(context, heat, &options, &solution));
  bw_release(heat);
  bw_release(pcg);
  bw_release(two_level);
}

static bw_status left_half(void *data, int64_t count, const double *at, uint8_t *inside) {
  (void)data;
  for (int64_t i = 0; i < count; i++)
    inside[i] = at[3 * i] < 0.5;
  return BW_OK;
}

/* Contact when memory ends: the separated mesh, the condition, and the solution. */
static void test_contact_memory(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *whole = body_box(context, 1, 1, 1, 2, 1, 1, 2), *split = NULL, *mesh = NULL;
  check_ok(context, bw_mesh_split(context, whole, "left", left_half, NULL, &split, NULL));
  check_fails(context, BW_INVALID, "no region 3", bw_mesh_separate(context, split, 2, &mesh));
  check_allocations(context, mesh, bw_mesh_separate(context, split, 1, &mesh));
  check_ok(context, bw_mesh_separate(context, split, 1, &mesh));
  bw_heat *heat = heat_body(context, mesh, heat_material(context, 1, 0, 0));
  bw_selection *side[2] = {NULL, NULL};
  for (int32_t r = 0; r < 2; r++)
    check_ok(context, bw_select_region(context, heat->mesh, r, &side[r]));
  const bw_heat_condition contact = {
      .kind = BW_HEAT_CONTACT, .on = side[0], .with = side[1], .coefficient = 10};
  check_each_allocation(context, status, 1) {
    status = bw_heat_add(context, heat, &contact);
    assert_int_equal(heat->condition_count, status == BW_OK);
  }
  heat_on_plane(context, heat, 0, 0,
                (bw_heat_condition){.kind = BW_HEAT_TEMPERATURE, .value = 300});
  heat_on_plane(context, heat, 0, 1, (bw_heat_condition){.kind = BW_HEAT_POWER, .value = 10});
  bw_heat_solution *solution = NULL;
  check_allocations(context, solution, bw_heat_steady(context, heat, NULL, &solution));
  check_ok(context, bw_heat_steady(context, heat, NULL, &solution));
  check_near(heat_at(solution, 1, 0, 0), 311, 1e-9); /* 10 W over 1 m2, both resist: 10, and 1 */
  bw_release(solution);
  solution = NULL;
  bw_solver *two_level = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_TWO_LEVEL});
  bw_heat_options options;
  bw_heat_options_default(&options);
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = two_level});
  options.solver = pcg;
  check_allocations(context, solution, bw_heat_steady(context, heat, &options, &solution));
  check_ok(context, bw_heat_steady(context, heat, &options, &solution));
  check_near(heat_at(solution, 1, 0, 0), 311, 1e-6);
  bw_release(solution);
  bw_release(pcg);
  bw_release(two_level);
  bw_release(side[0]);
  bw_release(side[1]);
  bw_release(heat);
  bw_release(split);
  bw_release(whole);
}

check_main(check_test(test_slab), check_test(test_orthotropic), check_test(test_orders),
           check_test(test_cylinder), check_test(test_error_of_cylinder),
           check_test(test_flux_beside_interface), check_test(test_radiating_plate),
           check_test(test_nafems_t2), check_test(test_nafems_t4),
           check_test(test_conductivity_by_temperature), check_test(test_balance_and_solvers),
           check_test(test_misuse), check_test(test_memory), check_test(test_contact_memory))
