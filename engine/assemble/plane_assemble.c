/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Values of a matrix on a plane pattern: gathered from element matrices, and changed where unknowns
 * are prescribed. Each value is summed by one thread, its contributions in ascending order of
 * elements. */
#include <math.h>
#include <string.h>

#include "assemble/plane_matrix.h"

static bw_status check_components(bw_context *context, int components) {
  if (components < 1 || components > BWI_MAX_COMPONENTS)
    return bw_fail(context, BW_INVALID, "%d components at a node; 1 to %d are possible", components,
                   BWI_MAX_COMPONENTS);
  return BW_OK;
}

/* ---- gathering ----------------------------------------------------------------------------- */

typedef struct gathering {
  const bw_plane_pattern *pattern;
  const double *block;
  double *values;
  bw_element_matrix *element_matrix;
  void *data;
  int n, components;
} gathering;

/* C and N are constants wherever this is expanded. */
static inline __attribute__((always_inline)) void gather_rows(const gathering *g, int64_t begin,
                                                              int64_t end, int C, int N) {
  const bw_plane_pattern *pattern = g->pattern;
  const int rows = N * C;
  for (int64_t p = pattern->start[begin]; p < pattern->start[end]; p++) {
    double sum[BWI_MAX_COMPONENTS * BWI_MAX_COMPONENTS] = {0};
    for (int64_t k = pattern->gather_start[p]; k < pattern->gather_start[p + 1]; k++) {
      int local = pattern->gather_local[k], a = local / 6, b = local % 6;
      const double *from =
          g->block + (int64_t)pattern->gather_element[k] * rows * rows + a * C * rows + b * C;
      for (int r = 0; r < C; r++)
        for (int c = 0; c < C; c++)
          sum[C * r + c] += from[r * rows + c];
    }
    for (int k = 0; k < C * C; k++)
      g->values[C * C * p + k] = sum[k];
  }
}

static bw_status gather_body(void *data, int64_t begin, int64_t end, int worker) {
  const gathering *g = data;
  (void)worker;
#define CASE(C, N)                                                                                 \
  case 8 * C + N:                                                                                  \
    gather_rows(g, begin, end, C, N);                                                              \
    break;
  switch (8 * g->components + g->n) {
    CASE(1, 3)
    CASE(2, 3)
    CASE(3, 3)
    CASE(4, 3)
    CASE(1, 6)
    CASE(2, 6)
    CASE(3, 6)
    CASE(4, 6)
  }
#undef CASE
  return BW_OK;
}

/* values[block] = sum of the contributions in `block`: element matrices one after the other, n x
 * components unknowns each, row by row. */
static bw_status plane_gather(bw_context *context, const bw_plane_pattern *pattern, int components,
                              const double *block, double *values) {
  gathering g = {.pattern = pattern,
                 .block = block,
                 .values = values,
                 .n = bwi_nodes_per_element(pattern->topology),
                 .components = components};
  return bw_parallel(context, pattern->node_count, BWI_GRAIN_NODES, gather_body, &g);
}

static bw_status element_body(void *data, int64_t begin, int64_t end, int worker) {
  const gathering *g = data;
  (void)worker;
  int64_t size = (int64_t)g->n * g->components * g->n * g->components;
  for (int64_t e = begin; e < end; e++) {
    bw_status status = g->element_matrix(g->data, (int32_t)e, (double *)g->block + e * size);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

bw_status bwi_plane_assemble(bw_context *context, const bw_plane_pattern *pattern, int components,
                             bw_element_matrix *element_matrix, void *data, double *workspace,
                             double *values) {
  gathering g = {.pattern = pattern,
                 .block = workspace,
                 .element_matrix = element_matrix,
                 .data = data,
                 .n = bwi_nodes_per_element(pattern->topology),
                 .components = components};
  bw_status status =
      bw_parallel(context, pattern->topology->element_count, BWI_GRAIN_ELEMENTS, element_body, &g);
  return status != BW_OK ? status : plane_gather(context, pattern, components, workspace, values);
}

bw_status bw_plane_assemble(bw_context *context, const bw_plane_pattern *pattern, int components,
                            bw_element_matrix *element_matrix, void *data, double *values) {
  bw_status status = check_components(context, components);
  if (status != BW_OK)
    return status;
  double *workspace = BW_NEW(context, double, bwi_plane_workspace_size(pattern, components));
  status = workspace ? bwi_plane_assemble(context, pattern, components, element_matrix, data,
                                          workspace, values)
                     : BW_MEMORY;
  bw_free(workspace);
  return status;
}

/* ---- prescribed unknowns ------------------------------------------------------------------- */

/* Rows and columns of the prescribed unknowns alone are walked, the columns through the mirrors of
 * the rows: few nodes are prescribed. */
bw_status bw_plane_prescribe(bw_context *context, const bw_plane_pattern *pattern, int components,
                             const uint8_t *is_prescribed, const double *prescribed, double *values,
                             double *rhs) {
  const int C = components, square = C * C;
  double scale[BWI_MAX_COMPONENTS];
  bw_status status = check_components(context, components);
  if (status != BW_OK)
    return status;
  for (int c = 0; c < C; c++) {
    double sum = 0;
    for (int32_t i = 0; i < pattern->node_count; i++)
      sum += fabs(values[square * pattern->diagonal[i] + (C + 1) * c]);
    scale[c] = sum > 0 && isfinite(sum) ? sum / pattern->node_count : 1;
  }
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int c = 0; c < C; c++) {
      if (!is_prescribed[i * C + c])
        continue;
      for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {
        int64_t j = pattern->column[p];
        double *row = values + square * p, *column = values + square * pattern->mirror[p];
        for (int r = 0; r < C; r++) {
          if (rhs && !is_prescribed[j * C + r])
            rhs[j * C + r] -= column[C * r + c] * prescribed[i * C + c];
          row[C * c + r] = 0;
          column[C * r + c] = 0;
        }
      }
      values[square * pattern->diagonal[i] + (C + 1) * c] = scale[c];
      if (rhs)
        rhs[i * C + c] = scale[c] * prescribed[i * C + c];
    }
  return BW_OK;
}
