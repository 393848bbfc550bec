/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which element holds a point: a tree of boxes over the straight-edged elements, which are sorted
 * along a Morton curve through their centroids. One search serves both questions: an element that
 * holds the point has the distance 0. */
#include "mesh/locator.h"

#include <math.h>
#include <string.h>

enum { LEAF = 8 };

struct bw_locator {
  bw_object object;
  const bw_mesh *mesh; /* retained */
  bwi_box_tree tree;   /* of the elements along the curve */
};

static void locator_destroy(void *object) {
  bw_locator *locator = object;
  bw_release(locator->mesh);
  bwi_box_tree_clear(&locator->tree);
  bw_free(locator);
}

static size_t locator_bytes(const void *object) {
  const bw_locator *locator = object;
  return sizeof *locator + bwi_box_tree_bytes(&locator->tree);
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

static void box_of(const void *data, int32_t element, double *min, double *max) {
  const double *x[4];
  corners_of(data, element, x);
  for (int k = 0; k < 3; k++) {
    min[k] = fmin(fmin(x[0][k], x[1][k]), fmin(x[2][k], x[3][k]));
    max[k] = fmax(fmax(x[0][k], x[1][k]), fmax(x[2][k], x[3][k]));
  }
}

bw_status bw_locator_create(bw_context *context, const bw_mesh *mesh, bw_locator **out) {
  bw_status status = BW_OK;
  int64_t count = mesh->element_count;
  coded *list = BW_NEW(context, coded, count), *other = BW_NEW(context, coded, count);
  int32_t *element = BW_NEW(context, int32_t, count);
  bw_locator *locator = BW_NEW0(context, bw_locator, 1);
  if (!list || !other || !element || !locator) {
    bw_free(element);
    bw_free(locator);
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
    element[i] = list[i].element;
  status = bwi_box_tree_create(context, 3, LEAF, count, element, box_of, mesh, &locator->tree);
  if (status != BW_OK) {
    bw_free(locator);
    goto done;
  }
  bw_object_init(locator, &locator_kind);
  locator->mesh = bw_retain(mesh);
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

/* The foot of the normal when it falls inside, else a place on one of the sides. */
double bwi_triangle_weights(const double *p, const double *a, const double *b, const double *c,
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
    double distance = bwi_triangle_weights(p, x[f[0]], x[f[1]], x[f[2]], on_face);
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

static double distance_from(void *data, int32_t element, const double *point) {
  const double *x[4];
  double weight[4];
  corners_of(data, element, x);
  return on_element(point, x, weight);
}

int32_t bw_locator_find(const bw_locator *locator, const double point[3], double weight[4],
                        bool *inside) {
  const double *x[4];
  double square;
  int32_t found =
      bwi_box_tree_nearest(&locator->tree, point, distance_from, (void *)locator->mesh, &square);
  if (inside)
    *inside = square == 0;
  if (found < 0) { /* a point that is no number is nowhere: say the first element's corner */
    memcpy(weight, (double[4]){1, 0, 0, 0}, 4 * sizeof *weight);
    return 0;
  }
  corners_of(locator->mesh, found, x);
  on_element(point, x, weight);
  return found;
}

bw_status bwi_locator_in_box(const bw_locator *locator, const double *min, const double *max,
                             bwi_item_visit *visit, void *data) {
  return bwi_box_tree_in_box(&locator->tree, min, max, visit, data);
}
