/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of skeletons and weights share. */
#ifndef BWI_SHAPE_INTERNAL_H
#define BWI_SHAPE_INTERNAL_H

#include "barwright/shape.h"

/* ---- TGF from memory, for the reader and for fuzzing (skeleton_tgf.c) ------------------------ */

bw_status bwi_tgf_parse(bw_context *context, const char *name, const unsigned char *bytes,
                        size_t count, double unit, bw_skeleton **skeleton);

#endif
