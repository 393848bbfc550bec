/* What is still readable of a damaged file, into a new one. See study.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A copy of the file is read, never the file itself: SQLite writes into what it opens. Copy and new
 * file lie beside each other as temporary files, and the new one is renamed when it is whole. A
 * head that is damaged is rewritten in the copy. Each table is read in the order of its row
 * numbers; where a page cannot be read, the reading begins again at the next number, and the next,
 * until it goes on: what lies behind the page is then found through others. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "barwright/confine.h"
#include "barwright/temporary.h"
#include "base/words.h"
#include "study/internal.h"
#include "study/salvage.h"

/* In one gap: so many row numbers one by one, then in strides that double after some more. */
enum { TRIES = 1 << 12, TRIES_OF_A_STRIDE = 32, NAME = BWI_LONGEST_PATH + 64, SIDE = NAME + 16 };
enum { MAX_ROWS = 1000000000 }; /* of a table: what is more is no count */

typedef struct salvage {
  bw_context *context;
  const char *damaged;
  char copy[NAME];
  sqlite3 *from;
  bw_database *to;
  bw_salvage_report report;
} salvage;

/* ---- the copy -------------------------------------------------------------------------------- */

static bw_status io_failure(bw_context *context, const char *path) {
  char words[BWI_WORDS];
  return bwi_database_fail(context, BW_IO, errno == ENOSPC || errno == EFBIG ? "full" : NULL, path,
                           "%s", bwi_system_words(errno, words));
}

/* Opened without waiting for the other end of a pipe. A device or a pipe has no end. */
static bw_status open_regular(bw_context *context, const char *path, int *file, int64_t *bytes) {
  struct stat about;
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status != BW_OK)
    return status;
  *file = bw_open(path, O_RDONLY | O_NONBLOCK, 0);
  if (*file < 0 || fstat(*file, &about) != 0)
    return io_failure(context, path);
  *bytes = about.st_size;
  if (S_ISREG(about.st_mode))
    return BW_OK;
  return bwi_database_fail(context, BW_IO, NULL, path, "a file expected, this is a %s",
                           S_ISDIR(about.st_mode) ? "folder" : "device or a pipe");
}

/* False with errno. */
static bool write_all(int file, const unsigned char *bytes, size_t count) {
  while (count > 0) {
    ssize_t put = write(file, bytes, count);
    if (put == 0 || (put < 0 && errno != EINTR))
      return false;
    bytes += put > 0 ? put : 0;
    count -= put > 0 ? (size_t)put : 0;
  }
  return true;
}

/* As many bytes as the file has now: it may be growing. A file that does not exist is no failure
 * when it is `optional`. The new one is made: what stands under its name may be a link. */
static bw_status copy_file(bw_context *context, const char *from, const char *to, bool optional) {
  unsigned char block[1 << 15];
  struct stat about;
  int64_t rest = 0;
  int in = -1, out = -1;
  if (optional && lstat(from, &about) != 0 && errno == ENOENT)
    return BW_OK;
  bw_status status = open_regular(context, from, &in, &rest);
  if (status == BW_OK) {
    out = bw_open(to, O_WRONLY | O_CREAT | O_EXCL, 0666);
    status = out < 0 ? io_failure(context, to) : BW_OK;
  }
  while (status == BW_OK && rest > 0) {
    size_t wanted = rest < (int64_t)sizeof block ? (size_t)rest : sizeof block;
    ssize_t got = read(in, block, wanted);
    if (got == 0)
      break;
    rest -= got;
    if (got < 0)
      status = io_failure(context, from);
    else if (!write_all(out, block, (size_t)got))
      status = io_failure(context, to);
    else
      status = bw_check_cancel(context);
  }
  if (in >= 0)
    close(in);
  if (out >= 0 && close(out) != 0 && status == BW_OK)
    status = io_failure(context, to);
  return status;
}

static bool head_is_sound(const unsigned char *head, int64_t file_bytes) {
  static const unsigned char fractions[4] = {0, 64, 32, 32};
  int page = head[16] << 8 | head[17];
  page = page == 1 ? 65536 : page;
  int32_t schema = bwi_big_endian(head + 44), encoding = bwi_big_endian(head + 56);
  return memcmp(head, bwi_magic, sizeof bwi_magic) == 0 && page >= 512 && !(page & (page - 1)) &&
         page <= file_bytes && memcmp(head + 20, fractions, 4) == 0 && head[18] <= 2 &&
         head[19] <= 2 && schema >= 0 && schema <= 4 && encoding >= 0 && encoding <= 3;
}

/* The head that our files have; sizes of the file and of lists are left for SQLite to find. */
static void write_head(unsigned char *head) {
  memset(head, 0, BWI_HEADER);
  memcpy(head, bwi_magic, sizeof bwi_magic);
  head[16] = 4096 >> 8;
  head[18] = head[19] = 2; /* write-ahead */
  head[21] = 64;
  head[22] = head[23] = 32;
  head[43] = 1; /* a number of the schema */
  head[47] = 4; /* its format */
  head[59] = 1; /* UTF-8 */
  head[BWI_VERSION_AT + 3] = BW_DATABASE_FORMAT;
  for (int i = 0; i < 4; i++)
    head[BWI_MARK_AT + i] = (unsigned char)((uint32_t)bwi_mark >> (24 - 8 * i));
}

static bw_status repair_head(salvage *s) {
  unsigned char head[BWI_HEADER];
  struct stat about;
  bw_status status = BW_OK;
  int file = bw_open(s->copy, O_RDWR, 0);
  if (file < 0 || fstat(file, &about) != 0 || pread(file, head, sizeof head, 0) < 0)
    status = io_failure(s->context, s->copy);
  else if (about.st_size < 512)
    status = bwi_database_fail(s->context, BW_FORMAT, "damaged", s->damaged,
                               "only %lld bytes are left of the file: nothing can be saved",
                               (long long)about.st_size);
  else if (!head_is_sound(head, about.st_size)) {
    write_head(head);
    bw_warn(s->context, "the header of the file is damaged; the usual header is assumed");
    s->report.whole = false;
    if (pwrite(file, head, sizeof head, 0) != (ssize_t)sizeof head)
      status = io_failure(s->context, s->copy);
  }
  if (file >= 0)
    close(file);
  return status;
}

static void side_name(const char *path, const char *ending, char name[SIDE]) {
  snprintf(name, SIDE, "%s%s", path, ending);
}

static bool has_changes_of_its_own(salvage *s) {
  unsigned char head[BWI_HEADER] = {0};
  int file = bw_open(s->copy, O_RDONLY, 0);
  bool sound = file >= 0 && pread(file, head, sizeof head, 0) == (ssize_t)sizeof head &&
               memcmp(head, bwi_magic, sizeof bwi_magic) == 0;
  if (file >= 0)
    close(file);
  if (!bwi_changes_ahead(s->damaged))
    return false;
  if (!sound || bwi_expects_changes(head))
    return true;
  bw_warn(s->context, "%s-wal belongs to another state of the file and was ignored", s->damaged);
  s->report.whole = false;
  return false;
}

static bw_status make_copy(salvage *s) {
  char from[SIDE], to[SIDE];
  bw_status status = copy_file(s->context, s->damaged, s->copy, false);
  if (status != BW_OK)
    return status;
  side_name(s->damaged, "-wal", from);
  side_name(s->copy, "-wal", to);
  if (has_changes_of_its_own(s))
    status = copy_file(s->context, from, to, true);
  return status == BW_OK ? repair_head(s) : status;
}

/* ---- rows ------------------------------------------------------------------------------------ */

static bw_status no_memory(salvage *s) {
  return bw_fail(s->context, BW_MEMORY, "%s: out of memory", s->damaged);
}

static bool is_damage(int code) {
  code &= 0xff;
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_IOERR;
}

static bw_status read_failure(salvage *s, int code) {
  if ((code & 0xff) == SQLITE_NOMEM)
    return no_memory(s);
  return bwi_database_fail(s->context, BW_FORMAT, "damaged", s->damaged, "%s",
                           sqlite3_errmsg(s->from));
}

static bw_status insert(salvage *s, const char *sql, sqlite3_stmt *row, int64_t *saved) {
  bw_statement *out = NULL;
  bool more = true;
  bw_status status = bw_database_prepare(s->context, s->to, sql, &out);
  for (int i = 1; i < sqlite3_column_count(row) && status == BW_OK; i++)
    if (sqlite3_bind_value(out->handle, i, sqlite3_column_value(row, i)) != SQLITE_OK)
      status = no_memory(s);
  if (status == BW_OK)
    status = bw_statement_step(s->context, out, &more);
  if (status == BW_OK)
    *saved += bw_database_changed(s->to);
  if (status != BW_OK || more)
    bw_statement_put_back(out);
  return status;
}

typedef struct gap {
  int64_t lost; /* row numbers between what was read */
  int count;    /* of gaps */
  bool open_end;
} gap;

/* The last row number, or INT64_MAX when it cannot be read. */
static int64_t last_number(salvage *s, const char *table) {
  int64_t last = INT64_MAX;
  sqlite3_stmt *row = NULL;
  char *sql = sqlite3_mprintf("SELECT rowid FROM \"%w\" ORDER BY rowid DESC LIMIT 1", table);
  if (sql && sqlite3_prepare_v2(s->from, sql, -1, &row, NULL) == SQLITE_OK) {
    int code = sqlite3_step(row);
    if (code == SQLITE_ROW)
      last = sqlite3_column_int64(row, 0);
    else if (code == SQLITE_DONE)
      last = INT64_MIN;
  }
  sqlite3_finalize(row);
  sqlite3_free(sql);
  return last;
}

/* A damaged page may hold any row number: what no file has room for is no count. */
static void add_lost(gap *gaps, int64_t rows) {
  if (rows > MAX_ROWS)
    gaps->open_end = true;
  else
    gaps->lost += rows;
}

/* Reads rows in order from `start` on, past what cannot be read. */
static bw_status copy_rows(salvage *s, sqlite3_stmt *row, const char *insertion, int64_t last,
                           int64_t *saved, gap *gaps) {
  int64_t start = INT64_MIN, before = 0, stride = 1;
  int tries = 0;
  bool any = false;
  for (;;) {
    int code;
    sqlite3_bind_int64(row, 1, start);
    while ((code = sqlite3_step(row)) == SQLITE_ROW) {
      int64_t number = sqlite3_column_int64(row, 0);
      if (number < start || (any && number <= before)) { /* pages that lead in a circle */
        code = SQLITE_CORRUPT;
        break;
      }
      if (tries > 0)
        add_lost(gaps, number - before - 1);
      bw_status status = insert(s, insertion, row, saved);
      if (status == BW_OK)
        status = bw_check_cancel(s->context);
      if (status != BW_OK)
        return status;
      before = number;
      any = true;
      tries = 0;
      stride = 1;
    }
    sqlite3_reset(row);
    if (code == SQLITE_DONE && tries == 0)
      return BW_OK;
    if (code != SQLITE_DONE && !is_damage(code))
      return read_failure(s, code);
    if (tries == 0) {
      gaps->count++;
      start = any ? before + 1 : 1;
    } else {
      if (tries > TRIES && tries % TRIES_OF_A_STRIDE == 0)
        stride = stride > INT64_MAX / 2 ? stride : 2 * stride;
      start = start > INT64_MAX - stride ? INT64_MAX : start + stride;
    }
    tries++;
    bw_status status = tries % 1024 == 0 ? bw_check_cancel(s->context) : BW_OK;
    if (status != BW_OK)
      return status;
    if (code == SQLITE_DONE || start > last || start == INT64_MAX) {
      if (last != INT64_MAX && last > before)
        add_lost(gaps, last - before);
      gaps->open_end = gaps->open_end || last == INT64_MAX;
      return BW_OK;
    }
  }
}

/* ", "a", "b"" of the table's columns, and as many question marks; to be released with
 * sqlite3_free. NULL where the table could not be made again. */
static bw_status columns_of(salvage *s, const char *table, char **names, char **marks) {
  sqlite3_stmt *row = NULL;
  sqlite3_str *list = sqlite3_str_new(NULL), *questions = sqlite3_str_new(NULL);
  enum { COLUMN_NAME = 1, HIDDEN = 6 };
  char *sql = sqlite3_mprintf("PRAGMA table_xinfo(\"%w\")", table);
  int code = sql ? sqlite3_prepare_v2(s->to->connection, sql, -1, &row, NULL) : SQLITE_NOMEM;
  sqlite3_free(sql);
  while (code == SQLITE_OK && (code = sqlite3_step(row)) == SQLITE_ROW) {
    code = SQLITE_OK;
    if (sqlite3_column_int(row, HIDDEN) != 0)
      continue;
    bool first = sqlite3_str_length(list) == 0;
    sqlite3_str_appendf(list, "%s\"%w\"", first ? "" : ", ",
                        (const char *)sqlite3_column_text(row, COLUMN_NAME));
    sqlite3_str_appendf(questions, "%s?", first ? "" : ", ");
  }
  sqlite3_finalize(row);
  bool any = sqlite3_str_length(list) > 0;
  *names = sqlite3_str_finish(list);
  *marks = sqlite3_str_finish(questions);
  return (code & 0xff) != SQLITE_NOMEM && any == (*names && *marks) ? BW_OK : no_memory(s);
}

static void add_note(salvage *s, const char *table, int64_t saved, const gap *gaps) {
  s->report.tables++;
  s->report.rows += saved;
  s->report.lost += gaps->lost;
  s->report.whole = s->report.whole && gaps->count == 0;
  if (gaps->count == 0)
    bw_warn(s->context, "table %s: all %lld rows were saved", table, (long long)saved);
  else if (gaps->lost == 0)
    bw_warn(s->context,
            "table %s: %lld rows were saved; others could not be read, and how many is not known",
            table, (long long)saved);
  else
    bw_warn(s->context,
            "table %s: %lld rows were saved; in %d place%s up to %lld rows could not be read%s",
            table, (long long)saved, gaps->count, gaps->count == 1 ? "" : "s",
            (long long)gaps->lost,
            gaps->open_end ? ", and how many there were behind the last is not known" : "");
}

static bw_status copy_table(salvage *s, const char *table) {
  char *names = NULL, *marks = NULL, *selection = NULL, *insertion = NULL;
  sqlite3_stmt *row = NULL;
  int64_t saved = 0;
  gap gaps = {0, 0, false};
  bw_status status;
  BW_TRY(columns_of(s, table, &names, &marks));
  if (!names)
    goto done;
  selection = sqlite3_mprintf(
      "SELECT rowid, %s FROM \"%w\" NOT INDEXED WHERE rowid >= ? ORDER BY rowid", names, table);
  insertion = sqlite3_mprintf("INSERT OR IGNORE INTO \"%w\" (%s) VALUES (%s)", table, names, marks);
  if (!selection || !insertion) {
    status = no_memory(s);
    goto done;
  }
  int code = sqlite3_prepare_v2(s->from, selection, -1, &row, NULL);
  if (code == SQLITE_OK)
    BW_TRY(copy_rows(s, row, insertion, last_number(s, table), &saved, &gaps));
  else if ((code & 0xff) == SQLITE_NOMEM) {
    status = no_memory(s);
    goto done;
  } else {
    gaps.count = 1;
    gaps.open_end = true;
  }
  add_note(s, table, saved, &gaps);
done:
  sqlite3_finalize(row);
  sqlite3_free(names);
  sqlite3_free(marks);
  sqlite3_free(selection);
  sqlite3_free(insertion);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

typedef enum part { TABLES, ROWS, THE_REST } part;

/* Rebuilds what the schema lists. All tables come first, so that they begin where those of a new
 * file do (salvage_tables.c); then their rows; then indices and views. */
static bw_status copy_schema(salvage *s, part what) {
  bool tables = what != THE_REST;
  int count = 0;
  sqlite3_stmt *row = NULL;
  bw_status status = BW_OK;
  int code = sqlite3_prepare_v2(s->from,
                                tables ? "SELECT name, sql FROM sqlite_master WHERE type = 'table' "
                                         "AND sql IS NOT NULL"
                                       : "SELECT name, sql FROM sqlite_master WHERE type <> "
                                         "'table' AND sql IS NOT NULL",
                                -1, &row, NULL);
  while (code == SQLITE_OK && (code = sqlite3_step(row)) == SQLITE_ROW) {
    const char *name = (const char *)sqlite3_column_text(row, 0);
    const char *sql = (const char *)sqlite3_column_text(row, 1);
    if (!name || !sql) {
      status = no_memory(s);
      break;
    }
    if (sqlite3_strnicmp(name, "sqlite_", 7) == 0) { /* SQLite makes its own tables by itself */
      code = SQLITE_OK;
      continue;
    }
    count++;
    status = what == ROWS ? copy_table(s, name) : bw_database_execute(s->context, s->to, sql);
    if (what != ROWS && (status == BW_INVALID || status == BW_INFEASIBLE)) {
      bw_warn(s->context, "%s could not be rebuilt: %s", name, bw_message(s->context));
      s->report.whole = false;
      status = BW_OK;
    }
    if (status != BW_OK)
      break;
    code = SQLITE_OK;
  }
  if (status == BW_OK && code != SQLITE_DONE && code != SQLITE_OK) {
    if (!is_damage(code) || (tables && count == 0))
      status = bwi_database_fail(s->context, BW_FORMAT, "damaged", s->damaged,
                                 "the list of its tables is damaged (%s): nothing can be saved",
                                 sqlite3_errmsg(s->from));
    else
      s->report.whole = false;
  }
  sqlite3_finalize(row);
  return status;
}

static bw_status open_copy(salvage *s) {
  sqlite3_close_v2(s->from);
  s->from = NULL;
  int code = bwi_connect(s->copy, SQLITE_OPEN_READWRITE, &s->from);
  /* A schema with errors in it is read all the same, and a file whose end is missing; the
   * statements that read it are those of this file. */
  if (code == SQLITE_OK)
    code = sqlite3_db_config(s->from, SQLITE_DBCONFIG_DEFENSIVE, 0, NULL);
  if (code == SQLITE_OK)
    code = sqlite3_db_config(s->from, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, NULL);
  if (code == SQLITE_OK)
    code = sqlite3_exec(s->from, "PRAGMA cell_size_check=ON", NULL, NULL, NULL);
  return code == SQLITE_OK ? BW_OK : read_failure(s, code);
}

/* Opens the copy; where its list of tables is gone, with the list that the schema gives. */
static bw_status open_with_tables(salvage *s, const char *schema, bool relist) {
  bw_status status = open_copy(s);
  if (!schema || (status != BW_OK && status != BW_FORMAT))
    return status;
  char scratch[SIDE];
  side_name(s->copy, ".tables", scratch);
  status = bwi_salvage_tables(s->context, s->from, schema, s->copy, scratch, relist,
                              &s->report.relisted);
  if (status != BW_OK || !s->report.relisted)
    return status;
  s->report.whole = false;
  bw_warn(s->context, "the list of tables is damaged; that of a new file is assumed");
  return open_copy(s);
}

bw_status bw_database_salvage(bw_context *context, const char *damaged, const char *to,
                              const char *schema, bool relist, bw_salvage_report *report) {
  struct stat about;
  if (strlen(damaged) + 64 >= NAME || strlen(to) + 64 >= NAME)
    return bw_fail(context, BW_INVALID, "a path is too long");
  bw_status allowed = bw_may_use(context, damaged, BW_TO_READ);
  if (allowed == BW_OK)
    allowed = bw_may_use(context, to, BW_TO_WRITE);
  if (allowed != BW_OK)
    return allowed;
  if (lstat(to, &about) == 0)
    return bwi_database_fail(context, BW_IO, NULL, to,
                             "there is a file already: name one that is to be made");
  salvage s = {.context = context, .damaged = damaged, .report = {.whole = true}};
  bw_temporary *temporary = NULL;
  char made[SIDE];
  bw_status status = bw_temporary_create(context, to, true, &temporary);
  if (status != BW_OK)
    return status;
  side_name(bw_temporary_path(temporary), ".new", made);
  snprintf(s.copy, sizeof s.copy, "%s.copy", bw_temporary_path(temporary));
  BW_TRY(make_copy(&s));
  BW_TRY(open_with_tables(&s, schema, relist));
  BW_TRY(bw_database_open(context, made, NULL, &s.to));
  BW_TRY(bw_database_execute(context, s.to, "BEGIN"));
  BW_TRY(copy_schema(&s, TABLES));
  BW_TRY(copy_schema(&s, ROWS));
  BW_TRY(copy_schema(&s, THE_REST));
  BW_TRY(bw_database_execute(context, s.to, "COMMIT"));
  if (s.report.relisted && s.report.rows == 0)
    BW_TRY(bwi_database_fail(context, BW_FORMAT, "damaged", damaged,
                             "the list of its tables is damaged, and no row is where one would be: "
                             "nothing can be saved"));
  *report = s.report;
done:
  sqlite3_close_v2(s.from);
  bw_release(s.to); /* which leaves one file */
  if (status == BW_OK && bw_rename(made, to) != 0)
    status = io_failure(context, to);
  bw_release(temporary);
  return status;
}
