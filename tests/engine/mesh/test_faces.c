/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Faces of shapes by formula, and what filling leaves of them. */
#include "prism.h"

#include "barwright/faces.h"

static const double pi = 3.14159265358979323846;

static const double middle[2] = {0, 0};

enum { ARC = 8, ROUNDED = 4 * (ARC + 1) };

/* A rectangle of 2 x 1 with corners of radius 0.2. */
static bw_surface *rounded_block(bw_context *context) {
  static const double centre[4][2] = {{0.8, 0.3}, {-0.8, 0.3}, {-0.8, -0.3}, {0.8, -0.3}};
  double profile[ROUNDED][2];
  for (int c = 0; c < 4; c++)
    for (int i = 0; i <= ARC; i++) {
      double angle = pi / 2 * (c + (double)i / ARC);
      profile[c * (ARC + 1) + i][0] = centre[c][0] + 0.2 * cos(angle);
      profile[c * (ARC + 1) + i][1] = centre[c][1] + 0.2 * sin(angle);
    }
  return prism(context, ROUNDED, (const double(*)[2])profile, middle, 0.5, 1);
}

static bw_surface *frustum(bw_context *context, int n, double top) {
  double profile[100][2];
  for (int i = 0; i < n; i++) {
    profile[i][0] = 0.4 * cos(2 * pi * i / n);
    profile[i][1] = 0.4 * sin(2 * pi * i / n);
  }
  return prism(context, n, (const double(*)[2])profile, middle, 0.5, top);
}

static int count_of(const bw_faces *faces, bw_face_kind kind) {
  int count = 0;
  for (int32_t i = 0; i < faces->count; i++)
    count += faces->face[i].kind == kind;
  return count;
}

static void shapes_have_their_faces(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0, 0, 0}, high[3] = {3, 2, 1}, axis[3] = {1, 2, 2}, centre[3] = {1, 1, 1};
  bw_surface *surface = NULL;
  bw_faces *faces = NULL;
  /* the corners of a box lie on a sphere, and it is none */
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_ok(context, bw_faces_find(context, surface, 0, &faces));
  assert_int_equal(faces->count, 6);
  assert_int_equal(count_of(faces, BW_FACE_PLANE), 6);
  check_near(faces->face[0].area, 6, 1e-14);
  check_near(fabs(faces->face[0].normal[2]), 1, 1e-15);
  check_near(faces->face[5].area, 2, 1e-14);
  const double side[3] = {3.5, 1, 0.4};
  check_near(faces->face[bw_faces_near(faces, surface, side)].axis[0], 1, 1e-15);
  bw_release(faces);
  bw_release(surface);
  check_ok(context, bw_surface_cylinder_shape(context, centre, axis, 0.5, 48, &surface));
  check_ok(context, bw_faces_find(context, surface, 0, &faces));
  assert_int_equal(faces->count, 3);
  assert_int_equal(faces->face[0].kind, BW_FACE_CYLINDER);
  assert_int_equal(count_of(faces, BW_FACE_PLANE), 2);
  check_near(faces->face[0].radius, 0.5, 1e-13);
  check_near(fabs(bw_dot(faces->face[0].axis, axis)) / 3, 1, 1e-14);
  assert_true(faces->face[0].residual < 1e-13);
  bw_release(faces);
  bw_release(surface);
  check_ok(context, bw_surface_sphere_shape(context, centre, 0.7, 3, &surface));
  check_ok(context, bw_faces_find(context, surface, 0, &faces));
  assert_int_equal(faces->count, 1);
  assert_int_equal(faces->face[0].kind, BW_FACE_SPHERE);
  check_near(faces->face[0].radius, 0.7, 1e-13);
  check_near(faces->face[0].point[1], 1, 1e-13);
  bw_release(faces);
  bw_release(surface);
  surface = frustum(context, 40, 0.5);
  check_ok(context, bw_faces_find(context, surface, 0, &faces));
  assert_int_equal(faces->count, 3);
  int32_t cone = 0;
  while (faces->face[cone].kind == BW_FACE_PLANE)
    cone++;
  assert_int_equal(faces->face[cone].kind, BW_FACE_CONE);
  check_near(fabs(faces->face[cone].slope), 0.4, 1e-10);
  const double on[3] = {0.3, 0, 0.25}, off[3] = {0.3 + 0.1, 0, 0.25};
  double gradient[3];
  check_near(bw_face_distance(&faces->face[cone], on, NULL), 0, 1e-12);
  check_near(bw_face_distance(&faces->face[cone], off, gradient), 0.1 / sqrt(1.16), 1e-12);
  check_near(gradient[2], 0.4 / sqrt(1.16), 1e-10);
  bw_release(faces);
  bw_release(surface);
}

/* Planes that run smoothly into fillets are parted from them. */
static void fillets_are_parted_from_planes(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = rounded_block(context);
  bw_faces *faces = NULL;
  double area = 0;
  check_ok(context, bw_faces_find(context, surface, 0, &faces));
  assert_int_equal(count_of(faces, BW_FACE_PLANE), 6);
  assert_int_equal(count_of(faces, BW_FACE_CYLINDER), 4);
  assert_int_equal(faces->count, 10);
  for (int32_t i = 0; i < faces->count; i++) {
    area += faces->face[i].area;
    if (faces->face[i].kind != BW_FACE_CYLINDER)
      continue;
    check_near(faces->face[i].radius, 0.2, 1e-12);
    check_near(faces->face[i].area, 0.5 * ARC * 0.4 * sin(pi / 4 / ARC), 1e-12);
  }
  check_near(area, bw_surface_area(surface), 1e-13);
  bw_release(faces);
  bw_release(surface);
  const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  check_ok(context, bw_surface_box_shape(context, low, high, &surface));
  check_fails(context, BW_INVALID, "not within 0 and 1.5",
              bw_faces_find(context, surface, 2, &faces));
  bw_release(surface);
}

/* Flat stays flat and round stays on its radius, to rounding, at every size. */
static void faces_survive_filling(void **state) {
  bw_context *context = check_context(state);
  static const int64_t elements[] = {600, 3000};
  for (int shape = 0; shape < 3; shape++)
    for (int i = 0; i < 2; i++) {
      const double low[3] = {0, 0, 0}, high[3] = {3, 2, 1}, axis[3] = {0.2, 0.4, 0.4};
      bw_surface *surface = NULL, *boundary = NULL;
      bw_faces *faces = NULL;
      bw_mesh *mesh = NULL;
      bw_fill_options options;
      bw_fill_options_default(&options);
      options.elements = elements[i];
      options.tolerance = 0.5;
      if (shape == 0)
        check_ok(context, bw_surface_box_shape(context, low, high, &surface));
      else if (shape == 1)
        check_ok(context, bw_surface_cylinder_shape(context, low, axis, 0.15, 40, &surface));
      else
        surface = rounded_block(context);
      check_ok(context, bw_faces_find(context, surface, 0, &faces));
      check_ok(context, bw_mesh_fill(context, surface, &options, &mesh, NULL));
      check_ok(context, bw_mesh_boundary(context, mesh, &boundary, NULL));
      int64_t off = 0;
      for (int32_t p = 0; p < boundary->point_count; p++) {
        double min = HUGE_VAL;
        for (int32_t f = 0; f < faces->count; f++)
          min = fmin(min, fabs(bw_face_distance(&faces->face[f], boundary->point + 3 * p, NULL)));
        off += min > 1e-13;
      }
      assert_int_equal(off, 0);
      if (shape == 0)
        check_near(bw_surface_area(boundary), 22, 22e-12);
      bw_release(boundary);
      bw_release(mesh);
      bw_release(faces);
      bw_release(surface);
    }
}

static double facet_area(const bw_surface *surface, int32_t t) {
  const double *x[3];
  double u[3], v[3], n[3];
  for (int k = 0; k < 3; k++)
    x[k] = surface->point + 3 * (size_t)surface->triangle[3 * (size_t)t + (size_t)k];
  for (int k = 0; k < 3; k++) {
    u[k] = x[1][k] - x[0][k];
    v[k] = x[2][k] - x[0][k];
  }
  bw_cross(u, v, n);
  return bw_norm(n) / 2;
}

/* The borders of faces are kept at every size: planes keep their areas to 1e-6, round faces to half
 * a per cent, and the count is met. */
static void areas_survive_filling(void **state) {
  bw_context *context = check_context(state);
  static const int64_t elements[] = {6000, 9000, 12000};
  for (int shape = 0; shape < 4; shape++)
    for (int i = 0; i < 3; i++) {
      const double low[3] = {0, 0, 0}, axis[3] = {0.2, 0.4, 0.4};
      bw_surface *surface = NULL, *boundary = NULL;
      bw_faces *faces = NULL;
      bw_mesh *mesh = NULL;
      bw_fill_options options;
      bw_fill_options_default(&options);
      options.elements = elements[i];
      if (shape == 0)
        check_ok(context, bw_surface_cylinder_shape(context, low, axis, 0.15, 40, &surface));
      else if (shape == 1)
        check_ok(context, bw_surface_sphere_shape(context, low, 0.7, 4, &surface));
      else
        surface = shape == 2 ? rounded_block(context) : frustum(context, 40, 0.5);
      check_ok(context, bw_faces_find(context, surface, 0, &faces));
      check_ok(context, bw_mesh_fill(context, surface, &options, &mesh, NULL));
      check_near((double)mesh->element_count / (double)elements[i], 1, 0.151);
      check_ok(context, bw_mesh_boundary(context, mesh, &boundary, NULL));
      int32_t *label = malloc((size_t)mesh->facet_count * sizeof *label);
      double *area = calloc((size_t)faces->count, sizeof *area);
      assert_true(label && area);
      check_ok(context, bw_faces_on_mesh(context, surface, faces, mesh, label));
      for (int32_t t = 0; t < mesh->facet_count; t++) {
        assert_true(label[t] >= 0);
        area[label[t]] += facet_area(boundary, t);
      }
      for (int32_t f = 0; f < faces->count; f++)
        check_near(area[f] / faces->face[f].area, 1,
                   faces->face[f].kind == BW_FACE_PLANE ? 1e-6 : 5e-3);
      free(label);
      free(area);
      bw_release(boundary);
      bw_release(mesh);
      bw_release(faces);
      bw_release(surface);
    }
}

check_main(check_test(shapes_have_their_faces), check_test(fillets_are_parted_from_planes),
           check_test(faces_survive_filling), check_test(areas_survive_filling))
