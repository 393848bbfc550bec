/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Motions of solids: what one is, and where it begins. */
#include "nonlinear/transient.h"
#include "grid/internal.h"

#include <math.h>
#include <string.h>

static void destroy(void *object) {
  bw_solid_transient *motion = (bw_solid_transient *)object;
  bwi_transient *inner = motion->inner;
  if (inner) {
    bw_release(inner->newton);
    bw_free(inner->dead);
    bwi_contact_destroy(inner->contact);
    bw_free(inner->multiplier);
    bw_free(inner->damping);
    bw_solid_linear_destroy(inner->damping_linear);
    bw_free(inner->centre);
    bw_free(inner->next_velocity);
    bw_free(inner->workspace[0]);
    bw_free(inner->workspace[1]);
    bw_free(inner->workspace[2]);
    bw_free(inner);
  }
  bw_free(motion->newton.history);
  bw_release(motion->options.solver);
  bw_free(motion->displacement);
  bw_free(motion->velocity);
  bw_free(motion->acceleration);
  bw_release(motion->load_case);
  bw_release(motion->solid);
  bw_free(motion);
}

static size_t bytes(const void *object) {
  const bw_solid_transient *motion = (const bw_solid_transient *)object;
  size_t nodes = (size_t)motion->solid->grid->node_count;
  size_t damping = motion->inner && motion->inner->damping ? 9 : 0;
  return sizeof *motion + (motion->inner ? bw_bytes(motion->inner->newton) : 0) +
         nodes * 9 * 3 * sizeof(double) +
         damping * (size_t)motion->solid->pattern->block_count * sizeof(double);
}

static const bw_kind motion_kind = {"transient", destroy, bytes};

void bw_transient_options_default(bw_transient_options *options) {
  *options = (bw_transient_options){.scheme = BW_IMPLICIT_EULER,
                                    .step = 0.01,
                                    .beta = 0.25,
                                    .gamma = 0.5,
                                    .tolerance = 1e-6,
                                    .iterations = 30};
}

bw_status bwi_transient_check(bw_context *context, const bw_transient_options *o) {
  bw_status status = BW_OK;
  bwi_newton_plan plan;
  if (o->scheme != BW_IMPLICIT_EULER && o->scheme != BW_NEWMARK)
    return bw_fail(context, BW_INVALID, "time integration scheme %d is not known", (int)o->scheme);
  if (!(o->step > 1e-100 && o->step < 1e100)) /* its square is divided by */
    return bw_fail(context, BW_INVALID,
                   "the time step is %g s; it must be positive (from 1e-100 to 1e100)", o->step);
  if (!(o->mass_damping >= 0 && o->stiffness_damping >= 0) || !isfinite(o->mass_damping) ||
      !isfinite(o->stiffness_damping))
    return bw_fail(context, BW_INVALID,
                   "damping by mass %g 1/s, by stiffness %g s: neither may be negative",
                   o->mass_damping, o->stiffness_damping);
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance is %g; it must lie between 0 and 1",
                   o->tolerance);
  BW_TRY(bwi_newton_plan_make(context, o->solver, 0, 0, &plan));
  if (plan.two_level)
    return bw_fail(context, BW_INVALID,
                   "steps in time have no two_level: give cholesky, or pcg with jacobi");
  if (o->solver && (o->solver->options.tolerance > 0 || o->solver->options.max_iterations > 0))
    return bw_fail(context, BW_INVALID,
                   "a step in time chooses tolerance and max_iterations of pcg: leave them out");
  if (o->iterations < 1)
    return bw_fail(context, BW_INVALID,
                   "%d iterations in a step; 1 for the linearly implicit integrator, 30 otherwise",
                   o->iterations);
  if (o->scheme == BW_NEWMARK && !(o->gamma >= 0.5 && o->gamma <= 2))
    return bw_fail(context, BW_INVALID,
                   "Newmark's gamma is %g: it must lie from 1/2 to 2. Below 1/2 the amplitude "
                   "grows without load; 1/2 conserves the energy",
                   o->gamma);
  if (o->scheme == BW_NEWMARK && !(2 * o->beta >= o->gamma && o->beta <= 2))
    return bw_fail(context, BW_INVALID,
                   "Newmark's beta is %g; below gamma / 2 = %g the method is stable for short "
                   "steps only. 1/4 is average acceleration",
                   o->beta, o->gamma / 2);
done:
  return status;
}

bool bwi_transient_iterates(const bw_transient_options *options) {
  return options->solver && options->solver->options.kind == BW_SOLVER_PCG;
}

bwi_transient_rule bwi_transient_rule_of(const bw_transient_options *o) {
  double h = o->step;
  if (o->scheme == BW_IMPLICIT_EULER)
    return (bwi_transient_rule){h * h, 1 / h, 0, 0};
  return (bwi_transient_rule){o->beta * h * h, o->gamma / (o->beta * h), (0.5 - o->beta) * h * h,
                              (1 - o->gamma) * h};
}

static bw_status check_finite(bw_context *context, const char *what, const double *value,
                              int64_t count) {
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(value[i])) {
      bw_fail(context, BW_INVALID, "the %s of node %lld is %g", what, (long long)(i / 3 + 1),
              value[i]);
      bw_detail_number(context, "node", (double)(i / 3 + 1));
      return BW_INVALID;
    }
  return BW_OK;
}

static bw_status reserve(bw_context *context, bw_solid_transient *motion) {
  bwi_transient *inner = motion->inner = BW_NEW0(context, bwi_transient, 1);
  if (!inner)
    return BW_MEMORY;
  double **workspace[] = {&motion->displacement, &motion->velocity,    &motion->acceleration,
                          &inner->dead,          &inner->centre,       &inner->next_velocity,
                          &inner->workspace[0],  &inner->workspace[1], &inner->workspace[2]};
  for (size_t k = 0; k < sizeof workspace / sizeof *workspace; k++) {
    *workspace[k] = BW_NEW0(context, double, 3 * (int64_t)motion->solid->grid->node_count);
    if (!*workspace[k])
      return BW_MEMORY;
  }
  return bw_newton_create(context, &inner->newton);
}

double bwi_transient_kinetic(const bw_solid *solid, const double *v) {
  double sum = 0;
  for (int64_t i = 0; i < solid->grid->node_count; i++)
    sum += solid->mass[i] * bw_dot(v + 3 * i, v + 3 * i);
  return 0.5 * sum;
}

double bwi_transient_work(const bw_solid_transient *motion, const double *u) {
  double sum = 0;
  for (int64_t i = 0; i < 3 * (int64_t)motion->solid->grid->node_count; i++)
    sum += motion->inner->dead[i] * u[i];
  return sum;
}

bw_status bwi_transient_tangent(bw_context *context, bw_solid_transient *motion, const double *x,
                                double *y) {
  bw_status status = BW_OK;
  bwi_transient *inner = motion->inner;
  const bw_solid *solid = motion->solid;
  bw_solid_shape shape;
  if (!bwi_transient_iterates(&motion->options)) {
    if (!inner->damping)
      inner->damping = BW_NEW(context, double, 9 * solid->pattern->block_count);
    if (!inner->damping)
      return BW_MEMORY;
    BW_TRY(bw_solid_evaluate(context, solid, motion->displacement, true, NULL, NULL, inner->damping,
                             &shape));
    BW_TRY(bw_block_multiply(context, solid->pattern, inner->damping, 9, 3, 1, x, y));
  } else {
    if (!inner->damping_linear)
      BW_TRY(bw_solid_linear_create(context, solid, &inner->damping_linear));
    BW_TRY(bw_solid_linear_set(context, inner->damping_linear, motion->displacement, true));
    BW_TRY(bw_solid_linear_multiply(context, inner->damping_linear, x, y));
  }
done:
  return status;
}

/* M a = f - grad W - C v, and the strain energy. */
static bw_status begin(bw_context *context, bw_solid_transient *motion) {
  bw_status status = BW_OK;
  const bw_solid *solid = motion->solid;
  bwi_transient *inner = motion->inner;
  double *force = inner->workspace[0], *other = inner->workspace[1];
  int64_t size = 3 * (int64_t)solid->grid->node_count;
  bw_solid_shape shape;
  BW_TRY(bw_solid_evaluate(context, solid, motion->displacement, false, &motion->strain, other,
                           NULL, &shape));
  if (!shape.defined || !isfinite(motion->strain)) {
    status = bw_fail(
        context, BW_GEOMETRY,
        "the initial shape of the motion has no energy: element %d is inverted (det F = %g)",
        (int)shape.worst + 1, shape.min_ratio);
    bw_detail_number(context, "element", shape.worst + 1);
    goto done;
  }
  memcpy(force, inner->dead, (size_t)size * sizeof *force);
  BW_TRY(bwi_load_case_follow(context, motion->load_case, motion->displacement, 1, force));
  for (int64_t i = 0; i < size; i++)
    force[i] -= other[i];
  if (motion->options.stiffness_damping > 0) {
    BW_TRY(bwi_transient_tangent(context, motion, motion->velocity, other));
    for (int64_t i = 0; i < size; i++)
      force[i] -= motion->options.stiffness_damping * other[i];
  }
  for (int64_t i = 0; i < size; i++)
    motion->acceleration[i] =
        motion->load_case->constrained[i]
            ? 0
            : force[i] / solid->mass[i / 3] - motion->options.mass_damping * motion->velocity[i];
  motion->kinetic = bwi_transient_kinetic(solid, motion->velocity);
  motion->potential = -bwi_transient_work(motion, motion->displacement);
done:
  return status;
}

bw_status bw_solid_transient_create(bw_context *context, const bw_solid *solid,
                                    const bw_load_case *load_case,
                                    const bw_transient_options *options, const double *u,
                                    const double *v, bw_solid_transient **out) {
  bw_status status = BW_OK;
  bw_solid_transient *motion = NULL;
  bw_transient_options plain;
  int64_t size = 3 * (int64_t)solid->grid->node_count;
  bw_transient_options_default(&plain);
  options = options ? options : &plain;
  BW_TRY(bwi_transient_check(context, options));
  if (!bwi_grid_same_places(load_case->grid, solid->grid))
    return bw_fail(context, BW_INVALID, "the supports and loads belong to another grid");
  if (solid->weightless)
    return bw_fail(context, BW_INVALID,
                   "transient dynamics needs the density of every material, and one is not given");
  if (u)
    BW_TRY(check_finite(context, "displacement", u, size));
  if (v)
    BW_TRY(check_finite(context, "velocity", v, size));
  motion = BW_NEW0(context, bw_solid_transient, 1);
  if (!motion)
    return BW_MEMORY;
  bw_object_init(motion, &motion_kind);
  motion->report.solver = motion->report.backend = motion->report.preconditioner = "";
  motion->solid = bw_retain(solid);
  motion->load_case = bw_retain(load_case);
  motion->options = *options;
  bw_retain(options->solver);
  BW_TRY(reserve(context, motion));
  for (int64_t i = 0; i < size; i++) {
    motion->displacement[i] = load_case->constrained[i] ? load_case->value[i] : u ? u[i] : 0;
    motion->velocity[i] = load_case->constrained[i] || !v ? 0 : v[i];
  }
  BW_TRY(bwi_load_case_dead(context, solid, load_case, motion->inner->dead));
  BW_TRY(begin(context, motion));
  *out = motion;
  motion = NULL;
done:
  bw_release(motion);
  return status;
}

bw_status bw_solid_transient_check(bw_context *context, const bw_solid_transient *motion) {
  const bwi_transient *inner = motion->inner;
  const double *field[] = {motion->displacement, motion->velocity, motion->acceleration,
                           inner->dead};
  const double number[] = {motion->time, motion->kinetic, motion->strain, motion->potential,
                           motion->dissipated};
  int64_t size = 3 * (int64_t)motion->solid->grid->node_count;
  if (!bwi_grid_same_places(motion->load_case->grid, motion->solid->grid) || motion->steps < 0 ||
      (inner->contact && inner->contact->load_case != motion->load_case))
    return bw_fail(context, BW_INTERNAL, "a motion's case is of another solid");
  for (size_t k = 0; k < sizeof number / sizeof *number; k++)
    if (!isfinite(number[k]))
      return bw_fail(context, BW_INTERNAL, "time or an energy of a motion is %g", number[k]);
  for (int64_t i = 0; i < size; i++) {
    for (size_t k = 0; k < sizeof field / sizeof *field; k++)
      if (!isfinite(field[k][i]))
        return bw_fail(context, BW_INTERNAL, "node %lld of a motion has %g in field %zu",
                       (long long)(i / 3) + 1, field[k][i], k);
    if (motion->load_case->constrained[i] &&
        (motion->displacement[i] != motion->load_case->value[i] || motion->velocity[i] != 0 ||
         motion->acceleration[i] != 0))
      return bw_fail(context, BW_INTERNAL, "node %lld of a motion is fixed and moves",
                     (long long)(i / 3) + 1);
  }
  return BW_OK;
}
