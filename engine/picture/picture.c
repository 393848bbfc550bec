/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A result as a picture: the stage is set here, drawn by the rasteriser, labelled by Cairo, and
 * written whole or not at all. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "picture/internal.h"

/* Facets that meet at less are shaded as one smooth surface: 40 degrees. */
#define CREASE 0.6981317007977318
/* The longest arrow, and the largest displacement when the factor is chosen here. */
#define ARROW_SIZE 0.2
#define DEFORMATION_SIZE 0.05
/* The radius of lines. */
#define LINE_RADIUS 0.003
enum {
  MIN_PIXELS = 64,
  MAX_PIXELS = 16384,
  MAX_ARROWS = 10000,
  MAX_LINE_POINTS = 1000000,
  MAX_CHECKED = 6,
  SOLIDS = 4
};

void bw_picture_options_default(bw_picture_options *options) {
  memset(options, 0, sizeof *options);
  options->width = 1200;
  options->height = 900;
  options->up[2] = 1;
  options->zoom = 1;
  options->scale = 1;
}

static bw_status check_options(bw_context *context, const bw_picture_options *options) {
  if (options->width < MIN_PIXELS || options->width > MAX_PIXELS || options->height < MIN_PIXELS ||
      options->height > MAX_PIXELS)
    return bw_fail(context, BW_INVALID, "a picture of %d x %d pixels: each side must have %d to %d",
                   options->width, options->height, MIN_PIXELS, MAX_PIXELS);
  if (!(options->zoom > 0) || !(options->zoom <= 1e4))
    return bw_fail(context, BW_INVALID, "the zoom %g is not between 0 and 10000", options->zoom);
  if (!isfinite(options->scale) || options->scale == 0)
    return bw_fail(context, BW_INVALID, "the scale %g of the values must be finite and not 0",
                   options->scale);
  if (!isfinite(options->min) || !isfinite(options->max) || options->min > options->max)
    return bw_fail(context, BW_INVALID, "the colour range %g to %g is not ascending", options->min,
                   options->max);
  if (!isfinite(options->deformation))
    return bw_fail(context, BW_INVALID, "the deformation factor is not finite");
  if (options->arrow_count < 0 || options->arrow_count > MAX_ARROWS ||
      (options->arrow_count > 0 && !options->arrow))
    return bw_fail(context, BW_INVALID, "%d arrows: 0 to %d can be drawn", options->arrow_count,
                   MAX_ARROWS);
  int64_t points = 0;
  for (int i = 0; i < options->line_count; i++)
    points += options->line[i].count;
  if (points > MAX_LINE_POINTS)
    return bw_fail(context, BW_INVALID, "lines of %lld points: at most %d can be drawn",
                   (long long)points, MAX_LINE_POINTS);
  if (options->label_count < 0 || (options->label_count > 0 && !options->label))
    return bw_fail(context, BW_INVALID, "%d labels without a list", options->label_count);
  return BW_OK;
}

/* ---- the values ------------------------------------------------------------------------------ */

typedef struct range {
  double min, max;             /* of the colours */
  double value_min, value_max; /* of the values, nan when there is none */
  int64_t largest_at;          /* its point or facet, or -1 */
  bool any, missing;
} range;

static range range_of(const double *value, int64_t count, double min, double max) {
  range r = {min, max, NAN, NAN, -1, false, false};
  for (int64_t i = 0; i < count; i++) {
    if (!isfinite(value[i])) {
      r.missing = true;
      continue;
    }
    if (!r.any || value[i] > r.value_max) {
      r.value_max = value[i];
      r.largest_at = i;
    }
    if (!r.any || value[i] < r.value_min)
      r.value_min = value[i];
    r.any = true;
  }
  if (min == 0 && max == 0 && r.any) {
    r.min = r.value_min;
    r.max = r.value_max;
  }
  return r;
}

/* ---- the stage ------------------------------------------------------------------------------- */

typedef struct stage {
  const bw_surface *surface;
  const bw_picture_options *options;
  bwi_view view;
  double diagonal, factor; /* of the box; on the displacement */
  int longest;             /* side of the box */
  bwi_solid solid[SOLIDS]; /* body, arrows, lines, ghost; unused ones hold no facet */
  double *arrow_end;
  range range;
  double direction[3]; /* to the viewer */
  double frame[4], u;  /* the body's part of the picture; a pixel of a 1200 x 900 one */
  bwi_image image;
} stage;

/* Where the largest value is, and the vector area of the facets there. */
static void largest_place(const stage *s, double at[3], double normal[3]) {
  const bwi_solid *body = &s->solid[0];
  int64_t which = s->range.largest_at;
  memset(at, 0, 3 * sizeof *at);
  memset(normal, 0, 3 * sizeof *normal);
  for (int64_t f = 0; f < body->triangle_count; f++) {
    const int32_t *t = body->triangle + 3 * f;
    if (body->on_facets ? f != which : t[0] != which && t[1] != which && t[2] != which)
      continue;
    const double *x = body->point + 3 * (size_t)t[0], *p = body->point + 3 * (size_t)t[1];
    const double *q = body->point + 3 * (size_t)t[2];
    double a[3], b[3], n[3];
    for (int k = 0; k < 3; k++) {
      a[k] = (p[k] - x[k]) / s->diagonal;
      b[k] = (q[k] - x[k]) / s->diagonal;
      at[k] = (x[k] + p[k] + q[k]) / 3;
    }
    bw_cross(a, b, n);
    for (int k = 0; k < 3; k++)
      normal[k] += body->inverted ? -n[k] : n[k];
  }
  if (!body->on_facets)
    memcpy(at, body->point + 3 * which, 3 * sizeof *at);
}

/* How well the arrows show from a direction, 0 to 1: seen from the side, ends not hidden. */
static double arrows_show(const stage *s, const double direction[3]) {
  double all = 0, shown = 0, first;
  int count = s->arrow_end ? s->options->arrow_count : 0;
  for (int i = 0; i < count && i < MAX_CHECKED; i++) {
    const double *force = s->options->arrow[i].force, *at = s->options->arrow[i].at;
    const double *end = s->arrow_end + 3 * (size_t)i;
    double size = bw_norm(force), across[3], near_body[3];
    for (int k = 0; k < 3; k++)
      near_body[k] = end[k] + 0.6 * (at[k] - end[k]);
    all += size;
    if (!(size > 0) ||
        bwi_solid_crossings(&s->solid[0], near_body, direction, 1e-4 * s->diagonal, &first) > 0)
      continue;
    bw_cross(force, direction, across);
    shown += bw_norm(across) / bw_norm(direction);
  }
  return all > 0 ? shown / all : 0;
}

/* The best of eight views around the body from above, or else from below, that show the largest
 * value: not edge-on, and with nothing in front. The usual view wins when it is about as good. */
static void choose_direction(const stage *s, double direction[3]) {
  const double *up = s->options->up;
  double at[3], normal[3], first, best = -1;
  bwi_view_usual(up, 0, false, direction);
  if (s->range.largest_at < 0 || !(s->diagonal > 0))
    return;
  largest_place(s, at, normal);
  for (int i = 0; i < 16 && (i != 8 || best < 0); i++) {
    int turn = i % 8 < 5 ? i % 8 : i % 8 - 8; /* eighths, -3 to 4 */
    double try[3];
    bwi_view_usual(up, turn * 0.7853981633974483, i >= 8, try);
    double facing = bw_dot(normal, try) / (bw_norm(normal) * bw_norm(try));
    if (!(facing > 0.3) ||
        bwi_solid_crossings(&s->solid[0], at, try, 1e-4 * s->diagonal, &first) > 0 ||
        bwi_solid_crossings(&s->solid[1], at, try, 1e-4 * s->diagonal, &first) > 0)
      continue;
    double score = arrows_show(s, try) + 0.2 * facing + (turn == 0 ? 0.15 : 0.02 * (4 - abs(turn)));
    /* a long body is better seen from the side */
    double along = try[s->longest] / bw_norm(try);
    score += 0.5 * sqrt(1 - along * along);
    if (score > best) {
      best = score;
      memcpy(direction, try, sizeof try);
    }
  }
}

static bw_status copy_surface(bw_context *context, const bw_surface *surface, bwi_solid *solid) {
  size_t points = 3 * (size_t)surface->point_count, corners = 3 * (size_t)surface->triangle_count;
  solid->point = BW_NEW(context, double, points);
  solid->triangle = BW_NEW(context, int32_t, corners);
  if (!solid->point || !solid->triangle)
    return BW_MEMORY;
  memcpy(solid->point, surface->point, points * sizeof *solid->point);
  memcpy(solid->triangle, surface->triangle, corners * sizeof *solid->triangle);
  solid->point_count = surface->point_count;
  solid->triangle_count = surface->triangle_count;
  return BW_OK;
}

/* Adds the displacement, with the factor asked for or a fitting one. */
static bw_status deform(bw_context *context, stage *s) {
  const double *u = s->options->displacement;
  bwi_solid *body = &s->solid[0];
  double largest = 0;
  if (!u)
    return BW_OK;
  for (size_t i = 0; i < (size_t)body->point_count; i++) {
    double size = hypot(hypot(u[3 * i], u[3 * i + 1]), u[3 * i + 2]);
    if (!isfinite(size))
      return bw_fail(context, BW_INVALID, "the displacement of point %zu is not finite", i + 1);
    largest = fmax(largest, size);
  }
  s->factor = s->options->deformation;
  if (s->factor == 0 && largest > 0)
    s->factor = DEFORMATION_SIZE * s->diagonal / largest;
  for (size_t i = 0; i < 3 * (size_t)body->point_count; i++)
    if (!(fabs(body->point[i] += s->factor * u[i]) < 1e300))
      return bw_fail(context, BW_INVALID, "%g times the displacement is too large for a picture",
                     s->factor);
  return BW_OK;
}

static bw_status set_stage(bw_context *context, const bw_surface *surface, const double *value,
                           bool on_facets, const bw_picture_options *options, stage *s) {
  bw_status status;
  double low[3], high[3], size[3];
  bwi_solid *body = &s->solid[0], *arrows = &s->solid[1], *lines = &s->solid[2],
            *ghost = &s->solid[3];
  BW_TRY(check_options(context, options));
  if (surface->triangle_count == 0 || surface->point_count == 0)
    return bw_fail(context, BW_EMPTY, "a picture of a surface without facets");
  s->surface = surface;
  s->options = options;
  body->finish = BWI_BODY;
  arrows->finish = BWI_ARROW;
  lines->finish = BWI_TUBE;
  ghost->finish = BWI_GHOST;
  body->inverted = ghost->inverted = bw_surface_volume(surface) < 0;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    size[k] = high[k] - low[k];
  s->diagonal = hypot(hypot(size[0], size[1]), size[2]); /* of any magnitude */
  for (int k = 1; k < 3; k++)
    if (size[k] > size[s->longest])
      s->longest = k;
  if (!(s->diagonal < 1e150))
    return bw_fail(context, BW_GEOMETRY, "a body of %g m is too large for a picture", s->diagonal);
  BW_TRY(copy_surface(context, surface, body));
  BW_TRY(deform(context, s));
  body->edges = options->edges;
  if (value) {
    int64_t count = on_facets ? surface->triangle_count : surface->point_count;
    s->range = range_of(value, count, options->min, options->max);
    body->value = value;
    body->on_facets = on_facets;
    body->low = s->range.min;
    body->high = s->range.max;
    if (!(body->high > body->low)) /* one value only: the middle of the colours */
      body->high = (body->low -= 1) + 2;
  }
  if (options->ghost && options->displacement)
    BW_TRY(copy_surface(context, surface, ghost));
  if (options->arrow_count > 0 && s->diagonal > 0) {
    s->arrow_end = BW_NEW(context, double, 3 * (size_t)options->arrow_count);
    BW_TRY_MEMORY(s->arrow_end);
    BW_TRY(bwi_arrows_solid(context, options->arrow_count, options->arrow, ARROW_SIZE * s->diagonal,
                            body, surface->point, arrows, s->arrow_end));
  }
  BW_TRY(bwi_lines_solid(context, options->line_count, options->line, LINE_RADIUS * s->diagonal,
                         body, options->displacement ? surface->point : NULL, lines));
  memcpy(s->direction, options->direction, sizeof s->direction);
  if (s->direction[0] == 0 && s->direction[1] == 0 && s->direction[2] == 0)
    choose_direction(s, s->direction);
  BW_TRY(bwi_view_axes(context, s->direction, options->up, &s->view));
  /* The frame: room for title, bar, triad and text. */
  double w = options->width, h = options->height;
  s->u = fmax(fmin(w / 1200, h / 900), 0.6); /* text stays legible */
  s->frame[0] = 40 * s->u;
  s->frame[1] = (options->title && options->title[0] ? 84 : 40) * s->u;
  s->frame[2] = w - (value && s->range.any ? 190 : 40) * s->u;
  s->frame[3] = h - 50 * s->u;
  double bounds[4] = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (int i = 0; i < SOLIDS; i++)
    bwi_view_bound(&s->view, s->solid[i].point_count, s->solid[i].point, bounds);
  bwi_view_fit(&s->view, bounds, s->frame, options->zoom);
  for (int i = 0; i < SOLIDS; i++)
    BW_TRY(bwi_solid_prepare(context, &s->solid[i], &s->view, CREASE, 0));
  if (ghost->point_count > 0)
    bwi_solid_behind(ghost, SOLIDS - 1, s->solid, 1 + 0.5 * w);
done:
  return status;
}

static void strike_stage(stage *s) {
  for (int i = 0; i < SOLIDS; i++)
    bwi_solid_clear(&s->solid[i]);
  bwi_image_clear(&s->image);
  bw_free(s->arrow_end);
}

/* ---- labels ---------------------------------------------------------------------------------- */

/* Three significant digits, the point a '.', e.g. for "max 5.83 MPa". */
static void short_number(char *buffer, size_t size, double value) {
  double magnitude = fabs(value);
  if (magnitude > 0 && (magnitude >= 1e6 || magnitude < 1e-3)) {
    int exponent = (int)floor(log10(magnitude));
    char mantissa[32], power[32];
    bwi_fixed(mantissa, sizeof mantissa, value / pow(10, exponent), 2);
    bwi_times_power(power, sizeof power, exponent);
    snprintf(buffer, size, "%s %s", mantissa, power);
    return;
  }
  int decimals = magnitude > 0 ? 2 - (int)floor(log10(magnitude) + 1e-9) : 0;
  bwi_fixed(buffer, size, value, decimals < 0 ? 0 : decimals);
}

/* Is something in front of a place by more than so many pixels? */
static bool is_hidden(const stage *s, const double pixel[3], double allowance) {
  int x = (int)floor(pixel[0]), y = (int)floor(pixel[1]);
  if (x < 0 || y < 0 || x >= s->image.width || y >= s->image.height)
    return false;
  float front = s->image.depth[(size_t)y * (size_t)s->image.width + (size_t)x];
  return (double)front > pixel[2] + allowance;
}

static void label_largest(const stage *s, cairo_t *cairo, const char *unit) {
  double at[3], normal[3], pixel[3];
  char number[64], label[160];
  largest_place(s, at, normal);
  bwi_view_project(&s->view, at, pixel);
  double w = s->image.width, h = s->image.height;
  if (pixel[0] < 0 || pixel[1] < 0 || pixel[0] >= w || pixel[1] >= h)
    return; /* zoomed out of the picture */
  bool hidden = is_hidden(s, pixel, 6 * s->u);
  const char *comma = unit ? strrchr(unit, ',') : NULL;
  short_number(number, sizeof number, s->range.value_max * s->options->scale);
  snprintf(label, sizeof label, "max %s%s%.60s%s", number, comma ? " " : "",
           comma ? comma + 1 + strspn(comma + 1, " ") : "", hidden ? " (behind)" : "");
  double frame[4] = {12 * s->u, s->frame[1] - 30 * s->u, s->frame[2] + 10 * s->u, h - 12 * s->u};
  bwi_draw_mark(cairo, pixel, hidden, frame, s->u, label);
}

static void label_arrows(const stage *s, cairo_t *cairo) {
  const bw_picture_options *options = s->options;
  int max = 0;
  for (int i = 1; i < options->arrow_count; i++)
    if (bw_norm(options->arrow[i].force) > bw_norm(options->arrow[max].force))
      max = i;
  double pixel[3], other[3], force = bw_norm(options->arrow[max].force);
  char number[64], label[80];
  if (!(force > 0))
    return;
  bwi_view_project(&s->view, s->arrow_end + 3 * (size_t)max, pixel);
  /* by more than its own shaft */
  if (is_hidden(s, pixel, 0.1 * ARROW_SIZE * s->diagonal * s->view.scale))
    return;
  short_number(number, sizeof number, force);
  snprintf(label, sizeof label, "%s N", number);
  cairo_set_source_rgb(cairo, 0.16, 0.18, 0.24);
  bwi_view_project(&s->view, options->arrow[max].at, other);
  double off = pixel[1] > other[1] ? 20 * s->u : -9 * s->u; /* beyond the arrow's end */
  bwi_draw_text(cairo, pixel[0], pixel[1] + off, 0.5, 14 * s->u, true, true, label);
}

/* Labels that are in sight, each with a dot at its place, above the dot and clear of those
 * before. */
static bw_status label_places(bw_context *context, const stage *s, cairo_t *cairo) {
  const bw_picture_options *options = s->options;
  double u = s->u, size = 14 * u, w = s->image.width, h = s->image.height;
  bw_status status = BW_OK;
  int drawn = 0;
  double *box = BW_NEW(context, double, 4 * (size_t)options->label_count);
  if (!box)
    return BW_MEMORY;
  bwi_choose_font(cairo, size, true);
  for (int i = 0; i < options->label_count && status == BW_OK; i++) {
    double pixel[3];
    bwi_view_project(&s->view, options->label[i].at, pixel);
    if (!(pixel[0] >= 0 && pixel[1] >= 0 && pixel[0] < w && pixel[1] < h) ||
        is_hidden(s, pixel, 6 * u))
      continue;
    char *text = bwi_clean_text(context, options->label[i].text);
    if (!text) {
      status = BW_MEMORY;
      break;
    }
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text, &extents);
    double half = extents.x_advance / 2 + 2 * u, *b = box + 4 * (size_t)drawn;
    double x = fmin(fmax(pixel[0], half), w - half);
    b[0] = x - half, b[1] = pixel[1] - 6 * u - size, b[2] = x + half, b[3] = pixel[1] + 5 * u;
    bool clear = b[1] >= 0;
    for (const double *o = box; o < b; o += 4)
      clear = clear && (o[2] < b[0] || o[0] > b[2] || o[3] < b[1] || o[1] > b[3]);
    if (clear) {
      drawn++;
      cairo_set_source_rgb(cairo, 0.10, 0.11, 0.15);
      cairo_arc(cairo, pixel[0], pixel[1], 3 * u, 0, 6.283185307179586);
      cairo_fill(cairo);
      bwi_draw_text(cairo, x, pixel[1] - 6 * u, 0.5, size, true, true, text);
    }
    bw_free(text);
  }
  bw_free(box);
  return status;
}

static bw_status annotate(bw_context *context, const stage *s, cairo_t *cairo) {
  const bw_picture_options *options = s->options;
  double w = s->image.width, h = s->image.height, u = s->u;
  bw_status status = BW_OK;
  char *title = options->title ? bwi_clean_text(context, options->title) : NULL;
  char *unit = options->unit ? bwi_clean_text(context, options->unit) : NULL;
  char *lines = options->line_name ? bwi_clean_text(context, options->line_name) : NULL;
  BW_TRY_MEMORY((!options->title || title) && (!options->unit || unit) &&
                (!options->line_name || lines));
  if (title) {
    cairo_set_source_rgb(cairo, 0.10, 0.11, 0.15);
    bwi_draw_title(cairo, 40 * u, 48 * u, w - 80 * u, 24 * u, title);
  }
  if (s->solid[0].value && s->range.any) {
    double scale = options->scale;
    bwi_bar bar = {.low = scale * fmin(s->range.min, s->range.max),
                   .high = scale * fmax(s->range.min, s->range.max),
                   .largest = scale * s->range.value_max,
                   .unit = unit,
                   .missing = s->range.missing,
                   .below = (s->range.value_min < s->range.min),
                   .beyond = (s->range.value_max > s->range.max)};
    if (scale < 0) { /* the bar runs upwards in labels all the same */
      double swap = bar.low;
      bar.low = bar.high;
      bar.high = swap;
    }
    bwi_bar_draw(cairo, &bar, w - 128 * u, 0.24 * h, 0.80 * h, w - 24 * u, u);
    label_largest(s, cairo, unit);
  }
  if (s->arrow_end)
    label_arrows(s, cairo);
  bwi_draw_triad(cairo, &s->view, 58 * u, h - 58 * u, 34 * u, u);
  if (options->label_count > 0)
    BW_TRY(label_places(context, s, cairo));
  if (lines && options->line_count > 0)
    bwi_draw_line_key(cairo, 124 * u, h - 24 * u, u, lines);
  if (options->displacement && s->factor != 0 && s->factor != 1) {
    char number[64], label[96];
    short_number(number, sizeof number, s->factor);
    snprintf(label, sizeof label, "deformation \xC3\x97 %s", number);
    cairo_set_source_rgb(cairo, 0.30, 0.33, 0.38);
    bwi_draw_text(cairo, w - 24 * u, h - 24 * u, 1, 14 * u, false, true, label);
  }
done:
  bw_free(title);
  bw_free(unit);
  bw_free(lines);
  return status;
}

bw_status bw_picture_direction(bw_context *context, const bw_surface *surface, const double *value,
                               bool on_facets, const bw_picture_options *options,
                               double direction[3]) {
  stage s;
  memset(&s, 0, sizeof s);
  bw_status status = set_stage(context, surface, value, on_facets, options, &s);
  if (status == BW_OK)
    memcpy(direction, s.direction, sizeof s.direction);
  strike_stage(&s);
  return status;
}

bw_status bw_picture_surface(bw_context *context, const bw_surface *surface, const double *value,
                             bool on_facets, const bw_picture_options *options, const char *path) {
  bw_picture_options usual;
  cairo_surface_t *canvas = NULL;
  cairo_t *cairo = NULL;
  stage s;
  bw_status status;
  memset(&s, 0, sizeof s);
  if (!options) {
    bw_picture_options_default(&usual);
    options = &usual;
  }
  BW_TRY(set_stage(context, surface, value, on_facets, options, &s));
  s.image.width = options->width;
  s.image.height = options->height;
  BW_TRY(bwi_render(context, SOLIDS, s.solid, &s.image));
  BW_TRY(bwi_occlude(context, &s.image, 0.035 * fmin(options->width, options->height)));
  canvas = cairo_image_surface_create(CAIRO_FORMAT_RGB24, options->width, options->height);
  cairo = cairo_create(canvas);
  if (cairo_status(cairo) == CAIRO_STATUS_SUCCESS) {
    bwi_compose(&s.image, canvas);
    BW_TRY(annotate(context, &s, cairo));
  }
  if (cairo_status(cairo) != CAIRO_STATUS_SUCCESS) {
    bool memory = cairo_status(cairo) == CAIRO_STATUS_NO_MEMORY;
    BW_TRY(bw_fail(context, memory ? BW_MEMORY : BW_INTERNAL, "drawing %s: %s", path,
                   cairo_status_to_string(cairo_status(cairo))));
  }
  BW_TRY(bwi_write_png(context, canvas, path));
done:
  if (cairo)
    cairo_destroy(cairo);
  if (canvas)
    cairo_surface_destroy(canvas);
  strike_stage(&s);
  return status;
}
