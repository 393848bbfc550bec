/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular values of 3x3 matrices with rotations on both sides, by one-sided Jacobi rotations:
 * columns of F are turned, pair by pair, until they are orthogonal. What has converged is left
 * exactly as it is, so that a lane does not feel how long the others take. */
#include "nonlinear/law.h"

enum { SWEEPS = 20 };

/* Squared cosine between columns below which they count as orthogonal: twice the rounding. */
#define ORTHOGONAL 2e-31

/* Columns p and q become c p - s q and s p + c q. */
static inline void rotate(bwi_lanes m[9], int p, int q, const bwi_lanes *c, const bwi_lanes *s) {
  for (int i = 0; i < 9; i += 3) {
    bwi_lanes x = m[i + p], y = m[i + q];
    m[i + p] = *c * x - *s * y;
    m[i + q] = *s * x + *c * y;
  }
}

/* Make columns p and q of b orthogonal; moved: the lanes where they were not. */
static inline void turn(bwi_lanes b[9], bwi_lanes v[9], int p, int q, bwi_mask *moved) {
  bwi_lanes pp = b[p] * b[p] + b[3 + p] * b[3 + p] + b[6 + p] * b[6 + p];
  bwi_lanes qq = b[q] * b[q] + b[3 + q] * b[3 + q] + b[6 + q] * b[6 + q];
  bwi_lanes pq = b[p] * b[q] + b[3 + p] * b[3 + q] + b[6 + p] * b[6 + q];
  bwi_mask apart = pq * pq > ORTHOGONAL * pp * qq;
  if (!bwi_any(&apart))
    return;
  *moved |= apart;
  bwi_lanes difference = qq - pp, t, c, s;
  bwi_jacobi(&difference, &pq, &apart, &t, &c, &s);
  rotate(b, p, q, &c, &s);
  rotate(v, p, q, &c, &s);
}

/* Where column p is shorter than q, exchange them; the sign keeps v a rotation. */
static inline void order(bwi_lanes b[9], bwi_lanes v[9], bwi_lanes square[3], int p, int q) {
  bwi_mask wrong = square[p] < square[q];
  bwi_lanes x = square[p], y = square[q];
  square[p] = BWI_SELECT(wrong, y, x);
  square[q] = BWI_SELECT(wrong, x, y);
  for (int i = 0; i < 9; i += 3) {
    x = b[i + p], y = b[i + q];
    b[i + p] = BWI_SELECT(wrong, y, x);
    b[i + q] = BWI_SELECT(wrong, -x, y);
    x = v[i + p], y = v[i + q];
    v[i + p] = BWI_SELECT(wrong, y, x);
    v[i + q] = BWI_SELECT(wrong, -x, y);
  }
}

/* Second columns of length 0 become any direction across the first. */
static void choose_second(const bwi_lanes first[3], bwi_lanes second[3], const bwi_lanes *length) {
  for (int lane = 0; lane < BWI_LANES; lane++) {
    if ((*length)[lane] > 0)
      continue;
    double u[3] = {first[0][lane], first[1][lane], first[2][lane]}, w[3];
    int min = fabs(u[1]) < fabs(u[0]) ? 1 : 0;
    min = fabs(u[2]) < fabs(u[min]) ? 2 : min;
    for (int i = 0; i < 3; i++)
      w[i] = (i == min) - u[min] * u[i];
    double norm = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (int i = 0; i < 3; i++)
      second[i][lane] = w[i] / norm;
  }
}

void bwi_svd(const bwi_lanes f[9], bwi_lanes u[9], bwi_lanes s[3], bwi_lanes v[9]) {
  bwi_lanes b[9], square[3], zero = {0}, one = BWI_ALL(1.0);
  for (int i = 0; i < 9; i++) {
    b[i] = f[i];
    v[i] = i % 4 == 0 ? one : zero;
  }
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    bwi_mask moved = {0};
    turn(b, v, 0, 1, &moved);
    turn(b, v, 0, 2, &moved);
    turn(b, v, 1, 2, &moved);
    if (!bwi_any(&moved))
      break;
  }
  for (int p = 0; p < 3; p++)
    square[p] = b[p] * b[p] + b[3 + p] * b[3 + p] + b[6 + p] * b[6 + p];
  order(b, v, square, 0, 1);
  order(b, v, square, 1, 2);
  order(b, v, square, 0, 1);
  bwi_lanes first[3], second[3], length;
  bwi_sqrt(&square[0], &s[0]);
  bwi_sqrt(&square[1], &s[1]);
  bwi_mask some = s[0] > 0;
  for (int i = 0; i < 3; i++)
    first[i] = BWI_SELECT(some, b[3 * i] / s[0], i == 0 ? one : zero);
  bwi_lanes along = first[0] * b[1] + first[1] * b[4] + first[2] * b[7];
  for (int i = 0; i < 3; i++)
    second[i] = b[3 * i + 1] - along * first[i];
  bwi_lanes size = second[0] * second[0] + second[1] * second[1] + second[2] * second[2];
  bwi_sqrt(&size, &length);
  for (int i = 0; i < 3; i++)
    second[i] = second[i] / length;
  bwi_mask none = ~(length > 0);
  if (bwi_any(&none))
    choose_second(first, second, &length);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    u[3 * i] = first[i];
    u[3 * i + 1] = second[i];
    u[3 * i + 2] = first[j] * second[k] - first[k] * second[j];
  }
  s[2] = u[2] * b[2] + u[5] * b[5] + u[8] * b[8];
}

void bw_svd3(const double f[9], double u[9], double s[3], double v[9]) {
  bwi_lanes in[9], left[9], value[3], right[9];
  for (int i = 0; i < 9; i++)
    in[i] = BWI_ALL(f[i]);
  bwi_svd(in, left, value, right);
  for (int i = 0; i < 9; i++) {
    u[i] = left[i][0];
    v[i] = right[i][0];
  }
  for (int i = 0; i < 3; i++)
    s[i] = value[i][0];
}
