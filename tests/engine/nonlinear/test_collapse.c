/* Loads past what a solid carries, equilibria that are not stable, large motions of what is
 * constrained; and that a solution can be stopped and can run out of memory. */
#include "solid_box.h"
#include "solver_by.h"

static const double bar_size[3] = {0.2, 0.2, 0.8};

/* A St. Venant-Kirchhoff bar carries at most E / (3 sqrt 3) in compression. */
static void test_limit_point(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {1, 1, 2};
  const double size[3] = {0.2, 0.2, 0.4};
  double max = 1 / (3 * sqrt(3));
  for (int k = 0; k < 2; k++) {
    box b;
    bw_solid_static *result = NULL;
    bw_newton_options options;
    bw_newton_options_default(&options);
    options.iterations = 40;
    box_make(context, &b, cells, size, BW_ST_VENANT_KIRCHHOFF, 1, 0, 0);
    box_symmetric(context, &b);
    box_force(context, &b, 2, 1, 0, 0, -(k ? 1.1 : 0.95) * max * 0.04);
    bw_status status = bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result);
    assert_non_null(result);
    if (k == 0) {
      assert_int_equal(status, BW_OK);
    } else {
      double stretch = 1 + box_mean(&b, result->displacement, 2, 1, 2) / 0.4;
      assert_true(status == BW_CONVERGENCE || status == BW_GEOMETRY);
      assert_non_null(strstr(bw_message(context), "load factor"));
      assert_false(result->complete);
      /* the last equilibrium is on the way there, shortly before the limit */
      check_near(result->newton.load, 1 / 1.1, 0.03);
      assert_true(result->newton.load <= 1 / 1.1);
      check_near(-0.5 * stretch * (stretch * stretch - 1), 1.1 * max * result->newton.load, 1e-5);
    }
    bw_release(result);
    box_free(&b);
  }
}

/* Seen from outside while a solution goes on. */
typedef struct watch {
  bw_context *context;
  int calls, stop_at; /* 0: not at all */
  double fraction;
} watch;

static void look(void *data, const char *stage, double fraction) {
  watch *w = (watch *)data;
  if (strcmp(stage, "equilibrium") != 0)
    return; /* of a factor */
  assert_true(fraction >= w->fraction - 1e-12 && fraction <= 1);
  w->fraction = fraction;
  if (++w->calls == w->stop_at)
    bw_cancel(w->context);
}

/* A block of rubber far past what it carries, in every way to solve: the work is bounded by what is
 * allowed, progress never goes back and ends at its whole, what was reached is an equilibrium, and
 * it can be stopped on the way. */
static void test_bounded(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 8};
  const double size[3] = {0.04, 0.04, 0.12}, gravity[3] = {0, 0, -1e6};
  for (int linear = 0; linear < 3; linear++)
    for (int k = 0; k < 4; k++) {
      box b;
      bw_coarse *coarse;
      bw_solid *below;
      bw_solid_static *result = NULL;
      bw_newton_options options;
      watch w = {.context = context, .stop_at = k == 2 ? 3 : k == 3 ? 30 : 0};
      box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.45, 1000);
      box_hold(context, &b, 2, 0, true, true, true, 0);
      check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
      check_ok(context,
               bw_coarsen(context, BW_COARSE_NAIVE, NULL, b.material_table, b.grid, 1, &coarse));
      check_ok(context,
               bw_solid_create(context, coarse->grid, coarse->material_table, NULL, &below));
      const bw_coarsening *coarsening = coarse->coarsening[0];
      const bw_solid *one = below;
      bw_newton_options_default(&options);
      options.solver = newton_by(linear);
      options.coarse_count = 1;
      options.coarsening = &coarsening;
      options.coarse = &one;
      options.max_iterations = k == 1 ? 40 : 0;
      bw_set_progress(context, look, &w);
      bw_status status = bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result);
      bw_set_progress(context, NULL, NULL);
      if (w.stop_at) {
        assert_int_equal(status, BW_CANCELLED);
        assert_null(result);
        assert_int_equal(w.calls, w.stop_at);
        bw_clear_cancel(context);
      } else {
        const bw_newton_report *r = &result->newton;
        int64_t max = k ? 40 : 500;
        assert_int_equal(status, BW_CONVERGENCE);
        assert_non_null(strstr(bw_message(context), "load factor"));
        assert_false(result->complete);
        assert_true(r->iterations <= max);
        assert_true(r->cg_iterations + r->stability_iterations <= 100 * (max + 1));
        assert_true(r->factorisations <= 12 * (r->iterations + r->failed_steps + 1));
        assert_true(k || r->residual <= options.tolerance);
        assert_true(r->failed_steps <= 16);
        if (k) {
          assert_non_null(strstr(bw_message(context), "max_iterations"));
          assert_true(w.fraction > 0.9);
        }
      }
      bw_release(result);
      bw_release(below);
      bw_release(coarse);
      box_free(&b);
    }
  box b;
  bw_solid_static *result = NULL;
  bw_newton_options options;
  bw_newton_options_default(&options);
  options.max_iterations = -1;
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.45, 1000);
  box_hold(context, &b, 2, 0, true, true, true, 0);
  check_fails(context, BW_INVALID, "over all load steps",
              bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  box_free(&b);
}

/* A load that failed is not tried again from as far: the limit of a bar that lies at 0.47 of its
 * load is come near by halves, with half of the load tried three times instead of five. */
static void test_barrier(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {1, 1, 2};
  const double size[3] = {0.2, 0.2, 0.4};
  box b;
  bw_solid_static *result = NULL;
  box_make(context, &b, cells, size, BW_ST_VENANT_KIRCHHOFF, 1, 0, 0);
  box_symmetric(context, &b);
  box_force(context, &b, 2, 1, 0, 0, -1 / (3 * sqrt(3)) * 0.04 / 0.47);
  bw_status status = bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result);
  assert_true(status == BW_CONVERGENCE || status == BW_GEOMETRY);
  const bw_newton_report *r = &result->newton;
  assert_true(r->load <= 0.47 && r->load > 0.47 - 1.0 / 256);
  int at_half = 0;
  for (int i = 0; i < r->history_count; i++)
    at_half += (i == 0 || r->history[i - 1].load != r->history[i].load) &&
               fabs(r->history[i].load - 0.5) < 1e-12;
  assert_int_equal(at_half, 3);
  assert_int_equal(r->failed_steps, 7);
  bw_release(result);
  box_free(&b);
}

/* Loads on what has next to no stiffness only move by very short steps: given up early. */
static void test_creeping(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 4};
  const double size[3] = {0.04, 0.04, 0.08};
  box b;
  bw_solid_static *result = NULL;
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e-3, 0.3, 0);
  box_hold(context, &b, 2, 0, true, true, true, 0);
  box_force(context, &b, 2, 1, 0, 0, -100);
  check_fails(context, BW_CONVERGENCE, "very short steps",
              bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
  assert_true(result->newton.iterations <= 9 * 8);
  bw_release(result);
  box_free(&b);
}

/* A slender column pressed straight down buckles, whichever way the solution is made. */
static void test_buckling(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {1, 1, 24};
  const double size[3] = {0.05, 0.06, 1};
  double sideways[2];
  for (int k = 0; k < 2; k++) {
    box b;
    bw_solid_static *result;
    bw_newton_options options;
    bw_newton_options_default(&options);
    options.solver = newton_by(k ? NEWTON_JACOBI : NEWTON_DIRECT);
    box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0, 0);
    box_hold(context, &b, 2, 0, true, true, true, 0);
    box_hold(context, &b, 2, 1, true, true, true, -0.05);
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
    double max = 0;
    for (int32_t n = 0; n < b.grid->node_count; n++)
      max = fmax(max, fabs(result->displacement[3 * (int64_t)n]));
    sideways[k] = max;
    assert_true(max > 0.05);
    /* far less than a straight column stores */
    assert_true(result->energy < 0.8 * 0.5 * 1e6 * 0.05 * 0.06 * 0.05 * 0.05);
    bw_release(result);
    box_free(&b);
  }
  check_near(sideways[0], sideways[1], 1e-4 * sideways[0]);
}

/* A column of 3 x 3 x 40 neo-Hookean cells between its constrained ends, pressed to 0.8 % below
 * and 1.5 % above the shortening at which the factor of its tangent fails first (0.0212; Euler's is
 * 0.0185, to which cells as wide as a third of it add). Symmetric in every respect: nothing but the
 * search for a direction tells a solution without a matrix that the straight column is no longer
 * stable, and the bent one has two ways to go that are nearly alike, along a side and along a
 * diagonal, of which only the first ends in a minimum. */
static void test_column(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {3, 3, 40};
  const double size[3] = {0.03, 0.03, 0.4}, pressed[2] = {0.021, 0.0215};
  box b;
  bw_coarse *coarse;
  bw_solid *below;
  for (int k = 0; k < 2; k++) {
    double energy[3], sideways[3];
    box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.45, 0);
    box_hold(context, &b, 2, 0, true, true, true, 0);
    box_hold(context, &b, 2, 1, true, true, true, -pressed[k] * size[2]);
    check_ok(context,
             bw_coarsen(context, BW_COARSE_NAIVE, NULL, b.material_table, b.grid, 1, &coarse));
    check_ok(context, bw_solid_create(context, coarse->grid, coarse->material_table, NULL, &below));
    const bw_coarsening *coarsening = coarse->coarsening[0];
    const bw_solid *one = below;
    for (int linear = 0; linear < 3; linear++) {
      bw_solid_static *result;
      bw_newton_options options;
      bw_newton_options_default(&options);
      options.solver = newton_by(linear);
      options.coarse_count = 1;
      options.coarsening = &coarsening;
      options.coarse = &one;
      check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
      assert_int_equal(result->newton.undecided, 0);
      assert_true(linear == NEWTON_DIRECT || result->newton.stability_iterations > 10);
      energy[linear] = result->energy;
      sideways[linear] = 0;
      for (int32_t n = 0; n < b.grid->node_count; n++)
        for (int c = 0; c < 2; c++)
          sideways[linear] = fmax(sideways[linear], fabs(result->displacement[3 * (int64_t)n + c]));
      bw_release(result);
    }
    for (int linear = 0; linear < 3; linear++) {
      /* at 0.0215 the straight column stores 2e-4 more than the bent one */
      check_near(energy[linear], energy[0], (k ? 1e-6 : 1e-9) * energy[0]);
      if (k == 0) /* the bulge of 0.45 x 0.021 x half of the width, a little more */
        check_near(sideways[linear], 1.49e-4, 1e-6);
      else
        check_near(sideways[linear], 4.88e-3, 2e-4);
    }
    bw_release(below);
    bw_release(coarse);
    box_free(&b);
  }
}

/* A stability test that is not allowed to converge reports so. */
static void test_undecided(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 16};
  box b;
  for (int k = 0; k < 2; k++) {
    bw_solid_static *result;
    bw_newton_options options;
    bw_newton_options_default(&options);
    bw_solver jacobi = *newton_by(NEWTON_JACOBI);
    jacobi.options.max_iterations = k ? 1000 : 40;
    options.solver = &jacobi;
    options.tolerance = 1e-4;
    bw_clear_warnings(context);
    box_make(context, &b, cells, bar_size, BW_NEO_HOOKEAN, 1e5, 0.3, 0);
    box_hold(context, &b, 2, 0, true, true, true, 0);
    box_force(context, &b, 2, 1, 0, 0, 10);
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
    assert_int_equal(result->newton.undecided, k ? 0 : 1);
    if (k)
      assert_null(bw_warning_at(context, 0));
    else
      assert_non_null(strstr(bw_warning_at(context, 0), "40 iterations of conjugate gradients"));
    bw_release(result);
    box_free(&b);
  }
}

/* One end of a bar turned by half a turn in steps, each from the shape before. */
static void test_twist(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 8};
  for (int law = 0; law < BW_LAWS; law++) {
    box b;
    bw_newton *newton;
    bw_solid_static *before = NULL;
    double energy = 0;
    box_make(context, &b, cells, bar_size, (bw_law)law, 1e5, 0.3, 0);
    check_ok(context, bw_newton_create(context, &newton));
    for (int step = 1; step <= 4; step++) {
      double angle = M_PI * step / 4;
      bw_load_case *load_case;
      bw_solid_static *result;
      bw_newton_options options;
      bool all[3] = {true, true, true};
      bw_newton_options_default(&options);
      options.start = before ? before->displacement : NULL;
      check_ok(context, bw_load_case_create(context, b.grid, &load_case));
      for (int32_t n = 0; n < b.grid->node_count; n++) {
        double x[3], value[3] = {0, 0, 0};
        bw_grid_position(b.grid, n, x);
        if (x[2] > 1e-9 && x[2] < 0.8 - 1e-9)
          continue;
        if (x[2] > 0.4) {
          double p = x[0] - 0.1, q = x[1] - 0.1;
          value[0] = cos(angle) * p - sin(angle) * q - p;
          value[1] = sin(angle) * p + cos(angle) * q - q;
        }
        check_ok(context, bw_load_case_fix(context, load_case, 1, &n, all, value));
      }
      check_ok(context, bw_solid_statics(context, b.solid, load_case, newton, &options, &result));
      assert_true(result->complete && result->newton.shape.inverted == 0);
      assert_true(result->energy > 1.5 * energy);
      energy = result->energy;
      /* the middle has turned half as far */
      for (int32_t n = 0; n < b.grid->node_count; n++) {
        double x[3];
        bw_grid_position(b.grid, n, x);
        if (fabs(x[2] - 0.4) > 1e-9 || x[0] > 1e-9 || x[1] > 1e-9)
          continue;
        const double *u = result->displacement + 3 * (int64_t)n;
        double turned = atan2(x[1] + u[1] - 0.1, x[0] + u[0] - 0.1) - atan2(-0.1, -0.1);
        check_near(turned, angle / 2, 1e-5);
      }
      bw_release(before);
      bw_release(load_case);
      before = result;
    }
    bw_release(before);
    bw_release(newton);
    box_free(&b);
  }
}

/* Large movements of what is constrained, that would turn elements inside out in one go. */
static void test_crushed(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 8};
  for (int law = 0; law < BW_LAWS; law++) {
    box b;
    bw_solid_static *result;
    box_make(context, &b, cells, bar_size, (bw_law)law, 1e5, 0.3, 0);
    box_hold(context, &b, 2, 0, true, true, true, 0);
    box_hold(context, &b, 2, 1, false, false, true, 2 * 0.8);
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
    assert_true(result->complete);
    bw_release(result);
    box_free(&b);
  }
  /* pressed through itself: no shape without inverted elements is there */
  box b;
  bw_solid_static *result = NULL;
  bw_newton_options options;
  bw_newton_options_default(&options);
  options.iterations = 30;
  options.min_step = 1.0 / 16;
  const int32_t few[3] = {2, 2, 2};
  const double cube[3] = {0.8, 0.8, 0.8};
  box_make(context, &b, few, cube, BW_NEO_HOOKEAN, 1e5, 0.3, 0);
  box_hold(context, &b, 2, 0, true, true, true, 0);
  box_hold(context, &b, 2, 1, true, true, true, -1.2 * 0.8);
  check_fails(context, BW_CONVERGENCE, "load factor",
              bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  assert_true(result->newton.load < 1 / 1.2 && result->newton.load > 0.2);
  assert_int_equal(result->newton.shape.inverted, 0);
  bw_release(result);
  box_free(&b);
}

/* Where no shift makes the tangent of badly shaped elements definite, their own projection is tried
 * once more: a block pressed to a tenth of its height between rough plates. */
static void test_pressed_flat(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {3, 3, 6};
  const double size[3] = {0.03, 0.03, 0.06};
  box b;
  bw_solid_static *result;
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e6, 0.3, 0);
  box_hold(context, &b, 2, 0, true, true, true, 0);
  box_hold(context, &b, 2, 1, true, true, true, -0.9 * 0.06);
  check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
  assert_int_equal(result->newton.shape.inverted, 0);
  assert_true(result->newton.iterations < 200);
  bw_release(result);
  box_free(&b);
}

static void bent(bw_context *context, box *b) {
  const int32_t cells[3] = {6, 2, 2};
  const double size[3] = {0.6, 0.2, 0.2};
  box_make(context, b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  box_hold(context, b, 0, 0, true, true, true, 0);
  box_force(context, b, 0, 1, 0, 0, -800);
}

static void stop(void *data, const char *stage, double fraction) {
  (void)stage;
  (void)fraction;
  bw_cancel((bw_context *)data);
}

static void test_cancel(void **state) {
  bw_context *context = check_context(state);
  box b;
  bw_solid_static *result = NULL;
  bent(context, &b);
  bw_set_progress(context, stop, context);
  check_fails(context, BW_CANCELLED, "",
              bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
  assert_null(result);
  bw_set_progress(context, NULL, NULL);
  bw_clear_cancel(context);
  check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
  bw_release(result);
  box_free(&b);
}

static void test_no_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  for (int k = 0; k < 3; k++) {
    box b;
    bw_newton *newton;
    bw_newton_options options;
    const int32_t cells[3] = {2, 2, 2};
    const double size[3] = {0.2, 0.2, 0.2};
    double point[3] = {0, 0, -0.001}, normal[3] = {0, 0, 1}, gravity[3] = {0, 0, -10};
    bw_coarse *coarse;
    bw_solid *coarse_solid;
    box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
    box_hold(context, &b, 0, 0, true, true, true, 0);
    check_ok(context,
             bw_coarsen(context, BW_COARSE_NAIVE, NULL, b.material_table, b.grid, 1, &coarse));
    check_ok(context,
             bw_solid_create(context, coarse->grid, coarse->material_table, NULL, &coarse_solid));
    const bw_coarsening *coarsening = coarse->coarsening[0];
    const bw_solid *one = coarse_solid;
    bw_newton_options_default(&options);
    options.solver = newton_by(k);
    options.coarse_count = 1;
    options.coarsening = &coarsening;
    options.coarse = &one;
    check_ok(context, bw_newton_create(context, &newton));
    check_each_allocation(context, status, 1) {
      bw_load_case *load_case = NULL;
      bw_solid_static *result = NULL;
      status = bw_load_case_create(context, b.grid, &load_case);
      if (status == BW_OK)
        status = bw_load_case_contact_plane(context, load_case, point, normal, NULL, NULL, NULL);
      if (status == BW_OK)
        status = bw_load_case_gravity(context, load_case, gravity);
      int32_t node[9];
      bool all[3] = {true, true, true};
      if (status == BW_OK)
        status = bw_load_case_fix(context, load_case, box_end(&b, 0, 0, node), node, all, NULL);
      if (status == BW_OK)
        status = bw_load_case_force(context, load_case, box_end(&b, 0, 1, node), node, gravity);
      if (status == BW_OK)
        status = bw_solid_statics(context, b.solid, load_case, k == 1 ? newton : NULL, &options,
                                  &result);
      bw_release(result);
      bw_release(load_case);
    }
    bw_release(newton);
    bw_release(coarse_solid);
    bw_release(coarse);
    box_free(&b);
  }
}

check_main(check_test(test_limit_point), check_test(test_bounded), check_test(test_barrier),
           check_test(test_creeping), check_test(test_buckling), check_test(test_column),
           check_test(test_undecided), check_test(test_twist), check_test(test_crushed),
           check_test(test_pressed_flat), check_test(test_cancel), check_test(test_no_memory))
