/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elastic modes: against a dense solver, of bars, of several equal bodies, of constrained bodies in
 * any direction; the same bits for any number of threads; failing allocations. Each test runs once
 * for each eigensolver. */
#include "bodies.h"
#include "body_system.h"

static const bw_eigensolver_kind kinds[] = {BW_EIGENSOLVER_LANCZOS, BW_EIGENSOLVER_ARPACK,
                                            BW_EIGENSOLVER_LOBPCG};
enum { KINDS = sizeof kinds / sizeof *kinds };

static bw_eigensolver *eigensolver(bw_context *context, bw_eigensolver_kind kind) {
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = kind;
  check_ok(context, bw_eigensolver_create(context, &options, &solver));
  return solver;
}

/* `count` modes by an eigensolver of this kind; 0: as many as by default. */
static bw_modes *modes_by(bw_context *context, bw_system *system, bw_eigensolver_kind kind,
                          int count) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  bw_eigensolver *solver = eigensolver(context, kind);
  options.solver = solver;
  if (count > 0)
    options.count = count;
  check_ok(context, bw_modes_elastic(context, system, &options, &modes));
  bw_release(solver);
  return modes;
}

void dsygv_(const int *, const char *, const char *, const int *, double *, const int *, double *,
            const int *, double *, double *, const int *, int *);

/* A free box against the dense generalised eigenproblem. */
static void free_box_against_dense(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 4, 3, 2, 1);
  bw_material *material = body_material(context);
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  check_ok(context, body_system(context, mesh, material, dof_map, NULL, &system));
  int size = 3 * mesh->node_count, kind = 1, info, length = 10 * size;
  double *k = numbers((int64_t)size * size), *m = numbers((int64_t)size * size),
         *column = numbers(size), *value = numbers(size), *work = numbers(length);
  for (int j = 0; j < size; j++) {
    memset(column, 0, (size_t)size * sizeof(double));
    column[j] = 1;
    check_ok(context, bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, 1,
                                        column, k + (size_t)j * (size_t)size));
    check_ok(context, bw_block_multiply(context, system->pattern, system->mass, 1, 3, 1, column,
                                        m + (size_t)j * (size_t)size));
  }
  dsygv_(&kind, "N", "L", &size, k, &size, m, &size, value, work, &length, &info);
  assert_int_equal(info, 0);
  for (int which = 0; which < KINDS; which++) {
    bw_modes *modes = modes_by(context, system, kinds[which], 0);
    assert_int_equal(modes->count, 15);
    assert_int_equal(modes->rigid_count, 6);
    assert_true(modes->counted);
    assert_int_equal(modes->recovered, 0);
    for (int i = 0; i < 15; i++) {
      check_near(modes->eigenvalue[i], value[6 + i], 1e-8 * value[6 + i]);
      check_near(modes->frequency[i], sqrt(value[6 + i]) / (2 * M_PI), 1e-8 * sqrt(value[6 + i]));
      assert_true(modes->residual[i] < 1e-8);
    }
    assert_true(modes->report.residual < 1e-8 && modes->report.bytes > 0);
    bw_release(modes);
  }
  free(k);
  free(m);
  free(column);
  free(value);
  free(work);
  bw_release(system);
  bw_release(dof_map);
  bw_release(material);
  bw_release(mesh);
}

typedef struct setup {
  bw_material *material;
  bw_dof_map *dof_map;
  bw_system *system;
} setup;

static void open_free(bw_context *context, const bw_mesh *mesh, setup *s) {
  *s = (setup){.material = body_material(context)};
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &s->dof_map));
  check_ok(context, body_system(context, mesh, s->material, s->dof_map, NULL, &s->system));
}
static void close_setup(setup *s) {
  bw_release(s->system);
  bw_release(s->dof_map);
  bw_release(s->material);
}

/* The eigensolvers agree, and blocks take fewer passes over the factor than single vectors. */
static void against_each_other(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.7, 0.4, 9, 7, 4, 1);
  setup s;
  open_free(context, mesh, &s);
  const char *const names[] = {"lanczos", "arpack", "lobpcg"};
  bw_modes *modes[KINDS];
  for (int k = 0; k < KINDS; k++) {
    modes[k] = modes_by(context, s.system, kinds[k], 0);
    assert_string_equal(modes[k]->report.solver, names[k]);
    for (int i = 0; i < 15; i++)
      check_near(modes[k]->eigenvalue[i], modes[0]->eigenvalue[i], 1e-9 * modes[0]->eigenvalue[i]);
  }
  assert_true((modes[0]->solves + 7) / 8 < modes[1]->solves);
  for (int k = 0; k < KINDS; k++)
    bw_release(modes[k]);
  close_setup(&s);
  bw_release(mesh);
}

/* A mesh of `count` copies of a mesh, side by side and not touching. */
static bw_mesh *copies(bw_context *context, const bw_mesh *one, int count, double apart) {
  int32_t n = one->node_count, m = one->element_count * one->nodes_per_element;
  double *x = numbers(3 * (int64_t)n * count);
  int32_t *element = calloc((size_t)(m * count), sizeof *element);
  for (int k = 0; k < count; k++) {
    for (int32_t i = 0; i < 3 * n; i++)
      x[3 * n * k + i] = one->node[i] + (i % 3 == 1 ? apart * k : 0);
    for (int32_t i = 0; i < m; i++)
      element[m * k + i] = one->element[i] + n * k;
  }
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, one->order, (int64_t)n * count, x,
                                 (int64_t)one->element_count * count, element, NULL, &mesh));
  free(x);
  free(element);
  return mesh;
}

/* Ten equal free bodies: every eigenvalue tenfold, 60 rigid-body motions, none of them a mode. */
static void equal_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = body_box(context, 0.5, 0.1, 0.08, 5, 1, 1, 1);
  bw_mesh *mesh = copies(context, one, 10, 0.3);
  assert_int_equal(mesh->component_count, 10);
  setup alone, s;
  open_free(context, one, &alone);
  open_free(context, mesh, &s);
  bw_modes *single = modes_by(context, alone.system, BW_EIGENSOLVER_AUTO, 4);
  for (int k = 0; k < KINDS; k++) {
    bw_modes *modes = modes_by(context, s.system, kinds[k], 25);
    assert_int_equal(modes->rigid_count, 60);
    assert_true(modes->counted);
    for (int i = 0; i < 25; i++)
      check_near(modes->eigenvalue[i], single->eigenvalue[i / 10],
                 1e-8 * single->eigenvalue[i / 10]);
    bw_release(modes);
  }
  bw_release(single);
  close_setup(&s);
  close_setup(&alone);
  bw_release(mesh);
  bw_release(one);
}

/* A slender free bar of square section: pairs of bending modes at the frequencies of Euler and
 * Bernoulli's beam, f = (beta L)^2 / (2 pi L^2) sqrt(E I / (rho A)). */
static void slender_bar(void **state) {
  bw_context *context = check_context(state);
  const double length = 2, side = 0.04, beta[2] = {4.730040744862704, 7.853204624095838};
  bw_mesh *mesh = body_box(context, length, side, side, 30, 1, 1, 2);
  setup s;
  open_free(context, mesh, &s);
  double speed = sqrt(s.material->young[0] / s.material->density) * side / sqrt(12.0);
  for (int k = 0; k < KINDS; k++) {
    bw_modes *modes = modes_by(context, s.system, kinds[k], 4);
    for (int i = 0; i < 4; i++) {
      double f = beta[i / 2] * beta[i / 2] / (2 * M_PI * length * length) * speed;
      check_near(modes->frequency[i], f, 0.01 * f);
    }
    bw_release(modes);
  }
  close_setup(&s);
  bw_release(mesh);
}

static void turn(const double rotation[9], const bw_mesh *mesh, double *x) {
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int c = 0; c < 3; c++)
      x[3 * i + c] = bw_dot(rotation + 3 * c, mesh->node + 3 * i);
}

/* Fixed, partly fixed (three motions free) and turned: a slide along an oblique plane changes
 * nothing but the frames. */
static void oblique_slide(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *straight = body_box(context, 0.4, 0.3, 0.2, 4, 3, 2, 1), *mesh[2] = {straight, NULL};
  const double a = 0.7, b = -0.4;
  const double rotation[9] = {cos(a) * cos(b), -sin(a), cos(a) * sin(b),
                              sin(a) * cos(b), cos(a),  sin(a) * sin(b),
                              -sin(b),         0,       cos(b)};
  double *x = numbers(3 * (int64_t)straight->node_count);
  turn(rotation, straight, x);
  check_ok(context, bw_mesh_moved(context, straight, x, &mesh[1]));
  bw_modes *modes[2][KINDS];
  for (int k = 0; k < 2; k++) {
    const double normal[3] = {k ? rotation[0] : 1, k ? rotation[3] : 0, k ? rotation[6] : 0},
                 origin[3] = {0, 0, 0};
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    bw_selection *face = NULL;
    bw_dof_map *dof_map = NULL;
    bw_system *system = NULL;
    check_ok(context, bw_model_create(context, mesh[k], material, &model));
    check_ok(context, bw_select_plane(context, mesh[k], origin, normal, 1e-9, &face));
    check_ok(context, bw_model_slide(context, model, face, normal));
    check_ok(context, bw_dof_map_create(context, model, &dof_map));
    assert_int_equal(dof_map->rigid_mode_count, 3);
    check_ok(context, body_system(context, mesh[k], material, dof_map, NULL, &system));
    for (int which = 0; which < KINDS; which++) {
      const bw_modes *found = modes[k][which] = modes_by(context, system, kinds[which], 0);
      assert_int_equal(found->rigid_count, 3);
      assert_true(found->counted);
      for (int i = 0; i < found->count; i++)
        assert_true(found->residual[i] < 1e-8);
    }
    bw_release(system);
    bw_release(dof_map);
    bw_release(face);
    bw_release(model);
    bw_release(material);
  }
  const double *expected = modes[0][0]->eigenvalue;
  for (int k = 0; k < 2; k++)
    for (int which = 0; which < KINDS; which++)
      for (int i = 0; i < modes[0][0]->count; i++)
        check_near(modes[k][which]->eigenvalue[i], expected[i], 1e-8 * expected[i]);
  free(x);
  for (int k = 0; k < 2; k++)
    for (int which = 0; which < KINDS; which++)
      bw_release(modes[k][which]);
  bw_release(mesh[1]);
  bw_release(straight);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.9, 0.8, 8, 7, 6, 1);
  for (int which = 0; which < KINDS; which++) {
    bw_modes *modes[3] = {NULL};
    for (int threads = 1; threads <= 3; threads++) {
      setup s;
      check_ok(context, bw_set_threads(context, threads));
      open_free(context, mesh, &s);
      modes[threads - 1] = modes_by(context, s.system, kinds[which], 0);
      close_setup(&s);
      assert_memory_equal(modes[0]->shape, modes[threads - 1]->shape,
                          (size_t)(15 * 3 * mesh->node_count) * sizeof(double));
      assert_memory_equal(modes[0]->eigenvalue, modes[threads - 1]->eigenvalue,
                          15 * sizeof(double));
    }
    for (int k = 0; k < 3; k++)
      bw_release(modes[k]);
  }
  bw_release(mesh);
}

/* One tetrahedron has 12 - 6 elastic modes, whatever is asked for. */
static void one_element(void **state) {
  bw_context *context = check_context(state);
  const double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const int32_t element[4] = {0, 1, 2, 3};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, 1, 4, x, 1, element, NULL, &mesh));
  setup s;
  open_free(context, mesh, &s);
  for (int k = 0; k < KINDS; k++) {
    bw_modes *modes = modes_by(context, s.system, kinds[k], 0);
    assert_int_equal(modes->count, 6);
    assert_true(modes->eigenvalue[0] > 0);
    assert_true(modes->counted);
    bw_release(modes);
  }
  close_setup(&s);
  bw_release(mesh);
}

static void failing_allocations(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 2, 3, 3, 1);
  setup s;
  open_free(context, mesh, &s);
  check_ok(context, bw_set_threads(context, 1));
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 3;
  for (int k = 0; k < KINDS; k++) {
    bw_eigensolver *solver = eigensolver(context, kinds[k]);
    options.solver = solver;
    check_each_allocation(context, status, 1) {
      bw_modes *modes = NULL, *scalar = NULL;
      status = bw_modes_elastic(context, s.system, &options, &modes);
      if (status == BW_OK)
        status = bw_modes_laplacian(context, mesh, s.system->pattern, &options, &scalar);
      if (status == BW_OK)
        assert_string_equal(modes->report.solver, bw_eigensolver_name(solver));
      bw_release(modes);
      bw_release(scalar);
    }
    bw_release(solver);
  }
  close_setup(&s);
  bw_release(mesh);
}

/* A bar, afloat or held at one end and on a plane that is not along the axes. */
static bw_model *held_bar(bw_context *context, int cells, int order, bool afloat) {
  bw_mesh *mesh = body_box(context, 3, 1, 0.9, 3 * cells, cells, cells, order);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *face = NULL, *side = NULL;
  const double origin[3] = {0, 0, 0}, along[3] = {1, 0, 0}, low[3] = {1.9, -1, -1},
               high[3] = {4, 1e-9, 2}, normal[3] = {0.1, 1, 0.2};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, along, 1e-9, &face));
  if (!afloat) {
    check_ok(context, bw_model_fix(context, model, face));
    check_ok(context, bw_select_box(context, mesh, low, high, &side));
    check_ok(context, bw_model_slide(context, model, side, normal));
  }
  bw_release(face);
  bw_release(side);
  bw_release(material);
  bw_release(mesh);
  return model;
}

/* By LOBPCG with this preconditioner; NULL: with that for the elements. */
static bw_status without_factor(bw_context *context, const bw_model *model,
                                const bw_solver *preconditioner, bw_system **system,
                                bw_modes **modes) {
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 6;
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  how.kind = BW_EIGENSOLVER_LOBPCG;
  how.preconditioner = preconditioner;
  bw_status status = bw_eigensolver_create(context, &how, &solver);
  options.solver = solver;
  if (status == BW_OK)
    status = bw_modes_of_model(context, model, NULL, &options, system, modes);
  bw_release(solver);
  return status;
}

typedef struct preconditioning {
  int order;
  bool afloat, given; /* given: AMG, where the elements would have another */
  const char *word;
} preconditioning;

/* The same modes as by a factor, with the same bits on any number of threads. */
static void compare_with_factor(bw_context *context, const preconditioning *p) {
  bw_model *model = held_bar(context, 4, p->order, p->afloat);
  bw_system *factored = NULL, *system = NULL;
  bw_solver *amg = NULL;
  const bw_solver_options options = {.kind = BW_SOLVER_AMG};
  if (p->given)
    check_ok(context, bw_solver_create(context, &options, &amg));
  check_ok(context, bw_system_of_model(context, model, NULL, NULL, &factored));
  bw_modes *own = modes_by(context, factored, BW_EIGENSOLVER_LANCZOS, 6), *modes[2];
  for (int threads = 1; threads <= 2; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    bw_release(system);
    check_ok(context, without_factor(context, model, amg, &system, &modes[threads - 1]));
    const bw_modes *found = modes[threads - 1];
    assert_null(system->factor);
    assert_string_equal(found->report.preconditioner, p->word);
    assert_true(found->tested && !found->counted);
    for (int i = 0; i < 6; i++) {
      check_near(found->eigenvalue[i], own->eigenvalue[i], 1e-9 * own->eigenvalue[i]);
      assert_true(found->residual[i] <= 1e-8);
    }
    assert_memory_equal(found->shape, modes[0]->shape,
                        (size_t)(6 * 3 * model->mesh->node_count) * sizeof(double));
  }
  bw_release(modes[0]);
  bw_release(modes[1]);
  bw_release(own);
  bw_release(system);
  bw_release(factored);
  bw_release(amg);
  bw_release(model);
}

static void lobpcg_without_factor(void **state) {
  bw_context *context = check_context(state);
  static const preconditioning cases[] = {{1, false, false, "amg"},
                                          {1, true, false, "amg"},
                                          {2, false, false, "two_level"},
                                          {2, true, true, "amg"},
                                          {2, true, false, "two_level"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    compare_with_factor(context, &cases[k]);
}

/* Equations on another mesh lend nothing, neither where they are of more nodes nor of fewer. */
static void system_of_another_mesh(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    bw_model *model = held_bar(context, 2 + k, 1, true), *other = held_bar(context, 3 - k, 1, true);
    bw_system *given = NULL, *system = NULL;
    bw_modes *modes = NULL;
    bw_modes_options options;
    bw_modes_options_default(&options);
    options.count = 4;
    check_ok(context, bw_system_of_model(context, other, NULL, NULL, &given));
    for (int lanczos = 0; lanczos < 2; lanczos++) {
      bw_eigensolver *solver = eigensolver(context, BW_EIGENSOLVER_LANCZOS);
      options.solver = lanczos ? solver : NULL;
      check_ok(context, bw_modes_of_model(context, model, given, &options, &system, &modes));
      assert_ptr_equal(system->mesh, model->mesh);
      for (int i = 0; i < 4; i++)
        assert_true(modes->residual[i] <= 1e-8);
      bw_release(solver);
      bw_release(modes);
      bw_release(system);
    }
    bw_release(given);
    bw_release(other);
    bw_release(model);
  }
}

/* Modes leave what a system says of its solver: that it was given. */
static void report_of_a_given_solver(void **state) {
  bw_context *context = check_context(state);
  static const bw_solver_options solvers[] = {
      {.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_CHOLMOD}, {.kind = BW_SOLVER_PCG}};
  bw_model *model = held_bar(context, 2, 2, true);
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 4;
  for (size_t k = 0; k < sizeof solvers / sizeof *solvers; k++) {
    bw_solver *solver = NULL;
    bw_system *given = NULL, *used = NULL;
    bw_modes *modes = NULL;
    check_ok(context, bw_solver_create(context, &solvers[k], &solver));
    check_ok(context, bw_system_of_model(context, model, solver, NULL, &given));
    check_ok(context, bw_modes_of_model(context, model, given, &options, &used, &modes));
    assert_ptr_equal(used, given);
    assert_string_equal(given->report.reason, "it was given");
    assert_string_equal(given->report.solver, bw_solver_word(solvers[k].kind));
    bw_release(modes);
    bw_release(used);
    bw_release(given);
    bw_release(solver);
  }
  bw_release(model);
}

/* Allocations that fail one after the other; thinned out, since there are thousands. */
static void check_memory(bw_context *context, int order) {
  bw_model *model = held_bar(context, 1, order, order == 1);
  check_ok(context, bw_set_threads(context, 1));
  int64_t before = bw_live_blocks();
  bool passed = false;
  for (int64_t n = 1; !passed && n < 100000; n += n < 300 ? 1 : 17) {
    bw_modes *modes = NULL;
    bw_system *system = NULL;
    bw_fail_allocation(n, true);
    bw_status status = without_factor(context, model, NULL, &system, &modes);
    bw_fail_allocation(0, false);
    if (status != BW_OK)
      assert_int_equal(status, BW_MEMORY);
    passed = status == BW_OK;
    bw_release(modes);
    bw_release(system);
    bw_clear_failure(context);
    assert_int_equal(bw_live_blocks(), before);
  }
  assert_true(passed);
  bw_release(model);
}

static void lobpcg_memory(void **state) {
  check_memory(check_context(state), 1);
  check_memory(check_context(state), 2);
}

/* Modes of flat cells, seven times as long as thick, where residuals are nearly dependent: LOBPCG's
 * vectors are M-orthonormal, and its values those of Lanczos within rounding. */
static void lobpcg_orthonormal(void **state) {
  enum { COUNT = 12 };
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 3, 1, 0.02, 20, 7, 1, 2);
  setup s;
  open_free(context, mesh, &s);
  bw_modes *own = modes_by(context, s.system, BW_EIGENSOLVER_LANCZOS, COUNT),
           *modes = modes_by(context, s.system, BW_EIGENSOLVER_LOBPCG, COUNT);
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *image = numbers(COUNT * size);
  check_ok(context, bw_block_multiply(context, s.system->pattern, s.system->mass, 1, 3, COUNT,
                                      modes->shape, image));
  for (int i = 0; i < COUNT; i++) {
    check_near(modes->eigenvalue[i], own->eigenvalue[i], 1e-7 * own->eigenvalue[i]);
    for (int j = 0; j < COUNT; j++) {
      double product = 0;
      for (int64_t k = 0; k < size; k++)
        product += modes->shape[i * size + k] * image[j * size + k];
      check_near(product, i == j, 1e-13); /* 1.3e-14; 2e-13 where 1e4 times more is let pass */
    }
  }
  free(image);
  bw_release(modes);
  bw_release(own);
  close_setup(&s);
  bw_release(mesh);
}

static void refused_options(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 1, 1, 1, 1);
  setup s;
  open_free(context, mesh, &s);
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 0;
  check_fails(context, BW_INVALID, "0 modes",
              bw_modes_elastic(context, s.system, &options, &modes));
  options.count = 5;
  options.tolerance = -1;
  check_fails(context, BW_INVALID, "tolerance",
              bw_modes_elastic(context, s.system, &options, &modes));
  close_setup(&s);
  bw_eigensolver *solver = NULL;
  bw_solver *jacobi = NULL;
  bw_eigensolver_options how;
  bw_eigensolver_options_default(&how);
  const bw_solver_options kind = {.kind = BW_SOLVER_JACOBI};
  check_ok(context, bw_solver_create(context, &kind, &jacobi));
  how.kind = BW_EIGENSOLVER_LOBPCG;
  how.preconditioner = jacobi;
  check_fails(context, BW_INVALID, "two_level and amg",
              bw_eigensolver_create(context, &how, &solver));
  bw_release(jacobi);
  bw_release(mesh);
}

check_main(check_test(free_box_against_dense), check_test(against_each_other),
           check_test(equal_bodies), check_test(slender_bar), check_test(oblique_slide),
           check_test(same_bits), check_test(one_element), check_test(failing_allocations),
           check_test(lobpcg_without_factor), check_test(lobpcg_memory),
           check_test(lobpcg_orthonormal), check_test(system_of_another_mesh),
           check_test(report_of_a_given_solver), check_test(refused_options))
