/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies that fall on a plane, against Saint-Venant's rod, Hertz's impact, and the laws of momentum
 * and energy. */
#include "bodies.h"

#include <sys/resource.h>

#include "barwright/drop.h"

#include "analysis/strain.h"
#include "base/job.h"

static bw_model *model_of(bw_context *context, bw_mesh *mesh, double poisson) {
  bw_material *material = NULL;
  bw_model *model = NULL;
  const bw_isotropic constants = {
      .name = "test", .young = 1e9, .poisson = poisson, .density = 1000, .strength = 2e7};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(mesh);
  bw_release(material);
  return model;
}

static bw_modes *lowest(bw_context *context, const bw_model *model, int count, bw_system **system) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = count;
  check_ok(context, bw_modes_of_model(context, model, NULL, &options, system, &modes));
  return modes;
}

/* A model with its lowest modes and the equations that they took. */
typedef struct body {
  bw_model *model;
  bw_system *system;
  bw_modes *modes;
} body;

static body body_of(bw_context *context, bw_mesh *mesh, double poisson, int count) {
  body b = {.model = model_of(context, mesh, poisson)};
  b.modes = lowest(context, b.model, count, &b.system);
  return b;
}

static void release_body(const body *b) {
  bw_release(b->modes);
  bw_release(b->system);
  bw_release(b->model);
}

static bw_drop_options towards(double x, double y, double z) {
  bw_drop_options options;
  bw_drop_options_default(&options);
  options.down[0] = x;
  options.down[1] = y;
  options.down[2] = z;
  return options;
}

/* A rod without lateral contraction that lands on its end touches for 2 L / c with the force
 * rho c A v, and leaves without vibration (Saint-Venant). Modes up to the 24th of the axis alone
 * are here: the force rings about its value. */
static void test_rod(void **state) {
  bw_context *context = check_context(state);
  const double length = 0.1, side = 0.01, speed = 2, c = 1000;
  const double force = 1000 * c * side * side * speed, contact = 2 * length / c;
  const body b = body_of(context, body_box(context, length, side, side, 40, 2, 2, 2), 0, 150);
  bw_drop_options options = towards(-3, 0, 0);
  bw_drop *drop = NULL;
  options.modes = b.modes;
  options.speed = speed;
  options.gravity = 0;
  options.samples = 0;
  check_ok(context, bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop));
  const bw_drop_impact *impact = drop->impact;
  check_near(drop->mass, 1000 * length * side * side, 1e-12);
  check_near(drop->energy, 0.5 * drop->mass * speed * speed, 1e-12);
  check_near(impact->duration, contact, 0.01 * contact);
  check_near(impact->impulse / impact->duration, force, 0.015 * force);
  check_near(drop->velocity[0], speed, 0.015 * speed);
  check_near(impact->impulse, drop->mass * (speed + drop->velocity[0]), 1e-9 * impact->impulse);
  assert_true(drop->error < 1e-3 && drop->stress == NULL && drop->peak_element == -1);
  bw_release(drop);
  release_body(&b);
}

/* A block whose lower face is part of a sphere of radius 0.01, with small elements about its lowest
 * point. */
static void dome_map(void *data, const double unit[3], double out[3]) {
  const double radius = 0.01;
  (void)data;
  for (int k = 0; k < 2; k++)
    out[k] = 0.6 * radius * sinh(6 * (2 * unit[k] - 1)) / sinh(6);
  double low = radius - sqrt(radius * radius - out[0] * out[0] - out[1] * out[1]);
  out[2] = low + (1.2 * radius - low) * expm1(6 * unit[2]) / expm1(6);
}

/* Hertz's impact lasts 2.943 d / v, d the deepest approach. The contact is 0.02 of the radius wide:
 * the theory is that of a small one. */
static void test_hertz(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {12, 12, 10};
  const double speed = 0.04, stiffness = 4. / 3 * 1e9 / (1 - 0.3 * 0.3) * sqrt(0.01);
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, dome_map, NULL, &mesh));
  const body b = body_of(context, mesh, 0.3, 20);
  bw_drop_options options = towards(0, 0, -1);
  bw_drop *drop = NULL;
  options.modes = b.modes;
  options.speed = speed;
  options.gravity = 0;
  options.samples = 0;
  check_ok(context, bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop));
  double deep = pow(1.25 * drop->mass * speed * speed / stiffness, 0.4);
  double time = 2.94327 * deep / speed, force = stiffness * pow(deep, 1.5);
  check_near(drop->impact[0].duration, time, 0.02 * time);
  check_near(drop->impact[0].force, force, 0.02 * force);
  check_near(drop->velocity[2], speed, 1e-3 * speed);
  assert_true(drop->error < 1e-3);
  bw_release(drop);
  release_body(&b);
}

/* The deformation of the largest stress has the strain energy of its row. */
static void check_deformation(bw_context *context, const bw_model *model, const bw_drop *drop) {
  int row = 0;
  bw_system *system = NULL;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *product = numbers(size), energy = 0;
  while (row < drop->row_count - 1 && drop->time[row] < drop->peak_time)
    row++;
  check_ok(context, bw_system_of_model(context, model, NULL, NULL, &system));
  check_ok(context, bw_system_stiffness(context, system));
  check_ok(context, bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, 1,
                                      drop->displacement, product));
  for (int64_t i = 0; i < size; i++)
    energy += 0.5 * product[i] * drop->displacement[i];
  assert_true(drop->time[row] == drop->peak_time);
  check_near(energy, drop->strain[row], 1e-6 * energy);
  free(product);
  bw_release(system);
}

/* A box that falls on a corner: the impulse J along the plane's normal n changes the velocity by J
 * n / m and the spin by I^-1 (r x n) J. A rigid body that loses no energy has J = 2 m_e v; what
 * goes into vibration is missing. */
/* The history of the peak's element has the peak when that is, and never more than any element. */
static void check_history(const bw_drop *drop) {
  bool peaked = false;
  for (int i = 0; i < drop->sample_count; i++) {
    assert_true(drop->peak_stress[i] <= drop->sample_stress[i] + 1e-9 * drop->peak);
    if (drop->sample[i] == drop->peak_time) {
      check_near(drop->peak_stress[i], drop->peak, 1e-9 * drop->peak);
      check_near(drop->sample_stress[i], drop->peak, 0);
      peaked = true;
    }
  }
  assert_true(peaked);
}

/* At a time before the peak, against the deformation of a drop that ends then. */
static void check_earlier(bw_context *context, const bw_model *model, bw_drop_options options,
                          const bw_drop *drop) {
  bw_drop *shorter = NULL;
  int row = 0;
  while (drop->sample_stress[row] < 0.5 * drop->peak)
    row++;
  options.time = drop->sample[row];
  check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &shorter));
  check_near(shorter->peak_time, drop->sample[row], 1e-12 * drop->sample[row]);
  double *stress = numbers(6 * (int64_t)model->mesh->element_count);
  check_ok(context,
           bw_element_stress(context, model->mesh, model->material, shorter->displacement, stress));
  check_near(bwi_max_principal(stress + 6 * (int64_t)drop->peak_element), drop->peak_stress[row],
             1e-9 * drop->peak);
  free(stress);
  bw_release(shorter);
}

static void test_corner(void **state) {
  bw_context *context = check_context(state);
  const double a = 0.03, b = 0.02, c = 0.01, spin[3] = {3, -5, 2};
  bw_model *model = model_of(context, body_box(context, a, b, c, 6, 4, 2, 2), 0.3);
  bw_drop_options options = towards(-2, -1, -2);
  bw_drop *drop = NULL;
  memcpy(options.spin, spin, sizeof spin);
  check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &drop));
  const bw_drop_impact *impact = &drop->impact[0];
  const double up[3] = {2. / 3, 1. / 3, 2. / 3}, arm[3] = {-a / 2, -b / 2, -c / 2};
  const double mass = 1000 * a * b * c;
  const double inertia[3] = {mass / 12 * (b * b + c * c), mass / 12 * (a * a + c * c),
                             mass / 12 * (a * a + b * b)};
  double turn[3], whirl[3], effective = 1 / mass, approach, before = 0, after = 0;
  bw_cross(arm, up, turn);
  bw_cross(spin, arm, whirl);
  for (int k = 0; k < 3; k++) {
    effective += turn[k] * turn[k] / inertia[k];
    before += 0.5 * inertia[k] * spin[k] * spin[k];
    after += 0.5 * (mass * drop->velocity[k] * drop->velocity[k]);
  }
  effective = 1 / effective;
  approach = drop->speed - bw_dot(whirl, up);
  check_near(drop->speed, sqrt(2 * 9.80665), 1e-12);
  check_near(drop->energy, mass * 9.80665 + before, 1e-9 * drop->energy);
  assert_true(bw_norm(impact->place) < 1e-12);
  for (int k = 0; k < 3; k++) {
    double weight = mass * 9.80665 * drop->time[drop->row_count - 1]; /* the fall went on */
    check_near(drop->velocity[k] + drop->speed * up[k], (impact->impulse - weight) / mass * up[k],
               1e-9 * drop->speed);
    check_near(drop->spin[k] - spin[k], impact->impulse * turn[k] / inertia[k],
               0.04 * impact->impulse * bw_norm(turn) / inertia[0]);
  }
  assert_true(impact->impulse > 1.8 * effective * approach);
  assert_true(impact->impulse < 2.02 * effective * approach);
  assert_true(after < drop->energy && drop->error < 1e-3);

  check_deformation(context, model, drop);
  check_near(drop->stress[drop->peak_element], drop->peak, 0);
  check_history(drop);
  check_earlier(context, model, options, drop);
  bw_drop *fewer = NULL;
  int same = 0;
  options.samples = 25;
  check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &fewer));
  assert_int_equal(fewer->peak_element, drop->peak_element);
  for (int i = 0; i < fewer->sample_count; i++)
    for (int j = 0; j < drop->sample_count; j++)
      if (drop->sample[j] == fewer->sample[i]) {
        check_near(fewer->peak_stress[i], drop->peak_stress[j], 1e-9 * drop->peak);
        same++;
      }
  assert_int_equal(same, fewer->sample_count);
  bw_release(fewer);
  assert_true(drop->sample_count >= 100 && drop->sample_count <= 200);
  assert_true(drop->utilisation[drop->peak_element] >= 0.99 * drop->peak / 2e7);

  /* of a face that lands almost flat, under the largest force: columns of many nodes */
  bw_drop *pressed = NULL;
  bw_drop_options flat = towards(-0.02, -0.01, -1);
  check_ok(context, bw_drop_of_model(context, model, NULL, &flat, NULL, &pressed));
  double most = pressed->impact[0].force;
  flat.time = pressed->impact[0].peak_time;
  bw_release(pressed);
  check_ok(context, bw_drop_of_model(context, model, NULL, &flat, NULL, &pressed));
  check_deformation(context, model, pressed);
  check_near(pressed->force[pressed->row_count - 1], most, 0.01 * most);
  assert_true(pressed->impact[0].contacts > 16 && pressed->solves >= pressed->impact[0].contacts);
  bw_release(pressed);
  bw_release(drop);
  bw_release(model);
}

/* Six impacts of a box that turns keep the energy. With damping, the balance has what it took. */
static void test_bounces(void **state) {
  bw_context *context = check_context(state);
  const body b = body_of(context, body_box(context, 0.03, 0.02, 0.01, 6, 4, 2, 1), 0.3, 20);
  for (int damped = 0; damped < 2; damped++) {
    bw_drop_options options = towards(-0.3, -0.2, -1);
    bw_drop *drop = NULL;
    options.modes = b.modes;
    options.height = 0.2;
    options.impacts = 6;
    options.samples = 5;
    options.damping.ratio = damped ? 0.05 : 0;
    check_ok(context, bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop));
    assert_int_equal(drop->impact_count, 6);
    double taken = drop->damped[drop->row_count - 1] / drop->energy;
    assert_true(drop->error < 1e-3 && drop->error > 0);
    assert_true(damped ? taken > 0.01 : taken == 0);
    assert_true(drop->peak_time > drop->impact[0].time + drop->impact[0].duration);
    check_history(drop);
    for (int i = 1; i < drop->row_count; i++)
      assert_true(drop->time[i] >= drop->time[i - 1]);
    for (int i = 0; i < drop->row_count; i++)
      assert_true(drop->force[i] >= 0);
    bw_release(drop);
  }
  release_body(&b);
}

/* An inclined plane wherever it is: the body meets it along its fall, and the push is its normal.
 */
static void test_plane(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.02, 0.02, 0.02, 2, 2, 2, 1), 0.3);
  const double at[3] = {0, 0, -3}, normal[3] = {0.6, 0, 0.8};
  bw_rigid_surface *plane = NULL;
  bw_drop *drop = NULL;
  bw_drop_options options = towards(0, 0, -1);
  check_ok(context, bw_rigid_plane(context, at, normal, &plane));
  options.onto = plane;
  options.gravity = 0;
  options.speed = 1;
  check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &drop));
  check_near(drop->velocity[1], 0, 1e-6);
  check_near(drop->velocity[0] / (drop->velocity[2] + 1), 0.75, 1e-9);
  check_near(drop->potential[0], 0, 1e-12);
  bw_release(drop);
  bw_release(plane);
  bw_release(model);
}

/* The normal of a cube that lands on its corner, with a spin across it, turns as the body does: by
 * the duration times a spin between the first and the last. A node that comes near at the first
 * touch of a plate, and touches when the plate has turned by 0.02 rad, has a column of its own
 * normal: one of the first touch would turn by 0.036. */
static void test_turn(void **state) {
  bw_context *context = check_context(state);
  bw_model *cube = model_of(context, body_box(context, 0.02, 0.02, 0.02, 2, 2, 2, 1), 0.3);
  bw_model *plate = model_of(context, body_box(context, 0.03, 0.02, 0.004, 6, 4, 1, 1), 0.3);
  bw_drop_options options = towards(-1, -1, -1);
  bw_drop *drop = NULL;
  options.gravity = 0;
  options.speed = 2;
  options.samples = 0;
  options.spin[0] = 200;
  options.spin[1] = -200;
  check_ok(context, bw_drop_of_model(context, cube, NULL, &options, NULL, &drop));
  const bw_drop_impact *impact = drop->impact;
  assert_true(impact->turn > bw_norm(options.spin) * impact->duration);
  assert_true(impact->turn < bw_norm(drop->spin) * impact->duration);
  bw_release(drop);
  const bw_drop_options flat = {
      .speed = 1, .down = {0.03, 0.015, -1}, .spin = {0, 100, 0}, .impacts = 1, .tolerance = 1e-3};
  check_ok(context, bw_drop_of_model(context, plate, NULL, &flat, NULL, &drop));
  impact = drop->impact;
  assert_true(impact->contacts == 2 && impact->turn > 0.01 && impact->turn < 0.025);
  bw_release(drop);
  bw_release(cube);
  bw_release(plate);
}

static void bent_map(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = 0.15 * unit[0];
  out[1] = 0.03 * unit[1];
  out[2] = 0.004 * unit[2] + 0.01 * (unit[0] - 0.5) * (unit[0] - 0.5);
}

/* A bent plate that bounces and bends far. A flight ends before anything touches, so that the first
 * row of the impact behind it, whose time is that of the flight's last row, has no force. */
static void test_flights(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {8, 2, 1};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, bent_map, NULL, &mesh));
  const body b = body_of(context, mesh, 0.3, 6);
  for (int i = 0; i < 20; i++) {
    bw_drop_options options = towards(0, 0, -1);
    bw_drop *drop = NULL;
    options.modes = b.modes;
    options.height = 0.1 * (i + 1);
    options.impacts = 8;
    options.samples = 0;
    check_ok(context, bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop));
    assert_int_equal(drop->impact_count, 8);
    for (int k = 1; k < drop->row_count; k++)
      assert_true(drop->time[k] > drop->time[k - 1] || drop->force[k] == 0);
    assert_true(drop->error < 8e-3); /* the tolerance of eight impacts */
    bw_release(drop);
  }
  release_body(&b);
}

/* Steps that keep the energy badly are halved as soon as this shows: eight halvings take little
 * more than 256 times the steps of none, and not 511 times. */
static void test_halving(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.03, 0.02, 0.01, 3, 2, 1, 1), 0.3);
  int64_t steps[2] = {0};
  for (int fine = 0; fine < 2; fine++) {
    bw_drop_options options = towards(-0.3, -0.2, -1);
    bw_drop *drop = NULL;
    options.samples = 0;
    options.tolerance = fine ? 1e-14 : 1;
    check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &drop));
    steps[fine] = drop->steps;
    assert_true(fine ? drop->error > 1e-14 && drop->error < 1e-6 : drop->error > 1e-6);
    bw_release(drop);
  }
  assert_true(steps[1] > 200 * steps[0] && steps[1] < 320 * steps[0]);
  bw_release(model);
}

static void test_bad_input(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.02, 0.02, 0.02, 1, 1, 1, 1), 0.3);
  bw_drop *drop = NULL;
  const bw_drop_options good = towards(0, 0, -1);
  bw_drop_options bad = good;
  bad.height = 0;
  check_fails(context, BW_INVALID, "would not move",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bad = good;
  bad.down[2] = 0;
  check_fails(context, BW_INVALID, "direction",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bad = good;
  bad.damping.mass = 1;
  check_fails(context, BW_UNSUPPORTED, "slow the fall",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bad = good;
  bad.impacts = 0;
  check_fails(context, BW_INVALID, "0 impacts",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bw_model *other = model_of(context, body_box(context, 0.02, 0.02, 0.02, 1, 1, 1, 1), 0.3);
  bw_modes *modes = lowest(context, other, 5, NULL);
  bad = good;
  bad.modes = modes;
  check_fails(context, BW_INVALID, "not elastic modes of this model",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bw_modes *all = lowest(context, model, 18, NULL); /* 24 displacements, 6 rigid-body modes */
  bad.modes = all;
  check_fails(context, BW_INVALID, "take fewer modes",
              bw_drop_of_model(context, model, NULL, &bad, NULL, &drop));
  bw_release(all);
  bw_selection *face = NULL;
  const double origin[3] = {0, 0, 0}, axis[3] = {0, 0, 1};
  check_ok(context, bw_select_plane(context, model->mesh, origin, axis, 1e-9, &face));
  check_ok(context, bw_model_fix(context, model, face));
  check_fails(context, BW_INVALID, "neither supports nor loads",
              bw_drop_of_model(context, model, NULL, NULL, NULL, &drop));
  bw_release(face);
  bw_release(modes);
  bw_release(other);
  bw_release(model);
}

static void test_memory_failures(void **state) {
  bw_context *context = check_context(state);
  const body b = body_of(context, body_box(context, 0.02, 0.02, 0.02, 1, 1, 1, 1), 0.3, 3);
  bw_drop_options options = towards(-1, -2, -3);
  options.modes = b.modes;
  options.samples = 2;
  for (int64_t n = 1;; n++) {
    bw_drop *drop = NULL;
    bw_fail_allocation(n, false);
    bw_status status = bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop);
    bw_fail_allocation(0, false);
    if (status == BW_OK) {
      bw_release(drop);
      break;
    }
    assert_int_equal(status, BW_MEMORY);
    assert_null(drop);
  }
  release_body(&b);
}

#ifndef __SANITIZE_ADDRESS__ /* it takes all addresses */
static bw_status drop_within(bw_context *context, const body *b, const bw_drop_options *options,
                             size_t spare) {
  bw_drop *drop = NULL;
  struct rlimit before, limit;
  getrlimit(RLIMIT_AS, &before);
  limit = before;
  limit.rlim_cur = (rlim_t)bwi_address_space() + spare;
  setrlimit(RLIMIT_AS, &limit);
  bw_status status = bw_drop_of_model(context, b->model, b->system, options, NULL, &drop);
  setrlimit(RLIMIT_AS, &before);
  bw_release(drop);
  return status;
}

/* 1 MB is too little for the displacements of 3125 nodes, 7 MB for the compliances of 625 of them.
 */
static void test_too_little_memory(void **state) {
  bw_context *context = check_context(state);
  const body b = body_of(context, body_box(context, 0.03, 0.03, 0.01, 12, 12, 2, 2), 0.3, 5);
  bw_drop_options options = towards(0, 0, -1);
  options.modes = b.modes;
  check_fails(context, BW_MEMORY, "the modes and displacements of a drop take",
              drop_within(context, &b, &options, 1 << 20));
  bw_clear_failure(context);
  check_fails(context, BW_MEMORY, "mesh the faces that land coarser",
              drop_within(context, &b, &options, 7 << 20));
  bw_clear_failure(context);
  check_ok(context, drop_within(context, &b, &options, (size_t)1 << 30));
  release_body(&b);
}
#endif

/* A box that lands flat touches at 81 nodes. Stresses by a solution for each of few times are those
 * by one for each node, and all is the same on any number of threads. */
static void test_flat(void **state) {
  bw_context *context = check_context(state);
  const body b = body_of(context, body_box(context, 0.03, 0.03, 0.01, 4, 4, 2, 2), 0.3, 30);
  bw_drop_options options = towards(0, 0, -1);
  bw_drop *drop[3] = {NULL};
  options.modes = b.modes;
  for (int i = 0; i < 3; i++) {
    check_ok(context, bw_set_threads(context, i == 1 ? 3 : 1));
    options.samples = i < 2 ? 100 : 20;
    check_ok(context, bw_drop_of_model(context, b.model, b.system, &options, NULL, &drop[i]));
    assert_true(drop[i]->impact[0].contacts == 81 && drop[i]->error < 1e-3);
  }
  const size_t size = (size_t)b.model->mesh->element_count * sizeof(double);
  assert_memory_equal(drop[0]->stress, drop[1]->stress, size);
  assert_memory_equal(drop[0]->peak_stress, drop[1]->peak_stress,
                      (size_t)drop[0]->sample_count * sizeof(double));
  for (int i = 0; i < 3; i++)
    check_history(drop[i]);
  assert_true(drop[0]->sample_count > 81 && drop[2]->sample_count <= 40);
  int same = 0;
  for (int i = 0; i < drop[2]->sample_count; i++)
    for (int j = 0; j < drop[0]->sample_count; j++)
      if (drop[0]->sample[j] == drop[2]->sample[i]) {
        check_near(drop[2]->sample_stress[i], drop[0]->sample_stress[j], 1e-8 * drop[0]->peak);
        same++;
      }
  assert_int_equal(same, drop[2]->sample_count);
  for (int i = 0; i < 3; i++)
    bw_release(drop[i]);
  release_body(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_flat),
      check_test(test_rod),
      check_test(test_hertz),
      check_test(test_corner),
      check_test(test_bounces),
      check_test(test_plane),
      check_test(test_turn),
      check_test(test_flights),
      check_test(test_halving),
      check_test(test_bad_input),
      check_test(test_memory_failures),
#ifndef __SANITIZE_ADDRESS__
      check_test(test_too_little_memory),
#endif
  };
  return cmocka_run_group_tests_name("drop", tests, NULL, NULL);
}
