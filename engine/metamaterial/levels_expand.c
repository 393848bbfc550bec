/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Representatives and tables of level 2, from what was chosen: the same for a library that is built
 * and for one that is read. Nothing here trusts what was chosen. */
#include <string.h>

#include "metamaterial/levels.h"

/* What a chosen item of stage 0 or of another can at most become. */
static bw_status capacity(bw_context *context, bwi_levels *it, int s, int64_t max) {
  it->code[s] = BW_NEW0(context, int32_t, max);
  it->origin[s] = BW_NEW0(context, int32_t, max);
  it->how[s] = BW_NEW0(context, uint8_t, max);
  return it->code[s] && it->origin[s] && it->how[s] ? BW_OK : BW_MEMORY;
}

static void add(bwi_levels *it, int s, int32_t code, int32_t origin, int how) {
  int32_t r = it->count[s]++;
  it->code[s][r] = code;
  it->origin[s][r] = origin;
  it->how[s][r] = (uint8_t)how;
}

static bw_status fail(bw_context *context, int s, const char *what) {
  return bw_fail(context, BW_FORMAT, "representatives of stage %d: %s", s, what);
}

bw_status bwi_levels_expand_cells(bw_context *context, bwi_levels *it, const bwi_keys *keys) {
  bw_status status = BW_OK;
  int32_t key[8], image[8];
  int32_t *representative = BW_NEW0(context, int32_t, keys->code_count);
  if (!representative)
    return BW_MEMORY;
  BW_TRY(capacity(context, it, 0, 1 + (int64_t)BWI_SYMMETRIES * it->chosen_count[0]));
  it->count[0] = 0;
  add(it, 0, 0, -1, 0);
  for (int32_t k = 0; k < it->chosen_count[0]; k++) {
    int32_t fit = it->chosen[0][k];
    if (fit < 0 || fit >= keys->orbit_count || representative[keys->first[fit]])
      BW_TRY(fail(context, 0, "a fit that there is not, or twice"));
    bwi_key_of(keys->base, keys->first[fit], key);
    for (int s = 0; s < BWI_SYMMETRIES; s++) {
      bwi_symmetry_key(s, 8, key, image);
      int32_t code = bwi_key_code(keys->base, image);
      if (representative[code])
        continue;
      representative[code] = it->count[0];
      add(it, 0, code, k, s);
    }
  }
  if (it->count[0] > BWI_MAX_REPRESENTATIVES + 1)
    BW_TRY(fail(context, 0, "too many"));
  it->turned = BW_NEW0(context, uint16_t, (int64_t)it->count[0] * BWI_SYMMETRIES);
  it->flipped[0] = BW_NEW0(context, uint16_t, (int64_t)it->count[0] * BWI_FLIPS);
  BW_TRY_MEMORY(it->turned && it->flipped[0]);
  for (int32_t r = 0; r < it->count[0]; r++) {
    bwi_key_of(keys->base, it->code[0][r], key);
    for (int s = 0; s < BWI_SYMMETRIES; s++) {
      bwi_symmetry_key(s, 8, key, image);
      uint16_t to = (uint16_t)representative[bwi_key_code(keys->base, image)];
      it->turned[(int64_t)r * BWI_SYMMETRIES + s] = to;
      if (s < BWI_FLIPS)
        it->flipped[0][r * BWI_FLIPS + s] = to;
    }
  }
done:
  bw_free(representative);
  return status;
}

int32_t bwi_pair_flipped(const bwi_levels *it, int stage, int32_t code, int flip) {
  int32_t n = it->count[stage];
  int32_t a = it->flipped[stage][code % n * BWI_FLIPS + flip];
  int32_t b = it->flipped[stage][code / n * BWI_FLIPS + flip];
  return flip >> stage & 1 ? b + n * a : a + n * b;
}

/* The smallest of its images, and the reflection that leads there and back. */
static int32_t pair_first(const bwi_levels *it, int stage, int32_t code, int *flip) {
  int32_t first = code;
  *flip = 0;
  for (int f = 1; f < BWI_FLIPS; f++) {
    int32_t image = bwi_pair_flipped(it, stage, code, f);
    if (image < first) {
      first = image;
      *flip = f;
    }
  }
  return first;
}

bw_status bwi_levels_expand_pairs(bw_context *context, bwi_levels *it, int s) {
  bw_status status = BW_OK;
  int32_t pairs = it->count[s - 1] * it->count[s - 1];
  int32_t *representative = BW_NEW0(context, int32_t, pairs);
  if (!representative)
    return BW_MEMORY;
  BW_TRY(capacity(context, it, s, 1 + (int64_t)BWI_FLIPS * it->chosen_count[s]));
  it->count[s] = 0;
  add(it, s, 0, -1, 0);
  for (int32_t k = 0; k < it->chosen_count[s]; k++) {
    int32_t pair = it->chosen[s][k];
    if (pair <= 0 || pair >= pairs || representative[pair])
      BW_TRY(fail(context, s, "a pair that there is not, or twice"));
    for (int f = 0; f < BWI_FLIPS; f++) {
      int32_t code = bwi_pair_flipped(it, s - 1, pair, f);
      if (representative[code])
        continue;
      representative[code] = it->count[s];
      add(it, s, code, k, f);
    }
  }
  if (it->count[s] > (s == 3 ? BWI_FLIPS : 1) * BWI_MAX_REPRESENTATIVES + 1)
    BW_TRY(fail(context, s, "too many"));
  it->flipped[s] = BW_NEW0(context, uint16_t, (int64_t)it->count[s] * BWI_FLIPS);
  BW_TRY_MEMORY(it->flipped[s]);
  for (int32_t r = 1; r < it->count[s]; r++)
    for (int f = 0; f < BWI_FLIPS; f++)
      it->flipped[s][r * BWI_FLIPS + f] =
          (uint16_t)representative[bwi_pair_flipped(it, s - 1, it->code[s][r], f)];
done:
  bw_free(representative);
  return status;
}

bw_status bwi_levels_items(bw_context *context, const bwi_levels *it, int stage, int32_t **item,
                           int32_t *count) {
  int32_t pairs = it->count[stage] * it->count[stage], found = 0;
  int flip;
  for (int32_t code = 1; code < pairs; code++)
    found += pair_first(it, stage, code, &flip) == code;
  *item = BW_NEW(context, int32_t, found);
  if (!*item)
    return BW_MEMORY;
  *count = 0;
  for (int32_t code = 1; code < pairs; code++)
    if (pair_first(it, stage, code, &flip) == code)
      (*item)[(*count)++] = code;
  return BW_OK;
}

bw_status bwi_levels_fill_table(bw_context *context, bwi_levels *it, int stage, int32_t count,
                                const int32_t *item, const uint16_t *representative) {
  int32_t pairs = it->count[stage] * it->count[stage];
  it->table[stage] = BW_NEW0(context, uint16_t, pairs);
  if (!it->table[stage])
    return BW_MEMORY;
  for (int32_t i = 0; i < count; i++)
    it->table[stage][item[i]] = representative[i];
  for (int32_t code = 1; code < pairs; code++) {
    int flip;
    int32_t first = pair_first(it, stage, code, &flip);
    it->table[stage][code] = it->flipped[stage + 1][it->table[stage][first] * BWI_FLIPS + flip];
  }
  return BW_OK;
}
