/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Text, the axes' triad and the mark of the largest value, drawn by Cairo over the picture. */
#include <math.h>

#include "picture/internal.h"

void bwi_draw_text(cairo_t *cairo, double x, double y, double align, double size, bool bold,
                   bool halo, const char *text) {
  cairo_text_extents_t extents;
  bwi_choose_font(cairo, size, bold);
  cairo_text_extents(cairo, text, &extents);
  cairo_move_to(cairo, x - align * extents.x_advance, y);
  if (halo) {
    cairo_pattern_t *source = cairo_pattern_reference(cairo_get_source(cairo));
    cairo_text_path(cairo, text);
    cairo_set_source_rgba(cairo, 1, 1, 1, 0.85);
    cairo_set_line_width(cairo, size / 4);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(cairo);
    cairo_set_source(cairo, source);
    cairo_pattern_destroy(source);
    cairo_move_to(cairo, x - align * extents.x_advance, y);
  }
  cairo_show_text(cairo, text);
  cairo_new_path(cairo);
}

void bwi_draw_title(cairo_t *cairo, double x, double y, double width, double size,
                    const char *text) {
  cairo_text_extents_t extents;
  bwi_choose_font(cairo, size, true);
  cairo_text_extents(cairo, text, &extents);
  if (extents.x_advance > width) { /* down to two thirds, then cut at the frame */
    size *= fmax(2. / 3, width / extents.x_advance);
  }
  cairo_save(cairo);
  cairo_rectangle(cairo, x, y - 2 * size, width, 3 * size);
  cairo_clip(cairo);
  bwi_draw_text(cairo, x, y, 0, size, true, false, text);
  cairo_restore(cairo);
}

void bwi_draw_line_key(cairo_t *cairo, double x, double y, double u, const char *label) {
  cairo_set_source_rgb(cairo, BWI_LINE_COLOUR);
  cairo_set_line_width(cairo, 5 * u);
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  cairo_move_to(cairo, x, y - 5 * u);
  cairo_line_to(cairo, x + 30 * u, y - 5 * u);
  cairo_stroke(cairo);
  cairo_set_source_rgb(cairo, 0.30, 0.33, 0.38);
  bwi_draw_text(cairo, x + 42 * u, y, 0, 14 * u, false, true, label);
}

/* ---- triad ----------------------------------------------------------------------------------- */

void bwi_draw_triad(cairo_t *cairo, const bwi_view *view, double x, double y, double length,
                    double u) {
  static const double colour[3][3] = {{0.80, 0.22, 0.22}, {0.20, 0.56, 0.27}, {0.18, 0.38, 0.78}};
  static const char *const name[3] = {"x", "y", "z"};
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 3; i++) /* the one that points away first */
    for (int j = i + 1; j < 3; j++)
      if (view->axis[2][order[j]] < view->axis[2][order[i]]) {
        int swap = order[i];
        order[i] = order[j];
        order[j] = swap;
      }
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  for (int i = 0; i < 3; i++) {
    int axis = order[i];
    double dx = view->axis[0][axis] * length, dy = -view->axis[1][axis] * length;
    double size = hypot(dx, dy), ux = size > 0 ? dx / size : 0, uy = size > 0 ? dy / size : 0;
    double head = fmin(9 * u, size), half = 0.45 * head;
    cairo_set_source_rgb(cairo, colour[axis][0], colour[axis][1], colour[axis][2]);
    cairo_set_line_width(cairo, 2.6 * u);
    if (size > 3 * u) {
      cairo_move_to(cairo, x, y);
      cairo_line_to(cairo, x + dx - 0.8 * head * ux, y + dy - 0.8 * head * uy);
      cairo_stroke(cairo);
      cairo_move_to(cairo, x + dx, y + dy);
      cairo_line_to(cairo, x + dx - head * ux - half * uy, y + dy - head * uy + half * ux);
      cairo_line_to(cairo, x + dx - head * ux + half * uy, y + dy - head * uy - half * ux);
      cairo_fill(cairo);
      bwi_draw_text(cairo, x + dx + 10 * u * ux, y + dy + 10 * u * uy + 4.5 * u, 0.5, 13 * u, true,
                    false, name[axis]);
    } else { /* towards or away from the viewer: a dot or a ring */
      cairo_arc(cairo, x, y, 4.5 * u, 0, 6.283185307179586);
      if (view->axis[2][axis] > 0)
        cairo_fill(cairo);
      else
        cairo_stroke(cairo);
      bwi_draw_text(cairo, x - 11 * u, y + 15 * u, 0.5, 13 * u, true, false, name[axis]);
    }
  }
}

/* ---- mark ------------------------------------------------------------------------------------ */

void bwi_draw_mark(cairo_t *cairo, const double pixel[3], bool hidden, const double frame[4],
                   double u, const char *label) {
  cairo_text_extents_t extents;
  double radius = 7 * u, size = 15 * u;
  bwi_choose_font(cairo, size, true);
  cairo_text_extents(cairo, label, &extents);
  /* away from the middle of the frame, where there is more likely room */
  double out_x = pixel[0] < (frame[0] + frame[2]) / 2 ? -1 : 1;
  double out_y = pixel[1] < (frame[1] + frame[3]) / 2 ? -1 : 1;
  double x = pixel[0] + out_x * 46 * u, y = pixel[1] + out_y * 40 * u;
  double min = frame[0] + (out_x < 0 ? extents.x_advance : 0);
  double max = frame[2] - (out_x > 0 ? extents.x_advance : 0);
  x = fmin(fmax(x, min), max);
  y = fmin(fmax(y, frame[1] + size), frame[3] - size / 2);
  double dx = x - pixel[0], dy = y - pixel[1], away = hypot(dx, dy);
  const double dash[2] = {3 * u, 3 * u};
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
  for (int pass = 0; pass < 2; pass++) { /* a pale line under a dark one */
    cairo_set_source_rgba(cairo, pass ? 0.10 : 1, pass ? 0.11 : 1, pass ? 0.15 : 1, pass ? 1 : 0.8);
    cairo_set_line_width(cairo, (pass ? 1.6 : 4) * u);
    if (hidden && pass)
      cairo_set_dash(cairo, dash, 2, 0);
    cairo_arc(cairo, pixel[0], pixel[1], radius, 0, 6.283185307179586);
    cairo_stroke(cairo);
    if (away > radius) {
      cairo_move_to(cairo, pixel[0] + radius * dx / away, pixel[1] + radius * dy / away);
      cairo_line_to(cairo, x, y);
      cairo_stroke(cairo);
    }
    cairo_set_dash(cairo, NULL, 0, 0);
  }
  cairo_set_source_rgb(cairo, 0.10, 0.11, 0.15);
  bwi_draw_text(cairo, x + out_x * 4 * u,
                y + (out_y > 0 ? 0.95 : -0.2) * size + (out_y > 0 ? 0 : 0), out_x < 0 ? 1 : 0, size,
                true, true, label);
}
