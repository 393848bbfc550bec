/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The stiffness by the load of the levers of remote points (docs/theory/joints.md). A point that
 * turns by theta moves a node at r from it by theta x r + theta x (theta x r) / 2. The forces g of
 * the point on the nodes do the work
 *
 *     1/2 sum g . (theta x (theta x r)) = 1/2 theta^T (sym B - tr B 1) theta,   B = sum g r^T. */
#include <math.h>
#include <string.h>

#include "joint/internal.h"

/* Of force and moment, what counts as rounding. */
static const double rounding = 1e-9;

/* B of the nodes of a coupling, with the forces `force` (node_count x 3 of the mesh). */
static void take_nodes(const bw_mesh *mesh, const bw_coupling *c, const double *force,
                       double b[9]) {
  for (int32_t i = 0; i < c->node_count; i++) {
    const double *x = mesh->node + 3 * (int64_t)c->node[i];
    const double *g = force + 3 * (int64_t)c->node[i];
    for (int k = 0; k < 9; k++)
      b[k] += g[k / 3] * (x[k % 3] - c->point.at[k % 3]);
  }
}

/* A distributed coupling: its forces are D^T load, and leave `force`. `own`: 0 at its nodes, before
 * and after. */
static void take_mean(const bw_mesh *mesh, const bw_coupling *c, const double load[6],
                      double *force, double *own, double b[9]) {
  bwi_point_exert(c, 1, load, own);
  take_nodes(mesh, c, own, b);
  bwi_point_exert(c, -1, load, force);
  for (int32_t i = 0; i < c->node_count; i++)
    memset(own + 3 * (int64_t)c->node[i], 0, 3 * sizeof *own);
}

/* A moment that keeps its direction, or turns with the point, has no symmetric stiffness where the
 * point can turn about two axes across it. */
static bw_status check_moment(bw_context *context, const bw_coupling *c,
                              const bw_coupling_result *of, int p, double size) {
  for (int k = 0; k < 3; k++) {
    double moment = c->point.load[3 + k] + of->reaction[3 + k];
    if (c->point.fixed[3 + (k + 1) % 3] || c->point.fixed[3 + (k + 2) % 3] ||
        !(fabs(moment) > 1e3 * rounding * size))
      continue;
    bw_fail(context, BW_UNSUPPORTED,
            "the remote point of coupling %d has a moment of %g N m about %c, and can turn about "
            "both axes across it: the stiffness by such a load is not symmetric, and load factors "
            "do not know it; load the point by forces on levers, or prescribe one of the rotations",
            p + 1, moment, "xyz"[k]);
    bw_detail_number(context, "coupling", p + 1.0);
    return BW_UNSUPPORTED;
  }
  return BW_OK;
}

bw_status bwi_levers_add(bw_context *context, const bw_static *solution,
                         const bwi_joined_equations *q, bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  const bw_model *model = solution->model;
  const bw_mesh *mesh = model->mesh;
  int points = model->coupling_count;
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *force = NULL, *own = NULL, *b = NULL;
  if (points == 0)
    return BW_OK;
  if (solution->coupling_count != points)
    return bw_fail(context, BW_UNSUPPORTED,
                   "load factors need what remote points exert, which a state of a motion does not "
                   "have: take a static solution");
  force = BW_NEW(context, double, size);
  b = BW_NEW0(context, double, 9 * (int64_t)points);
  own = BW_NEW0(context, double, size);
  BW_TRY_MEMORY(force && own && b);
  BW_TRY(
      bw_block_multiply(context, q->pattern, q->stiffness, 9, 3, 1, solution->displacement, force));
  for (int64_t i = 0; i < size; i++)
    force[i] -= solution->force[i];
  for (int p = 0; p < points; p++)
    if (model->coupling[p].point.kind == BW_DISTRIBUTED)
      take_mean(mesh, &model->coupling[p], solution->coupling[p].load, force, own,
                b + 9 * (size_t)p);
  bwi_reduction_move(&q->reduction, force);
  for (int p = 0; p < points; p++) {
    const bw_coupling *c = &model->coupling[p];
    const double *load = solution->coupling[p].load;
    double s[6][6] = {{0}}, *sum = b + 9 * (size_t)p, trace, largest = 0;
    double moment = bw_norm(load) * c->reach + bw_norm(load + 3);
    if (c->point.kind == BW_RIGID)
      take_nodes(mesh, c, force, sum);
    BW_TRY(check_moment(context, c, &solution->coupling[p], p, moment));
    trace = sum[0] + sum[4] + sum[8];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        s[3 + i][3 + j] = 0.5 * (sum[3 * i + j] + sum[3 * j + i]) - (i == j ? trace : 0);
        largest = fmax(largest, fabs(s[3 + i][3 + j]));
      }
    if (largest > rounding * moment)
      BW_TRY(bwi_points_add_one(context, &q->reduction, p, s, matrix));
  }
done:
  bw_free(force);
  bw_free(own);
  bw_free(b);
  return status;
}
