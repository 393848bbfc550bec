/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Plates that ring: published frequencies, no locking, convergence, three dimensions, gradients by
 * differences, and the same answer from a lagged factor as from scratch. */
#include "../check.h"
#include "body_system.h"

static const double PI = 3.14159265358979323846;

static const bw_isotropic aluminium = {"aluminium", 70e9, 0.3, 2700, 0, 0, 0};

static bw_material *make_material(bw_context *context, const bw_isotropic *constants) {
  bw_material *material;
  check_ok(context, bw_material_isotropic(context, constants, &material));
  return material;
}

static bw_plane_mesh *rectangle(bw_context *context, double a, double b, int nx, int ny) {
  bw_plane_mesh *mesh;
  check_ok(context, bw_plane_rectangle(context, 2, (double[2]){0, 0}, (double[2]){a, b}, nx, ny,
                                       BW_DIAGONAL_UNION_JACK, &mesh));
  return mesh;
}

/* Elastic frequencies of a free plate, Hz. */
static void frequencies(bw_context *context, const bw_plane_mesh *mesh, const bw_material *material,
                        double thickness, int modes, double *frequency) {
  bw_plate *plate;
  bw_plane_reuse reuse = {0};
  bw_plate_options options;
  bw_plate_options_default(&options);
  options.modes = modes;
  check_ok(context, bw_plate_create(context, mesh, material, thickness, &plate));
  check_ok(context, bw_plate_solve(context, plate, &options, &reuse));
  memcpy(frequency, plate->frequency, (size_t)modes * sizeof *frequency);
  bw_release(plate);
}

/* omega a^2 sqrt(rho h / D) */
static double parameter_of(double frequency, const bw_isotropic *m, double a, double h) {
  double d = m->young * h * h * h / (12 * (1 - m->poisson * m->poisson));
  return 2 * PI * frequency * a * a * sqrt(m->density * h / d);
}

/* Free square plate, nu = 0.3, thin, so that shear plays no part, down to where a plain element
 * would lock by orders of magnitude. Leissa 1973 gives upper bounds by Ritz's method; the limits,
 * which later and finer calculations agree on, lie up to 1 % below. */
static void test_free_square(void **state) {
  bw_context *context = check_context(state);
  static const double leissa[6] = {13.489, 19.789, 24.432, 35.024, 35.024, 61.526};
  static const double limit[6] = {13.468, 19.596, 24.270, 34.801, 34.801, 61.093};
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 8, 8);
  for (int k = 0; k < 2; k++) {
    double h = k ? 1e-4 : 1e-3, frequency[6];
    frequencies(context, mesh, material, h, 6, frequency);
    for (int i = 0; i < 6; i++) {
      double found = parameter_of(frequency[i], &aluminium, 1, h);
      check_near(found, leissa[i], 0.01 * leissa[i]);
      check_near(found, limit[i], (i < 5 ? 0.0005 : 0.002) * limit[i]);
    }
  }
  bw_release(mesh);
  bw_release(material);
}

/* Frequencies of quadratic elements converge with the fourth power of the size. */
static void test_convergence(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  double second[4]; /* the first of a square is a twist, with a boundary layer as wide as h */
  for (int k = 0; k < 4; k++) {
    bw_plane_mesh *mesh = rectangle(context, 1, 1, 3 << k, 3 << k);
    double two[2];
    frequencies(context, mesh, material, 3e-4, 2, two);
    second[k] = two[1];
    bw_release(mesh);
  }
  double order = log2((second[0] - second[1]) / (second[1] - second[2]));
  if (!(order > 3.5))
    fail_msg("order %g (%.8g %.8g %.8g %.8g Hz)", order, second[0], second[1], second[2],
             second[3]);
  bw_release(material);
}

/* A slender bar against the Euler-Bernoulli beam: beta L = 4.73004. */
static void test_bar(void **state) {
  bw_context *context = check_context(state);
  bw_isotropic beam = aluminium;
  beam.poisson = 0;
  bw_material *material = make_material(context, &beam);
  bw_plane_mesh *mesh = rectangle(context, 1, 0.01, 24, 1);
  double h = 0.005, frequency, beta = 4.730040744862704;
  frequencies(context, mesh, material, h, 1, &frequency);
  double exact = beta * beta / (2 * PI) * sqrt(beam.young * h * h / 12 / beam.density);
  check_near(frequency, exact, 5e-4 * exact);
  bw_release(mesh);
  bw_release(material);
}

/* A metallophone bar and a thick block against quadratic tetrahedra in space: bending and twisting
 * modes are found among the solid's within 1 %. */
static void test_solid(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  static const double size[2][3] = {{0.14, 0.03, 0.004}, {0.05, 0.04, 0.008}};
  for (int k = 0; k < 2; k++) {
    const double *s = size[k];
    bw_plane_mesh *mesh = rectangle(context, s[0], s[1], 14, 4);
    double plate[4];
    frequencies(context, mesh, material, s[2], 4, plate);
    bw_mesh *solid;
    int cells[3] = {k ? 12 : 28, k ? 10 : 6, k ? 3 : 2};
    check_ok(context, bw_mesh_box_grid(context, (double[3]){0}, s, cells, 2, &solid));
    bw_model *model;
    bw_dof_map *dof_map;
    bw_system *system;
    bw_modes *modes;
    check_ok(context, bw_model_create(context, solid, material, &model));
    check_ok(context, bw_dof_map_create(context, model, &dof_map));
    check_ok(context, body_system(context, solid, material, dof_map, NULL, &system));
    bw_modes_options options;
    bw_modes_options_default(&options);
    options.count = 8;
    check_ok(context, bw_modes_elastic(context, system, &options, &modes));
    for (int i = 0; i < 4; i++) {
      double nearest = INFINITY;
      for (int j = 0; j < modes->count; j++)
        nearest = fmin(nearest, fabs(modes->frequency[j] / plate[i] - 1));
      if (!(nearest < 0.01))
        fail_msg("plate %g: mode %d at %g Hz is %g from the solid's nearest", s[2], i + 1, plate[i],
                 nearest);
    }
    check_near(plate[0] / modes->frequency[0], 1, 0.005);
    bw_release(modes);
    bw_release(system);
    bw_release(dof_map);
    bw_release(model);
    bw_release(solid);
    bw_release(mesh);
  }
  bw_release(material);
}

/* The same nodes elsewhere: inner nodes moved at random, mid-edge nodes off the midpoints. */
static bw_plane_mesh *perturbed(bw_context *context, const bw_plane_mesh *mesh, double by,
                                uint64_t seed) {
  const bw_plane_nodes *nodes = mesh->topology->nodes;
  double *point = malloc((size_t)nodes->node_count * 2 * sizeof *point);
  bw_random random;
  bw_random_seed(&random, seed);
  for (int64_t i = 0; i < nodes->node_count; i++)
    for (int c = 0; c < 2; c++)
      point[2 * i + c] = mesh->point[2 * i + c] +
                         (nodes->segment[i] < 0 ? by * (bw_random_uniform(&random) - 0.5) : 0);
  bw_plane_mesh *moved;
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &moved));
  free(point);
  return moved;
}

static void test_curved_inside(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 1, 0.6, 10, 6);
  bw_plane_mesh *moved = perturbed(context, mesh, 0.02, 7);
  double straight[3], curved[3];
  frequencies(context, mesh, material, 0.01, 3, straight);
  frequencies(context, moved, material, 0.01, 3, curved);
  for (int i = 0; i < 3; i++)
    check_near(curved[i] / straight[i], 1, 2e-3);
  bw_release(moved);
  bw_release(mesh);
  bw_release(material);
}

/* A bar whose waist and length change, a little further each time. */
static bw_plane_mesh *dragged(bw_context *context, const bw_plane_mesh *mesh, double by) {
  const bw_outline *outline = mesh->outline;
  int64_t nodes = mesh->topology->nodes->node_count;
  double *point = malloc((size_t)nodes * 2 * sizeof *point), corner[8];
  for (int i = 0; i < 4; i++) {
    corner[2 * i] = outline->point[2 * i] * (1 + by);
    corner[2 * i + 1] = outline->point[2 * i + 1] * (1 - by);
  }
  for (int64_t i = 0; i < nodes; i++) {
    double x = mesh->point[2 * i], y = mesh->point[2 * i + 1];
    double inside = x * (0.14 - x) * y * (0.03 - y) / (0.07 * 0.07 * 0.015 * 0.015);
    point[2 * i] = x * (1 + by) + 0.01 * by * inside;
    point[2 * i + 1] = y * (1 - by) + 0.02 * by * inside;
  }
  bw_outline *changed;
  bw_plane_mesh *moved;
  check_ok(context, bw_outline_moved(context, outline, corner, &changed));
  check_ok(context, bw_plane_mesh_moved(context, mesh, changed, point, &moved));
  bw_release(changed);
  free(point);
  return moved;
}

static void test_lagged_equals_full(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 0.14, 0.03, 14, 4);
  bw_plate *plate;
  bw_plate_options options;
  bw_plate_options_default(&options);
  options.modes = 2;
  check_ok(context, bw_plate_create(context, mesh, material, 0.004, &plate));
  check_ok(context, bw_plate_solve(context, plate, &options, NULL));
  static const int modes[] = {2, 2, 2, 2, 2, 3, 1, 1, 1};
  for (int k = 0; k < 9; k++) {
    bw_plane_mesh *moved = dragged(context, mesh, 0.004 * (k + 1));
    bw_plane_reuse reuse = {0};
    double scratch[3];
    options.modes = modes[k];
    check_ok(context, bw_plate_follow(context, plate, moved, &reuse));
    check_ok(context, bw_plate_solve(context, plate, &options, &reuse));
    assert_int_equal(reuse.factorisations, 0);
    assert_true(reuse.iterations < 20);
    if (k == 4 || k == 8) /* the last frames' modes leave little to do */
      assert_true(reuse.iterations <= 3);
    assert_true(reuse.pattern && reuse.factor && reuse.solution);
    frequencies(context, moved, material, 0.004, modes[k], scratch);
    for (int i = 0; i < modes[k]; i++)
      check_near(plate->frequency[i] / scratch[i], 1, 1e-9);
    bw_release(moved);
  }
  bw_release(plate);
  bw_release(mesh);
  bw_release(material);
}

/* Directional derivative against central differences of whole solutions. */
static void test_gradient(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 0.14, 0.03, 6, 2);
  int64_t nodes = mesh->topology->nodes->node_count;
  double *gradient = malloc((size_t)nodes * 2 * sizeof *gradient);
  bw_plate *plate;
  bw_plate_options options;
  bw_plate_options_default(&options);
  options.modes = 2;
  options.tolerance = 1e-8;
  check_ok(context, bw_plate_create(context, mesh, material, 0.004, &plate));
  check_ok(context, bw_plate_solve(context, plate, &options, NULL));
  for (int mode = 0; mode < 2; mode++) {
    check_ok(context, bw_plate_gradient(context, plate, mode, gradient));
    bw_plane_mesh *far = perturbed(context, mesh, 2e-5, 3);
    bw_plane_mesh *back;
    double *opposite = malloc((size_t)nodes * 2 * sizeof *opposite), predicted = 0;
    for (int64_t i = 0; i < 2 * nodes; i++) {
      opposite[i] = 2 * mesh->point[i] - far->point[i];
      predicted += gradient[i] * 2 * (far->point[i] - mesh->point[i]);
    }
    check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, opposite, &back));
    double value[2];
    const bw_plane_mesh *both[2] = {far, back};
    for (int k = 0; k < 2; k++) {
      check_ok(context, bw_plate_follow(context, plate, both[k], NULL));
      check_ok(context, bw_plate_solve(context, plate, &options, NULL));
      value[k] = plate->frequency[mode];
    }
    check_near((value[0] - value[1]) / predicted, 1, 1e-4);
    check_ok(context, bw_plate_follow(context, plate, mesh, NULL));
    check_ok(context, bw_plate_solve(context, plate, &options, NULL));
    free(opposite);
    bw_release(far);
    bw_release(back);
  }
  /* scaling the shape in the plane by 1 + e scales bending frequencies of a thin plate by 1 - 2 e:
     here the bar is not quite thin */
  check_ok(context, bw_plate_gradient(context, plate, 0, gradient));
  double scaling = 0;
  for (int64_t i = 0; i < 2 * nodes; i++)
    scaling += gradient[i] * mesh->point[i];
  check_near(scaling / plate->frequency[0], -2, 0.05);
  free(gradient);
  bw_release(plate);
  bw_release(mesh);
  bw_release(material);
}

/* The lowest mode of a free bar crosses zero at 0.2242 of its length from each end. */
static void test_nodal_lines(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 0.2, 0.02, 20, 2);
  bw_plate *plate;
  int32_t count;
  double *lines;
  check_ok(context, bw_plate_create(context, mesh, material, 0.002, &plate));
  check_ok(context, bw_plate_solve(context, plate, NULL, NULL));
  check_ok(context, bw_plate_nodal_lines(context, plate, 0, &count, &lines));
  assert_true(count >= 8);
  for (int32_t i = 0; i < 2 * count; i++) {
    double from_end = fmin(lines[2 * i], 0.2 - lines[2 * i]);
    check_near(from_end / 0.2, 0.2242, 0.01);
  }
  check_fails(context, BW_INVALID, "mode 2",
              bw_plate_nodal_lines(context, plate, 1, &count, &lines));
  bw_free(lines);
  bw_release(plate);
  bw_release(mesh);
  bw_release(material);
}

/* In the plane a slender bar is a beam of another height. */
static void test_inplane(void **state) {
  bw_context *context = check_context(state);
  bw_isotropic beam = aluminium;
  beam.poisson = 0;
  bw_material *material = make_material(context, &beam);
  bw_plane_mesh *mesh = rectangle(context, 1, 0.02, 40, 2);
  bw_plate *plate;
  double frequency[2], beta[2] = {4.730040744862704, 7.853204624095838};
  check_ok(context, bw_plate_create(context, mesh, material, 0.05, &plate));
  check_ok(context, bw_plate_inplane(context, plate, 2, frequency));
  for (int i = 0; i < 2; i++) {
    double exact =
        beta[i] * beta[i] / (2 * PI) * sqrt(beam.young * 0.02 * 0.02 / 12 / beam.density);
    check_near(frequency[i] / exact, 1, 0.005);
  }
  check_fails(context, BW_INVALID, "0 modes", bw_plate_inplane(context, plate, 0, frequency));
  const bw_plate_options many = {.modes = INT32_MAX, .tolerance = 1e-6};
  check_fails(context, BW_INVALID, "2147483647 modes", bw_plate_solve(context, plate, &many, NULL));
  /* 3 rigid-body modes and 2 more vectors of the iteration, one less than all unknowns */
  char largest[32];
  int last = 2 * mesh->topology->nodes->node_count - 6;
  snprintf(largest, sizeof largest, "from 1 to %d expected", last);
  check_fails(context, BW_INVALID, largest, bw_plate_inplane(context, plate, last + 1, frequency));
  bw_release(plate);
  bw_release(mesh);
  bw_release(material);
}

static void test_wrong_input(void **state) {
  bw_context *context = check_context(state);
  bw_isotropic weightless = aluminium;
  weightless.density = 0;
  bw_material *material = make_material(context, &weightless);
  bw_material *heavy = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 2, 2), *linear;
  bw_plate *plate;
  check_fails(context, BW_INVALID, "density",
              bw_plate_create(context, mesh, material, 0.01, &plate));
  check_fails(context, BW_INVALID, "thickness", bw_plate_create(context, mesh, heavy, 0, &plate));
  check_ok(context, bw_plane_rectangle(context, 1, (double[2]){0, 0}, (double[2]){1, 1}, 2, 2,
                                       BW_DIAGONAL_RIGHT, &linear));
  check_fails(context, BW_INVALID, "order 2",
              bw_plate_create(context, linear, heavy, 0.01, &plate));
  bw_release(linear);
  bw_release(mesh);
  bw_release(material);
  bw_release(heavy);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = make_material(context, &aluminium);
  bw_plane_mesh *mesh = rectangle(context, 1, 0.6, 3, 2);
  bw_plane_mesh *moved = perturbed(context, mesh, 0.01, 1);
  double before;
  frequencies(context, mesh, material, 0.01, 1, &before); /* makes the context's threads */
  check_each_allocation(context, status, 1) {
    bw_plate *plate = NULL;
    status = bw_plate_create(context, mesh, material, 0.01, &plate);
    if (status == BW_OK)
      status = bw_plate_solve(context, plate, NULL, NULL);
    if (status == BW_OK)
      status = bw_plate_follow(context, plate, moved, NULL);
    if (status == BW_OK)
      status = bw_plate_solve(context, plate, NULL, NULL);
    double gain, sample[1000];
    bw_tone tone;
    bw_tone_default(&tone);
    tone.rate = 1000;
    tone.seconds = 1;
    if (status == BW_OK)
      status = bw_plate_tone(context, plate, &tone, sample);
    if (status == BW_OK)
      status = bw_plate_gains(context, plate, &tone, &gain);
    if (status == BW_OK)
      check_near(fabs(gain), 1, 0);
    bw_release(plate);
  }
  bw_release(moved);
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(test_free_square), check_test(test_convergence), check_test(test_bar),
           check_test(test_solid), check_test(test_curved_inside),
           check_test(test_lagged_equals_full), check_test(test_gradient),
           check_test(test_nodal_lines), check_test(test_inplane), check_test(test_wrong_input),
           check_test(test_memory))
