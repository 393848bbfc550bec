/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fields from one mesh to another. */
#include "plane/internal.h"

#include <math.h>
#include <string.h>

static void interpolate(const bw_plane_mesh *from, const bw_plane_locator *locator,
                        const double at[2], int components, const double *value,
                        double *transferred) {
  const bw_plane_topology *t = from->topology;
  double weight[6], along_r[6], along_s[6], place[3], outside;
  int32_t e = bw_plane_locate(locator, at, place, &outside);
  int width = bwi_plane_width(t->nodes);
  if (width == 6)
    bwi_tri6(place[1], place[2], weight, along_r, along_s);
  else
    memcpy(weight, place, sizeof place);
  for (int c = 0; c < components; c++) {
    transferred[c] = 0;
    for (int i = 0; i < width; i++)
      transferred[c] +=
          weight[i] *
          value[(size_t)t->element[(size_t)width * (size_t)e + (size_t)i] * (size_t)components +
                (size_t)c];
  }
}

/* The edges' ends of mid-edge nodes: x 2, the lower first. */
static int32_t *ends_of_mid_edge_nodes(bw_context *context, const bw_plane_topology *t) {
  int32_t corners = t->nodes->corner_count;
  int32_t *ends = BW_NEW(context, int32_t, 2 * (size_t)(t->nodes->node_count - corners));
  if (!ends)
    return NULL;
  for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
    const int32_t *n = t->element + 6 * (size_t)(h / 3);
    int32_t a = n[h % 3], b = n[(h % 3 + 1) % 3];
    int32_t *to = ends + 2 * (size_t)(n[3 + h % 3] - corners);
    to[0] = a < b ? a : b;
    to[1] = a < b ? b : a;
  }
  return ends;
}

/* The nodes are the same: only mid-edge nodes of flipped edges have another place in the field. It
 * is read where the new edge's middle would lie on the old mesh: corners keep their values. */
static bw_status transfer_flips(bw_context *context, const bw_plane_mesh *from,
                                const bw_plane_mesh *to, int components, const double *value,
                                double *transferred) {
  bw_status status = BW_OK;
  const bw_plane_nodes *nodes = from->topology->nodes;
  bw_plane_locator *locator = NULL;
  int32_t *before = ends_of_mid_edge_nodes(context, from->topology);
  int32_t *after = ends_of_mid_edge_nodes(context, to->topology);
  BW_TRY_MEMORY(before && after);
  for (int32_t m = nodes->corner_count; m < nodes->node_count; m++) {
    const int32_t *p = before + 2 * (size_t)(m - nodes->corner_count);
    const int32_t *q = after + 2 * (size_t)(m - nodes->corner_count);
    if (p[0] == q[0] && p[1] == q[1])
      continue;
    if (!locator)
      BW_TRY(bw_plane_locator_create(context, from, &locator));
    const double *a = from->point + 2 * (size_t)q[0], *b = from->point + 2 * (size_t)q[1];
    double at[2] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    interpolate(from, locator, at, components, value, transferred + (size_t)m * (size_t)components);
  }
done:
  bw_plane_locator_destroy(locator);
  bw_free(before);
  bw_free(after);
  return status;
}

bw_status bw_plane_transfer(bw_context *context, const bw_plane_mesh *from, const bw_plane_mesh *to,
                            int components, const double *value, double *transferred) {
  bw_status status = BW_OK;
  const bw_plane_nodes *nodes = to->topology->nodes;
  bw_plane_locator *locator = NULL;
  if (components < 1)
    return bw_fail(context, BW_INVALID, "%d components: at least 1 expected", components);
  if (nodes == from->topology->nodes) {
    memcpy(transferred, value, (size_t)nodes->node_count * (size_t)components * sizeof *value);
    if (nodes->order == 2 && from->topology != to->topology)
      status = transfer_flips(context, from, to, components, value, transferred);
    return status;
  }
  BW_TRY(bw_plane_locator_create(context, from, &locator));
  for (int32_t i = 0; i < nodes->node_count; i++) {
    if (i % 16384 == 0)
      BW_TRY(bw_check_cancel(context));
    interpolate(from, locator, to->point + 2 * (size_t)i, components, value,
                transferred + (size_t)i * (size_t)components);
  }
done:
  bw_plane_locator_destroy(locator);
  return status;
}
