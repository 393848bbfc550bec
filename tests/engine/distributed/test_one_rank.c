/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* PETSc and SLEPc on one rank, in this process: allocation failures and cancelling, which are hard
 * to aim from outside. Several ranks are tests/lua/distributed_spec.lua. */
#include "barwright/distributed.h"
#include "bodies.h"
#include "body_system.h"

static bw_model *body(bw_context *context, int order, bool fixed) {
  bw_mesh *mesh = body_box(context, 1, 0.2, 0.1, 4, 2, 1, order);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_selection *right = NULL;
  const double from[3] = {1 - 1e-9, -1, -1}, to[3] = {2, 1, 1};
  check_ok(context, bw_select_box(context, mesh, from, to, &right));
  check_ok(context, bw_model_force(context, model, right, (double[3]){100, 20, -9}));
  bw_release(right);
  if (fixed) {
    bw_selection *left = NULL;
    const double low[3] = {-1, -1, -1}, high[3] = {1e-9, 1, 1};
    check_ok(context, bw_select_box(context, mesh, low, high, &left));
    check_ok(context, bw_model_slide(context, model, left, (double[3]){1, 0.2, 0}));
    bw_release(left);
  }
  bw_release(mesh);
  bw_release(material);
  return model;
}

/* A factor, or conjugate gradients with multigrid, over the processes. */
static bw_status solver_of(bw_context *context, bw_solver_kind kind, bw_solver **solver) {
  bw_solver *amg = NULL;
  bw_solver_options options = {.kind = BW_SOLVER_AMG, .backend = BW_BACKEND_PETSC};
  bw_status status = bw_solver_create(context, &options, &amg);
  if (status == BW_OK) {
    options = kind == BW_SOLVER_PCG
                  ? (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg}
                  : (bw_solver_options){.backend = BW_BACKEND_PETSC};
    status = bw_solver_create(context, &options, solver);
  }
  bw_release(amg);
  return status;
}

static bw_status statics(bw_context *context, const bw_model *model, bw_solver_kind kind,
                         bw_static **result) {
  bw_solver *solver = NULL;
  bw_status status = solver_of(context, kind, &solver);
  if (status == BW_OK) {
    const bw_statics_options opts = {.inertia_relief = true, .solver = solver};
    status = bw_statics(context, model, NULL, &opts, result);
  }
  bw_release(solver);
  return status;
}

static bw_status modes_of(bw_context *context, const bw_model *model, bw_solver_kind kind,
                          bw_modes **modes) {
  bw_solver *inner = NULL;
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = BW_EIGENSOLVER_SLEPC;
  bw_status status = solver_of(context, kind, &inner);
  options.inner = inner;
  if (status == BW_OK)
    status = bw_eigensolver_create(context, &options, &solver);
  const bw_modes_options opts = {
      .count = 2, .tolerance = 1e-8, .sturm = true, .seed = 1, .solver = solver};
  if (status == BW_OK)
    status = bw_modes_of_model(context, model, NULL, &opts, NULL, modes);
  bw_release(inner);
  bw_release(solver);
  return status;
}

/* Each allocation fails once with all that follow: the message comes back, nothing stays behind,
 * and the next call works. */
static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_world_start(context, false));
  for (int kind = 0; kind < 16; kind++) {
    bw_solver_kind method = kind & 1 ? BW_SOLVER_CHOLESKY : BW_SOLVER_PCG;
    bw_model *model = body(context, kind & 8 ? 2 : 1, kind & 2);
    bw_status status = BW_MEMORY;
    int64_t n = 1;
    for (; status == BW_MEMORY; n++) {
      bw_static *result = NULL;
      bw_modes *modes = NULL;
      bw_fail_allocation(n, true);
      status = kind & 4 ? modes_of(context, model, method, &modes)
                        : statics(context, model, method, &result);
      bw_fail_allocation(0, false);
      if (status != BW_MEMORY)
        check_ok(context, status);
      bw_release(result);
      bw_release(modes);
    }
    assert_true(n > 30);
    bw_release(model);
  }
}

typedef struct stopper {
  bw_context *context;
  int reports;
} stopper;

static void stop(void *data, const char *stage, double fraction) {
  stopper *s = data;
  (void)fraction;
  if (strstr(stage, " modes") || strcmp(stage, "conjugate gradients") == 0) {
    s->reports++;
    bw_cancel(s->context);
  }
}

static void test_cancel(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_world_start(context, false));
  bw_model *model = body(context, 2, false);
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  stopper s = {.context = context};
  bw_set_progress(context, stop, &s);
  check_fails(context, BW_CANCELLED, "cancel", statics(context, model, BW_SOLVER_PCG, &result));
  assert_int_equal(s.reports, 1);
  bw_clear_cancel(context);
  s.reports = 0;
  check_fails(context, BW_CANCELLED, "cancel",
              modes_of(context, model, BW_SOLVER_CHOLESKY, &modes));
  assert_int_equal(s.reports, 1);
  bw_clear_cancel(context);
  bw_set_progress(context, NULL, NULL);
  check_ok(context, statics(context, model, BW_SOLVER_PCG, &result));
  check_ok(context, modes_of(context, model, BW_SOLVER_CHOLESKY, &modes));
  assert_true(modes->counted);
  assert_int_equal(modes->rigid_count, 6);
  bw_release(result);
  bw_release(modes);
  bw_release(model);
}

/* Axes by element, which only a part of the elements has in each piece. */
static void test_rotated_by_element(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_world_start(context, false));
  enum { GROUPS = 3 };
  const double rotation[GROUPS][9] = {
      {0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0, 0, 0, 0, -1, 0, 1, 0}};
  bw_mesh *mesh = body_box(context, 1, 0.2, 0.1, 4, 2, 1, 2);
  bw_material *material = NULL;
  bw_model *model = NULL;
  bw_selection *left = NULL, *right = NULL;
  bw_static *own = NULL, *other = NULL;
  const double low[3] = {-1, -1, -1}, high[3] = {1e-9, 1, 1};
  const double from[3] = {1 - 1e-9, -1, -1}, to[3] = {2, 1, 1};
  check_ok(context, bw_material_named(context, "zp150", &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  int32_t *group = BW_NEW(context, int32_t, mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    group[e] = e % 5 == 0 ? 2 : e % 2;
  check_ok(context, bw_model_rotate_material(context, model, GROUPS, group, rotation[0]));
  bw_free(group);
  check_ok(context, bw_select_box(context, mesh, low, high, &left));
  check_ok(context, bw_select_box(context, mesh, from, to, &right));
  check_ok(context, bw_model_fix(context, model, left));
  check_ok(context, bw_model_force(context, model, right, (double[3]){100, 20, -9}));
  check_ok(context, bw_statics(context, model, NULL, NULL, &own));
  check_ok(context, statics(context, model, BW_SOLVER_CHOLESKY, &other));
  double largest = 0;
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    largest = fmax(largest, fabs(own->displacement[i]));
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    check_near(other->displacement[i], own->displacement[i], 1e-9 * largest);
  bw_release(own);
  bw_release(other);
  bw_release(left);
  bw_release(right);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* A body that falls: inertia balances the load to rounding, and there is nothing to solve. */
static void test_fall(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_world_start(context, false));
  bw_model *model = body(context, 1, false);
  bw_static *result = NULL;
  bw_model_clear_loads(model);
  check_ok(context, bw_model_gravity(context, model, (double[3]){1, 2, 9.81}));
  for (int method = BW_SOLVER_CHOLESKY; method <= BW_SOLVER_PCG; method++) {
    check_ok(context, statics(context, model, (bw_solver_kind)method, &result));
    for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++)
      check_near(result->displacement[i], 0, 1e-18);
    bw_release(result);
    result = NULL;
  }
  bw_release(model);
}

/* More modes than there are: all of them, and no more. */
static void test_small(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_world_start(context, false));
  bw_mesh *mesh = body_box(context, 1, 1, 1, 1, 1, 1, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_modes *own = NULL, *other = NULL;
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
  bw_eigensolver *slepc = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = BW_EIGENSOLVER_SLEPC;
  check_ok(context, bw_eigensolver_create(context, &options, &slepc));
  bw_modes_options opts = {.count = 100, .tolerance = 1e-8, .sturm = true, .seed = 1};
  check_ok(context, bw_modes_elastic(context, system, &opts, &own));
  opts.solver = slepc;
  check_ok(context, bw_modes_of_model(context, model, NULL, &opts, NULL, &other));
  bw_release(slepc);
  assert_int_equal(other->count, own->count);
  for (int k = 0; k < own->count; k++)
    check_near(other->eigenvalue[k] / own->eigenvalue[k], 1, 1e-8);
  bw_release(own);
  bw_release(other);
  bw_release(system);
  bw_release(dof_map);
  bw_release(model);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(test_memory), check_test(test_cancel), check_test(test_rotated_by_element),
           check_test(test_fall), check_test(test_small))
