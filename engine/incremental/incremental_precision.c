/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The precision in which the factor of a system that follows edits is kept.
 *
 * In single precision factoring takes half the time, and the factor and the update matrices half
 * the memory; but a solution needs a few applications of the factor instead of one (conjugate
 * gradients in double precision on the matrix in double precision). So it pays where edits do much
 * of the factor again, and not where nearly all of it stays. What counts is the sum over the edits
 * to be expected, in operations and bytes; once double precision was chosen it stays. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"

/* Iterations to 1e-10 that a body needs, before it has been seen: limbed ones took 5 to 15. */
#define REFINEMENTS 10.0
/* Single precision is taken where it costs less than this of double precision: by so much that
 * shapes that are solved for several times (loads, adjoints) do not lose by it. It is left where it
 * costs more than that: a small predicted gain does not pay for a whole factor in the other. */
#define SINGLE_BELOW 0.7
#define DOUBLE_ABOVE 1.0

/* In single precision, to 1e-10. */
static double refinements_of(const bw_incremental_system *incremental) {
  return incremental->inner->refinements > 0 ? incremental->inner->refinements : REFINEMENTS;
}

double bwi_incremental_refinements(const bw_incremental_system *incremental, double tolerance) {
  const bwi_incremental *inner = incremental->inner;
  return inner->factor->kernels->bits == 64
             ? 0
             : refinements_of(incremental) * log(tolerance) / log(1e-10);
}

/* Update and solution after edits that do `flops` of work again, `edits` in all. */
static double cost_of(const bw_incremental_system *incremental, const bwi_symbolic *symbolic,
                      int bits, double flops, int32_t edits) {
  double entries = (double)symbolic->panel[symbolic->order->super_count];
  double pass = 2 * entries * bits / 8,
         product = 72.0 * (double)incremental->system->pattern->block_count;
  double again = symbolic->flops > 0 ? flops / symbolic->flops : 0;
  double refinements = refinements_of(incremental);
  double bytes = again * pass + edits * pass;
  if (bits == 32)
    bytes += edits * (refinements * product + (refinements - 1) * pass);
  return flops / bwi_cost_flops_per_second(bits) + bytes / BWI_COST_BYTES_PER_SECOND;
}

bw_status bwi_incremental_choose_bits(bw_context *context, const bw_incremental_system *incremental,
                                      const bwi_elimination_reach *reach, int *bits) {
  const bwi_incremental *inner = incremental->inner;
  const bw_edits *edits = &inner->edits;
  int32_t count = edits->count > 0 ? edits->count : inner->subdomain_count;
  double flops = 0;
  if (inner->wanted_bits || inner->double_only || *bits == 64) {
    *bits = inner->double_only || inner->wanted_bits == 0 ? 64 : inner->wanted_bits;
    return BW_OK;
  }
  uint8_t *touched = BW_NEW(context, uint8_t, inner->subdomain_count);
  if (!touched)
    return BW_MEMORY;
  for (int32_t e = 0; e < count; e++) {
    memset(touched, 0, (size_t)inner->subdomain_count);
    for (int32_t d = 0; d < inner->subdomain_count; d++) {
      if (edits->count == 0)
        touched[d] = d == e;
      for (int32_t k = edits->count ? edits->start[d] : 0;
           k < (edits->count ? edits->start[d + 1] : 0); k++)
        touched[d] |= edits->edit[k] == e;
    }
    flops += bwi_elimination_reach_flops(reach, touched);
  }
  bw_free(touched);
  double single = cost_of(incremental, reach->symbolic, 32, flops, count);
  double twice = cost_of(incremental, reach->symbolic, 64, flops, count);
  *bits = single < (*bits == 32 ? DOUBLE_ABOVE : SINGLE_BELOW) * twice ? 32 : 64;
  return BW_OK;
}
