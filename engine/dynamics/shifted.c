/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "dynamics/shifted.h"

#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "linear/pcg_space.h"

/* The components of the equations: isostatic constraints are for statics alone. */
enum { FREE = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC };

static bw_status open_joined(bw_context *context, bwi_shifted *s) {
  bw_status status = BW_OK;
  const bwi_joined_fields *e = &s->equations->joined;
  const bwi_joined_equations *q = &e->equations;
  s->size = q->reduction.unknown_count;
  s->diagonal = BW_NEW0(context, double, s->size);
  s->b = BW_NEW(context, double, s->size);
  s->x = BW_NEW(context, double, s->size);
  BW_TRY_MEMORY(s->diagonal && s->b && s->x);
  BW_TRY(bwi_joined_operator(context, q, e->mass, 1, "mass of the joined bodies", &s->mass));
  const bw_sparse_matrix *m = s->mass->matrix;
  for (int32_t i = 0; i < m->rows; i++)
    for (int64_t k = m->start[i]; k < m->start[i + 1]; k++)
      if (m->column[k] == i)
        s->diagonal[i] = m->value[k];
  BW_TRY(bwi_matrix_pair_open(context, q->k->matrix, m, &s->pair));
done:
  return status;
}

bw_status bwi_shifted_open(bw_context *context, const bwi_equations *e, bwi_shifted *s) {
  bw_status status = BW_OK;
  *s = (bwi_shifted){.equations = e};
  if (!e->system)
    return open_joined(context, s);
  s->size = e->size;
  s->diagonal = BW_NEW(context, double, s->size);
  BW_TRY_MEMORY(s->diagonal);
  for (int64_t i = 0; i < s->size; i++) /* the diagonal is the last block of a row */
    s->diagonal[i] = e->system->mass[e->pattern->start[i / 3 + 1] - 1];
done:
  return status;
}

void bwi_shifted_clear(bwi_shifted *s) {
  bw_release(s->symbolic);
  bw_free(s->diagonal);
  bw_release(s->mass);
  bwi_matrix_pair_clear(&s->pair);
  bw_free(s->b);
  bw_free(s->x);
  *s = (bwi_shifted){0};
}

size_t bwi_shifted_bytes(const bwi_shifted *s) {
  size_t bytes = 3 * (size_t)s->size * sizeof(double);
  if (s->mass)
    bytes += bw_bytes(s->mass) + bw_bytes(s->pair.pattern) +
             2 * (size_t)s->pair.pattern->block_count * sizeof(double);
  return bytes;
}

/* ---- K + s M --------------------------------------------------------------------------------- */

/* The elimination order of all factors: with the isostatic constraints of statics left out. */
static bw_status make_symbolic(bw_context *context, bwi_shifted *s) {
  bw_status status = BW_OK;
  const bw_system *system = s->equations->system;
  const bw_dof_map *dof_map = system->dof_map;
  bwi_symbolic *constrained = NULL;
  int32_t *unknown = NULL;
  BW_TRY(bwi_symbolic_for(context, system->pattern, dof_map, BW_ORDERING_AUTO, 0, NULL, NULL,
                          system->factor ? system->factor->symbolic : NULL, &constrained));
  if (dof_map->rigid_mode_count > 0) {
    unknown = BW_NEW(context, int32_t, s->size);
    BW_TRY_MEMORY(unknown);
    for (int64_t i = 0; i < s->size; i++)
      unknown[i] = dof_map->state[i] == BW_DOF_PRESCRIBED ? -1 : 0;
    BW_TRY(bwi_symbolic_create(context, constrained->order, 3, unknown, &s->symbolic));
  } else
    s->symbolic = bw_retain(constrained);
done:
  bw_free(unknown);
  bw_release(constrained);
  return status;
}

static bw_status factor_joined(bw_context *context, bwi_shifted *s, double shift,
                               bwi_factor **factor) {
  bw_status status = bwi_matrix_pair_factor(context, &s->pair, -shift, NULL,
                                            s->equations->joined.equations.k->name.text,
                                            "a coarser mesh needs less", s->symbolic, factor);
  if (status == BW_OK && !s->symbolic)
    s->symbolic = bw_retain((*factor)->symbolic);
  return status;
}

bw_status bwi_shifted_factor(bw_context *context, bwi_shifted *s, double shift,
                             bwi_factor **factor) {
  bw_status status = BW_OK;
  const bw_system *system = s->equations->system;
  int32_t bad_node = 0;
  if (!system)
    return factor_joined(context, s, shift, factor);
  const bwi_matrix matrix = {.pattern = system->pattern,
                             .stiffness = system->stiffness,
                             .mass = system->mass,
                             .shift = shift,
                             .dof_map = system->dof_map};
  bw_progress(context, "factorisation", 0);
  if (!s->symbolic)
    BW_TRY(make_symbolic(context, s));
  status = bwi_factor_create(context, s->symbolic, &matrix, factor, &bad_node);
  if (status == BW_SINGULAR)
    status = bwi_fail_singular(context, system->mesh, bad_node);
done:
  return status;
}

bw_status bwi_shifted_below(bw_context *context, bwi_shifted *s, double lambda, int64_t *count,
                            bool *trusted) {
  bw_status status = BW_OK;
  const bw_system *system = s->equations->system;
  bwi_factor *factor = NULL;
  bwi_matrix matrix = {.shift = -lambda};
  bw_progress(context, "counting modes", 0);
  if (system) {
    matrix.pattern = system->pattern;
    matrix.stiffness = system->stiffness;
    matrix.mass = system->mass;
    matrix.dof_map = system->dof_map;
    if (!s->symbolic)
      BW_TRY(make_symbolic(context, s));
  } else {
    matrix.pattern = s->pair.pattern;
    matrix.stiffness = s->pair.k;
    matrix.mass = s->pair.m;
    if (!s->symbolic) /* the elimination order comes with a factor */
      BW_TRY(factor_joined(context, s, lambda, &factor));
  }
  BW_TRY(bwi_count_negative(context, s->symbolic, &matrix, count, trusted));
done:
  bw_release(factor);
  return status;
}

bw_status bwi_shifted_solve(bw_context *context, const bwi_shifted *s, const bwi_factor *factor,
                            const double *f, double *u) {
  bw_status status = BW_OK;
  const bwi_equations *e = s->equations;
  const bwi_reduction *r = &e->joined.equations.reduction;
  if (e->system) {
    if (u != f)
      memcpy(u, f, (size_t)s->size * sizeof *u);
    bwi_keep_states(e->dof_map, FREE, u);
    return bwi_solve_fields(context, factor, e->dof_map, 1, u, u);
  }
  BW_TRY(bw_sparse_matrix_apply(context, r->transposed, 1, f, s->x));
  BW_TRY(bwi_solve_fields(context, factor, NULL, 1, s->x, s->x));
  BW_TRY(bw_sparse_matrix_apply(context, r->t, 1, s->x, u));
done:
  return status;
}

/* ---- M --------------------------------------------------------------------------------------- */

static bw_status keep_free(bw_context *context, void *data, int64_t count, double *x) {
  const bwi_shifted *s = data;
  (void)context;
  for (int64_t k = 0; s->equations->system && k < count; k++)
    bwi_keep_states(s->equations->dof_map, FREE, x + k * s->size);
  return BW_OK;
}

static bw_status multiply_mass(bw_context *context, void *data, int64_t count, const double *x,
                               double *y) {
  const bwi_shifted *s = data;
  const bw_system *system = s->equations->system;
  if (!system)
    return bw_sparse_matrix_apply(context, s->mass->matrix, count, x, y);
  bw_status status = bw_block_multiply(context, system->pattern, system->mass, 1, 3, count, x, y);
  return status == BW_OK ? keep_free(context, data, count, y) : status;
}

static bw_status by_diagonal(bw_context *context, void *data, int64_t count, const double *r,
                             double *z) {
  const bwi_shifted *s = data;
  (void)context;
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < s->size; i++)
      z[k * s->size + i] = r[k * s->size + i] / s->diagonal[i];
  return BW_OK;
}

/* By conjugate gradients with the diagonal: a mass matrix is well conditioned whatever the mesh,
 * but for the few motions in which a joint moves many nodes or a point with a mass. */
bw_status bwi_shifted_solve_mass(bw_context *context, const bwi_shifted *s, const double *f,
                                 double *u) {
  bw_status status = BW_OK;
  const bwi_equations *e = s->equations;
  const bwi_reduction *r = &e->joined.equations.reduction;
  void *data = (void *)s;
  const bwi_pcg_fields fields = {.size = s->size,
                                 .multiply = multiply_mass,
                                 .multiply_data = data,
                                 .precondition = by_diagonal,
                                 .precondition_data = data,
                                 .project = keep_free,
                                 .project_data = data,
                                 .symmetric = true};
  bwi_pcg_task task = {
      .columns = 1, .energy_tolerance = INFINITY, .residual_tolerance = 1e-13, .limit = 1000};
  if (!e->system)
    BW_TRY(bw_sparse_matrix_apply(context, r->transposed, 1, f, s->b));
  BW_TRY(bwi_pcg_fields_run(context, &fields, &task, e->system ? f : s->b, e->system ? u : s->x));
  if (!task.converged && !(task.residual < 1e-9))
    BW_TRY(bw_fail(context, BW_CONVERGENCE,
                   "the acceleration at the start was not found: the residual is %g after %d "
                   "iterations, which elements almost without volume cause. Mesh again",
                   task.residual, task.iterations));
  if (!e->system)
    BW_TRY(bw_sparse_matrix_apply(context, r->t, 1, s->x, u));
done:
  return status;
}
