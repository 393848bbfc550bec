/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coarsening 100,000 fine elements by lookup, and following an edit, beside the same without a
 * library. Three grids: helical fibres in a matrix (few different blocks), a body with void and cut
 * cells, and random materials in every cell (as many different blocks as there can be).
 *   build/tests/bench_coarsen library.bwm      a library of three materials (or other), with
 * void */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"

enum { X = 50, Y = 50, Z = 40, CELLS = X * Y * Z, REPEATS = 9 };

static double cpu(void) {
  return (double)clock() / CLOCKS_PER_SEC;
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static int32_t material_at(int kind, int count, int i, int j, int k, bw_random *random) {
  if (kind == 2)
    return 1 + (int32_t)(bw_random_bits(random) % (uint64_t)count);
  double x = i + 0.5 - X / 2.0, y = j + 0.5 - Y / 2.0, a = atan2(y, x) - 0.1 * k, r = hypot(x, y);
  if (kind == 1 && r > X / 2.0)
    return 0;
  return count > 1 && fabs(r - 15) < 4 && cos(3 * a) > 0.7 ? count : 1;
}

static void run(bw_context *context, const bw_library *library, int kind) {
  static const char *const name[] = {"helices", "cylinder", "random"};
  static int32_t material[CELLS];
  static double fraction[CELLS];
  const double origin[3] = {0, 0, 0}, spacing[3] = {0.01, 0.01, 0.01};
  const int32_t cells[3] = {X, Y, Z};
  int count = library->material_table->count - 1;
  bw_random random;
  bw_random_seed(&random, 1);
  for (int c = 0; c < CELLS; c++) {
    int i = c % X, j = c / X % Y, k = c / X / Y;
    double r = hypot(i + 0.5 - X / 2.0, j + 0.5 - Y / 2.0);
    material[c] = material_at(kind, count, i, j, k, &random);
    fraction[c] = r > X / 2.0 - 0.7 ? 0.5 : 1;
  }
  bw_grid *grid, *edited;
  OK(bw_grid_create(context, origin, spacing, cells, material, kind == 1 ? fraction : NULL, &grid));
  for (int c = 0; c < 100; c++) /* a box of 5 x 5 x 4 cells */
    material[37 + c % 5 + X * (25 + c / 5 % 5 + Y * (20 + c / 25))] = count > 1 ? 2 : 1;
  OK(bw_grid_create(context, origin, spacing, cells, material, kind == 1 ? fraction : NULL,
                    &edited));
  for (int levels = 1; levels <= library->levels; levels++) {
    double whole[REPEATS], lookup[REPEATS], follow[REPEATS], naive[REPEATS];
    int rows = 0;
    long long touched = 0;
    for (int n = 0; n < REPEATS; n++) {
      bw_coarse *coarse, *next, *plain;
      double start = cpu();
      OK(bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, grid, levels,
                    &coarse));
      whole[n] = cpu() - start;
      lookup[n] = coarse->seconds_lookup;
      start = cpu();
      OK(bw_coarse_follow(context, coarse, edited, &next));
      follow[n] = cpu() - start;
      start = cpu();
      OK(bw_coarsen(context, BW_COARSE_NAIVE, NULL, library->material_table, grid, levels, &plain));
      naive[n] = cpu() - start;
      rows = (int)coarse->material_table->count - 1;
      touched = (long long)next->looked_up;
      bw_release(coarse);
      bw_release(next);
      bw_release(plain);
    }
    qsort(whole, REPEATS, sizeof *whole, by_value);
    qsort(lookup, REPEATS, sizeof *lookup, by_value);
    qsort(follow, REPEATS, sizeof *follow, by_value);
    qsort(naive, REPEATS, sizeof *naive, by_value);
    printf("{\"grid\": \"%s\", \"elements\": %d, \"levels\": %d, \"materials\": %d, "
           "\"coarsen_ms\": %.2f, \"lookup_ms\": %.2f, \"follow_ms\": %.2f, \"touched\": %lld, "
           "\"naive_ms\": %.2f}\n",
           name[kind], (int)grid->element_count, levels, rows, 1e3 * whole[REPEATS / 2],
           1e3 * lookup[REPEATS / 2], 1e3 * follow[REPEATS / 2], touched, 1e3 * naive[REPEATS / 2]);
  }
  bw_release(grid);
  bw_release(edited);
}

int main(int arguments, char **argument) {
  bw_context *context = bw_context_create();
  bw_library *library;
  if (!context || arguments != 2) {
    fprintf(stderr, "usage: bench_coarsen library.bwm\n");
    return 1;
  }
  OK(bw_library_read(context, argument[1], &library));
  for (int kind = 0; kind < 3; kind++)
    run(context, library, kind);
  bw_release(library);
  bw_context_destroy(context);
  return 0;
}
