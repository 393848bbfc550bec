/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which element holds a point: a tree of boxes over the straight-edged elements.
 *
 * The elements are sorted along a Morton curve through their centroids and cut into leaves of
 * eight; the tree is a complete binary one in heap order (children of k: 2k+1, 2k+2), its last
 * level the leaves, padded with empty boxes to a power of two. One search serves both questions: an
 * element that holds the point has the distance 0. */
#include "barwright/mesh.h"

#include <math.h>
#include <string.h>

enum { LEAF = 8 };

struct bw_locator {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  int32_t *element;    /* along the curve */
  int64_t leaves;      /* a power of two */
  double (*box)[6];    /* 2 leaves - 1: low, high */
};

static void locator_destroy(void *object) {
  bw_locator *locator = object;
  bw_release(locator->mesh);
  bw_free(locator->element);
  bw_free(locator->box);
  bw_free(locator);
}

static size_t locator_bytes(const void *object) {
  const bw_locator *locator = object;
  return sizeof *locator + (size_t)locator->mesh->element_count * sizeof(int32_t) +
         (size_t)(2 * locator->leaves - 1) * sizeof *locator->box;
}

static const bw_kind locator_kind = {"locator", locator_destroy, locator_bytes};

static void corners_of(const bw_mesh *mesh, int32_t element, const double *x[4]) {
  const int32_t *e = mesh->element + (size_t)element * (size_t)mesh->nodes_per_element;
  for (int k = 0; k < 4; k++)
    x[k] = mesh->node + 3 * (size_t)e[k];
}

/* ---- building ------------------------------------------------------------------------------- */

/* Every third bit: the lowest 21 bits of v spread out. */
static uint64_t spread(uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

typedef struct coded {
  uint64_t code;
  int32_t element;
} coded;

/* Radix sort, eleven bits at a time: stable, so equal codes keep the order of their numbers. */
static void sort_codes(coded *list, coded *other, int64_t count) {
  for (int shift = 0; shift < 66; shift += 11) {
    int64_t place[2049] = {0};
    for (int64_t i = 0; i < count; i++)
      place[(list[i].code >> shift & 2047) + 1]++;
    for (int i = 0; i < 2048; i++)
      place[i + 1] += place[i];
    for (int64_t i = 0; i < count; i++)
      other[place[list[i].code >> shift & 2047]++] = list[i];
    coded *kept = list;
    list = other;
    other = kept;
  }
}

static void fill_boxes(bw_locator *locator) {
  const bw_mesh *mesh = locator->mesh;
  for (int64_t leaf = 0; leaf < locator->leaves; leaf++) {
    double *box = locator->box[locator->leaves - 1 + leaf];
    for (int k = 0; k < 3; k++) {
      box[k] = INFINITY;
      box[3 + k] = -INFINITY;
    }
    for (int64_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < mesh->element_count; i++) {
      const double *x[4];
      corners_of(mesh, locator->element[i], x);
      for (int c = 0; c < 4; c++)
        for (int k = 0; k < 3; k++) {
          box[k] = fmin(box[k], x[c][k]);
          box[3 + k] = fmax(box[3 + k], x[c][k]);
        }
    }
  }
  for (int64_t node = locator->leaves - 1; node-- > 0;)
    for (int k = 0; k < 3; k++) {
      const double *a = locator->box[2 * node + 1], *b = locator->box[2 * node + 2];
      locator->box[node][k] = fmin(a[k], b[k]);
      locator->box[node][3 + k] = fmax(a[3 + k], b[3 + k]);
    }
}

bw_status bw_locator_create(bw_context *context, const bw_mesh *mesh, bw_locator **out) {
  bw_status status = BW_OK;
  int64_t count = mesh->element_count;
  coded *list = BW_NEW(context, coded, count), *other = BW_NEW(context, coded, count);
  bw_locator *locator = BW_NEW0(context, bw_locator, 1);
  if (!list || !other || !locator) {
    bw_free(locator);
    status = BW_MEMORY;
    goto done;
  }
  bw_object_init(locator, &locator_kind);
  locator->mesh = bw_retain(mesh);
  locator->leaves = 1;
  while (locator->leaves * LEAF < count)
    locator->leaves *= 2;
  locator->element = BW_NEW(context, int32_t, count);
  locator->box = bw_alloc(context, (size_t)(2 * locator->leaves - 1), sizeof *locator->box);
  if (!locator->element || !locator->box) {
    bw_release(locator);
    status = BW_MEMORY;
    goto done;
  }
  double low[3], high[3], scale[3];
  bw_mesh_box(mesh, low, high);
  for (int k = 0; k < 3; k++)
    scale[k] = high[k] > low[k] ? 2097151 / (high[k] - low[k]) : 0;
  for (int32_t i = 0; i < count; i++) {
    const double *x[4];
    corners_of(mesh, i, x);
    list[i].code = 0;
    list[i].element = i;
    for (int k = 0; k < 3; k++) {
      double middle = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
      double place = fmin(fmax((middle - low[k]) * scale[k], 0), 2097151);
      list[i].code |= spread((uint64_t)place) << k;
    }
  }
  sort_codes(list, other, count); /* six passes: the result is in `list` again */
  for (int64_t i = 0; i < count; i++)
    locator->element[i] = list[i].element;
  fill_boxes(locator);
  *out = locator;
done:
  bw_free(list);
  bw_free(other);
  return status;
}

/* ---- searching ------------------------------------------------------------------------------ */

static double clamp_unit(double t) {
  return t < 0 ? 0 : t > 1 ? 1 : t;
}

/* The place on the segment nearest to p: returns its squared distance, *t along a to b. */
static double on_segment(const double *p, const double *a, const double *b, double *t) {
  double u[3], v[3], length = 0, along = 0, square = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = p[k] - a[k];
    length += u[k] * u[k];
    along += u[k] * v[k];
  }
  *t = length > 0 ? clamp_unit(along / length) : 0;
  for (int k = 0; k < 3; k++)
    square += (v[k] - *t * u[k]) * (v[k] - *t * u[k]);
  return square;
}

/* The place on the triangle nearest to p: the foot of the normal when it falls inside, else on one
 * of the sides. Returns the squared distance. */
static double on_triangle(const double *p, const double *a, const double *b, const double *c,
                          double weight[3]) {
  const double *corner[3] = {a, b, c};
  double u[3], v[3], w[3], n[3], part[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = p[k] - a[k];
  }
  bw_cross(u, v, n);
  double square = bw_dot(n, n);
  if (square > 0) {
    bw_cross(u, w, part);
    double wc = bw_dot(part, n) / square;
    bw_cross(w, v, part);
    double wb = bw_dot(part, n) / square;
    if (wb >= 0 && wc >= 0 && wb + wc <= 1) {
      weight[0] = 1 - wb - wc;
      weight[1] = wb;
      weight[2] = wc;
      double height = bw_dot(w, n);
      return height * height / square;
    }
  }
  double best = INFINITY;
  for (int k = 0; k < 3; k++) {
    double t, distance = on_segment(p, corner[k], corner[(k + 1) % 3], &t);
    if (distance < best) {
      best = distance;
      weight[k] = 1 - t;
      weight[(k + 1) % 3] = t;
      weight[(k + 2) % 3] = 0;
    }
  }
  return best;
}

/* Squared distance of p from an element; 0 when it is inside, up to rounding. */
static double on_element(const double *p, const double *x[4], double weight[4]) {
  double a[3], b[3], c[3], w[3], n[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x[1][k] - x[0][k];
    b[k] = x[2][k] - x[0][k];
    c[k] = x[3][k] - x[0][k];
    w[k] = p[k] - x[0][k];
  }
  bw_cross(b, c, n);
  double volume = bw_dot(a, n);
  weight[1] = bw_dot(w, n) / volume;
  bw_cross(c, a, n);
  weight[2] = bw_dot(w, n) / volume;
  bw_cross(a, b, n);
  weight[3] = bw_dot(w, n) / volume;
  weight[0] = 1 - weight[1] - weight[2] - weight[3];
  double min = fmin(fmin(weight[0], weight[1]), fmin(weight[2], weight[3]));
  if (min >= -1e-12) {
    double sum = 0;
    for (int k = 0; k < 4; k++)
      sum += weight[k] = fmax(weight[k], 0);
    for (int k = 0; k < 4; k++)
      weight[k] /= sum;
    return 0;
  }
  double best = INFINITY, on_face[3] = {0, 0, 0}, found[4] = {0, 0, 0, 0};
  static const int opposite[4] = {3, 2, 0, 1};
  for (int k = 0; k < 4; k++) {
    if (weight[opposite[k]] >= 0) /* p is on the inner side of this face */
      continue;
    const int *f = bw_tet_face[k];
    double distance = on_triangle(p, x[f[0]], x[f[1]], x[f[2]], on_face);
    if (distance < best) {
      best = distance;
      found[opposite[k]] = 0;
      for (int i = 0; i < 3; i++)
        found[f[i]] = on_face[i];
    }
  }
  memcpy(weight, found, sizeof found);
  return best;
}

static double on_box(const double *p, const double box[6]) {
  double square = 0;
  for (int k = 0; k < 3; k++) {
    double d = fmax(fmax(box[k] - p[k], p[k] - box[3 + k]), 0);
    square += d * d;
  }
  return square;
}

int32_t bw_locator_find(const bw_locator *locator, const double point[3], double weight[4],
                        bool *inside) {
  int64_t stack[80]; /* one sibling per level */
  int depth = 0;
  double best = INFINITY;
  int32_t found = -1;
  stack[depth++] = 0;
  while (depth > 0 && best > 0) {
    int64_t node = stack[--depth];
    if (on_box(point, locator->box[node]) > best)
      continue;
    if (node < locator->leaves - 1) {
      int64_t near = 2 * node + 1, far = near + 1;
      if (on_box(point, locator->box[far]) < on_box(point, locator->box[near])) {
        far = near;
        near = far + 1;
      }
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    int64_t first = (node - (locator->leaves - 1)) * LEAF;
    for (int64_t i = first; i < first + LEAF && i < locator->mesh->element_count; i++) {
      const double *x[4];
      double here[4];
      corners_of(locator->mesh, locator->element[i], x);
      double distance = on_element(point, x, here);
      if (distance < best || (distance == best && locator->element[i] < found)) {
        best = distance;
        found = locator->element[i];
        memcpy(weight, here, sizeof here);
      }
    }
  }
  if (found < 0) { /* a point that is no number is nowhere: say the first element's corner */
    found = 0;
    memcpy(weight, (double[4]){1, 0, 0, 0}, 4 * sizeof *weight);
  }
  if (inside)
    *inside = best == 0;
  return found;
}
