/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a model's supports constrain at each node.
 *
 * A support gives conditions d . u = v with unit directions d. At each node they are gathered into
 * an orthonormal set with values, by Gram-Schmidt: a condition that adds a direction extends the
 * set, one that lies in its span must agree with it. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

/* Directions nearer than this (radians) count as the same: normals of one flat face computed from
 * single-precision positions differ by as much, and must not constrain the plane they lie in. */
#define SAME_DIRECTION 1e-4
/* Values nearer than this, relative to the larger, agree. */
#define SAME_VALUE 1e-9
/* Facets that meet at a larger angle constrain a node along both their normals. */
#define CREASE_COSINE 0.7660444431189780 /* 40 degrees */

static bw_status add_condition(bw_context *context, const bw_model *model, int support,
                               bwi_constraint *constraint, const double d[3], double v) {
  double rest[3] = {d[0], d[1], d[2]}, value = v, size = fabs(v);
  for (int i = 0; i < constraint->count; i++) {
    double part = bw_dot(rest, constraint->direction[i]);
    for (int k = 0; k < 3; k++)
      rest[k] -= part * constraint->direction[i][k];
    value -= part * constraint->value[i];
    size = fmax(size, fabs(constraint->value[i]));
  }
  double length = bw_norm(rest);
  if (length > SAME_DIRECTION && constraint->count < 3) {
    for (int k = 0; k < 3; k++)
      constraint->direction[constraint->count][k] = rest[k] / length;
    constraint->value[constraint->count++] = value / length;
    return BW_OK;
  }
  if (fabs(value) <= SAME_VALUE * size)
    return BW_OK;
  char at[96], along[96], now[40], before[40];
  bwi_vector_string(at, sizeof at, model->mesh->node + 3 * (size_t)constraint->node, 6, 0);
  bwi_vector_string(along, sizeof along, d, 4, 1e-9);
  bwi_number_string(now, sizeof now, v, 6, 0);
  bwi_number_string(before, sizeof before, v - value, 6, 0);
  bw_status status =
      bw_fail(context, BW_INVALID,
              "support %d moves node %d at %s m by %s m along %s, but earlier supports move it by "
              "%s m: give one displacement to the nodes where supports meet",
              support + 1, constraint->node + 1, at, now, along, before);
  bw_detail_number(context, "node", constraint->node + 1.0);
  bw_detail_number(context, "support", support + 1);
  return status;
}

/* ---- slides along the body's own surface ----------------------------------------------------- */

/* The weight of a facet in the mean normal of its node: the angle at a corner. */
static double facet_weight(const bw_mesh *mesh, int32_t facet, int k) {
  if (k >= 3)
    return 1;
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  const double *x = mesh->node + 3 * (size_t)node[k];
  const double *p = mesh->node + 3 * (size_t)node[(k + 1) % 3];
  const double *q = mesh->node + 3 * (size_t)node[(k + 2) % 3];
  double a[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]};
  double b[3] = {q[0] - x[0], q[1] - x[1], q[2] - x[2]}, c[3];
  bw_cross(a, b, c);
  return atan2(bw_norm(c), bw_dot(a, b));
}

enum { CREASES = 8 };

/* Mean normals of the smooth pieces of surface that meet at a node; facets with flag 0 are left
 * out, unless all are. */
static int normals_at(const bw_mesh *mesh, const bwi_facet_incidence *at, const uint8_t *flag,
                      int32_t node, double (*normal)[3]) {
  double sum[CREASES][3];
  int pieces = 0;
  bool any = false;
  for (int64_t i = at->start[node]; i < at->start[node + 1]; i++)
    any = any || flag[at->list[i] / 8];
  for (int64_t i = at->start[node]; i < at->start[node + 1]; i++) {
    int32_t facet = (int32_t)(at->list[i] / 8);
    int place = (int)(at->list[i] % 8), best = -1;
    double n[3], cosine = CREASE_COSINE, weight = facet_weight(mesh, facet, place);
    if (any && !flag[facet])
      continue;
    bwi_boundary_normal_at(mesh, facet, place, n);
    double size = bw_norm(n);
    if (size == 0)
      continue;
    for (int p = 0; p < pieces; p++) {
      double c = bw_dot(n, sum[p]) / (size * bw_norm(sum[p]));
      if (c > cosine || (pieces == CREASES && best < 0)) {
        cosine = c;
        best = p;
      }
    }
    if (best < 0) {
      best = pieces++;
      memset(sum[best], 0, sizeof sum[best]);
    }
    for (int k = 0; k < 3; k++)
      sum[best][k] += weight * n[k] / size;
  }
  for (int p = 0; p < pieces; p++) {
    double size = bw_norm(sum[p]);
    for (int k = 0; k < 3; k++)
      normal[p][k] = sum[p][k] / size;
  }
  return pieces;
}

/* ---- all supports ---------------------------------------------------------------------------- */

/* Axis by axis first, then given normals, then surface normals: so that directions stay along the
 * global axes where they can. */
static int rank_of(const bw_support *support) {
  return !support->slide ? 0 : bw_norm(support->normal) > 0 ? 1 : 2;
}

bw_status bwi_node_constraints(bw_context *context, const bw_model *model, int32_t *count,
                               bwi_constraint **constraint) {
  const bw_mesh *mesh = model->mesh;
  bw_status status = BW_OK;
  bwi_facet_incidence at = {NULL, NULL};
  uint8_t *flag = NULL;
  bwi_constraint *list = NULL;
  int32_t constrained = 0;
  int32_t *place = BW_NEW0(context, int32_t, mesh->node_count);
  if (!place)
    return BW_MEMORY;
  for (int s = 0; s < model->support_count; s++)
    for (int32_t i = 0; i < model->support[s].on->node_count; i++)
      place[model->support[s].on->node[i]] = 1;
  for (int32_t i = 0; i < mesh->node_count; i++)
    constrained += place[i];
  list = BW_NEW0(context, bwi_constraint, constrained);
  BW_TRY_MEMORY(list);
  constrained = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (place[i]) {
      place[i] = constrained;
      list[constrained++].node = i;
    }
  for (int rank = 0; rank < 3; rank++)
    for (int s = 0; s < model->support_count; s++) {
      const bw_support *support = &model->support[s];
      if (rank_of(support) != rank)
        continue;
      BW_TRY(bw_check_cancel(context));
      if (rank == 2) {
        if (!at.start)
          BW_TRY(bwi_facet_incidence_of(context, mesh, &at));
        if (!flag && !(flag = BW_NEW(context, uint8_t, mesh->facet_count))) {
          status = BW_MEMORY;
          goto done;
        }
        memset(flag, 0, (size_t)mesh->facet_count);
        for (int32_t f = 0; f < support->on->facet_count; f++)
          flag[support->on->facet[f]] = 1;
      }
      for (int32_t i = 0; i < support->on->node_count; i++) {
        bwi_constraint *node = &list[place[support->on->node[i]]];
        double normal[CREASES][3] = {{0}};
        int normals = 0;
        if (rank == 0)
          for (int k = 0; k < 3; k++) {
            double axis[3] = {k == 0, k == 1, k == 2};
            if (support->fixed[k])
              BW_TRY(add_condition(context, model, s, node, axis,
                                   support->field ? bw_array_get(support->field, node->node, k)
                                                  : support->value[k]));
          }
        else if (rank == 1) {
          memcpy(normal[0], support->normal, sizeof normal[0]);
          normals = 1;
        } else
          normals = normals_at(mesh, &at, flag, node->node, normal);
        for (int n = 0; n < normals; n++)
          BW_TRY(add_condition(context, model, s, node, normal[n], 0));
      }
    }
  /* A support that constrains no direction leaves nodes without constraint. */
  int32_t kept = 0;
  for (int32_t i = 0; i < constrained; i++)
    if (list[i].count > 0)
      list[kept++] = list[i];
  *count = kept;
  *constraint = list;
  list = NULL;
done:
  bw_free(place);
  bw_free(flag);
  bwi_facet_incidence_clear(&at);
  bw_free(list);
  return status;
}
