/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From level 1 to level 2: representatives, and tables of pairs of them. */
#ifndef BWI_METAMATERIAL_LEVELS_H
#define BWI_METAMATERIAL_LEVELS_H

#include "metamaterial/internal.h"
#include "metamaterial/keys.h"

/* Stage 0 stands for single cells (fits of level 1, turned), 1 for two of them along x, 2 for two
 * of these along y, 3 for two of these along z: blocks of eight cells. Each stage has `count`
 * representatives; number 0 is void alone. They are images of the items that were `chosen`: at
 * stage 0 all 48 of each, at the others those under the eight reflections of axes, which keep the
 * axis of the pairs. Reflection f flips the axes whose bits are set, and is symmetry number f.
 *
 * A pair (a, b) of stage s has the code a + count[s] b. Reflections take pairs to pairs; that of
 * smallest code stands for the others, and the table is made so that the representative of a
 * reflected pair is the reflected representative. */
enum { BWI_STAGES = 4, BWI_FLIPS = 8, BWI_MAX_REPRESENTATIVES = 4000 };
typedef struct bwi_levels {
  int32_t chosen_count[BWI_STAGES], count[BWI_STAGES];
  int32_t *chosen[BWI_STAGES];   /* stage 0: fits of level 1; others: codes of pairs */
  int32_t *code[BWI_STAGES];     /* count: stage 0: code of the key; others: of the pair */
  int32_t *origin[BWI_STAGES];   /* count: which of the chosen, -1 for void */
  uint8_t *how[BWI_STAGES];      /* count: the symmetry that makes it of that */
  uint16_t *turned;              /* count[0] x 48: stage 0, under all symmetries */
  uint16_t *flipped[BWI_STAGES]; /* count x 8: under reflections */
  uint16_t *nearest;             /* fits of level 1: representative of the first key */
  uint16_t *table[3];            /* count[s] squared: pairs of stage s to stage s + 1 */
  float typical[BWI_STAGES];     /* root mean square over items of their distance to what stands for
                                    them, itself the root mean square of logarithms of energies */
  float max[BWI_STAGES];         /* the largest */
} bwi_levels;

void bwi_levels_destroy(bwi_levels *levels);
/* Chooses the representatives of all stages, from the fits of level 1 (one for each orbit): up to
 * `representatives` at stages 0 to 2, and so many chosen, to be fitted, at stage 3. */
bw_status bwi_levels_create(bw_context *context, const bwi_keys *keys,
                            bw_solid_material *const *fit, int32_t representatives,
                            bwi_levels **levels);

/* Which fit of level 2 stands for a block of 64 fine materials (not all void), and the symmetry
 * that turns it. Of the block's 48 images the one whose representatives come first in order is
 * looked up, pairs along x, y, z, so that the block's images have the images of its material. */
typedef struct bwi_level2 {
  int32_t fit;
  int symmetry;
} bwi_level2;
bwi_level2 bwi_levels_find(const bwi_levels *levels, const bwi_keys *keys, const int32_t key[64]);
/* The representatives of stage 0 in a pair along z, by its code. */
void bwi_levels_cells(const bwi_levels *levels, int32_t z, int32_t cell[8]);
/* The same of the block that fit f of level 2 is of. */
void bwi_levels_block(const bwi_levels *levels, int32_t fit, int32_t cell[8]);

/* ---- making them, also from a file (levels_expand.c) ----------------------------------------- */

/* The image of a pair of stage s under a reflection. */
int32_t bwi_pair_flipped(const bwi_levels *levels, int stage, int32_t code, int flip);
/* Everything of a stage's representatives that follows from what was chosen. BW_FORMAT, with the
 * reason, where that is impossible (files). */
bw_status bwi_levels_expand_cells(bw_context *context, bwi_levels *levels, const bwi_keys *keys);
bw_status bwi_levels_expand_pairs(bw_context *context, bwi_levels *levels, int stage);
/* The codes of the pairs of stage s that stand for others, ascending, without that of void. */
bw_status bwi_levels_items(bw_context *context, const bwi_levels *levels, int stage, int32_t **item,
                           int32_t *count);
/* The table of pairs of stage s, from what stands for the items. */
bw_status bwi_levels_fill_table(bw_context *context, bwi_levels *levels, int stage, int32_t count,
                                const int32_t *item, const uint16_t *representative);

/* ---- farthest-point sampling (compress.c) ------------------------------------------------------
 *
 * Items with BWI_FEATURES coordinates are covered by representatives, which come one by one. A
 * representative may stand for an item only if it has all bits of the item's `mask`. They are its
 * symmetries: else a symmetric item would be given one of several that are each other's images, and
 * the choice would not be symmetric. And whether it is without void. */
#define BWI_SOLID ((uint64_t)1 << 63)
typedef struct bwi_cover {
  bw_context *context;
  int32_t count;
  float *coordinate; /* count x BWI_FEATURES */
  uint64_t *mask;    /* count */
  float *distance;   /* count: squared, to the nearest so far; infinite at first */
  int32_t *nearest;  /* count: that representative, -1 at first */
} bwi_cover;
bw_status bwi_cover_begin(bw_context *context, int32_t count, bwi_cover *cover);
void bwi_cover_clear(bwi_cover *cover);
bw_status bwi_cover_add(bwi_cover *cover, const float coordinate[BWI_FEATURES], uint64_t mask,
                        int32_t representative);
/* The item farthest from all representatives among those that have the bits of `mask` and at most
 * `available` images (`images` may be NULL: any number); -1 when all such are at distance 0. Ties
 * go to the lower number. */
int32_t bwi_cover_farthest(const bwi_cover *cover, uint64_t mask, const uint8_t *images,
                           int32_t available);
/* Root mean square and largest distance, over the number of features. */
void bwi_cover_measure(const bwi_cover *cover, float *typical, float *max);

#endif
