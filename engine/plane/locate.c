/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which element holds a place: a tree of boxes over the elements, which are sorted along a Morton
 * curve through their centroids. The nearest element is searched, at distance 0 the one that holds
 * the place. Elements are taken as straight-edged; where a side is curved, the place in the found
 * element is then refined by Newton's method. */
#include "base/box_tree.h"
#include "plane/internal.h"

#include <math.h>
#include <string.h>

enum { LEAF = 4 };

struct bw_plane_locator {
  const bw_plane_mesh *mesh; /* retained */
  bwi_box_tree tree;         /* of the elements along the curve */
};

static void corners_of(const bw_plane_mesh *mesh, int32_t element, const double *x[3]) {
  const bw_plane_topology *t = mesh->topology;
  const int32_t *n = t->element + (size_t)element * (size_t)bwi_plane_width(t->nodes);
  for (int k = 0; k < 3; k++)
    x[k] = mesh->point + 2 * (size_t)n[k];
}

static void box_of(const void *data, int32_t element, double *min, double *max) {
  const double *x[3];
  corners_of(data, element, x);
  for (int k = 0; k < 2; k++) {
    min[k] = fmin(x[0][k], fmin(x[1][k], x[2][k]));
    max[k] = fmax(x[0][k], fmax(x[1][k], x[2][k]));
  }
}

bw_status bw_plane_locator_create(bw_context *context, const bw_plane_mesh *mesh,
                                  bw_plane_locator **out) {
  bw_status status = BW_OK;
  int32_t count = mesh->topology->element_count, *element = BW_NEW(context, int32_t, count);
  double *middle = BW_NEW(context, double, 2 * (size_t)count);
  bw_plane_locator *made = BW_NEW0(context, bw_plane_locator, 1);
  BW_TRY_MEMORY(middle && element && made);
  for (int32_t i = 0; i < count; i++) {
    const double *x[3];
    corners_of(mesh, i, x);
    for (size_t k = 0; k < 2; k++)
      middle[2 * (size_t)i + k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  }
  BW_TRY(bwi_order_places(context, count, middle, element));
  status = bwi_box_tree_create(context, 2, LEAF, count, element, box_of, mesh, &made->tree);
  element = NULL;
  if (status != BW_OK)
    goto done;
  made->mesh = bw_retain(mesh);
  *out = made;
  made = NULL;
done:
  bw_free(middle);
  bw_free(element);
  bw_free(made);
  return status;
}

void bw_plane_locator_destroy(bw_plane_locator *locator) {
  if (!locator)
    return;
  bw_release(locator->mesh);
  bwi_box_tree_clear(&locator->tree);
  bw_free(locator);
}

/* Squared distance from a triangle, barycentric coordinates of the nearest place in it. */
static double on_triangle(const double p[2], const double *x[3], double weight[3]) {
  double twice = bwi_cross2(x[0], x[1], x[2]);
  weight[0] = bwi_cross2(p, x[1], x[2]) / twice;
  weight[1] = bwi_cross2(x[0], p, x[2]) / twice;
  weight[2] = bwi_cross2(x[0], x[1], p) / twice;
  if (fmin(weight[0], fmin(weight[1], weight[2])) >= -1e-12) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
      sum += weight[k] = fmax(weight[k], 0);
    for (int k = 0; k < 3; k++)
      weight[k] /= sum;
    return 0;
  }
  double best = INFINITY;
  for (int k = 0; k < 3; k++) {
    const double *a = x[k], *b = x[(k + 1) % 3];
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {p[0] - a[0], p[1] - a[1]};
    double t = (u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1]);
    t = fmin(fmax(t, 0), 1);
    double square = (v[0] - t * u[0]) * (v[0] - t * u[0]) + (v[1] - t * u[1]) * (v[1] - t * u[1]);
    if (square < best) {
      best = square;
      weight[k] = 1 - t;
      weight[(k + 1) % 3] = t;
      weight[(k + 2) % 3] = 0;
    }
  }
  return best;
}

/* Where in a six-node element the place is: from the barycentric coordinates of the straight one.
 * Returns the distance of what was found after clipping; < 0 when Newton's method goes astray. */
static double refine(const bw_plane_mesh *mesh, int32_t element, const double p[2],
                     double weight[3]) {
  const int32_t *n = mesh->topology->element + 6 * (size_t)element;
  double r = weight[1], s = weight[2], x[2];
  for (int round = 0; round <= 12; round++) {
    double f[6], fr[6], fs[6], d[2][2] = {{0, 0}, {0, 0}};
    bwi_tri6(r, s, f, fr, fs);
    x[0] = x[1] = 0;
    for (int i = 0; i < 6; i++)
      for (int k = 0; k < 2; k++) {
        double at = mesh->point[2 * (size_t)n[i] + (size_t)k];
        x[k] += f[i] * at;
        d[0][k] += fr[i] * at;
        d[1][k] += fs[i] * at;
      }
    double j = d[0][0] * d[1][1] - d[0][1] * d[1][0];
    double e[2] = {p[0] - x[0], p[1] - x[1]};
    if (round == 12 || !(fabs(j) > 0))
      break;
    double dr = (e[0] * d[1][1] - e[1] * d[1][0]) / j, ds = (e[1] * d[0][0] - e[0] * d[0][1]) / j;
    r += dr;
    s += ds;
    if (fabs(dr) + fabs(ds) < 1e-13)
      break;
  }
  if (!(r > -0.5 && s > -0.5 && r + s < 1.5))
    return -1;
  double clipped[3] = {fmax(1 - r - s, 0), fmax(r, 0), fmax(s, 0)};
  double sum = clipped[0] + clipped[1] + clipped[2], f[6], fr[6], fs[6];
  for (int k = 0; k < 3; k++)
    weight[k] = clipped[k] / sum;
  bwi_tri6(weight[1], weight[2], f, fr, fs);
  x[0] = x[1] = 0;
  for (int i = 0; i < 6; i++)
    for (int k = 0; k < 2; k++)
      x[k] += f[i] * mesh->point[2 * (size_t)n[i] + (size_t)k];
  return hypot(p[0] - x[0], p[1] - x[1]);
}

void bwi_tri6(double r, double s, double f[6], double fr[6], double fs[6]) {
  double q = 1 - r - s;
  f[0] = q * (2 * q - 1);
  f[1] = r * (2 * r - 1);
  f[2] = s * (2 * s - 1);
  f[3] = 4 * q * r;
  f[4] = 4 * r * s;
  f[5] = 4 * s * q;
  fr[0] = fs[0] = 1 - 4 * q;
  fr[1] = 4 * r - 1;
  fs[1] = fr[2] = 0;
  fs[2] = 4 * s - 1;
  fr[3] = 4 * (q - r);
  fs[3] = -4 * r;
  fr[4] = 4 * s;
  fs[4] = 4 * r;
  fr[5] = -4 * s;
  fs[5] = 4 * (q - s);
}

static bool curved(const bw_plane_mesh *mesh, int32_t element) {
  const bw_plane_topology *t = mesh->topology;
  if (t->nodes->order == 1)
    return false;
  const int32_t *n = t->element + 6 * (size_t)element;
  const double *x[6];
  for (int i = 0; i < 6; i++)
    x[i] = mesh->point + 2 * (size_t)n[i];
  return bwi_curved_quality(x) < 1 - 1e-12;
}

static double distance_from(void *data, int32_t element, const double *at) {
  const double *x[3];
  double weight[3];
  corners_of(data, element, x);
  return on_triangle(at, x, weight);
}

int32_t bw_plane_locate(const bw_plane_locator *locator, const double at[2], double barycentric[3],
                        double *outside) {
  const bw_plane_mesh *mesh = locator->mesh;
  double best;
  int32_t found = bwi_box_tree_nearest(&locator->tree, at, distance_from, (void *)mesh, &best);
  if (found < 0) { /* a place that is no number is nowhere: say the first element's corner */
    found = 0;
    barycentric[0] = 1;
    barycentric[1] = barycentric[2] = 0;
  } else {
    const double *x[3];
    corners_of(mesh, found, x);
    on_triangle(at, x, barycentric);
  }
  double distance = sqrt(best);
  if (curved(mesh, found)) {
    double straight[3];
    memcpy(straight, barycentric, sizeof straight);
    double refined = refine(mesh, found, at, barycentric);
    if (refined >= 0 && (best == 0 || refined < distance))
      distance = refined;
    else
      memcpy(barycentric, straight, sizeof straight);
  }
  if (outside)
    *outside = distance;
  return found;
}
