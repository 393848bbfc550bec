/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A factor, or conjugate gradients over coarse solids: what either would cost.
 *
 * Costs are operations and bytes, counted, over the rates of one fixed machine, never time
 * measured: the same solution takes the same way everywhere. Those of the factor are known from its
 * analysis. An iteration of conjugate gradients is so many products, which read the elements'
 * stiffnesses, and a solution with the coarsest factor; how many there will be is what solutions of
 * the same elements have needed so far, and a guess before there were any. A walk begins with what
 * seems cheaper and goes over to the factor, for good, when iterations turn out to be dear; no
 * solution may take more of them than a few factors are worth.
 *
 * The search for a direction of negative curvature has to go on until its residual has fallen by
 * some sixteen factors of e, which is dear where convergence is slow: one factor then does the same
 * if it comes out. */
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

/* The model's machine. */
#define FLOPS_PER_SECOND 40e9
#define BYTES_PER_SECOND 15e9
#define SECONDS_PER_POINT 2.6e-7 /* of a projected tangent */

/* Bytes for each entry of a factor that is made and solved with; of a product for each element; of
 * all vectors of an iteration for each node. */
#define ENTRY_BYTES 60.0
#define ELEMENT_BYTES 2800.0
#define NODE_BYTES 1200.0
enum { PRODUCTS = 5, PRODUCTS_BELOW = 4, PRODUCTS_TO_SET = 3 };
/* A grid of half as many cells along each side has a factor of about this part of entries and
 * operations (measured: 1/10 to 1/20, 1/23 to 1/74). */
#define COARSE_ENTRIES 0.1
#define COARSE_FLOPS 0.04

/* Iterations of a solution before anything is known, which counts as so many solutions. */
#define GUESS 6.0
#define GUESS_WEIGHT 1.0
/* Iterations that are worth so many factors end a solution. */
#define LIMIT 3.0
/* Factors of e by which the search's residual falls: half of log(n 30 10^8), n some 10^4. */
#define SEARCH_NEPERS 16.0

bw_status bwi_choice_begin(bwi_walk *walk) {
  bw_status status = BW_OK;
  const bw_newton_options *o = walk->options;
  bw_newton *newton = walk->newton;
  bwi_choice *c = &walk->choice;
  const bw_grid *grid = walk->solid->grid;
  double flops, entries, before = bw_seconds();
  if (!walk->iterative || !o->by_cost || walk->free == 0)
    return BW_OK;
  if (newton->learnt.elements != grid->element_count)
    newton->learnt = (bwi_experience){.elements = grid->element_count,
                                      .solutions = GUESS_WEIGHT,
                                      .iterations = GUESS * GUESS_WEIGHT,
                                      .nepers = 3 * GUESS_WEIGHT};
  BW_TRY(bwi_direct_analyse(walk->context, newton->direct, walk->solid->graph, walk->the->held));
  walk->report->seconds_analysis += bw_seconds() - before;
  bwi_direct_count(newton->direct, &flops, &entries);
  c->factor = flops / FLOPS_PER_SECOND + ENTRY_BYTES * entries / BYTES_PER_SECOND;
  c->iteration = PRODUCTS * ELEMENT_BYTES * (double)grid->element_count +
                 NODE_BYTES * (double)grid->node_count;
  c->set = PRODUCTS_TO_SET * ELEMENT_BYTES * (double)grid->element_count / BYTES_PER_SECOND;
  for (int k = 0; k < o->coarse_count; k++) {
    const bw_grid *below = o->coarse[k]->grid;
    const bw_palette *palette = o->coarse[k]->palette;
    flops *= COARSE_FLOPS;
    entries *= COARSE_ENTRIES;
    for (int64_t e = 0; e < below->element_count; e++)
      c->set += SECONDS_PER_POINT * palette->material[below->material[e]]->rule->count;
    if (k + 1 < o->coarse_count)
      c->iteration += PRODUCTS_BELOW * ELEMENT_BYTES * (double)below->element_count;
  }
  c->set += flops / FLOPS_PER_SECOND;
  c->iteration = (c->iteration + 2 * 8 * entries) / BYTES_PER_SECOND;
  c->open = true;
done:
  return status;
}

void bwi_choice_learn(bwi_walk *walk, int32_t iterations, double residual) {
  bwi_experience *learnt = &walk->newton->learnt;
  learnt->solutions += 1;
  learnt->iterations += iterations;
  learnt->nepers += residual > 0 && residual < 1 ? -log(residual) : 0;
}

int32_t bwi_choice_limit(const bwi_walk *walk) {
  double most = walk->options->cg_iterations;
  if (walk->choice.open)
    most = fmin(most, fmax(10, LIMIT * walk->choice.factor / walk->choice.iteration));
  return (int32_t)most;
}

bool bwi_choice_factor(const bwi_walk *walk) {
  const bwi_choice *c = &walk->choice;
  const bwi_experience *learnt = &walk->newton->learnt;
  return c->open && c->set + c->iteration * learnt->iterations / learnt->solutions > c->factor;
}

bool bwi_choice_factor_search(const bwi_walk *walk) {
  const bwi_choice *c = &walk->choice;
  const bwi_experience *learnt = &walk->newton->learnt;
  return c->open &&
         c->iteration * SEARCH_NEPERS * learnt->iterations / fmax(1, learnt->nepers) > c->factor;
}
