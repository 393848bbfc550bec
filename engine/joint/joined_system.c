/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of joined models for many right-hand sides (docs/theory/joints.md, "Many loads"):
 * the motions that supports, springs and points leave free move all bodies as one. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "joint/joined_solution.h"
#include "linear/internal.h"

/* ---- rigid-body modes of all bodies together ------------------------------------------------- */

/* Conditions on the motion of all bodies as one, about a centre: rows as bwi_rigid_modes takes. */
typedef struct conditions {
  bw_context *context;
  double centre[3], length;
  double (*row)[6];
  size_t count, capacity;
} conditions;

static bw_status add_row(conditions *c, const double x[3], const double d[3]) {
  if (!bw_grow(c->context, (void **)&c->row, &c->capacity, c->count, 1, sizeof *c->row))
    return BW_MEMORY;
  double *row = c->row[c->count++];
  double y[3] = {x[0] - c->centre[0], x[1] - c->centre[1], x[2] - c->centre[2]};
  bw_cross(y, d, row + 3);
  for (int k = 0; k < 3; k++) {
    row[k] = d[k];
    row[3 + k] /= c->length;
  }
  return BW_OK;
}

static bw_status add_spring(conditions *c, const bw_attachment *spring) {
  bw_status status = BW_OK;
  const double *x = spring->on->mesh->node;
  for (int32_t i = 0; i < spring->on->node_count; i++)
    for (int k = 0; k < 3; k++)
      if (spring->stiffness[k] > 0)
        BW_TRY(
            add_row(c, x + 3 * (int64_t)spring->on->node[i], (double[3]){k == 0, k == 1, k == 2}));
done:
  return status;
}

static bw_status add_point(conditions *c, const bw_remote_point *point) {
  bw_status status = BW_OK;
  for (int k = 0; k < 6; k++) {
    const double d[3] = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
    if (!point->fixed[k] && !(point->spring[k] > 0))
      continue;
    BW_TRY(add_row(c, point->at, d));
    if (k < 3)
      continue;
    double *row = c->row[c->count - 1]; /* a rotation is the same everywhere */
    memset(row, 0, 3 * sizeof *row);
    memcpy(row + 3, d, sizeof d);
  }
done:
  return status;
}

/* Centre, size and 1/V integral of |y|^2 1 - y y^T of all bodies, by the mass of density 1. */
static bw_status find_moments(conditions *c, const bwi_joined_solution *s, const double *mass,
                              double inertia[9], double *volume) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->q.reduction.dof_map->mesh;
  int64_t nodes = mesh->node_count;
  double *one = BW_NEW(c->context, double, nodes), *weight = BW_NEW(c->context, double, nodes);
  double *y = BW_NEW(c->context, double, 3 * nodes), *my = BW_NEW(c->context, double, 3 * nodes);
  BW_TRY_MEMORY(one && weight && y && my);
  for (int64_t i = 0; i < nodes; i++)
    one[i] = 1;
  BW_TRY(bw_block_multiply(c->context, s->q.pattern, mass, 1, 1, 1, one, weight));
  *volume = 0;
  for (int64_t i = 0; i < nodes; i++) {
    *volume += weight[i];
    for (int k = 0; k < 3; k++)
      c->centre[k] += weight[i] * mesh->node[3 * i + k];
  }
  for (int k = 0; k < 3; k++)
    c->centre[k] /= *volume;
  for (int64_t i = 0; i < 3 * nodes; i++)
    y[i] = mesh->node[i] - c->centre[i % 3];
  BW_TRY(bw_block_multiply(c->context, s->q.pattern, mass, 1, 3, 1, y, my));
  double square[9] = {0};
  for (int64_t i = 0; i < nodes; i++)
    for (int k = 0; k < 9; k++)
      square[k] += y[3 * i + k / 3] * my[3 * i + k % 3] / *volume;
  for (int k = 0; k < 9; k++)
    inertia[k] = (k % 4 == 0 ? square[0] + square[4] + square[8] : 0) - square[k];
  c->length = sqrt((inertia[0] + inertia[4] + inertia[8]) / 2);
done:
  bw_free(one);
  bw_free(weight);
  bw_free(y);
  bw_free(my);
  return status;
}

static bw_status take_conditions(conditions *c, const bw_model *model) {
  bw_status status = BW_OK;
  int32_t count = 0;
  bwi_constraint *constraint = NULL;
  BW_TRY(bwi_node_constraints(c->context, model, &count, &constraint));
  for (int32_t h = 0; h < count; h++)
    for (int i = 0; i < constraint[h].count; i++)
      BW_TRY(add_row(c, model->mesh->node + 3 * (int64_t)constraint[h].node,
                     constraint[h].direction[i]));
  for (int i = 0; i < model->attachment_count; i++)
    BW_TRY(add_spring(c, &model->attachment[i]));
  for (int i = 0; i < model->coupling_count; i++)
    BW_TRY(add_point(c, &model->coupling[i].point));
done:
  bw_free(constraint);
  return status;
}

/* R, W R, and the modes into the DOF map. */
static bw_status find_motions(bw_context *context, const bw_model *model, bwi_joined_solution *s,
                              bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  conditions c = {.context = context};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double inertia[9], volume, *mass = NULL;
  bw_rigid_mode *motion = NULL;
  mass = BW_NEW(context, double, s->q.pattern->block_count);
  motion = BW_NEW0(context, bw_rigid_mode, 6);
  BW_TRY_MEMORY(mass && motion);
  BW_TRY(bw_mass(context, s->q.pattern, model->mesh, NULL, mass));
  BW_TRY(find_moments(&c, s, mass, inertia, &volume));
  BW_TRY(take_conditions(&c, model));
  bw_dof_map whole = {.mesh = model->mesh, .body_centre = c.centre};
  s->motions = bwi_rigid_modes(&whole, 0, inertia, c.length, (int64_t)c.count,
                               (const double(*)[6])c.row, motion);
  s->motion = BW_NEW(context, double, s->motions *size);
  BW_TRY_MEMORY(s->motion);
  for (int m = 0; m < s->motions; m++) {
    motion[m].component = -1;
    for (int64_t i = 0; i < size / 3; i++)
      bwi_motion_at(&motion[m], model->mesh->node + 3 * i, s->motion + m * size + 3 * i);
  }
  if (s->q.rigid_count > s->motions)
    BW_TRY(bw_fail(context, BW_UNCONSTRAINED,
                   "bonds and couplings leave %d rigid-body modes, and the joined body as one has "
                   "%d: some bodies move against one another. Join them by bonds, or support each",
                   s->q.rigid_count, s->motions));
  BW_TRY(bwi_joined_solution_weigh(context, model, mass, volume, c.length, s));
  bw_free(dof_map->rigid_mode);
  dof_map->rigid_mode = motion;
  motion = NULL;
  dof_map->rigid_mode_count = s->motions;
  memset(dof_map->rigid_mode_start, 0,
         ((size_t)model->mesh->component_count + 1) * sizeof *dof_map->rigid_mode_start);
  dof_map->unknown_count = s->q.reduction.unknown_count;
done:
  bw_free(c.row);
  bw_free(mass);
  bw_free(motion);
  return status;
}

/* ---- together -------------------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_model *model) {
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  bw_status status = bwi_model_refuse_preloads(
      context, model,
      "strains the bodies without any other load: the stress is not linear in the loads, leave the "
      "preload out");
  if (status != BW_OK)
    return status;
  return bwi_points_refuse_motion(context, model, "many loads are solved with fixed points only");
}

bw_status bw_joined_system(bw_context *context, const bw_model *model, const bw_solver *solver,
                           bw_system **out) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  bwi_joined_solution *s = NULL;
  double start = bw_seconds();
  BW_TRY(check_model(context, model));
  s = BW_NEW0(context, bwi_joined_solution, 1);
  BW_TRY_MEMORY(s);
  BW_TRY(bwi_dof_map_apart(context, model, &dof_map));
  if (dof_map->prescribed)
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "a support prescribes a displacement that is not zero: many loads are solved "
                   "with fixed supports only"));
  BW_TRY(bwi_joined_open(context, model, false, NULL, &s->q));
  BW_TRY(find_motions(context, model, s, dof_map));
  bwi_joined_solution *whole = s;
  s = NULL;
  BW_TRY(bwi_joined_solution_system(context, model, solver, dof_map, start, whole, out));
  bw_release(whole->q.k);
  whole->q.k = NULL;
  bw_free(whole->q.stiffness);
  whole->q.stiffness = NULL;
done:
  bwi_joined_solution_destroy(s);
  bw_release(dof_map);
  return status;
}
