/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A stiffness by the rows of its nodes, in an order for sweeping over them: Gauss and Seidel's
 * iteration, the smoother beside a coarse space, and products.
 *
 * Rows come in chunks whose nodes have no element in common with those of other chunks, so that
 * chunks are swept side by side, and then those of the nodes between the chunks. The order depends
 * on the pattern alone: the same bits for any number of threads.
 *
 * What takes the time is reading the matrix, so that only the lower triangle is kept, and read once
 * in each sweep: what a row does to those before it is added to them when it is its turn. Sweeps
 * are a preconditioner, which need not be exact: they read the upper half of each double, which is
 * a float. Products read the lower half too. Where elements are straight and of one material, the
 * block of two nodes with no facet of the boundary in common is symmetric in itself
 * (docs/theory/edit.md): six numbers in place of nine. Products of quadratic
 * elements go by elements there (element_product.h). So that no unit leaves the range of floats,
 * the matrix is taken times one power of two, `unit`, that brings its largest diagonal entry
 * near 1.
 *
 * Fields are packed: in the order of the rows, three numbers a node; `width` of them, 1 or a
 * multiple of 4, interleaved number by number. */
#ifndef BWI_LINEAR_SMOOTHER_H
#define BWI_LINEAR_SMOOTHER_H

#include <float.h>
#include <math.h>

#include "assemble/internal.h"
#include "linear/internal.h"

enum { BWI_SMOOTHER_SIDES = 12, BWI_SMOOTHER_ROWS = 512, BWI_SMOOTHER_MAX_CHUNKS = 16 };
/* Numbers that a packed field has room for behind its end. */
enum { BWI_SMOOTHER_SPARE = 8 };

/* The entries below the diagonal whose blocks have 6 numbers (xx xy xz yy yz zz), or those that
 * have 9 (by columns). */
typedef struct bwi_smoother_part {
  int64_t *start;         /* rows + 1: entries */
  const int64_t *outside; /* rows: end of those that are not of the row's own block */
  int64_t *within;        /* rows: the same, or NULL where there are no blocks */
  int32_t *column;        /* of an entry: a row, ascending in each row */
  float *value;           /* unit * K: the sign, the exponent and 24 bits of each number */
  uint32_t *rest;         /* the 29 bits that follow; NULL where no product reads them */
} bwi_smoother_part;

/* A number from its two halves. */
static inline double bwi_smoother_whole(float value, uint32_t rest) {
  union {
    double number;
    uint64_t bits;
  } whole = {.number = (double)value};
  whole.bits |= rest;
  return whole.number;
}

/* The halves of a number. What is below the range of floats is 0. */
static inline float bwi_smoother_halves(double number, uint32_t *rest) {
  union {
    double number;
    uint64_t bits;
  } whole = {.number = fabs(number) < (double)FLT_MIN ? 0 : number};
  *rest = whole.bits & 0x1fffffff;
  whole.bits -= *rest;
  return (float)whole.number;
}

/* element_product.h */
typedef struct bwi_element_product bwi_element_product;

typedef struct bwi_smoother {
  bw_object object;
  const bw_block_pattern *pattern; /* retained */
  int32_t count;                   /* nodes */
  int32_t *node;                   /* count: in the order of the rows */
  int32_t *row_of;                 /* count: and the row of each */
  int32_t chunk_count;
  int32_t chunk_start[BWI_SMOOTHER_MAX_CHUNKS + 1];   /* rows after the last are between chunks */
  int32_t between_start[BWI_SMOOTHER_MAX_CHUNKS + 1]; /* these, by the chunk that they were of */
  bwi_smoother_part even, odd;                        /* of 6 numbers, of 9 */
  /* Rows that sweeps solve together (smoother_blocks.h). NULL: each row by itself. Else the matrix
   * of each block is L D L^T, where L has the rows within its envelope. */
  bool columns; /* most nodes are strongly coupled in one direction */
  int32_t block_count;
  int32_t *block_start;                             /* block_count + 1: rows */
  int32_t chunk_block[BWI_SMOOTHER_MAX_CHUNKS + 1]; /* the first block of each chunk */
  int32_t *envelope;                                /* rows: the first column of L */
  int64_t *factor_start;                            /* rows + 1 */
  float *factor;                                    /* 9 each, by columns: L below the diagonal */
  float *inverse;   /* 9 by row, by columns: of D at the unknowns, of unit * K */
  double *diagonal; /* 6 by row: unit * K */
  double unit;
  bool by_elements;              /* products are, and no halves are stored for them */
  bwi_element_product *elements; /* of the shape followed; or NULL */
} bwi_smoother;

/* The width for up to BWI_SMOOTHER_SIDES fields at once. */
static inline int bwi_smoother_width(int64_t count) {
  return count <= 1                    ? 1
         : count >= BWI_SMOOTHER_SIDES ? BWI_SMOOTHER_SIDES
                                       : (int)(count + 3) / 4 * 4;
}
/* For matrices on the pattern of a mesh. `even`: bwi_blocks_even. `by_elements`: it is what
 * bwi_element_product_serves, and bwi_smoother_follow_elements comes before products. `stiffness`:
 * nodes that it couples strongly are swept together; NULL: each by itself. `mesh` NULL: not `even`,
 * and for sweeps alone, without products. Release with bw_release. */
bw_status bwi_smoother_create(bw_context *context, const bw_mesh *mesh,
                              const bw_block_pattern *pattern, bool even, bool by_elements,
                              const bwi_stiffness *stiffness, bwi_smoother **out);
/* Take over a stiffness, row by row, at the unknowns of a DOF map; isostatic constraints are
 * unknowns here: K is singular where there are any. One that is not stored is that of
 * bwi_smoother_create, where `unit` comes from. *usable is false where a node's own block is not
 * positive definite. */
bw_status bwi_smoother_follow(bw_context *context, bwi_smoother *smoother,
                              const bwi_stiffness *stiffness, const bw_dof_map *dof_map,
                              bool *usable);
/* And the elements of that shape, where products are by elements: before the first one. *usable is
 * false where these no longer serve. */
bw_status bwi_smoother_follow_elements(bw_context *context, bwi_smoother *smoother,
                                       const bw_mesh *mesh, const bw_material *material,
                                       bool *usable);
/* z = (D + L)^-1 r and residual = r - K z, where z is 0 off the unknowns and residual of no
 * meaning. */
bw_status bwi_smoother_forward(bw_context *context, const bwi_smoother *smoother, int width,
                               const float *r, float *z, float *residual);
/* z += (D + U)^-1 (r - K z); `work` has room for a field. */
bw_status bwi_smoother_backward(bw_context *context, const bwi_smoother *smoother, int width,
                                const float *r, float *z, float *work);
/* y = K x, and the energies x . K x of the fields (NULL: not wanted) */
bw_status bwi_smoother_product(bw_context *context, const bwi_smoother *smoother, int width,
                               const double *x, double *y, double *energy);
/* Projects a field on the unknowns at `count` rows that have prescribed components. */
void bwi_smoother_keep(const bwi_smoother *smoother, const bw_dof_map *dof_map, int32_t count,
                       const int32_t *row, int width, float *field);
/* Bytes that a product of stored blocks reads for a block below the diagonal, about: seven numbers
 * and a column. One by elements reads less. */
#define BWI_SMOOTHER_PRODUCT_BYTES 60
/* What such a product and a sweep forwards and backwards read for `blocks` of them. */
double bwi_smoother_bytes(int64_t blocks);

#endif
