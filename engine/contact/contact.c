/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact without friction on the compliance S = B G B^T of the candidates, whose displacements are
 * u = u_0 + G B^T p + R a (docs/theory/contact.md). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "model/internal.h"

enum {
  ROUNDS = 500,       /* of the working set and of the springs on motions */
  MOST_MOTIONS = 6000 /* a dense matrix */
};

static const double spring = 1e-6;    /* of the stiffness of the motions */
static const double rounding = 1e-12; /* of the diagonal of the mesh */

void bw_contact_options_default(bw_contact_options *options) {
  *options = (bw_contact_options){.tolerance = 1e-6, .max_iterations = 30};
}

/* ---- the state of a solution ----------------------------------------------------------------- */

static void problem_clear(bwi_contact_problem *c) {
  bw_release(c->system);
  bw_release(c->start);
  bwi_contact_rows_clear(&c->rows);
  bw_free(c->load);
  bw_free(c->a);
  bw_free(c->q);
  bw_free(c->e);
  bw_free(c->p);
  bw_free(c->w);
  bw_free(c->now);
  bw_free(c->member);
  bw_free(c->place);
  bw_free(c->active);
  bw_free(c->column);
  bw_free(c->h);
}

static bw_status prepare(bw_context *context, bwi_contact_problem *c, int pair_count,
                         const bw_contact_pair *pair, bw_system *given) {
  bw_status status = BW_OK;
  bw_statics_options without = {.inertia_relief = true, .tolerance = 1e-6};
  double min[3], max[3];
  BW_TRY(bwi_contact_rows_create(context, c->model->mesh, pair_count, pair, &c->rows));
  for (int i = 0; i < pair_count; i++)
    c->curved = c->curved || (pair[i].with && pair[i].with->kind != BW_RIGID_PLANE);
  BW_TRY(bw_system_of_model(context, c->model, c->options->solver, given, &c->system));
  BW_TRY(bw_statics(context, c->model, c->system, &without, &c->start));
  c->count = c->rows.count;
  c->motions = c->system->dof_map->rigid_mode_count;
  bw_mesh_box(c->model->mesh, min, max);
  for (int k = 0; k < 3; k++)
    max[k] -= min[k];
  c->rounded = rounding * bw_norm(max);
  c->young = bw_material_of(c->model->material, 0)->elasticity[0];
  if (c->motions > MOST_MOTIONS)
    BW_TRY(bw_fail(context, BW_LIMIT,
                   "%d rigid-body modes are free, and contact takes at most %d: add supports, or "
                   "join bodies in the mesh",
                   c->motions, (int)MOST_MOTIONS));
  int count = c->count, m = c->motions;
  c->load = BW_NEW0(context, double, m);
  c->a = BW_NEW0(context, double, m);
  c->h = BW_NEW0(context, double, (int64_t)m *m);
  c->q = BW_NEW(context, double, count);
  c->e = BW_NEW0(context, double, (int64_t)count *m);
  c->p = BW_NEW0(context, double, count);
  c->w = BW_NEW0(context, double, count);
  c->now = BW_NEW(context, double, bwi_contact_size(c));
  c->member = BW_NEW(context, int32_t, count);
  c->place = BW_NEW(context, int32_t, count);
  c->active = BW_NEW0(context, uint8_t, count);
  BW_TRY_MEMORY(c->load && c->a && c->h && c->q && c->e && c->p && c->w && c->now && c->member &&
                c->place && c->active);
  memcpy(c->now, c->start->displacement, (size_t)bwi_contact_size(c) * sizeof *c->now);
  memset(c->place, 0xff, (size_t)count * sizeof *c->place);
  if (m > 0)
    bw_rigid_modes_dot(c->system->dof_map, c->start->force, c->load);
done:
  return status;
}

/* q and E about the present normals; `gap` are the gaps of `now`. */
static bw_status linearise(bw_context *context, bwi_contact_problem *c, const double *gap) {
  bw_status status = BW_OK;
  int count = c->count, m = c->motions;
  double *row = BW_NEW(context, double, count), *field = NULL, *unit = BW_NEW0(context, double, m);
  BW_TRY_MEMORY(row && unit);
  memcpy(c->q, gap, (size_t)count * sizeof *gap);
  bwi_contact_rows_measure(&c->rows, c->now, row);
  for (int i = 0; i < count; i++)
    c->q[i] -= row[i];
  bwi_contact_rows_measure(&c->rows, c->start->displacement, row);
  for (int i = 0; i < count; i++)
    c->q[i] += row[i];
  if (m > 0) {
    field = BW_NEW(context, double, bwi_contact_size(c));
    BW_TRY_MEMORY(field);
  }
  for (int k = 0; k < m; k++) {
    memset(field, 0, (size_t)bwi_contact_size(c) * sizeof *field);
    unit[k] = 1;
    bw_rigid_modes_add(c->system->dof_map, unit, field);
    unit[k] = 0;
    bwi_contact_rows_measure(&c->rows, field, row);
    for (int i = 0; i < count; i++)
      c->e[(int64_t)i * m + k] = row[i];
  }
done:
  bw_free(row);
  bw_free(field);
  bw_free(unit);
  return status;
}

/* ---- equations (2) to (5) -------------------------------------------------------------------- */

/* `reach` (m): a contact farther than that is not found, or INFINITY. */
static bw_status fail_unheld(bw_context *context, const bwi_contact_problem *c,
                             const double *motion, double reach) {
  char text[300], within[40] = "";
  bwi_describe_motion(c->system->dof_map, motion, text, sizeof text);
  if (isfinite(reach))
    snprintf(within, sizeof within, " within %.3g m", reach);
  bw_fail(context, BW_UNCONSTRAINED,
          "neither supports nor contact balance the load: nothing stops the %s%s. Add a support or "
          "a contact pair that does, or turn the load",
          text, within);
  bw_detail_text(context, "motion", text);
  return BW_UNCONSTRAINED;
}

/* A first motion of free bodies. */
static bw_status find_start(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  double volume = 0;
  double *unheld = BW_NEW(context, double, c->motions);
  BW_TRY_MEMORY(unheld);
  for (int32_t b = 0; b < c->rows.mesh->component_count; b++)
    volume += c->system->dof_map->body_volume[b];
  bwi_rigid_start start = {.count = c->count,
                           .motions = c->motions,
                           .q = c->q,
                           .e = c->e,
                           .area = c->rows.area,
                           .load = c->load,
                           .stiffness = c->young / cbrt(volume),
                           .a = c->a,
                           .unheld = unheld};
  BW_TRY(bwi_rigid_start_find(context, &start));
  if (!start.held)
    BW_TRY(fail_unheld(context, c, unheld, start.reach));
  c->epsilon = spring * start.scale;
done:
  bw_free(unheld);
  return status;
}

/* What the springs on the motions carry, over the load. */
static double spring_fraction(const bwi_contact_problem *c, const double *centre) {
  double carried = 0, whole = bwi_dot(c->motions, c->load, c->load);
  for (int k = 0; k < c->motions; k++) {
    double part = 0;
    for (int i = 0; i < c->count; i++)
      part += fabs(c->p[i] * c->e[(int64_t)i * c->motions + k]);
    whole += part * part;
    part = c->epsilon * (c->a[k] - centre[k]);
    carried += part * part;
  }
  return whole > 0 ? sqrt(carried / whole) : 0;
}

/* Equations (2) to (5) about the present normals. */
static bw_status solve_linearised(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  int m = c->motions, added = 0;
  double fraction = 0, before = INFINITY;
  double *centre = BW_NEW(context, double, m);
  BW_TRY_MEMORY(centre);
  for (int round = 0; round < ROUNDS; round++) {
    memcpy(centre, c->a, (size_t)m * sizeof *centre);
    if (round == 0 && c->working == 0)
      for (int i = 0; i < c->count; i++)
        c->w[i] = c->q[i] + bwi_dot(m, c->e + (int64_t)i * m, c->a);
    else
      BW_TRY(bwi_contact_solve_working(context, c, centre));
    BW_TRY(bwi_contact_take_deepest(context, c, &added));
    /* without a candidate, the load is as yet unbalanced */
    fraction = c->working > 0 || round > 0 ? spring_fraction(c, centre) : m > 0 ? 1 : 0;
    if (added == 0 && (fraction < 1e-4 * BWI_CONTACT_BALANCED ||
                       (fraction < BWI_CONTACT_BALANCED && fraction > 0.5 * before)))
      goto done;
    before = added > 0 ? INFINITY : fraction;
  }
  for (int k = 0; k < m; k++)
    centre[k] = c->a[k] - centre[k];
  if (added == 0 && fraction > BWI_CONTACT_BALANCED)
    BW_TRY(fail_unheld(context, c, centre, INFINITY));
  if (added == 0)
    BW_TRY(bw_fail(context, BW_CONVERGENCE,
                   "after %d rounds the position of free bodies still moves: the fraction %.3g of "
                   "the load is not yet on the contact",
                   (int)ROUNDS, fraction));
  BW_TRY(bw_fail(context, BW_CONVERGENCE, "after %d rounds %d candidates still enter the contact",
                 (int)ROUNDS, added));
done:
  bw_free(centre);
  return status;
}

/* u of the present pressures and motions. */
static bw_status find_displacement(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  bwi_contact_rows_force(&c->rows, c->p, c->now);
  BW_TRY(bw_system_solve(context, c->system, 1, c->now, c->now));
  c->solves++;
  for (int64_t i = 0; i < bwi_contact_size(c); i++)
    c->now[i] += c->start->displacement[i];
  if (c->motions > 0)
    bw_rigid_modes_add(c->system->dof_map, c->a, c->now);
done:
  return status;
}

/* Whether the gaps are those of contact; *worst (m) and *at the candidate that is farthest off. */
static bool has_converged(const bwi_contact_problem *c, const double *gap, double *worst, int *at) {
  *worst = 0;
  *at = 0;
  for (int i = 0; i < c->count; i++) {
    double mean = gap[i] / c->rows.area[i], off = c->p[i] > 0 ? fabs(mean) : fmax(-mean, 0);
    if (off > *worst) {
      *worst = off;
      *at = i;
    }
  }
  return *worst <= fmax(c->options->tolerance * c->elastic, c->rounded);
}

static bw_status solve_contact(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  double worst = 0;
  int at = 0;
  double *gap = BW_NEW(context, double, c->count);
  BW_TRY_MEMORY(gap);
  bwi_contact_rows_linearise(&c->rows, c->now, gap);
  for (c->iterations = 1; c->iterations <= c->options->max_iterations; c->iterations++) {
    BW_TRY(linearise(context, c, gap));
    if (c->iterations > 1)
      BW_TRY(bwi_contact_renew(context, c));
    else if (c->motions > 0)
      BW_TRY(find_start(context, c));
    BW_TRY(solve_linearised(context, c));
    BW_TRY(find_displacement(context, c));
    bwi_contact_rows_linearise(&c->rows, c->now, gap);
    if (!c->curved || has_converged(c, gap, &worst, &at))
      goto done;
  }
  const double *x = c->rows.mesh->node + 3 * (int64_t)c->rows.node[at];
  status = bw_fail(context, BW_CONVERGENCE,
                   "contact does not converge in %d iterations: pair %d is %.3g m off its surface "
                   "at (%g, %g, %g). Contact is for small sliding: the part may slide far on the "
                   "curved surface",
                   c->options->max_iterations, c->rows.of[at] + 1, worst, x[0], x[1], x[2]);
done:
  bw_free(gap);
  return status;
}

/* ---- together -------------------------------------------------------------------------------- */

static bw_status check_options(bw_context *context, int pair_count,
                               const bw_contact_options *options) {
  if (pair_count < 1)
    return bw_fail(context, BW_INVALID, "contact needs a pair");
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance of contact is %g; it is above 0 and below 1",
                   options->tolerance);
  if (options->max_iterations < 1)
    return bw_fail(context, BW_INVALID, "contact has %d iterations; it needs 1 or more",
                   options->max_iterations);
  if (options->solver && options->solver->options.backend == BW_BACKEND_PETSC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "contact is not implemented by the external solver: give bw.solver.cholesky or "
                   "bw.solver.pcg");
  return BW_OK;
}

bw_status bw_contact_solve(bw_context *context, const bw_model *model, int pair_count,
                           const bw_contact_pair *pair, bw_system *given,
                           const bw_contact_options *given_options, bw_contact **contact) {
  bw_status status = BW_OK;
  bw_contact_options options;
  double start = bw_seconds();
  bw_contact_options_default(&options);
  if (given_options)
    options = *given_options;
  bwi_contact_problem c = {.model = model, .options = &options};
  BW_TRY(check_options(context, pair_count, &options));
  BW_TRY(prepare(context, &c, pair_count, pair, given));
  BW_TRY(solve_contact(context, &c));
  BW_TRY(bwi_contact_take_result(context, &c, contact));
  (*contact)->report.seconds = bw_seconds() - start;
done:
  problem_clear(&c);
  return status;
}
