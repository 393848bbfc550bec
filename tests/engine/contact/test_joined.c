/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact beside joints: a bolt with a preload and a flange that may open are bars in parallel,
 * with bonds of meshes that do not match. tests/lua/contact_joined_spec.lua has more. */
#include "../joint/pair.h"

#include "barwright/contact.h"

static const double young = 200e9, length = 0.1, bolt_area = 0.02 * 0.02, flange_area = 0.03 * 0.05;

/* A bolt of two halves and a flange of two beside it, along z, on the ground. */
typedef struct joint {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  bw_selection *lower, *upper, *ground, *top;
  bw_contact_pair pair;
} joint;

static joint make_joint(bw_context *context, int order) {
  joint j = {0};
  const double half[3] = {0, 0, length / 2}, beside[3] = {0.1, 0, 0};
  const bw_isotropic constants = {.name = "straight", .young = young, .density = 7800};
  bw_mesh *bolt = pair(context, body_box(context, 0.02, 0.02, length / 2, 1, 1, 2, order),
                       body_box(context, 0.02, 0.02, length / 2, 2, 3, 1, order), half);
  bw_mesh *flange = pair(context, body_box(context, 0.03, 0.05, length / 2, 2, 2, 2, order),
                         body_box(context, 0.03, 0.05, length / 2, 2, 2, 2, order), half);
  j.mesh = pair(context, bolt, flange, beside);
  check_ok(context, bw_material_isotropic(context, &constants, &j.material));
  check_ok(context, bw_model_create(context, j.mesh, j.material, &j.model));
  j.lower = face(context, j.mesh, 0, 2, length / 2);
  j.upper = face(context, j.mesh, 1, 2, length / 2);
  j.pair.against = face(context, j.mesh, 2, 2, length / 2);
  j.pair.on = face(context, j.mesh, 3, 2, length / 2);
  j.ground = face(context, j.mesh, -1, 2, 0);
  j.top = face(context, j.mesh, -1, 2, length);
  check_ok(context, bw_model_fix(context, j.model, j.ground));
  return j;
}

static void close_joint(joint *j) {
  bw_release(j->lower);
  bw_release(j->upper);
  bw_release((void *)j->pair.against);
  bw_release((void *)j->pair.on);
  bw_release(j->ground);
  bw_release(j->top);
  bw_release(j->model);
  bw_release(j->material);
  bw_release(j->mesh);
}

static void set(bw_context *context, joint *j, bw_preload_kind kind, double pull, double load) {
  bw_remote_point point = {.kind = BW_RIGID,
                           .at = {0, 0, length},
                           .load = {0, 0, load},
                           .fixed = {true, true, false, true, true, true}};
  bw_model_clear_bonds(j->model);
  check_ok(context, bw_model_clear_couplings(context, j->model));
  check_ok(context, bw_model_couple(context, j->model, j->top, &point));
  check_ok(context, bw_model_preload(context, j->model, j->lower, j->upper, -1, kind, pull));
}

static bw_contact *solve(bw_context *context, joint *j) {
  bw_contact *contact = NULL;
  check_ok(context, bw_contact_solve(context, j->model, 1, &j->pair, NULL, NULL, &contact));
  return contact;
}

static void bars_in_parallel(void **state) {
  bw_context *context = check_context(state);
  const double tight = 2e4, share = bolt_area / (bolt_area + flange_area);
  for (int variant = 0; variant < 4; variant++) {
    joint j = make_joint(context, 1 + variant / 2);
    j.pair.friction = variant % 2 ? 0.3 : 0;
    set(context, &j, BW_PRELOAD_FORCE, tight, 0);
    bw_contact *contact = solve(context, &j);
    double shortening = contact->solution->bond[0].shortening;
    check_near(shortening, tight * length / young * (1 / bolt_area + 1 / flange_area),
               1e-8 * shortening);
    check_near(contact->solution->coupling[0].displacement[2],
               -tight * length / young / flange_area, 1e-8 * shortening);
    check_near(contact->state[0].pressure, tight / flange_area, 1e-8 * tight / flange_area);
    bw_release(contact);
    for (int i = 0; i < 4; i++) {
      double load = (double[]){-0.5, 0.5, 0.99, 1.01}[i] * tight / (1 - share);
      double force = i < 3 ? tight + share * load : load;
      set(context, &j, BW_PRELOAD_SHORTENING, shortening, load);
      contact = solve(context, &j);
      check_near(contact->solution->bond[0].preload, force, 1e-8 * force);
      check_near(contact->state[0].force[2], force - load, 1e-8 * force);
      assert_int_equal(contact->state[0].active > 0, i < 3);
      bw_release(contact);
    }
    close_joint(&j);
  }
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  joint j = make_joint(context, 1);
  bw_contact *contact = NULL;
  j.pair.friction = 0.3;
  set(context, &j, BW_PRELOAD_FORCE, 2e4, 0);
  check_allocations(context, contact,
                    bw_contact_solve(context, j.model, 1, &j.pair, NULL, NULL, &contact));
  close_joint(&j);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(bars_in_parallel), check_test(memory_failures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
