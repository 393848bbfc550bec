/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elastic modes. */
#include "bodies.h"

void dsygv_(const int *, const char *, const char *, const int *, double *, const int *, double *,
            const int *, double *, double *, const int *, int *);

/* A free box against the dense generalised eigenproblem. */
static void free_box_against_dense(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 4, 3, 2, 1);
  bw_material *material = body_material(context);
  bw_numbering *numbering = NULL;
  bw_system *system = NULL;
  bw_modes *modes = NULL;
  check_ok(context, bw_numbering_free(context, mesh, &numbering));
  check_ok(context, bw_system_create(context, mesh, material, numbering, NULL, &system));
  bw_modes_options options;
  bw_modes_options_default(&options);
  check_ok(context, bw_modes_elastic(context, system, &options, &modes));
  assert_int_equal(modes->count, 15);
  assert_int_equal(modes->rigid_count, 6);
  assert_true(modes->counted);
  assert_int_equal(modes->recovered, 0);
  int size = 3 * mesh->node_count, kind = 1, info, length = 10 * size;
  double *k = numbers((int64_t)size * size), *m = numbers((int64_t)size * size),
         *column = numbers(size), *value = numbers(size), *work = numbers(length);
  for (int j = 0; j < size; j++) {
    memset(column, 0, (size_t)size * sizeof(double));
    column[j] = 1;
    check_ok(context, bw_graph_multiply(context, system->graph, system->stiffness, 9, 3, 1, column,
                                        k + (size_t)j * (size_t)size));
    check_ok(context, bw_graph_multiply(context, system->graph, system->mass, 1, 3, 1, column,
                                        m + (size_t)j * (size_t)size));
  }
  dsygv_(&kind, "N", "L", &size, k, &size, m, &size, value, work, &length, &info);
  assert_int_equal(info, 0);
  for (int i = 0; i < 15; i++) {
    check_near(modes->eigenvalue[i], value[6 + i], 1e-8 * value[6 + i]);
    check_near(modes->frequency[i], sqrt(value[6 + i]) / (2 * M_PI), 1e-8 * sqrt(value[6 + i]));
    assert_true(modes->residual[i] < 1e-8);
  }
  free(k);
  free(m);
  free(column);
  free(value);
  free(work);
  bw_release(modes);
  bw_release(system);
  bw_release(numbering);
  bw_release(material);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(free_box_against_dense)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
