/* Limits on the time that work in this process may take. Work in a child process has its own
 * (child.h).
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_LIMIT_H
#define BARWRIGHT_BASE_LIMIT_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds of computing of the thread that began, so that what a call gives does not depend on how
 * busy the machine is. */
typedef struct bwi_time_limit {
  const char *what; /* in messages: "filling the outline" */
  double seconds, start;
} bwi_time_limit;
bwi_time_limit bwi_time_limit_begin(const char *what, double seconds);

/* BW_CANCELLED; BW_LIMIT with the details limit = "time" and seconds. Cheap enough for every
 * thousandth step of a loop. On the thread that began. */
bw_status bwi_time_limit_check(bw_context *context, const bwi_time_limit *limit);

/* Seconds of computing that are left. On the thread that began. */
double bwi_time_limit_left(const bwi_time_limit *limit);

/* Whether the status is that of a failure because time ran out, by the detail of the context. */
bool bwi_time_ran_out(const bw_context *context, bw_status status);

#ifdef __cplusplus
}
#endif
#endif
