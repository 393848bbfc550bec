/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of matrix share: a reader and a writer for each format. */
#ifndef BARWRIGHT_MATRIX_INTERNAL_H
#define BARWRIGHT_MATRIX_INTERNAL_H

#include "barwright/matrix.h"
#include "io/internal.h"

/* A count of rows or columns that a file of so many bytes may have: they need no entry, but memory.
 * `what`: "rows" or "columns". */
bw_status bwi_check_size(const bwi_cursor *cursor, int64_t size, const char *what);

/* ---- Matrix Market (matrix_market.c) --------------------------------------------------------- */

bool bwi_is_matrix_market(const bwi_cursor *cursor);
bw_status bwi_market_read_matrix(bwi_cursor *cursor, bw_sparse_matrix **matrix);
bw_status bwi_market_read_array(bwi_cursor *cursor, bw_array **array);
bw_status bwi_market_write_matrix(bw_writer *writer, const bw_sparse_matrix *matrix);
bw_status bwi_market_write_array(bw_writer *writer, const bw_array *array);

/* ---- NumPy arrays (npy.c) -------------------------------------------------------------------- */

bool bwi_is_npy(const bwi_cursor *cursor);
bw_status bwi_npy_read(bwi_cursor *cursor, bw_array **array);
/* The text of a scalar of bytes, which SciPy keeps the name of its format in; cut to fit. */
bw_status bwi_npy_read_text(bwi_cursor *cursor, char *text, size_t size);
enum { BWI_NPY_HEAD = 128 };
/* A header of BWI_NPY_HEAD bytes; `shape` as Python writes a tuple, `type` as NumPy a dtype. */
void bwi_npy_head(char head[BWI_NPY_HEAD], const char *type, const char *shape);
bw_status bwi_npy_write(bw_writer *writer, const bw_array *array);

/* ---- archives of NumPy arrays (npz.c) -------------------------------------------------------- */

bool bwi_is_npz(const bwi_cursor *cursor);
bw_status bwi_npz_read_matrix(bwi_cursor *cursor, bw_sparse_matrix **matrix);
bw_status bwi_npz_write_matrix(bw_context *context, bw_writer *writer,
                               const bw_sparse_matrix *matrix);

#endif
