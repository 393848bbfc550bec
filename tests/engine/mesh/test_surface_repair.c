/* Repair, wrap and remesh: from broken shapes to sound ones, the distance moved reported. */
#include "check.h"

#include "mesh/faces_internal.h"
#include "mesh/surface_repair.h"

static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};

static bw_surface *make(bw_context *context, int32_t points, const double *point, int32_t facets,
                        const int32_t *triangle) {
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_copy(context, points, point, facets, triangle, NULL, &surface));
  return surface;
}

static bw_surface *repair(bw_context *context, const bw_surface *surface, bw_shape_log *log) {
  bw_surface *repaired = NULL;
  bw_surface_report report;
  bw_repair_options options;
  bw_repair_options_default(&options);
  options.wrap = false;
  check_ok(context, bw_surface_repair(context, surface, &options, &repaired, log));
  check_ok(context, bw_surface_check(context, repaired, 0, &report));
  assert_true(report.sound);
  bw_surface_report_clear(&report);
  return repaired;
}

static bool has_step(const bw_shape_log *log, const char *name) {
  for (int i = 0; i < log->count; i++)
    if (strcmp(log->step[i].name, name) == 0)
      return true;
  return false;
}

static void test_sound_stays_as_it_is(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = NULL, *repaired = NULL;
  bw_shape_log log = {.count = 7};
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  repaired = repair(context, box, &log);
  assert_ptr_equal(repaired, box);
  assert_int_equal(log.count, 0);
  bw_release(repaired);
  bw_release(box);
}

static void test_holes_and_cracks(void **state) {
  bw_context *context = check_context(state);
  bw_surface *sphere = NULL, *open = NULL, *repaired = NULL;
  bw_shape_log log;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 3, &sphere));
  open = make(context, sphere->point_count, sphere->point, sphere->triangle_count - 7,
              sphere->triangle);
  repaired = repair(context, open, &log);
  assert_true(has_step(&log, "fill holes"));
  check_near(bw_surface_volume(repaired), bw_surface_volume(sphere), 0.01);
  assert_true(log.moved > 0 && log.moved < 0.1);
  bw_release(repaired);
  bw_release(open);
  bw_release(sphere);
  /* A box without lid has one flat hole, as large as it is. */
  bw_surface *box = NULL;
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  open = make(context, 8, box->point, 10, box->triangle);
  repaired = repair(context, open, &log);
  check_near(bw_surface_volume(repaired), 1, 1e-12);
  bw_release(repaired);
  bw_release(open);
  /* A T-junction: the edge 0-1 is split on one side only. */
  double point[27];
  int32_t triangle[39];
  memcpy(point, box->point, 24 * sizeof(double));
  point[24] = 0.5, point[25] = 1e-9, point[26] = 0;
  memcpy(triangle, box->triangle, 36 * sizeof(int32_t));
  const int32_t split[6] = {0, 2, 8, 8, 2, 1}; /* of facet 0 2 1 */
  memcpy(triangle, split, 3 * sizeof(int32_t));
  memcpy(triangle + 36, split + 3, 3 * sizeof(int32_t));
  open = make(context, 9, point, 13, triangle);
  repaired = repair(context, open, &log);
  assert_true(has_step(&log, "stitch"));
  assert_int_equal(repaired->triangle_count, 14);
  check_near(bw_surface_volume(repaired), 1, 1e-8);
  bw_release(repaired);
  bw_release(open);
  bw_release(box);
}

/* Every facet twice, back to back: one of each stays. */
static void test_double_sided(void **state) {
  bw_context *context = check_context(state);
  bw_surface *sphere = NULL, *doubled = NULL, *repaired = NULL;
  bw_shape_log log;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 2, &sphere));
  int32_t n = sphere->triangle_count;
  int32_t *triangle = (int32_t *)malloc(6 * (size_t)n * sizeof *triangle);
  for (int32_t t = 0; t < n; t++)
    for (int k = 0; k < 3; k++) {
      triangle[3 * t + k] = sphere->triangle[3 * t + k];
      triangle[3 * (n + t) + k] = sphere->triangle[3 * t + 2 - k];
    }
  doubled = make(context, sphere->point_count, sphere->point, 2 * n, triangle);
  repaired = repair(context, doubled, &log);
  assert_int_equal(repaired->triangle_count, n);
  check_near(bw_surface_volume(repaired), bw_surface_volume(sphere), 1e-12);
  check_near(log.moved, 0, 1e-12);
  free(triangle);
  bw_release(repaired);
  bw_release(doubled);
  bw_release(sphere);
}

/* Two boxes that share a wall, the wall there twice: the wall goes, one body is left. */
static void test_wall_between_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = NULL, *both = NULL, *repaired = NULL;
  bw_shape_log log;
  double point[48];
  int32_t triangle[72];
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  for (int i = 0; i < 24; i++) {
    point[i] = box->point[i];
    point[24 + i] = box->point[i] + (i % 3 == 0);
  }
  for (int i = 0; i < 36; i++) {
    triangle[i] = box->triangle[i];
    triangle[36 + i] = box->triangle[i] + 8;
  }
  both = make(context, 16, point, 24, triangle);
  repaired = repair(context, both, &log);
  check_near(bw_surface_volume(repaired), 2, 1e-12);
  bw_release(repaired);
  bw_release(both);
  bw_release(box);
}

static bw_surface *two_boxes(bw_context *context, const double low[3], const double high[3]) {
  bw_surface *a = NULL, *b = NULL, *both = NULL;
  double point[48];
  int32_t triangle[72];
  check_ok(context, bw_surface_box_shape(context, zero, one, &a));
  check_ok(context, bw_surface_box_shape(context, low, high, &b));
  memcpy(point, a->point, sizeof point / 2);
  memcpy(point + 24, b->point, sizeof point / 2);
  for (int i = 0; i < 36; i++) {
    triangle[i] = a->triangle[i];
    triangle[36 + i] = b->triangle[i] + 8;
  }
  both = make(context, 16, point, 24, triangle);
  bw_release(a);
  bw_release(b);
  return both;
}

/* Whatever the limit on time, the repair gives the same surface or BW_LIMIT: a step that time ends
 * must not lead to another one. Two balls that overlap. */
static void test_time_decides_nothing(void **state) {
  bw_context *context = check_context(state);
  const double beside[3] = {0.3, 0.2, 0.1};
  bw_surface *ball[2], *both, *whole, *repaired = NULL;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 3, &ball[0]));
  check_ok(context, bw_surface_sphere_shape(context, beside, 1, 3, &ball[1]));
  const int32_t points = ball[0]->point_count, facets = ball[0]->triangle_count;
  double *point = malloc(6 * (size_t)points * sizeof *point);
  int32_t *triangle = malloc(6 * (size_t)facets * sizeof *triangle);
  assert_true(point && triangle);
  for (int b = 0; b < 2; b++) {
    memcpy(point + 3 * (size_t)points * (size_t)b, ball[b]->point,
           3 * (size_t)points * sizeof *point);
    for (int32_t i = 0; i < 3 * facets; i++)
      triangle[3 * facets * b + i] = ball[b]->triangle[i] + points * b;
    bw_release(ball[b]);
  }
  both = make(context, 2 * points, point, 2 * facets, triangle);
  bw_repair_options options;
  bw_repair_options_default(&options);
  options.wrap = false;
  check_ok(context, bw_surface_repair(context, both, &options, &whole, NULL));
  for (options.time_limit = 0.005; options.time_limit < 0.3; options.time_limit *= 1.3) {
    bw_status status = bw_surface_repair(context, both, &options, &repaired, NULL);
    assert_true(status == BW_OK || status == BW_LIMIT);
    if (status == BW_LIMIT)
      continue;
    assert_int_equal(repaired->point_count, whole->point_count);
    assert_memory_equal(repaired->point, whole->point,
                        3 * (size_t)whole->point_count * sizeof *whole->point);
    bw_release(repaired);
  }
  free(point);
  free(triangle);
  bw_release(both);
  bw_release(whole);
}

/* The union of two boxes has the volume that inclusion and exclusion give. */
static void test_overlapping_shells(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0.5, 0.25, 0.25}, high[3] = {2, 0.5, 1.5};
  bw_surface *both = two_boxes(context, low, high), *repaired = NULL;
  bw_shape_log log;
  repaired = repair(context, both, &log);
  assert_true(has_step(&log, "union"));
  /* Points in the order of their coordinates: that in which CGAL makes them depends on addresses.
   */
  for (int32_t k = 3; k < 3 * repaired->point_count; k += 3) {
    const double *p = repaired->point + k - 3, *q = repaired->point + k;
    assert_true(p[0] < q[0] || (p[0] == q[0] && (p[1] < q[1] || (p[1] == q[1] && p[2] < q[2]))));
  }
  check_near(bw_surface_volume(repaired), 1 + 1.5 * 0.25 * 1.25 - 0.5 * 0.25 * 0.75, 1e-12);
  check_near(log.moved, 0, 1e-9); /* inner walls went: the outside did not move */
  bw_release(repaired);
  bw_release(both);
}

static void test_boxes_touching_along_an_edge(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {1, 1, 0}, high[3] = {2, 2, 1};
  bw_surface *both = two_boxes(context, low, high), *repaired = NULL;
  bw_shape_log log;
  repaired = repair(context, both, &log);
  assert_true(has_step(&log, "separate"));
  check_near(bw_surface_volume(repaired), 2, 1e-4);
  assert_true(log.moved < 1e-5);
  bw_release(repaired);
  bw_release(both);
}

static void test_wrap(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0.5, 0.25, 0.25}, high[3] = {2, 0.5, 1.5};
  bw_surface *both = two_boxes(context, low, high), *wrapped = NULL;
  bw_shape_log log = {0};
  bw_wrap_options options;
  bw_wrap_options_default(&options);
  options.alpha = 0.2;
  options.offset = 0.02;
  check_ok(context, bw_surface_wrap(context, both, &options, &wrapped, &log));
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, wrapped, 0, &report));
  assert_true(report.sound);
  assert_true(report.volume > 1.375 && report.volume < 1.8);
  assert_int_equal(log.count, 1);
  assert_true(log.moved > 0.01);
  bw_release(wrapped);
  options.alpha = -1;
  check_fails(context, BW_INVALID, "positive",
              bw_surface_wrap(context, both, &options, &wrapped, &log));
  options.alpha = 1e-9;
  check_fails(context, BW_LIMIT, "1/3000",
              bw_surface_wrap(context, both, &options, &wrapped, &log));
  /* an offset that makes the wrap large */
  options.alpha = 0.5;
  options.offset = 4294967296.0;
  check_fails(context, BW_LIMIT, "offset",
              bw_surface_wrap(context, both, &options, &wrapped, &log));
  options.alpha = options.offset = 0.004; /* some seconds */
  options.time_limit = 0.05;
  check_fails(context, BW_LIMIT, "it may use",
              bw_surface_wrap(context, both, &options, &wrapped, &log));
  options.time_limit = 0;
  check_fails(context, BW_INVALID, "time_limit",
              bw_surface_wrap(context, both, &options, &wrapped, &log));
  bw_release(both);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  const double point[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const int32_t triangle[3] = {0, 1, 2};
  bw_surface *lone = make(context, 3, point, 1, triangle), *repaired = NULL;
  check_fails(context, BW_GEOMETRY, "encloses nothing",
              bw_surface_repair(context, lone, NULL, &repaired, NULL));
  bw_release(lone);
  /* an open sheet that nothing but a wrap could close, and no wrap allowed */
  double wave[75];
  int32_t grid[96], n = 0;
  for (int i = 0; i < 25; i++) {
    wave[3 * i] = i % 5;
    wave[3 * i + 1] = i / 5;
    wave[3 * i + 2] = sin(i % 5 * 1.5) * cos(i / 5 * 1.5);
  }
  for (int i = 0; i < 20; i++)
    if (i % 5 < 4) {
      const int32_t two[6] = {i, i + 1, i + 6, i, i + 6, i + 5};
      memcpy(grid + n, two, sizeof two);
      n += 6;
    }
  bw_surface *sheet = make(context, 25, wave, 32, grid);
  bw_repair_options options;
  bw_repair_options_default(&options);
  options.wrap = false;
  options.fill_holes = false;
  check_fails(context, BW_GEOMETRY, "16 open edges remain",
              bw_surface_repair(context, sheet, &options, &repaired, NULL));
  options.time_limit = 1e-9;
  check_fails(context, BW_LIMIT, "seconds",
              bw_surface_repair(context, sheet, &options, &repaired, NULL));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "", bw_surface_repair(context, sheet, NULL, &repaired, NULL));
  bw_clear_cancel(context);
  bw_release(sheet);
}

/* ---- remeshing ----------------------------------------------------------------------------- */

static double smallest_angle(const bw_surface *surface) {
  double min = 4;
  for (int32_t t = 0; t < surface->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = surface->point + 3 * surface->triangle[3 * t + k],
                   *b = surface->point + 3 * surface->triangle[3 * t + (k + 1) % 3],
                   *c = surface->point + 3 * surface->triangle[3 * t + (k + 2) % 3];
      double u[3], v[3], n[3];
      for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
      }
      bw_cross(u, v, n);
      min = fmin(min, atan2(bw_norm(n), bw_dot(u, v)));
    }
  return min * 180 / 3.14159265358979323846;
}

static void test_remesh_keeps_edges_and_volume(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = NULL, *fine = NULL;
  bw_shape_log log = {0};
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  options.edge_length = 0.13;
  check_ok(context, bw_surface_remesh(context, box, &options, &fine, &log));
  check_near(bw_surface_volume(fine), 1, 1e-12); /* planes and edges are kept exactly */
  check_near(bw_surface_area(fine), 6, 1e-12);
  check_near(log.moved, 0, 1e-12);
  assert_true(smallest_angle(fine) > 25);
  bw_release(fine);
  options.edge_length = 0;
  options.triangles = 3000;
  check_ok(context, bw_surface_remesh(context, box, &options, &fine, &log));
  assert_in_range(fine->triangle_count, 2000, 4500);
  bw_release(fine);
  bw_release(box);
}

/* A cylinder of needles: 200 segments without a point between the ends. */
/* Whether remeshing ends within a number of steps depends on the surface, not on threads. */
static void test_remesh_steps(void **state) {
  bw_context *context = check_context(state);
  bw_surface *ball, *made;
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = 0.1;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 3, &ball));
  int64_t min[2];
  for (int k = 0; k < 2; k++) {
    int64_t low = 0, high = 1 << 22; /* too few, enough */
    check_ok(context, bw_set_threads(context, 1 + 3 * k));
    while (high - low > 1024) {
      int64_t steps = (low + high) / 2;
      made = NULL;
      bw_status status = bwi_surface_remesh(context, ball, &options, NULL, steps, &made, NULL);
      bw_release(made);
      if (status == BW_OK)
        high = steps;
      else {
        assert_int_equal(status, BW_LIMIT);
        assert_non_null(strstr(bw_message(context), "steps it may use"));
        low = steps;
      }
    }
    assert_true(low > 0 && high < 1 << 22);
    min[k] = high;
  }
  assert_int_equal(min[0], min[1]);
  bw_release(ball);
}

static void test_remesh_needles(void **state) {
  bw_context *context = check_context(state);
  const double axis[3] = {0, 0, 4};
  bw_surface *cylinder = NULL, *remeshed = NULL;
  bw_shape_log log = {0};
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = 0.3;
  check_ok(context, bw_surface_cylinder_shape(context, zero, axis, 1, 200, &cylinder));
  assert_true(smallest_angle(cylinder) < 2);
  check_ok(context, bw_surface_remesh(context, cylinder, &options, &remeshed, &log));
  assert_true(smallest_angle(remeshed) > 20);
  check_near(bw_surface_volume(remeshed) / bw_surface_volume(cylinder), 1, 0.02);
  assert_true(log.moved < 0.03);
  assert_in_range(remeshed->triangle_count, 400, 1500);
  bw_release(remeshed);
  /* A length much larger than the radius: the cylinder is still there. */
  options.edge_length = 3;
  check_ok(context, bw_surface_remesh(context, cylinder, &options, &remeshed, &log));
  check_near(bw_surface_volume(remeshed) / bw_surface_volume(cylinder), 1, 0.2);
  bw_release(remeshed);
  bw_release(cylinder);
}

static void test_remesh_thin_shell(void **state) {
  bw_context *context = check_context(state);
  /* a hollow ball whose wall is a tenth of the edge length */
  bw_surface *outer = NULL, *inner = NULL, *shell = NULL, *turned = NULL, *remeshed = NULL;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 4, &outer));
  check_ok(context, bw_surface_sphere_shape(context, zero, 0.97, 4, &inner));
  int32_t n = outer->point_count, m = outer->triangle_count;
  double *point = (double *)malloc(6 * (size_t)n * sizeof *point);
  int32_t *triangle = (int32_t *)malloc(6 * (size_t)m * sizeof *triangle);
  memcpy(point, outer->point, 3 * (size_t)n * sizeof *point);
  memcpy(point + 3 * n, inner->point, 3 * (size_t)n * sizeof *point);
  for (int32_t i = 0; i < 3 * m; i++) {
    triangle[i] = outer->triangle[i];
    triangle[3 * m + i] = inner->triangle[i] + n;
  }
  shell = make(context, 2 * n, point, 2 * m, triangle);
  check_ok(context, bw_surface_orient(context, shell, &turned, NULL));
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = 0.3;
  check_ok(context, bw_surface_remesh(context, turned, &options, &remeshed, NULL));
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, remeshed, 0, &report));
  assert_true(report.sound);
  assert_int_equal(report.shells, 2);
  free(point);
  free(triangle);
  bw_release(outer);
  bw_release(inner);
  bw_release(shell);
  bw_release(turned);
  bw_release(remeshed);
}

static void test_remesh_refuses_open(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = NULL, *open = NULL, *remeshed = NULL;
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  open = make(context, 8, box->point, 11, box->triangle);
  check_fails(context, BW_GEOMETRY, "3 open",
              bw_surface_remesh(context, open, NULL, &remeshed, NULL));
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = 1e-7;
  check_fails(context, BW_LIMIT, "memory_limit",
              bw_surface_remesh(context, box, &options, &remeshed, NULL));
  options.edge_length = 0.01;
  options.memory_limit = 1e6;
  check_fails(context, BW_LIMIT, "memory_limit",
              bw_surface_remesh(context, box, &options, &remeshed, NULL));
  options.memory_limit = 6e9;
  options.time_limit = 1e-6;
  check_fails(context, BW_LIMIT, "time_limit",
              bw_surface_remesh(context, box, &options, &remeshed, NULL));
  options.time_limit = 0;
  check_fails(context, BW_INVALID, "time_limit",
              bw_surface_remesh(context, box, &options, &remeshed, NULL));
  options.time_limit = 300;
  options.edge_length = NAN;
  check_fails(context, BW_INVALID, "edge_length",
              bw_surface_remesh(context, box, &options, &remeshed, NULL));
  bw_release(open);
  bw_release(box);
}

/* ---- memory -------------------------------------------------------------------------------- */

static bw_status everything(bw_context *context, const bw_surface *broken) {
  bw_status status = BW_OK;
  bw_surface *repaired = NULL, *remeshed = NULL;
  bw_repair_options repairing;
  bw_repair_options_default(&repairing);
  repairing.wrap = false;
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = 0.6;
  options.iterations = 2;
  BW_TRY(bw_surface_repair(context, broken, &repairing, &repaired, NULL));
  BW_TRY(bw_surface_remesh(context, repaired, &options, &remeshed, NULL));
done:
  bw_release(repaired);
  bw_release(remeshed);
  return status;
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = NULL, *open = NULL;
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  int32_t triangle[36];
  memcpy(triangle, box->triangle, sizeof triangle);
  triangle[33] = triangle[34]; /* a facet that repeats a point, and so a hole */
  open = make(context, 8, box->point, 12, triangle);
  check_ok(context, everything(context, open));
  check_each_allocation(context, status, 100) {
    status = everything(context, open);
  }
  bw_release(open);
  bw_release(box);
}

check_main(check_test(test_sound_stays_as_it_is), check_test(test_holes_and_cracks),
           check_test(test_double_sided), check_test(test_wall_between_bodies),
           check_test(test_overlapping_shells), check_test(test_time_decides_nothing),
           check_test(test_boxes_touching_along_an_edge), check_test(test_wrap),
           check_test(test_refusals), check_test(test_remesh_keeps_edges_and_volume),
           check_test(test_remesh_steps), check_test(test_remesh_needles),
           check_test(test_remesh_thin_shell), check_test(test_remesh_refuses_open),
           check_test(test_allocation_failures))
