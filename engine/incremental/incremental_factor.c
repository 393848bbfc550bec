/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The factor of a system that follows edits: kept, updated in part, rebuilt where the
 * unknowns are others or an update failed. */
#include <string.h>

#include "incremental/incremental.h"

void bwi_incremental_note(bwi_incremental_way way, bw_reuse *reuse) {
  bool pcg = way == BWI_PCG || way == BWI_ITERATE;
  reuse->solver = bw_solver_word(pcg ? BW_SOLVER_PCG : BW_SOLVER_CHOLESKY);
  reuse->preconditioner = way == BWI_PCG       ? bw_solver_word(BW_SOLVER_TWO_LEVEL)
                          : way == BWI_ITERATE ? bw_solver_word(BW_SOLVER_CHOLESKY)
                                               : "";
  reuse->full = way == BWI_FULL;
}

bool bwi_incremental_usable(const bw_incremental_system *incremental) {
  return incremental->inner->factor && !incremental->inner->factor->broken;
}

bool bwi_incremental_current(const bw_incremental_system *incremental) {
  const bwi_incremental *inner = incremental->inner;
  if (!bwi_incremental_usable(incremental))
    return false;
  for (int32_t d = 0; d < inner->subdomain_count; d++)
    if (inner->touched[d])
      return false;
  return true;
}

/* Where the backend is open, that of the factor there is, if it has the precision. */
static bool wants_cholmod(const bwi_incremental *inner) {
  return inner->wanted_backend == BW_BACKEND_CHOLMOD ||
         (inner->wanted_backend == BW_BACKEND_AUTO && inner->wanted_bits != 32 && inner->factor &&
          inner->factor->cholmod);
}

/* Whether the factor there is (or NULL) is of another backend, order or precision than asked
 * for. */
static bool incremental_other_factor(const bw_incremental_system *incremental) {
  const bwi_incremental *inner = incremental->inner;
  const bwi_factor *factor = inner->factor;
  if (!factor)
    return false;
  bool cholmod = wants_cholmod(inner);
  if (cholmod != (factor->cholmod != NULL))
    return true;
  if (inner->wanted_ordering != BW_ORDERING_AUTO &&
      inner->wanted_ordering != factor->symbolic->order->ordering)
    return true;
  return inner->wanted_bits && !inner->double_only && !cholmod &&
         factor->kernels->bits != inner->wanted_bits;
}

/* A factor for other unknowns, or in another precision, by another backend or in another order, by
 * the old order where that fits. */
static bw_status refactor_full(bw_context *context, bw_incremental_system *incremental,
                               const bwi_matrix *matrix, int *bits, bw_reuse *reuse, int32_t *bad) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  const bwi_symbolic *old = inner->reach ? inner->reach->symbolic : NULL;
  bw_solve_times *times = &incremental->system->times;
  bwi_symbolic *symbolic = NULL;
  bwi_elimination_reach *reach = NULL;
  double start = bw_seconds();
  bool cholmod = wants_cholmod(inner);
  bw_release(inner->factor);
  inner->factor = NULL;
  bw_progress(context, "ordering", 0);
  BW_TRY(bwi_symbolic_for(context, matrix->pattern, matrix->dof_map, inner->wanted_ordering,
                          inner->subdomain_count, inner->element_subdomain,
                          inner->edits.count ? &inner->edits : NULL, (bwi_symbolic *)old,
                          &symbolic));
  BW_TRY(bwi_elimination_reach_create(context, symbolic, inner->model->mesh, inner->subdomain_count,
                                      inner->element_subdomain, &reach));
  if (reuse)
    reuse->ordering = old && symbolic->order == old->order;
  bw_release(inner->reach);
  inner->reach = bw_retain(reach);
  times->order = bw_seconds() - start;
  times->factor_entries = symbolic->panel[symbolic->order->super_count];
  times->factor_flops = symbolic->flops;
  if (cholmod)
    *bits = 64;
  else
    BW_TRY(bwi_incremental_choose_bits(context, incremental, reach, bits));
  bw_progress(context, "factorisation", 0);
  BW_TRY(bwi_factor_create_in(context, symbolic, matrix, reach,
                              cholmod       ? &bwi_kernels_cholmod
                              : *bits == 32 ? &bwi_kernels_single
                                            : &bwi_kernels_double,
                              &inner->factor, bad));
done:
  bw_release(symbolic);
  bw_release(reach);
  return status;
}

/* The factor is now that of the stiffness. */
static void is_current(bw_incremental_system *incremental) {
  bwi_incremental *inner = incremental->inner;
  const bw_system *view = incremental->system;
  memset(inner->touched, 0, (size_t)inner->subdomain_count);
  inner->excess_seconds = 0;
  bw_retain(view->mesh);
  bw_release(inner->factored);
  inner->factored = view->mesh;
  bw_retain(view->material);
  bw_release(inner->factored_material);
  inner->factored_material = view->material;
  memcpy(inner->factored_frame, inner->frame,
         9 * (size_t)inner->subdomain_count * sizeof *inner->frame);
  inner->spent = 0;
  inner->change = -1;
}

static bw_status update_or_make(bw_context *context, bw_incremental_system *incremental, bool whole,
                                bw_reuse *reuse, double *kept) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  const bw_system *view = incremental->system;
  bwi_matrix matrix = {
      .pattern = view->pattern, .stiffness = view->stiffness, .dof_map = view->dof_map};
  int bits = inner->factor ? inner->factor->kernels->bits : 0, wanted = bits;
  int32_t bad = 0;
  double flops = 0;
  bool other = incremental_other_factor(incremental);
  if (inner->factor && !inner->factor->cholmod)
    BW_TRY(bwi_incremental_choose_bits(context, incremental, inner->reach, &wanted));
  if (inner->factor && bits == wanted && !other) {
    bw_progress(context, "factorisation", 0);
    status = bwi_factor_update(context, inner->factor, &matrix, whole ? NULL : inner->touched,
                               &flops, &bad);
    if (inner->factor->symbolic->flops > 0)
      *kept = 1 - flops / inner->factor->symbolic->flops;
  } else
    status = refactor_full(context, incremental, &matrix, &wanted, reuse, &bad);
  if (status == BW_SINGULAR && wanted == 32) { /* perhaps for want of digits only */
    inner->double_only = true;
    wanted = 64;
    *kept = 0;
    status = refactor_full(context, incremental, &matrix, &wanted, reuse, &bad);
    if (status == BW_SINGULAR)
      inner->double_only = false;
    if (status == BW_OK) {
      bw_clear_failure(context);
      bw_warn(context,
              "the factorisation in single precision failed at node %d: these equations are solved "
              "in double precision from now on",
              bad + 1);
    }
  }
  if (status == BW_SINGULAR)
    status = bwi_fail_singular(context, view->mesh, bad);
done:
  return status;
}

bw_status bwi_incremental_factor(bw_context *context, bw_incremental_system *incremental, bool full,
                                 bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  double start = bw_seconds(), kept = 0;
  bool whole = full || !bwi_incremental_usable(incremental);
  bool other = incremental_other_factor(incremental);
  if (bwi_incremental_current(incremental) && !full && !other) {
    if (reuse && !reuse->solver) { /* else it says what an earlier solve did */
      bwi_incremental_note(BWI_REFACTOR, reuse);
      reuse->factor_reused = 1;
    }
    goto done;
  }
  const bwi_kernels *kernels = inner->factor ? inner->factor->kernels : NULL;
  BW_TRY(update_or_make(context, incremental, whole, reuse, &kept));
  is_current(incremental);
  incremental->system->times.factor = bw_seconds() - start;
  if (reuse) {
    bool made = other || inner->factor->kernels != kernels;
    bwi_incremental_note(whole || made ? BWI_FULL : BWI_REFACTOR, reuse);
    reuse->factor_reused = kept;
    reuse->seconds_factor += bw_seconds() - start;
  }
done:
  if (status == BW_OK && reuse)
    reuse->precision = inner->factor->kernels->bits;
  return status;
}

bw_status bwi_incremental_use_double(bw_context *context, bw_incremental_system *incremental,
                                     bw_reuse *reuse) {
  bw_status status = BW_OK;
  double start = bw_seconds(), kept = 0;
  incremental->inner->double_only = true;
  bw_warn(context, "solutions with the factor in single precision do not converge: these equations "
                   "are solved in double precision from now on");
  BW_TRY(update_or_make(context, incremental, true, reuse, &kept));
  is_current(incremental);
  incremental->system->times.factor = bw_seconds() - start;
  if (reuse) {
    bwi_incremental_note(BWI_FULL, reuse);
    reuse->factor_reused = 0;
    reuse->precision = 64;
    reuse->seconds_factor += bw_seconds() - start;
  }
done:
  return status;
}
