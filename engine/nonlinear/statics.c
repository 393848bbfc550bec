/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Statics of a solid: load steps from rest, or from a first guess, to load factor 1.
 *
 * At load factor s the loads, the gravity, the movements of what is constrained and of contact
 * planes are s times theirs. From a first guess the loads are there in full at once, and what is
 * out of balance at the guess is balanced by forces that go to zero, 1 - s of them being left: so a
 * guess that is the equilibrium of another case leads on from there, and a path exists in any case.
 *
 * A load step that fails is halved, with what the failure said about how far it could have gone;
 * steps grow again after two that went well. A load that failed is not tried again until it is a
 * quarter as far away, but come near by halves: past collapse each try takes all iterations. That
 * bounds the work, and options bound it further: Newton iterations and those of conjugate gradients
 * over all load steps (bwi_newton_left). Each of Newton's has at most some ten factors. */
#include "grid/internal.h"
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

void bw_newton_options_default(bw_newton_options *options) {
  *options =
      (bw_newton_options){.tolerance = 1e-6, .iterations = 100, .steps = 1, .min_step = 1.0 / 256};
}

static void destroy_newton(void *object) {
  bw_newton *newton = (bw_newton *)object;
  bwi_direct_destroy(newton->direct);
  bw_free(newton->stiffness);
  bw_solid_linear_destroy(newton->linear);
  bw_release(newton->linear_of);
  bw_free(newton);
}

static size_t bytes_of_newton(const void *object) {
  const bw_newton *newton = (const bw_newton *)object;
  size_t elements = newton->linear ? (size_t)newton->linear_of->grid->element_count : 0;
  return sizeof *newton + sizeof(double) * (9 * (size_t)newton->block_count + 324 * elements) +
         bwi_direct_bytes(newton->direct);
}

static const bw_kind newton_kind = {"newton", destroy_newton, bytes_of_newton};

bw_status bw_newton_create(bw_context *context, bw_newton **out) {
  bw_newton *newton = BW_NEW0(context, bw_newton, 1);
  if (!newton)
    return BW_MEMORY;
  bw_object_init(newton, &newton_kind);
  bw_status status = bwi_direct_create(context, &newton->direct);
  if (status != BW_OK)
    bw_release(newton);
  else
    *out = newton;
  return status;
}

static void destroy(void *object) {
  bw_solid_static *it = (bw_solid_static *)object;
  bw_release(it->solid);
  bw_release(it->load_case);
  bw_free(it->displacement);
  bw_free(it->reaction);
  bw_free(it->newton.history);
  bw_free(it);
}

static size_t bytes(const void *object) {
  const bw_solid_static *it = (const bw_solid_static *)object;
  return sizeof *it + 48 * (size_t)it->solid->grid->node_count;
}

static const bw_kind static_kind = {"solid static", destroy, bytes};

static bw_status check_coarse(bw_context *context, const bw_solid *solid,
                              const bw_newton_options *o) {
  const bw_grid *fine = solid->grid;
  if (o->coarse_count < 1)
    return bw_fail(context, BW_INVALID, "a preconditioner from coarse solids needs at least one");
  for (int k = 0; k < o->coarse_count; k++) {
    if (!bw_grid_same_elements(o->coarsening[k]->fine, fine))
      return bw_fail(context, BW_INVALID,
                     "coarsening %d is not of the grid of %d elements before it", k + 1,
                     (int)fine->element_count);
    fine = o->coarsening[k]->coarse;
    if (!bw_grid_same_elements(o->coarse[k]->grid, fine))
      return bw_fail(context, BW_INVALID,
                     "coarse solid %d is not on the grid of %d coarse elements", k + 1,
                     (int)fine->element_count);
  }
  return BW_OK;
}

bw_status bwi_newton_check(bw_context *context, const bw_solid *solid,
                           const bw_load_case *load_case, const bw_newton_options *o) {
  bw_status status = BW_OK;
  bwi_newton_plan plan;
  if (!bwi_grid_same_places(solid->grid, load_case->grid))
    return bw_fail(context, BW_INVALID,
                   "the case is for a grid of %d elements (cells of %g m), not for the solid's, "
                   "which has %d (%g m), or lies elsewhere",
                   (int)load_case->grid->element_count, load_case->grid->spacing[0],
                   (int)solid->grid->element_count, solid->grid->spacing[0]);
  BW_TRY(bwi_newton_plan_make(context, o->solver, o->coarse_count, solid->grid->node_count, &plan));
  if (plan.two_level)
    BW_TRY(check_coarse(context, solid, o));
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance is %g; it must lie between 0 and 1",
                   o->tolerance);
  if (o->max_iterations < 0)
    return bw_fail(context, BW_INVALID,
                   "%d iterations over all load steps; at least one, or 0: by itself",
                   o->max_iterations);
  if (o->iterations < 1 || o->steps < 1)
    return bw_fail(context, BW_INVALID, "%d iterations in each of %d load steps; at least one",
                   o->iterations, o->steps);
  if (!(o->min_step > 0 && o->min_step <= 1))
    return bw_fail(context, BW_INVALID,
                   "the smallest load step is %g; it must lie above 0, up to 1", o->min_step);
  for (int64_t i = 0; o->start && i < 3 * (int64_t)solid->grid->node_count; i++)
    if (!isfinite(o->start[i]))
      return bw_fail(context, BW_INVALID, "the initial guess is %g at node %lld: it must be finite",
                     o->start[i], (long long)(i / 3) + 1);
  BW_TRY(bwi_load_case_check_constraints(context, load_case));
done:
  return status;
}

static bw_status fail_undefined(bwi_newton_state *state) {
  int32_t e = state->now.shape.worst;
  double at[3];
  const bw_grid *grid = state->solid->grid;
  bw_grid_position(grid, grid->element[8 * (int64_t)e], at);
  bw_status status = bw_fail(state->context, BW_GEOMETRY,
                             "the initial guess inverts element %d at (%g, %g, %g) m (det F = "
                             "%.3g), where its law has no energy: start from zero displacement",
                             (int)e + 1, at[0], at[1], at[2], state->now.shape.min_ratio);
  bw_detail_number(state->context, "element", e + 1);
  return status;
}

/* Everything at load factor 0. */
static bw_status newton_begin(bwi_newton_state *state) {
  bw_status status = BW_OK;
  bw_context *context = state->context;
  const double *start = state->options->start;
  bool by_factor;
  BW_TRY(bwi_newton_state_create(state));
  int64_t n = state->size;
  if (start) {
    state->begin = BW_NEW(context, double, n);
    state->initial_residual = BW_NEW0(context, double, n);
    if (!state->begin || !state->initial_residual)
      return BW_MEMORY;
    memcpy(state->begin, start, (size_t)n * sizeof *start);
    memcpy(state->now.u, start, (size_t)n * sizeof *start);
    BW_TRY(bwi_newton_state_balance(state, &state->now));
    if (!state->now.shape.defined)
      return fail_undefined(state);
    for (int64_t i = 0; i < n; i++)
      state->initial_residual[i] =
          state->load_case->constrained[i] ? 0 : state->now.internal[i] - state->now.load[i];
  }
  bwi_choice_begin(state);
  BW_TRY(bwi_choice_factor(state, &by_factor));
  state->iterative = state->iterative && !by_factor;
  BW_TRY(bwi_tangent_blocks(state));
  BW_TRY(bwi_contact_create(context, state->load_case, state->blocks, &state->contact));
  if (state->contact && start)
    bwi_contact_begin(state->contact, state->now.u);
done:
  return status;
}

/* Loads that failed are tried again from this part of how far they were away. */
#define AGAIN 0.25

/* What goes wrong in a load step. */
typedef struct failure {
  bwi_obstacle obstacle;
  double load, residual;
  bw_solid_shape shape;
} failure;

static bw_status fail_equilibrium(bwi_newton_state *state, double reached, const failure *f) {
  bw_context *context = state->context;
  const bw_grid *grid = state->solid->grid;
  double at[3];
  int32_t e = f->shape.worst >= 0 && f->shape.worst < grid->element_count ? f->shape.worst : 0;
  bw_grid_position(grid, grid->element[8 * (int64_t)e], at);
  for (int d = 0; d < 3; d++)
    at[d] += 0.5 * grid->spacing[d];
  bool inverted = f->obstacle == BWI_INVERTED;
  bw_status status = bw_fail(
      context,
      inverted                       ? BW_GEOMETRY
      : f->obstacle == BWI_STIFFNESS ? BW_UNCONSTRAINED
                                     : BW_CONVERGENCE,
      "no %sequilibrium found beyond load factor %.6g: at %.6g %s (residual %.2g, tolerance %.2g; "
      "element %d at (%.4g, %.4g, %.4g) m is worst, its smallest det F %.3g, %lld inverted; %d "
      "iterations in %d load steps, %d of which failed). The load may be more than the solid "
      "carries; otherwise take smaller or more load steps, %s",
      inverted ? "regular " : "", reached, f->load, bwi_obstacle_text(f->obstacle), f->residual,
      state->options->tolerance, (int)e + 1, at[0], at[1], at[2], f->shape.min_ratio,
      (long long)f->shape.inverted, state->report->iterations,
      state->report->load_steps + state->report->failed_steps, state->report->failed_steps,
      f->obstacle == BWI_WORK ? "or allow more iterations (max_iterations)" : "or smaller cells");
  bw_detail_number(context, "load", reached);
  bw_detail_number(context, "residual", f->residual);
  bw_detail_number(context, "element", e + 1);
  bw_detail_number(context, "min_ratio", f->shape.min_ratio);
  bw_detail_number(context, "inverted", (double)f->shape.inverted);
  return status;
}

/* Load steps until load factor 1 or the least step. `u` and `multiplier` (may be NULL) hold the
 * last equilibrium, *reached its load factor. */
static bw_status follow_path(bwi_newton_state *state, double *u, double *multiplier,
                             double *reached, failure *failed) {
  bw_status status = BW_OK;
  const bw_newton_options *o = state->options;
  size_t size = (size_t)state->size * sizeof(double),
         contact = state->contact ? (size_t)state->contact->count * sizeof(double) : 0;
  double step = 1.0 / o->steps, min = fmin(o->min_step, step);
  double barrier = 2, away = 0; /* the least load that failed, and from how far */
  int good = 0;
  failed->obstacle = BWI_NO_OBSTACLE;
  while (*reached < 1) {
    double load = *reached + step > 1 - 1e-9 ? 1 : *reached + step;
    bool found;
    if (load >= barrier) {
      bool near = barrier - *reached <= fmax(AGAIN * away, 2 * min);
      load = near ? barrier : 0.5 * (*reached + barrier);
    }
    step = load - *reached;
    state->reached = *reached;
    BW_TRY(bwi_newton_equilibrium(state, load, &found));
    if (found) {
      *reached = load;
      if (load >= barrier)
        barrier = 2;
      memcpy(u, state->now.u, size);
      if (contact)
        memcpy(multiplier, state->contact->multiplier, contact);
      state->report->load_steps++;
      state->report->residual = state->relative;
      state->report->undecided += state->undecided;
      if (++good % 2 == 0)
        step = fmin(2 * step, 1);
      continue;
    }
    *failed = (failure){state->obstacle, load, state->relative, state->now.shape};
    state->report->failed_steps++;
    memcpy(state->now.u, u, size);
    state->stiffness_current = false;
    if (contact)
      memcpy(state->contact->multiplier, multiplier, contact);
    good = 0;
    if (step <= min * (1 + 1e-9) || state->obstacle == BWI_WORK)
      break;
    if (!(state->part > 0)) {
      barrier = load;
      away = step;
    }
    step = fmax(min, step * (state->part > 0 ? fmin(0.5, fmax(0.1, 0.8 * state->part)) : 0.5));
  }
done:
  return status;
}

/* A residual that passes as rounding may be as large as the loads themselves, where these are tiny
 * against the stiffest elements: no wrong answer without a word. */
static void warning_rounding(bwi_newton_state *state) {
  double applied = 0;
  bwi_newton_state_measure(state);
  double min = state->noise / state->options->tolerance;
  double left = state->relative * fmax(state->reference, min);
  for (int64_t i = 0; i < state->size; i++) {
    double load = state->now.load[i] - (state->now.contact ? state->now.contact[i] : 0);
    applied += state->load_case->constrained[i] ? 0 : load * load;
  }
  applied = sqrt(applied);
  if (applied > 0 && left > 1e-2 * applied && left > state->options->tolerance * state->reference)
    bw_warn(state->context,
            "the residual of the loads (%.3g N) is %.3g N, below the rounding error of the "
            "stiffest elements' forces (%.3g N): the displacements are not reliable",
            applied, left, state->noise);
}

/* An unstable equilibrium must not pass for a stable one without a word. */
static void warning_stability(bwi_newton_state *state) {
  const bw_newton_report *report = state->report;
  if (report->undecided > 0)
    bw_warn(state->context,
            "the stability of the solid is unknown at %d of %d load steps: %d iterations of "
            "conjugate gradients found no direction of negative stiffness, and did not exclude "
            "one. Solve by a factor (the solver cholesky) or allow more iterations to decide",
            report->undecided, report->load_steps, state->plan.max_iterations);
}

/* Reactions and energies of the state that was reached. */
static bw_status finish(bwi_newton_state *state, double reached, bw_solid_static *result) {
  bw_status status = BW_OK;
  memcpy(state->now.u, result->displacement, (size_t)state->size * sizeof(double));
  state->load = reached;
  if (state->contact)
    bwi_contact_place(state->contact, reached, state->begin != NULL);
  BW_TRY(bwi_newton_state_balance(state, &state->now));
  for (int64_t i = 0; i < state->size; i++) {
    double contact = state->now.contact ? state->now.contact[i] : 0;
    result->reaction[i] = state->load_case->constrained[i]
                              ? state->now.internal[i] - state->now.load[i] + contact
                              : contact;
  }
  result->energy = state->now.energy;
  result->newton.load = reached;
  result->newton.shape = state->now.shape;
  result->newton.contacts = state->now.contacts;
  result->complete = reached >= 1;
  if (bw_solid_locking(state->solid))
    bw_warn(state->context, "%s", bw_solid_locking(state->solid));
  if (result->complete)
    warning_rounding(state);
  warning_stability(state);
done:
  return status;
}

bw_status bw_solid_statics(bw_context *context, const bw_solid *solid,
                           const bw_load_case *load_case, bw_newton *newton,
                           const bw_newton_options *options, bw_solid_static **out) {
  bw_status status = BW_OK;
  bw_newton *own = NULL;
  bw_newton_options chosen;
  bw_solid_static *result = NULL;
  bwi_newton_state state = {.context = context, .solid = solid, .load_case = load_case};
  double *multiplier = NULL, reached = 0, before = bw_seconds();
  failure failed = {0};
  if (options)
    chosen = *options;
  else
    bw_newton_options_default(&chosen);
  BW_TRY(bwi_newton_check(context, solid, load_case, &chosen));
  result = BW_NEW0(context, bw_solid_static, 1);
  if (!result)
    return BW_MEMORY;
  bw_object_init(result, &static_kind);
  result->solid = bw_retain(solid);
  result->load_case = bw_retain(load_case);
  result->displacement = BW_NEW0(context, double, 3 * (int64_t)solid->grid->node_count);
  result->reaction = BW_NEW0(context, double, 3 * (int64_t)solid->grid->node_count);
  BW_TRY_MEMORY(result->displacement && result->reaction);
  if (!newton) {
    BW_TRY(bw_newton_create(context, &own));
    newton = own;
  }
  state.newton = newton;
  state.options = &chosen;
  state.report = &result->newton;
  BW_TRY(newton_begin(&state));
  memcpy(result->displacement, state.now.u, (size_t)state.size * sizeof(double));
  if (state.contact) {
    multiplier = BW_NEW0(context, double, state.contact->count);
    BW_TRY_MEMORY(multiplier);
  }
  BW_TRY(follow_path(&state, result->displacement, multiplier, &reached, &failed));
  BW_TRY(finish(&state, reached, result));
  result->newton.seconds = bw_seconds() - before;
  bwi_newton_state_report(&state, &result->report);
  if (reached < 1)
    status = fail_equilibrium(&state, reached, &failed);
  *out = result;
  result = NULL;
done:
  bwi_newton_state_clear(&state);
  bw_release(own);
  bw_free(multiplier);
  bw_release(result);
  return status;
}
