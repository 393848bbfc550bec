/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The reference machine of the cost model: operations and bytes are counted, never time measured.
 * All its rates are here; who decides brings counts. Whatever streams through memory does so at
 * one rate, on bodies, grids and sheets alike. Rates of operations differ by the kind of work,
 * since small fronts and short rows reach less of the peak. */
#ifndef BWI_BASE_COST_H
#define BWI_BASE_COST_H

#define BWI_COST_BYTES_PER_SECOND 17e9
/* Factors of bodies, in numbers of 64 or 32 bits. */
static inline double bwi_cost_flops_per_second(int bits) {
  return bits == 32 ? 110e9 : 55e9;
}
/* Of edits: a part of a factor made again. */
#define BWI_COST_EDIT_FLOPS_PER_SECOND 45.3e9

/* Factors of solids on grids, whose fronts are smaller. */
#define BWI_COST_GRID_FLOPS_PER_SECOND 40e9

/* Factors of plane meshes: Cholesky, LU of node blocks, UMFPACK; passes over a factor, where adding
 * up small fronts is memory traffic. */
#define BWI_COST_PLANE_FLOPS_PER_SECOND 20e9
#define BWI_COST_BLOCKS_FLOPS_PER_SECOND 8e9
#define BWI_COST_UMFPACK_FLOPS_PER_SECOND 1.5e9
#define BWI_COST_PLANE_FACTOR_BYTES_PER_SECOND 4e9

/* Seconds of what is counted in pieces. Orders: of a body for each block of nodes (nested
 * dissection with its analysis), of a plane mesh for each node. Analyses under an order, for each
 * node: of a plane mesh; of a grid, with its order. A projected tangent of a solid, for each point.
 */
#define BWI_COST_ORDER_BLOCK 5e-7
#define BWI_COST_PLANE_ORDER_NODE 3e-7
#define BWI_COST_PLANE_ANALYSIS_NODE 2e-7
#define BWI_COST_GRID_ANALYSIS_NODE 1e-5
#define BWI_COST_TANGENT_POINT 2.6e-7

#endif
