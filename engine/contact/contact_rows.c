/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The constraints of contact in the mean of hat functions (docs/theory/contact.md, eq. 2): points
 * of a rule on the selected facets, the rows B of the candidates, and products with them. */
#include <math.h>
#include <string.h>

#include "contact/internal.h"
#include "model/internal.h"

enum { DEGREE = 6 };

static bw_status check_pair(bw_context *context, const bw_mesh *mesh, int i,
                            const bw_contact_pair *pair) {
  if (pair->on->mesh != mesh)
    return bw_fail(context, BW_INVALID, "contact pair %d is on another mesh than the model's",
                   i + 1);
  if (pair->on->facet_count == 0)
    return bw_fail(context, BW_EMPTY,
                   "contact pair %d is on nodes without a facet: contact needs a selection with "
                   "facets",
                   i + 1);
  return BW_OK;
}

/* Numbers the corners of the facets of a pair by ascending nodes. */
static void number_corners(bwi_contact_rows *rows, int pair, int32_t *number) {
  const bw_mesh *mesh = rows->mesh;
  const bw_selection *on = rows->pair[pair].on;
  memset(number, 0xff, (size_t)mesh->node_count * sizeof *number);
  for (int32_t f = 0; f < on->facet_count; f++)
    for (int k = 0; k < 3; k++)
      number[mesh->facet[(int64_t)on->facet[f] * mesh->nodes_per_facet + k]] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (number[i] == 0) {
      number[i] = rows->count;
      rows->node[rows->count] = i;
      rows->of[rows->count++] = pair;
    }
}

static void add_points(bwi_contact_rows *rows, int pair, const int32_t *number) {
  const bw_mesh *mesh = rows->mesh;
  const bw_selection *on = rows->pair[pair].on;
  double barycentric[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int points = bw_triangle_quadrature(DEGREE, barycentric, weight);
  for (int32_t f = 0; f < on->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
    for (int p = 0; p < points; p++) {
      bwi_contact_point *point = &rows->point[rows->point_count++];
      double normal[3];
      bwi_boundary_normal(mesh, on->facet[f], barycentric[p], normal);
      *point = (bwi_contact_point){
          .facet = on->facet[f], .pair = pair, .area = weight[p] * bw_norm(normal) / 2};
      bw_facet_shape(mesh->order, barycentric[p], point->shape);
      for (int k = 0; k < 3; k++) {
        point->candidate[k] = number[node[k]];
        point->hat[k] = barycentric[p][k];
        rows->area[number[node[k]]] += point->area * barycentric[p][k];
      }
    }
  }
}

bw_status bwi_contact_rows_create(bw_context *context, const bw_mesh *mesh, int pair_count,
                                  const bw_contact_pair *pair, bwi_contact_rows *rows) {
  bw_status status = BW_OK;
  int64_t facets = 0;
  int32_t *number = BW_NEW(context, int32_t, mesh->node_count);
  *rows = (bwi_contact_rows){.mesh = mesh, .pair_count = pair_count, .pair = pair};
  BW_TRY_MEMORY(number);
  for (int i = 0; i < pair_count; i++) {
    BW_TRY(check_pair(context, mesh, i, &pair[i]));
    facets += pair[i].on->facet_count;
  }
  if (3 * facets > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "contact on %lld facets is too much", (long long)facets));
  rows->node = BW_NEW(context, int32_t, 3 * facets);
  rows->of = BW_NEW(context, int32_t, 3 * facets);
  rows->area = BW_NEW0(context, double, 3 * facets);
  rows->point = BW_NEW(context, bwi_contact_point, BW_QUADRATURE_POINTS * facets);
  BW_TRY_MEMORY(rows->node && rows->of && rows->area && rows->point);
  for (int i = 0; i < pair_count; i++) {
    number_corners(rows, i, number);
    add_points(rows, i, number);
  }
done:
  bw_free(number);
  return status;
}

void bwi_contact_rows_clear(bwi_contact_rows *rows) {
  bw_free(rows->node);
  bw_free(rows->of);
  bw_free(rows->area);
  bw_free(rows->point);
}

/* sum shape u over the facet's nodes */
static void at_point(const bw_mesh *mesh, const bwi_contact_point *point, const double *u,
                     double out[3]) {
  const int32_t *node = mesh->facet + (int64_t)point->facet * mesh->nodes_per_facet;
  memset(out, 0, 3 * sizeof *out);
  for (int a = 0; a < mesh->nodes_per_facet; a++)
    for (int k = 0; k < 3; k++)
      out[k] += point->shape[a] * u[3 * (int64_t)node[a] + k];
}

void bwi_contact_rows_linearise(bwi_contact_rows *rows, const double *displacement, double *gap) {
  memset(gap, 0, (size_t)rows->count * sizeof *gap);
  for (int64_t p = 0; p < rows->point_count; p++) {
    bwi_contact_point *point = &rows->point[p];
    double x[3], u[3];
    at_point(rows->mesh, point, rows->mesh->node, x);
    at_point(rows->mesh, point, displacement, u);
    for (int k = 0; k < 3; k++)
      x[k] += u[k];
    point->gap = bwi_rigid_gap(rows->pair[point->pair].with, x, point->normal);
    for (int k = 0; k < 3; k++)
      gap[point->candidate[k]] += point->area * point->hat[k] * point->gap;
  }
}

void bwi_contact_rows_measure(const bwi_contact_rows *rows, const double *u, double *gap) {
  memset(gap, 0, (size_t)rows->count * sizeof *gap);
  for (int64_t p = 0; p < rows->point_count; p++) {
    const bwi_contact_point *point = &rows->point[p];
    double at[3];
    at_point(rows->mesh, point, u, at);
    for (int k = 0; k < 3; k++)
      gap[point->candidate[k]] += point->area * point->hat[k] * bw_dot(point->normal, at);
  }
}

/* force += pressure n at a point. */
static void add_force(const bw_mesh *mesh, const bwi_contact_point *point, double pressure,
                      double *force) {
  const int32_t *node = mesh->facet + (int64_t)point->facet * mesh->nodes_per_facet;
  for (int a = 0; a < mesh->nodes_per_facet; a++)
    for (int k = 0; k < 3; k++)
      force[3 * (int64_t)node[a] + k] +=
          point->area * pressure * point->shape[a] * point->normal[k];
}

void bwi_contact_rows_columns(const bwi_contact_rows *rows, int columns, const int32_t *which,
                              double *force) {
  int64_t size = 3 * (int64_t)rows->mesh->node_count;
  memset(force, 0, (size_t)(columns * size) * sizeof *force);
  for (int64_t p = 0; p < rows->point_count; p++) {
    const bwi_contact_point *point = &rows->point[p];
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < columns; c++)
        if (which[c] == point->candidate[k])
          add_force(rows->mesh, point, point->hat[k], force + c * size);
  }
}

void bwi_contact_rows_force(const bwi_contact_rows *rows, int pair, const double *pressure,
                            double *force) {
  memset(force, 0, 3 * (size_t)rows->mesh->node_count * sizeof *force);
  for (int64_t p = 0; p < rows->point_count; p++) {
    const bwi_contact_point *point = &rows->point[p];
    double value = 0;
    if (pair >= 0 && point->pair != pair)
      continue;
    for (int k = 0; k < 3; k++)
      value += point->hat[k] * pressure[point->candidate[k]];
    if (value != 0)
      add_force(rows->mesh, point, value, force);
  }
}
