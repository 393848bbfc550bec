/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions against closed forms. */
#include "bodies.h"

/* A bar in tension on three sliding planes: displacement linear, exact to rounding. */
static void bar_in_tension(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 0.4, 0.1, 0.1, 8, 2, 2, order);
    bw_material *material = body_material(context);
    bw_model *model = NULL;
    bw_selection *face[4] = {NULL};
    const double normal[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0, 0, 0},
                 far[3] = {0.4, 0, 0}, traction[3] = {1e6, 0, 0};
    check_ok(context, bw_model_create(context, mesh, material, &model));
    for (int c = 0; c < 3; c++) {
      check_ok(context, bw_select_plane(context, mesh, origin, normal[c], 1e-9, &face[c]));
      check_ok(context, bw_model_slide(context, model, face[c], normal[c]));
    }
    check_ok(context, bw_select_plane(context, mesh, far, normal[0], 1e-9, &face[3]));
    check_ok(context, bw_model_traction(context, model, face[3], traction));
    bw_static *result = NULL;
    check_ok(context, bw_statics(context, model, NULL, NULL, &result));
    double strain = 1e6 / material->young[0], reaction = 0;
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *x = mesh->node + 3 * i, *u = result->displacement + 3 * i;
      check_near(u[0], strain * x[0], 1e-10 * strain);
      check_near(u[1], -material->poisson[0] * strain * x[1], 1e-10 * strain);
      reaction += result->reaction[3 * i];
    }
    check_near(reaction, -1e6 * 0.01, 1e-6);
    check_near(result->energy, 0.5 * 1e6 * strain * 0.4 * 0.01, 1e-9);
    assert_true(result->residual < 1e-9);
    for (int c = 0; c < 4; c++)
      bw_release(face[c]);
    bw_release(result);
    bw_release(model);
    bw_release(material);
    bw_release(mesh);
  }
}

/* A bar hanging on an oblique axis from a slide across its end, with its own weight along it:
 * without contraction (nu = 0) u = rho g (L s - s^2/2) / E along the axis, exact for tet10. */
static void bar_under_own_weight(void **state) {
  bw_context *context = check_context(state);
  const double length = 2, g = 9.81, turn = 0.6;
  const double axis[3] = {cos(turn), sin(turn), 0}, side[3] = {-sin(turn), cos(turn), 0};
  bw_mesh *straight = body_box(context, length, 0.2, 0.2, 6, 1, 1, 2), *mesh = NULL;
  double *x = numbers(3 * (int64_t)straight->node_count);
  for (int32_t i = 0; i < straight->node_count; i++)
    for (int c = 0; c < 3; c++)
      x[3 * i + c] = straight->node[3 * i] * axis[c] + straight->node[3 * i + 1] * side[c] +
                     (c == 2 ? straight->node[3 * i + 2] : 0);
  check_ok(context, bw_mesh_moved(context, straight, x, &mesh));
  const bw_isotropic constants = {.name = "cork", .young = 1e7, .poisson = 0, .density = 200};
  bw_material *material = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  bw_model *model = NULL;
  bw_selection *face[3] = {NULL};
  const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
  const double gravity[3] = {g * axis[0], g * axis[1], 0};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  const double *normal[3] = {axis, side, up};
  for (int c = 0; c < 3; c++) {
    check_ok(context, bw_select_plane(context, mesh, origin, normal[c], 1e-9, &face[c]));
    check_ok(context, bw_model_slide(context, model, face[c], normal[c]));
  }
  check_ok(context, bw_model_gravity(context, model, gravity));
  bw_static *result = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  double pull = 200 * g / 1e7, total[3] = {0, 0, 0};
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double s = straight->node[3 * i], u = pull * (length * s - s * s / 2);
    for (int c = 0; c < 3; c++) {
      check_near(result->displacement[3 * i + c], u * axis[c], 1e-9 * pull);
      total[c] += result->reaction[3 * i + c];
    }
  }
  for (int c = 0; c < 3; c++)
    check_near(total[c], -200 * g * length * 0.04 * axis[c], 1e-7);
  for (int c = 0; c < 3; c++)
    bw_release(face[c]);
  free(x);
  bw_release(result);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(straight);
}

/* Prescribed ends stretch a bar; nothing else loads it. */
static void prescribed_stretch(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.1, 0.1, 8, 1, 1, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *left = NULL, *right = NULL;
  const double normal[3] = {1, 0, 0}, origin[3] = {0, 0, 0}, far[3] = {1, 0, 0};
  const bool fixed[3] = {true, true, true};
  const double value[3] = {1e-3, 0, 0};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, normal, 1e-9, &left));
  check_ok(context, bw_select_plane(context, mesh, far, normal, 1e-9, &right));
  check_ok(context, bw_model_fix(context, model, left));
  check_ok(context, bw_model_prescribe(context, model, right, fixed, value));
  bw_static *result = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  double pull[2] = {0, 0};
  for (int32_t i = 0; i < mesh->node_count; i++) {
    if (mesh->node[3 * i] > 1 - 1e-9)
      check_near(result->displacement[3 * i], 1e-3, 1e-18);
    pull[mesh->node[3 * i] > 0.5] += result->reaction[3 * i];
  }
  check_near(pull[0], -pull[1], 1e-4);
  /* work of the prescribed motion is twice the energy */
  check_near(result->energy, 0.5 * pull[1] * 1e-3, 1e-6 * result->energy);
  assert_true(pull[1] > 2e11 * 1e-3 * 0.01);
  /* the same equations serve another motion of the same ends */
  bw_static *other = NULL;
  bw_model_clear_supports(model);
  check_ok(context, bw_model_fix(context, model, left));
  check_ok(context, bw_model_prescribe(context, model, right, fixed, (double[3]){-3e-3, 1e-3, 0}));
  check_ok(context, bw_statics(context, model, result->system, NULL, &other));
  assert_ptr_equal(other->system, result->system);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (mesh->node[3 * i] > 1 - 1e-9) {
      check_near(other->displacement[3 * i], -3e-3, 1e-18);
      check_near(other->displacement[3 * i + 1], 1e-3, 1e-18);
    }
  bw_release(other);
  bw_release(result);
  bw_release(left);
  bw_release(right);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* A free body: an unbalanced load is refused and the motion named; inertia relief accepts it; a
 * balanced one leaves no trace of the pins. */
static void free_bodies(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.2, 0.2, 10, 2, 2, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *left = NULL, *right = NULL;
  const double normal[3] = {1, 0, 0}, origin[3] = {0, 0, 0}, far[3] = {1, 0, 0};
  const double pull[3] = {1e6, 0, 0}, push[3] = {-1e6, 0, 0};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, normal, 1e-9, &left));
  check_ok(context, bw_select_plane(context, mesh, far, normal, 1e-9, &right));
  check_ok(context, bw_model_traction(context, model, right, pull));
  bw_static *result = NULL, *relieved = NULL;
  check_fails(context, BW_UNCONSTRAINED, "translation",
              bw_statics(context, model, NULL, NULL, &result));
  const bw_statics_options relief = {.inertia_relief = true};
  check_ok(context, bw_statics(context, model, NULL, &relief, &relieved));
  assert_true(relieved->residual < 1e-9);
  check_ok(context, bw_model_traction(context, model, left, push));
  check_ok(context, bw_statics(context, model, relieved->system, NULL, &result));
  assert_ptr_equal(result->system, relieved->system);
  double strain = 1e6 / material->young[0];
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i, *u = result->displacement + 3 * i;
    check_near(u[0], strain * (x[0] - 0.5), 1e-10 * strain);
    check_near(u[1], -0.3 * strain * (x[1] - 0.1), 1e-10 * strain);
    check_near(u[2], -0.3 * strain * (x[2] - 0.1), 1e-10 * strain);
    for (int c = 0; c < 3; c++)
      assert_true(result->reaction[3 * i + c] == 0);
  }
  bw_release(result);
  bw_release(relieved);
  bw_release(left);
  bw_release(right);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* Two cubes that touch in one corner are constrained at one of them: a mechanism. */
static void mechanism_is_refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = body_box(context, 1, 1, 1, 2, 2, 2, 1), *mesh = NULL;
  int32_t n = one->node_count, m = one->element_count, corner = -1;
  double *x = numbers(6 * (int64_t)n);
  int32_t *element = calloc((size_t)(8 * m), sizeof *element);
  int32_t *number = calloc((size_t)n, sizeof *number);
  for (int32_t i = 0; i < n; i++)
    if (one->node[3 * i] + one->node[3 * i + 1] + one->node[3 * i + 2] > 3 - 1e-9)
      corner = i;
  int32_t next = n;
  memcpy(x, one->node, 3 * (size_t)n * sizeof(double));
  for (int32_t i = 0; i < n; i++) {
    const double *p = one->node + 3 * i;
    if (p[0] + p[1] + p[2] < 1e-9) {
      number[i] = corner;
      continue;
    }
    for (int c = 0; c < 3; c++)
      x[3 * next + c] = 1 + p[c];
    number[i] = next++;
  }
  memcpy(element, one->element, 4 * (size_t)m * sizeof *element);
  for (int32_t k = 0; k < 4 * m; k++)
    element[4 * m + k] = number[one->element[k]];
  check_ok(context, bw_mesh_copy(context, 1, next, x, 2 * m, element, NULL, &mesh));
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *face = NULL;
  const double normal[3] = {1, 0, 0}, origin[3] = {0, 0, 0}, gravity[3] = {0, 0, -9.81};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_plane(context, mesh, origin, normal, 1e-9, &face));
  check_ok(context, bw_model_fix(context, model, face));
  check_ok(context, bw_model_gravity(context, model, gravity));
  bw_static *result = NULL;
  check_fails(context, BW_SINGULAR, "touch only in a node",
              bw_statics(context, model, NULL, NULL, &result));
  free(x);
  free(element);
  free(number);
  bw_release(face);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_release(one);
}

/* Everything fixed: no unknown is left, and no mode. */
static void nothing_to_solve(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 1, 1, 1, 1);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *all = NULL;
  const bool fixed[3] = {true, true, true};
  const double value[3] = {1, 2, 3};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_model_prescribe(context, model, all, fixed, value));
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  check_near(result->displacement[4], 2, 0);
  check_near(result->energy, 0, 1e-3); /* of terms of 1e11 J */
  check_ok(context, bw_modes_elastic(context, result->system, NULL, &modes));
  assert_int_equal(modes->count, 0);
  bw_release(modes);
  bw_release(result);
  bw_release(all);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

/* Answers of 0 MPa that look safe: everything fixed, or the load on the support itself. */
static void loads_that_reach_nothing_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 2, 1, 1, 4, 2, 2, 2);
  bw_material *material = body_material(context);
  bw_model *model = NULL;
  bw_selection *all = NULL, *foot = NULL, *tip = NULL, *side = NULL;
  bw_static *result = NULL;
  const double origin[3] = {0, 0, 0}, far[3] = {2, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
  const double down[3] = {0, 0, -10}, along[3] = {5, 0, 0}, middle[3] = {1, 0, 0};
  bw_selection *near = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_select_plane(context, mesh, origin, x, 1e-9, &foot));
  check_ok(context, bw_select_plane(context, mesh, far, x, 1e-9, &tip));
  check_ok(context, bw_select_plane(context, mesh, origin, y, 1e-9, &side));
  check_ok(context, bw_select_half_space(context, mesh, middle, x, 1e-9, &near));
  check_ok(context, bw_model_fix(context, model, all));
  check_ok(context, bw_model_gravity(context, model, down));
  check_fails(context, BW_INVALID, "fix all", bw_statics(context, model, NULL, NULL, &result));
  bw_model_clear_supports(model);
  bw_model_clear_loads(model);
  check_ok(context, bw_model_fix(context, model, foot));
  check_ok(context, bw_model_force(context, model, tip, down));
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  bw_release(result);
  check_ok(context, bw_model_force(context, model, foot, down));
  check_fails(context, BW_INVALID, "load 2, a force, acts on supports only",
              bw_statics(context, model, NULL, NULL, &result));
  /* a slide takes what pushes across it, not what pulls along it */
  bw_model_clear_loads(model);
  check_ok(context, bw_model_slide(context, model, side, y));
  check_ok(context, bw_model_force(context, model, side, along));
  bw_clear_warnings(context);
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  bw_release(result);
  bw_model_clear_loads(model);
  check_ok(context, bw_model_pressure(context, model, side, 1e3));
  check_fails(context, BW_INVALID, "load 1, a pressure, acts on supports only",
              bw_statics(context, model, NULL, NULL, &result));
  /* the half of a side where x <= 1 is fixed */
  bw_model_clear_loads(model);
  bw_model_clear_supports(model);
  check_ok(context, bw_model_fix(context, model, near));
  check_ok(context, bw_model_force(context, model, side, down));
  bw_clear_warnings(context);
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  assert_null(bw_warning_at(context, 1));
  assert_non_null(strstr(bw_warning_at(context, 0), "50 % of the area of load 1, a force"));
  bw_release(result);
  bw_release(near);
  bw_release(side);
  bw_release(tip);
  bw_release(foot);
  bw_release(all);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
}

check_main(check_test(bar_in_tension), check_test(bar_under_own_weight),
           check_test(prescribed_stretch), check_test(free_bodies),
           check_test(mechanism_is_refused), check_test(nothing_to_solve),
           check_test(loads_that_reach_nothing_are_refused))
