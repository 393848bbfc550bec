/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A plane mesh while edges are flipped and inner nodes moved. */
#ifndef BARWRIGHT_PLANE_EDGE_FLIPS_H
#define BARWRIGHT_PLANE_EDGE_FLIPS_H

#include "plane/internal.h"

/* Edge k of an element runs from its corner k to corner k + 1; `constrained` edges are never
 * flipped (sides and edges between regions). Points: of corners, and with order 2 of mid-edge nodes
 * behind them. */
typedef struct bwi_edge_flips {
  int order;
  int32_t corner_count, element_count;
  int32_t *element;     /* x 3 or 6 */
  int32_t *neighbour;   /* x 3 */
  uint8_t *constrained; /* x 3 */
  uint8_t *fixed;       /* corners: may not move */
  double *point;        /* x 2 */
  int32_t *star;        /* corners: an element around; kept by flips */
  double *quality;      /* elements; kept by flips and moves */
  int32_t *queue;       /* x 3: a ring of edges that flips will look at, 3 e + k */
  uint8_t *queued;      /* x 3 */
  int64_t head, waiting;
} bwi_edge_flips;

/* Of a mesh: topology, and points that are copied. Sides, edges between regions and their corners
 * are constrained and fixed. */
bw_status bwi_edge_flips_open(bw_context *context, const bw_plane_topology *topology,
                              const double *point, bwi_edge_flips *flipping);
void bwi_edge_flips_clear(bwi_edge_flips *flipping); /* frees all of it */

/* Every edge into the queue. */
void bwi_edge_flips_queue_all(bwi_edge_flips *flipping);
void bwi_edge_flips_queue(bwi_edge_flips *flipping, int32_t element, int k);
/* Flips until every edge in the queue, and around what was flipped, is Delaunay (but for rounding,
 * and where the new elements would be worse than flat or, curved, folded). Returns the number of
 * flips. */
int32_t bwi_edge_flips_flip(bwi_edge_flips *flipping);
/* One round over the nodes in order: each goes towards the middle of its star where that does not
 * make the worst element around it worse than `enough`. Only nodes with an element worse than
 * `below` around them. Their edges go into the queue. Returns the number of nodes moved. */
int32_t bwi_edge_flips_smooth(bwi_edge_flips *flipping, double below, double enough);

#endif
