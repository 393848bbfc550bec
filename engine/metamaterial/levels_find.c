/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Looking blocks of level 2 up. */
#include <string.h>

#include "metamaterial/levels.h"

void bwi_levels_destroy(bwi_levels *it) {
  if (!it)
    return;
  for (int s = 0; s < BWI_STAGES; s++) {
    bw_free(it->chosen[s]);
    bw_free(it->code[s]);
    bw_free(it->origin[s]);
    bw_free(it->how[s]);
    bw_free(it->flipped[s]);
  }
  for (int s = 0; s < 3; s++)
    bw_free(it->table[s]);
  bw_free(it->turned);
  bw_free(it->nearest);
  bw_free(it);
}

/* ---- lookup ---------------------------------------------------------------------------------- */

static int32_t pair_of(const bwi_levels *it, int stage, int32_t a, int32_t b) {
  return it->table[stage][a + (int64_t)it->count[stage] * b];
}

/* The symmetry that takes a block to the image whose cells' representatives come first in order;
 * of images that have the same, the one whose own materials come first. `best` becomes the
 * representatives there. */
static int first_image(const bwi_levels *it, const int32_t key[64], const uint16_t cell[8],
                       uint16_t best[8]) {
  int chosen = 0;
  int32_t own[64], other[64];
  bool have_own = false;
  memcpy(best, cell, 8 * sizeof *best);
  for (int s = 1; s < BWI_SYMMETRIES; s++) {
    uint16_t image[8];
    bwi_symmetry symmetry = bwi_symmetry_of(s);
    for (int c = 0; c < 8; c++)
      image[bwi_symmetry_octant(symmetry, c)] = it->turned[cell[c] * BWI_SYMMETRIES + s];
    int c = 0;
    while (c < 8 && image[c] == best[c])
      c++;
    if (c < 8 && image[c] > best[c])
      continue;
    bwi_symmetry_key(s, 64, key, other);
    if (c == 8) {
      if (!have_own)
        bwi_symmetry_key(chosen, 64, key, own);
      have_own = true;
      int p = 0;
      while (p < 63 && other[p] == own[p])
        p++;
      if (other[p] >= own[p])
        continue;
    }
    memcpy(best, image, 8 * sizeof *best);
    memcpy(own, other, sizeof own);
    have_own = true;
    chosen = s;
  }
  return chosen;
}

bwi_level2 bwi_levels_find(const bwi_levels *it, const bwi_keys *keys, const int32_t key[64]) {
  uint16_t cell[8], best[8];
  for (int c = 0; c < 8; c++) {
    int32_t code = bwi_key_code(keys->base, key + 8 * c), orbit = keys->orbit[code];
    cell[c] = orbit < 0
                  ? 0
                  : it->turned[(int64_t)it->nearest[orbit] * BWI_SYMMETRIES + keys->symmetry[code]];
  }
  int chosen = first_image(it, key, cell, best);
  int32_t x[4], y[2], z;
  for (int i = 0; i < 4; i++)
    x[i] = pair_of(it, 0, best[2 * i], best[2 * i + 1]);
  for (int i = 0; i < 2; i++)
    y[i] = pair_of(it, 1, x[2 * i], x[2 * i + 1]);
  z = pair_of(it, 2, y[0], y[1]);
  return (bwi_level2){it->origin[3][z],
                      bwi_symmetry_after(bwi_symmetry_inverse(chosen), it->how[3][z])};
}

void bwi_levels_cells(const bwi_levels *it, int32_t z, int32_t cell[8]) {
  for (int c = 0; c < 8; c++) {
    int32_t y = c & 4 ? z / it->count[2] : z % it->count[2];
    int32_t x = c & 2 ? it->code[2][y] / it->count[1] : it->code[2][y] % it->count[1];
    cell[c] = c & 1 ? it->code[1][x] / it->count[0] : it->code[1][x] % it->count[0];
  }
}

void bwi_levels_block(const bwi_levels *it, int32_t fit, int32_t cell[8]) {
  bwi_levels_cells(it, it->chosen[3][fit], cell);
}
