/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Updating a factor in part: the same bits as from scratch, after random edits of random
 * subdomains, for any number of threads and either order; what is predicted is what is done; and
 * what happens when an update fails. */
#include "bodies.h"

#include "bench/cholmod_baseline.h"

typedef struct problem {
  bw_mesh *mesh;
  bw_material *material;
  bw_block_pattern *pattern;
  double *stiffness;
  int32_t *unknown;
  uint8_t *take;
  int32_t subdomain_count, *element_subdomain;
  uint8_t *inner; /* node_count: all elements around it are of one subdomain */
  int32_t *subdomain_of;
  double *node;
  bwi_order *order;
  bwi_symbolic *symbolic;
  bwi_elimination_reach *reach;
  bwi_matrix matrix;
} problem;

typedef bw_status order_function(bw_context *, const problem *, bwi_order **);
static bw_status plain_order(bw_context *context, const problem *p, bwi_order **order) {
  return bwi_order_create(context, p->pattern, p->take, order);
}
static bw_status subdomain_order(bw_context *context, const problem *p, bwi_order **order) {
  return bwi_order_create_subdomains(context, p->pattern, p->take, p->mesh, p->subdomain_count,
                                     p->element_subdomain, NULL, order);
}

static int below(bw_random *random, int count) {
  return (int)(bw_random_bits(random) % (uint64_t)count);
}

/* Subdomains that are boxes of cells, numbered at random, so that some of them may fall apart. */
static void label(problem *p, const int cells[3], int size, bw_random *random) {
  p->element_subdomain = malloc((size_t)p->mesh->element_count * sizeof(int32_t));
  int count[3], label_of[512];
  for (int i = 0; i < 3; i++)
    count[i] = (cells[i] + size - 1) / size;
  int boxes = count[0] * count[1] * count[2];
  assert_true(boxes <= 512);
  p->subdomain_count = boxes > 2 ? boxes - 1 : boxes;
  for (int b = 0; b < boxes; b++)
    label_of[b] = b < p->subdomain_count ? b : below(random, p->subdomain_count);
  for (int64_t e = 0; e < p->mesh->element_count; e++) {
    int64_t cell = e / 6,
            at[3] = {cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]};
    p->element_subdomain[e] =
        label_of[at[0] / size + count[0] * (at[1] / size + count[1] * (at[2] / size))];
  }
}

static void open_problem(bw_context *context, const int cells[3], int order, int size,
                         order_function *make_order, uint64_t seed, problem *p) {
  bw_random random;
  bw_random_seed(&random, seed);
  *p = (problem){.mesh = body_box(context, 0.1 * cells[0], 0.1 * cells[1], 0.1 * cells[2], cells[0],
                                  cells[1], cells[2], order),
                 .material = body_material(context)};
  size_t nodes = (size_t)p->mesh->node_count;
  label(p, cells, size, &random);
  check_ok(context, bw_block_pattern_create(context, p->mesh, &p->pattern));
  p->stiffness = numbers(9 * p->pattern->block_count);
  check_ok(context, bw_stiffness(context, p->pattern, p->mesh, p->material, p->stiffness));
  p->unknown = calloc(3 * nodes, sizeof(int32_t));
  p->take = calloc(nodes, 1);
  p->inner = calloc(nodes, 1);
  p->subdomain_of = calloc(nodes, sizeof(int32_t));
  p->node = malloc(3 * nodes * sizeof(double));
  memcpy(p->node, p->mesh->node, 3 * nodes * sizeof(double));
  int32_t unknowns = 0;
  for (size_t i = 0; i < nodes; i++) {
    bool fixed = p->mesh->node[3 * i] < 1e-9;
    p->take[i] = !fixed;
    p->inner[i] = 1;
    p->subdomain_of[i] = -1;
    for (int c = 0; c < 3; c++)
      p->unknown[3 * i + (size_t)c] = fixed ? -1 : unknowns++;
    if (!fixed && below(&random, 20) == 0)
      p->unknown[3 * i + 1] = -1;
  }
  for (int64_t e = 0; e < p->mesh->element_count; e++)
    for (int k = 0; k < p->mesh->nodes_per_element; k++) {
      int32_t i = p->mesh->element[e * p->mesh->nodes_per_element + k];
      if (p->subdomain_of[i] >= 0 && p->subdomain_of[i] != p->element_subdomain[e])
        p->inner[i] = 0;
      p->subdomain_of[i] = p->element_subdomain[e];
    }
  check_ok(context, make_order(context, p, &p->order));
  check_ok(context, bwi_symbolic_create(context, p->order, 3, p->unknown, &p->symbolic));
  check_ok(context, bwi_elimination_reach_create(context, p->symbolic, p->mesh, p->subdomain_count,
                                                 p->element_subdomain, &p->reach));
  p->matrix = (bwi_matrix){.pattern = p->pattern, .stiffness = p->stiffness};
}

static void close_problem(problem *p) {
  bw_release(p->reach);
  bw_release(p->symbolic);
  bw_release(p->order);
  bw_release(p->pattern);
  bw_release(p->material);
  bw_release(p->mesh);
  free(p->stiffness);
  free(p->unknown);
  free(p->take);
  free(p->inner);
  free(p->subdomain_of);
  free(p->element_subdomain);
  free(p->node);
}

/* Move nodes that lie within touched subdomains: entries of those subdomains change, no other does.
 */
static void edit(bw_context *context, problem *p, const uint8_t *touched, bw_random *random) {
  bw_mesh *moved = NULL;
  for (int64_t i = 0; i < p->mesh->node_count; i++)
    if (p->inner[i] && touched[p->subdomain_of[i]])
      for (int c = 0; c < 3; c++)
        p->node[3 * i + c] = p->mesh->node[3 * i + c] + 0.004 * (bw_random_uniform(random) - 0.5);
  check_ok(context, bw_mesh_moved(context, p->mesh, p->node, &moved));
  check_ok(context, bw_stiffness(context, p->pattern, moved, p->material, p->stiffness));
  bw_release(moved);
}

static void same_as_from_scratch(bw_context *context, const problem *p, const bwi_factor *factor) {
  bwi_factor *fresh = NULL;
  check_ok(context, bwi_factor_create_in(context, p->symbolic, &p->matrix, p->reach,
                                         factor->kernels, &fresh, NULL));
  assert_true(fresh->unit == factor->unit);
  assert_memory_equal(fresh->value, factor->value, bwi_factor_bytes(factor));
  bw_release(fresh);
}

static void random_edits(void **state) {
  bw_context *context = check_context(state);
  const int shape[5][5] = {
      {12, 2, 2, 2, 2}, {7, 6, 5, 1, 2}, {1, 1, 1, 2, 1}, {24, 3, 3, 1, 6}, {14, 10, 10, 1, 5}};
  order_function *orders[2] = {plain_order, subdomain_order};
  for (int s = 0; s < 5; s++)
    for (int o = 0; o < 4; o++) {
      const bwi_kernels *kernels = o < 2 ? &bwi_kernels_double : &bwi_kernels_single;
      problem p;
      bw_random random;
      bw_random_seed(&random, (uint64_t)(10 * s + o));
      open_problem(context, shape[s], shape[s][3], shape[s][4], orders[o % 2], (uint64_t)s, &p);
      uint8_t *touched = calloc((size_t)p.subdomain_count, 1);
      bwi_factor *factor = NULL;
      check_ok(context, bwi_factor_create_in(context, p.symbolic, &p.matrix, p.reach, kernels,
                                             &factor, NULL));
      same_as_from_scratch(context, &p, factor);
      int rounds = s == 4 ? 4 : 12;
      for (int round = 0; round < rounds; round++) {
        check_ok(context, bw_set_threads(context, 1 + round % 3));
        for (int d = 0; d < p.subdomain_count; d++)
          touched[d] = round % 4 == 3 ? below(&random, 3) == 0 : 0;
        touched[below(&random, p.subdomain_count)] = 1;
        edit(context, &p, touched, &random);
        double flops = -1;
        check_ok(context, bwi_factor_update(context, factor, &p.matrix, touched, &flops, NULL));
        check_near(flops, bwi_elimination_reach_flops(p.reach, touched), 1e-9 * flops);
        same_as_from_scratch(context, &p, factor);
      }
      double flops = -1;
      memset(touched, 0, (size_t)p.subdomain_count);
      check_ok(context, bwi_factor_update(context, factor, &p.matrix, touched, &flops, NULL));
      assert_true(flops == 0);
      bw_release(factor);
      free(touched);
      close_problem(&p);
    }
}

/* In single precision to its digits, whatever the units: those of the matrix, huge or tiny, change
 * no bit, and those of the force neither. */
static void units(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {9, 3, 3};
  problem p;
  open_problem(context, cells, 2, 3, subdomain_order, 5, &p);
  enum { SIDES = 3 };
  int64_t size = 3 * (int64_t)p.mesh->node_count, entries = 9 * p.pattern->block_count;
  double *force = numbers(SIDES * size), *u = numbers(SIDES * size), *v = numbers(SIDES * size);
  const int exponent[4] = {0, -640, 640, 96};
  random_field(2, SIDES * size, force);
  bwi_factor *factor = NULL;
  check_ok(context, bwi_factor_create(context, p.symbolic, &p.matrix, &factor, NULL));
  check_ok(context, bwi_solve_fields(context, factor, NULL, SIDES, force, v));
  bw_release(factor);
  double *exact = numbers(SIDES * size);
  memcpy(exact, v, (size_t)(SIDES * size) * sizeof *v);
  for (int k = 0; k < 4; k++) {
    for (int64_t i = 0; i < entries; i++)
      p.stiffness[i] = ldexp(p.stiffness[i], exponent[k] - (k > 0 ? exponent[k - 1] : 0));
    for (int64_t i = 0; i < SIDES * size; i++)
      u[i] = ldexp(force[i], k == 3 ? -700 : 0);
    check_ok(context, bwi_factor_create_in(context, p.symbolic, &p.matrix, p.reach,
                                           &bwi_kernels_single, &factor, NULL));
    check_ok(context, bwi_solve_fields(context, factor, NULL, SIDES, u, u));
    for (int64_t i = 0; i < SIDES * size; i++)
      u[i] = ldexp(u[i], exponent[k] + (k == 3 ? 700 : 0));
    if (k > 0)
      assert_memory_equal(u, v, (size_t)(SIDES * size) * sizeof *u);
    memcpy(v, u, (size_t)(SIDES * size) * sizeof *u);
    bw_release(factor);
  }
  double max = 0, off = 0;
  for (int64_t i = 0; i < SIDES * size; i++) {
    max = fmax(max, fabs(exact[i]));
    off = fmax(off, fabs(exact[i] - v[i]));
  }
  assert_true(off > 0 && off < 1e-3 * max);
  free(force);
  free(u);
  free(v);
  free(exact);
  close_problem(&p);
}

/* A set is that of the elements around the nodes of the supernode and of all below it, found here
 * the slow way. */
static void sets(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {6, 5, 4};
  problem p;
  open_problem(context, cells, 1, 1, subdomain_order, 3, &p); /* 119 subdomains: two words */
  const bwi_order *order = p.order;
  assert_int_equal(p.reach->words, 2);
  uint8_t *touched = calloc((size_t)p.subdomain_count, 1),
          *wanted = calloc((size_t)order->super_count, 1),
          *expected = calloc((size_t)order->super_count, 1);
  for (int d = 0; d < p.subdomain_count; d += 7) {
    memset(touched, 0, (size_t)p.subdomain_count);
    memset(expected, 0, (size_t)order->super_count);
    touched[d] = 1;
    for (int64_t e = 0; e < p.mesh->element_count; e++)
      for (int k = 0; k < 4 && p.element_subdomain[e] == d; k++) {
        int32_t place = order->position[p.mesh->element[4 * e + k]], s = 0;
        if (place < 0)
          continue;
        while (order->super[s + 1] <= place)
          s++;
        for (; s >= 0; s = order->parent[s])
          expected[s] = 1;
      }
    bwi_elimination_reach_supernodes(p.reach, touched, wanted);
    assert_memory_equal(wanted, expected, (size_t)order->super_count);
  }
  free(touched);
  free(wanted);
  free(expected);
  close_problem(&p);
}

/* An update that meets a matrix that is not positive definite breaks the factor; a whole update
 * repairs it. */
static void broken(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {8, 3, 3};
  problem p;
  open_problem(context, cells, 1, 4, subdomain_order, 5, &p);
  uint8_t *touched = calloc((size_t)p.subdomain_count, 1);
  double *x = numbers(p.symbolic->unknowns);
  bwi_factor *factor = NULL;
  check_ok(context, bwi_factor_create_in(context, p.symbolic, &p.matrix, p.reach,
                                         &bwi_kernels_double, &factor, NULL));
  int32_t node = p.mesh->node_count - 1, bad = -1;
  double *diagonal = p.stiffness + 9 * (p.pattern->start[node + 1] - 1), kept = diagonal[0];
  assert_int_equal(p.pattern->column[p.pattern->start[node + 1] - 1], node);
  p.unknown[3 * node] >= 0 ? (diagonal[0] = -kept) : (diagonal[8] = -kept);
  touched[p.subdomain_of[node]] = 1;
  check_fails(context, BW_SINGULAR, "not positive definite",
              bwi_factor_update(context, factor, &p.matrix, touched, NULL, &bad));
  assert_true(bad >= 0 && bad < p.mesh->node_count);
  assert_true(factor->broken);
  check_fails(context, BW_INTERNAL, "failed", bwi_factor_solve(context, factor, 1, x));
  check_fails(context, BW_INTERNAL, "last update",
              bwi_factor_update(context, factor, &p.matrix, touched, NULL, &bad));
  check_ok(context, bw_stiffness(context, p.pattern, p.mesh, p.material, p.stiffness));
  check_ok(context, bwi_factor_update(context, factor, &p.matrix, NULL, NULL, &bad));
  assert_false(factor->broken);
  same_as_from_scratch(context, &p, factor);
  check_ok(context, bwi_factor_solve(context, factor, 1, x));
  bw_release(factor);
  free(touched);
  free(x);
  close_problem(&p);
}

/* An order of any subdomains is a permutation of the nodes that take part, with supernodes as
 * promised; it solves what CHOLMOD solves. */
static void orders(void **state) {
  bw_context *context = check_context(state);
  const int shape[3][5] = {{9, 8, 7, 1, 1}, {10, 4, 3, 2, 3}, {9, 9, 8, 1, 3}};
  for (int k = 0; k < 3; k++) {
    problem p;
    bwi_factor *factor = NULL;
    cholmod_times times;
    open_problem(context, shape[k], shape[k][3], shape[k][4], subdomain_order, 7, &p);
    const bwi_order *order = p.order;
    int32_t placed = 0;
    for (int32_t i = 0; i < order->node_count; i++) {
      assert_int_equal(order->position[i] >= 0, p.take[i]);
      if (order->position[i] >= 0)
        assert_int_equal(order->node_at[order->position[i]], i);
      placed += p.take[i];
    }
    assert_int_equal(placed, order->size);
    for (int32_t s = 0; s < order->super_count; s++)
      assert_true(order->parent[s] > s || order->parent[s] == -1);
    check_ok(context, bwi_factor_create(context, p.symbolic, &p.matrix, &factor, NULL));
    int32_t size = p.symbolic->unknowns;
    double *x = numbers(size), *y = numbers(size), max = 0;
    random_field(4, size, x);
    memcpy(y, x, (size_t)size * sizeof(double));
    check_ok(context, bwi_factor_solve(context, factor, 1, x));
    check_ok(context, cholmod_baseline(context, p.symbolic, &p.matrix, y, &times));
    for (int32_t i = 0; i < size; i++)
      max = fmax(max, fabs(y[i]));
    for (int32_t i = 0; i < size; i++)
      check_near(x[i], y[i], 1e-9 * max);
    assert_true(times.flops > 0 && times.entries >= size);
    bw_release(factor);
    free(x);
    free(y);
    close_problem(&p);
  }
}

/* Two thick blocks joined by a thin neck, three subdomains: an edit of one block leaves the other
 * alone, and the order for edits is no worse than plain dissection. */
static void neck(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {26, 6, 6};
  problem p;
  open_problem(context, cells, 1, 26, plain_order, 1, &p);
  uint8_t *keep = calloc((size_t)p.mesh->element_count, 1);
  int32_t count = 0, *subdomain = malloc((size_t)p.mesh->element_count * sizeof(int32_t));
  for (int64_t e = 0; e < p.mesh->element_count; e++) {
    int64_t cell = e / 6, x = cell % 26, y = cell / 26 % 6, z = cell / 156;
    bool thick = x < 10 || x >= 16;
    keep[e] = thick || (y >= 2 && y < 4 && z >= 2 && z < 4);
    if (keep[e])
      subdomain[count++] = x < 10 ? 0 : thick ? 2 : 1;
  }
  bw_mesh *mesh = NULL;
  bw_block_pattern *pattern = NULL;
  check_ok(context, bw_mesh_subset(context, p.mesh, keep, &mesh));
  assert_int_equal(count, mesh->element_count);
  check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
  int32_t *unknown = calloc(3 * (size_t)mesh->node_count, sizeof(int32_t));
  double flops[2][3];
  for (int k = 0; k < 2; k++) {
    bwi_order *order = NULL;
    bwi_symbolic *symbolic = NULL;
    bwi_elimination_reach *reach = NULL;
    check_ok(context, k ? bwi_order_create_subdomains(context, pattern, NULL, mesh, 3, subdomain,
                                                      NULL, &order)
                        : bwi_order_create(context, pattern, NULL, &order));
    check_ok(context, bwi_symbolic_create(context, order, 3, unknown, &symbolic));
    check_ok(context, bwi_elimination_reach_create(context, symbolic, mesh, 3, subdomain, &reach));
    for (int d = 0; d < 3; d++) {
      const uint8_t touched[3] = {d == 0, d == 1, d == 2};
      flops[k][d] = bwi_elimination_reach_flops(reach, touched) / symbolic->flops;
    }
    bw_release(reach);
    bw_release(symbolic);
    bw_release(order);
  }
  assert_true(flops[1][1] < 0.1);
  assert_true(flops[1][0] < 0.6 && flops[1][2] < 0.6);
  assert_true(flops[1][1] <= 1.01 * flops[0][1]);
  free(keep);
  free(subdomain);
  free(unknown);
  bw_release(pattern);
  bw_release(mesh);
  close_problem(&p);
}

static bw_status whole(bw_context *context, const problem *p, const uint8_t *touched) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  bwi_elimination_reach *reach = NULL;
  bwi_factor *factor = NULL;
  BW_TRY(subdomain_order(context, p, &order));
  BW_TRY(bwi_symbolic_create(context, order, 3, p->unknown, &symbolic));
  BW_TRY(bwi_elimination_reach_create(context, symbolic, p->mesh, p->subdomain_count,
                                      p->element_subdomain, &reach));
  BW_TRY(bwi_factor_create_in(context, symbolic, &p->matrix, reach, &bwi_kernels_single, &factor,
                              NULL));
  BW_TRY(bwi_factor_update(context, factor, &p->matrix, touched, NULL, NULL));
done:
  bw_release(factor);
  bw_release(reach);
  bw_release(symbolic);
  bw_release(order);
  return status;
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {6, 2, 2};
  problem p;
  open_problem(context, cells, 1, 2, plain_order, 8, &p);
  uint8_t *touched = calloc((size_t)p.subdomain_count, 1);
  touched[0] = 1;
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 40) {
    status = whole(context, &p, touched);
  }
  free(touched);
  close_problem(&p);
}

check_main(check_test(random_edits), check_test(units), check_test(sets), check_test(broken),
           check_test(orders), check_test(neck), check_test(memory_failures))
