/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Equations for many right-hand sides by each solver that claims to serve them: the factor's
 * solutions to the tolerance, its modes, the same bits on any number of threads, symmetric
 * operators on free bodies; what changes how a system is solved; what is refused; cancelled runs
 * and failing allocations. */
#include "bar.h"
#include "linear/system_solver.h"

typedef struct row {
  bw_solver_options options, preconditioner; /* the second: of pcg */
  const char *solver, *inner;
} row;

static const row rows[] = {
    {{.kind = BW_SOLVER_CHOLESKY}, {0}, "cholesky", ""},
    {{.backend = BW_BACKEND_CHOLMOD}, {0}, "cholesky", ""},
    {{.precision = 32}, {0}, "cholesky", ""},
    {{.kind = BW_SOLVER_PCG}, {.kind = BW_SOLVER_TWO_LEVEL}, "pcg", "two_level"},
    {{.kind = BW_SOLVER_PCG, .tolerance = 1e-10}, {.kind = BW_SOLVER_AMG}, "pcg", "amg"},
    {{.kind = BW_SOLVER_PCG, .tolerance = 1e-10}, {.kind = BW_SOLVER_JACOBI}, "pcg", "jacobi"},
    {{.kind = BW_SOLVER_PCG}, {.kind = BW_SOLVER_CHOLESKY, .precision = 32}, "pcg", "cholesky"}};
enum { ROWS = sizeof rows / sizeof *rows, SIDES = 11, MODES = 4 };

static bw_material *wood(bw_context *context) {
  bw_material *material = NULL;
  bw_orthotropic constants = {.name = "wood",
                              .young = {10e9, 0.8e9, 0.5e9},
                              .poisson = {0.3, 0.02, 0.35},
                              .shear = {0.05e9, 0.7e9, 0.6e9},
                              .density = 700};
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  return material;
}

static bw_model *make_model(bw_context *context, int scene, bool orthotropic, int cells,
                            int order) {
  bw_mesh *mesh = body_box(context, 3, 1.1, 0.9, 2 * cells, cells, cells, order);
  bw_material *material = orthotropic ? wood(context) : body_material(context);
  bw_model *model = bar_model(context, mesh, material, scene);
  bw_release(material);
  bw_release(mesh);
  return model;
}

/* The largest |a - b|_K / |b|_K of all fields. */
static double energy_error(bw_context *context, const bw_system *system, const double *a,
                           const double *b) {
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  double *difference = numbers(2 * size), *product = numbers(2 * size), worst = 0;
  for (int k = 0; k < SIDES; k++) {
    for (int64_t i = 0; i < size; i++) {
      difference[i] = a[k * size + i] - b[k * size + i];
      difference[size + i] = b[k * size + i];
    }
    check_ok(context, bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, 2,
                                        difference, product));
    double error = 0, whole = 0;
    for (int64_t i = 0; i < size; i++) {
      error += difference[i] * product[i];
      whole += difference[size + i] * product[size + i];
    }
    worst = fmax(worst, sqrt(fmax(0, error) / whole));
  }
  free(difference);
  free(product);
  return worst;
}

/* Over the largest number. */
static double largest_difference(const double *a, const double *b, int64_t count) {
  double difference = 0, largest = 0;
  for (int64_t i = 0; i < count; i++) {
    difference = fmax(difference, fabs(a[i] - b[i]));
    largest = fmax(largest, fabs(b[i]));
  }
  return difference / largest;
}

static bw_modes *lowest(bw_context *context, bw_system *system) {
  bw_modes_options options;
  bw_modes *modes = NULL;
  bw_modes_options_default(&options);
  options.count = MODES;
  options.sturm = !system->iterative;
  check_ok(context, bw_modes_elastic(context, system, &options, &modes));
  return modes;
}

static void check_report(const bw_system *system, const row *r) {
  const bw_solver_report *report = &system->report;
  bool iterates = r->inner[0] || r->options.precision == 32;
  assert_string_equal(report->solver, r->solver);
  assert_string_equal(report->preconditioner, r->inner);
  assert_string_equal(report->reason, "it was given");
  assert_true(report->bytes > 0 && report->seconds > 0);
  assert_true((report->iterations > 0) == iterates);
  assert_true((report->residual > 0) == iterates && report->residual < 1e-6);
  assert_true(system->iterative == iterates);
  assert_true((bwi_solve_tolerance(system) > 0) == iterates);
}

/* Solutions and modes by one row against the factor's; in place and not. */
static void compare(bw_context *context, const bw_model *model, const row *r, bw_system *factored,
                    const double *force, const double *expected, const bw_modes *modes) {
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *u[2] = {numbers(SIDES * size), numbers(SIDES * size)};
  bw_solver *solver = body_solver_over(context, r->options, r->preconditioner);
  for (int threads = 1; threads <= 2; threads++) {
    bw_system *system = NULL;
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, bw_system_of_model(context, model, solver, NULL, &system));
    assert_non_null(system->mass);
    memcpy(u[threads - 1], force, (size_t)(SIDES * size) * sizeof(double));
    const double *from = threads == 1 ? force : u[1];
    check_ok(context, bw_system_solve(context, system, SIDES, from, u[threads - 1]));
    check_report(system, r);
    double error = energy_error(context, factored, u[threads - 1], expected);
    assert_true(error <= fmax(1e-12, bwi_solve_tolerance(system)));
    assert_true(largest_difference(u[threads - 1], expected, SIDES * size) < 1e-6);
    if (threads == 1 || r->options.backend != BW_BACKEND_CHOLMOD)
      assert_true(threads == 1 || memcmp(u[0], u[1], (size_t)(SIDES * size) * sizeof(double)) == 0);
    if (threads == 1 && r->preconditioner.kind != BW_SOLVER_JACOBI) { /* that takes too long */
      bw_modes *found = lowest(context, system);
      for (int m = 0; m < MODES; m++)
        check_near(found->eigenvalue[m] / modes->eigenvalue[m], 1, 1e-8);
      assert_true(found->counted || system->iterative);
      bw_release(found);
    }
    bw_release(system);
  }
  bw_release(solver);
  free(u[0]);
  free(u[1]);
}

/* Two-level PCG on straight tet10 of one material has no stiffness. What multiplies in its place is
 * what the stiffness does; that is made where a matrix is asked for. */
static void products_without_stiffness(bw_context *context, const bw_model *model) {
  enum { FIELDS = 14 };
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *x = numbers(FIELDS * size), *by_elements = numbers(FIELDS * size),
         *by_blocks = numbers(FIELDS * size), noise[2];
  bw_system *system = NULL;
  bw_solver *solver = NULL;
  bw_sparse_matrix *matrix = NULL;
  for (int64_t i = 0; i < FIELDS * size; i++)
    x[i] = sin(1.0 + 0.37 * (double)i);
  check_ok(context,
           bw_solver_create(context, &(bw_solver_options){.kind = BW_SOLVER_PCG}, &solver));
  check_ok(context, bw_system_of_model(context, model, solver, NULL, &system));
  assert_null(system->stiffness);
  size_t bytes = bw_bytes(system);
  check_ok(context, bwi_system_multiply(context, system, 1, x, by_elements, &noise[0]));
  check_ok(context, bwi_system_multiply(context, system, FIELDS, x, by_elements, NULL));
  assert_null(system->stiffness);
  check_ok(context, bw_system_matrix(context, system, BW_STIFFNESS, false, &matrix));
  assert_non_null(system->stiffness);
  assert_int_equal(bw_bytes(system), bytes + 72 * (size_t)system->pattern->block_count);
  check_ok(context, bwi_system_multiply(context, system, FIELDS, x, by_blocks, &noise[1]));
  assert_true(largest_difference(by_elements, by_blocks, FIELDS * size) < 1e-13);
  check_near(noise[0] / noise[1], 1, 1e-12);
  bw_release(matrix);
  bw_release(system);
  bw_release(solver);
  free(x);
  free(by_elements);
  free(by_blocks);
}

static double dot(int64_t size, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < size; i++)
    sum += a[i] * b[i];
  return sum;
}

/* f . K^+ g = g . K^+ f, to the tolerance. */
static void check_symmetry(const double *force, const double *u, int64_t size) {
  double one = dot(size, force, u + size), other = dot(size, force + size, u);
  double scale = sqrt(dot(size, force, u) * dot(size, force + size, u + size));
  check_near(one, other, 1e-10 * scale);
}

static void every_solver(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++)
    for (int kind = 0; kind < 3; kind++) {
      int order = kind < 2 ? 2 : 1;
      bw_model *model = make_model(context, scene, kind != 1, 5 - order, order);
      int64_t size = 3 * (int64_t)model->mesh->node_count;
      double *force = numbers(SIDES * size), *u = numbers(SIDES * size);
      bw_system *factored = NULL;
      random_field(5 + (uint64_t)scene, SIDES * size, force);
      check_ok(context, bw_system_of_model(context, model, NULL, NULL, &factored));
      assert_string_equal(factored->report.reason, "a factor serves many right-hand sides");
      check_ok(context, bw_system_solve(context, factored, SIDES, force, u));
      check_symmetry(force, u, size);
      bw_modes *modes = lowest(context, factored);
      for (int k = 0; k < ROWS; k++)
        if (order == 2 || strcmp(rows[k].inner, "two_level") != 0)
          compare(context, model, &rows[k], factored, force, u, modes);
      if (order == 2)
        products_without_stiffness(context, model);
      bw_release(modes);
      bw_release(factored);
      bw_release(model);
      free(force);
      free(u);
    }
}

/* Where a model prescribes other displacements its equations have these, with the same matrices and
 * factor. Those that it had stay as they are. */
static void other_displacements(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = make_model(context, FREE, false, 2, 2);
  const bw_mesh *mesh = model->mesh;
  const double x[3] = {1, 0, 0}, origin[3] = {0, 0, 0}, far[3] = {3, 0, 0};
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *force = numbers(size), *b = numbers(size), *u = numbers(size);
  bw_selection *left = NULL, *right = NULL;
  bw_system *system[4] = {NULL};
  check_ok(context, bw_select_plane(context, mesh, origin, x, 1e-9, &left));
  check_ok(context, bw_select_plane(context, mesh, far, x, 1e-9, &right));
  for (int64_t i = 0; i < size; i++)
    force[i] = 0;
  for (int k = 0; k < 4; k++) { /* 0, 1 and 2 mm, and 2 mm by PCG */
    bw_solver *solver = NULL;
    bw_static *result = NULL;
    if (k == 3)
      check_ok(context,
               bw_solver_create(context, &(bw_solver_options){.kind = BW_SOLVER_PCG}, &solver));
    bw_model_clear_supports(model);
    check_ok(context, bw_model_fix(context, model, left));
    check_ok(context, bw_model_prescribe(context, model, right, (bool[3]){true, true, true},
                                         (double[3]){1e-3 * (k < 3 ? k : 2), 0, 0}));
    check_ok(context,
             bw_system_of_model(context, model, solver, k ? system[k - 1] : NULL, &system[k]));
    assert_int_equal(system[k]->dof_map->prescribed, k > 0);
    assert_int_equal(system[k]->pattern == system[0]->pattern, 1);
    assert_ptr_equal(system[k]->factor, system[0]->factor);
    check_ok(context, bw_statics(context, model, NULL, NULL, &result));
    check_ok(context, bw_system_right_hand_side(context, system[k], force, b));
    for (int64_t i = 0; i < size; i++) { /* K x = b, from a field of forces at the unknowns */
      int32_t unknown = system[k]->dof_map->unknown[i];
      u[i] = unknown < 0 ? 0 : b[unknown];
    }
    check_ok(context, bw_system_solve(context, system[k], 1, u, u));
    for (int64_t i = 0; i < size; i++) {
      int32_t unknown = system[k]->dof_map->unknown[i];
      if (unknown >= 0)
        b[unknown] = u[i];
    }
    bw_system_displacement(system[k], b, u);
    for (int64_t i = 0; i < size; i++)
      check_near(u[i], result->displacement[i], 1e-9);
    bw_release(result);
    bw_release(solver);
  }
  assert_ptr_equal(system[0]->stiffness, system[2]->stiffness);
  assert_ptr_equal(system[2], system[3]);
  for (int k = 0; k < 3; k++) { /* each keeps what it was made for */
    bw_system_displacement(system[k], b, u);
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (mesh->node[3 * i] > 3 - 1e-9)
        check_near(u[3 * i], 1e-3 * k, 1e-18);
    bw_release(system[k]); /* those that are left hold what they share */
  }
  bw_release(system[3]);
  bw_release(left);
  bw_release(right);
  bw_release(model);
  free(force);
  free(b);
  free(u);
}

/* How one system is solved may change: each request is met, and the solutions stay. */
static void one_system(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = make_model(context, HELD, false, 2, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *force = numbers(size), *u = numbers(size), *first = numbers(size);
  bw_system *system = NULL;
  random_field(1, size, force);
  check_ok(context, bw_system_of_model(context, model, NULL, NULL, &system));
  check_ok(context, bw_system_solve(context, system, 1, force, first));
  for (int k = 0; k < 2 * ROWS; k++) {
    bw_solver *solver =
        body_solver_over(context, rows[k % ROWS].options, rows[k % ROWS].preconditioner);
    bw_system *same = NULL;
    check_ok(context, bw_system_of_model(context, model, solver, system, &same));
    assert_ptr_equal(same, system);
    check_ok(context, bw_system_solve(context, system, 1, force, u));
    assert_string_equal(system->report.solver, rows[k % ROWS].solver);
    assert_string_equal(system->report.preconditioner, rows[k % ROWS].inner);
    assert_true(largest_difference(u, first, size) < 1e-6);
    bw_static *result = NULL; /* leaves the equations as they are */
    const double gravity[3] = {0, 0, -9.81};
    if (k == 0)
      check_ok(context, bw_model_gravity(context, model, gravity));
    bool iterates = system->iterative && !system->factor;
    check_ok(context, bw_statics(context, model, system, NULL, &result));
    assert_int_equal(strstr(result->report.reason, "earlier solution is left") != NULL, iterates);
    check_ok(context, bw_system_solve(context, system, 1, force, u));
    bw_release(result);
    bw_release(solver);
    bw_release(same);
  }
  bw_release(system);
  bw_release(model);
  free(force);
  free(u);
  free(first);
}

/* What may happen to a system's preconditioner: a static solution without memory for a factor, by
 * itself or since a factor is asked for; another preconditioner that could not be made. */
static void disturb(bw_context *context, const bw_model *model, bw_system *system, int how) {
  bw_static *result = NULL;
  bw_solver *factor = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  const bw_statics_options little = {.solver = how == 1 ? factor : NULL, .memory = 1e4};
  if (how == 0)
    check_ok(context, bw_statics(context, model, system, &little, &result));
  else if (how == 1)
    check_fails(context, BW_MEMORY, "the solver pcg",
                bw_statics(context, model, system, &little, &result));
  else {
    bw_release(system->preconditioner);
    system->preconditioner = NULL;
  }
  bw_release(result);
  bw_release(factor);
}

/* Then the system is solved as before. */
static void without_memory_for_a_factor(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = make_model(context, HELD, false, 2, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *force = numbers(size), *u = numbers(size), *first = numbers(size);
  const double gravity[3] = {0, 0, -9.81};
  random_field(1, size, force);
  check_ok(context, bw_model_gravity(context, model, gravity));
  for (int k = 0; k < ROWS; k++) {
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    bw_system *system = NULL;
    check_ok(context, bw_system_of_model(context, model, solver, NULL, &system));
    check_ok(context, bw_system_solve(context, system, 1, force, first));
    for (int how = 0; system->iterative && how < 3; how++) {
      disturb(context, model, system, how);
      if (rows[k].preconditioner.kind != BW_SOLVER_JACOBI) /* that takes too long */
        bw_release(lowest(context, system));
      check_ok(context, bw_system_solve(context, system, 1, force, u));
      assert_true(system->iterative && !system->factor);
      assert_memory_equal(u, first, (size_t)size * sizeof *u);
    }
    check_ok(context, bw_system_factor(context, system));
    assert_true(system->factor && !system->iterative && !system->preconditioner);
    assert_string_equal(system->report.solver, "cholesky");
    assert_string_equal(system->report.preconditioner, "");
    bw_release(system);
    bw_release(solver);
  }
  bw_release(model);
  free(force);
  free(u);
  free(first);
}

/* Where nothing was asked for, a factor takes the place of iterations that do not converge: here of
 * a nearly incompressible body, after as many as the factor costs. In place and not, in two blocks.
 */
static void a_factor_in_place_of_iterations(void **state) {
  bw_context *context = check_context(state);
  const bw_isotropic rubber = {.name = "rubber", .young = 1e6, .poisson = 0.4999, .density = 1e3};
  const double origin[3] = {0, 0, 0}, x[3] = {1, 0, 0};
  bw_mesh *mesh = body_box(context, 3, 1.1, 0.9, 6, 3, 3, 2);
  bw_material *material = NULL;
  bw_model *model = NULL;
  bw_selection *end = NULL;
  check_ok(context, bw_material_isotropic(context, &rubber, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, x, 1e-9, &end));
  check_ok(context, bw_model_fix(context, model, end));
  bw_release(end);
  bw_release(material);
  bw_release(mesh);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *first = numbers(SIDES * size);
  bw_system *system = NULL, *factored = NULL;
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  random_field(3, SIDES * size, force);
  check_ok(context, bw_system_of_model(context, model, NULL, NULL, &factored));
  check_ok(context, bw_system_solve(context, factored, SIDES, force, first));
  for (int in_place = 0; in_place < 2; in_place++) {
    check_ok(context, bw_system_of_model(context, model, pcg, NULL, &system));
    bw_release(system->solver); /* as where a factor was too large */
    system->solver = NULL;
    bw_clear_warnings(context);
    memcpy(u, force, (size_t)(SIDES * size) * sizeof *u);
    check_ok(context, bw_system_solve(context, system, SIDES, in_place ? u : force, u));
    assert_true(system->factor && !system->iterative);
    assert_string_equal(system->report.solver, "cholesky");
    assert_string_equal(system->report.reason, "two-level PCG did not converge");
    assert_non_null(strstr(bw_warning_at(context, 0), "a Cholesky factorisation gives"));
    assert_true(largest_difference(u, first, SIDES * size) < 1e-10);
    bw_release(system);
  }
  bw_clear_warnings(context);
  bw_release(pcg);
  bw_release(factored);
  bw_release(model);
  free(force);
  free(u);
  free(first);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = make_model(context, HELD, false, 1, 2);
  bw_mesh *linear = body_box(context, 3, 1, 1, 2, 2, 2, 1);
  bw_model *other = NULL;
  bw_system *system = NULL;
  bw_modes *modes = NULL;
  check_ok(context, bw_model_create(context, linear, model->material, &other));
  bw_solver *jacobi = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *spread = body_solver(context, (bw_solver_options){.backend = BW_BACKEND_PETSC});
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  bw_solver *few =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .max_iterations = 2});
  check_fails(context, BW_INVALID, "preconditioner and no solver",
              bw_system_of_model(context, model, jacobi, NULL, &system));
  check_fails(context, BW_UNSUPPORTED, "no external solver",
              bw_system_of_model(context, model, spread, NULL, &system));
  check_fails(context, BW_INVALID, "quadratic",
              bw_system_of_model(context, other, pcg, NULL, &system));
  check_ok(context, bw_system_of_model(context, model, few, NULL, &system));
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *u = numbers(size);
  random_field(1, size, u);
  check_fails(context, BW_CONVERGENCE, "in 2 iterations",
              bw_system_solve(context, system, 1, u, u));
  bw_eigensolver *lanczos = NULL;
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  how.kind = BW_EIGENSOLVER_LANCZOS;
  check_ok(context, bw_eigensolver_create(context, &how, &lanczos));
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.solver = lanczos;
  check_fails(context, BW_INVALID, "needs a factor",
              bw_modes_elastic(context, system, &options, &modes));
  free(u);
  bw_release(lanczos);
  bw_release(system);
  bw_release(few);
  bw_release(pcg);
  bw_release(spread);
  bw_release(jacobi);
  bw_release(other);
  bw_release(linear);
  bw_release(model);
}

static void stop(void *data, const char *stage, double fraction) {
  (void)fraction;
  if (strcmp(stage, "factorisation") == 0 || strcmp(stage, "conjugate gradients") == 0)
    bw_cancel(data);
}

static bw_status solve_once(bw_context *context, const bw_model *model, const bw_solver *solver,
                            double *u) {
  bw_system *system = NULL;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  random_field(1, 9 * size, u);
  bw_status status = bw_system_of_model(context, model, solver, NULL, &system);
  if (status == BW_OK)
    status = bw_system_solve(context, system, 9, u, u);
  bw_release(system);
  return status;
}

static void cancelling_and_memory(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = make_model(context, HELD, false, 1, 2);
  double *u = numbers(9 * 3 * (int64_t)model->mesh->node_count);
  check_ok(context, bw_set_threads(context, 1));
  for (int k = 0; k < ROWS; k++) {
    bw_solver *solver = body_solver_over(context, rows[k].options, rows[k].preconditioner);
    bw_set_progress(context, stop, context);
    check_fails(context, BW_CANCELLED, "cancel", solve_once(context, model, solver, u));
    bw_clear_cancel(context);
    bw_set_progress(context, NULL, NULL);
    check_each_allocation(context, status, 1) {
      status = solve_once(context, model, solver, u);
    }
    bw_release(solver);
  }
  free(u);
  bw_release(model);
}

check_main(check_test(every_solver), check_test(one_system), check_test(other_displacements),
           check_test(without_memory_for_a_factor), check_test(a_factor_in_place_of_iterations),
           check_test(refusals), check_test(cancelling_and_memory))
