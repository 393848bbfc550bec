/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Temporary files: those of killed processes go, those of living ones and of users stay. */
#include "check.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "barwright/temporary.h"

static char folder[64];

static const char *path_of(const char *name) {
  static char path[4][400];
  static int which;
  which = (which + 1) % 4;
  snprintf(path[which], sizeof path[which], "%s/%s", folder, name);
  return path[which];
}

static bool exists(const char *path) {
  struct stat about;
  return lstat(path, &about) == 0;
}

static void touch(const char *path) {
  int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  assert_true(file >= 0);
  close(file);
}

static int set_up(void **state) {
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/barwright-temporary-XXXXXX");
  return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

/* A child that makes a temporary file for the target with two more that belong to it, tells its
 * path, and waits to be killed. */
static pid_t start_child(const char *target, char path[400]) {
  int report[2];
  assert_int_equal(pipe(report), 0);
  pid_t child = fork();
  if (child == 0) {
    bw_context *context = bw_context_create();
    bw_temporary *temporary = NULL;
    char other[400] = "";
    if (bw_temporary_create(context, target, true, &temporary) != BW_OK)
      _exit(1);
    snprintf(other, sizeof other, "%s-wal", bw_temporary_path(temporary));
    touch(other);
    snprintf(other, sizeof other, "%s.d", bw_temporary_path(temporary));
    mkdir(other, 0777);
    snprintf(other, sizeof other, "%s.d/inside", bw_temporary_path(temporary));
    touch(other);
    snprintf(other, sizeof other, "%s", bw_temporary_path(temporary));
    if (write(report[1], other, sizeof other) != (ssize_t)sizeof other)
      _exit(2);
    for (;;)
      pause();
  }
  close(report[1]);
  assert_int_equal(read(report[0], path, 400), 400);
  close(report[0]);
  return child;
}

static void end_child(pid_t child) {
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
}

static const char *with(const char *path, const char *ending) {
  static char name[3][440];
  static int which;
  which = (which + 1) % 3;
  snprintf(name[which], sizeof name[which], "%s%s", path, ending);
  return name[which];
}

static void test_left_behind(void **state) {
  bw_context *context = check_context(state);
  char dead[400], living[400];
  static const char *const own[] = {"a.partial",
                                    "a.partial-12",
                                    "a.partial-12-1",
                                    "a.partial.12",
                                    "a.partial.12.1234567",
                                    "a.partial.12.123456789",
                                    "a.partial.12.ABCDEF01",
                                    "a.partial.x.12345678",
                                    "a.partial.12.12345678x",
                                    "a.partial..12345678"};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    touch(path_of(own[i]));
  mkdir(path_of("a.partial.12.00000000"), 0777); /* a folder is no temporary file */
  assert_int_equal(symlink("a.partial", path_of("a.partial.12.00000001")), 0);
  pid_t killed = start_child(path_of("a"), dead), alive = start_child(path_of("b"), living);
  end_child(killed);
  touch(with(dead, ".vtu.partial.1.0123abcd"));
  assert_true(exists(dead) && exists(with(dead, ".d/inside")));
  bw_temporary *temporary = NULL;
  check_ok(context, bw_temporary_create(context, path_of("c"), false, &temporary));
  assert_false(exists(dead));
  assert_false(exists(with(dead, "-wal")));
  assert_false(exists(with(dead, ".d")));
  assert_false(exists(with(dead, ".vtu.partial.1.0123abcd")));
  assert_true(exists(living) && exists(with(living, "-wal")) && exists(with(living, ".d/inside")));
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    assert_true(exists(path_of(own[i])));
  assert_true(exists(path_of("a.partial.12.00000000")));
  assert_true(exists(path_of("a.partial.12.00000001")));
  bw_temporaries_sweep(folder);
  assert_true(exists(bw_temporary_path(temporary))); /* this process's own */
  end_child(alive);
  bw_temporaries_sweep(folder);
  assert_false(exists(living) || exists(with(living, "-wal")) || exists(with(living, ".d")));
  bw_release(temporary);
}

static void test_life(void **state) {
  bw_context *context = check_context(state);
  bw_temporary *one = NULL, *two = NULL;
  char path[400], long_name[300];
  check_ok(context, bw_temporary_create(context, path_of("x"), true, &one));
  check_ok(context, bw_temporary_create(context, path_of("x"), true, &two));
  assert_string_not_equal(bw_temporary_path(one), bw_temporary_path(two));
  snprintf(path, sizeof path, "%s", bw_temporary_path(one));
  touch(with(path, ".vtu"));
  touch(with(path, "x")); /* another's */
  pid_t child = fork();
  if (child == 0) {
    bw_release(one); /* leaves it alone */
    _exit(0);
  }
  waitpid(child, NULL, 0);
  assert_true(exists(path));
  bw_release(one);
  assert_false(exists(path) || exists(with(path, ".vtu")));
  assert_true(exists(with(path, "x")));
  assert_int_equal(write(bw_temporary_file(two), "kept", 4), 4);
  snprintf(path, sizeof path, "%s", bw_temporary_path(two));
  assert_int_equal(bw_temporary_put_in_place(two, path_of("x")), 0);
  bw_release(two);
  assert_true(exists(path_of("x")));
  assert_false(exists(path));
  memset(long_name, 'n', 255);
  long_name[255] = 0;
  check_ok(context, bw_temporary_create(context, path_of(long_name), false, &one));
  assert_int_equal(bw_temporary_put_in_place(one, path_of(long_name)), 0);
  bw_release(one);
  assert_true(exists(path_of(long_name)));
  check_fails(context, BW_IO, "there is no folder /tmp/no such folder",
              bw_temporary_create(context, "/tmp/no such folder/x", false, &one));
}

/* Each time another, of this user alone, where TMPDIR says or else in /tmp. */
static void test_folders(void **state) {
  bw_context *context = check_context(state);
  bw_temporary *made[2];
  char before[256], wished[128], gone[400];
  struct stat about;
  const char *set = getenv("TMPDIR");
  snprintf(before, sizeof before, "%s", set ? set : "");
  snprintf(wished, sizeof wished, "%s", path_of("tmp"));
  assert_int_equal(mkdir(wished, 0777), 0);
  const char *const places[] = {wished, "relative", "/no/such/folder", ""};
  for (int i = 0; i < 4; i++) {
    setenv("TMPDIR", places[i], 1);
    for (int k = 0; k < 2; k++) {
      check_ok(context, bw_temporary_folder_create(context, &made[k]));
      const char *path = bw_temporary_path(made[k]);
      assert_true(strncmp(path, i ? "/tmp/" : wished, i ? 5 : strlen(wished)) == 0);
      assert_int_equal(stat(path, &about), 0);
      assert_true(S_ISDIR(about.st_mode));
      assert_int_equal(about.st_mode & 0777, 0700);
      touch(with(path, "/inside"));
    }
    assert_string_not_equal(bw_temporary_path(made[0]), bw_temporary_path(made[1]));
    for (int k = 0; k < 2; k++) {
      snprintf(gone, sizeof gone, "%s", bw_temporary_path(made[k]));
      bw_release(made[k]);
      assert_false(exists(gone));
    }
  }
  if (set)
    setenv("TMPDIR", before, 1);
  else
    unsetenv("TMPDIR");
}

/* Many processes make and remove files in one folder while others sweep it: none loses its own. */
static void test_together(void **state) {
  (void)state;
  enum { PROCESSES = 6, ROUNDS = 150 };
  pid_t child[PROCESSES];
  for (int i = 0; i < PROCESSES; i++) {
    child[i] = fork();
    if (child[i] != 0)
      continue;
    bw_context *context = bw_context_create();
    for (int k = 0; k < ROUNDS; k++) {
      bw_temporary *temporary = NULL;
      if (bw_temporary_create(context, path_of("shared"), false, &temporary) != BW_OK)
        _exit(1);
      bw_temporaries_sweep(folder);
      if (!exists(bw_temporary_path(temporary)) ||
          bw_temporary_put_in_place(temporary, path_of("shared")) != 0)
        _exit(2);
      bw_release(temporary);
    }
    _exit(0);
  }
  for (int i = 0; i < PROCESSES; i++) {
    int status = -1;
    waitpid(child[i], &status, 0);
    assert_int_equal(status, 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(test_left_behind), check_test(test_life),
                                     check_test(test_folders), check_test(test_together)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
