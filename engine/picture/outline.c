/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A flat picture of an outline: regions in pale colours, edges in a colour for every tag with a
 * legend, and on request the numbers by which edges are called. Loops are painted from the outside
 * in, so that a hole is white and what lies in it is seen. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/io.h"
#include "picture/internal.h"

static const double region_colour[6][3] = {{0.86, 0.90, 0.95}, {0.96, 0.90, 0.80},
                                           {0.87, 0.94, 0.85}, {0.95, 0.86, 0.88},
                                           {0.90, 0.87, 0.95}, {0.93, 0.93, 0.84}};
static const double tag_colour[8][3] = {{0.15, 0.20, 0.30}, {0.80, 0.20, 0.15}, {0.10, 0.45, 0.75},
                                        {0.20, 0.55, 0.25}, {0.75, 0.45, 0.05}, {0.50, 0.25, 0.65},
                                        {0.05, 0.55, 0.55}, {0.70, 0.20, 0.50}};

enum { MAX_TAGS = 20 }; /* in the legend */

/* x right, y up, metres to pixels. */
typedef struct frame {
  double scale, middle[2], centre[2];
} frame;

static void place(const frame *f, const double *x, double pixel[2]) {
  pixel[0] = f->centre[0] + f->scale * (x[0] - f->middle[0]);
  pixel[1] = f->centre[1] - f->scale * (x[1] - f->middle[1]);
}

static const double *point_of(const bw_outline *o, int32_t segment, int which) {
  return o->point + 2 * (int64_t)o->segment[segment].point[which];
}

static void add_segment(cairo_t *cairo, const frame *f, const bw_outline *o, int32_t s) {
  double a[2], b[2], c[2];
  place(f, point_of(o, s, 3), c);
  if (o->segment[s].point[1] < 0) {
    cairo_line_to(cairo, c[0], c[1]);
    return;
  }
  place(f, point_of(o, s, 1), a);
  place(f, point_of(o, s, 2), b);
  cairo_curve_to(cairo, a[0], a[1], b[0], b[1], c[0], c[1]);
}

static void start_at(cairo_t *cairo, const frame *f, const bw_outline *o, int32_t s) {
  double a[2];
  place(f, point_of(o, s, 0), a);
  cairo_move_to(cairo, a[0], a[1]);
}

static int depth_of(const bw_outline *o, int32_t loop) {
  int depth = 0;
  while ((loop = o->loop[loop].parent) >= 0)
    depth++;
  return depth;
}

static void fill_loops(cairo_t *cairo, const frame *f, const bw_outline *o) {
  bool more = true;
  for (int depth = 0; more; depth++) {
    more = false;
    for (int32_t l = 0; l < o->loop_count; l++) {
      const bw_loop *loop = &o->loop[l];
      int own = depth_of(o, l);
      more = more || own > depth;
      if (own != depth)
        continue;
      start_at(cairo, f, o, loop->first);
      for (int32_t s = loop->first; s < loop->first + loop->count; s++)
        add_segment(cairo, f, o, s);
      cairo_close_path(cairo);
      const double *c = region_colour[loop->region < 0 ? 0 : loop->region % 6];
      if (loop->region < 0)
        cairo_set_source_rgb(cairo, 1, 1, 1);
      else
        cairo_set_source_rgb(cairo, c[0], c[1], c[2]);
      cairo_fill(cairo);
    }
  }
}

static void draw_edges(cairo_t *cairo, const frame *f, const bw_outline *o, double width) {
  cairo_set_line_width(cairo, width);
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  for (int32_t s = 0; s < o->segment_count; s++) {
    const double *c = tag_colour[o->segment[s].tag % 8];
    double at[2];
    cairo_set_source_rgb(cairo, c[0], c[1], c[2]);
    start_at(cairo, f, o, s);
    add_segment(cairo, f, o, s);
    cairo_stroke(cairo);
    place(f, point_of(o, s, 0), at);
    cairo_arc(cairo, at[0], at[1], 1.4 * width, 0, 2 * acos(-1));
    cairo_fill(cairo);
  }
}

/* Beside the middle of each edge, on its right: outside of the material. */
static void write_numbers(cairo_t *cairo, const frame *f, const bw_outline *o, double size) {
  cairo_set_source_rgb(cairo, 0.2, 0.2, 0.2);
  for (int32_t s = 0; s < o->segment_count; s++) {
    double x[2], d[2], at[2];
    char text[16];
    bw_outline_evaluate(o, s, 0.5, x, d, NULL);
    double length = hypot(d[0], d[1]);
    place(f, x, at);
    if (length > 0) {
      at[0] += size * d[1] / length;
      at[1] += size * d[0] / length;
    }
    snprintf(text, sizeof text, "%d", s + 1);
    bwi_draw_text(cairo, at[0], at[1] + 0.35 * size, 0.5, size, false, true, text);
  }
}

static int32_t legend_count(const bw_outline *o) {
  return o->tag_count < 2 ? 0 : o->tag_count < MAX_TAGS ? o->tag_count : MAX_TAGS;
}

static void draw_legend(cairo_t *cairo, const bw_outline *o, double left, double top, double size) {
  for (int32_t t = 0; t < legend_count(o); t++) {
    double y = top + 1.5 * size * t;
    const double *c = tag_colour[t % 8];
    cairo_set_source_rgb(cairo, c[0], c[1], c[2]);
    cairo_rectangle(cairo, left, y - 0.4 * size, 1.4 * size, 0.3 * size);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, 0.1, 0.1, 0.1);
    bwi_draw_text(cairo, left + 2 * size, y, 0, size, false, false, o->tag[t].text);
  }
}

bw_status bw_picture_outline(bw_context *context, const bw_outline *outline, int width, int height,
                             bool numbers, const char *path) {
  bw_outline_measures m;
  bw_status status = bw_outline_measure(context, outline, -1, &m);
  if (status != BW_OK)
    return status;
  if (width < 16 || height < 16 || width > 20000 || height > 20000)
    return bw_fail(context, BW_INVALID,
                   "a picture of %d x %d pixels: 16 to 20000 on each side expected", width, height);
  double size = fmax(10, fmin(width, height) / 45.0), margin = 2.5 * size;
  double legend = legend_count(outline) ? fmin(14 * size, 0.3 * width) : 0;
  double drawing[2] = {fmax(1, width - 2 * margin - legend), fmax(1, height - 2 * margin)};
  frame f = {.scale = fmin(drawing[0] / (m.max[0] - m.min[0]), drawing[1] / (m.max[1] - m.min[1]))};
  for (int k = 0; k < 2; k++) {
    f.middle[k] = (m.min[k] + m.max[k]) / 2;
    f.centre[k] = margin + drawing[k] / 2;
  }
  cairo_surface_t *canvas = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  cairo_t *cairo = cairo_create(canvas);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  fill_loops(cairo, &f, outline);
  draw_edges(cairo, &f, outline, fmax(1.5, size / 8));
  if (numbers)
    write_numbers(cairo, &f, outline, 0.8 * size);
  if (legend > 0)
    draw_legend(cairo, outline, width - legend, margin, size);
  cairo_status_t drawn = cairo_status(cairo);
  status = drawn == CAIRO_STATUS_SUCCESS ? bwi_write_png(context, canvas, path)
           : drawn == CAIRO_STATUS_NO_MEMORY
               ? bw_fail(context, BW_MEMORY, "%s: no memory for the picture", path)
               : bw_fail(context, BW_INTERNAL, "%s: %s", path, cairo_status_to_string(drawn));
  cairo_destroy(cairo);
  cairo_surface_destroy(canvas);
  return status;
}
