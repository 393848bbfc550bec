/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling outlines with triangles: areas, sizes, counts, quality, regions, hard shapes. */
#include "outlines.h"

static bw_plane_mesh *filled(bw_context *context, const shape *s, const bw_plane_options *options) {
  bw_outline *outline = outline_of(context, s);
  bw_plane_mesh *mesh = NULL;
  double seconds = bw_seconds();
  check_ok(context, bw_plane_fill(context, outline, options, &mesh));
  seconds = bw_seconds() - seconds;
  bw_outline_measures measures;
  check_ok(context, bw_outline_measure(context, outline, -1, &measures));
  bw_plane_quality quality;
  bw_plane_measure(mesh, &quality);
  if (getenv("BARWRIGHT_FULL"))
    printf("%d elements, %d nodes, worst %.3f mean %.3f angles %.1f to %.1f, %.3f s\n",
           mesh->topology->element_count, mesh->topology->nodes->node_count, quality.worst,
           quality.mean, quality.smallest_angle, quality.largest_angle, seconds);
  assert_int_equal(quality.inverted, 0);
  /* every node on the outline lies there; moving onto oneself checks it */
  bw_plane_mesh *same = NULL;
  check_ok(context, bw_plane_mesh_moved(context, mesh, outline, mesh->point, &same));
  bw_release(same);
  bw_release(outline);
  return mesh;
}

static void block(void **state) {
  bw_context *context = check_context(state);
  shape s;
  block_with_hole(&s, 1);
  for (int order = 1; order <= 2; order++)
    for (int count = 500; count <= 8000; count *= 4) {
      bw_plane_options options;
      bw_plane_options_default(&options);
      options.order = order;
      options.elements = count;
      bw_plane_mesh *mesh = filled(context, &s, &options);
      double made = mesh->topology->element_count;
      assert_true(fabs(made / count - 1) <= 0.1);
      bw_plane_quality quality;
      bw_plane_measure(mesh, &quality);
      assert_true(quality.worst > 0.45 && quality.mean > 0.85);
      /* the area is the outline's: parabolas to the third order, chords to the first */
      bw_outline_measures measures;
      check_ok(context, bw_outline_measure(context, mesh->outline, -1, &measures));
      double h2 = 6.0 / count;
      check_near(quality.area, measures.area, order == 2 ? 0.5 * h2 * h2 : 2 * h2);
      bw_release(mesh);
    }
}

static double near_corner(void *data, const double at[2]) {
  (*(int64_t *)data)++;
  return 0.01 + 0.2 * hypot(at[0], at[1]);
}

static void size_field(void **state) {
  bw_context *context = check_context(state);
  shape s;
  block_with_hole(&s, 1.5);
  bw_plane_options options;
  bw_plane_options_default(&options);
  int64_t calls = 0;
  options.field = near_corner;
  options.field_data = &calls;
  bw_plane_mesh *mesh = filled(context, &s, &options);
  assert_true(calls > 0);
  /* edge lengths follow the field, within a factor of two and a half */
  const bw_plane_topology *t = mesh->topology;
  double ratio = 0;
  for (int32_t e = 0; e < t->element_count; e++)
    for (int k = 0; k < 3; k++) {
      const double *a = mesh->point + 2 * t->element[3 * e + k];
      const double *b = mesh->point + 2 * t->element[3 * e + (k + 1) % 3];
      double middle[2] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
      double wanted = near_corner(&calls, middle), length = hypot(b[0] - a[0], b[1] - a[1]);
      assert_true(length < 2.5 * wanted);
      ratio += length / wanted / (3 * t->element_count);
    }
  assert_true(ratio > 0.6 && ratio < 1.3);
  bw_release(mesh);
}

static double bad_field(void *data, const double at[2]) {
  (void)data;
  return at[0] - 0.5;
}

static void regions(void **state) {
  bw_context *context = check_context(state);
  shape s = {.points = 0};
  add_box(&s, 0, "body", 0, 0, 4, 2);
  add_ellipse(&s, 1, "inlay", 1, 1, 0.7, 0.6);
  add_ellipse(&s, -1, "hole", 1, 1, 0.3, 0.3);
  add_box(&s, 2, "island", 0.9, 0.9, 1.1, 1.1);
  add_box(&s, -1, "window", 2.5, 0.5, 3.5, 1.5);
  for (int order = 1; order <= 2; order++) {
    bw_plane_options options;
    bw_plane_options_default(&options);
    options.elements = 3000;
    options.order = order;
    bw_plane_mesh *mesh = filled(context, &s, &options);
    const bw_plane_topology *t = mesh->topology;
    double area[3] = {0, 0, 0};
    int width = order == 2 ? 6 : 3;
    for (int32_t e = 0; e < t->element_count; e++) {
      const int32_t *n = t->element + width * e;
      const double *a = mesh->point + 2 * n[0], *b = mesh->point + 2 * n[1],
                   *c = mesh->point + 2 * n[2];
      area[t->region[e]] += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    for (int r = 0; r < 3; r++) {
      bw_outline_measures measures;
      check_ok(context, bw_outline_measure(context, mesh->outline, r, &measures));
      check_near(area[r], measures.area, 0.01 * measures.area);
    }
    /* the inlay's sides have both elements, the inner region on the left */
    for (int32_t i = 0; i < t->side_count; i++) {
      int32_t left = t->side_element[2 * i], right = t->side_element[2 * i + 1];
      if (t->side_segment[i] >= mesh->outline->loop[1].first &&
          t->side_segment[i] < mesh->outline->loop[1].first + 4) {
        assert_int_equal(t->region[left], 1);
        assert_int_equal(t->region[right], 0);
      } else {
        assert_true(left >= 0 && right < 0);
      }
    }
    bw_release(mesh);
  }
}

/* Needles, tiny segments beside large ones, thin walls, cusps. */
static void hard_shapes(void **state) {
  bw_context *context = check_context(state);
  bw_plane_options options;
  bw_plane_options_default(&options);
  for (int order = 1; order <= 2; order++) {
    options.order = order;
    options.elements = 400;
    const double needle[3][2] = {{0, 0}, {1, 0}, {1, 0.002}};
    shape s = {.points = 0};
    add_polygon(&s, 0, "needle", 3, needle);
    bw_release(filled(context, &s, &options));
    const double step[6][2] = {{0, 0}, {1, 0}, {1, 0.5}, {1.00001, 0.5}, {1.00001, 1}, {0, 1}};
    s = (shape){.points = 0};
    add_polygon(&s, 0, "step", 6, step);
    bw_release(filled(context, &s, &options));
    s = (shape){.points = 0}; /* a wall of a thousandth */
    add_ellipse(&s, 0, "body", 0, 0, 1, 1);
    add_ellipse(&s, -1, "hole", 0.5, 0, 0.499, 0.499);
    bw_release(filled(context, &s, &options));
    s = (shape){.points = 0}; /* a drop: curves that meet in a cusp */
    begin_loop(&s, 0, "drop");
    const double drop[7][2] = {{0, 0}, {0.5, 0}, {1, -0.6}, {1.2, 0}, {1, 0.6}, {0.5, 0.001}};
    for (int i = 0; i < 6; i++)
      memcpy(s.point[i], drop[i], sizeof drop[i]);
    s.points = 6;
    s.segment[0] = (bw_segment){{0, 1, 2, 3}, 0};
    s.segment[1] = (bw_segment){{3, 4, 5, 0}, 0};
    s.segments = s.loop[0].count = 2;
    bw_release(filled(context, &s, &options));
    s = (shape){.points = 0}; /* one segment */
    begin_loop(&s, 0, "leaf");
    const double leaf[3][2] = {{0, 0}, {2, 0.1}, {0.2, 2}};
    for (int i = 0; i < 3; i++)
      memcpy(s.point[i], leaf[i], sizeof leaf[i]);
    s.points = 3;
    s.segment[0] = (bw_segment){{0, 1, 2, 0}, 0};
    s.segments = s.loop[0].count = 1;
    bw_release(filled(context, &s, &options));
  }
}

/* Far from the origin, tiny, huge, thinner than its boundary edges: in no more time. */
static void scales(void **state) {
  bw_context *context = check_context(state);
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.elements = 50;
  static const double place[4][2] = {{1e6, 1}, {0, 1e-9}, {1e10, 1e9}, {0, 1}};
  for (int i = 0; i < 4; i++) {
    shape s = {.points = 0};
    add_ellipse(&s, 0, "disc", place[i][0], place[i][0], place[i][1], place[i][1]);
    bw_plane_mesh *mesh = filled(context, &s, &options);
    assert_in_range(mesh->topology->element_count, 40, 60);
    bw_release(mesh);
  }
  shape s = {.points = 0};
  const double sliver[3][2] = {{0, 0}, {1, 0}, {0.5, 1e-6}};
  add_polygon(&s, 0, "sliver", 3, sliver);
  bw_plane_mesh *mesh = filled(context, &s, &options);
  assert_in_range(mesh->topology->element_count, 40, 60);
  bw_release(mesh);
}

/* A detail of 1e-8 of the outline, far from all else of it: edge lengths grow away from it, and its
 * size is not kept up along the long curves that begin there. */
static void details(void **state) {
  bw_context *context = check_context(state);
  bw_plane_options options;
  bw_plane_options_default(&options);
  const double step[5][2] = {{0, 0}, {1e6, 4e5}, {1.2e6, -3e5}, {0.02, -0.02}, {0.01, 0}};
  shape s = {.points = 0};
  add_polygon(&s, 0, "step", 5, step);
  bw_release(filled(context, &s, &options));
  s = (shape){.points = 0};
  begin_loop(&s, 0, "bow");
  const double bow[6][2] = {{0, 0}, {5e5, 4e5}, {9e5, 4e5}, {1e6, 0}, {0.02, -0.02}, {0.01, 0}};
  memcpy(s.point, bow, sizeof bow);
  s.points = 6;
  s.segment[0] = (bw_segment){{0, 1, 2, 3}, 0};
  s.segment[1] = (bw_segment){{3, -1, -1, 4}, 0};
  s.segment[2] = (bw_segment){{4, -1, -1, 5}, 0};
  s.segment[3] = (bw_segment){{5, -1, -1, 0}, 0};
  s.segments = s.loop[0].count = 4;
  bw_plane_mesh *mesh = filled(context, &s, &options);
  assert_in_range(mesh->topology->element_count, 1800, 2200);
  bw_release(mesh);
}

/* Nodes along a strip lie on two straight lines. Inserted one after the other they would turn over
 * a number of edges that grows with the square of theirs. */
static void strip(void **state) {
  bw_context *context = check_context(state);
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.size = 1;
  options.minimum_angle = 0;
  shape s = {.points = 0};
  add_box(&s, 0, "strip", 0, 0, 30000, 0.5);
  bw_plane_mesh *mesh = filled(context, &s, &options);
  assert_in_range(mesh->topology->element_count, 50000, 80000);
  bw_release(mesh);
}

typedef struct stopping {
  bw_context *context;
  int64_t calls, after;
} stopping;

static double cancelling(void *data, const double at[2]) {
  stopping *it = data;
  (void)at;
  if (++it->calls == it->after)
    bw_cancel(it->context);
  return 0.01;
}

static void limits(void **state) {
  bw_context *context = check_context(state);
  bw_outline *outline = block_outline(context, 1);
  bw_plane_options options;
  bw_plane_mesh *mesh = NULL;
  const char *key, *text;
  double number;
  bw_plane_options_default(&options);
  options.time_limit = 0;
  check_fails(context, BW_INVALID, "time_limit", bw_plane_fill(context, outline, &options, &mesh));
  options.time_limit = 1e-9;
  options.elements = 20000;
  check_fails(context, BW_LIMIT, "time_limit", bw_plane_fill(context, outline, &options, &mesh));
  assert_true(bw_detail(context, 0, &key, &number, &text));
  assert_string_equal(key, "limit");
  assert_string_equal(text, "time");
  bw_plane_options_default(&options);
  options.memory_limit = 1e5;
  check_fails(context, BW_LIMIT, "memory_limit", bw_plane_fill(context, outline, &options, &mesh));
  options.elements = 100;
  check_ok(context, bw_plane_fill(context, outline, &options, &mesh));
  bw_release(mesh);
  mesh = NULL;
  bw_plane_options_default(&options);
  options.elements = 2000000000;
  check_fails(context, BW_LIMIT, "fewer elements",
              bw_plane_fill(context, outline, &options, &mesh));
  bw_plane_options_default(&options);
  stopping it = {context, 0, 3000};
  options.field = cancelling;
  options.field_data = &it;
  check_fails(context, BW_CANCELLED, "", bw_plane_fill(context, outline, &options, &mesh));
  assert_true(it.calls > 2999 && it.calls < 40000);
  bw_clear_cancel(context);
  bw_release(outline);
  /* more nodes along it than elements are allowed */
  shape s = {.points = 0};
  add_box(&s, 0, "strip", 0, 0, 1e5, 1e-3);
  outline = outline_of(context, &s);
  bw_plane_options_default(&options);
  options.size = 0.01;
  check_fails(context, BW_LIMIT, "nodes on the outline",
              bw_plane_fill(context, outline, &options, &mesh));
  bw_release(outline);
}

static void same_every_time(void **state) {
  bw_context *context = check_context(state);
  shape s;
  block_with_hole(&s, 0.7);
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.order = 2;
  bw_plane_mesh *first = filled(context, &s, &options);
  void *between = malloc(12345); /* other addresses */
  bw_plane_mesh *second = filled(context, &s, &options);
  free(between);
  const bw_plane_topology *a = first->topology, *b = second->topology;
  assert_int_equal(a->element_count, b->element_count);
  assert_memory_equal(a->element, b->element, sizeof(int32_t) * 6 * (size_t)a->element_count);
  assert_memory_equal(first->point, second->point,
                      sizeof(double) * 2 * (size_t)a->nodes->node_count);
  bw_release(first);
  bw_release(second);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_outline *outline = block_outline(context, 1);
  bw_plane_options options;
  bw_plane_mesh *mesh = NULL;
  bw_plane_options_default(&options);
  options.order = 3;
  check_fails(context, BW_INVALID, "order 3", bw_plane_fill(context, outline, &options, &mesh));
  bw_plane_options_default(&options);
  options.size = NAN;
  check_fails(context, BW_INVALID, "size", bw_plane_fill(context, outline, &options, &mesh));
  bw_plane_options_default(&options);
  options.size = 1e-6;
  check_fails(context, BW_LIMIT, "limit", bw_plane_fill(context, outline, &options, &mesh));
  bw_plane_options_default(&options);
  options.elements = 5000;
  options.limit = 1000;
  check_fails(context, BW_LIMIT, "limit", bw_plane_fill(context, outline, &options, &mesh));
  bw_plane_options_default(&options);
  options.field = bad_field;
  check_fails(context, BW_INVALID, "size field", bw_plane_fill(context, outline, &options, &mesh));
  bw_cancel(context);
  bw_plane_options_default(&options);
  check_fails(context, BW_CANCELLED, "", bw_plane_fill(context, outline, &options, &mesh));
  bw_clear_cancel(context);
  bw_release(outline);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_outline *outline = block_outline(context, 1);
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.elements = 60;
  options.order = 2;
  bw_plane_mesh *mesh = NULL;
  check_each_allocation(context, status, 1) {
    status = bw_plane_fill(context, outline, &options, &mesh);
  }
  bw_release(mesh);
  bw_release(outline);
}

static void large(void **state) {
  bw_context *context = check_context(state);
  if (!getenv("BARWRIGHT_FULL"))
    return;
  shape s;
  block_with_hole(&s, 1);
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.elements = 20000;
  bw_release(filled(context, &s, &options));
  options.elements = 500000;
  bw_release(filled(context, &s, &options));
}

check_main(check_test(block), check_test(size_field), check_test(regions), check_test(hard_shapes),
           check_test(scales), check_test(details), check_test(strip), check_test(limits),
           check_test(same_every_time), check_test(refusals), check_test(memory_failures),
           check_test(large))
