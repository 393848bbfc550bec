/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Messages and details, memory, arrays, threads, tensors, SHA-256. */
#include "check.h"

#include "base/warning.h"

#include <sched.h>
#include <sys/stat.h>

static void test_messages(void **state) {
  bw_context *context = check_context(state);
  assert_string_equal(bw_message(context), "");
  assert_int_equal(bw_fail(context, BW_FORMAT, "%s: line %d", "a.stl", 7), BW_FORMAT);
  bw_detail_text(context, "file", "a.stl");
  bw_detail_number(context, "line", 6);
  bw_detail_number(context, "line", 7);
  /* The present message may be part of the next one. */
  bw_fail(context, BW_IO, "while reading: %s", bw_message(context));
  assert_string_equal(bw_message(context), "while reading: a.stl: line 7");
  bw_detail_number(context, "line", 7);
  bw_detail_text(context, "file", "a.stl");
  const char *key, *text;
  double number;
  assert_true(bw_detail(context, 0, &key, &number, &text));
  assert_string_equal(key, "line");
  assert_null(text);
  check_near(number, 7, 0);
  assert_true(bw_detail(context, 1, &key, &number, &text));
  assert_string_equal(text, "a.stl");
  assert_false(bw_detail(context, 2, &key, &number, &text));
  bw_warn(context, "one");
  bw_warn(context, "two");
  assert_string_equal(bw_warning_at(context, 1), "two");
  /* No warning is given twice, and of equal ones only that of the largest value. */
  static const double moved[] = {2, 5, 3};
  for (int i = 0; i < 3; i++)
    bwi_warn_largest(context, moved[i], "moved by %g m", moved[i]);
  bw_warn(context, "two");
  assert_string_equal(bw_warning_at(context, 2), "moved by 5 m");
  assert_null(bw_warning_at(context, 3));
  bw_clear_warnings(context);
  bw_warn(context, "one");
  bw_warn(context, "two");
  assert_null(bw_warning_at(context, 2));
  for (int status = BW_BROKEN; status <= BW_INTERNAL; status++)
    assert_string_not_equal(bw_status_word((bw_status)status), "unknown");
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  assert_null(bw_alloc(context, SIZE_MAX / 4, 8));
  assert_non_null(strstr(bw_message(context), "out of memory"));
  bw_fail_allocation(2, false);
  void *first = bw_alloc(context, 1, 8);
  assert_non_null(first);
  assert_null(bw_alloc(context, 1, 8));
  void *third = bw_calloc(context, 0, 8);
  assert_non_null(third);
  bw_fail_allocation(1, true);
  assert_null(bw_resize(context, first, 100, 8));
  assert_null(bw_alloc(context, 1, 1));
  bw_fail_allocation(0, false);
  bw_free(first);
  bw_free(third);
  int *list = NULL;
  size_t capacity = 0, count = 0;
  for (int i = 0; i < 1000; i++) {
    assert_true(bw_grow(context, (void **)&list, &capacity, count, 1, sizeof *list));
    list[count++] = i;
  }
  assert_int_equal(list[999], 999);
  bw_free(list);
}

static void test_arrays(void **state) {
  bw_context *context = check_context(state);
  bw_array *array, *view, *again;
  check_ok(context, bw_array_create(context, BW_F64, 4, 3, &array));
  for (int i = 0; i < 12; i++)
    ((double *)array->data)[i] = i;
  check_ok(context, bw_array_view(context, array, 3, 4, -1, 1, 2, 1, &view));
  check_near(bw_array_get(view, 0, 0), 10, 0);
  check_near(bw_array_get(view, 3, 1), 2, 0);
  check_ok(context, bw_array_view(context, view, 0, 2, 2, 1, 1, 1, &again));
  check_near(bw_array_get(again, 1, 0), 5, 0);
  bw_release(array);
  bw_release(view);
  check_near(bw_array_get(again, 0, 0), 11, 0); /* the owner lives as long as a view does */
  check_fails(context, BW_INVALID, "does not fit",
              bw_array_view(context, again, 0, 3, 1, 0, 1, 1, &view));
  check_fails(context, BW_INVALID, "does not fit",
              bw_array_view(context, again, 1, 2, INT64_MAX, 0, 1, 1, &view));
  bw_release(again);
  /* The step to a second row that there is not. */
  check_ok(context, bw_array_create(context, BW_F64, 2, 2, &array));
  check_ok(context, bw_array_view(context, array, 1, 1, INT64_MAX, 1, 1, INT64_MIN, &view));
  check_near(bw_array_get(view, 0, 0), 0, 0);
  bw_release(array);
  bw_release(view);
  check_fails(context, BW_INVALID, "sizes", bw_array_create(context, BW_F64, -1, 3, &array));
}

typedef struct sum {
  double part[64];
} sum;

static bw_status sum_chunk(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  double total = 0;
  for (int64_t i = begin; i < end; i++)
    total += 1.0 / (double)(i + 1);
  ((sum *)data)->part[begin / 100] = total;
  return BW_OK;
}

typedef struct failing {
  bw_context *context;
  bool wait;
  int recorded; /* chunk 7 has recorded its failure; atomic */
} failing;

/* Chunk 3 returns its failure after chunk 7 has recorded another one. */
static bw_status fail_chunk(void *data, int64_t begin, int64_t end, int worker) {
  failing *it = data;
  (void)end;
  (void)worker;
  if (begin == 7) {
    bw_fail(it->context, BW_IO, "chunk seven");
    bw_detail_number(it->context, "seven", 7);
    __atomic_store_n(&it->recorded, 1, __ATOMIC_RELEASE);
    return BW_IO;
  }
  if (begin != 3)
    return BW_OK;
  bw_fail(it->context, BW_FORMAT, "chunk three");
  bw_detail_number(it->context, "three", 3);
  double start = bw_seconds();
  while (it->wait && !__atomic_load_n(&it->recorded, __ATOMIC_ACQUIRE) && bw_seconds() < start + 20)
    sched_yield();
  return BW_FORMAT;
}

static void test_threads(void **state) {
  bw_context *context = check_context(state);
  sum first;
  for (int threads = 1; threads <= 5; threads++) {
    sum now = {{0}};
    check_ok(context, bw_set_threads(context, threads));
    for (int round = 0; round < 50; round++)
      check_ok(context, bw_parallel(context, 6400, 100, sum_chunk, &now));
    if (threads == 1)
      first = now;
    assert_memory_equal(&first, &now, sizeof now);
    /* status, message and details are those of the failing chunk with the lowest number */
    failing it = {context, threads > 1, 0};
    const char *key, *text;
    double number;
    check_fails(context, BW_FORMAT, "chunk three", bw_parallel(context, 10, 1, fail_chunk, &it));
    assert_true(bw_detail(context, 0, &key, &number, &text));
    assert_string_equal(key, "three");
    assert_false(bw_detail(context, 1, &key, &number, &text));
    bw_clear_failure(context);
    bw_fail(context, BW_IO, "recorded after the loop");
    assert_string_equal(bw_message(context), "recorded after the loop");
  }
  check_fails(context, BW_INVALID, "0 threads", bw_set_threads(context, 0));
  check_fails(context, BW_INVALID, "65 threads", bw_set_threads(context, 65));
}

static void test_tensors(void **state) {
  (void)state;
  bw_random random;
  bw_random_seed(&random, 1);
  for (int round = 0; round < 1000; round++) {
    double t[6], values[3], v[9];
    for (int i = 0; i < 6; i++)
      t[i] = bw_random_normal(&random) * (round % 3 == 0 && i > 2 ? 1e-9 : 1);
    bw_eigen3(t, values, v);
    assert_true(values[0] >= values[1] && values[1] >= values[2]);
    double m[3][3] = {{t[0], t[5], t[4]}, {t[5], t[1], t[3]}, {t[4], t[3], t[2]}};
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double row = m[j][0] * v[3 * i] + m[j][1] * v[3 * i + 1] + m[j][2] * v[3 * i + 2];
        check_near(row, values[i] * v[3 * i + j], 1e-14 * 10);
        check_near(bw_dot(v + 3 * i, v + 3 * j), i == j, 1e-14);
      }
  }
  double tension[6] = {5, 0, 0, 0, 0, 0}, shear[6] = {0, 0, 0, 0, 0, 2};
  check_near(bw_von_mises(tension), 5, 1e-15);
  check_near(bw_von_mises(shear), 2 * sqrt(3), 1e-15);
  double a[9] = {2, 1, 0, 0, 3, 1, 1, 0, 4}, inverse[9];
  check_near(bw_inverse3(a, inverse), 25, 1e-13);
  check_near(2 * inverse[0] + inverse[3], 1, 1e-15);
}

static void test_sha256(void **state) {
  bw_context *context = check_context(state);
  char digest[65];
  FILE *file = fopen("/tmp/barwright-sha256-test", "wb");
  assert_non_null(file);
  fputs("abc", file);
  fclose(file);
  check_ok(context, bw_sha256_file(context, "/tmp/barwright-sha256-test", digest));
  remove("/tmp/barwright-sha256-test");
  assert_string_equal(digest, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  check_fails(context, BW_IO, "/nowhere", bw_sha256_file(context, "/nowhere/x", digest));
  /* What has no end, or nobody at the other end, is refused at once. */
  check_fails(context, BW_IO, "not a regular file", bw_sha256_file(context, "/dev/zero", digest));
  check_fails(context, BW_IO, "a directory", bw_sha256_file(context, "tests", digest));
  const char *pipe = "/tmp/barwright-sha256-pipe";
  remove(pipe);
  assert_int_equal(mkfifo(pipe, 0600), 0);
  check_fails(context, BW_IO, "not a regular file", bw_sha256_file(context, pipe, digest));
  remove(pipe);
}

check_main(check_test(test_messages), check_test(test_memory), check_test(test_arrays),
           check_test(test_threads), check_test(test_tensors), check_test(test_sha256))
