/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Attached masses and springs: closed forms, balance, and what is refused. */
#include "pair.h"

#include "barwright/analysis.h"
#include "barwright/joint.h"

static const double pi = 3.14159265358979323846;

typedef struct body {
  bw_mesh *mesh;
  bw_material *material;
  bw_model *model;
  double mass;
} body;

static body make_body(bw_context *context, double x, double y, double z, int order) {
  body b = {.mesh = body_box(context, x, y, z, 2, 3, 2, order), .material = body_material(context)};
  check_ok(context, bw_model_create(context, b.mesh, b.material, &b.model));
  b.mass = x * y * z * b.material->density;
  return b;
}

static void close_body(body *b) {
  bw_release(b->model);
  bw_release(b->material);
  bw_release(b->mesh);
}

static bw_selection *plane(bw_context *context, const body *b, int k, double at) {
  bw_selection *on = NULL;
  double point[3] = {0}, normal[3] = {0};
  point[k] = at;
  normal[k] = 1;
  check_ok(context, bw_select_plane(context, b->mesh, point, normal, 1e-9, &on));
  return on;
}

static void attach_spring(bw_context *context, body *b, int k, double at, double stiffness) {
  bw_selection *on = plane(context, b, k, at);
  double along[3] = {stiffness, stiffness, stiffness};
  check_ok(context, bw_model_attach_spring(context, b->model, on, along));
  bw_release(on);
}

/* A stiff body on soft springs moves as a rigid one: frequencies of the 3 x 3 blocks of sway and
 * rocking, of heave and of yaw. A mass on top at its centre makes it heavier. */
static void a_body_on_springs_is_rigid(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int loaded = 0; loaded < 2; loaded++) {
      const double x = 0.3, y = 0.2, z = 0.1, k = 1e5, added = loaded ? 30 : 0;
      body b = make_body(context, x, y, z, order);
      attach_spring(context, &b, 2, 0, k);
      if (loaded) {
        bw_selection *top = plane(context, &b, 2, z);
        check_ok(context, bw_model_attach_mass(context, b.model, top, added));
        bw_release(top);
      }
      /* about the centre of the base */
      double m = b.mass + added, first = b.mass * z / 2 + added * z, square[2], expected[6];
      double height = b.mass * z * z / 3 + added * z * z;
      double side[2] = {x * x / 12, y * y / 12};
      for (int c = 0; c < 2; c++) { /* sway along c with rocking about the other axis */
        double inertia = m * side[c] + height, rocking = k * side[c];
        double a = m * inertia - first * first, p = k * inertia + m * rocking, q = k * rocking;
        for (int s = 0; s < 2; s++)
          square[s] = (p + (s ? 1 : -1) * sqrt(p * p - 4 * a * q)) / (2 * a);
        expected[2 * c] = square[0];
        expected[2 * c + 1] = square[1];
      }
      expected[4] = k / m;                                               /* heave */
      expected[5] = k * (side[0] + side[1]) / (m * (side[0] + side[1])); /* yaw */
      check_six(context, b.model, expected, 1e-4);
      close_body(&b);
    }
}

/* A bar held at one end and guided so that it only stretches, a mass M on the other: the root of
 * wL/c tan(wL/c) = m/M. */
static void a_mass_slows_a_bar(void **state) {
  bw_context *context = check_context(state);
  const double length = 1, side = 0.1, added = 40;
  body b = {.mesh = body_box(context, length, side, side, 10, 1, 1, 2)};
  bw_material *straight = NULL; /* without Poisson's effect */
  bw_modes *modes = NULL;
  bw_modes_options options;
  const bw_isotropic constants = {.name = "straight", .young = 200e9, .density = 7800};
  check_ok(context, bw_material_isotropic(context, &constants, &straight));
  b.material = straight;
  check_ok(context, bw_model_create(context, b.mesh, b.material, &b.model));
  bw_selection *root = plane(context, &b, 0, 0), *tip = plane(context, &b, 0, length), *all = NULL;
  const bool across[3] = {false, true, true};
  check_ok(context, bw_select_all(context, b.mesh, &all));
  check_ok(context, bw_model_fix(context, b.model, root));
  check_ok(context, bw_model_prescribe(context, b.model, all, across, NULL));
  check_ok(context, bw_model_attach_mass(context, b.model, tip, added));
  bw_modes_options_default(&options);
  options.count = 1;
  check_ok(context, bw_joined_modes(context, b.model, &options, &modes));
  double density = b.material->density, mass = density * length * side * side, low = 0,
         high = pi / 2;
  for (int i = 0; i < 100; i++) {
    double middle = (low + high) / 2;
    *(middle * tan(middle) < mass / added ? &low : &high) = middle;
  }
  double expected = low / length * sqrt(200e9 / density) / (2 * pi);
  check_near(modes->frequency[0], expected, 1e-5 * expected);
  bw_release(modes);
  bw_release(root);
  bw_release(tip);
  bw_release(all);
  close_body(&b);
}

/* A load off the centre on springs under the body: each exerts what balances it; a rigid body sinks
 * and tilts as the closed form says. */
static void springs_carry_a_load(void **state) {
  bw_context *context = check_context(state);
  const double x = 0.3, y = 0.2, z = 0.1, k = 1e5, added = 7, g = 9.81;
  body b = make_body(context, x, y, z, 2);
  bw_static *result = NULL;
  bw_selection *end = plane(context, &b, 0, x);
  check_ok(context, bw_model_gravity(context, b.model, (double[3]){0, 0, -g}));
  attach_spring(context, &b, 2, 0, k);
  check_ok(context, bw_model_attach_mass(context, b.model, end, added));
  check_near(b.model->load[0].resultant[2], -g * (b.mass + added), 1e-9 * g * (b.mass + added));
  check_ok(context, bw_joined_statics(context, b.model, NULL, &result));
  double weight = g * (b.mass + added);
  check_near(result->attachment[0].force[2], weight, 1e-6 * weight);
  check_near(result->attachment[1].force[2], -g * added, 1e-9 * weight);
  check_near(result->attachment[0].moment[1], -(g * b.mass * x / 2 + g * added * x),
             1e-6 * weight * x);
  /* rocking stiffness k x^2/12 and sway, coupled through nothing in a static load along z */
  double tilt = g * added * (x / 2) / (k * x * x / 12);
  for (int32_t i = 0; i < b.mesh->node_count; i++)
    check_near(result->displacement[3 * i + 2], -weight / k - tilt * (b.mesh->node[3 * i] - x / 2),
               1e-4 * weight / k);
  assert_true(result->energy >= 0 && result->energy < 1e-3 * weight * weight / k);
  check_ok(context, bw_model_clear_attachments(context, b.model));
  check_near(b.model->load[0].resultant[2], -g * b.mass, 1e-9 * weight);
  bw_release(result);
  bw_release(end);
  close_body(&b);
}

/* Shares of curved and plane facets, and of single nodes, sum to the whole; a moved model
 * keeps them. */
static void shares_sum_to_the_whole(void **state) {
  bw_context *context = check_context(state);
  body b = make_body(context, 1, 1, 1, 2);
  bw_selection *point = NULL, *all = NULL;
  bw_mesh *mesh = NULL;
  bw_model *moved = NULL;
  const double corner[3] = {0, 0, 0};
  double *x = numbers(3 * (int64_t)b.mesh->node_count);
  check_ok(context, bw_select_nearest(context, b.mesh, corner, 1, &point));
  check_ok(context, bw_select_all(context, b.mesh, &all));
  check_ok(context, bw_model_attach_mass(context, b.model, point, 2));
  check_ok(context, bw_model_attach_mass(context, b.model, all, 3));
  check_ok(context, bw_model_gravity(context, b.model, (double[3]){0, 2, 0}));
  check_near(b.model->load[0].resultant[1], 2 * (b.mass + 5), 1e-10 * b.mass);
  for (int64_t i = 0; i < 3 * (int64_t)b.mesh->node_count; i++) /* bends edges */
    x[i] = b.mesh->node[i] + 0.05 * sin(7 * b.mesh->node[i / 3 * 3 + (i + 1) % 3]);
  check_ok(context, bw_mesh_moved(context, b.mesh, x, &mesh));
  check_ok(context, bw_model_moved(context, b.model, mesh, &moved));
  assert_int_equal(moved->attachment_count, 2);
  check_near(moved->load[0].resultant[1], 2 * (b.material->density * bw_mesh_volume(mesh) + 5),
             1e-9 * b.mass);
  free(x);
  bw_release(moved);
  bw_release(mesh);
  bw_release(point);
  bw_release(all);
  close_body(&b);
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  body b = make_body(context, 1, 1, 1, 1);
  bw_dof_map *dof_map = NULL;
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  bw_selection *on = plane(context, &b, 2, 0);
  check_fails(context, BW_INVALID, "must be positive",
              bw_model_attach_mass(context, b.model, on, 0));
  check_fails(context, BW_INVALID, "component 2",
              bw_model_attach_spring(context, b.model, on, (double[3]){1, -1, 0}));
  check_fails(context, BW_INVALID, "no stiffness",
              bw_model_attach_spring(context, b.model, on, (double[3]){0, 0, 0}));
  check_ok(context, bw_model_attach_spring(context, b.model, on, (double[3]){0, 0, 1e6}));
  check_fails(context, BW_UNSUPPORTED,
              "1 attachment:", bw_dof_map_create(context, b.model, &dof_map));
  check_fails(context, BW_UNCONSTRAINED, "3 rigid-body modes",
              bw_joined_statics(context, b.model, NULL, &result));
  check_ok(context, bw_model_attach_mass(context, b.model, on, 1));
  check_ok(context, bw_joined_modes(context, b.model, NULL, &modes));
  assert_int_equal(modes->rigid_count, 3);
  bw_release(modes);
  bw_release(on);
  close_body(&b);
}

/* Springs so soft that rounding of the body's stiffness hides them give no displacement. */
static void soft_springs(void **state) {
  bw_context *context = check_context(state);
  body b = make_body(context, 1, 1, 1, 1);
  bw_static *result = NULL;
  check_ok(context, bw_model_gravity(context, b.model, (double[3]){0, 0, -10}));
  for (int k = 0; k < 2; k++) { /* the elimination fails, or the residual is large */
    check_ok(context, bw_model_clear_attachments(context, b.model));
    attach_spring(context, &b, 2, 0, k ? 1e-2 : 1e-4);
    check_fails(context, BW_SINGULAR, "nearly singular",
                bw_joined_statics(context, b.model, NULL, &result));
  }
  close_body(&b);
}

/* With each allocation failing in turn. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  body b = make_body(context, 1, 1, 1, 1);
  bw_static *result = NULL;
  bw_modes *modes = NULL;
  attach_spring(context, &b, 2, 0, 1e8);
  check_ok(context, bw_model_gravity(context, b.model, (double[3]){0, 0, -10}));
  check_allocations(context, result, bw_joined_statics(context, b.model, NULL, &result));
  check_allocations(context, modes, bw_joined_modes(context, b.model, NULL, &modes));
  close_body(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(a_body_on_springs_is_rigid),
      check_test(a_mass_slows_a_bar),
      check_test(springs_carry_a_load),
      check_test(shares_sum_to_the_whole),
      check_test(refuses),
      check_test(soft_springs),
      check_test(memory_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
