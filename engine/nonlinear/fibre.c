/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The anisotropic term C (|F v| - 1)^2 of data-driven, formula (2). */
#include "nonlinear/law.h"

/* A fibre shortened to this has no direction any more. */
#define MIN_LENGTH 1e-9

/* With w = F v, r = |w|, n = w / r: P = 2 C (r - 1) n v^T, and A_ijkl = B_ik v_j v_l with
 * B = 2 C (n n^T + (1 - 1/r)(1 - n n^T)): 2 C along the fibre, 2 C (1 - 1/r) across, which is
 * negative where the fibre is shortened. */
void bwi_fibre(const bwi_lanes *stiffness, const bwi_lanes v[3], const bwi_lanes h[9],
               bwi_want want, bool project, bwi_response *out) {
  bwi_lanes n[3], square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - 1, r, zero = {0};
  for (int i = 0; i < 3; i++) {
    bwi_lanes moved = h[3 * i] * v[0] + h[3 * i + 1] * v[1] + h[3 * i + 2] * v[2];
    n[i] = v[i] + moved;
    square += moved * (2 * v[i] + moved); /* r^2 - 1 */
  }
  bwi_lanes length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  bwi_sqrt(&length, &r);
  bwi_lanes change = square / (1 + r), inverse = 1 / BWI_MAX(r, BWI_ALL(MIN_LENGTH));
  bwi_lanes twice = 2 * *stiffness, force = twice * change;
  out->energy += *stiffness * change * change;
  if (want == BWI_ENERGY)
    return;
  for (int i = 0; i < 3; i++) {
    n[i] = n[i] * inverse;
    for (int j = 0; j < 3; j++)
      out->stress[3 * i + j] += force * n[i] * v[j];
  }
  if (want == BWI_STRESS)
    return;
  bwi_lanes across = 1 - inverse;
  if (project)
    across = BWI_MAX(across, zero);
  bwi_lanes along = twice * (1 - across);
  across = twice * across;
  for (int i = 0; i < 3; i++)
    for (int k = i; k < 3; k++) {
      bwi_lanes b = along * n[i] * n[k] + (i == k ? across : zero);
      for (int j = 0; j < 3; j++)
        for (int l = 0; l < 3; l++) {
          bwi_lanes value = b * v[j] * v[l];
          out->tangent[9 * (3 * i + j) + 3 * k + l] += value;
          if (i != k)
            out->tangent[9 * (3 * k + l) + 3 * i + j] += value;
        }
    }
}
