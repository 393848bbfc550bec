/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodes along the outline.
 *
 * The wanted length h along a loop is the least of the size field, of the length in which the curve
 * turns by the angle allowed, and of the length of the segment. It is graded: h may grow by GRADING
 * per unit of length. A segment then gets n = integral of ds / h nodes (rounded), equally spaced in
 * that integral, so that neighbours differ little in length wherever h does. */
#include "plane/fill_internal.h"

#include <math.h>
#include <string.h>

static const double GRADING = 0.3;
/* A curve that turns on the spot (a cusp) is not followed below this part of the wanted size. */
static const double SMALLEST_TURN = 0.02;
enum { MAX_SAMPLES = 2048 };
static const double COARSE = 2;

/* ---- the size field ------------------------------------------------------------------------ */

double bwi_plane_size_at(bwi_plane_size_field *field, double x, double y) {
  if (!field->function || field->failed)
    return field->size;
  double at[2] = {x, y}, value = field->function(field->data, at);
  if (!(value > 0)) {
    field->failed = true;
    field->at[0] = x;
    field->at[1] = y;
    field->value = value;
    return field->size;
  }
  return fmin(value, field->size);
}

bw_status bwi_size_check(bw_context *context, const bwi_plane_size_field *field) {
  if (!field->failed)
    return BW_OK;
  bw_fail(context, BW_INVALID,
          "the size field gives %g at (%g, %g): an edge length above 0 is needed everywhere",
          field->value, field->at[0], field->at[1]);
  bw_detail_number(context, "x", field->at[0]);
  bw_detail_number(context, "y", field->at[1]);
  return BW_INVALID;
}

/* ---- samples along a loop ------------------------------------------------------------------ */

typedef struct sample {
  double t, step; /* parameter; length to the next sample */
  double h;
} sample;

/* Samples of a segment in equal steps of the parameter; the last one, t = 1, is the first of the
 * next segment and not kept. */
static void sample_segment(const bw_outline *outline, int32_t s, bwi_plane_size_field *field,
                           double turn, int count, sample *list) {
  bool curved = outline->segment[s].point[1] >= 0;
  double before[2], at[2], d[2], dd[2], length = 0;
  bw_outline_evaluate(outline, s, 0, before, NULL, NULL);
  for (int i = 0; i < count; i++) {
    sample *p = &list[i];
    p->t = (double)i / count;
    bw_outline_evaluate(outline, s, p->t, at, d, dd);
    p->h = bwi_plane_size_at(field, at[0], at[1]);
    if (curved) {
      double speed = hypot(d[0], d[1]), bend = fabs(d[0] * dd[1] - d[1] * dd[0]);
      double allowed = bend > 0 ? turn * speed * speed * speed / bend : INFINITY;
      p->h = fmin(p->h, fmax(allowed, SMALLEST_TURN * p->h));
    }
    bw_outline_evaluate(outline, s, (double)(i + 1) / count, at, NULL, NULL);
    p->step = hypot(at[0] - before[0], at[1] - before[1]);
    length += p->step;
    memcpy(before, at, sizeof at);
  }
  for (int i = 0; i < count; i++)
    list[i].h = fmin(list[i].h, length);
}

static int samples_of(const bw_outline *outline, int32_t s, double size) {
  bw_segment segment = outline->segment[s];
  bool curved = segment.point[1] >= 0;
  double length = 0;
  const double *p = outline->point + 2 * (size_t)segment.point[0];
  for (int i = 1; i < 4; i++) {
    if (segment.point[i] < 0)
      continue;
    const double *q = outline->point + 2 * (size_t)segment.point[i];
    length += hypot(q[0] - p[0], q[1] - p[1]);
    p = q;
  }
  double wanted = 4 * length / size;
  double min = curved ? 48 : 8;
  return (int)fmin(fmax(ceil(wanted), min), MAX_SAMPLES);
}

/* Both ways around the loop, twice, so that what begins anywhere gets everywhere. */
static void grade(sample *list, int64_t count) {
  for (int64_t i = 0; i < 2 * count; i++) {
    sample *a = &list[i % count], *b = &list[(i + 1) % count];
    b->h = fmin(b->h, a->h + GRADING * a->step);
  }
  for (int64_t i = 2 * count; i-- > 0;) {
    sample *a = &list[i % count], *b = &list[(i + 1) % count];
    a->h = fmin(a->h, b->h + GRADING * a->step);
  }
}

/* Integral of ds / h over one step: by the trapezoidal rule, which is right to 6 percent up to
 * COARSE. Where no number of samples resolves how h grows (a detail of a much larger drawing), h is
 * linear in between, and its integral a logarithm. */
static double load_of(const sample *a, const sample *b) {
  double low = fmin(a->h, b->h), high = fmax(a->h, b->h);
  if (high <= COARSE * low)
    return a->step * 0.5 * (1 / a->h + 1 / b->h);
  return a->step * log(high / low) / (high - low);
}

/* The part of a step, by length, that holds this part of its load. */
static double part_of(const sample *a, const sample *b, double part) {
  double ratio = b->h / a->h;
  if (ratio <= COARSE && ratio >= 1 / COARSE)
    return part;
  return (pow(ratio, part) - 1) / (ratio - 1);
}

static bw_status add_node(bw_context *context, bwi_fill_boundary *boundary, size_t capacity[3],
                          const bw_outline *outline, int32_t s, double t) {
  size_t count = (size_t)boundary->count;
  if (!bw_grow(context, (void **)&boundary->point, &capacity[0], count, 1, 2 * sizeof(double)) ||
      !bw_grow(context, (void **)&boundary->segment, &capacity[1], count, 1, sizeof(int32_t)) ||
      !bw_grow(context, (void **)&boundary->parameter, &capacity[2], count, 1, sizeof(double)))
    return BW_MEMORY;
  bw_outline_evaluate(outline, s, t, boundary->point + 2 * count, NULL, NULL);
  boundary->segment[count] = s;
  boundary->parameter[count] = t;
  boundary->count++;
  return BW_OK;
}

static bw_status too_many(bw_context *context, const bw_outline *outline, int32_t s, double nodes,
                          int64_t limit) {
  const double *at = outline->point + 2 * (size_t)outline->segment[s].point[0];
  bw_fail(
      context, BW_LIMIT,
      "the wanted size puts %.3g nodes on the outline up to segment %d, which begins at (%g, %g); "
      "between them are more elements than the limit of %lld: give a larger size, or raise the "
      "limit",
      nodes, (int)s + 1, at[0], at[1], (long long)limit);
  bw_detail_text(context, "limit", "elements");
  bw_detail_number(context, "x", at[0]);
  bw_detail_number(context, "y", at[1]);
  return BW_LIMIT;
}

bw_status bwi_fill_boundary_create(bw_context *context, const bw_outline *outline,
                                   bwi_plane_size_field *field, double turn, int64_t limit,
                                   bwi_fill_boundary *boundary) {
  bw_status status = BW_OK;
  sample *list = NULL;
  size_t list_capacity = 0, capacity[3] = {0, 0, 0};
  int64_t *start = BW_NEW(context, int64_t, (size_t)outline->segment_count + 1);
  /* a polygon of n corners is cut into n - 2 triangles at least, and more around holes */
  double max = fmin((double)limit + 2.0 * outline->loop_count, INT32_MAX / 8);
  memset(boundary, 0, sizeof *boundary);
  boundary->loop_start = BW_NEW0(context, int32_t, (size_t)outline->loop_count + 1);
  BW_TRY_MEMORY(start && boundary->loop_start);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    int64_t count = 0;
    for (int32_t k = 0; k < loop->count; k++) {
      int32_t s = loop->first + k;
      int samples = samples_of(outline, s, field->size);
      for (;;) {
        BW_TRY_MEMORY(bw_grow(context, (void **)&list, &list_capacity, (size_t)count,
                              (size_t)samples, sizeof *list));
        sample_segment(outline, s, field, turn, samples, list + count);
        double nodes = 0;
        for (int i = 0; i < samples; i++)
          nodes += list[count + i].step / list[count + i].h;
        if (samples >= MAX_SAMPLES || samples >= 2 * nodes)
          break;
        samples = (int)fmin(fmax(4 * nodes, samples + 1), MAX_SAMPLES);
      }
      start[k] = count;
      count += samples;
    }
    start[loop->count] = count;
    BW_TRY(bwi_size_check(context, field));
    grade(list, count);
    /* a loop of one or two segments needs nodes inside of them to enclose anything */
    int min = loop->count == 1 ? 4 : loop->count == 2 ? 2 : 1;
    for (int32_t k = 0; k < loop->count; k++) {
      double load = 0, passed = 0;
      for (int64_t i = start[k]; i < start[k + 1]; i++)
        load += load_of(&list[i], &list[(i + 1) % count]);
      double rounded = fmax(ceil(load - 0.25), min);
      if (!(boundary->count + rounded <= max)) {
        status = too_many(context, outline, loop->first + k, boundary->count + rounded, limit);
        goto done;
      }
      int32_t n = (int32_t)rounded, next = 1;
      BW_TRY(add_node(context, boundary, capacity, outline, loop->first + k, 0));
      for (int64_t i = start[k]; i < start[k + 1] && next < n; i++) {
        double here = load_of(&list[i], &list[(i + 1) % count]);
        double end = i + 1 < start[k + 1] ? list[i + 1].t : 1;
        for (; next < n && load * next / n <= passed + here; next++) {
          double part = here > 0 ? (load * next / n - passed) / here : 0;
          part = part_of(&list[i], &list[(i + 1) % count], fmin(fmax(part, 0), 1));
          double t = list[i].t + (end - list[i].t) * part;
          if (t > 0 && t < 1)
            BW_TRY(add_node(context, boundary, capacity, outline, loop->first + k, t));
        }
        passed += here;
      }
    }
    boundary->loop_start[l + 1] = boundary->count;
    BW_TRY(bw_check_cancel(context));
  }
done:
  bw_free(list);
  bw_free(start);
  if (status != BW_OK)
    bwi_fill_boundary_clear(boundary);
  return status;
}

void bwi_fill_boundary_clear(bwi_fill_boundary *boundary) {
  bw_free(boundary->point);
  bw_free(boundary->segment);
  bw_free(boundary->parameter);
  bw_free(boundary->loop_start);
  memset(boundary, 0, sizeof *boundary);
}
