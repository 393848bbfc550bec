/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products with the unconstrained rigid-body modes R of a DOF map and their weights W R. Each works
 * on the nodes of one body with the six numbers of a motion about the body's centre. */
#include <string.h>

#include "model/internal.h"

void bwi_motion_at(const bw_rigid_mode *motion, const double x[3], double u[3]) {
  double arm[3] = {x[0] - motion->centre[0], x[1] - motion->centre[1], x[2] - motion->centre[2]};
  bw_cross(motion->rotation, arm, u);
  for (int k = 0; k < 3; k++)
    u[k] += motion->translation[k];
}

static int motions_of(const bw_dof_map *dof_map, int32_t body) {
  return dof_map->rigid_mode_start[body + 1] - dof_map->rigid_mode_start[body];
}

/* a[m] of the body's motions from the resultant and the moment about the body's centre. */
static void along_motions(const bw_dof_map *dof_map, int32_t body, const double sum[3],
                          const double moment[3], double *a) {
  const bw_rigid_mode *motion = dof_map->rigid_mode + dof_map->rigid_mode_start[body];
  for (int m = 0; m < motions_of(dof_map, body); m++) {
    double at_centre[3];
    bwi_motion_at(&motion[m], dof_map->body_centre + 3 * (size_t)body, at_centre);
    a[m] = bw_dot(at_centre, sum) + bw_dot(motion[m].rotation, moment);
  }
}

/* t and w, about the body's centre, of sum a[m] motion m. */
static void combined(const bw_dof_map *dof_map, int32_t body, const double *a, double t[3],
                     double w[3]) {
  const bw_rigid_mode *motion = dof_map->rigid_mode + dof_map->rigid_mode_start[body];
  memset(t, 0, 3 * sizeof *t);
  memset(w, 0, 3 * sizeof *w);
  for (int m = 0; m < motions_of(dof_map, body); m++) {
    double at_centre[3];
    bwi_motion_at(&motion[m], dof_map->body_centre + 3 * (size_t)body, at_centre);
    for (int k = 0; k < 3; k++) {
      t[k] += a[m] * at_centre[k];
      w[k] += a[m] * motion[m].rotation[k];
    }
  }
}

static void dot_body(const bw_dof_map *dof_map, int32_t body, const double *force, double *a) {
  const double *centre = dof_map->body_centre + 3 * (size_t)body;
  double sum[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  for (int32_t j = dof_map->body_start[body]; j < dof_map->body_start[body + 1]; j++) {
    size_t i = (size_t)dof_map->body_node[j];
    const double *x = dof_map->mesh->node + 3 * i, *f = force + 3 * i;
    double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]}, cross[3];
    bw_cross(y, f, cross);
    for (int k = 0; k < 3; k++) {
      sum[k] += f[k];
      moment[k] += cross[k];
    }
  }
  along_motions(dof_map, body, sum, moment, a);
}

static void measure_body(const bw_dof_map *dof_map, int32_t body, const double *displacement,
                         double *a) {
  double sum[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  for (int32_t j = dof_map->body_start[body]; j < dof_map->body_start[body + 1]; j++) {
    size_t i = (size_t)dof_map->body_node[j];
    const double *u = displacement + 3 * i, *weight = dof_map->weight + 4 * i;
    double cross[3];
    bw_cross(weight + 1, u, cross); /* u . (w x q) = w . (q x u) */
    for (int k = 0; k < 3; k++) {
      sum[k] += weight[0] * u[k];
      moment[k] += cross[k];
    }
  }
  along_motions(dof_map, body, sum, moment, a);
}

static void add_body(const bw_dof_map *dof_map, int32_t body, double factor, const double *a,
                     double *u) {
  const double *centre = dof_map->body_centre + 3 * (size_t)body;
  double t[3], w[3];
  combined(dof_map, body, a, t, w);
  for (int32_t j = dof_map->body_start[body]; j < dof_map->body_start[body + 1]; j++) {
    size_t i = (size_t)dof_map->body_node[j];
    const double *x = dof_map->mesh->node + 3 * i;
    double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]}, cross[3];
    bw_cross(w, y, cross);
    for (size_t k = 0; k < 3; k++)
      u[3 * i + k] += factor * (t[k] + cross[k]);
  }
}

static void add_weighted_body(const bw_dof_map *dof_map, int32_t body, double factor,
                              const double *a, double *f) {
  double t[3], w[3];
  combined(dof_map, body, a, t, w);
  for (int32_t j = dof_map->body_start[body]; j < dof_map->body_start[body + 1]; j++) {
    size_t i = (size_t)dof_map->body_node[j];
    const double *weight = dof_map->weight + 4 * i;
    double cross[3];
    bw_cross(w, weight + 1, cross);
    for (size_t k = 0; k < 3; k++)
      f[3 * i + k] += factor * (t[k] * weight[0] + cross[k]);
  }
}

void bw_rigid_modes_dot(const bw_dof_map *dof_map, const double *force, double *a) {
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body))
      dot_body(dof_map, body, force, a + dof_map->rigid_mode_start[body]);
}

void bw_rigid_modes_measure(const bw_dof_map *dof_map, const double *displacement, double *a) {
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body))
      measure_body(dof_map, body, displacement, a + dof_map->rigid_mode_start[body]);
}

void bw_rigid_modes_add(const bw_dof_map *dof_map, const double *a, double *displacement) {
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body))
      add_body(dof_map, body, 1, a + dof_map->rigid_mode_start[body], displacement);
}

void bw_rigid_modes_weighted(const bw_dof_map *dof_map, const double *a, double *force) {
  memset(force, 0, 3 * sizeof *force * (size_t)dof_map->mesh->node_count);
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body))
      add_weighted_body(dof_map, body, 1, a + dof_map->rigid_mode_start[body], force);
}

void bw_rigid_modes_balance(const bw_dof_map *dof_map, double *force) {
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body)) {
      double a[6];
      dot_body(dof_map, body, force, a);
      add_weighted_body(dof_map, body, -1, a, force);
    }
}

void bw_rigid_modes_remove(const bw_dof_map *dof_map, double *displacement) {
  for (int32_t body = 0; body < dof_map->mesh->component_count; body++)
    if (motions_of(dof_map, body)) {
      double a[6];
      measure_body(dof_map, body, displacement, a);
      add_body(dof_map, body, -1, a, displacement);
    }
}
