/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The map of a pose, for any place in or beside the mesh. */
#include "shape/pose_map.h"
#include "mesh/locator.h"
#include "mesh/surface_tree.h"
#include "shape/internal.h"

#include <string.h>

struct bwi_pose_map {
  const bw_mesh *mesh; /* borrowed */
  bw_locator *locator;
  double *node; /* (12 per node) */
  bw_surface *boundary;
  int32_t *node_of_point; /* of the boundary */
  bwi_tree *tree;         /* of the boundary */
  double spacing;
};

/* The blend of the maps of a node, which is the first one to the last bit where they agree. */
static void blend(const bw_subdomains *d, const double *map, int32_t node, double *out) {
  int64_t first = d->influence_start[node], end = d->influence_start[node + 1];
  static const double rest[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const double *base = first == end ? rest : map + 12 * (size_t)d->influence_bone[first];
  memcpy(out, base, 12 * sizeof *out);
  for (int64_t k = first + 1; k < end; k++) {
    const double *other = map + 12 * (size_t)d->influence_bone[k];
    for (int j = 0; j < 12; j++)
      out[j] += d->influence_weight[k] * (other[j] - base[j]);
  }
}

static double mean_edge(const bw_surface *surface) {
  double sum = 0;
  for (int32_t f = 0; f < surface->triangle_count; f++)
    for (int k = 0; k < 3; k++) {
      const int32_t *corner = surface->triangle + 3 * (size_t)f;
      const double *a = surface->point + 3 * (size_t)corner[k];
      const double *b = surface->point + 3 * (size_t)corner[(k + 1) % 3];
      sum += bw_norm((double[3]){a[0] - b[0], a[1] - b[1], a[2] - b[2]});
    }
  return sum / (3.0 * surface->triangle_count);
}

bw_status bwi_pose_map_create(bw_context *context, const bw_subdomains *subdomains,
                              const double *map, bwi_pose_map **out) {
  bw_status status = BW_OK;
  bwi_pose_map *made = BW_NEW0(context, bwi_pose_map, 1);
  BW_TRY_MEMORY(made);
  made->mesh = subdomains->mesh;
  BW_TRY(bw_mesh_boundary(context, made->mesh, &made->boundary, &made->node_of_point));
  BW_TRY(bwi_tree_create(context, made->boundary->point, made->boundary->triangle_count,
                         made->boundary->triangle, NULL, &made->tree));
  made->spacing = mean_edge(made->boundary);
  made->node = BW_NEW(context, double, 12 * (int64_t)made->mesh->node_count);
  BW_TRY_MEMORY(made->node);
  for (int32_t i = 0; i < made->mesh->node_count; i++)
    blend(subdomains, map, i, made->node + 12 * (size_t)i);
  BW_TRY(bw_locator_create(context, made->mesh, &made->locator));
  *out = made;
  made = NULL;
done:
  bwi_pose_map_destroy(made);
  return status;
}

void bwi_pose_map_destroy(bwi_pose_map *map) {
  if (!map)
    return;
  bw_release(map->locator);
  bwi_tree_destroy(map->tree);
  bw_free(map->node_of_point);
  bw_release(map->boundary);
  bw_free(map->node);
  bw_free(map);
}

/* A sum of maps with weights, as differences from the first one: exact where all are the same. */
typedef struct mixture {
  const double *base;
  double sum[12], total;
} mixture;

static void mix(const bwi_pose_map *map, mixture *m, int32_t node, double weight) {
  const double *own = map->node + 12 * (size_t)node;
  if (!m->base)
    m->base = own;
  for (int j = 0; j < 12; j++)
    m->sum[j] += weight * (own[j] - m->base[j]);
  m->total += weight;
}

typedef struct surroundings {
  const bwi_pose_map *map;
  const double *x;
  double nearest; /* m, above 0 */
  mixture mixture;
} surroundings;

/* A facet counts the less the farther it is than the nearest, and not beyond twice that distance.
 */
static bool mix_facet(void *data, int32_t facet) {
  surroundings *s = (surroundings *)data;
  const bw_surface *boundary = s->map->boundary;
  const int32_t *corner = boundary->triangle + 3 * (size_t)facet;
  double weight[3];
  double d = sqrt(bwi_triangle_weights(s->x, boundary->point + 3 * (size_t)corner[0],
                                       boundary->point + 3 * (size_t)corner[1],
                                       boundary->point + 3 * (size_t)corner[2], weight));
  double part = fmin(2 - d / s->nearest, 1);
  if (part > 0)
    for (int k = 0; k < 3; k++)
      mix(s->map, &s->mixture, s->map->node_of_point[corner[k]], part * part * weight[k]);
  return true;
}

void bwi_pose_map_point(const bwi_pose_map *map, const double x[3], double y[3]) {
  double weight[4], place[3], low[3], high[3];
  bool inside;
  surroundings s = {.map = map, .x = x};
  int32_t element = bw_locator_find(map->locator, x, weight, &inside), facet;
  if (!inside) {
    s.nearest = sqrt(bwi_tree_nearest(map->tree, x, -1, 0, place, &facet));
    for (int k = 0; k < 3; k++) {
      low[k] = x[k] - 2 * s.nearest;
      high[k] = x[k] + 2 * s.nearest;
    }
    if (s.nearest > 0)
      bwi_tree_in_box(map->tree, low, high, mix_facet, &s);
  }
  if (!(s.mixture.total > 0)) {
    s.mixture = (mixture){0};
    for (int k = 0; k < 4; k++)
      mix(map, &s.mixture, bwi_nodes_of(map->mesh, element)[k], weight[k]);
  }
  for (int i = 0; i < 3; i++) {
    const double *base = s.mixture.base + 4 * i, *sum = s.mixture.sum + 4 * i;
    double d = base[3] + sum[3] / s.mixture.total;
    for (int j = 0; j < 3; j++)
      d += (base[j] - (i == j) + sum[j] / s.mixture.total) * x[j];
    y[i] = x[i] + d;
  }
}

double bwi_pose_map_spacing(const bwi_pose_map *map) {
  return map->spacing;
}
