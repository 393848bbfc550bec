/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies and fields that the tests of several folders share. */
#ifndef BODIES_H
#define BODIES_H

#include "check.h"

static inline bw_mesh *body_box(bw_context *context, double x, double y, double z, int nx, int ny,
                                int nz, int order) {
  bw_mesh *mesh = NULL;
  const double low[3] = {0, 0, 0}, high[3] = {x, y, z};
  const int cells[3] = {nx, ny, nz};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static inline bw_material *body_material(bw_context *context) {
  bw_material *material = NULL;
  const bw_isotropic constants = {
      .name = "test", .young = 200e9, .poisson = 0.3, .density = 7800, .strength = 4e8};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static inline bw_solver *body_solver(bw_context *context, bw_solver_options options) {
  bw_solver *solver = NULL;
  check_ok(context, bw_solver_create(context, &options, &solver));
  return solver;
}

/* The preconditioner is that of PCG; others have none. */
static inline bw_solver *body_solver_over(bw_context *context, bw_solver_options options,
                                          bw_solver_options preconditioner) {
  if (options.kind != BW_SOLVER_PCG)
    return body_solver(context, options);
  bw_solver *inner = body_solver(context, preconditioner);
  options.preconditioner = inner;
  bw_solver *solver = body_solver(context, options);
  bw_release(inner); /* the solver retains it */
  return solver;
}

static inline void random_field(uint64_t seed, int64_t size, double *field) {
  bw_random random;
  bw_random_seed(&random, seed);
  for (int64_t i = 0; i < size; i++)
    field[i] = 2 * bw_random_uniform(&random) - 1;
}

static inline double *numbers(int64_t count) {
  return (double *)calloc(count > 0 ? (size_t)count : 1, sizeof(double));
}

#endif
