/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Files that appear whole or not at all.
 *
 * Bytes go to a partial file beside the target. Commit flushes it to the disk and renames it over
 * the target; until then the target is what it was. The first error sticks: later calls return it,
 * and commit removes the partial file. A target that exists and is no regular file (a terminal, a
 * pipe, /dev/null) cannot be renamed over and is written directly. */
#include "barwright/confine.h"
#include "barwright/temporary.h"
#include "base/words.h"
#include "io/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/locale.h"

enum { BUFFER_BYTES = 1 << 16 };

struct bw_writer {
  bw_context *context;
  char *path;            /* the target, symbolic links followed */
  bw_temporary *partial; /* NULL: written directly */
  int file;
  bw_status status; /* the first error */
  size_t used;
  unsigned char buffer[BUFFER_BYTES];
};

static void writer_free(bw_writer *writer) {
  bw_release(writer->partial);
  bw_free(writer->path);
  bw_free(writer);
}

/* The target with symbolic links followed, so that a link stays a link. */
static bw_status resolve(bw_writer *writer, const char *path) {
  struct stat link;
  char *real = NULL;
  if (lstat(path, &link) == 0 && S_ISLNK(link.st_mode))
    real = realpath(path, NULL); /* NULL for a dangling link: then the link is replaced */
  const char *use = real ? real : path;
  size_t bytes = strlen(use) + 1;
  writer->path = BW_NEW(writer->context, char, bytes);
  if (writer->path)
    memcpy(writer->path, use, bytes);
  free(real);
  return writer->path ? BW_OK : BW_MEMORY;
}

static bw_status open_beside(bw_writer *writer, const struct stat *old) {
  bw_status status = bw_temporary_create(writer->context, writer->path, false, &writer->partial);
  if (status != BW_OK)
    return status;
  writer->file = bw_temporary_file(writer->partial);
  if (old && fchmod(writer->file, old->st_mode & 07777) != 0)
    return bwi_fail_system(writer->context, writer->path, "cannot keep its permissions");
  return BW_OK;
}

bw_status bw_writer_open(bw_context *context, const char *path, bw_writer **writer) {
  bw_status status = BW_OK;
  bw_writer *made = BW_NEW(context, bw_writer, 1);
  if (!made)
    return BW_MEMORY;
  made->context = context;
  made->path = NULL;
  made->partial = NULL;
  made->file = -1;
  made->status = BW_OK;
  made->used = 0;
  struct stat old;
  if (!path[0])
    BW_TRY(bw_fail(context, BW_INVALID, "an empty path: the name of a file is needed"));
  BW_TRY(bw_may_use(context, path, BW_TO_WRITE));
  BW_TRY(resolve(made, path));
  bool exists = stat(made->path, &old) == 0;
  if (exists && S_ISDIR(old.st_mode)) {
    errno = EISDIR;
    BW_TRY(bwi_fail_system(context, path, "cannot write"));
  }
  if (exists && access(made->path, W_OK) != 0)
    BW_TRY(bwi_fail_system(context, path, "cannot write"));
  if (exists && !S_ISREG(old.st_mode)) {
    made->file = bw_open(made->path, O_WRONLY, 0);
    if (made->file < 0)
      BW_TRY(bwi_fail_system(context, path, "cannot write"));
  } else {
    BW_TRY(open_beside(made, exists ? &old : NULL));
  }
  *writer = made;
  return BW_OK;
done:
  bw_writer_discard(made);
  return status;
}

bw_context *bwi_writer_context(const bw_writer *writer) {
  return writer->context;
}

static bw_status put(bw_writer *writer, const unsigned char *bytes, size_t count) {
  while (count > 0) {
    ssize_t written = write(writer->file, bytes, count);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0) {
      if (written == 0)
        errno = EIO;
      return writer->status = bwi_fail_system(writer->context, writer->path, "cannot write");
    }
    bytes += written;
    count -= (size_t)written;
  }
  return BW_OK;
}

static bw_status flush(bw_writer *writer) {
  size_t used = writer->used;
  writer->used = 0;
  return put(writer, writer->buffer, used);
}

bw_status bw_writer_bytes(bw_writer *writer, const void *bytes, size_t count) {
  if (writer->status != BW_OK)
    return writer->status;
  if (count > BUFFER_BYTES - writer->used && flush(writer) != BW_OK)
    return writer->status;
  if (count > BUFFER_BYTES)
    return put(writer, bytes, count);
  if (count > 0)
    memcpy(writer->buffer + writer->used, bytes, count);
  writer->used += count;
  return BW_OK;
}

bw_status bw_writer_print(bw_writer *writer, const char *format, ...) {
  if (writer->status != BW_OK)
    return writer->status;
  char text[512];
  va_list arguments;
  locale_t before = uselocale(bwi_c_locale());
  va_start(arguments, format);
  int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (length >= 0 && (size_t)length < sizeof text) {
    uselocale(before);
    return bw_writer_bytes(writer, text, (size_t)length);
  }
  char *longer = length < 0 ? NULL : BW_NEW(writer->context, char, (size_t)length + 1);
  if (longer) {
    va_start(arguments, format);
    vsnprintf(longer, (size_t)length + 1, format, arguments);
    va_end(arguments);
  }
  uselocale(before);
  if (!longer)
    return writer->status = BW_MEMORY;
  bw_writer_bytes(writer, longer, (size_t)length);
  bw_free(longer);
  return writer->status;
}

bw_status bw_writer_number(bw_writer *writer, double value) {
  char text[BW_NUMBER_BYTES];
  return bw_writer_bytes(writer, text, (size_t)bw_format_number(value, text));
}

bw_status bw_writer_integer(bw_writer *writer, int64_t value) {
  char text[24];
  char *at = text + sizeof text;
  uint64_t rest = value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
  do
    *--at = (char)('0' + rest % 10);
  while (rest /= 10);
  if (value < 0)
    *--at = '-';
  return bw_writer_bytes(writer, at, (size_t)(text + sizeof text - at));
}

/* So that the new name survives a power cut too. Not every file system can do it: no error. */
static void sync_directory(const char *path) {
  char folder[4096] = ".";
  const char *slash = strrchr(path, '/');
  if (slash && (size_t)(slash - path) + 2 <= sizeof folder) {
    size_t length = slash == path ? 1 : (size_t)(slash - path);
    memcpy(folder, path, length);
    folder[length] = 0;
  }
  int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file >= 0) {
    fsync(file);
    close(file);
  }
}

bw_status bw_writer_commit(bw_writer *writer) {
  if (writer->status == BW_OK)
    flush(writer);
  if (writer->status == BW_OK && writer->partial && fsync(writer->file) != 0 && errno != EINVAL)
    writer->status = bwi_fail_system(writer->context, writer->path, "cannot write");
  /* Some file systems say at the closing alone that there was no room: of a second descriptor, as
   * the first one holds the lock. */
  int other = writer->partial ? dup(writer->file) : writer->file;
  writer->file = writer->partial ? writer->file : -1;
  if (other >= 0 && close(other) != 0 && writer->status == BW_OK)
    writer->status = bwi_fail_system(writer->context, writer->path, "cannot write");
  if (writer->status == BW_OK && writer->partial) {
    if (bw_temporary_put_in_place(writer->partial, writer->path) != 0)
      writer->status = bwi_fail_system(writer->context, writer->path, "cannot put it in place");
    else
      sync_directory(writer->path);
  }
  bw_status status = writer->status;
  bw_writer_discard(writer);
  return status;
}

void bw_writer_discard(bw_writer *writer) {
  if (!writer)
    return;
  if (writer->file >= 0 && !writer->partial)
    close(writer->file);
  writer_free(writer);
}
