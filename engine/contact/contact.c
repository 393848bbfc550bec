/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact without friction on the compliance of the candidates (docs/theory/contact.md).
 *
 * u = u_0 + G B^T p + R a. A column of S = B G B^T is computed for candidates of the working set
 * alone, at all candidates. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"
#include "model/internal.h"
#include "statics/internal.h"

enum {
  SIDES = 16,            /* right-hand sides at once */
  AT_ONCE = 32,          /* candidates that may enter the working set in a round at least */
  ROUNDS = 500,          /* of the working set and of the springs on motions */
  MOST_CANDIDATES = 8000 /* in the working set: a dense matrix */
};

static const double spring = 1e-6;    /* of the stiffness of the motions */
static const double held = 1e-8;      /* of the compliance of a free surface: supports hold it */
static const double small_gap = 1e-8; /* of the elastic displacement: penetration that is none */
static const double undecided = 1e-9; /* of the stiffest motion */
static const double balanced = 1e-6;  /* of the load: what springs may carry in the end */
static const double large_rotation = 0.05;
static const double coarse = 0.25; /* of the elastic displacement: penetration that is too much */

void bw_contact_options_default(bw_contact_options *options) {
  *options = (bw_contact_options){.tolerance = 1e-6, .max_iterations = 30};
}

static void contact_destroy(void *object) {
  bw_contact *contact = object;
  for (int i = 0; i < contact->pair_count && contact->pair; i++) {
    bw_release(contact->pair[i].on);
    bw_release(contact->pair[i].with);
    bw_release(contact->pair[i].against);
  }
  bw_release(contact->model);
  bw_release(contact->solution);
  bw_free(contact->pair);
  bw_free(contact->state);
  bw_free(contact->pressure);
  bw_free(contact->gap);
  bw_free(contact->free_text);
  bw_free(contact);
}

static size_t contact_bytes(const void *object) {
  const bw_contact *contact = object;
  return sizeof *contact + 2 * (size_t)contact->model->mesh->node_count * sizeof(double) +
         (size_t)contact->pair_count * (sizeof *contact->pair + sizeof *contact->state);
}

static const bw_kind contact_kind = {"contact", contact_destroy, contact_bytes};

/* ---- the state of a solution ----------------------------------------------------------------- */

typedef struct contact_problem {
  const bw_model *model;
  const bw_contact_options *options;
  bw_system *system;
  bw_static *start; /* u_0 */
  bwi_contact_rows rows;
  int count, motions;
  bool curved;
  double young;    /* of the first element, to tell sizes */
  double *load;    /* (motions) R^T f */
  double *a;       /* (motions) */
  double *q;       /* (count) gaps of u_0 */
  double *e;       /* (count x motions) */
  double *p;       /* (count) */
  double *w;       /* (count) gaps */
  double *now;     /* (node_count x 3) u */
  int working;     /* candidates in the working set, */
  int32_t *member; /* (count) which, */
  int32_t *place;  /* (count) their place in it, or -1, */
  uint8_t *active; /* (count) by place, */
  double *column;  /* (capacity x count) and their columns of S */
  int capacity;
  double elastic; /* the largest mean displacement that pressure causes at a candidate */
  double epsilon;
  double *h; /* (motions x motions) */
  int iterations, changes, solves;
} contact_problem;

static void problem_clear(contact_problem *c) {
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

static int64_t size_of(const contact_problem *c) {
  return 3 * (int64_t)c->model->mesh->node_count;
}

static bw_status prepare(bw_context *context, contact_problem *c, int pair_count,
                         const bw_contact_pair *pair, bw_system *given) {
  bw_status status = BW_OK;
  bw_statics_options without = {.inertia_relief = true, .tolerance = 1e-6};
  BW_TRY(bwi_contact_rows_create(context, c->model->mesh, pair_count, pair, &c->rows));
  for (int i = 0; i < pair_count; i++)
    c->curved = c->curved || (pair[i].with && pair[i].with->kind != BW_RIGID_PLANE);
  BW_TRY(bw_system_of_model(context, c->model, c->options->solver, given, &c->system));
  BW_TRY(bw_statics(context, c->model, c->system, &without, &c->start));
  c->count = c->rows.count;
  c->motions = c->system->dof_map->rigid_mode_count;
  c->young = bw_material_of(c->model->material, 0)->elasticity[0];
  int count = c->count, m = c->motions;
  c->load = BW_NEW0(context, double, m);
  c->a = BW_NEW0(context, double, m);
  c->h = BW_NEW0(context, double, m *m);
  c->q = BW_NEW(context, double, count);
  c->e = BW_NEW0(context, double, (int64_t)count *m);
  c->p = BW_NEW0(context, double, count);
  c->w = BW_NEW0(context, double, count);
  c->now = BW_NEW(context, double, size_of(c));
  c->member = BW_NEW(context, int32_t, count);
  c->place = BW_NEW(context, int32_t, count);
  c->active = BW_NEW0(context, uint8_t, count);
  BW_TRY_MEMORY(c->load && c->a && c->h && c->q && c->e && c->p && c->w && c->now && c->member &&
                c->place && c->active);
  memcpy(c->now, c->start->displacement, (size_t)size_of(c) * sizeof *c->now);
  memset(c->place, 0xff, (size_t)count * sizeof *c->place);
  if (m > 0)
    bw_rigid_modes_dot(c->system->dof_map, c->start->force, c->load);
done:
  return status;
}

/* q and E about the present normals; `gap` are the gaps of `now`. */
static bw_status linearise(bw_context *context, contact_problem *c, const double *gap) {
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
    field = BW_NEW(context, double, size_of(c));
    BW_TRY_MEMORY(field);
  }
  for (int k = 0; k < m; k++) {
    memset(field, 0, (size_t)size_of(c) * sizeof *field);
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

/* ---- the working set ------------------------------------------------------------------------- */

/* Columns of S from `first` on. */
static bw_status compute_columns(bw_context *context, contact_problem *c, int first) {
  bw_status status = BW_OK;
  int64_t size = size_of(c);
  double *block = BW_NEW(context, double, SIDES *size);
  BW_TRY_MEMORY(block);
  for (; first < c->working; first += SIDES) {
    int part = c->working - first < SIDES ? c->working - first : SIDES;
    BW_TRY(bw_check_cancel(context));
    bw_progress(context, "contact", (double)first / c->working);
    bwi_contact_rows_columns(&c->rows, part, c->member + first, block);
    BW_TRY(bw_system_solve(context, c->system, part, block, block));
    c->solves += part;
    for (int k = 0; k < part; k++)
      bwi_contact_rows_measure(&c->rows, block + k * size,
                               c->column + (int64_t)(first + k) * c->count);
  }
done:
  bw_free(block);
  return status;
}

static bw_status extend(bw_context *context, contact_problem *c, int added, const int32_t *which) {
  bw_status status = BW_OK;
  int first = c->working;
  if (first + added > MOST_CANDIDATES)
    BW_TRY(
        bw_fail(context, BW_LIMIT,
                "more than %d corners of facets are in contact: select fewer facets, or make the "
                "mesh coarser there",
                (int)MOST_CANDIDATES));
  if (first + added > c->capacity) {
    int capacity = first + added > 2 * c->capacity ? first + added : 2 * c->capacity;
    double *larger = BW_NEW(context, double, (int64_t)capacity * c->count);
    BW_TRY_MEMORY(larger);
    if (first > 0)
      memcpy(larger, c->column, (size_t)first * (size_t)c->count * sizeof *larger);
    bw_free(c->column);
    c->column = larger;
    c->capacity = capacity;
  }
  for (int k = 0; k < added; k++) {
    c->member[c->working] = which[k];
    c->active[c->working] = 1;
    c->place[which[k]] = c->working++;
  }
  c->changes += added;
  BW_TRY(compute_columns(context, c, first));
  for (int k = first; k < c->working; k++) {
    int32_t i = c->member[k];
    double area = c->rows.area[i], softness = area * sqrt(area) / c->young;
    const double *x = c->rows.mesh->node + 3 * (int64_t)c->rows.node[i];
    if (c->column[(int64_t)k * c->count + i] > held * softness)
      continue;
    status =
        bw_fail(context, BW_INVALID,
                "contact pair %d penetrates by %.3g m at (%g, %g, %g), where supports hold the "
                "body: take the supported facets out of the pair, or move the surface",
                c->rows.of[i] + 1, -c->w[i] / area, x[0], x[1], x[2]);
    goto done;
  }
done:
  return status;
}

typedef struct deep {
  double gap;
  int32_t candidate;
} deep;

static int deeper(const void *a, const void *b) {
  const deep *x = a, *y = b;
  if (x->gap != y->gap)
    return x->gap < y->gap ? -1 : 1;
  return x->candidate < y->candidate ? -1 : 1;
}

/* Takes in the deepest of those outside that penetrate by more than `slack`; *added: how many. */
static bw_status take_deepest(bw_context *context, contact_problem *c, double slack, int *added) {
  bw_status status = BW_OK;
  int found = 0, most = c->working > AT_ONCE ? c->working : AT_ONCE;
  deep *list = BW_NEW(context, deep, c->count);
  int32_t *which = BW_NEW(context, int32_t, c->count);
  BW_TRY_MEMORY(list && which);
  for (int i = 0; i < c->count; i++)
    if (c->place[i] < 0 && c->w[i] < -slack * c->rows.area[i])
      list[found++] = (deep){c->w[i] / c->rows.area[i], i};
  qsort(list, (size_t)found, sizeof *list, deeper);
  *added = found < most ? found : most;
  for (int k = 0; k < *added; k++)
    which[k] = list[k].candidate;
  BW_TRY(*added > 0 ? extend(context, c, *added, which) : BW_OK);
done:
  bw_free(list);
  bw_free(which);
  return status;
}

/* Keeps those that carry pressure, with columns of the present normals. */
static bw_status renew(bw_context *context, contact_problem *c) {
  int kept = 0;
  for (int k = 0; k < c->working; k++) {
    int32_t i = c->member[k];
    c->place[i] = -1;
    if (c->p[i] > 0) {
      c->place[i] = kept;
      c->active[kept] = 1;
      c->member[kept++] = i;
    }
  }
  c->working = kept;
  return compute_columns(context, c, 0);
}

/* ---- equations (2) to (5) -------------------------------------------------------------------- */

/* The problem on the working set, and the gaps of all candidates. */
static bw_status solve_working(bw_context *context, contact_problem *c, const double *centre) {
  bw_status status = BW_OK;
  int n = c->working, m = c->motions, count = c->count;
  double *s = BW_NEW(context, double, (int64_t)n *n), *q = BW_NEW(context, double, n);
  double *e = BW_NEW(context, double, (int64_t)n *m), *slack = BW_NEW(context, double, n);
  double *p = BW_NEW(context, double, n), *w = BW_NEW(context, double, n);
  BW_TRY_MEMORY(s && q && e && slack && p && w);
  for (int k = 0; k < n; k++) {
    int32_t i = c->member[k];
    for (int l = 0; l < n; l++) /* the mean of the two that rounding tells apart */
      s[(int64_t)k * n + l] =
          0.5 * (c->column[(int64_t)k * count + c->member[l]] + c->column[(int64_t)l * count + i]);
    q[k] = c->q[i];
    memcpy(e + (int64_t)k * m, c->e + (int64_t)i * m, (size_t)m * sizeof *e);
    slack[k] = 0.1 * small_gap * c->elastic * c->rows.area[i];
  }
  bwi_complementarity problem = {.count = n,
                                 .motions = m,
                                 .s = s,
                                 .q = q,
                                 .e = e,
                                 .load = c->load,
                                 .centre = centre,
                                 .epsilon = c->epsilon,
                                 .slack = slack,
                                 .active = c->active,
                                 .p = p,
                                 .w = w,
                                 .a = c->a,
                                 .h = c->h};
  BW_TRY(bwi_complementarity_solve(context, &problem));
  c->changes += problem.changes;
  memset(c->p, 0, (size_t)count * sizeof *c->p);
  for (int i = 0; i < count; i++)
    c->w[i] = 0;
  for (int k = 0; k < n; k++) {
    c->p[c->member[k]] = p[k];
    for (int i = 0; p[k] > 0 && i < count; i++)
      c->w[i] += p[k] * c->column[(int64_t)k * count + i];
  }
  c->elastic = 0;
  for (int i = 0; i < count; i++) {
    c->elastic = fmax(c->elastic, fabs(c->w[i]) / c->rows.area[i]);
    c->w[i] += c->q[i] + bwi_dot(m, c->e + (int64_t)i * m, c->a);
  }
done:
  bw_free(s);
  bw_free(q);
  bw_free(e);
  bw_free(slack);
  bw_free(p);
  bw_free(w);
  return status;
}

static bw_status fail_unheld(bw_context *context, const contact_problem *c, const double *motion) {
  char text[300];
  bwi_describe_motion(c->system->dof_map, motion, text, sizeof text);
  bw_fail(context, BW_UNCONSTRAINED,
          "neither supports nor contact balance the load: nothing stops the %s. Add a support or a "
          "contact pair that does, or turn the load",
          text);
  bw_detail_text(context, "motion", text);
  return BW_UNCONSTRAINED;
}

/* A first motion of free bodies. */
static bw_status find_start(bw_context *context, contact_problem *c) {
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
    BW_TRY(fail_unheld(context, c, unheld));
  c->epsilon = spring * start.scale;
done:
  bw_free(unheld);
  return status;
}

/* What the springs on the motions carry, over the load. */
static double spring_fraction(const contact_problem *c, const double *centre) {
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
static bw_status solve_linearised(bw_context *context, contact_problem *c) {
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
      BW_TRY(solve_working(context, c, centre));
    BW_TRY(take_deepest(context, c, small_gap * c->elastic, &added));
    fraction = c->working > 0 ? spring_fraction(c, centre) : 0;
    if (added == 0 &&
        (fraction < 1e-4 * balanced || (fraction < balanced && fraction > 0.5 * before)))
      goto done;
    before = added > 0 ? INFINITY : fraction;
  }
  for (int k = 0; k < m; k++)
    centre[k] = c->a[k] - centre[k];
  if (added == 0 && fraction > balanced)
    BW_TRY(fail_unheld(context, c, centre));
  BW_TRY(bw_fail(context, BW_CONVERGENCE, "after %d rounds %d candidates still enter the contact",
                 (int)ROUNDS, added));
done:
  bw_free(centre);
  return status;
}

/* u of the present pressures and motions. */
static bw_status find_displacement(bw_context *context, contact_problem *c) {
  bw_status status = BW_OK;
  bwi_contact_rows_force(&c->rows, c->p, c->now);
  BW_TRY(bw_system_solve(context, c->system, 1, c->now, c->now));
  c->solves++;
  for (int64_t i = 0; i < size_of(c); i++)
    c->now[i] += c->start->displacement[i];
  if (c->motions > 0)
    bw_rigid_modes_add(c->system->dof_map, c->a, c->now);
done:
  return status;
}

/* Whether the gaps are those of contact; *worst (m) and *at the candidate that is farthest off. */
static bool has_converged(const contact_problem *c, const double *gap, double *worst, int *at) {
  double largest = 0;
  *worst = 0;
  *at = 0;
  for (int i = 0; i < c->count; i++) {
    double mean = gap[i] / c->rows.area[i], off = c->p[i] > 0 ? fabs(mean) : fmax(-mean, 0);
    largest = fmax(largest, bw_norm(c->now + 3 * (int64_t)c->rows.node[i]));
    if (off > *worst) {
      *worst = off;
      *at = i;
    }
  }
  return *worst <= c->options->tolerance * largest;
}

static bw_status solve_contact(bw_context *context, contact_problem *c) {
  bw_status status = BW_OK;
  double worst = 0;
  int at = 0;
  double *gap = BW_NEW(context, double, c->count);
  BW_TRY_MEMORY(gap);
  bwi_contact_rows_linearise(&c->rows, c->now, gap);
  for (c->iterations = 1; c->iterations <= c->options->max_iterations; c->iterations++) {
    BW_TRY(linearise(context, c, gap));
    if (c->iterations > 1)
      BW_TRY(renew(context, c));
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

/* ---- the result ------------------------------------------------------------------------------ */

/* The static solution of the model with the forces of contact, at the place that contact gives. */
static bw_status take_solution(bw_context *context, contact_problem *c, bw_contact *out) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = c->system->dof_map;
  bw_statics_options options = {.tolerance = 10 * balanced};
  bw_model *loaded = NULL;
  bw_array *force = NULL;
  double *a = BW_NEW(context, double, c->motions);
  bool closed = false;
  BW_TRY_MEMORY(a);
  for (int i = 0; i < c->count; i++)
    closed = closed || c->p[i] > 0;
  BW_TRY(bw_model_moved(context, c->model, c->model->mesh, &loaded));
  BW_TRY(bw_array_create(context, BW_F64, c->model->mesh->node_count, 3, &force));
  bwi_contact_rows_force(&c->rows, c->p, force->data);
  if (closed)
    BW_TRY(bw_model_nodal_forces(context, loaded, force));
  BW_TRY(bw_statics(context, loaded, c->system, &options, &out->solution));
  if (c->motions > 0) { /* which differ by a rigid-body motion */
    double *u = out->solution->displacement;
    for (int64_t i = 0; i < size_of(c); i++)
      c->now[i] -= u[i];
    bw_rigid_modes_measure(dof_map, c->now, a);
    bw_rigid_modes_add(dof_map, a, u);
  }
  memcpy(c->now, out->solution->displacement, (size_t)size_of(c) * sizeof *c->now);
done:
  bw_release(force);
  bw_release(loaded);
  bw_free(a);
  return status;
}

static void take_pressure(const contact_problem *c, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int i = 0; i < c->count; i++)
    out->pressure[c->rows.node[i]] += c->p[i];
  for (int pair = 0; pair < out->pair_count; pair++) {
    const bw_selection *on = out->pair[pair].on;
    for (int32_t f = 0; f < on->facet_count; f++) {
      const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
      for (int k = 3; k < mesh->nodes_per_facet; k++)
        out->pressure[node[k]] =
            (out->pressure[node[k - 3]] + out->pressure[node[(k - 2) % 3]]) / 2;
    }
  }
}

static void take_gaps(const contact_problem *c, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int32_t i = 0; i < mesh->node_count; i++)
    out->gap[i] = INFINITY;
  for (int pair = 0; pair < out->pair_count; pair++) {
    const bw_selection *on = out->pair[pair].on;
    out->state[pair].gap = INFINITY;
    for (int k = 0; k < c->count && !out->pair[pair].with; k++)
      if (c->rows.of[k] == pair) {
        double gap = c->p[k] > 0 ? 0 : c->w[k] / c->rows.area[k];
        out->gap[c->rows.node[k]] = fmin(out->gap[c->rows.node[k]], gap);
        out->state[pair].gap = fmin(out->state[pair].gap, gap);
      }
    if (!out->pair[pair].with)
      continue;
    for (int32_t f = 0; f < on->facet_count * mesh->nodes_per_facet; f++) {
      int32_t facet = on->facet[f / mesh->nodes_per_facet];
      int32_t i = mesh->facet[(int64_t)facet * mesh->nodes_per_facet + f % mesh->nodes_per_facet];
      double x[3], normal[3];
      for (int k = 0; k < 3; k++)
        x[k] = mesh->node[3 * (int64_t)i + k] + c->now[3 * (int64_t)i + k];
      double gap = bwi_rigid_gap(out->pair[pair].with, x, normal) - out->pair[pair].interference;
      out->gap[i] = fmin(out->gap[i], gap);
      out->state[pair].gap = fmin(out->state[pair].gap, gap);
    }
  }
}

static void take_states(const contact_problem *c, double *force, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int pair = 0; pair < out->pair_count; pair++) {
    bw_contact_state *state = &out->state[pair];
    state->node = -1;
    for (int i = 0; i < c->count; i++) {
      if (c->rows.of[i] != pair)
        continue;
      state->candidates++;
      state->active += c->p[i] > 0;
      state->area += c->p[i] > 0 ? c->rows.area[i] : 0;
      if (c->p[i] > state->pressure) {
        state->pressure = c->p[i];
        state->node = c->rows.node[i];
      }
    }
    if (state->active > 0)
      state->gap = 0;
    for (int64_t k = 0; k < c->rows.point_count; k++)
      if (c->rows.point[k].pair == pair)
        state->penetration = fmax(state->penetration, -c->rows.point[k].gap);
    if (state->penetration < small_gap * c->elastic)
      state->penetration = 0;
    bwi_contact_rows_pair_force(&c->rows, pair, c->p, force);
    for (int64_t i = 0; i < mesh->node_count; i++) {
      double moment[3];
      bw_cross(mesh->node + 3 * i, force + 3 * i, moment);
      for (int k = 0; k < 3; k++) {
        state->force[k] += force[3 * i + k];
        state->moment[k] += moment[k];
      }
    }
  }
}

/* The motions in the null space of H. */
static bw_status take_undetermined(bw_context *context, const contact_problem *c, bw_contact *out) {
  bw_status status = BW_OK;
  int m = c->motions, length = 8 * m + 8, info = 0;
  double *value = BW_NEW(context, double, m), *work = BW_NEW(context, double, length);
  out->free_text = BW_NEW0(context, char, (size_t)m * 300 + 1);
  BW_TRY_MEMORY(value && work && out->free_text);
  if (m > 0) {
    bwi_blas_enter();
    dsyev_("V", "U", &m, c->h, &m, value, work, &length, &info);
    bwi_blas_leave();
    if (info != 0)
      BW_TRY(bw_fail(context, BW_INTERNAL, "dsyev failed on %d motions (%d)", m, info));
  }
  for (int k = 0; k < m && value[k] <= undecided * value[m - 1]; k++) {
    char *end = out->free_text + strlen(out->free_text);
    if (out->free_count++)
      *end++ = '\n';
    bwi_describe_motion(c->system->dof_map, c->h + (size_t)k * (size_t)m, end, 299);
  }
done:
  bw_free(value);
  bw_free(work);
  return status;
}

static void warn(bw_context *context, const contact_problem *c, const bw_contact *out) {
  const bw_dof_map *dof_map = c->system->dof_map;
  for (int i = 0; i < out->pair_count; i++) {
    if (out->state[i].active == 0 && out->state[i].penetration > 0)
      bw_warn(context,
              "contact pair %d is undecided: points penetrate by up to %.3g m, though its gap is "
              "open in the mean: its facets are too large for what it touches. Refine them",
              i + 1, out->state[i].penetration);
    else if (out->state[i].active == 0)
      bw_warn(context, "contact pair %d stays open: its smallest gap is %.3g m", i + 1,
              out->state[i].gap);
    else if (out->state[i].penetration > coarse * c->elastic)
      bw_warn(context,
              "contact pair %d penetrates by up to %.3g m between corners, and its pressure moves "
              "them by %.3g m: its facets are too large for what it touches. Refine them",
              i + 1, out->state[i].penetration, c->elastic);
  }
  if (out->free_count > 0) {
    char text[400];
    size_t length = strcspn(out->free_text, "\n");
    snprintf(text, sizeof text, "%.*s", (int)length, out->free_text);
    bw_warn(
        context,
        "nothing decides the position along %d motions, such as the %s: stresses and pressure do "
        "not depend on it",
        out->free_count, text);
  }
  for (int32_t b = 0; b < dof_map->mesh->component_count; b++) {
    double rotation[3] = {0};
    for (int32_t m = dof_map->rigid_mode_start[b]; m < dof_map->rigid_mode_start[b + 1]; m++)
      for (int k = 0; k < 3; k++)
        rotation[k] += c->a[m] * dof_map->rigid_mode[m].rotation[k];
    if (bw_norm(rotation) > large_rotation)
      bw_warn(context, "body %d rotates by %.2g rad on its contact: rotations are taken as small",
              b + 1, bw_norm(rotation));
  }
}

static bw_status take_result(bw_context *context, contact_problem *c, bw_contact *out) {
  bw_status status = BW_OK;
  int64_t nodes = c->model->mesh->node_count;
  double *force = BW_NEW(context, double, 3 * nodes);
  out->pair = BW_NEW0(context, bw_contact_pair, c->rows.pair_count);
  out->state = BW_NEW0(context, bw_contact_state, c->rows.pair_count);
  out->pressure = BW_NEW0(context, double, nodes);
  out->gap = BW_NEW(context, double, nodes);
  BW_TRY_MEMORY(force && out->pair && out->state && out->pressure && out->gap);
  out->pair_count = c->rows.pair_count;
  for (int i = 0; i < out->pair_count; i++)
    out->pair[i] =
        (bw_contact_pair){bw_retain(c->rows.pair[i].on), bw_retain(c->rows.pair[i].with),
                          bw_retain(c->rows.pair[i].against), c->rows.pair[i].interference};
  BW_TRY(take_solution(context, c, out));
  BW_TRY(take_undetermined(context, c, out));
  take_pressure(c, out);
  take_gaps(c, out);
  take_states(c, force, out);
  out->iterations = c->iterations;
  out->changes = c->changes;
  out->solves = c->solves;
  out->report = c->system->report;
  warn(context, c, out);
done:
  bw_free(force);
  return status;
}

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
  bw_contact *out = NULL;
  double start = bw_seconds();
  bw_contact_options_default(&options);
  if (given_options)
    options = *given_options;
  contact_problem c = {.model = model, .options = &options};
  BW_TRY(check_options(context, pair_count, &options));
  BW_TRY(prepare(context, &c, pair_count, pair, given));
  BW_TRY(solve_contact(context, &c));
  out = BW_NEW0(context, bw_contact, 1);
  BW_TRY_MEMORY(out);
  bw_object_init(out, &contact_kind);
  out->model = bw_retain(model);
  BW_TRY(take_result(context, &c, out));
  out->report.seconds = bw_seconds() - start;
  *contact = out;
  out = NULL;
done:
  bw_release(out);
  problem_clear(&c);
  return status;
}
