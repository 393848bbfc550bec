/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Borders of supports, and what acts on points and lines. */
#include "helpers.h"

static const double pi = 3.14159265358979323846;

static bw_singular_places *places_of(bw_context *context, const bw_model *model) {
  bw_singular_places *places = NULL;
  check_ok(context, bw_singular_places_find(context, model, NULL, 0, &places));
  return places;
}

/* nu = 0.3: a fixed face of 90 degrees has 0.711, one that slides on a plane of symmetry nothing.
 */
static void borders_of_supports(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box_mesh(context, 2, 1, 1, 4, 2, 2, order);
    bw_selection *end = face_of(context, mesh, 0, 0);
    bw_model *fixed = some_model(context, mesh), *sliding = some_model(context, mesh);
    const bool held[3] = {true, false, false};
    const double none[3] = {0, 0, 0};
    check_ok(context, bw_model_fix(context, fixed, end));
    check_ok(context, bw_model_prescribe(context, sliding, end, held, none));
    bw_singular_places *places = places_of(context, fixed);
    assert_int_equal(places->count, 4);
    for (int32_t i = 0; i < 4; i++) {
      const bw_singular_place *place = &places->place[i];
      assert_int_equal(place->kind, BW_SINGULAR_SUPPORT);
      check_near(place->exponent, 0.7112, 1e-4);
      check_near(place->angle, pi / 2, 1e-12);
      check_near(place->length, 1, 1e-14);
      assert_int_equal(place->count, 3);
    }
    bw_release(places);
    places = places_of(context, sliding);
    assert_int_equal(places->count, 0);
    bw_release(places);
    bw_release(end);
    bw_release(fixed);
    bw_release(sliding);
    bw_release(mesh);
  }
}

/* Memory that runs out anywhere is reported, and nothing is lost. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 1);
  bw_selection *end = face_of(context, mesh, 0, 0), *point = NULL;
  bw_model *model = some_model(context, mesh);
  bw_singular_places *places = NULL;
  bw_array *force = NULL;
  const double corner[3] = {2, 0, 0};
  check_ok(context, bw_model_fix(context, model, end));
  check_ok(context, bw_select_nearest(context, mesh, corner, 1, &point));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &force));
  memset(force->data, 0, 3 * (size_t)mesh->node_count * sizeof(double));
  ((double *)force->data)[3 * point->node[0]] = 1;
  check_ok(context, bw_model_nodal_forces(context, model, force));
  bw_status status = BW_MEMORY;
  int64_t n = 0;
  while (status == BW_MEMORY) {
    bw_fail_allocation(++n, false);
    status = bw_singular_places_find(context, model, NULL, 0, &places);
    bw_fail_allocation(0, false);
  }
  assert_int_equal(status, BW_OK);
  assert_true(n > 40);
  assert_int_equal(places->count, 5);
  assert_int_equal(places->place[4].kind, BW_SINGULAR_POINT_LOAD);
  check_near(places->place[4].exponent, -1, 0);
  bw_release(places);
  bw_release(force);
  bw_release(point);
  bw_release(end);
  bw_release(model);
  bw_release(mesh);
}

check_main(check_test(borders_of_supports), check_test(memory_failures))
