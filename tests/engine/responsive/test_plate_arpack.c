/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The modes of plates against ARPACK: the plate's own stiffness and mass, Lanczos in inverse mode
 * on a factor by UMFPACK. Nothing of the engine's iteration, factor, start or projection takes
 * part. */
#include "check.h"

#include <arpack/arpack.h>
#include <suitesparse/umfpack.h>

#include "responsive/plate.h"

enum { RIGID = 3, MODES = 4, BASIS = 28 };

static const double TWO_PI = 6.28318530717958647692;

/* A round outline whose radius is a random trigonometric polynomial, on cubics with smooth joints,
 * so that elements have curved sides; some have a hole. */
static bw_outline *random_outline(bw_context *context, uint64_t seed) {
  enum { CURVES = 8 };
  bw_random random;
  bw_random_seed(&random, seed);
  double wave[3][2], point[2 * 3 * CURVES][2];
  bw_segment segment[2 * CURVES];
  bw_loop loop[2] = {{.count = CURVES, .parent = -1},
                     {.first = CURVES, .count = CURVES, .region = -1, .parent = 0}};
  int loops = seed % 3 == 0 ? 2 : 1;
  double length = 0.05 * (1 + 2 * bw_random_uniform(&random));
  double width = 0.02 * (1 + bw_random_uniform(&random));
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 2; c++)
      wave[k][c] = 0.12 * (2 * bw_random_uniform(&random) - 1) / (k + 1);
  for (int l = 0; l < loops; l++)
    for (int i = 0; i < CURVES; i++) {
      double place[2][2], slope[2][2], step = TWO_PI / CURVES;
      for (int end = 0; end < 2; end++) {
        double t = step * (i + end), r = 1, dr = 0;
        for (int k = 0; k < 3 && l == 0; k++) {
          r += wave[k][0] * cos((k + 2) * t) + wave[k][1] * sin((k + 2) * t);
          dr += (k + 2) * (wave[k][1] * cos((k + 2) * t) - wave[k][0] * sin((k + 2) * t));
        }
        double size[2] = {l ? 0.3 * width : length, l ? 0.3 * width : width};
        place[end][0] = size[0] * r * cos(t);
        place[end][1] = size[1] * r * sin(t);
        slope[end][0] = size[0] * (dr * cos(t) - r * sin(t));
        slope[end][1] = size[1] * (dr * sin(t) + r * cos(t));
      }
      int first = 3 * (CURVES * l + i), next = 3 * (CURVES * l + (i + 1) % CURVES);
      for (int c = 0; c < 2; c++) {
        point[first][c] = place[0][c];
        point[first + 1][c] = place[0][c] + step / 3 * slope[0][c];
        point[first + 2][c] = place[1][c] - step / 3 * slope[1][c];
      }
      segment[CURVES * l + i] = (bw_segment){{first, first + 1, first + 2, next}, 0};
    }
  static const bw_name tag = {"rim"};
  bw_outline *outline;
  check_ok(context, bw_outline_create(context, 3 * CURVES * loops, &point[0][0], CURVES * loops,
                                      segment, loops, loop, 1, &tag, &outline));
  return outline;
}

/* The lowest MODES elastic frequencies and RIGID zeros below them, of a matrix pair whose zeros a
 * shift by `shift` takes away: x -> (K + shift M)^-1 M x. */
static void by_arpack(bw_context *context, const bw_plate *plate, double *frequency) {
  const struct bwi_plate *in = plate->inner;
  const bw_plane_pattern *g = in->now->matrices->pattern;
  int n = 3 * g->node_count;
  int *start = malloc(((size_t)n + 1) * sizeof *start);
  int *row = malloc(9 * (size_t)g->block_count * sizeof *row);
  double *value = malloc(9 * (size_t)g->block_count * sizeof *value);
  /* columns of a symmetric matrix: its rows */
  int at = 0;
  double shift = 0;
  for (int i = 0; i < g->node_count; i++)
    for (int c = 0; c < 3; c++) {
      start[3 * i + c] = at;
      for (int64_t p = g->start[i]; p < g->start[i + 1]; p++)
        for (int d = 0; d < 3; d++) {
          row[at] = 3 * g->column[p] + d;
          value[at++] = in->now->matrices->stiffness[9 * p + 3 * c + d];
        }
    }
  start[n] = at;
  /* near the lowest elastic eigenvalue as the engine has it: that alone is taken from there */
  shift = pow(TWO_PI * plate->frequency[0], 2);
  at = 0;
  for (int i = 0; i < g->node_count; i++)
    for (int c = 0; c < 3; c++)
      for (int64_t p = g->start[i]; p < g->start[i + 1]; p++)
        for (int d = 0; d < 3; d++, at++)
          if (c == d)
            value[at] +=
                shift * (c == 0 ? in->law.mass : in->law.inertia) * in->now->matrices->mass[p];
  void *symbolic, *numeric;
  assert_int_equal(umfpack_di_symbolic(n, n, start, row, value, &symbolic, NULL, NULL), 0);
  assert_int_equal(umfpack_di_numeric(start, row, value, symbolic, &numeric, NULL, NULL), 0);
  enum { COUNT = RIGID + MODES };
  int ido = 0, info = 0, lwork = BASIS * (BASIS + 8), param[11] = {1, 0, 300, 1, 0, 0, 3};
  int pointer[14], chosen[BASIS];
  double *residual = calloc((size_t)n, sizeof(double)), found[COUNT];
  double *basis = calloc((size_t)n * BASIS, sizeof(double));
  double *work = calloc(3 * (size_t)n, sizeof(double)), space[BASIS * (BASIS + 8)];
  double *force = calloc((size_t)n, sizeof(double));
  for (;;) {
    dsaupd_c(&ido, "G", n, "LM", COUNT, 1e-12, residual, BASIS, basis, n, param, pointer, work,
             space, lwork, &info);
    double *x = work + pointer[0] - 1, *y = work + pointer[1] - 1;
    if (ido == -1 || ido == 1) {
      const double *mx = work + pointer[2] - 1;
      if (ido == -1) {
        check_ok(context, bwi_plate_multiply_mass(context, plate, x, force));
        mx = force;
      }
      assert_int_equal(umfpack_di_solve(UMFPACK_A, start, row, value, y, mx, numeric, NULL, NULL),
                       0);
    } else if (ido == 2)
      check_ok(context, bwi_plate_multiply_mass(context, plate, x, y));
    else
      break;
  }
  assert_int_equal(info, 0);
  dseupd_c(0, "A", chosen, found, basis, n, -shift, "G", n, "LM", COUNT, 1e-12, residual, BASIS,
           basis, n, param, pointer, work, space, lwork, &info);
  assert_int_equal(info, 0);
  for (int i = 0; i < COUNT; i++)
    if (i < RIGID)
      check_near(found[i], 0, 1e-6 * shift);
    else
      frequency[i - RIGID] = sqrt(found[i]) / TWO_PI;
  umfpack_di_free_symbolic(&symbolic);
  umfpack_di_free_numeric(&numeric);
  free(start);
  free(row);
  free(value);
  free(residual);
  free(basis);
  free(work);
  free(force);
}

static void compare(bw_context *context, const bw_plate *plate, uint64_t seed) {
  double frequency[MODES];
  by_arpack(context, plate, frequency);
  for (int i = 0; i < MODES; i++)
    if (!(fabs(plate->frequency[i] / frequency[i] - 1) < 1e-8))
      fail_msg("outline %d, mode %d: %.12g Hz, ARPACK %.12g Hz, relative %.2g", (int)seed, i + 1,
               plate->frequency[i], frequency[i], plate->frequency[i] / frequency[i] - 1);
}

/* Random outlines, isotropic and orthotropic, thick and thin; then each after a pull at its rim,
 * its modes found from the former ones on the former factor. */
static void random_plates(void **state) {
  bw_context *context = check_context(state);
  const bw_isotropic aluminium = {"aluminium", 70e9, 0.3, 2700, 0, 0, 0};
  bw_orthotropic spruce = {.name = "spruce",
                           .young = {11e9, 0.8e9, 0.5e9},
                           .poisson = {0.4, 0.02, 0.4},
                           .shear = {0.7e9, 0.7e9, 0.05e9},
                           .density = 440};
  bw_material *metal, *wood;
  check_ok(context, bw_material_isotropic(context, &aluminium, &metal));
  check_ok(context, bw_material_orthotropic(context, &spruce, &wood));
  uint64_t count = getenv("BARWRIGHT_FULL") ? 100 : 12;
  for (uint64_t seed = 1; seed <= count; seed++) {
    bw_outline *outline = random_outline(context, seed);
    bw_plane_mesh *mesh;
    bw_follow_options follow;
    bw_follow_options_default(&follow);
    follow.fill.order = 2;
    follow.fill.elements = 150;
    check_ok(context, bw_plane_fill(context, outline, &follow.fill, &mesh));
    bw_mesh_motion *motion;
    check_ok(context, bw_mesh_motion_create(context, mesh, &follow, &motion));
    bw_plate *plate;
    bw_plate_options options;
    bw_plate_options_default(&options);
    options.modes = MODES;
    check_ok(context, bw_plate_create(context, mesh, seed % 2 ? metal : wood,
                                      seed % 4 < 2 ? 0.004 : 0.001, &plate));
    check_ok(context, bw_plate_solve(context, plate, &options, NULL));
    compare(context, plate, seed);
    bw_outline *pulled;
    bw_follow_report report;
    double point[2 * 2 * 24], weight[2 * 24];
    check_ok(context, bw_outline_handle(context, outline, BW_HANDLE_VERTEX, 0, weight));
    for (int32_t i = 0; i < 2 * outline->point_count; i++)
      point[i] = outline->point[i] + weight[i / 2] * (i % 2 ? 0.001 : 0.002);
    check_ok(context, bw_outline_moved(context, outline, point, &pulled));
    check_ok(context, bw_mesh_motion_follow(context, motion, pulled, &report));
    check_ok(context, bw_plate_follow(context, plate, motion->mesh, NULL));
    check_ok(context, bw_plate_solve(context, plate, &options, NULL));
    compare(context, plate, seed);
    bw_release(pulled);
    bw_release(plate);
    bw_release(motion);
    bw_release(mesh);
    bw_release(outline);
  }
  bw_release(metal);
  bw_release(wood);
}

check_main(check_test(random_plates))
