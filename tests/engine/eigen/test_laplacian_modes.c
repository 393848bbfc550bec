/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Laplacian modes with a free boundary: of a box, pi^2 (i^2/a^2 + j^2/b^2 + k^2/c^2), with the
 * order of convergence that the element has; of two boxes, both spectra. */
#include "bodies.h"

static void box_converges(void **state) {
  bw_context *context = check_context(state);
  const double a = 1, b = 0.8, c = 0.55;
  /* the lowest four, no two alike */
  const double exact[4] = {M_PI * M_PI, M_PI * M_PI / (b * b), M_PI * M_PI * (1 + 1 / (b * b)),
                           M_PI * M_PI / (c * c)};
  for (int order = 1; order <= 2; order++) {
    double error[2][4];
    for (int fine = 0; fine < 2; fine++) {
      int n = (order == 1 ? 7 : 3) << fine;
      bw_mesh *mesh = body_box(context, a, b, c, n, n, n, order);
      bw_block_pattern *pattern = NULL;
      bw_modes *modes = NULL;
      bw_modes_options options;
      bw_modes_options_default(&options);
      options.count = 4;
      check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
      check_ok(context, bw_modes_laplacian(context, mesh, pattern, &options, &modes));
      assert_int_equal(modes->components, 1);
      assert_int_equal(modes->rigid_count, 1);
      assert_null(modes->frequency);
      assert_true(modes->counted);
      for (int k = 0; k < 4; k++) {
        error[fine][k] = modes->eigenvalue[k] / exact[k] - 1;
        assert_true(error[fine][k] > 0); /* Rayleigh's principle */
        assert_true(modes->residual[k] < 1e-8);
      }
      bw_release(modes);
      bw_release(pattern);
      bw_release(mesh);
    }
    for (int k = 0; k < 4; k++) {
      double rate = log2(error[0][k] / error[1][k]);
      assert_true(rate > 2 * order - 0.4);
    }
    assert_true(error[1][0] < 0.02);
  }
}

void openblas_set_num_threads(int);
int openblas_get_num_threads(void);

/* OpenBLAS's threads are a setting of the whole process: it is as it was behind a call, and what a
 * call gives does not depend on it. */
static void threads_of_others(void **state) {
  bw_context *context = check_context(state);
  double value[2][4];
  int before = openblas_get_num_threads();
  bw_mesh *mesh = body_box(context, 1, 0.8, 0.55, 9, 8, 6, 1);
  for (int k = 0; k < 2; k++) {
    bw_block_pattern *pattern = NULL;
    bw_modes *modes = NULL;
    bw_modes_options options;
    bw_modes_options_default(&options);
    options.count = 4;
    openblas_set_num_threads(1 + 2 * k);
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    check_ok(context, bw_modes_laplacian(context, mesh, pattern, &options, &modes));
    assert_int_equal(openblas_get_num_threads(), 1 + 2 * k);
    memcpy(value[k], modes->eigenvalue, sizeof value[k]);
    bw_release(modes);
    bw_release(pattern);
  }
  assert_memory_equal(value[0], value[1], sizeof value[0]);
  bw_release(mesh);
  openblas_set_num_threads(before);
}

static void two_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = body_box(context, 1, 0.8, 0.55, 3, 3, 3, 1), *mesh = NULL;
  int32_t n = one->node_count, m = 4 * one->element_count;
  double *x = numbers(6 * (int64_t)n);
  int32_t *element = calloc((size_t)(2 * m), sizeof *element);
  for (int32_t i = 0; i < 3 * n; i++) {
    x[i] = one->node[i];
    x[3 * n + i] = one->node[i] + 5;
  }
  for (int32_t i = 0; i < m; i++) {
    element[i] = one->element[i];
    element[m + i] = one->element[i] + n;
  }
  check_ok(context,
           bw_mesh_copy(context, 1, 2 * n, x, 2 * one->element_count, element, NULL, &mesh));
  bw_block_pattern *pattern[2] = {NULL};
  bw_modes *modes[2] = {NULL};
  bw_modes_options options;
  bw_modes_options_default(&options);
  const bw_mesh *meshes[2] = {one, mesh};
  for (int k = 0; k < 2; k++)
    check_ok(context, bw_block_pattern_create(context, meshes[k], &pattern[k]));
  const bw_eigensolver_kind kinds[] = {BW_EIGENSOLVER_LANCZOS, BW_EIGENSOLVER_ARPACK,
                                       BW_EIGENSOLVER_LOBPCG};
  for (size_t which = 0; which < sizeof kinds / sizeof *kinds; which++) {
    bw_eigensolver *solver = NULL;
    bw_eigensolver_options how;
    bw_eigensolver_options_default(&how);
    how.kind = kinds[which];
    check_ok(context, bw_eigensolver_create(context, &how, &solver));
    options.solver = solver;
    for (int k = 0; k < 2; k++) {
      options.count = k ? 8 : 4;
      check_ok(context, bw_modes_laplacian(context, meshes[k], pattern[k], &options, &modes[k]));
      assert_string_equal(modes[k]->report.solver, bw_eigensolver_name(solver));
    }
    assert_int_equal(modes[1]->rigid_count, 2);
    for (int k = 0; k < 8; k++)
      check_near(modes[1]->eigenvalue[k], modes[0]->eigenvalue[k / 2],
                 1e-9 * modes[0]->eigenvalue[k / 2]);
    for (int k = 0; k < 2; k++)
      bw_release(modes[k]);
    bw_release(solver);
  }
  free(x);
  free(element);
  for (int k = 0; k < 2; k++)
    bw_release(pattern[k]);
  bw_release(mesh);
  bw_release(one);
}

static void versions(void **state) {
  bw_context *context = check_context(state);
  char *text = NULL;
  check_ok(context, bw_library_versions(context, &text));
  assert_non_null(strstr(text, "OpenBLAS"));
  assert_non_null(strstr(text, "CHOLMOD 3."));
  assert_non_null(strstr(text, "GLPK 5."));
  assert_non_null(strstr(text, "ARPACK-ng 3."));
  bw_free(text);
}

check_main(check_test(box_converges), check_test(threads_of_others), check_test(two_bodies),
           check_test(versions))
