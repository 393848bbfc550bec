/* The starter's side of jobs. See barwright/job.h; the child's side is job_child.c,
 * what came of it job_result.c.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * The child sends frames through a pipe: a head and a payload. A frame of kind DONE or FAILED is
 * the last one. The end of the pipe alone is not trusted to mean that the child has ended, since a
 * process forked meanwhile may hold a copy of its writing end: the process itself is asked as well.
 *
 * Invariant: a job is in the list `living` exactly while its state is RUNNING, and then its child
 * has not been waited for, so that its number belongs to no other process. */
#include "base/job.h"
#include "base/blas.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CHUNK = 1 << 15, POLL_MILLISECONDS = 50, DRAIN_MILLISECONDS = 100 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static bw_job *living;
static int own_pipe = -1; /* in a child: its writing end */

static void list_add(bw_job *job) {
  pthread_mutex_lock(&lock);
  job->next = living;
  if (living)
    living->previous = job;
  living = job;
  pthread_mutex_unlock(&lock);
}

static void list_remove(bw_job *job) {
  pthread_mutex_lock(&lock);
  if (job->previous)
    job->previous->next = job->next;
  else
    living = job->next;
  if (job->next)
    job->next->previous = job->previous;
  job->previous = job->next = NULL;
  pthread_mutex_unlock(&lock);
}

/* ---- the end of a job ------------------------------------------------------------------------ */

static void collect(bw_job *job) {
  int how = 0;
  struct rusage used;
  memset(&used, 0, sizeof used);
  /* All of its group: a shell that it started would go on. Its own end is not changed by this when
   * it has begun. */
  kill(-job->child, SIGKILL);
  kill(job->child, SIGKILL);
  while (wait4(job->child, &how, 0, &used) < 0 && errno == EINTR)
    ;
  close(job->pipe);
  job->pipe = -1;
  list_remove(job);
  bw_job_usage *u = &job->usage;
  if (!job->last_frame)
    u->seconds = bw_seconds() - job->start;
  u->processor_seconds = (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                         1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  u->peak_bytes = 1024.0 * (double)used.ru_maxrss;
  u->signal = !job->last_frame && WIFSIGNALED(how) ? WTERMSIG(how) : 0;
  job->exit_code = WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

static void conclude(bw_job *job) {
  bool limited = job->bytes_limit > 0;
  collect(job);
  bw_job_usage *u = &job->usage;
  if (job->last_frame && job->failure == BW_OK)
    u->state = BW_JOB_DONE;
  else if (job->last_frame)
    u->state = job->failure == BW_MEMORY && limited ? BW_JOB_OUT_OF_MEMORY : BW_JOB_FAILED;
  else if (u->signal == SIGALRM || u->signal == SIGPROF)
    u->state = BW_JOB_OUT_OF_TIME;
  else if (u->signal == SIGKILL && limited && u->peak_bytes > 0.5 * job->bytes_limit)
    /* the system's out-of-memory killer; who held little was killed by somebody */
    u->state = BW_JOB_OUT_OF_MEMORY;
  else
    u->state = BW_JOB_CRASHED;
}

void bw_job_cancel(bw_job *job) {
  /* A child that came by the job through its fork has no right to it. */
  if (job->usage.state != BW_JOB_RUNNING || job->starter != getpid())
    return;
  job->last_frame = false;
  collect(job);
  job->usage.state = BW_JOB_CANCELLED;
}

static void job_destroy(void *object) {
  bw_job *job = (bw_job *)object;
  bw_job_cancel(job);
  bw_free(job->bytes);
  bw_free(job);
}

static size_t job_bytes(const void *object) {
  const bw_job *job = (const bw_job *)object;
  return sizeof *job + job->capacity;
}

static const bw_kind job_kind = {"job", job_destroy, job_bytes};

/* ---- the start ------------------------------------------------------------------------------- */

/* What other libraries keep of threads must not be in the child, where the threads are not. */
static void settle_libraries(void) {
  bwi_blas_enter(); /* in the child OpenBLAS would start its threads again */
  /* CHOLMOD comes with OpenMP, whose sleeping threads a child would wait for. */
  static int (*pause_threads)(int);
  static bool searched;
  if (!searched) {
    void *symbol = dlsym(RTLD_DEFAULT, "omp_pause_resource_all");
    memcpy(&pause_threads, &symbol, sizeof symbol);
    searched = true;
  }
  enum { PAUSE_HARD = 2 };
  if (pause_threads)
    pause_threads(PAUSE_HARD);
}

static void close_pipes_of_others(void) {
  for (const bw_job *job = living; job; job = job->next)
    close(job->pipe);
  living = NULL;
  if (own_pipe >= 0)
    close(own_pipe);
}

bw_status bw_job_start(bw_context *context, const bw_job_options *options, bw_job_work *work,
                       void *data, bw_job **out) {
  static const bw_job_options defaults;
  int ends[2] = {-1, -1}, output = -1;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK)
    return status;
  options = options ? options : &defaults;
  bw_job *job = BW_NEW0(context, bw_job, 1);
  if (!job)
    return BW_MEMORY;
  bw_object_init(job, &job_kind);
  snprintf(job->name, sizeof job->name, "%s", options->name ? options->name : "the job");
  job->seconds_limit = options->seconds;
  job->processor_limit = options->processor_seconds;
  /* Where this process may use less, so may the child. */
  job->bytes_limit = options->bytes > 0 ? fmin(options->bytes, bwi_address_space_left()) : 0;
  job->show = options->show;
  job->starter = getpid();
  if (options->output) {
    output = open(options->output, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (output < 0) {
      status = bw_fail(context, BW_IO, "%s: cannot write %s (%s)", job->name, options->output,
                       strerror(errno));
      bw_detail_text(context, "file", options->output);
      goto done;
    }
  }
  if (pipe2(ends, O_CLOEXEC) != 0)
    BW_TRY(bw_fail(context, BW_LIMIT, "%s: no pipe for a child process (%s)", job->name,
                   strerror(errno)));
  fflush(NULL); /* else the child would hold, and write, what is buffered here */
  settle_libraries();
  job->start = bw_seconds();
  pthread_mutex_lock(&lock);
  job->child = fork();
  int why = errno;
  if (job->child == 0) {
    pthread_mutex_init(&lock, NULL);
    close(ends[0]);
    close_pipes_of_others();
    own_pipe = ends[1];
    bwi_blas_forked();
    bwi_job_child(context, options, work, data, ends[1], output, (int)job->starter);
  }
  pthread_mutex_unlock(&lock);
  bwi_blas_leave();
  if (job->child < 0)
    BW_TRY(bw_fail(context, BW_MEMORY, "%s: no child process (%s)", job->name, strerror(why)));
  setpgid(job->child, job->child); /* as the child does: whoever comes first */
  job->pipe = ends[0];
  ends[0] = -1;
  list_add(job);
  job->usage.stage = job->stage;
  *out = job;
  job = NULL;
done:
  if (job) {
    job->usage.state = BW_JOB_CANCELLED; /* it has no child */
    bw_release(job);
  }
  if (output >= 0)
    close(output);
  for (int i = 0; i < 2; i++)
    if (ends[i] >= 0)
      close(ends[i]);
  return status;
}

/* ---- what the child says --------------------------------------------------------------------- */

static void finish_frame(bw_context *context, bw_job *job) {
  switch (job->head.kind) {
  case BWI_PROGRESS: {
    bwi_progress_line line;
    memcpy(&line, job->payload, sizeof line);
    line.stage[sizeof line.stage - 1] = 0;
    memcpy(job->stage, line.stage, sizeof job->stage);
    job->usage.fraction = line.fraction;
    if (job->show)
      bw_progress(context, job->stage, line.fraction);
    break;
  }
  case BWI_DETAIL:
    if (job->detail_count < BWI_JOB_DETAILS)
      memcpy(&job->detail[job->detail_count++], job->payload, sizeof(bwi_detail_line));
    break;
  case BWI_FAILED:
  case BWI_DONE:
    job->failure = job->head.kind == BWI_DONE ? BW_OK : (bw_status)job->head.value;
    job->usage.seconds = job->head.seconds;
    job->last_frame = true;
    break;
  default:
    break;
  }
}

/* Take what a read brought. Where the memory for it is missing, the job has failed. */
static void take(bw_context *context, bw_job *job, const unsigned char *at, size_t got) {
  while (got > 0 && !job->last_frame) {
    if (job->head_held < sizeof job->head) {
      size_t part = sizeof job->head - job->head_held;
      part = part < got ? part : got;
      memcpy((char *)&job->head + job->head_held, at, part);
      job->head_held += part;
      at += part;
      got -= part;
      if (job->head_held < sizeof job->head)
        return;
      job->left = job->head.length;
      job->payload_held = 0;
      memset(job->payload, 0, sizeof job->payload);
      if (job->head.kind == BWI_DATA && !bw_grow(context, (void **)&job->bytes, &job->capacity,
                                                 job->count, (size_t)job->left, 1)) {
        snprintf(job->payload, sizeof job->payload,
                 "%s: no memory for its result of more than %zu bytes", job->name, job->count);
        job->payload_held = strlen(job->payload);
        job->failure = BW_MEMORY;
        job->bytes_limit = 0; /* it is not the child that wanted too much */
        job->usage.seconds = bw_seconds() - job->start;
        job->last_frame = true;
        return;
      }
    } else {
      size_t part = job->left < got ? (size_t)job->left : got;
      if (job->head.kind == BWI_DATA) {
        memcpy(job->bytes + job->count, at, part);
        job->count += part;
      } else {
        size_t capacity = sizeof job->payload - 1 - job->payload_held;
        size_t keep = part < capacity ? part : capacity;
        memcpy(job->payload + job->payload_held, at, keep);
        job->payload_held += keep;
      }
      job->left -= part;
      at += part;
      got -= part;
    }
    if (job->head_held == sizeof job->head && job->left == 0) {
      finish_frame(context, job);
      job->head_held = 0;
    }
  }
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* The pipe can be read, or has been closed. */
static void listen(bw_context *context, bw_job *job) {
  unsigned char chunk[CHUNK];
  ssize_t got = read(job->pipe, chunk, sizeof chunk);
  if (got < 0 && errno == EINTR)
    return;
  if (got > 0)
    take(context, job, chunk, (size_t)got);
  if (got <= 0 || job->last_frame)
    conclude(job);
}

/* Silence: has the child gone while somebody else holds its end of the pipe? Once it is known to be
 * gone and nothing is left to read, that was all. WNOWAIT leaves it to be collected. */
static void ask_process(bw_job *job) {
  if (job->silent_death) {
    conclude(job);
    return;
  }
  siginfo_t info;
  memset(&info, 0, sizeof info);
  if (waitid(P_PID, (id_t)job->child, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0)
    job->silent_death = true;
}

static bw_status check_jobs(bw_context *context, int count, bw_job *const *jobs) {
  for (int i = 0; i < count; i++)
    if (jobs[i]->usage.state == BW_JOB_RUNNING && jobs[i]->starter != getpid())
      return bw_fail(context, BW_INVALID, "%s was started by another process, which waits for it",
                     jobs[i]->name);
  return BW_OK;
}

bw_status bw_jobs_wait(bw_context *context, int count, bw_job *const *jobs, double seconds,
                       int *which) {
  bw_status status;
  double start = bw_seconds();
  bool late = false;
  struct pollfd *ready = BW_NEW(context, struct pollfd, count);
  if (!ready)
    return BW_MEMORY;
  BW_TRY(check_jobs(context, count, jobs));
  for (;;) {
    for (int i = 0; i < count; i++)
      if (jobs[i]->usage.state != BW_JOB_RUNNING) {
        *which = i;
        goto done;
      }
    BW_TRY(bw_check_cancel(context));
    if (count == 0 || late) {
      *which = -1;
      goto done;
    }
    for (int i = 0; i < count; i++)
      ready[i] = (struct pollfd){jobs[i]->pipe, POLLIN, 0};
    double left = 1000 * (seconds - (bw_seconds() - start));
    int timeout = left >= POLL_MILLISECONDS ? POLL_MILLISECONDS : left > 0 ? (int)ceil(left) : 0;
    int found = poll(ready, (nfds_t)count, timeout);
    if (found < 0 && errno != EINTR)
      BW_TRY(bw_fail(context, BW_LIMIT, "waiting for %d jobs: %s", count, strerror(errno)));
    /* What has come by the end of the time is still read, and may be somebody's last words. */
    late = left <= 0 && (found == 0 || left < -DRAIN_MILLISECONDS);
    for (int i = 0; i < count && found >= 0; i++)
      if (ready[i].revents)
        listen(context, jobs[i]);
      else if (found == 0)
        ask_process(jobs[i]);
  }
done:
  bw_free(ready);
  return status;
}
