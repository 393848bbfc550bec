/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the fuzzers and the replay test share. */
#ifndef PARSE_CHECK_H
#define PARSE_CHECK_H

#include <stdlib.h>

#include "barwright.h"

static inline void parse_require(int condition) {
  if (!condition)
    abort();
}

static inline bw_context *parse_context(void) {
  static bw_context *context;
  if (!context) {
    context = bw_context_create();
    parse_require(context != NULL && bw_set_threads(context, 1) == BW_OK);
  }
  bw_clear_failure(context);
  bw_clear_warnings(context);
  return context;
}

#endif
