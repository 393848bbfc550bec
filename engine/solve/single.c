/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The kernels of a factor once more, for float (real.h). */
#define BWI_SINGLE
#include "solve/fields.c"
#include "solve/front.c"
#include "solve/front_assemble.c"
#include "solve/triangular.c"
