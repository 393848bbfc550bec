/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The state of Newton's method: displacements, energy, forces and residual at one load factor, and
 * what is left of the iterations allowed. The potential is the strain energy, less the work of
 * loads, plus the energies of contact and of the quadratic term. */
#include "nonlinear/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounding in the forces of an element, over its stiffness times its size. */
#define NOISE (8 * DBL_EPSILON)
enum { MAX_ITERATIONS = 500, MAX_ITERATIONS_PER_STEP = 20 };
#define CG ((int64_t)100) /* iterations that cost as much as one of Newton's */

const char *bwi_obstacle_text(bwi_obstacle obstacle) {
  static const char *const why[] = {
      [BWI_NO_OBSTACLE] = "",
      [BWI_ITERATIONS] = "the iterations did not suffice",
      [BWI_WORK] = "all iterations that are allowed together were used up",
      [BWI_CREEPING] = "only very short steps lower the potential",
      [BWI_SEARCH] = "no step lowers the potential any more",
      [BWI_INVERTING] = "moving what is constrained inverts elements",
      [BWI_UNSTABLE] = "one unstable equilibrium followed on another",
      [BWI_STIFFNESS] = "something can move without any force",
      [BWI_CRUSHED] = "elements are so far out of shape that there is no tangent to solve with",
      [BWI_INVERTED] = "the equilibrium has inverted elements"};
  return why[obstacle];
}

void bwi_newton_state_clear(bwi_newton_state *state) {
  bw_free(state->dead);
  bw_free(state->begin);
  bw_free(state->initial_residual);
  bw_free(state->follower);
  bwi_precondition_destroy(state->precondition);
  bwi_contact_destroy(state->contact);
  bwi_energy_forces_clear(&state->now);
  bwi_energy_forces_clear(&state->trial);
  bw_free(state->blocks);
  bw_free(state->residual);
  bw_free(state->direction);
  bw_free(state->work);
}

bw_status bwi_newton_state_create(bwi_newton_state *state) {
  bw_status status = BW_OK;
  bw_context *context = state->context;
  const bw_newton_options *o = state->options;
  int64_t n = state->size = 3 * (int64_t)state->solid->grid->node_count;
  BW_TRY(bwi_newton_plan_make(context, o->solver, o->coarse_count, state->solid->grid->node_count,
                              &state->plan));
  for (int64_t i = 0; i < n; i++)
    state->free += !state->load_case->constrained[i];
  state->follows = bwi_load_case_follows(state->load_case);
  state->dead = BW_NEW(context, double, n);
  state->blocks = BW_NEW0(context, double, 3 * n);
  state->residual = BW_NEW0(context, double, n);
  state->direction = BW_NEW0(context, double, n);
  state->work = BW_NEW0(context, double, n);
  if (!state->dead || !state->blocks || !state->residual || !state->direction || !state->work)
    return BW_MEMORY;
  BW_TRY(
      bwi_energy_forces_create(context, n, state->load_case->contact_plane_count > 0, &state->now));
  BW_TRY(bwi_energy_forces_create(context, n, state->load_case->contact_plane_count > 0,
                                  &state->trial));
  state->iterative = state->plan.iterative;
  if (state->follows && (!state->iterative || state->plan.by_cost)) {
    state->follower = BW_NEW(context, double, 9 * state->solid->pattern->block_count);
    if (!state->follower)
      return BW_MEMORY;
  }
  BW_TRY(bwi_load_case_dead(context, state->solid, state->load_case, state->dead));
done:
  return status;
}

bw_status bwi_energy_forces_create(bw_context *context, int64_t size, bool contact,
                                   bwi_energy_forces *at) {
  *at = (bwi_energy_forces){0};
  at->u = BW_NEW0(context, double, size);
  at->internal = BW_NEW0(context, double, size);
  at->load = BW_NEW0(context, double, size);
  at->contact = contact ? BW_NEW0(context, double, size) : NULL;
  return at->u && at->internal && at->load && (!contact || at->contact) ? BW_OK : BW_MEMORY;
}

void bwi_energy_forces_clear(bwi_energy_forces *at) {
  bw_free(at->u);
  bw_free(at->internal);
  bw_free(at->load);
  bw_free(at->contact);
  *at = (bwi_energy_forces){0};
}

double bwi_newton_state_dot(const bwi_newton_state *state, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < state->size; i++)
    if (!state->load_case->constrained[i])
      sum += a[i] * b[i];
  return sum;
}

/* Loads but for those of contact planes, at displacements u. */
static bw_status newton_state_loads(bwi_newton_state *state, const double *u, double *load) {
  double factor = state->initial_residual ? 1 : state->load;
  for (int64_t i = 0; i < state->size; i++)
    load[i] = factor * state->dead[i] +
              (state->initial_residual ? (1 - state->load) * state->initial_residual[i] : 0);
  return state->follows ? bwi_load_case_follow(state->context, state->load_case, u, factor, load)
                        : BW_OK;
}

bw_status bwi_newton_state_balance(bwi_newton_state *state, bwi_energy_forces *at) {
  bw_status status = BW_OK;
  double before = bw_seconds(), sum = 0;
  BW_TRY(bw_solid_evaluate(state->context, state->solid, at->u, false, &at->energy, at->internal,
                           NULL, &at->shape));
  state->report->evaluations++;
  state->report->seconds_quadrature += bw_seconds() - before;
  if (!at->shape.defined)
    goto done;
  BW_TRY(newton_state_loads(state, at->u, at->load));
  if (state->quadratic)
    BW_TRY(bwi_quadratic_evaluate(state, at));
  at->contact_energy = 0;
  at->contacts = 0;
  if (state->contact) {
    memset(at->contact, 0, (size_t)state->size * sizeof *at->contact);
    at->contacts = bwi_contact_evaluate(state->contact, at->u, &at->contact_energy, at->contact);
    for (int64_t i = 0; i < state->size; i++)
      at->load[i] += at->contact[i];
  }
  for (int64_t i = 0; i < state->size; i++)
    sum += fabs(at->internal[i]) + fabs(at->load[i]);
  at->shape.defined = isfinite(sum) && isfinite(at->energy) && isfinite(at->contact_energy);
done:
  return status;
}

void bwi_newton_state_measure(bwi_newton_state *state) {
  const bwi_energy_forces *now = &state->now;
  const bw_grid *grid = state->solid->grid;
  double left = 0, applied = 0, constrained = 0, contact = 0, noise = 0, elastic = 0;
  double cell = fmax(grid->spacing[0], fmax(grid->spacing[1], grid->spacing[2]));
  for (int64_t i = 0; i < state->size; i++) {
    double touching = now->contact ? now->contact[i] : 0, other = now->load[i] - touching;
    double r = now->internal[i] - now->load[i];
    state->residual[i] = state->load_case->constrained[i] ? 0 : r;
    *(state->load_case->constrained[i] ? &constrained : &left) += r * r;
    applied += other * other;
    contact += touching * touching;
    if (!state->load_case->constrained[i]) {
      double stiff = state->blocks[3 * i + i % 3], term = stiff * (fabs(now->u[i]) + cell);
      elastic += fabs(stiff) * cell * cell;
      noise += term * term;
    }
  }
  state->noise = NOISE * sqrt(noise);
  state->elastic = elastic;
  state->reference = sqrt(applied) + sqrt(constrained) + sqrt(contact) + now->quadratic_size;
  double min = state->noise / state->options->tolerance;
  state->relative = left > 0 ? sqrt(left) / fmax(state->reference, min) : 0;
  if (!isfinite(state->relative))
    state->relative = DBL_MAX;
}

void bwi_newton_state_accept(bwi_newton_state *state) {
  bwi_energy_forces old = state->now;
  state->now = state->trial;
  state->trial = old;
  state->stiffness_current = false;
}

double bwi_newton_left(const bwi_newton_state *state, int64_t *of_cg) {
  const bw_newton_options *o = state->options;
  const bw_newton_report *report = state->report;
  int64_t max = CG * (o->max_iterations > 0
                          ? o->max_iterations
                          : MAX_ITERATIONS + (int64_t)MAX_ITERATIONS_PER_STEP * (o->steps - 1));
  int64_t left =
      max - CG * report->iterations - report->cg_iterations - report->stability_iterations;
  if (of_cg)
    *of_cg = left > 0 ? left : 0;
  return left > 0 ? (double)left / (double)max : 0;
}
