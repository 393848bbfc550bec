/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodes and cells by geometry: counts in closed form, the same region on a coarse grid, refusals.
 */
#include "check.h"

#include "grid/internal.h"

static double near_x(void *data, const double at[3]) {
  (void)data;
  return at[0] < 0.3 ? 1 : NAN;
}

static double halves(void *data, const double at[3]) {
  return *(const double *)data * (at[2] > 1 ? 2 : 1);
}

static int32_t nodes_in(bw_context *context, const bw_grid *grid, const bw_region *region) {
  int32_t *node, count;
  check_ok(context, bw_grid_nodes(context, grid, region, &node, &count));
  for (int32_t i = 1; i < count; i++)
    assert_true(node[i] > node[i - 1]);
  assert_true(node[0] >= 0 && node[count - 1] < grid->node_count);
  bw_free(node);
  return count;
}

static int32_t cells_in(bw_context *context, const bw_grid *grid, const bw_region *region,
                        bool voids) {
  int32_t *cell, count;
  check_ok(context, bw_grid_cells(context, grid, region, voids, &cell, &count));
  bw_free(cell);
  return count;
}

/* 8 x 6 x 4 cells of 0.1 m, the cells above half the height void. */
static bw_grid *block(bw_context *context) {
  int32_t material[8 * 6 * 4];
  bw_grid *grid;
  for (int c = 0; c < 192; c++)
    material[c] = c < 96;
  check_ok(context, bw_grid_create(context, (double[3]){0, 0, 0}, (double[3]){0.1, 0.1, 0.1},
                                   (int32_t[3]){8, 6, 4}, material, NULL, &grid));
  return grid;
}

static void shapes(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = block(context);
  bw_region r = {0};
  assert_int_equal(nodes_in(context, grid, &r), 9 * 7 * 3);
  assert_int_equal(cells_in(context, grid, &r, false), 96);
  assert_int_equal(cells_in(context, grid, &r, true), 192);
  r = (bw_region){.parts = BW_IN_BOX, .min = {0.1, 0.2, 0}, .max = {0.3, 0.4, 9}};
  assert_int_equal(nodes_in(context, grid, &r), 3 * 3 * 3);
  assert_int_equal(cells_in(context, grid, &r, false), 2 * 2 * 2);
  assert_int_equal(cells_in(context, grid, &r, true), 2 * 2 * 4);
  r = (bw_region){.parts = BW_IN_BALL, .centre = {0.4, 0.3, 0.1}, .radius = 0.1};
  assert_int_equal(nodes_in(context, grid, &r), 7);
  r.within = 0.05; /* now the twelve at a diagonal of 0.1414 too */
  assert_int_equal(nodes_in(context, grid, &r), 19);
  r = (bw_region){.parts = BW_ON_PLANE, .plane_point = {0, 0.3, 0}, .plane_normal = {0, -2, 0}};
  assert_int_equal(nodes_in(context, grid, &r), 9 * 3);
  r = (bw_region){.parts = BW_BEYOND, .beyond_point = {0.5, 0, 0}, .beyond_normal = {3, 0, 0}};
  assert_int_equal(nodes_in(context, grid, &r), 4 * 7 * 3);
  assert_int_equal(cells_in(context, grid, &r, false), 3 * 6 * 2);
  r.parts |= BW_ON_SIDE; /* the elements' top, not the lattice's */
  r.side = 5;
  assert_int_equal(nodes_in(context, grid, &r), 4 * 7);
  assert_int_equal(cells_in(context, grid, &r, false), 3 * 6);
  r = (bw_region){.parts = BW_ON_BOUNDARY};
  assert_int_equal(nodes_in(context, grid, &r), 9 * 7 * 3 - 7 * 5);
  r = (bw_region){.parts = BW_WHERE, .where = near_x};
  assert_int_equal(nodes_in(context, grid, &r), 3 * 7 * 3);
  bw_surface *inner;
  check_ok(context, bw_surface_box_shape(context, (double[3]){0.16, 0.16, -1},
                                         (double[3]){0.36, 0.36, 1}, &inner));
  r = (bw_region){.parts = BW_IN_SURFACE, .surface = inner};
  assert_int_equal(nodes_in(context, grid, &r), 2 * 2 * 3);
  assert_int_equal(cells_in(context, grid, &r, true), 3 * 4); /* 1, 0.6, 0.6, not 0.36 */
  bw_release(inner);
  bw_release(grid);
}

/* A region means the same places on the coarse grid of a body. */
static void coarse_alike(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = block(context);
  bw_coarsening *it;
  check_ok(context, bw_coarsening_create(context, grid, &it));
  for (int side = 0; side < 6; side++) {
    bw_region r = {.parts = BW_ON_SIDE, .side = side};
    int32_t *node[2], count[2];
    double at[2][3];
    const bw_grid *both[2] = {grid, it->coarse};
    for (int i = 0; i < 2; i++) {
      check_ok(context, bw_grid_nodes(context, both[i], &r, &node[i], &count[i]));
      bw_grid_position(both[i], node[i][0], at[i]);
      bw_free(node[i]);
    }
    check_near(at[0][side / 2], at[1][side / 2], 1e-15);
    assert_true(count[0] > count[1]);
  }
  bw_release(it);
  bw_release(grid);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = block(context);
  int32_t *node, count;
  bw_region r = {.parts = BW_IN_BOX, .min = {0.41, 0.21, 0.05}, .max = {0.43, 0.22, 0.05}};
  check_fails(context, BW_EMPTY, "nearest node is at (0.4, 0.2, ",
              bw_grid_nodes(context, grid, &r, &node, &count));
  assert_non_null(strstr(bw_message(context), "between (0, 0, 0) and (0.8, 0.6, 0.2) m"));
  r.min[0] = 1;
  check_fails(context, BW_INVALID, "from 1 to 0.43 m along x",
              bw_grid_nodes(context, grid, &r, &node, &count));
  r = (bw_region){.parts = BW_ON_PLANE};
  check_fails(context, BW_INVALID, "a finite vector that is not 0",
              bw_grid_cells(context, grid, &r, false, &node, &count));
  int32_t material[192];
  double one = 1, half = 1.5;
  check_ok(context, bw_cell_materials(context, grid->origin, (double[3]){1, 1, 1}, grid->cells, 192,
                                      NULL, halves, &one, material));
  for (int c = 0; c < 192; c++)
    assert_int_equal(material[c], c < 48 ? 1 : 2);
  check_fails(context, BW_INVALID, "at (0.5, 0.5, 0.5) m is 1.5",
              bw_cell_materials(context, grid->origin, (double[3]){1, 1, 1}, grid->cells, 192, NULL,
                                halves, &half, material));
  /* memory */
  bw_surface *inner;
  check_ok(context, bw_surface_box_shape(context, (double[3]){0.16, 0.16, -1},
                                         (double[3]){0.36, 0.36, 1}, &inner));
  r = (bw_region){.parts = BW_IN_SURFACE | BW_ON_BOUNDARY, .surface = inner};
  nodes_in(context, grid, &r);
  check_each_allocation(context, status, 1) {
    node = NULL;
    status = bw_grid_nodes(context, grid, &r, &node, &count);
    bw_free(node);
  }
  bw_release(inner);
  bw_release(grid);
}

check_main(check_test(shapes), check_test(coarse_alike), check_test(refusals))
