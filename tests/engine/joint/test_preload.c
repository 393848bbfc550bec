/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preloads across bonds: a bolt and a flange as two bars in parallel, and what is refused. */
#include "pair.h"

#include "barwright/joint.h"

/* A bolt of two halves and a flange beside it, along z, on the ground; a point pulls both. Without
 * Poisson's effect all is uniaxial and exact. */
static const double young = 200e9, length = 0.1, bolt_area = 0.02 * 0.02, flange_area = 0.03 * 0.05;

typedef struct joint {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  bw_selection *lower, *upper, *ground, *top;
} joint;

static joint make_joint(bw_context *context, int order) {
  joint j = {0};
  const double half[3] = {0, 0, length / 2}, beside[3] = {0.1, 0, 0};
  const bw_isotropic constants = {.name = "straight", .young = young, .density = 7800};
  bw_mesh *bolt = pair(context, body_box(context, 0.02, 0.02, length / 2, 1, 1, 2, order),
                       body_box(context, 0.02, 0.02, length / 2, 2, 3, 1, order), half);
  j.mesh = pair(context, bolt, body_box(context, 0.03, 0.05, length, 1, 2, 3, order), beside);
  check_ok(context, bw_material_isotropic(context, &constants, &j.material));
  check_ok(context, bw_model_create(context, j.mesh, j.material, &j.model));
  j.lower = face(context, j.mesh, 0, 2, length / 2);
  j.upper = face(context, j.mesh, 1, 2, length / 2);
  j.ground = face(context, j.mesh, -1, 2, 0);
  j.top = face(context, j.mesh, -1, 2, length);
  check_ok(context, bw_model_fix(context, j.model, j.ground));
  return j;
}

static void close_joint(joint *j) {
  bw_release(j->lower);
  bw_release(j->upper);
  bw_release(j->ground);
  bw_release(j->top);
  bw_release(j->model);
  bw_release(j->material);
  bw_release(j->mesh);
}

static bw_static *solve(bw_context *context, joint *j, bool upper_follows, bw_preload_kind kind,
                        double pull, double load) {
  bw_static *result = NULL;
  bw_remote_point point = {.kind = BW_RIGID,
                           .at = {0, 0, length},
                           .load = {0, 0, load},
                           .fixed = {true, true, false, true, true, true}};
  bw_model_clear_bonds(j->model);
  check_ok(context, bw_model_clear_couplings(context, j->model));
  check_ok(context, bw_model_couple(context, j->model, j->top, &point));
  check_ok(context, bw_model_preload(context, j->model, upper_follows ? j->upper : j->lower,
                                     upper_follows ? j->lower : j->upper, -1, kind, pull));
  check_ok(context, bw_joined_statics(context, j->model, NULL, &result));
  return result;
}

/* Forces that the ground exerts on a body along z. */
static double held(const joint *j, const bw_static *result, int body) {
  double sum = 0;
  for (int32_t i = 0; i < j->mesh->node_count; i++)
    sum += j->mesh->component[i] == body ? result->reaction[3 * i + 2] : 0;
  return sum;
}

static void load_follows_stiffness(void **state) {
  bw_context *context = check_context(state);
  const double preload = 2e4, load = 7e3;
  double bolt = young * bolt_area / length, flange = young * flange_area / length;
  for (int variant = 0; variant < 4; variant++) {
    joint j = make_joint(context, 1 + variant / 2);
    bool upper_follows = variant % 2;
    bw_static *result = solve(context, &j, upper_follows, BW_PRELOAD_FORCE, preload, 0);
    double shortening = preload * (1 / bolt + 1 / flange);
    check_near(result->bond[0].preload, preload, 1e-10 * preload);
    check_near(result->bond[0].shortening, shortening, 1e-9 * shortening);
    check_near(result->coupling[0].displacement[2], -preload / flange, 1e-9 * preload / flange);
    check_near(held(&j, result, 0), -preload, 1e-9 * preload);
    check_near(held(&j, result, 2), preload, 1e-9 * preload);
    shortening = result->bond[0].shortening;
    bw_release(result);
    /* the same, by its shortening; then further load shares as the stiffnesses say */
    for (int loaded = 0; loaded < 2; loaded++) {
      double force = preload + loaded * load * bolt / (bolt + flange);
      result = solve(context, &j, upper_follows, BW_PRELOAD_SHORTENING, shortening, loaded * load);
      check_near(result->bond[0].preload, force, 1e-9 * force);
      check_near(result->bond[0].shortening, shortening, 1e-9 * shortening);
      check_near(held(&j, result, 0), -force, 1e-9 * force);
      bw_release(result);
    }
    /* a given preload stays whatever acts: the flange takes the load alone */
    result = solve(context, &j, upper_follows, BW_PRELOAD_FORCE, preload, load);
    check_near(result->bond[0].preload, preload, 1e-9 * preload);
    check_near(result->coupling[0].displacement[2], (load - preload) / flange,
               1e-9 * preload / flange);
    bw_release(result);
    close_joint(&j);
  }
}

/* Vibrations are those of the joint as it was tightened: a preload changes no frequency. */
static void modes_are_those_of_the_bond(void **state) {
  bw_context *context = check_context(state);
  joint j = make_joint(context, 1);
  bw_modes *modes[2] = {0};
  for (int pulled = 0; pulled < 2; pulled++) {
    bw_model_clear_bonds(j.model);
    check_ok(context,
             bw_model_preload(context, j.model, j.upper, j.lower, -1,
                              pulled ? BW_PRELOAD_FORCE : BW_NO_PRELOAD, pulled ? 1e4 : 0));
    check_ok(context, bw_joined_modes(context, j.model, NULL, &modes[pulled]));
  }
  assert_int_equal(modes[1]->rigid_count, 0);
  for (int i = 0; i < modes[0]->count; i++)
    check_near(modes[0]->frequency[i], modes[1]->frequency[i], 1e-9 * modes[0]->frequency[i]);
  bw_release(modes[0]);
  bw_release(modes[1]);
  close_joint(&j);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  joint j = make_joint(context, 1);
  bw_static *result = NULL;
  bw_selection *whole = NULL, *body = NULL;
  check_fails(context, BW_INVALID, "preload of a bond",
              bw_model_preload(context, j.model, j.upper, j.lower, -1, BW_PRELOAD_FORCE, NAN));
  /* nothing holds the head against the pull */
  check_ok(context,
           bw_model_preload(context, j.model, j.upper, j.lower, -1, BW_PRELOAD_FORCE, 1e4));
  check_fails(context, BW_UNCONSTRAINED, "1 rigid-body mode",
              bw_joined_statics(context, j.model, NULL, &result));
  /* supports at all nodes of the section */
  check_ok(context, bw_model_fix(context, j.model, j.upper));
  check_fails(context, BW_INVALID, "supports hold all",
              bw_joined_statics(context, j.model, NULL, &result));
  check_ok(context, bw_select_all(context, j.mesh, &whole));
  check_ok(context, bw_select_combine(context, whole, j.lower, BW_DIFFERENCE, &body));
  check_fails(context, BW_GEOMETRY, "not plane",
              bw_model_preload(context, j.model, body, j.lower, -1, BW_PRELOAD_FORCE, 1));
  bw_release(whole);
  bw_release(body);
  close_joint(&j);
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  joint j = make_joint(context, 1);
  bw_static *result = solve(context, &j, true, BW_PRELOAD_FORCE, 1e4, 0);
  bw_release(result);
  result = NULL;
  check_allocations(context, result, bw_joined_statics(context, j.model, NULL, &result));
  close_joint(&j);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(load_follows_stiffness),
      check_test(modes_are_those_of_the_bond),
      check_test(refuses),
      check_test(memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
