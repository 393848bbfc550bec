/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Repair: what relaxation can restore and what it must refuse; refilling keeps the boundary, the
 * volume and the equations. */
#include "check.h"

static bw_mesh *box(bw_context *context, double length, int nx, int ny, int nz, int order) {
  double low[3] = {0, 0, 0}, high[3] = {length, 1, 1};
  int cells[3] = {nx, ny, nz};
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static double *copy_nodes(bw_context *context, const bw_mesh *mesh) {
  double *node = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  memcpy(node, mesh->node, 3 * (size_t)mesh->node_count * sizeof *node);
  return node;
}

/* The boundary and mid-edge nodes are 2, other corners 0. */
static uint8_t *classify(const bw_mesh *mesh) {
  uint8_t *kind = (uint8_t *)malloc((size_t)mesh->node_count);
  memset(kind, 2, (size_t)mesh->node_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++)
      kind[mesh->element[e * mesh->nodes_per_element + k]] = 0;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    kind[mesh->boundary_node[i]] = 2;
  return kind;
}

static void straighten(const bw_mesh *mesh, double *node) {
  for (int32_t e = 0; e < mesh->element_count && mesh->order == 2; e++) {
    const int32_t *n = mesh->element + 10 * e;
    for (int k = 0; k < 6; k++)
      for (int i = 0; i < 3; i++)
        node[3 * n[4 + k] + i] =
            0.5 * (node[3 * n[bw_tet_edge[k][0]] + i] + node[3 * n[bw_tet_edge[k][1]] + i]);
  }
}

static void test_quality(void **state) {
  (void)state;
  double a[3] = {1, 1, 1}, b[3] = {1, -1, -1}, c[3] = {-1, 1, -1}, d[3] = {-1, -1, 1};
  double turned = bw_shape_quality(a, b, c, d), regular = bw_shape_quality(a, c, b, d);
  check_near(fabs(regular), 1, 1e-15);
  check_near(turned + regular, 0, 1e-15);
  /* the corner of a cube: V = 1/6, edges 1 1 1 2 2 2 squared */
  double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
  check_near(bw_shape_quality(o, x, y, z), 12 * pow(0.5, 2.0 / 3) / 9, 1e-15);
  check_near(bw_shape_quality(o, x, y, o), 0, 0);
  check_near(bw_shape_quality(o, o, o, o), 0, 0);
}

/* Inner nodes pushed through the faces opposite: relaxation restores positive volumes, moves
 * nothing that must stay, and touches only the neighbourhood. */
static void test_pushed_nodes(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box(context, 1, 8, 8, 8, order), *moved;
    uint8_t *kind = classify(mesh), *may = (uint8_t *)malloc((size_t)mesh->node_count);
    double *node = copy_nodes(context, mesh);
    bw_random random;
    bw_random_seed(&random, 7);
    memset(may, 1, (size_t)mesh->node_count);
    int pushed = 0;
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (kind[i] == 0 && bw_random_uniform(&random) < 0.06) {
        pushed++;
        for (int k = 0; k < 3; k++)
          node[3 * i + k] += (bw_random_uniform(&random) - 0.5) * 5 / 8;
      }
    straighten(mesh, node);
    assert_true(pushed > 10);
    bw_mesh_repair_report checked, report;
    bw_mesh_shape_check(mesh, node, 0, &checked);
    assert_true(checked.inverted > 30 && checked.worst_before < 0);
    check_fails(context, BW_GEOMETRY, "inverted", bw_mesh_moved(context, mesh, node, &moved));
    bw_clear_failure(context);
    check_ok(context, bw_mesh_relax(context, mesh, may, node, &report));
    assert_int_equal(report.inverted, checked.inverted);
    assert_int_equal(report.worst, checked.worst);
    bw_mesh_shape_check(mesh, node, 0, &checked);
    assert_int_equal(checked.inverted, 0);
    check_near(checked.worst_before, report.worst_after, 0);
    assert_true(report.worst_after > 0.1);
    check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
    check_near(bw_mesh_volume(moved), 1, 1e-12);
    for (int32_t i = 0; i < mesh->boundary_node_count; i++)
      assert_memory_equal(moved->node + 3 * mesh->boundary_node[i],
                          mesh->node + 3 * mesh->boundary_node[i], 24);
    double *straight = copy_nodes(context, moved);
    straighten(mesh, straight);
    assert_memory_equal(straight, moved->node, 24 * (size_t)mesh->node_count);
    bw_free(straight);
    bw_free(node);
    free(may), free(kind);
    bw_release(moved);
    bw_release(mesh);
  }
}

/* A single node through a face: only it and nodes near it may move. */
static void test_stays_local(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 4, 32, 8, 8, 1);
  uint8_t *kind = classify(mesh), *may = (uint8_t *)malloc((size_t)mesh->node_count);
  double *node = copy_nodes(context, mesh);
  int32_t pushed = -1;
  memset(may, 1, (size_t)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (kind[i] == 0 && fabs(mesh->node[3 * i] - 1) < 1e-9)
      pushed = i;
  node[3 * pushed] += 0.3;
  bw_mesh_repair_report report;
  check_ok(context, bw_mesh_relax(context, mesh, may, node, &report));
  assert_true(report.inverted > 0 && report.worst_after > 0.2);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (fabs(mesh->node[3 * i] - 1) > 0.75)
      assert_memory_equal(node + 3 * i, mesh->node + 3 * i, 24);
  /* nothing to do: nothing done */
  memcpy(node, mesh->node, 24 * (size_t)mesh->node_count);
  check_ok(context, bw_mesh_relax(context, mesh, may, node, &report));
  assert_int_equal(report.moved, 0);
  assert_int_equal(report.inverted, 0);
  assert_memory_equal(node, mesh->node, 24 * (size_t)mesh->node_count);
  bw_free(node);
  free(may), free(kind);
  bw_release(mesh);
}

/* A dent of the boundary a third deep, deeper than a layer of elements, tangles whole layers; the
 * nodes that may not move stay. */
static void test_dent(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 1, 10, 10, 10, 1), *moved;
  uint8_t *may = (uint8_t *)malloc((size_t)mesh->node_count);
  double *node = copy_nodes(context, mesh);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    may[i] = x[2] > 0.15;
    if (x[2] > 0.999) {
      double r2 = (x[0] - 0.5) * (x[0] - 0.5) + (x[1] - 0.5) * (x[1] - 0.5);
      node[3 * i + 2] -= 0.33 * exp(-8 * r2);
    }
  }
  bw_mesh_repair_report report;
  bw_mesh_shape_check(mesh, node, 0, &report);
  assert_true(report.inverted > 100);
  check_ok(context, bw_mesh_relax(context, mesh, may, node, &report));
  assert_true(report.worst_after > 0.05);
  check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (!may[i])
      assert_memory_equal(node + 3 * i, mesh->node + 3 * i, 24);
  bw_free(node);
  free(may);
  bw_release(moved);
  bw_release(mesh);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 1, 4, 4, 4, 2), *refilled;
  uint8_t *kind = classify(mesh), *may = (uint8_t *)malloc((size_t)mesh->node_count);
  double *node = copy_nodes(context, mesh), *before = copy_nodes(context, mesh);
  bw_mesh_repair_report report;
  /* A corner of the boundary through the whole box: no inner nodes can make up for that. */
  int32_t corner = -1, inner = -1;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    if (kind[i] == 0)
      inner = i;
    if (x[0] + x[1] + x[2] < 1e-9)
      corner = i;
  }
  memset(may, 1, (size_t)mesh->node_count);
  for (int k = 0; k < 3; k++)
    node[3 * corner + k] += 1.2;
  memcpy(before, node, 24 * (size_t)mesh->node_count);
  check_fails(context, BW_GEOMETRY, "folded over itself",
              bw_mesh_relax(context, mesh, may, node, &report));
  assert_memory_equal(node, before, 24 * (size_t)mesh->node_count);
  /* An inner node pushed far with nothing allowed to move. */
  memcpy(node, mesh->node, 24 * (size_t)mesh->node_count);
  memset(may, 0, (size_t)mesh->node_count);
  node[3 * inner] += 0.5;
  memcpy(before, node, 24 * (size_t)mesh->node_count);
  check_fails(context, BW_GEOMETRY, "where 4 of 4 corners",
              bw_mesh_relax(context, mesh, may, node, &report));
  assert_memory_equal(node, before, 24 * (size_t)mesh->node_count);
  node[3 * inner] = NAN;
  check_fails(context, BW_INVALID, "finite", bw_mesh_relax(context, mesh, may, node, &report));

  uint8_t *replace = (uint8_t *)calloc((size_t)mesh->element_count, 1);
  memcpy(node, mesh->node, 24 * (size_t)mesh->node_count);
  check_fails(context, BW_EMPTY, "none of the 384",
              bw_mesh_refill(context, mesh, node, replace, &refilled, NULL, NULL));
  replace[5] = 1;
  node[3 * inner] += 0.5;
  check_fails(context, BW_GEOMETRY, "not among what",
              bw_mesh_refill(context, mesh, node, replace, &refilled, NULL, NULL));
  node[3 * inner] = INFINITY;
  check_fails(context, BW_INVALID, "finite",
              bw_mesh_refill(context, mesh, node, replace, &refilled, NULL, NULL));
  /* Inside out as a whole, and a boundary that cuts itself: both say where. */
  memset(replace, 1, (size_t)mesh->element_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    memcpy(node + 3 * i, mesh->node + 3 * i, 24);
    node[3 * i] *= -1;
  }
  check_fails(context, BW_GEOMETRY, "has inward normals",
              bw_mesh_refill(context, mesh, node, replace, &refilled, NULL, NULL));
  memcpy(node, mesh->node, 24 * (size_t)mesh->node_count);
  for (int k = 0; k < 3; k++)
    node[3 * corner + k] += 1.2;
  check_fails(context, BW_GEOMETRY, "cuts itself at (",
              bw_mesh_refill(context, mesh, node, replace, &refilled, NULL, NULL));
  free(replace), free(may), free(kind);
  bw_free(node);
  bw_free(before);
  bw_release(mesh);
}

/* ---- refilling ------------------------------------------------------------------------------- */

/* A straight bar bent by turning what lies beyond x = 2 by `angle` about (2, 0, .): blended between
 * x = 1.5 and 2.5, which folds its inner side. */
static double *bend(bw_context *context, const bw_mesh *mesh, double angle) {
  double *node = copy_nodes(context, mesh);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    double w = fmin(1, fmax(0, (x[0] - 1.5)));
    double c = cos(angle), s = sin(angle), dx = x[0] - 2, dy = x[1] - 0.5;
    node[3 * i] = (1 - w) * x[0] + w * (2 + c * dx - s * dy);
    node[3 * i + 1] = (1 - w) * x[1] + w * (0.5 + s * dx + c * dy);
  }
  straighten(mesh, node);
  return node;
}

/* Signed volume enclosed by the facets at these positions. */
static double enclosed(const bw_mesh *mesh, const double *node) {
  double volume = 0;
  for (int32_t i = 0; i < mesh->facet_count; i++) {
    const int32_t *f = mesh->facet + i * mesh->nodes_per_facet;
    double c[3];
    bw_cross(node + 3 * f[1], node + 3 * f[2], c);
    volume += bw_dot(node + 3 * f[0], c) / 6;
  }
  return volume;
}

static void check_contract(const bw_mesh *mesh, const double *node, const uint8_t *replace,
                           const bw_mesh *made, const int32_t *node_from,
                           const int32_t *element_from) {
  int width = mesh->nodes_per_facet, per = mesh->nodes_per_element;
  assert_int_equal(made->facet_count, mesh->facet_count);
  for (int32_t i = 0; i < mesh->facet_count; i++) {
    bool found = false;
    for (int k = 0; k < width; k++) {
      int32_t now = made->facet[i * width + k], old = mesh->facet[i * width + k];
      assert_int_equal(node_from[now], old);
      assert_memory_equal(made->node + 3 * now, node + 3 * old, 24);
    }
    const int32_t *e = made->element + made->facet_element[i] * per;
    for (int k = 0; k < 4; k++) {
      int same = 0;
      for (int j = 0; j < 3; j++)
        for (int l = 0; l < 3; l++)
          same += e[bw_tet_face[k][j]] == made->facet[i * width + l];
      found = found || (same == 3 && made->neighbour[4 * made->facet_element[i] + k] < 0);
    }
    assert_true(found);
  }
  int32_t last = -1, next = 0;
  for (int32_t i = 0; i < made->node_count; i++) {
    if (node_from[i] < 0)
      break;
    assert_true(node_from[i] > last);
    last = node_from[i];
    next = i + 1;
    assert_memory_equal(made->node + 3 * i, node + 3 * last, 24);
  }
  for (int32_t i = next; i < made->node_count; i++)
    assert_int_equal(node_from[i], -1);
  int32_t at = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (!replace[e]) {
      assert_int_equal(element_from[at], e);
      for (int k = 0; k < per; k++)
        assert_int_equal(node_from[made->element[at * per + k]], mesh->element[e * per + k]);
      at++;
    }
  for (; at < made->element_count; at++)
    assert_true(element_from[at] < 0);
  double *straight = (double *)malloc(24 * (size_t)made->node_count);
  memcpy(straight, made->node, 24 * (size_t)made->node_count);
  straighten(made, straight);
  for (int32_t i = 0; i < 3 * made->node_count; i++)
    check_near(straight[i], made->node[i], 1e-14);
  free(straight);
}

/* A displacement linear in place, prescribed on the boundary, must come out inside as well. */
static void patch_test(bw_context *context, const bw_mesh *mesh) {
  bw_isotropic constants = {.name = "plain", .young = 2, .poisson = 0.3};
  bw_material *material = NULL;
  bw_model *model = NULL;
  bw_selection *all = NULL;
  bw_array *field = NULL;
  bw_static *result = NULL;
  check_ok(context, bw_material_isotropic(context, &constants, &material));
  check_ok(context, bw_model_create(context, mesh, material, &model));
  check_ok(context, bw_select_all(context, mesh, &all));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &field));
  double *u = (double *)field->data;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    u[3 * i] = 1e-3 * (0.1 + 0.3 * x[0] - 0.2 * x[1] + 0.7 * x[2]);
    u[3 * i + 1] = 1e-3 * (0.5 * x[0] + 0.1 * x[1]);
    u[3 * i + 2] = 1e-3 * (-0.2 - 0.4 * x[1] + 0.6 * x[2]);
  }
  const bool fixed[3] = {true, true, true};
  check_ok(context, bw_model_prescribe_field(context, model, all, fixed, field));
  check_ok(context, bw_statics(context, model, NULL, NULL, &result));
  int inner = 0;
  for (int32_t i = 0; i < 3 * mesh->node_count; i++)
    check_near(result->displacement[i], u[i], 1e-13);
  inner = mesh->node_count - mesh->boundary_node_count;
  assert_true(inner > 50);
  bw_release(result);
  bw_release(field);
  bw_release(all);
  bw_release(model);
  bw_release(material);
}

/* Inner corners between x = 1.6 and 2.4 pushed about by so much. */
static void push_inner(const bw_mesh *mesh, double *node, double by) {
  uint8_t *kind = classify(mesh);
  bw_random random;
  bw_random_seed(&random, 3);
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int k = 0; k < 3 && kind[i] == 0 && fabs(mesh->node[3 * i] - 2) < 0.4; k++)
      node[3 * i + k] += by * (bw_random_uniform(&random) - 0.5);
  straighten(mesh, node);
  free(kind);
}

static void test_bent_bar(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = box(context, 4, 24, 6, 6, order), *made = NULL;
    uint8_t *replace = (uint8_t *)malloc((size_t)mesh->element_count);
    double *node = bend(context, mesh, 1);
    int32_t *node_from, *element_from;
    push_inner(mesh, node, 0.5);
    for (int32_t e = 0; e < mesh->element_count; e++) {
      double x = 0;
      for (int k = 0; k < 4; k++)
        x += mesh->node[3 * mesh->element[e * mesh->nodes_per_element + k]] / 4;
      replace[e] = x > 1.4 && x < 2.6;
    }
    bw_mesh_repair_report report;
    bw_mesh_shape_check(mesh, node, 0, &report);
    assert_true(report.inverted > 100);
    check_ok(context,
             bw_mesh_refill(context, mesh, node, replace, &made, &node_from, &element_from));
    check_contract(mesh, node, replace, made, node_from, element_from);
    check_near(bw_mesh_volume(made), enclosed(mesh, node), 1e-12);
    bw_mesh_shape_check(made, made->node, 0, &report);
    assert_true(abs(made->element_count - mesh->element_count) < mesh->element_count / 4);
    assert_true(report.worst_before > 0.1);
    patch_test(context, made);
    bw_free(node_from);
    bw_free(element_from);
    bw_free(node);
    free(replace);
    bw_release(made);
    bw_release(mesh);
  }
}

/* Several components: apart, touching in an edge only, and a shell around elements that stay. */
static void test_components(void **state) {
  bw_context *context = check_context(state);
  for (int shape = 0; shape < 4; shape++) {
    bw_mesh *mesh = box(context, 2, 12, 6, 6, 2), *made = NULL;
    uint8_t *replace = (uint8_t *)malloc((size_t)mesh->element_count);
    int32_t *node_from, *element_from;
    int64_t removed = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
      double c[3] = {0, 0, 0};
      for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
          c[i] += mesh->node[3 * mesh->element[10 * e + k] + i] / 4;
      bool low = c[0]<0.5, high = c[0]> 1.5;
      bool a = c[0] < 1 && c[1]<0.5, b = c[0]> 1 && c[1] > 0.5;
      bool core = c[0] > 0.5 && c[0] < 1.5 && fabs(c[1] - 0.5) < 0.17 && fabs(c[2] - 0.5) < 0.17;
      /* around a core that touches the outer boundary of the shell in one edge */
      bool notch = c[0] > 1.5 && c[1] > 0.66 && c[2] > 0.66;
      bool inside =
          c[0] > 1.165 && c[0] < 1.5 && c[1] > 0.332 && c[1] < 0.66 && c[2] > 0.332 && c[2] < 0.66;
      replace[e] = shape == 0   ? low || high
                   : shape == 1 ? a || b
                   : shape == 2 ? !core
                                : !notch && !inside;
      removed += replace[e];
    }
    check_ok(context,
             bw_mesh_refill(context, mesh, mesh->node, replace, &made, &node_from, &element_from));
    check_contract(mesh, mesh->node, replace, made, node_from, element_from);
    int32_t components = -element_from[made->element_count - 1];
    assert_int_equal(components, shape < 2 ? 2 : 1);
    double volume[2] = {0, 0}, whole = bw_mesh_volume(made);
    for (int32_t e = 0; e < made->element_count; e++)
      if (element_from[e] < 0)
        volume[-element_from[e] - 1] += made->volume[e];
    check_near(whole, 2, 1e-12);
    if (shape < 2) {
      check_near(volume[0], 0.5, 1e-12);
      check_near(volume[1], 0.5, 1e-12);
    } else {
      check_near(volume[0], 2.0 * (double)removed / mesh->element_count, 1e-12);
    }
    assert_int_equal(made->component_count, 1);
    bw_mesh_repair_report report;
    bw_mesh_shape_check(made, made->node, 0, &report);
    assert_true(report.worst_before > 0.03);
    patch_test(context, made);
    bw_free(node_from);
    bw_free(element_from);
    free(replace);
    bw_release(made);
    bw_release(mesh);
  }
}

/* New elements carry the region of most of those that they replace; the same call gives the same
 * mesh. */
static void test_regions(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *plain = box(context, 1, 4, 4, 4, 1), *mesh, *made[2];
  int32_t *region = (int32_t *)malloc(4 * (size_t)plain->element_count);
  uint8_t *replace = (uint8_t *)calloc((size_t)plain->element_count, 1);
  for (int32_t e = 0; e < plain->element_count; e++) {
    region[e] = e % 3 == 0 ? -5 : 9;
    replace[e] = e < plain->element_count / 2;
  }
  mesh = check_tagged(context, bw_retain(plain), region);
  for (int i = 0; i < 2; i++) {
    int32_t *element_from;
    check_ok(context,
             bw_mesh_refill(context, mesh, mesh->node, replace, &made[i], NULL, &element_from));
    for (int32_t e = 0; e < made[i]->element_count; e++)
      assert_int_equal(made[i]->regions[made[i]->region[e]].tag,
                       element_from[e] < 0 ? 9 : region[element_from[e]]);
    bw_free(element_from);
  }
  assert_int_equal(made[0]->element_count, made[1]->element_count);
  assert_int_equal(made[0]->node_count, made[1]->node_count);
  assert_memory_equal(made[0]->node, made[1]->node, 24 * (size_t)made[0]->node_count);
  assert_memory_equal(made[0]->element, made[1]->element, 16 * (size_t)made[0]->element_count);
  free(region), free(replace);
  bw_release(made[0]);
  bw_release(made[1]);
  bw_release(mesh);
  bw_release(plain);
}

static void test_cancel(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 4, 8, 3, 3, 1), *made;
  uint8_t *one = (uint8_t *)malloc((size_t)mesh->element_count);
  double *node = copy_nodes(context, mesh);
  memset(one, 1, (size_t)mesh->element_count);
  push_inner(mesh, node, 2);
  bw_mesh_repair_report report;
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "", bw_mesh_relax(context, mesh, one, node, &report));
  check_fails(context, BW_CANCELLED, "",
              bw_mesh_refill(context, mesh, mesh->node, one, &made, NULL, NULL));
  bw_clear_cancel(context);
  free(one);
  bw_free(node);
  bw_release(mesh);
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box(context, 4, 8, 3, 3, 2);
  uint8_t *replace = (uint8_t *)malloc((size_t)mesh->element_count);
  uint8_t *may = (uint8_t *)malloc((size_t)mesh->node_count);
  memset(may, 1, (size_t)mesh->node_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    replace[e] = e % (mesh->element_count / 2) < mesh->element_count / 8;
  double *node = copy_nodes(context, mesh), *tangled = copy_nodes(context, mesh);
  push_inner(mesh, tangled, 1);
  check_each_allocation(context, status, 1) {
    bw_mesh_repair_report report;
    memcpy(node, tangled, 24 * (size_t)mesh->node_count);
    status = bw_mesh_relax(context, mesh, may, node, &report);
    assert_true(status == BW_OK || memcmp(node, tangled, 24 * (size_t)mesh->node_count) == 0);
  }
  check_each_allocation(context, status, 1) {
    bw_mesh *made = NULL;
    int32_t *node_from = NULL, *element_from = NULL;
    status = bw_mesh_refill(context, mesh, mesh->node, replace, &made, &node_from, &element_from);
    assert_true((status == BW_OK) == (made != NULL) && (status == BW_OK) == (node_from != NULL));
    bw_free(node_from);
    bw_free(element_from);
    bw_release(made);
  }
  free(replace), free(may);
  bw_free(node);
  bw_free(tangled);
  bw_release(mesh);
}

check_main(cmocka_unit_test(test_quality), check_test(test_pushed_nodes),
           check_test(test_stays_local), check_test(test_dent), check_test(test_refusals),
           check_test(test_bent_bar), check_test(test_components), check_test(test_regions),
           check_test(test_cancel), check_test(test_allocation_failures))
