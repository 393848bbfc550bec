/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Parts for tests of contact. */
#ifndef PARTS_H
#define PARTS_H

#include "bodies.h"

#include "barwright/contact.h"

static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double young = 200e9, poisson = 0.3;

static inline bw_selection *plane(bw_context *context, const bw_mesh *mesh, int k, double at) {
  double origin[3] = {0, 0, 0};
  bw_selection *face = NULL;
  origin[k] = at;
  check_ok(context, bw_select_plane(context, mesh, origin, axis[k], 1e-9, &face));
  return face;
}

static inline bw_model *model_of(bw_context *context, bw_mesh *mesh) {
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(material);
  return model;
}

static inline void slide(bw_context *context, bw_model *model, int k, double at) {
  bw_selection *face = plane(context, model->mesh, k, at);
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

#endif
