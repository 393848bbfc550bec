/* The child's side of a job. See barwright/job.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Limits on time are timers of the child itself: the system ends it by SIGALRM or SIGPROF, also
 * while the starter is busy with something else. */
#include "base/job.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

enum { BUFFER = 1 << 16 };

struct bw_job_stream {
  int pipe;
  double start;
  size_t held;
  unsigned char buffer[BUFFER];
};

static bool put_all(int pipe, const void *bytes, size_t count) {
  const unsigned char *at = (const unsigned char *)bytes;
  while (count > 0) {
    ssize_t put = write(pipe, at, count);
    if (put < 0 && errno == EINTR)
      continue;
    if (put <= 0)
      return false;
    at += put;
    count -= (size_t)put;
  }
  return true;
}

static bool put_frame(bw_job_stream *out, uint32_t kind, int32_t value, const void *bytes,
                      size_t count) {
  bwi_message_frame head = {kind, value, count, bw_seconds() - out->start};
  return put_all(out->pipe, &head, sizeof head) && put_all(out->pipe, bytes, count);
}

static bool flush(bw_job_stream *out) {
  bool good = out->held == 0 || put_frame(out, BWI_DATA, 0, out->buffer, out->held);
  out->held = 0;
  return good;
}

bw_status bw_job_write(bw_job_stream *out, const void *bytes, size_t count) {
  if (count > BUFFER - out->held && !flush(out))
    return BW_IO;
  if (count > BUFFER)
    return put_frame(out, BWI_DATA, 0, bytes, count) ? BW_OK : BW_IO;
  if (count)
    memcpy(out->buffer + out->held, bytes, count);
  out->held += count;
  return BW_OK;
}

void bw_job_progress(void *data, const char *stage, double fraction) {
  bw_job_stream *out = (bw_job_stream *)data;
  /* A pipe is ready when a page of it is free, and then a short frame goes in whole. */
  struct pollfd writable = {out->pipe, POLLOUT, 0};
  if (poll(&writable, 1, 0) != 1)
    return;
  struct {
    bwi_message_frame head;
    bwi_progress_line line;
  } frame = {.head = {BWI_PROGRESS, 0, sizeof frame.line, bw_seconds() - out->start},
             .line = {.fraction = fraction}};
  snprintf(frame.line.stage, sizeof frame.line.stage, "%s", stage);
  put_all(out->pipe, &frame, sizeof frame);
}

static void send_failure(const bw_context *context, bw_job_stream *out, bw_status status) {
  const char *key, *text;
  double number;
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++) {
    bwi_detail_line line = {.number = number, .is_text = text != NULL};
    snprintf(line.key, sizeof line.key, "%s", key);
    snprintf(line.text, sizeof line.text, "%s", text ? text : "");
    put_frame(out, BWI_DETAIL, 0, &line, sizeof line);
  }
  const char *message = bw_message(context);
  put_frame(out, BWI_FAILED, (int32_t)status, message, strlen(message));
}

static void limit_memory(double bytes) {
  double present = bwi_address_space(), wanted = present + bytes;
  struct rlimit space;
  if (present <= 0 || wanted >= 9e18 || getrlimit(RLIMIT_AS, &space) != 0)
    return;
  if (space.rlim_cur == RLIM_INFINITY || wanted < (double)space.rlim_cur) {
    space.rlim_cur = (rlim_t)wanted;
    setrlimit(RLIMIT_AS, &space);
  }
}

static void limit_time(int timer, double seconds) {
  if (!(seconds > 0) || seconds > 1e9)
    return;
  struct itimerval end = {.it_value = {.tv_sec = (time_t)seconds}};
  end.it_value.tv_usec = (suseconds_t)((seconds - floor(seconds)) * 1e6);
  if (end.it_value.tv_sec == 0 && end.it_value.tv_usec == 0)
    end.it_value.tv_usec = 1;
  setitimer(timer, &end, NULL);
}

static void prepare(const bw_job_options *options, int output, int parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) /* it died before it was asked to take us along */
    _exit(1);
  /* Handlers are the starter's business, and so is Ctrl-C, which does not come here. */
  for (int number = 1; number < 32; number++)
    signal(number, SIG_DFL);
  /* A file that may not grow further is a failure to write, which can be reported. */
  signal(SIGXFSZ, SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);

  int null = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (null >= 0) {
    dup2(null, STDIN_FILENO);
    dup2(output >= 0 ? output : null, STDOUT_FILENO);
    dup2(output >= 0 ? output : null, STDERR_FILENO);
    if (null > STDERR_FILENO)
      close(null);
  }
  if (output > STDERR_FILENO)
    close(output);

  struct rlimit none_at_all = {0, 0};
  setrlimit(RLIMIT_CORE, &none_at_all);
  if (options->bytes > 0)
    limit_memory(options->bytes);
  limit_time(ITIMER_REAL, options->seconds);
  limit_time(ITIMER_PROF, options->processor_seconds);
}

_Noreturn void bwi_job_child(bw_context *context, const bw_job_options *options, bw_job_work *work,
                             void *data, int pipe, int output, int parent) {
  static bw_job_stream out; /* too big for a stack of unknown depth; the child is alone */
  out.pipe = pipe;
  out.start = bw_seconds();
  out.held = 0;
  bw_fail_allocation(0, false); /* a test's failing allocation concerns the starter alone */
  prepare(options, output, parent);
  bwi_context_forked(context);
  bw_set_progress(context, bw_job_progress, &out);
  bw_status status = work(context, data, &out);
  fflush(NULL);
  if (status != BW_OK)
    send_failure(context, &out, status);
  else if (!flush(&out) || !put_frame(&out, BWI_DONE, 0, NULL, 0))
    _exit(1);
  _exit(0);
}
