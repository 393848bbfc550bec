/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Masses and springs that are spread over the area of a selection. An attachment is a sum of parts,
 * one for each facet: integral N_i N_j dA over the whole area. Without facets each node is a part,
 * and all have the same share. The shares of all parts sum to 1. */
#include <string.h>

#include "model/internal.h"

int32_t bwi_attachment_parts(const bw_attachment *attachment) {
  const bw_selection *on = attachment->on;
  return on->facet_count > 0 ? on->facet_count : on->node_count;
}

int bwi_attachment_part(const bw_attachment *attachment, int32_t part, const int32_t **node,
                        double share[36]) {
  const bw_selection *on = attachment->on;
  const bw_mesh *mesh = on->mesh;
  int count = on->facet_count > 0 ? mesh->nodes_per_facet : 1;
  memset(share, 0, 36 * sizeof *share);
  if (on->facet_count == 0) {
    *node = on->node + part;
    share[0] = 1. / on->node_count;
    return count;
  }
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  int points = bwi_boundary_points(mesh, on->facet[part], point);
  *node = mesh->facet + (int64_t)on->facet[part] * count;
  for (int p = 0; p < points; p++) {
    double weight = bw_norm(point[p].area) / attachment->area;
    for (int i = 0; i < count; i++)
      for (int j = 0; j < count; j++)
        share[count * i + j] += weight * point[p].shape[i] * point[p].shape[j];
  }
  return count;
}

void bwi_attachment_apply(const bw_attachment *attachment, const double factor[3],
                          const double *field, const double constant[3], bwi_add_force *add,
                          void *data) {
  int32_t parts = bwi_attachment_parts(attachment);
  for (int32_t p = 0; p < parts; p++) {
    const int32_t *node;
    double share[36];
    int count = bwi_attachment_part(attachment, p, &node, share);
    for (int i = 0; i < count; i++) {
      double force[3] = {0};
      for (int j = 0; j < count; j++) {
        const double *value = field ? field + 3 * (int64_t)node[j] : constant;
        for (int c = 0; c < 3; c++)
          force[c] += factor[c] * share[count * i + j] * value[c];
      }
      add(data, node[i], force);
    }
  }
}
