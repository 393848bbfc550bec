/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coarsening: what blocks become, that edits lead where a fresh start does, and displacements. */
#include "check.h"

#include "barwright/metamaterial.h"

static bw_material_table *make_material_table(bw_context *context, int count) {
  static const double young[] = {1e5, 1e6, 1e7, 2e6}, density[] = {1000, 1200, 900, 1100};
  bw_solid_material *material[4] = {NULL};
  bw_material_table *material_table;
  for (int i = 0; i < count; i++)
    check_ok(context, bw_solid_material_create(context, i == 1 ? "middle" : "other",
                                               i == 3 ? BW_COROTATED : BW_NEO_HOOKEAN, young[i],
                                               0.45, density[i], &material[i]));
  check_ok(context,
           bw_material_table_create(context, count + 1, (const bw_solid_material *const *)material,
                                    &material_table));
  for (int i = 0; i < count; i++)
    bw_release(material[i]);
  return material_table;
}

static bw_grid *make_grid(bw_context *context, const int32_t cells[3], const int32_t *material,
                          const double *fraction) {
  const double origin[3] = {0.5, -1, 2}, spacing[3] = {0.01, 0.01, 0.01};
  bw_grid *grid;
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, fraction, &grid));
  return grid;
}

/* Random materials 0..most, with fractions below one in a third of the cells. */
static void random_cells(bw_random *random, int count, int max, int32_t *material,
                         double *fraction) {
  for (int i = 0; i < count; i++) {
    material[i] = (int32_t)(bw_random_bits(random) % (uint64_t)(max + 1));
    if (fraction)
      fraction[i] = bw_random_bits(random) % 3 ? 1 : 0.05 + 0.9 * bw_random_uniform(random);
  }
  material[0] = 1;
}

static double mass(const bw_grid *grid, const bw_material_table *material_table) {
  double cell = grid->spacing[0] * grid->spacing[1] * grid->spacing[2], sum = 0;
  for (int32_t e = 0; e < grid->element_count; e++)
    sum += cell * material_table->material[grid->material[e]]->density *
           (grid->fraction ? grid->fraction[e] : 1);
  return sum;
}

/* The fine element at point p of the block of coarse element e, or -1. */
static int32_t fine_at(const bw_coarse *coarse, int32_t e, int p) {
  int32_t child =
      coarse->coarsening[coarse->levels - 1]->child[8 * e + (coarse->levels == 1 ? p : p / 8)];
  if (coarse->levels == 1 || child < 0)
    return child;
  return coarse->coarsening[0]->child[8 * child + p % 8];
}

static void test_naive(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 3);
  bw_random random;
  int32_t material[7 * 5 * 6];
  double fraction[7 * 5 * 6];
  const int32_t cells[3] = {7, 5, 6};
  bw_random_seed(&random, 3);
  random_cells(&random, 7 * 5 * 6, 3, material, fraction);
  bw_grid *grid = make_grid(context, cells, material, fraction);
  for (int levels = 1; levels <= 2; levels++) {
    bw_coarse *coarse;
    check_ok(context,
             bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, levels, &coarse));
    assert_int_equal(coarse->looked_up, coarse->grid->element_count);
    assert_null(coarse->grid->fraction);
    assert_ptr_equal(coarse->fine, grid);
    check_near(mass(coarse->grid, coarse->material_table) / mass(grid, material_table), 1, 1e-13);
    for (int32_t e = 0; e < coarse->grid->element_count; e++) {
      const bw_solid_material *m = coarse->material_table->material[coarse->grid->material[e]];
      int points = levels == 1 ? 8 : 64;
      assert_int_equal(m->rule->count, points);
      for (int p = 0; p < points; p++) {
        int32_t f = fine_at(coarse, e, p);
        if (f < 0) {
          assert_true(m->mu[p] > 0 && m->mu[p] < 2e-3 * material_table->material[3]->mu[0]);
          continue;
        }
        /* The point lies in the cell of that fine element. */
        double low[3], at[3];
        bw_grid_position(coarse->grid, coarse->grid->element[8 * e], low);
        bw_grid_position(grid, grid->element[8 * f], at);
        for (int d = 0; d < 3; d++) {
          double x = low[d] + coarse->grid->spacing[d] * m->rule->at[3 * p + d] - at[d];
          assert_true(x > 0 && x < grid->spacing[d]);
        }
        const bw_solid_material *base = material_table->material[grid->material[f]];
        check_near(m->mu[p], base->mu[0] * grid->fraction[f], 1e-9 * m->mu[p]);
        check_near(m->lambda[p], base->lambda[0] * grid->fraction[f], 1e-9 * m->lambda[p]);
      }
    }
    bw_release(coarse);
  }
  bw_release(grid);
  bw_release(material_table);
}

static void test_average(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 4);
  const int32_t cells[3] = {2, 2, 2}, material[8] = {4, 4, 2, 4, 4, 0, 4, 1};
  bw_grid *grid = make_grid(context, cells, material, NULL);
  bw_coarse *coarse;
  check_ok(context, bw_coarsen(context, BW_COARSE_AVERAGE, NULL, material_table, grid, 1, &coarse));
  const bw_solid_material *m = coarse->material_table->material[1];
  double mu = (5 * material_table->material[4]->mu[0] + material_table->material[2]->mu[0] +
               material_table->material[1]->mu[0]) /
              8;
  assert_true(m->uniform);
  assert_int_equal(m->law[0], BW_COROTATED);
  check_near(m->mu[5], mu, 1e-12 * mu);
  check_near(m->density, (5 * 1100 + 1200 + 1000) / 8.0, 1e-9);
  bw_release(coarse);
  bw_release(grid);
  bw_release(material_table);
}

/* Equal keys share a row; rows are numbered by first use. */
static void test_rows(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 3);
  int32_t material[8 * 4 * 4];
  const int32_t cells[3] = {8, 4, 4};
  for (int i = 0; i < 8 * 4 * 4; i++)
    material[i] = i % 8 < 4 ? 2 : 1;
  bw_grid *grid = make_grid(context, cells, material, NULL);
  bw_coarse *coarse;
  check_ok(context, bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, 1, &coarse));
  assert_int_equal(coarse->material_table->count, 3);
  assert_int_equal(coarse->grid->material[0], 1);
  assert_int_equal(coarse->grid->material[3], 2);
  assert_true(coarse->material_table->material[1]->mu[3] == material_table->material[2]->mu[0]);
  bw_release(coarse);
  bw_release(grid);
  bw_release(material_table);
}

static void same_coarse(const bw_coarse *a, const bw_coarse *b) {
  assert_true(bw_grid_same_elements(a->grid, b->grid));
  assert_int_equal(a->material_table->count, b->material_table->count);
  assert_memory_equal(a->grid->material, b->grid->material,
                      sizeof(int32_t) * (size_t)a->grid->element_count);
  for (int32_t r = 1; r < a->material_table->count; r++) {
    const bw_solid_material *m = a->material_table->material[r],
                            *n = b->material_table->material[r];
    size_t points = (size_t)m->rule->count;
    assert_int_equal(m->rule->count, n->rule->count);
    assert_memory_equal(m->rule->spread, n->rule->spread, sizeof m->rule->spread);
    assert_int_equal(m->fibre_count, n->fibre_count);
    assert_true(m->density == n->density);
    assert_memory_equal(m->law, n->law, points);
    assert_memory_equal(m->mu, n->mu, points * sizeof(double));
    assert_memory_equal(m->lambda, n->lambda, points * sizeof(double));
    assert_memory_equal(m->fibre_stiffness, n->fibre_stiffness,
                        points * (size_t)m->fibre_count * sizeof(double));
    assert_memory_equal(m->fibre, n->fibre, 3 * points * (size_t)m->fibre_count * sizeof(double));
  }
}

/* Random edits, of materials alone and with cells that come and go. */
static void follow(bw_context *context, bw_coarse_method method, const bw_library *library,
                   const bw_material_table *material_table, int levels, uint64_t seed,
                   bool partial) {
  enum { X = 9, Y = 8, Z = 6, CELLS = X * Y * Z };
  const int32_t cells[3] = {X, Y, Z};
  int32_t material[CELLS];
  double fraction[CELLS];
  bw_random random;
  bw_random_seed(&random, seed);
  random_cells(&random, CELLS, material_table->count - 1, material, partial ? fraction : NULL);
  bw_grid *grid = make_grid(context, cells, material, partial ? fraction : NULL);
  bw_coarse *coarse, *next, *fresh;
  check_ok(context, bw_coarsen(context, method, library, material_table, grid, levels, &coarse));
  for (int step = 0; step < 12; step++) {
    bool void_too = step % 3 == 2;
    int edits = step == 4 ? 0 : 1 + (int)(bw_random_bits(&random) % 7);
    for (int i = 0; i < edits; i++) {
      int32_t c = (int32_t)(bw_random_bits(&random) % CELLS);
      int32_t m = (int32_t)(bw_random_bits(&random) % (uint64_t)material_table->count);
      if (void_too || (m && material[c]))
        material[c] = m;
      if (partial && material[c])
        fraction[c] = bw_random_bits(&random) % 2 ? 1 : 0.5;
    }
    material[0] = 1;
    bw_grid *edited = make_grid(context, cells, material, partial ? fraction : NULL);
    check_ok(context, bw_coarse_follow(context, coarse, edited, &next));
    check_ok(context, bw_coarsen(context, method, library, material_table, edited, levels, &fresh));
    same_coarse(next, fresh);
    assert_true(next->looked_up <= edits + 1);
    if (bw_grid_same_elements(grid, edited))
      assert_ptr_equal(next->coarsening[levels - 1], coarse->coarsening[levels - 1]);
    bw_release(fresh);
    bw_release(coarse);
    bw_release(grid);
    coarse = next;
    grid = edited;
  }
  bw_release(coarse);
  bw_release(grid);
}

static void test_follow(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 3);
  for (int levels = 1; levels <= 2; levels++) {
    follow(context, BW_COARSE_NAIVE, NULL, material_table, levels, 5, false);
    follow(context, BW_COARSE_NAIVE, NULL, material_table, levels, 6, true);
    follow(context, BW_COARSE_AVERAGE, NULL, material_table, levels, 7, true);
  }
  bw_release(material_table);
}

/* A displacement that is linear over the whole body comes out exactly; any other as prolongation
 * from level to level gives it. */
static void test_displacements(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 2);
  int32_t material[7 * 5 * 6];
  const int32_t cells[3] = {7, 5, 6};
  bw_random random;
  bw_random_seed(&random, 8);
  random_cells(&random, 7 * 5 * 6, 2, material, NULL);
  for (int i = 0; i < 7 * 5 * 6; i++)
    material[i] = bw_random_bits(&random) % 2 ? 0 : material[i];
  material[3] = 1;
  bw_grid *grid = make_grid(context, cells, material, NULL);
  for (int levels = 1; levels <= 2; levels++) {
    bw_coarse *coarse;
    check_ok(context,
             bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, levels, &coarse));
    int32_t nodes = coarse->grid->node_count;
    const bw_grid *middle = coarse->coarsening[0]->coarse;
    double *u = calloc(3 * (size_t)nodes, sizeof *u);
    double *v = calloc(3 * (size_t)grid->node_count, sizeof *v);
    double *w = calloc(3 * (size_t)grid->node_count, sizeof *w);
    double *m = calloc(3 * (size_t)middle->node_count, sizeof *m);
    for (int32_t i = 0; i < 3 * nodes; i++)
      u[i] = bw_random_normal(&random);
    bw_coarse_to_fine(coarse, u, v);
    if (levels == 2)
      bw_coarsening_prolong(coarse->coarsening[1], 3, u, m);
    bw_coarsening_prolong(coarse->coarsening[0], 3, levels == 2 ? m : u, w);
    for (int32_t i = 0; i < 3 * grid->node_count; i++)
      check_near(v[i], w[i], 1e-13);
    for (int32_t n = 0; n < nodes; n++) {
      double x[3];
      bw_grid_position(coarse->grid, n, x);
      for (int d = 0; d < 3; d++)
        u[3 * n + d] = 1 + x[d] - 2 * x[(d + 1) % 3];
    }
    bw_coarse_to_fine(coarse, u, v);
    for (int32_t n = 0; n < grid->node_count; n++) {
      double x[3];
      bw_grid_position(grid, n, x);
      for (int d = 0; d < 3; d++)
        check_near(v[3 * n + d], 1 + x[d] - 2 * x[(d + 1) % 3], 1e-13);
    }
    free(u);
    free(v);
    free(w);
    free(m);
    bw_release(coarse);
  }
  bw_release(grid);
  bw_release(material_table);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 2), *varied;
  const int32_t cells[3] = {2, 2, 2}, material[8] = {1, 1, 3, 1, 1, 1, 1, 1};
  const int32_t fewer[3] = {2, 2, 1};
  bw_grid *grid = make_grid(context, cells, material, NULL);
  bw_grid *good = make_grid(context, cells, NULL, NULL),
          *other = make_grid(context, fewer, NULL, NULL);
  bw_coarse *coarse, *next;
  check_fails(context, BW_INVALID, "element 3 (cell 3) is of material 3",
              bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, 1, &coarse));
  check_fails(context, BW_INVALID, "3 levels",
              bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, good, 3, &coarse));
  check_fails(context, BW_INVALID, "needs a library",
              bw_coarsen(context, BW_COARSE_LOOKUP, NULL, material_table, good, 1, &coarse));
  check_ok(context, bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, good, 1, &coarse));
  check_fails(context, BW_INVALID, "another lattice",
              bw_coarse_follow(context, coarse, other, &next));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "",
              bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, good, 1, &next));
  bw_clear_cancel(context);
  /* A material that differs from point to point. */
  bw_rule *rule;
  bw_solid_material *m;
  const uint8_t law[8] = {0};
  const double mu[8] = {1, 2, 1, 1, 1, 1, 1, 1}, lambda[8] = {0};
  check_ok(context, bw_rule_create(context, 1, &rule));
  check_ok(context, bw_solid_material_points(context, "varied", rule, 0, law, mu, lambda, 0, NULL,
                                             NULL, &m));
  check_ok(context,
           bw_material_table_create(context, 2, (const bw_solid_material *const *)&m, &varied));
  check_fails(context, BW_INVALID, "material 1 (varied) differs",
              bw_coarsen(context, BW_COARSE_NAIVE, NULL, varied, good, 1, &next));
  bw_release(m);
  bw_release(rule);
  bw_release(varied);
  bw_release(coarse);
  bw_release(grid);
  bw_release(good);
  bw_release(other);
  bw_release(material_table);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = make_material_table(context, 2);
  int32_t material[6 * 4 * 4];
  double fraction[6 * 4 * 4];
  const int32_t cells[3] = {6, 4, 4};
  bw_random random;
  bw_random_seed(&random, 9);
  random_cells(&random, 6 * 4 * 4, 2, material, fraction);
  bw_grid *grid = make_grid(context, cells, material, fraction);
  material[5] = material[5] ? 0 : 1;
  bw_grid *edited = make_grid(context, cells, material, fraction);
  check_each_allocation(context, status, 1) {
    bw_coarse *coarse = NULL, *next = NULL;
    status = bw_coarsen(context, BW_COARSE_NAIVE, NULL, material_table, grid, 2, &coarse);
    if (status == BW_OK)
      status = bw_coarse_follow(context, coarse, edited, &next);
    bw_release(coarse);
    bw_release(next);
  }
  bw_release(grid);
  bw_release(edited);
  bw_release(material_table);
}

check_main(check_test(test_naive), check_test(test_average), check_test(test_rows),
           check_test(test_follow), check_test(test_refusals), check_test(test_memory),
           check_test(test_displacements))
