/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Two-level PCG of a system (system_two_level.h), and its predicted cost.
 *
 * What a factor costs is known when its order is, and making that takes seconds where it matters.
 * The linear elements on the same corners have to be ordered in any case, have a seventh of the
 * unknowns, and predict it too, since nested dissection cuts both bodies alike. Let the quadratic
 * ones have w times as many unknowns. Along the length of a body there are twice as many, so that a
 * separator has w / 2 times as many. Fronts are dense: entries go with the square of that,
 * operations with its cube, for blocks, bars and plates alike, whose w differ. What is left over
 * was measured on these. */
#include "linear/system_two_level.h"

#include <math.h>

#include "barwright/job.h"
#include "base/cost.h"
#include "linear/element_product.h"
#include "linear/pcg.h"

/* Entries and operations over those powers. Measured: 1.26 to 1.52, 1.08 to 1.46. */
#define MORE_ENTRIES 1.35
#define MORE_FLOPS 1.25
/* Of multigrid on linear elements: bytes of an iteration and of the setup for a block of nodes, and
 * iterations for a factor of e (fitted to blocks, bars and plates of 28,000 to 130,000 unknowns).
 */
#define AMG_ITERATION 1000.0
#define AMG_SETUP 15000.0
#define AMG_RATE 1.0

static void two_level_solver_destroy(void *object) {
  bwi_two_level_solver *l = object;
  bw_release(l->preconditioner);
  bw_release(l->coarse);
  bw_release(l->symbolic);
  bw_free(l);
}

/* With the preconditioner made, the coarse space is its own too. */
static size_t two_level_solver_bytes(const void *object) {
  const bwi_two_level_solver *l = object;
  return sizeof *l + bw_bytes(l->symbolic) +
         (l->preconditioner ? bw_bytes(l->preconditioner) : bw_bytes(l->coarse));
}

static const bw_kind two_level_solver_kind = {"two-level solver", two_level_solver_destroy,
                                              two_level_solver_bytes};

bool bwi_two_level_applies(const bw_system *system) {
  return bwi_coarse_fits(system->mesh);
}

static bwi_cost_prediction predict(const bw_system *system, const bwi_coarse *coarse) {
  bwi_cost_prediction cost = {0};
  double blocks = (double)(system->pattern->block_count - system->pattern->node_count);
  double unknowns = bwi_coarse_unknowns(coarse);
  double wider = unknowns > 0 ? system->dof_map->unknown_count / (2 * unknowns) : 0;
  cost.factor_flops = MORE_FLOPS * wider * wider * wider * bwi_coarse_flops(coarse);
  cost.factor_bytes = MORE_ENTRIES * wider * wider * bwi_coarse_entries(coarse) * sizeof(double);
  cost.factor = cost.factor_flops / bwi_cost_flops_per_second(64) +
                4 * cost.factor_bytes / BWI_COST_BYTES_PER_SECOND + BWI_COST_ORDER_BLOCK * blocks;
  double bytes = bwi_smoother_bytes((int64_t)blocks) + bwi_coarse_pass_bytes(coarse);
  cost.one_iteration = BWI_TWO_LEVEL_PASS * bytes / BWI_COST_BYTES_PER_SECOND;
  cost.pcg =
      (BWI_TWO_LEVEL_BEGIN + 1 + BWI_TWO_LEVEL_RATE * log(2 / BWI_REFINE_TO)) * cost.one_iteration +
      bwi_coarse_seconds(coarse);
  return cost;
}

/* Linear elements have no coarser ones to predict by: the factor is ordered and counted, and the
 * order serves where it is made. */
static bw_status predict_linear(bw_context *context, const bw_system *system,
                                bwi_two_level_solver *l) {
  bwi_cost_prediction *cost = &l->prediction;
  double blocks = (double)(system->pattern->block_count - system->pattern->node_count);
  bw_status status = bwi_symbolic_for(context, system->pattern, system->dof_map, BW_ORDERING_AUTO,
                                      0, NULL, NULL, NULL, &l->symbolic);
  if (status != BW_OK)
    return status;
  cost->factor_flops = l->symbolic->flops;
  cost->factor_bytes = (double)l->symbolic->panel[l->symbolic->order->super_count] * sizeof(double);
  cost->factor = cost->factor_flops / bwi_cost_flops_per_second(64) +
                 4 * cost->factor_bytes / BWI_COST_BYTES_PER_SECOND;
  cost->one_iteration = AMG_ITERATION * blocks / BWI_COST_BYTES_PER_SECOND;
  cost->pcg = AMG_SETUP * blocks / BWI_COST_BYTES_PER_SECOND + bwi_predicted_next(l);
  return BW_OK;
}

double bwi_predicted_next(const bwi_two_level_solver *l) {
  double rate = l->coarse ? BWI_TWO_LEVEL_RATE : AMG_RATE;
  return (1 + rate * log(2 / BWI_REFINE_TO)) * l->prediction.one_iteration;
}

bw_status bwi_two_level_predict(bw_context *context, bw_system *system) {
  bw_status status = BW_OK;
  bwi_two_level_solver *l = BW_NEW0(context, bwi_two_level_solver, 1);
  if (!l)
    return BW_MEMORY;
  bw_object_init(l, &two_level_solver_kind);
  bw_progress(context, "ordering", 0);
  if (bwi_two_level_applies(system)) {
    BW_TRY(bwi_coarse_create(context, system->mesh, &l->coarse));
    BW_TRY(bwi_coarse_count(context, l->coarse, system->dof_map));
    l->prediction = predict(system, l->coarse);
  } else
    BW_TRY(predict_linear(context, system, l));
done:
  if (status == BW_OK)
    system->two_level = l;
  else
    bw_release(l);
  return status;
}

bw_status bwi_two_level_make(bw_context *context, const bw_model *model, bw_system *system) {
  bw_status status = BW_OK;
  bwi_two_level *made = NULL;
  bool even, usable;
  if (!bwi_two_level_applies(system))
    return bwi_two_level_refused(context, "cholesky, or the preconditioner amg");
  if (!system->two_level)
    BW_TRY(bwi_two_level_predict(context, system));
  bwi_two_level_solver *l = system->two_level;
  if (l->preconditioner)
    return BW_OK;
  double start = bw_seconds();
  bw_progress(context, "factorisation", 0);
  BW_TRY(bwi_element_product_serves(context, system->mesh, system->material, &even));
  if (!even) /* what multiplies then is read from it */
    BW_TRY(bw_system_stiffness(context, system));
  const bwi_stiffness stiffness = {system->stiffness, system->mesh, system->material};
  BW_TRY(bwi_two_level_create_over(context, l->coarse, system->mesh, system->pattern, even,
                                   &stiffness, &made));
  BW_TRY(bwi_two_level_follow(context, made, model, system->dof_map, system->stiffness, &usable));
  if (!usable) {
    status =
        bw_fail(context, BW_SINGULAR,
                "the stiffness of the linear elements is singular, or so nearly that double "
                "precision cannot tell: parts touch only in a node or an edge, or elements have "
                "almost no volume (the solver cholesky says where)");
    goto done;
  }
  l->preconditioner = made;
  made = NULL;
  system->times.pcg += bw_seconds() - start;
done:
  bw_release(made);
  return status;
}
