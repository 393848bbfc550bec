/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* ZIP archives, by PKWARE's APPNOTE 6.3: local headers and bytes of the members, then a directory
 * and where it lies. The directory alone counts in reading. */
#include "io/zip.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum { LOCAL = 30, CENTRAL = 46, END = 22, END64 = 56, LOCATOR = 20, LONGEST_COMMENT = 65535 };

bool bwi_is_zip(const bwi_cursor *cursor) {
  return bwi_left(cursor) >= 4 &&
         (memcmp(cursor->at, "PK\3\4", 4) == 0 || memcmp(cursor->at, "PK\5\6", 4) == 0);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Where the directory lies, and how many entries it has. */
static bw_status find_directory(const bwi_cursor *archive, uint64_t *count, uint64_t *first) {
  const unsigned char *bytes = archive->begin, *at = archive->end;
  size_t whole = (size_t)(archive->end - archive->begin);
  if (whole >= END)
    for (at -= END; at > bytes && memcmp(at, "PK\5\6", 4) != 0 &&
                    (size_t)(archive->end - at) < LONGEST_COMMENT + END;)
      at--;
  if (whole < END || memcmp(at, "PK\5\6", 4) != 0)
    return bwi_fail_byte(archive,
                         "the directory of a ZIP archive is missing: the file is cut short");
  *count = bwi_u16(at + 10, false);
  *first = bwi_u32(at + 16, false);
  if (at - bytes >= LOCATOR + END64 && memcmp(at - LOCATOR, "PK\6\7", 4) == 0) {
    uint64_t wide = bwi_u64(at - LOCATOR + 8, false);
    if (wide > (uint64_t)(at - bytes) - LOCATOR - END64 || memcmp(bytes + wide, "PK\6\6", 4) != 0)
      return bwi_fail_byte(archive, "the directory of the archive is damaged");
    *count = bwi_u64(bytes + wide + 32, false);
    *first = bwi_u64(bytes + wide + 48, false);
  }
  if (*first > whole || *count > (whole - *first) / CENTRAL)
    return bwi_fail_byte(archive, "the directory of %llu members lies at byte %llu of %zu",
                         (unsigned long long)*count, (unsigned long long)*first, whole);
  return BW_OK;
}

/* Sizes and places that take more than 32 bits stand in an extra field, those that do alone. */
static void read_wide(const unsigned char *extra, size_t length, bwi_zip_member *m) {
  uint64_t *value[3] = {&m->size, &m->packed, &m->at};
  while (length >= 4) {
    size_t id = bwi_u16(extra, false), bytes = bwi_u16(extra + 2, false);
    if (bytes > length - 4)
      return;
    const unsigned char *at = extra + 4;
    size_t left = id == 1 ? bytes : 0;
    for (int k = 0; k < 3 && left >= 8; k++)
      if (*value[k] == UINT32_MAX) {
        *value[k] = bwi_u64(at, false);
        at += 8, left -= 8;
      }
    extra += 4 + bytes, length -= 4 + bytes;
  }
}

bw_status bwi_zip_find(const bwi_cursor *archive, bool nocase, int count, bwi_zip_member *list) {
  bw_status status = BW_OK;
  bwi_cursor cursor = *archive;
  const unsigned char *at, *name, *extra, *comment;
  uint64_t entries = 0, first = 0;
  BW_TRY(find_directory(archive, &entries, &first));
  cursor.at = cursor.begin + first;
  for (uint64_t i = 0; i < entries; i++) {
    BW_TRY(bwi_take(&cursor, CENTRAL, &at, "an entry of the directory"));
    if (memcmp(at, "PK\1\2", 4) != 0)
      return bwi_fail_byte(&cursor, "entry %llu of the directory of the archive is damaged",
                           (unsigned long long)i + 1);
    bwi_word word = {NULL, bwi_u16(at + 28, false)};
    size_t extra_count = bwi_u16(at + 30, false);
    BW_TRY(bwi_take(&cursor, word.length, &name, "the name of a member"));
    BW_TRY(bwi_take(&cursor, extra_count, &extra, "an entry of the directory"));
    BW_TRY(bwi_take(&cursor, bwi_u16(at + 32, false), &comment, "a comment of the directory"));
    word.at = name;
    for (int k = 0; k < count; k++)
      if (bwi_word_is(word, list[k].name) ||
          (nocase && !list[k].found && bwi_word_is_nocase(word, list[k].name))) {
        list[k].found = true;
        list[k].method = bwi_u16(at + 10, false);
        list[k].crc = bwi_u32(at + 16, false);
        list[k].packed = bwi_u32(at + 20, false);
        list[k].size = bwi_u32(at + 24, false);
        list[k].at = bwi_u32(at + 42, false);
        read_wide(extra, extra_count, &list[k]);
      }
  }
done:
  return status;
}

static bw_status unpack(const bwi_cursor *cursor, const bwi_zip_member *m,
                        const unsigned char *from, unsigned char *to) {
  z_stream stream;
  memset(&stream, 0, sizeof stream);
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
    return bw_fail(cursor->context, BW_MEMORY, "no memory to unpack %s", m->name);
  stream.next_in = (unsigned char *)from;
  stream.avail_in = (uInt)m->packed;
  stream.next_out = to;
  stream.avail_out = (uInt)m->size;
  int result = inflate(&stream, Z_FINISH);
  bool whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole ? BW_OK : bwi_fail_byte(cursor, "%s cannot be unpacked", m->name);
}

bw_status bwi_zip_open(const bwi_cursor *archive, const bwi_zip_member *m,
                       const unsigned char **bytes, unsigned char **owned) {
  bw_status status = BW_OK;
  bwi_cursor cursor = *archive;
  const unsigned char *at;
  *owned = NULL;
  if (m->at > (size_t)(cursor.end - cursor.begin))
    return bwi_fail_byte(&cursor, "%s lies at byte %llu, behind the end", m->name,
                         (unsigned long long)m->at);
  cursor.at = cursor.begin + m->at;
  BW_TRY(bwi_take(&cursor, LOCAL, &at, "the header of a member"));
  if (memcmp(at, "PK\3\4", 4) != 0)
    return bwi_fail_byte(&cursor, "the header of %s is damaged", m->name);
  size_t skip = (size_t)bwi_u16(at + 26, false) + bwi_u16(at + 28, false);
  BW_TRY(bwi_take(&cursor, skip, &at, "the name of a member"));
  if (m->packed > UINT32_MAX || m->size > UINT32_MAX)
    return bwi_fail_byte(&cursor, "%s takes more than 4 GB", m->name);
  BW_TRY(bwi_take(&cursor, (size_t)m->packed, bytes, m->name));
  if (m->method == 0 && m->packed != m->size)
    return bwi_fail_byte(&cursor, "%s is stored in %llu bytes and has %llu", m->name,
                         (unsigned long long)m->packed, (unsigned long long)m->size);
  if (m->method == 8) {
    if (m->size / BWI_DEFLATE_RATIO > m->packed)
      return bwi_fail_byte(&cursor, "%s of %llu bytes cannot be packed into %llu", m->name,
                           (unsigned long long)m->size, (unsigned long long)m->packed);
    *owned = BW_NEW(cursor.context, unsigned char, (size_t)m->size + 1);
    if (!*owned)
      return BW_MEMORY;
    BW_TRY(unpack(&cursor, m, *bytes, *owned));
    *bytes = *owned;
  } else if (m->method != 0) {
    bwi_fail_byte(&cursor, "%s is compressed by method %u: stored or deflated ones expected",
                  m->name, m->method);
    return BW_UNSUPPORTED;
  }
  if (crc32_z(0, *bytes, (size_t)m->size) != m->crc)
    status = bwi_fail_byte(&cursor, "%s is damaged: its checksum is wrong", m->name);
done:
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static void put16(unsigned char *at, unsigned value) {
  at[0] = (unsigned char)value;
  at[1] = (unsigned char)(value >> 8);
}

static void put32(unsigned char *at, uint32_t value) {
  put16(at, value & 0xffff);
  put16(at + 2, value >> 16);
}

/* What local header and directory have in common, from the version needed to the length of extra
 * fields. */
static void describe(unsigned char *at, const bwi_zip_part *p) {
  put16(at, 20);
  put16(at + 4, p->method);
  put16(at + 8, 0x21);
  put32(at + 10, p->crc);
  put32(at + 14, p->packed);
  put32(at + 18, (uint32_t)(p->head_count + p->count));
  put16(at + 22, (unsigned)strlen(p->name));
}

/* Both blocks packed into a new one. */
static bw_status pack(bw_context *context, bwi_zip_part *p, unsigned char **packed) {
  z_stream stream;
  memset(&stream, 0, sizeof stream);
  int result = deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  if (result != Z_OK)
    return bw_fail(context, BW_MEMORY, "no memory to pack %s", p->name);
  size_t bound = deflateBound(&stream, (uLong)(p->head_count + p->count));
  *packed = bound < UINT32_MAX ? BW_NEW(context, unsigned char, bound) : NULL;
  if (*packed) {
    stream.next_out = *packed;
    stream.avail_out = (uInt)bound;
    stream.next_in = (unsigned char *)p->head;
    stream.avail_in = (uInt)p->head_count;
    if (p->head_count > 0)
      deflate(&stream, Z_NO_FLUSH);
    stream.next_in = (unsigned char *)p->bytes;
    stream.avail_in = (uInt)p->count;
    result = deflate(&stream, Z_FINISH);
    p->packed = (uint32_t)stream.total_out;
    p->method = 8;
  }
  deflateEnd(&stream);
  return *packed && result == Z_STREAM_END ? BW_OK : (bw_status)BW_MEMORY;
}

static bw_status write_part(bw_writer *writer, bwi_zip_part *p, uint64_t *offset) {
  bw_status status = BW_OK;
  unsigned char local[LOCAL] = "PK\3\4", *packed = NULL;
  p->at = (uint32_t)*offset;
  p->crc = (uint32_t)crc32_z(crc32_z(0, p->head, p->head ? p->head_count : 0), p->bytes, p->count);
  p->method = 0;
  p->packed = (uint32_t)(p->head_count + p->count);
  if (p->deflate)
    BW_TRY(pack(bwi_writer_context(writer), p, &packed));
  describe(local + 4, p);
  BW_TRY(bw_writer_bytes(writer, local, sizeof local));
  BW_TRY(bw_writer_bytes(writer, p->name, strlen(p->name)));
  if (packed) {
    BW_TRY(bw_writer_bytes(writer, packed, p->packed));
  } else {
    BW_TRY(bw_writer_bytes(writer, p->head, p->head_count));
    BW_TRY(bw_writer_bytes(writer, p->bytes, p->count));
  }
  *offset += sizeof local + strlen(p->name) + p->packed;
done:
  bw_free(packed);
  return status;
}

static bw_status write_directory(bw_writer *writer, const bwi_zip_part *list, int count,
                                 uint64_t offset) {
  bw_status status = BW_OK;
  uint32_t bytes = 0;
  for (int i = 0; i < count; i++) {
    unsigned char entry[CENTRAL] = "PK\1\2";
    put16(entry + 4, 20);
    describe(entry + 6, &list[i]);
    put32(entry + 42, list[i].at);
    BW_TRY(bw_writer_bytes(writer, entry, sizeof entry));
    BW_TRY(bw_writer_bytes(writer, list[i].name, strlen(list[i].name)));
    bytes += (uint32_t)(sizeof entry + strlen(list[i].name));
  }
  unsigned char end[END] = "PK\5\6";
  put16(end + 8, (unsigned)count);
  put16(end + 10, (unsigned)count);
  put32(end + 12, bytes);
  put32(end + 16, (uint32_t)offset);
  BW_TRY(bw_writer_bytes(writer, end, sizeof end));
done:
  return status;
}

bw_status bwi_zip_write(bw_writer *writer, bwi_zip_part *list, int count) {
  bw_status status = BW_OK;
  uint64_t all = 0, offset = 0;
  for (int i = 0; i < count; i++)
    all += LOCAL + CENTRAL + 2 * strlen(list[i].name) + list[i].head_count + list[i].count;
  if (all > UINT32_MAX - 4096)
    return bw_fail(bwi_writer_context(writer), BW_LIMIT,
                   "an archive of %llu bytes: sizes of more than 4 GB are not written",
                   (unsigned long long)all);
  for (int i = 0; i < count; i++)
    BW_TRY(write_part(writer, &list[i], &offset));
  BW_TRY(write_directory(writer, list, count, offset));
done:
  return status;
}
