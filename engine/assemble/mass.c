/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Mass: consistent (integrals of N_i N_j) and lumped.
 *
 * On a straight element the integrals are the volume times constants,
 *     tet4:  (1 + d_ij) / 20
 *     tet10, in units of V/420: corners 6 (same) and 1; corner and mid-edge node -4 (of its own
 * edge) and -6; mid-edge nodes 32 (same), 16 (edges that meet) and 8 (opposite edges). Lumping
 * scales the diagonal to the volume (Hinton, Rock, Zienkiewicz): V/4 per node of tet4, V/36 per
 * corner and 4V/27 per mid-edge node of tet10. Row sums would give corners of tet10 a negative
 * mass. */
#include "assemble/internal.h"

#include <string.h>

typedef struct mass_data {
  bwi_row_sums rows;
  const bw_mesh *mesh;
  int32_t *curved;
  double *curved_mass;  /* curved elements x 100 */
  double factor[256];   /* of V, by local pair (a << 4 | b) */
  const double *weight; /* (any, element_count) or NULL: 1 */
  double scale;         /* (any) of all */
  double *values;
} mass_data;

static void make_table(int order, double factor[256]) {
  memset(factor, 0, 256 * sizeof *factor);
  for (int a = 0; a < (order == 1 ? 4 : 10); a++)
    for (int b = 0; b < (order == 1 ? 4 : 10); b++) {
      double *f = &factor[a << 4 | b];
      if (order == 1) {
        *f = (a == b ? 2 : 1) / 20.0;
        continue;
      }
      int shared = 0; /* corners that the two nodes' edges (or corners) have in common */
      for (int i = 0; i < 4; i++) {
        bool of_a = a < 4 ? a == i : bw_tet_edge[a - 4][0] == i || bw_tet_edge[a - 4][1] == i;
        bool of_b = b < 4 ? b == i : bw_tet_edge[b - 4][0] == i || bw_tet_edge[b - 4][1] == i;
        shared += of_a && of_b;
      }
      if (a < 4 && b < 4)
        *f = (shared ? 6 : 1) / 420.0;
      else if (a >= 4 && b >= 4)
        *f = 8 * (1 << shared) / 420.0;
      else
        *f = (shared ? -4 : -6) / 420.0;
    }
}

static bw_status fill_curved(void *data, int64_t begin, int64_t end, int worker) {
  const mass_data *m = (const mass_data *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++)
    if (m->curved[e] >= 0) {
      double x[10][3];
      bwi_element_nodes(m->mesh, e, x);
      bw_element_mass(2, (const double(*)[3])x, m->curved_mass + 100 * (int64_t)m->curved[e]);
    }
  return BW_OK;
}

static bw_status prepare(bw_context *context, const bw_mesh *mesh, mass_data *m) {
  bw_status status;
  int64_t curved_count;
  m->mesh = mesh;
  make_table(mesh->order, m->factor);
  BW_TRY(bwi_find_curved(context, mesh, &m->curved, &curved_count));
  if (curved_count) {
    m->curved_mass = BW_NEW(context, double, 100 * curved_count);
    if (!m->curved_mass)
      return BW_MEMORY;
    BW_TRY(bw_parallel(context, mesh->element_count, 64, fill_curved, m));
  }
done:
  return status;
}

static void clear(mass_data *m) {
  bw_free(m->curved);
  bw_free(m->curved_mass);
}

static bw_status gather_rows(void *data, int64_t begin, int64_t end, int worker) {
  const mass_data *m = (const mass_data *)data;
  const bwi_row_sums *r = &m->rows;
  int32_t *place = r->place + (int64_t)worker * r->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    double *row = m->values + r->pattern->start[i];
    int64_t count = bwi_row_places(r, i, place);
    memset(row, 0, (size_t)count * sizeof *row);
    for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
      int64_t e = r->incidence.element[k];
      int a = r->incidence.local[k];
      const int32_t *node = bwi_row_element(r, k);
      bool curved = m->curved && m->curved[e] >= 0;
      const double *of_pair =
          curved ? m->curved_mass + 100 * (int64_t)m->curved[e] + 10 * a : m->factor + (a << 4);
      double volume = curved ? 1 : m->mesh->volume[e];
      if (m->weight)
        volume *= m->weight[e];
      for (int b = 0; b < r->nodes_per_element; b++)
        if (node[b] <= i)
          row[place[node[b]]] += of_pair[b] * volume;
    }
    for (int64_t k = 0; m->scale != 1 && k < count; k++)
      row[k] *= m->scale;
  }
  return BW_OK;
}

static bw_status fill(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                      const double *weight, double scale, double *values) {
  bw_status status;
  mass_data m = {.weight = weight, .scale = scale, .values = values};
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  BW_TRY(prepare(context, mesh, &m));
  BW_TRY(bwi_row_sums_open(context, pattern, mesh->element_count, mesh->nodes_per_element,
                           mesh->element, &m.rows));
  BW_TRY(bw_parallel(context, mesh->node_count, BWI_ROWS_PER_CHUNK, gather_rows, &m));
done:
  bwi_row_sums_close(&m.rows);
  clear(&m);
  return status;
}

bw_status bw_mass(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                  const bw_material *material, double *values) {
  bw_status status = BW_OK;
  bool known = material && material->density > 0; /* in all elements */
  double *weight = NULL;
  if (material)
    BW_TRY(bw_material_fits(context, material, mesh->element_count));
  if (known && material->parts) {
    weight = BW_NEW(context, double, mesh->element_count);
    BW_TRY_MEMORY(weight);
    for (int64_t e = 0; e < mesh->element_count; e++)
      weight[e] = bw_material_of(material, e)->density;
  }
  BW_TRY(fill(context, pattern, mesh, weight, known && !weight ? material->density : 1, values));
done:
  bw_free(weight);
  return status;
}

bw_status bw_weighted_mass(bw_context *context, const bw_block_pattern *pattern,
                           const bw_mesh *mesh, const double *weight, double *values) {
  return fill(context, pattern, mesh, weight, 1, values);
}

bw_status bw_lumped_mass(bw_context *context, const bw_mesh *mesh, const double *weight,
                         double *values) {
  bw_status status;
  int n = mesh->nodes_per_element;
  mass_data m = {0};
  BW_TRY(prepare(context, mesh, &m));
  memset(values, 0, (size_t)mesh->node_count * sizeof *values);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * n;
    double volume = mesh->volume[e], trace = 0, diagonal[10];
    if (m.curved && m.curved[e] >= 0) {
      const double *mass = m.curved_mass + 100 * (int64_t)m.curved[e];
      volume = 0;
      for (int k = 0; k < 100; k++)
        volume += mass[k];
      for (int a = 0; a < 10; a++)
        diagonal[a] = mass[11 * a];
    } else
      for (int a = 0; a < n; a++)
        diagonal[a] = m.factor[a << 4 | a];
    for (int a = 0; a < n; a++)
      trace += diagonal[a];
    if (weight)
      volume *= weight[e];
    for (int a = 0; a < n; a++)
      values[node[a]] += diagonal[a] / trace * volume;
  }
done:
  clear(&m);
  return status;
}
