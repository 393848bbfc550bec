/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Animated PNG: the chunks of the first file, and of every other one its compressed rows, each
 * with the number that it has in the sequence.
 *
 * A PNG is 8 bytes of signature and chunks: length (of the data, big endian), four letters, data,
 * CRC of letters and data. acTL (how many pictures, how often) comes before the rows, fcTL (size,
 * delay) before each picture's; rows are IDAT in the first picture and fdAT in the rest. */
#include <math.h>
#include <string.h>
#include <zlib.h>

#include "picture/internal.h"

enum { SIGNATURE = 8, HEADER_DATA = 13, OVERHEAD = 12, MAX_PICTURES = 10000 };

static const unsigned char signature[SIGNATURE] = {137, 'P', 'N', 'G', 13, 10, 26, 10};

typedef struct chunk {
  const unsigned char *type, *data;
  size_t length;
} chunk;

static uint32_t big_endian(const unsigned char *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static void put(unsigned char *at, uint32_t value, int bytes) {
  for (int i = 0; i < bytes; i++)
    at[i] = (unsigned char)(value >> (8 * (bytes - 1 - i)));
}

static void write_chunk(bw_writer *writer, const char *type, const unsigned char *first,
                        size_t first_length, const unsigned char *rest, size_t rest_length) {
  unsigned char word[4];
  put(word, (uint32_t)(first_length + rest_length), 4);
  bw_writer_bytes(writer, word, 4);
  bw_writer_bytes(writer, type, 4);
  bw_writer_bytes(writer, first, first_length);
  bw_writer_bytes(writer, rest, rest_length);
  uLong crc = crc32(0, (const unsigned char *)type, 4);
  crc = crc32(crc, first, (uInt)first_length);
  crc = rest_length ? crc32(crc, rest, (uInt)rest_length) : crc;
  put(word, (uint32_t)crc, 4);
  bw_writer_bytes(writer, word, 4);
}

/* The chunk at *at, which moves behind it; false where none fits. */
static bool next_chunk(const unsigned char *bytes, size_t count, size_t *at, chunk *out) {
  if (count - *at < OVERHEAD)
    return false;
  out->length = big_endian(bytes + *at);
  out->type = bytes + *at + 4;
  out->data = out->type + 4;
  if (out->length > count - *at - OVERHEAD)
    return false;
  *at += OVERHEAD + out->length;
  return true;
}

static bw_status check_picture(bw_context *context, const char *path, const unsigned char *bytes,
                               size_t count, unsigned char header[HEADER_DATA], bool first) {
  chunk c;
  size_t at = SIGNATURE;
  if (count < SIGNATURE || memcmp(bytes, signature, SIGNATURE) != 0 ||
      !next_chunk(bytes, count, &at, &c) || memcmp(c.type, "IHDR", 4) != 0 ||
      c.length != HEADER_DATA)
    return bw_fail(context, BW_FORMAT, "%s: this is no PNG file", path);
  if (first)
    memcpy(header, c.data, HEADER_DATA);
  else if (memcmp(header, c.data, HEADER_DATA) != 0)
    return bw_fail(context, BW_INVALID,
                   "%s: %u x %u pixels; the first picture has %u x %u, and all must be alike", path,
                   (unsigned)big_endian(c.data), (unsigned)big_endian(c.data + 4),
                   (unsigned)big_endian(header), (unsigned)big_endian(header + 4));
  return BW_OK;
}

/* The rows of one picture, behind its fcTL. */
static bw_status write_rows(bw_context *context, bw_writer *writer, const char *path,
                            const unsigned char *bytes, size_t count, bool first,
                            uint32_t *sequence) {
  chunk c;
  size_t at = SIGNATURE;
  bool ended = false;
  while (!ended && next_chunk(bytes, count, &at, &c)) {
    ended = memcmp(c.type, "IEND", 4) == 0;
    if (memcmp(c.type, "IDAT", 4) != 0)
      continue;
    if (first) {
      write_chunk(writer, "IDAT", c.data, c.length, NULL, 0);
      continue;
    }
    unsigned char number[4];
    put(number, (*sequence)++, 4);
    write_chunk(writer, "fdAT", number, 4, c.data, c.length);
  }
  return ended ? BW_OK : bw_fail(context, BW_FORMAT, "%s: the PNG file ends early", path);
}

static void write_control(bw_writer *writer, const unsigned char header[HEADER_DATA],
                          double seconds, uint32_t *sequence) {
  unsigned char data[26] = {0}; /* the whole picture replaces the one before */
  put(data, (*sequence)++, 4);
  memcpy(data + 4, header, 8);
  put(data + 20, (uint32_t)lround(1000 * seconds), 2);
  put(data + 22, 1000, 2);
  write_chunk(writer, "fcTL", data, sizeof data, NULL, 0);
}

bw_status bw_animation_write(bw_context *context, int count, const char *const *png, double seconds,
                             int rounds, const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  unsigned char *bytes = NULL, header[HEADER_DATA], control[8];
  size_t size;
  uint32_t sequence = 0;
  if (count < 1 || count > MAX_PICTURES)
    return bw_fail(context, BW_INVALID, "an animation of %d pictures: 1 to %d are possible", count,
                   MAX_PICTURES);
  if (!(seconds >= 0.001 && seconds <= 60) || rounds < 0)
    return bw_fail(context, BW_INVALID,
                   "pictures of %g s, %d rounds: 0.001 to 60 s and 0 rounds or more expected",
                   seconds, rounds);
  BW_TRY(bwi_need_png(context, path));
  BW_TRY(bw_writer_open(context, path, &writer));
  for (int i = 0; i < count; i++) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_read_file(context, png[i], &bytes, &size));
    BW_TRY(check_picture(context, png[i], bytes, size, header, i == 0));
    if (i == 0) {
      bw_writer_bytes(writer, signature, SIGNATURE);
      write_chunk(writer, "IHDR", header, HEADER_DATA, NULL, 0);
      put(control, (uint32_t)count, 4);
      put(control + 4, (uint32_t)rounds, 4);
      write_chunk(writer, "acTL", control, sizeof control, NULL, 0);
    }
    write_control(writer, header, seconds, &sequence);
    BW_TRY(write_rows(context, writer, png[i], bytes, size, i == 0, &sequence));
    bw_free(bytes);
    bytes = NULL;
  }
  write_chunk(writer, "IEND", control, 0, NULL, 0);
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  bw_free(bytes);
  return status;
}
