/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tractions between two regions, from the nodal forces of their elements
 * (docs/theory/elements.md#interface-tractions). */
#include <math.h>
#include <string.h>

#include "assemble/internal.h"
#include "barwright/analysis.h"
#include "model/internal.h"

typedef struct interface_work {
  const bw_static *result;
  const bw_mesh *mesh;
  bw_mesh_interface interface;
  uint8_t *on;      /* (node_count) on the interface */
  uint8_t *shared;  /* (node_count) a third region or a support, too */
  uint8_t *element; /* (element_count) of one region, with a node on the interface */
  double *side[2];  /* (N, node_count x 3) K u - f of the elements of region a, of region b */
  double *load;     /* (N, node_count x 3) */
  double *area;     /* (m2, node_count) integral of the hat function of a corner */
  double *normal;   /* (m2, node_count x 3) integral of hat function times normal, towards b */
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
  w->area = BW_NEW0(context, double, nodes);
  w->normal = BW_NEW0(context, double, 3 * nodes);
  BW_TRY_MEMORY(w->on && w->shared && w->element && w->side[0] && w->side[1] && w->load &&
                w->area && w->normal);
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
  bw_free(w->area);
  bw_free(w->normal);
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

/* Areas and normals of the hat functions of corners, phi_k = N_k + half of its edges' N. */
static void integrate_hats(interface_work *w, bw_interface_force *sum) {
  const bw_mesh *mesh = w->mesh;
  sum->area = 0;
  for (int32_t f = 0; f < w->interface.count; f++) {
    const int32_t *node = w->interface.facet + (int64_t)f * mesh->nodes_per_facet;
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int count = bwi_facet_points(mesh, node, point);
    for (int p = 0; p < count; p++) {
      const double *shape = point[p].shape;
      double size = bw_norm(point[p].area);
      sum->area += size;
      for (int k = 0; k < 3; k++) {
        double hat = shape[k];
        if (mesh->order == 2)
          hat += 0.5 * (shape[3 + k] + shape[3 + (k + 2) % 3]);
        w->area[node[k]] += hat * size;
        for (int c = 0; c < 3; c++)
          w->normal[3 * (int64_t)node[k] + c] += hat * point[p].area[c];
      }
    }
  }
}

/* Adds half of the force of each mid-edge node to its ends, once for an edge: `on` is cleared. */
static void gather_at_corners(interface_work *w) {
  const bw_mesh *mesh = w->mesh;
  for (int32_t f = 0; f < w->interface.count && mesh->order == 2; f++) {
    const int32_t *node = w->interface.facet + (int64_t)f * mesh->nodes_per_facet;
    for (int k = 0; k < 3; k++) {
      int64_t middle = node[3 + k];
      for (int c = 0; c < 3 && w->on[middle]; c++) {
        w->side[0][3 * (int64_t)node[k] + c] += 0.5 * w->side[0][3 * middle + c];
        w->side[0][3 * (int64_t)node[(k + 1) % 3] + c] += 0.5 * w->side[0][3 * middle + c];
      }
      w->on[middle] = 0;
    }
  }
}

static void write_fields(const interface_work *w, double *traction, double *normal, double *shear) {
  const bw_mesh *mesh = w->mesh;
  for (int64_t i = 0; i < mesh->node_count; i++) {
    double *t = traction + 3 * i, size = bw_norm(w->normal + 3 * i), along[3];
    if (!(w->area[i] > 0))
      continue;
    for (int k = 0; k < 3; k++)
      t[k] = w->side[0][3 * i + k] / w->area[i];
    normal[i] = size > 0 ? bw_dot(t, w->normal + 3 * i) / size : 0;
    for (int k = 0; k < 3; k++)
      along[k] = t[k] - (size > 0 ? normal[i] * w->normal[3 * i + k] / size : 0);
    shear[i] = bw_norm(along);
  }
  for (int32_t f = 0; f < w->interface.count && mesh->order == 2; f++) {
    const int32_t *node = w->interface.facet + (int64_t)f * mesh->nodes_per_facet;
    for (int k = 0; k < 3; k++) {
      int64_t middle = node[3 + k], a = node[k], b = node[(k + 1) % 3];
      for (int c = 0; c < 3; c++)
        traction[3 * middle + c] = 0.5 * (traction[3 * a + c] + traction[3 * b + c]);
      normal[middle] = 0.5 * (normal[a] + normal[b]);
      shear[middle] = 0.5 * (shear[a] + shear[b]);
    }
  }
}

bw_status bw_interface_traction(bw_context *context, const bw_static *result, int32_t a, int32_t b,
                                double *traction, double *normal, double *shear,
                                bw_interface_force *sum) {
  interface_work w = {.result = result, .mesh = result->model->mesh};
  bw_dof_map *dof_map = NULL;
  size_t nodes = (size_t)w.mesh->node_count;
  bw_status status;
  *sum = (bw_interface_force){0};
  memset(traction, 0, 3 * nodes * sizeof *traction);
  memset(normal, 0, nodes * sizeof *normal);
  memset(shear, 0, nodes * sizeof *shear);
  if (result->model->object.revision != result->revision)
    return bw_fail(context, BW_INVALID,
                   "the model has changed since this solution, and tractions need its loads and "
                   "supports: take them before, or solve it again");
  BW_TRY(bw_mesh_interface_find(context, w.mesh, a, b, &w.interface));
  BW_TRY(bw_dof_map_create(context, result->model, &dof_map));
  BW_TRY(reserve(context, &w));
  for (int64_t i = 0; i < (int64_t)w.interface.count * w.mesh->nodes_per_facet; i++)
    w.on[w.interface.facet[i]] = 1;
  BW_TRY(find_side(context, &w, a, w.side[0]));
  BW_TRY(find_side(context, &w, b, w.side[1]));
  find_thirds(&w, a, b);
  transmit(&w, dof_map, sum);
  integrate_hats(&w, sum);
  gather_at_corners(&w);
  write_fields(&w, traction, normal, shear);
done:
  bw_release(dof_map);
  clear(&w);
  return status;
}
