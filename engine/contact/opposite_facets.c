/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which facet of another part a point of contact faces: that with the nearest point. */
#include <math.h>
#include <string.h>

#include "base/box_tree.h"
#include "contact/internal.h"
#include "model/internal.h"

enum { LEAF = 8 };

/* A point faces a facet when its distance along the facet is below this fraction of the gap... */
static const double slant = 0.5;
/* ... or of the size of the facet. */
static const double beside = 1e-6;

typedef struct search {
  const bw_mesh *mesh;
  const bw_selection *against;
} search;

static const int32_t *corners(const search *s, int32_t item) {
  return s->mesh->facet + (int64_t)s->against->facet[item] * s->mesh->nodes_per_facet;
}

/* Barycentric coordinates of the point of a triangle nearest to p (Ericson, Real-Time Collision
 * Detection, section 5.1.5). */
static void nearest_in_triangle(const double *a, const double *b, const double *c, const double *p,
                                double bary[3]) {
  double ab[3], ac[3], ap[3], bp[3], cp[3];
  for (int k = 0; k < 3; k++) {
    ab[k] = b[k] - a[k];
    ac[k] = c[k] - a[k];
    ap[k] = p[k] - a[k];
    bp[k] = p[k] - b[k];
    cp[k] = p[k] - c[k];
  }
  double d1 = bw_dot(ab, ap), d2 = bw_dot(ac, ap), d3 = bw_dot(ab, bp), d4 = bw_dot(ac, bp);
  double d5 = bw_dot(ab, cp), d6 = bw_dot(ac, cp);
  double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, t;
  memset(bary, 0, 3 * sizeof *bary);
  if (d1 <= 0 && d2 <= 0)
    bary[0] = 1;
  else if (d3 >= 0 && d4 <= d3)
    bary[1] = 1;
  else if (d6 >= 0 && d5 <= d6)
    bary[2] = 1;
  else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    t = d1 / (d1 - d3);
    bary[0] = 1 - t;
    bary[1] = t;
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    t = d2 / (d2 - d6);
    bary[0] = 1 - t;
    bary[2] = t;
  } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    t = (d4 - d3) / (d4 - d3 + d5 - d6);
    bary[1] = 1 - t;
    bary[2] = t;
  } else {
    bary[1] = vb / (va + vb + vc);
    bary[2] = vc / (va + vb + vc);
    bary[0] = 1 - bary[1] - bary[2];
  }
}

static double distance_to(void *data, int32_t item, const double *p) {
  const search *s = data;
  const int32_t *node = corners(s, item);
  const double *x[3];
  double bary[3], square = 0;
  for (int k = 0; k < 3; k++)
    x[k] = s->mesh->node + 3 * (int64_t)node[k];
  nearest_in_triangle(x[0], x[1], x[2], p, bary);
  for (int i = 0; i < 3; i++) {
    double off = p[i] - bary[0] * x[0][i] - bary[1] * x[1][i] - bary[2] * x[2][i];
    square += off * off;
  }
  return square;
}

static void box_of(const void *data, int32_t item, double *min, double *max) {
  const search *s = data;
  const int32_t *node = corners(s, item);
  for (int i = 0; i < 3; i++) {
    min[i] = INFINITY;
    max[i] = -INFINITY;
    for (int k = 0; k < 3; k++) {
      min[i] = fmin(min[i], s->mesh->node[3 * (int64_t)node[k] + i]);
      max[i] = fmax(max[i], s->mesh->node[3 * (int64_t)node[k] + i]);
    }
  }
}

/* Whether the point, at x, faces the facet of the item. */
static bool faces(const search *s, int32_t item, const double x[3], bwi_contact_point *point) {
  const bw_mesh *mesh = s->mesh;
  const int32_t *node = corners(s, item);
  double bary[3], y[3] = {0}, off[3], size, along;
  nearest_in_triangle(mesh->node + 3 * (int64_t)node[0], mesh->node + 3 * (int64_t)node[1],
                      mesh->node + 3 * (int64_t)node[2], x, bary);
  point->opposite = s->against->facet[item];
  bw_facet_shape(mesh->order, bary, point->far);
  bwi_boundary_normal(mesh, point->opposite, bary, point->normal);
  size = bw_norm(point->normal);
  for (int a = 0; a < mesh->nodes_per_facet; a++)
    for (int i = 0; i < 3; i++)
      y[i] += point->far[a] * mesh->node[3 * (int64_t)node[a] + i];
  for (int i = 0; i < 3; i++) {
    point->normal[i] /= size;
    off[i] = x[i] - y[i];
  }
  point->apart = along = bw_dot(point->normal, off);
  for (int i = 0; i < 3; i++)
    off[i] -= along * point->normal[i];
  return bw_norm(off) <= slant * fabs(along) + beside * sqrt(size);
}

bw_status bwi_contact_find_opposite(bw_context *context, const bw_mesh *mesh,
                                    const bw_contact_pair *pair, int64_t *count,
                                    bwi_contact_point *point) {
  bw_status status = BW_OK;
  search s = {.mesh = mesh, .against = pair->against};
  bwi_box_tree tree = {0};
  int64_t kept = 0;
  int32_t *item = BW_NEW(context, int32_t, pair->against->facet_count);
  BW_TRY_MEMORY(item);
  for (int32_t f = 0; f < pair->against->facet_count; f++)
    item[f] = f;
  BW_TRY(
      bwi_box_tree_create(context, 3, LEAF, pair->against->facet_count, item, box_of, &s, &tree));
  for (int64_t p = 0; p < *count; p++) {
    const int32_t *node = mesh->facet + (int64_t)point[p].facet * mesh->nodes_per_facet;
    double x[3] = {0}, square;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int i = 0; i < 3; i++)
        x[i] += point[p].shape[a] * mesh->node[3 * (int64_t)node[a] + i];
    int32_t nearest = bwi_box_tree_nearest(&tree, x, distance_to, &s, &square);
    if (nearest >= 0 && faces(&s, nearest, x, &point[p]))
      point[kept++] = point[p];
  }
  *count = kept;
done:
  bwi_box_tree_clear(&tree);
  return status;
}
