/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* SIGTERM ends a process that orders, though METIS catches it. */
#include "check.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "linear/order.h"

enum { SIDE = 12, SIZE = SIDE * SIDE * SIDE, CHILDREN = 8 };

/* Orders the graph of a cube of nodes again and again. */
static void order_for_ever(int report) {
  static idx_t start[SIZE + 1], neighbour[6 * SIZE], permutation[SIZE];
  const int step[3] = {1, SIDE, SIDE * SIDE};
  idx_t next = 0;
  for (idx_t i = 0; i < SIZE; i++) {
    for (int axis = 0; axis < 3; axis++) {
      int at = i / step[axis] % SIDE;
      if (at > 0)
        neighbour[next++] = i - step[axis];
      if (at < SIDE - 1)
        neighbour[next++] = i + step[axis];
    }
    start[i + 1] = next;
  }
  bw_context *context = bw_context_create();
  alarm(60); /* in case the signal is lost */
  if (write(report, "", 1) != 1)
    _exit(1);
  while (bwi_dissect(context, SIZE, start, neighbour, permutation) == BW_OK)
    ;
  _exit(2);
}

static void test_sigterm_ends(void **state) {
  (void)state;
  for (int i = 0; i < CHILDREN; i++) {
    int report[2], how = 0;
    char ready;
    assert_int_equal(pipe(report), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
      order_for_ever(report[1]);
    assert_int_equal(read(report[0], &ready, 1), 1);
    usleep(3000 * (unsigned)(i + 1));
    kill(child, SIGTERM);
    assert_int_equal(waitpid(child, &how, 0), child);
    assert_true(WIFSIGNALED(how));
    assert_int_equal(WTERMSIG(how), SIGTERM);
    close(report[0]);
    close(report[1]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_sigterm_ends)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
