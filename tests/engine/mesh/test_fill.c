/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling: volumes of shapes with closed forms, cavities, wanted numbers, sizes, limits, and with
 * BARWRIGHT_FULL=1 the table over all models. */
#include "check.h"

#include "mesh/fill_internal.h"
#include "mesh/surface_tree.h"

static const double pi = 3.14159265358979323846;

static bw_surface *box(bw_context *context, double low, double high) {
  double a[3] = {low, low, low}, b[3] = {high, high, high};
  bw_surface *surface;
  check_ok(context, bw_surface_box_shape(context, a, b, &surface));
  return surface;
}

static bw_surface *sphere(bw_context *context, double radius, int subdivisions) {
  double centre[3] = {0.1, 0.2, 0.3};
  bw_surface *surface;
  check_ok(context, bw_surface_sphere_shape(context, centre, radius, subdivisions, &surface));
  return surface;
}

/* Several surfaces as one; `turned` has a bit for each that is to face the other way. */
static bw_surface *join(bw_context *context, bw_surface **part, int count, unsigned turned) {
  int32_t points = 0, triangles = 0;
  for (int i = 0; i < count; i++) {
    points += part[i]->point_count;
    triangles += part[i]->triangle_count;
  }
  double *point = BW_NEW(context, double, 3 * points);
  int32_t *triangle = BW_NEW(context, int32_t, 3 * triangles);
  points = triangles = 0;
  for (int i = 0; i < count; i++) {
    memcpy(point + 3 * points, part[i]->point, 24 * (size_t)part[i]->point_count);
    for (int32_t t = 0; t < part[i]->triangle_count; t++)
      for (int k = 0; k < 3; k++)
        triangle[3 * (triangles + t) + (turned >> i & 1 ? 2 - k : k)] =
            part[i]->triangle[3 * t + k] + points;
    points += part[i]->point_count;
    triangles += part[i]->triangle_count;
    bw_release(part[i]);
  }
  bw_surface *all;
  check_ok(context, bw_surface_adopt(context, points, point, triangles, triangle, NULL, &all));
  return all;
}

/* Moves that are rounding are none. */
static void test_moves_by_rounding(void **state) {
  bw_context *context = check_context(state);
  bw_surface *cube = box(context, 0.1, 0.8);
  bw_mesh *mesh;
  bw_fill_log log;
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.elements = 3000;
  check_ok(context, bw_mesh_fill(context, cube, &options, &mesh, &log));
  assert_true(log.surface_moved == 0);
  bool reported = false;
  for (int i = 0; bw_warning_at(context, i); i++) {
    assert_null(strstr(bw_warning_at(context, i), "moved it"));
    reported |= strstr(bw_warning_at(context, i), "m: the boundary lies on the input") != NULL;
  }
  assert_true(reported);
  bw_release(mesh);
  bw_release(cube);
}

static void test_cube(void **state) {
  bw_context *context = check_context(state);
  bw_surface *cube = box(context, 0, 1);
  bw_mesh *mesh, *again;
  bw_mesh_quality q;
  bw_fill_log log;
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.elements = 3000;
  check_ok(context, bw_mesh_fill(context, cube, &options, &mesh, &log));
  check_near(bw_mesh_volume(mesh), 1, 1e-9);
  check_near(log.surface_moved, 0, 1e-9);
  assert_true(log.attempts >= 1 && !log.repaired);
  assert_true(abs(mesh->element_count - 3000) <= 450);
  bw_mesh_quality_of(mesh, &q);
  assert_true(q.dihedral_min > 5 * pi / 180);
  options.order = 2;
  check_ok(context, bw_mesh_fill(context, cube, &options, &again, NULL));
  assert_int_equal(again->nodes_per_element, 10);
  assert_int_equal(again->element_count, mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++) /* the same bits from run to run */
    for (int k = 0; k < 4; k++)
      assert_memory_equal(mesh->node + 3 * mesh->element[4 * e + k],
                          again->node + 3 * again->element[10 * e + k], 24);
  bw_release(again);
  bw_release(mesh);
  bw_release(cube);
}

/* A body in a cavity in a body, whichever way the shells face; and two bodies side by side. */
static void test_shells(void **state) {
  bw_context *context = check_context(state);
  for (unsigned turned = 0; turned < 8; turned += 7) {
    bw_surface *part[3] = {sphere(context, 1, 2), sphere(context, 0.6, 2), sphere(context, 0.3, 2)};
    double volume =
        bw_surface_volume(part[0]) - bw_surface_volume(part[1]) + bw_surface_volume(part[2]);
    bw_surface *nested = join(context, part, 3, turned ? 5 : 2);
    double *hole;
    int32_t holes;
    check_ok(context, bwi_find_cavities(context, nested, &hole, &holes));
    assert_int_equal(holes, 1);
    double r = hypot(hypot(hole[0] - 0.1, hole[1] - 0.2), hole[2] - 0.3);
    assert_true(r > 0.35 && r < 0.55);
    bw_free(hole);
    bw_fill_options options;
    bw_fill_options_default(&options);
    options.remesh = false;
    bw_mesh *mesh;
    check_ok(context, bw_mesh_fill(context, nested, &options, &mesh, NULL));
    assert_int_equal(mesh->component_count, 2);
    check_near(bw_mesh_volume(mesh), volume, 2e-3 * volume);
    bw_release(mesh);
    bw_release(nested);
  }
  bw_surface *pair[2] = {box(context, 0, 1), box(context, 1.5, 2)};
  bw_surface *two = join(context, pair, 2, 0);
  bw_mesh *mesh;
  check_ok(context, bw_mesh_fill(context, two, NULL, &mesh, NULL));
  assert_int_equal(mesh->component_count, 2);
  check_near(bw_mesh_volume(mesh), 1.125, 1e-6);
  bw_release(mesh);
  bw_release(two);
}

static void test_keep_surface(void **state) {
  bw_context *context = check_context(state);
  bw_surface *ball = sphere(context, 1, 3);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.keep_surface = true;
  options.elements = 8000;
  bw_mesh *mesh;
  bw_fill_log log;
  check_ok(context, bw_mesh_fill(context, ball, &options, &mesh, &log));
  assert_int_equal(mesh->facet_count, ball->triangle_count);
  check_near(bw_mesh_volume(mesh), bw_surface_volume(ball), 1e-12);
  check_near(log.surface_moved, 0, 0);
  assert_true(abs(mesh->element_count - 8000) <= 1200);
  bw_release(mesh);
  /* Fewer than the surface alone makes: the nearest there is, and a warning. */
  bw_clear_warnings(context);
  options.elements = 1000;
  check_ok(context, bw_mesh_fill(context, ball, &options, &mesh, &log));
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "1000 elements were requested"));
  bw_release(mesh);
  bw_release(ball);
}

static void test_max_volume(void **state) {
  bw_context *context = check_context(state);
  bw_surface *ball = sphere(context, 1, 3);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.max_volume = 1e-3;
  bw_mesh *mesh;
  bw_mesh_quality q;
  check_ok(context, bw_mesh_fill(context, ball, &options, &mesh, NULL));
  bw_mesh_quality_of(mesh, &q);
  assert_true(q.volume_max <= 1.5e-3); /* the optimisation at the end may exceed the bound */
  bw_release(mesh);
  bw_release(ball);
}

/* Mean edge length of the elements whose middle lies in a shell around a point. */
static double mean_edge(const bw_mesh *mesh, const double at[3], double from, double to) {
  double sum = 0;
  int64_t count = 0;
  for (int32_t i = 0; i < mesh->element_count; i++) {
    const double *x[4];
    double d[3] = {-at[0], -at[1], -at[2]};
    for (int k = 0; k < 4; k++) {
      x[k] = mesh->node + 3 * mesh->element[4 * i + k];
      for (int j = 0; j < 3; j++)
        d[j] += x[k][j] / 4;
    }
    double r = bw_norm(d);
    if (r < from || r > to)
      continue;
    for (int k = 0; k < 6; k++) {
      double e[3];
      for (int j = 0; j < 3; j++)
        e[j] = x[bw_tet_edge[k][1]][j] - x[bw_tet_edge[k][0]][j];
      sum += bw_norm(e);
      count++;
    }
  }
  return count ? sum / (double)count : 0;
}

static double by_height(void *data, const double at[3]) {
  (void)data;
  return at[2] > 0.8 ? 0.05 : 0;
}

static double no_length(void *data, const double at[3]) {
  (void)data;
  return at[0] > 0.5 ? NAN : 0.3;
}

static void test_sizes(void **state) {
  bw_context *context = check_context(state);
  bw_surface *cube = box(context, 0, 1);
  bw_mesh *mesh;
  bw_fill_options options;
  bw_size_point corner = {{0, 0, 0}, 0.1, 0.03};
  bw_fill_options_default(&options);
  options.elements = 4000;
  options.size_point_count = 1;
  options.size_point = &corner;
  check_ok(context, bw_mesh_fill(context, cube, &options, &mesh, NULL));
  double near = mean_edge(mesh, corner.at, 0, 0.1), middle = mean_edge(mesh, corner.at, 0.35, 0.45);
  double far = mean_edge(mesh, corner.at, 1, 2);
  assert_true(near > 0.6 * 0.03 && near < 1.15 * 0.03);
  assert_true(middle < 1.15 * (0.03 + 0.3 * 0.35)); /* grows by 0.3 per distance */
  assert_true(far > 2.5 * near);
  check_near(bw_mesh_volume(mesh), 1, 1e-6);
  bw_release(mesh);
  options.size_point_count = 0;
  options.elements = 0;
  options.max_volume = 1e-2;
  options.size = by_height;
  check_ok(context, bw_mesh_fill(context, cube, &options, &mesh, NULL));
  double top[3] = {0.5, 0.5, 1}, bottom[3] = {0.5, 0.5, 0};
  assert_true(mean_edge(mesh, top, 0, 0.15) < 1.2 * 0.05);
  assert_true(mean_edge(mesh, bottom, 0, 0.3) > 0.1);
  bw_release(mesh);
  options.size = no_length;
  check_fails(context, BW_INVALID, "no length", bw_mesh_fill(context, cube, &options, &mesh, NULL));
  bw_release(cube);
}

/* Half a pipe with a thin wall, coarsened to edges eight times its thickness: still sound, its
 * walls still apart. */
static void half_pipe(void *data, const double unit[3], double out[3]) {
  (void)data;
  double r = 0.9 + 0.05 * unit[2], angle = pi * unit[0];
  out[0] = r * cos(angle);
  out[1] = r * sin(angle);
  out[2] = 1.5 * unit[1];
}

static bw_status coarsen(bw_context *context, const bw_surface *surface, double length,
                         double shorter, double error, double seconds, bw_surface **coarsened) {
  const bwi_coarsen_options options = {
      .length = length, .shorter = shorter, .error = error, .seconds = seconds};
  return bwi_coarsen_surface(context, surface, &options, coarsened);
}

static void test_coarsen(void **state) {
  bw_context *context = check_context(state);
  int cells[3] = {90, 45, 2};
  bw_mesh *grid;
  bw_surface *fine, *coarse;
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, half_pipe, NULL, &grid));
  check_ok(context, bw_mesh_boundary(context, grid, &fine, NULL));
  bw_release(grid);
  check_fails(context, BW_LIMIT, "seconds of computing",
              coarsen(context, fine, 0.4, 0.3, 0.02, 1e-9, &coarse));
  check_ok(context, coarsen(context, fine, 0.4, 0.3, 0.02, 300, &coarse));
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, coarse, 0, &report));
  assert_true(report.sound);
  bw_surface_report_clear(&report);
  assert_true(coarse->triangle_count < fine->triangle_count / 8);
  double volume = bw_surface_volume(fine);
  check_near(bw_surface_volume(coarse), volume, 0.2 * volume);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.elements = 2500;
  bw_mesh *mesh;
  check_ok(context, bw_mesh_fill(context, fine, &options, &mesh, NULL));
  assert_true(abs(mesh->element_count - 2500) <= 500);
  bw_release(mesh);
  bw_release(coarse);
  bw_release(fine);
}

static void test_refine(void **state) {
  bw_context *context = check_context(state);
  bw_surface *cube = box(context, 0, 1), *fine, *none;
  bw_size_point corner = {{1, 1, 1}, 0.1, 0.02};
  bw_size_field field = {.point_count = 1, .point = &corner};
  check_ok(context, bwi_refine_surface(context, cube, &field, 1.0, 100000, 300, &fine));
  bw_surface_report report;
  check_ok(context, bw_surface_check(context, fine, 0, &report));
  assert_true(report.sound);
  bw_surface_report_clear(&report);
  check_near(bw_surface_volume(fine), 1, 1e-12);
  for (int32_t t = 0; t < fine->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = fine->point + 3 * fine->triangle[3 * t + k];
      const double *b = fine->point + 3 * fine->triangle[3 * t + (k + 1) % 3];
      double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
      double m[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
      assert_true(bw_norm(d) <= bwi_size_at(&field, m) * (1 + 1e-12));
    }
  assert_true(fine->triangle_count < 20000);
  check_fails(context, BW_LIMIT, "facets",
              bwi_refine_surface(context, cube, &field, 1.0, 500, 300, &none));
  check_fails(context, BW_LIMIT, "seconds of computing",
              bwi_refine_surface(context, cube, &field, 1.0, 100000, 1e-9, &none));
  bw_release(fine);
  bw_release(cube);
}

/* ---- surfaces by marching tetrahedra: many tiny facets and needles ------------------------- */

static double wall; /* of the dome: the outer radius is 1 */

static double dome(void *data, const double at[3]) {
  (void)data;
  return fmax(fabs(bw_norm(at) - 1 + wall / 2) - wall / 2, -at[2]);
}

static double two_limbs(void *data, const double at[3]) {
  (void)data;
  double trunk = hypot(hypot(fmax(fabs(at[0]) - 0.6, 0), at[1]), at[2]) - 0.3;
  double leg = hypot(hypot(at[0] - 0.4, at[1]), fmax(fabs(at[2] + 0.4) - 0.4, 0)) - 0.08;
  return fmin(trunk, leg);
}

static bw_surface *marching(bw_context *context, double (*f)(void *, const double *), int cells) {
  const double low[3] = {-1.083, -1.091, -0.987}, high[3] = {1.102, 1.097, 1.093};
  bw_surface *surface;
  check_ok(context, bw_surface_implicit(context, low, high, cells, f, NULL, &surface));
  return surface;
}

static void test_marching(void **state) {
  bw_context *context = check_context(state);
  struct {
    double (*f)(void *, const double *);
    double wall, length;
    int cells, facets; /* at most so many are left */
  } const shape[] = {{dome, 0.12, 0.3, 36, 900}, {two_limbs, 0, 0.15, 40, 900}};
  for (int i = 0; i < 2; i++) {
    wall = shape[i].wall;
    bw_surface *fine = marching(context, shape[i].f, shape[i].cells), *coarse;
    check_ok(context, coarsen(context, fine, shape[i].length, 0.8 * shape[i].length,
                              0.05 * shape[i].length, 300, &coarse));
    bw_surface_report report;
    check_ok(context, bw_surface_check(context, coarse, 0, &report));
    assert_true(report.sound);
    bw_surface_report_clear(&report);
    assert_true(coarse->triangle_count < shape[i].facets);
    double moved, volume = bw_surface_volume(fine);
    check_ok(context, bw_surface_distance(context, fine, coarse, &moved));
    assert_true(moved < 0.25 * shape[i].length);
    check_near(bw_surface_volume(coarse), volume, 0.08 * volume);
    bw_release(coarse);
    bw_fill_options options;
    bw_fill_options_default(&options);
    options.elements = 2000;
    bw_mesh *mesh;
    check_ok(context, bw_mesh_fill(context, fine, &options, &mesh, NULL));
    assert_true(abs(mesh->element_count - 2000) <= 300);
    bw_release(mesh);
    bw_release(fine);
  }
}

/* A wall thinner than the grid comes out full of tunnels: the count cannot be met, which is
 * reported, and the body stays what it was. */
static void test_tunnels(void **state) {
  bw_context *context = check_context(state);
  wall = 0.05;
  bw_surface *fine = marching(context, dome, 36);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.elements = 2500;
  bw_mesh *mesh;
  bw_clear_warnings(context);
  check_ok(context, bw_mesh_fill(context, fine, &options, &mesh, NULL));
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "tunnels"));
  check_near(bw_mesh_volume(mesh), bw_surface_volume(fine), 0.15 * bw_surface_volume(fine));
  bw_release(mesh);
  bw_release(fine);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_surface *cube = box(context, 0, 1), *open;
  bw_mesh *mesh;
  bw_fill_options options;
  check_ok(context, bw_surface_copy(context, cube->point_count, cube->point,
                                    cube->triangle_count - 1, cube->triangle, NULL, &open));
  bw_fill_options_default(&options);
  options.repair = false;
  check_fails(context, BW_GEOMETRY, "not closed (3 x open edge)",
              bw_mesh_fill(context, open, &options, &mesh, NULL));
  options.repair = true;
  bw_fill_log log;
  check_ok(context, bw_mesh_fill(context, open, &options, &mesh, &log));
  assert_true(log.repaired);
  check_near(bw_mesh_volume(mesh), 1, 1e-6);
  bw_release(mesh);
  bw_release(open);
  check_ok(context, bw_surface_copy(context, 0, NULL, 0, NULL, NULL, &open));
  check_fails(context, BW_GEOMETRY, "no facets", bw_mesh_fill(context, open, NULL, &mesh, NULL));
  bw_release(open);

  options.order = 3;
  check_fails(context, BW_INVALID, "order 3", bw_mesh_fill(context, cube, &options, &mesh, NULL));
  bw_fill_options_default(&options);
  options.radius_edge = 0.5;
  check_fails(context, BW_INVALID, "radius_edge",
              bw_mesh_fill(context, cube, &options, &mesh, NULL));
  bw_fill_options_default(&options);
  options.elements = -5;
  check_fails(context, BW_INVALID, "-5 elements",
              bw_mesh_fill(context, cube, &options, &mesh, NULL));
  bw_fill_options_default(&options);
  options.sharp_angle = 0;
  check_fails(context, BW_INVALID, "sharp_angle 0",
              bw_mesh_fill(context, cube, &options, &mesh, NULL));

  /* Limits: some hundred thousand elements in a fifth of a second or twenty megabytes. */
  bw_fill_options_default(&options);
  options.max_volume = 1e-5;
  options.time_limit = 0.2;
  check_fails(context, BW_LIMIT, "seconds", bw_mesh_fill(context, cube, &options, &mesh, NULL));
  /* Time that runs out is a failure: another way, or a nearer try, would depend on the machine. */
  bw_fill_options_default(&options);
  options.elements = 200000;
  options.time_limit = 0.2;
  check_fails(context, BW_LIMIT, "seconds", bw_mesh_fill(context, cube, &options, &mesh, NULL));
  bw_fill_options_default(&options);
  options.time_limit = 60;
  options.max_volume = 1e-6;
  options.remesh = false;
  options.memory_limit = 2e7;
#ifndef __SANITIZE_ADDRESS__ /* whose shadow does not fit into any limit */
  check_fails(context, BW_LIMIT, "memory", bw_mesh_fill(context, cube, &options, &mesh, NULL));
#endif
  bw_cancel(context);
  assert_int_equal(bw_mesh_fill(context, cube, NULL, &mesh, NULL), BW_CANCELLED);
  bw_clear_cancel(context);
  bw_release(cube);
}

/* TetGen itself must refuse what cuts through itself, with a message and no crash of ours. */
static void test_crossing(void **state) {
  bw_context *context = check_context(state);
  bw_surface *pair[2] = {box(context, 0, 1), box(context, 0.5, 1.7)};
  bw_surface *crossing = join(context, pair, 2, 0);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.repair = false;
  options.keep_surface = true;
  bw_mesh *mesh = NULL;
  bw_status status = bw_mesh_fill(context, crossing, &options, &mesh, NULL);
  assert_int_equal(status, BW_GEOMETRY);
  assert_true(strlen(bw_message(context)) > 10);
  bw_fill_options_default(&options);
  check_ok(context, bw_mesh_fill(context, crossing, &options, &mesh, NULL));
  double both = 1 + 1.2 * 1.2 * 1.2 - 0.125; /* the union, or near it if it had to be wrapped */
  check_near(bw_mesh_volume(mesh), both, 0.05 * both);
  bw_release(mesh);
  bw_release(crossing);
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_surface *part[2] = {box(context, 0, 1), box(context, 0.25, 0.75)};
  bw_surface *hollow = join(context, part, 2, 2);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.order = 2;
  bw_size_point point = {{0, 0, 0}, 0.1, 0.4};
  options.size_point = &point;
  options.size_point_count = 1;
  check_each_allocation(context, status, 1) {
    bw_surface *made = NULL;
    status = coarsen(context, hollow, 1, 0.8, 0.1, 300, &made);
    bw_release(made);
  }
  bw_status status = BW_MEMORY;
  int64_t step = getenv("BARWRIGHT_FULL") ? 1 : 7;
  for (int64_t n = 1; status != BW_OK; n += step) {
    bw_mesh *mesh = NULL;
    bw_fail_allocation(n, true);
    status = bw_mesh_fill(context, hollow, &options, &mesh, NULL);
    bw_fail_allocation(0, false);
    if (status != BW_OK && status != BW_MEMORY)
      fail_msg("allocation %lld: %s (%s)", (long long)n, bw_status_word(status),
               bw_message(context));
    bw_release(mesh);
  }
  bw_release(hollow);
}

/* A flat element that meets the boundary with a needle stays: without it a point far inside would
 * come to light. */
static void test_needle_is_not_peeled(void **state) {
  bw_context *context = check_context(state);
  static const double x[] = {0,   0, 0,  1,   0.01, 0,  1,    -0.01, 0,
                             0.9, 1, -1, 0.9, -1,   -1, 0.75, 0,     -0.3};
  static const int32_t e[] = {0, 1, 2, 5, 1, 0, 3, 5, 0, 2, 4, 5,
                              3, 0, 4, 5, 2, 1, 3, 5, 4, 2, 3, 5};
  bw_mesh *mesh;
  int64_t gone;
  double moved;
  check_ok(context, bw_mesh_copy(context, 1, 6, x, 6, e, NULL, &mesh));
  assert_int_equal(mesh->boundary_node_count, 5);
  check_ok(context, bwi_peel_flat(context, &mesh, 0.05, HUGE_VAL, &gone, &moved));
  assert_int_equal(gone, 0);
  assert_int_equal(mesh->boundary_node_count, 5);
  bw_release(mesh);
}

/* A tolerance bounds how far the surface moves; near a point with short edges it is followed more
 * closely than elsewhere. */
/* A pyramid over a square of two elements, and below it a third one that lies in the base: it has
 * no volume, and goes. One that does not lie on the boundary stays. */
static void test_degenerate_is_peeled(void **state) {
  bw_context *context = check_context(state);
  const double node[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1, 0.5, 0.5, -1};
  const int32_t element[] = {0, 1, 2, 4, 0, 2, 3, 4, 0, 1, 2, 3, 0, 1, 3, 5, 1, 2, 3, 5};
  for (int inside = 0; inside < 2; inside++) {
    bwi_tetgen_result result = {.node_count = 6, .element_count = inside ? 5 : 3};
    result.node = BW_NEW(context, double, 18);
    result.element = BW_NEW(context, int32_t, 20);
    assert_non_null(result.node);
    assert_non_null(result.element);
    memcpy(result.node, node, sizeof node);
    memcpy(result.element, element, sizeof element);
    check_ok(context, bwi_peel_degenerate(context, &result, 1e-12));
    assert_int_equal(result.element_count, inside ? 5 : 2);
    assert_int_equal(result.node_count, inside ? 6 : 5);
    if (!inside) {
      bw_mesh *mesh;
      check_ok(context, bw_mesh_adopt(context, 1, result.node_count, result.node,
                                      result.element_count, result.element, NULL, &mesh));
      check_near(bw_mesh_volume(mesh), 1.0 / 3, 1e-15);
      assert_int_equal(mesh->facet_count, 6);
      bw_release(mesh);
    } else {
      bw_free(result.node);
      bw_free(result.element);
    }
  }
}

static void test_surface_tolerance(void **state) {
  bw_context *context = check_context(state);
  bw_surface *fine = marching(context, two_limbs, 40), *remeshed;
  const double allowed = 0.02;
  double moved, near = 0;
  bw_remesh_options opts;
  bw_remesh_options_default(&opts);
  opts.edge_length = 0.3;
  opts.tolerance = allowed;
  check_ok(context, bw_surface_remesh(context, fine, &opts, &remeshed, NULL));
  check_ok(context, bw_surface_distance(context, fine, remeshed, &moved));
  assert_true(moved <= 1.001 * allowed);
  bw_release(remeshed);

  bw_size_point point = {.radius = 0.15, .length = 0.06};
  memcpy(point.at, fine->point, sizeof point.at);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.edge_length = 0.3;
  options.surface_tolerance = allowed;
  options.size_point_count = 1;
  options.size_point = &point;
  bw_mesh *mesh;
  bw_surface *boundary;
  check_ok(context, bw_mesh_fill(context, fine, &options, &mesh, NULL));
  check_ok(context, bw_mesh_boundary(context, mesh, &boundary, NULL));
  check_ok(context, bw_surface_distance(context, fine, boundary, &moved));
  assert_true(moved <= 1.1 * allowed);
  bwi_tree *tree;
  check_ok(context, bwi_tree_create(context, fine->point, fine->triangle_count, fine->triangle,
                                    NULL, &tree));
  for (int32_t i = 0; i < boundary->point_count; i++) {
    const double *x = boundary->point + 3 * (int64_t)i;
    double d[3] = {x[0] - point.at[0], x[1] - point.at[1], x[2] - point.at[2]}, place[3];
    int32_t facet;
    if (bw_norm(d) < point.radius)
      near = fmax(near, sqrt(bwi_tree_nearest(tree, x, -1, 0, place, &facet)));
  }
  assert_true(near < 0.1 * point.length);
  bwi_tree_destroy(tree);
  bw_release(boundary);
  bw_release(mesh);
  bw_release(fine);
}

/* ---- the table over all models -------------------------------------------------------------- */

static void test_models(void **state) {
  bw_context *context = check_context(state);
  static const char *const model[] = {
      "bottle_opener_round.stl", "triceratops.off", "chair.ply",    "engine_bracket.obj",
      "rocker_arm.obj",          "fandisk.obj",     "anchor.off",   "tray_bottom.stl",
      "fan_blade.stl",           "fertility.off",   "boot.obj",     "cat.obj",
      "screwdriver.ply",         "gear_spur.stl",   "armadillo.obj"};
  static const int target[] = {5000, 20000, 100000, 400000};
  const char *shared = getenv("BARWRIGHT_SHARED");
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  for (size_t m = full ? 0 : 13; m < (full ? 15u : 14u); m++) {
    char path[1000];
    bw_surface *surface;
    snprintf(path, sizeof path, "%s/models/%s", shared ? shared : "../shared", model[m]);
    FILE *file = fopen(path, "rb");
    if (!file)
      continue;
    fclose(file);
    check_ok(context, bw_surface_read(context, path, &surface, NULL));
    for (int t = 0; t < (full ? 4 : 1); t++) {
      bw_fill_options options;
      bw_fill_options_default(&options);
      options.elements = target[t];
      bw_mesh *mesh;
      bw_fill_log log;
      bw_mesh_quality q;
      double low[3], high[3], start = bw_seconds();
      bw_surface_box(surface, low, high);
      double size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
      check_ok(context, bw_mesh_fill(context, surface, &options, &mesh, &log));
      bw_mesh_quality_of(mesh, &q);
      double ratio = (double)mesh->element_count / target[t];
      printf("%-24s %6d %6d  %4.2f  %2d attempts %6.1f s  moved %.3f %%  dihedral %5.2f to %6.2f\n",
             model[m], target[t], mesh->element_count, ratio, log.attempts, bw_seconds() - start,
             100 * log.surface_moved / size, q.dihedral_min * 180 / pi, q.dihedral_max * 180 / pi);
      fflush(stdout);
      assert_true(ratio > 0.8 && ratio < 1.2);
      double volume = fabs(bw_surface_volume(surface));
      check_near(bw_mesh_volume(mesh), volume, 0.06 * volume);
      assert_true(log.surface_moved < 0.03 * size);
      bw_release(mesh);
    }
    bw_release(surface);
  }
}

check_main(check_test(test_moves_by_rounding), check_test(test_cube), check_test(test_shells),
           check_test(test_keep_surface), check_test(test_max_volume), check_test(test_sizes),
           check_test(test_coarsen), check_test(test_refine), check_test(test_refusals),
           check_test(test_crossing), check_test(test_allocation_failures),
           check_test(test_marching), check_test(test_surface_tolerance),
           check_test(test_needle_is_not_peeled), check_test(test_degenerate_is_peeled),
           check_test(test_tunnels), check_test(test_models))
