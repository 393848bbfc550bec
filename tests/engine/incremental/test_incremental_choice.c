/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refactoring or iterating: which one a system that follows edits chooses, and when it gives up. */
#include "incremental_bar.h"

/* The choice: a change near rounding is iterated away, a large one factored; and what was chosen is
 * what was predicted to cost less. */
static void choice_by_cost(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 1, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  const double stretch[4] = {1 + 1e-10, 1.2, 1.001, 1 + 1e-6};
  for (int i = 0; i < 4; i++) {
    b.now.scale[1][0] *= stretch[i];
    bw_reuse r = edit_and_compare(context, &b, incremental, WAY_AUTO);
    bool cheaper = r.predicted_iterate <= r.predicted_refactor;
    if (r.iterations == 0 || way_of(&r) == WAY_ITERATE)
      assert_int_equal(way_of(&r) == WAY_ITERATE, cheaper);
    if (i == 0)
      assert_int_equal(way_of(&r), WAY_ITERATE);
    if (i == 1)
      assert_int_equal(way_of(&r), WAY_REFACTOR);
  }
  bw_release(incremental);
  bar_clear(&b);
}

/* The work that the order of elimination was chosen by is the work that a session then does, and no
 * subdomain is touched but those whose bones moved: here the one reshaped and those
 * blended beside it. */
static void work_is_predicted(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bw_random random;
  bw_random_seed(&random, 5);
  bar_make(context, 2, 1, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  const bwi_elimination_reach *reach = incremental->inner->reach;
  int32_t subdomains = incremental->inner->subdomain_count;
  uint8_t *predicted = calloc((size_t)subdomains, 1);
  for (int edit = 0; edit < 20; edit++) {
    int k = (int)(bw_random_uniform(&random) * RIGID);
    for (int c = 0; c < 3; c++)
      b.now.scale[k][c] = 0.9 + 0.2 * bw_random_uniform(&random);
    for (int32_t d = 0; d < subdomains; d++)
      predicted[d] = abs(d - 2 * k) <= 1;
    bw_model *model = posed(context, &b);
    assert_non_null(model);
    bw_reuse r = {0};
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &r));
    assert_memory_equal(incremental->inner->touched, predicted, (size_t)subdomains);
    check_ok(context, bw_incremental_system_refactor(context, incremental, &r));
    check_near(r.factor_reused,
               1 - bwi_elimination_reach_flops(reach, predicted) / reach->symbolic->flops, 1e-12);
    bw_release(model);
  }
  free(predicted);
  bw_release(incremental);
  bar_clear(&b);
}

/* Iterating is given up when too many iterations are predicted: early, and not where it would soon
 * be done. */
static void given_up_early(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  b.now.scale[1][1] *= 1.3;
  turn_subdomain(&b, 2, 0.2);
  bw_model *model = posed(context, &b);
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  double *f = numbers(3 * size), *u = numbers(3 * size);
  random_field(1, 3 * size, f);
  const bw_system *system = incremental->system;
  bwi_factor_preconditioner factor = {incremental->inner->factor, system->dof_map};
  bwi_pcg problem = {.pattern = system->pattern,
                     .stiffness = system->stiffness,
                     .dof_map = system->dof_map,
                     .precondition = bwi_factor_precondition,
                     .data = &factor,
                     .tolerance = 1e-10,
                     .limit = 2000};
  check_ok(context, bwi_pcg_solve(context, &problem, 3, f, u));
  assert_true(problem.converged);
  int needed = problem.iterations;
  assert_true(needed > 20);
  problem.max_remaining = 5;
  check_ok(context, bwi_pcg_solve(context, &problem, 3, f, u));
  assert_false(problem.converged);
  assert_true(problem.iterations <= needed / 3);
  assert_true(problem.predicted_iterations > 0.5 * needed &&
              problem.predicted_iterations < 2 * needed);
  problem.max_remaining = 10.0 * needed;
  check_ok(context, bwi_pcg_solve(context, &problem, 3, f, u));
  assert_true(problem.converged);
  assert_int_equal(problem.iterations, needed);
  free(f);
  free(u);
  bw_release(model);
  bw_release(incremental);
  bar_clear(&b);
}

/* A prediction that errs: iterating stops when it has cost what the other way would have, and that
 * is then gone. */
static void iteration_ratio_too_small(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  /* of these subdomains all good is believed, and of no others */
  b.now.scale[1][0] *= 1 + 1e-9;
  turn_subdomain(&b, 2, 1e-9);
  edit_and_compare(context, &b, incremental, WAY_ITERATE);
  b.now.scale[1][0] *= 1.3;
  turn_subdomain(&b, 2, 0.2);
  incremental->inner->iteration_ratio = 1e-3;
  bw_reuse r = edit_and_compare(context, &b, incremental, WAY_AUTO);
  assert_int_equal(way_of(&r), WAY_REFACTOR);
  assert_true(r.predicted_iterate < r.predicted_refactor);
  assert_true(r.iterations > 0 && r.iterations < 20);
  assert_true(bwi_incremental_current(incremental));
  /* small steps, iterated, until their sum has cost as much */
  bw_incremental_options options;
  bw_incremental_options_default(&options);
  b.now.scale[2][1] *= 1 + 1e-10;
  bw_model *model = posed(context, &b);
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &r));
  double *u = numbers(3 * (int64_t)b.mesh->node_count);
  int solves = 0;
  for (; solves < 100 && !bwi_incremental_current(incremental); solves++) {
    random_field((uint64_t)solves + 1, 3 * (int64_t)b.mesh->node_count, u);
    check_ok(context, bw_incremental_system_solve(context, incremental, &options, 1, u, u, &r));
  }
  assert_true(solves > 1 && solves < 100);
  free(u);
  bw_release(model);
  bw_release(incremental);
  bar_clear(&b);
}

/* A factor of a quite other shape is no help: that is reported, and the other way still works. */
static void no_convergence(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  b.now.scale[1][1] = b.now.scale[1][2] = 5e-3;
  follow(&b);
  bw_mesh *mesh = NULL;
  bw_model *model = NULL;
  bw_static *result = NULL;
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &mesh));
  check_ok(context, bw_model_moved(context, b.model, mesh, &model));
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
  bw_incremental_options options;
  bw_incremental_options_default(&options);
  options.solver = solver_by(WAY_ITERATE);
  check_fails(context, BW_CONVERGENCE, "changed too much",
              bw_incremental_statics(context, incremental, model, NULL, &options, &result, NULL));
  bw_reuse reuse = {0};
  check_ok(context,
           bw_incremental_statics(context, incremental, model, NULL, NULL, &result, &reuse));
  assert_int_equal(way_of(&reuse), WAY_REFACTOR);
  bw_release(result);
  bw_release(model);
  bw_release(mesh);
  bw_release(incremental);
  bar_clear(&b);
}

check_main(check_test(choice_by_cost), check_test(work_is_predicted), check_test(given_up_early),
           check_test(iteration_ratio_too_small), check_test(no_convergence))
