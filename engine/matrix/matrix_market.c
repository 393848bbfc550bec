/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrix Market: a line that says what follows, comments, a line of sizes, then entries "row column
 * value" counted from 1 (coordinate), or the numbers column by column (array). Of symmetric
 * matrices the file has the lower triangle. */
#include "matrix/internal.h"

#include <string.h>

typedef enum symmetry { GENERAL, SYMMETRIC, SKEW } symmetry;

typedef struct market {
  bool coordinate, pattern;
  symmetry symmetry;
  int64_t rows, columns, entries;
} market;

bool bwi_is_matrix_market(const bwi_cursor *cursor) {
  static const char magic[] = "%%MatrixMarket";
  return bwi_left(cursor) >= sizeof magic - 1 && memcmp(cursor->at, magic, sizeof magic - 1) == 0;
}

static bw_status read_banner(bwi_cursor *cursor, market *m) {
  bwi_cursor line;
  bwi_word word;
  bwi_next_line(cursor, &line);
  bwi_next_word(&line, &word); /* %%MatrixMarket */
  if (!bwi_next_word(&line, &word) || !bwi_word_is_nocase(word, "matrix"))
    return bwi_fail_word(&line, word, "'matrix'");
  bwi_next_word(&line, &word);
  m->coordinate = bwi_word_is_nocase(word, "coordinate");
  if (!m->coordinate && !bwi_word_is_nocase(word, "array"))
    return bwi_fail_word(&line, word, "'coordinate' or 'array'");
  bwi_next_word(&line, &word);
  m->pattern = bwi_word_is_nocase(word, "pattern") && m->coordinate;
  if (bwi_word_is_nocase(word, "complex")) {
    bwi_fail_line(&line, "the numbers are complex: real ones expected");
    return BW_UNSUPPORTED;
  }
  if (!m->pattern && !bwi_word_is_nocase(word, "real") && !bwi_word_is_nocase(word, "integer") &&
      !bwi_word_is_nocase(word, "double"))
    return bwi_fail_word(&line, word, "'real' or 'integer'");
  bwi_next_word(&line, &word);
  m->symmetry = bwi_word_is_nocase(word, "symmetric")        ? SYMMETRIC
                : bwi_word_is_nocase(word, "skew-symmetric") ? SKEW
                                                             : GENERAL;
  if (m->symmetry == GENERAL && !bwi_word_is_nocase(word, "general"))
    return bwi_fail_word(&line, word, "'general', 'symmetric' or 'skew-symmetric'");
  return BW_OK;
}

static bw_status read_sizes(bwi_cursor *cursor, market *m) {
  bw_status status = BW_OK;
  while (bwi_skip_space(cursor) && *cursor->at == '%')
    bwi_skip_line(cursor);
  BW_TRY(bwi_read_integer(cursor, &m->rows, "the number of rows"));
  BW_TRY(bwi_read_integer(cursor, &m->columns, "the number of columns"));
  BW_TRY(bwi_check_size(cursor, m->rows, "rows"));
  BW_TRY(bwi_check_size(cursor, m->columns, "columns"));
  if (m->symmetry != GENERAL && m->rows != m->columns)
    return bwi_fail_line(cursor, "a symmetric matrix of %lld x %lld: it must be square",
                         (long long)m->rows, (long long)m->columns);
  if (m->coordinate)
    BW_TRY(bwi_read_count(cursor, m->pattern ? 3 : 5, &m->entries, "entries"));
done:
  return status;
}

static bw_status check_end(bwi_cursor *cursor, const char *what) {
  if (!bwi_skip_space(cursor))
    return BW_OK;
  return bwi_fail_line(cursor, "found %s behind the last %s", bwi_show(bwi_peek_word(cursor)),
                       what);
}

/* An entry; rows and columns from 0. */
static bw_status read_entry(bwi_cursor *cursor, const market *m, int32_t *row, int32_t *column,
                            double *value) {
  bw_status status = BW_OK;
  int64_t i, j;
  BW_TRY(bwi_read_integer(cursor, &i, "the row of an entry"));
  BW_TRY(bwi_read_integer(cursor, &j, "the column of an entry"));
  if (i < 1 || i > m->rows || j < 1 || j > m->columns)
    return bwi_fail_line(cursor, "an entry at (%lld, %lld) of a matrix of %lld x %lld",
                         (long long)i, (long long)j, (long long)m->rows, (long long)m->columns);
  if (m->symmetry != GENERAL && i < j + (m->symmetry == SKEW))
    return bwi_fail_line(cursor,
                         "an entry at (%lld, %lld) lies %s the diagonal of a matrix of which the "
                         "lower triangle is expected",
                         (long long)i, (long long)j, i == j ? "on" : "above");
  *row = (int32_t)(i - 1);
  *column = (int32_t)(j - 1);
  *value = 1;
  if (!m->pattern)
    BW_TRY(bwi_read_any_real(cursor, value, "the value of an entry"));
done:
  return status;
}

bw_status bwi_market_read_matrix(bwi_cursor *cursor, bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  bw_context *context = cursor->context;
  market m = {0};
  int32_t *row = NULL, *column = NULL;
  double *value = NULL;
  BW_TRY(read_banner(cursor, &m));
  if (!m.coordinate)
    return bwi_fail_line(cursor, "an array of numbers, not a sparse matrix: read it as an array");
  BW_TRY(read_sizes(cursor, &m));
  size_t capacity = (size_t)m.entries * (m.symmetry == GENERAL ? 1 : 2) + 1;
  row = BW_NEW(context, int32_t, capacity);
  column = BW_NEW(context, int32_t, capacity);
  value = BW_NEW(context, double, capacity);
  BW_TRY_MEMORY(row && column && value);
  int64_t count = 0;
  for (int64_t k = 0; k < m.entries; k++) {
    if (k % 65536 == 0)
      BW_TRY(bw_check_cancel(context));
    BW_TRY(read_entry(cursor, &m, &row[count], &column[count], &value[count]));
    count++;
    if (m.symmetry != GENERAL && row[count - 1] != column[count - 1]) {
      row[count] = column[count - 1];
      column[count] = row[count - 1];
      value[count] = m.symmetry == SKEW ? -value[count - 1] : value[count - 1];
      count++;
    }
  }
  BW_TRY(check_end(cursor, "entry"));
  BW_TRY(bw_sparse_matrix_create(context, (int32_t)m.rows, (int32_t)m.columns, count, row, column,
                                 value, matrix));
done:
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}

bw_status bwi_market_read_array(bwi_cursor *cursor, bw_array **result) {
  bw_status status = BW_OK;
  market m = {0};
  bw_array *array = NULL;
  BW_TRY(read_banner(cursor, &m));
  if (m.coordinate)
    return bwi_fail_line(cursor, "a sparse matrix, not an array: read it as a sparse matrix");
  BW_TRY(read_sizes(cursor, &m));
  uint64_t numbers = (uint64_t)m.rows * (uint64_t)m.columns;
  BW_TRY(bwi_check_count(cursor, m.symmetry == GENERAL ? numbers : numbers / 4, 2, "numbers"));
  BW_TRY(bw_array_create(cursor->context, BW_F64, m.rows, m.columns, &array));
  double *data = array->data;
  for (int64_t j = 0; j < m.columns; j++)
    for (int64_t i = m.symmetry == GENERAL ? 0 : j + (m.symmetry == SKEW); i < m.rows; i++) {
      double value;
      BW_TRY(bwi_read_any_real(cursor, &value, "a number"));
      data[i * m.columns + j] = value;
      if (m.symmetry != GENERAL && i != j)
        data[j * m.columns + i] = m.symmetry == SKEW ? -value : value;
    }
  BW_TRY(check_end(cursor, "number"));
  *result = array;
  array = NULL;
done:
  bw_release(array);
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

bw_status bwi_market_write_matrix(bw_writer *writer, const bw_sparse_matrix *matrix) {
  bool symmetric = bw_sparse_matrix_is_symmetric(matrix);
  bw_status status = BW_OK;
  int64_t entries = 0;
  for (int32_t i = 0; i < matrix->rows; i++)
    for (int64_t k = matrix->start[i]; k < matrix->start[i + 1]; k++)
      entries += !symmetric || matrix->column[k] <= i;
  BW_TRY(bw_writer_print(writer, "%%%%MatrixMarket matrix coordinate real %s\n%d %d %lld\n",
                         symmetric ? "symmetric" : "general", matrix->rows, matrix->columns,
                         (long long)entries));
  for (int32_t i = 0; i < matrix->rows; i++)
    for (int64_t k = matrix->start[i]; k < matrix->start[i + 1]; k++) {
      if (symmetric && matrix->column[k] > i)
        break;
      BW_TRY(bw_writer_print(writer, "%d %d ", i + 1, matrix->column[k] + 1));
      BW_TRY(bw_writer_number(writer, matrix->value[k]));
      BW_TRY(bw_writer_bytes(writer, "\n", 1));
    }
done:
  return status;
}

bw_status bwi_market_write_array(bw_writer *writer, const bw_array *array) {
  bw_status status = BW_OK;
  BW_TRY(bw_writer_print(writer, "%%%%MatrixMarket matrix array real general\n%lld %lld\n",
                         (long long)array->rows, (long long)array->columns));
  for (int64_t j = 0; j < array->columns; j++)
    for (int64_t i = 0; i < array->rows; i++) {
      BW_TRY(bw_writer_number(writer, bw_array_get(array, i, j)));
      BW_TRY(bw_writer_bytes(writer, "\n", 1));
    }
done:
  return status;
}
