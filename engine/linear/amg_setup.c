/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The levels of multigrid by smoothed aggregation (amg.h): aggregates, prolongations, products.
 *
 * Invariants: a row without an aggregate has no unknown. Columns of the tentative prolongation that
 * would depend on those before are 0, and so are the rows and columns of their unknowns on the next
 * level, whose diagonal entries in inverses are 0 too. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "linear/amg.h"

enum { ROWS = 128, MODES = BWI_AMG_MODES, POWER = 12, MOST_DENSE = 400 };

/* Nodes are strongly coupled where |A_ij|^2 >= STRONG^2 |A_ii| |A_jj|. */
#define STRONG 0.02
/* A column with less than this of it left depends on those before. */
#define DEPENDENT 1e-6
/* The power iteration finds a little less than the largest eigenvalue. */
#define SAFETY 1.1

void bwi_amg_blocks_clear(bwi_amg_blocks *b) {
  bw_free(b->start);
  bw_free(b->column);
  bw_free(b->exact);
  bw_free(b->value);
  *b = (bwi_amg_blocks){0};
}

typedef struct setup {
  bw_context *context;
  bwi_amg *g;
  const bwi_matrix *matrix;
  int at;            /* the level in work */
  double *modes;     /* rows x unknowns x MODES: near null space of the level */
  int32_t *of;       /* rows: aggregate, or -1 */
  int32_t count;     /* of aggregates */
  double *tentative; /* rows x unknowns x MODES */
  bwi_amg_blocks ap; /* A P */
  int workers;
  int32_t *mark;   /* workers x aggregates: place in the row in work, + 1, or 0 */
  double *x, *y;   /* rows x unknowns */
  double *norm;    /* rows: |A_ii| */
  double *inverse; /* rows x unknowns^2 */
} setup;

/* ---- rows of the level's matrix -------------------------------------------------------------- */

/* Calls what follows for every block of row k: its column j, numbers `block`, stored `across` where
 * they are those of the transposed block. */
#define FOR_ROW(s, k, body)                                                                        \
  do {                                                                                             \
    const bwi_amg_level *v_ = &(s)->g->level[(s)->at];                                             \
    if ((s)->at > 0) {                                                                             \
      for (int64_t e_ = v_->a.start[k]; e_ < v_->a.start[(k) + 1]; e_++) {                         \
        const double *block = v_->a.exact + 36 * e_;                                               \
        const int32_t j = v_->a.column[e_];                                                        \
        const bool across = false;                                                                 \
        body                                                                                       \
      }                                                                                            \
    } else {                                                                                       \
      const bwi_smoother *g_ = (s)->g->smoother;                                                   \
      const bw_block_pattern *p_ = g_->pattern;                                                    \
      const int32_t i_ = g_->node[k];                                                              \
      for (int64_t e_ = p_->start[i_]; e_ < p_->start[i_ + 1]; e_++) {                             \
        const double *block = (s)->matrix->stiffness + 9 * e_;                                     \
        const int32_t j = g_->row_of[p_->column[e_]];                                              \
        const bool across = false;                                                                 \
        body                                                                                       \
      }                                                                                            \
      for (int64_t e_ = p_->upper_start[i_]; e_ < p_->upper_start[i_ + 1]; e_++) {                 \
        const double *block = (s)->matrix->stiffness + 9 * p_->upper_block[e_];                    \
        const int32_t j = g_->row_of[p_->upper_row[e_]];                                           \
        const bool across = true;                                                                  \
        body                                                                                       \
      }                                                                                            \
    }                                                                                              \
  } while (0)

static double unit_of(const setup *s) {
  return s->at > 0 ? 1 : s->g->smoother->unit;
}

static int unknowns_of(const setup *s) {
  return s->g->level[s->at].unknowns;
}

static double size_of(const double *block, int n) {
  double sum = 0;
  for (int i = 0; i < n * n; i++)
    sum += block[i] * block[i];
  return sqrt(sum);
}

/* sum (u x w) += A (u x u), or its transpose, times x (u x w) */
static inline void add_product(const double *a, bool across, int u, int w, const double *x,
                               double *sum) {
  for (int i = 0; i < u; i++)
    for (int k = 0; k < u; k++) {
      double factor = across ? a[k * u + i] : a[i * u + k];
      for (int j = 0; j < w; j++)
        sum[i * w + j] += factor * x[k * w + j];
    }
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
  setup *s = data;
  int u = unknowns_of(s);
  for (int64_t k = begin; k < end; k++) {
    double *inverse = s->inverse + u * u * k;
    FOR_ROW(s, k, {
      (void)across;
      if (j == k) {
        s->norm[k] = size_of(block, u) * unit_of(s);
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
  setup *s = data;
  int u = unknowns_of(s);
  for (int64_t k = begin; k < end; k++) {
    double sum[6] = {0}, *y = s->y + u * k;
    FOR_ROW(s, k, { add_product(block, across, u, 1, s->x + (int64_t)u * j, sum); });
    for (int i = 0; i < u; i++) {
      y[i] = 0;
      for (int c = 0; c < u; c++)
        y[i] += s->inverse[u * u * k + i * u + c] * sum[c] * unit_of(s);
    }
  }
  return BW_OK;
}

static bw_status estimate(setup *s) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  int64_t size = (int64_t)v->rows * v->unknowns;
  bw_random random;
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < size; i++)
    s->x[i] = bw_random_uniform(&random) - 0.5;
  for (int k = 0; k < POWER; k++) {
    BW_TRY(bw_parallel(s->context, v->rows, ROWS, power, s));
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

/* ---- aggregates ------------------------------------------------------------------------------ */

static bool is_strong(const setup *s, int64_t k, int32_t j, const double *block) {
  double size = size_of(block, unknowns_of(s)) * unit_of(s);
  return j != k && s->of[j] != -2 && size * size >= STRONG * STRONG * s->norm[k] * s->norm[j];
}

/* Whether no strong neighbour of row k is in an aggregate, and there is one. */
static bool is_apart(const setup *s, int64_t k) {
  bool any = false;
  FOR_ROW(s, k, {
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
static bw_status aggregate(setup *s) {
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
      FOR_ROW(s, k, {
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
    FOR_ROW(s, k, {
      (void)across;
      if (is_strong(s, k, j, block) && s->of[j] >= 0 && s->of[j] < first) {
        double size = size_of(block, u) / s->norm[j];
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
      FOR_ROW(s, k, {
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
static bw_status make_tentative(setup *s) {
  bw_status status = BW_OK;
  const bwi_amg_level *v = &s->g->level[s->at];
  int64_t numbers = (int64_t)v->unknowns * MODES;
  double *next = BW_NEW0(s->context, double, (int64_t)s->count *MODES *MODES);
  int64_t *start = BW_NEW0(s->context, int64_t, s->count + 2);
  int32_t *list = BW_NEW(s->context, int32_t, v->rows);
  if (!next || !start || !list) {
    bw_free(next);
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
    if (s->of[k] >= 0)
      list[start[s->of[k] + 1]++] = k;
  for (int32_t a = 0; a < s->count; a++) {
    const group g = {s->modes, v->unknowns, list + start[a], start[a + 1] - start[a]};
    orthonormalise(&g, next + (int64_t)MODES * MODES * a);
  }
  s->tentative = s->modes;
  s->modes = next;
done:
  bw_free(start);
  bw_free(list);
  return status;
}

/* ---- products by rows ------------------------------------------------------------------------ */

/* Each product is made in two passes: columns of rows are counted, then listed and filled. */
typedef struct making {
  setup *s;
  bwi_amg_blocks *out;
  bool fill;
} making;

/* The place of a column in the row in work. */
static int64_t place(int32_t *mark, int32_t column, int32_t *seen, int64_t *count) {
  if (!mark[column]) {
    seen[*count] = column;
    mark[column] = (int32_t)++ * count;
  }
  return mark[column] - 1;
}

enum { MOST_COLUMNS = 4096 };

static bw_status make_row(const making *m, int worker, int64_t k,
                          void (*row)(const making *, int64_t, int32_t *, int32_t *, int64_t *)) {
  int32_t seen[MOST_COLUMNS];
  int64_t count = 0;
  setup *s = m->s;
  int32_t *mark = s->mark + (int64_t)worker * s->count;
  row(m, k, mark, seen, &count);
  if (count >= MOST_COLUMNS - 1)
    return bw_fail(s->context, BW_LIMIT, "a row of multigrid has more than %d blocks",
                   (int)MOST_COLUMNS);
  if (m->fill)
    memcpy(m->out->column + m->out->start[k], seen, (size_t)count * sizeof *seen);
  else
    m->out->start[k + 1] = count;
  for (int64_t c = 0; c < count; c++)
    mark[seen[c]] = 0;
  return BW_OK;
}

/* P = (1 - omega D^-1 A) T, omega = 4 / 3 over the largest eigenvalue. */
static void smooth_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + numbers * m->out->start[k] : NULL, sum[36], column[36];
  if (s->of[k] < 0)
    return;
  place(mark, s->of[k], seen, count);
  FOR_ROW(s, k, {
    if (s->of[j] >= 0 && *count < MOST_COLUMNS - 1) {
      int64_t at = place(mark, s->of[j], seen, count);
      if (out)
        add_product(block, across, u, MODES, s->tentative + numbers * j, out + numbers * at);
    }
  });
  double omega = 4.0 / 3 / v->largest * unit_of(s);
  for (int64_t c = 0; out && c < *count; c++) {
    double *p = out + numbers * c;
    memcpy(column, p, (size_t)numbers * sizeof *p);
    memset(sum, 0, sizeof sum);
    add_product(s->inverse + (int64_t)u * u * k, false, u, MODES, column, sum);
    for (int64_t i = 0; i < numbers; i++)
      p[i] = (c == 0 ? s->tentative[numbers * k + i] : 0) - omega * sum[i];
  }
}

static void multiply_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + numbers * m->out->start[k] : NULL;
  FOR_ROW(s, k, {
    for (int64_t e = v->p.start[j]; e < v->p.start[j + 1] && *count < MOST_COLUMNS - 1; e++) {
      int64_t at = place(mark, v->p.column[e], seen, count);
      if (out)
        add_product(block, across, u, MODES, v->p.exact + numbers * e, out + numbers * at);
    }
  });
  for (int64_t i = 0; out && i < numbers * *count; i++)
    out[i] *= unit_of(s);
}

/* P^T (A P) */
static void galerkin_row(const making *m, int64_t k, int32_t *mark, int32_t *seen, int64_t *count) {
  setup *s = m->s;
  const bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t numbers = (int64_t)u * MODES;
  double *out = m->fill ? m->out->exact + 36 * m->out->start[k] : NULL;
  for (int64_t c = v->child_start[k]; c < v->child_start[k + 1]; c++) {
    const double *p = v->p.exact + numbers * v->child[c];
    int32_t i = v->child_row[c];
    for (int64_t e = s->ap.start[i]; e < s->ap.start[i + 1] && *count < MOST_COLUMNS - 1; e++) {
      int64_t at = place(mark, s->ap.column[e], seen, count);
      if (out)
        bwi_multiply_add(MODES, u, MODES, p, s->ap.exact + numbers * e, out + 36 * at);
    }
  }
}

static bw_status smooth_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, smooth_row);
  return status;
}

static bw_status multiply_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, multiply_row);
  return status;
}

static bw_status galerkin_rows(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  for (int64_t k = begin; k < end && status == BW_OK; k++)
    status = make_row(data, worker, k, galerkin_row);
  return status;
}

static bw_status make(setup *s, int32_t rows, int height, bw_body *body, bwi_amg_blocks *out) {
  bw_status status = BW_OK;
  making m = {s, out, false};
  *out = (bwi_amg_blocks){.rows = rows, .columns = s->count, .height = height, .width = MODES};
  out->start = BW_NEW0(s->context, int64_t, rows + 1);
  if (!out->start)
    return BW_MEMORY;
  BW_TRY(bw_parallel(s->context, rows, ROWS, body, &m));
  for (int32_t k = 0; k < rows; k++)
    out->start[k + 1] += out->start[k];
  out->column = BW_NEW(s->context, int32_t, out->start[rows] + 1);
  out->exact = BW_NEW0(s->context, double, out->start[rows] * height * MODES + 1);
  if (!out->column || !out->exact) {
    status = BW_MEMORY;
    goto done;
  }
  m.fill = true;
  BW_TRY(bw_parallel(s->context, rows, ROWS, body, &m));
done:
  return status;
}

static bw_status list_children(setup *s, bwi_amg_level *v) {
  int64_t count = v->p.start[v->rows];
  v->child_start = BW_NEW0(s->context, int64_t, s->count + 2);
  v->child = BW_NEW(s->context, int64_t, count + 1);
  v->child_row = BW_NEW(s->context, int32_t, count + 1);
  if (!v->child_start || !v->child || !v->child_row)
    return BW_MEMORY;
  int64_t *next = v->child_start + 1; /* runs to where the next column starts */
  for (int64_t e = 0; e < count; e++)
    if (v->p.column[e] + 1 < s->count)
      next[v->p.column[e] + 1]++;
  for (int32_t a = 1; a < s->count; a++)
    next[a] += next[a - 1];
  for (int32_t k = 0; k < v->rows; k++)
    for (int64_t e = v->p.start[k]; e < v->p.start[k + 1]; e++) {
      int64_t at = next[v->p.column[e]]++;
      v->child[at] = e;
      v->child_row[at] = k;
    }
  return BW_OK;
}

/* Numbers for the cycle, without those of the setup. */
static bw_status to_floats(setup *s, bwi_amg_blocks *b) {
  int64_t count = b->start[b->rows] * b->height * b->width;
  b->value = BW_NEW(s->context, float, count + 1);
  if (!b->value)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++)
    b->value[i] = (float)b->exact[i];
  bw_free(b->exact);
  b->exact = NULL;
  return BW_OK;
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* Rigid-body motions of the nodes about the middle of all, in units of their distance from it, at
 * the unknowns. */
static bw_status nodal_modes(setup *s) {
  const bwi_smoother *g = s->g->smoother;
  const bw_dof_map *dof_map = s->matrix->dof_map;
  const bw_mesh *mesh = dof_map->mesh;
  double centre[3] = {0, 0, 0}, size = 0;
  s->modes = BW_NEW0(s->context, double, 18 * (int64_t)g->count);
  if (!s->modes)
    return BW_MEMORY;
  for (int64_t i = 0; i < 3 * (int64_t)g->count; i++)
    centre[i % 3] += mesh->node[i] / g->count;
  for (int64_t i = 0; i < 3 * (int64_t)g->count; i++)
    size = fmax(size, fabs(mesh->node[i] - centre[i % 3]));
  for (int64_t k = 0; k < g->count; k++) {
    int64_t i = g->node[k];
    int32_t row = dof_map->frame_of[i];
    const double *x = mesh->node + 3 * i;
    const double y[3] = {(x[0] - centre[0]) / size, (x[1] - centre[1]) / size,
                         (x[2] - centre[2]) / size};
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

static bw_status factor_coarsest(setup *s) {
  bwi_amg *g = s->g;
  const bwi_amg_level *v = &g->level[s->at];
  int u = v->unknowns, n = s->at > 0 ? v->rows * u : 0; /* 0: nothing is unknown */
  g->size = n;
  g->dense = BW_NEW0(s->context, double, (int64_t)n *n);
  g->dense_x = BW_NEW0(s->context, double, n);
  if (!g->dense || !g->dense_x)
    return BW_MEMORY;
  for (int32_t k = 0; s->at > 0 && k < v->rows; k++)
    FOR_ROW(s, k, {
      for (int a = 0; a < u; a++)
        for (int b = 0; b < u; b++)
          g->dense[(int64_t)n * (u * k + a) + u * j + b] +=
              unit_of(s) * (across ? block[b * u + a] : block[a * u + b]);
    });
  for (int64_t i = 0; i < n; i++)
    if (!(g->dense[(int64_t)n * i + i] > 0))
      g->dense[(int64_t)n * i + i] = 1;
  return bwi_cholesky(n, g->dense, 1e-14) ? BW_OK
                                          : bw_fail(s->context, BW_SINGULAR,
                                                    "the stiffness is singular, or so nearly that "
                                                    "multigrid cannot tell: its coarsest "
                                                    "level is not positive definite");
}

static void clear_level(setup *s) {
  bw_free(s->of);
  bw_free(s->tentative);
  bw_free(s->mark);
  bw_free(s->x);
  bw_free(s->y);
  bw_free(s->norm);
  bw_free(s->inverse);
  bwi_amg_blocks_clear(&s->ap);
  s->of = s->mark = NULL;
  s->tentative = s->x = s->y = s->norm = s->inverse = NULL;
}

/* What smoothing on this level needs. */
static bw_status begin_level(setup *s) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  int u = v->unknowns;
  int64_t size = (int64_t)v->rows * u;
  s->x = BW_NEW(s->context, double, size);
  s->y = BW_NEW(s->context, double, size);
  s->norm = BW_NEW0(s->context, double, v->rows);
  s->inverse = BW_NEW0(s->context, double, size *u);
  if (!s->x || !s->y || !s->norm || !s->inverse) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_parallel(s->context, v->rows, ROWS, find_diagonal, s));
  BW_TRY(estimate(s));
  if (s->at > 0) {
    v->inverse = BW_NEW(s->context, float, size *u);
    if (!v->inverse) {
      status = BW_MEMORY;
      goto done;
    }
    for (int64_t i = 0; i < size * u; i++)
      v->inverse[i] = (float)s->inverse[i];
  }
done:
  return status;
}

/* The next level: its matrix and modes. *smaller is false where aggregates are too many to help. */
static bw_status make_next(setup *s, bool *smaller) {
  bw_status status = BW_OK;
  bwi_amg_level *v = &s->g->level[s->at];
  BW_TRY(aggregate(s));
  /* nodes always, so that the coarsest level has no prescribed components */
  *smaller = s->count > 0 && (s->at == 0 || s->count <= 0.7 * v->rows);
  if (!*smaller)
    goto done;
  s->mark = BW_NEW0(s->context, int32_t, (int64_t)s->workers * s->count);
  if (!s->mark) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(make_tentative(s));
  BW_TRY(make(s, v->rows, v->unknowns, smooth_rows, &v->p));
  BW_TRY(list_children(s, v));
  BW_TRY(make(s, v->rows, v->unknowns, multiply_rows, &s->ap));
  v[1].rows = s->count;
  v[1].unknowns = MODES;
  BW_TRY(make(s, s->count, MODES, galerkin_rows, &v[1].a));
  BW_TRY(to_floats(s, &v->p));
done:
  return status;
}

bw_status bwi_amg_setup(bw_context *context, bwi_amg *g, const bwi_matrix *matrix) {
  bw_status status = BW_OK;
  setup s = {.context = context, .g = g, .matrix = matrix, .workers = bw_threads(context)};
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
        status = factor_coarsest(&s);
    }
    if (status == BW_OK && s.at > 0)
      status = to_floats(&s, &v->a);
    clear_level(&s);
    if (status != BW_OK || !smaller)
      break;
  }
done:
  clear_level(&s);
  bw_free(s.modes);
  return status;
}
