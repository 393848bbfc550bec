/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The exact search of a convex, piecewise linear function along a line: how many of its breakpoints
 * are passed before its slope is no longer negative, by selection in linear time. */
#include "lp/simplex.h"

bool bwi_sooner(const bwi_breakpoint *a, const bwi_breakpoint *b) {
  return a->step != b->step ? a->step < b->step : a->column < b->column;
}

int32_t bwi_select_breakpoints(bwi_breakpoint *list, int32_t count, double wanted) {
  int32_t low = 0, high = count;
  double all = 0;
  for (int32_t i = 0; i < count; i++)
    all += list[i].slope;
  if (!(all >= wanted))
    return -1;
  while (high - low > 1) {
    bwi_breakpoint a = list[low], b = list[low + (high - low) / 2], c = list[high - 1];
    bwi_breakpoint pivot = bwi_sooner(&a, &b) ? (bwi_sooner(&b, &c)   ? b
                                                 : bwi_sooner(&a, &c) ? c
                                                                      : a)
                                              : (bwi_sooner(&a, &c)   ? a
                                                 : bwi_sooner(&b, &c) ? c
                                                                      : b);
    double slope = 0;
    int32_t i = low, j = high - 1;
    for (;;) {
      while (bwi_sooner(&list[i], &pivot))
        slope += list[i++].slope;
      while (bwi_sooner(&pivot, &list[j]))
        j--;
      if (i >= j)
        break;
      bwi_breakpoint t = list[i];
      list[i] = list[j];
      list[j] = t;
    }
    if (slope >= wanted) {
      high = i;
    } else if (slope + list[i].slope >= wanted || i + 1 == high) {
      return i + 1;
    } else {
      wanted -= slope + list[i].slope;
      low = i + 1;
    }
  }
  return low + 1;
}
