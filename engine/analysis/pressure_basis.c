/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A basis of pressures: its life, and the products with its columns. */
#include "analysis/load_program.h"

#include <string.h>

static void basis_destroy(void *object) {
  bw_pressure_basis *basis = (bw_pressure_basis *)object;
  bw_release(basis->mesh);
  bw_free(basis->node);
  bw_free(basis->at);
  bw_free(basis->area);
  bw_free(basis->start);
  bw_free(basis->row);
  bw_free(basis->coefficient);
  bw_free(basis->parts);
  bw_free(basis->facet_start);
  bw_free(basis->facet_column);
  bw_free(basis);
}

static size_t basis_bytes(const void *object) {
  const bw_pressure_basis *basis = (const bw_pressure_basis *)object;
  size_t entries = basis->start ? (size_t)basis->start[basis->count] : 0;
  size_t facets = basis->facet_start ? (size_t)basis->mesh->facet_count : 0;
  size_t pressures = facets > 0 ? (size_t)basis->facet_start[facets] : 0;
  return sizeof *basis + (size_t)basis->count * 44 + 8 + entries * 28 + facets * 9 + pressures * 4;
}

static const bw_kind basis_kind = {"pressure basis", basis_destroy, basis_bytes};

bw_status bwi_pressure_basis_empty(bw_context *context, const bw_mesh *mesh,
                                   bw_pressure_basis **basis) {
  *basis = BW_NEW0(context, bw_pressure_basis, 1);
  if (!*basis)
    return BW_MEMORY;
  bw_object_init(*basis, &basis_kind);
  (*basis)->mesh = (const bw_mesh *)bw_retain(mesh);
  return BW_OK;
}

void bw_pressure_force(const bw_pressure_basis *basis, const double *pressure, double *force) {
  memset(force, 0, 3 * (size_t)basis->mesh->node_count * sizeof *force);
  for (int32_t j = 0; j < basis->count; j++) {
    double p = pressure[j];
    if (p == 0)
      continue;
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++) {
      double *to = force + 3 * (size_t)basis->row[k];
      const double *c = basis->coefficient + 3 * k;
      to[0] += p * c[0];
      to[1] += p * c[1];
      to[2] += p * c[2];
    }
  }
}

void bw_pressure_gradient(const bw_pressure_basis *basis, const double *q, double *f) {
  for (int32_t j = 0; j < basis->count; j++) {
    double sum = 0;
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++)
      sum += bw_dot(basis->coefficient + 3 * k, q + 3 * (size_t)basis->row[k]);
    f[j] = sum;
  }
}
