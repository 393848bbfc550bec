/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Files that appear whole or not at all.
 *
 * Bytes go to a partial file beside the target. Commit flushes it to the disk and renames it over
 * the target; until then the target is what it was. The first error sticks: later calls return it,
 * and commit removes the partial file. A target that exists and is no regular file (a terminal, a
 * pipe, /dev/null) cannot be renamed over and is written directly. */
#include "barwright/confine.h"
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

enum { BUFFER_BYTES = 1 << 16, OPEN_PARTIALS = 64 };

struct bw_writer {
  bw_context *context;
  char *path;    /* the target, symbolic links followed */
  char *partial; /* NULL: written directly */
  int slot;      /* in open_partial, or -1 */
  int file;
  bw_status status; /* the first error */
  size_t used;
  unsigned char buffer[BUFFER_BYTES];
};

/* The partial files that exist now, for bw_writers_abandon: a signal handler may read it at any
 * time, so an entry is one pointer, set after the file was made and cleared before it is freed. */
static char *open_partial[OPEN_PARTIALS];

static int enter_partial(char *path) {
  for (int i = 0; i < OPEN_PARTIALS; i++) {
    char *none = NULL;
    if (__atomic_compare_exchange_n(&open_partial[i], &none, path, false, __ATOMIC_SEQ_CST,
                                    __ATOMIC_SEQ_CST))
      return i;
  }
  return -1;
}

void bw_writers_abandon(void) {
  for (int i = 0; i < OPEN_PARTIALS; i++) {
    char *path = __atomic_load_n(&open_partial[i], __ATOMIC_SEQ_CST);
    if (path)
      unlink(path);
  }
}

static bw_status fail_system(bw_context *context, const char *path, const char *doing) {
  char text[BWI_WORDS];
  bw_fail(context, BW_IO, "%s: %s: %s", path, doing, bwi_system_words(errno, text));
  bw_detail_text(context, "file", path);
  return BW_IO;
}

static void writer_free(bw_writer *writer) {
  if (writer->slot >= 0)
    __atomic_store_n(&open_partial[writer->slot], NULL, __ATOMIC_SEQ_CST);
  bw_free(writer->path);
  bw_free(writer->partial);
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
  size_t bytes = strlen(writer->path) + 48;
  writer->partial = BW_NEW(writer->context, char, bytes);
  if (!writer->partial)
    return BW_MEMORY;
  /* The plain name may be taken by another writer of this process, or be left over from a process
   * of the same number that was killed. */
  for (int i = 0; i < 100 && writer->file < 0; i++) {
    if (i == 0)
      snprintf(writer->partial, bytes, "%s.partial-%ld", writer->path, (long)getpid());
    else
      snprintf(writer->partial, bytes, "%s.partial-%ld-%d", writer->path, (long)getpid(), i);
    writer->file = bw_open(writer->partial, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (writer->file < 0 && errno != EEXIST)
      break;
  }
  if (writer->file < 0)
    return fail_system(writer->context, writer->path, "cannot write beside it");
  writer->slot = enter_partial(writer->partial);
  if (old && fchmod(writer->file, old->st_mode & 07777) != 0)
    return fail_system(writer->context, writer->path, "cannot keep its permissions");
  return BW_OK;
}

bw_status bw_writer_open(bw_context *context, const char *path, bw_writer **writer) {
  bw_status status = BW_OK;
  bw_writer *made = BW_NEW(context, bw_writer, 1);
  if (!made)
    return BW_MEMORY;
  made->context = context;
  made->path = made->partial = NULL;
  made->slot = made->file = -1;
  made->status = BW_OK;
  made->used = 0;
  struct stat old;
  if (!path[0]) {
    status = bw_fail(context, BW_INVALID, "an empty path: the name of a file is needed");
    goto done;
  }
  BW_TRY(bw_may_use(context, path, BW_TO_WRITE));
  BW_TRY(resolve(made, path));
  bool exists = stat(made->path, &old) == 0;
  if (exists && S_ISDIR(old.st_mode)) {
    errno = EISDIR;
    BW_TRY(fail_system(context, path, "cannot write"));
  }
  if (exists && access(made->path, W_OK) != 0)
    BW_TRY(fail_system(context, path, "cannot write"));
  if (exists && !S_ISREG(old.st_mode)) {
    made->file = bw_open(made->path, O_WRONLY, 0);
    if (made->file < 0)
      BW_TRY(fail_system(context, path, "cannot write"));
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
      return writer->status = fail_system(writer->context, writer->path, "cannot write");
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
    writer->status = fail_system(writer->context, writer->path, "cannot write");
  int closed = close(writer->file);
  writer->file = -1;
  if (writer->status == BW_OK && closed != 0)
    writer->status = fail_system(writer->context, writer->path, "cannot write");
  if (writer->status == BW_OK && writer->partial) {
    if (bw_rename(writer->partial, writer->path) != 0) {
      writer->status = fail_system(writer->context, writer->path, "cannot put it in place");
    } else {
      sync_directory(writer->path);
      writer_free(writer);
      return BW_OK;
    }
  }
  bw_status status = writer->status;
  bw_writer_discard(writer);
  return status;
}

void bw_writer_discard(bw_writer *writer) {
  if (!writer)
    return;
  if (writer->file >= 0) {
    if (writer->partial)
      bw_remove(writer->partial);
    close(writer->file);
  } else if (writer->partial && writer->slot >= 0) {
    bw_remove(writer->partial); /* closed by a commit that failed */
  }
  writer_free(writer);
}
