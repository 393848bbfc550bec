/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "check.h"
#include "picture/canvas.h"

#include <unistd.h>

#include "barwright/io.h"

static const bw_pen red = {.fill = {1, 0, 0, 1}};
static const bw_pen blue_line = {.stroke = {0, 0, 1, 1}, .width = 4};

static char *path_of(const char *name) {
  static char path[2][200];
  static int turn = 0;
  turn = 1 - turn;
  snprintf(path[turn], sizeof path[turn], "/tmp/barwright-test-%d-%s", (int)getpid(), name);
  return path[turn];
}

static bw_canvas *canvas_of(bw_context *context, double width, double height) {
  bw_canvas *canvas = NULL;
  check_ok(context, bw_canvas_create(context, width, height, "a <drawing> & more", &canvas));
  return canvas;
}

static char *svg_of(bw_context *context, const bw_canvas *canvas, bool outlines) {
  char *text = NULL;
  size_t length;
  check_ok(context, bw_canvas_svg(context, canvas, outlines, &text, &length));
  assert_int_equal(strlen(text), length);
  return text;
}

static void assert_holds(const char *text, const char *part) {
  if (!strstr(text, part))
    fail_msg("\"%s\" is not in:\n%s", part, text);
}

/* The pixels of the drawing, through a PNG file. */
static cairo_surface_t *pixels_of(bw_context *context, const bw_canvas *canvas, double scale) {
  char *path = path_of("canvas.png");
  unsigned char *bytes = NULL;
  size_t count;
  cairo_surface_t *image = NULL;
  check_ok(context, bw_canvas_write(context, canvas, scale, true, path));
  check_ok(context, bw_read_file(context, path, &bytes, &count));
  check_ok(context, bwi_png_decode(context, path, bytes, count, &image));
  bw_free(bytes);
  unlink(path);
  return image;
}

static unsigned pixel_at(cairo_surface_t *image, int x, int y) {
  const unsigned char *data = cairo_image_surface_get_data(image);
  const unsigned char *row = data + (size_t)y * (size_t)cairo_image_surface_get_stride(image);
  uint32_t value;
  memcpy(&value, row + 4 * (size_t)x, 4);
  return value & 0xffffff;
}

/* One of everything. */
static void draw_all(bw_context *context, bw_canvas *canvas, const char *png) {
  const double line[8] = {10, 10, 20, 20, NAN, 0, 30, 30};
  const double square[8] = {50, 50, 70, 50, 70, 70, 50, 70};
  const char *const note[4] = {"first", NULL, "", "<last>"};
  const unsigned char rgb[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  bw_pen dashed = blue_line;
  dashed.dash[0] = dashed.dash[1] = 3;
  dashed.round = true;
  bw_label label = {
      .x = 40, .y = 90, .size = 12, .align = 0.5, .angle = 90, .colour = {0, 0, 0, 1}};
  label.halo = label.bold = true;
  check_ok(context, bw_canvas_line(context, canvas, &dashed, false, 4, line));
  check_ok(context, bw_canvas_line(context, canvas, &red, true, 4, square));
  check_ok(context, bw_canvas_rectangle(context, canvas, &red, (double[4]){1, 2, 30, 4}, 2));
  for (int marker = 0; marker < BW_MARKER_COUNT; marker++)
    check_ok(context,
             bw_canvas_markers(context, canvas, &blue_line, (bw_marker)marker, 6, 4, line, note));
  check_ok(context, bw_canvas_text(context, canvas, &label, "5 < \xC2\xB5m & \"more\" \xFF"));
  check_ok(context, bw_canvas_enter(context, canvas, (double[4]){0, 0, 50, 50},
                                    (double[4]){0, 0, 100, 100}));
  check_ok(context, bw_canvas_pixels(context, canvas, (double[4]){10, 10, 20, 20}, 2, 2, rgb));
  check_ok(context, bw_canvas_leave(context, canvas));
  if (png)
    check_ok(context, bw_canvas_image(context, canvas, (double[4]){60, 0, 40, 20}, png));
}

static void what_is_drawn_lies_where_it_was_put(void **state) {
  bw_context *context = check_context(state);
  bw_canvas *canvas = canvas_of(context, 100, 80);
  const double point[4] = {20, 30, 70.125, 60};
  const double ring[18] = {40,  10, 60, 10, 60, 30, 40, 30, NAN,
                           NAN, 45, 15, 55, 15, 55, 25, 45, 25};
  check_ok(context, bw_canvas_markers(context, canvas, &red, BW_DISC, 10, 2, point, NULL));
  check_ok(context, bw_canvas_line(context, canvas, &red, true, 9, ring));
  check_ok(context, bw_canvas_line(context, canvas, &blue_line, false, 2,
                                   (const double[4]){0, 70, 100, 70}));
  char *svg = svg_of(context, canvas, false);
  assert_holds(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"80\" "
                    "viewBox=\"0 0 100 80\"");
  assert_holds(svg, "aria-label=\"a &lt;drawing&gt; &amp; more\"");
  assert_holds(svg, "<circle cx=\"20\" cy=\"30\" r=\"5\"/>");
  assert_holds(svg, "cx=\"70.13\"");
  assert_holds(svg,
               "<path d=\"M0 70L100 70\" fill=\"none\" stroke=\"#0000ff\" stroke-width=\"4\"/>");
  assert_null(strstr(svg, " id=\""));
  cairo_surface_t *image = pixels_of(context, canvas, 2);
  assert_int_equal(cairo_image_surface_get_width(image), 200);
  assert_int_equal(cairo_image_surface_get_height(image), 160);
  assert_int_equal(pixel_at(image, 40, 60), 0xff0000); /* the disc's middle */
  assert_int_equal(pixel_at(image, 48, 60), 0xff0000); /* radius 5 at scale 2 */
  assert_int_equal(pixel_at(image, 52, 60), 0xffffff);
  assert_int_equal(pixel_at(image, 84, 24), 0xff0000); /* the ring and its hole */
  assert_int_equal(pixel_at(image, 100, 40), 0xffffff);
  assert_int_equal(pixel_at(image, 100, 140), 0x0000ff);
  assert_int_equal(pixel_at(image, 100, 134), 0xffffff); /* 4 wide: from 136 to 144 */
  cairo_surface_destroy(image);
  bw_free(svg);
  bw_release(canvas);
}

static void drawings_within_are_moved_scaled_and_cut(void **state) {
  bw_context *context = check_context(state);
  bw_canvas *canvas = canvas_of(context, 100, 100);
  /* a square drawing in a wide box: centred, half as large */
  check_ok(context, bw_canvas_enter(context, canvas, (double[4]){20, 40, 60, 20},
                                    (double[4]){0, 0, 40, 40}));
  check_ok(context, bw_canvas_rectangle(context, canvas, &red, (double[4]){0, 0, 20, 200}, 0));
  check_ok(context, bw_canvas_leave(context, canvas));
  check_fails(context, BW_INVALID, "no nested drawing", bw_canvas_leave(context, canvas));
  cairo_surface_t *image = pixels_of(context, canvas, 1);
  assert_int_equal(pixel_at(image, 42, 45), 0xff0000); /* from 40 to 50 across, 40 to 60 down */
  assert_int_equal(pixel_at(image, 52, 45), 0xffffff);
  assert_int_equal(pixel_at(image, 38, 45), 0xffffff);
  assert_int_equal(pixel_at(image, 45, 62), 0xffffff); /* cut */
  char *svg = svg_of(context, canvas, false);
  assert_holds(svg, "<svg x=\"20\" y=\"40\" width=\"60\" height=\"20\" viewBox=\"0 0 40 40\" "
                    "overflow=\"hidden\">");
  bw_free(svg);
  cairo_surface_destroy(image);
  bw_release(canvas);
}

static void text_is_as_wide_as_measured(void **state) {
  bw_context *context = check_context(state);
  bw_canvas *canvas = canvas_of(context, 300, 60);
  double width, twice, none;
  check_ok(context, bw_canvas_text_width(context, canvas, 20, false, "Hamburg \xC2\xB5m", &width));
  check_ok(context, bw_canvas_text_width(context, canvas, 40, false, "Hamburg \xC2\xB5m", &twice));
  check_ok(context, bw_canvas_text_width(context, canvas, 40, true, "", &none));
  assert_true(width > 90 && width < 150);
  check_near(twice, 2 * width, 0.01 * width);
  check_near(none, 0, 0);
  bw_label label = {.x = 290, .y = 40, .size = 20, .align = 1, .colour = {0, 0, 0, 1}};
  check_ok(context, bw_canvas_text(context, canvas, &label, "Hamburg \xC2\xB5m"));
  cairo_surface_t *image = pixels_of(context, canvas, 1);
  int first = 300, last = -1;
  for (int y = 0; y < 60; y++)
    for (int x = 0; x < 300; x++)
      if (pixel_at(image, x, y) != 0xffffff) {
        first = x < first ? x : first;
        last = x > last ? x : last;
      }
  check_near(first, 290 - width, 4); /* the letters' own sides */
  check_near(last, 290, 4);
  char *svg = svg_of(context, canvas, false), *outlines = svg_of(context, canvas, true);
  assert_holds(svg, "text-anchor=\"end\"");
  assert_holds(svg, ">Hamburg \xC2\xB5m</text>");
  assert_null(strstr(outlines, "<text"));
  assert_holds(outlines,
               "<path aria-label=\"Hamburg \xC2\xB5m\" transform=\"translate(290 40)\" d=\"M");
  bw_free(svg);
  bw_free(outlines);
  cairo_surface_destroy(image);
  bw_release(canvas);
}

/* Each letter of a long text is there, on whichever side of its place it lies. */
static void long_texts_are_whole(void **state) {
  enum { LETTERS = 300 };
  bw_context *context = check_context(state);
  char text[LETTERS + 1];
  memset(text, 'l', LETTERS); /* one outline each */
  text[LETTERS] = '\0';
  for (int way = 0; way < 3; way++) {
    bw_canvas *canvas = canvas_of(context, 300, 60);
    bw_label label = {.x = 150, .y = 40, .size = 12, .align = way / 2.0, .colour = {0, 0, 0, 1}};
    check_ok(context, bw_canvas_text(context, canvas, &label, text));
    char *svg = svg_of(context, canvas, true);
    int outlines = 0;
    for (const char *at = strstr(svg, " d=\"M"); *at; at++)
      outlines += *at == 'M';
    assert_int_equal(outlines, LETTERS);
    bw_free(svg);
    bw_release(canvas);
  }
}

static void images_are_fitted_and_large_ones_reduced(void **state) {
  bw_context *context = check_context(state);
  char *path = path_of("large.png");
  bw_canvas *large = canvas_of(context, 800, 400);
  check_ok(context, bw_canvas_rectangle(context, large, &red, (double[4]){0, 0, 400, 400}, 0));
  check_ok(context, bw_canvas_write(context, large, 1, true, path));
  bw_canvas *canvas = canvas_of(context, 120, 100);
  check_ok(context, bw_canvas_image(context, canvas, (double[4]){10, 10, 100, 80}, path));
  /* 100 x 50 from (10, 25); of its pixels 200 x 100 are kept */
  assert_int_equal(canvas->ink[0].kind, BWI_IMAGE);
  check_near(canvas->ink[0].box[1], 25, 1e-12);
  check_near(canvas->ink[0].box[3], 50, 1e-12);
  assert_int_equal(canvas->ink[0].png[19], 200);
  assert_int_equal(canvas->ink[0].png[23], 100);
  cairo_surface_t *image = pixels_of(context, canvas, 1);
  assert_int_equal(pixel_at(image, 12, 27), 0xff0000);
  assert_int_equal(pixel_at(image, 57, 72), 0xff0000);
  assert_int_equal(pixel_at(image, 63, 72), 0xffffff);
  assert_int_equal(pixel_at(image, 30, 22), 0xffffff);
  char *svg = svg_of(context, canvas, false);
  assert_holds(svg, "<image x=\"10\" y=\"25\" width=\"100\" height=\"50\" "
                    "preserveAspectRatio=\"none\" href=\"data:image/png;base64,iVBORw0KGgo");
  bw_free(svg);
  cairo_surface_destroy(image);
  bw_release(canvas);
  bw_release(large);
  unlink(path);
}

static void broken_images_are_refused(void **state) {
  bw_context *context = check_context(state);
  bw_canvas *canvas = canvas_of(context, 50, 50);
  const double box[4] = {0, 0, 50, 50};
  char *path = path_of("broken.png");
  check_fails(context, BW_IO, "broken.png", bw_canvas_image(context, canvas, box, path));
  check_ok(context, bw_canvas_write(context, canvas, 1, true, path));
  unsigned char *bytes = NULL;
  size_t count;
  check_ok(context, bw_read_file(context, path, &bytes, &count));
  for (size_t length = 0; length < count; length += 7) { /* files that end early */
    cairo_surface_t *image = NULL;
    bw_status status = bwi_png_decode(context, "cut", bytes, length, &image);
    if (status == BW_OK) /* all rows were there */
      cairo_surface_destroy(image);
    else
      assert_int_equal(status, BW_FORMAT);
    assert_true(status != BW_OK || length > count / 2);
  }
  for (size_t at = 8; at < count; at += 3) { /* files with a wrong byte */
    cairo_surface_t *image = NULL;
    bytes[at] ^= 0x5A;
    bw_status status = bwi_png_decode(context, "wrong", bytes, count, &image);
    bytes[at] ^= 0x5A;
    if (status == BW_OK)
      cairo_surface_destroy(image);
    else
      assert_true(status == BW_FORMAT || status == BW_LIMIT);
  }
  bytes[16] = 1; /* 16777266 pixels wide */
  cairo_surface_t *image = NULL;
  check_fails(context, BW_LIMIT, "at most", bwi_png_decode(context, "wide", bytes, count, &image));
  bw_free(bytes);
  assert_int_equal(canvas->count, 0);
  bw_release(canvas);
  unlink(path);
}

static void misuse_is_refused(void **state) {
  bw_context *context = check_context(state);
  bw_canvas *canvas = NULL;
  check_fails(context, BW_INVALID, "0 x 10", bw_canvas_create(context, 0, 10, NULL, &canvas));
  check_fails(context, BW_INVALID, "nan", bw_canvas_create(context, 10, NAN, NULL, &canvas));
  assert_null(canvas);
  check_ok(context, bw_canvas_create(context, 10, 10, NULL, &canvas));
  bw_pen pen = red;
  pen.fill[0] = 1.5;
  check_fails(context, BW_INVALID, "colour", bw_canvas_line(context, canvas, &pen, true, 0, NULL));
  pen = blue_line;
  pen.width = -1;
  check_fails(context, BW_INVALID, "stroke", bw_canvas_line(context, canvas, &pen, true, 0, NULL));
  check_fails(context, BW_INVALID, "box",
              bw_canvas_rectangle(context, canvas, &red, (double[4]){0, 0, -1, 1}, 0));
  bw_label label = {.x = NAN, .size = 12};
  check_fails(context, BW_INVALID, "finite", bw_canvas_text(context, canvas, &label, "x"));
  check_fails(context, BW_UNSUPPORTED, ".svg or .png",
              bw_canvas_write(context, canvas, 1, true, "/tmp/drawing.pdf"));
  check_fails(context, BW_IO, "/nowhere/",
              bw_canvas_write(context, canvas, 1, true, "/nowhere/drawing.svg"));
  check_fails(context, BW_INVALID, "scale", bw_canvas_write(context, canvas, 0, true, "x.png"));
  assert_int_equal(canvas->count, 0);
  /* what is far away or nothing at all is drawn nevertheless */
  check_ok(context, bw_canvas_line(context, canvas, &blue_line, false, 0, NULL));
  check_ok(context, bw_canvas_line(context, canvas, &blue_line, false, 2,
                                   (const double[4]){-1e300, 0, INFINITY, 1}));
  check_ok(context, bw_canvas_enter(context, canvas, (double[4]){0, 0, 0, 0}, NULL));
  check_ok(context, bw_canvas_rectangle(context, canvas, &red, (double[4]){0, 0, 5, 5}, 9));
  cairo_surface_t *image = pixels_of(context, canvas, 1);
  assert_int_equal(pixel_at(image, 2, 2), 0xffffff);
  cairo_surface_destroy(image);
  bw_release(canvas);
}

static void many_discs_are_few_bytes(void **state) {
  bw_context *context = check_context(state);
  enum { COUNT = 20000 };
  bw_canvas *canvas = canvas_of(context, 500, 500);
  double *point = malloc(sizeof *point * 2 * COUNT);
  for (int i = 0; i < COUNT; i++) {
    point[2 * i] = i % 500;
    point[2 * i + 1] = i * 37 % 499;
  }
  check_ok(context, bw_canvas_markers(context, canvas, &red, BW_DISC, 3, COUNT, point, NULL));
  char *svg = svg_of(context, canvas, false);
  assert_true(strlen(svg) < 14 * COUNT);
  free(point);
  bw_free(svg);
  bw_release(canvas);
}

static void same_drawing_same_bytes(void **state) {
  bw_context *context = check_context(state);
  char *svg[2];
  for (int i = 0; i < 2; i++) {
    bw_canvas *canvas = canvas_of(context, 100, 100);
    draw_all(context, canvas, NULL);
    svg[i] = svg_of(context, canvas, true);
    bw_release(canvas);
  }
  assert_string_equal(svg[0], svg[1]);
  bw_free(svg[0]);
  bw_free(svg[1]);
}

/* Everything in turn, with the status of the first failure. */
static bw_status whole(bw_context *context, const char *png, const char *out) {
  const double point[4] = {1, 2, 3, 4};
  const char *const note[2] = {"a", "b"};
  const double box[4] = {0, 0, 20, 20};
  const unsigned char rgb[3] = {1, 2, 3};
  bw_label label = {.size = 12, .colour = {0, 0, 0, 1}};
  bw_canvas *canvas = NULL;
  char *text = NULL;
  size_t length;
  double width;
  bw_status status = BW_OK;
  BW_TRY(bw_canvas_create(context, 40, 30, "name", &canvas));
  BW_TRY(bw_canvas_line(context, canvas, &blue_line, false, 2, point));
  BW_TRY(bw_canvas_rectangle(context, canvas, &red, box, 1));
  BW_TRY(bw_canvas_markers(context, canvas, &red, BW_DIAMOND, 5, 2, point, note));
  BW_TRY(bw_canvas_text(context, canvas, &label, "text"));
  BW_TRY(bw_canvas_text_width(context, canvas, 12, false, "text", &width));
  BW_TRY(bw_canvas_enter(context, canvas, box, NULL));
  BW_TRY(bw_canvas_pixels(context, canvas, box, 1, 1, rgb));
  BW_TRY(bw_canvas_image(context, canvas, box, png));
  BW_TRY(bw_canvas_leave(context, canvas));
  BW_TRY(bw_canvas_svg(context, canvas, true, &text, &length));
  BW_TRY(bw_canvas_write(context, canvas, 1, false, out));
done:
  bw_free(text);
  bw_release(canvas);
  return status;
}

static void failing_allocations_leave_nothing_behind(void **state) {
  bw_context *context = check_context(state);
  char png[200], out[200];
  snprintf(png, sizeof png, "%s", path_of("from.png"));
  snprintf(out, sizeof out, "%s", path_of("to.svg"));
  bw_canvas *canvas = canvas_of(context, 100, 100);
  draw_all(context, canvas, NULL);
  check_ok(context, bw_canvas_write(context, canvas, 1, true, png));
  bw_release(canvas);
  check_each_allocation(context, status, 1) {
    status = whole(context, png, out);
    if (status != BW_OK)
      assert_int_not_equal(access(out, F_OK), 0);
  }
  unlink(png);
  unlink(out);
}

check_main(check_test(what_is_drawn_lies_where_it_was_put),
           check_test(drawings_within_are_moved_scaled_and_cut),
           check_test(text_is_as_wide_as_measured), check_test(long_texts_are_whole),
           check_test(images_are_fitted_and_large_ones_reduced),
           check_test(broken_images_are_refused), check_test(misuse_is_refused),
           check_test(many_discs_are_few_bytes), check_test(same_drawing_same_bytes),
           check_test(failing_allocations_leave_nothing_behind))
