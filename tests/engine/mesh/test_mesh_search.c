/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quality measures against closed forms; the locator against trying every element. */
#include "check.h"

static void test_regular(void **state) {
  bw_context *context = check_context(state);
  double node[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
  int32_t element[4] = {0, 1, 2, 3};
  bw_mesh *mesh;
  bw_mesh_quality q;
  check_ok(context, bw_mesh_copy(context, 1, 4, node, 1, element, NULL, &mesh));
  bw_mesh_quality_of(mesh, &q);
  check_near(q.dihedral_min, acos(1.0 / 3), 1e-14);
  check_near(q.dihedral_max, acos(1.0 / 3), 1e-14);
  check_near(q.radius_edge_max, sqrt(6) / 4, 1e-14);
  check_near(q.aspect_max, sqrt(1.5), 1e-14);
  check_near(q.volume_min, 8.0 / 3, 1e-14);
  assert_int_equal(q.worst, 0);
  bw_release(mesh);
}

/* The Kuhn tetrahedron of the unit cube, twice: once flattened to the height t. */
static void test_flat(void **state) {
  bw_context *context = check_context(state);
  double t = 1e-3;
  double node[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1, 5, 0, 0, 6, 0, 0, 6, 1, 0, 6, 1, t};
  int32_t element[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  bw_mesh *mesh;
  bw_mesh_quality q;
  check_ok(context, bw_mesh_copy(context, 1, 8, node, 1, element, NULL, &mesh));
  bw_mesh_quality_of(mesh, &q); /* angles 90 (3), 60, 45 (2); circumradius sqrt(3)/2 */
  check_near(q.dihedral_min, acos(-1) / 4, 1e-14);
  check_near(q.dihedral_max, acos(-1) / 2, 1e-14);
  check_near(q.radius_edge_max, sqrt(3) / 2, 1e-14);
  check_near(q.aspect_max, sqrt(3) * sqrt(2), 1e-13);
  bw_release(mesh);
  check_ok(context, bw_mesh_copy(context, 1, 8, node, 2, element, NULL, &mesh));
  bw_mesh_quality_of(mesh, &q);
  assert_int_equal(q.worst, 1);
  check_near(q.dihedral_min, atan(t), 1e-14); /* the two large faces meet in an edge of length 1 */
  check_near(q.volume_min, t / 6, 1e-16);
  check_near(q.aspect_max, sqrt(2 + t * t) * sqrt(1 + t * t) / t, 1e-9 / t);
  bw_release(mesh);
}

static void twist(void *data, const double u[3], double out[3]) {
  (void)data;
  out[0] = 2 * u[0] + 0.1 * sin(5 * u[1]);
  out[1] = u[1] * (1 + 0.3 * u[0]) + 0.2 * u[2];
  out[2] = 0.5 * u[2] + 0.1 * cos(4 * u[0]);
}

static void test_locator(void **state) {
  bw_context *context = check_context(state);
  int cells[3] = {9, 7, 3};
  bw_mesh *mesh;
  bw_locator *locator;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, twist, NULL, &mesh));
  check_ok(context, bw_locator_create(context, mesh, &locator));
  bw_random random;
  bw_random_seed(&random, 7);

  /* Points made inside an element are found there, with their weights. */
  for (int trial = 0; trial < 2000; trial++) {
    int32_t e = (int32_t)(bw_random_uniform(&random) * mesh->element_count);
    double w[4], sum = 0, p[3] = {0, 0, 0}, found[4];
    for (int k = 0; k < 4; k++)
      sum += w[k] = 0.01 + bw_random_uniform(&random);
    for (int k = 0; k < 4; k++)
      for (int i = 0; i < 3; i++)
        p[i] += w[k] / sum * mesh->node[3 * mesh->element[10 * e + k] + i];
    bool inside = false;
    assert_int_equal(bw_locator_find(locator, p, found, &inside), e);
    assert_true(inside);
    for (int k = 0; k < 4; k++)
      check_near(found[k], w[k] / sum, 1e-12);
  }

  /* Outside, the nearest place is at most as far as the nearest of many samples on the boundary,
   * and the weights describe it. */
  int outside = 0;
  for (int trial = 0; trial < 400; trial++) {
    double p[3] = {-1 + 4 * bw_random_uniform(&random), -1 + 4 * bw_random_uniform(&random),
                   -1 + 3 * bw_random_uniform(&random)};
    double w[4], q[3] = {0, 0, 0}, sampled = INFINITY, sum = 0;
    bool inside = true;
    int32_t e = bw_locator_find(locator, p, w, &inside);
    if (inside)
      continue;
    outside++;
    for (int k = 0; k < 4; k++) {
      assert_true(w[k] >= 0);
      sum += w[k];
      for (int i = 0; i < 3; i++)
        q[i] += w[k] * mesh->node[3 * mesh->element[10 * e + k] + i];
    }
    check_near(sum, 1, 1e-12);
    for (int32_t f = 0; f < mesh->facet_count; f++)
      for (int a = 0; a <= 6; a++)
        for (int b = 0; a + b <= 6; b++) {
          double d = 0;
          for (int i = 0; i < 3; i++) {
            const int32_t *n = mesh->facet + 6 * f;
            double x = (a * mesh->node[3 * n[0] + i] + b * mesh->node[3 * n[1] + i] +
                        (6 - a - b) * mesh->node[3 * n[2] + i]) /
                       6;
            d += (x - p[i]) * (x - p[i]);
          }
          sampled = fmin(sampled, sqrt(d));
        }
    double distance = hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]);
    assert_true(distance <= sampled + 1e-12 && distance > sampled - 0.06);
  }
  assert_true(outside > 200);
  double nowhere[3] = {NAN, 0, 0}, w[4];
  bool inside = true;
  assert_int_equal(bw_locator_find(locator, nowhere, w, &inside), 0);
  assert_false(inside);
  bw_release(mesh); /* the locator keeps it */
  assert_true(bw_bytes(locator) > 1000);
  bw_release(locator);
}

static void test_locator_memory(void **state) {
  bw_context *context = check_context(state);
  double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  int cells[3] = {2, 2, 2};
  bw_mesh *mesh;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &mesh));
  check_each_allocation(context, status, 1) {
    bw_locator *locator = NULL;
    status = bw_locator_create(context, mesh, &locator);
    bw_release(locator);
  }
  bw_release(mesh);
}

check_main(check_test(test_regular), check_test(test_flat), check_test(test_locator),
           check_test(test_locator_memory))
