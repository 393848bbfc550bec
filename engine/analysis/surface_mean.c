/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The mean of a field of facets' corners over the boundary near each boundary node: a nonlocal
 * stress measure that stays finite where the stress itself is singular
 * (docs/theory/breaking_force.md).
 *
 * Invariant: weights are not negative and sum to one, so constants are kept and no mean exceeds the
 * largest value of its patch. */
#include "analysis/surface_patch.h"

#include "barwright/analysis.h"

#include <string.h>

typedef struct means {
  bwi_surface_patches patches;
  int columns;
  const double *value;
  double *mean;
} means;

typedef struct sum {
  const means *m;
  double total, *mean;
} sum;

static void add_facet(void *data, int32_t facet, const double weight[3]) {
  sum *s = (sum *)data;
  int columns = s->m->columns;
  const double *value = s->m->value + 3 * (size_t)facet * (size_t)columns;
  for (int a = 0; a < 3; a++, value += columns) {
    s->total += weight[a];
    for (int c = 0; c < columns; c++)
      s->mean[c] += weight[a] * value[c];
  }
}

static bw_status means_of(void *data, int64_t begin, int64_t end, int worker) {
  const means *m = (const means *)data;
  for (int64_t i = begin; i < end; i++) {
    int32_t node = m->patches.mesh->boundary_node[i];
    sum s = {m, 0, m->mean + (size_t)node * m->columns};
    memset(s.mean, 0, (size_t)m->columns * sizeof *s.mean);
    bwi_surface_patch_visit(&m->patches, node, (int32_t)i + 1, worker, add_facet, &s);
    for (int c = 0; c < m->columns && s.total > 0; c++)
      s.mean[c] /= s.total;
  }
  return BW_OK;
}

bw_status bw_surface_mean(bw_context *context, const bw_mesh *mesh, const bw_dof_map *dof_map,
                          double radius, int columns, const double *value, double *mean) {
  bw_status status;
  means m = {.columns = columns, .value = value, .mean = mean};
  if (columns < 1)
    return bw_fail(context, BW_INVALID, "%d columns: at least one is needed", columns);
  BW_TRY(bwi_surface_patches_begin(context, mesh, dof_map, radius, &m.patches));
  memset(mean, 0, (size_t)mesh->node_count * (size_t)columns * sizeof *mean);
  BW_TRY(bw_parallel(context, mesh->boundary_node_count, 64, means_of, &m));
done:
  bwi_surface_patches_clear(&m.patches);
  return status;
}
