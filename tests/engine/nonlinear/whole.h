/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Whole solids for the tests of statics and motion: boxes of one material, and their sides. */
#ifndef TESTS_WHOLE_H
#define TESTS_WHOLE_H

#include "check.h"

typedef struct body {
  bw_grid *grid;
  bw_material_table *material_table;
  bw_solid *solid;
  int32_t nodes;
} body;

/* A grid of one material becomes a body; the grid goes with it. */
static inline body body_of(bw_context *context, bw_grid *grid, bw_law law, double young,
                           double poisson, double density) {
  body b = {.grid = grid, .nodes = grid->node_count};
  bw_solid_material *material;
  check_ok(context,
           bw_solid_material_create(context, "it", law, young, poisson, density, &material));
  check_ok(context,
           bw_material_table_create(context, 2, (const bw_solid_material *const[]){material},
                                    &b.material_table));
  check_ok(context, bw_solid_create(context, b.grid, b.material_table, NULL, &b.solid));
  bw_release(material);
  return b;
}

/* A box from the origin. */
static inline body body_box(bw_context *context, int x, int y, int z, double lx, double ly,
                            double lz, bw_law law, double young, double poisson, double density) {
  const double origin[3] = {0, 0, 0}, spacing[3] = {lx / x, ly / y, lz / z};
  const int32_t cells[3] = {x, y, z};
  bw_grid *grid;
  check_ok(context, bw_grid_create(context, origin, spacing, cells, NULL, NULL, &grid));
  return body_of(context, grid, law, young, poisson, density);
}

/* The same body in the B-bar formulation. */
static inline void body_take_b_bar(bw_context *context, body *b, bw_law law, double young,
                                   double poisson) {
  bw_solid_material *material;
  bw_release(b->solid);
  bw_release(b->material_table);
  check_ok(context, bw_solid_material_b_bar(context, "it", law, young, poisson, 0, &material));
  check_ok(context,
           bw_material_table_create(context, 2, (const bw_solid_material *const[]){material},
                                    &b->material_table));
  check_ok(context, bw_solid_create(context, b->grid, b->material_table, NULL, &b->solid));
  bw_release(material);
}

static inline void body_release(body *b) {
  bw_release(b->solid);
  bw_release(b->material_table);
  bw_release(b->grid);
}

/* The nodes with a coordinate near `at`; release with bw_free. */
static inline int32_t *nodes_at(bw_context *context, const bw_grid *grid, int axis, double at,
                                int64_t *count) {
  int32_t *node = BW_NEW(context, int32_t, grid->node_count);
  assert_non_null(node);
  *count = 0;
  for (int32_t i = 0; i < grid->node_count; i++) {
    double x[3];
    bw_grid_position(grid, i, x);
    if (fabs(x[axis] - at) < 1e-6 * grid->spacing[axis])
      node[(*count)++] = i;
  }
  assert_true(*count > 0);
  return node;
}

static inline int32_t node_near(const bw_grid *grid, double x, double y, double z) {
  int32_t best = -1;
  double min = INFINITY;
  for (int32_t i = 0; i < grid->node_count; i++) {
    double at[3], way[3];
    bw_grid_position(grid, i, at);
    way[0] = at[0] - x, way[1] = at[1] - y, way[2] = at[2] - z;
    if (bw_norm(way) < min) {
      min = bw_norm(way);
      best = i;
    }
  }
  return best;
}

/* Hold components of a side: bits 1, 2, 4 for x, y, z. */
static inline void hold_side(bw_context *context, bw_load_case *load_case, int axis, double at,
                             int bits, double vx, double vy, double vz) {
  int64_t count;
  int32_t *node = nodes_at(context, load_case->grid, axis, at, &count);
  const bool fixed[3] = {bits & 1, (bits & 2) != 0, (bits & 4) != 0};
  const double value[3] = {vx, vy, vz};
  check_ok(context, bw_load_case_fix(context, load_case, count, node, fixed, value));
  bw_free(node);
}

static inline void push_side(bw_context *context, bw_load_case *load_case, int axis, double at,
                             double fx, double fy, double fz) {
  int64_t count;
  int32_t *node = nodes_at(context, load_case->grid, axis, at, &count);
  const double total[3] = {fx, fy, fz};
  check_ok(context, bw_load_case_force(context, load_case, count, node, total));
  bw_free(node);
}

/* A case whose load factor is 1 in one step, to a tight tolerance. */
static inline bw_solid_static *solve(bw_context *context, const body *b,
                                     const bw_load_case *load_case, int steps) {
  bw_newton_options options;
  bw_solid_static *result = NULL;
  bw_newton_options_default(&options);
  options.tolerance = 1e-10;
  options.steps = steps;
  check_ok(context, bw_solid_statics(context, b->solid, load_case, NULL, &options, &result));
  assert_true(result->complete);
  return result;
}

/* The sum of what supports and contact planes carry on a side. */
static inline void side_reaction(bw_context *context, const bw_solid_static *result, int axis,
                                 double at, double sum[3]) {
  int64_t count;
  int32_t *node = nodes_at(context, result->solid->grid, axis, at, &count);
  sum[0] = sum[1] = sum[2] = 0;
  for (int64_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++)
      sum[c] += result->reaction[3 * (int64_t)node[k] + c];
  bw_free(node);
}

#endif
