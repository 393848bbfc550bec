/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Algebraic multigrid as preconditioner: solutions as by a factor under every kind of support, of
 * linear and of quadratic elements; iterations that sizes do not change; few on a free plate; a
 * symmetric and positive operator, in the same bits on any number of threads; and right-hand sides
 * side by side on packed fields, as by the same operator on fields that are not. */
#include "linear/pcg.h"
#include "linear/pcg_space.h"
#include "linear/system_two_level.h"

#include "base/dense.h"
#include "incremental_bar.h"

/* Displacements and energy by multigrid and by a factor; returns iterations. `afloat`: the body can
 * move freely, and no displacement is along its rigid-body modes. */
static int compare_ways(bw_context *context, const bw_model *model, bool afloat) {
  bw_static *a = NULL, *b = NULL;
  bw_solver *amg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG});
  bw_solver *pcg = body_solver(
      context,
      (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg, .tolerance = 1e-11});
  bw_solver *cholesky = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_statics_options options = {.solver = pcg, .inertia_relief = afloat};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  check_ok(context, bw_statics(context, model, NULL, &options, &a));
  options.solver = cholesky;
  check_ok(context, bw_statics(context, model, NULL, &options, &b));
  check_near(difference(a->displacement, b->displacement, size), 0, 1e-8);
  check_near(a->energy / b->energy, 1, 1e-8);
  if (afloat) {
    double part[12];
    const bw_dof_map *dof_map = a->system->dof_map;
    assert_in_range(dof_map->rigid_mode_count, 1, 12);
    bw_rigid_modes_measure(dof_map, a->displacement, part);
    for (int m = 0; m < dof_map->rigid_mode_count; m++)
      check_near(part[m], 0, 1e-10 * sqrt(bwi_dot(size, b->displacement, b->displacement)));
  }
  assert_string_equal(a->report.preconditioner, "amg");
  assert_null(a->system->factor);
  assert_true(bw_bytes(a->system->preconditioner) > 0);
  int iterations = a->report.iterations;
  bw_release(a);
  bw_release(b);
  bw_release(amg);
  bw_release(pcg);
  bw_release(cholesky);
  return iterations;
}

static void as_a_factor(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int scene = 0; scene < SCENES; scene++) {
      bar b;
      bar_make(context, 2, order, &b);
      load_bar(context, &b, scene);
      assert_in_range(compare_ways(context, b.model, scene == 3), 2, 120);
      bar_clear(&b);
    }
}

/* A cube of n x n x n cubes of elements, or a bar eight times as long, fixed at one end or afloat.
 */
static bw_model *cube(bw_context *context, int length, int n, int order, bool afloat) {
  bw_mesh *mesh = body_box(context, length, 1, 1, length * n, n, n, order);
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

static void sizes_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  const int size[3][2] = {{1, 8}, {1, 20}, {8, 6}};
  for (int afloat = 0; afloat < 2; afloat++) {
    int iterations[3];
    for (int k = 0; k < 3; k++) {
      bw_model *model = cube(context, size[k][0], size[k][1], 1, afloat);
      iterations[k] = compare_ways(context, model, afloat);
      bw_release(model);
    }
    assert_in_range(iterations[0], 5, 30);
    assert_true(iterations[1] <= iterations[0] + 6);
    assert_true(iterations[2] <= iterations[0] + 10);
  }
}

/* Aggregates of aggregates that are too large took 44. */
static void of_a_free_plate(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 30, 30, 1, 100, 100, 3, 1);
  bw_material *material = body_material(context);
  bw_selection *tip = body_face(context, mesh, 0, 30);
  bw_solver *amg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG});
  bw_solver *pcg = body_solver(
      context,
      (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg, .tolerance = 1e-10});
  bw_statics_options options = {.solver = pcg, .inertia_relief = true};
  const double pull[3] = {1, 0.3, -1};
  bw_model *model = NULL;
  bw_static *solution = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_force(context, model, tip, pull));
  check_ok(context, bw_statics(context, model, NULL, &options, &solution));
  assert_in_range(solution->report.iterations, 5, 40);
  bw_release(solution);
  bw_release(model);
  bw_release(pcg);
  bw_release(amg);
  bw_release(tip);
  bw_release(material);
  bw_release(mesh);
}

/* Two bodies in one mesh, of which none, one or both are held: each has its own null space. */
static void of_several_bodies(void **state) {
  bw_context *context = check_context(state);
  for (int held = 0; held < 3; held++) {
    bw_mesh *part[2] = {body_box(context, 1, 1, 1, 5, 5, 5, 1),
                        body_box(context, 1, 1, 1, 6, 4, 4, 1)};
    int32_t nodes = part[0]->node_count + part[1]->node_count;
    int32_t elements = part[0]->element_count + part[1]->element_count;
    double *node = numbers(3 * (int64_t)nodes);
    int32_t *element = malloc(4 * (size_t)elements * sizeof *element);
    for (int p = 0, at = 0, e = 0; p < 2;
         at += part[p]->node_count, e += part[p]->element_count, p++) {
      for (int64_t i = 0; i < 3 * (int64_t)part[p]->node_count; i++)
        node[3 * at + i] = part[p]->node[i] + 3 * p;
      for (int64_t i = 0; i < 4 * (int64_t)part[p]->element_count; i++)
        element[4 * e + i] = part[p]->element[i] + at;
    }
    bw_mesh *mesh = NULL;
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    const double pull[3] = {1e6, 2e6, 3e6};
    check_ok(context, bw_mesh_copy(context, 1, nodes, node, elements, element, NULL, &mesh));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    for (int p = 0; p < 2; p++) {
      bw_selection *root = body_face(context, mesh, 0, 3 * p),
                   *tip = body_face(context, mesh, 0, 3 * p + 1);
      if (p < held)
        check_ok(context, bw_model_fix(context, model, root));
      check_ok(context, bw_model_force(context, model, tip, pull));
      bw_release(root);
      bw_release(tip);
    }
    assert_in_range(compare_ways(context, model, held < 2), 5, 40);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
    bw_release(part[0]);
    bw_release(part[1]);
    free(node);
    free(element);
  }
}

/* Without a solver: multigrid where there is no memory for a factor, which is counted, and where
 * solutions to come would not have paid for one. */
static void chosen_by_cost(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = cube(context, 1, 21, 1, false), *small = cube(context, 1, 8, 1, false);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  bw_static *result = NULL, *again = NULL, *direct = NULL;
  bw_statics_options options = {.memory = 1e6};
  check_ok(context, bw_statics(context, model, NULL, &options, &result));
  assert_string_equal(result->report.preconditioner, "amg");
  assert_non_null(strstr(result->report.reason, "a factor is predicted to take"));
  assert_true(result->report.rival_cost > 0 && result->report.predicted_cost > 0);
  double bytes = result->system->two_level->prediction.factor_bytes;
  check_ok(context, bw_statics(context, model, result->system, &options, &again));
  assert_true(again->report.reused == 1);
  assert_memory_equal(again->displacement, result->displacement, (size_t)size * sizeof(double));
  check_ok(context, bw_statics(context, model, NULL, NULL, &direct)); /* it is cheap */
  assert_string_equal(direct->report.solver, "cholesky");
  check_near(bytes / (double)bwi_factor_bytes(direct->system->factor), 1, 1e-12);
  check_near(difference(result->displacement, direct->displacement, size), 0, 1e-8);
  bw_release(again);
  check_ok(context, bw_statics(context, small, NULL, NULL, &again));
  assert_string_equal(again->report.solver, "cholesky");
  bw_release(again);
  bw_release(direct);
  bw_release(result);
  bw_release(small);
  bw_release(model);
}

static bwi_amg *amg_of(bw_context *context, const bw_system *system) {
  bwi_amg *amg = NULL;
  const bwi_matrix matrix = {
      .pattern = system->pattern, .stiffness = system->stiffness, .dof_map = system->dof_map};
  check_ok(context, bwi_amg_create(context, &matrix, true, &amg));
  return amg;
}

/* Of several fields at once each is as by itself; x . B y = y . B x, x . B x > 0; and the bits. */
static void check_operator(bw_context *context, bool afloat) {
  enum { FIELDS = 11 };
  bw_model *model = cube(context, 1, 16, 1, afloat);
  bw_static *direct = NULL;
  const bw_statics_options by_inertia = {.inertia_relief = true};
  check_ok(context, bw_statics(context, model, NULL, &by_inertia, &direct));
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *r = numbers(FIELDS * size), *z = numbers(FIELDS * size), *one = numbers(size);
  double *same = numbers(FIELDS * size);
  random_field(3, FIELDS * size, r);
  for (int threads = 1; threads <= 4; threads += 3) {
    check_ok(context, bw_set_threads(context, threads));
    bwi_amg *amg = amg_of(context, direct->system);
    assert_true(amg->level_count >= 3);
    check_ok(context, bwi_amg_apply(context, amg, FIELDS, r, z));
    if (threads == 1)
      memcpy(same, z, (size_t)(FIELDS * size) * sizeof *z);
    else
      assert_memory_equal(same, z, (size_t)(FIELDS * size) * sizeof *z);
    for (int k = 0; k < FIELDS; k += 10) {
      check_ok(context, bwi_amg_apply(context, amg, 1, r + k * size, one));
      check_near(difference(one, z + k * size, size), 0, 1e-4);
    }
    bw_release(amg);
  }
  for (int a = 0; a < FIELDS; a++)
    for (int b = 0; b <= a; b++) {
      double there = bwi_dot(size, r + a * size, z + b * size);
      double back = bwi_dot(size, r + b * size, z + a * size);
      double scale = sqrt(bwi_dot(size, r + a * size, z + a * size) *
                          bwi_dot(size, r + b * size, z + b * size));
      assert_true(scale > 0);
      check_near(there, back, 1e-4 * scale);
    }
  free(r);
  free(z);
  free(one);
  free(same);
  bw_release(direct);
  bw_release(model);
}

static void operator_is_symmetric(void **state) {
  check_operator(check_context(state), false);
  check_operator(check_context(state), true);
}

/* ---- right-hand sides side by side ----------------------------------------------------------- */

/* What the unpacked iteration works with. */
typedef struct plain {
  const bw_system *system;
  bwi_amg *amg;
  bwi_rigid_space *rigid; /* or NULL */
} plain;

static bw_status plain_project(bw_context *context, void *data, int64_t count, double *x) {
  const plain *p = data;
  int64_t size = 3 * (int64_t)p->system->mesh->node_count;
  const bwi_field_layout layout = {3, 1, size};
  bw_status status = BW_OK;
  for (int64_t k = 0; k < count && status == BW_OK; k++) {
    bwi_keep_states(p->system->dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC,
                    x + k * size);
    if (p->rigid)
      status = bwi_rigid_space_project(context, p->rigid, &layout, 1, x + k * size);
  }
  return status;
}

static bw_status plain_multiply(bw_context *context, void *data, int64_t count, const double *x,
                                double *y) {
  const plain *p = data;
  bw_status status =
      bw_block_multiply(context, p->system->pattern, p->system->stiffness, 9, 3, count, x, y);
  return status == BW_OK ? plain_project(context, data, count, y) : status;
}

static bw_status plain_precondition(bw_context *context, void *data, int64_t count, const double *r,
                                    double *z) {
  const plain *p = data;
  bw_status status = bwi_amg_apply(context, p->amg, count, r, z);
  return status == BW_OK ? plain_project(context, data, count, z) : status;
}

/* Iterations of `count` right-hand sides, unpacked. */
static int solve_plain(bw_context *context, plain *p, int64_t count, const double *f, double *u) {
  const bw_dof_map *dof_map = p->system->dof_map;
  const bwi_pcg_fields fields = {.size = 3 * (int64_t)p->system->mesh->node_count,
                                 .multiply = plain_multiply,
                                 .multiply_data = p,
                                 .precondition = plain_precondition,
                                 .precondition_data = p,
                                 .project = plain_project,
                                 .project_data = p};
  bwi_pcg_task task = {.columns = (int)count,
                       .energy_tolerance = 1e-10,
                       .residual_tolerance = 1e-10,
                       .energy_fall = BWI_ENERGY_FALLS,
                       .limit = 200};
  int32_t *row_of = malloc((size_t)p->system->mesh->node_count * sizeof *row_of);
  for (int32_t i = 0; i < p->system->mesh->node_count; i++)
    row_of[i] = i;
  if (dof_map->rigid_mode_count > 0)
    check_ok(context, bwi_rigid_space_create(context, dof_map, row_of, &p->rigid));
  check_ok(context, bwi_pcg_fields_run(context, &fields, &task, f, u));
  assert_true(task.converged);
  bw_release(p->rigid);
  free(row_of);
  return task.iterations;
}

static void cancel_at_once(void *data, const char *stage, double fraction) {
  (void)stage;
  (void)fraction;
  bw_cancel(data);
}

/* Of each number of columns: 1, 4, 8, and 12 with 2 more. */
static void check_packed(bw_context *context, int order, int scene) {
  enum { MOST = 14 };
  static const int counts[] = {1, 3, 8, MOST};
  bar b;
  bw_static *direct = NULL;
  bw_solver *amg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG});
  bw_solver *pcg =
      body_solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg});
  const bw_statics_options options = {.inertia_relief = true, .solver = pcg};
  bar_make(context, 3, order, &b);
  load_bar(context, &b, scene);
  check_ok(context, bw_statics(context, b.model, NULL, &options, &direct));
  int64_t size = 3 * (int64_t)b.model->mesh->node_count;
  plain p = {.system = direct->system, .amg = direct->system->preconditioner->amg};
  double *f = numbers(MOST * size), *u = numbers(MOST * size), *reference = numbers(MOST * size);
  double *same = numbers(MOST * size);
  random_field(3, MOST * size, f);
  check_ok(context, bwi_balance_fields(context, p.system->dof_map, MOST, f));
  int iterations = solve_plain(context, &p, MOST, f, reference);
  check_ok(context, bwi_steady_fields(context, p.system->dof_map, MOST, reference));
  for (int c = 0; c < 4; c++) {
    bwi_amg_problem problem = {.tolerance = 1e-10, .limit = 200};
    check_ok(context, bwi_amg_solve(context, p.amg, &problem, counts[c], f, u));
    assert_true(problem.converged);
    assert_true(problem.iterations <= iterations + 2);
    for (int threads = 1; threads <= 4; threads += 3) {
      check_ok(context, bw_set_threads(context, threads));
      check_ok(context, bwi_amg_solve(context, p.amg, &problem, counts[c], f, same));
      assert_memory_equal(same, u, (size_t)(counts[c] * size) * sizeof *u);
    }
    check_ok(context, bwi_steady_fields(context, p.system->dof_map, counts[c], u));
    for (int k = 0; k < counts[c]; k++)
      check_near(difference(u + k * size, reference + k * size, size), 0, 1e-8);
  }
  if (p.amg->rigid) { /* what rounding may leave of the resultant is taken off */
    bwi_amg_problem problem = {.tolerance = 1e-10, .limit = 200};
    f[0] += 1e-8 * sqrt(bwi_dot(size, f, f));
    check_ok(context, bwi_amg_solve(context, p.amg, &problem, 1, f, u));
    assert_true(problem.converged && problem.iterations <= iterations + 2);
  }
  bwi_amg_problem few = {.tolerance = 1e-10, .limit = 2};
  check_ok(context, bwi_amg_solve(context, p.amg, &few, MOST, f, u));
  assert_false(few.converged);
  assert_true(few.residual > 1e-10);
  bw_set_progress(context, cancel_at_once, context);
  assert_int_equal(bwi_amg_solve(context, p.amg, &few, MOST, f, u), BW_CANCELLED);
  bw_set_progress(context, NULL, NULL);
  bw_clear_cancel(context);
  bw_clear_failure(context);
  free(f);
  free(u);
  free(reference);
  free(same);
  bw_release(direct);
  bw_release(amg);
  bw_release(pcg);
  bar_clear(&b);
}

static void side_by_side(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int scene = 0; scene < SCENES; scene++)
      check_packed(context, order, scene);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = cube(context, 1, 6, 1, true);
  bw_static *direct = NULL;
  const bw_statics_options by_inertia = {.inertia_relief = true};
  check_ok(context, bw_statics(context, model, NULL, &by_inertia, &direct));
  const bw_system *system = direct->system;
  const bwi_matrix matrix = {
      .pattern = system->pattern, .stiffness = system->stiffness, .dof_map = system->dof_map};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *r = numbers(size), *z = numbers(size);
  random_field(3, size, r);
  bw_solver *amg = body_solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG});
  check_each_allocation(context, status, 1) {
    bwi_preconditioner *made = NULL;
    int32_t bad = 0;
    status = bwi_preconditioner_create(context, amg, &matrix, NULL, &made, &bad);
    if (status == BW_OK)
      status = bwi_preconditioner_apply(context, made, 1, r, z);
    bwi_amg_problem problem = {.tolerance = 1e-2, .limit = 2};
    if (status == BW_OK)
      status = bwi_amg_solve(context, made->amg, &problem, 1, r, z);
    bw_release(made);
  }
  free(r);
  free(z);
  bw_release(amg);
  bw_release(direct);
  bw_release(model);
}

check_main(check_test(as_a_factor), check_test(sizes_do_not_matter), check_test(of_a_free_plate),
           check_test(of_several_bodies), check_test(chosen_by_cost),
           check_test(operator_is_symmetric), check_test(side_by_side), check_test(no_memory))
