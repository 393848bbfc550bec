/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Joined models that follow edits: the stiffness of the bodies apart is updated by subdomains, what
 * the joints make of it is computed at each shape.
 *
 * Invariant: `stiffness` is that of `model`, without what its attachments add. `inverse` is that of
 * T^T K T when it was last solved by a factor, of whatever shape. */
#include <math.h>

#include "barwright/job.h"
#include "joint/internal.h"
#include "linear/matrix_factor.h"
#include "model/internal.h"
#include "statics/internal.h"

struct bw_joined_incremental {
  bw_object object;
  const bw_model *model; /* retained: last synchronised */
  bw_subdomain_stiffness *stiffness;
  bw_operator *inverse; /* or NULL */
};

static void joined_destroy(void *object) {
  bw_joined_incremental *joined = object;
  bw_release(joined->model);
  bw_release(joined->stiffness);
  bw_release(joined->inverse);
  bw_free(joined);
}

static size_t joined_bytes(const void *object) {
  const bw_joined_incremental *joined = object;
  const bwi_factor *factor = bwi_operator_factor(joined->inverse);
  return sizeof *joined + bw_bytes(joined->stiffness) + (factor ? bwi_factor_bytes(factor) : 0);
}

static const bw_kind joined_kind = {"joined incremental system", joined_destroy, joined_bytes};

const bw_mesh *bw_joined_incremental_mesh(const bw_joined_incremental *joined) {
  return joined->model->mesh;
}

const bw_subdomain_stiffness *bw_joined_incremental_stiffness(const bw_joined_incremental *joined) {
  return joined->stiffness;
}

bw_status bw_joined_incremental_create(bw_context *context, const bw_model *model,
                                       bool rotate_material, int32_t subdomain_count,
                                       const int32_t *element_subdomain,
                                       const int32_t *node_subdomain, bw_joined_incremental **out) {
  bw_status status = BW_OK;
  bw_block_pattern *pattern = NULL;
  bw_joined_incremental *joined = NULL;
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  joined = BW_NEW0(context, bw_joined_incremental, 1);
  if (!joined)
    return BW_MEMORY;
  bw_object_init(joined, &joined_kind);
  joined->model = bw_retain(model);
  BW_TRY(bw_block_pattern_create(context, model->mesh, &pattern));
  BW_TRY(bw_subdomain_stiffness_create(context, pattern, model->mesh, model->material,
                                       rotate_material, subdomain_count, element_subdomain,
                                       node_subdomain, &joined->stiffness));
done:
  bw_release(pattern);
  if (status == BW_OK)
    *out = joined;
  else
    bw_release(joined);
  return status;
}

bw_status bw_joined_incremental_update(bw_context *context, bw_joined_incremental *joined,
                                       const bw_model *model, const bw_subdomain_motion *motion,
                                       bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_subdomain_change change;
  bw_subdomain_stiffness *stiffness = joined->stiffness;
  double start = bw_seconds();
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  if (!bwi_same_topology(model->mesh, joined->model->mesh))
    return bw_fail(context, BW_INVALID,
                   "the edited model has a mesh of %d nodes and %d elements, the system one of %d "
                   "and %d: the elements must be the same",
                   model->mesh->node_count, model->mesh->element_count,
                   joined->model->mesh->node_count, joined->model->mesh->element_count);
  BW_TRY(bw_subdomain_stiffness_update(context, stiffness, model->mesh, model->material, motion,
                                       &change));
  bw_retain(model);
  bw_release(joined->model);
  joined->model = model;
  joined->object.revision++;
  if (reuse) {
    int32_t count = 0;
    for (int32_t d = 0; d < stiffness->subdomain_count; d++)
      count += stiffness->changed[d];
    int32_t left = stiffness->subdomain_count - count;
    *reuse = (bw_reuse){.subdomains = stiffness->subdomain_count, .subdomains_changed = count};
    reuse->subdomains_reused = change.kept < left ? change.kept : left;
    reuse->subdomains_rotated = left - reuse->subdomains_reused;
    reuse->seconds_stiffness = bw_seconds() - start;
  }
done:
  return status;
}

/* The largest difference to the solution from scratch, relative to the largest displacement. */
static bw_status compare(bw_context *context, const bw_model *model,
                         const bw_statics_options *options, const bw_static *result,
                         bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_static *fresh = NULL;
  double largest = 0, off = 0;
  BW_TRY(bw_joined_statics(context, model, options, &fresh));
  for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++) {
    largest = fmax(largest, fabs(fresh->displacement[i]));
    off = fmax(off, fabs(fresh->displacement[i] - result->displacement[i]));
  }
  reuse->difference_solution = largest > 0 ? off / largest : off;
  if (!(reuse->difference_solution <= 1e-8))
    BW_TRY(bw_fail(context, BW_INTERNAL,
                   "the displacement of the joined bodies differs by %.3g of the largest from that "
                   "of equations made from scratch",
                   reuse->difference_solution));
done:
  bw_release(fresh);
  return status;
}

bw_status bw_joined_incremental_statics(bw_context *context, bw_joined_incremental *joined,
                                        const bw_model *model, const bw_statics_options *options,
                                        bool check, bw_static **out, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_joined_equations q = {0};
  bwi_inverse_reuse reused = BWI_REUSED_NONE;
  bw_reuse own = {0}, *r = reuse ? reuse : &own;
  bw_static *result = NULL;
  double start = bw_seconds(), opened, factored;
  if (model != joined->model)
    return bw_fail(context, BW_INVALID,
                   "the model is not the one that the system last followed: update the system "
                   "first");
  BW_TRY(bwi_joined_check_options(context, options));
  BW_TRY(bwi_joined_open(context, model, false, joined->stiffness, &q));
  opened = bw_seconds();
  if (q.rigid_count == 0 && q.reduction.unknown_count > 0 && !(options && options->solver)) {
    status = bwi_operator_inverse_follow(context, q.k->matrix, &joined->inverse, &reused);
    if (status == BW_SINGULAR)
      status = bwi_joined_check_residual(context, -1);
    BW_TRY(status);
    q.inverse = joined->inverse;
  }
  factored = bw_seconds();
  BW_TRY(bwi_joined_static(context, model, options, &q, start, &result));
  const bwi_factor *factor = bwi_operator_factor(q.inverse);
  if (factor) {
    result->report.reused = reused == BWI_REUSED_FACTOR;
    result->report.flops = reused == BWI_REUSED_FACTOR ? 0 : bwi_factor_flops(factor);
  }
  r->pattern = r->ordering = reused != BWI_REUSED_NONE;
  r->full = reused != BWI_REUSED_FACTOR;
  r->factor_reused = reused == BWI_REUSED_FACTOR;
  r->precision = 64;
  r->solver = result->report.solver;
  r->preconditioner = result->report.preconditioner;
  r->iterations += result->report.iterations;
  r->seconds_unknowns += opened - start;
  r->seconds_factor += factored - opened;
  r->seconds_solve += bw_seconds() - factored;
  if (check)
    BW_TRY(compare(context, model, options, result, r));
done:
  bwi_joined_clear(&q);
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}
