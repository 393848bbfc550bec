/* Names of faces on surfaces and meshes, and triangles between polygons. */
#include "barwright/boolean.h"
#include "barwright/shape.h"
#include "check.h"

/* The area of a mesh's facets of a name. */
static double named_area(bw_context *context, const bw_mesh *mesh, const char *name) {
  bw_surface *boundary = NULL;
  double area = 0;
  check_ok(context, bw_mesh_boundary(context, mesh, &boundary, NULL));
  for (int32_t t = 0; t < boundary->triangle_count; t++) {
    const int32_t *c = boundary->triangle + 3 * (size_t)t;
    const double *x = boundary->point;
    double u[3], v[3], n[3];
    for (size_t k = 0; k < 3; k++) {
      u[k] = x[3 * (size_t)c[1] + k] - x[3 * (size_t)c[0] + k];
      v[k] = x[3 * (size_t)c[2] + k] - x[3 * (size_t)c[0] + k];
    }
    bw_cross(u, v, n);
    if (bw_face_names_is(boundary->names, boundary->group[t], name))
      area += 0.5 * bw_norm(n);
  }
  bw_release(boundary);
  return area;
}

static bw_mesh *make_mesh(bw_context *context) {
  const double low[3] = {0, 0, 0}, high[3] = {3, 2, 1};
  bw_surface *box = NULL;
  bw_mesh *mesh = NULL;
  bw_fill_options options;
  bw_fill_options_default(&options);
  options.edge_length = 0.5;
  check_ok(context, bw_surface_box_shape(context, low, high, &box));
  check_ok(context, bw_mesh_fill(context, box, &options, &mesh, NULL));
  bw_release(box);
  return mesh;
}

static void test_meshes(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_mesh(context), *other = NULL;
  check_near(named_area(context, mesh, "top"), 6, 1e-12);
  check_near(named_area(context, mesh, "left"), 2, 1e-12);
  check_ok(context, bw_mesh_with_order(context, mesh, 2, &other));
  check_near(named_area(context, other, "front"), 3, 1e-12);
  bw_release(other);
  check_ok(context, bw_mesh_renumbered(context, mesh, NULL, NULL, &other));
  check_near(named_area(context, other, "back"), 3, 1e-12);
  bw_release(other);
  check_ok(context, bw_mesh_moved(context, mesh, mesh->node, &other));
  check_near(named_area(context, other, "right"), 2, 1e-12);
  bw_release(other);
  uint8_t *levels = BW_NEW0(context, uint8_t, mesh->element_count);
  bw_refinement refined;
  for (int32_t e = 0; e < mesh->element_count; e += 7)
    levels[e] = 3;
  check_ok(context, bw_mesh_refine(context, mesh, levels, 1, 1000000, &refined));
  assert_true(refined.mesh->element_count > mesh->element_count);
  check_near(named_area(context, refined.mesh, "bottom"), 6, 1e-12);
  bw_refinement_clear(&refined);
  /* A part keeps its outer faces; the cut has no name. */
  for (int32_t e = 0; e < mesh->element_count; e++)
    levels[e] = e % 2 == 0;
  check_ok(context, bw_mesh_subset(context, mesh, levels, &other));
  double outer = 0;
  static const char *const name[6] = {"left", "right", "front", "back", "bottom", "top"};
  for (int i = 0; i < 6; i++)
    outer += named_area(context, other, name[i]);
  assert_true(outer > 1 && outer < 22);
  int32_t unnamed = 0;
  for (int32_t t = 0; t < other->facet_count; t++)
    unnamed += other->facet_group[t] < 0;
  assert_true(unnamed > 0);
  bw_release(other);
  bw_free(levels);
  bw_release(mesh);
}

/* The sides of a grid have the names and the areas of those of the box, at both orders. */
static void test_box_grids(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {-0.1, 0.3, 7}, high[3] = {2.9, 2.3, 8};
  const int cells[3] = {5, 3, 2};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
    check_near(named_area(context, mesh, "left"), 2, 1e-12);
    check_near(named_area(context, mesh, "right"), 2, 1e-12);
    check_near(named_area(context, mesh, "front"), 3, 1e-12);
    check_near(named_area(context, mesh, "back"), 3, 1e-12);
    check_near(named_area(context, mesh, "bottom"), 6, 1e-12);
    check_near(named_area(context, mesh, "top"), 6, 1e-12);
    bw_release(mesh);
  }
}

/* Facets keep their order in a refilled mesh, which is not that of its elements. */
static void test_refilled(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_mesh(context), *refilled = NULL, *other = NULL;
  uint8_t *replace = BW_NEW0(context, uint8_t, mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    replace[e] = mesh->node[3 * (size_t)mesh->element[4 * (size_t)e]] > 1.2;
  check_ok(context, bw_mesh_refill(context, mesh, mesh->node, replace, &refilled, NULL, NULL));
  check_near(named_area(context, refilled, "right"), 2, 1e-12);
  check_near(named_area(context, refilled, "top"), 6, 1e-12);
  check_near(named_area(context, refilled, "front"), 3, 1e-12);
  /* What is made from that one has them too. */
  check_ok(context, bw_mesh_renumbered(context, refilled, NULL, NULL, &other));
  check_near(named_area(context, other, "right"), 2, 1e-12);
  check_near(named_area(context, other, "left"), 2, 1e-12);
  bw_release(other);
  check_ok(context, bw_mesh_with_order(context, refilled, 2, &other));
  check_near(named_area(context, other, "top"), 6, 1e-12);
  bw_release(other);
  bw_free(replace);
  bw_release(refilled);
  bw_release(mesh);
}

static void test_booleans(void **state) {
  bw_context *context = check_context(state);
  const double low[3] = {0, 0, 0}, high[3] = {3, 2, 1}, base[3] = {1, 1, -1}, axis[3] = {0, 0, 3};
  static const bw_name hole = {"hole"};
  bw_surface *box = NULL, *drill = NULL, *named = NULL, *made = NULL;
  bw_face_names *names = NULL;
  check_ok(context, bw_surface_box_shape(context, low, high, &box));
  check_ok(context, bw_surface_cylinder_shape(context, base, axis, 0.5, 8, &drill));
  int32_t *group = BW_NEW0(context, int32_t, drill->triangle_count);
  check_ok(context, bw_face_names_create(context, 1, &hole, NULL, &names));
  check_ok(context, bw_surface_with_names(context, drill, group, names, &named));
  check_ok(context, bw_surface_boolean(context, box, named, BW_BOOLEAN_DIFFERENCE, &made));
  int32_t count[2] = {0, 0};
  for (int32_t t = 0; t < made->triangle_count; t++) {
    count[0] += bw_face_names_is(made->names, made->group[t], "hole");
    count[1] += bw_face_names_is(made->names, made->group[t], "top");
  }
  assert_true(count[0] >= 16 && count[1] >= 10);
  bw_surface *bare = NULL, *none = NULL;
  check_ok(context, bw_surface_copy(context, box->point_count, box->point, box->triangle_count,
                                    box->triangle, NULL, &bare));
  check_fails(context, BW_INVALID, "need a group",
              bw_surface_with_names(context, bare, NULL, names, &none));
  bw_release(bare);
  bw_free(group);
  bw_release(names);
  bw_release(named);
  bw_release(made);
  bw_release(drill);
  bw_release(box);
}

static void test_polygons(void **state) {
  bw_context *context = check_context(state);
  /* A square with a square hole, and a triangle in the hole. */
  const double point[22] = {0, 0, 6, 0, 6, 6, 0, 6, 1, 1, 1, 5, 5, 5, 5, 1, 2, 2, 4, 2, 3, 4};
  const int32_t start[4] = {0, 4, 8, 11};
  int32_t *triangle = NULL;
  int64_t count = 0;
  check_ok(context, bw_polygons_triangles(context, 3, start, point, &triangle, &count));
  assert_int_equal(count, 8 + 1);
  double area = 0;
  for (int64_t t = 0; t < count; t++) {
    const double *a = point + 2 * triangle[3 * t], *b = point + 2 * triangle[3 * t + 1],
                 *c = point + 2 * triangle[3 * t + 2];
    double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    assert_true(twice > 0);
    area += 0.5 * twice;
  }
  check_near(area, 36 - 16 + 2, 1e-14);
  bw_free(triangle);
  const double crossed[8] = {0, 0, 1, 1, 1, 0, 0, 1};
  check_fails(context, BW_GEOMETRY, "touch or cross",
              bw_polygons_triangles(context, 1, start, crossed, &triangle, &count));
  const double onto[14] = {0, 0, 4, 0, 4, 4, 0, 4, 2, 0, 3, 2, 1, 2};
  const int32_t two[3] = {0, 4, 7};
  check_fails(context, BW_GEOMETRY, "touch or cross",
              bw_polygons_triangles(context, 2, two, onto, &triangle, &count));
  const double flat[6] = {0, 0, 1, 0, 2, 0};
  const int32_t one[2] = {0, 3};
  check_fails(context, BW_GEOMETRY, "",
              bw_polygons_triangles(context, 1, one, flat, &triangle, &count));
}

static bw_status make_all(bw_context *context, const bw_mesh *mesh) {
  const double low[3] = {0, 0, 0}, high[3] = {1, 2, 3};
  static const bw_name name[2] = {{"a"}, {"b"}};
  bw_status status = BW_OK;
  bw_surface *box = NULL, *named = NULL, *welded = NULL;
  bw_face_names *names = NULL;
  bw_mesh *wide = NULL, *moved = NULL;
  BW_TRY(bw_surface_box_shape(context, low, high, &box));
  BW_TRY(bw_face_names_create(context, 2, name, NULL, &names));
  BW_TRY(bw_surface_with_names(context, box, NULL, names, &named));
  BW_TRY(bw_surface_weld(context, named, 0, &welded));
  BW_TRY(bw_mesh_with_order(context, mesh, 2, &wide));
  BW_TRY(bw_mesh_renumbered(context, mesh, NULL, NULL, &moved));
done:
  bw_release(box);
  bw_release(named);
  bw_release(welded);
  bw_release(names);
  bw_release(wide);
  bw_release(moved);
  return status;
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_mesh(context);
  check_each_allocation(context, status, 1) {
    status = make_all(context, mesh);
  }
  bw_release(mesh);
}

check_main(check_test(test_meshes), check_test(test_box_grids), check_test(test_refilled),
           check_test(test_booleans), check_test(test_polygons),
           check_test(test_allocation_failures))
