/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions stay with their elements through every change of a mesh. */
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

int main(void) {
  const struct CMUnitTest tests[] = {check_test(regions_are_kept), check_test(bad_regions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
