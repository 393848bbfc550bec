/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Warnings that work which is done several times would repeat. */
#ifndef BWI_WARNING_H
#define BWI_WARNING_H

#include "barwright/base.h"

/* As bw_warn, but of all warnings with one format (a literal) only that of the largest value is
 * kept, at the index of the first: three meshes of one command say once how far they moved the
 * surface. */
void bwi_warn_largest(bw_context *context, double value, const char *format, ...) BW_PRINTF(3, 4);

#endif
