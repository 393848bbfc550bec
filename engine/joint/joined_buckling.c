/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Load factors of joined models: T^T (K + lambda K_sigma) T x = 0. Springs and bonds carry no
 * stress of their own, and masses only load. The lever of a remote point has a stiffness by its
 * load (levers.c). */
#include "barwright/job.h"
#include "buckling/internal.h"
#include "joint/internal.h"
#include "linear/blas.h"
#include "linear/matrix_factor.h"

typedef struct pencil {
  bwi_joined_equations equations;
  bw_operator *stress; /* T^T K_sigma T */
  bwi_matrix_pair pair;
  bwi_factor *factor;
} pencil;

static void clear(pencil *p) {
  bwi_joined_clear(&p->equations);
  bw_release(p->stress);
  bw_release(p->factor);
  bwi_matrix_pair_clear(&p->pair);
}

static bw_status stiffness(bw_context *context, void *data, int64_t count, const double *x,
                           double *y) {
  return bw_sparse_matrix_apply(context, ((pencil *)data)->equations.k->matrix, count, x, y);
}

static bw_status stress(bw_context *context, void *data, int64_t count, const double *x,
                        double *y) {
  return bw_sparse_matrix_apply(context, ((pencil *)data)->stress->matrix, count, x, y);
}

static bw_status solve(bw_context *context, void *data, int64_t count, const double *f, double *y) {
  return bwi_solve_fields(context, ((pencil *)data)->factor, NULL, count, f, y);
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  (void)context, (void)data, (void)count, (void)x; /* the space is all of it */
  return BW_OK;
}

static bw_status between(bw_context *context, void *data, double s, int64_t *count, bool *trusted) {
  const pencil *p = data;
  bwi_matrix matrix = {
      .pattern = p->pair.pattern, .stiffness = p->pair.k, .mass = p->pair.m, .shift = s};
  return bwi_count_negative(context, p->factor->symbolic, &matrix, count, trusted);
}

static bw_status at_nodes(bw_context *context, void *data, const double *x, double *shape) {
  return bw_sparse_matrix_apply(context, ((pencil *)data)->equations.reduction.t, 1, x, shape);
}

/* The matrices and the factor of T^T K T. */
static bw_status prepare(bw_context *context, const bw_static *solution, pencil *p) {
  bw_status status = BW_OK;
  bwi_joined_equations *q = &p->equations;
  bw_sparse_matrix *matrix = NULL;
  double *values = NULL;
  if (solution->model->cyclic)
    return bw_model_refuse_joints(context, solution->model);
  BW_TRY(bwi_buckling_refuse_contact(context, solution));
  BW_TRY(bwi_joined_open(context, solution->model, true, NULL, q));
  if (q->rigid_count > 0)
    BW_TRY(bwi_joined_fail_free(context, q));
  values = BW_NEW(context, double, q->pattern->block_count);
  BW_TRY_MEMORY(values);
  BW_TRY(bw_stress_stiffness(context, q->pattern, solution->model, solution->displacement, values));
  BW_TRY(bwi_reduce_matrix(context, &q->reduction, q->pattern, values, 1, &matrix));
  BW_TRY(bwi_levers_add(context, solution, q, &matrix));
  BW_TRY(bw_operator_of_matrix(context, matrix, "initial stress of the joined bodies", &p->stress));
  BW_TRY(bwi_matrix_pair_open(context, q->k->matrix, p->stress->matrix, &p->pair));
  BW_TRY(bwi_matrix_pair_factor(context, &p->pair, 0, NULL, q->k->name.text,
                                "a coarser mesh needs less", NULL, &p->factor));
done:
  bw_release(matrix);
  bw_free(values);
  return status;
}

bw_status bw_joined_buckling(bw_context *context, const bw_static *solution,
                             const bw_buckling_options *given, bw_buckling **buckling) {
  bw_status status = BW_OK;
  bw_buckling_options options;
  pencil p = {0};
  bw_buckling *out = NULL;
  double start = bw_seconds();
  bwi_blas_enter();
  BW_TRY(bwi_buckling_options_check(context, given, &options));
  if (solution->model->object.revision != solution->revision)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the model has changed since this solution, and load factors need its bonds and "
                   "supports: solve it again"));
  BW_TRY(prepare(context, solution, &p));
  bwi_stability problem = {.size = p.equations.reduction.unknown_count,
                           .dimension = p.equations.reduction.unknown_count,
                           .data = &p,
                           .stiffness = stiffness,
                           .stress = stress,
                           .solve = solve,
                           .project = project,
                           .between = between,
                           .at_nodes = at_nodes};
  BW_TRY(bwi_buckling_empty(context, solution->model, &out));
  BW_TRY(bwi_buckling_find(context, &problem, &options, out));
  out->report.bytes += (double)bwi_factor_bytes(p.factor);
  out->report.flops = 4.0 * (double)bwi_factor_entries(p.factor) * problem.solves;
  out->report.seconds = bw_seconds() - start;
  *buckling = out;
  out = NULL;
done:
  bwi_blas_leave();
  bw_release(out);
  clear(&p);
  return status;
}
