/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Williams' exponents against published values, and re-entrant edges of shapes by formula. */
#include "prism.h"

static const double pi = 3.14159265358979323846;

/* The exponents of a V-notch that is open by 0, 30, 45, 60, 90, 120, 135 and 150 degrees: Lazzarin
 * and Tovo, Fatigue Fract. Eng. Mater. Struct. 21 (1998), table 1. */
static void exponents_of_free_edges(void **state) {
  (void)state;
  static const double value[][2] = {{360, 0.5},    {330, 0.5014}, {315, 0.5050}, {300, 0.5122},
                                    {270, 0.5445}, {240, 0.6157}, {225, 0.6736}, {210, 0.7520}};
  for (size_t i = 0; i < sizeof value / sizeof *value; i++)
    check_near(bw_williams_exponent(BW_CORNER_FREE, value[i][0] * pi / 180, 0.3), value[i][1],
               6e-5);
  for (int angle = 1; angle <= 180; angle++)
    check_near(bw_williams_exponent(BW_CORNER_FREE, angle * pi / 180, 0.3), 1, 0);
  check_near(bw_williams_exponent(BW_CORNER_FREE, 0, 0.3), 1, 0);
  /* the smaller the kink, the weaker: 1 - lambda -> 2 delta / pi */
  double kink = 0.01;
  check_near((1 - bw_williams_exponent(BW_CORNER_FREE, pi + kink, 0)) / (2 * kink / pi), 1, 0.02);
}

/* A fixed face of 90 degrees at nu = 0.3: 0.711 (Williams 1952); of 180 degrees: 1/2, complex. */
static void exponents_at_supports(void **state) {
  (void)state;
  check_near(bw_williams_exponent(BW_CORNER_FIXED, pi / 2, 0.3), 0.7112, 1e-4);
  check_near(bw_williams_exponent(BW_CORNER_FIXED, pi, 0.3), 0.5, 1e-9);
  check_near(bw_williams_exponent(BW_CORNER_FIXED, pi, 0.45), 0.5, 1e-9);
  check_near(bw_williams_exponent(BW_CORNER_FIXED, 2 * pi, 0.3), 0.25, 1e-9);
  check_near(bw_williams_exponent(BW_CORNER_FIXED, pi / 4, 0.3), 1, 0);
  check_near(bw_williams_exponent(BW_CORNER_FIXED, pi / 2, 0), 1, 1e-5); /* no contraction */
  assert_true(bw_williams_exponent(BW_CORNER_FIXED, pi / 2, 0.45) <
              bw_williams_exponent(BW_CORNER_FIXED, pi / 2, 0.3));
  /* a sliding face is a plane of symmetry */
  check_near(bw_williams_exponent(BW_CORNER_SLIDING, pi / 2, 0.3), 1, 0);
  check_near(bw_williams_exponent(BW_CORNER_SLIDING, 0.75 * pi, 0.3), 0.54448, 1e-5);
  check_near(bw_williams_exponent(BW_CORNER_SLIDING, pi, 0.3), 0.5, 1e-9);
  check_near(bw_williams_exponent(BW_CORNER_SLIDING, 2 * pi, 0.3), 0.25, 1e-9);
}

/* A block with a V-notch of the opening `open` (radians) at the origin. */
static bw_surface *notched(bw_context *context, double open, double height) {
  const double wide = tan(open / 2), centre[2] = {0, -1};
  const double profile[][2] = {{-25, -2}, {25, -2},   {25, 1}, {wide, 1},
                               {0, 0},    {-wide, 1}, {-25, 1}};
  return prism(context, 7, profile, centre, height, 1);
}

static void notches_have_one_edge(void **state) {
  bw_context *context = check_context(state);
  static const int open[] = {20, 45, 90, 120, 150};
  for (size_t i = 0; i < sizeof open / sizeof *open; i++) {
    bw_surface *surface = notched(context, open[i] * pi / 180, 2.5);
    bw_singular_places *edges = NULL;
    check_ok(context, bw_singular_edges(context, surface, NULL, 0, &edges));
    assert_int_equal(edges->count, 1);
    const bw_singular_place *edge = edges->place;
    assert_int_equal(edge->kind, BW_SINGULAR_EDGE);
    assert_int_equal(edge->count, 2);
    check_near(edge->length, 2.5, 1e-14);
    check_near(edge->angle, (360 - open[i]) * pi / 180, 1e-12);
    check_near(edge->exponent, bw_williams_exponent(BW_CORNER_FREE, edge->angle, 0), 0);
    for (int32_t p = 0; p < 2; p++) {
      const double *x = edges->point + 3 * (size_t)p, *inward = edges->inward + 3 * (size_t)p;
      check_near(x[0], 0, 1e-15);
      check_near(x[1], 0, 1e-15);
      check_near(inward[0], 0, 1e-12);
      check_near(inward[1], -1, 1e-12);
    }
    bw_release(edges);
    bw_release(surface);
  }
  /* a kink of 15 degrees passes for a part of a round or free face; one of 30 does not */
  bw_surface *surface = notched(context, 165 * pi / 180, 1);
  bw_singular_places *edges = NULL;
  check_ok(context, bw_singular_edges(context, surface, NULL, 0, &edges));
  assert_int_equal(edges->count, 0);
  bw_release(edges);
  bw_release(surface);
  surface = notched(context, 120 * pi / 180, 1);
  check_ok(context, bw_singular_edges(context, surface, NULL, 1.1, &edges));
  assert_int_equal(edges->count, 0);
  bw_release(edges);
  bw_release(surface);
}

/* An L: one edge of 270 degrees; its cut end is part of no other edge. */
static void an_l_section_has_one_edge(void **state) {
  bw_context *context = check_context(state);
  const double profile[][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  const double centre[2] = {0.5, 0.5};
  bw_surface *surface = prism(context, 6, profile, centre, 4, 1);
  bw_singular_places *edges = NULL;
  check_ok(context, bw_singular_edges(context, surface, NULL, 0, &edges));
  assert_int_equal(edges->count, 1);
  check_near(edges->place[0].angle, 1.5 * pi, 1e-12);
  check_near(edges->place[0].exponent, 0.5444837, 1e-6);
  check_near(edges->place[0].length, 4, 1e-14);
  check_near(edges->inward[0], -sqrt(0.5), 1e-12);
  bw_release(edges);
  bw_release(surface);
}

static void convex_and_round_bodies_have_none(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0, 0, 0}, high[3] = {3, 2, 1}, axis[3] = {1, 2, 2};
  bw_surface *surface[3] = {NULL};
  check_ok(context, bw_surface_box_shape(context, low, high, &surface[0]));
  check_ok(context, bw_surface_cylinder_shape(context, low, axis, 0.5, 20, &surface[1]));
  check_ok(context, bw_surface_sphere_shape(context, low, 0.7, 2, &surface[2]));
  for (int i = 0; i < 3; i++) {
    bw_singular_places *edges = NULL;
    check_ok(context, bw_singular_edges(context, surface[i], NULL, 0, &edges));
    assert_int_equal(edges->count, 0);
    bw_release(edges);
    bw_release(surface[i]);
  }
}

/* A profile turned around z, facets seen from inside too: points (r, z) counterclockwise with r > 0
 * make a ring. */
static bw_surface *turned(bw_context *context, int n, const double (*profile)[2], int around) {
  double *point = malloc(3 * (size_t)n * (size_t)around * sizeof *point);
  int32_t *triangle = malloc(6 * (size_t)n * (size_t)around * sizeof *triangle), at = 0;
  bw_surface *surface = NULL;
  assert_true(point && triangle);
  for (int j = 0; j < around; j++)
    for (int i = 0; i < n; i++) {
      double *x = point + 3 * (j * n + i), turn = 2 * pi * j / around;
      x[0] = profile[i][0] * cos(turn);
      x[1] = profile[i][0] * sin(turn);
      x[2] = profile[i][1];
    }
  for (int j = 0; j < around; j++)
    for (int i = 0; i < n; i++) {
      int32_t a = j * n + i, b = j * n + (i + 1) % n, c = (j + 1) % around * n + i;
      int32_t d = (j + 1) % around * n + (i + 1) % n;
      const int32_t two[6] = {a, c, b, b, c, d};
      memcpy(triangle + at, two, sizeof two);
      at += 6;
    }
  check_ok(context,
           bw_surface_copy(context, n * around, point, 2 * n * around, triangle, NULL, &surface));
  free(point);
  free(triangle);
  return surface;
}

/* The facets of a hole and of a shaft make no edges; the shoulder of the shaft makes one ring, and
 * a quarter-round fillet of eight facets none. */
static void facets_of_round_faces_are_no_edges(void **state) {
  bw_context *context = check_context(state);
  const double ring[][2] = {{1, 0}, {2, 0}, {2, 1}, {1, 1}};
  const double shoulder[][2] = {{0.5, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0.5, 3}};
  double fillet[14][2] = {{0.5, 0}, {3, 0}, {3, 1}};
  for (int i = 0; i <= 8; i++) {
    fillet[3 + i][0] = 1.5 - 0.5 * sin(pi / 16 * i);
    fillet[3 + i][1] = 1.5 - 0.5 * cos(pi / 16 * i);
  }
  fillet[12][0] = 1;
  fillet[12][1] = fillet[13][1] = 3;
  fillet[13][0] = 0.5;
  bw_surface *surface[3] = {turned(context, 4, ring, 24), turned(context, 6, shoulder, 40),
                            turned(context, 14, (const double(*)[2])fillet, 60)};
  static const int expected[] = {0, 1, 0};
  for (int i = 0; i < 3; i++) {
    bw_singular_places *edges = NULL;
    check_ok(context, bw_singular_edges(context, surface[i], NULL, 0, &edges));
    assert_int_equal(edges->count, expected[i]);
    if (i == 1) {
      const bw_singular_place *edge = edges->place;
      assert_int_equal(edge->count, 41);
      check_near(edge->length, 80 * sin(pi / 40), 1e-12);
      check_near(edge->angle, 1.5 * pi, 1e-9);
      assert_memory_equal(edges->point, edges->point + 120, 3 * sizeof(double));
    }
    bw_release(edges);
    bw_release(surface[i]);
  }
}

static void surfaces_without_an_inside_are_refused(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  bw_surface *box = NULL, *bad = NULL;
  bw_singular_places *edges = NULL;
  int32_t triangle[36];
  check_ok(context, bw_surface_box_shape(context, low, high, &box));
  assert_int_equal(box->triangle_count, 12);
  memcpy(triangle, box->triangle, sizeof triangle);
  check_ok(context,
           bw_surface_copy(context, box->point_count, box->point, 11, triangle, NULL, &bad));
  check_fails(context, BW_GEOMETRY, "open", bw_singular_edges(context, bad, NULL, 0, &edges));
  bw_release(bad);
  triangle[0] = box->triangle[1];
  triangle[1] = box->triangle[0];
  check_ok(context,
           bw_surface_copy(context, box->point_count, box->point, 12, triangle, NULL, &bad));
  check_fails(context, BW_GEOMETRY, "inconsistent orientation",
              bw_singular_edges(context, bad, NULL, 0, &edges));
  bw_release(bad);
  for (int t = 0; t < 12; t++) {
    triangle[3 * t] = box->triangle[3 * t + 1];
    triangle[3 * t + 1] = box->triangle[3 * t];
    triangle[3 * t + 2] = box->triangle[3 * t + 2];
  }
  check_ok(context,
           bw_surface_copy(context, box->point_count, box->point, 12, triangle, NULL, &bad));
  check_fails(context, BW_GEOMETRY, "normals of the surface point inwards",
              bw_singular_edges(context, bad, NULL, 0, &edges));
  check_fails(context, BW_INVALID, "not within 0 and 1.5",
              bw_singular_edges(context, box, NULL, 2, &edges));
  bw_release(bad);
  bw_release(box);
}

/* Memory that runs out anywhere is reported, and nothing is lost. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = notched(context, pi / 2, 1);
  bw_singular_places *edges = NULL;
  bw_status status = BW_MEMORY;
  int64_t n = 0;
  while (status == BW_MEMORY) {
    bw_fail_allocation(++n, false);
    status = bw_singular_edges(context, surface, NULL, 0, &edges);
    bw_fail_allocation(0, false);
  }
  assert_int_equal(status, BW_OK);
  assert_true(n > 20);
  assert_int_equal(edges->count, 1);
  bw_release(edges);
  bw_release(surface);
}

/* A nodal field that the elements hold is exact inside, and clamped outside. */
static void fields_at_points(void **state) {
  bw_context *context = check_context(state);
  static const double node[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const int32_t element[] = {0, 1, 2, 3};
  static const double point[] = {0.2, 0.3, 0.1, 2, 0, 0};
  bw_mesh *linear = NULL, *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, 1, 4, node, 1, element, NULL, &linear));
  for (int order = 1; order <= 2; order++) {
    bw_locator *locator = NULL;
    double value[20], out[4], outside[2];
    check_ok(context, bw_mesh_with_order(context, linear, order, &mesh));
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i;
      value[2 * i] = order == 2 ? x[0] * x[1] : x[0];
      value[2 * i + 1] = 1 + x[0] - 2 * x[2];
    }
    check_ok(context, bw_locator_create(context, mesh, &locator));
    check_ok(context, bw_mesh_sample(context, mesh, locator, 2, value, 2, point, out, outside));
    check_near(out[0], order == 2 ? 0.06 : 0.2, 1e-15);
    check_near(out[1], 1, 1e-15);
    check_near(out[2], order == 2 ? 0 : 1, 1e-15);
    check_near(out[3], 2, 1e-15);
    check_near(outside[0], 0, 1e-15);
    check_near(outside[1], 1, 1e-15);
    bw_release(locator);
    bw_release(mesh);
  }
  bw_release(linear);
}

check_main(check_test(exponents_of_free_edges), check_test(exponents_at_supports),
           check_test(notches_have_one_edge), check_test(an_l_section_has_one_edge),
           check_test(convex_and_round_bodies_have_none),
           check_test(facets_of_round_faces_are_no_edges),
           check_test(surfaces_without_an_inside_are_refused), check_test(memory_failures),
           check_test(fields_at_points))
