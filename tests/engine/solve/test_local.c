/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A bar of five domains along x, R F R F R, is bent at its two joints, stretched and turned: after
 * every edit the system that followed it must have the stiffness and the solution of one made anew.
 */
#include "bodies.h"
#include "solve/local.h"

enum { DOMAINS = 5, RIGID = 3 };
/* Where domains end along the bar of length 10; the R domains are 0, 2, 4. */
static const double cut[DOMAINS + 1] = {0, 2, 4, 6, 8, 10};

/* What an edit changes: every R domain turns and translates against the one before, about the
 * middle of the F domain between, and is stretched about that point along its own axes. */
typedef struct pose {
  double turn[RIGID][9]; /* against the R domain before; of the first: against rest */
  double scale[RIGID][3];
  double shift[RIGID][3];
} pose;

typedef struct bar {
  bw_mesh *mesh; /* at rest */
  bw_material *material;
  bw_model *model; /* at rest */
  int32_t *element_domain, *node_domain;
  pose now;
  double map[RIGID][12], rotation[RIGID][9];
  double *node;
  bw_domain_motion motion[DOMAINS];
} bar;

static void multiply(const double *a, const double *b, double *c) {
  double out[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      out[3 * i + j] = 0;
      for (int k = 0; k < 3; k++)
        out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    }
  memcpy(c, out, sizeof out);
}

static void rotation_about(const double axis[3], double angle, double *r) {
  double size = bw_norm(axis), n[3] = {axis[0] / size, axis[1] / size, axis[2] / size};
  double c = cos(angle), s = sin(angle);
  const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      r[3 * i + j] = (i == j) * c + s * cross[3 * i + j] + (1 - c) * n[i] * n[j];
}

static void identity(double *r) {
  for (int k = 0; k < 9; k++)
    r[k] = k % 4 == 0;
}

static void rest_pose(pose *p) {
  memset(p, 0, sizeof *p);
  for (int k = 0; k < RIGID; k++) {
    identity(p->turn[k]);
    for (int c = 0; c < 3; c++)
      p->scale[k][c] = 1;
  }
}

static void apply(const double *map, const double *x, double *y) {
  for (int i = 0; i < 3; i++)
    y[i] = bw_dot(map + 4 * i, x) + map[4 * i + 3];
}

/* Maps, nodes and motions of the bar's pose. */
static void follow(bar *b) {
  for (int k = 0; k < RIGID; k++) {
    double pivot[3] = {k == 0 ? 0 : 0.5 * (cut[2 * k - 1] + cut[2 * k]), 0.5, 0.5}, moved[3];
    double linear[9];
    if (k == 0) {
      memcpy(b->rotation[0], b->now.turn[0], sizeof b->rotation[0]);
      memcpy(moved, pivot, sizeof moved);
    } else {
      multiply(b->rotation[k - 1], b->now.turn[k], b->rotation[k]);
      apply(b->map[k - 1], pivot, moved);
    }
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        linear[3 * i + j] = b->rotation[k][3 * i + j] * b->now.scale[k][j];
    for (int i = 0; i < 3; i++) {
      memcpy(b->map[k] + 4 * i, linear + 3 * i, 3 * sizeof *linear);
      b->map[k][4 * i + 3] = moved[i] + b->now.shift[k][i] - bw_dot(linear + 3 * i, pivot);
    }
  }
  for (int32_t i = 0; i < b->mesh->node_count; i++) {
    const double *x = b->mesh->node + 3 * i;
    int k = 0;
    while (k < DOMAINS - 1 && x[0] > cut[k + 1])
      k++;
    double t = (x[0] - cut[k]) / (cut[k + 1] - cut[k]), from[3], to[3];
    apply(b->map[k / 2], x, from);
    apply(b->map[k % 2 ? k / 2 + 1 : k / 2], x, to);
    for (int c = 0; c < 3; c++)
      b->node[3 * i + c] = (1 - t) * from[c] + t * to[c];
  }
  for (int32_t e = 0; b->mesh->order == 2 && e < b->mesh->element_count; e++) {
    const int32_t *n = b->mesh->element + 10 * e;
    for (int m = 0; m < 6; m++)
      for (int c = 0; c < 3; c++)
        b->node[3 * n[4 + m] + c] =
            0.5 * (b->node[3 * n[bw_tet_edge[m][0]] + c] + b->node[3 * n[bw_tet_edge[m][1]] + c]);
  }
  for (int d = 0; d < DOMAINS; d++) {
    int k = d / 2;
    bw_domain_motion *m = &b->motion[d];
    for (int i = 0; i < 3; i++)
      memcpy(m->linear + 3 * i, b->map[k] + 4 * i, 3 * sizeof(double));
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        m->frame[3 * i + j] = b->rotation[k][3 * j + i];
    m->reshaped = false;
    for (int c = 0; d % 2 && c < 12; c++)
      m->reshaped |= fabs(b->map[k][c] - b->map[k + 1][c]) > 1e-13;
  }
}

static void bar_clear(bar *b) {
  bw_release(b->model);
  bw_release(b->material);
  bw_release(b->mesh);
  free(b->element_domain);
  free(b->node_domain);
  free(b->node);
}

static void bar_make(bw_context *context, int across, int order, bar *b) {
  memset(b, 0, sizeof *b);
  b->mesh = body_box(context, 10, 1, 1, 10, across, across, order);
  b->material = body_material(context);
  int32_t nodes = b->mesh->node_count, width = b->mesh->nodes_per_element;
  b->element_domain = malloc((size_t)b->mesh->element_count * sizeof(int32_t));
  b->node_domain = malloc((size_t)nodes * sizeof(int32_t));
  b->node = numbers(3 * nodes);
  for (int32_t i = 0; i < nodes; i++)
    b->node_domain[i] = -1;
  for (int kind = 1; kind >= 0; kind--) /* R last: it takes the interfaces */
    for (int32_t e = 0; e < b->mesh->element_count; e++) {
      double centre = 0;
      for (int a = 0; a < 4; a++)
        centre += 0.25 * b->mesh->node[3 * b->mesh->element[e * width + a]];
      int d = (int)(centre / 2);
      b->element_domain[e] = d;
      for (int a = 0; d % 2 == kind && a < width; a++)
        b->node_domain[b->mesh->element[e * width + a]] = d;
    }
  rest_pose(&b->now);
  follow(b);
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
}

static bw_selection *face(bw_context *context, const bw_mesh *mesh, int axis, double at) {
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  point[axis] = at;
  normal[axis] = 1;
  bw_selection *selection = NULL;
  check_ok(context, bw_select_plane(context, mesh, point, normal, 1e-9, &selection));
  return selection;
}

/* Supports and loads: built in; sliding on its own surface, prescribed, held at a corner; built in,
 * displaced and heated; free; sliding on its own surface all round one end. */
enum { SCENES = 5 };
static void load_bar(bw_context *context, bar *b, int scene) {
  bw_selection *root = face(context, b->mesh, 0, 0), *tip = face(context, b->mesh, 0, 10);
  bw_selection *top = face(context, b->mesh, 2, 1), *side = face(context, b->mesh, 1, 0);
  const double gravity[3] = {0, 3, -9.81}, pull[3] = {2e5, 1e5, 5e4}, torque[3] = {3e4, 0, 0};
  const bool all[3] = {true, true, true}, one[3] = {true, false, false};
  const double by[3] = {1e-4, -2e-4, 3e-5}, corner[3] = {10, 1, 1};
  bw_selection *few = NULL;
  bw_array *warm = NULL;
  switch (scene) {
  case 0:
    check_ok(context, bw_model_fix(context, b->model, root));
    check_ok(context, bw_model_gravity(context, b->model, gravity));
    check_ok(context, bw_model_force(context, b->model, tip, pull));
    break;
  case 1:
    check_ok(context, bw_model_slide(context, b->model, side, NULL));
    check_ok(context, bw_model_prescribe(context, b->model, root, one, by));
    check_ok(context,
             bw_select_nearest(context, b->mesh, corner, 4, &few)); /* held however turned */
    check_ok(context, bw_model_fix(context, b->model, few));
    bw_release(few);
    check_ok(context, bw_model_pressure(context, b->model, tip, 1e6));
    check_ok(context, bw_model_force(context, b->model, tip, pull));
    break;
  case 2:
    check_ok(context, bw_model_prescribe(context, b->model, root, all, by));
    check_ok(context, bw_model_pressure(context, b->model, top, 1e5));
    check_ok(context, bw_model_torque(context, b->model, tip, torque, NULL));
    check_ok(context, bw_array_create(context, BW_F64, b->mesh->node_count, 1, &warm));
    for (int32_t i = 0; i < b->mesh->node_count; i++)
      ((double *)warm->data)[i] = 3 * b->mesh->node[3 * i];
    check_ok(context, bw_model_temperature(context, b->model, warm, 1e-5));
    bw_release(warm);
    break;
  case 3:
    check_ok(context, bw_model_pressure(context, b->model, tip, 1e5));
    check_ok(context, bw_model_gravity(context, b->model, gravity));
    break;
  default:
    check_ok(context, bw_model_slide(context, b->model, root, NULL));
    check_ok(context, bw_model_slide(context, b->model, side, NULL));
    check_ok(context, bw_model_slide(context, b->model, top, NULL));
    check_ok(context, bw_model_force(context, b->model, tip, pull));
  }
  bw_release(root);
  bw_release(tip);
  bw_release(top);
  bw_release(side);
}

static void random_axis(bw_random *random, double axis[3]) {
  do
    for (int k = 0; k < 3; k++)
      axis[k] = 2 * bw_random_uniform(random) - 1;
  while (bw_norm(axis) < 0.1);
}

static void random_edit(bw_random *random, pose *p) {
  int what = (int)(bw_random_uniform(random) * 5), k = (int)(bw_random_uniform(random) * RIGID);
  double axis[3], turn[9];
  random_axis(random, axis);
  switch (what) {
  case 0: /* all as one */
    k = 0;
    rotation_about(axis, 3 * bw_random_uniform(random), turn);
    multiply(turn, p->turn[0], p->turn[0]);
    break;
  case 1:
  case 2:
    rotation_about(axis, 0.3 * bw_random_uniform(random), turn);
    multiply(p->turn[k], turn, p->turn[k]);
    break;
  case 3:
    for (int c = 0; c < 3; c++)
      p->scale[k][c] *= 0.8 + 0.45 * bw_random_uniform(random);
    break;
  default:
    for (int c = 0; c < 3; c++)
      p->shift[k][c] += 0.05 * axis[c];
  }
}

/* The model in the bar's present pose, or NULL when its mesh would be inverted or nearly so (where
 * rounding leaves less than the digits that are compared). */
static bw_model *posed(bw_context *context, bar *b) {
  bw_mesh *mesh = NULL;
  bw_model *model = NULL;
  follow(b);
  if (bw_mesh_moved(context, b->mesh, b->node, &mesh) != BW_OK)
    return NULL;
  double least = 1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    least = fmin(least, mesh->volume[e] / b->mesh->volume[e]);
  if (least > 0.2)
    check_ok(context, bw_model_moved(context, b->model, mesh, &model));
  bw_release(mesh);
  return model;
}

static double difference(const double *a, const double *b, int64_t count) {
  double most = 0, scale = 0;
  for (int64_t i = 0; i < count; i++) {
    most = fmax(most, fabs(a[i] - b[i]));
    scale = fmax(scale, fabs(b[i]));
  }
  return scale > 0 ? most / scale : most;
}

static const bw_statics_options relief = {.inertia_relief = true};

static void compare_in(bw_context *context, bw_local_system *local, const bw_model *model,
                       bw_local_method method, int precision, bw_reuse *reuse) {
  bw_static *fresh = NULL, *mine = NULL;
  bw_local_options options;
  bw_local_options_default(&options);
  options.method = method;
  options.precision = precision;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  check_ok(context, bw_local_statics(context, local, model, &relief, &options, &mine, reuse));
  check_ok(context, bw_statics(context, model, NULL, &relief, &fresh));
  const bw_system *a = local->system, *b = fresh->system;
  check_near(difference(a->stiffness, b->stiffness, 9 * a->graph->pair_count), 0, 1e-12);
  check_near(difference(mine->displacement, fresh->displacement, size), 0, 1e-8);
  check_near(difference(mine->reaction, fresh->reaction, size), 0, 1e-7);
  check_near(mine->energy / fresh->energy, 1, 1e-8);
  assert_null(mine->system);
  bw_release(mine);
  bw_release(fresh);
}

static void compare(bw_context *context, bw_local_system *local, const bw_model *model,
                    bw_local_method method, bw_reuse *reuse) {
  compare_in(context, local, model, method, 0, reuse);
}

static void edit_sequences(bw_context *context, int scene, int order, bw_local_method method,
                           int precision, int sequences, uint64_t seed) {
  bar b;
  bw_random random;
  bw_random_seed(&random, seed);
  bar_make(context, 1, order, &b);
  load_bar(context, &b, scene);
  for (int s = 0; s < sequences; s++) {
    bw_local_system *local = NULL;
    rest_pose(&b.now);
    follow(&b);
    check_ok(context, bw_local_system_create(context, b.model, false, DOMAINS, b.element_domain,
                                             b.node_domain, NULL, &local));
    for (int edit = 0; edit < 4; edit++) {
      pose before = b.now;
      random_edit(&random, &b.now);
      bw_model *model = posed(context, &b);
      if (!model) {
        b.now = before;
        follow(&b);
        continue;
      }
      bw_reuse reuse = {0};
      check_ok(context, bw_local_system_update(context, local, model, b.motion, &reuse));
      if (edit % 2 || bw_random_uniform(&random) < 0.5) /* or several edits before a solve */
        compare_in(context, local, model, method, precision, &reuse);
      bw_release(model);
    }
    bw_release(local);
  }
  bar_clear(&b);
}

static void random_sequences(void **state) {
  bw_context *context = check_context(state);
  int many = getenv("BARWRIGHT_FULL") ? 400 : 40; /* 520 in all */
  for (int scene = 0; scene < SCENES; scene++)
    for (int method = BW_LOCAL_AUTO; method <= BW_LOCAL_ITERATE; method++)
      for (int precision = 64; precision >= 32; precision -= 32)
        edit_sequences(context, scene, scene == 1 ? 2 : 1, (bw_local_method)method, precision,
                       (scene == 1 ? many / 2 : many) / 2, (uint64_t)(10 * scene + method + 1));
}

/* ---- what was reused ----------------------------------------------------------------------- */

static bw_local_system *local_of(bw_context *context, const bar *b) {
  bw_local_system *local = NULL;
  check_ok(context, bw_local_system_create(context, b->model, false, DOMAINS, b->element_domain,
                                           b->node_domain, NULL, &local));
  return local;
}

/* Bring the system to the bar's pose and compare. */
static bw_reuse edit_and_compare(bw_context *context, bar *b, bw_local_system *local,
                                 bw_local_method method) {
  bw_reuse reuse = {0};
  bw_model *model = posed(context, b);
  assert_non_null(model);
  check_ok(context, bw_local_system_update(context, local, model, b->motion, &reuse));
  compare(context, local, model, method, &reuse);
  bw_release(model);
  return reuse;
}

static void turn_domain(bar *b, int k, double angle) {
  const double axis[3] = {1, 2, -1};
  double turn[9];
  rotation_about(axis, angle, turn);
  multiply(b->now.turn[k], turn, b->now.turn[k]);
}

static void reuse_is_said(void **state) {
  bw_context *context = check_context(state);
  for (int scene = 0; scene < SCENES; scene++) {
    bar b;
    bar_make(context, 2, 1, &b);
    load_bar(context, &b, scene);
    bw_local_system *local = local_of(context, &b);
    turn_domain(&b, 0, 0.4); /* everything as one */
    bw_reuse r = edit_and_compare(context, &b, local, BW_LOCAL_REFACTOR);
    assert_true(r.pattern && r.ordering);
    assert_int_equal(r.domains, DOMAINS);
    assert_int_equal(r.method, BW_LOCAL_REFACTOR);
    assert_int_equal(r.iterations, 0);
    if (scene != 1) { /* there, a support that keeps its direction */
      assert_int_equal(r.domains_turned, DOMAINS);
      assert_int_equal(r.domains_touched, 0);
      check_near(r.factor_kept, 1, 0);
    } else {
      assert_true(r.domains_touched > 0 && r.domains_touched < DOMAINS);
      assert_true(r.factor_kept < 1 && r.factor_kept > 0.1);
    }
    turn_domain(&b, 2, 0.2); /* the tip: its joint is blended */
    r = edit_and_compare(context, &b, local, BW_LOCAL_REFACTOR);
    if (scene == 0 || scene == 2 || scene == 3) { /* slides at the joint turn too */
      assert_int_equal(r.domains_kept, 3);
      assert_int_equal(r.domains_turned, 1);
      assert_int_equal(r.domains_touched, 1);
    }
    assert_true(r.factor_kept > 0 && r.factor_kept < 1);
    b.now.shift[0][0] += 0.3; /* a translation touches nothing */
    r = edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
    assert_int_equal(r.domains_kept, DOMAINS);
    check_near(r.factor_kept, 1, 0);
    assert_int_equal(r.method, BW_LOCAL_REFACTOR);
    r = edit_and_compare(context, &b, local, BW_LOCAL_SCRATCH);
    assert_int_equal(r.method, BW_LOCAL_SCRATCH);
    check_near(r.factor_kept, 0, 0);
    pose before = b.now;
    b.now.scale[2][1] *= 1.05;
    r = edit_and_compare(context, &b, local, BW_LOCAL_ITERATE);
    assert_int_equal(r.method, BW_LOCAL_ITERATE);
    assert_true(r.iterations > 1 && r.iterations < 60);
    check_near(r.factor_kept, 1, 0);
    b.now = before; /* taken back: the factor is that of the shape again */
    r = edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
    assert_int_equal(r.method, BW_LOCAL_REFACTOR);
    assert_int_equal(r.iterations, 0);
    check_near(r.factor_kept, 1, 0);
    size_t factor = 0, updates = 0;
    bw_local_system_memory(local, &factor, &updates);
    assert_true(factor > 0 && updates > 0);
    bw_release(local);
    bar_clear(&b);
  }
}

/* The choice: a change near rounding is iterated away, a large one factored; and what was chosen is
 * what was predicted to cost less. */
static void choice_by_cost(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 1, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  const double stretch[4] = {1 + 1e-10, 1.2, 1.001, 1 + 1e-6};
  for (int i = 0; i < 4; i++) {
    b.now.scale[1][0] *= stretch[i];
    bw_reuse r = edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
    bool cheaper = r.predicted_iterate <= r.predicted_refactor;
    if (r.iterations == 0 || r.method == BW_LOCAL_ITERATE)
      assert_int_equal(r.method == BW_LOCAL_ITERATE, cheaper);
    if (i == 0)
      assert_int_equal(r.method, BW_LOCAL_ITERATE);
    if (i == 1)
      assert_int_equal(r.method, BW_LOCAL_REFACTOR);
  }
  bw_release(local);
  bar_clear(&b);
}

/* The work that the order of elimination was chosen by is the work that a session then does, and no
 * domain is touched but those whose bones moved: here the one reshaped and those blended beside it.
 */
static void work_is_foreseen(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bw_random random;
  bw_random_seed(&random, 5);
  bar_make(context, 2, 1, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  const bwi_reach *reach = local->inner->reach;
  int32_t domains = local->inner->domain_count;
  uint8_t *foreseen = calloc((size_t)domains, 1);
  for (int edit = 0; edit < 20; edit++) {
    int k = (int)(bw_random_uniform(&random) * RIGID);
    for (int c = 0; c < 3; c++)
      b.now.scale[k][c] = 0.9 + 0.2 * bw_random_uniform(&random);
    for (int32_t d = 0; d < domains; d++)
      foreseen[d] = abs(d - 2 * k) <= 1;
    bw_model *model = posed(context, &b);
    assert_non_null(model);
    bw_reuse r = {0};
    check_ok(context, bw_local_system_update(context, local, model, b.motion, &r));
    assert_memory_equal(local->inner->touched, foreseen, (size_t)domains);
    check_ok(context, bw_local_system_refactor(context, local, &r));
    check_near(r.factor_kept, 1 - bwi_reach_flops(reach, foreseen) / reach->symbolic->flops, 1e-12);
    bw_release(model);
  }
  free(foreseen);
  bw_release(local);
  bar_clear(&b);
}

/* Iterating is given up when too many iterations are foreseen: early, and not where it would soon
 * be done. */
static void given_up_early(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  b.now.scale[1][1] *= 1.3;
  turn_domain(&b, 2, 0.2);
  bw_model *model = posed(context, &b);
  check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
  int64_t size = 3 * (int64_t)b.mesh->node_count;
  double *f = numbers(3 * size), *u = numbers(3 * size);
  random_field(1, 3 * size, f);
  const bw_system *system = local->system;
  bwi_conjugate problem = {.graph = system->graph,
                           .stiffness = system->stiffness,
                           .numbering = system->numbering,
                           .factor = local->inner->factor,
                           .tolerance = 1e-10,
                           .limit = 2000};
  check_ok(context, bwi_conjugate_solve(context, &problem, 3, f, u));
  assert_true(problem.converged);
  int needed = problem.iterations;
  assert_true(needed > 20);
  problem.patience = 5;
  check_ok(context, bwi_conjugate_solve(context, &problem, 3, f, u));
  assert_false(problem.converged);
  assert_true(problem.iterations <= needed / 3);
  assert_true(problem.foreseen > 0.5 * needed && problem.foreseen < 2 * needed);
  problem.patience = 10.0 * needed;
  check_ok(context, bwi_conjugate_solve(context, &problem, 3, f, u));
  assert_true(problem.converged);
  assert_int_equal(problem.iterations, needed);
  free(f);
  free(u);
  bw_release(model);
  bw_release(local);
  bar_clear(&b);
}

/* A prediction that errs: iterating stops when it has cost what the other way would have, and that
 * is then gone. */
static void too_hopeful(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  /* of these domains all good is believed, and of no others */
  b.now.scale[1][0] *= 1 + 1e-9;
  turn_domain(&b, 2, 1e-9);
  edit_and_compare(context, &b, local, BW_LOCAL_ITERATE);
  b.now.scale[1][0] *= 1.3;
  turn_domain(&b, 2, 0.2);
  local->inner->experience = 1e-3;
  bw_reuse r = edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
  assert_int_equal(r.method, BW_LOCAL_REFACTOR);
  assert_true(r.predicted_iterate < r.predicted_refactor);
  assert_true(r.iterations > 0 && r.iterations < 20);
  assert_true(bwi_local_current(local));
  /* small steps, iterated, until their sum has cost as much */
  bw_local_options options;
  bw_local_options_default(&options);
  b.now.scale[2][1] *= 1 + 1e-10;
  bw_model *model = posed(context, &b);
  check_ok(context, bw_local_system_update(context, local, model, b.motion, &r));
  double *u = numbers(3 * (int64_t)b.mesh->node_count);
  int solves = 0;
  for (; solves < 100 && !bwi_local_current(local); solves++) {
    random_field((uint64_t)solves + 1, 3 * (int64_t)b.mesh->node_count, u);
    check_ok(context, bw_local_system_solve(context, local, &options, 1, u, u, &r));
  }
  assert_true(solves > 1 && solves < 100);
  free(u);
  bw_release(model);
  bw_release(local);
  bar_clear(&b);
}

/* ---- several right-hand sides, views, other materials --------------------------------------- */

static void many_sides(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 11 };
  for (int run = 0; run < 4; run++) {
    int scene = run % 2 * 3;
    bar b;
    bar_make(context, 2, 1, &b);
    load_bar(context, &b, scene);
    bw_local_system *local = local_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
    random_field(7, SIDES * size, force);
    memset(force + 4 * size, 0, (size_t)size * sizeof *force);
    b.now.scale[2][2] = 1.03;
    turn_domain(&b, 1, 0.05);
    bw_model *model = posed(context, &b);
    bw_system *fresh = NULL;
    bw_local_options options;
    bw_local_options_default(&options);
    options.precision = run < 2 ? 64 : 32;
    check_ok(context, bw_local_system_solve(context, local, &options, 1, force, u, NULL));
    check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
    check_ok(context, bw_system_create(context, model->mesh, b.material, local->system->numbering,
                                       NULL, &fresh));
    check_ok(context, bw_system_solve(context, fresh, SIDES, force, v));
    for (int method = BW_LOCAL_ITERATE; method >= BW_LOCAL_REFACTOR; method--) {
      bw_reuse reuse = {0};
      options.method = (bw_local_method)method;
      options.check = true;
      check_ok(context, bw_local_system_solve(context, local, &options, SIDES, force, u, &reuse));
      assert_int_equal(reuse.method, method);
      assert_int_equal(reuse.refinements > 0,
                       options.precision == 32 && method == BW_LOCAL_REFACTOR);
      for (int k = 0; k < SIDES; k++)
        check_near(difference(u + k * size, v + k * size, size), 0, 1e-8);
      for (int64_t i = 0; i < size; i++)
        check_near(u[4 * size + i], 0, 0);
    }
    memcpy(u, force, (size_t)(SIDES * size) * sizeof *u); /* in place */
    check_ok(context, bw_local_system_solve(context, local, NULL, SIDES, u, u, NULL));
    check_near(difference(u, v, size), 0, 1e-8);
    bw_release(fresh);
    bw_release(model);
    bw_release(local);
    free(force);
    free(u);
    free(v);
    bar_clear(&b);
  }
}

/* Fields to begin with: the same solution whatever they are; fewer iterations where they are near,
 * hardly any where the solutions are combinations of them. */
static void guesses(void **state) {
  bw_context *context = check_context(state);
  enum { SIDES = 3, FIELDS = 7 };
  for (int scene = 0; scene < 4; scene++) {
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, scene);
    bw_local_system *local = local_of(context, &b);
    int64_t size = 3 * (int64_t)b.mesh->node_count;
    double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
    double *field = numbers(FIELDS * size);
    const double *guess[FIELDS];
    random_field(5, SIDES * size, force);
    bw_local_options options;
    bw_local_options_default(&options);
    options.method = BW_LOCAL_ITERATE;
    options.check = true;
    for (int step = 0; step < 2; step++) { /* two shapes; the solutions of the first are fields */
      bw_reuse reuse = {0};
      b.now.scale[2][2] = 1.06 + 0.004 * step;
      bw_model *model = posed(context, &b);
      check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
      options.guess_count = 0;
      check_ok(context, bw_local_system_solve(context, local, &options, SIDES, force, v, &reuse));
      int without = reuse.iterations;
      if (step == 1) {
        for (int k = 0; k < FIELDS; k++)
          guess[k] = field + k * size; /* the fourth is zero */
        memcpy(field + 4 * size, field, (size_t)size * sizeof *field);
        random_field(9, size, field + 5 * size);
        field[6 * size] = NAN;
        options.guess = guess;
        options.guess_count = FIELDS;
        reuse = (bw_reuse){0};
        check_ok(context, bw_local_system_solve(context, local, &options, SIDES, force, u, &reuse));
        assert_true(reuse.iterations < without);
        for (int k = 0; k < SIDES; k++)
          check_near(difference(u + k * size, v + k * size, size), 0, 1e-8);
        for (int64_t i = 0; i < size; i++)
          field[i] = v[i] + 2 * v[size + i];
        memcpy(field + size, v + size, (size_t)(2 * size) * sizeof *field);
        reuse = (bw_reuse){0};
        options.tolerance = 1e-8;
        check_ok(context, bw_local_system_solve(context, local, &options, SIDES, force, u, &reuse));
        assert_true(reuse.iterations <= 1);
        options.method = BW_LOCAL_REFACTOR; /* ignores them */
        options.guess_count = FIELDS;
        check_ok(context, bw_local_system_solve(context, local, &options, SIDES, force, u, NULL));
      }
      memcpy(field, v, (size_t)(SIDES * size) * sizeof *field);
      bw_release(model);
    }
    bw_release(local);
    free(force);
    free(u);
    free(v);
    free(field);
    bar_clear(&b);
  }
}

/* The view of an up-to-date system is one: modes of the edited shape from it. Before that, it says
 * that it is not. */
static void view_serves_modes(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  b.now.scale[1][1] = 1.2;
  turn_domain(&b, 2, 0.3);
  bw_model *model = posed(context, &b);
  bw_modes *mine = NULL, *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 4;
  check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
  check_fails(context, BW_INVALID, "not up to date",
              bw_modes_elastic(context, local->system, &options, &mine));
  check_fails(context, BW_INVALID, "not up to date",
              bw_system_solve(context, local->system, 1, b.node, b.node));
  bw_local_options single;
  bw_local_options_default(&single);
  single.precision = 32;
  check_ok(context, bw_local_system_solve(context, local, &single, 1, b.node, b.node, NULL));
  check_ok(context, bw_local_system_refactor(context, local, NULL));
  assert_int_equal(local->inner->factor->kernels->bits, 32);
  assert_int_equal(local->system->factor->kernels->bits, 64);
  check_ok(context, bw_modes_elastic(context, local->system, &options, &mine));
  bw_static *fresh = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &fresh));
  check_ok(context, bw_modes_elastic(context, fresh->system, &options, &modes));
  for (int k = 0; k < 4; k++)
    check_near(mine->frequency[k] / modes->frequency[k], 1, 1e-8);
  bw_release(fresh);
  bw_release(modes);
  bw_release(mine);
  bw_release(model);
  bw_release(local);
  bar_clear(&b);
}

/* Printed material: its axes stay those of the printer, or turn with the domains. */
static void print_bar(bw_context *context, bar *b) {
  const bw_orthotropic constants = {.name = "print",
                                    .young = {2e9, 1.8e9, 1.2e9},
                                    .poisson = {0.35, 0.3, 0.3},
                                    .shear = {6e8, 5e8, 7e8},
                                    .density = 1100,
                                    .strength = {3e7, 3e7, 2e7}};
  bar_make(context, 1, 1, b);
  bw_release(b->material);
  bw_release(b->model);
  check_ok(context, bw_material_orthotropic(context, &constants, &b->material));
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
  load_bar(context, b, 0);
}

/* The material of every domain turned as the domain is. */
static void turn_material(bw_context *context, const bar *b, bw_model *model) {
  double turn[DOMAINS][9];
  for (int d = 0; d < DOMAINS; d++)
    memcpy(turn[d], b->rotation[d / 2], sizeof turn[d]);
  check_ok(context, bw_model_turn_material(context, model, DOMAINS, b->element_domain, turn[0]));
}

static void orthotropic(void **state) {
  bw_context *context = check_context(state);
  for (int turns = 0; turns < 2; turns++) {
    bar b;
    print_bar(context, &b);
    bw_local_system *local = NULL;
    check_ok(context, bw_local_system_create(context, b.model, turns, DOMAINS, b.element_domain,
                                             b.node_domain, NULL, &local));
    bw_local_options options;
    bw_local_options_default(&options);
    options.check = true;
    for (int step = 0; step < 3; step++) {
      bw_reuse reuse = {0};
      bw_static *result = NULL;
      if (step == 0)
        turn_domain(&b, 0, 0.5); /* all as one */
      else
        turn_domain(&b, step, 0.2);
      bw_model *model = posed(context, &b);
      if (turns) { /* the material must lie as the domains do */
        uint64_t revision = local->object.revision;
        check_fails(context, BW_INVALID, "turned otherwise than its domain",
                    bw_local_system_update(context, local, model, b.motion, &reuse));
        assert_int_equal(local->object.revision, revision);
        turn_material(context, &b, model);
      }
      options.method = step == 2 ? BW_LOCAL_ITERATE : BW_LOCAL_REFACTOR;
      check_ok(context, bw_local_system_update(context, local, model, b.motion, &reuse));
      check_ok(context, bw_local_statics(context, local, model, NULL, &options, &result, &reuse));
      if (step == 0 && turns)
        check_near(reuse.factor_kept, 1, 0);
      if (step == 0 && !turns)
        check_near(reuse.factor_kept, 0, 0); /* against the printer's axes all has turned */
      bw_release(result);
      bw_release(model);
    }
    bw_release(local);
    bar_clear(&b);
  }
}

/* A bar whose material turned with it has the stress of one of that shape whose material was given
 * so from the start: as a whole by bw_material_rotated, bent by element; and of the latter a system
 * can be made at that shape, and go on. */
static void material_turns(void **state) {
  bw_context *context = check_context(state);
  bar b;
  print_bar(context, &b);
  bw_local_system *local = NULL;
  check_ok(context, bw_local_system_create(context, b.model, true, DOMAINS, b.element_domain,
                                           b.node_domain, NULL, &local));
  size_t count = 6 * (size_t)b.mesh->node_count;
  double *mine = numbers((int64_t)count), *fresh = numbers((int64_t)count);
  for (int step = 0; step < 3; step++) {
    bw_reuse reuse = {0};
    bw_static *followed = NULL, *anew = NULL;
    bw_material *rotated = NULL;
    bw_model *other = NULL;
    turn_domain(&b, step == 0 ? 0 : step, 0.3);
    bw_model *model = posed(context, &b);
    turn_material(context, &b, model);
    check_ok(context, bw_local_system_update(context, local, model, b.motion, &reuse));
    check_ok(context, bw_local_statics(context, local, model, NULL, NULL, &followed, &reuse));
    check_ok(context, bw_static_stress(context, followed, true, mine));
    if (step == 0) {
      bar c = b;
      check_ok(context, bw_material_rotated(context, b.material, b.rotation[0], &rotated));
      check_ok(context, bw_model_create(context, b.mesh, rotated, &c.model));
      load_bar(context, &c, 0);
      check_ok(context, bw_model_moved(context, c.model, model->mesh, &other));
      bw_release(c.model);
    } else
      other = bw_retain(model);
    check_ok(context, bw_statics(context, other, NULL, NULL, &anew));
    check_ok(context, bw_static_stress(context, anew, true, fresh));
    check_near(difference(mine, fresh, (int64_t)count), 0, 1e-8);
    double error_mine = 0, error_fresh = 0;
    check_ok(context, bw_error_estimate(context, model->mesh, model->material,
                                        followed->displacement, NULL, &error_mine));
    check_ok(context, bw_error_estimate(context, other->mesh, other->material, anew->displacement,
                                        NULL, &error_fresh));
    check_near(error_mine / error_fresh, 1, 1e-8);
    if (step == 2) { /* with the material as it lay at rest the stress is another */
      check_ok(context,
               bw_nodal_stress(context, model->mesh, b.material, followed->displacement, fresh));
      assert_true(difference(mine, fresh, (int64_t)count) > 0.01);
    }
    bw_release(followed);
    bw_release(anew);
    bw_release(rotated);
    bw_release(other);
    if (step == 1) { /* from here on by a system made at this shape */
      bw_release(local);
      check_ok(context, bw_local_system_create(context, model, true, DOMAINS, b.element_domain,
                                               b.node_domain, NULL, &local));
      bw_release(b.model);
      b.model = bw_retain(model);
    }
    bw_release(model);
    if (step == 1) { /* motions count from here: turn all as one, material and frames with it */
      bw_domain_motion motion[DOMAINS];
      double turn[9], all[DOMAINS][9], *x = numbers(3 * b.mesh->node_count);
      const double axis[3] = {1, -1, 2};
      bw_mesh *mesh = NULL;
      rotation_about(axis, 0.7, turn);
      for (int d = 0; d < DOMAINS; d++) {
        bw_domain_motion_rest(&motion[d]);
        memcpy(motion[d].linear, turn, sizeof turn);
        for (int i = 0; i < 9; i++)
          motion[d].frame[i] = turn[3 * (i % 3) + i / 3];
        multiply(turn, b.rotation[d / 2], all[d]);
      }
      for (int32_t i = 0; i < b.mesh->node_count; i++)
        for (int c = 0; c < 3; c++)
          x[3 * i + c] = bw_dot(turn + 3 * c, b.model->mesh->node + 3 * i);
      check_ok(context, bw_mesh_moved(context, b.model->mesh, x, &mesh));
      bw_model *plain = NULL;
      bar c = b;
      check_ok(context, bw_model_create(context, b.mesh, b.material, &c.model));
      load_bar(context, &c, 0);
      check_ok(context, bw_model_moved(context, c.model, mesh, &plain));
      check_ok(context, bw_model_turn_material(context, plain, DOMAINS, b.element_domain, all[0]));
      reuse = (bw_reuse){0};
      check_ok(context, bw_local_system_update(context, local, plain, motion, &reuse));
      bw_local_options options;
      bw_local_options_default(&options);
      options.check = true;
      check_ok(context, bw_local_statics(context, local, plain, NULL, &options, &followed, &reuse));
      check_near(reuse.factor_kept, 1, 0);
      bw_release(followed);
      bw_release(plain);
      bw_release(mesh);
      bw_release(local);
      free(x);
      bw_release(b.model); /* and the last step from rest again */
      b.model = c.model;
      local = NULL;
      check_ok(context, bw_local_system_create(context, b.model, true, DOMAINS, b.element_domain,
                                               b.node_domain, NULL, &local));
    }
  }
  free(mine);
  free(fresh);
  bw_release(local);
  bar_clear(&b);
}

/* ---- failures ------------------------------------------------------------------------------ */

static void failures_and_recovery(void **state) {
  bw_context *context = check_context(state);
  bar b, other;
  bar_make(context, 1, 1, &b);
  bar_make(context, 2, 1, &other);
  load_bar(context, &b, 0);
  load_bar(context, &other, 0);
  bw_local_system *local = local_of(context, &b);
  turn_domain(&b, 1, 0.1);
  edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
  uint64_t revision = local->object.revision;
  bw_model *good = posed(context, &b), *model = NULL;

  /* what is refused leaves the system as it was */
  check_fails(context, BW_INVALID, "elements must be the same",
              bw_local_system_update(context, local, other.model, b.motion, NULL));
  bw_domain_motion wrong[DOMAINS];
  memcpy(wrong, b.motion, sizeof wrong);
  wrong[2].linear[0] = NAN;
  assert_int_equal(bw_local_system_update(context, local, good, wrong, NULL), BW_INVALID);
  memcpy(wrong, b.motion, sizeof wrong);
  wrong[4].linear[4] *= -1;
  assert_int_equal(bw_local_system_update(context, local, good, wrong, NULL), BW_INVALID);
  bw_static *result = NULL;
  check_fails(context, BW_INVALID, "last followed",
              bw_local_statics(context, local, good, NULL, NULL, &result, NULL));
  assert_true(local->object.revision == revision);
  bw_local_options options = {.method = BW_LOCAL_REFACTOR, .tolerance = 2};
  double *u = numbers(3 * (int64_t)b.mesh->node_count);
  check_fails(context, BW_INVALID, "between 0 and 1",
              bw_local_system_solve(context, local, &options, 1, u, u, NULL));
  options.tolerance = 1e-10;

  /* a waist so thin that the stiffness is singular: said when it is factored, and mended after */
  pose before = b.now;
  b.now.scale[1][1] = b.now.scale[1][2] = 3e-6;
  follow(&b);
  bw_mesh *flat = NULL;
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &flat));
  check_ok(context, bw_model_moved(context, b.model, flat, &model));
  check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
  assert_int_equal(bw_local_statics(context, local, model, NULL, &options, &result, NULL),
                   BW_SINGULAR);
  assert_int_equal(bw_local_statics(context, local, model, NULL, &options, &result, NULL),
                   BW_SINGULAR);
  options.method = BW_LOCAL_ITERATE; /* there is no factor to iterate with */
  assert_int_equal(bw_local_statics(context, local, model, NULL, &options, &result, NULL),
                   BW_SINGULAR);
  bw_release(model);
  bw_release(flat);
  b.now = before;
  bw_reuse r = edit_and_compare(context, &b, local, BW_LOCAL_AUTO);
  assert_int_equal(r.method, BW_LOCAL_SCRATCH);

  /* stopped by the user in the middle */
  turn_domain(&b, 2, 0.1);
  model = posed(context, &b);
  check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
  bw_cancel(context);
  assert_int_equal(bw_local_statics(context, local, model, NULL, NULL, &result, NULL),
                   BW_CANCELLED);
  bw_clear_cancel(context);
  r = (bw_reuse){0};
  compare(context, local, model, BW_LOCAL_AUTO, &r);
  bw_release(model);

  /* a load that is not balanced, and a check that finds what is wrong */
  options = (bw_local_options){.method = BW_LOCAL_REFACTOR, .tolerance = 1e-10, .check = true};
  local->stiffness->values[0] *= 1.001;
  random_field(3, 3 * (int64_t)b.mesh->node_count, u);
  check_fails(context, BW_INTERNAL, "stiffness kept through edits",
              bw_local_system_solve(context, local, &options, 1, u, u, NULL));
  free(u);
  bw_release(good);
  bw_release(local);
  bar_clear(&other);
  bar_clear(&b);
}

/* A factor of a quite other shape is no help: that is said, and the other way still works. */
static void no_convergence(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  b.now.scale[1][1] = b.now.scale[1][2] = 5e-3;
  follow(&b);
  bw_mesh *mesh = NULL;
  bw_model *model = NULL;
  bw_static *result = NULL;
  check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &mesh));
  check_ok(context, bw_model_moved(context, b.model, mesh, &model));
  check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
  bw_local_options options;
  bw_local_options_default(&options);
  options.method = BW_LOCAL_ITERATE;
  check_fails(context, BW_CONVERGENCE, "changed too much",
              bw_local_statics(context, local, model, NULL, &options, &result, NULL));
  bw_reuse reuse = {0};
  check_ok(context, bw_local_statics(context, local, model, NULL, NULL, &result, &reuse));
  assert_int_equal(reuse.method, BW_LOCAL_REFACTOR);
  bw_release(result);
  bw_release(model);
  bw_release(mesh);
  bw_release(local);
  bar_clear(&b);
}

/* The same shape held otherwise: other unknowns, and a whole new factor. */
static void supports_become_others(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 1, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  turn_domain(&b, 2, 0.1);
  bw_model *model = posed(context, &b);
  bw_selection *tip = NULL;
  const double point[3] = {10, 0.5, 0.5};
  check_ok(context, bw_select_nearest(context, model->mesh, point, 3, &tip));
  check_ok(context, bw_model_fix(context, model, tip));
  bw_reuse reuse;
  check_ok(context, bw_local_system_update(context, local, model, b.motion, &reuse));
  compare(context, local, model, BW_LOCAL_ITERATE, &reuse);
  assert_int_equal(reuse.method, BW_LOCAL_SCRATCH);
  assert_true(reuse.pattern && !reuse.ordering); /* nodes left the order */
  bw_release(tip);
  bw_release(model);
  edit_and_compare(context, &b, local, BW_LOCAL_AUTO); /* and back */
  bw_release(local);
  bar_clear(&b);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 1, 1, &b);
  load_bar(context, &b, 1);
  bw_model *rest = bw_retain(b.model);
  b.now.scale[1][1] = 1.02;
  bw_model *model = posed(context, &b);
  bw_domain_motion motion[DOMAINS];
  memcpy(motion, b.motion, sizeof motion);
  for (int64_t n = 1;; n += n < 200 ? 1 : 7) {
    bw_local_system *local = NULL;
    bw_fail_allocation(n, true);
    bw_status status = bw_local_system_create(context, rest, false, DOMAINS, b.element_domain,
                                              b.node_domain, NULL, &local);
    bw_fail_allocation(0, false);
    bw_release(local);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
  }
  bw_local_system *local = local_of(context, &b);
  bw_local_options options;
  bw_local_options_default(&options);
  double *field = numbers(3 * (int64_t)b.mesh->node_count);
  const double *guess[1] = {field};
  random_field(3, 3 * (int64_t)b.mesh->node_count, field);
  options.guess = guess;
  options.guess_count = 1;
  for (int run = 0; run < 3; run++) {
    options.method = run == 0 ? BW_LOCAL_ITERATE : BW_LOCAL_REFACTOR;
    options.precision = run < 2 ? 0 : 32;
    bool updated = false;
    for (int64_t n = 1;; n++) {
      bw_static *result = NULL;
      bw_status status = BW_OK;
      bw_fail_allocation(n, true);
      if (!updated)
        status = bw_local_system_update(context, local, model, motion, NULL);
      updated = updated || status == BW_OK;
      if (status == BW_OK)
        status = bw_local_statics(context, local, model, NULL, &options, &result, NULL);
      bw_fail_allocation(0, false);
      bw_release(result);
      if (status == BW_OK)
        break;
      assert_int_equal(status, BW_MEMORY);
    }
    bw_reuse reuse = {0};
    compare(context, local, model, BW_LOCAL_AUTO, &reuse);
  }
  free(field);
  bw_release(local);
  bw_release(model);
  bw_release(rest);
  bar_clear(&b);
}

/* The same bits for one thread and for two. */
static void threads_agree(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 2, 1, &b);
  load_bar(context, &b, 1);
  b.now.scale[1][1] = 1.02;
  turn_domain(&b, 2, 0.1);
  bw_model *model = posed(context, &b);
  enum { RUNS = 8 };
  bw_static *result[RUNS] = {NULL};
  for (int k = 0; k < RUNS; k++) {
    check_ok(context, bw_set_threads(context, 1 + k % 2));
    bw_local_system *local = local_of(context, &b);
    bw_local_options options;
    bw_local_options_default(&options);
    options.method = k % 4 < 2 ? BW_LOCAL_REFACTOR : BW_LOCAL_ITERATE;
    options.precision = k < 4 ? 64 : 32;
    check_ok(context, bw_local_system_update(context, local, model, b.motion, NULL));
    check_ok(context, bw_local_statics(context, local, model, NULL, &options, &result[k], NULL));
    bw_release(local);
  }
  size_t bytes = 3 * (size_t)b.mesh->node_count * sizeof(double);
  for (int k = 0; k < RUNS; k += 2)
    assert_memory_equal(result[k]->displacement, result[k + 1]->displacement, bytes);
  for (int k = 0; k < RUNS; k++)
    bw_release(result[k]);
  bw_release(model);
  bar_clear(&b);
}

/* ---- single precision ---------------------------------------------------------------------- */

/* What it takes and what it says; from one precision to the other. */
static void precisions(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  size_t factor[2], updates[2];
  for (int k = 0; k < 2; k++) {
    bw_reuse r = {0};
    b.now.scale[1][1] = 1.1 + 0.1 * k;
    bw_model *model = posed(context, &b);
    check_ok(context, bw_local_system_update(context, local, model, b.motion, &r));
    compare_in(context, local, model, BW_LOCAL_REFACTOR, 32 + 32 * k, &r);
    assert_int_equal(r.precision, 32 + 32 * k);
    assert_int_equal(r.method, BW_LOCAL_SCRATCH); /* there was one in the other precision */
    assert_int_equal(r.iterations, 0);
    assert_int_equal(r.refinements > 0, k == 0);
    assert_true(r.refinements < 10);
    bw_local_system_memory(local, &factor[k], &updates[k]);
    bw_release(model);
    model = NULL;
  }
  assert_int_equal(factor[1], 2 * factor[0]);
  assert_int_equal(updates[1], 2 * updates[0]);
  bw_local_options options = {.tolerance = 1e-10, .precision = 16};
  check_fails(context, BW_INVALID, "32 or 64 bits",
              bw_local_system_solve(context, local, &options, 1, b.node, b.node, NULL));
  bw_release(local);
  bar_clear(&b);
}

/* A waist of a third still does; one of a tenth, where elements are ten times as long as thick both
 * ways, is too much for seven digits: the factor in single precision breaks down, the one in double
 * precision serves, from then on, and that is said. */
static void too_thin_for_single(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < 2; k++) {
    const double waist[2] = {0.3, 0.1};
    bar b;
    bar_make(context, 2, 2, &b);
    load_bar(context, &b, 0);
    bw_local_system *local = local_of(context, &b);
    bw_static *result = NULL, *fresh = NULL;
    bw_local_options options;
    bw_local_options_default(&options);
    options.precision = 32;
    options.method = BW_LOCAL_REFACTOR;
    bw_reuse reuse = {0};
    check_ok(context, bw_local_statics(context, local, b.model, NULL, &options, &result, &reuse));
    assert_int_equal(reuse.precision, 32);
    bw_release(result);
    b.now.scale[1][1] = b.now.scale[1][2] = waist[k];
    follow(&b);
    bw_mesh *mesh = NULL;
    bw_model *model = NULL;
    check_ok(context, bw_mesh_moved(context, b.mesh, b.node, &mesh));
    check_ok(context, bw_model_moved(context, b.model, mesh, &model));
    bw_clear_remarks(context);
    check_ok(context, bw_local_system_update(context, local, model, b.motion, &reuse));
    check_ok(context, bw_local_statics(context, local, model, NULL, &options, &result, &reuse));
    check_ok(context, bw_statics(context, model, NULL, NULL, &fresh));
    int64_t size = 3 * (int64_t)mesh->node_count;
    check_near(difference(result->displacement, fresh->displacement, size), 0, 1e-8);
    bw_release(result);
    assert_int_equal(reuse.precision, k == 0 ? 32 : 64);
    if (k == 1) {
      assert_int_equal(reuse.method, BW_LOCAL_SCRATCH);
      assert_non_null(strstr(bw_remark_at(context, 0), "double precision from here on"));
      b.now.scale[1][1] = b.now.scale[1][2] = 1;
      bw_model *back = posed(context, &b);
      check_ok(context, bw_local_system_update(context, local, back, b.motion, &reuse));
      compare_in(context, local, back, BW_LOCAL_AUTO, 32, &reuse);
      assert_int_equal(reuse.precision, 64);
      bw_release(back);
    }
    bw_release(fresh);
    bw_release(model);
    bw_release(mesh);
    bw_release(local);
    bar_clear(&b);
  }
}

/* By cost: where iterations are cheap single precision, where they are dear double, and no more of
 * single once it failed. */
static void choice_of_precision(void **state) {
  bw_context *context = check_context(state);
  bar b;
  bar_make(context, 3, 2, &b);
  load_bar(context, &b, 0);
  bw_local_system *local = local_of(context, &b);
  bwi_local *inner = local->inner;
  for (int k = 0; k < 4; k++) {
    int bits = k == 3 ? 64 : 0;
    inner->refinements = k == 1 ? 200 : 0.01;
    inner->lost = k == 2;
    check_ok(context, bwi_local_choose_bits(context, local, inner->reach, &bits));
    assert_int_equal(bits, k == 0 ? 32 : 64);
  }
  bw_release(local);
  bar_clear(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(random_sequences),   check_test(reuse_is_said),
      check_test(choice_by_cost),     check_test(too_hopeful),
      check_test(work_is_foreseen),   check_test(given_up_early),
      check_test(many_sides),         check_test(guesses),
      check_test(view_serves_modes),  check_test(orthotropic),
      check_test(material_turns),     check_test(failures_and_recovery),
      check_test(no_convergence),     check_test(supports_become_others),
      check_test(no_memory),          check_test(threads_agree),
      check_test(precisions),         check_test(too_thin_for_single),
      check_test(choice_of_precision)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
