/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The points of a falling body that may touch, and where they are (docs/theory/drop.md). */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "drop/internal.h"

/* ---- points ---------------------------------------------------------------------------------- */

static void add_areas(const bw_mesh *mesh, const int32_t *place, double *area) {
  static const double linear[3] = {1. / 3, 1. / 3, 1. / 3};
  static const double quadratic[6] = {1. / 12, 1. / 12, 1. / 12, 1. / 4, 1. / 4, 1. / 4};
  const double *part = mesh->order == 1 ? linear : quadratic; /* of the four triangles of a facet */
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    const double *x[3];
    double a[3], b[3], normal[3];
    for (int k = 0; k < 3; k++)
      x[k] = mesh->node + 3 * (size_t)node[k];
    for (int k = 0; k < 3; k++) {
      a[k] = x[1][k] - x[0][k];
      b[k] = x[2][k] - x[0][k];
    }
    bw_cross(a, b, normal);
    for (int i = 0; i < mesh->nodes_per_facet; i++)
      for (int k = 0; k < 3; k++)
        area[3 * (int64_t)place[node[i]] + k] += 0.5 * part[i] * normal[k];
  }
}

bw_status bwi_drop_points_create(bw_context *context, bwi_drop_run *run) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = run->model->mesh;
  bwi_drop_points *p = &run->points;
  int m = run->motion.modes;
  int32_t *place = BW_NEW0(context, int32_t, mesh->node_count);
  p->count = mesh->boundary_node_count;
  p->node = BW_NEW(context, int32_t, p->count);
  p->at = BW_NEW(context, double, 3 * (int64_t)p->count);
  p->area = BW_NEW0(context, double, 3 * (int64_t)p->count);
  p->basis = BW_NEW(context, double, 3 * (int64_t)p->count * m);
  p->mode_size = BW_NEW0(context, double, m);
  BW_TRY_MEMORY(place && p->node && p->at && p->area && p->basis && p->mode_size);
  for (int32_t i = 0; i < p->count; i++) {
    int64_t node = mesh->boundary_node[i];
    double *at = p->at + 3 * (int64_t)i, *basis = p->basis + 3 * (int64_t)i * m;
    p->node[i] = (int32_t)node;
    place[node] = i;
    for (int k = 0; k < 3; k++)
      at[k] = mesh->node[3 * node + k] - run->origin[k];
    p->radius = fmax(p->radius, bw_norm(at));
    for (int j = 0; j < m; j++) {
      const double *shape = run->modes->shape + 3 * ((int64_t)j * mesh->node_count + node);
      for (int k = 0; k < 3; k++)
        basis[k * m + j] = shape[k];
      p->mode_size[j] = fmax(p->mode_size[j], bw_norm(shape));
    }
  }
  add_areas(mesh, place, p->area);
done:
  bw_free(place);
  return status;
}

void bwi_drop_points_clear(bwi_drop_points *p) {
  bw_free(p->node);
  bw_free(p->at);
  bw_free(p->area);
  bw_free(p->basis);
  bw_free(p->mode_size);
}

/* ---- positions ------------------------------------------------------------------------------- */

void bwi_drop_to_space(const double turn[9], const double body[3], double space[3]) {
  for (int i = 0; i < 3; i++)
    space[i] = bw_dot(turn + 3 * i, body);
}

void bwi_drop_to_body(const double turn[9], const double space[3], double body[3]) {
  for (int k = 0; k < 3; k++)
    body[k] = turn[k] * space[0] + turn[3 + k] * space[1] + turn[6 + k] * space[2];
}

double bwi_drop_rigid_gap_at(const bwi_drop_run *run, int32_t point) {
  const bwi_drop_motion *m = &run->motion;
  double arm[3], x[3], normal[3];
  bwi_drop_to_space(m->turn, run->points.at + 3 * (int64_t)point, arm);
  for (int k = 0; k < 3; k++)
    x[k] = m->centre[k] + arm[k];
  return bwi_rigid_gap(&run->onto, x, normal);
}

double bwi_drop_gap_at(const bwi_drop_run *run, int32_t point, double normal[3], double arm[3]) {
  const bwi_drop_motion *m = &run->motion;
  const double *at = run->points.at + 3 * (int64_t)point;
  const double *basis = run->points.basis + 3 * (int64_t)point * m->modes;
  double place[3], x[3];
  for (int k = 0; k < 3; k++)
    place[k] = at[k] + bwi_dot(m->modes, basis + k * m->modes, m->q);
  bwi_drop_to_space(m->turn, place, arm);
  for (int k = 0; k < 3; k++)
    x[k] = m->centre[k] + arm[k];
  return bwi_rigid_gap(&run->onto, x, normal);
}

double bwi_drop_rigid_gap(const bwi_drop_run *run) {
  double least = INFINITY;
  for (int32_t i = 0; i < run->points.count; i++)
    least = fmin(least, bwi_drop_rigid_gap_at(run, i));
  return least;
}

double bwi_drop_plane_gap(const bwi_drop_run *run, const double normal[3]) {
  const bwi_drop_motion *m = &run->motion;
  double body[3], least = INFINITY, centre = -run->onto.radius; /* 0 of a plane */
  bwi_drop_to_body(m->turn, normal, body);
  for (int k = 0; k < 3; k++)
    centre += normal[k] * (m->centre[k] - run->onto.point[k]);
  for (int32_t i = 0; i < run->points.count; i++)
    least = fmin(least, centre + bw_dot(body, run->points.at + 3 * (int64_t)i));
  return least;
}

double bwi_drop_speed(const bwi_drop_run *run) {
  double spin[3];
  bwi_drop_spin(&run->motion, spin);
  return bw_norm(run->motion.velocity) + bw_norm(spin) * run->points.radius;
}

bool bwi_drop_faces_away(const bwi_drop_run *run, int32_t point, const double normal[3]) {
  const double *area = run->points.area + 3 * (int64_t)point;
  double push[3];
  bwi_drop_to_body(run->motion.turn, normal, push);
  return bw_dot(area, push) > 0.5 * bw_norm(area);
}
