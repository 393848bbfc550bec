/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* CSR matrices as SciPy stores them: a ZIP archive of the arrays data, indices, indptr, shape and
 * format. It is written without compression, and read with or without. */
#include "matrix/internal.h"

#include <stdio.h>
#include <string.h>

#include "io/zip.h"

enum { MEMBERS = 5 };

bool bwi_is_npz(const bwi_cursor *cursor) {
  return bwi_is_zip(cursor);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* A member as a cursor named after the archive and the member. */
static bw_status open_cursor(const bwi_cursor *archive, const bwi_zip_member *m, char name[512],
                             bwi_cursor *cursor, unsigned char **owned) {
  const unsigned char *bytes = NULL;
  bw_status status = BW_FORMAT;
  *owned = NULL;
  if (m->found) {
    status = bwi_zip_open(archive, m, &bytes, owned);
  } else {
    bwi_cursor whole = *archive;
    whole.at = whole.begin;
    bwi_fail_byte(&whole, "the archive has no member '%s': a CSR matrix of SciPy expected",
                  m->name);
  }
  snprintf(name, 512, "%.400s: %s", archive->name, m->name);
  if (status == BW_OK)
    bwi_cursor_init(cursor, archive->context, name, bytes, (size_t)m->size);
  return status;
}

static bw_status read_member(const bwi_cursor *archive, const bwi_zip_member *m, bw_array **array) {
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

static bw_status check_format(const bwi_cursor *archive, const bwi_zip_member *m) {
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
  bwi_zip_member list[MEMBERS] = {{.name = "shape.npy"},
                                  {.name = "indptr.npy"},
                                  {.name = "indices.npy"},
                                  {.name = "data.npy"},
                                  {.name = "format.npy"}};
  bw_array *array[4] = {NULL, NULL, NULL, NULL};
  BW_TRY(bwi_zip_find(cursor, false, MEMBERS, list));
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
  bwi_zip_part list[MEMBERS] = {
      {.name = "indices.npy", .bytes = matrix->column, .count = 4 * count},
      {.name = "indptr.npy", .bytes = start, .count = 4 * (rows + 1)},
      {.name = "format.npy", .bytes = "csr", .count = 3},
      {.name = "shape.npy", .bytes = shape, .count = sizeof shape},
      {.name = "data.npy", .bytes = matrix->value, .count = 8 * count}};
  static const char *const type[MEMBERS] = {"<i4", "<i4", "|S3", "<i8", "<f8"};
  const size_t length[MEMBERS] = {count, rows + 1, 0, 2, count};
  char head[MEMBERS][BWI_NPY_HEAD];
  for (int i = 0; i < MEMBERS; i++) {
    char text[64] = "()";
    if (i != 2)
      snprintf(text, sizeof text, "(%zu,)", length[i]);
    bwi_npy_head(head[i], type[i], text);
    list[i].head = head[i];
    list[i].head_count = BWI_NPY_HEAD;
  }
  status = bwi_zip_write(writer, list, MEMBERS);
  bw_free(start);
  return status;
}
