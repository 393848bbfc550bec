/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Constraints C x = d of the unknowns of joined bodies: as many of them, the pivots, are expressed
 * by the others. Gauss-Jordan elimination with the largest number as the next pivot. */
#include <math.h>
#include <string.h>

#include "joint/internal.h"

/* A row of which less than this part is left depends on the others. */
static const double dependent = 1e-9;

typedef struct elimination {
  bwi_reduction *r;
  int count, *pivot;   /* columns */
  int32_t *pivot_of;   /* unknown_count: the row whose pivot a column is, or -1 */
  int32_t *renumbered; /* unknown_count: columns that stay */
  double *rows, *d;    /* x_pivot = d - sum over the others of rows x */
} elimination;

static bw_status fail_dependent(bw_context *context, int component) {
  static const char *const name[] = {"displacement x", "displacement y", "displacement z",
                                     "rotation x",     "rotation y",     "rotation z"};
  bw_fail(context, BW_INVALID,
          "the %s that is prescribed for the remote point of coupling %d is over-constrained: "
          "supports or other couplings move its face already; leave it free, or hold less of the "
          "face",
          name[component % 6], component / 6 + 1);
  bw_detail_number(context, "coupling", component / 6 + 1.0);
  return BW_INVALID;
}

/* Rows are scaled to their largest number first. */
static bw_status gauss_jordan(bw_context *context, elimination *q, const int *component) {
  int64_t n = q->r->unknown_count;
  for (int i = 0; i < q->count; i++) {
    double *row = q->rows + i * n, largest = 0;
    for (int64_t j = 0; j < n; j++)
      largest = fmax(largest, fabs(row[j]));
    if (!(largest > 0))
      return fail_dependent(context, component[i]);
    for (int64_t j = 0; j < n; j++)
      row[j] /= largest;
    q->d[i] /= largest;
    q->pivot[i] = -1;
  }
  for (int step = 0; step < q->count; step++) {
    int best = -1;
    int64_t at = -1;
    double largest = dependent;
    for (int i = 0; i < q->count; i++)
      for (int64_t j = 0; q->pivot[i] < 0 && j < n; j++)
        if (fabs(q->rows[i * n + j]) > largest) {
          largest = fabs(q->rows[i * n + j]);
          best = i;
          at = j;
        }
    for (int i = 0; best < 0 && i < q->count; i++)
      if (q->pivot[i] < 0)
        return fail_dependent(context, component[i]);
    double *row = q->rows + best * n, scale = row[at];
    for (int64_t j = 0; j < n; j++)
      row[j] /= scale;
    q->d[best] /= scale;
    for (int i = 0; i < q->count; i++) {
      double *other = q->rows + i * n, factor = other[at];
      if (i == best || factor == 0)
        continue;
      for (int64_t j = 0; j < n; j++)
        other[j] -= factor * row[j];
      other[at] = 0;
      q->d[i] -= factor * q->d[best];
    }
    q->pivot[best] = (int)at;
  }
  return BW_OK;
}

/* What the multipliers need, before T and P change. */
static bw_status keep_pivots(bw_context *context, const elimination *q, const int *component,
                             const double *before) {
  bw_status status = BW_OK;
  bwi_reduction *r = q->r;
  bwi_eliminated *gone = &r->gone;
  int n = q->count;
  int32_t *row = NULL, *column = NULL;
  double *value = NULL;
  int64_t entries = 0;
  gone->component = BW_NEW(context, int, n);
  gone->square = BW_NEW(context, double, (int64_t)n *n);
  gone->point = BW_NEW0(context, double, 6 * (int64_t)n * r->point_count);
  BW_TRY_MEMORY(gone->component && gone->square && gone->point);
  for (int i = 0; i < n; i++)
    entries += r->transposed->start[q->pivot[i] + 1] - r->transposed->start[q->pivot[i]];
  row = BW_NEW(context, int32_t, entries);
  column = BW_NEW(context, int32_t, entries);
  value = BW_NEW(context, double, entries);
  BW_TRY_MEMORY(row && column && value);
  entries = 0;
  for (int i = 0; i < n; i++) {
    int32_t at = q->pivot[i];
    gone->component[i] = component[i];
    for (int j = 0; j < n; j++)
      gone->square[i * n + j] = before[(int64_t)j * r->unknown_count + at];
    for (int64_t e = r->transposed->start[at]; e < r->transposed->start[at + 1]; e++) {
      row[entries] = i;
      column[entries] = r->transposed->column[e];
      value[entries++] = r->transposed->value[e];
    }
  }
  for (int k = 0; k < 6 * r->point_count; k++)
    for (int64_t e = r->p->start[k]; e < r->p->start[k + 1]; e++)
      if (q->pivot_of[r->p->column[e]] >= 0)
        gone->point[q->pivot_of[r->p->column[e]] * 6 * r->point_count + k] = r->p->value[e];
  BW_TRY(bw_sparse_matrix_create(context, n, 3 * r->dof_map->mesh->node_count, entries, row, column,
                                 value, &gone->row));
  gone->count = n;
done:
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}

/* A matrix of the unknowns that stay, `constant` with what the pivots add; and transposed. */
static bw_status replace(bw_context *context, const elimination *q, bw_sparse_matrix **matrix,
                         double *constant, bw_sparse_matrix **transposed) {
  bw_status status = BW_OK;
  const bw_sparse_matrix *a = *matrix;
  int64_t n = q->r->unknown_count, count = 0;
  int32_t *row = NULL, *column = NULL;
  double *value = NULL;
  bw_sparse_matrix *made = NULL, *turned = NULL;
  for (int pass = 0; pass < 2; pass++) {
    count = 0;
    for (int32_t i = 0; i < a->rows; i++)
      for (int64_t e = a->start[i]; e < a->start[i + 1]; e++) {
        int32_t at = a->column[e], p = q->pivot_of[at];
        const double *by = p < 0 ? NULL : q->rows + p * n;
        for (int64_t j = p < 0 ? at : 0; j < (p < 0 ? at + 1 : n); j++) {
          double factor = p < 0 ? 1 : j == at ? 0 : -by[j];
          if (factor == 0)
            continue;
          if (pass == 1) {
            row[count] = i;
            column[count] = q->renumbered[j];
            value[count] = factor * a->value[e];
          }
          count++;
        }
        if (pass == 1 && p >= 0)
          constant[i] += a->value[e] * q->d[p];
      }
    if (pass == 0) {
      row = BW_NEW(context, int32_t, count);
      column = BW_NEW(context, int32_t, count);
      value = BW_NEW(context, double, count);
      BW_TRY_MEMORY(row && column && value);
    }
  }
  int32_t left = (int32_t)n - q->count;
  BW_TRY(bw_sparse_matrix_create(context, a->rows, left, count, row, column, value, &made));
  if (transposed) {
    BW_TRY(bw_sparse_matrix_create(context, left, a->rows, count, column, row, value, &turned));
    bw_release(*transposed);
    *transposed = turned;
  }
  bw_release(*matrix);
  *matrix = made;
  made = NULL;
done:
  bw_release(made);
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}

bw_status bwi_eliminate(bw_context *context, bwi_reduction *r, int count, const int *component,
                        double *rows, double *d) {
  bw_status status = BW_OK;
  int64_t n = r->unknown_count;
  elimination q = {.r = r, .count = count, .rows = rows, .d = d};
  double *before = BW_NEW(context, double, count *n);
  q.pivot = BW_NEW(context, int, count);
  q.pivot_of = BW_NEW(context, int32_t, n);
  q.renumbered = BW_NEW(context, int32_t, n);
  BW_TRY_MEMORY(before && q.pivot && q.pivot_of && q.renumbered);
  memcpy(before, rows, (size_t)(count * n) * sizeof *before);
  BW_TRY(gauss_jordan(context, &q, component));
  memset(q.pivot_of, 0xff, (size_t)n * sizeof *q.pivot_of);
  for (int i = 0; i < count; i++)
    q.pivot_of[q.pivot[i]] = i;
  int32_t left = 0;
  for (int64_t j = 0; j < n; j++)
    q.renumbered[j] = q.pivot_of[j] < 0 ? left++ : -1;
  BW_TRY(keep_pivots(context, &q, component, before));
  BW_TRY(replace(context, &q, &r->t, r->g, &r->transposed));
  BW_TRY(replace(context, &q, &r->p, r->h, NULL));
  r->unknown_count = left;
done:
  bw_free(before);
  bw_free(q.pivot);
  bw_free(q.pivot_of);
  bw_free(q.renumbered);
  return status;
}
