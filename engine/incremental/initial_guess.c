/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where an iteration begins: at the combination of given fields (solutions of nearby shapes,
 * mostly) that is nearest to the solution in energy. With V the fields and g = V c, V^T K V c = V^T
 * f,     g . K g = g . f,     |u - g|_K minimal, for every right-hand side by itself, all from the
 * same K V.
 *
 * Solutions of shapes that hardly differ are nearly parallel. Fields are taken in turn, by a
 * Cholesky factorisation of V^T K V with V scaled to energy 1 that leaves out whatever is, to
 * rounding, a combination of those before it. The residual is that of the combination as it is, so
 * that what was lost there makes a worse start and no error. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"
#include "linear/multivector.h"

/* The smallest fraction of a field's energy that is not rounding once those before it are taken
 * out. */
#define INDEPENDENT 1e-11

/* Cholesky of the n x n matrix `a` (column-major, unit diagonal) in place, rows of fields left out
 * marked by a zero diagonal. */
static void factor(int n, double *a) {
  for (int j = 0; j < n; j++) {
    double *column = a + (size_t)j * (size_t)n;
    for (int k = 0; k < j; k++) {
      const double *before = a + (size_t)k * (size_t)n;
      if (before[k] > 0)
        for (int i = j; i < n; i++)
          column[i] -= before[i] * before[j];
    }
    if (!(column[j] > INDEPENDENT)) {
      memset(column + j, 0, (size_t)(n - j) * sizeof *column);
      continue;
    }
    double root = sqrt(column[j]);
    for (int i = j; i < n; i++)
      column[i] /= root;
  }
}

static void substitute(int n, const double *l, double *b) {
  for (int j = 0; j < n; j++) {
    const double *column = l + (size_t)j * (size_t)n;
    b[j] = column[j] > 0 ? b[j] / column[j] : 0;
    for (int i = j + 1; i < n; i++)
      b[i] -= column[i] * b[j];
  }
  for (int j = n - 1; j >= 0; j--) {
    const double *column = l + (size_t)j * (size_t)n;
    for (int i = j + 1; i < n; i++)
      b[j] -= column[i] * b[i];
    b[j] = column[j] > 0 ? b[j] / column[j] : 0;
  }
}

/* For every right-hand side the combination, what it leaves of the force, and its energy. */
static bw_status combine(bw_context *context, const bw_system *system, int fields,
                         const double *const *field, int64_t count, const double *force,
                         double *solution, double *residual, double *energy) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = system->dof_map;
  const unsigned free = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  size_t n = (size_t)fields, length = (size_t)size;
  double *v = BW_NEW(context, double, n *length);
  double *kv = BW_NEW(context, double, n *length);
  double *gram = BW_NEW(context, double, n *n);
  double *weight = BW_NEW(context, double, n *(size_t)count);
  double *scale = BW_NEW(context, double, n);
  BW_TRY_MEMORY(v && kv && gram && weight && scale);
  for (size_t k = 0; k < n; k++) {
    double sum = 0;
    memcpy(v + k * length, field[k], length * sizeof *v);
    bwi_keep_states(dof_map, free, v + k * length);
    for (size_t i = 0; i < length; i++)
      sum += fabs(v[k * length + i]);
    if (!isfinite(sum))
      memset(v + k * length, 0, length * sizeof *v);
  }
  BW_TRY(bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, fields, v, kv));
  for (size_t k = 0; k < n; k++)
    bwi_keep_states(dof_map, free, kv + k * length);
  BW_TRY(bwi_multi_dot(context, size, fields, v, fields, kv, gram));
  BW_TRY(bwi_multi_dot(context, size, fields, v, (int)count, force, weight));
  for (size_t k = 0; k < n; k++) {
    double norm = sqrt(gram[k * n + k]);
    scale[k] = norm > 0 && isfinite(1 / norm) ? 1 / norm : 0;
  }
  for (size_t k = 0; k < n; k++)
    for (size_t i = 0; i < n; i++)
      gram[k * n + i] = scale[k] * scale[i] > 0 ? gram[k * n + i] * scale[k] * scale[i] : 0;
  factor(fields, gram);
  for (int64_t side = 0; side < count; side++) {
    double *w = weight + (size_t)side * n;
    for (size_t k = 0; k < n; k++)
      w[k] = scale[k] > 0 ? w[k] * scale[k] : 0;
    substitute(fields, gram, w);
    for (size_t k = 0; k < n; k++)
      w[k] *= scale[k];
  }
  memcpy(residual, force, (size_t)count * length * sizeof *residual);
  BW_TRY(bwi_multi_combine(context, size, fields, v, (int)count, weight, fields, 1, 0, solution));
  BW_TRY(bwi_multi_combine(context, size, fields, kv, (int)count, weight, fields, -1, 1, residual));
  for (int64_t side = 0; side < count; side++) {
    const double *f = force + side * size, *g = solution + side * size;
    energy[side] = 0;
    for (int64_t i = 0; i < size; i++)
      energy[side] += f[i] * g[i];
  }
done:
  bw_free(v);
  bw_free(kv);
  bw_free(gram);
  bw_free(weight);
  bw_free(scale);
  return status;
}

void bwi_initial_guess_clear(bwi_initial_guess *left) {
  bw_free(left->guess);
  bw_free(left->force);
  bw_free(left->load);
  bw_free(left->energy);
}

/* |a| over the unknowns; `work` has room for a field */
static double norm(const bw_dof_map *dof_map, const double *a, double *work) {
  double sum = 0;
  size_t size = 3 * (size_t)dof_map->mesh->node_count;
  memcpy(work, a, size * sizeof *work);
  bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, work);
  for (size_t i = 0; i < size; i++)
    sum += work[i] * work[i];
  return sqrt(sum);
}

bw_status bwi_initial_guess_make(bw_context *context, const bw_incremental_system *incremental,
                                 const bw_incremental_options *options, int64_t count,
                                 const double *force, bwi_initial_guess *left) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = incremental->system->dof_map;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  double *work = NULL;
  left->tolerance = options->tolerance;
  if (options->guess_count <= 0)
    return BW_OK;
  left->guess = BW_NEW(context, double, count *size);
  left->force = BW_NEW(context, double, count *size);
  left->load = BW_NEW(context, double, count);
  left->energy = BW_NEW(context, double, count);
  work = BW_NEW(context, double, size);
  BW_TRY_MEMORY(left->guess && left->force && left->load && left->energy && work);
  BW_TRY(combine(context, incremental->system, options->guess_count, options->guess, count, force,
                 left->guess, left->force, left->energy));
  double max = 0;
  for (int64_t k = 0; k < count; k++) {
    left->load[k] = norm(dof_map, force + k * size, work);
    if (left->load[k] > 0)
      max = fmax(max, norm(dof_map, left->force + k * size, work) / left->load[k]);
  }
  if (options->energy)
    max = fmin(max, 1); /* it is the best combination in energy, 0 among them */
  left->tolerance = max > 2 * options->tolerance ? fmin(options->tolerance / max, 0.5) : 0.5;
done:
  bw_free(work);
  return status;
}
