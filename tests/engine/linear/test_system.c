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

enum { EDITS = 4 };

/* Shapes whose last corner differs, one after the other; of `order` 2 with an edge that is curved
 * by it. */
static bw_mesh *edited(bw_context *context, const bw_mesh *mesh, int edit) {
  bw_mesh *moved = NULL;
  double *x = numbers(3 * (int64_t)mesh->node_count);
  memcpy(x, mesh->node, 3 * (size_t)mesh->node_count * sizeof *x);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (x[3 * i] > 0.99 && x[3 * i + 1] > 0.79 && x[3 * i + 2] > 0.69)
      x[3 * i + edit % 3] += 0.003 * (edit + 1);
  check_ok(context, bw_mesh_moved(context, mesh, x, &moved));
  free(x);
  return moved;
}

/* A chain of edits has, bit for bit, the stiffness and the solutions that each shape has from
 * scratch; only elements at the edit are assembled. Where isostatic constraints stay, the first
 * edit makes a factor that can be updated, and later ones update it in part. What came before stays
 * as it was. */
static void edits(void **state) {
  bw_context *context = check_context(state);
  int updated = 0;
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 1, 0.8, 0.7, 12 / order, 8 / order, 8 / order, order);
    bw_material *material = body_material(context);
    bw_dof_map *dof_map = NULL;
    bw_system *system = NULL;
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *f = numbers(size), *u = numbers(size), *v = numbers(size), *first = numbers(size);
    random_field(9, size, f);
    check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
    check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
    check_ok(context, bw_system_solve(context, system, 1, f, first));
    bw_system *rest = bw_retain(system);
    for (int k = 0; k < EDITS; k++) {
      bw_mesh *shape = edited(context, mesh, k);
      bw_dof_map *now = NULL;
      bw_system *next = NULL, *fresh = NULL;
      check_ok(context, bw_dof_map_unconstrained(context, shape, &now));
      check_ok(context, body_system(context, shape, material, now, system, &next));
      check_ok(context, body_system(context, shape, material, now, NULL, &fresh));
      assert_int_equal(fresh->times.elements, mesh->element_count);
      assert_true(next->times.elements > 0 && next->times.elements < mesh->element_count / 10);
      bool can = system->factor->kept && bwi_same_supports(system->dof_map, now);
      assert_true(can ? next->times.factor_reused > 0.3 : next->times.factor_reused == 0);
      updated += can;
      assert_memory_equal(next->stiffness, fresh->stiffness,
                          (size_t)(9 * next->pattern->block_count) * sizeof(double));
      check_ok(context, bw_system_solve(context, next, 1, f, u));
      check_ok(context, bw_system_solve(context, fresh, 1, f, v));
      assert_memory_equal(u, v, (size_t)size * sizeof(double));
      bw_release(system);
      system = next;
      bw_release(fresh);
      bw_release(now);
      bw_release(shape);
    }
    check_ok(context, bw_system_solve(context, rest, 1, f, u));
    assert_memory_equal(u, first, (size_t)size * sizeof(double));
    free(f);
    free(u);
    free(v);
    free(first);
    bw_release(rest);
    bw_release(system);
    bw_release(dof_map);
    bw_release(material);
    bw_release(mesh);
  }
  assert_true(updated >= 2);
}

/* Another rotation of the material in some elements, then another material in all. */
static void other_materials(void **state) {
  bw_context *context = check_context(state);
  static const double turn[27] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.6, -0.8, 0, 0.8, 0.6,
                                  0, 0, 0, 1, 0, 0, 1, 1, 0, 0,   0,    1, 0};
  bw_mesh *mesh = body_box(context, 1, 0.8, 0.7, 6, 4, 4, 1);
  bw_material *base = NULL, *whole = NULL, *material[4] = {NULL};
  check_ok(context, bw_material_named(context, "zp150", &base));
  check_ok(context, bw_material_formulated(context, base, BW_STANDARD, &whole));
  int32_t *group = calloc((size_t)mesh->element_count, sizeof *group);
  for (int k = 0; k < 3; k++) {
    for (int32_t e = 0; e < mesh->element_count; e++)
      group[e] = e < 20 ? k : 0;
    check_ok(context, bw_material_rotated_by_element(context, whole, mesh->element_count, 3, group,
                                                     turn, &material[k]));
  }
  material[3] = body_material(context);
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *f = numbers(size), *u = numbers(size), *v = numbers(size);
  random_field(4, size, f);
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  for (int k = 0; k < 4; k++) {
    bw_system *next = NULL, *fresh = NULL;
    check_ok(context, body_system(context, mesh, material[k], dof_map, system, &next));
    check_ok(context, body_system(context, mesh, material[k], dof_map, NULL, &fresh));
    assert_int_equal(next->times.elements, k == 0 || k == 3 ? mesh->element_count : 20);
    check_ok(context, bw_system_solve(context, next, 1, f, u));
    check_ok(context, bw_system_solve(context, fresh, 1, f, v));
    assert_memory_equal(u, v, (size_t)size * sizeof(double));
    bw_release(system);
    system = next;
    bw_release(fresh);
  }
  free(group);
  free(f);
  free(u);
  free(v);
  bw_release(system);
  bw_release(dof_map);
  for (int k = 0; k < 4; k++)
    bw_release(material[k]);
  bw_release(whole);
  bw_release(base);
  bw_release(mesh);
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
  bw_mesh *shape[2] = {edited(context, mesh, 0), edited(context, mesh, 1)};
  bw_system *former = NULL, *kept = NULL;
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &former));
  check_ok(context, body_system(context, shape[0], material, dof_map, former, &kept));
  check_each_allocation(context, status, 1) {
    bw_system *system = NULL;
    status = body_system(context, mesh, material, dof_map, NULL, &system);
    if (status == BW_OK) {
      bw_release(system);
      status = body_system(context, shape[0], material, dof_map, former, &system);
    }
    if (status == BW_OK) {
      bw_release(system);
      status = body_system(context, shape[1], material, dof_map, kept, &system);
    }
    random_field(1, 3 * size, u);
    if (status == BW_OK)
      status = bw_system_solve(context, system, 3, u, u);
    bw_release(system);
  }
  free(u);
  bw_release(former);
  bw_release(kept);
  bw_release(shape[0]);
  bw_release(shape[1]);
  bw_release(dof_map);
  bw_release(material);
  bw_release(mesh);
}

check_main(check_test(free_body_against_bordered), check_test(residual_and_threads),
           check_test(reuse), check_test(edits), check_test(other_materials),
           check_test(failing_allocations))
