/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Square grids of triangles, as topologies alone: for what needs no positions. */
#ifndef GRIDS_H
#define GRIDS_H

#include "check.h"

static inline void grid_nodes_destroy(void *object) {
  bw_free(object);
}
static inline void grid_topology_destroy(void *object) {
  bw_plane_topology *topology = object;
  bw_release(topology->nodes);
  bw_free(topology->element);
  bw_free(topology);
}

/* n x n squares of two triangles each; the diagonal of square k goes the other way where
 * flip >> (k % 8) has its lowest bit set. Nodes are those of `same` where it is given. */
static inline bw_plane_topology *grid_create(bw_context *context, int order, int n, unsigned flip,
                                             const bw_plane_topology *same) {
  static const bw_kind nodes_kind = {"grid nodes", grid_nodes_destroy, NULL};
  static const bw_kind topology_kind = {"grid topology", grid_topology_destroy, NULL};
  int m = order * n + 1;
  bw_plane_nodes *nodes = NULL;
  if (!same) {
    nodes = BW_NEW0(context, bw_plane_nodes, 1);
    bw_object_init(nodes, &nodes_kind);
    nodes->order = order;
    nodes->node_count = m * m;
    nodes->corner_count = (n + 1) * (n + 1);
  }
  bw_plane_topology *topology = BW_NEW0(context, bw_plane_topology, 1);
  bw_object_init(topology, &topology_kind);
  topology->nodes = same ? bw_retain(same->nodes) : nodes;
  topology->element_count = 2 * n * n;
  int per = order == 1 ? 3 : 6;
  topology->element = BW_NEW(context, int32_t, 2 * n * n * per);
  int32_t *e = topology->element;
  for (int y = 0; y < n; y++)
    for (int x = 0; x < n; x++)
      for (int half = 0; half < 2; half++) {
        static const int plain[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        static const int other[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{1, 0}, {1, 1}, {0, 1}}};
        const int(*corner)[2] = flip >> ((y * n + x) % 8) & 1 ? other[half] : plain[half];
        for (int a = 0; a < 3; a++)
          *e++ = (order * (y + corner[a][1])) * m + order * (x + corner[a][0]);
        for (int a = 0; a < 3 && order == 2; a++) {
          const int *p = corner[a], *q = corner[(a + 1) % 3];
          *e++ = (2 * y + p[1] + q[1]) * m + 2 * x + p[0] + q[0];
        }
      }
  return topology;
}

#endif
