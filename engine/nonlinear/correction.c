/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How far a coarse solution is off, without the fine one: a few cheap Newton steps of the fine
 * solid from there. Each takes few iterations of conjugate gradients over coarse solids, which
 * bring the smooth part of the error and, by their smoother, what lies inside coarse cells. How far
 * the steps went is the estimate. */
#include <math.h>
#include <string.h>

#include "nonlinear/newton.h"

/* One step along which the potential falls, from walk->now; *moved false: there is none. */
static bw_status step(bwi_walk *walk, bool *moved) {
  bw_status status = BW_OK;
  bool definite;
  double length = 0, slope;
  *moved = false;
  walk->fresh = false;
  BW_TRY(bwi_tangent_set(walk, BWI_PROJECTED, &definite));
  bwi_walk_measure(walk);
  for (int64_t i = 0; i < walk->size; i++)
    walk->work[i] = -walk->residual[i];
  BW_TRY(bwi_tangent_solve(walk, walk->work, 1e-3, walk->direction, NULL));
  slope = bwi_walk_dot(walk, walk->residual, walk->direction);
  if (!(slope < 0))
    goto done;
  BW_TRY(bwi_newton_search(walk, slope, &length));
  *moved = length > 0;
done:
  return status;
}

bw_status bw_solid_correct(bw_context *context, const bw_solid *solid, const bw_solid_case *the,
                           const bw_newton_options *options, double *displacement, bool *defined) {
  bw_status status = BW_OK;
  bw_newton *newton = NULL;
  bw_newton_report report = {0};
  bwi_walk walk = {
      .context = context, .solid = solid, .the = the, .options = options, .report = &report};
  bool moved = true;
  if (!options->start || options->linear == BW_NEWTON_DIRECT)
    return bw_fail(context, BW_INVALID,
                   "a correction begins at displacements, and is one of conjugate gradients");
  BW_TRY(bwi_newton_check(context, solid, the, options));
  BW_TRY(bw_newton_create(context, &newton));
  walk.newton = newton;
  BW_TRY(bwi_walk_create(&walk));
  walk.load = 1;
  memcpy(walk.now.u, options->start, (size_t)walk.size * sizeof *displacement);
  for (int64_t i = 0; i < walk.size; i++)
    if (the->held[i])
      walk.now.u[i] = the->value[i];
  BW_TRY(bwi_walk_balance(&walk, &walk.now));
  *defined = walk.now.shape.defined;
  if (!*defined)
    goto done;
  BW_TRY(bwi_tangent_blocks(&walk));
  BW_TRY(bwi_contact_create(context, the, walk.blocks, &walk.contact));
  if (walk.contact) {
    bwi_contact_begin(walk.contact, walk.now.u);
    BW_TRY(bwi_walk_balance(&walk, &walk.now));
  }
  for (int k = 0; k < options->iterations && moved; k++)
    BW_TRY(step(&walk, &moved));
  memcpy(displacement, walk.now.u, (size_t)walk.size * sizeof *displacement);
done:
  bwi_walk_clear(&walk);
  bw_free(report.history);
  bw_release(newton);
  return status;
}
