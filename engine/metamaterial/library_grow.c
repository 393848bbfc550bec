/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Growing a library for a grid: fits for the blocks that occur there and have none of their own.
 *
 * First the blocks of 2 x 2 x 2 that are not in the library, since blocks of 4 x 4 x 4 are made of
 * their fits; then these. fits.c runs them; a seed is made of its block alone, so that other blocks
 * do not show in a fit. */
#include <stdlib.h>
#include <string.h>

#include "metamaterial/coarse.h"
#include "metamaterial/fits.h"

typedef struct grower {
  int level;
  bwi_grown added[2]; /* of each level; fits that the checkpoint did not have are NULL */
  bwi_fits fits; /* its library is that which the blocks of this level are made of: all cells */
} grower;

/* ---- what is missing ------------------------------------------------------------------------ */

static int by_key_8(const void *a, const void *b) {
  return bwi_key_compare(8, (const uint8_t *)a, (const uint8_t *)b);
}

static int by_key_64(const void *a, const void *b) {
  return bwi_key_compare(64, (const uint8_t *)a, (const uint8_t *)b);
}

static int32_t sort_unique(int32_t width, uint8_t *key, int32_t count) {
  size_t w = (size_t)width;
  int32_t kept = 0;
  if (count > 0)
    qsort(key, (size_t)count, w, width == 8 ? by_key_8 : by_key_64);
  for (int32_t i = 0; i < count; i++)
    if (i == 0 || bwi_key_compare(width, key + w * (size_t)(kept - 1), key + w * (size_t)i) != 0) {
      memmove(key + w * (size_t)kept, key + w * (size_t)i, w);
      kept++;
    }
  return kept;
}

static bool has(const bw_library *library, int level, const uint8_t *first) {
  int32_t key[64];
  int symmetry;
  for (int p = 0; p < (level == 1 ? 8 : 64); p++)
    key[p] = first[p];
  return level == 1 ? bwi_library_cell(library, key, &symmetry) != NULL
                    : bwi_library_has_block(library, key);
}

/* The distinct blocks of a grid, turned first, that the library has no fit for. */
static bw_status find_missing(grower *it, const bw_grid *fine,
                              const bw_coarsening *const *coarsening) {
  bw_status status = BW_OK;
  const int32_t width = it->level == 1 ? 8 : 64,
                elements = coarsening[it->level - 1]->coarse->element_count;
  size_t w = (size_t)width;
  int32_t count = 0;
  uint8_t *key = BW_NEW(it->fits.context, uint8_t, (int64_t)width * elements), own[64];
  bwi_fine_block block;
  if (!key)
    return BW_MEMORY;
  for (int32_t e = 0; e < elements; e++) {
    if (e % 4096 == 0)
      BW_TRY(bw_check_cancel(it->fits.context));
    bwi_block_gather(fine, coarsening, it->level, e, &block);
    for (int32_t p = 0; p < width; p++)
      own[p] = (uint8_t)block.key[p];
    bwi_key_first(width, own, key + w * (size_t)e);
  }
  count = sort_unique(width, key, elements);
  int32_t missing = 0;
  for (int32_t i = 0; i < count; i++)
    if (!has(it->fits.library, it->level, key + w * (size_t)i)) {
      memmove(key + w * (size_t)missing, key + w * (size_t)i, w);
      missing++;
    }
  BW_TRY(bwi_grown_reserve(it->fits.context, width, missing, &it->added[it->level - 1]));
  if (missing > 0)
    memcpy(it->added[it->level - 1].key, key, w * (size_t)missing);
done:
  bw_free(key);
  return status;
}

/* ---- fits ----------------------------------------------------------------------------------- */

/* Children are materials of the material table, or fits of level 1, turned. */
static bw_status make_block(void *data, int32_t entry, bwi_block *block,
                            bw_solid_material *owned[8], uint64_t *seed) {
  bw_status status = BW_OK;
  const grower *it = (const grower *)data;
  const bwi_grown *added = &it->added[it->level - 1];
  const uint8_t *key = added->key + (size_t)added->width * (size_t)entry;
  const bw_library *library = it->fits.library;
  int32_t base = library->inner->keys->base, cell[8], code[8];
  for (int c = 0; c < 8; c++) {
    for (int p = 0; p < 8; p++)
      cell[p] = it->level == 1 ? key[p] : key[8 * c + p];
    code[c] = bwi_key_code(base, cell);
    if (it->level == 2 && code[c] > 0) {
      int symmetry = 0;
      const bw_solid_material *fit = bwi_library_cell(library, cell, &symmetry);
      BW_TRY(bwi_material_transformed(it->fits.context, fit, symmetry, &owned[c]));
    }
    block->child[c] = it->level == 1 ? library->material_table->material[key[c]] : owned[c];
  }
  *seed = bwi_fit_seed(library, it->level, code);
done:
  return status;
}

/* ---- checkpoints ----------------------------------------------------------------------------- */

static bw_status take(void *data, int level, int32_t fit, const uint8_t *key,
                      bw_solid_material *material, const bw_fit_error *error) {
  grower *it = (grower *)data;
  bwi_grown *added = &it->added[level - 1];
  (void)fit;
  if (!key) {
    bw_release(material);
    return bw_fail(it->fits.context, BW_INVALID,
                   "the checkpoint is of a library that is being built, not grown: name another "
                   "file");
  }
  int32_t entry = level == it->level ? bwi_grown_find(added, key) : -1;
  if (entry < 0 || added->fit[entry]) { /* of another grid, or twice */
    bw_release(material);
    return BW_OK;
  }
  added->fit[entry] = material;
  added->error[entry] = *error;
  return BW_OK;
}

/* ---- levels --------------------------------------------------------------------------------- */

static bw_status grow_level(grower *it, int level, const bw_grid *fine,
                            const bw_coarsening *const *coarsening, const char *checkpoint) {
  static const char *const stage[] = {"blocks of level 1", "blocks of level 2"};
  bw_status status = BW_OK;
  bwi_grown *added = &it->added[level - 1];
  it->level = level;
  BW_TRY(find_missing(it, fine, coarsening));
  if (added->count == 0)
    return BW_OK;
  if (checkpoint)
    BW_TRY(bwi_checkpoint_open(it->fits.context, checkpoint, it->fits.library->material_table,
                               &it->fits.library->options, take, it, &it->fits.before,
                               &it->fits.checkpoint));
  BW_TRY(bwi_fits_run(&it->fits, level, stage[level - 1], added->count, added->key, added->width,
                      added->fit, added->error));
done:
  bwi_checkpoint_close(it->fits.checkpoint);
  it->fits.checkpoint = NULL;
  return status;
}

/* The library with what was fitted so far. */
static bw_status join(grower *it, bw_library **out) {
  bw_status status = BW_OK;
  const bwi_library *inner = it->fits.library->inner;
  bwi_grown grown[2] = {{0}};
  for (int l = 0; l < 2; l++) {
    it->added[l].width = l == 0 ? 8 : 64;
    BW_TRY(bwi_grown_join(it->fits.context, &inner->grown[l], &it->added[l], &grown[l]));
  }
  BW_TRY(bwi_library_with(it->fits.context, it->fits.library, grown, out));
done:
  for (int l = 0; l < 2; l++)
    bwi_grown_clear(&grown[l]);
  return status;
}

bw_status bw_library_grow(bw_context *context, const bw_library *library,
                          const bw_material_table *material_table, const bw_grid *fine, int levels,
                          const char *checkpoint, bw_library **out) {
  bw_status status = BW_OK;
  bw_library *with_cells = NULL, *grown = NULL;
  bw_coarsening *coarsening[2] = {NULL};
  grower it;
  memset(&it, 0, sizeof it);
  if (levels < 1 || levels > 2)
    return bw_fail(context, BW_INVALID, "growing for %d levels: 1 or 2 expected", levels);
  BW_TRY(bwi_coarse_check(context, library, material_table, fine));
  BW_TRY(bwi_fits_begin(context, make_block, &it, &it.fits));
  it.fits.library = library;
  for (int l = 0; l < levels; l++)
    BW_TRY(bw_coarsening_create(context, l ? coarsening[0]->coarse : fine, &coarsening[l]));
  BW_TRY(grow_level(&it, 1, fine, (const bw_coarsening *const *)coarsening, checkpoint));
  if (levels == 2) {
    BW_TRY(join(&it, &with_cells));
    bwi_grown_clear(&it.added[0]);
    it.fits.library = with_cells;
    BW_TRY(grow_level(&it, 2, fine, (const bw_coarsening *const *)coarsening, checkpoint));
  }
  BW_TRY(join(&it, &grown));
  grown->seconds = it.fits.before + bw_seconds() - it.fits.start;
  *out = grown;
done:
  bwi_fits_clear(&it.fits);
  for (int l = 0; l < 2; l++) {
    bwi_grown_clear(&it.added[l]);
    bw_release(coarsening[l]);
  }
  bw_release(with_cells);
  return status;
}
