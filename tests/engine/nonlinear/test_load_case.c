/* What acts on a solid: totals, contradictions, what is not constrained, pressures that follow. */
#include "solid_box.h"

#include "nonlinear/load_case.h"

static const int32_t cells[3] = {2, 2, 2};
static const double size[3] = {0.3, 0.2, 0.2};

/* Points of a face of the box, n x n, and triangles between them seen from outside. */
static bw_embedding *face(bw_context *context, const box *b, int axis, int high, int n,
                          int32_t *triangle) {
  double *at = malloc(sizeof *at * 3 * (size_t)(n * n));
  bw_embedding *embedding;
  int p = (axis + 1) % 3, q = (axis + 2) % 3;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double *x = at + 3 * (i * n + j);
      x[axis] = high ? b->size[axis] : 0;
      x[p] = b->size[p] * i / (n - 1);
      x[q] = b->size[q] * j / (n - 1);
    }
  for (int i = 0; i < n - 1; i++)
    for (int j = 0; j < n - 1; j++) {
      int32_t corner[4] = {i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1};
      int32_t *t = triangle + 6 * (i * (n - 1) + j);
      for (int k = 0; k < 6; k++) {
        static const int order[6] = {0, 1, 2, 0, 2, 3};
        /* diagonals alternate, so that sums over cells are exact for bilinear functions */
        t[k] = corner[((high ? order[k] : order[5 - k]) + i + j) % 4];
      }
    }
  check_ok(context, bw_embedding_create(context, b->grid, n * n, at, 1, &embedding));
  free(at);
  return embedding;
}

enum { N = 5, TRIANGLES = 2 * (N - 1) * (N - 1) };

static void press_face(bw_context *context, box *b, int axis, int high, double pressure,
                       bool follower) {
  int32_t triangle[3 * TRIANGLES];
  double pressures[TRIANGLES];
  bw_embedding *embedding = face(context, b, axis, high, N, triangle);
  for (int t = 0; t < TRIANGLES; t++)
    pressures[t] = pressure;
  check_ok(context, bw_load_case_pressure(context, b->load_case, embedding, TRIANGLES, triangle,
                                          pressures, follower));
  bw_release(embedding);
}

static void test_totals(void **state) {
  bw_context *context = check_context(state);
  box b;
  double gravity[3] = {1, 2, -9}, total[3] = {0}, moment = 0;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  box_force(context, &b, 0, 1, 5, 6, 7);
  check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
  press_face(context, &b, 0, 1, 1000, false);
  press_face(context, &b, 2, 0, 500, false);
  double *force = malloc(24 * (size_t)b.grid->node_count);
  check_ok(context, bwi_load_case_dead(context, b.solid, b.load_case, force));
  for (int32_t n = 0; n < b.grid->node_count; n++) {
    double x[3];
    bw_grid_position(b.grid, n, x);
    for (int d = 0; d < 3; d++)
      total[d] += force[3 * n + d];
    moment += (x[1] - 0.1) * force[3 * n] - (x[0] - 0.15) * force[3 * n + 1];
  }
  check_near(total[0], 5 + 12 * 1 - 1000 * 0.04, 1e-9);
  check_near(total[1], 6 + 12 * 2, 1e-9);
  check_near(total[2], 7 - 12 * 9 + 500 * 0.06, 1e-9);
  check_near(moment, -0.15 * 6, 1e-9);
  free(force);
  box_free(&b);
}

/* A cube pressed from all sides (an eighth of it, by symmetry) shrinks to the stretch l with mu (l
 * - 1/l) + 3 lambda ln(l) / l = -p l^2: pressure on what the faces have become. */
static void test_followers(void **state) {
  bw_context *context = check_context(state);
  const double young = 1, poisson = 0.3, pressure = 0.8;
  double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * 0.4);
  double low = 0.3, high = 1;
  for (int k = 0; k < 100; k++) {
    double l = 0.5 * (low + high);
    *(mu * (l - 1 / l) + 3 * lambda * log(l) / l + pressure * l * l > 0 ? &high : &low) = l;
  }
  box b;
  bw_newton_options options;
  bw_newton_options_default(&options);
  options.tolerance = 1e-10;
  box_make(context, &b, cells, size, BW_NEO_HOOKEAN, young, poisson, 0);
  box_symmetric(context, &b);
  for (int axis = 0; axis < 3; axis++)
    press_face(context, &b, axis, 1, pressure, true);
  bw_solid_static *result;
  check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  for (int axis = 0; axis < 3; axis++)
    check_near(1 + box_mean(&b, result->displacement, axis, 1, axis) / size[axis], low, 1e-9);
  assert_in_range(result->newton.iterations, 3, 12);
  bw_release(result);
  box_free(&b);
}

/* Nodes of a side, all of whose faces are pressed. */
static void press_side(bw_context *context, box *b, int axis, int high, double pressure,
                       bool follower) {
  int32_t *node = malloc(sizeof *node * (size_t)b->grid->node_count);
  int64_t count = box_end(b, axis, high, node);
  check_ok(context, bw_load_case_surface_pressure(context, b->load_case, count, node, NULL, NULL,
                                                  pressure, follower));
  free(node);
}

static double linear_in_x(void *data, const double at[3]) {
  return *(const double *)data * at[0];
}

/* Even on every face: a node has a quarter of p A for each of its faces, on all six sides. */
static void test_even(void **state) {
  bw_context *context = check_context(state);
  for (int side = 0; side < 6; side++) {
    box b;
    int axis = side / 2, high = side % 2, faces = 0;
    box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 0);
    press_side(context, &b, axis, high, 700, false);
    double *force = malloc(24 * (size_t)b.grid->node_count), sum = 0;
    double quarter = size[0] * size[1] * size[2] / size[axis] / 4 / 4 * 700;
    check_ok(context, bwi_load_case_dead(context, b.solid, b.load_case, force));
    for (int32_t n = 0; n < b.grid->node_count; n++) {
      double x[3], share = quarter;
      bw_grid_position(b.grid, n, x);
      for (int d = 0; d < 3; d++)
        if (d != axis && fabs(x[d] - size[d] / 2) < 1e-9)
          share *= 2;
      bool on = fabs(x[axis] - (high ? size[axis] : 0)) < 1e-9;
      for (int d = 0; d < 3; d++)
        check_near(force[3 * n + d], d == axis && on ? (high ? -share : share) : 0, 1e-9);
      sum += force[3 * n + axis];
      faces += on;
    }
    check_near(fabs(sum), 700 * size[0] * size[1] * size[2] / size[axis], 1e-8);
    assert_int_equal(faces, 9);
    free(force);
    box_free(&b);
  }
}

/* By place, and what is no face. */
static void test_press(void **state) {
  bw_context *context = check_context(state);
  box b;
  double slope = 1000, total = 0, bad = NAN;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 0);
  int32_t *node = malloc(sizeof *node * (size_t)b.grid->node_count);
  int64_t count = box_end(&b, 2, 1, node);
  check_ok(context, bw_load_case_surface_pressure(context, b.load_case, count, node, linear_in_x,
                                                  &slope, 2, false));
  double *force = malloc(24 * (size_t)b.grid->node_count);
  check_ok(context, bwi_load_case_dead(context, b.solid, b.load_case, force));
  for (int32_t n = 0; n < b.grid->node_count; n++)
    total += force[3 * n + 2];
  check_near(total, -2 * 1000 * 0.15 * 0.06, 1e-9);
  check_fails(context, BW_INVALID, "finite",
              bw_load_case_surface_pressure(context, b.load_case, count, node, linear_in_x, &bad, 2,
                                            false));
  check_fails(context, BW_EMPTY, "no free face",
              bw_load_case_surface_pressure(context, b.load_case, 3, node, NULL, NULL, 2, false));
  free(node);
  free(force);
  box_free(&b);
}

/* A follower on faces is the slope of the volume: moved in any way, the work of pressing all six
 * sides is p times the volume that is lost, whatever shape the faces have. */
static void test_follows_volume(void **state) {
  bw_context *context = check_context(state);
  box b;
  bw_random random;
  const double pressure = 40;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 0);
  for (int side = 0; side < 6; side++)
    press_side(context, &b, side / 2, side % 2, pressure, true);
  int n = 3 * b.grid->node_count;
  double *u = calloc(3 * (size_t)n, sizeof *u), *v = u + n, *force = v + n;
  bw_random_seed(&random, 8);
  for (int i = 0; i < n; i++) {
    u[i] = 0.05 * (bw_random_uniform(&random) - 0.5);
    v[i] = bw_random_uniform(&random) - 0.5;
  }
  check_ok(context, bwi_load_case_follow(context, b.load_case, u, 1, force));
  double work = 0, volume[2] = {0, 0}, step = 1e-6;
  for (int i = 0; i < n; i++)
    work += force[i] * v[i];
  bw_rule *rule;
  check_ok(context, bw_rule_create(context, 0, &rule));
  for (int s = 0; s < 2; s++) /* det F of a trilinear cell is integrated exactly by 2 x 2 x 2 */
    for (int32_t e = 0; e < b.grid->element_count; e++)
      for (int k = 0; k < rule->count; k++) {
        double f[9] = {0};
        for (int c = 0; c < 8; c++) {
          int32_t node = b.grid->element[8 * e + c];
          double x[3];
          bw_grid_position(b.grid, node, x);
          for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
              f[3 * i + j] += (x[i] + u[3 * node + i] + (s ? -step : step) * v[3 * node + i]) *
                              rule->gradient[24 * k + 3 * c + j];
        }
        volume[s] += rule->weight[k] *
                     (f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
                      f[2] * (f[3] * f[7] - f[4] * f[6]));
      }
  check_near(work, -pressure * (volume[0] - volume[1]) / (2 * step), 1e-6);
  bw_release(rule);
  free(u);
  box_free(&b);
}

/* The derivative of follower forces against differences. */
static void test_follower_derivative(void **state) {
  bw_context *context = check_context(state);
  box b;
  bw_random random;
  double step = 1e-5;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  press_face(context, &b, 1, 1, 3, true);
  press_face(context, &b, 0, 0, 2, true);
  press_side(context, &b, 2, 1, 4, true);
  int n = 3 * b.grid->node_count;
  double *u = calloc(7 * (size_t)n, sizeof *u), *v = u + n, *moved = v + n;
  bw_random_seed(&random, 3);
  for (int i = 0; i < n; i++) {
    u[i] = 0.1 * bw_random_uniform(&random);
    v[i] = bw_random_uniform(&random);
  }
  double *exact = moved + n, *side = exact + n;
  check_ok(context, bwi_load_case_follow_along(context, b.load_case, u, v, 1, exact));
  for (int s = 0; s < 2; s++) {
    for (int i = 0; i < n; i++)
      moved[i] = u[i] + (s ? -step : step) * v[i];
    check_ok(context, bwi_load_case_follow(context, b.load_case, moved, 1, side + s * n));
  }
  for (int i = 0; i < n; i++)
    check_near(exact[i], (side[i] - side[n + i]) / (2 * step), 1e-9);
  free(u);
  box_free(&b);
}

/* The same cells at another place, or of another size, are another grid. */
static void test_elsewhere(void **state) {
  bw_context *context = check_context(state);
  box b, other;
  const double twice[3] = {0.6, 0.4, 0.4}, point[3] = {0, 0, 0}, normal[3] = {0, 0, 1};
  const double places[3] = {0.1, 0.1, 0.1};
  bw_embedding *embedding;
  bw_solid_static *result;
  bw_solid_transient *motion;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  box_make(context, &other, cells, twice, BW_COROTATED, 1e6, 0.3, 1000);
  check_ok(context, bw_embedding_create(context, other.grid, 1, places, 0, &embedding));
  check_fails(
      context, BW_INVALID, "another grid",
      bw_load_case_contact_plane(context, b.load_case, point, normal, NULL, embedding, NULL));
  check_fails(context, BW_INVALID, "elsewhere",
              bw_solid_statics(context, b.solid, other.load_case, NULL, NULL, &result));
  check_fails(
      context, BW_INVALID, "another grid",
      bw_solid_transient_create(context, b.solid, other.load_case, NULL, NULL, NULL, &motion));
  bw_release(embedding);
  box_free(&b);
  box_free(&other);
}

static void test_contradictions(void **state) {
  bw_context *context = check_context(state);
  box b;
  int32_t node[2] = {0, 7}, wrong = 1000, point[3] = {0, 1, 99};
  bool z[3] = {false, false, true}, none[3] = {false, false, false};
  double up[3] = {0, 0, 0.1}, other[3] = {0, 0, 0.2}, bad[3] = {0, 0, INFINITY}, p = 1;
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  check_ok(context, bw_load_case_fix(context, b.load_case, 2, node, z, up));
  check_ok(context, bw_load_case_fix(context, b.load_case, 1, node, z, up));
  check_fails(context, BW_INVALID, "node 8",
              bw_load_case_fix(context, b.load_case, 1, node + 1, z, other));
  check_fails(context, BW_INVALID, "no node 1001",
              bw_load_case_fix(context, b.load_case, 1, &wrong, z, up));
  check_fails(context, BW_INVALID, "finite",
              bw_load_case_fix(context, b.load_case, 1, node, z, bad));
  check_fails(context, BW_EMPTY, "no direction",
              bw_load_case_fix(context, b.load_case, 1, node, none, up));
  check_fails(context, BW_EMPTY, "the list of nodes is empty",
              bw_load_case_force(context, b.load_case, 0, node, up));
  bw_embedding *embedding;
  double at[6] = {0.1, 0.1, 0.1, 0.2, 0.1, 0.1};
  check_ok(context, bw_embedding_create(context, b.grid, 2, at, 1, &embedding));
  check_fails(context, BW_INVALID, "point 100",
              bw_load_case_pressure(context, b.load_case, embedding, 1, point, &p, false));
  bw_release(embedding);
  box_free(&b);
}

static void check_free(bw_context *context, box *b, const char *text) {
  bw_solid_static *result;
  check_fails(context, BW_UNCONSTRAINED, text,
              bw_solid_statics(context, b->solid, b->load_case, NULL, NULL, &result));
}

static void test_unconstrained(void **state) {
  bw_context *context = check_context(state);
  box b;
  double gravity[3] = {0, 0, -1};
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 1000);
  check_free(context, &b, "can move");
  box_hold(context, &b, 2, 0, false, false, true, 0);
  box_hold(context, &b, 1, 0, false, true, false, 0);
  check_free(context, &b, "along (");
  box_free(&b);
  box_make(context, &b, cells, size, BW_COROTATED, 1e6, 0.3, 0);
  int32_t two[2] = {0, 2}; /* both on the x axis: it can turn about that */
  bool all[3] = {true, true, true};
  check_ok(context, bw_load_case_fix(context, b.load_case, 2, two, all, NULL));
  check_free(context, &b, "rotate as a whole");
  box_hold(context, &b, 0, 0, true, true, true, 0);
  check_ok(context, bw_load_case_gravity(context, b.load_case, gravity));
  bw_solid_static *result;
  check_fails(context, BW_INVALID, "density",
              bw_solid_statics(context, b.solid, b.load_case, NULL, NULL, &result));
  box_free(&b);
}

check_main(check_test(test_totals), check_test(test_followers),
           check_test(test_follower_derivative), check_test(test_elsewhere), check_test(test_even),
           check_test(test_press), check_test(test_follows_volume), check_test(test_contradictions),
           check_test(test_unconstrained))
