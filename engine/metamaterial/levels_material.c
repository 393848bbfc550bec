/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The material of a block of 64: its own cells, softened as the block that stands for it was
 * softened by its fit.
 *
 * A fit of level 2 has a point for each cell. Representatives are few, and stand for blocks that
 * are stiffer or softer in places; so their fitted constants are not taken as they are, but by the
 * ratio of the block's own cell to theirs (means of what was fitted at level 1, which is known for
 * both). A cell that is the same in both so has the constants of the fit, and a representative is
 * given its own fit.
 *
 * Blocks with void lie far apart, and a fit tells nothing of a block whose cells are filled quite
 * differently: there the cells' own means are taken as they are. */
#include <math.h>
#include <string.h>

#include "metamaterial/coarse.h"
#include "metamaterial/library.h"
#include "nonlinear/internal.h"

#define FAR 4      /* times as stiff as the cell that stands for it, or as soft */
#define SPREAD 0.8 /* of points where no fit is taken: that of homogeneous blocks */

/* A cell as one point: means of its fit of level 1, with what its fibres contribute in the mean
 * over all directions: C (v . E v)^2 then is 2 C / 15 (E : E + (tr E)^2 / 2). */
typedef struct cell {
  int32_t code;
  bool empty;
  uint8_t law;
  double mu, lambda;
} cell;

static cell take_cell(const bw_library *library, int32_t code) {
  const bwi_keys *keys = library->inner->keys;
  cell it = {code, keys->orbit[code] < 0, BWI_VOID_LAW, 0, 0};
  int32_t key[8];
  int votes[BW_LAWS] = {0};
  if (it.empty)
    return it;
  const bw_solid_material *fit = library->inner->fit[0][keys->orbit[code]];
  bwi_key_of(keys->base, code, key);
  for (int p = 0; p < 8; p++) {
    double fibres = 0;
    for (int f = 0; f < fit->fibre_count; f++)
      fibres += fit->fibre_stiffness[p * fit->fibre_count + f] * 2 / 15;
    it.mu += (fit->mu[p] + fibres) / 8;
    it.lambda += (fit->lambda[p] + fibres) / 8;
    if (key[p] > 0)
      votes[library->material_table->material[key[p]]->law[0]]++;
  }
  it.law = 0;
  for (uint8_t l = 1; l < BW_LAWS; l++)
    it.law = votes[l] > votes[it.law] ? l : it.law;
  return it;
}

/* The fit of level 2 that stands for a block, turned into its place, with its cells. */
typedef struct stand_in {
  cell cell[8];
  uint8_t law[8];
  double mu[8], lambda[8], stiffness[24], fibre[72], spread[3];
  double mean_mu, mean_lambda;     /* of the fit */
  double factor_mu, factor_lambda; /* the fit's constants over those of its cells */
} stand_in;

static double ratio(double own, double its) {
  return its > 0 && isfinite(own / its) ? own / its : 1;
}

static void take_stand_in(const bw_library *library, bwi_level2 found, stand_in *it) {
  const bwi_levels *levels = library->inner->levels;
  const bw_solid_material *fit = library->inner->fit[1][found.fit];
  bwi_symmetry symmetry = bwi_symmetry_of(found.symmetry);
  size_t fibres = (size_t)fit->fibre_count;
  int32_t before[8];
  double fitted_mu = 0, fitted_lambda = 0, own_mu = 0, own_lambda = 0;
  bwi_levels_block(levels, found.fit, before);
  for (int c = 0; c < 8; c++) {
    size_t to = (size_t)bwi_symmetry_octant(symmetry, c);
    int32_t turned = levels->turned[before[c] * BWI_SYMMETRIES + found.symmetry];
    it->cell[to] = take_cell(library, levels->code[0][turned]);
    it->law[to] = fit->law[c];
    it->mu[to] = fit->mu[c];
    it->lambda[to] = fit->lambda[c];
    for (size_t f = 0; f < fibres; f++) {
      it->stiffness[to * fibres + f] = fit->fibre_stiffness[(size_t)c * fibres + f];
      bwi_symmetry_vector(symmetry, fit->fibre + 3 * ((size_t)c * fibres + f),
                          it->fibre + 3 * (to * fibres + f));
    }
    fitted_mu += it->mu[to];
    fitted_lambda += it->lambda[to];
    own_mu += it->cell[to].mu;
    own_lambda += it->cell[to].lambda;
  }
  it->mean_mu = fitted_mu / 8;
  it->mean_lambda = fitted_lambda / 8;
  it->factor_mu = ratio(fitted_mu, own_mu);
  it->factor_lambda = ratio(fitted_lambda, own_lambda);
  for (int d = 0; d < 3; d++)
    it->spread[d] = fit->rule->spread[symmetry.axis[d]];
}

/* How much stiffer the block's cells are than those of what stands for it. */
static double whole_ratio(const cell own[8], const cell its[8]) {
  double sum_own = 0, sum_its = 0;
  bool same = true;
  for (int c = 0; c < 8; c++) {
    sum_own += own[c].mu;
    sum_its += its[c].mu;
    same = same && own[c].code == its[c].code;
  }
  return same ? 1 : ratio(sum_own, sum_its);
}

double bwi_block_part(const bwi_fine_block *block, int c) {
  double sum = 0;
  int count = 0;
  for (int p = 8 * c; p < 8 * c + 8; p++)
    if (block->key[p] > 0) {
      sum += fmax(block->fraction[p], BWI_MIN_FRACTION);
      count++;
    }
  return count > 0 ? sum / count : 1;
}

static bool is_far(const bwi_fine_block *block, const cell own[8], const cell its[8]) {
  bool empty = false, far = false;
  for (int p = 0; p < 64; p++)
    empty = empty || block->key[p] == 0;
  for (int c = 0; c < 8; c++)
    far = far || (!own[c].empty && !its[c].empty &&
                  (own[c].mu > FAR * its[c].mu || its[c].mu > FAR * own[c].mu));
  return empty && far;
}

/* The cells' means as points, without fibres. */
static bw_status made_of_cells(bw_context *context, const bwi_fine_block *block, const cell own[8],
                               double density, bw_solid_material **material) {
  bw_status status = BW_OK;
  const double spread[3] = {SPREAD, SPREAD, SPREAD};
  double mu[8], lambda[8], mean_mu = 0, mean_lambda = 0;
  uint8_t law[8];
  int there = 0;
  bw_rule *rule = NULL;
  for (int c = 0; c < 8; c++) {
    double part = bwi_block_part(block, c);
    law[c] = own[c].law;
    mu[c] = part * own[c].mu;
    lambda[c] = part * own[c].lambda;
    mean_mu += mu[c];
    mean_lambda += lambda[c];
    there += !own[c].empty;
  }
  for (int c = 0; c < 8; c++)
    if (own[c].empty) {
      mu[c] = BWI_VOID_PART * mean_mu / there;
      lambda[c] = BWI_VOID_PART * mean_lambda / there;
    }
  BW_TRY(bw_rule_create_spread(context, 1, spread, &rule));
  BW_TRY(bw_solid_material_points(context, "of its cells, level 2", rule, density, law, mu, lambda,
                                  0, NULL, NULL, material));
done:
  bw_release(rule);
  return status;
}

bw_status bwi_level2_material(bw_context *context, const bw_library *library,
                              const bwi_fine_block *block, double density, int32_t *fit,
                              bw_solid_material **material) {
  bw_status status = BW_OK;
  bwi_level2 found = bwi_levels_find(library->inner->levels, library->inner->keys, block->key);
  const bw_solid_material *of = library->inner->fit[1][found.fit];
  size_t fibres = (size_t)of->fibre_count;
  bw_rule *rule = NULL;
  stand_in it;
  cell own[8];
  take_stand_in(library, found, &it);
  for (int c = 0; c < 8; c++)
    own[c] = take_cell(library, bwi_key_code(library->inner->keys->base, block->key + 8 * c));
  if (is_far(block, own, it.cell)) {
    *fit = -1;
    return made_of_cells(context, block, own, density, material);
  }
  double whole = whole_ratio(own, it.cell);
  for (int c = 0; c < 8; c++) {
    const cell *its = &it.cell[c];
    double part = bwi_block_part(block, c), by_mu = whole, by_lambda = whole, by_fibre;
    if (own[c].empty != its->empty) {
      it.mu[c] = (own[c].empty ? BWI_VOID_PART * it.mean_mu : it.factor_mu * own[c].mu);
      it.lambda[c] =
          (own[c].empty ? BWI_VOID_PART * it.mean_lambda : it.factor_lambda * own[c].lambda);
      by_mu = by_lambda = own[c].empty ? whole : 1;
      by_fibre = 0;
    } else if (!own[c].empty) {
      by_mu = own[c].code == its->code ? 1 : ratio(own[c].mu, its->mu);
      by_lambda = own[c].code == its->code ? 1 : ratio(own[c].lambda, its->lambda);
      by_fibre = by_mu;
    } else {
      by_fibre = whole;
    }
    it.law[c] = own[c].empty ? BWI_VOID_LAW : own[c].law;
    it.mu[c] *= part * by_mu;
    it.lambda[c] *= part * by_lambda;
    for (size_t f = 0; f < fibres; f++)
      it.stiffness[(size_t)c * fibres + f] *= part * by_fibre;
  }
  BW_TRY(bw_rule_create_spread(context, 1, it.spread, &rule));
  BW_TRY(bw_solid_material_points(context, of->name, rule, density, it.law, it.mu, it.lambda,
                                  of->fibre_count, it.stiffness, it.fibre, material));
  *fit = found.fit;
done:
  bw_release(rule);
  return status;
}
