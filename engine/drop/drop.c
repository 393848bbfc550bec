/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A body that falls on a rigid obstacle: impacts in steps that keep the energy, and flight between
 * them (docs/theory/drop.md).
 *
 * A step is half a kick by the forces of contact, free motion, and the other half (Stoermer and
 * Verlet): symmetric and symplectic. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/stress_peaks.h"
#include "barwright/analysis.h"
#include "base/dense.h"
#include "contact/internal.h"
#include "drop/internal.h"
#include "model/internal.h"

enum { MODES = 40, ROWS = 2048, WIDTH = 7, MOST_IMPACTS = 10000, HALVINGS = 8 };
static const int64_t most_steps = 4000000; /* of an impact */
static const double first_fraction = 0.2;  /* step times the highest frequency */
static const double far_turn = 0.1;        /* (rad) of a warning */
static const double least_slope = 1e-3;    /* sine between a fall and the obstacle */

void bw_drop_options_default(bw_drop_options *options) {
  *options = (bw_drop_options){.height = 1,
                               .gravity = 9.80665,
                               .down = {0, 0, -1},
                               .impacts = 1,
                               .tolerance = 1e-3,
                               .samples = 100,
                               .history = true};
}

static void drop_destroy(void *object) {
  bw_drop *d = object;
  bw_release(d->model);
  bw_release(d->modes);
  bw_release(d->fewer);
  bw_release(d->onto);
  double *all[] = {d->time,        d->force,       d->motion,      d->vibration,     d->strain,
                   d->potential,   d->damped,      d->sample,      d->sample_stress, d->stress,
                   d->utilisation, d->peak_stress, d->displacement};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    bw_free(all[i]);
  bw_free(d->impact);
  bw_free(d);
}

static size_t drop_bytes(const void *object) {
  const bw_drop *d = object;
  const bw_mesh *mesh = d->model->mesh;
  size_t numbers = (size_t)d->row_count * WIDTH + 3 * (size_t)d->sample_count;
  if (d->stress)
    numbers +=
        (d->utilisation ? 2 : 1) * (size_t)mesh->element_count + 3 * (size_t)mesh->node_count;
  return sizeof *d + (size_t)d->impact_count * sizeof *d->impact + numbers * sizeof(double) +
         (d->fewer ? drop_bytes(d->fewer) : 0);
}

static const bw_kind drop_kind = {"drop", drop_destroy, drop_bytes};

/* ---- what is asked for ----------------------------------------------------------------------- */

static bool finite3(const double *x) {
  return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

static bw_status check_obstacle(bw_context *context, const bw_drop_options *o) {
  double cosine = bw_dot(o->onto->direction, o->down) / bw_norm(o->down);
  if (o->onto->inside)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a body falls on the outside of a sphere or cylinder: leave out `inside`");
  if (o->onto->kind == BW_RIGID_PLANE && !(cosine < -least_slope))
    return bw_fail(context, BW_INVALID,
                   "the body does not fall towards the plane: its normal must point against "
                   "`down`");
  if (o->onto->kind == BW_RIGID_CYLINDER && !(1 - cosine * cosine > least_slope * least_slope))
    return bw_fail(context, BW_INVALID,
                   "the body falls along the cylinder: its axis must point across `down`");
  return BW_OK;
}

static bw_status check_options(bw_context *context, const bw_drop_options *o) {
  if (!(o->height >= 0) || !(o->speed >= 0) || !(o->gravity >= 0) ||
      !isfinite(o->height + o->speed + o->gravity))
    return bw_fail(context, BW_INVALID,
                   "a drop of %g m with %g m/s under %g m/s2: none of these may be negative",
                   o->height, o->speed, o->gravity);
  if (!finite3(o->down) || !(bw_norm(o->down) > 0) || !finite3(o->spin))
    return bw_fail(context, BW_INVALID,
                   "a drop needs a direction `down` and a spin of three finite numbers, the "
                   "direction not all zero");
  if (o->speed == 0 && !(o->height * o->gravity > 0))
    return bw_fail(context, BW_INVALID,
                   "the body would not move along `down`: give a height and gravity, or a speed");
  if (o->impacts < 1 || o->impacts > MOST_IMPACTS)
    return bw_fail(context, BW_INVALID, "%d impacts were requested: 1 to %d expected", o->impacts,
                   MOST_IMPACTS);
  if (o->samples < 0 || o->samples > 100000)
    return bw_fail(context, BW_INVALID, "%d samples of the stress: 0 to 100000 expected",
                   o->samples);
  if (!(o->time >= 0) || !(o->tolerance > 0))
    return bw_fail(context, BW_INVALID,
                   "a time of %g s and a tolerance of %g: the first may not be negative, the "
                   "second must be positive",
                   o->time, o->tolerance);
  if (o->damping.mass != 0 || o->damping.loss != 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   o->damping.loss != 0
                       ? "a loss factor is for harmonic motion: give damping by a ratio or "
                         "by stiffness"
                       : "damping by mass would slow the fall: give damping by a ratio or by "
                         "stiffness");
  if (!(o->damping.ratio >= 0 && o->damping.ratio < 1) || !(o->damping.stiffness >= 0) ||
      !isfinite(o->damping.stiffness))
    return bw_fail(context, BW_INVALID,
                   "damping by a ratio of %g and %g s of the stiffness: 0 to below 1, and 0 or "
                   "more expected",
                   o->damping.ratio, o->damping.stiffness);
  return o->onto ? check_obstacle(context, o) : BW_OK;
}

static bw_status check_model(bw_context *context, const bw_model *model) {
  bw_status status = BW_OK;
  BW_TRY(bw_model_refuse_joints(context, model));
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++) {
    const bw_material *part = bw_material_part(model->material, i);
    if (!(part->density > 0))
      return bw_fail(context, BW_INVALID,
                     "a drop needs the density of the material, and %s has none",
                     part->name[0] ? part->name : "this one");
  }
  if (model->support_count > 0 || model->load_count > 0)
    return bw_fail(context, BW_INVALID,
                   "a body that drops has neither supports nor loads, and this model has %d and "
                   "%d: make a model without",
                   model->support_count, model->load_count);
  if (model->mesh->component_count != 1)
    return bw_fail(context, BW_INVALID,
                   "the mesh has %d parts that nothing joins: drop one of them",
                   model->mesh->component_count);
  if (model->mesh->node_count > INT32_MAX / 3)
    return bw_fail(context, BW_LIMIT, "%d nodes are too many for a drop", model->mesh->node_count);
done:
  return status;
}

/* Modes, their motion of the points that may touch, and displacements whose stress is found at
 * once: two blocks of BWI_PEAK_FIELDS. */
static bw_status check_memory(bw_context *context, const bwi_drop_run *run) {
  const bw_mesh *mesh = run->model->mesh;
  const bw_modes *own = run->options.modes;
  double size = 3.0 * mesh->node_count, count = own ? own->count : MODES;
  double numbers = (own ? 0 : count * size) + 3 * count * mesh->boundary_node_count;
  if (run->options.samples > 0)
    numbers += 2 * BWI_PEAK_FIELDS * size;
  return bwi_drop_check_memory(context, numbers, "the modes and displacements",
                               "use fewer elements");
}

static bw_status find_modes(bw_context *context, bwi_drop_run *run, bw_system *given,
                            bw_system **system, bw_modes **modes) {
  bw_status status = BW_OK;
  const bw_modes *own = run->options.modes;
  if (own) {
    if (own->mesh != run->model->mesh || own->material != run->model->material ||
        own->components != 3 || own->count < 1 || own->rigid_count != 6)
      return bw_fail(context, BW_INVALID,
                     "the modes are not elastic modes of this model: compute them of the same "
                     "mesh and material, without supports");
    BW_TRY(bw_system_of_model(context, run->model, NULL, given, system));
    *modes = bw_retain(own);
  } else {
    bw_modes_options options;
    bw_modes_options_default(&options);
    options.count = MODES; /* and not all of a small mesh: contact needs what they leave */
    if (3 * (int64_t)run->model->mesh->node_count < 2 * MODES + 6)
      options.count = (3 * run->model->mesh->node_count - 6) / 2;
    BW_TRY(bw_modes_of_model(context, run->model, given, &options, system, modes));
  }
  BW_TRY(bw_system_factor(context, *system)); /* and the mass */
done:
  return status;
}

/* ---- the body -------------------------------------------------------------------------------- */

/* Mass, centre and inertia by the mass matrix, so that modes have no part of rigid motion. It is
 * that of `given` where it has the model's. */
static bw_status weigh(bw_context *context, bwi_drop_run *run, const bw_system *given) {
  bw_status status = BW_OK;
  const bw_model *model = run->model;
  bool has =
      given && given->mass && given->mesh == model->mesh && given->material == model->material;
  bw_block_pattern *pattern = NULL;
  double *mass = NULL;
  const bw_mesh *mesh = model->mesh;
  bwi_drop_motion *m = &run->motion;
  int64_t count = mesh->node_count;
  double low[3], high[3], first[3] = {0}, second[9] = {0};
  double *x = BW_NEW(context, double, 6 * count), *y = BW_NEW(context, double, 6 * count);
  BW_TRY_MEMORY(x && y);
  if (!has) {
    BW_TRY(bw_block_pattern_create(context, mesh, &pattern));
    mass = BW_NEW(context, double, pattern->block_count);
    BW_TRY_MEMORY(mass);
    BW_TRY(bw_mass(context, pattern, mesh, model->material, mass));
  }
  bw_mesh_box(mesh, low, high); /* moments about a point nearby lose fewer digits */
  for (int64_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) {
      x[3 * i + k] = mesh->node[3 * i + k] - low[k];
      x[3 * (count + i) + k] = 1;
    }
  BW_TRY(bw_block_multiply(context, has ? given->pattern : pattern, has ? given->mass : mass, 1, 3,
                           2, x, y));
  for (int64_t i = 0; i < count; i++) {
    m->mass += y[3 * (count + i)];
    for (int k = 0; k < 3; k++) {
      first[k] += y[3 * i + k];
      for (int l = 0; l < 3; l++)
        second[3 * k + l] += x[3 * i + k] * y[3 * i + l];
    }
  }
  for (int k = 0; k < 3; k++)
    run->origin[k] = first[k] / m->mass;
  for (int k = 0; k < 3; k++)
    for (int l = 0; l < 3; l++)
      second[3 * k + l] -= m->mass * run->origin[k] * run->origin[l];
  double trace = second[0] + second[4] + second[8];
  for (int i = 0; i < 9; i++)
    m->inertia[i] = (i % 4 == 0 ? trace : 0) - second[i];
  bw_inverse3(m->inertia, m->inverse);
  for (int k = 0; k < 3; k++)
    run->origin[k] += low[k];
done:
  bw_release(pattern);
  bw_free(mass);
  bw_free(x);
  bw_free(y);
  return status;
}

/* How it moves when it touches. */
static bw_status begin(bw_context *context, bwi_drop_run *run, bw_drop *drop) {
  bwi_drop_motion *m = &run->motion;
  const bw_drop_options *o = &run->options;
  double length = bw_norm(o->down);
  memcpy(m->centre, run->origin, sizeof m->centre);
  for (int k = 0; k < 9; k++)
    m->turn[k] = k % 4 == 0;
  drop->speed = o->speed > 0 ? o->speed : sqrt(2 * o->gravity * o->height);
  for (int k = 0; k < 3; k++) {
    m->velocity[k] = drop->speed * o->down[k] / length;
    m->gravity[k] = o->gravity * o->down[k] / length;
    m->momentum[k] = bw_dot(m->inertia + 3 * k, o->spin);
  }
  drop->mass = m->mass;
  drop->energy = bwi_drop_energy_of(run).motion;
  drop->depth = run->depth;
  return bwi_rigid_create(context, &run->onto, &drop->onto);
}

/* ---- impacts --------------------------------------------------------------------------------- */

typedef struct history {
  double *row; /* (count x WIDTH) */
  int count, capacity;
} history;

static bw_status append(bw_context *context, const bwi_drop_rows *rows, history *h) {
  if (h->count + rows->count > h->capacity) {
    int capacity = 2 * (h->count + rows->count);
    double *larger = BW_NEW(context, double, (int64_t)capacity *WIDTH);
    if (!larger)
      return BW_MEMORY;
    if (h->count > 0)
      memcpy(larger, h->row, (size_t)h->count * WIDTH * sizeof *larger);
    bw_free(h->row);
    h->row = larger;
    h->capacity = capacity;
  }
  memcpy(h->row + (size_t)h->count * WIDTH, rows->row,
         (size_t)rows->count * WIDTH * sizeof *rows->row);
  h->count += rows->count;
  return BW_OK;
}

static double total_of(const bwi_drop_run *run, const bwi_drop_energy *e) {
  return e->motion + e->vibration + e->strain + e->potential + run->motion.damped;
}

static double force_of(const bwi_drop_run *run) {
  double force[3];
  bwi_drop_force(run, force);
  return bw_norm(force);
}

/* A row of the present state; returns the sum of its energies. */
static double note(const bwi_drop_run *run, bwi_drop_rows *rows) {
  const bwi_drop_energy e = bwi_drop_energy_of(run);
  double *row = bwi_drop_rows_next(rows);
  if (row) {
    row[0] = run->motion.time;
    row[1] = force_of(run);
    row[2] = e.motion;
    row[3] = e.vibration;
    row[4] = e.strain;
    row[5] = e.potential;
    row[6] = run->motion.damped;
  }
  return total_of(run, &e);
}

static double area_of(const bwi_drop_run *run) {
  double sum = 0;
  for (int j = 0; j < run->touch.count; j++)
    if (run->touch.force[j] > 0)
      sum += fmax(
          0, -bw_dot(run->points.area + 3 * (int64_t)run->touch.point[j], run->touch.push + 3 * j));
  return sum;
}

/* The first touched place, and what the present forces add to the impact. */
static void regard(const bwi_drop_run *run, double force, bw_drop_impact *impact) {
  const bwi_drop_motion *m = &run->motion;
  const bwi_drop_touch *t = &run->touch;
  if (impact->contacts == 0) {
    int first = 0;
    for (int j = 0; j < t->count; j++)
      first = t->force[j] > t->force[first] ? j : first;
    impact->time = m->time;
    memcpy(impact->place, run->model->mesh->node + 3 * (int64_t)run->points.node[t->point[first]],
           sizeof impact->place);
    impact->contacts = 1;
  }
  impact->duration = m->time - impact->time;
  impact->turn = fmax(impact->turn, bwi_drop_turn(run));
  impact->area = fmax(impact->area, area_of(run));
  if (force > impact->force) {
    impact->force = force;
    impact->peak_time = m->time;
  }
}

typedef struct follow {
  bwi_drop_run *run;
  bw_drop *drop;
  double fraction; /* of a step */
  double period;   /* of the lowest mode */
  double begin;    /* energy when the body touches first */
  double changed;  /* most by which it is another in the last impact or flight, */
  double error;    /* and by which it changed during this */
  double allowed;  /* of `error`: beyond it, an impact is not followed further */
  bool over;       /* the time is up, or nothing touches any more */
} follow;

static double step_length(const follow *f) {
  double highest = f->run->motion.omega[f->run->motion.modes - 1];
  return f->fraction / hypot(highest, f->run->touch.stiffest);
}

static bw_status one_step(bw_context *context, bwi_drop_run *run, double h) {
  bwi_drop_kick(run, 0.5 * h);
  run->touch.traveled += h * (bwi_drop_speed(run) + h * bw_norm(run->motion.gravity));
  bwi_drop_drift(&run->motion, h);
  bw_status status = bwi_drop_touch_find(context, run);
  bwi_drop_kick(run, 0.5 * h);
  return status;
}

/* From the present state until nothing has touched for a period of the lowest mode. */
static bw_status follow_impact(bw_context *context, follow *f, bw_drop_impact *impact,
                               bwi_drop_rows *rows, bwi_drop_states *states) {
  bw_status status = BW_OK;
  bwi_drop_run *run = f->run;
  bwi_drop_motion *m = &run->motion;
  double start = 0, quiet = m->time, last = 0, push[3], impulse[3] = {0};
  double until = run->options.time > 0 ? run->options.time : INFINITY;
  f->error = f->changed = 0;
  f->over = false;
  BW_TRY(bwi_drop_touch_find(context, run));
  for (int64_t step = 0;; step++) {
    double force = force_of(run), total = note(run, rows), h = step_length(f);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_drop_states_take(context, run, states));
    if (step == 0)
      start = total;
    f->error = fmax(f->error, fabs(total - start));
    f->changed = fmax(f->changed, fabs(total - f->begin));
    if (force > 0) {
      regard(run, force, impact);
      quiet = m->time;
    }
    f->over = m->time >= until;
    if (f->over || m->time - quiet > f->period || f->error > f->allowed)
      break;
    if (step > most_steps)
      BW_TRY(bw_fail(context, BW_LIMIT,
                     "the body still touches %g s after the impact began: give a time at which "
                     "the drop ends",
                     m->time - impact->time));
    for (int half = 0; half < 2; half++) {
      if (half == 1)
        BW_TRY(one_step(context, run, h));
      bwi_drop_force(run, push);
      for (int k = 0; k < 3; k++)
        impulse[k] += 0.5 * h * push[k];
    }
    last = h;
    f->drop->steps++;
  }
  impact->impulse = bw_norm(impulse);
  if (last > 0)
    f->drop->step = f->drop->step > 0 ? fmin(f->drop->step, last) : last;
done:
  return status;
}

/* The impact in steps that are halved until the energy is kept well enough. */
static bw_status impact_of(bw_context *context, follow *f, history *h) {
  bw_status status = BW_OK;
  bwi_drop_run *run = f->run;
  bw_drop *drop = f->drop;
  bw_drop_impact impact;
  bwi_drop_motion start = {0};
  bwi_drop_rows rows = {0};
  bwi_drop_states states = {.capacity = 2 * run->options.samples, .stride = 1};
  BW_TRY(bwi_drop_motion_create(context, run->modes, run->motion.modes, &run->options.damping,
                                &start));
  bwi_drop_motion_copy(&run->motion, &start);
  BW_TRY(bwi_drop_touch_create(context, run, &run->touch));
  states.state = BW_NEW0(context, bwi_drop_state, states.capacity);
  BW_TRY_MEMORY(states.state);
  f->fraction = first_fraction;
  for (int halvings = 0;; halvings++) {
    bw_free(rows.row);
    BW_TRY(bwi_drop_rows_create(context, ROWS, WIDTH, &rows));
    bwi_drop_states_empty(&states);
    impact = (bw_drop_impact){0};
    f->allowed = halvings < HALVINGS ? run->options.tolerance * drop->energy : drop->energy;
    BW_TRY(follow_impact(context, f, &impact, &rows, &states));
    if (f->error <= f->allowed)
      break;
    if (halvings == HALVINGS)
      BW_TRY(bw_fail(context, BW_CONVERGENCE,
                     "an impact changes the energy by as much as the body has when it touches, "
                     "although its steps were halved %d times: mesh the body again",
                     HALVINGS));
    bwi_drop_motion_copy(&start, &run->motion);
    run->touch.limit = -1;
    f->fraction *= 0.5;
  }
  if (f->error > run->options.tolerance * drop->energy)
    bw_warn(context,
            "the energy changes by %.2g %% in an impact, although its steps were halved %d times",
            100 * f->error / drop->energy, HALVINGS);
  BW_TRY(append(context, &rows, h));
  if (impact.duration > 0 || impact.contacts > 0) {
    impact.contacts = run->touch.count;
    drop->impact[drop->impact_count++] = impact;
    if (impact.turn > far_turn)
      bw_warn(context,
              "a normal of the contact turns by %.2g degrees in the body while it touches: the "
              "compliance of the contact is that of the first touch",
              impact.turn * 180 / M_PI);
    run->beyond = 0;
    if (drop->stress)
      BW_TRY(bwi_drop_states_stress(context, run, &states, drop));
    if (run->beyond > 1)
      bw_warn(context,
              "contact moves a point %.2g times as far as it was looked for: others may have "
              "entered the obstacle unseen. Make elements there of the size of those that touch",
              run->beyond);
  }
done:
  bwi_drop_states_empty(&states);
  bw_free(states.state);
  bw_free(rows.row);
  bwi_drop_motion_clear(&start);
  bwi_drop_touch_clear(&run->touch);
  return status;
}

/* ---- flight ---------------------------------------------------------------------------------- */

/* How long it takes at least from a distance at a speed of closing and a pull; infinite where it is
 * never covered. */
static double time_to(double distance, double closing, double pull) {
  if (distance <= 0)
    return 0;
  if (pull <= 0)
    return closing > 0 ? distance / closing : INFINITY;
  double root = sqrt(closing * closing + 2 * pull * distance);
  return closing > 0 ? 2 * distance / (closing + root) : (root - closing) / pull;
}

/* How long nothing can touch, at least; infinite where the body leaves for ever. All of the
 * obstacle is below the plane that touches it where it is nearest to the centre of mass: one bound
 * is that of the plane, the other that of a body which moves straight to the obstacle. */
static double safe_time(const bwi_drop_run *run) {
  const bwi_drop_motion *m = &run->motion;
  double spin[3], normal[3], reach = bwi_drop_reach(run);
  bwi_drop_spin(m, spin);
  bwi_rigid_gap(&run->onto, m->centre, normal);
  double distance = bwi_drop_plane_gap(run, normal) - reach, pull = -bw_dot(m->gravity, normal);
  double away = bw_dot(m->velocity, normal), whirl = bw_norm(spin) * run->points.radius;
  if (pull <= 0 && away >= 0 && distance > 2 * run->points.radius)
    return INFINITY;
  double safe = time_to(distance, whirl - away, pull);
  if (run->onto.kind == BW_RIGID_PLANE)
    return safe;
  distance = bwi_drop_rigid_gap(run) - reach;
  return fmax(safe, time_to(distance, bwi_drop_speed(run), bw_norm(m->gravity)));
}

static bw_status fly(bw_context *context, follow *f, history *h) {
  bw_status status = BW_OK;
  bwi_drop_run *run = f->run;
  bwi_drop_motion *m = &run->motion;
  bwi_drop_rows rows = {0};
  double until = run->options.time > 0 ? run->options.time : INFINITY, spin[3];
  BW_TRY(bwi_drop_rows_create(context, ROWS, WIDTH, &rows));
  for (;;) {
    double safe = safe_time(run);
    BW_TRY(bw_check_cancel(context));
    f->changed = fmax(f->changed, fabs(note(run, &rows) - f->begin));
    f->over = m->time >= until || (isinf(safe) && isinf(until));
    if (f->over || safe < 4 * step_length(f))
      break;
    bwi_drop_spin(m, spin);
    double step =
        fmin(fmin(safe, until - m->time), bw_norm(spin) > 0 ? 0.01 / bw_norm(spin) : safe);
    bwi_drop_drift(m, step);
  }
  BW_TRY(append(context, &rows, h));
done:
  bw_free(rows.row);
  return status;
}

/* ---- the drop -------------------------------------------------------------------------------- */

static bw_status take_history(bw_context *context, const history *h, bw_drop *drop) {
  bw_status status = BW_OK;
  double **column[WIDTH] = {&drop->time,   &drop->force,     &drop->motion, &drop->vibration,
                            &drop->strain, &drop->potential, &drop->damped};
  drop->row_count = h->count;
  for (int k = 0; k < WIDTH; k++) {
    *column[k] = BW_NEW(context, double, h->count);
    BW_TRY_MEMORY(*column[k]);
    for (int i = 0; i < h->count; i++)
      (*column[k])[i] = h->row[(size_t)i * WIDTH + (size_t)k];
  }
done:
  return status;
}

static bw_status follow_drop(bw_context *context, bwi_drop_run *run, bw_drop *drop) {
  bw_status status = BW_OK;
  history h = {0};
  follow f = {.run = run, .drop = drop, .period = 2 * M_PI / run->motion.omega[0]};
  f.begin = bwi_drop_energy_of(run).motion;
  for (int round = 0; drop->impact_count < run->options.impacts && !f.over; round++) {
    bw_progress(context, "impacts", (double)drop->impact_count / run->options.impacts);
    if (round > 0)
      BW_TRY(fly(context, &f, &h));
    if (!f.over)
      BW_TRY(impact_of(context, &f, &h));
    drop->error = fmax(drop->error, f.changed / drop->energy);
  }
  bw_progress(context, "impacts", 1);
  BW_TRY(take_history(context, &h, drop));
  memcpy(drop->velocity, run->motion.velocity, sizeof drop->velocity);
  bwi_drop_spin(&run->motion, drop->spin);
  if (run->options.history)
    BW_TRY(bwi_drop_peak_history(context, run, drop));
  drop->solves = run->solves;
done:
  bw_free(h.row);
  return status;
}

static bw_status make_result(bw_context *context, const bwi_drop_run *run, bw_drop **out) {
  bw_status status = BW_OK;
  const bw_model *model = run->model;
  bw_drop *drop = BW_NEW0(context, bw_drop, 1);
  BW_TRY_MEMORY(drop);
  bw_object_init(drop, &drop_kind);
  drop->model = bw_retain(model);
  drop->modes = bw_retain(run->modes);
  drop->mode_count = run->motion.modes;
  drop->peak_element = -1;
  drop->impact = BW_NEW0(context, bw_drop_impact, run->options.impacts);
  BW_TRY_MEMORY(drop->impact);
  if (run->options.samples > 0) {
    drop->stress = BW_NEW0(context, double, model->mesh->element_count);
    drop->displacement = BW_NEW0(context, double, 3 * (int64_t)model->mesh->node_count);
    BW_TRY_MEMORY(drop->stress && drop->displacement);
    if (bw_material_strength(model->material, model->material->axes) > 0) {
      drop->utilisation = BW_NEW0(context, double, model->mesh->element_count);
      BW_TRY_MEMORY(drop->utilisation);
    }
  }
  *out = drop;
  drop = NULL;
done:
  bw_release(drop);
  return status;
}

bw_status bw_drop_misses(bw_context *context, const bw_model *model, int count,
                         const bw_drop_options *options, bool *misses) {
  bw_status status = BW_OK;
  bwi_drop_run run = {.model = model};
  int missed = 0;
  BW_TRY(check_model(context, model));
  BW_TRY(weigh(context, &run, NULL));
  for (int i = 0; i < count; i++) {
    run.options = options[i];
    BW_TRY(bw_check_cancel(context));
    bw_progress(context, "which drops miss", (double)i / count);
    BW_TRY(check_options(context, &run.options));
    status = bwi_drop_place(context, &run);
    misses[i] = status == BW_GEOMETRY;
    missed += misses[i];
    if (misses[i] && missed < count) {
      bw_clear_failure(context);
      status = BW_OK;
    }
    BW_TRY(status);
  }
  bw_progress(context, "which drops miss", 1);
done:
  return status;
}

/* The drop of a body that is weighed and placed, with the `count` lowest of its modes. */
static bw_status drop_with(bw_context *context, const bwi_drop_run *placed, int count,
                           bw_drop **out) {
  bw_status status = BW_OK;
  bwi_drop_run run = *placed;
  bw_drop *drop = NULL;
  BW_TRY(bwi_drop_motion_create(context, run.modes, count, &run.options.damping, &run.motion));
  BW_TRY(bwi_drop_points_create(context, &run));
  BW_TRY(make_result(context, &run, &drop));
  BW_TRY(begin(context, &run, drop));
  run.sampled = BW_NEW0(context, bwi_drop_sampled, run.options.impacts);
  BW_TRY_MEMORY(run.sampled);
  run.slack = 1e-10 * run.points.radius;
  run.margin = 2 * drop->speed * first_fraction / run.motion.omega[count - 1];
  BW_TRY(follow_drop(context, &run, drop));
  *out = drop;
  drop = NULL;
done:
  bw_release(drop);
  bwi_drop_motion_clear(&run.motion);
  bwi_drop_points_clear(&run.points);
  bwi_drop_sampled_clear(&run);
  return status;
}

bw_status bw_drop_of_model(bw_context *context, const bw_model *model, bw_system *given,
                           const bw_drop_options *options, bw_system **system, bw_drop **out) {
  bw_status status = BW_OK;
  bwi_drop_run run = {.model = model};
  bw_drop *drop = NULL;
  bw_modes *modes = NULL;
  if (options)
    run.options = *options;
  else
    bw_drop_options_default(&run.options);
  BW_TRY(check_options(context, &run.options));
  BW_TRY(check_model(context, model));
  BW_TRY(weigh(context, &run, given));
  BW_TRY(bwi_drop_place(context, &run));
  BW_TRY(check_memory(context, &run));
  BW_TRY(find_modes(context, &run, given, &run.system, &modes));
  run.modes = modes;
  BW_TRY(drop_with(context, &run, modes->count, &drop));
  if (run.options.fewer && modes->count > 1) {
    status = drop_with(context, &run, modes->count / 2, &drop->fewer);
    if (status != BW_OK && status != BW_CANCELLED && status != BW_MEMORY) {
      bw_clear_failure(context); /* the drop itself is found */
      status = BW_OK;
    }
    BW_TRY(status);
  }
  if (system)
    *system = bw_retain(run.system);
  *out = drop;
  drop = NULL;
done:
  bw_release(drop);
  bw_release(modes);
  bw_release(run.system);
  return status;
}
