/* What the files of study share. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_STUDY_INTERNAL_H
#define BWI_STUDY_INTERNAL_H

#include <sqlite3.h>
#include <sys/types.h>

#include "barwright/study.h"

enum { BWI_STATEMENTS_KEPT = 64, BWI_LONGEST_PATH = 4096 };

struct bw_statement {
  bw_database *database;
  sqlite3_stmt *handle;
  char *text;
  bool in_use;
  uint64_t last_use;
};

struct bw_database {
  bw_object object;
  sqlite3 *connection;
  pid_t owner;
  double busy_seconds, busy_since;
  bw_context *context; /* of the call that runs, for cancelling */
  uint64_t clock;      /* counts uses of statements */
  int64_t changed;     /* rows, by the last statement */
  int64_t total;       /* rows changed since the opening, as far as `changed` knows */
  bw_statement kept[BWI_STATEMENTS_KEPT];
  char path[BWI_LONGEST_PATH];
};

/* Opens a file of results; `flags` are SQLite's. On the connection only what studies need works
 * (connection.c). Returns SQLite's extended result; the connection is to be closed in any case. */
enum { BWI_IMMUTABLE = SQLITE_OPEN_URI }; /* a flag: nobody writes the file meanwhile */
int bwi_connect(const char *path, int flags, sqlite3 **connection);

/* The name of the VFS that asks bw_may_use; NULL where SQLite has none to stand on. */
const char *bwi_gate(void);

/* Every use of a database begins with it: refused in another process than the opener's. */
bw_status bwi_database_enter(bw_context *context, bw_database *database);
/* A statement has ended well: notes how many rows it changed. */
void bwi_database_note_changes(bw_database *database);
/* Records a failure of SQLite; `code` is the extended result. A transaction that cannot be trusted
 * after it is rolled back. */
bw_status bwi_database_failure(bw_context *context, bw_database *database, int code);
/* Records "path: sentence" with the details "file" and (unless NULL) "reason". */
bw_status bwi_database_fail(bw_context *context, bw_status status, const char *reason,
                            const char *path, const char *format, ...) BW_PRINTF(5, 6);

/* In the first bytes of every file: magic, and at its place the mark of barwright
 * (SQLite's application_id) and the version of the format (user_version), big-endian. */
enum { BWI_HEADER = 100, BWI_MODE_AT = 18, BWI_VERSION_AT = 60, BWI_MARK_AT = 68 };
extern const char bwi_magic[16];
extern const int32_t bwi_mark;
int32_t bwi_big_endian(const unsigned char *at);
ino_t bwi_changes_ahead(const char *path);
bool bwi_expects_changes(const unsigned char *head);

#endif
