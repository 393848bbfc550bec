/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The columns of a row of a sparsity pattern: sorting them, and finding one again. */
#ifndef BWI_BASE_SORT_H
#define BWI_BASE_SORT_H

#include <stdint.h>

/* Ascending, in place, without memory or calls. Rows are short; that of a node with very many
 * neighbours (a star of elements) must not cost the square of them: Shell sort. */
static inline void bwi_sort_columns(int32_t *list, int64_t count) {
  int64_t gap = 1;
  while (gap < count / 9)
    gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3)
    for (int64_t i = gap; i < count; i++) {
      int32_t item = list[i];
      int64_t j = i;
      for (; j >= gap && list[j - gap] > item; j -= gap)
        list[j] = list[j - gap];
      list[j] = item;
    }
}

/* The index of a column in list[begin, end), which ascends and has it. */
static inline int64_t bwi_sorted_index(const int32_t *list, int64_t begin, int64_t end,
                                       int32_t column) {
  while (end - begin > 1) {
    int64_t middle = begin + (end - begin) / 2;
    if (list[middle] <= column)
      begin = middle;
    else
      end = middle;
  }
  return begin;
}

#endif
