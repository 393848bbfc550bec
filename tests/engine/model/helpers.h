/* Meshes for the tests of the model. */
#ifndef MODEL_HELPERS_H
#define MODEL_HELPERS_H

#include "check.h"

#include "model/internal.h"

static inline bw_mesh *box_mesh(bw_context *context, double lx, double ly, double lz, int nx,
                                int ny, int nz, int order) {
  double low[3] = {0, 0, 0}, high[3] = {lx, ly, lz};
  int cells[3] = {nx, ny, nz};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

/* The first octant of a ball of radius 1: cube points moved out along rays, so that the cube's far
 * faces become the sphere and its near faces the three planes. Curved edges in order 2. */
static inline void octant_map(void *data, const double unit[3], double out[3]) {
  (void)data;
  double max = fmax(unit[0], fmax(unit[1], unit[2]));
  double size = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
  for (int k = 0; k < 3; k++)
    out[k] = size > 0 ? unit[k] * (1 - max + max * max / size) : 0;
}

static inline bw_mesh *octant_mesh(bw_context *context, int cells_per_side, int order) {
  int cells[3] = {cells_per_side, cells_per_side, cells_per_side};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, order, octant_map, NULL, &mesh));
  return mesh;
}

/* Two boxes of one cell each, 1 x 1 x 1 at the origin and at (3, 0, 0). */
static inline bw_mesh *two_boxes(bw_context *context) {
  bw_mesh *one = box_mesh(context, 1, 1, 1, 1, 1, 1, 1), *two = NULL;
  int32_t n = one->node_count, m = one->element_count;
  double node[3 * 16];
  int32_t element[4 * 12];
  assert_true(n == 8 && m == 6);
  for (int32_t i = 0; i < 3 * n; i++) {
    node[i] = one->node[i];
    node[3 * n + i] = one->node[i] + (i % 3 == 0 ? 3 : 0);
  }
  for (int32_t i = 0; i < 4 * m; i++) {
    element[i] = one->element[i];
    element[4 * m + i] = one->element[i] + n;
  }
  check_ok(context, bw_mesh_copy(context, 1, 2 * n, node, 2 * m, element, NULL, &two));
  bw_release(one);
  return two;
}

static inline bw_material *some_material(bw_context *context) {
  bw_isotropic constants = {"test", 2e11, 0.3, 7800, 4e8, 0, 0};
  bw_material *material = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static inline bw_model *some_model(bw_context *context, const bw_mesh *mesh) {
  bw_material *material = some_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(material);
  return model;
}

/* The nodes and facets of the plane x[axis] = at. */
static inline bw_selection *face_of(bw_context *context, const bw_mesh *mesh, int axis, double at) {
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  point[axis] = at;
  normal[axis] = 1;
  bw_selection *selection = NULL;
  check_ok(context, bw_select_plane(context, mesh, point, normal, 1e-9, &selection));
  return selection;
}

#endif
