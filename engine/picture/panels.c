/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Grids side by side: every panel is rendered on its own, with the scale that suits all, and put
 * onto one canvas with a title above, a colour bar to the right or a legend of materials below. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "picture/panels.h"

#define CREASE 0.6981317007977318
enum { MAX_PANELS = 64, MAX_PIXELS = 16384, MIN_PIXELS = 64, LEGEND = 12 };

void bw_grid_picture_options_default(bw_grid_picture_options *options) {
  memset(options, 0, sizeof *options);
  options->width = 640;
  options->height = 560;
  options->up[2] = 1;
  options->zoom = 1;
  options->scale = 1;
  options->deformation = 1;
  options->edges = true;
}

static bw_status check(bwi_panel_sheet *s) {
  const bw_grid_picture_options *o = s->options;
  if (s->count < 1 || s->count > MAX_PANELS)
    return bw_fail(s->context, BW_INVALID, "%d panels: 1 to %d can be drawn", s->count, MAX_PANELS);
  if (o->columns < 0)
    return bw_fail(s->context, BW_INVALID, "%d panels in a row: 0 or more expected", o->columns);
  s->columns = o->columns > 0 ? o->columns : s->count < 4 ? s->count : 4;
  s->columns = s->columns < s->count ? s->columns : s->count;
  s->rows = (s->count + s->columns - 1) / s->columns;
  if (o->width < MIN_PIXELS || o->height < MIN_PIXELS ||
      (int64_t)o->width * s->columns > MAX_PIXELS - 400 ||
      (int64_t)o->height * s->rows > MAX_PIXELS - 400)
    return bw_fail(s->context, BW_INVALID,
                   "%d x %d panels of %d x %d pixels: a panel needs %d at least, all have room in "
                   "%d x %d",
                   s->columns, s->rows, o->width, o->height, MIN_PIXELS, MAX_PIXELS - 400,
                   MAX_PIXELS - 400);
  if (!(o->zoom > 0) || !(o->zoom <= 1e4))
    return bw_fail(s->context, BW_INVALID, "the zoom %g is not between 0 and 10000", o->zoom);
  if (!isfinite(o->scale) || o->scale == 0)
    return bw_fail(s->context, BW_INVALID, "the scale %g of the values must be finite and not 0",
                   o->scale);
  if (!isfinite(o->min) || !isfinite(o->max) || o->min > o->max)
    return bw_fail(s->context, BW_INVALID, "the colour range %g to %g is not ascending", o->min,
                   o->max);
  if (!isfinite(o->deformation))
    return bw_fail(s->context, BW_INVALID, "the deformation factor is not finite");
  return BW_OK;
}

/* ---- colours --------------------------------------------------------------------------------- */

/* One range for all. Values inside count too: they are what the panels compare. */
static void find_range(bwi_panel_sheet *s) {
  const bw_grid_picture_options *o = s->options;
  s->value_min = INFINITY;
  s->value_max = -INFINITY;
  for (int i = 0; i < s->count; i++) {
    const bw_grid_panel *panel = &s->panel[i];
    int64_t n = panel->on_elements ? panel->grid->element_count : panel->grid->node_count;
    for (int64_t k = 0; panel->value && k < n; k++) {
      if (!isfinite(panel->value[k])) {
        s->missing = true;
        continue;
      }
      s->value_min = fmin(s->value_min, panel->value[k]);
      s->value_max = fmax(s->value_max, panel->value[k]);
    }
  }
  s->valued = s->value_min <= s->value_max;
  bool given = o->min != 0 || o->max != 0;
  s->min = given ? o->min : s->valued ? s->value_min : 0;
  s->max = given ? o->max : s->valued ? s->value_max : 1;
  for (int i = 0; i < s->count; i++) {
    bwi_solid *body = &s->solid[i][0];
    bool wide = s->max > s->min; /* one value only: the middle of the colours */
    body->low = wide ? s->min : s->min - 1;
    body->high = wide ? s->max : s->min + 1;
  }
}

/* ---- camera ---------------------------------------------------------------------------------- */

static void seen_frame(const bwi_panel_sheet *s, double frame[4]) {
  frame[0] = 24 * s->u;
  frame[1] = 44 * s->u;
  frame[2] = s->options->width - 24 * s->u;
  frame[3] = s->options->height - 24 * s->u;
}

static bw_status place_camera(bwi_panel_sheet *s) {
  const bw_grid_picture_options *o = s->options;
  double direction[3], frame[4], bounds[4] = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  bool box = false;
  memcpy(direction, o->direction, sizeof direction);
  if (direction[0] == 0 && direction[1] == 0 && direction[2] == 0)
    bwi_view_usual(o->up, 0, false, direction);
  bw_status status = bwi_view_axes(s->context, direction, o->up, &s->view);
  if (status != BW_OK)
    return status;
  for (int d = 0; d < 3; d++)
    box |= o->view_min[d] != 0 || o->view_max[d] != 0;
  for (int c = 0; c < 8 && box; c++) {
    double corner[3];
    for (int d = 0; d < 3; d++)
      corner[d] = c >> d & 1 ? o->view_max[d] : o->view_min[d];
    bwi_view_bound(&s->view, 1, corner, bounds);
  }
  for (int i = 0; i < s->count && !box; i++)
    for (int k = 0; k < 2; k++)
      bwi_view_bound(&s->view, s->solid[i][k].point_count, s->solid[i][k].point, bounds);
  seen_frame(s, frame);
  bwi_view_fit(&s->view, bounds, frame, o->zoom);
  return BW_OK;
}

/* ---- canvas ---------------------------------------------------------------------------------- */

static bw_status draw_text(bwi_panel_sheet *s, cairo_t *cairo, double x, double y, double width,
                           double size, const char *text) {
  char *clean = bwi_clean_text(s->context, text);
  if (!clean)
    return BW_MEMORY;
  cairo_set_source_rgb(cairo, 0.10, 0.11, 0.15);
  bwi_draw_title(cairo, x, y, width, size, clean);
  bw_free(clean);
  return BW_OK;
}

static bw_status draw_panel(bwi_panel_sheet *s, int which, cairo_t *cairo) {
  const bw_grid_picture_options *o = s->options;
  bwi_solid *solid = s->solid[which];
  bwi_image image = {.width = o->width, .height = o->height};
  cairo_surface_t *part = NULL;
  bw_status status;
  double x = (double)(which % s->columns) * o->width;
  double y = s->head + (double)(which / s->columns) * o->height;
  for (int k = 0; k < 2; k++)
    BW_TRY(bwi_solid_prepare(s->context, &solid[k], &s->view, CREASE, 0));
  if (solid[1].point_count > 0)
    bwi_solid_behind(&solid[1], 1, solid, 1 + 0.5 * o->width);
  BW_TRY(bwi_render(s->context, 2, solid, &image));
  BW_TRY(bwi_occlude(s->context, &image, 0.035 * fmin(o->width, o->height)));
  part = cairo_image_surface_create(CAIRO_FORMAT_RGB24, o->width, o->height);
  if (cairo_surface_status(part) != CAIRO_STATUS_SUCCESS)
    BW_TRY(bw_fail(s->context, BW_MEMORY, "no memory for a panel of %d x %d pixels", o->width,
                   o->height));
  bwi_compose(&image, part);
  cairo_set_source_surface(cairo, part, x, y);
  cairo_rectangle(cairo, x, y, o->width, o->height);
  cairo_fill(cairo);
  cairo_set_source_rgb(cairo, 0.86, 0.88, 0.90); /* between panels */
  cairo_set_line_width(cairo, 1);
  if (which % s->columns > 0) {
    cairo_move_to(cairo, x + 0.5, y + 12 * s->u);
    cairo_line_to(cairo, x + 0.5, y + o->height - 12 * s->u);
    cairo_stroke(cairo);
  }
  if (s->panel[which].title)
    BW_TRY(draw_text(s, cairo, x + 24 * s->u, y + 28 * s->u, o->width - 48 * s->u, 18 * s->u,
                     s->panel[which].title));
  if (which == (s->rows - 1) * s->columns)
    bwi_draw_triad(cairo, &s->view, x + 40 * s->u, y + o->height - 40 * s->u, 24 * s->u, s->u);
done:
  if (part)
    cairo_surface_destroy(part);
  bwi_image_clear(&image);
  for (int k = 0; k < 2; k++) /* panels may be many and large */
    bwi_solid_clear(&solid[k]);
  return status;
}

/* Squares with the materials' names, as many as there is room for. */
static bw_status draw_legend(bwi_panel_sheet *s, cairo_t *cairo) {
  const bw_grid_picture_options *o = s->options;
  double x = 24 * s->u, y = s->high_pixels - 0.5 * s->foot, size = 14 * s->u;
  for (int32_t m = 1; m <= s->max_material && m <= LEGEND; m++) {
    char text[80];
    unsigned char rgb[3];
    cairo_text_extents_t extents;
    if (m <= o->name_count && o->name[m - 1])
      snprintf(text, sizeof text, "%.60s", o->name[m - 1]);
    else
      snprintf(text, sizeof text, "%d", (int)m);
    char *clean = bwi_clean_text(s->context, text);
    if (!clean)
      return BW_MEMORY;
    bw_category_colour(m - 1, rgb);
    cairo_set_source_rgb(cairo, rgb[0] / 255., rgb[1] / 255., rgb[2] / 255.);
    cairo_rectangle(cairo, x, y - 0.5 * size, size, size);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, 0.13, 0.15, 0.19);
    bwi_draw_text(cairo, x + 1.5 * size, y + 0.36 * size, 0, size, false, false, clean);
    cairo_text_extents(cairo, clean, &extents);
    bw_free(clean);
    x += 2.5 * size + extents.x_advance + 8 * s->u;
    if (x > s->wide - 80 * s->u)
      break;
  }
  return BW_OK;
}

static bw_status draw(bwi_panel_sheet *s, cairo_t *cairo) {
  const bw_grid_picture_options *o = s->options;
  bw_status status = BW_OK;
  cairo_pattern_t *shade = cairo_pattern_create_linear(0, s->head, 0, s->high_pixels - s->foot);
  cairo_pattern_add_color_stop_rgb(shade, 0, 1, 1, 1); /* as bwi_compose has it behind panels */
  cairo_pattern_add_color_stop_rgb(shade, 1, 242 / 255., 244 / 255., 247 / 255.);
  cairo_set_source(cairo, shade);
  cairo_paint(cairo);
  cairo_pattern_destroy(shade);
  for (int i = 0; i < s->count; i++)
    BW_TRY(draw_panel(s, i, cairo));
  if (o->title && o->title[0])
    BW_TRY(draw_text(s, cairo, 24 * s->u, 34 * s->u, s->wide - 48 * s->u, 22 * s->u, o->title));
  if (s->bar > 0) {
    char *unit = o->unit ? bwi_clean_text(s->context, o->unit) : NULL;
    if (o->unit && !unit)
      return BW_MEMORY;
    double a = o->scale * s->min, b = o->scale * s->max;
    bwi_bar bar = {.low = fmin(a, b),
                   .high = fmax(a, b),
                   .largest = NAN,
                   .unit = unit,
                   .missing = s->missing,
                   .below = (o->scale > 0 ? s->value_min < s->min : s->value_max > s->max),
                   .beyond = (o->scale > 0 ? s->value_max > s->max : s->value_min < s->min)};
    double h = s->high_pixels;
    bwi_bar_draw(cairo, &bar, s->wide - 0.72 * s->bar, 0.26 * h, 0.84 * h, s->wide - 16 * s->u,
                 s->u);
    bw_free(unit);
  }
  if (s->foot > 0)
    BW_TRY(draw_legend(s, cairo));
done:
  return status;
}

static bw_status make(bwi_panel_sheet *s, const char *path) {
  const bw_grid_picture_options *o = s->options;
  cairo_surface_t *canvas = NULL;
  cairo_t *cairo = NULL;
  bw_status status;
  for (int i = 0; i < s->count; i++)
    BW_TRY(bwi_panel_solids(s, i));
  find_range(s);
  s->u = fmax(fmin(o->width / 640., o->height / 560.), 0.5);
  s->head = o->title && o->title[0] ? floor(48 * s->u) : 0;
  s->foot = s->max_material > 1 ? floor(36 * s->u) : 0;
  s->bar = s->valued ? floor(170 * s->u) : 0;
  s->wide = o->width * s->columns + (int)s->bar;
  s->high_pixels = o->height * s->rows + (int)(s->head + s->foot);
  BW_TRY(place_camera(s));
  canvas = cairo_image_surface_create(CAIRO_FORMAT_RGB24, s->wide, s->high_pixels);
  cairo = cairo_create(canvas);
  if (cairo_status(cairo) == CAIRO_STATUS_SUCCESS)
    BW_TRY(draw(s, cairo));
  if (cairo_status(cairo) != CAIRO_STATUS_SUCCESS) {
    bool memory = cairo_status(cairo) == CAIRO_STATUS_NO_MEMORY;
    BW_TRY(bw_fail(s->context, memory ? BW_MEMORY : BW_INTERNAL, "drawing %s: %s", path,
                   cairo_status_to_string(cairo_status(cairo))));
  }
  BW_TRY(bwi_write_png(s->context, canvas, path));
done:
  if (cairo)
    cairo_destroy(cairo);
  if (canvas)
    cairo_surface_destroy(canvas);
  return status;
}

bw_status bw_picture_grids(bw_context *context, int count, const bw_grid_panel *panel,
                           const bw_grid_picture_options *options, const char *path) {
  bw_grid_picture_options usual;
  if (!options) {
    bw_grid_picture_options_default(&usual);
    options = &usual;
  }
  bwi_panel_sheet s = {.context = context, .options = options, .count = count, .panel = panel};
  bw_status status = check(&s);
  if (status != BW_OK)
    return status;
  s.solid = (bwi_solid(*)[2])bw_calloc(context, (size_t)count, sizeof *s.solid);
  s.category = BW_NEW0(context, int32_t *, count);
  s.value = BW_NEW0(context, double *, count);
  status = s.solid && s.category && s.value ? make(&s, path) : BW_MEMORY;
  for (int i = 0; i < count; i++) {
    if (s.solid)
      for (int k = 0; k < 2; k++)
        bwi_solid_clear(&s.solid[i][k]);
    if (s.category)
      bw_free(s.category[i]);
    if (s.value)
      bw_free(s.value[i]);
  }
  bw_free(s.solid);
  bw_free(s.category);
  bw_free(s.value);
  return status;
}
