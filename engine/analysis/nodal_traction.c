/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Tractions on facets from forces at their nodes: means weighted by the hat functions of corners
 * (docs/theory/elements.md#interface-tractions). */
#include "analysis/nodal_traction.h"

#include <string.h>

#include "model/internal.h"

bw_status bwi_nodal_traction_open(bw_context *context, const bw_mesh *mesh, int32_t count,
                                  const int32_t *facet, bwi_nodal_traction *t) {
  *t = (bwi_nodal_traction){.mesh = mesh, .count = count, .facet = facet};
  t->gathered = BW_NEW0(context, uint8_t, mesh->node_count);
  t->area = BW_NEW0(context, double, mesh->node_count);
  t->normal = BW_NEW0(context, double, 3 * (int64_t)mesh->node_count);
  return t->gathered && t->area && t->normal ? BW_OK : BW_MEMORY;
}

void bwi_nodal_traction_clear(bwi_nodal_traction *t) {
  bw_free(t->gathered);
  bw_free(t->area);
  bw_free(t->normal);
}

static const int32_t *nodes_of(const bwi_nodal_traction *t, int32_t facet) {
  return t->facet + (int64_t)facet * t->mesh->nodes_per_facet;
}

double bwi_nodal_traction_integrate(bwi_nodal_traction *t) {
  double area = 0;
  for (int32_t f = 0; f < t->count; f++) {
    const int32_t *node = nodes_of(t, f);
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int points = bwi_facet_points(t->mesh, node, point);
    for (int p = 0; p < points; p++) {
      double size = bw_norm(point[p].area);
      area += size;
      for (int k = 0; k < t->mesh->nodes_per_facet; k++) {
        t->area[node[k]] += point[p].shape[k] * size;
        for (int c = 0; c < 3; c++)
          t->normal[3 * (int64_t)node[k] + c] += point[p].shape[k] * point[p].area[c];
      }
    }
  }
  return area;
}

static void add_half(double *value, int64_t middle, int64_t end, int width) {
  for (int c = 0; c < width; c++)
    value[width * end + c] += 0.5 * value[width * middle + c];
}

/* The function of a corner and half of those of its edges are a hat: once for each edge. */
static void gather_at_corners(bwi_nodal_traction *t, double *force) {
  for (int32_t f = 0; f < t->count && t->mesh->order == 2; f++) {
    const int32_t *node = nodes_of(t, f);
    for (int k = 0; k < 3; k++) {
      int32_t middle = node[3 + k];
      for (int e = 0; e < 2 && !t->gathered[middle]; e++) {
        int32_t end = node[(k + e) % 3];
        add_half(force, middle, end, 3);
        add_half(t->area, middle, end, 1);
        add_half(t->normal, middle, end, 3);
      }
      t->gathered[middle] = 1;
    }
  }
}

static void write_corner(const bwi_nodal_traction *t, const double *force, int64_t i,
                         double *traction, double *normal, double *shear) {
  double *out = traction + 3 * i, size = bw_norm(t->normal + 3 * i), along[3];
  if (!(t->area[i] > 0))
    return;
  for (int k = 0; k < 3; k++)
    out[k] = force[3 * i + k] / t->area[i];
  normal[i] = size > 0 ? bw_dot(out, t->normal + 3 * i) / size : 0;
  for (int k = 0; k < 3; k++)
    along[k] = out[k] - (size > 0 ? normal[i] * t->normal[3 * i + k] / size : 0);
  shear[i] = bw_norm(along);
}

void bwi_nodal_traction_write(bwi_nodal_traction *t, double *force, double *traction,
                              double *normal, double *shear) {
  const bw_mesh *mesh = t->mesh;
  size_t nodes = (size_t)mesh->node_count;
  memset(traction, 0, 3 * nodes * sizeof *traction);
  memset(normal, 0, nodes * sizeof *normal);
  memset(shear, 0, nodes * sizeof *shear);
  gather_at_corners(t, force);
  for (int32_t f = 0; f < t->count; f++)
    for (int k = 0; k < 3; k++)
      write_corner(t, force, nodes_of(t, f)[k], traction, normal, shear);
  for (int32_t f = 0; f < t->count && mesh->order == 2; f++) {
    const int32_t *node = nodes_of(t, f);
    for (int k = 0; k < 3; k++) {
      int64_t middle = node[3 + k], a = node[k], b = node[(k + 1) % 3];
      for (int c = 0; c < 3; c++)
        traction[3 * middle + c] = 0.5 * (traction[3 * a + c] + traction[3 * b + c]);
      normal[middle] = 0.5 * (normal[a] + normal[b]);
      shear[middle] = 0.5 * (shear[a] + shear[b]);
    }
  }
}
