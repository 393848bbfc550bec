/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Extend-add: a child's update matrix into its parent's front, by runs of rows that are next to
 * each other in both, since most are. */
#include "solve/internal.h"

typedef struct addition {
  const double *from;
  int32_t size; /* of the child's update matrix */
  const bwi_run *runs;
  int32_t run_count;
  double *panel, *update;
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
    double *target =
        column < add->pivots
            ? add->panel + column * add->rows
            : add->update + bwi_update_column(outer, column - add->pivots) - add->pivots;
    const double *source = add->from + bwi_update_column(add->size, j);
    int64_t from = j, to = column, length = add->runs[r].length - (j - add->runs[r].from);
    for (int32_t q = r;;) {
      double *restrict a = target + to;
      const double *restrict b = source + from;
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
                        const double *of_child, const int32_t *local, bwi_run *runs, double *panel,
                        double *update) {
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
