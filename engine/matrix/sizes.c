/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How many rows and columns a file may say that a matrix has. */
#include "matrix/internal.h"

bw_status bwi_check_size(const bwi_cursor *cursor, int64_t size, const char *what) {
  /* Few matrices have so many empty rows. */
  enum { PER_BYTE = 16, ALWAYS = 1000000 };
  size_t bytes = (size_t)(cursor->end - cursor->begin);
  bool is_text = bytes > 0 && *cursor->begin == '%';
  bw_status (*fail)(const bwi_cursor *, const char *, ...) =
      is_text ? bwi_fail_line : bwi_fail_byte;
  if (size < 0)
    return fail(cursor, "%lld %s: 0 or more expected", (long long)size, what);
  if (size >= INT32_MAX) {
    fail(cursor, "%lld %s: fewer than 2^31 - 1 expected", (long long)size, what);
    return BW_LIMIT;
  }
  if (size > ALWAYS + PER_BYTE * (int64_t)bytes)
    return fail(cursor, "%lld %s in a file of %zu bytes: the number must be wrong", (long long)size,
                what, bytes);
  return BW_OK;
}
