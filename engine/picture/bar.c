/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The colour bar: heading, round ticks, both ends, the largest value, missing values. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "picture/internal.h"

int bwi_ticks(double low, double high, int max, double tick[BWI_TICKS], int *decimals) {
  *decimals = 0;
  /* Ends that differ by rounding alone hold no round number between them that doubles can count. */
  double size = fmax(fabs(low), fabs(high));
  if (!(high - low > 1e-9 * size) || !isfinite(high - low) || max < 1)
    return 0;
  max = max > BWI_TICKS ? BWI_TICKS : max;
  double power = pow(10, floor(log10((high - low) / max)));
  static const double round_steps[] = {1, 2, 2.5, 5, 10, 20};
  static const int extra[] = {0, 0, 1, 0, 0, 0};
  for (size_t i = 0; i < sizeof round_steps / sizeof *round_steps; i++) {
    double step = round_steps[i] * power;
    double first = ceil(low / step - 1e-9), last = floor(high / step + 1e-9);
    if (last - first + 1 > max)
      continue;
    int count = 0;
    for (double k = first; k <= last; k++)
      tick[count++] = k == 0 ? 0 : k * step;
    int exponent = (int)floor(log10(step) + 1e-9);
    *decimals = exponent < 0 ? -exponent : 0;
    *decimals += (exponent <= 0) * extra[i];
    return count;
  }
  return 0;
}

void bwi_fixed(char *buffer, size_t size, double value, int decimals) {
  double power = 1;
  decimals = decimals > 17 ? 17 : decimals; /* more do not fit into the whole number below */
  for (int i = 0; i < decimals; i++)
    power *= 10;
  double whole = floor(fabs(value) * power + 0.5);
  const char *sign = value < 0 && whole > 0 ? "\xE2\x88\x92" : ""; /* a true minus */
  if (!(whole < 1e17)) {
    snprintf(buffer, size, "%s%.0f", sign, fabs(value));
    return;
  }
  long long number = (long long)whole, unit = (long long)power;
  if (decimals == 0)
    snprintf(buffer, size, "%s%lld", sign, number);
  else
    snprintf(buffer, size, "%s%lld.%0*lld", sign, number / unit, decimals, number % unit);
}

/* Thousands or thousandths that make numbers short: 10 to this power is taken out. */
static int common_exponent(double largest) {
  if (!(largest > 1e-300) || !(largest < 1e300) || (largest < 1e5 && largest >= 1e-2))
    return 0;
  return 3 * (int)floor(log10(largest) / 3);
}

void bwi_times_power(char *buffer, size_t size, int exponent) {
  static const char *const digit[] = {
      "\xE2\x81\xB0", "\xC2\xB9",     "\xC2\xB2",     "\xC2\xB3",     "\xE2\x81\xB4",
      "\xE2\x81\xB5", "\xE2\x81\xB6", "\xE2\x81\xB7", "\xE2\x81\xB8", "\xE2\x81\xB9"};
  int n = exponent < 0 ? -exponent : exponent;
  snprintf(buffer, size, "\xC3\x97 10%s%s%s%s", exponent < 0 ? "\xE2\x81\xBB" : "",
           n >= 100 ? digit[n / 100 % 10] : "", n >= 10 ? digit[n / 10 % 10] : "", digit[n % 10]);
}

/* Decimals that show four significant digits of the larger end, for the ends and the maximum. */
static int end_decimals(double size) {
  int digits = size > 1e-300 && isfinite(size) ? 2 - (int)floor(log10(size) + 1e-9) : 0;
  return digits < 0 ? 0 : digits > 9 ? 9 : digits;
}

/* Lines of bold text, the last one at y, broken at spaces to fit into `width`. */
static void draw_heading(cairo_t *cairo, double right, double y, double width, double u,
                         char *text) {
  enum { LINES = 4 };
  char *line[LINES] = {text};
  int lines = 1;
  bwi_choose_font(cairo, 15 * u, true);
  for (char *space = strchr(text, ' '); space && lines < LINES;) {
    cairo_text_extents_t extents;
    char *next = strchr(space + 1, ' ');
    if (next)
      *next = 0;
    cairo_text_extents(cairo, line[lines - 1], &extents);
    if (next)
      *next = ' ';
    if (extents.x_advance > width) { /* the word after this space does not fit */
      *space = 0;
      line[lines++] = space + 1;
    }
    space = next;
  }
  for (int i = 0; i < lines; i++)
    bwi_draw_text(cairo, right, y - 19 * u * (lines - 1 - i), 1, 15 * u, true, false, line[i]);
}

void bwi_bar_draw(cairo_t *cairo, const bwi_bar *bar, double x, double top, double bottom,
                  double right, double u) {
  double size = fmax(fabs(bar->low), fabs(bar->high)), wide = 22 * u, text = 14 * u;
  int exponent = common_exponent(size);
  double factor = pow(10, -exponent), low = bar->low * factor, high = bar->high * factor;

  /* heading: the name, then the unit on a line of its own */
  char name[160] = "", unit[160] = "", power[48] = "";
  if (bar->unit) {
    const char *comma = strrchr(bar->unit, ',');
    size_t length = comma ? (size_t)(comma - bar->unit) : strlen(bar->unit);
    snprintf(name, sizeof name, "%.*s", (int)(length > 150 ? 150 : length), bar->unit);
    if (comma)
      snprintf(unit, sizeof unit, "%.100s", comma + 1 + strspn(comma + 1, " "));
  }
  if (exponent != 0)
    bwi_times_power(power, sizeof power, exponent);
  char second[240];
  snprintf(second, sizeof second, "%s%s%s", power, power[0] && unit[0] ? " " : "", unit);
  cairo_set_source_rgb(cairo, 0.13, 0.15, 0.19);
  draw_heading(cairo, right, top - (second[0] ? 36 : 16) * u, 170 * u, u, name);
  bwi_draw_text(cairo, right, top - 16 * u, 1, text, false, false, second);

  /* the colours, one pixel row each */
  cairo_pattern_t *colours = cairo_pattern_create_linear(0, bottom, 0, top);
  for (int i = 0; i <= 64; i++) {
    unsigned char rgb[3];
    bw_colour(i / 64., rgb);
    cairo_pattern_add_color_stop_rgb(colours, i / 64., rgb[0] / 255., rgb[1] / 255., rgb[2] / 255.);
  }
  cairo_set_source(cairo, colours);
  cairo_rectangle(cairo, x, top, wide, bottom - top);
  cairo_fill_preserve(cairo);
  cairo_pattern_destroy(colours);
  cairo_set_source_rgba(cairo, 0.13, 0.15, 0.19, 0.55);
  cairo_set_line_width(cairo, u);
  cairo_stroke(cairo);

  double tick[BWI_TICKS], height = bottom - top, clear = 17 * u;
  int decimals, count = bwi_ticks(low, high, 6, tick, &decimals),
                ends = end_decimals(size * factor);
  double mark = bar->largest * factor;
  bool marked = mark >= low && mark <= high && high > low && mark < high - 1e-3 * (high - low);
  double mark_at = bottom - (mark - low) / (high - low) * height;
  for (int i = 0; i < count; i++) {
    char label[64];
    double y = bottom - (tick[i] - low) / (high - low) * height;
    cairo_set_source_rgba(cairo, 0.13, 0.15, 0.19, 0.55);
    cairo_set_line_width(cairo, u);
    cairo_move_to(cairo, x + wide, y);
    cairo_line_to(cairo, x + wide + 5 * u, y);
    cairo_stroke(cairo);
    if (y - top < clear || bottom - y < clear || (marked && fabs(y - mark_at) < clear))
      continue; /* the ends have labels of their own */
    bwi_fixed(label, sizeof label, tick[i], decimals);
    cairo_set_source_rgb(cairo, 0.30, 0.33, 0.38);
    bwi_draw_text(cairo, x + wide + 10 * u, y + 5 * u, 0, text, false, false, label);
  }
  char number[64], label[80];
  cairo_set_source_rgb(cairo, 0.13, 0.15, 0.19);
  bwi_fixed(number, sizeof number, low, ends);
  snprintf(label, sizeof label, "%s%s", bar->below ? "\xE2\x89\xA4 " : "", number);
  bwi_draw_text(cairo, x + wide + 10 * u, bottom + 5 * u, 0, text, true, false, label);
  if (high > low) {
    bwi_fixed(number, sizeof number, high, ends);
    snprintf(label, sizeof label, "%s%s", bar->beyond ? "\xE2\x89\xA5 " : "", number);
    bwi_draw_text(cairo, x + wide + 10 * u, top + 5 * u, 0, text, true, false, label);
  }
  if (marked && mark_at - top >= clear && bottom - mark_at >= clear) { /* where the largest lies */
    bwi_fixed(number, sizeof number, mark, ends);
    snprintf(label, sizeof label, "%s max", number);
    bwi_draw_text(cairo, x + wide + 10 * u, mark_at + 5 * u, 0, text, true, false, label);
    cairo_move_to(cairo, x - 2 * u, mark_at);
    cairo_line_to(cairo, x - 9 * u, mark_at - 4 * u);
    cairo_line_to(cairo, x - 9 * u, mark_at + 4 * u);
    cairo_fill(cairo);
  }
  if (bar->missing) {
    unsigned char rgb[3];
    bw_colour(NAN, rgb);
    cairo_set_source_rgb(cairo, rgb[0] / 255., rgb[1] / 255., rgb[2] / 255.);
    cairo_rectangle(cairo, x, bottom + 22 * u, wide, 16 * u);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, 0.30, 0.33, 0.38);
    bwi_draw_text(cairo, x + wide + 10 * u, bottom + 35 * u, 0, text, false, false, "no value");
  }
}
