/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Parts for tests of contact. */
#ifndef PARTS_H
#define PARTS_H

#include "bodies.h"

#include "barwright/contact.h"

static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double young = 200e9, poisson = 0.3;

static inline bw_model *model_of(bw_context *context, bw_mesh *mesh) {
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(material);
  return model;
}

static inline void slide(bw_context *context, bw_model *model, int k, double at) {
  bw_selection *face = body_face(context, model->mesh, k, at);
  check_ok(context, bw_model_slide(context, model, face, axis[k]));
  bw_release(face);
}

/* Both meshes as one, whose bodies share no node. */
static inline bw_mesh *both(bw_context *context, bw_mesh *a, bw_mesh *b) {
  int per = a->nodes_per_element;
  int64_t nodes = (int64_t)a->node_count + b->node_count;
  int64_t elements = (int64_t)a->element_count + b->element_count;
  double *node = numbers(3 * nodes);
  int32_t *element = (int32_t *)calloc((size_t)(per * elements), sizeof *element);
  bw_mesh *mesh = NULL;
  memcpy(node, a->node, 3 * (size_t)a->node_count * sizeof *node);
  memcpy(node + 3 * (int64_t)a->node_count, b->node, 3 * (size_t)b->node_count * sizeof *node);
  for (int64_t i = 0; i < per * elements; i++) {
    int64_t first = (int64_t)per * a->element_count;
    element[i] = i < first ? a->element[i] : b->element[i - first] + a->node_count;
  }
  check_ok(context, bw_mesh_copy(context, a->order, nodes, node, elements, element, NULL, &mesh));
  free(node);
  free(element);
  bw_release(a);
  bw_release(b);
  return mesh;
}

/* A block of 0.3 x 0.2 x 0.1 m and its faces across z. */
typedef struct block {
  bw_mesh *mesh;
  bw_model *model;
  bw_selection *foot, *top;
} block;

static inline block block_of(bw_context *context, int nx, int ny, int nz, int order) {
  block b = {.mesh = body_box(context, 0.3, 0.2, 0.1, nx, ny, nz, order)};
  b.model = model_of(context, b.mesh);
  b.foot = body_face(context, b.mesh, 2, 0);
  b.top = body_face(context, b.mesh, 2, 0.1);
  return b;
}

static inline void block_release(block *b) {
  bw_release(b->foot);
  bw_release(b->top);
  bw_release(b->model);
  bw_release(b->mesh);
}

/* A block that is pressed and sheared on a sphere: one and three threads give the same. */
static inline void check_same_bits(bw_context *context, double friction, int steps) {
  block b = block_of(context, 6, 5, 3, 2);
  size_t size = (size_t)b.mesh->node_count * sizeof(double);
  bw_rigid_surface *with = NULL;
  bw_contact *c[2] = {NULL, NULL};
  bw_contact_options options;
  bw_contact_options_default(&options);
  options.steps = steps;
  check_ok(context, bw_model_traction(context, b.model, b.top,
                                      (double[3]){friction > 0 ? 1e6 : 0, 0, -1e7}));
  check_ok(context, bw_rigid_sphere(context, (double[3]){0.15, 0.1, -3}, 3, false, &with));
  bw_contact_pair pair = {.on = b.foot, .with = with, .friction = friction};
  for (int k = 0; k < 2; k++) {
    check_ok(context, bw_set_threads(context, k ? 3 : 1));
    check_ok(context, bw_contact_solve(context, b.model, 1, &pair, NULL, &options, &c[k]));
  }
  assert_memory_equal(c[0]->pressure, c[1]->pressure, size);
  if (friction > 0)
    assert_memory_equal(c[0]->traction, c[1]->traction, 3 * size);
  assert_memory_equal(c[0]->solution->displacement, c[1]->solution->displacement, 3 * size);
  bw_release(c[0]);
  bw_release(c[1]);
  bw_release(with);
  block_release(&b);
}

/* A contact of a block on a plane fails at each allocation without a leak. */
static inline void check_memory(bw_context *context, double friction) {
  block b = block_of(context, 2, 1, 1, 1);
  bw_rigid_surface *with = NULL;
  bw_contact *c = NULL;
  check_ok(context, bw_model_traction(context, b.model, b.top,
                                      (double[3]){friction > 0 ? 1e5 : 0, 0, -1e6}));
  check_ok(context, bw_rigid_plane(context, (double[3]){0}, axis[2], &with));
  bw_contact_pair pair = {.on = b.foot, .with = with, .friction = friction};
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, c, bw_contact_solve(context, b.model, 1, &pair, NULL, NULL, &c));
  bw_release(with);
  block_release(&b);
}

#endif
