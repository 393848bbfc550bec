/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest nonconstant modes of the scalar Laplacian with a free boundary, L u = lambda V u. Like
 * a free elastic body, with one motion per body: the constant. One node of each body is
 * constrained, and P = 1 - 1 1^T V / volume takes the constant off. */
#include <math.h>
#include <string.h>

#include "eigen/modes.h"

typedef struct laplacian {
  const bw_mesh *mesh;
  const bw_block_pattern *pattern;
  double *stiffness, *mass; /* 1 per block */
  double *weight;           /* node_count: integral of each shape function over its body's volume */
  double *sum;              /* component_count */
  bwi_factor *factor;
  bwi_symbolic *unconstrained;
} laplacian;

static bw_status laplacian_mass(bw_context *context, void *data, int64_t count, const double *x,
                                double *y) {
  laplacian *l = data;
  return bw_block_multiply(context, l->pattern, l->mass, 1, 1, count, x, y);
}

static bw_status laplacian_stiffness(bw_context *context, void *data, int64_t count,
                                     const double *x, double *y) {
  laplacian *l = data;
  return bw_block_multiply(context, l->pattern, l->stiffness, 1, 1, count, x, y);
}

/* u -= mean of u over each body (force false), f -= weight * sum of f (force true) */
static void remove_constant(laplacian *l, bool force, int64_t count, double *fields) {
  const bw_mesh *mesh = l->mesh;
  for (int64_t k = 0; k < count; k++) {
    double *field = fields + k * mesh->node_count;
    memset(l->sum, 0, (size_t)mesh->component_count * sizeof(double));
    for (int32_t i = 0; i < mesh->node_count; i++)
      l->sum[mesh->component[i]] += force ? field[i] : l->weight[i] * field[i];
    for (int32_t i = 0; i < mesh->node_count; i++)
      field[i] -= l->sum[mesh->component[i]] * (force ? l->weight[i] : 1);
  }
}

static bw_status laplacian_project(bw_context *context, void *data, int64_t count, double *x) {
  (void)context;
  remove_constant(data, false, count, x);
  return BW_OK;
}

static bw_status laplacian_solve(bw_context *context, void *data, int64_t count, const double *f,
                                 double *y) {
  laplacian *l = data;
  if (f != y)
    memcpy(y, f, (size_t)count * (size_t)l->mesh->node_count * sizeof(double));
  remove_constant(l, true, count, y);
  bw_status status = bwi_solve_fields(context, l->factor, NULL, count, y, y);
  if (status == BW_OK)
    remove_constant(l, false, count, y);
  return status;
}

static bw_status laplacian_below(bw_context *context, void *data, double sigma, int64_t *count,
                                 bool *trusted) {
  laplacian *l = data;
  bwi_matrix matrix = {
      .pattern = l->pattern, .stiffness = l->stiffness, .mass = l->mass, .shift = -sigma};
  int64_t negative = 0;
  bw_status status = bwi_count_negative(context, l->unconstrained, &matrix, &negative, trusted);
  if (status == BW_OK)
    *count = negative - l->mesh->component_count;
  return status;
}

static bw_status open_laplacian(bw_context *context, const bw_mesh *mesh,
                                const bw_block_pattern *pattern, laplacian *l) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  bwi_symbolic *constrained = NULL;
  int32_t nodes = mesh->node_count;
  int32_t *unknown = BW_NEW0(context, int32_t, nodes);
  *l = (laplacian){.mesh = mesh, .pattern = pattern};
  l->stiffness = BW_NEW(context, double, pattern->block_count);
  l->mass = BW_NEW(context, double, pattern->block_count);
  l->weight = BW_NEW(context, double, nodes);
  l->sum = BW_NEW0(context, double, mesh->component_count);
  BW_TRY_MEMORY(unknown && l->stiffness && l->mass && l->weight && l->sum);
  BW_TRY(bw_laplacian(context, pattern, mesh, l->stiffness));
  BW_TRY(bw_mass(context, pattern, mesh, NULL, l->mass));
  BW_TRY(bwi_order_create(context, pattern, NULL, &order));
  BW_TRY(bwi_symbolic_create(context, order, 1, unknown, &l->unconstrained));
  /* constrain the node that comes last in the order of each body */
  for (int32_t p = order->size - 1, found = 0; p >= 0 && found < mesh->component_count; p--) {
    int32_t body = mesh->component[order->node_at[p]];
    if (l->sum[body] == 0) {
      l->sum[body] = 1;
      unknown[order->node_at[p]] = -1;
      found++;
    }
  }
  BW_TRY(bwi_symbolic_create(context, order, 1, unknown, &constrained));
  bwi_matrix matrix = {.pattern = pattern, .stiffness = l->stiffness};
  BW_TRY(bwi_factor_create(context, constrained, &matrix, &l->factor, NULL));
  /* weights: V 1 over the volume of the body */
  double *ones = BW_NEW(context, double, nodes);
  BW_TRY_MEMORY(ones);
  for (int32_t i = 0; i < nodes; i++)
    ones[i] = 1;
  status = laplacian_mass(context, l, 1, ones, l->weight);
  bw_free(ones);
  if (status != BW_OK)
    goto done;
  memset(l->sum, 0, (size_t)mesh->component_count * sizeof(double));
  for (int32_t i = 0; i < nodes; i++)
    l->sum[mesh->component[i]] += l->weight[i];
  for (int32_t i = 0; i < nodes; i++)
    l->weight[i] /= l->sum[mesh->component[i]];
done:
  bw_free(unknown);
  bw_release(order);
  bw_release(constrained);
  return status;
}

bw_status bw_modes_laplacian(bw_context *context, const bw_mesh *mesh,
                             const bw_block_pattern *pattern, const bw_modes_options *given,
                             bw_modes **modes) {
  bw_status status = BW_OK;
  bwi_eigen_result result = {0};
  bw_modes_options options;
  laplacian l = {0};
  BW_TRY(bwi_modes_options_check(context, given, &options));
  BW_TRY(open_laplacian(context, mesh, pattern, &l));
  bwi_eigen_problem eigen = {.size = mesh->node_count,
                             .mesh = mesh,
                             .data = &l,
                             .solve = laplacian_solve,
                             .mass = laplacian_mass,
                             .stiffness = laplacian_stiffness,
                             .project = laplacian_project,
                             .below = laplacian_below,
                             .dimension = mesh->node_count - mesh->component_count};
  BW_TRY(bwi_eigen_lowest(context, &eigen, &options, &result));
  BW_TRY(bwi_modes_from(context, mesh, NULL, mesh->component_count, &result, modes));
done:
  bw_free(l.stiffness);
  bw_free(l.mass);
  bw_free(l.weight);
  bw_free(l.sum);
  bw_release(l.factor);
  bw_release(l.unconstrained);
  bwi_eigen_result_clear(&result);
  return status;
}
