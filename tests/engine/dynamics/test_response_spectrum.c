/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Response spectra against single modes, static solutions and sums written out. */
#include "bodies.h"

#include "barwright/analysis.h"
#include "barwright/dynamics.h"
#include "barwright/statics.h"

static bw_model *cantilever(bw_context *context, bw_mesh *mesh) {
  const double origin[3] = {0, 0, 0}, axis[3] = {1, 0, 0};
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *held = NULL;
  check_ok(context, bw_select_plane(context, mesh, origin, axis, 1e-9, &held));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_model_fix(context, model, held));
  bw_release(held);
  bw_release(material);
  return model;
}

static bw_response_spectrum *shaken(bw_context *context, const bw_model *model,
                                    const bw_response_spectrum_options *options) {
  bw_response_spectrum *r = NULL;
  check_ok(context, bw_response_spectrum_of_model(context, model, NULL, options, NULL, &r));
  return r;
}

/* Where the points end behind the first mode its response is the spectrum's, straight on
 * logarithmic axes; where they end before it the response is the static one. */
static void single_mode_and_rigid(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.04, 6, 1, 1, 2);
  bw_model *model = cantilever(context, mesh), *heavy = cantilever(context, mesh);
  bw_modes *modes = NULL;
  check_ok(context, bw_modes_of_model(context, model, NULL, NULL, NULL, &modes));
  double f = modes->frequency[0], last = (f + modes->frequency[1]) / 2;
  const double at[2] = {f / 4, last}, acceleration[2] = {3, 12};
  int64_t size = 3 * (int64_t)mesh->node_count;
  double *stress = numbers(2 * size), largest = 0;
  bw_response_spectrum_options options;
  bw_response_spectrum_options_default(&options);
  options.count = 2;
  options.frequency = at;
  options.acceleration = acceleration;
  options.direction[2] = -7;
  options.missing_mass = false;
  bw_response_spectrum *r = shaken(context, model, &options);
  assert_int_equal(r->count, 1);
  assert_null(bw_warning_at(context, 0));
  assert_true(r->modes->counted && r->base == 0);
  double expected = 3 * exp(log(4) * log(4) / log(4 * last / f));
  check_near(r->acceleration[0], expected, 1e-9 * expected);
  check_near(r->effective_mass[0] / r->mass, 0.613, 0.02); /* of the first mode of a cantilever */
  check_near(r->mass, 0.3 * 0.05 * 0.04 * 7800, 1e-9 * r->mass);
  check_near(r->missing_mass, r->mass - r->effective_mass[0], 1e-12);
  check_near(r->base_force[2], r->effective_mass[0] * expected, 1e-9 * r->base_force[2]);
  double scale = fabs(r->participation[0]) * expected / modes->eigenvalue[0];
  for (int64_t i = 0; i < size; i++)
    largest = fmax(largest, r->displacement[i]);
  for (int64_t i = 0; i < size; i++)
    check_near(r->displacement[i], fabs(scale * modes->shape[i]), 1e-6 * largest);
  options.modes = modes; /* given ones */
  bw_response_spectrum *again = shaken(context, model, &options);
  assert_ptr_equal(again->modes, modes);
  assert_int_equal(again->count, 1);
  for (int64_t i = 0; i < size; i++)
    check_near(again->displacement[i], r->displacement[i], 1e-6 * largest);
  bw_release(again);
  options.modes = NULL;
  check_ok(context, bw_nodal_stress(context, mesh, model->material, modes->shape, stress));
  for (int32_t i = 0; i < mesh->node_count; i++)
    check_near(r->von_mises[i], scale * bw_von_mises(stress + 6 * i), 1e-5 * (1 + r->von_mises[i]));
  bw_release(r);

  const double before[2] = {1, f / 2}, gravity[3] = {0, 0, 12};
  bw_static *solution = NULL;
  options.frequency = before;
  options.missing_mass = true;
  check_ok(context, bw_model_gravity(context, heavy, gravity));
  check_ok(context, bw_statics(context, heavy, NULL, NULL, &solution));
  for (int which = BW_CQC; which <= BW_ABSOLUTE; which++) {
    options.combination = (bw_combination)which;
    r = shaken(context, model, &options);
    assert_int_equal(r->count, 0);
    assert_non_null(bw_warning_at(context, 0));
    assert_non_null(strstr(bw_warning_at(context, 0), "static one under the 12 m/s2"));
    largest = 0;
    for (int64_t i = 0; i < size; i++)
      largest = fmax(largest, r->displacement[i]);
    for (int64_t i = 0; i < size; i++)
      check_near(r->displacement[i], fabs(solution->displacement[i]), 1e-8 * largest);
    check_ok(context, bw_static_stress(context, solution, true, stress));
    for (int32_t i = 0; i < mesh->node_count; i++)
      check_near(r->von_mises[i], bw_von_mises(stress + 6 * i), 1e-6 * (1e3 + r->von_mises[i]));
    check_near(r->base_force[2], 12 * r->mass, 1e-9 * r->base_force[2]);
    check_near(r->missing_mass, r->mass, 1e-12 * r->mass);
    bw_release(r);
  }
  bw_clear_warnings(context);
  options.missing_mass = false;
  r = shaken(context, model, &options);
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "the response is 0"));
  assert_true(r->base_force[2] == 0);
  bw_release(r);
  free(stress);
  bw_release(solution);
  bw_release(modes);
  bw_release(model);
  bw_release(heavy);
  bw_release(mesh);
}

/* Where two materials meet the larger stress counts, as of a base that shakes slowly. */
static void two_materials(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.04, 6, 1, 1, 2);
  bw_model *one = cantilever(context, mesh), *mixed = NULL;
  bw_material *soft = NULL, *all = NULL, *hard = body_material(context);
  int32_t *of = (int32_t *)calloc((size_t)mesh->element_count, sizeof *of);
  double *mises = numbers(mesh->node_count);
  const double at[2] = {1, 2}, acceleration[2] = {12, 12}, slow = 0.1;
  check_ok(context, bw_material_named(context, "pla", &soft));
  const bw_material *part[2] = {hard, soft};
  for (int64_t e = 0; e < mesh->element_count; e++)
    of[e] = e % 5 == 0;
  check_ok(context, bw_material_by_element(context, mesh->element_count, 2, of, part, &all));
  check_ok(context, bw_model_create(context, mesh, all, &mixed));
  check_ok(context, bw_model_fix(context, mixed, one->support[0].on));
  bw_response_spectrum_options options;
  bw_response_spectrum_options_default(&options);
  options.count = 2;
  options.frequency = at;
  options.acceleration = acceleration;
  options.direction[2] = 1;
  bw_response_spectrum *r = shaken(context, mixed, &options);
  assert_int_equal(r->count, 0);
  bw_harmonic_options harmonic;
  bw_harmonic_options_default(&harmonic);
  harmonic.frequency_count = 1;
  harmonic.frequency = &slow;
  harmonic.base[2] = 12;
  bw_harmonic *h = NULL;
  check_ok(context, bw_harmonic_of_model(context, mixed, NULL, &harmonic, NULL, &h));
  check_ok(context, bw_harmonic_stress(context, h, slow, NULL, NULL, mises));
  for (int32_t i = 0; i < mesh->node_count; i++)
    check_near(r->von_mises[i], mises[i], 1e-4 * mises[i]);
  free(of);
  free(mises);
  bw_release(h);
  bw_release(r);
  bw_release(mixed);
  bw_release(one);
  bw_release(all);
  bw_release(soft);
  bw_release(hard);
  bw_release(mesh);
}

/* Sums written out, on any number of threads. All modes together have the mass, and the magnitudes
 * bound the other combinations. */
static void combinations(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.048, 6, 1, 1, 2);
  bw_model *model = cantilever(context, mesh);
  const double at[4] = {50, 400, 2000, 9000}, acceleration[4] = {2, 30, 20, 5};
  double z = 0.05, *found[3];
  int64_t size = 3 * (int64_t)mesh->node_count;
  bw_response_spectrum_options options;
  bw_response_spectrum_options_default(&options);
  options.count = 4;
  options.frequency = at;
  options.acceleration = acceleration;
  options.direction[0] = 0.2;
  options.direction[1] = 1;
  options.direction[2] = 0.7;
  options.missing_mass = false;
  for (int which = BW_CQC; which <= BW_ABSOLUTE; which++) {
    options.combination = (bw_combination)which;
    check_ok(context, bw_set_threads(context, 1));
    bw_response_spectrum *r = shaken(context, model, &options);
    check_ok(context, bw_set_threads(context, 3));
    bw_response_spectrum *again = shaken(context, model, &options);
    assert_memory_equal(r->von_mises, again->von_mises, (size_t)mesh->node_count * sizeof(double));
    bw_release(again);
    assert_true(r->count >= 6);
    double left = r->mass, largest = 0;
    for (int k = 0; k < r->count; k++) {
      left -= r->effective_mass[k];
      assert_true(r->effective_mass[k] >= 0);
    }
    check_near(left, r->missing_mass, 1e-9 * r->mass);
    assert_true(left > 0 && left < 0.4 * r->mass);
    for (int64_t i = 0; i < size; i++)
      largest = fmax(largest, r->displacement[i]);
    for (int64_t i = 0; i < size; i++) {
      double sum = 0;
      for (int a = 0; a < r->count; a++)
        for (int b = 0; b < r->count; b++) {
          double own[2];
          for (int j = 0; j < 2; j++) {
            int k = j ? b : a;
            own[j] = r->participation[k] * r->acceleration[k] / r->modes->eigenvalue[k] *
                     r->modes->shape[k * size + i];
          }
          double x = r->modes->frequency[a] / r->modes->frequency[b];
          double rho = 8 * z * z * (1 + x) * pow(x, 1.5) /
                       (pow(1 - x * x, 2) + 4 * z * z * x * pow(1 + x, 2));
          if (which == BW_CQC)
            sum += rho * own[0] * own[1];
          else if (a == b)
            sum += which == BW_SRSS ? own[0] * own[0] : fabs(own[0]);
        }
      check_near(r->displacement[i], which == BW_ABSOLUTE ? sum : sqrt(fmax(sum, 0)),
                 1e-9 * largest);
    }
    found[which] = numbers(mesh->node_count);
    memcpy(found[which], r->von_mises, (size_t)mesh->node_count * sizeof(double));
    bw_release(r);
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    assert_true(found[BW_SRSS][i] <= found[BW_ABSOLUTE][i] * (1 + 1e-12) &&
                found[BW_CQC][i] <= found[BW_ABSOLUTE][i] * (1 + 1e-12));
  /* with little damping the modes are far apart */
  options.combination = BW_CQC;
  options.ratio = z = 1e-5;
  bw_response_spectrum *r = shaken(context, model, &options);
  for (int32_t i = 0; i < mesh->node_count; i++)
    check_near(r->von_mises[i], found[BW_SRSS][i], 1e-3 * (1 + found[BW_SRSS][i]));
  bw_release(r);
  for (int which = 0; which < 3; which++)
    free(found[which]);
  bw_release(model);
  bw_release(mesh);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.05, 0.04, 2, 1, 1, 1);
  bw_model *model = cantilever(context, mesh), *free_model = NULL;
  bw_response_spectrum *r = NULL;
  double at[2] = {10, 5000}, acceleration[2] = {1, 1};
  bw_response_spectrum_options options, good;
  bw_response_spectrum_options_default(&good);
  good.count = 2;
  good.frequency = at;
  good.acceleration = acceleration;
  good.direction[0] = 1;
#define REFUSED(what, expected)                                                                    \
  options = good;                                                                                  \
  options.what;                                                                                    \
  assert_int_equal(bw_response_spectrum_of_model(context, model, NULL, &options, NULL, &r),        \
                   BW_INVALID);                                                                    \
  assert_non_null(strstr(bw_message(context), expected))
  REFUSED(count = 1, "2 points or more");
  REFUSED(direction[0] = 0, "no length");
  REFUSED(ratio = 0, "damping ratio");
  at[1] = 5;
  REFUSED(count = 2, "must ascend");
  at[1] = 5000;
  acceleration[0] = 0;
  REFUSED(count = 2, "above 0");
  acceleration[0] = 1;
  at[0] = 4000;
  REFUSED(count = 2, "below the first point");
  at[0] = 10;
  bw_material *material = body_material(context);
  check_ok(context, bw_model_create(context, mesh, material, &free_model));
  assert_int_equal(bw_response_spectrum_of_model(context, free_model, NULL, &good, NULL, &r),
                   BW_UNCONSTRAINED);
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, r,
                    bw_response_spectrum_of_model(context, model, NULL, &good, NULL, &r));
  bw_release(material);
  bw_release(free_model);
  bw_release(model);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(single_mode_and_rigid), check_test(two_materials),
                                     check_test(combinations), check_test(refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
