/* Files of results on SQLite: opening, checking, closing. See study.h; statement.c uses them.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "barwright/confine.h"
#include "study/internal.h"

enum { STEPS_BETWEEN_QUESTIONS = 20000 };

const char bwi_magic[16] = "SQLite format 3";
const int32_t bwi_mark = 0x62777374; /* "bwst" */

/* ---- waiting and cancelling ------------------------------------------------------------------ */

static int on_busy(void *data, int calls) {
  bw_database *d = (bw_database *)data;
  double now = bw_seconds();
  if (calls == 0)
    d->busy_since = now;
  if (now - d->busy_since > d->busy_seconds || bw_cancelled(d->context))
    return 0;
  struct timespec pause = {0, calls < 10 ? 2000000 : 20000000};
  nanosleep(&pause, NULL);
  return 1;
}

static int on_progress(void *data) {
  return bw_cancelled(((bw_database *)data)->context);
}

bw_status bwi_database_enter(bw_context *context, bw_database *d) {
  if (d->owner != getpid())
    return bw_fail(context, BW_INVALID,
                   "%s was opened by another process: a job opens a database of its own", d->path);
  d->context = context;
  return BW_OK;
}

/* ---- the object ------------------------------------------------------------------------------ */

static void database_destroy(void *object) {
  bw_database *d = (bw_database *)object;
  bool own = d->owner == getpid();
  d->context = NULL;
  for (int i = 0; i < BWI_STATEMENTS_KEPT; i++) {
    if (own)
      sqlite3_finalize(d->kept[i].handle);
    bw_free(d->kept[i].text);
  }
  if (own)
    sqlite3_close_v2(d->connection);
  bw_free(d);
}

static size_t database_bytes(const void *object) {
  const bw_database *d = (const bw_database *)object;
  int now = 0, max = 0;
  if (d->owner == getpid())
    sqlite3_db_status(d->connection, SQLITE_DBSTATUS_CACHE_USED, &now, &max, 0);
  return sizeof *d + (size_t)now;
}

static const bw_kind database_kind = {"database", database_destroy, database_bytes};

void bw_database_options_default(bw_database_options *options) {
  *options = (bw_database_options){.busy_seconds = 20};
}

const char *bw_database_path(const bw_database *database) {
  return database->path;
}

bool bw_database_inside_transaction(const bw_database *database) {
  return database->owner == getpid() && !sqlite3_get_autocommit(database->connection);
}

int64_t bw_database_changed(const bw_database *database) {
  return database->changed;
}

/* Statements that change no rows leave SQLite's own count as it was. */
void bwi_database_note_changes(bw_database *d) {
  int64_t total = sqlite3_total_changes64(d->connection);
  d->changed = total != d->total ? sqlite3_changes64(d->connection) : 0;
  d->total = total;
}

/* ---- checking -------------------------------------------------------------------------------- */

int32_t bwi_big_endian(const unsigned char *at) {
  return (int32_t)((uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3]);
}

static bw_status newer(bw_context *context, const char *path, int32_t version) {
  bw_status status = bwi_database_fail(context, BW_FORMAT, "newer", path,
                                       "written by a newer version of barwright (its format is %d, "
                                       "this version knows %d): open it with that version",
                                       version, BW_DATABASE_FORMAT);
  bw_detail_number(context, "format", version);
  return status;
}

static bool only_zeros(const unsigned char *head) {
  for (int i = 0; i < BWI_HEADER; i++)
    if (head[i])
      return false;
  return true;
}

static bw_status check_head(bw_context *context, const char *path, const unsigned char *head,
                            ssize_t got) {
  bool ours = bwi_big_endian(head + BWI_MARK_AT) == bwi_mark;
  if (memcmp(head, bwi_magic, sizeof bwi_magic) != 0) {
    if (ours || only_zeros(head)) /* no program's files begin with nothing */
      return bwi_database_fail(context, BW_FORMAT, "damaged", path,
                               "the file is damaged: its first bytes are not those of a database; "
                               "what is readable can be copied to a new one (salvage)");
    return bwi_database_fail(context, BW_FORMAT, "foreign", path,
                             "not a database of barwright: it begins as something else");
  }
  if (got < BWI_HEADER)
    return bwi_database_fail(context, BW_FORMAT, "damaged", path,
                             "the file is damaged: it ends after %d bytes", (int)got);
  if (ours && bwi_big_endian(head + BWI_VERSION_AT) > BW_DATABASE_FORMAT)
    return newer(context, path, bwi_big_endian(head + BWI_VERSION_AT));
  return BW_OK;
}

/* The number of the file beside a database in which changes stand that it has not taken in; 0 where
 * there is none. */
ino_t bwi_changes_ahead(const char *path) {
  char name[BWI_LONGEST_PATH + 8];
  struct stat about;
  snprintf(name, sizeof name, "%s-wal", path);
  return stat(name, &about) == 0 && about.st_size > 0 ? about.st_ino : 0;
}

/* Changes stand beside a file only while its head says so, and who ends that mode removes them
 * first: what stands beside another head is of another state of the file, which SQLite would bring
 * back. */
bool bwi_expects_changes(const unsigned char *head) {
  return head[BWI_MODE_AT] != 1 || head[BWI_MODE_AT + 1] != 1;
}

/* What SQLite would say only in general terms, or not at all, is decided by the first bytes. */
static bw_status check_file(bw_context *context, const char *path, bool read_only) {
  unsigned char head[BWI_HEADER] = {0};
  struct stat about;
  if (stat(path, &about) != 0) {
    if (errno == ENOENT && !read_only)
      return BW_OK;
    return bwi_database_fail(context, BW_IO, NULL, path, "%s", strerror(errno));
  }
  if (!S_ISREG(about.st_mode))
    return bwi_database_fail(context, BW_IO, NULL, path, "a file expected, this is %s",
                             S_ISDIR(about.st_mode) ? "a folder" : "a device or a pipe");
  if (about.st_size == 0 && !read_only)
    return BW_OK;
  if (about.st_size == 0)
    return bwi_database_fail(context, BW_FORMAT, "foreign", path, "the file is empty");
  ino_t ahead = bwi_changes_ahead(path);
  int file = bw_open(path, O_RDONLY, 0);
  ssize_t got = file >= 0 ? read(file, head, sizeof head) : -1;
  int error = errno;
  if (file >= 0)
    close(file);
  if (got < 0)
    return bwi_database_fail(context, BW_IO, NULL, path, "%s", strerror(error));
  bw_status status = check_head(context, path, head, got);
  /* The same before and after the head was read: nobody ended the mode meanwhile. */
  if (status == BW_OK && !bwi_expects_changes(head) && ahead != 0 &&
      bwi_changes_ahead(path) == ahead)
    return bwi_database_fail(
        context, BW_FORMAT, "damaged", path,
        "the file is damaged: %s-wal is beside it, which is of another state of "
        "the file; move that one away if the file itself is the right one",
        path);
  return status;
}

/* ---- opening --------------------------------------------------------------------------------- */

static int read_number(sqlite3 *connection, const char *sql, int64_t *number) {
  sqlite3_stmt *statement = NULL;
  int code = sqlite3_prepare_v2(connection, sql, -1, &statement, NULL);
  if (code == SQLITE_OK && (code = sqlite3_step(statement)) == SQLITE_ROW) {
    *number = sqlite3_column_int64(statement, 0);
    code = SQLITE_OK;
  }
  sqlite3_finalize(statement);
  return code == SQLITE_DONE ? SQLITE_OK : code;
}

/* The mark of a new file. Two processes may come here at the same time: the second one finds it
 * marked. */
static int mark_file(bw_database *d) {
  char sql[160];
  int64_t mark = 0;
  int code = sqlite3_exec(d->connection, "BEGIN IMMEDIATE", NULL, NULL, NULL);
  if (code == SQLITE_OK)
    code = read_number(d->connection, "PRAGMA application_id", &mark);
  if (code == SQLITE_OK && mark == 0) {
    snprintf(sql, sizeof sql, "PRAGMA application_id=%d; PRAGMA user_version=%d", (int)bwi_mark,
             (int)BW_DATABASE_FORMAT);
    code = sqlite3_exec(d->connection, sql, NULL, NULL, NULL);
  }
  if (code == SQLITE_OK)
    code = sqlite3_exec(d->connection, "COMMIT", NULL, NULL, NULL);
  return code;
}

/* A change of the mode does not wait for other openers by itself. */
static int write_ahead(bw_database *d) {
  double start = bw_seconds();
  for (;;) {
    int code = sqlite3_exec(d->connection, "PRAGMA journal_mode=WAL", NULL, NULL, NULL);
    if ((code & 0xff) != SQLITE_BUSY || bw_cancelled(d->context) ||
        bw_seconds() - start > d->busy_seconds)
      return code;
    struct timespec pause = {0, 5000000};
    nanosleep(&pause, NULL);
  }
}

static bw_status set_up(bw_context *context, bw_database *d, bool read_only) {
  sqlite3_busy_handler(d->connection, on_busy, d);
  sqlite3_progress_handler(d->connection, STEPS_BETWEEN_QUESTIONS, on_progress, d);
  int64_t mark = 0, version = 0, tables = 0;
  int code = sqlite3_exec(d->connection, "PRAGMA cell_size_check=ON; PRAGMA temp_store=MEMORY",
                          NULL, NULL, NULL);
  if (code == SQLITE_OK)
    code = read_number(d->connection, "PRAGMA application_id", &mark);
  if (code == SQLITE_OK)
    code = read_number(d->connection, "PRAGMA user_version", &version);
  if (code == SQLITE_OK)
    code = read_number(d->connection, "SELECT count(*) FROM sqlite_master", &tables);
  /* Another opener may have marked the file and made its tables since the mark was read. */
  if (code == SQLITE_OK && mark == 0 && tables != 0)
    code = read_number(d->connection, "PRAGMA application_id", &mark);
  if ((code & 0xff) == SQLITE_ERROR) /* nothing is wrong with what was asked */
    return bwi_database_fail(
        context, BW_FORMAT, "damaged", d->path,
        "the file is damaged (%s); what is readable can be copied to a new one "
        "(salvage)",
        sqlite3_errmsg(d->connection));
  if (code != SQLITE_OK)
    return bwi_database_failure(context, d, code);
  if (mark != bwi_mark && (mark != 0 || tables != 0 || read_only))
    return bwi_database_fail(context, BW_FORMAT, "foreign", d->path,
                             "a SQLite file of another program, which is left alone");
  if (version > BW_DATABASE_FORMAT)
    return newer(context, d->path, (int32_t)version);
  if (read_only)
    return BW_OK;
  code = write_ahead(d);
  if (code == SQLITE_OK)
    code = sqlite3_exec(d->connection, "PRAGMA synchronous=NORMAL", NULL, NULL, NULL);
  if (code == SQLITE_OK && mark == 0)
    code = mark_file(d);
  return code == SQLITE_OK ? BW_OK : bwi_database_failure(context, d, code);
}

static bw_status connect_to(bw_context *context, bw_database *d, int flags) {
  sqlite3_close_v2(d->connection);
  d->connection = NULL;
  int code = bwi_connect(d->path, flags, &d->connection);
  return code == SQLITE_OK ? set_up(context, d, (flags & SQLITE_OPEN_READONLY) != 0)
                           : bwi_database_failure(context, d, code);
}

bw_status bw_database_open(bw_context *context, const char *path,
                           const bw_database_options *options, bw_database **database) {
  bw_database_options defaults;
  bw_database_options_default(&defaults);
  options = options ? options : &defaults;
  if (!path[0] || strlen(path) + 8 >= BWI_LONGEST_PATH)
    return bw_fail(context, BW_INVALID, "a path of %zu bytes: 1 to %d expected", strlen(path),
                   BWI_LONGEST_PATH - 8);
  if (!(options->busy_seconds >= 0))
    return bw_fail(context, BW_INVALID, "busy_seconds %g: 0 or more expected",
                   options->busy_seconds);
  bw_status status = bw_may_use(context, path, options->read_only ? BW_TO_READ : BW_TO_WRITE);
  if (status == BW_OK)
    status = check_file(context, path, options->read_only);
  if (status != BW_OK)
    return status;
  bw_database *d = BW_NEW0(context, bw_database, 1);
  if (!d)
    return BW_MEMORY;
  bw_object_init(d, &database_kind);
  d->owner = getpid();
  d->busy_seconds = options->busy_seconds;
  d->context = context;
  snprintf(d->path, sizeof d->path, "%s", path);
  status = connect_to(context, d,
                      options->read_only ? SQLITE_OPEN_READONLY
                                         : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  /* In a folder that may not be written, SQLite cannot make the files of write-ahead mode; where
   * there is nothing ahead, the file alone is all. */
  if (status == BW_IO && options->read_only && !bwi_changes_ahead(path))
    status = connect_to(context, d, SQLITE_OPEN_READONLY | BWI_IMMUTABLE);
  if (status != BW_OK) {
    bw_release(d);
    return status;
  }
  *database = d;
  return BW_OK;
}
