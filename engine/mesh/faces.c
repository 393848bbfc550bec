/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Faces of a surface (docs/theory/faces.md).
 *
 * Facets are gathered into flat regions. A region that is wide beside its smooth neighbours, or has
 * none, is a plane. The others are strips of round faces: what hangs together smoothly is fitted as
 * a whole, and where no primitive fits, grown strip by strip from the largest one. What is left is
 * free form.
 *
 * Invariant: once label[t] is set, it is the number of the facet's region, which goes from 0 up to
 * the count of regions; face_of[r] is the region's face, or -1 while it has none. */
#include "mesh/faces_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

static const double strip_width = 0.15; /* a smooth neighbour of a plane is narrower than this */
/* Corners may be as far from a round primitive: the larger of the first fraction of the diagonal,
 * and the smaller of fractions of diagonal and radius. */
static const double near_rounding = 2e-6, near_diagonal = 1e-4, near_radius = 0.01;
/* ... and of the distance from the best plane: any small piece of a smooth surface is nearly
 * round */
static const double near_plane = 0.03;
static const double largest_radius = 5; /* of the diagonal */
enum { MIN_STRIPS = 4 };                /* in a face that is grown */

/* ---- fits ------------------------------------------------------------------------------------ */

/* Corners and normals of the facets of some regions. */
static bw_status gather(bwi_face_finder *f, int32_t count, const int32_t *region) {
  const bwi_topology *top = f->top;
  size_t facets = 0;
  for (int32_t i = 0; i < count; i++)
    facets += (size_t)(f->first[region[i] + 1] - f->first[region[i]]);
  bwi_cloud *cloud = &f->cloud;
  bw_free(cloud->point);
  bw_free(cloud->normal);
  bw_free(cloud->area);
  *cloud = (bwi_cloud){.point = BW_NEW(f->context, double, 9 * facets),
                       .normal = BW_NEW(f->context, double, 3 * facets),
                       .area = BW_NEW(f->context, double, facets)};
  if (!cloud->point || !cloud->normal || !cloud->area)
    return BW_MEMORY;
  for (int clear = 0; clear < 2; clear++)
    for (int32_t i = 0; i < count; i++)
      for (int32_t m = f->first[region[i]]; m < f->first[region[i] + 1]; m++) {
        int32_t t = f->member[m];
        for (int k = 0; k < 3; k++) {
          int32_t p = top->corner[3 * (size_t)t + (size_t)k];
          if (!clear && !f->seen[p])
            memcpy(cloud->point + 3 * cloud->points++, top->point + 3 * (size_t)p,
                   3 * sizeof(double));
          f->seen[p] = !clear;
        }
        if (clear || !(f->area[t] > 0))
          continue;
        memcpy(cloud->normal + 3 * cloud->facets, f->normal + 3 * (size_t)t, 3 * sizeof(double));
        cloud->area[cloud->facets++] = f->area[t];
      }
  return BW_OK;
}

/* Whether the gathered cloud lies on a primitive of this kind; sets the limit of the distance. */
static bool fit_kind(bwi_face_finder *f, bw_face_kind kind, bw_face *face) {
  bw_face plane;
  if (!bwi_face_fit(&f->cloud, kind, face) || face->radius > largest_radius * f->diagonal ||
      !bwi_face_fit(&f->cloud, BW_FACE_PLANE, &plane))
    return false;
  f->limit = fmax(near_rounding * f->diagonal,
                  fmin(near_plane * plane.residual,
                       fmin(near_diagonal * f->diagonal, near_radius * face->radius)));
  return face->residual <= f->limit;
}

/* Does a facet lean as the primitive does? Corners of a box lie on a sphere. */
static bool leans(const bw_face *face, const double normal[3], const double at[3]) {
  double gradient[3];
  bw_face_distance(face, at, gradient);
  return fabs(bw_dot(gradient, normal)) > 0.7660444431189780; /* 40 degrees */
}

/* The first round primitive that the gathered cloud lies on. Two circles around an axis lie on a
 * cone and on a sphere; facets between them are the cone. */
static bool fit_round(bwi_face_finder *f, bw_face *face) {
  static const bw_face_kind kind[] = {BW_FACE_CYLINDER, BW_FACE_CONE, BW_FACE_SPHERE};
  for (int i = 0; i < 3; i++)
    if (fit_kind(f, kind[i], face))
      return true;
  return false;
}

static bool region_leans(const bwi_face_finder *f, int32_t region, const bw_face *face) {
  for (int32_t m = f->first[region]; m < f->first[region + 1]; m++) {
    int32_t t = f->member[m];
    const double *n = f->normal + 3 * (size_t)t;
    double middle[3] = {0};
    for (int k = 0; k < 9; k++)
      middle[k % 3] += f->top->point[3 * (size_t)f->top->corner[3 * (size_t)t + (size_t)(k / 3)] +
                                     (size_t)(k % 3)] /
                       3;
    if (bw_norm(n) > 0 && !leans(face, n, middle))
      return false;
  }
  return true;
}

static bool region_lies_on(const bwi_face_finder *f, int32_t region, const bw_face *face) {
  for (int32_t m = f->first[region]; m < f->first[region + 1]; m++)
    for (int k = 0; k < 3; k++) {
      int32_t p = f->top->corner[3 * (size_t)f->member[m] + (size_t)k];
      if (fabs(bw_face_distance(face, f->top->point + 3 * (size_t)p, NULL)) > f->limit)
        return false;
    }
  return region_leans(f, region, face);
}

static bw_status add_face(bwi_face_finder *f, const bw_face *face, int32_t count,
                          const int32_t *region) {
  if (!bw_grow(f->context, (void **)&f->face, &f->face_capacity, f->face_count, 1, sizeof *f->face))
    return BW_MEMORY;
  for (int32_t i = 0; i < count; i++)
    f->face_of[region[i]] = (int32_t)f->face_count;
  f->face[f->face_count++] = *face;
  return BW_OK;
}

static bw_status add_plane(bwi_face_finder *f, int32_t region) {
  bw_face face = {.kind = BW_FACE_FREE};
  bw_status status = gather(f, 1, &region);
  if (status != BW_OK)
    return status;
  if (!(f->region_area[region] > 0) || !bwi_face_fit(&f->cloud, BW_FACE_PLANE, &face))
    face = (bw_face){.kind = BW_FACE_FREE};
  return add_face(f, &face, 1, &region);
}

/* Wide beside all its smooth neighbours? */
static bool is_plane(const bwi_face_finder *f, int32_t region) {
  int64_t begin = f->link_start[region], end = f->link_start[region + 1];
  if (begin == end)
    return true;
  if (f->first[region + 1] - f->first[region] < 2)
    return false;
  for (int64_t i = begin; i < end; i++)
    if (f->region_area[f->links[i].to] > strip_width * f->region_area[region])
      return false;
  return true;
}

/* The regions without a face that hang together smoothly with `start`, whose facets lie on `face`
 * (NULL: all). */
static int32_t spread(const bwi_face_finder *f, int32_t start, const bw_face *face, uint8_t *mark,
                      int32_t *list) {
  int32_t count = 0;
  mark[start] = 1;
  list[count++] = start;
  for (int32_t at = 0; at < count; at++)
    for (int64_t i = f->link_start[list[at]]; i < f->link_start[list[at] + 1]; i++) {
      int32_t next = f->links[i].to;
      if (mark[next] || f->face_of[next] >= 0 || (face && !region_lies_on(f, next, face)))
        continue;
      mark[next] = 1;
      list[count++] = next;
    }
  for (int32_t at = 0; at < count; at++)
    mark[list[at]] = 0;
  return count;
}

/* A face grown from a region and its smooth neighbours. *count 0 where there is none. */
static bw_status grow(bwi_face_finder *f, int32_t seed, uint8_t *mark, int32_t *list, bw_face *face,
                      int32_t *count) {
  bw_status status = BW_OK;
  int32_t near = 0;
  list[near++] = seed;
  for (int64_t i = f->link_start[seed]; i < f->link_start[seed + 1] && near < 16; i++)
    if (f->face_of[f->links[i].to] < 0)
      list[near++] = f->links[i].to;
  *count = 0;
  if (near < 3)
    return BW_OK;
  BW_TRY(gather(f, near, list));
  if (!fit_round(f, face))
    goto done;
  for (int round = 0; round < 3; round++) { /* the more strips, the better the fit */
    if (!region_lies_on(f, seed, face))
      goto done;
    int32_t now = spread(f, seed, face, mark, list);
    if (now < MIN_STRIPS)
      goto done;
    BW_TRY(gather(f, now, list));
    bw_face better;
    if (!fit_kind(f, face->kind, &better))
      goto done;
    *face = better;
    *count = now;
  }
done:
  return status;
}

static bw_status find_faces(bwi_face_finder *f) {
  bw_status status = BW_OK;
  const int32_t regions = f->regions;
  int32_t *order = BW_NEW(f->context, int32_t, regions);
  int32_t *list = BW_NEW(f->context, int32_t, regions);
  uint8_t *mark = BW_NEW0(f->context, uint8_t, regions);
  uint8_t *tried = BW_NEW0(f->context, uint8_t, regions);
  BW_TRY_MEMORY(order && list && mark && tried);
  BW_TRY(bwi_order_by(f->context, regions, f->region_area, order));
  for (int32_t i = 0; i < regions; i++)
    if (is_plane(f, order[i]))
      BW_TRY(add_plane(f, order[i]));
  for (int32_t i = 0; i < regions; i++) { /* whole pieces */
    BW_TRY(bw_check_cancel(f->context));
    if (f->face_of[order[i]] >= 0 || tried[order[i]])
      continue;
    int32_t count = spread(f, order[i], NULL, mark, list);
    bw_face face;
    for (int32_t k = 0; k < count; k++)
      tried[list[k]] = 1;
    BW_TRY(gather(f, count, list));
    bool fits = fit_round(f, &face);
    for (int32_t k = 0; k < count && fits; k++)
      fits = region_leans(f, list[k], &face);
    if (fits)
      BW_TRY(add_face(f, &face, count, list));
    else if (count == 1)
      BW_TRY(add_plane(f, order[i]));
  }
  for (int32_t i = 0; i < regions; i++) { /* parts of pieces */
    int32_t count;
    bw_face face;
    BW_TRY(bw_check_cancel(f->context));
    if (f->face_of[order[i]] >= 0)
      continue;
    BW_TRY(grow(f, order[i], mark, list, &face, &count));
    if (count > 0)
      BW_TRY(add_face(f, &face, count, list));
  }
  for (int32_t i = 0; i < regions; i++) { /* a wide strip of a round face is no plane */
    int32_t region = order[i], own = f->face_of[region];
    if (own < 0 || f->face[own].kind != BW_FACE_PLANE)
      continue;
    for (int64_t k = f->link_start[region]; k < f->link_start[region + 1]; k++) {
      int32_t other = f->face_of[f->links[k].to];
      f->limit = near_rounding * f->diagonal;
      if (other < 0 || f->face[other].kind == BW_FACE_PLANE ||
          !region_lies_on(f, region, &f->face[other]))
        continue;
      f->face[own].kind = BW_FACE_FREE; /* without regions: dropped at the end */
      f->face_of[region] = other;
      break;
    }
  }
  for (int32_t i = 0; i < regions; i++) { /* free form */
    const bw_face none = {.kind = BW_FACE_FREE};
    if (f->face_of[order[i]] >= 0)
      continue;
    int32_t count = spread(f, order[i], NULL, mark, list);
    if (count == 1)
      BW_TRY(add_plane(f, order[i]));
    else
      BW_TRY(add_face(f, &none, count, list));
  }
done:
  bw_free(order);
  bw_free(list);
  bw_free(mark);
  bw_free(tried);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static void faces_destroy(void *object) {
  bw_faces *faces = (bw_faces *)object;
  bw_free(faces->face);
  bw_free(faces->of_triangle);
  bw_free(faces);
}

static size_t faces_bytes(const void *object) {
  const bw_faces *faces = (const bw_faces *)object;
  return sizeof *faces + (size_t)faces->count * sizeof *faces->face +
         (size_t)faces->triangle_count * sizeof *faces->of_triangle;
}

static const bw_kind faces_kind = {"faces", faces_destroy, faces_bytes};

/* Areas, centres and normals; faces in descending order of area. */
static bw_status finish(bwi_face_finder *f, bw_faces *faces) {
  bw_status status = BW_OK;
  uint8_t *used = NULL; /* has a region */
  double *area = BW_NEW0(f->context, double, f->face_count);
  int32_t *order = BW_NEW(f->context, int32_t, f->face_count);
  int32_t *place = BW_NEW(f->context, int32_t, f->face_count);
  faces->triangle_count = f->top->facets;
  faces->face = BW_NEW0(f->context, bw_face, f->face_count);
  faces->of_triangle = BW_NEW(f->context, int32_t, f->top->facets);
  BW_TRY_MEMORY(area && order && place && faces->face && faces->of_triangle);
  used = BW_NEW0(f->context, uint8_t, f->face_count);
  BW_TRY_MEMORY(used);
  for (int32_t r = 0; r < f->regions; r++)
    used[f->face_of[r]] = 1;
  for (size_t i = 0; i < f->face_count; i++)
    faces->count += used[i];
  for (int32_t r = 0; r < f->regions; r++)
    area[f->face_of[r]] += f->region_area[r];
  for (size_t i = 0; i < f->face_count; i++)
    area[i] = used[i] ? area[i] : -1;
  BW_TRY(bwi_order_by(f->context, (int32_t)f->face_count, area, order));
  for (int32_t i = 0; i < faces->count; i++) {
    faces->face[i] = f->face[order[i]];
    faces->face[i].area = area[order[i]];
    place[order[i]] = i;
  }
  for (int32_t t = 0; t < f->top->facets; t++) {
    bw_face *face = &faces->face[place[f->face_of[f->label[t]]]];
    faces->of_triangle[t] = (int32_t)(face - faces->face);
    face->triangle_count++;
    for (int k = 0; k < 3; k++)
      face->normal[k] += f->area[t] * f->normal[3 * (size_t)t + (size_t)k];
    for (int k = 0; k < 9; k++)
      face->centre[k % 3] +=
          f->area[t] / 3 *
          f->top->point[3 * (size_t)f->top->corner[3 * (size_t)t + (size_t)(k / 3)] +
                        (size_t)(k % 3)];
  }
  for (int32_t i = 0; i < faces->count; i++) {
    bw_face *face = &faces->face[i];
    double size = bw_norm(face->normal);
    for (int k = 0; k < 3; k++) {
      face->centre[k] = face->area > 0 ? face->centre[k] / face->area : 0;
      face->normal[k] = size > 1e-9 * face->area ? face->normal[k] / size : 0;
    }
  }
done:
  bw_free(used);
  bw_free(area);
  bw_free(order);
  bw_free(place);
  return status;
}

bw_status bw_faces_find(bw_context *context, const bw_surface *surface, double angle,
                        bw_faces **out) {
  bw_status status;
  bwi_topology *top = NULL;
  bw_faces *faces = NULL;
  bwi_face_finder f = {.context = context};
  if (!(angle >= 0 && angle < 1.5))
    return bw_fail(context, BW_INVALID, "faces: the angle %g is not within 0 and 1.5 radians",
                   angle);
  f.smooth = cos(angle > 0 ? angle : 30 * 0.017453292519943295);
  f.diagonal = bwi_surface_diagonal(surface);
  BW_TRY(bwi_topology_create(context, surface, &top));
  f.top = top;
  BW_TRY(bwi_faces_measure(&f));
  BW_TRY(bwi_find_regions(&f));
  BW_TRY(bwi_link_regions(&f));
  BW_TRY(find_faces(&f));
  faces = BW_NEW0(context, bw_faces, 1);
  BW_TRY_MEMORY(faces);
  bw_object_init(faces, &faces_kind);
  BW_TRY(finish(&f, faces));
  *out = faces;
  faces = NULL;
done:
  bw_release(faces);
  bwi_topology_destroy(top);
  bw_free(f.normal);
  bw_free(f.area);
  bw_free(f.order);
  bw_free(f.label);
  bw_free(f.region_area);
  bw_free(f.first);
  bw_free(f.member);
  bw_free(f.links);
  bw_free(f.link_start);
  bw_free(f.face_of);
  bw_free(f.face);
  bw_free(f.seen);
  bw_free(f.cloud.point);
  bw_free(f.cloud.normal);
  bw_free(f.cloud.area);
  return status;
}

int32_t bw_faces_near(const bw_faces *faces, const bw_surface *surface, const double point[3]) {
  double min = HUGE_VAL, place[3];
  int32_t best = -1;
  for (int32_t t = 0; t < surface->triangle_count; t++) {
    const int32_t *corner = surface->triangle + 3 * (size_t)t;
    double far = bwi_nearest_on_triangle(point, surface->point + 3 * (size_t)corner[0],
                                         surface->point + 3 * (size_t)corner[1],
                                         surface->point + 3 * (size_t)corner[2], place);
    if (far < min) {
      min = far;
      best = faces->of_triangle[t];
    }
  }
  return best;
}

const char *bw_face_word(bw_face_kind kind) {
  static const char *const word[] = {"plane", "cylinder", "cone", "sphere", "free form"};
  return word[kind];
}
