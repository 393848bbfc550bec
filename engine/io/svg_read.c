/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* SVG drawings: path, rect, circle, ellipse, polygon, polyline, line, in groups with transforms.
 * What draws nothing by itself (defs, clipPath, symbol, ...) and what is hidden (display none) is
 * passed over; text, images and uses are counted as skipped.
 *
 * Lengths: width and height of the outermost svg with its viewBox say what a user unit is; without
 * them it is a pixel, 1/96 inch. SVG's y goes down; here it goes up: y is mirrored about the middle
 * of the viewBox (or of the height, or about 0), so that the page keeps its place. */
#include <math.h>
#include <string.h>

#include "io/contours.h"
#include "io/vtu.h"

/* An element that is open. */
typedef struct level {
  bwi_word name;
  double matrix[6];
  int32_t tag; /* -1: none so far */
  bool hidden;
  int64_t line;
} level;

typedef struct reader {
  bwi_cursor *cursor;
  bwi_contours *contours;
  level *stack;
  size_t depth, capacity;
  double unit; /* asked for, or 0 */
  int64_t skipped;
  const unsigned char *counted; /* up to where `line` has counted */
  int64_t line;
  bool any;
} reader;

enum { DEEPEST = 1000 };

/* ---- attributes ------------------------------------------------------------------------------ */

/* A value as a cursor of its own, with its line. Values come in the order of the file within a tag,
 * but are asked for in any; lines are counted from the tag's start. */
static bwi_cursor value_cursor(const reader *r, bwi_word value) {
  bwi_cursor at = *r->cursor;
  at.line = r->line;
  for (const unsigned char *c = r->counted; c < value.at; c++)
    at.line += *c == '\n';
  at.at = value.at;
  at.end = value.at + value.length;
  return at;
}

static const struct {
  const char *name;
  double metres;
} units[] = {{"px", 0.0254 / 96}, {"mm", 1e-3},       {"cm", 1e-2},  {"in", 0.0254},
             {"pt", 0.0254 / 72}, {"pc", 0.0254 / 6}, {"Q", 2.5e-4}, {"m", 1}};

/* A length: a number of user units, or of metres when *absolute. */
static bw_status read_length(bwi_cursor *at, double *value, bool *absolute, const char *key) {
  bool any;
  *absolute = false;
  bw_status status = bwi_svg_number(at, value, &any);
  if (status != BW_OK)
    return status;
  if (!any)
    return bwi_fail_line(at, "'%s' is empty: a length was expected", key);
  bwi_word rest = {at->at, bwi_left(at)};
  while (rest.length > 0 && rest.at[rest.length - 1] <= ' ')
    rest.length--;
  if (rest.length == 0)
    return BW_OK;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (bwi_word_is(rest, units[i].name)) {
      *value *= units[i].metres;
      *absolute = true;
      return BW_OK;
    }
  return bwi_fail_word(at, rest, "a unit of length (px mm cm in pt pc)");
}

/* A length of a shape, in user units. */
static bw_status shape_length(const reader *r, const bwi_tag *tag, const char *key, double *value) {
  bwi_word word = bwi_xml_value(tag, key);
  bool absolute;
  if (word.length == 0)
    return BW_OK;
  bwi_cursor at = value_cursor(r, word);
  bw_status status = read_length(&at, value, &absolute, key);
  /* Units inside a drawing are pixels of the user's coordinates, by the standard. */
  if (status == BW_OK && absolute)
    *value /= 0.0254 / 96;
  return status;
}

/* With the five entities of XML. */
static bw_name name_of(bwi_word word) {
  static const struct {
    const char *entity;
    char is;
  } entities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  char text[4 * BW_NAME];
  size_t length = 0;
  for (size_t i = 0; i < word.length && length < sizeof text; i++) {
    char c = (char)word.at[i];
    for (size_t e = 0; c == '&' && e < 5; e++) {
      size_t n = strlen(entities[e].entity);
      if (word.length - i >= n && memcmp(word.at + i, entities[e].entity, n) == 0) {
        c = entities[e].is;
        i += n - 1;
        break;
      }
    }
    if (c != 0)
      text[length++] = c;
  }
  return bwi_name(text, length);
}

static bool says_hidden(const bwi_tag *tag) {
  bwi_word style = bwi_xml_value(tag, "style");
  if (bwi_word_is(bwi_xml_value(tag, "display"), "none"))
    return true;
  const unsigned char *at =
      style.length ? memmem(style.at, style.length, "display", strlen("display")) : NULL;
  if (!at)
    return false;
  size_t left = (size_t)(style.at + style.length - at) - strlen("display");
  at += strlen("display");
  while (left > 0 && (*at == ' ' || *at == ':')) {
    at++;
    left--;
  }
  return left >= 4 && memcmp(at, "none", 4) == 0;
}

/* The first word of a class. */
static int32_t class_tag(reader *r, const bwi_tag *tag, int32_t otherwise) {
  bwi_word word = bwi_xml_value(tag, "class");
  while (word.length > 0 && *word.at <= ' ') {
    word.at++;
    word.length--;
  }
  size_t length = 0;
  while (length < word.length && word.at[length] > ' ')
    length++;
  bw_name name = name_of((bwi_word){word.at, length});
  return name.text[0] ? bwi_draft_tag(&r->contours->draft, name.text) : otherwise;
}

/* ---- shapes ---------------------------------------------------------------------------------- */

static void add_ellipse(bwi_contours *c, const bw_name *name, int32_t region, int64_t line,
                        double cx, double cy, double rx, double ry) {
  const double start[2] = {cx + rx, cy};
  bwi_contours_begin(c, start, name, region, line);
  bwi_contours_arc(c, (double[]){cx, cy}, (double[]){rx, 0}, (double[]){0, ry}, 0,
                   2 * 3.14159265358979323846);
  bwi_contours_end(c, true);
}

/* A quarter of an ellipse at a corner, from the angle `from` on. */
static void add_corner(bwi_contours *c, double cx, double cy, double rx, double ry, double from) {
  const double half_pi = 1.57079632679489661923;
  const double start[2] = {cx + rx * cos(from), cy + ry * sin(from)};
  bwi_contours_line(c, start);
  bwi_contours_arc(c, (double[]){cx, cy}, (double[]){rx, 0}, (double[]){0, ry}, from,
                   from + half_pi);
}

static bw_status read_rect(reader *r, const bwi_tag *tag, const bw_name *name, int32_t region) {
  bw_status status = BW_OK;
  bwi_contours *c = r->contours;
  double x = 0, y = 0, w = 0, h = 0, rx = -1, ry = -1;
  const double half_pi = 1.57079632679489661923;
  BW_TRY(shape_length(r, tag, "x", &x));
  BW_TRY(shape_length(r, tag, "y", &y));
  BW_TRY(shape_length(r, tag, "width", &w));
  BW_TRY(shape_length(r, tag, "height", &h));
  BW_TRY(shape_length(r, tag, "rx", &rx));
  BW_TRY(shape_length(r, tag, "ry", &ry));
  if (!(w > 0 && h > 0))
    BW_TRY(bwi_fail_line(r->cursor, "a rect of %g x %g: a positive width and height were expected",
                         w, h));
  rx = fmin(rx < 0 ? fmax(ry, 0) : rx, w / 2);
  ry = fmin(ry < 0 ? fmax(rx, 0) : ry, h / 2);
  if (!(rx > 0 && ry > 0)) {
    bwi_contours_begin(c, (double[]){x, y}, name, region, r->line);
    bwi_contours_line(c, (double[]){x + w, y});
    bwi_contours_line(c, (double[]){x + w, y + h});
    bwi_contours_line(c, (double[]){x, y + h});
  } else {
    bwi_contours_begin(c, (double[]){x + rx, y}, name, region, r->line);
    add_corner(c, x + w - rx, y + ry, rx, ry, -half_pi);
    add_corner(c, x + w - rx, y + h - ry, rx, ry, 0);
    add_corner(c, x + rx, y + h - ry, rx, ry, half_pi);
    add_corner(c, x + rx, y + ry, rx, ry, 2 * half_pi);
  }
  bwi_contours_end(c, true);
done:
  return status;
}

static bw_status read_ellipse(reader *r, const bwi_tag *tag, const bw_name *name, int32_t region,
                              bool circle) {
  bw_status status = BW_OK;
  double cx = 0, cy = 0, rx = 0, ry = 0;
  BW_TRY(shape_length(r, tag, "cx", &cx));
  BW_TRY(shape_length(r, tag, "cy", &cy));
  BW_TRY(shape_length(r, tag, circle ? "r" : "rx", &rx));
  if (circle)
    ry = rx;
  else
    BW_TRY(shape_length(r, tag, "ry", &ry));
  if (!(rx > 0 && ry > 0))
    BW_TRY(bwi_fail_line(r->cursor, "radii of %g and %g: positive ones were expected", rx, ry));
  add_ellipse(r->contours, name, region, r->line, cx, cy, rx, ry);
done:
  return status;
}

static bw_status read_points(reader *r, const bwi_tag *tag, const bw_name *name, int32_t region,
                             bool close) {
  bw_status status = BW_OK;
  bwi_cursor at = value_cursor(r, bwi_xml_value(tag, "points"));
  double point[2];
  int64_t count = 0;
  for (bool any;; count++) {
    BW_TRY(bwi_svg_number(&at, &point[0], &any));
    if (!any)
      break;
    BW_TRY(bwi_svg_number(&at, &point[1], &any));
    if (!any)
      BW_TRY(bwi_fail_line(&at, "the points end behind an x: pairs of numbers were expected"));
    if (count == 0)
      bwi_contours_begin(r->contours, point, name, region, r->line);
    else
      bwi_contours_line(r->contours, point);
  }
  if (count > 0)
    bwi_contours_end(r->contours, close);
done:
  return status;
}

static bw_status read_line(reader *r, const bwi_tag *tag, const bw_name *name, int32_t region) {
  bw_status status = BW_OK;
  double from[2] = {0, 0}, to[2] = {0, 0};
  BW_TRY(shape_length(r, tag, "x1", &from[0]));
  BW_TRY(shape_length(r, tag, "y1", &from[1]));
  BW_TRY(shape_length(r, tag, "x2", &to[0]));
  BW_TRY(shape_length(r, tag, "y2", &to[1]));
  bwi_contours_begin(r->contours, from, name, region, r->line);
  bwi_contours_line(r->contours, to);
  bwi_contours_end(r->contours, false);
done:
  return status;
}

/* ---- what the writer adds -------------------------------------------------------------------- */

/* data-region: "hole", or a number from 1. */
static bw_status read_region(const reader *r, const bwi_tag *tag, int32_t *region) {
  bwi_word word = bwi_xml_value(tag, "data-region");
  int64_t number;
  const unsigned char *after;
  *region = BWI_REGION_BY_NESTING;
  if (word.length == 0)
    return BW_OK;
  if (bwi_word_is(word, "hole")) {
    *region = -1;
    return BW_OK;
  }
  if (!bwi_parse_integer(word.at, word.at + word.length, &number, &after) ||
      after != word.at + word.length || number < 1 || number > 1000000)
    return bwi_fail_word(r->cursor, word, "'hole' or the number of a region, from 1,");
  *region = (int32_t)number - 1;
  return BW_OK;
}

static int hexadecimal(unsigned char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                : -1;
}

/* data-tags: "name*count name ...", blanks and the like as %20, for the edges from `first` on. Only
 * when the counts are right: whoever edited the curve did not know of them. */
static void read_tags(reader *r, const bwi_tag *tag, size_t first) {
  bwi_contours *c = r->contours;
  bwi_cursor at = value_cursor(r, bwi_xml_value(tag, "data-tags"));
  size_t edge = first;
  bool closed = c->pieces > 0 && c->piece[c->pieces - 1].closed;
  size_t last = c->edges - closed; /* without the closing line of no length */
  bwi_word word;
  for (int pass = 0; pass < 2 && c->status == BW_OK; pass++) {
    bwi_cursor list = at;
    edge = first;
    while (bwi_next_word(&list, &word)) {
      const unsigned char *star = memchr(word.at, '*', word.length), *after;
      bwi_word name = {word.at, star ? (size_t)(star - word.at) : word.length};
      int64_t count = 1;
      if (star && (!bwi_parse_integer(star + 1, word.at + word.length, &count, &after) ||
                   after != word.at + word.length || count < 1))
        return;
      if ((uint64_t)count > last - edge)
        return;
      bw_name plain = {""};
      size_t length = 0;
      for (size_t i = 0; i < name.length && length < BW_NAME - 1; i++) {
        int high = i + 2 < name.length ? hexadecimal(name.at[i + 1]) : -1;
        int low = i + 2 < name.length ? hexadecimal(name.at[i + 2]) : -1;
        bool escaped = name.at[i] == '%' && high >= 0 && low >= 0 && high + low > 0;
        plain.text[length++] = escaped ? (char)(16 * high + low) : (char)name.at[i];
        i += escaped ? 2 : 0;
      }
      if (pass == 1) {
        int32_t number = bwi_draft_tag(&c->draft, plain.text);
        for (int64_t i = 0; i < count; i++)
          c->edge[edge + (size_t)i].tag = number;
      }
      edge += (size_t)count;
    }
    if (edge != last)
      return;
  }
}

/* ---- elements -------------------------------------------------------------------------------- */

static bool one_of(bwi_word name, const char *const *words) {
  for (; *words; words++)
    if (bwi_word_is(name, *words))
      return true;
  return false;
}

static bw_status read_shape(reader *r, const bwi_tag *tag, const level *now) {
  static const char *const others[] = {"text", "image", "use", "foreignObject", NULL};
  bw_status status = BW_OK;
  bwi_contours *c = r->contours;
  int32_t region;
  size_t first = c->edges;
  bwi_word wanted = bwi_xml_value(tag, "data-name");
  bw_name name = name_of(wanted.length ? wanted : bwi_xml_value(tag, "id"));
  BW_TRY(read_region(r, tag, &region));
  c->tag = now->tag >= 0 ? now->tag : bwi_draft_tag(&c->draft, "boundary");
  memcpy(c->matrix, now->matrix, sizeof c->matrix);
  if (bwi_word_is(tag->name, "path")) {
    bwi_cursor at = value_cursor(r, bwi_xml_value(tag, "d"));
    BW_TRY(bwi_svg_path(&at, c, &name, region));
  } else if (bwi_word_is(tag->name, "rect"))
    BW_TRY(read_rect(r, tag, &name, region));
  else if (bwi_word_is(tag->name, "circle"))
    BW_TRY(read_ellipse(r, tag, &name, region, true));
  else if (bwi_word_is(tag->name, "ellipse"))
    BW_TRY(read_ellipse(r, tag, &name, region, false));
  else if (bwi_word_is(tag->name, "polygon"))
    BW_TRY(read_points(r, tag, &name, region, true));
  else if (bwi_word_is(tag->name, "polyline"))
    BW_TRY(read_points(r, tag, &name, region, false));
  else if (bwi_word_is(tag->name, "line"))
    BW_TRY(read_line(r, tag, &name, region));
  else
    r->skipped += one_of(tag->name, others);
  if (c->edges > first)
    read_tags(r, tag, first);
done:
  return status;
}

/* What a user unit of the outermost svg is, and where y is mirrored. */
static bw_status read_root(reader *r, const bwi_tag *tag, double matrix[6]) {
  bw_status status = BW_OK;
  static const char *const key[2] = {"width", "height"};
  double size[2] = {0, 0}, box[4] = {0, 0, 0, 0}, unit = 0;
  bool absolute[2] = {false, false};
  bwi_word view = bwi_xml_value(tag, "viewBox");
  if (view.length) {
    bwi_cursor at = value_cursor(r, view);
    for (int i = 0; i < 4; i++) {
      bool any;
      BW_TRY(bwi_svg_number(&at, &box[i], &any));
      if (!any)
        BW_TRY(bwi_fail_line(&at, "a viewBox of %d numbers: four were expected", i));
    }
    if (!(box[2] > 0 && box[3] > 0))
      BW_TRY(bwi_fail_line(&at, "a viewBox of %g x %g: a positive width and height were expected",
                           box[2], box[3]));
  }
  for (int k = 0; k < 2; k++) {
    bwi_word word = bwi_xml_value(tag, key[k]);
    if (word.length == 0 || word.at[word.length - 1] == '%' || bwi_word_is(word, "auto"))
      continue;
    bwi_cursor at = value_cursor(r, word);
    BW_TRY(read_length(&at, &size[k], &absolute[k], key[k]));
    if (!absolute[k])
      size[k] *= 0.0254 / 96;
    if (!(size[k] > 0))
      BW_TRY(bwi_fail_line(&at, "the drawing's %s is %g: a positive length was expected", key[k],
                           size[k]));
  }
  if (view.length == 0 && size[1] > 0)
    box[3] = size[1] / (0.0254 / 96);
  if (r->unit > 0)
    unit = r->unit;
  else if (view.length && (size[0] > 0 || size[1] > 0))
    unit =
        fmin(size[0] > 0 ? size[0] / box[2] : HUGE_VAL, size[1] > 0 ? size[1] / box[3] : HUGE_VAL);
  else
    unit = 0.0254 / 96;
  if (r->unit == 0 && !absolute[0] && !absolute[1])
    bw_warn(r->cursor->context,
            "%s: the drawing has no size in a unit of length: its units are taken as pixels of "
            "1/96 inch",
            r->cursor->name);
  const double root[6] = {unit, 0, 0, -unit, 0, unit * (2 * box[1] + box[3])};
  memcpy(matrix, root, sizeof root);
done:
  return status;
}

static bw_status open_element(reader *r, const bwi_tag *tag) {
  static const char *const aside[] = {"defs",  "clipPath", "symbol",   "marker",         "pattern",
                                      "mask",  "filter",   "metadata", "style",          "script",
                                      "title", "desc",     "font",     "linearGradient", NULL};
  bw_status status = BW_OK;
  level now = {.name = tag->name, .matrix = {1, 0, 0, 1, 0, 0}, .tag = -1, .line = r->line};
  if (r->depth > 0) {
    now = r->stack[r->depth - 1];
    now.name = tag->name;
    now.line = r->line;
  } else {
    if (!bwi_word_is(tag->name, "svg"))
      return bwi_fail_word(r->cursor, tag->name, "the element svg that a drawing begins with");
    r->any = true;
    BW_TRY(read_root(r, tag, now.matrix));
  }
  now.hidden = now.hidden || one_of(tag->name, aside) || says_hidden(tag);
  if (!now.hidden) {
    if (r->depth > 0 && bwi_word_is(tag->name, "svg")) {
      double place[6] = {1, 0, 0, 1, 0, 0};
      BW_TRY(shape_length(r, tag, "x", &place[4]));
      BW_TRY(shape_length(r, tag, "y", &place[5]));
      if (bwi_xml_value(tag, "viewBox").length)
        BW_TRY(bwi_fail_line(r->cursor,
                             "an svg with a viewBox inside another: such drawings are not "
                             "read; put its content in a group"));
      bwi_matrix_multiply(now.matrix, place);
    }
    bwi_word transform = bwi_xml_value(tag, "transform");
    if (transform.length) {
      bwi_cursor at = value_cursor(r, transform);
      BW_TRY(bwi_svg_transform(&at, now.matrix));
    }
    now.tag = class_tag(r, tag, now.tag);
    BW_TRY(read_shape(r, tag, &now));
  }
  if (tag->empty)
    goto done;
  if (r->depth >= DEEPEST)
    BW_TRY(bwi_fail_line(r->cursor, "elements are nested more than %d deep", DEEPEST));
  if (!bw_grow(r->cursor->context, (void **)&r->stack, &r->capacity, r->depth, 1, sizeof *r->stack))
    return BW_MEMORY;
  r->stack[r->depth++] = now;
done:
  return status;
}

static bw_status close_element(reader *r, const bwi_tag *tag) {
  if (r->depth == 0)
    return bwi_fail_line(r->cursor, "</%s> closes nothing", bwi_show(tag->name));
  const level *open = &r->stack[r->depth - 1];
  if (open->name.length != tag->name.length ||
      memcmp(open->name.at, tag->name.at, tag->name.length) != 0)
    return bwi_fail_line(r->cursor, "</%s> where </%s> was expected, for the element of line %lld",
                         bwi_show(tag->name), bwi_show(open->name), (long long)open->line);
  r->depth--;
  return BW_OK;
}

bw_status bwi_svg_parse(bwi_cursor *cursor, double unit, bwi_contours *contours,
                        bw_read_info *info) {
  bw_status status = BW_OK;
  reader r = {.cursor = cursor, .contours = contours, .unit = unit};
  bwi_tag tag;
  for (int64_t n = 0;; n++) {
    bool any;
    r.counted = cursor->at;
    r.line = cursor->line;
    BW_TRY(bwi_xml_next(cursor, &tag, &any));
    if (!any)
      break;
    while (r.counted < tag.name.at)
      r.line += *r.counted++ == '\n';
    if (tag.name.length > 4 && memcmp(tag.name.at, "svg:", 4) == 0)
      tag.name = (bwi_word){tag.name.at + 4, tag.name.length - 4};
    BW_TRY(tag.closing ? close_element(&r, &tag) : open_element(&r, &tag));
    if (r.depth == 0 && r.any)
      break; /* what stands behind the drawing is not looked at */
    if (n % 4096 == 4095)
      BW_TRY(bw_check_cancel(cursor->context));
  }
  if (!r.any)
    BW_TRY(bwi_fail_line(cursor, "no element svg is in the file"));
  if (r.depth > 0)
    BW_TRY(bwi_fail_line(cursor, "the file ends inside the element '%s' of line %lld",
                         bwi_show(r.stack[r.depth - 1].name),
                         (long long)r.stack[r.depth - 1].line));
  if (info) {
    *info = (bw_read_info){.format = "SVG", .skipped = r.skipped};
  }
  if (r.skipped > 0)
    bw_warn(cursor->context,
            "%s: %lld elements (text, image, use) were ignored: convert them to paths to read them",
            cursor->name, (long long)r.skipped);
done:
  bw_free(r.stack);
  return status;
}
