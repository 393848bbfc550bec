/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Libraries: the object, its options, and materials by key. */
#include "metamaterial/library.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "metamaterial/coarse.h"
#include "nonlinear/internal.h"

enum { MAX_SAMPLES = 1000000 };

void bw_library_options_default(bw_library_options *options) {
  memset(options, 0, sizeof *options);
  options->levels = 1;
  options->voids = true;
  options->directions = 500;
  options->magnitudes = 5;
  options->stretches = 500;
  options->fibres = 3;
  options->strain = 0.1;
  options->ridge = 0.01;
  options->representatives = 400;
  options->seed = 1;
}

static void destroy(void *object) {
  bw_library *it = (bw_library *)object;
  bwi_library *inner = it->inner;
  bw_release(it->material_table);
  for (int l = 0; inner && l < 2; l++)
    bwi_grown_clear(&inner->grown[l]);
  for (int l = 0; inner && !inner->of && l < 2; l++) {
    for (int32_t f = 0; inner->fit[l] && f < it->fit_count[l]; f++)
      bw_release(inner->fit[l][f]);
    bw_free(inner->fit[l]);
    bw_free(inner->error[l]);
  }
  if (inner && inner->of) {
    bw_release(inner->of);
  } else if (inner) {
    bwi_keys_destroy(inner->keys);
    bwi_levels_destroy(inner->levels);
  }
  bw_free(inner);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_library *it = (const bw_library *)object;
  size_t sum = sizeof *it + sizeof *it->inner;
  for (int l = 0; l < 2; l++) {
    const bwi_grown *grown = &it->inner->grown[l];
    for (int32_t f = 0; f < it->fit_count[l]; f++)
      sum += bw_bytes(it->inner->fit[l][f]) + sizeof(bw_fit_error) + sizeof(void *);
    for (int32_t f = 0; f < grown->count; f++)
      sum += bw_bytes(grown->fit[f]) + sizeof(bw_fit_error) + sizeof(void *) + (size_t)grown->width;
  }
  sum += (size_t)it->inner->keys->code_count * 5 + (size_t)it->inner->keys->orbit_count * 4;
  if (it->inner->levels)
    for (int s = 0; s < 3; s++)
      sum += 2 * (size_t)it->inner->levels->count[s] * (size_t)it->inner->levels->count[s];
  return sum;
}

static const bw_kind library_kind = {"library", destroy, bytes};

static bw_status check_count(bw_context *context, const char *name, int value, int min, int max) {
  if (value < min || value > max)
    return bw_fail(context, BW_INVALID, "library option %s is %d; %d to %d", name, value, min, max);
  return BW_OK;
}

bw_status bwi_check_options(bw_context *context, const bw_library_options *o) {
  bw_status status = BW_OK;
  BW_TRY(check_count(context, "levels", o->levels, 0, 2));
  BW_TRY(check_count(context, "directions", o->directions, 1, MAX_SAMPLES));
  BW_TRY(check_count(context, "magnitudes", o->magnitudes, 1, 1000));
  BW_TRY(check_count(context, "stretches", o->stretches, 0, MAX_SAMPLES));
  BW_TRY(check_count(context, "fibres", o->fibres, 0, 3));
  BW_TRY(check_count(context, "representatives", o->representatives, 8, BWI_MAX_REPRESENTATIVES));
  if (!(o->strain >= 1e-5 && o->strain < 10)) /* below that, energies are rounding */
    return bw_fail(context, BW_INVALID,
                   "library option strain is %g; it must lie between 1e-5 and 10 (0.3: 30 %%)",
                   o->strain);
  if (!(o->ridge >= 0 && isfinite(o->ridge)))
    return bw_fail(context, BW_INVALID, "library option ridge is %g; it must not be negative",
                   o->ridge);
done:
  return status;
}

bw_status bwi_library_begin(bw_context *context, const bw_material_table *material_table,
                            const bw_library_options *options, bw_library **out) {
  bw_status status = BW_OK;
  bw_library *it = NULL;
  BW_TRY(bwi_check_options(context, options));
  for (int32_t i = 1; i < material_table->count; i++)
    if (!material_table->material[i]->uniform)
      return bw_fail(context, BW_INVALID,
                     "material %d (%s) differs from point to point: a library is of uniform ones",
                     (int)i, material_table->material[i]->name);
  it = BW_NEW0(context, bw_library, 1);
  if (!it)
    return BW_MEMORY;
  bw_object_init(it, &library_kind);
  it->material_table = (const bw_material_table *)bw_retain(material_table);
  it->options = *options;
  it->levels = options->levels;
  it->inner = BW_NEW0(context, bwi_library, 1);
  BW_TRY_MEMORY(it->inner);
  BW_TRY(bwi_keys_create(context, material_table->count, options->voids, it->levels > 0,
                         &it->inner->keys));
  BW_TRY(bwi_library_reserve(context, it, 1, it->levels > 0 ? it->inner->keys->orbit_count : 0));
  bwi_library_show(it);
  *out = it;
  it = NULL;
done:
  bw_release(it);
  return status;
}

void bwi_library_show(bw_library *it) {
  for (int l = 0; l < 2; l++) {
    it->inner->grown[l].width = l == 0 ? 8 : 64;
    it->grown_count[l] = it->inner->grown[l].count;
    it->grown_error[l] = it->inner->grown[l].error;
    if (it->grown_count[l] > 0 && it->levels <= l)
      it->levels = l + 1;
  }
}

bw_status bwi_library_with(bw_context *context, const bw_library *of, bwi_grown grown[2],
                           bw_library **out) {
  const bw_library *owner = of->inner->of ? of->inner->of : of;
  bw_library *it = BW_NEW0(context, bw_library, 1);
  bwi_library *inner = BW_NEW0(context, bwi_library, 1);
  if (!it || !inner) {
    bw_free(it);
    bw_free(inner);
    return BW_MEMORY;
  }
  bw_object_init(it, &library_kind);
  it->material_table = (const bw_material_table *)bw_retain(of->material_table);
  it->options = of->options;
  it->levels = owner->levels;
  it->inner = inner;
  *inner = *owner->inner;
  inner->of = (const bw_library *)bw_retain(owner);
  for (int l = 0; l < 2; l++) {
    it->fit_count[l] = owner->fit_count[l];
    it->error[l] = owner->error[l];
    inner->grown[l] = grown[l];
    memset(&grown[l], 0, sizeof grown[l]);
  }
  bwi_library_show(it);
  *out = it;
  return BW_OK;
}

bw_status bwi_library_reserve(bw_context *context, bw_library *it, int level, int32_t count) {
  bwi_library *inner = it->inner;
  inner->fit[level - 1] = BW_NEW0(context, bw_solid_material *, count);
  inner->error[level - 1] = BW_NEW0(context, bw_fit_error, count);
  it->error[level - 1] = inner->error[level - 1];
  if (!inner->fit[level - 1] || !inner->error[level - 1])
    return BW_MEMORY;
  it->fit_count[level - 1] = count;
  return BW_OK;
}

bw_status bwi_level2_block(bw_context *context, const bw_library *it, int32_t fit,
                           bw_solid_material *child[8]) {
  bw_status status = BW_OK;
  const bwi_levels *levels = it->inner->levels;
  int32_t cell[8];
  for (int c = 0; c < 8; c++)
    child[c] = NULL;
  bwi_levels_block(levels, fit, cell);
  for (int c = 0; c < 8 && status == BW_OK; c++)
    if (cell[c] > 0)
      status = bwi_material_transformed(
          context, it->inner->fit[0][levels->chosen[0][levels->origin[0][cell[c]]]],
          levels->how[0][cell[c]], &child[c]);
  return status;
}

/* ---- materials by key ----------------------------------------------------------------------- */

static int first_of(int width, const int32_t *key, uint8_t first[64]) {
  uint8_t bytes_of[64];
  for (int p = 0; p < width; p++)
    bytes_of[p] = (uint8_t)key[p];
  return bwi_key_first(width, bytes_of, first);
}

/* The grown fit of a block, or -1. */
static int32_t find_grown(const bw_library *it, int level, const int32_t *key, int *symmetry) {
  const bwi_grown *grown = &it->inner->grown[level - 1];
  uint8_t first[64];
  if (grown->count == 0)
    return -1;
  *symmetry = first_of(grown->width, key, first);
  return bwi_grown_find(grown, first);
}

const bw_solid_material *bwi_library_cell(const bw_library *it, const int32_t key[8],
                                          int *symmetry) {
  const bwi_keys *keys = it->inner->keys;
  int32_t code = bwi_key_code(keys->base, key), grown;
  if (it->fit_count[0] > 0 && keys->orbit[code] >= 0) {
    *symmetry = keys->symmetry[code];
    return it->inner->fit[0][keys->orbit[code]];
  }
  grown = find_grown(it, 1, key, symmetry);
  return grown < 0 ? NULL : it->inner->grown[0].fit[grown];
}

bool bwi_library_has_block(const bw_library *it, const int32_t key[64]) {
  const bwi_library *inner = it->inner;
  int symmetry;
  int32_t before[8];
  bool empty = false;
  if (find_grown(it, 2, key, &symmetry) >= 0)
    return true;
  for (int p = 0; p < 64; p++)
    empty = empty || key[p] == 0;
  if (!inner->levels || (empty && !it->options.voids))
    return false;
  bwi_level2 found = bwi_levels_find(inner->levels, inner->keys, key);
  bwi_levels_block(inner->levels, found.fit, before);
  for (int c = 0; c < 8; c++) {
    int to = bwi_symmetry_octant(bwi_symmetry_of(found.symmetry), c);
    int32_t turned = inner->levels->turned[before[c] * BWI_SYMMETRIES + found.symmetry];
    if (inner->levels->code[0][turned] != bwi_key_code(inner->keys->base, key + 8 * to))
      return false;
  }
  return true;
}

static uint64_t mix(uint64_t h, uint64_t value) {
  h = (h ^ value) * 0xff51afd7ed558ccdu;
  return h ^ h >> 33;
}

uint64_t bwi_fit_seed(const bw_library *library, int level, const int32_t *code) {
  uint64_t h = mix(library->options.seed, (uint64_t)level);
  for (int c = 0; c < (level == 1 ? 1 : 8); c++)
    h = mix(h, (uint64_t)code[c]);
  return h;
}

/* A fit turned, its constants multiplied by the parts of cells, with a density of its own. */
static bw_status made_of(bw_context *context, const bw_solid_material *fit, int symmetry,
                         const bwi_fine_block *block, int level, double density,
                         bw_solid_material **out) {
  bw_status status = BW_OK;
  bw_solid_material *turned = NULL;
  double mu[8], lambda[8], stiffness[24];
  size_t fibres = (size_t)fit->fibre_count;
  BW_TRY(bwi_material_transformed(context, fit, symmetry, &turned));
  if (!block->partial && density == turned->density) {
    *out = turned;
    return BW_OK;
  }
  for (size_t p = 0; p < (size_t)turned->rule->count; p++) {
    double part = level == 2      ? bwi_block_part(block, (int)p)
                  : block->key[p] ? fmax(block->fraction[p], BWI_MIN_FRACTION)
                                  : 1;
    mu[p] = part * turned->mu[p];
    lambda[p] = part * turned->lambda[p];
    for (size_t f = 0; f < fibres; f++)
      stiffness[p * fibres + f] = part * turned->fibre_stiffness[p * fibres + f];
  }
  BW_TRY(bw_solid_material_points(context, turned->name, turned->rule, density, turned->law, mu,
                                  lambda, turned->fibre_count, stiffness, turned->fibre, out));
done:
  bw_release(turned);
  return status;
}

/* Blocks with void, where the library has none with void: naive. */
static bool refused_void(const bw_library *library, int count, const int32_t *key) {
  bool empty = false;
  for (int p = 0; p < count; p++)
    empty = empty || key[p] == 0;
  return empty && !library->options.voids;
}

static bw_status look_up(bw_context *context, const bwi_coarse_maker *maker,
                         const bwi_fine_block *block, bw_solid_material **material, int32_t *fit) {
  const bw_library *it = maker->library;
  const bwi_library *inner = it->inner;
  const int level = maker->levels;
  double density = bwi_block_density(maker, block);
  int symmetry = 0;
  int32_t grown = find_grown(it, level, block->key, &symmetry);
  *fit = -1;
  if (grown >= 0) {
    *fit = it->fit_count[level - 1] + grown;
    return made_of(context, inner->grown[level - 1].fit[grown], symmetry, block, level, density,
                   material);
  }
  if (it->fit_count[level - 1] == 0 || refused_void(it, maker->rule->count, block->key))
    return bwi_baseline_material(context, maker, block, material);
  if (level == 1) {
    int32_t code = bwi_key_code(inner->keys->base, block->key);
    *fit = inner->keys->orbit[code];
    return made_of(context, inner->fit[0][*fit], inner->keys->symmetry[code], block, 1, density,
                   material);
  }
  return bwi_level2_material(context, it, block, density, fit, material);
}

bw_status bwi_lookup_material(bw_context *context, const bwi_coarse_maker *maker,
                              const bwi_fine_block *block, bw_solid_material **material) {
  int32_t fit;
  return look_up(context, maker, block, material, &fit);
}

bw_status bw_library_material(bw_context *context, const bw_library *library, int level,
                              const int32_t *key, bw_solid_material **material, int32_t *fit) {
  bw_status status = BW_OK;
  bw_rule *rule = NULL;
  bwi_fine_block block;
  bwi_coarse_maker maker = {BW_COARSE_LOOKUP, level, library, library->material_table, NULL};
  int32_t which = -1, solid = 0;
  if (level < 1 || level > library->levels)
    return bw_fail(context, BW_INVALID, "level %d of a library of %d", level, library->levels);
  block.partial = false;
  for (int p = 0; p < (level == 1 ? 8 : 64); p++) {
    if (key[p] < 0 || key[p] >= library->material_table->count)
      return bw_fail(context, BW_INVALID,
                     "number %d of the key is %d; the library has materials 0 (void) to %d", p + 1,
                     (int)key[p], (int)library->material_table->count - 1);
    block.key[p] = key[p];
    block.fraction[p] = 1;
    solid += key[p] > 0;
  }
  if (solid == 0)
    return bw_fail(context, BW_EMPTY, "a block of void alone has no material");
  BW_TRY(bw_rule_create(context, level, &rule));
  maker.rule = rule;
  BW_TRY(look_up(context, &maker, &block, material, &which));
  if (fit)
    *fit = which;
done:
  bw_release(rule);
  return status;
}
