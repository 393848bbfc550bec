/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The working set of contact: candidates for which a column of S = B G B^T is known, and the
 * problem on them (docs/theory/contact.md). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"

enum {
  SIDES = 16,            /* right-hand sides at once */
  AT_ONCE = 32,          /* candidates that may enter in a round at least */
  MOST_CANDIDATES = 8000 /* a dense matrix */
};

static const double held = 1e-8; /* of the compliance of a free surface: supports constrain it */

/* Columns of S from `first` on. */
static bw_status compute_columns(bw_context *context, bwi_contact_problem *c, int first) {
  bw_status status = BW_OK;
  int64_t size = bwi_contact_size(c);
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

static bw_status extend(bw_context *context, bwi_contact_problem *c, int added,
                        const int32_t *which) {
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
    status = bw_fail(
        context, BW_INVALID,
        "contact pair %d penetrates by %.3g m at (%g, %g, %g), where supports constrain the "
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

bw_status bwi_contact_take_deepest(bw_context *context, bwi_contact_problem *c, int *added) {
  bw_status status = BW_OK;
  double slack = bwi_contact_small_gap(c);
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

bw_status bwi_contact_renew(bw_context *context, bwi_contact_problem *c) {
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

bw_status bwi_contact_solve_working(bw_context *context, bwi_contact_problem *c,
                                    const double *centre) {
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
    slack[k] = 0.1 * bwi_contact_small_gap(c) * c->rows.area[i];
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
