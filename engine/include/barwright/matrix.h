/* matrix: sparse matrices, operators, and matrices and arrays in files of Matrix Market and NumPy.
 */
#ifndef BARWRIGHT_MATRIX_H
#define BARWRIGHT_MATRIX_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A matrix by compressed rows; it does not change. Symmetric ones have both triangles. */
typedef struct bw_sparse_matrix {
  bw_object object;
  int32_t rows, columns; /* sizes */
  int64_t *start;        /* (index, rows + 1) first entry of each row */
  int32_t *column;       /* (index, start[rows]) ascending in each row */
  double *value;         /* (any, start[rows]) */
} bw_sparse_matrix;
/* A matrix of `rows` x `columns` from `count` entries in any order: row (index, count), column
 * (index, count), value (any, count). Entries at one place are added, in the order given. */
BW_API bw_status bw_sparse_matrix_create(bw_context *context, int32_t rows, int32_t columns,
                                         int64_t count, const int32_t *row, const int32_t *column,
                                         const double *value, bw_sparse_matrix **matrix);
/* The same of `rows` x `columns` from compressed rows that it takes over, blocks of bw_alloc: start
 * (index, rows + 1), column (index, start[rows]), value (any, start[rows]). Columns of a row may be
 * in any order, each once. On failure the blocks stay the caller's. */
BW_API bw_status bw_sparse_matrix_adopt(bw_context *context, int32_t rows, int32_t columns,
                                        int64_t *start, int32_t *column, double *value,
                                        bw_sparse_matrix **matrix);
/* Whether it is square and equal to its transpose, to the last bit. */
BW_API bool bw_sparse_matrix_is_symmetric(const bw_sparse_matrix *matrix);
/* Y = A X for `count` vectors, one after the other: x (any, count x columns), y (any, count x
 * rows), another block. */
BW_API bw_status bw_sparse_matrix_apply(bw_context *context, const bw_sparse_matrix *matrix,
                                        int64_t count, const double *x, double *y);

/* Y = A X for `count` vectors, one after the other: x (any, count x size), y (any, count x size),
 * another block. Called on the thread that called the solver, and on no other. A status other than
 * BW_OK ends the solver with it. */
typedef bw_status bw_operator_function(bw_context *context, void *data, int64_t count,
                                       const double *x, double *y);
/* A square matrix that is known by its products alone: the caller's own, or a sparse matrix. It
 * must be linear, and the same in each call. */
typedef struct bw_operator {
  bw_object object;
  int64_t size;                   /* rows, and columns */
  bw_operator_function *apply;    /* the product */
  void *data;                     /* of `apply` */
  void (*destroy)(void *data);    /* releases `data`; or NULL */
  const bw_sparse_matrix *matrix; /* retained, where it is one; else NULL */
  bw_name name;                   /* for messages */
} bw_operator;
/* An operator of `size` rows whose products the caller's function computes. `destroy` (may be NULL)
 * releases `data` with the last reference; on failure the data stay the caller's. `name` (NULL:
 * "operator") is for messages, and is cut after BW_NAME bytes. BW_INVALID for a negative size or no
 * function. */
BW_API bw_status bw_operator_create(bw_context *context, int64_t size, bw_operator_function *apply,
                                    void *data, void (*destroy)(void *data), const char *name,
                                    bw_operator **result);
/* A square sparse matrix, which it retains, as an operator. `name` (NULL: "matrix"). BW_INVALID for
 * another number of columns than rows. */
BW_API bw_status bw_operator_of_matrix(bw_context *context, const bw_sparse_matrix *matrix,
                                       const char *name, bw_operator **result);
/* Y = A X as bw_operator_function: x (any, count x size), y (any, count x size), another block.
 * BW_INVALID for a product that is not finite; and the statuses of the caller's function. */
BW_API bw_status bw_operator_apply(bw_context *context, const bw_operator *a, int64_t count,
                                   const double *x, double *y);

/* Writes a matrix, by the ending of the path: .mtx is Matrix Market, coordinate format, real, and
 * symmetric (the lower triangle) where the matrix is, else general (Boisvert, Pozo and Remington
 * 1996); .npz is what scipy.sparse.load_npz reads as a CSR matrix. Numbers are read back to the
 * last bit. BW_UNSUPPORTED for other endings, BW_LIMIT for an array of 4 GB in .npz. */
BW_API bw_status bw_sparse_matrix_write(bw_context *context, const bw_sparse_matrix *matrix,
                                        const char *path);
/* Reads what bw_sparse_matrix_write writes, .mtx with fields real, integer or pattern, also
 * skew-symmetric, and .npz that is stored or deflated. The content decides, not the name. BW_FORMAT
 * names the line or byte, and the cause; BW_UNSUPPORTED for complex numbers and other formats of
 * SciPy; BW_LIMIT beyond 2^31 - 1 rows or columns, and beyond 4 GiB. */
BW_API bw_status bw_sparse_matrix_read(bw_context *context, const char *path,
                                       bw_sparse_matrix **matrix);
/* The same from `count` bytes; `name` is for messages. Those of bw_sparse_matrix_read. */
BW_API bw_status bw_sparse_matrix_parse(bw_context *context, const char *name,
                                        const unsigned char *bytes, size_t count,
                                        bw_sparse_matrix **matrix);

/* Writes an array, by the ending of the path: .npy is NumPy's format 1.0, a vector where there is
 * one column; .mtx is Matrix Market, array format, real, general. BW_UNSUPPORTED for other endings.
 */
BW_API bw_status bw_array_write(bw_context *context, const bw_array *array, const char *path);
/* Reads .npy of one or two dimensions (real numbers and integers of up to 8 bytes, and truth
 * values; either byte order and order of entries) or .mtx of the array format. The content decides.
 * BW_FORMAT names the line or byte, and the cause; BW_UNSUPPORTED for other types of numbers,
 * BW_LIMIT beyond 4 GiB. */
BW_API bw_status bw_array_read(bw_context *context, const char *path, bw_array **array);
/* The same from `count` bytes; `name` is for messages. Those of bw_array_read. */
BW_API bw_status bw_array_parse(bw_context *context, const char *name, const unsigned char *bytes,
                                size_t count, bw_array **array);

#ifdef __cplusplus
}
#endif
#endif
