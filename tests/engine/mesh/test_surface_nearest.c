/* The nearest facets of surfaces: against all facets, one after the other. */
#include "check.h"

#include <math.h>
#include <string.h>

#include "barwright/sample.h"

enum { FACETS = 3000, POINTS = 1500 };

/* A number in [-1, 1], always the same row of them. */
static double any(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / (double)(1ull << 52) - 1;
}

/* The distance of x from a triangle by the region of its plane that x lies above (Ericson,
 * Real-Time Collision Detection, 2005, 5.1.5), and the place on it. */
static double distance_from(const double x[3], const double *a, const double *b, const double *c,
                            double place[3]) {
  double ab[3], ac[3], ax[3], bx[3], cx[3], v, w;
  for (int k = 0; k < 3; k++) {
    ab[k] = b[k] - a[k];
    ac[k] = c[k] - a[k];
    ax[k] = x[k] - a[k];
    bx[k] = x[k] - b[k];
    cx[k] = x[k] - c[k];
  }
  double d1 = bw_dot(ab, ax), d2 = bw_dot(ac, ax), d3 = bw_dot(ab, bx), d4 = bw_dot(ac, bx),
         d5 = bw_dot(ab, cx), d6 = bw_dot(ac, cx);
  double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0)
    v = w = 0;
  else if (d3 >= 0 && d4 <= d3)
    v = 1, w = 0;
  else if (d6 >= 0 && d5 <= d6)
    v = 0, w = 1;
  else if (vc <= 0 && d1 >= 0 && d3 <= 0)
    v = d1 / (d1 - d3), w = 0;
  else if (vb <= 0 && d2 >= 0 && d6 <= 0)
    v = 0, w = d2 / (d2 - d6);
  else if (va <= 0 && d4 >= d3 && d5 >= d6)
    w = (d4 - d3) / (d4 - d3 + d5 - d6), v = 1 - w;
  else
    v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    place[k] = a[k] + v * ab[k] + w * ac[k];
    sum += (x[k] - place[k]) * (x[k] - place[k]);
  }
  return sqrt(sum);
}

/* The first of the facets that are nearest, to `tie`. */
static int32_t first_of_all(const bw_surface *surface, const double x[3], double tie,
                            double *distance) {
  double best = HUGE_VAL, place[3];
  int32_t facet = -1;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t t = surface->triangle_count - 1; t >= 0; t--) {
      const int32_t *corner = surface->triangle + 3 * (int64_t)t;
      double far = distance_from(x, surface->point + 3 * (int64_t)corner[0],
                                 surface->point + 3 * (int64_t)corner[1],
                                 surface->point + 3 * (int64_t)corner[2], place);
      if (pass == 0)
        best = fmin(best, far);
      else if (far <= best + tie)
        facet = t;
    }
  *distance = best;
  return facet;
}

static void compare(bw_context *context, const bw_surface *surface, int count,
                    const double *point) {
  int32_t *facet = (int32_t *)calloc((size_t)count, sizeof *facet);
  double *place = (double *)calloc(3 * (size_t)count, sizeof *place);
  double *distance = (double *)calloc((size_t)count, sizeof *distance);
  double *offset = (double *)calloc((size_t)count, sizeof *offset);
  assert_true(facet && place && distance && offset);
  check_ok(context, bw_surface_nearest(context, surface, count, point, facet, place, distance));
  check_ok(context, bw_surface_offsets(context, surface, count, point, offset));
  for (int i = 0; i < count; i++) {
    double far, apart[3];
    assert_int_equal(facet[i], first_of_all(surface, point + 3 * i, 1e-12, &far));
    for (int k = 0; k < 3; k++)
      apart[k] = place[3 * i + k] - point[3 * i + k];
    check_near(distance[i], far, 1e-11);
    check_near(offset[i], far, 1e-11);
    check_near(bw_norm(apart), far, 1e-11);
  }
  free(facet);
  free(place);
  free(distance);
  free(offset);
}

/* Small triangles anywhere, none of which shares a point with another. */
static void test_anywhere(void **state) {
  bw_context *context = check_context(state);
  static double corner[9 * FACETS], point[3 * POINTS];
  static int32_t triangle[3 * FACETS];
  uint64_t seed = 7;
  for (int t = 0; t < FACETS; t++) {
    double centre[3] = {any(&seed), any(&seed), any(&seed)};
    for (int k = 0; k < 9; k++)
      corner[9 * t + k] = centre[k % 3] + 0.1 * any(&seed);
  }
  for (int i = 0; i < 3 * FACETS; i++)
    triangle[i] = i;
  for (int i = 0; i < 3 * POINTS; i++)
    point[i] = 1.5 * any(&seed);
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_copy(context, 3 * FACETS, corner, FACETS, triangle, NULL, &surface));
  compare(context, surface, POINTS, point);
  bw_release(surface);
}

/* Points of a sphere, middles of its edges and its centre: as near to several facets. */
static void test_ties(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  const double centre[3] = {0.1, 0.2, 0.3};
  check_ok(context, bw_surface_sphere_shape(context, centre, 0.7, 2, &surface));
  int count = surface->triangle_count;
  double *at = (double *)calloc(18 * (size_t)count + 3, sizeof *at);
  assert_true(at);
  for (int t = 0; t < count; t++)
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        const int32_t *corner = surface->triangle + 3 * (int64_t)t;
        double a = surface->point[3 * (int64_t)corner[i] + k],
               b = surface->point[3 * (int64_t)corner[(i + 1) % 3] + k];
        at[18 * t + 6 * i + k] = a;
        at[18 * t + 6 * i + 3 + k] = (a + b) / 2;
      }
  memcpy(at + 18 * (size_t)count, centre, sizeof centre);
  compare(context, surface, 6 * count, at);
  bw_release(surface);
  free(at);

  const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1}, points[6] = {0, 0, 0, 1, 1, 1};
  double place[6], distance[2];
  int32_t facet[2];
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_ok(context, bw_surface_nearest(context, surface, 2, points, facet, place, distance));
  assert_int_equal(facet[0], 0); /* of twelve that are as near */
  assert_true(distance[0] == 1 && distance[1] == 0);
  compare(context, surface, 2, points);
  bw_release(surface);
}

/* A facet without area counts as the segment or the point that it is. */
static void test_without_area(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  static const double corner[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 5, 50};
  static const int32_t triangle[] = {3, 3, 3, 0, 1, 2, 2, 1, 0};
  static const double point[] = {1.5, 3, 4, 5, 5, 51};
  int32_t facet[2];
  double place[6], distance[2];
  check_ok(context, bw_surface_copy(context, 4, corner, 3, triangle, NULL, &surface));
  check_ok(context, bw_surface_nearest(context, surface, 2, point, facet, place, distance));
  assert_int_equal(facet[0], 1);
  assert_int_equal(facet[1], 0);
  check_near(distance[0], 5, 1e-12);
  check_near(distance[1], 1, 1e-12);
  check_near(place[0], 1.5, 1e-12);
  check_near(place[5], 50, 1e-12);
  bw_release(surface);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL, *empty = NULL;
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  double point[6] = {0, 0, 0, 0, NAN, 0}, distance[2];
  int32_t facet[2];
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_fails(context, BW_INVALID, "point 2",
              bw_surface_nearest(context, surface, 2, point, facet, NULL, NULL));
  check_ok(context, bw_surface_copy(context, 0, NULL, 0, NULL, NULL, &empty));
  check_fails(context, BW_GEOMETRY, "no facets",
              bw_surface_nearest(context, empty, 1, point, facet, NULL, distance));
  check_each_allocation(context, status, 1) {
    status = bw_surface_nearest(context, surface, 1, point, facet, NULL, distance);
  }
  bw_release(surface);
  bw_release(empty);
}

check_main(check_test(test_anywhere), check_test(test_ties), check_test(test_without_area),
           check_test(test_refused))
