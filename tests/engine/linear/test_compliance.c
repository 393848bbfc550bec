/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Compliances by the forward half of the solves against whole ones, one right-hand side each: of
 * supported and free bodies, with oblique supports, grown column by column, by other factors and by
 * PCG; the same bits on any number of threads; failing allocations. */
#include "bar.h"
#include "linear/compliance.h"

enum { COLUMNS = 150, PER_COLUMN = 5 };

typedef struct sides {
  int64_t start[COLUMNS + 1];
  int32_t node[COLUMNS * PER_COLUMN];
  double force[3 * COLUMNS * PER_COLUMN];
  bwi_nodal_columns columns;
} sides;

/* Forces at a few nodes each, near each other in every second column; a node may be there twice. */
static void random_sides(const bw_mesh *mesh, sides *s) {
  double pick[COLUMNS * PER_COLUMN];
  random_field(7, COLUMNS * PER_COLUMN, pick);
  random_field(8, 3 * COLUMNS * PER_COLUMN, s->force);
  for (int k = 0; k < COLUMNS * PER_COLUMN; k++) {
    int32_t any = (int32_t)(fabs(pick[k]) * 1e6) % mesh->node_count;
    s->node[k] = k / PER_COLUMN % 2 ? (mesh->node_count / 2 + k) % mesh->node_count : any;
  }
  for (int j = 0; j <= COLUMNS; j++)
    s->start[j] = j * PER_COLUMN;
  s->columns = (bwi_nodal_columns){COLUMNS, s->start, s->node, s->force};
}

enum { TWO_FREE = SCENES };

static bw_mesh *two_boxes(bw_context *context) {
  bw_mesh *mesh = NULL, *one = body_box(context, 3, 1, 1, 6, 3, 3, 1);
  int64_t n = one->node_count, e = one->element_count;
  double *node = numbers(6 * n);
  int32_t *element = calloc((size_t)(8 * e), sizeof *element);
  for (int64_t i = 0; i < 6 * n; i++)
    node[i] = one->node[i % (3 * n)] + (i >= 3 * n && i % 3 == 2 ? 2 : 0);
  for (int64_t i = 0; i < 8 * e; i++)
    element[i] = one->element[i % (4 * e)] + (i >= 4 * e ? (int32_t)n : 0);
  check_ok(context, bw_mesh_copy(context, 1, (int32_t)(2 * n), node, (int32_t)(2 * e), element,
                                 NULL, &mesh));
  free(node);
  free(element);
  bw_release(one);
  return mesh;
}

static bw_model *make_model(bw_context *context, int scene) {
  bw_mesh *mesh = scene == TWO_FREE ? two_boxes(context)
                                    : body_box(context, 3, 1.1, 0.9, 8, 4, 4, 2 - scene % 2);
  bw_material *material = body_material(context);
  bw_model *model = bar_model(context, mesh, material, scene);
  bw_release(material);
  bw_release(mesh);
  return model;
}

/* Column by column by bw_system_solve. */
static void obvious(bw_context *context, bw_system *system, const sides *s, double *matrix) {
  int64_t size = 3 * (int64_t)system->mesh->node_count;
  double *u = numbers(size);
  for (int j = 0; j < COLUMNS; j++) {
    memset(u, 0, (size_t)size * sizeof *u);
    for (int64_t k = s->start[j]; k < s->start[j + 1]; k++)
      for (int c = 0; c < 3; c++)
        u[3 * s->node[k] + c] += s->force[3 * k + c];
    check_ok(context, bw_system_solve(context, system, 1, u, u));
    for (int i = 0; i < COLUMNS; i++) {
      double sum = 0;
      for (int64_t k = s->start[i]; k < s->start[i + 1]; k++)
        sum += bw_dot(s->force + 3 * k, u + 3 * s->node[k]);
      matrix[j * COLUMNS + i] = sum;
    }
  }
  free(u);
}

static double difference(const double *a, const double *b) {
  double worst = 0, largest = 0;
  for (int i = 0; i < COLUMNS * COLUMNS; i++) {
    worst = fmax(worst, fabs(a[i] - b[i]));
    largest = fmax(largest, fabs(b[i]));
  }
  return worst / largest;
}

/* In parts, of which one is empty: each leaves the halves of its solves for the next. */
static void grown(bw_context *context, bw_system *system, const sides *s, double *matrix) {
  static const int end[] = {20, 70, 70, 71, COLUMNS};
  static double part[COLUMNS * COLUMNS];
  bwi_half_solves kept = {0};
  int first = 0;
  for (size_t k = 0; k < sizeof end / sizeof *end; k++) {
    bwi_nodal_columns columns = s->columns;
    columns.count = end[k];
    for (int i = 0; i < end[k]; i++)
      for (int j = 0; j < end[k]; j++)
        part[i * end[k] + j] = i < first && j < first ? matrix[i * COLUMNS + j] : NAN;
    check_ok(context, bwi_compliance_of(context, system, &columns, first, &kept, part));
    first = end[k];
    for (int i = 0; i < first; i++)
      memcpy(matrix + i * COLUMNS, part + i * first, (size_t)first * sizeof *part);
  }
  assert_int_equal(kept.count, bwi_compliance_by_halves(system) ? COLUMNS : 0);
  bwi_half_solves_clear(&kept);
}

static void whole_solves(void **state) {
  bw_context *context = check_context(state);
  static double wanted[COLUMNS * COLUMNS], found[COLUMNS * COLUMNS], again[COLUMNS * COLUMNS];
  const bw_solver_options by[] = {{.kind = BW_SOLVER_CHOLESKY},
                                  {.backend = BW_BACKEND_CHOLMOD},
                                  {.precision = 32},
                                  {.kind = BW_SOLVER_PCG, .tolerance = 1e-10}};
  for (int scene = 0; scene <= TWO_FREE; scene++) {
    bw_model *model = make_model(context, scene);
    sides s;
    random_sides(model->mesh, &s);
    for (int k = 0; k < 4; k++) {
      bw_solver *solver =
          body_solver_over(context, by[k], (bw_solver_options){.kind = BW_SOLVER_AMG});
      bw_system *system = NULL;
      check_ok(context, bw_system_of_model(context, model, solver, NULL, &system));
      if (k == 0)
        obvious(context, system, &s, wanted);
      assert_int_equal(bwi_compliance_by_halves(system), k == 0);
      check_ok(context, bwi_compliance_of(context, system, &s.columns, 0, NULL, found));
      assert_true(difference(found, wanted) < (k < 2 ? 1e-12 : 1e-6));
      for (int i = 0; i < COLUMNS; i++)
        for (int j = 0; j < i; j++)
          assert_true(found[i * COLUMNS + j] == found[j * COLUMNS + i]);
      memcpy(again, found, sizeof again); /* what is known stays */
      for (int i = 0; i < COLUMNS; i++)
        for (int j = 0; j < COLUMNS; j++)
          if (i >= 70 || j >= 70)
            again[i * COLUMNS + j] = NAN;
      check_ok(context, bwi_compliance_of(context, system, &s.columns, 70, NULL, again));
      assert_true(difference(again, wanted) < (k < 2 ? 1e-12 : 1e-6));
      grown(context, system, &s, again);
      assert_true(difference(again, wanted) < (k < 2 ? 1e-12 : 1e-6));
      bw_release(system);
      bw_release(solver);
    }
    bw_release(model);
  }
}

static void same_bits(void **state) {
  bw_context *context = check_context(state);
  static double one[COLUMNS * COLUMNS], other[COLUMNS * COLUMNS];
  for (int two = 0; two < 2; two++) {
    bw_model *model = make_model(context, two ? TWO_FREE : FREE);
    sides s;
    bw_system *system = NULL;
    random_sides(model->mesh, &s);
    check_ok(context, bw_system_of_model(context, model, NULL, NULL, &system));
    check_ok(context, bw_set_threads(context, 1));
    check_ok(context, bwi_compliance_of(context, system, &s.columns, 0, NULL, one));
    check_ok(context, bw_set_threads(context, 3));
    check_ok(context, bwi_compliance_of(context, system, &s.columns, 0, NULL, other));
    assert_memory_equal(one, other, sizeof one);
    check_ok(context, bw_set_threads(context, 1));
    check_each_allocation(context, status, 1) {
      bw_release(system->relaxed);
      system->relaxed = NULL;
      status = bwi_compliance_of(context, system, &s.columns, 0, NULL, other);
    }
    assert_memory_equal(one, other, sizeof one);
    bwi_half_solves kept = {0};
    check_each_allocation(context, status, 1) {
      bwi_half_solves_clear(&kept);
      status = bwi_compliance_of(context, system, &s.columns, 0, &kept, other);
      assert_int_equal(kept.count, status == BW_OK ? COLUMNS : 0);
    }
    bwi_half_solves_clear(&kept);
    assert_memory_equal(one, other, sizeof one);
    bw_release(system);
    bw_release(model);
  }
}

check_main(check_test(whole_solves), check_test(same_bits))
