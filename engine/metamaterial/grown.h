/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits of single blocks that a library has beside those that it was built of. */
#ifndef BWI_METAMATERIAL_GROWN_H
#define BWI_METAMATERIAL_GROWN_H

#include "metamaterial/internal.h"

/* Blocks of 8 or 64 fine materials (`width`). Of the 48 images of a block under the symmetries of
 * the cube the one whose key comes first stands for all, numbers compared from the last one back,
 * so that keys of 8 come in the order of their codes. Entries are in this order, no two alike. */
typedef struct bwi_grown {
  int32_t width, count;
  uint8_t *key;            /* count x width */
  bw_solid_material **fit; /* count; NULL while they are made */
  bw_fit_error *error;     /* count */
} bwi_grown;

/* The first image of a key, and the symmetry that takes it to the key. */
int bwi_key_first(int32_t width, const uint8_t *key, uint8_t *first);
/* Order of two keys: negative, zero, positive. */
int bwi_key_compare(int32_t width, const uint8_t *a, const uint8_t *b);
/* The entry of a first image, or -1. */
int32_t bwi_grown_find(const bwi_grown *grown, const uint8_t *first);
/* The entries of both, which have no key in common; fits are retained. */
bw_status bwi_grown_join(bw_context *context, const bwi_grown *a, const bwi_grown *b,
                         bwi_grown *joined);
/* Room for `count` entries without fits. */
bw_status bwi_grown_reserve(bw_context *context, int32_t width, int32_t count, bwi_grown *grown);
void bwi_grown_clear(bwi_grown *grown);

#endif
