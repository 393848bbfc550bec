/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One three-node triangle of the stabilised equations: linear velocity, pressure and temperature.
 * Every integral is exact: with gradients constant and the convecting velocity a linear in the
 * element only integrals of products of corner functions occur,
 *
 *   int N_i N_j = A (1 + d_ij) / 12,   int a N_j = A (sum a + a_j) / 12,
 *   int a a^T = A (sum a_k a_k^T + (sum a)(sum a)^T) / 12.
 *
 * docs/theory/responsive.md, "Flow and heat". */
#include <math.h>
#include <string.h>

#include "flow/internal.h"

static double dot2(const double a[2], const double b[2]) {
  return a[0] * b[0] + a[1] * b[1];
}

/* 1/tau^2 = a . G a + 9/2 k^2 G : G with the metric G = 2 sum g_i g_i^T, 4/h^2 times the identity
 * for an equilateral triangle: then the terms are (2 |a|/h)^2 and (12 k/h^2)^2. The step in time is
 * left out on purpose: with it the equations in space would change with the step, and what short
 * steps converge to would not be what they stand for. */
static double intrinsic_time(const double metric[3], const double a[2], double diffusion) {
  double convective =
      metric[0] * a[0] * a[0] + metric[1] * a[1] * a[1] + 2 * metric[2] * a[0] * a[1];
  double square = metric[0] * metric[0] + metric[1] * metric[1] + 2 * metric[2] * metric[2];
  double sum = convective + 4.5 * diffusion * diffusion * square;
  return sum > 0 ? 1 / sqrt(sum) : 0;
}

bool bwi_flow_element_make(const bwi_linear *linear, int32_t element, bwi_flow_element *made) {
  const bw_plane_mesh *mesh = linear->mesh;
  const bw_flow_description *about = linear->about;
  const int32_t *node = mesh->topology->element + 3 * (int64_t)element;
  const double *x[3];
  *made = (bwi_flow_element){0};
  for (int i = 0; i < 3; i++)
    x[i] = mesh->point + 2 * (int64_t)node[i];
  double twice =
      (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]);
  if (!(twice > 0))
    return false;
  made->area = twice / 2;
  double metric[3] = {0};
  for (int i = 0; i < 3; i++) {
    const double *b = x[(i + 1) % 3], *c = x[(i + 2) % 3];
    double *g = made->gradient[i];
    g[0] = (b[1] - c[1]) / twice;
    g[1] = (c[0] - b[0]) / twice;
    metric[0] += 2 * g[0] * g[0];
    metric[1] += 2 * g[1] * g[1];
    metric[2] += 2 * g[0] * g[1];
    for (int d = 0; d < 2; d++) {
      made->convection[i][d] = linear->convect[2 * (int64_t)node[i] + d];
      made->mean[d] += made->convection[i][d] / 3;
    }
  }
  made->tau = intrinsic_time(metric, made->mean, about->viscosity / about->density);
  made->divergence = 1 / (made->tau * (metric[0] + metric[1]));
  if (linear->components == 4)
    made->tau_heat = intrinsic_time(metric, made->mean, about->diffusivity);
  if (linear->newton)
    for (int i = 0; i < 3; i++) {
      const double *state = linear->newton + linear->components * (int64_t)node[i];
      for (int d = 0; d < 2; d++) {
        for (int c = 0; c < 2; c++)
          made->velocity_slope[c][d] += state[c] * made->gradient[i][d];
        if (linear->components == 4)
          made->heat_slope[d] += state[3] * made->gradient[i][d];
      }
    }
  return true;
}

/* What appears in several terms: int N_i N_j, and int (a . grad N_i) N_j. */
typedef struct products {
  double mass[3][3], along[3][3];
} products;

static products make_products(const bwi_flow_element *e) {
  products p;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum[2] = {3 * e->mean[0] + e->convection[j][0], 3 * e->mean[1] + e->convection[j][1]};
      p.mass[i][j] = e->area / 12 * (i == j ? 2 : 1);
      p.along[i][j] = e->area / 12 * dot2(sum, e->gradient[i]);
    }
  return p;
}

/* c, the number of components, is a constant wherever this is expanded. */
static inline __attribute__((always_inline)) void
fill_matrix(const bwi_linear *linear, const bwi_flow_element *e, int c, double *matrix) {
  const bw_flow_description *about = linear->about;
  int n = 3 * c;
  double rho = about->density, mu = about->viscosity, area = e->area, third = area / 3;
  double tau = e->tau, rate = linear->rate;
  products p = make_products(e);
  double square[2][2] = {{0}}; /* int a a^T */
  for (int r = 0; r < 2; r++)
    for (int s = 0; s < 2; s++) {
      square[r][s] = 9 * e->mean[r] * e->mean[s];
      for (int k = 0; k < 3; k++)
        square[r][s] += e->convection[k][r] * e->convection[k][s];
      square[r][s] *= area / 12;
    }
  memset(matrix, 0, (size_t)(n * n) * sizeof *matrix);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const double *gi = e->gradient[i], *gj = e->gradient[j];
      double *m = matrix + n * c * i + c * j; /* entry (r, s) at m[n r + s] */
      double diffuse = area * dot2(gi, gj);
      double convect = p.along[j][i]; /* int N_i a . grad N_j */
      double streamed = gi[0] * (square[0][0] * gj[0] + square[0][1] * gj[1]) +
                        gi[1] * (square[1][0] * gj[0] + square[1][1] * gj[1]);
      double test = p.mass[i][j] + tau * p.along[i][j]; /* Galerkin and streamline test of N_j */
      double same = rho * (rate * test + convect + tau * streamed) + mu * diffuse;
      double ai = dot2(e->mean, gi), aj = dot2(e->mean, gj);
      for (int r = 0; r < 2; r++) {
        m[n * r + r] += same;
        for (int s = 0; s < 2; s++)
          m[n * r + s] +=
              rho * (e->divergence * area * gi[r] * gj[s] + test * e->velocity_slope[r][s]);
        m[n * r + 2] += -third * gi[r] + tau * area * ai * gj[r];
        m[n * 2 + r] += third * gj[r] + tau * gi[r] * (rate * third + area * aj);
        for (int s = 0; s < 2; s++)
          m[n * 2 + r] += tau * third * gi[s] * e->velocity_slope[s][r];
      }
      m[n * 2 + 2] += tau / rho * diffuse;
      if (c < 4)
        continue;
      double heat = p.mass[i][j] + e->tau_heat * p.along[i][j];
      m[n * 3 + 3] += rate * heat + convect + e->tau_heat * streamed + about->diffusivity * diffuse;
      for (int r = 0; r < 2; r++) {
        /* buoyancy -beta g (T - T0), on the left */
        m[n * r + 3] += rho * about->expansion * about->gravity[r] * test;
        m[n * 2 + 3] += tau * third * about->expansion * about->gravity[r] * gi[r];
        m[n * 3 + r] += heat * e->heat_slope[r];
      }
    }
}

void bwi_flow_element_matrix(const bwi_linear *linear, const bwi_flow_element *e, double *matrix) {
  if (linear->components == 4)
    fill_matrix(linear, e, 4, matrix);
  else
    fill_matrix(linear, e, 3, matrix);
}

void bwi_flow_element_vector(const bwi_linear *linear, int32_t element, const bwi_flow_element *e,
                             double *vector) {
  const bw_flow_description *about = linear->about;
  const int32_t *node = linear->mesh->topology->element + 3 * (int64_t)element;
  int c = linear->components;
  products p = make_products(e);
  memset(vector, 0, (size_t)(3 * c) * sizeof *vector);
  for (int j = 0; j < 3; j++) {
    double source[2], heat = 0;
    for (int d = 0; d < 2; d++) {
      source[d] =
          c == 4 ? about->expansion * about->reference * about->gravity[d] : about->gravity[d];
      source[d] += linear->history[c * (int64_t)node[j] + d];
    }
    if (c == 4)
      heat = linear->history[c * (int64_t)node[j] + 3];
    if (linear->newton) {
      const double *state = linear->newton + c * (int64_t)node[j];
      for (int d = 0; d < 2; d++)
        source[d] += dot2(e->velocity_slope[d], state);
      heat += dot2(e->heat_slope, state);
    }
    for (int i = 0; i < 3; i++) {
      double test = p.mass[i][j] + e->tau * p.along[i][j];
      for (int d = 0; d < 2; d++)
        vector[c * i + d] += about->density * test * source[d];
      vector[c * i + 2] += e->tau * e->area / 3 * dot2(e->gradient[i], source);
      if (c == 4)
        vector[c * i + 3] += (p.mass[i][j] + e->tau_heat * p.along[i][j]) * heat;
    }
  }
  /* Linear functions have no second derivatives of their own; left out of the stabilisation they
     would make it an error of first order. */
  const double *laplacian = linear->laplacian + 3 * (int64_t)element;
  double viscous[2] = {about->viscosity * laplacian[0], about->viscosity * laplacian[1]};
  for (int i = 0; i < 3; i++) {
    const double *g = e->gradient[i];
    double streamed = e->area * dot2(e->mean, g);
    for (int d = 0; d < 2; d++)
      vector[c * i + d] += e->tau * streamed * viscous[d];
    vector[c * i + 2] += e->tau / about->density * e->area * dot2(g, viscous);
    if (c == 4)
      vector[c * i + 3] += e->tau_heat * streamed * about->diffusivity * laplacian[2];
  }
}
