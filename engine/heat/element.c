/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elements: conduction and sources.
 *
 * Matrices of a chunk of elements are made at once by all threads, and added one element after the
 * other, so that sums do not depend on the threads. */
#include "heat/internal.h"

#include <string.h>

enum { CHUNK = 2048 };

void bwi_heat_conductivity(const bw_material *material, int64_t element, double tensor[9]) {
  const bw_material *part = bw_material_of(material, element);
  const double *axes = part->axes;
  memset(tensor, 0, 9 * sizeof *tensor);
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 3; i++) {
      if (part->isotropic)
        tensor[4 * i] = part->thermal.conductivity[0];
      else
        for (int j = 0; j < 3; j++)
          tensor[3 * i + j] += part->thermal.conductivity[k] * axes[3 * k + i] * axes[3 * k + j];
    }
}

bool bwi_heat_varies(const bw_material *material) {
  bool varies = false;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    varies |= bw_material_part(material, i)->thermal.rows > 0;
  return varies;
}

typedef struct conduction {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *temperature;
  int64_t first;
  double (*matrix)[100];
  int degree[2]; /* of straight and of curved elements */
} conduction;

static bw_status conduct(void *data, int64_t begin, int64_t end, int worker) {
  const conduction *d = data;
  const bw_mesh *mesh = d->mesh;
  int n = mesh->nodes_per_element;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    int64_t e = d->first + i;
    const int32_t *node = mesh->element + e * n;
    double x[10][3], k[9], *matrix = d->matrix[i];
    double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
    const bw_thermal *thermal = &bw_material_of(d->material, e)->thermal;
    bwi_element_nodes(mesh, e, x);
    bwi_heat_conductivity(d->material, e, k);
    bool curved = mesh->order == 2 && !bw_tet_is_straight((const double(*)[3])x);
    int points = bw_tet_quadrature(d->degree[curved], point, weight);
    memset(matrix, 0, sizeof *d->matrix);
    for (int q = 0; q < points; q++) {
      double slope[10][3], flux[10][3], shape[10], t = 0;
      double size =
          weight[q] / 6 * bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope);
      if (!(size > 0))
        return BW_GEOMETRY;
      if (thermal->rows) {
        bw_tet_shape(mesh->order, point[q], shape);
        for (int a = 0; a < n; a++)
          t += shape[a] * d->temperature[node[a]];
        size *= bw_thermal_factor(thermal, t);
      }
      for (int a = 0; a < n; a++)
        for (int c = 0; c < 3; c++)
          flux[a][c] = size * (k[3 * c] * slope[a][0] + k[3 * c + 1] * slope[a][1] +
                               k[3 * c + 2] * slope[a][2]);
      for (int a = 0; a < n; a++)
        for (int b = 0; b <= a; b++)
          matrix[10 * a + b] += bw_dot(flux[a], slope[b]);
    }
  }
  return BW_OK;
}

bw_status bwi_heat_conduct(bw_context *context, const bw_block_pattern *pattern,
                           const bw_mesh *mesh, const bw_material *material,
                           const double *temperature, double *values) {
  bw_status status = BW_OK;
  int n = mesh->nodes_per_element;
  bool varies = bwi_heat_varies(material);
  conduction d = {.mesh = mesh, .material = material, .temperature = temperature};
  d.degree[0] = mesh->order == 1 ? 1 : varies ? BWI_CURVED_DEGREE : 2;
  d.degree[1] = BWI_CURVED_DEGREE;
  d.matrix = bw_alloc(context, CHUNK, sizeof *d.matrix);
  BW_TRY_MEMORY(d.matrix);
  for (d.first = 0; d.first < mesh->element_count; d.first += CHUNK) {
    int64_t count = mesh->element_count - d.first < CHUNK ? mesh->element_count - d.first : CHUNK;
    BW_TRY(bw_check_cancel(context));
    status = bw_parallel(context, count, 64, conduct, &d);
    if (status == BW_GEOMETRY)
      bw_fail(context, status,
              "an element is inverted or has no volume: repair or refill the mesh");
    BW_TRY(status);
    for (int64_t i = 0; i < count; i++) {
      const int32_t *node = mesh->element + (d.first + i) * n;
      for (int a = 0; a < n; a++)
        for (int b = 0; b <= a; b++)
          values[bwi_heat_block(pattern, node[a], node[b])] += d.matrix[i][10 * a + b];
    }
  }
done:
  bw_free(d.matrix);
  return status;
}

bw_status bwi_heat_volume(bw_context *context, const bw_mesh *mesh, const bw_array *nodal,
                          double *load) {
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  double shape[BW_QUADRATURE_POINTS][10];
  int n = mesh->nodes_per_element, points = bw_tet_quadrature(BWI_MASS_DEGREE, point, weight);
  for (int q = 0; q < points; q++)
    bw_tet_shape(mesh->order, point[q], shape[q]);
  memset(load, 0, (size_t)mesh->node_count * sizeof *load);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * n;
    double x[10][3], slope[10][3];
    if (e % 4096 == 0 && bw_cancelled(context))
      return bw_check_cancel(context);
    bwi_element_nodes(mesh, e, x);
    for (int q = 0; q < points; q++) {
      double f = nodal ? 0 : 1;
      for (int a = 0; nodal && a < n; a++)
        f += shape[q][a] * bw_array_get(nodal, node[a], 0);
      f *= weight[q] / 6 * bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope);
      for (int a = 0; a < n; a++)
        load[node[a]] += f * shape[q][a];
    }
  }
  return BW_OK;
}
