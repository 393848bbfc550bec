/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solvers external, seen from the engine: one that is the engine's own in disguise
 * gives the engine's answers; one that fails, lies or runs out of memory is found out. What MPI
 * does with it is tests/lua/distributed_spec.lua. */
#include "bodies.h"
#include "body_system.h"

static struct fake {
  bw_system *system;
  double scale;     /* what it gives over what is right */
  bw_status status; /* of a solve */
  int opened, closed, solves;
} fake;

static bw_status fake_open(bw_context *context, const bw_external_problem *problem,
                           const bw_solver *solver) {
  (void)solver;
  fake.opened++;
  return body_system(context, problem->dof_map->mesh, problem->material, problem->dof_map, NULL,
                     &fake.system);
}

static bw_status forget(bw_status status) {
  if (status != BW_OK) {
    bw_release(fake.system);
    fake.system = NULL;
  }
  return status;
}

static bw_status fake_multiply(bw_context *context, int count, const double *x, double *kx,
                               double *mx, double *magnitude) {
  const bw_system *system = fake.system;
  bw_status status =
      bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, count, x, kx);
  if (status == BW_OK && mx)
    status = bw_block_multiply(context, system->pattern, system->mass, 1, 3, count, x, mx);
  for (int k = 0; k < count && magnitude; k++)
    magnitude[k] = 0;
  return forget(status);
}

static bw_status fake_solve(bw_context *context, int count, const double *force,
                            double *displacement) {
  fake.solves += count;
  if (fake.status != BW_OK)
    return forget(bw_fail(context, fake.status, "the fake has failed"));
  bw_status status = bw_system_solve(context, fake.system, count, force, displacement);
  for (int64_t i = 0; status == BW_OK && i < 3 * (int64_t)count * fake.system->mesh->node_count;
       i++)
    displacement[i] *= fake.scale;
  return forget(status);
}

static bw_status fake_modes(bw_context *context, const bw_modes_options *options,
                            bw_external_modes *out) {
  bw_modes *modes = NULL;
  bw_modes_options own = *options;
  own.solver = NULL;
  bw_status status = bw_modes_elastic(context, fake.system, &own, &modes);
  if (status != BW_OK)
    return forget(status);
  size_t size = 3 * (size_t)modes->count * (size_t)modes->mesh->node_count;
  out->value = BW_NEW(context, double, modes->count);
  out->vector = BW_NEW(context, double, size);
  if (out->value && out->vector) {
    memcpy(out->value, modes->eigenvalue, (size_t)modes->count * sizeof(double));
    memcpy(out->vector, modes->shape, size * sizeof(double));
    out->count = modes->count;
  } else {
    status = BW_MEMORY;
    bw_free(out->value);
    bw_free(out->vector);
    out->value = out->vector = NULL;
  }
  bw_release(modes);
  return forget(status);
}

static void fake_report(bw_context *context, bw_external_report *report) {
  (void)context;
  *report = (bw_external_report){.ranks = 1};
}

static void fake_close(void) {
  fake.closed++;
  bw_release(fake.system);
  fake.system = NULL;
}

static const bw_external outside = {.open = fake_open,
                                    .multiply = fake_multiply,
                                    .solve = fake_solve,
                                    .modes = fake_modes,
                                    .report = fake_report,
                                    .close = fake_close};

/* By SLEPc, as it is registered. */
static bw_status external_modes(bw_context *context, const bw_model *model,
                                const bw_modes_options *given, bw_modes **modes) {
  bw_eigensolver *solver = NULL;
  bw_modes_options options;
  bw_eigensolver_options slepc;
  bw_eigensolver_options_default(&slepc);
  slepc.kind = BW_EIGENSOLVER_SLEPC;
  bw_modes_options_default(&options);
  if (given)
    options = *given;
  bw_status status = bw_eigensolver_create(context, &slepc, &solver);
  options.solver = solver;
  if (status == BW_OK)
    status = bw_modes_of_model(context, model, NULL, &options, NULL, modes);
  bw_release(solver);
  return status;
}

static bw_model *cantilever(bw_context *context, bool fixed) {
  bw_mesh *mesh = body_box(context, 1, 0.1, 0.1, 6, 2, 2, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_array *force = NULL;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &force));
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (mesh->node[3 * i] > 1 - 1e-9)
      ((double *)force->data)[3 * i + 2] = 10;
  check_ok(context, bw_model_nodal_forces(context, model, force));
  if (fixed) {
    bw_selection *left = NULL;
    const double low[3] = {-1, -1, -1}, high[3] = {1e-9, 1, 1};
    check_ok(context, bw_select_box(context, mesh, low, high, &left));
    check_ok(context, bw_model_fix(context, model, left));
    bw_release(left);
  }
  bw_release(force);
  bw_release(mesh);
  bw_release(material);
  return model;
}

/* Statics by the backend "petsc", as it is registered. */
static bw_status statics(bw_context *context, const bw_model *model, bool inertia_relief,
                         bw_static **result) {
  bw_solver *amg = NULL, *solver = NULL;
  bw_solver_options options = {.kind = BW_SOLVER_AMG, .backend = BW_BACKEND_PETSC};
  bw_status status = bw_solver_create(context, &options, &amg);
  if (status == BW_OK) {
    options = (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg};
    status = bw_solver_create(context, &options, &solver);
  }
  if (status == BW_OK) {
    const bw_statics_options opts = {.inertia_relief = inertia_relief, .solver = solver};
    status = bw_statics(context, model, NULL, &opts, result);
  }
  bw_release(amg);
  bw_release(solver);
  return status;
}

static void begin(void) {
  memset(&fake, 0, sizeof fake);
  fake.scale = 1;
  bw_external_register(&outside);
}

static void test_same_answers(void **state) {
  bw_context *context = check_context(state);
  begin();
  for (int fixed = 0; fixed < 2; fixed++) {
    bw_model *model = cantilever(context, fixed);
    bw_static *own = NULL, *other = NULL;
    bw_modes *modes = NULL, *others = NULL;
    const bw_statics_options options = {.inertia_relief = !fixed};
    const bw_modes_options opts = {.count = 4, .tolerance = 1e-8, .seed = 1};
    check_ok(context, bw_statics(context, model, NULL, &options, &own));
    check_ok(context, statics(context, model, !fixed, &other));
    for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++) {
      check_near(other->displacement[i], own->displacement[i], 1e-14);
      check_near(other->reaction[i], own->reaction[i], 1e-6);
    }
    assert_null(other->system);
    assert_null(own->external);
    assert_int_equal(other->external->ranks, 1);
    assert_string_equal(other->report.solver, "pcg");
    assert_string_equal(other->report.preconditioner, "amg");
    assert_string_equal(other->report.backend, "petsc");
    check_ok(context, bw_modes_elastic(context, own->system, &opts, &modes));
    check_ok(context, external_modes(context, model, &opts, &others));
    assert_int_equal(others->count, 4);
    assert_int_equal(others->rigid_count, fixed ? 0 : 6);
    for (int k = 0; k < 4; k++) {
      check_near(others->frequency[k], modes->frequency[k], 0);
      check_near(others->residual[k], modes->residual[k], 1e-9);
    }
    bw_release(own);
    bw_release(other);
    bw_release(modes);
    bw_release(others);
    bw_release(model);
  }
  assert_int_equal(fake.opened, fake.closed);
  bw_external_register(NULL);
}

/* The engine refines what it is given, with its own residuals, and does not believe the rest. */
static void test_lies(void **state) {
  bw_context *context = check_context(state);
  begin();
  bw_model *model = cantilever(context, true);
  bw_static *result = NULL;
  fake.scale = 1 - 1e-4; /* two more passes leave 1e-12 */
  check_ok(context, statics(context, model, false, &result));
  assert_true(result->residual < 1e-10);
  assert_int_equal(fake.solves, 3);
  bw_release(result);
  result = NULL;
  fake.scale = 0.5;
  check_fails(context, BW_CONVERGENCE, "the residual of the solution is",
              statics(context, model, false, &result));
  assert_null(result);
  fake.scale = NAN;
  check_fails(context, BW_SINGULAR, "not finite", statics(context, model, false, &result));
  assert_int_equal(fake.opened, fake.closed);
  fake.scale = 1;
  fake.status = BW_LIMIT;
  check_fails(context, BW_LIMIT, "the fake has failed", statics(context, model, false, &result));
  assert_int_equal(fake.opened, fake.closed + 1); /* it has closed itself */
  bw_release(model);
  bw_external_register(NULL);
}

/* Equations for many right-hand sides: the solver has one system at a time, and opens it again. */
static void test_many_right_hand_sides(void **state) {
  bw_context *context = check_context(state);
  begin();
  enum { COUNT = 3 };
  bw_solver *solver = NULL;
  const bw_solver_options options = {.backend = BW_BACKEND_PETSC};
  check_ok(context, bw_solver_create(context, &options, &solver));
  for (int fixed = 0; fixed < 2; fixed++) {
    bw_model *model = cantilever(context, fixed);
    bw_system *own = NULL, *system = NULL, *second = NULL;
    bw_modes *modes = NULL, *others = NULL;
    int64_t size = 3 * (int64_t)model->mesh->node_count;
    double *force = BW_NEW(context, double, COUNT *size),
           *u = BW_NEW(context, double, 2 * COUNT * size);
    for (int64_t i = 0; i < COUNT * size; i++)
      force[i] = (double)((i * 7919) % 101) - 50;
    check_ok(context, bw_system_of_model(context, model, NULL, NULL, &own));
    check_ok(context, bw_system_of_model(context, model, solver, own, &system));
    assert_null(system->pattern);
    assert_int_equal(fake.opened, fake.closed);
    check_ok(context, bw_system_solve(context, own, COUNT, force, u));
    memcpy(u + COUNT * size, force, (size_t)(COUNT * size) * sizeof *u);
    check_ok(context, bw_system_solve(context, system, COUNT, u + COUNT * size, u + COUNT * size));
    for (int64_t i = 0; i < COUNT * size; i++)
      check_near(u[COUNT * size + i], u[i], 1e-14);
    assert_string_equal(system->report.backend, "petsc");
    assert_int_equal(system->external_report->ranks, 1);

    int opened = fake.opened;
    check_ok(context, bw_system_of_model(context, model, solver, system, &second));
    assert_ptr_equal(second, system);
    bw_release(second);
    check_ok(context, bw_system_of_model(context, model, solver, NULL, &second));
    check_ok(context, bw_system_solve(context, second, 1, force, u));
    assert_int_equal(fake.closed, fake.opened - 1);
    check_ok(context, bw_system_solve(context, system, 1, force, u));
    assert_int_equal(fake.opened, opened + 2);
    bw_release(second);
    const bw_modes_options opts = {.count = 3, .tolerance = 1e-8, .seed = 1};
    check_ok(context, bw_modes_of_model(context, model, own, &opts, NULL, &modes));
    check_ok(context, bw_modes_of_model(context, model, system, &opts, NULL, &others));
    assert_string_equal(others->report.solver, "slepc");
    for (int k = 0; k < 3; k++)
      check_near(others->frequency[k], modes->frequency[k], 1e-6 * modes->frequency[k]);

    bw_static *result = NULL; /* its own equations */
    const bw_statics_options relief = {.inertia_relief = true};
    check_ok(context, bw_statics(context, model, system, &relief, &result));
    assert_string_equal(result->report.backend, "multifrontal");
    bw_sparse_matrix *matrix = NULL;
    check_fails(context, BW_UNSUPPORTED, "spread over several processes",
                bw_system_matrix(context, system, BW_STIFFNESS, false, &matrix));
    check_fails(context, BW_UNSUPPORTED, "spread over several processes",
                bw_system_factor(context, system));
    fake.status = BW_LIMIT;
    check_fails(context, BW_LIMIT, "the fake has failed",
                bw_system_solve(context, system, 1, force, u));
    fake.closed++; /* by itself */
    fake.status = BW_OK;
    check_ok(context, bw_system_solve(context, system, 1, force, u));
    bw_release(system);
    assert_int_equal(fake.opened, fake.closed);
    bw_release(result);
    bw_release(modes);
    bw_release(others);
    bw_release(own);
    bw_release(model);
    bw_free(force);
    bw_free(u);
  }
  bw_release(solver);
  bw_external_register(NULL);
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = cantilever(context, true);
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  check_fails(context, BW_UNSUPPORTED, "barwright.distributed",
              statics(context, model, false, &result));
  check_fails(context, BW_UNSUPPORTED, "barwright.distributed",
              external_modes(context, model, NULL, &modes));
  begin();
  bw_solver *amg = NULL;
  const bw_solver_options alone = {.kind = BW_SOLVER_AMG, .backend = BW_BACKEND_PETSC};
  check_ok(context, bw_solver_create(context, &alone, &amg));
  const bw_statics_options by_amg = {.solver = amg};
  check_fails(context, BW_INVALID, "is a preconditioner",
              bw_statics(context, model, NULL, &by_amg, &result));
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = BW_EIGENSOLVER_SLEPC;
  const bw_solver own = {.options = {.kind = BW_SOLVER_CHOLESKY}},
                  over_levels = {.options = {.kind = BW_SOLVER_PCG}};
  const bw_solver *const refused[] = {amg, &own, &over_levels};
  for (int k = 0; k < 3; k++) {
    options.inner = refused[k];
    check_fails(context, BW_INVALID, "does not serve SLEPc",
                bw_eigensolver_create(context, &options, &solver));
  }
  bw_release(amg);
  assert_int_equal(fake.opened, 0);
  bw_release(model);
  bw_model *free_model = cantilever(context, false);
  check_fails(context, BW_UNCONSTRAINED, "not in equilibrium",
              statics(context, free_model, false, &result));
  bw_release(free_model);
  bw_external_register(NULL);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  begin();
  bw_model *model = cantilever(context, true);
  const bw_modes_options opts = {.count = 2, .tolerance = 1e-8, .seed = 1};
  for (int what = 0; what < 2; what++) {
    check_each_allocation(context, status, 1) {
      bw_static *result = NULL;
      bw_modes *modes = NULL;
      status = what == 0 ? statics(context, model, false, &result)
                         : external_modes(context, model, &opts, &modes);
      bw_release(result);
      bw_release(modes);
    }
  }
  bw_release(model);
  bw_external_register(NULL);
}

check_main(check_test(test_same_answers), check_test(test_lies),
           check_test(test_many_right_hand_sides), check_test(test_misuse), check_test(test_memory))
