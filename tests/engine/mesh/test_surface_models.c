/* The shared models: what the check finds in each, and what repair makes of the broken ones.
 * Skipped where the models are not there. With BARWRIGHT_FULL=1 the slow ones too, and remeshing.
 */
#include "check.h"

static const char *folder(void) {
  const char *shared = getenv("BARWRIGHT_SHARED");
  return shared ? shared : "../shared";
}

static bw_surface *read_model(bw_context *context, const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/models/%s", folder(), name);
  FILE *file = fopen(path, "rb");
  if (!file)
    skip();
  fclose(file);
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_read(context, path, &surface, NULL));
  return surface;
}

static bool full(void) {
  const char *text = getenv("BARWRIGHT_FULL");
  return text && text[0] == '1';
}

typedef struct good_model {
  const char *name;
  double volume; /* to four digits */
  bool slow;
} good_model;

static const good_model good[] = {
    {"bottle_opener_round.stl", 1.238e4, false},
    {"triceratops.off", 136.7, false},
    {"chair.ply", 0.1364, false},
    {"engine_bracket.obj", -907.8, false},
    {"rocker_arm.obj", 0.04251, false},
    {"fandisk.obj", 20.24, false},
    {"anchor.off", 0.1435, false},
    {"tray_bottom.stl", 3.479e5, false},
    {"fan_blade.stl", 6468, false},
    {"fertility.off", 4.322e5, false},
    {"boot.obj", 0.002548, true},
    {"cat.obj", 1.982, false},
    {"screwdriver.ply", 1.391e-5, false},
    {"gear_spur.stl", 1.322e5, false},
    {"armadillo.obj", 0.06862, true},
    {"ok_negative_indices.obj", 8, false},
    {"ok_ascii_odd_whitespace.stl", 1.322e5, false},
    {"ok_solid_header_binary.stl", 1.322e5, false},
};

static void test_good_models_are_sound(void **state) {
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    if (good[i].slow && !full())
      continue;
    bw_surface *surface = read_model(context, good[i].name);
    bw_surface_report report;
    check_ok(context, bw_surface_check(context, surface, 3, &report));
    bool inwards = good[i].volume < 0;
    if (report.sound == inwards || !report.closed ||
        report.count[BW_DEFECT_FLIPPED_SHELL] != inwards)
      fail_msg("%s: %s", good[i].name,
               report.defect_count ? bw_defect_word(report.defect[0].kind) : "sound");
    check_near(report.volume / good[i].volume, 1, 5e-4);
    bw_surface_report_clear(&report);
    bw_release(surface);
  }
}

/* The table's counts: open, non-manifold edges, non-manifold points, misoriented, duplicates. */
typedef struct bad_model {
  const char *name;
  int64_t open, edges, points, turned, doubled;
  bool cuts;     /* has self-intersections */
  double volume; /* after repair */
  double moved;  /* at most, of the diagonal */
  bool slow;
} bad_model;

static const bad_model bad[] = {
    {"bad_horse_selfint.ply", 0, 0, 0, 0, 0, true, 2.634e-4, 0.003, true},
    {"bad_raptor_quads.obj", 0, 0, 0, 0, 0, true, 27.75, 0.01, false},
    {"bad_chair_doublesided.obj", 0, 9518, 3158, 0, 6374, true, 0, 0.03, true},
    {"bad_pliers_shells.stl", 0, 0, 0, 0, 0, true, 1.707, 0.01, true},
    {"bad_gear_open.stl", 150, 10, 11, 0, 0, true, 1.482e4, 0.004, true},
    {"bad_spider_ascii.stl", 72, 0, 0, 10, 0, true, 9.816, 0.03, false},
    {"bad_idler_riser_inch.stl", 44, 0, 1, 0, 0, true, 1.488, 1e-5, false},
    {"bad_multibody_flipped.stl", 0, 0, 0, 12, 0, false, 0.007423, 1e-9, false},
    {"bad_quads_gear_two_shells.obj", 0, 0, 0, 0, 0, true, 35.09, 1e-6, false},
    {"bad_zero_area_dup.off", 6, 33, 36, 0, 10, true, 0.1435, 1e-6, false},
    {"bad_flipped_normals.stl", 0, 0, 0, 5322, 0, false, 0.1435, 1e-6, false},
};

static void test_bad_models_are_repaired(void **state) {
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const bad_model *model = &bad[i];
    if (model->slow && !full())
      continue;
    bw_surface *surface = read_model(context, model->name), *repaired = NULL;
    bw_surface_report report;
    bw_shape_log log;
    check_ok(context, bw_surface_check(context, surface, 0, &report));
    assert_false(report.sound);
    assert_int_equal(report.count[BW_DEFECT_OPEN_EDGE], model->open);
    assert_int_equal(report.count[BW_DEFECT_NONMANIFOLD_EDGE], model->edges);
    assert_int_equal(report.count[BW_DEFECT_NONMANIFOLD_POINT], model->points);
    assert_int_equal(report.count[BW_DEFECT_MISORIENTED_EDGE], model->turned);
    assert_true(report.count[BW_DEFECT_DUPLICATE_FACET] >= model->doubled);
    assert_int_equal(report.count[BW_DEFECT_SELF_INTERSECTION] > 0, model->cuts);
    double size[3];
    for (int k = 0; k < 3; k++)
      size[k] = report.max[k] - report.min[k];
    check_ok(context, bw_surface_repair(context, surface, NULL, &repaired, &log));
    check_ok(context, bw_surface_check(context, repaired, 0, &report));
    if (!report.sound)
      fail_msg("%s is not sound after repair", model->name);
    if (full()) {
      printf("%s:\n", model->name);
      for (int k = 0; k < log.count; k++)
        printf("  %s, moved %.3g: %s\n", log.step[k].name, log.step[k].moved, log.step[k].text);
    }
    if (model->volume > 0)
      check_near(report.volume / model->volume, 1, 2e-3);
    assert_true(log.moved <= model->moved * bw_norm(size));
    bw_release(repaired);
    bw_release(surface);
  }
}

static void test_needles_are_remeshed(void **state) {
  bw_context *context = check_context(state);
  static const char *const names[] = {"tray_bottom.stl", "gear_spur.stl", "bottle_opener_round.stl",
                                      "fan_blade.stl"};
  for (int i = 0; i < (full() ? 4 : 2); i++) {
    bw_surface *surface = read_model(context, names[i]), *remeshed = NULL;
    bw_surface_report report;
    check_ok(context, bw_surface_remesh(context, surface, NULL, &remeshed, NULL));
    check_ok(context, bw_surface_check(context, remeshed, 0, &report));
    assert_true(report.sound);
    check_near(report.volume / bw_surface_volume(surface), 1, 0.02);
    assert_true(remeshed->triangle_count < 4 * surface->triangle_count);
    bw_release(remeshed);
    bw_release(surface);
  }
}

check_main(check_test(test_good_models_are_sound), check_test(test_bad_models_are_repaired),
           check_test(test_needles_are_remeshed))
