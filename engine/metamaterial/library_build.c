/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building a library: a fit for each orbit of keys, then, for level 2, one for each representative.
 * fits.c runs them. */
#include <string.h>

#include "metamaterial/fits.h"

typedef struct builder {
  bw_library *library;
  int level;
  bwi_fits fits;
} builder;

/* ---- fits ----------------------------------------------------------------------------------- */

static uint64_t seed_of(const bw_library *library, int level, int32_t fit) {
  if (level == 1)
    return bwi_fit_seed(library, 1, &library->inner->keys->first[fit]);
  int32_t cell[8], code[8];
  const bwi_levels *levels = library->inner->levels;
  bwi_levels_block(levels, fit, cell);
  for (int c = 0; c < 8; c++)
    code[c] = levels->code[0][cell[c]];
  return bwi_fit_seed(library, 2, code);
}

static bw_status make_block(void *data, int32_t fit, bwi_block *block, bw_solid_material *owned[8],
                            uint64_t *seed) {
  const builder *it = (const builder *)data;
  const bw_library *library = it->library;
  *seed = seed_of(library, it->level, fit);
  if (it->level == 1) {
    int32_t key[8];
    bwi_key_of(library->inner->keys->base, library->inner->keys->first[fit], key);
    for (int c = 0; c < 8; c++)
      block->child[c] = library->material_table->material[key[c]];
    return BW_OK;
  }
  bw_status status = bwi_level2_block(it->fits.context, library, fit, owned);
  for (int c = 0; c < 8; c++)
    block->child[c] = owned[c];
  return status;
}

static bw_status fit_level(builder *it, int level) {
  static const char *const stage[] = {"fits of level 1", "fits of level 2"};
  bw_library *library = it->library;
  it->level = level;
  return bwi_fits_run(&it->fits, level, stage[level - 1], library->fit_count[level - 1], NULL, 0,
                      library->inner->fit[level - 1], library->inner->error[level - 1]);
}

/* ---- checkpoints --------------------------------------------------------------------------- */

/* Fits of level 2 are kept aside until it is known how many there are. */
typedef struct later {
  bw_solid_material **fit;
  bw_fit_error *error;
  size_t count, fit_capacity, error_capacity;
} later;

typedef struct taker {
  builder *it;
  later second;
} taker;

static bw_status take(void *data, int level, int32_t fit, const uint8_t *key,
                      bw_solid_material *material, const bw_fit_error *error) {
  taker *to = (taker *)data;
  bw_library *library = to->it->library;
  bw_context *context = to->it->fits.context;
  later *second = &to->second;
  if (key) {
    bw_release(material);
    return bw_fail(context, BW_INVALID,
                   "the checkpoint is of a library that was grown for a grid: name another file");
  }
  if (level == 1) {
    if (fit >= library->fit_count[0]) {
      bw_release(material);
      return bw_fail(context, BW_FORMAT, "the checkpoint has a fit %d of level 1; there are %d",
                     (int)fit + 1, (int)library->fit_count[0]);
    }
    bw_release(library->inner->fit[0][fit]);
    library->inner->fit[0][fit] = material;
    library->inner->error[0][fit] = *error;
    return BW_OK;
  }
  size_t extra = (size_t)fit < second->count ? 0 : (size_t)fit + 1 - second->count;
  if (fit >= library->options.representatives || library->levels < 2 ||
      !bw_grow(context, (void **)&second->fit, &second->fit_capacity, second->count, extra,
               sizeof *second->fit) ||
      !bw_grow(context, (void **)&second->error, &second->error_capacity, second->count, extra,
               sizeof *second->error)) {
    bw_release(material);
    if (fit >= library->options.representatives || library->levels < 2)
      return bw_fail(context, BW_FORMAT, "the checkpoint has a fit %d of level 2", (int)fit + 1);
    return BW_MEMORY;
  }
  for (; extra > 0; extra--)
    second->fit[second->count++] = NULL;
  bw_release(second->fit[fit]);
  second->fit[fit] = material;
  second->error[fit] = *error;
  return BW_OK;
}

static bw_status begin_level2(builder *it, later *second) {
  bw_status status = BW_OK;
  bw_library *library = it->library;
  bwi_library *inner = library->inner;
  BW_TRY(bwi_levels_create(it->fits.context, inner->keys, inner->fit[0],
                           library->options.representatives, &inner->levels));
  BW_TRY(bwi_library_reserve(it->fits.context, library, 2, inner->levels->chosen_count[3]));
  for (size_t f = 0; f < second->count && f < (size_t)library->fit_count[1]; f++) {
    inner->fit[1][f] = second->fit[f];
    inner->error[1][f] = second->error[f];
    second->fit[f] = NULL;
  }
done:
  return status;
}

bw_status bw_library_build(bw_context *context, const bw_material_table *material_table,
                           const bw_library_options *given, const char *checkpoint,
                           bw_library **out) {
  bw_status status = BW_OK;
  bw_library_options options;
  bw_library *library = NULL;
  builder it;
  taker to;
  memset(&it, 0, sizeof it);
  memset(&to, 0, sizeof to);
  bw_library_options_default(&options);
  if (given)
    options = *given;
  to.it = &it;
  BW_TRY(bwi_fits_begin(context, make_block, &it, &it.fits));
  BW_TRY(bwi_library_begin(context, material_table, &options, &library));
  it.library = library;
  it.fits.library = library;
  if (checkpoint)
    BW_TRY(bwi_checkpoint_open(context, checkpoint, material_table, &options, take, &to,
                               &it.fits.before, &it.fits.checkpoint));
  if (options.levels > 0)
    BW_TRY(fit_level(&it, 1));
  if (options.levels == 2) {
    BW_TRY(begin_level2(&it, &to.second));
    BW_TRY(fit_level(&it, 2));
  }
  library->seconds = it.fits.before + bw_seconds() - it.fits.start;
  *out = library;
  library = NULL;
done:
  bwi_checkpoint_close(it.fits.checkpoint);
  bwi_fits_clear(&it.fits);
  for (size_t f = 0; f < to.second.count; f++)
    bw_release(to.second.fit[f]);
  bw_free(to.second.fit);
  bw_free(to.second.error);
  bw_release(library);
  return status;
}
