/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The closed forms of one block (gather.h), in the one place where they are written: for all blocks
 * of a mesh (gather.c) and for those of a subdomain (subdomain_write.c). Inlined into loops. */
#ifndef BARWRIGHT_BLOCK_H
#define BARWRIGHT_BLOCK_H

#include "assemble/gather.h"

#include <string.h>

/* One contribution: first * u (x) v + second * w (x) z, the letters being numbers of frame vectors.
 * Indexed by the local pair (a << 4 | b). */
typedef struct bwi_block_term {
  uint8_t u, v, w, z;
  double first, second;
} bwi_block_term;
void bwi_product_table(int order, bwi_block_term table[256]);

/* Add to T (rows of four, the last unused) what an element with frame h contributes to a block: of
 * a corner's row, of a corner's column, of two mid-edge nodes, of a mid-edge node with itself.
 * Where a corner is one of both nodes, the two products have its vector in common. */
static inline void bwi_add_outer(const bwi_vector *u, const bwi_vector *v, bwi_vector t[3]) {
  t[0] += (*u)[0] * *v;
  t[1] += (*u)[1] * *v;
  t[2] += (*u)[2] * *v;
}
static inline void bwi_add_corner_row(const bwi_block_term *p, const bwi_vector *h,
                                      bwi_vector t[3]) {
  bwi_vector v = p->first * h[p->v] + p->second * h[p->z];
  bwi_add_outer(&h[p->u], &v, t);
}
static inline void bwi_add_corner_column(const bwi_block_term *p, const bwi_vector *h,
                                         bwi_vector t[3]) {
  bwi_vector u = p->first * h[p->u] + p->second * h[p->w];
  bwi_add_outer(&u, &h[p->v], t);
}
static inline void bwi_add_middles(const bwi_block_term *p, const bwi_vector *h, bwi_vector t[3]) {
  const double *u = (const double *)(h + p->u), *w = (const double *)(h + p->w);
  bwi_vector v = p->first * h[p->v], z = p->second * h[p->z];
  t[0] += u[0] * v + w[0] * z;
  t[1] += u[1] * v + w[1] * z;
  t[2] += u[2] * v + w[2] * z;
}
static inline void bwi_add_middle(int m, const bwi_vector *h, bwi_vector t[3]) {
  const int *edge = bw_tet_edge[m - 4];
  bwi_vector s = h[m], a = h[edge[0]], b = h[edge[1]];
  t[0] += 0.8 * (s[0] * s + (a[0] * a + b[0] * b));
  t[1] += 0.8 * (s[1] * s + (a[1] * a + b[1] * b));
  t[2] += 0.8 * (s[2] * s + (a[2] * a + b[2] * b));
}

/* Elements of a subdomain, all straight: frame number[e] - first if that is in [0, count). */
typedef struct bwi_element_range {
  const int32_t *number;
  int32_t first, count;
  const bwi_vector *vector; /* their frames */
  int vectors;
  const bwi_block_term *table;
} bwi_element_range;

/* T of one block, of the elements in the range, into t (rows of four, the last unused). A node is
 * corner or middle in all its elements, so that each loop has contributions of one kind. */
static inline void bwi_sum_block(const bwi_contributions *list, const bwi_element_range *range,
                                 int64_t index, bool diagonal, bwi_vector t[3]) {
  int64_t begin = list->start[index], end = list->start[index + 1];
  const int row = list->local[begin] >> 4, column = list->local[begin] & 15;
  bwi_vector sum[3] = {{0}, {0}, {0}}; /* in registers */
#define BWI_SUM(add)                                                                               \
  for (int64_t k = begin; k < end; k++) {                                                          \
    int32_t e = range->number[list->element[k]] - range->first;                                    \
    const int code = list->local[k];                                                               \
    const bwi_vector *h = range->vector + (int64_t)e * range->vectors;                             \
    if ((uint32_t)e < (uint32_t)range->count)                                                      \
      add;                                                                                         \
  }
  if (row < 4)
    BWI_SUM(bwi_add_corner_row(&range->table[code], h, sum))
  else if (column < 4)
    BWI_SUM(bwi_add_corner_column(&range->table[code], h, sum))
  else if (diagonal)
    BWI_SUM(bwi_add_middle(code & 15, h, sum))
  else
    BWI_SUM(bwi_add_middles(&range->table[code], h, sum))
#undef BWI_SUM
  memcpy(t, sum, sizeof sum);
}

/* K = lambda T + mu T^T + mu tr(T) I */
static inline void bwi_apply_isotropic(double lambda, double mu, const bwi_vector t[3],
                                       double *out) {
  double trace = mu * (t[0][0] + t[1][1] + t[2][2]);
  bwi_vector a = __builtin_shufflevector(t[0], t[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(t[0], t[1], 1, 5, 3, 7);
  bwi_vector column[3] = {__builtin_shufflevector(a, t[2], 0, 1, 4, 7),
                          __builtin_shufflevector(b, t[2], 0, 1, 5, 7),
                          __builtin_shufflevector(a, t[2], 2, 3, 6, 7)};
  bwi_vector row[3] = {lambda * t[0] + mu * column[0] + (bwi_vector){trace, 0, 0, 0},
                       lambda * t[1] + mu * column[1] + (bwi_vector){0, trace, 0, 0},
                       lambda * t[2] + mu * column[2] + (bwi_vector){0, 0, trace, 0}};
  /* four numbers of each row but the last: what is behind it belongs to the next block */
  *(bwi_vector *)out = row[0];
  *(bwi_vector *)(out + 3) = row[1];
  for (int c = 0; c < 3; c++)
    out[6 + c] = row[2][c];
}

/* K_ik = sum_jl C_ijkl T_jl; map[3 j + l][i][k] = C_ijkl */
static inline void bwi_apply_general(const bwi_vector (*map)[3], const bwi_vector t[3],
                                     double *out) {
  bwi_vector row[3] = {map[0][0] * t[0][0], map[0][1] * t[0][0], map[0][2] * t[0][0]};
  for (int m = 1; m < 9; m++)
    for (int r = 0; r < 3; r++)
      row[r] += map[m][r] * t[m / 3][m % 3];
  for (int r = 0; r < 3; r++)
    memcpy(out + 3 * r, &row[r], 3 * sizeof *out);
}

/* A diagonal block is symmetric but for rounding: make it exactly so. */
static inline void bwi_make_symmetric(double *block) {
  block[3] = block[1];
  block[6] = block[2];
  block[7] = block[5];
}

#endif
