/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Points of a remeshed surface back onto the primitives of the faces they came from: a point inside
 * a face onto its primitive, one between two onto their crossing, a corner onto the point of three.
 *
 * Each facet takes the face of the facet of the base that its middle is nearest to. A point then
 * solves d_i(x) = 0 for its faces by Newton steps of least norm. Gradients nearly in the span of
 * those before (a fillet that runs into a plane) are left out; planes come first. */
#include "mesh/faces_internal.h"

#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_tree.h"

enum { STEPS = 20 };
static const double min_gradient = 0.1; /* of the part outside of the span: 6 degrees */
static const double of_edge = 0.3;      /* longest move, of the shortest edge at the point */
static const double of_rounding = 1e-7; /* of the diagonal: single precision */

void bwi_around_add(bwi_faces_around *a, const bw_faces *faces, int32_t face) {
  int at = a->count;
  for (int i = 0; i < a->count; i++)
    if (a->face[i] == face)
      return;
  if (a->count == BWI_AROUND || faces->face[face].kind == BW_FACE_FREE)
    return;
  while (at > 0 && (faces->face[a->face[at - 1]].kind > faces->face[face].kind ||
                    (faces->face[a->face[at - 1]].kind == faces->face[face].kind &&
                     a->face[at - 1] > face))) {
    a->face[at] = a->face[at - 1];
    at--;
  }
  a->face[at] = face;
  a->count++;
}

bool bwi_around_project(const bw_faces *faces, const bwi_faces_around *a, bw_face_kind last,
                        double diagonal, double x[3]) {
  for (int step = 0; step < STEPS; step++) {
    double base[3][3], move[3] = {0, 0, 0}, largest = 0;
    int rank = 0;
    for (int i = 0; i < a->count && rank < 3 && faces->face[a->face[i]].kind <= last; i++) {
      double g[3], rest[3];
      double value = bw_face_distance(&faces->face[a->face[i]], x, g);
      memcpy(rest, g, sizeof rest);
      for (int r = 0; r < rank; r++) {
        double part = bw_dot(rest, base[r]);
        for (int k = 0; k < 3; k++)
          rest[k] -= part * base[r][k];
      }
      double size = bw_norm(rest);
      if (!(size > min_gradient))
        continue;
      for (int k = 0; k < 3; k++)
        base[rank][k] = rest[k] / size;
      double along = -(value + bw_dot(g, move)) / bw_dot(g, base[rank]);
      for (int k = 0; k < 3; k++)
        move[k] += along * base[rank][k];
      largest = fmax(largest, fabs(along));
      rank++;
    }
    for (int k = 0; k < 3; k++)
      x[k] += move[k];
    if (!isfinite(largest))
      return false;
    if (largest <= 1e-15 * diagonal)
      return true;
    if (step > 5 && largest <= 1e-13 * diagonal)
      return true;
  }
  return false;
}

static double apart(const double *a, const double *b) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return bw_norm(d);
}

bw_status bwi_faces_label(bw_context *context, const bw_surface *base, const bw_faces *faces,
                          const bw_surface *surface, int32_t *label) {
  bw_status status;
  bwi_tree *tree = NULL;
  int32_t nearest = -1;
  BW_TRY(bwi_tree_create(context, base->point, base->triangle_count, base->triangle, NULL, &tree));
  for (int32_t t = 0; t < surface->triangle_count; t++) {
    const int32_t *corner = surface->triangle + 3 * (size_t)t;
    double middle[3] = {0}, place[3], n[3], m[3];
    label[t] = -1;
    if (t % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    for (int k = 0; k < 9; k++)
      middle[k % 3] += surface->point[3 * (size_t)corner[k / 3] + (size_t)(k % 3)] / 3;
    bwi_tree_nearest(tree, middle, nearest, 0, place, &nearest);
    if (nearest < 0)
      continue;
    bwi_facet_normal(surface->point, corner, n);
    bwi_facet_normal(base->point, base->triangle + 3 * (size_t)nearest, m);
    if (fabs(bw_dot(n, m)) > 0.7 * bw_norm(n) * bw_norm(m))
      label[t] = faces->of_triangle[nearest];
  }
done:
  bwi_tree_destroy(tree);
  return status;
}

bw_status bw_faces_on_mesh(bw_context *context, const bw_surface *surface, const bw_faces *faces,
                           const bw_mesh *mesh, int32_t *label) {
  bw_surface *boundary = NULL;
  bw_status status = bw_mesh_boundary(context, mesh, &boundary, NULL);
  if (status == BW_OK)
    status = bwi_faces_label(context, surface, faces, boundary, label);
  bw_release(boundary);
  return status;
}

bw_status bw_faces_on_surface(bw_context *context, const bw_surface *surface, const bw_faces *faces,
                              const bw_surface *other, int32_t *label) {
  return bwi_faces_label(context, surface, faces, other, label);
}

/* The faces at each point, and the longest move that its edges allow. */
static void find_faces_around(const bw_faces *faces, const bw_surface *surface,
                              const int32_t *label, bwi_faces_around *at, double *max_move) {
  for (int32_t i = 0; i < surface->point_count; i++)
    max_move[i] = HUGE_VAL;
  for (int32_t t = 0; t < surface->triangle_count; t++) {
    const int32_t *corner = surface->triangle + 3 * (size_t)t;
    for (int k = 0; k < 3; k++) {
      int32_t a = corner[k], b = corner[(k + 1) % 3];
      double max = of_edge * apart(surface->point + 3 * (size_t)a, surface->point + 3 * (size_t)b);
      max_move[a] = fmin(max_move[a], max);
      max_move[b] = fmin(max_move[b], max);
      if (label[t] >= 0)
        bwi_around_add(&at[a], faces, label[t]);
    }
  }
}

/* Takes back the moves from `from` of facets that turn by more than 60 degrees against the surface;
 * true when there were some. */
static bool take_back(const bw_surface *surface, const double *from, double *point,
                      uint8_t *moved) {
  bool some = false;
  for (int32_t t = 0; t < surface->triangle_count; t++) {
    const int32_t *corner = surface->triangle + 3 * (size_t)t;
    double before[3], after[3];
    if (!moved[corner[0]] && !moved[corner[1]] && !moved[corner[2]])
      continue;
    bwi_facet_normal(surface->point, corner, before);
    bwi_facet_normal(point, corner, after);
    if (bw_norm(after) > 0.1 * bw_norm(before) &&
        bw_dot(before, after) > 0.5 * bw_norm(before) * bw_norm(after))
      continue;
    for (int k = 0; k < 3; k++)
      if (moved[corner[k]]) {
        memcpy(point + 3 * (size_t)corner[k], from + 3 * (size_t)corner[k], 3 * sizeof *point);
        moved[corner[k]] = 0;
        some = true;
      }
  }
  return some;
}

typedef struct projection {
  const bw_faces *faces;
  const bw_surface *surface;
  const bwi_faces_around *at;
  const double *max_move;
  double longest, diagonal;
  double *from, *point; /* before and after a round */
  uint8_t *moved;       /* in this round */
} projection;

/* A point of the border of a plane that is as near to all its faces as those of the base are moves
 * by roundings only: the outline of the plane, and its area, are those of the base. */
static bool is_outline(const bw_faces *faces, const bwi_faces_around *at, const double x[3]) {
  bool planes = false;
  for (int i = 0; i < at->count; i++) {
    const bw_face *face = &faces->face[at->face[i]];
    planes = planes || face->kind == BW_FACE_PLANE;
    if (fabs(bw_face_distance(face, x, NULL)) > 1.01 * face->residual)
      return false;
  }
  return planes && at->count > 1;
}

/* One round: onto primitives up to a kind. */
static bw_status move_onto(bw_context *context, projection *p, bw_face_kind last) {
  const bw_surface *surface = p->surface;
  memcpy(p->from, p->point, 3 * (size_t)surface->point_count * sizeof *p->from);
  for (int32_t i = 0; i < surface->point_count; i++) {
    double x[3];
    const bool outline =
        p->surface->group && is_outline(p->faces, &p->at[i], p->from + 3 * (size_t)i);
    const double longest = outline ? of_rounding * p->diagonal : fmin(p->max_move[i], p->longest);
    memcpy(x, p->from + 3 * (size_t)i, sizeof x);
    p->moved[i] = p->at[i].count > 0 &&
                  bwi_around_project(p->faces, &p->at[i], last, p->diagonal, x) &&
                  apart(surface->point + 3 * (size_t)i, x) <= longest &&
                  memcmp(x, p->from + 3 * (size_t)i, sizeof x) != 0;
    if (p->moved[i])
      memcpy(p->point + 3 * (size_t)i, x, sizeof x);
  }
  bw_status status = BW_OK;
  while (status == BW_OK && take_back(surface, p->from, p->point, p->moved))
    status = bw_check_cancel(context);
  return status;
}

bw_status bwi_faces_project(bw_context *context, const bw_surface *base, const bw_faces *faces,
                            const bw_surface *surface, double longest, bw_surface **projected,
                            int64_t *count, double *moved) {
  bw_status status = BW_OK;
  bw_surface *made = NULL;
  bw_surface_report report = {0};
  size_t points = (size_t)surface->point_count;
  bwi_faces_around *at = BW_NEW0(context, bwi_faces_around, points);
  double *max_move = BW_NEW(context, double, points);
  int32_t *label = BW_NEW(context, int32_t, surface->triangle_count);
  projection p = {.faces = faces,
                  .surface = surface,
                  .at = at,
                  .max_move = max_move,
                  .longest = longest,
                  .diagonal = bwi_surface_diagonal(surface),
                  .from = BW_NEW(context, double, 3 * points),
                  .point = BW_NEW(context, double, 3 * points),
                  .moved = BW_NEW0(context, uint8_t, points)};
  *count = 0;
  *moved = 0;
  BW_TRY_MEMORY(at && max_move && label && p.from && p.point && p.moved);
  if (surface->group)
    memcpy(label, surface->group, (size_t)surface->triangle_count * sizeof *label);
  else
    BW_TRY(bwi_faces_label(context, base, faces, surface, label));
  find_faces_around(faces, surface, label, at, max_move);
  memcpy(p.point, surface->point, 3 * points * sizeof *p.point);
  /* Planes first, by hair's breadths: what the longer moves onto round faces give up stays flat. */
  BW_TRY(move_onto(context, &p, BW_FACE_PLANE));
  BW_TRY(move_onto(context, &p, BW_FACE_SPHERE));
  for (size_t i = 0; i < points; i++) {
    double far = apart(p.point + 3 * i, surface->point + 3 * i);
    *count += far > 0;
    *moved = fmax(*moved, far);
  }
  if (*count > 0)
    BW_TRY(bw_surface_copy(context, surface->point_count, p.point, surface->triangle_count,
                           surface->triangle, surface->group, &made));
  if (made)
    BW_TRY(bw_surface_check(context, made, 0, &report));
  if (made && report.sound) {
    *projected = made;
    made = NULL;
  } else {
    *count = 0;
    *moved = 0;
    *projected = (bw_surface *)bw_retain(surface);
  }
done:
  bw_surface_report_clear(&report);
  bw_release(made);
  bw_free(at);
  bw_free(max_move);
  bw_free(label);
  bw_free(p.from);
  bw_free(p.point);
  bw_free(p.moved);
  return status;
}
