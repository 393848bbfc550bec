/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Manufactured solutions: a smooth displacement is chosen, the body force that it needs follows
 * from the law, and the error of the computed field must fall with the power of the mesh size that
 * theory gives: p+1 in L2, p in energy, for tet4 (p = 1) and tet10 (p = 2). Isotropic and rotated
 * orthotropic, on grids whose inner nodes are perturbed. */
#include "check.h"

/* u_i = A_i sin(k_i . x + phase_i) */
static const double amplitude[3] = {1.0, 0.7, -0.4};
static const double wave[3][3] = {{1.1, 0.6, -0.4}, {-0.5, 1.3, 0.7}, {0.8, -0.3, 1.2}};
static const double phase[3] = {0.3, 1.1, -0.5};
/* The tensor index pairs of the six stress components. */
static const int pair[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

static void exact(const double x[3], double u[3], double gradient[3][3]) {
  for (int i = 0; i < 3; i++) {
    double t = bw_dot(wave[i], x) + phase[i];
    u[i] = amplitude[i] * sin(t);
    for (int j = 0; j < 3; j++)
      gradient[i][j] = amplitude[i] * wave[i][j] * cos(t);
  }
}

/* f_i = -C_ijkl d_j d_l u_k */
static void body_force(const bw_material *material, const double x[3], double f[3]) {
  for (int i = 0; i < 3; i++) {
    f[i] = 0;
    for (int k = 0; k < 3; k++) {
      double second = -amplitude[k] * sin(bw_dot(wave[k], x) + phase[k]);
      for (int j = 0; j < 3; j++)
        for (int l = 0; l < 3; l++)
          f[i] -=
              material->elasticity[6 * pair[i][j] + pair[k][l]] * second * wave[k][j] * wave[k][l];
    }
  }
}

static bool on_surface(const double *x) {
  for (int d = 0; d < 3; d++)
    if (x[d] == 0 || x[d] == 1)
      return true;
  return false;
}

static bw_mesh *perturbed_grid(bw_context *context, int cells, int order) {
  double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  int n[3] = {cells, cells, cells};
  bw_mesh *grid, *moved, *mesh;
  check_ok(context, bw_mesh_box_grid(context, low, high, n, 1, &grid));
  double *x = BW_NEW(context, double, 3 * (size_t)grid->node_count);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int32_t i = 0; i < grid->node_count; i++)
    for (int d = 0; d < 3; d++) {
      double perturbation = 0.12 / cells * (2 * bw_random_uniform(&random) - 1);
      x[3 * i + d] = grid->node[3 * i + d] + (on_surface(grid->node + 3 * i) ? 0 : perturbation);
    }
  check_ok(context, bw_mesh_moved(context, grid, x, &moved));
  check_ok(context, bw_mesh_with_order(context, moved, order, &mesh));
  bw_free(x);
  bw_release(grid);
  bw_release(moved);
  return mesh;
}

static void element_nodes(const bw_mesh *mesh, int32_t e, double x[10][3]) {
  for (int a = 0; a < mesh->nodes_per_element; a++)
    memcpy(x[a], mesh->node + 3 * (size_t)mesh->element[e * mesh->nodes_per_element + a],
           3 * sizeof(double));
}

/* The point with barycentric coordinates `at` of a straight element. */
static void place(const double x[10][3], const double at[4], double point[3]) {
  for (int d = 0; d < 3; d++)
    point[d] = at[0] * x[0][d] + at[1] * x[1][d] + at[2] * x[2][d] + at[3] * x[3][d];
}

static void errors(bw_context *context, const bw_material *material, int cells, int order,
                   double *l2, double *energy) {
  bw_mesh *mesh = perturbed_grid(context, cells, order);
  bw_model *model;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  const bool fixed[3] = {true, true, true};
  bw_selection *surface;
  bw_array *field;
  check_ok(context, bw_select_all(context, mesh, &surface));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &field));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double gradient[3][3];
    exact(mesh->node + 3 * (size_t)i, (double *)field->data + 3 * (size_t)i, gradient);
  }
  check_ok(context, bw_model_prescribe_field(context, model, surface, fixed, field));
  bw_array *force;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &force));
  double *f = (double *)force->data;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(6, point, weight), nodes = mesh->nodes_per_element;
  double x[10][3], at[3], b[3], shape[10];
  for (int32_t e = 0; e < mesh->element_count; e++) {
    element_nodes(mesh, e, x);
    for (int q = 0; q < points; q++) {
      place(x, point[q], at);
      body_force(material, at, b);
      bw_tet_shape(order, point[q], shape);
      for (int a = 0; a < nodes; a++)
        for (int d = 0; d < 3; d++)
          f[3 * mesh->element[e * nodes + a] + d] += weight[q] * mesh->volume[e] * shape[a] * b[d];
    }
  }
  check_ok(context, bw_model_nodal_forces(context, model, force));
  bw_static *result;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  assert_true(result->residual < 1e-9);
  double squares = 0, strain_squares = 0;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    element_nodes(mesh, e, x);
    for (int q = 0; q < points; q++) {
      double u[3], gradient[3][3], slope[10][3];
      place(x, point[q], at);
      exact(at, u, gradient);
      bw_tet_shape(order, point[q], shape);
      bw_tet_gradient(order, (const double(*)[3])x, point[q], slope);
      for (int a = 0; a < nodes; a++) {
        const double *v = result->displacement + 3 * (size_t)mesh->element[e * nodes + a];
        for (int i = 0; i < 3; i++) {
          u[i] -= shape[a] * v[i];
          for (int j = 0; j < 3; j++)
            gradient[i][j] -= v[i] * slope[a][j];
        }
      }
      double strain[6] = {gradient[0][0],
                          gradient[1][1],
                          gradient[2][2],
                          gradient[1][2] + gradient[2][1],
                          gradient[2][0] + gradient[0][2],
                          gradient[0][1] + gradient[1][0]};
      double density = 0;
      for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
          density += strain[i] * material->elasticity[6 * i + j] * strain[j];
      squares += weight[q] * mesh->volume[e] * bw_dot(u, u);
      strain_squares += weight[q] * mesh->volume[e] * density;
    }
  }
  *l2 = sqrt(squares);
  *energy = sqrt(strain_squares);
  bw_release(field);
  bw_release(surface);
  bw_release(result);
  bw_release(force);
  bw_release(model);
  bw_release(mesh);
}

static void converge(bw_context *context, const bw_material *material, int order) {
  int coarse = order == 1 ? 6 : 3, rounds = 3;
  double l2[3], energy[3];
  for (int r = 0; r < rounds; r++)
    errors(context, material, coarse << r, order, &l2[r], &energy[r]);
  double l2_order = log2(l2[1] / l2[2]), energy_order = log2(energy[1] / energy[2]);
  printf("VERIFY | manufactured solution, %s, tet%d | order in L2 | %d | %.2f | 0.15 | theory\n",
         material->name, order == 1 ? 4 : 10, order + 1, l2_order);
  printf(
      "VERIFY | manufactured solution, %s, tet%d | order in energy | %d | %.2f | 0.15 | theory\n",
      material->name, order == 1 ? 4 : 10, order, energy_order);
  assert_true(l2_order > order + 1 - 0.15);
  assert_true(energy_order > order - 0.15);
}

static void test_isotropic(void **state) {
  bw_context *context = check_context(state);
  bw_isotropic constants = {.name = "isotropic", .young = 3.0, .poisson = 0.3};
  bw_material *material;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  converge(context, material, 1);
  converge(context, material, 2);
  bw_release(material);
}

static void test_orthotropic(void **state) {
  bw_context *context = check_context(state);
  double c = cos(0.6), s = sin(0.6);
  bw_orthotropic constants = {.name = "orthotropic",
                              .young = {5, 2, 1},
                              .poisson = {0.3, 0.05, 0.35},
                              .shear = {0.6, 0.7, 0.9},
                              .axes = {c, s, 0, -s, c, 0, 0, 0, 1}};
  bw_material *material;
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  converge(context, material, 1);
  converge(context, material, 2);
  bw_release(material);
}

check_main(check_test(test_isotropic), check_test(test_orthotropic))
