/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skinning weights: a closed form, symmetries, sight, bodies without bones, and the sparse systems
 * behind them. */
#include "check.h"
#include "linear/matrix_factor.h"

static bw_skeleton *bones_between(bw_context *context, int joints, const double *joint, int bones,
                                  const int32_t *bone) {
  bw_skeleton *s = NULL;
  check_ok(context, bw_skeleton_create(context, joints, joint, NULL, bones, bone, NULL, 0, &s));
  return s;
}

static double *heated(bw_context *context, const bw_mesh *mesh, const bw_skeleton *s, double heat) {
  double *w = malloc((size_t)mesh->node_count * (size_t)s->bone_count * sizeof *w);
  bw_weights_options options = {heat};
  check_ok(context, bw_skinning_weights(context, mesh, s, &options, w));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double sum = 0;
    for (int32_t b = 0; b < s->bone_count; b++) {
      assert_true(w[i * s->bone_count + b] >= 0);
      sum += w[i * s->bone_count + b];
    }
    check_near(sum, 1, 1e-12);
  }
  return w;
}

static double *weights(bw_context *context, const bw_mesh *mesh, const bw_skeleton *s) {
  return heated(context, mesh, s, 0);
}

/* The unit square onto a disc of radius 1, x along the third axis. */
static void rod(void *data, const double unit[3], double out[3]) {
  double length = *(double *)data, a = 2 * unit[0] - 1, b = 2 * unit[1] - 1;
  double r = fmax(fabs(a), fabs(b)), angle = 0;
  if (r > 0) {
    if (fabs(a) >= fabs(b))
      angle = (a > 0 ? 0 : M_PI) + M_PI / 4 * b / a;
    else
      angle = (b > 0 ? M_PI / 2 : -M_PI / 2) - M_PI / 4 * a / b;
  }
  out[0] = r * cos(angle);
  out[1] = r * sin(angle);
  out[2] = length * (unit[2] - 0.5);
}

/* On a round rod with its bones on the axis d is the radius everywhere, so that along the surface
 * w'' = heat (w - p) / r^2: w = exp(-sqrt(heat) |z| / r) / 2 beyond the place where the bones meet.
 */
static void a_round_rod_has_the_closed_form(void **state) {
  bw_context *context = check_context(state);
  double length = 12;
  static const int cells[3] = {10, 10, 96};
  static const double joint[9] = {0, 0, -6, 0, 0, 0, 0, 0, 6};
  static const int32_t bone[4] = {0, 1, 1, 2};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, rod, &length, &mesh));
  bw_skeleton *s = bones_between(context, 3, joint, 2, bone);
  for (double heat = 1; heat < 5; heat += 3) {
    double *w = heated(context, mesh, s, heat);
    int compared = 0;
    for (int32_t k = 0; k < mesh->boundary_node_count; k++) {
      int32_t i = mesh->boundary_node[k];
      const double *x = mesh->node + 3 * i;
      if (fabs(x[2]) > 4)
        continue; /* the ends are caps */
      double far = 0.5 * exp(-sqrt(heat) * fabs(x[2])), expected = x[2] > 0 ? far : 1 - far;
      check_near(w[2 * i], expected, 0.01);
      compared++;
    }
    assert_true(compared > 1000);
    free(w);
  }
  bw_release(s);
  bw_release(mesh);
}

/* A grid of Kuhn's is its own image in its middle, and so is this skeleton. */
static void a_symmetric_bar_has_symmetric_weights(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {-3, -0.5, -0.5}, high[3] = {3, 0.5, 0.5};
  static const int cells[3] = {24, 4, 4};
  static const double joint[9] = {-2.8, 0.1, 0, 0, 0, 0, 2.8, -0.1, 0};
  static const int32_t bone[4] = {0, 1, 1, 2};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
    bw_skeleton *s = bones_between(context, 3, joint, 2, bone);
    double *w = weights(context, mesh, s), along[2][25];
    bw_locator *locator = NULL;
    check_ok(context, bw_locator_create(context, mesh, &locator));
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i, turned[3] = {-x[0], -x[1], -x[2]};
      double part[4];
      bool inside;
      int32_t e = bw_locator_find(locator, turned, part, &inside);
      double mirrored = 0;
      for (int a = 0; a < 4; a++)
        mirrored += part[a] * w[2 * mesh->element[e * mesh->nodes_per_element + a]];
      check_near(mirrored, w[2 * i + 1], 1e-9);
      /* the axis and an edge of the bar, for the next check */
      for (int line = 0; line < 2; line++)
        if (fabs(x[1] - 0.5 * line) < 1e-9 && fabs(x[2] - 0.5 * line) < 1e-9) {
          double place = (x[0] + 3) * 4;
          if (fabs(place - round(place)) < 1e-9)
            along[line][(int)round(place)] = w[2 * i];
        }
    }
    for (int line = 0; line < 2; line++)
      for (int k = 0; k < 24; k++)
        assert_true(along[line][k] >= along[line][k + 1] - 1e-12);
    check_near(along[0][0], 1, 0.01);
    check_near(along[0][12], 0.5, 0.02);
    check_near(along[0][24], 0, 0.01);
    bw_release(locator);
    free(w);
    bw_release(s);
    bw_release(mesh);
  }
}

static double limbs(void *data, const double at[3]) {
  (void)data;
  static const double end[4][3] = {{1, 0.2, 0}, {-0.9, 0.3, 0.2}, {0.1, 1, -0.3}, {0, -0.4, 0.9}};
  double min = HUGE_VAL;
  for (int k = 0; k < 4; k++) {
    double t = fmin(fmax(bw_dot(at, end[k]) / bw_dot(end[k], end[k]), 0), 1), d[3];
    for (int c = 0; c < 3; c++)
      d[c] = at[c] - t * end[k][c];
    min = fmin(min, bw_norm(d) - 0.2);
  }
  return min;
}

static void limbed(bw_context *context, int order, bw_mesh **mesh, bw_skeleton **s) {
  static const double low[3] = {-1.3, -0.8, -0.8}, high[3] = {1.4, 1.4, 1.3};
  static const double joint[5 * 3] = {0,    0,     0,    0.95,   0.19, 0,     -0.855, 0.285,
                                      0.19, 0.095, 0.95, -0.285, 0,    -0.38, 0.855};
  static const int32_t bone[4 * 2] = {0, 1, 0, 2, 0, 3, 0, 4};
  bw_surface *surface = NULL;
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.order = order;
  options.elements = 3000;
  check_ok(context, bw_surface_implicit(context, low, high, 30, limbs, NULL, &surface));
  check_ok(context, bw_mesh_fill(context, surface, &options, mesh, NULL));
  bw_release(surface);
  *s = bones_between(context, 5, joint, 4, bone);
}

static void moved(bw_context *context, const bw_mesh *mesh, const bw_skeleton *s,
                  const double map[12], bw_mesh **mesh_out, bw_skeleton **s_out) {
  double *node = malloc(3 * (size_t)mesh->node_count * sizeof *node), joint[15];
  for (int32_t i = 0; i < mesh->node_count + s->joint_count; i++) {
    bool is_node = i < mesh->node_count;
    const double *x = is_node ? mesh->node + 3 * i : s->joint + 3 * (i - mesh->node_count);
    double *to = is_node ? node + 3 * i : joint + 3 * (i - mesh->node_count);
    for (int k = 0; k < 3; k++)
      to[k] = bw_dot(map + 4 * k, x) + map[4 * k + 3];
  }
  check_ok(context, bw_mesh_moved(context, mesh, node, mesh_out));
  check_ok(context, bw_skeleton_create(context, s->joint_count, joint, NULL, s->bone_count, s->bone,
                                       NULL, s->root, s_out));
  free(node);
}

static void scale_and_place_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL, *other = NULL;
  bw_skeleton *s = NULL, *turned = NULL;
  limbed(context, 2, &mesh, &s);
  double *w = weights(context, mesh, s);
  /* every limb follows its bone at its end */
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int b = 0; b < 4; b++) {
      const double *tail = s->joint + 3 * s->bone[2 * b + 1], *x = mesh->node + 3 * i;
      double d[3] = {x[0] - tail[0], x[1] - tail[1], x[2] - tail[2]};
      if (bw_norm(d) < 0.2)
        assert_true(w[4 * i + b] > 0.9);
    }
  /* a turn about (1, 1, 1), a thousandth of the size, far away */
  static const double turn[12] = {0, 0, 1e-3, 5, 1e-3, 0, 0, -7, 0, 1e-3, 0, 2};
  moved(context, mesh, s, turn, &other, &turned);
  double *again = weights(context, other, turned);
  for (int32_t i = 0; i < 4 * mesh->node_count; i++)
    check_near(again[i], w[i], 1e-6);
  /* mid-edge nodes are the mean of their edge's ends */
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + 10 * e;
    check_near(w[4 * node[7]], 0.5 * (w[4 * node[0]] + w[4 * node[3]]), 1e-15);
  }
  free(w);
  free(again);
  bw_release(other);
  bw_release(turned);
  bw_release(mesh);
  bw_release(s);
}

static void any_number_of_threads_gives_the_same_bits(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  bw_skeleton *s = NULL;
  limbed(context, 1, &mesh, &s);
  check_ok(context, bw_set_threads(context, 1));
  double *one = weights(context, mesh, s);
  check_ok(context, bw_set_threads(context, 3));
  double *three = weights(context, mesh, s);
  assert_memory_equal(one, three, (size_t)mesh->node_count * 4 * sizeof *one);
  free(one);
  free(three);
  bw_release(mesh);
  bw_release(s);
}

/* The engine's own Laplacian of tetrahedra, which weights.c does not use, finds nothing inside. */
static void weights_inside_are_harmonic(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  bw_skeleton *s = NULL;
  bw_block_pattern *pattern = NULL;
  limbed(context, 1, &mesh, &s);
  double *w = weights(context, mesh, s);
  check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
  double *laplacian = malloc((size_t)pattern->block_count * sizeof *laplacian);
  double *x = malloc((size_t)mesh->node_count * sizeof *x);
  double *y = malloc((size_t)mesh->node_count * sizeof *y), max = 0;
  uint8_t *outer = calloc((size_t)mesh->node_count, 1);
  check_ok(context, bw_laplacian(context, pattern, mesh, laplacian));
  for (int32_t k = 0; k < mesh->boundary_node_count; k++)
    outer[mesh->boundary_node[k]] = 1;
  for (int b = 0; b < 4; b++) {
    for (int32_t i = 0; i < mesh->node_count; i++)
      x[i] = w[4 * i + b];
    check_ok(context, bw_block_multiply(context, pattern, laplacian, 1, 1, 1, x, y));
    int inner = 0;
    for (int32_t i = 0; i < mesh->node_count; i++)
      max = fmax(max, fabs(y[i]));
    for (int32_t i = 0; i < mesh->node_count; i++) {
      inner += !outer[i];
      if (!outer[i])
        check_near(y[i], 0, 1e-4 * max); /* where a negative weight was cut: not quite */
    }
    assert_true(inner > 100);
  }
  free(outer);
  free(x);
  free(y);
  free(laplacian);
  free(w);
  bw_release(pattern);
  bw_release(mesh);
  bw_release(s);
}

/* A U: a thick prong at the left, with its bone at its far side, a thin one at the right, nearer to
 * the inner side of the thick one than that one's own bone. Only sight tells whose it is. */
static void a_bone_behind_a_gap_is_not_seen(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {0, 0, 0}, high[3] = {5, 1, 8};
  static const int cells[3] = {10, 2, 16};
  static const double joint[12] = {0.5, 0.5, 7.5, 0.5, 0.5, 0.5, 4.5, 0.5, 0.5, 4.25, 0.5, 7.5};
  static const int32_t bone[6] = {0, 1, 1, 2, 2, 3};
  bw_mesh *box = NULL, *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &box));
  uint8_t *keep = malloc((size_t)box->element_count);
  for (int32_t e = 0; e < box->element_count; e++) {
    double x = 0, z = 0;
    for (int a = 0; a < 4; a++) {
      x += box->node[3 * box->element[4 * e + a]] / 4;
      z += box->node[3 * box->element[4 * e + a] + 2] / 4;
    }
    keep[e] = x < 3 || x > 4 || z < 1;
  }
  check_ok(context, bw_mesh_subset(context, box, keep, &mesh));
  bw_skeleton *s = bones_between(context, 4, joint, 3, bone);
  double *w = weights(context, mesh, s);
  int seen = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    if (x[0] <= 3 && x[2] >= 6) {
      assert_true(w[3 * i] > 0.9);
      assert_true(w[3 * i + 2] < 0.05);
      seen++;
    }
  }
  assert_true(seen > 50);
  free(w);
  free(keep);
  bw_release(s);
  bw_release(mesh);
  bw_release(box);
}

static void bodies_without_a_bone_follow_the_nearest(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {0, 0, 0}, high[3] = {9, 1, 1};
  static const int cells[3] = {18, 2, 2};
  static const double joint[9] = {0.1, 0.5, 0.5, 2.9, 0.5, 0.5, 9.5, 3, 3};
  static const int32_t bone[4] = {0, 1, 1, 2}; /* the second leaves the body */
  bw_mesh *box = NULL, *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &box));
  uint8_t *keep = malloc((size_t)box->element_count);
  for (int32_t e = 0; e < box->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += box->node[3 * box->element[4 * e + a]] / 4;
    keep[e] = x < 3 || (x > 4 && x < 5) || x > 8;
  }
  check_ok(context, bw_mesh_subset(context, box, keep, &mesh));
  assert_int_equal(mesh->component_count, 3);
  bw_skeleton *s = bones_between(context, 3, joint, 2, bone);
  double *w = weights(context, mesh, s); /* all checks are there */
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (mesh->node[3 * i] > 7)
      check_near(w[2 * i + 1], 1, 1e-9);
  bw_weights_options bad = {-1};
  check_fails(context, BW_INVALID, "heat", bw_skinning_weights(context, mesh, s, &bad, w));
  free(w);
  free(keep);
  bw_release(s);
  bw_release(mesh);
  bw_release(box);
}

/* ---- sparse systems -------------------------------------------------------------------------- */

static bw_status solve(bw_context *context, int size, int64_t count, const int32_t *row,
                       const int32_t *column, const double *value, int64_t columns, double *x) {
  bw_sparse_matrix *matrix;
  check_ok(context,
           bw_sparse_matrix_create(context, size, size, count, row, column, value, &matrix));
  bw_status status = bwi_matrix_solve(context, matrix, "a", "", columns, x);
  bw_release(matrix);
  return status;
}

static void sparse_systems_are_solved(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 300, MAX = SIZE * 12, COUNT = 37 };
  int32_t row[MAX], column[MAX];
  double value[MAX];
  double *x = malloc(SIZE * COUNT * sizeof *x), *b = calloc(SIZE * COUNT, sizeof *b);
  int64_t count = 0;
  bw_random random;
  bw_random_seed(&random, 7);
  for (int i = 0; i < SIZE; i++) {
    row[count] = column[count] = i;
    value[count++] = 8;
    for (int k = 0; k < 5; k++) { /* also twice at one place */
      int j = (int)(bw_random_uniform(&random) * SIZE);
      double off = bw_random_uniform(&random) - 0.5;
      if (j == i)
        continue;
      row[count] = i > j ? i : j;
      column[count] = i > j ? j : i;
      value[count++] = off;
    }
  }
  for (int i = 0; i < SIZE * COUNT; i++)
    x[i] = bw_random_normal(&random);
  for (int c = 0; c < COUNT; c++)
    for (int64_t k = 0; k < count; k++) {
      b[c * SIZE + row[k]] += value[k] * x[c * SIZE + column[k]];
      if (row[k] != column[k])
        b[c * SIZE + column[k]] += value[k] * x[c * SIZE + row[k]];
    }
  check_ok(context, solve(context, SIZE, count, row, column, value, COUNT, b));
  for (int i = 0; i < SIZE * COUNT; i++)
    check_near(b[i], x[i], 1e-12);
  value[0] = -8;
  check_fails(context, BW_SINGULAR, "row", solve(context, SIZE, count, row, column, value, 1, b));
  check_fails(context, BW_SINGULAR, "row",
              solve(context, SIZE, count - 6, row, column, value, 1, b)); /* 0 on the diagonal */
  check_ok(context, solve(context, 0, 0, row, column, value, 1, b));
  free(x);
  free(b);
}

static void every_failing_allocation_is_survived(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {0, 0, 0}, high[3] = {3, 1, 1};
  static const int cells[3] = {6, 2, 2};
  static const double joint[9] = {0.1, 0.5, 0.5, 1.4, 0.5, 0.5, 2.9, 0.5, 0.5};
  static const int32_t bone[4] = {0, 1, 1, 2};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 2, &mesh));
  bw_skeleton *s = bones_between(context, 3, joint, 2, bone);
  double *w = malloc(2 * (size_t)mesh->node_count * sizeof *w);
  check_each_allocation(context, status, 1) {
    status = bw_skinning_weights(context, mesh, s, NULL, w);
  }
  free(w);
  bw_release(s);
  bw_release(mesh);
}

check_main(check_test(a_round_rod_has_the_closed_form),
           check_test(a_symmetric_bar_has_symmetric_weights),
           check_test(scale_and_place_do_not_matter),
           check_test(any_number_of_threads_gives_the_same_bits),
           check_test(weights_inside_are_harmonic), check_test(a_bone_behind_a_gap_is_not_seen),
           check_test(bodies_without_a_bone_follow_the_nearest),
           check_test(sparse_systems_are_solved), check_test(every_failing_allocation_is_survived))
