/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Responses of a joined model: motions of its remote points, equal bits and failing allocations. */
#include "bodies.h"

#include "barwright/dynamics.h"
#include "barwright/joint.h"
#include "barwright/transient.h"

static const double along[2] = {20, 400}, density[2] = {1, 1};

/* A bar along x that is fixed at x = 0, with a mass on a lever at its other end, and one around. */
static bw_model *loaded(bw_context *context, int order, bw_coupling_kind kind) {
  const double normal[3] = {1, 0, 0}, zero[3] = {0}, end[3] = {0.3, 0, 0};
  bw_mesh *mesh = body_box(context, 0.3, 0.1, 0.05, 3, 1, 1, order);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *held = NULL, *tip = NULL;
  bw_remote_point point = {.kind = kind, .at = {0.4, 0.02, 0.03}, .mass = 2};
  point.load[2] = 10;
  for (int k = 0; k < 3; k++)
    point.inertia[4 * k] = 1e-3 * (k + 1);
  check_ok(context, bw_select_plane(context, mesh, zero, normal, 1e-9, &held));
  check_ok(context, bw_select_plane(context, mesh, end, normal, 1e-9, &tip));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, held));
  check_ok(context, bw_model_couple(context, model, tip, &point));
  check_ok(context, bw_model_attach_mass(context, model, tip, 0.5));
  bw_release(held);
  bw_release(tip);
  bw_release(material);
  bw_release(mesh);
  return model;
}

static bw_harmonic_options ways(void) {
  bw_harmonic_options options;
  bw_harmonic_options_default(&options);
  options.to = 500;
  options.damping.ratio = 0.05;
  options.modes = 4;
  options.base[1] = 3;
  return options;
}

/* The nodes of a rigid face move as its point does. */
static void face_follows_point(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = loaded(context, 2, BW_RIGID);
  const bw_coupling *c = &model->coupling[0];
  bw_harmonic_options options = ways();
  bw_harmonic *h = NULL;
  double q[24], u[12];
  check_ok(context, bw_harmonic_of_model(context, model, NULL, &options, NULL, &h));
  check_ok(context, bw_harmonic_point_curve(context, h, 0, 2, along, q));
  for (int32_t i = 0; i < c->node_count; i++) {
    const double *x = model->mesh->node + 3 * (int64_t)c->node[i];
    check_ok(context, bw_harmonic_curve(context, h, c->node[i], 2, along, u));
    for (int part = 0; part < 4; part++) {
      const double *own = q + 6 * part, *turn = own + 3;
      double r[3], size = 0;
      for (int k = 0; k < 3; k++) {
        r[k] = x[k] - c->point.at[k];
        size = fmax(size, fabs(own[k]));
      }
      for (int k = 0; k < 3; k++)
        check_near(u[3 * part + k],
                   own[k] + turn[(k + 1) % 3] * r[(k + 2) % 3] - turn[(k + 2) % 3] * r[(k + 1) % 3],
                   1e-12 * size);
    }
  }
  bw_release(h);
  bw_release(model);
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 2; kind++) {
    bw_model *model = loaded(context, 2, kind ? BW_DISTRIBUTED : BW_RIGID);
    bw_harmonic_options options = ways();
    double q[2][24], rms[2][6];
    for (int k = 0; k < 2; k++) {
      bw_harmonic *h = NULL;
      check_ok(context, bw_set_threads(context, k ? 3 : 1));
      check_ok(context, bw_harmonic_of_model(context, model, NULL, &options, NULL, &h));
      check_ok(context, bw_harmonic_point_curve(context, h, 0, 2, along, q[k]));
      check_ok(context,
               bw_harmonic_random(context, h, 2, along, density, NULL, NULL, rms[k], NULL));
      bw_release(h);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(rms[0], rms[1], sizeof rms[0]);
    bw_release(model);
  }
}

static bw_modes *lowest(bw_context *context, const bw_model *model) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = 4;
  check_ok(context, bw_joined_modes(context, model, &options, &modes));
  return modes;
}

static void same_bits_in_time(void **state) {
  bw_context *context = check_context(state);
  for (int way = 0; way < 4; way++) { /* both kinds, by modes and directly in steps that adapt */
    bw_model *model = loaded(context, 2, way % 2 ? BW_DISTRIBUTED : BW_RIGID);
    bw_modes *modes = lowest(context, model);
    const double half = 0.5;
    const bw_transient_factors start = {.point = &half};
    bw_linear_transient_options options;
    bw_linear_transient_options_default(&options);
    options.step = 1e-3;
    if (way < 2) {
      options.modes = modes;
      options.damping.ratio = 0.01;
    } else {
      options.error = 1e-3;
      options.damping.stiffness = 1e-5;
    }
    bw_linear_transient *t[2] = {NULL, NULL};
    size_t bytes = 3 * (size_t)model->mesh->node_count * sizeof(double);
    for (int k = 0; k < 2; k++) {
      check_ok(context, bw_set_threads(context, k ? 3 : 1));
      check_ok(context, bw_linear_transient_create(context, model, NULL, &options, &start, &t[k]));
      for (int i = 0; i < 5; i++)
        check_ok(context, bw_linear_transient_step(context, t[k], NULL));
    }
    assert_true(t[0]->kinetic > 0 && t[0]->strain > 0);
    assert_memory_equal(t[0]->displacement, t[1]->displacement, bytes);
    assert_memory_equal(t[0]->acceleration, t[1]->acceleration, bytes);
    assert_memory_equal(t[0]->reaction, t[1]->reaction, bytes);
    assert_memory_equal(&t[0]->work, &t[1]->work, sizeof(double));
    const double wrong = NAN;
    assert_int_equal(
        bw_linear_transient_step(context, t[0], &(bw_transient_factors){.point = &wrong}),
        BW_INVALID);
    bw_release(t[0]);
    bw_release(t[1]);
    bw_release(modes);
    bw_release(model);
  }
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_model *model = loaded(context, 1, BW_DISTRIBUTED);
  bw_harmonic_options options = ways();
  bw_response_spectrum_options spectrum;
  const double points[2] = {1, 1e5}, size[2] = {1, 1};
  bw_harmonic *h = NULL;
  bw_response_spectrum *r = NULL;
  double q[24];
  void *none = NULL;
  bw_response_spectrum_options_default(&spectrum);
  spectrum.count = 2;
  spectrum.frequency = points;
  spectrum.acceleration = size;
  spectrum.direction[1] = 1;
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, h, bw_harmonic_of_model(context, model, NULL, &options, NULL, &h));
  check_allocations(context, r,
                    bw_response_spectrum_of_model(context, model, NULL, &spectrum, NULL, &r));
  check_ok(context, bw_harmonic_of_model(context, model, NULL, &options, NULL, &h));
  check_allocations(context, none, bw_harmonic_point_curve(context, h, 0, 2, along, q));
  check_allocations(context, none,
                    bw_harmonic_random(context, h, 2, along, density, NULL, NULL, q, NULL));
  bw_release(h);
  bw_modes *modes = lowest(context, model);
  double *velocity = calloc(3 * (size_t)model->mesh->node_count, sizeof *velocity);
  assert_non_null(velocity);
  for (int way = 0; way < 2; way++) { /* by modes, and directly from a start */
    bw_linear_transient_options chosen = {.step = 1e-3, .modes = way ? NULL : modes, .rho = 0.9};
    bw_linear_transient *t = NULL;
    bw_static *now = NULL;
    chosen.velocity = way ? velocity : NULL;
    check_allocations(context, t,
                      bw_linear_transient_create(context, model, NULL, &chosen, NULL, &t));
    check_ok(context, bw_linear_transient_create(context, model, NULL, &chosen, NULL, &t));
    check_allocations(context, none, bw_linear_transient_step(context, t, NULL));
    check_allocations(context, now, bw_linear_transient_static(context, t, &now));
    bw_release(t);
  }
  free(velocity);
  bw_release(modes);
  bw_release(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(face_follows_point), check_test(same_bits),
                                     check_test(same_bits_in_time), check_test(memory_failures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
