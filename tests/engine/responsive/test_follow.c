/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sheets that follow a dragged outline: after every drag the answer with everything reused is that
 * of a sheet built on the same mesh, for statics, transients and large deflections; and curved
 * outlines: NAFEMS LE1, Kirsch's hole. */
#include "outline/shapes.h"
#include "sheets.h"
#include "solver_by.h"

enum { DRAGS = 24 };

/* A plate 2 x 1, fixed at the left, with a round hole. */
static bw_outline *plate(bw_context *context, double x, double y, double r) {
  static draft d;
  memset(&d, 0, sizeof d);
  draft_rectangle(&d, "plate", 0, 0, 0, 2, 1);
  draft_circle(&d, "hole", -1, x, y, r);
  for (int i = 0; i < 4; i++)
    d.segment[i].tag = i;
  for (int i = 4; i < 8; i++)
    d.segment[i].tag = 4;
  d.tags = 5;
  static const char *const name[] = {"bottom", "right", "top", "left", "hole"};
  for (int i = 0; i < 5; i++)
    strcpy(d.tag[i].text, name[i]);
  return draft_make(context, &d);
}

static bw_outline *hole_at(bw_context *context, const bw_outline *outline, double dx, double dy) {
  bw_outline *moved;
  double *weight = BW_NEW(context, double, outline->point_count);
  double *point = BW_NEW(context, double, 2 * outline->point_count);
  check_ok(context, bw_outline_handle(context, outline, BW_HANDLE_LOOP, 1, weight));
  for (int32_t i = 0; i < outline->point_count; i++) {
    point[2 * i] = outline->point[2 * i] + weight[i] * dx;
    point[2 * i + 1] = outline->point[2 * i + 1] + weight[i] * dy;
  }
  check_ok(context, bw_outline_moved(context, outline, point, &moved));
  bw_free(weight);
  bw_free(point);
  return moved;
}

typedef enum kind { STATIC, TRANSIENT, LARGE_DEFLECTION } kind;

static double shaking(void *data, const double at[2], double time) {
  (void)data, (void)at;
  return 0.01 * sin(30 * time);
}

static bw_sheet *make(bw_context *context, const bw_plane_mesh *mesh, const bw_material *material,
                      kind what) {
  bw_condition conditions[3] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1, .function = what == TRANSIENT ? shaking : NULL},
      {.tag = RIGHT,
       .kind = BW_TRACTION,
       .component = 1,
       .value = what == LARGE_DEFLECTION ? -15 : -10}};
  bw_sheet_section section = {material, 1, false};
  bw_sheet_description description = {.section_count = 1,
                                      .section = &section,
                                      .condition_count = 3,
                                      .condition = conditions,
                                      .gravity = {0, -1}};
  bw_sheet *sheet;
  check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
  return sheet;
}

static void step(bw_context *context, bw_sheet *sheet, kind what, lagged_way way,
                 bw_plane_reuse *reuse) {
  bw_lagged_factor_options options;
  bw_large_deflection_options newton;
  bw_newmark newmark;
  bw_lagged_factor_options_default(&options);
  bw_large_deflection_options_default(&newton);
  bw_newmark_default(&newmark);
  newmark.step = 5e-3;
  options.solver = newton.linear.solver = lagged_by(true, way);
  if (what == STATIC)
    check_ok(context, bw_sheet_static(context, sheet, &options, reuse));
  else if (what == TRANSIENT)
    check_ok(context, bw_sheet_transient(context, sheet, &newmark, &options, reuse));
  else
    check_ok(context, bw_sheet_large_deflection(context, sheet, &newton, NULL, reuse));
}

static void drag(bw_context *context, kind what, int order) {
  bw_material *material = isotropic(context, 1e4, 0.3, 1);
  bw_outline *outline = plate(context, 0.6, 0.5, 0.2);
  bw_plane_options fill;
  bw_plane_mesh *mesh;
  bw_mesh_motion *motion;
  bw_follow_options follow;
  bw_plane_options_default(&fill);
  fill.order = order;
  fill.elements = 300;
  bw_follow_options_default(&follow);
  follow.fill = fill;
  check_ok(context, bw_plane_fill(context, outline, &fill, &mesh));
  check_ok(context, bw_mesh_motion_create(context, mesh, &follow, &motion));
  bw_sheet *reused = make(context, mesh, material, what);
  bw_sheet *fresh = make(context, mesh, material, what); /* for TRANSIENT: history needed */
  bw_random random;
  bw_random_seed(&random, 9 + (uint64_t)what);
  double x = 0.6, y = 0.5;
  int seen[4] = {0}, lagged = 0;
  for (int k = 0; k < DRAGS; k++) {
    double to_x = 0.4 + 1.2 * bw_random_uniform(&random),
           to_y = 0.4 + 0.2 * bw_random_uniform(&random);
    double share = k % 3 == 0 ? 1 : 0.05;
    double dx = share * (to_x - x), dy = share * (to_y - y);
    bw_outline *moved = hole_at(context, outline, dx, dy);
    bw_follow_report report;
    bw_plane_reuse reuse = {0};
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    x += dx;
    y += dy;
    check_ok(context, bw_sheet_follow(context, reused, motion->mesh, &reuse));
    assert_int_equal(reuse.level, report.level);
    seen[report.level]++;
    step(context, reused, what, LAGGED_AUTO, &reuse);
    lagged += reuse.factor;
    if (k > 0)
      assert_true(reuse.pattern == (report.level < BW_LEVEL_RECONNECTING));
    if (what == TRANSIENT)
      check_ok(context, bw_sheet_follow(context, fresh, motion->mesh, NULL));
    else {
      bw_release(fresh);
      fresh = make(context, motion->mesh, material, what);
    }
    step(context, fresh, what, LAGGED_FULL, NULL);
    double max = 0, off = 0;
    for (int32_t i = 0; i < 2 * motion->mesh->topology->nodes->node_count; i++) {
      max = fmax(max, fabs(fresh->displacement[i]));
      off = fmax(off, fabs(fresh->displacement[i] - reused->displacement[i]));
    }
    assert_true(max > 0 && off <= 1e-6 * max);
    bw_release(outline);
    outline = moved;
  }
  assert_true(seen[BW_LEVEL_RELOCATION] > 0);
  assert_true(seen[BW_LEVEL_RECONNECTING] + seen[BW_LEVEL_RECONSTRUCTION] > 0);
  assert_true(lagged > 0 || what == TRANSIENT); /* on so few nodes a new factor is soon as cheap */
  bw_release(reused);
  bw_release(fresh);
  bw_release(motion);
  bw_release(mesh);
  bw_release(outline);
  bw_release(material);
}

static void test_static(void **state) {
  drag(check_context(state), STATIC, 1);
  drag(check_context(state), STATIC, 2);
}
static void test_transient(void **state) {
  drag(check_context(state), TRANSIENT, 1);
  drag(check_context(state), TRANSIENT, 2);
}
static void test_large_deflection(void **state) {
  drag(check_context(state), LARGE_DEFLECTION, 1);
  drag(check_context(state), LARGE_DEFLECTION, 2);
}

/* Memory that runs out anywhere in a frame: the frame fails, the sheet is as it was, and goes on.
 */
static void memory(bw_context *context, kind what, int order, double by) {
  bw_material *material = isotropic(context, 1e4, 0.3, 1);
  bw_outline *outline = plate(context, 0.6, 0.5, 0.2), *moved;
  bw_plane_options fill;
  bw_plane_mesh *mesh;
  bw_follow_options follow;
  bw_status status = BW_MEMORY;
  check_ok(context, bw_set_threads(context, 1));
  bw_plane_options_default(&fill);
  fill.order = order;
  fill.elements = 60;
  bw_follow_options_default(&follow);
  follow.fill = fill;
  follow.force = by > 0.2 ? BW_LEVEL_RECONSTRUCTION : BW_LEVEL_NONE;
  check_ok(context, bw_plane_fill(context, outline, &fill, &mesh));
  moved = hole_at(context, outline, by, 0);
  bw_mesh_motion *motion;
  check_ok(context, bw_mesh_motion_create(context, mesh, &follow, &motion));
  check_ok(context, bw_mesh_motion_follow(context, motion, moved, NULL));
  for (int n = 1; status != BW_OK; n += 3) {
    bw_sheet *sheet = make(context, mesh, material, what);
    step(context, sheet, what, LAGGED_AUTO, NULL);
    bw_plane_reuse reuse = {0};
    double norm, *gradient = BW_NEW(context, double, 2 * motion->mesh->topology->nodes->node_count);
    bw_fail_allocation(n, true);
    status = bw_sheet_follow(context, sheet, motion->mesh, &reuse);
    if (status == BW_OK && what == STATIC)
      status = bw_sheet_static(context, sheet, NULL, &reuse);
    else if (status == BW_OK && what == TRANSIENT)
      status = bw_sheet_transient(context, sheet, NULL, NULL, &reuse);
    else if (status == BW_OK)
      status = bw_sheet_large_deflection(context, sheet, NULL, NULL, &reuse);
    if (status == BW_OK && what == STATIC)
      status = bw_sheet_stress_gradient(context, sheet, 6, &norm, gradient);
    bw_fail_allocation(0, false);
    assert_true(status == BW_OK || status == BW_MEMORY);
    assert_true(n < 3000);
    check_ok(context, bw_sheet_follow(context, sheet, motion->mesh, &reuse));
    step(context, sheet, what, LAGGED_AUTO, NULL);
    bw_free(gradient);
    bw_release(sheet);
  }
  bw_release(motion);
  bw_release(moved);
  bw_release(mesh);
  bw_release(outline);
  bw_release(material);
}

static void test_memory(void **state) {
  for (int order = 1; order <= 2; order++)
    for (kind what = STATIC; what <= LARGE_DEFLECTION; what++) {
      memory(check_context(state), what, order, 0.02);
      memory(check_context(state), what, order, 0.3);
    }
}

/* ---- curved outlines ------------------------------------------------------------------------- */

/* Conditions go by the names of tags: another outline may have them in another order. */
static void test_renamed(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e4, 0.3, 1);
  bw_outline *outline = plate(context, 0.6, 0.5, 0.2), *other, *without;
  bw_segment segment[8];
  bw_name tag[5];
  memcpy(segment, outline->segment, sizeof segment);
  for (int i = 0; i < 8; i++)
    segment[i].tag = 4 - segment[i].tag;
  for (int i = 0; i < 5; i++)
    tag[i] = outline->tag[4 - i];
  check_ok(context, bw_outline_create(context, outline->point_count, outline->point, 8, segment, 2,
                                      outline->loop, 5, tag, &other));
  strcpy(tag[1].text, "Left");
  check_ok(context, bw_outline_create(context, outline->point_count, outline->point, 8, segment, 2,
                                      outline->loop, 5, tag, &without));
  bw_plane_options fill;
  bw_plane_mesh *mesh[3];
  const bw_outline *const of[3] = {outline, other, without};
  bw_plane_options_default(&fill);
  fill.elements = 300;
  for (int i = 0; i < 3; i++)
    check_ok(context, bw_plane_fill(context, of[i], &fill, &mesh[i]));
  bw_sheet *sheet = make(context, mesh[0], material, STATIC);
  step(context, sheet, STATIC, LAGGED_AUTO, NULL);
  int32_t corner = node_at(mesh[0], 2, 1);
  double before = sheet->displacement[2 * corner + 1];
  check_fails(context, BW_INVALID, "no tag 'left'", bw_sheet_follow(context, sheet, mesh[2], NULL));
  step(context, sheet, STATIC, LAGGED_AUTO, NULL);
  check_near(sheet->displacement[2 * corner + 1], before, 1e-6 * fabs(before));
  check_ok(context, bw_sheet_follow(context, sheet, mesh[1], NULL));
  step(context, sheet, STATIC, LAGGED_AUTO, NULL);
  check_near(sheet->displacement[2 * node_at(mesh[1], 2, 1) + 1], before, 1e-6 * fabs(before));
  bw_release(sheet);
  for (int i = 0; i < 3; i++)
    bw_release(mesh[i]);
  bw_release(outline);
  bw_release(other);
  bw_release(without);
  bw_release(material);
}

/* A quarter of an ellipse from (a, 0) to (0, b), or backwards. */
static void quarter(double a, double b, bool back, double p[8]) {
  const double k = 0.5522847498307936;
  double q[8] = {a, 0, a, k * b, k * a, b, 0, b};
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 2; c++)
      p[2 * i + c] = q[2 * (back ? 3 - i : i) + c];
}

static double near_d(void *data, const double at[2]) {
  const double *d = data;
  return d[2] + 0.15 * hypot(at[0] - d[0], at[1] - d[1]);
}

/* The quarter between two ellipses; tags: bottom, outside, left, inside. */
static bw_plane_mesh *between(bw_context *context, double a, double b, double outer_a,
                              double outer_b, bool box, double smallest) {
  static draft d;
  memset(&d, 0, sizeof d);
  double arc[8];
  bw_loop *loop = draft_loop(&d, "body", 0, box ? 5 : 4);
  int32_t inside = 0, s = loop->first;
  quarter(outer_a, outer_b, false, arc);
  draft_point(&d, a, 0);
  draft_point(&d, outer_a, 0);
  if (box) {
    draft_point(&d, outer_a, outer_b);
    draft_point(&d, 0, outer_b);
    d.segment[s++] = (bw_segment){{0, -1, -1, 1}, 0};
    d.segment[s++] = (bw_segment){{1, -1, -1, 2}, 1};
    d.segment[s++] = (bw_segment){{2, -1, -1, 3}, 4};
    inside = 3;
  } else {
    for (int i = 1; i < 4; i++)
      draft_point(&d, arc[2 * i], arc[2 * i + 1]);
    d.segment[s++] = (bw_segment){{0, -1, -1, 1}, 0};
    d.segment[s++] = (bw_segment){{1, 2, 3, 4}, 1};
    inside = 4;
  }
  int32_t start = draft_point(&d, 0, b);
  d.segment[s++] = (bw_segment){{inside, -1, -1, start}, 2};
  quarter(a, b, true, arc);
  int32_t control = draft_point(&d, arc[2], arc[3]);
  draft_point(&d, arc[4], arc[5]);
  d.segment[s++] = (bw_segment){{start, control, control + 1, 0}, 3};
  d.tags = 5;
  for (int i = 0; i < 5; i++)
    snprintf(d.tag[i].text, sizeof d.tag[i].text, "t%d", i);
  bw_outline *outline = draft_make(context, &d);
  bw_plane_options fill;
  bw_plane_mesh *mesh;
  double field[3] = {box ? 0 : a, box ? b : 0, smallest};
  bw_plane_options_default(&fill);
  fill.order = 2;
  fill.field = near_d;
  fill.field_data = field;
  check_ok(context, bw_plane_fill(context, outline, &fill, &mesh));
  bw_release(outline);
  return mesh;
}

static double stress_at(bw_context *context, const bw_sheet *sheet, double x, double y, int part) {
  double *stress = BW_NEW(context, double, 4 * sheet->mesh->topology->nodes->node_count);
  check_ok(context, bw_sheet_stress(context, sheet, stress, NULL));
  double value = stress[4 * node_at(sheet->mesh, x, y) + part];
  bw_free(stress);
  return value;
}

/* 92.7 MPa at (2, 0) and the displacement there. */
static void test_le1(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 210e9, 0.3, 0);
  bw_plane_mesh *mesh = between(context, 2, 1, 3.25, 2.75, false, 0.02);
  bw_condition conditions[3] = {{.tag = 2, .component = 0},
                                {.tag = 0, .component = 1},
                                {.tag = 1, .kind = BW_PRESSURE, .value = -10e6}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 0.1, false, 3, conditions);
  double error;
  check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
  check_near(stress_at(context, sheet, 2, 0, 1), 92.7e6, 0.01 * 92.7e6);
  check_near(sheet->displacement[2 * node_at(mesh, 2, 0)], -0.000102208, 0.005 * 0.000102208);
  check_ok(context, bw_sheet_error(context, sheet, &error));
  assert_in_range((int)(error * 1e6), 1, 50000);
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
}

/* Three times the tension beside the hole, its negative on the axis: half width 20 radii. */
static void test_kirsch(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9, 0.3, 0);
  bw_plane_mesh *mesh = between(context, 1, 1, 20, 20, true, 0.06);
  bw_condition conditions[3] = {{.tag = 2, .component = 0},
                                {.tag = 0, .component = 1},
                                {.tag = 1, .kind = BW_TRACTION, .component = 0, .value = 1e3}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, true, 3, conditions);
  check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
  check_near(stress_at(context, sheet, 0, 1, 0), 3e3, 0.02 * 3e3);
  check_near(stress_at(context, sheet, 1, 0, 1), -1e3, 0.06 * 1e3);
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(test_static), check_test(test_transient), check_test(test_large_deflection),
           check_test(test_memory), check_test(test_renamed), check_test(test_le1),
           check_test(test_kirsch))
