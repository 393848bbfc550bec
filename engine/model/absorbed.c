/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Loads that go straight into the supports. Such a load does no work, and a static solution that
 * leaves it out of account looks safe: zero stress. Most often a coordinate has the wrong unit, and
 * a support covers more than was meant. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

/* A force is absorbed where its part along free components is below this fraction of it. */
static const double absorbed_fraction = 1e-9;
/* A load of which this fraction of the area lies on supports is a warning. */
static const double warning_fraction = 0.05;

/* The part of a nodal force along components that are not constrained. */
static double free_part(const bw_dof_map *dof_map, int32_t node, const double force[3]) {
  const uint8_t *state = dof_map->state + 3 * (size_t)node;
  int32_t row = dof_map->frame_of[node];
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double along =
        row < 0 ? force[c] : bw_dot(dof_map->frame + 9 * (size_t)row + 3 * (size_t)c, force);
    sum += state[c] == BW_DOF_PRESCRIBED ? 0 : along * along;
  }
  return sqrt(sum);
}

/* Whether every unit force on this node goes into the supports. */
static bool is_fixed(const bw_dof_map *dof_map, int32_t node) {
  const uint8_t *state = dof_map->state + 3 * (size_t)node;
  return state[0] == BW_DOF_PRESCRIBED && state[1] == BW_DOF_PRESCRIBED &&
         state[2] == BW_DOF_PRESCRIBED;
}

static double facet_size(const bw_mesh *mesh, int32_t facet) {
  double middle[3] = {1. / 3, 1. / 3, 1. / 3}, normal[3];
  bwi_boundary_normal(mesh, facet, middle, normal);
  return bw_norm(normal) / 2;
}

/* The fraction of a load that the supports take: of its area, where all nodes of a facet pass their
 * force on; of the sum of forces for nodal loads. 0 for a load without force. */
static double fraction_of(const bw_dof_map *dof_map, const bw_load *load, const double *force) {
  const bw_mesh *mesh = dof_map->mesh;
  double whole = 0, absorbed = 0, total = 0, loose = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    total += bw_norm(force + 3 * (size_t)i);
    loose += free_part(dof_map, i, force + 3 * (size_t)i);
  }
  if (!(total > 0))
    return 0;
  if (loose <= absorbed_fraction * total)
    return 1;
  for (int32_t f = 0; load->on && f < load->on->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)load->on->facet[f] * (size_t)mesh->nodes_per_facet;
    double size = facet_size(mesh, load->on->facet[f]);
    bool all = true;
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      const double *at_node = force + 3 * (size_t)node[a];
      all = all && (bw_norm(at_node) > 0 ? free_part(dof_map, node[a], at_node) <=
                                               absorbed_fraction * bw_norm(at_node)
                                         : is_fixed(dof_map, node[a]));
    }
    whole += size;
    absorbed += all ? size : 0;
  }
  return whole > 0 ? fmin(absorbed / whole, 1 - absorbed_fraction) : 0;
}

static const char *kind_word(bw_load_kind kind) {
  static const char *const word[] = {"pressure", "traction",    "force",      "torque",
                                     "gravity",  "nodal force", "temperature"};
  return word[kind];
}

/* No support moves anything, and the loads cannot strain a body whose boundary is at rest. */
static bw_status check_boundary(bw_context *context, const bw_model *model,
                                const bw_dof_map *dof_map) {
  const bw_mesh *mesh = model->mesh;
  if (dof_map->prescribed)
    return BW_OK;
  for (int i = 0; i < model->load_count; i++)
    if (model->load[i].kind == BW_LOAD_TEMPERATURE || model->load[i].kind == BW_LOAD_NODAL)
      return BW_OK;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    if (!is_fixed(dof_map, mesh->boundary_node[i]))
      return BW_OK;
  bw_status status = bw_fail(context, BW_INVALID,
                             "the supports fix all %d boundary nodes: no load reaches the body. "
                             "Fix a smaller part; coordinates and tolerances are in metres",
                             mesh->boundary_node_count);
  bw_detail_number(context, "unknowns", dof_map->unknown_count);
  return status;
}

/* Whether a load acts, or a support or a remote point moves. */
static bool is_excited(const bw_model *model, const bw_dof_map *dof_map) {
  bool excited = model->load_count > 0 || dof_map->prescribed;
  for (int b = 0; b < model->bond_count; b++)
    excited = excited || model->bond[b].preload != BW_NO_PRELOAD;
  for (int p = 0; p < model->coupling_count; p++)
    for (int k = 0; k < 6; k++) {
      const bw_remote_point *point = &model->coupling[p].point;
      excited = excited || point->load[k] != 0 || (point->fixed[k] && point->displacement[k] != 0);
    }
  return excited;
}

bw_status bw_model_check_absorbed(bw_context *context, const bw_model *model,
                                  const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  double *force = NULL;
  if (!is_excited(model, dof_map))
    bw_warn(context, "no load acts and no support moves: the displacement is zero");
  if (model->support_count == 0)
    return BW_OK;
  BW_TRY(check_boundary(context, model, dof_map));
  force = BW_NEW(context, double, 3 * (size_t)model->mesh->node_count);
  BW_TRY_MEMORY(force);
  for (int i = 0; i < model->load_count; i++) {
    const bw_load *load = &model->load[i];
    if (!load->on && load->kind != BW_LOAD_NODAL)
      continue;
    BW_TRY(bwi_load_force(context, model, load, force));
    double fraction = fraction_of(dof_map, load, force);
    if (fraction == 1 && !dof_map->prescribed) {
      status =
          bw_fail(context, BW_INVALID,
                  "load %d, a %s, acts on supports only: they take its force directly and nothing "
                  "deforms. Move the load or fix less; coordinates and tolerances are in metres",
                  i + 1, kind_word(load->kind));
      bw_detail_number(context, "load", i + 1);
      goto done;
    }
    if (fraction >= warning_fraction)
      bw_warn(context,
              "%.2g %% of the area of load %d, a %s, lies on supports: the supports take that part "
              "of its force directly",
              100 * fraction, i + 1, kind_word(load->kind));
  }
done:
  bw_free(force);
  return status;
}
