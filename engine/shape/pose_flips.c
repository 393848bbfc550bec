/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Edge flips in flat parts of a surface.
 *
 * Side 3 t + k of triangle t runs from its corner k to its corner k + 1. twin[s] is the other side
 * of the edge, which runs backwards, or -1 where the edge has not exactly two such sides. */
#include "shape/pose_flips.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct flips {
  const double *point;
  int32_t *triangle;
  int32_t *twin;   /* per side */
  int32_t *stack;  /* sides to look at */
  uint8_t *queued; /* per side */
  int64_t depth;
} flips;

typedef struct side {
  int32_t low, high; /* its points */
  int32_t side;
} side;

static int compare_sides(const void *first, const void *second) {
  const side *x = (const side *)first, *y = (const side *)second;
  if (x->low != y->low)
    return x->low < y->low ? -1 : 1;
  if (x->high != y->high)
    return x->high < y->high ? -1 : 1;
  return (x->side > y->side) - (x->side < y->side);
}

static int32_t next(int32_t s) {
  return s % 3 == 2 ? s - 2 : s + 1;
}

static int32_t from(const flips *f, int32_t s) {
  return f->triangle[s];
}

static int32_t to(const flips *f, int32_t s) {
  return f->triangle[next(s)];
}

static int32_t apex(const flips *f, int32_t s) {
  return f->triangle[next(next(s))];
}

static bw_status find_twins(bw_context *context, flips *f, int32_t sides) {
  bw_status status = BW_OK;
  side *list = BW_NEW(context, side, sides);
  BW_TRY_MEMORY(list);
  for (int32_t s = 0; s < sides; s++) {
    int32_t a = from(f, s), b = to(f, s);
    list[s] = (side){a < b ? a : b, a < b ? b : a, s};
    f->twin[s] = -1;
  }
  qsort(list, (size_t)sides, sizeof *list, compare_sides);
  for (int32_t i = 0, end; i < sides; i = end) {
    for (end = i + 1;
         end < sides && list[end].low == list[i].low && list[end].high == list[i].high;)
      end++;
    int32_t s = list[i].side, t = end == i + 2 ? list[i + 1].side : s;
    if (from(f, s) == to(f, t) && from(f, s) != to(f, s)) {
      f->twin[s] = t;
      f->twin[t] = s;
    }
  }
done:
  bw_free(list);
  return status;
}

static void push(flips *f, int32_t s) {
  if (s < 0 || f->queued[s])
    return;
  f->queued[s] = 1;
  f->stack[f->depth++] = s;
}

/* Whether an edge from the start of side s to d exists: all triangles around the start are asked.
 */
static bool has_edge(const flips *f, int32_t s, int32_t d) {
  int32_t at = s;
  do {
    if (to(f, at) == d || apex(f, at) == d)
      return true;
    at = f->twin[next(next(at))];
  } while (at >= 0 && at != s);
  if (at == s)
    return false;
  for (at = f->twin[s]; at >= 0; at = f->twin[at]) { /* the start lies on an open edge */
    at = next(at);
    if (to(f, at) == d || apex(f, at) == d)
      return true;
  }
  return false;
}

static void minus(const double *x, const double *y, double *d) {
  for (int k = 0; k < 3; k++)
    d[k] = x[k] - y[k];
}

/* Whether the circle through one triangle holds the other's corner: the angles at c and d sum to
 * more than a half turn. */
static bool is_poor(const double *a, const double *b, const double *c, const double *d) {
  double ca[3], cb[3], da[3], db[3], n[3];
  minus(a, c, ca);
  minus(b, c, cb);
  minus(a, d, da);
  minus(b, d, db);
  bw_cross(ca, cb, n);
  double sine_c = bw_norm(n), cosine_c = bw_dot(ca, cb);
  bw_cross(da, db, n);
  double sine_d = bw_norm(n), cosine_d = bw_dot(da, db);
  return sine_c * cosine_d + cosine_c * sine_d <
         -1e-9 * bw_norm(ca) * bw_norm(cb) * bw_norm(da) * bw_norm(db);
}

/* Whether the edges ab and cd cross within both, up to the tolerance: the two pairs of triangles
 * are nowhere farther from each other than these. */
static bool is_flat(const double *a, const double *b, const double *c, const double *d,
                    double tolerance) {
  double ab[3], cd[3], ac[3], n[3], part[3];
  minus(b, a, ab);
  minus(d, c, cd);
  minus(c, a, ac);
  bw_cross(ab, cd, n);
  double square = bw_dot(n, n), small = 1e-6;
  if (!(square > 0) || fabs(bw_dot(ac, n)) > tolerance * sqrt(square))
    return false;
  bw_cross(ac, cd, part);
  double s = bw_dot(part, n) / square;
  bw_cross(ac, ab, part);
  double t = bw_dot(part, n) / square;
  return s > small && s < 1 - small && t > small && t < 1 - small;
}

static double area(const flips *f, int32_t t) {
  const int32_t *corner = f->triangle + 3 * (size_t)t;
  const double *a = f->point + 3 * (size_t)corner[0];
  double u[3], v[3], n[3];
  minus(f->point + 3 * (size_t)corner[1], a, u);
  minus(f->point + 3 * (size_t)corner[2], a, v);
  bw_cross(u, v, n);
  return bw_norm(n);
}

static void set_twin(flips *f, int32_t s, int32_t t) {
  f->twin[s] = t;
  if (t >= 0)
    f->twin[t] = s;
}

/* (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c). */
static void flip(flips *f, int32_t s) {
  int32_t t = f->twin[s], first = s - s % 3, second = t - t % 3;
  int32_t a = from(f, s), b = to(f, s), c = apex(f, s), d = apex(f, t);
  int32_t bc = f->twin[next(s)], ca = f->twin[next(next(s))];
  int32_t ad = f->twin[next(t)], db = f->twin[next(next(t))];
  memcpy(f->triangle + first, (int32_t[3]){a, d, c}, 3 * sizeof a);
  memcpy(f->triangle + second, (int32_t[3]){d, b, c}, 3 * sizeof a);
  set_twin(f, first, ad);
  set_twin(f, first + 1, second + 2);
  set_twin(f, first + 2, ca);
  set_twin(f, second, db);
  set_twin(f, second + 1, bc);
  push(f, first);
  push(f, first + 2);
  push(f, second);
  push(f, second + 1);
}

bw_status bwi_flip_flat_edges(bw_context *context, const double *point, int32_t triangles,
                              int32_t *triangle, int32_t *group, uint8_t *fresh, double tolerance,
                              bwi_may_flip *may_flip, void *data) {
  bw_status status = BW_OK;
  int32_t sides = 3 * triangles;
  int64_t left = 20 * (int64_t)triangles; /* flips; rounding may let edges flip back and forth */
  flips f = {point,
             triangle,
             BW_NEW(context, int32_t, sides),
             BW_NEW(context, int32_t, sides),
             BW_NEW0(context, uint8_t, sides),
             0};
  BW_TRY_MEMORY(f.twin && f.stack && f.queued);
  BW_TRY(find_twins(context, &f, sides));
  for (int32_t s = sides - 1; s >= 0; s--)
    if (s < f.twin[s] && (fresh[s / 3] || fresh[f.twin[s] / 3]))
      push(&f, s);
  while (f.depth > 0 && left > 0) {
    int32_t s = f.stack[--f.depth], t = f.twin[s];
    f.queued[s] = 0;
    if (t < 0)
      continue;
    int32_t a = from(&f, s), b = to(&f, s), c = apex(&f, s), d = apex(&f, t);
    const double *x[4] = {point + 3 * (size_t)a, point + 3 * (size_t)b, point + 3 * (size_t)c,
                          point + 3 * (size_t)d};
    if (c == d || !is_poor(x[0], x[1], x[2], x[3]) || !is_flat(x[0], x[1], x[2], x[3], tolerance) ||
        has_edge(&f, next(next(s)), d) || !may_flip(data, a, b, c, d))
      continue;
    if (group) {
      int32_t first = s / 3, second = t / 3;
      if (group[first] != group[second])
        group[first] = group[second] =
            area(&f, first) < area(&f, second) ? group[second] : group[first];
    }
    flip(&f, s);
    fresh[s / 3] = fresh[t / 3] = 1;
    left--;
  }
done:
  bw_free(f.twin);
  bw_free(f.stack);
  bw_free(f.queued);
  return status;
}
