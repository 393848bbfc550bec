/* Solutions without a matrix: the same as direct ones, and how many iterations they take. */
#include "solid_box.h"
#include "solver_by.h"

typedef struct block {
  bw_grid *grid;
  bw_material_table *material_table;
  bw_solid *solid;
  bw_load_case *load_case;
  bw_coarse *coarse;
  bw_solid *coarse_solid[2];
} block;

/* A cube of n x n x n cells of two materials, mixed at random, the stiff one `contrast` times as
 * stiff; constrained below, pulled sideways and down at the top. */
static void block_make(bw_context *context, block *b, int32_t n, double contrast, double strain) {
  const int32_t cells[3] = {n, n, n};
  double origin[3] = {0, 0, 0}, spacing[3] = {1.0 / n, 1.0 / n, 1.0 / n};
  int64_t count = (int64_t)n * n * n;
  int32_t *material = malloc(sizeof *material * (size_t)count);
  bw_random random;
  bw_solid_material *soft, *stiff;
  *b = (block){0};
  bw_random_seed(&random, 5);
  for (int64_t i = 0; i < count; i++)
    material[i] = bw_random_uniform(&random) < 0.5 ? 1 : 2;
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, NULL, &b->grid));
  check_ok(context,
           bw_solid_material_create(context, "soft", BW_NEO_HOOKEAN, 1e5, 0.4, 1000, &soft));
  check_ok(context, bw_solid_material_create(context, "stiff", BW_NEO_HOOKEAN, 1e5 * contrast, 0.4,
                                             1000, &stiff));
  const bw_solid_material *both[2] = {soft, stiff};
  check_ok(context, bw_material_table_create(context, 3, both, &b->material_table));
  check_ok(context, bw_solid_create(context, b->grid, b->material_table, NULL, &b->solid));
  check_ok(context, bw_load_case_create(context, b->grid, &b->load_case));
  int32_t *low = malloc(2 * sizeof *low * (size_t)b->grid->node_count),
          *high = low + b->grid->node_count;
  int64_t lows = 0, highs = 0;
  for (int32_t i = 0; i < b->grid->node_count; i++) {
    double x[3];
    bw_grid_position(b->grid, i, x);
    if (x[2] < 1e-9)
      low[lows++] = i;
    if (x[2] > 1 - 1e-9)
      high[highs++] = i;
  }
  bool all[3] = {true, true, true};
  double force[3] = {1e5 * strain, 0, -1e5 * strain};
  check_ok(context, bw_load_case_fix(context, b->load_case, lows, low, all, NULL));
  check_ok(context, bw_load_case_force(context, b->load_case, highs, high, force));
  free(low);
  free(material);
  bw_release(soft);
  bw_release(stiff);
}

static void block_coarsen(bw_context *context, block *b) {
  check_ok(context,
           bw_coarsen(context, BW_COARSE_NAIVE, NULL, b->material_table, b->grid, 1, &b->coarse));
  check_ok(context, bw_solid_create(context, b->coarse->grid, b->coarse->material_table, NULL,
                                    &b->coarse_solid[0]));
}

static void block_free(block *b) {
  bw_release(b->coarse_solid[0]);
  bw_release(b->coarse_solid[1]);
  bw_release(b->coarse);
  bw_release(b->load_case);
  bw_release(b->solid);
  bw_release(b->material_table);
  bw_release(b->grid);
}

static bw_solid_static *solve(bw_context *context, const block *b, newton_way linear,
                              double tolerance) {
  bw_newton_options options;
  bw_solid_static *result;
  const bw_coarsening *coarsening[1] = {b->coarse ? b->coarse->coarsening[0] : NULL};
  const bw_solid *coarse[1] = {b->coarse_solid[0]};
  bw_newton_options_default(&options);
  options.solver = newton_by(linear);
  options.tolerance = tolerance;
  options.coarse_count = 1;
  options.coarsening = coarsening;
  options.coarse = coarse;
  check_ok(context, bw_solid_statics(context, b->solid, b->load_case, NULL, &options, &result));
  return result;
}

static void test_the_same(void **state) {
  bw_context *context = check_context(state);
  block b;
  block_make(context, &b, 6, 20, 0.1);
  block_coarsen(context, &b);
  bw_solid_static *direct = solve(context, &b, NEWTON_DIRECT, 1e-9),
                  *jacobi = solve(context, &b, NEWTON_JACOBI, 1e-9),
                  *coarse = solve(context, &b, NEWTON_COARSE, 1e-9);
  check_near(bw_grid_difference(b.grid, direct->displacement, jacobi->displacement), 0, 1e-9);
  check_near(bw_grid_difference(b.grid, direct->displacement, coarse->displacement), 0, 1e-9);
  const bw_solid_static *results[] = {direct, jacobi, coarse};
  static const char *const words[][2] = {{"cholesky", ""}, {"pcg", "jacobi"}, {"pcg", "two_level"}};
  for (int k = 0; k < 3; k++) {
    const bw_solver_report *report = &results[k]->report;
    assert_string_equal(report->solver, words[k][0]);
    assert_string_equal(report->preconditioner, words[k][1]);
    assert_string_equal(report->backend, k ? "" : "multifrontal");
    assert_string_equal(report->reason, "it was given");
    assert_true(report->bytes > 0 && report->seconds > 0 && report->residual <= 1e-9);
    assert_int_equal(report->iterations,
                     results[k]->newton.cg_iterations + results[k]->newton.stability_iterations);
    assert_int_equal(report->flops > 0, k == 0);
  }
  assert_true(jacobi->newton.cg_iterations > 2 * coarse->newton.cg_iterations);
  bw_release(direct);
  bw_release(jacobi);
  bw_release(coarse);
  block_free(&b);
}

/* Three levels, the coarsest of one material. */
static void test_levels(void **state) {
  bw_context *context = check_context(state);
  block b;
  bw_newton_options options;
  bw_solid_static *result, *direct;
  bw_coarsening *second;
  bw_solid_material *mean;
  bw_material_table *material_table;
  block_make(context, &b, 9, 10, 0.05);
  block_coarsen(context, &b);
  check_ok(context, bw_coarsening_create(context, b.coarse->grid, &second));
  check_ok(context, bw_solid_material_create(context, "", BW_NEO_HOOKEAN, 3e5, 0.4, 1000, &mean));
  const bw_solid_material *one = mean;
  check_ok(context, bw_material_table_create(context, 2, &one, &material_table));
  check_ok(context,
           bw_solid_create(context, second->coarse, material_table, NULL, &b.coarse_solid[1]));
  const bw_coarsening *coarsening[2] = {b.coarse->coarsening[0], second};
  const bw_solid *coarse[2] = {b.coarse_solid[0], b.coarse_solid[1]};
  bw_newton_options_default(&options);
  options.solver = newton_by(NEWTON_COARSE);
  options.tolerance = 1e-8;
  options.coarse_count = 2;
  options.coarsening = coarsening;
  options.coarse = coarse;
  check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  direct = solve(context, &b, NEWTON_DIRECT, 1e-8);
  check_near(bw_grid_difference(b.grid, direct->displacement, result->displacement), 0, 1e-8);
  assert_true(result->newton.cg_iterations < 25 * result->newton.iterations);
  options.coarse = coarse + 1;
  check_fails(context, BW_INVALID, "coarse solid 1",
              bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  bw_release(result);
  bw_release(direct);
  bw_release(material_table);
  bw_release(mean);
  bw_release(second);
  block_free(&b);
}

/* Iterations of one linear solution to 1e-8, small strains. */
static double iterations(bw_context *context, int32_t n, double contrast, newton_way linear) {
  block b;
  bw_newton_options options;
  bw_solid_static *result;
  block_make(context, &b, n, contrast, 1e-4);
  block_coarsen(context, &b);
  const bw_coarsening *coarsening[1] = {b.coarse->coarsening[0]};
  const bw_solid *coarse[1] = {b.coarse_solid[0]};
  bw_newton_options_default(&options);
  bw_solver exact = *newton_by(linear);
  exact.options.tolerance = 1e-8;
  options.solver = &exact;
  options.tolerance = 1e-3;
  options.coarse_count = 1;
  options.coarsening = coarsening;
  options.coarse = coarse;
  double before = bw_seconds();
  check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  double count = (double)result->newton.cg_iterations / result->newton.iterations;
  if (getenv("BARWRIGHT_FULL"))
    printf("%d^3 cells, contrast %g, %s: %g iterations, %.2f s\n", (int)n, contrast,
           linear == NEWTON_JACOBI ? "node blocks" : "coarse solid", count, bw_seconds() - before);
  bw_release(result);
  block_free(&b);
  return count;
}

static void test_iterations(void **state) {
  bw_context *context = check_context(state);
  double blocks[2], coarse[2];
  int32_t n = getenv("BARWRIGHT_FULL") ? 16 : 8;
  for (int k = 0; k < 2; k++) {
    blocks[k] = iterations(context, n * (k + 1), 10, NEWTON_JACOBI);
    coarse[k] = iterations(context, n * (k + 1), 10, NEWTON_COARSE);
  }
  assert_true(coarse[1] <= 1.25 * coarse[0]);
  assert_true(blocks[1] >= 1.5 * blocks[0]);
  assert_true(coarse[1] < 0.25 * blocks[1]);
  if (getenv("BARWRIGHT_FULL"))
    for (int k = 1; k <= 4; k *= 2) {
      iterations(context, 8 * k, 100, NEWTON_JACOBI);
      iterations(context, 8 * k, 100, NEWTON_COARSE);
    }
}

/* On a floor that comes down, with a pressure on one side that follows. */
static void test_contact_plane(void **state) {
  bw_context *context = check_context(state);
  bw_solid_static *result[3];
  for (int k = 0; k < 3; k++) {
    block b;
    double point[3] = {0, 0, 1}, normal[3] = {0, 0, -1}, move[3] = {0, 0, -0.1};
    block_make(context, &b, 4, 5, 0);
    block_coarsen(context, &b);
    int32_t side[25];
    int64_t count = 0;
    for (int32_t i = 0; i < b.grid->node_count; i++) {
      double x[3];
      bw_grid_position(b.grid, i, x);
      if (x[0] < 1e-9)
        side[count++] = i;
    }
    check_ok(context, bw_load_case_surface_pressure(context, b.load_case, count, side, NULL, NULL,
                                                    5e3, true));
    check_ok(context,
             bw_load_case_contact_plane(context, b.load_case, point, normal, move, NULL, NULL));
    result[k] = solve(context, &b, (newton_way)k, 1e-8);
    block_free(&b);
  }
  for (int k = 1; k < 3; k++)
    check_near(bw_grid_difference(result[0]->solid->grid, result[0]->displacement,
                                  result[k]->displacement),
               0, 1e-7);
  for (int k = 0; k < 3; k++)
    bw_release(result[k]);
}

/* By counted cost, from iterations on: few cells never need an analysis; many, mixed mildly, are
 * solved by conjugate gradients to the end; mixed wildly, so that the coarse solid says little,
 * these are given up for the factor, and the next solution begins with it. The result is the same,
 * and so are the bits from run to run. */
static void test_by_cost(void **state) {
  static const struct {
    int32_t n;
    double contrast;
    bool again;
    const char *reason;
  } kind[] = {{5, 10, true, "iterations have cost too little to analyse a factor"},
              {12, 10, true, "iterations have cost too little to analyse a factor"},
              {12, 1e5, false, "iterations over coarse solids are predicted to cost more"}};
  bw_context *context = check_context(state);
  for (int k = 0; k < 3; k++) {
    block b;
    bw_newton *newton;
    bw_newton_options options;
    bw_solid_static *first, *second, *fresh, *direct;
    block_make(context, &b, kind[k].n, kind[k].contrast, 0.02);
    block_coarsen(context, &b);
    const bw_coarsening *coarsening = b.coarse->coarsening[0];
    const bw_solid *coarse = b.coarse_solid[0];
    bw_newton_options_default(&options);
    options.tolerance = 1e-8;
    options.coarse_count = 1;
    options.coarsening = &coarsening;
    options.coarse = &coarse;
    check_ok(context, bw_newton_create(context, &newton));
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, newton, &options, &first));
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, newton, &options, &second));
    check_ok(context, bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &fresh));
    direct = solve(context, &b, NEWTON_DIRECT, 1e-8);
    assert_true(first->newton.cg_iterations > 0);
    assert_string_equal(first->report.solver, kind[k].again ? "pcg" : "cholesky");
    assert_string_equal(first->report.reason, kind[k].reason);
    assert_int_equal(first->report.predicted_cost > 0, first->report.rival_cost > 0);
    assert_true(first->report.predicted_cost <= first->report.rival_cost);
    assert_int_equal(first->newton.stability_iterations > 0, kind[k].again);
    assert_int_equal(second->newton.cg_iterations > 0, kind[k].again);
    assert_int_equal(first->newton.undecided + second->newton.undecided, 0);
    assert_memory_equal(first->displacement, fresh->displacement,
                        3 * sizeof(double) * (size_t)b.grid->node_count);
    check_near(bw_grid_difference(b.grid, direct->displacement, first->displacement), 0, 1e-7);
    check_near(bw_grid_difference(b.grid, direct->displacement, second->displacement), 0, 1e-7);
    bw_release(first);
    bw_release(second);
    bw_release(fresh);
    bw_release(direct);
    bw_release(newton);
    block_free(&b);
  }
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  block b;
  bw_newton_options options;
  bw_solid_static *result;
  block_make(context, &b, 2, 1, 0.1);
  bw_newton_options_default(&options);
  options.solver = newton_by(NEWTON_COARSE);
  check_fails(context, BW_INVALID, "at least one",
              bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  const bw_solver amg = {.options = {.kind = BW_SOLVER_AMG}},
                  lu = {.options = {.kind = BW_SOLVER_LU}},
                  by_amg = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = &amg}},
                  by_factor = {.options = {.kind = BW_SOLVER_PCG,
                                           .preconditioner = newton_by(NEWTON_DIRECT)}},
                  full = {.options = {.full = true}}, single = {.options = {.precision = 32}},
                  cholmod = {.options = {.backend = BW_BACKEND_CHOLMOD}},
                  ordered = {.options = {.ordering = BW_ORDERING_METIS}};
  const bw_solver *refused[] = {&amg, &lu, &by_amg, &by_factor, &full, &single, &cholmod, &ordered};
  for (size_t k = 0; k < sizeof refused / sizeof *refused; k++) {
    options.solver = refused[k];
    check_fails(context, BW_INVALID, "does not serve Newton's method",
                bw_solid_statics(context, b.solid, b.load_case, NULL, &options, &result));
  }
  block_free(&b);
}

check_main(check_test(test_the_same), check_test(test_levels), check_test(test_iterations),
           check_test(test_contact_plane), check_test(test_by_cost), check_test(test_misuse))
