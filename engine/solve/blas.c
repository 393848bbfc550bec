/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "solve/blas.h"

void openblas_set_num_threads(int);
int openblas_get_num_threads(void);

void bwi_blas_serial(void) {
  if (openblas_get_num_threads() != 1)
    openblas_set_num_threads(1);
}
