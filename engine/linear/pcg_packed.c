/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients on packed fields (pcg_packed.h). */
#include "linear/pcg_packed.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum { SIDES = BWI_SMOOTHER_SIDES, ROWS = BWI_SMOOTHER_ROWS };

typedef struct packing {
  bw_context *context;
  const bwi_packed *m;
  int used;
  bool zero; /* u is */
  const double *force;
  double *displacement;
  double unit[SIDES]; /* the force of each was taken times it */
  double alpha[SIDES], beta[SIDES];
  const bool *wanted;
  double *chunk_sum; /* by chunk of rows: 2 x SIDES sums */
  double sum[2 * SIDES];
} packing;

static bw_status parallel_sums(packing *s, bw_body *body) {
  bw_status status = BW_OK;
  int64_t chunks = (s->m->smoother->count + ROWS - 1) / ROWS;
  BW_TRY(bw_parallel(s->context, s->m->smoother->count, ROWS, body, s));
  for (int i = 0; i < 2 * SIDES; i++) {
    s->sum[i] = 0;
    for (int64_t c = 0; c < chunks; c++)
      s->sum[i] += s->chunk_sum[2 * SIDES * c + i];
  }
done:
  return status;
}

static double *clear_sum(const packing *s, int64_t begin) {
  double *sum = s->chunk_sum + 2 * SIDES * (begin / ROWS);
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  return sum;
}

static void keep_unknowns(const bwi_packed *m, double *field) {
  int width = m->width;
  for (int32_t h = 0; h < m->constrained_count; h++) {
    double *x = field + 3 * (int64_t)width * m->constrained[h];
    for (int f = 0; f < width; f++) {
      double value[3] = {x[f], x[width + f], x[2 * width + f]};
      bwi_project_unknowns(m->dof_map, m->smoother->node[m->constrained[h]], value, value);
      for (int d = 0; d < 3; d++)
        x[d * width + f] = value[d];
    }
  }
}

/* Without what there is of rigid-body modes in a field. */
static bw_status remove_modes(const packing *s, double *field) {
  const bwi_field_layout layout = {3 * (int64_t)s->m->width, s->m->width, 1};
  return bwi_rigid_space_project(s->context, s->m->rigid, &layout, s->used, field);
}

/* ---- the operations -------------------------------------------------------------------------- */

/* r = f in the columns wanted */
static bw_status pack_force(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  int width = m->width;
  int64_t size = 3 * (int64_t)m->smoother->count;
  for (int64_t k = begin; k < end; k++) {
    const double *force = s->force + 3 * (int64_t)m->smoother->node[k];
    double *r = m->r + 3 * width * k;
    for (int f = 0; f < width; f++)
      for (int d = 0; d < 3; d++)
        if (f >= s->used)
          r[d * width + f] = 0;
        else if (s->wanted[f])
          r[d * width + f] = s->unit[f] * force[f * size + d];
  }
  return BW_OK;
}

/* r -= K u in the columns wanted */
static bw_status subtract_product(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  int width = m->width;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < s->used; f++)
      if (s->wanted[f])
        m->r[i * width + f] -= m->ku[i * width + f];
  return BW_OK;
}

/* The floats of r, and r . r */
static bw_status measure(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  double *sum = clear_sum(s, begin);
  int width = m->width;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      double r = m->r[i * width + f];
      m->floats[i * width + f] = (float)r;
      sum[f] += r * r;
    }
  return BW_OK;
}

static bw_status residual(bw_context *context, void *data, const bool *wanted, double *r_dot_r) {
  bw_status status = BW_OK;
  packing *s = data;
  const bwi_packed *m = s->m;
  s->wanted = wanted;
  BW_TRY(bw_parallel(context, m->smoother->count, ROWS, pack_force, s));
  if (!s->zero) {
    BW_TRY(bwi_smoother_product(context, m->smoother, m->width, m->u, m->ku, NULL));
    BW_TRY(bw_parallel(context, m->smoother->count, ROWS, subtract_product, s));
  }
  keep_unknowns(m, m->r);
  if (m->rigid)
    BW_TRY(remove_modes(s, m->r));
  BW_TRY(parallel_sums(s, measure));
  memcpy(r_dot_r, s->sum, (size_t)s->used * sizeof *r_dot_r);
done:
  return status;
}

/* r . z and z . q */
static bw_status dot_z(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  double *sum = clear_sum(s, begin);
  int width = m->width;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      double z = (double)m->z[at];
      sum[f] += m->r[at] * z;
      sum[SIDES + f] += z * m->q[at];
    }
  return BW_OK;
}

static bw_status precondition(bw_context *context, void *data, double *r_dot_z, double *z_dot_q) {
  bw_status status = BW_OK;
  packing *s = data;
  BW_TRY(s->m->precondition(context, s->m->data, s->m->width, s->used));
  BW_TRY(parallel_sums(s, dot_z));
  memcpy(r_dot_z, s->sum, (size_t)s->used * sizeof *r_dot_z);
  if (z_dot_q)
    memcpy(z_dot_q, s->sum + SIDES, (size_t)s->used * sizeof *z_dot_q);
done:
  return status;
}

/* p = z + beta p */
static bw_status update_direction(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  int width = m->width;
  double beta[SIDES];
  memcpy(beta, s->beta, sizeof beta);
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      m->p[at] = (double)m->z[at] + beta[f] * m->p[at];
    }
  return BW_OK;
}

/* Directions are projected onto the unknowns, since the floats of z leave a remainder along
 * constrained directions, and off the rigid-body modes, which K does not see but its rounding does.
 */
static bw_status multiply(bw_context *context, void *data, const double *beta, double *p_dot_q) {
  bw_status status = BW_OK;
  packing *s = data;
  const bwi_packed *m = s->m;
  double energy[SIDES];
  memcpy(s->beta, beta, (size_t)s->used * sizeof *beta);
  BW_TRY(bw_parallel(context, m->smoother->count, ROWS, update_direction, s));
  keep_unknowns(m, m->p);
  if (m->rigid)
    BW_TRY(remove_modes(s, m->p));
  BW_TRY(bwi_smoother_product(context, m->smoother, m->width, m->p, m->q, energy));
  keep_unknowns(m, m->q);
  memcpy(p_dot_q, energy, (size_t)s->used * sizeof *p_dot_q);
done:
  return status;
}

/* u += alpha p, r -= alpha q; r . r */
static bw_status take_step(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  double *sum = clear_sum(s, begin), alpha[SIDES];
  int width = m->width;
  memcpy(alpha, s->alpha, sizeof alpha);
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      m->u[at] += alpha[f] * m->p[at];
      double r = m->r[at] - alpha[f] * m->q[at];
      m->r[at] = r;
      m->floats[at] = (float)r;
      sum[f] += r * r;
    }
  return BW_OK;
}

static bw_status advance(bw_context *context, void *data, const double *alpha, double *r_dot_r) {
  bw_status status = BW_OK;
  packing *s = data;
  (void)context;
  s->zero = false;
  memcpy(s->alpha, alpha, (size_t)s->used * sizeof *alpha);
  BW_TRY(parallel_sums(s, take_step));
  if (s->m->rigid) { /* rounding of q leaves modes in r, which make the next alpha too large */
    BW_TRY(remove_modes(s, s->m->r));
    BW_TRY(parallel_sums(s, measure));
  }
  memcpy(r_dot_r, s->sum, (size_t)s->used * sizeof *r_dot_r);
done:
  return status;
}

/* As bwi_residual_noise has it. */
static double noise(void *data, int f) {
  const packing *s = data;
  const bwi_packed *m = s->m;
  static const int six[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  double sum = 0;
  for (int64_t k = 0; k < m->smoother->count; k++)
    for (int d = 0; d < 3; d++) {
      double term = 0;
      for (int c = 0; c < 3; c++)
        term += fabs(m->smoother->diagonal[6 * k + six[c][d]] * m->u[(3 * k + c) * m->width + f]);
      sum += term * term;
    }
  return BWI_RESIDUAL_NOISE * DBL_EPSILON * sqrt(sum);
}

/* ---- from fields and back -------------------------------------------------------------------- */

static bw_status store_solution(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *s = data;
  const bwi_packed *m = s->m;
  int64_t size = 3 * (int64_t)m->smoother->count;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int f = 0; f < s->used; f++)
        s->displacement[f * size + 3 * (int64_t)m->smoother->node[k] + d] =
            m->u[(3 * k + d) * m->width + f] * (m->smoother->unit / s->unit[f]);
  return BW_OK;
}

/* Powers of two that bring loads near 1, and what tolerances are relative to times these: energies
 * in equations taken times units go with their square over the matrix'. */
static bw_status choose_units(packing *s, const bwi_pcg_task *given, double *load, double *energy) {
  bw_status status = BW_OK;
  bool all[SIDES];
  for (int f = 0; f < s->used; f++) {
    all[f] = true;
    s->unit[f] = 1;
  }
  s->wanted = all;
  BW_TRY(bw_parallel(s->context, s->m->smoother->count, ROWS, pack_force, s));
  keep_unknowns(s->m, s->m->r);
  BW_TRY(parallel_sums(s, measure));
  for (int f = 0; f < s->used; f++) {
    int exponent = 0;
    if (s->sum[f] > 0 && isfinite(s->sum[f]))
      frexp(sqrt(s->sum[f]), &exponent);
    s->unit[f] = ldexp(1, -exponent);
    if (given->load)
      load[f] = s->unit[f] * given->load[f];
    if (given->energy)
      energy[f] = given->energy[f] * s->unit[f] * s->unit[f] / s->m->smoother->unit;
  }
done:
  return status;
}

/* Those of task->columns fields. */
static bw_status solve_columns(bw_context *context, const bwi_packed *m, bwi_pcg_task *task,
                               const double *force, double *displacement) {
  bw_status status = BW_OK;
  size_t numbers = 3 * (size_t)m->smoother->count * (size_t)m->width;
  double load[SIDES], energy[SIDES];
  packing s = {.context = context,
               .m = m,
               .used = task->columns,
               .zero = true,
               .force = force,
               .displacement = displacement};
  const bwi_pcg_space space = {.data = &s,
                               .residual = residual,
                               .precondition = precondition,
                               .multiply = multiply,
                               .advance = advance,
                               .noise = noise};
  bwi_pcg_task scaled = *task;
  assert(task->columns <= m->width && m->width <= SIDES);
  s.chunk_sum = BW_NEW(context, double, 2 * SIDES * (m->smoother->count / ROWS + 1));
  if (!s.chunk_sum)
    return BW_MEMORY;
  BW_TRY(choose_units(&s, task, load, energy));
  scaled.load = task->load ? load : NULL;
  scaled.energy = task->energy ? energy : NULL;
  memset(m->u, 0, numbers * sizeof *m->u);
  memset(m->p, 0, numbers * sizeof *m->p);
  memset(m->q, 0, numbers * sizeof *m->q);
  BW_TRY(bwi_pcg_run(context, &space, &scaled));
  BW_TRY(bw_parallel(context, m->smoother->count, ROWS, store_solution, &s));
  scaled.load = task->load;
  scaled.energy = task->energy;
  *task = scaled;
done:
  bw_free(s.chunk_sum);
  return status;
}

bw_status bwi_packed_solve(bw_context *context, bwi_packed *m, bwi_pcg_task *task, int64_t count,
                           const double *force, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)m->smoother->count;
  const bwi_pcg_task given = *task;
  int most = 0;
  task->iterations = 0;
  task->converged = true;
  task->residual = 0;
  for (int64_t first = 0; first < count && task->converged; first += m->width) {
    *task = given;
    m->left = count - first;
    m->width = bwi_smoother_width(m->left); /* no more than before */
    task->columns = m->left < m->width ? (int)m->left : m->width;
    task->load = given.load ? given.load + first : NULL;
    task->energy = given.energy ? given.energy + first : NULL;
    BW_TRY(solve_columns(context, m, task, force + first * size, displacement + first * size));
    most = task->iterations > most ? task->iterations : most;
  }
  task->iterations = most;
done:
  return status;
}
