/* Work in a child process with limits. See child.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * The child sends frames through a pipe: a header (kind and length) and a payload. A frame of kind
 * DONE or FAILED is the last one. The end of the pipe alone is not trusted to mean that the child
 * has ended, since another child forked meanwhile from another thread may hold a copy of its
 * writing end: the process itself is asked as well. */
#include "base/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Limits are on computing time, so that what a run gives does not depend on how busy the machine
 * is; a child that only waits ends after this many times as long. */
enum { WALL_FACTOR = 6 };

enum frame_kind { FRAME_DATA = 1, FRAME_PROGRESS, FRAME_DETAIL, FRAME_FAILED, FRAME_DONE };

typedef struct frame {
  uint32_t kind;
  int32_t value; /* FAILED: the status */
  uint64_t length;
} frame;

enum { BUFFER = 1 << 16, TEXT = 1024 };

/* ---- the child's side ------------------------------------------------------------------- */

struct bwi_child_stream {
  int pipe;
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

static bool put_frame(int pipe, uint32_t kind, int32_t value, const void *bytes, size_t count) {
  frame head = {kind, value, count};
  return put_all(pipe, &head, sizeof head) && put_all(pipe, bytes, count);
}

static bool flush(bwi_child_stream *out) {
  bool good = out->held == 0 || put_frame(out->pipe, FRAME_DATA, 0, out->buffer, out->held);
  out->held = 0;
  return good;
}

bw_status bwi_child_write(bwi_child_stream *out, const void *bytes, size_t count) {
  if (count > BUFFER - out->held && !flush(out))
    return BW_IO;
  if (count > BUFFER)
    return put_frame(out->pipe, FRAME_DATA, 0, bytes, count) ? BW_OK : BW_IO;
  if (count)
    memcpy(out->buffer + out->held, bytes, count);
  out->held += count;
  return BW_OK;
}

typedef struct progress_line {
  double fraction;
  char stage[64];
} progress_line;

static void send_progress(void *data, const char *stage, double fraction) {
  bwi_child_stream *out = (bwi_child_stream *)data;
  progress_line line = {.fraction = fraction};
  snprintf(line.stage, sizeof line.stage, "%s", stage);
  put_frame(out->pipe, FRAME_PROGRESS, 0, &line, sizeof line);
}

typedef struct detail_line {
  char key[64];
  double number;
  bool is_text;
  char text[256];
} detail_line;

static void send_failure(const bw_context *context, bwi_child_stream *out, bw_status status) {
  const char *key, *text;
  double number;
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++) {
    detail_line line = {.number = number, .is_text = text != NULL};
    snprintf(line.key, sizeof line.key, "%s", key);
    snprintf(line.text, sizeof line.text, "%s", text ? text : "");
    put_frame(out->pipe, FRAME_DETAIL, 0, &line, sizeof line);
  }
  const char *message = bw_message(context);
  put_frame(out->pipe, FRAME_FAILED, (int32_t)status, message, strlen(message));
}

/* Bytes of address space in use now. */
static double address_space(void) {
  char text[64] = "";
  int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0)
    return 0;
  ssize_t got = read(file, text, sizeof text - 1);
  close(file);
  double pages = 0;
  for (ssize_t i = 0; i < got && text[i] >= '0' && text[i] <= '9'; i++)
    pages = 10 * pages + (text[i] - '0');
  return pages * (double)sysconf(_SC_PAGESIZE);
}

static void prepare_child(const bwi_child_limits *limits, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGPIPE, SIGALRM};
  for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++)
    signal(fatal[i], SIG_DFL);
  signal(SIGINT, SIG_IGN); /* Ctrl-C reaches the caller, and the caller ends the child */
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);

  int null = open("/dev/null", O_RDWR);
  if (null >= 0)
    for (int k = 0; k < 3; k++)
      dup2(null, k);
  if (pipe > 3)
    close_range(3, (unsigned)pipe - 1, 0);
  close_range((unsigned)pipe + 1, ~0U, 0);

  struct rlimit none_at_all = {0, 0};
  setrlimit(RLIMIT_CORE, &none_at_all);
  double present = address_space();
  if (limits->bytes > 0 && present > 0) {
    struct rlimit space;
    getrlimit(RLIMIT_AS, &space);
    double wanted = present + limits->bytes;
    if (wanted < 9e18 && (space.rlim_cur == RLIM_INFINITY || wanted < (double)space.rlim_cur)) {
      space.rlim_cur = (rlim_t)wanted;
      setrlimit(RLIMIT_AS, &space);
    }
  }
}

static _Noreturn void run_child(const bwi_child_limits *limits, bwi_child_work *work, void *data,
                                int pipe) {
  prepare_child(limits, pipe);
  static bwi_child_stream out; /* too big for a stack of unknown depth; the child is alone */
  out.pipe = pipe;
  out.held = 0;
  bw_fail_allocation(0, false); /* a test's failing allocation concerns the caller alone */
  bw_context *context = bw_context_create();
  if (!context || bw_set_threads(context, 1) != BW_OK) {
    static const char text[] = "no memory for a context in the child process";
    put_frame(pipe, FRAME_FAILED, BW_MEMORY, text, sizeof text - 1);
    _exit(1);
  }
  bw_set_progress(context, send_progress, &out);
  bw_status status = work(context, data, &out);
  if (status != BW_OK)
    send_failure(context, &out, status);
  else if (!flush(&out) || !put_frame(pipe, FRAME_DONE, 0, NULL, 0))
    _exit(1);
  _exit(0);
}

/* ---- the caller's side ------------------------------------------------------------------ */

typedef struct reader {
  unsigned char *bytes; /* DATA payloads so far */
  size_t count, capacity;
  frame head;
  size_t head_held;   /* bytes of the header that have come */
  uint64_t left;      /* bytes of the payload still to come */
  char payload[TEXT]; /* of the small frames */
  size_t payload_held;
  bool ended;
  bw_status status; /* of a FAILED frame */
  int detail_count;
  detail_line detail[8];
} reader;

static void finish_small_frame(bw_context *context, reader *from) {
  switch (from->head.kind) {
  case FRAME_PROGRESS: {
    progress_line line;
    memcpy(&line, from->payload, sizeof line);
    line.stage[sizeof line.stage - 1] = 0;
    bw_progress(context, line.stage, line.fraction);
    break;
  }
  case FRAME_DETAIL:
    if (from->detail_count < 8)
      memcpy(&from->detail[from->detail_count++], from->payload, sizeof(detail_line));
    break;
  case FRAME_FAILED:
    from->status = (bw_status)from->head.value;
    from->ended = true;
    break;
  case FRAME_DONE:
    from->ended = true;
    break;
  default:
    break;
  }
}

/* Take what a read brought. */
static bw_status accept(bw_context *context, reader *from, const unsigned char *at, size_t got) {
  while (got > 0 && !from->ended) {
    if (from->head_held < sizeof from->head) {
      size_t take = sizeof from->head - from->head_held;
      take = take < got ? take : got;
      memcpy((char *)&from->head + from->head_held, at, take);
      from->head_held += take;
      at += take;
      got -= take;
      if (from->head_held < sizeof from->head)
        return BW_OK;
      from->left = from->head.length;
      from->payload_held = 0;
      if (from->head.kind == FRAME_DATA && !bw_grow(context, (void **)&from->bytes, &from->capacity,
                                                    from->count, (size_t)from->left, 1))
        return BW_MEMORY;
    } else {
      size_t take = from->left < got ? (size_t)from->left : got;
      if (from->head.kind == FRAME_DATA) {
        memcpy(from->bytes + from->count, at, take);
        from->count += take;
      } else {
        size_t room = sizeof from->payload - 1 - from->payload_held;
        size_t keep = take < room ? take : room;
        memcpy(from->payload + from->payload_held, at, keep);
        from->payload_held += keep;
        from->payload[from->payload_held] = 0;
      }
      from->left -= take;
      at += take;
      got -= take;
    }
    if (from->head_held == sizeof from->head && from->left == 0) {
      finish_small_frame(context, from);
      from->head_held = 0;
    }
  }
  return BW_OK;
}

static void read_size(double bytes, char text[32]) {
  if (bytes >= 1e9)
    snprintf(text, 32, "%.3g GB", bytes / 1e9);
  else
    snprintf(text, 32, "%.3g MB", bytes / 1e6);
}

static bw_status out_of_memory(bw_context *context, const char *what,
                               const bwi_child_limits *limits) {
  char size[32];
  read_size(limits->bytes, size);
  bw_status status =
      bw_fail(context, BW_LIMIT, "%s needs more than the %s of memory it may use", what, size);
  bw_detail_text(context, "limit", "memory");
  bw_detail_number(context, "bytes", limits->bytes);
  return status;
}

/* The work ended by itself in a failure: say it in the caller's context. */
static bw_status pass_failure_on(bw_context *context, const char *what,
                                 const bwi_child_limits *limits, const reader *from) {
  if (from->status == BW_MEMORY && limits->bytes > 0)
    return out_of_memory(context, what, limits);
  bw_status status = from->status;
  if (from->payload_held)
    bw_fail(context, status, "%s", from->payload);
  else
    bw_fail(context, status, "%s failed (%s)", what, bw_status_word(status));
  for (int i = 0; i < from->detail_count; i++)
    if (from->detail[i].is_text)
      bw_detail_text(context, from->detail[i].key, from->detail[i].text);
    else
      bw_detail_number(context, from->detail[i].key, from->detail[i].number);
  return status;
}

static bw_status crashed(bw_context *context, const char *what, const bwi_child_limits *limits,
                         int how) {
  int number = WIFSIGNALED(how) ? WTERMSIG(how) : 0;
  if (number == SIGKILL && limits->bytes > 0) /* the system's out-of-memory killer */
    return out_of_memory(context, what, limits);
  bw_status status;
  if (number)
    status = bw_fail(context, BW_GEOMETRY, "%s broke off: the library stopped with signal %d (%s)",
                     what, number, strsignal(number));
  else
    status = bw_fail(context, BW_GEOMETRY, "%s broke off: the library ended the process", what);
  bw_detail_number(context, "signal", number);
  return status;
}

static void end_child(pid_t child, int *how) {
  while (waitpid(child, how, 0) < 0 && errno == EINTR)
    ;
}

/* Seconds that a process has computed; 0 when that cannot be said. */
static double seconds_of(pid_t process) {
  clockid_t clock;
  struct timespec spent;
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &spent) != 0)
    return 0;
  return (double)spent.tv_sec + 1e-9 * (double)spent.tv_nsec;
}

bw_status bwi_child_run(bw_context *context, const char *what, const bwi_child_limits *limits,
                        bwi_child_work *work, void *data, unsigned char **bytes, size_t *count) {
  static const bwi_child_limits no_limits = {0, 0};
  limits = limits ? limits : &no_limits;
  reader from = {.status = BW_OK};
  unsigned char *chunk = NULL;
  int ends[2], how = 0;
  bw_status status = bw_check_cancel(context);
  if (status != BW_OK)
    return status;
  if (pipe2(ends, O_CLOEXEC) != 0)
    return bw_fail(context, BW_LIMIT, "%s: no pipe for a child process (%s)", what,
                   strerror(errno));
  pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(limits, work, data, ends[1]);
  }
  int why = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return bw_fail(context, BW_MEMORY, "%s: no child process (%s)", what, strerror(why));
  }

  bool running = true;
  double start = bw_seconds();
  chunk = BW_NEW(context, unsigned char, 1 << 20);
  if (!chunk) {
    status = BW_MEMORY;
    goto done;
  }
  while (!from.ended) {
    if (bw_cancelled(context)) {
      status = bw_check_cancel(context);
      goto done;
    }
    if (limits->seconds > 0 && (seconds_of(child) > limits->seconds ||
                                bw_seconds() - start > WALL_FACTOR * limits->seconds)) {
      status = bw_fail(context, BW_LIMIT, "%s took more than the %.3g seconds it may use", what,
                       limits->seconds);
      bw_detail_text(context, "limit", "time");
      bw_detail_number(context, "seconds", limits->seconds);
      goto done;
    }
    struct pollfd wait = {ends[0], POLLIN, 0};
    int ready = poll(&wait, 1, 20);
    if (ready == 0 || (ready < 0 && errno == EINTR)) {
      /* Silence: has the child gone while somebody else holds its end of the pipe? Once it is
       * known to be gone and nothing is left to read, that was all. */
      if (!running)
        break;
      if (ready == 0 && waitpid(child, &how, WNOHANG) != 0)
        running = false;
      continue;
    }
    ssize_t got = read(ends[0], chunk, 1 << 20);
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      break;
    BW_TRY(accept(context, &from, chunk, (size_t)got));
  }
  if (running) {
    end_child(child, &how);
    running = false;
  }
  if (!from.ended)
    status = crashed(context, what, limits, how);
  else if (from.status != BW_OK)
    status = pass_failure_on(context, what, limits, &from);
  if (status == BW_OK) {
    if (!from.bytes) {
      from.bytes = BW_NEW(context, unsigned char, 0);
      if (!from.bytes) {
        status = BW_MEMORY;
        goto done;
      }
    }
    *bytes = from.bytes;
    *count = from.count;
    from.bytes = NULL;
  }
done:
  if (running) {
    kill(child, SIGKILL);
    end_child(child, &how);
  }
  close(ends[0]);
  bw_free(chunk);
  bw_free(from.bytes);
  return status;
}
