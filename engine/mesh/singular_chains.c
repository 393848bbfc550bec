/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places as polylines, made of edges between facets.
 *
 * Invariant: point and inward have point_count rows, and each place has its rows in one block. */
#include "mesh/singular_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the list -------------------------------------------------------------------------------- */

static void places_destroy(void *object) {
  bw_singular_places *places = (bw_singular_places *)object;
  bw_free(places->place);
  bw_free(places->point);
  bw_free(places->inward);
  bw_free(places);
}

static size_t places_bytes(const void *object) {
  const bw_singular_places *places = (const bw_singular_places *)object;
  return sizeof *places + (size_t)places->count * sizeof *places->place +
         6 * (size_t)places->point_count * sizeof *places->point;
}

static const bw_kind places_kind = {"singular places", places_destroy, places_bytes};

bw_status bwi_singular_create(bw_context *context, bw_singular_places **places) {
  *places = BW_NEW0(context, bw_singular_places, 1);
  if (!*places)
    return BW_MEMORY;
  bw_object_init(*places, &places_kind);
  return BW_OK;
}

bw_status bwi_singular_add(bw_context *context, bw_singular_places *places,
                           const bw_singular_place *place, int32_t count, const double *point,
                           const double *inward) {
  size_t points = (size_t)places->point_count, rows = (size_t)count;
  size_t capacity = (size_t)places->count, point_capacity = 3 * points,
         inward_capacity = 3 * points;
  if (!bw_grow(context, (void **)&places->place, &capacity, capacity, 1, sizeof *places->place) ||
      !bw_grow(context, (void **)&places->point, &point_capacity, 3 * points, 3 * rows,
               sizeof(double)) ||
      !bw_grow(context, (void **)&places->inward, &inward_capacity, 3 * points, 3 * rows,
               sizeof(double)))
    return BW_MEMORY;
  memcpy(places->point + 3 * points, point, 3 * rows * sizeof *point);
  memcpy(places->inward + 3 * points, inward, 3 * rows * sizeof *inward);
  bw_singular_place *own = &places->place[places->count++];
  *own = *place;
  own->first = places->point_count;
  own->count = count;
  places->point_count += count;
  return BW_OK;
}

static int by_length(const void *a, const void *b) {
  const bw_singular_place *x = (const bw_singular_place *)a, *y = (const bw_singular_place *)b;
  if (x->kind != y->kind)
    return x->kind < y->kind ? -1 : 1;
  if (x->length != y->length)
    return x->length > y->length ? -1 : 1;
  return (x->first > y->first) - (x->first < y->first);
}

void bwi_singular_sort(bw_singular_places *places) {
  if (places->count > 1)
    qsort(places->place, (size_t)places->count, sizeof *places->place, by_length);
}

/* ---- edges of facets ------------------------------------------------------------------------- */

bw_status bwi_seams_add(bw_context *context, bwi_seams *seams, const bwi_seam *seam) {
  if (!bw_grow(context, (void **)&seams->seam, &seams->capacity, seams->count, 1,
               sizeof *seams->seam))
    return BW_MEMORY;
  seams->seam[seams->count] = *seam;
  seams->seam[seams->count].number = (int32_t)seams->count;
  seams->count++;
  return BW_OK;
}

static void without(double vector[3], const double direction[3]) {
  double along = bw_dot(vector, direction);
  for (int k = 0; k < 3; k++)
    vector[k] -= along * direction[k];
  double size = bw_norm(vector);
  for (int k = 0; k < 3 && size > 0; k++)
    vector[k] /= size;
}

double bwi_opening(const double a[3], const double b[3], const double normal1[3],
                   const double normal2[3], double inward[3]) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, n1[3], n2[3], cross[3], side1[3], side2[3];
  double size = bw_norm(d);
  for (int k = 0; k < 3; k++)
    d[k] = size > 0 ? d[k] / size : 0;
  memcpy(n1, normal1, sizeof n1);
  memcpy(n2, normal2, sizeof n2);
  without(n1, d);
  without(n2, d);
  bw_cross(n1, n2, cross);
  double angle = 3.14159265358979323846 - atan2(bw_dot(cross, d), bw_dot(n1, n2));
  bw_cross(n1, d, side1); /* along the facets, away from the edge */
  bw_cross(d, n2, side2);
  for (int k = 0; k < 3; k++)
    inward[k] = cos(angle / 2) * (side1[k] + side2[k]) - sin(angle / 2) * (n1[k] + n2[k]);
  size = bw_norm(inward);
  for (int k = 0; k < 3; k++)
    inward[k] = size > 0 ? inward[k] / size : 0;
  return angle;
}

/* ---- polylines ------------------------------------------------------------------------------- */

static int compare_keys(const bwi_seam *x, const bwi_seam *y) {
  for (int k = 0; k < 3; k++)
    if (x->key[k] != y->key[k])
      return x->key[k] < y->key[k] ? -1 : 1;
  return 0;
}

static int by_key(const void *a, const void *b) {
  const bwi_seam *x = (const bwi_seam *)a, *y = (const bwi_seam *)b;
  int order = compare_keys(x, y);
  return order != 0 ? order : (x->number > y->number) - (x->number < y->number);
}

/* Half h of seam s = h / 2 begins at end[h % 2]. The halves at a point are a list. */
typedef struct chainer {
  bw_context *context;
  bw_singular_places *places;
  const bwi_seam *seam;
  const double *at;
  bw_singular_place made; /* kind; the rest is set for each polyline */
  bw_corner corner;
  double poisson;
  int64_t *head, *next; /* per point; per half */
  int32_t *degree;
  uint8_t *used;          /* per seam */
  double *point, *inward; /* of the polyline */
} chainer;

static void append(chainer *c, int32_t row, int32_t point, const bwi_seam *seam, double length) {
  memcpy(c->point + 3 * (size_t)row, c->at + 3 * (size_t)point, 3 * sizeof(double));
  for (int k = 0; k < 3; k++)
    c->inward[3 * (size_t)row + (size_t)k] += length * seam->inward[k];
}

/* Follow unused seams from a half on. */
static bw_status follow(chainer *c, int64_t half) {
  bw_singular_place place = c->made;
  int32_t rows = 1;
  place.min_angle = HUGE_VAL;
  memset(c->inward, 0, 3 * sizeof(double));
  while (half >= 0) {
    const bwi_seam *seam = &c->seam[half / 2];
    int32_t from = seam->end[half % 2], to = seam->end[1 - half % 2];
    const double *a = c->at + 3 * (size_t)from, *b = c->at + 3 * (size_t)to;
    double edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, length = bw_norm(edge);
    c->used[half / 2] = 1;
    append(c, rows - 1, from, seam, length);
    memset(c->inward + 3 * (size_t)rows, 0, 3 * sizeof(double));
    append(c, rows++, to, seam, length);
    place.length += length;
    place.angle += length * seam->angle;
    place.min_angle = fmin(place.min_angle, seam->angle);
    place.largest_angle = fmax(place.largest_angle, seam->angle);
    half = -1;
    for (int64_t h = c->head[to]; h >= 0 && c->degree[to] == 2; h = c->next[h])
      if (!c->used[h / 2])
        half = h;
  }
  place.angle = place.length > 0 ? place.angle / place.length : place.min_angle;
  bool line = place.kind == BW_SINGULAR_LINE_LOAD || place.kind == BW_SINGULAR_LINE_SUPPORT;
  place.exponent = line ? 0 : bw_williams_exponent(c->corner, place.angle, c->poisson);
  if (!(place.exponent < 1))
    return BW_OK;
  for (int32_t i = 0; i < rows; i++) {
    double *inward = c->inward + 3 * (size_t)i, size = bw_norm(inward);
    for (int k = 0; k < 3; k++)
      inward[k] = size > 0 ? inward[k] / size : 0;
  }
  return bwi_singular_add(c->context, c->places, &place, rows, c->point, c->inward);
}

/* The seams of like keys from `begin` to `end`. */
static bw_status chain_group(chainer *c, size_t begin, size_t end) {
  bw_status status = BW_OK;
  for (size_t s = begin; s < end; s++)
    for (int k = 0; k < 2; k++) {
      int32_t p = c->seam[s].end[k];
      c->next[2 * s + (size_t)k] = c->head[p];
      c->head[p] = 2 * (int64_t)s + k;
      c->degree[p]++;
    }
  for (int ring = 0; ring < 2; ring++) /* what is left after the open ones are rings */
    for (size_t s = begin; s < end; s++)
      for (int k = 0; k < 2 && status == BW_OK; k++)
        if (!c->used[s] && (ring || c->degree[c->seam[s].end[k]] != 2))
          status = follow(c, 2 * (int64_t)s + k);
  for (size_t s = begin; s < end; s++)
    for (int k = 0; k < 2; k++) {
      c->head[c->seam[s].end[k]] = -1;
      c->degree[c->seam[s].end[k]] = 0;
    }
  return status;
}

bw_status bwi_singular_chain(bw_context *context, bw_singular_places *places, bwi_seams *seams,
                             int32_t point_count, const double *point, bw_singular_kind kind,
                             bw_corner corner, double poisson) {
  bw_status status = BW_OK;
  const size_t count = seams->count;
  chainer c = {.context = context,
               .places = places,
               .seam = seams->seam,
               .at = point,
               .made = {.kind = kind},
               .corner = corner,
               .poisson = poisson};
  if (count == 0)
    return BW_OK;
  qsort(seams->seam, count, sizeof *seams->seam, by_key);
  c.head = BW_NEW(context, int64_t, point_count);
  c.next = BW_NEW(context, int64_t, 2 * count);
  c.degree = BW_NEW0(context, int32_t, point_count);
  c.used = BW_NEW0(context, uint8_t, count);
  c.point = BW_NEW(context, double, 3 * (count + 1));
  c.inward = BW_NEW(context, double, 3 * (count + 1));
  BW_TRY_MEMORY(c.head && c.next && c.degree && c.used && c.point && c.inward);
  memset(c.head, -1, (size_t)point_count * sizeof *c.head);
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count; end++)
      if (compare_keys(&seams->seam[begin], &seams->seam[end]) != 0)
        break;
    BW_TRY(chain_group(&c, begin, end));
  }
done:
  bw_free(c.head);
  bw_free(c.next);
  bw_free(c.degree);
  bw_free(c.used);
  bw_free(c.point);
  bw_free(c.inward);
  return status;
}
