/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coarse materials without a library: naive (each point takes the constants of the fine element
 * there) and averaged.
 *
 * That of an element which fills a part of its cell has this part of its constants; that of a void
 * one next to nothing (BWI_VOID_PART), so that every node has some stiffness. So the energy of a
 * block under a uniform deformation is right to a thousandth, and its mass exactly; the coarse
 * cells themselves count as full. */
#include <math.h>
#include <stdio.h>

#include "metamaterial/coarse.h"
#include "nonlinear/internal.h"

double bwi_block_density(const bwi_coarse_maker *maker, const bwi_fine_block *block) {
  int count = maker->rule->count;
  double sum = 0;
  for (int p = 0; p < count; p++) {
    if (!block->key[p])
      continue;
    double density = maker->material_table->material[block->key[p]]->density;
    if (!(density > 0))
      return 0;
    sum += density * block->fraction[p];
  }
  return sum / count;
}

static void naive(const bwi_coarse_maker *maker, const bwi_fine_block *block, uint8_t *law,
                  double *mu, double *lambda) {
  double mean_mu = 0, mean_lambda = 0;
  int there = 0, count = maker->rule->count;
  for (int p = 0; p < count; p++) {
    const bw_solid_material *m = maker->material_table->material[block->key[p]];
    double part = fmax(block->fraction[p], BWI_MIN_FRACTION);
    law[p] = m ? m->law[0] : BWI_VOID_LAW;
    mu[p] = m ? part * m->mu[0] : 0;
    lambda[p] = m ? part * m->lambda[0] : 0;
    mean_mu += mu[p];
    mean_lambda += lambda[p];
    there += m != NULL;
  }
  for (int p = 0; p < count; p++)
    if (!block->key[p]) {
      mu[p] = BWI_VOID_PART * mean_mu / there;
      lambda[p] = BWI_VOID_PART * mean_lambda / there;
    }
}

/* Every point takes the means; of several laws the one that most elements have. */
static void average(int count, const bwi_fine_block *block, uint8_t *law, double *mu,
                    double *lambda) {
  int votes[BW_LAWS] = {0}, max = 0;
  double mean_mu = 0, mean_lambda = 0;
  for (int p = 0; p < count; p++) {
    votes[law[p]] += block->key[p] > 0;
    mean_mu += block->key[p] ? mu[p] / count : 0;
    mean_lambda += block->key[p] ? lambda[p] / count : 0;
  }
  for (int l = 1; l < BW_LAWS; l++)
    max = votes[l] > votes[max] ? l : max;
  for (int p = 0; p < count; p++) {
    law[p] = (uint8_t)max;
    mu[p] = mean_mu;
    lambda[p] = mean_lambda;
  }
}

bw_status bwi_baseline_material(bw_context *context, const bwi_coarse_maker *maker,
                                const bwi_fine_block *block, bw_solid_material **material) {
  uint8_t law[64];
  double mu[64], lambda[64];
  char name[BW_NAME];
  bool averaged = maker->method == BW_COARSE_AVERAGE;
  naive(maker, block, law, mu, lambda);
  if (averaged)
    average(maker->rule->count, block, law, mu, lambda);
  snprintf(name, sizeof name, "%s, level %d", averaged ? "averaged" : "naive", maker->levels);
  return bw_solid_material_points(context, name, maker->rule, bwi_block_density(maker, block), law,
                                  mu, lambda, 0, NULL, NULL, material);
}

bw_status bwi_same_material_table(bw_context *context, const bw_material_table *material_table,
                                  const bw_material_table *of_library) {
  if (material_table->count != of_library->count)
    return bw_fail(
        context, BW_INVALID,
        "the material table has %d materials, the library is of %d: a library serves the "
        "material table it was built of",
        (int)material_table->count - 1, (int)of_library->count - 1);
  for (int32_t i = 1; i < material_table->count; i++) {
    const bw_solid_material *a = material_table->material[i], *b = of_library->material[i];
    if (a->law[0] != b->law[0] || a->mu[0] != b->mu[0] || a->lambda[0] != b->lambda[0])
      return bw_fail(
          context, BW_INVALID,
          "material %d is %s (%s, mu = %g Pa, lambda = %g Pa), that of the library %s "
          "(%s, mu = %g Pa, lambda = %g Pa): a library serves the material table it was built "
          "of",
          (int)i, a->name, bw_law_word((bw_law)a->law[0]), a->mu[0], a->lambda[0], b->name,
          bw_law_word((bw_law)b->law[0]), b->mu[0], b->lambda[0]);
  }
  return BW_OK;
}
