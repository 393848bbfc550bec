/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Measures against closed forms; the area's gradient against differences. */
#include "outline/internal.h"
#include "shapes.h"

static bw_outline_measures measure(bw_context *context, const bw_outline *o, int32_t region) {
  bw_outline_measures m;
  check_ok(context, bw_outline_measure(context, o, region, &m));
  return m;
}

static void a_rectangle_with_a_hole(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  /* far from the origin, so that cancellation would show */
  double x = 1000, y = -500;
  draft_rectangle(&d, "body", 0, x, y, x + 6, y + 4);
  draft_rectangle(&d, "hole", -1, x + 1, y + 1, x + 3, y + 2);
  bw_outline *o = draft_make(context, &d);
  bw_outline_measures m = measure(context, o, -1);
  check_near(m.area, 22, 1e-11);
  check_near(m.perimeter, 26, 1e-11);
  double cx = (24 * 3 - 2 * 2) / 22.0, cy = (24 * 2 - 2 * 1.5) / 22.0;
  check_near(m.centroid[0], x + cx, 1e-11);
  check_near(m.centroid[1], y + cy, 1e-11);
  double xx = 6 * 64 / 12.0 + 24 * (2 - cy) * (2 - cy) - 2 / 12.0 - 2 * (1.5 - cy) * (1.5 - cy);
  double yy = 4 * 216 / 12.0 + 24 * (3 - cx) * (3 - cx) - 8 / 12.0 - 2 * (2 - cx) * (2 - cx);
  double xy = 24 * (3 - cx) * (2 - cy) - 2 * (2 - cx) * (1.5 - cy);
  check_near(m.second_moment[0], xx, 1e-10);
  check_near(m.second_moment[1], yy, 1e-10);
  check_near(m.second_moment[2], xy, 1e-10);
  check_near(m.min[0], x, 0);
  check_near(m.max[1], y + 4, 0);
  bw_release(o);
}

/* Between y = x^2 and y = 1. */
static void a_segment_of_a_parabola(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  bw_loop *loop = draft_loop(&d, "bowl", 0, 2);
  draft_point(&d, -1, 1);
  draft_point(&d, -1 / 3.0, -1 / 3.0);
  draft_point(&d, 1 / 3.0, -1 / 3.0);
  draft_point(&d, 1, 1);
  d.segment[0] = (bw_segment){{0, 1, 2, 3}, 0};
  d.segment[1] = (bw_segment){{3, -1, -1, 0}, 0};
  assert_int_equal(loop->first, 0);
  bw_outline *o = draft_make(context, &d);
  bw_outline_measures m = measure(context, o, 0);
  check_near(m.area, 4 / 3.0, 1e-15);
  check_near(m.centroid[0], 0, 1e-15);
  check_near(m.centroid[1], 0.6, 1e-15);
  check_near(m.second_moment[0], 4 / 7.0 - 4 / 3.0 * 0.36, 1e-15);
  check_near(m.second_moment[1], 4 / 15.0, 1e-15);
  check_near(m.second_moment[2], 0, 1e-15);
  check_near(m.perimeter, sqrt(5) + asinh(2) / 2 + 2, 1e-13);
  check_near(m.min[1], 0, 1e-15);
  double at[2], first[2], second[2], basis[4];
  bw_outline_evaluate(o, 0, 0.75, at, first, second); /* x = 2 t - 1 */
  check_near(at[0], 0.5, 1e-15);
  check_near(at[1], 0.25, 1e-15);
  check_near(first[0], 2, 1e-15);
  check_near(first[1], 2, 1e-15);
  check_near(second[1], 8, 1e-14);
  bw_outline_basis(o, 0, 0.75, basis);
  check_near(basis[0] + basis[1] + basis[2] + basis[3], 1, 1e-15);
  check_near(-basis[0] - basis[1] / 3 + basis[2] / 3 + basis[3], 0.5, 1e-15);
  bw_outline_evaluate(o, 1, 0.75, at, first, second);
  check_near(at[0], -0.5, 1e-15);
  check_near(first[0], -2, 1e-15);
  check_near(second[0], 0, 0);
  bw_outline_basis(o, 1, 0.75, basis);
  check_near(basis[0], 0.25, 0);
  check_near(basis[1] + basis[2], 0, 0);
  bw_release(o);
}

/* An island in a hole, a region in a region. */
static void regions_are_measured_apart(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  draft_rectangle(&d, "body", 0, 0, 0, 10, 10);
  draft_rectangle(&d, "hole", -1, 1, 1, 4, 4);
  draft_rectangle(&d, "island", 0, 2, 2, 3, 3);
  draft_rectangle(&d, "steel", 1, 5, 5, 9, 9);
  draft_rectangle(&d, "bore", -1, 6, 6, 7, 7);
  draft_rectangle(&d, "seam", 0, 5, 1, 6, 2); /* of the same region as what is around */
  bw_outline *o = draft_make(context, &d);
  check_near(measure(context, o, -1).area, 100 - 9 + 1 - 1, 1e-12);
  check_near(measure(context, o, -1).perimeter, 40 + 12 + 4 + 4, 1e-12);
  check_near(measure(context, o, 0).area, 100 - 9 + 1 - 16, 1e-12);
  check_near(measure(context, o, 0).perimeter, 40 + 12 + 4 + 16, 1e-12);
  check_near(measure(context, o, 1).area, 15, 1e-12);
  check_near(measure(context, o, 1).perimeter, 20, 1e-12);
  check_near(measure(context, o, 1).min[0], 5, 0);
  bw_outline_measures m;
  check_fails(context, BW_INVALID, "region 3", bw_outline_measure(context, o, 2, &m));
  bw_release(o);
}

static void a_circle_is_nearly_round(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  draft_circle(&d, "disc", 0, 3, 4, 2);
  bw_outline *o = draft_make(context, &d);
  bw_outline_measures m = measure(context, o, -1);
  const double pi = acos(-1);
  check_near(m.area, 4 * pi, 4 * pi * 4e-4); /* four cubics */
  check_near(m.perimeter, 4 * pi, 4 * pi * 2e-4);
  check_near(m.second_moment[0], 4 * pi, 4 * pi * 8e-4);
  check_near(m.second_moment[0], m.second_moment[1], 1e-12);
  check_near(bwi_loop_area(o->point, &o->loop[0], o->segment), m.area, 1e-13);
  check_near(m.centroid[0], 3, 1e-13);
  bw_release(o);
}

/* The area is of second degree in the points: central differences are exact. */
static void the_gradient_of_the_area(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  draft_circle(&d, "body", 0, 0, 0, 2);
  draft_rectangle(&d, "hole", -1, -1, -1, 1, 1);
  draft_circle(&d, "island", 0, 0, 0, 0.5);
  draft_circle(&d, "inlay", 1, 1.4, 0, 0.2);
  bw_outline *o = draft_make(context, &d);
  double gradient[80], point[80];
  check_ok(context, bw_outline_area_gradient(context, o, gradient));
  for (int i = 0; i < 2 * o->point_count; i++) {
    double area[2];
    for (int k = 0; k < 2; k++) {
      bw_outline *moved = NULL;
      memcpy(point, o->point, 2 * (size_t)o->point_count * sizeof *point);
      point[i] += k ? 0.01 : -0.01;
      check_ok(context, bw_outline_moved(context, o, point, &moved));
      area[k] = measure(context, moved, -1).area;
      bw_release(moved);
    }
    check_near(gradient[i], (area[1] - area[0]) / 0.02, 1e-11);
  }
  bw_release(o);
}

check_main(check_test(a_rectangle_with_a_hole), check_test(a_segment_of_a_parabola),
           check_test(regions_are_measured_apart), check_test(a_circle_is_nearly_round),
           check_test(the_gradient_of_the_area))
