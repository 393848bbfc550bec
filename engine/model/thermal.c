/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Thermal expansion: sigma = C : (epsilon - alpha dT 1), with the change of temperature dT between
 * the nodes by the element's shape functions. The second part moves to the loads,
 * f_a = integral (C : alpha dT 1) grad N_a, and is taken off the stress afterwards. */
#include <string.h>

#include "model/internal.h"

bool bwi_model_expands(const bw_model *model) {
  for (int i = 0; i < model->load_count; i++)
    if (model->load[i].kind == BW_LOAD_TEMPERATURE)
      return true;
  return false;
}

/* C : 1, the stress per unit of expansion. */
static void unit_stress(const bw_material *material, int64_t element, double stress[6]) {
  for (int i = 0; i < 6; i++) {
    const double *row = bw_material_elasticity(material, element) + 6 * i;
    stress[i] = row[0] + row[1] + row[2];
  }
}

/* Quadrature exact for the thermal force of straight elements: dT of the order times grad N. */
static int points_of(int order, double (*point)[4], double *weight) {
  return bw_tet_quadrature(order == 1 ? 1 : 4, point, weight);
}

static double change_at(const bw_mesh *mesh, const bw_load *load, const int32_t *node,
                        const double at[4]) {
  double shape[10], change = 0;
  bw_tet_shape(mesh->order, at, shape);
  for (int a = 0; a < mesh->nodes_per_element; a++)
    change += shape[a] * bw_array_get(load->nodal, node[a], 0);
  return change;
}

/* The bulk modulus that acts on the mean of the volumetric strain, thermal strain included. */
static double projected_bulk(const bw_model *model) {
  return model->mesh->order == 2 ? bw_material_projected_bulk(model->material) : 0;
}

/* The mean of the change over an element. */
static double mean_change(const bw_mesh *mesh, const bw_load *load, int32_t element) {
  const int32_t *node = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
  double x[10][3], point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], sum = 0, whole = 0;
  for (int a = 0; a < mesh->nodes_per_element; a++)
    memcpy(x[a], mesh->node + 3 * (size_t)node[a], sizeof x[a]);
  int points = bw_tet_quadrature(5, point, weight);
  for (int q = 0; q < points; q++) {
    double slope[10][3];
    double volume =
        weight[q] * bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope);
    sum += volume * change_at(mesh, load, node, point[q]);
    whole += volume;
  }
  return sum / whole;
}

void bwi_thermal_force(const bw_model *model, const bw_load *load, int32_t element,
                       double (*force)[3]) {
  const bw_mesh *mesh = model->mesh;
  int nodes = mesh->nodes_per_element;
  const int32_t *node = mesh->element + (size_t)element * (size_t)nodes;
  double x[10][3], unit[6], point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  for (int a = 0; a < nodes; a++)
    memcpy(x[a], mesh->node + 3 * (size_t)node[a], sizeof x[a]);
  memset(force, 0, (size_t)nodes * sizeof *force);
  unit_stress(model->material, element, unit);
  double projected = 3 * projected_bulk(model); /* per unit of expansion */
  double mean = projected > 0 ? mean_change(mesh, load, element) : 0;
  int points = points_of(mesh->order, point, weight);
  for (int q = 0; q < points; q++) {
    double slope[10][3];
    double volume = bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope) / 6;
    double change = change_at(mesh, load, node, point[q]);
    double size = weight[q] * volume * load->expansion * change;
    double shift = weight[q] * volume * load->expansion * projected * (mean - change);
    for (int a = 0; a < nodes; a++) {
      const double *g = slope[a];
      force[a][0] += size * (unit[0] * g[0] + unit[5] * g[1] + unit[4] * g[2]) + shift * g[0];
      force[a][1] += size * (unit[5] * g[0] + unit[1] * g[1] + unit[3] * g[2]) + shift * g[1];
      force[a][2] += size * (unit[4] * g[0] + unit[3] * g[1] + unit[2] * g[2]) + shift * g[2];
    }
  }
}

/* C : 1 at nodes, the mean of the elements around each, as the stresses there are averaged. */
static bw_status nodal_units(bw_context *context, const bw_model *model, double **out) {
  const bw_mesh *mesh = model->mesh;
  size_t nodes = (size_t)mesh->node_count;
  double *mean = BW_NEW0(context, double, 6 * nodes), *volume = BW_NEW0(context, double, nodes);
  if (!mean || !volume) {
    bw_free(mean);
    bw_free(volume);
    return BW_MEMORY;
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * mesh->nodes_per_element;
    double unit[6];
    unit_stress(model->material, e, unit);
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      volume[node[a]] += mesh->volume[e];
      for (int k = 0; k < 6; k++)
        mean[6 * (size_t)node[a] + (size_t)k] += mesh->volume[e] * unit[k];
    }
  }
  for (size_t i = 0; i < 6 * nodes; i++)
    mean[i] = volume[i / 6] > 0 ? mean[i] / volume[i / 6] : 0;
  bw_free(volume);
  *out = mean;
  return BW_OK;
}

/* What the projection adds at nodes: the means of the elements around each, weighted by volume. */
static bw_status add_projected(bw_context *context, const bw_model *model, const bw_load *load,
                               double *stress) {
  const bw_mesh *mesh = model->mesh;
  double unit = 3 * projected_bulk(model) * load->expansion;
  double *sum = BW_NEW0(context, double, mesh->node_count);
  double *volume = BW_NEW0(context, double, mesh->node_count);
  for (int32_t e = 0; sum && volume && e < mesh->element_count; e++) {
    double mean = mean_change(mesh, load, e);
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t node = mesh->element[(size_t)e * (size_t)mesh->nodes_per_element + (size_t)a];
      volume[node] += mesh->volume[e];
      sum[node] += mesh->volume[e] * (mean - bw_array_get(load->nodal, node, 0));
    }
  }
  for (int32_t i = 0; sum && volume && i < mesh->node_count; i++)
    for (int k = 0; k < 3 && volume[i] > 0; k++)
      stress[6 * (size_t)i + (size_t)k] += unit * sum[i] / volume[i];
  bw_status status = sum && volume ? BW_OK : BW_MEMORY;
  bw_free(sum);
  bw_free(volume);
  return status;
}

bw_status bw_model_thermal_stress(bw_context *context, const bw_model *model, bool on_nodes,
                                  double *stress) {
  const bw_mesh *mesh = model->mesh;
  int32_t count = on_nodes ? mesh->node_count : mesh->element_count;
  double unit[6], point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  double *by_node = NULL; /* where the material is rotated by element */
  bool rotated = model->material->orientations != NULL;
  bw_status status = BW_OK;
  if (rotated && on_nodes)
    BW_TRY(nodal_units(context, model, &by_node));
  unit_stress(model->material, 0, unit);
  int points = points_of(mesh->order, point, weight);
  memset(stress, 0, (size_t)count * 6 * sizeof *stress);
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    if (load->kind != BW_LOAD_TEMPERATURE)
      continue;
    if (on_nodes && projected_bulk(model) > 0)
      BW_TRY(add_projected(context, model, load, stress));
    for (int32_t i = 0; i < count; i++) {
      double change = 0;
      if (i % 65536 == 0)
        BW_TRY(bw_check_cancel(context));
      if (rotated && on_nodes)
        memcpy(unit, by_node + 6 * (size_t)i, sizeof unit);
      else if (rotated)
        unit_stress(model->material, i, unit);
      if (on_nodes)
        change = bw_array_get(load->nodal, i, 0);
      else
        for (int q = 0; q < points; q++)
          change +=
              weight[q] * change_at(mesh, load,
                                    mesh->element + (size_t)i * (size_t)mesh->nodes_per_element,
                                    point[q]);
      for (int k = 0; k < 6; k++)
        stress[6 * (size_t)i + (size_t)k] += load->expansion * change * unit[k];
    }
  }
done:
  bw_free(by_node);
  return status;
}
