/* What is wrong with a surface.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

const char *bw_defect_word(bw_defect_kind kind) {
  static const char *const words[BW_DEFECT_KINDS] = {
      "open edge",         "non-manifold edge", "non-manifold point", "misoriented edge",
      "self-intersection", "duplicate facet",   "zero-area facet",    "flipped shell"};
  return kind >= 0 && kind < BW_DEFECT_KINDS ? words[kind] : "unknown defect";
}

void bw_surface_report_clear(bw_surface_report *report) {
  bw_free(report->defect);
  report->defect = NULL;
  report->defect_count = 0;
}

typedef struct checker {
  bw_context *context;
  const bwi_topology *topology;
  bw_surface_report *report;
  int64_t limit;
  size_t capacity;
} checker;

static bw_status add(checker *check, bw_defect_kind kind, int32_t facet, int32_t other,
                     const double at[3]) {
  bw_surface_report *report = check->report;
  if (report->count[kind]++ >= check->limit)
    return BW_OK;
  if (!bw_grow(check->context, (void **)&report->defect, &check->capacity,
               (size_t)report->defect_count, 1, sizeof *report->defect))
    return BW_MEMORY;
  bw_defect *defect = &report->defect[report->defect_count++];
  defect->kind = kind;
  defect->facet = facet;
  defect->other = other;
  memcpy(defect->at, at, sizeof defect->at);
  return BW_OK;
}

static const double *corner_at(const bwi_topology *topology, int64_t side) {
  return topology->point + 3 * (int64_t)topology->corner[side];
}

static void facet_centroid(const bwi_topology *topology, int64_t t, double at[3]) {
  for (int k = 0; k < 3; k++)
    at[k] = (corner_at(topology, 3 * t)[k] + corner_at(topology, 3 * t + 1)[k] +
             corner_at(topology, 3 * t + 2)[k]) /
            3;
}

static void side_midpoint(const bwi_topology *topology, int64_t side, double at[3]) {
  const double *a = topology->point + 3 * (int64_t)bwi_side_from(topology, side),
               *b = topology->point + 3 * (int64_t)bwi_side_to(topology, side);
  for (int k = 0; k < 3; k++)
    at[k] = 0.5 * (a[k] + b[k]);
}

/* Edges with another number of facets than two, and loops of open ones. */
static bw_status check_edges(checker *check) {
  const bwi_topology *topology = check->topology;
  bw_status status = BW_OK;
  double at[3];
  int32_t *parent = BW_NEW(check->context, int32_t, topology->points);
  uint8_t *open = BW_NEW0(check->context, uint8_t, topology->points);
  BW_TRY_MEMORY(parent && open);
  for (int32_t i = 0; i < topology->points; i++)
    parent[i] = i;
  for (bw_defect_kind kind = BW_DEFECT_OPEN_EDGE; kind <= BW_DEFECT_MISORIENTED_EDGE; kind++) {
    if (kind == BW_DEFECT_NONMANIFOLD_POINT)
      continue;
    for (int64_t e = 0; e < topology->edges; e++) {
      int64_t first = topology->start[e], facets = topology->start[e + 1] - first;
      int64_t s = topology->side[first], t = facets > 1 ? topology->side[first + 1] : -1;
      bool bad = kind == BW_DEFECT_OPEN_EDGE ? facets == 1
                 : kind == BW_DEFECT_NONMANIFOLD_EDGE
                     ? facets > 2
                     : facets == 2 && bwi_side_from(topology, s) == bwi_side_from(topology, t);
      if (!bad)
        continue;
      if (kind == BW_DEFECT_OPEN_EDGE) {
        open[bwi_side_from(topology, s)] = open[bwi_side_to(topology, s)] = 1;
        bwi_set_join(parent, bwi_side_from(topology, s), bwi_side_to(topology, s));
      }
      side_midpoint(topology, s, at);
      BW_TRY(add(check, kind, (int32_t)(s / 3), t < 0 ? -1 : (int32_t)(t / 3), at));
    }
  }
  for (int32_t i = 0; i < topology->points; i++)
    check->report->holes += open[i] && bwi_set_root(parent, i) == i;
done:
  bw_free(parent);
  bw_free(open);
  return status;
}

/* Points whose facets do not form one fan: corners of facets are joined across edges; a point with
 * more than one set of corners, or on an edge of three facets, is not manifold. */
static bw_status check_points(checker *check) {
  const bwi_topology *topology = check->topology;
  bw_status status = BW_OK;
  int64_t sides = 3 * (int64_t)topology->facets;
  if (sides > INT32_MAX)
    return bw_fail(check->context, BW_LIMIT, "a surface of %d facets is too large to be checked",
                   topology->facets);
  int32_t *parent = BW_NEW(check->context, int32_t, sides);
  int32_t *fan = BW_NEW(check->context, int32_t, topology->points); /* the first set of corners */
  uint8_t *bad = BW_NEW0(check->context, uint8_t, topology->points);
  int32_t *facet = BW_NEW(check->context, int32_t, topology->points);
  BW_TRY_MEMORY(parent && fan && bad && facet);
  for (int64_t s = 0; s < sides; s++)
    parent[s] = (int32_t)s;
  for (int32_t i = 0; i < topology->points; i++)
    fan[i] = -1;
  for (int64_t e = 0; e < topology->edges; e++) {
    int64_t first = topology->start[e], facets = topology->start[e + 1] - first;
    int64_t s = topology->side[first];
    for (int64_t i = first; i < first + facets; i++) {
      int64_t t = topology->side[i];
      int64_t s_next = s % 3 == 2 ? s - 2 : s + 1, t_next = t % 3 == 2 ? t - 2 : t + 1;
      bool along = bwi_side_from(topology, s) == bwi_side_from(topology, t);
      bwi_set_join(parent, (int32_t)s, (int32_t)(along ? t : t_next));
      bwi_set_join(parent, (int32_t)s_next, (int32_t)(along ? t_next : t));
    }
    if (facets > 2)
      bad[bwi_side_from(topology, s)] = bad[bwi_side_to(topology, s)] = 1;
  }
  for (int64_t s = 0; s < sides; s++) {
    if (topology->degenerate[s / 3])
      continue;
    int32_t point = topology->corner[s], root = bwi_set_root(parent, (int32_t)s);
    if (fan[point] < 0) {
      fan[point] = root;
      facet[point] = (int32_t)(s / 3);
    } else if (fan[point] != root) {
      bad[point] = 1;
    }
  }
  for (int32_t i = 0; i < topology->points; i++)
    if (bad[i] && fan[i] >= 0)
      BW_TRY(
          add(check, BW_DEFECT_NONMANIFOLD_POINT, facet[i], -1, topology->point + 3 * (int64_t)i));
done:
  bw_free(parent);
  bw_free(fan);
  bw_free(bad);
  bw_free(facet);
  return status;
}

/* The middle of the box in which the boxes of two facets overlap: where they meet, or near it. */
static void meeting_place(const bwi_topology *topology, bwi_pair pair, double at[3]) {
  for (int k = 0; k < 3; k++) {
    double low = -HUGE_VAL, high = HUGE_VAL;
    for (int i = 0; i < 2; i++) {
      int64_t t = i ? pair.second : pair.first;
      double a = corner_at(topology, 3 * t)[k], b = corner_at(topology, 3 * t + 1)[k],
             c = corner_at(topology, 3 * t + 2)[k];
      low = fmax(low, fmin(a, fmin(b, c)));
      high = fmin(high, fmax(a, fmax(b, c)));
    }
    at[k] = 0.5 * (low + high);
  }
}

static bw_status check_facets(checker *check, const uint8_t *flat) {
  const bwi_topology *topology = check->topology;
  bw_status status = BW_OK;
  bwi_pair *pairs = NULL;
  int64_t count = 0;
  double at[3];
  int32_t *same = BW_NEW(check->context, int32_t, topology->facets);
  if (!same)
    return BW_MEMORY;
  BW_TRY(bwi_intersections(check->context, topology, flat, &pairs, &count));
  for (int64_t i = 0; i < count; i++) {
    meeting_place(topology, pairs[i], at);
    BW_TRY(add(check, BW_DEFECT_SELF_INTERSECTION, pairs[i].first, pairs[i].second, at));
  }
  BW_TRY(bwi_same_facets(check->context, topology, same));
  for (int32_t t = 0; t < topology->facets; t++)
    if (same[t] != t) {
      facet_centroid(topology, t, at);
      BW_TRY(add(check, BW_DEFECT_DUPLICATE_FACET, t, same[t], at));
    }
  for (int32_t t = 0; t < topology->facets; t++)
    if (flat[t]) {
      facet_centroid(topology, t, at);
      BW_TRY(add(check, BW_DEFECT_ZERO_AREA, t, -1, at));
    }
done:
  bw_free(same);
  bw_free(pairs);
  return status;
}

/* Closed shells whose facets agree, but face the wrong way for the depth at which they lie. */
static bw_status check_shells(checker *check, const uint8_t *flat) {
  const bwi_topology *topology = check->topology;
  bw_status status = BW_OK;
  int32_t shells = topology->shells;
  uint8_t *closed = BW_NEW(check->context, uint8_t, shells);
  uint8_t *agrees = BW_NEW(check->context, uint8_t, shells);
  int32_t *depth = BW_NEW0(check->context, int32_t, shells);
  int32_t *first = BW_NEW(check->context, int32_t, shells);
  double *volume = BW_NEW0(check->context, double, shells);
  BW_TRY_MEMORY(closed && agrees && depth && first && volume);
  memset(closed, 1, (size_t)shells);
  memset(agrees, 1, (size_t)shells);
  for (int64_t e = 0; e < topology->edges; e++) {
    int64_t start = topology->start[e], facets = topology->start[e + 1] - start;
    int64_t s = topology->side[start];
    int32_t shell = topology->shell[s / 3];
    if (facets % 2)
      closed[shell] = 0;
    if (facets != 2 ||
        bwi_side_from(topology, s) == bwi_side_from(topology, topology->side[start + 1]))
      agrees[shell] = 0;
  }
  for (int32_t t = topology->facets - 1; t >= 0; t--)
    if (topology->shell[t] >= 0)
      first[topology->shell[t]] = t;
  for (int32_t t = 0; t < topology->facets; t++) {
    int32_t s = topology->shell[t];
    if (s >= 0)
      volume[s] += bwi_facet_volume(topology->point, topology->corner + 3 * (int64_t)t,
                                    corner_at(topology, 3 * (int64_t)first[s]));
  }
  BW_TRY(bwi_shell_depths(check->context, topology, closed, flat, depth));
  for (int32_t s = 0; s < shells; s++)
    if (closed[s] && agrees[s] && volume[s] != 0 && (volume[s] < 0) != (depth[s] % 2 == 1)) {
      double at[3];
      facet_centroid(topology, first[s], at);
      BW_TRY(add(check, BW_DEFECT_FLIPPED_SHELL, first[s], -1, at));
    }
done:
  bw_free(closed);
  bw_free(agrees);
  bw_free(depth);
  bw_free(first);
  bw_free(volume);
  return status;
}

bw_status bw_surface_check(bw_context *context, const bw_surface *surface, int64_t limit,
                           bw_surface_report *out) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  bw_surface_report report = {0};
  uint8_t *flat = NULL;
  BW_TRY(bwi_topology_create(context, surface, &topology));
  flat = BW_NEW(context, uint8_t, topology->facets);
  BW_TRY_MEMORY(flat);
  BW_TRY(bwi_flat_facets(context, topology, flat));
  checker check = {context, topology, &report, limit, 0};
  BW_TRY(check_edges(&check));
  BW_TRY(check_points(&check));
  BW_TRY(check_facets(&check, flat));
  BW_TRY(check_shells(&check, flat));
  const int64_t *count = report.count;
  report.shells = topology->shells;
  report.closed = topology->edges > 0 && count[BW_DEFECT_OPEN_EDGE] == 0 &&
                  count[BW_DEFECT_NONMANIFOLD_EDGE] == 0;
  report.oriented = count[BW_DEFECT_MISORIENTED_EDGE] == 0 && count[BW_DEFECT_FLIPPED_SHELL] == 0;
  report.sound = report.closed && report.oriented && count[BW_DEFECT_NONMANIFOLD_POINT] == 0 &&
                 count[BW_DEFECT_SELF_INTERSECTION] == 0 && count[BW_DEFECT_DUPLICATE_FACET] == 0 &&
                 count[BW_DEFECT_ZERO_AREA] == 0;
  report.volume = bw_surface_volume(surface);
  report.area = bw_surface_area(surface);
  bw_surface_box(surface, report.min, report.max);
  *out = report;
  report.defect = NULL;
done:
  bw_surface_report_clear(&report);
  bw_free(flat);
  bwi_topology_destroy(topology);
  return status;
}
