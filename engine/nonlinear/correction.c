/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How far a coarse solution is off, without the fine one: a few cheap Newton steps of the fine
 * solid from there. Each takes few iterations of conjugate gradients over coarse solids, which
 * bring the smooth part of the error and, by their smoother, what lies inside coarse cells. How far
 * the steps went is the estimate. */
#include <math.h>
#include <string.h>

#include "nonlinear/newton.h"

/* One step along which the potential falls, from state->now; *moved false: there is none. */
static bw_status step(bwi_newton_state *state, bool *moved) {
  bw_status status = BW_OK;
  bool definite;
  double length = 0, slope;
  *moved = false;
  state->stiffness_current = false;
  BW_TRY(bwi_tangent_set(state, BWI_PROJECTED, &definite));
  bwi_newton_state_measure(state);
  for (int64_t i = 0; i < state->size; i++)
    state->work[i] = -state->residual[i];
  BW_TRY(bwi_tangent_solve(state, state->work, 1e-3, state->direction, NULL));
  slope = bwi_newton_state_dot(state, state->residual, state->direction);
  if (!(slope < 0))
    goto done;
  BW_TRY(bwi_newton_search(state, slope, &length));
  *moved = length > 0;
done:
  return status;
}

bw_status bw_solid_correct(bw_context *context, const bw_solid *solid,
                           const bw_load_case *load_case, const bw_newton_options *options,
                           double *displacement, bool *defined) {
  bw_status status = BW_OK;
  bw_newton *newton = NULL;
  bw_newton_report report = {0};
  bwi_newton_state state = {.context = context,
                            .solid = solid,
                            .load_case = load_case,
                            .options = options,
                            .report = &report};
  bool moved = true;
  if (!options->start || !options->solver || options->solver->options.kind != BW_SOLVER_PCG)
    return bw_fail(context, BW_INVALID,
                   "a correction needs initial displacements and the conjugate gradient solver");
  BW_TRY(bwi_newton_check(context, solid, load_case, options));
  BW_TRY(bw_newton_create(context, &newton));
  state.newton = newton;
  BW_TRY(bwi_newton_state_create(&state));
  state.load = 1;
  memcpy(state.now.u, options->start, (size_t)state.size * sizeof *displacement);
  for (int64_t i = 0; i < state.size; i++)
    if (load_case->constrained[i])
      state.now.u[i] = load_case->value[i];
  BW_TRY(bwi_newton_state_balance(&state, &state.now));
  *defined = state.now.shape.defined;
  if (!*defined)
    goto done;
  BW_TRY(bwi_tangent_blocks(&state));
  BW_TRY(bwi_contact_create(context, load_case, state.blocks, &state.contact));
  if (state.contact) {
    bwi_contact_begin(state.contact, state.now.u);
    BW_TRY(bwi_newton_state_balance(&state, &state.now));
  }
  for (int k = 0; k < options->iterations && moved; k++)
    BW_TRY(step(&state, &moved));
  memcpy(displacement, state.now.u, (size_t)state.size * sizeof *displacement);
done:
  bwi_newton_state_clear(&state);
  bw_free(report.history);
  bw_release(newton);
  return status;
}
