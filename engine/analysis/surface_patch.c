/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Patches of the boundary. See surface_patch.h. */
#include "analysis/surface_patch.h"

#include <math.h>
#include <string.h>

/* Quadratic facets are interpolated linearly on the four triangles between corners and middles,
 * which keeps all weights positive. */
static void make_rule(int nodes, double weight[BWI_PATCH_SAMPLES][6]) {
  static const double corner[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  static const int inner[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {4, 5, 3}};
  memset(weight, 0, sizeof(double[BWI_PATCH_SAMPLES][6]));
  int k = 0;
  for (int i = 0; i < BWI_PATCH_CUTS; i++)
    for (int j = 0; i + j < BWI_PATCH_CUTS; j++)
      for (int up = 0; up < (i + j < BWI_PATCH_CUTS - 1 ? 2 : 1); up++, k++) {
        double shift = up ? 2.0 / 3 : 1.0 / 3;
        double x = (i + shift) / BWI_PATCH_CUTS, y = (j + shift) / BWI_PATCH_CUTS;
        if (nodes == 3) {
          weight[k][0] = 1 - x - y, weight[k][1] = x, weight[k][2] = y;
          continue;
        }
        for (int t = 0; t < 4; t++) {
          const double *a = corner[inner[t][0]], *b = corner[inner[t][1]], *c = corner[inner[t][2]];
          double twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
          double u = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / twice;
          double v = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / twice;
          if (u < 0 || v < 0 || u + v > 1)
            continue;
          weight[k][inner[t][0]] = 1 - u - v;
          weight[k][inner[t][1]] = u;
          weight[k][inner[t][2]] = v;
          break;
        }
      }
}

bw_status bwi_surface_patches_begin(bw_context *context, const bw_mesh *mesh, double radius,
                                    bwi_surface_patches *patches) {
  bw_status status;
  size_t facets = (size_t)mesh->facet_count, threads = (size_t)bw_threads(context);
  *patches = (bwi_surface_patches){.mesh = mesh, .radius = radius};
  if (!(radius > 0) || !isfinite(radius))
    return bw_fail(context, BW_INVALID, "a radius greater than 0 expected, got %g m", radius);
  patches->area = BW_NEW(context, double, facets);
  patches->sample = BW_NEW(context, double, facets *BWI_PATCH_SAMPLES * 3);
  patches->seen = BW_NEW0(context, int32_t, facets * threads);
  patches->queue = BW_NEW(context, int32_t, facets * threads);
  if (!patches->area || !patches->sample || !patches->seen || !patches->queue)
    return BW_MEMORY;
  BW_TRY(bwi_incidence_of_elements(context, mesh->node_count, mesh->facet_count,
                                   mesh->nodes_per_facet, mesh->facet, &patches->around));
  make_rule(mesh->nodes_per_facet, patches->weight);
  for (size_t f = 0; f < facets; f++) {
    const int32_t *node = mesh->facet + f * (size_t)mesh->nodes_per_facet;
    const double *a = mesh->node + 3 * (size_t)node[0], *b = mesh->node + 3 * (size_t)node[1],
                 *c = mesh->node + 3 * (size_t)node[2];
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++)
      u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    bw_cross(u, v, n);
    patches->area[f] = 0.5 * sqrt(bw_dot(n, n));
    for (size_t k = 0; k < BWI_PATCH_SAMPLES; k++)
      for (size_t j = 0; j < 3; j++) {
        double x = 0;
        for (int i = 0; i < mesh->nodes_per_facet; i++)
          x += patches->weight[k][i] * mesh->node[3 * (size_t)node[i] + j];
        patches->sample[(f * BWI_PATCH_SAMPLES + k) * 3 + j] = x;
      }
  }
done:
  return status;
}

void bwi_surface_patches_clear(bwi_surface_patches *patches) {
  bwi_incidence_clear(&patches->around);
  bw_free(patches->area);
  bw_free(patches->sample);
  bw_free(patches->seen);
  bw_free(patches->queue);
}

/* The shares of a facet's samples; whether one is not 0. */
static bool shares_of(const bwi_surface_patches *p, int32_t facet, const double *centre,
                      double share[BWI_PATCH_SAMPLES]) {
  const double *x = p->sample + (size_t)facet * BWI_PATCH_SAMPLES * 3;
  double area = p->area[facet] / BWI_PATCH_SAMPLES, scale = 1 / (p->radius * p->radius);
  bool any = false;
  for (int k = 0; k < BWI_PATCH_SAMPLES; k++, x += 3) {
    double d[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    share[k] = fmax(0, area * (1 - scale * bw_dot(d, d)));
    any = any || share[k] > 0;
  }
  return any;
}

void bwi_surface_patch_visit(const bwi_surface_patches *p, int32_t node, int32_t mark, int worker,
                             void (*add)(void *data, int32_t facet,
                                         const double share[BWI_PATCH_SAMPLES]),
                             void *data) {
  const bw_mesh *mesh = p->mesh;
  const double *centre = mesh->node + 3 * (size_t)node;
  int32_t *seen = p->seen + (size_t)worker * mesh->facet_count, first = 0, last = 0;
  int32_t *queue = p->queue + (size_t)worker * mesh->facet_count;
  for (int64_t k = p->around.start[node]; k < p->around.start[node + 1]; k++) {
    seen[p->around.element[k]] = mark;
    queue[last++] = p->around.element[k];
  }
  while (first < last) {
    int32_t facet = queue[first++];
    double share[BWI_PATCH_SAMPLES];
    if (!shares_of(p, facet, centre, share))
      continue;
    add(data, facet, share);
    for (int a = 0; a < 3; a++) {
      int32_t corner = mesh->facet[(size_t)facet * mesh->nodes_per_facet + a];
      for (int64_t k = p->around.start[corner]; k < p->around.start[corner + 1]; k++)
        if (seen[p->around.element[k]] != mark) {
          seen[p->around.element[k]] = mark;
          queue[last++] = p->around.element[k];
        }
    }
  }
}
