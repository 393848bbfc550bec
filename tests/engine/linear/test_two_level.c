/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solving by two-level PCG: as exact as a factor under every kind of support, in a number of
 * iterations that sizes and edits do not change, in the same bits on any number of threads. */
#include "incremental_bar.h"

/* Under every kind of support, turned, bent and stretched, though the factor of the start stays as
 * it is. */
static void as_a_factor(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    bw_reuse r = edit_and_compare(context, &b, incremental, WAY_PCG);
    assert_int_equal(way_of(&r), WAY_PCG);
    turn_subdomain(&b, 0, 0.5);
    turn_subdomain(&b, 1, 0.3);
    b.now.scale[2][1] *= 1.3;
    r = edit_and_compare(context, &b, incremental, WAY_PCG);
    assert_in_range(r.iterations, 5, 120);
    assert_false(bwi_incremental_current(incremental));
    bw_release(incremental);
    bar_clear(&b);
  }
}

/* Linear elements have no coarser ones. */
static void linear_elements_are_refused(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bw_static *result = NULL;
  const bw_incremental_options options = {.solver = solver_by(WAY_PCG)};
  bar_make(context, 1, 1, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  check_fails(context, BW_INVALID, "these are linear",
              bw_incremental_statics(context, incremental, b.model, NULL, &options, &result, NULL));
  bw_release(incremental);
  bar_clear(&b);
}

/* A block of cubes, nx by n by n of them, in one subdomain, fixed at one end, under its weight. */
static bw_incremental_system *block_of(bw_context *context, int nx, int n, bar *b) {
  const double gravity[3] = {1, 2, -9.81};
  bw_incremental_system *incremental = NULL;
  memset(b, 0, sizeof *b);
  b->mesh = body_box(context, (double)nx / n, 1, 1, nx, n, n, 2);
  b->material = body_material(context);
  b->element_subdomain = calloc((size_t)b->mesh->element_count, sizeof(int32_t));
  b->node_subdomain = calloc((size_t)b->mesh->node_count, sizeof(int32_t));
  b->node = numbers(3 * (int64_t)b->mesh->node_count);
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
  bw_selection *root = body_face(context, b->mesh, 0, 0);
  check_ok(context, bw_model_fix(context, b->model, root));
  check_ok(context, bw_model_gravity(context, b->model, gravity));
  check_ok(context, bw_incremental_system_create(context, b->model, false, 1, b->element_subdomain,
                                                 b->node_subdomain, NULL, &incremental));
  bw_release(root);
  return incremental;
}

/* Iterations to 1e-10 for a bar of cubes of `cells` elements along an edge. */
static int iterations_of(bw_context *context, int cells) {
  bar b;
  bw_incremental_system *incremental = block_of(context, 2 * cells, cells, &b);
  bw_reuse reuse = {0};
  compare(context, incremental, b.model, WAY_PCG, &reuse);
  bw_release(incremental);
  bar_clear(&b);
  return reuse.iterations;
}

static void sizes_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  int coarse = iterations_of(context, 3), fine = iterations_of(context, 6);
  assert_in_range(coarse, 5, 60);
  assert_true(fine <= coarse + coarse / 4);
}

/* Loads spread, at a point, none, more than fit side by side; one by one and together; begun near
 * the solution; to an error in energy, measured by the exact solution. */
static void many_sides(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 11 };
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 1);
  bw_incremental_system *incremental = incremental_of(context, &b);
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
  double *near = numbers(size), *product = numbers(size);
  random_field(7, SIDES * size, force);
  memset(force + size, 0, 2 * (size_t)size * sizeof *force);
  force[size + size - 2] = 1e6;
  bw_incremental_options options = {.solver = solver_by(WAY_FULL)};
  check_ok(context,
           bw_incremental_system_solve(context, incremental, &options, SIDES, force, v, NULL));
  options = (bw_incremental_options){.solver = solver_by(WAY_PCG)};
  bw_reuse reuse = {0};
  check_ok(context,
           bw_incremental_system_solve(context, incremental, &options, SIDES, force, u, &reuse));
  for (int k = 0; k < SIDES; k++)
    check_near(difference(u + k * size, v + k * size, size), 0, 1e-8);
  for (int64_t i = 0; i < size; i++)
    check_near(u[2 * size + i], 0, 0);
  check_ok(context, bw_incremental_system_solve(context, incremental, &options, 1, force, u, NULL));
  check_near(difference(u, v, size), 0, 1e-8);
  /* begun at the solution but for very little of another */
  double part = 1e-9 / difference(v + size, v, size);
  for (int64_t i = 0; i < size; i++)
    near[i] = v[i] + part * v[size + i];
  const double *guesses[1] = {near};
  bw_reuse begun = {0};
  options.guess = guesses;
  options.guess_count = 1;
  check_ok(context,
           bw_incremental_system_solve(context, incremental, &options, 1, force, u, &begun));
  check_near(difference(u, v, size), 0, 1e-8);
  assert_true(begun.iterations < reuse.iterations - 3);
  options =
      (bw_incremental_options){.solver = solver_by(WAY_PCG), .tolerance = 1e-3, .energy = true};
  check_ok(context, bw_incremental_system_solve(context, incremental, &options, 2, force, u, NULL));
  for (int k = 0; k < 2; k++) {
    double error = 0, whole = 0;
    for (int64_t i = 0; i < size; i++)
      near[i] = u[k * size + i] - v[k * size + i];
    check_ok(context, bw_block_multiply(context, incremental->system->pattern,
                                        incremental->system->stiffness, 9, 3, 1, near, product));
    for (int64_t i = 0; i < size; i++) {
      error += near[i] * product[i];
      whole += force[k * size + i] * v[k * size + i];
    }
    check_near(sqrt(error / whole), 0, 3e-3);
    assert_true(sqrt(error / whole) > 1e-7); /* and no more was done */
  }
  bw_release(incremental);
  free(force);
  free(u);
  free(v);
  free(near);
  free(product);
  bar_clear(&b);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  double *force = numbers(2 * size), *u = numbers(2 * size), *v = numbers(2 * size);
  random_field(5, 2 * size, force);
  const bw_incremental_options options = {.solver = solver_by(WAY_PCG)};
  for (int threads = 1; threads <= 4; threads += 3) {
    check_ok(context, bw_set_threads(context, threads));
    bw_incremental_system *incremental = incremental_of(context, &b);
    for (int count = 1; count <= 2; count++) {
      check_ok(context,
               bw_incremental_system_solve(context, incremental, &options, count, force, u, NULL));
      if (threads == 1)
        memcpy(count == 1 ? v : v + size, u, (size_t)size * sizeof *u);
      else
        assert_memory_equal(count == 1 ? v : v + size, u, (size_t)size * sizeof *u);
    }
    bw_release(incremental);
  }
  free(force);
  free(u);
  free(v);
  bar_clear(&b);
}

/* Left to itself, a system takes the factor where it is at hand, and else what it says to be the
 * cheapest. Of a body as small as this one that is not PCG.
 */
static void chosen_by_cost(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 5, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  bw_reuse r = edit_and_compare(context, &b, incremental, WAY_AUTO);
  assert_int_equal(way_of(&r), WAY_REFACTOR);
  assert_true(r.predicted_pcg == 0);
  for (int k = 0; k < RIGID; k++)
    b.now.scale[k][1] *= 1.3;
  r = edit_and_compare(context, &b, incremental, WAY_AUTO);
  assert_true(r.predicted_pcg > 0 && r.predicted_refactor > 0);
  bool cheaper = r.predicted_pcg < fmin(r.predicted_refactor, r.predicted_iterate);
  assert_false(cheaper);
  assert_int_not_equal(way_of(&r), WAY_PCG);
  bw_release(incremental);
  bar_clear(&b);
}

/* Of a block all of whose factor an edit does again, PCG is chosen, and serves as well: a thick
 * body's factor is expensive for its size. What they hold is counted. */
static void chosen_for_a_thick_body(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bw_incremental_system *incremental = block_of(context, 10, 10, &b);
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  size_t before = bw_bytes(incremental), factor, updates;
  assert_true(bw_incremental_system_two_level_bytes(incremental) == 0);
  bw_mesh *moved = NULL;
  bw_model *model = NULL;
  bw_static *result = NULL;
  bw_subdomain_motion motion;
  bw_subdomain_motion_rest(&motion);
  motion.linear[4] = 1.25;
  for (int64_t i = 0; i < size; i++)
    b.node[i] = (i % 3 == 1 ? 1.25 : 1) * b.mesh->node[i];
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &moved));
  check_ok(context, bw_model_moved(context, b.model, moved, &model));
  bw_reuse r = {0};
  check_ok(context, bw_incremental_system_update(context, incremental, model, &motion, &r));
  check_ok(context, bw_incremental_statics(context, incremental, model, NULL, NULL, &result, &r));
  assert_int_equal(way_of(&r), WAY_PCG);
  assert_true(r.predicted_pcg < r.predicted_refactor && r.predicted_pcg < r.predicted_iterate);
  assert_in_range(r.iterations, 5, 60);
  assert_true(result->residual < 1e-10);
  assert_false(bwi_incremental_current(incremental));
  bw_incremental_system_memory(incremental, &factor, &updates);
  size_t two_level = bw_incremental_system_two_level_bytes(incremental);
  assert_in_range(two_level, factor / 10, factor); /* a third: the body is small */
  assert_true(bw_bytes(incremental) >= before + two_level);
  bw_release(result);
  bw_release(model);
  bw_release(moved);
  bw_release(incremental);
  bar_clear(&b);
}

/* Levels follow a shape once: not again for the same shape, always for another, be it only turned.
 */
static void followed_once(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    const bwi_incremental *inner = incremental->inner;
    for (int edit = 0; edit < 4; edit++) {
      if (edit == 1)
        b.now.scale[1][1] *= 1.1;
      if (edit == 3)
        turn_subdomain(&b, 0, 0.3);
      bw_model *model = posed(context, &b);
      assert_non_null(model);
      check_ok(context, bw_incremental_system_update(context, incremental, model, b.motion, NULL));
      assert_true(inner->two_level_known == (edit == 2));
      bw_reuse reuse = {0};
      compare(context, incremental, model, WAY_PCG, &reuse);
      assert_true(inner->two_level_known);
      bw_release(model);
    }
    bw_release(incremental);
    bar_clear(&b);
  }
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 2, &b);
  load_bar(context, &b, 0);
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  double *force = numbers(2 * size), *u = numbers(2 * size);
  random_field(5, 2 * size, force);
  const bw_incremental_options options = {.solver = solver_by(WAY_PCG), .tolerance = 1e-3};
  for (int64_t n = 1;; n++) {
    bw_incremental_system *incremental = incremental_of(context, &b);
    bw_fail_allocation(n, true);
    bw_status status =
        bw_incremental_system_solve(context, incremental, &options, 2, force, u, NULL);
    bw_fail_allocation(0, false);
    bw_release(incremental);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    bw_clear_failure(context);
  }
  free(force);
  free(u);
  bar_clear(&b);
}

check_main(check_test(as_a_factor), check_test(linear_elements_are_refused),
           check_test(sizes_do_not_matter), check_test(many_sides), check_test(same_bits),
           check_test(chosen_by_cost), check_test(chosen_for_a_thick_body),
           check_test(followed_once), check_test(no_memory))
