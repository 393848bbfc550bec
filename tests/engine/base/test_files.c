/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Folders, locks between processes, SHA-256 of bytes. */
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[64];

static const char *in_folder(const char *name) {
  static char path[2][128];
  static int turn;
  turn = 1 - turn;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

static int make_place(void **state) {
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/bw_files_XXXXXX");
  return mkdtemp(folder) ? 0 : -1;
}

static int drop_place(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

/* FIPS 180-4's examples. */
static void digests_of_bytes(void **state) {
  (void)state;
  char digest[65];
  bw_sha256_bytes("", 0, digest);
  assert_string_equal(digest, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  bw_sha256_bytes("abc", 3, digest);
  assert_string_equal(digest, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  bw_sha256_bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56, digest);
  assert_string_equal(digest, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

static bw_status count_entry(void *data, const char *name, bool is_folder, int64_t bytes,
                             double changed) {
  int *count = (int *)data;
  count[is_folder]++;
  assert_true(changed > 1e9);
  if (strcmp(name, "file") == 0)
    assert_int_equal(bytes, 3);
  return BW_OK;
}

static void folders(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_folder_make(context, in_folder("a//b/c/")));
  check_ok(context, bw_folder_make(context, in_folder("a/b/c")));
  struct stat about;
  assert_int_equal(stat(in_folder("a/b/c"), &about), 0);
  FILE *file = fopen(in_folder("a/file"), "w");
  fputs("abc", file);
  fclose(file);
  check_fails(context, BW_IO, "a folder", bw_folder_make(context, in_folder("a/file")));
  check_fails(context, BW_IO, "a folder", bw_folder_make(context, in_folder("a/file/d")));
  check_fails(context, BW_IO, "empty name", bw_folder_make(context, ""));
  int count[2] = {0, 0};
  check_ok(context, bw_folder_visit(context, in_folder("a"), count_entry, count));
  assert_int_equal(count[0], 1);
  assert_int_equal(count[1], 1);
  check_fails(context, BW_IO, "none",
              bw_folder_visit(context, in_folder("none"), count_entry, count));
  check_ok(context, bw_file_touch(context, in_folder("a/file")));
  check_fails(context, BW_IO, "none", bw_file_touch(context, in_folder("none")));
  check_each_allocation(context, status, 1) {
    status = bw_folder_make(context, in_folder("a/e"));
  }
}

/* A child that takes the lock and goes on until it is asked to stop. */
static pid_t holder(const char *path) {
  int ready[2];
  assert_int_equal(pipe(ready), 0);
  pid_t child = fork();
  if (child == 0) {
    bw_context *own = bw_context_create();
    bw_lock *lock = NULL;
    char word = bw_lock_take(own, path, 0, &lock) == BW_OK ? 'y' : 'n';
    if (write(ready[1], &word, 1) != 1)
      _exit(1);
    for (;;)
      pause();
  }
  char word = 0;
  assert_int_equal(read(ready[0], &word, 1), 1);
  assert_int_equal(word, 'y');
  close(ready[0]);
  close(ready[1]);
  return child;
}

static void locks(void **state) {
  bw_context *context = check_context(state);
  char path[128];
  snprintf(path, sizeof path, "%s", in_folder("lock"));
  bw_lock *lock = NULL, *other = NULL;
  check_ok(context, bw_lock_take(context, path, 0, &lock));
  check_fails(context, BW_LIMIT, "this process", bw_lock_take(context, path, 0, &other));
  /* Asking did not give it up: a child that did not inherit it is refused, too. */
  pid_t child = fork();
  if (child == 0) {
    bw_context *own = bw_context_create();
    bw_status status = bw_lock_take(own, path, 0.05, &other);
    bw_release(lock); /* what was inherited is not the child's to give up */
    _exit(status == BW_LIMIT && strstr(bw_message(own), "process ") ? 0 : 1);
  }
  int how = 0;
  waitpid(child, &how, 0);
  assert_int_equal(how, 0);
  assert_int_equal(access(path, F_OK), 0);
  bw_release(lock);
  assert_int_not_equal(access(path, F_OK), 0);
  /* A process that is killed leaves the file, and not the lock. */
  child = holder(path);
  check_fails(context, BW_LIMIT, "process", bw_lock_take(context, path, 0, &other));
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  check_ok(context, bw_lock_take(context, path, 0, &lock));
  bw_release(lock);
  check_fails(context, BW_IO, "no/lock", bw_lock_take(context, in_folder("no/lock"), 0, &lock));
  check_each_allocation(context, status, 1) {
    status = bw_lock_take(context, path, 0, &lock);
  }
  bw_release(lock);
}

/* Many processes count in one file under one lock: none is lost. */
static void one_at_a_time(void **state) {
  bw_context *context = check_context(state);
  (void)context;
  enum { PROCESSES = 4, TURNS = 25 };
  char path[128], number[128];
  snprintf(path, sizeof path, "%s", in_folder("turn"));
  snprintf(number, sizeof number, "%s", in_folder("number"));
  pid_t child[PROCESSES];
  for (int i = 0; i < PROCESSES; i++) {
    child[i] = fork();
    if (child[i] != 0)
      continue;
    bw_context *own = bw_context_create();
    for (int turn = 0; turn < TURNS; turn++) {
      bw_lock *lock = NULL;
      if (bw_lock_take(own, path, 60, &lock) != BW_OK)
        _exit(1);
      int value = 0;
      FILE *file = fopen(number, "r");
      if (file) {
        if (fscanf(file, "%d", &value) != 1)
          _exit(2);
        fclose(file);
      }
      file = fopen(number, "w");
      fprintf(file, "%d", value + 1);
      fclose(file);
      bw_release(lock);
    }
    _exit(0);
  }
  for (int i = 0; i < PROCESSES; i++) {
    int how = 1;
    waitpid(child[i], &how, 0);
    assert_int_equal(how, 0);
  }
  int value = 0;
  FILE *file = fopen(number, "r");
  assert_int_equal(fscanf(file, "%d", &value), 1);
  fclose(file);
  assert_int_equal(value, PROCESSES * TURNS);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(digests_of_bytes), check_test(folders),
                                     check_test(locks), check_test(one_at_a_time)};
  return cmocka_run_group_tests(tests, make_place, drop_place);
}
