/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* After every edit the system that followed it has the stiffness and the solution of one rebuilt,
 * and says what it reused; what fails leaves it as it was. */
#include "incremental_bar.h"

static void edit_sequences(bw_context *context, int scene, int order, edit_way method,
                           int precision, int sequences, uint64_t seed) {
  bar b;
  bw_random random;
  bw_random_seed(&random, seed);
  bar_make(context, 1, order, &b);
  load_bar(context, &b, scene);
  for (int s = 0; s < sequences; s++) {
    bw_incremental_system *incremental = NULL;
    rest_pose(&b.now);
    follow(&b);
    check_ok(context,
             bw_incremental_system_create(context, b.model, false, SUBDOMAINS, b.element_subdomain,
                                          b.node_subdomain, NULL, &incremental));
    for (int edit = 0; edit < 4; edit++) {
      pose before = b.now;
      random_edit(&random, &b.now);
      bw_model *model = posed(context, &b);
      if (!model) {
        b.now = before;
        follow(&b);
        continue;
      }
      bw_reuse reuse = {0};
      check_ok(context,
               bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
      if (edit % 2 || bw_random_uniform(&random) < 0.5) /* or several edits before a solve */
        compare_in(context, incremental, model, method, precision, &reuse);
      bw_release(model);
    }
    bw_release(incremental);
  }
  bar_clear(&b);
}

static void random_sequences(void **state) {
  bw_context *context = check_context(state);
  int many = getenv("BARWRIGHT_FULL") ? 400 : 40; /* 520 in all */
  for (int scene = 0; scene < SCENES; scene++)
    for (int method = WAY_AUTO; method <= WAY_ITERATE; method++)
      for (int precision = 64; precision >= 32; precision -= 32)
        edit_sequences(context, scene, scene == 1 ? 2 : 1, (edit_way)method, precision,
                       (scene == 1 ? many / 2 : many) / 2, (uint64_t)(10 * scene + method + 1));
}

static void reuse_is_said(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 1, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    turn_subdomain(&b, 0, 0.4); /* everything as one */
    bw_reuse r = edit_and_compare(context, &b, incremental, WAY_REFACTOR);
    assert_true(r.pattern && r.ordering);
    assert_int_equal(r.subdomains, SUBDOMAINS);
    assert_int_equal(way_of(&r), WAY_REFACTOR);
    assert_int_equal(r.iterations, 0);
    if (scene != 1) { /* there, a support that keeps its direction */
      assert_int_equal(r.subdomains_rotated, SUBDOMAINS);
      assert_int_equal(r.subdomains_changed, 0);
      check_near(r.factor_reused, 1, 0);
    } else {
      assert_true(r.subdomains_changed > 0 && r.subdomains_changed < SUBDOMAINS);
      assert_true(r.factor_reused < 1 && r.factor_reused > 0.1);
    }
    turn_subdomain(&b, 2, 0.2); /* the tip: its joint is blended */
    r = edit_and_compare(context, &b, incremental, WAY_REFACTOR);
    if (scene == 0 || scene == 2 || scene == 3) { /* slides at the joint turn too */
      assert_int_equal(r.subdomains_reused, 3);
      assert_int_equal(r.subdomains_rotated, 1);
      assert_int_equal(r.subdomains_changed, 1);
    }
    assert_true(r.factor_reused > 0 && r.factor_reused < 1);
    b.now.shift[0][0] += 0.3; /* a translation touches nothing */
    r = edit_and_compare(context, &b, incremental, WAY_AUTO);
    assert_int_equal(r.subdomains_reused, SUBDOMAINS);
    check_near(r.factor_reused, 1, 0);
    assert_int_equal(way_of(&r), WAY_REFACTOR);
    r = edit_and_compare(context, &b, incremental, WAY_FULL);
    assert_int_equal(way_of(&r), WAY_FULL);
    check_near(r.factor_reused, 0, 0);
    pose before = b.now;
    b.now.scale[2][1] *= 1.05;
    r = edit_and_compare(context, &b, incremental, WAY_ITERATE);
    assert_int_equal(way_of(&r), WAY_ITERATE);
    assert_true(r.iterations > 1 && r.iterations < 60);
    check_near(r.factor_reused, 1, 0);
    b.now = before; /* taken back: the factor is that of the shape again */
    r = edit_and_compare(context, &b, incremental, WAY_AUTO);
    assert_int_equal(way_of(&r), WAY_REFACTOR);
    assert_int_equal(r.iterations, 0);
    check_near(r.factor_reused, 1, 0);
    size_t factor = 0, updates = 0;
    bw_incremental_system_memory(incremental, &factor, &updates);
    assert_true(factor > 0 && updates > 0);
    bw_release(incremental);
    bar_clear(&b);
  }
}

/* ---- failures ------------------------------------------------------------------------------ */

static void failures_and_recovery(void **state) {
  bw_context *context = check_context(state);
  bar b, other;
  bar_make(context, 1, 1, &b);
  bar_make(context, 2, 1, &other);
  load_bar(context, &b, 0);
  load_bar(context, &other, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  turn_subdomain(&b, 1, 0.1);
  edit_and_compare(context, &b, incremental, WAY_AUTO);
  uint64_t revision = incremental->object.revision;
  bw_model *good = posed(context, &b), *model = NULL;

  /* what is refused leaves the system as it was */
  check_fails(context, BW_INVALID, "elements must be the same",
              bw_incremental_system_update(context, incremental, other.model, b.motion, NULL));
  bw_subdomain_motion wrong[SUBDOMAINS];
  memcpy(wrong, b.motion, sizeof wrong);
  wrong[2].linear[0] = NAN;
  assert_int_equal(bw_incremental_system_update(context, incremental, good, wrong, NULL),
                   BW_INVALID);
  memcpy(wrong, b.motion, sizeof wrong);
  wrong[4].linear[4] *= -1;
  assert_int_equal(bw_incremental_system_update(context, incremental, good, wrong, NULL),
                   BW_INVALID);
  bw_static *result = NULL;
  check_fails(context, BW_INVALID, "last followed",
              bw_incremental_statics(context, incremental, good, NULL, NULL, &result, NULL));
  assert_true(incremental->object.revision == revision);
  bw_incremental_options options = {.solver = solver_by(WAY_REFACTOR), .tolerance = 2};
  double *u = numbers(3 * (int64_t)b.mesh->node_count);
  check_fails(context, BW_INVALID, "between 0 and 1",
              bw_incremental_system_solve(context, incremental, &options, 1, u, u, NULL));
  options.tolerance = 1e-10;
  options.further = -1;
  check_fails(context, BW_INVALID, "-1 further right-hand sides",
              bw_incremental_system_solve(context, incremental, &options, 1, u, u, NULL));
  options.further = 0;

  /* a waist so thin that the stiffness is singular: said when it is factored, and repaired after */
  pose before = b.now;
  b.now.scale[1][1] = b.now.scale[1][2] = 3e-6;
  follow(&b);
  bw_mesh *flat = NULL;
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &flat));
  check_ok(context, bw_model_moved(context, b.model, flat, &model));
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
  assert_int_equal(
      bw_incremental_statics(context, incremental, model, NULL, &options, &result, NULL),
      BW_SINGULAR);
  assert_int_equal(
      bw_incremental_statics(context, incremental, model, NULL, &options, &result, NULL),
      BW_SINGULAR);
  options.solver = solver_by(WAY_ITERATE); /* there is no factor to iterate with */
  assert_int_equal(
      bw_incremental_statics(context, incremental, model, NULL, &options, &result, NULL),
      BW_SINGULAR);
  bw_release(model);
  bw_release(flat);
  b.now = before;
  bw_reuse r = edit_and_compare(context, &b, incremental, WAY_AUTO);
  assert_int_equal(way_of(&r), WAY_FULL);

  /* stopped by the user in the middle */
  turn_subdomain(&b, 2, 0.1);
  model = posed(context, &b);
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
  bw_cancel(context);
  assert_int_equal(bw_incremental_statics(context, incremental, model, NULL, NULL, &result, NULL),
                   BW_CANCELLED);
  bw_clear_cancel(context);
  r = (bw_reuse){0};
  compare(context, incremental, model, WAY_AUTO, &r);
  bw_release(model);

  /* a load that is not balanced, and a check that finds what is wrong */
  options = (bw_incremental_options){
      .solver = solver_by(WAY_REFACTOR), .tolerance = 1e-10, .check = true};
  incremental->stiffness->values[0] *= 1.001;
  random_field(3, 3 * (int64_t)b.mesh->node_count, u);
  check_fails(context, BW_INTERNAL, "stiffness differs from the reassembled one",
              bw_incremental_system_solve(context, incremental, &options, 1, u, u, NULL));
  free(u);
  bw_release(good);
  bw_release(incremental);
  bar_clear(&other);
  bar_clear(&b);
}

/* The same shape constrained otherwise: other unknowns, and a whole new factor. */
static void supports_become_others(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 1, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  turn_subdomain(&b, 2, 0.1);
  bw_model *model = posed(context, &b);
  bw_selection *tip = NULL;
  const double point[3] = {10, 0.5, 0.5};
  check_ok(context, bw_select_nearest(context, model->mesh, point, 3, &tip));
  check_ok(context, bw_model_fix(context, model, tip));
  bw_reuse reuse;
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
  compare(context, incremental, model, WAY_ITERATE, &reuse);
  assert_int_equal(way_of(&reuse), WAY_FULL);
  assert_true(reuse.pattern && !reuse.ordering); /* nodes left the order */
  bw_release(tip);
  bw_release(model);
  edit_and_compare(context, &b, incremental, WAY_AUTO); /* and back */
  bw_release(incremental);
  bar_clear(&b);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 1, &b);
  load_bar(context, &b, 1);
  bw_model *rest = bw_retain(b.model);
  b.now.scale[1][1] = 1.02;
  bw_model *model = posed(context, &b);
  bw_subdomain_motion motion[SUBDOMAINS];
  memcpy(motion, b.motion, sizeof motion);
  for (int64_t n = 1;; n += n < 200 ? 1 : 7) {
    bw_incremental_system *incremental = NULL;
    bw_fail_allocation(n, true);
    bw_status status =
        bw_incremental_system_create(context, rest, false, SUBDOMAINS, b.element_subdomain,
                                     b.node_subdomain, NULL, &incremental);
    bw_fail_allocation(0, false);
    bw_release(incremental);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
  }
  bw_incremental_system *incremental = incremental_of(context, &b);
  bw_incremental_options options;
  bw_incremental_options_default(&options);
  double *field = numbers(3 * (int64_t)b.mesh->node_count);
  const double *guess[1] = {field};
  random_field(3, 3 * (int64_t)b.mesh->node_count, field);
  options.guess = guess;
  options.guess_count = 1;
  for (int run = 0; run < 3; run++) {
    options.solver = solver_by(run == 0 ? WAY_ITERATE : WAY_REFACTOR);
    options.precision = run < 2 ? 0 : 32;
    bool updated = false;
    check_each_allocation(context, status, 1) {
      bw_static *result = NULL;
      status = BW_OK;
      if (!updated)
        status = bw_incremental_system_update(context, incremental, model, motion, NULL);
      updated = updated || status == BW_OK;
      if (status == BW_OK)
        status = bw_incremental_statics(context, incremental, model, NULL, &options, &result, NULL);
      bw_release(result);
    }
    bw_reuse reuse = {0};
    compare(context, incremental, model, WAY_AUTO, &reuse);
  }
  free(field);
  bw_release(incremental);
  bw_release(model);
  bw_release(rest);
  bar_clear(&b);
}

/* The same bits for one thread and for two. */
static void threads_agree(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 1, &b);
  load_bar(context, &b, 1);
  b.now.scale[1][1] = 1.02;
  turn_subdomain(&b, 2, 0.1);
  bw_model *model = posed(context, &b);
  enum { RUNS = 8 };
  bw_static *result[RUNS] = {NULL};
  for (int k = 0; k < RUNS; k++) {
    check_ok(context, bw_set_threads(context, 1 + k % 2));
    bw_incremental_system *incremental = incremental_of(context, &b);
    bw_incremental_options options;
    bw_incremental_options_default(&options);
    options.solver = solver_by(k % 4 < 2 ? WAY_REFACTOR : WAY_ITERATE);
    options.precision = k < 4 ? 64 : 32;
    check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
    check_ok(context,
             bw_incremental_statics(context, incremental, model, NULL, &options, &result[k], NULL));
    bw_release(incremental);
  }
  size_t bytes = 3 * (size_t)b.mesh->node_count * sizeof(double);
  for (int k = 0; k < RUNS; k += 2)
    assert_memory_equal(result[k]->displacement, result[k + 1]->displacement, bytes);
  for (int k = 0; k < RUNS; k++)
    bw_release(result[k]);
  bw_release(model);
  bar_clear(&b);
}

/* A factor by CHOLMOD: computed again as a whole, used to iterate with, replaced by the engine's
 * and back, by one in single precision and by one in another order, which the next keeps. */
static void other_factors(void **state) {
  bw_context *context = check_context(state);
  bw_solver *factor = body_solver(context, (bw_solver_options){.backend = BW_BACKEND_CHOLMOD});
  bw_solver *iterate =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = factor});
  bw_solver *own = body_solver(context, (bw_solver_options){.backend = BW_BACKEND_MULTIFRONTAL});
  bw_solver *single = body_solver(context, (bw_solver_options){.precision = 32});
  bw_solver *amd = body_solver(context, (bw_solver_options){.ordering = BW_ORDERING_AMD});
  const struct {
    const bw_solver *solver;
    const char *backend;
    double reused; /* -1: a part, -2: any */
    int bits;      /* 0: any */
    bool amd;      /* the order */
  } step[] = {{factor, "cholmod", 0, 64, false},   {iterate, "cholmod", 1, 64, false},
              {factor, "cholmod", 0, 64, false},   {own, "multifrontal", 0, 0, false},
              {own, "multifrontal", -1, 0, false}, {factor, "cholmod", 0, 64, false},
              {NULL, "cholmod", -2, 64, false},    {single, "multifrontal", 0, 32, false},
              {amd, "multifrontal", 0, 0, true},   {amd, "multifrontal", -1, 0, true},
              {own, "multifrontal", -1, 0, true}};
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 1, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
      bw_static *fresh = NULL, *mine = NULL;
      bw_reuse reuse = {0};
      turn_subdomain(&b, 2, 0.02);
      b.now.scale[2][1] *= 1.01;
      bw_model *model = posed(context, &b);
      assert_non_null(model);
      check_ok(context,
               bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
      const bw_incremental_options options = {.solver = step[k].solver, .tolerance = 1e-10};
      check_ok(context, bw_incremental_statics(context, incremental, model, &relief, &options,
                                               &mine, &reuse));
      check_ok(context, bw_statics(context, model, NULL, &relief, &fresh));
      check_near(difference(mine->displacement, fresh->displacement, size), 0, 1e-8);
      check_near(mine->energy / fresh->energy, 1, 1e-8);
      assert_string_equal(mine->report.backend, step[k].backend);
      if (step[k].reused >= 0)
        check_near(mine->report.reused, step[k].reused, 0);
      else if (step[k].reused == -1)
        assert_true(mine->report.reused > 0 && mine->report.reused < 1);
      const bwi_factor *made = incremental->inner->factor;
      assert_true(step[k].bits == 0 || made->kernels->bits == step[k].bits);
      assert_true((made->symbolic->order->ordering == BW_ORDERING_AMD) == step[k].amd);
      bw_release(mine);
      bw_release(fresh);
      bw_release(model);
    }
    bw_release(incremental);
    bar_clear(&b);
  }
  bw_release(amd);
  bw_release(single);
  bw_release(own);
  bw_release(iterate);
  bw_release(factor);
}

/* Each static solution reports its own work, where several complete one bw_reuse. */
static void reports_of_several(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  turn_subdomain(&b, 2, 0.02);
  bw_model *model = posed(context, &b);
  assert_non_null(model);
  bw_reuse reuse = {0};
  check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, &reuse));
  const int way[4] = {WAY_PCG, WAY_PCG, WAY_REFACTOR, WAY_AUTO};
  bw_static *result[4] = {NULL};
  for (int k = 0; k < 4; k++) {
    const bw_incremental_options options = {
        .solver = solver_by(way[k]), .tolerance = 1e-10, .precision = 64};
    check_ok(context, bw_incremental_statics(context, incremental, model, NULL, &options,
                                             &result[k], &reuse));
  }
  assert_true(result[0]->report.iterations > 0);
  assert_int_equal(result[1]->report.iterations, result[0]->report.iterations);
  assert_int_equal(result[2]->report.iterations, 0);
  assert_true(result[2]->report.reused < 1 && result[2]->report.flops > 0);
  assert_true(result[3]->report.reused == 1 && result[3]->report.flops == 0);
  assert_string_equal(result[3]->report.reason, "the equations have a factor already");
  for (int k = 0; k < 4; k++)
    bw_release(result[k]);
  bw_release(model);
  bw_release(incremental);
  bar_clear(&b);
}

check_main(check_test(other_factors), check_test(reports_of_several), check_test(random_sequences),
           check_test(reuse_is_said), check_test(failures_and_recovery),
           check_test(supports_become_others), check_test(no_memory), check_test(threads_agree))
