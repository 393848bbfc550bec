/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small vectors and symmetric 3x3 tensors, stored xx yy zz yz zx xy. */
#include "barwright/base.h"

#include <math.h>
#include <string.h>

double bw_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void bw_cross(const double a[3], const double b[3], double c[3]) {
  double x = a[1] * b[2] - a[2] * b[1];
  double y = a[2] * b[0] - a[0] * b[2];
  double z = a[0] * b[1] - a[1] * b[0];
  c[0] = x;
  c[1] = y;
  c[2] = z;
}

double bw_norm(const double a[3]) {
  return sqrt(bw_dot(a, a));
}

void bw_across(const double unit[3], double a[3], double b[3]) {
  int min =
      0; /* the axis most across; the margin keeps rounding from choosing between equal ones */
  for (int k = 1; k < 3; k++)
    if (fabs(unit[k]) < fabs(unit[min]) - 1e-9)
      min = k;
  double axis[3] = {min == 0, min == 1, min == 2};
  bw_cross(unit, axis, a);
  double size = bw_norm(a);
  for (int k = 0; k < 3; k++)
    a[k] /= size;
  bw_cross(unit, a, b);
}

double bw_inverse3(const double a[9], double inverse[9]) {
  double c0 = a[4] * a[8] - a[5] * a[7];
  double c1 = a[5] * a[6] - a[3] * a[8];
  double c2 = a[3] * a[7] - a[4] * a[6];
  double determinant = a[0] * c0 + a[1] * c1 + a[2] * c2;
  if (determinant == 0)
    return 0;
  double r = 1 / determinant;
  double out[9] = {c0 * r, (a[2] * a[7] - a[1] * a[8]) * r, (a[1] * a[5] - a[2] * a[4]) * r,
                   c1 * r, (a[0] * a[8] - a[2] * a[6]) * r, (a[2] * a[3] - a[0] * a[5]) * r,
                   c2 * r, (a[1] * a[6] - a[0] * a[7]) * r, (a[0] * a[4] - a[1] * a[3]) * r};
  memcpy(inverse, out, sizeof out);
  return determinant;
}

/* One Jacobi rotation that clears a[p][q]; the rows of v collect the rotations. */
static void rotate(double a[3][3], double v[3][3], int p, int q) {
  if (a[p][q] == 0)
    return;
  double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  double c = 1 / sqrt(t * t + 1), s = t * c;
  int r = 3 - p - q;
  double apq = a[p][q], arp = a[r][p], arq = a[r][q];
  a[p][p] -= t * apq;
  a[q][q] += t * apq;
  a[p][q] = a[q][p] = 0;
  a[r][p] = a[p][r] = c * arp - s * arq;
  a[r][q] = a[q][r] = s * arp + c * arq;
  for (int k = 0; k < 3; k++) {
    double vp = v[p][k], vq = v[q][k];
    v[p][k] = c * vp - s * vq;
    v[q][k] = s * vp + c * vq;
  }
}

void bw_eigen3(const double tensor[6], double values[3], double vectors[9]) {
  double a[3][3] = {{tensor[0], tensor[5], tensor[4]},
                    {tensor[5], tensor[1], tensor[3]},
                    {tensor[4], tensor[3], tensor[2]}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  /* Cyclic Jacobi converges quadratically: five or six sweeps reach rounding. */
  for (int sweep = 0; sweep < 12; sweep++) {
    double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
    double diagonal = fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]);
    if (!(off > 1e-17 * diagonal))
      break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2 - i; j++)
      if (a[order[j]][order[j]] < a[order[j + 1]][order[j + 1]]) {
        int swap = order[j];
        order[j] = order[j + 1];
        order[j + 1] = swap;
      }
  for (int i = 0; i < 3; i++) {
    values[i] = a[order[i]][order[i]];
    if (vectors)
      memcpy(vectors + 3 * i, v[order[i]], 3 * sizeof(double));
  }
}

double bw_von_mises(const double s[6]) {
  double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  double shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
  return sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
}
