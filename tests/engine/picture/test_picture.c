/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "check.h"
#include "picture/internal.h"

#include <unistd.h>

#define PI 3.14159265358979323846

/* A sphere of radius 1: an octahedron whose facets are cut into n x n and pushed out. */
static bw_surface *sphere(bw_context *context, int n) {
  double *point = malloc(sizeof *point * 3 * 3 * 8 * (size_t)(n * n));
  int32_t *triangle = malloc(sizeof *triangle * 3 * 8 * (size_t)(n * n));
  int32_t count = 0;
  for (int octant = 0; octant < 8; octant++) {
    double s[3] = {octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1};
    bool flip = s[0] * s[1] * s[2] < 0;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n - i; j++)
        for (int half = 0; half < (j < n - i - 1 ? 2 : 1); half++) {
          int at[3][2] = {{i, j}, {i + 1, j}, {i, j + 1}};
          if (half) {
            int other[3][2] = {{i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
            memcpy(at, other, sizeof at);
          }
          for (int c = 0; c < 3; c++) {
            int corner = flip ? 2 - c : c;
            double x[3] = {at[corner][0], at[corner][1], n - at[corner][0] - at[corner][1]};
            double size = bw_norm(x);
            for (int k = 0; k < 3; k++)
              point[3 * (3 * count + c) + k] = s[k] * x[k] / size;
            triangle[3 * count + c] = 3 * count + c;
          }
          count++;
        }
  }
  bw_surface *loose = NULL, *welded = NULL;
  check_ok(context, bw_surface_copy(context, 3 * count, point, count, triangle, NULL, &loose));
  check_ok(context, bw_surface_weld(context, loose, 0, &welded));
  assert_int_equal(welded->point_count, 4 * n * n + 2);
  check_near(bw_surface_volume(welded), 4 * PI / 3, 8.0 / (n * n));
  bw_release(loose);
  free(point);
  free(triangle);
  return welded;
}

static char *path_of(const char *name) {
  static char path[2][200];
  static int turn = 0;
  turn = 1 - turn;
  snprintf(path[turn], sizeof path[turn], "/tmp/barwright-test-%d-%s.png", (int)getpid(), name);
  return path[turn];
}

/* Renders a surface by itself, seen along -z, 1 m = `scale` pixels, origin in the middle. */
static bwi_image render(bw_context *context, const bw_surface *surface, const double *value,
                        int width, int height, double scale) {
  bwi_view view = {.axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   .scale = scale,
                   .middle = {width / 2., height / 2.}};
  bwi_solid solid = {.point_count = surface->point_count,
                     .triangle_count = surface->triangle_count,
                     .value = value,
                     .high = 1};
  bwi_image image = {.width = width, .height = height};
  size_t points = 3 * sizeof(double) * (size_t)surface->point_count;
  size_t corners = 3 * sizeof(int32_t) * (size_t)surface->triangle_count;
  solid.point = bw_alloc(context, 1, points);
  solid.triangle = bw_alloc(context, 1, corners);
  memcpy(solid.point, surface->point, points);
  memcpy(solid.triangle, surface->triangle, corners);
  check_ok(context, bwi_solid_prepare(context, &solid, &view, 0.7, 0));
  check_ok(context, bwi_render(context, 1, &solid, &image));
  bwi_solid_clear(&solid);
  return image;
}

static void silhouette_of_a_sphere_is_a_disc(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 32);
  bwi_image image = render(context, surface, NULL, 400, 300, 100);
  double area = 0;
  for (int i = 0; i < 400 * 300; i++)
    area += image.colour[4 * i + 3] / 255.;
  check_near(area, PI * 100 * 100, 2e-3 * PI * 100 * 100);
  /* depth in the middle: the pole */
  check_near(image.depth[150 * 400 + 200], 100, 0.2);
  check_near(image.normal[3 * (150 * 400 + 200) + 2], 1, 1e-3);
  /* and on the way to the rim: the sphere's own normal, smoothly */
  check_near(image.normal[3 * (150 * 400 + 260)], 0.605, 0.01);
  bwi_image_clear(&image);
  bw_release(surface);
}

static void symmetric_view_gives_a_symmetric_image(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 7);
  bwi_image image = render(context, surface, NULL, 200, 160, 70);
  for (int y = 0; y < 160; y++)
    for (int x = 0; x < 200; x++) {
      int at = image.colour[4 * (y * 200 + x) + 3];
      check_near(image.colour[4 * (y * 200 + 199 - x) + 3], at, 0);
      check_near(image.colour[4 * ((159 - y) * 200 + x) + 3], at, 0);
      if (at == 255)
        check_near(image.depth[y * 200 + 199 - x], image.depth[y * 200 + x], 1e-3);
    }
  bwi_image_clear(&image);
  bw_release(surface);
}

static void no_gaps_between_facets_and_the_nearer_wins(void **state) {
  bw_context *context = check_context(state);
  enum { N = 23 };
  double point[2 * 3 * (N + 1) * (N + 1)];
  int32_t triangle[2 * 3 * 2 * N * N];
  bw_random random;
  bw_random_seed(&random, 3);
  for (int layer = 0; layer < 2; layer++) /* the far layer is listed last and carries 1 */
    for (int i = 0; i <= N; i++)
      for (int j = 0; j <= N; j++) {
        double *p = point + 3 * (layer * (N + 1) * (N + 1) + i * (N + 1) + j);
        bool rim = i == 0 || j == 0 || i == N || j == N;
        p[0] = (i + (rim ? 0 : 0.6 * bw_random_uniform(&random) - 0.3)) / N;
        p[1] = (j + (rim ? 0 : 0.6 * bw_random_uniform(&random) - 0.3)) / N;
        p[2] = layer ? -0.1 : 0;
      }
  int32_t *t = triangle;
  for (int layer = 0; layer < 2; layer++)
    for (int i = 0; i < N; i++)
      for (int j = 0; j < N; j++) {
        int32_t a = layer * (N + 1) * (N + 1) + i * (N + 1) + j, b = a + N + 1;
        int32_t both[6] = {a, b, b + 1, a, b + 1, a + 1};
        memcpy(t, both, sizeof both);
        t += 6;
      }
  double value[2 * (N + 1) * (N + 1)];
  for (int i = 0; i < 2 * (N + 1) * (N + 1); i++)
    value[i] = i >= (N + 1) * (N + 1);
  bw_surface *surface = NULL;
  check_ok(context, bw_surface_copy(context, 2 * (N + 1) * (N + 1), point, 4 * N * N, triangle,
                                    NULL, &surface));
  bwi_image image = render(context, surface, value, 220, 220, 100);
  unsigned char low[3];
  bw_colour(0, low);
  for (int y = 11; y < 109; y++)
    for (int x = 111; x < 209; x++) {
      const unsigned char *c = image.colour + 4 * (y * 220 + x);
      assert_int_equal(c[3], 255);
      assert_true(c[2] > c[0]); /* blue in front, not the dark red behind */
    }
  bwi_image_clear(&image);
  bw_release(surface);
}

static cairo_surface_t *read_png(const char *path) {
  cairo_surface_t *image = cairo_image_surface_create_from_png(path);
  assert_int_equal(cairo_surface_status(image), CAIRO_STATUS_SUCCESS);
  cairo_surface_flush(image);
  return image;
}

static void pixel_of(cairo_surface_t *image, int x, int y, int rgb[3]) {
  const unsigned char *data = cairo_image_surface_get_data(image);
  uint32_t v;
  memcpy(&v, data + y * cairo_image_surface_get_stride(image) + 4 * x, 4);
  for (int k = 0; k < 3; k++)
    rgb[k] = v >> (16 - 8 * k) & 255;
}

static void picture_is_a_png_with_bar_and_grey_for_missing(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 12);
  double *value = malloc(sizeof *value * (size_t)surface->point_count);
  for (int32_t i = 0; i < surface->point_count; i++) /* the right half, seen from -y, has none */
    value[i] = surface->point[3 * i] > 0.3 ? NAN : 1e6 * (surface->point[3 * i + 2] + 2);
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.direction[0] = options.direction[2] = 0;
  options.direction[1] = -1;
  options.unit = "stress, MPa";
  options.scale = 1e-6;
  options.title = "A sphere \xFF\xC3 with broken bytes";
  char *path = path_of("bar");
  check_ok(context, bw_picture_surface(context, surface, value, false, &options, path));
  cairo_surface_t *image = read_png(path);
  assert_int_equal(cairo_image_surface_get_width(image), 1200);
  assert_int_equal(cairo_image_surface_get_height(image), 900);
  int rgb[3];
  unsigned char low[3], high[3];
  bw_colour(0, low);
  bw_colour(1, high);
  pixel_of(image, 1083, 718, rgb); /* the bar runs from 0.24 to 0.80 of the height */
  for (int k = 0; k < 3; k++)
    check_near(rgb[k], low[k], 4);
  pixel_of(image, 1083, 218, rgb);
  for (int k = 0; k < 3; k++)
    check_near(rgb[k], high[k], 4);
  pixel_of(image, 700, 450, rgb); /* on the right half */
  check_near(rgb[0], rgb[1], 2);
  check_near(rgb[1], rgb[2], 2);
  assert_true(rgb[0] < 200);
  pixel_of(image, 400, 450, rgb); /* on the left half: the middle of the colours */
  assert_true(rgb[0] > rgb[2] + 50);
  pixel_of(image, 2, 2, rgb);
  assert_true(rgb[0] > 250 && rgb[1] > 250 && rgb[2] > 250);
  cairo_surface_destroy(image);
  unlink(path);
  free(value);
  bw_release(surface);
}

static int count_different(const char *a, const char *b) {
  cairo_surface_t *p = read_png(a), *q = read_png(b);
  int count = 0, w = cairo_image_surface_get_width(p), h = cairo_image_surface_get_height(p);
  for (int y = 0; y < h; y++)
    for (int x = 0; x < w; x++) {
      int u[3], v[3];
      pixel_of(p, x, y, u);
      pixel_of(q, x, y, v);
      count += abs(u[0] - v[0]) + abs(u[1] - v[1]) + abs(u[2] - v[2]) > 60;
    }
  cairo_surface_destroy(p);
  cairo_surface_destroy(q);
  return count;
}

static void same_bytes_again_and_for_any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 20);
  double *value = malloc(sizeof *value * (size_t)surface->triangle_count);
  for (int32_t i = 0; i < surface->triangle_count; i++)
    value[i] = sin(i * 0.1);
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.width = 400;
  options.height = 300;
  options.edges = true;
  char digest[3][65], *path = path_of("same");
  for (int i = 0; i < 3; i++) {
    check_ok(context, bw_set_threads(context, i == 0 ? 1 : i + 1));
    check_ok(context, bw_picture_surface(context, surface, value, true, &options, path));
    check_ok(context, bw_sha256_file(context, path, digest[i]));
  }
  assert_string_equal(digest[0], digest[1]);
  assert_string_equal(digest[0], digest[2]);
  unlink(path);
  free(value);
  bw_release(surface);
}

static void arrows_ghost_and_deformation_show(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 10);
  double *u = calloc(3 * (size_t)surface->point_count, sizeof *u);
  for (int32_t i = 0; i < surface->point_count; i++)
    u[3 * i] = 0.01 * (1 + surface->point[3 * i + 2]);
  bw_arrow arrow[2] = {{{0, 0, 1}, {0, 0, -5}, 1}, {{0, 0, -1}, {0, 0, 0}, 1}};
  bw_picture_options options;
  bw_picture_options_default(&options);
  char plain[200], changed[200];
  snprintf(plain, sizeof plain, "%s", path_of("plain"));
  snprintf(changed, sizeof changed, "%s", path_of("changed"));
  options.arrow = arrow; /* the same frame: an arrow from above is there both times */
  options.arrow_count = 1;
  options.zoom = 0.6;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, plain));
  arrow[0].force[2] = 5; /* pulls: stands on the body just the same, tip up */
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, changed));
  int heads = count_different(plain, changed);
  assert_true(heads > 100 && heads < 6000);
  arrow[0].force[2] = -5;
  options.displacement = u;
  options.ghost = true;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, changed));
  assert_true(count_different(plain, changed) > 1000);
  /* with another factor the label alone could not make so many pixels different */
  options.ghost = false;
  options.deformation = 1e-9;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, changed));
  assert_true(count_different(plain, changed) < 1500);
  unlink(plain);
  unlink(changed);
  free(u);
  bw_release(surface);
}

/* A line is seen in its colour in front of the body, hidden behind it, and moves with it. */
static void lines_show_and_are_hidden(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 16);
  double *u = calloc(3 * (size_t)surface->point_count, sizeof *u),
         point[2][6] = {{-0.3, -1.05, 0, 0.3, -1.05, 0}, {0, 0, -0.5, 0, 0, 0.5}};
  bw_picture_line line = {2, point[0]};
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.direction[1] = -1;
  options.zoom = 0.7;
  char plain[200], changed[200];
  snprintf(plain, sizeof plain, "%s", path_of("plain"));
  snprintf(changed, sizeof changed, "%s", path_of("changed"));
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, plain));
  options.line = &line;
  options.line_count = 1;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, changed));
  int seen = count_different(plain, changed);
  assert_true(seen > 300 && seen < 6000);
  options.line_name = "an edge"; /* the legend */
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, plain));
  int key = count_different(plain, changed);
  assert_true(key > 100 && key < 3000);
  line.point = point[1]; /* inside of the body */
  options.line_name = NULL;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, changed));
  options.line_count = 0;
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, plain));
  assert_int_equal(count_different(plain, changed), 0);
  /* the deformed body takes it along */
  bwi_solid body = {.point_count = surface->point_count, .point = u}, solid;
  for (int32_t i = 0; i < 3 * surface->point_count; i++)
    u[i] = surface->point[i] + (i % 3 == 2 ? 0.25 : 0);
  line.point = point[0];
  check_ok(context, bwi_lines_solid(context, 1, &line, 0.01, &body, surface->point, &solid));
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int32_t i = 0; i < solid.point_count; i++) {
    low = fmin(low, solid.point[3 * i + 2]);
    high = fmax(high, solid.point[3 * i + 2]);
  }
  check_near(0.5 * (low + high), 0.25, 1e-12);
  bwi_solid_clear(&solid);
  point[0][4] = NAN;
  check_fails(context, BW_INVALID, "point 2 of line 1 is not finite",
              bwi_lines_solid(context, 1, &line, 0.01, &body, surface->point, &solid));
  unlink(plain);
  unlink(changed);
  free(u);
  bw_release(surface);
}

/* A resultant below the surface: its arrow ends on the surface all the same. */
static void arrows_end_on_the_surface(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 16);
  bwi_solid body = {.point_count = surface->point_count,
                    .triangle_count = surface->triangle_count,
                    .point = surface->point,
                    .triangle = surface->triangle};
  bw_arrow arrow[3] = {{{0.02, 0.01, 0.6}, {0, 0, -1}, 1},
                       {{0.6, 0.02, 0.01}, {2, 0, 0}, 1},
                       {{0.01, 1.2, 0.02}, {0, -2, 0}, 1}};
  double end[9];
  bwi_solid solid;
  check_ok(context, bwi_arrows_solid(context, 3, arrow, 0.5, &body, surface->point, &solid, end));
  check_near(end[2], 1 + 0.25, 0.01);   /* pushes, half as long: tip at z = 1 */
  check_near(end[3], 1 + 0.5, 0.01);    /* pulls: tail at x = 1 */
  check_near(end[7], 1.2 + 0.5, 1e-12); /* outside: stays */
  bwi_solid_clear(&solid);
  bw_release(surface);
}

static void unusable_requests_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 2), *empty = NULL;
  bw_picture_options options;
  bw_picture_options_default(&options);
  check_ok(context, bw_surface_copy(context, 0, NULL, 0, NULL, NULL, &empty));
  check_fails(context, BW_EMPTY, "without facets",
              bw_picture_surface(context, empty, NULL, false, &options, "x.png"));
  options.width = 10;
  check_fails(context, BW_INVALID, "10 x 900 pixels",
              bw_picture_surface(context, surface, NULL, false, &options, "x.png"));
  bw_picture_options_default(&options);
  options.direction[0] = NAN;
  check_fails(context, BW_INVALID, "a finite vector that is not 0",
              bw_picture_surface(context, surface, NULL, false, &options, "x.png"));
  bw_picture_options_default(&options);
  options.min = 2;
  options.max = 1;
  check_fails(context, BW_INVALID, "not ascending",
              bw_picture_surface(context, surface, NULL, false, &options, "x.png"));
  bw_picture_options_default(&options);
  double *u = calloc(3 * (size_t)surface->point_count, sizeof *u);
  u[3] = INFINITY;
  options.displacement = u;
  check_fails(context, BW_INVALID, "displacement of point 2 is not finite",
              bw_picture_surface(context, surface, NULL, false, &options, "x.png"));
  bw_picture_options_default(&options);
  options.width = options.height = 64;
  bw_status status =
      bw_picture_surface(context, surface, NULL, false, &options, "/nonexistent-folder/x.png");
  assert_int_equal(status, BW_IO);
  free(u);
  bw_release(empty);
  bw_release(surface);
}

/* All the values the same, none at all, and extreme ones: a picture all the same. */
static void odd_values_are_drawn(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 3);
  double *value = malloc(sizeof *value * (size_t)surface->point_count);
  static const double odd[][2] = {{5, 5},          {0, 0},           {NAN, NAN}, {INFINITY, 1},
                                  {1e308, -1e308}, {1e-310, 2e-310}, {-3, NAN}};
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.width = 320;
  options.height = 240;
  char *path = path_of("odd");
  for (size_t o = 0; o < sizeof odd / sizeof *odd; o++) {
    for (int32_t i = 0; i < surface->point_count; i++)
      value[i] = odd[o][i % 2];
    check_ok(context, bw_picture_surface(context, surface, value, false, &options, path));
    cairo_surface_destroy(read_png(path));
  }
  unlink(path);
  free(value);
  bw_release(surface);
}

static void inward_surfaces_are_lit_from_outside(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 12), *inward = NULL;
  int32_t *triangle = malloc(sizeof *triangle * 3 * (size_t)surface->triangle_count);
  for (int32_t i = 0; i < 3 * surface->triangle_count; i++)
    triangle[i] = surface->triangle[i / 3 * 3 + 2 - i % 3];
  check_ok(context, bw_surface_copy(context, surface->point_count, surface->point,
                                    surface->triangle_count, triangle, NULL, &inward));
  bw_picture_options options;
  bw_picture_options_default(&options);
  char out[200], in[200];
  snprintf(out, sizeof out, "%s", path_of("outward"));
  snprintf(in, sizeof in, "%s", path_of("inward"));
  check_ok(context, bw_picture_surface(context, surface, NULL, false, &options, out));
  check_ok(context, bw_picture_surface(context, inward, NULL, false, &options, in));
  assert_int_equal(count_different(out, in), 0);
  unlink(out);
  unlink(in);
  free(triangle);
  bw_release(inward);
  bw_release(surface);
}

static void bodies_of_any_size_are_drawn_or_refused(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 2);
  static const double factor[] = {1e-300, 1e-170, 1e-20, 1e20, 1e140, 1e160, 1e300, 0};
  double *u = calloc(3 * (size_t)surface->point_count, sizeof *u);
  bw_arrow arrow = {{0, 0, 1}, {0, 0, -5}, 1};
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.width = options.height = 100;
  options.arrow = &arrow;
  options.arrow_count = 1;
  options.displacement = u;
  char *path = path_of("size");
  for (size_t i = 0; i < sizeof factor / sizeof *factor; i++) {
    bw_surface *scaled = NULL;
    double *point = malloc(sizeof *point * 3 * (size_t)surface->point_count);
    for (int32_t k = 0; k < 3 * surface->point_count; k++)
      point[k] = factor[i] * surface->point[k];
    u[0] = arrow.at[2] = factor[i];
    check_ok(context, bw_surface_copy(context, surface->point_count, point, surface->triangle_count,
                                      surface->triangle, NULL, &scaled));
    bw_status status = bw_picture_surface(context, scaled, point, false, &options, path);
    assert_int_equal(status, factor[i] > 1e150 ? BW_GEOMETRY : BW_OK);
    free(point);
    bw_release(scaled);
  }
  options.deformation = 1e308;
  u[0] = 1e10;
  check_fails(context, BW_INVALID, "too large for a picture",
              bw_picture_surface(context, surface, NULL, false, &options, path));
  unlink(path);
  free(u);
  bw_release(surface);
}

/* The largest value sits on one side of a sphere after another: the chosen view always shows it as
 * a dark red place. */
static void chosen_view_shows_the_largest_value(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 12);
  static const double side[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                    {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  double *value = malloc(sizeof *value * (size_t)surface->point_count);
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.width = 320;
  options.height = 240;
  char *path = path_of("chosen");
  for (int i = 0; i < 12; i++) {
    int red = 0, rgb[3];
    memset(options.up, 0, sizeof options.up);
    options.up[i < 6 ? 2 : 1] = 1;
    for (int32_t k = 0; k < surface->point_count; k++)
      value[k] = exp(6 * bw_dot(surface->point + 3 * k, side[i % 6]));
    check_ok(context, bw_picture_surface(context, surface, value, false, &options, path));
    cairo_surface_t *image = read_png(path);
    for (int y = 30; y < 230; y++)
      for (int x = 10; x < 230; x++) {
        pixel_of(image, x, y, rgb);
        red += rgb[0] > 90 && rgb[0] > 2 * rgb[1] && rgb[0] > 2 * rgb[2];
      }
    cairo_surface_destroy(image);
    assert_true(red > 200);
  }
  unlink(path);
  free(value);
  bw_release(surface);
}

static void cancelled_pictures_leave_no_file(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 4);
  char *path = path_of("cancelled");
  bw_cancel(context);
  assert_int_equal(bw_picture_surface(context, surface, NULL, false, NULL, path), BW_CANCELLED);
  assert_int_not_equal(access(path, F_OK), 0);
  bw_clear_cancel(context);
  bw_release(surface);
}

static void ticks_are_round(void **state) {
  (void)state;
  double tick[BWI_TICKS];
  int decimals;
  char text[64];
  assert_int_equal(bwi_ticks(0.03, 5.83, 6, tick, &decimals), 5);
  check_near(tick[0], 1, 1e-15);
  check_near(tick[4], 5, 1e-15);
  assert_int_equal(decimals, 0);
  assert_int_equal(bwi_ticks(-0.11, 0.12, 6, tick, &decimals), 5);
  check_near(tick[2], 0, 0);
  assert_int_equal(decimals, 2);
  assert_int_equal(bwi_ticks(1, 1, 6, tick, &decimals), 0);
  /* A uniform field after rounding: the ticks would be too many to count in doubles. */
  assert_int_equal(bwi_ticks(1, 1 + 0x1p-52, 6, tick, &decimals), 0);
  assert_int_equal(bwi_ticks(-3e7, -3e7 + 0x1p-27, 6, tick, &decimals), 0);
  assert_int_equal(bwi_ticks(0, 1, 5, tick, &decimals), 5); /* 0 0.25 .. 1 */
  assert_int_equal(decimals, 2);
  bwi_fixed(text, sizeof text, -0.125, 2);
  assert_string_equal(text, "\xE2\x88\x92"
                            "0.13");
  bwi_fixed(text, sizeof text, -0.001, 2);
  assert_string_equal(text, "0.00");
  bwi_fixed(text, sizeof text, 1234.5, 0);
  assert_string_equal(text, "1235");
}

/* Lightness in OKLab falls all the way, and equal steps look equally different. */
static void colours_are_even(void **state) {
  (void)state;
  double lab[65][3], min = HUGE_VAL, max = 0;
  for (int i = 0; i <= 64; i++) {
    unsigned char rgb[3];
    double c[3];
    bw_colour(i / 64., rgb);
    for (int k = 0; k < 3; k++)
      c[k] = rgb[k] / 255. <= 0.04045 ? rgb[k] / 255. / 12.92
                                      : pow((rgb[k] / 255. + 0.055) / 1.055, 2.4);
    double l = cbrt(0.4122214708 * c[0] + 0.5363325363 * c[1] + 0.0514459929 * c[2]);
    double m = cbrt(0.2119034982 * c[0] + 0.6806995451 * c[1] + 0.1073969566 * c[2]);
    double s = cbrt(0.0883024619 * c[0] + 0.2817188376 * c[1] + 0.6299787005 * c[2]);
    lab[i][0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[i][1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[i][2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
  }
  for (int i = 2; i <= 64; i += 2) {
    double d[3] = {lab[i][0] - lab[i - 2][0], lab[i][1] - lab[i - 2][1], lab[i][2] - lab[i - 2][2]};
    assert_true(d[0] < 0.002);
    min = fmin(min, bw_norm(d));
    max = fmax(max, bw_norm(d));
  }
  assert_true(max < 1.25 * min);
  unsigned char rgb[3];
  bw_colour(NAN, rgb);
  assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
}

static void text_is_cleaned(void **state) {
  bw_context *context = check_context(state);
  static const char *const pair[][2] = {
      {"plain", "plain"},         {"5.8 \xC2\xB5m", "5.8 \xC2\xB5m"},      {"a\xFFz", "a?z"},
      {"cut \xE2\x82", "cut ??"}, {"line\nbreak", "line break"},           {"\xC0\xAF", "??"},
      {"\xED\xA0\x80", "???"},    {"\xF0\x9F\x98\x80", "\xF0\x9F\x98\x80"}};
  for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
    char *clean = bwi_clean_text(context, pair[i][0]);
    assert_string_equal(clean, pair[i][1]);
    bw_free(clean);
  }
}

static void failing_allocations_leave_nothing_behind(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface = sphere(context, 2);
  double *value = calloc((size_t)surface->point_count, sizeof *value);
  double *u = calloc(3 * (size_t)surface->point_count, sizeof *u);
  bw_arrow arrow = {{0, 0, 1}, {0, 0, -5}, 1};
  bw_picture_options options;
  bw_picture_options_default(&options);
  options.width = 80;
  options.height = 64;
  options.arrow = &arrow;
  options.arrow_count = 1;
  double ends[6] = {-1, -1, 0, 1, -1, 0};
  bw_picture_line line = {2, ends};
  options.line = &line;
  options.line_count = 1;
  options.displacement = u;
  options.ghost = true;
  options.title = options.unit = options.line_name = "x";
  u[0] = value[0] = 1;
  char *path = path_of("memory");
  /* once before: the context keeps its threads */
  check_ok(context, bw_picture_surface(context, surface, value, false, &options, path));
  unlink(path);
  check_each_allocation(context, status, 1) {
    status = bw_picture_surface(context, surface, value, false, &options, path);
    if (status != BW_OK)
      assert_int_not_equal(access(path, F_OK), 0);
  }
  unlink(path);
  free(value);
  free(u);
  bw_release(surface);
}

check_main(check_test(silhouette_of_a_sphere_is_a_disc),
           check_test(symmetric_view_gives_a_symmetric_image),
           check_test(no_gaps_between_facets_and_the_nearer_wins),
           check_test(picture_is_a_png_with_bar_and_grey_for_missing),
           check_test(same_bytes_again_and_for_any_number_of_threads),
           check_test(arrows_ghost_and_deformation_show), check_test(lines_show_and_are_hidden),
           check_test(arrows_end_on_the_surface), check_test(unusable_requests_are_refused),
           check_test(odd_values_are_drawn), check_test(inward_surfaces_are_lit_from_outside),
           check_test(bodies_of_any_size_are_drawn_or_refused),
           check_test(chosen_view_shows_the_largest_value),
           check_test(cancelled_pictures_leave_no_file), check_test(ticks_are_round),
           check_test(colours_are_even), check_test(text_is_cleaned),
           check_test(failing_allocations_leave_nothing_behind))
