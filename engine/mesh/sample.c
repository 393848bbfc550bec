/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodal fields at points, by the shape functions of the elements that hold them. */
#include "barwright/sample.h"

typedef struct sampling {
  const bw_mesh *mesh;
  const bw_locator *locator;
  int columns;
  const double *value, *point;
  double *out, *outside;
} sampling;

static bw_status sample_some(void *data, int64_t begin, int64_t end, int worker) {
  const sampling *s = (const sampling *)data;
  const bw_mesh *mesh = s->mesh;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    const double *p = s->point + 3 * i;
    double *out = s->out + i * s->columns, l[4], shape[10], apart[3] = {-p[0], -p[1], -p[2]};
    const int32_t *node =
        mesh->element + (int64_t)bw_locator_find(s->locator, p, l, NULL) * mesh->nodes_per_element;
    for (int a = 0; a < 4; a++) {
      shape[a] = mesh->order == 2 ? l[a] * (2 * l[a] - 1) : l[a];
      for (int k = 0; k < 3; k++)
        apart[k] += l[a] * mesh->node[3 * (int64_t)node[a] + k];
    }
    for (int a = 4; a < mesh->nodes_per_element; a++)
      shape[a] = 4 * l[bw_tet_edge[a - 4][0]] * l[bw_tet_edge[a - 4][1]];
    for (int c = 0; c < s->columns; c++) {
      out[c] = 0;
      for (int a = 0; a < mesh->nodes_per_element; a++)
        out[c] += shape[a] * s->value[(int64_t)node[a] * s->columns + c];
    }
    if (s->outside)
      s->outside[i] = bw_norm(apart);
  }
  return BW_OK;
}

bw_status bw_mesh_sample(bw_context *context, const bw_mesh *mesh, const bw_locator *locator,
                         int columns, const double *value, int64_t count, const double *point,
                         double *out, double *outside) {
  sampling s = {mesh, locator, columns, value, point, out, outside};
  return bw_parallel(context, count, 16, sample_some, &s);
}
