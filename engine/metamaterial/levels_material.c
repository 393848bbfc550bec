/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The material of a block of 64: its own cells' constants of level 1, softened as the block that
 * stands for it was softened by its fit.
 *
 * Representatives are few, and stand for blocks that are stiffer or softer in places. So their
 * fitted constants are not taken as they are, but as factors on those of their cells (fits of level
 * 1, which are exact for both). A cell that is the same in both takes the constants of the fit
 * themselves, so that a representative is given its own fit. */
#include <math.h>
#include <string.h>

#include "metamaterial/coarse.h"
#include "metamaterial/library.h"

/* Constants of a cell of level 1, turned as it lies. */
typedef struct cell {
  int32_t code;
  bool empty;
  uint8_t law[8];
  double mu[8], lambda[8], sum_mu, sum_lambda;
} cell;

static void take_cell(const bw_library *library, int32_t code, cell *it) {
  const bwi_keys *keys = library->inner->keys;
  memset(it, 0, sizeof *it);
  it->code = code;
  it->empty = keys->orbit[code] < 0;
  if (it->empty)
    return;
  const bw_solid_material *fit = library->inner->fit[0][keys->orbit[code]];
  bwi_symmetry symmetry = bwi_symmetry_of(keys->symmetry[code]);
  for (int p = 0; p < 8; p++) {
    int to = bwi_symmetry_octant(symmetry, p);
    it->law[to] = fit->law[p];
    it->mu[to] = fit->mu[p];
    it->lambda[to] = fit->lambda[p];
    it->sum_mu += fit->mu[p];
    it->sum_lambda += fit->lambda[p];
  }
}

/* The fit of level 2 that stands for the block, turned into its place, with its cells. */
typedef struct stand_in {
  cell cell[8];
  double mu[64], lambda[64], stiffness[192], fibre[576], spread[3];
  double sum_mu[8], sum_lambda[8]; /* of the fit, by cell */
  double factor_mu, factor_lambda; /* of the whole: fitted over its cells */
} stand_in;

static void take_stand_in(const bw_library *library, bwi_level2 found, stand_in *it) {
  const bwi_levels *levels = library->inner->levels;
  const bw_solid_material *fit = library->inner->fit[1][found.fit];
  bwi_symmetry symmetry = bwi_symmetry_of(found.symmetry);
  size_t fibres = (size_t)fit->fibre_count;
  int32_t before[8];
  double fitted_mu = 0, fitted_lambda = 0, own_mu = 0, own_lambda = 0;
  memset(it->sum_mu, 0, sizeof it->sum_mu);
  memset(it->sum_lambda, 0, sizeof it->sum_lambda);
  bwi_levels_block(levels, found.fit, before);
  for (int c = 0; c < 8; c++) {
    int to = bwi_symmetry_octant(symmetry, c);
    int32_t turned = levels->turned[before[c] * BWI_SYMMETRIES + found.symmetry];
    take_cell(library, levels->code[0][turned], &it->cell[to]);
  }
  for (int p = 0; p < 64; p++) {
    int c = bwi_symmetry_octant(symmetry, p / 8);
    size_t to = (size_t)(8 * c + bwi_symmetry_octant(symmetry, p % 8));
    it->mu[to] = fit->mu[p];
    it->lambda[to] = fit->lambda[p];
    it->sum_mu[c] += fit->mu[p];
    it->sum_lambda[c] += fit->lambda[p];
    for (size_t f = 0; f < fibres; f++) {
      it->stiffness[to * fibres + f] = fit->fibre_stiffness[(size_t)p * fibres + f];
      bwi_symmetry_vector(symmetry, fit->fibre + 3 * ((size_t)p * fibres + f),
                          it->fibre + 3 * (to * fibres + f));
    }
  }
  for (int c = 0; c < 8; c++) {
    if (it->cell[c].empty)
      continue;
    fitted_mu += it->sum_mu[c];
    fitted_lambda += it->sum_lambda[c];
    own_mu += it->cell[c].sum_mu;
    own_lambda += it->cell[c].sum_lambda;
  }
  it->factor_mu = own_mu > 0 ? fitted_mu / own_mu : 1;
  it->factor_lambda = own_lambda > 0 ? fitted_lambda / own_lambda : 1;
  for (int d = 0; d < 3; d++)
    it->spread[d] = fit->rule->spread[symmetry.axis[d]];
}

/* Fitted over own, where both mean something. */
static double factor(double fitted, double own, double else_) {
  return own > 0 && isfinite(fitted / own) ? fitted / own : else_;
}

bw_status bwi_level2_material(bw_context *context, const bw_library *library,
                              const bwi_fine_block *block, double density, int32_t *fit,
                              bw_solid_material **material) {
  bw_status status = BW_OK;
  bwi_level2 found = bwi_levels_find(library->inner->levels, library->inner->keys, block->key);
  const bw_solid_material *of = library->inner->fit[1][found.fit];
  size_t fibres = (size_t)of->fibre_count;
  stand_in it;
  uint8_t law[64];
  double mu[64], lambda[64], stiffness[192], mean_mu = 0, mean_lambda = 0;
  bw_rule *rule = NULL;
  int there = 0;
  take_stand_in(library, found, &it);
  for (int c = 0; c < 8; c++) {
    cell own;
    const cell *its = &it.cell[c];
    take_cell(library, bwi_key_code(library->inner->keys->base, block->key + 8 * c), &own);
    bool same = own.code == its->code;
    double by_mu = its->empty ? it.factor_mu : factor(it.sum_mu[c], its->sum_mu, it.factor_mu);
    double by_lambda =
        its->empty ? it.factor_lambda : factor(it.sum_lambda[c], its->sum_lambda, it.factor_lambda);
    double by_fibre = same ? 1 : its->empty ? 0 : factor(own.sum_mu, its->sum_mu, 0);
    for (int k = 0; k < 8; k++) {
      size_t p = (size_t)(8 * c + k);
      double part = block->key[p] ? fmax(block->fraction[p], BWI_VOID_PART) : 1;
      law[p] = own.empty ? BWI_VOID_LAW : own.law[k];
      mu[p] = own.empty ? 0 : part * (same ? it.mu[p] : by_mu * own.mu[k]);
      lambda[p] = own.empty ? 0 : part * (same ? it.lambda[p] : by_lambda * own.lambda[k]);
      for (size_t f = 0; f < fibres; f++)
        stiffness[p * fibres + f] = own.empty ? 0 : part * by_fibre * it.stiffness[p * fibres + f];
      mean_mu += mu[p];
      mean_lambda += lambda[p];
      there += !own.empty;
    }
  }
  for (int p = 0; p < 64; p++)
    if (law[p] == BWI_VOID_LAW && mu[p] == 0 && lambda[p] == 0) {
      mu[p] = BWI_VOID_PART * mean_mu / there;
      lambda[p] = BWI_VOID_PART * mean_lambda / there;
    }
  BW_TRY(bw_rule_create_spread(context, 2, it.spread, &rule));
  BW_TRY(bw_solid_material_points(context, of->name, rule, density, law, mu, lambda,
                                  of->fibre_count, stiffness, it.fibre, material));
  *fit = found.fit;
done:
  bw_release(rule);
  return status;
}
