/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Thermal expansion and prescribed fields: free expansion makes no stress, a clamped bar makes
 * -E alpha dT, and a linear prescribed field comes back exactly. */
#include "check.h"

static bw_mesh *bar(bw_context *context, int order) {
  double low[3] = {0, 0, 0}, high[3] = {0.4, 0.1, 0.1};
  int cells[3] = {8, 2, 2};
  bw_mesh *mesh;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static bw_material *metal(bw_context *context) {
  bw_isotropic constants = {.name = "metal", .young = 70e9, .poisson = 0.33, .density = 2700};
  bw_material *material;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static double largest(const double *values, size_t count) {
  double max = 0;
  for (size_t i = 0; i < count; i++)
    max = fmax(max, fabs(values[i]));
  return max;
}

static bw_static *heated(bw_context *context, int order, bool clamped) {
  bw_mesh *mesh = bar(context, order);
  bw_material *material = metal(context);
  bw_model *model;
  bw_array *change;
  bw_static *result;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &change));
  for (int32_t i = 0; i < mesh->node_count; i++)
    ((double *)change->data)[i] = clamped ? 50 : 50 + 300 * mesh->node[3 * i];
  check_ok(context, bw_model_temperature(context, model, change, &(double){23e-6}));
  if (clamped)
    for (int end = 0; end < 2; end++) {
      double point[3] = {0.4 * end, 0, 0}, normal[3] = {1, 0, 0};
      bw_selection *on;
      check_ok(context, bw_select_plane(context, mesh, point, normal, 1e-9, &on));
      check_ok(context, bw_model_slide(context, model, on, normal));
      bw_release(on);
    }
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  bw_release(change);
  bw_release(model);
  bw_release(mesh);
  bw_release(material);
  return result;
}

/* A temperature that is linear in space makes a free body bend without stress; tet10 can follow. */
static void test_free_expansion(void **state) {
  bw_context *context = check_context(state);
  bw_static *result = heated(context, 2, false);
  size_t count = 6 * (size_t)result->model->mesh->node_count;
  double *stress = BW_NEW(context, double, count);
  check_ok(context, bw_static_stress(context, result, true, stress));
  check_near(largest(stress, count), 0, 1e-8 * 70e9 * 23e-6 * 170);
  bw_free(stress);
  bw_release(result);
}

static void test_clamped(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int on_nodes = 0; on_nodes < 2; on_nodes++) {
      bw_static *result = heated(context, order, true);
      const bw_mesh *mesh = result->model->mesh;
      int32_t rows = on_nodes ? mesh->node_count : mesh->element_count;
      double *stress = BW_NEW(context, double, 6 * (size_t)rows);
      check_ok(context, bw_static_stress(context, result, on_nodes, stress));
      for (int32_t i = 0; i < rows; i++) {
        check_near(stress[6 * i], -70e9 * 23e-6 * 50, 1.0);
        check_near(stress[6 * i + 1], 0, 1.0);
      }
      bw_free(stress);
      bw_release(result);
    }
}

static void test_prescribed_field(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = bar(context, 2);
  bw_material *material = metal(context);
  bw_model *model;
  bw_selection *all;
  bw_array *field, *wrong;
  bw_static *result;
  const bool fixed[3] = {true, true, true};
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &field));
  double *u = (double *)field->data;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * (size_t)i;
    u[3 * i] = 1e-3 * (2 * x[0] + x[1]);
    u[3 * i + 1] = 1e-3 * (x[2] - x[0]);
    u[3 * i + 2] = 1e-3 * (3 * x[1] + x[2]);
  }
  check_ok(context, bw_model_prescribe_field(context, model, all, fixed, field));
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    check_near(result->displacement[i], u[i], 1e-15);
  check_ok(context, bw_array_create(context, BW_F64, 3, 3, &wrong));
  check_fails(context, BW_INVALID, "rows",
              bw_model_prescribe_field(context, model, all, fixed, wrong));
  check_fails(context, BW_INVALID, "columns",
              bw_model_temperature(context, model, field, &(double){1e-5}));
  bw_release(wrong);
  bw_release(result);
  bw_release(field);
  bw_release(all);
  bw_release(model);
  bw_release(mesh);
  bw_release(material);
}

/* Of two regions one expands, then none: a warning and an error name region and material. */
static void test_without_expansion(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *plain = bar(context, 1), *mesh = NULL;
  bw_material *still = metal(context), *steel = NULL, *mixed = NULL;
  bw_model *model = NULL, *inert = NULL;
  bw_array *change = NULL;
  bw_mesh_region named[2] = {{.tag = 1, .name = {"core"}}, {.tag = 2, .name = {"skin"}}};
  int32_t *of_element = BW_NEW0(context, int32_t, plain->element_count);
  of_element[0] = 1;
  check_ok(context,
           bw_mesh_with_regions(context, plain, &(bw_mesh_regions){2, named, of_element}, &mesh));
  check_ok(context, bw_material_named(context, "steel", &steel));
  check_ok(context,
           bw_material_by_region(context, mesh, (const bw_material *[]){steel, still}, &mixed));
  check_ok(context, bw_model_create(context, mesh, mixed, &model));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &change));
  memset(change->data, 0, (size_t)mesh->node_count * sizeof(double));
  bw_clear_warnings(context);
  check_ok(context, bw_model_create(context, mesh, still, &inert));
  check_ok(context, bw_model_temperature(context, inert, change, NULL)); /* nothing changes */
  for (int32_t i = 0; i < mesh->node_count; i++)
    ((double *)change->data)[i] = 100;
  check_fails(context, BW_INVALID, "the material metal of region 'core' has no coefficient",
              bw_model_temperature(context, inert, change, NULL));
  check_ok(context, bw_model_temperature(context, inert, change, &(double){0}));
  assert_null(bw_warning_at(context, 0));
  check_ok(context, bw_model_temperature(context, model, change, NULL));
  assert_non_null(bw_warning_at(context, 0));
  assert_non_null(strstr(bw_warning_at(context, 0), "the material metal of region 'skin' has no"));
  assert_null(bw_warning_at(context, 1));
  check_fails(context, BW_INVALID, "the material metal of region 'core' has no coefficient",
              bw_model_set_material(context, model, -1, still));
  assert_true(bw_material_of(model->material, 1)->expansion == 12e-6);
  check_ok(context, bw_model_set_material(context, model, -1, steel));
  bw_clear_warnings(context);
  bw_free(of_element);
  bw_release(change);
  bw_release(inert);
  bw_release(model);
  bw_release(mixed);
  bw_release(steel);
  bw_release(still);
  bw_release(mesh);
  bw_release(plain);
}

check_main(check_test(test_free_expansion), check_test(test_clamped),
           check_test(test_prescribed_field), check_test(test_without_expansion))
