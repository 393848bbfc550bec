/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* SVG's path data: M L H V C S Q T A Z, absolute and relative. Each M begins a piece; so does what
 * follows a Z without an M, where the piece before began. Arcs follow the implementation notes of
 * SVG 1.1 (appendix F.6): radii that are too short are made longer. */
#include <math.h>
#include <string.h>

#include "io/contours.h"

static bool skip_separators(bwi_cursor *cursor) {
  bool more = bwi_skip_space(cursor);
  if (more && *cursor->at == ',') {
    cursor->at++;
    more = bwi_skip_space(cursor);
  }
  return more;
}

static bwi_word rest_of(const bwi_cursor *cursor) {
  return (bwi_word){cursor->at, bwi_left(cursor)};
}

bw_status bwi_svg_number(bwi_cursor *cursor, double *value, bool *any) {
  const unsigned char *after;
  *any = skip_separators(cursor);
  if (!*any)
    return BW_OK;
  if (bwi_parse_real(cursor->at, cursor->end, value, &after) != BWI_NUMBER)
    return bwi_fail_word(cursor, rest_of(cursor), "a number");
  cursor->at = after;
  return BW_OK;
}

typedef struct pen {
  bwi_cursor *cursor;
  bwi_contours *contours;
  const bw_name *name;
  int32_t region;
  int64_t line;
  double at[2], start[2], control[2]; /* the last control point, for S and T */
  char before;                        /* the last command, in capitals */
  bool drawing;
} pen;

static bw_status numbers(pen *p, int count, double *value, char command) {
  for (int i = 0; i < count; i++) {
    bool any;
    bw_status status = bwi_svg_number(p->cursor, &value[i], &any);
    if (status != BW_OK)
      return status;
    if (!any)
      return bwi_fail_line(p->cursor,
                           "the path ends inside the command '%c', which takes %d numbers", command,
                           count);
  }
  return BW_OK;
}

/* 0 or 1, which may stand without a space before what follows. */
static bw_status flag(pen *p, bool *value) {
  if (!skip_separators(p->cursor) || (*p->cursor->at != '0' && *p->cursor->at != '1'))
    return bwi_fail_word(p->cursor, rest_of(p->cursor), "a flag of an arc, 0 or 1,");
  *value = *p->cursor->at++ == '1';
  return BW_OK;
}

static void begin(pen *p) {
  if (p->drawing)
    return;
  memcpy(p->start, p->at, sizeof p->start);
  bwi_contours_begin(p->contours, p->at, p->name, p->region, p->line);
  p->drawing = true;
}

static void end(pen *p, bool close) {
  if (p->drawing)
    bwi_contours_end(p->contours, close);
  p->drawing = false;
}

static double angle_of(double x, double y) {
  return atan2(y, x);
}

static void arc(pen *p, double rx, double ry, double degrees, bool large, bool sweep,
                const double to[2]) {
  const double pi = 3.14159265358979323846;
  rx = fabs(rx);
  ry = fabs(ry);
  if (p->at[0] == to[0] && p->at[1] == to[1])
    return;
  if (!(rx > 0 && ry > 0)) {
    bwi_contours_line(p->contours, to);
    return;
  }
  double turn = fmod(degrees, 360) * pi / 180, c = cos(turn), s = sin(turn);
  double dx = (p->at[0] - to[0]) / 2, dy = (p->at[1] - to[1]) / 2;
  double x = (c * dx + s * dy) / rx, y = (-s * dx + c * dy) / ry; /* on the unit circle's scale */
  double size2 = x * x + y * y;
  if (size2 > 1) {
    rx *= sqrt(size2);
    ry *= sqrt(size2);
    x /= sqrt(size2);
    y /= sqrt(size2);
    size2 = 1;
  }
  double k = sqrt(fmax(0, (1 - size2) / size2)) * (large != sweep ? 1 : -1);
  double cx = k * y, cy = -k * x;
  double from = angle_of(x - cx, y - cy), until = angle_of(-x - cx, -y - cy);
  if (sweep && until < from)
    until += 2 * pi;
  if (!sweep && until > from)
    until -= 2 * pi;
  double centre[2] = {c * rx * cx - s * ry * cy + (p->at[0] + to[0]) / 2,
                      s * rx * cx + c * ry * cy + (p->at[1] + to[1]) / 2};
  double u[2] = {c * rx, s * rx}, v[2] = {-s * ry, c * ry};
  bwi_contours_arc(p->contours, centre, u, v, from, until);
}

static bw_status draw(pen *p, char command) {
  bw_status status = BW_OK;
  bool relative = command >= 'a';
  char capital = (char)(relative ? command - 32 : command);
  double value[7], base[2] = {relative ? p->at[0] : 0, relative ? p->at[1] : 0};
  double to[2] = {p->at[0], p->at[1]}, a[2], b[2];
  bool large, sweep;
  begin(p);
  switch (capital) {
  case 'L':
    BW_TRY(numbers(p, 2, value, command));
    to[0] = base[0] + value[0];
    to[1] = base[1] + value[1];
    bwi_contours_line(p->contours, to);
    break;
  case 'H':
  case 'V':
    BW_TRY(numbers(p, 1, value, command));
    to[capital == 'V'] = base[capital == 'V'] + value[0];
    bwi_contours_line(p->contours, to);
    break;
  case 'C':
  case 'S':
    BW_TRY(numbers(p, capital == 'C' ? 6 : 4, capital == 'C' ? value : value + 2, command));
    for (int k = 0; k < 2; k++) {
      bool mirrored = p->before == 'C' || p->before == 'S';
      a[k] = capital == 'C' ? base[k] + value[k]
             : mirrored     ? 2 * p->at[k] - p->control[k]
                            : p->at[k];
      b[k] = base[k] + value[2 + k];
      to[k] = base[k] + value[4 + k];
    }
    bwi_contours_cubic(p->contours, a, b, to);
    memcpy(p->control, b, sizeof b);
    break;
  case 'Q':
  case 'T':
    BW_TRY(numbers(p, capital == 'Q' ? 4 : 2, capital == 'Q' ? value : value + 2, command));
    for (int k = 0; k < 2; k++) {
      bool mirrored = p->before == 'Q' || p->before == 'T';
      a[k] = capital == 'Q' ? base[k] + value[k]
             : mirrored     ? 2 * p->at[k] - p->control[k]
                            : p->at[k];
      to[k] = base[k] + value[2 + k];
    }
    bwi_contours_quadratic(p->contours, a, to);
    memcpy(p->control, a, sizeof a);
    break;
  default:
    BW_TRY(numbers(p, 3, value, command));
    BW_TRY(flag(p, &large));
    BW_TRY(flag(p, &sweep));
    BW_TRY(numbers(p, 2, value + 3, command));
    to[0] = base[0] + value[3];
    to[1] = base[1] + value[4];
    arc(p, value[0], value[1], value[2], large, sweep, to);
  }
  memcpy(p->at, to, sizeof to);
  memcpy(p->contours->at, to, sizeof to);
  p->before = capital;
done:
  return status;
}

static bw_status move(pen *p, bool relative, bool first) {
  double value[2];
  bw_status status = numbers(p, 2, value, relative ? 'm' : 'M');
  if (status != BW_OK)
    return status;
  end(p, false);
  for (int k = 0; k < 2; k++)
    p->at[k] = value[k] + (relative && !first ? p->at[k] : 0);
  memcpy(p->start, p->at, sizeof p->at);
  p->before = 'M';
  return BW_OK;
}

bw_status bwi_svg_path(bwi_cursor *cursor, bwi_contours *contours, const bw_name *name,
                       int32_t region) {
  bw_status status = BW_OK;
  pen p = {
      .cursor = cursor, .contours = contours, .name = name, .region = region, .line = cursor->line};
  char command = 0;
  while (status == BW_OK && skip_separators(cursor)) {
    unsigned char c = *cursor->at;
    bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (letter && !strchr("MmLlHhVvCcSsQqTtAaZz", c))
      return bwi_fail_word(cursor, rest_of(cursor),
                           "a command of a path (M L H V C S Q T A Z, capital or small)");
    if (!letter && (command == 0 || command == 'Z' || command == 'z'))
      return bwi_fail_word(cursor, rest_of(cursor), "a command of a path");
    if (letter) {
      if (p.before == 0 && c != 'M' && c != 'm')
        return bwi_fail_word(cursor, rest_of(cursor), "the M that a path begins with");
      command = (char)c;
      cursor->at++;
    }
    if (command == 'Z' || command == 'z') {
      end(&p, true);
      memcpy(p.at, p.start, sizeof p.at);
      p.before = 'Z';
    } else if (command == 'M' || command == 'm') {
      status = move(&p, command == 'm', p.before == 0);
      command = command == 'm' ? 'l' : 'L'; /* what follows without a letter */
    } else {
      status = draw(&p, command);
    }
  }
  if (status == BW_OK)
    end(&p, false);
  return status;
}
