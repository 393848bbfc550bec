/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Newmark's method for sheets with base excitation.
 *
 * With u* = u + h v + (1/2 - beta) h^2 a and v* = v + (1 - gamma) h a, the new acceleration and
 * velocity are a = (u - u*) / (beta h^2) and v = v* + gamma h a, and the new displacement solves
 *
 *   (M / (beta h^2) + C gamma / (beta h) + K) u = f + M u* / (beta h^2)
 *                                                 + C (gamma / (beta h) u* - v*),
 *   C = am M + ak K.
 *
 * Where the ground moves, displacement, velocity and acceleration are those of the ground itself:
 * taken by Newmark's formulas they would swing about the truth undamped. The mass is consistent and
 * couples prescribed to free nodes, so these accelerations are part of the load. The matrix depends
 * on the mesh and the step only: while the drag rests, its factor is exact. */
#include <math.h>
#include <string.h>

#include "incremental/lagged_factor.h"
#include "linear/pcg_space.h"
#include "responsive/sheet.h"

void bw_newmark_default(bw_newmark *newmark) {
  *newmark = (bw_newmark){.step = 1e-3, .beta = 0.25, .gamma = 0.5};
}

/* out = M mass_of + K stiffness_of, in one pass over both. */
typedef struct products {
  const bw_plane_pattern *pattern;
  const double *mass, *stiffness, *mass_of, *stiffness_of;
  double *out;
} products;

static bw_status product_rows(void *data, int64_t begin, int64_t end, int worker) {
  const products *d = data;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double x = 0, y = 0;
    for (int64_t p = d->pattern->start[i]; p < d->pattern->start[i + 1]; p++) {
      int64_t j = d->pattern->column[p];
      const double *k = d->stiffness + 4 * p, *w = d->stiffness_of + 2 * j;
      double m = d->mass[p];
      x += m * d->mass_of[2 * j] + k[0] * w[0] + k[1] * w[1];
      y += m * d->mass_of[2 * j + 1] + k[2] * w[0] + k[3] * w[1];
    }
    d->out[2 * i] = x;
    d->out[2 * i + 1] = y;
  }
  return BW_OK;
}

static bw_status multiply(bw_context *context, const struct bwi_sheet *inner, const double *mass_of,
                          const double *stiffness_of, double *out) {
  products d = {inner->pattern, inner->mass, inner->stiffness, mass_of, stiffness_of, out};
  return bw_parallel(context, inner->pattern->node_count, BWI_GRAIN_NODES, product_rows, &d);
}

/* K (1 + k_of_k) + M m: the matrix of a step. */
typedef struct blend {
  const bw_plane_pattern *pattern;
  const double *mass, *stiffness;
  double of_mass, of_stiffness;
  double *out;
} blend;

static bw_status blend_rows(void *data, int64_t begin, int64_t end, int worker) {
  const blend *d = data;
  (void)worker;
  for (int64_t p = d->pattern->start[begin]; p < d->pattern->start[end]; p++) {
    const double *k = d->stiffness + 4 * p;
    double m = d->of_mass * d->mass[p];
    d->out[4 * p] = d->of_stiffness * k[0] + m;
    d->out[4 * p + 1] = d->of_stiffness * k[1];
    d->out[4 * p + 2] = d->of_stiffness * k[2];
    d->out[4 * p + 3] = d->of_stiffness * k[3] + m;
  }
  return BW_OK;
}

/* The ground at a time: displacement into inner->prescribed, velocity and acceleration by
 * differences over a step, of the order of the method: so that a recorded motion, a line between
 * its samples, has the acceleration that a step sees, and no spikes. Never asked for times below 0.
 * Rooms of 2 node_count. */
static bw_status ground(bw_context *context, bw_sheet *sheet, double time, double step,
                        double *velocity, double *acceleration, double *workspace) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  size_t size = 2 * (size_t)inner->pattern->node_count;
  bool moves = false;
  for (int32_t k = 0; k < inner->condition_count; k++)
    moves = moves || (inner->condition[k].kind == BW_PRESCRIBED && inner->condition[k].function);
  memset(velocity, 0, size * sizeof *velocity);
  memset(acceleration, 0, size * sizeof *acceleration);
  if (moves) {
    bool first = time < 0.5 * step; /* then ahead, in place of on both sides */
    BW_TRY(bwi_sheet_prescribe(context, sheet, first ? time + 2 * step : time - step));
    memcpy(workspace, inner->prescribed, size * sizeof *workspace);
    BW_TRY(bwi_sheet_prescribe(context, sheet, time + step));
    memcpy(velocity, inner->prescribed, size * sizeof *velocity);
    BW_TRY(bwi_sheet_prescribe(context, sheet, time));
    for (size_t i = 0; i < size; i++)
      if (inner->is_prescribed[i]) {
        double other = workspace[i], after = velocity[i], now = inner->prescribed[i];
        velocity[i] = (first ? 4 * after - 3 * now - other : after - other) / (2 * step);
        acceleration[i] =
            (first ? now - 2 * after + other : after - 2 * now + other) / (step * step);
      } else
        velocity[i] = 0;
  } else
    BW_TRY(bwi_sheet_prescribe(context, sheet, time));
done:
  return status;
}

typedef struct masses {
  const struct bwi_sheet *inner;
  const double *zero;
} masses;

static bw_status keep_free(bw_context *context, void *data, int64_t count, double *x) {
  const masses *m = data;
  (void)context;
  (void)count;
  for (int64_t i = 0; i < 2 * (int64_t)m->inner->pattern->node_count; i++)
    if (m->inner->is_prescribed[i])
      x[i] = 0;
  return BW_OK;
}

static bw_status multiply_mass(bw_context *context, void *data, int64_t count, const double *x,
                               double *y) {
  const masses *m = data;
  bw_status status = multiply(context, m->inner, x, m->zero, y);
  return status == BW_OK ? keep_free(context, data, count, y) : status;
}

static bw_status by_diagonal(bw_context *context, void *data, int64_t count, const double *r,
                             double *z) {
  const masses *m = data;
  const bw_plane_pattern *pattern = m->inner->pattern;
  (void)context;
  (void)count;
  for (int64_t i = 0; i < 2 * (int64_t)pattern->node_count; i++)
    z[i] = r[i] / m->inner->mass[pattern->diagonal[i / 2]];
  return BW_OK;
}

/* M a = f - C v - K u at free unknowns, by conjugate gradients with the diagonal: a mass matrix is
 * well conditioned whatever the mesh. `acceleration` comes as that of the ground. */
static bw_status first_acceleration(bw_context *context, bw_sheet *sheet, const bw_newmark *newmark,
                                    const double *velocity, const double *displacement,
                                    double *acceleration) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  size_t n = 2 * (size_t)inner->pattern->node_count;
  double *workspace = BW_NEW(context, double, 6 * n);
  double *rhs = workspace, *zero = workspace + n, *work = zero + n;
  if (!workspace)
    return BW_MEMORY;
  memset(zero, 0, n * sizeof *zero);
  for (size_t i = 0; i < n; i++) {
    work[i] = newmark->damping_mass * velocity[i];
    work[n + i] = newmark->damping_stiffness * velocity[i] + displacement[i];
  }
  BW_TRY(multiply(context, inner, work, work + n, rhs));
  for (size_t i = 0; i < n; i++)
    rhs[i] = inner->force[i] - rhs[i];
  masses m = {inner, zero};
  const bwi_pcg_fields fields = {.size = (int64_t)n,
                                 .multiply = multiply_mass,
                                 .multiply_data = &m,
                                 .precondition = by_diagonal,
                                 .precondition_data = &m,
                                 .project = keep_free,
                                 .project_data = &m,
                                 .symmetric = true,
                                 .guess = true,
                                 .work = work};
  bwi_pcg_task task = {.columns = 1,
                       .energy_tolerance = INFINITY,
                       .residual_tolerance = 1e-12,
                       .recurrence = true,
                       .limit = 500};
  BW_TRY(bwi_pcg_fields_run(context, &fields, &task, rhs, acceleration));
done:
  bw_free(workspace);
  return status;
}

static bw_status check(bw_context *context, const bw_newmark *newmark) {
  if (!(newmark->step > 0) || !isfinite(newmark->step))
    return bw_fail(context, BW_INVALID, "a time step of %g s: above 0 expected", newmark->step);
  if (!(newmark->gamma >= 0.5) || !(newmark->beta >= 0.5 * newmark->gamma))
    return bw_fail(
        context, BW_INVALID,
        "beta %g and gamma %g: 2 beta >= gamma >= 1/2 expected, which is stable for any time step",
        newmark->beta, newmark->gamma);
  if (!(newmark->damping_mass >= 0) || !(newmark->damping_stiffness >= 0) ||
      !isfinite(newmark->damping_mass + newmark->damping_stiffness))
    return bw_fail(context, BW_INVALID,
                   "damping coefficients %g 1/s and %g s: both 0 or more expected",
                   newmark->damping_mass, newmark->damping_stiffness);
  return BW_OK;
}

/* From rest where there was no motion yet: velocity and acceleration of `next`, which has the
 * fields of the sheet as it is. */
static bw_status begin(bw_context *context, bw_sheet *sheet, const bw_newmark *newmark,
                       double *workspace, bw_sheet_state *next) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  size_t size = 2 * (size_t)inner->pattern->node_count;
  double *velocity = workspace, *acceleration = workspace + size,
         *displacement = workspace + 2 * size;
  BW_TRY(bwi_sheet_force(context, sheet, sheet->time));
  BW_TRY(ground(context, sheet, sheet->time, newmark->step, velocity, acceleration, displacement));
  for (size_t i = 0; i < size; i++) {
    displacement[i] = inner->is_prescribed[i] ? inner->prescribed[i] : sheet->displacement[i];
    if (!inner->is_prescribed[i])
      velocity[i] = sheet->velocity ? sheet->velocity[i] : 0;
  }
  BW_TRY(first_acceleration(context, sheet, newmark, velocity, displacement, acceleration));
  if (!next->velocity)
    next->velocity = BW_NEW(context, double, size);
  if (!next->acceleration)
    next->acceleration = BW_NEW(context, double, size);
  BW_TRY_MEMORY(next->velocity && next->acceleration);
  memcpy(next->velocity, velocity, size * sizeof(double));
  memcpy(next->acceleration, acceleration, size * sizeof(double));
  memcpy(next->displacement, displacement, size * sizeof(double));
  next->moving = next->solved = true;
done:
  return status;
}

bw_status bw_sheet_transient(bw_context *context, bw_sheet *sheet, const bw_newmark *newmark,
                             const bw_lagged_factor_options *options, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  bw_newmark defaults;
  bw_sheet_state *next = NULL;
  bw_plane_reuse ignored = {0};
  double *workspace = NULL;
  bool made;
  bw_newmark_default(&defaults);
  newmark = newmark ? newmark : &defaults;
  reuse = bwi_reuse_of(reuse, &ignored);
  double start = bw_seconds();
  BW_TRY(check(context, newmark));
  BW_TRY(bwi_sheet_prepare(context, sheet, &made));
  reuse->pattern = !made;
  BW_TRY(bwi_sheet_next(context, sheet, sheet->mesh, true, &next));
  reuse->solution = next->solved;
  size_t size = 2 * (size_t)inner->pattern->node_count;
  BW_TRY(bwi_sheet_stiffness(context, sheet));
  BW_TRY(bwi_sheet_mass(context, sheet));
  workspace = BW_NEW(context, double, 4 * size);
  BW_TRY_MEMORY(workspace);
  if (!next->moving)
    BW_TRY(begin(context, sheet, newmark, workspace, next));

  double h = newmark->step, beta = newmark->beta, gamma = newmark->gamma;
  double am = newmark->damping_mass, ak = newmark->damping_stiffness;
  double by_mass = 1 / (beta * h * h), by_damping = gamma / (beta * h), time = sheet->time + h;
  double *u = workspace, *v = workspace + size, *a = v + size, *w = a + size;
  BW_TRY(bwi_sheet_force(context, sheet, time));
  BW_TRY(ground(context, sheet, time, h, v, a, w));
  /* What multiplies M, C and K in the load: at prescribed unknowns the ground's own, at free ones
     the part of Newmark's formulas that is known already. v and a take the latter over. */
  for (size_t i = 0; i < size; i++) {
    if (inner->is_prescribed[i]) {
      u[i] = inner->prescribed[i];
    } else {
      double before = next->displacement[i] + h * next->velocity[i] +
                      (0.5 - beta) * h * h * next->acceleration[i];
      a[i] = -by_mass * before;
      v[i] = next->velocity[i] + (1 - gamma) * h * next->acceleration[i] - by_damping * before;
      u[i] = 0;
    }
    w[i] = u[i] + ak * v[i];
    inner->work[i] = a[i] + am * v[i];
  }
  BW_TRY(multiply(context, inner, inner->work, w, inner->rhs));
  for (size_t i = 0; i < size; i++)
    inner->rhs[i] = inner->force[i] - inner->rhs[i];
  double step[4] = {h, beta, am * by_damping, ak * by_damping};
  if (memcmp(step, inner->matrix_step, sizeof step) != 0) {
    blend d = {inner->pattern,      inner->mass,  inner->stiffness, by_mass + am * by_damping,
               1 + ak * by_damping, inner->matrix};
    BW_TRY(bw_parallel(context, inner->pattern->node_count, BWI_GRAIN_NODES, blend_rows, &d));
    BW_TRY(bw_plane_prescribe(context, inner->pattern, 2, inner->is_prescribed, inner->prescribed,
                              inner->matrix, NULL));
    memcpy(inner->matrix_step, step, sizeof step);
  }
  for (size_t i = 0; i < size; i++)
    if (inner->is_prescribed[i]) {
      int64_t p = inner->pattern->diagonal[i / 2];
      inner->rhs[i] = inner->matrix[4 * p + (i % 2 ? 3 : 0)] * inner->prescribed[i];
      inner->work[i] = inner->prescribed[i];
    } else /* a first guess: the acceleration stays */
      inner->work[i] =
          next->displacement[i] + h * next->velocity[i] + 0.5 * h * h * next->acceleration[i];
  reuse->seconds_assemble += bw_seconds() - start;
  BW_TRY(bw_lagged_factor_solve(context, inner->lagged, inner->pattern, inner->matrix, inner->rhs,
                                inner->work, options, reuse));
  /* v and a hold what is known of the new ones */
  for (size_t i = 0; i < size; i++) {
    bool is_prescribed = inner->is_prescribed[i];
    next->acceleration[i] = is_prescribed ? a[i] : a[i] + by_mass * inner->work[i];
    next->velocity[i] = is_prescribed ? v[i] : v[i] + by_damping * inner->work[i];
    next->displacement[i] = inner->work[i];
  }
  next->time = time;
  next->solved = true;
  next->large = next->statics = false;
  bw_free(next->before); /* not of one load after another any more */
  bw_free(next->former);
  next->before = next->former = NULL;
  BW_TRY(bwi_sheet_commit(context, sheet, next));
done:
  bw_release(next);
  bw_free(workspace);
  return status;
}
