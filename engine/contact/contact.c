/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact on the compliance S = B G B^T of the candidates; the displacements are
 * u = u_0 + G B^T p + R a (docs/theory/contact.md). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "linear/internal.h"
#include "model/internal.h"

enum {
  ROUNDS = 500,        /* of the working set and of the springs on motions */
  MOST_MOTIONS = 6000, /* a dense matrix */
  STANDSTILL = 20 /* rounds in which springs carry the same: what they carry nothing else does */
};

static const double spring = 1e-6;               /* of the stiffness of the motions */
static const double stiffer = 100, softer = 0.1; /* from one try to the next */
static const double stiffest = 1e8;              /* of the softest springs */
static const double rounding = 1e-12;            /* of the diagonal of the mesh */
static const double settled = 1e-4; /* of a facet: motion that leaves what it faces opposite */
static const double far_away = 100; /* m */
static const double nearly =
    0.01; /* of the load, on springs: the next step takes most of it away */

void bw_contact_options_default(bw_contact_options *options) {
  *options = (bw_contact_options){.tolerance = 1e-6, .max_iterations = 30, .steps = 1};
}

/* ---- the state of a solution ----------------------------------------------------------------- */

static void problem_clear(bwi_contact_problem *c) {
  bw_release(c->system);
  bw_release(c->start);
  bwi_contact_rows_clear(&c->rows);
  bw_free(c->base);
  bw_free(c->load);
  bw_free(c->a);
  bw_free(c->q);
  bw_free(c->e);
  bw_free(c->p);
  bw_free(c->w);
  bw_free(c->now);
  bw_free(c->before);
  bw_free(c->slip);
  bw_free(c->work);
  bw_free(c->row);
  bw_free(c->member);
  bw_free(c->place);
  bw_free(c->active);
  bw_free(c->s);
  bwi_half_solves_clear(&c->halves);
  bw_free(c->pressed);
  bw_free(c->h);
}

/* The smallest size of facets that may touch. */
static double find_facet(const bwi_contact_rows *rows) {
  const bw_mesh *mesh = rows->mesh;
  const double centre[3] = {1. / 3, 1. / 3, 1. / 3};
  double least = INFINITY, normal[3];
  for (int i = 0; i < rows->pair_count; i++)
    for (int side = 0; side < (rows->pair[i].against ? 2 : 1); side++) {
      const bw_selection *facets = side ? rows->pair[i].against : rows->pair[i].on;
      for (int32_t f = 0; f < facets->facet_count; f++) {
        bwi_boundary_normal(mesh, facets->facet[f], centre, normal);
        least = fmin(least, sqrt(bw_norm(normal)));
      }
    }
  return least;
}

static bw_status prepare(bw_context *context, bwi_contact_problem *c, int pair_count,
                         const bw_contact_pair *pair, bw_system *given) {
  bw_status status = BW_OK;
  double min[3], max[3];
  for (int i = 0; i < pair_count; i++)
    c->finite = c->finite || (pair[i].against && c->options->finite_sliding);
  BW_TRY(bwi_contact_rows_create(context, c->model, pair_count, pair, c->finite, &c->rows));
  c->facet = find_facet(&c->rows);
  for (int i = 0; i < pair_count; i++)
    c->curved = c->curved || (pair[i].with && pair[i].with->kind != BW_RIGID_PLANE);
  BW_TRY(bwi_contact_bodies_open(context, c, given));
  c->count = c->rows.count;
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
  int count = c->count, rows = c->rows.row_count, m = c->motions;
  int64_t size = bwi_contact_size(c);
  c->base = BW_NEW(context, double, size);
  c->load = BW_NEW0(context, double, m);
  c->a = BW_NEW0(context, double, m);
  c->h = BW_NEW0(context, double, (int64_t)m *m);
  c->q = BW_NEW(context, double, rows);
  c->e = BW_NEW0(context, double, (int64_t)rows *m);
  c->p = BW_NEW0(context, double, rows);
  c->w = BW_NEW0(context, double, rows);
  c->now = BW_NEW(context, double, size);
  c->pressed = BW_NEW0(context, double, size);
  c->member = BW_NEW(context, int32_t, count);
  c->place = BW_NEW(context, int32_t, count);
  c->active = BW_NEW0(context, uint8_t, count);
  c->row = BW_NEW(context, int32_t, rows);
  BW_TRY_MEMORY(c->base && c->load && c->a && c->h && c->q && c->e && c->p && c->w && c->now &&
                c->pressed && c->member && c->place && c->active && c->row);
  memset(c->place, 0xff, (size_t)count * sizeof *c->place);
  if (rows > count) {
    c->before = BW_NEW0(context, double, size);
    c->slip = BW_NEW0(context, double, 3 * (int64_t)count);
    c->work = BW_NEW0(context, double, pair_count);
    BW_TRY_MEMORY(c->before && c->slip && c->work);
  }
done:
  return status;
}

/* q and E about the present normals; `gap` are the gaps of `now`. */
static bw_status linearise(bw_context *context, bwi_contact_problem *c, const double *gap) {
  bw_status status = BW_OK;
  int rows = c->rows.row_count, m = c->motions;
  double *row = BW_NEW(context, double, rows), *field = NULL, *unit = BW_NEW0(context, double, m);
  BW_TRY_MEMORY(row && unit);
  memcpy(c->q, gap, (size_t)rows * sizeof *gap);
  bwi_contact_rows_measure(&c->rows, c->now, row);
  for (int i = 0; i < c->count; i++)
    c->q[c->rows.first[i]] -= row[c->rows.first[i]];
  bwi_contact_rows_measure(&c->rows, c->base, row);
  for (int r = 0; r < rows; r++)
    c->q[r] += row[r];
  if (c->before) { /* slip is since the step before */
    bwi_contact_rows_measure(&c->rows, c->before, row);
    for (int i = 0; i < c->count; i++)
      for (int r = c->rows.first[i] + 1; r < c->rows.first[i + 1]; r++)
        c->q[r] -= row[r];
  }
  if (m > 0) {
    field = BW_NEW(context, double, bwi_contact_size(c));
    BW_TRY_MEMORY(field);
  }
  for (int k = 0; k < m; k++) {
    memset(field, 0, (size_t)bwi_contact_size(c) * sizeof *field);
    unit[k] = 1;
    bwi_contact_motions_add(c, unit, field);
    unit[k] = 0;
    bwi_contact_rows_measure(&c->rows, field, row);
    for (int i = 0; i < rows; i++)
      c->e[(int64_t)i * m + k] = row[i];
  }
done:
  bw_free(row);
  bw_free(field);
  bw_free(unit);
  return status;
}

/* ---- equations (2) to (5) -------------------------------------------------------------------- */

/* `reach` (m): a contact farther than that is not found, or INFINITY. One within far_away says it
 * all. */
static bw_status fail_unheld(bw_context *context, const bwi_contact_problem *c,
                             const double *motion, double reach) {
  char text[300], within[60] = "";
  bw_status status = bwi_contact_motions_describe(context, c, motion, text, sizeof text);
  if (status != BW_OK)
    return status;
  if (isfinite(reach))
    snprintf(within, sizeof within, " Its first %.3g m meet no surface.", fmin(reach, far_away));
  bw_fail(context, BW_UNCONSTRAINED,
          "neither supports nor contact balance the load: nothing stops the %s.%s Add a support or "
          "a contact pair that does, or turn the load%s",
          text, within, c->before ? ", or take a larger coefficient of friction" : "");
  bw_detail_text(context, "motion", text);
  return BW_UNCONSTRAINED;
}

/* A first motion of free bodies. Where normals alone do not stop it, friction may. */
static bw_status find_start(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  double volume = 0;
  int rows = c->rows.row_count, m = c->motions, count = 0;
  double *unheld = BW_NEW(context, double, m), *q = BW_NEW(context, double, rows);
  double *e = BW_NEW(context, double, (int64_t)rows *m), *area = BW_NEW(context, double, rows);
  uint8_t *pulls = BW_NEW0(context, uint8_t, rows);
  BW_TRY_MEMORY(unheld && q && e && area && pulls);
  for (int along = 0; along < 2; along++) /* normals, then tangents */
    for (int i = 0; i < c->count; i++)
      for (int r = c->rows.first[i] + along;
           r < (along ? c->rows.first[i + 1] : c->rows.first[i] + 1); r++) {
        q[count] = along ? 0 : c->q[r];
        area[count] = c->rows.area[i] > 0 ? c->rows.area[i] : 1; /* B is 0 there */
        pulls[count] = along > 0;
        memcpy(e + (int64_t)count++ * m, c->e + (int64_t)r * m, (size_t)m * sizeof *e);
      }
  for (int32_t b = 0; b < c->rows.mesh->component_count; b++)
    volume += c->system->dof_map->body_volume[b];
  bwi_rigid_start start = {.count = c->count,
                           .motions = m,
                           .q = q,
                           .e = e,
                           .area = area,
                           .pulls = pulls,
                           .load = c->load,
                           .stiffness = c->young / cbrt(volume),
                           .a = c->a,
                           .unheld = unheld};
  BW_TRY(bwi_rigid_start_find(context, &start));
  if (!start.held && rows > c->count) {
    start.count = rows;
    BW_TRY(bwi_rigid_start_find(context, &start));
  }
  if (!start.held)
    BW_TRY(fail_unheld(context, c, unheld, start.reach));
  c->softest = c->epsilon = spring * start.scale;
  if (c->options->after)
    bwi_contact_motions_measure(c, c->now, c->a);
done:
  bw_free(unheld);
  bw_free(q);
  bw_free(e);
  bw_free(area);
  bw_free(pulls);
  return status;
}

/* What the springs on the motions carry, over the load. */
static double spring_fraction(const bwi_contact_problem *c, const double *centre) {
  double carried = 0, whole = bwi_dot(c->motions, c->load, c->load);
  for (int k = 0; k < c->motions; k++) {
    double part = 0;
    for (int r = 0; r < c->rows.row_count; r++)
      part += fabs(c->p[r] * c->e[(int64_t)r * c->motions + k]);
    whole += part * part;
    part = c->epsilon * (c->a[k] - centre[k]);
    carried += part * part;
  }
  return whole > 0 ? sqrt(carried / whole) : 0;
}

/* The problem on the working set. With friction it may have no solution that Newton's method finds
 * from afar: then stiffer springs make the way shorter. */
static bw_status solve_on_springs(bw_context *context, bwi_contact_problem *c,
                                  const double *centre) {
  bw_status status = BW_OK;
  for (;; c->epsilon *= stiffer) {
    c->last_try = c->motions == 0 || !(c->epsilon < stiffest * c->softest);
    status = bwi_contact_solve_working(context, c, centre);
    if (status != BW_CONVERGENCE || c->last_try || !c->before)
      return status;
  }
}

/* Equations (2) to (5) about the present normals. */
static bw_status solve_linearised(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  int m = c->motions, added = 0, still = 0;
  double fraction = 0, before = INFINITY;
  double *centre = BW_NEW(context, double, m);
  BW_TRY_MEMORY(centre);
  for (int round = 0; round < ROUNDS; round++) {
    memcpy(centre, c->a, (size_t)m * sizeof *centre);
    bool solved = c->working > 0 || round > 0;
    if (solved)
      BW_TRY(solve_on_springs(context, c, centre));
    /* without a candidate, the load is as yet unbalanced */
    fraction = solved ? spring_fraction(c, centre) : m > 0 ? 1 : 0;
    bool balanced = fraction < 1e-4 * BWI_CONTACT_BALANCED ||
                    (fraction < BWI_CONTACT_BALANCED && fraction > 0.5 * before);
    added = 0;
    if (balanced || fraction > nearly || fraction > 0.5 * before) { /* else no look at the others */
      BW_TRY(bwi_contact_measure_all(context, c));
      BW_TRY(bwi_contact_take_deepest(context, c, &added));
    }
    if (added == 0 && balanced)
      goto done;
    still = added == 0 && fraction > 0.999 * before && c->epsilon <= c->softest ? still + 1 : 0;
    if (fraction > 0.5 * before)
      c->epsilon = fmax(c->softest, softer * c->epsilon);
    before = added > 0 ? INFINITY : fraction;
    if (c->before && still == STANDSTILL && fraction > BWI_CONTACT_BALANCED)
      break; /* it slides away */
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

/* u of the present pressures and motions; the largest change. */
static double find_displacement(bwi_contact_problem *c) {
  double moved = 0;
  for (int64_t i = 0; i < bwi_contact_size(c); i++)
    c->pressed[i] += c->base[i];
  if (c->motions > 0)
    bwi_contact_motions_add(c, c->a, c->pressed);
  for (int64_t i = 0; i < bwi_contact_size(c); i++)
    moved = fmax(moved, fabs(c->pressed[i] - c->now[i]));
  memcpy(c->now, c->pressed, (size_t)bwi_contact_size(c) * sizeof *c->now);
  return moved;
}

/* Whether the gaps are those of contact; *worst (m) and *at the candidate that is farthest off. */
static bool has_converged(const bwi_contact_problem *c, const double *gap, double *worst, int *at) {
  *worst = 0;
  *at = 0;
  for (int i = 0; i < c->count; i++) {
    if (!(c->rows.area[i] > 0))
      continue;
    double mean = gap[c->rows.first[i]] / c->rows.area[i];
    double off = c->p[c->rows.first[i]] > 0 ? fabs(mean) : fmax(-mean, 0);
    if (off > *worst) {
      *worst = off;
      *at = i;
    }
  }
  return *worst <= fmax(c->options->tolerance * c->elastic, c->rounded);
}

/* The loads of this step. */
static bw_status solve_step(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  bool stays = false;
  double worst = 0;
  int at = 0;
  double *gap = BW_NEW(context, double, c->rows.row_count);
  BW_TRY_MEMORY(gap);
  BW_TRY(bwi_contact_rows_linearise(context, &c->rows, c->now, gap));
  for (int i = 1; i <= c->options->max_iterations; i++) {
    c->iterations++;
    BW_TRY(linearise(context, c, gap));
    if (c->iterations > 1 && (c->curved || c->finite))
      BW_TRY(bwi_contact_renew(context, c));
    else if (c->iterations == 1 && c->motions > 0)
      BW_TRY(find_start(context, c));
    BW_TRY(solve_linearised(context, c));
    stays = find_displacement(c) <= settled * c->facet;
    if (c->finite && !c->curved && stays)
      goto done;
    BW_TRY(bwi_contact_rows_linearise(context, &c->rows, c->now, gap));
    if (c->finite && !stays)
      continue;
    if (!c->curved || has_converged(c, gap, &worst, &at))
      goto done;
  }
  if (c->finite && !stays)
    BW_TRY(bw_fail(context, BW_CONVERGENCE,
                   "contact in finite sliding does not come to rest in %d iterations of step %d: "
                   "what faces what keeps changing. Take more steps",
                   c->options->max_iterations, c->step));
  const double *x = c->rows.mesh->node + 3 * (int64_t)c->rows.node[at];
  status =
      bw_fail(context, BW_CONVERGENCE,
              "contact does not converge in %d iterations of step %d: pair %d is %.3g m off "
              "its surface at (%g, %g, %g). The part may slide far on it: take more steps, "
              "or support it against rolling",
              c->options->max_iterations, c->step, c->rows.of[at] + 1, worst, x[0], x[1], x[2]);
done:
  bw_free(gap);
  return status;
}

/* Adds the slip of a step, and the work of the tractions at its end on it. */
static bw_status take_slip(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  double *after = BW_NEW(context, double, c->rows.row_count);
  double *row = BW_NEW(context, double, c->rows.row_count);
  BW_TRY_MEMORY(after && row);
  bwi_contact_rows_measure(&c->rows, c->now, after);
  bwi_contact_rows_measure(&c->rows, c->before, row);
  for (int i = 0; i < c->count; i++) {
    int32_t r = c->rows.first[i];
    for (int k = 1; k < c->rows.first[i + 1] - r && c->place[i] >= 0; k++) {
      double moved = after[r + k] - row[r + k];
      if (c->active[c->place[i]] != BWI_SLIPS)
        continue;
      c->work[c->rows.of[i]] -= c->p[r + k] * moved;
      for (int l = 0; l < 3; l++)
        c->slip[3 * (int64_t)i + l] +=
            moved / c->rows.area[i] * c->rows.tangent[6 * (int64_t)i + 3 * (k - 1) + l];
    }
  }
  memcpy(c->before, c->now, (size_t)bwi_contact_size(c) * sizeof *c->now);
done:
  bw_free(after);
  bw_free(row);
  return status;
}

static bool same_material(const bw_mesh *mesh, const bw_material *a, const bw_material *b) {
  for (int64_t e = 0; a != b && e < mesh->element_count; e++)
    if (!bwi_same_stiffness(bw_material_of(a, e), bw_material_of(b, e)))
      return false;
  return true;
}

/* Where the path of the loads begins: at rest, or after another contact. */
static bw_status begin(bw_context *context, bwi_contact_problem *c) {
  const bw_contact *after = c->options->after;
  if (!after) {
    memcpy(c->now, c->start->displacement, (size_t)bwi_contact_size(c) * sizeof *c->now);
    for (int64_t i = 0; i < bwi_contact_size(c); i++)
      c->now[i] /= c->options->steps;
    return BW_OK;
  }
  if (after->model->mesh != c->model->mesh || after->pair_count != c->rows.pair_count)
    return bw_fail(context, BW_INVALID,
                   "contact after another needs its mesh and its %d contact pair%s",
                   after->pair_count, after->pair_count == 1 ? "" : "s");
  for (int i = 0; i < after->pair_count; i++)
    if (after->pair[i].on != c->rows.pair[i].on ||
        after->pair[i].against != c->rows.pair[i].against)
      return bw_fail(context, BW_INVALID,
                     "contact pair %d is of other facets than in the contact that it follows: give "
                     "the same selections",
                     i + 1);
  if (!c->before || !after->start)
    return bw_fail(context, BW_INVALID,
                   "contact follows another where both have friction: without it the path of the "
                   "loads does not matter");
  if (!same_material(c->model->mesh, after->start->system->material, c->system->material))
    return bw_fail(context, BW_INVALID,
                   "contact follows another of a part of the same material: this one has another");
  if (!bwi_same_supports(after->start->system->dof_map, c->system->dof_map))
    return bw_fail(context, BW_INVALID,
                   "contact follows another of a part with the same supports: these have changed. "
                   "Prescribe other displacements of the same nodes, or change the loads");
  if (!bwi_joined_parts_same(after->joined, c->joined))
    return bw_fail(context, BW_INVALID,
                   "contact follows another of a part with the same bonds, springs and couplings: "
                   "these have changed. Give the shortening of a bolt from the first contact on");
  memcpy(c->now, after->solution->displacement, (size_t)bwi_contact_size(c) * sizeof *c->now);
  memcpy(c->before, c->now, (size_t)bwi_contact_size(c) * sizeof *c->now);
  memcpy(c->work, after->work, (size_t)after->pair_count * sizeof *c->work);
  memcpy(c->slip, after->corner_slip, 3 * (size_t)c->count * sizeof *c->slip);
  return BW_OK;
}

/* The loads grow in proportion from those before. */
static bw_status solve_contact(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  const bw_static *from = c->options->after ? c->options->after->start : NULL;
  double *load = BW_NEW0(context, double, c->motions),
         *first = BW_NEW0(context, double, c->motions);
  BW_TRY_MEMORY(load && first);
  BW_TRY(begin(context, c));
  if (c->motions > 0) {
    bwi_contact_motions_dot(c, c->start->force, load);
    if (from)
      bwi_contact_motions_dot(c, from->force, first);
  }
  for (c->step = 1; c->step <= c->options->steps; c->step++) {
    double part = (double)c->step / c->options->steps, rest = 1 - part;
    for (int64_t i = 0; i < bwi_contact_size(c); i++)
      c->base[i] = part * c->start->displacement[i] + (from ? rest * from->displacement[i] : 0);
    for (int k = 0; k < c->motions; k++)
      c->load[k] = part * load[k] + rest * first[k];
    BW_TRY(solve_step(context, c));
    if (c->before)
      BW_TRY(take_slip(context, c));
  }
done:
  bw_free(load);
  bw_free(first);
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
  if (options->steps < 1)
    return bw_fail(context, BW_INVALID, "contact has %d steps; it needs 1 or more", options->steps);
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
