/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The mean of a field over surface patches: constants, closed forms on a flat face, thin walls, a
 * singular field, threads, wrong input. */
#include "assemble/dense.h"

typedef double field(const double x[3]);

static bw_mesh *plate(bw_context *context, int cells, int layers, double thickness, int order) {
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){-1, -1, 0}, (double[3]){1, 1, thickness},
                                     (int[3]){cells, cells, layers}, order, &mesh));
  return mesh;
}

static const double *corner(const bw_mesh *mesh, size_t k) {
  return mesh->node + 3 * mesh->facet[k / 3 * (size_t)mesh->nodes_per_facet + k % 3];
}

static double *values_of(const bw_mesh *mesh, field *f) {
  size_t corners = 3 * (size_t)mesh->facet_count;
  double *value = (double *)malloc(sizeof *value * corners);
  for (size_t k = 0; k < corners; k++)
    value[k] = f(corner(mesh, k));
  return value;
}

static int node_near(const bw_mesh *mesh, double x, double y, double z) {
  for (int i = 0; i < mesh->node_count; i++) {
    const double *p = mesh->node + 3 * i;
    if (fabs(p[0] - x) + fabs(p[1] - y) + fabs(p[2] - z) < 1e-9)
      return i;
  }
  fail_msg("no node at %g %g %g", x, y, z);
  return -1;
}

static double mean_at_top(bw_context *context, bw_mesh *mesh, double radius, field *f, double top) {
  double *value = values_of(mesh, f);
  double *mean = (double *)malloc(sizeof *mean * (size_t)mesh->node_count);
  check_ok(context, bw_surface_mean(context, mesh, NULL, radius, 1, value, mean));
  double out = mean[node_near(mesh, 0, 0, top)];
  free(value), free(mean);
  return out;
}

static double seven(const double *x) {
  (void)x;
  return 7;
}

static double slope(const double *x) {
  return 3 + x[0] - 2 * x[1];
}

static double square(const double *x) {
  return x[0] * x[0] + x[1] * x[1];
}

static double side(const double *x) {
  return x[2] > 0.025 ? 1 : -1;
}

/* As the stress at a re-entrant edge of 90 degrees, along x = 0. */
static double singular(const double *x) {
  return pow(fabs(x[0]) + 1e-12, -0.4555);
}

static void test_closed_forms(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = plate(context, 20, 2, 0.4, order);
    check_near(mean_at_top(context, mesh, 0.5, seven, 0.4), 7, 1e-12);
    check_near(mean_at_top(context, mesh, 0.5, slope, 0.4), 3, 1e-12);
    /* of rho^2 with the weight 1 - (rho / r)^2: r^2 / 3 */
    check_near(mean_at_top(context, mesh, 0.8, square, 0.4) / (0.64 / 3), 1, 0.02);
    check_near(mean_at_top(context, mesh, 1e-6, square, 0.4), 0, 1e-14);
    bw_release(mesh);
  }
}

/* The other side of a wall is farther along the surface than the radius. */
static void test_thin_wall(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = plate(context, 12, 1, 0.05, 2);
  check_near(mean_at_top(context, mesh, 0.5, side, 0.05), 1, 1e-14);
  check_near(mean_at_top(context, mesh, 0.5, side, 0), -1, 1e-14);
  bw_release(mesh);
}

/* The field has no limit at the edge, its mean has. */
static void test_singular_field(void **state) {
  bw_context *context = check_context(state);
  double mean[3];
  for (int k = 0; k < 3; k++) {
    bw_mesh *mesh = plate(context, 10 << k, 1, 0.4, 1);
    double *value = values_of(mesh, singular), *out;
    out = (double *)malloc(sizeof *out * (size_t)mesh->node_count);
    double h = 2.0 / (10 << k);
    for (size_t i = 0; i < 3 * (size_t)mesh->facet_count; i++)
      if (fabs(corner(mesh, i)[0]) < 1e-9)
        value[i] = pow(h / 4, -0.4555); /* what a mesh of that size shows there */
    check_ok(context, bw_surface_mean(context, mesh, NULL, 0.6, 1, value, out));
    mean[k] = out[node_near(mesh, 0, 0, 0.4)];
    free(value), free(out);
    bw_release(mesh);
  }
  check_near(mean[1] / mean[0], 1, 0.1);
  assert_true(fabs(mean[2] / mean[1] - 1) < fabs(mean[1] / mean[0] - 1));
}

static void test_columns_and_threads(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = plate(context, 8, 3, 0.4, 2);
  size_t n = (size_t)mesh->node_count, corners = 3 * (size_t)mesh->facet_count;
  double *value = (double *)malloc(2 * corners * sizeof *value), *mean[2];
  for (size_t k = 0; k < corners; k++)
    value[2 * k] = square(corner(mesh, k)), value[2 * k + 1] = slope(corner(mesh, k));
  int before = bw_threads(context);
  for (int k = 0; k < 2; k++) {
    mean[k] = (double *)malloc(2 * n * sizeof **mean);
    check_ok(context, bw_set_threads(context, k ? 4 : 1));
    check_ok(context, bw_surface_mean(context, mesh, NULL, 0.5, 2, value, mean[k]));
  }
  check_ok(context, bw_set_threads(context, before));
  assert_memory_equal(mean[0], mean[1], 2 * n * sizeof **mean);
  int top = node_near(mesh, 0, 0, 0.4);
  check_near(mean[0][2 * top], mean_at_top(context, mesh, 0.5, square, 0.4), 1e-15);
  int inner = 0;
  for (size_t i = 0, b = 0; i < n; i++) {
    bool boundary = b < (size_t)mesh->boundary_node_count && mesh->boundary_node[b] == (int)i;
    b += boundary;
    if (!boundary && mean[0][2 * i] == 0 && mean[0][2 * i + 1] == 0)
      inner++;
  }
  assert_int_equal(inner, mesh->node_count - mesh->boundary_node_count);
  check_fails(context, BW_INVALID, "radius",
              bw_surface_mean(context, mesh, NULL, 0, 2, value, mean[0]));
  check_fails(context, BW_INVALID, "radius",
              bw_surface_mean(context, mesh, NULL, NAN, 2, value, mean[0]));
  free(value), free(mean[0]), free(mean[1]);
  bw_release(mesh);
}

/* A plate that is fixed where x <= 0 has patches on the other side only. */
static void test_supports(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = plate(context, 8, 1, 0.4, 2);
  bw_material *material = NULL;
  bw_model *model = NULL;
  bw_selection *fixed = NULL;
  bw_dof_map *dof_map = NULL;
  const bw_isotropic constants = {.name = "test", .young = 1, .poisson = 0.3};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_half_space(context, mesh, (double[3]){0, 0, 0}, (double[3]){1, 0, 0},
                                         1e-9, &fixed));
  check_ok(context, bw_model_fix(context, model, fixed));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  double *value = values_of(mesh, slope);
  double *mean = (double *)malloc(sizeof *mean * (size_t)mesh->node_count);
  check_ok(context, bw_surface_mean(context, mesh, dof_map, 0.5, 1, value, mean));
  /* At the border 3 + x over half a disc: x has the mean r 16 / (15 pi) by the weight. */
  check_near(mean[node_near(mesh, 0, 0, 0.4)], 3 + 0.5 * 16 / (15 * acos(-1)), 0.02);
  assert_true(mean[node_near(mesh, -0.5, 0, 0.4)] == 0);
  check_near(mean[node_near(mesh, 0.5, 0, 0.4)], 3.5, 1e-12);
  /* Nearest nodes with a patch: those with a mean, as a search of all finds them. */
  const double point[4][3] = {{-0.5, 0, 0.4}, {-0.9, -0.6, 0}, {0.5, 0.01, 0.41}, {0.02, 0.3, 0.2}};
  int32_t found[4];
  check_ok(context, bw_nearest_patch_nodes(context, mesh, dof_map, 4, point[0], found));
  for (int k = 0; k < 4; k++) {
    double least = INFINITY;
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i;
      double d[3] = {x[0] - point[k][0], x[1] - point[k][1], x[2] - point[k][2]};
      least = mean[i] != 0 ? fmin(least, bw_norm(d)) : least;
    }
    const double *x = mesh->node + 3 * found[k];
    double d[3] = {x[0] - point[k][0], x[1] - point[k][1], x[2] - point[k][2]};
    assert_true(mean[found[k]] != 0);
    check_near(bw_norm(d), least, 1e-14);
  }
  assert_int_equal(found[0], node_near(mesh, 0, 0, 0.4));
  free(value), free(mean);
  bw_release(fixed), bw_release(dof_map);
  check_ok(context, bw_nearest_patch_nodes(context, mesh, NULL, 1, point[0], found));
  assert_int_equal(found[0], node_near(mesh, -0.5, 0, 0.4));
  const double nowhere[6] = {0, 0, 0, 0, NAN, 0};
  check_fails(context, BW_INVALID, "point 2",
              bw_nearest_patch_nodes(context, mesh, NULL, 2, nowhere, found));
  check_ok(context, bw_select_all(context, mesh, &fixed));
  check_ok(context, bw_model_fix(context, model, fixed));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  check_fails(context, BW_EMPTY, "whole boundary",
              bw_nearest_patch_nodes(context, mesh, dof_map, 1, point[0], found));
  bw_release(dof_map), bw_release(fixed), bw_release(model), bw_release(material);
  bw_release(mesh);
}

check_main(check_test(test_closed_forms), check_test(test_thin_wall),
           check_test(test_singular_field), check_test(test_columns_and_threads),
           check_test(test_supports))
