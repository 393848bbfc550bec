/* One job, waited for. See child.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "base/child.h"

#include <math.h>
#include <string.h>

#include "base/job.h"

/* Limits are on computing time, so that what a run gives does not depend on how busy the machine
 * is; a child that only waits ends after this many times as long. */
enum { WALL_FACTOR = 6 };

/* Seconds after which the last progress is reported again. */
static const double BETWEEN_REPORTS = 0.25;

struct bwi_child_stream {
  bw_job_stream *out;
};

typedef struct request {
  bwi_child_work *work;
  void *data;
} request;

static bw_status run(bw_context *context, void *data, bw_job_stream *out) {
  const request *asked = (const request *)data;
  bwi_child_stream stream = {out};
  return asked->work(context, asked->data, &stream);
}

bw_status bwi_child_write(bwi_child_stream *out, const void *bytes, size_t count) {
  return bw_job_write(out->out, bytes, count);
}

/* A library that ends its process does so because of the shape it was given. */
static bw_status fail_broken(bw_context *context, const char *what, int number) {
  bw_status status;
  if (number)
    status = bw_fail(context, BW_GEOMETRY, "%s failed: the library stopped with signal %d (%s)",
                     what, number, strsignal(number));
  else
    status = bw_fail(context, BW_GEOMETRY, "%s failed: the library ended the process", what);
  bw_detail_number(context, "signal", number);
  return status;
}

bw_status bwi_child_run(bw_context *context, const char *what, const bwi_child_limits *limits,
                        bwi_child_work *work, void *data, unsigned char **bytes, size_t *count) {
  bw_job_options options = {.name = what, .show = true};
  if (limits) {
    options.processor_seconds = limits->seconds;
    options.seconds = WALL_FACTOR * limits->seconds;
    options.bytes = limits->bytes;
  }
  request asked = {work, data};
  bw_job *job = NULL;
  const unsigned char *result;
  size_t length;
  int which;
  bw_status status;
  BW_TRY(bw_job_start(context, &options, run, &asked, &job));
  do { /* the caller can cancel also while the work reports nothing */
    BW_TRY(bw_jobs_wait(context, 1, &job, BETWEEN_REPORTS, &which));
    if (which < 0)
      bwi_progress_again(context);
  } while (which < 0);
  bw_job_usage usage;
  bw_job_read_usage(job, &usage);
  if (limits && limits->spent)
    *limits->spent += usage.processor_seconds;
  if (usage.state == BW_JOB_CRASHED)
    BW_TRY(fail_broken(context, what, usage.signal));
  BW_TRY(bw_job_result(context, job, &result, &length));
  unsigned char *own = bwi_job_take(job);
  if (!own)
    own = BW_NEW(context, unsigned char, 0);
  BW_TRY_MEMORY(own);
  *bytes = own;
  *count = length;
done:
  bw_release(job);
  return status;
}
