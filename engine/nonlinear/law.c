/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The four laws at a point, in the frame of singular values (docs/theory/data_driven.md). */
#include "barwright/nonlinear.h"

#include <math.h>
#include <string.h>

/* What a law is in the frame: energy w, its first derivatives by the stretches, their Hessian, and
 * of the pairs 12, 13, 23 the eigenvalues of the symmetric (flip) and antisymmetric (twist) change.
 */
typedef struct frame {
  double w, first[3], second[3][3], flip[3], twist[3];
} frame;

static const int pair[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}}; /* i, j, and the third */

/* 2 - 4 / (a + b) needs a + b > 0; it is 0 where the rotation of F is not unique. */
static double sum_of(const double s[3], int i, int j) {
  return fmax(s[i] + s[j], 1e-9);
}

static bool in_frame(bw_law law, double mu, double lambda, const double s[3], frame *f) {
  double j = s[0] * s[1] * s[2], inverse[3], e[3], t;
  switch (law) {
  case BW_NEO_HOOKEAN: {
    if (!(j > 0))
      return false;
    double l = log(j), g = mu - lambda * l;
    f->w = mu * (0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - 3) - l) + 0.5 * lambda * l * l;
    for (int i = 0; i < 3; i++) {
      inverse[i] = 1 / s[i];
      f->first[i] = mu * s[i] - g * inverse[i];
    }
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        f->second[i][k] =
            i == k ? mu + (g + lambda) * inverse[i] * inverse[i] : lambda * inverse[i] * inverse[k];
    for (int p = 0; p < 3; p++) {
      double product = g * inverse[pair[p][0]] * inverse[pair[p][1]];
      f->flip[p] = mu + product;
      f->twist[p] = mu - product;
    }
    return true;
  }
  case BW_ST_VENANT_KIRCHHOFF:
    for (int i = 0; i < 3; i++)
      e[i] = 0.5 * (s[i] * s[i] - 1);
    t = e[0] + e[1] + e[2];
    f->w = mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + 0.5 * lambda * t * t;
    for (int i = 0; i < 3; i++) {
      f->first[i] = s[i] * (2 * mu * e[i] + lambda * t);
      for (int k = 0; k < 3; k++)
        f->second[i][k] =
            lambda * s[i] * s[k] + (i == k ? mu * (3 * s[i] * s[i] - 1) + lambda * t : 0);
    }
    for (int p = 0; p < 3; p++) {
      double a = s[pair[p][0]], b = s[pair[p][1]];
      f->flip[p] = mu * (a * a + a * b + b * b - 1) + lambda * t;
      f->twist[p] = mu * (a * a - a * b + b * b - 1) + lambda * t;
    }
    return true;
  default:
    t = s[0] + s[1] + s[2] - 3;
    f->w = 0;
    for (int i = 0; i < 3; i++) {
      f->w += mu * (s[i] - 1) * (s[i] - 1);
      f->first[i] = 2 * mu * (s[i] - 1);
      for (int k = 0; k < 3; k++)
        f->second[i][k] = i == k ? 2 * mu : 0;
    }
    for (int p = 0; p < 3; p++) {
      f->flip[p] = 2 * mu;
      f->twist[p] = 2 * mu - 4 * mu / sum_of(s, pair[p][0], pair[p][1]);
    }
    if (law == BW_COROTATED) {
      f->w += 0.5 * lambda * t * t;
      for (int i = 0; i < 3; i++) {
        f->first[i] += lambda * t;
        for (int k = 0; k < 3; k++)
          f->second[i][k] += lambda;
      }
      for (int p = 0; p < 3; p++)
        f->twist[p] += 2 * lambda * t / sum_of(s, pair[p][0], pair[p][1]);
    } else {
      f->w += 0.5 * lambda * (j - 1) * (j - 1);
      double slope[3] = {s[1] * s[2], s[0] * s[2], s[0] * s[1]};
      for (int i = 0; i < 3; i++) {
        f->first[i] += lambda * (j - 1) * slope[i];
        for (int k = 0; k < 3; k++)
          f->second[i][k] += lambda * (slope[i] * slope[k] + (i == k ? 0 : (j - 1) * s[3 - i - k]));
      }
      for (int p = 0; p < 3; p++) {
        f->flip[p] -= lambda * (j - 1) * s[pair[p][2]];
        f->twist[p] += lambda * (j - 1) * s[pair[p][2]];
      }
    }
    return true;
  }
}

/* Negative eigenvalues of the stretches' Hessian to zero. */
static void project_stretches(double h[3][3]) {
  double tensor[6] = {h[0][0], h[1][1], h[2][2], h[1][2], h[0][2], h[0][1]}, value[3], vector[9];
  bw_eigen3(tensor, value, vector);
  if (value[2] >= 0)
    return;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      h[i][k] = 0;
      for (int m = 0; m < 3; m++)
        h[i][k] += fmax(value[m], 0) * vector[3 * m + i] * vector[3 * m + k];
    }
}

bool bw_law_energy(bw_law law, double mu, double lambda, const double f[9], double *energy) {
  return bw_law_evaluate(law, mu, lambda, f, false, energy, NULL, NULL);
}

bool bw_law_evaluate(bw_law law, double mu, double lambda, const double f[9], bool project,
                     double *energy, double *stress, double *tangent) {
  double u[9], s[3], v[9], direction[9][9];
  frame in;
  bw_svd3(f, u, s, v);
  if (!in_frame(law, mu, lambda, s, &in))
    return false;
  *energy = in.w;
  /* direction[3 a + b] = u_a v_b^T */
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          direction[3 * a + b][3 * i + k] = u[3 * i + a] * v[3 * k + b];
  if (stress)
    for (int n = 0; n < 9; n++) {
      stress[n] = 0;
      for (int a = 0; a < 3; a++)
        stress[n] += in.first[a] * direction[4 * a][n];
    }
  if (!tangent)
    return true;
  if (project) {
    project_stretches(in.second);
    for (int p = 0; p < 3; p++) {
      in.flip[p] = fmax(in.flip[p], 0);
      in.twist[p] = fmax(in.twist[p], 0);
    }
  }
  for (int m = 0; m < 9; m++)
    for (int n = 0; n < 9; n++) {
      double sum = 0;
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          sum += in.second[a][b] * direction[4 * a][m] * direction[4 * b][n];
      for (int p = 0; p < 3; p++) {
        int i = 3 * pair[p][0] + pair[p][1], k = 3 * pair[p][1] + pair[p][0];
        sum += 0.5 * in.flip[p] * (direction[i][m] + direction[k][m]) *
               (direction[i][n] + direction[k][n]);
        sum += 0.5 * in.twist[p] * (direction[i][m] - direction[k][m]) *
               (direction[i][n] - direction[k][n]);
      }
      tangent[9 * m + n] = sum;
    }
  return true;
}
