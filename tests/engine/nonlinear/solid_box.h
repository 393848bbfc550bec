/* Boxes of elements for tests of equilibrium. */
#ifndef SOLID_BOX_H
#define SOLID_BOX_H

#include "../check.h"

typedef struct box {
  bw_grid *grid;
  bw_material_table *material_table;
  bw_solid *solid;
  bw_load_case *load_case;
  double size[3];
} box;

static inline void box_make(bw_context *context, box *b, const int32_t cells[3],
                            const double size[3], bw_law law, double young, double poisson,
                            double density) {
  double origin[3] = {0, 0, 0}, spacing[3];
  bw_solid_material *material;
  for (int d = 0; d < 3; d++) {
    b->size[d] = size[d];
    spacing[d] = size[d] / cells[d];
  }
  check_ok(context, bw_grid_create(context, origin, spacing, cells, NULL, NULL, &b->grid));
  check_ok(context, bw_solid_material_create(context, "", law, young, poisson, density, &material));
  const bw_solid_material *one = material;
  check_ok(context, bw_material_table_create(context, 2, &one, &b->material_table));
  check_ok(context, bw_solid_create(context, b->grid, b->material_table, NULL, &b->solid));
  check_ok(context, bw_load_case_create(context, b->grid, &b->load_case));
  bw_release(material);
}

static inline void box_free(box *b) {
  bw_release(b->load_case);
  bw_release(b->solid);
  bw_release(b->material_table);
  bw_release(b->grid);
}

/* Nodes at low (0) or high (1) end of an axis, into `node` (room for all). */
static inline int64_t box_end(const box *b, int axis, int high, int32_t *node) {
  int64_t count = 0;
  for (int32_t n = 0; n < b->grid->node_count; n++) {
    double x[3];
    bw_grid_position(b->grid, n, x);
    if (fabs(x[axis] - (high ? b->size[axis] : 0)) < 1e-9 * b->size[axis])
      node[count++] = n;
  }
  return count;
}

static inline void box_hold(bw_context *context, box *b, int axis, int high, bool x, bool y, bool z,
                            double value) {
  int32_t *node = malloc(sizeof *node * (size_t)b->grid->node_count);
  int64_t count = box_end(b, axis, high, node);
  bool fixed[3] = {x, y, z};
  double values[3] = {0, 0, 0};
  values[axis] = fixed[axis] ? value : 0;
  check_ok(context, bw_load_case_fix(context, b->load_case, count, node, fixed, values));
  free(node);
}

static inline void box_force(bw_context *context, box *b, int axis, int high, double x, double y,
                             double z) {
  int32_t *node = malloc(sizeof *node * (size_t)b->grid->node_count);
  int64_t count = box_end(b, axis, high, node);
  double total[3] = {x, y, z};
  check_ok(context, bw_load_case_force(context, b->load_case, count, node, total));
  free(node);
}

static inline double box_mean(const box *b, const double *field, int axis, int high,
                              int component) {
  int32_t *node = malloc(sizeof *node * (size_t)b->grid->node_count);
  int64_t count = box_end(b, axis, high, node);
  double sum = 0;
  for (int64_t k = 0; k < count; k++)
    sum += field[3 * (int64_t)node[k] + component];
  free(node);
  return sum / (double)count;
}

static inline double box_sum(const box *b, const double *field, int axis, int high, int component) {
  int32_t *node = malloc(sizeof *node * (size_t)b->grid->node_count);
  int64_t count = box_end(b, axis, high, node);
  double sum = 0;
  for (int64_t k = 0; k < count; k++)
    sum += field[3 * (int64_t)node[k] + component];
  free(node);
  return sum;
}

/* Symmetry planes at the low ends of the three axes. */
static inline void box_symmetric(bw_context *context, box *b) {
  box_hold(context, b, 0, 0, true, false, false, 0);
  box_hold(context, b, 1, 0, false, true, false, 0);
  box_hold(context, b, 2, 0, false, false, true, 0);
}

#endif
