/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines of the tests, put together loop by loop. */
#ifndef OUTLINE_SHAPES_H
#define OUTLINE_SHAPES_H

#include "check.h"

enum { DRAFT_POINTS = 4000, DRAFT_LOOPS = 50 };
typedef struct draft {
  int32_t points, segments, loops, tags;
  double point[2 * DRAFT_POINTS];
  bw_segment segment[DRAFT_POINTS];
  bw_loop loop[DRAFT_LOOPS];
  bw_name tag[8];
} draft;

static inline int32_t draft_point(draft *d, double x, double y) {
  assert_true(d->points < DRAFT_POINTS);
  d->point[2 * d->points] = x;
  d->point[2 * d->points + 1] = y;
  return d->points++;
}

static inline bw_loop *draft_loop(draft *d, const char *name, int32_t region, int32_t count) {
  assert_true(d->loops < DRAFT_LOOPS);
  bw_loop *loop = &d->loop[d->loops++];
  *loop = (bw_loop){.first = d->segments, .count = count, .region = region, .parent = -7};
  strncpy(loop->name.text, name, BW_NAME - 1);
  d->segments += count;
  return loop;
}

static inline void draft_polygon(draft *d, const char *name, int32_t region, int32_t count,
                                 const double *xy) {
  bw_loop *loop = draft_loop(d, name, region, count);
  int32_t first = d->points;
  for (int32_t i = 0; i < count; i++) {
    draft_point(d, xy[2 * i], xy[2 * i + 1]);
    d->segment[loop->first + i] = (bw_segment){{first + i, -1, -1, first + (i + 1) % count}, 0};
  }
}

static inline void draft_rectangle(draft *d, const char *name, int32_t region, double x0, double y0,
                                   double x1, double y1) {
  draft_polygon(d, name, region, 4, (double[]){x0, y0, x1, y0, x1, y1, x0, y1});
}

/* Cubics: three points each (start, two controls). */
static inline void draft_cubics(draft *d, const char *name, int32_t region, int32_t count,
                                const double *xy) {
  bw_loop *loop = draft_loop(d, name, region, count);
  int32_t first = d->points;
  for (int32_t i = 0; i < 3 * count; i++)
    draft_point(d, xy[2 * i], xy[2 * i + 1]);
  for (int32_t i = 0; i < count; i++)
    d->segment[loop->first + i] = (bw_segment){
        {first + 3 * i, first + 3 * i + 1, first + 3 * i + 2, first + 3 * ((i + 1) % count)}, 0};
}

static inline void draft_circle(draft *d, const char *name, int32_t region, double x, double y,
                                double r) {
  const double k = 0.5522847498307936 * r;
  draft_cubics(d, name, region, 4,
               (double[]){x + r, y,     x + r, y + k, x + k, y + r, x,     y + r,
                          x - k, y + r, x - r, y + k, x - r, y,     x - r, y - k,
                          x - k, y - r, x,     y - r, x + k, y - r, x + r, y - k});
}

static inline bw_status draft_try(bw_context *context, const draft *d, bw_outline **outline) {
  return bw_outline_create(context, d->points, d->point, d->segments, d->segment, d->loops, d->loop,
                           d->tags, d->tag, outline);
}

static inline bw_outline *draft_make(bw_context *context, const draft *d) {
  bw_outline *outline = NULL;
  check_ok(context, draft_try(context, d, &outline));
  return outline;
}

/* What every outline promises. */
static inline void check_outline(bw_context *context, const bw_outline *o) {
  uint8_t *used = calloc((size_t)o->point_count, 1);
  int32_t end = 0;
  for (int32_t l = 0; l < o->loop_count; l++) {
    const bw_loop *loop = &o->loop[l];
    assert_int_equal(loop->first, end);
    end += loop->count;
    assert_true(loop->name.text[0]);
    assert_int_equal(bw_outline_find_loop(o, loop->name.text), l);
    assert_true(loop->parent >= -1 && loop->parent < o->loop_count && loop->parent != l);
    assert_true(loop->region < o->region_count);
    if (loop->region < 0)
      assert_true(loop->parent >= 0 && o->loop[loop->parent].region >= 0);
    double area = 0;
    for (int32_t i = 0; i < loop->count; i++) {
      const bw_segment *s = &o->segment[loop->first + i];
      assert_int_equal(s->point[3], o->segment[loop->first + (i + 1) % loop->count].point[0]);
      assert_false(used[s->point[0]]++);
      for (int k = 1; k < 3 && s->point[1] >= 0; k++)
        assert_false(used[s->point[k]]++);
      assert_true(s->tag >= 0 && s->tag < o->tag_count);
      for (int k = 0; k < 1000; k++) { /* the midpoint rule tells the direction */
        double at[2], derivative[2];
        bw_outline_evaluate(o, loop->first + i, (k + 0.5) / 1000, at, derivative, NULL);
        area += (at[0] * derivative[1] - at[1] * derivative[0]) / 2000;
      }
    }
    assert_true(loop->region >= 0 ? area > 0 : area < 0);
  }
  assert_int_equal(end, o->segment_count);
  for (int32_t p = 0; p < o->point_count; p++)
    assert_true(used[p]);
  for (int32_t t = 0; t < o->tag_count; t++)
    assert_int_equal(bw_outline_find_tag(o, o->tag[t].text), t);
  free(used);
  (void)context;
}

#endif
