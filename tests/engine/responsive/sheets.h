/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Plane meshes and materials for the tests of sheets. */
#ifndef SHEETS_H
#define SHEETS_H

#include "check.h"

enum { BOTTOM, RIGHT, TOP, LEFT };

static inline bw_material *isotropic(bw_context *context, double young, double poisson,
                                     double density) {
  bw_material *material;
  bw_isotropic constants = {"test", young, poisson, density, 0, 0, 0};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

/* The rectangle with the tags bottom, right, top, left. */
static inline bw_plane_mesh *rectangle(bw_context *context, int order, double width, double height,
                                       int nx, int ny) {
  bw_plane_mesh *mesh;
  double low[2] = {0, 0}, high[2] = {width, height};
  check_ok(context,
           bw_plane_rectangle(context, order, low, high, nx, ny, BW_DIAGONAL_UNION_JACK, &mesh));
  return mesh;
}

/* The same mesh with all inner corners moved about, sides straight. */
static inline bw_plane_mesh *jittered(bw_context *context, bw_plane_mesh *mesh, double by) {
  const bw_plane_nodes *nodes = mesh->topology->nodes;
  bw_plane_mesh *moved;
  bw_random random;
  bw_random_seed(&random, 3);
  double *point = BW_NEW(context, double, 2 * nodes->node_count);
  memcpy(point, mesh->point, 2 * (size_t)nodes->node_count * sizeof *point);
  for (int32_t i = 0; i < nodes->corner_count; i++)
    for (int k = 0; k < 2; k++) {
      double off = by * (2 * bw_random_uniform(&random) - 1);
      if (nodes->segment[i] < 0)
        point[2 * i + k] += off;
    }
  if (nodes->order == 2)
    for (int32_t e = 0; e < mesh->topology->element_count; e++)
      for (int a = 0; a < 3; a++) {
        const int32_t *node = mesh->topology->element + 6 * e;
        for (int k = 0; k < 2; k++)
          point[2 * node[3 + a] + k] =
              0.5 * (point[2 * node[a] + k] + point[2 * node[(a + 1) % 3] + k]);
      }
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &moved));
  bw_free(point);
  bw_release(mesh);
  return moved;
}

/* The same mesh with what lies above a height as region 1. */
static inline bw_plane_mesh *in_two(bw_context *context, bw_plane_mesh *mesh, double height) {
  const bw_plane_topology *t = mesh->topology;
  const bw_plane_nodes *nodes = t->nodes;
  int width = nodes->order == 1 ? 3 : 6;
  bw_plane_mesh *two;
  int32_t *region = BW_NEW(context, int32_t, t->element_count);
  for (int32_t e = 0; e < t->element_count; e++) {
    double y = 0;
    for (int a = 0; a < 3; a++)
      y += mesh->point[2 * t->element[e * width + a] + 1] / 3;
    region[e] = y > height;
  }
  check_ok(context, bw_plane_mesh_on(context, mesh->outline, nodes->order, nodes->node_count,
                                     mesh->point, nodes->segment, nodes->parameter,
                                     t->element_count, t->element, region, &two));
  bw_free(region);
  bw_release(mesh);
  return two;
}

/* The same mesh with the mid-edge nodes of inner sides off their chords. */
static inline bw_plane_mesh *bowed(bw_context *context, bw_plane_mesh *mesh, double by) {
  const bw_plane_nodes *nodes = mesh->topology->nodes;
  bw_plane_mesh *curved;
  double *point = BW_NEW(context, double, 2 * nodes->node_count);
  memcpy(point, mesh->point, 2 * (size_t)nodes->node_count * sizeof *point);
  for (int32_t i = nodes->corner_count; i < nodes->node_count; i++)
    for (int k = 0; k < 2 && nodes->segment[i] < 0; k++)
      point[2 * i + k] += by * sin(7.0 * i + k);
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &curved));
  bw_free(point);
  bw_release(mesh);
  return curved;
}

/* Nodes taken to other places by a map. */
static inline bw_plane_mesh *mapped(bw_context *context, bw_plane_mesh *mesh,
                                    void (*map)(double point[2])) {
  const bw_plane_topology *topology = mesh->topology;
  int32_t nodes = topology->nodes->node_count;
  double *point = BW_NEW(context, double, 2 * nodes);
  bw_plane_mesh *copy;
  for (int32_t i = 0; i < nodes; i++) {
    point[2 * i] = mesh->point[2 * i];
    point[2 * i + 1] = mesh->point[2 * i + 1];
    map(point + 2 * i);
  }
  check_ok(context, bw_plane_mesh_copy(context, topology->nodes->order, nodes, point,
                                       topology->element_count, topology->element, NULL, &copy));
  bw_free(point);
  bw_release(mesh);
  return copy;
}

static inline bw_sheet *sheet_on(bw_context *context, const bw_plane_mesh *mesh,
                                 const bw_material *material, double thickness, bool plane_strain,
                                 int32_t count, const bw_condition *condition) {
  bw_sheet *sheet;
  bw_sheet_section section = {material, thickness, plane_strain};
  bw_sheet_description description = {
      .section_count = 1, .section = &section, .condition_count = count, .condition = condition};
  check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
  return sheet;
}

/* What `solve` does of a constrained and pulled sheet has the same bits on one to three threads;
 * the mesh is large enough to be shared out. */
static inline void same_on_any_threads(bw_context *context, double young, double traction,
                                       double jitter,
                                       void (*solve)(bw_context *context, bw_sheet *sheet)) {
  bw_material *material = isotropic(context, young, 0.3, 10);
  bw_condition conditions[3] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1},
      {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = traction}};
  double *first = NULL;
  for (int threads = 1; threads <= 3; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    bw_plane_mesh *mesh = jittered(context, rectangle(context, 1, 1, 1, 80, 80), jitter);
    size_t bytes = 2 * (size_t)mesh->topology->nodes->node_count * sizeof(double);
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 3, conditions);
    solve(context, sheet);
    if (first)
      assert_memory_equal(first, sheet->displacement, bytes);
    else {
      first = BW_NEW(context, double, bytes / sizeof(double));
      memcpy(first, sheet->displacement, bytes);
    }
    bw_release(sheet);
    bw_release(mesh);
  }
  bw_free(first);
  bw_release(material);
}

/* The node nearest to a place. */
static inline int32_t node_at(const bw_plane_mesh *mesh, double x, double y) {
  int32_t best = 0;
  double min = INFINITY;
  for (int32_t i = 0; i < mesh->topology->nodes->node_count; i++) {
    double d = hypot(mesh->point[2 * i] - x, mesh->point[2 * i + 1] - y);
    if (d < min)
      min = d, best = i;
  }
  return best;
}

#endif
