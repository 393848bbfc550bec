/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness: closed forms against quadrature, rigid-body motions, spectrum, rotations, threads. */
#include "assemble/dense.h"

static const double corner[4][3] = {
    {0.1, 0.2, -0.1}, {1.3, 0.1, 0.2}, {0.3, 1.1, 0.1}, {0.2, 0.4, 1.2}};

static void tet10(double bulge, double x[10][3]) {
  memcpy(x, corner, sizeof corner);
  for (int m = 0; m < 6; m++)
    for (int k = 0; k < 3; k++)
      x[4 + m][k] = 0.5 * (corner[bw_tet_edge[m][0]][k] + corner[bw_tet_edge[m][1]][k]) +
                    bulge * sin(3.0 * m + k);
}

static double largest(const double *a, int64_t n) {
  double max = 0;
  for (int64_t i = 0; i < n; i++)
    max = fmax(max, fabs(a[i]));
  return max;
}

/* The assembled matrix is the sum of element matrices made by quadrature. */
static void assembly_is_the_sum_of_elements(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[4];
  formulated_materials(context, 2e9, material);
  for (int kind = 0; kind < 3; kind++) /* tet4, straight tet10, partly curved tet10 */
    for (int m = 0; m < 4; m++) {
      bw_mesh *mesh = NULL;
      bw_block_pattern *g = NULL;
      perturbed_box(context, 2, 2, 1, kind ? 2 : 1, 0.3, kind == 2 ? 0.2 : 0, &mesh);
      check_ok(context, bw_block_pattern_create(context, mesh, &g));
      double *values = (double *)malloc(sizeof *values * 9 * (size_t)g->block_count);
      check_ok(context, bw_stiffness(context, g, mesh, material[m], values));
      double *full = dense_stiffness(g, values);
      int n = 3 * mesh->node_count, per = mesh->nodes_per_element;
      double scale = largest(full, (int64_t)n * n);
      for (int e = 0; e < mesh->element_count; e++) {
        const int32_t *node = mesh->element + per * e;
        double x[10][3], k[900];
        for (int a = 0; a < per; a++)
          memcpy(x[a], mesh->node + 3 * node[a], sizeof x[a]);
        check_ok(context,
                 bw_element_stiffness(context, mesh->order, (const double(*)[3])x, material[m], k));
        for (int i = 0; i < 3 * per; i++)
          for (int j = 0; j < 3 * per; j++)
            full[(3 * node[i / 3] + i % 3) * n + 3 * node[j / 3] + j % 3] -= k[i * 3 * per + j];
      }
      check_near(largest(full, (int64_t)n * n), 0, 2e-14 * scale);
      for (int i = 0; i < mesh->node_count; i++) { /* diagonal blocks are exactly symmetric */
        const double *d = values + 9 * (g->start[i + 1] - 1);
        assert_true(d[1] == d[3] && d[2] == d[6] && d[5] == d[7]);
      }
      free(values), free(full);
      bw_release(g);
      bw_release(mesh);
    }
  for (int m = 0; m < 4; m++)
    bw_release(material[m]);
}

/* Positive semidefinite with exactly six zero eigenvalues, the rigid-body motions. */
static void six_zero_energy_motions(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[4];
  formulated_materials(context, 1, material);
  for (int kind = 0; kind < 3; kind++)
    for (int m = 0; m < 4; m++) {
      double x[10][3], k[900], value[30], rigid[6][30];
      int n = kind ? 30 : 12;
      tet10(kind == 2 ? 0.06 : 0, x);
      check_ok(context,
               bw_element_stiffness(context, kind ? 2 : 1, (const double(*)[3])x, material[m], k));
      double scale = largest(k, n * n);
      for (int a = 0; a < n / 3; a++)
        for (int i = 0; i < 3; i++) {
          double axis[3] = {i == 0, i == 1, i == 2}, turn[3];
          bw_cross(axis, x[a], turn);
          for (int c = 0; c < 3; c++) {
            rigid[i][3 * a + c] = axis[c];
            rigid[3 + i][3 * a + c] = turn[c];
          }
        }
      for (int r = 0; r < 6; r++)
        for (int i = 0; i < n; i++) {
          double force = 0;
          for (int j = 0; j < n; j++)
            force += k[i * n + j] * rigid[r][j];
          check_near(force, 0, 1e-14 * scale);
        }
      dense_eigenvalues(n, k, value);
      for (int i = 0; i < 6; i++)
        check_near(value[i], 0, 1e-13 * value[n - 1]);
      assert_true(value[6] > 1e-4 * value[n - 1]);
    }
  for (int m = 0; m < 4; m++)
    bw_release(material[m]);
}

/* Turning the model and its material axes together turns the matrix. */
static void orthotropic_rotation(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context), *turned = NULL;
  double a = 0.8, b = -0.5, r[9] = {cos(a),  sin(a) * cos(b), sin(a) * sin(b),
                                    -sin(a), cos(a) * cos(b), cos(a) * sin(b),
                                    0,       -sin(b),         cos(b)};
  check_ok(context, bw_material_rotated(context, material, r, &turned));
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL, *moved = NULL;
    bw_block_pattern *g = NULL;
    perturbed_box(context, 2, 1, 2, order, 0.3, 0.1, &mesh);
    int n = mesh->node_count;
    double *node = (double *)malloc(sizeof *node * 3 * (size_t)n);
    for (int i = 0; i < n; i++)
      for (int k = 0; k < 3; k++)
        node[3 * i + k] = bw_dot(r + 3 * k, mesh->node + 3 * i);
    check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
    check_ok(context, bw_block_pattern_create(context, mesh, &g));
    double *k0 = (double *)malloc(sizeof *k0 * 9 * (size_t)g->block_count);
    double *k1 = (double *)malloc(sizeof *k1 * 9 * (size_t)g->block_count);
    check_ok(context, bw_stiffness(context, g, mesh, material, k0));
    check_ok(context, bw_stiffness(context, g, moved, turned, k1));
    double scale = largest(k0, 9 * g->block_count);
    for (int64_t p = 0; p < g->block_count; p++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
          double sum = 0;
          for (int u = 0; u < 3; u++)
            for (int v = 0; v < 3; v++)
              sum += r[3 * i + u] * k0[9 * p + 3 * u + v] * r[3 * j + v];
          check_near(k1[9 * p + 3 * i + j], sum, 1e-14 * scale);
        }
    free(node), free(k0), free(k1);
    bw_release(g);
    bw_release(moved);
    bw_release(mesh);
  }
  bw_release(turned);
  bw_release(material);
}

static void same_bits_for_any_thread_count(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2e9, 0.3), odd_material(context)};
  const int threads[] = {1, 2, 3, 7};
  for (int kind = 0; kind < 3; kind++) {
    bw_mesh *mesh = NULL;
    bw_block_pattern *g = NULL;
    perturbed_box(context, 8, 6, 6, kind ? 2 : 1, 0.3, kind == 2 ? 0.1 : 0, &mesh);
    check_ok(context, bw_block_pattern_create(context, mesh, &g));
    size_t blocks = (size_t)g->block_count, n = 3 * (size_t)mesh->node_count;
    double *first = (double *)malloc(sizeof *first * (20 * blocks + n));
    double *now = (double *)malloc(sizeof *now * (20 * blocks + n));
    for (int t = 0; t < 4; t++) {
      double *out = t ? now : first;
      check_ok(context, bw_set_threads(context, threads[t]));
      check_ok(context, bw_stiffness(context, g, mesh, material[0], out));
      check_ok(context, bw_stiffness(context, g, mesh, material[1], out + 9 * blocks));
      check_ok(context, bw_mass(context, g, mesh, NULL, out + 18 * blocks));
      check_ok(context, bw_laplacian(context, g, mesh, out + 19 * blocks));
      check_ok(context,
               bw_block_multiply(context, g, first, 9, 3, 1, mesh->node, out + 20 * blocks));
      if (t)
        assert_memory_equal(first, now, sizeof *first * (20 * blocks + n));
    }
    free(first), free(now);
    bw_release(g);
    bw_release(mesh);
  }
  bw_release(material[0]);
  bw_release(material[1]);
}

static void inverted_elements_are_named(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = plain_material(context, 1, 0.3);
  bw_mesh *mesh = NULL;
  bw_block_pattern *g = NULL;
  double x[10][3], k[900];
  int32_t element[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  tet10(0, x);
  for (int i = 0; i < 3; i++) /* the middle of edge 01 beyond node 1 */
    x[4][i] = 2 * x[1][i] - x[0][i];
  check_fails(context, BW_GEOMETRY, "Jacobian",
              bw_element_stiffness(context, 2, (const double(*)[3])x, material, k));
  if (bw_mesh_copy(context, 2, 10, x[0], 1, element, NULL, &mesh) == BW_OK) {
    check_ok(context, bw_block_pattern_create(context, mesh, &g));
    double *values = (double *)malloc(sizeof *values * 9 * (size_t)g->block_count);
    check_fails(context, BW_GEOMETRY, "element 1",
                bw_stiffness(context, g, mesh, material, values));
    free(values);
  }
  bw_release(g);
  bw_release(mesh);
  bw_release(material);
}

static void patterns_of_other_meshes_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = plain_material(context, 1, 0.3);
  bw_mesh *small = NULL, *large = NULL;
  bw_block_pattern *g = NULL;
  perturbed_box(context, 1, 1, 1, 1, 0, 0, &small);
  perturbed_box(context, 2, 1, 1, 1, 0, 0, &large);
  check_ok(context, bw_block_pattern_create(context, large, &g));
  double *values = (double *)malloc(sizeof *values * 9 * (size_t)g->block_count);
  check_fails(context, BW_INVALID, "12 elements",
              bw_stiffness(context, g, small, material, values));
  check_fails(context, BW_INVALID, "12 elements", bw_mass(context, g, small, NULL, values));
  free(values);
  bw_release(g);
  bw_release(large);
  bw_release(small);
  bw_release(material);
}

static bw_status assemble_all(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              double *values) {
  bw_block_pattern *g = NULL;
  bw_status status;
  BW_TRY(bw_block_pattern_create(context, mesh, &g));
  BW_TRY(bw_stiffness(context, g, mesh, material, values));
  BW_TRY(bw_laplacian(context, g, mesh, values));
  BW_TRY(bw_mass(context, g, mesh, NULL, values));
  BW_TRY(bw_lumped_mass(context, mesh, NULL, values));
  BW_TRY(bw_block_multiply(context, g, values, 1, 1, 2, values, values + 4000));
done:
  bw_release(g);
  return status;
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  bw_mesh *mesh = NULL;
  perturbed_box(context, 1, 1, 1, 2, 0, 0.1, &mesh);
  double *values = (double *)calloc(8000, sizeof *values);
  check_each_allocation(context, status, 15) {
    status = assemble_all(context, mesh, material, values);
  }
  free(values);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(assembly_is_the_sum_of_elements), check_test(six_zero_energy_motions),
           check_test(orthotropic_rotation), check_test(same_bits_for_any_thread_count),
           check_test(inverted_elements_are_named),
           check_test(patterns_of_other_meshes_are_refused), check_test(out_of_memory))
