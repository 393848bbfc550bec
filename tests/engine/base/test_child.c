/* Work in a child process: whatever happens there, the caller gets a status and a message. */
#include "check.h"

#include <unistd.h>

#include "base/child.h"

static bw_status write_numbers(bw_context *context, void *data, bwi_child_stream *out) {
  bw_status status = BW_OK;
  int count = *(const int *)data;
  for (int i = 0; i < count; i++) {
    BW_TRY(bwi_child_write(out, &i, sizeof i));
    if (i % 100000 == 0)
      bw_progress(context, "counting", (double)i / count);
  }
done:
  return status;
}

/* A child whose pipe is full leaves progress out, so that their number is not known. */
static void note_progress(void *data, const char *stage, double fraction) {
  double *last = (double *)data;
  assert_string_equal(stage, "counting");
  assert_true(fraction > *last && fraction < 1);
  *last = fraction;
}

static void test_bytes_come_back(void **state) {
  bw_context *context = check_context(state);
  unsigned char *bytes = NULL;
  size_t count = 0;
  int wanted = 1000000;
  double last = -1;
  bw_set_progress(context, note_progress, &last);
  check_ok(context,
           bwi_child_run(context, "counting", NULL, write_numbers, &wanted, &bytes, &count));
  assert_int_equal(count, wanted * sizeof(int));
  for (int i = 0; i < wanted; i++) {
    int value;
    memcpy(&value, bytes + (size_t)i * sizeof value, sizeof value);
    assert_int_equal(value, i);
  }
  assert_true(last >= 0); /* the first finds an empty pipe */
  bw_set_progress(context, NULL, NULL);
  bw_free(bytes);
  wanted = 0;
  check_ok(context,
           bwi_child_run(context, "counting", NULL, write_numbers, &wanted, &bytes, &count));
  assert_int_equal(count, 0);
  bw_free(bytes);
}

void openblas_set_num_threads(int);
int openblas_get_num_threads(void);

static bw_status write_threads(bw_context *context, void *data, bwi_child_stream *out) {
  int threads = openblas_get_num_threads();
  (void)context;
  (void)data;
  return bwi_child_write(out, &threads, sizeof threads);
}

/* One thread in the child, and here as many as before. */
static void test_threads_of_others(void **state) {
  bw_context *context = check_context(state);
  unsigned char *bytes = NULL;
  size_t count = 0;
  int before = openblas_get_num_threads(), there = 0;
  openblas_set_num_threads(3);
  check_ok(context, bwi_child_run(context, "asking", NULL, write_threads, NULL, &bytes, &count));
  assert_int_equal(openblas_get_num_threads(), 3);
  assert_int_equal(count, sizeof there);
  memcpy(&there, bytes, sizeof there);
  assert_int_equal(there, 1);
  bw_free(bytes);
  openblas_set_num_threads(before);
}

enum way { FAIL, ABORT, SEGFAULT, LEAVE, HANG, EAT, KEEP };

static bw_status misbehave(bw_context *context, void *data, bwi_child_stream *out) {
  static volatile int sink;
  int *volatile nowhere = NULL;
  (void)out;
  switch (*(enum way *)data) {
  case FAIL: {
    bw_status status = bw_fail(context, BW_FORMAT, "byte 17 is odd");
    bw_detail_number(context, "byte", 17);
    bw_detail_text(context, "file", "a.stl");
    return status;
  }
  case ABORT:
    printf("noise that nobody hears\n");
    abort();
  case SEGFAULT:
    sink = *nowhere;
    break;
  case LEAVE:
    exit(3);
  case HANG:
    for (;;)
      sink++;
  case EAT:
    for (size_t i = 0; i < 4096; i++) {
      char *block = BW_NEW(context, char, (size_t)1 << 24);
      if (!block)
        return BW_MEMORY;
      memset(block, 1, 4096);
    }
    break;
  case KEEP:
    break;
  }
  return BW_OK;
}

static void test_failures_are_reported(void **state) {
  bw_context *context = check_context(state);
  unsigned char *bytes = NULL;
  size_t count = 0;
  const bwi_child_limits none = {.seconds = 600, .bytes = 1e12},
                         seconds = {.seconds = 0.2, .bytes = 1e12};
  enum way way = FAIL;
  check_fails(context, BW_FORMAT, "byte 17 is odd",
              bwi_child_run(context, "work", &none, misbehave, &way, &bytes, &count));
  const char *key, *text;
  double number;
  assert_true(bw_detail(context, 0, &key, &number, &text));
  assert_string_equal(key, "byte");
  check_near(number, 17, 0);
  assert_true(bw_detail(context, 1, &key, &number, &text));
  assert_string_equal(text, "a.stl");
  way = ABORT;
  check_fails(context, BW_GEOMETRY, "signal 6",
              bwi_child_run(context, "work", NULL, misbehave, &way, &bytes, &count));
#ifndef __SANITIZE_ADDRESS__ /* it reports and leaves in its own way */
  way = SEGFAULT;
  check_fails(context, BW_GEOMETRY, "signal 11",
              bwi_child_run(context, "work", NULL, misbehave, &way, &bytes, &count));
  const bwi_child_limits memory = {.seconds = 600, .bytes = 3e8};
  way = EAT;
  check_fails(context, BW_LIMIT, "300 MB of memory",
              bwi_child_run(context, "work", &memory, misbehave, &way, &bytes, &count));
#endif
  way = LEAVE;
  check_fails(context, BW_GEOMETRY, "ended the process",
              bwi_child_run(context, "work", NULL, misbehave, &way, &bytes, &count));
  way = HANG;
  /* 0.2 of computing, or on a busy machine 1.2 in all */
  check_fails(context, BW_LIMIT, "2 seconds",
              bwi_child_run(context, "work", &seconds, misbehave, &way, &bytes, &count));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "",
              bwi_child_run(context, "work", NULL, misbehave, &way, &bytes, &count));
  bw_clear_cancel(context);
}

static void cancel_soon(void *data, const char *stage, double fraction) {
  (void)stage;
  (void)fraction;
  bw_cancel((bw_context *)data);
}

static bw_status report_and_hang(bw_context *context, void *data, bwi_child_stream *out) {
  (void)out;
  bw_progress(context, "hanging", 0.5);
  return misbehave(context, data, out);
}

static void test_cancel_ends_the_child(void **state) {
  bw_context *context = check_context(state);
  unsigned char *bytes = NULL;
  size_t count = 0;
  enum way way = HANG;
  bw_set_progress(context, cancel_soon, context);
  check_fails(context, BW_CANCELLED, "",
              bwi_child_run(context, "work", NULL, report_and_hang, &way, &bytes, &count));
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  unsigned char *bytes = NULL;
  size_t count = 0;
  int wanted = 100000;
  check_each_allocation(context, status, 2) {
    status = bwi_child_run(context, "counting", NULL, write_numbers, &wanted, &bytes, &count);
  }
  bw_free(bytes);
}

check_main(check_test(test_bytes_come_back), check_test(test_threads_of_others),
           check_test(test_failures_are_reported), check_test(test_cancel_ends_the_child),
           check_test(test_allocation_failures))
