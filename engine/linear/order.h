/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The steps of making an order, for those who bring a permutation of their own. */
#ifndef BWI_LINEAR_ORDER_H
#define BWI_LINEAR_ORDER_H

#include <metis.h>

#include "linear/internal.h"

/* The graph of the nodes that take part, numbered 0 to size - 1 in ascending order: both triangles,
 * without the diagonal. */
typedef struct bwi_adjacency {
  idx_t size;
  idx_t *start, *neighbour;
  int32_t node_count; /* of the mesh */
  int32_t *node_of;   /* size: mesh node */
  int32_t *compact;   /* mesh node -> 0 to size - 1, or -1 */
} bwi_adjacency;
/* Only blocks below the diagonal are read. Clear in any case. */
bw_status bwi_adjacency_create(bw_context *context, const bw_block_pattern *pattern,
                               const uint8_t *take, bwi_adjacency *near);
void bwi_adjacency_clear(bwi_adjacency *near);

/* permutation[k] = the node eliminated k-th, by METIS. */
bw_status bwi_dissect(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                      idx_t *permutation);
/* The same by approximate minimum degree, AMD: a fraction of the time, with more fill on large
 * graphs. */
bw_status bwi_minimum_degree(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                             idx_t *permutation);
/* Dissection with more care: each separator is the best of several, and trials (1, 2, ...) begin
 * from other random numbers. Twice the time; factors differ by a fifth between trials, and by more
 * in what an edit touches. Trial 0 is bwi_dissect. */
bw_status bwi_dissect_trial(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                            int trial, idx_t *permutation);

/* Around calls of METIS by others. */
void bwi_metis_lock(void);
void bwi_metis_unlock(void);

/* CHOLMOD's supernodal analysis of a permutation. */
bw_status bwi_order_analyse(bw_context *context, const bwi_adjacency *near,
                            const idx_t *permutation, bwi_order **order);

/* The groups around each node, ascending. */
typedef struct bwi_membership {
  int32_t *start; /* size + 1 (and one to count with) */
  int32_t *group;
} bwi_membership;
/* shared[a groups + b]: nodes that groups a and b have in common; the diagonal is 0. */
void bwi_count_shared(const bwi_membership *of, int32_t size, int32_t groups, int32_t *shared);
/* permutation[k] = the node eliminated k-th: the set of groups bisected along its interfaces, METIS
 * inside a group (order_interfaces.c). */
bw_status bwi_order_along_interfaces(bw_context *context, const bwi_adjacency *near,
                                     const bwi_membership *of, int32_t groups, idx_t *permutation);

#endif
