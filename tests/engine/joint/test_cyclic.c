/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Modes of a sector of cyclic symmetry on the whole wheel: the equations of the wheel, their
 * orthonormality, and numbers of nodal diameters. tests/lua/cyclic_spec.lua compares with wheels.
 */
#include "bodies.h"

#include "assemble/internal.h"
#include "barwright/joint.h"
#include "barwright/singular_places.h"

/* A quarter of a square block about the z axis, of an orthotropic material with axes of its own. */
static bw_model *quarter(bw_context *context, int order) {
  bw_mesh *mesh = body_box(context, 1, 1, 0.5, 3, 3, 2, order);
  bw_material *material = NULL, *turned = NULL;
  bw_model *model = NULL;
  bw_selection *low = NULL, *high = NULL;
  const bw_orthotropic constants = {.name = "wood",
                                    .young = {10e9, 3e9, 5e9},
                                    .poisson = {0.3, 0.2, 0.25},
                                    .shear = {1e9, 2e9, 1.5e9},
                                    .axes = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                    .density = 500};
  const double rotation[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};
  const double origin[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  check_ok(context, bw_material_rotated(context, material, rotation, &turned));
  check_ok(context, bw_model_create(context, mesh, turned, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, y, 1e-9, &low));
  check_ok(context, bw_select_plane(context, mesh, origin, x, 1e-9, &high));
  check_ok(context, bw_model_cyclic(context, model, low, high, 4, z, origin));
  bw_release(low);
  bw_release(high);
  bw_release(material);
  bw_release(turned);
  bw_release(mesh);
  return model;
}

static bw_modes *modes_of(bw_context *context, const bw_model *model, int count, int diameter) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = count;
  options.tolerance = 1e-10;
  options.nodal_diameter = diameter;
  check_ok(context, bw_joined_modes(context, model, &options, &modes));
  assert_true(modes->counted);
  return modes;
}

/* K u = lambda M u and u . M v = 0 or 1, on the wheel with material that turns. */
static void modes_are_those_of_the_wheel(void **state) {
  bw_context *context = check_context(state);
  enum { COUNT = 16 };
  for (int order = 1; order <= 2; order++) {
    bw_model *model = quarter(context, order);
    bw_modes *sector = modes_of(context, model, COUNT, -1), *whole = NULL;
    bw_block_pattern *pattern = NULL;
    check_ok(context, bw_modes_whole(context, sector, &whole));
    const bw_mesh *mesh = whole->mesh;
    int64_t size = 3 * (int64_t)mesh->node_count;
    assert_int_equal(sector->rigid_count, 6);
    assert_int_equal(mesh->element_count, 4 * model->mesh->element_count);
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *k = numbers(9 * pattern->block_count), *m = numbers(pattern->block_count);
    double *ku = numbers(size), *mu = numbers(size);
    check_ok(context, bw_stiffness(context, pattern, mesh, whole->material, k));
    check_ok(context, bw_mass(context, pattern, mesh, whole->material, m));
    for (int i = 0; i < COUNT; i++) {
      const double *u = whole->shape + i * size;
      double far = 0, all = 0;
      check_ok(context, bw_block_multiply(context, pattern, k, 9, 3, 1, u, ku));
      check_ok(context, bw_block_multiply(context, pattern, m, 1, 3, 1, u, mu));
      for (int64_t c = 0; c < size; c++) {
        double want = whole->eigenvalue[i] * mu[c];
        far += (ku[c] - want) * (ku[c] - want);
        all += want * want;
      }
      assert_true(sqrt(far) < 1e-7 * sqrt(all));
      for (int j = 0; j < COUNT; j++) {
        double dot = 0;
        for (int64_t c = 0; c < size; c++)
          dot += mu[c] * whole->shape[j * size + c];
        check_near(dot, i == j, 1e-8);
      }
    }
    free(k);
    free(m);
    free(ku);
    free(mu);
    bw_release(pattern);
    bw_release(whole);
    bw_release(sector);
    bw_release(model);
  }
}

/* The modes of each number of diameters are those of all with that number: single ones for 0 and
 * n/2, pairs between. */
static void diameters_split_the_modes(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = quarter(context, 1);
  bw_modes *all = modes_of(context, model, 16, -1);
  int seen = 0, rigid = 0;
  for (int diameter = 0; diameter <= 2; diameter++) {
    bw_modes *own = modes_of(context, model, 16, diameter);
    int at = 0;
    for (int i = 0; i < all->count; i++)
      if (all->nodal_diameter[i] == diameter) {
        assert_int_equal(own->nodal_diameter[at], diameter);
        check_near(own->eigenvalue[at], all->eigenvalue[i], 1e-9 * all->eigenvalue[i]);
        at++;
      }
    for (int i = 0; i + 1 < at; i++) {
      bool pair = own->eigenvalue[i + 1] - own->eigenvalue[i] < 1e-7 * own->eigenvalue[i];
      assert_int_equal(pair, diameter == 1 && i % 2 == 0);
    }
    seen += at;
    rigid += own->rigid_count;
    assert_int_equal(own->rigid_count, diameter == 0 ? 2 : diameter == 1 ? 4 : 0);
    bw_release(own);
  }
  assert_int_equal(seen, 16);
  assert_int_equal(rigid, all->rigid_count);
  bw_release(all);
  bw_release(model);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = quarter(context, 1), *whole = NULL, *again = NULL;
  bw_static *result = NULL;
  bw_dof_map *dof_map = NULL;
  bw_modes_options options;
  bw_modes *modes = NULL;
  const double gravity[3] = {0, 0, -10};
  check_ok(context, bw_model_gravity(context, model, gravity));
  assert_int_equal(bw_joined_statics(context, model, NULL, &result), BW_UNCONSTRAINED);
  assert_int_equal(bw_dof_map_create(context, model, &dof_map), BW_UNSUPPORTED);
  bw_modes_options_default(&options);
  options.nodal_diameter = 3;
  assert_int_equal(bw_joined_modes(context, model, &options, &modes), BW_INVALID);
  check_ok(context, bw_model_whole(context, model, &whole));
  assert_int_equal(bw_model_whole(context, whole, &again), BW_INVALID);
  bw_release(whole);
  bw_release(model);
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = quarter(context, 1), *whole = NULL;
  const bw_cyclic *cyclic = bw_retain(model->cyclic);
  bw_static *result = NULL, *all = NULL;
  bw_modes *modes = NULL, *shapes = NULL;
  bw_selection *foot = NULL;
  bw_singular_places *places = NULL;
  const double point[3] = {0, 0, 0}, z[3] = {0, 0, 1};
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 3;
  bw_model_clear_cyclic(model);
  for (int64_t n = 1;; n++) {
    bw_fail_allocation(n, true);
    bw_status status = bw_model_cyclic(context, model, cyclic->low, cyclic->high, 4, z, point);
    bw_fail_allocation(0, false);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    bw_clear_failure(context);
  }
  check_ok(context, bw_select_plane(context, model->mesh, point, z, 1e-9, &foot));
  check_ok(context, bw_model_fix(context, model, foot));
  check_ok(context, bw_model_gravity(context, model, (double[3]){0, 0, -10}));
  check_allocations(context, result, bw_joined_statics(context, model, NULL, &result));
  check_ok(context, bw_joined_statics(context, model, NULL, &result));
  check_allocations(context, modes, bw_joined_modes(context, model, &options, &modes));
  check_ok(context, bw_joined_modes(context, model, &options, &modes));
  check_allocations(context, whole, bw_model_whole(context, model, &whole));
  check_allocations(context, all, bw_static_whole(context, result, &all));
  check_allocations(context, shapes, bw_modes_whole(context, modes, &shapes));
  check_allocations(context, places, bw_singular_places_find(context, model, NULL, 0, &places));
  bw_release(result);
  bw_release(modes);
  bw_release(foot);
  bw_release(cyclic);
  bw_release(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(modes_are_those_of_the_wheel),
      check_test(diameters_split_the_modes),
      check_test(refuses),
      check_test(memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
