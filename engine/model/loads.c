/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Consistent nodal forces of loads: f_i = integral N_i t over the facets, or N_i rho g over the
 * volume. The shape functions sum to one and reproduce positions, so the nodal forces have the
 * resultant and the moment of the traction itself. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

/* A surface load as traction t(x) = constant + spin x (x - about) - pressure * normal. */
typedef struct surface_load {
  bool varies; /* spin is not zero */
  double pressure, constant[3], spin[3], about[3];
} surface_load;

/* Area and, about a point, integral of |y|^2 1 - y y^T over the selection. */
static void area_moments(const bw_selection *on, const double about[3], double *area,
                         double inertia[9]) {
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  *area = 0;
  memset(inertia, 0, 9 * sizeof *inertia);
  for (int32_t f = 0; f < on->facet_count; f++) {
    int count = bwi_boundary_points(on->mesh, on->facet[f], point);
    for (int p = 0; p < count; p++) {
      double size = bw_norm(point[p].area), y[3];
      for (int k = 0; k < 3; k++)
        y[k] = point[p].at[k] - about[k];
      *area += size;
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          inertia[3 * k + l] += size * ((k == l ? bw_dot(y, y) : 0) - y[k] * y[l]);
    }
  }
}

static bw_status prepare(bw_context *context, const bw_load *load, surface_load *surface) {
  memset(surface, 0, sizeof *surface);
  switch (load->kind) {
  case BW_LOAD_PRESSURE:
    surface->pressure = load->vector[0];
    break;
  case BW_LOAD_TRACTION:
    memcpy(surface->constant, load->vector, sizeof surface->constant);
    break;
  case BW_LOAD_FORCE: {
    double area = bw_selection_area(load->on);
    if (!(area > 0))
      return bw_fail(context, BW_GEOMETRY, "the %d facets that a force acts on have no area",
                     load->on->facet_count);
    for (int k = 0; k < 3; k++)
      surface->constant[k] = load->vector[k] / area;
    break;
  }
  case BW_LOAD_TORQUE: {
    /* Moment of t = spin x y: integral y x (spin x y) = inertia spin. */
    double area, inertia[9], inverse[9];
    surface->varies = true;
    memcpy(surface->about, load->about, sizeof surface->about);
    area_moments(load->on, load->about, &area, inertia);
    double trace = inertia[0] + inertia[4] + inertia[8];
    if (!(trace > 0) || !(bw_inverse3(inertia, inverse) > 1e-12 * trace * trace * trace))
      return bw_fail(
          context, BW_GEOMETRY,
          "the %d facets that a torque acts on have no lever arm about its point: choose a "
          "wider selection",
          load->on->facet_count);
    for (int k = 0; k < 3; k++)
      surface->spin[k] = bw_dot(inverse + 3 * k, load->vector);
    break;
  }
  default:
    return bw_fail(context, BW_INTERNAL, "load kind %d does not act on a surface", (int)load->kind);
  }
  return BW_OK;
}

/* Nodal forces of one facet. */
static void facet_force(const bw_mesh *mesh, const surface_load *load, int32_t facet,
                        double (*force)[3]) {
  memset(force, 0, (size_t)mesh->nodes_per_facet * sizeof *force);
  if (!load->varies && bwi_boundary_is_straight(mesh, facet)) {
    /* Integral N: a third of the area at each corner (order 1), at each mid-edge node (order 2). */
    double normal[3], middle[3] = {1. / 3, 1. / 3, 1. / 3};
    bwi_boundary_normal(mesh, facet, middle, normal);
    double area = bw_norm(normal) / 2;
    for (int a = 0; a < 3; a++)
      for (int k = 0; k < 3; k++)
        force[mesh->order == 1 ? a : 3 + a][k] =
            (load->constant[k] * area - load->pressure * normal[k] / 2) / 3;
    return;
  }
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  int count = bwi_boundary_points(mesh, facet, point);
  for (int p = 0; p < count; p++) {
    double y[3], traction[3], size = bw_norm(point[p].area);
    for (int k = 0; k < 3; k++)
      y[k] = point[p].at[k] - load->about[k];
    bw_cross(load->spin, y, traction);
    for (int k = 0; k < 3; k++)
      traction[k] = (traction[k] + load->constant[k]) * size - load->pressure * point[p].area[k];
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int k = 0; k < 3; k++)
        force[a][k] += point[p].shape[a] * traction[k];
  }
}

/* Calls `add` with the part of a load at every node, facet by facet or element by element. Of the
 * elements marked in `only` alone, unless it is NULL. */
static bw_status spread(bw_context *context, const bw_model *model, const bw_load *load,
                        const uint8_t *only, bwi_add_force *add, void *data) {
  const bw_mesh *mesh = model->mesh;
  bw_status status = BW_OK;
  switch (load->kind) {
  case BW_LOAD_GRAVITY:
    for (int32_t e = 0; e < mesh->element_count; e++) {
      const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
      double x[10][3], moment[10][4];
      if (e % 65536 == 0)
        BW_TRY(bw_check_cancel(context));
      if (only && !only[e])
        continue;
      for (int a = 0; a < mesh->nodes_per_element; a++)
        memcpy(x[a], mesh->node + 3 * (size_t)node[a], sizeof x[a]);
      bwi_element_moments(mesh->order, (const double(*)[3])x, mesh->volume[e], moment);
      for (int a = 0; a < mesh->nodes_per_element; a++) {
        double mass = bw_material_of(model->material, e)->density * moment[a][0];
        double force[3] = {mass * load->vector[0], mass * load->vector[1], mass * load->vector[2]};
        add(data, node[a], force);
      }
    }
    for (int i = 0; i < model->attachment_count && !only; i++) {
      const bw_attachment *at = &model->attachment[i];
      if (at->mass > 0)
        bwi_attachment_apply(at, (double[3]){at->mass, at->mass, at->mass}, NULL, load->vector, add,
                             data);
    }
    break;
  case BW_LOAD_NODAL:
    for (int32_t i = 0; i < mesh->node_count && !only; i++) {
      double force[3];
      for (int k = 0; k < 3; k++)
        force[k] = bw_array_get(load->nodal, i, k);
      add(data, i, force);
    }
    break;
  case BW_LOAD_TEMPERATURE:
    for (int32_t e = 0; e < mesh->element_count; e++) {
      const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
      double force[10][3];
      if (e % 65536 == 0)
        BW_TRY(bw_check_cancel(context));
      if (only && !only[e])
        continue;
      bwi_thermal_force(model, load, e, force);
      for (int a = 0; a < mesh->nodes_per_element; a++)
        add(data, node[a], force[a]);
    }
    break;
  default: {
    surface_load surface;
    BW_TRY(prepare(context, load, &surface));
    for (int32_t f = 0; f < load->on->facet_count; f++) {
      int32_t facet = load->on->facet[f];
      double force[6][3];
      if (only && !only[mesh->facet_element[facet]])
        continue;
      facet_force(mesh, &surface, facet, force);
      for (int a = 0; a < mesh->nodes_per_facet; a++)
        add(data, mesh->facet[(size_t)facet * (size_t)mesh->nodes_per_facet + (size_t)a], force[a]);
    }
  }
  }
done:
  return status;
}

typedef struct sums {
  const bw_mesh *mesh;
  double resultant[3], moment[3];
} sums;

static void add_sums(void *data, int32_t node, const double force[3]) {
  sums *s = (sums *)data;
  double moment[3];
  bw_cross(s->mesh->node + 3 * (size_t)node, force, moment);
  for (int k = 0; k < 3; k++) {
    s->resultant[k] += force[k];
    s->moment[k] += moment[k];
  }
}

bw_status bwi_load_measure(bw_context *context, const bw_model *model, bw_load *load) {
  sums s = {.mesh = model->mesh};
  bw_status status = spread(context, model, load, NULL, add_sums, &s);
  if (status != BW_OK)
    return status;
  for (int i = 0; i < model->coupling_count && load->kind == BW_LOAD_GRAVITY; i++) {
    const bw_remote_point *point = &model->coupling[i].point;
    double weight[3], moment[3];
    for (int k = 0; k < 3; k++)
      weight[k] = point->mass * load->vector[k];
    bw_cross(point->at, weight, moment);
    for (int k = 0; k < 3; k++) {
      s.resultant[k] += weight[k];
      s.moment[k] += moment[k];
    }
  }
  load->area = load->on ? bw_selection_area(load->on) : 0;
  memcpy(load->resultant, s.resultant, sizeof load->resultant);
  memcpy(load->moment, s.moment, sizeof load->moment);
  return BW_OK;
}

static void add_vector(void *data, int32_t node, const double force[3]) {
  double *f = (double *)data + 3 * (size_t)node;
  for (int k = 0; k < 3; k++)
    f[k] += force[k];
}

bw_status bwi_force_vector(bw_context *context, const bw_model *model, bool volume, double *force) {
  memset(force, 0, 3 * sizeof *force * (size_t)model->mesh->node_count);
  for (int i = 0; i < model->load_count; i++) {
    bw_load_kind kind = model->load[i].kind;
    if (!volume && (kind == BW_LOAD_GRAVITY || kind == BW_LOAD_TEMPERATURE))
      continue;
    bw_status status = spread(context, model, &model->load[i], NULL, add_vector, force);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

void bwi_sum_gravity(const bw_model *model, double gravity[3]) {
  memset(gravity, 0, 3 * sizeof *gravity);
  for (int i = 0; i < model->load_count; i++)
    for (int c = 0; c < 3 && model->load[i].kind == BW_LOAD_GRAVITY; c++)
      gravity[c] += model->load[i].vector[c];
}

bw_status bwi_load_force(bw_context *context, const bw_model *model, const bw_load *load,
                         double *force) {
  memset(force, 0, 3 * sizeof *force * (size_t)model->mesh->node_count);
  return spread(context, model, load, NULL, add_vector, force);
}

bw_status bwi_force_of_elements(bw_context *context, const bw_model *model, const uint8_t *only,
                                double *force) {
  bw_status status = BW_OK;
  memset(force, 0, 3 * sizeof *force * (size_t)model->mesh->node_count);
  for (int i = 0; i < model->load_count && status == BW_OK; i++)
    status = spread(context, model, &model->load[i], only, add_vector, force);
  return status;
}

bw_status bw_model_force_vector(bw_context *context, const bw_model *model, double *force) {
  return bwi_force_vector(context, model, true, force);
}
