/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stress fields: patch test, fields of known stress, energies, principal stresses, threads. */
#include "assemble/dense.h"

static double *nodal_field(const bw_mesh *mesh, void (*f)(const double *x, double *u)) {
  double *u = (double *)malloc(sizeof *u * 3 * (size_t)mesh->node_count);
  for (int i = 0; i < mesh->node_count; i++)
    f(mesh->node + 3 * i, u + 3 * i);
  return u;
}

static void stress_of(const bw_material *m, const double grad[9], double stress[6]) {
  double strain[6] = {grad[0],           grad[4],           grad[8],
                      grad[5] + grad[7], grad[2] + grad[6], grad[1] + grad[3]};
  for (int i = 0; i < 6; i++) {
    stress[i] = 0;
    for (int j = 0; j < 6; j++)
      stress[i] += m->elasticity[6 * i + j] * strain[j];
  }
}

/* MacNeal and Harder's patch (see assemble/test_patch.c): the published stresses to 1e-10. */
static void macneal_harder_stresses(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = plain_material(context, 1e6, 0.25);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    patch_mesh(context, order, &mesh);
    int n = mesh->node_count;
    double *u = (double *)calloc(3 * (size_t)n, sizeof *u);
    bool *inner = (bool *)malloc(3 * (size_t)n);
    memset(inner, true, 3 * (size_t)n);
    for (int b = 0; b < mesh->boundary_node_count; b++) {
      int i = mesh->boundary_node[b];
      const double *x = mesh->node + 3 * i;
      for (int c = 0; c < 3; c++) {
        inner[3 * i + c] = false;
        u[3 * i + c] = 1e-3 * (x[0] + x[1] + x[2] + x[c]) / 2;
      }
    }
    dense_static(context, mesh, material, inner, NULL, u);
    double *stress = (double *)malloc(sizeof *stress * 6 * (size_t)mesh->element_count);
    double *nodal = (double *)malloc(sizeof *nodal * 6 * (size_t)n);
    check_ok(context, bw_element_stress(context, mesh, material, u, stress));
    check_ok(context, bw_nodal_stress(context, mesh, material, u, nodal));
    for (int i = 0; i < 6 * mesh->element_count; i++)
      check_near(stress[i], i % 6 < 3 ? 2000 : 400, 1e-10 * 2000);
    for (int i = 0; i < 6 * n; i++)
      check_near(nodal[i], i % 6 < 3 ? 2000 : 400, 1e-10 * 2000);
    free(u), free(inner), free(stress), free(nodal);
    bw_release(mesh);
  }
  bw_release(material);
}

static const double linear_gradient[9] = {0.3, -0.2, 0.7, 0.5, 0.1, 0, 0, -0.4, 0.6};

static void linear(const double *x, double *u) {
  for (int i = 0; i < 3; i++)
    u[i] = 0.1 * i + bw_dot(linear_gradient + 3 * i, x);
}

/* Constant strain on every kind of element, curved ones too: exact everywhere, and the energy is
 * that of the density times the volume. */
static void constant_stress(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2, 0.3), odd_material(context)};
  for (int kind = 0; kind < 3; kind++)
    for (int m = 0; m < 2; m++) {
      bw_mesh *mesh = NULL;
      perturbed_box(context, 2, 3, 2, kind ? 2 : 1, 0.3, kind == 2 ? 0.2 : 0, &mesh);
      double *u = nodal_field(mesh, linear), expected[6], scale = 0;
      double *out =
          (double *)malloc(sizeof *out * 6 * (size_t)(mesh->node_count + mesh->element_count));
      stress_of(material[m], linear_gradient, expected);
      for (int c = 0; c < 6; c++)
        scale = fmax(scale, fabs(expected[c]));
      check_ok(context, bw_element_stress(context, mesh, material[m], u, out));
      for (int i = 0; i < 6 * mesh->element_count; i++)
        check_near(out[i], expected[i % 6], 1e-13 * scale);
      check_ok(context, bw_nodal_stress(context, mesh, material[m], u, out));
      for (int i = 0; i < 6 * mesh->node_count; i++)
        check_near(out[i], expected[i % 6], 1e-13 * scale);
      free(u), free(out);
      bw_release(mesh);
    }
  bw_release(material[0]);
  bw_release(material[1]);
}

static void quadratic(const double *x, double *u) {
  u[0] = x[0] * x[0] + x[1] * x[2];
  u[1] = x[0] * x[1] - 2 * x[2] * x[2];
  u[2] = 0.5 * x[1] * x[1] - x[0] * x[2];
}

static void quadratic_gradient(const double *x, double g[9]) {
  double h[9] = {2 * x[0], x[2], x[1], x[1], x[0], -4 * x[2], -x[2], x[1], -x[0]};
  memcpy(g, h, sizeof h);
}

/* Straight tet10 have quadratic fields exactly: the mean stress is that of the centroid, and the
 * stress at every node is its own. */
static void linear_stress(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  bw_mesh *mesh = NULL;
  perturbed_box(context, 2, 2, 2, 2, 0.3, 0, &mesh);
  double *u = nodal_field(mesh, quadratic), grad[9], expected[6];
  double *out =
      (double *)malloc(sizeof *out * 6 * (size_t)(mesh->node_count + mesh->element_count));
  check_ok(context, bw_element_stress(context, mesh, material, u, out));
  for (int e = 0; e < mesh->element_count; e++) {
    double centre[3] = {0};
    for (int a = 0; a < 4; a++)
      for (int k = 0; k < 3; k++)
        centre[k] += 0.25 * mesh->node[3 * mesh->element[10 * e + a] + k];
    quadratic_gradient(centre, grad);
    stress_of(material, grad, expected);
    for (int c = 0; c < 6; c++)
      check_near(out[6 * e + c], expected[c], 1e-13 * 5e9);
  }
  check_ok(context, bw_nodal_stress(context, mesh, material, u, out));
  for (int i = 0; i < mesh->node_count; i++) {
    quadratic_gradient(mesh->node + 3 * i, grad);
    stress_of(material, grad, expected);
    for (int c = 0; c < 6; c++)
      check_near(out[6 * i + c], expected[c], 1e-13 * 5e9);
  }
  free(u), free(out);
  bw_release(mesh);
  bw_release(material);
}

static void rough(const double *x, double *u) {
  u[0] = sin(7 * x[0] + x[1]);
  u[1] = cos(5 * x[1] * x[2]);
  u[2] = sin(3 * x[2] + 2 * x[0]);
}

/* Energies of the elements sum to u.K.u / 2, with any displacement. */
static void energies_sum_to_that_of_the_stiffness(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2, 0.3), odd_material(context)};
  for (int kind = 0; kind < 3; kind++)
    for (int m = 0; m < 2; m++) {
      bw_mesh *mesh = NULL;
      bw_block_pattern *g = NULL;
      perturbed_box(context, 3, 3, 2, kind ? 2 : 1, 0.3, kind == 2 ? 0.2 : 0, &mesh);
      check_ok(context, bw_block_pattern_create(context, mesh, &g));
      double *u = nodal_field(mesh, rough);
      double *k = (double *)malloc(sizeof *k * 9 * (size_t)g->block_count);
      double *f = (double *)malloc(sizeof *f * 3 * (size_t)mesh->node_count);
      double *energy = (double *)malloc(sizeof *energy * (size_t)mesh->element_count);
      double whole = 0, sum = 0;
      check_ok(context, bw_stiffness(context, g, mesh, material[m], k));
      check_ok(context, bw_block_multiply(context, g, k, 9, 3, 1, u, f));
      check_ok(context, bw_element_energy(context, mesh, material[m], u, energy));
      for (int i = 0; i < 3 * mesh->node_count; i++)
        whole += 0.5 * u[i] * f[i];
      for (int e = 0; e < mesh->element_count; e++) {
        assert_true(energy[e] >= 0);
        sum += energy[e];
      }
      check_near(sum, whole, 1e-13 * whole);
      free(u), free(k), free(f), free(energy);
      bw_release(g);
      bw_release(mesh);
    }
  bw_release(material[0]);
  bw_release(material[1]);
}

/* The paper's observation: under given forces the stress of an isotropic body does not depend on
 * Young's modulus (it does depend on Poisson's ratio). */
static void stress_does_not_depend_on_youngs_modulus(void **state) {
  bw_context *context = check_context(state);
  const double young[3] = {1e6, 7e10, 1e6}, poisson[3] = {0.3, 0.3, 0.1};
  bw_mesh *mesh = NULL;
  perturbed_box(context, 4, 1, 1, 2, 0, 0, &mesh);
  int n = mesh->node_count;
  double peak[3] = {0}, *f = (double *)calloc(3 * (size_t)n, sizeof *f);
  double *u = (double *)malloc(sizeof *u * 3 * (size_t)n);
  double *stress = (double *)malloc(sizeof *stress * 6 * (size_t)mesh->element_count);
  double *value = (double *)malloc(sizeof *value * (size_t)mesh->element_count);
  bool *is_free = (bool *)malloc(3 * (size_t)n);
  for (int i = 0; i < n; i++)
    for (int c = 0; c < 3; c++) {
      is_free[3 * i + c] = mesh->node[3 * i] > 1e-9;
      f[3 * i + c] = mesh->node[3 * i] > 1.2 - 1e-9 ? 1 + c : 0;
    }
  for (int m = 0; m < 3; m++) {
    bw_material *material = plain_material(context, young[m], poisson[m]);
    memset(u, 0, sizeof *u * 3 * (size_t)n);
    dense_static(context, mesh, material, is_free, f, u);
    check_ok(context, bw_element_stress(context, mesh, material, u, stress));
    check_ok(context, bw_max_principal_field(context, mesh->element_count, stress, value));
    for (int e = 0; e < mesh->element_count; e++)
      peak[m] = fmax(peak[m], value[e]);
    bw_release(material);
  }
  check_near(peak[1], peak[0], 1e-10 * peak[0]);
  assert_true(fabs(peak[2] - peak[0]) > 1e-3 * peak[0]);
  free(f), free(u), free(stress), free(value), free(is_free);
  bw_release(mesh);
}

static void principal_stresses(void **state) {
  bw_context *context = check_context(state);
  enum { COUNT = 2000 };
  double *t = (double *)calloc(6 * COUNT, sizeof *t);
  double *value = (double *)malloc(sizeof *value * 3 * COUNT);
  double *with = (double *)malloc(sizeof *with * 3 * COUNT);
  double *direction = (double *)malloc(sizeof *direction * 9 * COUNT);
  double *max = (double *)malloc(sizeof *max * COUNT);
  bw_random random;
  bw_random_seed(&random, 11);
  for (int i = 0; i < COUNT; i++)
    for (int c = 0; c < 6; c++)
      t[6 * i + c] = (bw_random_uniform(&random) - 0.5) * pow(10, i % 9);
  memset(t, 0, sizeof *t * 6 * 8);
  t[6] = 5;                          /* tension: two equal eigenvalues, r = 1 */
  t[12] = -5;                        /* compression: r = -1 */
  t[18] = t[19] = t[20] = 3;         /* hydrostatic */
  t[24 + 5] = 2;                     /* pure shear */
  t[30] = 1, t[31] = 1 + 1e-9;       /* nearly equal */
  t[36] = 1e-200, t[37] = -2e-200;   /* tiny */
  t[42] = 1e200, t[42 + 3] = -2e200; /* huge */
  check_ok(context, bw_principal_field(context, COUNT, t, value, NULL));
  check_ok(context, bw_principal_field(context, COUNT, t, with, direction));
  check_ok(context, bw_max_principal_field(context, COUNT, t, max));
  for (int i = 0; i < COUNT; i++) {
    const double *v = value + 3 * i, *w = with + 3 * i;
    double size = fmax(fabs(w[0]), fabs(w[2]));
    assert_true(v[0] >= v[1] && v[1] >= v[2]);
    for (int k = 0; k < 3; k++)
      check_near(v[k], w[k], 2e-11 * size);
    check_near(max[i], size, 2e-11 * size);
    for (int k = 0; k < 3; k++) { /* t d = w d */
      const double *d = direction + 9 * i + 3 * k, *s = t + 6 * i;
      check_near(s[0] * d[0] + s[5] * d[1] + s[4] * d[2], w[k] * d[0], 1e-13 * size);
      check_near(s[5] * d[0] + s[1] * d[1] + s[3] * d[2], w[k] * d[1], 1e-13 * size);
    }
  }
  check_near(value[3], 5, 0);
  check_near(value[4], 0, 0);
  check_near(max[2], 5, 0);
  check_near(value[12], 2, 1e-14);
  check_near(value[14], -2, 1e-14);
  free(t), free(value), free(with), free(direction), free(max);
}

static void von_mises_and_utilisation(void **state) {
  bw_context *context = check_context(state);
  double t[18] = {7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 4, 4, 4, 0, 0, 0}, value[3];
  check_ok(context, bw_von_mises_field(context, 3, t, value));
  check_near(value[0], 7, 1e-14);                            /* tension */
  check_near(value[1], 2 * sqrt(3), 1e-14);                  /* shear */
  check_near(value[2], 0, 1e-14);                            /* hydrostatic */
  bw_material *material = plain_material(context, 1e9, 0.3); /* strength 1e6 */
  check_ok(context, bw_utilisation_field(context, material, 3, t, value));
  check_near(value[0], 7e-6, 1e-20);
  check_near(value[1], 2e-6, 1e-20);
  check_near(value[2], 4e-6, 1e-20);
  bw_release(material);
  const char *const names[] = {"zp150", "nylon_pa2200"}; /* equal strengths, and not */
  bw_random random;
  bw_random_seed(&random, 5);
  for (int m = 0; m < 2; m++) {
    check_ok(context, bw_material_named(context, names[m], &material));
    for (int repeat = 0; repeat < 50; repeat++) {
      for (int c = 0; c < 18; c++)
        t[c] = 1e6 * (bw_random_uniform(&random) - 0.5);
      check_ok(context, bw_utilisation_field(context, material, 3, t, value));
      for (int i = 0; i < 3; i++)
        check_near(value[i], bw_material_utilisation(material, t + 6 * i), 1e-11 * value[i]);
    }
    bw_release(material);
  }
  check_fails(context, BW_INVALID, "material", bw_utilisation_field(context, NULL, 3, t, value));
}

static void same_bits_for_any_thread_count(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  bw_mesh *mesh = NULL;
  perturbed_box(context, 8, 7, 6, 2, 0.3, 0.1, &mesh);
  size_t n = (size_t)mesh->node_count, e = (size_t)mesh->element_count, all = 9 * e + 6 * n + 1;
  double *u = nodal_field(mesh, rough);
  double *first = (double *)malloc(sizeof *first * all);
  double *now = (double *)malloc(sizeof *now * all);
  const int threads[] = {1, 2, 3, 7};
  for (int t = 0; t < 4; t++) {
    double *out = t ? now : first, *next = out;
    check_ok(context, bw_set_threads(context, threads[t]));
    check_ok(context, bw_element_stress(context, mesh, material, u, next));
    check_ok(context, bw_max_principal_field(context, (int64_t)e, next, next + 6 * e));
    check_ok(context, bw_element_energy(context, mesh, material, u, next += 7 * e));
    check_ok(context, bw_nodal_stress(context, mesh, material, u, next += e));
    next += 6 * n;
    check_ok(context, bw_error_estimate(context, mesh, material, u, next, next + e));
    if (t)
      assert_memory_equal(first, now, sizeof *first * all);
  }
  free(u), free(first), free(now);
  bw_release(mesh);
  bw_release(material);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  bw_mesh *mesh = NULL;
  perturbed_box(context, 1, 1, 1, 2, 0, 0.1, &mesh);
  double *u = nodal_field(mesh, rough), out[6 * 100], relative = -1;
  for (int with = 0; with < 2; with++)
    check_each_allocation(context, status, 8) {
      status = bw_nodal_stress(context, mesh, material, u, out);
      if (status == BW_OK)
        status = bw_error_estimate(context, mesh, material, u, with ? out : NULL, &relative);
    }
  assert_true(relative > 0);
  free(u);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(macneal_harder_stresses), check_test(constant_stress),
           check_test(linear_stress), check_test(energies_sum_to_that_of_the_stiffness),
           check_test(stress_does_not_depend_on_youngs_modulus), check_test(principal_stresses),
           check_test(von_mises_and_utilisation), check_test(same_bits_for_any_thread_count),
           check_test(out_of_memory))
