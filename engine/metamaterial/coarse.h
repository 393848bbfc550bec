/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From the key of a block to its coarse material. */
#ifndef BWI_METAMATERIAL_COARSE_H
#define BWI_METAMATERIAL_COARSE_H

#include "metamaterial/internal.h"

/* What blocks are turned into materials by. */
typedef struct bwi_coarse_maker {
  bw_coarse_method method;
  int levels;
  const bw_library *library;               /* NULL for baselines */
  const bw_material_table *material_table; /* of the fine grid */
  const bw_rule *rule;                     /* of these levels, points at Gauss's places */
} bwi_coarse_maker;

/* A block's 8 or 64 fine elements: their materials (0: void), child by child, and the parts of
 * their cells that are inside. At level 2 element 8 c + d is child d of child c. */
typedef struct bwi_fine_block {
  int32_t key[64];
  double fraction[64];
  bool partial; /* some fraction is not 1 */
} bwi_fine_block;

/* Mean over the block, void counted as nothing; 0 where that of an element is not known. */
double bwi_block_density(const bwi_coarse_maker *maker, const bwi_fine_block *block);
/* The mean part of cell c's elements that is inside, at level 2. */
double bwi_block_part(const bwi_fine_block *block, int c);
/* The fine elements of a coarse one, through one or two coarsenings. */
void bwi_block_gather(const bw_grid *fine, const bw_coarsening *const *coarsening, int levels,
                      int32_t element, bwi_fine_block *block);
bw_status bwi_baseline_material(bw_context *context, const bwi_coarse_maker *maker,
                                const bwi_fine_block *block, bw_solid_material **material);
bw_status bwi_lookup_material(bw_context *context, const bwi_coarse_maker *maker,
                              const bwi_fine_block *block, bw_solid_material **material);
/* Of a block of 64, by a library of two levels; *fit is the fit that stands for it, or -1 where
 * none does well enough. */
bw_status bwi_level2_material(bw_context *context, const bw_library *library,
                              const bwi_fine_block *block, double density, int32_t *fit,
                              bw_solid_material **material);
/* Whether a grid's blocks can be looked up: uniform materials of the library's material table,
 * cubes. */
bw_status bwi_coarse_check(bw_context *context, const bw_library *library,
                           const bw_material_table *material_table, const bw_grid *fine);
/* Materials, laws and constants of the two must be the same, row by row. */
bw_status bwi_same_material_table(bw_context *context, const bw_material_table *material_table,
                                  const bw_material_table *of_library);

/* Behind bw_coarse: the keys of its material table's rows. */
typedef struct bwi_coarse_keys {
  int32_t width; /* 8 or 64 */
  int32_t *key;  /* (material table->count - 1) x width */
} bwi_coarse_keys;

/* Materials while blocks are gone through: those of the coarse grid followed first, new ones
 * behind. */
typedef struct bwi_rows {
  bw_context *context;
  const bwi_coarse_maker *maker;
  int32_t width, count;
  const bw_solid_material **material; /* id - 1; retained */
  int32_t *key;                       /* as in bwi_coarse_keys, by id */
  size_t material_capacity, key_capacity;
  int32_t *slot; /* ids by hash of their key, 0: free */
  size_t slots;
} bwi_rows;
/* With the rows of `before` (may be NULL); to be cleared also when it fails. */
bw_status bwi_rows_begin(bwi_rows *rows, bw_context *context, const bwi_coarse_maker *maker,
                         const bw_coarse *before);
void bwi_rows_clear(bwi_rows *rows);
/* The id of a block's material, made where it is new. */
bw_status bwi_rows_of(bwi_rows *rows, bwi_fine_block *block, int32_t *id);

#endif
