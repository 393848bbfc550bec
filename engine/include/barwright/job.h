/* Jobs: work in forked child processes with limits on time and memory, one or many at a time.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A child has the memory of its starter at the fork, on pages that both share until one writes; the
 * starter does not see what the child writes. Whatever the child does (crash, hang, fill memory),
 * the starter gets a status and a message. The child has one thread. It is the leader of a process
 * group of its own, so that Ctrl-C at a terminal reaches the starter alone, and ends with the
 * starter. Files that were open at the fork stay open in it; the pipes of other jobs do not. */
#ifndef BARWRIGHT_JOB_H
#define BARWRIGHT_JOB_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bw_job bw_job; /* an object: bw_retain, bw_release */
/* The child's end of the pipe to the starter; it lives while the work runs and is not released. */
typedef struct bw_job_stream bw_job_stream;

/* What a job is called and what it may take; the texts are copied or read by bw_job_start. All
 * zeros are the defaults. */
typedef struct bw_job_options {
  const char *name;         /* in messages: "trial 7"; NULL: "the job" */
  const char *output;       /* file for standard output and error; NULL: they go nowhere */
  double seconds;           /* of time by the clock; 0: no limit */
  double processor_seconds; /* (s) of computing; 0: no limit */
  double bytes; /* (bytes) of address space beyond that of the process at the fork; 0: no limit */
  bool show;    /* progress of the work goes to the progress function of the context that waits */
} bw_job_options;

/* Called in the child, with the starter's context prepared for it: one thread, no failure, no
 * warnings; bw_progress in it reaches the job's usage. A failure goes to the starter with message
 * and details. When it returns, what it wrote to files is flushed, and the process ends; nothing
 * registered with atexit runs. */
typedef bw_status bw_job_work(bw_context *context, void *data, bw_job_stream *out);
/* Append `count` bytes to the job's result. BW_IO when the starter is gone. */
BW_API bw_status bw_job_write(bw_job_stream *out, const void *bytes, size_t count);
/* A bw_progress_function for the child, with the fraction done of a stage; `out` is the stream.
 * What finds no room in the pipe is dropped: the work does not wait for a starter that is busy. */
BW_API void bw_job_progress(void *out, const char *stage, double fraction);

/* Fork and begin `work`. Nothing of the context's threads may be at work. Ask bw_may_start before.
 * BW_IO where the output file cannot be written, BW_LIMIT where the system has no pipe or process
 * left. */
BW_API bw_status bw_job_start(bw_context *context, const bw_job_options *options, bw_job_work *work,
                              void *data, bw_job **job);

/* Wait until one of the jobs has ended; *which is its place, or -1 when `seconds` have passed
 * (INFINITY: no end) or the list is empty. A job that ended before counts at once. BW_CANCELLED
 * leaves the jobs as they are. BW_LIMIT where the system refuses to wait. */
BW_API bw_status bw_jobs_wait(bw_context *context, int count, bw_job *const *jobs, double seconds,
                              int *which);

/* What became of a job. */
typedef enum bw_job_state {
  BW_JOB_RUNNING,       /* it has not ended */
  BW_JOB_DONE,          /* the work returned BW_OK */
  BW_JOB_FAILED,        /* the work returned a failure */
  BW_JOB_CRASHED,       /* a signal, or the process was left early */
  BW_JOB_OUT_OF_TIME,   /* either limit */
  BW_JOB_OUT_OF_MEMORY, /* the limit on address space */
  BW_JOB_CANCELLED      /* bw_job_cancel */
} bw_job_state;

/* What a job has used so far. */
typedef struct bw_job_usage {
  bw_job_state state;       /* at the time of the call */
  int signal;               /* that ended it, or 0 */
  double seconds;           /* (s) by the clock, from the fork to the end of the work */
  double processor_seconds; /* (s) with that of processes that it waited for; once it has ended */
  double peak_bytes;        /* (bytes) resident, shared pages included; once it has ended */
  const char *stage; /* of its last progress, "" when there was none; lives as the job does */
  double fraction;   /* (-) done of that stage */
} bw_job_usage;

/* What a job has used until its last message, or until its end. */
BW_API void bw_job_read_usage(const bw_job *job, bw_job_usage *usage);
/* Its name, which lives as long as the job. */
BW_API const char *bw_job_name(const bw_job *job);

/* What the work wrote; the bytes live as long as the job. Otherwise, with message and details:
 *   the work's own status      it failed
 *   BW_LIMIT                   time or memory ran out (detail "limit": "time" or "memory")
 *   BW_INTERNAL                it crashed (detail "signal") or left early (detail "exit")
 *   BW_CANCELLED               bw_job_cancel
 *   BW_INVALID                 it is running */
BW_API bw_status bw_job_result(bw_context *context, const bw_job *job, const unsigned char **bytes,
                               size_t *count);

/* End it with all processes of its group, and collect it; nothing where it has ended. The last
 * release of a running job does the same. */
BW_API void bw_job_cancel(bw_job *job);

/* The memory (bytes) that this process may still take: the least of what the machine has free and
 * of what a job's limit, one on address space and one on the control group leave; INFINITY where
 * none of these is known. The system provides memory only once it is touched, so that asking for
 * more than this succeeds, and ends the process later. */
BW_API double bw_available_memory(void);

#ifdef __cplusplus
}
#endif
#endif
