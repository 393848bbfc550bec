/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Atomic writing, and numbers as text in any locale. */
#include "io_check.h"

#include <dirent.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "io/internal.h"

static void check_content(const char *path, const char *expected) {
  char text[200] = "";
  FILE *file = fopen(path, "r");
  if (expected) {
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    assert_string_equal(text, expected);
  } else {
    assert_null(file);
  }
}

/* No partial file of this path is left. */
static int partials(const char *path) {
  char folder[300];
  snprintf(folder, sizeof folder, "%s", path);
  char *slash = strrchr(folder, '/');
  *slash = 0;
  char name[300];
  snprintf(name, sizeof name, "%s.partial.", slash + 1);
  int count = 0;
  DIR *directory = opendir(folder);
  for (struct dirent *entry; (entry = readdir(directory));)
    count += strncmp(entry->d_name, name, strlen(name)) == 0;
  closedir(directory);
  return count;
}

static void commit_and_discard(void **state) {
  bw_context *context = check_context(state);
  char path[300];
  bw_writer *writer, *other;
  temporary(path, "w.txt");
  check_ok(context, bw_writer_open(context, path, &writer));
  check_ok(context, bw_writer_open(context, path, &other)); /* two at a time */
  check_ok(context, bw_writer_print(writer, "%s %d\n", "one", 1));
  check_ok(context, bw_writer_number(writer, -0.1));
  check_ok(context, bw_writer_integer(writer, INT64_MIN));
  check_content(path, NULL);
  assert_int_equal(partials(path), 2);
  check_ok(context, bw_writer_commit(writer));
  check_content(path, "one 1\n-0.1-9223372036854775808");
  assert_int_equal(chmod(path, 0640), 0);
  check_ok(context, bw_writer_print(other, "two"));
  bw_writer_discard(other);
  check_content(path, "one 1\n-0.1-9223372036854775808");
  check_ok(context, bw_writer_open(context, path, &writer));
  check_ok(context, bw_writer_commit(writer));
  check_content(path, "");
  struct stat about;
  stat(path, &about);
  assert_int_equal(about.st_mode & 0777, 0640); /* kept */
  assert_int_equal(partials(path), 0);
  unlink(path);
  bw_writer_discard(NULL);
}

static void odd_targets(void **state) {
  bw_context *context = check_context(state);
  char path[300], link[300];
  bw_writer *writer = NULL;
  check_fails(context, BW_IO, "/tmp: cannot write: Is a directory",
              bw_writer_open(context, "/tmp", &writer));
  check_fails(context, BW_IO, "there is no folder /tmp/no",
              bw_writer_open(context, "/tmp/no/no", &writer));
  check_fails(context, BW_INVALID, "empty path", bw_writer_open(context, "", &writer));
  assert_null(writer);
  check_ok(context, bw_writer_open(context, "/dev/null", &writer)); /* written directly */
  check_ok(context, bw_writer_print(writer, "x"));
  check_ok(context, bw_writer_commit(writer));
  struct stat about;
  stat("/dev/null", &about);
  assert_true(S_ISCHR(about.st_mode));
  /* a symbolic link stays one */
  temporary(path, "target");
  temporary(link, "link");
  fclose(fopen(path, "w"));
  assert_int_equal(symlink(path, link), 0);
  check_ok(context, bw_writer_open(context, link, &writer));
  check_ok(context, bw_writer_print(writer, "through"));
  check_ok(context, bw_writer_commit(writer));
  check_content(path, "through");
  lstat(link, &about);
  assert_true(S_ISLNK(about.st_mode));
  unlink(link);
  unlink(path);
}

static void full_disk(void **state) {
  bw_context *context = check_context(state);
  bw_writer *writer;
  static const char block[1 << 17];
  if (access("/dev/full", W_OK) != 0)
    skip();
  check_ok(context, bw_writer_open(context, "/dev/full", &writer));
  check_fails(context, BW_IO, "/dev/full: cannot write: No space left",
              bw_writer_bytes(writer, block, sizeof block));
  check_fails(context, BW_IO, "No space left", bw_writer_print(writer, "more"));
  check_fails(context, BW_IO, "No space left", bw_writer_commit(writer));
}

/* A limit on the size of files: the old file stays, the partial one goes. */
static void cut_off(void **state) {
  (void)state;
  char path[300];
  FILE *old = fopen(temporary(path, "old.txt"), "w");
  fputs("old", old);
  fclose(old);
  pid_t child = fork();
  if (child == 0) {
    struct rlimit limit = {1 << 16, 1 << 16};
    static const char block[1 << 18];
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    bw_context *context = bw_context_create();
    bw_writer *writer;
    bool good = bw_writer_open(context, path, &writer) == BW_OK;
    bw_writer_bytes(writer, block, sizeof block);
    good = good && bw_writer_commit(writer) == BW_IO && strstr(bw_message(context), path) &&
           strstr(bw_message(context), "may not grow beyond 65536 bytes");
    _exit(good ? 0 : 1);
  }
  int status;
  waitpid(child, &status, 0);
  assert_int_equal(status, 0);
  check_content(path, "old");
  assert_int_equal(partials(path), 0);
  unlink(path);
}

static void end_now(int number) {
  bw_temporaries_abandon();
  _exit(number == SIGINT ? 0 : 1);
}

/* Ctrl-C in the middle: the target is not there, and the partial file neither. */
static void interrupted(void **state) {
  (void)state;
  char path[300];
  temporary(path, "interrupted.txt");
  int ready[2];
  assert_int_equal(pipe(ready), 0);
  pid_t child = fork();
  if (child == 0) {
    signal(SIGINT, end_now);
    bw_context *context = bw_context_create();
    bw_writer *writer;
    if (bw_writer_open(context, path, &writer) != BW_OK)
      _exit(2);
    bw_writer_print(writer, "half");
    if (write(ready[1], "x", 1) != 1)
      _exit(3);
    for (;;)
      pause();
  }
  char byte;
  assert_int_equal(read(ready[0], &byte, 1), 1);
  assert_int_equal(partials(path), 1);
  kill(child, SIGINT);
  int status;
  waitpid(child, &status, 0);
  assert_int_equal(status, 0);
  assert_int_equal(partials(path), 0);
  check_content(path, NULL);
  close(ready[0]);
  close(ready[1]);
}

/* Reading is correctly rounded: compared with strtod on many numbers of every shape. */
static void numbers(void **state) {
  (void)state;
  bw_random random;
  char text[400];
  double value;
  bw_random_seed(&random, 5);
  int count = getenv("BARWRIGHT_FULL") ? 3000000 : 200000;
  for (int i = 0; i < count; i++) {
    uint64_t bits = bw_random_bits(&random);
    double expected;
    memcpy(&expected, &bits, sizeof expected);
    int shape = (int)(bw_random_bits(&random) % 5);
    if (shape == 0 && isfinite(expected))
      snprintf(text, sizeof text, "%.*e", (int)(bits % 25), expected);
    else if (shape == 1)
      snprintf(text, sizeof text, "%.*f", (int)(bits % 30), bw_random_normal(&random) * 1000);
    else if (shape == 2)
      snprintf(text, sizeof text, "%llu.%llue%d", (unsigned long long)bits % 100000,
               (unsigned long long)bw_random_bits(&random), (int)(bits % 60) - 30);
    else if (shape == 3) /* half way between two doubles, and just beside */
      snprintf(text, sizeof text, "%llu%s", (unsigned long long)((bits >> 11 | 1ull << 53) * 2 + 1),
               i % 2 ? ".0" : ".000001");
    else
      snprintf(text, sizeof text, "%.17g", bw_random_normal(&random));
    expected = strtod(text, NULL);
    if (!isfinite(expected))
      continue;
    if (!bw_parse_number(text, &value) || memcmp(&value, &expected, sizeof value) != 0)
      fail_msg("'%s' read as %.17g", text, value);
    bw_format_number(expected, text);
    assert_true(bw_parse_number(text, &value) && value == expected);
  }
  static const struct {
    const char *text;
    double value;
  } good[] = {{"+1", 1},
              {"1.", 1},
              {".5", 0.5},
              {"1D-3", 1e-3},
              {"1d+2", 100},
              {"-0", -0.0},
              {"0e999", 0},
              {"4.9e-324", 4.9e-324},
              {"00012", 12},
              {"1e-400", 0},
              {"1.7976931348623157e308", 1.7976931348623157e308}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    assert_true(bw_parse_number(good[i].text, &value));
    assert_true(memcmp(&value, &good[i].value, sizeof value) == 0);
  }
  static const char *const bad[] = {"",     "+",      ".",        "e5", "0x10", "nan", "inf",
                                    "-inf", "1e999",  "1,5",      "1 ", "1e",   "--1", "1.#IND",
                                    "1..2", "NaN(7)", "infinity", " 1", "1f"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (bw_parse_number(bad[i], &value))
      fail_msg("'%s' was read as %g", bad[i], value);
}

/* With decimal commas in the process: the same bytes. Skipped without such a locale. */
static void other_locale(void **state) {
  bw_context *context = check_context(state);
  static const char *const name[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE.utf8", "pl_PL.UTF-8"};
  bool any = false;
  for (size_t i = 0; i < sizeof name / sizeof *name && !any; i++)
    any = setlocale(LC_ALL, name[i]) != NULL;
  if (!any)
    skip();
  char path[300], text[40];
  double value;
  bw_writer *writer;
  bw_format_number(1.0 / 3, text);
  assert_string_equal(text, "0.3333333333333333");
  assert_true(bw_parse_number("1.23456789012345678901234e5", &value) && value > 123456);
  check_ok(context, bw_writer_open(context, temporary(path, "locale.txt"), &writer));
  bw_writer_print(writer, "%.2f", 0.25);
  check_ok(context, bw_writer_commit(writer));
  check_content(path, "0.25");
  unlink(path);
  setlocale(LC_ALL, "C");
}

check_main(check_test(commit_and_discard), check_test(odd_targets), check_test(full_disk),
           check_test(cut_off), check_test(interrupted), check_test(numbers),
           check_test(other_locale))
