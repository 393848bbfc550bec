/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A bar of five subdomains along x, R F R F R, is bent at its two joints, stretched and turned:
 * what the tests of systems that follow edits share. */
#ifndef INCREMENTAL_BAR_H
#define INCREMENTAL_BAR_H

#include "bodies.h"
#include "incremental/incremental.h"
#include "solver_by.h"

enum { SUBDOMAINS = 5, RIGID = 3 };

/* Where subdomains end along the bar of length 10; the R subdomains are 0, 2, 4. */
static const double cut[SUBDOMAINS + 1] = {0, 2, 4, 6, 8, 10};

/* What an edit changes: every R subdomain turns and translates against the one before, about the
 * middle of the F subdomain between, and is stretched about that point along its own axes. */
typedef struct pose {
  double turn[RIGID][9]; /* against the R subdomain before; of the first: against rest */
  double scale[RIGID][3];
  double shift[RIGID][3];
} pose;

typedef struct bar {
  bw_mesh *mesh; /* at rest */
  bw_material *material;
  bw_model *model; /* at rest */
  int32_t *element_subdomain, *node_subdomain;
  pose now;
  double map[RIGID][12], rotation[RIGID][9];
  double *node;
  bw_subdomain_motion motion[SUBDOMAINS];
} bar;

static inline void multiply(const double *a, const double *b, double *c) {
  double out[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      out[3 * i + j] = 0;
      for (int k = 0; k < 3; k++)
        out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    }
  memcpy(c, out, sizeof out);
}

static inline void rotation_about(const double axis[3], double angle, double *r) {
  double size = bw_norm(axis), n[3] = {axis[0] / size, axis[1] / size, axis[2] / size};
  double c = cos(angle), s = sin(angle);
  const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      r[3 * i + j] = (i == j) * c + s * cross[3 * i + j] + (1 - c) * n[i] * n[j];
}

static inline void identity(double *r) {
  for (int k = 0; k < 9; k++)
    r[k] = k % 4 == 0;
}

static inline void rest_pose(pose *p) {
  memset(p, 0, sizeof *p);
  for (int k = 0; k < RIGID; k++) {
    identity(p->turn[k]);
    for (int c = 0; c < 3; c++)
      p->scale[k][c] = 1;
  }
}

static inline void apply(const double *map, const double *x, double *y) {
  for (int i = 0; i < 3; i++)
    y[i] = bw_dot(map + 4 * i, x) + map[4 * i + 3];
}

/* Maps, nodes and motions of the bar's pose. */
static inline void follow(bar *b) {
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
    while (k < SUBDOMAINS - 1 && x[0] > cut[k + 1])
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
  for (int d = 0; d < SUBDOMAINS; d++) {
    int k = d / 2;
    bw_subdomain_motion *m = &b->motion[d];
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

static inline void bar_clear(bar *b) {
  bw_release(b->model);
  bw_release(b->material);
  bw_release(b->mesh);
  free(b->element_subdomain);
  free(b->node_subdomain);
  free(b->node);
}

static inline void bar_make(bw_context *context, int across, int order, bar *b) {
  memset(b, 0, sizeof *b);
  b->mesh = body_box(context, 10, 1, 1, 10, across, across, order);
  b->material = body_material(context);
  int32_t nodes = b->mesh->node_count, width = b->mesh->nodes_per_element;
  b->element_subdomain = malloc((size_t)b->mesh->element_count * sizeof(int32_t));
  b->node_subdomain = malloc((size_t)nodes * sizeof(int32_t));
  b->node = numbers(3 * nodes);
  for (int32_t i = 0; i < nodes; i++)
    b->node_subdomain[i] = -1;
  for (int kind = 1; kind >= 0; kind--) /* R last: it takes the interfaces */
    for (int32_t e = 0; e < b->mesh->element_count; e++) {
      double centre = 0;
      for (int a = 0; a < 4; a++)
        centre += 0.25 * b->mesh->node[3 * b->mesh->element[e * width + a]];
      int d = (int)(centre / 2);
      b->element_subdomain[e] = d;
      for (int a = 0; d % 2 == kind && a < width; a++)
        b->node_subdomain[b->mesh->element[e * width + a]] = d;
    }
  rest_pose(&b->now);
  follow(b);
  check_ok(context, bw_model_create(context, b->mesh, b->material, &b->model));
}

/* Supports and loads: built in; sliding on its own surface, prescribed, held at a corner; built in,
 * displaced and heated; free; sliding on its own surface all round one end. */
enum { SCENES = 5 };

static inline void load_bar(bw_context *context, bar *b, int scene) {
  bw_selection *root = body_face(context, b->mesh, 0, 0), *tip = body_face(context, b->mesh, 0, 10);
  bw_selection *top = body_face(context, b->mesh, 2, 1), *side = body_face(context, b->mesh, 1, 0);
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
    check_ok(context, bw_model_temperature(context, b->model, warm, &(double){1e-5}));
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

static inline void random_axis(bw_random *random, double axis[3]) {
  do
    for (int k = 0; k < 3; k++)
      axis[k] = 2 * bw_random_uniform(random) - 1;
  while (bw_norm(axis) < 0.1);
}

static inline void random_edit(bw_random *random, pose *p) {
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
static inline bw_model *posed(bw_context *context, bar *b) {
  bw_mesh *mesh = NULL;
  bw_model *model = NULL;
  follow(b);
  if (bw_mesh_moved(context, b->mesh, b->node, &mesh) != BW_OK)
    return NULL;
  double min = 1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    min = fmin(min, mesh->volume[e] / b->mesh->volume[e]);
  if (min > 0.2)
    check_ok(context, bw_model_moved(context, b->model, mesh, &model));
  bw_release(mesh);
  return model;
}

static inline double difference(const double *a, const double *b, int64_t count) {
  double max = 0, scale = 0;
  for (int64_t i = 0; i < count; i++) {
    max = fmax(max, fabs(a[i] - b[i]));
    scale = fmax(scale, fabs(b[i]));
  }
  return scale > 0 ? max / scale : max;
}

static const bw_statics_options relief = {.inertia_relief = true};

static inline void compare_in(bw_context *context, bw_incremental_system *incremental,
                              const bw_model *model, edit_way method, int precision,
                              bw_reuse *reuse) {
  bw_static *fresh = NULL, *mine = NULL;
  bw_incremental_options options;
  bw_incremental_options_default(&options);
  options.solver = solver_by(method);
  options.precision = precision;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  check_ok(context,
           bw_incremental_statics(context, incremental, model, &relief, &options, &mine, reuse));
  check_ok(context, bw_statics(context, model, NULL, &relief, &fresh));
  const bw_system *a = incremental->system, *b = fresh->system;
  check_near(difference(a->stiffness, b->stiffness, 9 * a->pattern->block_count), 0, 1e-12);
  check_near(difference(mine->displacement, fresh->displacement, size), 0, 1e-8);
  check_near(difference(mine->reaction, fresh->reaction, size), 0, 1e-7);
  check_near(mine->energy / fresh->energy, 1, 1e-8);
  assert_null(mine->system);
  bw_release(mine);
  bw_release(fresh);
}

static inline void compare(bw_context *context, bw_incremental_system *incremental,
                           const bw_model *model, edit_way method, bw_reuse *reuse) {
  compare_in(context, incremental, model, method, 0, reuse);
}

static inline bw_incremental_system *incremental_of(bw_context *context, const bar *b) {
  bw_incremental_system *incremental = NULL;
  check_ok(context,
           bw_incremental_system_create(context, b->model, false, SUBDOMAINS, b->element_subdomain,
                                        b->node_subdomain, NULL, &incremental));
  return incremental;
}

/* Bring the system to the bar's pose and compare. */
static inline bw_reuse edit_and_compare(bw_context *context, bar *b,
                                        bw_incremental_system *incremental, edit_way method) {
  bw_reuse reuse = {0};
  bw_model *model = posed(context, b);
  assert_non_null(model);
  check_ok(context, bw_incremental_system_update(context, incremental, model, b->motion, &reuse));
  compare(context, incremental, model, method, &reuse);
  bw_release(model);
  return reuse;
}

static inline void turn_subdomain(bar *b, int k, double angle) {
  const double axis[3] = {1, 2, -1};
  double turn[9];
  rotation_about(axis, angle, turn);
  multiply(b->now.turn[k], turn, b->now.turn[k]);
}

#endif
