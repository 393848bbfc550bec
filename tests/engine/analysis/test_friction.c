/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Pressure with friction: the cone's columns, the linear program in groups by our own method and by
 * GLPK, facets of the cone, forbidden surfaces. */
#include "pressed.h"

#include "lp/backends.h"

static double worst_of(bw_context *context, const pressed_body *s,
                       const bw_worst_load_options *options, const double *f, double *pressure) {
  double value = 0;
  check_ok(context, bw_worst_loads(context, s->basis, s->dof_map, options, 1, f, pressure, &value,
                                   NULL, NULL));
  return value;
}

/* The columns of a node: their mean is the pressure alone; on a plane each is inclined by the angle
 * of friction; and nowhere do they hold more than friction allows. */
static void columns_lie_on_the_cone(void **state) {
  bw_context *context = check_context(state);
  const double friction = 0.4;
  for (int kind = 0; kind < 3; kind++) {
    const int cells[3] = {3, 4, 2};
    bw_mesh *mesh = NULL;
    if (kind < 2)
      mesh = make_box(context, 1, 2, 0.5, 3, 4, 2, 1 + kind);
    else
      check_ok(context, bw_mesh_mapped_box(context, cells, 2, bulge, NULL, &mesh));
    pressed_body plain, rough;
    pressed_open(context, &plain, mesh, false, 0, 0);
    pressed_open(context, &rough, mesh, false, friction, 5);
    assert_int_equal(plain.basis->directions, 1);
    assert_int_equal(rough.basis->directions, 5);
    assert_int_equal(rough.nodes, plain.n);
    int flat = 0;
    for (size_t j = 0; j < plain.n; j++) {
      double normal[3] = {0, 0, 0};
      for (int64_t e = plain.basis->start[j]; e < plain.basis->start[j + 1]; e++)
        for (int k = 0; k < 3; k++)
          normal[k] += plain.basis->coefficient[3 * e + k];
      double pressed = bw_norm(normal), area = plain.basis->area[j];
      int64_t size = plain.basis->start[j + 1] - plain.basis->start[j];
      for (int64_t e = 0; e < size; e++)
        for (int k = 0; k < 3; k++) {
          double mean = 0;
          for (size_t d = 0; d < 5; d++)
            mean += rough.basis->coefficient[3 * (rough.basis->start[5 * j + d] + e) + k] / 5;
          check_near(mean, plain.basis->coefficient[3 * (plain.basis->start[j] + e) + k],
                     1e-12 * area);
        }
      for (size_t d = 0; d < 5; d++) {
        double drag[3] = {-normal[0], -normal[1], -normal[2]};
        assert_true(rough.basis->area[5 * j + d] == area);
        assert_int_equal(rough.basis->node[5 * j + d], plain.basis->node[j]);
        for (int64_t e = rough.basis->start[5 * j + d]; e < rough.basis->start[5 * j + d + 1]; e++)
          for (int k = 0; k < 3; k++)
            drag[k] += rough.basis->coefficient[3 * e + k];
        assert_true(bw_norm(drag) <= friction * area * (1 + 1e-9));
        if (pressed < area * (1 - 1e-9))
          continue; /* at an edge, or curved */
        flat++;
        check_near(bw_norm(drag), friction * area, 1e-9 * area);
        check_near(bw_dot(drag, normal), 0, 1e-9 * area * area);
      }
    }
    assert_true(kind == 2 || flat > 0);
    pressed_close(&plain);
    pressed_close(&rough);
    bw_release(mesh);
  }
}

/* Each backend alone, in the scaled form. GLPK takes a second or two for the larger ones. */
static void backends_agree(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 4; kind++) {
    bw_mesh *mesh = kind == 0   ? make_bar(context, dumbbell_profile, 12, 4, 1)
                    : kind == 1 ? make_box(context, 1, 1, 1, 5, 5, 5, 2)
                    : kind == 2 ? make_box(context, 1, 0.7, 0.3, 24, 18, 9, 1)
                                : make_box(context, 1, 1, 1, 40, 40, 10, 1);
    pressed_body s;
    pressed_open(context, &s, mesh, false, kind == 3 ? 1.5 : 0.3, kind == 1 ? 3 : 6);
    int backends = kind > 1 && !getenv("BARWRIGHT_FULL") ? 1 : LP_BACKENDS;
    double area = 0;
    for (size_t j = 0; j < s.n; j += (size_t)s.basis->directions)
      area += s.basis->area[j];
    for (int tight = 0; tight < 3; tight++) {
      const double share[3] = {0.01, 0.1, 0.9};
      bw_worst_load_options options = {.pressure = 1, .force = share[tight] * area};
      options.force_is_max = kind == 1 && tight == 1;
      bwi_load_program *loads = NULL;
      check_ok(context, bwi_load_program_create(context, s.basis, s.dof_map, &options, &loads));
      const bwi_linear_program *program = &loads->lp;
      assert_int_equal(program->groups, s.nodes + options.force_is_max);
      assert_int_equal(program->levels, kind == 3 ? 2 : 1);
      size_t n = (size_t)program->columns, m = (size_t)program->rows;
      double *cost = BW_NEW(context, double, n), *shares = BW_NEW(context, double, n), y[7];
      double first[3] = {0};
      bwi_vertex vertex = {BW_NEW(context, int32_t, m), BW_NEW(context, uint8_t, n), 0};
      for (int b = 0; b < backends; b++) {
        const bwi_lp_method *method = lp_backends[b];
        void *opened = NULL;
        check_ok(context, method->open(context, program, 0, &opened));
        for (int i = 0; i < 3; i++) {
          double *f = pressed_objective(context, &s, i);
          for (size_t j = 0; j < n; j++) {
            int32_t from = loads->source[j];
            cost[j] = from < 0 ? 0 : f[from] / s.basis->area[from];
          }
          /* All attempts of ours; of GLPK the first that ends. */
          bool done = false;
          for (int attempt = 0; attempt < method->attempts && !done; attempt++) {
            double start = bw_seconds();
            bw_status status = method->solve(context, opened, cost, attempt, &vertex);
            double seconds = bw_seconds() - start;
            if (b == 1 && status == BW_CONVERGENCE)
              continue;
            check_ok(context, status);
            done = b == 1;
            bwi_solution solution = {shares, y, 0, 0, 0};
            check_ok(context,
                     bwi_linear_program_evaluate(context, program, cost, &vertex, &solution));
            if (getenv("BARWRIGHT_FULL"))
              printf("  %s, attempt %d, %zu columns: %d iterations, %.2f ms, violation %.1e, gap "
                     "%.1e\n",
                     method->name, attempt, n, vertex.iterations, 1e3 * seconds, solution.violation,
                     solution.gap);
            assert_true(solution.violation < 1e-9 && solution.gap < 1e-8);
            if (b == 0 && attempt == 0)
              first[i] = solution.value;
            check_near(solution.value, first[i], 1e-8 * fabs(first[i]));
          }
          assert_true(b == 0 || done);
          bw_free(f);
        }
        method->close(opened);
      }
      bw_free(cost);
      bw_free(shares);
      bw_free(vertex.basic);
      bw_free(vertex.at_upper);
      bwi_load_program_destroy(loads);
    }
    pressed_close(&s);
    bw_release(mesh);
  }
}

/* Pyramids of 4, 8 and 16 facets lie in each other and in the cone; the pyramid around the cone, of
 * friction / cos(pi / m), holds all of them. */
static void facets_converge_from_below(void **state) {
  bw_context *context = check_context(state);
  const double friction = 0.5, pi = 3.14159265358979323846;
  bw_mesh *mesh = make_box(context, 1, 0.7, 0.3, 8, 6, 3, 1);
  pressed_body plain;
  pressed_open(context, &plain, mesh, false, 0, 0);
  for (int which = 0; which < 4; which++) {
    double former = 0;
    for (int facets = 4; facets <= 16; facets *= 2) {
      pressed_body inside, around;
      pressed_open(context, &inside, mesh, false, friction, facets);
      pressed_open(context, &around, mesh, false, friction / cos(pi / facets), facets);
      bw_worst_load_options options = {.pressure = 1, .force = 0.3};
      double *f = pressed_objective(context, &inside, which),
             *g = pressed_objective(context, &around, which);
      double *p = BW_NEW(context, double, inside.n), total = 0;
      if (facets == 4) {
        double *h = pressed_objective(context, &plain, which);
        former = worst_of(context, &plain, &options, h, p);
        bw_free(h);
      }
      double above = worst_of(context, &around, &options, g, p);
      double value = worst_of(context, &inside, &options, f, p);
      assert_true(value >= former * (1 - 1e-7) && value <= above * (1 + 1e-7));
      assert_true(facets > 4 || value > 1.05 * former); /* friction adds something here */
      for (size_t j = 0; j < inside.n; j += (size_t)facets) {
        double sum = 0;
        for (size_t k = 0; k < (size_t)facets; k++) {
          assert_true(p[j + k] >= 0);
          sum += p[j + k];
        }
        assert_true(sum <= options.pressure * (1 + 1e-9));
        total += sum * inside.basis->area[j];
      }
      check_near(total, options.force, 1e-8 * options.force);
      former = value;
      bw_free(f);
      bw_free(g);
      bw_free(p);
      pressed_close(&inside);
      pressed_close(&around);
    }
  }
  pressed_close(&plain);
  bw_release(mesh);
}

/* A cone that is hardly open: the linear program without friction, solved by the other method. */
static void little_friction_is_none(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_bar(context, dumbbell_profile, 12, 4, 1);
  pressed_body plain, rough;
  pressed_open(context, &plain, mesh, false, 0, 0);
  pressed_open(context, &rough, mesh, false, 1e-12, 4);
  double area = 0;
  for (size_t j = 0; j < plain.n; j++)
    area += plain.basis->area[j];
  bw_worst_load_options options = {.pressure = 1, .force = 0.1 * area};
  double *p = BW_NEW(context, double, rough.n);
  for (int which = 0; which < 4; which++) {
    double *f = pressed_objective(context, &plain, which),
           *g = pressed_objective(context, &rough, which);
    double value = worst_of(context, &plain, &options, f, p);
    check_near(worst_of(context, &rough, &options, g, p), value, 1e-8 * fabs(value));
    bw_free(f);
    bw_free(g);
  }
  bw_free(p);
  pressed_close(&plain);
  pressed_close(&rough);
  bw_release(mesh);
}

static void bad_options_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 1, 1, 1, 1);
  bw_pressure_basis *basis = NULL;
  const bw_pressure_options bad[] = {
      {.friction = -1, .friction_facets = 8},
      {.friction = NAN, .friction_facets = 8},
      {.friction = 0.3, .friction_facets = 2},
      {.friction = 0.3, .friction_facets = BW_MAX_FRICTION_FACETS + 1}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_int_equal(bw_pressure_basis_create(context, mesh, &bad[i], &basis), BW_INVALID);
  assert_null(basis);
  bw_release(mesh);
}

static void allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 3, 3, 3, 1);
  bw_dof_map *dof_map = NULL;
  bw_selection *top = NULL;
  const double up[3] = {0, 0, 1};
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  check_ok(context, bw_select_normal_cone(context, mesh, up, 0.1, &top));
  check_ok(context, bw_set_threads(context, 1));
  for (int b = 0; b < LP_BACKENDS; b++) {
    bw_lp_solver *solver = lp_backend(context, b);
    bw_worst_load_options limits = {.pressure = 1, .force = 0.1};
    const bw_pressure_options options = {.forbidden = top, .friction = 0.8, .friction_facets = 3};
    limits.lp = solver;
    check_each_allocation(context, status, 20) {
      double f[56 * 3], p[56 * 3], value;
      bw_pressure_basis *basis = NULL;
      for (int j = 0; j < 56 * 3; j++)
        f[j] = j % 7;
      status = bw_pressure_basis_create(context, mesh, &options, &basis);
      if (status == BW_OK)
        status = bw_worst_loads(context, basis, dof_map, &limits, 1, f, p, &value, NULL, NULL);
      bw_release(basis);
    }
    bw_release(solver);
  }
  bw_release(top);
  bw_release(dof_map);
  bw_release(mesh);
}

check_main(check_test(columns_lie_on_the_cone), check_test(backends_agree),
           check_test(facets_converge_from_below), check_test(little_friction_is_none),
           check_test(bad_options_are_refused), check_test(allocation_failures))
