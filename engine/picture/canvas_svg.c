/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A canvas as SVG text. There are no ids, which would clash where several drawings stand in one
 * page: clipping is by <svg> elements within, whose overflow is hidden. Lengths are rounded to a
 * hundredth of a pixel. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/io.h"
#include "picture/canvas.h"

/* ---- growing text: the first failure sticks -------------------------------------------------- */

typedef struct page {
  bw_context *context;
  char *text;
  size_t count, capacity;
  bool full;
} page;

static void put_bytes(page *out, const char *bytes, size_t count) {
  if (out->full ||
      !bw_grow(out->context, (void **)&out->text, &out->capacity, out->count, count + 1, 1)) {
    out->full = true;
    return;
  }
  memcpy(out->text + out->count, bytes, count);
  out->count += count;
  out->text[out->count] = 0;
}

static void put(page *out, const char *text) {
  put_bytes(out, text, strlen(text));
}

/* Hundredths, without zeros at the end. */
static void put_number(page *out, double value) {
  char buffer[40];
  long long n = llround(100 * value);
  unsigned long long m = n < 0 ? 0ULL - (unsigned long long)n : (unsigned long long)n;
  int length = snprintf(buffer, sizeof buffer, "%s%llu", n < 0 ? "-" : "", m / 100);
  if (m % 10)
    length += snprintf(buffer + length, sizeof buffer - (size_t)length, ".%02llu", m % 100);
  else if (m % 100)
    length += snprintf(buffer + length, sizeof buffer - (size_t)length, ".%llu", m % 100 / 10);
  put_bytes(out, buffer, (size_t)length);
}

static void put_attribute(page *out, const char *name, double value) {
  put(out, " ");
  put(out, name);
  put(out, "=\"");
  put_number(out, value);
  put(out, "\"");
}

static void put_pair(page *out, const char *command, double x, double y) {
  put(out, command);
  put_number(out, x);
  put(out, " ");
  put_number(out, y);
}

/* The text is valid UTF-8; XML forbids two code points more. */
static void put_escaped(page *out, const char *text) {
  for (const char *c = text; *c; c++) {
    if (*c == '&')
      put(out, "&amp;");
    else if (*c == '<')
      put(out, "&lt;");
    else if (*c == '>')
      put(out, "&gt;");
    else if (*c == '"')
      put(out, "&quot;");
    else if (memcmp(c, "\xEF\xBF", 2) == 0 && (c[2] == '\xBE' || c[2] == '\xBF')) {
      put(out, "?");
      c += 2;
    } else
      put_bytes(out, c, 1);
  }
}

static void put_base64(page *out, const unsigned char *bytes, size_t count) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < count; i += 3) {
    uint32_t three = (uint32_t)bytes[i] << 16 | (i + 1 < count ? (uint32_t)bytes[i + 1] << 8 : 0) |
                     (i + 2 < count ? bytes[i + 2] : 0);
    char four[4] = {digit[three >> 18], digit[three >> 12 & 63],
                    i + 1 < count ? digit[three >> 6 & 63] : '=',
                    i + 2 < count ? digit[three & 63] : '='};
    put_bytes(out, four, 4);
  }
}

/* ---- pens ------------------------------------------------------------------------------------ */

static void put_colour(page *out, const char *name, const double colour[4]) {
  char buffer[48];
  if (colour[3] <= 0) {
    snprintf(buffer, sizeof buffer, " %s=\"none\"", name);
    put(out, buffer);
    return;
  }
  snprintf(buffer, sizeof buffer, " %s=\"#%02x%02x%02x\"", name, (unsigned)lround(255 * colour[0]),
           (unsigned)lround(255 * colour[1]), (unsigned)lround(255 * colour[2]));
  put(out, buffer);
  if (colour[3] < 1) {
    snprintf(buffer, sizeof buffer, "%s-opacity", name);
    put_attribute(out, buffer, colour[3]);
  }
}

static void put_pen(page *out, const bw_pen *pen) {
  put_colour(out, "fill", pen->fill);
  if (!(pen->stroke[3] > 0 && pen->width > 0))
    return; /* SVG takes none where the attribute is missing */
  put_colour(out, "stroke", pen->stroke);
  put_attribute(out, "stroke-width", pen->width);
  if (pen->round)
    put(out, " stroke-linecap=\"round\" stroke-linejoin=\"round\"");
  if (pen->dash[0] > 0) {
    put(out, " stroke-dasharray=\"");
    for (int k = 0; k < (pen->dash[2] > 0 ? 4 : 2); k++) {
      put(out, k ? " " : "");
      put_number(out, pen->dash[k]);
    }
    put(out, "\"");
  }
}

/* ---- what is drawn --------------------------------------------------------------------------- */

static void put_line(page *out, const bwi_ink *ink) {
  bool open = false;
  put(out, "<path d=\"");
  for (int64_t i = 0; i <= ink->count; i++) {
    const double *p = ink->point + 2 * i;
    if (i == ink->count || isnan(p[0])) {
      put(out, open && ink->closed ? "Z" : "");
      open = false;
    } else {
      put_pair(out, open ? "L" : "M", p[0], p[1]);
      open = true;
    }
  }
  put(out, "\"");
  put_pen(out, &ink->pen);
  put(out, ink->closed && ink->pen.fill[3] > 0 ? " fill-rule=\"evenodd\"/>\n" : "/>\n");
}

static void put_box(page *out, const double box[4]) {
  put_attribute(out, "x", box[0]);
  put_attribute(out, "y", box[1]);
  put_attribute(out, "width", box[2]);
  put_attribute(out, "height", box[3]);
}

static void put_rectangle(page *out, const bwi_ink *ink) {
  put(out, "<rect");
  put_box(out, ink->box);
  if (ink->size > 0)
    put_attribute(out, "rx", ink->size);
  put_pen(out, &ink->pen);
  put(out, "/>\n");
}

static void put_shape(page *out, const bwi_ink *ink, int corners,
                      double corner[BWI_MARKER_CORNERS][2], double x, double y) {
  bool strokes = ink->marker == BW_CROSS || ink->marker == BW_PLUS;
  for (int c = 0; c < corners; c++)
    put_pair(out, c == 0 || (strokes && c == 2) ? "M" : "L", x + corner[c][0], y + corner[c][1]);
  put(out, strokes ? "" : "Z");
}

/* Very many discs: dots of a line without length and with round ends, a fifth of the bytes. */
static void put_dots(page *out, const bwi_ink *ink) {
  put(out, "<path fill=\"none\" stroke-linecap=\"round\"");
  put_colour(out, "stroke", ink->pen.fill);
  put_attribute(out, "stroke-width", ink->size);
  put(out, " d=\"");
  for (int64_t i = 0; i < ink->count; i++)
    if (!isnan(ink->point[2 * i])) {
      put_pair(out, "M", ink->point[2 * i], ink->point[2 * i + 1]);
      put(out, "h0");
    }
  put(out, "\"/>\n");
}

static void put_marker(page *out, const bwi_ink *ink, int corners,
                       double corner[BWI_MARKER_CORNERS][2], double x, double y, const char *note) {
  if (corners == 0) {
    put(out, "<circle");
    put_attribute(out, "cx", x);
    put_attribute(out, "cy", y);
    put_attribute(out, "r", ink->size / 2);
  } else {
    put(out, "<path d=\"");
    put_shape(out, ink, corners, corner, x, y);
    put(out, "\"");
  }
  if (note && *note) {
    put(out, "><title>");
    put_escaped(out, note);
    put(out, corners == 0 ? "</title></circle>\n" : "</title></path>\n");
  } else
    put(out, "/>\n");
}

static void put_markers(page *out, const bwi_ink *ink) {
  enum { MANY = 3000 };
  double corner[BWI_MARKER_CORNERS][2];
  int corners = bwi_marker_corners(ink->marker, ink->size, corner);
  const char *note = ink->text;
  if (corners == 0 && ink->count > MANY && !note && ink->pen.fill[3] > 0) {
    put_dots(out, ink);
    return;
  }
  put(out, "<g");
  put_pen(out, &ink->pen);
  put(out, ">\n");
  for (int64_t i = 0; i < ink->count; i++) {
    if (!isnan(ink->point[2 * i]))
      put_marker(out, ink, corners, corner, ink->point[2 * i], ink->point[2 * i + 1], note);
    note = note ? note + strlen(note) + 1 : NULL;
  }
  put(out, "</g>\n");
}

/* The outlines of a text that begins at 0. */
static bw_status put_outlines(page *out, cairo_t *ruler, const char *text, double x) {
  cairo_new_path(ruler);
  cairo_move_to(ruler, x, 0);
  cairo_text_path(ruler, text);
  cairo_path_t *path = cairo_copy_path(ruler);
  for (int i = 0; i < path->num_data; i += path->data[i].header.length) {
    const cairo_path_data_t *d = &path->data[i];
    switch (d->header.type) {
    case CAIRO_PATH_MOVE_TO:
      /* the one behind the last glyph draws nothing */
      if (i + d->header.length < path->num_data)
        put_pair(out, "M", d[1].point.x, d[1].point.y);
      break;
    case CAIRO_PATH_LINE_TO:
      put_pair(out, "L", d[1].point.x, d[1].point.y);
      break;
    case CAIRO_PATH_CURVE_TO:
      put_pair(out, "C", d[1].point.x, d[1].point.y);
      put_pair(out, " ", d[2].point.x, d[2].point.y);
      put_pair(out, " ", d[3].point.x, d[3].point.y);
      break;
    case CAIRO_PATH_CLOSE_PATH:
      put(out, "Z");
      break;
    }
  }
  bw_status status = bwi_cairo_status(out->context, path->status, "the outlines of a text");
  cairo_path_destroy(path);
  return status;
}

static void put_turn(page *out, const bw_label *label, bool moved) {
  if (!moved && label->angle == 0)
    return;
  put(out, " transform=\"");
  if (moved) {
    put_pair(out, "translate(", label->x, label->y);
    put(out, ")");
  }
  if (label->angle != 0) {
    put(out, "rotate(");
    put_number(out, -label->angle);
    if (!moved) {
      put_pair(out, " ", label->x, label->y);
    }
    put(out, ")");
  }
  put(out, "\"");
}

static bw_status put_text(page *out, cairo_t *ruler, const bwi_ink *ink, bool outlines) {
  const bw_label *label = &ink->label;
  cairo_text_extents_t extents;
  bw_status status = BW_OK;
  if (!ink->text[0])
    return BW_OK;
  bwi_choose_font(ruler, label->size, label->bold);
  cairo_text_extents(ruler, ink->text, &extents);
  if (outlines) {
    put(out, "<path aria-label=\"");
    put_escaped(out, ink->text);
    put(out, "\"");
    put_turn(out, label, true);
    put(out, " d=\"");
    status = put_outlines(out, ruler, ink->text, -label->align * extents.x_advance);
    put(out, "\"");
  } else {
    put(out, "<text");
    put_attribute(out, "x", label->x);
    put_attribute(out, "y", label->y);
    put_attribute(out, "font-size", label->size);
    put(out, label->bold ? " font-weight=\"bold\"" : "");
    put(out, label->align == 0.5 ? " text-anchor=\"middle\""
             : label->align == 1 ? " text-anchor=\"end\""
                                 : "");
    put_turn(out, label, false);
    if (extents.x_advance > 0) {
      put_attribute(out, "textLength", extents.x_advance);
      put(out, " lengthAdjust=\"spacingAndGlyphs\"");
    }
  }
  if (label->halo) {
    put(out, " paint-order=\"stroke\" stroke=\"#fff\" stroke-opacity=\"0.85\" "
             "stroke-linejoin=\"round\"");
    put_attribute(out, "stroke-width", label->size / 4);
  }
  put_colour(out, "fill", label->colour);
  if (outlines)
    put(out, "/>\n");
  else {
    put(out, ">");
    put_escaped(out, ink->text);
    put(out, "</text>\n");
  }
  return status;
}

static void put_image(page *out, const bwi_ink *ink) {
  put(out, "<image");
  put_box(out, ink->box);
  put(out, " preserveAspectRatio=\"none\" href=\"data:image/png;base64,");
  put_base64(out, ink->png, ink->length);
  put(out, "\"/>\n");
}

static void put_enter(page *out, const bwi_ink *ink) {
  put(out, "<svg");
  put_box(out, ink->box);
  put(out, " viewBox=\"");
  put_pair(out, "", ink->view[0], ink->view[1]);
  put_pair(out, " ", ink->view[2], ink->view[3]);
  put(out, "\" overflow=\"hidden\">\n");
}

static bw_status put_ink(page *out, cairo_t *ruler, const bwi_ink *ink, bool outlines) {
  switch (ink->kind) {
  case BWI_LINE:
    put_line(out, ink);
    break;
  case BWI_RECTANGLE:
    put_rectangle(out, ink);
    break;
  case BWI_MARKERS:
    put_markers(out, ink);
    break;
  case BWI_TEXT:
    return put_text(out, ruler, ink, outlines);
  case BWI_IMAGE:
    put_image(out, ink);
    break;
  case BWI_ENTER:
    put_enter(out, ink);
    break;
  case BWI_LEAVE:
    put(out, "</svg>\n");
    break;
  }
  return BW_OK;
}

static void put_head(page *out, const bw_canvas *canvas) {
  put(out, "<svg xmlns=\"http://www.w3.org/2000/svg\"");
  put_attribute(out, "width", canvas->width);
  put_attribute(out, "height", canvas->height);
  put_pair(out, " viewBox=\"0 0 ", canvas->width, canvas->height);
  put(out, "\" font-family=\"DejaVu Sans,Verdana,sans-serif\"");
  if (canvas->name[0]) {
    put(out, " role=\"img\" aria-label=\"");
    put_escaped(out, canvas->name);
    put(out, "\"");
  }
  put(out, ">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
}

bw_status bw_canvas_svg(bw_context *context, const bw_canvas *canvas, bool outlines, char **text,
                        size_t *length) {
  page out = {.context = context};
  cairo_t *ruler = NULL;
  bw_status status = BW_OK;
  *text = NULL;
  *length = 0;
  BW_TRY(bwi_ruler_open(context, &ruler));
  put_head(&out, canvas);
  for (size_t i = 0; i < canvas->count; i++) {
    BW_TRY(put_ink(&out, ruler, &canvas->ink[i], outlines));
    BW_TRY(bw_check_cancel(context));
  }
  for (int i = 0; i < canvas->depth; i++)
    put(&out, "</svg>\n");
  put(&out, "</svg>\n");
  BW_TRY(bwi_cairo_status(context, cairo_status(ruler), "the drawing"));
  if (out.full) {
    status = BW_MEMORY;
    goto done;
  }
  *text = out.text;
  *length = out.count;
  out.text = NULL;
done:
  bw_free(out.text);
  if (ruler)
    cairo_destroy(ruler);
  return status;
}

/* ---- files ----------------------------------------------------------------------------------- */

static bool ends_in(const char *path, const char *ending) {
  size_t length = strlen(path), tail = strlen(ending);
  if (length < tail)
    return false;
  for (size_t i = 0; i < tail; i++)
    if (tolower((unsigned char)path[length - tail + i]) != ending[i])
      return false;
  return true;
}

bw_status bw_canvas_write(bw_context *context, const bw_canvas *canvas, double scale, bool outlines,
                          const char *path) {
  bw_writer *writer = NULL;
  char *text = NULL;
  size_t length;
  bw_status status = BW_OK;
  if (!(scale >= 0.1 && scale <= 8))
    return bw_fail(context, BW_INVALID, "a scale of %g: 0.1 to 8 are possible", scale);
  if (ends_in(path, ".png"))
    return bwi_canvas_png(context, canvas, scale, path);
  if (!ends_in(path, ".svg"))
    return bw_fail(context, BW_UNSUPPORTED, "%s: a drawing is written as .svg or .png", path);
  BW_TRY(bw_canvas_svg(context, canvas, outlines, &text, &length));
  BW_TRY(bw_writer_open(context, path, &writer));
  bw_writer_bytes(writer, text, length); /* the first error sticks */
  status = bw_writer_commit(writer);
done:
  bw_free(text);
  return status;
}
