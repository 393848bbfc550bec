/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear bodies in time against closed forms of modes, orders in time and balances of energy. */
#include "bodies.h"

#include "barwright/eigen.h"
#include "barwright/transient.h"

static bw_selection *plane(bw_context *context, const bw_mesh *mesh, int k, double at) {
  double origin[3] = {0, 0, 0}, axis[3] = {0, 0, 0};
  bw_selection *face = NULL;
  origin[k] = at;
  axis[k] = 1;
  check_ok(context, bw_select_plane(context, mesh, origin, axis, 1e-9, &face));
  return face;
}

/* A bar along x, fixed at x = 0 where `fixed`. */
static bw_model *bar(bw_context *context, bool fixed, int order) {
  bw_mesh *mesh = body_box(context, 1, 0.1, 0.08, 8, 1, 1, order);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  if (fixed) {
    bw_selection *held = plane(context, mesh, 0, 0);
    check_ok(context, bw_model_fix(context, model, held));
    bw_release(held);
  }
  bw_release(mesh);
  bw_release(material);
  return model;
}

static bw_modes *lowest(bw_context *context, const bw_model *model, int count) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = count;
  options.tolerance = 1e-11;
  check_ok(context, bw_modes_of_model(context, model, NULL, &options, NULL, &modes));
  return modes;
}

static bw_linear_transient *start(bw_context *context, const bw_model *model,
                                  const bw_linear_transient_options *options,
                                  const bw_transient_factors *now) {
  bw_linear_transient *t = NULL;
  check_ok(context, bw_linear_transient_create(context, model, NULL, options, now, &t));
  return t;
}

static void march(bw_context *context, bw_linear_transient *t, int steps) {
  for (int k = 0; k < steps; k++)
    check_ok(context, bw_linear_transient_step(context, t, NULL));
}

static double largest(int64_t size, const double *x) {
  double most = 0;
  for (int64_t i = 0; i < size; i++)
    most = fmax(most, fabs(x[i]));
  return most;
}

static double balance(const bw_linear_transient *t) {
  return t->initial + t->work - t->kinetic - t->strain - t->damped;
}

/* A mode released from its shape swings as e^(-d t) (cos w' t + d / w' sin w' t), with Rayleigh
 * damping d = (a + b w^2) / 2. The error falls with the square of the step for any rho. */
static void test_mode(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  bw_modes *modes = lowest(context, model, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const double *shape = modes->shape + size; /* the second mode */
  const double w = sqrt(modes->eigenvalue[1]), a = 0.04 * w, b = 0.02 / w, d = (a + b * w * w) / 2;
  const double until = 2.2 * 2 * M_PI / w, swing = sqrt(w * w - d * d);
  const double expected = exp(-d * until) * (cos(swing * until) + d / swing * sin(swing * until));
  for (int which = 0; which < 3; which++) {
    double error[3];
    for (int level = 0; level < 3; level++) {
      int steps = 200 << level;
      const bw_linear_transient_options options = {.step = until / steps,
                                                   .rho = 0.5 * which,
                                                   .damping = {.mass = a, .stiffness = b},
                                                   .displacement = shape};
      bw_linear_transient *t = start(context, model, &options, NULL);
      march(context, t, steps);
      double *off = numbers(size);
      for (int64_t i = 0; i < size; i++)
        off[i] = t->displacement[i] - expected * shape[i];
      error[level] = largest(size, off) / largest(size, shape);
      free(off);
      bw_release(t);
    }
    check_near(log2(error[0] / error[1]), 2, 0.1);
    check_near(log2(error[1] / error[2]), 2, 0.05);
    assert_true(error[2] < 2e-3);
  }
  bw_release(modes);
  bw_release(model);
}

/* A free body thrown with a spin keeps energy and momentum: to rounding with rho = 1. */
static void test_free_body(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_model *model = bar(context, false, order);
    const bw_mesh *mesh = model->mesh;
    int64_t size = 3 * (int64_t)mesh->node_count;
    double *velocity = numbers(size), *one = numbers(size), *product = numbers(size);
    double momentum[2] = {0, 0}, mass = 1 * 0.1 * 0.08 * 7800;
    random_field(3, size, velocity);
    for (int64_t i = 0; i < size; i++) {
      velocity[i] += i % 3 == 2 ? 5 : 0;
      one[i] = i % 3 == 2;
    }
    const bw_linear_transient_options options = {.step = 2e-6, .rho = 1, .velocity = velocity};
    bw_linear_transient *t = start(context, model, &options, NULL);
    bw_block_pattern *pattern = NULL;
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *values = numbers(pattern->block_count);
    check_ok(context, bw_mass(context, pattern, mesh, model->material, values));
    check_ok(context, bw_block_multiply(context, pattern, values, 1, 3, 1, one, product));
    for (int64_t i = 0; i < size; i++)
      momentum[0] += product[i] * t->velocity[i];
    march(context, t, 300);
    for (int64_t i = 0; i < size; i++)
      momentum[1] += product[i] * t->velocity[i];
    assert_true(t->strain > 1e-3 * t->initial);
    check_near(balance(t), 0, 1e-10 * t->initial);
    check_near(t->work, 0, 1e-12 * t->initial);
    check_near(momentum[1], momentum[0], 1e-10 * mass * 5);
    free(velocity);
    free(one);
    free(product);
    free(values);
    bw_release(pattern);
    bw_release(t);
    bw_release(model);
  }
}

/* Gravity alone: a free body falls g t^2 / 2, exactly, and without stress. */
static void test_fall(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, false, 2);
  const double g[3] = {0, 0, -9.81};
  check_ok(context, bw_model_gravity(context, model, g));
  const bw_linear_transient_options options = {.step = 1e-3, .rho = 0.8};
  bw_linear_transient *t = start(context, model, &options, NULL);
  march(context, t, 50);
  for (int64_t i = 2; i < 3 * (int64_t)model->mesh->node_count; i += 3)
    check_near(t->displacement[i], -0.5 * 9.81 * 0.05 * 0.05, 1e-9);
  double mass = 0.008 * 7800;
  check_near(t->work, mass * 9.81 * 0.5 * 9.81 * 0.05 * 0.05, 1e-6);
  check_near(t->kinetic, t->work, 1e-6 * t->work);
  check_near(t->strain, 0, 1e-7 * t->work); /* rounding of K u */
  bw_release(t);
  bw_release(model);
}

/* A load applied at once: mean displacement that of statics, the first mode's peak twice it; with
 * damping the motion ends in the static solution, and the balance of energy holds. */
static void test_step_load(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  const double force[3] = {0, 0, -1000};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_force(context, model, end, force));
  bw_release(end);
  bw_static *rest = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &rest));
  bw_modes *modes = lowest(context, model, 1);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const double w = sqrt(modes->eigenvalue[0]), still = largest(size, rest->displacement);
  const double h = 2 * M_PI / w / 200;
  bw_linear_transient_options options = {.step = h, .rho = 1};
  bw_linear_transient *t = start(context, model, &options, NULL);
  double peak = 0;
  for (int k = 0; k < 210; k++) {
    march(context, t, 1);
    peak = fmax(peak, largest(size, t->displacement));
    check_near(balance(t), 0, 1e-9 * (t->work + t->strain));
  }
  check_near(peak / still, 2, 0.06); /* higher modes are out of step */
  const bw_motion_resolution loaded = bw_linear_transient_resolution(context, t);
  bw_release(t);
  /* without the load, from minus its displacement, the motion about its mean is the same */
  bw_model *bare = bar(context, true, 2);
  double *minus = numbers(size);
  for (int64_t i = 0; i < size; i++)
    minus[i] = -rest->displacement[i];
  options.displacement = minus;
  t = start(context, bare, &options, NULL);
  march(context, t, 210);
  const bw_motion_resolution about = bw_linear_transient_resolution(context, t);
  check_near(loaded.steps, about.steps, 1e-6 * about.steps);
  assert_true(about.steps > 60 && about.steps < 200);
  options.displacement = NULL;
  free(minus);
  bw_release(t);
  bw_release(bare);
  options.rho = 0.5;
  options.damping.mass = 1.4 * w;
  t = start(context, model, &options, NULL);
  march(context, t, 1500);
  double *off = numbers(size);
  for (int64_t i = 0; i < size; i++)
    off[i] = t->displacement[i] - rest->displacement[i];
  assert_true(largest(size, off) < 1e-6 * still);
  check_near(balance(t), 0, 2e-3 * t->work);
  /* the present state as a static solution: stresses, reactions and forces are those at rest */
  bw_static *now = NULL;
  check_ok(context, bw_linear_transient_static(context, t, &now));
  check_near(now->energy, rest->energy, 1e-5 * rest->energy);
  for (int64_t i = 0; i < size; i++) {
    check_near(now->reaction[i], rest->reaction[i], 1e-2);
    check_near(now->force[i], rest->force[i], 1e-2);
  }
  free(off);
  bw_release(now);
  bw_release(t);
  bw_release(modes);
  bw_release(rest);
  bw_release(model);
}

/* Of a mode that swings, the steps per period and the error of the period are those of its zero
 * crossings. Six steps per period warn, twenty do not; a body that falls has no period. */
static void test_resolution(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2), *loose = bar(context, false, 1);
  bw_modes *modes = lowest(context, model, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const double *shape = modes->shape + size, w = sqrt(modes->eigenvalue[1]);
  int64_t at = 0;
  for (int64_t i = 0; i < size; i++)
    at = fabs(shape[i]) > fabs(shape[at]) ? i : at;
  for (int which = 0; which < 6; which++) {
    const int per = which % 3 == 0 ? 6 : which % 3 == 1 ? 20 : 50, periods = 10;
    const bw_linear_transient_options options = {
        .step = 2 * M_PI / w / per, .rho = which < 3 ? 1 : 0.5, .displacement = shape};
    double crossing[2] = {0, 0};
    int crossings = 0;
    bw_clear_warnings(context);
    bw_linear_transient *t = start(context, model, &options, NULL);
    for (int k = 0; k < periods * per; k++) {
      double before = t->displacement[at];
      march(context, t, 1);
      if (before * t->displacement[at] < 0) {
        double here = k + before / (before - t->displacement[at]);
        crossing[crossings > 0] = here;
        crossings++;
      }
    }
    const double steps = 2 * (crossing[1] - crossing[0]) / (crossings - 1);
    bw_motion_resolution r = bw_linear_transient_resolution(context, t);
    check_near(r.steps, steps, 0.03 * steps);
    check_near(r.error, steps / per - 1, 0.12 * (steps / per - 1));
    assert_int_equal(bw_warning_at(context, 0) != NULL, per == 6);
    bw_release(t);
  }
  const double g[3] = {0, 0, -9.81};
  check_ok(context, bw_model_gravity(context, loose, g));
  const bw_linear_transient_options options = {.step = 1e-3, .rho = 0.8};
  bw_linear_transient *t = start(context, loose, &options, NULL);
  bw_clear_warnings(context);
  march(context, t, 100);
  assert_true(bw_linear_transient_resolution(context, t).steps == 0);
  assert_null(bw_warning_at(context, 0));
  bw_release(t);
  bw_release(modes);
  bw_release(loose);
  bw_release(model);
}

/* Steps that adapt follow a mode with the error that they estimate. One that is rejected leaves the
 * state as it was; what a step does not see of a load counts as error. */
static void test_adaptive(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  bw_modes *modes = lowest(context, model, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const double *shape = modes->shape + size, w = sqrt(modes->eigenvalue[1]);
  const double period = 2 * M_PI / w;
  double *before = numbers(3 * size), *off = numbers(size);
  /* rho, the tolerance, and how far the estimate may be off, relatively */
  static const double followed[][3] = {{0, 1e-4, 0.05},   {0.5, 1e-4, 0.05}, {1, 1e-4, 0.05},
                                       {0.9, 1e-4, 0.05}, {0.9, 1e-3, 0.05}, {0.3, 1e-5, 0.15}};
  for (size_t which = 0; which < sizeof followed / sizeof *followed; which++) {
    const double *given = followed[which];
    const bw_linear_transient_options options = {
        .step = period / 20, .rho = given[0], .error = given[1], .displacement = shape};
    bw_linear_transient *t = start(context, model, &options, NULL);
    double most = 0;
    while (t->time < 5 * period) {
      const int64_t steps = t->steps;
      const double time = t->time, h = t->step;
      const double *field[3] = {t->displacement, t->velocity, t->acceleration};
      for (int k = 0; k < 3; k++)
        memcpy(before + k * size, field[k], (size_t)size * sizeof(double));
      march(context, t, 1);
      if (t->steps == steps) {
        assert_true(t->time == time && t->step < h);
        for (int k = 0; k < 3; k++)
          assert_memory_equal(before + k * size, field[k], (size_t)size * sizeof(double));
      } else
        check_near(t->time, time + h, 1e-12 * period);
      for (int64_t i = 0; i < size; i++)
        off[i] = t->displacement[i] - cos(w * t->time) * shape[i];
      if (t->time > 4 * period)
        most = fmax(most, largest(size, off) / largest(size, shape));
    }
    assert_true(t->rejected > 0 && t->factors > 1 && t->coarse == 0);
    check_near(t->error, most, given[2] * most);
    assert_true(bw_linear_transient_resolution(context, t).steps == 0);
    bw_release(t);
  }
  const double force[3] = {0, 0, -1000};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_force(context, model, end, force));
  const double off_load = 0, seen = 0, unseen = 0.1;
  const bw_linear_transient_options options = {.step = period / 20, .rho = 0.9, .error = 1e-3};
  for (int which = 0; which < 2; which++) {
    bw_transient_factors f = {.load = &off_load};
    bw_linear_transient *t = start(context, model, &options, &f);
    f.load_missed = which ? &unseen : &seen;
    check_ok(context, bw_linear_transient_step(context, t, &f));
    assert_int_equal(t->rejected, which);
    assert_int_equal(t->steps, 1 - which);
    bw_release(t);
  }
  const double broken = NAN;
  bw_transient_factors f = {.load = &off_load};
  bw_linear_transient *t = start(context, model, &options, &f);
  f.load_missed = &broken;
  assert_int_equal(bw_linear_transient_step(context, t, &f), BW_INVALID);
  bw_release(t);
  bw_release(end);
  free(before);
  free(off);
  bw_release(modes);
  bw_release(model);
}

/* Supports that move: a stiff bar follows its foot, and a mode of the bar is excited as a single
 * mass on a spring is by y = Y (1 - cos(W t)), whose relative motion is closed. */
static void test_moving_support(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.1, 0.08, 8, 1, 1, 2);
  bw_material *material = body_material(context);
  bw_model *model = NULL, *fixed = bar(context, true, 2);
  const bool all[3] = {true, true, true};
  const double y[3] = {0, 0, 1e-3};
  bw_selection *foot = plane(context, mesh, 0, 0);
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_prescribe(context, model, foot, all, y));
  bw_modes *modes = lowest(context, fixed, 12);
  int64_t size = 3 * (int64_t)mesh->node_count;
  bw_block_pattern *pattern = NULL;
  check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
  double *values = numbers(pattern->block_count), *one = numbers(size), *product = numbers(size);
  check_ok(context, bw_mass(context, pattern, mesh, material, values));
  for (int64_t i = 2; i < size; i += 3)
    one[i] = 1;
  check_ok(context, bw_block_multiply(context, pattern, values, 1, 3, 1, one, product));
  const double W = 0.6 * sqrt(modes->eigenvalue[0]), until = 4 / W;
  double *expected = numbers(size), error[3];
  for (int64_t i = 2; i < size; i += 3)
    expected[i] = y[2] * (1 - cos(W * until));
  for (int k = 0; k < modes->count; k++) { /* q'' + w^2 q = -p y'', from rest */
    const double *shape = modes->shape + k * size;
    double w = sqrt(modes->eigenvalue[k]), p = 0;
    for (int64_t i = 0; i < size; i++)
      p += shape[i] * product[i];
    double q = -p * y[2] * W * W / (w * w - W * W) * (cos(W * until) - cos(w * until));
    for (int64_t i = 0; i < size; i++)
      expected[i] += q * shape[i];
  }
  for (int level = 0; level < 3; level++) {
    int steps = 25 << level;
    double h = until / steps;
    bw_linear_transient_options options = {.step = h, .rho = 0.9};
    double y_of[3] = {0, 0, W * W};
    const bw_transient_factors f = {.support = y_of};
    bw_linear_transient *t = start(context, model, &options, &f);
    for (int k = 1; k <= steps; k++) {
      y_of[0] = 1 - cos(W * h * k);
      y_of[1] = W * sin(W * h * k);
      y_of[2] = W * W * cos(W * h * k);
      check_ok(context, bw_linear_transient_step(context, t, &f));
    }
    for (int64_t i = 0; i < size; i++)
      error[level] = fmax(i ? error[level] : 0, fabs(t->displacement[i] - expected[i]));
    for (int32_t i = 0; i < foot->node_count; i++)
      check_near(t->displacement[3 * foot->node[i] + 2], y[2] * (1 - cos(W * until)), 1e-12);
    check_near(balance(t), 0, 2e-3 * t->work);
    bw_release(t);
  }
  check_near(log2(error[0] / error[2]), 4, 0.5); /* of second order */
  assert_true(error[2] < 1e-3 * largest(size, expected));
  free(values);
  free(one);
  free(product);
  free(expected);
  bw_release(pattern);
  bw_release(modes);
  bw_release(foot);
  bw_release(material);
  bw_release(mesh);
  bw_release(model);
  bw_release(fixed);
}

/* Two loads with histories of their own superpose. */
static void test_superposition(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 1);
  const double force[2][3] = {{0, 0, -1000}, {300, 500, 0}};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  for (int k = 0; k < 2; k++)
    check_ok(context, bw_model_force(context, model, end, force[k]));
  bw_release(end);
  const bw_linear_transient_options options = {.step = 1e-4, .rho = 0.7};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *sum = numbers(size);
  for (int which = 0; which < 3; which++) {
    double factor[2] = {which != 1, 0};
    const bw_transient_factors f = {.load = factor};
    bw_linear_transient *t = start(context, model, &options, &f);
    for (int k = 1; k <= 20; k++) {
      factor[0] = which != 1 ? 1 - 0.05 * k : 0;
      factor[1] = which != 0 ? sin(0.3 * k) : 0;
      check_ok(context, bw_linear_transient_step(context, t, &f));
    }
    for (int64_t i = 0; i < size; i++)
      sum[i] += which < 2 ? t->displacement[i] : -t->displacement[i];
    if (which == 2)
      assert_true(largest(size, sum) < 1e-11 * largest(size, t->displacement));
    bw_release(t);
  }
  free(sum);
  bw_release(model);
}

/* Superposed, a mode follows its closed form whatever the step: below and above critical damping.
 */
static void test_superposed_mode(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  bw_modes *modes = lowest(context, model, 3);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  const double *shape = modes->shape + size;
  const double w = sqrt(modes->eigenvalue[1]), h = 0.7 * 2 * M_PI / w;
  for (int strong = 0; strong < 2; strong++) {
    const double d = strong ? 1.25 * w : 0.07 * w, until = 4 * h;
    const double s = sqrt(fabs(w * w - d * d));
    const double expected = strong ? exp(-d * until) * (cosh(s * until) + d / s * sinh(s * until))
                                   : exp(-d * until) * (cos(s * until) + d / s * sin(s * until));
    bw_linear_transient_options options = {
        .step = h, .rho = 1, .modes = modes, .displacement = shape};
    if (strong)
      options.damping.mass = 2 * d;
    else
      options.damping.ratio = 0.07;
    bw_linear_transient *t = start(context, model, &options, NULL);
    march(context, t, 4);
    for (int64_t i = 0; i < size; i++)
      check_near(t->displacement[i], expected * shape[i], 1e-9 * largest(size, shape));
    bw_release(t);
  }
  bw_release(modes);
  bw_release(model);
}

/* Loads that rise and fall on held and free bodies, one with a support that moves: as integrated
 * directly with short steps. */
static void test_superposed_against_direct(void **state) {
  bw_context *context = check_context(state);
  const bool all[3] = {true, true, true};
  const double y[3] = {2e-6, 0, 1e-6}, force[3] = {500, 200, -1000};
  for (int which = 0; which < 3; which++) { /* free, held, held by a support that moves */
    bw_model *model = bar(context, which == 1, 2);
    bw_selection *end = plane(context, model->mesh, 0, 1),
                 *foot = plane(context, model->mesh, 0, 0);
    check_ok(context, bw_model_force(context, model, end, force));
    if (which == 2)
      check_ok(context, bw_model_prescribe(context, model, foot, all, y));
    bw_modes *modes = lowest(context, model, 25);
    int64_t size = 3 * (int64_t)model->mesh->node_count;
    double *u[2], energy[2];
    const double w = 2 * M_PI * 120, until = 0.01;
    for (int way = 0; way < 2; way++) {
      int steps = way ? 100 : 2000;
      double h = until / steps, load = 0;
      bw_linear_transient_options options = {
          .step = h, .rho = 1, .damping.mass = 30, .modes = way ? modes : NULL};
      double y_of[3] = {0, 0, w * w};
      const bw_transient_factors f = {.load = &load, .support = y_of};
      bw_linear_transient *t = start(context, model, &options, &f);
      for (int k = 1; k <= steps; k++) {
        load = sin(w * h * k) * sin(w * h * k);
        y_of[0] = 1 - cos(w * h * k);
        y_of[1] = w * sin(w * h * k);
        y_of[2] = w * w * cos(w * h * k);
        check_ok(context, bw_linear_transient_step(context, t, &f));
      }
      u[way] = numbers(size);
      memcpy(u[way], t->displacement, (size_t)size * sizeof(double));
      energy[way] = t->kinetic + t->strain;
      check_near(balance(t), 0, (way ? 2e-2 : 2e-3) * (t->work + energy[way]));
      bw_release(t);
    }
    double off = 0, most = largest(size, u[0]);
    for (int64_t i = 0; i < size; i++)
      off = fmax(off, fabs(u[1][i] - u[0][i]));
    assert_true(off < 1e-3 * most);
    check_near(energy[1], energy[0], 5e-3 * energy[0]);
    for (int way = 0; way < 2; way++)
      free(u[way]);
    bw_release(end);
    bw_release(foot);
    bw_release(modes);
    bw_release(model);
  }
}

/* Under a slow load two modes and the static part of the others give the static solution. */
static void test_static_part(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  const double force[3] = {2000, 0, -1000};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_force(context, model, end, force));
  bw_static *rest = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &rest));
  bw_modes *modes = lowest(context, model, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double load = 0;
  const bw_linear_transient_options options = {
      .step = 0.05, .rho = 1, .modes = modes, .damping.ratio = 0.3};
  const bw_transient_factors f = {.load = &load};
  bw_linear_transient *t = start(context, model, &options, &f);
  for (int k = 1; k <= 60; k++) {
    load = fmin(k / 40.0, 1);
    check_ok(context, bw_linear_transient_step(context, t, &f));
  }
  for (int64_t i = 0; i < size; i++)
    check_near(t->displacement[i], rest->displacement[i], 1e-8 * largest(size, rest->displacement));
  bw_release(t);
  bw_release(modes);
  bw_release(rest);
  bw_release(end);
  bw_release(model);
}

/* What two modes leave out of a start is said; a sum of them, and a static solution, are whole. */
static void test_start_left_out(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 2);
  const double force[3] = {2000, 0, -1000};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_force(context, model, end, force));
  bw_static *rest = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &rest));
  bw_modes *modes = lowest(context, model, 2);
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *along = numbers(size);
  for (int64_t i = 0; i < size; i += 3)
    along[i] = 1;
  bw_clear_warnings(context);
  for (int which = 0; which < 3; which++) {
    bw_linear_transient_options options = {.step = 1e-4, .rho = 1, .modes = modes};
    options.displacement = which == 0 ? rest->displacement : NULL;
    options.velocity = which == 1 ? modes->shape : which == 2 ? along : NULL;
    bw_release(start(context, model, &options, NULL));
    const char *warning = bw_warning_at(context, 0);
    if (which < 2)
      assert_null(warning);
    else {
      assert_non_null(warning);
      assert_non_null(strstr(warning, "% of the velocity at the start"));
      assert_true(atof(strstr(warning, "leave out") + 9) > 80);
    }
  }
  free(along);
  bw_release(modes);
  bw_release(rest);
  bw_release(end);
  bw_release(model);
}

static void test_bad_input(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 1);
  bw_linear_transient *t = NULL;
  bw_linear_transient_options options;
  bw_linear_transient_options_default(&options);
#define REFUSED(expected, change)                                                                  \
  do {                                                                                             \
    bw_linear_transient_options bad = options;                                                     \
    bad.step = 1e-4;                                                                               \
    change;                                                                                        \
    assert_int_equal(bw_linear_transient_create(context, model, NULL, &bad, NULL, &t), expected);  \
    assert_null(t);                                                                                \
  } while (0)
  REFUSED(BW_INVALID, bad.step = 0);
  REFUSED(BW_INVALID, bad.step = NAN);
  REFUSED(BW_INVALID, bad.rho = 1.1);
  REFUSED(BW_INVALID, bad.damping.mass = -1);
  REFUSED(BW_UNSUPPORTED, bad.damping.ratio = 0.02);
  REFUSED(BW_UNSUPPORTED, bad.damping.loss = 0.02);
  bw_model *other = bar(context, true, 1), *loose = NULL;
  check_ok(context, bw_model_create(context, model->mesh, model->material, &loose));
  bw_model *more = NULL, *soft = NULL;
  bw_material *weak = NULL;
  const bw_isotropic properties = {
      .name = "weak", .young = 2e9, .poisson = 0.3, .density = 7800, .strength = 4e8};
  bw_selection *foot = plane(context, model->mesh, 0, 0), *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_create(context, model->mesh, model->material, &more));
  check_ok(context, bw_model_fix(context, more, foot));
  check_ok(context, bw_model_fix(context, more, end));
  check_ok(context, bw_material_isotropic(context, &properties, &weak));
  check_ok(context, bw_model_create(context, model->mesh, weak, &soft));
  check_ok(context, bw_model_fix(context, soft, foot));
  bw_modes *of_more = lowest(context, more, 2), *of_soft = lowest(context, soft, 2);
  REFUSED(BW_INVALID, bad.modes = of_more); /* of more supports */
  REFUSED(BW_INVALID, bad.modes = of_soft); /* of another stiffness */
  bw_release(of_more);
  bw_release(of_soft);
  bw_release(more);
  bw_release(soft);
  bw_release(weak);
  bw_release(foot);
  bw_release(end);
  bw_modes *modes = lowest(context, other, 2), *wrong_modes = lowest(context, loose, 2);
  REFUSED(BW_INVALID, bad.modes = modes);       /* of another mesh */
  REFUSED(BW_INVALID, bad.modes = wrong_modes); /* of other supports */
  bw_release(modes);
  modes = lowest(context, model, 2);
  REFUSED(BW_INVALID, (bad.modes = modes, bad.damping.ratio = 1));
  REFUSED(BW_UNSUPPORTED, (bad.modes = modes, bad.damping.loss = 0.1));
  bw_release(modes);
  bw_release(wrong_modes);
  bw_release(other);
  bw_release(loose);
  double *field = numbers(3 * (int64_t)model->mesh->node_count);
  field[4] = INFINITY;
  REFUSED(BW_INVALID, bad.velocity = field);
  const int32_t beyond = 1, below = -1;
  REFUSED(BW_INVALID, bad.support_motion = &beyond);
  REFUSED(BW_INVALID, bad.support_motion = &below);
#undef REFUSED
  for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++)
    field[i] = 1;
  options.step = 1e200;
  options.velocity = field;
  t = start(context, model, &options, NULL);
  assert_int_equal(bw_linear_transient_step(context, t, NULL), BW_INVALID);
  assert_int_equal(t->steps, 0);
  bw_release(t);
  options.velocity = NULL;
  free(field);
  options.step = 1e-4;
  t = start(context, model, &options, NULL);
  const double no_number[3] = {NAN, 0, 0};
  const bw_transient_factors wrong = {.support = no_number};
  assert_int_equal(bw_linear_transient_step(context, t, &wrong), BW_INVALID);
  assert_int_equal(t->steps, 0);
  const double g[3] = {0, 0, -9.81};
  check_ok(context, bw_model_gravity(context, model, g));
  assert_int_equal(bw_linear_transient_step(context, t, NULL), BW_INVALID);
  bw_release(t);
  bw_release(model);
}

static void test_memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = bar(context, true, 1);
  const bw_linear_transient_options options = {.step = 1e-4, .rho = 0.7};
  bw_linear_transient *t = NULL;
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, t,
                    bw_linear_transient_create(context, model, NULL, &options, NULL, &t));
  const bw_linear_transient_options adaptive = {.step = 1e-4, .rho = 0.9, .error = 1e-3};
  bw_model *loose = bar(context, false, 1);
  check_allocations(context, t,
                    bw_linear_transient_create(context, loose, NULL, &adaptive, NULL, &t));
  bw_release(loose);
  bw_modes *modes = lowest(context, model, 2);
  const bw_linear_transient_options superposed = {.step = 1e-4, .modes = modes};
  check_allocations(context, t,
                    bw_linear_transient_create(context, model, NULL, &superposed, NULL, &t));
  const bool all[3] = {true, true, true};
  const double y[3] = {0, 0, 1e-3};
  const int32_t motion[2] = {1, 0};
  bw_selection *end = plane(context, model->mesh, 0, 1);
  check_ok(context, bw_model_prescribe(context, model, end, all, y));
  const bw_linear_transient_options apart = {.step = 1e-4, .support_motion = motion};
  check_allocations(context, t, bw_linear_transient_create(context, model, NULL, &apart, NULL, &t));
  bw_release(end);
  bw_release(modes);
  bw_release(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_mode),
      check_test(test_free_body),
      check_test(test_fall),
      check_test(test_resolution),
      check_test(test_adaptive),
      check_test(test_step_load),
      check_test(test_moving_support),
      check_test(test_superposition),
      check_test(test_superposed_mode),
      check_test(test_superposed_against_direct),
      check_test(test_static_part),
      check_test(test_start_left_out),
      check_test(test_bad_input),
      check_test(test_memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
