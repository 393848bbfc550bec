/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The pattern's invariants against a naive construction, and products against the full matrix. */
#include "assemble/dense.h"
#include "assemble/internal.h"

/* A fan of elements around one edge: rows as long as the mesh. */
static void fan(bw_context *context, int blades, bw_mesh **mesh) {
  int nodes = blades + 2;
  double *node = (double *)malloc(sizeof *node * 3 * (size_t)nodes);
  int32_t *element = (int32_t *)malloc(sizeof *element * 4 * (size_t)blades);
  memset(node, 0, sizeof *node * 3 * (size_t)nodes);
  node[3 * blades + 2] = -1;
  node[3 * (blades + 1) + 2] = 1;
  for (int i = 0; i < blades; i++) {
    /* numbers of neighbours lie far apart, so that rows come unsorted */
    int here = (int)((int64_t)i * 7 % blades), next = (int)((int64_t)(i + 1) * 7 % blades);
    node[3 * here] = cos(2 * 3.14159265358979 * i / blades);
    node[3 * here + 1] = sin(2 * 3.14159265358979 * i / blades);
    int32_t four[4] = {blades, here, next, blades + 1};
    memcpy(element + 4 * i, four, sizeof four);
  }
  check_ok(context, bw_mesh_copy(context, 1, nodes, node, blades, element, NULL, mesh));
  free(node), free(element);
}

static void check_pattern(bw_context *context, const bw_mesh *mesh) {
  bw_block_pattern *g = NULL;
  bwi_contributions *list = NULL;
  check_ok(context, bw_block_pattern_create(context, mesh, &g));
  check_ok(context, bwi_contributions_create(context, g, mesh->element_count,
                                             mesh->nodes_per_element, mesh->element, &list));
  int n = mesh->node_count, per = mesh->nodes_per_element;
  int *together = (int *)calloc((size_t)n * (size_t)n, sizeof *together);
  for (int e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < per; a++)
      for (int b = 0; b < per; b++)
        together[mesh->element[e * per + a] * n + mesh->element[e * per + b]]++;
  int64_t blocks = 0, uppers = 0;
  for (int i = 0; i < n; i++) {
    assert_int_equal(g->column[g->start[i + 1] - 1], i);
    for (int64_t p = g->start[i]; p < g->start[i + 1]; p++, blocks++) {
      int j = g->column[p];
      assert_true(p == g->start[i] || j > g->column[p - 1]);
      assert_int_equal(list->start[p + 1] - list->start[p], together[i * n + j]);
      for (int64_t k = list->start[p]; k < list->start[p + 1]; k++) {
        const int32_t *element = mesh->element + per * list->element[k];
        assert_int_equal(element[list->local[k] >> 4], i);
        assert_int_equal(element[list->local[k] & 15], j);
        assert_true(k == list->start[p] || list->element[k] > list->element[k - 1]);
      }
    }
    for (int64_t k = g->upper_start[i]; k < g->upper_start[i + 1]; k++, uppers++) {
      int row = g->upper_row[k];
      int64_t p = bw_upper_block(g, k);
      assert_true(row > i && g->column[p] == i && p >= g->start[row] && p < g->start[row + 1]);
      assert_true(k == g->upper_start[i] || row > g->upper_row[k - 1]);
    }
    for (int j = 0; j <= i; j++)
      blocks -= together[i * n + j] > 0;
  }
  assert_int_equal(blocks, 0);
  assert_int_equal(uppers, g->block_count - n);
  assert_int_equal(list->start[g->block_count], mesh->element_count * (per * (per + 1) / 2));
  assert_true(bw_bytes(g) > 0 && bw_bytes(list) > 0);
  bw_release(list);
  free(together);
  bw_release(g);
}

static void invariants(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  for (int order = 1; order <= 2; order++) {
    perturbed_box(context, 3, 2, 2, order, 0.2, 0, &mesh);
    check_pattern(context, mesh);
    bw_release(mesh);
  }
  fan(context, 500, &mesh);
  check_pattern(context, mesh);
  bw_release(mesh);
}

static void same_pattern_for_any_thread_count(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  bw_block_pattern *first = NULL;
  bwi_contributions *of_first = NULL;
  perturbed_box(context, 12, 10, 8, 2, 0.2, 0, &mesh);
  const int threads[] = {1, 2, 3, 7};
  for (int t = 0; t < 4; t++) {
    bw_block_pattern *g = NULL;
    bwi_contributions *list = NULL;
    check_ok(context, bw_set_threads(context, threads[t]));
    check_ok(context, bw_block_pattern_create(context, mesh, &g));
    check_ok(context,
             bwi_contributions_create(context, g, mesh->element_count, 10, mesh->element, &list));
    if (!first) {
      first = g;
      of_first = list;
      continue;
    }
    size_t blocks = (size_t)g->block_count, all = (size_t)list->start[blocks];
    assert_int_equal(g->block_count, first->block_count);
    assert_memory_equal(g->column, first->column, blocks * sizeof *g->column);
    assert_memory_equal(list->start, of_first->start, blocks * sizeof *list->start);
    assert_memory_equal(list->element, of_first->element, all * sizeof(int32_t));
    assert_memory_equal(list->local, of_first->local, all);
    bw_release(g);
    bw_release(list);
  }
  bw_release(first);
  bw_release(of_first);
  bw_release(mesh);
}

static void product_is_that_of_the_full_matrix(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = NULL;
  bw_block_pattern *g = NULL;
  perturbed_box(context, 2, 2, 2, 2, 0.2, 0, &mesh);
  check_ok(context, bw_block_pattern_create(context, mesh, &g));
  int n = 3 * mesh->node_count, vectors = 9;
  double *a = (double *)malloc(sizeof *a * 9 * (size_t)g->block_count);
  double *x = (double *)malloc(sizeof *x * (size_t)(n * vectors));
  double *y = (double *)malloc(sizeof *y * (size_t)(n * vectors));
  double *z = (double *)malloc(sizeof *z * (size_t)(n * vectors));
  bw_random random;
  bw_random_seed(&random, 3);
  for (int64_t p = 0; p < 9 * g->block_count; p++)
    a[p] = bw_random_uniform(&random);
  for (int i = 0; i < mesh->node_count; i++) { /* symmetric on the diagonal, as stiffness is */
    double *d = a + 9 * (g->start[i + 1] - 1);
    d[3] = d[1], d[6] = d[2], d[7] = d[5];
  }
  for (int i = 0; i < n * vectors; i++)
    x[i] = bw_random_uniform(&random) - 0.5;
  double *full = dense_stiffness(g, a);

  check_ok(context, bw_block_multiply(context, g, a, 9, 3, vectors, x, y));
  for (int v = 0; v < vectors; v++) {
    for (int i = 0; i < n; i++) {
      double sum = 0;
      for (int j = 0; j < n; j++)
        sum += full[i * n + j] * x[v * n + j];
      check_near(y[v * n + i], sum, 1e-12);
    }
    /* one by one: the same bits */
    check_ok(context, bw_block_multiply(context, g, a, 9, 3, 1, x + v * n, z));
    assert_memory_equal(z, y + v * n, sizeof *z * (size_t)n);
  }
  /* one number per block, on three components and on one */
  check_ok(context, bw_block_multiply(context, g, a, 1, 3, vectors, x, y));
  check_ok(context, bw_block_multiply(context, g, a, 1, 3, 1, x + n, z));
  assert_memory_equal(z, y + n, sizeof *z * (size_t)n);
  for (int k = 0; k < 3; k++) {
    double *one = (double *)malloc(sizeof *one * (size_t)n), *out = one + mesh->node_count;
    for (int i = 0; i < mesh->node_count; i++)
      one[i] = x[3 * i + k];
    check_ok(context, bw_block_multiply(context, g, a, 1, 1, 1, one, out));
    for (int i = 0; i < mesh->node_count; i++)
      assert_true(out[i] == y[3 * i + k]);
    free(one);
  }
  /* any number of vectors at once, by each kind of block: the same bits */
  const int blocks[3] = {9, 1, 1}, components[3] = {3, 3, 1};
  for (int kind = 0; kind < 3; kind++)
    for (int count = 2; count <= vectors; count++) {
      size_t length = (size_t)(components[kind] * mesh->node_count);
      check_ok(context,
               bw_block_multiply(context, g, a, blocks[kind], components[kind], count, x, y));
      for (size_t v = 0; v < (size_t)count; v++) {
        check_ok(context, bw_block_multiply(context, g, a, blocks[kind], components[kind], 1,
                                            x + v * length, z));
        assert_memory_equal(z, y + v * length, sizeof *z * length);
      }
    }
  check_ok(context, bw_block_multiply(context, g, a, 9, 3, 0, x, y));
  check_fails(context, BW_INVALID, "blocks", bw_block_multiply(context, g, a, 9, 1, 1, x, y));
  check_fails(context, BW_INVALID, "blocks", bw_block_multiply(context, g, a, 4, 3, 1, x, y));
  free(a), free(x), free(y), free(z), free(full);
  bw_release(g);
  bw_release(mesh);
}

check_main(check_test(invariants), check_test(same_pattern_for_any_thread_count),
           check_test(product_is_that_of_the_full_matrix))
