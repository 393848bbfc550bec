/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over vertex stars beside their equations, and bodies that are nearly incompressible, or
 * have stiff fibres in no direction of the mesh, beside a factor. */
#include "base/cost.h"
#include "linear/corner_rotations.h"
#include "linear/stars.h"

#include "base/dense.h"

#include "linear/supports.h"
#include "linear/system_two_level.h"

/* A bar with a material of its own, in place of that of bar_make. */
typedef struct scene {
  bar b;
  bw_block_pattern *pattern;
  bw_dof_map *dof_map;
  double *stiffness;
  bwi_two_level *two_level;
  int64_t size;
} scene;

static bw_material *material_of(bw_context *context, double poisson, bw_formulation formulation) {
  bw_material *standard = NULL, *material = NULL;
  const bw_isotropic constants = {.young = 1e9, .poisson = poisson, .density = 1000};
  check_ok(context, bw_material_isotropic(context, &constants, &standard));
  check_ok(context, bw_material_formulated(context, standard, formulation, &material));
  bw_release(standard);
  return material;
}

static void scene_make(bw_context *context, int across, int supports, scene *s) {
  bool usable = false;
  *s = (scene){.size = 0};
  bar_make(context, across, 2, &s->b);
  bw_release(s->b.model);
  bw_release(s->b.material);
  s->b.material = material_of(context, 0.49, BW_B_BAR);
  check_ok(context, bw_model_create(context, s->b.mesh, s->b.material, &s->b.model));
  load_bar(context, &s->b, supports);
  check_ok(context, bw_block_pattern_create(context, s->b.mesh, &s->pattern));
  check_ok(context, bw_dof_map_create(context, s->b.model, &s->dof_map));
  s->stiffness = numbers(9 * s->pattern->block_count);
  s->size = 3 * (int64_t)s->b.mesh->node_count;
  check_ok(context, bw_stiffness(context, s->pattern, s->b.mesh, s->b.material, s->stiffness));
  check_ok(context,
           bwi_two_level_create(context, s->b.mesh, s->pattern, false, NULL, &s->two_level));
  check_ok(context, bwi_two_level_follow(context, s->two_level, s->b.model, s->dof_map,
                                         s->stiffness, &usable));
  assert_true(usable);
}

static void scene_clear(scene *s) {
  bw_release(s->two_level);
  free(s->stiffness);
  bw_release(s->dof_map);
  bw_release(s->pattern);
  bar_clear(&s->b);
}

static void keep_unknowns(const scene *s, double *field) {
  for (int64_t i = 0; i < s->b.mesh->node_count; i++)
    bwi_project_unknowns(s->dof_map, i, field + 3 * i, field + 3 * i);
}

/* rest = r - K z at the unknowns. */
static void subtract(bw_context *context, const scene *s, const double *r, const double *z,
                     double *rest) {
  check_ok(context, bw_block_multiply(context, s->pattern, s->stiffness, 9, 3, 1, z, rest));
  for (int64_t i = 0; i < s->size; i++)
    rest[i] = r[i] - rest[i];
  keep_unknowns(s, rest);
}

/* z of a sweep forwards, and then of one backwards, of field f of `width`; rest: what the one
 * forwards leaves. The other fields have numbers of their own. */
static void sweep_field(bw_context *context, const scene *s, const bwi_stars *stars, int width,
                        int f, const double *r, double *forward, double *rest, double *both) {
  const bwi_smoother *w = s->two_level->smoother;
  size_t capacity = (size_t)(width * s->size) + BWI_SMOOTHER_SPARE;
  float *pr = calloc(capacity, sizeof *pr), *pz = calloc(capacity, sizeof *pz);
  float *left = calloc(capacity, sizeof *left);
  for (size_t i = 0; i < capacity - BWI_SMOOTHER_SPARE; i++)
    pr[i] = (float)((int)(i % 7) - 3);
  for (int64_t k = 0; k < w->count; k++)
    for (int d = 0; d < 3; d++)
      pr[(3 * k + d) * width + f] = (float)r[3 * (int64_t)w->node[k] + d];
  check_ok(context, bwi_stars_forward(context, stars, width, pr, pz, left));
  for (int pass = 0; pass < 2; pass++) {
    double *z = pass ? both : forward;
    for (int64_t k = 0; k < w->count; k++)
      for (int d = 0; d < 3; d++) {
        int64_t at = (3 * k + d) * width + f, i = 3 * (int64_t)w->node[k] + d;
        z[i] = w->unit * (double)pz[at];
        if (pass == 0)
          rest[i] = (double)left[at];
      }
    if (pass == 0)
      check_ok(context, bwi_stars_backward(context, stars, width, pr, pz));
  }
  keep_unknowns(s, rest);
  free(pr);
  free(pz);
  free(left);
}

/* The equations of the first corner's star hold: it has the first colour, and is the last one
 * backwards. */
static void check_first_star(const scene *s, const double *rest) {
  const bwi_two_level *l = s->two_level;
  for (int64_t a = l->child_start[0]; a < l->child_start[1]; a++)
    for (int d = 0; d < 3; d++)
      check_near(rest[3 * (int64_t)l->smoother->node[l->child[a]] + d], 0, 2e-3);
}

static void sweeps(void **state) {
  bw_context *context = check_context(state);
  static const int supports[] = {0, 1, 4, 3}; /* built in; slides; on surfaces of its own; free */
  for (int k = 0; k < 4; k++) {
    scene s;
    bwi_stars *stars = NULL;
    scene_make(context, 2, supports[k], &s);
    check_ok(context, bwi_stars_create(context, s.two_level, s.stiffness, &stars));
    assert_non_null(stars);
    double *r = numbers(s.size), *other = numbers(s.size), *rest = numbers(s.size);
    double *forward = numbers(s.size), *z = numbers(s.size), *again = numbers(s.size);
    double *left = numbers(s.size), *first = numbers(s.size);
    random_field(3, s.size, r);
    random_field(4, s.size, other);
    keep_unknowns(&s, r);
    keep_unknowns(&s, other);
    for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4)
      for (int f = 0; f < width; f += 3) {
        sweep_field(context, &s, stars, width, f, other, forward, left, again);
        sweep_field(context, &s, stars, width, f, r, forward, left, z);
        subtract(context, &s, r, forward, rest);
        check_near(difference(left, rest, s.size), 0, 1e-3);
        subtract(context, &s, r, z, rest);
        check_first_star(&s, rest);
        check_near(bwi_dot(s.size, z, other) / bwi_dot(s.size, again, r), 1, 1e-3);
        keep_unknowns(&s, z);
        if (width == 1)
          memcpy(first, z, (size_t)s.size * sizeof *z);
        check_near(difference(z, first, s.size), 0, 1e-4);
      }
    bw_release(stars);
    free(r);
    free(other);
    free(rest);
    free(forward);
    free(z);
    free(again);
    free(left);
    free(first);
    scene_clear(&s);
  }
}

/* A star that is not positive definite is found, and its body does without stars. */
static void singular_stars(void **state) {
  bw_context *context = check_context(state);
  scene s;
  bwi_stars *stars = NULL;
  scene_make(context, 1, 0, &s);
  int64_t own = s.pattern->start[s.b.mesh->node_count] - 1; /* the last node, at the free end */
  for (int c = 0; c < 9; c++)
    s.stiffness[9 * own + c] *= -1;
  check_ok(context, bwi_stars_create(context, s.two_level, s.stiffness, &stars));
  assert_null(stars);
  scene_clear(&s);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  scene s;
  scene_make(context, 1, 0, &s);
  bwi_stars *stars = NULL;
  check_allocations(context, stars, bwi_stars_create(context, s.two_level, s.stiffness, &stars));
  scene_clear(&s);
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* A cube whose corners inside are moved by up to `shake` of a cell, its mid-edge nodes between
 * them. */
static bw_mesh *cube_of(bw_context *context, int cells, double shake) {
  bw_mesh *box = body_box(context, 1, 1, 1, cells, cells, cells, 2), *mesh = NULL;
  double *node = numbers(3 * (int64_t)box->node_count);
  bw_random random;
  bw_random_seed(&random, 11);
  for (int64_t i = 0; i < 3 * (int64_t)box->node_count; i++) {
    double x = box->node[i], by = 2 * shake / cells * (bw_random_uniform(&random) - 0.5);
    node[i] = x > 1e-9 && x < 1 - 1e-9 ? x + by : x;
  }
  for (int64_t e = 0; e < box->element_count; e++)
    for (int m = 0; m < 6; m++)
      for (int d = 0; d < 3; d++) {
        const int32_t *n = box->element + 10 * e;
        node[3 * (int64_t)n[4 + m] + d] = 0.5 * (node[3 * (int64_t)n[bw_tet_edge[m][0]] + d] +
                                                 node[3 * (int64_t)n[bw_tet_edge[m][1]] + d]);
      }
  check_ok(context, bw_mesh_moved(context, box, node, &mesh));
  bw_release(box);
  free(node);
  return mesh;
}

static bw_model *model_of(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          support how) {
  return supported_body(context, mesh, material, how, 2, 1, (const double[3]){0.6, 0, 0.8});
}

/* Iterations to the displacements that a factor gives, on one thread and on four the same bits.
 * *stars: whether they are used. */
static int solve_both(bw_context *context, const bw_model *model, double tolerance, bool *stars) {
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  const bw_statics_options by_factor = {.solver = cholesky, .inertia_relief = true};
  const bw_statics_options by_levels = {.solver = pcg, .inertia_relief = true};
  bw_static *direct = NULL, *result[2] = {NULL, NULL};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  check_ok(context, bw_statics(context, model, NULL, &by_factor, &direct));
  for (int n = 0; n < 2; n++) {
    check_ok(context, bw_set_threads(context, n ? 4 : 1));
    check_ok(context, bw_statics(context, model, NULL, &by_levels, &result[n]));
  }
  assert_memory_equal(result[0]->displacement, result[1]->displacement,
                      (size_t)size * sizeof(double));
  check_near(difference(result[0]->displacement, direct->displacement, size), 0, tolerance);
  int iterations = result[0]->report.iterations;
  const bwi_two_level *l = result[0]->system->two_level->preconditioner;
  *stars = l->stars != NULL;
  assert_true(!l->stars || (l->rotations && strstr(result[0]->report.reason, "vertex stars")));
  assert_true(!l->stars || bw_bytes(l->stars) > 0);
  if (l->stars) { /* they are read from one end to the other */
    double streamed = bwi_stars_read(l->stars) + bwi_corner_rotations_read(l->rotations);
    double rest = bwi_two_level_seconds(l) - streamed / BWI_COST_BYTES_PER_SECOND;
    double blocks = (double)(l->smoother->pattern->block_count - l->smoother->count);
    check_near(rest * BWI_COST_BYTES_PER_SECOND / (BWI_TWO_LEVEL_PASS * blocks),
               BWI_SMOOTHER_PRODUCT_BYTES, 1e-9);
  }
  bw_release(direct);
  bw_release(result[0]);
  bw_release(result[1]);
  bw_release(cholesky);
  bw_release(pcg);
  return iterations;
}

/* Node by node they take 70 at 0.49, and 210 to 700 iterations at 0.499 and 0.4999. */
static void nearly_incompressible(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    double poisson;
    bw_formulation formulation;
    double shake;
    support how;
    int most;
    bool stars;
  } cases[] = {
      {0.3, BW_STANDARD, 0, CLAMPED, 30, false},   {0.45, BW_B_BAR, 0.3, CLAMPED, 60, false},
      {0.499, BW_STANDARD, 0, CLAMPED, 80, true},  {0.499, BW_B_BAR, 0, CLAMPED, 45, true},
      {0.4999, BW_B_BAR, 0, CLAMPED, 90, true},    {0.499, BW_B_BAR, 0.3, CLAMPED, 60, true},
      {0.4999, BW_B_BAR, 0.3, CLAMPED, 120, true}, {0.499, BW_B_BAR, 0.3, SLIDING, 60, true},
      {0.499, BW_B_BAR, 0.3, OBLIQUE, 60, true},   {0.499, BW_B_BAR, 0.3, FREE, 60, true},
      {0.4999, BW_B_BAR, 0.3, FREE, 120, true}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    bool stars = false;
    bw_mesh *mesh = cube_of(context, 7, cases[k].shake);
    bw_material *material = material_of(context, cases[k].poisson, cases[k].formulation);
    bw_model *model = model_of(context, mesh, material, cases[k].how);
    int iterations = solve_both(context, model, 1e-7, &stars);
    assert_in_range(iterations, 5, cases[k].most);
    assert_int_equal(stars, cases[k].stars);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* Twelve right-hand sides at once have what a factor gives. */
static void many_right_hand_sides(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .tolerance = 1e-9});
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_mesh *mesh = cube_of(context, 7, 0.3);
  bw_material *material = material_of(context, 0.4999, BW_B_BAR);
  bw_model *model = model_of(context, mesh, material, CLAMPED);
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *f = numbers(12 * size), *a = numbers(12 * size), *b = numbers(12 * size);
  bw_system *iterative = NULL, *factor = NULL;
  random_field(9, 12 * size, f);
  check_ok(context, bw_system_of_model(context, model, pcg, NULL, &iterative));
  check_ok(context, bw_system_of_model(context, model, cholesky, NULL, &factor));
  check_ok(context, bw_system_solve(context, iterative, 12, f, a));
  check_ok(context, bw_system_solve(context, factor, 12, f, b));
  check_near(difference(a, b, 12 * size), 0, 1e-6);
  assert_non_null(iterative->two_level->preconditioner->stars);
  assert_in_range(iterative->report.iterations, 5, 120);
  bw_release(iterative);
  bw_release(factor);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(pcg);
  bw_release(cholesky);
  free(f);
  free(a);
  free(b);
}

/* While they are made. */
static void cancelled_at_once(void **state) {
  bw_context *context = check_context(state);
  scene s;
  bwi_stars *stars = NULL;
  scene_make(context, 1, 0, &s);
  bw_cancel(context);
  assert_int_equal(bwi_stars_create(context, s.two_level, s.stiffness, &stars), BW_CANCELLED);
  assert_null(stars);
  bw_clear_cancel(context);
  bw_clear_failure(context);
  scene_clear(&s);
}

static void cancel_stars(void *data, const char *stage, double fraction) {
  (void)fraction;
  if (strcmp(stage, "vertex stars") == 0)
    bw_cancel((bw_context *)data);
}

static void cancelled(void **state) {
  bw_context *context = check_context(state);
  bw_solver *pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  const bw_statics_options by_levels = {.solver = pcg};
  bw_mesh *mesh = cube_of(context, 7, 0);
  bw_material *material = material_of(context, 0.4999, BW_B_BAR);
  bw_model *model = model_of(context, mesh, material, CLAMPED);
  bw_static *result = NULL;
  bw_set_progress(context, cancel_stars, context);
  check_fails(context, BW_CANCELLED, "", bw_statics(context, model, NULL, &by_levels, &result));
  bw_set_progress(context, NULL, NULL);
  bw_clear_cancel(context);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(pcg);
}

/* Fibres 1000 times as stiff as what is between them, in a direction of no edge, on a mesh without
 * order. Without rotations: 100 iterations. */
static void oblique_fibres(void **state) {
  bw_context *context = check_context(state);
  double c = cos(0.6), s = sin(0.6);
  const bw_orthotropic fibres = {.young = {1e10, 1e7, 1e7},
                                 .poisson = {0.3, 3e-4, 3e-4},
                                 .shear = {4e6, 4e6, 4e6},
                                 .density = 1000,
                                 .axes = {c, 0.8 * s, 0.6 * s, -s, 0.8 * c, 0.6 * c, 0, -0.6, 0.8}};
  bw_material *material = NULL;
  check_ok(context, bw_material_orthotropic(context, &fibres, &material));
  for (int k = 0; k < 2; k++) {
    bool stars = true;
    bw_mesh *mesh = cube_of(context, 8, k ? 0.3 : 0);
    bw_model *model = model_of(context, mesh, material, CLAMPED);
    int iterations = solve_both(context, model, 1e-7, &stars);
    assert_in_range(iterations, 5, 60);
    assert_false(stars);
    bw_release(model);
    bw_release(mesh);
  }
  bw_release(material);
}

check_main(check_test(sweeps), check_test(singular_stars), check_test(no_memory),
           check_test(nearly_incompressible), check_test(many_right_hand_sides),
           check_test(cancelled_at_once), check_test(cancelled), check_test(oblique_fibres))
