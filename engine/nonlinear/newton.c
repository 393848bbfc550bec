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
 * What is constrained moves in the first iteration, K_ff d_f = -(r_f + K_fh d_h), so that the rest
 * of the solid goes along: the only step that is not measured by the potential, since the problem
 * changes with it. It is taken when no element is inverted by it. */
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

/* Multipliers of contact are settled at residuals below this. */
#define SETTLE_BELOW 1e-3
/* Gaps of points that push, over the size of the solid. */
#define GAP 1e-11
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
  MAX_ESCAPES = 6,
  MAX_PROJECTED = 12,  /* projected tangents, before shifted ones are taken */
  MAX_PREDICTIONS = 8, /* directions for one tangent, each with other points in contact */
  MAX_SHORT_STEPS = 8
};

/* What the iterations at one load factor remember. They end with an equilibrium or an obstacle. */
typedef struct iterations {
  bwi_newton_state *state;
  bwi_tangent kind;   /* of the next tangent */
  double plain_below; /* residual below which the tangent may be tried as it is again */
  double gap;         /* of points that push, m */
  int escapes, projected, short_steps;
  bool moving;  /* what is constrained has yet to move */
  bool crushed; /* a shifted tangent failed once */
} iterations;

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

/* Move what is constrained to where it is at this load factor, and the rest along. */
static bw_status move_constrained(bwi_newton_state *state, bool *moved) {
  bw_status status = BW_OK;
  int32_t cg = 0;
  double *d = state->direction, *moving = state->work, residual = state->relative;
  *moved = false;
  for (int64_t i = 0; i < state->size; i++)
    moving[i] =
        state->load_case->constrained[i] ? bwi_newton_state_target(state, i) - state->now.u[i] : 0;
  if (state->free > 0) {
    BW_TRY(bwi_tangent_multiply(state, moving, d));
    for (int64_t i = 0; i < state->size; i++)
      d[i] = state->load_case->constrained[i] ? 0 : -state->residual[i] - d[i];
    BW_TRY(bwi_tangent_solve(state, d, 1e-4, d, &cg));
    if (state->negative && state->tangent == BWI_PLAIN)
      return BW_OK; /* not yet: with another tangent */
  } else
    memset(d, 0, (size_t)state->size * sizeof *d);
  for (int64_t i = 0; i < state->size; i++) {
    d[i] += moving[i];
    state->trial.u[i] = state->load_case->constrained[i] ? bwi_newton_state_target(state, i)
                                                         : state->now.u[i] + d[i];
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

/* Contact planes are stiff: a direction that does not know of them ends at the first that it meets,
 * a little of the way. So the direction is found again for the points that push at its end, until
 * these are those that it was found for: the minimum of the potential's parabola with contact
 * planes. It goes down, since what is added to a parabola where a point is about to push, or taken
 * away where it is about to leave, only makes a step towards its minimum lower. */
static bw_status predict_contacts(bwi_newton_state *state, double tolerance, double *slope,
                                  int32_t *cg) {
  bw_status status = BW_OK;
  size_t size = (size_t)state->size * sizeof(double);
  double *first = state->trial.internal, *linear = state->trial.load; /* not in use here */
  memcpy(first, state->direction, size);
  for (int k = 0; k < MAX_PREDICTIONS; k++) {
    bool changed, definite;
    int32_t more = 0;
    BW_TRY(bwi_tangent_predict_contact(state, &changed, &definite));
    if (!changed || !definite)
      break;
    memset(linear, 0, size);
    bwi_contact_linear(state->contact, linear);
    for (int64_t i = 0; i < state->size; i++)
      state->work[i] = state->load_case->constrained[i]
                           ? 0
                           : linear[i] - state->now.contact[i] - state->residual[i];
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
  if (state->plan.tolerance > 0)
    tolerance = state->plan.tolerance;
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
    if (state->load_case->constrained[i] && state->now.u[i] != bwi_newton_state_target(state, i))
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
static bw_status check_stable(bwi_newton_state *state, bool *stable) {
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
    state->iterative = state->stiffness_current = false;
    status = bwi_tangent_set(state, BWI_PLAIN, &definite);
    state->iterative = true;
    state->stiffness_current = false;
    if (status != BW_OK || definite)
      return status;
  }
  BW_TRY(bwi_tangent_set(state, BWI_PLAIN, &definite));
  if (definite && !state->iterative)
    return BW_OK;
  BW_TRY(bwi_newton_leave(state, &lower, &decided));
  state->undecided = !decided;
  *stable = !lower;
done:
  return status;
}

/* A tangent that is sure to be definite comes next; as it is only at much smaller residuals. */
static void make_definite(iterations *it, bwi_tangent kind) {
  it->kind = kind;
  it->plain_below = fmin(it->plain_below, it->state->relative) * 1e-2;
}

static bool prefers_shift(const iterations *it) {
  return it->state->relative < NEAR || it->projected > MAX_PROJECTED;
}

/* Whether a state with a small residual is the equilibrium; contact is settled on the way. */
static bw_status check_equilibrium(iterations *it, bool *found) {
  bw_status status = BW_OK;
  bwi_newton_state *state = it->state;
  const bw_newton_options *options = state->options;
  double size = size_of(state->solid->grid);
  it->gap = state->contact ? bwi_contact_error(state->contact) : 0;
  if (!state->quadratic && largest(state->now.u, state->size) > AWAY * size) {
    state->obstacle = BWI_STIFFNESS;
    return BW_OK;
  }
  if (it->moving)
    return BW_OK;
  if (it->gap > GAP * size && state->relative <= fmax(SETTLE_BELOW, options->tolerance)) {
    bwi_contact_settle(state->contact);
    BW_TRY(bwi_newton_state_balance(state, &state->now));
    bwi_newton_state_measure(state);
  } else if (state->relative <= options->tolerance) {
    if (state->now.shape.inverted > 0 && !options->allow_inverted) {
      state->obstacle = BWI_INVERTED;
      return BW_OK;
    }
    BW_TRY(check_stable(state, found));
    if (*found)
      return BW_OK;
    if (++it->escapes > MAX_ESCAPES) {
      state->obstacle = BWI_UNSTABLE;
      return BW_OK;
    }
    it->kind = BWI_SHIFTED;
    it->plain_below = 1e-2;
    bwi_newton_state_measure(state);
  }
done:
  return status;
}

/* A tangent to solve with, of a stiffer kind where that of the kind wanted is not definite. */
static bw_status set_tangent(iterations *it) {
  bw_status status = BW_OK;
  bwi_newton_state *state = it->state;
  bool definite;
  if (state->iterative) {
    bool by_factor;
    BW_TRY(bwi_choice_factor(state, &by_factor));
    if (by_factor)
      state->iterative = state->stiffness_current = false;
  }
  if (state->free == 0)
    return BW_OK;
  if (it->kind == BWI_PROJECTED && ++it->projected > MAX_PROJECTED)
    it->kind = BWI_SHIFTED;
  BW_TRY(bwi_tangent_set(state, it->kind, &definite));
  if (!definite && it->kind == BWI_PLAIN) {
    make_definite(it, prefers_shift(it) ? BWI_SHIFTED : BWI_PROJECTED);
    BW_TRY(bwi_tangent_set(state, it->kind, &definite));
  }
  if (!definite && it->kind == BWI_SHIFTED && !it->crushed) {
    /* what elements need, at least once */
    it->crushed = true;
    it->projected = 0;
    make_definite(it, BWI_PROJECTED);
    BW_TRY(bwi_tangent_set(state, it->kind, &definite));
  }
  if (!definite)
    state->obstacle = it->kind == BWI_SHIFTED ? BWI_CRUSHED : BWI_STIFFNESS;
done:
  return status;
}

/* A direction for which the tangent shows no negative curvature: where it does, a stiffer tangent,
 * as where a factor fails. */
static bw_status find_safe_direction(iterations *it, double *slope, int32_t *cg) {
  bw_status status = BW_OK;
  bwi_newton_state *state = it->state;
  BW_TRY(find_direction(state, slope, cg));
  while (state->negative && state->tangent != BWI_PROJECTED) {
    int32_t further = 0;
    bool stiffer, definite;
    BW_TRY(bwi_tangent_stiffen(state, &stiffer));
    if (!stiffer) {
      bool shift = prefers_shift(it) && it->kind == BWI_PLAIN;
      make_definite(it, shift ? BWI_SHIFTED : BWI_PROJECTED);
      BW_TRY(bwi_tangent_set(state, it->kind, &definite));
    }
    BW_TRY(find_direction(state, slope, &further));
    *cg += further;
  }
done:
  return status;
}

/* No step lowers the potential: a residual of rounding, another tangent, or an obstacle. */
static void end_search(iterations *it, bool *found) {
  bwi_newton_state *state = it->state;
  const bw_newton_options *options = state->options;
  /* some laws round more than the noise allows for */
  double left = state->relative * fmax(state->reference, state->noise / options->tolerance);
  if (left <= ROUGH * state->noise && it->gap <= GAP * size_of(state->solid->grid) &&
      (state->now.shape.inverted == 0 || options->allow_inverted))
    *found = true;
  else if (it->kind == BWI_PLAIN) /* once more with a direction that is sure to go down */
    make_definite(it, BWI_PROJECTED);
  else
    state->obstacle = BWI_SEARCH;
}

/* The iteration that moves what is constrained. */
static bw_status move(iterations *it) {
  bw_status status = BW_OK;
  bool moved;
  BW_TRY(move_constrained(it->state, &moved));
  if (moved) {
    it->moving = false;
    it->state->have_tangent = false; /* it was that of another shape */
  } else if (it->state->obstacle == BWI_NO_OBSTACLE) {
    it->kind = BWI_PROJECTED;
    it->plain_below *= 1e-2;
  }
done:
  return status;
}

static bw_status descend(iterations *it, bool *found) {
  bw_status status = BW_OK;
  bwi_newton_state *state = it->state;
  double slope = 0, step = 0, residual = state->relative;
  int32_t cg = 0;
  BW_TRY(find_safe_direction(it, &slope, &cg));
  if (slope < 0)
    BW_TRY(bwi_newton_search(state, slope, &step));
  if (step == 0) {
    BW_TRY(record(state, 0, cg, residual));
    end_search(it, found);
    return BW_OK;
  }
  state->previous = residual;
  state->step = step;
  BW_TRY(record(state, step, cg, residual));
  it->short_steps = step < SHORT ? it->short_steps + 1 : 0;
  if (it->short_steps == MAX_SHORT_STEPS) {
    state->obstacle = BWI_CREEPING;
  } else if (it->kind != BWI_PLAIN && step >= 1) {
    bwi_newton_state_measure(state);
    if (state->relative <= fmin(it->plain_below, NEAR))
      it->kind = BWI_PLAIN;
  }
done:
  return status;
}

bw_status bwi_newton_equilibrium(bwi_newton_state *state, double load, bool *found) {
  bw_status status = BW_OK;
  iterations it = {.state = state, .kind = BWI_PLAIN, .plain_below = 1};
  *found = false;
  state->load = load;
  state->obstacle = BWI_NO_OBSTACLE;
  state->part = state->previous = state->shift = state->projected_shift = 0;
  state->step = 1;
  state->have_tangent = state->negative = false;
  if (state->contact)
    bwi_contact_place(state->contact, load, state->begin != NULL);
  it.moving = must_move(state);
  BW_TRY(bwi_newton_state_balance(state, &state->now));
  for (int k = 0; !*found && state->obstacle == BWI_NO_OBSTACLE; k++) {
    if (!state->quadratic)
      bw_progress(state->context, "equilibrium",
                  fmax(state->reached, 1 - bwi_newton_left(state, NULL)));
    BW_TRY(bw_check_cancel(state->context));
    bwi_newton_state_measure(state);
    BW_TRY(check_equilibrium(&it, found));
    if (*found || state->obstacle != BWI_NO_OBSTACLE)
      break;
    if (k == state->options->iterations)
      state->obstacle = BWI_ITERATIONS;
    else if (bwi_newton_left(state, NULL) <= 0)
      state->obstacle = BWI_WORK;
    else
      BW_TRY(set_tangent(&it));
    if (state->obstacle == BWI_NO_OBSTACLE)
      BW_TRY(it.moving ? move(&it) : descend(&it, found));
  }
done:
  return status;
}
