/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Edits of outlines: loops more and fewer, splits and joins, smoothing, pulling, polygons. */
#include "shapes.h"

#define PI 3.14159265358979323846

static bw_outline *plate(bw_context *context) {
  draft d = {0};
  draft_rectangle(&d, "body", 0, 0, 0, 6, 4);
  draft_circle(&d, "hole", -1, 2, 2, 1);
  draft_rectangle(&d, "island", 1, 1.8, 1.8, 2.2, 2.2);
  draft_rectangle(&d, "inlay", 2, 4, 1, 5, 2);
  d.tags = 2;
  strcpy(d.tag[0].text, "free");
  strcpy(d.tag[1].text, "fixed");
  d.segment[3].tag = d.segment[5].tag = 1;
  return draft_make(context, &d);
}

static double area(bw_context *context, const bw_outline *o) {
  bw_outline_measures m;
  check_ok(context, bw_outline_measure(context, o, -1, &m));
  return m.area;
}

/* ---- loops ----------------------------------------------------------------------------------- */

static void a_loop_more_and_fewer(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context), *larger = NULL, *smaller = NULL, *none = NULL;
  draft d = {0};
  draft_circle(&d, "second", -1, 5, 3, 0.5);
  d.segment[1].tag = 1;
  check_ok(context, bw_outline_with_loop(context, o, d.points, d.point, d.segments, d.segment,
                                         d.loop, &larger));
  check_outline(context, larger);
  int32_t l = bw_outline_find_loop(larger, "second");
  assert_int_equal(l, 4);
  assert_int_equal(larger->loop[l].parent, 0);
  check_near(area(context, o) - area(context, larger), 0.25 * PI, 1e-3);
  check_ok(context, bw_outline_without_loop(context, larger, l, &smaller));
  check_outline(context, smaller);
  assert_int_equal(smaller->point_count, o->point_count);
  assert_memory_equal(smaller->point, o->point, 2 * (size_t)o->point_count * sizeof *o->point);
  assert_memory_equal(smaller->segment, o->segment, (size_t)o->segment_count * sizeof *o->segment);
  bw_release(smaller);
  /* the island goes with its hole, and region 2 becomes region 1 */
  check_ok(context, bw_outline_without_loop(context, larger, 1, &smaller));
  check_outline(context, smaller);
  assert_int_equal(smaller->loop_count, 3);
  assert_int_equal(smaller->region_count, 2);
  assert_int_equal(smaller->loop[bw_outline_find_loop(smaller, "inlay")].region, 1);
  assert_int_equal(smaller->tag_count, 2);
  check_near(area(context, smaller), 24 - 0.25 * PI, 1e-3);
  check_fails(context, BW_GEOMETRY, "nothing would be left",
              bw_outline_without_loop(context, o, 0, &none));
  check_fails(context, BW_INVALID, "loop 5", bw_outline_without_loop(context, o, 4, &none));
  check_fails(context, BW_GEOMETRY, "crosses",
              bw_outline_with_loop(context, o, d.points, (d.point[0] = 7, d.point), d.segments,
                                   d.segment, d.loop, &none));
  d.segment[2].point[1] = 40;
  check_fails(
      context, BW_INVALID, "segment 19 names point",
      bw_outline_with_loop(context, o, d.points, d.point, d.segments, d.segment, d.loop, &none));
  assert_null(none);
  bw_release(smaller);
  bw_release(larger);
  bw_release(o);
}

/* ---- splits and joins ------------------------------------------------------------------------ */

static void a_join_undoes_a_split(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context), *finer = NULL, *again = NULL;
  for (int32_t s = 0; s < o->segment_count; s += 3) {
    bool line = o->segment[s].point[1] < 0;
    check_ok(context, bw_outline_split(context, o, s, 0.3, &finer));
    check_outline(context, finer);
    assert_int_equal(finer->segment_count, o->segment_count + 1);
    assert_int_equal(finer->point_count, o->point_count + (line ? 1 : 3));
    assert_int_equal(finer->segment[s + 1].point[0], o->point_count);
    assert_int_equal(finer->segment[s + 1].tag, o->segment[s].tag);
    check_near(area(context, finer), area(context, o), 1e-13);
    for (int k = 0; k <= 10; k++) { /* the same curve */
      double a[2], b[2], t = k / 10.0;
      bw_outline_evaluate(o, s, t, a, NULL, NULL);
      bw_outline_evaluate(finer, t < 0.3 ? s : s + 1, t < 0.3 ? t / 0.3 : (t - 0.3) / 0.7, b, NULL,
                          NULL);
      check_near(a[0], b[0], 1e-14);
      check_near(a[1], b[1], 1e-14);
    }
    check_ok(context, bw_outline_joined(context, finer, o->point_count, &again));
    check_outline(context, again);
    assert_int_equal(again->point_count, o->point_count);
    for (int32_t i = 0; i < again->segment_count; i++)
      for (int k = 0; k <= 4; k++) {
        double a[2], b[2];
        bw_outline_evaluate(o, i, k / 4.0, a, NULL, NULL);
        bw_outline_evaluate(again, i, k / 4.0, b, NULL, NULL);
        check_near(a[0], b[0], 1e-14);
        check_near(a[1], b[1], 1e-14);
      }
    bw_release(finer);
    bw_release(again);
  }
  check_fails(context, BW_INVALID, "between 0 and 1", bw_outline_split(context, o, 0, 1, &finer));
  check_fails(context, BW_INVALID, "segment 17", bw_outline_split(context, o, 16, 0.5, &finer));
  check_fails(context, BW_INVALID, "control point", bw_outline_joined(context, o, 5, &finer));
  /* a line and a cubic give a cubic with their directions at its ends */
  draft d = {0};
  draft_cubics(&d, "d", 0, 2, (double[]){0, 0, 1, -1, 2, -1, 3, 0, 4, 1, 4, 2});
  d.segment[1].point[1] = d.segment[1].point[2] = -1;
  d.points = 4;
  draft_point(&d, 3, 3);
  d.segment[1].point[3] = 4;
  d.segment[2] = (bw_segment){{4, -1, -1, 0}, 0};
  d.loop[0].count = d.segments = 3;
  bw_release(o);
  o = draft_make(context, &d);
  check_ok(context, bw_outline_joined(context, o, 3, &again));
  check_outline(context, again);
  double first[2], second[2];
  bw_outline_evaluate(again, 0, 0, first, second, NULL);
  check_near(second[0], -second[1], 1e-12);
  bw_outline_evaluate(again, 0, 1, first, second, NULL);
  check_near(first[1], 3, 0);
  check_near(second[0], 0, 1e-12);
  bw_release(again);
  bw_release(o);
}

/* ---- smoothing ------------------------------------------------------------------------------- */

static void smoothing_evens_a_wave_and_keeps_corners(void **state) {
  bw_context *context = check_context(state);
  draft d = {0};
  double xy[2 * 44];
  for (int i = 0; i <= 40; i++) { /* a saw of small teeth along the upper edge */
    xy[2 * i] = 4 - i * 0.1;
    xy[2 * i + 1] = 2 + 0.005 * (i % 2 == 0 ? 1 : -1);
  }
  memcpy(xy + 82, (double[]){0, 0, 4, 0}, 4 * sizeof *xy);
  draft_polygon(&d, "saw", 0, 43, xy);
  bw_outline *o = draft_make(context, &d), *smooth = NULL, *same = NULL;
  check_ok(context, bw_outline_smoothed(context, o, 0, 0.5, 10, 0.5, &smooth));
  assert_true(bw_outline_same_topology(o, smooth));
  for (int i = 10; i <= 30; i++)
    check_near(smooth->point[2 * i + 1], 2, 1e-5);
  const int corner[4] = {0, 40, 41, 42};
  for (int i = 0; i < 4; i++)
    assert_memory_equal(smooth->point + 2 * corner[i], o->point + 2 * corner[i],
                        2 * sizeof(double));
  check_ok(context, bw_outline_smoothed(context, o, 0, 0.5, 10, 0, &same));
  assert_memory_equal(same->point, o->point, 86 * sizeof(double)); /* all turn by more than 0 */
  bw_release(same);
  check_ok(context, bw_outline_smoothed(context, o, 0, 0, 10, PI, &same));
  assert_memory_equal(same->point, o->point, 86 * sizeof(double));
  check_fails(context, BW_INVALID, "a strength of 0 to 1",
              bw_outline_smoothed(context, o, 0, 1.5, 1, 0, &same));
  bw_release(same);
  bw_release(smooth);
  bw_release(o);
  /* a circle stays round */
  d = (draft){0};
  draft_circle(&d, "disc", 0, 0, 0, 1);
  o = draft_make(context, &d);
  check_ok(context, bw_outline_smoothed(context, o, 0, 0.2, 3, 0.5, &smooth));
  for (int i = 0; i < 3; i++)
    check_near(hypot(smooth->point[6 * i], smooth->point[6 * i + 1]), hypot(smooth->point[0], 0),
               1e-15);
  bw_release(smooth);
  bw_release(o);
}

/* ---- pulling --------------------------------------------------------------------------------- */

static bw_outline *ring(bw_context *context, int32_t count) {
  draft d = {0};
  double xy[2 * 200];
  for (int32_t i = 0; i < count; i++) {
    xy[2 * i] = cos(2 * PI * i / count);
    xy[2 * i + 1] = sin(2 * PI * i / count);
  }
  draft_polygon(&d, "ring", 0, count, xy);
  draft_circle(&d, "hole", -1, 0, 0, 0.1);
  return draft_make(context, &d);
}

static void pulling_without_strain_is_rigid(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = ring(context, 40), *pulled = NULL;
  check_ok(context, bw_outline_pulled(context, o, 10, (double[]){0.05, 1.02}, 0, NULL, 0, &pulled));
  for (int i = 0; i < 40; i++) {
    check_near(pulled->point[2 * i] - o->point[2 * i], 0.05, 1e-15);
    check_near(pulled->point[2 * i + 1] - o->point[2 * i + 1], 0.02, 1e-15);
  }
  assert_memory_equal(pulled->point + 80, o->point + 80, 24 * sizeof(double));
  bw_release(pulled);
  /* on a circle about the only pin, which is point 0: everything turns about it */
  const int32_t pin[2] = {0, 20};
  double turn = 0.3, c = cos(turn), s = sin(turn);
  double x = o->point[40] - 1, y = o->point[41];
  check_ok(context, bw_outline_pulled(context, o, 20, (double[]){1 + c * x - s * y, s * x + c * y},
                                      1, pin, 0, &pulled));
  for (int i = 0; i < 40; i++) {
    x = o->point[2 * i] - 1;
    y = o->point[2 * i + 1];
    check_near(pulled->point[2 * i], 1 + c * x - s * y, 1e-6);
    check_near(pulled->point[2 * i + 1], s * x + c * y, 1e-6);
  }
  bw_release(pulled);
  /* to where it is already */
  check_ok(context, bw_outline_pulled(context, o, 10, o->point + 20, 2, pin, 0, &pulled));
  for (int i = 0; i < 80; i++)
    check_near(pulled->point[i], o->point[i], 1e-15);
  bw_release(pulled);
  bw_release(o);
}

static void pulling_bends_what_lies_between_pins(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = ring(context, 80), *pulled = NULL;
  const int32_t pin[2] = {0, 40};
  check_ok(context, bw_outline_pulled(context, o, 20, (double[]){0, 1.3}, 2, pin, 0, &pulled));
  check_near(pulled->point[41], 1.3, 0);
  for (int i = 40; i <= 80; i++) /* below nothing moves */
    assert_memory_equal(pulled->point + 2 * (i % 80), o->point + 2 * (i % 80), 2 * sizeof(double));
  for (int i = 0; i <= 20; i++) { /* mirror images */
    check_near(pulled->point[2 * i], -pulled->point[2 * (40 - i)], 1e-12);
    check_near(pulled->point[2 * i + 1], pulled->point[2 * (40 - i) + 1], 1e-12);
  }
  /* edges are longer by the same small part, roughly */
  double min = 10, max = 0, before = 2 * sin(PI / 80);
  for (int i = 0; i < 20; i++) {
    double length = hypot(pulled->point[2 * i + 2] - pulled->point[2 * i],
                          pulled->point[2 * i + 3] - pulled->point[2 * i + 1]);
    min = fmin(min, length / before);
    max = fmax(max, length / before);
  }
  assert_true(min > 1 && max < 1.35 && max / min < 1.15);
  bw_release(pulled);
  /* within a reach nothing else moves */
  check_ok(context, bw_outline_pulled(context, o, 20, (double[]){0, 1.1}, 0, NULL, 0.5, &pulled));
  for (int i = 0; i < 80; i++) {
    double moved = hypot(pulled->point[2 * i] - o->point[2 * i],
                         pulled->point[2 * i + 1] - o->point[2 * i + 1]);
    if (abs(i - 20) >= 7)
      check_near(moved, 0, 0);
    else
      assert_true(moved > 1e-4 && moved < 0.11);
  }
  bw_release(pulled);
  pulled = NULL;
  check_fails(context, BW_INVALID, "pinned too",
              bw_outline_pulled(context, o, 40, (double[]){0, 1.1}, 2, pin, 0, &pulled));
  check_fails(context, BW_INVALID, "finite",
              bw_outline_pulled(context, o, 20, (double[]){0, NAN}, 2, pin, 0, &pulled));
  check_fails(context, BW_GEOMETRY, "crosses",
              bw_outline_pulled(context, o, 20, (double[]){0, 0}, 2, pin, 0, &pulled));
  assert_null(pulled);
  bw_release(o);
}

/* Wild pulls of curves: refused with the outline kept, or a valid outline. */
static void random_pulls_stay_valid(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context);
  bw_random random;
  bw_random_seed(&random, 7);
  int made = 0;
  for (int round = 0; round < 400; round++) {
    int32_t vertex = o->segment[bw_random_bits(&random) % (uint64_t)o->segment_count].point[0];
    int32_t pin[2];
    int pins = (int)(bw_random_bits(&random) % 3);
    for (int i = 0; i < pins; i++)
      pin[i] = o->segment[bw_random_bits(&random) % (uint64_t)o->segment_count].point[0];
    double to[2], reach = round % 3 == 0 ? 2 * bw_random_uniform(&random) : 0;
    for (int k = 0; k < 2; k++)
      to[k] = o->point[2 * vertex + k] + 0.3 * bw_random_normal(&random);
    bw_outline *pulled = NULL;
    bw_status status = bw_outline_pulled(context, o, vertex, to, pins, pin, reach, &pulled);
    assert_true(status == BW_OK || status == BW_GEOMETRY || status == BW_INVALID);
    if (status != BW_OK)
      continue;
    check_near(pulled->point[2 * vertex], to[0], 1e-15);
    made++;
    bw_release(o);
    o = pulled;
  }
  check_outline(context, o);
  assert_true(made > 40);
  bw_release(o);
}

/* ---- tags and places -------------------------------------------------------------------- */

static void tags_change(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context), *tagged = NULL, *none = NULL;
  const int32_t segment[2] = {0, 9}, wrong = 99;
  check_ok(context, bw_outline_tagged(context, o, 2, segment, "wall", &tagged));
  check_outline(context, tagged);
  assert_int_equal(tagged->tag_count, 3);
  for (int32_t s = 0; s < o->segment_count; s++)
    assert_int_equal(tagged->segment[s].tag, s == 0 || s == 9 ? 2 : o->segment[s].tag);
  assert_false(bw_outline_same_topology(o, tagged));
  check_fails(context, BW_INVALID, "segment 100",
              bw_outline_tagged(context, o, 1, &wrong, "wall", &none));
  check_fails(context, BW_INVALID, "1 to 47 bytes",
              bw_outline_tagged(context, o, 1, segment, "", &none));
  bw_release(tagged);
  bw_release(o);
}

static void the_nearest_place(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context);
  bw_random random;
  bw_random_seed(&random, 3);
  bw_outline_place place = bw_outline_nearest(o, (double[]){3, -1});
  assert_int_equal(place.segment, 0);
  check_near(place.t, 0.5, 1e-15);
  check_near(place.distance, 1, 1e-15);
  for (int round = 0; round < 200; round++) { /* against samples */
    double at[2] = {8 * bw_random_uniform(&random) - 1, 6 * bw_random_uniform(&random) - 1};
    double min = 100;
    for (int32_t s = 0; s < o->segment_count; s++)
      for (int k = 0; k <= 2000; k++) {
        double p[2];
        bw_outline_evaluate(o, s, k / 2000.0, p, NULL, NULL);
        min = fmin(min, hypot(p[0] - at[0], p[1] - at[1]));
      }
    place = bw_outline_nearest(o, at);
    assert_true(place.distance <= min + 1e-15);
    check_near(place.distance, min, 2e-3);
    check_near(bw_segment_nearest(o, place.segment, at).distance, place.distance, 0);
  }
  check_near(bw_segment_length(o, 1), 4, 1e-14);
  assert_int_equal(bw_segment_loop(o, 3), 0);
  assert_int_equal(bw_segment_loop(o, 4), 1);
  assert_int_equal(bw_segment_loop(o, 15), 3);
  bw_release(o);
}

/* ---- polygons -------------------------------------------------------------------------------- */

static void polygons_keep_their_tolerance(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context);
  bw_polygons p;
  check_ok(context, bw_outline_flatten(context, o, 1e-4, &p));
  assert_int_equal(p.loop_count, 4);
  assert_int_equal(p.start[1] - p.start[0], 4);
  assert_true(p.start[2] - p.start[1] > 100 && p.start[2] - p.start[1] < 400);
  double worst = 0;
  for (int32_t i = p.start[1]; i < p.start[2]; i++) { /* midpoints of chords lie that far inside */
    const double *a = p.point + 2 * i;
    const double *b = p.point + 2 * (i + 1 < p.start[2] ? i + 1 : p.start[1]);
    worst = fmax(worst, 1 - hypot((a[0] + b[0]) / 2 - 2, (a[1] + b[1]) / 2 - 2));
  }
  assert_true(worst < 1.01e-4 && worst > 2e-5);
  bw_polygons_clear(&p);
  check_fails(context, BW_INVALID, "a length above 0 expected",
              bw_outline_flatten(context, o, 0, &p));
  check_fails(context, BW_LIMIT, "choose a larger one", bw_outline_flatten(context, o, 1e-17, &p));
  bw_release(o);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static bw_status everything(bw_context *context, const bw_outline *o) {
  bw_status status = BW_OK;
  bw_outline *made[5] = {NULL};
  bw_polygons p = {0};
  draft d = {0};
  draft_circle(&d, "second", -1, 5, 3, 0.5);
  const int32_t pin[2] = {4, 10};
  BW_TRY(
      bw_outline_with_loop(context, o, d.points, d.point, d.segments, d.segment, d.loop, &made[0]));
  BW_TRY(bw_outline_without_loop(context, o, 1, &made[1]));
  BW_TRY(bw_outline_split(context, o, 5, 0.5, &made[2]));
  BW_TRY(bw_outline_joined(context, made[2], o->point_count, &made[3]));
  BW_TRY(bw_outline_pulled(context, o, 7, (double[]){2, 3.1}, 2, pin, 0, &made[4]));
  bw_release(made[4]);
  made[4] = NULL;
  BW_TRY(bw_outline_smoothed(context, o, 1, 0.1, 1, 2, &made[4]));
  BW_TRY(bw_outline_flatten(context, o, 0.01, &p));
  bw_release(made[3]);
  made[3] = NULL;
  BW_TRY(bw_outline_tagged(context, o, 1, pin, "wall", &made[3]));
done:
  bw_polygons_clear(&p);
  for (int i = 0; i < 5; i++)
    bw_release(made[i]);
  return status;
}

static void memory_failures_lose_nothing(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = plate(context);
  check_ok(context, everything(context, o));
  for (int n = 1;; n++) {
    int64_t before = bw_live_blocks();
    bw_fail_allocation(n, true);
    bw_status status = everything(context, o);
    bw_fail_allocation(0, false);
    bw_clear_failure(context);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
    assert_true(bw_live_blocks() <= before + 8);
    assert_true(n < 300);
  }
  bw_release(o);
}

check_main(check_test(a_loop_more_and_fewer), check_test(a_join_undoes_a_split),
           check_test(smoothing_evens_a_wave_and_keeps_corners),
           check_test(pulling_without_strain_is_rigid),
           check_test(pulling_bends_what_lies_between_pins), check_test(random_pulls_stay_valid),
           check_test(tags_change), check_test(the_nearest_place),
           check_test(polygons_keep_their_tolerance), check_test(memory_failures_lose_nothing))
