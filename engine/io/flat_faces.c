/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The faces of a closed surface: what flat_faces.h says. */
#include "io/flat_faces.h"

#include <math.h>
#include <stdlib.h>

#include "barwright/base.h"

bw_status bwi_fail_repair(bw_context *context, const char *what) {
  return bw_fail(context, BW_GEOMETRY, "STEP holds closed solids, but %s: repair it first", what);
}

/* ---- faces ----------------------------------------------------------------------------------- */

int64_t bwi_flat_opposite(const bwi_topology *t, int64_t side) {
  int64_t first = t->start[t->edge_of[side]];
  return t->side[first] == side ? t->side[first + 1] : t->side[first];
}

static int64_t following(int64_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

static bw_status check_closed(bw_context *context, const bwi_topology *t) {
  for (int64_t e = 0; e < t->edges; e++) {
    if (t->start[e + 1] - t->start[e] != 2)
      return bwi_fail_repair(context, "an edge has a number of triangles other than two");
    int64_t a = t->side[t->start[e]], b = t->side[t->start[e] + 1];
    if (bwi_side_from(t, a) != bwi_side_to(t, b) || bwi_side_to(t, a) != bwi_side_from(t, b))
      return bwi_fail_repair(context, "neighbouring triangles face in different directions");
  }
  return BW_OK;
}

void bwi_flat_normal(const bwi_topology *t, int32_t facet, double n[3]) {
  const int32_t *c = t->corner + 3 * (size_t)facet;
  const double *a = t->point + 3 * (size_t)c[0], *b = t->point + 3 * (size_t)c[1],
               *d = t->point + 3 * (size_t)c[2];
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double v[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  bw_cross(u, v, n);
}

typedef struct sized {
  double area;
  int32_t facet;
} sized;

static int largest_first(const void *left, const void *right) {
  const sized *a = (const sized *)left, *b = (const sized *)right;
  return a->area != b->area ? (a->area < b->area) - (a->area > b->area)
                            : (a->facet > b->facet) - (a->facet < b->facet);
}

/* Whether a facet lies in the plane through `at` with the unit normal n, and faces as it does. */
static bool lies_in(const bwi_flat_faces *s, int32_t facet, const double at[3], const double n[3]) {
  const bwi_topology *t = s->topology;
  double own[3];
  for (int k = 0; k < 3; k++) {
    const double *x = t->point + 3 * (size_t)t->corner[3 * (size_t)facet + (size_t)k];
    double off = (x[0] - at[0]) * n[0] + (x[1] - at[1]) * n[1] + (x[2] - at[2]) * n[2];
    if (fabs(off) > s->tolerance)
      return false;
  }
  bwi_flat_normal(t, facet, own);
  return bw_dot(own, n) >= 0;
}

static bw_status find_faces(bwi_flat_faces *s) {
  bw_status status = BW_OK;
  const bwi_topology *t = s->topology;
  const int32_t *group = s->surface->group;
  int32_t count = 0;
  sized *order = BW_NEW(s->context, sized, t->facets + 1);
  int32_t *stack = BW_NEW(s->context, int32_t, t->facets + 1);
  BW_TRY_MEMORY(order && stack);
  for (int32_t i = 0; i < t->facets; i++) {
    double n[3];
    s->face_of[i] = -1;
    if (t->degenerate[i])
      continue;
    bwi_flat_normal(t, i, n);
    order[count++] = (sized){bw_norm(n), i};
  }
  qsort(order, (size_t)count, sizeof *order, largest_first);
  for (int32_t k = 0; k < count; k++) {
    int32_t seed = order[k].facet, depth = 0;
    double n[3];
    if (s->face_of[seed] >= 0)
      continue;
    if (!(order[k].area > 0))
      BW_TRY(bwi_fail_repair(s->context, "a triangle has no area"));
    bwi_flat_normal(t, seed, n);
    for (int j = 0; j < 3; j++)
      n[j] /= order[k].area;
    const double *at = t->point + 3 * (size_t)t->corner[3 * (size_t)seed];
    s->seed[s->face_count] = seed;
    s->face_of[seed] = s->face_count;
    stack[depth++] = seed;
    while (depth > 0) {
      int32_t facet = stack[--depth];
      for (int64_t side = 3 * (int64_t)facet; side < 3 * (int64_t)facet + 3; side++) {
        int32_t other = (int32_t)(bwi_flat_opposite(t, side) / 3);
        if (s->face_of[other] >= 0 || (group && group[other] != group[seed]) ||
            !lies_in(s, other, at, n))
          continue;
        s->face_of[other] = s->face_count;
        stack[depth++] = other;
      }
    }
    s->face_count++;
  }
done:
  bw_free(order);
  bw_free(stack);
  return status;
}

/* ---- borders --------------------------------------------------------------------------------- */

bool bwi_flat_is_border(const bwi_flat_faces *s, int64_t side) {
  return s->face_of[side / 3] != s->face_of[bwi_flat_opposite(s->topology, side) / 3];
}

int64_t bwi_flat_next(const bwi_flat_faces *s, int64_t side) {
  side = following(side);
  while (!bwi_flat_is_border(s, side))
    side = following(bwi_flat_opposite(s->topology, side));
  return side;
}

bool bwi_flat_is_across(const bwi_round *round, const double a[3], const double b[3],
                        double tolerance) {
  const double between[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return fabs(bw_dot(between, round->axis)) <= tolerance;
}

const bwi_round *bwi_flat_round_of(const bwi_flat_faces *s, int64_t side) {
  const bwi_topology *t = s->topology;
  const double tolerance = ROUND / FLAT * s->tolerance;
  const double *a = t->point + 3 * (size_t)bwi_side_from(t, side),
               *b = t->point + 3 * (size_t)bwi_side_to(t, side);
  for (int k = 0; s->round_of && k < 2; k++) {
    int32_t face = s->face_of[(k ? bwi_flat_opposite(t, side) : side) / 3];
    if (s->round_of[face] >= 0 && bwi_flat_is_across(&s->round[s->round_of[face]], a, b, tolerance))
      return &s->round[s->round_of[face]];
  }
  return NULL;
}

/* Whether the middle of three points lies on the line between the others. */
static bool is_straight(const bwi_flat_faces *s, int32_t from, int32_t middle, int32_t to) {
  const double *a = s->topology->point + 3 * (size_t)from,
               *b = s->topology->point + 3 * (size_t)middle,
               *c = s->topology->point + 3 * (size_t)to;
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double v[3] = {c[0] - b[0], c[1] - b[1], c[2] - b[2]};
  const double whole[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  double cross[3], length = bw_norm(whole);
  bw_cross(u, v, cross);
  return bw_dot(u, v) > 0 && bw_norm(cross) <= s->tolerance * length;
}

/* Points where more than two border edges meet, or two that go neither straight on nor along one
 * arc. */
static bw_status find_kept(bwi_flat_faces *s) {
  bw_status status = BW_OK;
  const bwi_topology *t = s->topology;
  int32_t *near = BW_NEW(s->context, int32_t, 2 * (size_t)t->points + 1);
  uint8_t *edges = BW_NEW0(s->context, uint8_t, t->points + 1);
  uint8_t *arcs = BW_NEW0(s->context, uint8_t, t->points + 1);
  BW_TRY_MEMORY(near && edges && arcs);
  for (int64_t e = 0; e < t->edges; e++) {
    int64_t side = t->side[t->start[e]];
    if (!bwi_flat_is_border(s, side))
      continue;
    int32_t end[2] = {bwi_side_from(t, side), bwi_side_to(t, side)};
    bool arc = bwi_flat_round_of(s, side);
    for (int k = 0; k < 2; k++) {
      uint8_t *count = &edges[end[k]];
      if (*count < 2) {
        near[2 * (size_t)end[k] + *count] = end[1 - k];
        arcs[end[k]] += arc;
      }
      *count = *count < 3 ? *count + 1 : 3;
    }
  }
  for (int32_t i = 0; i < t->points; i++)
    s->kept[i] =
        edges[i] > 2 ||
        (edges[i] == 2 && arcs[i] < 2 &&
         (arcs[i] == 1 || !is_straight(s, near[2 * (size_t)i], i, near[2 * (size_t)i + 1])));
done:
  bw_free(near);
  bw_free(edges);
  bw_free(arcs);
  return status;
}

/* A border without kept points is a circle, of which the first point is kept. One of lines has at
 * least three kept points, or keeps all. */
static void keep_enough(bwi_flat_faces *s, int64_t loop) {
  const bwi_topology *t = s->topology;
  int64_t at = loop;
  int kept = 0;
  bool arcs = false;
  int32_t first = bwi_side_from(t, at);
  do {
    const int32_t from = bwi_side_from(t, at);
    kept += s->kept[from];
    arcs = arcs || bwi_flat_round_of(s, at);
    first = from < first ? from : first;
    at = bwi_flat_next(s, at);
  } while (at != loop);
  if (arcs && kept == 0)
    s->kept[first] = 1;
  for (bool more = !arcs && kept < 3; more; more = at != loop) {
    s->kept[bwi_side_from(t, at)] = 1;
    at = bwi_flat_next(s, at);
  }
}

/* Each loop by its first side, in the order of facets. */
static bw_status find_loops(bwi_flat_faces *s) {
  bw_status status = BW_OK;
  int64_t sides = 3 * (int64_t)s->topology->facets;
  uint8_t *seen = BW_NEW0(s->context, uint8_t, sides + 1);
  BW_TRY_MEMORY(seen);
  for (int64_t side = 0; side < sides; side++) {
    if (seen[side] || s->face_of[side / 3] < 0 || !bwi_flat_is_border(s, side))
      continue;
    for (int64_t at = side; !seen[at]; at = bwi_flat_next(s, at))
      seen[at] = 1;
    s->loop[s->loop_count++] = side;
    keep_enough(s, side);
  }
done:
  bw_free(seen);
  return status;
}

static double diagonal(const bwi_topology *t) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double min = HUGE_VAL, max = -HUGE_VAL;
    for (int32_t i = 0; i < t->points; i++) {
      double x = t->point[3 * (size_t)i + (size_t)k];
      min = x < min ? x : min;
      max = x > max ? x : max;
    }
    sum += (max - min) * (max - min);
  }
  return sqrt(sum);
}

bw_status bwi_flat_faces_find(bw_context *context, const bw_surface *surface, bwi_flat_faces *s) {
  bw_status status = BW_OK;
  *s = (bwi_flat_faces){.context = context, .surface = surface};
  BW_TRY(bwi_topology_create(context, surface, &s->topology));
  const bwi_topology *t = s->topology;
  BW_TRY(check_closed(context, t));
  s->tolerance = FLAT * diagonal(t);
  s->face_of = BW_NEW(context, int32_t, t->facets + 1);
  s->seed = BW_NEW(context, int32_t, t->facets + 1);
  s->kept = BW_NEW0(context, uint8_t, t->points + 1);
  s->loop = BW_NEW(context, int64_t, 3 * (size_t)t->facets + 1);
  BW_TRY_MEMORY(s->face_of && s->seed && s->kept && s->loop);
  BW_TRY(find_faces(s));
  BW_TRY(find_kept(s));
done:
  return status;
}

bw_status bwi_flat_loops_find(bwi_flat_faces *s) {
  bw_status status = find_kept(s);
  return status == BW_OK ? find_loops(s) : status;
}

void bwi_flat_faces_clear(bwi_flat_faces *s) {
  bwi_topology_destroy(s->topology);
  bw_free(s->face_of);
  bw_free(s->seed);
  bw_free(s->round);
  bw_free(s->round_of);
  bw_free(s->kept);
  bw_free(s->loop);
}
