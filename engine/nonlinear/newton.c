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
 * with it. It is taken when no element is turned inside out by it. */
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
enum { ESCAPES = 6, PATIENCE = 12, FORESEEN = 8, CREEPING = 8, MOST = 500, MOST_OF_STEP = 20 };
#define CG ((int64_t)100) /* iterations that are worth one of Newton's */

bw_status bwi_balance_create(bw_context *context, int64_t size, bool contact, bwi_balance *at) {
  *at = (bwi_balance){0};
  at->u = BW_NEW0(context, double, size);
  at->internal = BW_NEW0(context, double, size);
  at->load = BW_NEW0(context, double, size);
  at->contact = contact ? BW_NEW0(context, double, size) : NULL;
  return at->u && at->internal && at->load && (!contact || at->contact) ? BW_OK : BW_MEMORY;
}

void bwi_balance_clear(bwi_balance *at) {
  bw_free(at->u);
  bw_free(at->internal);
  bw_free(at->load);
  bw_free(at->contact);
  *at = (bwi_balance){0};
}

double bwi_walk_dot(const bwi_walk *walk, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < walk->size; i++)
    if (!walk->the->held[i])
      sum += a[i] * b[i];
  return sum;
}

bw_status bwi_walk_loads(bwi_walk *walk, const double *u, double *load) {
  double factor = walk->fade ? 1 : walk->load;
  for (int64_t i = 0; i < walk->size; i++)
    load[i] = factor * walk->dead[i] + (walk->fade ? (1 - walk->load) * walk->fade[i] : 0);
  return walk->follows ? bwi_case_follow(walk->context, walk->the, u, factor, load) : BW_OK;
}

bw_status bwi_walk_balance(bwi_walk *walk, bwi_balance *at) {
  bw_status status = BW_OK;
  double before = bw_seconds(), sum = 0;
  BW_TRY(bw_solid_evaluate(walk->context, walk->solid, at->u, false, &at->energy, at->internal,
                           NULL, &at->shape));
  walk->report->evaluations++;
  walk->report->seconds_quadrature += bw_seconds() - before;
  if (!at->shape.defined)
    goto done;
  BW_TRY(bwi_walk_loads(walk, at->u, at->load));
  if (walk->quadratic)
    BW_TRY(bwi_quadratic_evaluate(walk, at));
  at->contact_energy = 0;
  at->contacts = 0;
  if (walk->contact) {
    memset(at->contact, 0, (size_t)walk->size * sizeof *at->contact);
    at->contacts = bwi_contact_evaluate(walk->contact, at->u, &at->contact_energy, at->contact);
    for (int64_t i = 0; i < walk->size; i++)
      at->load[i] += at->contact[i];
  }
  for (int64_t i = 0; i < walk->size; i++)
    sum += fabs(at->internal[i]) + fabs(at->load[i]);
  at->shape.defined = isfinite(sum) && isfinite(at->energy) && isfinite(at->contact_energy);
done:
  return status;
}

void bwi_walk_measure(bwi_walk *walk) {
  const bwi_balance *now = &walk->now;
  const bw_grid *grid = walk->solid->grid;
  double left = 0, applied = 0, held = 0, contact = 0, noise = 0, elastic = 0;
  double cell = fmax(grid->spacing[0], fmax(grid->spacing[1], grid->spacing[2]));
  for (int64_t i = 0; i < walk->size; i++) {
    double touching = now->contact ? now->contact[i] : 0, other = now->load[i] - touching;
    double r = now->internal[i] - now->load[i];
    walk->residual[i] = walk->the->held[i] ? 0 : r;
    *(walk->the->held[i] ? &held : &left) += r * r;
    applied += other * other;
    contact += touching * touching;
    if (!walk->the->held[i]) {
      double stiff = walk->blocks[3 * i + i % 3], term = stiff * (fabs(now->u[i]) + cell);
      elastic += fabs(stiff) * cell * cell;
      noise += term * term;
    }
  }
  walk->noise = NOISE * sqrt(noise);
  walk->elastic = elastic;
  walk->reference = sqrt(applied) + sqrt(held) + sqrt(contact) + now->quadratic_size;
  double least = walk->noise / walk->options->tolerance;
  walk->relative = left > 0 ? sqrt(left) / fmax(walk->reference, least) : 0;
  if (!isfinite(walk->relative))
    walk->relative = DBL_MAX;
}

void bwi_walk_accept(bwi_walk *walk) {
  bwi_balance old = walk->now;
  walk->now = walk->trial;
  walk->trial = old;
  walk->fresh = false;
}

static bw_status record(bwi_walk *walk, double step, int32_t cg, double residual) {
  bw_newton_report *report = walk->report;
  report->iterations++;
  if (!bw_grow(walk->context, (void **)&report->history, &walk->history_capacity,
               (size_t)report->history_count, 1, sizeof *report->history))
    return BW_MEMORY;
  report->history[report->history_count++] = (bw_newton_entry){
      .load = walk->load,
      .energy = walk->now.energy,
      .residual = residual,
      .step = step,
      .cg = cg,
      .contacts = (int32_t)(walk->now.contacts < INT32_MAX ? walk->now.contacts : INT32_MAX),
      .projected = walk->tangent != BWI_PLAIN};
  return BW_OK;
}

/* Move what is held to where it is at this load factor, and the rest along. */
static bw_status move_held(bwi_walk *walk, bool *moved) {
  bw_status status = BW_OK;
  int32_t cg = 0;
  double *d = walk->direction, *moving = walk->work, residual = walk->relative;
  *moved = false;
  for (int64_t i = 0; i < walk->size; i++)
    moving[i] = walk->the->held[i] ? bwi_walk_target(walk, i) - walk->now.u[i] : 0;
  if (walk->free > 0) {
    BW_TRY(bwi_tangent_multiply(walk, moving, d));
    for (int64_t i = 0; i < walk->size; i++)
      d[i] = walk->the->held[i] ? 0 : -walk->residual[i] - d[i];
    BW_TRY(bwi_tangent_solve(walk, d, 1e-4, d, &cg));
    if (walk->negative && walk->tangent == BWI_PLAIN)
      return BW_OK; /* not yet: with another tangent */
  } else
    memset(d, 0, (size_t)walk->size * sizeof *d);
  for (int64_t i = 0; i < walk->size; i++) {
    d[i] += moving[i];
    walk->trial.u[i] = walk->the->held[i] ? bwi_walk_target(walk, i) : walk->now.u[i] + d[i];
  }
  BW_TRY(bwi_walk_balance(walk, &walk->trial));
  bool inverting = walk->trial.shape.inverted > 0 && walk->now.shape.inverted == 0;
  if (!walk->trial.shape.defined || inverting) {
    BW_TRY(bwi_newton_cap(walk->context, walk->solid, walk->now.u, d, inverting, &walk->part));
    walk->obstacle = BWI_INVERTING;
    goto done;
  }
  bwi_walk_accept(walk);
  BW_TRY(record(walk, 1, cg, residual));
  *moved = true;
done:
  return status;
}

/* Floors are stiff: a direction that does not know of them ends at the first that it meets, a
 * little of the way. So the direction is found again for the points that push at its end, until
 * these are those that it was found for: the minimum of the potential's parabola with floors. It
 * goes down, since what is added to a parabola where a point is about to push, or taken away where
 * it is about to leave, only makes a step towards its minimum lower. */
static bw_status foresee_contacts(bwi_walk *walk, double tolerance, double *slope, int32_t *cg) {
  bw_status status = BW_OK;
  size_t size = (size_t)walk->size * sizeof(double);
  double *first = walk->trial.internal, *linear = walk->trial.load; /* not in use here */
  memcpy(first, walk->direction, size);
  for (int k = 0; k < FORESEEN; k++) {
    bool changed, definite;
    int32_t more = 0;
    BW_TRY(bwi_tangent_foresee(walk, &changed, &definite));
    if (!changed || !definite)
      break;
    memset(linear, 0, size);
    bwi_contact_linear(walk->contact, linear);
    for (int64_t i = 0; i < walk->size; i++)
      walk->work[i] = walk->the->held[i] ? 0 : linear[i] - walk->now.contact[i] - walk->residual[i];
    BW_TRY(bwi_tangent_solve(walk, walk->work, tolerance, walk->direction, &more));
    *cg += more;
  }
  double along = bwi_walk_dot(walk, walk->residual, walk->direction);
  if (along < 0)
    *slope = along;
  else
    memcpy(walk->direction, first, size);
done:
  return status;
}

/* The direction -K^-1 r; where it does not go down (with follower pressures, whose tangent is not
 * symmetric, or an inexact solution), *slope is not negative. */
static bw_status find_direction(bwi_walk *walk, double *slope, int32_t *cg) {
  bw_status status = BW_OK;
  double rate = walk->previous > 0 ? walk->relative / walk->previous : 1;
  /* Eisenstat and Walker, choice 2 */
  double tolerance = fmin(0.1, 0.9 * rate * rate);
  tolerance = fmax(tolerance, fmin(0.1, 0.3 * walk->options->tolerance / walk->relative));
  if (walk->tangent == BWI_SHIFTED)
    tolerance = fmin(tolerance, 1e-3);
  if (walk->contact) /* gaps are to be closed much further than residuals */
    tolerance = fmin(tolerance, 1e-4);
  if (walk->options->cg_tolerance > 0)
    tolerance = walk->options->cg_tolerance;
  for (int64_t i = 0; i < walk->size; i++)
    walk->work[i] = -walk->residual[i];
  BW_TRY(bwi_tangent_solve(walk, walk->work, tolerance, walk->direction, cg));
  *slope = bwi_walk_dot(walk, walk->residual, walk->direction);
  if (walk->contact && *slope < 0)
    BW_TRY(foresee_contacts(walk, tolerance, slope, cg));
done:
  return status;
}

static bool must_move(const bwi_walk *walk) {
  for (int64_t i = 0; i < walk->size; i++)
    if (walk->the->held[i] && walk->now.u[i] != bwi_walk_target(walk, i))
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
  double most = 0;
  for (int64_t i = 0; i < size; i++)
    most = fmax(most, fabs(u[i]));
  return most;
}

/* At a residual that is small enough: whether the state is stable; if not, leave it. */
static bw_status check_stable(bwi_walk *walk, int *escapes, bool *stable) {
  bw_status status = BW_OK;
  bool definite = true, lower = false, decided = true, by_factor = false;
  *stable = true;
  walk->undecided = false;
  /* a definite tangent one iteration ago says it for here, if that was near */
  bool near = walk->previous < NEARBY && walk->have_tangent && walk->tangent == BWI_PLAIN &&
              !walk->iterative;
  if (walk->free == 0 || walk->quadratic || near)
    return BW_OK;
  if (walk->iterative)
    BW_TRY(bwi_choice_factor_search(walk, &by_factor));
  if (by_factor) {
    walk->iterative = walk->fresh = false;
    status = bwi_tangent_set(walk, BWI_PLAIN, &definite);
    walk->iterative = true;
    walk->fresh = false;
    if (status != BW_OK || definite)
      return status;
  }
  BW_TRY(bwi_tangent_set(walk, BWI_PLAIN, &definite));
  if (definite && !walk->iterative)
    return BW_OK;
  BW_TRY(bwi_newton_leave(walk, &lower, &decided));
  walk->undecided = !decided;
  if (!lower)
    return BW_OK;
  *stable = false;
  ++*escapes;
done:
  return status;
}

double bwi_newton_left(const bwi_walk *walk, int64_t *of_cg) {
  const bw_newton_options *o = walk->options;
  const bw_newton_report *report = walk->report;
  int64_t most = CG * (o->most_iterations > 0 ? o->most_iterations
                                              : MOST + (int64_t)MOST_OF_STEP * (o->steps - 1));
  int64_t left =
      most - CG * report->iterations - report->cg_iterations - report->stability_iterations;
  if (of_cg)
    *of_cg = left > 0 ? left : 0;
  return left > 0 ? (double)left / (double)most : 0;
}

bw_status bwi_newton_equilibrium(bwi_walk *walk, double load, bool *found) {
  bw_status status = BW_OK;
  const bw_newton_options *options = walk->options;
  bwi_tangent kind = BWI_PLAIN;
  bool moving, crushed = false;
  double plain_below = 1; /* residual below which the tangent may be tried as it is again */
  int escapes = 0, projected = 0, creeping = 0;
  *found = false;
  walk->load = load;
  walk->obstacle = BWI_NO_OBSTACLE;
  walk->part = walk->previous = walk->shift = walk->lift = 0;
  walk->step = 1;
  walk->have_tangent = walk->negative = false;
  if (walk->contact)
    bwi_contact_place(walk->contact, load, walk->begin != NULL);
  moving = must_move(walk);
  BW_TRY(bwi_walk_balance(walk, &walk->now));
  for (int k = 0; k <= options->iterations; k++) {
    bool definite = false;
    int32_t cg = 0;
    double slope = 0, step = 0;
    if (!walk->quadratic)
      bw_progress(walk->context, "equilibrium",
                  fmax(walk->reached, 1 - bwi_newton_left(walk, NULL)));
    BW_TRY(bw_check_cancel(walk->context));
    bwi_walk_measure(walk);
    if (!walk->quadratic && largest(walk->now.u, walk->size) > AWAY * size_of(walk->solid->grid)) {
      walk->obstacle = BWI_STIFFNESS;
      goto done;
    }
    double gap = walk->contact ? bwi_contact_error(walk->contact) : 0;
    bool small = walk->relative <= options->tolerance;
    if (!moving && gap > GAP * size_of(walk->solid->grid) &&
        walk->relative <= fmax(SETTLE_BELOW, options->tolerance)) {
      bwi_contact_settle(walk->contact);
      BW_TRY(bwi_walk_balance(walk, &walk->now));
      bwi_walk_measure(walk);
    } else if (!moving && small) {
      bool stable;
      if (walk->now.shape.inverted > 0 && !options->allow_inverted) {
        walk->obstacle = BWI_INVERTED;
        goto done;
      }
      BW_TRY(check_stable(walk, &escapes, &stable));
      *found = stable;
      if (stable)
        goto done;
      if (escapes > ESCAPES) {
        walk->obstacle = BWI_UNSTABLE;
        goto done;
      }
      kind = BWI_SHIFTED;
      plain_below = 1e-2;
      bwi_walk_measure(walk);
    }
    if (k == options->iterations)
      break;
    if (bwi_newton_left(walk, NULL) <= 0) {
      walk->obstacle = BWI_WORK;
      goto done;
    }
    double residual = walk->relative;
    if (walk->iterative) {
      bool by_factor;
      BW_TRY(bwi_choice_factor(walk, &by_factor));
      if (by_factor)
        walk->iterative = walk->fresh = false;
    }
    if (walk->free > 0) {
      if (kind == BWI_PROJECTED && ++projected > PATIENCE)
        kind = BWI_SHIFTED;
      BW_TRY(bwi_tangent_set(walk, kind, &definite));
      if (!definite && kind == BWI_PLAIN) {
        kind = walk->relative < NEAR || projected > PATIENCE ? BWI_SHIFTED : BWI_PROJECTED;
        plain_below = fmin(plain_below, walk->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(walk, kind, &definite));
      }
      if (!definite && kind == BWI_SHIFTED && !crushed) { /* what elements need, at least once */
        crushed = true;
        kind = BWI_PROJECTED;
        projected = 0;
        plain_below = fmin(plain_below, walk->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(walk, kind, &definite));
      }
      if (!definite) {
        walk->obstacle = kind == BWI_SHIFTED ? BWI_CRUSHED : BWI_STIFFNESS;
        goto done;
      }
    }
    if (moving) {
      bool moved;
      BW_TRY(move_held(walk, &moved));
      if (!moved && walk->obstacle == BWI_NO_OBSTACLE) {
        kind = BWI_PROJECTED;
        plain_below *= 1e-2;
        continue;
      }
      if (!moved)
        goto done;
      moving = false;
      walk->have_tangent = false; /* it was that of another shape */
      continue;
    }
    BW_TRY(find_direction(walk, &slope, &cg));
    while (walk->negative && walk->tangent != BWI_PROJECTED) { /* as where a factor fails */
      int32_t further = 0;
      bool stiffer;
      BW_TRY(bwi_tangent_stiffen(walk, &stiffer));
      if (!stiffer) {
        bool close = walk->relative < NEAR || projected > PATIENCE;
        kind = close && kind == BWI_PLAIN ? BWI_SHIFTED : BWI_PROJECTED;
        plain_below = fmin(plain_below, walk->relative) * 1e-2;
        BW_TRY(bwi_tangent_set(walk, kind, &definite));
      }
      BW_TRY(find_direction(walk, &slope, &further));
      cg += further;
    }
    if (slope < 0)
      BW_TRY(bwi_newton_search(walk, slope, &step));
    if (step == 0) {
      BW_TRY(record(walk, 0, cg, residual));
      /* as good as it gets: some laws round more than the noise allows for */
      double least = walk->noise / options->tolerance;
      double left = walk->relative * fmax(walk->reference, least);
      if (left <= ROUGH * walk->noise && gap <= GAP * size_of(walk->solid->grid) &&
          (walk->now.shape.inverted == 0 || options->allow_inverted)) {
        *found = true;
        goto done;
      }
      if (kind == BWI_PLAIN) { /* once more with a direction that is sure to go down */
        kind = BWI_PROJECTED;
        plain_below = fmin(plain_below, walk->relative) * 1e-2;
        continue;
      }
      walk->obstacle = BWI_SEARCH;
      goto done;
    }
    walk->previous = residual;
    walk->step = step;
    BW_TRY(record(walk, step, cg, residual));
    creeping = step < SHORT ? creeping + 1 : 0;
    if (creeping == CREEPING) {
      walk->obstacle = BWI_CREEPING;
      goto done;
    }
    if (kind != BWI_PLAIN && step >= 1) {
      bwi_walk_measure(walk);
      if (walk->relative <= fmin(plain_below, NEAR))
        kind = BWI_PLAIN;
    }
  }
  walk->obstacle = BWI_ITERATIONS;
done:
  return status;
}
