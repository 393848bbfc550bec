/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* CSR matrices as SciPy stores them: a ZIP archive of the arrays data, indices, indptr, shape and
 * format. It is written without compression, and read with or without. */
#include "matrix/internal.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum {
  LOCAL = 30,
  CENTRAL = 46,
  END = 22,
  LONGEST_COMMENT = 65535,
  MEMBERS = 5,
  DEFLATE_RATIO = 1032
};

bool bwi_is_npz(const bwi_cursor *cursor) {
  return bwi_left(cursor) >= 4 &&
         (memcmp(cursor->at, "PK\3\4", 4) == 0 || memcmp(cursor->at, "PK\5\6", 4) == 0);
}

/* ---- reading --------------------------------------------------------------------------------- */

typedef struct member {
  const char *name;
  bool found;
  uint16_t method;
  uint32_t crc, packed, size, at; /* at: of its local header */
} member;

static bw_status find_members(bwi_cursor *cursor, member list[MEMBERS]) {
  bw_status status = BW_OK;
  const unsigned char *bytes = cursor->begin, *at = cursor->end;
  size_t whole = (size_t)(cursor->end - cursor->begin);
  if (whole >= END)
    for (at -= END; at > bytes && memcmp(at, "PK\5\6", 4) != 0 &&
                    (size_t)(cursor->end - at) < LONGEST_COMMENT + END;)
      at--;
  if (whole < END || memcmp(at, "PK\5\6", 4) != 0)
    return bwi_fail_byte(cursor,
                         "the directory of a ZIP archive is missing: the file is cut short");
  unsigned count = bwi_u16(at + 10, false);
  uint32_t first = bwi_u32(at + 16, false);
  if (first > whole)
    return bwi_fail_byte(cursor, "the directory of the archive lies at byte %u of %zu", first,
                         whole);
  cursor->at = bytes + first;
  for (unsigned i = 0; i < count; i++) {
    const unsigned char *name;
    BW_TRY(bwi_take(cursor, CENTRAL, &at, "an entry of the directory"));
    if (memcmp(at, "PK\1\2", 4) != 0)
      return bwi_fail_byte(cursor, "entry %u of the directory of the archive is damaged", i + 1);
    size_t length = bwi_u16(at + 28, false);
    size_t more = (size_t)bwi_u16(at + 30, false) + bwi_u16(at + 32, false);
    BW_TRY(bwi_take(cursor, length, &name, "the name of a member"));
    for (int k = 0; k < MEMBERS; k++)
      if (bwi_word_is((bwi_word){name, length}, list[k].name)) {
        list[k].found = true;
        list[k].method = bwi_u16(at + 10, false);
        list[k].crc = bwi_u32(at + 16, false);
        list[k].packed = bwi_u32(at + 20, false);
        list[k].size = bwi_u32(at + 24, false);
        list[k].at = bwi_u32(at + 42, false);
      }
    BW_TRY(bwi_take(cursor, more, &at, "a comment of the directory"));
  }
done:
  return status;
}

static bw_status unpack(const bwi_cursor *cursor, const member *m, const unsigned char *from,
                        unsigned char *to) {
  z_stream stream;
  memset(&stream, 0, sizeof stream);
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
    return bw_fail(cursor->context, BW_MEMORY, "no memory to unpack %s", m->name);
  stream.next_in = (unsigned char *)from;
  stream.avail_in = m->packed;
  stream.next_out = to;
  stream.avail_out = m->size;
  int result = inflate(&stream, Z_FINISH);
  bool whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole ? BW_OK : bwi_fail_byte(cursor, "%s cannot be unpacked", m->name);
}

/* The bytes of a member; *owned to be freed, where they had to be unpacked. */
static bw_status open_member(const bwi_cursor *archive, const member *m,
                             const unsigned char **bytes, unsigned char **owned) {
  bw_status status = BW_OK;
  bwi_cursor cursor = *archive;
  const unsigned char *at;
  *owned = NULL;
  if (!m->found) {
    cursor.at = cursor.begin;
    return bwi_fail_byte(&cursor, "the archive has no member '%s': a CSR matrix of SciPy expected",
                         m->name);
  }
  if (m->at > (size_t)(cursor.end - cursor.begin))
    return bwi_fail_byte(&cursor, "%s lies at byte %u, behind the end", m->name, m->at);
  cursor.at = cursor.begin + m->at;
  BW_TRY(bwi_take(&cursor, LOCAL, &at, "the header of a member"));
  if (memcmp(at, "PK\3\4", 4) != 0)
    return bwi_fail_byte(&cursor, "the header of %s is damaged", m->name);
  size_t skip = (size_t)bwi_u16(at + 26, false) + bwi_u16(at + 28, false);
  BW_TRY(bwi_take(&cursor, skip, &at, "the name of a member"));
  BW_TRY(bwi_take(&cursor, m->packed, bytes, m->name));
  if (m->method == 0 && m->packed != m->size)
    return bwi_fail_byte(&cursor, "%s is stored in %u bytes and has %u", m->name, m->packed,
                         m->size);
  if (m->method == 8) {
    if (m->size / DEFLATE_RATIO > m->packed)
      return bwi_fail_byte(&cursor, "%s of %u bytes cannot be packed into %u", m->name, m->size,
                           m->packed);
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
  if (crc32_z(0, *bytes, m->size) != m->crc)
    status = bwi_fail_byte(&cursor, "%s is damaged: its checksum is wrong", m->name);
done:
  return status;
}

/* A member as a cursor named after the archive and the member. */
static bw_status open_cursor(const bwi_cursor *archive, const member *m, char name[512],
                             bwi_cursor *cursor, unsigned char **owned) {
  const unsigned char *bytes = NULL;
  bw_status status = open_member(archive, m, &bytes, owned);
  snprintf(name, 512, "%.400s: %s", archive->name, m->name);
  if (status == BW_OK)
    bwi_cursor_init(cursor, archive->context, name, bytes, m->size);
  return status;
}

static bw_status read_member(const bwi_cursor *archive, const member *m, bw_array **array) {
  unsigned char *owned = NULL;
  char name[512];
  bwi_cursor cursor;
  bw_status status = open_cursor(archive, m, name, &cursor, &owned);
  if (status == BW_OK)
    status = bwi_npy_read(&cursor, array);
  if (status == BW_OK && (*array)->columns != 1 && (*array)->rows > 0)
    status = bwi_fail_byte(&cursor, "one dimension expected");
  bw_free(owned);
  return status;
}

static bw_status check_format(const bwi_cursor *archive, const member *m) {
  unsigned char *owned = NULL;
  char name[512], format[16] = "csr";
  bwi_cursor cursor;
  bw_status status = BW_OK;
  if (m->found) {
    status = open_cursor(archive, m, name, &cursor, &owned);
    if (status == BW_OK)
      status = bwi_npy_read_text(&cursor, format, sizeof format);
  }
  if (status == BW_OK && strcmp(format, "csr") != 0) {
    bwi_fail_byte(archive, "a matrix in the format '%s' of SciPy: save it as CSR (A.tocsr())",
                  bwi_show((bwi_word){(unsigned char *)format, strlen(format)}));
    status = BW_UNSUPPORTED;
  }
  bw_free(owned);
  return status;
}

static int64_t whole_at(const bw_array *array, int64_t i) {
  return array->type == BW_I64   ? ((const int64_t *)array->data)[i]
         : array->type == BW_I32 ? ((const int32_t *)array->data)[i]
                                 : ((const uint8_t *)array->data)[i];
}

/* The matrix from its arrays: what SciPy would not accept is refused. */
static bw_status build(const bwi_cursor *archive, const bw_array *shape, const bw_array *indptr,
                       const bw_array *indices, const bw_array *data, bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  bw_context *context = archive->context;
  int64_t *start = NULL;
  int32_t *column = NULL;
  double *value = NULL;
  if (shape->type == BW_F64 || indptr->type == BW_F64 || indices->type == BW_F64)
    return bwi_fail_byte(archive, "shape, indptr and indices must be integers");
  if (shape->rows != 2)
    return bwi_fail_byte(archive, "the shape has %lld numbers: two expected",
                         (long long)shape->rows);
  int64_t rows = whole_at(shape, 0), columns = whole_at(shape, 1), count = data->rows;
  BW_TRY(bwi_check_size(archive, rows, "rows"));
  BW_TRY(bwi_check_size(archive, columns, "columns"));
  if (indptr->rows != rows + 1 || indices->rows != count)
    return bwi_fail_byte(archive, "%lld starts of %lld rows, %lld columns of %lld entries",
                         (long long)indptr->rows, (long long)rows, (long long)indices->rows,
                         (long long)count);
  start = BW_NEW(context, int64_t, rows + 1);
  column = BW_NEW(context, int32_t, count + 1);
  value = BW_NEW(context, double, count + 1);
  BW_TRY_MEMORY(start && column && value);
  for (int64_t i = 0; i <= rows; i++) {
    start[i] = whole_at(indptr, i);
    if (start[i] < (i > 0 ? start[i - 1] : 0) || start[i] > count || (i == 0 && start[0] != 0))
      BW_TRY(bwi_fail_byte(archive, "row %lld starts at entry %lld of %lld", (long long)i + 1,
                           (long long)start[i], (long long)count));
  }
  for (int64_t k = 0; k < count; k++) {
    int64_t j = whole_at(indices, k);
    if (j < 0 || j >= columns)
      BW_TRY(bwi_fail_byte(archive, "entry %lld lies in column %lld of %lld", (long long)k + 1,
                           (long long)j, (long long)columns));
    column[k] = (int32_t)j;
    value[k] = bw_array_get(data, k, 0);
  }
  status = bw_sparse_matrix_adopt(context, (int32_t)rows, (int32_t)columns, start, column, value,
                                  matrix);
  if (status == BW_INVALID) /* a column twice in a row */
    status = bwi_fail_byte(archive, "the matrix has two entries at one place");
  if (status == BW_OK) {
    start = NULL;
    column = NULL;
    value = NULL;
  }
done:
  bw_free(start);
  bw_free(column);
  bw_free(value);
  return status;
}

bw_status bwi_npz_read_matrix(bwi_cursor *cursor, bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  member list[MEMBERS] = {{.name = "shape.npy"},
                          {.name = "indptr.npy"},
                          {.name = "indices.npy"},
                          {.name = "data.npy"},
                          {.name = "format.npy"}};
  bw_array *array[4] = {NULL, NULL, NULL, NULL};
  BW_TRY(find_members(cursor, list));
  BW_TRY(check_format(cursor, &list[4]));
  for (int k = 0; k < 4; k++)
    BW_TRY(read_member(cursor, &list[k], &array[k]));
  BW_TRY(build(cursor, array[0], array[1], array[2], array[3], matrix));
done:
  for (int k = 0; k < 4; k++)
    bw_release(array[k]);
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* What a member is written from: a header and a block. */
typedef struct part {
  const char *name, *type;
  char shape[64];
  const void *bytes;
  size_t count;
  uint32_t crc, at;
} part;

static void put16(unsigned char *at, unsigned value) {
  at[0] = (unsigned char)value;
  at[1] = (unsigned char)(value >> 8);
}

static void put32(unsigned char *at, uint32_t value) {
  put16(at, value & 0xffff);
  put16(at + 2, value >> 16);
}

/* What local header and directory have in common, from the version needed to the length of extra
 * fields; the date is the first of 1980: the same matrix gives the same bytes. */
static void describe(unsigned char *at, const part *p) {
  uint32_t size = (uint32_t)(p->count + BWI_NPY_HEAD);
  put16(at, 20);
  put16(at + 8, 0x21);
  put32(at + 10, p->crc);
  put32(at + 14, size);
  put32(at + 18, size);
  put16(at + 22, (unsigned)strlen(p->name));
}

static bw_status write_part(bw_writer *writer, part *p, uint32_t *offset) {
  bw_status status = BW_OK;
  unsigned char local[LOCAL] = "PK\3\4";
  char head[BWI_NPY_HEAD];
  bwi_npy_head(head, p->type, p->shape);
  p->at = *offset;
  p->crc =
      (uint32_t)crc32_z(crc32_z(0, (const unsigned char *)head, sizeof head), p->bytes, p->count);
  describe(local + 4, p);
  BW_TRY(bw_writer_bytes(writer, local, sizeof local));
  BW_TRY(bw_writer_bytes(writer, p->name, strlen(p->name)));
  BW_TRY(bw_writer_bytes(writer, head, sizeof head));
  BW_TRY(bw_writer_bytes(writer, p->bytes, p->count));
  *offset += (uint32_t)(sizeof local + strlen(p->name) + sizeof head + p->count);
done:
  return status;
}

static bw_status write_directory(bw_writer *writer, const part *list, int count, uint32_t offset) {
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
  put32(end + 16, offset);
  BW_TRY(bw_writer_bytes(writer, end, sizeof end));
done:
  return status;
}

bw_status bwi_npz_write_matrix(bw_context *context, bw_writer *writer,
                               const bw_sparse_matrix *matrix) {
  bw_status status = BW_OK;
  size_t rows = (size_t)matrix->rows, count = (size_t)matrix->start[rows];
  int64_t shape[2] = {matrix->rows, matrix->columns};
  if (4 * rows + 12 * count > UINT32_MAX - 4096)
    return bw_fail(context, BW_LIMIT,
                   "a matrix of %zu entries takes more than 4 GB, which an archive without 64-bit "
                   "sizes cannot hold: write it as .mtx",
                   count);
  int32_t *start = BW_NEW(context, int32_t, rows + 1); /* as many bits as SciPy gives indices */
  if (!start)
    return BW_MEMORY;
  for (size_t i = 0; i <= rows; i++)
    start[i] = (int32_t)matrix->start[i];
  part list[MEMBERS] = {
      {.name = "indices.npy", .type = "<i4", .bytes = matrix->column, .count = 4 * count},
      {.name = "indptr.npy", .type = "<i4", .bytes = start, .count = 4 * (rows + 1)},
      {.name = "format.npy", .type = "|S3", .bytes = "csr", .count = 3},
      {.name = "shape.npy", .type = "<i8", .bytes = shape, .count = sizeof shape},
      {.name = "data.npy", .type = "<f8", .bytes = matrix->value, .count = 8 * count}};
  snprintf(list[0].shape, sizeof list[0].shape, "(%zu,)", count);
  snprintf(list[1].shape, sizeof list[1].shape, "(%zu,)", rows + 1);
  snprintf(list[2].shape, sizeof list[2].shape, "()");
  snprintf(list[3].shape, sizeof list[3].shape, "(2,)");
  snprintf(list[4].shape, sizeof list[4].shape, "(%zu,)", count);
  uint32_t offset = 0;
  for (int i = 0; i < MEMBERS; i++)
    BW_TRY(write_part(writer, &list[i], &offset));
  BW_TRY(write_directory(writer, list, MEMBERS, offset));
done:
  bw_free(start);
  return status;
}
