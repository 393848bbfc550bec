/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Plane meshes from arrays: topology, checks, areas, moving. */
#include "check.h"

static const double LOW[2] = {0, 0}, HIGH[2] = {3, 2};

/* Every edge is shared by two elements that name each other, or is a side. */
static void check_topology(const bw_plane_mesh *mesh) {
  const bw_plane_topology *t = mesh->topology;
  int width = t->nodes->order == 2 ? 6 : 3, per = t->nodes->order == 2 ? 3 : 2;
  int32_t open = 0, outer = 0;
  for (int32_t h = 0; h < 3 * t->element_count; h++) {
    int32_t other = t->neighbour[h];
    open += other < 0;
    if (other < 0)
      continue;
    const int32_t *n = t->element + h / 3 * width, *m = t->element + other * width;
    bool found = false;
    for (int k = 0; k < 3; k++)
      found |= m[k] == n[(h % 3 + 1) % 3] && m[(k + 1) % 3] == n[h % 3] &&
               t->neighbour[3 * other + k] == h / 3 && (width == 3 || m[3 + k] == n[3 + h % 3]);
    assert_true(found);
  }
  for (int32_t i = 0; i < t->side_count; i++) {
    const int32_t *s = t->side + per * i;
    outer += t->side_element[2 * i] < 0 || t->side_element[2 * i + 1] < 0;
    for (int j = 0; j < 2; j++) {
      int32_t e = t->side_element[2 * i + j];
      bool found = e < 0;
      for (int k = 0; k < 3 && !found; k++) {
        const int32_t *n = t->element + e * width;
        found = n[k] == s[j] && n[(k + 1) % 3] == s[1 - j] && (per == 2 || n[3 + k] == s[2]);
      }
      assert_true(found);
    }
    assert_int_equal(t->nodes->segment[s[0]], t->side_segment[i]);
  }
  assert_int_equal(open, outer);
}

static void rectangles(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int diagonal = 0; diagonal < 3; diagonal++) {
      bw_plane_mesh *mesh = NULL;
      check_ok(context,
               bw_plane_rectangle(context, order, LOW, HIGH, 6, 4, (bw_diagonal)diagonal, &mesh));
      check_topology(mesh);
      const bw_plane_topology *t = mesh->topology;
      assert_int_equal(t->element_count, 48);
      assert_int_equal(t->nodes->corner_count, 35);
      assert_int_equal(t->nodes->node_count, order == 2 ? 13 * 9 : 35);
      assert_int_equal(t->side_count, 20);
      assert_int_equal(mesh->outline->segment_count, 4);
      bw_plane_quality quality;
      bw_plane_measure(mesh, &quality);
      check_near(quality.area, 6, 1e-12);
      /* an isosceles right triangle: 2 sqrt(3) (1 - sqrt(1/2)) / sqrt(2) */
      check_near(quality.worst, 0.7174389352143009, 1e-12);
      check_near(quality.mean, quality.worst, 1e-12);
      check_near(quality.smallest_angle, 45, 1e-9);
      check_near(quality.largest_angle, 90, 1e-9);
      assert_int_equal(quality.inverted, 0);
      bw_release(mesh);
    }
}

static void copies(void **state) {
  bw_context *context = check_context(state);
  /* a square with a square hole, two regions */
  double point[16] = {0, 0, 3, 0, 3, 3, 0, 3, 1, 1, 2, 1, 2, 2, 1, 2};
  int32_t element[24] = {0, 1, 4, 1, 5, 4, 1, 2, 5, 2, 6, 5, 2, 3, 6, 3, 7, 6, 3, 0, 7, 0, 4, 7};
  int32_t region[8] = {0, 0, 0, 0, 1, 1, 1, 1};
  bw_plane_mesh *mesh = NULL;
  check_ok(context, bw_plane_mesh_copy(context, 1, 8, point, 8, element, region, &mesh));
  check_topology(mesh);
  assert_int_equal(mesh->outline->loop_count, 2);
  assert_int_equal(mesh->outline->loop[1].region, -1);
  assert_int_equal(mesh->outline->loop[1].parent, 0);
  assert_int_equal(mesh->topology->side_count, 8);
  assert_int_equal(mesh->topology->region[5], 1);
  assert_string_equal(mesh->outline->tag[0].text, "boundary");
  bw_plane_quality quality;
  bw_plane_measure(mesh, &quality);
  check_near(quality.area, 8, 1e-14);

  /* moved: only where the outline goes along */
  double other[16];
  memcpy(other, point, sizeof point);
  other[8] = 1.2;
  check_fails(context, BW_GEOMETRY, "away from its place",
              bw_plane_mesh_moved(context, mesh, mesh->outline, other, &mesh));
  bw_outline *outline = NULL;
  bw_plane_mesh *moved = NULL;
  double *place = malloc(sizeof(double) * 2 * (size_t)mesh->outline->point_count);
  memcpy(place, mesh->outline->point, sizeof(double) * 2 * (size_t)mesh->outline->point_count);
  for (int32_t i = 0; i < mesh->outline->point_count; i++)
    if (place[2 * i] == 1 && place[2 * i + 1] == 1)
      place[2 * i] = 1.2;
  check_ok(context, bw_outline_moved(context, mesh->outline, place, &outline));
  check_ok(context, bw_plane_mesh_moved(context, mesh, outline, other, &moved));
  assert_ptr_equal(moved->topology, mesh->topology);
  bw_plane_measure(moved, &quality);
  check_near(quality.area, 8.1, 1e-14);
  free(place);
  bw_release(moved);
  bw_release(outline);
  bw_release(mesh);
}

/* Triangles in three corners of a circle with parabolic sides. */
static void curved(void **state) {
  bw_context *context = check_context(state);
  double point[12] = {0, 0, 2, 0, 0, 2, 1, -0.3, 1.2, 1.2, 0, 1};
  int32_t element[6] = {0, 1, 2, 3, 4, 5};
  bw_plane_mesh *mesh = NULL;
  check_ok(context, bw_plane_mesh_copy(context, 2, 6, point, 1, element, NULL, &mesh));
  check_topology(mesh);
  bw_plane_quality quality;
  bw_plane_measure(mesh, &quality);
  /* two thirds of base times height of each bulge */
  double area = 2 + 2.0 / 3 * 2 * 0.3 + 2.0 / 3 * sqrt(8) * 0.2 * sqrt(2);
  check_near(quality.area, area, 1e-14);
  bw_outline_measures measures;
  check_ok(context, bw_outline_measure(context, mesh->outline, -1, &measures));
  check_near(measures.area, area, 1e-14); /* the parabolas are the outline's */
  assert_true(quality.worst > 0 && quality.worst < 0.71);
  bw_release(mesh);
  point[6] = 0.2; /* beyond the quarter: folded */
  check_fails(context, BW_GEOMETRY, "element 1",
              bw_plane_mesh_copy(context, 2, 6, point, 1, element, NULL, &mesh));
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = NULL;
  double point[10] = {0, 0, 1, 0, 1, 1, 0, 1, 2, 0.5};
  check_fails(context, BW_GEOMETRY, "counter-clockwise",
              bw_plane_mesh_copy(context, 1, 3, point, 1, (int32_t[]){0, 2, 1}, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "names node 8",
              bw_plane_mesh_copy(context, 1, 4, point, 1, (int32_t[]){0, 1, 7}, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "belongs to no element",
              bw_plane_mesh_copy(context, 1, 4, point, 1, (int32_t[]){0, 1, 2}, NULL, &mesh));
  check_fails(
      context, BW_GEOMETRY, "same side",
      bw_plane_mesh_copy(context, 1, 4, point, 2, (int32_t[]){0, 1, 2, 0, 1, 3}, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "more than once",
              bw_plane_mesh_copy(context, 1, 5, (double[]){0, 0, 1, 0, 0, 1, -1, 0, 0, -1}, 2,
                                 (int32_t[]){0, 1, 2, 0, 3, 4}, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "a corner node behind a mid-edge node",
              bw_plane_mesh_copy(context, 2, 6, (double[]){0, 0, 2, 0, 1, 0, 0, 2, 1, 1, 0, 1}, 1,
                                 (int32_t[]){0, 1, 3, 2, 4, 5}, NULL, &mesh));
  point[4] = NAN;
  check_fails(context, BW_GEOMETRY, "finite",
              bw_plane_mesh_copy(context, 1, 3, point, 1, (int32_t[]){0, 1, 2}, NULL, &mesh));
  check_fails(context, BW_INVALID, "order 3",
              bw_plane_rectangle(context, 3, LOW, HIGH, 2, 2, BW_DIAGONAL_LEFT, &mesh));
  check_fails(context, BW_INVALID, "0 x 2 cells",
              bw_plane_rectangle(context, 1, LOW, HIGH, 0, 2, BW_DIAGONAL_LEFT, &mesh));
  check_fails(context, BW_INVALID, "above",
              bw_plane_rectangle(context, 1, HIGH, LOW, 1, 2, BW_DIAGONAL_LEFT, &mesh));
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = NULL, *moved = NULL;
  check_each_allocation(context, status, 1) {
    status = bw_plane_rectangle(context, 2, LOW, HIGH, 2, 2, BW_DIAGONAL_UNION_JACK, &mesh);
  }
  const bw_plane_topology *t = mesh->topology;
  check_each_allocation(context, status, 1) {
    status = bw_plane_mesh_copy(context, 2, t->nodes->node_count, mesh->point, t->element_count,
                                t->element, NULL, &moved);
  }
  bw_release(moved);
  bw_release(mesh);
}

check_main(check_test(rectangles), check_test(copies), check_test(curved), check_test(refusals),
           check_test(memory_failures))
