/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Prolongations and Galerkin products of multigrid (amg.h), by rows. Each product is made in two
 * passes: columns of rows are counted, then listed and filled. */
#include <string.h>

#include "base/dense.h"
#include "linear/amg_setup.h"

enum { MODES = BWI_AMG_MODES };

typedef struct making {
  bwi_amg_setup *s;
  bwi_amg_blocks *out;
  bool fill;
} making;

/* The place of a column in the row in work. */
static int64_t place(int32_t *mark, int32_t column, int32_t *seen, int64_t *count) {
  if (!mark[column]) {
    seen[*count] = column;
    mark[column] = (int32_t)++ * count;
  }
  return mark[column] - 1;
}

enum { MOST_COLUMNS = 4096 };

static bw_status make_row(const making *m, int worker, int64_t k,
                          void (*row)(const making *, int64_t, int32_t *, int32_t *, int64_t *)) {
  int32_t seen[MOST_COLUMNS];
  int64_t count = 0;
  bwi_amg_setup *s = m->s;
  int32_t *mark = s->mark + (int64_t)worker * s->count;
  row(m, k, mark, seen, &count);
  if (count >= MOST_COLUMNS - 1)
    return bw_fail(s->context, BW_LIMIT, "a row of multigrid has more than %d blocks",
                   (int)MOST_COLUMNS);
  if (m->fill)
    memcpy(m->out->column + m->out->start[k], seen, (size_t)count * sizeof *seen);
  else
    m->out->start[k + 1] = count;
  for (int64_t c = 0; c < count; c++)
    mark[seen[c]] = 0;
  return BW_OK;
}

/* P = (1 - omega D^-1 A) T, omega = 4 / 3 over the largest eigenvalue. */
static void smooth_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  bwi_amg_setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + numbers * m->out->start[k] : NULL, sum[36], column[36];
  if (s->of[k] < 0)
    return;
  place(mark, s->of[k], seen, count);
  BWI_AMG_FOR_ROW(s, k, {
    if (s->of[j] >= 0 && *count < MOST_COLUMNS - 1) {
      int64_t at = place(mark, s->of[j], seen, count);
      if (out)
        bwi_amg_add_product(block, across, u, MODES, s->tentative + numbers * j,
                            out + numbers * at);
    }
  });
  double omega = 4.0 / 3 / v->largest * bwi_amg_unit(s);
  for (int64_t c = 0; out && c < *count; c++) {
    double *p = out + numbers * c;
    memcpy(column, p, (size_t)numbers * sizeof *p);
    memset(sum, 0, sizeof sum);
    bwi_amg_add_product(s->inverse + (int64_t)u * u * k, false, u, MODES, column, sum);
    for (int64_t i = 0; i < numbers; i++)
      p[i] = (c == 0 ? s->tentative[numbers * k + i] : 0) - omega * sum[i];
  }
}

static void multiply_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  bwi_amg_setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + numbers * m->out->start[k] : NULL;
  BWI_AMG_FOR_ROW(s, k, {
    for (int64_t e = v->p.start[j]; e < v->p.start[j + 1] && *count < MOST_COLUMNS - 1; e++) {
      int64_t at = place(mark, v->p.column[e], seen, count);
      if (out)
        bwi_amg_add_product(block, across, u, MODES, v->p.exact + numbers * e, out + numbers * at);
    }
  });
  for (int64_t i = 0; out && i < numbers * *count; i++)
    out[i] *= bwi_amg_unit(s);
}

/* P^T (A P) */
static void galerkin_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  bwi_amg_setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + 36 * m->out->start[k] : NULL;
  for (int64_t c = v->pt.start[k]; c < v->pt.start[k + 1]; c++) {
    const double *p = v->p.exact + numbers * s->child[c];
    int32_t i = v->pt.column[c];
    for (int64_t e = s->ap.start[i]; e < s->ap.start[i + 1] && *count < MOST_COLUMNS - 1; e++) {
      int64_t at = place(mark, s->ap.column[e], seen, count);
      if (out)
        bwi_multiply_add(MODES, u, MODES, p, s->ap.exact + numbers * e, out + 36 * at);
    }
  }
}

static bw_status smooth_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, smooth_row);
  return status;
}

static bw_status multiply_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, multiply_row);
  return status;
}

static bw_status galerkin_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, galerkin_row);
  return status;
}

static bw_status make(bwi_amg_setup *s, int32_t rows, int height, bw_body *body,
                      bwi_amg_blocks *out) {
  bw_status status = BW_OK;
  making m = {s, out, false};
  *out = (bwi_amg_blocks){.rows = rows, .columns = s->count, .height = height, .width = MODES};
  out->start = BW_NEW0(s->context, int64_t, rows + 1);
  if (!out->start)
    return BW_MEMORY;
  BW_TRY(bw_parallel(s->context, rows, BWI_AMG_ROWS, body, &m));
  for (int32_t k = 0; k < rows; k++)
    out->start[k + 1] += out->start[k];
  out->column = BW_NEW(s->context, int32_t, out->start[rows] + 1);
  out->exact = BW_NEW0(s->context, double, out->start[rows] * height * MODES + 1);
  BW_TRY_MEMORY(out->column && out->exact);
  m.fill = true;
  BW_TRY(bw_parallel(s->context, rows, BWI_AMG_ROWS, body, &m));
done:
  return status;
}

/* The pattern of P^T, and which block of P each of its blocks is. */
static bw_status transpose(bwi_amg_setup *s, bwi_amg_level *v) {
  int64_t count = v->p.start[v->rows];
  v->pt =
      (bwi_amg_blocks){.rows = s->count, .columns = v->rows, .height = MODES, .width = v->unknowns};
  v->pt.start = BW_NEW0(s->context, int64_t, s->count + 2);
  v->pt.column = BW_NEW(s->context, int32_t, count + 1);
  s->child = BW_NEW(s->context, int64_t, count + 1);
  if (!v->pt.start || !v->pt.column || !s->child)
    return BW_MEMORY;
  int64_t *next = v->pt.start + 1; /* runs to where the next column starts */
  for (int64_t e = 0; e < count; e++)
    if (v->p.column[e] + 1 < s->count)
      next[v->p.column[e] + 1]++;
  for (int32_t a = 1; a < s->count; a++)
    next[a] += next[a - 1];
  for (int32_t k = 0; k < v->rows; k++)
    for (int64_t e = v->p.start[k]; e < v->p.start[k + 1]; e++) {
      int64_t at = next[v->p.column[e]]++;
      s->child[at] = e;
      v->pt.column[at] = k;
    }
  return BW_OK;
}

static bw_status reserve_floats(bw_context *context, bwi_amg_blocks *b) {
  b->value = BW_NEW0(context, float, b->start[b->rows] * b->height * b->width + BWI_SMOOTHER_SPARE);
  return b->value ? BW_OK : BW_MEMORY;
}

/* The columns of a block of P are the rows of that of P^T. */
static bw_status transposed_floats(bwi_amg_setup *s, bwi_amg_level *v) {
  int64_t numbers = (int64_t)v->unknowns * MODES;
  bw_status status = reserve_floats(s->context, &v->pt);
  for (int64_t e = 0; status == BW_OK && e < v->pt.start[v->pt.rows]; e++)
    for (int64_t i = 0; i < numbers; i++)
      v->pt.value[numbers * e + i] = (float)v->p.exact[numbers * s->child[e] + i];
  return status;
}

bw_status bwi_amg_to_floats(bw_context *context, bwi_amg_blocks *b) {
  int h = b->height, w = b->width;
  bw_status status = reserve_floats(context, b);
  for (int64_t e = 0; status == BW_OK && e < b->start[b->rows]; e++)
    for (int i = 0; i < h; i++)
      for (int j = 0; j < w; j++)
        b->value[(e * w + j) * h + i] = (float)b->exact[(e * h + i) * w + j];
  bw_free(b->exact);
  b->exact = NULL;
  return status;
}

bw_status bwi_amg_make_next(bwi_amg_setup *s) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  s->mark = BW_NEW0(s->context, int32_t, (int64_t)s->workers * s->count);
  if (!s->mark)
    return BW_MEMORY;
  BW_TRY(make(s, v->rows, v->unknowns, smooth_rows, &v->p));
  BW_TRY(transpose(s, v));
  BW_TRY(make(s, v->rows, v->unknowns, multiply_rows, &s->ap));
  v[1].rows = s->count;
  v[1].unknowns = MODES;
  BW_TRY(make(s, s->count, MODES, galerkin_rows, &v[1].a));
  BW_TRY(transposed_floats(s, v));
  BW_TRY(bwi_amg_to_floats(s->context, &v->p));
done:
  return status;
}
