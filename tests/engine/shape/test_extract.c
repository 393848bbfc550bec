/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons extracted from surfaces, and the curve behind them. */
#include "check.h"
#include "shape/curve.h"

typedef struct capsules {
  int count;
  double end[6][6], radius;
} capsules;

static double union_of(void *data, const double at[3]) {
  const capsules *c = data;
  double min = HUGE_VAL;
  for (int i = 0; i < c->count; i++) {
    const double *a = c->end[i], *b = a + 3;
    double along[3], from[3], d[3];
    for (int k = 0; k < 3; k++) {
      along[k] = b[k] - a[k];
      from[k] = at[k] - a[k];
    }
    double t = fmin(fmax(bw_dot(from, along) / bw_dot(along, along), 0), 1);
    for (int k = 0; k < 3; k++)
      d[k] = from[k] - t * along[k];
    min = fmin(min, bw_norm(d) - c->radius);
  }
  return min;
}

static bw_surface *surface_of(bw_context *context, const capsules *c, int cells) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (int i = 0; i < 2 * c->count; i++)
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], c->end[i / 2][3 * (i % 2) + k] - 1.3 * c->radius);
      high[k] = fmax(high[k], c->end[i / 2][3 * (i % 2) + k] + 1.3 * c->radius);
    }
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_implicit(context, low, high, cells, union_of, (void *)c, &surface));
  return surface;
}

static bw_skeleton *extract(bw_context *context, const bw_surface *surface, int bones) {
  bw_skeleton_options options;
  bw_skeleton_options_default(&options);
  options.bones = bones;
  bw_skeleton *s = NULL;
  check_ok(context, bw_skeleton_extract(context, surface, &options, &s));
  return s;
}

static int bones_at(const bw_skeleton *s, int32_t joint) {
  int count = 0;
  for (int32_t i = 0; i < 2 * s->bone_count; i++)
    count += s->bone[i] == joint;
  return count;
}

/* The smallest distance from a joint to a point. */
static double gap_to(const bw_skeleton *s, double x, double y, double z) {
  double min = HUGE_VAL;
  for (int32_t j = 0; j < s->joint_count; j++) {
    double d[3] = {s->joint[3 * j] - x, s->joint[3 * j + 1] - y, s->joint[3 * j + 2] - z};
    min = fmin(min, bw_norm(d));
  }
  return min;
}

static void a_capsule_has_one_bone_along_its_axis(void **state) {
  bw_context *context = check_context(state);
  const capsules c = {1, {{0, 0, 0, 0.06, 0.02, 0.01}}, 0.01};
  bw_surface *surface = surface_of(context, &c, 26);
  bw_skeleton *s = extract(context, surface, 0);
  assert_int_equal(s->bone_count, 1);
  /* from near one end to near the other, each tip half a radius below the surface */
  assert_true(gap_to(s, 0, 0, 0) < 0.008);
  assert_true(gap_to(s, 0.06, 0.02, 0.01) < 0.008);
  for (int32_t j = 0; j < 2; j++)
    assert_true(union_of((void *)&c, s->joint + 3 * j) < -0.002);
  double d[3];
  for (int k = 0; k < 3; k++)
    d[k] = s->joint[3 + k] - s->joint[k];
  static const double axis[3] = {0.06, 0.02, 0.01};
  assert_true(fabs(bw_dot(d, axis)) > cos(0.05) * bw_norm(d) * bw_norm(axis));
  check_near(bw_norm(d), bw_norm(axis), 0.014);
  bw_release(s);
  /* just so many as asked for, all along the axis */
  for (int bones = 2; bones <= 5; bones += 3) {
    s = extract(context, surface, bones);
    assert_int_equal(s->bone_count, bones);
    for (int32_t j = 0; j < s->joint_count; j++)
      assert_true(union_of((void *)&c, s->joint + 3 * j) < -0.002);
    bw_release(s);
  }
  bw_release(surface);
}

static const capsules cross = {2, {{-3, 0, 0, 3, 0, 0}, {0, -2, 0, 0, 4, 0}}, 0.5};

static void a_cross_has_four_bones_that_meet(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = surface_of(context, &cross, 24);
  bw_skeleton *s = extract(context, surface, 0);
  assert_int_equal(s->bone_count, 4);
  assert_int_equal(bones_at(s, s->root), 4);
  assert_true(gap_to(s, 0, 0, 0) < 0.2);
  assert_true(gap_to(s, 3, 0, 0) < 0.4);
  assert_true(gap_to(s, -3, 0, 0) < 0.4);
  assert_true(gap_to(s, 0, 4, 0) < 0.4);
  assert_true(gap_to(s, 0, -2, 0) < 0.4);
  /* the longest limb comes first */
  assert_true(s->joint[3 * s->bone[1] + 1] > 3.5);
  /* the same surface gives the same bits, whatever the heap looks like */
  void *hole[200];
  for (int i = 0; i < 200; i++)
    hole[i] = malloc((size_t)(16 + 96 * i));
  for (int i = 0; i < 200; i += 2)
    free(hole[i]);
  bw_skeleton *again = extract(context, surface, 0);
  assert_memory_equal(again->joint, s->joint, 15 * sizeof(double));
  assert_memory_equal(again->bone, s->bone, 8 * sizeof(int32_t));
  for (int i = 1; i < 200; i += 2)
    free(hole[i]);
  bw_release(again);
  bw_release(s);
  for (int bones = 2; bones <= 9; bones += 7) { /* fewer than limbs, and more */
    s = extract(context, surface, bones);
    assert_int_equal(s->bone_count, bones);
    for (int32_t j = 0; j < s->joint_count; j++)
      assert_true(union_of((void *)&cross, s->joint + 3 * j) < 0);
    bw_release(s);
  }
  bw_release(surface);
}

static double torus(void *data, const double at[3]) {
  (void)data;
  double ring = hypot(at[0], at[1]) - 2;
  return hypot(ring, at[2]) - 0.5;
}

static void a_ring_is_cut_with_a_warning(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {-3, -3, -1}, high[3] = {3, 3, 1};
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_implicit(context, low, high, 26, torus, NULL, &surface));
  bw_skeleton *s = extract(context, surface, 0);
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "ring"));
  assert_true(s->bone_count >= 4);
  double length = 0;
  for (int32_t b = 0; b < s->bone_count; b++)
    length += bwi_gap(s->joint + 3 * s->bone[2 * b], s->joint + 3 * s->bone[2 * b + 1]);
  assert_true(length > 0.85 * 4 * M_PI && length < 1.01 * 4 * M_PI);
  int ends = 0;
  for (int32_t j = 0; j < s->joint_count; j++) {
    assert_true(torus(NULL, s->joint + 3 * j) < 0);
    ends += bones_at(s, j) == 1;
  }
  assert_int_equal(ends, 2);
  bw_release(s);
  bw_release(surface);
}

static void a_ball_has_a_bone_too(void **state) {
  bw_context *context = check_context(state);
  static const double centre[3] = {1, 2, 3};
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_sphere_shape(context, centre, 0.1, 3, &surface));
  bw_skeleton *s = extract(context, surface, 0);
  for (int32_t j = 0; j < s->joint_count; j++)
    assert_true(bwi_gap(s->joint + 3 * j, centre) < 0.1);
  bw_release(s);
  bw_release(surface);
}

static void what_cannot_be_used_is_refused(void **state) {
  bw_context *context = check_context(state);
  static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  bw_surface *box = NULL, *two = NULL;
  bw_skeleton *s = NULL;
  check_ok(context, bw_surface_box_shape(context, low, high, &box));
  bw_skeleton_options options;
  bw_skeleton_options_default(&options);
  options.bones = -1;
  check_fails(context, BW_INVALID, "bones -1", bw_skeleton_extract(context, box, &options, &s));
  options.bones = 501;
  check_fails(context, BW_INVALID, "bones 501", bw_skeleton_extract(context, box, &options, &s));
  bw_skeleton_options_default(&options);
  options.bend = NAN;
  check_fails(context, BW_INVALID, "bend", bw_skeleton_extract(context, box, &options, &s));
  int points = box->point_count, facets = box->triangle_count;
  double *point = malloc(6 * (size_t)points * sizeof *point);
  int32_t *triangle = malloc(6 * (size_t)facets * sizeof *triangle);
  for (int i = 0; i < 3 * points; i++) {
    point[i] = box->point[i];
    point[3 * points + i] = box->point[i] + 5;
  }
  for (int i = 0; i < 3 * facets; i++) {
    triangle[i] = box->triangle[i];
    triangle[3 * facets + i] = box->triangle[i] + points;
  }
  check_ok(context, bw_surface_copy(context, 2 * points, point, 2 * facets, triangle, NULL, &two));
  check_fails(context, BW_GEOMETRY, "2 separate shells",
              bw_skeleton_extract(context, two, NULL, &s));
  assert_null(s);
  /* a box without its last facet is closed first */
  bw_release(two);
  check_ok(context, bw_surface_copy(context, points, point, facets - 1, triangle, NULL, &two));
  check_ok(context, bw_skeleton_extract(context, two, NULL, &s));
  assert_non_null(strstr(bw_warning_at(context, 0), "repaired"));
  bw_release(s);
  free(point);
  free(triangle);
  bw_release(two);
  bw_release(box);
}

/* ---- the curve ------------------------------------------------------------------------------- */

/* A trunk along x with radius 1, a limb up at x = 8 of length 6, a spur of length 1.2 at x = 4, two
 * junctions at x = 12 and 12.5 that are one with limbs to both sides, and a ring at the end. */
typedef struct sketch_graph {
  bwi_curve_graph graph;
  double point[400 * 4];
  int32_t edge[400 * 2];
} sketch_graph;

static int32_t put(sketch_graph *g, double x, double y, double r) {
  double *at = g->point + 4 * g->graph.point_count;
  at[0] = x;
  at[1] = y;
  at[2] = 0;
  at[3] = r;
  return g->graph.point_count++;
}

static void link(sketch_graph *g, int32_t a, int32_t b) {
  g->edge[2 * g->graph.edge_count] = a;
  g->edge[2 * g->graph.edge_count++ + 1] = b;
}

/* A line of points from a point to a place; returns the last. */
static int32_t line(sketch_graph *g, int32_t from, double x, double y, double r) {
  const double *a = g->point + 4 * from;
  int parts = (int)ceil(hypot(x - a[0], y - a[1]) / 0.5);
  double x0 = a[0], y0 = a[1];
  for (int i = 1; i <= parts; i++) {
    int32_t next = put(g, x0 + (x - x0) * i / parts, y0 + (y - y0) * i / parts,
                       i % 3 == 1 && i < parts ? -1 : r);
    link(g, from, next);
    from = next;
  }
  return from;
}

static void make_graph(sketch_graph *g) {
  memset(g, 0, sizeof *g);
  g->graph.point = g->point;
  g->graph.edge = g->edge;
  int32_t start = put(g, 0, 0, 1), a = line(g, start, 4, 0, 1), b = line(g, a, 8, 0, 1);
  line(g, a, 4, 1.2, 0.5);
  line(g, b, 8, 6, 0.5);
  int32_t c = line(g, b, 12, 0, 1), d = line(g, c, 12.5, 0, 1);
  line(g, c, 12, 5, 0.5);
  line(g, d, 12.5, -5, 0.5);
  int32_t e = line(g, d, 18, 0, 1);
  int32_t f = line(g, line(g, e, 21, 3, 0.5), 24, 0, 0.5);
  link(g, f, line(g, line(g, e, 21, -3, 0.5), 23.5, -0.5, 0.5));
}

static void the_curve_is_pruned_and_cut(void **state) {
  bw_context *context = check_context(state);
  sketch_graph g;
  bwi_curve curve;
  bwi_sketch sketch;
  make_graph(&g);
  check_ok(context, bwi_curve_create(context, &g.graph, &curve));
  assert_int_equal(curve.cut_count, 1);
  /* the ring is open at its far side from the middle */
  assert_true(curve.cut_at[0] > 23);
  check_ok(context, bwi_curve_prune(context, &curve, 1.5, 0));
  int branches = 0;
  for (int b = 0; b < curve.branch_count; b++)
    branches += curve.branch[b].at != NULL;
  /* trunk to 8, limb, trunk to 12, two limbs, trunk to 18, two halves of the ring */
  assert_int_equal(branches, 8);
  check_ok(context, bwi_curve_bones(context, &curve, 0.5, 0, &sketch));
  assert_int_equal(sketch.bone_count, 10); /* each half of the ring has its corner */
  int tips = 0;
  for (int j = 0; j < sketch.joint_count; j++)
    tips += sketch.tip[j];
  assert_int_equal(tips, 4); /* not where the ring was cut */
  bwi_sketch_clear(&sketch);
  for (int wanted = 8; wanted < 40; wanted++) {
    check_ok(context, bwi_curve_bones(context, &curve, 0.5, wanted, &sketch));
    assert_int_equal(sketch.bone_count, wanted);
    bwi_sketch_clear(&sketch);
  }
  /* fewer than branches: the shortest limbs go first */
  check_ok(context, bwi_curve_prune(context, &curve, 1.5, 3));
  check_ok(context, bwi_curve_bones(context, &curve, 0.5, 3, &sketch));
  assert_int_equal(sketch.bone_count, 3);
  bwi_sketch_clear(&sketch);
  bwi_curve_clear(&curve);
}

static void every_failing_allocation_is_survived(void **state) {
  bw_context *context = check_context(state);
  sketch_graph g;
  make_graph(&g);
  check_each_allocation(context, status, 1) {
    bwi_curve curve = {0};
    bwi_sketch sketch = {0};
    status = bwi_curve_create(context, &g.graph, &curve);
    if (status == BW_OK)
      status = bwi_curve_prune(context, &curve, 1.5, 4);
    if (status == BW_OK)
      status = bwi_curve_bones(context, &curve, 0.5, 20, &sketch);
    bwi_sketch_clear(&sketch);
    bwi_curve_clear(&curve);
  }
  /* the whole: a second a time, so not every one */
  if (!getenv("BARWRIGHT_FULL"))
    return;
  bw_surface *surface = surface_of(context, &cross, 32);
  for (int64_t n = 1;; n += 1 + n / 6) {
    bw_skeleton *s = NULL;
    bw_fail_allocation(n, true);
    bw_status status = bw_skeleton_extract(context, surface, NULL, &s);
    bw_fail_allocation(0, false);
    assert_true((status == BW_OK) == (s != NULL));
    bw_release(s);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
  }
  bw_release(surface);
}

check_main(check_test(a_capsule_has_one_bone_along_its_axis),
           check_test(a_cross_has_four_bones_that_meet), check_test(a_ring_is_cut_with_a_warning),
           check_test(a_ball_has_a_bone_too), check_test(what_cannot_be_used_is_refused),
           check_test(the_curve_is_pruned_and_cut),
           check_test(every_failing_allocation_is_survived))
