/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions: they stay with their elements through every change of a mesh; splits, interfaces, and
 * filling several surfaces. */
#include "../check.h"

static bw_mesh *box(bw_context *context, int cells, int order) {
  bw_mesh *mesh;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){3, 1, 1},
                                     (int[3]){3 * cells, cells, cells}, order, &mesh));
  return mesh;
}

/* The third of the box that an element lies in: 0, 1 or 2. */
static int third_of(const bw_mesh *mesh, int32_t e) {
  double middle = 0;
  for (int a = 0; a < 4; a++)
    middle += 0.25 * mesh->node[3 * mesh->element[e * mesh->nodes_per_element + a]];
  return (int)middle;
}

/* Thirds of the box; tags descend along x, and the table is in no order. */
static bw_mesh *thirds(bw_context *context, int order) {
  bw_mesh *plain = box(context, 2, order), *mesh;
  int32_t *of_element = malloc(sizeof *of_element * (size_t)plain->element_count);
  for (int32_t e = 0; e < plain->element_count; e++)
    of_element[e] = (third_of(plain, e) + 1) % 3;
  bw_mesh_region region[4] = {{-4, 99, {"right"}}, {30, 0, {"left"}}, {7, 0, {""}}, {8, 5, {"no"}}};
  bw_mesh_regions regions = {4, region, of_element};
  check_ok(context, bw_mesh_with_regions(context, plain, &regions, &mesh));
  assert_ptr_equal(mesh->node, plain->node);
  assert_ptr_equal(mesh->element, plain->element);
  free(of_element);
  bw_release(plain);
  return mesh;
}

/* The three regions with their names, each in its third, with a third of the volume. */
static void check_thirds(const bw_mesh *mesh) {
  static const char *const name[3] = {"left", "region 7", "right"};
  static const int32_t tag[3] = {30, 7, -4};
  double volume[3];
  int32_t elements = 0;
  assert_int_equal(mesh->region_count, 3);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(mesh->regions[2 - i].tag, tag[i]);
    assert_string_equal(mesh->regions[2 - i].name.text, name[i]);
    assert_int_equal(bw_mesh_find_region(mesh, name[i]), 2 - i);
    elements += mesh->regions[i].element_count;
  }
  assert_int_equal(bw_mesh_find_region(mesh, "no"), -1);
  assert_int_equal(elements, mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    assert_int_equal(mesh->region[e], 2 - third_of(mesh, e));
  bw_mesh_region_volumes(mesh, volume);
  for (int i = 0; i < 3; i++)
    check_near(volume[i], bw_mesh_volume(mesh) / 3, 1e-12);
}

static void regions_are_kept(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = thirds(context, order), *out, *other;
    check_thirds(mesh);
    check_ok(context, bw_mesh_with_order(context, mesh, 3 - order, &out));
    check_thirds(out);
    bw_release(out);
    check_ok(context, bw_mesh_renumbered(context, mesh, NULL, NULL, &out));
    check_thirds(out);
    bw_release(out);

    double *node = malloc(24 * (size_t)mesh->node_count);
    for (int i = 0; i < 3 * mesh->node_count; i++)
      node[i] = mesh->node[i] * (i % 3 ? 2 : 1);
    check_ok(context, bw_mesh_moved(context, mesh, node, &out));
    free(node);
    bw_release(mesh); /* what the moved mesh borrows stays */
    check_thirds(out);
    check_ok(context, bw_mesh_with_regions(context, out, NULL, &other));
    assert_null(other->region);
    assert_int_equal(other->region_count, 0);
    bw_release(other);
    mesh = out;

    uint8_t *level = calloc((size_t)mesh->element_count, 1);
    bw_refinement refinement;
    level[0] = level[mesh->element_count - 1] = 4;
    check_ok(context, bw_mesh_refine(context, mesh, level, order, 100000, &refinement));
    assert_true(refinement.mesh->element_count > mesh->element_count + 16);
    check_thirds(refinement.mesh);
    bw_refinement_clear(&refinement);

    for (int32_t e = 0; e < mesh->element_count; e++) /* a whole region goes */
      level[e] = third_of(mesh, e) != 1;
    check_ok(context, bw_mesh_subset(context, mesh, level, &out));
    assert_int_equal(out->region_count, 2);
    assert_string_equal(out->regions[0].name.text, "right");
    assert_string_equal(out->regions[1].name.text, "left");
    for (int32_t e = 0; e < out->element_count; e++)
      assert_int_equal(out->region[e], third_of(out, e) == 0);
    free(level);
    bw_release(out);
    bw_release(mesh);
  }
}

static void bad_regions(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 1, 1), *out = NULL;
  int32_t *of_element = calloc((size_t)mesh->element_count, sizeof *of_element);
  bw_mesh_region region[2] = {{1, 0, {"steel"}}, {2, 0, {"steel"}}};
  bw_mesh_regions regions = {2, region, of_element};
  check_ok(context, bw_mesh_with_regions(context, mesh, &regions, &out)); /* the second is empty */
  assert_int_equal(out->region_count, 1);
  bw_release(out);
  of_element[3] = 1;
  check_fails(context, BW_INVALID, "'steel', those of the tags 1 and 2",
              bw_mesh_with_regions(context, mesh, &regions, &out));
  region[1] = (bw_mesh_region){1, 0, {"brass"}};
  check_fails(context, BW_INVALID, "'steel' and 'brass' both have the tag 1",
              bw_mesh_with_regions(context, mesh, &regions, &out));
  region[1].tag = 3;
  of_element[5] = 2;
  check_fails(context, BW_INVALID, "element 6 is in region number 3, but there are 2 regions",
              bw_mesh_with_regions(context, mesh, &regions, &out));
  of_element[5] = 1;
  out = NULL;
  check_allocations(context, out, bw_mesh_with_regions(context, mesh, &regions, &out));
  free(of_element);
  bw_release(mesh);
}

/* ---- splits and interfaces ------------------------------------------------------------------- */

typedef struct slab {
  int axis;
  double low, high;
} slab;

static bw_status in_slab(void *data, int64_t count, const double *at, uint8_t *inside) {
  const slab *s = data;
  for (int64_t i = 0; i < count; i++)
    inside[i] = at[3 * i + s->axis] >= s->low && at[3 * i + s->axis] <= s->high;
  return BW_OK;
}

typedef struct ball {
  bw_context *context;
  bw_surface *surface;
} ball;

static bw_status in_ball(void *data, int64_t count, const double *at, uint8_t *inside) {
  const ball *b = data;
  return bw_surface_contains(b->context, b->surface, count, at, inside);
}

/* Every pair of regions: both sides agree, facets face region b, and their vector areas do too. */
static void check_interfaces(bw_context *context, const bw_mesh *mesh) {
  const int width = mesh->nodes_per_facet;
  for (int32_t a = 0; a < mesh->region_count; a++)
    for (int32_t b = a + 1; b < mesh->region_count; b++) {
      bw_mesh_interface one, two;
      check_ok(context, bw_mesh_interface_find(context, mesh, a, b, &one));
      check_ok(context, bw_mesh_interface_find(context, mesh, b, a, &two));
      assert_int_equal(one.count, two.count);
      assert_true(one.area == two.area);
      for (int32_t i = 0; i < one.count; i++) {
        const int32_t *f = one.facet + i * width, *g = two.facet + i * width;
        assert_int_equal(mesh->region[one.element[2 * i]], a);
        assert_int_equal(mesh->region[one.element[2 * i + 1]], b);
        assert_int_equal(one.element[2 * i], two.element[2 * i + 1]);
        assert_int_equal(one.element[2 * i + 1], two.element[2 * i]);
        double u[3], v[3], n[3], away[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
          u[k] = mesh->node[3 * f[1] + k] - mesh->node[3 * f[0] + k];
          v[k] = mesh->node[3 * f[2] + k] - mesh->node[3 * f[0] + k];
          for (int c = 0; c < 4; c++) /* from the facet to the middle of the element of b */
            away[k] +=
                0.25 *
                mesh->node[3 * mesh->element[one.element[2 * i + 1] * mesh->nodes_per_element + c] +
                           k];
          away[k] -= mesh->node[3 * f[0] + k];
        }
        bw_cross(u, v, n);
        assert_true(bw_dot(n, away) > 0);
        assert_int_equal(f[0], g[0]);
        assert_int_equal(f[1], g[2]);
        assert_int_equal(f[2], g[1]);
        for (int k = 0; mesh->order == 2 && k < 3; k++) { /* mid-edge nodes lie between */
          for (int x = 0; x < 3; x++) {
            check_near(mesh->node[3 * f[3 + k] + x],
                       0.5 * (mesh->node[3 * f[k] + x] + mesh->node[3 * f[(k + 1) % 3] + x]),
                       1e-12);
            check_near(mesh->node[3 * g[3 + k] + x],
                       0.5 * (mesh->node[3 * g[k] + x] + mesh->node[3 * g[(k + 1) % 3] + x]),
                       1e-12);
          }
        }
      }
      bw_mesh_interface_clear(&one);
      bw_mesh_interface_clear(&two);
    }
}

static double total(const bw_mesh *mesh) {
  double volume[8], sum = 0;
  bw_mesh_region_volumes(mesh, volume);
  for (int i = 0; i < mesh->region_count; i++)
    sum += volume[i];
  return sum;
}

/* Along planes of elements a split is exact; a second one takes from both regions. */
static void splits(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *plain = box(context, 4, order), *one, *two;
    bw_split_log log;
    slab left = {0, -1, 1.25}, low = {2, 0, 0.5};
    check_ok(context, bw_mesh_split(context, plain, "left", in_slab, &left, &one, &log));
    check_near(log.volume, 1.25, 1e-12);
    assert_true(log.misplaced == 0);
    assert_int_equal(log.cut, 0);
    assert_string_equal(one->regions[0].name.text, "rest");
    check_ok(context, bw_mesh_split(context, one, "low", in_slab, &low, &two, NULL));
    assert_int_equal(two->region_count, 3);
    check_near(total(two), 3, 1e-12);
    check_interfaces(context, two);
    bw_mesh_interface face;
    check_ok(context, bw_mesh_interface_find(context, one, 0, 1, &face));
    check_near(face.area, 1, 1e-12);
    bw_mesh_interface_clear(&face);
    check_fails(context, BW_INVALID, "already a region 'left'",
                bw_mesh_split(context, one, "left", in_slab, &low, &two, NULL));
    low.low = 7, low.high = 8;
    check_fails(context, BW_EMPTY, "would be empty",
                bw_mesh_split(context, one, "high", in_slab, &low, &two, NULL));
    low.low = -1;
    check_fails(context, BW_EMPTY, "would be the whole mesh",
                bw_mesh_split(context, one, "high", in_slab, &low, &two, NULL));
    check_fails(context, BW_INVALID, "two different regions from 1 to 2",
                bw_mesh_interface_find(context, one, 1, 1, &face));
    bw_release(two);
    bw_release(one);
    bw_release(plain);
  }
}

/* What is misplaced about a ball bounds the error of its volume, and shrinks with the elements. A
 * plane through the elements is known exactly: those that it halves are sampled evenly. */
static void split_errors(void **state) {
  bw_context *context = check_context(state);
  ball b = {context, NULL};
  double before = HUGE_VAL, exact;
  bw_split_log log;
  bw_mesh *split;
  check_ok(context,
           bw_surface_sphere_shape(context, (double[3]){1.51, 0.52, 0.49}, 0.4, 4, &b.surface));
  exact = bw_surface_volume(b.surface);
  for (int cells = 4; cells <= 16; cells *= 2) {
    bw_mesh *plain = box(context, cells, 1);
    check_ok(context, bw_mesh_split(context, plain, "ball", in_ball, &b, &split, &log));
    assert_true(fabs(log.volume - exact) < log.misplaced + 0.01 * exact);
    assert_true(log.misplaced > 0 && log.misplaced < 0.7 * before);
    check_near(total(split), 3, 1e-11);
    check_interfaces(context, split);
    before = log.misplaced;
    bw_release(split);
    bw_release(plain);
  }
  bw_release(b.surface);
  double node[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
  int32_t both[] = {0, 1, 2, 3, 1, 2, 3, 4};
  bw_mesh *pair;
  check_ok(context, bw_mesh_copy(context, 1, 5, node, 2, both, NULL, &pair));
  slab half = {0, -1,
               0.5 - 1e-9}; /* of the first element 1/8 is outside, of the second half is inside */
  check_ok(context, bw_mesh_split(context, pair, "half", in_slab, &half, &split, &log));
  check_near(log.misplaced, 1. / 6 / 8 + 1. / 3 / 2, 1e-12);
  assert_int_equal(log.cut, 2);
  bw_release(split);
  bw_release(pair);
}

/* ---- filling several surfaces -----------------------------------------------------------------
 */

static bw_surface *cuboid(bw_context *context, double x0, double y0, double z0, double x1,
                          double y1, double z1) {
  bw_surface *s;
  check_ok(context,
           bw_surface_box_shape(context, (double[3]){x0, y0, z0}, (double[3]){x1, y1, z1}, &s));
  return s;
}

static bw_surface *sphere(bw_context *context, double radius) {
  bw_surface *s;
  check_ok(context, bw_surface_sphere_shape(context, (double[3]){0, 0, 0}, radius, 3, &s));
  return s;
}

static void release_parts(bw_fill_part *part, int count) {
  for (int p = 0; p < count; p++)
    bw_release(part[p].surface);
}

/* Layers, an inclusion that touches the boundary of its matrix, a smaller face on a larger one, and
 * a body apart: volumes are those of the surfaces, interfaces have the areas that they share. */
static void fills_parts(void **state) {
  bw_context *context = check_context(state);
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.edge_length = 0.4;
  for (int order = 1; order <= 2; order++) {
    options.order = order;
    bw_fill_part part[5] = {{{"core"}, sphere(context, 0.4)},
                            {{"middle"}, sphere(context, 0.7)},
                            {{"shell"}, sphere(context, 1)},
                            {{"apart"}, cuboid(context, 3, 0, 0, 4, 1, 1)},
                            {{"on it"}, cuboid(context, 4, 0.25, 0.125, 5, 0.5, 0.75)}};
    double volume[5], whole[5];
    bw_mesh *mesh;
    bw_mesh_interface face;
    for (int p = 0; p < 5; p++)
      whole[p] = bw_surface_volume(part[p].surface);
    check_ok(context, bw_mesh_fill_parts(context, 5, part, 0, &options, &mesh));
    assert_int_equal(mesh->order, order);
    assert_int_equal(mesh->region_count, 5);
    bw_mesh_region_volumes(mesh, volume);
    for (int p = 0; p < 5; p++) {
      assert_string_equal(mesh->regions[p].name.text, part[p].name.text);
      check_near(volume[p], whole[p] - (p == 1 || p == 2 ? whole[p - 1] : 0), 1e-9);
    }
    check_interfaces(context, mesh);
    for (int p = 0; p < 2; p++) {
      check_ok(context, bw_mesh_interface_find(context, mesh, p, p + 1, &face));
      check_near(face.area, bw_surface_area(part[p].surface), 1e-9);
      bw_mesh_interface_clear(&face);
    }
    check_ok(context, bw_mesh_interface_find(context, mesh, 3, 4, &face));
    check_near(face.area, 0.25 * 0.625, 1e-12);
    bw_mesh_interface_clear(&face);
    check_ok(context, bw_mesh_interface_find(context, mesh, 2, 3, &face));
    assert_int_equal(face.count, 0);
    bw_mesh_interface_clear(&face);
    bw_release(mesh);
    release_parts(part, 5);
  }
}

/* Boxes at random cells of a grid either touch or are apart; one around them all is the matrix. */
static void fills_random_boxes(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_fill_options options;
  bw_fill_options_default(&options);
  bw_random_seed(&random, 19);
  for (int round = 0; round < 4; round++) {
    bool taken[27] = {false};
    bw_fill_part part[6] = {{{"matrix"}, cuboid(context, 0, 0, 0, 3, 3, 3)}};
    double volume[6];
    bw_mesh *mesh;
    for (int p = 1; p < 6; p++) {
      int cell;
      do
        cell = (int)(27 * bw_random_uniform(&random));
      while (taken[cell]);
      taken[cell] = true;
      int x = cell % 3, y = cell / 3 % 3, z = cell / 9;
      snprintf(part[p].name.text, BW_NAME, "cell %d", p);
      part[p].surface = cuboid(context, x, y, z, x + 1, y + 1, z + 1);
    }
    check_ok(context, bw_mesh_fill_parts(context, 6, part, 0, &options, &mesh));
    bw_mesh_region_volumes(mesh, volume);
    check_near(volume[0], 22, 1e-10);
    for (int p = 1; p < 6; p++)
      check_near(volume[p], 1, 1e-10);
    check_interfaces(context, mesh);
    bw_release(mesh);
    release_parts(part, 6);
  }
}

static void bad_parts(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh;
  bw_fill_part part[2] = {{{"a"}, cuboid(context, 0, 0, 0, 1, 1, 1)},
                          {{"b"}, cuboid(context, 0.5, 0.25, 0.25, 2, 0.75, 0.75)}};
  check_fails(context, BW_GEOMETRY, "'a' and 'b' overlap",
              bw_mesh_fill_parts(context, 2, part, 0, NULL, &mesh));
  bw_release(part[1].surface);
  part[1].surface = bw_retain(part[0].surface);
  check_fails(context, BW_GEOMETRY, "'a' and 'b' are the same body",
              bw_mesh_fill_parts(context, 2, part, 0, NULL, &mesh));
  part[1].name = part[0].name;
  check_fails(context, BW_INVALID, "two parts are called 'a'",
              bw_mesh_fill_parts(context, 2, part, 0, NULL, &mesh));
  bw_release(part[1].surface);
  part[1] = (bw_fill_part){{"open"}, NULL};
  bw_surface *open;
  check_ok(context, bw_surface_copy(context, part[0].surface->point_count, part[0].surface->point,
                                    part[0].surface->triangle_count - 1, part[0].surface->triangle,
                                    NULL, &open));
  part[1].surface = open;
  check_fails(context, BW_GEOMETRY, "the part 'open' is not sound",
              bw_mesh_fill_parts(context, 2, part, 0, NULL, &mesh));
  uint8_t inside;
  check_fails(context, BW_GEOMETRY, "not closed",
              bw_surface_contains(context, open, 1, (double[3]){0, 0, 0}, &inside));
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.elements = 100;
  check_fails(context, BW_UNSUPPORTED, "not filled to a number of elements",
              bw_mesh_fill_parts(context, 1, part, 0, &options, &mesh));
  release_parts(part, 2);
}

check_main(check_test(regions_are_kept), check_test(bad_regions), check_test(splits),
           check_test(split_errors), check_test(fills_parts), check_test(fills_random_boxes),
           check_test(bad_parts))
