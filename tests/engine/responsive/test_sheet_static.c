/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear statics of sheets: patch tests, manufactured solutions with their orders, Cook's membrane,
 * Kirsch's hole, supports that do not hold, the same bits on any number of threads. */
#include <complex.h>
#undef I

#include "sheets.h"

/* ---- patch test ------------------------------------------------------------------------------ */

static double linear_x(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return 1e-3 * (0.3 + 1.1 * at[0] - 0.4 * at[1]);
}
static double linear_y(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return 1e-3 * (-0.2 + 0.7 * at[0] + 0.6 * at[1]);
}

static bw_material *turned(bw_context *context) {
  bw_orthotropic constants = {.name = "wood",
                              .young = {11e9, 0.9e9, 0.5e9},
                              .poisson = {0.35, 0.02, 0.4},
                              .shear = {0.05e9, 0.7e9, 0.8e9},
                              .density = 500};
  double c = cos(0.6), s = sin(0.6), rotation[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  bw_material *material, *rotated;
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  check_ok(context, bw_material_rotated(context, material, rotation, &rotated));
  bw_release(material);
  return rotated;
}

static void test_patch(void **state) {
  bw_context *context = check_context(state);
  bw_condition support[2] = {{.tag = -1, .component = 0, .function = linear_x},
                             {.tag = -1, .component = 1, .function = linear_y}};
  for (int order = 1; order <= 2; order++)
    for (int strain = 0; strain < 2; strain++)
      for (int wood = 0; wood < 2; wood++) {
        bw_material *material = wood ? turned(context) : isotropic(context, 2e11, 0.3, 0);
        bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 2, 1, 6, 4), 0.06);
        bw_sheet *sheet = sheet_on(context, mesh, material, 0.01, strain, 2, support);
        bw_plane_reuse reuse = {0};
        bw_lagged_factor_options options;
        bw_lagged_factor_options_default(&options);
        options.tolerance = 1e-12;
        check_ok(context, bw_sheet_static(context, sheet, &options, &reuse));
        int32_t nodes = mesh->topology->nodes->node_count;
        for (int32_t i = 0; i < nodes; i++) {
          check_near(sheet->displacement[2 * i], linear_x(NULL, mesh->point + 2 * i, 0), 1e-14);
          check_near(sheet->displacement[2 * i + 1], linear_y(NULL, mesh->point + 2 * i, 0), 1e-14);
        }
        double *stress = BW_NEW(context, double, 4 * nodes),
               *mises = BW_NEW(context, double, nodes);
        check_ok(context, bw_sheet_stress(context, sheet, stress, mises));
        /* Hooke's law in space, with the strain across that belongs to the case */
        double strain6[6] = {1.1e-3, 0.6e-3, 0, 0, 0, 0.3e-3}, expected[6];
        const double *c = material->elasticity;
        if (!strain)
          strain6[2] = -(c[12] * strain6[0] + c[13] * strain6[1] + c[17] * strain6[5]) / c[14];
        for (int i = 0; i < 6; i++) {
          expected[i] = 0;
          for (int j = 0; j < 6; j++)
            expected[i] += c[6 * i + j] * strain6[j];
        }
        double size = fabs(expected[0]) + fabs(expected[1]), error;
        for (int32_t i = 0; i < nodes; i++) {
          check_near(stress[4 * i], expected[0], 1e-9 * size);
          check_near(stress[4 * i + 1], expected[1], 1e-9 * size);
          check_near(stress[4 * i + 2], expected[5], 1e-9 * size);
          check_near(stress[4 * i + 3], expected[2], 1e-9 * size);
          check_near(mises[i], bw_von_mises(expected), 1e-9 * size);
        }
        check_ok(context, bw_sheet_error(context, sheet, &error));
        assert_true(error < 1e-9);
        bw_free(stress);
        bw_free(mises);
        bw_release(sheet);
        bw_release(mesh);
        bw_release(material);
      }
}

/* ---- manufactured solutions ------------------------------------------------------------------ */

/* Without body force: 2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi) with
 * phi = exp(z), psi = sin(z) (Kolosov, Muskhelishvili). */
typedef struct exact {
  double mu, kappa;
  int component;
} exact;

static double exact_value(void *data, const double at[2], double time) {
  const exact *x = data;
  double complex z = at[0] + at[1] * _Complex_I;
  double complex w = (x->kappa * cexp(z) - z * conj(cexp(z)) - conj(csin(z))) / (2 * x->mu);
  (void)time;
  return x->component ? cimag(w) : creal(w);
}

/* Errors in the displacement (L2) and in the stress (L2, element by element at the rule's best
 * order), relative. */
static void errors(bw_context *context, int order, int n, bool strain, double *of_u,
                   double *of_gradient) {
  double nu = 0.3, young = 5;
  exact x = {young / (2 * (1 + nu)), strain ? 3 - 4 * nu : (3 - nu) / (1 + nu), 0}, y = x;
  y.component = 1;
  bw_condition support[2] = {{.tag = -1, .component = 0, .function = exact_value, .data = &x},
                             {.tag = -1, .component = 1, .function = exact_value, .data = &y}};
  bw_material *material = isotropic(context, young, nu, 0);
  bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 1, 1, n, n), 0.1 / n);
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, strain, 2, support);
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  options.tolerance = 1e-11;
  check_ok(context, bw_sheet_static(context, sheet, &options, NULL));
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int count = bw_triangle_quadrature(6, point, weight), width = order == 1 ? 3 : 6;
  double e0 = 0, s0 = 0, e1 = 0, s1 = 0;
  for (int32_t e = 0; e < mesh->topology->element_count; e++)
    for (int q = 0; q < count; q++) {
      double p[6][2], g[6][2], value[6], u[2] = {0}, du[4] = {0}, at[2] = {0};
      const int32_t *node = mesh->topology->element + e * width;
      for (int a = 0; a < width; a++)
        memcpy(p[a], mesh->point + 2 * node[a], sizeof p[a]);
      double w = weight[q] * 0.5 * bw_triangle_gradient(order, p, point[q], g);
      bw_facet_shape(order, point[q], value);
      for (int a = 0; a < width; a++)
        for (int i = 0; i < 2; i++) {
          u[i] += value[a] * sheet->displacement[2 * node[a] + i];
          at[i] += value[a] * p[a][i];
          for (int k = 0; k < 2; k++)
            du[2 * i + k] += g[a][k] * sheet->displacement[2 * node[a] + i];
        }
      for (int i = 0; i < 2; i++) {
        exact *f = i ? &y : &x;
        double v = exact_value(f, at, 0), h = 1e-5;
        e0 += w * (u[i] - v) * (u[i] - v);
        s0 += w * v * v;
        for (int k = 0; k < 2; k++) {
          double plus[2] = {at[0], at[1]}, minus[2] = {at[0], at[1]};
          plus[k] += h;
          minus[k] -= h;
          double d = (exact_value(f, plus, 0) - exact_value(f, minus, 0)) / (2 * h);
          e1 += w * (du[2 * i + k] - d) * (du[2 * i + k] - d);
          s1 += w * d * d;
        }
      }
    }
  *of_u = sqrt(e0 / s0);
  *of_gradient = sqrt(e1 / s1);
  bw_release(sheet);
  bw_release(mesh);
  bw_release(material);
}

static void test_orders(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int strain = 0; strain < 2; strain++) {
      double coarse[2], fine[2];
      errors(context, order, 8, strain, &coarse[0], &coarse[1]);
      errors(context, order, 16, strain, &fine[0], &fine[1]);
      check_near(log2(coarse[0] / fine[0]), order + 1, 0.15);
      check_near(log2(coarse[1] / fine[1]), order, 0.15);
      assert_true(fine[0] < (order == 1 ? 2e-3 : 2e-5));
    }
}

/* ---- benchmarks ------------------------------------------------------------------------------ */

static void cook(double p[2]) {
  double x = p[0], y = p[1];
  p[0] = 48 * x;
  p[1] = 44 * x + y * (44 - 28 * x);
}

/* Every boundary edge of a mapped mesh is a segment of its own: conditions by place. */
static double only_right(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return at[0] > 48 - 1e-9 ? 1.0 / 16 : 0;
}

static void test_cook(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1, 1.0 / 3, 0);
  bw_plane_mesh *grid = rectangle(context, 2, 1, 1, 24, 24), *mesh;
  /* keep the rectangle's four segments, at Cook's corners */
  int32_t nodes = grid->topology->nodes->node_count;
  double *point = BW_NEW(context, double, 2 * nodes);
  double corner[8] = {0, 0, 48, 44, 48, 60, 0, 44};
  bw_outline *outline;
  for (int32_t i = 0; i < nodes; i++) {
    memcpy(point + 2 * i, grid->point + 2 * i, 2 * sizeof *point);
    cook(point + 2 * i);
  }
  check_ok(context, bw_outline_moved(context, grid->outline, corner, &outline));
  check_ok(context, bw_plane_mesh_moved(context, grid, outline, point, &mesh));
  bw_condition conditions[3] = {
      {.tag = LEFT, .component = 0},
      {.tag = LEFT, .component = 1},
      {.tag = RIGHT, .kind = BW_TRACTION, .component = 1, .function = only_right}};
  for (int strain = 0; strain < 2; strain++) {
    bw_sheet *sheet = sheet_on(context, mesh, material, 1, strain, 3, conditions);
    check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
    int32_t middle = node_at(mesh, 48, 52), top = node_at(mesh, 48, 60);
    check_near(sheet->displacement[2 * middle + 1], strain ? 21.522 : 23.966,
               0.005 * (strain ? 21.522 : 23.966));
    check_near(sheet->displacement[2 * top + 1], strain ? 22.584 : 25.17,
               0.005 * (strain ? 22.584 : 25.17));
    bw_release(sheet);
  }
  bw_free(point);
  bw_release(outline);
  bw_release(mesh);
  bw_release(grid);
  bw_release(material);
}

static void test_unconstrained(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9, 0.3, 0);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 1, 4, 4);
  bw_condition support[3] = {{.tag = BOTTOM, .component = 1},
                             {.tag = LEFT, .kind = BW_PRESSURE, .value = 5},
                             {.tag = LEFT, .component = 0}};
  bw_sheet *sheet = sheet_on(context, mesh, material, 1, false, 2, support);
  check_fails(context, BW_UNCONSTRAINED, "move along x",
              bw_sheet_static(context, sheet, NULL, NULL));
  bw_release(sheet);
  support[0].component = 0;
  sheet = sheet_on(context, mesh, material, 1, false, 1, support);
  check_fails(context, BW_UNCONSTRAINED, "free to", bw_sheet_static(context, sheet, NULL, NULL));
  bw_release(sheet);
  sheet = sheet_on(context, mesh, material, 1, false, 0, NULL);
  check_fails(context, BW_UNCONSTRAINED, "free to", bw_sheet_static(context, sheet, NULL, NULL));
  bw_release(sheet);
  /* uniform pressure on a square constrained at two sides: uniform stress */
  support[0].component = 1;
  support[1].tag = RIGHT;
  sheet = sheet_on(context, mesh, material, 2, false, 3, support);
  check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
  double stress[4 * 25];
  check_ok(context, bw_sheet_stress(context, sheet, stress, NULL));
  for (int i = 0; i < 25; i++) {
    check_near(stress[4 * i], -5, 1e-6);
    check_near(stress[4 * i + 1], 0, 1e-6);
  }
  bw_release(sheet);
  bw_sheet_section section = {material, 0, false};
  bw_sheet_description description = {.section_count = 1, .section = &section};
  check_fails(context, BW_INVALID, "thickness",
              bw_sheet_create(context, mesh, &description, &sheet));
  section.thickness = 1;
  description.condition_count = 1;
  description.condition = support;
  support[0].tag = 9;
  check_fails(context, BW_INVALID, "tag 10", bw_sheet_create(context, mesh, &description, &sheet));
  bw_release(mesh);
  bw_release(material);
}

/* Weight of a column: stress grows linearly from the top. */
static void test_gravity(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e9, 0, 1000);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = jittered(context, rectangle(context, order, 1, 3, 6, 18), 0.04);
    bw_condition support[2] = {{.tag = BOTTOM, .component = 0}, {.tag = BOTTOM, .component = 1}};
    bw_sheet_section section = {material, 0.2, false};
    bw_sheet_description description = {.section_count = 1,
                                        .section = &section,
                                        .condition_count = 2,
                                        .condition = support,
                                        .gravity = {0, -10}};
    bw_sheet *sheet;
    check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
    check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
    /* exact at the top: rho g h^2 / 2 E */
    check_near(sheet->displacement[2 * node_at(mesh, 0.5, 3) + 1], -1e4 * 9 / 2 / 1e9,
               order == 1 ? 5e-8 : 1e-12);
    bw_release(sheet);
    bw_release(mesh);
  }
  bw_release(material);
}

/* 1000 Pa over 1 MPa on the left, over 4 MPa on the right of x = 1. */
static double pulled_x(void *data, const double at[2], double time) {
  (void)data, (void)time;
  return fmin(at[0], 1) * 1e-3 + fmax(at[0] - 1, 0) * 0.25e-3;
}

/* Two materials side by side, pulled: the stress is the same in both, the stretch is each one's
 * own, and the estimate sees no error although a mean over both at their border would. */
static void test_regions(void **state) {
  bw_context *context = check_context(state);
  bw_material *soft = isotropic(context, 1e6, 0, 10), *stiff = isotropic(context, 4e6, 0, 30);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *grid = rectangle(context, order, 2, 1, 8, 4), *mesh;
    const bw_plane_topology *t = grid->topology;
    int width = order == 1 ? 3 : 6;
    int32_t *region = BW_NEW(context, int32_t, t->element_count);
    for (int32_t e = 0; e < t->element_count; e++) {
      double x = 0;
      for (int a = 0; a < 3; a++)
        x += grid->point[2 * t->element[e * width + a]] / 3;
      region[e] = x > 1;
    }
    check_ok(context, bw_plane_mesh_copy(context, order, t->nodes->node_count, grid->point,
                                         t->element_count, t->element, region, &mesh));
    bw_sheet_section section[2] = {{soft, 0.5, false}, {stiff, 0.5, false}};
    bw_condition conditions[2] = {{.tag = -1, .component = 0, .function = pulled_x},
                                  {.tag = -1, .component = 1}};
    bw_sheet_description description = {
        .section_count = 2, .section = section, .condition_count = 2, .condition = conditions};
    bw_sheet *sheet;
    check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
    check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
    int32_t nodes = mesh->topology->nodes->node_count;
    double *stress = BW_NEW(context, double, 4 * nodes), error;
    check_ok(context, bw_sheet_stress(context, sheet, stress, NULL));
    for (int32_t i = 0; i < nodes; i++) {
      check_near(sheet->displacement[2 * i], pulled_x(NULL, mesh->point + 2 * i, 0), 1e-9);
      check_near(stress[4 * i], 1e3, 1e-3);
    }
    check_ok(context, bw_sheet_error(context, sheet, &error));
    assert_true(error < 1e-6);
    /* of one material the same displacement of the border is no solution */
    bw_release(sheet);
    description.section_count = 1;
    check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
    check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
    check_ok(context, bw_sheet_error(context, sheet, &error));
    assert_true(error > 0.01);
    bw_release(sheet);
    bw_free(stress);
    bw_free(region);
    bw_release(mesh);
    bw_release(grid);
  }
  bw_release(soft);
  bw_release(stiff);
}

/* Tractions act on the thickness of the element beside: strips one above the other, of thicknesses
 * 1 and 3, pulled by the same force per area, stretch alike. */
static void test_thicknesses(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = isotropic(context, 1e6, 0, 10);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = in_two(context, rectangle(context, order, 2, 1, 6, 4), 0.5);
    const bw_plane_nodes *nodes = mesh->topology->nodes;
    bw_sheet_section section[2] = {{material, 1, false}, {material, 3, false}};
    bw_condition conditions[4] = {{.tag = LEFT, .component = 0},
                                  {.tag = BOTTOM, .component = 1},
                                  {.tag = RIGHT, .kind = BW_TRACTION, .value = 600},
                                  {.tag = RIGHT, .kind = BW_PRESSURE, .value = -400}};
    bw_sheet_description description = {
        .section_count = 2, .section = section, .condition_count = 4, .condition = conditions};
    bw_sheet *sheet;
    check_ok(context, bw_sheet_create(context, mesh, &description, &sheet));
    check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
    for (int32_t i = 0; i < nodes->node_count; i++) {
      check_near(sheet->displacement[2 * i], 1e-3 * mesh->point[2 * i], 1e-10);
      check_near(sheet->displacement[2 * i + 1], 0, 1e-10);
    }
    bw_release(sheet);
    bw_release(mesh);
  }
  bw_release(material);
}

/* Axes by element are those of a solid's elements. */
static void test_turned_material(void **state) {
  bw_context *context = check_context(state);
  bw_orthotropic spruce = {.name = "spruce",
                           .young = {11e9, 0.8e9, 0.5e9},
                           .poisson = {0.4, 0.02, 0.4},
                           .shear = {0.7e9, 0.7e9, 0.05e9},
                           .density = 440};
  bw_material *wood, *turned;
  bw_sheet *sheet;
  bw_plate *plate;
  int32_t group[16] = {0};
  double rotation[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  check_ok(context, bw_material_orthotropic(context, &spruce, &wood));
  check_ok(context, bw_material_rotated_by_element(context, wood, 16, 1, group, rotation, &turned));
  bw_plane_mesh *mesh = rectangle(context, 2, 2, 1, 2, 2);
  bw_sheet_section section = {turned, 1, false};
  bw_sheet_description description = {.section_count = 1, .section = &section};
  check_fails(context, BW_INVALID, "axes by element",
              bw_sheet_create(context, mesh, &description, &sheet));
  check_fails(context, BW_INVALID, "axes by element",
              bw_plate_create(context, mesh, turned, 0.01, &plate));
  bw_release(mesh);
  bw_release(turned);
  bw_release(wood);
}

static void at_rest(bw_context *context, bw_sheet *sheet) {
  check_ok(context, bw_sheet_static(context, sheet, NULL, NULL));
}

static void test_threads(void **state) {
  same_on_any_threads(check_context(state), 1e9, 1, 0.002, at_rest);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  bw_material *material = isotropic(context, 1e9, 0.3, 0);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 1, 3, 3);
  bw_condition support[2] = {{.tag = LEFT, .component = 0}, {.tag = LEFT, .component = 1}};
  bw_sheet_section section = {material, 1, false};
  bw_sheet_description description = {
      .section_count = 1, .section = &section, .condition_count = 2, .condition = support};
  check_each_allocation(context, status, 1) {
    bw_sheet *sheet = NULL;
    double error;
    status = bw_sheet_create(context, mesh, &description, &sheet);
    if (status == BW_OK)
      status = bw_sheet_static(context, sheet, NULL, NULL);
    if (status == BW_OK)
      status = bw_sheet_stress(context, sheet, NULL, NULL);
    if (status == BW_OK)
      status = bw_sheet_error(context, sheet, &error);
    bw_release(sheet);
  }
  bw_release(mesh);
  bw_release(material);
}

check_main(check_test(test_patch), check_test(test_orders), check_test(test_cook),
           check_test(test_unconstrained), check_test(test_gravity), check_test(test_regions),
           check_test(test_threads), check_test(test_memory), check_test(test_thicknesses),
           check_test(test_turned_material))
