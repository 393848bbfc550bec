/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Energies of solids: patch test, derivatives against differences, invariance, threads, shapes. */
#include "nonlinear/solids.h"

static const double affine[9] = {0.1, 0.05, -0.02, 0.03, -0.08, 0.04, 0, 0.06, 0.12};

/* An L of two materials with every law at points of its own and fibres, one cell partly full. */
static bw_solid *ell(bw_context *context, int level) {
  static const int32_t cells[3] = {3, 2, 2}, material[12] = {1, 2, 1, 2, 0, 0, 1, 1, 2, 0, 0, 1};
  double fraction[12];
  for (int i = 0; i < 12; i++)
    fraction[i] = i == 1 ? 0.3 : 1;
  bw_solid_material *both[2] = {solids_mixed(context, BW_LAWS, level, 2, 1),
                                solids_simple(context, BW_NEO_HOOKEAN)};
  return solids_create(context, cells, 2, both, material, fraction);
}

/* An affine displacement: the energy is the volume times that at a point, forces act on the
 * boundary only, where they are those of the constant stress. */
static void test_patch(void **state) {
  bw_context *context = check_context(state);
  static const int32_t cells[3] = {3, 3, 3};
  for (int law = 0; law < BW_LAWS; law++)
    for (int level = 0; level < 3; level++) {
      bw_solid_material *one = solids_simple(context, (bw_law)law);
      double mu = one->mu[0], lambda = one->lambda[0];
      if (level > 0) { /* the same at the points of a finer rule */
        bw_rule *rule = NULL;
        uint8_t laws[64];
        double m[64], l[64];
        check_ok(context, bw_rule_create(context, level, &rule));
        for (int q = 0; q < rule->count; q++) {
          laws[q] = (uint8_t)law;
          m[q] = mu;
          l[q] = lambda;
        }
        bw_release(one);
        check_ok(context,
                 bw_solid_material_points(context, "", rule, 0, laws, m, l, 0, NULL, NULL, &one));
        bw_release(rule);
      }
      bw_solid *solid = solids_create(context, cells, 1, &one, NULL, NULL);
      const bw_grid *grid = solid->grid;
      double *u = solids_displacement(solid, affine, 0), *g = solids_numbers(3 * grid->node_count);
      double f[9], point, p[9], energy;
      bw_solid_shape shape;
      for (int i = 0; i < 9; i++)
        f[i] = affine[i] + (i % 4 == 0);
      assert_true(bw_law_evaluate((bw_law)law, mu, lambda, f, false, &point, p, NULL));
      check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, g, NULL, &shape));
      check_near(energy, point * bw_grid_volume(grid), 1e-14);
      for (int32_t i = 0; i < grid->node_count; i++) {
        double x[3], expected[3] = {0};
        bw_grid_position(grid, i, x);
        /* the box's faces: P N times the node's share of the area */
        for (int d = 0; d < 3; d++) {
          double along = (x[d] - grid->origin[d]) / grid->spacing[d], area = 1;
          double side = along < 0.5 ? -1 : along > 2.5 ? 1 : 0;
          for (int k = 0; k < 3; k++) {
            double other = (x[k] - grid->origin[k]) / grid->spacing[k];
            if (k != d)
              area *= grid->spacing[k] * (other < 0.5 || other > 2.5 ? 0.5 : 1);
          }
          for (int k = 0; k < 3; k++)
            expected[k] += side * area * p[3 * k + d];
        }
        for (int k = 0; k < 3; k++)
          check_near(g[3 * i + k], expected[k], 1e-15);
      }
      assert_true(shape.defined && shape.inverted == 0);
      free(u);
      free(g);
      bw_release(solid);
    }
}

/* One element by plain loops over its points: energy, forces (24), stiffness (24 x 24). */
static double plain_element(const bw_solid *solid, int32_t e, const double *u, bool project,
                            double *force, double *matrix) {
  const bw_grid *grid = solid->grid;
  const bw_solid_material *m = solid->material_table->material[grid->material[e]];
  double volume = grid->fraction[e] * grid->spacing[0] * grid->spacing[1] * grid->spacing[2];
  double sum = 0;
  memset(force, 0, 24 * sizeof *force);
  memset(matrix, 0, 576 * sizeof *matrix);
  for (int32_t q = 0; q < m->rule->count; q++) {
    double g[8][3], f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, energy, p[9], a[81];
    double w = volume * m->rule->weight[q];
    for (int c = 0; c < 8; c++)
      for (int k = 0; k < 3; k++)
        g[c][k] = m->rule->gradient[24 * q + 3 * c + k] / grid->spacing[k];
    for (int c = 0; c < 8; c++)
      for (int i = 0; i < 9; i++)
        f[i] += u[3 * grid->element[8 * e + c] + i / 3] * g[c][i % 3];
    assert_true(
        bw_law_evaluate((bw_law)m->law[q], m->mu[q], m->lambda[q], f, project, &energy, p, a));
    for (int k = q * m->fibre_count; k < (q + 1) * m->fibre_count; k++)
      bw_fibre_add(m->fibre_stiffness[k], m->fibre + 3 * (size_t)k, f, project, &energy, p, a);
    sum += w * energy;
    for (int i = 0; i < 24; i++) {
      force[i] += w * bw_dot(p + 3 * (size_t)(i % 3), g[i / 3]);
      for (int k = 0; k < 24; k++)
        for (int j = 0; j < 3; j++)
          matrix[24 * i + k] +=
              w * g[i / 3][j] *
              bw_dot(a + 9 * (size_t)(3 * (i % 3) + j) + 3 * (size_t)(k % 3), g[k / 3]);
    }
  }
  return sum;
}

/* The whole is the sum of what plain loops find, entry by entry. */
static void test_plain_sums(void **state) {
  bw_context *context = check_context(state);
  for (int level = 0; level < 3; level++)
    for (int project = 0; project < 2; project++) {
      bw_solid *solid = ell(context, level);
      const bw_block_pattern *pattern = solid->pattern;
      int64_t n = 3 * (int64_t)solid->grid->node_count;
      double *u = solids_displacement(solid, affine, 0.05), *g = solids_numbers(n);
      double *values = solids_numbers(9 * pattern->block_count), *all = solids_numbers(n * n);
      double *expected = solids_numbers(n), force[24], matrix[576], energy, sum = 0, size = 0;
      bw_solid_shape shape;
      check_ok(context, bw_solid_evaluate(context, solid, u, project, &energy, g, values, &shape));
      for (int32_t e = 0; e < solid->grid->element_count; e++) {
        const int32_t *node = solid->grid->element + 8 * (size_t)e;
        sum += plain_element(solid, e, u, project, force, matrix);
        for (int i = 0; i < 24; i++) {
          expected[3 * node[i / 3] + i % 3] += force[i];
          for (int k = 0; k < 24; k++)
            all[n * (3 * node[i / 3] + i % 3) + 3 * node[k / 3] + k % 3] += matrix[24 * i + k];
        }
      }
      check_near(energy, sum, 1e-14 * sum);
      for (int64_t i = 0; i < n; i++) {
        check_near(g[i], expected[i], 1e-15);
        size = fmax(size, all[(n + 1) * i]);
      }
      for (int32_t i = 0; i < pattern->node_count; i++)
        for (int64_t block = pattern->start[i]; block < pattern->start[i + 1]; block++)
          for (int k = 0; k < 9; k++)
            check_near(values[9 * block + k],
                       all[n * (3 * i + k / 3) + 3 * pattern->column[block] + k % 3], 1e-13 * size);
      free(u), free(g), free(values), free(all), free(expected);
      bw_release(solid);
    }
}

/* Energy, gradient and second derivatives against central differences. */
static void test_derivatives(void **state) {
  bw_context *context = check_context(state);
  for (int level = 0; level < 3; level++) {
    bw_solid *solid = ell(context, level);
    const bw_block_pattern *pattern = solid->pattern;
    int64_t n = 3 * (int64_t)solid->grid->node_count;
    double *u = solids_displacement(solid, affine, 0.03), *g = solids_numbers(n);
    double *values = solids_numbers(9 * pattern->block_count), *x = solids_numbers(n);
    double *product = solids_numbers(n), *more = solids_numbers(n), *less = solids_numbers(n);
    double energy, up, down, along = 0, size = 0, step = 1e-6;
    bw_solid_shape shape;
    bw_random random;
    bw_random_seed(&random, 9);
    check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, g, values, &shape));
    assert_true(shape.defined);
    for (int64_t i = 0; i < n; i++)
      x[i] = 0.1 * bw_random_normal(&random);
    check_ok(context, bw_block_multiply(context, pattern, values, 9, 3, 1, x, product));
    for (int64_t i = 0; i < n; i++) {
      along += g[i] * x[i];
      size = fmax(size, fabs(product[i]));
      u[i] += step * x[i];
    }
    check_ok(context, bw_solid_evaluate(context, solid, u, false, &up, more, NULL, &shape));
    for (int64_t i = 0; i < n; i++)
      u[i] -= 2 * step * x[i];
    check_ok(context, bw_solid_evaluate(context, solid, u, false, &down, less, NULL, &shape));
    check_near((up - down) / (2 * step), along, 1e-8 * fabs(along) + 1e-11);
    for (int64_t i = 0; i < n; i++)
      check_near((more[i] - less[i]) / (2 * step), product[i], 1e-7 * size);
    free(u), free(g), free(values), free(x), free(product), free(more), free(less);
    bw_release(solid);
  }
}

/* The energy does not feel a rotation of the whole, and the forces turn with it. */
static void test_rotation(void **state) {
  bw_context *context = check_context(state);
  bw_solid *solid = ell(context, 1);
  int64_t nodes = solid->grid->node_count;
  double *u = solids_displacement(solid, affine, 0.03), *turned = solids_numbers(3 * nodes);
  double *g = solids_numbers(3 * nodes), *g_turned = solids_numbers(3 * nodes), energy, other;
  double c = cos(1.1), s = sin(1.1);
  const double r[9] = {c, -s, 0, s, c, 0, 0, 0, 1}, shift[3] = {1, -2, 0.5};
  bw_solid_shape shape;
  for (int32_t i = 0; i < nodes; i++) {
    double x[3], y[3];
    bw_grid_position(solid->grid, i, x);
    for (int d = 0; d < 3; d++)
      y[d] = x[d] + u[3 * i + d];
    for (int d = 0; d < 3; d++)
      turned[3 * i + d] = bw_dot(r + 3 * (size_t)d, y) + shift[d] - x[d];
  }
  check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, g, NULL, &shape));
  check_ok(context,
           bw_solid_evaluate(context, solid, turned, false, &other, g_turned, NULL, &shape));
  check_near(other, energy, 1e-13 * energy);
  for (int32_t i = 0; i < nodes; i++)
    for (int d = 0; d < 3; d++)
      check_near(g_turned[3 * i + d], bw_dot(r + 3 * (size_t)d, g + 3 * i), 1e-14);
  free(u), free(turned), free(g), free(g_turned);
  bw_release(solid);
}

/* The same bits for any number of threads, with windows of elements that wrap around the ring. */
static void test_threads(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {9, 31, 13};
  int32_t material[9 * 31 * 13];
  for (int i = 0; i < 9 * 31 * 13; i++)
    material[i] = i % 7 == 3 ? 0 : i % 5 == 1 ? 2 : 1;
  bw_solid_material *both[2] = {solids_mixed(context, BW_COROTATED, 1, 1, 1),
                                solids_simple(context, BW_NEO_HOOKEAN)};
  bw_solid *solid = solids_create(context, cells, 2, both, material, NULL);
  int64_t n = 3 * (int64_t)solid->grid->node_count, m = 9 * solid->pattern->block_count;
  double *u = solids_displacement(solid, affine, 0.01), energy[2];
  double *g[2] = {solids_numbers(n), solids_numbers(n)};
  double *values[2] = {solids_numbers(m), solids_numbers(m)}, *x = solids_numbers(n);
  double *y = solids_numbers(n), *z = solids_numbers(n);
  double *blocks = solids_numbers(3 * n);
  bw_solid_linear *linear = NULL;
  bw_solid_shape shape[2];
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_set_threads(context, 1 + 3 * i));
    check_ok(context,
             bw_solid_evaluate(context, solid, u, true, &energy[i], g[i], values[i], &shape[i]));
  }
  assert_true(energy[0] == energy[1]);
  assert_memory_equal(g[0], g[1], (size_t)n * sizeof(double));
  assert_memory_equal(values[0], values[1], (size_t)m * sizeof(double));
  assert_true(shape[0].worst == shape[1].worst && shape[0].min_ratio == shape[1].min_ratio);
  /* energy and gradient alone are the same, and so are products without the matrix */
  check_ok(context, bw_solid_evaluate(context, solid, u, true, &energy[1], NULL, NULL, &shape[1]));
  assert_true(energy[0] == energy[1]);
  check_ok(context, bw_solid_linear_create(context, solid, &linear));
  check_ok(context, bw_solid_linear_set(context, linear, u, true));
  for (int64_t i = 0; i < n; i++)
    x[i] = sin(1.0 + (double)i);
  check_ok(context, bw_solid_linear_multiply(context, linear, x, y));
  check_ok(context, bw_block_multiply(context, solid->pattern, values[0], 9, 3, 1, x, z));
  for (int64_t i = 0; i < n; i++)
    check_near(y[i], z[i], 1e-13);
  check_ok(context, bw_set_threads(context, 1));
  check_ok(context, bw_solid_linear_multiply(context, linear, x, z));
  assert_memory_equal(y, z, (size_t)n * sizeof(double));
  check_ok(context, bw_solid_linear_diagonal(context, linear, blocks));
  for (int32_t i = 0; i < solid->pattern->node_count; i++)
    assert_memory_equal(blocks + 9 * i, values[0] + 9 * (solid->pattern->start[i + 1] - 1),
                        9 * sizeof(double));
  bw_solid_linear_destroy(linear);
  free(u), free(g[0]), free(g[1]), free(values[0]), free(values[1]), free(x), free(y), free(z);
  free(blocks);
  bw_release(solid);
}

/* x . K x >= 0 for a projected matrix however the body is bent; the matrix itself is indefinite. */
static void test_projected(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {3, 3, 3};
  static const double squeezed[9] = {-0.4, 0, 0, 0, -0.4, 0, 0, 0, -0.3};
  for (int law = 0; law < BW_LAWS; law++) {
    bw_solid_material *one = solids_simple(context, (bw_law)law);
    bw_solid *solid = solids_create(context, cells, 1, &one, NULL, NULL);
    int64_t n = 3 * (int64_t)solid->grid->node_count;
    double *u = solids_displacement(solid, squeezed, 0.02), *x = solids_numbers(n), energy;
    double *y = solids_numbers(n), *values = solids_numbers(9 * solid->pattern->block_count);
    bw_random random;
    bw_solid_shape shape;
    bw_random_seed(&random, 1);
    for (int project = 0; project < 2; project++) {
      double min = 0;
      check_ok(context,
               bw_solid_evaluate(context, solid, u, project, &energy, NULL, values, &shape));
      for (int k = 0; k < 60; k++) { /* Rayleigh quotients, drawn to the low end */
        double xy = 0, xx = 0;
        for (int64_t i = 0; i < n && k == 0; i++)
          x[i] = bw_random_normal(&random);
        check_ok(context, bw_block_multiply(context, solid->pattern, values, 9, 3, 1, x, y));
        for (int64_t i = 0; i < n; i++) {
          xy += x[i] * y[i];
          xx += x[i] * x[i];
        }
        min = fmin(min, xy / xx);
        for (int64_t i = 0; i < n; i++)
          x[i] = (x[i] - y[i] / 6) / sqrt(xx);
      }
      if (project)
        assert_true(min > -1e-12);
      else
        assert_true(min < -1e-4);
    }
    free(u), free(x), free(y), free(values);
    bw_release(solid);
  }
}

/* A point that stands for void may turn inside out: with the same material at all points the
 * element counts as inverted. */
static void test_empty(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {1, 1, 1};
  for (int empty = 0; empty < 2; empty++) {
    bw_rule *rule = NULL;
    bw_solid_material *one = NULL;
    uint8_t law[8];
    double mu[8], lambda[8], u[24] = {0}, energy;
    check_ok(context, bw_rule_create(context, 1, &rule));
    for (int q = 0; q < 8; q++) {
      bool last = q == 7 && empty;
      law[q] = last ? BW_ST_VENANT_KIRCHHOFF : BW_FIXED_COROTATED;
      mu[q] = last ? 1e-3 : 1;
      lambda[q] = last ? 0 : 1;
    }
    check_ok(context,
             bw_solid_material_points(context, "", rule, 0, law, mu, lambda, 0, NULL, NULL, &one));
    assert_true((one->empty != NULL) == (empty == 1));
    bw_solid *solid = solids_create(context, cells, 1, &one, NULL, NULL);
    for (int d = 0; d < 3; d++) /* the last corner, pushed through the middle */
      u[21 + d] = -0.75 * solid->grid->spacing[d];
    bw_solid_shape shape;
    check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, NULL, NULL, &shape));
    assert_int_equal(shape.inverted, 1 - empty);
    assert_true((shape.min_ratio > 0) == (empty == 1));
    bw_release(solid);
    bw_release(rule);
  }
}

/* Inverted elements are counted; where the energy does not exist the call still succeeds. */
static void test_inverted(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {3, 1, 1};
  for (int law = 0; law < 2; law++) {
    bw_solid_material *one = solids_simple(context, (bw_law)law);
    bw_solid *solid = solids_create(context, cells, 1, &one, NULL, NULL);
    int64_t n = 3 * (int64_t)solid->grid->node_count;
    double *u = solids_numbers(n), *g = solids_numbers(n), stress[18], energy = 7;
    bw_solid_shape shape;
    for (int32_t i = 0; i < solid->grid->node_count; i++)
      if (i % 4 == 3) /* the high end, pushed through its neighbours */
        u[3 * i] = -0.15;
    check_ok(context, bw_solid_evaluate(context, solid, u, false, &energy, g, NULL, &shape));
    assert_int_equal(shape.inverted, 1);
    assert_int_equal(shape.worst, 2);
    check_near(shape.min_ratio, -0.5, 1e-14);
    assert_true(shape.defined == (law != BW_NEO_HOOKEAN));
    if (law == BW_NEO_HOOKEAN) {
      bw_solid_linear *linear = NULL;
      assert_true(energy == 7);
      check_fails(context, BW_GEOMETRY, "element 3",
                  bw_solid_stress(context, solid, u, stress, NULL));
      check_ok(context, bw_solid_linear_create(context, solid, &linear));
      check_fails(context, BW_GEOMETRY, "element 3",
                  bw_solid_linear_set(context, linear, u, false));
      bw_solid_linear_destroy(linear);
    }
    u[4] = NAN;
    check_ok(context, bw_solid_evaluate(context, solid, u, true, &energy, g, NULL, &shape));
    assert_true(!shape.defined && isnan(shape.min_ratio));
    free(u), free(g);
    bw_release(solid);
  }
}

/* Every failing allocation is reported, and nothing leaks. */
static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_solid *made = ell(context, 1), *solid = NULL;
  int64_t n = 3 * (int64_t)made->grid->node_count;
  double *u = solids_displacement(made, affine, 0), *g = solids_numbers(n), energy;
  double *values = solids_numbers(9 * made->pattern->block_count);
  double *stress = solids_numbers(2 * n), *blocks = solids_numbers(3 * n);
  bw_status status = BW_MEMORY;
  for (int count = 1; status != BW_OK; count++) {
    bw_solid_shape shape;
    bw_solid_linear *linear = NULL;
    solid = NULL;
    assert_true(count < 200);
    bw_fail_allocation(count, true);
    status = bw_solid_create(context, made->grid, made->material_table, NULL, &solid);
    if (status == BW_OK)
      status = bw_solid_evaluate(context, solid, u, true, &energy, g, values, &shape);
    if (status == BW_OK)
      status = bw_solid_linear_create(context, solid, &linear);
    if (status == BW_OK)
      status = bw_solid_linear_set(context, linear, u, true);
    if (status == BW_OK)
      status = bw_solid_linear_multiply(context, linear, u, g);
    if (status == BW_OK)
      status = bw_solid_linear_diagonal(context, linear, blocks);
    if (status == BW_OK)
      status = bw_solid_stress(context, solid, u, NULL, stress);
    bw_fail_allocation(0, false);
    assert_true(status == BW_OK || status == BW_MEMORY);
    bw_solid_linear_destroy(linear);
    bw_release(solid);
  }
  free(u), free(g), free(values), free(stress), free(blocks);
  bw_release(made);
}

check_main(check_test(test_patch), check_test(test_plain_sums), check_test(test_derivatives),
           check_test(test_rotation), check_test(test_threads), check_test(test_projected),
           check_test(test_empty), check_test(test_inverted), check_test(test_memory))
