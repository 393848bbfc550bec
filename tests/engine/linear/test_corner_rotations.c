/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse space of corners that rotate: what it contains it solves, under every kind of support;
 * plates of flat elements converge with it, to what a factor gives. */
#include "linear/corner_rotations.h"

#include "linear/supports.h"
#include "linear/system_two_level.h"

typedef struct levels {
  const bw_mesh *mesh;
  bw_dof_map *dof_map;
  bw_block_pattern *pattern;
  double *stiffness;
  bwi_two_level *two_level;
} levels;

static void levels_make(bw_context *context, const bw_model *model, levels *v) {
  bool usable = false;
  *v = (levels){.mesh = model->mesh};
  check_ok(context, bw_dof_map_create(context, model, &v->dof_map));
  check_ok(context, bw_block_pattern_create(context, v->mesh, &v->pattern));
  v->stiffness = numbers(9 * v->pattern->block_count);
  check_ok(context, bw_stiffness(context, v->pattern, v->mesh, model->material, v->stiffness));
  check_ok(context, bwi_two_level_create(context, v->mesh, v->pattern, true, NULL, &v->two_level));
  check_ok(context,
           bwi_two_level_follow(context, v->two_level, model, v->dof_map, v->stiffness, &usable));
  assert_true(usable);
  check_ok(context, bwi_two_level_reserve(context, v->two_level, 1));
}

static void levels_clear(levels *v) {
  bw_release(v->two_level);
  bw_release(v->dof_map);
  bw_release(v->pattern);
  free(v->stiffness);
}

/* The field of random displacements and rotations of the corners, node by node. */
static void field_of_corners(const levels *v, bw_random *random, double *u) {
  const bw_mesh *mesh = v->mesh;
  double *turn = numbers(3 * (int64_t)mesh->node_count);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) {
    u[i] = bw_random_uniform(random) - 0.5;
    turn[i] = 5 * bw_random_uniform(random);
  }
  for (int64_t i = 0; i < mesh->node_count; i++)
    bwi_project_unknowns(v->dof_map, i, u + 3 * i, u + 3 * i);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int m = 0; m < 6; m++) {
      const int32_t *node = mesh->element + 10 * e;
      int64_t a = 3 * (int64_t)node[bw_tet_edge[m][0]], b = 3 * (int64_t)node[bw_tet_edge[m][1]];
      double w[3], arm[3], moved[3], *mid = u + 3 * (int64_t)node[4 + m];
      for (int d = 0; d < 3; d++) {
        w[d] = turn[a + d] - turn[b + d];
        arm[d] = 0.25 * (mesh->node[b + d] - mesh->node[a + d]);
      }
      bw_cross(w, arm, moved);
      for (int d = 0; d < 3; d++)
        mid[d] = 0.5 * (u[a + d] + u[b + d]) + moved[d];
      bwi_project_unknowns(v->dof_map, node[4 + m], mid, mid);
    }
  free(turn);
}

/* K P A^-1 P^T K u = K u for u in the space. */
static void fields_of_the_space_are_solved(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 7);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    levels v;
    bwi_corner_rotations *rotations = NULL;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    levels_make(context, b.model, &v);
    bwi_two_level *l = v.two_level;
    const bwi_smoother *s = l->smoother;
    int64_t size = 3 * (int64_t)s->count;
    double *u = numbers(size), *f = numbers(size), *g = numbers(size);
    field_of_corners(&v, &random, u);
    check_ok(context, bw_block_multiply(context, v.pattern, v.stiffness, 9, 3, 1, u, f));
    for (int64_t i = 0; i < s->count; i++) {
      bwi_project_unknowns(v.dof_map, i, f + 3 * i, f + 3 * i);
      for (int d = 0; d < 3; d++)
        l->residual[3 * (int64_t)s->row_of[i] + d] = (float)(s->unit * f[3 * i + d]);
    }
    check_ok(context, bwi_corner_rotations_create(context, l, v.mesh, v.stiffness, &rotations));
    assert_non_null(rotations);
    memset(l->z, 0, (size_t)size * sizeof *l->z);
    check_ok(context, bwi_corner_rotations_correct(context, rotations, l, 1, 1));
    for (int64_t i = 0; i < s->count; i++) {
      for (int d = 0; d < 3; d++)
        u[3 * i + d] = (double)l->z[3 * (int64_t)s->row_of[i] + d];
      bwi_project_unknowns(v.dof_map, i, u + 3 * i, u + 3 * i);
    }
    check_ok(context, bw_block_multiply(context, v.pattern, v.stiffness, 9, 3, 1, u, g));
    for (int64_t i = 0; i < s->count; i++)
      bwi_project_unknowns(v.dof_map, i, g + 3 * i, g + 3 * i);
    check_near(difference(g, f, size), 0, 2e-3);
    assert_true(bw_bytes(rotations) > 0);
    bw_release(rotations);
    levels_clear(&v);
    free(u);
    free(f);
    free(g);
    bar_clear(&b);
  }
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  levels v;
  bar_make(context, 1, 2, &b);
  load_bar(context, &b, 3);
  levels_make(context, b.model, &v);
  bwi_corner_rotations *rotations = NULL;
  check_allocations(
      context, rotations,
      bwi_corner_rotations_create(context, v.two_level, v.mesh, v.stiffness, &rotations));
  levels_clear(&v);
  bar_clear(&b);
}

/* ---- plates of flat elements ----------------------------------------------------------------- */

/* A plate of cells `wide` times as wide as thick, under its weight and a force at one edge. */
static bw_model *plate_of(bw_context *context, int cells, int layers, double wide, support how) {
  double length = wide * cells;
  bw_mesh *mesh = body_box(context, length, length, layers, cells, cells, layers, 2);
  bw_material *material = body_material(context);
  bw_model *model =
      supported_body(context, mesh, material, how, 0, length, (const double[3]){0.8, 0.6, 0});
  bw_release(material);
  bw_release(mesh);
  return model;
}

static void plates_converge(void **state) {
  bw_context *context = check_context(state);
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  const bw_statics_options by_factor = {.solver = cholesky, .inertia_relief = true};
  int rotating = 0;
  for (int n = 0; n < 2 * SUPPORTS; n++) {
    double tolerance = 1e-10;
    bw_solver *pcg =
        body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .tolerance = tolerance});
    const bw_statics_options by_levels = {.solver = pcg, .inertia_relief = true};
    bw_model *model = plate_of(context, 10, 1 + n % 2, 10, n / 2);
    bw_static *a = NULL, *b = NULL, *c = NULL;
    check_ok(context, bw_statics(context, model, NULL, &by_factor, &a));
    check_ok(context, bw_statics(context, model, NULL, &by_levels, &b));
    check_near(difference(b->displacement, a->displacement, 3 * (int64_t)model->mesh->node_count),
               0, 1e3 * tolerance);
    assert_in_range(b->report.iterations, 5, 200); /* node by node, free: 411 and 834 to 1e-8 */
    assert_non_null(b->system->two_level->preconditioner->smoother->block_start);
    rotating += strstr(b->report.reason, "corners rotate") != NULL;
    /* what was made serves the next solution from its first iteration */
    check_ok(context, bw_statics(context, model, b->system, &by_levels, &c));
    assert_true(c->report.iterations <= b->report.iterations);
    assert_ptr_equal(c->system->two_level, b->system->two_level);
    bw_release(a);
    bw_release(b);
    bw_release(c);
    bw_release(model);
    bw_release(pcg);
  }
  assert_true(rotating >= 2); /* built in, and free */
  bw_release(cholesky);
}

/* Where iterations are not slow, nothing is tried. */
static void ordinary_bodies_keep_theirs(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  const bw_statics_options by_levels = {.solver = pcg, .inertia_relief = true};
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bw_static *result = NULL;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    check_ok(context, bw_statics(context, b.model, NULL, &by_levels, &result));
    assert_null(result->system->two_level->preconditioner->rotations);
    bw_release(result);
    bar_clear(&b);
  }
  bw_release(pcg);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  const bw_statics_options by_levels = {.solver = pcg};
  bw_model *model = plate_of(context, 12, 1, 10, CLAMPED);
  bw_static *result[2] = {NULL, NULL};
  for (int n = 0; n < 2; n++) {
    check_ok(context, bw_set_threads(context, n ? 4 : 1));
    check_ok(context, bw_statics(context, model, NULL, &by_levels, &result[n]));
  }
  assert_memory_equal(result[0]->displacement, result[1]->displacement,
                      3 * (size_t)model->mesh->node_count * sizeof(double));
  bw_release(result[0]);
  bw_release(result[1]);
  bw_release(model);
  bw_release(pcg);
}

static double *random_numbers(int64_t count) {
  double *x = numbers(count);
  bw_random random;
  bw_random_seed(&random, 3);
  for (int64_t i = 0; i < count; i++)
    x[i] = 2 * bw_random_uniform(&random) - 1;
  return x;
}

/* Many right-hand sides make rotations where their iterations are slow, and have what a factor
 * has. Of these and of static solutions the first makes them for both. */
static void many_right_hand_sides(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .tolerance = 1e-9});
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  const bw_statics_options by_levels = {.solver = pcg};
  bw_model *model = plate_of(context, 10, 1, 10, CLAMPED);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *f = random_numbers(3 * size), *a = numbers(3 * size), *b = numbers(3 * size);
  bw_system *iterative = NULL, *factor = NULL;
  bw_static *result = NULL;
  check_ok(context, bw_system_of_model(context, model, pcg, NULL, &iterative));
  check_ok(context, bw_system_of_model(context, model, cholesky, NULL, &factor));
  check_ok(context, bw_system_solve(context, iterative, 3, f, a));
  check_ok(context, bw_system_solve(context, factor, 3, f, b));
  check_near(difference(a, b, 3 * size), 0, 1e-6);
  const bwi_corner_rotations *rotations = iterative->two_level->preconditioner->rotations;
  assert_non_null(rotations);
  assert_non_null(strstr(iterative->report.reason, "; corners rotate"));
  int first = iterative->report.iterations;
  iterative->report.iterations = 0;
  check_ok(context, bw_system_solve(context, iterative, 3, f, a));
  assert_true(iterative->report.iterations < first);
  assert_null(strstr(strstr(iterative->report.reason, "; corners rotate") + 1, "; corners rotate"));
  check_ok(context, bw_statics(context, model, iterative, &by_levels, &result));
  assert_ptr_equal(result->system->two_level->preconditioner->rotations, rotations);
  bw_release(result);
  bw_release(iterative);
  bw_release(factor);
  bw_release(model);
  bw_release(pcg);
  bw_release(cholesky);
  free(f);
  free(a);
  free(b);
}

/* LOBPCG, which makes no solution, asks by a few iterations before. */
static void modes_rotate(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_model *model = plate_of(context, 10, 1, 10, FREE);
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 6;
  options.tolerance = 1e-6;
  bw_modes *modes[2];
  for (int n = 0; n < 2; n++) {
    bw_system *system = NULL;
    check_ok(context, bw_system_of_model(context, model, n ? cholesky : pcg, NULL, &system));
    check_ok(context, bw_modes_elastic(context, system, &options, &modes[n]));
    if (n == 0) {
      assert_non_null(system->two_level->preconditioner->rotations);
      assert_non_null(strstr(modes[n]->report.reason, "corners rotate"));
      assert_in_range(modes[n]->report.iterations, 5, 100);
    }
    bw_release(system);
  }
  for (int k = 0; k < options.count; k++)
    check_near(modes[0]->eigenvalue[k] / modes[1]->eigenvalue[k], 1, 1e-6);
  bw_release(modes[0]);
  bw_release(modes[1]);
  bw_release(model);
  bw_release(pcg);
  bw_release(cholesky);
}

/* A preconditioner that follows another shape makes them before its first solution. */
static void another_shape_remembers(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = plate_of(context, 10, 1, 10, CLAMPED);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *f = random_numbers(size), *u[2] = {numbers(size), numbers(size)};
  int iterations[2];
  levels v;
  levels_make(context, model, &v);
  bwi_two_level *l = v.two_level;
  for (int n = 0; n < 2; n++) {
    bool usable = false;
    bwi_two_level_problem problem = {.tolerance = 1e-9, .limit = 500};
    check_ok(context, bwi_two_level_follow(context, l, model, v.dof_map, v.stiffness, &usable));
    assert_true(usable && !l->rotations);
    check_ok(context, bwi_two_level_solve(context, l, &problem, 1, f, u[n]));
    assert_true(problem.converged && l->rotations);
    iterations[n] = problem.iterations;
  }
  assert_true(iterations[1] < iterations[0]);
  check_near(difference(u[1], u[0], size), 0, 1e-6);
  levels_clear(&v);
  bw_release(model);
  free(f);
  free(u[0]);
  free(u[1]);
}

static void cancel_rotations(void *data, const char *stage, double fraction) {
  (void)fraction;
  if (strcmp(stage, "corner rotations") == 0)
    bw_cancel((bw_context *)data);
}

/* Where making them was cancelled, the next solution makes them. */
static void cancelled_rotations_are_made_later(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = plate_of(context, 10, 1, 10, CLAMPED);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *f = random_numbers(size), *u = numbers(size);
  bwi_two_level_problem problem = {.tolerance = 1e-9, .limit = 500};
  bool usable = false;
  levels v;
  levels_make(context, model, &v);
  bwi_two_level *l = v.two_level;
  check_ok(context, bwi_two_level_follow(context, l, model, v.dof_map, v.stiffness, &usable));
  bw_set_progress(context, cancel_rotations, context);
  check_fails(context, BW_CANCELLED, "", bwi_two_level_solve(context, l, &problem, 1, f, u));
  bw_set_progress(context, NULL, NULL);
  bw_clear_cancel(context);
  check_ok(context, bwi_two_level_solve(context, l, &problem, 1, f, u));
  assert_true(problem.converged && l->rotations);
  levels_clear(&v);
  bw_release(model);
  free(f);
  free(u);
}

/* Blocks of the smoother along stiff fibres and at nearly flat elements, on 1 thread and on 4.
 * Node by node they take 183 and 280 iterations. */
static void strong_couplings_converge(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  const bw_statics_options by_levels = {.solver = pcg};
  for (int layer = 0; layer < 2; layer++) {
    bw_mesh *box = body_box(context, 10, 10, 10, 10, 4, 4, 2), *mesh = NULL;
    bw_material *material = NULL;
    bw_model *model = NULL;
    bw_static *result[2] = {NULL, NULL};
    const bw_orthotropic fibres = {
        .young = {1e10, 1e7, 1e7}, .poisson = {0.3, 3e-4, 3e-4}, .shear = {4e6, 4e6, 4e6}};
    const double pull[3] = {3e3, 1e3, -2e3};
    double *node = numbers(3 * (int64_t)box->node_count);
    for (int64_t i = 0; i < 3 * (int64_t)box->node_count; i++)
      node[i] =
          box->node[i] - (layer && i % 3 == 0 ? 0.999 * fmin(fmax(box->node[i] - 4, 0), 1) : 0);
    check_ok(context, bw_mesh_moved(context, box, node, &mesh));
    if (layer)
      material = body_material(context);
    else
      check_ok(context, bw_material_orthotropic(context, &fibres, &material));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    bw_selection *low = body_face(context, mesh, 2, 0), *high = body_face(context, mesh, 2, 10);
    check_ok(context, bw_model_fix(context, model, low));
    check_ok(context, bw_model_force(context, model, high, pull));
    for (int n = 0; n < 2; n++) {
      check_ok(context, bw_set_threads(context, n ? 4 : 1));
      check_ok(context, bw_statics(context, model, NULL, &by_levels, &result[n]));
      assert_in_range(result[n]->report.iterations, 5, 40);
    }
    assert_memory_equal(result[0]->displacement, result[1]->displacement,
                        3 * (size_t)mesh->node_count * sizeof(double));
    bw_release(result[0]);
    bw_release(result[1]);
    bw_release(low);
    bw_release(high);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
    bw_release(box);
    free(node);
  }
  bw_release(pcg);
}

check_main(check_test(fields_of_the_space_are_solved), check_test(no_memory),
           check_test(plates_converge), check_test(strong_couplings_converge),
           check_test(ordinary_bodies_keep_theirs), check_test(same_bits),
           check_test(many_right_hand_sides), check_test(modes_rotate),
           check_test(another_shape_remembers), check_test(cancelled_rotations_are_made_later))
