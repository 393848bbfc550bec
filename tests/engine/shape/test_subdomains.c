/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Subdomains: the invariants hold whatever the weights; blending is harmonic and sums to one;
 * changes by hand keep the rules or are refused. */
#include "limbs.h"

static bw_subdomains *make(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton,
                           const double *weight, double threshold) {
  bw_subdomains *subdomains;
  bw_subdomains_options options = {threshold, NULL, -1};
  check_ok(context, bw_subdomains_create(context, mesh, skeleton, weight, &options, &subdomains));
  check_ok(context, bw_subdomains_check(context, subdomains));
  return subdomains;
}

static double middle(const bw_mesh *mesh, int32_t e, int axis) {
  double sum = 0;
  for (int k = 0; k < 4; k++)
    sum += mesh->node[3 * mesh->element[e * mesh->nodes_per_element + k] + axis] / 4;
  return sum;
}

/* Three bones along a bar: R F R F R, with F around the joints. */
static void test_bar(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    limbs l = limbs_of_bar(context, order, 4, 20);
    bw_subdomains *d = make(context, l.mesh, l.skeleton, l.weight, 0.95);
    assert_int_equal(d->count, 5);
    assert_int_equal(d->rigid_count, 3);
    for (int b = 0; b < 3; b++)
      assert_int_equal(d->bone_of[b], b);
    for (int32_t e = 0; e < l.mesh->element_count; e++) {
      double x = middle(l.mesh, e, 0);
      if (fabs(x - 1) < 0.05)
        assert_int_equal(d->element_subdomain[e], 3);
      if (fabs(x - 1.5) < 0.2)
        assert_int_equal(d->element_subdomain[e], 1);
      if (x > 2.5)
        assert_int_equal(d->element_subdomain[e], 2);
    }
    /* neighbours along the chain, bones of the blended ones */
    const int32_t neighbours[5] = {1, 2, 1, 2, 2};
    for (int i = 0; i < 5; i++)
      assert_int_equal(d->adjacent_start[i + 1] - d->adjacent_start[i], neighbours[i]);
    assert_int_equal(d->adjacent[d->adjacent_start[3]], 0);
    assert_int_equal(d->adjacent[d->adjacent_start[3] + 1], 1);
    assert_int_equal(d->bone_start[4] - d->bone_start[3], 2);
    assert_int_equal(d->bone[d->bone_start[4]], 1);
    assert_int_equal(d->bone[d->bone_start[4] + 1], 2);
    assert_null(bw_warning_at(context, 0));
    assert_true(bw_bytes(d) > sizeof *d);
    bw_release(d);
    limbs_drop(&l);
  }
}

/* A bar whose cells grow along x and across it. */
static double along(double u) {
  return 2.1 * u + 0.9 * u * u;
}

static void graded(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = along(unit[0]);
  out[1] = 0.4 * unit[1] * unit[1];
  out[2] = 0.4 * sqrt(unit[2]);
}

/* What is left of two weights of one in sum when small ones are left out. */
static double thinned(double w) {
  double own = fmax(w - 0.02, 0), other = fmax(1 - w - 0.02, 0);
  return own / (own + other);
}

/* A slab of type F between two planes: harmonic weights are linear in x, to rounding, whatever the
 * sizes of the elements; they follow one bone alone near its interface. */
static void test_blend_is_linear(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh;
  const int cells[3] = {30, 4, 4};
  check_ok(context, bw_mesh_mapped_box(context, cells, 1, graded, NULL, &mesh));
  bw_skeleton *skeleton = limbs_bar_bones(context);
  int32_t *label = calloc((size_t)mesh->element_count, sizeof *label);
  const int32_t bone_of[4] = {0, 1, 2, -1};
  /* F in the first and the third interval */
  const double plane[4] = {along(0.3), along(0.5), along(0.7), along(0.8)};
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x = middle(mesh, e, 0);
    label[e] = x < plane[0] ? 0 : x < plane[1] ? 3 : x < plane[2] ? 1 : x < plane[3] ? 3 : 2;
  }
  bw_subdomains *d;
  check_ok(context, bw_subdomains_from_labels(context, mesh, skeleton, 4, bone_of, label, &d));
  check_ok(context, bw_subdomains_check(context, d));
  int32_t found = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    double x = mesh->node[3 * i], sum = 0;
    if (d->influence_start[i] == d->influence_start[i + 1] || x < plane[0] - 1e-9 ||
        x > plane[1] + 1e-9)
      continue;
    double expected = (x - plane[0]) / (plane[1] - plane[0]), weight = 0;
    for (int64_t k = d->influence_start[i]; k < d->influence_start[i + 1]; k++) {
      sum += d->influence_weight[k];
      if (d->influence_bone[k] == 1)
        weight += d->influence_weight[k];
      assert_true(d->influence_bone[k] < 2);
    }
    check_near(weight, thinned(expected), 1e-11);
    check_near(sum, 1, 1e-15);
    found++;
  }
  assert_true(found > 100);
  bw_release(d);
  /* the same elements in another subdomain would share nodes of no type R subdomain with them */
  const int32_t split[5] = {0, 1, 2, -1, -1};
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (label[e] == 3 && middle(mesh, e, 0) < along(0.4))
      label[e] = 4;
  check_fails(context, BW_INVALID, "must be one subdomain",
              bw_subdomains_from_labels(context, mesh, skeleton, 5, split, label, &d));
  free(label);
  bw_release(mesh);
  bw_release(skeleton);
}

/* Random weights on a cross, thresholds from loose to strict: the invariants hold. Many bones touch
 * and fall apart here. */
static void test_random_weights(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 7);
  bw_skeleton *skeleton = limbs_cross_bones(context);
  int32_t meetings = 0;
  for (int round = 0; round < 40; round++) {
    bw_mesh *mesh = limbs_cross(context, 1 + round % 2);
    double *weight = limbs_weights(mesh, skeleton, 1 + 10 * bw_random_uniform(&random));
    double noise = 2 * bw_random_uniform(&random),
           threshold = 0.3 + 0.68 * bw_random_uniform(&random);
    for (int32_t i = 0; i < mesh->node_count; i++) {
      double sum = 0, *w = weight + 4 * i;
      for (int b = 0; b < 4; b++)
        sum += w[b] *= exp(noise * bw_random_normal(&random));
      for (int b = 0; b < 4; b++)
        w[b] /= sum;
    }
    bw_subdomains_options options = {threshold, NULL, round % 4 == 0 ? -1 : 0.25 * (round % 4)};
    bw_subdomains *d;
    check_ok(context, bw_subdomains_create(context, mesh, skeleton, weight, &options, &d));
    check_ok(context, bw_subdomains_check(context, d));
    for (int32_t i = 0; i < mesh->node_count; i++)
      meetings += d->interface[i];
    /* every bone below the threshold everywhere is reported */
    int warnings = 0;
    for (int i = 0; bw_warning_at(context, i); i++)
      warnings += strstr(bw_warning_at(context, i), "has no subdomain") != NULL;
    assert_int_equal(warnings, 4 - d->rigid_count);
    bw_clear_warnings(context);
    bw_release(d);
    free(weight);
    bw_release(mesh);
  }
  assert_true(meetings > 1000);
  bw_release(skeleton);
}

/* Bodies apart from each other, and bones whose weights are high nowhere. */
static void test_what_no_bone_claims(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *box, *mesh;
  bw_skeleton *skeleton = limbs_bar_bones(context);
  const double low[3] = {0, 0, 0}, high[3] = {3, 0.5, 0.5};
  const int cells[3] = {12, 2, 2};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &box));
  uint8_t *keep = calloc((size_t)box->element_count, 1);
  for (int32_t e = 0; e < box->element_count; e++)
    keep[e] = middle(box, e, 0) < 1 || middle(box, e, 0) > 2;
  check_ok(context, bw_mesh_subset(context, box, keep, &mesh));
  assert_int_equal(mesh->component_count, 2);
  double *weight = calloc((size_t)mesh->node_count * 3, sizeof *weight);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bool left = mesh->node[3 * i] < 1.5;
    weight[3 * i] = left ? 1 : 0;
    weight[3 * i + 1] = left ? 0 : 0.4;
    weight[3 * i + 2] = left ? 0 : 0.6;
  }
  /* the right body becomes the subdomain of its best bone */
  bw_subdomains *d = make(context, mesh, skeleton, weight, 0.95), *changed;
  assert_int_equal(d->count, 2);
  assert_int_equal(d->bone_of[1], 2);
  assert_non_null(strstr(bw_warning_at(context, 0), "bone 2"));
  assert_non_null(strstr(bw_warning_at(context, 0), "0.4"));
  /* taken out by hand, it still follows that bone as a whole */
  int32_t count = 0, *element = malloc((size_t)mesh->element_count * sizeof *element);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (d->element_subdomain[e] == 1)
      element[count++] = e;
  check_ok(context, bw_subdomains_assign(context, d, count, element, -1, &changed));
  check_ok(context, bw_subdomains_check(context, changed));
  assert_int_equal(changed->count, 2);
  assert_int_equal(changed->bone_of[1], -1);
  assert_int_equal(changed->bone[changed->bone_start[1]], 2);
  bw_release(d);
  bw_release(changed);
  /* and when that bone has a subdomain already, it follows it with weight one */
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bool left = mesh->node[3 * i] < 1.5;
    weight[3 * i] = left ? 1 : 0.7;
    weight[3 * i + 1] = left ? 0 : 0.3;
    weight[3 * i + 2] = 0;
  }
  d = make(context, mesh, skeleton, weight, 0.95);
  assert_int_equal(d->rigid_count, 1);
  assert_int_equal(d->count, 2);
  assert_int_equal(d->bone[d->bone_start[1]], 0);
  bw_release(d);
  free(element);
  free(weight);
  free(keep);
  bw_release(box);
  bw_release(mesh);
  bw_release(skeleton);
}

/* An island of low weights inside one bone's elements joins them: it would follow it anyway. */
static void test_island(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_bar(context, 1, 4, 20);
  for (int32_t i = 0; i < l.mesh->node_count; i++)
    if (fabs(l.mesh->node[3 * i] - 2.6) < 0.01 && fabs(l.mesh->node[3 * i + 1]) < 0.01) {
      l.weight[3 * i + 1] = 0.3;
      l.weight[3 * i + 2] = 0.7;
      l.weight[3 * i] = 0;
    }
  bw_subdomains *d = make(context, l.mesh, l.skeleton, l.weight, 0.95);
  assert_int_equal(d->count, 5);
  bw_release(d);
  limbs_drop(&l);
}

static void test_thresholds(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_bar(context, 1, 4, 20);
  const double own[3] = {0, 0.999, 0};
  bw_subdomains_options options = {0.95, own, 0};
  bw_subdomains *usual = make(context, l.mesh, l.skeleton, l.weight, 0.95), *strict, *none;
  check_ok(context, bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, &options, &strict));
  check_ok(context, bw_subdomains_check(context, strict));
  assert_true(strict->elements[1] < usual->elements[1]);
  assert_int_equal(strict->elements[0], usual->elements[0]);
  options.threshold = 1.5;
  check_fails(context, BW_INVALID, "1.5",
              bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, &options, &none));
  l.weight[3 * 17] += 0.5;
  check_fails(context, BW_INVALID, "node 18",
              bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, NULL, &none));
  l.weight[3 * 17] = NAN;
  check_fails(context, BW_INVALID, "node 18",
              bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, NULL, &none));
  bw_release(usual);
  bw_release(strict);
  limbs_drop(&l);
}

/* Weights that reach 0.95 nowhere: as many elements as asked for become each bone's, the surest
 * first; a bone with a threshold of its own keeps it. */
static void test_fraction(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_bar(context, 1, 4, 3);
  bw_subdomains *none = make(context, l.mesh, l.skeleton, l.weight, 0.95), *d;
  assert_true(none->rigid_count < 3);
  bw_clear_warnings(context);
  for (int i = 1; i <= 2; i++) {
    bw_subdomains_options options = {0.95, NULL, i == 1 ? 0 : 0.6};
    check_ok(context, bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, &options, &d));
    check_ok(context, bw_subdomains_check(context, d));
    assert_int_equal(d->rigid_count, 3);
    for (int b = 0; b < 3; b++) { /* each bone moves a third most; cells are alike */
      double part = 3.0 * d->elements[b] / l.mesh->element_count;
      check_near(part, i == 1 ? 0.35 : 0.6, 0.1);
    }
    assert_non_null(strstr(bw_warning_at(context, 0), "3 of 3 bones were lowered"));
    bw_clear_warnings(context);
    bw_release(d);
  }
  const double own[3] = {0, 0.99, 0};
  bw_subdomains_options options = {0.95, own, 0.5};
  check_ok(context, bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, &options, &d));
  assert_int_equal(d->rigid_count, 2);
  options.fraction = 1.5;
  check_fails(context, BW_INVALID, "a fraction of 1.5",
              bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, &options, &none));
  bw_release(d);
  bw_release(none);
  limbs_drop(&l);
}

static void test_assign(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_bar(context, 1, 4, 20);
  bw_subdomains *d = make(context, l.mesh, l.skeleton, l.weight, 0.95), *changed = NULL, *back;
  int32_t *element = malloc((size_t)l.mesh->element_count * sizeof *element), count = 0;
  /* elements next to bone 1's subdomain join it and leave it again */
  for (int32_t e = 0; e < l.mesh->element_count; e++) {
    bool near = false;
    for (int k = 0; k < 4; k++) {
      int32_t other = l.mesh->neighbour[4 * e + k];
      near |= other >= 0 && d->element_subdomain[other] == 0;
    }
    if (d->element_subdomain[e] == 3 && near && count < 5)
      element[count++] = e;
  }
  assert_int_equal(count, 5);
  check_ok(context, bw_subdomains_assign(context, d, count, element, 0, &changed));
  check_ok(context, bw_subdomains_check(context, changed));
  assert_int_equal(changed->elements[0], d->elements[0] + 5);
  check_ok(context, bw_subdomains_assign(context, changed, count, element, -1, &back));
  assert_memory_equal(back->element_subdomain, d->element_subdomain,
                      (size_t)l.mesh->element_count * sizeof(int32_t));
  assert_memory_equal(back->influence_weight, d->influence_weight,
                      (size_t)d->influence_start[l.mesh->node_count] * sizeof(double));
  bw_release(back);
  bw_release(changed);
  /* an island, a cut, a touch, a number that is not there */
  count = 0;
  for (int32_t e = 0; e < l.mesh->element_count && !count; e++)
    if (fabs(middle(l.mesh, e, 0) - 2) < 0.06)
      element[count++] = e;
  check_fails(context, BW_INVALID, "is not connected",
              bw_subdomains_assign(context, d, count, element, 0, &changed));
  const char *key, *text;
  double number;
  assert_true(bw_detail(context, 0, &key, &number, &text));
  assert_string_equal(key, "element");
  assert_true((int32_t)number == element[0] + 1);
  count = 0;
  for (int32_t e = 0; e < l.mesh->element_count; e++)
    if (fabs(middle(l.mesh, e, 0) - 1.5) < 0.06)
      element[count++] = e;
  check_fails(context, BW_INVALID, "is not connected",
              bw_subdomains_assign(context, d, count, element, -1, &changed));
  count = 0;
  for (int32_t e = 0; e < l.mesh->element_count; e++)
    if (d->element_subdomain[e] == 3)
      element[count++] = e;
  check_fails(context, BW_INVALID, "touch at (",
              bw_subdomains_assign(context, d, count, element, 0, &changed));
  element[0] = l.mesh->element_count;
  check_fails(context, BW_INVALID, "does not exist",
              bw_subdomains_assign(context, d, 1, element, 0, &changed));
  check_fails(context, BW_INVALID, "bone 4 of 3",
              bw_subdomains_assign(context, d, 0, element, 3, &changed));
  bw_release(d);
  free(element);
  limbs_drop(&l);
}

static void test_labels(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_cross(context, 2, 20);
  bw_subdomains *d = make(context, l.mesh, l.skeleton, l.weight, 0.9), *again;
  assert_int_equal(d->rigid_count, 4);
  assert_int_equal(d->count, 5);
  assert_int_equal(d->bone_start[5] - d->bone_start[4], 4);
  check_ok(context, bw_subdomains_from_labels(context, l.mesh, l.skeleton, d->count, d->bone_of,
                                              d->element_subdomain, &again));
  assert_memory_equal(again->node_subdomain, d->node_subdomain, (size_t)l.mesh->node_count * 4);
  assert_memory_equal(again->influence_weight, d->influence_weight,
                      (size_t)d->influence_start[l.mesh->node_count] * sizeof(double));
  bw_release(again);
  int32_t wrong[5] = {0, 1, 2, 9, -1};
  check_fails(context, BW_INVALID, "bone 10 of 4",
              bw_subdomains_from_labels(context, l.mesh, l.skeleton, 5, wrong, d->element_subdomain,
                                        &again));
  wrong[3] = 2;
  check_fails(context, BW_INVALID, "out of order",
              bw_subdomains_from_labels(context, l.mesh, l.skeleton, 5, wrong, d->element_subdomain,
                                        &again));
  check_fails(context, BW_INVALID, "there are 4",
              bw_subdomains_from_labels(context, l.mesh, l.skeleton, 4, d->bone_of,
                                        d->element_subdomain, &again));
  const int32_t more[6] = {0, 1, 2, 3, -1, -1};
  check_fails(context, BW_INVALID, "no element",
              bw_subdomains_from_labels(context, l.mesh, l.skeleton, 6, more, d->element_subdomain,
                                        &again));
  bw_release(d);
  limbs_drop(&l);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  limbs l = limbs_of_bar(context, 2, 2, 20);
  bw_subdomains *d = NULL, *changed = NULL;
  check_each_allocation(context, status, 25) {
    status = bw_subdomains_create(context, l.mesh, l.skeleton, l.weight, NULL, &d);
  }
  int32_t element = 0;
  for (int32_t e = 0; e < l.mesh->element_count; e++)
    if (d->element_subdomain[e] == 2 && middle(l.mesh, e, 0) > middle(l.mesh, element, 0))
      element = e;
  check_each_allocation(context, status, 1) {
    status = bw_subdomains_assign(context, d, 1, &element, -1, &changed);
  }
  check_ok(context, bw_subdomains_check(context, changed));
  bw_release(d);
  bw_release(changed);
  limbs_drop(&l);
}

/* Bones by the dozen that nothing follows are counted, not listed. */
static void test_needless_bones(void **state) {
  enum { MANY = 40 };
  bw_context *context = check_context(state);
  bw_mesh *mesh = limbs_bar(context, 1, 2);
  double joint[3 * (MANY + 1)];
  int32_t bone[2 * MANY];
  for (int j = 0; j <= MANY; j++) {
    joint[3 * j] = 3.0 * j / MANY;
    joint[3 * j + 1] = joint[3 * j + 2] = 0;
    if (j < MANY) {
      bone[2 * j] = j;
      bone[2 * j + 1] = j + 1;
    }
  }
  bw_skeleton *skeleton;
  check_ok(context,
           bw_skeleton_create(context, MANY + 1, joint, NULL, MANY, bone, NULL, 0, &skeleton));
  double *weight = limbs_weights(mesh, skeleton, 5);
  bw_subdomains *d;
  check_ok(context, bw_subdomains_create(context, mesh, skeleton, weight, NULL, &d));
  assert_true(d->rigid_count < MANY - 10);
  int one = 0, all = 0;
  char text[64];
  snprintf(text, sizeof text, "%d of %d bones have no subdomain", MANY - d->rigid_count, MANY);
  for (int i = 0; bw_warning_at(context, i); i++) {
    one += strstr(bw_warning_at(context, i), "has no subdomain") != NULL;
    all += strstr(bw_warning_at(context, i), text) != NULL;
  }
  assert_int_equal(one, 4);
  assert_int_equal(all, 1);
  free(weight);
  bw_release(d);
  bw_release(skeleton);
  bw_release(mesh);
}

check_main(check_test(test_bar), check_test(test_blend_is_linear), check_test(test_random_weights),
           check_test(test_what_no_bone_claims), check_test(test_island),
           check_test(test_thresholds), check_test(test_fraction), check_test(test_assign),
           check_test(test_labels), check_test(test_memory), check_test(test_needless_bones))
