/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Large blocks of numbers on huge pages, where the system has them: first touch of a gibibyte takes
 * most of a second in small pages, and the factor is read from end to end at every solve. */
#include <stdint.h>
#include <sys/mman.h>

#include "solve/internal.h"

double *bwi_numbers(bw_context *context, int64_t count) {
  enum { HUGE = 2 << 20 };
  double *block = BW_NEW(context, double, count);
  size_t bytes = (size_t)count * sizeof(double);
  if (block && bytes >= 2 * (size_t)HUGE) {
    uintptr_t begin = ((uintptr_t)block + HUGE - 1) / HUGE * HUGE;
    uintptr_t end = ((uintptr_t)block + bytes) / HUGE * HUGE;
    if (end > begin)
      (void)madvise((void *)begin, end - begin,
                    MADV_HUGEPAGE); /* a wish: failure costs time only */
  }
  return block;
}
