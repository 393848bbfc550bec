/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elements at finite displacements, indefinite factors, and paths of equilibrium. */
#include "bodies.h"

#include "barwright/finite.h"
#include "linear/internal.h"

static void bend(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = 0.3 * unit[0];
  out[1] = 0.1 * unit[1] + 0.03 * unit[0] * unit[0];
  out[2] = 0.05 * unit[2] + 0.01 * unit[1] * unit[0];
}

/* Quadratic elements with straight edges or curved ones, or linear ones. */
static bw_mesh *body(bw_context *context, int which) {
  const int cells[3] = {3, 2, 2};
  bw_mesh *mesh = NULL;
  if (which % 2)
    return body_box(context, 0.3, 0.1, 0.05, 3, 2, 2, 2);
  check_ok(context, bw_mesh_mapped_box(context, cells, which ? 2 : 1, bend, NULL, &mesh));
  return mesh;
}

/* A material of three directions, turned out of the axes. */
static bw_material *timber(bw_context *context) {
  const bw_orthotropic constants = {.name = "timber",
                                    .young = {12e9, 0.8e9, 0.5e9},
                                    .poisson = {0.3, 0.02, 0.4},
                                    .shear = {0.6e9, 0.7e9, 0.05e9},
                                    .density = 500};
  const double c = 0.8, s = 0.6, turn[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  bw_material *straight = NULL, *turned = NULL;
  check_ok(context, bw_material_orthotropic(context, &constants, &straight));
  check_ok(context, bw_material_rotated(context, straight, turn, &turned));
  bw_release(straight);
  return turned;
}

/* Forces are the derivative of the energy, tangents that of forces, and symmetric: tet4, tet10,
 * curved tet10, B-bar, an orthotropic law, and temperatures. */
static void derivatives(void **state) {
  bw_context *context = check_context(state);
  for (int which = 0; which < 6; which++) {
    bw_mesh *mesh = body(context, which == 4 ? 2 : which);
    bw_material *material = which == 4 ? timber(context) : body_material(context);
    bw_model *model = NULL;
    bw_block_pattern *pattern = NULL;
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *u = numbers(size), *d = numbers(size), *f = numbers(size), *kd = numbers(size);
    double *at[2] = {numbers(size), numbers(size)}, *moved = numbers(size), energy[3];
    if (which == 3) {
      bw_material *standard = material;
      check_ok(context, bw_material_formulated(context, standard, BW_B_BAR, &material));
      bw_release(standard);
    }
    check_ok(context, bw_model_create(context, mesh, material, &model));
    if (which == 5) {
      const double expansion = 1e-3;
      bw_array *change = NULL;
      check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &change));
      for (int32_t i = 0; i < mesh->node_count; i++)
        ((double *)change->data)[i] = 20 + 100 * mesh->node[3 * i];
      check_ok(context, bw_model_temperature(context, model, change, &expansion));
      bw_release(change);
    }
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *k = numbers(9 * pattern->block_count);
    random_field(3, size, u);
    random_field(4, size, d);
    for (int64_t i = 0; i < size; i++)
      u[i] = 1e-3 * u[i] + (i % 3 == 1 ? 0.6 * mesh->node[i - 1]
                            : i % 3    ? 0
                                       : -0.2 * mesh->node[i]);
    const double step = 1e-7;
    check_ok(context, bw_finite_forces(context, model, pattern, u, 0.7, &energy[2], f, k));
    for (int side = 0; side < 2; side++) {
      for (int64_t i = 0; i < size; i++)
        moved[i] = u[i] + (side ? step : -step) * d[i];
      check_ok(context, bw_finite_forces(context, model, pattern, moved, 0.7, &energy[side],
                                         at[side], NULL));
    }
    check_ok(context, bw_block_multiply(context, pattern, k, 9, 3, 1, d, kd));
    double work = 0, largest = 0, off = 0;
    for (int64_t i = 0; i < size; i++) {
      work += f[i] * d[i];
      largest = fmax(largest, fabs(kd[i]));
      off = fmax(off, fabs((at[1][i] - at[0][i]) / (2 * step) - kd[i]));
    }
    check_near(off / largest, 0, 1e-7);
    check_near((energy[1] - energy[0]) / (2 * step) / work, 1, 1e-6);
    for (int64_t i = 0; i < pattern->node_count; i++) { /* blocks of the diagonal */
      const double *block = k + 9 * (pattern->start[i + 1] - 1);
      for (int a = 0; a < 9; a++)
        check_near(block[a], block[3 * (a % 3) + a / 3], 1e-12 * largest / 1e-3);
    }
    /* at rest it is the stiffness of the linear analysis */
    double *linear = numbers(9 * pattern->block_count), most = 0;
    memset(u, 0, (size_t)size * sizeof *u);
    check_ok(context, bw_finite_forces(context, model, pattern, u, 0, &energy[0], f, k));
    check_ok(context, bw_stiffness(context, pattern, mesh, material, linear));
    for (int64_t i = 0; i < 9 * pattern->block_count; i++)
      most = fmax(most, fabs(linear[i]));
    for (int64_t i = 0; i < 9 * pattern->block_count; i++)
      check_near(k[i], linear[i], 1e-12 * most);
    for (int i = 0; i < 2; i++)
      free(at[i]);
    free(u), free(d), free(f), free(kd), free(moved), free(k), free(linear);
    bw_release(pattern);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* A rotation by 100 degrees has no forces and no stress. A stretch and a rotation have the Cauchy
 * stress F S F^T / det F of the law. */
static void rotations(void **state) {
  bw_context *context = check_context(state);
  const double c = cos(1.75), s = sin(1.75), turn[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  for (int which = 0; which < 3; which++) {
    bw_mesh *mesh = body(context, which);
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    bw_block_pattern *pattern = NULL;
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *u = numbers(size), *f = numbers(size), energy;
    double *stress = numbers(6 * ((int64_t)mesh->node_count + mesh->element_count));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    for (int64_t i = 0; i < size; i++) {
      u[i] = -mesh->node[i];
      for (int k = 0; k < 3; k++)
        u[i] += turn[3 * (i % 3) + k] * mesh->node[i - i % 3 + k];
    }
    check_ok(context, bw_finite_forces(context, model, pattern, u, 1, &energy, f, NULL));
    for (int64_t i = 0; i < size; i++)
      check_near(f[i], 0, 2e11 * 0.3 * 0.3 * 1e-14);
    for (int on_nodes = 0; on_nodes < 2; on_nodes++) {
      check_ok(context, bw_finite_stress(context, model, u, 1, on_nodes, stress));
      for (int64_t i = 0; i < 6 * (on_nodes ? mesh->node_count : mesh->element_count); i++)
        check_near(stress[i], 0, 1e-12 * 2e11);
    }
    /* x stretched by 1.2, then turned: S_xx = C_11 E, S_yy = C_12 E */
    const double *law = material->elasticity, strain = (1.2 * 1.2 - 1) / 2;
    double along = 1.2 * law[0] * strain, across = law[6] * strain / 1.2;
    for (int64_t i = 0; i < size; i++) {
      u[i] = -mesh->node[i];
      for (int k = 0; k < 3; k++)
        u[i] += turn[3 * (i % 3) + k] * (k == 0 ? 1.2 : 1) * mesh->node[i - i % 3 + k];
    }
    for (int on_nodes = 0; on_nodes < 2; on_nodes++) {
      check_ok(context, bw_finite_stress(context, model, u, 1, on_nodes, stress));
      for (int64_t i = 0; i < (on_nodes ? mesh->node_count : mesh->element_count); i++) {
        check_near(stress[6 * i], c * c * along + s * s * across, 1e-11 * along);
        check_near(stress[6 * i + 1], s * s * along + c * c * across, 1e-11 * along);
        check_near(stress[6 * i + 2], across, 1e-11 * along);
        check_near(stress[6 * i + 5], c * s * (along - across), 1e-11 * along);
      }
    }
    for (int64_t i = 0; i < size; i++) /* inside out */
      u[i] = -2 * mesh->node[i];
    check_fails(context, BW_GEOMETRY, "inverts",
                bw_finite_forces(context, model, pattern, u, 1, &energy, f, NULL));
    check_fails(context, BW_GEOMETRY, "inverts",
                bw_finite_stress(context, model, u, 1, true, stress));
    free(u), free(f), free(stress);
    bw_release(pattern);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* K - s M solved by its indefinite factor: the residual, and as many negative pivots as there are
 * eigenvalues below s. */
static void indefinite_factors(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 6, 3, 2, 2);
  bw_model *model = body_bar(context, mesh, 0.3, (const double[3]){0, 0, 1});
  bw_dof_map *map = NULL;
  bw_block_pattern *pattern = NULL;
  bwi_symbolic *symbolic = NULL;
  check_ok(context, bw_dof_map_create(context, model, &map));
  check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
  check_ok(context, bwi_symbolic_for(context, pattern, map, BW_ORDERING_AUTO, 0, NULL, NULL, NULL,
                                     &symbolic));
  double *k = numbers(9 * pattern->block_count), *m = numbers(pattern->block_count);
  int64_t size = 3 * (int64_t)mesh->node_count, before = -1;
  double *f = numbers(2 * size), *x = numbers(2 * size), *kx = numbers(2 * size),
         *mx = numbers(2 * size);
  check_ok(context, bw_stiffness(context, pattern, mesh, model->material, k));
  check_ok(context, bw_mass(context, pattern, mesh, model->material, m));
  random_field(9, 2 * size, f);
  for (int i = 0; i < 2; i++)
    bwi_keep_states(map, 1u << BW_DOF_UNKNOWN, f + i * size);
  for (double shift = 0; shift < 1e10; shift = 30 * shift + 1e7) {
    bwi_matrix matrix = {
        .pattern = pattern, .stiffness = k, .mass = m, .shift = -shift, .dof_map = map};
    bwi_factor *factor = NULL;
    int64_t negative;
    int32_t bad = 0;
    bool trusted[2];
    check_ok(context,
             bwi_factor_create_indefinite(context, symbolic, &matrix, &factor, &trusted[0], &bad));
    check_ok(context, bwi_count_negative(context, symbolic, &matrix, &negative, &trusted[1]));
    assert_int_equal(factor->negative, negative);
    assert_true(trusted[0] && trusted[1] && negative > before);
    before = negative;
    check_ok(context, bwi_solve_fields(context, factor, map, 2, f, x));
    check_ok(context, bw_block_multiply(context, pattern, k, 9, 3, 2, x, kx));
    check_ok(context, bw_block_multiply(context, pattern, m, 1, 3, 2, x, mx));
    for (int64_t i = 0; i < 2 * size; i++)
      kx[i] -= shift * mx[i];
    for (int i = 0; i < 2; i++)
      bwi_keep_states(map, 1u << BW_DOF_UNKNOWN, kx + i * size);
    for (int64_t i = 0; i < 2 * size; i++)
      check_near(kx[i], f[i], 1e-6);
    bw_release(factor);
  }
  free(k), free(m), free(f), free(x), free(kx), free(mx);
  bw_release(symbolic);
  bw_release(pattern);
  bw_release(map);
  bw_release(model);
  bw_release(mesh);
}

/* A cantilever under a transverse force at its end: Mattiasson, Int. J. Num. Meth. Eng. 17 (1981),
 * 145-153, elliptic integrals of the inextensible elastica. */
static void elastica(void **state) {
  bw_context *context = check_context(state);
  const double length = 1, side = 0.02, inertia = side * side * side * side / 12, young = 200e9;
  const double published[3][3] = {
      {1, 0.05643, 0.30172}, {5, 0.38763, 0.71379}, {10, 0.55500, 0.81061}};
  bw_mesh *mesh = body_box(context, length, side, side, 40, 2, 2, 2);
  bw_model *model = body_bar(context, mesh, length, (const double[3]){0, 0, 10 * young * inertia});
  bw_selection *end = body_face(context, mesh, 0, length);
  bw_nonlinear_options options;
  bw_nonlinear *path = NULL;
  bw_nonlinear_options_default(&options);
  options.monitor_count = 1;
  int32_t centre = 0;
  for (int32_t k = 0; k < end->node_count; k++) {
    const double *x = mesh->node + 3 * (int64_t)end->node[k];
    if (fabs(x[1] - side / 2) < 1e-9 && fabs(x[2] - side / 2) < 1e-9)
      centre = end->node[k];
  }
  options.monitor = &centre;
  check_ok(context, bw_nonlinear_statics(context, model, &options, &path));
  assert_int_equal(path->count, 10);
  assert_int_equal(path->end, BW_NONLINEAR_FACTOR);
  for (int k = 0; k < 3; k++) {
    int row = (int)published[k][0] - 1;
    const double *u = path->monitored + 3 * row;
    check_near(path->step[row].factor, published[k][0] / 10, 1e-12);
    check_near(-u[0] / length / published[k][1], 1, 0.01);
    check_near(u[2] / length / published[k][2], 1, 0.01);
    assert_true(path->step[row].counted);
    assert_int_equal(path->step[row].negative, 0);
    assert_true(path->step[row].residual < 1e-7);
  }
  double sum[3] = {0}; /* reactions balance the load */
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    sum[i % 3] += path->reaction[i];
  check_near(sum[2] / (10 * young * inertia), -1, 1e-6);
  check_near(sum[0] / (10 * young * inertia), 0, 1e-6);
  bw_release(path);
  bw_release(end);
  bw_release(model);
  bw_release(mesh);
}

/* ---- snap-through ---------------------------------------------------------------------------- */

static void incline(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = unit[0];
  out[1] = 0.04 * (unit[1] - 0.5);
  out[2] = 0.04 * (unit[2] - 0.5) + 0.04 * unit[0];
}

/* Nodes of the line z = middle at one end of the bar. */
static bw_selection *hinge(bw_context *context, const bw_mesh *mesh, double x, double z) {
  const double low[3] = {x - 1e-6, -1, z - 1e-6}, high[3] = {x + 1e-6, 1, z + 1e-6};
  bw_selection *near = NULL, *line = NULL;
  check_ok(context, bw_select_box(context, mesh, low, high, &near));
  check_ok(context, bw_select_node_set(context, near, &line));
  bw_release(near);
  return line;
}

/* Half of von Mises's truss: a bar with a hinge at its foot, whose other end slides down. Its load
 * is P = k h (1 - x)(2 x - x^2) / 2 at the height (1 - x) h, with k of small displacements, and its
 * largest one k h / (3 sqrt 3) at x = 1 - 1 / sqrt 3. Between the limit points one direction is
 * unstable. */
static void snap_through(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {20, 1, 2};
  const double h = 0.04, load = 1e6;
  bw_mesh *mesh = NULL;
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_array *force = NULL;
  bw_nonlinear *path = NULL;
  bw_nonlinear_options options;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, incline, NULL, &mesh));
  bw_selection *foot = hinge(context, mesh, 0, 0), *apex = hinge(context, mesh, 1, h);
  assert_int_equal(apex->node_count, 3);
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context,
           bw_model_prescribe(context, model, foot, (const bool[3]){true, true, true}, NULL));
  check_ok(context,
           bw_model_prescribe(context, model, apex, (const bool[3]){true, true, false}, NULL));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &force));
  memset(force->data, 0, 3 * (size_t)mesh->node_count * sizeof(double));
  for (int k = 0; k < 3; k++) /* Simpson's rule */
    ((double *)force->data)[3 * apex->node[k] + 2] =
        fabs(mesh->node[3 * apex->node[k] + 1]) < 1e-9 ? -load * 4 / 6 : -load / 6;
  check_ok(context, bw_model_nodal_forces(context, model, force));
  bw_nonlinear_options_default(&options);
  options.monitor_count = 1;
  options.monitor = apex->node;
  options.arc_length = true;
  options.steps = 2000;
  options.displacement = 2.2 * h;
  check_ok(context, bw_nonlinear_statics(context, model, &options, &path));
  assert_int_equal(path->end, BW_NONLINEAR_DISPLACEMENT);
  const double *w = path->monitored + 2;
  double k = -load * path->step[0].factor / w[0];
  k /= 1 - 1.5 * -w[0] / h; /* the first step is not of no size */
  double limit = k * h / sqrt(27);
  bool near_limit = false;
  for (int s = 0; s < path->count; s++) {
    double x = -w[3 * s] / h, closed = k * h * (1 - x) * (2 * x - x * x) / 2;
    double beside = fabs(1 - x) - 1 / sqrt(3);
    check_near(load * path->step[s].factor, closed, 0.003 * limit);
    assert_int_equal(path->step[s].negative, beside < 0);
    assert_true(path->step[s].counted);
    near_limit |= fabs(closed) > 0.98 * limit;
  }
  assert_true(near_limit);
  bw_release(path);
  bw_release(force);
  bw_release(foot);
  bw_release(apex);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* The same bits on one thread and on three. */
static void same_bits(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.5, 0.02, 0.02, 20, 2, 2, 2);
  bw_model *model = body_bar(context, mesh, 0.5, (const double[3]){0, 0, 500});
  bw_nonlinear *path[2] = {NULL, NULL};
  bw_nonlinear_options options;
  bw_nonlinear_options_default(&options);
  options.steps = 3;
  for (int k = 0; k < 2; k++) {
    check_ok(context, bw_set_threads(context, k ? 3 : 1));
    check_ok(context, bw_nonlinear_statics(context, model, &options, &path[k]));
  }
  size_t size = 3 * (size_t)mesh->node_count * sizeof(double);
  assert_memory_equal(path[0]->displacement, path[1]->displacement, size);
  assert_memory_equal(path[0]->reaction, path[1]->reaction, size);
  for (int k = 0; k < 2; k++)
    bw_release(path[k]);
  bw_release(model);
  bw_release(mesh);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, 1);
  bw_material *material = body_material(context);
  bw_model *free_body = NULL, *model = body_bar(context, mesh, 0.3, (const double[3]){0, 0, 1});
  bw_selection *end = body_face(context, mesh, 0, 0.3);
  bw_nonlinear *path = NULL;
  bw_nonlinear_options options;
  check_ok(context, bw_model_create(context, mesh, material, &free_body));
  check_ok(context, bw_model_force(context, free_body, end, (const double[3]){1, 0, 0}));
  check_fails(context, BW_UNCONSTRAINED, "move freely",
              bw_nonlinear_statics(context, free_body, NULL, &path));
  bw_nonlinear_options_default(&options);
  options.factor = -1;
  check_fails(context, BW_INVALID, "load factor",
              bw_nonlinear_statics(context, model, &options, &path));
  options.factor = 1;
  options.max_iterations = 1;
  check_fails(context, BW_INVALID, "iterations",
              bw_nonlinear_statics(context, model, &options, &path));
  options.max_iterations = 20;
  options.monitor_count = 1;
  options.monitor = &mesh->node_count;
  check_fails(context, BW_INVALID, "node", bw_nonlinear_statics(context, model, &options, &path));
  bw_model_clear_loads(model);
  options.monitor_count = 0;
  check_fails(context, BW_INVALID, "nothing acts",
              bw_nonlinear_statics(context, model, &options, &path));
  check_ok(context, bw_model_attach_mass(context, model, end, 1));
  check_fails(context, BW_UNSUPPORTED, "mass",
              bw_nonlinear_statics(context, model, &options, &path));
  bw_release(end);
  bw_release(free_body);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, 2);
  bw_model *model = body_bar(context, mesh, 0.3, (const double[3]){0, 0, 1});
  bw_nonlinear *path = NULL;
  bw_nonlinear_options options;
  bw_nonlinear_options_default(&options);
  options.steps = 1;
  check_allocations(context, path, bw_nonlinear_statics(context, model, &options, &path));
  bw_release(model);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(derivatives), check_test(rotations),      check_test(indefinite_factors),
      check_test(elastica),    check_test(snap_through),   check_test(same_bits),
      check_test(refused),     check_test(memory_failures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
