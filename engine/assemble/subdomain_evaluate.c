/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entries from coefficients: nine numbers in, nine numbers out, by one map per subdomain that holds
 * its motion and its material together.
 *
 *   T' = det(A) A^-T T A^-1   and   K_ik = sum_jl C_ijkl T'_jl   give, with B = A^-1,
 *   K_ik = sum_pq T_pq M_pq,ik,     M_pq,ik = det(A) sum_jl C_ijkl B_pj B_ql.
 *
 * As C_ijkl = C_klij, the transpose of T makes the transpose of K: the symmetric half of T makes
 * that of K and the skew half that of K. So 36 + 9 numbers of M serve, and not 81. */
#include "assemble/subdomain.h"

#ifdef __FMA__
#include <immintrin.h>
#endif

/* Rows and columns of the coefficients, in their order: the symmetric half, then the skew one. */
static const int upper[9][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2},
                                {2, 2}, {0, 1}, {0, 2}, {1, 2}};

void bwi_subdomain_halves(const bwi_vector t[3], int numbers, double *out) {
  for (int m = 0; m < numbers; m++) {
    int p = upper[m][0], q = upper[m][1];
    out[4 * m] = p == q ? t[p][p] : 0.5 * (m < 6 ? t[p][q] + t[q][p] : t[p][q] - t[q][p]);
  }
}

void bwi_subdomain_map(const double elasticity[81], const double linear[9],
                       double map[BWI_SUBDOMAIN_MAP]) {
  double inverse[9];
  double determinant = bw_inverse3(linear, inverse);
  for (int r = 0; r < 9; r++) {
    const double *c = elasticity + 9 * (3 * upper[r][0] + upper[r][1]);
    double half[3][3], full[3][3]; /* half: B_ql; full: B_pj too */
    for (int j = 0; j < 3; j++)
      for (int q = 0; q < 3; q++)
        half[j][q] = c[3 * j] * inverse[3 * q] + c[3 * j + 1] * inverse[3 * q + 1] +
                     c[3 * j + 2] * inverse[3 * q + 2];
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        full[p][q] = determinant * (half[0][q] * inverse[3 * p] + half[1][q] * inverse[3 * p + 1] +
                                    half[2][q] * inverse[3 * p + 2]);
    for (int m = r < 6 ? 0 : 6; m < (r < 6 ? 6 : 9); m++) {
      int p = upper[m][0], q = upper[m][1];
      if (r < 6)
        map[6 * m + r] = p == q ? full[p][p] : full[p][q] + full[q][p];
      else
        map[36 + 3 * (m - 6) + r - 6] = full[p][q] - full[q][p];
    }
  }
}

/* C of a rotated material: C'_ijkl = R_ia R_jb R_kc R_ld C_abcd. */
static void rotate_elasticity(const double elasticity[81], const double rotation[9],
                              double rotated[81]) {
  /* each pass rotates the last index and moves it to the front; four passes rotate all and restore
   * the order, which is i k j l here */
  double now[81], next[81];
  memcpy(now, elasticity, sizeof now);
  for (int pass = 0; pass < 4; pass++) {
    for (int other = 0; other < 27; other++)
      for (int r = 0; r < 3; r++)
        next[27 * r + other] = now[3 * other] * rotation[3 * r] +
                               now[3 * other + 1] * rotation[3 * r + 1] +
                               now[3 * other + 2] * rotation[3 * r + 2];
    memcpy(now, next, sizeof now);
  }
  memcpy(rotated, now, sizeof now);
}

void bwi_subdomain_elasticity(const bw_subdomain_stiffness *stiffness, int32_t subdomain,
                              const double frame[9], double elasticity[81]) {
  const bwi_subdomain_coefficients *c = stiffness->coefficients;
  const double *rest = c->elasticity + 81 * (int64_t)subdomain;
  double rotation[9];
  if (!c->orientation_matters || !stiffness->rotate_material) {
    memcpy(elasticity, rest, 81 * sizeof *elasticity);
    return;
  }
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      rotation[3 * r + s] = frame[3 * s + r];
  rotate_elasticity(rest, rotation, elasticity);
}

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

/* The sums stay in registers only where everything is inlined. */
#define INLINED __attribute__((always_inline)) static inline

/* half += the halves of the entries of four blocks, from 6 or 9 numbers of each. */
INLINED void add_four(const double *map, const double *tensor, int numbers, bwi_vector half[9]) {
  const bwi_vector *t = (const bwi_vector *)tensor;
  for (int m = 0; m < 6; m++)
    for (int r = 0; r < 6; r++)
      add_product(map[6 * m + r], &t[m], &half[r]);
  for (int m = 0; m < numbers - 6; m++)
    for (int r = 0; r < 3; r++)
      add_product(map[36 + 3 * m + r], &t[6 + m], &half[6 + r]);
}

/* The entries of `count` of four blocks, to their places. */
INLINED void store(const bwi_vector half[9], int numbers, const uint32_t *code, int count,
                   double *out) {
  bwi_vector k[8] = {half[0], half[1], half[2], half[1], half[3], half[4], half[2], half[4]};
  if (numbers == 9) {
    k[1] += half[6];
    k[2] += half[7];
    k[3] -= half[6];
    k[5] += half[8];
    k[6] -= half[7];
    k[7] -= half[8];
  }
  bwi_vector low[4], high[4];
  transpose(k, low);
  transpose(k + 4, high);
  for (int index = 0; index < count; index++) {
    double *block = out + 9 * (int64_t)(code[index] >> 1);
    *(bwi_vector *)block = low[index];
    *(bwi_vector *)(block + 4) = high[index];
    block[8] = half[5][index];
  }
}

/* The map of a segment's j-th subdomain, and T as it counts now. */
static const double *map_of(const bwi_subdomain_coefficients *c,
                            const bwi_subdomain_segment *segment, int64_t j,
                            const double **tensor) {
  int32_t subdomain = c->section_subdomain[c->section_start[segment->section] + j];
  *tensor = c->written[subdomain].reshaped && segment->section >= c->inside_count
                ? bwi_subdomain_present(c, segment, j)
                : bwi_subdomain_rest(c, segment, j);
  return c->map + BWI_SUBDOMAIN_MAP * (int64_t)subdomain;
}

/* Segments of one subdomain. */
INLINED void evaluate_inside(const double *map, const double *tensor, int numbers,
                             const uint32_t *code, int64_t size, double *out) {
  int64_t k = 0;
  for (; k + 4 <= size; k += 4) {
    bwi_vector half[9] = {{0}};
    add_four(map, tensor + numbers * k, numbers, half);
    store(half, numbers, code + k, 4, out);
  }
  if (k < size) {
    bwi_vector half[9] = {{0}};
    add_four(map, tensor + numbers * k, numbers, half);
    store(half, numbers, code + k, (int)(size - k), out);
  }
}

void bwi_subdomain_evaluate(const bwi_subdomain_coefficients *c,
                            const bwi_subdomain_segment *segment, double *out) {
  const uint32_t *code = c->block_code + segment->first;
  int64_t subdomains = c->section_start[segment->section + 1] - c->section_start[segment->section];
  const double *tensor, *map = map_of(c, segment, 0, &tensor);
  if (subdomains > 1)
    for (int64_t k = 0; k < segment->size; k += 4) {
      bwi_vector half[9] = {{0}};
      for (int64_t j = 0; j < subdomains; j++) {
        map = map_of(c, segment, j, &tensor);
        add_four(map, tensor + 9 * k, 9, half);
      }
      store(half, 9, code + k, segment->size - k < 4 ? (int)(segment->size - k) : 4, out);
    }
  else if (segment->numbers == 6)
    evaluate_inside(map, tensor, 6, code, segment->size, out);
  else
    evaluate_inside(map, tensor, 9, code, segment->size, out);
}
