/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What all benchmarks share. */
#ifndef BENCH_H
#define BENCH_H

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "barwright.h"

/* Ends the program where a call fails; `context` is the caller's. */
#define OK(call)                                                                                   \
  do {                                                                                             \
    if ((call) != BW_OK) {                                                                         \
      fprintf(stderr, "%s\n", bw_message(context));                                                \
      exit(1);                                                                                     \
    }                                                                                              \
  } while (0)

/* Of all threads: on a busy machine they are more reliable than the clock. */
static inline double processor_seconds(void) {
  return (double)clock() / CLOCKS_PER_SEC;
}

#endif
