/* Surfaces: making, measuring, welding, orienting, checking, distance. */
#include "check.h"

#include "mesh/predicates.h"

static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};

static bw_surface *unit_box(bw_context *context) {
  bw_surface *box = NULL;
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  return box;
}

/* Two surfaces in one. */
static bw_surface *together(bw_context *context, const bw_surface *a, const bw_surface *b) {
  int32_t points = a->point_count + b->point_count, facets = a->triangle_count + b->triangle_count;
  double *point = (double *)malloc((size_t)points * 3 * sizeof *point);
  int32_t *triangle = (int32_t *)malloc((size_t)facets * 3 * sizeof *triangle);
  memcpy(point, a->point, (size_t)a->point_count * 3 * sizeof *point);
  memcpy(point + 3 * a->point_count, b->point, (size_t)b->point_count * 3 * sizeof *point);
  memcpy(triangle, a->triangle, (size_t)a->triangle_count * 3 * sizeof *triangle);
  for (int32_t i = 0; i < 3 * b->triangle_count; i++)
    triangle[3 * a->triangle_count + i] = b->triangle[i] + a->point_count;
  bw_surface *both = NULL;
  check_ok(context, bw_surface_copy(context, points, point, facets, triangle, NULL, &both));
  free(point);
  free(triangle);
  return both;
}

static bw_surface *box_between(bw_context *context, double low, double high) {
  double a[3] = {low, low, low}, b[3] = {high, high, high};
  bw_surface *box = NULL;
  check_ok(context, bw_surface_box_shape(context, a, b, &box));
  return box;
}

static void test_measures(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = unit_box(context), *moved = NULL, *scaled = NULL;
  check_near(bw_surface_volume(box), 1, 1e-15);
  check_near(bw_surface_area(box), 6, 1e-15);
  /* Volume scales with the determinant; a mirror does not turn the surface inside out. */
  const double matrix[12] = {-2, 0, 0, 1e6, 0, 3, 1, 0, 0, 0, 1, 0};
  check_ok(context, bw_surface_transform(context, box, matrix, &moved));
  check_near(bw_surface_volume(moved), 6, 1e-8);
  check_ok(context, bw_surface_scale(context, box, 1e-3, &scaled));
  check_near(bw_surface_volume(scaled), 1e-9, 1e-24);
  double low[3], high[3];
  bw_surface_box(moved, low, high);
  check_near(low[0], 1e6 - 2, 0);
  check_near(high[1], 4, 0);
  bw_release(box);
  bw_release(moved);
  bw_release(scaled);
}

static void test_bad_arrays_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  const double point[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, bad[9] = {0, 0, 0, 1, NAN, 0, 0, 1, 0};
  const int32_t triangle[3] = {0, 1, 2}, far[3] = {0, 1, 3}, below[3] = {0, -1, 2};
  check_fails(context, BW_GEOMETRY, "point 2",
              bw_surface_copy(context, 3, bad, 1, triangle, NULL, &surface));
  check_fails(context, BW_GEOMETRY, "point 4",
              bw_surface_copy(context, 3, point, 1, far, NULL, &surface));
  check_fails(context, BW_GEOMETRY, "point 0",
              bw_surface_copy(context, 3, point, 1, below, NULL, &surface));
  check_fails(context, BW_LIMIT, "3000000000",
              bw_surface_copy(context, 3000000000, point, 1, triangle, NULL, &surface));
  check_fails(context, BW_INVALID, "factor", bw_surface_scale(context, surface, 0, &surface));
  assert_null(surface);
  check_ok(context, bw_surface_copy(context, 0, NULL, 0, NULL, NULL, &surface)); /* empty is fine */
  check_near(bw_surface_volume(surface), 0, 0);
  bw_release(surface);
}

static void test_weld(void **state) {
  bw_context *context = check_context(state);
  bw_surface *sphere = NULL, *loose = NULL, *welded = NULL;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 3, &sphere));
  assert_int_equal(sphere->triangle_count, 1280);
  assert_int_equal(sphere->point_count, 642);
  /* Facets torn apart, each corner shaken by up to 1e-7. */
  int32_t count = 3 * sphere->triangle_count;
  double *point = (double *)malloc((size_t)count * 3 * sizeof *point);
  int32_t *triangle = (int32_t *)malloc((size_t)count * sizeof *triangle);
  int32_t *group = (int32_t *)malloc((size_t)sphere->triangle_count * sizeof *group);
  bw_random random;
  bw_random_seed(&random, 1);
  for (int32_t i = 0; i < count; i++) {
    triangle[i] = i;
    group[i / 3] = i / 3 % 7;
    for (int k = 0; k < 3; k++)
      point[3 * i + k] =
          sphere->point[3 * sphere->triangle[i] + k] + 1e-7 * bw_random_uniform(&random);
  }
  check_ok(context, bw_surface_copy(context, count, point, count / 3, triangle, group, &loose));
  check_ok(context, bw_surface_weld(context, loose, 0, &welded));
  assert_int_equal(welded->point_count, count);
  bw_release(welded);
  check_ok(context, bw_surface_weld(context, loose, 3e-7, &welded));
  assert_int_equal(welded->point_count, 642);
  assert_int_equal(welded->triangle_count, 1280);
  assert_int_equal(welded->group[8], 1);
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, welded, 1, &report));
  assert_true(report.sound);
  bw_surface_report_clear(&report);
  double distance;
  check_ok(context, bw_surface_distance(context, sphere, welded, &distance));
  assert_true(distance > 0 && distance < 5e-7);
  free(point);
  free(triangle);
  free(group);
  bw_release(loose);
  bw_release(welded);
  bw_release(sphere);
}

static void test_predicates_are_exact(void **state) {
  (void)state;
  /* Points of a plane moved by one unit in the last place, where plain doubles give any sign. */
  double a[3] = {0.1, 0.2, 0.3}, b[3] = {1.1, 2.2, 3.3};
  for (int i = 1; i < 200; i++) {
    double c[3], d[3];
    for (int k = 0; k < 3; k++) {
      c[k] = 12 + i * 0.25;
      d[k] = c[k];
    }
    /* a 2D case on the line y = x: exactly 0, then one step to each side */
    double p[2] = {0.5, 0.5}, q[2] = {12, 12}, r[2] = {24 + i, 24 + i};
    assert_int_equal(bwi_orient2(p, q, r), 0);
    r[1] = nextafter(r[1], 1e9);
    assert_int_equal(bwi_orient2(p, q, r), 1);
    r[1] = nextafter(nextafter(r[1], 0), 0);
    assert_int_equal(bwi_orient2(p, q, r), -1);
    /* x = y = z: three points of a line with any fourth are in a plane */
    double e[3] = {0.5, 0.5, 0.5};
    assert_int_equal(bwi_orient3(e, c, d, a), 0);
    assert_int_equal(bwi_orient3(a, b, a, c), 0);
  }
  /* the plane x + y + z = 1 with dyadic points, exactly representable */
  double u[3] = {1, 0, 0}, v[3] = {0, 1, 0}, w[3] = {0, 0, 1}, x[3] = {0.375, 0.5, 0.125};
  assert_int_equal(bwi_orient3(u, v, w, x), 0);
  x[0] = nextafter(x[0], 1);
  assert_int_equal(bwi_orient3(u, v, w, x), 1);
  assert_int_equal(bwi_orient3(v, u, w, x), -1);
  double origin[3] = {0, 0, 0};
  assert_int_equal(bwi_orient3(origin, u, v, w), 1);
}

static void test_check_counts(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box = unit_box(context), *changed = NULL;
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, box, 10, &report));
  assert_true(report.sound && report.closed && report.oriented);
  assert_int_equal(report.shells, 1);
  assert_int_equal(report.defect_count, 0);
  bw_surface_report_clear(&report);

  /* one facet missing: three open edges, one hole, with their places */
  check_ok(context, bw_surface_copy(context, 8, box->point, 11, box->triangle, NULL, &changed));
  check_ok(context, bw_surface_check(context, changed, 2, &report));
  assert_int_equal(report.count[BW_DEFECT_OPEN_EDGE], 3);
  assert_int_equal(report.holes, 1);
  assert_int_equal(report.defect_count, 2); /* the list is cut, the count is not */
  assert_false(report.sound);
  bw_surface_report_clear(&report);
  bw_release(changed);

  /* one facet turned, one doubled, one that repeats a point, one with its corners on a line */
  double point[27];
  int32_t triangle[45];
  memcpy(point, box->point, sizeof(double) * 24);
  point[24] = 0.5, point[25] = 0, point[26] = 0; /* the middle of edge 0-1 */
  memcpy(triangle, box->triangle, sizeof(int32_t) * 36);
  triangle[1] = box->triangle[2];
  triangle[2] = box->triangle[1];
  const int32_t more[9] = {4, 5, 6, 7, 7, 3, 0, 1, 8};
  memcpy(triangle + 36, more, sizeof more);
  check_ok(context, bw_surface_copy(context, 9, point, 15, triangle, NULL, &changed));
  check_ok(context, bw_surface_check(context, changed, 10, &report));
  assert_int_equal(report.count[BW_DEFECT_DUPLICATE_FACET], 1);
  assert_int_equal(report.count[BW_DEFECT_ZERO_AREA], 2);
  assert_int_equal(report.count[BW_DEFECT_NONMANIFOLD_EDGE], 4); /* 3 of the double, edge 0-1 */
  assert_int_equal(report.count[BW_DEFECT_OPEN_EDGE], 2);
  assert_true(report.count[BW_DEFECT_MISORIENTED_EDGE] >= 2);
  bw_surface_report_clear(&report);
  bw_release(changed);
  bw_release(box);
}

static void test_intersections(void **state) {
  bw_context *context = check_context(state);
  bw_surface_report report;
  bw_surface *a = unit_box(context), *b = box_between(context, 0.5, 1.5),
             *both = together(context, a, b);
  check_ok(context, bw_surface_check(context, both, 100, &report));
  assert_true(report.closed);
  assert_true(report.count[BW_DEFECT_SELF_INTERSECTION] > 0);
  assert_int_equal(report.count[BW_DEFECT_FLIPPED_SHELL], 0); /* overlapping is not nested */
  for (int64_t i = 0; i < report.defect_count; i++)
    for (int k = 0; k < 3; k++)
      assert_true(report.defect[i].at[k] >= 0.5 && report.defect[i].at[k] <= 1);
  bw_surface_report_clear(&report);
  bw_release(both);
  bw_release(b);
  /* Touching along a face counts: facets of both lie in one plane and overlap. */
  double low[3] = {1, 0.25, 0.25}, high[3] = {2, 0.75, 0.75};
  check_ok(context, bw_surface_box_shape(context, low, high, &b));
  both = together(context, a, b);
  check_ok(context, bw_surface_check(context, both, 0, &report));
  assert_true(report.count[BW_DEFECT_SELF_INTERSECTION] > 0);
  bw_surface_report_clear(&report);
  bw_release(both);
  bw_release(b);
  /* A corner that just touches a face does, one beside it by one unit in the last place does not.
   */
  double point[12] = {1, 0.5, 0.5, 2, 0, 0, 2, 1, 0, 2, 0.5, 1};
  const int32_t spike[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_surface_copy(context, 4, point, 4, spike, NULL, &b));
    both = together(context, a, b);
    check_ok(context, bw_surface_check(context, both, 0, &report));
    assert_int_equal(report.count[BW_DEFECT_SELF_INTERSECTION] > 0, i == 0);
    bw_surface_report_clear(&report);
    bw_release(both);
    bw_release(b);
    point[0] = nextafter(1, 2);
  }
  bw_release(a);
}

/* Boxes in boxes, all facing every way: outermost outwards, then inwards, outwards again. */
static void test_orientation_of_nested_shells(void **state) {
  bw_context *context = check_context(state);
  bw_surface *a = box_between(context, 0, 10), *b = box_between(context, 1, 9),
             *c = box_between(context, 2, 8), *ab = together(context, a, b),
             *all = together(context, ab, c), *shuffled = NULL, *oriented = NULL;
  check_ok(context, bw_surface_copy(context, all->point_count, all->point, all->triangle_count,
                                    all->triangle, NULL, &shuffled));
  bw_random random;
  bw_random_seed(&random, 5);
  for (int32_t t = 0; t < shuffled->triangle_count; t++)
    if (bw_random_uniform(&random) < 0.5) {
      int32_t keep = shuffled->triangle[3 * t];
      shuffled->triangle[3 * t] = shuffled->triangle[3 * t + 1];
      shuffled->triangle[3 * t + 1] = keep;
    }
  int64_t flipped = 0;
  check_ok(context, bw_surface_orient(context, shuffled, &oriented, &flipped));
  check_near(bw_surface_volume(oriented), 1000 - 512 + 216, 1e-9);
  assert_true(flipped > 0);
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, oriented, 0, &report));
  assert_true(report.sound);
  assert_int_equal(report.shells, 3);
  bw_surface_report_clear(&report);
  check_ok(context, bw_surface_check(context, all, 10, &report));
  assert_int_equal(report.count[BW_DEFECT_FLIPPED_SHELL], 1); /* the middle one */
  assert_int_equal(report.defect[0].facet, 12);
  bw_surface_report_clear(&report);
  bw_release(oriented);
  bw_release(shuffled);
  bw_release(all);
  bw_release(ab);
  bw_release(a);
  bw_release(b);
  bw_release(c);
}

static void test_one_sided_strip_is_refused(void **state) {
  bw_context *context = check_context(state);
  enum { N = 12 };
  double point[2 * N * 3];
  int32_t triangle[2 * N * 3];
  for (int i = 0; i < N; i++) {
    double turn = 2 * 3.14159265358979323846 * i / N;
    for (int k = 0; k < 2; k++) {
      double across = (k ? 0.3 : -0.3), r = 1 + across * cos(turn / 2);
      point[6 * i + 3 * k] = r * cos(turn);
      point[6 * i + 3 * k + 1] = r * sin(turn);
      point[6 * i + 3 * k + 2] = across * sin(turn / 2);
    }
    int32_t a = 2 * i, b = a + 1, c = i + 1 < N ? a + 2 : 1, d = i + 1 < N ? a + 3 : 0;
    const int32_t two[6] = {a, c, b, b, c, d};
    memcpy(triangle + 6 * i, two, sizeof two);
  }
  bw_surface *strip = NULL, *oriented = NULL;
  check_ok(context, bw_surface_copy(context, 2 * N, point, 2 * N, triangle, NULL, &strip));
  check_fails(context, BW_GEOMETRY, "one side", bw_surface_orient(context, strip, &oriented, NULL));
  bw_release(strip);
}

static void test_distance(void **state) {
  bw_context *context = check_context(state);
  bw_surface *a = unit_box(context), *b = NULL, *empty = NULL;
  double distance;
  const double matrix[12] = {1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, 0};
  check_ok(context, bw_surface_transform(context, a, matrix, &b));
  check_ok(context, bw_surface_distance(context, a, b, &distance));
  check_near(distance, 0.25, 1e-15);
  check_ok(context, bw_surface_distance(context, a, a, &distance));
  check_near(distance, 0, 1e-15);
  /* Concentric spheres; and the far side of one alone is seen from either order. */
  bw_surface *s = NULL, *t = NULL;
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 4, &s));
  check_ok(context, bw_surface_sphere_shape(context, zero, 1.5, 4, &t));
  check_ok(context, bw_surface_distance(context, s, t, &distance));
  check_near(distance, 0.5, 5e-3);
  bw_surface *both = together(context, s, t);
  double back;
  check_ok(context, bw_surface_distance(context, both, s, &distance));
  check_ok(context, bw_surface_distance(context, s, both, &back));
  check_near(distance, back, 0);
  check_near(distance, 0.5, 5e-3);
  check_ok(context, bw_surface_copy(context, 0, NULL, 0, NULL, NULL, &empty));
  check_fails(context, BW_EMPTY, "without facets",
              bw_surface_distance(context, s, empty, &distance));
  bw_release(a);
  bw_release(b);
  bw_release(s);
  bw_release(t);
  bw_release(both);
  bw_release(empty);
}

static void test_same_for_any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  bw_surface *s = NULL, *t = NULL, *both = NULL;
  const double centre[3] = {0.3, 0.1, 0.2};
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 4, &s));
  check_ok(context, bw_surface_sphere_shape(context, centre, 1, 4, &t));
  both = together(context, s, t);
  bw_surface_report report[2];
  double distance[2];
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_set_threads(context, i ? 3 : 1));
    check_ok(context, bw_surface_check(context, both, 1000000, &report[i]));
    check_ok(context, bw_surface_distance(context, s, t, &distance[i]));
  }
  assert_int_equal(report[0].defect_count, report[1].defect_count);
  assert_true(report[0].defect_count > 100);
  for (int64_t i = 0; i < report[0].defect_count; i++) {
    assert_int_equal(report[0].defect[i].facet, report[1].defect[i].facet);
    assert_int_equal(report[0].defect[i].other, report[1].defect[i].other);
    assert_memory_equal(report[0].defect[i].at, report[1].defect[i].at, 3 * sizeof(double));
  }
  assert_memory_equal(&distance[0], &distance[1], sizeof distance[0]);
  bw_surface_report_clear(&report[0]);
  bw_surface_report_clear(&report[1]);
  bw_release(s);
  bw_release(t);
  bw_release(both);
}

static bw_status everything(bw_context *context, const bw_surface *both) {
  bw_status status = BW_OK;
  bw_surface *welded = NULL, *oriented = NULL;
  bw_surface_report report = {0};
  double distance;
  BW_TRY(bw_surface_weld(context, both, 1e-9, &welded));
  BW_TRY(bw_surface_orient(context, welded, &oriented, NULL));
  BW_TRY(bw_surface_check(context, oriented, 10, &report));
  BW_TRY(bw_surface_distance(context, both, oriented, &distance));
done:
  bw_surface_report_clear(&report);
  bw_release(welded);
  bw_release(oriented);
  return status;
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_surface *a = unit_box(context), *b = box_between(context, 0.5, 1.5),
             *both = together(context, a, b);
  check_ok(context, everything(context, both)); /* threads are there from now on */
  check_each_allocation(context, status, 40) {
    status = everything(context, both);
  }
  bw_release(a);
  bw_release(b);
  bw_release(both);
}

check_main(check_test(test_measures), check_test(test_bad_arrays_are_refused),
           check_test(test_weld), check_test(test_predicates_are_exact),
           check_test(test_check_counts), check_test(test_intersections),
           check_test(test_orientation_of_nested_shells),
           check_test(test_one_sided_strip_is_refused), check_test(test_distance),
           check_test(test_same_for_any_number_of_threads), check_test(test_allocation_failures))
