/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* CHOLMOD as a backend of bwi_factor. Its 64-bit interface is used: L of a large body has more
 * numbers than 32 bits can count.
 *
 * Invariant: `factor` is supernodal. Its numbers are those of the matrix given last, unless that
 * call failed; bwi_factor knows. The BLAS runs on the threads of the context here, which is what
 * CHOLMOD's speed rests on: the last bits of L depend on their number. */
#include "linear/cholmod.h"

#include <math.h>
#include <string.h>

#include <cholmod.h>

#include "barwright/job.h"
#include "linear/blas.h"
#include "linear/order.h"

/* A pivot below this fraction of its diagonal entry has no digits left (as in front.c). */
#define WEAK_FRACTION 1e-13

struct bwi_cholmod {
  cholmod_common common;
  cholmod_sparse *matrix; /* lower triangle by unknowns; or NULL */
  cholmod_factor *factor;
  cholmod_dense *x, *y, *e; /* solution and workspace of cholmod_solve2; or NULL */
  double flops;
};

void bwi_cholmod_destroy(bwi_cholmod *cholmod) {
  if (!cholmod)
    return;
  cholmod_l_free_dense(&cholmod->x, &cholmod->common);
  cholmod_l_free_dense(&cholmod->y, &cholmod->common);
  cholmod_l_free_dense(&cholmod->e, &cholmod->common);
  cholmod_l_free_factor(&cholmod->factor, &cholmod->common);
  cholmod_l_free_sparse(&cholmod->matrix, &cholmod->common);
  cholmod_l_finish(&cholmod->common);
  bw_free(cholmod);
}

size_t bwi_cholmod_bytes(const bwi_cholmod *cholmod) {
  const cholmod_sparse *kept = cholmod->matrix;
  size_t matrix = kept ? kept->nzmax * (sizeof(double) + sizeof(SuiteSparse_long)) +
                             (kept->ncol + 1) * sizeof(SuiteSparse_long)
                       : 0;
  return cholmod->factor->xsize * sizeof(double) + matrix;
}

size_t bwi_cholmod_entries(const bwi_cholmod *cholmod) {
  return cholmod->factor->xsize;
}

double bwi_cholmod_flops(const bwi_cholmod *cholmod) {
  return cholmod->flops;
}

/* CHOLMOD's status in words. */
static bw_status fail(bw_context *context, const bwi_cholmod *cholmod, const char *what,
                      int32_t unknowns) {
  int code = cholmod->common.status;
  if (code == CHOLMOD_TOO_LARGE)
    return bw_fail(context, BW_LIMIT, "CHOLMOD: the %s of %d unknowns is too large", what,
                   unknowns);
  if (code == CHOLMOD_OUT_OF_MEMORY)
    return bw_fail(context, BW_MEMORY, "CHOLMOD: no memory for the %s of %d unknowns", what,
                   unknowns);
  return bw_fail(context, BW_INTERNAL, "CHOLMOD failed in the %s of %d unknowns (status %d)", what,
                 unknowns, code);
}

/* ---- the matrix ------------------------------------------------------------------------------ */

typedef struct filling {
  const bwi_symbolic *symbolic;
  const bwi_matrix *matrix;
  SuiteSparse_long *start, *row; /* row NULL: columns are only counted, in start[column + 1] */
  double *value;                 /* NULL: rows alone */
} filling;

/* The block column of the node at position p. Rows of a column are in no order. */
static void fill_node(const filling *fill, int32_t p) {
  const bwi_symbolic *symbolic = fill->symbolic;
  const bwi_order *order = symbolic->order;
  const bw_block_pattern *pattern = fill->matrix->pattern;
  int components = symbolic->components;
  int32_t node = order->node_at[p];
  const int32_t *at = symbolic->at + (int64_t)node * components;
  SuiteSparse_long cursor[3] = {0, 0, 0};
  for (int j = 0; fill->row && j < components; j++)
    cursor[j] = at[j] < 0 ? 0 : fill->start[at[j]];
  for (int half = 0; half < 2; half++) {
    const int64_t *from = half ? pattern->upper_start : pattern->start;
    for (int64_t k = from[node]; k < from[node + 1]; k++) {
      int32_t other = half ? pattern->upper_row[k] : pattern->column[k];
      const int32_t *rows = symbolic->at + (int64_t)other * components;
      double block[9];
      if (order->position[other] < p)
        continue;
      if (fill->value)
        bwi_matrix_block(fill->matrix, components, half ? bw_upper_block(pattern, k) : k, !half,
                         other, node, block);
      for (int j = 0; j < components; j++)
        for (int i = 0; at[j] >= 0 && i < components; i++) {
          if (rows[i] < at[j])
            continue;
          if (fill->row) {
            fill->row[cursor[j]] = rows[i];
            if (fill->value)
              fill->value[cursor[j]] = block[components * i + j];
          }
          cursor[j]++;
        }
    }
  }
  for (int j = 0; !fill->row && j < components; j++)
    if (at[j] >= 0)
      fill->start[at[j] + 1] = cursor[j];
}

static bw_status fill_nodes(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  for (int64_t p = begin; p < end; p++)
    fill_node(data, (int32_t)p);
  return BW_OK;
}

enum { GRAIN = 512 };

/* The lower triangle by unknowns, made on the first call; its numbers where asked for. */
static bw_status fill_matrix(bw_context *context, bwi_cholmod *cholmod,
                             const bwi_symbolic *symbolic, const bwi_matrix *matrix, bool numbers) {
  bw_status status = BW_OK;
  size_t size = (size_t)symbolic->unknowns;
  int64_t nodes = symbolic->order->size;
  filling fill = {.symbolic = symbolic, .matrix = matrix};
  if (!cholmod->matrix) {
    SuiteSparse_long *start = BW_NEW0(context, SuiteSparse_long, size + 1);
    if (!start)
      return BW_MEMORY;
    fill.start = start;
    status = bw_parallel(context, nodes, GRAIN, fill_nodes, &fill);
    for (size_t i = 0; i < size; i++)
      start[i + 1] += start[i];
    if (status == BW_OK)
      cholmod->matrix = cholmod_l_allocate_sparse(size, size, (size_t)start[size], 0, 1, -1,
                                                  CHOLMOD_REAL, &cholmod->common);
    if (cholmod->matrix)
      memcpy(cholmod->matrix->p, start, (size + 1) * sizeof *start);
    bw_free(start);
    if (status != BW_OK)
      return status;
    if (!cholmod->matrix)
      return fail(context, cholmod, "matrix", symbolic->unknowns);
  }
  fill.start = cholmod->matrix->p;
  fill.row = cholmod->matrix->i;
  fill.value = numbers ? cholmod->matrix->x : NULL;
  return bw_parallel(context, nodes, GRAIN, fill_nodes, &fill);
}

/* ---- analysis -------------------------------------------------------------------------------- */

/* The first touch of memory that is not there would end the process. */
static bw_status check_memory(bw_context *context, const bwi_cholmod *cholmod, int32_t unknowns,
                              double memory) {
  double bytes = (double)bwi_cholmod_bytes(cholmod) +
                 sizeof(double) * (double)cholmod->factor->maxcsize,
         available = memory > 0 ? memory : bw_available_memory();
  if (bytes <= available)
    return BW_OK;
  bw_fail(context, BW_MEMORY,
          "CHOLMOD's factor of %d unknowns takes %.3g GB of memory, more than the %.3g GB "
          "available. Use fewer elements, or a machine with more memory",
          unknowns, bytes / 1e9, available / 1e9);
  bw_detail_number(context, "bytes", bytes);
  bw_detail_number(context, "free_bytes", available);
  return BW_MEMORY;
}

bw_status bwi_cholmod_create(bw_context *context, const bwi_symbolic *symbolic,
                             const bwi_matrix *matrix, bwi_cholmod **out) {
  bw_status status = BW_OK;
  bool own = symbolic->order->ordering == BW_ORDERING_BACKEND;
  bwi_cholmod *cholmod = BW_NEW0(context, bwi_cholmod, 1);
  if (!cholmod)
    return BW_MEMORY;
  cholmod_common *common = &cholmod->common;
  cholmod_l_start(common);
  common->print = 0;
  common->useGPU = 0;
  common->postorder = 1;
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->nmethods = own ? 2 : 1;
  common->method[0].ordering = own ? CHOLMOD_AMD : CHOLMOD_NATURAL;
  common->method[1].ordering = CHOLMOD_METIS;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(fill_matrix(context, cholmod, symbolic, matrix, false));
  bwi_metis_lock(); /* CHOLMOD calls METIS */
  cholmod->factor = cholmod_l_analyze(cholmod->matrix, common);
  bwi_metis_unlock();
  if (!cholmod->factor) {
    status = fail(context, cholmod, "analysis", symbolic->unknowns);
    goto done;
  }
  if (!cholmod->factor->is_super) {
    status = bw_fail(context, BW_INTERNAL, "CHOLMOD's analysis of %d unknowns is not supernodal",
                     symbolic->unknowns);
    goto done;
  }
  cholmod->flops = common->fl;
  BW_TRY(check_memory(context, cholmod, symbolic->unknowns, matrix->memory));
done:
  if (status == BW_OK)
    *out = cholmod;
  else
    bwi_cholmod_destroy(cholmod);
  return status;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* The first unknown, in elimination order, whose pivot has lost nearly all its digits; -1: none. */
static int32_t weak_unknown(const bwi_cholmod *cholmod) {
  const cholmod_factor *l = cholmod->factor;
  const SuiteSparse_long *super = l->super, *row_start = l->pi, *panel = l->px, *perm = l->Perm;
  const SuiteSparse_long *start = cholmod->matrix->p, *row = cholmod->matrix->i;
  const double *value = cholmod->matrix->x, *x = l->x;
  for (size_t s = 0; s < l->nsuper; s++) {
    SuiteSparse_long rows = row_start[s + 1] - row_start[s];
    for (SuiteSparse_long k = super[s]; k < super[s + 1]; k++) {
      SuiteSparse_long column = perm[k], entry = start[column];
      while (row[entry] != column)
        entry++;
      double pivot = x[panel[s] + (k - super[s]) * (rows + 1)];
      if (!(pivot * pivot > WEAK_FRACTION * fabs(value[entry])))
        return (int32_t)column;
    }
  }
  return -1;
}

bw_status bwi_cholmod_factorise(bw_context *context, bwi_cholmod *cholmod,
                                const bwi_symbolic *symbolic, const bwi_matrix *matrix, bool keep,
                                int32_t *bad) {
  bw_status status = BW_OK;
  cholmod_common *common = &cholmod->common;
  int threads = bw_threads(context);
  *bad = -1;
  bwi_blas_enter();
  BW_TRY(bwi_blas_check_memory(context, threads));
  BW_TRY(bw_check_cancel(context));
  BW_TRY(fill_matrix(context, cholmod, symbolic, matrix, true));
  bwi_blas_widen(threads);
  cholmod_l_factorize(cholmod->matrix, cholmod->factor, common);
  BW_TRY(bw_check_cancel(context));
  if (common->status < CHOLMOD_OK) {
    status = fail(context, cholmod, "factorisation", symbolic->unknowns);
    goto done;
  }
  if (common->status == CHOLMOD_NOT_POSDEF)
    *bad = (int32_t)((const SuiteSparse_long *)cholmod->factor->Perm)[cholmod->factor->minor];
  else
    *bad = weak_unknown(cholmod);
  if (*bad >= 0)
    status = BW_SINGULAR;
done:
  bwi_blas_leave();
  if (!keep)
    cholmod_l_free_sparse(&cholmod->matrix, common);
  return status;
}

/* ---- solution -------------------------------------------------------------------------------- */

/* As bwi_factor_solve. One call at a time for each factor. */
static bw_status solve(bw_context *context, const bwi_factor *factor, int width, void *data) {
  bw_status status = BW_OK;
  bwi_cholmod *cholmod = factor->cholmod;
  size_t size = (size_t)factor->symbolic->unknowns, count = (size_t)width;
  double *x = data, *b = NULL;
  if (factor->broken)
    return bw_fail(context, BW_INTERNAL, "the last update of this factor failed: refactorise it");
  b = BW_NEW(context, double, size *count);
  if (!b)
    return BW_MEMORY;
  for (size_t i = 0; i < size; i++)
    for (size_t k = 0; k < count; k++)
      b[k * size + i] = x[i * count + k];
  cholmod_dense side = {.nrow = size,
                        .ncol = count,
                        .nzmax = size * count,
                        .d = size,
                        .x = b,
                        .xtype = CHOLMOD_REAL,
                        .dtype = CHOLMOD_DOUBLE};
  bwi_blas_enter();
  bool solved = cholmod_l_solve2(CHOLMOD_A, cholmod->factor, &side, NULL, &cholmod->x, NULL,
                                 &cholmod->y, &cholmod->e, &cholmod->common);
  bwi_blas_leave();
  if (!solved) {
    status = fail(context, cholmod, "solution", factor->symbolic->unknowns);
    goto done;
  }
  const double *u = cholmod->x->x;
  for (size_t i = 0; i < size; i++)
    for (size_t k = 0; k < count; k++)
      x[i * count + k] = u[k * size + i];
done:
  bw_free(b);
  return status;
}

/* The dense kernels are of no use to it, and NULL. */
const bwi_kernels bwi_kernels_cholmod = {.backend = "cholmod",
                                         .bits = 64,
                                         .size = sizeof(double),
                                         .solve = solve,
                                         .solve_fields = bwi_solve_fields_of};
