/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sorting the columns of a row of a graph. */
#ifndef BWI_BASE_SORT_H
#define BWI_BASE_SORT_H

#include <stdint.h>

/* Ascending, in place, without memory or calls. Rows are short; that of a node with very many
 * neighbours (a star of elements) must not cost the square of them: insertion with shrinking gaps.
 */
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

#endif
