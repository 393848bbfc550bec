/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The memory that a drop takes beside the factor, which has a check of its own: refused before it
 * is taken, for memory that is given out but never there ends the process. */
#include "barwright/job.h"
#include "drop/internal.h"

bw_status bwi_drop_check_memory(bw_context *context, double numbers, const char *what,
                                const char *advice) {
  double bytes = numbers * sizeof(double), available = bw_available_memory();
  if (bytes <= available)
    return BW_OK;
  bw_fail(context, BW_MEMORY,
          "%s of a drop take %.3g GB of memory beside the factor, more than the %.3g GB available: "
          "%s",
          what, bytes / 1e9, available / 1e9, advice);
  bw_detail_number(context, "bytes", bytes);
  bw_detail_number(context, "free_bytes", available);
  return BW_MEMORY;
}
