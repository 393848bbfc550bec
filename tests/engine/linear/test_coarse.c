/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse space of linear elements: what it represents it solves to the digits of floats. */
#include "linear/system_two_level.h"

#include "base/dense.h"
#include "incremental_bar.h"

/* A field that is linear in every element, random at the corners, and 0 wherever a support holds
 * anything nearby, without rigid-body motion of the corners where that is free. */
static double *linear_field(bw_context *context, const bw_dof_map *dof_map, bw_random *random) {
  const bw_mesh *mesh = dof_map->mesh;
  double *u = BW_NEW0(context, double, 3 * (size_t)mesh->node_count);
  uint8_t *fixed = BW_NEW0(context, uint8_t, mesh->node_count);
  assert_non_null(u);
  assert_non_null(fixed);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    if (dof_map->state[i] == BW_DOF_PRESCRIBED)
      fixed[i / 3] = 1;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 6; a++) {
      const int32_t *node = mesh->element + 10 * e;
      if (fixed[node[4 + a]])
        fixed[node[bw_tet_edge[a][0]]] = fixed[node[bw_tet_edge[a][1]]] = 1;
    }
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++) {
      int64_t i = mesh->element[10 * e + a];
      for (int c = 0; c < 3 && !fixed[i] && u[3 * i + 2] == 0; c++)
        u[3 * i + c] = bw_random_uniform(random) - 0.5;
    }
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 6; a++) {
      const int32_t *node = mesh->element + 10 * e;
      for (int c = 0; c < 3; c++)
        u[3 * node[4 + a] + c] =
            0.5 * (u[3 * node[bw_tet_edge[a][0]] + c] + u[3 * node[bw_tet_edge[a][1]] + c]);
    }
  bw_free(fixed);
  return u;
}

/* What of a field on the corners is a rigid-body motion that no support holds: by least squares,
 * the slow way. */
static void remove_modes(bw_context *context, const bw_dof_map *dof_map, const int32_t *parent,
                         double *x) {
  const bw_mesh *mesh = dof_map->mesh;
  int modes = dof_map->rigid_mode_count;
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *r = BW_NEW0(context, double, (modes + 1) * size);
  assert_non_null(r);
  for (int m = 0; m < modes; m++) {
    double *of = r + m * size, only[6] = {0};
    only[m] = 1;
    bw_rigid_modes_add(dof_map, only, of);
    for (int64_t i = 0; i < mesh->node_count; i++) /* to the corners */
      if (parent[2 * i] == parent[2 * i + 1])
        memmove(of + 3 * parent[2 * i], of + 3 * i, 3 * sizeof *of);
    int64_t corners = 0;
    for (int64_t i = 0; i < mesh->node_count; i++)
      corners += parent[2 * i] == parent[2 * i + 1];
    memset(of + 3 * corners, 0, (size_t)(size - 3 * corners) * sizeof *of);
    for (int k = 0; k < m; k++) {
      double part = bwi_dot(size, of, r + k * size);
      for (int64_t i = 0; i < size; i++)
        of[i] -= part * r[k * size + i];
    }
    double norm = sqrt(bwi_dot(size, of, of));
    for (int64_t i = 0; i < size; i++)
      of[i] /= norm;
    double along = bwi_dot(3 * corners, of, x);
    for (int64_t i = 0; i < 3 * corners; i++)
      x[i] -= along * of[i];
  }
  bw_free(r);
}

/* A^-1 P^T K u = y for u = P y, on a turned and scaled shape, under every kind of support. */
static void linear_fields_are_solved(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 7);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 1, 2, &b);
    load_bar(context, &b, scene);
    bw_incremental_system *incremental = incremental_of(context, &b);
    turn_subdomain(&b, 1, 0.2);
    b.now.scale[0][1] *= 1.2;
    edit_and_compare(context, &b, incremental, WAY_REFACTOR);
    const bw_dof_map *dof_map = incremental->system->dof_map;
    const bw_mesh *mesh = incremental->system->mesh;
    size_t size = 3 * (size_t)mesh->node_count;
    assert_true(bwi_coarse_fits(mesh));
    bwi_coarse *coarse = NULL;
    bool usable = false;
    double *u = linear_field(context, dof_map, &random);
    double *f = BW_NEW(context, double, size), *v = BW_NEW0(context, double, size);
    assert_true(f && v);
    check_ok(context, bwi_coarse_create(context, mesh, &coarse));
    check_ok(context,
             bwi_coarse_follow(context, coarse, incremental->inner->model, dof_map, &usable));
    assert_true(usable);
    check_ok(context, bw_block_multiply(context, incremental->system->pattern,
                                        incremental->system->stiffness, 9, 3, 1, u, f));
    const int32_t *parent = bwi_coarse_parents(coarse);
    int64_t corners = bwi_coarse_corners(coarse);
    for (int64_t i = 0; i < mesh->node_count; i++)
      for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3; c++)
          v[3 * parent[2 * i + side] + c] += 0.5 * f[3 * i + c];
    check_ok(context, bwi_coarse_solve(context, coarse, 1, v));
    for (int64_t i = 0; i < mesh->node_count; i++)
      for (int c = 0; c < 3 && parent[2 * i] == parent[2 * i + 1]; c++)
        f[3 * parent[2 * i] + c] = u[3 * i + c];
    remove_modes(context, dof_map, parent, f);
    check_near(difference(v, f, 3 * corners), 0, 1e-3);
    bw_release(coarse);
    bw_free(u);
    bw_free(f);
    bw_free(v);
    bw_release(incremental);
    bar_clear(&b);
  }
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 2, &b);
  load_bar(context, &b, 0);
  bw_incremental_system *incremental = incremental_of(context, &b);
  check_each_allocation(context, status, 1) {
    bwi_coarse *coarse = NULL;
    bool usable = false;
    status = bwi_coarse_create(context, incremental->system->mesh, &coarse);
    if (status == BW_OK)
      status = bwi_coarse_follow(context, coarse, incremental->inner->model,
                                 incremental->system->dof_map, &usable);
    bw_release(coarse);
  }
  bw_release(incremental);
  bar_clear(&b);
}

/* ---- multigrid in place of the factor -------------------------------------------------------- */

/* A cube of n x n x n cubes, or a bar of four of them, fixed at one end or afloat. */
static bw_model *thick_body(bw_context *context, int length, int n, bool afloat) {
  bw_mesh *mesh = body_box(context, length, 1, 1, length * n, n, n, 2);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  const double pull[3] = {1e6, 2e6, 3e6};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_selection *root = body_face(context, mesh, 0, 0), *tip = body_face(context, mesh, 0, length);
  if (!afloat)
    check_ok(context, bw_model_fix(context, model, root));
  check_ok(context, bw_model_force(context, model, tip, pull));
  bw_release(root);
  bw_release(tip);
  bw_release(material);
  bw_release(mesh);
  return model;
}

/* Statics by two-level PCG over multigrid and by a factor; the same bits on any number of threads.
 * Returns iterations. */
static int compare_with_factor(bw_context *context, const bw_model *model, bool afloat) {
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_statics_options options = {.solver = cholesky, .inertia_relief = afloat};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  bw_static *direct = NULL, *found[2];
  check_ok(context, bw_statics(context, model, NULL, &options, &direct));
  options.solver = pcg;
  for (int threads = 1; threads <= 2; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, bw_statics(context, model, NULL, &options, &found[threads - 1]));
  }
  assert_true(bwi_coarse_iterative(found[0]->system->two_level->coarse));
  assert_true(found[0]->report.flops == 0);
  check_near(difference(found[0]->displacement, direct->displacement, size), 0, 1e-8);
  check_near(found[0]->energy / direct->energy, 1, 1e-8);
  assert_memory_equal(found[0]->displacement, found[1]->displacement,
                      (size_t)size * sizeof(double));
  int iterations = found[0]->report.iterations;
  bw_release(found[0]);
  bw_release(found[1]);
  bw_release(direct);
  bw_release(pcg);
  bw_release(cholesky);
  return iterations;
}

static void multigrid_below(void **state) {
  bw_context *context = check_context(state);
  const int size[3][2] = {{1, 12}, {1, 15}, {3, 9}};
  for (int k = 0; k < 3; k++) {
    bool afloat = k % 2 == 1;
    bw_model *model = thick_body(context, size[k][0], size[k][1], afloat);
    assert_in_range(compare_with_factor(context, model, afloat), 15, 32);
    bw_release(model);
  }
}

/* Allocations that fail one after the other, thinned out, and a request to stop. */
static void multigrid_fails(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = thick_body(context, 1, 13, true);
  bw_dof_map *dof_map = NULL;
  bwi_coarse *coarse = NULL;
  bool usable = false, passed = false;
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  check_ok(context, bwi_coarse_create(context, model->mesh, &coarse)); /* and the threads */
  check_ok(context, bwi_coarse_follow(context, coarse, model, dof_map, &usable));
  bw_release(coarse);
  coarse = NULL;
  int64_t before = bw_live_blocks();
  for (int64_t n = 1; !passed; n += 11) {
    bw_fail_allocation(n, true);
    bw_status status = bwi_coarse_create(context, model->mesh, &coarse);
    if (status == BW_OK)
      status = bwi_coarse_follow(context, coarse, model, dof_map, &usable);
    bw_fail_allocation(0, false);
    passed = status == BW_OK;
    assert_true(passed || status == BW_MEMORY);
    bw_clear_failure(context);
    if (!passed) {
      bw_release(coarse);
      coarse = NULL;
      assert_int_equal(bw_live_blocks(), before);
    }
  }
  assert_true(usable && bwi_coarse_iterative(coarse));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "cancel",
              bwi_coarse_follow(context, coarse, model, dof_map, &usable));
  bw_clear_cancel(context);
  check_ok(context, bwi_coarse_follow(context, coarse, model, dof_map, &usable));
  assert_true(usable);
  bw_release(coarse);
  bw_release(dof_map);
  bw_release(model);
}

check_main(check_test(linear_fields_are_solved), check_test(no_memory), check_test(multigrid_below),
           check_test(multigrid_fails))
