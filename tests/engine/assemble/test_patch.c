/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Patch tests: constant strain is reproduced on any mesh of any of the elements. */
#include "assemble/dense.h"

/* K u of a linear displacement has no force at inner nodes, and boundary forces in balance. */
static void linear_displacement_needs_no_inner_force(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[4];
  formulated_materials(context, 2, material);
  for (int kind = 0; kind < 3; kind++)
    for (int m = 0; m < 4; m++) {
      bw_mesh *mesh = NULL;
      bw_block_pattern *g = NULL;
      perturbed_box(context, 4, 3, 3, kind ? 2 : 1, 0.4, kind == 2 ? 0.2 : 0, &mesh);
      check_ok(context, bw_block_pattern_create(context, mesh, &g));
      int n = mesh->node_count;
      double *k = (double *)malloc(sizeof *k * 9 * (size_t)g->block_count), scale = 0;
      double *u = (double *)malloc(sizeof *u * 3 * (size_t)n);
      double *f = (double *)malloc(sizeof *f * 3 * (size_t)n);
      for (int i = 0; i < n; i++) {
        const double *x = mesh->node + 3 * i;
        u[3 * i] = 0.1 + 0.3 * x[0] - 0.2 * x[1] + 0.7 * x[2];
        u[3 * i + 1] = 0.5 * x[0] + 0.1 * x[1];
        u[3 * i + 2] = -0.2 - 0.4 * x[1] + 0.6 * x[2];
      }
      check_ok(context, bw_stiffness(context, g, mesh, material[m], k));
      check_ok(context, bw_block_multiply(context, g, k, 9, 3, 1, u, f));
      for (int64_t p = 0; p < 9 * g->block_count; p++)
        scale = fmax(scale, fabs(k[p]));
      uint8_t *outside = (uint8_t *)calloc((size_t)n, 1);
      for (int b = 0; b < mesh->boundary_node_count; b++)
        outside[mesh->boundary_node[b]] = 1;
      int inner = 0;
      for (int i = 0; i < n; i++)
        for (int c = 0; c < 3 && !outside[i]; c++, inner++)
          check_near(f[3 * i + c], 0, 1e-14 * scale);
      assert_true(inner > 30);
      for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int i = 0; i < n; i++)
          sum += f[3 * i + c];
        check_near(sum, 0, 1e-13 * scale);
      }
      free(k), free(u), free(f), free(outside);
      bw_release(g);
      bw_release(mesh);
    }
  for (int m = 0; m < 4; m++)
    bw_release(material[m]);
}

/* MacNeal and Harder (1985): the boundary of the unit cube is displaced linearly; the inner nodes
 * find their places and every stress is 2000 (normal) and 400 (shear). */
static void macneal_harder(void **state) {
  bw_context *context = check_context(state);
  bw_material *plain = plain_material(context, 1e6, 0.25), *projected = NULL;
  bw_material *squashed = plain_material(context, 1e6, 0.49);
  check_ok(context, bw_material_formulated(context, squashed, BW_B_BAR, &projected));
  for (int kind = 0; kind < 3; kind++) { /* tet4, tet10, tet10 with B-bar */
    bw_material *material = kind == 2 ? projected : plain;
    int order = kind ? 2 : 1;
    bw_mesh *mesh = NULL;
    patch_mesh(context, order, &mesh);
    int n = mesh->node_count;
    double *u = (double *)calloc(3 * (size_t)n, sizeof *u);
    bool *inner = (bool *)malloc(3 * (size_t)n);
    memset(inner, true, 3 * (size_t)n);
    for (int i = 0; i < n; i++)
      for (int c = 0; c < 3; c++) {
        const double *x = mesh->node + 3 * i;
        u[3 * i + c] = 1e-3 * (x[0] + x[1] + x[2] + x[c]) / 2;
      }
    double *exact = (double *)malloc(sizeof *exact * 3 * (size_t)n);
    memcpy(exact, u, sizeof *exact * 3 * (size_t)n);
    for (int b = 0; b < mesh->boundary_node_count; b++)
      for (int c = 0; c < 3; c++)
        inner[3 * mesh->boundary_node[b] + c] = false;
    int free_count = 0;
    for (int i = 0; i < 3 * n; i++)
      if (inner[i]) {
        u[i] = 0;
        free_count++;
      }
    assert_true(free_count >= 24);
    dense_static(context, mesh, material, inner, NULL, u);
    for (int i = 0; i < 3 * n; i++)
      check_near(u[i], exact[i], 1e-15);
    free(u), free(inner), free(exact);
    bw_release(mesh);
  }
  bw_release(plain);
  bw_release(squashed);
  bw_release(projected);
}

check_main(check_test(linear_displacement_needs_no_inner_force), check_test(macneal_harder))
