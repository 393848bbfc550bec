/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The making of tetrahedral meshes: topology against counting formulas, refusals, changes. */
#include "check.h"

static const double corner_node[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static bw_mesh *box(bw_context *context, int nx, int ny, int nz, int order) {
  double low[3] = {0, 0, 0}, high[3] = {3, 2, 1};
  int cells[3] = {nx, ny, nz};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static void test_one_element(void **state) {
  bw_context *context = check_context(state);
  for (int turned = 0; turned < 2; turned++) {
    int32_t element[4] = {0, turned ? 2 : 1, turned ? 1 : 2, 3};
    bw_mesh *mesh;
    check_ok(context, bw_mesh_copy(context, 1, 4, &corner_node[0][0], 1, element, NULL, &mesh));
    check_near(bw_mesh_volume(mesh), 1.0 / 6, 1e-15);
    assert_int_equal(mesh->facet_count, 4);
    assert_int_equal(mesh->boundary_node_count, 4);
    assert_int_equal(mesh->component_count, 1);
    for (int i = 0; i < 4; i++) { /* every facet faces outwards: away from the centroid */
      const int32_t *f = mesh->facet + 3 * i;
      double a[3], b[3], n[3], out[3];
      for (int k = 0; k < 3; k++) {
        a[k] = mesh->node[3 * f[1] + k] - mesh->node[3 * f[0] + k];
        b[k] = mesh->node[3 * f[2] + k] - mesh->node[3 * f[0] + k];
        out[k] = mesh->node[3 * f[0] + k] - 0.25;
      }
      bw_cross(a, b, n);
      assert_true(bw_dot(n, out) > 0);
      assert_int_equal(mesh->neighbour[i], -1);
    }
    bw_release(mesh);
  }
}

/* Stokes: the boundary's divergence theorem gives the same volume as the elements, at both orders;
 * Euler's formula and the counts of a grid fix the topology. */
static void test_grid(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    int n[3] = {4, 3, 2};
    bw_mesh *mesh = box(context, n[0], n[1], n[2], order);
    assert_int_equal(mesh->element_count, 6 * 4 * 3 * 2);
    assert_int_equal(mesh->node_count, order == 1 ? 5 * 4 * 3 : 9 * 7 * 5);
    assert_int_equal(mesh->facet_count, 4 * (4 * 3 + 3 * 2 + 2 * 4));
    assert_int_equal(mesh->component_count, 1);
    check_near(bw_mesh_volume(mesh), 6, 1e-13);
    double flux = 0;
    for (int32_t i = 0; i < mesh->facet_count; i++) {
      const int32_t *f = mesh->facet + i * mesh->nodes_per_facet;
      const double *x = mesh->node;
      double c[3];
      bw_cross(x + 3 * f[1], x + 3 * f[2], c);
      flux += bw_dot(x + 3 * f[0], c) / 6;
    }
    check_near(flux, 6, 1e-13);
    for (int32_t e = 0; e < mesh->element_count; e++)
      for (int k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * e + k], back = 0;
        for (int j = 0; other >= 0 && j < 4; j++)
          back += mesh->neighbour[4 * other + j] == e;
        assert_int_equal(back, other >= 0);
      }
    int32_t inner = (order == 1 ? 3 * 2 * 1 : 7 * 5 * 3);
    assert_int_equal(mesh->boundary_node_count, mesh->node_count - inner);
    double low[3], high[3];
    bw_mesh_box(mesh, low, high);
    check_near(low[0] + low[1] + low[2], 0, 0);
    assert_true(high[0] == 3 && high[1] == 2 && high[2] == 1);
    bw_release(mesh);
  }
}

static int ascending(const void *a, const void *b) {
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* How far apart, in numbers, the nodes of an element are: the median. */
static double median_span(const bw_mesh *mesh) {
  int32_t *span = malloc(sizeof(int32_t) * (size_t)mesh->element_count);
  for (int32_t i = 0; i < mesh->element_count; i++) {
    int32_t low = INT32_MAX, high = 0;
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t n = mesh->element[mesh->nodes_per_element * i + a];
      low = n < low ? n : low;
      high = n > high ? n : high;
    }
    span[i] = high - low;
  }
  qsort(span, (size_t)mesh->element_count, sizeof *span, ascending);
  int32_t median = span[mesh->element_count / 2];
  free(span);
  return median;
}

/* Numbers change and nothing else, and what is near in space is near in numbers: of n^3 cells a
 * curve that fills space keeps an element's nodes within some n^2 numbers at worst, mostly far
 * less.
 */
static void test_renumbered(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box(context, 8, 8, 8, order), *shuffled, *out;
    int32_t nodes = mesh->node_count, elements = mesh->element_count, width = order == 1 ? 4 : 10;
    double *place = malloc(3 * sizeof(double) * (size_t)nodes);
    int32_t *element = malloc(sizeof(int32_t) * (size_t)(width * elements));
    int32_t *region = malloc(sizeof(int32_t) * (size_t)elements), *node_from, *element_from;
    uint8_t *seen = calloc((size_t)(nodes + elements), 1);
    /* 1009 is prime: a permutation that takes neighbours apart */
    for (int32_t i = 0; i < nodes; i++)
      memcpy(place + 3 * (i * INT64_C(1009) % nodes), mesh->node + 3 * i, 3 * sizeof(double));
    for (int32_t e = 0; e < elements; e++) {
      int32_t to = (int32_t)(e * INT64_C(1009) % elements);
      for (int a = 0; a < width; a++)
        element[width * to + a] = (int32_t)(mesh->element[width * e + a] * INT64_C(1009) % nodes);
      region[to] = e % 7;
    }
    check_ok(context,
             bw_mesh_copy(context, order, nodes, place, elements, element, NULL, &shuffled));
    shuffled = check_tagged(context, shuffled, region);
    check_ok(context, bw_mesh_renumbered(context, shuffled, &node_from, &element_from, &out));
    assert_int_equal(out->node_count, nodes);
    for (int32_t i = 0; i < nodes; i++) {
      assert_int_equal(seen[node_from[i]]++, 0);
      assert_memory_equal(out->node + 3 * i, place + 3 * node_from[i], 3 * sizeof(double));
    }
    for (int32_t e = 0; e < elements; e++) {
      int32_t old = element_from[e];
      assert_int_equal(seen[nodes + old]++, 0);
      assert_int_equal(out->region[e], region[old]);
      assert_true(out->volume[e] == shuffled->volume[old]);
      for (int a = 0; a < width; a++)
        assert_int_equal(node_from[out->element[width * e + a]],
                         shuffled->element[width * old + a]);
    }
    assert_true(median_span(shuffled) > 0.5 * nodes);
    assert_true(median_span(out) < 0.06 * nodes);
    bw_release(out);
    check_ok(context, bw_mesh_renumbered(context, mesh, NULL, NULL, &out));
    assert_true(median_span(out) < 0.06 * nodes); /* wherever it came from */
    check_each_allocation(context, status, 1) {
      bw_mesh *again = NULL;
      int32_t *from = NULL;
      status = bw_mesh_renumbered(context, mesh, &from, NULL, &again);
      bw_release(again);
      bw_free(from);
    }
    bw_release(out);
    bw_release(shuffled);
    bw_release(mesh);
    bw_free(node_from);
    bw_free(element_from);
    free(place);
    free(element);
    free(region);
    free(seen);
  }
}

static void test_order(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *one = box(context, 3, 2, 2, 1), *two, *back, *same;
  check_ok(context, bw_mesh_with_order(context, one, 2, &two));
  for (int32_t i = 0; i < two->element_count; i++)
    for (int k = 0; k < 6; k++) {
      const int32_t *e = two->element + 10 * i;
      for (int j = 0; j < 3; j++)
        check_near(
            two->node[3 * e[4 + k] + j],
            (two->node[3 * e[bw_tet_edge[k][0]] + j] + two->node[3 * e[bw_tet_edge[k][1]] + j]) / 2,
            1e-15);
    }
  for (int32_t i = 0; i < two->facet_count; i++)
    for (int k = 0; k < 3; k++) {
      const int32_t *f = two->facet + 6 * i;
      for (int j = 0; j < 3; j++)
        check_near(two->node[3 * f[3 + k] + j],
                   (two->node[3 * f[k] + j] + two->node[3 * f[(k + 1) % 3] + j]) / 2, 1e-15);
    }
  check_ok(context, bw_mesh_with_order(context, two, 1, &back));
  assert_int_equal(back->node_count, one->node_count);
  assert_memory_equal(back->node, one->node, 3 * sizeof(double) * (size_t)one->node_count);
  assert_memory_equal(back->element, one->element, 16 * (size_t)one->element_count);
  check_ok(context, bw_mesh_with_order(context, one, 1, &same));
  assert_ptr_equal(same, one);
  check_fails(context, BW_INVALID, "order 3", bw_mesh_with_order(context, one, 3, &same));
  bw_release(same);
  bw_release(back);
  bw_release(two);
  bw_release(one);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh;
  double node[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 0, -1}};
  int32_t good[] = {0, 1, 2, 3};
  check_fails(context, BW_INVALID, "order 4",
              bw_mesh_copy(context, 4, 6, node[0], 1, good, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "no elements",
              bw_mesh_copy(context, 1, 6, node[0], 0, good, NULL, &mesh));
  int32_t wild[] = {0, 1, 2, 3, 0, 1, 2, 6}, negative[] = {0, 1, 2, -1};
  check_fails(context, BW_GEOMETRY, "element 2 names node 7",
              bw_mesh_copy(context, 1, 6, node[0], 2, wild, NULL, &mesh));
  check_fails(context, BW_GEOMETRY, "node 0",
              bw_mesh_copy(context, 1, 6, node[0], 1, negative, NULL, &mesh));
  int32_t flat[] = {0, 1, 2, 3, 0, 1, 2, 2};
  check_fails(context, BW_GEOMETRY, "element 2 (nodes 1 2 3 3)",
              bw_mesh_copy(context, 1, 6, node[0], 2, flat, NULL, &mesh));
  int32_t three[] = {0, 1, 2, 3, 0, 1, 2, 5, 0, 1, 2, 4};
  check_fails(context, BW_GEOMETRY, "third",
              bw_mesh_copy(context, 1, 6, node[0], 3, three, NULL, &mesh));
  int32_t overlap[] = {0, 1, 2, 3, 0, 1, 2, 4};
  check_fails(context, BW_GEOMETRY, "overlap",
              bw_mesh_copy(context, 1, 6, node[0], 2, overlap, NULL, &mesh));
  node[3][1] = NAN;
  check_fails(context, BW_GEOMETRY, "node 4",
              bw_mesh_copy(context, 1, 6, node[0], 1, good, NULL, &mesh));
  /* A sheet of a billionth of a metre far from the origin: flat to within rounding. */
  double far[4][3] = {{1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6, 1, 0}, {1e6, 0, 1e-9}};
  check_fails(context, BW_GEOMETRY, "no volume",
              bw_mesh_copy(context, 1, 4, far[0], 1, good, NULL, &mesh));

  /* Two quadratic elements that differ in a mid-edge node of their common face. */
  bw_mesh *wide = box(context, 1, 1, 1, 2);
  int32_t torn[60];
  memcpy(torn, wide->element, sizeof torn);
  double more[28 * 3];
  memcpy(more, wide->node, 27 * 3 * sizeof(double));
  int inner = -1; /* a middle on the diagonal from corner to corner, common to all six */
  for (int k = 4; k < 10; k++)
    if (fabs(wide->node[3 * torn[k]] - 1.5) + fabs(wide->node[3 * torn[k] + 1] - 1) +
            fabs(wide->node[3 * torn[k] + 2] - 0.5) <
        1e-12)
      inner = k;
  assert_true(inner > 0);
  memcpy(more + 81, more + 3 * torn[inner], 3 * sizeof(double));
  torn[inner] = 27;
  check_fails(context, BW_GEOMETRY, "mid-edge nodes",
              bw_mesh_copy(context, 2, 28, more, 6, torn, NULL, &mesh));
  bw_release(wide);
}

static void test_moved(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 3, 3, 3, 2), *moved, *again;
  double *node = BW_NEW(context, double, 3 * mesh->node_count);
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    node[i] = 2 * mesh->node[i];
  check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
  check_ok(context, bw_mesh_moved(context, moved, node, &again));
  assert_ptr_equal(again->element, mesh->element);
  assert_true(bw_bytes(again) < bw_bytes(mesh));
  bw_release(moved);
  bw_release(mesh); /* the topology stays alive under `again` */
  check_near(bw_mesh_volume(again), 48, 1e-12);
  int32_t victim = again->element[10 * 7 + 2];
  node[3 * victim] += 100;
  check_fails(context, BW_GEOMETRY, "inverted", bw_mesh_moved(context, again, node, &moved));
  node[3 * victim] = INFINITY;
  check_fails(context, BW_GEOMETRY, "finite", bw_mesh_moved(context, again, node, &moved));
  bw_free(node);
  bw_release(again);
}

static void test_subset_and_boundary(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 5, 1, 1, 2), *part;
  uint8_t keep[30] = {0};
  memset(keep, 1, 6);       /* the first cell */
  memset(keep + 18, 1, 12); /* the fourth and fifth */
  check_ok(context, bw_mesh_subset(context, mesh, keep, &part));
  assert_int_equal(part->element_count, 18);
  assert_int_equal(part->component_count, 2);
  check_near(bw_mesh_volume(part), 6 * 3 / 5.0, 1e-13);
  assert_int_equal(part->component[0], 0);
  bw_surface *surface;
  int32_t *node;
  check_ok(context, bw_mesh_boundary(context, part, &surface, &node));
  check_near(bw_surface_volume(surface), 3.6, 1e-13);
  assert_int_equal(surface->triangle_count, part->facet_count);
  for (int32_t i = 0; i < surface->point_count; i++)
    for (int k = 0; k < 3; k++)
      assert_true(surface->point[3 * i + k] == part->node[3 * node[i] + k]);
  bw_free(node);
  bw_release(surface);
  memset(keep, 0, sizeof keep);
  bw_mesh *none;
  check_fails(context, BW_EMPTY, "none", bw_mesh_subset(context, mesh, keep, &none));
  bw_release(part);
  bw_release(mesh);
}

static void bend(void *data, const double unit[3], double out[3]) {
  (void)data; /* a quarter of a ring, radii 1 and 2 */
  double r = 1 + unit[0], angle = unit[1] * acos(-1) / 2;
  out[0] = r * cos(angle);
  out[1] = r * sin(angle);
  out[2] = unit[2];
}

static void test_mapped(void **state) {
  bw_context *context = check_context(state);
  int cells[3] = {3, 24, 2};
  bw_mesh *mesh;
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, bend, NULL, &mesh));
  double exact = 0.75 * acos(-1), h = acos(-1) / 2 / 24; /* chords lose (1 - sin h / h) of it */
  check_near(bw_mesh_volume(mesh), exact * sin(h) / h, 1e-12);
  /* mid-edge nodes lie on the curve too */
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    const double *x = mesh->node + 3 * mesh->boundary_node[i];
    double r = hypot(x[0], x[1]), angle = atan2(x[1], x[0]) / h * 2;
    check_near(angle, round(angle), 1e-9);
    check_near(6 * r, round(6 * r), 1e-9);
  }
  bw_release(mesh);
  int none[3] = {3, 0, 2}, huge[3] = {1000, 1000, 1000};
  check_fails(context, BW_INVALID, "3 x 0 x 2",
              bw_mesh_mapped_box(context, none, 1, bend, NULL, &mesh));
  check_fails(context, BW_LIMIT, "6000000000",
              bw_mesh_mapped_box(context, huge, 1, bend, NULL, &mesh));
}

/* A star of elements around one node fills one bucket: the sort must not be quadratic there, and
 * the result must not depend on it. */
static void test_hub(void **state) {
  bw_context *context = check_context(state);
  enum { N = 20000 };
  double *node = BW_NEW(context, double, 3 * (N + 3));
  int32_t *element = BW_NEW(context, int32_t, 4 * N);
  memcpy(node, (double[]){0, 0, 0, 0, 0, 1}, 6 * sizeof(double));
  for (int i = 0; i <= N; i++) {
    double angle = 6 * (double)i / N;
    node[6 + 3 * i] = cos(angle);
    node[7 + 3 * i] = sin(angle);
    node[8 + 3 * i] = 0;
  }
  for (int i = 0; i < N; i++)
    memcpy(element + 4 * i, (int32_t[]){0, 2 + i, 3 + i, 1}, 16);
  bw_mesh *mesh;
  check_ok(context, bw_mesh_adopt(context, 1, N + 3, node, N, element, NULL, &mesh));
  assert_int_equal(mesh->facet_count, 2 * N + 2);
  check_near(bw_mesh_volume(mesh), 1, 1e-6);
  bw_release(mesh);
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  check_each_allocation(context, status, 1) {
    int cells[3] = {2, 1, 1};
    double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    bw_mesh *mesh = NULL, *one = NULL, *part = NULL, *moved = NULL;
    bw_surface *surface = NULL;
    int32_t *number = NULL;
    uint8_t keep[12] = {1, 1, 1};
    status = bw_mesh_box_grid(context, low, high, cells, 2, &mesh);
    if (status == BW_OK)
      status = bw_mesh_with_order(context, mesh, 1, &one);
    if (status == BW_OK)
      status = bw_mesh_subset(context, mesh, keep, &part);
    if (status == BW_OK)
      status = bw_mesh_moved(context, mesh, mesh->node, &moved);
    if (status == BW_OK)
      status = bw_mesh_boundary(context, mesh, &surface, &number);
    bw_free(number);
    bw_release(surface);
    bw_release(moved);
    bw_release(part);
    bw_release(one);
    bw_release(mesh);
  }
}

check_main(check_test(test_one_element), check_test(test_grid), check_test(test_order),
           check_test(test_renumbered), check_test(test_refusals), check_test(test_moved),
           check_test(test_subset_and_boundary), check_test(test_mapped), check_test(test_hub),
           check_test(test_allocation_failures))
