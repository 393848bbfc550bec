/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small solids for the tests of energies and what is made of them. */
#ifndef SOLIDS_H
#define SOLIDS_H

#include "check.h"

/* Points of a rule of `level`, laws and constants that differ from point to point, and fibres.
 * `law` BW_LAWS: all laws in turn. */
static inline bw_solid_material *solids_mixed(bw_context *context, bw_law law, int level,
                                              int fibres, uint64_t seed) {
  enum { MAX = 64 };
  bw_rule *rule = NULL;
  bw_solid_material *material = NULL;
  bw_random random;
  uint8_t laws[MAX];
  double mu[MAX], lambda[MAX], stiffness[3 * MAX], v[9 * MAX];
  bw_random_seed(&random, seed);
  check_ok(context, bw_rule_create(context, level, &rule));
  for (int q = 0; q < rule->count; q++) {
    laws[q] = (uint8_t)(law == BW_LAWS ? q % BW_LAWS : (int)law);
    mu[q] = 1 + bw_random_uniform(&random);
    lambda[q] = 2 * bw_random_uniform(&random);
    for (int k = 0; k < fibres; k++) {
      double *direction = v + 3 * (q * fibres + k), length;
      for (int d = 0; d < 3; d++)
        direction[d] = bw_random_normal(&random);
      length = bw_norm(direction);
      for (int d = 0; d < 3; d++)
        direction[d] /= length;
      stiffness[q * fibres + k] = bw_random_uniform(&random);
    }
  }
  check_ok(context, bw_solid_material_points(context, "mixed", rule, 800, laws, mu, lambda, fibres,
                                             stiffness, v, &material));
  bw_release(rule);
  return material;
}

static inline bw_solid_material *solids_simple(bw_context *context, bw_law law) {
  bw_solid_material *material = NULL;
  check_ok(context, bw_solid_material_create(context, "simple", law, 2.6, 0.3, 1000, &material));
  return material;
}

/* Boxes of 0.1 x 0.2 x 0.15 m; `material` and `fraction` per cell as in bw_grid_create. Releases
 * the materials of the material table. */
static inline bw_solid *solids_create(bw_context *context, const int32_t cells[3], int count,
                                      bw_solid_material **material_table_materials,
                                      const int32_t *material, const double *fraction) {
  const double origin[3] = {-0.1, 0.2, 0}, spacing[3] = {0.1, 0.2, 0.15};
  bw_grid *grid = NULL;
  bw_material_table *material_table = NULL;
  bw_solid *solid = NULL;
  check_ok(context,
           bw_material_table_create(context, count + 1,
                                    (const bw_solid_material *const *)material_table_materials,
                                    &material_table));
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, fraction, &grid));
  check_ok(context, bw_solid_create(context, grid, material_table, NULL, &solid));
  for (int i = 0; i < count; i++)
    bw_release(material_table_materials[i]);
  bw_release(material_table);
  bw_release(grid);
  return solid;
}

/* u = H (X - origin of the grid), and a random part of size `noise`. */
static inline double *solids_displacement(const bw_solid *solid, const double h[9], double noise) {
  const bw_grid *grid = solid->grid;
  double *u = (double *)malloc(3 * sizeof *u * (size_t)grid->node_count);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int32_t i = 0; i < grid->node_count; i++) {
    double x[3];
    bw_grid_position(grid, i, x);
    for (int d = 0; d < 3; d++)
      x[d] -= grid->origin[d];
    for (int d = 0; d < 3; d++)
      u[3 * (int64_t)i + d] =
          bw_dot(h + 3 * (size_t)d, x) + noise * (bw_random_uniform(&random) - 0.5);
  }
  return u;
}

static inline double *solids_numbers(int64_t count) {
  return (double *)calloc((size_t)count, sizeof(double));
}

#endif
