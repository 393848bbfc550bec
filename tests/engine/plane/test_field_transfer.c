/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Point location and fields transferred from mesh to mesh. */
#include "outlines.h"

static double distance_to(const double p[2], const double a[2], const double b[2]) {
  double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {p[0] - a[0], p[1] - a[1]};
  double t = fmin(fmax((u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1]), 0), 1);
  return hypot(v[0] - t * u[0], v[1] - t * u[1]);
}

/* Against a search through all elements. */
static void locating(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = block_mesh(context, 1, 1, 300);
  bw_plane_locator *locator = NULL;
  check_ok(context, bw_plane_locator_create(context, mesh, &locator));
  bw_random random;
  bw_random_seed(&random, 3);
  for (int trial = 0; trial < 2000; trial++) {
    double p[2] = {4 * bw_random_uniform(&random) - 0.5, 2 * bw_random_uniform(&random) - 0.5};
    double weight[3], outside, nearest = INFINITY;
    int32_t e = bw_plane_locate(locator, p, weight, &outside);
    for (int32_t i = 0; i < mesh->topology->element_count; i++) {
      const int32_t *n = mesh->topology->element + 3 * i;
      const double *x[3] = {mesh->point + 2 * n[0], mesh->point + 2 * n[1], mesh->point + 2 * n[2]};
      bool inside = true;
      double d = INFINITY;
      for (int k = 0; k < 3; k++) {
        const double *a = x[k], *b = x[(k + 1) % 3];
        inside &= (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0;
        d = fmin(d, distance_to(p, a, b));
      }
      nearest = fmin(nearest, inside ? 0 : d);
    }
    check_near(outside, nearest, 1e-12);
    double at[2] = {0, 0};
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 2; c++)
        at[c] += weight[k] * mesh->point[2 * mesh->topology->element[3 * e + k] + c];
    check_near(hypot(p[0] - at[0], p[1] - at[1]), outside, 1e-12);
  }
  double weight[3];
  assert_int_equal(bw_plane_locate(locator, (double[]){NAN, 0}, weight, NULL), 0);
  bw_plane_locator_destroy(locator);
  bw_release(mesh);
}

static double field(int order, const double x[2]) {
  return order == 1 ? 2 + x[0] - 3 * x[1]
                    : 1 + x[0] - x[1] + 0.5 * x[0] * x[0] - x[0] * x[1] + 2 * x[1] * x[1];
}

/* Polynomials of the mesh's order are transferred exactly from a straight-edged mesh. */
static void polynomials(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_outline *outline = box_outline(context, 2, 0.5, 1);
    bw_plane_mesh *from = mesh_on(context, outline, order, 300);
    bw_plane_mesh *to = mesh_on(context, outline, order, 500);
    int32_t n = from->topology->nodes->node_count, m = to->topology->nodes->node_count;
    double *value = malloc(sizeof(double) * 2 * (size_t)n);
    double *transferred = malloc(sizeof(double) * 2 * (size_t)m);
    for (int32_t i = 0; i < n; i++) {
      value[2 * i] = field(order, from->point + 2 * i);
      value[2 * i + 1] = -field(order, from->point + 2 * i);
    }
    check_ok(context, bw_plane_transfer(context, from, to, 2, value, transferred));
    for (int32_t i = 0; i < m; i++) {
      check_near(transferred[2 * i], field(order, to->point + 2 * i), 1e-12);
      check_near(transferred[2 * i + 1], -field(order, to->point + 2 * i), 1e-12);
    }
    free(value);
    free(transferred);
    bw_release(from);
    bw_release(to);
    bw_release(outline);
  }
}

/* Six-node triangles with flips: a quadratic field before a hole is moved. */
static void flipped_mid_edge_nodes(void **state) {
  bw_context *context = check_context(state);
  bw_outline *first = box_outline(context, 3, 1, 1.4), *outline = NULL;
  bw_plane_mesh *mesh = mesh_on(context, first, 2, 600);
  double place[16];
  memcpy(place, first->point, sizeof place);
  for (int i = 0; i < 8; i++)
    if (place[2 * i] > 0.9 && place[2 * i] < 1.5)
      place[2 * i] += 0.25;
  check_ok(context, bw_outline_moved(context, first, place, &outline));
  bw_follow_options options;
  bw_follow_options_default(&options);
  options.force = BW_LEVEL_RECONNECTING;
  bw_mesh_motion *motion = NULL;
  bw_follow_report report;
  check_ok(context, bw_mesh_motion_create(context, mesh, &options, &motion));
  check_ok(context, bw_mesh_motion_follow(context, motion, outline, &report));
  assert_int_equal(report.level, BW_LEVEL_RECONNECTING);
  assert_true(report.flips > 5);
  assert_ptr_equal(motion->mesh->topology->nodes, mesh->topology->nodes);
  int32_t n = mesh->topology->nodes->node_count;
  double *value = malloc(sizeof(double) * (size_t)n),
         *transferred = malloc(sizeof(double) * (size_t)n);
  for (int32_t i = 0; i < n; i++)
    value[i] = field(2, mesh->point + 2 * i);
  check_ok(context, bw_plane_transfer(context, mesh, motion->mesh, 1, value, transferred));
  /* on the old mesh's places of corners, the transferred field is the same quadratic one */
  const bw_plane_topology *t = motion->mesh->topology;
  int changed = 0;
  for (int32_t h = 0; h < 3 * t->element_count; h++) {
    const int32_t *e = t->element + h / 3 * 6;
    const double *a = mesh->point + 2 * e[h % 3], *b = mesh->point + 2 * e[(h % 3 + 1) % 3];
    double middle[2] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    check_near(transferred[e[3 + h % 3]], field(2, middle), 1e-12);
    changed += transferred[e[3 + h % 3]] != value[e[3 + h % 3]];
  }
  assert_true(changed > 0);
  free(value);
  free(transferred);
  bw_release(motion);
  bw_release(outline);
  bw_release(first);
  bw_release(mesh);
}

/* On curved sides the place is found in the curved element. */
static void curved_sides(void **state) {
  bw_context *context = check_context(state);
  shape s = {.points = 0};
  add_ellipse(&s, 0, "disc", 0, 0, 1, 1);
  bw_plane_mesh *mesh = mesh_of(context, &s, 2, 60);
  bw_plane_locator *locator = NULL;
  check_ok(context, bw_plane_locator_create(context, mesh, &locator));
  for (int i = 0; i < 360; i++) {
    double angle = i * 0.017453292519943295, r = 0.9985, weight[3], outside;
    double p[2] = {r * cos(angle), r * sin(angle)};
    bw_plane_locate(locator, p, weight, &outside);
    assert_true(outside < 1e-9);
    p[0] = 1.1 * cos(angle);
    p[1] = 1.1 * sin(angle);
    bw_plane_locate(locator, p, weight, &outside);
    check_near(outside, 0.1, 0.02);
  }
  bw_plane_locator_destroy(locator);
  bw_release(mesh);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_outline *outline = block_outline(context, 1);
  bw_plane_mesh *from = mesh_on(context, outline, 2, 60), *to = mesh_on(context, outline, 2, 90);
  double *value = calloc((size_t)from->topology->nodes->node_count, sizeof(double));
  double *transferred = calloc((size_t)to->topology->nodes->node_count, sizeof(double));
  check_each_allocation(context, status, 1) {
    status = bw_plane_transfer(context, from, to, 1, value, transferred);
  }
  check_fails(context, BW_INVALID, "components",
              bw_plane_transfer(context, from, to, 0, value, transferred));
  free(value);
  free(transferred);
  bw_release(from);
  bw_release(to);
  bw_release(outline);
}

check_main(check_test(locating), check_test(polynomials), check_test(flipped_mid_edge_nodes),
           check_test(curved_sides), check_test(memory_failures))
