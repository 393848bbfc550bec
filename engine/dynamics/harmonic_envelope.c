/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Largest displacement and von Mises stress of a harmonic response over frequencies. Fields are
 * linear in the coordinates of vectors. So each vector has its field once, as vectors whose length
 * is wanted, and products of matrices combine them for many frequencies. */
#include <math.h>
#include <string.h>

#include "barwright/analysis.h"
#include "dynamics/internal.h"
#include "linear/blas.h"

/* Points of one task; frequencies of one product. The products of a task stay in the cache. */
enum { POINTS = 64, TOGETHER = 48 };

/* What is as long as von Mises stress is large, in the place of the stress. */
static void mises_components(double s[6]) {
  double difference[3] = {s[0] - s[1], s[1] - s[2], s[2] - s[0]};
  for (int c = 0; c < 3; c++) {
    s[c] = difference[c] * sqrt(0.5);
    s[3 + c] *= sqrt(3.0);
  }
}

/* The fields of all vectors, h->count x points->count x width. */
static bw_status basis_fields(bw_context *context, const bw_harmonic *h, bw_harmonic_field what,
                              const bw_stress_points *points, int width, double *field) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = h->model->mesh;
  int64_t size = (int64_t)points->count * width;
  for (int k = 0; k < h->count; k++) {
    double *own = field + k * size;
    const double *u = bwi_harmonic_vector(h, k);
    BW_TRY(bw_check_cancel(context));
    if (what == BW_HARMONIC_DISPLACEMENT) {
      memcpy(own, u, (size_t)size * sizeof *own);
      continue;
    }
    BW_TRY(bw_point_stress(context, mesh, h->model->material, u, points, own));
    for (int64_t i = 0; i < points->count; i++)
      mises_components(own + 6 * i);
    bw_progress(context, "stresses of vectors", (double)(k + 1) / h->count);
  }
done:
  return status;
}

typedef struct largest {
  double value;
  int32_t where; /* a point, or a frequency */
} largest;

/* Frequencies `first` to first + n - 1 of all points. */
typedef struct envelope {
  const double *field;
  int vectors, width;
  int64_t points;
  const double *coordinate; /* (vectors x 2n) of columns: the real parts, then the imaginary ones */
  int first, n;
  largest *of_point;     /* (points) over the frequencies so far */
  largest *of_frequency; /* (tasks x n) over the points of a task */
} envelope;

/* The squared length of a cos t - b sin t, where it is largest. */
static double longest(int width, const double *a, const double *b) {
  double aa = 0, bb = 0, ab = 0;
  for (int c = 0; c < width; c++) {
    aa += a[c] * a[c];
    bb += b[c] * b[c];
    ab += a[c] * b[c];
  }
  return (aa + bb) / 2 + hypot((aa - bb) / 2, ab);
}

static bw_status take_points(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  bw_status status = BW_OK;
  const envelope *e = data;
  int width = e->width, rows = (int)(end - begin) * width, columns = 2 * e->n;
  const double one = 1, zero = 0;
  largest *of_frequency = e->of_frequency + begin / POINTS * e->n;
  double *own = BW_NEW(NULL, double, (int64_t)rows * e->vectors);
  double *product = BW_NEW(NULL, double, (int64_t)rows *columns);
  BW_TRY_MEMORY(own && product);
  for (int k = 0; k < e->vectors; k++)
    memcpy(own + (size_t)k * (size_t)rows, e->field + (k * e->points + begin) * width,
           (size_t)rows * sizeof *own);
  dgemm_("N", "N", &rows, &columns, &e->vectors, &one, own, &rows, e->coordinate, &e->vectors,
         &zero, product, &rows);
  for (int f = 0; f < e->n; f++) {
    const double *a = product + (size_t)f * (size_t)rows, *b = a + (size_t)e->n * (size_t)rows;
    of_frequency[f] = (largest){-1, 0};
    for (int64_t i = begin; i < end; i++, a += width, b += width) {
      double square = longest(width, a, b);
      if (square > of_frequency[f].value)
        of_frequency[f] = (largest){square, (int32_t)i};
      if (square > e->of_point[i].value)
        e->of_point[i] = (largest){square, e->first + f};
    }
  }
done:
  bw_free(own);
  bw_free(product);
  return status;
}

/* The coordinates of n frequencies as columns. */
static bw_status take_coordinates(bw_context *context, const bw_harmonic *h, int n,
                                  const double *frequency, double *q, double *coordinate) {
  for (int f = 0; f < n; f++) {
    bw_status status = bw_harmonic_coordinates(context, h, frequency[f], q, NULL);
    if (status != BW_OK)
      return status;
    for (int k = 0; k < h->count; k++) {
      coordinate[f * h->count + k] = q[2 * k];
      coordinate[(n + f) * h->count + k] = q[2 * k + 1];
    }
  }
  return BW_OK;
}

/* Over all frequencies: those of a product at a time. */
static bw_status take_frequencies(bw_context *context, const bw_harmonic *h, envelope *e,
                                  const bw_stress_points *points, int count,
                                  const double *frequency, double *peak, int32_t *node) {
  bw_status status = BW_OK;
  int64_t tasks = (e->points + POINTS - 1) / POINTS;
  double *q = BW_NEW(context, double, 2 * (int64_t)h->count + 1);
  double *coordinate = BW_NEW(context, double, 2 * (int64_t)TOGETHER * h->count + 1);
  e->of_frequency = BW_NEW(context, largest, tasks * TOGETHER);
  BW_TRY_MEMORY(q && coordinate && e->of_frequency);
  e->coordinate = coordinate;
  for (e->first = 0; e->first < count; e->first += e->n) {
    e->n = count - e->first < TOGETHER ? count - e->first : TOGETHER;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(take_coordinates(context, h, e->n, frequency + e->first, q, coordinate));
    BW_TRY(bw_parallel(context, e->points, POINTS, take_points, e));
    for (int f = 0; f < e->n; f++) {
      largest most = {-1, 0};
      for (int64_t task = 0; task < tasks; task++) {
        largest own = e->of_frequency[task * e->n + f];
        most = own.value > most.value ? own : most;
      }
      if (peak)
        peak[e->first + f] = sqrt(most.value);
      if (node)
        node[e->first + f] = bw_stress_point_node(points, most.where);
    }
    bw_progress(context, "frequencies", (double)(e->first + e->n) / count);
  }
done:
  bw_free(q);
  bw_free(coordinate);
  bw_free(e->of_frequency);
  e->of_frequency = NULL;
  return status;
}

bw_status bw_harmonic_envelope(bw_context *context, const bw_harmonic *h, bw_harmonic_field what,
                               int count, const double *frequency, double *value, double *at,
                               double *peak, int32_t *node) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = h->model->mesh;
  bw_stress_points points = {.count = mesh->node_count};
  double *field = NULL;
  envelope e = {.vectors = h->count, .width = what == BW_HARMONIC_DISPLACEMENT ? 3 : 6};
  bwi_blas_enter();
  if (count < 1)
    BW_TRY(bw_fail(context, BW_INVALID, "an envelope needs at least 1 frequency, got %d", count));
  if (what == BW_HARMONIC_VON_MISES)
    BW_TRY(bw_stress_points_create(context, mesh, h->model->material, &points));
  e.points = points.count;
  field = BW_NEW(context, double, h->count *e.points *e.width + 1);
  e.of_point = BW_NEW(context, largest, e.points);
  BW_TRY_MEMORY(field && e.of_point);
  e.field = field;
  for (int64_t i = 0; i < e.points; i++)
    e.of_point[i] = (largest){-1, 0};
  BW_TRY(basis_fields(context, h, what, &points, e.width, field));
  BW_TRY(take_frequencies(context, h, &e, &points, count, frequency, peak, node));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    largest most = e.of_point[i];
    for (int32_t k = points.point ? points.point[i].next : -1; k >= 0; k = points.point[k].next)
      most = e.of_point[k].value > most.value ? e.of_point[k] : most;
    if (value)
      value[i] = sqrt(most.value);
    if (at)
      at[i] = frequency[most.where];
  }
done:
  bwi_blas_leave();
  bw_stress_points_clear(&points);
  bw_free(field);
  bw_free(e.of_point);
  return status;
}
