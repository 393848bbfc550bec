/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The working set of contact: candidates between which S = B G B^T is known, and the problem on
 * them (docs/theory/contact.md). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"

enum {
  AT_ONCE = 32,    /* candidates that may enter in a round at least, */
  GROWTH = 3,      /* or this many for each that is there */
  MOST_ROWS = 8000 /* a dense matrix */
};

static const double held = 1e-8; /* of the compliance of a free surface: supports constrain it */

/* S from row `first` on. */
static bw_status take_compliance(bw_context *context, bwi_contact_problem *c, int first) {
  bw_status status = BW_OK;
  int64_t n = c->row_count;
  double *larger = BW_NEW(context, double, n *n);
  BW_TRY_MEMORY(larger);
  for (int k = 0; k < first; k++)
    memcpy(larger + k * n, c->s + (int64_t)k * first, (size_t)first * sizeof *larger);
  bw_free(c->s);
  c->s = larger;
  bw_progress(context, "contact", (double)c->working / c->count);
  if (first == 0)
    bwi_half_solves_clear(&c->halves);
  BW_TRY(bwi_contact_rows_compliance(context, &c->rows, c->system, c->row_count, c->row, first,
                                     &c->halves, c->s));
  c->solves += (int)n - first;
done:
  return status;
}

/* Puts candidate i at the end, with its rows. */
static void append(bwi_contact_problem *c, int32_t i) {
  c->member[c->working] = i;
  c->place[i] = c->working++;
  for (int32_t r = c->rows.first[i]; r < c->rows.first[i + 1]; r++)
    c->row[c->row_count++] = r;
}

static bw_status extend(bw_context *context, bwi_contact_problem *c, int added,
                        const int32_t *which) {
  bw_status status = BW_OK;
  int first = c->row_count, member = c->working, rows = first;
  for (int k = 0; k < added; k++)
    rows += c->rows.first[which[k] + 1] - c->rows.first[which[k]];
  if (rows > MOST_ROWS)
    BW_TRY(bw_fail(context, BW_LIMIT,
                   "the corners of facets in contact have more than %d unknowns, one each or three "
                   "with friction: select fewer facets, or make the mesh coarser there",
                   (int)MOST_ROWS));
  for (int k = 0; k < added; k++) {
    c->active[c->working] = 1;
    append(c, which[k]);
  }
  c->changes += added;
  BW_TRY(take_compliance(context, c, first));
  for (; member < c->working; member++) {
    int32_t i = c->member[member];
    double area = c->rows.area[i], softness = area * sqrt(area) / c->young;
    const double *x = c->rows.mesh->node + 3 * (int64_t)c->rows.node[i];
    double compliance = c->s[(int64_t)first * c->row_count + first];
    first += c->rows.first[i + 1] - c->rows.first[i];
    if (compliance > held * softness)
      continue;
    status = bw_fail(
        context, BW_INVALID,
        "contact pair %d penetrates by %.3g m at (%g, %g, %g), where supports constrain the "
        "body: take the supported facets out of the pair, or move the surface",
        c->rows.of[i] + 1, -c->w[c->rows.first[i]] / area, x[0], x[1], x[2]);
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

bw_status bwi_contact_take_deepest(bw_context *context, bwi_contact_problem *c, int *added) {
  bw_status status = BW_OK;
  double slack = bwi_contact_small_gap(c);
  int found = 0, most = GROWTH * c->working > AT_ONCE ? GROWTH * c->working : AT_ONCE;
  deep *list = BW_NEW(context, deep, c->count);
  int32_t *which = BW_NEW(context, int32_t, c->count);
  BW_TRY_MEMORY(list && which);
  for (int i = 0; i < c->count; i++) {
    double area = c->rows.area[i], gap = c->w[c->rows.first[i]] / area;
    if (area > 0 && c->place[i] < 0 && gap < -slack)
      list[found++] = (deep){gap, i};
  }
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

bw_status bwi_contact_renew(bw_context *context, bwi_contact_problem *c) {
  int before = c->working;
  c->working = c->row_count = 0;
  for (int k = 0; k < before; k++) {
    int32_t i = c->member[k];
    c->place[i] = -1;
    if (!(c->rows.area[i] > 0))
      memset(c->p + c->rows.first[i], 0,
             (size_t)(c->rows.first[i + 1] - c->rows.first[i]) * sizeof *c->p);
    if (c->p[c->rows.first[i]] > 0) {
      c->active[c->working] = 1;
      append(c, i);
    }
  }
  return take_compliance(context, c, 0);
}

/* The place of the candidate that keeps contact with friction from an equilibrium, in words. */
static void say_where(bw_context *context, const bwi_contact_problem *c, const bwi_friction *f) {
  int32_t i = c->member[f->worst];
  const double *x = c->rows.mesh->node + 3 * (int64_t)c->rows.node[i];
  bw_fail(context, BW_CONVERGENCE,
          "contact with friction finds no equilibrium in step %d of %d: pair %d keeps changing "
          "between stick and slip about (%g, %g, %g), by the fraction %.2g of the largest "
          "pressure. Take more steps, or a smaller coefficient of friction",
          c->step, c->options->steps, c->rows.of[i] + 1, x[0], x[1], x[2], f->change);
}

bw_status bwi_contact_solve_working(bw_context *context, bwi_contact_problem *c,
                                    const double *centre) {
  bw_status status = BW_OK;
  int n = c->row_count, m = c->motions, rows = c->rows.row_count;
  bool friction = c->rows.row_count > c->count;
  double *q = BW_NEW(context, double, n);
  double *e = BW_NEW(context, double, (int64_t)n *m), *slack = BW_NEW(context, double, c->working);
  double *p = BW_NEW(context, double, n), *w = BW_NEW(context, double, n);
  double *coefficient = BW_NEW(context, double, c->working);
  int32_t *first = BW_NEW0(context, int32_t, c->working + 1);
  BW_TRY_MEMORY(q && e && slack && p && w && coefficient && first);
  for (int k = 0; k < n; k++) {
    int32_t r = c->row[k];
    q[k] = c->q[r];
    p[k] = c->p[r];
    memcpy(e + (int64_t)k * m, c->e + (int64_t)r * m, (size_t)m * sizeof *e);
  }
  for (int k = 0; k < c->working; k++) {
    int32_t i = c->member[k];
    slack[k] = 0.1 * bwi_contact_small_gap(c) * c->rows.area[i];
    coefficient[k] = c->rows.pair[c->rows.of[i]].friction;
    first[k + 1] = first[k] + c->rows.first[i + 1] - c->rows.first[i];
  }
  if (friction) {
    bwi_friction problem = {.count = c->working,
                            .rows = n,
                            .motions = m,
                            .first = first,
                            .friction = coefficient,
                            .s = c->s,
                            .q = q,
                            .e = e,
                            .load = c->load,
                            .centre = centre,
                            .epsilon = c->epsilon,
                            .patient = c->last_try,
                            .slack = slack,
                            .state = c->active,
                            .p = p,
                            .a = c->a,
                            .h = c->h};
    status = bwi_friction_solve(context, &problem);
    c->changes += problem.changes;
    if (status == BW_CONVERGENCE && c->last_try)
      say_where(context, c, &problem);
  } else {
    bwi_complementarity problem = {.count = n,
                                   .motions = m,
                                   .s = c->s,
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
    status = bwi_complementarity_solve(context, &problem);
    c->changes += problem.changes;
  }
  BW_TRY(status);
  memset(c->p, 0, (size_t)rows * sizeof *c->p);
  for (int k = 0; k < n; k++)
    c->p[c->row[k]] = p[k];
done:
  bw_free(q);
  bw_free(e);
  bw_free(slack);
  bw_free(p);
  bw_free(w);
  bw_free(coefficient);
  bw_free(first);
  return status;
}

bw_status bwi_contact_measure_all(bw_context *context, bwi_contact_problem *c) {
  bw_status status = BW_OK;
  bwi_contact_rows_force(&c->rows, c->p, c->pressed); /* 0 without a candidate */
  if (c->working > 0) {
    BW_TRY(bw_system_solve(context, c->system, 1, c->pressed, c->pressed));
    c->solves++;
  }
  bwi_contact_rows_measure(&c->rows, c->pressed, c->w);
  c->elastic = 0;
  for (int i = 0; i < c->count; i++)
    if (c->rows.area[i] > 0)
      c->elastic = fmax(c->elastic, fabs(c->w[c->rows.first[i]]) / c->rows.area[i]);
  for (int r = 0; r < c->rows.row_count; r++)
    c->w[r] += c->q[r] + bwi_dot(c->motions, c->e + (int64_t)r * c->motions, c->a);
done:
  return status;
}
