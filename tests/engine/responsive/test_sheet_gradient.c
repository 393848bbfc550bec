/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The p-norm of stresses and its gradient by node positions, against central differences of the
 * whole analysis: straight and curved, plane stress and strain, gravity, traction, pressure. */
#include "sheets.h"

static double push(void *data, const double at[2], double time) {
  (void)data, (void)at, (void)time;
  return 40;
}

static double norm_of(bw_context *context, const bw_plane_mesh *mesh, bool strain, double p,
                      double *gradient) {
  double value;
  bw_material *material = isotropic(context, 1e4, 0.3, 30);
  bw_condition conditions[4] = {{.tag = LEFT, .component = 0},
                                {.tag = LEFT, .component = 1},
                                {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .value = 30},
                                {.tag = TOP, .kind = BW_PRESSURE, .function = push}};
  bw_sheet_section section[2] = {{material, 0.3, strain}, {material, 0.5, strain}};
  int32_t last = mesh->topology->region[mesh->topology->element_count - 1];
  bw_sheet_description description = {.section_count = last + 1,
                                      .section = section,
                                      .condition_count = 4,
                                      .condition = conditions,
                                      .gravity = {2, -9}};
  bw_sheet *sheet;
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  options.tolerance = 1e-13;
  check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
  check_ok(context, bw_sheet_static(context, sheet, &options, NULL));
  check_ok(context, bw_sheet_stress_gradient(context, sheet, p, &value, gradient));
  bw_release(sheet);
  bw_release(material);
  return value;
}

static void test_differences(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int kind = 0; kind < 3; kind++) {
      /* straight, curved, in plane strain and of two thicknesses */
      bool strain = kind == 2;
      bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 1.2, 1, 3, 3), 0.06);
      if (kind == 2) {
        mesh = in_two(context, mesh, 0.5);
        assert_int_equal(mesh->topology->region[mesh->topology->element_count - 1], 1);
      }
      int32_t size = 2 * mesh->topology->nodes->node_count;
      double *gradient = BW_NEW(context, double, size), *point = BW_NEW(context, double, size);
      double p = strain ? 8 : 3, largest = 0, h = 1e-5;
      /* inner nodes move with the outline as it is; mid-edge nodes go off their chords */
      const bw_plane_nodes *nodes = mesh->topology->nodes;
      if (order == 2 && kind > 0) {
        mesh = bowed(context, mesh, 0.02);
        nodes = mesh->topology->nodes;
      }
      double value = norm_of(context, mesh, strain, p, gradient);
      assert_true(value > 0);
      for (int32_t i = 0; i < size; i++)
        largest = fmax(largest, fabs(gradient[i]));
      for (int32_t i = 0; i < size; i++) {
        double around[2];
        if (nodes->segment[i / 2] >= 0)
          continue;
        for (int s = 0; s < 2; s++) {
          bw_plane_mesh *other;
          memcpy(point, mesh->point, (size_t)size * sizeof *point);
          point[i] += s ? h : -h;
          check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &other));
          around[s] = norm_of(context, other, strain, p, NULL);
          bw_release(other);
        }
        check_near(gradient[i], (around[1] - around[0]) / (2 * h), 1e-6 * largest);
      }
      /* the outline's corners: right and top sides with their loads move */
      for (int32_t k = 0; k < 8; k++) {
        double around[2], sum = 0;
        for (int32_t i = 0; i < nodes->node_count; i++)
          if (nodes->segment[i] >= 0) {
            double w[4];
            bw_outline_basis(mesh->outline, nodes->segment[i], nodes->parameter[i], w);
            const bw_segment *segment = &mesh->outline->segment[nodes->segment[i]];
            for (int end = 0; end < 2; end++)
              if (segment->point[3 * end] == k / 2)
                sum += w[3 * end] * gradient[2 * i + k % 2];
          }
        for (int s = 0; s < 2; s++) {
          double corner[8];
          bw_outline *outline;
          bw_plane_mesh *other;
          memcpy(corner, mesh->outline->point, sizeof corner);
          corner[k] += s ? h : -h;
          check_ok(context, bw_outline_moved(context, mesh->outline, corner, &outline));
          memcpy(point, mesh->point, (size_t)size * sizeof *point);
          for (int32_t i = 0; i < nodes->node_count; i++)
            if (nodes->segment[i] >= 0)
              bw_outline_evaluate(outline, nodes->segment[i], nodes->parameter[i], point + 2 * i,
                                  NULL, NULL);
          check_ok(context, bw_plane_mesh_moved(context, mesh, outline, point, &other));
          around[s] = norm_of(context, other, strain, p, NULL);
          bw_release(other);
          bw_release(outline);
        }
        check_near(sum, (around[1] - around[0]) / (2 * h), 1e-6 * largest);
      }
      bw_free(gradient);
      bw_free(point);
      bw_release(mesh);
    }
}

/* It lies between the mean and the largest stress and grows with p. */
static void test_bounds(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 1, 1.2, 1, 8, 8);
  double before = 0, at[5] = {1, 4, 16, 64, 256};
  for (int k = 0; k < 5; k++) {
    double now = norm_of(context, mesh, false, at[k], NULL);
    assert_true(now > before);
    before = now;
  }
  bw_sheet *sheet;
  bw_material *material = isotropic(context, 1, 0, 0);
  bw_condition support = {.tag = LEFT};
  sheet = sheet_on(context, mesh, material, 1, false, 1, &support);
  check_fails(context, BW_INVALID, "linear statics",
              bw_sheet_stress_gradient(context, sheet, 4, &before, NULL));
  check_fails(context, BW_INVALID, "exponent",
              bw_sheet_stress_gradient(context, sheet, 0, &before, NULL));
  bw_release(sheet);
  bw_release(material);
  bw_release(mesh);
}

check_main(check_test(test_differences), check_test(test_bounds))
