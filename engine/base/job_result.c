/* What came of a job: usage, result, and the message where there is none. See barwright/job.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <signal.h>
#include <string.h>

#include "base/job.h"

void bw_job_read_usage(const bw_job *job, bw_job_usage *usage) {
  *usage = job->usage;
  if (usage->state == BW_JOB_RUNNING)
    usage->seconds = bw_seconds() - job->start;
}

const char *bw_job_name(const bw_job *job) {
  return job->name;
}

static bw_status out_of_time(bw_context *context, const bw_job *job) {
  bool computing = job->usage.signal == SIGPROF;
  double limit = computing ? job->processor_limit : job->seconds_limit;
  bw_status status = bw_fail(context, BW_LIMIT, "%s took more than the %.4g seconds%s it may use",
                             job->name, limit, computing ? " of computing" : "");
  bw_detail_text(context, "limit", "time");
  bw_detail_number(context, "seconds", limit);
  return status;
}

static bw_status out_of_memory(bw_context *context, const bw_job *job) {
  static const char *const unit[] = {"MB", "GB", "TB"};
  double size = job->bytes_limit / 1e6;
  int u = 0;
  for (; u < 2 && size >= 999.5; u++)
    size /= 1e3;
  bw_status status =
      bw_fail(context, BW_LIMIT, "%s needs more than the %.3g %s of memory it may use", job->name,
              size, unit[u]);
  bw_detail_text(context, "limit", "memory");
  bw_detail_number(context, "bytes", job->bytes_limit);
  return status;
}

/* The work ended by itself in a failure: say it in the caller's context. */
static bw_status failed(bw_context *context, const bw_job *job) {
  bw_status status = job->failure;
  if (job->payload_held)
    bw_fail(context, status, "%s", job->payload);
  else
    bw_fail(context, status, "%s failed (%s)", job->name, bw_status_word(status));
  for (int i = 0; i < job->detail_count; i++)
    if (job->detail[i].is_text)
      bw_detail_text(context, job->detail[i].key, job->detail[i].text);
    else
      bw_detail_number(context, job->detail[i].key, job->detail[i].number);
  return status;
}

static bw_status crashed(bw_context *context, const bw_job *job) {
  bw_status status;
  int number = job->usage.signal;
  if (number == SIGKILL)
    status = bw_fail(
        context, BW_INTERNAL,
        "%s was killed by signal 9 from outside: by a user, or by the system for lack of memory",
        job->name);
  else if (number)
    status = bw_fail(context, BW_INTERNAL, "%s crashed with signal %d (%s)", job->name, number,
                     strsignal(number));
  else
    status = bw_fail(context, BW_INTERNAL, "%s left its process with exit code %d before its end",
                     job->name, job->exit_code);
  if (number)
    bw_detail_number(context, "signal", number);
  else
    bw_detail_number(context, "exit", job->exit_code);
  return status;
}

bw_status bw_job_result(bw_context *context, const bw_job *job, const unsigned char **bytes,
                        size_t *count) {
  static const unsigned char nothing[1];
  switch (job->usage.state) {
  case BW_JOB_RUNNING:
    return bw_fail(context, BW_INVALID, "%s is running: wait for it first", job->name);
  case BW_JOB_DONE:
    *bytes = job->bytes ? job->bytes : nothing;
    *count = job->count;
    return BW_OK;
  case BW_JOB_FAILED:
    return failed(context, job);
  case BW_JOB_CRASHED:
    return crashed(context, job);
  case BW_JOB_OUT_OF_TIME:
    return out_of_time(context, job);
  case BW_JOB_OUT_OF_MEMORY:
    return out_of_memory(context, job);
  case BW_JOB_CANCELLED:
    break;
  }
  return bw_fail(context, BW_CANCELLED, "%s was cancelled", job->name);
}

unsigned char *bwi_job_take(bw_job *job) {
  unsigned char *bytes = job->bytes;
  job->bytes = NULL;
  job->count = job->capacity = 0;
  return bytes;
}
