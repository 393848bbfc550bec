/* What SQLite's failures mean to whoever uses a file of results. See study.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include "base/words.h"
#include "study/internal.h"

bw_status bwi_database_fail(bw_context *context, bw_status status, const char *reason,
                            const char *path, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bw_fail(context, status, "%s: %s", path, text);
  if (reason)
    bw_detail_text(context, "reason", reason);
  bw_detail_text(context, "file", path);
  return status;
}

static bw_status full_disk(bw_context *context, const char *path, int error) {
  char words[BWI_WORDS];
  if (error == EFBIG)
    return bwi_database_fail(context, BW_LIMIT, "full", path,
                             "%s; what was committed before is kept",
                             bwi_system_words(error, words));
  bw_status status = bwi_database_fail(
      context, BW_LIMIT, "full", path,
      "no room is left on its disk; what was committed before is kept. Free some space and go on");
  char folder[BWI_LONGEST_PATH];
  snprintf(folder, sizeof folder, "%s", path);
  char *slash = strrchr(folder, '/');
  if (slash)
    slash[slash == folder] = 0;
  struct statvfs disk;
  if (statvfs(slash ? folder : ".", &disk) == 0)
    bw_detail_number(context, "free_bytes", (double)disk.f_bavail * (double)disk.f_frsize);
  return status;
}

/* SQLite does not always keep what the system said: whether the file, or what stands beside it, has
 * no room to grow. */
static int why_not_written(const char *path) {
  enum { LITTLE = 1 << 16 };
  struct rlimit sizes;
  struct stat about;
  char name[BWI_LONGEST_PATH + 8];
  static const char *const ending[] = {"", "-wal", "-shm"};
  if (getrlimit(RLIMIT_FSIZE, &sizes) == 0 && sizes.rlim_cur != RLIM_INFINITY)
    for (int i = 0; i < 3; i++) {
      snprintf(name, sizeof name, "%s%s", path, ending[i]);
      if (stat(name, &about) == 0 && (rlim_t)about.st_size + LITTLE > sizes.rlim_cur)
        return EFBIG;
    }
  struct statvfs disk;
  if (statvfs(path, &disk) == 0 && (double)disk.f_bavail * (double)disk.f_frsize < LITTLE)
    return ENOSPC;
  return 0;
}

static bw_status refused(bw_context *context, const char *path, const char *words, int error) {
  return bwi_database_fail(context, BW_IO, NULL, path, "%s%s%s", words, error ? ": " : "",
                           error ? strerror(error) : "");
}

static bw_status describe(bw_context *context, sqlite3 *connection, int code, const char *path) {
  const char *words = connection ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
  int error = connection ? sqlite3_system_errno(connection) : 0;
  switch (code & 0xff) {
  case SQLITE_NOMEM:
    return bw_fail(context, BW_MEMORY, "%s: out of memory", path);
  case SQLITE_CORRUPT:
  case SQLITE_NOTADB:
    return bwi_database_fail(
        context, BW_FORMAT, "damaged", path,
        "the file is damaged (%s); what is readable can be copied to a new one "
        "(salvage)",
        words);
  case SQLITE_FULL:
    return full_disk(context, path, error);
  case SQLITE_BUSY:
  case SQLITE_LOCKED:
  case SQLITE_PROTOCOL:
    return bwi_database_fail(context, BW_LIMIT, "busy", path,
                             "another process is writing it, for longer than was waited (%s)",
                             words);
  case SQLITE_INTERRUPT:
    return bw_fail(context, BW_CANCELLED, "cancelled");
  case SQLITE_CONSTRAINT:
    return bwi_database_fail(context, BW_INFEASIBLE, "constraint", path, "%s", words);
  case SQLITE_TOOBIG:
    return bwi_database_fail(context, BW_LIMIT, "size", path, "%s", words);
  case SQLITE_IOERR:
    if (error == 0 && (code == SQLITE_IOERR_WRITE || code == SQLITE_IOERR_SHMSIZE ||
                       code == SQLITE_IOERR_TRUNCATE))
      error = why_not_written(path);
    if (error == ENOSPC || error == EFBIG || error == EDQUOT)
      return full_disk(context, path, error);
    return refused(context, path, words, error);
  case SQLITE_CANTOPEN:
  case SQLITE_PERM:
  case SQLITE_READONLY:
  case SQLITE_NOLFS:
    return refused(context, path, words, error);
  case SQLITE_AUTH:
    return bwi_database_fail(context, BW_INVALID, "sql", path,
                             "%s: only statements that studies need work on it", words);
  default:
    return bwi_database_fail(context, BW_INVALID, "sql", path, "%s", words);
  }
}

bw_status bwi_database_failure(bw_context *context, bw_database *d, int code) {
  bw_status status = describe(context, d->connection, code, d->path);
  if (status == BW_CANCELLED && !bw_cancelled(context))
    status = bw_fail(context, BW_INTERNAL, "%s: SQLite was interrupted without a request", d->path);
  bool untrusted = status == BW_FORMAT || status == BW_IO || status == BW_MEMORY ||
                   (status == BW_LIMIT && (code & 0xff) != SQLITE_BUSY);
  if (untrusted && d->connection && !sqlite3_get_autocommit(d->connection))
    sqlite3_exec(d->connection, "ROLLBACK", NULL, NULL, NULL);
  return status;
}
