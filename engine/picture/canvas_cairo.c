/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A canvas through Cairo: pixels, PNG in memory, and the proportions of fonts. */
#include <math.h>
#include <string.h>

#include "barwright/io.h"
#include "picture/canvas.h"

static const double two_pi = 6.283185307179586;
static const double max_area = 1e8; /* pixels: 400 MB */
enum { MAX_PIXELS = 20000 };

bw_status bwi_cairo_status(bw_context *context, cairo_status_t status, const char *what) {
  return status == CAIRO_STATUS_SUCCESS ? BW_OK
         : status == CAIRO_STATUS_NO_MEMORY
             ? bw_fail(context, BW_MEMORY, "%s: no memory for the picture", what)
             : bw_fail(context, BW_INTERNAL, "%s: %s", what, cairo_status_to_string(status));
}

/* ---- PNG in memory --------------------------------------------------------------------------- */

typedef struct memory {
  bw_context *context;
  unsigned char *bytes;
  size_t count, capacity, at;
  bool full;
} memory;

static cairo_status_t put_bytes(void *data, const unsigned char *bytes, unsigned int count) {
  memory *m = (memory *)data;
  if (!bw_grow(m->context, (void **)&m->bytes, &m->capacity, m->count, count, 1)) {
    m->full = true;
    return CAIRO_STATUS_WRITE_ERROR;
  }
  memcpy(m->bytes + m->count, bytes, count);
  m->count += count;
  return CAIRO_STATUS_SUCCESS;
}

static cairo_status_t get_bytes(void *data, unsigned char *bytes, unsigned int count) {
  memory *m = (memory *)data;
  if (count > m->count - m->at)
    return CAIRO_STATUS_READ_ERROR;
  memcpy(bytes, m->bytes + m->at, count);
  m->at += count;
  return CAIRO_STATUS_SUCCESS;
}

bw_status bwi_png_encode(bw_context *context, cairo_surface_t *image, unsigned char **png,
                         size_t *length) {
  memory m = {.context = context};
  cairo_status_t status = cairo_surface_write_to_png_stream(image, put_bytes, &m);
  if (status == CAIRO_STATUS_SUCCESS) {
    *png = m.bytes;
    *length = m.count;
    return BW_OK;
  }
  bw_free(m.bytes);
  return m.full ? BW_MEMORY : bwi_cairo_status(context, status, "the image");
}

static uint32_t big_endian(const unsigned char *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

bw_status bwi_png_decode(bw_context *context, const char *name, const unsigned char *png,
                         size_t length, cairo_surface_t **image) {
  static const unsigned char head[8] = {137, 'P', 'N', 'G', 13, 10, 26, 10};
  *image = NULL;
  if (length < 33 || memcmp(png, head, sizeof head) != 0 || memcmp(png + 12, "IHDR", 4) != 0)
    return bw_fail(context, BW_FORMAT, "%s: this is no PNG file", name);
  uint32_t columns = big_endian(png + 16), rows = big_endian(png + 20);
  if (columns > MAX_PIXELS || rows > MAX_PIXELS ||
      (double)columns * rows > max_area) /* before memory is asked for */
    return bw_fail(context, BW_LIMIT, "%s: %u x %u pixels: at most %d x %d and %g in all are read",
                   name, (unsigned)columns, (unsigned)rows, MAX_PIXELS, MAX_PIXELS, max_area);
  /* Cairo calls a damaged file a lack of memory, so that is found out here */
  void *block = bw_alloc(context, (size_t)columns * rows, 4);
  bw_free(block);
  if (!block)
    return BW_MEMORY;
  memory m = {.bytes = (unsigned char *)(uintptr_t)png, .count = length};
  cairo_surface_t *out = cairo_image_surface_create_from_png_stream(get_bytes, &m);
  cairo_status_t status = cairo_surface_status(out);
  if (status == CAIRO_STATUS_SUCCESS) {
    *image = out;
    return BW_OK;
  }
  cairo_surface_destroy(out);
  return bw_fail(context, BW_FORMAT, "%s: the PNG file is damaged or ends early", name);
}

/* ---- fonts ----------------------------------------------------------------------------------- */

bw_status bwi_ruler_open(bw_context *context, cairo_t **ruler) {
  /* Without bounds: outlines of letters far outside of a surface are left out by Cairo. */
  cairo_surface_t *endless = cairo_recording_surface_create(CAIRO_CONTENT_ALPHA, NULL);
  cairo_t *out = cairo_create(endless);
  cairo_surface_destroy(endless); /* held by the context */
  bw_status status = bwi_cairo_status(context, cairo_status(out), "measuring text");
  if (status != BW_OK) {
    cairo_destroy(out);
    out = NULL;
  }
  *ruler = out;
  return status;
}

/* ---- drawing --------------------------------------------------------------------------------- */

static void set_colour(cairo_t *cairo, const double colour[4]) {
  cairo_set_source_rgba(cairo, colour[0], colour[1], colour[2], colour[3]);
}

static void ready_stroke(cairo_t *cairo, const bw_pen *pen) {
  int dashes = pen->dash[0] > 0 ? pen->dash[2] > 0 ? 4 : 2 : 0;
  cairo_set_line_width(cairo, pen->width);
  cairo_set_dash(cairo, pen->dash, dashes, 0);
  cairo_set_line_cap(cairo, pen->round ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  cairo_set_line_join(cairo, pen->round ? CAIRO_LINE_JOIN_ROUND : CAIRO_LINE_JOIN_MITER);
}

/* Fills and strokes the path at hand. */
static void ink_path(cairo_t *cairo, const bw_pen *pen) {
  if (pen->fill[3] > 0) {
    set_colour(cairo, pen->fill);
    cairo_fill_preserve(cairo);
  }
  if (pen->stroke[3] > 0 && pen->width > 0) {
    set_colour(cairo, pen->stroke);
    ready_stroke(cairo, pen);
    cairo_stroke_preserve(cairo);
  }
  cairo_new_path(cairo);
}

static void draw_line(cairo_t *cairo, const bwi_ink *ink) {
  bool open = false;
  for (int64_t i = 0; i <= ink->count; i++) {
    const double *p = ink->point + 2 * i;
    if (i == ink->count || isnan(p[0])) {
      if (open && ink->closed)
        cairo_close_path(cairo);
      open = false;
    } else if (open)
      cairo_line_to(cairo, p[0], p[1]);
    else {
      cairo_move_to(cairo, p[0], p[1]);
      open = true;
    }
  }
  ink_path(cairo, &ink->pen);
}

static void draw_rectangle(cairo_t *cairo, const bwi_ink *ink) {
  double x = ink->box[0], y = ink->box[1], w = ink->box[2], h = ink->box[3], r = ink->size;
  if (r > 0) {
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, x + w - r, y + r, r, -two_pi / 4, 0);
    cairo_arc(cairo, x + w - r, y + h - r, r, 0, two_pi / 4);
    cairo_arc(cairo, x + r, y + h - r, r, two_pi / 4, two_pi / 2);
    cairo_arc(cairo, x + r, y + r, r, two_pi / 2, 3 * two_pi / 4);
    cairo_close_path(cairo);
  } else
    cairo_rectangle(cairo, x, y, w, h);
  ink_path(cairo, &ink->pen);
}

static void draw_markers(cairo_t *cairo, const bwi_ink *ink) {
  double corner[BWI_MARKER_CORNERS][2];
  int corners = bwi_marker_corners(ink->marker, ink->size, corner);
  bool strokes = ink->marker == BW_CROSS || ink->marker == BW_PLUS;
  for (int64_t i = 0; i < ink->count; i++) {
    double x = ink->point[2 * i], y = ink->point[2 * i + 1];
    if (isnan(x))
      continue;
    if (corners == 0)
      cairo_arc(cairo, x, y, ink->size / 2, 0, two_pi);
    for (int c = 0; c < corners; c++)
      if (c == 0 || (strokes && c == 2))
        cairo_move_to(cairo, x + corner[c][0], y + corner[c][1]);
      else
        cairo_line_to(cairo, x + corner[c][0], y + corner[c][1]);
    if (!strokes)
      cairo_close_path(cairo);
    ink_path(cairo, &ink->pen);
  }
}

static void draw_text(cairo_t *cairo, const bwi_ink *ink) {
  const bw_label *label = &ink->label;
  cairo_text_extents_t extents;
  cairo_save(cairo);
  cairo_translate(cairo, label->x, label->y);
  cairo_rotate(cairo, -label->angle * two_pi / 360);
  bwi_choose_font(cairo, label->size, label->bold);
  cairo_text_extents(cairo, ink->text, &extents);
  cairo_move_to(cairo, -label->align * extents.x_advance, 0);
  cairo_text_path(cairo, ink->text);
  if (label->halo) {
    cairo_set_source_rgba(cairo, 1, 1, 1, 0.85);
    cairo_set_dash(cairo, NULL, 0, 0);
    cairo_set_line_width(cairo, label->size / 4);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke_preserve(cairo);
  }
  set_colour(cairo, label->colour);
  cairo_fill(cairo);
  cairo_restore(cairo);
}

static bw_status draw_image(bw_context *context, cairo_t *cairo, const bwi_ink *ink) {
  cairo_surface_t *image = NULL;
  bw_status status = bwi_png_decode(context, "an image", ink->png, ink->length, &image);
  if (status != BW_OK)
    return status;
  double columns = cairo_image_surface_get_width(image);
  double rows = cairo_image_surface_get_height(image);
  if (ink->box[2] > 0 && ink->box[3] > 0) {
    cairo_save(cairo);
    cairo_rectangle(cairo, ink->box[0], ink->box[1], ink->box[2], ink->box[3]);
    cairo_clip(cairo);
    cairo_translate(cairo, ink->box[0], ink->box[1]);
    cairo_scale(cairo, ink->box[2] / columns, ink->box[3] / rows);
    cairo_set_source_surface(cairo, image, 0, 0);
    cairo_pattern_set_extend(cairo_get_source(cairo), CAIRO_EXTEND_PAD);
    cairo_paint(cairo);
    cairo_restore(cairo);
  }
  cairo_surface_destroy(image);
  return BW_OK;
}

static void enter(cairo_t *cairo, const bwi_ink *ink) {
  const double *box = ink->box, *view = ink->view;
  cairo_save(cairo);
  cairo_rectangle(cairo, box[0], box[1], box[2], box[3]);
  cairo_clip(cairo);
  if (!(box[2] > 0 && box[3] > 0 && view[2] > 0 && view[3] > 0))
    return; /* nothing is seen */
  double scale = fmin(box[2] / view[2], box[3] / view[3]);
  cairo_translate(cairo, box[0] + (box[2] - scale * view[2]) / 2,
                  box[1] + (box[3] - scale * view[3]) / 2);
  cairo_scale(cairo, scale, scale);
  cairo_translate(cairo, -view[0], -view[1]);
}

static bw_status draw(bw_context *context, cairo_t *cairo, const bw_canvas *canvas) {
  bw_status status = BW_OK;
  for (size_t i = 0; i < canvas->count && status == BW_OK; i++) {
    const bwi_ink *ink = &canvas->ink[i];
    switch (ink->kind) {
    case BWI_LINE:
      draw_line(cairo, ink);
      break;
    case BWI_RECTANGLE:
      draw_rectangle(cairo, ink);
      break;
    case BWI_MARKERS:
      draw_markers(cairo, ink);
      break;
    case BWI_TEXT:
      draw_text(cairo, ink);
      break;
    case BWI_IMAGE:
      status = draw_image(context, cairo, ink);
      break;
    case BWI_ENTER:
      enter(cairo, ink);
      break;
    case BWI_LEAVE:
      cairo_restore(cairo);
      break;
    }
    if (status == BW_OK)
      status = bw_check_cancel(context);
  }
  return status == BW_OK ? bwi_cairo_status(context, cairo_status(cairo), "the drawing") : status;
}

bw_status bwi_canvas_png(bw_context *context, const bw_canvas *canvas, double scale,
                         const char *path) {
  double width = ceil(scale * canvas->width - 1e-9), height = ceil(scale * canvas->height - 1e-9);
  if (width > MAX_PIXELS || height > MAX_PIXELS || width * height > max_area)
    return bw_fail(context, BW_INVALID,
                   "%s: %g x %g pixels: at most %d x %d and %g in all are possible", path, width,
                   height, MAX_PIXELS, MAX_PIXELS, max_area);
  cairo_surface_t *image =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)fmax(1, width), (int)fmax(1, height));
  cairo_t *cairo = cairo_create(image);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  cairo_scale(cairo, scale, scale);
  cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
  bw_status status = draw(context, cairo, canvas);
  cairo_destroy(cairo);
  if (status == BW_OK)
    status = bwi_write_png(context, image, path);
  cairo_surface_destroy(image);
  return status;
}
