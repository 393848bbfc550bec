/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Polygons into triangles by ear clipping.
 *
 * The polygon is projected onto the plane across its area vector (Newell's normal), in which a
 * polygon turns counter-clockwise. A corner is an ear when it is convex and no reflex corner lies
 * in its triangle; of all ears the best-shaped is cut first, so that quadrilaterals are cut along
 * the diagonal with the better triangles and slivers come last. Cutting changes the state of the
 * two neighbours only: n corners cost n times the number of reflex ones. */
#include "io/internal.h"

#include <math.h>

typedef struct corner2 {
  double x, y;
  int32_t before, after; /* in the ring of what is left */
  double shape;          /* of the ear: sine-like, larger is better; negative: no ear */
  bool reflex;
} corner2;

static double doubled_area(const corner2 *a, const corner2 *b, const corner2 *c) {
  return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static double square(const corner2 *a, const corner2 *b) {
  return (b->x - a->x) * (b->x - a->x) + (b->y - a->y) * (b->y - a->y);
}

static bool same(const corner2 *a, const corner2 *b) {
  return a->x == b->x && a->y == b->y;
}

/* Project onto the plane; false when the polygon has no area to speak of. */
static bool flatten(const double *point, const int32_t *corner, size_t count, corner2 *ring) {
  const double *origin = point + 3 * (size_t)corner[0];
  double normal[3] = {0, 0, 0}, a[3], b[3], size = 0;
  for (size_t i = 0; i < count; i++) {
    const double *p = point + 3 * (size_t)corner[i];
    const double *q = point + 3 * (size_t)corner[(i + 1) % count];
    for (int k = 0; k < 3; k++)
      a[k] = p[k] - origin[k], b[k] = q[k] - origin[k];
    double c[3];
    bw_cross(a, b, c);
    for (int k = 0; k < 3; k++)
      normal[k] += c[k];
    size = fmax(size, bw_dot(a, a));
  }
  double length = bw_norm(normal);
  if (!(length > 1e-14 * size) || !isfinite(length))
    return false;
  double u[3], v[3];
  for (int k = 0; k < 3; k++)
    normal[k] /= length;
  bw_across(normal, u, v);
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++)
      a[k] = point[3 * (size_t)corner[i] + (size_t)k] - origin[k];
    ring[i].x = bw_dot(a, u);
    ring[i].y = bw_dot(a, v);
    ring[i].before = (int32_t)(i == 0 ? count - 1 : i - 1);
    ring[i].after = (int32_t)(i + 1 == count ? 0 : i + 1);
  }
  return true;
}

static void check(corner2 *ring, int32_t i) {
  corner2 *b = ring + i;
  const corner2 *a = ring + b->before, *c = ring + b->after;
  double area = doubled_area(a, b, c);
  b->reflex = !(area > 0);
  b->shape = -1;
  if (b->reflex)
    return;
  for (int32_t j = c->after; j != b->before; j = ring[j].after) {
    const corner2 *p = ring + j;
    if (!p->reflex || same(p, a) || same(p, b) || same(p, c))
      continue;
    if (doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0)
      return;
  }
  double longest = fmax(square(a, b), fmax(square(b, c), square(c, a)));
  b->shape = area / longest;
}

static void emit(int32_t **triangle, int32_t a, int32_t b, int32_t c) {
  *(*triangle)++ = a;
  *(*triangle)++ = b;
  *(*triangle)++ = c;
}

static bw_status clip(bw_context *context, corner2 *ring, const int32_t *corner, size_t count,
                      int32_t *triangle) {
  for (size_t i = 0; i < count; i++) /* the ear test asks who is reflex */
    ring[i].reflex = !(doubled_area(ring + ring[i].before, ring + i, ring + ring[i].after) > 0);
  for (size_t i = 0; i < count; i++)
    check(ring, (int32_t)i);
  int32_t at = 0;
  for (size_t left = count; left > 3; left--) {
    /* No ear: the polygon crosses itself. Any cut is as good as another; take the flattest, and
     * leave it to the check of the surface to say so. */
    int32_t best = at;
    for (size_t i = 0; i < left; i++, at = ring[at].after)
      if (ring[at].shape > ring[best].shape || (ring[at].shape == ring[best].shape && at < best))
        best = at;
    int32_t before = ring[best].before, after = ring[best].after;
    emit(&triangle, corner[before], corner[best], corner[after]);
    ring[before].after = after;
    ring[after].before = before;
    check(ring, before);
    check(ring, after);
    at = after;
    if (left % 256 == 0) {
      bw_status status = bw_check_cancel(context);
      if (status != BW_OK)
        return status;
    }
  }
  emit(&triangle, corner[ring[at].before], corner[at], corner[ring[at].after]);
  return BW_OK;
}

bw_status bwi_triangulate(bw_context *context, const double *point, const int32_t *corner,
                          size_t count, int32_t *triangle) {
  corner2 few[16];
  corner2 *ring = few;
  if (count > sizeof few / sizeof *few) {
    ring = BW_NEW(context, corner2, count);
    if (!ring)
      return BW_MEMORY;
  }
  bw_status status = BW_OK;
  if (count > 3 && flatten(point, corner, count, ring)) {
    status = clip(context, ring, corner, count, triangle);
  } else {
    for (size_t i = 1; i + 1 < count; i++)
      emit(&triangle, corner[0], corner[i], corner[i + 1]);
  }
  if (ring != few)
    bw_free(ring);
  return status;
}
