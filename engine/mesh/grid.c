/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tetrahedra on a box of cells, each cell cut into the six tetrahedra that run along its edges from
 * the lowest corner to the highest, one for every order of the three directions (Kuhn). All cells
 * are cut alike, so neighbours agree on the diagonals of their common faces. */
#include "mesh/mesh_internal.h"

#include <math.h>

static bw_status check_cells(bw_context *context, const int cells[3]) {
  double elements = 6, nodes = 1;
  for (int k = 0; k < 3; k++) {
    if (cells[k] < 1)
      return bw_fail(context, BW_INVALID,
                     "a box of %d x %d x %d cells: every number of cells must be at least 1",
                     cells[0], cells[1], cells[2]);
    elements *= cells[k];
    nodes *= cells[k] + 1.0;
  }
  if (elements > INT32_MAX || nodes > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "a box of %d x %d x %d cells has %.0f elements: a mesh holds at most 2147483647",
                   cells[0], cells[1], cells[2], elements);
  return BW_OK;
}

/* The grid of order 1 in unit coordinates. */
static bw_status unit_grid(bw_context *context, const int cells[3], int64_t *nodes, double **node,
                           int64_t *elements, int32_t **element) {
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  int64_t side[3] = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
  int64_t step[3] = {1, side[0], side[0] * side[1]};
  *nodes = side[0] * side[1] * side[2];
  *elements = 6 * (int64_t)cells[0] * cells[1] * cells[2];
  double *x = *node = BW_NEW(context, double, 3 * *nodes);
  int32_t *e = *element = BW_NEW(context, int32_t, 4 * *elements);
  if (!x || !e)
    return BW_MEMORY;
  for (int64_t c = 0; c < side[2]; c++)
    for (int64_t b = 0; b < side[1]; b++)
      for (int64_t a = 0; a < side[0]; a++) {
        *x++ = (double)a / cells[0];
        *x++ = (double)b / cells[1];
        *x++ = (double)c / cells[2];
      }
  for (int64_t c = 0; c < cells[2]; c++)
    for (int64_t b = 0; b < cells[1]; b++)
      for (int64_t a = 0; a < cells[0]; a++)
        for (int k = 0; k < 6; k++, e += 4) {
          int64_t at = a * step[0] + b * step[1] + c * step[2];
          e[0] = (int32_t)at;
          for (int i = 0; i < 3; i++)
            e[1 + i] = (int32_t)(at += step[path[k][i]]);
          if (k >= 3) { /* the odd orders of directions run the other way round */
            int32_t kept = e[1];
            e[1] = e[2];
            e[2] = kept;
          }
        }
  return BW_OK;
}

bw_status bw_mesh_mapped_box(bw_context *context, const int cells[3], int order,
                             void (*map)(void *data, const double unit[3], double out[3]),
                             void *data, bw_mesh **mesh) {
  bw_status status = check_cells(context, cells);
  if (status != BW_OK)
    return status;
  if (order != 1 && order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a mesh of tetrahedra has order 1 or 2", order);
  int64_t nodes, elements;
  double *node = NULL;
  int32_t *element = NULL;
  bw_mesh *straight = NULL, *wide = NULL;
  BW_TRY(unit_grid(context, cells, &nodes, &node, &elements, &element));
  if (order == 2) { /* mid-edge nodes are made in the unit box and mapped like the corners */
    BW_TRY(bw_mesh_adopt(context, 1, nodes, node, elements, element, NULL, &straight));
    node = NULL;
    element = NULL;
    BW_TRY(bw_mesh_with_order(context, straight, 2, &wide));
    bw_release(straight);
    straight = NULL;
    nodes = wide->node_count;
    node = BW_NEW(context, double, 3 * nodes);
    BW_TRY_MEMORY(node);
  }
  const double *unit = order == 2 ? wide->node : node;
  for (int64_t i = 0; i < nodes; i++) {
    double from[3] = {unit[3 * i], unit[3 * i + 1], unit[3 * i + 2]};
    map(data, from, node + 3 * i);
  }
  BW_TRY(bw_check_cancel(context));
  if (order == 2) {
    BW_TRY(bw_mesh_copy(context, 2, nodes, node, elements, wide->element, NULL, mesh));
  } else {
    BW_TRY(bw_mesh_adopt(context, 1, nodes, node, elements, element, NULL, mesh));
    node = NULL;
    element = NULL;
  }
done:
  bw_free(node);
  bw_free(element);
  bw_release(straight);
  bw_release(wide);
  return status;
}

typedef struct box {
  const double *min, *max;
} box;

static void map_to_box(void *data, const double unit[3], double out[3]) {
  const box *to = data;
  for (int k = 0; k < 3; k++)
    out[k] = (1 - unit[k]) * to->min[k] + unit[k] * to->max[k];
}

/* The sides of the box have the names of those of bw_surface_box_shape. */
static bw_status name_sides(bw_context *context, const box *of, bw_mesh *mesh) {
  static const bw_name name[6] = {{"left"}, {"right"}, {"front"}, {"back"}, {"bottom"}, {"top"}};
  bw_status status = BW_OK;
  bw_face_names *names = NULL;
  int32_t *group = BW_NEW0(context, int32_t, mesh->facet_count);
  BW_TRY_MEMORY(group);
  BW_TRY(bw_face_names_create(context, 6, name, NULL, &names));
  for (int32_t t = 0; t < mesh->facet_count; t++) {
    const int32_t *corner = mesh->facet + (size_t)mesh->nodes_per_facet * (size_t)t;
    for (int i = 0; i < 6; i++) { /* points of a side have its coordinate to the last bit */
      const int axis = i / 2;
      const double side = i % 2 ? of->max[axis] : of->min[axis];
      int on = 0;
      for (int k = 0; k < 3; k++)
        on += mesh->node[3 * (size_t)corner[k] + (size_t)axis] == side;
      if (on == 3)
        group[t] = i;
    }
  }
  bwi_mesh_adopt_groups(mesh, group, names);
  group = NULL;
done:
  bw_free(group);
  bw_release(names);
  return status;
}

bw_status bw_mesh_box_grid(bw_context *context, const double min[3], const double max[3],
                           const int cells[3], int order, bw_mesh **mesh) {
  for (int k = 0; k < 3; k++)
    if (!(max[k] > min[k]) || !isfinite(max[k] - min[k]))
      return bw_fail(
          context, BW_INVALID,
          "a box from (%g, %g, %g) to (%g, %g, %g) m: every max coordinate must be above "
          "the min one",
          min[0], min[1], min[2], max[0], max[1], max[2]);
  box to = {min, max};
  bw_mesh *made = NULL;
  bw_status status = bw_mesh_mapped_box(context, cells, order, map_to_box, &to, &made);
  if (status == BW_OK)
    status = name_sides(context, &to, made);
  if (status != BW_OK) {
    bw_release(made);
    return status;
  }
  *mesh = made;
  return BW_OK;
}
