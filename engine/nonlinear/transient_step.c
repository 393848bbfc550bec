/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One step of a motion: the minimum of the incremental potential
 *
 *   potential(u) + 1/2 (u - u*)^T Q (u - u*) + (u - u*)^T C v*,
 *   Q = M / displacement + velocity C,   C = am M + ak K(u at the step's start),
 *
 * whose gradient is the equation of motion at the step's end, with a and v as the rule
 * (bwi_transient_rule) has them. */
#include "nonlinear/transient.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* Contact is set up for the matrix of a step: as stiff against it as a static one against the
 * solid. */
static bw_status prepare_contact_planes(bw_context *context, bw_solid_transient *motion,
                                        double of_mass) {
  bw_status status = BW_OK;
  bwi_transient *inner = motion->inner;
  const bw_solid *solid = motion->solid;
  const bw_block_pattern *pattern = solid->pattern;
  int64_t nodes = solid->grid->node_count;
  double *blocks = NULL, *matrix = NULL;
  bwi_contact *contact = NULL;
  bw_solid_shape shape;
  if (motion->load_case->contact_plane_count == 0 ||
      (inner->contact && inner->contact_for == of_mass))
    return BW_OK;
  blocks = BW_NEW(context, double, 9 * nodes);
  matrix = BW_NEW(context, double, 9 * pattern->block_count);
  BW_TRY_MEMORY(blocks && matrix);
  memset(inner->workspace[0], 0, 3 * (size_t)nodes * sizeof(double));
  BW_TRY(bw_solid_evaluate(context, solid, inner->workspace[0], true, NULL, NULL, matrix, &shape));
  for (int64_t i = 0; i < nodes; i++) {
    memcpy(blocks + 9 * i, matrix + 9 * (pattern->start[i + 1] - 1), 9 * sizeof *blocks);
    for (int c = 0; c < 3; c++)
      blocks[9 * i + 4 * c] += of_mass * solid->mass[i];
  }
  BW_TRY(bwi_contact_create(context, motion->load_case, blocks, &contact));
  double *before = BW_NEW0(context, double, contact->count);
  BW_TRY_MEMORY(before);
  bwi_contact_destroy(inner->contact);
  bw_free(inner->multiplier);
  inner->contact = contact;
  inner->multiplier = before;
  inner->contact_for = of_mass;
  contact = NULL;
done:
  bwi_contact_destroy(contact);
  bw_free(blocks);
  bw_free(matrix);
  return status;
}

/* u*, v* (into next_velocity) and C v* (into workspace[0]). */
static bw_status set_centre(bw_context *context, bw_solid_transient *motion,
                            const bwi_transient_rule *rule) {
  bw_status status = BW_OK;
  const bw_transient_options *o = &motion->options;
  const bw_solid *solid = motion->solid;
  bwi_transient *inner = motion->inner;
  int64_t size = 3 * (int64_t)solid->grid->node_count;
  for (int64_t i = 0; i < size; i++) {
    bool constrained = motion->load_case->constrained[i];
    inner->centre[i] = motion->displacement[i];
    inner->next_velocity[i] = 0;
    if (constrained)
      continue;
    inner->centre[i] +=
        o->step * motion->velocity[i] + rule->old_displacement * motion->acceleration[i];
    inner->next_velocity[i] = motion->velocity[i] + rule->old_velocity * motion->acceleration[i];
  }
  if (o->stiffness_damping > 0) {
    BW_TRY(bwi_transient_tangent(context, motion, inner->next_velocity, inner->workspace[0]));
  } else
    memset(inner->workspace[0], 0, (size_t)size * sizeof(double));
  for (int64_t i = 0; i < size; i++)
    inner->workspace[0][i] = o->stiffness_damping * inner->workspace[0][i] +
                             o->mass_damping * solid->mass[i / 3] * inner->next_velocity[i];
done:
  return status;
}

/* Where to begin: at the shape that the accelerations lead to if they stay, where that is lower
 * than the shape now. The linearly implicit step is linear about the shape now. */
static bw_status choose_start(bw_solid_transient *motion, const bwi_transient_rule *rule,
                              bwi_newton_state *state) {
  bw_status status = BW_OK;
  bwi_energy_forces *now = &state->now, *ahead = &state->trial;
  memcpy(now->u, motion->displacement, (size_t)state->size * sizeof(double));
  if (motion->options.iterations == 1)
    return BW_OK;
  for (int64_t i = 0; i < state->size; i++)
    ahead->u[i] = motion->inner->centre[i] +
                  rule->displacement * motion->acceleration[i]; /* constrained: 0 */
  BW_TRY(bwi_newton_state_balance(state, now));
  BW_TRY(bwi_newton_state_balance(state, ahead));
  if (!ahead->shape.defined)
    goto done;
  double change = 0, work = 0;
  for (int64_t i = 0; i < state->size; i++)
    work += motion->inner->dead[i] * (ahead->u[i] - now->u[i]);
  change = ahead->energy + ahead->quadratic_energy + ahead->contact_energy - now->energy -
           now->quadratic_energy - now->contact_energy - work;
  if (change < 0)
    memcpy(now->u, ahead->u, (size_t)state->size * sizeof(double));
done:
  return status;
}

static bw_status fail_step(bw_context *context, const bw_solid_transient *motion,
                           const bwi_newton_state *state) {
  const bw_transient_options *o = &motion->options;
  const bw_solid_shape *shape = &state->now.shape;
  double at[3];
  bw_status status;
  int32_t worst = shape->worst;
  bw_grid_position(motion->solid->grid, motion->solid->grid->element[8 * (int64_t)worst], at);
  if (state->obstacle == BWI_INVERTED)
    status = bw_fail(context, BW_GEOMETRY,
                     "the step from %g s, %g s long, ends with %lld inverted elements, the worst "
                     "element %d at (%g, %g, %g) m with det F = %.3g. Make the step "
                     "shorter, or allow inverted elements",
                     motion->time, o->step, (long long)shape->inverted, (int)worst + 1, at[0],
                     at[1], at[2], shape->min_ratio);
  else
    status = bw_fail(context, BW_CONVERGENCE,
                     "the step from %g s, %g s long, found no solution after %d iterations: %s. "
                     "The residual is %.2e of the forces at work, the tolerance %.2e; the most "
                     "compressed element is %d at (%g, %g, %g) m, det F = %.3g. Make the step "
                     "shorter, or allow more iterations",
                     motion->time, o->step, state->report->iterations,
                     bwi_obstacle_text(state->obstacle), state->relative, o->tolerance,
                     (int)worst + 1, at[0], at[1], at[2], shape->min_ratio);
  bw_detail_number(context, "time", motion->time);
  bw_detail_number(context, "step", o->step);
  bw_detail_number(context, "residual", state->relative);
  bw_detail_number(context, "element", worst + 1);
  for (int d = 0; d < 3; d++)
    bw_detail_number(context, d == 0 ? "x" : d == 1 ? "y" : "z", at[d]);
  return status;
}

/* Nothing fails from here on. */
static void take(bw_solid_transient *motion, const bwi_transient_rule *rule,
                 const bwi_newton_state *state, double follower_work) {
  bwi_transient *inner = motion->inner;
  const bw_solid *solid = motion->solid;
  double before = motion->kinetic + motion->strain + motion->potential;
  for (int64_t i = 0; i < state->size; i++) {
    double moved = state->now.u[i] - inner->centre[i];
    if (motion->load_case->constrained[i])
      continue;
    motion->displacement[i] = state->now.u[i];
    motion->velocity[i] = inner->next_velocity[i] + rule->velocity * moved;
    motion->acceleration[i] = moved / rule->displacement;
    if (state->now.contact && motion->options.scheme == BW_NEWMARK)
      motion->acceleration[i] -= state->now.contact[i] / solid->mass[i / 3];
  }
  motion->strain = state->now.energy;
  motion->kinetic = bwi_transient_kinetic(solid, motion->velocity);
  motion->potential = -bwi_transient_work(motion, motion->displacement);
  motion->dissipated +=
      before + follower_work - motion->kinetic - motion->strain - motion->potential;
  motion->time += motion->options.step;
  motion->steps++;
}

bw_status bw_solid_transient_step(bw_context *context, bw_solid_transient *motion) {
  bw_status status = BW_OK;
  const bw_transient_options *o = &motion->options;
  bwi_transient *inner = motion->inner;
  bw_newton_options newton;
  bw_newton_report report = {0};
  bwi_newton_state state = {
      .context = context, .solid = motion->solid, .load_case = motion->load_case};
  double start = bw_seconds(), work = 0;
  bool found = false, stiff = o->stiffness_damping > 0, direct = !bwi_transient_iterates(o);
  BW_TRY(bwi_transient_check(context, o));
  BW_TRY(bw_check_cancel(context));
  bwi_transient_rule rule = bwi_transient_rule_of(o);
  double of_mass = 1 / rule.displacement + rule.velocity * o->mass_damping;
  BW_TRY(prepare_contact_planes(context, motion, of_mass));
  BW_TRY(set_centre(context, motion, &rule));
  bwi_quadratic inertia = {.centre = inner->centre,
                           .force = inner->workspace[0],
                           .of_mass = of_mass,
                           .stiffness = stiff && direct ? inner->damping : NULL,
                           .linear = stiff && !direct ? inner->damping_linear : NULL,
                           .of_stiffness = rule.velocity * o->stiffness_damping,
                           .workspace = {inner->workspace[1], inner->workspace[2]}};
  bw_newton_options_default(&newton);
  newton.tolerance = o->tolerance;
  newton.iterations = o->iterations;
  newton.solver = o->solver;
  newton.allow_inverted = o->allow_inverted;
  state.newton = inner->newton;
  newton.max_iterations = INT_MAX; /* a step has one load step */
  state.options = &newton;
  state.report = &report;
  BW_TRY(bwi_newton_state_create(&state));
  if (o->iterations == 1) /* no other follows that would make up for it */
    state.plan.tolerance = o->tolerance;
  state.load = 1;
  state.quadratic = &inertia;
  state.contact = inner->contact;
  if (inner->contact) {
    memcpy(inner->multiplier, inner->contact->multiplier,
           (size_t)inner->contact->count * sizeof(double));
    bwi_contact_place(inner->contact, 1, false);
  }
  BW_TRY(choose_start(motion, &rule, &state));
  BW_TRY(bwi_tangent_blocks(&state)); /* the rounding bound is computed from them */
  BW_TRY(bwi_newton_equilibrium(&state, 1, &found));
  bool went = report.history_count > 0 && report.history[report.history_count - 1].step > 0;
  if (!found && !(o->iterations == 1 && state.obstacle == BWI_ITERATIONS && went))
    BW_TRY(fail_step(context, motion, &state));
  if (state.follows) { /* by the trapezoidal rule */
    const double *u[2] = {motion->displacement, state.now.u};
    memset(inner->workspace[1], 0, (size_t)state.size * sizeof(double));
    for (int k = 0; k < 2; k++)
      BW_TRY(bwi_load_case_follow(context, motion->load_case, u[k], 0.5, inner->workspace[1]));
    for (int64_t i = 0; i < state.size; i++)
      work += inner->workspace[1][i] * (u[1][i] - u[0][i]);
  }
  BW_TRY(bw_check_cancel(context)); /* a result would surprise who asked to stop */
  take(motion, &rule, &state, work);
  report.shape = state.now.shape;
  report.contacts = state.now.contacts;
  report.load = 1;
  report.load_steps = 1;
  report.residual = state.relative;
  report.seconds = bw_seconds() - start;
  bwi_newton_state_report(&state, &motion->report);
  bw_free(motion->newton.history);
  motion->newton = report;
  report.history = NULL;
done:
  if (status != BW_OK && inner->contact && state.contact)
    memcpy(inner->contact->multiplier, inner->multiplier,
           (size_t)inner->contact->count * sizeof(double));
  state.contact = NULL; /* the motion's */
  bwi_newton_state_clear(&state);
  bw_free(report.history);
  return status;
}

/* What steps change, to be put back. */
typedef struct motion_before {
  bw_solid_transient as; /* numbers and report, whose history it owns */
  double *field[3], *multiplier;
} motion_before;

static bw_status keep(bw_context *context, bw_solid_transient *motion, motion_before *former) {
  const bwi_contact *contact = motion->inner->contact;
  const double *field[] = {motion->displacement, motion->velocity, motion->acceleration};
  size_t size = 3 * (size_t)motion->solid->grid->node_count;
  for (int k = 0; k < 3; k++) {
    former->field[k] = BW_NEW(context, double, size);
    if (!former->field[k])
      return BW_MEMORY;
    memcpy(former->field[k], field[k], size * sizeof(double));
  }
  if (contact) {
    former->multiplier = BW_NEW(context, double, contact->count);
    if (!former->multiplier)
      return BW_MEMORY;
    memcpy(former->multiplier, contact->multiplier, (size_t)contact->count * sizeof(double));
  }
  former->as = *motion;
  motion->newton.history = NULL;
  return BW_OK;
}

/* A contact that steps have made begins without pushes. */
static void put_back(bw_solid_transient *motion, motion_before *former) {
  bwi_contact *contact = motion->inner->contact;
  double *field[] = {motion->displacement, motion->velocity, motion->acceleration};
  size_t size = 3 * (size_t)motion->solid->grid->node_count;
  for (int k = 0; k < 3; k++)
    memcpy(field[k], former->field[k], size * sizeof(double));
  for (int64_t k = 0; contact && k < contact->count; k++)
    contact->multiplier[k] = former->multiplier ? former->multiplier[k] : 0;
  bw_free(motion->newton.history);
  motion->newton = former->as.newton;
  former->as.newton.history = NULL;
  motion->report = former->as.report;
  motion->time = former->as.time;
  motion->steps = former->as.steps;
  motion->kinetic = former->as.kinetic;
  motion->strain = former->as.strain;
  motion->potential = former->as.potential;
  motion->dissipated = former->as.dissipated;
}

bw_status bw_solid_transient_advance(bw_context *context, bw_solid_transient *motion,
                                     int64_t count) {
  bw_status status = BW_OK;
  motion_before former = {0};
  bool kept = false;
  if (count > 1) { /* one step keeps itself */
    BW_TRY(keep(context, motion, &former));
    kept = true;
  }
  for (int64_t i = 0; i < count; i++) {
    if (count > 1)
      bw_progress(context, "transient", (double)i / (double)count);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_solid_transient_step(context, motion));
  }
done:
  if (kept && status != BW_OK)
    put_back(motion, &former);
  if (kept)
    bw_free(former.as.newton.history);
  for (int k = 0; k < 3; k++)
    bw_free(former.field[k]);
  bw_free(former.multiplier);
  return status;
}
