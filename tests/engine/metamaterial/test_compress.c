/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Farthest-point sampling, and what level 2 is made of by it. */
#include "library_fixture.h"

/* By hand: points on a line, chosen from the ends inwards; an item with a symmetry is only covered
 * by a representative that has it too. */
static void test_farthest(void **state) {
  bw_context *context = check_context(state);
  static const float at[] = {0, 1, 4, 10, 6};
  bwi_cover cover;
  float typical, max;
  check_ok(context, bwi_cover_begin(context, 5, &cover));
  for (int i = 0; i < 5; i++)
    cover.coordinate[BWI_FEATURES * i] = at[i];
  cover.mask[4] = 2;
  check_ok(context, bwi_cover_add(&cover, cover.coordinate, 1, 0));
  assert_int_equal(bwi_cover_farthest(&cover, 0, NULL, 0), 4); /* not covered at all */
  check_ok(context, bwi_cover_add(&cover, cover.coordinate + 4 * BWI_FEATURES, 3, 1));
  assert_int_equal(bwi_cover_farthest(&cover, 0, NULL, 0), 3);
  check_ok(context, bwi_cover_add(&cover, cover.coordinate + 3 * BWI_FEATURES, 1, 2));
  assert_int_equal(bwi_cover_farthest(&cover, 0, NULL, 0), 2);
  bwi_cover_measure(&cover, &typical, &max);
  check_near(max, sqrt(4.0 / BWI_FEATURES), 1e-6);
  check_near(typical, sqrt((1 + 4) / 5.0 / BWI_FEATURES), 1e-6);
  assert_int_equal(bwi_cover_farthest(&cover, 2, NULL, 0), -1);
  static const uint8_t images[] = {1, 1, 8, 1, 1};
  assert_int_equal(bwi_cover_farthest(&cover, 0, images, 7), 1);
  static const int32_t expected[] = {0, 0, 1, 2, 1};
  assert_memory_equal(cover.nearest, expected, sizeof expected);
  check_ok(context, bwi_cover_add(&cover, cover.coordinate + 2 * BWI_FEATURES, 1, 3));
  check_ok(context, bwi_cover_add(&cover, cover.coordinate + BWI_FEATURES, 1, 4));
  assert_int_equal(bwi_cover_farthest(&cover, 0, NULL, 0), -1);
  bwi_cover_clear(&cover);
}

/* Tables are closed: images of pairs have the images of representatives. */
static void test_tables(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, true, 2, 40);
  const bwi_levels *levels = library->inner->levels;
  for (int s = 0; s < 3; s++) {
    int32_t n = levels->count[s];
    assert_true(levels->count[s] <= 41);
    assert_int_equal(levels->table[s][0], 0);
    for (int32_t code = 1; code < n * n; code++) {
      int32_t to = levels->table[s][code];
      assert_true(to > 0 && to < levels->count[s + 1]);
      for (int f = 0; f < BWI_FLIPS; f++) {
        int32_t image = bwi_pair_flipped(levels, s, code, f);
        assert_int_equal(levels->table[s][image], levels->flipped[s + 1][to * BWI_FLIPS + f]);
      }
    }
    /* What was chosen stands for itself. */
    for (int32_t r = 1; r < levels->count[s + 1]; r++)
      assert_int_equal(levels->table[s][levels->code[s + 1][r]], r);
  }
  /* Blocks of one material stand for themselves, at every stage. */
  for (int32_t m = 1; m <= 2; m++) {
    int32_t key[64], cell[8];
    for (int p = 0; p < 64; p++)
      key[p] = m;
    bwi_level2 found = bwi_levels_find(levels, library->inner->keys, key);
    bwi_levels_block(levels, found.fit, cell);
    for (int c = 0; c < 8; c++)
      assert_int_equal(levels->code[0][cell[c]], bwi_key_code(3, key));
  }
  bw_release(library);
}

static void turned_key(int s, const int32_t *from, int32_t *to) {
  bwi_symmetry_key(s, 64, from, to);
}

/* A block that is turned or mirrored has the material turned or mirrored: of random blocks, and of
 * ones with reflections of their own. */
static void test_symmetry(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, true, 2, 60);
  bw_random random;
  bw_random_seed(&random, 12);
  for (int round = 0; round < 30; round++) {
    int32_t key[64], other[64], image[64];
    for (int p = 0; p < 64; p++)
      key[p] = (int32_t)(bw_random_bits(&random) % 3);
    for (int f = 1; round >= 10 && f < 8; f *= 2) {
      if (round % 3 == 0 && f == 2)
        continue;
      turned_key(f, key, other);
      for (int p = 0; p < 64; p++)
        if (p / 8 & f)
          key[p] = other[p];
    }
    bw_solid_material *m, *turned, *expected;
    double k[576], expected_k[576], max = 0;
    check_ok(context, bw_library_material(context, library, 2, key, &m, NULL));
    for (int s = 1; s < 48; s += round % 5 + 1) {
      turned_key(s, key, image);
      check_ok(context, bw_library_material(context, library, 2, image, &turned, NULL));
      check_ok(context, bwi_material_transformed(context, m, s, &expected));
      bwi_material_stiffness(turned, k);
      bwi_material_stiffness(expected, expected_k);
      for (int i = 0; i < 576; i++)
        max = fmax(max, fabs(expected_k[i]));
      for (int i = 0; i < 576; i++)
        check_near(k[i], expected_k[i], 1e-5 * max);
      bw_release(turned);
      bw_release(expected);
    }
    bw_release(m);
  }
  bw_release(library);
}

/* A block that was fitted has its own fit, turned as it is. */
static void test_own_fits(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, true, 2, 30);
  const bwi_levels *levels = library->inner->levels;
  for (int32_t f = 0; f < library->fit_count[1]; f++) {
    int32_t cell[8], key[64], image[64], found;
    bw_solid_material *m, *expected;
    bwi_levels_block(levels, f, cell);
    for (int c = 0; c < 8; c++)
      bwi_key_of(library->material_table->count, levels->code[0][cell[c]], key + 8 * c);
    bwi_symmetry_key(f % 48, 64, key, image);
    check_ok(context, bw_library_material(context, library, 2, image, &m, &found));
    check_ok(context,
             bwi_material_transformed(context, library->inner->fit[1][found], f % 48, &expected));
    double k[576], expected_k[576];
    bwi_material_stiffness(m, k);
    bwi_material_stiffness(expected, expected_k);
    assert_int_equal(found, f);
    for (int i = 0; i < 576; i++)
      check_near(k[i], expected_k[i], 1e-5 * expected_k[0]);
    bw_release(m);
    bw_release(expected);
  }
  bw_release(library);
}

/* The same for any number of threads; more representatives are nearer. */
static void test_threads(void **state) {
  bw_context *context = check_context(state);
  check_ok(context, bw_set_threads(context, 1));
  bw_library *one = fixture_library(context, 2, true, 2, 30);
  check_ok(context, bw_set_threads(context, 3));
  bw_library *three = fixture_library(context, 2, true, 2, 30);
  bw_library *more = fixture_library(context, 2, true, 2, 90);
  fixture_same(one, three);
  assert_true(more->inner->levels->typical[0] < one->inner->levels->typical[0]);
  bw_release(one);
  bw_release(three);
  bw_release(more);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 1, 8);
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 1) {
    bwi_levels *levels = NULL;
    status = bwi_levels_create(context, library->inner->keys, library->inner->fit[0], 8, &levels);
    bwi_levels_destroy(levels);
  }
  bw_release(library);
}

check_main(check_test(test_farthest), check_test(test_own_fits), check_test(test_tables),
           check_test(test_symmetry), check_test(test_threads), check_test(test_memory))
