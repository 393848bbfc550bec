/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular values of 3x3 matrices with rotations on both sides. */
#include "barwright/nonlinear.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 12 };

/* Turn columns p and q of b (and of v) so that those of b are orthogonal; true where they were. */
static bool turn(double b[9], double v[9], int p, int q) {
  double pp = 0, qq = 0, pq = 0;
  for (int i = 0; i < 3; i++) {
    pp += b[3 * i + p] * b[3 * i + p];
    qq += b[3 * i + q] * b[3 * i + q];
    pq += b[3 * i + p] * b[3 * i + q];
  }
  if (pq == 0 || !(fabs(pq) > 1e-16 * sqrt(pp * qq)))
    return true;
  double difference = qq - pp, root = hypot(difference, 2 * pq);
  double t = 2 * pq / (difference >= 0 ? difference + root : difference - root);
  double c = 1 / sqrt(1 + t * t), s = c * t;
  for (int i = 0; i < 3; i++) {
    double x = b[3 * i + p], y = b[3 * i + q];
    b[3 * i + p] = c * x - s * y;
    b[3 * i + q] = s * x + c * y;
    x = v[3 * i + p], y = v[3 * i + q];
    v[3 * i + p] = c * x - s * y;
    v[3 * i + q] = s * x + c * y;
  }
  return false;
}

/* Exchange columns p and q; the sign keeps v a rotation. */
static void exchange(double b[9], double v[9], int p, int q) {
  for (int i = 0; i < 3; i++) {
    double x = b[3 * i + p];
    b[3 * i + p] = b[3 * i + q];
    b[3 * i + q] = -x;
    x = v[3 * i + p];
    v[3 * i + p] = v[3 * i + q];
    v[3 * i + q] = -x;
  }
}

static double column_norm(const double b[9], int p) {
  return sqrt(b[p] * b[p] + b[3 + p] * b[3 + p] + b[6 + p] * b[6 + p]);
}

void bw_svd3(const double f[9], double u[9], double s[3], double v[9]) {
  double b[9], column[3][3];
  memcpy(b, f, sizeof b);
  memset(v, 0, 9 * sizeof *v);
  v[0] = v[4] = v[8] = 1;
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    bool first = turn(b, v, 0, 1), second = turn(b, v, 0, 2), third = turn(b, v, 1, 2);
    if (first && second && third)
      break;
  }
  if (column_norm(b, 0) < column_norm(b, 1))
    exchange(b, v, 0, 1);
  if (column_norm(b, 1) < column_norm(b, 2))
    exchange(b, v, 1, 2);
  if (column_norm(b, 0) < column_norm(b, 1))
    exchange(b, v, 0, 1);
  for (int p = 0; p < 3; p++)
    for (int i = 0; i < 3; i++)
      column[p][i] = b[3 * i + p];
  s[0] = bw_norm(column[0]);
  s[1] = bw_norm(column[1]);
  if (s[0] > 0)
    for (int i = 0; i < 3; i++)
      column[0][i] /= s[0];
  else
    column[0][0] = 1;
  double along = bw_dot(column[0], column[1]);
  for (int i = 0; i < 3; i++)
    column[1][i] -= along * column[0][i];
  double length = bw_norm(column[1]);
  if (!(length > 0)) { /* any direction across the first */
    int least = 0;
    for (int i = 1; i < 3; i++)
      if (fabs(column[0][i]) < fabs(column[0][least]))
        least = i;
    for (int i = 0; i < 3; i++)
      column[1][i] = (i == least) - column[0][least] * column[0][i];
    length = bw_norm(column[1]);
  }
  for (int i = 0; i < 3; i++)
    column[1][i] /= length;
  double third[3];
  bw_cross(column[0], column[1], third);
  s[2] = bw_dot(third, column[2]);
  for (int i = 0; i < 3; i++) {
    u[3 * i] = column[0][i];
    u[3 * i + 1] = column[1][i];
    u[3 * i + 2] = third[i];
  }
}
