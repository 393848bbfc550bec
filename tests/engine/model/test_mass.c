/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The motions' weights against the assembled consistent mass matrix, straight and curved. */
#include "helpers.h"

static void weighted_motions_are_mass_times_motions(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 3; kind++) {
    bw_mesh *mesh = kind == 0   ? box_mesh(context, 3, 2, 1, 3, 2, 2, 1)
                    : kind == 1 ? box_mesh(context, 3, 2, 1, 3, 2, 2, 2)
                                : octant_mesh(context, 2, 2);
    bw_dof_map *dof_map = NULL;
    bw_block_pattern *pattern = NULL;
    size_t size = 3 * (size_t)mesh->node_count;
    check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *mass = malloc(sizeof *mass * (size_t)pattern->block_count);
    double *r = malloc(sizeof *r * size), *w = malloc(sizeof *w * size),
           *m = malloc(sizeof *m * size);
    check_ok(context, bw_mass(context, pattern, mesh, NULL, mass));
    for (int i = 0; i < 6; i++) {
      double a[6] = {0}, largest = 0;
      a[i] = 1;
      memset(r, 0, sizeof *r * size);
      bw_rigid_modes_add(dof_map, a, r);
      bw_rigid_modes_weighted(dof_map, a, w);
      check_ok(context, bw_block_multiply(context, pattern, mass, 1, 3, 1, r, m));
      for (size_t k = 0; k < size; k++)
        largest = fmax(largest, fabs(w[k]));
      for (size_t k = 0; k < size; k++)
        check_near(m[k] / dof_map->body_volume[0], w[k], 1e-14 * largest * 10);
    }
    free(mass);
    free(r);
    free(w);
    free(m);
    bw_release(pattern);
    bw_release(dof_map);
    bw_release(mesh);
  }
}

check_main(check_test(weighted_motions_are_mass_times_motions))
