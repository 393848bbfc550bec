/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Recording what is drawn. Everything is checked here, once: see canvas.h for what holds after. */
#include <math.h>
#include <string.h>

#include "barwright/io.h"
#include "picture/canvas.h"

static const double far_away = 1e6; /* pixels; Cairo's fixed point ends at 8e6 */
enum { LARGEST = 20000, DEEPEST = 60 };

/* ---- the object ------------------------------------------------------------------------------ */

static void clear_ink(bwi_ink *ink) {
  bw_free(ink->point);
  bw_free(ink->text);
  bw_free(ink->png);
}

static void destroy(void *object) {
  bw_canvas *canvas = (bw_canvas *)object;
  for (size_t i = 0; i < canvas->count; i++)
    clear_ink(&canvas->ink[i]);
  bw_free(canvas->ink);
  bw_free(canvas->name);
  bw_free(canvas);
}

static size_t bytes_of(const void *object) {
  const bw_canvas *canvas = (const bw_canvas *)object;
  size_t bytes = sizeof *canvas + canvas->capacity * sizeof *canvas->ink;
  for (size_t i = 0; i < canvas->count; i++)
    bytes += 2 * sizeof(double) * (size_t)canvas->ink[i].count + canvas->ink[i].length;
  return bytes;
}

static const bw_kind canvas_kind = {"canvas", destroy, bytes_of};

bw_status bw_canvas_create(bw_context *context, double width, double height, const char *name,
                           bw_canvas **canvas) {
  *canvas = NULL;
  if (!(width >= 1 && height >= 1 && width <= LARGEST && height <= LARGEST))
    return bw_fail(context, BW_INVALID, "a drawing of %g x %g pixels: 1 to %d are possible", width,
                   height, LARGEST);
  bw_canvas *out = BW_NEW0(context, bw_canvas, 1);
  if (!out)
    return BW_MEMORY;
  bw_object_init(out, &canvas_kind);
  out->width = width;
  out->height = height;
  out->name = bwi_clean_text(context, name ? name : "");
  if (!out->name) {
    bw_release(out);
    return BW_MEMORY;
  }
  *canvas = out;
  return BW_OK;
}

void bw_canvas_size(const bw_canvas *canvas, double size[2]) {
  size[0] = canvas->width;
  size[1] = canvas->height;
}

/* Takes over what the ink holds, also when it fails. */
static bw_status add(bw_context *context, bw_canvas *canvas, bwi_ink *ink) {
  if (!bw_grow(context, (void **)&canvas->ink, &canvas->capacity, canvas->count, 1,
               sizeof *canvas->ink)) {
    clear_ink(ink);
    return BW_MEMORY;
  }
  canvas->ink[canvas->count++] = *ink;
  return BW_OK;
}

/* ---- checks ---------------------------------------------------------------------------------- */

static double clamped(double x) {
  return fmin(fmax(x, -far_away), far_away);
}

static bw_status check_colour(bw_context *context, const double colour[4]) {
  for (int k = 0; k < 4; k++)
    if (!(colour[k] >= 0 && colour[k] <= 1))
      return bw_fail(context, BW_INVALID, "a colour of %g, %g, %g, %g: four numbers from 0 to 1",
                     colour[0], colour[1], colour[2], colour[3]);
  return BW_OK;
}

static bw_status check_length(bw_context *context, const char *what, double length) {
  if (!(length >= 0 && length <= LARGEST))
    return bw_fail(context, BW_INVALID, "%s of %g pixels: 0 to %d are possible", what, length,
                   LARGEST);
  return BW_OK;
}

static bw_status check_pen(bw_context *context, const bw_pen *pen) {
  bw_status status = BW_OK;
  BW_TRY(check_colour(context, pen->fill));
  BW_TRY(check_colour(context, pen->stroke));
  BW_TRY(check_length(context, "a stroke", pen->width));
  for (int k = 0; k < 4; k++)
    BW_TRY(check_length(context, "a dash", pen->dash[k]));
done:
  return status;
}

static bw_status check_box(bw_context *context, const double box[4]) {
  if (!(isfinite(box[0]) && isfinite(box[1]) && box[2] >= 0 && box[3] >= 0 && isfinite(box[2]) &&
        isfinite(box[3])))
    return bw_fail(
        context, BW_INVALID,
        "a box from %g, %g of %g x %g pixels: finite numbers and sizes of 0 or more expected",
        box[0], box[1], box[2], box[3]);
  return BW_OK;
}

static void hold_box(const double box[4], double out[4]) {
  for (int k = 0; k < 4; k++)
    out[k] = clamped(box[k]);
}

/* Points copied and clamped to the reach; those that are not finite become nan. */
static bw_status copy_points(bw_context *context, int64_t count, const double *point,
                             bwi_ink *ink) {
  if (count < 0)
    return bw_fail(context, BW_INVALID, "%lld points: 0 or more expected", (long long)count);
  ink->point = (double *)bw_alloc(context, (size_t)count, 2 * sizeof *ink->point);
  if (!ink->point)
    return BW_MEMORY;
  ink->count = count;
  for (int64_t i = 0; i < count; i++) {
    bool finite = isfinite(point[2 * i]) && isfinite(point[2 * i + 1]);
    for (int k = 0; k < 2; k++)
      ink->point[2 * i + k] = finite ? clamped(point[2 * i + k]) : NAN;
  }
  return BW_OK;
}

/* ---- lines, rectangles, markers -------------------------------------------------------------- */

bw_status bw_canvas_line(bw_context *context, bw_canvas *canvas, const bw_pen *pen, bool closed,
                         int64_t count, const double *point) {
  bwi_ink ink = {.kind = BWI_LINE, .pen = *pen, .closed = closed};
  bw_status status = check_pen(context, pen);
  if (status == BW_OK)
    status = copy_points(context, count, point, &ink);
  return status == BW_OK ? add(context, canvas, &ink) : status;
}

bw_status bw_canvas_rectangle(bw_context *context, bw_canvas *canvas, const bw_pen *pen,
                              const double box[4], double radius) {
  bw_status status = BW_OK;
  BW_TRY(check_pen(context, pen));
  BW_TRY(check_box(context, box));
  BW_TRY(check_length(context, "a corner", radius));
  bwi_ink ink = {.kind = BWI_RECTANGLE, .pen = *pen};
  hold_box(box, ink.box);
  ink.size = fmin(radius, fmin(ink.box[2], ink.box[3]) / 2);
  status = add(context, canvas, &ink);
done:
  return status;
}

/* The notes behind each other in one block, each with its final zero. */
static bw_status copy_notes(bw_context *context, int64_t count, const char *const *note,
                            bwi_ink *ink) {
  size_t length = 1, at = 0;
  for (int64_t i = 0; i < count; i++)
    length += (note[i] ? strlen(note[i]) : 0) + 1;
  ink->text = BW_NEW(context, char, length);
  if (!ink->text)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++) {
    char *clean = bwi_clean_text(context, note[i] ? note[i] : "");
    if (!clean)
      return BW_MEMORY;
    size_t bytes = strlen(clean) + 1; /* cleaning keeps the length */
    memcpy(ink->text + at, clean, bytes);
    at += bytes;
    bw_free(clean);
  }
  ink->length = at;
  return BW_OK;
}

bw_status bw_canvas_markers(bw_context *context, bw_canvas *canvas, const bw_pen *pen,
                            bw_marker marker, double size, int64_t count, const double *point,
                            const char *const *note) {
  bwi_ink ink = {.kind = BWI_MARKERS, .pen = *pen, .marker = marker, .size = size};
  bw_status status = BW_OK;
  if (marker < 0 || marker >= BW_MARKER_COUNT)
    return bw_fail(context, BW_INVALID, "marker %d is not known", (int)marker);
  BW_TRY(check_pen(context, pen));
  BW_TRY(check_length(context, "a marker", size));
  BW_TRY(copy_points(context, count, point, &ink));
  if (note)
    BW_TRY(copy_notes(context, count, note, &ink));
  return add(context, canvas, &ink);
done:
  clear_ink(&ink);
  return status;
}

/* ---- text ------------------------------------------------------------------------------------ */

bw_status bw_canvas_text(bw_context *context, bw_canvas *canvas, const bw_label *label,
                         const char *text) {
  bw_status status = BW_OK;
  bwi_ink ink = {.kind = BWI_TEXT, .label = *label};
  BW_TRY(check_colour(context, label->colour));
  BW_TRY(check_length(context, "a font", label->size));
  if (!(isfinite(label->x) && isfinite(label->y) && isfinite(label->align) &&
        isfinite(label->angle)))
    return bw_fail(context, BW_INVALID,
                   "a text at %g, %g, align %g, angle %g: finite numbers expected", label->x,
                   label->y, label->align, label->angle);
  ink.label.x = clamped(label->x);
  ink.label.y = clamped(label->y);
  ink.label.angle = fmod(label->angle, 360);
  ink.text = bwi_clean_text(context, text);
  if (!ink.text)
    return BW_MEMORY;
  return add(context, canvas, &ink);
done:
  return status;
}

bw_status bw_canvas_text_width(bw_context *context, const bw_canvas *canvas, double size, bool bold,
                               const char *text, double *width) {
  (void)canvas;
  cairo_t *ruler = NULL;
  char *clean = NULL;
  bw_status status = BW_OK;
  *width = 0;
  BW_TRY(check_length(context, "a font", size));
  BW_TRY(bwi_ruler_open(context, &ruler));
  clean = bwi_clean_text(context, text);
  BW_TRY_MEMORY(clean);
  cairo_text_extents_t extents;
  bwi_choose_font(ruler, size, bold);
  cairo_text_extents(ruler, clean, &extents);
  *width = extents.x_advance;
  status = bwi_cairo_status(context, cairo_status(ruler), "measuring text");
done:
  bw_free(clean);
  if (ruler)
    cairo_destroy(ruler);
  return status;
}

/* ---- drawings within ------------------------------------------------------------------------- */

bw_status bw_canvas_enter(bw_context *context, bw_canvas *canvas, const double box[4],
                          const double view[4]) {
  bw_status status = check_box(context, box);
  if (status == BW_OK && view)
    status = check_box(context, view);
  if (status != BW_OK)
    return status;
  if (canvas->depth >= DEEPEST)
    return bw_fail(context, BW_INVALID, "%d nested drawings: leave some of them first", DEEPEST);
  bwi_ink ink = {.kind = BWI_ENTER};
  hold_box(box, ink.box);
  hold_box(view ? view : box, ink.view);
  status = add(context, canvas, &ink);
  canvas->depth += status == BW_OK;
  return status;
}

bw_status bw_canvas_leave(bw_context *context, bw_canvas *canvas) {
  if (canvas->depth == 0)
    return bw_fail(context, BW_INVALID, "there is no nested drawing to leave");
  bwi_ink ink = {.kind = BWI_LEAVE};
  bw_status status = add(context, canvas, &ink);
  canvas->depth -= status == BW_OK;
  return status;
}

/* ---- images ---------------------------------------------------------------------------------- */

bw_status bw_canvas_pixels(bw_context *context, bw_canvas *canvas, const double box[4], int columns,
                           int rows, const unsigned char *rgb) {
  bwi_ink ink = {.kind = BWI_IMAGE};
  cairo_surface_t *image = NULL;
  bw_status status = BW_OK;
  if (columns < 1 || rows < 1 || columns > LARGEST || rows > LARGEST)
    return bw_fail(context, BW_INVALID, "an image of %d x %d pixels: 1 to %d are possible", columns,
                   rows, LARGEST);
  BW_TRY(check_box(context, box));
  hold_box(box, ink.box);
  image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, columns, rows);
  BW_TRY(bwi_cairo_status(context, cairo_surface_status(image), "the image"));
  unsigned char *data = cairo_image_surface_get_data(image);
  int stride = cairo_image_surface_get_stride(image);
  for (int y = 0; y < rows; y++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * (size_t)stride);
    const unsigned char *from = rgb + 3 * (size_t)y * (size_t)columns;
    for (int x = 0; x < columns; x++, from += 3)
      row[x] = (uint32_t)from[0] << 16 | (uint32_t)from[1] << 8 | from[2];
  }
  cairo_surface_mark_dirty(image);
  BW_TRY(bwi_png_encode(context, image, &ink.png, &ink.length));
  status = add(context, canvas, &ink);
done:
  if (image)
    cairo_surface_destroy(image);
  return status;
}

/* The image with fewer pixels, in place of the one given. */
static bw_status reduce(bw_context *context, cairo_surface_t **image, int width, int height) {
  cairo_surface_t *small = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  cairo_t *cairo = cairo_create(small);
  cairo_scale(cairo, (double)width / cairo_image_surface_get_width(*image),
              (double)height / cairo_image_surface_get_height(*image));
  cairo_set_source_surface(cairo, *image, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(cairo), CAIRO_EXTEND_PAD); /* no pale rim */
  cairo_paint(cairo);
  bw_status status = bwi_cairo_status(context, cairo_status(cairo), "the reduced image");
  cairo_destroy(cairo);
  cairo_surface_destroy(status == BW_OK ? *image : small);
  if (status == BW_OK)
    *image = small;
  return status;
}

bw_status bw_canvas_image(bw_context *context, bw_canvas *canvas, const double box[4],
                          const char *path) {
  bwi_ink ink = {.kind = BWI_IMAGE};
  cairo_surface_t *image = NULL;
  bw_status status = BW_OK;
  BW_TRY(check_box(context, box));
  BW_TRY(bw_read_file(context, path, &ink.png, &ink.length));
  BW_TRY(bwi_png_decode(context, path, ink.png, ink.length, &image));
  double width = cairo_image_surface_get_width(image);
  double height = cairo_image_surface_get_height(image);
  double scale = fmin(box[2] / width, box[3] / height);
  ink.box[2] = clamped(scale * width);
  ink.box[3] = clamped(scale * height);
  ink.box[0] = clamped(box[0] + (box[2] - ink.box[2]) / 2);
  ink.box[1] = clamped(box[1] + (box[3] - ink.box[3]) / 2);
  if (scale < 0.4) {
    BW_TRY(reduce(context, &image, (int)fmax(1, ceil(2 * ink.box[2] - 1e-9)),
                  (int)fmax(1, ceil(2 * ink.box[3] - 1e-9))));
    bw_free(ink.png);
    ink.png = NULL;
    BW_TRY(bwi_png_encode(context, image, &ink.png, &ink.length));
  }
  status = add(context, canvas, &ink);
  ink.png = NULL;
done:
  bw_free(ink.png);
  if (image)
    cairo_surface_destroy(image);
  return status;
}
