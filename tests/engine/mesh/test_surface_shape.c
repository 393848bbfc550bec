/* Surfaces by formula: sound, and of the volume that geometry says. */
#include "check.h"

static const double pi = 3.14159265358979323846;

static void check_sound(bw_context *context, const bw_surface *surface, int64_t shells) {
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, surface, 3, &report));
  for (int64_t i = 0; i < report.defect_count; i++)
    print_message("%s at %g %g %g\n", bw_defect_word(report.defect[i].kind), report.defect[i].at[0],
                  report.defect[i].at[1], report.defect[i].at[2]);
  assert_true(report.sound);
  assert_int_equal(report.shells, shells);
  bw_surface_report_clear(&report);
}

static void test_box_sphere_cylinder(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  const double low[3] = {-1, 2, 3}, high[3] = {1, 5, 3.5}, axis[3] = {1, 2, -2};
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_near(bw_surface_volume(surface), 3, 1e-14);
  check_sound(context, surface, 1);
  bw_release(surface);
  /* Second-order convergence to the sphere's volume. */
  double error[2];
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_surface_sphere_shape(context, low, 2, 3 + i, &surface));
    error[i] = 4.0 / 3 * pi * 8 - bw_surface_volume(surface);
    check_sound(context, surface, 1);
    bw_release(surface);
  }
  check_near(error[0] / error[1], 4, 0.1);
  check_ok(context, bw_surface_cylinder_shape(context, low, axis, 0.5, 60, &surface));
  check_near(bw_surface_volume(surface), 3 * 0.5 * 60 * 0.25 * sin(2 * pi / 60), 1e-13);
  check_sound(context, surface, 1);
  bw_release(surface);
  check_fails(context, BW_INVALID, "min must lie below max",
              bw_surface_box_shape(context, high, low, &surface));
  check_fails(context, BW_INVALID, "radius",
              bw_surface_sphere_shape(context, low, -1, 2, &surface));
  check_fails(context, BW_INVALID, "segments",
              bw_surface_cylinder_shape(context, low, axis, 1, 2, &surface));
}

typedef struct balls {
  int count;
  double centre[2][3], radius;
} balls;

static double outside_balls(void *data, const double at[3]) {
  const balls *b = (const balls *)data;
  double nearest = HUGE_VAL;
  for (int i = 0; i < b->count; i++) {
    double d[3] = {at[0] - b->centre[i][0], at[1] - b->centre[i][1], at[2] - b->centre[i][2]};
    nearest = fmin(nearest, bw_norm(d) - b->radius);
  }
  return nearest;
}

static void test_implicit(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {-1, -1.2, -1}, high[3] = {3, 1.1, 1}, cut[3] = {-0.5, -1, -1};
  balls two = {2, {{0, 0, 0}, {2, 0, 0}}, 0.8};
  bw_surface *surface = NULL;
  double exact = 2 * 4.0 / 3 * pi * 0.512, error[2];
  for (int i = 0; i < 2; i++) {
    check_ok(context,
             bw_surface_implicit(context, low, high, 20 << i, outside_balls, &two, &surface));
    error[i] = exact - bw_surface_volume(surface);
    check_sound(context, surface, 2);
    for (int32_t p = 0; p < surface->point_count; p++) /* the points lie on the zero set */
      check_near(outside_balls(&two, surface->point + 3 * p), 0, 2e-3);
    bw_release(surface);
  }
  check_near(error[0] / error[1], 4, 0.5);
  /* Zeros exactly at nodes, and a surface that merges: still sound. */
  balls merged = {2, {{0, 0, 0}, {1, 0, 0}}, 0.75};
  const double even_low[3] = {-2, -2, -2}, even_high[3] = {2, 2, 2};
  check_ok(context,
           bw_surface_implicit(context, even_low, even_high, 16, outside_balls, &merged, &surface));
  check_sound(context, surface, 1);
  bw_release(surface);
  check_fails(context, BW_GEOMETRY, "larger box",
              bw_surface_implicit(context, cut, high, 20, outside_balls, &two, &surface));
  two.radius = -1;
  check_fails(context, BW_EMPTY, "nowhere negative",
              bw_surface_implicit(context, low, high, 10, outside_balls, &two, &surface));
}

static bw_status make_all(bw_context *context) {
  bw_status status = BW_OK;
  bw_surface *a = NULL, *b = NULL, *c = NULL;
  const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  balls one = {1, {{0, 0, 0}}, 0.6};
  BW_TRY(bw_surface_sphere_shape(context, low, 1, 2, &a));
  BW_TRY(bw_surface_cylinder_shape(context, low, high, 1, 9, &b));
  BW_TRY(bw_surface_implicit(context, low, high, 6, outside_balls, &one, &c));
done:
  bw_release(a);
  bw_release(b);
  bw_release(c);
  return status;
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  check_each_allocation(context, status, 1) {
    status = make_all(context);
  }
}

check_main(check_test(test_box_sphere_cylinder), check_test(test_implicit),
           check_test(test_allocation_failures))
