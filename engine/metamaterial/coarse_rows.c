/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials of blocks by their keys: an open hash, whose slots hold ids.
 *
 * Invariants: key id - 1 is that of material id - 1; a key whose first entry is -1 (of a block with
 * partial cells) is in no slot; slots are a power of two, at least twice the materials. */
#include <string.h>

#include "metamaterial/coarse.h"

static size_t hash(const int32_t *key, int32_t width) {
  uint64_t h = 0x9e3779b97f4a7c15u;
  for (int32_t i = 0; i < width; i += 2) {
    h ^= (uint32_t)key[i] | (uint64_t)(uint32_t)key[i + 1] << 32;
    h *= 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  return (size_t)h;
}

/* The slot that holds this key's id, or the free one where it belongs. */
static int32_t *find(const bwi_rows *it, const int32_t *key) {
  size_t at = hash(key, it->width);
  for (;; at++) {
    int32_t *slot = &it->slot[at & (it->slots - 1)];
    if (!*slot || memcmp(it->key + (size_t)it->width * (size_t)(*slot - 1), key,
                         (size_t)it->width * sizeof *key) == 0)
      return slot;
  }
}

static bw_status make_slots(bwi_rows *it, size_t slots) {
  int32_t *larger = BW_NEW0(it->context, int32_t, slots);
  if (!larger)
    return BW_MEMORY;
  bw_free(it->slot);
  it->slot = larger;
  it->slots = slots;
  for (int32_t id = 1; id <= it->count; id++) {
    const int32_t *key = it->key + (size_t)it->width * (size_t)(id - 1);
    if (key[0] >= 0)
      *find(it, key) = id;
  }
  return BW_OK;
}

static bw_status add(bwi_rows *it, const bw_solid_material *material, const int32_t *key) {
  size_t n = (size_t)it->count, w = (size_t)it->width;
  if (!bw_grow(it->context, (void **)&it->material, &it->material_capacity, n, 1,
               sizeof *it->material) ||
      !bw_grow(it->context, (void **)&it->key, &it->key_capacity, n * w, w, sizeof *it->key))
    return BW_MEMORY;
  it->material[n] = (const bw_solid_material *)bw_retain(material);
  memcpy(it->key + n * w, key, w * sizeof *key);
  it->count++;
  return BW_OK;
}

bw_status bwi_rows_begin(bwi_rows *it, bw_context *context, const bwi_coarse_maker *maker,
                         const bw_coarse *before) {
  bw_status status = BW_OK;
  memset(it, 0, sizeof *it);
  it->context = context;
  it->maker = maker;
  it->width = maker->rule->count;
  size_t slots = 64;
  for (int32_t r = 1; before && r < before->material_table->count; r++)
    BW_TRY(add(it, before->material_table->material[r],
               before->inner->key + (size_t)it->width * (size_t)(r - 1)));
  while (slots < 4 * (size_t)it->count)
    slots *= 2;
  BW_TRY(make_slots(it, slots));
done:
  return status;
}

void bwi_rows_clear(bwi_rows *it) {
  for (int32_t i = 0; i < it->count; i++)
    bw_release(it->material[i]);
  bw_free((void *)it->material);
  bw_free(it->key);
  bw_free(it->slot);
}

/* The id of a block's material, made where it is new. */
bw_status bwi_rows_of(bwi_rows *it, bwi_fine_block *block, int32_t *id) {
  bw_status status = BW_OK;
  bw_solid_material *material = NULL;
  int32_t *slot = NULL;
  if (!block->partial) {
    slot = find(it, block->key);
    *id = *slot;
    if (*id)
      return BW_OK;
  }
  if (it->maker->method == BW_COARSE_LOOKUP)
    BW_TRY(bwi_lookup_material(it->context, it->maker, block, &material));
  else
    BW_TRY(bwi_baseline_material(it->context, it->maker, block, &material));
  if (block->partial)
    block->key[0] = -1;
  BW_TRY(add(it, material, block->key));
  *id = it->count;
  if (slot)
    *slot = it->count;
  if (2 * (size_t)it->count > it->slots)
    BW_TRY(make_slots(it, 2 * it->slots));
done:
  bw_release(material);
  return status;
}
