/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear bodies in time by the generalised-alpha method (docs/theory/transient.md).
 *
 * With the known parts u* = u + h v + (1/2 - beta) h^2 a and v* = v + (1 - gamma) h a, the new
 * acceleration x of the unknowns solves A x = r with
 *
 *   A = (1 - alpha_m) M + (1 - alpha_f) (gamma h C + beta h^2 K),   C = c_m M + c_k K,
 *
 * which is a multiple of K + s M. Its factor serves all steps of one length. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "dynamics/transient_adapt.h"
#include "dynamics/transient_modes.h"
#include "linear/blas.h"
#include "statics/internal.h"

/* The components of the equations: isostatic constraints are for statics alone. */
enum { FREE = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, HELD = 1u << BW_DOF_PRESCRIBED };

/* Blocks of numbers, node_count x 3 each. */
enum {
  FORCE,
  NEXT_FORCE,
  DAMPING_V,
  NEXT_DAMPING_V,
  ELASTIC, /* K u of the state at hand or of the next one */
  ELASTIC_BEFORE,
  W_M,
  W_K,
  RIGHT,
  INERTIA,
  SUM_U, /* over all states */
  SUM_ELASTIC,
  BLOCKS
};

enum { KEPT = 6 }; /* factors, each of one length of step */

/* Of the start: what joints may not allow of it without a warning. */
static const double left_out_limit = 1e-2;

/* Of the relative error of the period: a step that leaves more is too large. */
static const double resolution_limit = 0.03;

enum { VALUE, VELOCITY, ACCELERATION, DERIVATIVES };

/* A history of supports: its factor and two derivatives in time, and what the supports exert times
 * their displacements of factor 1 (J). */
typedef struct support_motion {
  double of[DERIVATIVES], exerted;
} support_motion;

/* The state at the end of a step: that of the transient takes it over when all has succeeded. */
typedef struct state {
  double *u, *v, *a, *reaction;
  double kinetic, strain;
  support_motion *support; /* (motions) */
} state;

typedef struct kept_factor {
  double step;  /* (s) that it is of */
  int64_t used; /* the number of its last use */
  bwi_factor *factor;
} kept_factor;

typedef struct bwi_linear_transient {
  bwi_equations equations;
  bwi_shifted shifted;            /* of direct integration */
  kept_factor kept[KEPT];         /* of direct integration */
  bwi_factor *factor;             /* the one of the step at hand: borrowed */
  bwi_adaptive *adaptive;         /* or NULL: all steps have one length */
  struct bwi_modal_motion *modal; /* of modal superposition, or NULL */
  int64_t size;
  int loads, points, supports, motions;
  uint64_t revision;   /* of a joined model */
  double *load;        /* (N) a block for each load, then for each remote point */
  double **prescribed; /* (motions) the displacements (m) that follow each history, with what
                          follows them in a joined model, or NULL: all 0 */
  bool moves;          /* some are not 0 */
  double *block[BLOCKS];
  state next;
  support_motion *support, *predicted; /* (motions) now, and of the known parts of a step */
  double alpha_m, alpha_f, beta, gamma, mass_damping, stiffness_damping;
  double scale, shift;  /* of the step at hand: A = (K + shift M) / scale */
  int64_t uses;         /* of factors */
  double swing, change; /* (J) sums of u^T K u over the states, of d^T K d over the steps d of u */
  double rounding;      /* (J) of the sums */
} inner;

void bw_linear_transient_options_default(bw_linear_transient_options *options) {
  *options = (bw_linear_transient_options){.rho = 0.9};
}

static void transient_destroy(void *object) {
  bw_linear_transient *t = object;
  inner *s = t->inner;
  if (s) {
    for (int k = 0; k < KEPT; k++)
      bw_release(s->kept[k].factor);
    bwi_shifted_clear(&s->shifted);
    bwi_equations_clear(&s->equations);
    if (s->adaptive)
      bwi_adaptive_clear(s->adaptive);
    bw_free(s->adaptive);
    bwi_modal_motion_destroy(s->modal);
    bw_free(s->load);
    for (int m = 0; s->prescribed && m < s->motions; m++)
      bw_free(s->prescribed[m]);
    bw_free(s->prescribed);
    bw_free(s->support);
    bw_free(s->predicted);
    bw_free(s->next.support);
    for (int k = 0; k < BLOCKS; k++)
      bw_free(s->block[k]);
    bw_free(s->next.u);
    bw_free(s->next.v);
    bw_free(s->next.a);
    bw_free(s->next.reaction);
    bw_free(s);
  }
  bw_release(t->model);
  bw_free(t->displacement);
  bw_free(t->velocity);
  bw_free(t->acceleration);
  bw_free(t->reaction);
  bw_free(t);
}

static size_t transient_bytes(const void *object) {
  const bw_linear_transient *t = object;
  const inner *s = t->inner;
  size_t bytes =
      sizeof *t + sizeof *s + bw_bytes(s->equations.system) + bwi_shifted_bytes(&s->shifted) +
      (size_t)(s->size * (BLOCKS + 8 + s->motions + s->loads + s->points)) * sizeof(double);
  for (int k = 0; k < KEPT; k++)
    bytes += s->kept[k].factor ? bwi_factor_bytes(s->kept[k].factor) : 0;
  if (s->adaptive && s->adaptive->rigid)
    bytes += 6 * (size_t)s->size * sizeof(double);
  if (s->equations.joined.mass)
    bytes += 10 * (size_t)s->equations.pattern->block_count * sizeof(double);
  if (s->equations.joined.factor)
    bytes += bwi_factor_bytes(s->equations.joined.factor);
  return bytes + (s->modal ? bwi_modal_motion_bytes(s->modal) : 0);
}

static const bw_kind transient_kind = {"linear transient", transient_destroy, transient_bytes};

/* ---- what is asked for ----------------------------------------------------------------------- */

/* The history of a support, or behind the supports of a remote point. */
static int32_t motion_of(const bw_model *model, const bw_linear_transient_options *o, int k) {
  const int32_t *list = k < model->support_count ? o->support_motion : o->point_motion;
  return list ? list[k < model->support_count ? k : k - model->support_count] : 0;
}

static bw_status check_options(bw_context *context, const bw_model *model,
                               const bw_linear_transient_options *o) {
  const bw_damping *d = &o->damping;
  const double *field[2] = {o->displacement, o->velocity};
  static const char *const word[2] = {"displacement", "velocity"};
  if (!(o->step > 0) || !isfinite(o->step))
    return bw_fail(context, BW_INVALID, "a time step of %g s: above 0 expected", o->step);
  if (!(o->rho >= 0 && o->rho <= 1))
    return bw_fail(context, BW_INVALID,
                   "a spectral radius of %g at infinite frequency: 0 to 1 expected", o->rho);
  for (int k = 0; k < model->support_count + model->coupling_count; k++)
    if (motion_of(model, o, k) < 0 ||
        motion_of(model, o, k) >= model->support_count + model->coupling_count)
      return bw_fail(context, BW_INVALID,
                     "history %lld of supports: there are no more histories than %d supports and "
                     "remote points",
                     motion_of(model, o, k) + 1LL, model->support_count + model->coupling_count);
  if (!(o->error >= 0 && o->error < 1))
    return bw_fail(context, BW_INVALID,
                   "a tolerance of %g for the error of a step: 0 to below 1 expected", o->error);
  if (o->error > 0 && o->modes)
    return bw_fail(context, BW_UNSUPPORTED,
                   "steps that adapt are for direct integration: by modes a step is exact for "
                   "loads that are linear within it. Leave out the tolerance or the modes");
  if (!(d->mass >= 0) || !(d->stiffness >= 0) || !isfinite(d->mass + d->stiffness))
    return bw_fail(context, BW_INVALID,
                   "damping by %g 1/s of the mass and %g s of the stiffness: both 0 or more "
                   "expected",
                   d->mass, d->stiffness);
  if (o->modes && !(d->ratio >= 0 && d->ratio < 1))
    return bw_fail(context, BW_INVALID, "a damping ratio of %g: 0 to below 1 expected", d->ratio);
  if ((d->ratio != 0 && !o->modes) || d->loss != 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   d->loss != 0 ? "a loss factor is for harmonic motion: give damping by mass, "
                                  "stiffness or, with modes, a ratio"
                                : "a damping ratio needs modes: direct integration takes damping "
                                  "by mass and stiffness");
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++)
    if (!(bw_material_part(model->material, i)->density > 0))
      return bw_fail(context, BW_INVALID,
                     "material %s has no density, which motion needs: give one in kg/m3",
                     bw_material_part(model->material, i)->name);
  for (int k = 0; k < model->load_count; k++)
    if (model->load[k].kind == BW_LOAD_TEMPERATURE)
      return bw_fail(context, BW_UNSUPPORTED,
                     "load %d is a change of temperature, which motion in time does not take: "
                     "remove it from the model",
                     k + 1);
  for (int k = 0; k < 2; k++)
    for (int64_t i = 0; field[k] && i < 3 * (int64_t)model->mesh->node_count; i++)
      if (!isfinite(field[k][i]))
        return bw_fail(context, BW_INVALID,
                       "the %s at the start is not a finite number at node %lld", word[k],
                       (long long)(i / 3) + 1);
  return BW_OK;
}

/* What joins the model must not deform it without a load. */
static bw_status check_joints(bw_context *context, const bw_model *model) {
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  return bwi_model_refuse_preloads(context, model,
                                   "motion in time does not know: bond the section without one");
}

static bw_status check_factors(bw_context *context, const bw_linear_transient *t,
                               const bw_transient_factors *f) {
  const inner *s = t->inner;
  if (t->model->load_count != s->loads || t->model->support_count != s->supports ||
      (bw_model_joined(t->model) != !s->equations.system) ||
      (!s->equations.system && t->model->object.revision != s->revision))
    return bw_fail(
        context, BW_INVALID,
        "the model has other loads, supports or joints than at the start: begin a new transient");
  for (int m = 0; m < s->motions; m++) {
    const double *of = f->support ? f->support + DERIVATIVES * m : NULL;
    if ((of && !isfinite(of[VALUE] + of[VELOCITY] + of[ACCELERATION])) ||
        (f->support_missed && !isfinite(f->support_missed[m])))
      return bw_fail(context, BW_INVALID,
                     "the factor of the prescribed displacements is not finite at %g s", t->time);
  }
  for (int k = 0; k < s->loads; k++)
    if ((f->load && !isfinite(f->load[k])) || (f->load_missed && !isfinite(f->load_missed[k])))
      return bw_fail(context, BW_INVALID, "the factor of load %d is not finite at %g s", k + 1,
                     t->time);
  for (int k = 0; k < s->points; k++)
    if ((f->point && !isfinite(f->point[k])) || (f->point_missed && !isfinite(f->point_missed[k])))
      return bw_fail(context, BW_INVALID,
                     "the factor of the remote point of coupling %d is not finite at %g s", k + 1,
                     t->time);
  return BW_OK;
}

/* ---- what is made once ----------------------------------------------------------------------- */

static bool has_numbers(int64_t count, const double *x) {
  for (int64_t i = 0; i < count; i++)
    if (x[i] != 0)
      return true;
  return false;
}

/* Displacements that a model prescribes, as one of its histories. */
static bw_status keep_prescribed(bw_context *context, const bw_dof_map *dof_map, const double *g,
                                 int motion, inner *s) {
  double *field = BW_NEW(context, double, s->size);
  if (!field)
    return BW_MEMORY;
  if (g)
    memcpy(field, g, (size_t)s->size * sizeof *g);
  else
    bwi_prescribed_field(dof_map, field);
  if (has_numbers(s->size, field)) {
    s->prescribed[motion] = field;
    s->moves = true;
  } else
    bw_free(field);
  return BW_OK;
}

/* What follows one history: the model holds all else at 0. */
static bw_status make_prescribed(bw_context *context, const bw_model *model,
                                 const bw_linear_transient_options *o, int motion, inner *s) {
  bw_status status = BW_OK;
  bw_model one = *model;
  bw_dof_map *dof_map = NULL;
  bwi_reduction reduction = {0};
  bw_support *support = BW_NEW(context, bw_support, model->support_count);
  bw_coupling *coupling = BW_NEW(context, bw_coupling, model->coupling_count);
  BW_TRY_MEMORY(support && coupling);
  for (int k = 0; k < model->support_count; k++) {
    support[k] = model->support[k];
    if (motion_of(model, o, k) != motion) {
      memset(support[k].value, 0, sizeof support[k].value);
      support[k].field = NULL;
    }
  }
  for (int k = 0; k < model->coupling_count; k++) {
    coupling[k] = model->coupling[k];
    if (motion_of(model, o, model->support_count + k) != motion)
      memset(coupling[k].point.displacement, 0, sizeof coupling[k].point.displacement);
  }
  one.support = support;
  one.coupling = coupling;
  status = s->equations.system ? bw_dof_map_create(context, &one, &dof_map)
                               : bwi_reduction_open(context, &one, true, &reduction);
  if (status == BW_INVALID)
    bw_fail(context, BW_INVALID,
            "supports or remote points with different histories prescribe displacements of the "
            "same node along the same direction: let them follow one history, or let them hold "
            "different nodes or directions");
  if (status == BW_OK)
    status = keep_prescribed(context, dof_map, reduction.g, motion, s);
done:
  bwi_reduction_clear(&reduction);
  bw_release(dof_map);
  bw_free(support);
  bw_free(coupling);
  return status;
}

static bw_status make_system(bw_context *context, const bw_model *model, bw_system *given,
                             const bw_linear_transient_options *o, inner *s) {
  bw_status status = BW_OK;
  bool by_modes = o->modes != NULL;
  bw_dof_map *dof_map = NULL;
  bw_system *system = NULL;
  if (bw_model_joined(model))
    s->revision = model->object.revision;
  else {
    BW_TRY(bw_dof_map_create(context, model, &dof_map));
    BW_TRY(bwi_equations_system(context, model, dof_map, given, &system));
  }
  BW_TRY(by_modes ? bwi_equations_open(context, model, system, &s->equations)
                  : bwi_equations_begin(context, model, system, &s->equations));
  if (!by_modes)
    BW_TRY(bwi_shifted_open(context, &s->equations, &s->shifted));
  if (s->motions == 1)
    BW_TRY(keep_prescribed(context, dof_map, s->equations.joined.equations.reduction.g, 0, s));
  for (int m = 0; m < s->motions && s->motions > 1; m++)
    BW_TRY(make_prescribed(context, model, o, m, s));
done:
  bw_release(dof_map);
  bw_release(system);
  return status;
}

static bw_solver_report report_factor(const bwi_factor *factor) {
  return (bw_solver_report){.solver = bw_solver_word(BW_SOLVER_CHOLESKY),
                            .backend = factor->kernels->backend,
                            .preconditioner = "",
                            .flops = bwi_factor_flops(factor),
                            .bytes = (double)bwi_factor_bytes(factor)};
}

/* The factor of K + shift M in a place that is free or that was not used for the longest time. */
static bw_status make_factor(bw_context *context, bw_linear_transient *t, kept_factor *kept) {
  bw_status status = BW_OK;
  inner *s = t->inner;
  double start = bw_seconds();
  s->factor = NULL;
  bw_release(kept->factor);
  *kept = (kept_factor){.step = 0};
  BW_TRY(bwi_shifted_factor(context, &s->shifted, s->shift, &kept->factor));
  kept->step = t->step;
  t->factors++;
  double before = t->report.seconds;
  t->report = report_factor(kept->factor);
  t->report.seconds = before + bw_seconds() - start;
  if (s->adaptive)
    snprintf(t->report.reason, sizeof t->report.reason,
             "one factor for each length of step, %d of them kept", KEPT);
  else
    snprintf(t->report.reason, sizeof t->report.reason, "one factor serves all steps");
done:
  return status;
}

/* The factor of the step at hand, kept or made. */
static bw_status need_factor(bw_context *context, bw_linear_transient *t) {
  bw_status status = BW_OK;
  inner *s = t->inner;
  double h = t->step, m = 1 - s->alpha_m + (1 - s->alpha_f) * s->gamma * h * s->mass_damping;
  double k = (1 - s->alpha_f) * (s->beta * h * h + s->gamma * h * s->stiffness_damping);
  kept_factor *place = &s->kept[0];
  s->scale = 1 / k;
  s->shift = m / k;
  for (int i = 0; i < KEPT; i++) {
    if (s->kept[i].step == h) {
      place = &s->kept[i];
      break;
    }
    if (s->kept[i].used < place->used)
      place = &s->kept[i];
  }
  if (place->step != h)
    BW_TRY(make_factor(context, t, place));
  place->used = ++s->uses;
  s->factor = place->factor;
done:
  return status;
}

/* Loads one by one, that each may have its own factor. */
static bw_status make_loads(bw_context *context, const bw_model *model, inner *s) {
  bw_status status = BW_OK;
  s->load = BW_NEW0(context, double, s->size *(s->loads + s->points));
  BW_TRY_MEMORY(s->load);
  for (int k = 0; k < s->loads; k++) {
    bw_model one = *model;
    one.load = &model->load[k];
    one.load_count = 1;
    BW_TRY(bw_model_force_vector(context, &one, s->load + k * s->size));
    bwi_point_weights(&one, s->load + k * s->size);
  }
  for (int k = 0; k < s->points; k++)
    bwi_point_loads(&(bw_model){.coupling = &model->coupling[k], .coupling_count = 1},
                    s->load + (s->loads + k) * s->size);
done:
  return status;
}

/* ---- products -------------------------------------------------------------------------------- */

static bw_status by_mass(bw_context *context, const inner *s, const double *x, double *y) {
  return bwi_equations_mass(context, &s->equations, x, y);
}

static bw_status by_stiffness(bw_context *context, const inner *s, const double *x, double *y) {
  return bwi_equations_elastic(context, &s->equations, x, y);
}

/* `count` loads from number `first` on, with factors of their own (NULL: 1). */
static void add_blocks(const inner *s, int first, int count, const double *factor, double *force) {
  for (int k = 0; k < count; k++) {
    double own = factor ? factor[k] : 1;
    for (int64_t i = 0; i < s->size && own != 0; i++)
      force[i] += own * s->load[(first + k) * s->size + i];
  }
}

static void add_forces(const inner *s, const bw_transient_factors *f, double *force) {
  memset(force, 0, (size_t)s->size * sizeof *force);
  add_blocks(s, 0, s->loads, f->load, force);
  add_blocks(s, s->loads, s->points, f->point, force);
}

static void take_motions(const inner *s, const bw_transient_factors *f, support_motion *motion) {
  for (int m = 0; m < s->motions; m++)
    for (int d = 0; d < DERIVATIVES; d++)
      motion[m].of[d] = f->support ? f->support[DERIVATIVES * m + d] : d == VALUE;
}

/* x += factor times the displacements, velocities or accelerations of these motions. */
static void add_motions(const inner *s, const support_motion *motion, int derivative, double factor,
                        double *x) {
  for (int m = 0; m < s->motions; m++) {
    double own = factor * motion[m].of[derivative];
    for (int64_t i = 0; s->prescribed[m] && i < s->size && own != 0; i++)
      x[i] += own * s->prescribed[m][i];
  }
}

/* The part of x that supports prescribe becomes that of the next state instead of that of `before`
 * (NULL: 0). */
static void hold(const inner *s, int derivative, const support_motion *before, double *x) {
  if (s->equations.system)
    bwi_keep_states(s->equations.dof_map, FREE, x);
  else if (before)
    add_motions(s, before, derivative, -1, x);
  add_motions(s, s->next.support, derivative, 1, x);
}

/* ---- energy and reactions -------------------------------------------------------------------- */

/* Energies and reactions of a state; leaves K u, M a and C v in ELASTIC, INERTIA and
 * NEXT_DAMPING_V. */
static bw_status take_stock(bw_context *context, inner *s, const double *force, state *now) {
  bw_status status = BW_OK;
  double *elastic = s->block[ELASTIC], *inertia = s->block[INERTIA];
  double *damping = s->block[NEXT_DAMPING_V], *momentum = s->block[W_M];
  BW_TRY(by_stiffness(context, s, now->u, elastic));
  BW_TRY(by_mass(context, s, now->a, inertia));
  if (s->modal) {
    BW_TRY(by_mass(context, s, s->block[W_K], damping)); /* d of bwi_motion_fields */
  } else if (s->stiffness_damping > 0)
    BW_TRY(by_stiffness(context, s, now->v, damping));
  BW_TRY(by_mass(context, s, now->v, momentum));
  for (int64_t i = 0; i < s->size; i++) {
    if (!s->modal)
      damping[i] = (s->stiffness_damping > 0 ? s->stiffness_damping * damping[i] : 0) +
                   s->mass_damping * momentum[i];
    now->reaction[i] = inertia[i] + damping[i] + elastic[i] - force[i];
  }
  for (int m = 0; m < s->motions; m++)
    now->support[m].exerted =
        s->prescribed[m] ? bwi_dot(s->size, s->prescribed[m], now->reaction) : 0;
  if (s->equations.system)
    bwi_keep_states(s->equations.dof_map, HELD, now->reaction);
  else
    BW_TRY(bwi_joined_reactions(context, &s->equations.joined, now->reaction));
  now->strain = 0.5 * bwi_dot(s->size, now->u, elastic);
  now->kinetic = 0.5 * bwi_dot(s->size, now->v, momentum);
done:
  return status;
}

/* What the resolution of the motion is measured by. K u of a body that flies is rounding: its part
 * of u^T K u is below that of the diagonal times the precision. */
static void add_to_swing(bw_linear_transient *t) {
  inner *s = t->inner;
  const bw_block_pattern *pattern = s->equations.pattern;
  const double *u = t->displacement, *elastic = s->block[ELASTIC_BEFORE];
  double diagonal = 0;
  for (int64_t i = 0; i < s->size; i++) {
    const double *block = s->equations.stiffness + 9 * (pattern->start[i / 3 + 1] - 1);
    diagonal += u[i] * u[i] * block[4 * (i % 3)];
    s->block[SUM_U][i] += u[i];
    s->block[SUM_ELASTIC][i] += elastic[i];
  }
  s->swing += 2 * t->strain;
  s->rounding += 1e-14 * diagonal;
}

/* The transient takes over the next state, with the forces and the damping forces that go with it.
 */
static void advance(bw_linear_transient *t) {
  inner *s = t->inner;
  state *next = &s->next;
  double **pair[7][2] = {{&t->displacement, &next->u},
                         {&t->velocity, &next->v},
                         {&t->acceleration, &next->a},
                         {&t->reaction, &next->reaction},
                         {&s->block[FORCE], &s->block[NEXT_FORCE]},
                         {&s->block[DAMPING_V], &s->block[NEXT_DAMPING_V]},
                         {&s->block[ELASTIC_BEFORE], &s->block[ELASTIC]}};
  for (int k = 0; k < 7; k++) {
    double *held = *pair[k][0];
    *pair[k][0] = *pair[k][1];
    *pair[k][1] = held;
  }
  memcpy(s->support, next->support, (size_t)s->motions * sizeof *s->support);
  t->kinetic = next->kinetic;
  t->strain = next->strain;
  if (!s->modal)
    add_to_swing(t);
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* The field of the start that joints and supports allow, nearest to the given one in the mass, with
 * a warning where it is another one; without joints, the given one where no support holds it. */
static bw_status take_start(bw_context *context, inner *s, const double *given, int derivative,
                            const char *what, double *x) {
  bw_status status = BW_OK;
  double part = 0, *off = s->block[RIGHT];
  if (given && s->equations.system)
    memcpy(x, given, (size_t)s->size * sizeof *x);
  else if (given) {
    memcpy(off, given, (size_t)s->size * sizeof *off);
    add_motions(s, s->next.support, derivative, -1, off);
    bwi_keep_states(s->equations.dof_map, FREE, off);
    BW_TRY(by_mass(context, s, off, s->block[INERTIA]));
    BW_TRY(bwi_shifted_solve_mass(context, &s->shifted, s->block[INERTIA], x));
  }
  hold(s, derivative, NULL, x);
  if (given && !s->equations.system)
    BW_TRY(bwi_equations_left_out(context, &s->equations, given, x, &part));
  if (part > left_out_limit)
    bw_warn(context,
            "supports and joints do not allow %.3g %% of the %s at the start, in the norm of the "
            "mass: it is left out",
            100 * part, what);
done:
  return status;
}

static bw_status begin(bw_context *context, bw_linear_transient *t,
                       const bw_linear_transient_options *options, const bw_transient_factors *f) {
  bw_status status = BW_OK;
  inner *s = t->inner;
  state *next = &s->next;
  double *r = s->block[RIGHT], *x = s->block[W_K];
  take_motions(s, f, next->support);
  add_forces(s, f, s->block[NEXT_FORCE]);
  if (s->modal) {
    const bwi_motion_fields fields = {next->u, next->v, next->a, s->block[W_K]};
    BW_TRY(bwi_modal_motion_start(context, s->modal, &s->equations, options, f, &fields));
    bwi_modal_motion_accept(s->modal);
    BW_TRY(take_stock(context, s, s->block[NEXT_FORCE], next));
    advance(t);
    t->initial = t->kinetic + t->strain;
    goto done;
  }
  BW_TRY(take_start(context, s, options->displacement, VALUE, "displacement", next->u));
  BW_TRY(take_start(context, s, options->velocity, VELOCITY, "velocity", next->v));
  hold(s, ACCELERATION, NULL, next->a);
  BW_TRY(take_stock(context, s, s->block[NEXT_FORCE], next));
  for (int64_t i = 0; i < s->size; i++)
    r[i] = s->block[NEXT_FORCE][i] - s->block[ELASTIC][i] - s->block[INERTIA][i] -
           s->block[NEXT_DAMPING_V][i];
  BW_TRY(bwi_shifted_solve_mass(context, &s->shifted, r, x));
  for (int64_t i = 0; i < s->size; i++)
    next->a[i] += x[i];
  BW_TRY(take_stock(context, s, s->block[NEXT_FORCE], next));
  advance(t);
  t->initial = t->kinetic + t->strain;
done:
  return status;
}

static const bw_transient_factors all_one = {0};

bw_status bw_linear_transient_create(bw_context *context, const bw_model *model, bw_system *given,
                                     const bw_linear_transient_options *options,
                                     const bw_transient_factors *now,
                                     bw_linear_transient **transient) {
  bw_status status = BW_OK;
  bw_linear_transient *t = NULL;
  bool all = true;
  bwi_blas_enter();
  BW_TRY(check_options(context, model, options));
  if (bw_model_joined(model))
    BW_TRY(check_joints(context, model));
  t = BW_NEW0(context, bw_linear_transient, 1);
  BW_TRY_MEMORY(t);
  bw_object_init(t, &transient_kind);
  t->model = bw_retain(model);
  t->step = options->step;
  inner *s = t->inner = BW_NEW0(context, inner, 1);
  BW_TRY_MEMORY(s);
  s->size = 3 * (int64_t)model->mesh->node_count;
  s->loads = model->load_count;
  s->points = model->coupling_count;
  s->supports = model->support_count;
  s->motions = 1;
  for (int k = 0; k < s->supports + s->points; k++)
    if (motion_of(model, options, k) >= s->motions)
      s->motions = motion_of(model, options, k) + 1;
  double rho = options->rho;
  s->alpha_m = (2 * rho - 1) / (rho + 1);
  s->alpha_f = rho / (rho + 1);
  s->gamma = 0.5 - s->alpha_m + s->alpha_f;
  s->beta = 0.25 * (1 - s->alpha_m + s->alpha_f) * (1 - s->alpha_m + s->alpha_f);
  s->mass_damping = options->damping.mass;
  s->stiffness_damping = options->damping.stiffness;
  now = now ? now : &all_one;
  for (int k = 0; k < BLOCKS; k++)
    all = (s->block[k] = BW_NEW0(context, double, s->size)) && all;
  double **field[8] = {&t->displacement, &t->velocity, &t->acceleration, &t->reaction,
                       &s->next.u,       &s->next.v,   &s->next.a,       &s->next.reaction};
  for (int k = 0; k < 8; k++)
    all = (*field[k] = BW_NEW0(context, double, s->size)) && all;
  support_motion **motion[3] = {&s->support, &s->predicted, &s->next.support};
  for (int k = 0; k < 3; k++)
    all = (*motion[k] = BW_NEW0(context, support_motion, s->motions)) && all;
  s->prescribed = BW_NEW0(context, double *, s->motions);
  BW_TRY_MEMORY(all && s->prescribed);
  BW_TRY(make_system(context, model, given, options, s));
  BW_TRY(check_factors(context, t, now));
  BW_TRY(make_loads(context, model, s));
  if (options->modes) {
    BW_TRY(bwi_modal_motion_create(context, model, &s->equations, options, s->load,
                                   s->moves ? s->motions : 0, s->prescribed, &s->modal));
    if (s->equations.system)
      bwi_report_way(s->equations.system, BWI_BY_FACTOR, NULL, &t->report);
    else
      t->report = report_factor(s->equations.joined.factor);
    snprintf(t->report.reason, sizeof t->report.reason, "%d modes are superposed",
             options->modes->count);
  } else
    BW_TRY(need_factor(context, t));
  if (options->error > 0) {
    s->adaptive = BW_NEW0(context, bwi_adaptive, 1);
    BW_TRY_MEMORY(s->adaptive);
    bwi_adaptive_begin(s->adaptive, options->error, options->step);
    if (s->moves || s->equations.rigid_count > 0)
      BW_TRY(bwi_adaptive_leave_out_rigid(context, model->mesh, &s->equations, s->adaptive));
  }
  BW_TRY(begin(context, t, options, now));
  *transient = t;
  t = NULL;
done:
  bwi_blas_leave();
  bw_release(t);
  return status;
}

static double mix(double part, double before, double after) {
  return part * before + (1 - part) * after;
}

/* Displacement, velocity and acceleration of the next state by generalised-alpha. */
static bw_status integrate(bw_context *context, const bw_linear_transient *t) {
  bw_status status = BW_OK;
  inner *s = t->inner;
  double h = t->step, *force = s->block[FORCE], *next_force = s->block[NEXT_FORCE];
  double *w_m = s->block[W_M], *w_k = s->block[W_K], *r = s->block[RIGHT];
  double *u = s->next.u, *v = s->next.v, *a = s->next.a;
  for (int m = 0; m < s->motions; m++) {
    const double *of = s->support[m].of;
    double *to = s->predicted[m].of;
    to[VALUE] = of[VALUE] + h * (of[VELOCITY] + (0.5 - s->beta) * h * of[ACCELERATION]);
    to[VELOCITY] = of[VELOCITY] + (1 - s->gamma) * h * of[ACCELERATION];
  }
  for (int64_t i = 0; i < s->size; i++) {
    u[i] = t->displacement[i] + h * (t->velocity[i] + (0.5 - s->beta) * h * t->acceleration[i]);
    v[i] = t->velocity[i] + (1 - s->gamma) * h * t->acceleration[i];
    a[i] = 0;
  }
  hold(s, VALUE, s->predicted, u);
  hold(s, VELOCITY, s->predicted, v);
  hold(s, ACCELERATION, NULL, a);
  for (int64_t i = 0; i < s->size; i++) {
    double middle = mix(s->alpha_f, t->velocity[i], v[i]);
    w_m[i] = mix(s->alpha_m, t->acceleration[i], a[i]) + s->mass_damping * middle;
    w_k[i] = mix(s->alpha_f, t->displacement[i], u[i]) + s->stiffness_damping * middle;
  }
  BW_TRY(by_mass(context, s, w_m, s->block[INERTIA]));
  BW_TRY(by_stiffness(context, s, w_k, s->block[ELASTIC]));
  for (int64_t i = 0; i < s->size; i++)
    r[i] = s->scale *
           (mix(s->alpha_f, force[i], next_force[i]) - s->block[INERTIA][i] - s->block[ELASTIC][i]);
  BW_TRY(bwi_shifted_solve(context, &s->shifted, s->factor, r, r));
  for (int64_t i = 0; i < s->size; i++) {
    u[i] += s->beta * h * h * r[i];
    v[i] += s->gamma * h * r[i];
    a[i] += r[i];
  }
done:
  return status;
}

/* The error of the step that was computed, relative to the largest displacement, and the norms of
 * both. */
static bw_status estimate(bw_context *context, const bw_linear_transient *t,
                          const bw_transient_factors *f, double *error, double norm[3]) {
  inner *s = t->inner;
  double *change = s->block[RIGHT], *missed = s->block[W_M], moved = 0;
  double spread = sqrt(4 * s->beta) - 1; /* x of docs/theory/transient.md */
  memset(missed, 0, (size_t)s->size * sizeof *missed);
  if (f->load_missed)
    add_blocks(s, 0, s->loads, f->load_missed, missed);
  if (f->point_missed)
    add_blocks(s, s->loads, s->points, f->point_missed, missed);
  for (int64_t i = 0; i < s->size; i++)
    change[i] = s->next.a[i] - t->acceleration[i];
  for (int m = 0; f->support_missed && m < s->motions; m++) {
    double most = 0;
    for (int64_t i = 0; s->prescribed[m] && i < s->size; i++)
      most = fmax(most, fabs(s->prescribed[m][i]));
    moved += most * f->support_missed[m];
  }
  bwi_computed_step step = {.shifted = &s->shifted,
                            .factor = s->factor,
                            .shift = s->shift,
                            .constant = 1.0 / 12 + 0.375 * spread * spread,
                            .h = t->step,
                            .u = s->next.u,
                            .v = s->next.v,
                            .a = s->next.a,
                            .support_missed = moved,
                            .change = change,
                            .missed = missed,
                            .work = s->block[W_K]};
  return bwi_adaptive_estimate(context, s->adaptive, &step, error, norm);
}

bw_status bw_linear_transient_step(bw_context *context, bw_linear_transient *t,
                                   const bw_transient_factors *factors) {
  bw_status status = BW_OK;
  inner *s = t->inner;
  state *next = &s->next;
  bwi_adaptive *adaptive = s->adaptive;
  double work = 0, damped = 0, moved = 0, error = 0, norm[3];
  double *force = s->block[FORCE], *next_force = s->block[NEXT_FORCE];
  factors = factors ? factors : &all_one;
  bwi_blas_enter();
  BW_TRY(check_factors(context, t, factors));
  add_forces(s, factors, next_force);
  take_motions(s, factors, next->support);
  if (s->modal) {
    const bwi_motion_fields fields = {next->u, next->v, next->a, s->block[W_K]};
    bwi_modal_motion_step(s->modal, factors, &fields);
  } else {
    BW_TRY(need_factor(context, t));
    BW_TRY(integrate(context, t));
  }
  BW_TRY(take_stock(context, s, next_force, next));
  for (int64_t i = 0; i < s->size; i++) {
    double change = next->u[i] - t->displacement[i];
    work += 0.5 * (force[i] + next_force[i]) * change;
    damped += 0.5 * (s->block[DAMPING_V][i] + s->block[NEXT_DAMPING_V][i]) * change;
    moved += change * (s->block[ELASTIC][i] - s->block[ELASTIC_BEFORE][i]);
  }
  for (int m = 0; m < s->motions; m++)
    work += 0.5 * (s->support[m].exerted + next->support[m].exerted) *
            (next->support[m].of[VALUE] - s->support[m].of[VALUE]);
  if (!isfinite(next->kinetic + next->strain + work + damped))
    BW_TRY(bw_fail(
        context, BW_INVALID,
        "the motion at %g s has no finite energy: give a shorter step than %g s, or smaller "
        "loads",
        t->time + t->step, t->step));
  if (adaptive) {
    BW_TRY(estimate(context, t, factors, &error, norm));
    if (!bwi_adaptive_accepts(adaptive, error)) {
      t->rejected++;
      t->step = bwi_adaptive_step(adaptive);
      goto done;
    }
    if (error > adaptive->tolerance && t->coarse++ == 0)
      bw_warn(
          context,
          "the shortest step, %.3g s, has an error of %.2g at %.4g s, which is more than the %.2g "
          "asked for: a load or support changes in no time there. Give it a time to change, or a "
          "shorter base step",
          t->step, error, t->time + t->step, adaptive->tolerance);
  }
  advance(t);
  if (s->modal)
    bwi_modal_motion_accept(s->modal);
  s->change += moved;
  t->work += work;
  t->damped += damped;
  t->steps++;
  if (adaptive) {
    bwi_adaptive_accept(adaptive, error, norm);
    t->time = bwi_adaptive_time(adaptive);
    t->step = bwi_adaptive_step(adaptive);
    t->error = bwi_adaptive_total(adaptive);
  } else
    t->time = t->step * (double)t->steps;
  t->object.revision++;
done:
  bwi_blas_leave();
  return status;
}

bw_motion_resolution bw_linear_transient_resolution(bw_context *context,
                                                    const bw_linear_transient *t) {
  bw_motion_resolution r = {0, 0};
  const inner *s = t->inner;
  double mean = bwi_dot(s->size, s->block[SUM_U], s->block[SUM_ELASTIC]) / (double)(t->steps + 1);
  double swing = s->swing - mean, dissipation, angle, lag;
  if (s->modal || s->adaptive || !(swing > s->rounding) || !(s->change > 0))
    return r;
  angle = 2 * asin(fmin(0.5 * sqrt(s->change / swing), 1));
  /* beta = (1 + x)^2 / 4 with x = (1 - rho) / (1 + rho) */
  dissipation = sqrt(4 * s->beta) - 1;
  lag = 0.375 * dissipation * dissipation; /* the expansion in docs/theory/transient.md */
  r.steps = 2 * M_PI / angle;
  r.error = 2 * tan(0.5 * angle) / angle - 1 + lag * angle * angle;
  if (r.error > resolution_limit && (double)t->steps < r.steps) /* less than a period: a bound */
    return (bw_motion_resolution){0, 0};
  if (r.error > resolution_limit)
    bw_warn(context,
            "a step of %.3g s is too large for this motion: it has %.2g steps per period, and its "
            "periods are too long by %s%.2g %%. Take a step of %.2g s or less, for 1 %%",
            t->step, r.steps, r.error < 0.3 ? "about " : "more than ", 100 * fmin(r.error, 0.3),
            t->step * sqrt(0.01 / (1.0 / 12 + lag)) / (2 * tan(0.5 * angle)));
  return r;
}

bw_status bw_linear_transient_static(bw_context *context, const bw_linear_transient *t,
                                     bw_static **result) {
  bw_status status = BW_OK;
  const inner *s = t->inner;
  size_t bytes = (size_t)s->size * sizeof(double);
  bw_static *made = NULL;
  BW_TRY(bwi_static_new(context, t->model, &made));
  made->system = s->equations.system ? bw_retain(s->equations.system) : NULL;
  made->reaction = BW_NEW(context, double, s->size);
  BW_TRY_MEMORY(made->reaction);
  memcpy(made->displacement, t->displacement, bytes);
  memcpy(made->reaction, t->reaction, bytes);
  if (s->equations.system) {
    BW_TRY(by_stiffness(context, s, t->displacement, made->force));
    for (int64_t i = 0; i < s->size; i++)
      made->force[i] -= t->reaction[i];
  } else {
    BW_TRY(by_mass(context, s, t->acceleration, made->force));
    for (int64_t i = 0; i < s->size; i++)
      made->force[i] = s->block[FORCE][i] - made->force[i] - s->block[DAMPING_V][i];
  }
  made->energy = t->strain - bwi_spring_energy(t->model, t->displacement);
  made->report = t->report;
  *result = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}
