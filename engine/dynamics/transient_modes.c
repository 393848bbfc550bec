/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Modal superposition (docs/theory/transient.md). Coordinates q of the modes and of rigid-body
 * motions follow q'' + c q' + w^2 q = p with p linear within a step: exact, whatever the step. */
#include "dynamics/transient_modes.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"

/* Of the start: what modes may leave out of it without a warning. */
static const double left_out_limit = 1e-2;

typedef struct bwi_modal_motion {
  int64_t size;
  int count;        /* vectors of the basis */
  int given, loads; /* loads of the model; with those of remote points */
  int motions;      /* histories of supports that move, or 0 */
  double *basis;    /* count x size, of M-norm 1 */
  double *square;   /* (count) w^2, 0 of rigid-body motions */
  double *damping;  /* (count) c = 2 zeta w + a + b w^2 */
  double *part;     /* (loads + motions) x count: of each load, and of each acceleration of 1 */
  double *residual; /* loads x size: the static displacement less what the basis has of it */
  double *support;  /* motions x size: static displacement by the supports, or NULL */
  double mass_damping;
  double *transition; /* count x 8: q and h q' after a step by q, h q', h^2 p, h^2 (p1 - p) */
  double step;
  double *q, *rate, *p;                /* (count) now */
  double *next_q, *next_rate, *next_p; /* (count) after a step */
} motion;

void bwi_modal_motion_destroy(motion *m) {
  if (!m)
    return;
  double *all[] = {m->basis,   m->square,     m->damping, m->part, m->residual,
                   m->support, m->transition, m->q,       m->rate, m->p,
                   m->next_q,  m->next_rate,  m->next_p};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    bw_free(all[i]);
  bw_free(m);
}

size_t bwi_modal_motion_bytes(const motion *m) {
  return sizeof *m + sizeof(double) * (size_t)(m->size * (m->count + m->loads + m->motions));
}

static void add(int64_t size, double factor, const double *x, double *y) {
  for (int64_t i = 0; i < size && factor != 0; i++)
    y[i] += factor * x[i];
}

/* ---- the basis ------------------------------------------------------------------------------- */

/* Rigid-body motions, made M-orthonormal, and behind them the modes. */
static bw_status make_basis(bw_context *context, const bwi_equations *e, const bw_modes *modes,
                            int rigid, double *work, motion *m) {
  bw_status status = BW_OK;
  double *one = BW_NEW0(context, double, rigid);
  BW_TRY_MEMORY(one);
  for (int k = 0; k < rigid; k++) {
    double *r = m->basis + k * m->size;
    memset(one, 0, (size_t)rigid * sizeof *one);
    one[k] = 1;
    bw_rigid_modes_add(e->dof_map, one, r);
    for (int j = 0; j <= k; j++) {
      BW_TRY(bwi_equations_mass(context, e, r, work));
      if (j < k)
        add(m->size, -bwi_dot(m->size, m->basis + j * m->size, work), m->basis + j * m->size, r);
    }
    double scale = 1 / sqrt(bwi_dot(m->size, r, work));
    for (int64_t i = 0; i < m->size; i++)
      r[i] *= scale;
  }
  memcpy(m->basis + rigid * m->size, modes->shape,
         (size_t)(m->size * modes->count) * sizeof(double));
  memcpy(m->square + rigid, modes->eigenvalue, (size_t)modes->count * sizeof(double));
done:
  bw_free(one);
  return status;
}

/* ---- the recurrence -------------------------------------------------------------------------- */

static void multiply4(const double *a, const double *b, double *c) {
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      double sum = 0;
      for (int k = 0; k < 4; k++)
        sum += a[4 * i + k] * b[4 * k + j];
      c[4 * i + j] = sum;
    }
}

/* The first two rows of exp(A) for (q w, q' h, p h^2, (p1 - p) h^2) with times in steps and w the
 * larger one of w h and 1, by scaling and squaring: any damping, and rigid-body motions too. */
static void make_transition(double square, double damping, double h, double out[8]) {
  double wh = sqrt(square) * h, w = fmax(wh, 1), norm = fmax(w, damping * h) + 1;
  double a[16] = {0, w, 0, 0, -wh * wh / w, -damping * h, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0};
  double term[16], next[16], sum[16];
  int halvings = (int)fmax(0, ceil(log2(norm)) + 3);
  for (int i = 0; i < 16; i++) {
    a[i] = ldexp(a[i], -halvings);
    sum[i] = term[i] = i % 5 == 0;
  }
  for (int n = 1; n < 16; n++) {
    multiply4(term, a, next);
    for (int i = 0; i < 16; i++)
      sum[i] += term[i] = next[i] / n;
  }
  for (int k = 0; k < halvings; k++) {
    multiply4(sum, sum, next);
    memcpy(sum, next, sizeof sum);
  }
  for (int j = 0; j < 4; j++) { /* back to q itself */
    out[j] = sum[j] / (j == 0 ? 1 : w);
    out[4 + j] = sum[4 + j] * (j == 0 ? w : 1);
  }
}

/* ---- creation -------------------------------------------------------------------------------- */

static bw_status make_loads(bw_context *context, const bwi_equations *e, const double *load,
                            double *const *prescribed, double *work, motion *m) {
  bw_status status = BW_OK;
  for (int l = 0; l < m->loads; l++) {
    const double *f = load + l * m->size;
    double *u = m->residual + l * m->size, *part = m->part + (int64_t)l * m->count;
    BW_TRY(bwi_equations_solve(context, e, f, u));
    for (int k = 0; k < m->count; k++) {
      part[k] = bwi_dot(m->size, m->basis + k * m->size, f);
      if (m->square[k] > 0)
        add(m->size, -part[k] / m->square[k], m->basis + k * m->size, u);
    }
  }
  for (int j = 0; j < m->motions; j++) {
    double *part = m->part + (int64_t)(m->loads + j) * m->count, *u = m->support + j * m->size;
    if (!prescribed[j])
      continue;
    BW_TRY(bwi_equations_elastic(context, e, prescribed[j], work));
    for (int64_t i = 0; i < m->size; i++)
      work[i] = -work[i];
    BW_TRY(bwi_equations_solve(context, e, work, u));
    add(m->size, 1, prescribed[j], u);
    BW_TRY(bwi_equations_mass(context, e, u, work));
    for (int k = 0; k < m->count; k++)
      part[k] = -bwi_dot(m->size, m->basis + k * m->size, work);
  }
done:
  return status;
}

bw_status bwi_modal_motion_create(bw_context *context, const bw_model *model,
                                  const bwi_equations *e,
                                  const bw_linear_transient_options *options, const double *load,
                                  int motions, double *const *prescribed, motion **out) {
  bw_status status = BW_OK;
  const bw_modes *modes = options->modes;
  const bw_damping *d = &options->damping;
  double *work = NULL;
  motion *m = NULL;
  int rigid = e->rigid_count;
  if (motions > 0 && (rigid > 0 || d->stiffness > 0))
    return bw_fail(
        context, BW_UNSUPPORTED,
        "modes of supports that move need a body that is held and damping without a part "
        "of the stiffness: integrate directly, without modes");
  m = BW_NEW0(context, motion, 1);
  BW_TRY_MEMORY(m);
  m->size = 3 * (int64_t)model->mesh->node_count;
  m->count = rigid + modes->count;
  m->given = model->load_count;
  m->loads = m->given + model->coupling_count;
  m->motions = motions;
  m->mass_damping = d->mass;
  m->step = options->step;
  work = BW_NEW(context, double, 3 * m->size);
  m->basis = BW_NEW0(context, double, m->size * m->count);
  m->residual = BW_NEW(context, double, m->size * m->loads);
  m->part = BW_NEW0(context, double, (int64_t)m->count *(m->loads + m->motions));
  m->transition = BW_NEW(context, double, 8 * (int64_t)m->count);
  if (motions > 0)
    m->support = BW_NEW0(context, double, m->size * m->motions);
  double **numbers[] = {&m->square, &m->damping, &m->q,         &m->rate,
                        &m->p,      &m->next_q,  &m->next_rate, &m->next_p};
  bool all = work && m->basis && m->residual && m->part && m->transition;
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    all = (*numbers[i] = BW_NEW0(context, double, m->count)) && all;
  BW_TRY_MEMORY(all && (m->support || motions == 0));
  BW_TRY(bwi_equations_check_modes(context, model, e, modes));
  BW_TRY(make_basis(context, e, modes, rigid, work, m));
  for (int k = 0; k < m->count; k++) {
    m->damping[k] = 2 * d->ratio * sqrt(m->square[k]) + d->mass + d->stiffness * m->square[k];
    make_transition(m->square[k], m->damping[k], m->step, m->transition + 8 * (int64_t)k);
  }
  BW_TRY(make_loads(context, e, load, prescribed, work, m));
  *out = m;
  m = NULL;
done:
  bwi_modal_motion_destroy(m);
  bw_free(work);
  return status;
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* Derivative 0 to 2 in time of a history of supports. */
static double support_factor(const bw_transient_factors *f, int history, int derivative) {
  return f->support ? f->support[3 * history + derivative] : derivative == 0;
}

static void add_supports(const motion *m, const bw_transient_factors *f, int derivative,
                         double factor, double *x) {
  for (int j = 0; j < m->motions; j++)
    add(m->size, factor * support_factor(f, j, derivative), m->support + j * m->size, x);
}

static void modal_forces(motion *m, const bw_transient_factors *f) {
  const double *support = m->part + (int64_t)m->loads * m->count;
  for (int k = 0; k < m->count; k++) {
    double p = 0;
    for (int j = 0; j < m->motions; j++)
      p += (support_factor(f, j, 2) + m->mass_damping * support_factor(f, j, 1)) *
           support[(int64_t)j * m->count + k];
    for (int l = 0; l < m->loads; l++)
      p += bwi_load_factor(f, m->given, l) * m->part[(int64_t)l * m->count + k];
    m->next_p[k] = p;
  }
}

/* The fields of the next coordinates: u also has the static part of the loads that the basis leaves
 * out, which follows them at once. */
static void expand(const motion *m, const bw_transient_factors *f, const bwi_motion_fields *out) {
  double *field[4] = {out->u, out->v, out->a, out->d};
  for (int i = 0; i < 4; i++)
    memset(field[i], 0, (size_t)m->size * sizeof(double));
  for (int k = 0; k < m->count; k++) {
    const double *shape = m->basis + k * m->size;
    double q = m->next_q[k], v = m->next_rate[k], d = m->damping[k] * v;
    add(m->size, q, shape, out->u);
    add(m->size, v, shape, out->v);
    add(m->size, m->next_p[k] - d - m->square[k] * q, shape, out->a);
    add(m->size, d, shape, out->d);
  }
  for (int l = 0; l < m->loads; l++)
    add(m->size, bwi_load_factor(f, m->given, l), m->residual + l * m->size, out->u);
  add_supports(m, f, 0, 1, out->u);
  add_supports(m, f, 1, 1, out->v);
  add_supports(m, f, 2, 1, out->a);
  add_supports(m, f, 1, m->mass_damping, out->d);
}

/* A warning where the start is not what was given. */
static bw_status compare_start(bw_context *context, const bwi_equations *e, const double *given,
                               const double *taken, const char *what) {
  double part = 0;
  bw_status status = given ? bwi_equations_left_out(context, e, given, taken, &part) : BW_OK;
  if (status == BW_OK && part > left_out_limit)
    bw_warn(context,
            "the modes and the static part of the loads leave out %.3g %% of the %s at the start, "
            "in the norm of the mass: take more modes, or integrate directly",
            100 * part, what);
  return status;
}

bw_status bwi_modal_motion_start(bw_context *context, motion *m, const bwi_equations *e,
                                 const bw_linear_transient_options *options,
                                 const bw_transient_factors *f, const bwi_motion_fields *out) {
  bw_status status = BW_OK;
  double *relative = out->u, *product = out->a;
  for (int which = 0; which < 2; which++) {
    const double *given = which ? options->velocity : options->displacement;
    double *to = which ? m->next_rate : m->next_q;
    for (int64_t i = 0; i < m->size; i++)
      relative[i] = given ? given[i] : 0;
    add_supports(m, f, which, -1, relative);
    BW_TRY(bwi_equations_mass(context, e, relative, product));
    for (int k = 0; k < m->count; k++)
      to[k] = bwi_dot(m->size, m->basis + k * m->size, product);
  }
  modal_forces(m, f);
  expand(m, f, out);
  BW_TRY(compare_start(context, e, options->displacement, out->u, "displacement"));
  BW_TRY(compare_start(context, e, options->velocity, out->v, "velocity"));
done:
  return status;
}

void bwi_modal_motion_step(motion *m, const bw_transient_factors *f, const bwi_motion_fields *out) {
  double h = m->step;
  modal_forces(m, f);
  for (int k = 0; k < m->count; k++) {
    const double *t = m->transition + 8 * (int64_t)k;
    double x[4] = {m->q[k], h * m->rate[k], h * h * m->p[k], h * h * (m->next_p[k] - m->p[k])};
    m->next_q[k] = t[0] * x[0] + t[1] * x[1] + t[2] * x[2] + t[3] * x[3];
    m->next_rate[k] = (t[4] * x[0] + t[5] * x[1] + t[6] * x[2] + t[7] * x[3]) / h;
  }
  expand(m, f, out);
}

void bwi_modal_motion_accept(motion *m) {
  double **pair[3][2] = {{&m->q, &m->next_q}, {&m->rate, &m->next_rate}, {&m->p, &m->next_p}};
  for (int k = 0; k < 3; k++) {
    double *held = *pair[k][0];
    *pair[k][0] = *pair[k][1];
    *pair[k][1] = held;
  }
}
