/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Single blocks by their keys, whatever way they are turned. */
#include "metamaterial/grown.h"

#include <string.h>

#include "metamaterial/keys.h"

int bwi_key_compare(int32_t width, const uint8_t *a, const uint8_t *b) {
  for (int32_t p = width - 1; p >= 0; p--)
    if (a[p] != b[p])
      return a[p] < b[p] ? -1 : 1;
  return 0;
}

/* Where position p of an image under a symmetry comes from, given the inverse. */
static int32_t source(int32_t width, bwi_symmetry inverse, int32_t p) {
  if (width == 8)
    return bwi_symmetry_octant(inverse, p);
  return 8 * bwi_symmetry_octant(inverse, p / 8) + bwi_symmetry_octant(inverse, p % 8);
}

int bwi_key_first(int32_t width, const uint8_t *key, uint8_t *first) {
  int best = 0; /* takes the first image to the key */
  memcpy(first, key, (size_t)width);
  for (int inverse = 1; inverse < BWI_SYMMETRIES; inverse++) {
    bwi_symmetry symmetry = bwi_symmetry_of(inverse);
    int32_t p = width - 1;
    while (p > 0 && key[source(width, symmetry, p)] == first[p])
      p--;
    if (key[source(width, symmetry, p)] >= first[p])
      continue;
    for (; p >= 0; p--)
      first[p] = key[source(width, symmetry, p)];
    best = inverse;
  }
  return best;
}

int32_t bwi_grown_find(const bwi_grown *it, const uint8_t *first) {
  int32_t low = 0, high = it->count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    int order = bwi_key_compare(it->width, it->key + (size_t)it->width * (size_t)middle, first);
    if (order == 0)
      return middle;
    if (order < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return -1;
}

bw_status bwi_grown_reserve(bw_context *context, int32_t width, int32_t count, bwi_grown *it) {
  memset(it, 0, sizeof *it);
  it->width = width;
  it->key = BW_NEW0(context, uint8_t, (int64_t)width * count);
  it->fit = BW_NEW0(context, bw_solid_material *, count);
  it->error = BW_NEW0(context, bw_fit_error, count);
  if (!it->key || !it->fit || !it->error) {
    bwi_grown_clear(it);
    return BW_MEMORY;
  }
  it->count = count;
  return BW_OK;
}

static void take(bwi_grown *to, int32_t i, const bwi_grown *from, int32_t j) {
  size_t width = (size_t)to->width;
  memcpy(to->key + width * (size_t)i, from->key + width * (size_t)j, width);
  to->fit[i] = (bw_solid_material *)bw_retain(from->fit[j]);
  to->error[i] = from->error[j];
}

bw_status bwi_grown_join(bw_context *context, const bwi_grown *a, const bwi_grown *b,
                         bwi_grown *joined) {
  size_t width = (size_t)b->width;
  bw_status status = bwi_grown_reserve(context, b->width, a->count + b->count, joined);
  for (int32_t i = 0, j = 0; status == BW_OK && i + j < joined->count;) {
    bool of_a =
        j == b->count || (i < a->count && bwi_key_compare(b->width, a->key + width * (size_t)i,
                                                          b->key + width * (size_t)j) < 0);
    take(joined, i + j, of_a ? a : b, of_a ? i : j);
    i += of_a;
    j += !of_a;
  }
  return status;
}

void bwi_grown_clear(bwi_grown *it) {
  for (int32_t i = 0; i < it->count; i++)
    bw_release(it->fit[i]);
  bw_free(it->key);
  bw_free(it->fit);
  bw_free(it->error);
  it->key = NULL;
  it->fit = NULL;
  it->error = NULL;
  it->count = 0;
}
