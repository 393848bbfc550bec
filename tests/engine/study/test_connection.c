/* What a statement may do on a file of results (S6): SQLite's own lists of functions and pragmas,
 * kinds of statements, files that are made to do harm, names with a meaning of their own. */
#include "check.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "barwright/confine.h"
#include "study/internal.h"

static char folder[64];

static const char *path_of(const char *name) {
  static char path[8][256];
  static int turn;
  turn = (turn + 1) % 8;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

static int make_folder(void **state) {
  snprintf(folder, sizeof folder, "/tmp/barwright_connection_XXXXXX");
  return mkdtemp(folder) ? check_setup(state) : -1;
}

static int remove_folder(void **state) {
  char command[128];
  int status = check_teardown(state);
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command) == 0 ? status : -1;
}

#define check_file_test(function)                                                                  \
  cmocka_unit_test_setup_teardown(function, make_folder, remove_folder)

static bw_database *open_file(bw_context *context, const char *name) {
  bw_database *d = NULL;
  check_ok(context, bw_database_open(context, path_of(name), NULL, &d));
  check_ok(context, bw_database_execute(context, d, "CREATE TABLE IF NOT EXISTS t (a, b)"));
  return d;
}

/* Whether SQLite compiles and runs the statement. */
static bool works(bw_context *context, bw_database *d, const char *sql) {
  bw_statement *s = NULL;
  bool row = true;
  bw_status status = bw_database_prepare(context, d, sql, &s);
  while (status == BW_OK && row)
    status = bw_statement_step(context, s, &row);
  if (status == BW_OK)
    return true;
  if (s)
    bw_statement_put_back(s);
  if (bw_database_inside_transaction(d))
    bw_database_execute(context, d, "ROLLBACK");
  return false;
}

static bool is_one_of(const char *name, const char *const *list) {
  for (; *list; list++)
    if (strcmp(name, *list) == 0)
      return true;
  return false;
}

/* Calls visit with each row of a list that SQLite itself gives. */
static void visit(const char *sql, void (*each)(void *data, const char *name, int arguments),
                  void *data) {
  sqlite3 *plain;
  sqlite3_stmt *row;
  assert_int_equal(sqlite3_open(":memory:", &plain), SQLITE_OK);
  assert_int_equal(sqlite3_prepare_v2(plain, sql, -1, &row, NULL), SQLITE_OK);
  while (sqlite3_step(row) == SQLITE_ROW)
    each(data, (const char *)sqlite3_column_text(row, 0), sqlite3_column_int(row, 1));
  sqlite3_finalize(row);
  sqlite3_close(plain);
}

typedef struct trial {
  bw_context *context;
  bw_database *d;
  int tried, worked;
} trial;

/* ---- functions ------------------------------------------------------------------------------- */

static void try_function(void *data, const char *name, int arguments) {
  static const char *const known[] = {"count", "max", "min", "sum", NULL};
  static const char *const list[] = {"", "a", "a, 'x'", "a, 'x', 1"};
  static const char *const form[] = {"SELECT \"%s\"(%s) FROM t",
                                     "SELECT \"%s\"(%s) OVER (ORDER BY a) FROM t",
                                     "INSERT INTO t (a) SELECT \"%s\"(%s) FROM t",
                                     "CREATE TABLE u (a, b AS (\"%s\"(%s)))",
                                     "CREATE TABLE u (a, CHECK (\"%s\"(%s)))",
                                     "CREATE INDEX u ON t (\"%s\"(%s))",
                                     "CREATE TABLE u (a DEFAULT (\"%s\"(%s)))"};
  trial *it = (trial *)data;
  int min = arguments < 0 ? 0 : arguments, max = arguments < 0 ? 3 : arguments;
  if (is_one_of(name, known))
    return;
  for (int n = min; n <= max && n < 4; n++)
    for (size_t i = 0; i < sizeof form / sizeof *form; i++) {
      char sql[256];
      snprintf(sql, sizeof sql, form[i], name, list[n]);
      it->tried++;
      if (!works(it->context, it->d, sql))
        continue;
      /* The operand of a default is looked up when a row is written. */
      if (strstr(sql, "DEFAULT") && !works(it->context, it->d, "INSERT INTO u DEFAULT VALUES")) {
        it->d = (bw_release(it->d), unlink(path_of("a")), open_file(it->context, "a"));
        continue;
      }
      fail_msg("works: %s", sql);
    }
}

static void test_functions(void **state) {
  trial it = {.context = check_context(state)};
  it.d = open_file(it.context, "a");
  visit("SELECT DISTINCT name, narg FROM pragma_function_list", try_function, &it);
  assert_true(it.tried > 500);
  check_ok(it.context,
           bw_database_execute(it.context, it.d, "SELECT count(*), max(a), min(a), sum(a) FROM t"));
  assert_false(works(it.context, it.d, "SELECT a LIKE 'x' FROM t"));
  assert_false(works(it.context, it.d, "SELECT a GLOB 'x' FROM t"));
  assert_false(works(it.context, it.d, "SELECT a MATCH 'x' FROM t"));
  assert_false(works(it.context, it.d, "SELECT a -> 'x' FROM t"));
  assert_false(works(it.context, it.d, "SELECT CURRENT_TIMESTAMP"));
  bw_release(it.d);
}

/* ---- pragmas --------------------------------------------------------------------------------- */

static void try_pragma(void *data, const char *name, int unused) {
  static const char *const with_any[] = {"application_id", "user_version", "quick_check",
                                         "table_xinfo", NULL};
  static const char *const with_this[] = {"cell_size_check=ON", "journal_mode=DELETE", NULL};
  static const char *const argument[] = {"",    "=1",  "=ON",     "='x'",
                                         "(1)", "(t)", "=DELETE", "='/tmp/barwright_nowhere'"};
  static const char *const form[] = {"PRAGMA %s", "PRAGMA main.%s", "PRAGMA temp.%s",
                                     "SELECT * FROM pragma_%s"};
  (void)unused;
  trial *it = (trial *)data;
  for (size_t i = 0; i < sizeof argument / sizeof *argument; i++) {
    char words[128], sql[160];
    snprintf(words, sizeof words, "%s%s", name, argument[i]);
    bool known = is_one_of(name, with_any) || is_one_of(words, with_this);
    for (int way = 0; way < 4; way++) {
      snprintf(sql, sizeof sql, form[way], words);
      it->tried++;
      bool good = works(it->context, it->d, sql);
      it->worked += good;
      if (good && (!known || way > 1))
        fail_msg("works: %s", sql);
    }
  }
}

static void test_pragmas(void **state) {
  trial it = {.context = check_context(state)};
  it.d = open_file(it.context, "a");
  visit("SELECT DISTINCT name, 0 FROM pragma_pragma_list", try_pragma, &it);
  assert_true(it.tried > 500);
  assert_true(it.worked > 0);
  assert_true(works(it.context, it.d, "PRAGMA journal_mode = delete"));
  assert_true(works(it.context, it.d, "PRAGMA journal_mode = WAL"));
  bw_release(it.d);
}

/* ---- statements ------------------------------------------------------------------------------ */

static void test_statements(void **state) {
  static const char *const good[] = {
      "INSERT INTO t VALUES (1, 2)",
      "INSERT OR REPLACE INTO t VALUES (1, 2)",
      "UPDATE t SET a = 3",
      "SELECT * FROM t WHERE a IN (SELECT b FROM t) ORDER BY a LIMIT 2",
      "DELETE FROM t WHERE a = 1",
      "SELECT 1 UNION SELECT 2",
      "WITH x AS (SELECT 1) SELECT * FROM x",
      "CREATE TABLE v (a, b)",
      "CREATE INDEX i ON t (a)",
      "CREATE UNIQUE INDEX j ON v (a, b)",
      "CREATE VIEW w AS SELECT 1",
      "SELECT name FROM sqlite_master",
      "BEGIN",
      "COMMIT",
      "BEGIN IMMEDIATE",
      "ROLLBACK",
      "SELECT t.a, p.b FROM t LEFT JOIN t p ON p.a = t.a",
      NULL};
  static const char *const bad[] = {
      "ATTACH '/tmp/barwright_nowhere' AS x",
      "ATTACH ':memory:' AS x",
      "ATTACH '' AS x",
      "ATTACH 'file:x?mode=memory' AS x",
      "DETACH main",
      "DETACH temp",
      "VACUUM",
      "VACUUM INTO '/tmp/barwright_nowhere'",
      "VACUUM main INTO 'x'",
      "ANALYZE",
      "ANALYZE t",
      "CREATE VIRTUAL TABLE x USING fts3",
      "CREATE VIRTUAL TABLE x USING fts4(a, tokenize=simple)",
      "CREATE VIRTUAL TABLE x USING fts5(a)",
      "CREATE VIRTUAL TABLE x USING rtree(a, b, c)",
      "CREATE VIRTUAL TABLE x USING fts3tokenize",
      "CREATE VIRTUAL TABLE x USING dbstat",
      "CREATE VIRTUAL TABLE x USING fts4aux(t)",
      "CREATE VIRTUAL TABLE temp.x USING fts3",
      "CREATE TEMP TABLE x (a)",
      "CREATE TABLE temp.x (a)",
      "CREATE TEMP VIEW x AS SELECT 1",
      "CREATE TEMP TRIGGER x AFTER INSERT ON t BEGIN DELETE FROM t; END",
      "CREATE TRIGGER x AFTER INSERT ON t BEGIN DELETE FROM t; END",
      "DROP TABLE t",
      "DROP VIEW w",
      "DROP INDEX i",
      "ALTER TABLE t RENAME TO u",
      "ALTER TABLE t ADD COLUMN c",
      "ALTER TABLE t DROP COLUMN b",
      "ALTER TABLE t RENAME COLUMN a TO c",
      "SAVEPOINT x",
      "RELEASE x",
      "EXPLAIN SELECT 1",
      "EXPLAIN QUERY PLAN SELECT 1",
      "EXPLAIN DELETE FROM t",
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n LIMIT 9",
      "UPDATE sqlite_master SET sql = 'x'",
      "DELETE FROM sqlite_master",
      "INSERT INTO sqlite_master VALUES ('table', 'x', 'x', 2, 'CREATE TABLE x (a)')",
      "REPLACE INTO sqlite_schema VALUES ('table', 'x', 'x', 2, 'CREATE TABLE x (a)')",
      "SELECT * FROM w",
      "SELECT * FROM json_each('[1]')",
      "SELECT * FROM json_tree('[1]')",
      "SELECT * FROM dbstat",
      "SELECT * FROM sqlite_stmt",
      "SELECT * FROM generate_series(1, 2)",
      "SELECT * FROM sqlite_dbpage",
      "SELECT * FROM fts3tokenize('simple', 'a')",
      "SELECT * FROM bytecode('SELECT 1')",
      "SELECT * FROM tables_used('SELECT 1')",
      "SELECT fts3_tokenizer('simple')",
      "SELECT hex(fts3_tokenizer(a)) FROM t",
      "SELECT fts3_tokenizer('x', a) FROM t",
      "SELECT load_extension('x')",
      "SELECT load_extension('x', 'y')",
      "SELECT readfile('/etc/passwd')",
      "SELECT writefile('x', 'y')",
      "SELECT zeroblob(1000000000)",
      "SELECT randomblob(1000000000)",
      "SELECT printf('%1000000000d', 1)",
      "SELECT RAISE(IGNORE)",
      "INSERT INTO x SELECT 1",
      "SELECT 1; SELECT 2",
      "",
      ";",
      "\n--x",
      NULL};
  bw_context *context = check_context(state);
  bw_database *d = open_file(context, "a");
  for (int i = 0; good[i]; i++)
    if (!works(context, d, good[i]))
      fail_msg("refused: %s: %s", good[i], bw_message(context));
  for (int i = 0; bad[i]; i++)
    if (works(context, d, bad[i]))
      fail_msg("works: %s", bad[i]);
  for (int i = 0; bad[i]; i++) /* the other way in */
    if (strncmp(bad[i], "EXPLAIN", 7) != 0 && strncmp(bad[i], "SELECT 1;", 9) != 0 &&
        strlen(bad[i]) > 4 && bw_database_execute(context, d, bad[i]) == BW_OK)
      fail_msg("works: %s", bad[i]);
  check_fails(context, BW_INVALID, "only statements that studies need",
              bw_database_execute(context, d, "ATTACH 'x' AS y"));
  /* Text that is far larger than a study's. */
  size_t size = (size_t)80 << 20;
  char *large = (char *)malloc(size);
  assert_non_null(large);
  memset(large, 'x', size);
  bw_statement *s = NULL;
  check_ok(context, bw_database_prepare(context, d, "INSERT INTO t (a) VALUES (?)", &s));
  check_fails(context, BW_LIMIT, "too big", bw_statement_bind_text(context, s, 0, large, size));
  bw_statement_put_back(s);
  free(large);
  bw_release(d);
}

/* ---- files that do harm ---------------------------------------------------------------------- */

/* A file of barwright into which another program put this; the tables are those of a study. */
static void make_hostile(bw_context *context, const char *name, const char *sql) {
  sqlite3 *plain;
  char *why = NULL;
  unlink(path_of(name));
  bw_release(open_file(context, name));
  assert_int_equal(sqlite3_open(path_of(name), &plain), SQLITE_OK);
  sqlite3_exec(plain, sql, NULL, NULL, &why);
  if (why)
    fail_msg("%s: %s", sql, why);
  sqlite3_close(plain);
}

static void test_hostile_files(void **state) {
  static const struct {
    const char *put, *used;
  } harm[] = {
      {"CREATE VIEW trials AS SELECT hex(fts3_tokenizer('simple')) AS key", "SELECT * FROM trials"},
      {"CREATE VIEW trials AS SELECT load_extension('x') AS key", "SELECT * FROM trials"},
      {"CREATE VIEW trials AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
       "SELECT i "
       "FROM n",
       "SELECT * FROM trials"},
      /* 2^40 copies, before the first step */
      {"CREATE VIEW v0 AS SELECT 1 AS a; CREATE VIEW v1 AS SELECT a FROM v0 UNION ALL SELECT a "
       "FROM v0;"
       "CREATE VIEW v2 AS SELECT a FROM v1 UNION ALL SELECT a FROM v1;"
       "CREATE VIEW trials AS SELECT a FROM v2 UNION ALL SELECT a FROM v2",
       "SELECT * FROM trials"},
      {"CREATE VIRTUAL TABLE trials USING fts3(a)", "SELECT * FROM trials"},
      {"CREATE VIRTUAL TABLE trials USING fts4(a)", "INSERT INTO trials VALUES ('x')"},
      {"CREATE VIRTUAL TABLE trials USING rtree(a, b, c)", "SELECT * FROM trials"},
      {"CREATE TABLE trials (a, b AS (hex(a))); INSERT INTO trials VALUES (1)",
       "SELECT b FROM trials"},
      {"CREATE TABLE trials (a, b AS (a LIKE '%a%a%a%a%a%b')); INSERT INTO trials VALUES ('aaaa')",
       "SELECT b FROM trials"},
      {"CREATE TABLE trials (a, CHECK (length(hex(a)) > 1))", "INSERT INTO trials VALUES (1)"},
      {"CREATE TABLE trials (a DEFAULT (hex(1)), b)", "INSERT INTO trials (b) VALUES (1)"},
      {"CREATE TABLE trials (a); CREATE INDEX i ON trials (hex(a)); INSERT INTO trials VALUES (1)",
       "SELECT * FROM trials WHERE hex(a) = 'x'"},
      {"CREATE TABLE trials (a); CREATE INDEX i ON trials (a) WHERE hex(a) > 'x'",
       "INSERT INTO trials VALUES (1)"},
  };
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof harm / sizeof *harm; i++) {
    make_hostile(context, "a", harm[i].put);
    bw_database *d = NULL;
    bw_status status = bw_database_open(context, path_of("a"), NULL, &d);
    if (status == BW_OK && works(context, d, harm[i].used))
      fail_msg("works: %s", harm[i].put);
    bw_release(d);
    /* Nor does salvage run it. */
    bw_salvage_report report;
    unlink(path_of("saved"));
    bw_clear_warnings(context);
    status = bw_database_salvage(context, path_of("a"), path_of("saved"), NULL, false, &report);
    if (status != BW_OK && status != BW_FORMAT)
      fail_msg("%s: %s", harm[i].put, bw_message(context));
  }
  /* A trigger does not run. */
  make_hostile(context, "a",
               "CREATE TABLE u (a); CREATE TRIGGER x AFTER INSERT ON t BEGIN INSERT INTO u VALUES "
               "(load_extension('x')); END");
  bw_database *d = open_file(context, "a");
  assert_true(works(context, d, "INSERT INTO t VALUES (1, 2)"));
  bw_release(d);
}

/* The statements of a schema are a script's as well. */
static void test_hostile_schema(void **state) {
  bw_context *context = check_context(state);
  char sql[256];
  bw_salvage_report report;
  bw_release(open_file(context, "a"));
  snprintf(sql, sizeof sql, "ATTACH '%s' AS x; CREATE TABLE x.y (z)", path_of("outside"));
  assert_int_not_equal(
      bw_database_salvage(context, path_of("a"), path_of("saved"), sql, false, &report), BW_OK);
  snprintf(sql, sizeof sql, "VACUUM INTO '%s'", path_of("outside"));
  assert_int_not_equal(
      bw_database_salvage(context, path_of("a"), path_of("saved"), sql, false, &report), BW_OK);
  assert_int_not_equal(bw_database_salvage(context, path_of("a"), path_of("saved"),
                                           "CREATE TABLE x AS SELECT fts3_tokenizer('simple')",
                                           false, &report),
                       BW_OK);
  assert_int_equal(access(path_of("outside"), F_OK), -1);
  assert_int_equal(access(path_of("saved"), F_OK), -1);
}

/* ---- names ----------------------------------------------------------------------------------- */

static void test_names(void **state) {
  static const char *const names[] = {
      ":memory:",           "file:x?mode=memory",         "file:a", "file:%61",
      "file:a?immutable=1", "file::memory:?cache=shared", "-x",     "a?b#c"};
  bw_context *context = check_context(state);
  char before[4096];
  assert_non_null(getcwd(before, sizeof before));
  assert_int_equal(chdir(folder), 0);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    bw_database *d = NULL;
    check_ok(context, bw_database_open(context, names[i], NULL, &d));
    check_ok(context, bw_database_execute(context, d, "CREATE TABLE t (a)"));
    bw_release(d);
    struct stat about;
    assert_int_equal(stat(path_of(names[i]), &about), 0); /* a file of this very name */
    assert_true(about.st_size > 0);
    bw_database_options options = {true, 1};
    check_ok(context, bw_database_open(context, names[i], &options, &d));
    bw_release(d);
    static const char *const endings[] = {"", "-wal", "-shm"};
    for (int k = 0; k < 3; k++) {
      char name[128];
      snprintf(name, sizeof name, "%s%s", names[i], endings[k]);
      assert_true(unlink(path_of(name)) == 0 || k > 0);
    }
  }
  assert_int_equal(chdir(before), 0);
  assert_int_equal(rmdir(folder), 0); /* nothing else was made */
  assert_int_equal(mkdir(folder, 0777), 0);
}

/* ---- a confined process ---------------------------------------------------------------------- */

static void make_journal(const char *name, const char *database, const char *other);

/* What stands beside a file, or under the names that salvage uses, leads to a file outside. 0, or
 * the number of what was not as it should be. */
static int try_from_inside(bw_context *context) {
  static const char *const beside[] = {"linked", "journal", "shared", "ahead"};
  bw_salvage_report report;
  bw_database *d = NULL;
  char sql[400];
  if (bw_confine(context, path_of("in")) != BW_OK || chdir(path_of("in")) != 0)
    return 1;
  for (int i = 0; i < 4; i++) {
    char name[32];
    snprintf(name, sizeof name, "in/%s", beside[i]);
    if (bw_database_open(context, path_of(name), NULL, &d) == BW_OK) {
      works(context, d, "INSERT INTO t VALUES (1, 2)");
      works(context, d, "PRAGMA journal_mode = DELETE");
      works(context, d, "INSERT INTO t VALUES (3, 4)");
      works(context, d, "SELECT * FROM t");
      bw_release(d);
      d = NULL;
    }
  }
  /* A journal that appears while a file is open. */
  if (bw_database_open(context, path_of("in/late"), NULL, &d) != BW_OK)
    return 2;
  works(context, d, "PRAGMA journal_mode = DELETE");
  make_journal("in/late-journal", "in/late", "secret");
  works(context, d, "SELECT * FROM t");
  works(context, d, "INSERT INTO t VALUES (1, 2)");
  bw_release(d);
  /* A folder under whose name a URI would begin. */
  d = NULL;
  snprintf(sql, sizeof sql, "file:%s", path_of("made"));
  if (bw_database_open(context, sql, NULL, &d) == BW_OK && access(path_of("made"), F_OK) == 0)
    return 3;
  bw_release(d);
  if (bw_database_salvage(context, path_of("in/whole"), path_of("in/saved"), NULL, false,
                          &report) != BW_OK)
    return 4;
  bw_clear_warnings(context);
  if (bw_database_salvage(context, path_of("in/leak"), path_of("in/leaked"), NULL, false,
                          &report) == BW_OK)
    return 5;
  if (bw_database_salvage(context, path_of("in/secret"), path_of("in/stolen"), NULL, false,
                          &report) == BW_OK ||
      bw_database_open(context, path_of("in/secret"), NULL, &d) == BW_OK)
    return 6;
  return 0;
}

/* A journal that has not been played back, and names another as the one that it belongs to. */
static void make_journal(const char *name, const char *database, const char *other) {
  unsigned char head[512] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
  struct stat about;
  uint32_t sum = 0, length;
  char full[256];
  snprintf(full, sizeof full, "%s", path_of(other));
  length = (uint32_t)strlen(full);
  if (stat(path_of(database), &about) != 0)
    return;
  head[19] = (unsigned char)(about.st_size / 4096); /* its pages */
  head[22] = 512 >> 8;
  head[26] = 4096 >> 8;
  for (uint32_t i = 0; i < length; i++)
    sum += (unsigned char)full[i];
  unsigned char tail[512], *at = tail;
  const uint32_t numbers[] = {1073741824 / 4096 + 1, length, sum};
  for (int i = 0; i < 4; i++)
    *at++ = (unsigned char)(numbers[0] >> (24 - 8 * i));
  memcpy(at, full, length);
  at += length;
  for (int k = 1; k < 3; k++)
    for (int i = 0; i < 4; i++)
      *at++ = (unsigned char)(numbers[k] >> (24 - 8 * i));
  memcpy(at, head, 8);
  at += 8;
  int file = open(path_of(name), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || write(file, head, sizeof head) < 0 || write(file, tail, (size_t)(at - tail)) < 0)
    fprintf(stderr, "%s is not written\n", name);
  close(file);
}

static void copy(const char *from, const char *to) {
  char command[700];
  snprintf(command, sizeof command, "cp '%s' '%s'", path_of(from), path_of(to));
  assert_int_equal(system(command), 0);
}

static void test_confined(void **state) {
  static const char *const links[][2] = {{"secret", "in/linked-wal"},
                                         {"secret", "in/shared-shm"},
                                         {"secret", "in/ahead-journal"},
                                         {"secret", "in/saved.reading"},
                                         {"secret", "in/saved.reading.tables"},
                                         {"secret-wal", "in/leak-wal"},
                                         {"secret", "in/secret"}};
  bw_context *context = check_context(state);
  assert_int_equal(mkdir(path_of("in"), 0777), 0);
  char made[256];
  snprintf(made, sizeof made, "mkdir -p '%s/in/file:%s'", folder, folder);
  assert_int_equal(system(made), 0);
  bw_release(open_file(context, "secret"));
  static const char *const files[] = {"in/whole", "in/linked", "in/shared",  "in/ahead",
                                      "in/late",  "in/leak",   "in/journal", "kept"};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    copy("secret", files[i]);
  copy("secret", "secret-wal");
  for (size_t i = 0; i < sizeof links / sizeof *links; i++)
    assert_int_equal(symlink(path_of(links[i][0]), path_of(links[i][1])), 0);
  make_journal("in/journal-journal", "in/journal", "secret");
  pid_t child = fork();
  if (child == 0)
    _exit(try_from_inside(context));
  int how = -1;
  assert_int_equal(waitpid(child, &how, 0), child);
  assert_true(WIFEXITED(how));
  assert_int_equal(WEXITSTATUS(how), 0);
  /* Outside all is as it was: a database, a copy of it, another copy. */
  char command[400];
  snprintf(command, sizeof command,
           "cd '%s' && cmp secret kept && cmp secret-wal kept && [ \"$(ls | tr '\\n' ' ')\" = 'in "
           "kept secret secret-wal ' ]",
           folder);
  assert_int_equal(system(command), 0);
}

check_main(check_file_test(test_functions), check_file_test(test_pragmas),
           check_file_test(test_statements), check_file_test(test_hostile_files),
           check_file_test(test_hostile_schema), check_file_test(test_names),
           check_file_test(test_confined))
