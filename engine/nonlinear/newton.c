/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Newton's method for a stable equilibrium at one load factor.
 *
 * The potential, strain energy less the work of loads plus the energy of contact, is the measure of
 * every step. The tangent is taken as it is while it is positive definite; where it is not, that
 * with every point's negative eigenvalues set to zero, and from then on that one, since the factor
 * of an indefinite tangent is work for nothing, until whole steps bring the residual down again.
 * Projected tangents are good where elements are badly out of shape, and far too stiff where the
 * solid as a whole is unstable, close to equilibria: there, and where projected ones take long, as
 * little is added to the diagonal as makes it positive definite.
 *
 * What is held moves in the first iteration, K_ff d_f = -(r_f + K_fh d_h), so that the rest of the
 * solid goes along: the only step that is not measured by the potential, since the problem changes
 * with it. It is taken when no element is inverted by it. */
#include "nonlinear/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Multipliers of contact are settled at residuals below this. */
#define SETTLE_BELOW 1e-3
/* Gaps of points that push, over the size of the solid. */
#define GAP 1e-11
/* Rounding in the forces of an element, over its stiffness times its size. */
#define NOISE (8 * DBL_EPSILON)
/* Where no step helps any more, residuals up to so many times that are taken for rounding. */
#define ROUGH 100
/* Residuals below this are near an equilibrium. */
#define NEAR 0.1
/* Residual below which the next iteration no longer changes whether the tangent is definite. */
#define NEARBY 1e-2
/* Displacements over the solid's size that no solid in balance has. */
#define AWAY 1e4
/* So many steps in succession that are shorter than this lead nowhere. */
#define SHORT 1e-2
enum {
  ESCAPES = 6,
  PATIENCE = 12,
  PREDICTED = 8,
  CREEPING = 8,
  MAX_ITERATIONS = 500,
  MAX_ITERATIONS_PER_STEP = 20
};
#define CG ((int64_t)100) /* iterations that are worth one of Newton's */

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
    if (!state->load_case->held[i])
      sum += a[i] * b[i];
  return sum;
}

bw_status bwi_newton_state_loads(bwi_newton_state *state, const double *u, double *load) {
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
  BW_TRY(bwi_newton_state_loads(state, at->u, at->load));
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
  double left = 0, applied = 0, held = 0, contact = 0, noise = 0, elastic = 0;
  double cell = fmax(grid->spacing[0], fmax(grid->spacing[1], grid->spacing[2]));
  for (int64_t i = 0; i < state->size; i++) {
    double touching = now->contact ? now->contact[i] : 0, other = now->load[i] - touching;
    double r = now->internal[i] - now->load[i];
    state->residual[i] = state->load_case->held[i] ? 0 : r;
    *(state->load_case->held[i] ? &held : &left) += r * r;
    applied += other * other;
    contact += touching * touching;
    if (!state->load_case->held[i]) {
      double stiff = state->blocks[3 * i + i % 3], term = stiff * (fabs(now->u[i]) + cell);
      elastic += fabs(stiff) * cell * cell;
      noise += term * term;
    }
  }
  state->noise = NOISE * sqrt(noise);
  state->elastic = elastic;
  state->reference = sqrt(applied) + sqrt(held) + sqrt(contact) + now->quadratic_size;
  double min = state->noise / state->options->tolerance;
  state->relative = left > 0 ? sqrt(left) / fmax(state->reference, min) : 0;
  if (!isfinite(state->relative))
    state->relative = DBL_MAX;
}

void bwi_newton_state_accept(bwi_newton_state *state) {
  bwi_energy_forces old = state->now;
  state->now = state->trial;
  state->trial = old;
  state->fresh = false;
}

static bw_status record(bwi_newton_state *state, double step, int32_t cg, double residual) {
  bw_newton_report *report = state->report;
  report->iterations++;
  if (!bw_grow(state->context, (void **)&report->history, &state->history_capacity,
               (size_t)report->history_count, 1, sizeof *report->history))
    return BW_MEMORY;
  report->history[report->history_count++] = (bw_newton_entry){
      .load = state->load,
      .energy = state->now.energy,
      .residual = residual,
      .step = step,
      .cg = cg,
      .contacts = (int32_t)(state->now.contacts < INT32_MAX ? state->now.contacts : INT32_MAX),
      .projected = state->tangent != BWI_PLAIN};
  return BW_OK;
}

/* Move what is held to where it is at this load factor, and the rest along. */
static bw_status move_held(bwi_newton_state *state, bool *moved) {
  bw_status status = BW_OK;
  int32_t cg = 0;
  double *d = state->direction, *moving = state->work, residual = state->relative;
  *moved = false;
  for (int64_t i = 0; i < state->size; i++)
    moving[i] = state->load_case->held[i] ? bwi_newton_state_target(state, i) - state->now.u[i] : 0;
  if (state->free > 0) {
    BW_TRY(bwi_tangent_multiply(state, moving, d));
    for (int64_t i = 0; i < state->size; i++)
      d[i] = state->load_case->held[i] ? 0 : -state->residual[i] - d[i];
    BW_TRY(bwi_tangent_solve(state, d, 1e-4, d, &cg));
    if (state->negative && state->tangent == BWI_PLAIN)
      return BW_OK; /* not yet: with another tangent */
  } else
    memset(d, 0, (size_t)state->size * sizeof *d);
  for (int64_t i = 0; i < state->size; i++) {
    d[i] += moving[i];
    state->trial.u[i] =
        state->load_case->held[i] ? bwi_newton_state_target(state, i) : state->now.u[i] + d[i];
  }
  BW_TRY(bwi_newton_state_balance(state, &state->trial));
  bool inverting = state->trial.shape.inverted > 0 && state->now.shape.inverted == 0;
  if (!state->trial.shape.defined || inverting) {
    BW_TRY(bwi_newton_cap(state->context, state->solid, state->now.u, d, inverting, &state->part));
    state->obstacle = BWI_INVERTING;
    goto done;
  }
  bwi_newton_state_accept(state);
  BW_TRY(record(state, 1, cg, residual));
  *moved = true;
done:
  return status;
}

/* Floors are stiff: a direction that does not know of them ends at the first that it meets, a
 * little of the way. So the direction is found again for the points that push at its end, until
 * these are those that it was found for: the minimum of the potential's parabola with contact
 * planes. It goes down, since what is added to a parabola where a point is about to push, or taken
 * away where it is about to leave, only makes a step towards its minimum lower. */
static bw_status predict_contacts(bwi_newton_state *state, double tolerance, double *slope,
                                  int32_t *cg) {
  bw_status status = BW_OK;
  size_t size = (size_t)state->size * sizeof(double);
  double *first = state->trial.internal, *linear = state->trial.load; /* not in use here */
  memcpy(first, state->direction, size);
  for (int k = 0; k < PREDICTED; k++) {
    bool changed, definite;
    int32_t more = 0;
    BW_TRY(bwi_tangent_predict_contact(state, &changed, &definite));
    if (!changed || !definite)
      break;
    memset(linear, 0, size);
    bwi_contact_linear(state->contact, linear);
    for (int64_t i = 0; i < state->size; i++)
      state->work[i] =
          state->load_case->held[i] ? 0 : linear[i] - state->now.contact[i] - state->residual[i];
    BW_TRY(bwi_tangent_solve(state, state->work, tolerance, state->direction, &more));
    *cg += more;
  }
  double along = bwi_newton_state_dot(state, state->residual, state->direction);
  if (along < 0)
    *slope = along;
  else
    memcpy(state->direction, first, size);
done:
  return status;
}

/* The direction -K^-1 r; where it does not go down (with follower pressures, whose tangent is not
 * symmetric, or an inexact solution), *slope is not negative. */
static bw_status find_direction(bwi_newton_state *state, double *slope, int32_t *cg) {
  bw_status status = BW_OK;
  double rate = state->previous > 0 ? state->relative / state->previous : 1;
  /* Eisenstat and Walker, choice 2 */
  double tolerance = fmin(0.1, 0.9 * rate * rate);
  tolerance = fmax(tolerance, fmin(0.1, 0.3 * state->options->tolerance / state->relative));
  if (state->tangent == BWI_SHIFTED)
    tolerance = fmin(tolerance, 1e-3);
  if (state->contact) /* gaps are to be closed much further than residuals */
    tolerance = fmin(tolerance, 1e-4);
  if (state->options->cg_tolerance > 0)
    tolerance = state->options->cg_tolerance;
  for (int64_t i = 0; i < state->size; i++)
    state->work[i] = -state->residual[i];
  BW_TRY(bwi_tangent_solve(state, state->work, tolerance, state->direction, cg));
  *slope = bwi_newton_state_dot(state, state->residual, state->direction);
  if (state->contact && *slope < 0)
    BW_TRY(predict_contacts(state, tolerance, slope, cg));
done:
  return status;
}

static bool must_move(const bwi_newton_state *state) {
  for (int64_t i = 0; i < state->size; i++)
    if (state->load_case->held[i] && state->now.u[i] != bwi_newton_state_target(state, i))
      return true;
  return false;
}

static double size_of(const bw_grid *grid) {
  double size = 0;
  for (int d = 0; d < 3; d++)
    size = fmax(size, grid->spacing[d] * grid->cells[d]);
  return size;
}

static double largest(const double *u, int64_t size) {
  double max = 0;
  for (int64_t i = 0; i < size; i++)
    max = fmax(max, fabs(u[i]));
  return max;
}

/* At a residual that is small enough: whether the state is stable; if not, leave it. */
static bw_status check_stable(bwi_newton_state *state, int *escapes, bool *stable) {
  bw_status status = BW_OK;
  bool definite = true, lower = false, decided = true, by_factor = false;
  *stable = true;
  state->undecided = false;
  /* a definite tangent one iteration ago says it for here, if that was near */
  bool near = state->previous < NEARBY && state->have_tangent && state->tangent == BWI_PLAIN &&
              !state->iterative;
  if (state->free == 0 || state->quadratic || near)
    return BW_OK;
  if (state->iterative)
    BW_TRY(bwi_choice_factor_search(state, &by_factor));
  if (by_factor) {
    state->iterative = state->fresh = false;
    status = bwi_tangent_set(state, BWI_PLAIN, &definite);
    state->iterative = true;
    state->fresh = false;
    if (status != BW_OK || definite)
      return status;
  }
  BW_TRY(bwi_tangent_set(state, BWI_PLAIN, &definite));
  if (definite && !state->iterative)
    return BW_OK;
  BW_TRY(bwi_newton_leave(state, &lower, &decided));
  state->undecided = !decided;
  if (!lower)
    return BW_OK;
  *stable = false;
  ++*escapes;
done:
  return status;
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

bw_status bwi_newton_equilibrium(bwi_newton_state *state, double load, bool *found) {
  bw_status status = BW_OK;
  const bw_newton_options *options = state->options;
  bwi_tangent kind = BWI_PLAIN;
  bool moving, crushed = false;
  double plain_below = 1; /* residual below which the tangent may be tried as it is again */
  int escapes = 0, projected = 0, creeping = 0;
  *found = false;
  state->load = load;
  state->obstacle = BWI_NO_OBSTACLE;
  state->part = state->previous = state->shift = state->projected_shift = 0;
  state->step = 1;
  state->have_tangent = state->negative = false;
  if (state->contact)
    bwi_contact_place(state->contact, load, state->begin != NULL);
  moving = must_move(state);
  BW_TRY(bwi_newton_state_balance(state, &state->now));
  for (int k = 0; k <= options->iterations; k++) {
    bool definite = false;
    int32_t cg = 0;
    double slope = 0, step = 0;
    if (!state->quadratic)
      bw_progress(state->context, "equilibrium",
                  fmax(state->reached, 1 - bwi_newton_left(state, NULL)));
    BW_TRY(bw_check_cancel(state->context));
    bwi_newton_state_measure(state);
    if (!state->quadratic &&
        largest(state->now.u, state->size) > AWAY * size_of(state->solid->grid)) {
      state->obstacle = BWI_STIFFNESS;
      goto done;
    }
    double gap = state->contact ? bwi_contact_error(state->contact) : 0;
    bool small = state->relative <= options->tolerance;
    if (!moving && gap > GAP * size_of(state->solid->grid) &&
        state->relative <= fmax(SETTLE_BELOW, options->tolerance)) {
      bwi_contact_settle(state->contact);
      BW_TRY(bwi_newton_state_balance(state, &state->now));
      bwi_newton_state_measure(state);
    } else if (!moving && small) {
      bool stable;
      if (state->now.shape.inverted > 0 && !options->allow_inverted) {
        state->obstacle = BWI_INVERTED;
        goto done;
      }
      BW_TRY(check_stable(state, &escapes, &stable));
      *found = stable;
      if (stable)
        goto done;
      if (escapes > ESCAPES) {
        state->obstacle = BWI_UNSTABLE;
        goto done;
      }
      kind = BWI_SHIFTED;
      plain_below = 1e-2;
      bwi_newton_state_measure(state);
    }
    if (k == options->iterations)
      break;
    if (bwi_newton_left(state, NULL) <= 0) {
      state->obstacle = BWI_WORK;
      goto done;
    }
    double residual = state->relative;
    if (state->iterative) {
      bool by_factor;
      BW_TRY(bwi_choice_factor(state, &by_factor));
      if (by_factor)
        state->iterative = state->fresh = false;
    }
    if (state->free > 0) {
      if (kind == BWI_PROJECTED && ++projected > PATIENCE)
        kind = BWI_SHIFTED;
      BW_TRY(bwi_tangent_set(state, kind, &definite));
      if (!definite && kind == BWI_PLAIN) {
        kind = state->relative < NEAR || projected > PATIENCE ? BWI_SHIFTED : BWI_PROJECTED;
        plain_below = fmin(plain_below, state->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(state, kind, &definite));
      }
      if (!definite && kind == BWI_SHIFTED && !crushed) { /* what elements need, at least once */
        crushed = true;
        kind = BWI_PROJECTED;
        projected = 0;
        plain_below = fmin(plain_below, state->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(state, kind, &definite));
      }
      if (!definite) {
        state->obstacle = kind == BWI_SHIFTED ? BWI_CRUSHED : BWI_STIFFNESS;
        goto done;
      }
    }
    if (moving) {
      bool moved;
      BW_TRY(move_held(state, &moved));
      if (!moved && state->obstacle == BWI_NO_OBSTACLE) {
        kind = BWI_PROJECTED;
        plain_below *= 1e-2;
        continue;
      }
      if (!moved)
        goto done;
      moving = false;
      state->have_tangent = false; /* it was that of another shape */
      continue;
    }
    BW_TRY(find_direction(state, &slope, &cg));
    while (state->negative && state->tangent != BWI_PROJECTED) { /* as where a factor fails */
      int32_t further = 0;
      bool stiffer;
      BW_TRY(bwi_tangent_stiffen(state, &stiffer));
      if (!stiffer) {
        bool close = state->relative < NEAR || projected > PATIENCE;
        kind = close && kind == BWI_PLAIN ? BWI_SHIFTED : BWI_PROJECTED;
        plain_below = fmin(plain_below, state->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(state, kind, &definite));
      }
      BW_TRY(find_direction(state, &slope, &further));
      cg += further;
    }
    if (slope < 0)
      BW_TRY(bwi_newton_search(state, slope, &step));
    if (step == 0) {
      BW_TRY(record(state, 0, cg, residual));
      /* as good as it gets: some laws round more than the noise allows for */
      double min = state->noise / options->tolerance;
      double left = state->relative * fmax(state->reference, min);
      if (left <= ROUGH * state->noise && gap <= GAP * size_of(state->solid->grid) &&
          (state->now.shape.inverted == 0 || options->allow_inverted)) {
        *found = true;
        goto done;
      }
      if (kind == BWI_PLAIN) { /* once more with a direction that is sure to go down */
        kind = BWI_PROJECTED;
        plain_below = fmin(plain_below, state->relative) * 1e-2;
        continue;
      }
      state->obstacle = BWI_SEARCH;
      goto done;
    }
    state->previous = residual;
    state->step = step;
    BW_TRY(record(state, step, cg, residual));
    creeping = step < SHORT ? creeping + 1 : 0;
    if (creeping == CREEPING) {
      state->obstacle = BWI_CREEPING;
      goto done;
    }
    if (kind != BWI_PLAIN && step >= 1) {
      bwi_newton_state_measure(state);
      if (state->relative <= fmin(plain_below, NEAR))
        kind = BWI_PLAIN;
    }
  }
  state->obstacle = BWI_ITERATIONS;
done:
  return status;
}
