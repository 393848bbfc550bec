/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The four laws. Neo-Hookean and St. Venant-Kirchhoff need singular values only to be projected;
 * their energies and stresses are written in h = F - 1, so that small strains keep their digits. */
#include "nonlinear/law.h"

#include <float.h>

/* ln(1 + j) and j - ln(1 + j), both to their last digits where j is small. With 1 + j = 2^k m,
 * m in [sqrt(1/2), sqrt(2)): ln m = 2 artanh(f / (2 + f)), f = m - 1, by its series. */
static inline void logarithm(const bwi_lanes *j, bwi_lanes *log, bwi_lanes *rest) {
  const int64_t root_half = 0x3FE6A09E667F3BCD;
  /* ln 2 in two parts; the first has so few digits that its multiples are exact */
  const double high = 0x1.62e42fee00000p-1, low = 0x1.a39ef35793c76p-33;
  bwi_lanes x = 1 + *j;
  x = BWI_SELECT(x > 0, x, BWI_ALL(1.0)); /* elsewhere nothing is used, but must not overflow */
  bwi_mask bits = (bwi_mask)x, exponent = (bits - root_half) >> 52;
  bwi_lanes m = (bwi_lanes)(bits - (exponent << 52));
  bwi_lanes k = __builtin_convertvector(exponent, bwi_lanes);
  bwi_mask near = exponent == 0;
  bwi_lanes f = BWI_SELECT(near, *j, m - 1), s = f / (2 + f), z = s * s;
  bwi_lanes series = BWI_ALL(2.0 / 23);
  for (int n = 21; n >= 3; n -= 2)
    series = series * z + 2.0 / n;
  series = series * z * s; /* ln m - 2 s */
  *log = k * high + (2 * s + (series + k * low));
  *rest = BWI_SELECT(near, f * s - series, *j - *log);
}

/* cof(m) with d m : cof = d det. */
static inline void cofactors(const bwi_lanes m[9], bwi_lanes c[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int a = 3 * ((i + 1) % 3), b = 3 * ((i + 2) % 3), p = (j + 1) % 3, q = (j + 2) % 3;
      c[3 * i + j] = m[a + p] * m[b + q] - m[a + q] * m[b + p];
    }
}

static void frame_of(const bwi_lanes h[9], bwi_frame *frame) {
  bwi_lanes f[9];
  for (int i = 0; i < 9; i++)
    f[i] = i % 4 == 0 ? 1 + h[i] : h[i];
  bwi_svd(f, frame->u, frame->s, frame->v);
}

static void project_closed(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda,
                           const bwi_lanes h[9], const bwi_lanes *log, bwi_response *out) {
  bwi_frame frame;
  frame_of(h, &frame);
  frame.energy = *log;
  bwi_frame_law(law, mu, lambda, BWI_TANGENT, &frame);
  bwi_frame_project(&frame);
  bwi_frame_tangent(&frame, out->tangent);
}

/* With C = cof F = (1 + tr h) 1 - h^T + cof h and j = J - 1 = tr h + q:
 *   W = mu (|h|^2 / 2 - q + (j - ln J)) + lambda (ln J)^2 / 2
 *   P = (mu (J F - C) + lambda ln J C) / J,  J F - C = h + h^T + q 1 + j h - cof h
 *   A = mu 1 + (mu - lambda ln J) G_il G_kj + lambda G_ij G_kl,  G = C / J */
static void neo_hookean(const bwi_lanes *mu, const bwi_lanes *lambda, const bwi_lanes h[9],
                        const bwi_lanes cofactor[9], const bwi_lanes *q, const bwi_lanes *j,
                        bwi_want want, bool project, bwi_response *out) {
  bwi_lanes log, rest, trace = h[0] + h[4] + h[8], size = h[0] * h[0];
  out->defined = (out->ratio >= DBL_MIN) & (out->ratio <= DBL_MAX);
  logarithm(j, &log, &rest);
  for (int i = 1; i < 9; i++)
    size += h[i] * h[i];
  out->energy = *mu * (0.5 * size - *q + rest) + 0.5 * *lambda * log * log;
  if (want == BWI_ENERGY)
    return;
  bwi_lanes inverse = 1 / out->ratio, *g = out->inverse, pressure = *lambda * log;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      int i = 3 * r + c, t = 3 * c + r;
      bwi_lanes difference = h[i] + h[t] + *j * h[i] - cofactor[i];
      g[i] = cofactor[i] - h[t];
      if (r == c) {
        difference += *q;
        g[i] += 1 + trace;
      }
      out->stress[i] = (*mu * difference + pressure * g[i]) * inverse;
      g[i] = g[i] * inverse;
    }
  bwi_lanes factor = *mu - pressure;
  out->factor = factor;
  if (want == BWI_STRESS)
    return;
  if (project) {
    project_closed(BW_NEO_HOOKEAN, mu, lambda, h, &log, out);
    return;
  }
  for (int m = 0; m < 9; m++)
    for (int n = m; n < 9; n++) {
      int cross = 3 * (m / 3) + n % 3, other = 3 * (n / 3) + m % 3;
      bwi_lanes value = factor * g[cross] * g[other] + *lambda * g[m] * g[n];
      if (m == n)
        value += *mu;
      out->tangent[9 * m + n] = value;
      out->tangent[9 * n + m] = value;
    }
}

/* P = F S with S = 2 mu E + lambda tr E 1, E = (h + h^T + h^T h) / 2;
 * A = 1_ik S_jl + mu ((F F^T)_ik 1_jl + F_il F_kj) + lambda F_ij F_kl */
static void st_venant_kirchhoff(const bwi_lanes *mu, const bwi_lanes *lambda, const bwi_lanes h[9],
                                bwi_want want, bool project, bwi_response *out) {
  bwi_lanes e[9], f[9], s[9], size = {0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      e[3 * i + j] = 0.5 * (h[3 * i + j] + h[3 * j + i] +
                            (h[i] * h[j] + h[3 + i] * h[3 + j] + h[6 + i] * h[6 + j]));
      size += e[3 * i + j] * e[3 * i + j];
    }
  bwi_lanes trace = e[0] + e[4] + e[8], pressure = *lambda * trace;
  out->defined = (bwi_mask){0} == 0;
  out->energy = *mu * size + 0.5 * pressure * trace;
  if (want == BWI_ENERGY)
    return;
  for (int i = 0; i < 9; i++) {
    f[i] = i % 4 == 0 ? 1 + h[i] : h[i];
    s[i] = 2 * *mu * e[i] + (i % 4 == 0 ? pressure : BWI_ALL(0.0));
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out->stress[3 * i + j] = f[3 * i] * s[j] + f[3 * i + 1] * s[3 + j] + f[3 * i + 2] * s[6 + j];
  if (want == BWI_STRESS)
    return;
  if (project) {
    project_closed(BW_ST_VENANT_KIRCHHOFF, mu, lambda, h, &trace, out);
    return;
  }
  for (int m = 0; m < 9; m++)
    for (int n = m; n < 9; n++) {
      int i = m / 3, j = m % 3, k = n / 3, l = n % 3;
      bwi_lanes value = *mu * f[3 * i + l] * f[3 * k + j] + *lambda * f[m] * f[n];
      if (i == k)
        value += s[3 * j + l];
      if (j == l)
        value +=
            *mu * (f[3 * i] * f[3 * k] + f[3 * i + 1] * f[3 * k + 1] + f[3 * i + 2] * f[3 * k + 2]);
      out->tangent[9 * m + n] = value;
      out->tangent[9 * n + m] = value;
    }
}

static void corotated(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda,
                      const bwi_lanes h[9], bwi_want want, bool project, bwi_response *out) {
  bwi_frame frame;
  frame_of(h, &frame);
  bwi_frame_law(law, mu, lambda, want, &frame);
  out->defined = (bwi_mask){0} == 0;
  out->energy = frame.energy;
  if (want == BWI_ENERGY)
    return;
  bwi_frame_stress(&frame, out->stress);
  if (want == BWI_STRESS)
    return;
  if (project)
    bwi_frame_project(&frame);
  bwi_frame_tangent(&frame, out->tangent);
}

void bwi_law(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda, const bwi_lanes h[9],
             bwi_want want, bool project, bwi_response *out) {
  bwi_lanes c[9];
  cofactors(h, c);
  bwi_lanes minors = c[0] + c[4] + c[8], determinant = h[0] * c[0] + h[1] * c[1] + h[2] * c[2];
  bwi_lanes q = minors + determinant, j = h[0] + h[4] + h[8] + q;
  out->ratio = 1 + j;
  if (law == BW_NEO_HOOKEAN)
    neo_hookean(mu, lambda, h, c, &q, &j, want, project, out);
  else if (law == BW_ST_VENANT_KIRCHHOFF)
    st_venant_kirchhoff(mu, lambda, h, want, project, out);
  else
    corotated(law, mu, lambda, h, want, project, out);
}

/* One point in all lanes. */
static void in_all(const double f[9], bwi_lanes h[9]) {
  for (int i = 0; i < 9; i++)
    h[i] = BWI_ALL(i % 4 == 0 ? f[i] - 1 : f[i]);
}

bool bw_law_evaluate(bw_law law, double mu, double lambda, const double f[9], bool project,
                     double *energy, double *stress, double *tangent) {
  bwi_response response;
  bwi_lanes h[9], both[2] = {BWI_ALL(mu), BWI_ALL(lambda)};
  in_all(f, h);
  bwi_law(law, &both[0], &both[1], h,
          tangent  ? BWI_TANGENT
          : stress ? BWI_STRESS
                   : BWI_ENERGY,
          project, &response);
  if (!response.defined[0])
    return false;
  *energy = response.energy[0];
  for (int i = 0; i < 9 && stress; i++)
    stress[i] = response.stress[i][0];
  for (int i = 0; i < 81 && tangent; i++)
    tangent[i] = response.tangent[i][0];
  return true;
}

void bw_fibre_add(double stiffness, const double v[3], const double f[9], bool project,
                  double *energy, double *stress, double *tangent) {
  bwi_response response;
  bwi_lanes h[9], direction[3], c = BWI_ALL(stiffness);
  memset(&response, 0, sizeof response);
  in_all(f, h);
  for (int i = 0; i < 3; i++)
    direction[i] = BWI_ALL(v[i]);
  bwi_fibre(&c, direction, h,
            tangent  ? BWI_TANGENT
            : stress ? BWI_STRESS
                     : BWI_ENERGY,
            project, &response);
  *energy += response.energy[0];
  for (int i = 0; i < 9 && stress; i++)
    stress[i] += response.stress[i][0];
  for (int i = 0; i < 81 && tangent; i++)
    tangent[i] += response.tangent[i][0];
}
