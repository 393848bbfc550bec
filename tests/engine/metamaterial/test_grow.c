/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Libraries grown for grids: the fits that building gives, found whatever way a block is turned,
 * the same through checkpoints, files and any order of growing. */
#include "library_fixture.h"

#include <unistd.h>

#include "metamaterial/coarse.h"

static char path[] = "/tmp/barwright_grown_XXXXXX";

static bw_library_options small_options(int levels) {
  bw_library_options options;
  bw_library_options_default(&options);
  options.levels = levels;
  options.directions = 3;
  options.magnitudes = 1;
  options.stretches = 6;
  options.representatives = 8;
  return options;
}

static bw_library *build(bw_context *context, const bw_material_table *material_table, int levels) {
  bw_library_options options = small_options(levels);
  bw_library *library;
  check_ok(context, bw_library_build(context, material_table, &options, NULL, &library));
  return library;
}

static bw_library *grow(bw_context *context, const bw_library *of, const bw_grid *grid, int levels,
                        const char *checkpoint) {
  bw_library *library;
  check_ok(context,
           bw_library_grow(context, of, of->material_table, grid, levels, checkpoint, &library));
  return library;
}

/* Few cells, so that fits are few: blocks repeat, turned. */
static bw_grid *make_grid(bw_context *context, uint64_t seed, int materials, int32_t min) {
  enum { CELLS = 8 * 4 * 4 };
  const double origin[3] = {0, 0, 0}, spacing[3] = {0.01, 0.01, 0.01};
  const int32_t cells[3] = {8, 4, 4};
  int32_t material[CELLS];
  bw_random random;
  bw_grid *grid;
  bw_random_seed(&random, seed);
  for (int i = 0; i < CELLS; i++) {
    int at[3] = {i % 8, i / 8 % 4, i / 32};
    material[i] = at[0] / 2 == (int)(seed % 4) && at[1] < 2
                      ? min + (int32_t)(bw_random_bits(&random) % (unsigned)(materials + 1 - min))
                      : 1 + (at[0] + (int)seed) / 2 % materials;
  }
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, NULL, &grid));
  return grid;
}

/* The fibre of point p that runs along v, either way: a block with symmetries of its own may have
 * them in another order. */
static double stiffness_along(const bw_solid_material *m, int p, const double v[3]) {
  int best = 0;
  double max = -1;
  for (int f = 0; f < m->fibre_count; f++) {
    double along = fabs(bw_dot(v, m->fibre + 3 * (p * m->fibre_count + f)));
    if (along > max) {
      max = along;
      best = f;
    }
  }
  check_near(max, 1, 1e-5);
  return m->fibre_stiffness[p * m->fibre_count + best];
}

static void same_materials(const bw_solid_material *m, const bw_solid_material *n, double error) {
  assert_int_equal(m->rule->count, n->rule->count);
  assert_int_equal(m->fibre_count, n->fibre_count);
  for (int p = 0; p < m->rule->count; p++) {
    check_near(m->mu[p], n->mu[p], error * m->mu[p]);
    check_near(m->lambda[p], n->lambda[p], error * m->lambda[p]);
    for (int f = 0; f < m->fibre_count; f++)
      if (m->fibre_stiffness[p * m->fibre_count + f] > 0)
        check_near(m->fibre_stiffness[p * m->fibre_count + f],
                   stiffness_along(n, p, m->fibre + 3 * (p * m->fibre_count + f)),
                   error * m->mu[p]);
  }
}

static void key_of(const bw_grid *grid, int levels, int x, int32_t key[64]) {
  for (int p = 0; p < (levels == 1 ? 8 : 64); p++) {
    int at[3], low = p % 8, high = levels == 1 ? 0 : p / 8;
    for (int d = 0; d < 3; d++)
      at[d] = (low >> d & 1) + 2 * (high >> d & 1) + (d == 0 ? x : 0);
    int32_t e = grid->at[at[0] + 8 * (at[1] + 4 * at[2])];
    key[p] = e < 0 ? 0 : grid->material[e];
  }
}

/* A library of nothing, grown, has the fits that building all blocks gives, for its grid's blocks.
 */
static void test_as_built(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  bw_library *whole = build(context, material_table, 1), *empty = build(context, material_table, 0);
  bw_grid *grid = make_grid(context, 4, 1, 0);
  assert_int_equal(empty->levels, 0);
  assert_int_equal(empty->fit_count[0], 0);
  bw_library *grown = grow(context, empty, grid, 1, NULL);
  assert_int_equal(grown->levels, 1);
  assert_in_range(grown->grown_count[0], 2, 8);
  for (int x = 0; x < 8; x += 2) {
    int32_t key[64], fit, other;
    bw_solid_material *a, *b;
    key_of(grid, 1, x, key);
    check_ok(context, bw_library_material(context, whole, 1, key, &a, &other));
    check_ok(context, bw_library_material(context, grown, 1, key, &b, &fit));
    assert_in_range(fit, 0, grown->grown_count[0] - 1);
    same_materials(a, b, 1e-6);
    bw_release(a);
    bw_release(b);
  }
  /* what the grid has not is naive */
  const int32_t unknown[8] = {1, 0, 0, 0, 0, 0, 0, 1};
  bw_solid_material *naive;
  int32_t fit;
  check_ok(context, bw_library_material(context, grown, 1, unknown, &naive, &fit));
  assert_int_equal(fit, -1);
  assert_true(naive->mu[0] == material_table->material[1]->mu[0]);
  bw_release(naive);
  /* nothing is missing in a library of all blocks */
  bw_library *same = grow(context, whole, grid, 1, NULL);
  assert_int_equal(same->grown_count[0], 0);
  fixture_same(whole, same);
  bw_release(same);
  bw_release(grown);
  bw_release(empty);
  bw_release(whole);
  bw_release(grid);
  bw_release(material_table);
}

/* Blocks of 64 have fits of their own, whichever way they are turned; others keep their
 * representatives. */
static void test_blocks(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, true, 2, 30);
  library->options.directions = 3;
  library->options.magnitudes = 1;
  library->options.stretches = 6;
  bw_grid *grid = make_grid(context, 1, 2, 1), *other = make_grid(context, 6, 2, 1);
  bw_library *grown = grow(context, library, grid, 2, NULL);
  assert_int_equal(grown->grown_count[0], 0);
  assert_int_equal(grown->grown_count[1], 2);
  int32_t key[64], image[64], fit;
  bw_solid_material *of, *turned, *expected, *before;
  for (int x = 0; x < 8; x += 4) {
    key_of(grid, 2, x, key);
    assert_true(bwi_library_has_block(grown, key));
    check_ok(context, bw_library_material(context, grown, 2, key, &of, &fit));
    assert_in_range(fit, grown->fit_count[1], grown->fit_count[1] + 1);
    for (int s = 1; s < BWI_SYMMETRIES; s += 5) {
      bwi_symmetry_key(s, 64, key, image);
      check_ok(context, bwi_material_transformed(context, of, s, &expected));
      check_ok(context, bw_library_material(context, grown, 2, image, &turned, NULL));
      same_materials(expected, turned, 1e-5);
      bw_release(expected);
      bw_release(turned);
    }
    bw_release(of);
  }
  /* the library itself knows its representatives, not the block */
  assert_false(bwi_library_has_block(library, key));
  for (int p = 0; p < 64; p++)
    image[p] = 2;
  assert_true(bwi_library_has_block(library, image));
  key_of(other, 2, 4, image);
  check_ok(context, bw_library_material(context, library, 2, image, &before, NULL));
  check_ok(context, bw_library_material(context, grown, 2, image, &of, &fit));
  assert_in_range(fit, 0, grown->fit_count[1] - 1);
  same_materials(before, of, 0);
  bw_release(before);
  bw_release(of);
  /* either order of growing, and both at once, give the same */
  bw_library *further = grow(context, grown, other, 2, NULL);
  bw_library *first = grow(context, library, other, 2, NULL);
  bw_library *second = grow(context, first, grid, 2, NULL);
  bw_release(grown); /* grown ones do not need those that they grew from */
  bw_release(first);
  fixture_same(further, second);
  bw_library *again = grow(context, second, grid, 2, NULL);
  fixture_same(second, again);
  bw_release(again);
  bw_release(further);
  bw_release(second);
  bw_release(library);
  bw_release(grid);
  bw_release(other);
}

static void progress(void *data, const char *stage, double fraction) {
  assert_non_null(stage);
  assert_true(fraction >= 0 && fraction <= 1);
  *(double *)data = fraction;
}

/* From nothing over two levels, on one thread and several, through a checkpoint, into a file. */
static void test_there_and_back(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 2);
  bw_library *empty = build(context, material_table, 0), *read = NULL;
  bw_grid *grid = make_grid(context, 2, 2, 1), *other = make_grid(context, 3, 2, 1);
  double last = 0;
  unlink(path);
  check_ok(context, bw_set_threads(context, 1));
  bw_library *one = grow(context, empty, grid, 2, NULL);
  check_ok(context, bw_set_threads(context, 3));
  bw_set_progress(context, progress, &last);
  bw_library *three = grow(context, empty, grid, 2, path);
  bw_set_progress(context, NULL, NULL);
  check_near(last, 1, 0);
  assert_int_equal(one->levels, 2);
  assert_int_equal(one->grown_count[1], 2);
  fixture_same(one, three);
  bw_release(three);
  /* the checkpoint serves again, cut or not, and for another grid */
  for (int turn = 0; turn < 3; turn++) {
    if (turn == 1) {
      unsigned char *bytes;
      size_t count;
      check_ok(context, bw_read_file(context, path, &bytes, &count));
      assert_int_equal(truncate(path, (off_t)count - 70), 0);
      bw_free(bytes);
    }
    if (turn == 2)
      bw_release(grow(context, empty, other, 2, path));
    three = grow(context, empty, grid, 2, path);
    fixture_same(one, three);
    bw_release(three);
  }
  bw_library_options options = small_options(0);
  options.levels = 1;
  check_fails(context, BW_INVALID, "its option levels is 0 instead of 1",
              bw_library_build(context, material_table, &options, path, &read));
  options.levels = 0;
  check_fails(context, BW_INVALID, "grown for a grid",
              bw_library_build(context, material_table, &options, path, &read));
  char *text;
  check_ok(context, bw_library_describe(context, one, &text));
  assert_non_null(strstr(text, "level 2: 2 fits of blocks of grids it was grown for"));
  bw_free(text);
  check_ok(context, bw_library_write(context, one, path));
  check_ok(context, bw_library_read(context, path, &read));
  fixture_same(one, read);
  bw_release(read);
  bw_release(one);
  bw_release(empty);
  bw_release(grid);
  bw_release(other);
  bw_release(material_table);
}

/* Edits of a grid are followed; blocks that are new are looked up as ever. */
static void test_follow(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 2);
  bw_library *empty = build(context, material_table, 0);
  bw_grid *grid = make_grid(context, 2, 2, 1), *edited = make_grid(context, 3, 2, 1);
  bw_library *grown = grow(context, empty, grid, 2, NULL);
  for (int levels = 1; levels <= 2; levels++) {
    bw_coarse *coarse, *followed, *fresh;
    check_ok(context,
             bw_coarsen(context, BW_COARSE_LOOKUP, grown, material_table, grid, levels, &coarse));
    check_ok(context, bw_coarse_follow(context, coarse, edited, &followed));
    check_ok(context,
             bw_coarsen(context, BW_COARSE_LOOKUP, grown, material_table, edited, levels, &fresh));
    assert_int_equal(followed->material_table->count, fresh->material_table->count);
    for (int32_t r = 1; r < fresh->material_table->count; r++)
      assert_memory_equal(followed->material_table->material[r]->mu,
                          fresh->material_table->material[r]->mu,
                          (size_t)fresh->material_table->material[r]->rule->count * sizeof(double));
    bw_release(coarse);
    bw_release(followed);
    bw_release(fresh);
  }
  bw_coarse *none = NULL;
  check_fails(context, BW_INVALID, "with a library of 0",
              bw_coarsen(context, BW_COARSE_LOOKUP, empty, material_table, grid, 1, &none));
  bw_release(grown);
  bw_release(empty);
  bw_release(grid);
  bw_release(edited);
  bw_release(material_table);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 2),
                    *other = fixture_material_table(context, 3);
  bw_library *empty = build(context, material_table, 0), *library = NULL;
  bw_grid *grid = make_grid(context, 2, 2, 1);
  const double origin[3] = {0, 0, 0}, uneven[3] = {1, 2, 1};
  const int32_t cells[3] = {2, 1, 1}, material[2] = {1, 2};
  bw_grid *bricks;
  check_fails(context, BW_INVALID, "3 levels",
              bw_library_grow(context, empty, material_table, grid, 3, NULL, &library));
  check_fails(context, BW_INVALID, "the material table has 3 materials",
              bw_library_grow(context, empty, other, grid, 1, NULL, &library));
  check_ok(context, bw_grid_create(context, origin, uneven, cells, material, NULL, &bricks));
  check_fails(context, BW_INVALID, "is of cubes",
              bw_library_grow(context, empty, material_table, bricks, 1, NULL, &library));
  unlink(path);
  bw_library_options options = small_options(1);
  bw_material_table *one = fixture_material_table(context, 1);
  bw_grid *small = make_grid(context, 2, 1, 0);
  options.voids = false; /* so that something is missing */
  bw_library *solid = NULL;
  check_ok(context, bw_library_build(context, one, &options, path, &solid));
  check_fails(context, BW_INVALID, "being built, not grown",
              bw_library_grow(context, solid, one, small, 1, path, &library));
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "",
              bw_library_grow(context, solid, one, small, 1, NULL, &library));
  bw_clear_cancel(context);
  assert_null(library);
  bw_release(solid);
  bw_release(one);
  bw_release(small);
  bw_release(bricks);
  bw_release(grid);
  bw_release(empty);
  bw_release(material_table);
  bw_release(other);
}

/* What a damaged file can claim of blocks. */
static void test_claims(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  bw_library *empty = build(context, material_table, 0), *read = NULL;
  bw_grid *grid = make_grid(context, 4, 1, 0);
  bw_library *grown = grow(context, empty, grid, 1, NULL);
  const bwi_grown *entries = &grown->inner->grown[0];
  assert_true(entries->count >= 2);
  static const char *const why[] = {"in its grown fits", "material 9", "not in order",
                                    "do not fit"};
  for (int wrong = 0; wrong < 4; wrong++) {
    bwi_pack head, fits;
    bwi_pack_begin(&head, context);
    bwi_pack_begin(&fits, context);
    bwi_pack_head(&head, material_table, &grown->options);
    bwi_pack_u32(&fits, wrong == 3 ? 1u << 30 : (uint32_t)entries->count);
    bwi_pack_bytes(&fits, entries->key, 8 * (size_t)entries->count);
    for (int32_t f = 0; f < entries->count; f++)
      bwi_pack_fit(&fits, entries->fit[f], &entries->error[f]);
    bwi_pack_u32(&fits, 0);
    if (wrong == 1)
      fits.bytes[4] = 9;
    if (wrong == 2)
      memcpy(fits.bytes + 4, fits.bytes + 12, 8);
    const bwi_file_section section[BWI_SECTIONS] = {{head.bytes, head.count},
                                                    {fits.bytes, 0},
                                                    {fits.bytes, 0},
                                                    {fits.bytes, 0},
                                                    {fits.bytes, fits.count - (wrong == 0)}};
    check_fails(context, BW_FORMAT, why[wrong],
                bwi_library_of_sections(context, "a.bwm", section, &read));
    bwi_pack_clear(&head);
    bwi_pack_clear(&fits);
  }
  bw_release(grown);
  bw_release(grid);
  bw_release(empty);
  bw_release(material_table);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  bw_library *empty, *grown = NULL, *read = NULL;
  bw_library_options options = small_options(0);
  options.fibres = 0; /* quick fits, for there are many */
  options.directions = 1;
  check_ok(context, bw_library_build(context, material_table, &options, NULL, &empty));
  const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
  const int32_t cells[3] = {4, 4, 2}, material[32] = {[0] = 1, [1] = 1, [4] = 1};
  bw_grid *grid;
  check_ok(context, bw_set_threads(context, 1));
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, NULL, &grid));
  check_each_allocation(context, status, 1) {
    unlink(path);
    status = bw_library_grow(context, empty, material_table, grid, 2, path, &grown);
  }
  check_ok(context, bw_library_write(context, grown, path));
  check_each_allocation(context, status, 1) {
    status = bw_library_read(context, path, &read);
  }
  fixture_same(grown, read);
  bw_release(read);
  bw_release(grown);
  bw_release(empty);
  bw_release(grid);
  bw_release(material_table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_as_built), check_test(test_blocks),   check_test(test_there_and_back),
      check_test(test_follow),   check_test(test_refusals), check_test(test_claims),
      check_test(test_memory),
  };
  int file = mkstemp(path);
  if (file < 0)
    return 1;
  close(file);
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(path);
  return failed;
}
