/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits of many blocks on all threads.
 *
 * Every fit depends on its block, the options and its seed alone, and is kept as it reads back from
 * the bytes it is packed into. So neither threads nor kills nor the order of a checkpoint show in
 * the result. */
#include "metamaterial/fits.h"

typedef struct run {
  bwi_fits *fits;
  int level;
  const char *stage;
  const uint8_t *keys;
  int32_t width, count, *todo; /* todo: what the checkpoint did not have */
  int32_t done;                /* atomic */
  bw_solid_material **fit;
  bw_fit_error *error;
} run;

bw_status bwi_fits_begin(bw_context *context, bwi_fits_block block, void *data, bwi_fits *fits) {
  *fits = (bwi_fits){.context = context, .block = block, .data = data, .start = bw_seconds()};
  fits->workers = bw_threads(context);
  fits->workspace = BW_NEW0(context, bwi_fit_workspace *, fits->workers);
  return fits->workspace ? BW_OK : BW_MEMORY;
}

void bwi_fits_clear(bwi_fits *fits) {
  for (int w = 0; fits->workspace && w < fits->workers; w++)
    bwi_fit_workspace_destroy(fits->workspace[w]);
  bw_free(fits->workspace);
  fits->workspace = NULL;
}

static bw_status fit_one(run *it, int32_t which, bwi_fit_workspace *workspace) {
  bw_status status = BW_OK;
  bwi_fits *fits = it->fits;
  bw_context *context = fits->context;
  const uint8_t *key = it->keys ? it->keys + (size_t)it->width * (size_t)which : NULL;
  bwi_block block;
  bw_solid_material *owned[8] = {NULL}, *material = NULL;
  bw_fit_error error;
  uint64_t seed;
  bwi_pack packed;
  bwi_pack_begin(&packed, context);
  block.size[0] = block.size[1] = block.size[2] = 2;
  BW_TRY(fits->block(fits->data, which, &block, owned, &seed));
  BW_TRY(bwi_fit(context, &block, &fits->library->options, seed, workspace, &material, &error));
  bwi_pack_fit(&packed, material, &error);
  BW_TRY(packed.status);
  bwi_unpack from = {context, "a new fit", "bytes", packed.bytes, packed.bytes + packed.count,
                     false};
  BW_TRY(bwi_unpack_fit(&from, it->level, which, &it->fit[which], &it->error[which]));
  if (fits->checkpoint)
    BW_TRY(bwi_checkpoint_add(context, fits->checkpoint, it->level, key ? 0 : which, key,
                              fits->before + bw_seconds() - fits->start, &packed));
done:
  bwi_pack_clear(&packed);
  bw_release(material);
  for (int c = 0; c < 8; c++)
    bw_release(owned[c]);
  return status;
}

static bw_status fit_some(void *data, int64_t begin, int64_t end, int worker) {
  run *it = (run *)data;
  bwi_fits *fits = it->fits;
  bw_status status = BW_OK;
  for (int64_t i = begin; i < end; i++) {
    BW_TRY(bw_check_cancel(fits->context));
    if (!fits->workspace[worker])
      BW_TRY(bwi_fit_workspace_create(fits->context, &fits->library->options,
                                      &fits->workspace[worker]));
    int32_t done = __atomic_load_n(&it->done, __ATOMIC_RELAXED);
    bwi_fit_workspace_report(fits->workspace[worker], it->stage, (double)done / it->count);
    BW_TRY(fit_one(it, it->todo[i], fits->workspace[worker]));
    done = __atomic_add_fetch(&it->done, 1, __ATOMIC_RELAXED);
    if (worker == 0) /* the caller's thread */
      bw_progress(fits->context, it->stage, (double)done / it->count);
  }
done:
  return status;
}

bw_status bwi_fits_run(bwi_fits *fits, int level, const char *stage, int32_t count,
                       const uint8_t *keys, int32_t width, bw_solid_material **fit,
                       bw_fit_error *error) {
  run it = {fits, level, stage, keys, width, count, NULL, 0, fit, error};
  int32_t todo_count = 0;
  it.todo = BW_NEW(fits->context, int32_t, count);
  if (!it.todo)
    return BW_MEMORY;
  for (int32_t i = 0; i < count; i++)
    if (!fit[i])
      it.todo[todo_count++] = i;
  it.done = count - todo_count;
  bw_status status = bw_parallel(fits->context, todo_count, 1, fit_some, &it);
  if (status == BW_OK)
    bw_progress(fits->context, stage, 1); /* even where other threads did all of it */
  bw_free(it.todo);
  return status;
}
