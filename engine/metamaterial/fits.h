/* Fits of many blocks on all threads: what building and growing a library share. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_METAMATERIAL_FITS_H
#define BWI_METAMATERIAL_FITS_H

#include "metamaterial/library.h"

/* Block `which`: its eight children, of which `owned` gets those to be released, and the seed of
 * its samples. Called from any thread. */
typedef bw_status (*bwi_fits_block)(void *data, int32_t which, bwi_block *block,
                                    bw_solid_material *owned[8], uint64_t *seed);

typedef struct bwi_fits {
  bw_context *context;
  const bw_library *library;
  bwi_checkpoint *checkpoint; /* may be NULL */
  double before, start;       /* seconds of earlier runs; when this one began */
  bwi_fits_block block;
  void *data;
  int workers;
  bwi_fit_workspace **workspace; /* workers; made at first use */
} bwi_fits;

/* Fields of the library's own are filled in by the caller; what was made here is freed by clear. */
bw_status bwi_fits_begin(bw_context *context, bwi_fits_block block, void *data, bwi_fits *fits);
void bwi_fits_clear(bwi_fits *fits);

/* Fills what is NULL of fit[count], and its error. keys: those of the blocks, which then name them
 * in the checkpoint, `width` bytes each; NULL: their numbers do. */
bw_status bwi_fits_run(bwi_fits *fits, int level, const char *stage, int32_t count,
                       const uint8_t *keys, int32_t width, bw_solid_material **fit,
                       bw_fit_error *error);

#endif
