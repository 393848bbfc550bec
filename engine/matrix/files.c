/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which format a file of a matrix or an array has: by content when it is read, by the ending of its
 * name when it is written. */
#include "matrix/internal.h"

#include <string.h>
#include <strings.h>

static const char *ending_of(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  return dot ? dot : "";
}

/* ---- matrices -------------------------------------------------------------------------------- */

bw_status bw_sparse_matrix_parse(bw_context *context, const char *name, const unsigned char *bytes,
                                 size_t count, bw_sparse_matrix **matrix) {
  bwi_cursor cursor;
  bwi_cursor_init(&cursor, context, name, bytes, count);
  if (bwi_is_matrix_market(&cursor))
    return bwi_market_read_matrix(&cursor, matrix);
  if (bwi_is_npz(&cursor))
    return bwi_npz_read_matrix(&cursor, matrix);
  if (bwi_is_npy(&cursor))
    return bwi_fail_byte(&cursor, "an array of NumPy, not a sparse matrix: read it as an array");
  return bwi_fail_byte(&cursor, "neither Matrix Market (%%%%MatrixMarket) nor a matrix of SciPy "
                                "(.npz)");
}

bw_status bw_sparse_matrix_read(bw_context *context, const char *path, bw_sparse_matrix **matrix) {
  unsigned char *bytes = NULL;
  size_t count = 0;
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status == BW_OK)
    status = bw_sparse_matrix_parse(context, path, bytes, count, matrix);
  bw_free(bytes);
  return status;
}

bw_status bw_sparse_matrix_write(bw_context *context, const bw_sparse_matrix *matrix,
                                 const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  const char *ending = ending_of(path);
  bool market = strcasecmp(ending, ".mtx") == 0;
  if (!market && strcasecmp(ending, ".npz") != 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   "%s: a matrix is written as .mtx (Matrix Market) or .npz (SciPy), not as '%s'",
                   path, ending);
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(market ? bwi_market_write_matrix(writer, matrix)
                : bwi_npz_write_matrix(context, writer, matrix));
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  return status;
}

/* ---- arrays ---------------------------------------------------------------------------------- */

bw_status bw_array_parse(bw_context *context, const char *name, const unsigned char *bytes,
                         size_t count, bw_array **array) {
  bwi_cursor cursor;
  bwi_cursor_init(&cursor, context, name, bytes, count);
  if (bwi_is_matrix_market(&cursor))
    return bwi_market_read_array(&cursor, array);
  if (bwi_is_npy(&cursor))
    return bwi_npy_read(&cursor, array);
  if (bwi_is_npz(&cursor))
    return bwi_fail_byte(&cursor, "an archive of arrays: read it as a sparse matrix, or save one "
                                  "array as .npy");
  return bwi_fail_byte(&cursor,
                       "neither an array of NumPy (.npy) nor Matrix Market (%%%%MatrixMarket)");
}

bw_status bw_array_read(bw_context *context, const char *path, bw_array **array) {
  unsigned char *bytes = NULL;
  size_t count = 0;
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status == BW_OK)
    status = bw_array_parse(context, path, bytes, count, array);
  bw_free(bytes);
  return status;
}

bw_status bw_array_write(bw_context *context, const bw_array *array, const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  const char *ending = ending_of(path);
  bool market = strcasecmp(ending, ".mtx") == 0;
  if (!market && strcasecmp(ending, ".npy") != 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   "%s: an array is written as .npy (NumPy) or .mtx (Matrix Market), not as '%s'",
                   path, ending);
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(market ? bwi_market_write_array(writer, array) : bwi_npy_write(writer, array));
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  return status;
}
