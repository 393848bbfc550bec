/* Thickness under the surface: of bodies whose thickness is known at every place. */
#include "check.h"

#include <math.h>

enum { SAMPLES = 500 };

static void test_plate(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  const double low[3] = {0, 0, 0}, high[3] = {10, 10, 0.5};
  static double thickness[SAMPLES], place[3 * SAMPLES];
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_ok(context, bw_surface_thickness(context, surface, SAMPLES, thickness, place));
  int thin = 0;
  for (int i = 0; i < SAMPLES; i++) {
    double z = place[3 * i + 2];
    bool face = z < 1e-12 || z > 0.5 - 1e-12;
    check_near(thickness[i], face ? 0.5 : 10, 1e-12);
    thin += face;
  }
  /* Samples have equal shares of the area: 200 of 220. */
  assert_in_range(thin, SAMPLES * 200 / 220 - 1, SAMPLES * 200 / 220 + 1);
  bw_release(surface);
}

static void test_sphere_and_shell(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  static double thickness[SAMPLES];
  const double centre[3] = {1, 2, 3};
  check_ok(context, bw_surface_sphere_shape(context, centre, 2, 4, &surface));
  check_ok(context, bw_surface_thickness(context, surface, SAMPLES, thickness, NULL));
  for (int i = 0; i < SAMPLES; i++)
    assert_true(thickness[i] > 3.9 && thickness[i] <= 4);
  bw_release(surface);
}

static void test_open(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  static const double point[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  static const int32_t triangle[] = {0, 1, 2};
  double thickness[4];
  check_ok(context, bw_surface_copy(context, 3, point, 1, triangle, NULL, &surface));
  check_ok(context, bw_surface_thickness(context, surface, 4, thickness, NULL));
  for (int i = 0; i < 4; i++)
    assert_true(isinf(thickness[i]));
  check_fails(context, BW_INVALID, "at least 1",
              bw_surface_thickness(context, surface, 0, thickness, NULL));
  /* Without memory nothing leaks. */
  check_each_allocation(context, status, 1) {
    status = bw_surface_thickness(context, surface, 4, thickness, NULL);
  }
  bw_release(surface);
}

check_main(check_test(test_plate), check_test(test_sphere_and_shell), check_test(test_open))
