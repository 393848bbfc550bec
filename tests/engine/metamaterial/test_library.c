/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building libraries, through kills and on any number of threads, and coarsening by them. */
#include "library_fixture.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char checkpoint[] = "/tmp/barwright_checkpoint_XXXXXX";

static bw_library_options small_options(int levels) {
  bw_library_options options;
  bw_library_options_default(&options);
  options.levels = levels;
  options.directions = 4;
  options.magnitudes = 1;
  options.stretches = 6;
  options.representatives = 8;
  return options;
}

static bw_library *build(bw_context *context, const bw_material_table *material_table, int levels,
                         const char *file) {
  bw_library_options options = small_options(levels);
  bw_library *library;
  check_ok(context, bw_library_build(context, material_table, &options, file, &library));
  return library;
}

static void progress(void *data, const char *stage, double fraction) {
  double *max = (double *)data;
  assert_non_null(stage);
  assert_true(fraction >= 0 && fraction <= 1);
  *max = fraction > *max ? fraction : *max;
}

static void test_threads(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  double max = 0;
  check_ok(context, bw_set_threads(context, 1));
  bw_library *one = build(context, material_table, 2, NULL);
  check_ok(context, bw_set_threads(context, 3));
  bw_set_progress(context, progress, &max);
  bw_library *three = build(context, material_table, 2, NULL);
  bw_set_progress(context, NULL, NULL);
  assert_int_equal(one->fit_count[0], 21); /* 22 by Burnside, one of them void alone */
  check_near(max, 1, 0);
  fixture_same(one, three);
  bw_release(one);
  bw_release(three);
  bw_release(material_table);
}

/* In a process of its own, so that it can be killed anywhere. */
static void build_in_child(void) {
  bw_context *context = bw_context_create();
  bw_solid_material *material;
  bw_material_table *material_table;
  bw_library *library;
  bw_library_options options = small_options(1);
  bool good = bw_solid_material_create(context, "soft", BW_NEO_HOOKEAN, 1e5, 0.45, 1000,
                                       &material) == BW_OK &&
              bw_material_table_create(context, 2, (const bw_solid_material *const *)&material,
                                       &material_table) == BW_OK &&
              bw_library_build(context, material_table, &options, checkpoint, &library) == BW_OK;
  _exit(good ? 0 : 1);
}

static void test_kills(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  bw_library *whole = build(context, material_table, 1, NULL), *resumed;
  bw_random random;
  int ended = 0, kills = 0;
  bw_random_seed(&random, 77);
  unlink(checkpoint);
  for (int attempt = 0; attempt < 60 && !ended; attempt++) {
    int result = 0;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
      build_in_child();
    if (attempt > 0)
      usleep((useconds_t)(bw_random_uniform(&random) * 4000 * attempt));
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, &result, 0), child);
    kills += WIFSIGNALED(result) != 0;
    ended = WIFEXITED(result) && WEXITSTATUS(result) == 0;
    assert_true(ended || WIFSIGNALED(result));
    if (ended && kills == 0) { /* the child was faster than its kill: once more */
      unlink(checkpoint);
      ended = 0;
    }
  }
  assert_true(kills > 0);
  resumed = build(context, material_table, 1, checkpoint);
  fixture_same(whole, resumed);
  assert_true(resumed->seconds > 0);
  bw_release(resumed);
  bw_release(whole);
  bw_release(material_table);
}

static void write_bytes(const unsigned char *bytes, size_t count) {
  FILE *file = fopen(checkpoint, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, count, file), count);
  fclose(file);
}

/* Whatever a kill leaves of the last record, and whatever follows it. */
static void test_cuts(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  unsigned char *bytes;
  size_t count;
  unlink(checkpoint);
  bw_library *whole = build(context, material_table, 1, checkpoint), *resumed;
  check_ok(context, bw_read_file(context, checkpoint, &bytes, &count));
  const size_t cut[] = {0, 3, 11, 60, count - 1, count - 3, count - 5, count - 200, count - 600};
  for (size_t i = 0; i < sizeof cut / sizeof cut[0]; i++) {
    write_bytes(bytes, cut[i]);
    resumed = build(context, material_table, 1, checkpoint);
    fixture_same(whole, resumed);
    bw_release(resumed);
    unsigned char *again;
    size_t size;
    check_ok(context, bw_read_file(context, checkpoint, &again, &size));
    assert_int_equal(size, count);
    bw_free(again);
  }
  bytes[count - 20] ^= 4; /* the last record is damaged: it is made again */
  write_bytes(bytes, count);
  resumed = build(context, material_table, 1, checkpoint);
  fixture_same(whole, resumed);
  bw_release(resumed);
  bw_free(bytes);
  bw_release(whole);
  bw_release(material_table);
}

static void test_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1),
                    *other = fixture_material_table(context, 2);
  bw_library_options options = small_options(1);
  bw_library *library = NULL;
  unlink(checkpoint);
  bw_release(build(context, material_table, 1, checkpoint));
  check_fails(context, BW_INVALID, "it has 1 materials instead of 2",
              bw_library_build(context, other, &options, checkpoint, &library));
  options.directions = 5;
  check_fails(context, BW_INVALID, "its option directions is 4 instead of 5",
              bw_library_build(context, material_table, &options, checkpoint, &library));
  options.directions = 4;
  options.seed = 5;
  check_fails(context, BW_INVALID, "its seed is 1 instead of 5",
              bw_library_build(context, material_table, &options, checkpoint, &library));
  options = small_options(1);
  write_bytes((const unsigned char *)"solid cube, and more than that", 30);
  check_fails(context, BW_FORMAT, "no checkpoint",
              bw_library_build(context, material_table, &options, checkpoint, &library));
  check_fails(context, BW_IO, "cannot open",
              bw_library_build(context, material_table, &options, "/tmp/nowhere/at/all", &library));
  options.levels = 3;
  check_fails(context, BW_INVALID, "levels is 3",
              bw_library_build(context, material_table, &options, NULL, &library));
  options = small_options(1);
  bw_cancel(context);
  check_fails(context, BW_CANCELLED, "",
              bw_library_build(context, material_table, &options, NULL, &library));
  bw_clear_cancel(context);
  bw_release(material_table);
  bw_release(other);
}

/* ---- coarsening ------------------------------------------------------------------------------ */

static bw_grid *make_grid(bw_context *context, const int32_t cells[3], const int32_t *material,
                          const double *fraction) {
  const double origin[3] = {0, 0, 0}, spacing[3] = {0.01, 0.01, 0.01};
  bw_grid *grid;
  check_ok(context, bw_grid_create(context, origin, spacing, cells, material, fraction, &grid));
  return grid;
}

/* Every coarse element has the material of its key. */
static void test_lookup(void **state) {
  bw_context *context = check_context(state);
  enum { X = 6, Y = 7, Z = 4, CELLS = X * Y * Z };
  const int32_t cells[3] = {X, Y, Z};
  for (int levels = 1; levels <= 2; levels++) {
    bw_library *library = fixture_library(context, 2, true, levels, 40);
    int32_t material[CELLS];
    bw_random random;
    bw_random_seed(&random, 31);
    for (int i = 0; i < CELLS; i++)
      material[i] = (int32_t)(bw_random_bits(&random) % 3);
    material[0] = 1;
    bw_grid *grid = make_grid(context, cells, material, NULL);
    bw_coarse *coarse;
    check_ok(context, bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, grid,
                                 levels, &coarse));
    assert_ptr_equal(coarse->library, library);
    double fine_mass = 0, coarse_mass = 0;
    for (int i = 0; i < CELLS; i++)
      fine_mass += material[i] ? library->material_table->material[material[i]]->density : 0;
    for (int32_t e = 0; e < coarse->grid->element_count; e++) {
      const bw_solid_material *m = coarse->material_table->material[coarse->grid->material[e]];
      bw_solid_material *expected;
      int32_t key[64], place = coarse->grid->cell[e], at[3];
      at[0] = place % coarse->grid->cells[0] << levels;
      at[1] = place / coarse->grid->cells[0] % coarse->grid->cells[1] << levels;
      at[2] = place / coarse->grid->cells[0] / coarse->grid->cells[1] << levels;
      for (int p = 0; p < (levels == 1 ? 8 : 64); p++) {
        int low = p % 8, high = levels == 1 ? 0 : p / 8, x[3];
        for (int d = 0; d < 3; d++)
          x[d] = at[d] + (low >> d & 1) + 2 * (high >> d & 1);
        key[p] = x[0] < X && x[1] < Y && x[2] < Z ? material[x[0] + X * (x[1] + Y * x[2])] : 0;
      }
      check_ok(context, bw_library_material(context, library, levels, key, &expected, NULL));
      size_t points = (size_t)m->rule->count;
      assert_memory_equal(m->mu, expected->mu, points * sizeof *m->mu);
      size_t fibres = points * (size_t)m->fibre_count;
      assert_int_equal(m->fibre_count, expected->fibre_count);
      assert_memory_equal(m->fibre, expected->fibre, 3 * fibres * sizeof *m->mu);
      assert_true(m->density == expected->density);
      bw_release(expected);
      coarse_mass += (levels == 1 ? 8 : 64) * m->density;
    }
    check_near(coarse_mass / fine_mass, 1, 1e-12);
    bw_release(coarse);
    bw_release(grid);
    bw_release(library);
  }
}

/* A block with void, one cell of which holds a single element where the cell that stands for it is
 * nearly full or the other way round, is made of its cells' means; without void it never is. */
static void test_far(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 1, true, 2, 10);
  bw_random random;
  int far = 0, near = 0;
  bw_random_seed(&random, 5);
  for (int turn = 0; turn < 60; turn++) {
    int32_t key[64], fit;
    bw_solid_material *material, *turned, *expected;
    for (int p = 0; p < 64; p++)
      key[p] =
          (int32_t)(bw_random_bits(&random) % 8) < (p / 8 == turn % 8 ? 7 : 1 + turn % 4) ? 1 : 0;
    key[turn] = 1;
    check_ok(context, bw_library_material(context, library, 2, key, &material, &fit));
    far += fit < 0;
    near += fit >= 0;
    if (fit < 0) {
      int32_t image[64];
      assert_int_equal(material->fibre_count, 0);
      for (int c = 0; c < 8; c++) {
        int solid = 0, symmetry;
        for (int p = 8 * c; p < 8 * c + 8; p++)
          solid += key[p];
        const bw_solid_material *cell = bwi_library_cell(library, key + 8 * c, &symmetry);
        double mean = 0;
        for (int p = 0; cell && p < 8; p++)
          mean += (cell->mu[p] + cell->fibre_stiffness[3 * p] * 6 / 15) / 8; /* three alike */
        if (solid > 0)
          check_near(material->mu[c], mean, 1e-6 * mean);
        else
          assert_true(material->mu[c] > 0 && material->mu[c] < 100);
      }
      bwi_symmetry_key(13, 64, key, image);
      check_ok(context, bw_library_material(context, library, 2, image, &turned, NULL));
      check_ok(context, bwi_material_transformed(context, material, 13, &expected));
      for (int p = 0; p < 8; p++)
        check_near(turned->mu[p], expected->mu[p], 1e-6 * expected->mu[p]);
      bw_release(turned);
      bw_release(expected);
    }
    bw_release(material);
  }
  assert_true(far > 5 && near > 5);
  bw_release(library);
}

/* Edits followed are edits made from scratch; also with partial cells. */
static void test_follow(void **state) {
  bw_context *context = check_context(state);
  enum { CELLS = 8 * 8 * 4 };
  const int32_t cells[3] = {8, 8, 4};
  for (int round = 0; round < 4; round++) {
    int levels = 1 + round % 2;
    bw_library *library = fixture_library(context, 1, true, levels, 30);
    int32_t material[CELLS];
    double fraction[CELLS];
    bw_random random;
    bw_random_seed(&random, (uint64_t)round);
    for (int i = 0; i < CELLS; i++) {
      material[i] = (int32_t)(bw_random_bits(&random) % 2);
      fraction[i] = bw_random_bits(&random) % 4 ? 1 : bw_random_uniform(&random) + 1e-6;
    }
    material[0] = 1;
    bw_grid *grid = make_grid(context, cells, material, round < 2 ? NULL : fraction);
    bw_coarse *coarse, *next, *fresh;
    check_ok(context, bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, grid,
                                 levels, &coarse));
    for (int step = 0; step < 8; step++) {
      for (int i = 0; i < 3; i++)
        material[1 + bw_random_bits(&random) % (CELLS - 1)] ^= 1;
      bw_grid *edited = make_grid(context, cells, material, round < 2 ? NULL : fraction);
      check_ok(context, bw_coarse_follow(context, coarse, edited, &next));
      check_ok(context, bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table,
                                   edited, levels, &fresh));
      assert_true(next->looked_up <= 3);
      assert_int_equal(next->material_table->count, fresh->material_table->count);
      assert_memory_equal(next->grid->material, fresh->grid->material,
                          (size_t)fresh->grid->element_count * sizeof(int32_t));
      for (int32_t r = 1; r < fresh->material_table->count; r++) {
        const bw_solid_material *a = next->material_table->material[r],
                                *b = fresh->material_table->material[r];
        assert_memory_equal(a->mu, b->mu, (size_t)a->rule->count * sizeof *a->mu);
        size_t fibres = (size_t)a->rule->count * (size_t)a->fibre_count;
        assert_int_equal(a->fibre_count, b->fibre_count);
        assert_memory_equal(a->fibre_stiffness, b->fibre_stiffness, fibres * sizeof *a->mu);
        assert_true(a->density == b->density);
      }
      bw_release(fresh);
      bw_release(coarse);
      bw_release(grid);
      coarse = next;
      grid = edited;
    }
    bw_release(coarse);
    bw_release(grid);
    bw_release(library);
  }
}

static void test_lookup_refusals(void **state) {
  bw_context *context = check_context(state);
  bw_library *library = fixture_library(context, 2, false, 1, 8);
  bw_material_table *fewer = fixture_material_table(context, 1),
                    *other = fixture_material_table(context, 4);
  const int32_t cells[3] = {2, 2, 2};
  int32_t key[8] = {1, 1, 1, 2, 1, 1, 1, 3}, material[8] = {1, 2, 1, 1, 0, 1, 1, 1};
  bw_grid *grid = make_grid(context, cells, NULL, NULL),
          *empty = make_grid(context, cells, material, NULL), *flat;
  bw_coarse *coarse, *naive;
  bw_solid_material *m;
  check_fails(context, BW_INVALID, "1 materials, the library is of 2",
              bw_coarsen(context, BW_COARSE_LOOKUP, library, fewer, grid, 1, &coarse));
  check_fails(
      context, BW_INVALID, "2 levels with a library of 1",
      bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, grid, 2, &coarse));
  const bw_solid_material *pair[2] = {other->material[1], other->material[3]};
  bw_material_table *swapped;
  check_ok(context, bw_material_table_create(context, 3, pair, &swapped));
  check_fails(context, BW_INVALID, "material 2 is stiff (neo_hookean",
              bw_coarsen(context, BW_COARSE_LOOKUP, library, swapped, grid, 1, &coarse));
  const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 2};
  check_ok(context, bw_grid_create(context, origin, spacing, cells, NULL, NULL, &flat));
  check_fails(
      context, BW_INVALID, "a library is of cubes",
      bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, flat, 1, &coarse));
  check_fails(context, BW_INVALID, "number 8 of the key is 3",
              bw_library_material(context, library, 1, key, &m, NULL));
  memset(key, 0, sizeof key);
  check_fails(context, BW_EMPTY, "void alone",
              bw_library_material(context, library, 1, key, &m, NULL));
  /* A library without void: blocks with void are naive. */
  check_ok(context, bw_coarsen(context, BW_COARSE_LOOKUP, library, library->material_table, empty,
                               1, &coarse));
  check_ok(context,
           bw_coarsen(context, BW_COARSE_NAIVE, NULL, library->material_table, empty, 1, &naive));
  assert_memory_equal(coarse->material_table->material[1]->mu,
                      naive->material_table->material[1]->mu, 8 * sizeof(double));
  bw_release(coarse);
  bw_release(naive);
  bw_release(grid);
  bw_release(empty);
  bw_release(flat);
  bw_release(swapped);
  bw_release(fewer);
  bw_release(other);
  bw_release(library);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_material_table *material_table = fixture_material_table(context, 1);
  bw_library *fixture = fixture_library(context, 1, true, 2, 12);
  bw_library_options options = small_options(1);
  const int32_t cells[3] = {4, 4, 2};
  bw_grid *grid = make_grid(context, cells, NULL, NULL);
  check_ok(context, bw_set_threads(context, 1));
  options.voids = false; /* a single orbit */
  for (int64_t n = 1;; n += n < 60 ? 1 : 1 + n / 16) {
    bw_library *library = NULL;
    bw_coarse *coarse = NULL;
    int64_t blocks = bw_live_blocks();
    unlink(checkpoint);
    bw_fail_allocation(n, true);
    bw_status status = bw_library_build(context, material_table, &options, checkpoint, &library);
    if (status == BW_OK)
      status =
          bw_coarsen(context, BW_COARSE_LOOKUP, fixture, fixture->material_table, grid, 2, &coarse);
    bw_fail_allocation(0, false);
    bw_release(library);
    bw_release(coarse);
    assert_int_equal(bw_live_blocks(), blocks);
    if (status == BW_OK)
      break;
    assert_int_equal(status, BW_MEMORY);
  }
  bw_release(grid);
  bw_release(fixture);
  bw_release(material_table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_threads),  check_test(test_kills),  check_test(test_cuts),
      check_test(test_refusals), check_test(test_lookup), check_test(test_far),
      check_test(test_follow),   check_test(test_memory), check_test(test_lookup_refusals),
  };
  int file = mkstemp(checkpoint);
  if (file < 0)
    return 1;
  close(file);
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(checkpoint);
  return failed;
}
