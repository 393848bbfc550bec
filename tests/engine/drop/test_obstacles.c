/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies that fall on spheres and cylinders, against Hertz's impact, the floor, and the laws of
 * momentum and energy. */
#include "bodies.h"

#include "barwright/drop.h"

static bw_model *model_of(bw_context *context, bw_mesh *mesh) {
  bw_material *material = NULL;
  bw_model *model = NULL;
  const bw_isotropic constants = {
      .name = "test", .young = 1e9, .poisson = 0.3, .density = 1000, .strength = 2e7};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(mesh);
  bw_release(material);
  return model;
}

static bw_drop_options towards(double x, double y, double z) {
  bw_drop_options options;
  bw_drop_options_default(&options);
  options.down[0] = x;
  options.down[1] = y;
  options.down[2] = z;
  options.samples = 0;
  return options;
}

static bw_rigid_surface *sphere(bw_context *context, const double *centre, double radius) {
  bw_rigid_surface *surface = NULL;
  check_ok(context, bw_rigid_sphere(context, centre, radius, false, &surface));
  return surface;
}

static bw_rigid_surface *cylinder(bw_context *context, const double *point, double x, double y,
                                  double z, double radius) {
  const double axis[3] = {x, y, z};
  bw_rigid_surface *surface = NULL;
  check_ok(context, bw_rigid_cylinder(context, point, axis, radius, false, &surface));
  return surface;
}

static bw_drop *drop_onto(bw_context *context, const bw_model *model, bw_drop_options options,
                          bw_rigid_surface *onto) {
  bw_drop *drop = NULL;
  options.onto = onto;
  check_ok(context, bw_drop_of_model(context, model, NULL, &options, NULL, &drop));
  bw_release(onto);
  return drop;
}

static void refuse(bw_context *context, bw_status status, const char *words, const bw_model *model,
                   bw_drop_options options, bw_rigid_surface *onto) {
  bw_drop *drop = NULL;
  options.onto = onto;
  check_fails(context, status, words,
              bw_drop_of_model(context, model, NULL, &options, NULL, &drop));
  assert_null(drop);
  bw_release(onto);
}

/* ---- Hertz ----------------------------------------------------------------------------------- */

static const double dome = 0.01; /* radius */

/* A block whose lower face is part of a sphere, with small elements about its lowest point. */
static void dome_map(void *data, const double unit[3], double out[3]) {
  const double grade = *(double *)data;
  for (int k = 0; k < 2; k++)
    out[k] = 0.6 * dome * sinh(grade * (2 * unit[k] - 1)) / sinh(grade);
  double low = dome - sqrt(dome * dome - out[0] * out[0] - out[1] * out[1]);
  out[2] = low + (1.2 * dome - low) * expm1(grade * unit[2]) / expm1(grade);
}

static bw_model *dome_model(bw_context *context, int count, double grade) {
  const int cells[3] = {count, count, count - 2};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, dome_map, &grade, &mesh));
  return model_of(context, mesh);
}

/* Hertz's impact: force = stiffness d^1.5, of the duration 2.943 d / v, d the deepest approach. */
static void check_hertz(const bw_drop *drop, double speed, double stiffness) {
  double deep = pow(1.25 * drop->mass * speed * speed / stiffness, 0.4);
  double time = 2.94327 * deep / speed, force = stiffness * pow(deep, 1.5);
  check_near(drop->impact[0].duration, time, 0.02 * time);
  check_near(drop->impact[0].force, force, 0.02 * force);
  check_near(drop->velocity[2], speed, 1e-3 * speed);
  assert_true(drop->error < 1e-3);
}

static const double modulus = 1e9 / (1 - 0.3 * 0.3);

/* On a sphere: 1/R = 1/R1 + 1/R2. Twice the speed makes the contact as wide as on a floor. */
static void test_sphere_on_sphere(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = dome_model(context, 12, 6);
  bw_drop_options options = towards(0, 0, -1);
  options.gravity = 0;
  options.speed = 0.08;
  bw_drop *drop = drop_onto(context, model, options, sphere(context, NULL, dome));
  check_hertz(drop, options.speed, 4. / 3 * modulus * sqrt(dome / 2));
  check_near(drop->onto->point[2], -dome, 1e-9);
  assert_true(drop->impact[0].turn < 0.1);
  bw_release(drop);
  bw_release(model);
}

/* The complete elliptic integrals by the means of Gauss: K, and E by the sum of the squares. */
static double elliptic(double square, double *second) {
  double a = 1, b = sqrt(1 - square), sum = 0.5 * square, power = 0.5;
  while (a - b > 1e-14) {
    double c = 0.5 * (a - b), next = 0.5 * (a + b);
    b = sqrt(a * b);
    a = next;
    power *= 2;
    sum += power * c * c;
  }
  *second = M_PI / (2 * a) * (1 - sum);
  return M_PI / (2 * a);
}

/* Force over approach^1.5 of bodies with the principal relative radii `wide` >= `narrow` (Johnson,
 * Contact Mechanics, eqs 4.26 to 4.28). */
static double elliptic_stiffness(double wide, double narrow) {
  double low = 0, high = 1 - 1e-12, first = 0, second = 0;
  for (int i = 0; i < 200; i++) { /* of the square of the eccentricity */
    double e2 = 0.5 * (low + high), k, e;
    k = elliptic(e2, &e);
    double ratio = (e / (1 - e2) - k) / (k - e);
    *(ratio < wide / narrow ? &low : &high) = e2;
    first = k;
    second = e;
  }
  double e2 = low, aspect = sqrt(1 - e2);
  double f1 = cbrt(4 / (M_PI * e2) * pow(aspect, 1.5) *
                   sqrt((second / (1 - e2) - first) * (first - second)));
  double f2 = 2 / M_PI * sqrt(aspect) / f1 * first;
  return 4. / 3 * modulus * sqrt(sqrt(wide * narrow)) / pow(f2, 1.5);
}

/* On a cylinder, where the contact is an ellipse: its short axis asks for smaller elements. */
static void test_sphere_on_cylinder(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = dome_model(context, 16, 5);
  bw_drop_options options = towards(0, 0, -1);
  options.gravity = 0;
  options.speed = 0.03;
  check_near(elliptic_stiffness(dome * 1.001, dome), 4. / 3 * modulus * sqrt(dome),
             1e-3 * modulus * sqrt(dome));
  bw_drop *drop = drop_onto(context, model, options, cylinder(context, NULL, 1, 0, 0, dome));
  check_hertz(drop, options.speed, elliptic_stiffness(dome, dome / 2));
  bw_release(drop);
  bw_release(model);
}

/* ---- the floor ------------------------------------------------------------------------------- */

/* A sphere or cylinder of a large radius below the corner that lands is a floor. */
static void test_large_radius(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.03, 0.02, 0.01, 6, 4, 2, 1));
  const double corner[3] = {0, 0, 0};
  bw_drop_options options = towards(-2, -1, -2);
  bw_drop *floor = drop_onto(context, model, options, NULL);
  for (int kind = 0; kind < 2; kind++) {
    bw_drop *drop = drop_onto(context, model, options,
                              kind == 0 ? sphere(context, corner, 1e4)
                                        : cylinder(context, corner, 1, -2, 0, 1e4));
    check_near(drop->impact[0].duration, floor->impact[0].duration,
               1e-6 * floor->impact[0].duration);
    check_near(drop->impact[0].force, floor->impact[0].force, 1e-6 * floor->impact[0].force);
    check_near(drop->impact[0].impulse, floor->impact[0].impulse, 1e-6 * floor->impact[0].impulse);
    for (int k = 0; k < 3; k++)
      check_near(drop->velocity[k], floor->velocity[k], 1e-6 * floor->speed);
    bw_release(drop);
  }
  bw_release(floor);
  bw_release(model);
}

/* ---- momentum and energy --------------------------------------------------------------------- */

/* Forces of a sphere pass its centre: the angular momentum about that stays the same, of a cube
 * that hits beside its centre of mass. About a cylinder that holds for the component along the
 * axis. The impulse is the change of linear momentum. */
static void test_momentum(void **state) {
  bw_context *context = check_context(state);
  const double side = 0.02, mass = 1000 * side * side * side, inertia = mass * side * side / 6;
  const double spin[3] = {3, -5, 2}, off[3] = {0.014, 0.012, 0};
  bw_model *model = model_of(context, body_box(context, side, side, side, 8, 8, 8, 1));
  bw_drop_options options = towards(0, 0, -1);
  options.gravity = 0;
  options.speed = 0.1;
  memcpy(options.spin, spin, sizeof spin);
  for (int kind = 0; kind < 2; kind++) {
    bw_drop *drop =
        drop_onto(context, model, options,
                  kind == 0 ? sphere(context, off, 0.02) : cylinder(context, off, 3, 4, 0, 0.02));
    double arm[3], change[3], moment[3];
    for (int k = 0; k < 3; k++) {
      arm[k] = side / 2 - drop->onto->point[k];
      change[k] = mass * (drop->velocity[k] + (k == 2 ? options.speed : 0));
    }
    bw_cross(arm, change, moment);
    double size = bw_norm(moment);
    for (int k = 0; k < 3; k++)
      moment[k] += inertia * (drop->spin[k] - spin[k]);
    /* the lever arm is that of the first touch */
    check_near(kind == 0 ? bw_norm(moment) : bw_dot(moment, drop->onto->direction), 0, 2e-3 * size);
    check_near(drop->impact[0].impulse, bw_norm(change), 1e-9 * bw_norm(change));
    if (kind == 1)
      check_near(bw_dot(change, drop->onto->direction), 0, 1e-12 * bw_norm(change));
    assert_true(size > 0.05 * side * bw_norm(change) && drop->error < 1e-3);
    bw_release(drop);
  }
  bw_release(model);
}

/* Several impacts on either keep the energy, although normals differ and the body turns. A body
 * that falls off leaves for ever. */
static void test_bounces(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.03, 0.02, 0.01, 12, 8, 4, 1));
  int most = 0;
  for (int i = 0; i < 6; i++) {
    bw_drop_options options = towards(0.02 * i, -0.01, -1);
    options.height = 0.05;
    options.impacts = 5;
    bw_drop *drop = drop_onto(context, model, options,
                              i % 2 == 0 ? sphere(context, NULL, 0.02)
                                         : cylinder(context, NULL, 0, 1, 0, 0.02));
    assert_true(drop->impact_count >= 1 && drop->error < 1e-3 && drop->error > 0);
    most = drop->impact_count > most ? drop->impact_count : most;
    bw_release(drop);
  }
  assert_true(most >= 3);
  bw_release(model);
}

/* ---- rotation -------------------------------------------------------------------------------- */

static const double turn[3][3] = {
    {2. / 3, -2. / 3, 1. / 3}, {1. / 3, 2. / 3, 2. / 3}, {-2. / 3, -1. / 3, 2. / 3}};

static void rotate(const double x[3], double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = bw_dot(turn[k], x);
}

static void brick_map(void *data, const double unit[3], double out[3]) {
  const double x[3] = {0.03 * unit[0], 0.02 * unit[1], 0.01 * unit[2] * (1 + 0.2 * unit[0])};
  if (data)
    rotate(x, out);
  else
    memcpy(out, x, sizeof x);
}

/* The same numbers when body, obstacle, fall, gravity and spin are rotated. */
static void test_rotation(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {9, 6, 3};
  const double place[3] = {0.02, 0.012, 0}, axis[3] = {0.2, 1, 0.1}, spin[3] = {3, -5, 2};
  const double down[3] = {0.1, -0.05, -1};
  for (int kind = 0; kind < 2; kind++) {
    bw_drop *drop[2];
    for (int turned = 0; turned < 2; turned++) {
      bw_mesh *mesh = NULL;
      double at[3], along[3];
      bw_drop_options options = towards(down[0], down[1], down[2]);
      memcpy(at, place, sizeof at);
      memcpy(along, axis, sizeof along);
      memcpy(options.spin, spin, sizeof spin);
      if (turned) {
        rotate(place, at);
        rotate(axis, along);
        rotate(down, options.down);
        rotate(spin, options.spin);
      }
      check_ok(context,
               bw_mesh_mapped_box(context, cells, 1, brick_map, turned ? &turned : NULL, &mesh));
      bw_model *model = model_of(context, mesh);
      drop[turned] =
          drop_onto(context, model, options,
                    kind == 0 ? sphere(context, at, 0.03)
                              : cylinder(context, at, along[0], along[1], along[2], 0.03));
      bw_release(model);
    }
    const bw_drop_impact *one = drop[0]->impact, *other = drop[1]->impact;
    double velocity[3];
    rotate(drop[0]->velocity, velocity);
    check_near(other->force, one->force, 1e-6 * one->force);
    check_near(other->duration, one->duration, 1e-6 * one->duration);
    check_near(other->impulse, one->impulse, 1e-6 * one->impulse);
    for (int k = 0; k < 3; k++)
      check_near(drop[1]->velocity[k], velocity[k], 1e-6 * drop[0]->speed);
    assert_int_equal(one->contacts, other->contacts);
    bw_release(drop[0]);
    bw_release(drop[1]);
  }
}

/* ---- what is refused ------------------------------------------------------------------------- */

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.02, 0.02, 0.02, 2, 2, 2, 1));
  const bw_drop_options options = towards(0, 0, -1);
  const double far[3] = {0.04, 0, 0}, between[3] = {0.005, 0.005, 0};
  bw_rigid_surface *bowl = NULL;
  refuse(context, BW_GEOMETRY,
         "misses the peg of radius 0.005 m: it falls past at a distance of 0.015 m", model, options,
         sphere(context, far, 0.005));
  refuse(context, BW_GEOMETRY, "misses the edge", model, options,
         cylinder(context, far, 0, 1, 0, 0.005));
  refuse(context, BW_INVALID, "across `down`", model, options,
         cylinder(context, NULL, 0, 0, 1, 0.005));
  /* nodes are 0.01 m apart: a sphere of 0.003 m meets none, that of 0.01 m goes deep */
  refuse(context, BW_LIMIT, "passes between the nodes", model, options,
         sphere(context, between, 3e-3));
  refuse(context, BW_LIMIT, "goes 0.0029", model, options, sphere(context, between, 0.01));
  check_ok(context, bw_rigid_sphere(context, NULL, 1, true, &bowl));
  refuse(context, BW_UNSUPPORTED, "leave out `inside`", model, options, bowl);
  /* a node is at the centre of the face */
  bw_drop *drop = drop_onto(context, model, options, sphere(context, NULL, 3e-3));
  check_near(drop->depth, 0, 1e-15);
  check_near(drop->onto->point[0], 0.01, 1e-12);
  check_near(drop->onto->point[2], -3e-3, 1e-12);
  bw_release(drop);
  bw_release(model);
}

/* Many drops are judged before the work of the first: one that misses is named, and one that is
 * refused refuses all. */
static void test_misses(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = model_of(context, body_box(context, 0.02, 0.02, 0.02, 2, 2, 2, 1));
  const double far[3] = {0.04, 0, 0}, between[3] = {0.005, 0.005, 0};
  bw_rigid_surface *onto[] = {sphere(context, far, 0.005), sphere(context, NULL, 3e-3),
                              cylinder(context, far, 0, 1, 0, 0.005),
                              sphere(context, between, 0.01)};
  bw_drop_options options[4];
  bool misses[4] = {false, true, false, true};
  for (int i = 0; i < 4; i++) {
    options[i] = towards(0, 0, -1);
    options[i].onto = onto[i];
  }
  check_ok(context, bw_drop_misses(context, model, 3, options, misses));
  assert_true(misses[0] && !misses[1] && misses[2]);
  check_fails(context, BW_LIMIT, "goes 0.0029", bw_drop_misses(context, model, 4, options, misses));
  check_fails(context, BW_GEOMETRY, "misses the peg",
              bw_drop_misses(context, model, 1, options, misses));
  for (int64_t n = 1;; n++) {
    bw_fail_allocation(n, false);
    bw_status status = bw_drop_misses(context, model, 3, options, misses);
    bw_fail_allocation(0, false);
    if (status == BW_OK) {
      assert_true(n > 4);
      break;
    }
    assert_int_equal(status, BW_MEMORY);
  }
  for (int i = 0; i < 4; i++)
    bw_release(onto[i]);
  bw_release(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_sphere_on_sphere), check_test(test_sphere_on_cylinder),
      check_test(test_large_radius),     check_test(test_momentum),
      check_test(test_bounces),          check_test(test_rotation),
      check_test(test_refused),          check_test(test_misses),
  };
  return cmocka_run_group_tests_name("obstacles", tests, NULL, NULL);
}
