/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sheets with large deflections: force and tangent against finite differences of the energy, the
 * elastica, Cook's membrane of St. Venant-Kirchhoff's material, uniform stretch by its closed form,
 * rigid rotation without stress, inversion reported. */
#include "responsive/large_deflection.h"
#include "sheets.h"

static void test_derivatives(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int strain = 0; strain < 2; strain++) {
      bw_material *material = isotropic(context, 3, 0.3, 1);
      bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 1, 1, 2, 2), 0.05);
      int size = 2 * mesh->topology->nodes->node_count;
      bw_sheet *sheet = sheet_on(context, mesh, material, 0.7, strain, 0, NULL);
      bool made;
      check_ok(context, bwi_sheet_prepare(context, sheet, &made));
      bwi_large_deflection bend;
      check_ok(context, bwi_large_deflection_prepare(context, sheet, &bend));
      double u[50], force[50], plus[50], minus[50], column[50], out[50], up, down;
      bw_random random;
      bw_random_seed(&random, 5);
      assert_true(size <= 50);
      for (int i = 0; i < size; i++)
        u[i] = 0.08 * bw_random_uniform(&random);
      bend.u = u;
      check_ok(context, bwi_large_deflection_evaluate(context, &bend, NULL, force));
      check_ok(context,
               bwi_large_deflection_tangent(context, &bend, sheet->inner->pattern,
                                            sheet->inner->workspace, sheet->inner->matrix));
      for (int i = 0; i < size; i++) {
        double h = 1e-5, was = u[i];
        u[i] = was + h;
        check_ok(context, bwi_large_deflection_evaluate(context, &bend, &up, plus));
        u[i] = was - h;
        check_ok(context, bwi_large_deflection_evaluate(context, &bend, &down, minus));
        u[i] = was;
        check_near(force[i], (up - down) / (2 * h), 1e-8);
        for (int k = 0; k < size; k++)
          column[k] = k == i;
        check_ok(context, bw_plane_multiply(context, sheet->inner->pattern, 2, sheet->inner->matrix,
                                            column, out));
        for (int k = 0; k < size; k++)
          check_near(out[k], (plus[k] - minus[k]) / (2 * h), 1e-7);
      }
      bwi_large_deflection_clear(&bend);
      bw_release(sheet);
      bw_release(mesh);
      bw_release(material);
    }
}

/* Exact elliptic integrals, ../shared/reference/elastica_cantilever.csv: P L^2 / (E I), deflection
 * and shortening over the length. */
static const double elastica[][3] = {{0.2, 0.06636448, 0.00264655},
                                     {1, 0.30172077, 0.05643324},
                                     {4, 0.66996418, 0.32894124},
                                     {10, 0.81060902, 0.55499560}};

static void test_elastica(void **state) {
  bw_context *context = check_context(state);
  double length = 1, height = 0.01, young = 1.2e7, inertia = height * height * height / 12;
  bw_material *material = isotropic(context, young, 0, 1);
  bw_plane_mesh *mesh = rectangle(context, 2, length, height, 40, 1);
  for (int k = 0; k < 4; k++) {
    double force = elastica[k][0] * young * inertia / (length * length);
    bw_condition conditions[3] = {
        {.tag = LEFT, .component = 0},
        {.tag = LEFT, .component = 1},
        {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = -force / height}};
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 3, conditions);
    bw_large_deflection_report report;
    check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, &report, NULL));
    int32_t tip = node_at(mesh, length, height / 2);
    check_near(-sheet->displacement[2 * tip + 1], elastica[k][1], 2e-3);
    check_near(-sheet->displacement[2 * tip], elastica[k][2], 2e-3);
    assert_true(report.residual <= 1e-6 && report.energy > 0);
    /* again, from the solution: nothing to do */
    check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, &report, NULL));
    assert_int_equal(report.load_steps, 1);
    assert_true(report.iterations <= 1);
    bw_release(sheet);
  }
  bw_release(mesh);
  bw_release(material);
}

/* Cook's membrane, plane strain, St. Venant-Kirchhoff, F = 100: 7.627 at the middle of the right
 * edge. */
static void test_cook(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 240.565, 0.3, 0);
  bw_plane_mesh *grid = rectangle(context, 2, 1, 1, 16, 16), *mesh;
  int32_t nodes = grid->topology->nodes->node_count;
  double *point = BW_NEW(context, double, 2 * nodes);
  double corner[8] = {0, 0, 48, 44, 48, 60, 0, 44};
  bw_outline *outline;
  for (int32_t i = 0; i < nodes; i++) {
    double x = grid->point[2 * i], y = grid->point[2 * i + 1];
    point[2 * i] = 48 * x;
    point[2 * i + 1] = 44 * x + y * (44 - 28 * x);
  }
  check_ok(context, bw_outline_moved(context, grid->outline, corner, &outline));
  check_ok(context, bw_plane_mesh_moved(context, grid, outline, point, &mesh));
  bw_condition conditions[3] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1},
      {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = 100.0 / 16}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, true, 3, conditions);
  check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL));
  check_near(sheet->displacement[2 * node_at(mesh, 48, 52) + 1], 7.627, 0.005 * 7.627);
  bw_free(point);
  bw_release(sheet);
  bw_release(outline);
  bw_release(mesh);
  bw_release(grid);
  bw_release(material);
}

/* Uniform stretch l of nu = 0: the nominal stress is E l (l^2 - 1) / 2, Cauchy's the same in the
 * direction of the pull, the width staying. */
static void test_stretch(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1000, 0, 0);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 2, 1, 4, 2), 0.1);
    double stretch = 1.4, nominal = 1000 * stretch * (stretch * stretch - 1) / 2;
    bw_condition conditions[3] = {
        {.tag = LEFT, .component = 0},
        {.tag = BOTTOM, .component = 1},
        {.tag = RIGHT, .kind = BW_TRACTION, .component = 0, .value = nominal}};
    bw_sheet *sheet = sheet_on(context, mesh, material, 0.1, false, 3, conditions);
    check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL));
    int32_t nodes = mesh->topology->nodes->node_count;
    double *stress = BW_NEW(context, double, 4 * nodes), *mises = BW_NEW(context, double, nodes);
    check_ok(context, bw_sheet_stress(context, sheet, stress, mises));
    for (int32_t i = 0; i < nodes; i++) {
      check_near(sheet->displacement[2 * i], (stretch - 1) * mesh->point[2 * i], 1e-7);
      check_near(sheet->displacement[2 * i + 1], 0, 1e-7);
      check_near(stress[4 * i], nominal, 1e-4);
      check_near(mises[i], nominal, 1e-4);
    }
    bw_free(stress);
    bw_free(mises);
    bw_release(sheet);
    bw_release(mesh);
  }
  bw_release(material);
}

/* A whole edge turned by half a right angle takes the sheet with it, without stress. */
static double turn_x(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return (at[0] * cos(0.8) - at[1] * sin(0.8)) - at[0];
}
static double turn_y(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return (at[0] * sin(0.8) + at[1] * cos(0.8)) - at[1];
}

static void test_rotation(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1000, 0.3, 0);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 1, 3, 3);
  bw_condition conditions[2] = {{.tag = LEFT, .component = 0, .function = turn_x},
                                {.tag = LEFT, .component = 1, .function = turn_y}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, true, 2, conditions);
  bw_large_deflection_report report;
  check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, &report, NULL));
  int32_t nodes = mesh->topology->nodes->node_count;
  for (int32_t i = 0; i < nodes; i++) {
    check_near(sheet->displacement[2 * i], turn_x(NULL, mesh->point + 2 * i, 0), 1e-6);
    check_near(sheet->displacement[2 * i + 1], turn_y(NULL, mesh->point + 2 * i, 0), 1e-6);
  }
  assert_true(report.energy < 1e-9);
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
}

/* A small load bends a sheet as linear statics says, on curved elements to rounding errors too:
 * half of what it does less what the opposite load does has no quadratic part, and the cubic one is
 * below. */
static void test_small_load(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e6, 0.3, 10);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 2, 1, 6, 4), 0.03);
    int32_t size = 2 * mesh->topology->nodes->node_count;
    if (order == 2)
      mesh = bowed(context, mesh, 0.02);
    double *sum = BW_NEW0(context, double, size), largest = 0;
    bw_lagged_factor_options linear;
    bw_large_deflection_options options;
    bw_large_deflection_options_default(&options);
    options.tolerance = 1e-11;
    bw_lagged_factor_options_default(&linear);
    linear.tolerance = 1e-11;
    for (int sign = -1; sign <= 1; sign += 2) {
      bw_condition conditions[3] = {
          {.tag = LEFT, .component = 0},
          {.tag = LEFT, .component = 1},
          {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = sign}};
      bw_sheet_section section = {material, 1, false};
      bw_sheet_description description = {.section_count = 1,
                                          .section = &section,
                                          .condition_count = 3,
                                          .condition = conditions,
                                          .gravity = {0.03 * sign, 0.01 * sign}};
      bw_sheet *large_deflection, *linear_one;
      check_ok(context, bw_sheet_create(context, mesh, &description, &large_deflection));
      check_ok(context, bw_sheet_create(context, mesh, &description, &linear_one));
      check_ok(context, bw_sheet_large_deflection(context, large_deflection, &options, NULL, NULL));
      check_ok(context, bw_sheet_static(context, linear_one, &linear, NULL));
      for (int32_t i = 0; i < size; i++) {
        sum[i] += 0.5 * sign * (large_deflection->displacement[i] - linear_one->displacement[i]);
        largest = fmax(largest, fabs(linear_one->displacement[i]));
      }
      bw_release(large_deflection);
      bw_release(linear_one);
    }
    for (int32_t i = 0; i < size; i++)
      check_near(sum[i] / largest, 0, 1e-8);
    bw_free(sum);
    bw_release(mesh);
  }
  bw_release(material);
}

/* St. Venant-Kirchhoff's material softens under compression: beyond sqrt(1/3) of its height no
 * equilibrium is left, which is reported and not shown as one. */
static void test_crushed(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1000, 0, 0);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 1, 4, 4);
  bw_condition conditions[3] = {{.tag = BOTTOM, .component = 0},
                                {.tag = BOTTOM, .component = 1},
                                {.tag = TOP, .kind = BW_PRESSURE, .value = 400}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 3, conditions);
  check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
  double before = sheet->displacement[2 * node_at(mesh, 1, 1) + 1];
  check_fails(context, BW_CONVERGENCE, "of its load",
              bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL));
  assert_true(sheet->displacement[2 * node_at(mesh, 1, 1) + 1] == before);
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
}

/* The unit square's inner nodes moved by t times a smooth field. */
static bw_plane_mesh *stirred(bw_context *context, const bw_plane_mesh *mesh, double t) {
  bw_plane_mesh *moved;
  int32_t nodes = mesh->topology->nodes->node_count;
  double *point = BW_NEW(context, double, 2 * nodes);
  for (int32_t i = 0; i < nodes; i++) {
    double x = mesh->point[2 * i], y = mesh->point[2 * i + 1];
    double by = t * sin(M_PI * x) * sin(M_PI * y);
    point[2 * i] = x + by;
    point[2 * i + 1] = y + 0.5 * by * by;
  }
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &moved));
  bw_free(point);
  return moved;
}

/* Frame after frame the answer is that from scratch; at constant speed the change of the last
 * frames is followed so well that one solve is enough; a stop, a turn and jumps do no harm. */
static void test_frames(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e4, 0.3, 1);
  bw_condition conditions[3] = {{.tag = LEFT, .component = 0},
                                {.tag = LEFT, .component = 1},
                                {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = 300}};
  static const double at[] = {0,     0.002, 0.004, 0.006, 0.008, 0.010, 0.012, 0.012,
                              0.012, 0.008, -0.04, 0.05,  0.051, 0.07,  0.07};
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = rectangle(context, order, 1, 1, 8, 8);
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 3, conditions);
    size_t size = 2 * (size_t)mesh->topology->nodes->node_count;
    for (int k = 0; k < (int)(sizeof at / sizeof *at); k++) {
      bw_plane_mesh *moved = stirred(context, mesh, at[k]);
      bw_plane_reuse reuse = {0};
      bw_large_deflection_report report;
      check_ok(context, bw_sheet_follow(context, sheet, moved, &reuse));
      check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, &report, &reuse));
      assert_true(report.residual <= 1e-8 && report.load_steps == 1);
      if (k >= 3 && k <= 6)
        assert_int_equal(reuse.solves, 1);
      if (k > 0 && at[k] == at[k - 1]) /* nothing to do */
        assert_int_equal(reuse.solves, 0);
      assert_true(reuse.solves <= 6 || k == 0);
      bw_sheet *fresh = sheet_on(context, moved, material, 1, false, 3, conditions);
      check_ok(context, bw_sheet_large_deflection(context, fresh, NULL, NULL, NULL));
      double max = 0, off = 0;
      for (size_t i = 0; i < size; i++) {
        max = fmax(max, fabs(fresh->displacement[i]));
        off = fmax(off, fabs(fresh->displacement[i] - sheet->displacement[i]));
      }
      assert_true(max > 0.1 && off <= 1e-7 * max);
      bw_release(fresh);
      bw_release(moved);
    }
    bw_release(sheet);
    bw_release(mesh);
  }
  bw_release(material);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  bw_material *material = isotropic(context, 100, 0, 1);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 1, 2, 2);
  bw_plane_mesh *frame[3];
  for (int k = 0; k < 3; k++)
    frame[k] = stirred(context, mesh, 0.01 * (k + 1));
  bw_condition conditions[3] = {{.tag = LEFT, .component = 0},
                                {.tag = LEFT, .component = 1},
                                {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = 1}};
  bw_status status = BW_MEMORY;
  for (int n = 1; status != BW_OK; n++) {
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 3, conditions);
    bw_fail_allocation(n, true);
    status = bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL);
    for (int k = 0; k < 3 && status == BW_OK; k++) {
      status = bw_sheet_follow(context, sheet, frame[k], NULL);
      if (status == BW_OK)
        status = bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL);
    }
    bw_fail_allocation(0, false);
    assert_true(status == BW_OK || status == BW_MEMORY);
    assert_true(n < 1000);
    bw_release(sheet);
  }
  for (int k = 0; k < 3; k++)
    bw_release(frame[k]);
  bw_release(mesh);
  bw_release(material);
}

static void large_deflection(bw_context *context, bw_sheet *sheet) {
  check_ok(context, bw_sheet_large_deflection(context, sheet, NULL, NULL, NULL));
}

static void test_threads(void **state) {
  same_on_any_threads(check_context(state), 1e6, 1e3, 0, large_deflection);
}

check_main(check_test(test_derivatives), check_test(test_elastica), check_test(test_cook),
           check_test(test_stretch), check_test(test_rotation), check_test(test_crushed),
           check_test(test_memory), check_test(test_threads), check_test(test_small_load),
           check_test(test_frames))
