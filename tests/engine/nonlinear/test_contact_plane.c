/* Solids and planes: no penetration, no pull, and balance. */
#include "solid_box.h"
#include "solver_by.h"

static const int32_t cells[3] = {3, 3, 4};
static const double size[3] = {0.3, 0.3, 0.4};

static bw_solid_static *solve(bw_context *context, const box *b) {
  bw_solid_static *result = NULL;
  check_ok(context, bw_solid_statics(context, b->solid, b->load_case, NULL, NULL, &result));
  assert_true(result->complete);
  return result;
}

/* Signorini's conditions at all nodes that are free in all directions; returns those that touch. */
static int check_contact(const box *b, const bw_solid_static *result,
                         const bw_contact_plane *plane) {
  int touching = 0;
  for (int32_t n = 0; n < b->grid->node_count; n++) {
    double x[3];
    const double *u = result->displacement + 3 * (int64_t)n, *r = result->reaction + 3 * (int64_t)n;
    bw_grid_position(b->grid, n, x);
    for (int d = 0; d < 3; d++)
      x[d] += u[d] - plane->point[d] - plane->move[d];
    double gap = bw_dot(x, plane->normal), push = bw_dot(r, plane->normal);
    assert_true(gap > -1e-9 * 0.4);
    bool constrained = false;
    for (int d = 0; d < 3; d++)
      constrained = constrained || b->load_case->constrained[3 * (int64_t)n + d];
    if (constrained)
      continue;
    assert_true(push >= 0);
    if (push > 0) {
      assert_true(gap < 1e-9 * 0.4);
      touching++;
    }
    for (int d = 0; d < 3; d++) /* no friction */
      check_near(r[d], push * plane->normal[d], 1e-9 * fabs(push));
  }
  return touching;
}

/* A block on the ground carries its weight there. `height`: it starts so much above. */
static void test_weight(void **state) {
  bw_context *context = check_context(state);
  static const double height[2] = {0, 0.01};
  for (int k = 0; k < 2; k++) {
    box b;
    double point[3] = {0, 0, -height[k]}, normal[3] = {0, 0, 2}, gravity[3] = {0, 0, -10};
    box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
    box_hold(context, &b, 0, 0, true, false, false, 0);
    box_hold(context, &b, 1, 0, false, true, false, 0);
    check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
    check_ok(context,
             bw_load_case_contact_plane(context, b.load_case, point, normal, NULL, NULL, NULL));
    check_near(b.load_case->contact_plane[0].normal[2], 1, 1e-15);
    bw_solid_static *result = solve(context, &b);
    assert_true(check_contact(&b, result, &b.load_case->contact_plane[0]) > 0);
    check_near(box_sum(&b, result->reaction, 2, 0, 2), 36 * 10, 1e-3);
    assert_true(result->newton.contacts == 16);
    bw_release(result);
    box_free(&b);
  }
}

/* A plate comes down on a bar with free sides: the closed form of uniaxial compression (E = 1). */
static void press(bw_context *context, bool embedded) {
  box b;
  double point[3] = {0, 0, size[2]}, normal[3] = {0, 0, -1}, move[3] = {0, 0, -0.1 * size[2]};
  bw_embedding *embedding = NULL;
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1, 0.3, 0);
  box_symmetric(context, &b);
  if (embedded) {
    double at[10][10][3];
    for (int i = 0; i < 100; i++) {
      at[i / 10][i % 10][0] = size[0] * (i / 10 + 0.5) / 10;
      at[i / 10][i % 10][1] = size[1] * (i % 10 + 0.5) / 10;
      at[i / 10][i % 10][2] = size[2];
    }
    check_ok(context, bw_embedding_create(context, b.grid, 100, &at[0][0][0], 1, &embedding));
  }
  check_ok(context,
           bw_load_case_contact_plane(context, b.load_case, point, normal, move, embedding, NULL));
  bw_solid_static *result = solve(context, &b);
  double force =
      embedded ? box_sum(&b, result->reaction, 2, 1, 2) : -box_sum(&b, result->reaction, 2, 0, 2);
  check_near(force / (size[0] * size[1]), -0.10872218513629549, 1e-6);
  check_near(1 + box_mean(&b, result->displacement, 0, 1, 0) / size[0], 1.0317024344, 1e-6);
  if (!embedded)
    assert_int_equal(check_contact(&b, result, &b.load_case->contact_plane[0]), 9);
  bw_release(result);
  bw_release(embedding);
  box_free(&b);
}

static void test_press(void **state) {
  press(check_context(state), false);
  press(check_context(state), true);
}

/* A cantilever bent down onto the ground, and one that slides along a slope. */
static void test_cantilever(void **state) {
  bw_context *context = check_context(state);
  const int32_t long_cells[3] = {12, 2, 2};
  const double long_size[3] = {0.4, 0.05, 0.05};
  for (int k = 0; k < 2; k++) {
    box b;
    double point[3] = {0.4, 0, -0.02}, normal[3] = {k ? -0.3 : 0, 0, 1}, gravity[3] = {0, 0, -10},
           move[3] = {0, 0, k ? 0.05 : 0};
    box_make(context, &b, long_cells, long_size, BW_COROTATED, 1e6, 0.3, 1000);
    box_hold(context, &b, 0, 0, true, true, true, 0);
    check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
    check_ok(context,
             bw_load_case_contact_plane(context, b.load_case, point, normal, move, NULL, NULL));
    bw_solid_static *result = solve(context, &b);
    int touching = check_contact(&b, result, &b.load_case->contact_plane[0]);
    assert_in_range(touching, 1, 6);
    double sum = 0;
    for (int32_t n = 0; n < b.grid->node_count; n++)
      sum += result->reaction[3 * (int64_t)n + 2];
    check_near(sum, 10, 1e-4);
    bw_release(result);
    box_free(&b);
  }
}

/* Lifted off the floor that was all that constrained it: nothing stops it. */
static void test_lifted(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    box b;
    bw_solid_static *result = NULL;
    bw_newton_options options;
    double point[3] = {0, 0, 0}, normal[3] = {0, 0, 1};
    bw_newton_options_default(&options);
    options.solver = newton_by(k ? NEWTON_JACOBI : NEWTON_DIRECT);
    box_make(context, &b, cells, size, BW_COROTATED, 1e5, 0.3, 1000);
    box_hold(context, &b, 0, 0, true, false, false, 0);
    box_hold(context, &b, 1, 0, false, true, false, 0);
    box_force(context, &b, 2, 1, 0, 0, 100);
    check_ok(context,
             bw_load_case_contact_plane(context, b.load_case, point, normal, NULL, NULL, NULL));
    check_fails(context, BW_UNCONSTRAINED, "without any force",
                bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
    assert_false(result->complete);
    bw_release(result);
    box_free(&b);
  }
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  box b;
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0}, bad[3] = {0, NAN, 0};
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, 1e5, 0.3, 1000);
  check_fails(context, BW_INVALID, "length 0",
              bw_load_case_contact_plane(context, b.load_case, point, normal, NULL, NULL, NULL));
  check_fails(context, BW_INVALID, "finite",
              bw_load_case_contact_plane(context, b.load_case, bad, normal, NULL, NULL, NULL));
  box_free(&b);
}

check_main(check_test(test_weight), check_test(test_press), check_test(test_cantilever),
           check_test(test_lifted), check_test(test_misuse))
