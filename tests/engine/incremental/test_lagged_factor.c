/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems solved on factors of former matrices: the solution is that of the present matrix,
 * whatever the factor is of; what is kept is kept and said; what cannot be solved is refused. */
#include "grids.h"
#include "solver_by.h"

/* c (components) diffusing fields coupled to each other, on triangles of a unit grid whose
 * coefficient varies from element to element by `roughness`; `wind` makes it unsymmetric. */
typedef struct field {
  const bw_plane_topology *topology;
  int components;
  double roughness, phase, wind, mass;
} field;

static bw_status field_matrix(void *data, int32_t element, double *matrix) {
  const field *f = data;
  int C = f->components, rows = 3 * C;
  double k = 1 + f->roughness * sin(element + f->phase);
  memset(matrix, 0, (size_t)(rows * rows) * sizeof *matrix);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      for (int r = 0; r < C; r++)
        for (int c = 0; c < C; c++)
          matrix[(a * C + r) * rows + b * C + c] = (a == b ? 1.0 : -0.5) * k * (r == c ? 1 : 0.3) +
                                                   (a == b && r == c ? f->mass : 0) +
                                                   f->wind * (b > a   ? 0.2
                                                              : b < a ? -0.3
                                                                      : 0);
  return BW_OK;
}

typedef struct fixture {
  bw_context *context;
  bw_plane_topology *topology;
  bw_plane_pattern *pattern;
  field field;
  double *values, *rhs, *x, *y;
  size_t size;
} fixture;

static fixture set_up(bw_context *context, int n, int components, double wind, unsigned flip,
                      const bw_plane_topology *same) {
  fixture f = {.context = context};
  f.topology = grid_create(context, 1, n, flip, same);
  check_ok(context, bw_plane_pattern_create(context, f.topology, &f.pattern));
  f.size = (size_t)f.pattern->node_count * (size_t)components;
  f.values = BW_NEW(context, double, f.pattern->block_count *components *components);
  f.rhs = BW_NEW(context, double, f.size);
  f.x = BW_NEW0(context, double, f.size);
  f.y = BW_NEW(context, double, f.size);
  f.field = (field){f.topology, components, 0, 0, wind, 0.01};
  return f;
}

static void assemble(fixture *f, double roughness, double phase) {
  f->field.roughness = roughness;
  f->field.phase = phase;
  check_ok(f->context, bw_plane_assemble(f->context, f->pattern, f->field.components, field_matrix,
                                         &f->field, f->values));
  for (size_t i = 0; i < f->size; i++)
    f->rhs[i] = 1 + 0.1 * sin((double)i);
}

static double residual(fixture *f) {
  double sum = 0, size = 0;
  check_ok(f->context,
           bw_plane_multiply(f->context, f->pattern, f->field.components, f->values, f->x, f->y));
  for (size_t i = 0; i < f->size; i++) {
    sum += (f->rhs[i] - f->y[i]) * (f->rhs[i] - f->y[i]);
    size += f->rhs[i] * f->rhs[i];
  }
  return sqrt(sum / size);
}

static void clear(fixture *f) {
  bw_free(f->values);
  bw_free(f->rhs);
  bw_free(f->x);
  bw_free(f->y);
  bw_release(f->pattern);
  bw_release(f->topology);
}

static void follow_changes(bw_context *context, bool symmetric, int components) {
  fixture f = set_up(context, 16, components, symmetric ? 0 : 1, 0, NULL);
  fixture g = set_up(context, 16, components, symmetric ? 0 : 1, 0x14, f.topology);
  bw_lagged_factor *lagged;
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  check_ok(context, bw_lagged_factor_create(context, symmetric, components, &lagged));

  bw_plane_reuse reuse = {0};
  assemble(&f, 0.1, 0);
  check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                           &options, &reuse));
  assert_true(residual(&f) < 1.001e-8);
  assert_int_equal(reuse.factorisations, 1);
  assert_int_equal(reuse.analyses, 1);
  assert_true(reuse.iterations <= 2);
  assert_false(reuse.factor);

  /* the values move: the factor is kept and iterated on */
  options.solver = lagged_by(symmetric, LAGGED_ITERATE);
  reuse = (bw_plane_reuse){0};
  assemble(&f, 0.1, 0.3);
  check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                           &options, &reuse));
  assert_true(residual(&f) < 1.001e-8);
  assert_true(reuse.factor);
  assert_int_equal(reuse.factorisations, 0);
  assert_in_range(reuse.iterations, 1, 30);
  check_near(reuse.residual, residual(&f), 1e-12);

  /* the topology moves: the factor is kept all the same */
  reuse = (bw_plane_reuse){0};
  assemble(&g, 0.1, 0.3);
  memcpy(g.x, f.x, f.size * sizeof *f.x);
  check_ok(context, bw_lagged_factor_solve(context, lagged, g.pattern, g.values, g.rhs, g.x,
                                           &options, &reuse));
  assert_true(residual(&g) < 1.001e-8);
  assert_true(reuse.factor);
  assert_int_equal(reuse.factorisations, 0);

  /* refactorised: the analysis is made for the new topology */
  options.solver = lagged_by(symmetric, LAGGED_REFACTOR);
  reuse = (bw_plane_reuse){0};
  memset(g.x, 0, g.size * sizeof *g.x);
  check_ok(context, bw_lagged_factor_solve(context, lagged, g.pattern, g.values, g.rhs, g.x,
                                           &options, &reuse));
  assert_true(residual(&g) < 1.001e-8);
  assert_int_equal(reuse.analyses, 1);
  assert_int_equal(reuse.factorisations, 1);
  reuse = (bw_plane_reuse){0};
  assemble(&g, 0.4, 0.3);
  check_ok(context, bw_lagged_factor_solve(context, lagged, g.pattern, g.values, g.rhs, g.x,
                                           &options, &reuse));
  assert_true(residual(&g) < 1.001e-8);
  assert_int_equal(reuse.analyses, 0);
  assert_int_equal(reuse.factorisations, 1);

  /* too far for the iterations allowed: a new factor is made without being asked for */
  bw_solver few = *lagged_by(symmetric, LAGGED_ITERATE);
  few.options.max_iterations = 2;
  options.solver = &few;
  reuse = (bw_plane_reuse){0};
  assemble(&g, 0.9, 2);
  check_ok(context, bw_lagged_factor_solve(context, lagged, g.pattern, g.values, g.rhs, g.x,
                                           &options, &reuse));
  assert_true(residual(&g) < 1.001e-8);
  assert_int_equal(reuse.factorisations, 1);

  /* another size */
  fixture h = set_up(context, 9, components, symmetric ? 0 : 1, 0, NULL);
  reuse = (bw_plane_reuse){0};
  bw_lagged_factor_options_default(&options);
  assemble(&h, 0.4, 0.3);
  check_ok(context, bw_lagged_factor_solve(context, lagged, h.pattern, h.values, h.rhs, h.x,
                                           &options, &reuse));
  assert_true(residual(&h) < 1.001e-8);
  assert_int_equal(reuse.analyses, 1);

  bw_lagged_factor_reset(lagged);
  check_fails(context, BW_INTERNAL, "no factor",
              bw_lagged_factor_apply(context, lagged, h.rhs, h.x));
  bw_lagged_factor_destroy(lagged);
  clear(&f);
  clear(&g);
  clear(&h);
}

static void test_follow(void **state) {
  for (int components = 1; components <= 3; components++) {
    follow_changes(check_context(state), true, components);
    follow_changes(check_context(state), false, components);
  }
  follow_changes(check_context(state), false, 4);
}

/* Every solver that serves gives one solution and reports itself; max_lag ends a factor. */
static void every_solver(void **state) {
  bw_context *context = check_context(state);
  for (int symmetric = 0; symmetric < 2; symmetric++)
    for (int way = LAGGED_AUTO; way <= LAGGED_FULL; way++) {
      fixture f = set_up(context, 24, 2, symmetric ? 0 : 1, 0, NULL);
      bw_lagged_factor *lagged;
      bw_lagged_factor_options options;
      bw_lagged_factor_options_default(&options);
      options.solver = lagged_by(symmetric, (lagged_way)way);
      check_ok(context, bw_lagged_factor_create(context, symmetric, 2, &lagged));
      bool each = way >= LAGGED_REFACTOR;
      bw_plane_reuse reuse = {0};
      const bw_solver_report *report = &reuse.report;
      for (int frame = 0; frame < 3; frame++) {
        assemble(&f, 0.1, 0.01 * frame);
        check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                                 &options, &reuse));
        assert_true(residual(&f) < 1.001e-8);
      }
      assert_int_equal(reuse.factorisations, each ? 3 : 1);
      assert_int_equal(reuse.analyses, way == LAGGED_FULL ? 3 : 1);
      const char *factor = symmetric ? "cholesky" : "lu";
      assert_string_equal(report->solver, each ? factor : symmetric ? "pcg" : "bicgstab");
      assert_string_equal(report->preconditioner, each ? "" : factor);
      assert_string_equal(report->backend, symmetric ? "multifrontal" : "barwright");
      assert_true(way == LAGGED_AUTO
                      ? report->predicted_cost > 0 && report->rival_cost > report->predicted_cost &&
                            strstr(report->reason, "cost least")
                      : report->predicted_cost == 0 && report->rival_cost == 0 &&
                            strcmp(report->reason, "it was given") == 0);
      assert_true(report->flops > 0 && report->bytes > 0 && report->seconds > 0);
      assert_int_equal(report->iterations, reuse.iterations);
      check_near(report->residual, reuse.residual, 0);
      check_near(report->reused, each ? 0 : 2. / 3, 1e-12);
      if (!each) {
        options.max_lag = 2;
        assemble(&f, 0.1, 0.04);
        check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                                 &options, &reuse));
        assert_int_equal(reuse.factorisations, 2);
        assert_true(strstr(report->reason, "max_lag"));
      }
      bw_lagged_factor_destroy(lagged);
      clear(&f);
    }
}

/* What does not serve plane meshes is refused before anything is done. */
static void refused_solvers(void **state) {
  bw_context *context = check_context(state);
  const bw_solver jacobi = {.options = {.kind = BW_SOLVER_JACOBI}},
                  single = {.options = {.precision = 32}},
                  cholmod = {.options = {.backend = BW_BACKEND_CHOLMOD}},
                  ordered = {.options = {.ordering = BW_ORDERING_AMD}},
                  two_level = {.options = {.kind = BW_SOLVER_PCG}},
                  by_jacobi = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &jacobi}};
  const bw_solver *refused[] = {&jacobi, &single, &cholmod, &ordered, &two_level, &by_jacobi, NULL};
  for (int symmetric = 0; symmetric < 2; symmetric++) {
    fixture f = set_up(context, 6, 1, 0, 0, NULL);
    bw_lagged_factor *lagged;
    bw_lagged_factor_options options;
    bw_lagged_factor_options_default(&options);
    check_ok(context, bw_lagged_factor_create(context, symmetric, 1, &lagged));
    assemble(&f, 0.2, 0);
    for (int k = 0; k < 9; k++) {
      options.solver = k < 6 ? refused[k] : lagged_by(!symmetric, (lagged_way)(k - 5));
      check_fails(
          context, BW_INVALID, symmetric ? "give cholesky" : "give lu",
          bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, &options, NULL));
    }
    options.solver = lagged_by(symmetric, LAGGED_REFACTOR);
    options.max_lag = 3;
    check_fails(
        context, BW_INVALID, "max_lag has no effect",
        bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, &options, NULL));
    options = (bw_lagged_factor_options){.tolerance = 1e-8, .max_lag = -1};
    check_fails(
        context, BW_INVALID, "a lag of at most -1",
        bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, &options, NULL));
    bw_lagged_factor_destroy(lagged);
    clear(&f);
  }
}

/* Small changes are iterated on, large ones factored, and the average over a drag is no worse, by
 * the model's own count, than either alone. */
static void test_choice(void **state) {
  bw_context *context = check_context(state);
  fixture f = set_up(context, 48, 2, 0, 0, NULL);
  int factorisations[2];
  for (int fast = 0; fast < 2; fast++) {
    bw_lagged_factor *lagged;
    check_ok(context, bw_lagged_factor_create(context, true, 2, &lagged));
    bw_plane_reuse reuse = {0};
    for (int frame = 0; frame < 40; frame++) {
      assemble(&f, 0.5, frame * (fast ? 0.8 : 1e-4));
      check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                               NULL, &reuse));
      assert_true(residual(&f) < 1.001e-8);
    }
    factorisations[fast] = reuse.factorisations;
    assert_int_equal(reuse.analyses, 1);
    bw_lagged_factor_destroy(lagged);
  }
  assert_in_range(factorisations[0], 1, 8);
  assert_in_range(factorisations[1], 15, 40);
  clear(&f);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  for (int symmetric = 0; symmetric < 2; symmetric++) {
    fixture f = set_up(context, 6, 1, 0, 0, NULL);
    bw_lagged_factor *lagged;
    check_ok(context, bw_lagged_factor_create(context, symmetric, 1, &lagged));
    f.field.mass = 0; /* the constant field is free */
    assemble(&f, 0.2, 0);
    memset(f.values, 0, sizeof(double)); /* and one entry is nothing */
    for (int64_t p = f.pattern->start[20]; p < f.pattern->start[21]; p++)
      f.values[p] = f.values[f.pattern->mirror[p]] = 0;
    for (size_t i = 0; i < f.size; i++)
      f.x[i] = 5;
    check_fails(
        context, BW_SINGULAR, symmetric ? "not positive definite" : "singular",
        bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL, NULL));
    for (size_t i = 0; i < f.size; i++)
      assert_true(f.x[i] == 5);
    /* it can go on after that */
    f.field.mass = 0.01;
    assemble(&f, 0.2, 0);
    check_ok(context,
             bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL, NULL));
    assert_true(residual(&f) < 1.001e-8);
    f.rhs[3] = NAN;
    check_fails(
        context, BW_INVALID, "not finite",
        bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL, NULL));
    memset(f.rhs, 0, f.size * sizeof *f.rhs);
    bw_plane_reuse reuse = {0};
    check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL,
                                             &reuse));
    assert_true(f.x[0] == 0);
    assert_string_equal(reuse.report.solver, ""); /* nothing was solved */
    bw_lagged_factor_destroy(lagged);
    clear(&f);
  }
  bw_lagged_factor *lagged;
  check_fails(context, BW_INVALID, "5 components",
              bw_lagged_factor_create(context, false, 5, &lagged));
}

/* A saddle: the second component has nothing on the diagonal. Without pivoting that cannot be
 * factored; and with next to nothing there it can, but not well. */
static void test_saddle(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    fixture f = set_up(context, 12, 2, 0.5, 0, NULL);
    bw_plane_reuse reuse = {0};
    bw_lagged_factor *lagged;
    double residual = 0;
    check_ok(context, bw_lagged_factor_create(context, false, 2, &lagged));
    assemble(&f, 0.3, 0);
    for (int64_t i = 0; i < f.pattern->node_count; i++)
      for (int64_t p = f.pattern->start[i]; p < f.pattern->start[i + 1]; p++) {
        double *block = f.values + 4 * p;
        bool own = f.pattern->column[p] == i;
        block[1] = own ? 1 : 0.1;
        block[2] = own ? -1 : 0.1;
        block[3] = own && k == 1 ? 1e-9 : 0;
      }
    check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL,
                                             &reuse));
    check_ok(context, bw_plane_multiply(context, f.pattern, 2, f.values, f.x, f.y));
    for (size_t i = 0; i < f.size; i++)
      residual = fmax(residual, fabs(f.y[i] - f.rhs[i]));
    assert_true(residual < 1e-6);
    if (k == 0)
      assert_int_equal(reuse.factorisations, 1); /* refused at once */
    bw_lagged_factor_destroy(lagged);
    clear(&f);
  }
}

static void test_threads(void **state) {
  bw_context *context = check_context(state);
  for (int symmetric = 0; symmetric < 2; symmetric++) {
    double *first = NULL;
    for (int threads = 1; threads <= 3; threads++) {
      check_ok(context, bw_set_threads(context, threads));
      fixture f = set_up(context, symmetric ? 96 : 40, 2, symmetric ? 0 : 1, 0, NULL);
      bw_lagged_factor *lagged;
      bw_lagged_factor_options options;
      bw_lagged_factor_options_default(&options);
      check_ok(context, bw_lagged_factor_create(context, symmetric, 2, &lagged));
      for (int frame = 0; frame < 3; frame++) {
        assemble(&f, 0.3, frame);
        check_ok(context, bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x,
                                                 &options, NULL));
        options.solver = lagged_by(symmetric, LAGGED_ITERATE);
      }
      bw_lagged_factor_destroy(lagged);
      if (first)
        assert_memory_equal(first, f.x, f.size * sizeof *f.x);
      else {
        first = f.x;
        f.x = NULL;
      }
      clear(&f);
    }
    bw_free(first);
  }
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  for (int symmetric = 0; symmetric < 2; symmetric++) {
    fixture f = set_up(context, 5, 2, symmetric ? 0 : 1, 0, NULL);
    assemble(&f, 0.3, 0);
    check_each_allocation(context, status, 1) {
      bw_lagged_factor *lagged = NULL;
      status = bw_lagged_factor_create(context, symmetric, 2, &lagged);
      if (status == BW_OK)
        status =
            bw_lagged_factor_solve(context, lagged, f.pattern, f.values, f.rhs, f.x, NULL, NULL);
      bw_lagged_factor_destroy(lagged);
    }
    clear(&f);
  }
}

check_main(check_test(every_solver), check_test(refused_solvers), check_test(test_follow),
           check_test(test_choice), check_test(test_refused), check_test(test_saddle),
           check_test(test_threads), check_test(test_memory))
