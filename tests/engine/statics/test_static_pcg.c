/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions by two-level PCG: the same as by a factor, under every kind of support,
 * of straight and of curved elements; when they are chosen, what is kept, and what is reported
 * where they do not serve. */
#include "incremental_bar.h"
#include "linear/system_two_level.h"

static bw_solver *pcg, *cholesky;
static bw_statics_options by_levels, by_factor;

static int make_solvers(void **state) {
  int result = check_setup(state);
  bw_context *context = check_context(state);
  pcg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG});
  cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  by_levels = (bw_statics_options){.solver = pcg, .inertia_relief = true};
  by_factor = (bw_statics_options){.solver = cholesky, .inertia_relief = true};
  return result;
}

static int release_solvers(void **state) {
  bw_release(pcg);
  bw_release(cholesky);
  return check_teardown(state);
}

static bool is_pcg(const bw_static *result) {
  return strcmp(result->report.solver, "pcg") == 0 &&
         strcmp(result->report.preconditioner, "two_level") == 0;
}

/* Displacements, reactions, energy and estimated error of both ways. */
static void compare_ways(bw_context *context, const bw_model *model) {
  bw_static *a = NULL, *b = NULL;
  const bw_mesh *mesh = model->mesh;
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *error = numbers(mesh->element_count), estimate[2];
  check_ok(context, bw_statics(context, model, NULL, &by_factor, &a));
  check_ok(context, bw_statics(context, model, NULL, &by_levels, &b));
  check_near(difference(b->displacement, a->displacement, size), 0, 1e-8);
  check_near(difference(b->reaction, a->reaction, size), 0, 1e-8);
  check_near(b->energy / a->energy, 1, 1e-8);
  assert_true(b->residual < 1e-10 || b->residual < 10 * a->residual); /* or as rounding leaves it */
  assert_false(is_pcg(a));
  assert_true(is_pcg(b));
  assert_in_range(b->report.iterations, 5, 100);
  assert_non_null(a->system->factor);
  assert_null(b->system->factor);
  assert_true(bw_bytes(b->system->two_level) > 0);
  check_ok(context,
           bw_error_estimate(context, mesh, model->material, a->displacement, error, &estimate[0]));
  check_ok(context,
           bw_error_estimate(context, mesh, model->material, b->displacement, error, &estimate[1]));
  check_near(estimate[1], estimate[0], 1e-8 * estimate[0] + 1e-9);
  free(error);
  bw_release(a);
  bw_release(b);
}

static void as_a_factor(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    compare_ways(context, b.model);
    bar_clear(&b);
  }
}

/* B-bar elements, whose blocks of two nodes are not symmetric. */
static void mean_dilatation(void **state) {
  bw_context *context = check_context(state);
  const bw_isotropic constants = {.name = "rubber", .young = 1e6, .poisson = 0.49};
  const double pull[3] = {3e3, 1e3, -2e3};
  bw_mesh *mesh = body_box(context, 4, 2, 2, 8, 4, 4, 2);
  bw_material *standard = NULL, *material = NULL;
  bw_model *model = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &standard));
  check_ok(context, bw_material_formulated(context, standard, BW_B_BAR, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_selection *low = body_face(context, mesh, 0, 0), *high = body_face(context, mesh, 0, 4);
  check_ok(context, bw_model_fix(context, model, low));
  check_ok(context, bw_model_force(context, model, high, pull));
  compare_ways(context, model);
  bw_release(low);
  bw_release(high);
  bw_release(model);
  bw_release(material);
  bw_release(standard);
  bw_release(mesh);
}

/* Bodies of which the supports leave one, three or six rigid-body modes free, on planes along the
 * axes and oblique ones; two bodies, of which one is fixed. */
static void partly_free(void **state) {
  bw_context *context = check_context(state);
  const double pull[3] = {3e5, 1e5, -2e5}, turn[3] = {2e4, 3e4, 1e4};
  const double normal[3][3] = {{1, 0, 0}, {0, 1, 0}, {0.6, 0, 0.8}};
  const int left[4] = {6, 3, 1, 1};
  for (int scene = 0; scene < 4; scene++) {
    bw_mesh *mesh = body_box(context, 4, 1, 1, 12, 3, 3, 2);
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    bw_dof_map *dof_map = NULL;
    check_ok(context, bw_model_create(context, mesh, material, &model));
    bw_selection *low = body_face(context, mesh, 0, 0), *side = body_face(context, mesh, 1, 0);
    bw_selection *high = body_face(context, mesh, 0, 4);
    if (scene > 0)
      check_ok(context, bw_model_slide(context, model, low, scene == 3 ? normal[2] : normal[0]));
    if (scene > 1)
      check_ok(context, bw_model_slide(context, model, side, normal[1]));
    check_ok(context, bw_model_force(context, model, high, pull));
    check_ok(context, bw_model_torque(context, model, high, turn, NULL));
    check_ok(context, bw_dof_map_create(context, model, &dof_map));
    assert_int_equal(dof_map->rigid_mode_count, left[scene]);
    compare_ways(context, model);
    bw_release(dof_map);
    bw_release(low);
    bw_release(side);
    bw_release(high);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* A part of two bodies, one fixed and one free. */
static void two_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = body_box(context, 2, 1, 1, 6, 3, 3, 2), *mesh = NULL;
  int64_t nodes = one->node_count, elements = one->element_count;
  double *x = numbers(6 * nodes);
  int32_t *element = malloc(20 * (size_t)elements * sizeof *element);
  for (int64_t i = 0; i < 3 * nodes; i++) {
    x[i] = one->node[i];
    x[3 * nodes + i] = one->node[i] + (i % 3 == 2 ? 3 : 0);
  }
  for (int64_t i = 0; i < 10 * elements; i++) {
    element[i] = one->element[i];
    element[10 * elements + i] = one->element[i] + one->node_count;
  }
  check_ok(context,
           bw_mesh_copy(context, 2, (int32_t)(2 * nodes), x, 2 * elements, element, NULL, &mesh));
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  const double gravity[3] = {1, 2, -9.81}, pull[3] = {1e5, 0, 3e5};
  const double point[3] = {0, 0, 0}, up[3] = {0, 0, 1}, tip[3] = {2, 0.5, 3.5};
  bw_selection *low = NULL, *high = NULL;
  check_ok(context, bw_select_plane(context, mesh, point, up, 1e-9, &low));
  check_ok(context, bw_select_patch(context, mesh, tip, 0.3, &high));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, low));
  check_ok(context, bw_model_gravity(context, model, gravity));
  check_ok(context, bw_model_force(context, model, high, pull));
  compare_ways(context, model);
  bw_release(low);
  bw_release(high);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(one);
  free(x);
  free(element);
}

/* Free bodies take no more iterations than held ones: as many for any size, and as many for a bar
 * 100 times as long as thick, of whose linear elements single precision knows too little. Of that
 * bar the rounding of the stored blocks, which the factor has and products by elements have not, is
 * 5e-9 of the displacement. */
static void free_bodies(void **state) {
  bw_context *context = check_context(state);
  const double pull[3] = {1e6, 2e6, 3e6};
  const int cells[3][3] = {{6, 6, 6}, {12, 12, 12}, {2, 2, 200}};
  int iterations[3];
  for (int k = 0; k < 3; k++) {
    const int *n = cells[k];
    bw_mesh *mesh = body_box(context, 1, 1, k < 2 ? 1 : 100, n[0], n[1], n[2], 2);
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    bw_static *a = NULL, *b = NULL;
    bw_selection *high = body_face(context, mesh, 2, k < 2 ? 1 : 100);
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_model_force(context, model, high, pull));
    check_ok(context, bw_statics(context, model, NULL, &by_levels, &a));
    check_ok(context, bw_statics(context, model, NULL, &by_factor, &b));
    check_near(difference(a->displacement, b->displacement, 3 * (int64_t)mesh->node_count), 0,
               k < 2 ? 1e-9 : 1e-8);
    iterations[k] = a->report.iterations;
    bw_release(a);
    bw_release(b);
    bw_release(high);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
  assert_in_range(iterations[0], 5, 40);
  assert_in_range(iterations[1], 5, 40);
  assert_in_range(iterations[2], 5, 40);
  assert_true(iterations[1] <= iterations[0] + iterations[0] / 4);
}

/* A block bent to a quarter of a ring: its elements are curved, and the linear ones no longer a
 * part of the space. */
static bw_mesh *ring(bw_context *context) {
  bw_mesh *mesh = body_box(context, 8, 1, 1, 12, 2, 3, 2), *bent = NULL;
  double *x = numbers(3 * (int64_t)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *from = mesh->node + 3 * i;
    double angle = from[0] / 5, radius = 4.5 + from[2];
    x[3 * i] = radius * sin(angle);
    x[3 * i + 1] = from[1];
    x[3 * i + 2] = radius * cos(angle);
  }
  check_ok(context, bw_mesh_moved(context, mesh, x, &bent));
  free(x);
  bw_release(mesh);
  return bent;
}

static void curved_elements(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = ring(context);
  bw_material *material = body_material(context);
  const double gravity[3] = {1, 2, -9.81}, pull[3] = {1e5, 2e5, -3e5};
  const double below[3] = {0, 0.5, 4.5}, end[3] = {5 * sin(1.6), 0.5, 5 * cos(1.6)};
  /* built in; free; sliding on its curved surface along the normals */
  for (int scene = 0; scene < 3; scene++) {
    bw_model *model = NULL;
    bw_selection *root = body_face(context, mesh, 0, 0), *inner = NULL, *tip = NULL;
    check_ok(context, bw_select_patch(context, mesh, below, 0.3, &inner));
    check_ok(context, bw_select_patch(context, mesh, end, 0.3, &tip));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    if (scene == 0)
      check_ok(context, bw_model_fix(context, model, root));
    if (scene == 2)
      check_ok(context, bw_model_slide(context, model, inner, NULL));
    check_ok(context, bw_model_gravity(context, model, gravity));
    check_ok(context, bw_model_force(context, model, tip, pull));
    compare_ways(context, model);
    bw_release(root);
    bw_release(inner);
    bw_release(tip);
    bw_release(model);
  }
  bw_release(material);
  bw_release(mesh);
}

/* A block of cells x cells x cells cubes, built in below and pulled along z. */
typedef struct block {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
} block;

static block make_block(bw_context *context, int nx, int ny, int nz, int order) {
  block b = {.mesh = body_box(context, nx, ny, nz, nx, ny, nz, order)};
  bw_selection *low = body_face(context, b.mesh, 2, 0), *high = body_face(context, b.mesh, 2, nz);
  const double pull[3] = {1e6, 2e6, 3e6};
  b.material = body_material(context);
  check_ok(context, bw_model_create(context, b.mesh, b.material, &b.model));
  check_ok(context, bw_model_fix(context, b.model, low));
  check_ok(context, bw_model_force(context, b.model, high, pull));
  bw_release(low);
  bw_release(high);
  return b;
}

static void clear_block(block *b) {
  bw_release(b->model);
  bw_release(b->material);
  bw_release(b->mesh);
}

/* The same body with the height times a factor. */
static void flatten(bw_context *context, block *b, double factor) {
  bw_mesh *mesh = NULL;
  double *x = numbers(3 * (int64_t)b->mesh->node_count), top = 0;
  for (int32_t i = 0; i < 3 * b->mesh->node_count; i++) {
    x[i] = b->mesh->node[i] * (i % 3 == 2 ? factor : 1);
    top = i % 3 == 2 ? fmax(top, x[i]) : top;
  }
  check_ok(context, bw_mesh_moved(context, b->mesh, x, &mesh));
  bw_selection *low = body_face(context, mesh, 2, 0), *high = body_face(context, mesh, 2, top);
  const double pull[3] = {1e6, 2e6, 3e6};
  bw_release(b->model);
  bw_release(b->mesh);
  b->mesh = mesh;
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
  check_ok(context, bw_model_fix(context, b->model, low));
  check_ok(context, bw_model_force(context, b->model, high, pull));
  bw_release(low);
  bw_release(high);
  free(x);
}

/* What is predicted of a factor is near what it is, for thick, long and flat bodies. */
static void factor_is_predicted(void **state) {
  bw_context *context = check_context(state);
  const int cells[4][3] = {{8, 8, 7}, {3, 3, 40}, {20, 20, 1}, {12, 12, 3}};
  for (int k = 0; k < 4; k++) {
    block b = make_block(context, cells[k][0], cells[k][1], cells[k][2], 2);
    bw_static *a = NULL, *l = NULL;
    check_ok(context, bw_statics(context, b.model, NULL, &by_factor, &a));
    check_ok(context, bw_statics(context, b.model, NULL, &by_levels, &l));
    assert_true(a->report.bytes == (double)a->system->times.factor_entries * 8);
    const bwi_cost_prediction *predicted = &l->system->two_level->prediction;
    check_near(log(predicted->factor_bytes / a->report.bytes), 0, log(1.4));
    check_near(log(predicted->factor_flops / a->report.flops), 0, log(1.6));
    bw_release(a);
    bw_release(l);
    clear_block(&b);
  }
}

/* Of displacements, relative. */
static double distance(const bw_static *a, const bw_static *b) {
  double square = 0, size = 0;
  for (int64_t i = 0; i < 3 * (int64_t)a->system->mesh->node_count; i++) {
    square += (a->displacement[i] - b->displacement[i]) * (a->displacement[i] - b->displacement[i]);
    size += b->displacement[i] * b->displacement[i];
  }
  return sqrt(square / size);
}

/* Small bodies: the factor, in the bits that it has always had; also by default. Without memory for
 * it, two-level PCG, on linear elements PCG with multigrid. */
static void small_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_static *result = NULL, *same = NULL;
  block b = make_block(context, 5, 5, 5, 2);
  check_ok(context, bw_statics(context, b.model, NULL, NULL, &result));
  check_ok(context, bw_statics(context, b.model, NULL, &by_factor, &same));
  assert_false(is_pcg(result));
  assert_memory_equal(result->displacement, same->displacement,
                      3 * (size_t)b.mesh->node_count * sizeof(double));
  bw_release(same);
  /* PCG when asked for, beside the factor that is there; which then serves again */
  check_ok(context, bw_statics(context, b.model, result->system, &by_levels, &same));
  assert_true(is_pcg(same));
  assert_ptr_equal(same->system, result->system);
  bw_release(same);
  check_ok(context, bw_statics(context, b.model, result->system, NULL, &same));
  assert_false(is_pcg(same));
  assert_ptr_equal(same->system, result->system);
  bw_release(same);
  bw_release(result);
  same = NULL;
  const bw_statics_options narrow = {.solver = cholesky, .memory = 1e6};
  check_fails(context, BW_MEMORY, "the solver pcg",
              bw_statics(context, b.model, NULL, &narrow, &result));
  const bw_statics_options none = {.memory = 1e4};
  check_ok(context, bw_statics(context, b.model, NULL, NULL, &result));
  check_ok(context, bw_statics(context, b.model, NULL, &none, &same));
  assert_true(is_pcg(same));
  assert_string_equal(same->report.preconditioner, "two_level");
  assert_string_equal(same->report.reason, "there is no memory for a factor");
  assert_true(distance(same, result) < 1e-8);
  bw_release(same);
  same = NULL;
  bw_release(result);
  clear_block(&b);
  b = make_block(context, 4, 4, 4, 1);
  check_ok(context, bw_statics(context, b.model, NULL, NULL, &result));
  for (int k = 0; k < 2; k++) { /* the preconditioner serves again */
    bw_system *system = k ? bw_retain(same->system) : NULL;
    bw_release(same);
    check_ok(context, bw_statics(context, b.model, system, &none, &same));
    bw_release(system);
    assert_string_equal(same->report.preconditioner, "amg");
    assert_string_equal(same->report.reason, "there is no memory for a factor");
    assert_true(same->report.reused == k);
    assert_true(distance(same, result) < 1e-8);
  }
  bw_release(same);
  bw_release(result);
  check_fails(context, BW_INVALID, "these are linear",
              bw_statics(context, b.model, NULL, &by_levels, &result));
  clear_block(&b);
  const bw_statics_options wrong = {.memory = NAN};
  check_fails(context, BW_INVALID, "memory", bw_statics(context, NULL, NULL, &wrong, &result));
}

/* A body that has no room for a factor is solved by two-level PCG, as exactly; asked for again, the
 * factor is made once the sum of what PCG costs would come to more. It then serves modes. */
static void large_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_static *first = NULL, *next = NULL;
  bw_modes *modes = NULL;
  block b = make_block(context, 11, 11, 10, 2);
  const bw_statics_options narrow = {.memory = 1e6}, wide = {.memory = 1e9};
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  int over_levels = 0;
  check_ok(context, bw_statics(context, b.model, NULL, &narrow, &first));
  assert_true(is_pcg(first));
  assert_true(first->residual < 1e-10);
  double sum[3] = {1e6, 2e6, 3e6};
  for (int64_t i = 0; i < size; i++)
    sum[i % 3] += first->reaction[i];
  for (int c = 0; c < 3; c++)
    check_near(sum[c], 0, 1e-10 * 3e6);
  bw_system *system = first->system;
  assert_null(system->mass);
  check_fails(context, BW_INVALID, "has no factor",
              bw_modes_elastic(context, system, NULL, &modes));
  for (;;) {
    check_ok(context, bw_statics(context, b.model, system, &wide, &next));
    assert_ptr_equal(next->system, system);
    check_near(difference(next->displacement, first->displacement, size), 0, 1e-8);
    if (!is_pcg(next))
      break;
    assert_true(system->two_level->spent < next->report.rival_cost);
    over_levels++;
    bw_release(next);
  }
  assert_in_range(over_levels, 1, 12);
  assert_null(system->two_level);
  const bw_modes_options few = {.count = 1, .tolerance = 1e-6, .sturm = false};
  check_ok(context, bw_modes_elastic(context, system, &few, &modes));
  assert_int_equal(modes->count, 1);
  bw_release(modes);
  bw_release(next);
  bw_release(first);
  clear_block(&b);
}

/* A block of 37,000 unknowns on three sliding planes, pulled: a linear field, exact. */
static void block_in_tension(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 2, 1, 1, 20, 8, 10, 2);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  const double traction[3] = {1e6, 0, 0};
  double normal[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  for (int c = 0; c < 3; c++) {
    bw_selection *plane = body_face(context, mesh, c, 0);
    check_ok(context, bw_model_slide(context, model, plane, normal[c]));
    bw_release(plane);
  }
  bw_selection *end = body_face(context, mesh, 0, 2);
  check_ok(context, bw_model_traction(context, model, end, traction));
  bw_static *result = NULL;
  check_ok(context, bw_statics(context, model, NULL, &by_levels, &result));
  double strain = 1e6 / material->young[0], reaction = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i, *u = result->displacement + 3 * i;
    check_near(u[0], strain * x[0], 1e-10 * strain);
    check_near(u[1], -material->poisson[0] * strain * x[1], 1e-10 * strain);
    check_near(u[2], -material->poisson[0] * strain * x[2], 1e-10 * strain);
    reaction += result->reaction[3 * i];
  }
  check_near(reaction, -1e6, 1e-3);
  check_near(result->energy, 0.5 * 1e6 * strain * 2, 1e-9);
  bw_release(result);
  bw_release(end);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* Too few iterations: an error that says what to do, or, where there is room, the factor and a
 * warning. */
static void not_converged(void **state) {
  bw_context *context = check_context(state);
  bw_static *first = NULL, *result = NULL;
  block b = make_block(context, 11, 11, 11, 2);
  bw_solver *short_pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .max_iterations = 4});
  bw_statics_options options = {.solver = short_pcg};
  check_fails(context, BW_CONVERGENCE, "the solver cholesky",
              bw_statics(context, b.model, NULL, &options, &result));
  check_fails(context, BW_CONVERGENCE, "in 4 iterations",
              bw_statics(context, b.model, NULL, &options, &result));
  bw_release(short_pcg);
  check_ok(context, bw_statics(context, b.model, NULL, &by_levels, &first));
  bw_release(first);
  clear_block(&b);
  /* By itself: a body so nearly incompressible that iterating costs more than the factor. A loose
   * solution first, so that there is a preconditioner and PCG is predicted to be better. */
  b = make_block(context, 11, 11, 11, 2);
  const bw_isotropic rubber = {.name = "rubber", .young = 1e6, .poisson = 0.49999};
  bw_release(b.material);
  check_ok(context, bw_material_isotropic(context, &rubber, &b.material));
  flatten(context, &b, 1);
  bw_solver *loose =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .tolerance = 0.9});
  const bw_statics_options loosely = {.solver = loose}, wide = {.memory = 1e10};
  check_ok(context, bw_statics(context, b.model, NULL, &loosely, &first));
  bw_clear_warnings(context);
  check_ok(context, bw_statics(context, b.model, first->system, &wide, &result));
  assert_false(is_pcg(result));
  assert_true(result->report.iterations > 20); /* in vain */
  assert_non_null(strstr(bw_warning_at(context, 0), "Cholesky factorisation"));
  bw_release(loose);
  bw_release(result);
  bw_release(first);
  clear_block(&b);
}

/* Two blocks in contact at an edge, one of them fixed: turning about the edge costs nothing. */
static void mechanism(void **state) {
  bw_context *context = check_context(state);
  const double x[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}};
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
  bw_static *result = NULL;
  check_fails(context, BW_SINGULAR, "singular", bw_statics(context, model, NULL, NULL, &result));
  check_fails(context, BW_SINGULAR, "the solver cholesky",
              bw_statics(context, model, NULL, &by_levels, &result));
  bw_release(fixed);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(linear);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  block b = make_block(context, 5, 5, 12, 2);
  bw_static *result[2] = {NULL};
  for (int k = 0; k < 2; k++) {
    check_ok(context, bw_set_threads(context, k ? 4 : 1));
    check_ok(context, bw_statics(context, b.model, NULL, &by_levels, &result[k]));
  }
  size_t size = 3 * (size_t)b.mesh->node_count * sizeof(double);
  assert_memory_equal(result[0]->displacement, result[1]->displacement, size);
  assert_memory_equal(result[0]->reaction, result[1]->reaction, size);
  for (int k = 0; k < 2; k++)
    bw_release(result[k]);
  clear_block(&b);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  block b = make_block(context, 2, 2, 2, 2);
  bw_static *result = NULL;
  check_allocations(context, result, bw_statics(context, b.model, NULL, &by_levels, &result));
  /* what is left of a system is as good as before */
  bw_static *first = NULL;
  check_ok(context, bw_statics(context, b.model, NULL, &by_levels, &first));
  for (int64_t n = 1;; n++) {
    bw_fail_allocation(n, true);
    bw_status status = bw_system_factor(context, first->system);
    bw_fail_allocation(0, false);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    bw_clear_failure(context);
    bw_static *again = NULL;
    check_ok(context, bw_statics(context, b.model, first->system, &by_levels, &again));
    bw_release(again);
  }
  bw_release(first);
  clear_block(&b);
}

/* The machine has some memory, and not more than there are addresses. */
static void available_memory(void **state) {
  (void)state;
  double bytes = bw_available_memory();
  assert_true(bytes > 1e6 && bytes < 1e18);
}

#define solver_test(function)                                                                      \
  cmocka_unit_test_setup_teardown(function, make_solvers, release_solvers)

check_main(solver_test(as_a_factor), solver_test(partly_free), solver_test(two_bodies),
           solver_test(free_bodies), solver_test(curved_elements), solver_test(factor_is_predicted),
           solver_test(small_bodies), solver_test(large_bodies), solver_test(not_converged),
           solver_test(mechanism), solver_test(same_bits), solver_test(no_memory),
           solver_test(available_memory), solver_test(block_in_tension),
           solver_test(mean_dilatation))
