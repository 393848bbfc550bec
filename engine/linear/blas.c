/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "linear/blas.h"

#include <sys/mman.h>

enum { BUFFER = 130 << 20 }; /* a little more than OpenBLAS takes at a time */

bw_status bwi_blas_check_memory(bw_context *context, int threads) {
  static bool had_memory;
  if (__atomic_load_n(&had_memory, __ATOMIC_RELAXED))
    return BW_OK;
  size_t size = (size_t)threads * BUFFER;
  void *block =
      mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (block == MAP_FAILED)
    return bw_fail(context, BW_MEMORY,
                   "the address space has no room for OpenBLAS, which takes 128 MB for each of %d "
                   "threads: raise the limit (ulimit -v) or use fewer threads",
                   threads);
  munmap(block, size);
  __atomic_store_n(&had_memory, true, __ATOMIC_RELAXED);
  return BW_OK;
}
