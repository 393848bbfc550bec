/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies that overlap: volumes and depths of boxes in closed form, and bodies that only touch. */
#include "../check.h"

static double between(bw_random *random, double low, double high) {
  return low + (high - low) * bw_random_uniform(random);
}

/* A rotation by three angles, then a shift. */
static void place(const double turn[9], const double shift[3], bw_mesh *mesh) {
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double x[3];
    memcpy(x, mesh->node + 3 * i, sizeof x);
    for (int k = 0; k < 3; k++)
      mesh->node[3 * i + k] =
          turn[3 * k] * x[0] + turn[3 * k + 1] * x[1] + turn[3 * k + 2] * x[2] + shift[k];
  }
}

static void random_turn(bw_random *random, double turn[9]) {
  double q[4], size = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = bw_random_normal(random);
    size += q[i] * q[i];
  }
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(size);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  double made[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                    2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                    2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(turn, made, sizeof made);
}

/* Boxes that share no node, turned and shifted together. */
static bw_mesh *boxes(bw_context *context, int count, const double (*box)[6], const int (*cells)[3],
                      int order, const double turn[9], const double shift[3]) {
  double *node = NULL;
  int32_t *element = NULL, nodes = 0, elements = 0, width = order == 2 ? 10 : 4;
  bw_mesh *mesh;
  for (int b = 0; b < count; b++) {
    bw_mesh *one;
    check_ok(context, bw_mesh_box_grid(context, box[b], box[b] + 3, cells[b], order, &one));
    place(turn, shift, one);
    node = realloc(node, 24 * (size_t)(nodes + one->node_count));
    element = realloc(element, 4 * (size_t)width * (size_t)(elements + one->element_count));
    memcpy(node + 3 * nodes, one->node, 24 * (size_t)one->node_count);
    for (int32_t i = 0; i < width * one->element_count; i++)
      element[width * elements + i] = one->element[i] + nodes;
    nodes += one->node_count;
    elements += one->element_count;
    bw_release(one);
  }
  check_ok(context, bw_mesh_copy(context, order, nodes, node, elements, element, NULL, &mesh));
  free(node);
  free(element);
  assert_int_equal(mesh->component_count, count);
  return mesh;
}

/* The volume that boxes share, and the shortest motion along an axis that takes them apart. */
static double common(const double a[6], const double b[6], double *apart) {
  double volume = 1;
  *apart = INFINITY;
  for (int k = 0; k < 3; k++) {
    volume *= fmax(fmin(a[3 + k], b[3 + k]) - fmax(a[k], b[k]), 0);
    *apart = fmin(*apart, fmin(a[3 + k] - b[k], b[3 + k] - a[k]));
  }
  return volume;
}

static void random_boxes(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 20261129);
  int overlapping = 0;
  for (int trial = 0; trial < 120; trial++) {
    double box[2][6], turn[9], shift[3], apart;
    int cells[2][3];
    for (int b = 0; b < 2; b++)
      for (int k = 0; k < 3; k++) {
        box[b][k] = between(&random, 0, 1);
        box[b][3 + k] = box[b][k] + between(&random, 0.05, 1);
        cells[b][k] = 1 + (int)between(&random, 0, 4);
      }
    for (int k = 0; k < 3; k++)
      shift[k] = between(&random, -100, 100);
    random_turn(&random, turn);
    double volume = common(box[0], box[1], &apart);
    bw_mesh *mesh = boxes(context, 2, box, cells, 1 + trial % 2, turn, shift);
    bw_mesh_overlaps found;
    check_ok(context, bw_mesh_overlaps_find(context, mesh, &found));
    assert_int_equal(found.count, volume > 0);
    assert_false(found.more);
    if (volume > 0) {
      const bw_mesh_overlap *o = found.overlap;
      overlapping++;
      assert_int_equal(o->body[0], 0);
      assert_int_equal(o->body[1], 1);
      check_near(o->volume, volume, 1e-9);
      double smaller = INFINITY;
      for (int b = 0; b < 2; b++)
        smaller = fmin(smaller,
                       (box[b][3] - box[b][0]) * (box[b][4] - box[b][1]) * (box[b][5] - box[b][2]));
      check_near(o->fraction, volume / smaller, 1e-8);
      /* a lower bound, and no small part of the depth */
      assert_true(o->depth <= apart * (1 + 1e-9) && o->depth > 0.1 * apart);
      for (int k = 0; k < 2; k++) /* one of each body */
        assert_int_equal(mesh->component[mesh->element[o->element[k] * mesh->nodes_per_element]],
                         k);
      double at[3]; /* the place, turned back, is in both boxes */
      for (int k = 0; k < 3; k++) {
        at[k] = 0;
        for (int l = 0; l < 3; l++)
          at[k] += turn[3 * l + k] * (o->at[l] - shift[l]);
        for (int b = 0; b < 2; b++)
          assert_true(at[k] > box[b][k] - 1e-9 && at[k] < box[b][3 + k] + 1e-9);
      }
    }
    bw_mesh_overlaps_clear(&found);
    bw_release(mesh);
  }
  assert_true(overlapping > 30 && overlapping < 110);
}

/* Boxes side by side, of grids that do not match, in contact at a face, an edge or a corner. */
static void touching_boxes(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 7);
  for (int trial = 0; trial < 100; trial++) {
    double box[2][6], turn[9], shift[3];
    int cells[2][3];
    for (int k = 0; k < 3; k++) {
      box[0][k] = between(&random, 0, 1);
      box[0][3 + k] = box[0][k] + between(&random, 0.1, 1);
      bool at_side = k == trial % 3 || bw_random_uniform(&random) < 0.4;
      box[1][k] = at_side ? box[0][3 + k] : box[0][k] + between(&random, -0.5, 0.05);
      box[1][3 + k] = box[1][k] + between(&random, 0.1, 1);
      for (int b = 0; b < 2; b++)
        cells[b][k] = 1 + (int)between(&random, 0, 5);
      shift[k] = between(&random, -10, 10);
    }
    random_turn(&random, turn);
    bw_mesh *mesh = boxes(context, 2, box, cells, 1 + trial % 2, turn, shift);
    bw_mesh_overlaps found;
    check_ok(context, bw_mesh_overlaps_find(context, mesh, &found));
    assert_int_equal(found.count, 0);
    bw_mesh_overlaps_clear(&found);
    bw_release(mesh);
  }
}

static const double straight[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, nowhere[3] = {0, 0, 0};

/* Four bodies: one inside the first, a copy of the first, and one that is apart. */
static void nested(void **state) {
  bw_context *context = check_context(state);
  const double box[4][6] = {
      {0, 0, 0, 2, 2, 2}, {0.5, 0.5, 0.5, 1, 1.5, 1.25}, {0, 0, 0, 2, 2, 2}, {2.1, 0, 0, 3, 1, 1}};
  const int cells[4][3] = {{3, 2, 4}, {1, 2, 1}, {3, 2, 4}, {1, 1, 1}};
  bw_mesh *mesh = boxes(context, 4, box, cells, 1, straight, nowhere);
  const double volume[3] = {0.375, 8, 0.375}, fraction[3] = {1, 1, 1};
  const int32_t body[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  bw_mesh_overlaps found;
  check_ok(context, bw_mesh_overlaps_find(context, mesh, &found));
  assert_int_equal(found.count, 3);
  for (int i = 0; i < 3; i++) {
    assert_memory_equal(found.overlap[i].body, body[i], sizeof body[i]);
    check_near(found.overlap[i].volume, volume[i], 1e-12);
    check_near(found.overlap[i].fraction, fraction[i], 1e-12);
  }
  check_near(found.overlap[0].depth, 0.75, 0.26); /* its corner (1, 1.5, 1.25) is 0.5 deep */
  bw_mesh_overlaps_clear(&found);
  check_each_allocation(context, status, 10) {
    status = bw_mesh_overlaps_find(context, mesh, &found);
    bw_mesh_overlaps_clear(&found);
  }
  bw_release(mesh);
}

/* What models and heat say: nothing of a fit, a warning, an error. */
static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_material *steel;
  check_ok(context, bw_material_named(context, "steel", &steel));
  const double into[3] = {0.002, 0.02, 0.15};
  for (int i = 0; i < 3; i++) {
    const double box[2][6] = {{0, 0, 0, 1, 1, 1}, {1 - into[i], 0, 0, 2, 1, 1}};
    const int cells[2][3] = {{4, 4, 4}, {5, 3, 3}};
    bw_mesh *mesh = boxes(context, 2, box, cells, 1, straight, nowhere);
    bw_model *model = NULL;
    bw_heat *heat = NULL;
    if (i == 2) {
      check_fails(context, BW_GEOMETRY, "bodies 1 and 2 of the mesh overlap: both take up 0.15 m3",
                  bw_model_create(context, mesh, steel, &model));
      bw_clear_failure(context);
      check_fails(context, BW_GEOMETRY, "15 % of the smaller one",
                  bw_heat_create(context, mesh, steel, &heat));
      bw_clear_failure(context);
    } else {
      check_ok(context, bw_model_create(context, mesh, steel, &model));
      check_ok(context, bw_heat_create(context, mesh, steel, &heat));
      const char *warning = bw_warning_at(context, 0);
      if (i == 0)
        assert_null(warning);
      else
        assert_non_null(strstr(warning, "overlap by at least 0.02 m near"));
    }
    bw_release(model);
    bw_release(heat);
    bw_release(mesh);
  }
  bw_clear_warnings(context);
  bw_release(steel);
}

check_main(check_test(random_boxes), check_test(touching_boxes), check_test(nested),
           check_test(refused))
