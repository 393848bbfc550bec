/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Checkpoints of a library that is being built.
 *
 *   "BWMCKPT3", u32 length of the head, head, u32 checksum of the head
 *   records: u32 length n, n bytes (u8 level, u32 fit, f64 seconds so far, the fit), u32 checksum;
 *            of a fit that was grown the level has bit 7 set, and the key (8 or 64 bytes) comes
 * before the fit
 *
 * Records are appended by one write each, so that a kill leaves at most one that is cut short; the
 * disk is asked to keep them every few seconds, which is what a power cut may cost. Who opens a
 * checkpoint holds a lock on it. The mark's last digit moves whenever fits come out differently or
 * this layout changes, so that a library is never put together of fits of two kinds. */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "barwright/confine.h"
#include "base/words.h"
#include "metamaterial/library.h"

enum { MARK_BYTES = 8, RECORD_HEAD = 13, MAX_HEAD = 4096 };
static const char mark[MARK_BYTES + 1] = "BWMCKPT3";
static const double seconds_between_syncs = 3;

struct bwi_checkpoint {
  int file;
  char *path;
  double synced;
  pthread_mutex_t lock;
  bool failed; /* a record could not be written whole: nothing may follow it */
};

static uint32_t sum_of(const unsigned char *bytes, size_t count) {
  return (uint32_t)crc32(crc32(0, NULL, 0), bytes, (uInt)count);
}

static bw_status read_all(bw_context *context, int file, const char *path, unsigned char **bytes,
                          size_t *count) {
  struct stat about;
  if (fstat(file, &about) != 0)
    return bwi_fail_system(context, path, "cannot read");
  if (!S_ISREG(about.st_mode))
    return bw_fail(context, BW_IO, "%s is no regular file: a checkpoint needs one", path);
  *bytes = BW_NEW(context, unsigned char, about.st_size);
  if (!*bytes)
    return BW_MEMORY;
  for (*count = 0; *count < (size_t)about.st_size;) {
    ssize_t got = read(file, *bytes + *count, (size_t)about.st_size - *count);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      return bwi_fail_system(context, path, "cannot read");
    if (got == 0)
      break;
    *count += (size_t)got;
  }
  return BW_OK;
}

static bw_status write_all(bw_context *context, int file, const char *path,
                           const unsigned char *bytes, size_t count) {
  while (count > 0) {
    ssize_t written = write(file, bytes, count);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      return bwi_fail_system(context, path, "cannot add to the checkpoint");
    bytes += written;
    count -= (size_t)written;
  }
  return BW_OK;
}

/* mark, length, head, checksum; *used is their size, 0 where the file is cut short within them. */
static bw_status check_head(bw_context *context, const char *path, const unsigned char *bytes,
                            size_t count, const bwi_pack *head,
                            const bw_material_table *material_table,
                            const bw_library_options *options, size_t *used) {
  bwi_unpack from = {context, path, "head", bytes, bytes + count, false};
  bw_material_table *other = NULL;
  bw_library_options other_options;
  char why[512];
  size_t marked = count < MARK_BYTES ? count : MARK_BYTES;
  *used = 0;
  if (memcmp(bytes, mark, marked) != 0)
    return bw_fail(context, BW_FORMAT, "%s is no checkpoint of a library of this version", path);
  bwi_unpack_bytes(&from, MARK_BYTES);
  uint32_t length = bwi_unpack_u32(&from);
  if (!from.short_of && length > MAX_HEAD)
    return bw_fail(context, BW_FORMAT, "%s: the head of this checkpoint is damaged", path);
  const unsigned char *its = bwi_unpack_bytes(&from, length);
  uint32_t sum = bwi_unpack_u32(&from);
  if (from.short_of)
    return BW_OK; /* killed before the head was written: begin again */
  *used = (size_t)(from.at - bytes);
  if (length == head->count && memcmp(its, head->bytes, length) == 0 && sum == sum_of(its, length))
    return BW_OK;
  if (sum != sum_of(its, length))
    return bw_fail(context, BW_FORMAT, "%s: the head of this checkpoint is damaged", path);
  bwi_unpack inside = {context, path, "head", its, its + length, false};
  bw_status status = bwi_unpack_head(&inside, &other, &other_options);
  if (status != BW_OK)
    return status;
  if (!bwi_head_differs(material_table, options, other, &other_options, why, sizeof why))
    snprintf(why, sizeof why, "its materials have other names");
  bw_release(other);
  return bw_fail(
      context, BW_INVALID,
      "%s is a checkpoint of another library: %s. Name another file, or the same material table "
      "and options",
      path, why);
}

/* Sound records up to the first that is not; *used moves past them. */
static bw_status take_records(bw_context *context, const char *path, const unsigned char *bytes,
                              size_t count, bwi_checkpoint_fit *fit, void *data, double *seconds,
                              size_t *used) {
  bwi_unpack from = {context, path, "records", bytes + *used, bytes + count, false};
  for (;;) {
    uint32_t length = bwi_unpack_u32(&from);
    const unsigned char *its = bwi_unpack_bytes(&from, length);
    uint32_t sum = bwi_unpack_u32(&from);
    if (from.short_of || length < RECORD_HEAD || sum != sum_of(its, length))
      return BW_OK;
    bwi_unpack record = {context, path, "records", its, its + length, false};
    bw_solid_material *material = NULL;
    bw_fit_error error;
    unsigned kind = bwi_unpack_u8(&record);
    int level = (int)(kind & 127u);
    int32_t number = (int32_t)bwi_unpack_u32(&record);
    double so_far = bwi_unpack_f64(&record);
    if (level < 1 || level > 2 || number < 0)
      return bwi_unpack_fail(&record, "a record of fit %d of level %d", (int)number, level);
    const uint8_t *key = kind & 128u ? bwi_unpack_bytes(&record, level == 1 ? 8 : 64) : NULL;
    if (record.short_of)
      return bwi_unpack_end(&record);
    bw_status status = bwi_unpack_fit(&record, level, number, &material, &error);
    if (status == BW_OK)
      status = bwi_unpack_end(&record);
    if (status != BW_OK) {
      bw_release(material);
      return status;
    }
    status = fit(data, level, number, key, material, &error);
    if (status != BW_OK)
      return status;
    *seconds = so_far > *seconds ? so_far : *seconds;
    *used = (size_t)(from.at - bytes);
  }
}

static bw_status write_head(bw_context *context, const bwi_checkpoint *it, const bwi_pack *head) {
  bwi_pack whole;
  bwi_pack_begin(&whole, context);
  bwi_pack_bytes(&whole, mark, MARK_BYTES);
  bwi_pack_u32(&whole, (uint32_t)head->count);
  bwi_pack_bytes(&whole, head->bytes, head->count);
  bwi_pack_u32(&whole, sum_of(head->bytes, head->count));
  bw_status status = whole.status;
  if (status == BW_OK)
    status = write_all(context, it->file, it->path, whole.bytes, whole.count);
  bwi_pack_clear(&whole);
  return status;
}

bw_status bwi_checkpoint_open(bw_context *context, const char *path,
                              const bw_material_table *material_table,
                              const bw_library_options *options, bwi_checkpoint_fit *fit,
                              void *data, double *seconds, bwi_checkpoint **out) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  size_t count = 0, used = 0;
  bwi_pack head;
  bwi_pack_begin(&head, context);
  bwi_checkpoint *it = BW_NEW0(context, bwi_checkpoint, 1);
  if (!it)
    return BW_MEMORY;
  pthread_mutex_init(&it->lock, NULL);
  it->file = -1;
  it->path = BW_NEW(context, char, strlen(path) + 1);
  BW_TRY_MEMORY(it->path);
  strcpy(it->path, path);
  BW_TRY(bw_may_use(context, path, BW_TO_WRITE));
  it->file = bw_open(path, O_RDWR | O_CREAT | O_APPEND, 0666);
  if (it->file < 0)
    BW_TRY(bwi_fail_system(context, path, "cannot open the checkpoint"));
  if (flock(it->file, LOCK_EX | LOCK_NB) != 0)
    BW_TRY(errno == EWOULDBLOCK
               ? bw_fail(context, BW_IO, "%s: another process uses this checkpoint", path)
               : bwi_fail_system(context, path, "cannot lock the checkpoint"));
  bwi_pack_head(&head, material_table, options);
  BW_TRY(head.status);
  BW_TRY(read_all(context, it->file, path, &bytes, &count));
  BW_TRY(check_head(context, path, bytes, count, &head, material_table, options, &used));
  *seconds = 0;
  if (used > 0)
    BW_TRY(take_records(context, path, bytes, count, fit, data, seconds, &used));
  if (used < count && ftruncate(it->file, (off_t)used) != 0)
    BW_TRY(bwi_fail_system(context, path, "cannot cut off what a kill left"));
  if (used == 0)
    BW_TRY(write_head(context, it, &head));
  it->synced = bw_seconds();
  *out = it;
  it = NULL;
done:
  bwi_pack_clear(&head);
  bw_free(bytes);
  bwi_checkpoint_close(it);
  return status;
}

bw_status bwi_checkpoint_add(bw_context *context, bwi_checkpoint *it, int level, int32_t fit,
                             const uint8_t *key, double seconds, const bwi_pack *packed) {
  bwi_pack record;
  bwi_pack_begin(&record, context);
  size_t width = !key ? 0 : level == 1 ? 8 : 64;
  bwi_pack_u32(&record, (uint32_t)(RECORD_HEAD + width + packed->count));
  bwi_pack_u8(&record, (unsigned)level | (key ? 128u : 0));
  bwi_pack_u32(&record, (uint32_t)fit);
  bwi_pack_f64(&record, seconds);
  if (key)
    bwi_pack_bytes(&record, key, width);
  bwi_pack_bytes(&record, packed->bytes, packed->count);
  if (record.status == BW_OK)
    bwi_pack_u32(&record, sum_of(record.bytes + 4, record.count - 4));
  bw_status status = record.status;
  pthread_mutex_lock(&it->lock);
  if (status == BW_OK && it->failed)
    status = bw_fail(context, BW_IO, "%s: cannot add to the checkpoint", it->path);
  if (status == BW_OK) {
    status = write_all(context, it->file, it->path, record.bytes, record.count);
    it->failed = status != BW_OK;
  }
  if (status == BW_OK && bw_seconds() - it->synced > seconds_between_syncs) {
    fdatasync(it->file);
    it->synced = bw_seconds();
  }
  pthread_mutex_unlock(&it->lock);
  bwi_pack_clear(&record);
  return status;
}

void bwi_checkpoint_close(bwi_checkpoint *it) {
  if (!it)
    return;
  if (it->file >= 0) {
    fdatasync(it->file);
    close(it->file);
  }
  pthread_mutex_destroy(&it->lock);
  bw_free(it->path);
  bw_free(it);
}
