/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "helpers.h"

static double *forces_of(bw_context *context, const bw_model *model) {
  double *force = malloc(3 * sizeof *force * (size_t)model->mesh->node_count);
  check_ok(context, bw_model_force_vector(context, model, force));
  return force;
}

static void resultant_of(const bw_mesh *mesh, const double *force, const double about[3],
                         double sum[3], double moment[3]) {
  memset(sum, 0, 3 * sizeof *sum);
  memset(moment, 0, 3 * sizeof *moment);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double y[3], turn[3];
    for (int k = 0; k < 3; k++) {
      y[k] = mesh->node[3 * i + k] - about[k];
      sum[k] += force[3 * i + k];
    }
    bw_cross(y, force + 3 * (size_t)i, turn);
    for (int k = 0; k < 3; k++)
      moment[k] += turn[k];
  }
}

static const double origin[3] = {0, 0, 0};

static void pressure_on_a_closed_body_is_balanced(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) { /* order 2: curved facets */
    bw_mesh *mesh = octant_mesh(context, 3, order);
    bw_model *model = some_model(context, mesh);
    bw_selection *all = NULL;
    double sum[3], moment[3];
    check_ok(context, bw_select_all(context, mesh, &all));
    check_ok(context, bw_model_pressure(context, model, all, 1));
    double *force = forces_of(context, model);
    resultant_of(mesh, force, origin, sum, moment);
    for (int k = 0; k < 3; k++) {
      check_near(sum[k], 0, 1e-14);
      check_near(moment[k], 0, 1e-14);
      check_near(model->load[0].resultant[k], 0, 1e-14);
    }
    free(force);
    bw_release(all);
    bw_release(model);
    bw_release(mesh);
  }
}

/* sum f_i . x_i = integral of t . x = -p times integral of div x = -3 p V, also when curved. */
static void pressure_obeys_the_divergence_theorem(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = octant_mesh(context, 3, order);
    bw_model *model = some_model(context, mesh);
    bw_selection *all = NULL;
    bw_dof_map *dof_map = NULL;
    check_ok(context, bw_select_all(context, mesh, &all));
    check_ok(context, bw_model_pressure(context, model, all, 2));
    check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
    double *force = forces_of(context, model), virial = 0;
    for (int32_t i = 0; i < 3 * mesh->node_count; i++)
      virial += force[i] * mesh->node[i];
    check_near(virial, -3 * 2 * dof_map->body_volume[0], 1e-13);
    free(force);
    bw_release(dof_map);
    bw_release(all);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A quarter of the projected area pi r^2 pushes along each axis on the octant's sphere. */
static void pressure_on_the_sphere_pushes_with_the_projected_area(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = octant_mesh(context, 4, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *round = NULL;
  double point[3] = {0.6, 0.6, 0.6};
  check_ok(context, bw_select_patch(context, mesh, point, 0.7, &round));
  check_near(bw_selection_area(round), acos(-1) / 2, 2e-4);
  check_ok(context, bw_model_pressure(context, model, round, 10));
  for (int k = 0; k < 3; k++)
    check_near(model->load[0].resultant[k], -10 * acos(-1) / 4, 1e-3);
  bw_release(round);
  bw_release(model);
  bw_release(mesh);
}

static void total_force_is_exact_and_spread_evenly(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = octant_mesh(context, 3, order);
    bw_model *model = some_model(context, mesh);
    bw_selection *some = NULL;
    double high[3] = {1, 1, 0.7}, sum[3], moment[3], wanted[3] = {1, -2, 5}, centre[3], turn[3];
    check_ok(context, bw_select_box(context, mesh, origin, high, &some));
    check_ok(context, bw_model_force(context, model, some, wanted));
    double *force = forces_of(context, model);
    resultant_of(mesh, force, origin, sum, moment);
    bw_selection_centre(some, centre);
    bw_cross(centre, wanted, turn); /* as if it acted at the centre of area */
    for (int k = 0; k < 3; k++) {
      check_near(sum[k], wanted[k], 1e-14);
      check_near(moment[k], turn[k], 1e-14);
    }
    free(force);
    bw_release(some);
    bw_release(model);
    bw_release(mesh);
  }
}

static void torque_is_what_was_asked_for(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = octant_mesh(context, 3, order);
    bw_model *model = some_model(context, mesh);
    bw_selection *face = face_of(context, mesh, 2, 0), *round = NULL;
    double point[3] = {0.6, 0.6, 0.6}, torque[3] = {0.3, -0.2, 7}, sum[3], moment[3], centre[3];
    check_ok(context, bw_select_patch(context, mesh, point, 0.5, &round));
    check_ok(context, bw_model_torque(context, model, round, torque, NULL));
    double *force = forces_of(context, model);
    bw_selection_centre(round, centre);
    resultant_of(mesh, force, centre, sum, moment);
    for (int k = 0; k < 3; k++) { /* about the centre of area: a pure couple */
      check_near(moment[k], torque[k], 1e-13);
      check_near(sum[k], 0, 1e-13);
    }
    free(force);
    bw_model_clear_loads(model);
    check_ok(context, bw_model_torque(context, model, face, torque, point));
    force = forces_of(context, model);
    resultant_of(mesh, force, point, sum, moment);
    for (int k = 0; k < 3; k++)
      check_near(moment[k], torque[k], 1e-12);
    free(force);
    bw_release(face);
    bw_release(round);
    bw_release(model);
    bw_release(mesh);
  }
}

static void gravity_is_the_weight(void **state) {
  bw_context *context = check_context(state);
  double g[3] = {0, -9.81, 1};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, order);
    bw_model *model = some_model(context, mesh);
    check_ok(context, bw_model_gravity(context, model, g));
    for (int k = 0; k < 3; k++)
      check_near(model->load[0].resultant[k], 7800 * 2 * g[k], 1e-9);
    /* acts at the centre (1, 0.5, 0.5) */
    double centre[3] = {1, 0.5, 0.5}, turn[3];
    bw_cross(centre, model->load[0].resultant, turn);
    for (int k = 0; k < 3; k++)
      check_near(model->load[0].moment[k], turn[k], 1e-9);
    bw_isotropic heavy = {.name = "heavy", .young = 1e9, .poisson = 0.3, .density = 10000};
    bw_material *material = NULL;
    check_ok(context, bw_material_isotropic(context, &heavy, &material));
    check_ok(context, bw_model_set_material(context, model, -1, material));
    for (int k = 0; k < 3; k++)
      check_near(model->load[0].resultant[k], 10000 * 2 * g[k], 1e-9);
    bw_release(material);
    bw_release(model);
    bw_release(mesh);
  }
}

static void uniform_pressure_on_tet10_loads_only_mid_edge_nodes(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *top = face_of(context, mesh, 2, 1);
  check_ok(context, bw_model_pressure(context, model, top, 6));
  double *force = forces_of(context, model);
  /* two triangles of area 1/2: 4 rim mid-edge nodes take A/3 p = 1, the shared one twice that */
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * (size_t)i;
    int halves = (x[0] == 0.5) + (x[1] == 0.5);
    check_near(force[3 * i + 2], x[2] < 1 ? 0 : -halves, 1e-15);
    check_near(force[3 * i], 0, 1e-15);
  }
  free(force);
  bw_release(top);
  bw_release(model);
  bw_release(mesh);
}

static void nodal_forces_pass_through(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 1);
  bw_model *model = some_model(context, mesh);
  bw_array *array = NULL;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &array));
  ((double *)array->data)[4] = 5;
  check_ok(context, bw_model_nodal_forces(context, model, array));
  check_near(model->load[0].resultant[1], 5, 0);
  double *force = forces_of(context, model);
  check_near(force[4], 5, 0);
  ((double *)array->data)[7] = NAN;
  check_fails(context, BW_INVALID, "component 2 of the nodal force at node 3",
              bw_model_nodal_forces(context, model, array));
  free(force);
  bw_release(array);
  bw_release(model);
  bw_release(mesh);
}

static void unusable_loads_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 1);
  bw_mesh *other = box_mesh(context, 1, 1, 1, 1, 1, 1, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *corner = NULL, *elsewhere = face_of(context, other, 0, 0);
  double f[3] = {1, 0, 0}, bad[3] = {INFINITY, 0, 0}, zero[3] = {0, 0, 0};
  bool none[3] = {false, false, false};
  uint64_t revision = model->object.revision;
  check_ok(context, bw_select_nearest(context, mesh, origin, 1, &corner));
  check_fails(context, BW_EMPTY, "no whole facet. Give", bw_model_force(context, model, corner, f));
  check_fails(context, BW_INVALID, "another mesh", bw_model_fix(context, model, elsewhere));
  check_fails(context, BW_INVALID, "not a finite", bw_model_gravity(context, model, bad));
  check_fails(context, BW_INVALID, "normal is (0, 0, 0)",
              bw_model_slide(context, model, corner, zero));
  check_fails(context, BW_INVALID, "constrains no direction",
              bw_model_prescribe(context, model, corner, none, zero));
  assert_int_equal(model->load_count, 0);
  assert_int_equal(model->support_count, 0);
  assert_int_equal(model->object.revision, revision);
  bw_isotropic weightless = {"air", 1, 0, 0, 0, 0, 0};
  bw_material *material = NULL;
  bw_model *light = NULL;
  check_ok(context, bw_material_isotropic(context, &weightless, &material));
  check_ok(context, bw_model_create(context, mesh, material, &light));
  check_fails(context, BW_INVALID, "needs the density of the material \"air\"",
              bw_model_gravity(context, light, f));
  bw_release(light);
  bw_release(material);
  bw_release(corner);
  bw_release(elsewhere);
  bw_release(model);
  bw_release(mesh);
  bw_release(other);
}

static void model_describes_itself(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *low = face_of(context, mesh, 0, 0), *high = face_of(context, mesh, 0, 2);
  double pull[3] = {100, 0, 0}, g[3] = {0, 0, -10}, x[3] = {1, 0, 0};
  char *text = NULL;
  check_ok(context, bw_model_slide(context, model, low, x));
  check_ok(context, bw_model_force(context, model, high, pull));
  check_ok(context, bw_model_gravity(context, model, g));
  check_ok(context, bw_model_describe(context, model, &text));
  assert_string_equal(
      text,
      "mesh: 12 tet4 elements, 12 nodes, 1 body, volume 2 m3, box (0, 0, 0) to (2, 1, 1) m\n"
      "material: test, isotropic, Young's modulus 2e+11 Pa, Poisson's ratio 0.3, density 7800 "
      "kg/m3, strength 4e+08 Pa\n"
      "support 1: slides, fixed along (1, 0, 0); 4 nodes, 2 facets, area 1 m2, centre (0, 0.5, "
      "0.5) "
      "m\n"
      "load 1: force (100, 0, 0) N; 4 nodes, 2 facets, area 1 m2, centre (2, 0.5, 0.5) m; "
      "resultant (100, 0, 0) N, moment about the origin (0, 50, -50) N m\n"
      "load 2: gravity (0, 0, -10) m/s2; resultant (0, 0, -1.56e+05) N, moment about the origin "
      "(-78000, 1.56e+05, 0) N m\n"
      "all loads: resultant (100, 0, -1.56e+05) N, moment about the origin (-78000, 1.5605e+05, "
      "-50) N m\n"
      "unknowns: 29; 3 rigid-body modes are unconstrained: translation along (0, 1, 0), "
      "translation along (0, "
      "0, 1), rotation about the axis through (1, 0.5, 0.5) along (1, 0, 0)\n");
  bw_free(text);
  bw_release(low);
  bw_release(high);
  bw_release(model);
  bw_release(mesh);
}

static bw_status build(bw_context *context, const bw_mesh *mesh, const bw_material *material) {
  bw_model *model = NULL;
  bw_selection *all = NULL, *patch = NULL, *rest = NULL;
  double v[3] = {1, 2, 3}, point[3] = {0.5, 0.5, 1};
  char *text = NULL;
  bw_status status;
  BW_TRY(bw_model_create(context, mesh, material, &model));
  BW_TRY(bw_select_all(context, mesh, &all));
  BW_TRY(bw_select_patch(context, mesh, point, 0.1, &patch));
  BW_TRY(bw_select_combine(context, all, patch, BW_DIFFERENCE, &rest));
  BW_TRY(bw_model_fix(context, model, patch));
  BW_TRY(bw_model_slide(context, model, patch, NULL));
  BW_TRY(bw_model_pressure(context, model, rest, 1));
  BW_TRY(bw_model_torque(context, model, rest, v, NULL));
  BW_TRY(bw_model_gravity(context, model, v));
  BW_TRY(bw_model_describe(context, model, &text));
done:
  bw_free(text);
  bw_release(all);
  bw_release(patch);
  bw_release(rest);
  bw_release(model);
  return status;
}

static void failing_allocations_leave_nothing_behind(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 2);
  bw_material *material = some_material(context);
  check_each_allocation(context, status, 1) {
    status = build(context, mesh, material);
  }
  bw_release(material);
  bw_release(mesh);
}

check_main(check_test(pressure_on_a_closed_body_is_balanced),
           check_test(pressure_obeys_the_divergence_theorem),
           check_test(pressure_on_the_sphere_pushes_with_the_projected_area),
           check_test(total_force_is_exact_and_spread_evenly),
           check_test(torque_is_what_was_asked_for), check_test(gravity_is_the_weight),
           check_test(uniform_pressure_on_tet10_loads_only_mid_edge_nodes),
           check_test(nodal_forces_pass_through), check_test(unusable_loads_are_refused),
           check_test(model_describes_itself), check_test(failing_allocations_leave_nothing_behind))
