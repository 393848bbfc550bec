/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* SVG's transform attribute: matrix, translate, scale, rotate, skewX, skewY. */
#include <math.h>
#include <string.h>

#include "io/contours.h"

/* Columns one behind the other: x' = m0 x + m2 y + m4, y' = m1 x + m3 y + m5. */
void bwi_matrix_multiply(double m[6], const double r[6]) {
  double out[6];
  for (int column = 0; column < 3; column++)
    for (int row = 0; row < 2; row++)
      out[2 * column + row] =
          m[row] * r[2 * column] + m[2 + row] * r[2 * column + 1] + (column == 2 ? m[4 + row] : 0);
  memcpy(m, out, sizeof out);
}

static void set(double m[6], double a, double b, double c, double d, double e, double f) {
  const double value[6] = {a, b, c, d, e, f};
  memcpy(m, value, sizeof value);
}

/* Which one, and how many numbers it may have; false when the count is none of them. */
static bool one(bwi_word word, const double *v, int count, double m[6]) {
  const double degree = 3.14159265358979323846 / 180;
  if (bwi_word_is(word, "matrix") && count == 6)
    set(m, v[0], v[1], v[2], v[3], v[4], v[5]);
  else if (bwi_word_is(word, "translate") && (count == 1 || count == 2))
    set(m, 1, 0, 0, 1, v[0], count == 2 ? v[1] : 0);
  else if (bwi_word_is(word, "scale") && (count == 1 || count == 2))
    set(m, v[0], 0, 0, count == 2 ? v[1] : v[0], 0, 0);
  else if (bwi_word_is(word, "skewX") && count == 1)
    set(m, 1, 0, tan(v[0] * degree), 1, 0, 0);
  else if (bwi_word_is(word, "skewY") && count == 1)
    set(m, 1, tan(v[0] * degree), 0, 1, 0, 0);
  else if (bwi_word_is(word, "rotate") && (count == 1 || count == 3)) {
    double c = cos(v[0] * degree), s = sin(v[0] * degree);
    double x = count == 3 ? v[1] : 0, y = count == 3 ? v[2] : 0;
    set(m, c, s, -s, c, x - c * x + s * y, y - s * x - c * y);
  } else
    return false;
  return true;
}

bw_status bwi_svg_transform(bwi_cursor *cursor, double matrix[6]) {
  while (bwi_skip_space(cursor)) {
    if (*cursor->at == ',') {
      cursor->at++;
      continue;
    }
    bwi_word word = {cursor->at, 0};
    while (cursor->at < cursor->end && ((*cursor->at | 32) >= 'a' && (*cursor->at | 32) <= 'z'))
      cursor->at++;
    word.length = (size_t)(cursor->at - word.at);
    if (word.length == 0 || !bwi_skip_space(cursor) || *cursor->at != '(')
      return bwi_fail_word(cursor, (bwi_word){word.at, (size_t)(cursor->end - word.at)},
                           "a transform: matrix(...), translate(...), scale(...), rotate(...), "
                           "skewX(...), skewY(...)");
    cursor->at++;
    const unsigned char *close =
        bwi_left(cursor) ? memchr(cursor->at, ')', bwi_left(cursor)) : NULL;
    if (!close)
      return bwi_fail_line(cursor, "the transform '%s' has no closing parenthesis", bwi_show(word));
    bwi_cursor inside = *cursor;
    inside.end = close;
    double value[6], step[6], extra;
    int count = 0;
    for (bool any = true; any; count += any) {
      bw_status status = bwi_svg_number(&inside, count < 6 ? &value[count] : &extra, &any);
      if (status != BW_OK)
        return status;
      if (any && count == 6)
        break;
    }
    if (bwi_left(&inside) > 0 || !one(word, value, count, step))
      return bwi_fail_line(
          cursor,
          "the transform '%s' with %d numbers: matrix takes 6, translate and scale "
          "1 or 2, rotate 1 or 3, skewX and skewY 1",
          bwi_show(word), count);
    bwi_matrix_multiply(matrix, step);
    cursor->line = inside.line;
    cursor->at = close + 1;
  }
  return BW_OK;
}
