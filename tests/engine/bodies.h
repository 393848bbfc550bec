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

/* The facets in a plane across an axis. */
static inline bw_selection *body_face(bw_context *context, const bw_mesh *mesh, int axis,
                                      double at) {
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  bw_selection *selection = NULL;
  point[axis] = at;
  normal[axis] = 1;
  check_ok(context, bw_select_plane(context, mesh, point, normal, 1e-9, &selection));
  return selection;
}

/* A bar along x, fixed at x = 0, under a force at its other end where there is one. */
static inline bw_model *body_bar(bw_context *context, bw_mesh *mesh, double length,
                                 const double *force) {
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *held = body_face(context, mesh, 0, 0),
               *loaded = body_face(context, mesh, 0, length);
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, held));
  if (force)
    check_ok(context, bw_model_force(context, model, loaded, force));
  bw_release(held);
  bw_release(loaded);
  bw_release(material);
  return model;
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
