/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the modes leave of the compliance of points that touch or come near (docs/theory/drop.md).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "drop/internal.h"
#include "linear/blas.h"
#include "linear/compliance.h"

enum {
  BESIDE = 16, /* points that are made known with others, at least */
  MOST = 6000  /* a dense matrix */
};

/* Of the way of two steps, and of how far the forces may move a point: those as near are made known
 * with others. */
static const double soon = 25, farther = 2;

/* Root of the largest compliance of any point over that of the known ones, at most. */
static const double softer = 2;

double bwi_drop_contact_energy(const bwi_drop_touch *touch) {
  double sum = 0;
  for (int j = 0; j < touch->count; j++) /* w force = 0 */
    sum -= touch->force[j] * touch->gap[j];
  return fmax(0, sum);
}

double bwi_drop_contact_reach(const bwi_drop_touch *touch, double energy) {
  return softer * sqrt(touch->largest * energy);
}

void bwi_drop_push(const bwi_drop_run *run, int32_t point, double push[3]) {
  double normal[3], arm[3];
  bwi_drop_gap_at(run, point, normal, arm);
  bwi_drop_to_body(run->motion.turn, normal, push);
}

void bwi_drop_modal_force(const bwi_drop_run *run, int32_t point, const double push[3],
                          double *force) {
  int m = run->motion.modes;
  const double *basis = run->points.basis + 3 * (int64_t)point * m;
  for (int k = 0; k < m; k++)
    force[k] = push[0] * basis[k] + push[1] * basis[m + k] + push[2] * basis[2 * m + k];
}

/* Rows from `first` on of B^T (G - phi phi^T / omega^2) B. */
static bw_status take_rows(bw_context *context, bwi_drop_run *run, int first) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  int n = t->known, m = run->motion.modes, later = n - first;
  const double minus_one = -1, one = 1;
  int64_t *start = BW_NEW(context, int64_t, n + 1);
  int32_t *node = BW_NEW(context, int32_t, n);
  double *b = BW_NEW(context, double, (int64_t)n *m);
  BW_TRY_MEMORY(start && node && b);
  start[n] = n;
  for (int64_t i = 0; i < n; i++) {
    start[i] = i;
    node[i] = run->points.node[t->point[i]];
    bwi_drop_modal_force(run, t->point[i], t->push + 3 * i, b + i * m);
    for (int k = 0; k < m; k++)
      b[i * m + k] /= run->motion.omega[k];
  }
  const bwi_nodal_columns columns = {n, start, node, t->push};
  BW_TRY(bwi_compliance_of(context, run->system, &columns, first, NULL, t->flexibility));
  run->solves += later;
  for (int64_t i = first; i < n; i++)
    t->whole[i] = t->flexibility[i * n + i];
  bwi_blas_enter();
  dgemm_("T", "N", &n, &later, &m, &minus_one, b, &m, b + (int64_t)first * m, &m, &one,
         t->flexibility + (int64_t)first * n, &n);
  bwi_blas_leave();
  for (int64_t i = first; i < n; i++) {
    for (int64_t j = 0; j < i; j++)
      t->flexibility[j * n + i] = t->flexibility[i * n + j];
    t->largest = fmax(t->largest, t->flexibility[i * n + i]);
  }
done:
  bw_free(start);
  bw_free(node);
  bw_free(b);
  return status;
}

typedef struct nearby {
  double gap;
  int32_t point;
} nearby;

static int nearer(const void *a, const void *b) {
  const nearby *x = a, *y = b;
  if (x->gap != y->gap)
    return x->gap < y->gap ? -1 : 1;
  return (x->point > y->point) - (x->point < y->point);
}

/* Room for `known` points, of which the first `n` stay. */
static bw_status lengthen(bw_context *context, bwi_drop_touch *t, int64_t n, int64_t known) {
  /* its own compliance, that of the candidates, and their factor */
  bw_status status = bwi_drop_check_memory(context, 3.0 * (double)known * (double)known,
                                           "the compliances of points that touch",
                                           "mesh the faces that land coarser, or tilt the body");
  if (status != BW_OK)
    return status;
  int32_t *point = BW_NEW(context, int32_t, known);
  double *push = BW_NEW(context, double, 3 * known), *whole = BW_NEW(context, double, known);
  double *flexibility = BW_NEW(context, double, known *known);
  BW_TRY_MEMORY(point && push && whole && flexibility);
  if (n > 0) {
    memcpy(point, t->point, (size_t)n * sizeof *point);
    memcpy(push, t->push, 3 * (size_t)n * sizeof *push);
    memcpy(whole, t->whole, (size_t)n * sizeof *whole);
  }
  for (int64_t i = 0; i < n; i++)
    memcpy(flexibility + i * known, t->flexibility + i * t->known, (size_t)n * sizeof *flexibility);
  for (int i = (int)n; i < t->known; i++)
    t->place[t->point[i]] = -1;
  bw_free(t->point);
  bw_free(t->push);
  bw_free(t->whole);
  bw_free(t->flexibility);
  t->point = point;
  t->push = push;
  t->whole = whole;
  t->flexibility = flexibility;
  t->known = (int)known;
  return BW_OK;
done:
  bw_free(point);
  bw_free(push);
  bw_free(whole);
  bw_free(flexibility);
  return status;
}

bw_status bwi_drop_know(bw_context *context, bwi_drop_run *run, int more, const int32_t *which) {
  bw_status status = BW_OK;
  bwi_drop_touch *t = &run->touch;
  int found = 0, needed = 0, first = t->known, most = MOST;
  nearby *list = BW_NEW(context, nearby, t->near_count);
  BW_TRY_MEMORY(list);
  for (int i = 0; i < more; i++)
    if (t->place[which[i]] >= 0) /* for another normal */
      first = t->count;
  for (int32_t i = 0; i < t->near_count; i++) {
    int32_t point = t->near[i], place = t->place[point];
    double normal[3], arm[3];
    bool wanted = needed < more && point == which[needed]; /* both are in the order of `near` */
    needed += wanted;
    if (place >= 0 && place < first)
      continue;
    double gap = bwi_drop_gap_at(run, point, normal, arm);
    if (wanted || !bwi_drop_faces_away(run, point, normal))
      list[found++] = (nearby){wanted ? -INFINITY : gap, point};
  }
  qsort(list, (size_t)found, sizeof *list, nearer);
  for (needed = 0; needed < found && isinf(list[needed].gap);)
    needed++;
  if (first + needed > most)
    BW_TRY(bw_fail(context, BW_LIMIT,
                   "more than %d nodes touch in one impact or come near: mesh the faces that land "
                   "coarser, or tilt the body",
                   most));
  double level =
      soon * run->margin + farther * bwi_drop_contact_reach(t, bwi_drop_contact_energy(t));
  int taken = needed + BESIDE;
  while (taken < found && taken < needed + t->known && list[taken].gap < level)
    taken++;
  taken = taken < found ? taken : found;
  taken = first + taken < most ? taken : most - first;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(lengthen(context, t, first, first + taken));
  for (int i = 0; i < taken; i++) {
    int at = first + i;
    t->point[at] = list[i].point;
    t->place[list[i].point] = at;
    bwi_drop_push(run, list[i].point, t->push + 3 * (int64_t)at);
  }
  BW_TRY(take_rows(context, run, first));
done:
  bw_free(list);
  return status;
}

void bwi_drop_promote(bwi_drop_touch *t, int32_t point) {
  int64_t n = t->known, a = t->count++, b = t->place[point];
  int32_t other = t->point[a];
  double *s = t->flexibility, whole = t->whole[a];
  for (int64_t k = 0; k < 3; k++) {
    double push = t->push[3 * a + k];
    t->push[3 * a + k] = t->push[3 * b + k];
    t->push[3 * b + k] = push;
  }
  t->whole[a] = t->whole[b];
  t->whole[b] = whole;
  t->point[a] = point;
  t->point[b] = other;
  t->place[other] = (int32_t)b;
  t->place[point] = (int32_t)a;
  for (int64_t k = 0; k < n; k++) {
    double entry = s[a * n + k];
    s[a * n + k] = s[b * n + k];
    s[b * n + k] = entry;
  }
  for (int64_t k = 0; k < n; k++) {
    double entry = s[k * n + a];
    s[k * n + a] = s[k * n + b];
    s[k * n + b] = entry;
  }
}
