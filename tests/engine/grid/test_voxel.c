/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids of closed surfaces: fractions against closed forms, the surface's volume, other directions;
 * real files; refusals. */
#include "check.h"

#include "grid/internal.h"

static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};

/* The overlap of a box with each cell, whatever the box: exact, also where faces lie on the
 * lattice's planes, and where the box goes beyond it. */
static void boxes(void **state) {
  bw_context *context = check_context(state);
  const int32_t cells[3] = {5, 4, 3};
  const double spacing[3] = {0.5, 0.25, 1}, origin[3] = {-1, 2, 0.5};
  bw_random random;
  bw_random_seed(&random, 3);
  for (int trial = 0; trial < 40; trial++) {
    double low[3], high[3], fraction[60];
    for (int d = 0; d < 3; d++) {
      double size = cells[d] * spacing[d], a = bw_random_uniform(&random) * 1.4 - 0.2;
      double b = bw_random_uniform(&random) * 1.4 - 0.2;
      if (trial % 2 == 0) { /* on planes */
        a = floor(a * cells[d]) / cells[d];
        b = floor(b * cells[d]) / cells[d] + (b < a ? 0 : 1. / cells[d]);
        b = b == a ? a + 1. / cells[d] : b;
      }
      low[d] = origin[d] + size * fmin(a, b);
      high[d] = origin[d] + size * fmax(a, b);
    }
    bw_surface *box;
    check_ok(context, bw_surface_box_shape(context, low, high, &box));
    check_ok(context, bw_grid_fractions(context, box, origin, spacing, cells, fraction));
    for (int64_t c = 0; c < 60; c++) {
      int32_t place[3];
      double part = 1;
      bwi_grid_place(cells, c, place);
      for (int d = 0; d < 3; d++) {
        double from = origin[d] + spacing[d] * place[d], to = from + spacing[d];
        part *= fmax(fmin(to, high[d]) - fmax(from, low[d]), 0) / spacing[d];
      }
      check_near(fraction[c], part, 1e-9);
    }
    bw_release(box);
  }
  assert_null(bw_warning_at(context, 0));
}

static void aligned_box(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box;
  bw_grid *grid;
  bw_voxel_options options;
  bw_voxel_options_default(&options);
  options.spacing = 0.1;
  check_ok(context, bw_surface_box_shape(context, zero, (double[3]){0.8, 0.4, 0.3}, &box));
  check_ok(context, bw_grid_of_surface(context, box, &options, &grid));
  assert_int_equal(grid->cells[0], 8);
  assert_int_equal(grid->cells[1], 4);
  assert_int_equal(grid->cells[2], 3);
  assert_int_equal(grid->element_count, 96);
  for (int32_t e = 0; e < 96; e++)
    check_near(grid->fraction[e], 1, 0);
  check_near(bw_grid_volume(grid), 0.096, 1e-14);
  bw_release(grid);
  options.multiple = 4; /* half the slack on either side: a cell of 0.1 above, none below */
  options.material = 3;
  check_ok(context, bw_grid_of_surface(context, box, &options, &grid));
  assert_int_equal(grid->cells[2], 4);
  check_near(grid->origin[2], -0.05, 1e-15);
  check_near(grid->fraction[0], 0.5, 1e-12);
  assert_int_equal(grid->material[0], 3);
  check_near(bw_grid_volume(grid), 0.096, 1e-14);
  bw_release(grid);
  options.whole = true;
  options.min_fraction = 0.6;
  check_ok(context, bw_grid_of_surface(context, box, &options, &grid));
  assert_null(grid->fraction);
  check_near(bw_grid_volume(grid), 0.064, 1e-14);
  bw_release(grid);
  bw_release(box);
}

/* All of the volume of the polyhedron, and in the limit that of the sphere; the same cells from
 * another direction (lines run along x only). */
static void spheres(void **state) {
  bw_context *context = check_context(state);
  bw_surface *sphere, *turned;
  bw_grid *grid, *other;
  bw_voxel_options options;
  bw_voxel_options_default(&options);
  options.min_fraction = 0;
  const double turn[12] = {0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}; /* x to y, y to z, z to x */
  double exact = 4. / 3 * 3.141592653589793 * 0.7 * 0.7 * 0.7, error[2];
  for (int i = 0; i < 2; i++) {
    check_ok(context,
             bw_surface_sphere_shape(context, (double[3]){0.01, 0.02, -0.03}, 0.7, 3 + i, &sphere));
    for (options.cells = 7; options.cells < 40; options.cells += 12) {
      check_ok(context, bw_grid_of_surface(context, sphere, &options, &grid));
      check_near(bw_grid_volume(grid), bw_surface_volume(sphere), 1e-10);
      error[i] = fabs(bw_grid_volume(grid) / exact - 1);
      bw_release(grid);
    }
    bw_release(sphere);
  }
  assert_true(error[1] < 0.3 * error[0]);
  check_ok(context,
           bw_surface_sphere_shape(context, (double[3]){0.01, 0.02, -0.03}, 0.7, 2, &sphere));
  check_ok(context, bw_surface_transform(context, sphere, turn, &turned));
  options.cells = 12;
  check_ok(context, bw_grid_of_surface(context, sphere, &options, &grid));
  check_ok(context, bw_grid_of_surface(context, turned, &options, &other));
  assert_int_equal(grid->element_count, other->element_count);
  for (int32_t e = 0; e < grid->element_count; e++) {
    int32_t p[3];
    bwi_grid_place(grid->cells, grid->cell[e], p);
    int32_t q = other->at[p[2] + other->cells[0] * (p[0] + other->cells[1] * p[1])];
    assert_true(q >= 0);
    check_near(grid->fraction[e], other->fraction[q], 1e-10);
  }
  bw_release(grid);
  bw_release(other);
  bw_release(turned);
  bw_release(sphere);
}

static bw_surface *join(bw_context *context, const bw_surface *a, const bw_surface *b,
                        bool turn_b) {
  int64_t points = (int64_t)a->point_count + b->point_count;
  int64_t facets = (int64_t)a->triangle_count + b->triangle_count;
  double *point = (double *)malloc(24 * (size_t)points);
  int32_t *triangle = (int32_t *)malloc(12 * (size_t)facets);
  memcpy(point, a->point, 24 * (size_t)a->point_count);
  memcpy(point + 3 * a->point_count, b->point, 24 * (size_t)b->point_count);
  memcpy(triangle, a->triangle, 12 * (size_t)a->triangle_count);
  for (int32_t i = 0; i < 3 * b->triangle_count; i++) {
    int k = i % 3;
    triangle[3 * a->triangle_count + i] =
        b->triangle[turn_b ? i - k + (3 - k) % 3 : i] + a->point_count;
  }
  bw_surface *both;
  check_ok(context, bw_surface_copy(context, points, point, facets, triangle, NULL, &both));
  free(point);
  free(triangle);
  return both;
}

/* Hollow bodies, parts that face inwards, parts that overlap. */
static void shells(void **state) {
  bw_context *context = check_context(state);
  bw_surface *outer, *inner, *beside, *both;
  bw_grid *grid;
  bw_voxel_options options;
  bw_voxel_options_default(&options);
  options.min_fraction = 0;
  options.cells = 10;
  check_ok(context, bw_surface_box_shape(context, zero, one, &outer));
  check_ok(context, bw_surface_box_shape(context, (double[3]){0.25, 0.3, 0.3},
                                         (double[3]){0.75, 0.6, 0.7}, &inner));
  check_ok(context,
           bw_surface_box_shape(context, (double[3]){1.5, 0, 0}, (double[3]){2, 1, 1}, &beside));
  for (int turn = 0; turn < 2; turn++) { /* the cavity is one whichever way it faces */
    both = join(context, outer, inner, turn);
    check_ok(context, bw_grid_of_surface(context, both, &options, &grid));
    check_near(bw_grid_volume(grid), 1 - 0.5 * 0.3 * 0.4, 1e-12);
    bw_release(grid);
    bw_release(both);
    both = join(context, outer, beside, turn);
    check_ok(context, bw_grid_of_surface(context, both, &options, &grid));
    check_near(bw_grid_volume(grid), 1.5, 1e-12);
    bw_release(grid);
    bw_release(both);
    assert_non_null(
        strstr(bw_warning_at(context, 0), "in 2 parts that share no node, of 75 to 125"));
    assert_null(bw_warning_at(context, 1));
    bw_clear_warnings(context);
  }
  bw_release(beside);
  check_ok(context,
           bw_surface_box_shape(context, (double[3]){0.5, 0, 0}, (double[3]){1.5, 1, 1}, &beside));
  both = join(context, outer, beside, false);
  options.spacing = 0.1;
  check_ok(context, bw_grid_of_surface(context, both, &options, &grid));
  check_near(bw_grid_volume(grid), 1.5, 1e-12);
  assert_non_null(strstr(bw_warning_at(context, 0), "overlap in 500 cells"));
  bw_release(grid);
  bw_release(both);
  bw_release(outer);
  bw_release(inner);
  bw_release(beside);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box, *open;
  bw_grid *grid;
  bw_voxel_options options;
  check_ok(context, bw_surface_box_shape(context, zero, (double[3]){1, 1, 0.001}, &box));
  check_ok(context,
           bw_surface_copy(context, box->point_count, box->point, 11, box->triangle, NULL, &open));
  check_fails(context, BW_GEOMETRY, "not closed: at 3 of its 18 edges",
              bw_grid_of_surface(context, open, NULL, &grid));
  check_fails(context, BW_EMPTY, "volume fraction above 0.032 inside",
              bw_grid_of_surface(context, box, NULL, &grid));
  bw_voxel_options_default(&options);
  options.spacing = 1e-7;
  check_fails(context, BW_LIMIT, "take larger cells",
              bw_grid_of_surface(context, box, &options, &grid));
  options.spacing = -1;
  check_fails(context, BW_INVALID, "spacing must be positive",
              bw_grid_of_surface(context, box, &options, &grid));
  bw_voxel_options_default(&options);
  options.multiple = 0;
  check_fails(context, BW_INVALID, "multiples of 0",
              bw_grid_of_surface(context, box, &options, &grid));
  bw_surface *flat;
  check_ok(context, bw_surface_copy(context, 3, (double[9]){0, 0, 0, 1, 0, 0, 0, 1, 0}, 2,
                                    (int32_t[6]){0, 1, 2, 2, 1, 0}, NULL, &flat));
  check_fails(context, BW_GEOMETRY, "encloses nothing",
              bw_grid_of_surface(context, flat, NULL, &grid));
  bw_release(flat);
  bw_release(open);
  bw_release(box);
}

static void threads_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  bw_surface *sphere;
  bw_grid *grid[2];
  check_ok(context, bw_surface_sphere_shape(context, zero, 1, 4, &sphere));
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_set_threads(context, i ? 3 : 1));
    check_ok(context, bw_grid_of_surface(context, sphere, NULL, &grid[i]));
  }
  assert_true(bw_grid_same_elements(grid[0], grid[1]));
  assert_memory_equal(grid[0]->fraction, grid[1]->fraction, 8 * (size_t)grid[0]->element_count);
  bw_release(grid[0]);
  bw_release(grid[1]);
  bw_release(sphere);
}

/* ---- files ----------------------------------------------------------------------------------- */

static const char *const good[] = {
    "bottle_opener_round.stl",
    "triceratops.off",
    "chair.ply",
    "engine_bracket.obj",
    "rocker_arm.obj",
    "fandisk.obj",
    "anchor.off",
    "tray_bottom.stl",
    "fan_blade.stl",
    "fertility.off",
    "boot.obj",
    "cat.obj",
    "screwdriver.ply",
    "gear_spur.stl",
    "armadillo.obj",
    "ok_negative_indices.obj",
    "ok_ascii_odd_whitespace.stl",
    "ok_solid_header_binary.stl",
};
static const char *const bad[] = {
    "bad_horse_selfint.ply",    "bad_raptor_quads.obj",      "bad_chair_doublesided.obj",
    "bad_pliers_shells.stl",    "bad_gear_open.stl",         "bad_spider_ascii.stl",
    "bad_idler_riser_inch.stl", "bad_multibody_flipped.stl", "bad_quads_gear_two_shells.obj",
    "bad_zero_area_dup.off",    "bad_flipped_normals.stl",
};

static bw_surface *read_model(bw_context *context, const char *name) {
  char path[512];
  const char *shared = getenv("BARWRIGHT_SHARED");
  snprintf(path, sizeof path, "%s/models/%s", shared ? shared : "../shared", name);
  FILE *file = fopen(path, "rb");
  if (!file)
    skip();
  fclose(file);
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_read(context, path, &surface, NULL));
  return surface;
}

/* Every closed model gives its volume: all of it when no cell is left out. Blades that are thinner
 * than a cell lose some to cells with less than a twentieth inside. */
static void good_models(void **state) {
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    bw_surface *surface = read_model(context, good[i]);
    bw_voxel_options options;
    bw_grid *grid;
    bw_voxel_options_default(&options);
    options.cells = 60;
    double volume = fabs(bw_surface_volume(surface));
    for (int pass = 0; pass < 2; pass++) {
      options.min_fraction = pass ? 0.05 : 0;
      check_ok(context, bw_grid_of_surface(context, surface, &options, &grid));
      check_near(bw_grid_volume(grid) / volume, 1, pass ? 0.05 : 1e-11);
      bw_release(grid);
    }
    bw_release(surface);
  }
}

/* Broken ones are refused as not closed, or give a part of their box. */
static void bad_models(void **state) {
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    bw_surface *surface = read_model(context, bad[i]);
    bw_grid *grid;
    bw_status status = bw_grid_of_surface(context, surface, NULL, &grid);
    if (getenv("BARWRIGHT_PRINT"))
      printf("%s: %s\n", bad[i], status ? bw_message(context) : "fine");
    if (status == BW_OK) {
      assert_true(bw_grid_volume(grid) > 0);
      bw_release(grid);
    } else {
      assert_int_equal(status, BW_GEOMETRY);
      assert_true(strstr(bw_message(context), "not closed") ||
                  strstr(bw_message(context), "encloses nothing"));
    }
    bw_release(surface);
  }
}

static void failing_memory(void **state) {
  bw_context *context = check_context(state);
  bw_surface *box;
  bw_grid *grid = NULL;
  int32_t count;
  check_ok(context, bw_surface_box_shape(context, zero, one, &box));
  for (int32_t t = 0; t < 4; t++) { /* some facets turned, so that it must be oriented */
    int32_t keep = box->triangle[3 * t];
    box->triangle[3 * t] = box->triangle[3 * t + 1];
    box->triangle[3 * t + 1] = keep;
  }
  check_ok(context, bw_grid_of_surface(context, box, NULL, &grid)); /* the threads come to life */
  bw_release(grid);
  grid = NULL;
  check_each_allocation(context, status, 20) {
    status = bw_grid_of_surface(context, box, NULL, &grid);
    if (status == BW_OK)
      status = bw_grid_components(context, grid, NULL, &count);
    if (grid)
      bw_release(grid);
    grid = NULL;
  }
  bw_release(box);
}

static void components(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid;
  /* two cells that share a corner, one apart, two that share a face */
  int32_t material[32] = {0}, group[5], count;
  material[0] = material[1 + 4 + 8] = 1; /* of 4 x 2 x 4 cells: (0,0,0), (1,1,1) */
  material[3] = 1;
  material[24] = material[28] = 2;
  check_ok(context,
           bw_grid_create(context, zero, one, (int32_t[3]){4, 2, 4}, material, NULL, &grid));
  check_ok(context, bw_grid_components(context, grid, group, &count));
  assert_int_equal(count, 3);
  const int32_t expected[5] = {0, 1, 0, 2, 2};
  assert_memory_equal(group, expected, sizeof group);
  bw_release(grid);
}

check_main(check_test(boxes), check_test(aligned_box), check_test(spheres), check_test(shells),
           check_test(refusals), check_test(threads_do_not_matter), check_test(components),
           check_test(good_models), check_test(bad_models), check_test(failing_memory))
