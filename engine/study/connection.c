/* Connections to SQLite: how each one is opened, and what a statement may do on it.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Files of results come from others, and statements may come from scripts that nobody has read.
 * Therefore a connection knows only what studies need, and everything else is denied:
 *  - the lists below name every kind of statement, every pragma and every function that works;
 *  - functions outside of the list are hidden, since SQLite does not ask the authoriser for those
 *    in a file's own tables (checks, generated columns, indices on expressions);
 *  - no virtual table, no trigger and no view of a file runs, and no extension is loaded.
 * The name of a file is never taken for a URI or for a database in memory. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "study/internal.h"

enum { NAME = 3 * BWI_LONGEST_PATH + 32 };

/* ---- what works ------------------------------------------------------------------------------ */

static const int actions[] = {SQLITE_SELECT,      SQLITE_READ,         SQLITE_INSERT,
                              SQLITE_UPDATE,      SQLITE_DELETE,       SQLITE_CREATE_TABLE,
                              SQLITE_CREATE_VIEW, SQLITE_CREATE_INDEX, SQLITE_REINDEX,
                              SQLITE_TRANSACTION};

static const char *const functions[] = {"count", "max", "min", "sum"};

/* With its argument; NULL: with any, or none. */
static const struct {
  const char *name, *argument;
} pragmas[] = {{"application_id", NULL},   {"user_version", NULL},    {"quick_check", NULL},
               {"table_xinfo", NULL},      {"cell_size_check", "ON"}, {"journal_mode", "DELETE"},
               {"journal_mode", "MEMORY"}, {"journal_mode", "WAL"},   {"synchronous", "NORMAL"},
               {"temp_store", "MEMORY"}};

static const struct {
  int limit, value;
} limits[] = {{SQLITE_LIMIT_LENGTH, 1 << 26},     /* bytes of a value or a row */
              {SQLITE_LIMIT_SQL_LENGTH, 1 << 22}, /* bytes of a statement */
              {SQLITE_LIMIT_EXPR_DEPTH, 100},     {SQLITE_LIMIT_COMPOUND_SELECT, 16},
              {SQLITE_LIMIT_VDBE_OP, 1 << 18},    {SQLITE_LIMIT_ATTACHED, 0},
              {SQLITE_LIMIT_TRIGGER_DEPTH, 1},    {SQLITE_LIMIT_VARIABLE_NUMBER, 4000}};

static const struct {
  int option, on;
} options[] = {{SQLITE_DBCONFIG_DEFENSIVE, 1},
               {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
               {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
               {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
               {SQLITE_DBCONFIG_ENABLE_FTS3_TOKENIZER, 0},
               {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0}};

#define COUNT(list) (sizeof(list) / sizeof *(list))

static bool knows_function(const char *name) {
  for (size_t i = 0; name && i < COUNT(functions); i++)
    if (sqlite3_stricmp(name, functions[i]) == 0)
      return true;
  return false;
}

static bool knows_pragma(const char *name, const char *argument) {
  for (size_t i = 0; name && i < COUNT(pragmas); i++)
    if (sqlite3_stricmp(name, pragmas[i].name) == 0 &&
        (!pragmas[i].argument || (argument && sqlite3_stricmp(argument, pragmas[i].argument) == 0)))
      return true;
  return false;
}

static int authorise(void *data, int action, const char *first, const char *second,
                     const char *database, const char *trigger) {
  (void)data, (void)trigger;
  bool known = false;
  if (database && strcmp(database, "main") != 0)
    return SQLITE_DENY;
  if (action == SQLITE_FUNCTION)
    known = knows_function(second);
  else if (action == SQLITE_PRAGMA)
    known = knows_pragma(first, second);
  for (size_t i = 0; i < COUNT(actions) && !known; i++)
    known = action == actions[i];
  return known ? SQLITE_OK : SQLITE_DENY;
}

/* ---- a connection ---------------------------------------------------------------------------- */

/* "name arguments\n" of every function, to be released with sqlite3_free. The pragma does not read
 * the file, whose tables are to find the functions hidden already. */
static int list_functions(sqlite3 *connection, char **list) {
  enum { FUNCTION_NAME = 0, ARGUMENTS = 4 };
  sqlite3_stmt *row = NULL;
  sqlite3_str *text = sqlite3_str_new(connection);
  int code = sqlite3_prepare_v2(connection, "PRAGMA function_list", -1, &row, NULL);
  while (code == SQLITE_OK && (code = sqlite3_step(row)) == SQLITE_ROW) {
    sqlite3_str_appendf(text, "%s %d\n", sqlite3_column_text(row, FUNCTION_NAME),
                        sqlite3_column_int(row, ARGUMENTS));
    code = sqlite3_str_errcode(text);
  }
  sqlite3_finalize(row);
  *list = sqlite3_str_finish(text);
  return code != SQLITE_DONE ? code : *list ? SQLITE_OK : SQLITE_NOMEM;
}

/* A function without a body is one that SQLite does not find. It can only be put in place while no
 * statement runs. */
static int hide_functions(sqlite3 *connection) {
  char *list = NULL, *rest = NULL;
  int code = list_functions(connection, &list);
  for (char *name = list; code == SQLITE_OK && name && *name; name = rest) {
    char *arguments = strchr(name, ' ');
    *arguments++ = 0;
    rest = strchr(arguments, '\n') + 1;
    if (!knows_function(name))
      code = sqlite3_create_function_v2(connection, name, (int)strtol(arguments, NULL, 10),
                                        SQLITE_UTF8, NULL, NULL, NULL, NULL, NULL);
  }
  sqlite3_free(list);
  return code;
}

static int restrict_to_studies(sqlite3 *connection) {
  int code = sqlite3_drop_modules(connection, NULL);
  for (size_t i = 0; i < COUNT(options) && code == SQLITE_OK; i++)
    code = sqlite3_db_config(connection, options[i].option, options[i].on, NULL);
  for (size_t i = 0; i < COUNT(limits); i++)
    sqlite3_limit(connection, limits[i].limit, limits[i].value);
  if (code == SQLITE_OK)
    code = hide_functions(connection);
  return code == SQLITE_OK ? sqlite3_set_authorizer(connection, authorise, NULL) : code;
}

/* The name in the form that SQLite needs. "./" before a relative one: else "file:" and ":memory:"
 * have a meaning of their own. An immutable file has a URI; what that reserves is escaped. */
static void name_of(const char *path, bool immutable, char name[NAME]) {
  size_t at = (size_t)snprintf(name, NAME, "%s%s%s", immutable ? "file:" : "",
                               immutable && path[0] == '/' ? "//" : "", path[0] == '/' ? "" : "./");
  for (; *path; path++)
    at +=
        (size_t)snprintf(name + at, NAME - at, immutable && strchr("%?#", *path) ? "%%%02X" : "%c",
                         (unsigned char)*path);
  if (immutable)
    snprintf(name + at, NAME - at, "?immutable=1");
}

int bwi_connect(const char *path, int flags, sqlite3 **connection) {
  char name[NAME];
  const char *vfs = bwi_gate();
  if (!vfs)
    return SQLITE_ERROR;
  name_of(path, (flags & BWI_IMMUTABLE) != 0, name);
  int code = sqlite3_open_v2(name, connection, flags | SQLITE_OPEN_EXRESCODE, vfs);
  return code == SQLITE_OK ? restrict_to_studies(*connection) : code;
}
