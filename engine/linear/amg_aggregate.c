/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Aggregates of multigrid, and the tentative prolongation from them (amg.h).
 *
 * Invariants: a row without an aggregate has no unknown. Columns of the tentative prolongation that
 * would depend on those before are 0, and so are the rows and columns of their unknowns on the next
 * level. */
#include <string.h>

#include "linear/amg_setup.h"

enum { MODES = BWI_AMG_MODES };

/* Rows are strongly coupled where |A_ij|^2 >= theta^2 |A_ii| |A_jj|. On aggregates theta is larger,
 * since smoothing couples them with more neighbours, and weakly. */
#define STRONG_NODES 0.02
#define STRONG_AGGREGATES 0.05
/* A column with less than this of it left depends on those before. */
#define DEPENDENT 1e-6

/* ---- aggregates ------------------------------------------------------------------------------ */

static bool is_strong(const bwi_amg_setup *s, int64_t k, int32_t j, const double *block) {
  double size = bwi_amg_norm(block, bwi_amg_unknowns(s)) * bwi_amg_unit(s);
  double theta = s->at > 0 ? STRONG_AGGREGATES : STRONG_NODES;
  return j != k && s->of[j] != -2 && size * size >= theta * theta * s->norm[k] * s->norm[j];
}

/* Whether no strong neighbour of row k is in an aggregate, and there is one. */
static bool is_apart(const bwi_amg_setup *s, int64_t k) {
  bool any = false;
  BWI_AMG_FOR_ROW(s, k, {
    (void)across;
    if (is_strong(s, k, j, block)) {
      any = true;
      if (s->of[j] >= 0)
        return false;
    }
  });
  return any;
}

/* -2: no unknown; -1: not yet in an aggregate. Vanek, Mandel and Brezina, algorithm 5.1. */
bw_status bwi_amg_aggregate(bwi_amg_setup *s) {
  bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int32_t first;
  s->of = BW_NEW(s->context, int32_t, v->rows);
  if (!s->of)
    return BW_MEMORY;
  s->count = 0;
  for (int32_t k = 0; k < v->rows; k++) {
    double trace = 0;
    for (int i = 0; i < u; i++)
      trace += s->inverse[(int64_t)u * u * k + i * (u + 1)];
    s->of[k] = trace > 0 ? -1 : -2;
  }
  for (int32_t k = 0; k < v->rows; k++)
    if (s->of[k] == -1 && is_apart(s, k)) {
      BWI_AMG_FOR_ROW(s, k, {
        (void)across;
        if (is_strong(s, k, j, block))
          s->of[j] = s->count;
      });
      s->of[k] = s->count++;
    }
  first = s->count;
  for (int32_t k = 0; k < v->rows; k++) { /* join the strongest neighbour's */
    double most = 0;
    int32_t best = -1;
    if (s->of[k] != -1)
      continue;
    BWI_AMG_FOR_ROW(s, k, {
      (void)across;
      if (is_strong(s, k, j, block) && s->of[j] >= 0 && s->of[j] < first) {
        double size = bwi_amg_norm(block, u) / s->norm[j];
        if (size > most) {
          most = size;
          best = s->of[j];
        }
      }
    });
    if (best >= 0)
      s->of[k] = best + INT32_MAX / 2; /* not before all others have chosen */
  }
  for (int32_t k = 0; k < v->rows; k++)
    if (s->of[k] >= INT32_MAX / 2)
      s->of[k] -= INT32_MAX / 2;
  for (int32_t k = 0; k < v->rows; k++)
    if (s->of[k] == -1) {
      BWI_AMG_FOR_ROW(s, k, {
        (void)across;
        if (is_strong(s, k, j, block) && s->of[j] == -1)
          s->of[j] = s->count;
      });
      s->of[k] = s->count++;
    }
  return BW_OK;
}

/* ---- the tentative prolongation -------------------------------------------------------------- */

/* Rows of an aggregate, of a field with MODES columns. */
typedef struct group {
  double *field;
  int unknowns;
  const int32_t *row;
  int64_t count;
} group;

static double *numbers_at(const group *g, int64_t e) {
  return g->field + (int64_t)g->unknowns * MODES * g->row[e];
}

static double dot_columns(const group *g, int a, int b) {
  double sum = 0;
  for (int64_t e = 0; e < g->count; e++)
    for (int i = 0; i < g->unknowns; i++)
      sum += numbers_at(g, e)[i * MODES + a] * numbers_at(g, e)[i * MODES + b];
  return sum;
}

/* column m = scale * column m + factor * column q */
static void combine_columns(const group *g, int m, double scale, int q, double factor) {
  for (int64_t e = 0; e < g->count; e++)
    for (int i = 0; i < g->unknowns; i++) {
      double *x = numbers_at(g, e) + i * MODES;
      x[m] = scale * x[m] + factor * x[q];
    }
}

/* Q R of the columns in their place, by Gram and Schmidt, twice; r: MODES x MODES. */
static void orthonormalise(const group *g, double *r) {
  for (int m = 0; m < MODES; m++) {
    double whole = sqrt(dot_columns(g, m, m));
    for (int pass = 0; pass < 2; pass++)
      for (int q = 0; q < m; q++) {
        double part = dot_columns(g, q, m);
        r[q * MODES + m] += part;
        combine_columns(g, m, 1, q, -part);
      }
    double left = sqrt(dot_columns(g, m, m));
    bool dependent = !(left > DEPENDENT * whole);
    r[m * MODES + m] = dependent ? 0 : left;
    combine_columns(g, m, dependent ? 0 : 1 / left, m, 0);
  }
}

/* The modes, by aggregates: Q, and R are those of the next level. */
bw_status bwi_amg_make_tentative(bwi_amg_setup *s) {
  bw_status status = BW_OK;
  const bwi_amg_level *v = &s->g->level[s->at];
  int64_t numbers = (int64_t)v->unknowns * MODES;
  double *next = BW_NEW0(s->context, double, (int64_t)s->count *MODES *MODES);
  int64_t *start = BW_NEW0(s->context, int64_t, s->count + 2);
  int32_t *list = BW_NEW(s->context, int32_t, v->rows);
  int32_t *body = BW_NEW(s->context, int32_t, s->count);
  if (!next || !start || !list || !body) {
    bw_free(next);
    bw_free(body);
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t k = 0; k < v->rows; k++)
    if (s->of[k] >= 0)
      start[s->of[k] + 2]++;
    else
      memset(s->modes + numbers * k, 0, (size_t)numbers * sizeof(double));
  for (int32_t a = 0; a < s->count; a++)
    start[a + 2] += start[a + 1];
  for (int32_t k = 0; k < v->rows; k++)
    if (s->of[k] >= 0) {
      list[start[s->of[k] + 1]++] = k;
      body[s->of[k]] = s->body[k];
    }
  for (int32_t a = 0; a < s->count; a++) {
    const group g = {s->modes, v->unknowns, list + start[a], start[a + 1] - start[a]};
    orthonormalise(&g, next + (int64_t)MODES * MODES * a);
  }
  s->tentative = s->modes;
  s->modes = next;
  bw_free(s->body);
  s->body = body;
done:
  bw_free(start);
  bw_free(list);
  return status;
}
