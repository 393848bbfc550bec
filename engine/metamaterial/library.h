/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What is inside a library, and how it becomes bytes. */
#ifndef BWI_METAMATERIAL_LIBRARY_H
#define BWI_METAMATERIAL_LIBRARY_H

#include "metamaterial/grown.h"
#include "metamaterial/internal.h"
#include "metamaterial/keys.h"
#include "metamaterial/levels.h"

typedef struct bwi_library {
  bwi_keys *keys;             /* of level 1; fit f of level 1 is orbit f, where there are any */
  bw_solid_material **fit[2]; /* fit_count; entries may be NULL while building */
  bw_fit_error *error[2];     /* fit_count */
  bwi_levels *levels;         /* NULL: built of one level at most */
  bwi_grown grown[2];         /* of level 1 and 2 */
  const bw_library *of;       /* NULL, or retained: whose keys, fits, errors and levels these are */
} bwi_library;

/* A library without fits, its keys numbered. Material table, options and key limits
 * are checked. */
bw_status bwi_library_begin(bw_context *context, const bw_material_table *material_table,
                            const bw_library_options *options, bw_library **library);
/* Room for `count` fits of a level, all NULL. */
bw_status bwi_library_reserve(bw_context *context, bw_library *library, int level, int32_t count);
/* A library with the fits of another, and `grown` beside, which it takes over. */
bw_status bwi_library_with(bw_context *context, const bw_library *of, bwi_grown grown[2],
                           bw_library **library);
/* After `grown` was set: what the public fields say of it. */
void bwi_library_show(bw_library *library);
/* The fit of level 1 of a key, and the symmetry that turns it there; NULL where there is none. */
const bw_solid_material *bwi_library_cell(const bw_library *library, const int32_t key[8],
                                          int *symmetry);
/* A block of 64 is one of those that were fitted, as built or grown. */
bool bwi_library_has_block(const bw_library *library, const int32_t key[64]);
/* What the random loads on a block are drawn from: `code` of its one or eight cells. */
uint64_t bwi_fit_seed(const bw_library *library, int level, const int32_t *code);
bw_status bwi_check_options(bw_context *context, const bw_library_options *options);
/* The block that fit f of level 2 is of: eight turned fits of level 1, NULL for void; release. */
bw_status bwi_level2_block(bw_context *context, const bw_library *library, int32_t fit,
                           bw_solid_material *child[8]);

/* ---- bytes --------------------------------------------------------------------------------------
 *
 * Little endian, IEEE 754. Constants are rounded to float: what is fitted is always rounded through
 * these bytes, so that a fit read back is the fit that was made. */
typedef struct bwi_pack {
  bw_context *context;
  unsigned char *bytes;
  size_t count, capacity;
  bw_status status; /* BW_MEMORY sticks */
} bwi_pack;
void bwi_pack_begin(bwi_pack *pack, bw_context *context);
void bwi_pack_clear(bwi_pack *pack);
void bwi_pack_bytes(bwi_pack *pack, const void *bytes, size_t count);
void bwi_pack_u8(bwi_pack *pack, unsigned value);
void bwi_pack_u32(bwi_pack *pack, uint32_t value);
void bwi_pack_u64(bwi_pack *pack, uint64_t value);
void bwi_pack_f32(bwi_pack *pack, double value);
void bwi_pack_f64(bwi_pack *pack, double value);

/* Reading: past the end everything is zero and `short_of` is set, which the caller asks at last. */
typedef struct bwi_unpack {
  bw_context *context;
  const char *name, *part; /* file and section, for messages */
  const unsigned char *at, *end;
  bool short_of;
} bwi_unpack;
const unsigned char *bwi_unpack_bytes(bwi_unpack *from, size_t count); /* NULL past the end */
unsigned bwi_unpack_u8(bwi_unpack *from);
uint32_t bwi_unpack_u32(bwi_unpack *from);
uint64_t bwi_unpack_u64(bwi_unpack *from);
double bwi_unpack_f32(bwi_unpack *from);
double bwi_unpack_f64(bwi_unpack *from);
bw_status bwi_unpack_fail(bwi_unpack *from, const char *format, ...) BW_PRINTF(2, 3);
/* BW_FORMAT unless exactly everything was read. */
bw_status bwi_unpack_end(bwi_unpack *from);

/* Material table and options: what makes a library this one and no other. */
void bwi_pack_head(bwi_pack *pack, const bw_material_table *material_table,
                   const bw_library_options *options);
bw_status bwi_unpack_head(bwi_unpack *from, bw_material_table **material_table,
                          bw_library_options *options);
/* A sentence on the first difference of two heads, or false when there is none. */
bool bwi_head_differs(const bw_material_table *material_table, const bw_library_options *options,
                      const bw_material_table *other, const bw_library_options *other_options,
                      char *text, size_t size);
/* One fit: of 8 points at either level. */
enum { BWI_FIT_MIN_BYTES = 100 };
void bwi_pack_fit(bwi_pack *pack, const bw_solid_material *fit, const bw_fit_error *error);
bw_status bwi_unpack_fit(bwi_unpack *from, int level, int32_t number, bw_solid_material **fit,
                         bw_fit_error *error);

/* ---- checkpoints ------------------------------------------------------------------------------
 *
 * A head with material table and options, then finished fits in any order, each with a checksum.
 * What follows the last sound record is cut off on opening: a kill may leave part of one. */
typedef struct bwi_checkpoint bwi_checkpoint;
typedef bw_status bwi_checkpoint_fit(void *data, int level, int32_t fit, const uint8_t *key,
                                     bw_solid_material *material,
                                     const bw_fit_error *error); /* takes the material over */
/* `fit` is called for each record; `seconds`: what earlier runs took. */
bw_status bwi_checkpoint_open(bw_context *context, const char *path,
                              const bw_material_table *material_table,
                              const bw_library_options *options, bwi_checkpoint_fit *fit,
                              void *data, double *seconds, bwi_checkpoint **checkpoint);
/* From any thread. `packed` is what bwi_pack_fit made. Grown fits have a key, the others a
 * number. */
bw_status bwi_checkpoint_add(bw_context *context, bwi_checkpoint *checkpoint, int level,
                             int32_t fit, const uint8_t *key, double seconds,
                             const bwi_pack *packed);
void bwi_checkpoint_close(bwi_checkpoint *checkpoint); /* flushed to the disk */

/* ---- files ------------------------------------------------------------------------------------
 *
 * The contents of the sections, unpacked; for the fuzzer too. */
enum { BWI_SECTIONS = 5 };
typedef struct bwi_file_section {
  const unsigned char *bytes;
  size_t count;
} bwi_file_section;
bw_status bwi_library_of_sections(bw_context *context, const char *name,
                                  const bwi_file_section section[BWI_SECTIONS],
                                  bw_library **library);

#endif
