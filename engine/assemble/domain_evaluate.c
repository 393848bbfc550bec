/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries from coefficients: nine numbers in, nine numbers out, by one 9 x 9 map per domain that
 * holds its motion and its material together.
 *
 *   T' = det(A) A^-T T A^-1   and   K_ik = sum_jl C_ijkl T'_jl   give, with B = A^-1,
 *   K_ik = sum_pq T_pq M_ik,pq,     M_ik,pq = det(A) sum_jl C_ijkl B_pj B_ql. */
#include "assemble/domain.h"

#include <math.h>

void bwi_domain_map(const double elasticity[81], const double linear[9], double map[81]) {
  double inverse[9], half[81];
  double determinant = bw_inverse3(linear, inverse);
  for (int ik = 0; ik < 9; ik++) { /* half: B_ql; map: B_pj */
    const double *c = elasticity + 9 * ik;
    for (int j = 0; j < 3; j++)
      for (int q = 0; q < 3; q++)
        half[9 * ik + 3 * j + q] = c[3 * j] * inverse[3 * q] + c[3 * j + 1] * inverse[3 * q + 1] +
                                   c[3 * j + 2] * inverse[3 * q + 2];
    const double *h = half + 9 * ik;
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        map[9 * ik + 3 * p + q] =
            determinant *
            (h[q] * inverse[3 * p] + h[3 + q] * inverse[3 * p + 1] + h[6 + q] * inverse[3 * p + 2]);
  }
}

/* dT' = tr(G) T' - G^T T' - T' G with G = dA A^-1; so M is differentiated through C alone:
 * sum_jl C_ijkl dT'_jl = sum_jl D_ijkl T'_jl. */
void bwi_domain_map_derivative(const double elasticity[81], const double linear[9],
                               const double direction[9], double map[81]) {
  double inverse[9], g[9], changed[81];
  bw_inverse3(linear, inverse);
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      g[3 * r + s] = direction[3 * r] * inverse[s] + direction[3 * r + 1] * inverse[3 + s] +
                     direction[3 * r + 2] * inverse[6 + s];
  double trace = g[0] + g[4] + g[8];
  for (int ik = 0; ik < 9; ik++) {
    const double *c = elasticity + 9 * ik;
    for (int j = 0; j < 3; j++)
      for (int l = 0; l < 3; l++) {
        double sum = trace * c[3 * j + l];
        for (int m = 0; m < 3; m++) /* - C_mk.. G_jm: from (G^T T)_ml; - C_jm G_lm: from (T G) */
          sum -= c[3 * m + l] * g[3 * j + m] + c[3 * j + m] * g[3 * l + m];
        changed[9 * ik + 3 * j + l] = sum;
      }
  }
  bwi_domain_map(changed, linear, map);
}

void bwi_turn_elasticity(const double elasticity[81], const double rotation[9], double turned[81]) {
  /* each pass turns the last index and moves it to the front; four passes turn all and restore the
   * order, which is i k j l here */
  double now[81], next[81];
  memcpy(now, elasticity, sizeof now);
  for (int pass = 0; pass < 4; pass++) {
    for (int rest = 0; rest < 27; rest++)
      for (int r = 0; r < 3; r++)
        next[27 * r + rest] = now[3 * rest] * rotation[3 * r] +
                              now[3 * rest + 1] * rotation[3 * r + 1] +
                              now[3 * rest + 2] * rotation[3 * r + 2];
    memcpy(now, next, sizeof now);
  }
  memcpy(turned, now, sizeof now);
}

void bwi_domain_evaluate(const bwi_domain_coefficients *c, const double map[81], int64_t first,
                         int64_t count, double *out) {
  for (int64_t group = first; group < first + count; group += 4) {
    const bwi_vector *t = (const bwi_vector *)(c->tensor + 9 * group);
    bwi_vector k[9];
    for (int r = 0; r < 9; r++) {
      bwi_vector sum = map[9 * r] * t[0];
      for (int m = 1; m < 9; m++)
        sum += map[9 * r + m] * t[m];
      k[r] = sum;
    }
    int lanes = first + count - group < 4 ? (int)(first + count - group) : 4;
    const double *entry = (const double *)k;
    for (int lane = 0; lane < lanes; lane++) {
      uint32_t place = c->place[group + lane];
      double *block = out + 9 * (int64_t)(place >> 1);
      for (int r = 0; r < 9; r++)
        block[r] = entry[4 * r + lane];
      if (place & 1)
        bwi_make_symmetric(block);
    }
  }
}
