/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Thermal expansion: sigma = C : (epsilon - alpha dT 1), with the change of temperature dT between
 * the nodes by the element's shape functions. The second part moves to the loads,
 * f_a = integral (C : alpha dT 1) grad N_a, and is taken off the stress afterwards. */
#include <stdio.h>
#include <string.h>

#include "model/internal.h"

bool bwi_model_expands(const bw_model *model) {
  for (int i = 0; i < model->load_count; i++)
    if (model->load[i].kind == BW_LOAD_TEMPERATURE)
      return true;
  return false;
}

double bwi_expansion(const bw_model *model, const bw_load *load, int64_t element) {
  return load->by_material ? bw_material_of(model->material, element)->expansion : load->expansion;
}

/* "the material pla of region 'low'" */
static void name_inert(const bw_mesh *mesh, const bw_material *material, int32_t element,
                       char *name, size_t size) {
  const char *own = bw_material_of(material, element)->name;
  int used = snprintf(name, size, "the material%s%s", own[0] ? " " : "", own);
  if (mesh->region && used > 0 && (size_t)used < size)
    snprintf(name + used, size - (size_t)used, " of region '%s'",
             mesh->regions[mesh->region[element]].name.text);
}

/* Regions that do not expand beside others that do may be meant so: a warning. */
bw_status bwi_check_expansion(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              const bw_array *change) {
  bw_status status = BW_OK;
  int32_t region_count = mesh->region ? mesh->region_count : 1;
  int32_t *inert = BW_NEW(context, int32_t, region_count); /* the first such element, or -1 */
  BW_TRY_MEMORY(inert);
  for (int32_t r = 0; r < region_count; r++)
    inert[r] = -1;
  bool expands = false;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    bool changes = false;
    for (int a = 0; a < mesh->nodes_per_element; a++)
      changes |= bw_array_get(change, node[a], 0) != 0;
    int32_t *first = &inert[mesh->region ? mesh->region[e] : 0];
    if (changes && bw_material_of(material, e)->expansion != 0)
      expands = true;
    else if (changes && *first < 0)
      *first = e;
  }
  for (int32_t r = 0; r < region_count; r++) {
    char name[2 * sizeof(bw_name) + 32];
    if (inert[r] < 0)
      continue;
    name_inert(mesh, material, inert[r], name, sizeof name);
    if (!expands)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "nothing expands where the temperature changes: %s has no coefficient of "
                     "expansion; give expansion (1/K)",
                     name));
    bw_warn(context,
            "%s has no coefficient of expansion: the change of temperature has no effect there; "
            "give expansion (1/K)",
            name);
  }
done:
  bw_free(inert);
  return status;
}

/* C : alpha 1, the stress per kelvin that free expansion would not have. */
static void unit_stress(const bw_model *model, const bw_load *load, int64_t element,
                        double stress[6]) {
  double expansion = bwi_expansion(model, load, element);
  for (int i = 0; i < 6; i++) {
    const double *row = bw_material_elasticity(model->material, element) + 6 * i;
    stress[i] = expansion * (row[0] + row[1] + row[2]);
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

/* The stress per kelvin that acts on the mean of the volumetric strain, thermal strain included. */
static double projected_stress(const bw_model *model, const bw_load *load, int64_t element) {
  if (model->mesh->order == 1)
    return 0;
  return 3 * bwi_expansion(model, load, element) *
         bw_material_projected_bulk(bw_material_of(model->material, element));
}

static bool projects(const bw_model *model) {
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++)
    if (bw_material_projected_bulk(bw_material_part(model->material, i)) > 0)
      return model->mesh->order == 2;
  return false;
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
  unit_stress(model, load, element, unit);
  double projected = projected_stress(model, load, element);
  double mean = projected != 0 ? mean_change(mesh, load, element) : 0;
  int points = points_of(mesh->order, point, weight);
  for (int q = 0; q < points; q++) {
    double slope[10][3];
    double volume = bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope) / 6;
    double change = change_at(mesh, load, node, point[q]);
    double size = weight[q] * volume * change;
    double shift = weight[q] * volume * projected * (mean - change);
    for (int a = 0; a < nodes; a++) {
      const double *g = slope[a];
      force[a][0] += size * (unit[0] * g[0] + unit[5] * g[1] + unit[4] * g[2]) + shift * g[0];
      force[a][1] += size * (unit[5] * g[0] + unit[1] * g[1] + unit[3] * g[2]) + shift * g[1];
      force[a][2] += size * (unit[4] * g[0] + unit[3] * g[1] + unit[2] * g[2]) + shift * g[2];
    }
  }
}

void bwi_thermal_stress_at(const bw_model *model, int32_t element, const double at[4],
                           double stress[6]) {
  const bw_mesh *mesh = model->mesh;
  const int32_t *node = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    if (load->kind != BW_LOAD_TEMPERATURE)
      continue;
    double unit[6], change = change_at(mesh, load, node, at);
    double projected = projected_stress(model, load, element);
    double shift = projected != 0 ? projected * (mean_change(mesh, load, element) - change) : 0;
    unit_stress(model, load, element, unit);
    for (int k = 0; k < 6; k++)
      stress[k] += change * unit[k] + (k < 3 ? shift : 0);
  }
}

/* C : alpha 1 at points, the mean of the elements around each, as the stresses there are averaged.
 */
static bw_status point_units(bw_context *context, const bw_model *model, const bw_load *load,
                             const bw_stress_points *at, double **out) {
  const bw_mesh *mesh = model->mesh;
  size_t count = (size_t)at->count;
  double *mean = BW_NEW0(context, double, 6 * count), *volume = BW_NEW0(context, double, count);
  if (!mean || !volume) {
    bw_free(mean);
    bw_free(volume);
    return BW_MEMORY;
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    double unit[6];
    unit_stress(model, load, e, unit);
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      size_t i = (size_t)bw_stress_point_of(at, mesh, e, a);
      volume[i] += mesh->volume[e];
      for (size_t k = 0; k < 6; k++)
        mean[6 * i + k] += mesh->volume[e] * unit[k];
    }
  }
  for (size_t i = 0; i < 6 * count; i++)
    mean[i] = volume[i / 6] > 0 ? mean[i] / volume[i / 6] : 0;
  bw_free(volume);
  *out = mean;
  return BW_OK;
}

/* What the projection adds at points: the means of the elements around each, weighted by volume. */
static bw_status add_projected(bw_context *context, const bw_model *model, const bw_load *load,
                               const bw_stress_points *at, double *stress) {
  const bw_mesh *mesh = model->mesh;
  double *sum = BW_NEW0(context, double, at->count);
  double *volume = BW_NEW0(context, double, at->count);
  for (int32_t e = 0; sum && volume && e < mesh->element_count; e++) {
    double unit = projected_stress(model, load, e), mean = mean_change(mesh, load, e);
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t i = bw_stress_point_of(at, mesh, e, a);
      double own = bw_array_get(load->nodal, bw_stress_point_node(at, i), 0);
      volume[i] += mesh->volume[e];
      sum[i] += unit * mesh->volume[e] * (mean - own);
    }
  }
  for (int32_t i = 0; sum && volume && i < at->count; i++)
    for (int k = 0; k < 3 && volume[i] > 0; k++)
      stress[6 * (size_t)i + (size_t)k] += sum[i] / volume[i];
  bw_status status = sum && volume ? BW_OK : BW_MEMORY;
  bw_free(sum);
  bw_free(volume);
  return status;
}

bw_status bw_model_thermal_stress(bw_context *context, const bw_model *model,
                                  const bw_stress_points *at, double *stress) {
  const bw_mesh *mesh = model->mesh;
  int32_t count = at ? at->count : mesh->element_count;
  double unit[6], point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  double *by_point = NULL; /* where elements differ */
  bool differ = model->material->parts != NULL;
  bw_status status = BW_OK;
  int points = points_of(mesh->order, point, weight);
  memset(stress, 0, (size_t)count * 6 * sizeof *stress);
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    if (load->kind != BW_LOAD_TEMPERATURE)
      continue;
    unit_stress(model, load, 0, unit);
    if (differ && at)
      BW_TRY(point_units(context, model, load, at, &by_point));
    if (at && projects(model))
      BW_TRY(add_projected(context, model, load, at, stress));
    for (int32_t i = 0; i < count; i++) {
      double change = 0;
      if (i % 65536 == 0)
        BW_TRY(bw_check_cancel(context));
      if (differ && at)
        memcpy(unit, by_point + 6 * (size_t)i, sizeof unit);
      else if (differ)
        unit_stress(model, load, i, unit);
      if (at)
        change = bw_array_get(load->nodal, bw_stress_point_node(at, i), 0);
      else
        for (int q = 0; q < points; q++)
          change +=
              weight[q] * change_at(mesh, load,
                                    mesh->element + (size_t)i * (size_t)mesh->nodes_per_element,
                                    point[q]);
      for (int k = 0; k < 6; k++)
        stress[6 * (size_t)i + (size_t)k] += change * unit[k];
    }
    bw_free(by_point);
    by_point = NULL;
  }
done:
  bw_free(by_point);
  return status;
}
