/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "metamaterial/coarse.h"

bw_status bwi_lookup_material(bw_context *context, const bwi_coarse_maker *maker,
                              const bwi_fine_block *block, bw_solid_material **material) {
  (void)maker;
  (void)block;
  (void)material;
  return bw_fail(context, BW_UNSUPPORTED, "no lookup yet");
}
