/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a front is assembled from: the matrix entries of its pivots, and the update matrices of its
 * children. */
#include <math.h>

#include "linear/internal.h"

/* ---- entries ------------------------------------------------------------------------------- */

/* Add the entries of block `block` to the panel: rows of mesh node `row`, columns of `column`. */
static void add_block(const bwi_symbolic *symbolic, const bwi_matrix *matrix, int64_t index,
                      bool transpose, int32_t row, int32_t column, int32_t row_offset,
                      int32_t column_offset, double unit, real *panel, int32_t ld, double *scale) {
  int components = symbolic->components;
  double block[9];
  bwi_matrix_block(matrix, components, index, transpose, row, column, block);
  double mass = matrix->mass ? fabs(matrix->shift * matrix->mass[index]) : 0;
  const int32_t *at = symbolic->at;
  for (int j = 0, b = 0; j < components; j++) {
    if (at[(int64_t)column * components + j] < 0)
      continue;
    real *target = panel + (int64_t)(column_offset + b) * ld + row_offset;
    for (int i = 0, a = 0; i < components; i++)
      if (at[(int64_t)row * components + i] >= 0) {
        target[a] += (real)(unit * block[components * i + j]);
        if (row == column && i == j)
          scale[column_offset + b] = unit * (fabs(block[components * i + j]) + 2 * mass);
        a++;
      }
    b++;
  }
}

void bwi_matrix_to_panel(const bwi_symbolic *symbolic, const bwi_matrix *matrix, double unit,
                         int32_t s, const int32_t *local, void *panel, double *scale) {
  const bwi_order *order = symbolic->order;
  const bw_block_pattern *pattern = matrix->pattern;
  int32_t ld = symbolic->rows[s];
  for (int32_t p = order->super[s]; p < order->super[s + 1]; p++) {
    int32_t node = order->node_at[p];
    for (int64_t k = pattern->start[node]; k < pattern->start[node + 1]; k++) {
      int32_t other = pattern->column[k];
      if (order->position[other] >= p)
        add_block(symbolic, matrix, k, true, other, node, local[order->position[other]], local[p],
                  unit, panel, ld, scale);
    }
    for (int64_t k = pattern->upper_start[node]; k < pattern->upper_start[node + 1]; k++) {
      int32_t other = pattern->upper_row[k];
      if (order->position[other] >= p)
        add_block(symbolic, matrix, bw_upper_block(pattern, k), false, other, node,
                  local[order->position[other]], local[p], unit, panel, ld, scale);
    }
  }
}

/* ---- extend-add ---------------------------------------------------------------------------- */

/* A child's update matrix goes into its parent's front by runs of rows that are next to each other
 * in both, since most are. */
typedef struct addition {
  const real *from;
  int32_t size; /* of the child's update matrix */
  const bwi_run *runs;
  int32_t run_count;
  real *panel, *update;
  int32_t rows, pivots; /* of the parent */
} addition;

static bw_status add_columns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const addition *add = data;
  int64_t outer = add->rows - add->pivots;
  int32_t r = 0;
  for (int64_t j = begin; j < end; j++) {
    while (add->runs[r].from + add->runs[r].length <= j)
      r++;
    int64_t column = add->runs[r].to + (j - add->runs[r].from);
    real *target = column < add->pivots
                       ? add->panel + column * add->rows
                       : add->update + bwi_update_column(outer, column - add->pivots) - add->pivots;
    const real *source = add->from + bwi_update_column(add->size, j);
    int64_t from = j, to = column, length = add->runs[r].length - (j - add->runs[r].from);
    for (int32_t q = r;;) {
      real *restrict a = target + to;
      const real *restrict b = source + from;
      for (int64_t i = 0; i < length; i++)
        a[i] += b[i];
      if (++q == add->run_count)
        break;
      from = add->runs[q].from;
      to = add->runs[q].to;
      length = add->runs[q].length;
    }
  }
  return BW_OK;
}

bw_status bwi_add_child(bw_context *context, const bwi_symbolic *symbolic, int32_t s, int32_t child,
                        const void *of_child, const int32_t *local, bwi_run *runs, void *panel,
                        void *update) {
  const bwi_order *order = symbolic->order;
  int32_t from = 0, count = 0;
  int64_t begin = order->row_start[child] + order->super[child + 1] - order->super[child];
  for (int64_t k = begin; k < order->row_start[child + 1]; k++) {
    int32_t p = order->row[k], length = symbolic->first[p + 1] - symbolic->first[p];
    if (length == 0)
      continue;
    int32_t to = local[p];
    if (count > 0 && runs[count - 1].to + runs[count - 1].length == to)
      runs[count - 1].length += length;
    else
      runs[count++] = (bwi_run){from, to, length};
    from += length;
  }
  if (from == 0)
    return BW_OK;
  addition add = {.from = of_child,
                  .size = from,
                  .runs = runs,
                  .run_count = count,
                  .panel = panel,
                  .update = update,
                  .rows = symbolic->rows[s],
                  .pivots = bwi_pivots(symbolic, s)};
  int64_t grain = 1 + (1 << 18) / from;
  return bw_parallel(context, from, grain, add_columns, &add);
}
