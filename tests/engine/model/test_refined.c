/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refined meshes and models: nested, conforming, with supports and loads where they were, whatever
 * allocation fails. */
#include "helpers.h"

static uint8_t *some_levels(const bw_mesh *mesh, int every, int levels) {
  uint8_t *list = (uint8_t *)calloc((size_t)mesh->element_count, 1);
  for (int32_t e = 0; e < mesh->element_count; e += every)
    list[e] = (uint8_t)levels;
  return list;
}

static void nested_and_conforming(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box_mesh(context, 2, 1, 1, 3, 2, 2, order);
    uint8_t *levels = some_levels(mesh, 5, 4);
    double *volume = (double *)calloc((size_t)mesh->element_count, sizeof *volume);
    bw_refinement r;
    check_ok(context, bw_mesh_refine(context, mesh, levels, 2, 1000000, &r));
    assert_int_equal(r.mesh->order, 2);
    assert_int_equal(r.mesh->component_count, 1);
    check_near(bw_mesh_volume(r.mesh), 2, 1e-12);
    for (int32_t e = 0; e < r.mesh->element_count; e++) {
      int32_t parent = r.element_parent[e];
      volume[parent] += r.mesh->volume[e];
      if (levels[parent])
        assert_true(r.mesh->volume[e] <= mesh->volume[parent] / 16 * (1 + 1e-9));
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
      check_near(volume[e], mesh->volume[e], 1e-12);
    /* every node is where its coordinates in the parent say; the mesh before is straight */
    for (int32_t i = 0; i < r.mesh->node_count; i++)
      for (int k = 0; k < 3; k++) {
        const int32_t *own =
            mesh->element + (size_t)r.node_parent[i] * (size_t)mesh->nodes_per_element;
        double x = 0;
        for (int a = 0; a < 4; a++)
          x += r.node_weight[4 * i + a] * mesh->node[3 * own[a] + k];
        check_near(r.mesh->node[3 * i + k], x, 1e-13);
      }
    /* a conforming mesh of a box has no boundary facet but on its faces */
    for (int32_t f = 0; f < r.mesh->facet_count; f++) {
      const int32_t *old = mesh->facet + (size_t)r.facet_parent[f] * (size_t)mesh->nodes_per_facet;
      for (int k = 0; k < 3; k++) {
        double at = mesh->node[3 * old[0] + k];
        if (at == mesh->node[3 * old[1] + k] && at == mesh->node[3 * old[2] + k])
          for (int a = 0; a < 6; a++)
            assert_true(r.mesh->node[3 * r.mesh->facet[6 * (size_t)f + (size_t)a] + k] == at);
      }
    }
    bw_refinement_clear(&r);
    free(levels);
    free(volume);
    bw_release(mesh);
  }
}

static void refuses(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 1, 1, 1, 1, 1, 1, 2);
  uint8_t *levels = some_levels(mesh, 1, 3);
  bw_refinement r = {.mesh = NULL};
  assert_int_equal(bw_mesh_refine(context, mesh, levels, 1, 1000, &r), BW_INVALID);
  assert_int_equal(bw_mesh_refine(context, mesh, levels, 2, 1, &r), BW_INVALID);
  assert_int_equal(bw_mesh_refine(context, mesh, levels, 2, 20, &r), BW_LIMIT);
  assert_null(r.mesh);
  free(levels);
  bw_release(mesh);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *root = face_of(context, mesh, 0, 0), *tip = face_of(context, mesh, 0, 2);
  const bw_selection *also[1] = {tip};
  const double torque[3] = {1, 0, 0};
  bw_array *change = NULL;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &change));
  check_ok(context, bw_model_fix(context, model, root));
  check_ok(context, bw_model_torque(context, model, tip, torque, NULL));
  check_ok(context, bw_model_temperature(context, model, change, &(double){1e-5}));
  uint8_t *levels = some_levels(mesh, 3, 2);
  check_each_allocation(context, status, 1) {
    bw_refinement r = {.mesh = NULL};
    bw_model *refined = NULL;
    bw_selection *carried[1] = {NULL};
    status = bw_mesh_refine(context, mesh, levels, 2, 100000, &r);
    if (status == BW_OK)
      status = bw_model_refined(context, model, &r, r.mesh, 1, also, carried, &refined);
    bw_refinement_clear(&r);
    bw_release(carried[0]);
    bw_release(refined);
  }
  free(levels);
  bw_release(change);
  bw_release(tip);
  bw_release(root);
  bw_release(model);
  bw_release(mesh);
}

check_main(check_test(nested_and_conforming), check_test(refuses), check_test(no_memory))
