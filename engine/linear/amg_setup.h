/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files that set multigrid up share: the level in work, and loops over its matrix. */
#ifndef BWI_LINEAR_AMG_SETUP_H
#define BWI_LINEAR_AMG_SETUP_H

#include <math.h>

#include "linear/amg.h"

enum { BWI_AMG_ROWS = 128 }; /* handed to a thread at once */

typedef struct bwi_amg_setup {
  bw_context *context;
  bwi_amg *g;
  const bwi_matrix *matrix;
  int at;                 /* the level in work */
  double *modes;          /* rows x unknowns x BWI_AMG_MODES: near null space of the level */
  int32_t *body;          /* rows: the body of each */
  double centre[3], size; /* m: the modes of the nodes are about it, rotations over it */
  int32_t *of;            /* rows: aggregate, or -1 */
  int32_t count;          /* of aggregates */
  double *tentative;      /* rows x unknowns x BWI_AMG_MODES */
  bwi_amg_blocks ap;      /* A P */
  int64_t *child;         /* the block of P that each of P^T is */
  int workers;
  int32_t *mark;   /* workers x aggregates: place in the row in work, + 1, or 0 */
  double *x, *y;   /* rows x unknowns */
  double *norm;    /* rows: |A_ii| */
  double *inverse; /* rows x unknowns^2 */
} bwi_amg_setup;

/* ---- rows of the level's matrix -------------------------------------------------------------- */

/* Calls what follows for every block of row k: its column j, numbers `block`, stored `across` where
 * they are those of the transposed block. */
#define BWI_AMG_FOR_ROW(s, k, body)                                                                \
  do {                                                                                             \
    const bwi_amg_level *v_ = &(s)->g->level[(s)->at];                                             \
    if ((s)->at > 0) {                                                                             \
      for (int64_t e_ = v_->a.start[k]; e_ < v_->a.start[(k) + 1]; e_++) {                         \
        const double *block = v_->a.exact + 36 * e_;                                               \
        const int32_t j = v_->a.column[e_];                                                        \
        const bool across = false;                                                                 \
        body                                                                                       \
      }                                                                                            \
    } else {                                                                                       \
      const bwi_smoother *g_ = (s)->g->smoother;                                                   \
      const bw_block_pattern *p_ = g_->pattern;                                                    \
      const int32_t i_ = g_->node[k];                                                              \
      for (int64_t e_ = p_->start[i_]; e_ < p_->start[i_ + 1]; e_++) {                             \
        const double *block = (s)->matrix->stiffness + 9 * e_;                                     \
        const int32_t j = g_->row_of[p_->column[e_]];                                              \
        const bool across = false;                                                                 \
        body                                                                                       \
      }                                                                                            \
      for (int64_t e_ = p_->upper_start[i_]; e_ < p_->upper_start[i_ + 1]; e_++) {                 \
        const double *block = (s)->matrix->stiffness + 9 * bw_upper_block(p_, e_);                 \
        const int32_t j = g_->row_of[p_->upper_row[e_]];                                           \
        const bool across = true;                                                                  \
        body                                                                                       \
      }                                                                                            \
    }                                                                                              \
  } while (0)

static inline double bwi_amg_unit(const bwi_amg_setup *s) {
  return s->at > 0 ? 1 : s->g->smoother->unit;
}

static inline int bwi_amg_unknowns(const bwi_amg_setup *s) {
  return s->g->level[s->at].unknowns;
}

static inline double bwi_amg_norm(const double *block, int n) {
  double sum = 0;
  for (int i = 0; i < n * n; i++)
    sum += block[i] * block[i];
  return sqrt(sum);
}

/* sum (u x w) += A (u x u), or its transpose, times x (u x w) */
static inline void bwi_amg_add_product(const double *a, bool across, int u, int w, const double *x,
                                       double *sum) {
  for (int i = 0; i < u; i++)
    for (int k = 0; k < u; k++) {
      double factor = across ? a[k * u + i] : a[i * u + k];
      for (int j = 0; j < w; j++)
        sum[i * w + j] += factor * x[k * w + j];
    }
}

/* ---- amg_coarsest.c -------------------------------------------------------------------------- */

/* The coarsest level: its null space and its factor. */
bw_status bwi_amg_factor_coarsest(bwi_amg_setup *s);

/* ---- amg_aggregate.c ------------------------------------------------------------------------- */

/* `of` and `count`: the aggregates of the level. */
bw_status bwi_amg_aggregate(bwi_amg_setup *s);
/* `tentative`: Q of the modes by aggregates. `modes` become R, those of the next level, and `body`
 * of its rows. */
bw_status bwi_amg_make_tentative(bwi_amg_setup *s);

/* ---- amg_products.c -------------------------------------------------------------------------- */

/* The prolongation of the level, and rows and matrix of the next one. */
bw_status bwi_amg_make_next(bwi_amg_setup *s);
/* Numbers for the cycle, without those of the setup. */
bw_status bwi_amg_to_floats(bw_context *context, bwi_amg_blocks *blocks);

#endif
