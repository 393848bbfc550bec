/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Motions of the boundary carried into the body, and the transpose (docs/theory/strengthen.md).
 *
 * Gauss and Seidel's sweeps: every inner node takes the mean of the nodes of the elements around
 * it, those of each element once. Inner nodes start at zero; boundary nodes keep their values. This
 * is a linear map E of boundary values; its transpose does the same steps backwards. */
#include "assemble/internal.h"

#include "barwright/analysis.h"

#include <string.h>

enum { SWEEPS = 30 };

typedef struct sweep {
  const bw_mesh *mesh;
  bwi_incidence around;
  uint8_t *boundary; /* node_count */
} sweep;

static bw_status begin(bw_context *context, const bw_mesh *mesh, sweep *s) {
  *s = (sweep){.mesh = mesh};
  s->boundary = BW_NEW0(context, uint8_t, mesh->node_count);
  if (!s->boundary)
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    s->boundary[mesh->boundary_node[i]] = 1;
  return bwi_incidence_create(context, mesh, &s->around);
}

static void end(sweep *s) {
  bwi_incidence_clear(&s->around);
  bw_free(s->boundary);
}

/* What node i takes of each of its neighbours, the own value among them left out. */
static double fraction_of(const sweep *s, int32_t node) {
  int64_t elements = s->around.start[node + 1] - s->around.start[node];
  return 1.0 / (double)(elements * (s->mesh->nodes_per_element - 1));
}

static void gather(const sweep *s, int32_t node, double *values) {
  double sum[3] = {0}, fraction = fraction_of(s, node);
  for (int64_t k = s->around.start[node]; k < s->around.start[node + 1]; k++) {
    const int32_t *own =
        s->mesh->element + (int64_t)s->around.element[k] * s->mesh->nodes_per_element;
    for (int a = 0; a < s->mesh->nodes_per_element; a++)
      for (size_t c = 0; c < 3 && own[a] != node; c++)
        sum[c] += values[3 * (size_t)own[a] + c];
  }
  for (size_t c = 0; c < 3; c++)
    values[3 * (size_t)node + c] = fraction * sum[c];
}

static void scatter(const sweep *s, int32_t node, double *covector) {
  double part[3], fraction = fraction_of(s, node);
  for (size_t c = 0; c < 3; c++) {
    part[c] = fraction * covector[3 * (size_t)node + c];
    covector[3 * (size_t)node + c] = 0;
  }
  for (int64_t k = s->around.start[node]; k < s->around.start[node + 1]; k++) {
    const int32_t *own =
        s->mesh->element + (int64_t)s->around.element[k] * s->mesh->nodes_per_element;
    for (int a = 0; a < s->mesh->nodes_per_element; a++)
      for (size_t c = 0; c < 3 && own[a] != node; c++)
        covector[3 * (size_t)own[a] + c] += part[c];
  }
}

static void clear_inner(const sweep *s, double *values) {
  for (int32_t i = 0; i < s->mesh->node_count; i++)
    if (!s->boundary[i])
      memset(values + 3 * (size_t)i, 0, 3 * sizeof *values);
}

bw_status bw_boundary_extend(bw_context *context, const bw_mesh *mesh, double *motion) {
  sweep s;
  bw_status status = begin(context, mesh, &s);
  if (status == BW_OK) {
    clear_inner(&s, motion);
    for (int k = 0; k < SWEEPS; k++)
      for (int32_t i = 0; i < mesh->node_count; i++)
        if (!s.boundary[i])
          gather(&s, i, motion);
  }
  end(&s);
  return status;
}

bw_status bw_boundary_gather(bw_context *context, const bw_mesh *mesh, double *covector) {
  sweep s;
  bw_status status = begin(context, mesh, &s);
  if (status == BW_OK) {
    for (int k = 0; k < SWEEPS; k++)
      for (int32_t i = mesh->node_count - 1; i >= 0; i--)
        if (!s.boundary[i])
          scatter(&s, i, covector);
    clear_inner(&s, covector);
  }
  end(&s);
  return status;
}
