/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solids: their pattern serves the engine's own factor; mass; what is refused. */
#include "linear/internal.h"
#include "nonlinear/solids.h"

static bw_solid *block(bw_context *context, const int32_t cells[3], bw_law law) {
  bw_solid_material *one = solids_simple(context, law);
  return solids_create(context, cells, 1, &one, NULL, NULL);
}

/* K x = b through order, symbolic and factor, for a block of which one end is constrained. */
static void test_factor(void **state) {
  bw_context *context = check_context(state);
  bw_solid *solid = block(context, (const int32_t[3]){5, 3, 2}, BW_COROTATED);
  const bw_grid *grid = solid->grid;
  bw_block_pattern *pattern = solid->pattern;
  int64_t n = grid->node_count, unknowns = 0;
  double *u = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *x = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *b = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *values = (double *)calloc((size_t)(9 * pattern->block_count), sizeof *u);
  int32_t *unknown = (int32_t *)calloc((size_t)(3 * n), sizeof *unknown);
  double energy;
  bw_solid_shape shape;
  check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, NULL, values, &shape));
  for (int32_t i = 0; i < n; i++) {
    double at[3];
    bw_grid_position(grid, i, at);
    for (int k = 0; k < 3; k++) {
      unknown[3 * i + k] = at[0] > grid->origin[0] + 1e-9 ? (int32_t)unknowns++ : -1;
      x[3 * i + k] = unknown[3 * i + k] >= 0 ? sin(1.0 + 7 * i + k) : 0;
    }
  }
  check_ok(context, bw_block_multiply(context, pattern, values, 9, 3, 1, x, b));
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  bwi_matrix matrix = {.pattern = pattern, .stiffness = values};
  check_ok(context, bwi_order_create(context, pattern, NULL, &order));
  check_ok(context, bwi_symbolic_create(context, order, 3, unknown, &symbolic));
  check_ok(context, bwi_factor_create(context, symbolic, &matrix, &factor, NULL));
  double *r = (double *)calloc((size_t)unknowns, sizeof *r);
  for (int64_t k = 0; k < 3 * n; k++)
    if (unknown[k] >= 0)
      r[symbolic->at[k]] = b[k];
  check_ok(context, bwi_factor_solve(context, factor, 1, r));
  for (int64_t k = 0; k < 3 * n; k++)
    if (unknown[k] >= 0)
      check_near(r[symbolic->at[k]], x[k], 1e-9);
  free(r);
  bw_release(factor);
  bw_release(symbolic);
  bw_release(order);
  free(u);
  free(x);
  free(b);
  free(values);
  free(unknown);
  bw_release(solid);
}

/* Mass: density times volume, parts of cells by their fraction, an eighth to every corner. */
static void test_mass(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 1, 1}, material[2] = {1, 2};
  const double fraction[2] = {0.5, 1e-9}, volume = 0.1 * 0.2 * 0.15;
  bw_solid_material *both[2] = {solids_simple(context, BW_COROTATED),
                                solids_mixed(context, BW_COROTATED, 1, 0, 1)};
  bw_solid *solid = solids_create(context, cells, 2, both, material, fraction);
  double sum = 0;
  for (int i = 0; i < 12; i++)
    sum += solid->mass[i];
  check_near(solid->mass[0], 1000 * 0.5 * volume / 8, 1e-15);
  check_near(solid->mass[2], 800 * 1e-3 * volume / 8, 1e-15); /* never below a thousandth */
  check_near(sum, (1000 * 0.5 + 800 * 1e-3) * volume, 1e-14);
  assert_false(solid->weightless);
  assert_null(solid->pattern->mesh);
  assert_true(bw_bytes(solid) >= sizeof *solid + 12 * sizeof(double));
  bw_release(solid);
}

/* The pattern of the same elements serves another solid; of other elements not. */
static void test_previous(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 2, 1}, other[4] = {1, 1, 1, 0};
  bw_solid *first = block(context, cells, BW_COROTATED), *second = NULL;
  bw_grid *grid = NULL;
  check_ok(context, bw_solid_create(context, first->grid, first->material_table, first, &second));
  assert_true(second->pattern == first->pattern);
  bw_release(second);
  check_ok(context, bw_grid_create(context, first->grid->origin, first->grid->spacing, cells, other,
                                   NULL, &grid));
  check_ok(context, bw_solid_create(context, grid, first->material_table, first, &second));
  assert_true(second->pattern != first->pattern);
  bw_release(second);
  bw_release(grid);
  bw_release(first);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {2, 1, 1}, material[2] = {1, 3};
  bw_solid *first = block(context, cells, BW_COROTATED), *second = NULL;
  bw_grid *grid = NULL;
  check_ok(context, bw_grid_create(context, first->grid->origin, first->grid->spacing, cells,
                                   material, NULL, &grid));
  check_fails(context, BW_INVALID, "element 2 (cell 2) is of material 3",
              bw_solid_create(context, grid, first->material_table, NULL, &second));
  assert_null(second);
  /* a pattern of element lists is no mesh's */
  bw_mesh *mesh = NULL;
  double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, values[1];
  const int three[3] = {1, 1, 1};
  check_ok(context, bw_mesh_box_grid(context, low, high, three, 1, &mesh));
  check_fails(context, BW_INVALID, "element lists",
              bw_laplacian(context, first->pattern, mesh, values));
  bw_release(mesh);
  bw_release(grid);
  bw_release(first);
}

check_main(check_test(test_factor), check_test(test_mass), check_test(test_previous),
           check_test(test_refused))
