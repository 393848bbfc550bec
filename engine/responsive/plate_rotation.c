/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rotations that go with the shape. What makes a thin plate's section follow its deflection is that
 * covariant shear w,xi + b . x,xi vanishes. When the shape is stretched and w and b stay as they
 * were, it no longer does, and the shear energy of that is beyond all others in a thin plate. With
 *
 *   b' = J'^-1 J b,   J = d x / d (xi, eta) before, J' now,
 *
 * it stays zero, up to how J'^-1 J differs between the elements at a node. So modes are carried to
 * a moved mesh, and a former factor is applied in the rotations of its own shape: z = T B T^T r. */
#include <string.h>

#include "responsive/plate.h"

static void jacobian_at(const bwi_plate_reference *r, int a, const double (*x)[2], double j[4]) {
  for (int d = 0; d < 2; d++)
    for (int c = 0; c < 2; c++) {
      double sum = 0;
      for (int b = 0; b < 6; b++)
        sum += r->node_slope[a][d][b] * x[b][c];
      j[2 * d + c] = sum;
    }
}

bw_status bwi_plate_rotations(bw_context *context, const bwi_plate_reference *reference,
                              const bw_plane_topology *topology, const double *from,
                              const double *to, double *rotation) {
  int64_t nodes = topology->nodes->node_count;
  double *weight = BW_NEW0(context, double, nodes);
  if (!weight)
    return BW_MEMORY;
  memset(rotation, 0, (size_t)(4 * nodes) * sizeof *rotation);
  for (int64_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + 6 * e;
    double before[6][2], now[6][2];
    for (int a = 0; a < 6; a++) {
      memcpy(before[a], from + 2 * (int64_t)node[a], sizeof before[a]);
      memcpy(now[a], to + 2 * (int64_t)node[a], sizeof now[a]);
    }
    for (int a = 0; a < 6; a++) {
      double j[4], k[4];
      jacobian_at(reference, a, before, j);
      jacobian_at(reference, a, now, k);
      double was = j[0] * j[3] - j[1] * j[2], is = k[0] * k[3] - k[1] * k[2];
      if (!(was > 0) || !(is > 0))
        continue; /* an element of a flipped edge need not have been one before */
      double *t = rotation + 4 * (int64_t)node[a];
      t[0] += k[3] * j[0] - k[1] * j[2]; /* is * (J'^-1 J), so that weights are areas */
      t[1] += k[3] * j[1] - k[1] * j[3];
      t[2] += k[0] * j[2] - k[2] * j[0];
      t[3] += k[0] * j[3] - k[2] * j[1];
      weight[node[a]] += is;
    }
  }
  for (int64_t i = 0; i < nodes; i++)
    for (int c = 0; c < 4; c++)
      rotation[4 * i + c] = weight[i] > 0 ? rotation[4 * i + c] / weight[i] : c % 3 == 0;
  bw_free(weight);
  return BW_OK;
}

void bwi_plate_rotate(int64_t nodes, const double *rotation, bool transposed, double *u) {
  for (int64_t i = 0; i < nodes; i++) {
    const double *t = rotation + 4 * i;
    double *b = u + 3 * i + 1, x = b[0], y = b[1];
    b[0] = t[0] * x + t[transposed ? 2 : 1] * y;
    b[1] = t[transposed ? 1 : 2] * x + t[3] * y;
  }
}
