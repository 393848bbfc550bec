/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elimination within one front: the dense part of the factorisation.
 *
 * The panel holds the pivot columns [A11; A21], the update matrix A22. On return
 * A11 = L11 S L11^T, L21 = A21 L11^-T S, A22 - L21 S L21^T, with S = diag(+-1): the Cholesky
 * factorisation where S = I. Keeping signs instead of a diagonal D lets Cholesky kernels do the
 * work: a panel whose pivots are all positive (with a shift just above the lowest eigenvalues,
 * nearly every one) costs what Cholesky costs, and the few negative columns are put right by a
 * product of their own.
 *
 * Two levels of blocking, both left-looking: blocks of TILE columns take all columns before them at
 * once, in products large enough for the BLAS to run at full speed; within a block, panels of WIDTH
 * columns take the columns of the block before them. Rows, and the update matrix, are cut into
 * tiles whose borders depend on the sizes only; strips of rows are fine enough that a front of a
 * thousand rows occupies several threads. Where many columns lie before a block the strips are
 * taller, since the BLAS copies the rows of the block for each strip. No pivoting: the caller
 * checks `weak`. */
#ifdef __FMA__
#include <immintrin.h>
#endif
#include <math.h>
#include <string.h>

#include "linear/blas.h"
#include "linear/internal.h"

enum { WIDTH = 128, STRIP = 256, TALL = 1024, STRIPS = 4, TILE = BWI_TILE };

/* A pivot below this fraction of its diagonal entry's size has no digits left. */
static const double weak_fraction = sizeof(real) == sizeof(double) ? 1e-13 : 1e-7;

static const real one = 1, minus_one = -1, two = 2;

typedef struct elimination {
  bwi_front *front;
  real *minus; /* rows x minus_count: the columns of L with a negative sign */
  int minus_count, minus_capacity;
  int block, block_end; /* the block of columns at work */
  int block_minus;      /* columns in `minus` when it began */
  int begin, end;       /* the panel at work */
  uint8_t negative[WIDTH];
  int negative_here;
} elimination;

/* Signed Cholesky of an n x n block with leading dimension ld, column by column. Returns the first
 * column whose pivot is zero, or -1. */
static int signed_block(int n, real *a, int ld, uint8_t *negative) {
  for (int j = 0; j < n; j++) {
    real *column = a + (size_t)j * (size_t)ld, d = column[j];
    if (d == 0 || !isfinite(d))
      return j;
    negative[j] = d < 0;
    real root = (real)sqrt(fabs((double)d)), factor = 1 / (d < 0 ? -root : root);
    column[j] = root;
    for (int i = j + 1; i < n; i++)
      column[i] *= factor;
    real sign = d < 0 ? -1 : 1;
    for (int k = j + 1; k < n; k++) {
      real *target = a + (size_t)k * (size_t)ld, weight = sign * column[k];
      for (int i = k; i < n; i++)
        target[i] -= column[i] * weight;
    }
  }
  return -1;
}

static real *entry(const bwi_front *front, int row, int column) {
  return (real *)front->panel + (size_t)front->rows * (size_t)column + row;
}

/* Remember the columns of this panel whose sign is negative (rows begin.. of the front). */
static bw_status keep_minus(bw_context *context, elimination *work) {
  bwi_front *front = work->front;
  if (work->negative_here == 0)
    return BW_OK;
  size_t rows = (size_t)front->rows;
  int wanted = work->minus_count + work->negative_here;
  if (wanted > work->minus_capacity) {
    int capacity = wanted > 2 * work->minus_capacity ? wanted : 2 * work->minus_capacity;
    real *larger = bw_resize(context, work->minus, rows * (size_t)capacity, sizeof(real));
    if (!larger)
      return BW_MEMORY;
    work->minus = larger;
    work->minus_capacity = capacity;
  }
  for (int j = work->begin; j < work->end; j++)
    if (work->negative[j - work->begin])
      memcpy(work->minus + rows * (size_t)work->minus_count++, entry(front, 0, j),
             rows * sizeof(real));
  return BW_OK;
}

static real *minus_row(const elimination *work, int row, int column) {
  return work->minus + (size_t)work->front->rows * (size_t)column + row;
}

/* ---- rows divided by a triangle -------------------------------------------------------------- */

/* A strip of three vectors of rows and ACROSS columns is kept in registers. */
#if defined __AVX512F__ && defined __FMA__
enum { LANES = 64 / sizeof(real), ACROSS = 8 };
#define subtract_product FUSED_512
#elif defined __FMA__
enum { LANES = 32 / sizeof(real), ACROSS = 4 };
#define subtract_product FUSED_256
#else
enum { LANES = 16 / sizeof(real), ACROSS = 4 };
#define subtract_product(a, b, c) ((c) - (a) * (b))
#endif
enum { VECTORS = 3, DOWN = VECTORS * LANES };
typedef real lanes __attribute__((vector_size(LANES * sizeof(real)), aligned(sizeof(real))));

static inline lanes *lanes_at(real *x, size_t ldx, int column, int vector) {
  return (lanes *)(x + (size_t)column * ldx + (size_t)(vector * LANES));
}

/* Columns j to j + W - 1 of DOWN rows: x = (x - what columns before j contribute) / l. */
static inline __attribute__((always_inline)) void divide_columns(const int W, int j, const real *l,
                                                                 size_t ld, const real *inverse,
                                                                 real *x, size_t ldx) {
  lanes sum[ACROSS][VECTORS];
  for (int q = 0; q < W; q++)
    for (int v = 0; v < VECTORS; v++)
      sum[q][v] = *lanes_at(x, ldx, j + q, v);
  for (int k = 0; k < j; k++)
    for (int q = 0; q < W; q++) {
      lanes weight = l[(size_t)k * ld + (size_t)(j + q)] - (lanes){0};
      for (int v = 0; v < VECTORS; v++)
        sum[q][v] = subtract_product(*lanes_at(x, ldx, k, v), weight, sum[q][v]);
    }
#pragma GCC unroll 8
  for (int q = 0; q < W; q++) {
#pragma GCC unroll 8
    for (int k = 0; k < q; k++) {
      lanes weight = l[(size_t)(j + k) * ld + (size_t)(j + q)] - (lanes){0};
      for (int v = 0; v < VECTORS; v++)
        sum[q][v] = subtract_product(sum[k][v], weight, sum[q][v]);
    }
    for (int v = 0; v < VECTORS; v++)
      *lanes_at(x, ldx, j + q, v) = sum[q][v] *= inverse[j + q];
  }
}

static void divide_strip(int width, const real *l, size_t ld, const real *inverse, real *x,
                         size_t ldx) {
  int j = 0;
  for (; j + ACROSS <= width; j += ACROSS)
    divide_columns(ACROSS, j, l, ld, inverse, x, ldx);
  for (; j < width; j++)
    divide_columns(1, j, l, ld, inverse, x, ldx);
}

/* x = x l^-T for many rows and the lower triangle l of up to WIDTH columns. TRSM of the BLAS takes
 * up to twice as long where both are in cache. */
static void divide_rows(int rows, int width, const real *l, int ld, real *x) {
  real inverse[WIDTH], last[WIDTH * DOWN];
  size_t step = (size_t)ld;
  for (int j = 0; j < width; j++)
    inverse[j] = 1 / l[(size_t)j * (step + 1)];
  int row = 0;
  for (; row + DOWN <= rows; row += DOWN)
    divide_strip(width, l, step, inverse, x + row, step);
  size_t left = (size_t)(rows - row) * sizeof(real);
  if (left == 0)
    return;
  memset(last, 0, (size_t)width * DOWN * sizeof(real));
  for (int j = 0; j < width; j++)
    memcpy(last + j * DOWN, x + row + (size_t)j * step, left);
  divide_strip(width, l, step, inverse, last, DOWN);
  for (int j = 0; j < width; j++)
    memcpy(x + row + (size_t)j * step, last + j * DOWN, left);
}

/* ---- elimination ----------------------------------------------------------------------------- */

/* Rows of the block at work: subtract what all columns before the block contribute. */
static bw_status block_rows(void *data, int64_t low, int64_t high, int worker) {
  (void)worker;
  elimination *work = data;
  bwi_front *front = work->front;
  int block = work->block, width = work->block_end - block, ld = front->rows;
  int first = block + (int)low, rows = (int)(high - low);
  real *target = entry(front, first, block);
  GEMM("N", "T", &rows, &width, &block, &minus_one, entry(front, first, 0), &ld,
       entry(front, block, 0), &ld, &one, target, &ld);
  if (work->minus_count > 0)
    GEMM("N", "T", &rows, &width, &work->minus_count, &two, minus_row(work, first, 0), &ld,
         minus_row(work, block, 0), &ld, &one, target, &ld);
  return BW_OK;
}

/* The diagonal block of the panel: update it and factor it. */
static bw_status diagonal_block(bw_context *context, elimination *work) {
  bwi_front *front = work->front;
  int begin = work->begin, width = work->end - begin, info = 0, ld = front->rows;
  real *block = entry(front, begin, begin);
  memset(work->negative, 0, sizeof work->negative);
  work->negative_here = 0;
  int done = begin - work->block, minus = work->minus_count - work->block_minus;
  if (done > 0)
    SYRK("L", "N", &width, &done, &minus_one, entry(front, begin, work->block), &ld, &one, block,
         &ld);
  if (minus > 0)
    SYRK("L", "N", &width, &minus, &two, minus_row(work, begin, work->block_minus), &ld, &one,
         block, &ld);
  if (front->signs) {
    real *copy = BW_NEW(context, real, (size_t)width * (size_t)width);
    if (!copy)
      return BW_MEMORY;
    for (int j = 0; j < width; j++)
      memcpy(copy + (size_t)j * (size_t)width, entry(front, begin, begin + j),
             (size_t)width * sizeof(real));
    POTRF("L", &width, block, &ld, &info);
    if (info != 0) {
      for (int j = 0; j < width; j++)
        memcpy(entry(front, begin, begin + j), copy + (size_t)j * (size_t)width,
               (size_t)width * sizeof(real));
      info = 1 + signed_block(width, block, ld, work->negative);
    }
    bw_free(copy);
    for (int j = 0; j < width; j++)
      work->negative_here += work->negative[j];
    if (front->minus)
      memcpy(front->minus + begin, work->negative, (size_t)width);
    front->negative += work->negative_here;
  } else
    POTRF("L", &width, block, &ld, &info);
  if (info != 0) {
    front->failed = begin + info - 1;
    return BW_SINGULAR;
  }
  for (int j = 0; j < width && front->weak < 0; j++) {
    double l = *entry(front, begin + j, begin + j);
    if (!(l * l > weak_fraction * front->scale[begin + j]))
      front->weak = begin + j;
  }
  return BW_OK;
}

/* Rows below the diagonal block: updated, then divided by it. */
static bw_status panel_rows(void *data, int64_t low, int64_t high, int worker) {
  (void)worker;
  elimination *work = data;
  bwi_front *front = work->front;
  int begin = work->begin, width = work->end - begin, ld = front->rows;
  int first = work->end + (int)low, rows = (int)(high - low);
  real *target = entry(front, first, begin);
  int done = begin - work->block, minus = work->minus_count - work->block_minus;
  if (done > 0)
    GEMM("N", "T", &rows, &width, &done, &minus_one, entry(front, first, work->block), &ld,
         entry(front, begin, work->block), &ld, &one, target, &ld);
  if (minus > 0)
    GEMM("N", "T", &rows, &width, &minus, &two, minus_row(work, first, work->block_minus), &ld,
         minus_row(work, begin, work->block_minus), &ld, &one, target, &ld);
  divide_rows(rows, width, entry(front, begin, begin), ld, target);
  for (int j = 0; j < width; j++)
    if (work->negative[j]) {
      real *column = entry(front, first, begin + j);
      for (int i = 0; i < rows; i++)
        column[i] = -column[i];
    }
  return BW_OK;
}

/* Tile number t of the lower triangle, row by row. */
static void tile_of(int64_t t, int *row, int *column) {
  int64_t i = (int64_t)((sqrt(8.0 * (double)t + 1) - 1) / 2);
  while (i * (i + 1) / 2 > t)
    i--;
  while ((i + 1) * (i + 2) / 2 <= t)
    i++;
  *row = (int)i;
  *column = (int)(t - i * (i + 1) / 2);
}

static bw_status update_tile(void *data, int64_t low, int64_t high, int worker) {
  (void)worker;
  elimination *work = data;
  bwi_front *front = work->front;
  int outer = front->rows - front->pivots, ld = front->rows, pivots = front->pivots;
  for (int64_t t = low; t < high; t++) {
    int i, j;
    tile_of(t, &i, &j);
    int row = i * TILE, column = j * TILE;
    int rows = outer - row < TILE ? outer - row : TILE;
    int columns = outer - column < TILE ? outer - column : TILE;
    real *target = (real *)front->update + bwi_update_column(outer, column) + row;
    int down = outer - column; /* leading dimension of this block column */
    const real *left = entry(front, pivots + row, 0), *right = entry(front, pivots + column, 0);
    const real *minus_left = work->minus ? work->minus + pivots + row : NULL;
    const real *minus_right = work->minus ? work->minus + pivots + column : NULL;
    if (i == j) {
      SYRK("L", "N", &rows, &pivots, &minus_one, left, &ld, &one, target, &down);
      if (work->minus_count > 0)
        SYRK("L", "N", &rows, &work->minus_count, &two, minus_left, &ld, &one, target, &down);
    } else {
      GEMM("N", "T", &rows, &columns, &pivots, &minus_one, left, &ld, right, &ld, &one, target,
           &down);
      if (work->minus_count > 0)
        GEMM("N", "T", &rows, &columns, &work->minus_count, &two, minus_left, &ld, minus_right, &ld,
             &one, target, &down);
    }
  }
  return BW_OK;
}

bw_status bwi_front_eliminate(bw_context *context, bwi_front *front) {
  bw_status status = BW_OK;
  elimination work = {.front = front};
  front->negative = 0;
  front->failed = front->weak = -1;
  for (int block = 0; block < front->pivots; block += TILE) {
    work.block = block;
    work.block_end = front->pivots - block < TILE ? front->pivots : block + TILE;
    work.block_minus = work.minus_count;
    if (block > 0) {
      int64_t rows = front->rows - block, strip = (rows + STRIPS - 1) / STRIPS;
      strip = strip < STRIP ? STRIP : strip < TALL ? strip : TALL;
      BW_TRY(bw_parallel(context, rows, strip, block_rows, &work));
    }
    for (int begin = block; begin < work.block_end; begin += WIDTH) {
      work.begin = begin;
      work.end = work.block_end - begin < WIDTH ? work.block_end : begin + WIDTH;
      BW_TRY(diagonal_block(context, &work));
      BW_TRY(bw_parallel(context, front->rows - work.end, STRIP, panel_rows, &work));
      BW_TRY(keep_minus(context, &work));
    }
  }
  int64_t outer = front->rows - front->pivots, tiles = (outer + TILE - 1) / TILE;
  if (front->pivots > 0)
    BW_TRY(bw_parallel(context, tiles * (tiles + 1) / 2, 1, update_tile, &work));
done:
  bw_free(work.minus);
  return status;
}
