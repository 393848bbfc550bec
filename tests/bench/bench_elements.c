/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* y = K x on straight tet10 of one isotropic material, by the matrix that the smoother stores and
 * by elements without a matrix: time and bytes of one product on a block of N x N x N cubes of six.
 *
 *     bench_elements [N]        19: 41,154 elements */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "linear/element_product.h"

enum { REPEATS = 15 };

int main(int argc, char **argv) {
  int n = argc > 1 ? atoi(argv[1]) : 19, cells[3] = {n, n, n};
  bw_context *context = bw_context_create();
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 1};
  const bw_isotropic constants = {.young = 1, .poisson = 0.3};
  bw_mesh *mesh = NULL;
  bw_material *material = NULL;
  bw_block_pattern *pattern = NULL;
  bw_dof_map *dof_map = NULL;
  bwi_smoother *s = NULL;
  bwi_element_product *product = NULL;
  bool usable;
  OK(bw_mesh_box_grid(context, min, max, cells, 2, &mesh));
  OK(bw_material_isotropic(context, &constants, &material));
  OK(bw_block_pattern_create(context, mesh, &pattern));
  OK(bw_dof_map_unconstrained(context, mesh, &dof_map));
  double *stiffness = malloc(9 * (size_t)pattern->block_count * sizeof *stiffness);
  OK(bw_stiffness(context, pattern, mesh, material, stiffness));
  OK(bwi_smoother_create(context, mesh, pattern, false, false, NULL, &s));
  OK(bwi_smoother_follow(context, s, &(bwi_stiffness){.values = stiffness}, dof_map, &usable));
  OK(bwi_element_product_create(context, s, mesh, material, &product));
  size_t size = 3 * (size_t)mesh->node_count;
  double *x = calloc(12 * size + BWI_SMOOTHER_SPARE, sizeof *x), energy[BWI_SMOOTHER_SIDES];
  double *y = calloc(12 * size + BWI_SMOOTHER_SPARE, sizeof *y);
  double *z = calloc(12 * size + BWI_SMOOTHER_SPARE, sizeof *z);
  bw_random random;
  bw_random_seed(&random, 1);
  for (size_t i = 0; i < 12 * size; i++)
    x[i] = 2 * bw_random_uniform(&random) - 1;
  double matrix = 76.0 * (double)s->odd.start[s->count];
  printf("%d tet10; one product, the least of %d\n\n", mesh->element_count, REPEATS);
  printf("| threads | right-hand sides | by | seconds | processor seconds | MB read | difference "
         "|\n|---|---|---|---|---|---|---|\n");
  for (int k = 0; k < 8; k++) {
    int threads = 1 + k / 4, width = k % 4 == 0 ? 1 : 4 * (k % 4);
    double wall[2] = {INFINITY, INFINITY}, processor[2] = {INFINITY, INFINITY};
    double off = 0, largest = 0;
    OK(bw_set_threads(context, threads));
    for (int pass = 0; pass < 2 * REPEATS; pass++) {
      double began = bw_seconds(), used = processor_seconds();
      if (pass % 2 == 0)
        OK(bwi_smoother_product(context, s, width, x, y, energy));
      else
        OK(bwi_element_product_apply(context, product, width, x, z, energy));
      wall[pass % 2] = fmin(wall[pass % 2], bw_seconds() - began);
      processor[pass % 2] = fmin(processor[pass % 2], processor_seconds() - used);
    }
    for (size_t i = 0; i < size * (size_t)width; i++) {
      off = fmax(off, fabs(z[i] - y[i]));
      largest = fmax(largest, fabs(y[i]));
    }
    printf("| %d | %d | matrix | %.4f | %.4f | %.1f | |\n", threads, width, wall[0], processor[0],
           matrix / 1e6);
    printf("| %d | %d | elements | %.4f | %.4f | %.1f | %.0e |\n", threads, width, wall[1],
           processor[1], (double)bw_bytes(product) / 1e6, off / largest);
  }
  free(x);
  free(y);
  free(z);
  free(stiffness);
  bw_release(product);
  bw_release(s);
  bw_release(dof_map);
  bw_release(pattern);
  bw_release(material);
  bw_release(mesh);
  bw_context_destroy(context);
  return 0;
}
