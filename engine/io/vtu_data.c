/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The numbers of one VTU array: as text, or as bytes that stand in the tag in base64 or behind all
 * tags, raw or in base64; and in each case as they are behind their length, or in blocks compressed
 * by zlib. How many there must be is known beforehand: the header of the data has to say the same,
 * and zlib cannot make more than 1032 bytes of one, so nothing is allocated on the word of a header
 * alone. */
#include "io/vtu.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum { ZLIB_GAIN = 1032, ZLIB_GRACE = 1024 };

static size_t size_of(bwi_vtk_type type) {
  static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return size[type];
}

/* ---- a stream of bytes --------------------------------------------------------------------- */

typedef struct stream {
  bwi_cursor cursor;
  bool base64;
  unsigned char rest[3]; /* decoded but not taken */
  int rest_count;
} stream;

static int base64_digit(unsigned char c) {
  if (c >= 'A' && c <= 'Z')
    return c - 'A';
  if (c >= 'a' && c <= 'z')
    return c - 'a' + 26;
  if (c >= '0' && c <= '9')
    return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Four digits to up to three bytes. Padding ends a quantum, not the stream: the header and the data
 * of an array are encoded apart. */
static bw_status next_quantum(stream *s) {
  int digit[4], have = 0, padding = 0;
  while (have < 4) {
    if (!bwi_skip_space(&s->cursor))
      return bwi_fail_byte(&s->cursor, "the file ends inside base64 data");
    unsigned char c = *s->cursor.at;
    if (c == '=' && have >= 2) {
      padding++;
      digit[have++] = 0;
    } else {
      digit[have] = base64_digit(c);
      if (digit[have] < 0 || padding)
        return bwi_fail_line(&s->cursor, "found '%s' inside base64 data, which are too short",
                             bwi_show((bwi_word){s->cursor.at, 1}));
      have++;
    }
    s->cursor.at++;
  }
  uint32_t bits = (uint32_t)(digit[0] << 18 | digit[1] << 12 | digit[2] << 6 | digit[3]);
  s->rest_count = 3 - padding;
  for (int k = 0; k < 3; k++)
    s->rest[k] = (unsigned char)(bits >> (16 - 8 * k));
  return BW_OK;
}

static size_t bytes_left(const stream *s) {
  return s->base64 ? bwi_left(&s->cursor) / 4 * 3 + 3 : bwi_left(&s->cursor);
}

static bw_status take(stream *s, unsigned char *to, size_t count) {
  if (!s->base64) {
    const unsigned char *bytes;
    bw_status status = bwi_take(&s->cursor, count, &bytes, "an array");
    if (status == BW_OK && count > 0)
      memcpy(to, bytes, count);
    return status;
  }
  while (count > 0) {
    if (s->rest_count == 0) {
      bw_status status = next_quantum(s);
      if (status != BW_OK)
        return status;
      continue;
    }
    *to++ = s->rest[0];
    memmove(s->rest, s->rest + 1, 2);
    s->rest_count--;
    count--;
  }
  return BW_OK;
}

static bw_status take_word(stream *s, bool wide, uint64_t *value) {
  unsigned char bytes[8];
  bw_status status = take(s, bytes, wide ? 8 : 4);
  *value = status != BW_OK ? 0
           : wide          ? bwi_u64(bytes, s->cursor.swap)
                           : bwi_u32(bytes, s->cursor.swap);
  return status;
}

/* ---- binary arrays ------------------------------------------------------------------------- */

static bw_status fail_size(const stream *s, const bwi_vtu_array *array, uint64_t found,
                           uint64_t expected) {
  return bwi_fail_byte(&s->cursor,
                       "the array '%s' (line %lld) holds %llu bytes of numbers where %llu were "
                       "expected",
                       bwi_show(array->name), (long long)array->line, (unsigned long long)found,
                       (unsigned long long)expected);
}

static bw_status inflate_block(stream *s, bw_context *context, unsigned char *to, uint64_t bytes,
                               uint64_t packed, const bwi_vtu_array *array) {
  bw_status status = BW_OK;
  unsigned char *own = NULL;
  const unsigned char *source = NULL;
  if (packed > bytes_left(s) || bytes > packed * ZLIB_GAIN + ZLIB_GRACE)
    return bwi_fail_byte(&s->cursor,
                         "a block of the array '%s' (line %lld) claims %llu bytes made of %llu "
                         "compressed ones, with %zu left in the file",
                         bwi_show(array->name), (long long)array->line, (unsigned long long)bytes,
                         (unsigned long long)packed, bytes_left(s));
  if (s->base64) {
    own = BW_NEW(context, unsigned char, packed);
    if (!own)
      return BW_MEMORY;
    BW_TRY(take(s, own, packed));
    source = own;
  } else {
    BW_TRY(bwi_take(&s->cursor, packed, &source, "a compressed block"));
  }
  uLongf made = (uLongf)bytes;
  int code = uncompress(to, &made, source, (uLong)packed);
  if (code == Z_MEM_ERROR)
    status = bw_fail(context, BW_MEMORY, "out of memory while unpacking");
  else if (code != Z_OK || made != bytes)
    status = bwi_fail_byte(&s->cursor,
                           "a compressed block of the array '%s' (line %lld) is damaged: zlib says "
                           "%d, %llu of %llu bytes",
                           bwi_show(array->name), (long long)array->line, code,
                           (unsigned long long)made, (unsigned long long)bytes);
done:
  bw_free(own);
  return status;
}

static bw_status take_compressed(stream *s, bw_context *context, const bwi_vtu_file *file,
                                 const bwi_vtu_array *array, uint64_t expected,
                                 unsigned char **out) {
  bw_status status = BW_OK;
  uint64_t blocks, block, last, *packed = NULL, all = 0, total = 0;
  unsigned char *bytes = NULL;
  BW_TRY(take_word(s, file->wide, &blocks));
  BW_TRY(take_word(s, file->wide, &block));
  BW_TRY(take_word(s, file->wide, &last));
  size_t word = file->wide ? 8 : 4;
  if (blocks > bytes_left(s) / word)
    BW_TRY(bwi_fail_byte(&s->cursor,
                         "the array '%s' (line %lld) claims %llu compressed blocks, but only %zu "
                         "bytes are left",
                         bwi_show(array->name), (long long)array->line, (unsigned long long)blocks,
                         bytes_left(s)));
  if (blocks > 0 && (__builtin_mul_overflow(blocks - 1, block, &total) ||
                     __builtin_add_overflow(total, last ? last : block, &total)))
    total = UINT64_MAX;
  if (total != expected)
    BW_TRY(fail_size(s, array, total, expected));
  packed = BW_NEW(context, uint64_t, blocks);
  BW_TRY_MEMORY(packed);
  for (uint64_t i = 0; i < blocks; i++) {
    BW_TRY(take_word(s, file->wide, &packed[i]));
    if (packed[i] > bytes_left(s))
      packed[i] = bytes_left(s) + 1; /* refused below, without overflow here */
    all += packed[i];
  }
  if (all > bytes_left(s) || expected / ZLIB_GAIN > all + ZLIB_GRACE)
    BW_TRY(bwi_fail_byte(&s->cursor,
                         "the array '%s' (line %lld) claims %llu bytes made of %llu compressed "
                         "ones, with %zu left in the file",
                         bwi_show(array->name), (long long)array->line,
                         (unsigned long long)expected, (unsigned long long)all, bytes_left(s)));
  bytes = BW_NEW(context, unsigned char, expected);
  BW_TRY_MEMORY(bytes);
  for (uint64_t i = 0; i < blocks; i++) {
    BW_TRY(bw_check_cancel(context));
    uint64_t size = i + 1 == blocks && last ? last : block;
    BW_TRY(inflate_block(s, context, bytes + i * block, size, packed[i], array));
  }
  *out = bytes;
  bytes = NULL;
done:
  bw_free(packed);
  bw_free(bytes);
  return status;
}

static bw_status take_plain(stream *s, bw_context *context, const bwi_vtu_file *file,
                            const bwi_vtu_array *array, uint64_t expected, unsigned char **out) {
  uint64_t count;
  bw_status status = take_word(s, file->wide, &count);
  if (status != BW_OK)
    return status;
  if (count != expected)
    return fail_size(s, array, count, expected);
  if (count > bytes_left(s))
    return bwi_fail_byte(
        &s->cursor, "the array '%s' (line %lld) takes %llu bytes, but only %zu are left",
        bwi_show(array->name), (long long)array->line, (unsigned long long)count, bytes_left(s));
  unsigned char *bytes = BW_NEW(context, unsigned char, count);
  if (!bytes)
    return BW_MEMORY;
  status = take(s, bytes, count);
  if (status != BW_OK)
    bw_free(bytes);
  else
    *out = bytes;
  return status;
}

static bw_status open_stream(const bwi_cursor *cursor, const bwi_vtu_file *file,
                             const bwi_vtu_array *array, stream *s) {
  *s = (stream){*cursor, false, {0}, 0};
  s->cursor.line = array->line;
  if (array->form == BWI_VTU_INLINE) {
    s->cursor.at = array->text;
    s->base64 = true;
    return BW_OK;
  }
  if (!file->appended || array->offset > (uint64_t)(cursor->end - file->appended))
    return bwi_fail_line(&s->cursor,
                         "the array '%s' lies at the offset %llu of the appended data, beyond "
                         "the end of the file",
                         bwi_show(array->name), (unsigned long long)array->offset);
  s->cursor.at = file->appended + array->offset;
  s->base64 = file->base64;
  return BW_OK;
}

/* The bytes of a binary array, still in the file's byte order. */
static bw_status array_bytes(const bwi_cursor *cursor, const bwi_vtu_file *file,
                             const bwi_vtu_array *array, uint64_t count, unsigned char **bytes) {
  stream s;
  bw_status status = open_stream(cursor, file, array, &s);
  if (status != BW_OK)
    return status;
  uint64_t expected;
  if (__builtin_mul_overflow(count, size_of(array->type), &expected))
    return fail_size(&s, array, bytes_left(&s), UINT64_MAX);
  return file->compressed ? take_compressed(&s, cursor->context, file, array, expected, bytes)
                          : take_plain(&s, cursor->context, file, array, expected, bytes);
}

/* ---- numbers ------------------------------------------------------------------------------- */

static bw_status fail_not_finite(const bwi_cursor *cursor, const bwi_vtu_array *array, uint64_t i,
                                 double value) {
  bwi_cursor place = *cursor;
  place.line = array->line;
  return bwi_fail_line(&place, "number %llu of the array '%s' is %g: a finite one was expected",
                       (unsigned long long)i + 1, bwi_show(array->name), value);
}

static bw_status text_cursor(const bwi_cursor *cursor, const bwi_vtu_array *array, uint64_t count,
                             bwi_cursor *text) {
  *text = *cursor;
  text->at = array->text;
  text->line = array->line;
  const unsigned char *stop = memchr(text->at, '<', bwi_left(text));
  if (stop)
    text->end = stop;
  char what[80];
  snprintf(what, sizeof what, "the number of values of '%s'", bwi_show(array->name));
  return bwi_check_count(text, count, 2, what);
}

static bw_status expect_end(bwi_cursor *text, const bwi_vtu_array *array, uint64_t count) {
  if (!bwi_skip_space(text))
    return BW_OK;
  return bwi_fail_line(text, "the array '%s' goes on behind the %llu numbers that were expected",
                       bwi_show(array->name), (unsigned long long)count);
}

bw_status bwi_vtu_reals(const bwi_cursor *cursor, const bwi_vtu_file *file,
                        const bwi_vtu_array *array, uint64_t count, bool finite, double **values) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  double *made = NULL;
  bwi_cursor text;
  if (array->form == BWI_VTU_ASCII)
    BW_TRY(text_cursor(cursor, array, count, &text));
  else
    BW_TRY(array_bytes(cursor, file, array, count, &bytes));
  made = BW_NEW(cursor->context, double, count);
  BW_TRY_MEMORY(made);
  for (uint64_t i = 0; i < count; i++) {
    if (array->form == BWI_VTU_ASCII)
      BW_TRY(finite ? bwi_read_real(&text, &made[i], "a number")
                    : bwi_read_any_real(&text, &made[i], "a number"));
    else if (array->type == BWI_VTK_F32)
      made[i] = (double)bwi_f32(bytes + 4 * i, cursor->swap);
    else
      made[i] = bwi_f64(bytes + 8 * i, cursor->swap);
    if (finite && !isfinite(made[i]))
      BW_TRY(fail_not_finite(cursor, array, i, made[i]));
  }
  if (array->form == BWI_VTU_ASCII)
    BW_TRY(expect_end(&text, array, count));
  *values = made;
  made = NULL;
done:
  bw_free(bytes);
  bw_free(made);
  return status;
}

static int64_t integer_at(const unsigned char *bytes, bwi_vtk_type type, uint64_t i, bool swap) {
  switch (type) {
  case BWI_VTK_I8:
    return (int8_t)bytes[i];
  case BWI_VTK_U8:
    return bytes[i];
  case BWI_VTK_I16:
    return (int16_t)bwi_u16(bytes + 2 * i, swap);
  case BWI_VTK_U16:
    return bwi_u16(bytes + 2 * i, swap);
  case BWI_VTK_I32:
    return (int32_t)bwi_u32(bytes + 4 * i, swap);
  case BWI_VTK_U32:
    return bwi_u32(bytes + 4 * i, swap);
  default:
    return (int64_t)bwi_u64(bytes + 8 * i, swap);
  }
}

bw_status bwi_vtu_integers(const bwi_cursor *cursor, const bwi_vtu_file *file,
                           const bwi_vtu_array *array, uint64_t count, int64_t **values) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  int64_t *made = NULL;
  bwi_cursor text;
  if (bwi_vtk_is_real(array->type) || array->type == BWI_VTK_NONE) {
    text = *cursor;
    text.line = array->line;
    BW_TRY(bwi_fail_line(&text, "the array '%s' must have an integer type", bwi_show(array->name)));
  }
  if (array->form == BWI_VTU_ASCII)
    BW_TRY(text_cursor(cursor, array, count, &text));
  else
    BW_TRY(array_bytes(cursor, file, array, count, &bytes));
  made = BW_NEW(cursor->context, int64_t, count);
  BW_TRY_MEMORY(made);
  for (uint64_t i = 0; i < count; i++)
    if (array->form == BWI_VTU_ASCII)
      BW_TRY(bwi_read_integer(&text, &made[i], "an integer"));
    else
      made[i] = integer_at(bytes, array->type, i, cursor->swap);
  if (array->form == BWI_VTU_ASCII)
    BW_TRY(expect_end(&text, array, count));
  *values = made;
  made = NULL;
done:
  bw_free(bytes);
  bw_free(made);
  return status;
}

bw_status bwi_vtu_count(const bwi_cursor *cursor, const bwi_vtu_file *file,
                        const bwi_vtu_array *array, uint64_t *count) {
  bw_status status = BW_OK;
  uint64_t block, last, total;
  stream s;
  *count = 0;
  if (array->form == BWI_VTU_ASCII) {
    bwi_cursor text;
    int64_t value;
    BW_TRY(text_cursor(cursor, array, 0, &text));
    for (; bwi_skip_space(&text); (*count)++)
      BW_TRY(bwi_read_integer(&text, &value, "an integer"));
    return BW_OK;
  }
  BW_TRY(open_stream(cursor, file, array, &s));
  BW_TRY(take_word(&s, file->wide, &total)); /* bytes, or blocks */
  if (file->compressed) {
    BW_TRY(take_word(&s, file->wide, &block));
    BW_TRY(take_word(&s, file->wide, &last));
    if (total > 0 && (__builtin_mul_overflow(total - 1, block, &total) ||
                      __builtin_add_overflow(total, last ? last : block, &total)))
      total = UINT64_MAX; /* refused when the array is read */
  }
  *count = total / size_of(array->type);
done:
  return status;
}
