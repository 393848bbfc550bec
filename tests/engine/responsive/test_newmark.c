/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Transient sheets: order 2 in time against an exact motion, energy kept without damping, resonance
 * at the eigenfrequency of a cantilever and nowhere else, Rayleigh's damping of a free vibration.
 */
#include "responsive/sheet.h"
#include "sheets.h"

static double ground_motion(void *data, const double at[2], double time) {
  const double *of = data; /* amplitude, angular frequency */
  (void)at;
  return of[0] * sin(of[1] * time);
}

static double pulled(void *data, const double at[2], double time) {
  (void)at;
  (void)time;
  return *(const double *)data;
}

static double energy_of(bw_context *context, bw_sheet *sheet) {
  const struct bwi_sheet *inner = sheet->inner;
  int32_t nodes = inner->pattern->node_count;
  double *y = BW_NEW(context, double, 2 * nodes), sum = 0;
  check_ok(context,
           bw_plane_multiply(context, inner->pattern, 2, inner->stiffness, sheet->displacement, y));
  for (int32_t i = 0; i < 2 * nodes; i++)
    sum += 0.5 * y[i] * sheet->displacement[i];
  for (int32_t i = 0; i < nodes; i++)
    for (int64_t p = inner->pattern->start[i]; p < inner->pattern->start[i + 1]; p++)
      for (int c = 0; c < 2; c++)
        sum += 0.5 * inner->mass[p] * sheet->velocity[2 * i + c] *
               sheet->velocity[2 * inner->pattern->column[p] + c];
  bw_free(y);
  return sum;
}

/* A strip of nu = 0 constrained sidewise on a ground that shakes along it: the exact motion is one
 * of the wave equation, u = sum over modes; with all nodes of a single element across it is a
 * chain. Here the exact thing is taken from the same mesh with very small steps. */
static double tip_after(bw_context *context, int steps, double ak) {
  bw_material *material = isotropic(context, 1e4, 0, 1);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 0.25, 8, 2);
  double motion[2] = {0.01, 40};
  bw_condition conditions[2] = {
      {.tag = LEFT, .component = 0, .function = ground_motion, .data = motion},
      {.tag = LEFT, .component = 1}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 2, conditions);
  bw_newmark newmark;
  bw_newmark_default(&newmark);
  newmark.step = 0.2 / steps;
  newmark.damping_stiffness = ak;
  newmark.damping_mass = 0.3;
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  options.tolerance = 1e-12;
  bw_plane_reuse reuse = {0};
  for (int k = 0; k < steps; k++)
    check_ok(context, bw_sheet_transient(context, sheet, &newmark, &options, &reuse));
  check_near(sheet->time, 0.2, 1e-12);
  assert_int_equal(reuse.factorisations, 1);
  double tip = sheet->displacement[2 * node_at(mesh, 1, 0.125)];
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
  return tip;
}

static void test_order(void **state) {
  bw_context *context = check_context(state);
  double reference = tip_after(context, 6400, 1e-3);
  double coarse = fabs(tip_after(context, 100, 1e-3) - reference);
  double fine = fabs(tip_after(context, 200, 1e-3) - reference);
  check_near(log2(coarse / fine), 2, 0.15);
  assert_true(fine < 1e-2 * fabs(reference));
}

static void test_energy(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e5, 0.3, 10);
  bw_plane_mesh *mesh = jittered(context, rectangle(context, 2, 1, 0.5, 4, 2), 0.03);
  double pull = 10;
  bw_condition conditions[3] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1},
      {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .function = pulled, .data = &pull}};
  bw_sheet *free = sheet_on(context, mesh, material, 0.1, true, 3, conditions);
  check_ok(context, bw_sheet_static(context, free, NULL, NULL));
  const double deflection = free->displacement[2 * node_at(mesh, 1, 0) + 1];
  pull = 0; /* let go */
  bw_newmark newmark;
  bw_newmark_default(&newmark);
  newmark.step = 2e-3;
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  options.tolerance = 1e-12;
  check_ok(context, bw_sheet_transient(context, free, &newmark, &options, NULL));
  double first = energy_of(context, free), min = first, max = first;
  bool moved = false;
  for (int k = 0; k < 400; k++) {
    check_ok(context, bw_sheet_transient(context, free, &newmark, &options, NULL));
    double now = energy_of(context, free);
    min = fmin(min, now);
    max = fmax(max, now);
    moved = moved || free->displacement[2 * node_at(mesh, 1, 0) + 1] < -0.5 * deflection;
  }
  assert_true(moved);
  assert_true(first > 0 && (max - min) < 1e-8 * first);
  /* damped, the energy falls all the time, at the rate of the first mode at last */
  newmark.damping_mass = 2;
  double last = energy_of(context, free);
  for (int k = 0; k < 100; k++) {
    check_ok(context, bw_sheet_transient(context, free, &newmark, &options, NULL));
    double now = energy_of(context, free);
    assert_true(now < last * (1 + 1e-9));
    last = now;
  }
  /* am = 2: amplitudes fall as exp(-t), energy as exp(-2 t) up to its swing in a period */
  check_near(log(last / first) / (-2 * 0.2), 1, 0.1);
  bw_release(free);
  bw_release(mesh);
  bw_release(material);
}

/* Largest deflection of a cantilever's tip against the ground, shaken at a multiple of its lowest
 * eigenfrequency (Euler's beam). */
static double transient(bw_context *context, double ratio, double *deflection) {
  double length = 1, height = 0.05, young = 1e6, density = 100;
  double omega = 1.875104 * 1.875104 * sqrt(young * height * height / (12 * density));
  double motion[2] = {1e-3, ratio * omega};
  bw_material *material = isotropic(context, young, 0, density);
  bw_plane_mesh *mesh = rectangle(context, 2, length, height, 12, 1);
  bw_condition conditions[2] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1, .function = ground_motion, .data = motion}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 2, conditions);
  bw_newmark newmark;
  bw_newmark_default(&newmark);
  double period = 2 * 3.14159265358979 / omega;
  newmark.step = period / 60;
  int32_t tip = node_at(mesh, length, 0);
  *deflection = 0;
  for (int k = 0; k < 60 * 12; k++) {
    check_ok(context, bw_sheet_transient(context, sheet, &newmark, NULL, NULL));
    double y = sheet->displacement[2 * tip + 1] - ground_motion(motion, mesh->point, sheet->time);
    *deflection = fmax(*deflection, fabs(y));
  }
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
  return omega;
}

static void test_resonance(void **state) {
  bw_context *context = check_context(state);
  double at[3];
  transient(context, 0.6, &at[0]);
  transient(context, 1, &at[1]);
  transient(context, 1.5, &at[2]);
  assert_true(at[1] > 6 * at[0]);
  assert_true(at[1] > 6 * at[2]);
  /* Undamped at resonance the first mode's amplitude grows by pi times its participation (1.566 at
     the tip) of the ground's amplitude every period. */
  check_near(at[1] / (12 * 3.14159 * 1.566 * 1e-3), 1, 0.15);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1, 0, 0), *heavy = isotropic(context, 1, 0, 1);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 1, 2, 2);
  bw_condition support = {.tag = LEFT, .component = 0};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 1, &support);
  bw_newmark newmark;
  bw_newmark_default(&newmark);
  check_fails(context, BW_INVALID, "density", bw_sheet_transient(context, sheet, NULL, NULL, NULL));
  bw_release(sheet);
  sheet = sheet_on(context, mesh, heavy, 1, false, 1, &support);
  newmark.step = 0;
  check_fails(context, BW_INVALID, "time step",
              bw_sheet_transient(context, sheet, &newmark, NULL, NULL));
  newmark.step = 1;
  newmark.gamma = 0.4;
  check_fails(context, BW_INVALID, "gamma",
              bw_sheet_transient(context, sheet, &newmark, NULL, NULL));
  check_ok(context,
           bw_sheet_transient(context, sheet, NULL, NULL, NULL)); /* free pieces may move */
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
  bw_release(heavy);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  bw_material *material = isotropic(context, 1, 0, 1);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 1, 3, 3);
  bw_condition support = {.tag = LEFT, .component = 0};
  bw_status status = BW_MEMORY;
  for (int n = 1; status != BW_OK; n++) {
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 1, &support);
    bw_fail_allocation(n, true);
    status = bw_sheet_transient(context, sheet, NULL, NULL, NULL);
    bw_fail_allocation(0, false);
    assert_true(status == BW_OK || status == BW_MEMORY);
    assert_true(n < 1000);
    /* and it goes on where it was */
    check_ok(context, bw_sheet_transient(context, sheet, NULL, NULL, NULL));
    bw_release(sheet);
  }
  bw_release(mesh);
  bw_release(material);
}

static void three_steps(bw_context *context, bw_sheet *sheet) {
  for (int k = 0; k < 3; k++)
    check_ok(context, bw_sheet_transient(context, sheet, NULL, NULL, NULL));
}

static void test_threads(void **state) {
  same_on_any_threads(check_context(state), 1e6, 1e3, 0, three_steps);
}

check_main(check_test(test_order), check_test(test_energy), check_test(test_resonance),
           check_test(test_refused), check_test(test_memory), check_test(test_threads))
