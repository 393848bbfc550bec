/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Second derivatives of fields that are linear in each element: gradients averaged to the nodes by
 * area, and the divergence of what runs linearly between them (Jansen, Collis, Whiting, Shakib
 * 1999). */
#include <string.h>

#include "flow/internal.h"

/* Gradients of the corner functions times twice the area; twice the area comes back. */
static double slopes(const bw_plane_mesh *mesh, const int32_t *node, double g[3][2]) {
  double twice = 0;
  for (int i = 0; i < 3; i++) {
    const double *b = mesh->point + 2 * (int64_t)node[(i + 1) % 3];
    const double *c = mesh->point + 2 * (int64_t)node[(i + 2) % 3];
    g[i][0] = b[1] - c[1];
    g[i][1] = c[0] - b[0];
    twice += b[0] * c[1] - c[0] * b[1];
  }
  return twice;
}

bw_status bwi_flow_recover(bw_context *context, const bw_plane_mesh *mesh, int components,
                           const double *state, double *laplacian) {
  const bw_plane_topology *topology = mesh->topology;
  int64_t nodes = topology->nodes->node_count;
  int fields = components - 1; /* all but the pressure */
  static const int at[3] = {0, 1, 3};
  double *mean = BW_NEW0(context, double, 6 * nodes), *weight = BW_NEW0(context, double, nodes);
  if (!mean || !weight) {
    bw_free(mean);
    bw_free(weight);
    return BW_MEMORY;
  }
  for (int64_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + 3 * e;
    double g[3][2], twice = slopes(mesh, node, g);
    for (int f = 0; f < fields; f++)
      for (int d = 0; d < 2; d++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
          sum += g[i][d] * state[components * (int64_t)node[i] + at[f]];
        for (int i = 0; i < 3; i++)
          mean[6 * (int64_t)node[i] + 2 * f + d] += sum; /* area times gradient, twice */
      }
    for (int i = 0; i < 3; i++)
      weight[node[i]] += twice;
  }
  for (int64_t i = 0; i < nodes; i++)
    for (int k = 0; k < 6; k++)
      mean[6 * i + k] /= weight[i];
  memset(laplacian, 0, (size_t)topology->element_count * 3 * sizeof *laplacian);
  for (int64_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + 3 * e;
    double g[3][2], twice = slopes(mesh, node, g);
    for (int f = 0; f < fields; f++)
      for (int i = 0; i < 3; i++)
        for (int d = 0; d < 2; d++)
          laplacian[3 * e + f] += g[i][d] * mean[6 * (int64_t)node[i] + 2 * f + d] / twice;
  }
  bw_free(mean);
  bw_free(weight);
  return BW_OK;
}
