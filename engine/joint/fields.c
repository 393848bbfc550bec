/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products and solutions of joined models on fields of their nodes. */
#include "joint/fields.h"

#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "base/dense.h"

void bwi_joined_fields_clear(bwi_joined_fields *e) {
  bwi_joined_clear(&e->equations);
  bw_free(e->mass);
  bw_release(e->factor);
  bw_free(e->x);
  *e = (bwi_joined_fields){0};
}

bw_status bwi_joined_fields_open(bw_context *context, const bw_model *model, bwi_joined_fields *e) {
  bw_status status = BW_OK;
  bwi_joined_equations *q = &e->equations;
  *e = (bwi_joined_fields){.model = model};
  BW_TRY(bwi_joined_open(context, model, true, NULL, q));
  e->mass = BW_NEW(context, double, q->pattern->block_count);
  e->x = BW_NEW(context, double, q->reduction.unknown_count);
  BW_TRY_MEMORY(e->mass && e->x);
  BW_TRY(bw_mass(context, q->pattern, model->mesh, model->material, e->mass));
  bwi_add_attachments(model, q->pattern, 1, e->mass);
done:
  return status;
}

bw_status bwi_joined_factor(bw_context *context, bwi_joined_fields *e) {
  bw_status status = BW_OK;
  const bwi_joined_equations *q = &e->equations;
  bwi_matrix_pair pair = {0};
  if (q->rigid_count > 0)
    BW_TRY(bwi_joined_fail_free(context, q));
  BW_TRY(bwi_matrix_pair_open(context, q->k->matrix, NULL, &pair));
  BW_TRY(bwi_matrix_pair_factor(context, &pair, 0, NULL, q->k->name.text,
                                "a coarser mesh needs less", NULL, &e->factor));
done:
  bwi_matrix_pair_clear(&pair);
  return status;
}

/* ---- remote points --------------------------------------------------------------------------- */

static void find_motion(const bw_coupling *c, const double *u, double q[6]) {
  int64_t width = 3 * (int64_t)c->node_count;
  for (int k = 0; k < 6; k++) {
    q[k] = 0;
    for (int64_t i = 0; i < width; i++)
      q[k] += c->mean[k * width + i] * u[3 * (int64_t)c->node[i / 3] + i % 3];
  }
}

void bwi_point_motions(const bw_model *model, const double *u, double *q) {
  for (int p = 0; p < model->coupling_count; p++)
    find_motion(&model->coupling[p], u, q + 6 * (size_t)p);
}

void bwi_point_loads(const bw_model *model, double *f) {
  for (int i = 0; i < model->coupling_count; i++)
    bwi_point_exert(&model->coupling[i], 1, model->coupling[i].point.load, f);
}

void bwi_point_weights(const bw_model *model, double *f) {
  for (int i = 0; i < model->coupling_count; i++) {
    double weight[6] = {0};
    for (int l = 0; l < model->load_count; l++)
      for (int k = 0; k < 3 && model->load[l].kind == BW_LOAD_GRAVITY; k++)
        weight[k] += model->coupling[i].point.mass * model->load[l].vector[k];
    bwi_point_exert(&model->coupling[i], 1, weight, f);
  }
}

/* f += D^T S D u with the springs, or the masses, of remote points. */
static void add_points(const bw_model *model, bool springs, const double *u, double *f) {
  for (int i = 0; i < model->coupling_count; i++) {
    const bw_coupling *c = &model->coupling[i];
    double q[6], load[6] = {0};
    if (springs ? !bwi_point_has_springs(&c->point) : !bwi_point_has_mass(&c->point))
      continue;
    find_motion(c, u, q);
    for (int k = 0; k < 6; k++)
      load[k] = springs ? c->point.spring[k] * q[k] : k < 3 ? c->point.mass * q[k] : 0;
    for (int a = 0; a < 9 && !springs; a++)
      load[3 + a / 3] += c->point.inertia[a] * q[3 + a % 3];
    bwi_point_exert(c, 1, load, f);
  }
}

typedef struct spring_work {
  const double *u;
  double work;
} spring_work;

static void add_work(void *data, int32_t node, const double force[3]) {
  spring_work *s = data;
  s->work += bw_dot(force, s->u + 3 * (int64_t)node);
}

double bwi_spring_energy(const bw_model *model, const double *u) {
  const double none[3] = {0};
  spring_work s = {u, 0};
  for (int a = 0; a < model->attachment_count; a++)
    if (!(model->attachment[a].mass > 0))
      bwi_attachment_apply(&model->attachment[a], model->attachment[a].stiffness, u, none, add_work,
                           &s);
  for (int i = 0; i < model->coupling_count; i++) {
    double q[6];
    find_motion(&model->coupling[i], u, q);
    for (int k = 0; k < 6; k++)
      s.work += model->coupling[i].point.spring[k] * q[k] * q[k];
  }
  return 0.5 * s.work;
}

/* ---- products -------------------------------------------------------------------------------- */

bw_status bwi_joined_mass(bw_context *context, const bwi_joined_fields *e, const double *u,
                          double *f) {
  bw_status status = bw_block_multiply(context, e->equations.pattern, e->mass, 1, 3, 1, u, f);
  add_points(e->model, false, u, f);
  return status;
}

bw_status bwi_joined_multiply(bw_context *context, const bw_model *model,
                              const bwi_joined_equations *q, const double *u, double *f) {
  bw_status status = bw_block_multiply(context, q->pattern, q->stiffness, 9, 3, 1, u, f);
  add_points(model, true, u, f);
  return status;
}

bw_status bwi_joined_stiffness(bw_context *context, const bwi_joined_fields *e, const double *u,
                               double *f) {
  return bwi_joined_multiply(context, e->model, &e->equations, u, f);
}

bw_status bwi_joined_solve(bw_context *context, const bwi_joined_fields *e, const double *f,
                           double *u) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &e->equations.reduction;
  BW_TRY(bw_sparse_matrix_apply(context, r->transposed, 1, f, e->x));
  BW_TRY(bwi_solve_fields(context, e->factor, NULL, 1, e->x, e->x));
  BW_TRY(bw_sparse_matrix_apply(context, r->t, 1, e->x, u));
done:
  return status;
}

bw_status bwi_joined_reactions(bw_context *context, const bwi_joined_fields *e, double *force) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &e->equations.reduction;
  BW_TRY(bwi_points_react(context, r, force));
  bwi_reduction_move(r, force);
  for (int p = 0; p < r->point_count; p++) /* what a rigid face takes is its point's */
    for (int32_t i = 0; i < r->coupling[p].node_count; i++)
      if (r->coupling[p].point.kind == BW_RIGID)
        memset(force + 3 * (int64_t)r->coupling[p].node[i], 0, 3 * sizeof *force);
  bwi_keep_states(r->dof_map, 1u << BW_DOF_PRESCRIBED, force);
done:
  return status;
}

bw_status bwi_joined_largest(bw_context *context, const bwi_joined_fields *e, const double *f,
                             double *largest) {
  const bwi_reduction *r = &e->equations.reduction;
  bw_status status = bw_sparse_matrix_apply(context, r->transposed, 1, f, e->x);
  *largest = 0;
  for (int32_t i = 0; status == BW_OK && i < r->unknown_count; i++)
    *largest = fmax(*largest, fabs(e->x[i]));
  return status;
}
