/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "linear/blas.h"

#include <sys/mman.h>

enum { BUFFER = 130 << 20 }; /* a little more than OpenBLAS takes at a time */

bool bwi_blas_has_memory(int threads) {
  static bool had_memory;
  if (__atomic_load_n(&had_memory, __ATOMIC_RELAXED))
    return true;
  size_t size = (size_t)threads * BUFFER;
  void *block =
      mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (block == MAP_FAILED)
    return false;
  munmap(block, size);
  __atomic_store_n(&had_memory, true, __ATOMIC_RELAXED);
  return true;
}
