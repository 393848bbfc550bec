/* A tree of boxes over facets.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Nodes lie in depth-first order: the first child of node i is i + 1, the second is node[i].second.
 * A leaf has second = 0 and holds facet[first .. first + count). Every box holds the boxes below.
 * Facets are split at the median of their centroids along the longest side, so that the depth is
 * log2 of their number and a stack of 64 is enough. */
#include "mesh/surface_tree.h"

#include <math.h>
#include <string.h>

enum { LEAF = 4, DEPTH = 64 };

typedef struct node {
  double low[3], high[3];
  int32_t second; /* 0 for a leaf: node 0 is the root and nobody's child */
  int32_t first, count;
} node;

struct bwi_tree {
  const double *point;
  const int32_t *triangle;
  int32_t facet_count, node_count;
  int32_t *facet;
  node *node;
};

typedef struct builder {
  bwi_tree *tree;
  double *middle; /* of each facet's box, times two */
} builder;

static const double *corner_of(const bwi_tree *tree, int32_t facet, int k) {
  return tree->point + 3 * (int64_t)tree->triangle[3 * (int64_t)facet + k];
}

static void facet_box(const bwi_tree *tree, int32_t facet, double low[3], double high[3]) {
  memcpy(low, corner_of(tree, facet, 0), 3 * sizeof *low);
  memcpy(high, low, 3 * sizeof *low);
  for (int i = 1; i < 3; i++) {
    const double *x = corner_of(tree, facet, i);
    for (int k = 0; k < 3; k++) {
      low[k] = x[k] < low[k] ? x[k] : low[k];
      high[k] = x[k] > high[k] ? x[k] : high[k];
    }
  }
}

/* Does facet a come before facet b along an axis? Equal centroids are ordered by number. */
static bool before(const builder *build, int axis, int32_t a, int32_t b) {
  double x = build->middle[3 * (int64_t)a + axis], y = build->middle[3 * (int64_t)b + axis];
  return x < y || (x == y && a < b);
}

/* Arrange list so that list[nth] is in its sorted position, smaller ones before, larger after. */
static void select_nth(const builder *build, int axis, int32_t *list, int64_t count, int64_t nth) {
  int64_t low = 0, high = count - 1;
  while (low < high) {
    /* the median of three as the pivot */
    int32_t a = list[low], b = list[low + (high - low) / 2], c = list[high], pivot;
    if (before(build, axis, a, b))
      pivot = before(build, axis, b, c) ? b : before(build, axis, a, c) ? c : a;
    else
      pivot = before(build, axis, a, c) ? a : before(build, axis, b, c) ? c : b;
    int64_t i = low, j = high;
    while (i <= j) {
      while (before(build, axis, list[i], pivot))
        i++;
      while (before(build, axis, pivot, list[j]))
        j--;
      if (i <= j) {
        int32_t keep = list[i];
        list[i++] = list[j];
        list[j--] = keep;
      }
    }
    if (nth <= j)
      high = j;
    else if (nth >= i)
      low = i;
    else
      return;
  }
}

static void build_node(builder *build, int32_t first, int32_t count) {
  bwi_tree *tree = build->tree;
  int32_t at = tree->node_count++;
  node *n = &tree->node[at];
  double low[3], high[3], spread_low[3], spread_high[3];
  for (int k = 0; k < 3; k++) {
    n->low[k] = spread_low[k] = HUGE_VAL;
    n->high[k] = spread_high[k] = -HUGE_VAL;
  }
  for (int32_t i = 0; i < count; i++) {
    int32_t facet = tree->facet[first + i];
    facet_box(tree, facet, low, high);
    const double *middle = build->middle + 3 * (int64_t)facet;
    for (int k = 0; k < 3; k++) {
      n->low[k] = fmin(n->low[k], low[k]);
      n->high[k] = fmax(n->high[k], high[k]);
      spread_low[k] = fmin(spread_low[k], middle[k]);
      spread_high[k] = fmax(spread_high[k], middle[k]);
    }
  }
  n->first = first;
  n->count = count;
  n->second = 0;
  if (count <= LEAF)
    return;
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (spread_high[k] - spread_low[k] > spread_high[axis] - spread_low[axis])
      axis = k;
  int32_t half = count / 2;
  select_nth(build, axis, tree->facet + first, count, half);
  build_node(build, first, half);
  tree->node[at].second = tree->node_count;
  build_node(build, first + half, count - half);
}

bw_status bwi_tree_create(bw_context *context, const double *point, int64_t triangles,
                          const int32_t *triangle, const uint8_t *skip, bwi_tree **out) {
  bw_status status = BW_OK;
  builder build = {0};
  bwi_tree *tree = BW_NEW0(context, bwi_tree, 1);
  if (!tree)
    return BW_MEMORY;
  tree->point = point;
  tree->triangle = triangle;
  tree->facet = BW_NEW(context, int32_t, triangles);
  tree->node = BW_NEW(context, node, 2 * (size_t)(triangles > 0 ? triangles : 1));
  build.middle = BW_NEW(context, double, (size_t)triangles * 3);
  BW_TRY_MEMORY(tree->facet && tree->node && build.middle);
  build.tree = tree;
  for (int64_t t = 0; t < triangles; t++) {
    if (skip && skip[t])
      continue;
    double low[3], high[3];
    facet_box(tree, (int32_t)t, low, high);
    for (int k = 0; k < 3; k++)
      build.middle[3 * t + k] = low[k] + high[k];
    tree->facet[tree->facet_count++] = (int32_t)t;
  }
  if (tree->facet_count)
    build_node(&build, 0, tree->facet_count);
  *out = tree;
  tree = NULL;
done:
  bwi_tree_destroy(tree);
  bw_free(build.middle);
  return status;
}

void bwi_tree_destroy(bwi_tree *tree) {
  if (!tree)
    return;
  bw_free(tree->facet);
  bw_free(tree->node);
  bw_free(tree);
}

static bool boxes_meet(const double low[3], const double high[3], const double other_low[3],
                       const double other_high[3]) {
  for (int k = 0; k < 3; k++)
    if (low[k] > other_high[k] || other_low[k] > high[k])
      return false;
  return true;
}

void bwi_tree_in_box(const bwi_tree *tree, const double low[3], const double high[3],
                     bwi_tree_visit *visit, void *data) {
  int32_t stack[DEPTH];
  int depth = 0;
  if (tree->facet_count)
    stack[depth++] = 0;
  while (depth > 0) {
    int32_t at = stack[--depth];
    const node *n = &tree->node[at];
    if (!boxes_meet(low, high, n->low, n->high))
      continue;
    if (n->second) {
      stack[depth++] = n->second;
      stack[depth++] = at + 1;
      continue;
    }
    for (int32_t i = 0; i < n->count; i++) {
      double facet_low[3], facet_high[3];
      facet_box(tree, tree->facet[n->first + i], facet_low, facet_high);
      if (boxes_meet(low, high, facet_low, facet_high) && !visit(data, tree->facet[n->first + i]))
        return;
    }
  }
}

/* Does a segment meet a box? Rounding may say yes for a near miss, never no for a hit. */
static bool segment_meets_box(const double p[3], const double q[3], const node *n) {
  double from = 0, to = 1;
  for (int k = 0; k < 3; k++) {
    double d = q[k] - p[k], slack = 1e-12 * (fabs(p[k]) + fabs(q[k]));
    double low = n->low[k] - slack, high = n->high[k] + slack;
    if (fabs(d) <= 1e-300) {
      if (p[k] < low || p[k] > high)
        return false;
      continue;
    }
    double s = (low - p[k]) / d, t = (high - p[k]) / d;
    if (s > t) {
      double keep = s;
      s = t;
      t = keep;
    }
    from = s > from ? s : from;
    to = t < to ? t : to;
    if (from > to + 1e-12)
      return false;
  }
  return true;
}

void bwi_tree_on_segment(const bwi_tree *tree, const double p[3], const double q[3],
                         bwi_tree_visit *visit, void *data) {
  int32_t stack[DEPTH];
  int depth = 0;
  if (tree->facet_count)
    stack[depth++] = 0;
  while (depth > 0) {
    int32_t at = stack[--depth];
    const node *n = &tree->node[at];
    if (!segment_meets_box(p, q, n))
      continue;
    if (n->second) {
      stack[depth++] = n->second;
      stack[depth++] = at + 1;
      continue;
    }
    for (int32_t i = 0; i < n->count; i++)
      if (!visit(data, tree->facet[n->first + i]))
        return;
  }
}

/* ---- the nearest place -------------------------------------------------------------------- */

static double square_distance(const double x[3], const double y[3]) {
  double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
  return bw_dot(d, d);
}

static double nearest_on_segment(const double x[3], const double a[3], const double b[3],
                                 double place[3]) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  double r[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
  double length = bw_dot(d, d), t = length > 0 ? bw_dot(r, d) / length : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  for (int k = 0; k < 3; k++)
    place[k] = a[k] + t * d[k];
  return square_distance(x, place);
}

double bwi_nearest_on_triangle(const double x[3], const double a[3], const double b[3],
                               const double c[3], double place[3]) {
  double u[3], v[3], r[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    r[k] = x[k] - a[k];
  }
  /* Barycentric coordinates of the foot of the perpendicular, by areas along the normal: the normal
   * equations would lose twice as many digits in a thin triangle. */
  double n[3], q[3];
  bw_cross(u, v, n);
  double nn = bw_dot(n, n);
  if (nn > 0) {
    bw_cross(r, v, q);
    double s = bw_dot(q, n) / nn;
    bw_cross(u, r, q);
    double t = bw_dot(q, n) / nn;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      double height = bw_dot(r, n);
      for (int k = 0; k < 3; k++)
        place[k] = a[k] + s * u[k] + t * v[k];
      return height * height / nn;
    }
  }
  double other[3], best = nearest_on_segment(x, a, b, place);
  double far = nearest_on_segment(x, b, c, other);
  if (far < best) {
    best = far;
    memcpy(place, other, sizeof other);
  }
  far = nearest_on_segment(x, c, a, other);
  if (far < best) {
    best = far;
    memcpy(place, other, sizeof other);
  }
  return best;
}

static double box_distance(const double x[3], const node *n) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double d = x[k] < n->low[k] ? n->low[k] - x[k] : x[k] > n->high[k] ? x[k] - n->high[k] : 0;
    sum += d * d;
  }
  return sum;
}

/* The search for something nearer than sqrt(best), until it is as near as sqrt(enough). */
static double search_below(const bwi_tree *tree, const double x[3], double best, double enough,
                           double place[3], int32_t *facet) {
  double other[3];
  struct {
    int32_t at;
    double far;
  } stack[DEPTH];
  int depth = 0;
  if (tree->facet_count) {
    stack[0].at = 0;
    stack[depth++].far = box_distance(x, &tree->node[0]);
  }
  while (depth > 0 && best > enough) {
    depth--;
    if (stack[depth].far >= best)
      continue;
    int32_t at = stack[depth].at;
    const node *n = &tree->node[at];
    if (n->second) {
      int32_t near = at + 1, away = n->second;
      double near_far = box_distance(x, &tree->node[near]),
             away_far = box_distance(x, &tree->node[away]);
      if (away_far < near_far) {
        int32_t keep = near;
        near = away;
        away = keep;
        double keep_far = near_far;
        near_far = away_far;
        away_far = keep_far;
      }
      if (away_far < best) {
        stack[depth].at = away;
        stack[depth++].far = away_far;
      }
      if (near_far < best) {
        stack[depth].at = near;
        stack[depth++].far = near_far;
      }
      continue;
    }
    for (int32_t i = 0; i < n->count; i++) {
      int32_t t = tree->facet[n->first + i];
      double far = bwi_nearest_on_triangle(x, corner_of(tree, t, 0), corner_of(tree, t, 1),
                                           corner_of(tree, t, 2), other);
      if (far < best) {
        best = far;
        *facet = t;
        memcpy(place, other, sizeof other);
      }
    }
  }
  return best;
}

double bwi_tree_nearest(const bwi_tree *tree, const double x[3], int32_t hint, double enough,
                        double place[3], int32_t *facet) {
  double best = HUGE_VAL;
  *facet = -1;
  if (hint >= 0) {
    best = bwi_nearest_on_triangle(x, corner_of(tree, hint, 0), corner_of(tree, hint, 1),
                                   corner_of(tree, hint, 2), place);
    *facet = hint;
  }
  return search_below(tree, x, best, enough, place, facet);
}

bool bwi_tree_is_near(const bwi_tree *tree, const double x[3], double limit, int32_t *hint) {
  double square = limit * limit, place[3];
  if (bwi_nearest_on_triangle(x, corner_of(tree, *hint, 0), corner_of(tree, *hint, 1),
                              corner_of(tree, *hint, 2), place) <= square)
    return true;
  double more = nextafter(square, INFINITY);
  return search_below(tree, x, more, square, place, hint) <= square;
}

typedef struct within {
  const bwi_tree *tree;
  const double *x;
  double square;
  int32_t first;
} within;

static bool visit_within(void *data, int32_t facet) {
  within *w = (within *)data;
  double place[3];
  if (facet < w->first &&
      bwi_nearest_on_triangle(w->x, corner_of(w->tree, facet, 0), corner_of(w->tree, facet, 1),
                              corner_of(w->tree, facet, 2), place) <= w->square)
    w->first = facet;
  return true;
}

int32_t bwi_tree_first_within(const bwi_tree *tree, const double x[3], double limit) {
  within w = {tree, x, limit * limit, INT32_MAX};
  double low[3], high[3];
  for (int k = 0; k < 3; k++) {
    low[k] = x[k] - limit;
    high[k] = x[k] + limit;
  }
  bwi_tree_in_box(tree, low, high, visit_within, &w);
  return w.first < INT32_MAX ? w.first : -1;
}
