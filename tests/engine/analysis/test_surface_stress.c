/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stress of surfaces without traction: of linear displacements whose stress is known, on straight
 * and curved facets, for materials with directions; wrong input. */
#include "bodies.h"

#include <math.h>

/* Off all axes and without symmetry but that of an elasticity: from three directions. */
static bw_material *make_material(bw_context *context, bool isotropic) {
  bw_material *material = NULL;
  if (isotropic) {
    const bw_isotropic constants = {.name = "test", .young = 2, .poisson = 0.3, .density = 1};
    check_ok(context, bw_material_isotropic(context, &constants, &material));
  } else {
    const bw_orthotropic constants = {.name = "layers",
                                      .young = {3, 2, 0.7},
                                      .poisson = {0.2, 0.3, 0.25},
                                      .shear = {0.4, 0.5, 0.9},
                                      .density = 1};
    check_ok(context, bw_material_orthotropic(context, &constants, &material));
  }
  return material;
}

static double *linear_displacement(const bw_mesh *mesh, const double gradient[9]) {
  double *u = (double *)malloc(3 * (size_t)mesh->node_count * sizeof *u);
  for (size_t i = 0; i < (size_t)mesh->node_count; i++)
    for (size_t c = 0; c < 3; c++)
      u[3 * i + c] = 0.1 + bw_dot(gradient + 3 * c, mesh->node + 3 * i);
  return u;
}

static double *stress_of(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         const double *u) {
  double *stress = (double *)malloc(18 * (size_t)mesh->facet_count * sizeof *stress);
  check_ok(context, bw_surface_stress(context, mesh, material, u, NULL, stress));
  return stress;
}

/* Along x: the sides have the stress of the bar, the ends what is left without traction. */
static void test_bar_in_tension(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 0.2, 0.3, 5, 2, 2, order);
    bw_material *material = make_material(context, true);
    const double gradient[9] = {0.5, 0.01, 0, -0.01, -0.15, 0, 0, 0, -0.15};
    double *u = linear_displacement(mesh, gradient), *s = stress_of(context, mesh, material, u);
    for (int32_t k = 0; k < 3 * mesh->facet_count; k++) {
      const int32_t *node = mesh->facet + (size_t)(k / 3) * (size_t)mesh->nodes_per_facet;
      double x[3];
      for (int a = 0; a < 3; a++)
        x[a] = mesh->node[3 * (size_t)node[a]];
      bool end = fabs(x[0] - x[1]) + fabs(x[0] - x[2]) < 1e-12;
      const double *stress = s + 6 * (size_t)k;
      /* At an end both other strains are -0.15: E / (1 - nu) times that. */
      const double expected[6] = {end ? 0 : 1, end ? -0.3 / 0.7 : 0, end ? -0.3 / 0.7 : 0, 0, 0, 0};
      for (int c = 0; c < 6; c++)
        check_near(stress[c], expected[c], 1e-12);
    }
    free(u), free(s);
    bw_release(mesh);
    bw_release(material);
  }
}

/* The stress leaves no traction, and displacement gradients a n^T that are added do not change it.
 * On curved facets the normal is the facet's own at its corners. */
static void test_no_traction(void **state) {
  bw_context *context = check_context(state);
  for (int curved = 0; curved < 2; curved++) {
    bw_mesh *mesh = make_box(context, 1, 1, 1, 2, 2, 2, 2);
    bw_material *material = make_material(context, false);
    if (curved) {
      double *x = (double *)malloc(3 * (size_t)mesh->node_count * sizeof *x);
      for (size_t i = 0; i < 3 * (size_t)mesh->node_count; i++)
        x[i] = mesh->node[i] + 0.03 * sin(9 * mesh->node[i - i % 3 + (i + 1) % 3]);
      bw_mesh *straight = mesh;
      check_ok(context, bw_mesh_moved(context, straight, x, &mesh));
      bw_release(straight);
      free(x);
    }
    const double gradient[9] = {0.5, 0.2, -0.1, 0.3, -0.4, 0.25, 0.15, -0.2, 0.35};
    double *u = linear_displacement(mesh, gradient), *s = stress_of(context, mesh, material, u);
    for (int32_t k = 0; k < 3 * mesh->facet_count; k++) {
      const double *stress = s + 6 * (size_t)k;
      double l[3] = {0}, by[6][3], a[3] = {0}, b[3] = {0}, n[3];
      const int32_t *node = mesh->facet + (size_t)(k / 3) * 6;
      l[k % 3] = 1;
      bw_triangle_shape_gradient(2, l, by);
      for (int i = 0; i < 6; i++)
        for (int c = 0; c < 3; c++) {
          a[c] += (by[i][1] - by[i][0]) * mesh->node[3 * (size_t)node[i] + (size_t)c];
          b[c] += (by[i][2] - by[i][0]) * mesh->node[3 * (size_t)node[i] + (size_t)c];
        }
      bw_cross(a, b, n);
      const double rows[3][3] = {{stress[0], stress[5], stress[4]},
                                 {stress[5], stress[1], stress[3]},
                                 {stress[4], stress[3], stress[2]}};
      double size = 0;
      for (int c = 0; c < 6; c++)
        size = fmax(size, fabs(stress[c]));
      assert_true(size > 0.01);
      for (int c = 0; c < 3; c++)
        assert_true(fabs(bw_dot(rows[c], n)) < 1e-12 * size * bw_norm(n));
      /* Its strain differs from the given one by what the surface does not see: D = C^-1 sigma -
       * strain is a n^T + n a^T, so t . D t = 0 along the surface. */
      double strain[6];
      const double *flexible = bw_material_compliance(material, 0);
      for (int r = 0; r < 6; r++) {
        strain[r] = 0;
        for (int c = 0; c < 6; c++)
          strain[r] += flexible[6 * r + c] * stress[c];
      }
      const double given[6] = {gradient[0],
                               gradient[4],
                               gradient[8],
                               gradient[5] + gradient[7],
                               gradient[6] + gradient[2],
                               gradient[1] + gradient[3]};
      double d[3][3];
      for (int r = 0; r < 3; r++)
        d[r][r] = strain[r] - given[r];
      d[1][2] = d[2][1] = (strain[3] - given[3]) / 2;
      d[2][0] = d[0][2] = (strain[4] - given[4]) / 2;
      d[0][1] = d[1][0] = (strain[5] - given[5]) / 2;
      const double *pair[3][2] = {{a, a}, {a, b}, {b, b}};
      for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int r = 0; r < 3; r++)
          sum += pair[i][0][r] * bw_dot(d[r], pair[i][1]);
        assert_true(fabs(sum) < 1e-12);
      }
    }
    free(u), free(s);
    bw_release(mesh);
    bw_release(material);
  }
}

/* Uniform pressure on a cube: hydrostatic, but at facets whose nodes lie on its edges, where the
 * forces of two faces meet. */
static void test_hydrostatic_pressure(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 1, 1, 4, 4, 4, order);
    bw_material *material = make_material(context, true);
    bw_pressure_basis *basis = NULL;
    check_ok(context, bw_pressure_basis_create(context, mesh, NULL, &basis));
    double *p = (double *)malloc((size_t)basis->count * sizeof *p),
           *force = (double *)malloc(3 * (size_t)mesh->node_count * sizeof *force),
           *s = (double *)malloc(18 * (size_t)mesh->facet_count * sizeof *s);
    for (int32_t j = 0; j < basis->count; j++)
      p[j] = 3;
    bw_pressure_force(basis, p, force);
    const double strain = -3 * (1 - 2 * 0.3) / 2;
    const double gradient[9] = {strain, 0, 0, 0, strain, 0, 0, 0, strain};
    double *u = linear_displacement(mesh, gradient);
    check_ok(context, bw_surface_stress(context, mesh, material, u, force, s));
    int inner = 0;
    for (int32_t f = 0; f < mesh->facet_count; f++) {
      const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
      bool edge = false;
      for (int a = 0; a < mesh->nodes_per_facet; a++) {
        int sides = 0;
        for (int c = 0; c < 3; c++) {
          double x = mesh->node[3 * (size_t)node[a] + (size_t)c];
          sides += x < 1e-9 || x > 1 - 1e-9;
        }
        edge = edge || sides > 1;
      }
      inner += !edge;
      for (int k = 0; k < 18 && !edge; k++)
        check_near(s[18 * (size_t)f + (size_t)k], k % 6 < 3 ? -3 : 0, 1e-12);
    }
    assert_true(inner > 40);
    free(p), free(force), free(s), free(u);
    bw_release(basis);
    bw_release(mesh);
    bw_release(material);
  }
}

static void test_wrong_input(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 1, 1, 1, 1);
  bw_material *material = make_material(context, true);
  double stress[18 * 12];
  check_fails(context, BW_INVALID, "displacement",
              bw_surface_stress(context, mesh, material, NULL, NULL, stress));
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(test_bar_in_tension), check_test(test_no_traction),
           check_test(test_hydrostatic_pressure), check_test(test_wrong_input))
