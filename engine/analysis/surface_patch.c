/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Patches of the boundary. See surface_patch.h. */
#include "analysis/surface_patch.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

static void place_samples(double at[BWI_PATCH_SAMPLES][3]) {
  int k = 0;
  for (int i = 0; i < BWI_PATCH_CUTS; i++)
    for (int j = 0; i + j < BWI_PATCH_CUTS; j++)
      for (int up = 0; up < (i + j < BWI_PATCH_CUTS - 1 ? 2 : 1); up++, k++) {
        double shift = up ? 2.0 / 3 : 1.0 / 3;
        at[k][1] = (i + shift) / BWI_PATCH_CUTS;
        at[k][2] = (j + shift) / BWI_PATCH_CUTS;
        at[k][0] = 1 - at[k][1] - at[k][2];
      }
}

double bwi_facet_area(const bw_mesh *mesh, int32_t facet) {
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  double u[3], v[3], n[3];
  for (size_t k = 0; k < 3; k++) {
    double x = mesh->node[3 * (size_t)node[0] + k];
    u[k] = mesh->node[3 * (size_t)node[1] + k] - x;
    v[k] = mesh->node[3 * (size_t)node[2] + k] - x;
  }
  bw_cross(u, v, n);
  return 0.5 * bw_norm(n);
}

/* Whether all nodes of a facet are constrained in all directions. */
static bool is_constrained(const bw_dof_map *dof_map, int nodes, const int32_t *node) {
  for (int k = 0; k < 3 * nodes; k++)
    if (dof_map->state[3 * (size_t)node[k / 3] + (size_t)(k % 3)] != BW_DOF_PRESCRIBED)
      return false;
  return true;
}

/* The area with which a facet counts: 0 where a support constrains it. */
static double patch_area(const bw_mesh *mesh, const bw_dof_map *dof_map, int32_t facet) {
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  return dof_map && is_constrained(dof_map, mesh->nodes_per_facet, node)
             ? 0
             : bwi_facet_area(mesh, facet);
}

bw_status bw_nearest_patch_nodes(bw_context *context, const bw_mesh *mesh,
                                 const bw_dof_map *dof_map, int64_t count, const double *point,
                                 int32_t *node) {
  if (dof_map && dof_map->mesh != mesh)
    return bw_fail(context, BW_INVALID, "supports of another mesh");
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(bw_dot(point + 3 * i, point + 3 * i)))
      return bw_fail(context, BW_INVALID,
                     "point %lld is (%g, %g, %g) m: finite coordinates expected", (long long)i + 1,
                     point[3 * i], point[3 * i + 1], point[3 * i + 2]);
  double *distance = BW_NEW(context, double, count);
  if (!distance)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++) {
    node[i] = -1;
    distance[i] = INFINITY;
  }
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *corner = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    if (!(patch_area(mesh, dof_map, f) > 0))
      continue;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int64_t i = 0; i < count; i++) {
        double to[3], d;
        for (int k = 0; k < 3; k++)
          to[k] = mesh->node[3 * (size_t)corner[a] + (size_t)k] - point[3 * i + k];
        d = bw_dot(to, to);
        if (d < distance[i] || (d == distance[i] && corner[a] < node[i])) {
          distance[i] = d;
          node[i] = corner[a];
        }
      }
  }
  bw_free(distance);
  if (count > 0 && node[0] < 0)
    return bw_fail(context, BW_EMPTY, "supports constrain the whole boundary: no stress is judged");
  return BW_OK;
}

bw_status bwi_surface_patches_begin(bw_context *context, const bw_mesh *mesh,
                                    const bw_dof_map *dof_map, double radius,
                                    bwi_surface_patches *patches) {
  bw_status status;
  size_t facets = (size_t)mesh->facet_count, threads = (size_t)bw_threads(context);
  *patches = (bwi_surface_patches){.mesh = mesh, .radius = radius};
  if (dof_map && dof_map->mesh != mesh)
    return bw_fail(context, BW_INVALID, "supports of another mesh");
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
  place_samples(patches->at);
  for (size_t f = 0; f < facets; f++) {
    const int32_t *node = mesh->facet + f * (size_t)mesh->nodes_per_facet;
    const double *a = mesh->node + 3 * (size_t)node[0], *b = mesh->node + 3 * (size_t)node[1],
                 *c = mesh->node + 3 * (size_t)node[2];
    patches->area[f] = patch_area(mesh, dof_map, (int32_t)f);
    for (size_t k = 0; k < BWI_PATCH_SAMPLES; k++)
      for (size_t j = 0; j < 3; j++) {
        const double *at = patches->at[k];
        patches->sample[(f * BWI_PATCH_SAMPLES + k) * 3 + j] =
            at[0] * a[j] + at[1] * b[j] + at[2] * c[j];
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

bool bwi_surface_patch_weights(const bwi_surface_patches *p, int32_t facet, int32_t node,
                               double weight[BWI_PATCH_SAMPLES]) {
  const double *x = p->sample + (size_t)facet * BWI_PATCH_SAMPLES * 3;
  const double *centre = p->mesh->node + 3 * (size_t)node;
  double area = p->area[facet] / BWI_PATCH_SAMPLES, scale = 1 / (p->radius * p->radius);
  bool any = false;
  for (int k = 0; k < BWI_PATCH_SAMPLES; k++, x += 3) {
    double d[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    weight[k] = fmax(0, area * (1 - scale * bw_dot(d, d)));
    any = any || weight[k] > 0;
  }
  return any;
}

bool bwi_surface_patch_exists(const bwi_surface_patches *p, int32_t node) {
  if (node < 0 || node >= p->mesh->node_count)
    return false;
  for (int64_t k = p->around.start[node]; k < p->around.start[node + 1]; k++)
    if (p->area[p->around.element[k]] > 0)
      return true;
  return false;
}

/* The facets around a node, where the mesh is coarser than the radius. */
static void visit_around(const bwi_surface_patches *p, int32_t node,
                         void (*add)(void *data, int32_t facet, const double weight[3]),
                         void *data) {
  for (int64_t k = p->around.start[node]; k < p->around.start[node + 1]; k++) {
    int32_t facet = p->around.element[k], a = p->around.local[k];
    double weight[3] = {0};
    if (!(p->area[facet] > 0))
      continue;
    if (a < 3)
      weight[a] = p->area[facet];
    else
      weight[a - 3] = weight[(a - 2) % 3] = p->area[facet] / 2;
    add(data, facet, weight);
  }
}

void bwi_surface_patch_visit(const bwi_surface_patches *p, int32_t node, int32_t mark, int worker,
                             void (*add)(void *data, int32_t facet, const double weight[3]),
                             void *data) {
  const bw_mesh *mesh = p->mesh;
  int32_t *seen = p->seen + (size_t)worker * mesh->facet_count, first = 0, last = 0;
  int32_t *queue = p->queue + (size_t)worker * mesh->facet_count;
  bool any = false;
  for (int64_t k = p->around.start[node]; k < p->around.start[node + 1]; k++) {
    seen[p->around.element[k]] = mark;
    queue[last++] = p->around.element[k];
  }
  while (first < last) {
    int32_t facet = queue[first++];
    double sample[BWI_PATCH_SAMPLES], weight[3] = {0};
    if (!bwi_surface_patch_weights(p, facet, node, sample))
      continue;
    for (int k = 0; k < BWI_PATCH_SAMPLES; k++)
      for (int a = 0; a < 3; a++)
        weight[a] += sample[k] * p->at[k][a];
    add(data, facet, weight);
    any = true;
    for (int a = 0; a < 3; a++) {
      int32_t corner = mesh->facet[(size_t)facet * mesh->nodes_per_facet + a];
      for (int64_t k = p->around.start[corner]; k < p->around.start[corner + 1]; k++)
        if (seen[p->around.element[k]] != mark) {
          seen[p->around.element[k]] = mark;
          queue[last++] = p->around.element[k];
        }
    }
  }
  if (!any)
    visit_around(p, node, add, data);
}
