/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Text that grows in memory. */
#include "io/growing.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "barwright/io.h"
#include "io/locale.h"

enum { PIECE = 1024 }; /* the longest that one call adds */

static bool reserve(bwi_growing *text) {
  if (text->status == BW_OK &&
      !bw_grow(text->context, (void **)&text->at, &text->capacity, text->count, PIECE, 1))
    text->status = BW_MEMORY;
  return text->status == BW_OK;
}

void bwi_growing_print(bwi_growing *text, const char *format, ...) {
  va_list arguments;
  if (!reserve(text))
    return;
  locale_t before = uselocale(bwi_c_locale());
  va_start(arguments, format);
  int length = vsnprintf(text->at + text->count, PIECE, format, arguments);
  va_end(arguments);
  uselocale(before);
  if (length < 0 || length >= PIECE)
    text->status = bw_fail(text->context, BW_LIMIT, "a text of more than %d bytes", PIECE - 1);
  else
    text->count += (size_t)length;
}

void bwi_growing_number(bwi_growing *text, double value) {
  if (reserve(text))
    text->count += (size_t)bw_format_number(value, text->at + text->count);
}
