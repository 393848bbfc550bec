/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How far the round faces that facets stand for are outside of these (docs/theory/contact.md, "Flat
 * facets of round faces"). */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "model/internal.h"

static const double smooth = 0.82;   /* cosine of 35 degrees: normals that differ less are of one
                                        face */
static const double border = 4.7;    /* (rad) corners whose facets span less are on its border */
static const double unknown = 0.02;  /* of heights: an arc of 35 degrees is less than a parabola */
static const double straight = 0.01; /* of the slope at the other end: there is none */

static const double *place(const bw_mesh *mesh, int32_t facet, int k) {
  return mesh->node + 3 * (int64_t)mesh->facet[(int64_t)facet * mesh->nodes_per_facet + k % 3];
}

/* Unit normal of a facet at its corner k, and its angle there. */
static double corner_normal(const bw_mesh *mesh, int32_t facet, int k, double normal[3]) {
  const double *x = place(mesh, facet, k), *y = place(mesh, facet, k + 1),
               *z = place(mesh, facet, k + 2);
  double a[3], b[3], turn[3], length;
  bwi_boundary_normal_at(mesh, facet, k, normal);
  length = bw_norm(normal);
  for (int i = 0; i < 3; i++) {
    normal[i] /= length;
    a[i] = y[i] - x[i];
    b[i] = z[i] - x[i];
  }
  bw_cross(a, b, turn);
  return atan2(bw_norm(turn), bw_dot(a, b));
}

/* The mean normal of the face at a facet's corner k, of the facets that are there. Whether the
 * corner is on the border of the face. */
static bool mean_normal(const bw_mesh *mesh, int32_t facet, int k, const int32_t *begin,
                        const int32_t *end, double mean[3]) {
  double own[3], other[3], spanned = 0;
  corner_normal(mesh, facet, k, own);
  memset(mean, 0, 3 * sizeof *mean);
  for (const int32_t *at = begin; at < end; at++) {
    double angle = corner_normal(mesh, *at / 3, *at % 3, other);
    if (!(bw_dot(own, other) > smooth))
      continue;
    spanned += angle;
    for (int i = 0; i < 3; i++)
      mean[i] += angle * other[i];
  }
  return spanned < border;
}

/* The height of the face over the middle of the edge from corner k, less that of the facet. */
static double edge_height(const bw_mesh *mesh, int32_t facet, int k, const double mean[3][3],
                          const bool *on_border) {
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  const double *x = place(mesh, facet, k), *y = place(mesh, facet, k + 1),
               *z = place(mesh, facet, k + 2);
  double edge[3], side[3], normal[3], slope[2], height;
  for (int i = 0; i < 3; i++) {
    edge[i] = y[i] - x[i];
    side[i] = z[i] - x[i];
  }
  bw_cross(edge, side, normal);
  for (int i = 0; i < 2; i++) {
    const double *n = mean[(k + i) % 3];
    slope[i] = (i ? 1 : -1) * bw_dot(n, edge) / bw_dot(n, normal) * bw_norm(normal);
  }
  for (int i = 0; i < 2; i++) /* nothing beyond the border turns the normal */
    if (on_border[(k + i) % 3] && fabs(slope[i]) < straight * fabs(slope[1 - i]))
      slope[i] = slope[1 - i];
  height = (slope[0] + slope[1]) / 8;
  for (int i = 0; i < 3 && mesh->nodes_per_facet > 3; i++)
    height -= (mesh->node[3 * (int64_t)node[3 + k] + i] - (x[i] + y[i]) / 2) * normal[i] /
              bw_norm(normal);
  return height;
}

bw_status bwi_contact_take_heights(bw_context *context, const bw_mesh *mesh, const bw_selection *on,
                                   double *height) {
  bw_status status = BW_OK;
  int32_t *start = BW_NEW0(context, int32_t, (int64_t)mesh->node_count + 1);
  int32_t *corner = BW_NEW(context, int32_t, 3 * (int64_t)on->facet_count);
  BW_TRY_MEMORY(start && corner);
  for (int pass = 0; pass < 2; pass++) { /* count, then list the corners at each node */
    for (int32_t f = on->facet_count - 1; f >= 0; f--)
      for (int k = 0; k < 3; k++) {
        int32_t node = mesh->facet[(int64_t)on->facet[f] * mesh->nodes_per_facet + k];
        if (pass == 0)
          start[node]++;
        else
          corner[--start[node]] = 3 * on->facet[f] + k;
      }
    for (int32_t i = 0; i < mesh->node_count && pass == 0; i++)
      start[i + 1] += start[i];
  }
  for (int32_t f = 0; f < on->facet_count; f++) {
    double mean[3][3];
    bool on_border[3];
    for (int k = 0; k < 3; k++) {
      int32_t node = mesh->facet[(int64_t)on->facet[f] * mesh->nodes_per_facet + k];
      on_border[k] = mean_normal(mesh, on->facet[f], k, corner + start[node],
                                 corner + start[node + 1], mean[k]);
    }
    for (int k = 0; k < 3; k++)
      height[3 * (int64_t)on->facet[f] + k] = edge_height(mesh, on->facet[f], k, mean, on_border);
  }
done:
  bw_free(start);
  bw_free(corner);
  return status;
}

static double height_at(const double *height, int32_t facet, const double lambda[3]) {
  double sum = 0;
  for (int k = 0; k < 3; k++)
    sum += 4 * lambda[k] * lambda[(k + 1) % 3] * height[3 * (int64_t)facet + k];
  return sum;
}

double bwi_contact_smoothing(const bw_mesh *mesh, const double *height,
                             const bwi_contact_point *point) {
  double change = -height_at(height, point->facet, point->hat), lambda[3];
  if (point->opposite < 0)
    return change;
  for (int k = 0; k < 3; k++)
    lambda[k] =
        point->far[k] +
        (mesh->nodes_per_facet > 3 ? (point->far[3 + k] + point->far[3 + (k + 2) % 3]) / 2 : 0);
  return change - height_at(height, point->opposite, lambda);
}

/* Mean changes of gaps (m) of the candidates: by round faces, or by what is not known of these. */
static double mean_changes(const bwi_contact_problem *c, double *change) {
  double most = 0;
  memset(change, 0, (size_t)c->count * sizeof *change);
  for (int64_t n = 0; n < c->rows.point_count; n++) {
    const bwi_contact_point *point = &c->rows.point[n];
    double by = point->area * bwi_contact_smoothing(c->rows.mesh, c->rows.height, point);
    if (c->rows.pair[point->pair].smooth)
      by *= unknown;
    for (int k = 0; k < 3; k++)
      change[point->candidate[k]] += point->hat[k] * by;
  }
  for (int i = 0; i < c->count; i++) {
    change[i] = c->rows.area[i] > 0 ? change[i] / c->rows.area[i] : 0;
    if (c->p[c->rows.first[i]] > 0)
      most = fmax(most, fabs(change[i]));
  }
  return most;
}

bw_status bwi_contact_round_pressure(bw_context *context, const bwi_contact_problem *c,
                                     double *change, double *pressure) {
  bw_status status = BW_OK;
  int n = c->working, m = c->motions, rows = c->row_count;
  double most = mean_changes(c, change);
  double *s = NULL, *q = BW_NEW(context, double, n), *e = BW_NEW(context, double, (int64_t)n *m);
  double *load = BW_NEW0(context, double, m), *slack = BW_NEW(context, double, n);
  double *p = BW_NEW(context, double, n), *w = BW_NEW(context, double, n);
  double *a = BW_NEW(context, double, m), *h = BW_NEW(context, double, (int64_t)m *m);
  uint8_t *active = BW_NEW(context, uint8_t, n);
  int *at = BW_NEW(context, int, n); /* rows along normals */
  BW_TRY_MEMORY(q && e && load && slack && p && w && a && h && active && at);
  for (int i = 0; i < c->count; i++)
    pressure[i] = c->p[c->rows.first[i]];
  if (!(most > BWI_CONTACT_ROUNDS * c->elastic))
    goto done;
  s = BW_NEW(context, double, (int64_t)n *n);
  BW_TRY_MEMORY(s);
  for (int k = 0, r = 0; k < n; k++) {
    at[k] = r;
    r += c->rows.first[c->member[k] + 1] - c->rows.first[c->member[k]];
  }
  memcpy(a, c->a, (size_t)m * sizeof *a);
  for (int k = 0; k < n; k++) { /* about the present state, which is in balance */
    int32_t i = c->member[k], row = c->rows.first[i];
    const double *motion = c->e + (int64_t)row * m;
    p[k] = pressure[i];
    active[k] = p[k] > 0;
    slack[k] = 0.1 * bwi_contact_small_gap(c) * c->rows.area[i];
    memcpy(e + (int64_t)k * m, motion, (size_t)m * sizeof *e);
    q[k] = (active[k] ? 0 : c->w[row]) + c->rows.area[i] * change[i] - bwi_dot(m, motion, a);
    for (int l = 0; l < m; l++)
      load[l] -= motion[l] * p[k];
    for (int l = 0; l < n; l++) {
      s[(int64_t)k * n + l] = c->s[(int64_t)at[k] * rows + at[l]];
      q[k] -= s[(int64_t)k * n + l] * c->p[c->rows.first[c->member[l]]];
    }
  }
  bwi_complementarity problem = {.count = n,
                                 .motions = m,
                                 .s = s,
                                 .q = q,
                                 .e = e,
                                 .load = load,
                                 .centre = c->a,
                                 .epsilon = c->epsilon,
                                 .slack = slack,
                                 .active = active,
                                 .p = p,
                                 .w = w,
                                 .a = a,
                                 .h = h};
  BW_TRY(bwi_complementarity_solve(context, &problem));
  for (int k = 0; k < n; k++)
    pressure[c->member[k]] = p[k];
done:
  bw_free(s);
  bw_free(q);
  bw_free(e);
  bw_free(load);
  bw_free(slack);
  bw_free(p);
  bw_free(w);
  bw_free(a);
  bw_free(h);
  bw_free(active);
  bw_free(at);
  return status;
}
