/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Arrays as NumPy stores them: a magic number, a version, the length of a header, the header (a
 * dictionary of Python with 'descr', 'fortran_order' and 'shape'), the numbers. */
#include "matrix/internal.h"

#include <stdio.h>
#include <string.h>

enum { MAGIC = 6, MAX_HEADER = 65536 };
static const char magic[MAGIC + 1] = "\x93NUMPY";

typedef struct header {
  char kind; /* of NumPy: f, i, u, b, S */
  int size;  /* bytes of a number */
  bool swap, fortran;
  int dimensions;
  int64_t shape[2]; /* 1 where there are fewer dimensions */
} header;

bool bwi_is_npy(const bwi_cursor *cursor) {
  return bwi_left(cursor) >= MAGIC && memcmp(cursor->at, magic, MAGIC) == 0;
}

/* ---- the header ------------------------------------------------------------------------------ */

static bool take_mark(bwi_cursor *h, char mark) {
  if (!bwi_skip_space(h) || *h->at != (unsigned char)mark)
    return false;
  h->at++;
  return true;
}

/* A text in quotes; false for anything else. */
static bool take_text(bwi_cursor *h, bwi_word *text) {
  if (!bwi_skip_space(h) || (*h->at != '\'' && *h->at != '"'))
    return false;
  unsigned char quote = *h->at++;
  *text = (bwi_word){h->at, 0};
  while (h->at < h->end && *h->at != quote)
    h->at++;
  if (h->at == h->end)
    return false;
  text->length = (size_t)(h->at++ - text->at);
  return true;
}

static bw_status read_type(bwi_cursor *h, header *head) {
  bwi_word text;
  if (!take_text(h, &text))
    return bwi_fail_byte(h, "'descr' of the header: the type of one number expected, in quotes");
  const unsigned char *at = text.at, *end = text.at + text.length, *after;
  int64_t size = 0;
  bool big = at < end && *at == '>';
  if (at < end && strchr("<>|=", *at))
    at++;
  head->kind = at < end ? (char)*at++ : 0;
  if (!bwi_parse_integer(at, end, &size, &after) || after != end || size < 0 || size > 1024)
    size = 0;
  head->size = (int)size;
  head->swap = big; /* the engine runs on machines of little-endian order */
  bool known = (head->kind == 'f' && (size == 4 || size == 8)) ||
               (head->kind == 'i' && (size == 1 || size == 2 || size == 4 || size == 8)) ||
               (head->kind == 'u' && (size == 1 || size == 2 || size == 4)) ||
               (head->kind == 'b' && size == 1) || (head->kind == 'S' && size > 0);
  if (!known) {
    bwi_fail_byte(h, "numbers of type '%s': real numbers of 4 or 8 bytes or integers expected",
                  bwi_show(text));
    return BW_UNSUPPORTED;
  }
  return BW_OK;
}

static bw_status read_shape(bwi_cursor *h, header *head) {
  if (!take_mark(h, '('))
    return bwi_fail_byte(h, "'shape' of the header: a tuple expected");
  while (!take_mark(h, ')')) {
    const unsigned char *after;
    int64_t size;
    if (h->at == h->end || !bwi_parse_integer(h->at, h->end, &size, &after) || size < 0)
      return bwi_fail_byte(h, "'shape' of the header: sizes of 0 or more expected");
    h->at = after;
    take_mark(h, ',');
    if (head->dimensions == 2) {
      bwi_fail_byte(h, "an array of more than two dimensions");
      return BW_UNSUPPORTED;
    }
    head->shape[head->dimensions++] = size;
  }
  return BW_OK;
}

static bw_status read_pair(bwi_cursor *h, header *head, unsigned *seen) {
  bwi_word key, word;
  if (!take_text(h, &key) || !take_mark(h, ':'))
    return bwi_fail_byte(h, "the header: a key in quotes and a colon expected");
  if (bwi_word_is(key, "descr")) {
    *seen |= 1;
    return read_type(h, head);
  }
  if (bwi_word_is(key, "shape")) {
    *seen |= 2;
    return read_shape(h, head);
  }
  if (!bwi_word_is(key, "fortran_order"))
    return bwi_fail_byte(h, "the header: the key '%s' is not known", bwi_show(key));
  *seen |= 4;
  bwi_skip_space(h);
  word = (bwi_word){h->at, bwi_left(h) < 4 ? 0 : *h->at == 'T' ? 4 : bwi_left(h) < 5 ? 0 : 5};
  head->fortran = bwi_word_is(word, "True");
  if (!head->fortran && !bwi_word_is(word, "False"))
    return bwi_fail_byte(h, "'fortran_order' of the header: True or False expected");
  h->at += word.length;
  return BW_OK;
}

static bw_status read_header(bwi_cursor *cursor, header *head) {
  bw_status status = BW_OK;
  const unsigned char *at;
  *head = (header){.shape = {1, 1}};
  BW_TRY(bwi_take(cursor, MAGIC + 2, &at, "the magic number"));
  if (memcmp(at, magic, MAGIC) != 0)
    return bwi_fail_byte(cursor, "an array of NumPy expected");
  int version = at[MAGIC];
  if (version < 1 || version > 3) {
    bwi_fail_byte(cursor, "version %d of the format: 1 to 3 expected", version);
    return BW_UNSUPPORTED;
  }
  BW_TRY(bwi_take(cursor, version == 1 ? 2 : 4, &at, "the length of the header"));
  uint32_t length =
      version == 1 ? at[0] | (uint32_t)at[1] << 8
                   : at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
  if (length > MAX_HEADER)
    return bwi_fail_byte(cursor, "a header of %u bytes: %d at most expected", length, MAX_HEADER);
  bwi_cursor h = *cursor;
  BW_TRY(bwi_take(cursor, length, &at, "the header"));
  h.end = cursor->at;
  unsigned seen = 0;
  if (!take_mark(&h, '{'))
    return bwi_fail_byte(&h, "the header: '{' expected");
  while (!take_mark(&h, '}')) {
    BW_TRY(read_pair(&h, head, &seen));
    take_mark(&h, ',');
  }
  if (seen != 7)
    return bwi_fail_byte(&h, "the header: 'descr', 'fortran_order' and 'shape' expected");
done:
  return status;
}

/* ---- the numbers ----------------------------------------------------------------------------- */

static int64_t integer_at(const header *head, const unsigned char *at) {
  switch (head->size) {
  case 1:
    return head->kind == 'i' ? (int8_t)*at : *at;
  case 2:
    return head->kind == 'i' ? (int16_t)bwi_u16(at, head->swap) : bwi_u16(at, head->swap);
  case 4:
    return head->kind == 'i' ? (int32_t)bwi_u32(at, head->swap) : (int64_t)bwi_u32(at, head->swap);
  default:
    return (int64_t)bwi_u64(at, head->swap);
  }
}

static bw_type type_of(const header *head) {
  if (head->kind == 'f')
    return BW_F64;
  if (head->size == 8 || (head->size == 4 && head->kind == 'u'))
    return BW_I64;
  return head->size == 1 && head->kind != 'i' ? BW_U8 : BW_I32;
}

static void put(const header *head, const unsigned char *at, bw_type type, void *data, int64_t k) {
  switch (type) {
  case BW_F64:
    ((double *)data)[k] =
        head->size == 8 ? bwi_f64(at, head->swap) : (double)bwi_f32(at, head->swap);
    break;
  case BW_I64:
    ((int64_t *)data)[k] = integer_at(head, at);
    break;
  case BW_I32:
    ((int32_t *)data)[k] = (int32_t)integer_at(head, at);
    break;
  case BW_U8:
    ((uint8_t *)data)[k] = *at;
    break;
  }
}

bw_status bwi_npy_read(bwi_cursor *cursor, bw_array **array) {
  bw_status status = BW_OK;
  header head;
  const unsigned char *at;
  int64_t count;
  BW_TRY(read_header(cursor, &head));
  int64_t rows = head.shape[0], columns = head.shape[1];
  if (head.kind == 'S') {
    bwi_fail_byte(cursor, "an array of texts: numbers expected");
    return BW_UNSUPPORTED;
  }
  if (__builtin_mul_overflow(rows, columns, &count) ||
      (uint64_t)count > bwi_left(cursor) / (size_t)head.size)
    return bwi_fail_byte(cursor,
                         "an array of %lld x %lld numbers of %d bytes, but only %zu bytes follow: "
                         "the file is cut short or the shape wrong",
                         (long long)rows, (long long)columns, head.size, bwi_left(cursor));
  BW_TRY(bwi_take(cursor, (size_t)count * (size_t)head.size, &at, "the array"));
  if (bwi_left(cursor) > 0)
    return bwi_fail_byte(cursor, "%zu bytes behind the array", bwi_left(cursor));
  bw_type type = type_of(&head);
  BW_TRY(bw_array_create(cursor->context, type, rows, columns, array));
  for (int64_t k = 0; k < count; k++) {
    int64_t to = head.fortran ? k % rows * columns + k / rows : k;
    put(&head, at + k * head.size, type, (*array)->data, to);
  }
done:
  return status;
}

bw_status bwi_npy_read_text(bwi_cursor *cursor, char *text, size_t size) {
  bw_status status = BW_OK;
  header head;
  const unsigned char *at;
  BW_TRY(read_header(cursor, &head));
  if (head.kind != 'S' || head.dimensions != 0)
    return bwi_fail_byte(cursor, "one text of bytes expected");
  BW_TRY(bwi_take(cursor, (size_t)head.size, &at, "the text"));
  snprintf(text, size, "%.*s", head.size, (const char *)at);
done:
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

void bwi_npy_head(char head[BWI_NPY_HEAD], const char *type, const char *shape) {
  memset(head, ' ', BWI_NPY_HEAD);
  memcpy(head, magic, MAGIC);
  head[MAGIC] = 1;
  head[MAGIC + 1] = 0;
  head[MAGIC + 2] = (char)(BWI_NPY_HEAD - MAGIC - 4);
  head[MAGIC + 3] = 0;
  int length = snprintf(head + MAGIC + 4, BWI_NPY_HEAD - MAGIC - 4,
                        "{'descr': '%s', 'fortran_order': False, 'shape': %s, }", type, shape);
  head[MAGIC + 4 + length] = ' ';
  head[BWI_NPY_HEAD - 1] = '\n';
}

bw_status bwi_npy_write(bw_writer *writer, const bw_array *array) {
  static const char *const word[] = {
      [BW_F64] = "<f8", [BW_I32] = "<i4", [BW_I64] = "<i8", [BW_U8] = "|u1"};
  bw_status status = BW_OK;
  size_t size = bw_type_size(array->type);
  char head[BWI_NPY_HEAD], shape[64];
  if (array->columns == 1)
    snprintf(shape, sizeof shape, "(%lld,)", (long long)array->rows);
  else
    snprintf(shape, sizeof shape, "(%lld, %lld)", (long long)array->rows,
             (long long)array->columns);
  bwi_npy_head(head, word[array->type], shape);
  BW_TRY(bw_writer_bytes(writer, head, sizeof head));
  for (int64_t i = 0; i < array->rows; i++) {
    const char *row = (const char *)array->data + i * array->row_stride;
    if (array->column_stride == (ptrdiff_t)size) {
      BW_TRY(bw_writer_bytes(writer, row, size * (size_t)array->columns));
      continue;
    }
    for (int64_t j = 0; j < array->columns; j++)
      BW_TRY(bw_writer_bytes(writer, row + j * array->column_stride, size));
  }
done:
  return status;
}
