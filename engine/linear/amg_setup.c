/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The levels of multigrid by smoothed aggregation (amg.h), from the nodes to the coarsest. */
#include <string.h>

#include "base/dense.h"
#include "linear/amg_setup.h"

enum { MODES = BWI_AMG_MODES, POWER = 12, MOST_DENSE = 400 };

/* The power iteration finds a little less than the largest eigenvalue. */
#define SAFETY 1.1

void bwi_amg_blocks_clear(bwi_amg_blocks *b) {
  bw_free(b->start);
  bw_free(b->column);
  bw_free(b->exact);
  bw_free(b->value);
  *b = (bwi_amg_blocks){0};
}

/* ---- diagonal blocks ------------------------------------------------------------------------- */

/* The inverse of a positive definite 6 x 6 block on the unknowns that there are. */
static bool invert_six(const double *a, double *inverse) {
  double l[36], unit[6];
  int list[6], n = 0;
  for (int i = 0; i < 6; i++)
    if (a[7 * i] > 0)
      list[n++] = i;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      l[i * n + j] = a[6 * list[i] + list[j]];
  memset(inverse, 0, 36 * sizeof *inverse);
  if (!bwi_cholesky(n, l, 1e-14))
    return false;
  for (int j = 0; j < n; j++) {
    memset(unit, 0, sizeof unit);
    unit[j] = 1;
    bwi_lower_solve(n, l, unit);
    bwi_upper_solve(n, l, unit);
    for (int i = 0; i < n; i++)
      inverse[6 * list[i] + list[j]] = unit[i];
  }
  return true;
}

static bw_status find_diagonal(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  bwi_amg_setup *s = data;
  int u = bwi_amg_unknowns(s);
  for (int64_t k = begin; k < end; k++) {
    double *inverse = s->inverse + u * u * k;
    BWI_AMG_FOR_ROW(s, k, {
      (void)across;
      if (j == k) {
        s->norm[k] = bwi_amg_norm(block, u) * bwi_amg_unit(s);
        if (s->at > 0 && !invert_six(block, inverse))
          inverse[0] = NAN;
      }
    });
    for (int c = 0; s->at == 0 && c < 9; c++) /* symmetric */
      inverse[c] = (double)s->g->smoother->inverse[9 * k + c];
  }
  return BW_OK;
}

/* ---- the largest eigenvalue of D^-1 A -------------------------------------------------------- */

static bw_status power(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  bwi_amg_setup *s = data;
  int u = bwi_amg_unknowns(s);
  for (int64_t k = begin; k < end; k++) {
    double sum[6] = {0}, *y = s->y + u * k;
    BWI_AMG_FOR_ROW(s, k,
                    { bwi_amg_add_product(block, across, u, 1, s->x + (int64_t)u * j, sum); });
    for (int i = 0; i < u; i++) {
      y[i] = 0;
      for (int c = 0; c < u; c++)
        y[i] += s->inverse[u * u * k + i * u + c] * sum[c] * bwi_amg_unit(s);
    }
  }
  return BW_OK;
}

static bw_status estimate(bwi_amg_setup *s) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  int64_t size = (int64_t)v->rows * v->unknowns;
  bw_random random;
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < size; i++)
    s->x[i] = bw_random_uniform(&random) - 0.5;
  for (int k = 0; k < POWER; k++) {
    BW_TRY(bw_parallel(s->context, v->rows, BWI_AMG_ROWS, power, s));
    double before = sqrt(bwi_dot(size, s->x, s->x)), after = sqrt(bwi_dot(size, s->y, s->y));
    if (!(after > 0) || !isfinite(after)) {
      status =
          bw_fail(s->context, BW_SINGULAR, "the stiffness is singular: a level of multigrid is");
      goto done;
    }
    v->largest = SAFETY * after / before;
    for (int64_t i = 0; i < size; i++)
      s->x[i] = s->y[i] / after;
  }
done:
  return status;
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* Rigid-body motions of the nodes about the middle of all, in units of their distance from it, at
 * the unknowns. */
static bw_status nodal_modes(bwi_amg_setup *s) {
  const bwi_smoother *g = s->g->smoother;
  const bw_dof_map *dof_map = s->matrix->dof_map;
  const bw_mesh *mesh = dof_map->mesh;
  s->modes = BW_NEW0(s->context, double, 18 * (int64_t)g->count);
  s->body = BW_NEW(s->context, int32_t, g->count);
  if (!s->modes || !s->body)
    return BW_MEMORY;
  for (int64_t k = 0; k < g->count; k++)
    for (int c = 0; c < 3; c++)
      s->centre[c] += mesh->node[3 * (int64_t)g->node[k] + c] / g->count;
  for (int64_t k = 0; k < g->count; k++)
    for (int c = 0; c < 3; c++)
      s->size = fmax(s->size, fabs(mesh->node[3 * (int64_t)g->node[k] + c] - s->centre[c]));
  for (int64_t k = 0; k < g->count; k++) {
    int64_t i = g->node[k];
    int32_t row = dof_map->frame_of[i];
    double y[3];
    s->body[k] = mesh->component[i];
    for (int c = 0; c < 3; c++)
      y[c] = (mesh->node[3 * i + c] - s->centre[c]) / s->size;
    for (int m = 0; m < MODES; m++) {
      double u[3] = {0, 0, 0}, axis[3] = {0, 0, 0};
      axis[m % 3] = 1;
      if (m < 3)
        u[m] = 1;
      else
        bw_cross(axis, y, u);
      for (int c = 0; c < 3; c++) {
        double direction[3] = {c == 0, c == 1, c == 2};
        if (row >= 0)
          memcpy(direction, dof_map->frame + 9 * (int64_t)row + 3 * c, sizeof direction);
        if (dof_map->state[3 * i + c] == BW_DOF_PRESCRIBED)
          continue;
        double along = bw_dot(direction, u);
        for (int d = 0; d < 3; d++)
          s->modes[18 * k + 6 * d + m] += along * direction[d];
      }
    }
  }
  return BW_OK;
}

static void clear_level(bwi_amg_setup *s) {
  bw_free(s->of);
  bw_free(s->tentative);
  bw_free(s->mark);
  bw_free(s->child);
  bw_free(s->x);
  bw_free(s->y);
  bw_free(s->norm);
  bw_free(s->inverse);
  bwi_amg_blocks_clear(&s->ap);
  s->of = s->mark = NULL;
  s->child = NULL;
  s->tentative = s->x = s->y = s->norm = s->inverse = NULL;
}

/* What smoothing on this level needs. */
static bw_status begin_level(bwi_amg_setup *s) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t size = (int64_t)v->rows * u;
  s->x = BW_NEW(s->context, double, size);
  s->y = BW_NEW(s->context, double, size);
  s->norm = BW_NEW0(s->context, double, v->rows);
  s->inverse = BW_NEW0(s->context, double, size *u);
  BW_TRY_MEMORY(s->x && s->y && s->norm && s->inverse);
  BW_TRY(bw_parallel(s->context, v->rows, BWI_AMG_ROWS, find_diagonal, s));
  BW_TRY(estimate(s));
  if (s->at > 0) {
    v->inverse = BW_NEW0(s->context, float, size *u + BWI_SMOOTHER_SPARE);
    BW_TRY_MEMORY(v->inverse);
    for (int64_t i = 0; i < size * u; i++)
      v->inverse[i] = (float)s->inverse[i];
  }
done:
  return status;
}

/* The next level: its matrix and modes. *smaller is false where aggregates are too many to help. */
static bw_status make_next(bwi_amg_setup *s, bool *smaller) {
  bw_status status = BW_OK;
  BW_TRY(bwi_amg_aggregate(s));
  /* nodes always, so that the coarsest level has no prescribed components */
  *smaller = s->count > 0 && (s->at == 0 || s->count <= 0.7 * s->g->level[s->at].rows);
  if (!*smaller)
    goto done;
  BW_TRY(bwi_amg_make_tentative(s));
  BW_TRY(bwi_amg_make_next(s));
done:
  return status;
}

bw_status bwi_amg_set_up(bw_context *context, bwi_amg *g, const bwi_matrix *matrix) {
  bw_status status = BW_OK;
  bwi_amg_setup s = {.context = context, .g = g, .matrix = matrix, .workers = bw_threads(context)};
  g->level[0].rows = g->smoother->count;
  g->level[0].unknowns = 3;
  BW_TRY(nodal_modes(&s));
  for (s.at = 0;; s.at++) {
    bwi_amg_level *v = &g->level[s.at];
    bool smaller = s.at == 0 || (v->rows > BWI_AMG_COARSEST && s.at + 1 < BWI_AMG_LEVELS);
    BW_TRY(bw_check_cancel(context));
    bw_progress(context, "multigrid", 0);
    g->level_count = s.at + 1;
    if (smaller) {
      BW_TRY(begin_level(&s));
      BW_TRY(make_next(&s, &smaller));
    }
    if (!smaller) {
      if (s.at > 0 && v->rows > MOST_DENSE)
        status = bw_fail(context, BW_LIMIT,
                         "multigrid stopped at a level of %d aggregates: parts are connected too "
                         "weakly",
                         (int)v->rows);
      else
        status = bwi_amg_factor_coarsest(&s);
    }
    if (status == BW_OK && s.at > 0)
      status = bwi_amg_to_floats(context, &v->a);
    clear_level(&s);
    if (status != BW_OK || !smaller)
      break;
  }
done:
  clear_level(&s);
  bw_free(s.modes);
  bw_free(s.body);
  return status;
}
