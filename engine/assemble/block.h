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

/* Where tensors are summed from: frames of all elements, or of those of one subdomain only. */
typedef struct bwi_block_source {
  const bwi_frames *frames;
  bwi_block_term table[256];
} bwi_block_source;

/* The elements that count, when not all do: frame number[e] - first if that is in [0, count). */
typedef struct bwi_element_range {
  const int32_t *number;
  int32_t first, count;
  const bwi_vector *vector; /* their frames */
} bwi_element_range;

/* Add a curved element's tensor of local nodes (a, b). */
static inline void bwi_add_curved(const bwi_frames *frames, int32_t number, int code,
                                  double t[3][4]) {
  int a = code >> 4, b = code & 15;
  int high = a > b ? a : b, low = a > b ? b : a;
  const double *tensor =
      frames->curved_tensor + ((int64_t)number * 55 + high * (high + 1) / 2 + low) * 9;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      t[r][c] += a >= b ? tensor[3 * r + c] : tensor[3 * c + r];
}

/* What the contributions from `begin` to `end` - 1 of one block make of T, into t (rows of four,
 * the last unused). `range` NULL: all elements; else those are straight. */
static inline void bwi_sum_contributions(const bwi_block_source *source,
                                         const bwi_contributions *list,
                                         const bwi_element_range *range, int64_t begin, int64_t end,
                                         bool diagonal, double t[3][4]) {
  /* Frames are asked for this many contributions ahead: numbers of neighbours may lie far apart. */
  enum { AHEAD = 32 };
  const int32_t *curved = range ? NULL : source->frames->curved;
  const int vectors = source->frames->vectors;
  const bwi_vector *vector = range ? range->vector : source->frames->vector;
  bwi_vector t0 = {0}, t1 = {0}, t2 = {0};
  double extra[3][4];
  if (curved)
    memset(extra, 0, sizeof extra);
  for (int64_t k = begin; k < end; k++) {
    int32_t e = list->element[k];
    int code = list->local[k];
    if (range) {
      e = range->number[e] - range->first;
      if ((uint32_t)e >= (uint32_t)range->count)
        continue;
    } else if (k + AHEAD < list->count)
      __builtin_prefetch(vector + (int64_t)list->element[k + AHEAD] * vectors);
    if (curved && curved[e] >= 0) {
      bwi_add_curved(source->frames, curved[e], code, extra);
      continue;
    }
    const bwi_vector *h = vector + (int64_t)e * vectors;
    if (diagonal && (code & 15) >= 4) {
      const int *edge = bw_tet_edge[(code & 15) - 4];
      bwi_vector s = h[code & 15], a = h[edge[0]], b = h[edge[1]];
      t0 += 0.8 * (s[0] * s + (a[0] * a + b[0] * b));
      t1 += 0.8 * (s[1] * s + (a[1] * a + b[1] * b));
      t2 += 0.8 * (s[2] * s + (a[2] * a + b[2] * b));
      continue;
    }
    const bwi_block_term *p = &source->table[code];
    const double *u = (const double *)(h + p->u), *w = (const double *)(h + p->w);
    bwi_vector v = p->first * h[p->v], z = p->second * h[p->z];
    t0 += u[0] * v + w[0] * z;
    t1 += u[1] * v + w[1] * z;
    t2 += u[2] * v + w[2] * z;
  }
  memcpy(t[0], &t0, sizeof t0);
  memcpy(t[1], &t1, sizeof t1);
  memcpy(t[2], &t2, sizeof t2);
  if (curved)
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        t[r][c] += extra[r][c];
}

/* What the same contributions make of the tensor of mean gradients, V mean(grad N_i) (x)
 * mean(grad N_j): on a straight tet10 those of corners vanish, and those of mid-edge nodes s_m. */
static inline void bwi_sum_means(const bwi_block_source *source, const bwi_contributions *list,
                                 int64_t begin, int64_t end, double t[3][4]) {
  const bwi_frames *frames = source->frames;
  bwi_vector row[3] = {{0}, {0}, {0}};
  for (int64_t k = begin; k < end; k++) {
    int64_t e = list->element[k];
    int a = list->local[k] >> 4, b = list->local[k] & 15;
    const bwi_vector *mean = frames->vector + e * frames->vectors;
    if (frames->curved && frames->curved[e] >= 0)
      mean = frames->curved_mean + (int64_t)frames->curved[e] * 10;
    else if (a < 4 || b < 4)
      continue;
    for (int r = 0; r < 3; r++)
      row[r] += mean[a][r] * mean[b];
  }
  memcpy(t, row, sizeof row);
}

/* T of one block. */
static inline void bwi_sum_block(const bwi_block_source *source, const bwi_contributions *list,
                                 const bwi_element_range *range, int64_t index, bool diagonal,
                                 double t[3][4]) {
  const int64_t *start = list->start + (index - list->first);
  bwi_sum_contributions(source, list, range, start[0], start[1], diagonal, t);
}

/* K = lambda T + mu T^T + mu tr(T) I */
static inline void bwi_apply_isotropic(double lambda, double mu, double t[3][4], double *out) {
  double trace = mu * (t[0][0] + t[1][1] + t[2][2]);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      out[3 * r + c] = lambda * t[r][c] + mu * t[c][r] + (r == c ? trace : 0);
}

/* K_ik = sum_jl C_ijkl T_jl; map[3 j + l][i][k] = C_ijkl */
static inline void bwi_apply_general(const bwi_vector (*map)[3], double t[3][4], double *out) {
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
