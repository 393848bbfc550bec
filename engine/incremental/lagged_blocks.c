/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* LU factors of unsymmetric matrices on plane patterns in blocks, one for each pair of nodes, in
 * single precision and without pivoting between nodes: for preconditioning. Where every node has
 * equations with a diagonal (stabilised flow has, also for the pressure) pivots are not needed, and
 * then small dense blocks in an order known beforehand are several times as fast as a general
 * factorisation. A node whose block is close to singular ends the attempt: the caller then factors
 * with pivoting.
 *
 * Invariants, after the analysis, in positions of the elimination order: row k of U holds columns
 * above k, ascending; row i of L the rows k below i whose U holds i, ascending; the pattern of U in
 * row k without its first column is part of that column's row. So row i minus L(i, k) U(k) never
 * leaves the pattern of row i.
 *
 * A block is C rows of four lanes, the last 4 - C of them zero. Unknowns are scaled so that the
 * matrix has ones on its diagonal: pressures and velocities differ by orders of magnitude. */
#include <math.h>
#include <string.h>

#include "base/sort.h"
#include "incremental/lagged_factor.h"

/* Smallest pivot inside a node's block, of a scaled matrix. */
#define SMALLEST_PIVOT 1e-5

typedef float lanes __attribute__((vector_size(16), aligned(4), may_alias));
enum { LANES = 4 };

typedef struct lagged_blocks {
  bwi_lagged shared;
  int32_t size;      /* nodes */
  int32_t *position; /* when a node is eliminated */
  int64_t *upper_start, *lower_start;
  int32_t *upper_column, *lower_column;
  float *upper, *lower; /* blocks */
  float *inverse;       /* of diagonal blocks of U */
  double *scale;        /* of unknowns, by node */
  float *workspace;     /* one row of blocks; in solves a vector */
} lagged_blocks;

static void forget_analysis(bwi_lagged *shared) {
  lagged_blocks *s = (lagged_blocks *)shared;
  bw_free(s->upper_start);
  bw_free(s->lower_start);
  bw_free(s->upper_column);
  bw_free(s->lower_column);
  bw_free(s->upper);
  bw_free(s->lower);
  s->upper_start = s->lower_start = NULL;
  s->upper_column = s->lower_column = NULL;
  s->upper = s->lower = NULL;
}

static void forget(bwi_lagged *shared) {
  lagged_blocks *s = (lagged_blocks *)shared;
  bw_free(s->position);
  bw_free(s->inverse);
  bw_free(s->scale);
  bw_free(s->workspace);
  s->position = NULL;
  s->inverse = s->workspace = NULL;
  s->scale = NULL;
}

/* ---- analysis ------------------------------------------------------------------------------ */

/* Patterns of U row by row: what the pattern has above the diagonal, and what the rows bring whose
 * first column this is. */
static bw_status find_upper(bw_context *context, lagged_blocks *s,
                            const bw_plane_pattern *pattern) {
  bw_status status = BW_OK;
  int32_t n = s->size;
  int64_t capacity = 4 * pattern->block_count + n, used = 0;
  int32_t *child = BW_NEW(context, int32_t, n), *sibling = BW_NEW(context, int32_t, n);
  int32_t *mark = BW_NEW(context, int32_t, n);
  s->upper_start = BW_NEW0(context, int64_t, (size_t)n + 1);
  s->upper_column = BW_NEW(context, int32_t, capacity);
  BW_TRY_MEMORY(child && sibling && mark && s->upper_start && s->upper_column);
  for (int32_t k = 0; k < n; k++)
    child[k] = mark[k] = -1;
  for (int32_t k = 0; k < n; k++) {
    int64_t bound =
        pattern->start[s->shared.permutation[k] + 1] - pattern->start[s->shared.permutation[k]];
    for (int32_t c = child[k]; c >= 0; c = sibling[c])
      bound += s->upper_start[c + 1] - s->upper_start[c];
    if (used + bound > capacity) {
      capacity = 2 * capacity + bound;
      int32_t *larger = BW_NEW(context, int32_t, capacity);
      BW_TRY_MEMORY(larger);
      memcpy(larger, s->upper_column, (size_t)used * sizeof *larger);
      bw_free(s->upper_column);
      s->upper_column = larger;
    }
    int64_t first = used;
    mark[k] = k;
    for (int64_t p = pattern->start[s->shared.permutation[k]];
         p < pattern->start[s->shared.permutation[k] + 1]; p++) {
      int32_t j = s->position[pattern->column[p]];
      if (j > k && mark[j] != k) {
        mark[j] = k;
        s->upper_column[used++] = j;
      }
    }
    for (int32_t c = child[k]; c >= 0; c = sibling[c])
      for (int64_t p = s->upper_start[c]; p < s->upper_start[c + 1]; p++) {
        int32_t j = s->upper_column[p];
        if (mark[j] != k) {
          mark[j] = k;
          s->upper_column[used++] = j;
        }
      }
    bwi_sort_columns(s->upper_column + first, used - first);
    s->upper_start[k + 1] = used;
    if (used > first) {
      int32_t parent = s->upper_column[first];
      sibling[k] = child[parent];
      child[parent] = k;
    }
  }
done:
  bw_free(child);
  bw_free(sibling);
  bw_free(mark);
  return status;
}

static bw_status find_lower(bw_context *context, lagged_blocks *s) {
  int32_t n = s->size;
  int64_t entries = s->upper_start[n];
  size_t block = (size_t)s->shared.components * LANES;
  s->lower_start = BW_NEW0(context, int64_t, (size_t)n + 2);
  s->lower_column = BW_NEW(context, int32_t, entries);
  s->upper = BW_NEW(context, float, (size_t)entries *block);
  s->lower = BW_NEW(context, float, (size_t)entries *block);
  if (!s->lower_start || !s->lower_column || !s->upper || !s->lower)
    return BW_MEMORY;
  /* Counted two places up; filling moves each start to where the next one is. */
  for (int64_t p = 0; p < entries; p++)
    s->lower_start[s->upper_column[p] + 2]++;
  for (int32_t i = 0; i < n; i++)
    s->lower_start[i + 2] += s->lower_start[i + 1];
  for (int32_t k = 0; k < n; k++)
    for (int64_t p = s->upper_start[k]; p < s->upper_start[k + 1]; p++)
      s->lower_column[s->lower_start[s->upper_column[p] + 1]++] = k;
  return BW_OK;
}

static void count_work(lagged_blocks *s) {
  double updates = 0;
  for (int32_t k = 0; k < s->size; k++) {
    double row = (double)(s->upper_start[k + 1] - s->upper_start[k]);
    updates += row * row + 2 * row;
  }
  const double C = s->shared.components;
  s->shared.flops = 2 * updates * C * C * C;
}

static bw_status analyse(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                         const double *values, bwi_adjacency *near) {
  bw_status status = BW_OK;
  lagged_blocks *s = (lagged_blocks *)shared;
  size_t n = (size_t)pattern->node_count, block = (size_t)shared->components * LANES;
  (void)values;
  (void)near;
  if (!s->position) {
    s->size = pattern->node_count;
    s->position = BW_NEW(context, int32_t, n);
    s->inverse = BW_NEW(context, float, n *block);
    s->scale = BW_NEW(context, double, n *(size_t)shared->components);
    s->workspace = BW_NEW(context, float, n *block);
    BW_TRY_MEMORY(s->position && s->inverse && s->scale && s->workspace);
  }
  for (int32_t k = 0; k < s->size; k++)
    s->position[shared->permutation[k]] = k;
  BW_TRY(find_upper(context, s, pattern));
  BW_TRY(find_lower(context, s));
  count_work(s);
done:
  return status;
}

/* ---- numbers ------------------------------------------------------------------------------- */

/* False where a pivot is too small. */
static inline __attribute__((always_inline)) bool invert(const lanes *block, lanes *inverse,
                                                         int C) {
  double a[4][8] = {{0}};
  for (int r = 0; r < C; r++) {
    for (int c = 0; c < C; c++)
      a[r][c] = (double)block[r][c];
    a[r][C + r] = 1;
  }
  for (int k = 0; k < C; k++) {
    int best = k;
    for (int r = k + 1; r < C; r++)
      if (fabs(a[r][k]) > fabs(a[best][k]))
        best = r;
    if (!(fabs(a[best][k]) > SMALLEST_PIVOT))
      return false;
    for (int c = 0; c < 2 * C; c++) {
      double t = a[best][c];
      a[best][c] = a[k][c];
      a[k][c] = t;
    }
    double by = 1 / a[k][k];
    for (int c = 0; c < 2 * C; c++)
      a[k][c] *= by;
    for (int r = 0; r < C; r++)
      if (r != k) {
        double f = a[r][k];
        for (int c = 0; c < 2 * C; c++)
          a[r][c] -= f * a[k][c];
      }
  }
  for (int r = 0; r < C; r++) {
    lanes row = {0};
    for (int c = 0; c < C; c++)
      row[c] = (float)a[r][C + c];
    inverse[r] = row;
  }
  return true;
}

/* Row by row: A(i) less L(i, k) U(k) for k from the lowest. C is a constant wherever this is
 * expanded. */
static inline __attribute__((always_inline)) bool
eliminate(lagged_blocks *s, const bw_plane_pattern *pattern, const double *values, int C) {
  lanes *work = (lanes *)s->workspace;
  const lanes zero = {0};
  for (int32_t i = 0; i < s->size; i++) {
    int32_t node = s->shared.permutation[i];
    for (int64_t p = s->lower_start[i]; p < s->lower_start[i + 1]; p++)
      for (int r = 0; r < C; r++)
        work[(int64_t)C * s->lower_column[p] + r] = zero;
    for (int64_t p = s->upper_start[i]; p < s->upper_start[i + 1]; p++)
      for (int r = 0; r < C; r++)
        work[(int64_t)C * s->upper_column[p] + r] = zero;
    for (int64_t p = pattern->start[node]; p < pattern->start[node + 1]; p++) {
      int64_t column = pattern->column[p];
      lanes *w = work + C * (int64_t)s->position[column];
      for (int r = 0; r < C; r++) {
        lanes row = zero;
        for (int c = 0; c < C; c++)
          row[c] = (float)(values[C * C * p + C * r + c] * s->scale[C * (int64_t)node + r] *
                           s->scale[C * column + c]);
        w[r] = row;
      }
    }
    for (int64_t q = s->lower_start[i]; q < s->lower_start[i + 1]; q++) {
      int64_t k = s->lower_column[q];
      const lanes *w = work + C * k, *inverse = (const lanes *)s->inverse + C * k;
      lanes *kept = (lanes *)s->lower + C * q, l[4];
      for (int r = 0; r < C; r++) {
        lanes row = w[r][0] * inverse[0];
        for (int c = 1; c < C; c++)
          row += w[r][c] * inverse[c];
        l[r] = kept[r] = row;
      }
      const lanes *upper = (const lanes *)s->upper + C * s->upper_start[k];
      for (int64_t p = s->upper_start[k]; p < s->upper_start[k + 1]; p++, upper += C) {
        lanes *to = work + C * (int64_t)s->upper_column[p];
        for (int r = 0; r < C; r++) {
          lanes row = to[r];
          for (int c = 0; c < C; c++)
            row -= l[r][c] * upper[c];
          to[r] = row;
        }
      }
    }
    if (!invert(work + C * (int64_t)i, (lanes *)s->inverse + C * (int64_t)i, C))
      return false;
    lanes *upper = (lanes *)s->upper + C * s->upper_start[i];
    for (int64_t p = s->upper_start[i]; p < s->upper_start[i + 1]; p++, upper += C)
      for (int r = 0; r < C; r++)
        upper[r] = work[C * (int64_t)s->upper_column[p] + r];
  }
  return true;
}

/* The row of a block times a vector, summed. */
static inline __attribute__((always_inline)) float sum_of(lanes v, int C) {
  float sum = v[0];
  for (int c = 1; c < C; c++)
    sum += v[c];
  return sum;
}

static inline __attribute__((always_inline)) void substitute(const lagged_blocks *s,
                                                             const double *r, double *z, int C) {
  lanes *y = (lanes *)s->workspace;
  double largest = 0;
  for (int64_t u = 0; u < (int64_t)C * s->size; u++)
    largest = fmax(largest, fabs(r[u] * s->scale[u]));
  double unit = largest > 0 && isfinite(largest) ? 1 / largest : 1; /* floats have a short range */
  for (int64_t i = 0; i < s->size; i++) {
    int64_t node = s->shared.permutation[i];
    lanes right = {0}, sum[4] = {{0}};
    for (int c = 0; c < C; c++)
      right[c] = (float)(unit * r[C * node + c] * s->scale[C * node + c]);
    const lanes *block = (const lanes *)s->lower + C * s->lower_start[i];
    for (int64_t p = s->lower_start[i]; p < s->lower_start[i + 1]; p++, block += C) {
      lanes x = y[s->lower_column[p]];
      for (int c = 0; c < C; c++)
        sum[c] += block[c] * x;
    }
    for (int c = 0; c < C; c++)
      right[c] -= sum_of(sum[c], C);
    y[i] = right;
  }
  for (int64_t i = s->size - 1; i >= 0; i--) {
    int64_t node = s->shared.permutation[i];
    lanes right = y[i], result = {0}, sum[4] = {{0}};
    const lanes *block = (const lanes *)s->upper + C * s->upper_start[i];
    for (int64_t p = s->upper_start[i]; p < s->upper_start[i + 1]; p++, block += C) {
      lanes x = y[s->upper_column[p]];
      for (int c = 0; c < C; c++)
        sum[c] += block[c] * x;
    }
    for (int c = 0; c < C; c++)
      right[c] -= sum_of(sum[c], C);
    const lanes *inverse = (const lanes *)s->inverse + C * i;
    for (int c = 0; c < C; c++) {
      result[c] = sum_of(inverse[c] * right, C);
      z[C * node + c] = (double)result[c] * s->scale[C * node + c] / unit;
    }
    y[i] = result;
  }
}

static bw_status factor(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                        const double *values, bwi_lagged_work *work) {
  lagged_blocks *s = (lagged_blocks *)shared;
  const int C = shared->components;
  (void)context;
  work->flops = shared->flops;
  work->bytes = 2.0 * (double)s->upper_start[s->size] * (C * LANES * sizeof(float) + 4);
  work->refused = true;
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int c = 0; c < C; c++) {
      double size = fabs(values[C * C * pattern->diagonal[i] + C * c + c]);
      if (!(size > 0) || !isfinite(size))
        return BW_OK;
      s->scale[C * i + c] = 1 / sqrt(size);
    }
  switch (C) {
  case 1:
    work->refused = !eliminate(s, pattern, values, 1);
    break;
  case 2:
    work->refused = !eliminate(s, pattern, values, 2);
    break;
  case 3:
    work->refused = !eliminate(s, pattern, values, 3);
    break;
  default:
    work->refused = !eliminate(s, pattern, values, 4);
  }
  return BW_OK;
}

static bw_status apply(bw_context *context, bwi_lagged *shared, bool old, const double *r,
                       double *z) {
  const lagged_blocks *s = (const lagged_blocks *)shared;
  (void)context;
  (void)old;
  switch (shared->components) {
  case 1:
    substitute(s, r, z, 1);
    break;
  case 2:
    substitute(s, r, z, 2);
    break;
  case 3:
    substitute(s, r, z, 3);
    break;
  default:
    substitute(s, r, z, 4);
  }
  return BW_OK;
}

const bwi_lagged_kind bwi_lagged_blocks = {sizeof(lagged_blocks), analyse, factor, apply,
                                           forget_analysis,       forget};
