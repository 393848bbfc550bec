/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Choosing the representatives of level 2.
 *
 * Nothing is fitted here: cells and pairs are compared by the linear elasticity of what they are
 * made of, seen from their corners (bwi_block_stiffness). Only one pair of each set of reflected
 * ones is looked at. */
#include "metamaterial/levels.h"

#include <math.h>
#include <string.h>

typedef struct chooser {
  bw_context *context;
  bwi_levels *levels;
  const bwi_keys *keys;
  bw_solid_material *const *fit;
  int32_t representatives;
  int stage;                     /* of the representatives that are chosen */
  bwi_cover cover;               /* its items: fits, or pairs of the stage before */
  int32_t *item;                 /* codes of pairs; NULL at stage 0 */
  uint8_t *images;               /* of each item */
  double *stiffness[BWI_STAGES]; /* count x 576, of representatives */
  bool shape;                    /* stage 3: the mean is taken off features */
  uint8_t *solid[BWI_STAGES];    /* count, of representatives: without void */
  uint8_t *cells[BWI_STAGES];    /* the same: which of their cells hold something */
  uint64_t *mask;                /* the same, of this stage: what they may stand for */
} chooser;

/* Deformations that next to nothing resists (cells that hang together at an edge or a corner) count
 * as this soft against the stiffest one: how soft exactly does not matter. */
static const double softest = 1e-4;

static void to_features(const double stiffness[576], float feature[BWI_FEATURES]) {
  double wide[BWI_FEATURES], max = -HUGE_VAL;
  bwi_features(stiffness, wide);
  for (int k = 0; k < BWI_FEATURES; k++)
    max = fmax(max, wide[k]);
  for (int k = 0; k < BWI_FEATURES; k++)
    feature[k] = (float)fmax(wide[k], max + log(softest));
}

static void take_mean_off(float feature[BWI_FEATURES]) {
  double mean = 0;
  for (int k = 0; k < BWI_FEATURES; k++)
    mean += feature[k] / (double)BWI_FEATURES;
  for (int k = 0; k < BWI_FEATURES; k++)
    feature[k] -= (float)mean;
}

/* Stiffness of an item in its own place. */
static void item_stiffness(const chooser *it, int32_t i, double stiffness[576]) {
  static const int32_t size[BWI_STAGES][3] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
  if (it->stage == 0) {
    bwi_material_stiffness(it->fit[i], stiffness);
    return;
  }
  int32_t n = it->levels->count[it->stage - 1], pair[2] = {it->item[i] % n, it->item[i] / n};
  const double *child[8] = {NULL};
  for (int p = 0; p < 2; p++)
    if (pair[p] > 0)
      child[p] = it->stiffness[it->stage - 1] + 576 * (int64_t)pair[p];
  bwi_block_stiffness(size[it->stage], child, stiffness);
}

/* Bits of the cells of a pair that hold something. */
static unsigned occupied(const chooser *it, int32_t pair) {
  int32_t n = it->levels->count[it->stage - 1];
  const uint8_t *cells = it->cells[it->stage - 1];
  return cells[pair % n] | (unsigned)cells[pair / n] << (1 << (it->stage - 1));
}

/* A pair may only be represented by one with void in the same cells: bits for those that are, and
 * for those that are not. */
static uint64_t occupied_mask(const chooser *it, int32_t pair) {
  unsigned bits = occupied(it, pair);
  return (uint64_t)(bits | (~bits & 255u) << 8) << BWI_FLIPS;
}

static bool is_solid(const chooser *it, int32_t i) {
  if (it->stage > 0) {
    int32_t n = it->levels->count[it->stage - 1];
    const uint8_t *solid = it->solid[it->stage - 1];
    return solid[it->item[i] % n] && solid[it->item[i] / n];
  }
  int32_t key[8];
  bwi_key_of(it->keys->base, it->keys->first[i], key);
  for (int c = 0; c < 8; c++)
    if (key[c] == 0)
      return false;
  return true;
}

/* Which symmetries of this stage take an item into itself, and how many images it has. */
static void item_symmetries(const chooser *it, int32_t i) {
  int total = it->stage == 0 ? BWI_SYMMETRIES : BWI_FLIPS, own = 0;
  int32_t key[8], image[8];
  uint64_t mask = 0;
  if (it->stage == 0)
    bwi_key_of(it->keys->base, it->keys->first[i], key);
  for (int s = 0; s < total; s++) {
    bool same;
    if (it->stage == 0) {
      bwi_symmetry_key(s, 8, key, image);
      same = memcmp(key, image, sizeof key) == 0;
    } else {
      same = bwi_pair_flipped(it->levels, it->stage - 1, it->item[i], s) == it->item[i];
    }
    mask |= same ? (uint64_t)1 << s : 0;
    own += same;
  }
  it->cover.mask[i] = mask | (is_solid(it, i) ? BWI_SOLID : 0) |
                      (it->stage > 0 ? occupied_mask(it, it->item[i]) : 0);
  it->images[i] = (uint8_t)(total / own);
}

/* Whether lookup can arrive at this pair along z exactly: of the block's images under all
 * symmetries one of its reflections comes first. */
static bool can_be_found(const bwi_levels *it, int32_t z) {
  int32_t cell[8], image[8], first[8];
  bwi_levels_cells(it, z, cell);
  memcpy(first, cell, sizeof first);
  for (int s = 1; s < BWI_SYMMETRIES; s++) {
    bwi_symmetry symmetry = bwi_symmetry_of(s);
    for (int c = 0; c < 8; c++)
      image[bwi_symmetry_octant(symmetry, c)] = it->turned[cell[c] * BWI_SYMMETRIES + s];
    int c = 0;
    while (c < 7 && image[c] == first[c])
      c++;
    if (image[c] >= first[c])
      continue;
    if (s >= BWI_FLIPS)
      return false;
    memcpy(first, image, sizeof first);
  }
  return true;
}

static bw_status measure_some(void *data, int64_t begin, int64_t end, int worker) {
  chooser *it = (chooser *)data;
  bw_status status = bw_check_cancel(it->context);
  double stiffness[576];
  (void)worker;
  for (int64_t i = begin; i < end && status == BW_OK; i++) {
    float *feature = it->cover.coordinate + BWI_FEATURES * i;
    item_stiffness(it, (int32_t)i, stiffness);
    to_features(stiffness, feature);
    if (it->shape)
      take_mean_off(feature);
    item_symmetries(it, (int32_t)i);
    if (it->stage == 3 && !can_be_found(it->levels, it->item[i]))
      it->images[i] = UINT8_MAX; /* never chosen */
  }
  return status;
}

/* The mask of the image of an item by `s`, whose code it is: it has the symmetries s m s^-1 for
 * each m that the item has (reflections commute). */
static uint64_t image_mask(const chooser *it, uint64_t mask, int s, int32_t code) {
  uint64_t image = mask & BWI_SOLID;
  if (it->stage > 0)
    return image | (mask & 255) | occupied_mask(it, code);
  for (int m = 0; m < BWI_SYMMETRIES; m++)
    if (mask >> m & 1)
      image |= (uint64_t)1 << bwi_symmetry_after(s, bwi_symmetry_after(m, bwi_symmetry_inverse(s)));
  return image;
}

/* An item becomes chosen, and its images representatives. At stage 0 the images are those of its
 * key, found in the same order as bwi_levels_expand_cells finds them; at others those of its
 * pair. */
static bw_status choose(chooser *it, int32_t i) {
  bw_status status = BW_OK;
  bwi_levels *levels = it->levels;
  int s = it->stage, total = s == 0 ? BWI_SYMMETRIES : BWI_FLIPS, found = 0;
  int32_t seen[BWI_SYMMETRIES], key[8], image[8];
  double own[576], turned[576];
  levels->chosen[s][levels->chosen_count[s]++] = s == 0 ? i : it->item[i];
  item_stiffness(it, i, own);
  if (s == 0)
    bwi_key_of(it->keys->base, it->keys->first[i], key);
  for (int g = 0; g < total; g++) {
    int32_t code;
    float feature[BWI_FEATURES];
    bool known = false;
    if (s == 0) {
      bwi_symmetry_key(g, 8, key, image);
      code = bwi_key_code(it->keys->base, image);
    } else {
      code = bwi_pair_flipped(levels, s - 1, it->item[i], g);
    }
    for (int k = 0; k < found; k++)
      known = known || seen[k] == code;
    if (known)
      continue;
    seen[found++] = code;
    bwi_symmetry_stiffness(g, own, turned);
    memcpy(it->stiffness[s] + 576 * (int64_t)levels->count[s], turned, sizeof turned);
    it->solid[s][levels->count[s]] = (it->cover.mask[i] & BWI_SOLID) != 0;
    it->cells[s][levels->count[s]] = (uint8_t)(s == 0 ? 1 : occupied(it, code));
    to_features(turned, feature);
    if (it->shape)
      take_mean_off(feature);
    it->mask[levels->count[s]] = image_mask(it, it->cover.mask[i], g, code);
    BW_TRY(bwi_cover_add(&it->cover, feature, it->mask[levels->count[s]], levels->count[s]));
    levels->count[s]++;
  }
done:
  return status;
}

/* What is chosen first: blocks of one material alone, so that homogeneous bodies are exact. */
static bool is_uniform(const chooser *it, int32_t i) {
  if (it->stage > 0) {
    int32_t n = it->levels->count[it->stage - 1], a = it->item[i] % n;
    return a == it->item[i] / n && a >= 1 && a < it->keys->base;
  }
  int32_t key[8];
  bwi_key_of(it->keys->base, it->keys->first[i], key);
  for (int c = 1; c < 8; c++)
    if (key[c] != key[0])
      return false;
  return true;
}

/* Where representatives are too few for every pattern of void in cells, items of patterns without
 * one are represented by others. The blocks of one material can stand for everything then. */
static bw_status cover_rest(chooser *it) {
  bw_status status = BW_OK;
  bool rest = false;
  for (int32_t i = 0; i < it->cover.count; i++)
    if (it->cover.nearest[i] < 0) {
      it->cover.mask[i] &= BWI_SOLID | 255;
      rest = true;
    }
  for (int32_t r = 1; rest && r < it->levels->count[it->stage]; r++) {
    float feature[BWI_FEATURES];
    to_features(it->stiffness[it->stage] + 576 * (int64_t)r, feature);
    if (it->shape)
      take_mean_off(feature);
    BW_TRY(bwi_cover_add(&it->cover, feature, it->mask[r], r));
  }
done:
  return status;
}

static bw_status choose_all(chooser *it) {
  bw_status status = BW_OK;
  bwi_levels *levels = it->levels;
  int s = it->stage;
  /* At stage 3 what is chosen is limited, else what it becomes. */
  bool limit_images = s < 3;
  int32_t max = it->representatives, images = s == 0 ? BWI_SYMMETRIES : BWI_FLIPS;
  static const char *const name[] = {"representatives of cells", "pairs along x", "pairs along y",
                                     "pairs along z"};
  levels->chosen[s] = BW_NEW(it->context, int32_t, max);
  int64_t capacity = 1 + (int64_t)max * (limit_images ? 1 : images);
  it->stiffness[s] = BW_NEW0(it->context, double, 576 * capacity);
  it->solid[s] = BW_NEW0(it->context, uint8_t, capacity);
  it->cells[s] = BW_NEW0(it->context, uint8_t, capacity);
  it->mask = BW_NEW0(it->context, uint64_t, capacity);
  if (!levels->chosen[s] || !it->stiffness[s] || !it->solid[s] || !it->cells[s] || !it->mask)
    return BW_MEMORY;
  levels->count[s] = 1;
  BW_TRY(bw_parallel(it->context, it->cover.count, 64, measure_some, it));
  for (int32_t i = 0; i < it->cover.count; i++)
    if (is_uniform(it, i) && levels->count[s] <= max)
      BW_TRY(choose(it, i));
  for (;;) {
    int32_t have = limit_images ? levels->count[s] - 1 : levels->chosen_count[s];
    if (have >= max)
      break;
    int32_t left = limit_images ? max - have : images;
    /* Blocks with void are far from everything; those without are what bodies are mostly made of.
     * Every second choice is among these. */
    int32_t next = -1;
    if (levels->chosen_count[s] % 2)
      next = bwi_cover_farthest(&it->cover, BWI_SOLID, it->images, left);
    if (next < 0)
      next = bwi_cover_farthest(&it->cover, 0, it->images, left);
    if (next < 0)
      break;
    BW_TRY(bw_check_cancel(it->context));
    bw_progress(it->context, name[s], (double)have / max);
    BW_TRY(choose(it, next));
  }
  BW_TRY(cover_rest(it));
  bwi_cover_measure(&it->cover, &levels->typical[s], &levels->max[s]);
done:
  return status;
}

static bw_status assign(const chooser *it, uint16_t *representative) {
  for (int32_t i = 0; i < it->cover.count; i++) {
    if (it->cover.nearest[i] < 0)
      return bw_fail(it->context, BW_INTERNAL, "nothing stands for item %d of stage %d", (int)i,
                     it->stage);
    representative[i] = (uint16_t)it->cover.nearest[i];
  }
  return BW_OK;
}

static bw_status begin_stage(chooser *it, int stage, int32_t count) {
  bw_status status = BW_OK;
  it->stage = stage;
  BW_TRY(bwi_cover_begin(it->context, count, &it->cover));
  it->images = BW_NEW0(it->context, uint8_t, count);
  it->shape = stage == 3;
  if (!it->images)
    status = BW_MEMORY;
done:
  return status;
}

static void end_stage(chooser *it) {
  bwi_cover_clear(&it->cover);
  bw_free(it->images);
  bw_free(it->item);
  bw_free(it->mask);
  it->mask = NULL;
  it->images = NULL;
  it->item = NULL;
}

static bw_status choose_cells(chooser *it) {
  bw_status status = BW_OK;
  bwi_levels *levels = it->levels;
  int32_t count = it->keys->orbit_count;
  BW_TRY(begin_stage(it, 0, count));
  BW_TRY(choose_all(it));
  levels->nearest = BW_NEW0(it->context, uint16_t, count);
  BW_TRY_MEMORY(levels->nearest);
  BW_TRY(assign(it, levels->nearest));
  BW_TRY(bwi_levels_expand_cells(it->context, levels, it->keys));
done:
  end_stage(it);
  return status;
}

static bw_status choose_pairs(chooser *it, int stage) {
  bw_status status = BW_OK;
  bwi_levels *levels = it->levels;
  int32_t count = 0, *item = NULL;
  uint16_t *representative = NULL;
  BW_TRY(bwi_levels_items(it->context, levels, stage - 1, &item, &count));
  it->item = item;
  BW_TRY(begin_stage(it, stage, count));
  BW_TRY(choose_all(it));
  representative = BW_NEW0(it->context, uint16_t, count);
  BW_TRY_MEMORY(representative);
  BW_TRY(assign(it, representative));
  BW_TRY(bwi_levels_expand_pairs(it->context, levels, stage));
  BW_TRY(bwi_levels_fill_table(it->context, levels, stage - 1, count, item, representative));
done:
  bw_free(representative);
  end_stage(it);
  return status;
}

bw_status bwi_levels_create(bw_context *context, const bwi_keys *keys,
                            bw_solid_material *const *fit, int32_t representatives,
                            bwi_levels **out) {
  bw_status status = BW_OK;
  chooser it;
  memset(&it, 0, sizeof it);
  it.context = context;
  it.keys = keys;
  it.fit = fit;
  it.representatives = representatives;
  it.levels = BW_NEW0(context, bwi_levels, 1);
  if (!it.levels)
    return BW_MEMORY;
  BW_TRY(choose_cells(&it));
  for (int s = 1; s < BWI_STAGES; s++)
    BW_TRY(choose_pairs(&it, s));
  *out = it.levels;
  it.levels = NULL;
done:
  for (int s = 0; s < BWI_STAGES; s++)
    bw_free(it.stiffness[s]);
  for (int s = 0; s < BWI_STAGES; s++)
    bw_free(it.solid[s]);
  for (int s = 0; s < BWI_STAGES; s++)
    bw_free(it.cells[s]);
  bwi_levels_destroy(it.levels);
  return status;
}
