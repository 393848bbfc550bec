/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One element, eight points of its rule at a time, one to a lane. Energies, forces and stiffnesses
 * are summed over groups of eight in the lanes, and over the lanes at the end, always in the same
 * order. */
#include "nonlinear/internal.h"

/* Sums over points, still lane by lane. */
typedef struct sums {
  bwi_lanes energy;
  bwi_lanes force[BWI_ELEMENT_FORCES];
  bwi_lanes stiffness[BWI_ELEMENT_NUMBERS + 4]; /* filled up to eights */
} sums;

/* Points first..first + 7 of a rule: gradients of the corners' functions, and weights. */
typedef struct points {
  bwi_lanes gradient[8][3];
  bwi_lanes weight;
} points;

static inline void load(const double *from, int stride, bwi_lanes *to) {
  for (int i = 0; i < BWI_LANES; i++)
    (*to)[i] = from[i * stride];
}

static void points_of(const bw_rule *rule, int32_t first, const double spacing[3], points *p) {
  bwi_lanes at[3], factor[3][2];
  load(rule->weight + first, 1, &p->weight);
  for (int d = 0; d < 3; d++) {
    load(rule->at + 3 * (int64_t)first + d, 3, &at[d]);
    factor[d][0] = 1 - at[d];
    factor[d][1] = at[d];
  }
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, f = (d + 2) % 3;
    double slope = 1 / spacing[d];
    for (int j = 0; j < 2; j++)
      for (int k = 0; k < 2; k++) {
        bwi_lanes product = slope * (factor[e][j] * factor[f][k]);
        int c = j << e | k << f;
        p->gradient[c][d] = -product;
        p->gradient[c | 1 << d][d] = product;
      }
  }
}

static inline void displacement_gradient(const points *p, const double u[8][3], bwi_lanes h[9]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      bwi_lanes sum = u[0][i] * p->gradient[0][k];
      for (int a = 1; a < 8; a++)
        sum += u[a][i] * p->gradient[a][k];
      h[3 * i + k] = sum;
    }
}

/* Constants of points first.. of a material times `volume` and their weights. */
static inline void constants(const bw_solid_material *m, int32_t first, const points *p,
                             double volume, bwi_lanes *mu, bwi_lanes *lambda) {
  bwi_lanes weight = volume * p->weight;
  load(m->mu + first, 1, mu);
  load(m->lambda + first, 1, lambda);
  *mu *= weight;
  *lambda *= weight;
}

/* The response of points first.. of a material times `volume` and their weights. Points of other
 * laws take part in each law's turn as points at rest of constants 0. */
static void respond(const bw_solid_material *m, int32_t first, const points *p, double volume,
                    const bwi_lanes h[9], bwi_want want, bool project, bwi_response *out) {
  bwi_lanes weight = volume * p->weight, mu, lambda, zero = {0};
  constants(m, first, p, volume, &mu, &lambda);
  unsigned laws = 0;
  for (int i = 0; i < BWI_LANES; i++)
    laws |= 1u << m->law[first + i];
  if ((laws & (laws - 1)) == 0)
    bwi_law((bw_law)m->law[first], &mu, &lambda, h, want, project, out);
  else {
    memset(out, 0, sizeof *out);
    for (int law = 0; law < BW_LAWS; law++) {
      bwi_response one;
      bwi_mask own = {0};
      bwi_lanes part[9], own_mu, own_lambda;
      if (!(laws >> law & 1))
        continue;
      for (int i = 0; i < BWI_LANES; i++)
        own[i] = m->law[first + i] == law ? -1 : 0;
      for (int i = 0; i < 9; i++)
        part[i] = BWI_SELECT(own, h[i], zero);
      own_mu = BWI_SELECT(own, mu, zero);
      own_lambda = BWI_SELECT(own, lambda, zero);
      bwi_law((bw_law)law, &own_mu, &own_lambda, part, want, project, &one);
      out->energy += one.energy;
      out->ratio = BWI_SELECT(own, one.ratio, out->ratio);
      out->defined |= own & one.defined;
      for (int i = 0; i < 9 && want >= BWI_STRESS; i++)
        out->stress[i] += one.stress[i];
      for (int i = 0; i < 81 && want >= BWI_TANGENT; i++)
        out->tangent[i] += one.tangent[i];
    }
  }
  for (int k = 0; k < m->fibre_count; k++) {
    int64_t fibre = (int64_t)first * m->fibre_count + k;
    bwi_lanes stiffness, v[3];
    load(m->fibre_stiffness + fibre, m->fibre_count, &stiffness);
    stiffness *= weight;
    for (int d = 0; d < 3; d++)
      load(m->fibre + 3 * fibre + d, 3 * m->fibre_count, &v[d]);
    bwi_fibre(&stiffness, v, h, want, project, out);
  }
}

/* Forces and stiffnesses of eight points; `overwrite`: written, else added to those of others. */
static inline void add_forces(const points *p, const bwi_lanes stress[9], bool overwrite,
                              bwi_lanes *force) {
  for (int a = 0; a < 8; a++)
    for (int i = 0; i < 3; i++) {
      bwi_lanes value = stress[3 * i] * p->gradient[a][0] + stress[3 * i + 1] * p->gradient[a][1] +
                        stress[3 * i + 2] * p->gradient[a][2];
      force[3 * a + i] = overwrite ? value : force[3 * a + i] + value;
    }
}

/* K_ab,ik = sum over j, l of g_aj A_ij,kl g_bl. */
static inline void add_stiffness(const points *p, const bwi_lanes tangent[81], bool overwrite,
                                 bwi_lanes *stiffness) {
  for (int a = 0; a < 8; a++) {
    const bwi_lanes *g = p->gradient[a];
    bwi_lanes t[3][9];
    for (int i = 0; i < 3; i++)
      for (int m = 0; m < 9; m++)
        t[i][m] = g[0] * tangent[27 * i + m] + g[1] * tangent[27 * i + 9 + m] +
                  g[2] * tangent[27 * i + 18 + m];
    for (int b = 0; b < a; b++) {
      bwi_lanes *block = stiffness + bwi_element_block(a, b);
      bwi_lanes x = p->gradient[b][0], y = p->gradient[b][1], z = p->gradient[b][2];
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
          bwi_lanes value = t[i][3 * k] * x + t[i][3 * k + 1] * y + t[i][3 * k + 2] * z;
          block[3 * i + k] = overwrite ? value : block[3 * i + k] + value;
        }
    }
    bwi_lanes *block = stiffness + bwi_element_block(a, a);
    for (int i = 0; i < 3; i++)
      for (int k = i; k < 3; k++, block++) {
        bwi_lanes value = t[i][3 * k] * g[0] + t[i][3 * k + 1] * g[1] + t[i][3 * k + 2] * g[2];
        *block = overwrite ? value : *block + value;
      }
  }
}

/* The same for neo-Hookean points, without their tangent: with h_a = F^-T g_a,
 * K_ab = mu (g_a . g_b) 1 + (mu - lambda ln J) h_b h_a^T + lambda h_a h_b^T. */
static inline void add_neo_hookean(const points *p, const bwi_lanes *mu, const bwi_lanes *lambda,
                                   const bwi_response *response, bool overwrite,
                                   bwi_lanes *stiffness) {
  bwi_lanes h[8][3], scaled[8][3], turned[8][3], zero = {0};
  for (int a = 0; a < 8; a++)
    for (int i = 0; i < 3; i++) {
      const bwi_lanes *g = p->gradient[a], *row = response->inverse + 3 * (size_t)i;
      h[a][i] = row[0] * g[0] + row[1] * g[1] + row[2] * g[2];
      scaled[a][i] = *lambda * h[a][i];
      turned[a][i] = response->factor * h[a][i];
    }
  for (int a = 0; a < 8; a++)
    for (int b = 0; b <= a; b++) {
      const bwi_lanes *x = p->gradient[a], *y = p->gradient[b];
      bwi_lanes *block = stiffness + bwi_element_block(a, b);
      bwi_lanes same = *mu * (x[0] * y[0] + x[1] * y[1] + x[2] * y[2]);
      for (int i = 0; i < 3; i++)
        for (int k = a == b ? i : 0; k < 3; k++, block++) {
          bwi_lanes value =
              h[b][i] * turned[a][k] + scaled[a][i] * h[b][k] + (i == k ? same : zero);
          *block = overwrite ? value : *block + value;
        }
    }
}

/* ((0 + 1) + (2 + 3)) + ((4 + 5) + (6 + 7)) of each of eight vectors. */
static inline void sum_lanes(const bwi_lanes x[8], double out[8]) {
#define EVEN(a, b) __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14)
#define ODD(a, b) __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15)
#define LOW(a, b) __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define HIGH(a, b) __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
  bwi_lanes pair[4], four[2];
  for (int i = 0; i < 4; i++) /* of 2i, 2i+1: 0+1 0+1 2+3 2+3 4+5 4+5 6+7 6+7 */
    pair[i] = EVEN(x[2 * i], x[2 * i + 1]) + ODD(x[2 * i], x[2 * i + 1]);
  for (int i = 0; i < 2; i++) /* of 4i..4i+3: the low halves four sums, the high halves four */
    four[i] = LOW(pair[2 * i], pair[2 * i + 1]) + HIGH(pair[2 * i], pair[2 * i + 1]);
  bwi_lanes sum = __builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 8, 9, 10, 11) +
                  __builtin_shufflevector(four[0], four[1], 4, 5, 6, 7, 12, 13, 14, 15);
  memcpy(out, &sum, sizeof sum);
#undef EVEN
#undef ODD
#undef LOW
#undef HIGH
}

/* Points first.. are all neo-Hookean, and without fibres. */
static inline bool neo_hookean(const bw_solid_material *m, int32_t first) {
  bool all = m->fibre_count == 0;
  for (int i = 0; i < BWI_LANES; i++)
    all = all && m->law[first + i] == BW_NEO_HOOKEAN;
  return all;
}

static void corners(const bw_grid *grid, int32_t element, const double *u, double own[8][3]) {
  const int32_t *node = grid->element + 8 * (int64_t)element;
  for (int a = 0; a < 8; a++)
    memcpy(own[a], u + 3 * (int64_t)node[a], sizeof own[a]);
}

void bwi_cell_evaluate(const bw_solid_material *m, const double spacing[3], double volume,
                       const double own[8][3], bwi_want want, bool project,
                       bwi_hexahedron_state *state, double *force, double *stiffness) {
  points p;
  bwi_lanes h[9], ratio = BWI_ALL(INFINITY), defined_ratio;
  bwi_response response;
  sums sum;
  sum.energy = BWI_ALL(0.0);
  bwi_mask defined = (bwi_mask){0} == 0;
  for (int32_t first = 0; first < m->rule->count; first += BWI_LANES) {
    points_of(m->rule, first, spacing, &p);
    displacement_gradient(&p, own, h);
    bool short_cut = want == BWI_TANGENT && !project && neo_hookean(m, first);
    respond(m, first, &p, volume, h, short_cut ? BWI_STRESS : want, project, &response);
    sum.energy += response.energy;
    defined &= response.defined;
    defined_ratio = response.ratio;
    if (m->empty)
      for (int i = 0; i < BWI_LANES; i++)
        if (m->empty[first + i] && !isnan(defined_ratio[i]))
          defined_ratio[i] = INFINITY;
    ratio = BWI_SELECT(defined_ratio >= ratio, ratio, defined_ratio); /* NaN stays */
    if (want >= BWI_STRESS)
      add_forces(&p, response.stress, first == 0, sum.force);
    if (want < BWI_TANGENT)
      continue;
    if (short_cut) {
      bwi_lanes mu, lambda;
      constants(m, first, &p, volume, &mu, &lambda);
      if (first == 0)
        add_neo_hookean(&p, &mu, &lambda, &response, true, sum.stiffness);
      else
        add_neo_hookean(&p, &mu, &lambda, &response, false, sum.stiffness);
    } else if (first == 0) /* a compiler makes two loops of these */
      add_stiffness(&p, response.tangent, true, sum.stiffness);
    else
      add_stiffness(&p, response.tangent, false, sum.stiffness);
  }
  state->defined = true;
  state->ratio = INFINITY;
  for (int i = 0; i < BWI_LANES; i++) {
    state->defined = state->defined && defined[i];
    if (!(ratio[i] >= state->ratio) && !isnan(state->ratio))
      state->ratio = ratio[i];
  }
  state->energy = ((sum.energy[0] + sum.energy[1]) + (sum.energy[2] + sum.energy[3])) +
                  ((sum.energy[4] + sum.energy[5]) + (sum.energy[6] + sum.energy[7]));
  if (want >= BWI_STRESS)
    for (int i = 0; i < BWI_ELEMENT_FORCES; i += BWI_LANES)
      sum_lanes(sum.force + i, force + i);
  if (want < BWI_TANGENT)
    return;
  double last[BWI_LANES];
  for (int i = 0; i + BWI_LANES <= BWI_ELEMENT_NUMBERS; i += BWI_LANES)
    sum_lanes(sum.stiffness + i, stiffness + i);
  memset(sum.stiffness + BWI_ELEMENT_NUMBERS, 0, 4 * sizeof *sum.stiffness);
  sum_lanes(sum.stiffness + BWI_ELEMENT_NUMBERS - 4, last);
  memcpy(stiffness + BWI_ELEMENT_NUMBERS - 4, last, 4 * sizeof *last);
}

void bwi_element_evaluate(const bw_solid *solid, int32_t element, const double *u, bwi_want want,
                          bool project, bwi_hexahedron_state *state, double *force,
                          double *stiffness) {
  const bw_grid *grid = solid->grid;
  double own[8][3];
  corners(grid, element, u, own);
  bwi_cell_evaluate(solid->material_table->material[grid->material[element]], grid->spacing,
                    bwi_solid_volume(grid, element), (const double(*)[3])own, want, project, state,
                    force, stiffness);
}

bool bwi_element_kirchhoff(const bw_solid *solid, int32_t element, const double *u,
                           double tensor[9], double *ratio) {
  const bw_grid *grid = solid->grid;
  const bw_solid_material *m = solid->material_table->material[grid->material[element]];
  double own[8][3];
  points p;
  bwi_lanes h[9], sum[9], volume = BWI_ALL(0.0);
  bwi_response response;
  bool defined = true;
  memset(sum, 0, sizeof sum);
  corners(grid, element, u, own);
  for (int32_t first = 0; first < m->rule->count; first += BWI_LANES) {
    points_of(m->rule, first, grid->spacing, &p);
    displacement_gradient(&p, own, h);
    respond(m, first, &p, 1, h, BWI_STRESS, false, &response);
    volume += p.weight * response.ratio;
    for (int i = 0; i < BWI_LANES; i++)
      defined = defined && response.defined[i];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        sum[3 * i + j] += response.stress[3 * i + j] + response.stress[3 * i] * h[3 * j] +
                          response.stress[3 * i + 1] * h[3 * j + 1] +
                          response.stress[3 * i + 2] * h[3 * j + 2];
  }
  *ratio = 0;
  memset(tensor, 0, 9 * sizeof *tensor);
  for (int i = 0; i < BWI_LANES; i++) {
    *ratio += volume[i];
    for (int k = 0; k < 9; k++)
      tensor[k] += sum[k][i];
  }
  return defined;
}
