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
    bwi_amg_blocks_clear(&v->pt);
    bw_free(v->inverse);
  }
  bw_release(g->smoother);
  bw_release(g->dof_map);
  bw_free(g->dense);
  bw_free(g->dense_x);
  bw_free(g->null);
  bw_release(g->rigid);
  bw_free(g->constrained);
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
  size_t bytes = sizeof *g + bw_bytes(g->smoother) + bw_bytes(g->rigid) +
                 (size_t)g->constrained_count * sizeof *g->constrained +
                 (size_t)g->size * (size_t)(g->size + SIDES + g->null_count) * sizeof(double);
  for (int l = 0; l < g->level_count; l++) {
    const bwi_amg_level *v = &g->level[l];
    size_t numbers = (size_t)v->rows * (size_t)v->unknowns;
    bytes += blocks_bytes(&v->a) + blocks_bytes(&v->p) + blocks_bytes(&v->pt) +
             (l > 0 ? 4 : 3) * numbers * (size_t)g->width * sizeof(float);
    if (v->inverse)
      bytes += numbers * (size_t)v->unknowns * sizeof(float);
  }
  return bytes;
}

static const bw_kind amg_kind = {"algebraic multigrid", amg_destroy, amg_bytes};

static bw_status list_constrained(bw_context *context, bwi_amg *g) {
  g->constrained = BW_NEW(context, int32_t, g->smoother->count);
  if (!g->constrained)
    return BW_MEMORY;
  for (int32_t k = 0; k < g->smoother->count; k++)
    if (memchr(g->dof_map->state + 3 * (int64_t)g->smoother->node[k], BW_DOF_PRESCRIBED, 3))
      g->constrained[g->constrained_count++] = k;
  return BW_OK;
}

bw_status bwi_amg_create(bw_context *context, const bwi_matrix *matrix, bool solves,
                         bwi_amg **out) {
  bw_status status = BW_OK;
  bool usable = false;
  bwi_amg *g = BW_NEW0(context, bwi_amg, 1);
  if (!g)
    return BW_MEMORY;
  bw_object_init(g, &amg_kind);
  g->dof_map = bw_retain(matrix->dof_map);
  BW_TRY(bwi_smoother_create(context, solves ? matrix->dof_map->mesh : NULL, matrix->pattern,
                             solves && matrix->even, false, NULL, &g->smoother));
  BW_TRY(bwi_smoother_follow(context, g->smoother, &(bwi_stiffness){.values = matrix->stiffness},
                             matrix->dof_map, &usable));
  if (!usable) {
    status = bw_fail(context, BW_SINGULAR, "the block of a node is not positive definite");
    goto done;
  }
  BW_TRY(bwi_amg_set_up(context, g, matrix));
  BW_TRY(list_constrained(context, g));
  if (solves && matrix->dof_map->rigid_mode_count > 0)
    BW_TRY(bwi_rigid_space_create(context, matrix->dof_map, g->smoother->row_of, &g->rigid));
done:
  if (status == BW_OK)
    *out = g;
  else
    bw_release(g);
  return status;
}

bw_status bwi_amg_reserve(bw_context *context, bwi_amg *g, int width) {
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
    v->d = l > 0 ? BW_NEW0(context, float, numbers) : NULL;
    if (!v->b || !v->x || !v->r || (l > 0 && !v->d)) {
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

/* Blocks of a row: `height` x `width` numbers each, by columns, the first at `value`. `column`:
 * rows of x; NULL: the one block there is meets the first. */
typedef struct row {
  int height, width;
  int64_t count;
  const int32_t *column;
  const float *value;
} row;

/* y += A x for the fields from `first` on that `all` holds. The sums stay in registers, for which
 * the compiler has to know the sizes. */
#define ADD_ROW(name, all)                                                                         \
  static inline void name(const row *a, int height, int width, int fields, int first,              \
                          const float *x, float *y) {                                              \
    const float *value = a->value;                                                                 \
    all sum[6];                                                                                    \
    for (int i = 0; i < height; i++)                                                               \
      sum[i] = *(const all *)(y + i * fields + first);                                             \
    for (int64_t k = 0; k < a->count; k++) {                                                       \
      const float *from = x + (a->column ? (int64_t)a->column[k] * width * fields : 0) + first;    \
      for (int j = 0; j < width; j++) {                                                            \
        all in = *(const all *)(from + j * fields);                                                \
        for (int i = 0; i < height; i++)                                                           \
          sum[i] += *value++ * in;                                                                 \
      }                                                                                            \
    }                                                                                              \
    for (int i = 0; i < height; i++)                                                               \
      *(all *)(y + i * fields + first) = sum[i];                                                   \
  }
ADD_ROW(add_to_four, four)
ADD_ROW(add_to_eight, eight)

/* The same for one field: a column of a block is added at once. */
static inline void add_to_one(const row *a, int height, int width, const float *x, float *y) {
  const float *value = a->value;
  eight sum = {0};
  for (int i = 0; i < height; i++)
    sum[i] = y[i];
  for (int64_t k = 0; k < a->count; k++) {
    const float *from = x + (a->column ? (int64_t)a->column[k] * width : 0);
    for (int j = 0; j < width; j++, value += height)
      sum += *(const eight *)value * from[j];
  }
  for (int i = 0; i < height; i++)
    y[i] = sum[i];
}

static inline void add_sized(const row *a, int height, int width, int fields, const float *x,
                             float *y) {
  int first = 0;
  if (fields == 1) {
    add_to_one(a, height, width, x, y);
    return;
  }
  for (; first + 8 <= fields; first += 8)
    add_to_eight(a, height, width, fields, first, x, y);
  if (first < fields)
    add_to_four(a, height, width, fields, first, x, y);
}

static void add_row(const row *a, int fields, const float *x, float *y) {
  if (a->height == 3)
    add_sized(a, 3, 6, fields, x, y);
  else if (a->width == 3)
    add_sized(a, 6, 3, fields, x, y);
  else
    add_sized(a, 6, 6, fields, x, y);
}

static row row_of(const bwi_amg_blocks *b, int64_t k) {
  int64_t start = b->start[k];
  return (row){.height = b->height,
               .width = b->width,
               .count = b->start[k + 1] - start,
               .column = b->column + start,
               .value = b->value + start * b->height * b->width};
}

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
    const row a = row_of(&v->a, i);
    add_row(&a, c->width, from, sum);
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
    const row inverse = {.height = 6, .width = 6, .count = 1, .value = v->inverse + 36 * i};
    add_row(&inverse, c->width, v->r + u * i, sum);
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
  int u = 6 * c->width;
  for (int64_t i = begin; i < end; i++) {
    float sum[6 * SIDES] = {0};
    const row pt = row_of(&v->pt, i);
    add_row(&pt, c->width, v->r, sum);
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
  const bwi_amg_level *v = c->v;
  for (int64_t i = begin; i < end; i++) {
    const row p = row_of(&v->p, i);
    add_row(&p, c->width, v[1].x, v->x + (int64_t)v->unknowns * c->width * i);
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

/* The coarsest level, field by field: x = A^-1 b, or by the pseudo-inverse. */
static bw_status solve_coarsest(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cycle *c = data;
  const bwi_amg *g = c->g;
  const bwi_amg_level *v = c->v;
  for (int64_t f = begin; f < end; f++) {
    double *x = g->dense_x + f * g->size;
    for (int i = 0; i < g->size; i++)
      x[i] = (double)v->b[i * c->width + f];
    remove_null(g, x);
    bwi_lower_solve(g->size, g->dense, x);
    bwi_upper_solve(g->size, g->dense, x);
    remove_null(g, x);
    for (int i = 0; i < g->size; i++)
      v->x[i * c->width + f] = (float)x[i];
  }
  return BW_OK;
}

/* From the nodes to the coarsest level and back. */
static bw_status descend(bw_context *context, cycle *c) {
  bw_status status = BW_OK;
  bwi_amg *g = c->g;
  int last = g->level_count - 1;
  for (int l = 0; l < last; l++) {
    c->v = &g->level[l];
    if (l > 0)
      BW_TRY(chebyshev(context, c, true));
    BW_TRY(bw_parallel(context, c->v->p.columns, ROWS, restrict_residual, c));
  }
  c->v = &g->level[last];
  BW_TRY(bw_parallel(context, c->width, 1, solve_coarsest, c));
  for (int l = last - 1; l >= 0; l--) {
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

bw_status bwi_amg_cycle(bw_context *context, bwi_amg *g, int width) {
  bw_status status = BW_OK;
  const bwi_amg_level *v = &g->level[0];
  cycle c = {.g = g, .width = width};
  BW_TRY(bwi_smoother_forward(context, g->smoother, width, v->b, v->x, v->r));
  BW_TRY(descend(context, &c));
  BW_TRY(bwi_smoother_backward(context, g->smoother, width, v->b, v->x, v->r));
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

/* The power of two that brings the largest number of a field between 1/2 and 1. */
static bw_status find_units(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  packing *p = data;
  int64_t size = 3 * (int64_t)p->g->smoother->count;
  for (int64_t f = begin; f < end; f++) {
    const double *r = p->r + f * size;
    double max = 0;
    int exponent = 0;
    for (int64_t i = 0; i < size; i++) {
      double number = fabs(r[i]);
      max = number > max ? number : max;
    }
    frexp(max, &exponent);
    p->unit[f] = ldexp(1, -exponent);
  }
  return BW_OK;
}

static bw_status pack(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *p = data;
  const bwi_smoother *s = p->g->smoother;
  int64_t size = 3 * (int64_t)s->count;
  for (int64_t k = begin; k < end; k++)
    for (int f = 0; f < p->width; f++) {
      float *b = p->g->level[0].b + 3 * k * p->width + f;
      const double *r = p->r + f * size + 3 * (int64_t)s->node[k];
      for (int d = 0; d < 3; d++)
        b[d * p->width] = f < p->used ? (float)(p->unit[f] * r[d]) : 0;
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
      const float *x = p->g->level[0].x + 3 * k * p->width + f;
      double *z = p->z + f * size + 3 * (int64_t)s->node[k];
      for (int d = 0; d < 3; d++)
        z[d] = (double)x[d * p->width] * (s->unit / p->unit[f]);
    }
  return BW_OK;
}

static bw_status apply_some(bw_context *context, bwi_amg *g, int width, int used, const double *r,
                            double *z) {
  bw_status status = BW_OK;
  packing p = {.g = g, .width = width, .used = used, .r = r, .z = z};
  BW_TRY(bw_parallel(context, used, 1, find_units, &p));
  BW_TRY(bw_parallel(context, g->smoother->count, ROWS, pack, &p));
  bwi_smoother_keep(g->smoother, g->dof_map, g->constrained_count, g->constrained, width,
                    g->level[0].b);
  BW_TRY(bwi_amg_cycle(context, g, width));
  bwi_smoother_keep(g->smoother, g->dof_map, g->constrained_count, g->constrained, width,
                    g->level[0].x);
  BW_TRY(bw_parallel(context, g->smoother->count, ROWS, unpack, &p));
done:
  return status;
}

bw_status bwi_amg_apply(bw_context *context, bwi_amg *g, int64_t count, const double *r,
                        double *z) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)g->smoother->count;
  int width = bwi_smoother_width(count);
  BW_TRY(bwi_amg_reserve(context, g, width));
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
      bytes += (double)(blocks_bytes(&v->p) + blocks_bytes(&v->pt));
    if (l > 0 && v->a.start)
      bytes += 2.0 * DEGREE * (double)blocks_bytes(&v->a);
  }
  return bytes + 8.0 * g->size * g->size;
}
