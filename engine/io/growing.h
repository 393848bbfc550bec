/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Text that grows in memory, for formats that hold text inside of something else. */
#ifndef BWI_IO_GROWING_H
#define BWI_IO_GROWING_H

#include "barwright/base.h"

typedef struct bwi_growing {
  bw_context *context;
  char *at; /* not 0-terminated; release with bw_free */
  size_t count, capacity;
  bw_status status; /* the first error; later calls add nothing */
} bwi_growing;

void bwi_growing_print(bwi_growing *text, const char *format, ...) BW_PRINTF(2, 3);
void bwi_growing_number(bwi_growing *text, double value); /* as bw_format_number */

#endif
