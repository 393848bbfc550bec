/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of joined models for many right-hand sides (docs/theory/joints.md, "Many loads").
 *
 * Invariant: the motions R that supports, springs and points leave free move all bodies as one, and
 * T reproduces them. So they span the null space of T^T K T, and as many unknowns held at 0 make it
 * positive definite; a balanced load exerts nothing there. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "joint/internal.h"
#include "linear/internal.h"
#include "linear/matrix_factor.h"

/* Of a displacement of size 1, what bonds may miss of a rigid-body mode. */
static const double reproduced = 1e-6;

typedef struct joined_solution {
  bwi_joined_equations q;
  int motions;
  double *motion;   /* motions x 3 node_count: R */
  double *weighted; /* motions x 3 node_count: W R, with R^T W R = 1 */
  uint8_t *held;    /* unknown_count: not 0 where an unknown is 0 instead of a motion */
  bw_operator *inverse;
} joined_solution;

static void solution_destroy(void *data) {
  joined_solution *s = data;
  if (!s)
    return;
  bwi_joined_clear(&s->q);
  bw_free(s->motion);
  bw_free(s->weighted);
  bw_free(s->held);
  bw_release(s->inverse);
  bw_free(s);
}

/* v -= sum of `out` (`in` . v): P^T with R and W R, P with these exchanged. */
static void project(const joined_solution *s, int64_t size, const double *in, const double *out,
                    double *v) {
  double part[6];
  for (int m = 0; m < s->motions; m++)
    part[m] = bwi_dot(size, in + m * size, v);
  for (int m = 0; m < s->motions; m++)
    for (int64_t i = 0; i < size; i++)
      v[i] -= part[m] * out[m * size + i];
}

static bw_status solution_apply(bw_context *context, void *data, int64_t count, const double *force,
                                double *displacement) {
  joined_solution *s = data;
  bw_status status = BW_OK;
  const bwi_reduction *r = &s->q.reduction;
  int64_t size = 3 * (int64_t)r->dof_map->mesh->node_count, unknowns = r->unknown_count;
  double *b = BW_NEW(context, double, count *unknowns),
         *x = BW_NEW(context, double, count *unknowns);
  BW_TRY_MEMORY(b && x);
  memcpy(displacement, force, (size_t)(count * size) * sizeof *displacement);
  for (int64_t k = 0; k < count; k++)
    project(s, size, s->motion, s->weighted, displacement + k * size);
  BW_TRY(bw_sparse_matrix_apply(context, r->transposed, count, displacement, b));
  for (int64_t i = 0; i < count * unknowns; i++)
    b[i] = s->held[i % unknowns] ? 0 : b[i];
  if (unknowns > 0)
    BW_TRY(bw_operator_apply(context, s->inverse, count, b, x));
  BW_TRY(bw_sparse_matrix_apply(context, r->t, count, x, displacement));
  for (int64_t k = 0; k < count; k++)
    project(s, size, s->weighted, s->motion, displacement + k * size);
done:
  bw_free(b);
  bw_free(x);
  return status;
}

/* ---- rigid-body modes of all bodies together ------------------------------------------------- */

/* Conditions on the motion of all bodies as one, about a centre: rows as bwi_rigid_modes takes. */
typedef struct conditions {
  bw_context *context;
  double centre[3], length;
  double (*row)[6];
  size_t count, capacity;
} conditions;

static bw_status add_row(conditions *c, const double x[3], const double d[3]) {
  if (!bw_grow(c->context, (void **)&c->row, &c->capacity, c->count, 1, sizeof *c->row))
    return BW_MEMORY;
  double *row = c->row[c->count++];
  double y[3] = {x[0] - c->centre[0], x[1] - c->centre[1], x[2] - c->centre[2]};
  bw_cross(y, d, row + 3);
  for (int k = 0; k < 3; k++) {
    row[k] = d[k];
    row[3 + k] /= c->length;
  }
  return BW_OK;
}

static bw_status add_spring(conditions *c, const bw_attachment *spring) {
  bw_status status = BW_OK;
  const double *x = spring->on->mesh->node;
  for (int32_t i = 0; i < spring->on->node_count; i++)
    for (int k = 0; k < 3; k++)
      if (spring->stiffness[k] > 0)
        BW_TRY(
            add_row(c, x + 3 * (int64_t)spring->on->node[i], (double[3]){k == 0, k == 1, k == 2}));
done:
  return status;
}

static bw_status add_point(conditions *c, const bw_remote_point *point) {
  bw_status status = BW_OK;
  for (int k = 0; k < 6; k++) {
    const double d[3] = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
    if (!point->fixed[k] && !(point->spring[k] > 0))
      continue;
    BW_TRY(add_row(c, point->at, d));
    if (k < 3)
      continue;
    double *row = c->row[c->count - 1]; /* a rotation is the same everywhere */
    memset(row, 0, 3 * sizeof *row);
    memcpy(row + 3, d, sizeof d);
  }
done:
  return status;
}

/* Centre, size and 1/V integral of |y|^2 1 - y y^T of all bodies, by the mass of density 1. */
static bw_status find_moments(conditions *c, const joined_solution *s, const double *mass,
                              double inertia[9], double *volume) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->q.reduction.dof_map->mesh;
  int64_t nodes = mesh->node_count;
  double *one = BW_NEW(c->context, double, nodes), *weight = BW_NEW(c->context, double, nodes);
  double *y = BW_NEW(c->context, double, 3 * nodes), *my = BW_NEW(c->context, double, 3 * nodes);
  BW_TRY_MEMORY(one && weight && y && my);
  for (int64_t i = 0; i < nodes; i++)
    one[i] = 1;
  BW_TRY(bw_block_multiply(c->context, s->q.pattern, mass, 1, 1, 1, one, weight));
  *volume = 0;
  for (int64_t i = 0; i < nodes; i++) {
    *volume += weight[i];
    for (int k = 0; k < 3; k++)
      c->centre[k] += weight[i] * mesh->node[3 * i + k];
  }
  for (int k = 0; k < 3; k++)
    c->centre[k] /= *volume;
  for (int64_t i = 0; i < 3 * nodes; i++)
    y[i] = mesh->node[i] - c->centre[i % 3];
  BW_TRY(bw_block_multiply(c->context, s->q.pattern, mass, 1, 3, 1, y, my));
  double square[9] = {0};
  for (int64_t i = 0; i < nodes; i++)
    for (int k = 0; k < 9; k++)
      square[k] += y[3 * i + k / 3] * my[3 * i + k % 3] / *volume;
  for (int k = 0; k < 9; k++)
    inertia[k] = (k % 4 == 0 ? square[0] + square[4] + square[8] : 0) - square[k];
  c->length = sqrt((inertia[0] + inertia[4] + inertia[8]) / 2);
done:
  bw_free(one);
  bw_free(weight);
  bw_free(y);
  bw_free(my);
  return status;
}

static bw_status take_conditions(conditions *c, const bw_model *model) {
  bw_status status = BW_OK;
  int32_t count = 0;
  bwi_constraint *constraint = NULL;
  BW_TRY(bwi_node_constraints(c->context, model, &count, &constraint));
  for (int32_t h = 0; h < count; h++)
    for (int i = 0; i < constraint[h].count; i++)
      BW_TRY(add_row(c, model->mesh->node + 3 * (int64_t)constraint[h].node,
                     constraint[h].direction[i]));
  for (int i = 0; i < model->attachment_count; i++)
    BW_TRY(add_spring(c, &model->attachment[i]));
  for (int i = 0; i < model->coupling_count; i++)
    BW_TRY(add_point(c, &model->coupling[i].point));
done:
  bw_free(constraint);
  return status;
}

/* Whether the nodes that follow in bonds follow the motions too. */
static bw_status check_bonds(bw_context *context, const bw_model *model, const joined_solution *s,
                             double length) {
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  for (int b = 0; b < model->bond_count; b++) {
    const bw_bond *bond = &model->bond[b];
    const bw_sparse_matrix *f = bond->follows;
    for (int64_t i = 0; i < 3 * (int64_t)bond->node_count * s->motions; i++) {
      int m = (int)(i % s->motions), k = (int)(i / s->motions % 3);
      int32_t row = (int32_t)(i / s->motions / 3);
      const double *u = s->motion + m * size + k;
      double off = u[3 * (int64_t)bond->node[row]];
      for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
        off -= f->value[e] * u[3 * (int64_t)f->column[e]];
      if (fabs(off) <= reproduced)
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

/* R, W R, and the modes into the DOF map. */
static bw_status find_motions(bw_context *context, const bw_model *model, joined_solution *s,
                              bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  conditions c = {.context = context};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double inertia[9], volume, *mass = NULL;
  bw_rigid_mode *motion = NULL;
  mass = BW_NEW(context, double, s->q.pattern->block_count);
  motion = BW_NEW0(context, bw_rigid_mode, 6);
  BW_TRY_MEMORY(mass && motion);
  BW_TRY(bw_mass(context, s->q.pattern, model->mesh, NULL, mass));
  BW_TRY(find_moments(&c, s, mass, inertia, &volume));
  BW_TRY(take_conditions(&c, model));
  bw_dof_map whole = {.mesh = model->mesh, .body_centre = c.centre};
  s->motions = bwi_rigid_modes(&whole, 0, inertia, c.length, (int64_t)c.count,
                               (const double(*)[6])c.row, motion);
  s->motion = BW_NEW(context, double, s->motions *size);
  s->weighted = BW_NEW(context, double, s->motions *size);
  BW_TRY_MEMORY(s->motion && s->weighted);
  for (int m = 0; m < s->motions; m++) {
    motion[m].component = -1;
    for (int64_t i = 0; i < size / 3; i++)
      bwi_motion_at(&motion[m], model->mesh->node + 3 * i, s->motion + m * size + 3 * i);
  }
  BW_TRY(bw_block_multiply(context, s->q.pattern, mass, 1, 3, s->motions, s->motion, s->weighted));
  for (int64_t i = 0; i < s->motions * size; i++)
    s->weighted[i] /= volume;
  if (s->q.rigid_count > s->motions)
    BW_TRY(bw_fail(context, BW_UNCONSTRAINED,
                   "bonds and couplings leave %d rigid-body modes, and the joined body as one has "
                   "%d: some bodies move against one another. Join them by bonds, or support each",
                   s->q.rigid_count, s->motions));
  BW_TRY(check_bonds(context, model, s, c.length));
  bw_free(dof_map->rigid_mode);
  dof_map->rigid_mode = motion;
  motion = NULL;
  dof_map->rigid_mode_count = s->motions;
  memset(dof_map->rigid_mode_start, 0,
         ((size_t)model->mesh->component_count + 1) * sizeof *dof_map->rigid_mode_start);
  dof_map->unknown_count = s->q.reduction.unknown_count;
done:
  bw_free(c.row);
  bw_free(mass);
  bw_free(motion);
  return status;
}

/* ---- the factor ------------------------------------------------------------------------------ */

/* Chooses unknowns that are displacements of nodes along global axes, one for each motion: each
 * that the motions move most, less what the ones before hold. */
static bw_status hold(bw_context *context, joined_solution *s) {
  const bwi_reduction *r = &s->q.reduction;
  int64_t size = 3 * (int64_t)r->dof_map->mesh->node_count;
  double base[6][6];
  s->held = BW_NEW0(context, uint8_t, r->unknown_count);
  if (!s->held)
    return BW_MEMORY;
  for (int h = 0; h < s->motions; h++) {
    double most = 1e-6;
    int32_t best = -1;
    for (int64_t i = 0; i < size; i++) {
      double row[6];
      if (r->t->start[i + 1] - r->t->start[i] != 1 || r->t->value[r->t->start[i]] != 1)
        continue;
      for (int m = 0; m < s->motions; m++)
        row[m] = s->motion[m * size + i];
      for (int k = 0; k < h; k++) {
        double part = bwi_dot(s->motions, row, base[k]);
        for (int m = 0; m < s->motions; m++)
          row[m] -= part * base[k][m];
      }
      double length = sqrt(bwi_dot(s->motions, row, row));
      if (length <= most)
        continue;
      most = length;
      best = r->t->column[r->t->start[i]];
      for (int m = 0; m < s->motions; m++)
        base[h][m] = row[m] / length;
    }
    if (best < 0)
      return bw_fail(context, BW_UNSUPPORTED,
                     "too few nodes of the joined body move freely along the axes: support it");
    s->held[best] = 1;
  }
  return BW_OK;
}

/* The matrix without the rows and columns that are held, but for their diagonal. */
static bw_status without_held(bw_context *context, const joined_solution *s,
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
static bw_status check_residual(bw_context *context, const joined_solution *s,
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

static bw_status factor(bw_context *context, const bw_solver *solver, joined_solution *s) {
  bw_status status = BW_OK;
  bw_sparse_matrix *matrix = NULL;
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

/* ---- together -------------------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_model *model, const bw_solver *solver) {
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  if (solver && solver->options.kind != BW_SOLVER_CHOLESKY)
    return bw_fail(context, BW_UNSUPPORTED,
                   "many loads on a joined model are solved by a factor, not by \"%s\": leave the "
                   "solver out, or give cholesky",
                   bw_solver_word(solver->options.kind));
  bw_status status = bwi_model_refuse_preloads(
      context, model,
      "strains the bodies without any other load: the stress is not linear in the loads, leave the "
      "preload out");
  if (status != BW_OK)
    return status;
  return bwi_points_refuse_motion(context, model, "many loads are solved with fixed points only");
}

bw_status bw_joined_system(bw_context *context, const bw_model *model, const bw_solver *solver,
                           bw_system **out) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  bw_operator *solution = NULL;
  bw_system *system = NULL;
  joined_solution *s = NULL;
  double start = bw_seconds(), assembled;
  BW_TRY(check_model(context, model, solver));
  s = BW_NEW0(context, joined_solution, 1);
  BW_TRY_MEMORY(s);
  BW_TRY(bwi_dof_map_apart(context, model, &dof_map));
  if (dof_map->prescribed)
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "a support prescribes a displacement that is not zero: many loads are solved "
                   "with fixed supports only"));
  BW_TRY(bwi_joined_open(context, model, false, NULL, &s->q));
  BW_TRY(find_motions(context, model, s, dof_map));
  assembled = bw_seconds();
  BW_TRY(hold(context, s));
  BW_TRY(factor(context, solver, s));
  bw_release(s->q.k);
  s->q.k = NULL;
  bw_free(s->q.stiffness);
  s->q.stiffness = NULL;
  const bw_operator *inverse = s->inverse;
  BW_TRY(bw_operator_create(context, 3 * (int64_t)model->mesh->node_count, solution_apply, s,
                            solution_destroy, "solution of the joined bodies", &solution));
  s = NULL;
  BW_TRY(bwi_system_by_operator(context, model, dof_map, solution, &system));
  system->times.stiffness = assembled - start;
  system->times.factor = bw_seconds() - assembled;
  system->report =
      (bw_solver_report){.solver = "cholesky",
                         .backend = "",
                         .preconditioner = "",
                         .reason = "many loads on joined bodies are solved by a factor"};
  const bwi_factor *l = bwi_operator_factor(inverse);
  if (l) {
    system->times.factor_entries = bwi_factor_entries(l);
    system->times.factor_flops = system->report.flops = bwi_factor_flops(l);
    system->report.bytes = (double)bwi_factor_bytes(l);
  }
  *out = system;
done:
  solution_destroy(s);
  bw_release(dof_map);
  bw_release(solution);
  return status;
}
