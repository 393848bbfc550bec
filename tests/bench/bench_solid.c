/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Microseconds per element of energies, gradients and second derivatives of solids;
 * built with the tests, run by hand: build/tests/bench_solid [cells x] [y] [z] [threads] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "nonlinear/internal.h"

enum { REPEATS = 4 };

static bw_solid_material *material_of(bw_context *context, bw_law law, int level, int fibres) {
  bw_rule *rule = NULL;
  bw_solid_material *material = NULL;
  OK(bw_rule_create(context, level, &rule));
  uint8_t laws[64];
  double mu[64], lambda[64], stiffness[192], v[576] = {0};
  for (int q = 0; q < rule->count; q++) {
    laws[q] = (uint8_t)law;
    mu[q] = 4e5 * (1 + 0.1 * (q % 5));
    lambda[q] = 6e5;
    for (int k = 0; k < fibres; k++) {
      stiffness[q * fibres + k] = 1e5;
      v[3 * (q * fibres + k) + k] = 1;
    }
  }
  OK(bw_solid_material_points(context, "it", rule, 1000, laws, mu, lambda, fibres, stiffness, v,
                              &material));
  bw_release(rule);
  return material;
}

int main(int count, char **argument) {
  int32_t cells[3] = {16, 25, 16};
  for (int d = 0; d < 3; d++)
    cells[d] = count > d + 1 ? atoi(argument[d + 1]) : cells[d];
  int threads = count > 4 ? atoi(argument[4]) : 1;
  bw_context *context = bw_context_create();
  OK(bw_set_threads(context, threads));
  double origin[3] = {0, 0, 0}, spacing[3] = {0.01, 0.01, 0.01};
  bw_grid *grid = NULL;
  OK(bw_grid_create(context, origin, spacing, cells, NULL, NULL, &grid));
  double *u = (double *)malloc(sizeof *u * 3 * (size_t)grid->node_count);
  double *force = (double *)malloc(sizeof *u * 3 * (size_t)grid->node_count);
  for (int32_t i = 0; i < 3 * grid->node_count; i++)
    u[i] = 1e-3 * sin(0.7 * i);
  printf("%d elements, %d threads; microseconds of processor time per element: energy, gradient, "
         "stiffness of elements alone; of the whole solid; products without and with the matrix\n",
         grid->element_count, threads);
  for (int level = 0; level <= 2; level++)
    for (int law = 0; law < BW_LAWS; law++)
      for (int fibres = level > 0, once = 1; once; once = 0)
        for (int project = 0; project < 2; project++) {
          bw_solid_material *material = material_of(context, (bw_law)law, level, fibres);
          bw_material_table *material_table = NULL;
          bw_solid *solid = NULL;
          bw_solid_linear *linear = NULL;
          bw_solid_shape shape;
          double energy, whole[3], kernel[3], product = INFINITY, own[24], matrix[300];
          OK(bw_material_table_create(context, 2, (const bw_solid_material *const *)&material,
                                      &material_table));
          OK(bw_solid_create(context, grid, material_table, NULL, &solid));
          double *values = (double *)malloc(sizeof *u * 9 * (size_t)solid->pattern->block_count);
          for (int want = 0; want < 3; want++) {
            whole[want] = kernel[want] = INFINITY;
            for (int r = 0; r < REPEATS; r++) {
              double start = processor_seconds();
              OK(bw_solid_evaluate(context, solid, u, project, &energy, want > 0 ? force : NULL,
                                   want > 1 ? values : NULL, &shape));
              whole[want] = fmin(whole[want], processor_seconds() - start);
              start = processor_seconds();
              bwi_hexahedron_state state;
              for (int32_t e = 0; e < grid->element_count; e++)
                bwi_element_evaluate(solid, e, u, (bwi_want)want, project, &state, own, matrix);
              kernel[want] = fmin(kernel[want], processor_seconds() - start);
            }
          }
          OK(bw_solid_linear_create(context, solid, &linear));
          OK(bw_solid_linear_set(context, linear, u, project));
          for (int r = 0; r < REPEATS; r++) {
            double start = processor_seconds();
            OK(bw_solid_linear_multiply(context, linear, u, force));
            product = fmin(product, processor_seconds() - start);
          }
          double with_matrix = INFINITY;
          for (int r = 0; r < REPEATS; r++) {
            double start = processor_seconds();
            OK(bw_block_multiply(context, solid->pattern, values, 9, 3, 1, u, force));
            with_matrix = fmin(with_matrix, processor_seconds() - start);
          }
          double unit = 1e6 / grid->element_count;
          printf("%-20s level %d fibres %d %-9s kernel %6.3f %6.3f %6.3f  whole %6.3f %6.3f %6.3f  "
                 "products %6.3f %6.3f\n",
                 bw_law_word((bw_law)law), level, fibres, project ? "projected" : "plain",
                 unit * kernel[0], unit * kernel[1], unit * kernel[2], unit * whole[0],
                 unit * whole[1], unit * whole[2], unit * product, unit * with_matrix);
          free(values);
          bw_solid_linear_destroy(linear);
          bw_release(solid);
          bw_release(material_table);
          bw_release(material);
        }
  free(u);
  free(force);
  bw_release(grid);
  bw_context_destroy(context);
  return 0;
}
