/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* DXF drawings as text: pairs of lines, a group code and its value. Of the section ENTITIES the
 * flat curves are read: LINE, LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE. z
 * is dropped; the extrusion direction counts where it points down, which mirrors x. Layers become
 * tags. $INSUNITS says what a unit is; without it a millimetre. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/contours.h"

typedef struct group {
  int code;
  bwi_word value;
  int64_t line; /* of the value */
} group;

/* An entity: its groups from `first` on in the list, the one of code 0 left out. */
typedef struct reader {
  bwi_cursor *cursor;
  bwi_contours *contours;
  group *list;
  size_t count, capacity;
  group ahead; /* the group of code 0 that ended the last entity */
  bwi_word type;
  int64_t type_line;
  double *number; /* of splines: knots, then points */
  size_t number_capacity;
  double unit;
  int64_t skipped, entities;
} reader;

/* ---- groups ---------------------------------------------------------------------------------- */

static bw_status fail_group(const reader *r, const group *g, const char *expected) {
  bwi_cursor at = *r->cursor;
  at.line = g->line;
  return bwi_fail_line(&at, "group %d: found '%s' where %s was expected", g->code,
                       bwi_show(g->value), expected);
}

static bwi_word trimmed(bwi_cursor line) {
  bwi_skip_blank(&line);
  while (line.end > line.at && line.end[-1] <= ' ')
    line.end--;
  return (bwi_word){line.at, bwi_left(&line)};
}

static bw_status next_group(reader *r, group *g) {
  bwi_cursor code, value;
  int64_t number;
  const unsigned char *after;
  if (!bwi_next_line(r->cursor, &code))
    return bwi_fail_line(r->cursor, "the file ends before the line EOF: it is cut short");
  bwi_word word = trimmed(code);
  if (!bwi_parse_integer(word.at, word.at + word.length, &number, &after) ||
      after != word.at + word.length || number < -5 || number > 1071)
    return bwi_fail_word(&code, word, "a group code, 0 to 1071,");
  if (!bwi_next_line(r->cursor, &value))
    return bwi_fail_line(r->cursor,
                         "the file ends behind the group code %lld: its value is missing",
                         (long long)number);
  *g = (group){(int)number, trimmed(value), value.line};
  return BW_OK;
}

static bw_status real_of(const reader *r, const group *g, double *value) {
  const unsigned char *after, *end = g->value.at + g->value.length;
  if (bwi_parse_real(g->value.at, end, value, &after) != BWI_NUMBER || after != end)
    return fail_group(r, g, "a number");
  return BW_OK;
}

static bw_status integer_of(const reader *r, const group *g, int64_t *value) {
  const unsigned char *after, *end = g->value.at + g->value.length;
  if (!bwi_parse_integer(g->value.at, end, value, &after) || after != end)
    return fail_group(r, g, "a whole number");
  return BW_OK;
}

/* The groups up to the next of code 0, which goes to `ahead`. */
static bw_status read_entity(reader *r) {
  group g;
  r->count = 0;
  r->type = r->ahead.value;
  r->type_line = r->ahead.line;
  for (;;) {
    bw_status status = next_group(r, &g);
    if (status != BW_OK)
      return status;
    if (g.code == 0) {
      r->ahead = g;
      return BW_OK;
    }
    if (!bw_grow(r->cursor->context, (void **)&r->list, &r->capacity, r->count, 1, sizeof *r->list))
      return BW_MEMORY;
    r->list[r->count++] = g;
  }
}

static const group *find(const reader *r, int code) {
  for (size_t i = 0; i < r->count; i++)
    if (r->list[i].code == code)
      return &r->list[i];
  return NULL;
}

/* A number of the entity; needed, or kept as it is. */
static bw_status entity_real(const reader *r, int code, bool needed, double *value) {
  const group *g = find(r, code);
  if (g)
    return real_of(r, g, value);
  if (!needed)
    return BW_OK;
  bwi_cursor at = *r->cursor;
  at.line = r->type_line;
  return bwi_fail_line(&at, "a %s without group %d was found", bwi_show(r->type), code);
}

static bw_status entity_integer(const reader *r, int code, int64_t *value) {
  const group *g = find(r, code);
  return g ? integer_of(r, g, value) : BW_OK;
}

static bw_status entity_point(const reader *r, int code, double at[2]) {
  bw_status status = entity_real(r, code, true, &at[0]);
  return status == BW_OK ? entity_real(r, code + 10, true, &at[1]) : status;
}

/* ---- entities -------------------------------------------------------------------------------- */

/* The layer as tag, the unit and the direction of extrusion as matrix. `plane`: coordinates are
 * those of the entity's own plane. *down: the extrusion points down. */
static bw_status begin_entity(reader *r, bool plane, bool *down) {
  bwi_contours *c = r->contours;
  const group *layer = find(r, 8);
  bw_name name = layer ? bwi_name((const char *)layer->value.at, layer->value.length)
                       : bwi_name("boundary", strlen("boundary"));
  for (char *t = name.text; *t; t++) /* a 0 byte ends a name */
    if ((unsigned char)*t < ' ')
      *t = ' ';
  c->tag = bwi_draft_tag(&c->draft, name.text[0] ? name.text : "boundary");
  double z = 1, x = 0, y = 0;
  bw_status status = entity_real(r, 230, false, &z);
  if (status == BW_OK)
    status = entity_real(r, 210, false, &x);
  if (status == BW_OK)
    status = entity_real(r, 220, false, &y);
  if (status != BW_OK)
    return status;
  if (fabs(x) + fabs(y) > 1e-6 * fabs(z)) {
    bwi_cursor at = *r->cursor;
    at.line = r->type_line;
    return bwi_fail_line(
        &at,
        "a %s in a plane of direction (%g, %g, %g): drawings in the plane z = 0 are "
        "read",
        bwi_show(r->type), x, y, z);
  }
  *down = z < 0;
  const double matrix[6] = {plane && *down ? -r->unit : r->unit, 0, 0, r->unit, 0, 0};
  memcpy(c->matrix, matrix, sizeof matrix);
  return BW_OK;
}

static bw_status read_line(reader *r) {
  bw_status status = BW_OK;
  bool down;
  double from[2], to[2];
  BW_TRY(begin_entity(r, false, &down));
  BW_TRY(entity_point(r, 10, from));
  BW_TRY(entity_point(r, 11, to));
  bwi_contours_begin(r->contours, from, NULL, BWI_REGION_BY_NESTING, r->type_line);
  bwi_contours_line(r->contours, to);
  bwi_contours_end(r->contours, false);
done:
  return status;
}

static bw_status read_arc(reader *r, bool circle) {
  bw_status status = BW_OK;
  const double pi = 3.14159265358979323846;
  bool down;
  double centre[2], radius, from = 0, to = 360;
  BW_TRY(begin_entity(r, true, &down));
  BW_TRY(entity_point(r, 10, centre));
  BW_TRY(entity_real(r, 40, true, &radius));
  if (!circle) {
    BW_TRY(entity_real(r, 50, true, &from));
    BW_TRY(entity_real(r, 51, true, &to));
  }
  if (!(radius > 0))
    BW_TRY(fail_group(r, find(r, 40), "a positive radius"));
  from = fmod(from, 360) * pi / 180;
  to = circle ? from + 2 * pi : fmod(to, 360) * pi / 180;
  while (to <= from)
    to += 2 * pi;
  const double start[2] = {centre[0] + radius * cos(from), centre[1] + radius * sin(from)};
  bwi_contours_begin(r->contours, start, NULL, BWI_REGION_BY_NESTING, r->type_line);
  bwi_contours_arc(r->contours, centre, (double[]){radius, 0}, (double[]){0, radius}, from, to);
  bwi_contours_end(r->contours, circle);
done:
  return status;
}

static bw_status read_ellipse(reader *r) {
  bw_status status = BW_OK;
  const double pi = 3.14159265358979323846;
  bool down;
  double centre[2], u[2], ratio = 1, from = 0, to = 2 * pi;
  BW_TRY(begin_entity(r, false, &down));
  BW_TRY(entity_point(r, 10, centre));
  BW_TRY(entity_point(r, 11, u));
  BW_TRY(entity_real(r, 40, true, &ratio));
  BW_TRY(entity_real(r, 41, false, &from));
  BW_TRY(entity_real(r, 42, false, &to));
  if (!(ratio > 0) || !(hypot(u[0], u[1]) > 0))
    BW_TRY(fail_group(r, find(r, 40), "a positive ratio of the axes"));
  from = fmod(from, 2 * pi);
  double span = fmod(to - from, 2 * pi);
  span = span <= 1e-9 ? span + 2 * pi : span;
  bool whole = span > 2 * pi - 1e-6;
  double side = down ? -ratio : ratio, v[2] = {-side * u[1], side * u[0]};
  const double start[2] = {centre[0] + cos(from) * u[0] + sin(from) * v[0],
                           centre[1] + cos(from) * u[1] + sin(from) * v[1]};
  bwi_contours_begin(r->contours, start, NULL, BWI_REGION_BY_NESTING, r->type_line);
  bwi_contours_arc(r->contours, centre, u, v, from, from + (whole ? 2 * pi : span));
  bwi_contours_end(r->contours, whole);
done:
  return status;
}

/* Vertices one after the other: 10 begins one, 20 and 42 (the bulge of what follows it) belong to
 * it. */
static bw_status read_lwpolyline(reader *r) {
  bw_status status = BW_OK;
  bool down, any = false, have_y = true;
  int64_t flags = 0;
  double at[2] = {0, 0}, first[2] = {0, 0}, bulge = 0, arrive = 0;
  BW_TRY(begin_entity(r, true, &down));
  BW_TRY(entity_integer(r, 70, &flags));
  for (size_t i = 0; i <= r->count; i++) {
    const group *g = i < r->count ? &r->list[i] : NULL;
    bool complete = !g || g->code == 10;
    if (complete && any) { /* the vertex before is complete */
      if (!have_y)
        BW_TRY(fail_group(r, &r->list[i - 1], "the y of a vertex (group 20)"));
      if (first[0] == HUGE_VAL) {
        memcpy(first, at, sizeof first);
        bwi_contours_begin(r->contours, at, NULL, BWI_REGION_BY_NESTING, r->type_line);
      } else
        bwi_contours_bulge(r->contours, at, arrive);
      arrive = bulge;
      bulge = 0;
    }
    if (!g)
      break;
    if (g->code == 10) {
      BW_TRY(real_of(r, g, &at[0]));
      if (!any)
        first[0] = HUGE_VAL;
      any = true;
      have_y = false;
    } else if (g->code == 20 && any) {
      BW_TRY(real_of(r, g, &at[1]));
      have_y = true;
    } else if (g->code == 42 && any)
      BW_TRY(real_of(r, g, &bulge));
  }
  if (!any)
    goto done;
  if (flags & 1)
    bwi_contours_bulge(r->contours, first, arrive);
  bwi_contours_end(r->contours, flags & 1);
done:
  return status;
}

/* POLYLINE, its VERTEX entities, SEQEND. Meshes and the control points of fitted curves are none of
 * ours. */
static bw_status read_polyline(reader *r) {
  bw_status status = BW_OK;
  bool down, any = false;
  int64_t flags = 0, line = r->type_line;
  double first[2] = {0, 0}, arrive = 0;
  BW_TRY(begin_entity(r, true, &down));
  BW_TRY(entity_integer(r, 70, &flags));
  bool foreign = flags & (16 | 64);
  r->skipped += foreign;
  while (bwi_word_is(r->ahead.value, "VERTEX")) {
    double at[2], bulge = 0;
    int64_t kind = 0;
    BW_TRY(read_entity(r));
    BW_TRY(entity_integer(r, 70, &kind));
    if (foreign || (kind & 16))
      continue;
    BW_TRY(entity_point(r, 10, at));
    BW_TRY(entity_real(r, 42, false, &bulge));
    if (any)
      bwi_contours_bulge(r->contours, at, arrive);
    else {
      memcpy(first, at, sizeof first);
      bwi_contours_begin(r->contours, at, NULL, BWI_REGION_BY_NESTING, line);
    }
    any = true;
    arrive = bulge;
  }
  if (any) {
    if (flags & 1)
      bwi_contours_bulge(r->contours, first, arrive);
    bwi_contours_end(r->contours, flags & 1);
  }
done:
  return status;
}

static bw_status read_spline(reader *r) {
  bw_status status = BW_OK;
  bool down;
  int64_t flags = 0, degree = 3;
  bwi_spline s = {0};
  bwi_cursor at = *r->cursor;
  at.line = r->type_line;
  BW_TRY(begin_entity(r, false, &down));
  BW_TRY(entity_integer(r, 70, &flags));
  BW_TRY(entity_integer(r, 71, &degree));
  for (size_t i = 0; i < r->count; i++) {
    s.knots += r->list[i].code == 40;
    s.points += r->list[i].code == 10;
  }
  if (!bw_grow(r->cursor->context, (void **)&r->number, &r->number_capacity, 0,
               s.knots + 2 * s.points + 1, sizeof *r->number))
    return BW_MEMORY;
  double *knot = r->number, *point = r->number + s.knots, weight = 0;
  size_t knots = 0, xs = 0, ys = 0;
  for (size_t i = 0; i < r->count; i++) {
    const group *g = &r->list[i];
    double value;
    if (g->code != 40 && g->code != 10 && g->code != 20 && g->code != 41)
      continue;
    BW_TRY(real_of(r, g, &value));
    if (g->code == 40)
      knot[knots++] = value;
    else if (g->code == 10)
      point[2 * xs++] = value;
    else if (g->code == 20 && ys < s.points)
      point[2 * ys++ + 1] = value;
    else if (g->code == 41) {
      if (weight != 0 && fabs(value - weight) > 1e-9 * fabs(weight))
        BW_TRY(fail_group(r, g,
                          "the weight of the others (rational splines are not read: save it as "
                          "a polyline or with arcs)"));
      weight = value;
    }
  }
  if (xs != ys)
    BW_TRY(bwi_fail_line(&at, "a SPLINE with %zu x and %zu y of control points was found", xs, ys));
  s.degree = degree >= 1 && degree <= 3 ? (int)degree : 0;
  s.knot = knot;
  s.point = point;
  const char *wrong = bwi_spline_wrong(&s);
  if (wrong)
    BW_TRY(bwi_fail_line(&at, "a SPLINE of degree %lld with %zu knots and %zu control points: %s",
                         (long long)degree, s.knots, s.points, wrong));
  double start[2];
  bwi_spline_start(&s, start);
  bwi_contours_begin(r->contours, start, NULL, BWI_REGION_BY_NESTING, r->type_line);
  bwi_spline_add(&s, r->contours);
  bwi_contours_end(r->contours, false);
done:
  return status;
}

static bw_status read_curve(reader *r) {
  static const char *const ours[] = {"LINE",   "ARC",        "CIRCLE",   "ELLIPSE",
                                     "SPLINE", "LWPOLYLINE", "POLYLINE", NULL};
  int which = 0;
  while (ours[which] && !bwi_word_is(r->type, ours[which]))
    which++;
  int64_t hidden = 0;
  bw_status status = entity_integer(r, 60, &hidden);
  if (status != BW_OK)
    return status;
  r->entities++;
  switch (hidden ? 7 : which) {
  case 0:
    return read_line(r);
  case 1:
  case 2:
    return read_arc(r, which == 2);
  case 3:
    return read_ellipse(r);
  case 4:
    return read_spline(r);
  case 5:
    return read_lwpolyline(r);
  case 6:
    return read_polyline(r);
  default:
    /* the parts of what was passed over are none of their own */
    r->skipped += !bwi_word_is(r->type, "SEQEND") && !bwi_word_is(r->type, "VERTEX") &&
                  !bwi_word_is(r->type, "ATTRIB");
    return BW_OK;
  }
}

/* ---- sections -------------------------------------------------------------------------------- */

/* Metres in a unit by the number of $INSUNITS; 0: it says nothing. */
static double unit_metres(int64_t number) {
  static const double metres[] = {0,       0.0254, 0.3048, 1609.344, 1e-3, 1e-2, 1,  1e3, 2.54e-8,
                                  2.54e-5, 0.9144, 1e-10,  1e-9,     1e-6, 0.1,  10, 100, 1e9};
  return number >= 0 && number < (int64_t)(sizeof metres / sizeof *metres) ? metres[number] : 0;
}

/* Entities up to ENDSEC; those of ENTITIES are curves. The header's come as one. */
static bw_status read_section(reader *r, bwi_word name, bool *found) {
  bw_status status = BW_OK;
  bool entities = bwi_word_is(name, "ENTITIES");
  if (bwi_word_is(name, "HEADER") && r->unit == 0) {
    for (size_t i = 0; i + 1 < r->count; i++)
      if (r->list[i].code == 9 && bwi_word_is(r->list[i].value, "$INSUNITS")) {
        int64_t number;
        BW_TRY(integer_of(r, &r->list[i + 1], &number));
        r->unit = unit_metres(number);
      }
  }
  if (entities) {
    *found = true;
    if (r->unit == 0) {
      r->unit = 1e-3;
      bw_warn(r->cursor->context,
              "%s: the drawing gives no unit ($INSUNITS): millimetres are assumed",
              r->cursor->name);
    }
  }
  for (int64_t n = 0; !bwi_word_is(r->ahead.value, "ENDSEC"); n++) {
    if (bwi_word_is(r->ahead.value, "EOF") || bwi_word_is(r->ahead.value, "SECTION"))
      BW_TRY(fail_group(r, &r->ahead, "an entity or ENDSEC"));
    BW_TRY(read_entity(r));
    if (entities)
      BW_TRY(read_curve(r));
    if (n % 4096 == 4095)
      BW_TRY(bw_check_cancel(r->cursor->context));
  }
  status = read_entity(r); /* to the next SECTION or EOF */
done:
  return status;
}

bw_status bwi_dxf_parse(bwi_cursor *cursor, double unit, bwi_contours *contours,
                        bw_read_info *info) {
  bw_status status = BW_OK;
  reader r = {.cursor = cursor, .contours = contours, .unit = unit};
  bool found = false;
  static const char binary[] = "AutoCAD Binary DXF";
  if (bwi_left(cursor) >= sizeof binary - 1 && memcmp(cursor->at, binary, sizeof binary - 1) == 0)
    return bwi_fail_byte(cursor, "this is a binary DXF file: save it as text (ASCII DXF)");
  do /* comments before the first section */
    BW_TRY(next_group(&r, &r.ahead));
  while (r.ahead.code == 999);
  if (r.ahead.code != 0)
    BW_TRY(fail_group(&r, &r.ahead, "the group 0, SECTION, that a DXF file begins with"));
  while (!bwi_word_is(r.ahead.value, "EOF")) {
    if (!bwi_word_is(r.ahead.value, "SECTION"))
      BW_TRY(fail_group(&r, &r.ahead, "SECTION or EOF"));
    BW_TRY(read_entity(&r));
    if (r.count == 0 || r.list[0].code != 2) {
      bwi_cursor at = *cursor;
      at.line = r.type_line;
      BW_TRY(bwi_fail_line(&at, "a SECTION without its name (group 2) was found"));
    }
    BW_TRY(read_section(&r, r.list[0].value, &found));
  }
  if (!found)
    BW_TRY(bwi_fail_line(cursor, "the section ENTITIES is missing"));
  if (info)
    *info = (bw_read_info){.format = "DXF", .skipped = r.skipped};
  if (r.skipped > 0)
    bw_warn(cursor->context,
            "%s: %lld of %lld entities are not plane curves (text, hatches, blocks, ...) and were "
            "ignored",
            cursor->name, (long long)r.skipped, (long long)r.entities);
done:
  bw_free(r.list);
  bw_free(r.number);
  return status;
}
