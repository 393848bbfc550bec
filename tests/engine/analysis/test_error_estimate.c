/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The Zienkiewicz-Zhu estimate against the true error of a problem with a known solution.
 *
 * u = grad phi of a harmonic phi = exp(sqrt 2 x) sin y sin z has no divergence and no Laplacian: it
 * is in equilibrium without body force in any isotropic material. Its boundary values on a box
 * drive the inner nodes. */
#include "assemble/dense.h"

static void exact(const double *p, double u[3], double grad[9]) {
  double s = 1.5, w = sqrt(2), e = exp(w * s * p[0]);
  double a = sin(s * p[1]), ca = cos(s * p[1]), b = sin(s * p[2]), cb = cos(s * p[2]);
  double v[3] = {w * e * a * b, e * ca * b, e * a * cb};
  double g[9] = {2 * e * a * b, w * e * ca * b, w * e * a * cb, w * e * ca * b, -e * a * b,
                 e * ca * cb,   w * e * a * cb, e * ca * cb,    -e * a * b};
  for (int i = 0; i < 3; i++)
    u[i] = v[i];
  for (int i = 0; i < 9; i++)
    grad[i] = s * g[i];
}

/* The relative error in energy, true and estimated. */
static void solve(bw_context *context, int order, int cells, double shake, double *truth,
                  double *estimate) {
  bw_material *material = plain_material(context, 1, 0.3);
  bw_mesh *mesh = NULL;
  perturbed_box(context, cells, cells, cells, order, shake, 0, &mesh);
  int n = mesh->node_count, per = mesh->nodes_per_element;
  double *u = (double *)calloc(3 * (size_t)n, sizeof *u), grad[9];
  double *element = (double *)malloc(sizeof *element * (size_t)mesh->element_count);
  bool *inner = (bool *)malloc(3 * (size_t)n);
  memset(inner, true, 3 * (size_t)n);
  double scale = 1.0 / (0.3 * cells); /* the same box whatever the number of cells */
  double *node = (double *)malloc(sizeof *node * 3 * (size_t)n);
  for (int i = 0; i < 3 * n; i++)
    node[i] = scale * mesh->node[i];
  bw_mesh *unit = NULL;
  check_ok(context, bw_mesh_moved(context, mesh, node, &unit));
  for (int b = 0; b < unit->boundary_node_count; b++) {
    int i = unit->boundary_node[b];
    exact(unit->node + 3 * i, u + 3 * i, grad);
    inner[3 * i] = inner[3 * i + 1] = inner[3 * i + 2] = false;
  }
  dense_static(context, unit, material, inner, NULL, u);
  check_ok(context, bw_error_estimate(context, unit, material, u, element, estimate));

  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], error = 0, energy = 0;
  int points = bw_tet_quadrature(6, point, weight);
  for (int e = 0; e < unit->element_count; e++) {
    const int32_t *nodes = unit->element + per * e;
    double x[10][3], gradient[10][3], value[10];
    assert_true(element[e] >= 0);
    for (int a = 0; a < per; a++)
      memcpy(x[a], unit->node + 3 * nodes[a], sizeof x[a]);
    for (int q = 0; q < points; q++) {
      double at[3] = {0}, here[9] = {0}, v, ignored[3];
      v = weight[q] * bw_tet_gradient(order, (const double(*)[3])x, point[q], gradient);
      bw_tet_shape(order, point[q], value);
      for (int a = 0; a < per; a++)
        for (int i = 0; i < 3; i++) {
          at[i] += value[a] * x[a][i];
          for (int j = 0; j < 3; j++)
            here[3 * i + j] += u[3 * nodes[a] + i] * gradient[a][j];
        }
      exact(at, ignored, grad);
      for (int pass = 0; pass < 2; pass++) {
        double h[9], *sum = pass ? &energy : &error;
        for (int i = 0; i < 9; i++)
          h[i] = pass ? here[i] : grad[i] - here[i];
        double strain[6] = {h[0], h[4], h[8], h[5] + h[7], h[2] + h[6], h[1] + h[3]};
        for (int i = 0; i < 6; i++)
          for (int j = 0; j < 6; j++)
            *sum += v * strain[i] * material->elasticity[6 * i + j] * strain[j];
      }
    }
  }
  *truth = sqrt(error / energy);
  free(u), free(element), free(inner), free(node);
  bw_release(unit);
  bw_release(mesh);
  bw_release(material);
}

/* Effectivity, estimate over truth: near one; the error falls with the element's order. */
static void effectivity_on_a_smooth_solution(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int perturbed = 0; perturbed < 2; perturbed++) {
      double truth[2], estimate[2];
      for (int level = 0; level < 2; level++) {
        int cells = (order == 1 ? 3 : 2) << level;
        if (order == 2 && level == 1)
          cells = 3;
        solve(context, order, cells, perturbed ? 0.3 : 0, &truth[level], &estimate[level]);
        check_near(estimate[level] / truth[level], 1, 0.12);
      }
      double ratio = order == 1 ? 2 : 1.5;
      double rate = log(truth[0] / truth[1]) / log(ratio);
      check_near(rate, order, 0.25);
    }
}

static void stretch(const double *x, double *u) {
  for (int i = 0; i < 3; i++)
    u[i] = (i + 1) * x[i] + 0.3 * x[(i + 1) % 3];
}

static void no_error_in_constant_stress(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  for (int kind = 0; kind < 3; kind++) {
    bw_mesh *mesh = NULL;
    perturbed_box(context, 2, 2, 2, kind ? 2 : 1, 0.3, kind == 2 ? 0.1 : 0, &mesh);
    double *u = (double *)malloc(sizeof *u * 3 * (size_t)mesh->node_count), relative = 1;
    for (int i = 0; i < mesh->node_count; i++)
      stretch(mesh->node + 3 * i, u + 3 * i);
    check_ok(context, bw_error_estimate(context, mesh, material, u, NULL, &relative));
    check_near(relative, 0, 1e-13);
    memset(u, 0, sizeof *u * 3 * (size_t)mesh->node_count);
    check_ok(context, bw_error_estimate(context, mesh, material, u, NULL, &relative));
    check_near(relative, 0, 0);
    check_fails(context, BW_INVALID, "material",
                bw_error_estimate(context, mesh, NULL, u, NULL, &relative));
    free(u);
    bw_release(mesh);
  }
  bw_release(material);
}

check_main(check_test(effectivity_on_a_smooth_solution), check_test(no_error_in_constant_stress))
