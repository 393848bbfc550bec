/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building a library: a fit for each orbit of keys, then, for level 2, one for each representative.
 *
 * Every fit depends on its block, the options and a seed made of its key alone, and is rounded as
 * it is packed. So neither threads nor kills nor the order of a checkpoint show in the result. */
#include <string.h>

#include "metamaterial/library.h"

typedef struct builder {
  bw_context *context;
  bw_library *library;
  bwi_checkpoint *checkpoint; /* may be NULL */
  int level;
  int32_t todo_count, *todo; /* fits that the checkpoint did not have */
  int32_t done;              /* of this level; atomic */
  int workers;
  bwi_fit_workspace **workspace; /* workers; made at first use */
  double before, start;          /* seconds of earlier runs; when this one began */
} builder;

/* ---- one fit -------------------------------------------------------------------------------- */

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

static bw_status make_block(builder *it, int32_t fit, bwi_block *block,
                            bw_solid_material *owned[8]) {
  const bw_library *library = it->library;
  block->size[0] = block->size[1] = block->size[2] = 2;
  if (it->level == 1) {
    int32_t key[8];
    bwi_key_of(library->inner->keys->base, library->inner->keys->first[fit], key);
    for (int c = 0; c < 8; c++)
      block->child[c] = library->palette->material[key[c]];
    return BW_OK;
  }
  bw_status status = bwi_level2_block(it->context, library, fit, owned);
  for (int c = 0; c < 8; c++)
    block->child[c] = owned[c];
  return status;
}

/* Keep a fit as it reads back from its bytes. */
static bw_status keep(builder *it, int32_t fit, const bwi_pack *packed) {
  bw_library *library = it->library;
  bwi_unpack from = {
      it->context, "a new fit", "bytes", packed->bytes, packed->bytes + packed->count, false};
  return bwi_unpack_fit(&from, it->level, fit, &library->inner->fit[it->level - 1][fit],
                        &library->inner->error[it->level - 1][fit]);
}

static bw_status fit_one(builder *it, int32_t fit, bwi_fit_workspace *workspace) {
  bw_status status = BW_OK;
  bwi_block block;
  bw_solid_material *owned[8] = {NULL}, *material = NULL;
  bw_fit_error error;
  bwi_pack packed;
  bwi_pack_begin(&packed, it->context);
  BW_TRY(make_block(it, fit, &block, owned));
  BW_TRY(bwi_fit(it->context, &block, &it->library->options, seed_of(it->library, it->level, fit),
                 workspace, &material, &error));
  bwi_pack_fit(&packed, material, &error);
  BW_TRY(packed.status);
  BW_TRY(keep(it, fit, &packed));
  if (it->checkpoint)
    BW_TRY(bwi_checkpoint_add(it->context, it->checkpoint, it->level, fit, NULL,
                              it->before + bw_seconds() - it->start, &packed));
done:
  bwi_pack_clear(&packed);
  bw_release(material);
  for (int c = 0; c < 8; c++)
    bw_release(owned[c]);
  return status;
}

static bw_status fit_some(void *data, int64_t begin, int64_t end, int worker) {
  builder *it = (builder *)data;
  bw_status status = BW_OK;
  static const char *const stage[] = {"fits of level 1", "fits of level 2"};
  for (int64_t i = begin; i < end; i++) {
    BW_TRY(bw_check_cancel(it->context));
    if (!it->workspace[worker])
      BW_TRY(bwi_fit_workspace_create(it->context, &it->library->options, &it->workspace[worker]));
    BW_TRY(fit_one(it, it->todo[i], it->workspace[worker]));
    int32_t done = __atomic_add_fetch(&it->done, 1, __ATOMIC_RELAXED);
    if (worker == 0) /* the caller's thread */
      bw_progress(it->context, stage[it->level - 1],
                  (double)done / it->library->fit_count[it->level - 1]);
  }
done:
  return status;
}

static bw_status fit_level(builder *it, int level) {
  bw_library *library = it->library;
  bw_solid_material *const *fit = library->inner->fit[level - 1];
  int32_t count = library->fit_count[level - 1];
  it->level = level;
  it->todo_count = 0;
  bw_free(it->todo);
  it->todo = BW_NEW(it->context, int32_t, count);
  if (!it->todo)
    return BW_MEMORY;
  for (int32_t f = 0; f < count; f++)
    if (!fit[f])
      it->todo[it->todo_count++] = f;
  it->done = count - it->todo_count;
  return bw_parallel(it->context, it->todo_count, 1, fit_some, it);
}

/* ---- checkpoints ------------------------------------------------------------------------------
 */

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
  bw_context *context = to->it->context;
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
  BW_TRY(bwi_levels_create(it->context, inner->keys, inner->fit[0],
                           library->options.representatives, &inner->levels));
  BW_TRY(bwi_library_room(it->context, library, 2, inner->levels->chosen_count[3]));
  for (size_t f = 0; f < second->count && f < (size_t)library->fit_count[1]; f++) {
    inner->fit[1][f] = second->fit[f];
    inner->error[1][f] = second->error[f];
    second->fit[f] = NULL;
  }
done:
  return status;
}

bw_status bw_library_build(bw_context *context, const bw_palette *palette,
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
  it.context = context;
  it.start = bw_seconds();
  to.it = &it;
  BW_TRY(bwi_library_begin(context, palette, &options, &library));
  it.library = library;
  it.workers = bw_threads(context);
  it.workspace = BW_NEW0(context, bwi_fit_workspace *, it.workers);
  if (!it.workspace) {
    status = BW_MEMORY;
    goto done;
  }
  if (checkpoint)
    BW_TRY(bwi_checkpoint_open(context, checkpoint, palette, &options, take, &to, &it.before,
                               &it.checkpoint));
  if (options.levels > 0)
    BW_TRY(fit_level(&it, 1));
  if (options.levels == 2) {
    BW_TRY(begin_level2(&it, &to.second));
    BW_TRY(fit_level(&it, 2));
  }
  library->seconds = it.before + bw_seconds() - it.start;
  *out = library;
  library = NULL;
done:
  bwi_checkpoint_close(it.checkpoint);
  for (int w = 0; it.workspace && w < it.workers; w++)
    bwi_fit_workspace_free(it.workspace[w]);
  bw_free(it.workspace);
  bw_free(it.todo);
  for (size_t f = 0; f < to.second.count; f++)
    bw_release(to.second.fit[f]);
  bw_free(to.second.fit);
  bw_free(to.second.error);
  bw_release(library);
  return status;
}
