/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solutions u = P T (T^T K T)^-1 T^T P^T f of a joined model, whose bodies may move freely
 * (docs/theory/joints.md, "Many loads"). */
#include "joint/joined_solution.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "linear/internal.h"
#include "linear/matrix_factor.h"

/* Of a displacement of size 1, what bonds may miss of a rigid-body mode. */
static const double reproduced = 1e-6;

void bwi_joined_solution_destroy(void *data) {
  bwi_joined_solution *s = data;
  if (!s)
    return;
  bwi_joined_clear(&s->q);
  bw_free(s->motion);
  bw_free(s->weighted);
  bw_free(s->held);
  bw_free(s->at);
  bw_release(s->inverse);
  bw_free(s);
}

/* v -= sum of `out` (`in` . v): P^T with R and W R, P with these exchanged. `part` (motions). */
static void project(const bwi_joined_solution *s, int64_t size, const double *in, const double *out,
                    double *part, double *v) {
  for (int m = 0; m < s->motions; m++)
    part[m] = bwi_dot(size, in + m * size, v);
  for (int m = 0; m < s->motions; m++)
    for (int64_t i = 0; i < size; i++)
      v[i] -= part[m] * out[m * size + i];
}

static bw_status solution_apply(bw_context *context, void *data, int64_t count, const double *force,
                                double *displacement) {
  bwi_joined_solution *s = data;
  bw_status status = BW_OK;
  const bwi_reduction *r = &s->q.reduction;
  int64_t size = 3 * (int64_t)r->dof_map->mesh->node_count, unknowns = r->unknown_count;
  double *b = BW_NEW(context, double, count *unknowns),
         *x = BW_NEW(context, double, count *unknowns), *part = BW_NEW(context, double, s->motions);
  BW_TRY_MEMORY(b && x && part);
  memcpy(displacement, force, (size_t)(count * size) * sizeof *displacement);
  for (int64_t k = 0; k < count; k++)
    project(s, size, s->motion, s->weighted, part, displacement + k * size);
  BW_TRY(bw_sparse_matrix_apply(context, r->transposed, count, displacement, b));
  for (int64_t i = 0; i < count * unknowns; i++)
    b[i] = s->held[i % unknowns] ? 0 : b[i];
  if (unknowns > 0)
    BW_TRY(bw_operator_apply(context, s->inverse, count, b, x));
  BW_TRY(bw_sparse_matrix_apply(context, r->t, count, x, displacement));
  for (int64_t k = 0; k < count; k++)
    project(s, size, s->weighted, s->motion, part, displacement + k * size);
done:
  bw_free(b);
  bw_free(x);
  bw_free(part);
  return status;
}

/* Whether the nodes that follow in a bond follow the motions too. A free shortening is the same at
 * all of them. */
static bw_status check_bond(bw_context *context, const bw_model *model,
                            const bwi_joined_solution *s, double length, int b) {
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const bw_bond *bond = &model->bond[b];
  const bw_sparse_matrix *f = bond->follows;
  for (int m = 0; m < s->motions; m++) {
    const double *u = s->motion + m * size;
    double shortening = 0;
    for (int32_t row = 0; row < bond->node_count; row++) {
      double off[3];
      memcpy(off, u + 3 * (int64_t)bond->node[row], sizeof off);
      for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
        for (int k = 0; k < 3; k++)
          off[k] -= f->value[e] * u[3 * (int64_t)f->column[e] + k];
      if (row == 0 && bond->preload == BW_PRELOAD_FORCE)
        shortening = bw_dot(off, bond->normal);
      for (int k = 0; k < 3 && bond->preload == BW_PRELOAD_FORCE; k++)
        off[k] -= shortening * bond->normal[k];
      if (bw_norm(off) <= reproduced)
        continue;
      bw_fail(context, BW_GEOMETRY,
              "bond %d closes a gap of up to %.3g m, and resists a rotation of the joined body by "
              "that: it is in balance with no load exactly. Make the sides touch within %.1g m, or "
              "support the model",
              b + 1, bond->gap, reproduced * length);
      bw_detail_number(context, "bond", b + 1.0);
      bw_detail_number(context, "gap", bond->gap);
      return BW_GEOMETRY;
    }
  }
  return BW_OK;
}

/* R^T W R = 1 by Gram and Schmidt, twice. The second time repairs what rounding left. */
static bw_status orthonormalise(bw_context *context, bwi_joined_solution *s, int64_t size,
                                const double *mass, double scale) {
  bw_status status = BW_OK;
  for (int pass = 0; pass < 2; pass++)
    for (int m = 0; m < s->motions; m++) {
      double *u = s->motion + m * size, *weighted = s->weighted + m * size;
      for (int k = 0; k < m; k++) {
        double part = bwi_dot(size, u, s->weighted + k * size);
        for (int64_t i = 0; i < size; i++)
          u[i] -= part * s->motion[k * size + i];
      }
      BW_TRY(bw_block_multiply(context, s->q.pattern, mass, 1, 3, 1, u, weighted));
      double square = bwi_dot(size, u, weighted) / scale;
      for (int64_t i = 0; i < size; i++) {
        u[i] /= sqrt(square);
        weighted[i] /= scale * sqrt(square);
      }
    }
done:
  return status;
}

bw_status bwi_joined_solution_weigh(bw_context *context, const bw_model *model, const double *mass,
                                    double scale, double length, bwi_joined_solution *s) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  s->weighted = BW_NEW(context, double, s->motions *size);
  BW_TRY_MEMORY(s->weighted);
  BW_TRY(orthonormalise(context, s, size, mass, scale));
  for (int b = 0; b < model->bond_count; b++)
    BW_TRY(check_bond(context, model, s, length, b));
done:
  return status;
}

/* Chooses unknowns that are displacements of nodes along global axes, one for each motion: each
 * that the motions move most, less what the ones before hold. */
static bw_status hold(bw_context *context, bwi_joined_solution *s) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &s->q.reduction;
  int64_t size = 3 * (int64_t)r->dof_map->mesh->node_count;
  double *base = BW_NEW(context, double, (int64_t)s->motions * s->motions);
  double *square = BW_NEW0(context, double, size); /* of what is left at a component */
  s->held = BW_NEW0(context, uint8_t, r->unknown_count);
  s->at = BW_NEW(context, int64_t, s->motions);
  BW_TRY_MEMORY(base && square && s->held && s->at);
  for (int64_t i = 0; i < size; i++)
    if (r->t->start[i + 1] - r->t->start[i] == 1 && r->t->value[r->t->start[i]] == 1)
      for (int m = 0; m < s->motions; m++)
        square[i] += s->motion[m * size + i] * s->motion[m * size + i];
  for (int h = 0; h < s->motions; h++) {
    double *row = base + (int64_t)h * s->motions;
    int64_t best = 0;
    for (int64_t i = 1; i < size; i++)
      best = square[i] > square[best] ? i : best;
    for (int m = 0; m < s->motions; m++)
      row[m] = s->motion[m * size + best];
    for (int k = 0; k < h; k++) {
      const double *before = base + (int64_t)k * s->motions;
      double part = bwi_dot(s->motions, row, before);
      for (int m = 0; m < s->motions; m++)
        row[m] -= part * before[m];
    }
    double length = sqrt(bwi_dot(s->motions, row, row));
    if (!(length > 1e-6))
      BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                     "too few nodes of the joined body move freely along the axes: support it"));
    for (int m = 0; m < s->motions; m++)
      row[m] /= length;
    for (int64_t i = 0; i < size; i++) {
      double part = 0;
      for (int m = 0; square[i] > 0 && m < s->motions; m++)
        part += row[m] * s->motion[m * size + i];
      square[i] = fmax(square[i] - part * part, 0);
    }
    square[best] = 0;
    s->at[h] = best;
    s->held[r->t->column[r->t->start[best]]] = 1;
  }
done:
  bw_free(base);
  bw_free(square);
  return status;
}

/* The matrix without the rows and columns that are held, but for their diagonal. */
static bw_status without_held(bw_context *context, const bwi_joined_solution *s,
                              bw_sparse_matrix **out) {
  bw_status status = BW_OK;
  const bw_sparse_matrix *a = s->q.k->matrix;
  int64_t count = 0, *start = BW_NEW(context, int64_t, (int64_t)a->rows + 1);
  int32_t *column = BW_NEW(context, int32_t, a->start[a->rows]);
  double *value = BW_NEW(context, double, a->start[a->rows]);
  BW_TRY_MEMORY(start && column && value);
  start[0] = 0;
  for (int32_t i = 0; i < a->rows; i++) {
    for (int64_t e = a->start[i]; e < a->start[i + 1]; e++)
      if (a->column[e] == i || !(s->held[i] || s->held[a->column[e]])) {
        column[count] = a->column[e];
        value[count++] = a->value[e];
      }
    start[i + 1] = count;
  }
  BW_TRY(bw_sparse_matrix_adopt(context, a->rows, a->rows, start, column, value, out));
  start = NULL;
  column = NULL;
  value = NULL;
done:
  bw_free(start);
  bw_free(column);
  bw_free(value);
  return status;
}

/* A probe of random unknowns: what is left of its forces. */
static bw_status check_residual(bw_context *context, const bwi_joined_solution *s,
                                const bw_sparse_matrix *matrix) {
  bw_status status = BW_OK;
  int64_t n = matrix->rows;
  double square = 0, whole = 0;
  bw_random random;
  double *b = BW_NEW(context, double, n), *x = BW_NEW(context, double, n),
         *kx = BW_NEW(context, double, n);
  BW_TRY_MEMORY(b && x && kx);
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < n; i++)
    b[i] = s->held[i] ? 0 : 2 * bw_random_uniform(&random) - 1;
  BW_TRY(bw_operator_apply(context, s->inverse, 1, b, x));
  BW_TRY(bw_sparse_matrix_apply(context, matrix, 1, x, kx));
  for (int64_t i = 0; i < n; i++) {
    square += (b[i] - kx[i]) * (b[i] - kx[i]);
    whole += b[i] * b[i];
  }
  BW_TRY(bwi_joined_check_residual(context, whole > 0 ? sqrt(square / whole) : 0));
done:
  bw_free(b);
  bw_free(x);
  bw_free(kx);
  return status;
}

static bw_status factor(bw_context *context, const bw_solver *solver, bwi_joined_solution *s) {
  bw_status status = BW_OK;
  bw_sparse_matrix *matrix = NULL;
  if (solver && solver->options.kind != BW_SOLVER_CHOLESKY)
    return bw_fail(context, BW_UNSUPPORTED,
                   "many loads on a joined model are solved by a factor, not by \"%s\": leave the "
                   "solver out, or give cholesky",
                   bw_solver_word(solver->options.kind));
  if (s->q.reduction.unknown_count == 0)
    return BW_OK;
  BW_TRY(without_held(context, s, &matrix));
  status = bw_operator_inverse(context, matrix, solver, &s->inverse);
  if (status == BW_SINGULAR)
    status = bwi_joined_check_residual(context, -1);
  BW_TRY(status);
  BW_TRY(check_residual(context, s, matrix));
done:
  bw_release(matrix);
  return status;
}

bw_status bwi_joined_solution_system(bw_context *context, const bw_model *model,
                                     const bw_solver *solver, const bw_dof_map *dof_map,
                                     double start, bwi_joined_solution *s, bw_system **out) {
  bw_status status = BW_OK;
  bw_operator *solution = NULL;
  bw_system *system = NULL;
  double assembled = bw_seconds();
  BW_TRY(hold(context, s));
  BW_TRY(factor(context, solver, s));
  const bwi_factor *l = bwi_operator_factor(s->inverse);
  BW_TRY(bw_operator_create(context, 3 * (int64_t)model->mesh->node_count, solution_apply, s,
                            bwi_joined_solution_destroy, "solution of the joined bodies",
                            &solution));
  s = NULL;
  BW_TRY(bwi_system_by_operator(context, model, dof_map, solution, &system));
  system->times.stiffness = assembled - start;
  system->times.factor = bw_seconds() - assembled;
  system->report =
      (bw_solver_report){.solver = "cholesky",
                         .backend = "",
                         .preconditioner = "",
                         .reason = "many loads on joined bodies are solved by a factor"};
  if (l) {
    system->times.factor_entries = bwi_factor_entries(l);
    system->times.factor_flops = system->report.flops = bwi_factor_flops(l);
    system->report.bytes = (double)bwi_factor_bytes(l);
  }
  *out = system;
done:
  bwi_joined_solution_destroy(s);
  bw_release(solution);
  return status;
}
