/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Random drags of vertices, edges and loops, small ones and ones that fold the outline, for each of
 * the four elastic applications: every drag ends either in the answer that a fresh body on the
 * same mesh gives, or in a refusal with the last good state kept. No element is ever inverted, and
 * memory does not grow. BARWRIGHT_FULL=1: 10,000 drags for each application and a figure of each
 * run; BARWRIGHT_DRAGS: another number. */
#include <malloc.h>
#include <sys/resource.h>

#include "outline/shapes.h"
#include "sheets.h"
#include "solver_by.h"

typedef enum kind { STEADY, TRANSIENT, LARGE_DEFLECTION, RINGING } kind;
static const char *const kind_words[] = {"steady", "vibration", "cantilever", "metallophone"};

/* A beam with a curved top and a round hole; `inlay`: one with a region of its own, and straight.
 */
static bw_outline *beam(bw_context *context, bool inlay) {
  static draft d;
  memset(&d, 0, sizeof d);
  if (inlay) {
    draft_rectangle(&d, "body", 0, 0, 0, 2, 0.6);
    draft_polygon(&d, "inlay", 1, 3, (double[]){1.2, 0.15, 1.7, 0.2, 1.5, 0.45});
  } else {
    bw_loop *loop = draft_loop(&d, "body", 0, 5);
    const double p[] = {0, 0, 1, 0, 2, 0, 2, 0.6, 1.4, 0.8, 0.7, 0.4, 0, 0.6};
    for (int i = 0; i < 7; i++)
      draft_point(&d, p[2 * i], p[2 * i + 1]);
    const int32_t s[5][4] = {
        {0, -1, -1, 1}, {1, -1, -1, 2}, {2, -1, -1, 3}, {3, 4, 5, 6}, {6, -1, -1, 0}};
    for (int i = 0; i < 5; i++)
      memcpy(d.segment[loop->first + i].point, s[i], sizeof s[i]);
  }
  draft_circle(&d, "hole", -1, 0.6, 0.28, 0.14);
  d.tags = 2;
  strcpy(d.tag[0].text, "edge");
  strcpy(d.tag[1].text, "fixed");
  d.segment[inlay ? 3 : 4].tag = 1;
  return draft_make(context, &d);
}

/* The outline with a random handle moved; NULL where that is refused. */
static bw_outline *dragged(bw_context *context, const bw_outline *outline, bw_random *random) {
  bw_outline *moved = NULL;
  bw_handle_kind handle = (bw_handle_kind)(bw_random_bits(random) % 3);
  int32_t count = handle == BW_HANDLE_LOOP ? outline->loop_count : outline->segment_count;
  int32_t index = (int32_t)(bw_random_bits(random) % (uint64_t)count);
  if (handle == BW_HANDLE_VERTEX) /* by the number of a point */
    index = outline->segment[index].point[0];
  double wild = bw_random_uniform(random), size = wild < 0.5 ? 0.01 : wild < 0.9 ? 0.06 : 0.8;
  double by[2] = {size * bw_random_normal(random), size * bw_random_normal(random)};
  double *weight = malloc(sizeof(double) * (size_t)outline->point_count);
  double *point = malloc(sizeof(double) * 2 * (size_t)outline->point_count);
  check_ok(context, bw_outline_handle(context, outline, handle, index, weight));
  for (int32_t i = 0; i < 2 * outline->point_count; i++)
    point[i] = outline->point[i] + weight[i / 2] * by[i % 2];
  bw_status status = bw_outline_moved(context, outline, point, &moved);
  if (status != BW_OK) {
    assert_int_equal(status, BW_GEOMETRY);
    assert_true(strlen(bw_message(context)) > 20);
    assert_null(moved);
  }
  free(weight);
  free(point);
  return moved;
}

/* ---- the four applications ------------------------------------------------------------------- */

static double ground(void *data, const double at[2], double time) {
  (void)data, (void)at;
  return 0.01 * sin(30 * time);
}

static void *make(bw_context *context, kind what, const bw_plane_mesh *mesh,
                  const bw_material *material) {
  if (what == RINGING) {
    bw_plate *plate;
    check_ok(context, bw_plate_create(context, mesh, material, 0.05, &plate));
    return plate;
  }
  bw_condition conditions[3] = {
      {.tag = 0, .kind = BW_PRESSURE, .value = 3},
      {.tag = 1, .component = 0},
      {.tag = 1, .component = 1, .function = what == TRANSIENT ? ground : NULL}};
  bw_sheet_section section[2] = {{material, 0.5, false}, {material, 0.5, true}};
  bw_sheet_description description = {.section_count = mesh->outline->region_count,
                                      .section = section,
                                      .condition_count = 3,
                                      .condition = conditions,
                                      .gravity = {0, what == LARGE_DEFLECTION ? -30 : -5}};
  bw_sheet *sheet;
  check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
  return sheet;
}

static bw_status follow(bw_context *context, kind what, void *body, const bw_plane_mesh *mesh,
                        bw_plane_reuse *reuse) {
  return what == RINGING ? bw_plate_follow(context, body, mesh, reuse)
                         : bw_sheet_follow(context, body, mesh, reuse);
}

static bw_status solve(bw_context *context, kind what, void *body, bool full,
                       bw_plane_reuse *reuse) {
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  if (full)
    options.solver = lagged_by(true, LAGGED_FULL);
  if (what == RINGING) {
    bw_plate_options plate;
    bw_plate_options_default(&plate);
    plate.full = full;
    return bw_plate_solve(context, body, &plate, reuse);
  }
  if (what == LARGE_DEFLECTION) {
    bw_large_deflection_options newton;
    bw_large_deflection_options_default(&newton);
    newton.linear = options;
    return bw_sheet_large_deflection(context, body, &newton, NULL, reuse);
  }
  if (what == STEADY)
    return bw_sheet_static(context, body, &options, reuse);
  bw_newmark newmark;
  bw_newmark_default(&newmark);
  newmark.step = 5e-3;
  return bw_sheet_transient(context, body, &newmark, &options, reuse);
}

/* How far two bodies on the same mesh differ, relative to the larger answer. */
static double difference(kind what, const void *a, const void *b) {
  if (what == RINGING) {
    const bw_plate *p = a, *q = b;
    return fabs(p->frequency[0] - q->frequency[0]) / q->frequency[0];
  }
  const bw_sheet *p = a, *q = b;
  double max = 0, off = 0;
  for (int32_t i = 0; i < 2 * p->mesh->topology->nodes->node_count; i++) {
    assert_true(isfinite(p->displacement[i]));
    max = fmax(max, fabs(q->displacement[i]));
    off = fmax(off, fabs(p->displacement[i] - q->displacement[i]));
  }
  assert_true(max > 0);
  return off / max;
}

/* ---- the run --------------------------------------------------------------------------------- */

static int wanted_drags(void) {
  const char *count = getenv("BARWRIGHT_DRAGS"), *full = getenv("BARWRIGHT_FULL");
  return count ? atoi(count) : full && *full == '1' ? 5000 : 120;
}

typedef struct run {
  int outline_refused, mesh_refused, unsolved, level[4];
  double worst;
} run;

static void drags(bw_context *context, kind what, int order, uint64_t seed) {
  int count = wanted_drags(), every = count > 500 ? 10 : 1;
  run r = {0};
  double start = bw_seconds();
  bool inlay = order == 2 && what != RINGING;
  bw_material *material =
      isotropic(context, what == RINGING ? 70e9 : 1e4, 0.3, what == RINGING ? 2700 : 1);
  bw_outline *first = beam(context, inlay), *outline = bw_retain(first);
  bw_follow_options options;
  bw_plane_mesh *mesh;
  bw_mesh_motion *motion;
  bw_follow_options_default(&options);
  options.fill.order = order;
  options.fill.elements = 200;
  check_ok(context, bw_plane_fill(context, outline, &options.fill, &mesh));
  check_ok(context, bw_mesh_motion_create(context, mesh, &options, &motion));
  void *body = make(context, what, mesh, material), *beside = NULL;
  if (what == TRANSIENT)
    beside = make(context, what, mesh, material);
  bw_release(mesh);
  check_ok(context, solve(context, what, body, false, NULL));
  if (beside)
    check_ok(context, solve(context, what, beside, true, NULL));
  bw_random random;
  bw_random_seed(&random, seed);
  int64_t blocks = 0;
  size_t bytes = 0;
  for (int k = 0; k < count; k++) {
    /* now and then back to where it began, far from where it is */
    bool back = k % 60 == 59;
    bw_outline *moved = back ? bw_retain(first) : dragged(context, outline, &random);
    if (!moved) {
      r.outline_refused++;
      continue;
    }
    bw_follow_report report;
    bw_plane_reuse reuse = {0};
    const bw_plane_mesh *before = motion->mesh;
    const bw_mesh_motion_state *there = bw_mesh_motion_keep(motion);
    const bw_sheet_state *then = what == LARGE_DEFLECTION ? bw_sheet_keep(body) : NULL;
    bw_retain(before);
    bw_status status = bw_mesh_motion_follow(context, motion, moved, &report);
    if (status != BW_OK) { /* walls thinner than any mesh: the mesh motion is as it was */
      assert_true(!back && (status == BW_GEOMETRY || status == BW_LIMIT));
      assert_true(strlen(bw_message(context)) > 20);
      assert_ptr_equal(motion->mesh, before);
      r.mesh_refused++;
      bw_release(moved);
      bw_release(before);
      bw_release(there);
      bw_release(then);
      continue;
    }
    r.level[report.level]++;
    bw_plane_quality quality;
    bw_plane_measure(motion->mesh, &quality);
    assert_int_equal(quality.inverted, 0);
    assert_true(quality.worst > 0);
    check_ok(context, follow(context, what, body, motion->mesh, &reuse));
    status = solve(context, what, body, false, &reuse);
    if (status != BW_OK) { /* back to the last good state */
      assert_true(what == LARGE_DEFLECTION && status == BW_CONVERGENCE);
      r.unsolved++;
      check_ok(context, bw_mesh_motion_return(context, motion, there));
      assert_ptr_equal(motion->mesh, before);
      check_ok(context, bw_sheet_return(context, body, then));
      assert_ptr_equal(((bw_sheet *)body)->mesh, before);
      size_t numbers = 2 * (size_t)before->topology->nodes->node_count;
      double *last = malloc(numbers * sizeof *last);
      memcpy(last, ((bw_sheet *)body)->displacement, numbers * sizeof *last);
      check_ok(context, solve(context, what, body, false, &reuse));
      for (size_t i = 0; i < numbers; i++)
        check_near(((bw_sheet *)body)->displacement[i], last[i], 1e-6);
      free(last);
    }
    bw_release(before);
    bw_release(there);
    bw_release(then);
    if (status != BW_OK) {
      bw_release(moved);
      continue;
    }
    if (what == TRANSIENT) {
      check_ok(context, follow(context, what, beside, motion->mesh, NULL));
      check_ok(context, solve(context, what, beside, true, NULL));
    }
    if (k % every == 0) {
      void *fresh = what == TRANSIENT ? beside : make(context, what, motion->mesh, material);
      if (what != TRANSIENT)
        check_ok(context, solve(context, what, fresh, true, NULL));
      double off = difference(what, body, fresh);
      if (!(off <= 1e-6))
        fail_msg("%s, order %d, drag %d: %g off, level %d, quality %g", kind_words[what], order, k,
                 off, (int)report.level, quality.worst);
      r.worst = fmax(r.worst, off);
      if (what != TRANSIENT)
        bw_release(fresh);
    }
    if (what == TRANSIENT) { /* the same state again for the next step */
      const bw_sheet_state *same = bw_sheet_keep(body);
      check_ok(context, bw_sheet_return(context, beside, same));
      bw_release(same);
    }
    bw_release(outline);
    outline = moved;
    if (back) { /* always the same outline: what is alive then must not grow */
      struct mallinfo2 now = mallinfo2();
      if (k < count / 4 || blocks == 0) {
        blocks = blocks > bw_live_blocks() ? blocks : bw_live_blocks();
        bytes = bytes > now.uordblks + now.hblkhd ? bytes : now.uordblks + now.hblkhd;
      } else {
        assert_true(bw_live_blocks() <= blocks + 50);
        if (count > 500)
          assert_true(now.uordblks + now.hblkhd <= 2 * bytes);
      }
    }
  }
  assert_true(r.level[BW_LEVEL_RELOCATION] > 0);
  assert_true(r.level[BW_LEVEL_RECONNECTING] + r.level[BW_LEVEL_RECONSTRUCTION] > 0);
  assert_true(r.outline_refused > 0);
  bw_release(body);
  bw_release(beside);
  bw_release(motion);
  bw_release(outline);
  bw_release(first);
  bw_release(material);
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  printf("%s, order %d: %d drags, %.1f s; refused by outline %d, mesh %d, solution %d; "
         "relocation %d, reconnecting %d, reconstruction %d; largest difference %.1e; "
         "%ld MB at most\n",
         kind_words[what], order, count, bw_seconds() - start, r.outline_refused, r.mesh_refused,
         r.unsolved, r.level[BW_LEVEL_RELOCATION], r.level[BW_LEVEL_RECONNECTING],
         r.level[BW_LEVEL_RECONSTRUCTION], r.worst, usage.ru_maxrss / 1024);
}

static void test_steady(void **state) {
  drags(check_context(state), STEADY, 1, 1);
  drags(check_context(state), STEADY, 2, 2);
}
static void test_vibration(void **state) {
  drags(check_context(state), TRANSIENT, 1, 3);
  drags(check_context(state), TRANSIENT, 2, 4);
}
static void test_cantilever(void **state) {
  drags(check_context(state), LARGE_DEFLECTION, 1, 5);
  drags(check_context(state), LARGE_DEFLECTION, 2, 6);
}
static void test_metallophone(void **state) {
  drags(check_context(state), RINGING, 2, 7);
  drags(check_context(state), RINGING, 2, 8);
}

check_main(check_test(test_steady), check_test(test_vibration), check_test(test_cantilever),
           check_test(test_metallophone))
