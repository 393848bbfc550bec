/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* C = F^T A^-1 F = Y^T Y with Y = L^-1 F: the forward half of the solves is enough. A column of F
 * begins at its own nodes and passes only the supernodes above them. In each of these, the columns
 * that pass it are one dense block, so that all work is in products of matrices. Y can stay, so
 * that more columns take only their own solves. No sum depends on who did what: chunks of columns
 * are the same for any number of threads.
 *
 * Of a body that moves freely, G = (1 - R R^T W) A^-1 (1 - W R R^T), where A has isostatic
 * constraints. With E = F^T R, Z = A^-1 W R and V = F^T Z - E (R^T W Z) / 2 that is
 *     F^T G F = F^T A^-1 F - E V^T - V E^T,
 * so that the columns of F stay those of few nodes. */
#include "linear/compliance.h"

#include <stdlib.h>
#include <string.h>

#include "linear/blas.h"
#include "linear/internal.h"

enum { COLUMNS = 128, TILE = 128, SIDES = 16, SLOTS = 6 };

static const double one = 1, minus_one = -1, zero = 0;

/* What a system keeps of bodies that are free. */
typedef struct bwi_relaxed {
  bw_object object;
  double *motion;  /* (6 x size) Z = A^-1 W R, each body's k-th motion */
  double *inertia; /* (motions x 6) R^T W Z, body by body */
  int32_t *body;   /* (node_count) */
  size_t bytes;
} bwi_relaxed;

/* Y at a supernode: all columns that pass it. */
typedef struct bwi_half_columns {
  int count;
  int32_t *column; /* (count) ascending */
  double *value;   /* (pivots x count) by columns */
} bwi_half_columns;

/* The last columns of these, on their way to the parent. */
typedef struct passing {
  int columns;
  double *value; /* (outer unknowns x columns) by columns */
  int32_t next;  /* another child of the same parent, or -1 */
} passing;

typedef struct half_solve {
  const bwi_factor *factor;
  int count, first;
  double *matrix;
  bwi_half_columns *y; /* (super_count) */
  passing *at;         /* (super_count) */
  int32_t *child;      /* (super_count) first of those with columns, or -1 */
  int32_t *row;        /* (unknowns) row in the supernode at work */
  int32_t *unknown;    /* (max_rows) */
  int32_t *place;      /* (count) column of the block at work, or -1 */
  double *tile;        /* (workers x TILE x TILE) */
  int32_t s;           /* at work */
} half_solve;

/* An entry of F. */
typedef struct entry {
  int32_t super, column, unknown;
  double value;
} entry;

static int by_supernode(const void *a, const void *b) {
  const entry *x = a, *y = b;
  if (x->super != y->super)
    return x->super < y->super ? -1 : 1;
  if (x->column != y->column)
    return x->column < y->column ? -1 : 1;
  return (x->unknown > y->unknown) - (x->unknown < y->unknown);
}

static int ascending(const void *a, const void *b) {
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* The entries of F from column `first` on, on unknowns, by supernodes; how many. */
static int64_t list_entries(const bwi_symbolic *symbolic, const bw_dof_map *dof_map,
                            const bwi_nodal_columns *f, int first, entry *list) {
  const bwi_order *order = symbolic->order;
  int64_t count = 0;
  for (int32_t j = first; j < f->count; j++)
    for (int64_t k = f->start[j]; k < f->start[j + 1]; k++) {
      int32_t node = f->node[k], low = 0, high = order->super_count - 1;
      const double *frame = dof_map->frame_count > 0 && dof_map->frame_of[node] >= 0
                                ? dof_map->frame + 9 * (int64_t)dof_map->frame_of[node]
                                : NULL;
      while (low < high) { /* the last supernode that begins at or before it */
        int32_t middle = low + (high - low + 1) / 2;
        if (order->super[middle] <= order->position[node])
          low = middle;
        else
          high = middle - 1;
      }
      for (int c = 0; c < 3; c++) {
        int32_t u = symbolic->at[3 * (int64_t)node + c];
        if (u >= 0)
          list[count++] = (entry){
              low, j, u, frame ? bw_dot(frame + 3 * c, f->force + 3 * k) : f->force[3 * k + c]};
      }
    }
  qsort(list, (size_t)count, sizeof *list, by_supernode);
  return count;
}

static const int32_t *columns_of(const half_solve *h, int32_t s) {
  return h->y[s].column + h->y[s].count - h->at[s].columns;
}

/* The columns of entries and children that pass the supernode at work, behind those it has, with
 * the sums of what these bring. */
static bw_status assemble(bw_context *context, half_solve *h, const entry *list, int64_t count) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = h->factor->symbolic;
  bwi_half_columns *y = &h->y[h->s];
  passing *here = &h->at[h->s];
  int64_t most = count;
  int32_t pivots = bwi_pivots(symbolic, h->s), outer = symbolic->rows[h->s] - pivots, below;
  int32_t begin = symbolic->first[symbolic->order->super[h->s]];
  int32_t *column = NULL;
  double *value;
  for (int32_t c = h->child[h->s]; c >= 0; c = h->at[c].next)
    most += h->at[c].columns;
  column = bw_resize(context, y->column, (size_t)(y->count + most), sizeof *column);
  BW_TRY_MEMORY(column);
  y->column = column;
  column += y->count;
  for (int64_t k = 0; k < count; k++)
    if (h->place[list[k].column] < 0) {
      h->place[list[k].column] = 0;
      column[here->columns++] = list[k].column;
    }
  for (int32_t c = h->child[h->s]; c >= 0; c = h->at[c].next)
    for (int k = 0; k < h->at[c].columns; k++)
      if (h->place[columns_of(h, c)[k]] < 0) {
        h->place[columns_of(h, c)[k]] = 0;
        column[here->columns++] = columns_of(h, c)[k];
      }
  qsort(column, (size_t)here->columns, sizeof *column, ascending);
  for (int k = 0; k < here->columns; k++)
    h->place[column[k]] = k;
  value = bw_resize(context, y->value, (size_t)pivots * (size_t)(y->count + here->columns),
                    sizeof *value);
  BW_TRY_MEMORY(value);
  y->value = value;
  value += (int64_t)pivots * y->count;
  y->count += here->columns;
  memset(value, 0, (size_t)pivots * (size_t)here->columns * sizeof *value);
  here->value = BW_NEW0(context, double, (int64_t)outer * here->columns);
  BW_TRY_MEMORY(here->value);
  for (int32_t i = 0; i < pivots; i++)
    h->row[begin + i] = i;
  bwi_outer_unknowns(symbolic, h->s, h->unknown);
  for (int32_t i = 0; i < outer; i++)
    h->row[h->unknown[i]] = pivots + i;
  for (int64_t k = 0; k < count; k++) /* F has unknowns of this supernode alone */
    value[(int64_t)h->place[list[k].column] * pivots + h->row[list[k].unknown]] += list[k].value;
  for (int32_t c = h->child[h->s]; c >= 0; c = h->at[c].next) {
    passing *child = &h->at[c];
    below = bwi_outer_unknowns(symbolic, c, h->unknown);
    for (int32_t i = 0; i < below; i++)
      h->unknown[i] = h->row[h->unknown[i]];
    for (int k = 0; k < child->columns; k++) {
      int64_t at = h->place[columns_of(h, c)[k]];
      double *inside = value + at * pivots, *outside = here->value + at * outer - pivots;
      const double *from = child->value + (int64_t)k * below;
      for (int32_t i = 0; i < below; i++)
        (h->unknown[i] < pivots ? inside : outside)[h->unknown[i]] += from[i];
    }
    bw_free(child->value);
    child->value = NULL;
  }
done:
  for (int k = 0; column && k < here->columns; k++)
    h->place[column[k]] = -1;
  return status;
}

/* X_1 = L_11^-1 X_1, X_2 -= L_21 X_1 for some of the last columns. */
static bw_status eliminate(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const half_solve *h = data;
  const bwi_symbolic *symbolic = h->factor->symbolic;
  const bwi_half_columns *y = &h->y[h->s];
  int rows = symbolic->rows[h->s], pivots = bwi_pivots(symbolic, h->s), outer = rows - pivots;
  int columns = (int)(end - begin);
  const double *panel = (const double *)h->factor->value + symbolic->panel[h->s];
  double *x = y->value + (y->count - h->at[h->s].columns + begin) * pivots;
  dtrsm_("L", "L", "N", "N", &pivots, &columns, &one, panel, &rows, x, &pivots);
  if (outer > 0)
    dgemm_("N", "N", &outer, &columns, &pivots, &minus_one, panel + pivots, &rows, x, &pivots, &one,
           h->at[h->s].value + begin * outer, &outer);
  return BW_OK;
}

/* X_1^T X_1 into the lower triangle of the result, for some rows of tiles. */
static bw_status multiply(void *data, int64_t begin, int64_t end, int worker) {
  const half_solve *h = data;
  const bwi_half_columns *y = &h->y[h->s];
  int pivots = bwi_pivots(h->factor->symbolic, h->s), ld = TILE;
  double *tile = h->tile + (int64_t)worker * TILE * TILE;
  for (int64_t t = begin; t < end; t++) {
    int i = (int)t * TILE, height = y->count - i < TILE ? y->count - i : TILE;
    if (y->column[i + height - 1] < h->first)
      continue;
    for (int j = 0; j <= i; j += TILE) {
      int width = y->count - j < TILE ? y->count - j : TILE;
      dgemm_("T", "N", &width, &height, &pivots, &one, y->value + (int64_t)j * pivots, &pivots,
             y->value + (int64_t)i * pivots, &pivots, &zero, tile, &ld);
      for (int a = 0; a < height; a++) {
        double *to = h->matrix + (int64_t)y->column[i + a] * h->count;
        if (y->column[i + a] < h->first)
          continue;
        for (int b = 0; b < width && j + b <= i + a; b++)
          to[y->column[j + b]] += tile[a * TILE + b];
      }
    }
  }
  return BW_OK;
}

void bwi_half_solves_clear(bwi_half_solves *y) {
  for (int32_t s = 0; s < y->super_count; s++) {
    bw_free(y->at[s].column);
    bw_free(y->at[s].value);
  }
  bw_free(y->at);
  *y = (bwi_half_solves){0};
}

/* The lower triangle of F^T A^-1 F, from row `first` on. Y stays where `stays`. */
static bw_status by_halves(bw_context *context, const bw_system *system, const bwi_nodal_columns *f,
                           int first, bwi_half_solves *y, bool stays, double *matrix) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = system->factor->symbolic;
  const bwi_order *order = symbolic->order;
  int32_t supers = order->super_count;
  int64_t entries = 0, next = 0;
  entry *list = BW_NEW(context, entry, 3 * (f->start[f->count] - f->start[y->count]));
  half_solve h = {.factor = system->factor, .count = f->count, .first = first, .matrix = matrix};
  if (!y->at) {
    y->at = BW_NEW0(context, bwi_half_columns, supers);
    y->super_count = y->at ? supers : 0;
  }
  h.y = y->at;
  h.at = BW_NEW0(context, passing, supers);
  h.child = BW_NEW(context, int32_t, supers);
  h.row = BW_NEW(context, int32_t, symbolic->unknowns);
  h.unknown = BW_NEW(context, int32_t, symbolic->max_rows);
  h.place = BW_NEW(context, int32_t, f->count);
  h.tile = BW_NEW(context, double, (int64_t)bw_threads(context) * TILE * TILE);
  bwi_blas_enter();
  BW_TRY_MEMORY(list && h.y && h.at && h.child && h.row && h.unknown && h.place && h.tile);
  entries = list_entries(symbolic, system->dof_map, f, y->count, list);
  memset(h.child, 0xff, (size_t)supers * sizeof *h.child);
  memset(h.place, 0xff, (size_t)f->count * sizeof *h.place);
  for (h.s = 0; h.s < supers; h.s++) {
    int64_t from = next;
    while (next < entries && list[next].super == h.s)
      next++;
    if (next == from && h.child[h.s] < 0)
      continue;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(assemble(context, &h, list + from, next - from));
    BW_TRY(bw_parallel(context, h.at[h.s].columns, COLUMNS, eliminate, &h));
    BW_TRY(bw_parallel(context, (h.y[h.s].count + TILE - 1) / TILE, 1, multiply, &h));
    if (order->parent[h.s] >= 0) {
      h.at[h.s].next = h.child[order->parent[h.s]];
      h.child[order->parent[h.s]] = h.s;
    }
    if (!stays) {
      bw_free(h.y[h.s].value);
      h.y[h.s].value = NULL;
    }
  }
  y->count = f->count;
done:
  bwi_blas_leave();
  for (int32_t s = 0; h.at && s < supers; s++)
    bw_free(h.at[s].value);
  bw_free(list);
  bw_free(h.at);
  bw_free(h.child);
  bw_free(h.row);
  bw_free(h.unknown);
  bw_free(h.place);
  bw_free(h.tile);
  return status;
}

/* E and V of the free bodies, by columns of F. */
static void take_motions(const bw_system *system, const bwi_nodal_columns *f, double *e,
                         double *v) {
  const bw_dof_map *dof_map = system->dof_map;
  const bwi_relaxed *relaxed = system->relaxed;
  int64_t m = dof_map->rigid_mode_count, size = 3 * (int64_t)dof_map->mesh->node_count;
  for (int j = 0; j < f->count; j++)
    for (int64_t k = f->start[j]; k < f->start[j + 1]; k++) {
      int32_t node = f->node[k], body = relaxed->body[node];
      int32_t begin = dof_map->rigid_mode_start[body], end = dof_map->rigid_mode_start[body + 1];
      for (int32_t l = begin; l < end; l++) {
        const bw_rigid_mode *mode = &dof_map->rigid_mode[l];
        double arm[3], turn[3], u[3];
        for (int c = 0; c < 3; c++)
          arm[c] = dof_map->mesh->node[3 * (int64_t)node + c] - mode->centre[c];
        bw_cross(mode->rotation, arm, turn);
        for (int c = 0; c < 3; c++)
          u[c] = mode->translation[c] + turn[c];
        e[j * m + l] += bw_dot(u, f->force + 3 * k);
        v[j * m + l] +=
            bw_dot(relaxed->motion + (l - begin) * size + 3 * (int64_t)node, f->force + 3 * k);
      }
    }
  for (int j = 0; j < f->count; j++)
    for (int32_t body = 0; body < dof_map->mesh->component_count; body++) {
      int32_t begin = dof_map->rigid_mode_start[body], end = dof_map->rigid_mode_start[body + 1];
      for (int32_t l = begin; l < end; l++)
        for (int32_t n = begin; n < end; n++)
          v[j * m + l] -= e[j * m + n] * relaxed->inertia[(int64_t)n * SLOTS + l - begin] / 2;
    }
}

/* Takes E V^T + V E^T off. */
static bw_status free_bodies(bw_context *context, const bw_system *system,
                             const bwi_nodal_columns *f, int first, double *matrix) {
  bw_status status = BW_OK;
  int n = f->count, m = system->dof_map->rigid_mode_count, later = n - first;
  double *e = BW_NEW0(context, double, (int64_t)n *m), *v = BW_NEW0(context, double, (int64_t)n *m);
  BW_TRY_MEMORY(e && v);
  take_motions(system, f, e, v);
  bwi_blas_enter();
  dgemm_("T", "N", &n, &later, &m, &minus_one, e, &m, v + (int64_t)first * m, &m, &one,
         matrix + (int64_t)first * n, &n);
  dgemm_("T", "N", &n, &later, &m, &minus_one, v, &m, e + (int64_t)first * m, &m, &one,
         matrix + (int64_t)first * n, &n);
  bwi_blas_leave();
done:
  bw_free(e);
  bw_free(v);
  return status;
}

/* Rows from `first` on by whole solves, whatever solves. */
static bw_status by_solves(bw_context *context, bw_system *system, const bwi_nodal_columns *f,
                           int first, double *matrix) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  double *block = BW_NEW(context, double, SIDES *size);
  BW_TRY_MEMORY(block);
  for (int begin = first; begin < f->count; begin += SIDES) {
    int sides = f->count - begin < SIDES ? f->count - begin : SIDES;
    BW_TRY(bw_check_cancel(context));
    memset(block, 0, (size_t)(sides * size) * sizeof *block);
    for (int j = 0; j < sides; j++)
      for (int64_t k = f->start[begin + j]; k < f->start[begin + j + 1]; k++)
        for (int c = 0; c < 3; c++)
          block[j * size + 3 * (int64_t)f->node[k] + c] += f->force[3 * k + c];
    BW_TRY(bw_system_solve(context, system, sides, block, block));
    for (int j = 0; j < sides; j++)
      for (int i = 0; i < f->count; i++) {
        double sum = 0;
        for (int64_t k = f->start[i]; k < f->start[i + 1]; k++)
          sum += bw_dot(block + j * size + 3 * (int64_t)f->node[k], f->force + 3 * k);
        matrix[(int64_t)(begin + j) * f->count + i] = sum;
      }
  }
  for (int i = first; i < f->count; i++) /* the mean of the two that rounding tells apart */
    for (int j = first; j < i; j++)
      matrix[(int64_t)i * f->count + j] =
          0.5 * (matrix[(int64_t)i * f->count + j] + matrix[(int64_t)j * f->count + i]);
done:
  bw_free(block);
  return status;
}

static void relaxed_destroy(void *object) {
  bwi_relaxed *r = object;
  bw_free(r->motion);
  bw_free(r->inertia);
  bw_free(r->body);
  bw_free(r);
}

static size_t relaxed_bytes(const void *object) {
  return ((const bwi_relaxed *)object)->bytes;
}

static const bw_kind relaxed_kind = {"relaxed motions", relaxed_destroy, relaxed_bytes};

static bw_status relax(bw_context *context, bw_system *system) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = system->dof_map;
  int64_t nodes = dof_map->mesh->node_count, size = 3 * nodes;
  int m = dof_map->rigid_mode_count;
  double *a = BW_NEW(context, double, m);
  bwi_relaxed *relaxed = BW_NEW0(context, bwi_relaxed, 1);
  BW_TRY_MEMORY(relaxed);
  bw_object_init(relaxed, &relaxed_kind);
  BW_TRY_MEMORY(a);
  relaxed->motion = BW_NEW(context, double, SLOTS *size);
  relaxed->inertia = BW_NEW(context, double, (int64_t)SLOTS *m);
  relaxed->body = BW_NEW(context, int32_t, nodes);
  BW_TRY_MEMORY(relaxed->motion && relaxed->inertia && relaxed->body);
  relaxed->bytes = sizeof *relaxed + (size_t)nodes * sizeof(int32_t) +
                   SLOTS * ((size_t)size + (size_t)m) * sizeof(double);
  for (int32_t b = 0; b < dof_map->mesh->component_count; b++)
    for (int32_t k = dof_map->body_start[b]; k < dof_map->body_start[b + 1]; k++)
      relaxed->body[dof_map->body_node[k]] = b;
  for (int slot = 0; slot < SLOTS; slot++) {
    for (int32_t b = 0; b < dof_map->mesh->component_count; b++)
      for (int32_t k = dof_map->rigid_mode_start[b]; k < dof_map->rigid_mode_start[b + 1]; k++)
        a[k] = k - dof_map->rigid_mode_start[b] == slot;
    bw_rigid_modes_weighted(dof_map, a, relaxed->motion + slot * size);
  }
  BW_TRY(
      bwi_solve_fields(context, system->factor, dof_map, SLOTS, relaxed->motion, relaxed->motion));
  for (int slot = 0; slot < SLOTS; slot++) {
    bw_rigid_modes_measure(dof_map, relaxed->motion + slot * size, a);
    for (int k = 0; k < m; k++)
      relaxed->inertia[(int64_t)SLOTS * k + slot] = a[k];
  }
  system->relaxed = relaxed;
  relaxed = NULL;
done:
  bw_release(relaxed);
  bw_free(a);
  return status;
}

bool bwi_compliance_by_halves(const bw_system *system) {
  return !system->iterative && !system->external && system->factor &&
         system->factor->kernels == &bwi_kernels_double && !system->factor->broken;
}

bw_status bwi_compliance_of(bw_context *context, bw_system *system,
                            const bwi_nodal_columns *columns, int first, bwi_half_solves *kept,
                            double *matrix) {
  bw_status status = BW_OK;
  int64_t n = columns->count;
  bool halves = bwi_compliance_by_halves(system);
  bool is_free = halves && system->dof_map->rigid_mode_count > 0;
  bwi_half_solves local = {0}, *y = kept ? kept : &local;
  memset(matrix + first * n, 0, (size_t)((n - first) * n) * sizeof *matrix);
  if (is_free && !system->relaxed)
    BW_TRY(relax(context, system));
  BW_TRY(halves ? by_halves(context, system, columns, first, y, kept != NULL, matrix)
                : by_solves(context, system, columns, first, matrix));
  if (is_free)
    BW_TRY(free_bodies(context, system, columns, first, matrix));
  for (int64_t i = first; i < n; i++)
    for (int64_t j = 0; j < i; j++)
      matrix[j * n + i] = matrix[i * n + j];
done:
  if (!kept || status != BW_OK)
    bwi_half_solves_clear(y);
  return status;
}
