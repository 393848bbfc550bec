/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What limits the changes of coarsening: a grid of the living triangles, and whether new ones would
 * meet any of them. */
#include "mesh/coarsen.h"
#include "mesh/predicates.h"

enum { MAX_CELLS = 512 };

/* ---- the grid ------------------------------------------------------------------------------- */

static void box_of(const double *const x[3], double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) {
    double a = x[0][k], b = x[1][k], d = x[2][k];
    low[k] = a < b ? (a < d ? a : d) : (b < d ? b : d);
    high[k] = a > b ? (a > d ? a : d) : (b > d ? b : d);
  }
}

static void cells_of(const bwi_coarsening *c, const double low[3], const double high[3],
                     int64_t from[3], int64_t to[3]) {
  for (int k = 0; k < 3; k++) {
    from[k] = (int64_t)floor(low[k] / c->length);
    to[k] = (int64_t)floor(high[k] / c->length);
  }
}

static uint64_t bucket_of(const bwi_coarsening *c, int64_t i, int64_t j, int64_t k) {
  uint64_t h = (uint64_t)i * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 29 ^ (uint64_t)j) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 32 ^ (uint64_t)k) * 0x94d049bb133111ebu;
  return (h ^ h >> 31) & (c->buckets - 1);
}

bool bwi_coarsen_enter(bwi_coarsening *c, int32_t triangle) {
  const double *x[3];
  double low[3], high[3];
  int64_t from[3], to[3];
  for (int k = 0; k < 3; k++)
    x[k] = place(c, c->corner[3 * (size_t)triangle + (size_t)k]);
  box_of(x, low, high);
  cells_of(c, low, high, from, to);
  double cells = 1;
  for (int k = 0; k < 3; k++)
    cells *= (double)(to[k] - from[k] + 1);
  if (cells > MAX_CELLS) {
    if (!bw_grow(c->context, (void **)&c->big, &c->big_capacity, c->big_count, 1, sizeof *c->big))
      return false;
    c->big[c->big_count++] = triangle;
    return true;
  }
  if (!bw_grow(c->context, (void **)&c->list, &c->capacity, c->entries, (size_t)cells,
               sizeof *c->list))
    return false;
  for (int64_t i = from[0]; i <= to[0]; i++)
    for (int64_t j = from[1]; j <= to[1]; j++)
      for (int64_t k = from[2]; k <= to[2]; k++) {
        int64_t *head = &c->bucket[bucket_of(c, i, j, k)];
        c->list[c->entries] = (bwi_coarsen_entry){triangle, *head};
        *head = (int64_t)c->entries++;
      }
  return true;
}

/* ---- what a new triangle meets -------------------------------------------------------------- */

/* Two triangles of known corners: do they meet elsewhere than in shared corners and sides? See
 * surface_intersect.c for why these tests are enough. */
static bool cross(const int32_t a[3], const double *const xa[3], const int32_t b[3],
                  const double *const xb[3]) {
  int shared = 0, lone_a = 0, lone_b = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      if (a[i] == b[k]) {
        shared++;
        lone_a = i;
        lone_b = k;
      }
  if (shared == 0) {
    for (int i = 0; i < 3; i++)
      if (bwi_segment_meets_triangle(xa[i], xa[(i + 1) % 3], xb[0], xb[1], xb[2]) ||
          bwi_segment_meets_triangle(xb[i], xb[(i + 1) % 3], xa[0], xa[1], xa[2]))
        return true;
    return false;
  }
  if (shared == 1)
    return bwi_segment_meets_triangle(xa[(lone_a + 1) % 3], xa[(lone_a + 2) % 3], xb[0], xb[1],
                                      xb[2]) ||
           bwi_segment_meets_triangle(xb[(lone_b + 1) % 3], xb[(lone_b + 2) % 3], xa[0], xa[1],
                                      xa[2]);
  return false; /* neighbours: folds are refused by their angle */
}

/* Whether two triangles with a common side overlap. */
static bool folded(const double m[3], const double n[3]) {
  return bw_dot(m, n) <= -0.98 * bw_norm(m) * bw_norm(n);
}

/* May the new triangles lie beside that living one? */
static bool clear_of(bwi_coarsening *c, const bwi_coarsen_change *now,
                     const double box[2 * BWI_RING][6], int32_t other) {
  const int32_t *b = c->corner + 3 * (size_t)other;
  if (b[0] < 0 || c->seen[other] == c->query || other == now->pair[0] || other == now->pair[1])
    return true;
  c->seen[other] = c->query;
  const double *xb[3];
  for (int k = 0; k < 3; k++) {
    if (b[k] == now->kept || b[k] == now->gone)
      return true; /* it changes too, or goes */
    xb[k] = place(c, b[k]);
  }
  double low[3], high[3];
  box_of(xb, low, high);
  for (int i = 0; i < now->count; i++) {
    const double *mine = box[i];
    if (low[0] > mine[3] || low[1] > mine[4] || low[2] > mine[5] || high[0] < mine[0] ||
        high[1] < mine[1] || high[2] < mine[2])
      continue;
    int shared = 0;
    for (int k = 0; k < 9; k++)
      shared += now->corner[i][k / 3] == b[k % 3];
    if (shared == 3)
      return false;
    if (shared == 2) {
      double n[3];
      normal_of(xb, n);
      if (folded(n, now->normal[i]))
        return false;
    } else if (cross(now->corner[i], now->x[i], b, xb)) {
      return false;
    }
  }
  return true;
}

/* The new triangles among themselves. */
static bool fan_is_plain(const bwi_coarsen_change *now) {
  for (int i = 0; i < now->count; i++)
    for (int j = 0; j < i; j++) {
      int shared = 0;
      for (int k = 0; k < 9; k++)
        shared += now->corner[i][k / 3] == now->corner[j][k % 3];
      if (shared > 2 || (shared == 2 && folded(now->normal[i], now->normal[j])) ||
          cross(now->corner[i], now->x[i], now->corner[j], now->x[j]))
        return false;
    }
  return true;
}

/* ---- distance from the surface that was given ----------------------------------------------- */

static bool near_given(const bwi_coarsening *c, const double at[3], int32_t *hint) {
  double whole[3];
  for (int k = 0; k < 3; k++)
    whole[k] = at[k] + c->origin[k];
  return bwi_tree_is_near(c->tree, whole, allowed_at(c, at), hint);
}

/* A point that the change moves or takes away, and what it stands for, stay near a new facet: no
 * spike is lost, not even by many small steps. */
static bool near_change(const bwi_coarsening *c, bwi_coarsen_change *now, int32_t point) {
  if (point < 0)
    return true;
  const double *old = place(c, point);
  double min = INFINITY, found[3];
  for (int i = 0; i < now->count && min > 0; i++)
    min = fmin(min, bwi_nearest_on_triangle(old, now->x[i][0], now->x[i][1], now->x[i][2], found));
  now->lost = fmax(now->lost, c->lost[point] + sqrt(min));
  return now->lost <= allowed_at(c, old);
}

/* Midpoints of sides and centroids of facets are tried. */
static bool stays_near(const bwi_coarsening *c, bwi_coarsen_change *now) {
  for (int i = 0; i < now->count; i++) {
    double middle[3] = {0, 0, 0};
    for (int s = 0; s < 3; s++) {
      double half[3];
      int32_t *hint = &c->hint[now->corner[i][s]];
      for (int k = 0; k < 3; k++) {
        half[k] = (now->x[i][s][k] + now->x[i][(s + 1) % 3][k]) / 2;
        middle[k] += now->x[i][s][k] / 3;
      }
      if (!near_given(c, half, hint))
        return false;
    }
    if (!near_given(c, middle, &c->hint[now->corner[i][0]]))
      return false;
  }
  now->lost = 0;
  return near_change(c, now, now->kept) && near_change(c, now, now->gone);
}

bool bwi_coarsen_is_free(bwi_coarsening *c, bwi_coarsen_change *now) {
  double box[2 * BWI_RING][6], low[3], high[3];
  int64_t from[3], to[3];
  if (!fan_is_plain(now))
    return false;
  for (int i = 0; i < now->count; i++) {
    box_of(now->x[i], box[i], box[i] + 3);
    for (int k = 0; k < 3; k++) {
      low[k] = i && low[k] < box[i][k] ? low[k] : box[i][k];
      high[k] = i && high[k] > box[i][3 + k] ? high[k] : box[i][3 + k];
    }
  }
  if (now->count == 0)
    return false;
  if (c->tree && !stays_near(c, now))
    return false;
  cells_of(c, low, high, from, to);
  c->query++;
  double cells = 1;
  for (int k = 0; k < 3; k++)
    cells *= (double)(to[k] - from[k] + 1);
  if (cells > 512 + (double)c->triangles) { /* long facets among short ones: faster without grid */
    for (int32_t t = 0; t < c->triangles; t++)
      if (!clear_of(c, now, box, t))
        return false;
    return true;
  }
  for (int64_t p = from[0]; p <= to[0]; p++)
    for (int64_t q = from[1]; q <= to[1]; q++)
      for (int64_t r = from[2]; r <= to[2]; r++)
        for (int64_t e = c->bucket[bucket_of(c, p, q, r)]; e >= 0; e = c->list[e].next)
          if (!clear_of(c, now, box, c->list[e].triangle))
            return false;
  for (size_t e = 0; e < c->big_count; e++)
    if (!clear_of(c, now, box, c->big[e]))
      return false;
  return true;
}
