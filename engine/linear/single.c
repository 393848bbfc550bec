/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The kernels of a factor once more, for float (real.h). */
#define BWI_SINGLE
#include "linear/fields.c"
#include "linear/front.c"
#include "linear/front_assemble.c"
#include "linear/triangular.c"
