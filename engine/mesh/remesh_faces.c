/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Borders of faces in remeshing: they are sharp edges, and the points that bend them are corners,
 * which never move. So a plane keeps its outline, and its area to rounding. */
#include <stdlib.h>
#include <string.h>

#include "mesh/faces_internal.h"
#include "mesh/remesh.h"
#include "mesh/surface_internal.h"

static bool is_round(const bw_face *face) {
  return face->kind == BW_FACE_CYLINDER || face->kind == BW_FACE_CONE ||
         face->kind == BW_FACE_SPHERE;
}

/* Free forms part along sharp edges only, which are kept in any case. */
static bool is_border(const bwi_remesher *r, int32_t side) {
  int32_t one = r->mesh->group[side / 3], other = r->mesh->group[r->mesh->opposite[side] / 3];
  return one != other &&
         (r->faces->face[one].kind != BW_FACE_FREE || r->faces->face[other].kind != BW_FACE_FREE);
}

bool bwi_remesh_is_chord(const bwi_remesher *r, int32_t side) {
  const bwi_changing *mesh = r->mesh;
  if (!r->faces || !mesh->sharp[side])
    return false;
  const bw_face *one = &r->faces->face[mesh->group[side / 3]],
                *other = &r->faces->face[mesh->group[mesh->opposite[side] / 3]];
  const bw_face *curved = is_round(one) ? one : other;
  if (!is_round(curved) || (one->kind != BW_FACE_PLANE && other->kind != BW_FACE_PLANE))
    return false;
  const double *a = bwi_at(mesh, bwi_from(mesh, side)), *b = bwi_at(mesh, bwi_to(mesh, side));
  double middle[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
  return fabs(bw_face_distance(curved, middle, NULL)) > curved->residual + 1e-5 * distance(a, b);
}

/* The sharp side that goes on from the end of one, at a crease point. */
static int32_t onwards(const bwi_changing *mesh, int32_t side) {
  int32_t back = mesh->opposite[side], s = bwi_around(mesh, back);
  while (!mesh->sharp[s])
    s = bwi_around(mesh, s);
  return s;
}

static double off_line(const double x[3], const double a[3], const double b[3]) {
  double place[3];
  return sqrt(bwi_nearest_on_triangle(x, a, b, b, place));
}

/* Points of a chain of crease points become corners until the others are as near as `tolerance` to
 * the straight lines between them (Douglas and Peucker). */
static void find_bends(bwi_changing *mesh, const int32_t *chain, int32_t *stack, int32_t count,
                       double tolerance) {
  int32_t depth = 0;
  stack[depth++] = 0;
  stack[depth++] = count - 1;
  while (depth > 0) {
    int32_t last = stack[--depth], first = stack[--depth], worst = -1;
    double far = tolerance;
    for (int32_t i = first + 1; i < last; i++) {
      double off =
          off_line(bwi_at(mesh, chain[i]), bwi_at(mesh, chain[first]), bwi_at(mesh, chain[last]));
      if (off > far) {
        far = off;
        worst = i;
      }
    }
    if (worst < 0)
      continue;
    mesh->fixed[chain[worst]] = BWI_CORNER;
    const int32_t halves[4] = {first, worst, worst, last};
    memcpy(stack + depth, halves, sizeof halves);
    depth += 4;
  }
}

/* Follow the crease from a corner along a side. */
static void follow(bwi_changing *mesh, int32_t side, uint8_t *seen, int32_t *chain, int32_t *stack,
                   double tolerance) {
  int32_t count = 0;
  chain[count++] = bwi_from(mesh, side);
  while (mesh->fixed[bwi_to(mesh, side)] == BWI_CREASE && !seen[bwi_to(mesh, side)]) {
    chain[count++] = bwi_to(mesh, side);
    seen[bwi_to(mesh, side)] = 1;
    side = onwards(mesh, side);
  }
  chain[count++] = bwi_to(mesh, side);
  find_bends(mesh, chain, stack, count, tolerance);
}

static bw_status mark_bends(bwi_remesher *r, double tolerance) {
  bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  const int32_t sides = 3 * (int32_t)mesh->facet_count;
  uint8_t *seen = BW_NEW0(r->context, uint8_t, mesh->point_count);
  uint8_t *start = BW_NEW0(r->context, uint8_t, mesh->point_count);
  int32_t *chain = BW_NEW(r->context, int32_t, mesh->point_count + 2);
  int32_t *stack = BW_NEW(r->context, int32_t, 4 * mesh->point_count + 8);
  BW_TRY_MEMORY(seen && start && chain && stack);
  for (size_t p = 0; p < mesh->point_count; p++)
    start[p] = mesh->fixed[p] == BWI_CORNER;
  for (int32_t s = 0; s < sides; s++)
    if (mesh->sharp[s] && start[bwi_from(mesh, s)])
      follow(mesh, s, seen, chain, stack, tolerance);
  for (int32_t s = 0; s < sides; s++) { /* what is left are rings without a corner */
    int32_t p = bwi_from(mesh, s);
    if (!mesh->sharp[s] || seen[p] || mesh->fixed[p] != BWI_CREASE)
      continue;
    mesh->fixed[p] = BWI_CORNER;
    follow(mesh, s, seen, chain, stack, tolerance);
  }
done:
  bw_free(seen);
  bw_free(start);
  bw_free(chain);
  bw_free(stack);
  return status;
}

/* An edge on a round face turns by at most the angle, and facets of a sphere, which is bent twice,
 * lose no more area than those of a cylinder: the length at a point. */
static double round_size(const bw_face *face, const double x[3], double angle) {
  double along = 0;
  for (int i = 0; i < 3; i++)
    along += face->axis[i] * (x[i] - face->point[i]);
  if (face->kind == BW_FACE_SPHERE)
    angle *= 0.7;
  return angle * fabs(face->radius + (face->kind == BW_FACE_CONE ? face->slope * along : 0));
}

/* The wanted length at the corners of a facet on a round face. */
static void bound_sizes(bwi_remesher *r, int32_t facet, double angle) {
  const bw_face *face = &r->faces->face[r->mesh->group[facet]];
  for (int k = 0; k < 3 && is_round(face); k++) {
    int32_t p = r->mesh->corner[3 * (size_t)facet + (size_t)k];
    double size = round_size(face, bwi_at(r->mesh, p), angle);
    r->mesh->size[p] = fmin(r->mesh->size[p], fmax(size, r->finest * r->length));
  }
}

bw_status bwi_remesh_mark_faces(bwi_remesher *r, double tolerance, double round_angle) {
  bwi_changing *mesh = r->mesh;
  for (size_t t = 0; t < mesh->facet_count; t++) {
    mesh->group[t] = r->faces->of_triangle[t];
    if (round_angle > 0)
      bound_sizes(r, (int32_t)t, round_angle);
  }
  for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++)
    mesh->sharp[s] |= is_border(r, s);
  bwi_changing_classify(mesh);
  return mark_bends(r, tolerance);
}

bw_status bwi_faces_min(bw_context *context, const bw_surface *surface, const bw_faces *faces,
                        double sharp_angle, double tolerance, double round_angle, int64_t *bends,
                        double *round_facets) {
  bwi_remesher r = {.context = context, .faces = faces};
  bw_status status = bwi_changing_create(context, surface, sharp_angle, &r.mesh);
  if (status == BW_OK)
    status = bwi_remesh_mark_faces(&r, tolerance, 0);
  *bends = 0;
  *round_facets = 0;
  for (size_t p = 0; status == BW_OK && p < r.mesh->point_count; p++)
    *bends += r.mesh->fixed[p] == BWI_CORNER;
  for (int32_t i = 0; i < faces->count; i++) {
    double size = round_size(&faces->face[i], faces->face[i].centre, round_angle);
    if (is_round(&faces->face[i]) && size > 0)
      *round_facets += faces->face[i].area / (0.4330127 * size * size);
  }
  bwi_changing_destroy(r.mesh);
  return status;
}
