/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tractions that joints and supports exert on the body, from the forces at nodes that make up their
 * resultants (docs/theory/joints.md#tractions-of-joints). */
#include <math.h>
#include <string.h>

#include "analysis/nodal_traction.h"
#include "base/dense.h"
#include "joint/internal.h"

typedef struct traction_work {
  const bw_static *result;
  const bw_mesh *mesh;
  const bw_selection *on;
  bwi_nodal_traction facets;
  int32_t *facet; /* (index, facet_count x nodes_per_facet) */
  double *force;  /* (N, node_count x 3) on the body */
} traction_work;

static bw_status reserve(bw_context *context, const bw_selection *on, traction_work *w) {
  bw_status status = BW_OK;
  int per = w->mesh->nodes_per_facet;
  w->on = on;
  w->facet = BW_NEW(context, int32_t, (int64_t)on->facet_count * per);
  w->force = BW_NEW0(context, double, 3 * (int64_t)w->mesh->node_count);
  BW_TRY_MEMORY(w->facet && w->force);
  for (int32_t f = 0; f < on->facet_count; f++)
    memcpy(w->facet + (int64_t)f * per, w->mesh->facet + (int64_t)on->facet[f] * per,
           (size_t)per * sizeof *w->facet);
  BW_TRY(bwi_nodal_traction_open(context, w->mesh, on->facet_count, w->facet, &w->facets));
done:
  return status;
}

/* ---- forces of each kind of joint ------------------------------------------------------------ */

/* At a node that a support constrains, the bond's part is the rest. */
static bw_status take_bond(bw_context *context, traction_work *w, int index,
                           bw_interface_force *sum) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  const bw_bond *bond = &w->result->model->bond[index];
  BW_TRY(reserve(context, bond->a, w));
  BW_TRY(bwi_dof_map_apart(context, w->result->model, &dof_map));
  sum->area = bond->area;
  for (int32_t i = 0; i < bond->node_count; i++) {
    int64_t node = bond->node[i];
    const uint8_t *state = dof_map->state + 3 * node;
    memcpy(w->force + 3 * node, w->result->joint_force + 3 * node, 3 * sizeof *w->force);
    memcpy(w->facets.normal + 3 * node, bond->node_normal + 3 * (int64_t)i,
           3 * sizeof *w->facets.normal);
    w->facets.area[node] = bond->node_area[i];
    sum->shared += state[0] == BW_DOF_PRESCRIBED || state[1] == BW_DOF_PRESCRIBED ||
                   state[2] == BW_DOF_PRESCRIBED;
  }
done:
  bw_release(dof_map);
  return status;
}

static void add_force(void *data, int32_t node, const double force[3]) {
  double *to = (double *)data + 3 * (int64_t)node;
  for (int c = 0; c < 3; c++)
    to[c] += force[c];
}

static bw_status take_attachment(bw_context *context, traction_work *w, int index) {
  bw_status status = BW_OK;
  const bw_attachment *at = &w->result->model->attachment[index];
  double factor[3], gravity[3];
  BW_TRY(reserve(context, at->on, w));
  bwi_sum_gravity(w->result->model, gravity);
  for (int c = 0; c < 3; c++)
    factor[c] = at->mass > 0 ? at->mass : -at->stiffness[c];
  bwi_attachment_apply(at, factor, at->mass > 0 ? NULL : w->result->displacement, gravity,
                       add_force, w->force);
done:
  return status;
}

static bw_status take_coupling(bw_context *context, traction_work *w, int index) {
  bw_status status = BW_OK;
  const bw_coupling *c = &w->result->model->coupling[index];
  BW_TRY(reserve(context, c->on, w));
  if (c->point.kind == BW_DISTRIBUTED)
    bwi_point_exert(c, 1, w->result->coupling[index].load, w->force);
  for (int32_t i = 0; i < c->node_count && c->point.kind == BW_RIGID; i++)
    add_force(w->force, c->node[i], w->result->joint_force + 3 * (int64_t)c->node[i]);
done:
  return status;
}

/* The directions along which a support constrains a node, -1: those of its facets. */
static int directions_of(const bw_support *support, double direction[3][3]) {
  int count = 0;
  double size = bw_norm(support->normal);
  if (support->slide && !(size > 0))
    return -1;
  for (int k = 0; k < 3; k++)
    if (support->slide ? k == 0 : support->field || support->fixed[k]) {
      for (int c = 0; c < 3; c++)
        direction[count][c] = support->slide ? support->normal[c] / size : c == k;
      count++;
    }
  return count;
}

/* Directions of one support that the others leave no part of are theirs too. */
static const double independent = 1e-6;

/* The part of the reaction at a node along the directions of the support `index`, where those of
 * all supports there are independent. False: it cannot be told, and is the whole. */
static bool divide(const bw_model *model, const uint8_t *const *constrained, int index,
                   int32_t node, double force[3]) {
  double all[3][3], square[9], part[3];
  int count = directions_of(&model->support[index], all), own = count;
  bool alone = true;
  for (int s = 0; s < model->support_count; s++) {
    double next[3][3];
    if (s == index || !constrained[s][node])
      continue;
    int more = directions_of(&model->support[s], next);
    alone = false;
    if (own < 0 || more < 0 || count + more > 3)
      return false;
    memcpy(all[count], next, (size_t)more * sizeof *next);
    count += more;
  }
  if (alone)
    return true;
  for (int i = 0; i < count; i++) {
    part[i] = bw_dot(all[i], force);
    for (int j = 0; j < count; j++)
      square[count * i + j] = bw_dot(all[i], all[j]);
  }
  if (!bwi_cholesky(count, square, independent))
    return false;
  bwi_lower_solve(count, square, part);
  bwi_upper_solve(count, square, part);
  for (int c = 0; c < 3; c++) {
    force[c] = 0;
    for (int i = 0; i < own; i++)
      force[c] += part[i] * all[i][c];
  }
  return true;
}

static bw_status take_support(bw_context *context, traction_work *w, int index,
                              bw_interface_force *sum) {
  bw_status status = BW_OK;
  const bw_model *model = w->result->model;
  int64_t nodes = w->mesh->node_count;
  uint8_t *mark = BW_NEW0(context, uint8_t, nodes * model->support_count);
  const uint8_t **constrained = BW_NEW(context, const uint8_t *, model->support_count);
  const bw_selection *on = model->support[index].on;
  BW_TRY_MEMORY(mark && constrained);
  BW_TRY(reserve(context, on, w));
  for (int s = 0; s < model->support_count; s++) {
    constrained[s] = mark + s * nodes;
    for (int32_t i = 0; i < model->support[s].on->node_count; i++)
      mark[s * nodes + model->support[s].on->node[i]] = 1;
  }
  for (int32_t i = 0; i < on->node_count; i++) {
    double *f = w->force + 3 * (int64_t)on->node[i];
    memcpy(f, w->result->reaction + 3 * (int64_t)on->node[i], 3 * sizeof *f);
    sum->shared += !divide(model, constrained, index, on->node[i], f);
  }
done:
  bw_free(mark);
  bw_free(constrained);
  return status;
}

/* ---- together -------------------------------------------------------------------------------- */

static bw_status check(bw_context *context, const bw_static *result, bw_joint_kind kind,
                       int index) {
  const bw_model *model = result->model;
  const struct {
    const char *name;
    int count;
    const void *force; /* NULL: not known, of a transient or a whole wheel */
  } of[] = {[BW_JOINT_BOND] = {"bond", model->bond_count, result->joint_force},
            [BW_JOINT_ATTACHMENT] = {"attachment", model->attachment_count, result->attachment},
            [BW_JOINT_COUPLING] = {"coupling", model->coupling_count, result->coupling},
            [BW_JOINT_SUPPORT] = {"support", model->support_count, result->reaction}};
  if (model->object.revision != result->revision)
    return bw_fail(context, BW_INVALID,
                   "the model has changed since this solution, and tractions need its joints and "
                   "supports: take them before, or solve it again");
  if (index < 0 || index >= of[kind].count)
    return bw_fail(context, BW_INVALID, "%s %d of a model with %d %s%s", of[kind].name, index + 1,
                   of[kind].count, of[kind].name, of[kind].count == 1 ? "" : "s");
  if (!of[kind].force)
    return bw_fail(context, BW_UNSUPPORTED,
                   "this solution has no forces of %ss: it is an instant of a transient, or the "
                   "whole of a sector. Solve its model",
                   of[kind].name);
  const bw_selection *on = kind == BW_JOINT_BOND         ? model->bond[index].a
                           : kind == BW_JOINT_ATTACHMENT ? model->attachment[index].on
                           : kind == BW_JOINT_COUPLING   ? model->coupling[index].on
                                                         : model->support[index].on;
  if (on->facet_count == 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   "%s %d is on %d nodes without facets, and a traction needs an area: its force "
                   "alone is known",
                   of[kind].name, index + 1, on->node_count);
  for (int32_t i = 0; kind == BW_JOINT_SUPPORT && model->cyclic && i < on->node_count; i++)
    if (model->cyclic->partner[on->node[i]] >= 0)
      return bw_fail(context, BW_UNSUPPORTED,
                     "support %d meets a cut face of the sector, where the reaction is of two "
                     "sectors: take the traction of the whole of this solution",
                     index + 1);
  return BW_OK;
}

bw_status bw_joint_traction(bw_context *context, const bw_static *result, bw_joint_kind kind,
                            int index, double *traction, double *normal, double *shear,
                            bw_interface_force *sum) {
  bw_status status = BW_OK;
  traction_work w = {.result = result, .mesh = result->model->mesh};
  *sum = (bw_interface_force){0};
  BW_TRY(check(context, result, kind, index));
  switch (kind) {
  case BW_JOINT_BOND:
    BW_TRY(take_bond(context, &w, index, sum));
    break;
  case BW_JOINT_ATTACHMENT:
    BW_TRY(take_attachment(context, &w, index));
    break;
  case BW_JOINT_COUPLING:
    BW_TRY(take_coupling(context, &w, index));
    break;
  case BW_JOINT_SUPPORT:
    BW_TRY(take_support(context, &w, index, sum));
    break;
  }
  if (kind != BW_JOINT_BOND)
    sum->area = bwi_nodal_traction_integrate(&w.facets);
  for (int32_t i = 0; i < w.on->node_count; i++) {
    const double *f = w.force + 3 * (int64_t)w.on->node[i];
    double moment[3];
    bw_cross(w.mesh->node + 3 * (int64_t)w.on->node[i], f, moment);
    for (int c = 0; c < 3; c++) {
      sum->force[c] += f[c];
      sum->moment[c] += moment[c];
    }
  }
  bwi_nodal_traction_write(&w.facets, w.force, traction, normal, shear);
done:
  bwi_nodal_traction_clear(&w.facets);
  bw_free(w.facet);
  bw_free(w.force);
  return status;
}
