/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The formats, and how one is recognised. */
#ifndef BWI_IO_FORMATS_H
#define BWI_IO_FORMATS_H

#include "io/internal.h"

typedef enum bwi_format {
  BWI_UNKNOWN,
  BWI_STL,
  BWI_OBJ,
  BWI_OFF,
  BWI_PLY,
  BWI_3MF,
  BWI_GLTF,
  BWI_MSH,
  BWI_VTU,
  BWI_MEDIT,
  BWI_TETGEN,
  BWI_INP
} bwi_format;

/* Says what the content looks like and which formats were considered; BW_FORMAT. */
bw_status bwi_fail_unknown(bwi_cursor *cursor, const char *considered);
const char *bwi_ending(const char *path); /* behind the last dot of the file's name; "" */
bool bwi_has_ending(const char *path, const char *ending); /* in any case of letters */

#endif
