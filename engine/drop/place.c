/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where a falling body meets the obstacle (docs/theory/drop.md). */
#include <math.h>
#include <string.h>

#include "contact/internal.h"
#include "drop/internal.h"

/* Of the radius: how deep an obstacle may be between nodes when the first one touches it. */
static const double deepest = 0.1;

/* How deep the facets, with all of their nodes, reach into the obstacle; with a way: as seen along
 * it. */
static double depth_of(const bwi_drop_run *run, const double *way) {
  static const int whole[1][3] = {{0, 1, 2}};
  static const int quarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  const bw_mesh *mesh = run->model->mesh;
  const int(*part)[3] = mesh->order == 1 ? whole : quarters;
  double most = -INFINITY;
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (int i = 0; i < (mesh->order == 1 ? 1 : 4); i++) {
      const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
      const double *corner[3];
      for (int k = 0; k < 3; k++)
        corner[k] = mesh->node + 3 * (size_t)node[part[i][k]];
      most = fmax(most, bwi_rigid_depth(&run->onto, corner, way));
    }
  return most;
}

static const char *name_of(const bw_rigid_surface *surface) {
  return surface->kind == BW_RIGID_SPHERE ? "peg" : "edge";
}

/* The way of the first node that meets it. */
static double travel_of(const bwi_drop_run *run, const double way[3]) {
  const bw_mesh *mesh = run->model->mesh;
  double least = INFINITY;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    least = fmin(
        least, bwi_rigid_travel(&run->onto, mesh->node + 3 * (int64_t)mesh->boundary_node[i], way));
  return least;
}

bw_status bwi_drop_place(bw_context *context, bwi_drop_run *run) {
  const bw_drop_options *o = &run->options;
  bw_rigid_surface *onto = &run->onto;
  double length = bw_norm(o->down), way[3];
  if (o->onto)
    *onto = *o->onto;
  else
    onto->kind = BW_RIGID_PLANE;
  for (int k = 0; k < 3; k++) {
    way[k] = o->down[k] / length;
    if (!o->onto)
      onto->direction[k] = -way[k];
    if (!onto->placed)
      onto->point[k] = run->origin[k];
  }
  double travel = travel_of(run, way);
  bool meets = isfinite(travel);
  for (int k = 0; k < 3 && meets; k++) /* the body stays where the mesh is */
    onto->point[k] -= travel * way[k];
  run->depth = depth_of(run, meets ? NULL : way);
  if (!meets && !(run->depth > 0))
    return bw_fail(context, BW_GEOMETRY,
                   "the body misses the %s of radius %g m: it falls past at a distance of %g m. %s",
                   name_of(onto), onto->radius, -run->depth,
                   onto->placed ? "Put it nearer to the centre of mass, or leave its place out"
                                : "Make its radius larger");
  if (!meets)
    return bw_fail(context, BW_LIMIT,
                   "the %s of radius %g m passes between the nodes of the body: make elements "
                   "smaller where it hits, or its radius larger",
                   name_of(onto), onto->radius);
  if (run->depth > deepest * onto->radius)
    return bw_fail(context, BW_LIMIT,
                   "the %s of radius %g m goes %g m deep between nodes before one touches it, and "
                   "%g m is the most that is allowed: make elements smaller where it hits, or its "
                   "radius larger",
                   name_of(onto), onto->radius, run->depth, deepest * onto->radius);
  run->depth = fmax(0, run->depth);
  return BW_OK;
}
