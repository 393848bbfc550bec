/* What every engine test includes: cmocka, the engine, and a few checks of its own. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "barwright.h"

/* A call that must succeed: prints the engine's message when it does not. */
#define check_ok(context, call)                                                                    \
  do {                                                                                             \
    bw_status check_status_ = (call);                                                              \
    if (check_status_ != BW_OK)                                                                    \
      fail_msg("%s: %s (%s)", #call, bw_message(context), bw_status_word(check_status_));          \
  } while (0)

/* A call that must fail with this status, and with a message that holds this text. */
#define check_fails(context, expected, text, call)                                                 \
  do {                                                                                             \
    bw_status check_status_ = (call);                                                              \
    if (check_status_ != (expected))                                                               \
      fail_msg("%s: %s instead of %s (%s)", #call, bw_status_word(check_status_),                  \
               bw_status_word(expected), bw_message(context));                                     \
    if (!strstr(bw_message(context), (text)))                                                      \
      fail_msg("%s: message \"%s\" lacks \"%s\"", #call, bw_message(context), (text));             \
  } while (0)

/* Ends the n-th run and begins the next one; false behind the run that passed. */
static inline bool check_next_failure(bw_context *context, int64_t *n, bw_status status,
                                      int64_t least) {
  bw_fail_allocation(0, false);
  if (*n > 0 && status != BW_OK && status != BW_MEMORY)
    fail_msg("without the allocation %d: %s (%s)", (int)*n, bw_message(context),
             bw_status_word(status));
  if (*n > 0 && status == BW_OK && *n <= least)
    fail_msg("only %d allocations, at least %d expected", (int)*n - 1, (int)least);
  if (*n > 0 && status == BW_OK)
    return false;
  bw_clear_failure(context);
  bw_fail_allocation(++*n, true);
  return true;
}

/* Runs the statement that follows with its first allocation and all behind it failing, then from
 * the second on, until it sets `status`, which is declared here, to BW_OK. In the runs before,
 * `least` of them at least, it must be BW_MEMORY. What they leave behind fails the fixture. */
#define check_each_allocation(context, status, least)                                              \
  for (bw_status status = BW_MEMORY, *check_once_ = &status; check_once_; check_once_ = NULL)      \
    for (int64_t check_n_ = 0; check_next_failure(context, &check_n_, status, least);)

/* The same of a call that makes an object, which is released, or none. */
#define check_allocations(context, object, call)                                                   \
  check_each_allocation(context, check_status_, 0) {                                               \
    check_status_ = (call);                                                                        \
    bw_release(object);                                                                            \
    (object) = NULL;                                                                               \
  }

#define check_near(value, expected, tolerance)                                                     \
  do {                                                                                             \
    double check_value_ = (value), check_expected_ = (expected);                                   \
    if (!(fabs(check_value_ - check_expected_) <= (tolerance)))                                    \
      fail_msg("%s = %.17g, expected %.17g within %g", #value, check_value_, check_expected_,      \
               (double)(tolerance));                                                               \
  } while (0)

/* Fixture: a context as *state, and at the end no block may be alive that was not before. */
typedef struct check_state {
  bw_context *context;
  int64_t blocks;
} check_state;

static inline int check_setup(void **state) {
  check_state *check = (check_state *)malloc(sizeof *check);
  check->blocks = bw_live_blocks();
  check->context = bw_context_create();
  *state = check;
  return check->context ? 0 : -1;
}

static inline int check_teardown(void **state) {
  check_state *check = (check_state *)*state;
  bw_context_destroy(check->context);
  int64_t left = bw_live_blocks() - check->blocks;
  free(check);
  if (left != 0)
    printf("%lld blocks were not freed\n", (long long)left);
  return left == 0 ? 0 : -1;
}

/* The mesh, which is released, with a region for each tag, tag (element_count). */
static inline bw_mesh *check_tagged(bw_context *context, bw_mesh *mesh, const int32_t *tag) {
  bw_mesh_regions regions;
  bw_mesh *tagged;
  check_ok(context, bw_mesh_regions_by_tag(context, mesh->element_count, tag, 0, NULL, &regions));
  check_ok(context, bw_mesh_with_regions(context, mesh, &regions, &tagged));
  bw_mesh_regions_clear(&regions);
  bw_release(mesh);
  return tagged;
}

#define check_context(state) (((check_state *)*(state))->context)
#define check_test(function) cmocka_unit_test_setup_teardown(function, check_setup, check_teardown)

/* The program of these tests. */
#define check_main(...)                                                                            \
  int main(void) {                                                                                 \
    const struct CMUnitTest tests[] = {__VA_ARGS__};                                               \
    return cmocka_run_group_tests(tests, NULL, NULL);                                              \
  }

#endif
