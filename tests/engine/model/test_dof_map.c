/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "helpers.h"

/* R^T W R = 1, R^T W from W R, and the pins tell the motions apart. */
static void check_motions(const bw_dof_map *dof_map) {
  int n = dof_map->rigid_mode_count;
  size_t size = 3 * (size_t)dof_map->mesh->node_count;
  double *r = calloc(size, sizeof *r), *w = calloc(size, sizeof *w);
  double a[64], one[64];
  assert_true(n <= 64);
  for (int m = 0; m < n; m++) {
    memset(one, 0, sizeof one);
    one[m] = 1;
    memset(r, 0, size * sizeof *r);
    bw_rigid_modes_add(dof_map, one, r);
    bw_rigid_modes_measure(dof_map, r, a);
    for (int k = 0; k < n; k++)
      check_near(a[k], k == m, 1e-12);
    bw_rigid_modes_weighted(dof_map, one, w);
    bw_rigid_modes_dot(dof_map, w, a);
    for (int k = 0; k < n; k++)
      check_near(a[k], k == m, 1e-12);
    for (size_t i = 0; i < size; i++) /* no constrained component moves */
      if (dof_map->state[i] == BW_DOF_PRESCRIBED && dof_map->frame_of[i / 3] < 0)
        check_near(r[i], 0, 1e-9);
  }
  int isostatic = 0, unknowns = 0;
  for (size_t i = 0; i < size; i++) {
    isostatic += dof_map->state[i] == BW_DOF_ISOSTATIC;
    if (dof_map->state[i] == BW_DOF_UNKNOWN)
      assert_int_equal(dof_map->unknown[i], unknowns++);
    else
      assert_int_equal(dof_map->unknown[i], -1);
  }
  assert_int_equal(isostatic, n);
  assert_int_equal(unknowns, dof_map->unknown_count);
  free(r);
  free(w);
}

static void free_box_has_six_motions_about_its_principal_axes(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box_mesh(context, 3, 2, 1, 3, 2, 1, order);
    bw_dof_map *dof_map = NULL;
    check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
    assert_int_equal(dof_map->rigid_mode_count, 6);
    assert_string_equal(dof_map->rigid_mode[0].text, "translation along (1, 0, 0)");
    assert_string_equal(dof_map->rigid_mode[1].text, "translation along (0, 1, 0)");
    assert_string_equal(dof_map->rigid_mode[2].text, "translation along (0, 0, 1)");
    /* smallest moment first: about the long side */
    assert_string_equal(dof_map->rigid_mode[3].text,
                        "rotation about the axis through (1.5, 1, 0.5) along (1, 0, 0)");
    check_near(dof_map->rigid_mode[3].rotation[0], 1 / sqrt((4. + 1.) / 12), 1e-12);
    check_near(dof_map->rigid_mode[4].rotation[1], 1 / sqrt((9. + 1.) / 12), 1e-12);
    check_near(dof_map->rigid_mode[5].rotation[2], 1 / sqrt((9. + 4.) / 12), 1e-12);
    check_near(dof_map->body_volume[0], 6, 1e-12);
    check_motions(dof_map);
    bw_release(dof_map);
    bw_release(mesh);
  }
}

/* What is a thousandth of a motion is not named. */
static void motions_are_described_to_three_digits(void **state) {
  bw_context *context = check_context(state);
  const struct {
    double a[6];
    const char *text;
  } of[] = {
      {{1, 5e-4, 0, 0, 0, 5e-4}, "translation along (1, 0, 0)"},
      {{0, 0, 1e-4, 0, 0, 1}, "rotation about the axis through (1.5, 1, 0.5) along (0, 0, 1)"},
      {{0, 0, 0.1, 0, 0, 1},
       "screw motion about the axis through (1.5, 1, 0.5) along (0, 0, 1), 0.104 m per radian"},
      {{1, 0, 0, 0, 0, 1}, "rotation about the axis through (1.5, 2.041, 0.5) along (0, 0, 1)"}};
  bw_mesh *mesh = box_mesh(context, 3, 2, 1, 3, 2, 1, 1);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
    char text[300];
    bwi_describe_motion(dof_map, of[i].a, text, sizeof text);
    assert_string_equal(text, of[i].text);
  }
  bw_release(dof_map);
  bw_release(mesh);
}

static void moved_and_turned_box_keeps_its_motions_orthonormal(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 3, 2, 1, 2, 2, 2, 1), *moved = NULL;
  double *x = malloc(3 * sizeof *x * (size_t)mesh->node_count);
  double c = cos(0.7), s = sin(0.7);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *p = mesh->node + 3 * (size_t)i;
    x[3 * i] = 1000 + c * p[0] - s * p[1];
    x[3 * i + 1] = -2000 + s * p[0] + c * p[1];
    x[3 * i + 2] = 500 + p[2];
  }
  check_ok(context, bw_mesh_moved(context, mesh, x, &moved));
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, moved, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 6);
  double turn = bw_norm(dof_map->rigid_mode[3].rotation);
  check_near(dof_map->rigid_mode[3].rotation[0] / turn, c, 1e-9);
  check_near(dof_map->rigid_mode[3].rotation[1] / turn, s, 1e-9);
  free(x);
  bw_release(dof_map);
  bw_release(moved);
  bw_release(mesh);
}

static void curved_octant_has_the_centre_of_half_a_ball(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = octant_mesh(context, 4, 2);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  check_near(dof_map->body_volume[0], acos(-1) / 6, 2e-4);
  for (int k = 0; k < 3; k++)
    check_near(dof_map->body_centre[k], 3. / 8, 2e-4);
  check_motions(dof_map);
  bw_release(dof_map);
  bw_release(mesh);
}

static void cube_takes_global_axes(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 2, 2, 2, 2);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  assert_string_equal(dof_map->rigid_mode[4].text,
                      "rotation about the axis through (0.5, 0.5, 0.5) along (0, 1, 0)");
  check_motions(dof_map);
  bw_release(dof_map);
  bw_release(mesh);
}

static void three_symmetry_planes_hold_an_octant(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = octant_mesh(context, 3, 1);
  bw_model *model = some_model(context, mesh);
  for (int axis = 0; axis < 3; axis++) {
    bw_selection *face = face_of(context, mesh, axis, 0);
    double normal[3] = {axis == 0, axis == 1, axis == 2};
    check_ok(context, bw_model_slide(context, model, face, normal));
    bw_release(face);
  }
  bw_dof_map *dof_map = NULL;
  char *text = NULL;
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 0);
  assert_int_equal(dof_map->frame_count, 0); /* global directions serve */
  check_ok(context, bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  assert_string_equal(text, "no rigid-body mode is unconstrained");
  bw_free(text);
  /* the corner at the origin is constrained in all three directions */
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (bw_norm(mesh->node + 3 * (size_t)i) == 0)
      for (int k = 0; k < 3; k++)
        assert_int_equal(dof_map->state[3 * i + k], BW_DOF_PRESCRIBED);
  bw_release(dof_map);
  bw_release(model);
  bw_release(mesh);
}

static void box_on_one_plane_keeps_three_named_motions(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *face = face_of(context, mesh, 2, 0);
  check_ok(context, bw_model_slide(context, model, face, NULL)); /* by the surface's own normal */
  bw_dof_map *dof_map = NULL;
  char *text = NULL;
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  check_ok(context, bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  assert_string_equal(
      text, "3 rigid-body modes are unconstrained: translation along (1, 0, 0), translation "
            "along (0, 1, 0), rotation about the axis through (1, 0.5, 0.5) along "
            "(0, 0, 1)");
  assert_int_equal(dof_map->frame_count, 0);
  check_motions(dof_map);
  bw_free(text);
  bw_release(dof_map);
  bw_release(face);
  bw_release(model);
  bw_release(mesh);
}

static void point_and_line_supports_leave_rotations(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *corner = NULL, *edge = NULL;
  double origin[3] = {0, 0, 0}, far_end[3] = {2, 0, 0};
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_select_nearest(context, mesh, origin, 1, &corner));
  check_ok(context, bw_model_fix(context, model, corner));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 3);
  for (int m = 0; m < 3; m++) { /* all turn about the corner */
    double u[3];
    for (int k = 0; k < 3; k++)
      u[k] = -dof_map->rigid_mode[m].centre[k];
    double c[3];
    bw_cross(dof_map->rigid_mode[m].rotation, u, c);
    check_near(bw_norm(c), 0, 1e-12);
    check_near(bw_norm(dof_map->rigid_mode[m].translation), 0, 0);
  }
  check_motions(dof_map);
  bw_release(dof_map);
  check_ok(context, bw_select_nearest(context, mesh, far_end, 1, &edge));
  check_ok(context, bw_model_fix(context, model, edge));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 1);
  assert_string_equal(dof_map->rigid_mode[0].text,
                      "rotation about the axis through (1, 0, 0) along (1, 0, 0)");
  check_motions(dof_map);
  bw_release(dof_map);
  bw_release(corner);
  bw_release(edge);
  bw_release(model);
  bw_release(mesh);
}

static void unconstrained_second_body_is_named(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = two_boxes(context);
  bw_model *model = some_model(context, mesh);
  bw_selection *face = face_of(context, mesh, 0, 0);
  bw_dof_map *dof_map = NULL;
  char *text = NULL;
  check_ok(context, bw_model_fix(context, model, face));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 6);
  for (int m = 0; m < 6; m++)
    assert_int_equal(dof_map->rigid_mode[m].component, mesh->component[mesh->node_count - 1]);
  check_ok(context, bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  assert_non_null(strstr(text, "body 2 of 2 (around (3.5, 0.5, 0.5) m, 1 m3): 6 rigid-body modes"));
  check_motions(dof_map);
  bw_free(text);
  bw_release(dof_map);
  bw_release(face);
  bw_release(model);
  bw_release(mesh);
}

static void oblique_slides_get_frames(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 2, 2, 2, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *top = face_of(context, mesh, 2, 1), *side = face_of(context, mesh, 0, 0);
  double slope[3] = {0, 3, 4}, x[3] = {2, 0, 0};
  check_ok(context, bw_model_slide(context, model, top, slope));
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->frame_count, top->node_count);
  assert_int_equal(dof_map->rigid_mode_count, 3);
  for (int32_t f = 0; f < dof_map->frame_count; f++) {
    const double *frame = dof_map->frame + 9 * (size_t)f;
    double c[3];
    check_near(frame[1], 0.6, 1e-15);
    check_near(frame[2], 0.8, 1e-15);
    bw_cross(frame, frame + 3, c);
    for (int k = 0; k < 3; k++)
      check_near(c[k], frame[6 + k], 1e-15);
    check_near(bw_norm(frame + 3), 1, 1e-15);
  }
  check_motions(dof_map);
  bw_release(dof_map);
  /* where both meet, two directions are constrained; the third is free */
  check_ok(context, bw_model_slide(context, model, side, x));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  int both = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int fixed = 0;
    for (int k = 0; k < 3; k++)
      fixed += dof_map->state[3 * i + k] == BW_DOF_PRESCRIBED;
    both += fixed == 2;
  }
  assert_int_equal(both, 3);
  assert_int_equal(dof_map->rigid_mode_count, 1); /* along (0, 4, -3) */
  check_near(fabs(dof_map->rigid_mode[0].translation[1]), 0.8, 1e-12);
  check_motions(dof_map);
  bw_release(dof_map);
  bw_release(top);
  bw_release(side);
  bw_release(model);
  bw_release(mesh);
}

static void own_normals_hold_both_faces_at_an_edge(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 2, 2, 2, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *all = NULL;
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_model_slide(context, model, all, NULL));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 0);
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      double x = mesh->node[3 * i + k];
      assert_int_equal(dof_map->state[3 * i + k],
                       x == 0 || x == 1 ? BW_DOF_PRESCRIBED : BW_DOF_UNKNOWN);
    }
  bw_release(dof_map);
  bw_release(all);
  bw_release(model);
  bw_release(mesh);
}

static void prescribed_values_reach_the_nodes_and_contradictions_are_named(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *low = face_of(context, mesh, 0, 0), *high = face_of(context, mesh, 0, 1);
  bw_selection *side = face_of(context, mesh, 1, 0);
  bool all[3] = {true, true, true}, x[3] = {true, false, false};
  double pull[3] = {1e-3, 0, 0};
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_model_fix(context, model, low));
  check_ok(context, bw_model_prescribe(context, model, high, x, pull));
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_true(dof_map->prescribed);
  for (int32_t i = 0; i < mesh->node_count; i++)
    check_near(dof_map->value[3 * i], mesh->node[3 * i] == 1 ? 1e-3 : 0, 0);
  bw_release(dof_map);
  check_ok(context, bw_model_prescribe(context, model, side, all, pull));
  check_fails(context, BW_INVALID, "support 3 moves node",
              bw_dof_map_create(context, model, &dof_map));
  assert_non_null(strstr(bw_message(context), "at (0, 0, 0) m"));
  bw_release(low);
  bw_release(high);
  bw_release(side);
  bw_release(model);
  bw_release(mesh);
}

/* A slide along one's own surface that is flat but for rounding to single precision must not hold
 * the plane. */
static void rounding_of_positions_does_not_hold(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 0.7, 0.3, 6, 6, 3, 1), *moved = NULL;
  double *x = malloc(3 * sizeof *x * (size_t)mesh->node_count);
  double c = cos(0.5), s = sin(0.5);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *p = mesh->node + 3 * (size_t)i;
    x[3 * i] = (float)p[0];
    x[3 * i + 1] = (float)(c * p[1] - s * p[2]);
    x[3 * i + 2] = (float)(s * p[1] + c * p[2]);
  }
  check_ok(context, bw_mesh_moved(context, mesh, x, &moved));
  bw_model *model = some_model(context, moved);
  bw_selection *face = NULL;
  double normal[3] = {0, s, -c}; /* the low face, outwards */
  check_ok(context, bw_select_normal_cone(context, moved, normal, 0.01, &face));
  check_ok(context, bw_model_slide(context, model, face, NULL));
  check_ok(context, bw_model_slide(context, model, face, normal)); /* the same but for rounding */
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_create(context, model, &dof_map));
  assert_int_equal(dof_map->rigid_mode_count, 3);
  check_motions(dof_map);
  free(x);
  bw_release(dof_map);
  bw_release(face);
  bw_release(model);
  bw_release(moved);
  bw_release(mesh);
}

static void projections_leave_nothing_rigid(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = octant_mesh(context, 2, 2);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &dof_map));
  size_t size = 3 * (size_t)mesh->node_count;
  double *f = malloc(size * sizeof *f), a[6];
  bw_random random;
  bw_random_seed(&random, 7);
  for (size_t i = 0; i < size; i++)
    f[i] = bw_random_normal(&random);
  bw_rigid_modes_balance(dof_map, f);
  bw_rigid_modes_dot(dof_map, f, a);
  for (int m = 0; m < 6; m++)
    check_near(a[m], 0, 1e-11);
  for (size_t i = 0; i < size; i++)
    f[i] = bw_random_normal(&random);
  bw_rigid_modes_remove(dof_map, f);
  bw_rigid_modes_measure(dof_map, f, a);
  for (int m = 0; m < 6; m++)
    check_near(a[m], 0, 1e-12);
  free(f);
  bw_release(dof_map);
  bw_release(mesh);
}

static void failing_allocations_leave_nothing_behind(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = two_boxes(context);
  bw_model *model = some_model(context, mesh);
  bw_selection *face = face_of(context, mesh, 0, 0);
  double slope[3] = {1, 1, 0};
  check_ok(context, bw_model_slide(context, model, face, slope));
  check_ok(context, bw_model_slide(context, model, face, NULL));
  check_each_allocation(context, status, 1) {
    bw_dof_map *dof_map = NULL;
    char *text = NULL;
    status = bw_dof_map_create(context, model, &dof_map);
    if (status == BW_OK)
      status = bw_dof_map_describe_rigid_modes(context, dof_map, &text);
    bw_free(text);
    bw_release(dof_map);
  }
  bw_release(face);
  bw_release(model);
  bw_release(mesh);
}

check_main(check_test(free_box_has_six_motions_about_its_principal_axes),
           check_test(motions_are_described_to_three_digits),
           check_test(moved_and_turned_box_keeps_its_motions_orthonormal),
           check_test(curved_octant_has_the_centre_of_half_a_ball),
           check_test(cube_takes_global_axes), check_test(three_symmetry_planes_hold_an_octant),
           check_test(box_on_one_plane_keeps_three_named_motions),
           check_test(point_and_line_supports_leave_rotations),
           check_test(unconstrained_second_body_is_named), check_test(oblique_slides_get_frames),
           check_test(own_normals_hold_both_faces_at_an_edge),
           check_test(prescribed_values_reach_the_nodes_and_contradictions_are_named),
           check_test(rounding_of_positions_does_not_hold),
           check_test(projections_leave_nothing_rigid),
           check_test(failing_allocations_leave_nothing_behind))
