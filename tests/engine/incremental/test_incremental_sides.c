/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Several right-hand sides, guesses, and the view that serves modes. */
#include "body_system.h"
#include "incremental_bar.h"

static void many_sides(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 11 };
  for (int run = 0; run < 4; run++) {
    int scene = run % 2 * 3;
    bar b;
    bar_make(context, 2, 1, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
    random_field(7, SIDES * size, force);
    memset(force + 4 * size, 0, (size_t)size * sizeof *force);
    b.now.scale[2][2] = 1.03;
    turn_subdomain(&b, 1, 0.05);
    bw_model *model = posed(context, &b);
    bw_system *fresh = NULL;
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.precision = run < 2 ? 64 : 32;
    check_ok(context,
             bw_incremental_system_solve(context, incremental, &options, 1, force, u, NULL));
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
    check_ok(context, body_system(context, model->mesh, b.material, incremental->system->dof_map,
                                  NULL, &fresh));
    check_ok(context, bw_system_solve(context, fresh, SIDES, force, v));
    for (int method = WAY_ITERATE; method >= WAY_REFACTOR; method--) {
      bw_reuse reuse = {0};
      options.solver = solver_by((edit_way)method);
      options.check = true;
      check_ok(context, bw_incremental_system_solve(context, incremental, &options, SIDES, force, u,
                                                    &reuse));
      assert_int_equal(way_of(&reuse), method);
      assert_int_equal(reuse.refinements > 0, options.precision == 32 && method == WAY_REFACTOR);
      for (int k = 0; k < SIDES; k++)
        check_near(difference(u + k * size, v + k * size, size), 0, 1e-8);
      for (int64_t i = 0; i < size; i++)
        check_near(u[4 * size + i], 0, 0);
    }
    memcpy(u, force, (size_t)(SIDES * size) * sizeof *u); /* in place */
    check_ok(context, bw_incremental_system_solve(context, incremental, NULL, SIDES, u, u, NULL));
    check_near(difference(u, v, size), 0, 1e-8);
    bw_release(fresh);
    bw_release(model);
    bw_release(incremental);
    free(force);
    free(u);
    free(v);
    bar_clear(&b);
  }
}

/* The tolerance on the error in energy: met by |error|_K, computed from the exact solution, in both
 * precisions, for loads spread and at a point. */
static void energy_alone(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 3 };
  for (int run = 0; run < 4; run++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, 0);
    bw_incremental_system *incremental = incremental_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
    double *product = numbers(size);
    memset(force, 0, (size_t)(SIDES * size) * sizeof *force);
    for (int64_t i = 0; i < b.mesh->node_count; i++)
      force[3 * i + 2] = 1;
    force[size + size - 2] = force[2 * size + size / 2] = 1;
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.precision = run % 2 ? 32 : 64;
    check_ok(context,
             bw_incremental_system_solve(context, incremental, &options, SIDES, force, u, NULL));
    b.now.scale[2][2] = run < 2 ? 1.03 : 1.4;
    bw_model *model = posed(context, &b);
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
    options.solver = solver_by(WAY_ITERATE);
    options.tolerance = 1e-5;
    options.energy = true;
    check_ok(context,
             bw_incremental_system_solve(context, incremental, &options, SIDES, force, u, NULL));
    options = (bw_incremental_options){.solver = solver_by(WAY_ITERATE), .tolerance = 1e-12};
    options.precision = run % 2 ? 32 : 64;
    check_ok(context,
             bw_incremental_system_solve(context, incremental, &options, SIDES, force, v, NULL));
    for (int k = 0; k < SIDES; k++) {
      double error = 0, energy = 0;
      for (int64_t i = 0; i < size; i++)
        u[k * size + i] -= v[k * size + i];
      check_ok(context,
               bw_block_multiply(context, incremental->system->pattern,
                                 incremental->system->stiffness, 9, 3, 1, u + k * size, product));
      for (int64_t i = 0; i < size; i++) {
        error += u[k * size + i] * product[i];
        energy += v[k * size + i] * force[k * size + i];
      }
      if (!(error <= 1e-10 * energy))
        fail_msg("run %d, side %d: %g of the solution in energy", run, k, sqrt(error / energy));
    }
    bw_release(model);
    bw_release(incremental);
    free(force);
    free(u);
    free(v);
    free(product);
    bar_clear(&b);
  }
}

/* Fields to begin with: the same solution whatever they are; fewer iterations where they are near,
 * hardly any where the solutions are combinations of them. */
static void guesses(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 3, FIELDS = 7 };
  for (int scene = 0; scene < 4; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
    double *field = numbers(FIELDS * size);
    const double *guess[FIELDS];
    random_field(5, SIDES * size, force);
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.solver = solver_by(WAY_ITERATE);
    options.check = true;
    for (int step = 0; step < 2; step++) { /* two shapes; the solutions of the first are fields */
      bw_reuse reuse = {0};
      b.now.scale[2][2] = 1.06 + 0.004 * step;
      bw_model *model = posed(context, &b);
      check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
      options.guess_count = 0;
      check_ok(context, bw_incremental_system_solve(context, incremental, &options, SIDES, force, v,
                                                    &reuse));
      int without = reuse.iterations;
      if (step == 1) {
        for (int k = 0; k < FIELDS; k++)
          guess[k] = field + k * size; /* the fourth is zero */
        memcpy(field + 4 * size, field, (size_t)size * sizeof *field);
        random_field(9, size, field + 5 * size);
        field[6 * size] = NAN;
        options.guess = guess;
        options.guess_count = FIELDS;
        reuse = (bw_reuse){0};
        check_ok(context, bw_incremental_system_solve(context, incremental, &options, SIDES, force,
                                                      u, &reuse));
        assert_true(reuse.iterations < without);
        for (int k = 0; k < SIDES; k++)
          check_near(difference(u + k * size, v + k * size, size), 0, 1e-8);
        for (int64_t i = 0; i < size; i++)
          field[i] = v[i] + 2 * v[size + i];
        memcpy(field + size, v + size, (size_t)(2 * size) * sizeof *field);
        reuse = (bw_reuse){0};
        options.tolerance = 1e-8;
        check_ok(context, bw_incremental_system_solve(context, incremental, &options, SIDES, force,
                                                      u, &reuse));
        assert_true(reuse.iterations <= 1);
        options.solver = solver_by(WAY_REFACTOR); /* ignores them */
        options.guess_count = FIELDS;
        check_ok(context, bw_incremental_system_solve(context, incremental, &options, SIDES, force,
                                                      u, NULL));
      }
      memcpy(field, v, (size_t)(SIDES * size) * sizeof *field);
      bw_release(model);
    }
    bw_release(incremental);
    free(force);
    free(u);
    free(v);
    free(field);
    bar_clear(&b);
  }
}

/* The view of a current system is one: modes of the edited shape from it. Before that, it says
 * that it is not. */
static void view_serves_modes(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  b.now.scale[1][1] = 1.2;
  turn_subdomain(&b, 2, 0.3);
  bw_model *model = posed(context, &b);
  bw_modes *mine = NULL, *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 4;
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
  check_fails(context, BW_INVALID, "its factor is lagged",
              bw_modes_elastic(context, incremental->system, &options, &mine));
  check_fails(context, BW_INVALID, "its factor is lagged",
              bw_system_solve(context, incremental->system, 1, b.node, b.node));
  bw_incremental_options single;
  bw_incremental_options_default(&single);
  single.precision = 32;
  check_ok(context,
           bw_incremental_system_solve(context, incremental, &single, 1, b.node, b.node, NULL));
  check_ok(context, bw_incremental_system_refactor(context, incremental, NULL));
  assert_int_equal(incremental->inner->factor->kernels->bits, 32);
  assert_int_equal(incremental->system->factor->kernels->bits, 64);
  check_ok(context, bw_modes_elastic(context, incremental->system, &options, &mine));
  bw_static *fresh = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &fresh));
  check_ok(context, bw_modes_elastic(context, fresh->system, &options, &modes));
  for (int k = 0; k < 4; k++)
    check_near(mine->frequency[k] / modes->frequency[k], 1, 1e-8);
  bw_release(fresh);
  bw_release(modes);
  bw_release(mine);
  bw_release(model);
  bw_release(incremental);
  bar_clear(&b);
}

check_main(check_test(many_sides), check_test(energy_alone), check_test(guesses),
           check_test(view_serves_modes))
