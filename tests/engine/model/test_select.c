/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "helpers.h"

static void check_selection(const bw_selection *selection) {
  const bw_mesh *mesh = selection->mesh;
  for (int32_t i = 1; i < selection->node_count; i++)
    assert_true(selection->node[i - 1] < selection->node[i]);
  for (int32_t f = 1; f < selection->facet_count; f++)
    assert_true(selection->facet[f - 1] < selection->facet[f]);
  for (int32_t f = 0; f < selection->facet_count; f++)
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      int32_t node = mesh->facet[selection->facet[f] * mesh->nodes_per_facet + a];
      bool found = false;
      for (int32_t i = 0; i < selection->node_count; i++)
        found = found || selection->node[i] == node;
      assert_true(found);
    }
}

static void shapes_select_what_lies_in_them(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box_mesh(context, 2, 1, 1, 4, 2, 2, order);
    int side = 2 * order + 1; /* nodes along one side of an end face */
    bw_selection *face = face_of(context, mesh, 0, 2), *half = NULL, *ball = NULL, *box = NULL;
    double normal[3], centre[3];
    assert_int_equal(face->node_count, side * side);
    assert_int_equal(face->facet_count, 8);
    check_near(bw_selection_area(face), 1, 1e-15);
    bw_selection_normal(face, normal);
    bw_selection_centre(face, centre);
    check_near(normal[0], 1, 1e-15);
    check_near(centre[0], 2, 1e-15);
    check_near(centre[1], 0.5, 1e-15);
    double at[3] = {0.5, 0, 0}, x[3] = {5, 0, 0};
    check_ok(context, bw_select_half_space(context, mesh, at, x, 1e-9, &half));
    check_near(bw_selection_area(half), 1 + 4 * 0.5, 1e-14);
    double high[3] = {0.5, HUGE_VAL, HUGE_VAL}, low[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    check_ok(context, bw_select_box(context, mesh, low, high, &box));
    assert_int_equal(box->node_count, half->node_count);
    assert_memory_equal(box->node, half->node, sizeof *box->node * (size_t)box->node_count);
    double corner[3] = {2, 1, 1};
    check_ok(context, bw_select_sphere(context, mesh, corner, 0.1, &ball));
    assert_int_equal(ball->node_count, 1);
    assert_int_equal(ball->facet_count, 0);
    bw_selection_centre(ball, centre); /* no area: of the nodes */
    check_near(centre[2], 1, 0);
    check_selection(face);
    check_selection(half);
    check_selection(box);
    bw_release(face);
    bw_release(half);
    bw_release(ball);
    bw_release(box);
    bw_release(mesh);
  }
}

static void directions_select_sides(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = octant_mesh(context, 4, 2);
  bw_selection *down = NULL, *round = NULL, *nearest = NULL;
  double z[3] = {0, 0, -4}, point[3] = {1, 1, 1};
  check_ok(context, bw_select_normal_cone(context, mesh, z, 0.01, &down));
  check_near(bw_selection_area(down), acos(-1) / 4, 1e-3);
  check_ok(context, bw_select_patch(context, mesh, point, 0.6, &round));
  check_near(bw_selection_area(round), acos(-1) / 2, 1e-3);
  check_selection(down);
  check_selection(round);
  check_ok(context, bw_select_nearest(context, mesh, point, 1, &nearest));
  for (int k = 0; k < 3; k++)
    check_near(mesh->node[3 * nearest->node[0] + k], 1 / sqrt(3), 1e-12);
  bw_release(down);
  bw_release(round);
  bw_release(nearest);
  bw_release(mesh);
}

static void selections_combine(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 2, 2, 2, 1);
  bw_selection *all = NULL, *rest = NULL, *both = NULL, *edge = NULL, *again = NULL;
  bw_selection *low = face_of(context, mesh, 0, 0), *side = face_of(context, mesh, 1, 0);
  check_ok(context, bw_select_all(context, mesh, &all));
  assert_int_equal(all->facet_count, mesh->facet_count);
  assert_int_equal(all->node_count, mesh->boundary_node_count);
  check_ok(context, bw_select_combine(context, all, low, BW_DIFFERENCE, &rest));
  check_near(bw_selection_area(rest), 5, 1e-14); /* the rim's facets stay whole */
  check_ok(context, bw_select_combine(context, low, side, BW_INTERSECTION, &edge));
  assert_int_equal(edge->node_count, 3);
  assert_int_equal(edge->facet_count, 0);
  check_ok(context, bw_select_combine(context, low, side, BW_UNION, &both));
  check_near(bw_selection_area(both), 2, 1e-14);
  check_ok(context, bw_select_combine(context, rest, low, BW_UNION, &again));
  assert_int_equal(again->facet_count, all->facet_count);
  check_selection(rest);
  check_selection(both);
  bw_selection *none = NULL;
  check_fails(context, BW_EMPTY, "the difference selects no boundary node",
              bw_select_combine(context, low, all, BW_DIFFERENCE, &none));
  uint8_t *mask = calloc((size_t)mesh->node_count, 1);
  for (int32_t i = 0; i < low->node_count; i++)
    mask[low->node[i]] = 1;
  bw_selection *masked = NULL;
  check_ok(context, bw_select_mask(context, mesh, NULL, mask, &masked));
  assert_int_equal(masked->facet_count, low->facet_count);
  free(mask);
  bw_release(masked);
  bw_release(all);
  bw_release(rest);
  bw_release(both);
  bw_release(edge);
  bw_release(again);
  bw_release(low);
  bw_release(side);
  bw_release(mesh);
}

/* The top of a box left unflat by rounding: every other node lies a hair above. */
static bw_mesh *unflat_box(bw_context *context, double hair) {
  bw_mesh *flat = box_mesh(context, 2, 1, 1, 8, 4, 4, 1), *mesh = NULL;
  double *x = malloc(3 * (size_t)flat->node_count * sizeof *x);
  assert_non_null(x);
  memcpy(x, flat->node, 3 * (size_t)flat->node_count * sizeof *x);
  for (int32_t i = 0; i < flat->node_count; i++) {
    double *at = x + 3 * (size_t)i;
    int column = (int)lround(4 * at[0]), row = (int)lround(4 * at[1]);
    if (at[2] == 1 && (column + row) % 2 == 1)
      at[2] += hair;
  }
  check_ok(context, bw_mesh_moved(context, flat, x, &mesh));
  free(x);
  bw_release(flat);
  return mesh;
}

static void a_selection_knows_the_face_it_misses(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = unflat_box(context, 1e-5), *flat = box_mesh(context, 2, 1, 1, 8, 4, 4, 1);
  bw_selection *on = NULL;
  const double top[3] = {0, 0, 1}, z[3] = {0, 0, 1}, high[3] = {2, 1, 1}, low[3] = {0, 0, 1};
  check_ok(context, bw_select_plane(context, mesh, top, z, 1e-6, &on));
  assert_int_equal(on->facet_count, 0);
  check_near(on->missed_area, 2, 1e-6);
  bw_release(on);
  check_ok(context, bw_select_box(context, mesh, low, high, &on));
  check_near(on->missed_area, 2, 1e-6);
  bw_release(on);
  check_ok(context, bw_select_plane(context, mesh, top, z, 1e-4, &on));
  check_near(bw_selection_area(on), 2, 1e-6);
  check_near(on->missed_area, 0, 0);
  bw_release(on);
  /* what is cut off on purpose is not missed */
  const double half[3] = {1.1, 0, 0}, x[3] = {1, 0, 0};
  check_ok(context, bw_select_half_space(context, flat, half, x, 0, &on));
  check_near(on->missed_area, 0, 0);
  bw_release(on);
  bw_release(flat);
  bw_release(mesh);
}

static void supports_need_facets_or_a_node_set(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = unflat_box(context, 1e-5);
  bw_model *model = some_model(context, mesh);
  bw_selection *on = NULL, *set = NULL, *both = NULL;
  const double top[3] = {0, 0, 1}, z[3] = {0, 0, 1}, force[3] = {1, 0, 0};
  const bool fixed[3] = {true, true, true};
  check_ok(context, bw_select_plane(context, mesh, top, z, 1e-6, &on));
  check_fails(context, BW_EMPTY, "23 nodes and no whole facet: it covers 0 of the 2 m2",
              bw_model_fix(context, model, on));
  check_fails(context, BW_EMPTY, "make it a node set", bw_model_slide(context, model, on, NULL));
  check_fails(context, BW_EMPTY, "no whole facet",
              bw_model_prescribe(context, model, on, fixed, NULL));
  check_fails(context, BW_EMPTY, "forces at nodes", bw_model_force(context, model, on, force));
  assert_int_equal(model->support_count + model->load_count, 0);
  check_ok(context, bw_select_node_set(context, on, &set));
  check_ok(context, bw_model_fix(context, model, set));
  check_ok(context, bw_select_combine(context, set, on, BW_INTERSECTION, &both));
  assert_true(both->node_set);
  bw_release(both);
  bw_release(set);
  bw_release(on);
  check_ok(context, bw_select_nearest(context, mesh, top, 1, &on));
  check_ok(context, bw_model_fix(context, model, on));
  bw_release(on);
  bw_release(model);
  bw_release(mesh);
}

/* Three nodes of the top are out of the tolerance, each with six facets of 1/32 m2. */
static void what_is_missed_is_reported(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *flat = box_mesh(context, 2, 1, 1, 8, 4, 4, 1), *mesh = NULL;
  double *x = malloc(3 * (size_t)flat->node_count * sizeof *x);
  assert_non_null(x);
  memcpy(x, flat->node, 3 * (size_t)flat->node_count * sizeof *x);
  for (int32_t i = 0; i < flat->node_count; i++) {
    double *at = x + 3 * (size_t)i;
    if (at[2] == 1 && at[1] == 0.5 && (at[0] == 0.5 || at[0] == 1 || at[0] == 1.5))
      at[2] -= 1e-5;
  }
  check_ok(context, bw_mesh_moved(context, flat, x, &mesh));
  bw_model *model = some_model(context, mesh);
  bw_selection *on = NULL;
  const double top[3] = {0, 0, 1}, z[3] = {0, 0, 1};
  check_ok(context, bw_select_plane(context, mesh, top, z, 1e-6, &on));
  bw_clear_warnings(context);
  check_ok(context, bw_model_pressure(context, model, on, 1));
  assert_null(bw_warning_at(context, 1));
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "m2 of the 2 m2 that lie along the border"));
  check_near(bw_selection_area(on), 2 - 18. / 32, 1e-12);
  bw_release(on);
  bw_release(model);
  bw_release(mesh);
  bw_release(flat);
  free(x);
}

static void empty_selections_say_where_the_body_is(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 1);
  bw_selection *none = NULL;
  double far_low[3] = {3, 0, 0}, far_high[3] = {4, 1, 1}, z[3] = {0, 0, 1}, above[3] = {0, 0, 1.5};
  check_fails(context, BW_EMPTY,
              "1 m away; the bounding box of the mesh is (0, 0, 0) to (2, 1, 1) m",
              bw_select_box(context, mesh, far_low, far_high, &none));
  check_fails(context, BW_EMPTY, "0.4 m away",
              bw_select_plane(context, mesh, above, z, 0.1, &none));
  check_fails(context, BW_EMPTY, "the nearest is node",
              bw_select_sphere(context, mesh, above, 0.4, &none));
  double odd[3] = {1, 1, 1};
  check_fails(context, BW_EMPTY, "54.74 degrees off",
              bw_select_normal_cone(context, mesh, odd, 0.1, &none));
  uint8_t *mask = calloc((size_t)mesh->node_count, 1);
  check_fails(context, BW_EMPTY, "the mask selects no boundary node",
              bw_select_mask(context, mesh, NULL, mask, &none));
  free(mask);
  check_fails(context, BW_INVALID, "min is above max along x",
              bw_select_box(context, mesh, far_high, far_low, &none));
  double zero[3] = {0, 0, 0}, nan[3] = {NAN, 0, 0};
  check_fails(context, BW_INVALID, "normal is (0, 0, 0)",
              bw_select_plane(context, mesh, zero, zero, 0.1, &none));
  check_fails(context, BW_INVALID, "not finite", bw_select_sphere(context, mesh, nan, 0.1, &none));
  check_fails(context, BW_INVALID, "13 nodes asked for, but there are 1 to 12",
              bw_select_nearest(context, mesh, zero, 13, &none));
  assert_null(none);
  bw_release(mesh);
}

check_main(check_test(shapes_select_what_lies_in_them), check_test(directions_select_sides),
           check_test(selections_combine), check_test(a_selection_knows_the_face_it_misses),
           check_test(supports_need_facets_or_a_node_set), check_test(what_is_missed_is_reported),
           check_test(empty_selections_say_where_the_body_is))
