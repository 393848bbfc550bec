/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A cycle of multigrid over the levels that amg_setup.c makes (amg.h): down with smoothing, the
 * coarsest level directly, up with smoothing in the opposite order, so that B is symmetric. */
#include "linear/amg.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "linear/pcg_packed.h"

enum { SIDES = BWI_SMOOTHER_SIDES, ROWS = 128, DEGREE = 2 };

/* Chebyshev's polynomial is small between the largest eigenvalue and this fraction of it. */
#define LOWEST 0.12

/* ---- life ---------------------------------------------------------------------------------- */

static void free_fields(bwi_amg *g) {
  for (int l = 0; l < g->level_count; l++) {
    bwi_amg_level *v = &g->level[l];
    bw_free(v->b);
    bw_free(v->x);
    bw_free(v->r);
    bw_free(v->d);
    v->b = v->x = v->r = v->d = NULL;
  }
  g->width = 0;
}

static void amg_destroy(void *object) {
  bwi_amg *g = object;
  free_fields(g);
  for (int l = 0; l < BWI_AMG_LEVELS; l++) {
    bwi_amg_level *v = &g->level[l];
    bwi_amg_blocks_clear(&v->a);
    bwi_amg_blocks_clear(&v->p);
    bw_free(v->inverse);
    bw_free(v->child_start);
    bw_free(v->child);
    bw_free(v->child_row);
  }
  bw_release(g->smoother);
  bw_release(g->dof_map);
  bw_free(g->dense);
  bw_free(g->dense_x);
  bw_free(g->null);
  bw_free(g);
}

static size_t blocks_bytes(const bwi_amg_blocks *b) {
  if (!b->start)
    return 0;
  size_t count = (size_t)b->start[b->rows];
  return (size_t)(b->rows + 1) * sizeof(int64_t) +
         count * (sizeof(int32_t) + (size_t)(b->height * b->width) * sizeof(float));
}

static size_t amg_bytes(const void *object) {
  const bwi_amg *g = object;
  size_t bytes = sizeof *g + bw_bytes(g->smoother) +
                 (size_t)g->size * (size_t)(g->size + 1 + g->null_count) * sizeof(double);
  for (int l = 0; l < g->level_count; l++) {
    const bwi_amg_level *v = &g->level[l];
    size_t numbers = (size_t)v->rows * (size_t)v->unknowns;
    bytes += blocks_bytes(&v->a) + blocks_bytes(&v->p) + 4 * numbers * (size_t)g->width * 4;
    if (v->inverse)
      bytes += numbers * (size_t)v->unknowns * sizeof(float);
    if (v->p.start)
      bytes += (size_t)v->p.start[v->p.rows] * 12 + (size_t)(v->p.columns + 1) * 8;
  }
  return bytes;
}

static const bw_kind amg_kind = {"algebraic multigrid", amg_destroy, amg_bytes};

bw_status bwi_amg_create(bw_context *context, const bwi_matrix *matrix, bwi_amg **out) {
  bw_status status = BW_OK;
  bool usable = false;
  bwi_amg *g = BW_NEW0(context, bwi_amg, 1);
  if (!g)
    return BW_MEMORY;
  bw_object_init(g, &amg_kind);
  g->dof_map = bw_retain(matrix->dof_map);
  BW_TRY(bwi_smoother_create(context, NULL, matrix->pattern, false, NULL, &g->smoother));
  BW_TRY(bwi_smoother_follow(context, g->smoother, matrix->stiffness, matrix->dof_map, &usable));
  if (!usable) {
    status = bw_fail(context, BW_SINGULAR, "the block of a node is not positive definite");
    goto done;
  }
  BW_TRY(bwi_amg_set_up(context, g, matrix));
done:
  if (status == BW_OK)
    *out = g;
  else
    bw_release(g);
  return status;
}

static bw_status reserve(bw_context *context, bwi_amg *g, int width) {
  if (g->width >= width)
    return BW_OK;
  free_fields(g);
  for (int l = 0; l < g->level_count; l++) {
    bwi_amg_level *v = &g->level[l];
    size_t numbers =
        (size_t)v->rows * (size_t)v->unknowns * (size_t)width + BWI_SMOOTHER_SPARE * SIDES;
    v->b = BW_NEW0(context, float, numbers);
    v->x = BW_NEW0(context, float, numbers);
    v->r = BW_NEW0(context, float, numbers);
    v->d = BW_NEW0(context, float, numbers);
    if (!v->b || !v->x || !v->r || !v->d) {
      free_fields(g);
      return BW_MEMORY;
    }
  }
  g->width = width;
  return BW_OK;
}

/* ---- kernels ------------------------------------------------------------------------------- */

/* One number of each of four fields, or of eight. */
typedef float four __attribute__((vector_size(16), aligned(4), may_alias));
typedef float eight __attribute__((vector_size(32), aligned(4), may_alias));

/* y += A x of one block for the fields from `first` on that `all` holds, where A's entry of row i
 * and column j is at a[down i + across j]. */
#define ADD_BLOCK(name, all)                                                                       \
  static inline void name(const float *a, int rows, int columns, int down, int across, int fields, \
                          int first, const float *x, float *y) {                                   \
    for (int i = 0; i < rows; i++) {                                                               \
      all sum = *(const all *)(y + i * fields + first);                                            \
      for (int j = 0; j < columns; j++)                                                            \
        sum += a[down * i + across * j] * *(const all *)(x + j * fields + first);                  \
      *(all *)(y + i * fields + first) = sum;                                                      \
    }                                                                                              \
  }
ADD_BLOCK(add_to_one, float)
ADD_BLOCK(add_to_four, four)
ADD_BLOCK(add_to_eight, eight)

static inline void add_any(const float *a, int rows, int columns, int down, int across, int fields,
                           const float *x, float *y) {
  int first = 0;
  for (; first + 8 <= fields; first += 8)
    add_to_eight(a, rows, columns, down, across, fields, first, x, y);
  for (; first + 4 <= fields; first += 4)
    add_to_four(a, rows, columns, down, across, fields, first, x, y);
  for (; first < fields; first++)
    add_to_one(a, rows, columns, down, across, fields, first, x, y);
}

/* y += A x of one block, for `fields` interleaved fields; y += A^T x. */
static inline void add_block(const float *a, int height, int width, int fields, const float *x,
                             float *y) {
  add_any(a, height, width, width, 1, fields, x, y);
}

static inline void add_transposed(const float *a, int height, int width, int fields, const float *x,
                                  float *y) {
  add_any(a, width, height, 1, width, fields, x, y);
}

/* Compiled for the sizes that there are. */
#define FOR_FIELDS(fields, call)                                                                   \
  do {                                                                                             \
    if ((fields) == 1) {                                                                           \
      enum { F = 1 };                                                                              \
      call;                                                                                        \
    } else if ((fields) == 4) {                                                                    \
      enum { F = 4 };                                                                              \
      call;                                                                                        \
    } else if ((fields) == 8) {                                                                    \
      enum { F = 8 };                                                                              \
      call;                                                                                        \
    } else {                                                                                       \
      enum { F = 12 };                                                                             \
      call;                                                                                        \
    }                                                                                              \
  } while (0)

typedef struct cycle {
  bwi_amg *g;
  bwi_amg_level *v;
  int width, degree;
  double largest, first, second; /* coefficients of a step: d = first d + second D^-1 r */
  bool again;                    /* r -= A d, else r = b - A x */
} cycle;

/* r -= A d, or r = b - A x */
static bw_status subtract_product(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cycle *c = data;
  const bwi_amg_level *v = c->v;
  const float *from = c->again ? v->d : v->x, *base = c->again ? v->r : v->b;
  int u = 6 * c->width;
  for (int64_t i = begin; i < end; i++) {
    float sum[6 * SIDES] = {0};
    for (int64_t k = v->a.start[i]; k < v->a.start[i + 1]; k++)
      FOR_FIELDS(c->width,
                 add_block(v->a.value + 36 * k, 6, 6, F, from + u * (int64_t)v->a.column[k], sum));
    for (int j = 0; j < u; j++)
      v->r[u * i + j] = base[u * i + j] - sum[j];
  }
  return BW_OK;
}

/* d = first d + second D^-1 r, x += d */
static bw_status step(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cycle *c = data;
  const bwi_amg_level *v = c->v;
  int u = 6 * c->width;
  for (int64_t i = begin; i < end; i++) {
    float sum[6 * SIDES] = {0};
    FOR_FIELDS(c->width, add_block(v->inverse + 36 * i, 6, 6, F, v->r + u * i, sum));
    for (int j = 0; j < u; j++) {
      float d = (float)c->second * sum[j];
      if (c->first != 0)
        d += (float)c->first * v->d[u * i + j];
      v->d[u * i + j] = d;
      v->x[u * i + j] += d;
    }
  }
  return BW_OK;
}

/* Chebyshev's iteration (Saad, algorithm 12.1) with r at hand; `residual`: r is kept. */
static bw_status chebyshev(bw_context *context, cycle *c, bool residual) {
  bw_status status = BW_OK;
  const bwi_amg_level *v = c->v;
  double high = v->largest, low = LOWEST * high, theta = 0.5 * (high + low);
  double delta = 0.5 * (high - low), sigma = theta / delta, rho = 1 / sigma;
  c->first = 0;
  c->second = 1 / theta;
  for (int k = 0; k < DEGREE; k++) {
    BW_TRY(bw_parallel(context, v->rows, ROWS, step, c));
    if (k == DEGREE - 1 && !residual)
      break;
    c->again = true;
    BW_TRY(bw_parallel(context, v->rows, ROWS, subtract_product, c));
    double next = 1 / (2 * sigma - rho);
    c->first = next * rho;
    c->second = 2 * next / delta;
    rho = next;
  }
done:
  return status;
}

/* b of the next level = P^T r, x of it = 0 */
static bw_status restrict_residual(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cycle *c = data;
  const bwi_amg_level *v = c->v, *next = v + 1;
  int u = 6 * c->width, h = v->unknowns;
  for (int64_t i = begin; i < end; i++) {
    float sum[6 * SIDES] = {0};
    for (int64_t k = v->child_start[i]; k < v->child_start[i + 1]; k++) {
      const float *p = v->p.value + (int64_t)h * 6 * v->child[k];
      const float *r = v->r + (int64_t)h * c->width * v->child_row[k];
      if (h == 3)
        FOR_FIELDS(c->width, add_transposed(p, 3, 6, F, r, sum));
      else
        FOR_FIELDS(c->width, add_transposed(p, 6, 6, F, r, sum));
    }
    memcpy(next->b + u * i, sum, (size_t)u * sizeof *sum);
    memset(next->x + u * i, 0, (size_t)u * sizeof *sum);
    memcpy(next->r + u * i, sum, (size_t)u * sizeof *sum);
  }
  return BW_OK;
}

/* x += P x of the next level */
static bw_status prolong(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cycle *c = data;
  const bwi_amg_level *v = c->v, *next = v + 1;
  int u = 6 * c->width, h = v->unknowns;
  for (int64_t i = begin; i < end; i++) {
    float *x = v->x + (int64_t)h * c->width * i;
    for (int64_t k = v->p.start[i]; k < v->p.start[i + 1]; k++) {
      const float *p = v->p.value + (int64_t)h * 6 * k;
      const float *from = next->x + u * (int64_t)v->p.column[k];
      if (h == 3)
        FOR_FIELDS(c->width, add_block(p, 3, 6, F, from, x));
      else
        FOR_FIELDS(c->width, add_block(p, 6, 6, F, from, x));
    }
  }
  return BW_OK;
}

/* x without its part along the null space of the coarsest level */
static void remove_null(const bwi_amg *g, double *x) {
  for (int m = 0; m < g->null_count; m++) {
    const double *mode = g->null + (int64_t)g->size * m;
    double part = bwi_dot(g->size, mode, x);
    for (int i = 0; i < g->size; i++)
      x[i] -= part * mode[i];
  }
}

/* The coarsest level: x = A^-1 b, or by the pseudo-inverse. */
static void solve_coarsest(cycle *c, const bwi_amg_level *v) {
  bwi_amg *g = c->g;
  for (int f = 0; f < c->width; f++) {
    for (int i = 0; i < g->size; i++)
      g->dense_x[i] = (double)v->b[i * c->width + f];
    remove_null(g, g->dense_x);
    bwi_lower_solve(g->size, g->dense, g->dense_x);
    bwi_upper_solve(g->size, g->dense, g->dense_x);
    remove_null(g, g->dense_x);
    for (int i = 0; i < g->size; i++)
      v->x[i * c->width + f] = (float)g->dense_x[i];
  }
}

static bw_status descend(bw_context *context, cycle *c, int from) {
  bw_status status = BW_OK;
  bwi_amg *g = c->g;
  int last = g->level_count - 1;
  for (int l = from; l < last; l++) {
    c->v = &g->level[l];
    if (l > 0)
      BW_TRY(chebyshev(context, c, true));
    BW_TRY(bw_parallel(context, c->v->p.columns, ROWS, restrict_residual, c));
  }
  solve_coarsest(c, &g->level[last]);
  for (int l = last - 1; l >= from; l--) {
    c->v = &g->level[l];
    BW_TRY(bw_parallel(context, c->v->rows, ROWS, prolong, c));
    if (l > 0) {
      c->again = false;
      BW_TRY(bw_parallel(context, c->v->rows, ROWS, subtract_product, c));
      BW_TRY(chebyshev(context, c, false));
    }
  }
done:
  return status;
}

/* ---- application --------------------------------------------------------------------------- */

typedef struct packing {
  const bwi_amg *g;
  int width, used;
  const double *r;
  double *z;
  double unit[SIDES]; /* each field times a power of two, so that floats hold it */
} packing;

static bw_status pack(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *p = data;
  const bwi_smoother *s = p->g->smoother;
  int64_t size = 3 * (int64_t)s->count;
  for (int64_t k = begin; k < end; k++)
    for (int f = 0; f < p->width; f++) {
      double x[3] = {0, 0, 0};
      for (int d = 0; d < 3 && f < p->used; d++)
        x[d] = p->unit[f] * p->r[f * size + 3 * (int64_t)s->node[k] + d];
      bwi_project_unknowns(p->g->dof_map, s->node[k], x, x);
      for (int d = 0; d < 3; d++)
        p->g->level[0].b[(3 * k + d) * p->width + f] = (float)x[d];
    }
  return BW_OK;
}

static bw_status unpack(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *p = data;
  const bwi_smoother *s = p->g->smoother;
  int64_t size = 3 * (int64_t)s->count;
  for (int64_t k = begin; k < end; k++)
    for (int f = 0; f < p->used; f++) {
      double x[3];
      for (int d = 0; d < 3; d++)
        x[d] = (double)p->g->level[0].x[(3 * k + d) * p->width + f] * (s->unit / p->unit[f]);
      bwi_project_unknowns(p->g->dof_map, s->node[k], x, x);
      memcpy(p->z + f * size + 3 * (int64_t)s->node[k], x, sizeof x);
    }
  return BW_OK;
}

static bw_status apply_some(bw_context *context, bwi_amg *g, int width, int used, const double *r,
                            double *z) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &g->level[0];
  int64_t size = 3 * (int64_t)g->smoother->count;
  packing p = {.g = g, .width = width, .used = used, .r = r, .z = z};
  cycle c = {.g = g, .width = width, .v = v};
  for (int f = 0; f < used; f++) {
    double max = 0;
    int exponent = 0;
    for (int64_t i = 0; i < size; i++)
      max = fmax(max, fabs(r[f * size + i]));
    frexp(max, &exponent);
    p.unit[f] = ldexp(1, -exponent);
  }
  BW_TRY(bw_parallel(context, g->smoother->count, ROWS, pack, &p));
  BW_TRY(bwi_smoother_forward(context, g->smoother, width, v->b, v->x, v->r));
  BW_TRY(descend(context, &c, 0));
  BW_TRY(bwi_smoother_backward(context, g->smoother, width, v->b, v->x, v->r));
  BW_TRY(bw_parallel(context, g->smoother->count, ROWS, unpack, &p));
done:
  return status;
}

bw_status bwi_amg_apply(bw_context *context, bwi_amg *g, int64_t count, const double *r,
                        double *z) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)g->smoother->count;
  int width = bwi_smoother_width(count);
  BW_TRY(reserve(context, g, width));
  for (int64_t first = 0; first < count; first += width) {
    width = bwi_smoother_width(count - first); /* no more than before */
    int used = (int)(count - first < width ? count - first : width);
    BW_TRY(apply_some(context, g, width, used, r + first * size, z + first * size));
  }
done:
  return status;
}

double bwi_amg_pass_bytes(const bwi_amg *g) {
  double bytes = 64 * (double)(g->smoother->pattern->block_count - g->smoother->count);
  for (int l = 0; l < g->level_count; l++) {
    const bwi_amg_level *v = &g->level[l];
    if (v->p.start)
      bytes += 2.0 * (double)blocks_bytes(&v->p);
    if (l > 0 && v->a.start)
      bytes += 2.0 * DEGREE * (double)blocks_bytes(&v->a);
  }
  return bytes + 8.0 * g->size * g->size;
}
