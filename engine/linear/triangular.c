/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* x = L^-T S L^-1 x for several right-hand sides at once. The right-hand sides of one unknown lie
 * next to each other, so each number of L, which has to come from memory, is used for all of them:
 * eight cost little more than one.
 *
 * Subtrees (tasks) run on different threads. What a task adds to unknowns above its own goes to a
 * collector of its own; collectors are summed in ascending order of their roots. In the top, rows
 * (forward) or columns (backward) of a panel are shared out. No sum depends on who did what. */
#include <string.h>

#include "linear/blas.h"
#include "linear/internal.h"

/* Columns solved together, numbers kept in the first-level cache, columns of one chunk of work. */
enum { PANEL = 128, CACHED = 32768 / sizeof(real), COLUMNS = 32 };

/* Rows of one chunk of work in the top. */
static int64_t rows_at_once(int width) {
  return width < 4 ? CACHED / 4 : CACHED / width;
}

#ifdef __FP_FAST_FMA
#define multiply_add(a, b, c) FUSED(a, b, c)
#else
#define multiply_add(a, b, c) ((a) * (b) + (c))
#endif
#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* ---- kernels ------------------------------------------------------------------------------- */
/* L: panel entries from a given row and column on, leading dimension ld. x: one row of W numbers
 * per column. y: one per row. W is a constant wherever these are expanded. */

/* One right-hand side is as fast as memory lets L through. Columns of a panel are short streams,
 * too short for the hardware to run ahead in, so the next four are asked for by hand while four are
 * at work; past the end of a panel that is the beginning of the next one. */
enum { LINE = 64 / sizeof(real) }; /* numbers in a cache line */
static inline void ask_for(const real *l, int64_t ld) {
  for (int c = 0; c < 4; c++)
    __builtin_prefetch(l + (4 + c) * ld);
}

/* y -= L x for one right-hand side, four columns */
static inline void forward_four(const real *l, int64_t ld, int64_t rows, const real *x,
                                real *restrict y) {
  const real *l0 = l, *l1 = l0 + ld, *l2 = l1 + ld, *l3 = l2 + ld;
  const real x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3];
  int64_t r = 0;
  for (; r + LINE <= rows; r += LINE) {
    ask_for(l + r, ld);
    for (int k = 0; k < LINE; k++) {
      real sum = multiply_add(-l0[r + k], x0, y[r + k]);
      sum = multiply_add(-l1[r + k], x1, sum);
      sum = multiply_add(-l2[r + k], x2, sum);
      y[r + k] = multiply_add(-l3[r + k], x3, sum);
    }
  }
  for (; r < rows; r++) {
    real sum = multiply_add(-l0[r], x0, y[r]);
    sum = multiply_add(-l1[r], x1, sum);
    sum = multiply_add(-l2[r], x2, sum);
    y[r] = multiply_add(-l3[r], x3, sum);
  }
}

static inline real sum_of(real *lane) {
  for (int half = LINE / 2; half > 0; half /= 2)
    for (int k = 0; k < half; k++)
      lane[k] += lane[k + half];
  return lane[0];
}

/* x -= L^T y for one right-hand side, four columns. A line of sums side by side for each: one sum
 * would wait for itself at every step. */
static inline void backward_four(const real *l, int64_t ld, int64_t rows, real *x, const real *y) {
  const real *l0 = l, *l1 = l0 + ld, *l2 = l1 + ld, *l3 = l2 + ld;
  real s0[LINE] = {0}, s1[LINE] = {0}, s2[LINE] = {0}, s3[LINE] = {0};
  int64_t r = 0;
  for (; r + LINE <= rows; r += LINE) {
    ask_for(l + r, ld);
    for (int k = 0; k < LINE; k++) {
      s0[k] = multiply_add(l0[r + k], y[r + k], s0[k]);
      s1[k] = multiply_add(l1[r + k], y[r + k], s1[k]);
      s2[k] = multiply_add(l2[r + k], y[r + k], s2[k]);
      s3[k] = multiply_add(l3[r + k], y[r + k], s3[k]);
    }
  }
  for (; r < rows; r++) {
    s0[0] = multiply_add(l0[r], y[r], s0[0]);
    s1[0] = multiply_add(l1[r], y[r], s1[0]);
    s2[0] = multiply_add(l2[r], y[r], s2[0]);
    s3[0] = multiply_add(l3[r], y[r], s3[0]);
  }
  x[0] -= sum_of(s0);
  x[1] -= sum_of(s1);
  x[2] -= sum_of(s2);
  x[3] -= sum_of(s3);
}

/* y -= L x */
ALWAYS_INLINE void forward_kernel(const int W, const real *l, int64_t ld, int64_t rows,
                                  int64_t columns, const real *x, real *y) {
  const int64_t block = CACHED / W;
  for (int64_t begin = 0; begin < rows; begin += block) {
    int64_t end = rows - begin < block ? rows : begin + block;
    int64_t c = 0;
    for (; c + 4 <= columns; c += 4) {
      if (W == 1) {
        forward_four(l + c * ld + begin, ld, end - begin, x + c, y + begin);
        continue;
      }
      const real *l0 = l + c * ld, *l1 = l0 + ld, *l2 = l1 + ld, *l3 = l2 + ld, *xc = x + c * W;
      real *restrict to = y;
      for (int64_t r = begin; r < end; r++)
        for (int w = 0; w < W; w++) {
          real sum = to[r * W + w];
          sum = multiply_add(-l0[r], xc[w], sum);
          sum = multiply_add(-l1[r], xc[W + w], sum);
          sum = multiply_add(-l2[r], xc[2 * W + w], sum);
          to[r * W + w] = multiply_add(-l3[r], xc[3 * W + w], sum);
        }
    }
    for (; c < columns; c++) {
      const real *l0 = l + c * ld, *xc = x + c * W;
      real *restrict to = y;
      for (int64_t r = begin; r < end; r++)
        for (int w = 0; w < W; w++)
          to[r * W + w] = multiply_add(-l0[r], xc[w], to[r * W + w]);
    }
  }
}

/* x -= L^T y */
ALWAYS_INLINE void backward_kernel(const int W, const real *l, int64_t ld, int64_t rows,
                                   int64_t columns, real *x, const real *y) {
  const int64_t block = CACHED / W;
  for (int64_t begin = 0; begin < rows; begin += block) {
    int64_t end = rows - begin < block ? rows : begin + block;
    int64_t c = 0;
    for (; c + 4 <= columns; c += 4) {
      if (W == 1) {
        backward_four(l + c * ld + begin, ld, end - begin, x + c, y + begin);
        continue;
      }
      const real *l0 = l + c * ld, *l1 = l0 + ld, *l2 = l1 + ld, *l3 = l2 + ld;
      real sum[4 * BWI_MAX_WIDTH] = {0};
      for (int64_t r = begin; r < end; r++)
        for (int w = 0; w < W; w++) {
          real yw = y[r * W + w];
          sum[w] = multiply_add(l0[r], yw, sum[w]);
          sum[W + w] = multiply_add(l1[r], yw, sum[W + w]);
          sum[2 * W + w] = multiply_add(l2[r], yw, sum[2 * W + w]);
          sum[3 * W + w] = multiply_add(l3[r], yw, sum[3 * W + w]);
        }
      for (int w = 0; w < 4 * W; w++)
        x[c * W + w] -= sum[w];
    }
    for (; c < columns; c++) {
      const real *l0 = l + c * ld;
      real sum[BWI_MAX_WIDTH] = {0};
      for (int64_t r = begin; r < end; r++)
        for (int w = 0; w < W; w++)
          sum[w] = multiply_add(l0[r], y[r * W + w], sum[w]);
      for (int w = 0; w < W; w++)
        x[c * W + w] -= sum[w];
    }
  }
}

/* The triangle of `columns` columns, four at a time. */
ALWAYS_INLINE void forward_triangle(const int W, const real *l, int64_t ld, int64_t columns,
                                    real *x) {
  for (int64_t c = 0; c < columns; c += 4) {
    int64_t end = columns - c < 4 ? columns : c + 4;
    for (int64_t j = c; j < end; j++) {
      real diagonal = l[j * ld + j];
      for (int w = 0; w < W; w++)
        x[j * W + w] /= diagonal;
      for (int64_t i = j + 1; i < end; i++)
        for (int w = 0; w < W; w++)
          x[i * W + w] = multiply_add(-l[j * ld + i], x[j * W + w], x[i * W + w]);
    }
    forward_kernel(W, l + c * ld + end, ld, columns - end, end - c, x + c * W, x + end * W);
  }
}

ALWAYS_INLINE void backward_triangle(const int W, const real *l, int64_t ld, int64_t columns,
                                     real *x) {
  for (int64_t c = (columns - 1) / 4 * 4; c >= 0; c -= 4) {
    int64_t end = columns - c < 4 ? columns : c + 4;
    backward_kernel(W, l + c * ld + end, ld, columns - end, end - c, x + c * W, x + end * W);
    for (int64_t j = end - 1; j >= c; j--) {
      for (int64_t i = j + 1; i < end; i++)
        for (int w = 0; w < W; w++)
          x[j * W + w] = multiply_add(-l[j * ld + i], x[i * W + w], x[j * W + w]);
      real diagonal = l[j * ld + j];
      for (int w = 0; w < W; w++)
        x[j * W + w] /= diagonal;
    }
  }
}

#define FOR_WIDTH(width, call)                                                                     \
  switch (width) {                                                                                 \
  case 1: {                                                                                        \
    enum { W = 1 };                                                                                \
    call;                                                                                          \
  } break;                                                                                         \
  case 2: {                                                                                        \
    enum { W = 2 };                                                                                \
    call;                                                                                          \
  } break;                                                                                         \
  case 4: {                                                                                        \
    enum { W = 4 };                                                                                \
    call;                                                                                          \
  } break;                                                                                         \
  case 8: {                                                                                        \
    enum { W = 8 };                                                                                \
    call;                                                                                          \
  } break;                                                                                         \
  default: {                                                                                       \
    enum { W = 16 };                                                                               \
    call;                                                                                          \
  }                                                                                                \
  }

static void forward(int width, const real *l, int64_t ld, int64_t rows, int64_t columns,
                    const real *x, real *y) {
  FOR_WIDTH(width, forward_kernel(W, l, ld, rows, columns, x, y))
}
static void backward(int width, const real *l, int64_t ld, int64_t rows, int64_t columns, real *x,
                     const real *y) {
  FOR_WIDTH(width, backward_kernel(W, l, ld, rows, columns, x, y))
}
static void lower_triangle(int width, const real *l, int64_t ld, int64_t columns, real *x) {
  FOR_WIDTH(width, forward_triangle(W, l, ld, columns, x))
}
static void upper_triangle(int width, const real *l, int64_t ld, int64_t columns, real *x) {
  FOR_WIDTH(width, backward_triangle(W, l, ld, columns, x))
}

/* ---- the tree ------------------------------------------------------------------------------ */

typedef struct scratch {
  int32_t *index; /* unknowns of a panel's rows below the pivots */
  real *y;        /* those rows, width numbers each */
  int32_t *slot;  /* unknown -> row of the collector */
} scratch;

typedef struct solution {
  bw_context *context;
  const bwi_symbolic *symbolic;
  const real *value;
  int width;
  real *x;
  real **collector; /* per task */
  scratch *space;   /* per worker */
  /* the top panel at work */
  const real *panel;
  int64_t ld, begin, end, pivots;
  int32_t first;
} solution;

static bw_status forward_tasks(void *data, int64_t begin, int64_t end, int worker) {
  solution *solve = data;
  const bwi_symbolic *symbolic = solve->symbolic;
  const bwi_order *order = symbolic->order;
  scratch *space = &solve->space[worker];
  int width = solve->width;
  for (int64_t t = begin; t < end; t++) {
    const bwi_task *task = &symbolic->plan.task[t];
    int32_t limit = symbolic->first[order->super[task->root + 1]];
    int32_t outside = bwi_outer_unknowns(symbolic, task->root, space->index);
    for (int32_t i = 0; i < outside; i++)
      space->slot[space->index[i]] = i;
    real *collector = solve->collector[t];
    memset(collector, 0, (size_t)outside * (size_t)width * sizeof(real));
    for (int32_t s = task->first; s <= task->root; s++) {
      const real *panel = solve->value + symbolic->panel[s];
      int32_t pivots = bwi_pivots(symbolic, s), rows = symbolic->rows[s];
      real *x = solve->x + (int64_t)symbolic->first[order->super[s]] * width;
      lower_triangle(width, panel, rows, pivots, x);
      int32_t outer = bwi_outer_unknowns(symbolic, s, space->index);
      memset(space->y, 0, (size_t)outer * (size_t)width * sizeof(real));
      forward(width, panel + pivots, rows, outer, pivots, x, space->y);
      for (int32_t i = 0; i < outer; i++) {
        int32_t u = space->index[i];
        real *to =
            u < limit ? solve->x + (int64_t)u * width : collector + (int64_t)space->slot[u] * width;
        for (int w = 0; w < width; w++)
          to[w] += space->y[(int64_t)i * width + w];
      }
    }
  }
  return BW_OK;
}

static bw_status backward_tasks(void *data, int64_t begin, int64_t end, int worker) {
  solution *solve = data;
  const bwi_symbolic *symbolic = solve->symbolic;
  const bwi_order *order = symbolic->order;
  scratch *space = &solve->space[worker];
  int width = solve->width;
  for (int64_t t = begin; t < end; t++) {
    const bwi_task *task = &symbolic->plan.task[t];
    for (int32_t s = task->root; s >= task->first; s--) {
      const real *panel = solve->value + symbolic->panel[s];
      int32_t pivots = bwi_pivots(symbolic, s), rows = symbolic->rows[s];
      real *x = solve->x + (int64_t)symbolic->first[order->super[s]] * width;
      int32_t outer = bwi_outer_unknowns(symbolic, s, space->index);
      for (int32_t i = 0; i < outer; i++)
        memcpy(space->y + (int64_t)i * width, solve->x + (int64_t)space->index[i] * width,
               (size_t)width * sizeof(real));
      backward(width, panel + pivots, rows, outer, pivots, x, space->y);
      upper_triangle(width, panel, rows, pivots, x);
    }
  }
  return BW_OK;
}

/* Pivots below the columns at work. */
static bw_status top_inner_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  solution *solve = data;
  real *x = solve->x + (int64_t)solve->first * solve->width;
  int64_t row = solve->end + begin;
  forward(solve->width, solve->panel + solve->begin * solve->ld + row, solve->ld, end - begin,
          solve->end - solve->begin, x + solve->begin * solve->width, x + row * solve->width);
  return BW_OK;
}

/* Rows below the pivots, all columns. */
static bw_status top_outer_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  solution *solve = data;
  int width = solve->width;
  real *y = solve->space[0].y + begin * width;
  const int32_t *index = solve->space[0].index;
  memset(y, 0, (size_t)(end - begin) * (size_t)width * sizeof(real));
  forward(width, solve->panel + solve->pivots + begin, solve->ld, end - begin, solve->pivots,
          solve->x + (int64_t)solve->first * width, y);
  for (int64_t i = begin; i < end; i++)
    for (int w = 0; w < width; w++)
      solve->x[(int64_t)index[i] * width + w] += *y++;
  return BW_OK;
}

static bw_status top_outer_columns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  solution *solve = data;
  real *x = solve->x + ((int64_t)solve->first + begin) * solve->width;
  backward(solve->width, solve->panel + begin * solve->ld + solve->pivots, solve->ld,
           solve->ld - solve->pivots, end - begin, x, solve->space[0].y);
  return BW_OK;
}

static bw_status top_inner_columns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  solution *solve = data;
  real *x = solve->x + (int64_t)solve->first * solve->width;
  int64_t column = solve->begin + begin;
  backward(solve->width, solve->panel + column * solve->ld + solve->end, solve->ld,
           solve->pivots - solve->end, end - begin, x + column * solve->width,
           x + solve->end * solve->width);
  return BW_OK;
}

static int32_t open_top(solution *solve, int32_t s) {
  const bwi_symbolic *symbolic = solve->symbolic;
  solve->panel = solve->value + symbolic->panel[s];
  solve->ld = symbolic->rows[s];
  solve->pivots = bwi_pivots(symbolic, s);
  solve->first = symbolic->first[symbolic->order->super[s]];
  return bwi_outer_unknowns(symbolic, s, solve->space[0].index);
}

static bw_status forward_top(solution *solve, int32_t s) {
  bw_status status = BW_OK;
  int32_t outer = open_top(solve, s);
  for (solve->begin = 0; solve->begin < solve->pivots; solve->begin = solve->end) {
    solve->end = solve->pivots - solve->begin < PANEL ? solve->pivots : solve->begin + PANEL;
    lower_triangle(solve->width, solve->panel + solve->begin * (solve->ld + 1), solve->ld,
                   solve->end - solve->begin,
                   solve->x + (solve->first + solve->begin) * solve->width);
    BW_TRY(bw_parallel(solve->context, solve->pivots - solve->end, rows_at_once(solve->width),
                       top_inner_rows, solve));
  }
  BW_TRY(bw_parallel(solve->context, outer, rows_at_once(solve->width), top_outer_rows, solve));
done:
  return status;
}

static bw_status backward_top(solution *solve, int32_t s) {
  bw_status status = BW_OK;
  int32_t outer = open_top(solve, s);
  const scratch *space = &solve->space[0];
  for (int32_t i = 0; i < outer; i++)
    memcpy(space->y + (int64_t)i * solve->width, solve->x + (int64_t)space->index[i] * solve->width,
           (size_t)solve->width * sizeof(real));
  if (outer > 0)
    BW_TRY(bw_parallel(solve->context, solve->pivots, COLUMNS, top_outer_columns, solve));
  for (solve->begin = (solve->pivots - 1) / PANEL * PANEL; solve->begin >= 0;
       solve->begin -= PANEL) {
    solve->end = solve->pivots - solve->begin < PANEL ? solve->pivots : solve->begin + PANEL;
    if (solve->end < solve->pivots)
      BW_TRY(bw_parallel(solve->context, solve->end - solve->begin, COLUMNS, top_inner_columns,
                         solve));
    upper_triangle(solve->width, solve->panel + solve->begin * (solve->ld + 1), solve->ld,
                   solve->end - solve->begin,
                   solve->x + (solve->first + solve->begin) * solve->width);
  }
done:
  return status;
}

/* Collectors into x: in ascending order of roots, whatever the order of the tasks. */
static void collect(solution *solve) {
  const bwi_symbolic *symbolic = solve->symbolic;
  int width = solve->width;
  for (int32_t s = 0; s < symbolic->order->super_count; s++) {
    int32_t t = symbolic->plan.task_of[s];
    if (t < 0)
      continue;
    int32_t outer = bwi_outer_unknowns(symbolic, s, solve->space[0].index);
    const real *from = solve->collector[t];
    for (int32_t i = 0; i < outer; i++) {
      real *to = solve->x + (int64_t)solve->space[0].index[i] * width;
      for (int w = 0; w < width; w++)
        to[w] += *from++;
    }
  }
}

bw_status bwi_factor_solve(bw_context *context, const bwi_factor *factor, int width, void *x) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = factor->symbolic;
  int workers = bw_threads(context);
  solution solve = {
      .context = context, .symbolic = symbolic, .value = factor->value, .width = width, .x = x};
  if (factor->kernels->size != sizeof(real) || factor->cholmod)
    return bw_fail(context, BW_INTERNAL,
                   "a solve in another precision or by another backend than the factor's");
  if (factor->broken)
    return bw_fail(context, BW_INTERNAL,
                   "a solve with a factor whose last update failed: refactorise it");
  if (width != 1 && width != 2 && width != 4 && width != 8 && width != 16)
    return bw_fail(context, BW_INTERNAL, "a solve of %d right-hand sides at once", width);
  solve.collector = BW_NEW0(context, real *, symbolic->plan.task_count);
  solve.space = BW_NEW0(context, scratch, workers);
  BW_TRY_MEMORY(solve.collector && solve.space);
  for (int32_t t = 0; t < symbolic->plan.task_count; t++) {
    int32_t root = symbolic->plan.task[t].root;
    int64_t outer = symbolic->rows[root] - bwi_pivots(symbolic, root);
    solve.collector[t] = BW_NEW(context, real, outer * width);
    BW_TRY_MEMORY(solve.collector[t]);
  }
  for (int w = 0; w < workers; w++) {
    scratch *space = &solve.space[w];
    space->index = BW_NEW(context, int32_t, symbolic->max_rows);
    space->y = BW_NEW(context, real, symbolic->max_rows * width);
    space->slot = BW_NEW(context, int32_t, symbolic->unknowns);
    BW_TRY_MEMORY(space->index && space->y && space->slot);
  }
  BW_TRY(bw_parallel(context, symbolic->plan.task_count, 1, forward_tasks, &solve));
  collect(&solve);
  for (int32_t k = 0; k < symbolic->plan.top_count; k++)
    BW_TRY(forward_top(&solve, symbolic->plan.top[k]));
  for (int64_t i = 0; factor->minus && i < symbolic->unknowns; i++)
    for (int w = 0; w < width && factor->minus[i]; w++)
      solve.x[i * width + w] = -solve.x[i * width + w];
  for (int32_t k = symbolic->plan.top_count - 1; k >= 0; k--)
    BW_TRY(backward_top(&solve, symbolic->plan.top[k]));
  BW_TRY(bw_parallel(context, symbolic->plan.task_count, 1, backward_tasks, &solve));
done:
  for (int32_t t = 0; solve.collector && t < symbolic->plan.task_count; t++)
    bw_free(solve.collector[t]);
  for (int w = 0; solve.space && w < workers; w++) {
    bw_free(solve.space[w].index);
    bw_free(solve.space[w].y);
    bw_free(solve.space[w].slot);
  }
  bw_free(solve.collector);
  bw_free(solve.space);
  return status;
}
