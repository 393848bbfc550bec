/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies laid down layer by layer against closed forms, and against regions of one static problem.
 */
#include "bodies.h"

#include "barwright/deposition.h"

static const double up[3] = {0, 0, 1};
static const double young = 200e9, poisson = 0.3, expansion = 12e-6, cooling = -500;

static bw_material *expanding(bw_context *context, double coefficient) {
  bw_material *material = NULL;
  const bw_isotropic constants = {
      .name = "test", .young = young, .poisson = poisson, .expansion = coefficient};
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  return material;
}

static bw_model *body(bw_context *context, const bw_mesh *mesh) {
  bw_material *material = expanding(context, expansion);
  bw_model *model = NULL;
  check_ok(context, bw_model_create(context, mesh, material, &model));
  bw_release(material);
  return model;
}

static void slide_plane(bw_context *context, bw_model *model, int axis, double at) {
  double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  bw_selection *face = NULL;
  point[axis] = at;
  normal[axis] = 1;
  check_ok(context, bw_select_plane(context, model->mesh, point, normal, 1e-9, &face));
  check_ok(context, bw_model_slide(context, model, face, normal));
  bw_release(face);
}

static void fix_bottom(bw_context *context, bw_model *model) {
  const double origin[3] = {0, 0, 0};
  bw_selection *face = NULL;
  check_ok(context, bw_select_plane(context, model->mesh, origin, up, 1e-9, &face));
  check_ok(context, bw_model_fix(context, model, face));
  bw_release(face);
}

/* Layers by height, all of them cooling alike. */
static bw_status deposit(bw_context *context, const bw_model *model, int32_t layers,
                         bw_deposition **deposition) {
  const bw_mesh *mesh = model->mesh;
  int32_t *layer = (int32_t *)calloc((size_t)mesh->element_count, sizeof *layer);
  double *change = numbers(mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    change[i] = cooling;
  check_ok(context, bw_deposition_layers(context, mesh, up, layers, layer));
  const bw_deposition_options options = {.layer_count = layers, .layer = layer, .change = change};
  bw_status status = bw_deposit(context, model, &options, deposition);
  free(layer);
  free(change);
  return status;
}

/* Sides that slide: every layer is strained in its plane as it is laid, and no other one feels it.
 */
static void between_walls(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 2, 1, 1, 4, 3, 5, order);
    bw_model *model = body(context, mesh);
    bw_deposition *d = NULL;
    for (int axis = 0; axis < 3; axis++)
      slide_plane(context, model, axis, 0);
    slide_plane(context, model, 0, 2);
    slide_plane(context, model, 1, 1);
    check_ok(context, deposit(context, model, 5, &d));
    const double expected = -young * expansion * cooling / (1 - poisson);
    assert_int_equal(d->layer_count, 5);
    assert_int_equal(d->postponed, 0);
    for (int64_t e = 0; e < mesh->element_count; e++)
      for (int k = 0; k < 6; k++)
        check_near(d->element_stress[6 * e + k], k < 2 ? expected : 0, 1e-9 * expected);
    bw_release(d);
    bw_release(model);
    bw_release(mesh);
  }
}

/* The second of two layers is the static problem of a body of which a region alone expands. */
static void two_layers(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 2, 1, 1, 5, 3, 4, 2);
  bw_model *model = body(context, mesh), *half = NULL;
  bw_material *parts[2] = {expanding(context, 0), expanding(context, expansion)}, *both = NULL;
  bw_deposition *d = NULL, *one = NULL;
  bw_static *second = NULL;
  const double up_to = cooling;
  double *change = numbers(mesh->node_count), *stress = numbers(6 * (int64_t)mesh->element_count);
  fix_bottom(context, model);
  check_ok(context, deposit(context, model, 2, &d));

  check_ok(context, bw_material_by_element(context, mesh->element_count, 2, d->layer,
                                           (const bw_material *const *)parts, &both));
  check_ok(context, bw_model_create(context, mesh, both, &half));
  fix_bottom(context, half);
  bw_array *field = NULL;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &field));
  for (int32_t i = 0; i < mesh->node_count; i++)
    ((double *)field->data)[i] = up_to;
  check_ok(context, bw_model_temperature(context, half, field, NULL));
  check_ok(context, bw_statics(context, half, NULL, NULL, &second));
  check_ok(context, bw_static_stress(context, second, false, stress));

  /* The first layer alone, laid on the same elements. */
  uint8_t *keep = (uint8_t *)calloc((size_t)mesh->element_count, 1);
  for (int64_t e = 0; e < mesh->element_count; e++)
    keep[e] = d->layer[e] == 0;
  bw_mesh *lower = NULL;
  check_ok(context, bw_mesh_subset(context, mesh, keep, &lower));
  bw_model *alone = body(context, lower);
  fix_bottom(context, alone);
  check_ok(context, deposit(context, alone, 1, &one));
  double largest = 0, off = 0;
  for (int64_t e = 0, at = 0; e < mesh->element_count; e++) {
    for (int k = 0; k < 6; k++) {
      double sum = stress[6 * e + k] + (keep[e] ? one->element_stress[6 * at + k] : 0);
      largest = fmax(largest, fabs(sum));
      off = fmax(off, fabs(sum - d->element_stress[6 * e + k]));
    }
    at += keep[e];
  }
  assert_true(largest > 1e8);
  check_near(off, 0, 1e-8 * largest);
  free(keep);
  free(change);
  free(stress);
  bw_release(field);
  bw_release(second);
  bw_release(half);
  bw_release(both);
  bw_release(parts[0]);
  bw_release(parts[1]);
  bw_release(one);
  bw_release(alone);
  bw_release(lower);
  bw_release(d);
  bw_release(model);
  bw_release(mesh);
}

/* In the middle of a wide free plate each layer shrinks as docs/theory/deposition.md says. */
static void free_plate(void **state) {
  bw_context *context = check_context(state);
  enum { LAYERS = 4 };
  const double t = 0.25, shrinkage = expansion * cooling, modulus = young / (1 - poisson);
  bw_mesh *mesh = body_box(context, 8, 8, 1, 16, 16, LAYERS, 2);
  bw_model *model = body(context, mesh);
  bw_deposition *d = NULL;
  double expected[LAYERS] = {0}, sum[LAYERS] = {0}, volume[LAYERS] = {0};
  check_ok(context, deposit(context, model, LAYERS, &d));
  for (int step = 0; step < LAYERS; step++) {
    double height = (step + 1) * t, mean = shrinkage * t / height,
           curvature = 6 * shrinkage * t * (height - t) / (height * height * height);
    for (int i = 0; i <= step; i++)
      expected[i] +=
          modulus * (mean + curvature * ((i + 0.5) * t - height / 2) - (i == step ? shrinkage : 0));
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    double x[3] = {0, 0, 0};
    for (int a = 0; a < 4; a++)
      for (int k = 0; k < 3; k++)
        x[k] += mesh->node[3 * mesh->element[10 * e + a] + k] / 4;
    if (fabs(x[0] - 4) > 1 || fabs(x[1] - 4) > 1)
      continue;
    int layer = (int)(x[2] / t);
    sum[layer] += mesh->volume[e] * d->element_stress[6 * e];
    volume[layer] += mesh->volume[e];
  }
  for (int i = 0; i < LAYERS; i++)
    check_near(sum[i] / volume[i], expected[i], 0.01 * expected[LAYERS - 1]);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    assert_true(d->reaction[i] == 0);
  bw_release(d);
  bw_release(model);
  bw_release(mesh);
}

/* One layer on a plate has no stress once the plate is gone, and has shrunk freely. */
static void released(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 2, 1, 1, 4, 2, 2, 2);
  bw_model *model = body(context, mesh), *loose = body(context, mesh);
  bw_deposition *d = NULL, *after = NULL;
  double most = 0, low[3] = {INFINITY, INFINITY, INFINITY},
         high[3] = {-INFINITY, -INFINITY, -INFINITY};
  fix_bottom(context, model);
  check_ok(context, deposit(context, model, 1, &d));
  check_ok(context, bw_deposition_release(context, d, loose, NULL, &after));
  for (int64_t i = 0; i < 6 * (int64_t)mesh->element_count; i++) {
    most = fmax(most, fabs(d->element_stress[i]));
    check_near(after->element_stress[i], 0, 1e-2);
  }
  assert_true(most > 1e8);
  /* The corners span a box that is smaller by the shrinkage; it may have turned a little. */
  double first[3], second[3], length = 0, before = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * (int64_t)i, *u = after->displacement + 3 * (int64_t)i;
    bool at_first = x[0] == 0 && x[1] == 0 && x[2] == 0,
         at_second = x[0] == 2 && x[1] == 1 && x[2] == 1;
    for (int k = 0; k < 3; k++) {
      if (at_first)
        first[k] = x[k] + u[k];
      if (at_second)
        second[k] = x[k] + u[k];
      low[k] = fmin(low[k], x[k]);
      high[k] = fmax(high[k], x[k]);
    }
  }
  for (int k = 0; k < 3; k++) {
    length += (second[k] - first[k]) * (second[k] - first[k]);
    before += (high[k] - low[k]) * (high[k] - low[k]);
  }
  check_near(sqrt(length / before) - 1, expansion * cooling, 1e-4 * -expansion * cooling);
  bw_release(after);
  bw_release(d);
  bw_release(loose);
  bw_release(model);
  bw_release(mesh);
}

/* A table's top is laid outwards from its legs, and what nothing carries is refused. */
static void what_carries(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *box = body_box(context, 6, 1, 3, 6, 1, 3, 1), *table = NULL, *loose = NULL;
  uint8_t *keep = (uint8_t *)calloc((size_t)box->element_count, 1);
  bw_deposition *d = NULL;
  for (int round = 0; round < 2; round++) {
    for (int64_t e = 0; e < box->element_count; e++) {
      double x = 0, z = 0;
      for (int a = 0; a < 4; a++) {
        x += box->node[3 * box->element[4 * e + a]] / 4;
        z += box->node[3 * box->element[4 * e + a] + 2] / 4;
      }
      /* a leg, a top, and a hanging end; or the top alone apart from a foot */
      keep[e] = round == 0 ? x < 1 || z > 2 || (x > 5 && z > 1) : (x < 1 && z < 1) || z > 2;
    }
    check_ok(context, bw_mesh_subset(context, box, keep, round == 0 ? &table : &loose));
  }
  bw_model *model = body(context, table), *apart = body(context, loose);
  fix_bottom(context, model);
  fix_bottom(context, apart);
  check_ok(context, deposit(context, model, 3, &d));
  assert_true(d->postponed > 0);
  check_near(d->postponed_volume, 1, 0.35); /* the hanging end, and elements cut by the border */
  assert_non_null(strstr(bw_warning_at(context, 0), "laid later than asked for"));
  bw_clear_warnings(context);
  bw_release(d);
  check_fails(context, BW_GEOMETRY, "cannot be laid", deposit(context, apart, 3, &d));
  free(keep);
  bw_release(apart);
  bw_release(model);
  bw_release(loose);
  bw_release(table);
  bw_release(box);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_model *model = body(context, mesh), *cold = NULL;
  bw_material *material = body_material(context);
  bw_deposition *d = NULL;
  bw_selection *all = NULL;
  const double prescribed[3] = {1e-3, 0, 0};
  const bool fixed[3] = {true, true, true};
  check_ok(context, bw_model_create(context, mesh, material, &cold));
  check_fails(context, BW_INVALID, "nothing expands", deposit(context, cold, 2, &d));
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_model_pressure(context, model, all, 1));
  check_fails(context, BW_INVALID, "1 load", deposit(context, model, 2, &d));
  bw_model_clear_loads(model);
  check_ok(context, bw_model_prescribe(context, model, all, fixed, prescribed));
  check_fails(context, BW_INVALID, "prescribes a displacement", deposit(context, model, 2, &d));
  bw_model_clear_supports(model);
  check_ok(context, bw_model_slide(context, model, all, NULL));
  check_fails(context, BW_UNSUPPORTED, "normals of its facets", deposit(context, model, 2, &d));
  bw_release(all);
  bw_release(material);
  bw_release(cold);
  bw_release(model);
  bw_release(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(between_walls), check_test(two_layers),
                                     check_test(free_plate),    check_test(released),
                                     check_test(what_carries),  check_test(refusals)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
