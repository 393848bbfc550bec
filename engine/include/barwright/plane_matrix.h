/* plane_matrix: matrices on a plane mesh. */
#ifndef BARWRIGHT_PLANE_MATRIX_H
#define BARWRIGHT_PLANE_MATRIX_H

#include "barwright/plane.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Block sparsity pattern of a plane mesh: full rows, ascending, and for every block the
 * contributions (element, local pair) that are added into it: gathered, never scattered, so that
 * the bits do not depend on threads. Values are the caller's: `components`^2 numbers per block, row
 * by row. Depends on topology only. */
typedef struct bw_plane_pattern {
  bw_object object;
  const bw_plane_topology *topology; /* retained */
  int32_t node_count;
  int64_t block_count;
  int64_t *start;          /* (index, node_count + 1) first block of each row */
  int32_t *column;         /* (index, block_count) */
  int64_t *diagonal;       /* (index, node_count) where the block (i, i) is */
  int64_t *mirror;         /* (index, block_count) where the block (j, i) of a block (i, j) is */
  int64_t *gather_start;   /* (index, block_count + 1) first contribution to each block */
  int32_t *gather_element; /* (index, gather_start[block_count]) of each contribution */
  uint8_t *gather_local; /* (gather_start[block_count]) a * 6 + b: local nodes of row and column */
} bw_plane_pattern;
/* The pattern of a topology. BW_LIMIT where it has too many blocks. */
BW_API bw_status bw_plane_pattern_create(bw_context *context, const bw_plane_topology *topology,
                                         bw_plane_pattern **pattern);
/* Writes the matrix (any, n c x n c) of an element with n nodes and c components: unknown node c +
 * component. Called from several threads at once. */
typedef bw_status bw_element_matrix(void *data, int32_t element, double *matrix);
/* Adds the matrices of all elements, which element_matrix gives, into values (any, block_count x
 * components x components), zeroed first; 1 to 4 components. */
BW_API bw_status bw_plane_assemble(bw_context *context, const bw_plane_pattern *pattern,
                                   int components, bw_element_matrix *element_matrix, void *data,
                                   double *values);
/* y = A x for values (any, block_count x components x components), with x and y (any, node_count x
 * components). */
BW_API bw_status bw_plane_multiply(bw_context *context, const bw_plane_pattern *pattern,
                                   int components, const double *values, const double *x,
                                   double *y);
/* Prescribes unknowns, those with is_prescribed (node_count x components) not 0, to prescribed
 * (any, node_count x components). Their rows and columns in values (any, block_count x components x
 * components) become those of the identity times the mean size of the component's diagonal entries.
 * rhs (any, node_count x components), which may be NULL, changes accordingly, and the number of
 * unknowns does not. */
BW_API bw_status bw_plane_prescribe(bw_context *context, const bw_plane_pattern *pattern,
                                    int components, const uint8_t *is_prescribed,
                                    const double *prescribed, double *values, double *rhs);

#ifdef __cplusplus
}
#endif
#endif
