/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Seconds of a Newton iteration: bench_statics NX NY NZ [direct|jacobi|coarse] [iterations]
 *
 * A neo-Hookean block of cubes, one end fixed, the other pulled sideways. Processor time is that of
 * all threads, which on a machine with other work says more than what a clock shows. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "bench/bench.h"

int main(int count, char **word) {
  if (count < 4) {
    fprintf(stderr, "%s NX NY NZ [direct|jacobi|coarse] [iterations]\n", word[0]);
    return 2;
  }
  const int32_t cells[3] = {atoi(word[1]), atoi(word[2]), atoi(word[3])};
  const char *way = count > 4 ? word[4] : "direct";
  const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
  int axis = cells[0] > cells[1] ? 0 : 1;
  bw_context *context = bw_context_create();
  bw_grid *grid;
  bw_solid_material *material;
  bw_material_table *material_table;
  bw_solid *solid, *small = NULL;
  bw_load_case *load_case;
  bw_coarse *coarse = NULL;
  bw_newton_options options;
  bw_solid_static *result = NULL;
  OK(bw_grid_create(context, origin, spacing, cells, NULL, NULL, &grid));
  OK(bw_solid_material_create(context, "", BW_NEO_HOOKEAN, 1e6, 0.4, 1000, &material));
  const bw_solid_material *one = material;
  OK(bw_material_table_create(context, 2, &one, &material_table));
  OK(bw_solid_create(context, grid, material_table, NULL, &solid));
  OK(bw_load_case_create(context, grid, &load_case));
  int32_t *node = BW_NEW(context, int32_t, grid->node_count);
  for (int high = 0; node && high < 2; high++) {
    int64_t nodes = 0;
    for (int32_t n = 0; n < grid->node_count; n++) {
      double x[3];
      bw_grid_position(grid, n, x);
      if (x[axis] == high * cells[axis])
        node[nodes++] = n;
    }
    bool all[3] = {true, true, true};
    double area = (double)cells[0] * cells[1] * cells[2] / cells[axis];
    double force[3] = {0, 0, 1e4 * area * cells[2] / cells[axis]};
    if (high)
      OK(bw_load_case_force(context, load_case, nodes, node, force));
    else
      OK(bw_load_case_fix(context, load_case, nodes, node, all, NULL));
  }
  bw_newton_options_default(&options);
  const bw_solver direct = {.options = {.kind = BW_SOLVER_CHOLESKY}},
                  blocks = {.options = {.kind = BW_SOLVER_JACOBI}},
                  jacobi = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &blocks}},
                  two_level = {.options = {.kind = BW_SOLVER_PCG}};
  options.solver = strcmp(way, "direct") == 0   ? &direct
                   : strcmp(way, "jacobi") == 0 ? &jacobi
                                                : &two_level;
  if (count > 5) {
    options.iterations = atoi(word[5]);
    options.min_step = 1;
  }
  OK(bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, 1, &coarse));
  OK(bw_solid_create(context, coarse->grid, coarse->material_table, NULL, &small));
  const bw_coarsening *coarsening = coarse->coarsening[0];
  const bw_solid *of_coarse = small;
  options.coarse_count = 1;
  options.coarsening = &coarsening;
  options.coarse = &of_coarse;
  double before = processor_seconds();
  if (bw_solid_statics(context, solid, load_case, NULL, &options, &result) != BW_OK)
    fprintf(stderr, "%s\n", bw_message(context));
  if (!result)
    return 1;
  const bw_newton_report *r = &result->newton;
  double per = r->iterations > 0 ? r->iterations : 1, used = processor_seconds() - before;
  printf("{\"way\": \"%s\", \"cells\": [%d, %d, %d], \"iterations\": %d, \"cg\": %lld, "
         "\"factorisations\": %d, \"seconds_iteration\": %.4f, \"processor_iteration\": %.4f, "
         "\"seconds_quadrature\": %.3f, \"seconds_analysis\": %.3f, \"seconds_factor\": %.3f, "
         "\"seconds_solve\": %.3f}\n",
         way, (int)cells[0], (int)cells[1], (int)cells[2], r->iterations,
         (long long)r->cg_iterations, r->factorisations, r->seconds / per, used / per,
         r->seconds_quadrature, r->seconds_analysis, r->seconds_factor, r->seconds_solve);
  bw_release(result);
  bw_release(small);
  bw_release(coarse);
  bw_release(load_case);
  bw_release(solid);
  bw_release(material_table);
  bw_release(material);
  bw_release(grid);
  bw_free(node);
  bw_context_destroy(context);
  return 0;
}
