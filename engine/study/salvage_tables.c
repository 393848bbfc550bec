/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The list of tables of a damaged file, taken from a rebuilt file.
 *
 * SQLite keeps the list of tables, and the page at which each begins, from the first page on. Where
 * that is gone the tables are there all the same: files whose tables are made by the same
 * statements in the same order have the same list, since pages are handed out in order and none of
 * ours moves later. So the first page of an empty file with the same tables stands in. Should a
 * file have been put together otherwise, its tables would begin elsewhere: SQLite then finds pages
 * of another kind there and says so. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "barwright/confine.h"
#include "study/internal.h"
#include "study/salvage.h"

enum { LARGEST_PAGE = 65536, COUNTER_AT = 24, PAGES_AT = 28, VALID_FOR_AT = 92 };

static int connect_to_empty(const char *path, const char *schema, sqlite3 **empty) {
  char marks[96];
  sqlite3_snprintf(sizeof marks, marks, "PRAGMA application_id=%d; PRAGMA user_version=%d",
                   (int)bwi_mark, (int)BW_DATABASE_FORMAT);
  int code = bwi_connect(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, empty);
  if (code == SQLITE_OK)
    code = sqlite3_exec(*empty, "PRAGMA journal_mode=MEMORY; BEGIN", NULL, NULL, NULL);
  if (code == SQLITE_OK)
    code = sqlite3_exec(*empty, schema, NULL, NULL, NULL);
  if (code == SQLITE_OK)
    code = sqlite3_exec(*empty, marks, NULL, NULL, NULL);
  return code == SQLITE_OK ? sqlite3_exec(*empty, "COMMIT", NULL, NULL, NULL) : code;
}

/* Whether the file lists a table under this name, and can say what its columns are. */
static bool lists(sqlite3 *from, const char *table) {
  sqlite3_stmt *row = NULL;
  char *sql = sqlite3_mprintf("SELECT rowid, * FROM \"%w\"", table);
  bool listed = sql && sqlite3_prepare_v2(from, sql, -1, &row, NULL) == SQLITE_OK;
  sqlite3_finalize(row);
  sqlite3_free(sql);
  return listed;
}

/* Whether the list can be read to its end; how many entries it has. */
static bool readable(sqlite3 *from, int *entries) {
  sqlite3_stmt *row = NULL;
  int code = sqlite3_prepare_v2(from, "SELECT type, name, sql FROM sqlite_master", -1, &row, NULL);
  if (code == SQLITE_OK)
    while ((code = sqlite3_step(row)) == SQLITE_ROW)
      ++*entries;
  sqlite3_finalize(row);
  return code == SQLITE_DONE;
}

static bool is_marked(sqlite3 *from) {
  sqlite3_stmt *row = NULL;
  bool marked = sqlite3_prepare_v2(from, "PRAGMA application_id", -1, &row, NULL) == SQLITE_OK &&
                sqlite3_step(row) == SQLITE_ROW && sqlite3_column_int(row, 0) == bwi_mark;
  sqlite3_finalize(row);
  return marked;
}

/* The list is damaged where it cannot be read, is empty, or lacks tables. A file that has none of
 * them, nor our mark, is another's. */
static int check(sqlite3 *from, sqlite3 *empty, bool *damaged) {
  int there = 0, missing = 0, entries = 0;
  sqlite3_stmt *row = NULL;
  int code = sqlite3_prepare_v2(empty, "SELECT name FROM sqlite_master WHERE type = 'table'", -1,
                                &row, NULL);
  if (code == SQLITE_OK)
    while ((code = sqlite3_step(row)) == SQLITE_ROW) {
      bool listed = lists(from, (const char *)sqlite3_column_text(row, 0));
      there += listed;
      missing += !listed;
    }
  sqlite3_finalize(row);
  *damaged =
      !readable(from, &entries) || entries == 0 || (missing > 0 && (there > 0 || is_marked(from)));
  return code == SQLITE_DONE ? SQLITE_OK : code;
}

static bw_status take_first_page(bw_context *context, const char *from, const char *to) {
  unsigned char head[BWI_HEADER];
  unsigned char *page = BW_NEW(context, unsigned char, LARGEST_PAGE);
  int in = bw_open(from, O_RDONLY, 0), out = bw_open(to, O_WRONLY, 0);
  const char *failed = in < 0 ? from : out < 0 ? to : NULL;
  bw_status status = page ? BW_OK : BW_MEMORY;
  if (page && !failed) {
    if (pread(in, head, sizeof head, 0) != (ssize_t)sizeof head)
      failed = from;
    else {
      int size = head[16] << 8 | head[17];
      size = size == 1 ? LARGEST_PAGE : size;
      if (pread(in, page, (size_t)size, 0) != size)
        failed = from;
      page[18] = page[19] = 2;       /* write-ahead, as it was */
      memset(page + PAGES_AT, 0, 4); /* SQLite finds the number of pages by itself */
      page[VALID_FOR_AT + 3] = page[COUNTER_AT + 3] ^ 1; /* where the counters differ */
      if (!failed && pwrite(out, page, (size_t)size, 0) != size)
        failed = to;
    }
  }
  if (status == BW_OK && failed)
    status = bwi_database_fail(context, BW_IO, errno == ENOSPC ? "full" : NULL, failed, "%s",
                               strerror(errno));
  if (in >= 0)
    close(in);
  if (out >= 0)
    close(out);
  bw_free(page);
  return status;
}

bw_status bwi_salvage_tables(bw_context *context, sqlite3 *from, const char *schema,
                             const char *copy, const char *scratch, bool always, bool *rebuilt) {
  sqlite3 *empty = NULL;
  bw_status status = BW_OK;
  int code = connect_to_empty(scratch, schema, &empty);
  if (code == SQLITE_OK) {
    code = check(from, empty, rebuilt);
    *rebuilt = *rebuilt || always;
  }
  if (code != SQLITE_OK)
    status = (code & 0xff) == SQLITE_NOMEM
                 ? bw_fail(context, BW_MEMORY, "%s: out of memory", scratch)
                 : bwi_database_fail(context, BW_IO, (code & 0xff) == SQLITE_FULL ? "full" : NULL,
                                     scratch, "%s", sqlite3_errmsg(empty));
  sqlite3_close_v2(empty);
  if (status == BW_OK && *rebuilt)
    status = take_first_page(context, scratch, copy);
  return status;
}
