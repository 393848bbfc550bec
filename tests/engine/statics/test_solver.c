/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear solvers: every one that claims to serve static solutions gives the same, under each kind
 * of support; factors of each backend serve modes; what a description refuses and how it reads;
 * what is reported and reused. */
#include "incremental_bar.h"
#include "linear/pcg.h"

/* Each solver of a body that is held: how it is described and reported. */
typedef struct row {
  bw_solver_options options, preconditioner; /* the second: of pcg */
  const char *text, *solver, *backend, *inner;
} row;

static const row rows[] = {
    {{.kind = BW_SOLVER_CHOLESKY}, {0}, "cholesky", "cholesky", "multifrontal", ""},
    {{.backend = BW_BACKEND_MULTIFRONTAL, .ordering = BW_ORDERING_AMD},
     {0},
     "cholesky (multifrontal, ordering amd)",
     "cholesky",
     "multifrontal",
     ""},
    {{.precision = 32}, {0}, "cholesky (32 bits)", "cholesky", "multifrontal", ""},
    {{.backend = BW_BACKEND_CHOLMOD}, {0}, "cholesky (cholmod)", "cholesky", "cholmod", ""},
    {{.backend = BW_BACKEND_CHOLMOD, .ordering = BW_ORDERING_BACKEND},
     {0},
     "cholesky (cholmod, ordering backend)",
     "cholesky",
     "cholmod",
     ""},
    {{.backend = BW_BACKEND_CHOLMOD, .ordering = BW_ORDERING_AMD},
     {0},
     "cholesky (cholmod, ordering amd)",
     "cholesky",
     "cholmod",
     ""},
    {{.kind = BW_SOLVER_PCG, .max_iterations = 200},
     {.kind = BW_SOLVER_TWO_LEVEL},
     "pcg (two_level, at most 200 iterations)",
     "pcg",
     "",
     "two_level"},
    {{.kind = BW_SOLVER_PCG, .tolerance = 1e-11},
     {.kind = BW_SOLVER_AMG},
     "pcg (amg, tolerance 1e-11)",
     "pcg",
     "",
     "amg"},
    {{.kind = BW_SOLVER_PCG, .tolerance = 1e-11},
     {.kind = BW_SOLVER_JACOBI},
     "pcg (jacobi, tolerance 1e-11)",
     "pcg",
     "",
     "jacobi"},
    {{.kind = BW_SOLVER_PCG},
     {.kind = BW_SOLVER_CHOLESKY, .precision = 32},
     "pcg (cholesky (32 bits))",
     "pcg",
     "multifrontal",
     "cholesky"},
    {{.kind = BW_SOLVER_PCG},
     {.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_CHOLMOD},
     "pcg (cholesky (cholmod))",
     "pcg",
     "cholmod",
     "cholesky"}};
enum { ROWS = sizeof rows / sizeof *rows };

/* Displacements, reactions, energy and modes of one body by every solver. */
static void compare_solvers(bw_context *context, const bw_model *model, bool is_free) {
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  bw_static *expected = NULL;
  bw_modes *modes = NULL;
  bw_statics_options options = {.inertia_relief = is_free};
  check_ok(context, bw_statics(context, model, NULL, &options, &expected));
  check_ok(context, bw_modes_elastic(context, expected->system, NULL, &modes));
  for (int k = 0; k < ROWS; k++) {
    bw_static *result = NULL;
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    options.solver = solver;
    check_ok(context, bw_statics(context, model, NULL, &options, &result));
    check_near(difference(result->displacement, expected->displacement, size), 0, 1e-8);
    check_near(difference(result->reaction, expected->reaction, size), 0, 1e-8);
    check_near(result->energy / expected->energy, 1, 1e-8);
    assert_string_equal(result->report.solver, rows[k].solver);
    assert_string_equal(result->report.backend, rows[k].backend);
    assert_string_equal(result->report.preconditioner, rows[k].inner);
    assert_string_equal(result->report.reason, "it was given");
    assert_true(result->report.bytes > 0 && result->report.seconds > 0);
    assert_true(result->report.residual == result->residual);
    bool iterates = rows[k].inner[0] || rows[k].options.precision == 32;
    assert_true((result->report.iterations > 0) == iterates);
    assert_true(result->report.reused == 0);
    bw_static *again = NULL; /* what is there serves again */
    check_ok(context, bw_statics(context, model, result->system, &options, &again));
    assert_true(again->report.reused == 1);
    assert_memory_equal(again->displacement, result->displacement, (size_t)size * sizeof(double));
    bw_release(again);
    if (result->system->factor) {
      bw_modes *same = NULL;
      check_ok(context, bw_modes_elastic(context, result->system, NULL, &same));
      assert_int_equal(same->count, modes->count);
      assert_true(same->counted);
      for (int m = 0; m < modes->count; m++)
        check_near(same->eigenvalue[m] / modes->eigenvalue[m], 1, 1e-8);
      bw_release(same);
    }
    bw_release(result);
    bw_release(solver);
  }
  bw_release(modes);
  bw_release(expected);
}

static void all_solvers(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    compare_solvers(context, b.model, scene == 3);
    bar_clear(&b);
  }
}

/* A factor of one backend takes the place of another's, with the equations kept. */
static void other_backend(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_static *first = NULL, *second = NULL, *third = NULL;
  bw_solver *cholmod = body_solver(context, (bw_solver_options){.backend = BW_BACKEND_CHOLMOD});
  bw_solver *any = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_statics_options options = {.solver = cholmod};
  check_ok(context, bw_statics(context, b.model, NULL, NULL, &first));
  check_ok(context, bw_statics(context, b.model, first->system, &options, &second));
  assert_ptr_equal(second->system, first->system);
  assert_string_equal(second->report.backend, "cholmod");
  assert_true(second->report.reused == 0);
  options.solver = any; /* takes the one that is there */
  check_ok(context, bw_statics(context, b.model, first->system, &options, &third));
  assert_string_equal(third->report.backend, "cholmod");
  assert_true(third->report.reused == 1);
  bw_release(first);
  bw_release(second);
  bw_release(third);
  bw_release(cholmod);
  bw_release(any);
  bar_clear(&b);
}

static void descriptions(void **state) {
  bw_context *context = check_context(state);
  char text[BW_SOLVER_TEXT];
  bw_solver_describe(NULL, text);
  assert_string_equal(text, "auto");
  for (int k = 0; k < ROWS; k++) {
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    bw_solver_describe(solver, text);
    assert_string_equal(text, rows[k].text);
    bw_release(solver);
  }
}

/* Where a factor in single precision lacks digits, the one in its place has the ordering that was
 * given. */
static void wide_in_place_of_single(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  b.now.scale[1][1] = b.now.scale[1][2] = 0.01;
  bw_mesh *mesh = NULL;
  bw_model *model = NULL;
  follow(&b);
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &mesh));
  check_ok(context, bw_model_moved(context, b.model, mesh, &model));
  for (int k = 0; k < 2; k++) {
    bw_ordering ordering = k ? BW_ORDERING_AMD : BW_ORDERING_METIS;
    bw_solver *single =
        body_solver(context, (bw_solver_options){.precision = 32, .ordering = ordering});
    const bw_statics_options options = {.solver = single};
    bw_static *result = NULL;
    bw_clear_warnings(context);
    check_ok(context, bw_statics(context, model, NULL, &options, &result));
    assert_non_null(bw_warning_at(context, 0));
    assert_non_null(strstr(bw_warning_at(context, 0), "lacks digits"));
    assert_int_equal(result->system->factor->symbolic->order->ordering, ordering);
    assert_int_equal(result->system->factor->kernels->bits, 64);
    bw_release(result);
    bw_release(single);
  }
  bw_clear_warnings(context);
  bw_release(model);
  bw_release(mesh);
  bar_clear(&b);
}

/* Of unsymmetric equations: nothing else takes them. */
static void unsymmetric(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  bw_static *result = NULL;
  bw_solver *lu = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_LU, .full = true}),
            *wrong = NULL;
  bw_solver *bicgstab = body_solver(
      context,
      (bw_solver_options){.kind = BW_SOLVER_BICGSTAB, .preconditioner = lu, .tolerance = 1e-9});
  char text[BW_SOLVER_TEXT];
  bw_solver_describe(bicgstab, text);
  assert_string_equal(text, "bicgstab (lu (full refactorisation), tolerance 1e-09)");
  bw_statics_options options = {.solver = lu};
  check_fails(context, BW_INVALID, "\"lu\" is for the unsymmetric equations",
              bw_statics(context, b.model, NULL, &options, &result));
  options.solver = bicgstab;
  check_fails(context, BW_INVALID, "\"bicgstab\" is for the unsymmetric equations",
              bw_statics(context, b.model, NULL, &options, &result));
  const bw_solver_options pcg = {.kind = BW_SOLVER_PCG, .preconditioner = lu},
                          other = {.kind = BW_SOLVER_BICGSTAB, .preconditioner = bicgstab},
                          ordered = {.kind = BW_SOLVER_LU, .ordering = BW_ORDERING_AMD};
  check_fails(context, BW_INVALID, "not symmetric", bw_solver_create(context, &pcg, &wrong));
  check_fails(context, BW_INVALID, "not linear", bw_solver_create(context, &other, &wrong));
  check_fails(context, BW_INVALID, "has no option 'ordering'",
              bw_solver_create(context, &ordered, &wrong));
  bw_release(lu);
  bw_release(bicgstab);
  bar_clear(&b);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  bw_solver *spread = body_solver(context, (bw_solver_options){.backend = BW_BACKEND_PETSC});
  bw_solver *amg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG}), *none = NULL;
  const struct {
    bw_solver_options options;
    const char *message;
  } wrong[] = {
      {{.precision = 16}, "32 or 64 bits"},
      {{.backend = BW_BACKEND_CHOLMOD, .precision = 32}, "\"cholmod\" has no factor in single"},
      {{.backend = BW_BACKEND_PETSC, .ordering = BW_ORDERING_AMD}, "takes its own"},
      {{.tolerance = 1e-3}, "\"cholesky\" has no option 'tolerance'"},
      {{.kind = BW_SOLVER_PCG, .tolerance = 1}, "between 0 and 1"},
      {{.kind = BW_SOLVER_PCG, .tolerance = NAN}, "between 0 and 1"},
      {{.kind = BW_SOLVER_PCG, .max_iterations = -1}, "at least 1"},
      {{.kind = BW_SOLVER_PCG, .backend = BW_BACKEND_CHOLMOD}, "\"pcg\" has no option 'backend'"},
      {{.kind = BW_SOLVER_PCG, .preconditioner = pcg}, "conjugate gradients as preconditioner"},
      {{.kind = BW_SOLVER_PCG, .preconditioner = spread}, "\"petsc\" has no factor that"},
      {{.kind = BW_SOLVER_JACOBI, .precision = 64}, "\"jacobi\" has no option 'precision'"},
      {{.kind = BW_SOLVER_TWO_LEVEL, .full = true}, "\"two_level\" has no option 'full'"},
      {{.kind = BW_SOLVER_AMG, .backend = BW_BACKEND_CHOLMOD}, "no algebraic multigrid"},
      {{.kind = (bw_solver_kind)9}, "is not known"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    check_fails(context, BW_INVALID, wrong[k].message,
                bw_solver_create(context, &wrong[k].options, &none));
  assert_null(none);
  bar b;
  bar_make(context, 1, 2, &b);
  load_bar(context, &b, 0);
  bw_static *result = NULL;
  bw_statics_options options = {.solver = amg};
  check_fails(context, BW_INVALID, "is a preconditioner",
              bw_statics(context, b.model, NULL, &options, &result));
  options.solver = spread;
  check_fails(context, BW_UNSUPPORTED, "barwright.distributed",
              bw_statics(context, b.model, NULL, &options, &result));
  bw_release(amg);
  bw_release(spread);
  bw_release(pcg);
  bar_clear(&b);
}

/* Two blocks in contact at an edge, one of them fixed: no solver takes rounding for stiffness. */
static void mechanism(void **state) {
  bw_context *context = check_context(state);
  const double x[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}};
  const int32_t element[8] = {0, 1, 2, 3, 1, 4, 2, 5};
  bw_mesh *linear = NULL, *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, 1, 6, x[0], 2, element, NULL, &linear));
  check_ok(context, bw_mesh_with_order(context, linear, 2, &mesh));
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *fixed = body_face(context, mesh, 0, 0);
  const double gravity[3] = {1, 2, -9.81};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, fixed));
  check_ok(context, bw_model_gravity(context, model, gravity));
  for (int k = 0; k < ROWS; k++) {
    bw_static *result = NULL;
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    const bw_statics_options options = {.solver = solver};
    bool iterates =
        rows[k].preconditioner.precision == 32 || rows[k].preconditioner.kind == BW_SOLVER_AMG;
    if (strcmp(rows[k].inner, "jacobi") != 0) { /* which has no factor to see it by */
      bw_status status = bw_statics(context, model, NULL, &options, &result);
      /* Rounding decides whether a factor in single precision, or of a coarse level, sees it. */
      assert_true(status == BW_SINGULAR || (iterates && status == BW_CONVERGENCE));
      assert_non_null(strstr(bw_message(context), status == BW_SINGULAR ? "singular" : "reached"));
    }
    bw_release(solver);
  }
  bw_release(fixed);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(linear);
}

/* A block of elements 1 km long, of which one face is fixed: stiffnesses of 1e14 N/m beside
 * prescribed components. */
static void large_elements(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 4000, 1000, 1000, 4, 1, 1, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_static *expected = NULL, *result = NULL;
  bw_selection *fixed = body_face(context, mesh, 0, 0), *loaded = body_face(context, mesh, 0, 4000);
  const double pull[3] = {1e6, 2e6, 3e6};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, fixed));
  check_ok(context, bw_model_force(context, model, loaded, pull));
  check_ok(context, bw_statics(context, model, NULL, NULL, &expected));
  bw_solver *jacobi = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *solver =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = jacobi});
  const bw_statics_options options = {.solver = solver};
  check_ok(context, bw_statics(context, model, NULL, &options, &result));
  check_near(
      difference(result->displacement, expected->displacement, 3 * (int64_t)mesh->node_count), 0,
      1e-8);
  bw_release(result);
  bw_release(expected);
  bw_release(solver);
  bw_release(jacobi);
  bw_release(fixed);
  bw_release(loaded);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* Too few iterations are reported with what was reached. */
static void too_few_iterations(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_solver *jacobi = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *solver = body_solver(
      context,
      (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = jacobi, .max_iterations = 3});
  const bw_statics_options options = {.solver = solver};
  bw_static *result = NULL;
  check_fails(context, BW_CONVERGENCE, "jacobi reached a residual of",
              bw_statics(context, b.model, NULL, &options, &result));
  bw_release(solver);
  bw_release(jacobi);
  bar_clear(&b);
}

static void stop(void *data, const char *stage, double fraction) {
  (void)fraction;
  if (strcmp(stage, "factorisation") == 0 || strcmp(stage, "conjugate gradients") == 0)
    bw_cancel(data);
}

/* Each can be cancelled, and each gives back what failed allocations leave. */
static void cancelling_and_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 2, &b);
  load_bar(context, &b, 0);
  for (int k = 0; k < ROWS; k++) {
    if (rows[k].preconditioner.kind == BW_SOLVER_TWO_LEVEL)
      continue; /* linear elements; test_static_pcg.c */
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    const bw_statics_options options = {.solver = solver};
    bw_static *result = NULL;
    bw_set_progress(context, stop, context);
    check_fails(context, BW_CANCELLED, "cancel",
                bw_statics(context, b.model, NULL, &options, &result));
    bw_clear_cancel(context);
    bw_set_progress(context, NULL, NULL);
    check_each_allocation(context, status, 1) {
      status = bw_statics(context, b.model, NULL, &options, &result);
    }
    bw_release(result);
    bw_release(solver);
  }
  bar_clear(&b);
}

check_main(check_test(all_solvers), check_test(other_backend), check_test(descriptions),
           check_test(wide_in_place_of_single), check_test(unsymmetric), check_test(refusals),
           check_test(mechanism), check_test(large_elements), check_test(too_few_iterations),
           check_test(cancelling_and_memory))
