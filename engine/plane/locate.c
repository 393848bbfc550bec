/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which element holds a place: a tree of boxes.
 *
 * The elements are sorted along a Morton curve through their centroids and cut into leaves; the
 * tree is a complete binary one in heap order (children of k: 2k+1, 2k+2), its last level the
 * leaves, padded with empty boxes to a power of two. The nearest element is searched, at distance 0
 * the one that holds the place. Elements are taken as straight-edged; where a side is curved, the
 * place in the found element is then refined by Newton's method. */
#include "plane/internal.h"

#include <math.h>
#include <string.h>

enum { LEAF = 4 };

struct bw_plane_locator {
  const bw_plane_mesh *mesh; /* retained */
  int32_t *element;          /* along the curve */
  int64_t leaves;            /* a power of two */
  double (*box)[4];          /* 2 leaves - 1: low, high */
};

static void corners_of(const bw_plane_mesh *mesh, int32_t element, const double *x[3]) {
  const bw_plane_topology *t = mesh->topology;
  const int32_t *n = t->element + (size_t)element * (size_t)bwi_plane_width(t->nodes);
  for (int k = 0; k < 3; k++)
    x[k] = mesh->point + 2 * (size_t)n[k];
}

static void fill_boxes(bw_plane_locator *locator) {
  for (int64_t leaf = 0; leaf < locator->leaves; leaf++) {
    double *box = locator->box[locator->leaves - 1 + leaf];
    box[0] = box[1] = INFINITY;
    box[2] = box[3] = -INFINITY;
    for (int64_t i = leaf * LEAF;
         i < (leaf + 1) * LEAF && i < locator->mesh->topology->element_count; i++) {
      const double *x[3];
      corners_of(locator->mesh, locator->element[i], x);
      for (int c = 0; c < 3; c++)
        for (int k = 0; k < 2; k++) {
          box[k] = fmin(box[k], x[c][k]);
          box[2 + k] = fmax(box[2 + k], x[c][k]);
        }
    }
  }
  for (int64_t node = locator->leaves - 1; node-- > 0;)
    for (int k = 0; k < 2; k++) {
      const double *a = locator->box[2 * node + 1], *b = locator->box[2 * node + 2];
      locator->box[node][k] = fmin(a[k], b[k]);
      locator->box[node][2 + k] = fmax(a[2 + k], b[2 + k]);
    }
}

bw_status bw_plane_locator_create(bw_context *context, const bw_plane_mesh *mesh,
                                  bw_plane_locator **out) {
  bw_status status = BW_OK;
  int32_t count = mesh->topology->element_count;
  double *middle = BW_NEW(context, double, 2 * (size_t)count);
  bw_plane_locator *made = BW_NEW0(context, bw_plane_locator, 1);
  if (!middle || !made) {
    status = BW_MEMORY;
    goto done;
  }
  made->mesh = bw_retain(mesh);
  made->leaves = 1;
  while (made->leaves * LEAF < count)
    made->leaves *= 2;
  made->element = BW_NEW(context, int32_t, count);
  made->box = bw_alloc(context, (size_t)(2 * made->leaves - 1), sizeof *made->box);
  if (!made->element || !made->box) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0; i < count; i++) {
    const double *x[3];
    corners_of(mesh, i, x);
    for (size_t k = 0; k < 2; k++)
      middle[2 * (size_t)i + k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  }
  BW_TRY(bwi_order_places(context, count, middle, made->element));
  fill_boxes(made);
  *out = made;
  made = NULL;
done:
  bw_free(middle);
  bw_plane_locator_free(made);
  return status;
}

void bw_plane_locator_free(bw_plane_locator *locator) {
  if (!locator)
    return;
  bw_release(locator->mesh);
  bw_free(locator->element);
  bw_free(locator->box);
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

static double on_box(const double p[2], const double box[4]) {
  double square = 0;
  for (int k = 0; k < 2; k++) {
    double d = fmax(fmax(box[k] - p[k], p[k] - box[2 + k]), 0);
    square += d * d;
  }
  return square;
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

int32_t bw_plane_locate(const bw_plane_locator *locator, const double at[2], double barycentric[3],
                        double *outside) {
  const bw_plane_mesh *mesh = locator->mesh;
  int64_t stack[80]; /* one sibling per level */
  int depth = 0;
  double best = INFINITY;
  int32_t found = -1;
  stack[depth++] = 0;
  while (depth > 0 && best > 0) {
    int64_t node = stack[--depth];
    if (on_box(at, locator->box[node]) > best)
      continue;
    if (node < locator->leaves - 1) {
      int64_t near = 2 * node + 1, far = near + 1;
      if (on_box(at, locator->box[far]) < on_box(at, locator->box[near])) {
        far = near;
        near = far + 1;
      }
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    int64_t first = (node - (locator->leaves - 1)) * LEAF;
    for (int64_t i = first; i < first + LEAF && i < mesh->topology->element_count; i++) {
      const double *x[3];
      double here[3];
      corners_of(mesh, locator->element[i], x);
      double distance = on_triangle(at, x, here);
      if (distance < best || (distance == best && locator->element[i] < found)) {
        best = distance;
        found = locator->element[i];
        memcpy(barycentric, here, sizeof here);
      }
    }
  }
  if (found < 0) { /* a place that is no number is nowhere: say the first element's corner */
    found = 0;
    barycentric[0] = 1;
    barycentric[1] = barycentric[2] = 0;
    best = INFINITY;
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
