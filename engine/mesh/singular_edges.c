/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Re-entrant edges of a surface, found between its faces (docs/theory/singular.md). The normals at
 * an edge are those of the fitted primitives, so facets that stand for a round face make no
 * edge. */
#include "mesh/singular_internal.h"

#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

static const double pi = 3.14159265358979323846;
static const double min_margin = 10 * 0.017453292519943295;
static const double free_margin = 30 * 0.017453292519943295; /* where no primitive is known */

/* Two planes that meet at a small angle also lie on a cylinder: a round face has this many flat
 * strips, whose normals differ by more than 2 degrees. */
enum { MIN_STRIPS = 4 };
static const double same_strip = 0.9993908270190958; /* cos 2 degrees */

typedef struct finder {
  const bwi_topology *top;
  const bw_faces *faces;
  double margin;
  uint8_t *known; /* per face: its primitive counts */
} finder;

static void facet_normal(const bwi_topology *top, int32_t t, double normal[3]) {
  bwi_facet_normal(top->point, top->corner + 3 * (size_t)t, normal);
  double size = bw_norm(normal);
  for (int k = 0; k < 3; k++)
    normal[k] = size > 0 ? normal[k] / size : 0;
}

static bw_status check_faces(bw_context *context, finder *f) {
  const bw_faces *faces = f->faces;
  double *normal = BW_NEW(context, double, 3 * MIN_STRIPS * (size_t)faces->count);
  f->known = BW_NEW0(context, uint8_t, faces->count); /* number of strips at first */
  if (!normal || !f->known) {
    bw_free(normal);
    return BW_MEMORY;
  }
  for (int32_t t = 0; t < f->top->facets; t++) {
    int32_t face = faces->of_triangle[t];
    double *own = normal + 3 * MIN_STRIPS * (size_t)face, n[3];
    bool other = f->known[face] < MIN_STRIPS;
    facet_normal(f->top, t, n);
    for (int k = 0; k < f->known[face] && other; k++)
      other = bw_dot(own + 3 * k, n) < same_strip;
    if (other && bw_norm(n) > 0)
      memcpy(own + 3 * f->known[face]++, n, sizeof n);
  }
  for (int32_t i = 0; i < faces->count; i++)
    f->known[i] = faces->face[i].kind == BW_FACE_PLANE ||
                  (faces->face[i].kind != BW_FACE_FREE && f->known[i] == MIN_STRIPS);
  bw_free(normal);
  return BW_OK;
}

/* The outward normal at x of the face that a facet lies on: its primitive's where it has one. */
static void normal_at(const finder *f, int32_t t, const double x[3], double normal[3]) {
  const bw_face *face = &f->faces->face[f->faces->of_triangle[t]];
  double gradient[3];
  facet_normal(f->top, t, normal);
  if (!f->known[f->faces->of_triangle[t]])
    return;
  bw_face_distance(face, x, gradient);
  double along = bw_dot(gradient, normal);
  for (int k = 0; k < 3 && fabs(along) > 0.5; k++)
    normal[k] = along > 0 ? gradient[k] : -gradient[k];
}

static bw_status add_edge(bw_context *context, const finder *f, int64_t side1, int64_t side2,
                          bwi_seams *seams) {
  const bwi_topology *top = f->top;
  const bw_faces *faces = f->faces;
  int32_t t1 = (int32_t)(side1 / 3), t2 = (int32_t)(side2 / 3);
  int32_t f1 = faces->of_triangle[t1], f2 = faces->of_triangle[t2];
  bool free_form = faces->face[f1].kind == BW_FACE_FREE || faces->face[f2].kind == BW_FACE_FREE;
  if (f1 == f2 && f->known[f1])
    return BW_OK;
  bwi_seam seam = {.end = {bwi_side_from(top, side1), bwi_side_to(top, side1)},
                   .key = {f1 < f2 ? f1 : f2, f1 < f2 ? f2 : f1, 0}};
  const double *a = top->point + 3 * (size_t)seam.end[0], *b = top->point + 3 * (size_t)seam.end[1];
  double middle[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}, n1[3], n2[3];
  normal_at(f, t1, middle, n1);
  normal_at(f, t2, middle, n2);
  if (!(bw_norm(n1) > 0 && bw_norm(n2) > 0))
    return BW_OK;
  seam.angle = bwi_opening(a, b, n1, n2, seam.inward);
  if (seam.angle - pi <= (free_form ? fmax(f->margin, free_margin) : f->margin))
    return BW_OK;
  return bwi_seams_add(context, seams, &seam);
}

static bw_status find_edges(bw_context *context, const finder *f, bwi_seams *seams) {
  const bwi_topology *top = f->top;
  for (int64_t e = 0; e < top->edges; e++) {
    const int64_t *side = top->side + top->start[e];
    int64_t sides = top->start[e + 1] - top->start[e];
    if (sides % 2 != 0)
      return bw_fail(context, BW_GEOMETRY,
                     "singular edges: the surface is open: surface:repair() closes it");
    if (sides != 2) /* bodies that touch along an edge */
      continue;
    if (bwi_side_from(top, side[0]) != bwi_side_to(top, side[1]))
      return bw_fail(context, BW_GEOMETRY,
                     "singular edges: facets have inconsistent orientation: surface:repair() or "
                     "surface:orient() corrects it");
    bw_status status = add_edge(context, f, side[0], side[1], seams);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

bw_status bw_singular_edges(bw_context *context, const bw_surface *surface, const bw_faces *faces,
                            double margin, bw_singular_places **edges) {
  bw_status status;
  bwi_topology *top = NULL;
  bw_faces *found = NULL;
  bw_singular_places *places = NULL;
  bwi_seams seams = {0};
  finder f = {.top = NULL};
  if (!(margin >= 0 && margin < 1.5))
    return bw_fail(context, BW_INVALID,
                   "singular edges: the angle %g is not within 0 and 1.5 radians", margin);
  if (faces && faces->triangle_count != surface->triangle_count)
    return bw_fail(context, BW_INVALID, "singular edges: the faces are those of another surface");
  BW_TRY(bwi_topology_create(context, surface, &top));
  if (!faces) {
    BW_TRY(bw_faces_find(context, surface, 0, &found));
    faces = found;
  }
  f = (finder){.top = top, .faces = faces, .margin = margin > 0 ? margin : min_margin};
  BW_TRY(check_faces(context, &f));
  BW_TRY(find_edges(context, &f, &seams));
  if (!(bw_surface_volume(surface) > 0))
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "singular edges: the normals of the surface point inwards, or it encloses no "
                   "volume: surface:repair() or surface:orient() corrects the normals"));
  BW_TRY(bwi_singular_create(context, &places));
  BW_TRY(bwi_singular_chain(context, places, &seams, top->points, top->point, BW_SINGULAR_EDGE,
                            BW_CORNER_FREE, 0));
  bwi_singular_sort(places);
  *edges = places;
  places = NULL;
done:
  bw_release(places);
  bw_release(found);
  bwi_topology_destroy(top);
  bw_free(f.known);
  bw_free(seams.seam);
  return status;
}
