/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sandbox's second wall by itself (S8): what the kernel refuses a process that tries. */
#include "check.h"

#include "../../lua/program/program.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[64];

static bool opens(const char *path, int flags) {
  int file = open(path, flags | O_CLOEXEC, 0666);
  if (file >= 0)
    close(file);
  return file >= 0;
}

static void in(char text[128], const char *name) {
  snprintf(text, 128, "%s/%s", folder, name);
}

/* 0, or the number of what was not as it should be. */
static int try_out(void) {
  char inside[128], other[128], fifo[128], away[128], deep[128];
  in(inside, "inside/file");
  in(other, "inside/other");
  in(fifo, "inside/fifo");
  in(deep, "inside/deep");
  in(away, "away");
  program_walls walls = program_close_kernel((in(other, "inside"), other), (const char *[]){NULL});
  in(other, "inside/other");
  char *const arguments[] = {"true", NULL};
  if (walls.landlock) {
    if (opens("/etc/passwd", O_RDONLY) || opens(away, O_WRONLY | O_CREAT) || opens("/", O_RDONLY))
      return 1;
    if (!opens(inside, O_WRONLY | O_CREAT) || !opens(inside, O_RDONLY))
      return 2;
    if (rename(inside, other) != 0 || mkdir(deep, 0777) != 0 || rename(other, away) == 0)
      return 3;
    if (truncate("/etc/hostname", 0) == 0 || unlink(away) == 0 || mkfifo(fifo, 0666) == 0 ||
        symlink("/etc/passwd", fifo) == 0)
      return 4;
    if (!opens("/dev/null", O_RDWR) || !opens("/proc/self/statm", O_RDONLY))
      return 5;
  }
  if (walls.calls) {
    if (socket(AF_INET, SOCK_STREAM, 0) >= 0 || errno != EPERM)
      return 6;
    if (execv("/bin/true", arguments) == 0 || errno != EPERM)
      return 7;
  } else if (walls.landlock && (execv("/bin/true", arguments) == 0 || errno != EACCES))
    return 8;
  /* Children that the engine forks go on working, and are held as well. */
  pid_t child = fork();
  if (child == 0)
    _exit(walls.landlock && opens("/etc/passwd", O_RDONLY) ? 1 : 0);
  int how = -1;
  waitpid(child, &how, 0);
  return WIFEXITED(how) && WEXITSTATUS(how) == 0 ? 0 : 9;
}

static void test_walls(void **state) {
  (void)state;
  char path[128];
  snprintf(folder, sizeof folder, "/tmp/kernel_XXXXXX");
  assert_non_null(mkdtemp(folder));
  in(path, "inside");
  assert_int_equal(mkdir(path, 0777), 0);
  pid_t child = fork();
  if (child == 0)
    _exit(try_out());
  int how = -1;
  assert_int_equal(waitpid(child, &how, 0), child);
  assert_true(WIFEXITED(how));
  assert_int_equal(WEXITSTATUS(how), 0);
  char command[160];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  assert_int_equal(system(command), 0);
  assert_true(opens("/etc/passwd", O_RDONLY)); /* this process is free */
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(test_walls)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
