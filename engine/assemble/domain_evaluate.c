/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries from coefficients: nine numbers in, nine numbers out, by one 9 x 9 map per domain that
 * holds its motion and its material together.
 *
 *   T' = det(A) A^-T T A^-1   and   K_ik = sum_jl C_ijkl T'_jl   give, with B = A^-1,
 *   K_ik = sum_pq T_pq M_pq,ik,     M_pq,ik = det(A) sum_jl C_ijkl B_pj B_ql. */
#include "assemble/domain.h"

#ifdef __FMA__
#include <immintrin.h>
#endif

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
        map[9 * (3 * p + q) + ik] =
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

void bwi_domain_elasticity(const bw_domain_stiffness *stiffness, const double frame[9],
                           double elasticity[81]) {
  const bwi_domain_coefficients *c = stiffness->coefficients;
  if (!c->turning_matters || !stiffness->material_turns) {
    memcpy(elasticity, c->elasticity, sizeof c->elasticity);
    return;
  }
  double rotation[9];
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      rotation[3 * r + s] = frame[3 * s + r];
  bwi_turn_elasticity(c->elasticity, rotation, elasticity);
}

/* The sums stay in registers only where everything is inlined. */
#define INLINED __attribute__((always_inline)) static inline

/* y += a * x, rounded once where the processor can. Through pointers: without AVX, vectors that are
 * passed or returned by value change the calling convention, which compilers warn of. */
static inline void add_product(double a, const bwi_vector *x, bwi_vector *y) {
#ifdef __FMA__
  *y = (bwi_vector)_mm256_fmadd_pd(_mm256_set1_pd(a), (__m256d)*x, (__m256d)*y);
#else
  *y += a * *x;
#endif
}

/* Rows to columns. */
static inline void transpose(const bwi_vector *in, bwi_vector out[4]) {
  bwi_vector a = __builtin_shufflevector(in[0], in[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(in[0], in[1], 1, 5, 3, 7),
             c = __builtin_shufflevector(in[2], in[3], 0, 4, 2, 6),
             d = __builtin_shufflevector(in[2], in[3], 1, 5, 3, 7);
  out[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  out[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  out[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/* sum[0..8] and, of the four pairs after, sum[9..17] += map of the coefficients. Both share what is
 * read of the map: it is this, more than the sums, that would take the time. */
INLINED void add_eight(const double *map, const double *tensor, bwi_vector sum[18]) {
  for (int m = 0; m < 9; m++) {
    bwi_vector t = *(const bwi_vector *)(tensor + 4 * m);
    bwi_vector u = *(const bwi_vector *)(tensor + 36 + 4 * m);
    for (int r = 0; r < 9; r++) {
      add_product(map[9 * m + r], &t, &sum[r]);
      add_product(map[9 * m + r], &u, &sum[9 + r]);
    }
  }
}

INLINED void add_four(const double *map, const double *tensor, bwi_vector sum[9]) {
  for (int m = 0; m < 9; m++) {
    bwi_vector t = *(const bwi_vector *)(tensor + 4 * m);
    for (int r = 0; r < 9; r++)
      add_product(map[9 * m + r], &t, &sum[r]);
  }
}

INLINED void store(const bwi_vector sum[9], const uint32_t *place, int pairs, double *out) {
  bwi_vector low[4], high[4], last = sum[8];
  transpose(sum, low);
  transpose(sum + 4, high);
  for (int k = 0; k < pairs; k++) {
    double *block = out + 9 * (int64_t)(place[k] >> 1);
    *(bwi_vector *)block = low[k];
    *(bwi_vector *)(block + 4) = high[k];
    block[8] = last[k];
    if (place[k] & 1)
      bwi_make_symmetric(block);
  }
}

/* A block's map, and its coefficients as they count now. */
typedef struct present_block {
  const double *map, *tensor;
} present_block;

static present_block block_of(const bwi_domain_coefficients *c, int32_t domain_count,
                              int64_t block) {
  int32_t domain = c->block_domain[block];
  return (present_block){c->map + 81 * (int64_t)domain,
                         c->written[domain].reshaped && block >= domain_count
                             ? c->present +
                                   9 * (c->block_first[block] - c->block_first[domain_count])
                             : c->tensor + 9 * c->block_first[block]};
}

/* Pairs [k, end) that a fixed number of blocks contribute to, 1 or 2. */
INLINED void evaluate(int blocks, present_block a, present_block b, const uint32_t *place,
                      int64_t k, int64_t end, double *out) {
  for (; k + 8 <= end; k += 8) {
    bwi_vector sum[18] = {{0}};
    add_eight(a.map, a.tensor + 9 * k, sum);
    if (blocks == 2)
      add_eight(b.map, b.tensor + 9 * k, sum);
    store(sum, place + k, 4, out);
    store(sum + 9, place + k + 4, 4, out);
  }
  for (; k < end; k += 4) {
    bwi_vector sum[9] = {{0}};
    add_four(a.map, a.tensor + 9 * k, sum);
    if (blocks == 2)
      add_four(b.map, b.tensor + 9 * k, sum);
    store(sum, place + k, end - k < 4 ? (int)(end - k) : 4, out);
  }
}

void bwi_domain_evaluate(const bwi_domain_coefficients *c, int32_t domain_count, int64_t section,
                         int64_t first, int64_t size, double *out) {
  const uint32_t *place = c->place + c->section_start[section];
  int64_t low = c->block_start[section], high = c->block_start[section + 1];
  int64_t k = first, end = first + size;
  present_block a = block_of(c, domain_count, low);
  if (high - low == 1)
    evaluate(1, a, a, place, k, end, out);
  else if (high - low == 2)
    evaluate(2, a, block_of(c, domain_count, low + 1), place, k, end, out);
  else
    for (; k < end; k += 4) {
      bwi_vector sum[9] = {{0}};
      for (int64_t b = low; b < high; b++) {
        a = block_of(c, domain_count, b);
        add_four(a.map, a.tensor + 9 * k, sum);
      }
      store(sum, place + k, end - k < 4 ? (int)(end - k) : 4, out);
    }
}
