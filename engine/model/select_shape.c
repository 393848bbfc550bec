/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Selections by place: box, half space, plane, sphere, nearest nodes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/internal.h"

/* How far a position is from fulfilling a selection: <= 0 when it does. Near the shape's border the
 * size is the distance from the border on both sides. */
typedef double distance_function(const void *shape, const double x[3]);

/* A facet lies along the border of a shape where its corners are nearer to it than this fraction of
 * the facet's size (the root of its area). */
static const double along_border = 0.05;

/* The area of a facet that is not chosen, though it lies along the border; else 0. */
static double missed_area(const bw_mesh *mesh, int32_t facet, distance_function *distance,
                          const void *shape) {
  const int32_t *corner = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  double middle[3] = {1. / 3, 1. / 3, 1. / 3}, normal[3], far = 0;
  for (int k = 0; k < 3; k++)
    far = fmax(far, fabs(distance(shape, mesh->node + 3 * (size_t)corner[k])));
  bwi_boundary_normal(mesh, facet, middle, normal);
  double area = bw_norm(normal) / 2;
  return far <= along_border * sqrt(area) ? area : 0;
}

static bw_status select_by(bw_context *context, const bw_mesh *mesh, distance_function *distance,
                           const void *shape, const char *what, bw_selection **selection) {
  bw_status status = BW_OK;
  int32_t nearest = -1;
  double min = HUGE_VAL, missed = 0;
  uint8_t *facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  uint8_t *node = BW_NEW0(context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(facet && node);
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    int32_t n = mesh->boundary_node[i];
    double d = distance(shape, mesh->node + 3 * (size_t)n);
    node[n] = d <= 0;
    if (d < min) {
      min = d;
      nearest = n;
    }
  }
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *corner = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    facet[f] = node[corner[0]] && node[corner[1]] && node[corner[2]];
    if (!facet[f])
      missed += missed_area(mesh, f, distance, shape);
  }
  status = bwi_selection_make(context, mesh, facet, node, what, nearest, min, selection);
  if (status == BW_OK)
    (*selection)->missed_area = missed;
done:
  bw_free(facet);
  bw_free(node);
  return status;
}

/* Every number finite, or BW_INVALID. */
static bw_status check_numbers(bw_context *context, const char *what, int count, const double *v) {
  for (int k = 0; k < count; k++)
    if (!isfinite(v[k]))
      return bw_fail(context, BW_INVALID, "%s selection: number %d is not finite", what, k + 1);
  return BW_OK;
}

/* ---- box ------------------------------------------------------------------------------------- */

typedef struct box {
  double min[3], max[3];
} box;

static double box_distance(const void *shape, const double x[3]) {
  const box *b = (const box *)shape;
  double square = 0, inside = -HUGE_VAL;
  for (int k = 0; k < 3; k++) {
    double d = fmax(b->min[k] - x[k], x[k] - b->max[k]);
    square += d > 0 ? d * d : 0;
    inside = fmax(inside, d);
  }
  return square > 0 ? sqrt(square) : inside;
}

bw_status bw_select_box(bw_context *context, const bw_mesh *mesh, const double min[3],
                        const double max[3], bw_selection **selection) {
  box b;
  for (int k = 0; k < 3; k++) { /* infinite sides are welcome, nan is not */
    b.min[k] = min[k];
    b.max[k] = max[k];
    if (!(min[k] <= max[k])) {
      char from[96], to[96];
      bwi_vector_string(from, sizeof from, min, 6, 0);
      bwi_vector_string(to, sizeof to, max, 6, 0);
      return bw_fail(context, BW_INVALID, "box selection from %s to %s: min is above max along %c",
                     from, to, "xyz"[k]);
    }
  }
  char from[96], to[96], what[240];
  bwi_vector_string(from, sizeof from, min, 6, 0);
  bwi_vector_string(to, sizeof to, max, 6, 0);
  snprintf(what, sizeof what, "the box from %s to %s m", from, to);
  return select_by(context, mesh, box_distance, &b, what, selection);
}

/* ---- half space and plane -------------------------------------------------------------------- */

typedef struct plane {
  double point[3], normal[3], tolerance;
  bool both; /* a plane: either side within the tolerance */
} plane;

static double plane_distance(const void *shape, const double x[3]) {
  const plane *p = (const plane *)shape;
  double d = 0;
  for (int k = 0; k < 3; k++)
    d += (x[k] - p->point[k]) * p->normal[k];
  return (p->both ? fabs(d) : d) - p->tolerance;
}

static bw_status select_plane(bw_context *context, const bw_mesh *mesh, const double point[3],
                              const double normal[3], double tolerance, bool both,
                              bw_selection **selection) {
  const char *name = both ? "plane" : "half space";
  plane p = {.tolerance = tolerance, .both = both};
  bw_status status;
  BW_TRY(check_numbers(context, name, 3, point));
  BW_TRY(check_numbers(context, name, 3, normal));
  BW_TRY(check_numbers(context, name, 1, &tolerance));
  if (both && tolerance < 0)
    BW_TRY(
        bw_fail(context, BW_INVALID, "plane selection: the tolerance %g is negative", tolerance));
  double max = fmax(fabs(normal[0]), fmax(fabs(normal[1]), fabs(normal[2])));
  if (max == 0)
    BW_TRY(bw_fail(context, BW_INVALID, "%s selection: the normal is (0, 0, 0)", name));
  for (int k = 0; k < 3; k++) {
    p.point[k] = point[k];
    p.normal[k] = normal[k] / max;
  }
  double size = bw_norm(p.normal);
  for (int k = 0; k < 3; k++)
    p.normal[k] /= size;
  char at[96], along[96], within[40], what[320];
  bwi_vector_string(at, sizeof at, point, 6, 0);
  bwi_vector_string(along, sizeof along, p.normal, 4, 0);
  bwi_number_string(within, sizeof within, tolerance, 4, 0);
  snprintf(what, sizeof what, "the %s %s %s m with normal %s (tolerance %s m)", name,
           both ? "through" : "behind", at, along, within);
  BW_TRY(select_by(context, mesh, plane_distance, &p, what, selection));
done:
  return status;
}

bw_status bw_select_half_space(bw_context *context, const bw_mesh *mesh, const double point[3],
                               const double normal[3], double tolerance, bw_selection **selection) {
  return select_plane(context, mesh, point, normal, tolerance, false, selection);
}

bw_status bw_select_plane(bw_context *context, const bw_mesh *mesh, const double point[3],
                          const double normal[3], double tolerance, bw_selection **selection) {
  return select_plane(context, mesh, point, normal, tolerance, true, selection);
}

/* ---- sphere ---------------------------------------------------------------------------------- */

typedef struct sphere {
  double centre[3], radius;
} sphere;

static double sphere_distance(const void *shape, const double x[3]) {
  const sphere *s = (const sphere *)shape;
  double d[3] = {x[0] - s->centre[0], x[1] - s->centre[1], x[2] - s->centre[2]};
  return bw_norm(d) - s->radius * (1 + 1e-9);
}

bw_status bw_select_sphere(bw_context *context, const bw_mesh *mesh, const double centre[3],
                           double radius, bw_selection **selection) {
  sphere s = {.centre = {centre[0], centre[1], centre[2]}, .radius = radius};
  bw_status status;
  BW_TRY(check_numbers(context, "sphere", 3, centre));
  if (!(radius >= 0))
    BW_TRY(bw_fail(context, BW_INVALID, "sphere selection: the radius %g is not positive", radius));
  char at[96], size[40], what[200];
  bwi_vector_string(at, sizeof at, centre, 6, 0);
  bwi_number_string(size, sizeof size, radius, 6, 0);
  snprintf(what, sizeof what, "the sphere around %s m with radius %s m", at, size);
  BW_TRY(select_by(context, mesh, sphere_distance, &s, what, selection));
done:
  return status;
}

/* ---- nearest --------------------------------------------------------------------------------- */

typedef struct near_node {
  double distance;
  int32_t node;
} near_node;

static int compare_near(const void *a, const void *b) {
  const near_node *p = (const near_node *)a, *q = (const near_node *)b;
  if (p->distance != q->distance)
    return p->distance < q->distance ? -1 : 1;
  return p->node < q->node ? -1 : p->node > q->node;
}

bw_status bw_select_nearest(bw_context *context, const bw_mesh *mesh, const double point[3],
                            int32_t count, bw_selection **selection) {
  near_node *list = NULL;
  uint8_t *mask = NULL;
  bw_status status;
  BW_TRY(check_numbers(context, "nearest", 3, point));
  if (count < 1 || count > mesh->boundary_node_count)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "nearest selection: %d nodes asked for, but there are 1 to %d", count,
                   mesh->boundary_node_count));
  status = BW_MEMORY;
  list = BW_NEW(context, near_node, mesh->boundary_node_count);
  mask = BW_NEW0(context, uint8_t, mesh->node_count);
  if (!list || !mask)
    goto done;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    const double *x = mesh->node + 3 * (size_t)mesh->boundary_node[i];
    double d[3] = {x[0] - point[0], x[1] - point[1], x[2] - point[2]};
    list[i].distance = bw_norm(d);
    list[i].node = mesh->boundary_node[i];
  }
  qsort(list, (size_t)mesh->boundary_node_count, sizeof *list, compare_near);
  for (int32_t i = 0; i < count; i++)
    mask[list[i].node] = 1;
  status = bw_select_mask(context, mesh, NULL, mask, selection);
done:
  bw_free(list);
  bw_free(mask);
  return status;
}
