/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems: residuals, free bodies against a bordered dense system, the same bits for any number of
 * threads, reuse, failing allocations. */
#include "bodies.h"
#include "body_system.h"

void dgesv_(const int *, const int *, double *, const int *, int *, double *, const int *, int *);

/* A free body: P K_c^-1 P^T equals the bordered system [K WR; (WR)^T 0]. */
static void free_body_against_bordered(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 3, 2, 2, 1);
  bw_material *material = body_material(context);
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 6);
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
  int size = 3 * mesh->node_count, whole = size + 6, one = 1, info;
  double *dense = numbers((int64_t)whole * whole), *column = numbers(size), *out = numbers(size),
         *right = numbers(whole), *force = numbers(size);
  int *pivot = calloc((size_t)whole, sizeof(int));
  double scale = material->young[0]; /* of the border */
  for (int j = 0; j < size; j++) {
    memset(column, 0, (size_t)size * sizeof(double));
    column[j] = 1;
    check_ok(context,
             bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, 1, column, out));
    memcpy(dense + (size_t)j * (size_t)whole, out, (size_t)size * sizeof(double));
  }
  for (int m = 0; m < 6; m++) {
    double a[6] = {0};
    a[m] = 1;
    bw_rigid_modes_weighted(dof_map, a, out);
    for (int i = 0; i < size; i++)
      dense[(size_t)(size + m) * (size_t)whole + (size_t)i] =
          dense[(size_t)i * (size_t)whole + (size_t)(size + m)] = out[i] * scale;
  }
  random_field(3, size, force);
  memcpy(right, force, (size_t)size * sizeof(double));
  bw_rigid_modes_balance(dof_map, right);
  dgesv_(&whole, &one, dense, &whole, pivot, right, &whole, &info);
  assert_int_equal(info, 0);
  check_ok(context, bw_system_solve(context, system, 1, force, out));
  double largest = 0, difference = 0;
  for (int i = 0; i < size; i++) {
    largest = fmax(largest, fabs(right[i]));
    difference = fmax(difference, fabs(right[i] - out[i]));
  }
  assert_true(difference < 1e-10 * largest);
  free(dense);
  free(column);
  free(out);
  free(right);
  free(force);
  free(pivot);
  bw_release(system);
  bw_release(dof_map);
  bw_release(material);
  bw_release(mesh);
}

/* K u = balanced f at every node, also at isostatic constraints; many right-hand sides; the same
 * bits for 1, 2 and 3 threads. */
static void residual_and_threads(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.8, 0.7, 9, 8, 7, 2);
  bw_material *material = body_material(context);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  enum { COUNT = 21 };
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *force = numbers(COUNT * size), *ku = numbers(COUNT * size), *u[3] = {NULL};
  for (int threads = 1; threads <= 3; threads++) {
    bw_system *system = NULL;
    u[threads - 1] = numbers(COUNT * size);
    random_field(5, COUNT * size, force);
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
    check_ok(context, bw_system_solve(context, system, COUNT, force, u[threads - 1]));
    assert_memory_equal(u[0], u[threads - 1], (size_t)(COUNT * size) * sizeof(double));
    if (threads == 1) {
      check_ok(context, bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, COUNT,
                                          u[0], ku));
      for (int k = 0; k < COUNT; k++) {
        double *f = force + k * size, worst = 0;
        bw_rigid_modes_balance(dof_map, f);
        for (int64_t i = 0; i < size; i++)
          worst = fmax(worst, fabs(ku[k * size + i] - f[i]));
        assert_true(worst < 1e-9);
      }
    }
    bw_release(system);
  }
  for (int k = 0; k < 3; k++)
    free(u[k]);
  free(force);
  free(ku);
  bw_release(dof_map);
  bw_release(material);
  bw_release(mesh);
}

/* Graph, ordering and analysis of a moved mesh come from the system before it. */
static void reuse(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 4, 4, 4, 1), *moved = NULL;
  bw_material *material = body_material(context);
  bw_dof_map *dof_map = NULL, *again = NULL;
  bw_system *first = NULL, *second = NULL, *fresh = NULL;
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *x = numbers(size), *u = numbers(size), *v = numbers(size);
  for (int64_t i = 0; i < size; i++)
    x[i] = mesh->node[i] * (i % 3 == 0 ? 1.5 : 1);
  check_ok(context, bw_mesh_moved(context, mesh, x, &moved));
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  check_ok(context, bw_dof_map_unconstrained(context, moved, &again));
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &first));
  check_ok(context, body_system(context, moved, material, again, first, &second));
  check_ok(context, body_system(context, moved, material, again, NULL, &fresh));
  assert_ptr_equal(second->pattern, first->pattern);
  random_field(9, size, x);
  check_ok(context, bw_system_solve(context, second, 1, x, u));
  check_ok(context, bw_system_solve(context, fresh, 1, x, v));
  for (int64_t i = 0; i < size; i++)
    check_near(u[i], v[i], 1e-20 + 1e-10 * fabs(v[i]));
  free(x);
  free(u);
  free(v);
  bw_release(first);
  bw_release(second);
  bw_release(fresh);
  bw_release(dof_map);
  bw_release(again);
  bw_release(material);
  bw_release(mesh);
  bw_release(moved);
}

static void failing_allocations(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 3, 3, 3, 1);
  bw_material *material = body_material(context);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *u = numbers(3 * size);
  check_ok(context, bw_set_threads(context, 1));
  int64_t before = bw_live_blocks();
  bool passed = false;
  for (int64_t n = 1; !passed && n < 2000; n++) {
    bw_system *system = NULL;
    bw_fail_allocation(n, true);
    bw_status status = body_system(context, mesh, material, dof_map, NULL, &system);
    random_field(1, 3 * size, u);
    if (status == BW_OK)
      status = bw_system_solve(context, system, 3, u, u);
    bw_fail_allocation(0, false);
    if (status != BW_OK)
      assert_int_equal(status, BW_MEMORY);
    passed = status == BW_OK;
    bw_release(system);
    bw_clear_failure(context);
    assert_int_equal(bw_live_blocks(), before);
  }
  assert_true(passed);
  free(u);
  bw_release(dof_map);
  bw_release(material);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(free_body_against_bordered),
                                     check_test(residual_and_threads), check_test(reuse),
                                     check_test(failing_allocations)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
