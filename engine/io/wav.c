/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sound as a WAV file: RIFF, one channel, 16-bit samples. */
#include "io/internal.h"

#include <math.h>
#include <string.h>

enum { HEADER = 44, BLOCK = 4096 };

static void put(unsigned char *at, uint32_t value, int bytes) {
  for (int i = 0; i < bytes; i++)
    at[i] = (unsigned char)(value >> (8 * i));
}

static void header(unsigned char *at, int32_t rate, uint32_t data) {
  memcpy(at, "RIFF", 4);
  put(at + 4, 36 + data, 4);
  memcpy(at + 8, "WAVEfmt ", 8);
  put(at + 16, 16, 4);                 /* bytes of the format */
  put(at + 20, 1, 2);                  /* linear samples */
  put(at + 22, 1, 2);                  /* channels */
  put(at + 24, (uint32_t)rate, 4);     /* samples per second */
  put(at + 28, (uint32_t)rate * 2, 4); /* bytes per second */
  put(at + 32, 2, 2);                  /* bytes per sample */
  put(at + 34, 16, 2);                 /* bits per sample */
  memcpy(at + 36, "data", 4);
  put(at + 40, data, 4);
}

bw_status bw_wav_write(bw_context *context, const char *path, int32_t rate, int64_t count,
                       const double *sample) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  unsigned char block[BLOCK];
  if (rate < 1000 || rate > 768000)
    return bw_fail(context, BW_INVALID, "%d samples per second: from 1000 to 768000", rate);
  if (count < 0 || count > (INT32_MAX - HEADER) / 2)
    return bw_fail(context, BW_LIMIT, "%lld samples do not fit into a WAV file of 2 GB",
                   (long long)count);
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(sample[i]))
      return bw_fail(context, BW_INVALID, "sample %lld is not a number", (long long)i + 1);
  BW_TRY(bw_writer_open(context, path, &writer));
  header(block, rate, (uint32_t)(2 * count));
  BW_TRY(bw_writer_bytes(writer, block, HEADER));
  for (int64_t i = 0; i < count;) {
    int used = 0;
    for (; i < count && used < BLOCK; i++, used += 2) {
      double clipped = fmin(fmax(sample[i], -1), 1);
      put(block + used, (uint32_t)(int32_t)lround(clipped * 32767), 2);
    }
    BW_TRY(bw_writer_bytes(writer, block, (size_t)used));
  }
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  return status;
}
