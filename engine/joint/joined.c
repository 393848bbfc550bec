/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions and modes of models with bonds, attached masses and springs, and couplings. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "assemble/internal.h"
#include "barwright/job.h"
#include "base/dense.h"
#include "eigen/modes.h"
#include "joint/cyclic.h"
#include "linear/matrix_factor.h"
#include "statics/internal.h"

void bwi_joined_clear(bwi_joined_equations *q) {
  bwi_reduction_clear(&q->reduction);
  bw_release(q->pattern);
  bw_release(q->k);
  bw_free(q->stiffness);
}

bw_status bwi_joined_operator(bw_context *context, const bwi_joined_equations *q,
                              const double *values, int block, const char *name,
                              bw_operator **out) {
  bw_sparse_matrix *matrix = NULL;
  bw_status status = bwi_reduce_matrix(context, &q->reduction, q->pattern, values, block, &matrix);
  if (status == BW_OK)
    status = bwi_points_add(context, &q->reduction, block == 9, &matrix);
  if (status == BW_OK)
    status = bw_operator_of_matrix(context, matrix, name, out);
  bw_release(matrix);
  return status;
}

bw_status bwi_joined_open(bw_context *context, const bw_model *model, bool locked,
                          const bw_subdomain_stiffness *known, bwi_joined_equations *q) {
  bw_status status = BW_OK;
  bw_progress(context, "assembly", 0);
  const char *locking = bw_locking(model->mesh, model->material);
  if (locking)
    bw_warn(context, "%s", locking);
  if (model->cyclic) {
    BW_TRY(bwi_cyclic_check_loads(context, model));
    BW_TRY(bwi_cyclic_reduction_open(context, model, 0, &q->reduction));
    BW_TRY(bwi_cyclic_rigid_modes(context, model, q->reduction.dof_map, 0, &q->rigid_count,
                                  &q->rigid_body));
  } else {
    BW_TRY(bwi_reduction_open(context, model, locked, &q->reduction));
    BW_TRY(bwi_bonded_rigid_modes(context, model, q->reduction.dof_map, locked, &q->rigid_count,
                                  &q->rigid_body));
  }
  q->reduction.with_zeros = known != NULL; /* the next shape keeps the elimination order */
  if (known)
    q->pattern = bw_retain(known->pattern);
  else
    BW_TRY(bw_block_pattern_create(context, model->mesh, &q->pattern));
  q->stiffness = BW_NEW(context, double, 9 * q->pattern->block_count);
  BW_TRY_MEMORY(q->stiffness);
  if (known)
    memcpy(q->stiffness, known->values, 9 * (size_t)q->pattern->block_count * sizeof *q->stiffness);
  else
    BW_TRY(bw_stiffness(context, q->pattern, model->mesh, model->material, q->stiffness));
  bwi_add_attachments(model, q->pattern, 9, q->stiffness);
  BW_TRY(bwi_joined_operator(context, q, q->stiffness, 9, "stiffness of the joined bodies", &q->k));
done:
  return status;
}

/* ---- statics --------------------------------------------------------------------------------- */

/* What a sector may move by is what all sectors share. */
static bw_status fail_free_sector(bw_context *context, const bwi_joined_equations *q) {
  bw_fail(context, BW_UNCONSTRAINED,
          "supports leave %d rigid-body mode%s unconstrained that all sectors share, along the "
          "axis or about it: add supports; where the loads balance, hold one node of the sector "
          "in that direction",
          q->rigid_count, q->rigid_count == 1 ? "" : "s");
  bw_detail_number(context, "motions", q->rigid_count);
  return BW_UNCONSTRAINED;
}

bw_status bwi_joined_fail_free(bw_context *context, const bwi_joined_equations *q) {
  const double *centre = q->reduction.dof_map->body_centre + 3 * (int64_t)q->rigid_body;
  bw_fail(
      context, BW_UNCONSTRAINED,
      "supports, bonds, couplings and springs leave %d rigid-body mode%s unconstrained, in which "
      "the body around (%g, %g, %g) m moves: add supports, bonds or springs",
      q->rigid_count, q->rigid_count == 1 ? "" : "s", centre[0], centre[1], centre[2]);
  bw_detail_number(context, "motions", q->rigid_count);
  return BW_UNCONSTRAINED;
}

/* Forces K u - f at the nodes that follow are what the bonds exert on side a. */
static bw_status sum_bonds(bw_context *context, const bwi_reduction *r, bw_static *result) {
  const bw_model *model = result->model;
  const double *force = result->reaction;
  if (model->bond_count == 0)
    return BW_OK;
  bw_joint_force *bonds = result->bond = BW_NEW0(context, bw_joint_force, model->bond_count);
  if (!bonds)
    return BW_MEMORY;
  result->bond_count = model->bond_count;
  const bw_dof_map *dof_map = r->dof_map;
  for (int b = 0; b < model->bond_count; b++) {
    for (int32_t i = 0; i < model->bond[b].node_count; i++) {
      int32_t node = model->bond[b].node[i];
      const double *x = model->mesh->node + 3 * (int64_t)node;
      double f[3], m[3], d[3];
      memcpy(f, force + 3 * (int64_t)node, sizeof f);
      for (int k = 0; k < 3; k++) { /* without what a support exerts */
        if (dof_map->state[3 * (int64_t)node + k] != BW_DOF_PRESCRIBED)
          continue;
        bwi_direction_of(dof_map, node, k, d);
        double part = bw_dot(d, force + 3 * (int64_t)node);
        for (int c = 0; c < 3; c++)
          f[c] -= part * d[c];
      }
      memcpy(result->joint_force + 3 * (int64_t)node, f, sizeof f);
      bw_cross(x, f, m);
      for (int c = 0; c < 3; c++) {
        bonds[b].force[c] += f[c];
        bonds[b].moment[c] += m[c];
      }
    }
  }
  return BW_OK;
}

typedef struct sums {
  const bw_mesh *mesh;
  const double *displacement;
  double work;
  bw_joint_force *of;
} sums;

static void add_to_sums(void *data, int32_t node, const double force[3]) {
  sums *s = data;
  double moment[3];
  bw_cross(s->mesh->node + 3 * (int64_t)node, force, moment);
  s->work += bw_dot(force, s->displacement + 3 * (int64_t)node);
  for (int c = 0; c < 3; c++) {
    s->of->force[c] += force[c];
    s->of->moment[c] += moment[c];
  }
}

/* What attachments exert on the body. The energy of springs is no strain energy. */
static bw_status sum_attachments(bw_context *context, const double gravity[3], bw_static *result) {
  const bw_model *model = result->model;
  if (model->attachment_count == 0)
    return BW_OK;
  result->attachment = BW_NEW0(context, bw_joint_force, model->attachment_count);
  if (!result->attachment)
    return BW_MEMORY;
  result->attachment_count = model->attachment_count;
  for (int a = 0; a < model->attachment_count; a++) {
    const bw_attachment *at = &model->attachment[a];
    sums s = {model->mesh, result->displacement, 0, &result->attachment[a]};
    double factor[3];
    for (int c = 0; c < 3; c++)
      factor[c] = at->mass > 0 ? at->mass : -at->stiffness[c];
    bwi_attachment_apply(at, factor, at->mass > 0 ? NULL : result->displacement, gravity,
                         add_to_sums, &s);
    if (!(at->mass > 0))
      result->energy += 0.5 * s.work;
  }
  return BW_OK;
}

/* A residual above this is refused: the error of the displacement is about a fifth of it. */
static const double max_residual = 1e-3;

bw_status bwi_joined_check_residual(bw_context *context, double residual) {
  char found[80] = "the elimination fails";
  if (residual >= 0 && residual <= max_residual)
    return BW_OK;
  if (residual >= 0)
    snprintf(found, sizeof found, "the residual is %.2g of the load", residual);
  bw_fail(context, BW_SINGULAR,
          "the joined stiffness is so nearly singular that double precision cannot tell the "
          "displacement: %s. Springs are too soft beside the body, or elements have almost no "
          "volume. Make the springs stiffer, support the body, or mesh again",
          found);
  if (residual >= 0)
    bw_detail_number(context, "residual", residual);
  return BW_SINGULAR;
}

/* x of K x = b, where the unknowns that are held have the values of `place`: b is balanced. */
static bw_status solve_held(bw_context *context, const bwi_joined_equations *q, const double *b,
                            double *x) {
  bw_status status = BW_OK;
  int64_t unknowns = q->reduction.unknown_count;
  double *rest = BW_NEW(context, double, unknowns), *more = BW_NEW(context, double, unknowns);
  BW_TRY_MEMORY(rest && more);
  memcpy(x, q->place, (size_t)unknowns * sizeof *x);
  for (int pass = 0; pass < 2; pass++) { /* the second refines */
    BW_TRY(bw_sparse_matrix_apply(context, q->k->matrix, 1, x, rest));
    for (int64_t i = 0; i < unknowns; i++)
      rest[i] = q->held[i] ? 0 : b[i] - rest[i];
    BW_TRY(bw_operator_apply(context, q->inverse, 1, rest, more));
    for (int64_t i = 0; i < unknowns; i++)
      x[i] += more[i];
  }
done:
  bw_free(rest);
  bw_free(more);
  return status;
}

static bw_status solve(bw_context *context, const bwi_joined_equations *q, const bw_solver *solver,
                       const bw_model *model, bw_static *result) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &q->reduction;
  int64_t size = 3 * (int64_t)model->mesh->node_count, unknowns = r->unknown_count;
  double gravity[3];
  bwi_sum_gravity(model, gravity);
  double *rest = BW_NEW(context, double, size), *b = BW_NEW(context, double, unknowns),
         *x = BW_NEW0(context, double, unknowns), *kx = BW_NEW(context, double, unknowns);
  result->reaction = BW_NEW(context, double, size);
  BW_TRY_MEMORY(rest && b && x && kx && result->reaction);
  if (r->point_count > 0) {
    result->coupling = BW_NEW0(context, bw_coupling_result, r->point_count);
    BW_TRY_MEMORY(result->coupling);
    result->coupling_count = r->point_count;
  }
  if (model->bond_count > 0 || r->point_count > 0) {
    result->joint_force = BW_NEW0(context, double, size);
    BW_TRY_MEMORY(result->joint_force);
  }
  BW_TRY(bw_block_multiply(context, q->pattern, q->stiffness, 9, 3, 1, r->g, rest));
  for (int64_t i = 0; i < size; i++)
    rest[i] = result->force[i] - rest[i];
  BW_TRY(bwi_preload_add(context, model, r, rest));
  BW_TRY(bw_sparse_matrix_apply(context, r->transposed, 1, rest, b));
  bwi_points_load(r, gravity, b);
  if (unknowns > 0 && q->held) {
    const bwi_factor *l = bwi_operator_factor(q->inverse);
    result->report = (bw_solver_report){.solver = bw_solver_word(BW_SOLVER_CHOLESKY),
                                        .backend = l ? l->kernels->backend : "",
                                        .preconditioner = "",
                                        .reason = "a factor serves all forces of contact"};
    status = solve_held(context, q, b, x);
  } else if (unknowns > 0)
    status = bwi_linear_solve_by(context, q->k, &(bw_linear_solve_options){.solver = solver},
                                 q->inverse, 1, b, x, &result->report);
  if (status == BW_SINGULAR)
    status = bwi_joined_check_residual(context, -1);
  BW_TRY(status);
  BW_TRY(bw_sparse_matrix_apply(context, q->k->matrix, 1, x, kx));
  double square = 0, whole = bwi_dot(unknowns, b, b);
  for (int64_t i = 0; i < unknowns; i++)
    square += (b[i] - kx[i]) * (b[i] - kx[i]);
  result->residual = whole > 0 ? sqrt(square / whole) : 0;
  BW_TRY(bwi_joined_check_residual(context, result->residual));
  BW_TRY(bw_sparse_matrix_apply(context, r->t, 1, x, result->displacement));
  for (int64_t i = 0; i < size; i++)
    result->displacement[i] += r->g[i];
  BW_TRY(bw_block_multiply(context, q->pattern, q->stiffness, 9, 3, 1, result->displacement,
                           result->reaction));
  for (int64_t i = 0; i < size; i++) {
    result->energy += 0.5 * result->displacement[i] * result->reaction[i];
    result->reaction[i] -= result->force[i];
  }
  BW_TRY(bwi_points_spread(context, r, gravity, x, result->reaction, result->coupling));
  BW_TRY(sum_bonds(context, r, result));
  bwi_preload_results(model, r, result->displacement, result->bond);
  BW_TRY(sum_attachments(context, gravity, result));
  bwi_reduction_move(r, result->reaction);
  if (model->cyclic)
    bwi_cyclic_move(model->cyclic, result->reaction);
  bwi_points_gather(r, result->reaction, result->coupling, result->joint_force);
  bwi_keep_states(r->dof_map, 1u << BW_DOF_PRESCRIBED, result->reaction);
done:
  bw_free(rest);
  bw_free(b);
  bw_free(x);
  bw_free(kx);
  return status;
}

bw_status bwi_joined_check_options(bw_context *context, const bw_statics_options *options) {
  if (!options || !options->inertia_relief)
    return BW_OK;
  return bw_fail(context, BW_UNSUPPORTED,
                 "inertia relief is for models without bonds, attachments, couplings and cyclic "
                 "symmetry: leave it out, and hold what moves freely by supports or springs");
}

bw_status bwi_joined_static(bw_context *context, const bw_model *model,
                            const bw_statics_options *options, const bwi_joined_equations *q,
                            double start, bw_static **out) {
  bw_status status = BW_OK;
  bw_static *result = NULL;
  bw_statics_options opts = options ? *options : (bw_statics_options){0};
  opts.inertia_relief = true; /* balance is judged for the joined bodies */
  if (q->rigid_count > 0 && !q->held)
    BW_TRY(model->cyclic ? fail_free_sector(context, q) : bwi_joined_fail_free(context, q));
  BW_TRY(bwi_static_begin(context, model, &opts, q->reduction.dof_map, &result));
  BW_TRY(solve(context, q, opts.solver, model, result));
  result->report.residual = result->residual;
  result->report.seconds = bw_seconds() - start;
done:
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}

bw_status bw_joined_statics(bw_context *context, const bw_model *model,
                            const bw_statics_options *options, bw_static **out) {
  bw_status status = BW_OK;
  bwi_joined_equations q = {0};
  double start = bw_seconds();
  BW_TRY(bwi_joined_check_options(context, options));
  BW_TRY(bwi_joined_open(context, model, false, NULL, &q));
  BW_TRY(bwi_joined_static(context, model, options, &q, start, out));
done:
  bwi_joined_clear(&q);
  return status;
}

/* ---- modes ----------------------------------------------------------------------------------- */

/* The pairs behind the rigid-body modes, as shapes of all nodes. */
static bw_status make_modes(bw_context *context, const bw_model *model,
                            const bwi_joined_equations *q, const bw_eigenpairs *pairs,
                            bw_modes **modes) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  int rigid = q->rigid_count < pairs->count ? q->rigid_count : pairs->count;
  bwi_eigen_result result = {.count = pairs->count - rigid,
                             .recovered = pairs->recovered,
                             .counted = pairs->counted,
                             .tested = pairs->tested,
                             .report = pairs->report};
  result.value = BW_NEW(context, double, result.count);
  result.residual = BW_NEW(context, double, result.count);
  result.vector = BW_NEW(context, double, result.count *size);
  BW_TRY_MEMORY(result.value && result.residual && result.vector);
  memcpy(result.value, pairs->value + rigid, (size_t)result.count * sizeof(double));
  memcpy(result.residual, pairs->residual + rigid, (size_t)result.count * sizeof(double));
  BW_TRY(bw_sparse_matrix_apply(context, q->reduction.t, result.count,
                                pairs->vector + rigid * pairs->size, result.vector));
  BW_TRY(bwi_modes_from(context, model->mesh, model->material, q->rigid_count, &result, modes));
done:
  bwi_eigen_result_clear(&result);
  return status;
}

/* Modes without a density are those of density 1, to which no mass in kg can be added. */
static bw_status check_density(bw_context *context, const bw_model *model) {
  for (int a = 0; a < model->attachment_count; a++)
    if (model->attachment[a].mass > 0 && !(model->material->density > 0))
      return bw_fail(context, BW_INVALID,
                     "modes with attached masses need the density of the material \"%s\", which is "
                     "not given",
                     model->material->name);
  for (int p = 0; p < model->coupling_count; p++)
    if (bwi_point_has_mass(&model->coupling[p].point) && !(model->material->density > 0))
      return bw_fail(context, BW_INVALID,
                     "modes with the mass of a remote point need the density of the material "
                     "\"%s\", which is not given",
                     model->material->name);
  return BW_OK;
}

bw_status bw_joined_modes(bw_context *context, const bw_model *model, const bw_modes_options *given,
                          bw_modes **modes) {
  bw_status status = BW_OK;
  bwi_joined_equations q = {0};
  bw_modes_options options;
  bw_operator *m = NULL;
  bw_eigenpairs *pairs = NULL;
  double *mass = NULL;
  BW_TRY(bwi_modes_options_check(context, given, &options));
  BW_TRY(check_density(context, model));
  if (model->cyclic)
    return bwi_cyclic_modes(context, model, &options, modes);
  BW_TRY(bwi_joined_open(context, model, true, NULL, &q));
  mass = BW_NEW(context, double, q.pattern->block_count);
  BW_TRY_MEMORY(mass);
  BW_TRY(bw_mass(context, q.pattern, model->mesh, model->material, mass));
  bwi_add_attachments(model, q.pattern, 1, mass);
  BW_TRY(bwi_joined_operator(context, &q, mass, 1, "mass of the joined bodies", &m));
  BW_TRY(bwi_joined_pairs(context, &options, q.rigid_count, q.k, m, &pairs));
  BW_TRY(make_modes(context, model, &q, pairs, modes));
done:
  bwi_joined_clear(&q);
  bw_release(m);
  bw_release(pairs);
  bw_free(mass);
  return status;
}
