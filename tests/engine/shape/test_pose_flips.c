/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Edge flips in flat parts: slivers disappear, the shape and what may not be flipped stay. */
#include "check.h"
#include "shape/pose_flips.h"

enum { COUNT = 40, TRIANGLES = 2 * COUNT };

static bool always(void *data, int32_t a, int32_t b, int32_t c, int32_t d) {
  (void)a, (void)b, (void)c, (void)d;
  ++*(int *)data;
  return true;
}

static bool never(void *data, int32_t a, int32_t b, int32_t c, int32_t d) {
  (void)data, (void)a, (void)b, (void)c, (void)d;
  return false;
}

/* A strip of two rows of points, the upper one bent by `lift`, whose triangles all reach to its
 * first or its last point. */
static void make_strip(double lift, double *point, int32_t *triangle) {
  for (int i = 0; i <= COUNT; i++)
    for (int row = 0; row < 2; row++) {
      double *p = point + 3 * (2 * i + row);
      p[0] = i;
      p[1] = row;
      p[2] = row ? lift * i * i : 0;
    }
  for (int i = 0; i < COUNT; i++) {
    memcpy(triangle + 3 * i, (int32_t[3]){2 * i, 2 * i + 2, 1}, 3 * sizeof *triangle);
    memcpy(triangle + 3 * (COUNT + i), (int32_t[3]){2 * i + 3, 2 * i + 1, 2 * COUNT},
           3 * sizeof *triangle);
  }
}

static double area_of(const double *point, const int32_t *t) {
  const double *a = point + 3 * t[0], *b = point + 3 * t[1], *c = point + 3 * t[2];
  return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

static void test_strip(void **state) {
  bw_context *context = check_context(state);
  double point[3 * (2 * COUNT + 2)], sum = 0;
  int32_t triangle[3 * TRIANGLES], group[TRIANGLES] = {0};
  uint8_t fresh[TRIANGLES];
  int asked = 0;
  make_strip(0, point, triangle);
  memset(fresh, 1, sizeof fresh);
  check_ok(context, bwi_flip_flat_edges(context, point, TRIANGLES, triangle, group, fresh, 1e-9,
                                        always, &asked));
  for (int t = 0; t < TRIANGLES; t++) {
    double area = area_of(point, triangle + 3 * t);
    check_near(area, 0.5, 1e-12); /* halves of unit squares: nothing else is Delaunay */
    for (int k = 0; k < 3; k++) {
      const double *a = point + 3 * triangle[3 * t + k];
      const double *b = point + 3 * triangle[3 * t + (k + 1) % 3];
      assert_true(fabs(a[0] - b[0]) <= 1);
    }
    sum += area;
  }
  check_near(sum, COUNT, 1e-12);
  assert_true(asked > 0);
}

/* Where it would change the shape, and where it is not wanted, nothing is flipped. */
static void test_kept(void **state) {
  bw_context *context = check_context(state);
  double point[3 * (2 * COUNT + 2)];
  int32_t triangle[3 * TRIANGLES], before[3 * TRIANGLES];
  uint8_t fresh[TRIANGLES];
  int asked = 0;
  for (int lifted = 0; lifted < 2; lifted++) {
    make_strip(lifted ? 0.5 : 0, point, before);
    memcpy(triangle, before, sizeof before);
    memset(fresh, 1, sizeof fresh);
    check_ok(context, bwi_flip_flat_edges(context, point, TRIANGLES, triangle, NULL, fresh, 1e-9,
                                          lifted ? always : never, &asked));
    assert_memory_equal(triangle, before, sizeof before);
  }
}

/* A tetrahedron with a flat cap: the edge that a flip would make is there already. */
static void test_closed(void **state) {
  bw_context *context = check_context(state);
  double point[12] = {0, 0, 0, 4, 0, 0, 2, 0.1, 0, 2, -0.1, 0};
  int32_t triangle[12] = {0, 1, 2, 1, 0, 3, 0, 2, 3, 2, 1, 3}, before[12];
  uint8_t fresh[4] = {1, 1, 1, 1};
  int asked = 0;
  memcpy(before, triangle, sizeof before);
  check_ok(context,
           bwi_flip_flat_edges(context, point, 4, triangle, NULL, fresh, 1e-9, always, &asked));
  assert_memory_equal(triangle, before, sizeof before);
  assert_int_equal(asked, 0);
}

check_main(check_test(test_strip), check_test(test_kept), check_test(test_closed));
