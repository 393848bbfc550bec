/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The quadratic term of a step in time. */
#include <math.h>

#include "nonlinear/newton.h"

bw_status bwi_quadratic_evaluate(bwi_newton_state *state, bwi_energy_forces *at) {
  bw_status status = BW_OK;
  const bwi_quadratic *q = state->quadratic;
  double *moved = q->workspace[0], *product = q->workspace[1], energy = 0, size = 0;
  bool stiff = q->stiffness || q->linear;
  for (int64_t i = 0; stiff && i < state->size; i++)
    moved[i] = at->u[i] - q->centre[i];
  if (q->linear)
    BW_TRY(bw_solid_linear_multiply(state->context, q->linear, moved, product));
  else if (stiff)
    BW_TRY(bw_block_multiply(state->context, state->solid->pattern, q->stiffness, 9, 3, 1, moved,
                             product));
  for (int64_t i = 0; i < state->size; i++) {
    double off = at->u[i] - q->centre[i];
    double slope = q->of_mass * state->solid->mass[i / 3] * off;
    if (stiff)
      slope += q->of_stiffness * product[i];
    energy += (0.5 * slope + q->force[i]) * off;
    slope += q->force[i];
    at->internal[i] += slope;
    if (!state->load_case->constrained[i])
      size += slope * slope;
  }
  at->quadratic_energy = energy;
  at->quadratic_size = sqrt(size);
done:
  return status;
}

void bwi_quadratic_stiffness(bwi_newton_state *state) {
  const bwi_quadratic *q = state->quadratic;
  const bw_block_pattern *pattern = state->solid->pattern;
  double *stiffness = state->newton->stiffness;
  for (int64_t k = 0; q->stiffness && k < 9 * pattern->block_count; k++)
    stiffness[k] += q->of_stiffness * q->stiffness[k];
  for (int64_t n = 0; n < pattern->node_count; n++) {
    double *block = stiffness + 9 * (pattern->start[n + 1] - 1);
    for (int c = 0; c < 3; c++)
      block[4 * c] += q->of_mass * state->solid->mass[n];
    for (int k = 0; k < 9; k++)
      state->blocks[9 * n + k] = block[k];
  }
}
