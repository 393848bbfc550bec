/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Memory that is filled once and read a few times. */
#ifndef BWI_BASE_PAGES_H
#define BWI_BASE_PAGES_H

#include "barwright/base.h"

/* As bw_alloc, for the factor of a matrix and what it is made from. Such a block is in large pages
 * too, unless the host of a virtual machine takes free large pages back: it clears each
 * again at the first touch, which takes four times as long as small pages that the machine still
 * has. */
void *bwi_alloc_once(bw_context *context, size_t count, size_t size) BW_MUST_USE;

#endif
