/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The anisotropic term C (|F v| - 1)^2 of data-driven, formula (2). */
#include "barwright/nonlinear.h"

#include <math.h>

/* With w = F v, r = |w|, n = w / r: P = 2 C (r - 1) n v^T, and the tangent is B (x) v v^T with
 * B = 2 C (n n^T + (1 - 1/r)(1 - n n^T)), whose eigenvalues are 2 C along the fibre and
 * 2 C (1 - 1/r) across: negative where the fibre is shortened. */
void bw_fibre_add(double stiffness, const double v[3], const double f[9], bool project,
                  double *energy, double *stress, double *tangent) {
  double w[3], n[3];
  for (int i = 0; i < 3; i++)
    w[i] = bw_dot(f + 3 * (size_t)i, v);
  double r = bw_norm(w), inverse = 1 / fmax(r, 1e-9), c = 2 * stiffness;
  for (int i = 0; i < 3; i++)
    n[i] = w[i] * inverse;
  *energy += stiffness * (r - 1) * (r - 1);
  if (stress)
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        stress[3 * i + k] += c * (r - 1) * n[i] * v[k];
  if (!tangent)
    return;
  double across = 1 - inverse;
  if (project && across < 0)
    across = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
          tangent[9 * (3 * i + j) + 3 * k + l] +=
              c * ((1 - across) * n[i] * n[k] + (i == k ? across : 0)) * v[j] * v[l];
}
