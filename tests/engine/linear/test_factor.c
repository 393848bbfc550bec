/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The factorisation by itself, by each backend: against CHOLMOD on entries put together here,
 * fronts against elimination column by column, inertia against dense eigenvalues and the same bits
 * for any number of threads. */
#include "bodies.h"

#include <suitesparse/cholmod.h>

#include "linear/internal.h"

void dsyev_(const char *, const char *, const int *, double *, const int *, double *, double *,
            const int *, int *);

typedef struct problem {
  bw_mesh *mesh;
  bw_block_pattern *pattern;
  double *stiffness, *mass;
  int32_t *unknown; /* node_count x 3 */
  int32_t count;    /* of unknowns */
  bwi_order *order;
  bwi_symbolic *symbolic;
  bwi_matrix matrix;
} problem;

/* A box fixed on one face. */
static void open_problem(bw_context *context, int nx, int ny, int nz, int order, double shift,
                         problem *p) {
  *p = (problem){.mesh = body_box(context, 0.1 * nx, 0.1 * ny, 0.1 * nz, nx, ny, nz, order)};
  bw_material *material = body_material(context);
  int64_t nodes = p->mesh->node_count;
  check_ok(context, bw_block_pattern_create(context, p->mesh, &p->pattern));
  p->stiffness = numbers(9 * p->pattern->block_count);
  p->mass = numbers(p->pattern->block_count);
  check_ok(context, bw_stiffness(context, p->pattern, p->mesh, material, p->stiffness));
  check_ok(context, bw_mass(context, p->pattern, p->mesh, NULL, p->mass));
  p->unknown = calloc((size_t)(3 * nodes), sizeof(int32_t));
  uint8_t *take = calloc((size_t)nodes, 1);
  for (int64_t i = 0; i < nodes; i++) {
    bool fixed = p->mesh->node[3 * i] < 1e-9;
    take[i] = !fixed;
    for (int c = 0; c < 3; c++)
      p->unknown[3 * i + c] = fixed ? -1 : p->count++;
  }
  check_ok(context, bwi_order_create(context, p->pattern, take, &p->order));
  check_ok(context, bwi_symbolic_create(context, p->order, 3, p->unknown, &p->symbolic));
  p->matrix = (bwi_matrix){
      .pattern = p->pattern, .stiffness = p->stiffness, .mass = p->mass, .shift = shift};
  free(take);
  bw_release(material);
}

static void close_problem(problem *p) {
  bw_release(p->order);
  bw_release(p->symbolic);
  bw_release(p->pattern);
  bw_release(p->mesh);
  free(p->stiffness);
  free(p->mass);
  free(p->unknown);
}

/* The matrix by unknowns' numbers, entry by entry through `put`. */
static void each_entry(const problem *p, void (*put)(void *, int32_t, int32_t, double),
                       void *data) {
  for (int32_t i = 0; i < p->pattern->node_count; i++)
    for (int64_t k = p->pattern->start[i]; k < p->pattern->start[i + 1]; k++)
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
          int32_t j = p->pattern->column[k], row = p->unknown[3 * i + a],
                  column = p->unknown[3 * j + b];
          if (row < 0 || column < 0 || (i == j && b > a))
            continue;
          double value = p->stiffness[9 * k + 3 * a + b];
          if (a == b)
            value += p->matrix.shift * p->mass[k];
          put(data, row, column, value);
        }
}

static void put_triplet(void *data, int32_t row, int32_t column, double value) {
  cholmod_triplet *t = data;
  ((int *)t->i)[t->nnz] = row > column ? row : column;
  ((int *)t->j)[t->nnz] = row > column ? column : row;
  ((double *)t->x)[t->nnz++] = value;
}

static void put_dense(void *data, int32_t row, int32_t column, double value) {
  double *const *dense = data;
  int32_t size = (int32_t)dense[1][0];
  dense[0][(size_t)row * (size_t)size + (size_t)column] = value;
  dense[0][(size_t)column * (size_t)size + (size_t)row] = value;
}

/* Right-hand side k of `width` is put where the factorisation wants it and the solution taken
 * back. */
static void to_order(const problem *p, int width, int k, const double *from, double *x) {
  for (int64_t i = 0; i < 3 * (int64_t)p->mesh->node_count; i++)
    if (p->unknown[i] >= 0)
      x[(int64_t)p->symbolic->at[i] * width + k] = from[p->unknown[i]];
}
static void from_order(const problem *p, int width, int k, const double *x, double *to) {
  for (int64_t i = 0; i < 3 * (int64_t)p->mesh->node_count; i++)
    if (p->unknown[i] >= 0)
      to[p->unknown[i]] = x[(int64_t)p->symbolic->at[i] * width + k];
}

/* One backend, with whole updates of the factor as well. */
static void compare_backend(bw_context *context, const bwi_kernels *kernels, bw_ordering ordering) {
  const int shape[4][4] = {{7, 6, 5, 1}, {30, 2, 2, 1}, {5, 4, 4, 2}, {1, 1, 1, 1}};
  for (int s = 0; s < 4; s++) {
    problem p;
    open_problem(context, shape[s][0], shape[s][1], shape[s][2], shape[s][3], 0, &p);
    bwi_factor *factor = NULL;
    bwi_elimination_reach *reach = NULL;
    p.order->ordering = ordering;
    check_ok(context, bwi_elimination_reach_create_whole(context, p.symbolic, &reach));
    check_ok(context, bwi_factor_create_in(context, p.symbolic, &p.matrix, s % 2 ? reach : NULL,
                                           kernels, &factor, NULL));
    if (s % 2)
      check_ok(context, bwi_factor_update(context, factor, &p.matrix, NULL, NULL, NULL));
    bw_release(reach);
    assert_true(bwi_factor_bytes(factor) > 0 && bwi_factor_flops(factor) > 0);
    size_t entries = 8 * (size_t)bwi_factor_entries(factor);
    assert_true(kernels == &bwi_kernels_cholmod && s % 2 ? bwi_factor_bytes(factor) > entries
                                                         : bwi_factor_bytes(factor) == entries);
    if (kernels == &bwi_kernels_cholmod) { /* as much as is given, not as is free */
      bwi_factor *larger = NULL;
      p.matrix.memory = (double)entries / 2;
      check_fails(
          context, BW_MEMORY, "CHOLMOD's factor",
          bwi_factor_create_in(context, p.symbolic, &p.matrix, NULL, kernels, &larger, NULL));
      p.matrix.memory = 0;
    }
    assert_int_equal(p.symbolic->unknowns, p.count);
    cholmod_common common;
    cholmod_start(&common);
    size_t n = (size_t)p.count;
    cholmod_triplet *triplet = cholmod_allocate_triplet(n, n, 9 * (size_t)p.pattern->block_count,
                                                        -1, CHOLMOD_REAL, &common);
    each_entry(&p, put_triplet, triplet);
    cholmod_sparse *a = cholmod_triplet_to_sparse(triplet, 0, &common);
    cholmod_factor *l = cholmod_analyze(a, &common);
    cholmod_factorize(a, l, &common);
    enum { COUNT = 16 };
    cholmod_dense *b = cholmod_allocate_dense(n, COUNT, n, CHOLMOD_REAL, &common);
    random_field(11, COUNT * (int64_t)n, b->x);
    cholmod_dense *expected = cholmod_solve(CHOLMOD_A, l, b, &common);
    double *x = numbers(COUNT * (int64_t)n), *u = numbers((int64_t)n), largest = 0;
    for (size_t i = 0; i < COUNT * n; i++)
      largest = fmax(largest, fabs(((double *)expected->x)[i]));
    for (int width = 1; width <= COUNT; width *= 2) {
      for (int k = 0; k < width; k++)
        to_order(&p, width, k, (double *)b->x + (size_t)k * n, x);
      check_ok(context, kernels->solve(context, factor, width, x));
      for (int k = 0; k < width; k++) {
        from_order(&p, width, k, x, u);
        for (size_t i = 0; i < n; i++)
          check_near(u[i], ((double *)expected->x)[(size_t)k * n + i], 1e-9 * largest);
      }
    }
    free(x);
    free(u);
    cholmod_free_dense(&expected, &common);
    cholmod_free_dense(&b, &common);
    cholmod_free_factor(&l, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_free_triplet(&triplet, &common);
    cholmod_finish(&common);
    bw_release(factor);
    close_problem(&p);
  }
}

static void against_cholmod(void **state) {
  bw_context *context = check_context(state);
  compare_backend(context, &bwi_kernels_double, BW_ORDERING_METIS);
  compare_backend(context, &bwi_kernels_cholmod, BW_ORDERING_METIS);
  compare_backend(context, &bwi_kernels_cholmod, BW_ORDERING_BACKEND);
}

/* In single precision entries of any units are in the range of float: K times 1e-40 or 1e40 has
 * solutions that are as many times larger or smaller. */
static void units_of_single_precision(void **state) {
  bw_context *context = check_context(state);
  const double unit[3] = {1, 1e-40, 1e40};
  problem p;
  open_problem(context, 5, 4, 3, 1, 0, &p);
  double *exact = numbers(p.count), *force = numbers(p.count), largest = 0;
  float *x = calloc((size_t)p.count, sizeof *x);
  random_field(5, p.count, force);
  for (int k = 0; k < 3; k++) {
    bwi_factor *factor = NULL;
    for (int64_t i = 0; i < 9 * p.pattern->block_count; i++)
      p.stiffness[i] *= k ? unit[k] / unit[k - 1] : 1;
    const bwi_kernels *kernels = k ? &bwi_kernels_single : &bwi_kernels_double;
    check_ok(context,
             bwi_factor_create_in(context, p.symbolic, &p.matrix, NULL, kernels, &factor, NULL));
    for (int32_t i = 0; i < p.count; i++) {
      exact[i] = k ? exact[i] : force[i];
      x[i] = (float)force[i];
    }
    check_ok(context, kernels->solve(context, factor, 1, k ? (void *)x : (void *)exact));
    for (int32_t i = 0; i < p.count; i++)
      largest = fmax(largest, fabs(exact[i]));
    for (int32_t i = 0; i < p.count && k; i++)
      check_near((double)x[i] * factor->unit * unit[k], exact[i], 1e-4 * largest);
    bw_release(factor);
  }
  free(exact);
  free(force);
  free(x);
  close_problem(&p);
}

static double number_of(const bwi_kernels *kernels, const void *block, int64_t at) {
  return kernels->bits == 64 ? ((const double *)block)[at] : (double)((const float *)block)[at];
}

static void set_number(const bwi_kernels *kernels, void *block, int64_t at, double number) {
  if (kernels->bits == 64)
    ((double *)block)[at] = number;
  else
    ((float *)block)[at] = (float)number;
}

/* A front of random numbers eliminated column by column here, in doubles. */
static void compare_front(bw_context *context, const bwi_kernels *kernels, int rows, int pivots) {
  int outer = rows - pivots;
  double *a = numbers((int64_t)rows * rows), *scale = numbers(rows);
  void *panel = calloc((size_t)rows * (size_t)pivots, kernels->size);
  void *update = calloc((size_t)bwi_update_size(outer) + 1, kernels->size);
  random_field(rows + pivots, (int64_t)rows * rows, a);
  for (int j = 0; j < rows; j++)
    for (int i = j; i < rows; i++) {
      double number = a[j * rows + i] / rows + (i == j ? 3 : 0);
      bool inside = j < pivots;
      set_number(kernels, inside ? panel : update,
                 inside ? (int64_t)j * rows + i : bwi_update_column(outer, j - pivots) + i - pivots,
                 number);
      a[j * rows + i] = number;
      scale[j] = a[j * rows + j];
    }
  for (int j = 0; j < pivots; j++) {
    double root = sqrt(a[j * rows + j]);
    for (int i = j; i < rows; i++)
      a[j * rows + i] /= root;
    for (int k = j + 1; k < rows; k++)
      for (int i = k; i < rows; i++)
        a[k * rows + i] -= a[j * rows + i] * a[j * rows + k];
  }
  bwi_front front = {
      .rows = rows, .pivots = pivots, .panel = panel, .update = update, .scale = scale};
  check_ok(context, kernels->eliminate(context, &front));
  for (int j = 0; j < rows; j++)
    for (int i = j; i < rows; i++)
      check_near(j < pivots ? number_of(kernels, panel, (int64_t)j * rows + i)
                            : number_of(kernels, update,
                                        bwi_update_column(outer, j - pivots) + i - pivots),
                 a[j * rows + i], kernels->bits == 64 ? 1e-13 : 1e-5);
  free(a);
  free(scale);
  free(panel);
  free(update);
}

/* Rows and pivots around the sizes of strips, of registers and of panels. */
static void fronts_of_any_size(void **state) {
  bw_context *context = check_context(state);
  const int pivots[] = {1, 3, 7, 8, 9, 31, 64, 127, 129}, outer[] = {0, 1, 11, 24, 47, 49, 96, 261};
  for (size_t i = 0; i < sizeof pivots / sizeof *pivots; i++)
    for (size_t j = 0; j < sizeof outer / sizeof *outer; j++) {
      compare_front(context, &bwi_kernels_double, pivots[i] + outer[j], pivots[i]);
      compare_front(context, &bwi_kernels_single, pivots[i] + outer[j], pivots[i]);
    }
}

/* Negative pivots of K - sigma M for sigma between any two eigenvalues: Sylvester. Shifts up to the
 * middle of the spectrum make many columns negative, in many fronts. */
static void inertia(void **state) {
  bw_context *context = check_context(state);
  problem p;
  open_problem(context, 5, 3, 3, 1, 0, &p);
  int n = p.count, info, length = 20 * n;
  double *dense = numbers((int64_t)n * n), *value = numbers(n), *work = numbers(length), size = n;
  double *pack[2] = {dense, &size};
  /* eigenvalues of K alone, mass = identity on blocks' diagonal */
  memset(p.mass, 0, (size_t)p.pattern->block_count * sizeof(double));
  for (int32_t i = 0; i < p.pattern->node_count; i++)
    p.mass[p.pattern->start[i + 1] - 1] = 1;
  each_entry(&p, put_dense, pack);
  dsyev_("N", "L", &n, dense, &n, value, work, &length, &info);
  assert_int_equal(info, 0);
  int checked = 0;
  for (int k = 0; k + 1 < n; k += k < 30 ? 1 : 17) {
    if (value[k + 1] - value[k] < 1e-6 * value[k])
      continue;
    p.matrix.shift = -0.5 * (value[k] + value[k + 1]);
    int64_t negative = 0;
    bool trusted = false;
    check_ok(context, bwi_count_negative(context, p.symbolic, &p.matrix, &negative, &trusted));
    if (trusted)
      assert_int_equal(negative, k + 1);
    checked += trusted;
  }
  assert_true(checked > 30);
  free(dense);
  free(value);
  free(work);
  close_problem(&p);
}

/* Large fronts too: several panels, several tiles. */
static void same_bits(void **state) {
  bw_context *context = check_context(state);
  problem p;
  open_problem(context, 18, 17, 16, 1, 0, &p);
  size_t numbers_of_l = (size_t)p.symbolic->panel[p.order->super_count];
  int64_t outer = 0, size = 3 * (int64_t)p.mesh->node_count;
  for (int32_t s = 0; s < p.order->super_count; s++)
    outer = outer > p.symbolic->rows[s] - bwi_pivots(p.symbolic, s)
                ? outer
                : p.symbolic->rows[s] - bwi_pivots(p.symbolic, s);
  assert_true(outer > BWI_TILE);
  bwi_factor *first = NULL;
  double *x = numbers(8 * (int64_t)p.count), *y = numbers(8 * (int64_t)p.count);
  for (int threads = 1; threads <= 3; threads++) {
    bwi_factor *factor = NULL;
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, bwi_factor_create(context, p.symbolic, &p.matrix, &factor, NULL));
    random_field(2, 8 * (int64_t)p.count, x);
    check_ok(context, bwi_factor_solve(context, factor, 8, x));
    if (!first) {
      first = factor;
      memcpy(y, x, 8 * (size_t)p.count * sizeof(double));
      double *u = numbers(size), *ku = numbers(size), *solution = numbers(p.count);
      from_order(&p, 8, 5, x, solution);
      for (int64_t i = 0; i < size; i++)
        u[i] = p.unknown[i] < 0 ? 0 : solution[p.unknown[i]];
      check_ok(context, bw_block_multiply(context, p.pattern, p.stiffness, 9, 3, 1, u, ku));
      random_field(2, 8 * (int64_t)p.count, x);
      from_order(&p, 8, 5, x, solution);
      for (int64_t i = 0; i < size; i++)
        if (p.unknown[i] >= 0)
          check_near(ku[i], solution[p.unknown[i]], 1e-9);
      free(u);
      free(ku);
      free(solution);
      continue;
    }
    assert_memory_equal(first->value, factor->value, numbers_of_l * sizeof(double));
    assert_memory_equal(x, y, 8 * (size_t)p.count * sizeof(double));
    bw_release(factor);
  }
  bw_release(first);
  free(x);
  free(y);
  close_problem(&p);
}

check_main(check_test(against_cholmod), check_test(units_of_single_precision),
           check_test(fronts_of_any_size), check_test(inertia), check_test(same_bits))
