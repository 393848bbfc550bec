/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over the rows of a stiffness, and products with it (sweeps.h). */
#include "solve/sweeps.h"

#include <math.h>
#include <string.h>

enum { SIDES = BWI_SWEEP_SIDES, ROWS = BWI_SWEEP_ROWS };

/* Three numbers of a node, and one that is ignored. */
typedef float quad __attribute__((vector_size(16), aligned(4), may_alias));
typedef double quad2 __attribute__((vector_size(32), aligned(8), may_alias));
/* One number of each of eight fields. */
typedef float eight __attribute__((vector_size(32), aligned(4), may_alias));
typedef double eight2 __attribute__((vector_size(64), aligned(8), may_alias));

/* A block of six numbers, as columns. */
static inline void columns_of_six(const float *a, quad column[3]) {
  quad low = *(const quad *)a, high = *(const quad *)(a + 2);
  column[0] = low;
  column[1] = __builtin_shufflevector(low, high, 1, 3, 6, 7);
  column[2] = __builtin_shufflevector(low, high, 2, 6, 7, 7);
}

static inline void columns_of_six2(const double *a, quad2 column[3]) {
  quad2 low = *(const quad2 *)a, high = *(const quad2 *)(a + 2);
  column[0] = low;
  column[1] = __builtin_shufflevector(low, high, 1, 3, 6, 7);
  column[2] = __builtin_shufflevector(low, high, 2, 6, 7, 7);
}

/* ---- sweeps -------------------------------------------------------------------------------- */

typedef struct sweep {
  const bwi_sweeps *s;
  int width;
  const float *r;
  float *z, *rest;
} sweep;

/* Which entries of a row. */
typedef enum span { BELOW, ABOVE, ALL } span;

static inline int64_t first_of(const bwi_sweep_part *part, int64_t k, span which) {
  return which == ABOVE ? part->middle[k] : part->start[k];
}

static inline int64_t last_of(const bwi_sweep_part *part, int64_t k, span which) {
  return which == BELOW ? part->middle[k] : part->start[k + 1];
}

/* sum - entries of row k times z */
static inline quad without(const bwi_sweeps *s, int64_t k, span which, const float *z, quad sum) {
  const bwi_sweep_part *part = &s->even;
  for (int64_t e = first_of(part, k, which), end = last_of(part, k, which); e < end; e++) {
    const float *x = z + 3 * (int64_t)part->column[e];
    quad column[3];
    columns_of_six(part->value + 6 * e, column);
    sum -= column[0] * x[0] + column[1] * x[1] + column[2] * x[2];
  }
  part = &s->odd;
  for (int64_t e = first_of(part, k, which), end = last_of(part, k, which); e < end; e++) {
    const float *a = part->value + 9 * e, *x = z + 3 * (int64_t)part->column[e];
    sum -= *(const quad *)a * x[0] + *(const quad *)(a + 3) * x[1] + *(const quad *)(a + 6) * x[2];
  }
  return sum;
}

static inline void without_eight(const bwi_sweeps *s, int64_t k, span which, const float *z,
                                 eight sum[3]) {
  const bwi_sweep_part *part = &s->even;
  for (int64_t e = first_of(part, k, which), end = last_of(part, k, which); e < end; e++) {
    const float *a = part->value + 6 * e;
    const eight *x = (const eight *)z + 3 * (int64_t)part->column[e];
    eight x0 = x[0], x1 = x[1], x2 = x[2];
    sum[0] -= a[0] * x0 + a[1] * x1 + a[2] * x2;
    sum[1] -= a[1] * x0 + a[3] * x1 + a[4] * x2;
    sum[2] -= a[2] * x0 + a[4] * x1 + a[5] * x2;
  }
  part = &s->odd;
  for (int64_t e = first_of(part, k, which), end = last_of(part, k, which); e < end; e++) {
    const float *a = part->value + 9 * e;
    const eight *x = (const eight *)z + 3 * (int64_t)part->column[e];
    eight x0 = x[0], x1 = x[1], x2 = x[2];
    for (int d = 0; d < 3; d++)
      sum[d] -= a[d] * x0 + a[3 + d] * x1 + a[6 + d] * x2;
  }
}

/* z of row k, so that its equation holds with those entries. */
static inline void satisfy(const sweep *w, int64_t k, span which) {
  const bwi_sweeps *s = w->s;
  const float *a = s->inverse + 9 * k;
  if (w->width == 1) {
    const float *r = w->r + 3 * k;
    quad sum = without(s, k, which, w->z, (quad){r[0], r[1], r[2], 0});
    sum = *(const quad *)a * sum[0] + *(const quad *)(a + 3) * sum[1] +
          *(const quad *)(a + 6) * sum[2];
    for (int d = 0; d < 3; d++)
      w->z[3 * k + d] = sum[d];
  } else {
    const eight *r = (const eight *)w->r + 3 * k;
    eight sum[3] = {r[0], r[1], r[2]}, *z = (eight *)w->z + 3 * k;
    without_eight(s, k, which, w->z, sum);
    for (int d = 0; d < 3; d++)
      z[d] = a[d] * sum[0] + a[3 + d] * sum[1] + a[6 + d] * sum[2];
  }
}

static bw_status chunk_forward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  const bwi_sweeps *s = w->s;
  for (int64_t k = s->chunk_start[begin]; k < s->chunk_start[end]; k++)
    satisfy(w, k, BELOW);
  return BW_OK;
}

static bw_status chunk_backward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  const bwi_sweeps *s = w->s;
  for (int64_t k = s->chunk_start[end] - 1; k >= s->chunk_start[begin]; k--)
    satisfy(w, k, ALL);
  return BW_OK;
}

/* After a sweep forwards from 0, what a row leaves is what stands above its diagonal. */
static bw_status leave(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  const bwi_sweeps *s = w->s;
  for (int64_t k = begin; k < end; k++)
    if (w->width == 1) {
      quad sum = without(s, k, ABOVE, w->z, (quad){0, 0, 0, 0});
      for (int d = 0; d < 3; d++)
        w->rest[3 * k + d] = sum[d];
    } else {
      eight sum[3];
      memset(sum, 0, sizeof sum);
      without_eight(s, k, ABOVE, w->z, sum);
      memcpy((eight *)w->rest + 3 * k, sum, sizeof sum);
    }
  return BW_OK;
}

bw_status bwi_sweeps_forward(bw_context *context, const bwi_sweeps *s, int width, const float *r,
                             float *z, float *rest) {
  bw_status status = BW_OK;
  sweep w = {s, width, r, z, rest};
  BW_TRY(bw_parallel(context, s->chunk_count, 1, chunk_forward, &w));
  for (int64_t k = s->chunk_start[s->chunk_count]; k < s->count; k++)
    satisfy(&w, k, BELOW);
  BW_TRY(bw_parallel(context, s->count, ROWS, leave, &w));
done:
  return status;
}

bw_status bwi_sweeps_backward(bw_context *context, const bwi_sweeps *s, int width, const float *r,
                              float *z) {
  sweep w = {s, width, r, z, NULL};
  for (int64_t k = s->count - 1; k >= s->chunk_start[s->chunk_count]; k--)
    satisfy(&w, k, ALL);
  return bw_parallel(context, s->chunk_count, 1, chunk_backward, &w);
}

/* ---- products ------------------------------------------------------------------------------ */

typedef struct product {
  const bwi_sweeps *s;
  int width;
  const double *x;
  double *y, *part; /* part: by chunk of rows, SIDES numbers */
} product;

/* Mirrors lie far apart: they are asked for this many entries before they are needed. */
static inline void fetch_ahead(const bwi_sweep_part *part, int64_t e) {
  enum { AHEAD = 24 };
  const double *block = part->exact + 6 * (int64_t)part->mirror[e + AHEAD];
  __builtin_prefetch(block);
  __builtin_prefetch(block + 5);
}

static inline quad2 six_times(const double *a, const double *x, quad2 sum) {
  quad2 column[3];
  columns_of_six2(a, column);
  return sum + (column[0] * x[0] + column[1] * x[1] + column[2] * x[2]);
}

static void product_one(const product *m, int64_t k, double *dot) {
  const bwi_sweeps *s = m->s;
  const double *own = m->x + 3 * k, *a = s->diagonal + 9 * k;
  quad2 sum = *(const quad2 *)a * own[0] + *(const quad2 *)(a + 3) * own[1] +
              *(const quad2 *)(a + 6) * own[2];
  quad2 across[3];
  memset(across, 0, sizeof across);
  const bwi_sweep_part *part = &s->even;
  a = part->exact + 6 * part->block[k];
  for (int64_t e = part->start[k]; e < part->middle[k]; e++, a += 6)
    sum = six_times(a, m->x + 3 * (int64_t)part->column[e], sum);
  for (int64_t e = part->middle[k]; e < part->start[k + 1]; e++) {
    fetch_ahead(part, e);
    sum = six_times(part->exact + 6 * (int64_t)part->mirror[e], m->x + 3 * (int64_t)part->column[e],
                    sum);
  }
  part = &s->odd;
  a = part->exact + 9 * part->block[k];
  for (int64_t e = part->start[k]; e < part->middle[k]; e++, a += 9) {
    const double *x = m->x + 3 * (int64_t)part->column[e];
    sum +=
        *(const quad2 *)a * x[0] + *(const quad2 *)(a + 3) * x[1] + *(const quad2 *)(a + 6) * x[2];
  }
  for (int64_t e = part->middle[k]; e < part->start[k + 1]; e++) {
    quad2 x = *(const quad2 *)(m->x + 3 * (int64_t)part->column[e]);
    a = part->exact + 9 * (int64_t)part->mirror[e];
    for (int d = 0; d < 3; d++)
      across[d] += *(const quad2 *)(a + 3 * d) * x;
  }
  for (int d = 0; d < 3; d++) {
    double y = sum[d] + (across[d][0] + across[d][1] + across[d][2]);
    m->y[3 * k + d] = y;
    dot[0] += own[d] * y;
  }
}

static inline void six_times_eight(const double *a, const eight2 *x, eight2 sum[3]) {
  sum[0] += a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
  sum[1] += a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
  sum[2] += a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
}

static void product_eight(const product *m, int64_t k, double *dot) {
  const bwi_sweeps *s = m->s;
  const eight2 *all = (const eight2 *)m->x, *own = all + 3 * k;
  const double *a = s->diagonal + 9 * k;
  eight2 sum[3], *y = (eight2 *)m->y + 3 * k, *into = (eight2 *)dot;
  for (int d = 0; d < 3; d++)
    sum[d] = a[d] * own[0] + a[3 + d] * own[1] + a[6 + d] * own[2];
  const bwi_sweep_part *part = &s->even;
  a = part->exact + 6 * part->block[k];
  for (int64_t e = part->start[k]; e < part->middle[k]; e++, a += 6)
    six_times_eight(a, all + 3 * (int64_t)part->column[e], sum);
  for (int64_t e = part->middle[k]; e < part->start[k + 1]; e++) {
    fetch_ahead(part, e);
    six_times_eight(part->exact + 6 * (int64_t)part->mirror[e], all + 3 * (int64_t)part->column[e],
                    sum);
  }
  part = &s->odd;
  a = part->exact + 9 * part->block[k];
  for (int64_t e = part->start[k]; e < part->middle[k]; e++, a += 9) {
    const eight2 *x = all + 3 * (int64_t)part->column[e];
    for (int d = 0; d < 3; d++)
      sum[d] += a[d] * x[0] + a[3 + d] * x[1] + a[6 + d] * x[2];
  }
  for (int64_t e = part->middle[k]; e < part->start[k + 1]; e++) {
    const eight2 *x = all + 3 * (int64_t)part->column[e];
    a = part->exact + 9 * (int64_t)part->mirror[e];
    for (int d = 0; d < 3; d++)
      sum[d] += a[3 * d] * x[0] + a[3 * d + 1] * x[1] + a[3 * d + 2] * x[2];
  }
  for (int d = 0; d < 3; d++) {
    y[d] = sum[d];
    *into += own[d] * sum[d];
  }
}

static bw_status multiply(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *m = data;
  double dot[SIDES] = {0};
  for (int64_t k = begin; k < end; k++)
    if (m->width == 1)
      product_one(m, k, dot);
    else
      product_eight(m, k, dot);
  memcpy(m->part + begin / ROWS * SIDES, dot, sizeof dot);
  return BW_OK;
}

bw_status bwi_sweeps_product(bw_context *context, const bwi_sweeps *s, int width, const double *x,
                             double *y, double *dot) {
  bw_status status = BW_OK;
  int64_t chunks = (s->count + ROWS - 1) / ROWS;
  product m = {s, width, x, y, BW_NEW(context, double, chunks *SIDES)};
  if (!m.part)
    return BW_MEMORY;
  BW_TRY(bw_parallel(context, s->count, ROWS, multiply, &m));
  for (int f = 0; f < width; f++) {
    dot[f] = 0;
    for (int64_t c = 0; c < chunks; c++)
      dot[f] += m.part[c * SIDES + f];
  }
done:
  bw_free(m.part);
  return status;
}

double bwi_sweeps_bytes(int64_t pairs) {
  /* of an entry: two sweeps that read seven numbers, a column each; half a block of doubles, column
     and mirror */
  return 2.0 * (double)pairs * (2 * 32 + 28 + 8);
}

/* ---- the matrix ---------------------------------------------------------------------------- */

typedef struct taking {
  bwi_sweeps *s;
  const double *stiffness;
  const bw_numbering *numbering;
} taking;

/* The inverse of a diagonal block on the unknowns of its node, 0 on what is held: F^T (F K F^T)^-1
 * F with the directions of the unknowns for rows of F. */
static bool invert(const bw_numbering *numbering, int64_t node, const double *block,
                   double inverse[9]) {
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  int32_t row = numbering->frame_of[node];
  const double *frame = row < 0 ? global : numbering->frame + 9 * (int64_t)row;
  int count = 0;
  double f[3][3], a[3][3], b[3][3] = {{0}};
  for (int k = 0; k < 3; k++)
    if (numbering->state[3 * node + k] == BW_UNKNOWN)
      memcpy(f[count++], frame + 3 * k, sizeof f[0]);
  for (int p = 0; p < count; p++)
    for (int q = 0; q < count; q++) {
      a[p][q] = 0;
      for (int i = 0; i < 3; i++)
        a[p][q] += f[p][i] * bw_dot(block + 3 * i, f[q]);
      b[p][q] = p == q;
    }
  for (int k = 0; k < count; k++) { /* pivots of a positive definite matrix are positive */
    double pivot = a[k][k];
    if (!(pivot > 0) || !isfinite(pivot))
      return false;
    for (int q = 0; q < count; q++) {
      a[k][q] /= pivot;
      b[k][q] /= pivot;
    }
    for (int p = 0; p < count; p++) {
      double factor = p == k ? 0 : a[p][k];
      for (int q = 0; q < count; q++) {
        a[p][q] -= factor * a[k][q];
        b[p][q] -= factor * b[k][q];
      }
    }
  }
  memset(inverse, 0, 9 * sizeof *inverse);
  for (int p = 0; p < count; p++)
    for (int q = 0; q < count; q++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          inverse[3 * i + j] += f[p][i] * b[p][q] * f[q][j];
  return true;
}

static const int of_six[6] = {0, 1, 2, 4, 5, 8}; /* of the nine of a block */

/* The blocks on and below the diagonal; an inverse that there is not is NAN. */
static bw_status take_exact(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const taking *t = data;
  const bwi_sweeps *s = t->s;
  for (int64_t k = begin; k < end; k++) {
    int64_t i = s->node[k];
    const double *own = t->stiffness + 9 * (s->graph->start[i + 1] - 1); /* the last of its row */
    double inverse[9];
    bool sound = invert(t->numbering, i, own, inverse);
    for (int c = 0; c < 9; c++) {
      s->inverse[9 * k + c] = sound ? (float)(inverse[3 * (c % 3) + c / 3] / s->unit) : NAN;
      s->diagonal[9 * k + c] = s->unit * own[3 * (c % 3) + c / 3];
    }
    for (int64_t at = s->even.block[k]; at < s->even.block[k + 1]; at++) {
      const double *block = t->stiffness + 9 * (s->even.pair[at] >> 1);
      for (int c = 0; c < 6; c++) {
        int n = of_six[c];
        s->even.exact[6 * at + c] = 0.5 * s->unit * (block[n] + block[3 * (n % 3) + n / 3]);
      }
    }
    for (int64_t at = s->odd.block[k]; at < s->odd.block[k + 1]; at++) {
      const double *block = t->stiffness + 9 * (s->odd.pair[at] >> 1);
      bool transposed = s->odd.pair[at] & 1;
      for (int c = 0; c < 9; c++)
        s->odd.exact[9 * at + c] = s->unit * block[transposed ? c : 3 * (c % 3) + c / 3];
    }
  }
  return BW_OK;
}

static bw_status take_floats(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const taking *t = data;
  const bwi_sweep_part *even = &t->s->even, *odd = &t->s->odd;
  for (int64_t k = begin; k < end; k++) {
    for (int64_t e = even->start[k], at = even->block[k]; e < even->start[k + 1]; e++) {
      const double *block = even->exact + 6 * (e < even->middle[k] ? at++ : even->mirror[e]);
      for (int c = 0; c < 6; c++)
        even->value[6 * e + c] = (float)block[c];
    }
    for (int64_t e = odd->start[k], at = odd->block[k]; e < odd->middle[k]; e++, at++)
      for (int c = 0; c < 9; c++)
        odd->value[9 * e + c] = (float)odd->exact[9 * at + c];
    for (int64_t e = odd->middle[k]; e < odd->start[k + 1]; e++)
      for (int c = 0; c < 9; c++)
        odd->value[9 * e + c] =
            (float)odd->exact[9 * (int64_t)odd->mirror[e] + 3 * (c % 3) + c / 3];
  }
  return BW_OK;
}

bw_status bwi_sweeps_follow(bw_context *context, bwi_sweeps *s, const double *stiffness,
                            const bw_numbering *numbering, bool *usable) {
  bw_status status = BW_OK;
  double most = 0;
  int exponent = 0;
  *usable = false;
  for (int64_t i = 0; i < s->count; i++)
    for (int d = 0; d < 9; d += 4)
      most = fmax(most, stiffness[9 * (s->graph->start[i + 1] - 1) + d]);
  if (!(most > 0) || !isfinite(most))
    return BW_OK;
  frexp(most, &exponent);
  s->unit = ldexp(1, -exponent);
  taking t = {s, stiffness, numbering};
  BW_TRY(bw_parallel(context, s->count, ROWS, take_exact, &t));
  BW_TRY(bw_parallel(context, s->count, ROWS, take_floats, &t));
  *usable = true;
  for (int64_t k = 0; k < s->count; k++)
    *usable &= isfinite(s->inverse[9 * k]) != 0;
done:
  return status;
}

/* ---- the order ----------------------------------------------------------------------------- */

/* Calls what follows for every neighbour j of node i, its pair and whether that is of row j. */
#define FOR_NEIGHBOURS(graph, i, body)                                                             \
  do {                                                                                             \
    for (int64_t p_ = (graph)->start[i]; p_ < (graph)->start[(i) + 1] - 1; p_++) {                 \
      int32_t j = (graph)->column[p_];                                                             \
      body                                                                                         \
    }                                                                                              \
    for (int64_t u_ = (graph)->upper_start[i]; u_ < (graph)->upper_start[(i) + 1]; u_++) {         \
      int32_t j = (graph)->upper_row[u_];                                                          \
      body                                                                                         \
    }                                                                                              \
  } while (0)

/* Nodes by their distance (in pairs) from one, into order[begin ...]: its body. Returns the end. */
static int32_t spread_from(const bw_graph *graph, int32_t from, int32_t begin, int32_t mark,
                           int32_t *seen, int32_t *order) {
  int32_t end = begin;
  order[end++] = from;
  seen[from] = mark;
  for (int32_t at = begin; at < end; at++)
    FOR_NEIGHBOURS(graph, order[at], {
      if (seen[j] != mark) {
        seen[j] = mark;
        order[end++] = j;
      }
    });
  return end;
}

static int32_t chunk_at(int64_t at, int32_t count, int32_t chunks) {
  return (int32_t)(at * chunks / count);
}

/* Whether node i has a neighbour in a later chunk. */
static bool is_between(const bw_graph *graph, int32_t i, const int32_t *at, int32_t chunks) {
  int32_t count = graph->node_count, own = chunk_at(at[i], count, chunks);
  FOR_NEIGHBOURS(graph, i, {
    if (chunk_at(at[j], count, chunks) > own)
      return true;
  });
  return false;
}

/* From nodes by distance (`at`: the inverse) to the order of rows, in as many chunks as leave few
 * nodes between them, whose rows are swept one after the other. */
static void cut(bwi_sweeps *s, const int32_t *near, const int32_t *at) {
  int32_t chunks = BWI_SWEEP_MOST_CHUNKS, row = 0, chunk = -1;
  for (; chunks > 1; chunks /= 2) {
    int32_t shared = 0;
    for (int32_t i = 0; i < s->count; i++)
      shared += is_between(s->graph, i, at, chunks);
    if (shared < s->count / 8)
      break;
  }
  s->chunk_count = chunks;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t k = 0; k < s->count; k++) {
      while (pass == 0 && chunk < chunk_at(k, s->count, chunks))
        s->chunk_start[++chunk] = row;
      if (is_between(s->graph, near[k], at, chunks) == (pass == 1))
        s->node[row++] = near[k];
      if (pass == 0 && k == s->count - 1)
        while (chunk < chunks)
          s->chunk_start[++chunk] = row;
    }
  for (int32_t k = 0; k < s->count; k++)
    s->place[s->node[k]] = k;
}

static bw_status order_nodes(bw_context *context, bwi_sweeps *s) {
  bw_status status = BW_OK;
  int32_t *near = BW_NEW(context, int32_t, s->count), *at = BW_NEW0(context, int32_t, s->count);
  if (!near || !at) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0, end = 0; i < s->count; i++)
    if (at[i] == 0) { /* a body, from one end of it: the node farthest from any */
      int32_t last = spread_from(s->graph, i, end, 1, at, near);
      end = spread_from(s->graph, near[last - 1], end, 2, at, near);
    }
  for (int32_t k = 0; k < s->count; k++)
    at[near[k]] = k;
  cut(s, near, at);
done:
  bw_free(near);
  bw_free(at);
  return status;
}

/* ---- rows ---------------------------------------------------------------------------------- */

typedef struct entry {
  int32_t column;
  int64_t pair;
} entry;

static void sort_row(entry *row, int64_t count) {
  for (int64_t i = 1; i < count; i++) {
    entry one = row[i];
    int64_t k = i;
    for (; k > 0 && row[k - 1].column > one.column; k--)
      row[k] = row[k - 1];
    row[k] = one;
  }
}

/* The pairs of two nodes of one facet of the boundary. */
static void mark_facets(const bw_mesh *mesh, const bw_graph *graph, uint8_t *odd) {
  for (int64_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + f * mesh->nodes_per_facet;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int b = 0; b < mesh->nodes_per_facet; b++) {
        int64_t low = graph->start[node[a]], high = graph->start[node[a] + 1];
        while (node[b] < node[a] && high - low > 1) {
          int64_t middle = (low + high) / 2;
          *(graph->column[middle] <= node[b] ? &low : &high) = middle;
        }
        if (node[b] < node[a])
          odd[low] = 1;
      }
  }
}

static bw_status make_part(bw_context *context, bwi_sweep_part *part, int64_t rows, int64_t blocks,
                           int numbers) {
  part->start = BW_NEW0(context, int64_t, rows + 1);
  part->middle = BW_NEW0(context, int64_t, rows + 1);
  part->block = BW_NEW0(context, int64_t, rows + 1);
  part->column = BW_NEW(context, int32_t, 2 * blocks + 1);
  part->mirror = BW_NEW0(context, int32_t, 2 * blocks + 32);
  part->pair = BW_NEW(context, int64_t, blocks + 1);
  part->value = BW_NEW0(context, float, 2 * numbers * blocks + BWI_SWEEP_SPARE);
  part->exact = BW_NEW0(context, double, numbers *blocks + BWI_SWEEP_SPARE);
  return part->start && part->middle && part->block && part->column && part->mirror && part->pair &&
                 part->value && part->exact
             ? BW_OK
             : BW_MEMORY;
}

static void free_part(bwi_sweep_part *part) {
  bw_free(part->start);
  bw_free(part->middle);
  bw_free(part->block);
  bw_free(part->column);
  bw_free(part->mirror);
  bw_free(part->pair);
  bw_free(part->value);
  bw_free(part->exact);
}

/* Columns of all rows, and which block is what entry. `odd`: by pair; next: room for rows. */
static void list_rows(bwi_sweeps *s, const uint8_t *odd, int64_t *next[2], entry *row) {
  const bw_graph *graph = s->graph;
  bwi_sweep_part *parts[2] = {&s->even, &s->odd};
  for (int32_t k = 0; k < s->count; k++) {
    int32_t i = s->node[k];
    int64_t count = 0;
    for (int64_t p = graph->start[i]; p < graph->start[i + 1] - 1; p++)
      row[count++] = (entry){s->place[graph->column[p]], 2 * p};
    for (int64_t u = graph->upper_start[i]; u < graph->upper_start[i + 1]; u++)
      row[count++] = (entry){s->place[graph->upper_row[u]], 2 * graph->upper_pair[u] + 1};
    sort_row(row, count);
    int64_t end[2];
    for (int n = 0; n < 2; n++) {
      end[n] = parts[n]->start[k];
      parts[n]->middle[k] = end[n];
      parts[n]->block[k + 1] = parts[n]->block[k];
    }
    for (int64_t e = 0; e < count; e++) {
      int n = odd[row[e].pair >> 1];
      bwi_sweep_part *part = parts[n];
      int64_t here = end[n]++;
      part->column[here] = row[e].column;
      if (row[e].column > k)
        continue;
      /* rows come in order, so that the mirrors of a row are listed in order too */
      int64_t at = part->block[k + 1]++;
      part->middle[k] = here + 1;
      part->pair[at] = row[e].pair;
      part->mirror[next[n][row[e].column]++] = (int32_t)at;
    }
    for (int n = 0; n < 2; n++) {
      parts[n]->start[k + 1] = end[n];
      next[n][k] = parts[n]->middle[k];
    }
  }
}

static bw_status make_rows(bw_context *context, bwi_sweeps *s, const bw_mesh *mesh, bool even) {
  bw_status status = BW_OK;
  const bw_graph *graph = s->graph;
  int64_t pairs = graph->pair_count, longest = 0, blocks[2] = {0, 0};
  uint8_t *odd = BW_NEW(context, uint8_t, pairs);
  int64_t *next[2] = {BW_NEW(context, int64_t, s->count), BW_NEW(context, int64_t, s->count)};
  entry *row = NULL;
  if (!odd || !next[0] || !next[1]) {
    status = BW_MEMORY;
    goto done;
  }
  memset(odd, !even, (size_t)pairs);
  if (even)
    mark_facets(mesh, graph, odd);
  for (int64_t i = 0; i < s->count; i++) {
    int64_t length =
        graph->start[i + 1] - graph->start[i] + graph->upper_start[i + 1] - graph->upper_start[i];
    longest = length > longest ? length : longest;
    for (int64_t p = graph->start[i]; p < graph->start[i + 1] - 1; p++)
      blocks[odd[p]]++;
  }
  row = BW_NEW(context, entry, longest + 1);
  if (!row) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(make_part(context, &s->even, s->count, blocks[0], 6));
  BW_TRY(make_part(context, &s->odd, s->count, blocks[1], 9));
  list_rows(s, odd, next, row);
done:
  bw_free(odd);
  bw_free(next[0]);
  bw_free(next[1]);
  bw_free(row);
  return status;
}

/* ---- life ---------------------------------------------------------------------------------- */

static void sweeps_destroy(void *object) {
  bwi_sweeps *s = object;
  bw_release(s->graph);
  bw_free(s->node);
  bw_free(s->place);
  free_part(&s->even);
  free_part(&s->odd);
  bw_free(s->inverse);
  bw_free(s->diagonal);
  bw_free(s);
}

static const bw_kind sweeps_kind = {"sweeps", sweeps_destroy, NULL};

bw_status bwi_sweeps_create(bw_context *context, const bw_mesh *mesh, const bw_graph *graph,
                            bool even, bwi_sweeps **out) {
  bw_status status = BW_OK;
  if (graph->pair_count > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "%lld pairs of nodes are too many for an iterative solution: at most %d",
                   (long long)graph->pair_count, INT32_MAX);
  bwi_sweeps *s = BW_NEW0(context, bwi_sweeps, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &sweeps_kind);
  s->graph = bw_retain(graph);
  s->count = graph->node_count;
  s->node = BW_NEW(context, int32_t, s->count);
  s->place = BW_NEW(context, int32_t, s->count);
  s->inverse = BW_NEW0(context, float, 9 * (int64_t)s->count + BWI_SWEEP_SPARE);
  s->diagonal = BW_NEW0(context, double, 9 * (int64_t)s->count + BWI_SWEEP_SPARE);
  if (!s->node || !s->place || !s->inverse || !s->diagonal) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(order_nodes(context, s));
  BW_TRY(make_rows(context, s, mesh, even));
done:
  if (status == BW_OK)
    *out = s;
  else
    bw_release(s);
  return status;
}
