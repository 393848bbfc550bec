/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Laws in the frame of singular values, where the 9x9 tangent of an isotropic energy falls apart
 * into the Hessian of the stretches and one symmetric 2x2 block for each pair of directions. */
#include "nonlinear/law.h"

/* i, j and the direction that is neither. */
static const int pair[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}};
/* Place of (i, j) in 00 11 22 12 02 01. */
static const int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

/* The rotation of F is not unique where two stretches add up to zero; the corotated laws have a
 * crease there, and their twists are those of a point this far from it. */
#define MIN_SUM 1e-9

static void neo_hookean(const bwi_lanes *mu, const bwi_lanes *lambda, bwi_frame *f) {
  /* energy and stress come from the closed form (law.c); in f->energy: ln J */
  bwi_lanes g = *mu - *lambda * f->energy, inverse[3];
  for (int i = 0; i < 3; i++)
    inverse[i] = 1 / f->s[i];
  for (int i = 0; i < 3; i++)
    f->second[i] = *mu + (g + *lambda) * inverse[i] * inverse[i];
  for (int p = 0; p < 3; p++) {
    bwi_lanes product = inverse[pair[p][0]] * inverse[pair[p][1]];
    f->second[5 - p] = *lambda * product;
    f->flip[p] = *mu + g * product;
    f->twist[p] = *mu - g * product;
  }
}

static void st_venant_kirchhoff(const bwi_lanes *mu, const bwi_lanes *lambda, bwi_frame *f) {
  const bwi_lanes *s = f->s;
  bwi_lanes square[3] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
  bwi_lanes pressure = *lambda * 0.5 * (square[0] + square[1] + square[2] - 3);
  for (int i = 0; i < 3; i++)
    f->second[i] = *lambda * square[i] + *mu * (3 * square[i] - 1) + pressure;
  for (int p = 0; p < 3; p++) {
    int i = pair[p][0], j = pair[p][1];
    bwi_lanes product = s[i] * s[j], sum = square[i] + square[j] - 1;
    f->second[5 - p] = *lambda * product;
    f->flip[p] = *mu * (sum + product) + pressure;
    f->twist[p] = *mu * (sum - product) + pressure;
  }
}

/* Both corotated laws: mu sum (s - 1)^2 and, of lambda, half the square of tr S - 3 or of J - 1. */
static void corotated(bool fixed, const bwi_lanes *mu, const bwi_lanes *lambda, bwi_want want,
                      bwi_frame *f) {
  const bwi_lanes *s = f->s;
  bwi_lanes d[3] = {s[0] - 1, s[1] - 1, s[2] - 1}, two = 2 * *mu;
  bwi_lanes slope[3] = {s[1] * s[2], s[0] * s[2], s[0] * s[1]}, one = BWI_ALL(1.0);
  bwi_lanes change = fixed ? s[0] * slope[0] - 1 : d[0] + d[1] + d[2], pressure = *lambda * change;
  f->energy = *mu * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + 0.5 * pressure * change;
  for (int i = 0; i < 3; i++)
    f->first[i] = two * d[i] + pressure * (fixed ? slope[i] : one);
  if (want < BWI_TANGENT)
    return;
  for (int i = 0; i < 3; i++)
    f->second[i] = two + *lambda * (fixed ? slope[i] * slope[i] : one);
  for (int p = 0; p < 3; p++) {
    int i = pair[p][0], j = pair[p][1];
    bwi_lanes sum = BWI_MAX(s[i] + s[j], BWI_ALL(MIN_SUM));
    if (fixed) {
      bwi_lanes third = pressure * s[pair[p][2]];
      f->second[5 - p] = *lambda * slope[i] * slope[j] + third;
      f->flip[p] = two - third;
      f->twist[p] = two - 2 * two / sum + third;
    } else {
      f->second[5 - p] = *lambda;
      f->flip[p] = two;
      f->twist[p] = two + 2 * (pressure - two) / sum;
    }
  }
}

void bwi_frame_law(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda, bwi_want want,
                   bwi_frame *frame) {
  if (law == BW_NEO_HOOKEAN)
    neo_hookean(mu, lambda, frame);
  else if (law == BW_ST_VENANT_KIRCHHOFF)
    st_venant_kirchhoff(mu, lambda, frame);
  else
    corotated(law == BW_FIXED_COROTATED, mu, lambda, want, frame);
}

enum { SWEEPS = 20 };

/* Jacobi's rotation of h (as `second`) that makes (p, q) zero; r is the third row. */
static inline void turn(bwi_lanes h[6], bwi_lanes v[9], int p, int q, int r, bwi_mask *moved) {
  bwi_lanes pq = h[place[p][q]], pr = h[place[p][r]], qr = h[place[q][r]];
  bwi_lanes scale = h[0] * h[0] + h[1] * h[1] + h[2] * h[2];
  bwi_mask apart = pq * pq > 1e-32 * scale;
  *moved |= apart;
  bwi_lanes difference = h[q] - h[p], t, c, s;
  bwi_jacobi(&difference, &pq, &apart, &t, &c, &s);
  h[p] -= t * pq;
  h[q] += t * pq;
  h[place[p][q]] = BWI_SELECT(apart, BWI_ALL(0.0), pq);
  h[place[p][r]] = c * pr - s * qr;
  h[place[q][r]] = s * pr + c * qr;
  for (int i = 0; i < 9; i += 3) {
    bwi_lanes x = v[i + p], y = v[i + q];
    v[i + p] = c * x - s * y;
    v[i + q] = s * x + c * y;
  }
}

/* Negative eigenvalues of the stretches' Hessian become 0, in the lanes that have any. */
static void project_stretches(bwi_lanes second[6]) {
  bwi_lanes minor = second[0] * second[1] - second[5] * second[5];
  bwi_lanes determinant = second[2] * minor - second[1] * second[4] * second[4] -
                          second[0] * second[3] * second[3] + 2 * second[3] * second[4] * second[5];
  bwi_mask doubtful = ~((second[0] > 0) & (minor > 0) & (determinant > 0));
  if (!bwi_any(&doubtful))
    return;
  bwi_lanes h[6], v[9], zero = {0}, one = BWI_ALL(1.0);
  memcpy(h, second, sizeof h);
  for (int i = 0; i < 9; i++)
    v[i] = i % 4 == 0 ? one : zero;
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    bwi_mask moved = {0};
    turn(h, v, 0, 1, 2, &moved);
    turn(h, v, 0, 2, 1, &moved);
    turn(h, v, 1, 2, 0, &moved);
    if (!bwi_any(&moved))
      break;
  }
  bwi_mask negative = doubtful & ((h[0] < 0) | (h[1] < 0) | (h[2] < 0));
  for (int k = 0; k < 3; k++)
    h[k] = BWI_MAX(h[k], zero);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      bwi_lanes sum = h[0] * v[3 * i] * v[3 * j] + h[1] * v[3 * i + 1] * v[3 * j + 1] +
                      h[2] * v[3 * i + 2] * v[3 * j + 2];
      second[place[i][j]] = BWI_SELECT(negative, sum, second[place[i][j]]);
    }
}

void bwi_frame_project(bwi_frame *frame) {
  bwi_lanes zero = {0};
  project_stretches(frame->second);
  for (int p = 0; p < 3; p++) {
    frame->flip[p] = BWI_MAX(frame->flip[p], zero);
    frame->twist[p] = BWI_MAX(frame->twist[p], zero);
  }
}

void bwi_frame_stress(const bwi_frame *frame, bwi_lanes stress[9]) {
  const bwi_lanes *u = frame->u, *v = frame->v, *first = frame->first;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      stress[3 * i + j] = u[3 * i] * first[0] * v[3 * j] + u[3 * i + 1] * first[1] * v[3 * j + 1] +
                          u[3 * i + 2] * first[2] * v[3 * j + 2];
}

/* A = sum over m of D_m (x) C_m, where D_(ij) = u_i v_j^T, and C is the frame's tangent applied to
 * D: of D_ii the sum of second_ik D_kk, of D_ij half (flip + twist) D_ij + (flip - twist) D_ji. */
void bwi_frame_tangent(const bwi_frame *frame, bwi_lanes tangent[81]) {
  bwi_lanes d[9][9], c[9][9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int m = 0; m < 9; m++)
        d[3 * i + j][m] = frame->u[3 * (m / 3) + i] * frame->v[3 * (m % 3) + j];
  for (int i = 0; i < 3; i++)
    for (int m = 0; m < 9; m++)
      c[4 * i][m] = frame->second[place[i][0]] * d[0][m] + frame->second[place[i][1]] * d[4][m] +
                    frame->second[place[i][2]] * d[8][m];
  for (int p = 0; p < 3; p++) {
    int ij = 3 * pair[p][0] + pair[p][1], ji = 3 * pair[p][1] + pair[p][0];
    bwi_lanes same = 0.5 * (frame->flip[p] + frame->twist[p]);
    bwi_lanes across = 0.5 * (frame->flip[p] - frame->twist[p]);
    for (int m = 0; m < 9; m++) {
      c[ij][m] = same * d[ij][m] + across * d[ji][m];
      c[ji][m] = same * d[ji][m] + across * d[ij][m];
    }
  }
  for (int m = 0; m < 9; m++)
    for (int n = m; n < 9; n++) {
      bwi_lanes sum = d[0][m] * c[0][n];
      for (int k = 1; k < 9; k++)
        sum += d[k][m] * c[k][n];
      tangent[9 * m + n] = sum;
      tangent[9 * n + m] = sum;
    }
}
