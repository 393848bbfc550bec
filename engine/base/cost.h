/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The reference machine of the cost model: operations and bytes are counted, never time measured.
 * Whatever streams through memory does so at one rate, on bodies, grids and sheets alike. Rates of
 * operations differ by the kind of work, since small fronts and short rows reach less of the peak.
 */
#ifndef BWI_BASE_COST_H
#define BWI_BASE_COST_H

#define BWI_COST_BYTES_PER_SECOND 17e9
static inline double bwi_cost_flops_per_second(int bits) {
  return bits == 32 ? 110e9 : 55e9;
}

/* Factors of solids on grids, whose fronts are smaller. */
#define BWI_COST_GRID_FLOPS_PER_SECOND 40e9

/* Factors of plane meshes: Cholesky, LU of node blocks, UMFPACK; passes over a factor, where adding
 * up small fronts is memory traffic. */
#define BWI_COST_PLANE_FLOPS_PER_SECOND 20e9
#define BWI_COST_BLOCKS_FLOPS_PER_SECOND 8e9
#define BWI_COST_UMFPACK_FLOPS_PER_SECOND 1.5e9
#define BWI_COST_PLANE_FACTOR_BYTES_PER_SECOND 4e9

#endif
