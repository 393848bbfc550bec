/* Jobs: many at a time, their limits, their ends, what they leave behind. */
#include "check.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/job.h"

static int open_files(void) {
  int count = 0;
  DIR *folder = opendir("/proc/self/fd");
  while (readdir(folder))
    count++;
  closedir(folder);
  return count;
}

static bw_job *start(bw_context *context, bw_job_options options, bw_job_work *work, void *data) {
  bw_job *job = NULL;
  check_ok(context, bw_job_start(context, &options, work, data, &job));
  return job;
}

static void wait_for(bw_context *context, bw_job *job) {
  int which = -2;
  check_ok(context, bw_jobs_wait(context, 1, &job, INFINITY, &which));
  assert_int_equal(which, 0);
}

static bw_job_state state_of(const bw_job *job) {
  bw_job_usage usage;
  bw_job_read_usage(job, &usage);
  return usage.state;
}

/* ---- results --------------------------------------------------------------------------------- */

static bw_status square(bw_context *context, void *data, bw_job_stream *out) {
  int64_t n = *(int *)data;
  (void)context;
  usleep((useconds_t)(1000 * (7 * n % 5)));
  n *= n;
  return bw_job_write(out, &n, sizeof n);
}

static void test_many_at_a_time(void **state) {
  enum { MANY = 40 };
  bw_context *context = check_context(state);
  bw_job *jobs[MANY];
  int number[MANY], before = open_files();
  for (int i = 0; i < MANY; i++) {
    number[i] = i;
    jobs[i] = start(context, (bw_job_options){.name = "square"}, square, &number[i]);
  }
  for (int left = MANY; left > 0; left--) {
    int which = -1;
    const unsigned char *bytes;
    size_t count;
    int64_t value;
    check_ok(context, bw_jobs_wait(context, left, jobs, INFINITY, &which));
    check_ok(context, bw_job_result(context, jobs[which], &bytes, &count));
    assert_int_equal(count, sizeof value);
    memcpy(&value, bytes, sizeof value);
    assert_int_equal(value, (int64_t)number[which] * number[which]);
    bw_release(jobs[which]);
    jobs[which] = jobs[left - 1];
    number[which] = number[left - 1];
  }
  assert_int_equal(open_files(), before);
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* none is left to collect */
}

static bw_status large(bw_context *context, void *data, bw_job_stream *out) {
  (void)context;
  size_t size = *(size_t *)data;
  unsigned char *block = BW_NEW(context, unsigned char, size);
  if (!block)
    return BW_MEMORY;
  for (size_t i = 0; i < size; i++)
    block[i] = (unsigned char)(i * 7 + (i >> 12));
  return bw_job_write(out, block, size);
}

/* Two results that fill their pipes at the same time, in either order. */
static void test_large_results(void **state) {
  bw_context *context = check_context(state);
  size_t size = (size_t)20 << 20;
  bw_job *jobs[2];
  for (int i = 0; i < 2; i++)
    jobs[i] = start(context, (bw_job_options){0}, large, &size);
  for (int i = 1; i >= 0; i--) {
    const unsigned char *bytes;
    size_t count;
    wait_for(context, jobs[i]);
    check_ok(context, bw_job_result(context, jobs[i], &bytes, &count));
    assert_int_equal(count, size);
    for (size_t k = 0; k < size; k += 997)
      assert_int_equal(bytes[k], (unsigned char)(k * 7 + (k >> 12)));
    bw_release(jobs[i]);
  }
}

/* ---- ends ------------------------------------------------------------------------------------ */

enum way { SLEEP, SPIN, EAT, SEGFAULT, LEAVE, KILLED, SHELL, WRITE };

static bw_status misbehave(bw_context *context, void *data, bw_job_stream *out) {
  static volatile int sink;
  int *volatile nowhere = NULL;
  (void)out;
  switch (*(enum way *)data) {
  case SLEEP:
    sleep(1000);
    break;
  case SPIN:
    for (;;)
      sink++;
  case EAT:
    for (;;) {
      char *block = BW_NEW(context, char, (size_t)1 << 24);
      if (!block)
        return BW_MEMORY;
      memset(block, 1, 4096);
    }
  case SEGFAULT:
    sink = *nowhere;
    break;
  case LEAVE:
    _exit(3);
  case KILLED:
    raise(SIGKILL);
    break;
  case WRITE: {
    FILE *file = tmpfile();
    for (int i = 0; i < 4096; i++)
      if (fputs("more and more and more", file) < 0)
        return bw_fail(context, BW_IO, "trial 7: %s", strerror(errno));
    return BW_OK;
  }
  case SHELL:
    return system("sleep 1000 & echo $! > $PID_FILE; wait") == 0 ? BW_OK : BW_IO;
  }
  return BW_OK;
}

static void check_end(bw_context *context, bw_job_options options, enum way way,
                      bw_job_state expected, bw_status status, const char *text) {
  const unsigned char *bytes;
  size_t count;
  options.name = "trial 7";
  bw_job *job = start(context, options, misbehave, &way);
  wait_for(context, job);
  check_fails(context, status, text, bw_job_result(context, job, &bytes, &count));
  check_fails(context, status, "trial 7", bw_job_result(context, job, &bytes, &count));
  assert_int_equal(state_of(job), expected);
  bw_release(job);
}

static void test_ends(void **state) {
  bw_context *context = check_context(state);
  check_end(context, (bw_job_options){.seconds = 0.2}, SLEEP, BW_JOB_OUT_OF_TIME, BW_LIMIT,
            "0.2 seconds it may use");
  check_end(context, (bw_job_options){.processor_seconds = 0.1, .seconds = 600}, SPIN,
            BW_JOB_OUT_OF_TIME, BW_LIMIT, "0.1 seconds of computing");
  check_end(context, (bw_job_options){0}, LEAVE, BW_JOB_CRASHED, BW_INTERNAL, "exit code 3");
  check_end(context, (bw_job_options){0}, KILLED, BW_JOB_CRASHED, BW_INTERNAL, "was killed");
  /* by the system, where it held much of what it may; else by somebody */
  check_end(context, (bw_job_options){.bytes = 3e6}, KILLED, BW_JOB_OUT_OF_MEMORY, BW_LIMIT,
            "3 MB");
  check_end(context, (bw_job_options){.bytes = 1e10}, KILLED, BW_JOB_CRASHED, BW_INTERNAL,
            "was killed");
#ifndef __SANITIZE_ADDRESS__ /* it reports and leaves in its own way */
  check_end(context, (bw_job_options){0}, SEGFAULT, BW_JOB_CRASHED, BW_INTERNAL, "signal 11");
  check_end(context, (bw_job_options){.bytes = 3e8}, EAT, BW_JOB_OUT_OF_MEMORY, BW_LIMIT, "300 MB");
#endif
}

/* Limits of the starter hold for its jobs, and it is theirs that are named. */
static void test_limits_of_the_starter(void **state) {
  bw_context *context = check_context(state);
  struct rlimit before, limit;
  getrlimit(RLIMIT_FSIZE, &before);
  limit = before;
  limit.rlim_cur = 20000;
  setrlimit(RLIMIT_FSIZE, &limit);
  check_end(context, (bw_job_options){0}, WRITE, BW_JOB_FAILED, BW_IO, "File too large");
  setrlimit(RLIMIT_FSIZE, &before);
#ifndef __SANITIZE_ADDRESS__ /* it takes all addresses */
  getrlimit(RLIMIT_AS, &before);
  limit = before;
  limit.rlim_cur = (rlim_t)(bwi_address_space() + 4e8);
  setrlimit(RLIMIT_AS, &limit);
  bw_job_options options = {.bytes = 6e9, .name = "trial 7"};
  enum way way = EAT;
  const unsigned char *bytes;
  size_t count;
  bw_job *job = start(context, options, misbehave, &way);
  wait_for(context, job);
  check_fails(context, BW_LIMIT, " MB of memory", bw_job_result(context, job, &bytes, &count));
  const char *key, *text;
  double value = 0;
  for (int i = 0; bw_detail(context, i, &key, &value, &text) && strcmp(key, "bytes") != 0; i++)
    ;
  assert_true(value > 1e8 && value <= 4e8);
  bw_release(job);
  setrlimit(RLIMIT_AS, &before);
#endif
}

/* The limit acts by itself, while nobody waits. */
static void test_limit_without_waiting(void **state) {
  bw_context *context = check_context(state);
  enum way way = SPIN;
  const unsigned char *bytes;
  size_t count;
  bw_job *job = start(context, (bw_job_options){.seconds = 0.1}, misbehave, &way);
  siginfo_t info;
  assert_int_equal(waitid(P_ALL, 0, &info, WEXITED | WNOWAIT), 0);
  int which = -1;
  check_ok(context, bw_jobs_wait(context, 1, &job, 0, &which));
  assert_int_equal(which, 0);
  check_fails(context, BW_LIMIT, "0.1 seconds", bw_job_result(context, job, &bytes, &count));
  bw_release(job);
}

static void test_waiting(void **state) {
  bw_context *context = check_context(state);
  enum way way = SLEEP;
  const unsigned char *bytes;
  size_t count;
  int which = -2;
  bw_job *job = start(context, (bw_job_options){.name = "sleeper"}, misbehave, &way);
  check_ok(context, bw_jobs_wait(context, 1, &job, 0.03, &which));
  assert_int_equal(which, -1);
  check_ok(context, bw_jobs_wait(context, 0, NULL, INFINITY, &which));
  assert_int_equal(which, -1);
  check_fails(context, BW_INVALID, "is running", bw_job_result(context, job, &bytes, &count));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "", bw_jobs_wait(context, 1, &job, 100, &which));
  bw_clear_cancel(context);
  assert_int_equal(state_of(job), BW_JOB_RUNNING);
  bw_job_cancel(job);
  bw_job_cancel(job);
  check_ok(context, bw_jobs_wait(context, 1, &job, INFINITY, &which));
  check_fails(context, BW_CANCELLED, "sleeper", bw_job_result(context, job, &bytes, &count));
  bw_release(job);
  job = start(context, (bw_job_options){0}, misbehave, &way);
  bw_release(job); /* ends it */
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

/* Whether a process that is to end does not, in a minute. */
static bool is_alive(pid_t process) {
  for (int i = 0; i < 6000; i++) {
    char path[64], text[256] = "";
    snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
    FILE *file = fopen(path, "r");
    bool alive = file && fgets(text, sizeof text, file) && !strstr(text, ") Z ");
    if (file)
      fclose(file);
    if (!alive)
      return false;
    usleep(10000);
  }
  return true;
}

static pid_t read_pid(const char *path) {
  int number = 0;
  for (int i = 0; i < 6000 && number == 0; i++) {
    FILE *file = fopen(path, "r");
    if (file && fscanf(file, "%d", &number) != 1)
      number = 0;
    if (file)
      fclose(file);
    if (number == 0)
      usleep(10000);
  }
  assert_true(number > 1);
  return number;
}

/* What a job started goes with it. */
static void test_group(void **state) {
  bw_context *context = check_context(state);
  char path[] = "/tmp/barwright_job_XXXXXX";
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  setenv("PID_FILE", path, 1);
  enum way way = SHELL;
  bw_job *job = start(context, (bw_job_options){0}, misbehave, &way);
  pid_t sleeper = read_pid(path);
  bw_job_cancel(job);
  bw_release(job);
  assert_false(is_alive(sleeper));
  unlink(path);
}

static bw_status say_number_and_sleep(bw_context *context, void *data, bw_job_stream *out) {
  (void)context;
  (void)out;
  FILE *file = fopen((const char *)data, "w");
  fprintf(file, "%d\n", (int)getpid());
  fclose(file);
  sleep(1000);
  return BW_OK;
}

/* A job dies with the process that started it, however that ends. */
static void test_dies_with_the_starter(void **state) {
  bw_context *context = check_context(state);
  char path[] = "/tmp/barwright_job_XXXXXX";
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  pid_t starter = fork();
  if (starter == 0) {
    bw_job *job = NULL;
    if (bw_job_start(context, NULL, say_number_and_sleep, path, &job) == BW_OK)
      sleep(1000);
    _exit(1);
  }
  pid_t child = read_pid(path);
  kill(starter, SIGKILL);
  waitpid(starter, NULL, 0);
  assert_false(is_alive(child));
  unlink(path);
}

/* ---- what the child sees --------------------------------------------------------------------- */

static bw_status sum_chunk(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    ((double *)data)[i] += (double)i;
  return BW_OK;
}

static bw_status use_threads(bw_context *context, void *data, bw_job_stream *out) {
  (void)out;
  if (bw_threads(context) != 1 || bw_cancelled(context) || bw_message(context)[0] ||
      bw_warning_at(context, 0))
    return bw_fail(context, BW_INTERNAL, "the context is not fit for a child");
  bw_status status = bw_parallel(context, 1000, 10, sum_chunk, data);
  if (status == BW_OK)
    status = bw_set_threads(context, 3); /* and it may have threads of its own */
  if (status == BW_OK)
    status = bw_parallel(context, 1000, 10, sum_chunk, data);
  return status;
}

static void test_threads_after_the_fork(void **state) {
  bw_context *context = check_context(state);
  static double sums[1000];
  const unsigned char *bytes;
  size_t count;
  check_ok(context, bw_set_threads(context, 4));
  for (int i = 0; i < 5; i++) {
    check_ok(context, bw_parallel(context, 1000, 10, sum_chunk, sums));
    bw_warn(context, "a warning");
    bw_fail(context, BW_IO, "a failure");
    bw_job *job = start(context, (bw_job_options){.seconds = 600}, use_threads, sums);
    wait_for(context, job);
    check_ok(context, bw_job_result(context, job, &bytes, &count));
    bw_release(job);
  }
  check_near(sums[999], 5 * 999, 0); /* the child's sums stayed there */
  assert_int_equal(bw_threads(context), 4);
}

static bw_status print(bw_context *context, void *data, bw_job_stream *out) {
  (void)data;
  (void)out;
  printf("to standard output\n");
  fprintf(stderr, "to standard error\n");
  bw_progress(context, "printing", 0.5);
  return getchar() == EOF ? BW_OK : BW_IO;
}

static void test_output(void **state) {
  bw_context *context = check_context(state);
  char path[] = "/tmp/barwright_job_XXXXXX", text[200] = "";
  int file = mkstemp(path);
  assert_true(file >= 0);
  printf("# "); /* buffered here: not to be written by the child too */
  bw_job *job = start(context, (bw_job_options){.output = path}, print, NULL);
  wait_for(context, job);
  ssize_t got = read(file, text, sizeof text - 1);
  assert_true(got > 0);
  if (strncmp(text, "to standard e", 13) == 0) /* in either order: only one is buffered */
    assert_string_equal(text, "to standard error\nto standard output\n");
  else
    assert_string_equal(text, "to standard output\nto standard error\n");
  bw_job_usage usage;
  bw_job_read_usage(job, &usage);
  assert_string_equal(usage.stage, "printing");
  check_near(usage.fraction, 0.5, 0);
  bw_release(job);
  close(file);
  unlink(path);
  bw_job_options nowhere = {.output = "/no/such/folder/file"};
  check_fails(context, BW_IO, "/no/such/folder/file",
              bw_job_start(context, &nowhere, print, NULL, &job));
}

static bw_status use_up(bw_context *context, void *data, bw_job_stream *out) {
  (void)data;
  (void)out;
  size_t size = (size_t)64 << 20;
  char *block = BW_NEW(context, char, size);
  if (!block)
    return BW_MEMORY;
  memset(block, 1, size);
  volatile double x = 0;
  while (clock() < CLOCKS_PER_SEC / 10)
    x += block[(size_t)x % size];
  bw_free(block);
  return BW_OK;
}

static void test_usage(void **state) {
  bw_context *context = check_context(state);
  bw_job_usage usage;
  bw_job *job = start(context, (bw_job_options){0}, use_up, NULL);
  bw_job_read_usage(job, &usage);
  assert_int_equal(usage.state, BW_JOB_RUNNING);
  wait_for(context, job);
  bw_job_read_usage(job, &usage);
  assert_true(usage.processor_seconds > 0.09);
  assert_true(usage.seconds > 0.9 * usage.processor_seconds);
  assert_true(usage.peak_bytes > 64e6 && usage.peak_bytes < 2e9);
  bw_release(job);
}

/* A job may start jobs, and has no right to those of its starter. */
static bw_status nested(bw_context *context, void *data, bw_job_stream *out) {
  bw_job *job = NULL, *elder = *(bw_job **)data;
  int n = 9, which;
  const unsigned char *bytes;
  size_t count;
  bw_job_cancel(elder);
  bw_status status = bw_jobs_wait(context, 1, &elder, 0, &which);
  if (status != BW_INVALID)
    return bw_fail(context, BW_INTERNAL, "waited for a job of the starter");
  bw_release(elder);
  BW_TRY(bw_job_start(context, NULL, square, &n, &job));
  BW_TRY(bw_jobs_wait(context, 1, &job, INFINITY, &which));
  BW_TRY(bw_job_result(context, job, &bytes, &count));
  status = bw_job_write(out, bytes, count);
done:
  bw_release(job);
  return status;
}

static void test_nested(void **state) {
  bw_context *context = check_context(state);
  enum way way = SLEEP;
  bw_job *elder = start(context, (bw_job_options){.name = "elder"}, misbehave, &way);
  bw_job *job = start(context, (bw_job_options){0}, nested, &elder);
  const unsigned char *bytes;
  size_t count;
  int64_t value;
  wait_for(context, job);
  check_ok(context, bw_job_result(context, job, &bytes, &count));
  memcpy(&value, bytes, sizeof value);
  assert_int_equal(value, 81);
  int which;
  check_ok(context, bw_jobs_wait(context, 1, &elder, 0, &which));
  assert_int_equal(which, -1); /* it lives */
  bw_release(job);
  bw_release(elder);
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_status status = BW_MEMORY;
  int n = 0, number = 5, before = open_files();
  while (status != BW_OK) {
    bw_job *job = NULL;
    const unsigned char *bytes;
    size_t count;
    int which;
    assert_true(++n < 50);
    bw_fail_allocation(n, true);
    BW_TRY(bw_job_start(context, NULL, square, &number, &job));
    BW_TRY(bw_jobs_wait(context, 1, &job, INFINITY, &which));
    status = bw_job_result(context, job, &bytes, &count);
  done:
    bw_fail_allocation(0, false);
    bw_release(job);
    assert_true(status == BW_OK || status == BW_MEMORY);
  }
  assert_true(n > 2);
  assert_int_equal(open_files(), before);
}

static bw_status nothing(bw_context *context, void *data, bw_job_stream *out) {
  (void)context;
  (void)data;
  (void)out;
  return BW_OK;
}

static void test_in_a_row(void **state) {
  bw_context *context = check_context(state);
  int many = getenv("BARWRIGHT_FULL") ? 10000 : 300, before = open_files();
  int64_t blocks = bw_live_blocks();
  double start_time = bw_seconds();
  for (int i = 0; i < many; i++) {
    bw_job *job = start(context, (bw_job_options){0}, nothing, NULL);
    wait_for(context, job);
    assert_int_equal(state_of(job), BW_JOB_DONE);
    bw_release(job);
  }
  printf("%d jobs in a row: %.3f ms each\n", many, 1e3 * (bw_seconds() - start_time) / many);
  assert_int_equal(open_files(), before);
  assert_int_equal(bw_live_blocks(), blocks);
}

check_main(check_test(test_many_at_a_time), check_test(test_large_results), check_test(test_ends),
           check_test(test_limit_without_waiting), check_test(test_limits_of_the_starter),
           check_test(test_waiting), check_test(test_group), check_test(test_dies_with_the_starter),
           check_test(test_threads_after_the_fork), check_test(test_output), check_test(test_usage),
           check_test(test_nested), check_test(test_allocation_failures), check_test(test_in_a_row))
