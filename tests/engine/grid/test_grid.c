/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids: numbering, edits, boundary, what is embedded, coarse counterparts. */
#include "check.h"

#include "grid/internal.h"

/* A box with a random third of its cells void. */
static bw_grid *swiss(bw_context *context, const int32_t cells[3], uint64_t seed, bool cut) {
  int64_t count = bwi_grid_cells(cells);
  int32_t *material = (int32_t *)malloc((size_t)count * sizeof *material);
  double *fraction = (double *)malloc((size_t)count * sizeof *fraction);
  bw_random random;
  bw_random_seed(&random, seed);
  for (int64_t c = 0; c < count; c++) {
    material[c] = (int32_t)(3 * bw_random_uniform(&random));
    fraction[c] = 1 - 0.5 * bw_random_uniform(&random);
  }
  material[count / 2] = 1;
  bw_grid *grid;
  check_ok(context, bw_grid_create(context, (double[3]){0.5, -1, 2}, (double[3]){0.1, 0.2, 0.15},
                                   cells, material, cut ? fraction : NULL, &grid));
  free(material);
  free(fraction);
  return grid;
}

/* The invariants at the top of grid.c. */
static void check_grid(const bw_grid *grid) {
  int64_t cells = bwi_grid_cells(grid->cells), held = 0;
  char *used = (char *)calloc((size_t)grid->node_count, 1);
  for (int64_t c = 0; c < cells; c++)
    if (grid->at[c] >= 0) {
      assert_int_equal(grid->at[c], held);
      assert_int_equal(grid->cell[held++], c);
    }
  assert_int_equal(held, grid->element_count);
  for (int32_t e = 0; e < grid->element_count; e++) {
    int32_t place[3];
    bwi_grid_place(grid->cells, grid->cell[e], place);
    assert_true(grid->material[e] >= 1);
    for (int c = 0; c < 8; c++) {
      int32_t node = grid->element[8 * e + c];
      double at[3];
      bw_grid_position(grid, node, at);
      used[node] = 1;
      for (int d = 0; d < 3; d++)
        check_near(at[d], grid->origin[d] + grid->spacing[d] * (place[d] + (c >> d & 1)), 0);
    }
  }
  for (int32_t n = 0; n < grid->node_count; n++) {
    assert_true(used[n]);
    if (n)
      assert_true(grid->node[n] > grid->node[n - 1]);
  }
  free(used);
}

static void dof_map(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = swiss(context, (int32_t[3]){4, 5, 3}, 1, true);
  check_grid(grid);
  bw_release(grid);
  check_ok(context, bw_grid_create(context, (double[3]){0, 0, 0}, (double[3]){1, 1, 1},
                                   (int32_t[3]){4, 3, 2}, NULL, NULL, &grid));
  check_grid(grid);
  assert_int_equal(grid->element_count, 24);
  assert_int_equal(grid->node_count, 60);
  check_near(bw_grid_volume(grid), 24, 0);
  bw_release(grid);
  const double zero[3] = {0}, one[3] = {1, 1, 1};
  check_fails(
      context, BW_LIMIT, "more than 2^31",
      bw_grid_create(context, zero, one, (int32_t[3]){2000, 2000, 2000}, NULL, NULL, &grid));
  check_fails(
      context, BW_EMPTY, "all its 2 cells are void",
      bw_grid_create(context, zero, one, (int32_t[3]){2, 1, 1}, (int32_t[2]){0, 0}, NULL, &grid));
  check_fails(
      context, BW_INVALID, "cell 2 has material 1 and fraction 0",
      bw_grid_create(context, zero, one, (int32_t[3]){2, 1, 1}, NULL, (double[2]){1, 0}, &grid));
  check_fails(context, BW_INVALID, "along y",
              bw_grid_create(context, zero, (double[3]){1, NAN, 1}, (int32_t[3]){2, 1, 1}, NULL,
                             NULL, &grid));
}

static void edits(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = swiss(context, (int32_t[3]){5, 4, 6}, 2, true), *edited, *back;
  int32_t taken = grid->cell[7], cut = grid->cell[9], added = 0;
  while (grid->at[added] >= 0)
    added++;
  int32_t cell[4] = {taken, cut, added, added}, material[4] = {0, 7, 5, 2};
  check_ok(context, bw_grid_edited(context, grid, 4, cell, material, &edited));
  check_grid(edited);
  assert_int_equal(edited->element_count, grid->element_count);
  assert_false(bw_grid_same_elements(grid, edited));
  assert_int_equal(edited->at[taken], -1);
  assert_int_equal(edited->material[edited->at[added]], 2);
  check_near(edited->fraction[edited->at[added]], 1, 0);
  assert_int_equal(edited->material[edited->at[cut]], 7);
  check_near(edited->fraction[edited->at[cut]], grid->fraction[9], 0);
  int32_t undo[3] = {grid->material[7], grid->material[9], 0};
  check_ok(context, bw_grid_edited(context, edited, 3, cell, undo, &back));
  assert_true(bw_grid_same_elements(grid, back));
  assert_memory_equal(grid->node, back->node, 4 * (size_t)grid->node_count);
  assert_memory_equal(grid->material, back->material, 4 * (size_t)grid->element_count);
  bw_release(back);
  check_ok(context, bw_grid_edited(context, grid, 1, cell, undo, &back));
  assert_ptr_equal(back, grid);
  bw_release(back);
  /* materials alone: the same lists, which outlive the grid that made them */
  bw_grid *painted, *again;
  check_ok(context, bw_grid_edited(context, edited, 1, &cut, (int32_t[1]){4}, &painted));
  assert_ptr_equal(painted->element, edited->element);
  assert_true(bw_grid_same_elements(painted, edited));
  assert_int_equal(painted->material[painted->at[cut]], 4);
  assert_int_equal(edited->material[edited->at[cut]], 7);
  check_ok(context, bw_grid_edited(context, painted, 1, &cut, (int32_t[1]){5}, &again));
  assert_ptr_equal(again->lists, edited);
  bw_release(painted);
  bw_release(edited);
  check_grid(again);
  edited = again;
  /* a cell that goes and comes back in one edit */
  check_ok(context,
           bw_grid_edited(context, grid, 2, (int32_t[2]){cut, cut}, (int32_t[2]){0, 9}, &again));
  assert_true(bw_grid_same_elements(grid, again));
  bw_release(again);
  check_fails(context, BW_INVALID, "element 2 has material 0",
              bw_grid_with_materials(context, grid, (int32_t[3]){1, 0, 0}, &again));
  check_fails(context, BW_INVALID, "cells 1 to 120",
              bw_grid_edited(context, grid, 1, (int32_t[1]){120}, material, &back));
  check_fails(context, BW_INVALID, "material -1",
              bw_grid_edited(context, grid, 1, cell, (int32_t[1]){-1}, &back));
  bw_release(edited);
  bw_release(grid);
}

/* The divergence theorem, by component: the boundary of any set of cells encloses their volume. */
static void boundary(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = swiss(context, (int32_t[3]){5, 4, 6}, 3, false);
  bw_grid_face *face;
  int64_t count;
  check_ok(context, bw_grid_boundary(context, grid, &face, &count));
  double flux[3] = {0}, volume = bw_grid_volume(grid);
  for (int64_t f = 0; f < count; f++) {
    double x[4][3], a[3], b[3], n[3], middle[3] = {0}, centre[3], outwards = 0;
    int32_t place[3];
    for (int k = 0; k < 4; k++)
      bw_grid_position(grid, face[f].node[k], x[k]);
    bwi_grid_place(grid->cells, grid->cell[face[f].element], place);
    for (int d = 0; d < 3; d++) {
      a[d] = x[1][d] - x[0][d];
      b[d] = x[3][d] - x[0][d];
      for (int k = 0; k < 4; k++)
        middle[d] += x[k][d] / 4;
      centre[d] = grid->origin[d] + grid->spacing[d] * (place[d] + 0.5);
    }
    bw_cross(a, b, n);
    for (int d = 0; d < 3; d++) {
      flux[d] += middle[d] * n[d];
      outwards += n[d] * (middle[d] - centre[d]);
    }
    assert_true(outwards > 0);
    assert_true((n[face[f].side / 2] > 0) == (face[f].side % 2 == 1));
  }
  for (int d = 0; d < 3; d++)
    check_near(flux[d], volume, 1e-13);
  bw_surface *surface;
  int32_t *node;
  check_ok(context, bw_grid_surface(context, grid, &surface, &node));
  assert_int_equal(surface->triangle_count, 2 * count);
  check_near(bw_surface_volume(surface), volume, 1e-13);
  for (int32_t p = 0; p < surface->point_count; p++) {
    double at[3];
    bw_grid_position(grid, node[p], at);
    assert_memory_equal(at, surface->point + 3 * p, sizeof at);
  }
  double low[3], high[3], other[2][3];
  bw_grid_box(grid, low, high);
  bw_surface_box(surface, other[0], other[1]);
  for (int d = 0; d < 3; d++) {
    check_near(low[d], other[0][d], 1e-15);
    check_near(high[d], other[1][d], 1e-15);
  }
  bw_release(surface);
  bw_free(node);
  bw_free(face);
  bw_release(grid);
}

static double linear(const double at[3]) {
  return 3 + at[0] - 2 * at[1] + 0.5 * at[2];
}
static double trilinear(const double at[3]) {
  return linear(at) + at[0] * at[1] - at[1] * at[2] + 2 * at[0] * at[1] * at[2];
}

/* Trilinear functions come through interpolation as they are; forces keep total and moment. */
static void embedding(void **state) {
  bw_context *context = check_context(state);
  enum { POINTS = 500 };
  bw_grid *grid = swiss(context, (int32_t[3]){6, 5, 4}, 4, false);
  double *value = (double *)malloc((size_t)grid->node_count * sizeof *value);
  double *force = (double *)calloc(3 * (size_t)grid->node_count, sizeof *force);
  double point[3 * POINTS], at[POINTS], push[3 * POINTS];
  bw_random random;
  bw_random_seed(&random, 9);
  for (int32_t n = 0; n < grid->node_count; n++) {
    double x[3];
    bw_grid_position(grid, n, x);
    value[n] = trilinear(x);
  }
  for (int i = 0; i < 3 * POINTS; i++) {
    int d = i % 3;
    point[i] = grid->origin[d] +
               grid->spacing[d] * (grid->cells[d] * 1.2 * bw_random_uniform(&random) - 0.1);
    push[i] = bw_random_normal(&random);
  }
  bw_embedding *it;
  check_ok(context, bw_embedding_create(context, grid, POINTS, point, 3, &it));
  bw_embedding_values(it, 1, value, at);
  bw_embedding_add(it, 3, push, force);
  double total[3] = {0}, moment[3] = {0}, work[2] = {0};
  for (int p = 0; p < POINTS; p++) {
    double m[3];
    check_near(at[p], trilinear(point + 3 * p), 1e-12);
    bw_cross(point + 3 * p, push + 3 * p, m);
    work[0] += at[p] * push[3 * p];
    for (int d = 0; d < 3; d++) {
      total[d] += push[3 * p + d];
      moment[d] += m[d];
    }
    /* No other element is nearer. */
    double best = INFINITY, mine = 0;
    for (int32_t e = 0; e < grid->element_count; e++) {
      int32_t place[3];
      double sum = 0;
      bwi_grid_place(grid->cells, grid->cell[e], place);
      for (int d = 0; d < 3; d++) {
        double low = grid->origin[d] + grid->spacing[d] * place[d], x = point[3 * p + d];
        double out = fmax(fmax(low - x, x - low - grid->spacing[d]), 0);
        sum += out * out;
      }
      best = fmin(best, sum);
      if (e == it->element[p])
        mine = sum;
    }
    check_near(sqrt(mine), sqrt(best), 1e-12);
  }
  for (int32_t n = 0; n < grid->node_count; n++) {
    double x[3], m[3];
    bw_grid_position(grid, n, x);
    bw_cross(x, force + 3 * n, m);
    work[1] += value[n] * force[3 * n];
    for (int d = 0; d < 3; d++) {
      total[d] -= force[3 * n + d];
      moment[d] -= m[d];
    }
  }
  for (int d = 0; d < 3; d++) {
    check_near(total[d], 0, 1e-11);
    check_near(moment[d], 0, 1e-11);
  }
  check_near(work[0], work[1], 1e-11 * fabs(work[0]) + 1e-11);
  bw_release(it);
  double far[6] = {grid->origin[0], grid->origin[1], grid->origin[2], 9, 9, 9};
  check_fails(context, BW_GEOMETRY, "point 2 at (9, 9, 9)",
              bw_embedding_create(context, grid, 2, far, 1, &it));
  far[4] = 1e300;
  check_fails(context, BW_GEOMETRY, "point 2", bw_embedding_create(context, grid, 2, far, 1, &it));
  far[2] = NAN;
  check_fails(context, BW_INVALID, "point 1 has z",
              bw_embedding_create(context, grid, 2, far, 1, &it));
  free(value);
  free(force);
  bw_release(grid);
}

static void coarsening(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = swiss(context, (int32_t[3]){7, 6, 5}, 5, true);
  bw_coarsening *it;
  check_ok(context, bw_coarsening_create(context, grid, &it));
  const bw_grid *coarse = it->coarse;
  check_grid(coarse);
  assert_int_equal(coarse->cells[0], 4);
  assert_int_equal(coarse->cells[1], 3);
  assert_int_equal(coarse->cells[2], 3);
  int32_t children = 0;
  for (int32_t e = 0; e < coarse->element_count; e++) {
    int here = 0;
    for (int c = 0; c < 8; c++) {
      int32_t child = it->child[8 * e + c], a[3], b[3];
      if (child < 0)
        continue;
      here++;
      assert_int_equal(it->parent[child], e);
      bwi_grid_place(coarse->cells, coarse->cell[e], a);
      bwi_grid_place(grid->cells, grid->cell[child], b);
      for (int d = 0; d < 3; d++)
        assert_int_equal(b[d], 2 * a[d] + (c >> d & 1));
    }
    assert_true(here > 0);
    children += here;
  }
  assert_int_equal(children, grid->element_count);
  /* A trilinear function comes through; <P a, b> = <a, R b>. */
  size_t fine_nodes = (size_t)grid->node_count, coarse_nodes = (size_t)coarse->node_count;
  double *u = (double *)malloc(coarse_nodes * 24), *v = (double *)malloc(fine_nodes * 24);
  double *w = (double *)malloc(fine_nodes * 24), *r = (double *)malloc(coarse_nodes * 24);
  bw_random random;
  bw_random_seed(&random, 1);
  for (int32_t n = 0; n < coarse->node_count; n++) {
    double x[3];
    bw_grid_position(coarse, n, x);
    u[3 * n] = trilinear(x);
    u[3 * n + 1] = 0.1;
    u[3 * n + 2] = bw_random_normal(&random);
  }
  bw_coarsening_prolong(it, 3, u, v);
  for (int32_t n = 0; n < grid->node_count; n++) {
    double x[3];
    bw_grid_position(grid, n, x);
    check_near(v[3 * n], trilinear(x), 1e-13);
    check_near(v[3 * n + 1], 0.1, 0);
    for (int d = 0; d < 3; d++)
      w[3 * n + d] = bw_random_normal(&random);
  }
  bw_coarsening_restrict(it, 3, w, r);
  double left = 0, right = 0;
  for (size_t i = 0; i < 3 * fine_nodes; i++)
    left += v[i] * w[i];
  for (size_t i = 0; i < 3 * coarse_nodes; i++)
    right += u[i] * r[i];
  check_near(left, right, 1e-11);
  /* The measure of a translation is its length over the longest side. */
  double low[3], high[3];
  bw_grid_box(grid, low, high);
  for (size_t i = 0; i < 3 * fine_nodes; i++)
    w[i] = v[i] + (i % 3 == 0 ? 0.03 : i % 3 == 1 ? 0.04 : 0);
  check_near(bw_grid_difference(grid, v, w),
             0.05 / fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2])), 1e-14);
  free(u);
  free(v);
  free(w);
  free(r);
  bw_release(it);
  bw_release(grid);
}

/* Everything that allocates, as a chain that ends at the first failure. */
static bw_status chain(bw_context *context) {
  bw_status status = BW_OK;
  bw_grid *grid = NULL, *edited = NULL, *painted = NULL;
  bw_grid_face *face = NULL;
  bw_surface *surface = NULL;
  bw_embedding *embedding_of = NULL;
  bw_coarsening *coarsening_of = NULL;
  int32_t *node = NULL, cell[2] = {3, 4}, to[2] = {0, 2}, five = 5;
  int64_t faces;
  double fraction[12] = {1, 1, 1, 1, 0.5, 1, 1, 1, 1, 1, 1, 1};
  BW_TRY(bw_grid_create(context, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, (int32_t[3]){2, 2, 3},
                        NULL, fraction, &grid));
  BW_TRY(bw_grid_edited(context, grid, 2, cell, to, &edited));
  BW_TRY(bw_grid_edited(context, edited, 1, cell + 1, &five, &painted));
  BW_TRY(bw_grid_boundary(context, edited, &face, &faces));
  BW_TRY(bw_grid_surface(context, edited, &surface, &node));
  BW_TRY(
      bw_embedding_create(context, edited, surface->point_count, surface->point, 0, &embedding_of));
  BW_TRY(bw_coarsening_create(context, edited, &coarsening_of));
done:
  bw_release(grid);
  bw_release(edited);
  bw_release(painted);
  bw_free(face);
  bw_release(surface);
  bw_free(node);
  bw_release(embedding_of);
  bw_release(coarsening_of);
  return status;
}

static void failing_memory(void **state) {
  bw_context *context = check_context(state);
  check_each_allocation(context, status, 30) {
    status = chain(context);
  }
}

check_main(check_test(dof_map), check_test(edits), check_test(boundary), check_test(embedding),
           check_test(coarsening), check_test(failing_memory))
