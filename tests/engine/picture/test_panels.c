/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Pictures of grids: lines of elements without their diagonals, colours of materials, one scale for
 * all panels; animations chunk by chunk. */
#include "check.h"
#include "picture/internal.h"

#include <unistd.h>
#include <zlib.h>

static const char *path_of(const char *name) {
  static char path[4][200];
  static int turn = 0;
  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "/tmp/barwright-panels-%d-%s.png", (int)getpid(), name);
  return path[turn];
}

static bw_grid *bar(bw_context *context, const int32_t cells[3]) {
  bw_grid *grid;
  int32_t material[64];
  for (int c = 0; c < 64; c++)
    material[c] = 1 + c % 2;
  check_ok(context, bw_grid_create(context, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, cells,
                                   material, NULL, &grid));
  return grid;
}

static const uint32_t *pixels(cairo_surface_t *canvas, int y) {
  return (const uint32_t *)(const void *)(cairo_image_surface_get_data(canvas) +
                                          (ptrdiff_t)y * cairo_image_surface_get_stride(canvas));
}

static int brightness(uint32_t pixel) {
  return (int)((pixel & 255) + (pixel >> 8 & 255) + (pixel >> 16 & 255));
}

/* From above, a row through the middle of 3 x 3 cells: dark where it crosses the two lines between
 * cells, nowhere else; with diagonals there would be three more. */
static void lines_without_diagonals(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = bar(context, (int32_t[3]){3, 3, 1});
  bw_grid_picture_options options;
  bw_grid_picture_options_default(&options);
  options.direction[2] = 1;
  options.up[1] = 1;
  options.up[2] = 0;
  const char *path = path_of("lines");
  bw_grid_panel panel = {.grid = grid, .value = (double[9]){0}, .on_elements = true};
  for (int edges = 0; edges < 2; edges++) {
    options.edges = edges;
    check_ok(context, bw_picture_grids(context, 1, &panel, &options, path));
    cairo_surface_t *canvas = cairo_image_surface_create_from_png(path);
    int width = cairo_image_surface_get_width(canvas), crossings = 0;
    assert_int_equal(width, 640 + 170);
    assert_int_equal(cairo_image_surface_get_height(canvas), 560);
    /* the body fills 44 to 536; a quarter into the middle cells, off their middle */
    const uint32_t *row = pixels(canvas, 44 + 492 / 2 + 30);
    int face = brightness(row[320]);
    for (int x = 90; x < 550; x++)
      crossings += brightness(row[x]) < face - 60 && brightness(row[x - 1]) >= face - 60;
    assert_int_equal(crossings, edges ? 2 : 0);
    cairo_surface_destroy(canvas);
  }
  unlink(path);
  bw_release(grid);
}

/* The same body in two panels looks the same, and a larger one beside it makes both smaller. */
static void one_scale_for_all(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = bar(context, (int32_t[3]){4, 2, 2}),
          *larger = bar(context, (int32_t[3]){8, 2, 2});
  bw_grid_panel panel[3] = {{.grid = grid, .title = "a"}, {.grid = grid, .title = "a"}};
  const char *path = path_of("scale"), *again = path_of("again");
  bw_grid_picture_options options;
  bw_grid_picture_options_default(&options);
  options.title = "two";
  int covered[2];
  for (int i = 0; i < 2; i++) {
    panel[2].grid = larger;
    check_ok(context, bw_picture_grids(context, 2 + i, panel, &options, path));
    cairo_surface_t *canvas = cairo_image_surface_create_from_png(path);
    covered[i] = 0;
    for (int y = 48 + 40; y < 48 + 460; y++) /* above the axes */
      for (int x = 20; x < 620; x++) {
        const uint32_t *row = pixels(canvas, y);
        assert_int_equal(row[x], row[x + 640]);
        covered[i] += brightness(row[x]) < 650;
      }
    cairo_surface_destroy(canvas);
  }
  assert_true(covered[1] < 0.4 * covered[0]);
  /* any number of threads, the same bytes */
  char digest[2][65];
  check_ok(context, bw_set_threads(context, 3));
  check_ok(context, bw_picture_grids(context, 3, panel, &options, again));
  check_ok(context, bw_sha256_file(context, path, digest[0]));
  check_ok(context, bw_sha256_file(context, again, digest[1]));
  assert_string_equal(digest[0], digest[1]);
  unlink(path);
  unlink(again);
  bw_release(grid);
  bw_release(larger);
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = bar(context, (int32_t[3]){2, 1, 1});
  double u[36] = {0};
  bw_grid_panel panel = {.grid = grid, .displacement = u};
  bw_grid_picture_options options;
  const char *path = path_of("refused");
  bw_grid_picture_options_default(&options);
  options.width = options.height = 100;
  options.ghost = true;
  u[4] = NAN;
  check_fails(context, BW_INVALID, "displacement of node 2 along y is nan",
              bw_picture_grids(context, 1, &panel, &options, path));
  u[4] = 0;
  check_fails(context, BW_INVALID, "0 panels", bw_picture_grids(context, 0, &panel, NULL, path));
  options.columns = -1;
  check_fails(context, BW_INVALID, "-1 panels in a row",
              bw_picture_grids(context, 1, &panel, &options, path));
  options.columns = 0;
  options.width = 20000;
  check_fails(context, BW_INVALID, "20000 x 100 pixels",
              bw_picture_grids(context, 1, &panel, &options, path));
  options.width = 100;
  bw_surface *box;
  bw_embedding *embedding;
  double value[2] = {1, 2};
  check_ok(context,
           bw_surface_box_shape(context, (double[3]){0, 0, 0}, (double[3]){2, 1, 1}, &box));
  check_ok(context,
           bw_embedding_create(context, grid, box->point_count, box->point, 0, &embedding));
  bw_grid_panel both[2] = {panel, panel};
  both[1].surface = box;
  check_fails(context, BW_INVALID, "panel 2: its surface needs an embedding",
              bw_picture_grids(context, 2, both, &options, path));
  both[1].embedding = embedding;
  both[1].value = value;
  both[1].on_elements = true;
  check_ok(context, bw_picture_grids(context, 2, both, &options, path));
  check_each_allocation(context, status, 15) {
    status = bw_picture_grids(context, 2, both, &options, path);
  }
  bw_release(box);
  bw_release(embedding);
  unlink(path);
  bw_release(grid);
}

static uint32_t word(const unsigned char *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* Rows of a PNG, or of one picture of an animation: its IDAT or fdAT chunks, inflated. Checks every
 * chunk's CRC and the numbers of the sequence. */
static unsigned char *rows_of(const char *path, int picture, uLongf *size, int *pictures) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  unsigned char *bytes = (unsigned char *)malloc(1 << 22),
                *packed = (unsigned char *)malloc(1 << 22);
  size_t count = fread(bytes, 1, 1 << 22, file), all = 0;
  int at = -1;
  uint32_t sequence = 0;
  fclose(file);
  *pictures = 1;
  for (size_t i = 8; i < count;) {
    uint32_t length = word(bytes + i);
    const unsigned char *type = bytes + i + 4, *data = type + 4;
    assert_int_equal(word(data + length), crc32(0, type, length + 4));
    if (memcmp(type, "acTL", 4) == 0)
      *pictures = (int)word(data);
    bool numbered = memcmp(type, "fcTL", 4) == 0 || memcmp(type, "fdAT", 4) == 0;
    if (numbered)
      assert_int_equal(word(data), sequence++);
    at += memcmp(type, "fcTL", 4) == 0;
    int here = at < 0 ? 0 : at;
    if (here == picture && memcmp(type, "IDAT", 4) == 0) {
      memcpy(packed + all, data, length);
      all += length;
    }
    if (here == picture && memcmp(type, "fdAT", 4) == 0) {
      memcpy(packed + all, data + 4, length - 4);
      all += length - 4;
    }
    i += 12 + length;
  }
  unsigned char *rows = (unsigned char *)malloc(1 << 22);
  *size = 1 << 22;
  assert_int_equal(uncompress(rows, size, packed, all), Z_OK);
  free(bytes);
  free(packed);
  return rows;
}

static void animations(void **state) {
  bw_context *context = check_context(state);
  bw_grid *grid = bar(context, (int32_t[3]){2, 1, 1});
  bw_grid_panel panel = {.grid = grid};
  bw_grid_picture_options options;
  const char *png[3], *path = path_of("animation");
  char kept[3][200];
  bw_grid_picture_options_default(&options);
  options.width = 90;
  options.height = 80;
  for (int i = 0; i < 3; i++) {
    snprintf(kept[i], sizeof kept[i], "%s.%d.png", path, i);
    png[i] = kept[i];
    options.zoom = 1 + 0.2 * i;
    check_ok(context, bw_picture_grids(context, 1, &panel, &options, png[i]));
  }
  check_ok(context, bw_animation_write(context, 3, png, 0.04, 0, path));
  for (int i = 0; i < 3; i++) {
    int pictures;
    uLongf size[2];
    unsigned char *a = rows_of(path, i, &size[0], &pictures), *b;
    assert_int_equal(pictures, 3);
    b = rows_of(png[i], 0, &size[1], &pictures);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(a, b, size[0]);
    free(a);
    free(b);
  }
  /* programs that know no animation show the first picture */
  cairo_surface_t *first = cairo_image_surface_create_from_png(path);
  assert_int_equal(cairo_image_surface_get_width(first), 90);
  cairo_surface_destroy(first);
  options.width = 100;
  check_ok(context, bw_picture_grids(context, 1, &panel, &options, png[2]));
  check_fails(context, BW_INVALID, "100 x 98 pixels; the first picture has 90 x 98",
              bw_animation_write(context, 3, png, 0.04, 0, path));
  FILE *file = fopen(png[2], "wb");
  fputs("no picture", file);
  fclose(file);
  check_fails(context, BW_FORMAT, "no PNG file",
              bw_animation_write(context, 3, png, 0.04, 0, path));
  check_fails(context, BW_INVALID, "pictures of 0 s",
              bw_animation_write(context, 2, png, 0, 0, path));
  check_fails(context, BW_INVALID, "animation of 0 pictures",
              bw_animation_write(context, 0, png, 1, 0, path));
  check_each_allocation(context, status, 1) {
    status = bw_animation_write(context, 2, png, 0.04, 0, path);
  }
  for (int i = 0; i < 3; i++)
    unlink(png[i]);
  unlink(path);
  bw_release(grid);
}

check_main(check_test(lines_without_diagonals), check_test(one_scale_for_all), check_test(refusals),
           check_test(animations))
