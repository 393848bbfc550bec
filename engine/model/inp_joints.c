/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The joints of a model as equations, springs and masses of a deck, the same as in the engine's own
 * equations (docs/theory/joints.md):
 *
 * - a node that follows others in a bond, and one of a rigid coupling, has an equation for each
 *   free direction;
 * - a remote point has two nodes, for its displacement and its rotation, and one of a distributed
 *   coupling has the mean motion of its face by six equations;
 * - a mass or a spring that is spread over an area acts at the points of the facets' quadrature,
 *   each a node that follows those of the facet;
 * - a preload is a node whose first displacement is the shortening. */
#include "model/inp_joints.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"

static const double rounding = 1e-15;

typedef struct work {
  bw_context *context;
  const bw_model *model;
  const bw_dof_map *dof_map;
  bwi_inp_joints *j;
  int32_t one; /* a node whose first displacement is 1, or -1 */
} work;

/* A further node, from 0. */
static bw_status add_node(work *w, const double at[3], int32_t *node) {
  bwi_inp_joints *j = w->j;
  if (!bw_grow(w->context, (void **)&j->node, &j->node_capacity, j->node_count, 1,
               3 * sizeof *j->node))
    return BW_MEMORY;
  memcpy(j->node + 3 * j->node_count, at, 3 * sizeof *j->node);
  *node = w->model->mesh->node_count + (int32_t)j->node_count++;
  return BW_OK;
}

static bw_status add_term(work *w, int32_t node, int direction, double factor) {
  if (fabs(factor) < rounding)
    return BW_OK;
  return bwi_inp_list_add(w->context, &w->j->term, node, direction, factor);
}

/* Begins an equation, of which this displacement is eliminated. */
static bw_status begin_equation(work *w, int32_t node, int direction) {
  bwi_inp_joints *j = w->j;
  if (!bw_grow(w->context, (void **)&j->first, &j->equation_capacity, j->equation_count, 1,
               sizeof *j->first))
    return BW_MEMORY;
  j->first[j->equation_count++] = j->term.count;
  return add_term(w, node, direction, 1);
}

/* ---- bonds ----------------------------------------------------------------------------------- */

static bw_status add_constant(work *w, double value) {
  bw_status status = BW_OK;
  if (value == 0)
    return BW_OK;
  if (w->one < 0) {
    BW_TRY(add_node(w, (double[3]){0}, &w->one));
    BW_TRY(bwi_inp_list_add(w->context, &w->j->fixed, w->one, 0, 1));
  }
  BW_TRY(add_term(w, w->one, 0, -value));
done:
  return status;
}

/* The displacement along c of a node that follows: its free directions are those of the others. */
static bw_status follow_along(work *w, const bw_bond *bond, int32_t row, int c, bool values,
                              int32_t shortening) {
  bw_status status = BW_OK;
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const bw_dof_map *d = w->dof_map;
  const bw_sparse_matrix *f = bond->follows;
  int32_t node = bond->node[row], frame_of = d->frame_of[node];
  const double *frame = frame_of >= 0 ? d->frame + 9 * (int64_t)frame_of : global;
  double part[3] = {0}, constant = 0;
  for (int k = 0; k < 3; k++) {
    bool prescribed = d->state[3 * (int64_t)node + k] == BW_DOF_PRESCRIBED;
    if (prescribed)
      constant += frame[3 * k + c] * d->value[3 * (int64_t)node + k];
    for (int e = 0; e < 3 && !prescribed; e++)
      part[e] += frame[3 * k + c] * frame[3 * k + e];
  }
  if (bw_norm(part) < rounding)
    return bwi_inp_list_add(w->context, &w->j->fixed, node, c, values ? constant : 0);
  BW_TRY(begin_equation(w, node, c));
  for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
    for (int k = 0; k < 3; k++)
      BW_TRY(add_term(w, f->column[e], k, -f->value[e] * part[k]));
  if (shortening >= 0)
    BW_TRY(add_term(w, shortening, 0, -bw_dot(part, bond->normal)));
  if (values)
    BW_TRY(add_constant(w, constant));
done:
  return status;
}

static bw_status add_bond(work *w, const bw_bond *bond, bool frequency, uint8_t *joined) {
  bw_status status = BW_OK;
  int32_t shortening = -1;
  bool force = bond->preload == BW_PRELOAD_FORCE;
  if (bond->preload != BW_NO_PRELOAD && !frequency) {
    BW_TRY(add_node(w, w->model->mesh->node + 3 * (int64_t)bond->node[0], &shortening));
    BW_TRY(bwi_inp_list_add(w->context, force ? &w->j->force : &w->j->fixed, shortening, 0,
                            bond->pull));
  }
  for (int32_t i = 0; i < bond->node_count; i++) {
    joined[bond->node[i]] = 1;
    for (int c = 0; c < 3; c++)
      BW_TRY(follow_along(w, bond, i, c, !frequency, shortening));
  }
done:
  return status;
}

/* ---- remote points --------------------------------------------------------------------------- */

static bw_status add_rigid(work *w, const bw_coupling *coupling, const int32_t node[2],
                           uint8_t *joined) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < coupling->node_count; i++) {
    const double *x = w->model->mesh->node + 3 * (int64_t)coupling->node[i];
    double arm[3];
    joined[coupling->node[i]] = 1; /* a support there agrees with the point */
    for (int c = 0; c < 3; c++)
      arm[c] = x[c] - coupling->point.at[c];
    for (int c = 0; c < 3; c++) {
      double turn[3];
      bw_cross(arm, (double[3]){c == 0, c == 1, c == 2}, turn);
      BW_TRY(begin_equation(w, coupling->node[i], c));
      BW_TRY(add_term(w, node[0], c, -1));
      for (int k = 0; k < 3; k++)
        BW_TRY(add_term(w, node[1], k, -turn[k]));
    }
  }
done:
  return status;
}

static bw_status add_distributed(work *w, const bw_coupling *coupling, const int32_t node[2]) {
  bw_status status = BW_OK;
  int64_t width = 3 * (int64_t)coupling->node_count;
  for (int k = 0; k < 6; k++) {
    BW_TRY(begin_equation(w, node[k / 3], k % 3));
    for (int64_t i = 0; i < width; i++)
      BW_TRY(add_term(w, coupling->node[i / 3], (int)(i % 3), -coupling->mean[k * width + i]));
  }
done:
  return status;
}

/* A tensor of inertia is that of three masses on arms along its axes, one meter long. */
static bw_status add_inertia(work *w, const bw_remote_point *point, int32_t rotation, int number,
                             const char *path) {
  bw_status status = BW_OK;
  double moment[9], axis[9], half = (point->inertia[0] + point->inertia[4] + point->inertia[8]) / 2;
  if (half == 0)
    return BW_OK;
  for (int i = 0; i < 9; i++)
    moment[i] = (i % 4 == 0 ? half : 0) - point->inertia[i];
  bwi_symmetric_eigen(3, 3, moment, axis, 1e-30, 60);
  for (int i = 0; i < 3; i++) {
    const double mass = moment[4 * i], *arm = axis + 3 * i;
    int32_t node;
    if (mass < -1e-12 * half)
      return bw_fail(w->context, BW_UNSUPPORTED,
                     "%s: a moment of inertia of remote point %d is larger than the sum of the "
                     "other two, as of no body, and a deck has masses only",
                     path, number);
    if (!(mass > 1e-12 * half))
      continue;
    BW_TRY(add_node(w, point->at, &node));
    for (int c = 0; c < 3; c++) {
      double turn[3];
      bw_cross(arm, (double[3]){c == 0, c == 1, c == 2}, turn);
      BW_TRY(begin_equation(w, node, c));
      for (int k = 0; k < 3; k++)
        BW_TRY(add_term(w, rotation, k, -turn[k]));
    }
    BW_TRY(bwi_inp_list_add(w->context, &w->j->mass, node, 0, mass));
  }
done:
  return status;
}

static bw_status add_coupling(work *w, int index, const double gravity[3], bool frequency,
                              const char *path, uint8_t *joined) {
  bw_status status = BW_OK;
  const bw_coupling *coupling = &w->model->coupling[index];
  const bw_remote_point *point = &coupling->point;
  bwi_inp_joints *j = w->j;
  int32_t node[2];
  for (int n = 0; n < 2; n++)
    BW_TRY(add_node(w, point->at, &node[n]));
  for (int k = 0; k < 6; k++) {
    int32_t at = node[k / 3];
    double force = point->load[k] + (k < 3 ? point->mass * gravity[k] : 0);
    if (point->fixed[k] && point->kind == BW_DISTRIBUTED)
      return bw_fail(w->context, BW_UNSUPPORTED,
                     "%s: the distributed coupling %d has prescribed values, and a deck cannot "
                     "prescribe what an equation gives: make the coupling rigid, or give its point "
                     "stiff springs",
                     path, index + 1);
    if (point->fixed[k])
      BW_TRY(bwi_inp_list_add(w->context, &j->fixed, at, k % 3,
                              frequency ? 0 : point->displacement[k]));
    if (point->spring[k] > 0)
      BW_TRY(bwi_inp_list_add(w->context, &j->spring, at, k % 3, point->spring[k]));
    if (force != 0)
      BW_TRY(bwi_inp_list_add(w->context, &j->force, at, k % 3, force));
  }
  if (point->kind == BW_RIGID)
    BW_TRY(add_rigid(w, coupling, node, joined));
  else
    BW_TRY(add_distributed(w, coupling, node));
  if (point->mass > 0)
    BW_TRY(bwi_inp_list_add(w->context, &j->mass, node[0], 0, point->mass));
  if (frequency)
    BW_TRY(add_inertia(w, point, node[1], index + 1, path));
done:
  return status;
}

/* ---- attachments ----------------------------------------------------------------------------- */

/* A part of an attachment at a node. */
static bw_status attach(work *w, const bw_attachment *attachment, int32_t node, double share) {
  bw_status status = BW_OK;
  if (attachment->mass > 0)
    return bwi_inp_list_add(w->context, &w->j->mass, node, 0, share * attachment->mass);
  for (int c = 0; c < 3; c++)
    if (attachment->stiffness[c] > 0)
      BW_TRY(
          bwi_inp_list_add(w->context, &w->j->spring, node, c, share * attachment->stiffness[c]));
done:
  return status;
}

/* Marks in `moved` (node_count) the nodes that a support, a rigid coupling or a shortening moves,
 * and those that follow one of them in a bond. */
static void find_moved(const work *w, uint8_t *moved) {
  const bw_model *model = w->model;
  for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++)
    moved[i / 3] |= w->dof_map->value[i] != 0;
  for (int p = 0; p < model->coupling_count; p++) {
    const bw_coupling *c = &model->coupling[p];
    bool moves = false;
    for (int k = 0; k < 6; k++)
      moves |= c->point.kind == BW_RIGID && c->point.fixed[k] && c->point.displacement[k] != 0;
    for (int32_t i = 0; moves && i < c->node_count; i++)
      moved[c->node[i]] = 1;
  }
  for (int b = 0; b < model->bond_count; b++) {
    const bw_bond *bond = &model->bond[b];
    for (int32_t i = 0; i < bond->node_count; i++) {
      moved[bond->node[i]] |= bond->preload == BW_PRELOAD_SHORTENING;
      for (int64_t e = bond->follows->start[i]; e < bond->follows->start[i + 1]; e++)
        moved[bond->node[i]] |= moved[bond->follows->column[e]];
    }
  }
}

static bool has_mark(const bw_selection *on, const uint8_t *mark) {
  for (int32_t i = 0; i < on->node_count; i++)
    if (mark[on->node[i]])
      return true;
  return false;
}

static bw_status add_attachment(work *w, const bw_attachment *attachment) {
  bw_status status = BW_OK;
  const bw_selection *on = attachment->on;
  const bw_mesh *mesh = on->mesh;
  for (int32_t i = 0; on->facet_count == 0 && i < on->node_count; i++)
    BW_TRY(attach(w, attachment, on->node[i], 1. / on->node_count));
  for (int32_t f = 0; f < on->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int points = bwi_boundary_points(mesh, on->facet[f], point);
    for (int p = 0; p < points; p++) {
      int32_t made;
      double at[3] = {0};
      for (int i = 0; i < mesh->nodes_per_facet; i++)
        for (int c = 0; c < 3; c++)
          at[c] += point[p].shape[i] * mesh->node[3 * (int64_t)node[i] + c];
      BW_TRY(add_node(w, at, &made));
      for (int c = 0; c < 3; c++) {
        BW_TRY(begin_equation(w, made, c));
        for (int i = 0; i < mesh->nodes_per_facet; i++)
          BW_TRY(add_term(w, node[i], c, -point[p].shape[i]));
      }
      BW_TRY(attach(w, attachment, made, bw_norm(point[p].area) / attachment->area));
    }
  }
done:
  return status;
}

/* ---- together -------------------------------------------------------------------------------- */

static void add_force(void *data, int32_t node, const double force[3]) {
  double *to = (double *)data + 3 * (int64_t)node;
  for (int c = 0; c < 3; c++)
    to[c] += force[c];
}

void bwi_inp_add_weights(const bw_model *model, double *force) {
  double gravity[3];
  bwi_sum_gravity(model, gravity);
  for (int i = 0; i < model->attachment_count; i++) {
    double mass = model->attachment[i].mass, factor[3] = {mass, mass, mass};
    if (mass > 0)
      bwi_attachment_apply(&model->attachment[i], factor, NULL, gravity, add_force, force);
  }
}

bw_status bwi_inp_joints_make(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                              const char *path, bool frequency, bwi_inp_joints *j,
                              uint8_t *joined) {
  bw_status status = BW_OK;
  work w = {.context = context, .model = model, .dof_map = dof_map, .j = j, .one = -1};
  double gravity[3];
  uint8_t *moved = BW_NEW0(context, uint8_t, model->mesh->node_count);
  BW_TRY_MEMORY(moved);
  find_moved(&w, moved);
  bwi_sum_gravity(model, gravity);
  for (int i = 0; i < model->coupling_count; i++)
    BW_TRY(add_coupling(&w, i, gravity, frequency, path, joined));
  for (int i = 0; i < model->bond_count; i++)
    BW_TRY(add_bond(&w, &model->bond[i], frequency, joined));
  for (int i = 0; i < model->attachment_count; i++) {
    const bw_attachment *attachment = &model->attachment[i];
    if (frequency || !(attachment->mass > 0))
      BW_TRY(add_attachment(&w, attachment));
    if (!frequency && !(attachment->mass > 0) && attachment->on->facet_count > 0 &&
        has_mark(attachment->on, moved))
      bw_warn(context,
              "%s: the spring of attachment %d is on nodes that supports, a rigid coupling or a "
              "shortening move, and CalculiX 2.20 leaves a part of its force out: its "
              "displacements differ",
              path, i + 1);
  }
done:
  bw_free(moved);
  return status;
}
