/* Limits on time. See limit.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "base/limit.h"

#include <string.h>
#include <time.h>

static double thread_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

bwi_time_limit bwi_time_limit_begin(const char *what, double seconds) {
  return (bwi_time_limit){what, seconds, thread_seconds()};
}

double bwi_time_limit_left(const bwi_time_limit *limit) {
  return limit->seconds - (thread_seconds() - limit->start);
}

bool bwi_time_ran_out(const bw_context *context, bw_status status) {
  const char *key, *text;
  double number;
  for (int i = 0; status == BW_LIMIT && bw_detail(context, i, &key, &number, &text); i++)
    if (strcmp(key, "limit") == 0 && text && strcmp(text, "time") == 0)
      return true;
  return false;
}

bw_status bwi_time_limit_check(bw_context *context, const bwi_time_limit *limit) {
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK || bwi_time_limit_left(limit) >= 0)
    return status;
  bw_fail(
      context, BW_LIMIT,
      "%s took more than the %.4g seconds of computing it may use: raise time_limit, or ask for "
      "larger elements",
      limit->what, limit->seconds);
  bw_detail_text(context, "limit", "time");
  bw_detail_number(context, "seconds", limit->seconds);
  return BW_LIMIT;
}
