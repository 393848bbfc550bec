/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solids: their graph serves the engine's own factor; mass; what is refused. */
#include "check.h"
#include "solve/internal.h"

static bw_palette *palette_of(bw_context *context, bw_law law, double density) {
  bw_solid_material *material = NULL;
  bw_palette *palette = NULL;
  check_ok(context, bw_solid_material_create(context, "it", law, 1e6, 0.3, density, &material));
  check_ok(context,
           bw_palette_create(context, 2, (const bw_solid_material *const *)&material, &palette));
  bw_release(material);
  return palette;
}

static bw_solid *solid_of(bw_context *context, const int32_t cells[3], bw_law law) {
  double origin[3] = {0, 0, 0}, spacing[3] = {0.1, 0.2, 0.15};
  bw_grid *grid = NULL;
  bw_solid *solid = NULL;
  bw_palette *palette = palette_of(context, law, 1000);
  check_ok(context, bw_grid_create(context, origin, spacing, cells, NULL, NULL, &grid));
  check_ok(context, bw_solid_create(context, grid, palette, NULL, &solid));
  bw_release(grid);
  bw_release(palette);
  return solid;
}

/* K x = b through order, symbolic and factor, for a block of which one end is held. */
static void test_factor(void **state) {
  bw_context *context = check_context(state);
  bw_solid *solid = solid_of(context, (const int32_t[3]){5, 3, 2}, BW_COROTATED);
  const bw_grid *grid = solid->grid;
  bw_graph *graph = solid->graph;
  int64_t n = grid->node_count, unknowns = 0;
  double *u = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *x = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *b = (double *)calloc((size_t)(3 * n), sizeof *u);
  double *values = (double *)calloc((size_t)(9 * graph->pair_count), sizeof *u);
  int32_t *unknown = (int32_t *)calloc((size_t)(3 * n), sizeof *unknown);
  double energy;
  bw_solid_shape shape;
  check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, NULL, values, &shape));
  for (int32_t i = 0; i < n; i++) {
    double at[3];
    bw_grid_position(grid, i, at);
    for (int k = 0; k < 3; k++) {
      unknown[3 * i + k] = at[0] > 1e-9 ? (int32_t)unknowns++ : -1;
      x[3 * i + k] = unknown[3 * i + k] >= 0 ? sin(1.0 + 7 * i + k) : 0;
    }
  }
  check_ok(context, bw_graph_multiply(context, graph, values, 9, 3, 1, x, b));
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  bwi_matrix matrix = {.graph = graph, .stiffness = values};
  check_ok(context, bwi_order_create(context, graph, NULL, &order));
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

int main(void) {
  const struct CMUnitTest tests[] = {check_test(test_factor)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
