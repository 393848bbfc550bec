/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tractions between two regions, from the nodal forces of their elements
 * (docs/theory/elements.md#interface-tractions). */
#include <math.h>
#include <string.h>

#include "analysis/nodal_traction.h"
#include "assemble/internal.h"
#include "model/internal.h"

typedef struct interface_work {
  const bw_static *result;
  const bw_mesh *mesh;
  bw_mesh_interface interface;
  bwi_nodal_traction facets;
  uint8_t *on;      /* (node_count) on the interface */
  uint8_t *shared;  /* (node_count) a third region, a support or a joint, too */
  uint8_t *element; /* (element_count) of one region, with a node on the interface */
  double *side[2];  /* (N, node_count x 3) K u - f of the elements of region a, of region b */
  double *load;     /* (N, node_count x 3) */
} interface_work;

static bw_status reserve(bw_context *context, interface_work *w) {
  bw_status status = BW_OK;
  int64_t nodes = w->mesh->node_count;
  w->on = BW_NEW0(context, uint8_t, nodes);
  w->shared = BW_NEW0(context, uint8_t, nodes);
  w->element = BW_NEW0(context, uint8_t, w->mesh->element_count);
  w->side[0] = BW_NEW0(context, double, 3 * nodes);
  w->side[1] = BW_NEW0(context, double, 3 * nodes);
  w->load = BW_NEW0(context, double, 3 * nodes);
  BW_TRY_MEMORY(w->on && w->shared && w->element && w->side[0] && w->side[1] && w->load);
  BW_TRY(bwi_nodal_traction_open(context, w->mesh, w->interface.count, w->interface.facet,
                                 &w->facets));
done:
  return status;
}

static void clear(interface_work *w) {
  bw_mesh_interface_clear(&w->interface);
  bw_free(w->on);
  bw_free(w->shared);
  bw_free(w->element);
  bw_free(w->side[0]);
  bw_free(w->side[1]);
  bw_free(w->load);
  bwi_nodal_traction_clear(&w->facets);
}

/* Adds K_e u_e at all nodes of an element. */
static bw_status add_element(bw_context *context, const interface_work *w, int32_t e,
                             double *force) {
  const bw_mesh *mesh = w->mesh;
  const int32_t *node = mesh->element + (int64_t)e * mesh->nodes_per_element;
  int size = 3 * mesh->nodes_per_element;
  double x[10][3], stiffness[30 * 30];
  bwi_element_nodes(mesh, e, x);
  bw_status status = bw_element_stiffness(context, mesh->order, (const double(*)[3])x,
                                          bw_material_of(w->result->model->material, e), stiffness);
  for (int i = 0; i < size && status == BW_OK; i++)
    for (int j = 0; j < size; j++)
      force[3 * (int64_t)node[i / 3] + i % 3] +=
          stiffness[i * size + j] * w->result->displacement[3 * (int64_t)node[j / 3] + j % 3];
  return status;
}

/* What the elements of a region exert, less the loads on them. Right at the interface alone. */
static bw_status find_side(bw_context *context, interface_work *w, int32_t region, double *force) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = w->mesh;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (int64_t)e * mesh->nodes_per_element;
    w->element[e] = 0;
    for (int a = 0; a < mesh->nodes_per_element && mesh->region[e] == region; a++)
      w->element[e] |= w->on[node[a]];
    if (e % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    if (w->element[e])
      BW_TRY(add_element(context, w, e, force));
  }
  BW_TRY(bwi_force_of_elements(context, w->result->model, w->element, w->load));
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    force[i] -= w->load[i];
done:
  return status;
}

/* Marks nodes that a third region has. */
static void find_thirds(interface_work *w, int32_t a, int32_t b) {
  const bw_mesh *mesh = w->mesh;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < mesh->nodes_per_element && mesh->region[e] != a && mesh->region[e] != b;
         k++) {
      int32_t i = mesh->element[(int64_t)e * mesh->nodes_per_element + k];
      w->shared[i] |= w->on[i];
    }
}

static void mark_selection(const interface_work *w, const bw_selection *on) {
  for (int32_t i = 0; i < on->node_count; i++)
    w->shared[on->node[i]] |= w->on[on->node[i]];
}

/* Marks nodes at which a joint acts. */
static void find_joints(const interface_work *w) {
  const bw_model *model = w->result->model;
  for (int i = 0; i < model->bond_count; i++) {
    mark_selection(w, model->bond[i].a);
    mark_selection(w, model->bond[i].b);
  }
  for (int i = 0; i < model->attachment_count; i++)
    mark_selection(w, model->attachment[i].on);
  for (int i = 0; i < model->coupling_count; i++)
    mark_selection(w, model->coupling[i].on);
}

/* side[0] becomes the force of region b on region a: half of the difference, so that what else acts
 * on a node is shared evenly, and nothing along what a support prescribes. */
static void transmit(interface_work *w, const bw_dof_map *dof_map, bw_interface_force *sum) {
  double lack = 0, whole = 0;
  for (int64_t i = 0; i < w->mesh->node_count; i++) {
    double *f = w->side[0] + 3 * i, moment[3], missing[3];
    if (!w->on[i])
      continue;
    for (int k = 0; k < 3; k++) {
      missing[k] = f[k] + w->side[1][3 * i + k];
      f[k] = 0.5 * (f[k] - w->side[1][3 * i + k]);
    }
    for (int k = 0; k < 3; k++) {
      if (dof_map->state[3 * i + k] != BW_DOF_PRESCRIBED)
        continue;
      double along[3] = {k == 0, k == 1, k == 2};
      if (dof_map->frame_of[i] >= 0)
        memcpy(along, dof_map->frame + 9 * (int64_t)dof_map->frame_of[i] + 3 * k, sizeof along);
      double part = bw_dot(along, f);
      for (int c = 0; c < 3; c++)
        f[c] -= part * along[c];
      w->shared[i] = 1;
    }
    sum->shared += w->shared[i];
    if (!w->shared[i]) {
      lack += bw_norm(missing);
      whole += bw_norm(f);
    }
    bw_cross(w->mesh->node + 3 * i, f, moment);
    for (int k = 0; k < 3; k++) {
      sum->force[k] += f[k];
      sum->moment[k] += moment[k];
    }
  }
  sum->imbalance = whole > 0 ? lack / whole : 0;
}

/* Loads of an instant of a motion have inertia, damping and factors of time, which the elements of
 * a region are not known to take. */
static bw_status check_loads(bw_context *context, const interface_work *w) {
  double off = 0, largest = 0;
  bw_status status = bw_model_force_vector(context, w->result->model, w->load);
  for (int64_t i = 0; status == BW_OK && i < 3 * (int64_t)w->mesh->node_count; i++) {
    off = fmax(off, fabs(w->result->force[i] - w->load[i]));
    largest = fmax(largest, fabs(w->result->force[i]));
  }
  if (off > 1e-9 * largest)
    status = bw_fail(context, BW_UNSUPPORTED,
                     "this solution has other loads than its model: it is an instant of a "
                     "transient, with inertia and factors of time. Solve the model");
  return status;
}

bw_status bw_interface_traction(bw_context *context, const bw_static *result, int32_t a, int32_t b,
                                double *traction, double *normal, double *shear,
                                bw_interface_force *sum) {
  interface_work w = {.result = result, .mesh = result->model->mesh};
  bw_dof_map *dof_map = NULL;
  bw_status status;
  *sum = (bw_interface_force){0};
  if (result->model->object.revision != result->revision)
    return bw_fail(context, BW_INVALID,
                   "the model has changed since this solution, and tractions need its loads and "
                   "supports: take them before, or solve it again");
  BW_TRY(bw_mesh_interface_find(context, w.mesh, a, b, &w.interface));
  if (result->model->cyclic)
    BW_TRY(bw_model_refuse_joints(context, result->model));
  BW_TRY(bwi_dof_map_apart(context, result->model, &dof_map));
  BW_TRY(reserve(context, &w));
  BW_TRY(check_loads(context, &w));
  for (int64_t i = 0; i < (int64_t)w.interface.count * w.mesh->nodes_per_facet; i++)
    w.on[w.interface.facet[i]] = 1;
  BW_TRY(find_side(context, &w, a, w.side[0]));
  BW_TRY(find_side(context, &w, b, w.side[1]));
  find_thirds(&w, a, b);
  find_joints(&w);
  transmit(&w, dof_map, sum);
  sum->area = bwi_nodal_traction_integrate(&w.facets);
  bwi_nodal_traction_write(&w.facets, w.side[0], traction, normal, shear);
done:
  bw_release(dof_map);
  clear(&w);
  return status;
}
