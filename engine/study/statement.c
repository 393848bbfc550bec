/* SQL on files of results. See study.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Invariant: a kept statement is idle (reset, its parameters NULL) or in use; a new one takes the
 * place of the idle one that was used longest ago. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "study/internal.h"

bw_status bw_database_execute(bw_context *context, bw_database *d, const char *sql) {
  bw_status status = bwi_database_enter(context, d);
  if (status != BW_OK)
    return status;
  int code = sqlite3_exec(d->connection, sql, NULL, NULL, NULL);
  if (code != SQLITE_OK)
    return bwi_database_failure(context, d, code);
  bwi_database_note_changes(d);
  return BW_OK;
}

/* ---- kept statements ------------------------------------------------------------------------- */

void bw_statement_put_back(bw_statement *s) {
  if (!s || s->database->owner != getpid())
    return;
  sqlite3_reset(s->handle);
  sqlite3_clear_bindings(s->handle);
  s->in_use = false;
}

/* The idle one with this text, else (*found is false) the place for a new one, or NULL. */
static bw_statement *look_up(bw_database *d, const char *sql, bool *found) {
  bw_statement *place = NULL;
  *found = false;
  for (int i = 0; i < BWI_STATEMENTS_KEPT; i++) {
    bw_statement *s = &d->kept[i];
    if (s->in_use)
      continue;
    if (s->text && strcmp(s->text, sql) == 0) {
      *found = true;
      return s;
    }
    if (!place || s->last_use < place->last_use)
      place = s;
  }
  return place;
}

static bw_status compile(bw_context *context, bw_database *d, const char *text,
                         sqlite3_stmt **handle) {
  const char *rest = NULL;
  int code = sqlite3_prepare_v3(d->connection, text, -1,
                                SQLITE_PREPARE_PERSISTENT | SQLITE_PREPARE_NO_VTAB, handle, &rest);
  if (code != SQLITE_OK)
    return bwi_database_failure(context, d, code);
  if (!*handle)
    return bw_fail(context, BW_INVALID, "a statement of SQL expected, got \"%.200s\"", text);
  if (sqlite3_stmt_isexplain(*handle))
    return bw_fail(context, BW_INVALID, "EXPLAIN does not work on files of results");
  rest += strspn(rest, " \t\r\n;");
  if (*rest)
    return bw_fail(context, BW_INVALID, "one statement expected, but more follows: \"%.200s\"",
                   rest);
  return BW_OK;
}

bw_status bw_database_prepare(bw_context *context, bw_database *d, const char *sql,
                              bw_statement **statement) {
  bool found;
  sqlite3_stmt *handle = NULL;
  char *text = NULL;
  bw_status status;
  BW_TRY(bwi_database_enter(context, d));
  bw_statement *place = look_up(d, sql, &found);
  if (!place)
    BW_TRY(bw_fail(context, BW_LIMIT,
                   "%s: %d statements are in use at the same time: finish some of them first",
                   d->path, BWI_STATEMENTS_KEPT));
  if (!found) {
    size_t size = strlen(sql) + 1;
    text = BW_NEW(context, char, size);
    BW_TRY_MEMORY(text);
    memcpy(text, sql, size);
    BW_TRY(compile(context, d, text, &handle));
    sqlite3_finalize(place->handle);
    bw_free(place->text);
    *place = (bw_statement){.database = d, .handle = handle, .text = text};
    handle = NULL;
    text = NULL;
  }
  place->in_use = true;
  place->last_use = ++d->clock;
  *statement = place;
done:
  sqlite3_finalize(handle);
  bw_free(text);
  return status;
}

/* ---- parameters ------------------------------------------------------------------------------ */

int bw_statement_parameters(const bw_statement *s) {
  return sqlite3_bind_parameter_count(s->handle);
}

static bw_status bound(bw_context *context, bw_statement *s, int i, int code) {
  if ((code & 0xff) == SQLITE_RANGE)
    return bw_fail(context, BW_INVALID, "parameter %d of a statement that has %d: %.200s", i + 1,
                   bw_statement_parameters(s), s->text);
  return code == SQLITE_OK ? BW_OK : bwi_database_failure(context, s->database, code);
}

bw_status bw_statement_bind_integer(bw_context *context, bw_statement *s, int i, int64_t value) {
  return bound(context, s, i, sqlite3_bind_int64(s->handle, i + 1, value));
}

bw_status bw_statement_bind_real(bw_context *context, bw_statement *s, int i, double value) {
  return bound(context, s, i, sqlite3_bind_double(s->handle, i + 1, value));
}

bw_status bw_statement_bind_text(bw_context *context, bw_statement *s, int i, const char *text,
                                 size_t length) {
  bool plain = length == 0 || !memchr(text, 0, length);
  int code =
      plain ? sqlite3_bind_text64(s->handle, i + 1, text, length, SQLITE_TRANSIENT, SQLITE_UTF8)
            : sqlite3_bind_blob64(s->handle, i + 1, text, length, SQLITE_TRANSIENT);
  return bound(context, s, i, code);
}

/* ---- rows ------------------------------------------------------------------------------------ */

bw_status bw_statement_step(bw_context *context, bw_statement *s, bool *row) {
  *row = false;
  bw_status status = bwi_database_enter(context, s->database);
  if (status != BW_OK)
    return status;
  int code = sqlite3_step(s->handle);
  *row = code == SQLITE_ROW;
  if (*row)
    return BW_OK;
  if (code == SQLITE_DONE)
    bwi_database_note_changes(s->database);
  else
    status = bwi_database_failure(context, s->database, code);
  bw_statement_put_back(s);
  return status;
}

int bw_statement_columns(const bw_statement *s) {
  return sqlite3_column_count(s->handle);
}

const char *bw_statement_column_name(const bw_statement *s, int column) {
  const char *name = sqlite3_column_name(s->handle, column);
  return name ? name : "";
}

bw_status bw_statement_value(bw_context *context, bw_statement *s, int column,
                             bw_sql_value *value) {
  *value = (bw_sql_value){.type = BW_SQL_NONE};
  switch (sqlite3_column_type(s->handle, column)) {
  case SQLITE_INTEGER:
    value->type = BW_SQL_INTEGER;
    value->integer = sqlite3_column_int64(s->handle, column);
    value->real = (double)value->integer;
    break;
  case SQLITE_FLOAT:
    value->type = BW_SQL_REAL;
    value->real = sqlite3_column_double(s->handle, column);
    break;
  case SQLITE_TEXT:
  case SQLITE_BLOB:
    value->type = BW_SQL_TEXT;
    value->text = (const char *)sqlite3_column_blob(s->handle, column);
    value->length = (size_t)sqlite3_column_bytes(s->handle, column);
    if (!value->text && value->length > 0)
      return bw_fail(context, BW_MEMORY, "%s: out of memory", s->database->path);
    if (!value->text)
      value->text = "";
    break;
  default:
    break;
  }
  return BW_OK;
}

/* ---- SQLite's own check ---------------------------------------------------------------------- */

typedef struct text {
  char *bytes;
  size_t length, capacity;
} text;

static bw_status add_line(bw_context *context, text *list, const char *line, size_t length) {
  if (!bw_grow(context, (void **)&list->bytes, &list->capacity, list->length, length + 2, 1))
    return BW_MEMORY;
  memcpy(list->bytes + list->length, line, length);
  list->length += length;
  list->bytes[list->length++] = '\n';
  list->bytes[list->length] = 0;
  return BW_OK;
}

bw_status bw_database_check(bw_context *context, bw_database *d, int max, char **problems) {
  char sql[64];
  text list = {NULL, 0, 0};
  bw_statement *s = NULL;
  bw_sql_value value;
  bool row = true;
  snprintf(sql, sizeof sql, "PRAGMA quick_check(%d)", max);
  bw_status status = bw_database_prepare(context, d, sql, &s);
  while (status == BW_OK) {
    status = bw_statement_step(context, s, &row);
    if (status != BW_OK || !row)
      break;
    status = bw_statement_value(context, s, 0, &value);
    bool ok = value.length == 2 && memcmp(value.text, "ok", 2) == 0;
    if (status == BW_OK && value.type == BW_SQL_TEXT && !ok)
      status = add_line(context, &list, value.text, value.length);
  }
  if (row)
    bw_statement_put_back(s);
  /* Damage that stops the check is what it was looking for. */
  if (status == BW_FORMAT)
    status = add_line(context, &list, bw_message(context), strlen(bw_message(context)));
  if (status == BW_OK)
    *problems = list.bytes;
  else
    bw_free(list.bytes);
  return status;
}
