/* Files of results: what is refused and how it is reported, what survives, what can be saved. */
#include "check.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "study/internal.h"

enum { ROWS = 3000 };

static char folder[64];

static const char *path_of(const char *name) {
  static char path[8][128];
  static int turn;
  turn = (turn + 1) % 8;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

static int make_folder(void **state) {
  snprintf(folder, sizeof folder, "/tmp/barwright_database_XXXXXX");
  return mkdtemp(folder) ? check_setup(state) : -1;
}

static int remove_folder(void **state) {
  char command[128];
  int status = check_teardown(state);
  umount2(folder, MNT_DETACH); /* what a failed test left */
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command) == 0 ? status : -1;
}

#define check_file_test(function)                                                                  \
  cmocka_unit_test_setup_teardown(function, make_folder, remove_folder)

static bw_database *open_file(bw_context *context, const char *path) {
  bw_database *d = NULL;
  check_ok(context, bw_database_open(context, path, NULL, &d));
  return d;
}

/* The text of row i. */
static void note_of(int i, char note[200]) {
  snprintf(
      note, 200, "%d: %.*s", i, 40 + i % 50,
      "the quick brown fox jumps over the lazy dog, and over the next one, and over all of it");
}

static bw_status add_row(bw_context *context, bw_database *d, int i) {
  bw_statement *s = NULL;
  char note[200];
  bool row = true;
  bw_status status;
  note_of(i, note);
  BW_TRY(bw_database_prepare(context, d, "INSERT INTO trial VALUES (?, ?, ?, NULL)", &s));
  BW_TRY(bw_statement_bind_text(context, s, 0, note, strlen(note)));
  BW_TRY(bw_statement_bind_integer(context, s, 1, i));
  BW_TRY(bw_statement_bind_real(context, s, 2, i / 3.0));
  BW_TRY(bw_statement_step(context, s, &row));
done:
  if (status != BW_OK || row)
    bw_statement_put_back(s);
  return status;
}

static const char schema[] =
    "CREATE TABLE study (name TEXT, value TEXT);"
    "INSERT INTO study VALUES ('seed', '1'), ('name', 'hook');"
    "CREATE TABLE trial (note TEXT PRIMARY KEY, number INTEGER, mass REAL, empty);"
    "CREATE INDEX by_number ON trial (number); CREATE VIEW light AS SELECT * FROM trial WHERE mass "
    "< 10";

static void make_file(bw_context *context, const char *path, int rows) {
  bw_database *d = open_file(context, path);
  check_ok(context, bw_database_execute(context, d, schema));
  check_ok(context, bw_database_execute(context, d, "BEGIN"));
  for (int i = 1; i <= rows; i++)
    check_ok(context, add_row(context, d, i));
  check_ok(context, bw_database_execute(context, d, "COMMIT"));
  bw_release(d);
}

/* How many rows there are; each is what was put in. */
static int count_rows(bw_context *context, bw_database *d) {
  bw_statement *s = NULL;
  bool row;
  int count = 0;
  check_ok(context, bw_database_prepare(context, d, "SELECT * FROM trial ORDER BY number", &s));
  for (;; count++) {
    bw_sql_value note, number, mass, nothing;
    check_ok(context, bw_statement_step(context, s, &row));
    if (!row)
      return count;
    check_ok(context, bw_statement_value(context, s, 0, &note));
    check_ok(context, bw_statement_value(context, s, 1, &number));
    check_ok(context, bw_statement_value(context, s, 2, &mass));
    check_ok(context, bw_statement_value(context, s, 3, &nothing));
    char text[200];
    note_of((int)number.integer, text);
    assert_int_equal(note.length, strlen(text));
    assert_memory_equal(note.text, text, note.length);
    check_near(mass.real, (double)number.integer / 3.0, 0);
    assert_int_equal(nothing.type, BW_SQL_NONE);
  }
}

static void overwrite(const char *path, int64_t at, int64_t count, int with) {
  int file = open(path, O_WRONLY);
  assert_true(file >= 0);
  for (int64_t i = 0; i < count; i++) {
    unsigned char byte =
        with >= 0 ? (unsigned char)with : (unsigned char)(at * 31 + i * 7 + i / 13);
    assert_int_equal(pwrite(file, &byte, 1, at + i), 1);
  }
  close(file);
}

static int64_t size_of(const char *path) {
  struct stat about;
  assert_int_equal(stat(path, &about), 0);
  return about.st_size;
}

static void check_refused(bw_context *context, const char *path, bool read_only, bw_status status,
                          const char *reason, const char *text) {
  bw_database *d = NULL;
  bw_database_options options = {read_only, 0.1};
  check_fails(context, status, text, bw_database_open(context, path, &options, &d));
  assert_null(d);
  const char *key, *word;
  double number;
  bool found = false;
  for (int i = 0; bw_detail(context, i, &key, &number, &word); i++)
    found = found || (strcmp(key, "reason") == 0 && word && strcmp(word, reason) == 0);
  assert_true(found || !reason);
}

/* ---- opening --------------------------------------------------------------------------------- */

static void test_opening(void **state) {
  bw_context *context = check_context(state);
  const char *path = path_of("a");
  make_file(context, path, 100);
  assert_int_equal(access(path_of("a-wal"), F_OK), -1); /* closed: all is in the file */
  path = path_of("a");
  bw_database_options options = {true, 1};
  bw_database *d = NULL;
  options.busy_seconds = NAN;
  check_fails(context, BW_INVALID, "busy_seconds", bw_database_open(context, path, &options, &d));
  options.busy_seconds = 1;
  check_ok(context, bw_database_open(context, path, &options, &d));
  assert_int_equal(count_rows(context, d), 100);
  check_fails(context, BW_IO, "readonly", bw_database_execute(context, d, "DELETE FROM trial"));
  char *problems = "";
  check_ok(context, bw_database_check(context, d, 10, &problems));
  assert_null(problems);
  bw_release(d);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  const char *path = path_of("foreign");
  sqlite3 *other;
  assert_int_equal(sqlite3_open(path, &other), SQLITE_OK);
  sqlite3_exec(other, "CREATE TABLE recipes (name)", NULL, NULL, NULL);
  sqlite3_close(other);
  check_refused(context, path, false, BW_FORMAT, "foreign", "another program");
  path = path_of("newer");
  make_file(context, path, 1);
  assert_int_equal(sqlite3_open(path, &other), SQLITE_OK);
  sqlite3_exec(other, "PRAGMA user_version=7", NULL, NULL, NULL);
  sqlite3_close(other);
  check_refused(context, path, false, BW_FORMAT, "newer", "its format is 7");
  check_refused(context, folder, false, BW_IO, NULL, "a folder");
  check_refused(context, path_of("none"), true, BW_IO, NULL, "No such file");
  check_refused(context, path_of("none/none"), false, BW_IO, NULL, "unable to open");
  path = path_of("short");
  make_file(context, path, 1);
  assert_int_equal(truncate(path, 50), 0);
  check_refused(context, path, false, BW_FORMAT, "damaged", "ends after 50 bytes");
  path = path_of("words");
  FILE *file = fopen(path, "w");
  for (int i = 0; i < 1000; i++)
    fprintf(file, "number,mass\n%d,2\n", i);
  fclose(file);
  check_refused(context, path, false, BW_FORMAT, "foreign", "not a database");
}

static void test_read_only_folder(void **state) {
  bw_context *context = check_context(state);
  make_file(context, path_of("a"), 10);
  chmod(path_of("a"), 0444);
  chmod(folder, 0555);
  if (access(folder, W_OK) != 0) { /* root may write everywhere */
    check_refused(context, path_of("b"), false, BW_IO, NULL, "unable to open");
    bw_database *d = NULL;
    bw_database_options options = {true, 1};
    check_ok(context, bw_database_open(context, path_of("a"), &options, &d));
    assert_int_equal(count_rows(context, d), 10);
    bw_release(d);
  }
  chmod(folder, 0755);
}

static void test_two_openers(void **state) {
  bw_context *context = check_context(state);
  enum { OPENERS = 4, EACH = 25 };
  const char *path = path_of("a");
  bw_database *one = open_file(context, path), *two = open_file(context, path);
  check_ok(context, bw_database_execute(context, one, schema));
  check_ok(context, add_row(context, two, 1));
  check_ok(context, add_row(context, one, 2));
  assert_int_equal(count_rows(context, two), 2);
  bw_release(one);
  bw_release(two);
  /* Processes that make the same file at the same time, and write in turn. */
  path = path_of("b");
  pid_t process[OPENERS];
  for (int k = 0; k < OPENERS; k++) {
    process[k] = fork();
    if (process[k] == 0) {
      bw_database *d = NULL;
      bw_status status = bw_database_open(context, path, NULL, &d);
      if (status == BW_OK)
        status = bw_database_execute(context, d,
                                     "CREATE TABLE IF NOT EXISTS trial (note TEXT PRIMARY "
                                     "KEY, number INTEGER, mass REAL, empty)");
      for (int i = 0; i < EACH && status == BW_OK; i++)
        status = add_row(context, d, 1 + k * EACH + i);
      if (status != BW_OK)
        fprintf(stderr, "%s\n", bw_message(context));
      bw_release(d);
      _exit(status == BW_OK ? 0 : 1);
    }
  }
  for (int k = 0; k < OPENERS; k++) {
    int how = -1;
    waitpid(process[k], &how, 0);
    assert_int_equal(how, 0);
  }
  one = open_file(context, path);
  assert_int_equal(count_rows(context, one), OPENERS * EACH);
  bw_release(one);
}

/* ---- full disk ------------------------------------------------------------------------------- */

/* Rows until the file may not grow, and what is there afterwards. */
static void fill_up(bw_context *context, const char *path, const char *text) {
  bw_database *d = open_file(context, path);
  check_ok(context, bw_database_execute(context, d, schema));
  bw_status status = BW_OK;
  int rows = 0;
  for (; status == BW_OK && rows < 100000; rows++)
    status = add_row(context, d, rows + 1);
  rows--;
  check_fails(context, BW_LIMIT, text, status);
  const char *key, *word;
  double number;
  assert_true(bw_detail(context, 0, &key, &number, &word));
  assert_string_equal(word, "full");
  assert_true(rows > 10);
  assert_int_equal(count_rows(context, d), rows);
  assert_false(bw_database_inside_transaction(d));
  bw_release(d);
}

static void test_full_disk(void **state) {
  bw_context *context = check_context(state);
  if (mount("none", folder, "tmpfs", 0, "size=400k") == 0) {
    fill_up(context, path_of("a"), "no room is left");
    bw_database *d = open_file(context, path_of("a"));
    assert_true(count_rows(context, d) > 10);
    bw_release(d);
    assert_int_equal(umount(folder), 0);
  }
  struct rlimit before, small;
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = 300000;
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  fill_up(context, path_of("b"), "may not grow beyond 300000 bytes");
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
}

/* ---- damage ---------------------------------------------------------------------------------- */

static void save(bw_context *context, const char *path, int min, int max, bool exact) {
  bw_salvage_report report;
  unlink(path_of("saved"));
  check_ok(context, bw_database_salvage(context, path, path_of("saved"), NULL, false, &report));
  bw_database *d = open_file(context, path_of("saved"));
  int rows = count_rows(context, d);
  if (rows < min || rows > max)
    fail_msg("%d rows saved, %d to %d expected", rows, min, max);
  if (exact)
    assert_int_equal(rows + report.lost, ROWS);
  assert_int_equal(report.tables, 2);
  assert_int_equal(report.rows, rows + 2); /* with those of study */
  assert_int_equal(report.whole, rows == ROWS && exact);
  sqlite3 *plain; /* a view is for other programs */
  assert_int_equal(sqlite3_open(path_of("saved"), &plain), SQLITE_OK);
  assert_int_equal(sqlite3_exec(plain, "SELECT count(*) FROM light", NULL, NULL, NULL), SQLITE_OK);
  sqlite3_close(plain);
  char *problems = NULL;
  check_ok(context, bw_database_check(context, d, 10, &problems));
  assert_null(problems);
  bw_release(d);
  assert_int_equal(access(path_of("saved.reading"), F_OK), -1);
  assert_non_null(bw_warning_at(context, 0));
  bw_clear_warnings(context);
}

/* Bytes inside of values can be anything: only damage to the order shows. */
static void check_damaged(bw_context *context, const char *path, bool shows) {
  bw_database *d = NULL;
  bw_status status = bw_database_open(context, path, NULL, &d);
  char *problems = NULL;
  if (status == BW_OK) {
    status = bw_database_check(context, d, 10, &problems);
    assert_true(!shows || status != BW_OK || problems);
    bw_free(problems);
  }
  if (status != BW_OK && status != BW_FORMAT)
    fail_msg("%s (%s)", bw_message(context), bw_status_word(status));
  bw_release(d);
}

static void test_damage(void **state) {
  bw_context *context = check_context(state);
  const char *path = path_of("a");
  make_file(context, path, ROWS);
  int64_t pages = size_of(path) / 4096;
  assert_true(pages > 60);
  path = path_of("a");
  save(context, path, ROWS, ROWS, true); /* whole */
  /* The head. */
  overwrite(path, 0, 60, 0);
  check_refused(context, path, false, BW_FORMAT, "damaged", "first bytes");
  save(context, path, ROWS, ROWS, false);
  make_file(context, path_of("b"), ROWS);
  path = path_of("b");
  overwrite(path, 16, 8, 255);
  check_damaged(context, path, true);
  save(context, path, ROWS, ROWS, false);
  /* Pages here and there, emptied or overwritten. */
  int file = 0;
  for (int way = 0; way < 6; way++) {
    char name[16];
    snprintf(name, sizeof name, "c%d", file++);
    make_file(context, path_of(name), ROWS);
    path = path_of(name);
    for (int64_t page = 20 + way; page < pages; page += way < 2 ? 1000 : 23)
      overwrite(path, page * 4096, way % 2 ? 4096 : 600, way % 3 == 0 ? 0 : -1);
    check_damaged(context, path, true);
    save(context, path, ROWS / 2, ROWS, way != 5);
  }
  /* The end is missing. */
  make_file(context, path_of("d"), ROWS);
  path = path_of("d");
  assert_int_equal(truncate(path, pages / 2 * 4096), 0);
  check_damaged(context, path, true);
  save(context, path, ROWS / 10, ROWS - 1, false);
}

/* The first page is gone: with the statements that made the tables, every row is there. */
static void test_lost_list(void **state) {
  bw_context *context = check_context(state);
  bw_salvage_report report;
  const char *path = path_of("a");
  make_file(context, path, ROWS);
  overwrite(path, 0, 4096, -1);
  check_fails(context, BW_FORMAT, "nothing can be saved",
              bw_database_salvage(context, path, path_of("b"), NULL, false, &report));
  check_ok(context, bw_database_salvage(context, path, path_of("b"), schema, false, &report));
  assert_true(report.relisted && !report.whole);
  assert_int_equal(report.lost, 0);
  bw_database *d = open_file(context, path_of("b"));
  assert_int_equal(count_rows(context, d), ROWS);
  bw_release(d);
}

static void test_nothing_to_save(void **state) {
  bw_context *context = check_context(state);
  bw_salvage_report report;
  const char *path = path_of("a");
  make_file(context, path, 100);
  check_fails(context, BW_IO, "there is a file already",
              bw_database_salvage(context, path, path, NULL, false, &report));
  check_fails(context, BW_IO, "No such file",
              bw_database_salvage(context, path_of("none"), path_of("b"), NULL, false, &report));
  overwrite(path, 100, 3996, 255);
  check_fails(context, BW_FORMAT, "nothing can be saved",
              bw_database_salvage(context, path, path_of("b"), NULL, false, &report));
  assert_int_equal(access(path_of("b"), F_OK), -1);
  assert_int_equal(truncate(path, 300), 0);
  check_fails(context, BW_FORMAT, "only 300 bytes",
              bw_database_salvage(context, path, path_of("b"), NULL, false, &report));
}

/* Whatever bytes are overwritten: a status, never a crash. */
static void test_random_damage(void **state) {
  bw_context *context = check_context(state);
  int rounds = getenv("BARWRIGHT_FULL") ? 400 : 25;
  make_file(context, path_of("whole"), 400);
  int64_t size = size_of(path_of("whole"));
  bw_random random;
  bw_random_seed(&random, 1);
  for (int round = 0; round < rounds; round++) {
    char command[256];
    snprintf(command, sizeof command, "cp '%s/whole' '%s/hurt'; rm -f '%s/saved'", folder, folder,
             folder);
    assert_int_equal(system(command), 0);
    const char *path = path_of("hurt");
    int places = 1 + (int)(bw_random_uniform(&random) * 12);
    for (int i = 0; i < places; i++)
      overwrite(path, (int64_t)(bw_random_uniform(&random) * (double)(size - 300)),
                1 + (int64_t)(bw_random_uniform(&random) * 299), -1);
    check_damaged(context, path, false);
    bw_salvage_report report;
    bw_status status = bw_database_salvage(context, path, path_of("saved"), NULL, false, &report);
    if (status != BW_OK && status != BW_FORMAT)
      fail_msg("%s (%s)", bw_message(context), bw_status_word(status));
    if (status == BW_OK) {
      bw_database *d = open_file(context, path_of("saved"));
      bw_release(d);
    }
    bw_clear_warnings(context);
  }
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void test_statements(void **state) {
  bw_context *context = check_context(state);
  make_file(context, path_of("a"), 20);
  bw_database *d = open_file(context, path_of("a"));
  bw_statement *s[70] = {NULL};
  bool row;
  /* More texts than are kept, and then more at once. */
  for (int i = 0; i < 200; i++) {
    char sql[64];
    snprintf(sql, sizeof sql, "SELECT %d", i);
    check_ok(context, bw_database_prepare(context, d, sql, &s[0]));
    check_ok(context, bw_statement_step(context, s[0], &row));
    bw_sql_value value;
    check_ok(context, bw_statement_value(context, s[0], 0, &value));
    assert_int_equal(value.integer, i);
    bw_statement_put_back(s[0]);
  }
  int many = 0;
  while (bw_database_prepare(context, d, "SELECT * FROM trial", &s[many]) == BW_OK)
    many++;
  assert_int_equal(many, BWI_STATEMENTS_KEPT);
  assert_non_null(strstr(bw_message(context), "in use"));
  for (int i = 0; i < many; i++)
    bw_statement_put_back(s[i]);
  assert_int_equal(count_rows(context, d), 20);
  /* A row that is refused leaves the statement usable. */
  check_fails(context, BW_INFEASIBLE, "UNIQUE", add_row(context, d, 5));
  check_ok(context, add_row(context, d, 21));
  assert_int_equal(bw_database_changed(d), 1);
  bw_cancel(context);
  check_fails(
      context, BW_CANCELLED, "",
      bw_database_execute(context, d,
                          "SELECT count(*) FROM trial a, trial b, trial c, trial d, trial e, "
                          "trial f, trial g, trial h"));
  bw_clear_cancel(context);
  assert_int_equal(count_rows(context, d), 21);
  bw_release(d);
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_status status = BW_MEMORY;
  for (int n = 1; status != BW_OK; n++) {
    bw_database *d = NULL;
    assert_true(n < 30);
    unlink(path_of("a"));
    unlink(path_of("saved"));
    bw_salvage_report report;
    bw_fail_allocation(n, true);
    BW_TRY(bw_database_open(context, path_of("a"), NULL, &d));
    BW_TRY(bw_database_execute(context, d, schema));
    BW_TRY(add_row(context, d, 1));
    BW_TRY(bw_database_salvage(context, path_of("a"), path_of("saved"), schema, false, &report));
  done:
    bw_fail_allocation(0, false);
    bw_release(d);
    bw_clear_warnings(context);
    assert_true(status == BW_OK || status == BW_MEMORY);
  }
}

check_main(check_file_test(test_opening), check_file_test(test_refused),
           check_file_test(test_read_only_folder), check_file_test(test_two_openers),
           check_file_test(test_full_disk), check_file_test(test_damage),
           check_file_test(test_lost_list), check_file_test(test_nothing_to_save),
           check_file_test(test_random_damage), check_file_test(test_statements),
           check_file_test(test_allocation_failures))
