/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Texts that can be drawn, and the font that they are drawn in. */
#include "picture/internal.h"

#include <string.h>

char *bwi_clean_text(bw_context *context, const char *text) {
  size_t length = strlen(text);
  char *clean = BW_NEW(context, char, length + 1);
  if (!clean)
    return NULL;
  for (size_t i = 0; i < length;) {
    const unsigned char *c = (const unsigned char *)text + i;
    size_t bytes = c[0] < 0x80                   ? 1
                   : c[0] >= 0xC2 && c[0] < 0xE0 ? 2
                   : (c[0] & 0xF0) == 0xE0       ? 3
                   : c[0] >= 0xF0 && c[0] < 0xF5 ? 4
                                                 : 0;
    bool good = bytes > 0 && i + bytes <= length && (bytes > 1 || (c[0] >= 32 && c[0] != 127));
    for (size_t k = 1; k < bytes && good; k++)
      good = (c[k] & 0xC0) == 0x80;
    /* overlong forms, surrogates, beyond the last code point */
    if (good &&
        ((bytes == 3 && ((c[0] == 0xE0 && c[1] < 0xA0) || (c[0] == 0xED && c[1] >= 0xA0))) ||
         (bytes == 4 && ((c[0] == 0xF0 && c[1] < 0x90) || (c[0] == 0xF4 && c[1] >= 0x90)))))
      good = false;
    if (good) {
      memcpy(clean + i, text + i, bytes);
      i += bytes;
    } else
      clean[i++] = c[0] < 32 ? ' ' : '?';
  }
  clean[length] = 0;
  return clean;
}

/* The options are set for every text: with Cairo's own, letters depend on what the process drew
 * before. Without hints a text of twice the size is twice as wide. */
void bwi_choose_font(cairo_t *cairo, double size, bool bold) {
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
  cairo_select_font_face(cairo, BWI_FONT, CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
}
