/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stress gradient against central differences of whole solutions, and against what physics
 * leaves unchanged. */
#include "bodies.h"

enum { NODES = 4 };

typedef enum fixed_by { CLAMPED, PRESCRIBED, ROLLING, ON_A_RAIL, NOTHING } fixed_by;

typedef struct scene {
  const char *name;
  int order;
  int printed; /* 1: orthotropic, axes oblique; 2: and they turn from element to element */
  fixed_by fixed;
  unsigned loads; /* 1 << bw_load_kind */
  bool relief;
} scene;

static double *numbers(int64_t count) {
  double *block = (double *)calloc((size_t)count, sizeof *block);
  assert_non_null(block);
  return block;
}

static bw_material *make_material(bw_context *context, int printed) {
  bw_material *material = NULL;
  if (printed) {
    const bw_orthotropic constants = {.name = "printed",
                                      .young = {2e9, 1.6e9, 1.1e9},
                                      .poisson = {0.3, 0.35, 0.28},
                                      .shear = {6e8, 4e8, 5e8},
                                      .axes = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1},
                                      .density = 1200};
    check_ok(context, bw_material_orthotropic(context, &constants, &material));
  } else {
    const bw_isotropic constants = {
        .name = "test", .young = 2e9, .poisson = 0.33, .density = 1200, .strength = 5e7};
    check_ok(context, bw_material_isotropic(context, &constants, &material));
  }
  return material;
}

/* Elements in turn belong to three groups, each with the material turned in its own way. */
static void rotate_material(bw_context *context, bw_model *model) {
  const double turn[3][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                             {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1},
                             {0, 0, 1, 0.6, 0.8, 0, -0.8, 0.6, 0}};
  int32_t count = model->mesh->element_count;
  int32_t *group = (int32_t *)calloc((size_t)count, sizeof *group);
  assert_non_null(group);
  for (int32_t e = 0; e < count; e++)
    group[e] = e % 3;
  check_ok(context, bw_model_rotate_material(context, model, 3, group, turn[0]));
  free(group);
}

static void mid_edge_nodes_at_midpoints(const bw_mesh *mesh, double *x) {
  for (int64_t e = 0; mesh->order == 2 && e < mesh->element_count; e++)
    for (int k = 0; k < 6; k++) {
      const int32_t *node = mesh->element + 10 * e;
      for (int c = 0; c < 3; c++)
        x[3 * node[4 + k] + c] =
            (x[3 * node[bw_tet_edge[k][0]] + c] + x[3 * node[bw_tet_edge[k][1]] + c]) / 2;
    }
}

/* Corners move at random by up to `size`. */
static void random_motion(const bw_mesh *mesh, uint64_t seed, double size, double *dx) {
  bw_random random;
  bw_random_seed(&random, seed);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    dx[i] = size * (2 * bw_random_uniform(&random) - 1);
  mid_edge_nodes_at_midpoints(mesh, dx);
}

static bw_mesh *moved_mesh(bw_context *context, const bw_mesh *mesh, double factor,
                           const double *dx) {
  bw_mesh *out = NULL;
  double *x = numbers(3 * (int64_t)mesh->node_count);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    x[i] = mesh->node[i] + factor * dx[i];
  mid_edge_nodes_at_midpoints(mesh, x);
  check_ok(context, bw_mesh_moved(context, mesh, x, &out));
  free(x);
  return out;
}

/* A distorted bar along x, and which of its nodes are on which end, on the box it came from. */
typedef struct bar {
  bw_mesh *mesh, *box;
  bw_material *material;
  bw_array *temperature, *force;
} bar;

static bar make(bw_context *context, const scene *s) {
  bar out = {0};
  out.box = make_box(context, 1, 0.3, 0.25, 4, 2, 2, s->order);
  int64_t nodes = out.box->node_count;
  double *dx = numbers(3 * nodes);
  random_motion(out.box, 7, 0.02, dx);
  out.mesh = moved_mesh(context, out.box, 1, dx);
  free(dx);
  out.material = make_material(context, s->printed);
  check_ok(context, bw_array_create(context, BW_F64, nodes, 1, &out.temperature));
  check_ok(context, bw_array_create(context, BW_F64, nodes, 3, &out.force));
  bw_random random;
  bw_random_seed(&random, 3);
  for (int64_t i = 0; i < nodes; i++) {
    ((double *)out.temperature->data)[i] = 20 * bw_random_uniform(&random);
    for (int c = 0; c < 3; c++)
      ((double *)out.force->data)[3 * i + c] = 40 * (bw_random_uniform(&random) - 0.5);
  }
  return out;
}

static void drop(bar *b) {
  bw_release(b->mesh);
  bw_release(b->box);
  bw_release(b->material);
  bw_release(b->temperature);
  bw_release(b->force);
}

static bw_selection *end_of(bw_context *context, const bar *b, const bw_mesh *mesh, double x) {
  bw_selection *on = NULL;
  uint8_t *facet = (uint8_t *)calloc((size_t)mesh->facet_count, 1);
  assert_non_null(facet);
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    facet[f] = 1;
    for (int k = 0; k < 3; k++)
      facet[f] &= fabs(b->box->node[3 * mesh->facet[f * mesh->nodes_per_facet + k]] - x) < 1e-9;
  }
  check_ok(context, bw_select_mask(context, mesh, facet, NULL, &on));
  free(facet);
  return on;
}

static bw_model *model_on(bw_context *context, const scene *s, const bar *b, const bw_mesh *mesh) {
  bw_model *model = NULL;
  bw_selection *foot = end_of(context, b, mesh, 0), *tip = end_of(context, b, mesh, 1), *all = NULL;
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_model_create(context, mesh, b->material, &model));
  if (s->printed == 2)
    rotate_material(context, model);
  const bool fixed[3] = {true, true, true}, across[3] = {false, true, true};
  const double value[3] = {1e-3, -2e-3, 5e-4}, zero[3] = {0, 0, 0}, oblique[3] = {0.8, 0.6, 0};
  if (s->fixed == CLAMPED || s->fixed == PRESCRIBED)
    check_ok(context, bw_model_fix(context, model, foot));
  if (s->fixed == PRESCRIBED)
    check_ok(context, bw_model_prescribe(context, model, tip, fixed, value));
  if (s->fixed == ROLLING) { /* an oblique plane */
    check_ok(context, bw_model_slide(context, model, foot, oblique));
    check_ok(context, bw_model_prescribe(context, model, tip, across, zero));
  }
  if (s->fixed == ON_A_RAIL) /* free to move along x only */
    check_ok(context, bw_model_prescribe(context, model, all, across, zero));
  const double gravity[3] = {500, -3000, 1000}, traction[3] = {2e4, -1e5, 3e4};
  const double force[3] = {300, -1000, 500}, torque[3] = {200, 80, -60}, about[3] = {0.9, 0.2, 0.1};
  if (s->loads >> BW_LOAD_PRESSURE & 1)
    check_ok(context, bw_model_pressure(context, model, s->fixed == NOTHING ? all : tip, 1e5));
  if (s->loads >> BW_LOAD_TRACTION & 1)
    check_ok(context, bw_model_traction(context, model, tip, traction));
  if (s->loads >> BW_LOAD_FORCE & 1)
    check_ok(context, bw_model_force(context, model, tip, force));
  if (s->loads >> BW_LOAD_TORQUE & 1)
    check_ok(context, bw_model_torque(context, model, tip, torque, about));
  if (s->loads >> BW_LOAD_GRAVITY & 1)
    check_ok(context, bw_model_gravity(context, model, gravity));
  if (s->loads >> BW_LOAD_NODAL & 1)
    check_ok(context, bw_model_nodal_forces(context, model, b->force));
  if (s->loads >> BW_LOAD_TEMPERATURE & 1)
    check_ok(context, bw_model_temperature(context, model, b->temperature, &(double){2e-5}));
  bw_release(foot);
  bw_release(tip);
  bw_release(all);
  return model;
}

static bw_static *solved(bw_context *context, const scene *s, const bw_model *model) {
  const bw_statics_options opts = {.inertia_relief = s->relief};
  bw_static *result = NULL;
  check_ok(context, bw_statics(context, model, NULL, &opts, &result));
  return result;
}

static void stresses_on(bw_context *context, const scene *s, const bw_model *from,
                        const bw_mesh *mesh, const int32_t *node, double out[NODES]) {
  bw_model *model = NULL;
  check_ok(context, bw_model_moved(context, from, mesh, &model));
  bw_static *result = solved(context, s, model);
  double *stress = numbers(6 * (int64_t)mesh->node_count);
  check_ok(context, bw_static_stress(context, result, true, stress));
  for (int i = 0; i < NODES; i++)
    out[i] = bw_von_mises(stress + 6 * (int64_t)node[i]);
  free(stress);
  bw_release(result);
  bw_release(model);
}

static bw_status solve(void *data, bw_context *context, int64_t count, const double *force,
                       double *displacement) {
  return bw_system_solve(context, (bw_system *)data, count, force, displacement);
}

/* Stresses of `count` nodes of a solved model, and their gradients. */
static bw_status gradient_of(bw_context *context, const bw_model *model, const bw_static *result,
                             int32_t count, const int32_t *node, double *stress, double *gradient) {
  return bw_von_mises_gradient(context, model, result->system->dof_map, result->displacement, solve,
                               result->system, count, node, NULL, stress, gradient);
}

/* Corners on the boundary and inside, and mid-edge nodes. */
static void choose(const bw_mesh *mesh, int32_t node[NODES]) {
  for (int i = 0; i < NODES; i++)
    node[i] = (int32_t)((int64_t)mesh->node_count * (3 * i + 2) / (3 * NODES));
}

/* Asked for at some nodes only, it has the same bits there. */
static void compare_part(bw_context *context, const bw_model *model, const bw_static *result,
                         const int32_t *node, const double *whole) {
  int32_t nodes = model->mesh->node_count;
  double j[NODES], *part = numbers(NODES * 3 * (int64_t)nodes);
  uint8_t *wanted = calloc((size_t)nodes, 1);
  assert_non_null(wanted);
  for (int32_t i = nodes / 3; i < nodes / 2; i++)
    wanted[i] = 1;
  check_ok(context,
           bw_von_mises_gradient(context, model, result->system->dof_map, result->displacement,
                                 solve, result->system, NODES, node, wanted, j, part));
  for (int64_t i = 0; i < NODES * (int64_t)nodes; i++)
    if (wanted[i % nodes])
      assert_memory_equal(part + 3 * i, whole + 3 * i, 3 * sizeof *part);
  free(part);
  free(wanted);
}

static void compare(bw_context *context, const scene *s) {
  static const char *const word[] = {"isotropic", "orthotropic", "rotated by element"};
  bar b = make(context, s);
  int32_t node[NODES];
  double j[NODES], at[4][NODES], size = 3e-4;
  int64_t n = 3 * (int64_t)b.mesh->node_count;
  double *gradient = numbers(NODES * n), *dx = numbers(n);
  choose(b.mesh, node);
  bw_model *model = model_on(context, s, &b, b.mesh);
  bw_static *result = solved(context, s, model);
  check_ok(context, gradient_of(context, model, result, NODES, node, j, gradient));
  compare_part(context, model, result, node, gradient);
  stresses_on(context, s, model, b.mesh, node, at[0]);
  for (int i = 0; i < NODES; i++)
    check_near(j[i], at[0][i], 1e-9 * (at[0][i] + 1));
  for (uint64_t seed = 1; seed <= 2; seed++) {
    random_motion(b.mesh, 100 + seed, 1, dx);
    for (int k = 0; k < 4; k++) { /* -2, -1, 1, 2 steps */
      bw_mesh *mesh = moved_mesh(context, b.mesh, size * (k < 2 ? k - 2 : k - 1), dx);
      stresses_on(context, s, model, mesh, node, at[k]);
      bw_release(mesh);
    }
    for (int i = 0; i < NODES; i++) {
      double slope = (8 * (at[2][i] - at[1][i]) - (at[3][i] - at[0][i])) / (12 * size);
      double sum = 0, scale = 0;
      for (int64_t k = 0; k < n; k++) {
        sum += gradient[i * n + k] * dx[k];
        scale += gradient[i * n + k] * gradient[i * n + k];
      }
      scale = fmax(1e4, fmax(fabs(slope), sqrt(scale))); /* loads are of 1e5 Pa */
      if (!(fabs(sum - slope) <= 1e-6 * scale))
        fail_msg("%s, order %d, %s: node %d: %.12g, by differences %.12g (scale %g)", s->name,
                 s->order, word[s->printed], node[i], sum, slope, scale);
    }
  }
  free(gradient);
  free(dx);
  bw_release(result);
  bw_release(model);
  drop(&b);
}

/* Of both orders, of all materials. */
static void compare_all(bw_context *context, const scene *list, size_t count) {
  for (size_t k = 0; k < count; k++)
    for (int order = 1; order <= 2; order++)
      for (int printed = 0; printed < 3; printed++) {
        scene s = list[k];
        s.order = order;
        s.printed = printed;
        compare(context, &s);
      }
}

static void each_load_by_differences(void **state) {
  bw_context *context = check_context(state);
  const scene list[] = {
      {"pressure", 0, 0, CLAMPED, 1u << BW_LOAD_PRESSURE, false},
      {"traction", 0, 0, CLAMPED, 1u << BW_LOAD_TRACTION, false},
      {"force", 0, 0, CLAMPED, 1u << BW_LOAD_FORCE, false},
      {"torque", 0, 0, CLAMPED, 1u << BW_LOAD_TORQUE, false},
      {"gravity", 0, 0, CLAMPED, 1u << BW_LOAD_GRAVITY, false},
      {"nodal forces", 0, 0, CLAMPED, 1u << BW_LOAD_NODAL, false},
      {"temperature", 0, 0, CLAMPED, 1u << BW_LOAD_TEMPERATURE, false},
      {"prescribed displacement", 0, 0, PRESCRIBED, 0, false},
      {"oblique roller", 0, 0, ROLLING, 1u << BW_LOAD_PRESSURE | 1u << BW_LOAD_GRAVITY, false},
      {"everything", 0, 0, PRESCRIBED, 0x7f, false}};
  compare_all(context, list, sizeof list / sizeof list[0]);
}

static void free_bodies_by_differences(void **state) {
  bw_context *context = check_context(state);
  const scene list[] = {
      /* a closed pressure and temperature are balanced in themselves */
      {"pressure all round", 0, 0, NOTHING, 1u << BW_LOAD_PRESSURE, false},
      {"free expansion", 0, 0, NOTHING, 1u << BW_LOAD_TEMPERATURE, false},
      /* balanced by inertia, with linear and angular acceleration */
      {"thrust and gravity", 0, 0, NOTHING, 1u << BW_LOAD_FORCE | 1u << BW_LOAD_GRAVITY, true},
      {"torque in flight", 0, 0, NOTHING, 1u << BW_LOAD_TORQUE, true},
      {"everything in flight", 0, 0, NOTHING, 0x7f, true},
      {"on a rail", 0, 0, ON_A_RAIL, 1u << BW_LOAD_FORCE | 1u << BW_LOAD_PRESSURE, true}};
  compare_all(context, list, sizeof list / sizeof list[0]);
}

/* Moving everything, loads and supports with it, changes no stress; nor does turning everything
 * with loads that turn along (pressure) on an isotropic body. Blowing up to twice the size halves
 * (twice: area) the stress of a force, and keeps that of a pressure: x . gradient = degree J. */
static void rigid_motion_and_size(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int kind = 0; kind < 3; kind++) {
      const bw_load_kind load[3] = {BW_LOAD_PRESSURE, BW_LOAD_FORCE, BW_LOAD_GRAVITY};
      const double degree[3] = {0, -2, 1};
      const scene s = {"", order, 0, CLAMPED, 1u << load[kind], false};
      bar b = make(context, &s);
      int32_t node[NODES];
      double j[NODES];
      int64_t n = 3 * (int64_t)b.mesh->node_count;
      double *gradient = numbers(NODES * n);
      choose(b.mesh, node);
      bw_model *model = model_on(context, &s, &b, b.mesh);
      bw_static *result = solved(context, &s, model);
      check_ok(context, gradient_of(context, model, result, NODES, node, j, gradient));
      for (int i = 0; i < NODES; i++) {
        const double *g = gradient + i * n;
        double sum[3] = {0, 0, 0}, turn[3] = {0, 0, 0}, size = 0, scale = 0;
        for (int64_t k = 0; k < b.mesh->node_count; k++) {
          double cross[3];
          bw_cross(b.mesh->node + 3 * k, g + 3 * k, cross);
          size += bw_dot(b.mesh->node + 3 * k, g + 3 * k);
          scale += bw_norm(g + 3 * k);
          for (int c = 0; c < 3; c++) {
            sum[c] += g[3 * k + c];
            turn[c] += cross[c];
          }
        }
        assert_true(scale > 0);
        check_near(bw_norm(sum), 0, 1e-9 * scale);
        if (load[kind] == BW_LOAD_PRESSURE)
          check_near(bw_norm(turn), 0, 1e-9 * scale);
        check_near(size, degree[kind] * j[i], 1e-9 * scale);
      }
      free(gradient);
      bw_release(result);
      bw_release(model);
      drop(&b);
    }
}

/* A bar in tension: sigma = F / A wherever we look, so that only the cross-section counts, and the
 * derivative by a stretch across it is -sigma. */
static void bar_in_tension(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = make_box(context, 1, 0.2, 0.1, 5, 2, 1, order);
    const bw_isotropic constants = {.name = "cork", .young = 1e7, .poisson = 0};
    bw_material *material = NULL;
    bw_model *model = NULL;
    bw_selection *foot = NULL, *tip = NULL;
    const double force[3] = {100, 0, 0}, low[3] = {0, 0, 0}, high[3] = {1, 0, 0};
    const double axis[3] = {1, 0, 0};
    check_ok(context, bw_material_isotropic(context, &constants, &material));
    check_ok(context, bw_model_create(context, mesh, material, &model));
    check_ok(context, bw_select_plane(context, mesh, low, axis, 1e-9, &foot));
    check_ok(context, bw_select_plane(context, mesh, high, axis, 1e-9, &tip));
    check_ok(context, bw_model_fix(context, model, foot));
    check_ok(context, bw_model_force(context, model, tip, force));
    bw_static *result = NULL;
    check_ok(context, bw_statics(context, model, NULL, NULL, &result));
    int32_t node[1] = {mesh->node_count / 2};
    double j[1], *gradient = numbers(3 * (int64_t)mesh->node_count), by[3] = {0, 0, 0};
    check_ok(context, gradient_of(context, model, result, 1, node, j, gradient));
    for (int32_t i = 0; i < mesh->node_count; i++)
      for (int c = 0; c < 3; c++)
        by[c] += gradient[3 * i + c] * mesh->node[3 * i + c];
    check_near(j[0], 5000, 1e-6);
    check_near(by[0], 0, 1e-5);
    check_near(by[1], -5000, 1e-5);
    check_near(by[2], -5000, 1e-5);
    free(gradient);
    bw_release(result);
    bw_release(foot);
    bw_release(tip);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* Many nodes at once give what each gives alone, whatever the number of threads. */
static void batches_and_threads(void **state) {
  bw_context *context = check_context(state);
  const scene s = {"", 2, false, CLAMPED, 1u << BW_LOAD_FORCE | 1u << BW_LOAD_GRAVITY, false};
  bar b = make(context, &s);
  enum { MANY = 19 };
  int32_t node[MANY];
  int64_t n = 3 * (int64_t)b.mesh->node_count;
  double j[MANY], one, *gradient = numbers(MANY * n), *alone = numbers(n);
  bw_model *model = model_on(context, &s, &b, b.mesh);
  bw_static *result = solved(context, &s, model);
  for (int i = 0; i < MANY; i++)
    node[i] = (int32_t)((int64_t)b.mesh->node_count * i / MANY);
  check_ok(context, bw_set_threads(context, 3));
  check_ok(context, gradient_of(context, model, result, MANY, node, j, gradient));
  check_ok(context, bw_set_threads(context, 1));
  for (int i = 0; i < MANY; i += 6) {
    check_ok(context, gradient_of(context, model, result, 1, &node[i], &one, alone));
    double scale = 0;
    for (int64_t k = 0; k < n; k++)
      scale = fmax(scale, fabs(alone[k]));
    assert_true(one == j[i]);
    for (int64_t k = 0; k < n; k++) /* solves of several right-hand sides may round otherwise */
      check_near(gradient[i * n + k], alone[k], 1e-11 * scale);
  }
  free(gradient);
  free(alone);
  bw_release(result);
  bw_release(model);
  drop(&b);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  const scene s = {"", 2, false, CLAMPED, 1u << BW_LOAD_FORCE, false};
  bar b = make(context, &s);
  int64_t n = 3 * (int64_t)b.mesh->node_count;
  double j, *gradient = numbers(n), *x = numbers(n);
  int32_t node = b.mesh->node_count;
  bw_model *model = model_on(context, &s, &b, b.mesh);
  bw_static *result = solved(context, &s, model);
  check_fails(context, BW_INVALID, "the mesh has",
              gradient_of(context, model, result, 1, &node, &j, gradient));
  check_fails(context, BW_INVALID, "displacement",
              bw_von_mises_gradient(context, model, result->system->dof_map, NULL, solve,
                                    result->system, 1, &node, NULL, &j, gradient));
  node = 5;
  /* curved */
  memcpy(x, b.mesh->node, (size_t)n * sizeof *x);
  x[3 * b.mesh->element[9]] += 1e-3;
  bw_mesh *curved = NULL;
  check_ok(context, bw_mesh_moved(context, b.mesh, x, &curved));
  bw_model *other = model_on(context, &s, &b, curved);
  check_fails(context, BW_INVALID, "curved edges",
              gradient_of(context, other, result, 1, &node, &j, gradient));
  /* directions that turn with the surface */
  bw_selection *tip = end_of(context, &b, b.mesh, 1);
  check_ok(context, bw_model_slide(context, model, tip, NULL));
  check_fails(context, BW_UNSUPPORTED, "support 2",
              gradient_of(context, model, result, 1, &node, &j, gradient));
  bw_release(tip);
  bw_release(other);
  bw_release(curved);
  bw_release(result);
  bw_release(model);
  free(gradient);
  free(x);
  drop(&b);
}

static void memory_runs_out(void **state) {
  bw_context *context = check_context(state);
  const scene s = {"", 2, false, NOTHING, 0x7f, true};
  bar b = make(context, &s);
  int32_t node[NODES];
  double j[NODES], *gradient = numbers(NODES * 3 * (int64_t)b.mesh->node_count);
  choose(b.mesh, node);
  bw_model *model = model_on(context, &s, &b, b.mesh);
  bw_static *result = solved(context, &s, model);
  check_each_allocation(context, status, 1) {
    status = gradient_of(context, model, result, NODES, node, j, gradient);
  }
  free(gradient);
  bw_release(result);
  bw_release(model);
  drop(&b);
}

check_main(check_test(each_load_by_differences), check_test(free_bodies_by_differences),
           check_test(rigid_motion_and_size), check_test(bar_in_tension),
           check_test(batches_and_threads), check_test(refusals), check_test(memory_runs_out))
