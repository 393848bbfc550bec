/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of joint share. */
#ifndef BWI_JOINT_INTERNAL_H
#define BWI_JOINT_INTERNAL_H

#include "barwright/assemble.h"
#include "barwright/joint.h"
#include "model/internal.h"

/* The displacements that supports and bonds allow: u = T x + g. */
typedef struct bwi_reduction {
  bw_dof_map *dof_map;          /* of the bodies apart */
  const bw_bond **bond_of;      /* node_count: the bond in which a node follows, or NULL */
  int32_t *row_of;              /* node_count: its row there */
  int32_t *unknown;             /* node_count x 3, in the nodes' frames: the column, or -1 */
  int32_t unknown_count;        /* columns */
  bw_sparse_matrix *t;          /* 3 node_count x unknown_count, global directions */
  bw_sparse_matrix *transposed; /* T^T */
  double *g;                    /* 3 node_count */
} bwi_reduction;
/* Clear with bwi_reduction_clear in any case. */
bw_status bwi_reduction_open(bw_context *context, const bw_model *model, bwi_reduction *reduction);
void bwi_reduction_clear(bwi_reduction *reduction);

/* T^T A T of a block matrix, `block` 9 or 1 numbers for each block of the pattern as
 * bw_block_multiply takes them. Symmetric to the last bit. */
bw_status bwi_reduce_matrix(bw_context *context, const bwi_reduction *reduction,
                            const bw_block_pattern *pattern, const double *values, int block,
                            bw_sparse_matrix **reduced);

/* Moves forces (node_count x 3) at nodes that follow to the nodes that they follow. */
void bwi_reduction_move(const bwi_reduction *reduction, double *force);

#endif
