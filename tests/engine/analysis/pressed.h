/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A body with the pressures that may act on it, free or fixed at x = 0: tests of worst loads. */
#ifndef PRESSED_H
#define PRESSED_H

#include "bodies.h"

#include "analysis/load_program.h"

typedef struct pressed_body {
  bw_mesh *mesh; /* the caller's */
  bw_material *material;
  bw_model *model;
  bw_dof_map *dof_map;
  bw_pressure_basis *basis;
  size_t n, nodes;
} pressed_body;

static inline void pressed_open(bw_context *context, pressed_body *s, bw_mesh *mesh, bool fixed,
                                double friction, int facets) {
  bw_isotropic constants = {"test", 3e9, 0.3, 1000, 5e6, 0, 0};
  const bw_pressure_options options = {.friction = friction, .friction_facets = facets};
  const double origin[3] = {0, 0, 0}, normal[3] = {1, 0, 0};
  bw_selection *foot = NULL;
  memset(s, 0, sizeof *s);
  s->mesh = mesh;
  check_ok(context, bw_material_isotropic(context, &constants, &s->material));
  check_ok(context, bw_model_create(context, mesh, s->material, &s->model));
  if (fixed) {
    check_ok(context, bw_select_plane(context, mesh, origin, normal, 1e-9, &foot));
    check_ok(context, bw_model_fix(context, s->model, foot));
  }
  check_ok(context, bw_dof_map_create(context, s->model, &s->dof_map));
  check_ok(context, bw_pressure_basis_create(context, mesh, &options, &s->basis));
  s->n = (size_t)s->basis->count;
  s->nodes = s->n / (size_t)s->basis->directions;
  bw_release(foot);
}

static inline void pressed_close(pressed_body *s) {
  bw_release(s->basis);
  bw_release(s->dof_map);
  bw_release(s->model);
  bw_release(s->material);
}

/* Work on a field that is far from rigid, for each pressure. */
static inline double *pressed_objective(bw_context *context, const pressed_body *s, int which) {
  const bw_mesh *mesh = s->mesh;
  double *field = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  double *f = BW_NEW(context, double, s->n);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * (size_t)i;
    field[3 * i] = sin(7 * x[0] + which) * cos(5 * x[1] - which);
    field[3 * i + 1] = x[2] * x[2] - 0.3 * which * x[0] * x[1] + 0.3 * cos(9 * x[1]);
    field[3 * i + 2] = cos(4 * x[0] * x[2] + which) + 0.05 * sin(90 * x[0] + 70 * x[1]);
  }
  bw_pressure_gradient(s->basis, field, f);
  bw_free(field);
  return f;
}

#endif
