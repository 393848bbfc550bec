/* Confinement to a folder (S1, S2). It cannot be undone, so each test confines a child process. */
#include "check.h"

#include "barwright/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[64], path[256];

static const char *in(const char *name) {
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static void make_file(const char *name) {
  int file = open(in(name), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  assert_true(file >= 0);
  close(file);
}

static void write_letter(const char *name, char letter) {
  int file = open(in(name), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  assert_true(file >= 0);
  assert_int_equal(write(file, &letter, 1), 1);
  close(file);
}

/* inside/ is the folder; beside/ and file are not. */
static int set_up(void **state) {
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/confine_XXXXXX");
  assert_non_null(mkdtemp(folder));
  assert_int_equal(mkdir(in("inside"), 0777), 0);
  assert_int_equal(mkdir(in("inside/deep"), 0777), 0);
  assert_int_equal(mkdir(in("inside_not"), 0777), 0);
  assert_int_equal(mkdir(in("library"), 0777), 0);
  make_file("file");
  make_file("inside/file");
  make_file("library/file");
  assert_int_equal(symlink("../file", in("inside/out")), 0);
  assert_int_equal(symlink("../inside/file", in("inside/round")), 0);
  assert_int_equal(symlink("/nowhere/at/all", in("inside/dangling")), 0);
  assert_int_equal(symlink("..", in("inside/up")), 0);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

static bool may(bw_context *context, const char *name, bw_use use) {
  bw_status status = bw_may_use(context, name, use);
  if (status != BW_OK &&
      (status != BW_IO || !strstr(bw_message(context), "refused in the sandbox")))
    _exit(99);
  return status == BW_OK;
}

typedef bool confined_work(bw_context *context);

/* Runs the work in a confined child. */
static void confined(bw_context *context, confined_work *work) {
  pid_t child = fork();
  if (child == 0) {
    bool good = bw_confine_read_also(context, in("library")) == BW_OK &&
                bw_confine(context, in("inside")) == BW_OK && work(context);
    _exit(good ? 0 : 1);
  }
  int how = -1;
  assert_int_equal(waitpid(child, &how, 0), child);
  assert_true(WIFEXITED(how));
  assert_int_equal(WEXITSTATUS(how), 0);
}

static bool check_paths(bw_context *c) {
  static const struct {
    const char *name;
    bool read, write, replace;
  } expected[] = {
      {"inside/file", true, true, true},
      {"inside/new", true, true, true},
      {"inside/deep/new", true, true, true},
      {"inside/deep/../file", true, true, true},
      {"inside/round", true, true, true}, /* a link that leads in */
      {"inside/out", false, false, true}, /* one that leads out: only the link itself is ours */
      {"inside/dangling", false, false, true},
      {"inside/up/file", false, false, false},
      {"inside/up/inside/file", true, true, true},
      {"inside/../file", false, false, false},
      {"inside_not/file", false, false, false}, /* the name begins alike */
      {"inside", true, true, false},            /* not to be taken away */
      {"inside/.", true, true, false},
      {"inside/..", false, false, false},
      {"inside/no/such", false, false, false},
      {"file", false, false, false},
      {"library/file", true, false, false},
      {"library", true, false, false},
      {"library/../file", false, false, false},
  };
  for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
    if (may(c, in(expected[i].name), BW_TO_READ) != expected[i].read ||
        may(c, in(expected[i].name), BW_TO_WRITE) != expected[i].write ||
        may(c, in(expected[i].name), BW_TO_REPLACE) != expected[i].replace) {
      fprintf(stderr, "%s is checked wrongly\n", expected[i].name);
      return false;
    }
  return !may(c, "", BW_TO_READ) && !may(c, "/etc/passwd", BW_TO_READ) && !may(c, "/", BW_TO_READ);
}

static bool check_relative(bw_context *c) {
  return chdir(in("inside")) == 0 && may(c, "file", BW_TO_READ) && may(c, "new", BW_TO_WRITE) &&
         may(c, "./deep/../new", BW_TO_WRITE) && !may(c, "../file", BW_TO_READ) &&
         !may(c, "..", BW_TO_READ) && may(c, ".", BW_TO_READ) && !may(c, ".", BW_TO_REPLACE);
}

static bool check_engine(bw_context *c) {
  unsigned char *bytes = NULL;
  size_t count;
  char digest[65];
  bw_writer *writer = NULL;
  bw_status refused[] = {bw_read_file(c, in("file"), &bytes, &count),
                         bw_sha256_file(c, in("file"), digest),
                         bw_writer_open(c, in("new"), &writer), bw_may_start(c, "a server")};
  if (refused[0] != BW_IO || refused[1] != BW_IO || refused[2] != BW_IO ||
      refused[3] != BW_UNSUPPORTED)
    return false;
  if (bw_writer_open(c, in("inside/made"), &writer) != BW_OK || bw_writer_commit(writer) != BW_OK)
    return false;
  if (bw_read_file(c, in("inside/file"), &bytes, &count) != BW_OK)
    return false;
  bw_free(bytes);
  /* No way back, and no way to more. */
  return bw_confine(c, "/") == BW_INVALID && bw_confine_read_also(c, "/") == BW_INVALID &&
         strstr(bw_confined_to(), "/inside") != NULL;
}

static bool opens(const char *name, int flags) {
  int file = bw_open(in(name), flags, 0666);
  if (file >= 0)
    close(file);
  else if (errno != EACCES)
    _exit(98);
  return file >= 0;
}

static bool renames(const char *from, const char *to) {
  char old[256];
  snprintf(old, sizeof old, "%s", in(from));
  return bw_rename(old, in(to)) == 0;
}

static bool check_opening(bw_context *c) {
  (void)c;
  static const struct {
    const char *name;
    int flags;
    bool opens;
  } expected[] = {
      {"inside/file", O_RDWR, true},
      {"inside/opened", O_WRONLY | O_CREAT, true},
      {"inside/opened", O_WRONLY | O_APPEND, true},
      {"inside/deep/../file", O_RDONLY, true},
      {"inside/round", O_RDONLY, true},
      {"inside/up/inside/file", O_RDONLY, true},
      {"inside", O_RDONLY | O_DIRECTORY, true},
      {"inside/out", O_RDONLY, false},
      {"inside/out", O_WRONLY | O_TRUNC, false},
      {"inside/dangling", O_WRONLY | O_CREAT, false},
      {"inside/dangling", O_WRONLY | O_CREAT | O_EXCL, false},
      {"inside/up/file", O_RDONLY, false},
      {"inside/up/new", O_WRONLY | O_CREAT, false},
      {"file", O_RDONLY, false},
      {"library/file", O_RDONLY, true},
      {"library/file", O_RDWR, false},
      {"library/file", O_RDONLY | O_TRUNC, false},
      {"library/new", O_RDONLY | O_CREAT, false},
  };
  for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
    if (opens(expected[i].name, expected[i].flags) != expected[i].opens) {
      fprintf(stderr, "%s with flags %x is opened wrongly\n", expected[i].name, expected[i].flags);
      return false;
    }
  const bool as_expected[] = {
      bw_make_folder(in("inside/built")) == 0,
      bw_make_folder(in("made")) != 0,
      bw_make_folder(in("inside/up/made")) != 0,
      renames("inside/built", "inside/deep/made"),
      !renames("inside/opened", "opened"),
      !renames("file", "inside/stolen"),
      !renames("inside", "inside/deep/inside"),
      !renames("inside/opened", "inside/up/opened"),
      bw_remove(in("inside/deep/made")) == 0,
      bw_remove(in("inside/opened")) == 0,
      bw_remove(in("file")) != 0,
      bw_remove(in("inside")) != 0,
      bw_remove(in("inside/out")) == 0 && symlink("../file", in("inside/out")) == 0,
      access(in("file"), F_OK) == 0,
  };
  for (size_t i = 0; i < sizeof as_expected / sizeof *as_expected; i++)
    if (!as_expected[i]) {
      fprintf(stderr, "attempt %zu ends wrongly\n", i);
      return false;
    }
  return true;
}

/* Another process exchanges a folder for a link to the outside, again and again: what is opened,
 * made and removed lies inside all the same. */
static bool check_moving(bw_context *c) {
  (void)c;
  enum { TIMES = 4000 };
  char turn[256], away[256];
  snprintf(turn, sizeof turn, "%s", in("inside/turn"));
  snprintf(away, sizeof away, "%s", in("inside/away"));
  pid_t motion = fork();
  if (motion == 0)
    for (;;)
      if (renameat2(AT_FDCWD, turn, AT_FDCWD, away, RENAME_EXCHANGE) != 0)
        _exit(1);
  bool good = true;
  for (int i = 0; i < TIMES && good; i++) {
    char letter = 'i';
    int file = bw_open(in("inside/turn/letter"), O_RDONLY, 0);
    if (file >= 0) {
      good = read(file, &letter, 1) == 1 && letter == 'i';
      close(file);
    }
    file = bw_open(in("inside/turn/made"), O_WRONLY | O_CREAT, 0666);
    if (file >= 0)
      close(file);
    bw_make_folder(in("inside/turn/folder"));
    bw_remove(in("inside/turn/kept"));
  }
  kill(motion, SIGKILL);
  waitpid(motion, NULL, 0);
  return good && access(in("made"), F_OK) != 0 && access(in("folder"), F_OK) != 0 &&
         access(in("kept"), F_OK) == 0;
}

static void test_opening(void **state) {
  confined(check_context(state), check_opening);
}

static void test_moving(void **state) {
  assert_int_equal(mkdir(in("inside/turn"), 0777), 0);
  assert_int_equal(symlink("..", in("inside/away")), 0);
  write_letter("letter", 'o');
  write_letter("inside/turn/letter", 'i');
  write_letter("kept", 'o');
  confined(check_context(state), check_moving);
}

static void test_paths(void **state) {
  confined(check_context(state), check_paths);
}

static void test_relative(void **state) {
  confined(check_context(state), check_relative);
}

static void test_engine(void **state) {
  confined(check_context(state), check_engine);
}

static void test_unconfined(void **state) {
  bw_context *context = check_context(state);
  assert_false(bw_confined());
  assert_null(bw_confined_to());
  check_ok(context, bw_may_use(context, "/etc/passwd", BW_TO_READ));
  check_ok(context, bw_may_start(context, "a server"));
  check_fails(context, BW_IO, "/no/such", bw_confine(context, "/no/such"));
  check_fails(context, BW_IO, "a folder expected", bw_confine(context, in("file")));
  check_fails(context, BW_IO, "/no/such", bw_confine_read_also(context, "/no/such"));
  assert_false(bw_confined());
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_unconfined), check_test(test_paths),   check_test(test_relative),
      check_test(test_engine),     check_test(test_opening), check_test(test_moving),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
