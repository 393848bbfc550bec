/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The reference machine of the cost model: operations and bytes are counted, never time measured.
 */
#ifndef BWI_BASE_COST_H
#define BWI_BASE_COST_H

#define BWI_COST_BYTES_PER_SECOND 17e9
static inline double bwi_cost_flops_per_second(int bits) {
  return bits == 32 ? 110e9 : 55e9;
}

#endif
