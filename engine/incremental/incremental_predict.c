/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What it would cost to update the factor, and what to iterate with the one there is.
 *
 * Costs are operations and bytes, counted, over the rates of one fixed machine, never time
 * measured: so the same edits take the same way everywhere, run after run. Iterating reads the
 * factor twice and the stiffness once per iteration; factoring is floating-point work, and reading
 * and writing what of the factor it concerns.
 *
 * How many iterations: let B be an element's affine map from the shape that was factored to the
 * present one, both seen from the frame of its subdomain, and e the largest |B - 1| in Frobenius's
 * norm over the touched subdomains.
 * Preconditioned by the former matrix, the eigenvalues spread over about (1 + SPREAD e)^2; the
 * bound of conjugate gradients for that spread is the prediction, times what the last solve needed
 * over what was predicted for it. A long slender limb has more spread than that, a stiff block
 * less: hence the iteration_ratio, and the limit that a solve sets itself. What was learnt from one
 * edit says nothing about others: iteration_ratio holds for the same touched subdomains only. No
 * bound by the elements alone would do: a body that turns without strain in one shape strains in
 * the other, by as much as it turns, so that their stiffnesses have no ratio. What a prediction
 * misses, the rate of convergence shows after a few iterations (pcg.c). Where the material changes
 * too, the spread is multiplied by that of the elasticities, from the element that became softest
 * to the one that became stiffest, beside 1: that of the rest.
 *
 * Two-level PCG leaves the factor behind, and what its update would cost grows with every edit. So
 * it is not compared with that alone: where it costs less than the last edit's own refactoring it
 * is better in the long run too. Where not, what it costs more is summed up, and the factor is
 * updated when the sum has reached what its update costs: as far as predictions hold,
 * never more than twice what the better way would have cost over all edits. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"

#define SPREAD 20.0
/* Right-hand sides that one pass over the factor serves, and what it costs over a pass for one
 * (measured). */
enum { SIDES = 8 };
#define SOLVE_SIDES 1.6

/* Edges from the first corner, seen from the frame: columns of a matrix. */
static void edges(const bw_mesh *mesh, const int32_t *node, const double *frame, double *out) {
  const double *x0 = mesh->node + 3 * (size_t)node[0];
  for (int j = 0; j < 3; j++) {
    const double *x = mesh->node + 3 * (size_t)node[j + 1];
    double edge[3] = {x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]};
    for (int i = 0; i < 3; i++)
      out[3 * i + j] = bw_dot(frame + 3 * i, edge);
  }
}

/* By how much stiffer and softer an element became, where that is more than of those before: the
 * means of both products with a compliance estimate the ends of the eigenvalues of one matrix
 * against the other. They are exact where one modulus changes. */
static void widen_by_material(const bwi_incremental *inner, int64_t element, double *stiffer,
                              double *softer) {
  const bw_material *before, *now;
  if (!bwi_incremental_other_material(inner, element, &before, &now))
    return;
  double more = 0, less = 0;
  for (int i = 0; i < 36; i++) {
    more += before->compliance[i] * now->elasticity[i] / 6;
    less += now->compliance[i] * before->elasticity[i] / 6;
  }
  *stiffer = fmax(*stiffer, more);
  *softer = fmax(*softer, less);
}

static double largest_change(const bw_incremental_system *incremental) {
  const bwi_incremental *inner = incremental->inner;
  const bw_mesh *before = inner->factored, *now = inner->model->mesh;
  double max = 0, stiffer = 1, softer = 1; /* 1: of the rest, which does not change */
  for (int32_t e = 0; e < now->element_count; e++) {
    int32_t subdomain = inner->element_subdomain[e];
    if (!inner->touched[subdomain])
      continue;
    const int32_t *node = now->element + (size_t)e * (size_t)now->nodes_per_element;
    double from[9], to[9], inverse[9], change = 0;
    edges(before, node, inner->factored_frame + 9 * (size_t)subdomain, from);
    edges(now, node, inner->frame + 9 * (size_t)subdomain, to);
    if (bw_inverse3(from, inverse) == 0)
      continue;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double b = -(i == j);
        for (int k = 0; k < 3; k++)
          b += to[3 * i + k] * inverse[3 * k + j];
        change += b * b;
      }
    max = fmax(max, sqrt(change));
    widen_by_material(inner, e, &stiffer, &softer);
  }
  return ((1 + SPREAD * max) * sqrt(stiffer * softer) - 1) / SPREAD;
}

/* Iterations for so many digits (natural logarithm). */
static double bound(double spread, double digits) {
  return spread > 0 ? digits / log((2 + spread) / spread) : 0;
}

/* Iterations from a solution near by, over those that as many digits take from nothing: what is
 * left of the error is rough, and sweeps are made for that (measured: 0.5 to 0.65). */
#define NEAR 0.6

static void predict_levels(const bw_incremental_system *incremental, double tolerance,
                           int64_t count, int64_t further, bwi_incremental_cost *cost) {
  const bwi_incremental *inner = incremental->inner;
  const bw_block_pattern *pattern = incremental->system->pattern;
  cost->pcg = INFINITY;
  cost->one_pcg_iteration = cost->pcg_iterations = 0;
  if (!bwi_incremental_has_two_level(incremental) ||
      (inner->two_level_known && !inner->two_level_usable))
    return;
  double one = inner->two_level
                   ? bwi_two_level_seconds(inner->two_level)
                   : 1.5 * BWI_TWO_LEVEL_PASS / BWI_COST_BYTES_PER_SECOND *
                         bwi_smoother_bytes(pattern->block_count - pattern->node_count);
  double follow = 0;
  if (!inner->two_level)
    follow = BWI_TWO_LEVEL_BEGIN * one;
  else if (!inner->two_level_known)
    follow = bwi_coarse_seconds(inner->two_level->coarse) +
             (216 + 6 * 72.0) * (double)pattern->block_count / BWI_COST_BYTES_PER_SECOND;
  double seen = inner->two_level_ratio[cost->near];
  double factor = seen > 0 ? seen : cost->near ? NEAR : 1;
  cost->pcg_iterations = 1 + factor * BWI_TWO_LEVEL_RATE * log(2 / tolerance);
  cost->one_pcg_iteration = one * bwi_two_level_sides(count);
  cost->pcg = follow +
              cost->pcg_iterations * (cost->one_pcg_iteration + one * bwi_two_level_sides(further));
}

static double refactoring(const bwi_incremental *inner, const uint8_t *touched,
                          double factor_bytes) {
  const bwi_symbolic *symbolic = inner->factor->symbolic;
  double flops = bwi_elimination_reach_flops(inner->reach, touched);
  if (inner->factor->cholmod && flops > 0) /* it has no partial refactorisation */
    flops = symbolic->flops;
  double part = symbolic->flops > 0 ? flops / symbolic->flops : 0;
  return flops / bwi_cost_flops_per_second(inner->factor->kernels->bits) +
         2 * part * factor_bytes / BWI_COST_BYTES_PER_SECOND;
}

void bwi_incremental_predict(bw_incremental_system *incremental,
                             const bw_incremental_options *options, double tolerance, int64_t count,
                             bwi_incremental_cost *cost) {
  bwi_incremental *inner = incremental->inner;
  double factor_bytes = (double)bwi_factor_bytes(inner->factor);
  double stiffness_bytes = 72.0 * (double)incremental->system->pattern->block_count;
  double passes = (double)((count + SIDES - 1) / SIDES);
  double later = options->further > 0 ? (options->further + SIDES - 1) / SIDES : 0;
  double solve = 2 * factor_bytes / BWI_COST_BYTES_PER_SECOND;
  double pass = solve + stiffness_bytes / BWI_COST_BYTES_PER_SECOND;
  double refinements = bwi_incremental_refinements(incremental, tolerance);
  double all = passes * (count > 1 ? SOLVE_SIDES : 1), solved = all + later * SOLVE_SIDES;
  double solutions = solved * (solve + refinements * pass);
  cost->refactor = refactoring(inner, inner->touched, factor_bytes) + solutions;
  cost->again = refactoring(inner, inner->latest, factor_bytes) + solutions;
  if (inner->change < 0)
    inner->change = largest_change(incremental);
  bool known = memcmp(inner->iterated_on, inner->touched, (size_t)inner->subdomain_count) == 0;
  cost->factor = known ? inner->iteration_ratio : 1;
  if (options->max_iteration_ratio > 0)
    cost->factor = fmin(cost->factor, options->max_iteration_ratio);
  cost->iterations =
      1 + refinements + cost->factor * bound(SPREAD * inner->change, log(2 / tolerance));
  cost->near = tolerance > 2 * options->tolerance;
  predict_levels(incremental, tolerance, count, options->further, cost);
  cost->one_iteration = all * pass;
  cost->iterate = cost->iterations * solved * pass;
}
