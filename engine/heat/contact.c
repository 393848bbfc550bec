/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact that resists heat: two surfaces at the same place, each with nodes of its own, between
 * which a flux passes in proportion to the jump of the temperature. */
#include "heat/internal.h"
#include "model/internal.h"

#include <math.h>
#include <stdlib.h>

/* Nodes are at one place where they are closer than this times the length of a facet, and were
 * perhaps meant to be where they are closer than the second. */
static const double same_place = 1e-6, near_place = 1e-2;
/* Facets are sorted along this unit vector. It is oblique, so that few facets of a plane face have
 * the same value. */
static const double along[3] = {0.42532540, 0.58778525, 0.68819096};

typedef struct placed {
  double at; /* (m) the sum of the corners, along it */
  int32_t facet;
} placed;

static placed place(const bw_mesh *mesh, int32_t facet) {
  placed p = {0, facet};
  for (int a = 0; a < 3; a++)
    p.at += bw_dot(along, mesh->node +
                              3 * (int64_t)mesh->facet[(int64_t)facet * mesh->nodes_per_facet + a]);
  return p;
}

static int by_place(const void *a, const void *b) {
  const placed *p = a, *q = b;
  if (p->at != q->at)
    return p->at < q->at ? -1 : 1;
  return (p->facet > q->facet) - (p->facet < q->facet);
}

/* Whether each node of a facet has a node of the other one at its place: pair. */
static bool match(const bw_mesh *mesh, int32_t facet, int32_t other, double distance,
                  int32_t *pair) {
  const int n = mesh->nodes_per_facet;
  for (int a = 0; a < n; a++) {
    const double *x = mesh->node + 3 * (int64_t)mesh->facet[(int64_t)facet * n + a];
    pair[a] = -1;
    for (int b = 0; b < n && pair[a] < 0; b++) {
      int32_t node = mesh->facet[(int64_t)other * n + b];
      const double *y = mesh->node + 3 * (int64_t)node;
      double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      if (bw_norm(d) <= distance)
        pair[a] = node;
    }
    if (pair[a] < 0)
      return false;
  }
  return true;
}

/* Finds the facet of the list, sorted, that lies on a facet. */
static bool find_opposite(const bw_mesh *mesh, const placed *list, int32_t count, int32_t facet,
                          double distance, int32_t *pair) {
  const double at = place(mesh, facet).at, width = 4 * distance; /* above that of three corners */
  int32_t low = 0, high = count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (list[middle].at < at - width)
      low = middle + 1;
    else
      high = middle;
  }
  for (; low < count && list[low].at <= at + width; low++)
    if (match(mesh, facet, list[low].facet, distance, pair))
      return true;
  return false;
}

bw_status bwi_heat_pair(bw_context *context, const bw_mesh *mesh, bw_heat_condition *condition) {
  bw_status status = BW_OK;
  const bw_selection *on = condition->on, *with = condition->with;
  const int n = mesh->nodes_per_facet;
  double length, missed = 0;
  int32_t missed_count = 0;
  placed *list = BW_NEW(context, placed, with->facet_count);
  uint8_t *of_with = BW_NEW0(context, uint8_t, mesh->facet_count);
  condition->pair = BW_NEW(context, int32_t, (int64_t)on->facet_count * n);
  BW_TRY_MEMORY(list && of_with && condition->pair);
  for (int32_t i = 0; i < with->facet_count; i++) {
    list[i] = place(mesh, with->facet[i]);
    of_with[with->facet[i]] = 1;
  }
  qsort(list, (size_t)with->facet_count, sizeof *list, by_place);
  length = sqrt(bw_selection_area(on) / on->facet_count);
  condition->size = 0;
  for (int32_t f = 0; f < on->facet_count; f++) {
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int32_t *pair = condition->pair + (int64_t)f * n;
    if (of_with[on->facet[f]]) { /* heat would be counted on both sides */
      const double *x = mesh->node + 3 * (int64_t)mesh->facet[(int64_t)on->facet[f] * n];
      BW_TRY(bw_fail(context, BW_INVALID,
                     "contact: the facet at (%g, %g, %g) m is in both selections: select each side "
                     "by itself, for example by its region",
                     x[0], x[1], x[2]));
    }
    double area = 0;
    int points = bwi_boundary_points(mesh, on->facet[f], point);
    for (int p = 0; p < points; p++)
      area += bw_norm(point[p].area);
    if (find_opposite(mesh, list, with->facet_count, on->facet[f], same_place * length, pair)) {
      condition->size += area;
      continue;
    }
    if (find_opposite(mesh, list, with->facet_count, on->facet[f], near_place * length, pair)) {
      missed += area;
      missed_count++;
    }
    pair[0] = -1;
  }
  if (!(condition->size > 0))
    BW_TRY(bw_fail(context, BW_EMPTY,
                   "contact: no facet of one selection lies node by node on a facet of the other: "
                   "give the two sides of a region that mesh:separated made, or meshes that match "
                   "there"));
  if (missed_count)
    bw_warn(
        context,
        "contact: %d facets of %.3g m2 have no contact: they lie within %.0f %% of their length "
        "of facets of the other selection, but not on them node by node; move their nodes "
        "together if they touch",
        (int)missed_count, missed, 100 * near_place);
done:
  bw_free(list);
  bw_free(of_with);
  return status;
}

void bwi_heat_contact(const bw_mesh *mesh, const bw_heat_condition *condition,
                      const double *temperature, double *in, double *sum) {
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  const int n = mesh->nodes_per_facet;
  *sum = 0;
  for (int32_t f = 0; f < condition->on->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)condition->on->facet[f] * n;
    const int32_t *pair = condition->pair + (int64_t)f * n;
    int points = pair[0] < 0 ? 0 : bwi_boundary_points(mesh, condition->on->facet[f], point);
    for (int p = 0; p < points; p++) {
      double jump = 0;
      for (int a = 0; a < n; a++)
        jump += point[p].shape[a] * (temperature[pair[a]] - temperature[node[a]]);
      double heat = condition->coefficient * jump * bw_norm(point[p].area);
      *sum += heat;
      for (int a = 0; a < n; a++) {
        in[node[a]] += point[p].shape[a] * heat;
        in[pair[a]] -= point[p].shape[a] * heat;
      }
    }
  }
}

bw_status bwi_heat_join(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                        const bw_heat_condition *condition, double *values, bwi_heat_cross *cross) {
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  const int n = mesh->nodes_per_facet;
  int64_t most = cross->count + (int64_t)condition->on->facet_count * n * n * 2;
  int32_t *row = bw_resize(context, cross->row, (size_t)most, sizeof *row);
  if (!row)
    return BW_MEMORY;
  cross->row = row;
  int32_t *column = bw_resize(context, cross->column, (size_t)most, sizeof *column);
  if (!column)
    return BW_MEMORY;
  cross->column = column;
  double *value = bw_resize(context, cross->value, (size_t)most, sizeof *value);
  if (!value)
    return BW_MEMORY;
  cross->value = value;
  for (int32_t f = 0; f < condition->on->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)condition->on->facet[f] * n;
    const int32_t *pair = condition->pair + (int64_t)f * n;
    int points = pair[0] < 0 ? 0 : bwi_boundary_points(mesh, condition->on->facet[f], point);
    double matrix[6][6] = {{0}};
    for (int p = 0; p < points; p++)
      for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++)
          matrix[a][b] += condition->coefficient * bw_norm(point[p].area) * point[p].shape[a] *
                          point[p].shape[b];
    for (int a = 0; points && a < n; a++)
      for (int b = 0; b < n; b++) {
        if (b <= a) {
          values[bwi_heat_block(pattern, node[a], node[b])] += matrix[a][b];
          values[bwi_heat_block(pattern, pair[a], pair[b])] += matrix[a][b];
        }
        for (int side = 0; side < 2; side++) {
          row[cross->count] = side ? pair[b] : node[a];
          column[cross->count] = side ? node[a] : pair[b];
          value[cross->count++] = -matrix[a][b];
        }
      }
  }
  return BW_OK;
}

void bwi_heat_cross_clear(bwi_heat_cross *cross) {
  bw_free(cross->row);
  bw_free(cross->column);
  bw_free(cross->value);
}
