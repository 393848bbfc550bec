/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* PLY: a text header that lists elements and their properties, then the elements as text or as
 * binary of either byte order. Used are x y z of "vertex", the list "vertex_indices" (or
 * "vertex_index") of "face", the rows of "tristrips", and, when it is an integer, the scalar
 * "group" of "face", which is what barwright writes; everything else is passed over. */
#include "io/surface_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 32, MAX_PROPERTIES = 256 };

typedef enum scalar { NONE, I8, U8, I16, U16, I32, U32, F32, F64 } scalar;
static const size_t scalar_size[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};

typedef enum meaning { IGNORED, X, Y, Z, CORNERS, GROUP, STRIP } meaning;

typedef struct property {
  scalar count, type; /* count: of a list; NONE for a scalar */
  meaning meaning;
} property;

typedef enum role { OTHER, VERTEX, FACE, STRIPS } role;

typedef struct element {
  bwi_word name;
  role role;
  int64_t count;
  int first, end; /* properties */
} element;

typedef struct ply {
  enum { TEXT, LITTLE, BIG } encoding;
  int element_count, property_count;
  element element[MAX_ELEMENTS];
  property property[MAX_PROPERTIES];
  int32_t *list; /* of the present list property */
  size_t list_count, list_capacity;
} ply;

/* ---- header -------------------------------------------------------------------------------- */

static scalar scalar_of(bwi_word word) {
  static const struct {
    const char *name;
    scalar type;
  } names[] = {{"char", I8},   {"int8", I8},     {"uchar", U8},   {"uint8", U8},
               {"short", I16}, {"int16", I16},   {"ushort", U16}, {"uint16", U16},
               {"int", I32},   {"int32", I32},   {"uint", U32},   {"uint32", U32},
               {"float", F32}, {"float32", F32}, {"double", F64}, {"float64", F64}};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (bwi_word_is(word, names[i].name))
      return names[i].type;
  return NONE;
}

static bw_status read_scalar_type(bwi_cursor *line, scalar *type) {
  bwi_word word;
  bwi_next_word(line, &word);
  *type = scalar_of(word);
  return *type == NONE ? bwi_fail_word(line, word, "a type (float, double, uchar, int, ...)")
                       : BW_OK;
}

static meaning meaning_of(role owner, const property *p, bwi_word name) {
  static const char *const axis[3] = {"x", "y", "z"};
  bool list = p->count != NONE;
  if (owner == VERTEX && !list)
    for (int k = 0; k < 3; k++)
      if (bwi_word_is(name, axis[k]))
        return (meaning)(X + k);
  bool indices = bwi_word_is(name, "vertex_indices") || bwi_word_is(name, "vertex_index");
  if (list && indices && owner == FACE)
    return CORNERS;
  if (list && indices && owner == STRIPS)
    return STRIP;
  if (owner == FACE && !list && p->type != F32 && p->type != F64 && bwi_word_is(name, "group"))
    return GROUP;
  return IGNORED;
}

static bw_status read_property(bwi_cursor *line, ply *file) {
  bw_status status = BW_OK;
  if (file->element_count == 0)
    BW_TRY(bwi_fail_line(line, "a property before the first element"));
  if (file->property_count == MAX_PROPERTIES)
    BW_TRY(bwi_fail_line(line, "more than %d properties", MAX_PROPERTIES));
  element *owner = &file->element[file->element_count - 1];
  property *p = &file->property[file->property_count];
  bwi_word word;
  *p = (property){NONE, NONE, IGNORED};
  if (bwi_word_is(bwi_peek_word(line), "list")) {
    bwi_next_word(line, &word);
    BW_TRY(read_scalar_type(line, &p->count));
    if (p->count == F32 || p->count == F64)
      BW_TRY(bwi_fail_line(line, "a list whose length is a real number"));
  }
  BW_TRY(read_scalar_type(line, &p->type));
  if (!bwi_next_word(line, &word))
    BW_TRY(bwi_fail_word(line, word, "the name of a property"));
  p->meaning = meaning_of(owner->role, p, word);
  if ((p->meaning == CORNERS || p->meaning == STRIP) && (p->type == F32 || p->type == F64))
    BW_TRY(bwi_fail_line(line, "corners that are real numbers"));
  owner->end = ++file->property_count;
done:
  return status;
}

static bw_status read_element(bwi_cursor *line, ply *file) {
  bw_status status = BW_OK;
  if (file->element_count == MAX_ELEMENTS)
    BW_TRY(bwi_fail_line(line, "more than %d kinds of elements", MAX_ELEMENTS));
  element *e = &file->element[file->element_count];
  if (!bwi_next_word(line, &e->name))
    BW_TRY(bwi_fail_word(line, e->name, "the name of an element"));
  BW_TRY(bwi_read_integer(line, &e->count, "the number of elements"));
  if (e->count < 0)
    BW_TRY(bwi_fail_line(line, "%lld elements: a count cannot be negative", (long long)e->count));
  e->role = bwi_word_is(e->name, "vertex")      ? VERTEX
            : bwi_word_is(e->name, "face")      ? FACE
            : bwi_word_is(e->name, "tristrips") ? STRIPS
                                                : OTHER;
  e->first = e->end = file->property_count;
  file->element_count++;
done:
  return status;
}

static bw_status read_format(bwi_cursor *line, ply *file) {
  bwi_word word, version;
  bwi_next_word(line, &word);
  bwi_next_word(line, &version);
  if (bwi_word_is(word, "ascii"))
    file->encoding = TEXT;
  else if (bwi_word_is(word, "binary_little_endian"))
    file->encoding = LITTLE;
  else if (bwi_word_is(word, "binary_big_endian"))
    file->encoding = BIG;
  else
    return bwi_fail_word(line, word, "'ascii', 'binary_little_endian' or 'binary_big_endian'");
  if (!bwi_word_is(version, "1.0"))
    return bwi_fail_word(line, version, "version 1.0");
  return BW_OK;
}

/* Each element must at least be able to fit into the rest of the file. */
static bw_status check_counts(const bwi_cursor *cursor, const ply *file) {
  for (int i = 0; i < file->element_count; i++) {
    const element *e = &file->element[i];
    size_t min = 0;
    for (int k = e->first; k < e->end; k++) {
      const property *p = &file->property[k];
      min += file->encoding == TEXT ? 2 : scalar_size[p->count != NONE ? p->count : p->type];
    }
    char what[80];
    snprintf(what, sizeof what, "the number of elements '%s'", bwi_show(e->name));
    bw_status status = bwi_check_count(cursor, (uint64_t)e->count, min, what);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

static bw_status read_header(bwi_cursor *cursor, ply *file) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bwi_word word;
  bool format = false, ended = false;
  bwi_next_line(cursor, &line); /* "ply" */
  while (!ended) {
    if (!bwi_next_line(cursor, &line))
      BW_TRY(bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, "'end_header'"));
    if (!bwi_next_word(&line, &word))
      continue;
    ended = bwi_word_is(word, "end_header");
    if (bwi_word_is(word, "format")) {
      BW_TRY(read_format(&line, file));
      format = true;
    } else if (bwi_word_is(word, "element")) {
      BW_TRY(read_element(&line, file));
    } else if (bwi_word_is(word, "property")) {
      BW_TRY(read_property(&line, file));
    } else if (!ended && !bwi_word_is(word, "comment") && !bwi_word_is(word, "obj_info")) {
      BW_TRY(bwi_fail_word(&line, word, "'element', 'property', 'comment' or 'end_header'"));
    }
  }
  if (!format)
    BW_TRY(bwi_fail_line(&line, "the header ends without a line 'format'"));
  cursor->swap =
      file->encoding != TEXT && (file->encoding == BIG) != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
  BW_TRY(check_counts(cursor, file));
done:
  return status;
}

/* ---- elements ------------------------------------------------------------------------------ */

/* A scalar as a double (which holds every int32 and uint32 exactly). */
static bw_status read_scalar(bwi_cursor *cursor, const ply *file, scalar type, bool finite,
                             double *value) {
  const unsigned char *bytes;
  bw_status status = BW_OK;
  if (file->encoding == TEXT) {
    if (finite)
      return bwi_read_real(cursor, value, "a number");
    bwi_word word;
    if (!bwi_next_word(cursor, &word)) /* ignored: nan and the like may stand here */
      return bwi_fail_word(cursor, word, "a property");
    *value = 0;
    return BW_OK;
  }
  BW_TRY(bwi_take(cursor, scalar_size[type], &bytes, "a property"));
  switch (type) {
  case I8:
    *value = (int8_t)bytes[0];
    break;
  case U8:
    *value = bytes[0];
    break;
  case I16:
    *value = (int16_t)bwi_u16(bytes, cursor->swap);
    break;
  case U16:
    *value = bwi_u16(bytes, cursor->swap);
    break;
  case I32:
    *value = (int32_t)bwi_u32(bytes, cursor->swap);
    break;
  case U32:
    *value = bwi_u32(bytes, cursor->swap);
    break;
  case F32:
    *value = (double)bwi_f32(bytes, cursor->swap);
    break;
  default:
    *value = bwi_f64(bytes, cursor->swap);
  }
  if (finite && !isfinite(*value)) {
    cursor->at = bytes;
    status = bwi_fail_byte(cursor, "found %g where a finite number was expected", *value);
  }
done:
  return status;
}

static bw_status fail_here(const bwi_cursor *cursor, const ply *file, const char *text) {
  return file->encoding == TEXT ? bwi_fail_line(cursor, "%s", text)
                                : bwi_fail_byte(cursor, "%s", text);
}

/* A list of point numbers into file->list; -1, which parts strips, is let through. */
static bw_status read_list(bwi_cursor *cursor, ply *file, const property *p, size_t points) {
  bw_status status = BW_OK;
  double length, value;
  char text[160];
  BW_TRY(read_scalar(cursor, file, p->count, true, &length));
  size_t min = file->encoding == TEXT ? 2 : scalar_size[p->type];
  if (!(length >= 0) || length != floor(length) || length > (double)(bwi_left(cursor) + 1)) {
    snprintf(text, sizeof text, "a list of length %g, but only %zu bytes follow", length,
             bwi_left(cursor));
    BW_TRY(fail_here(cursor, file, text));
  }
  BW_TRY(bwi_check_count(cursor, (uint64_t)length, min, "the length of a list"));
  file->list_count = (size_t)length;
  if (p->meaning == IGNORED && file->encoding != TEXT) {
    const unsigned char *bytes;
    return bwi_take(cursor, file->list_count * min, &bytes, "a list");
  }
  BW_TRY_MEMORY(bw_grow(cursor->context, (void **)&file->list, &file->list_capacity, 0,
                        file->list_count + 1, sizeof *file->list));
  for (size_t i = 0; i < file->list_count; i++) {
    BW_TRY(read_scalar(cursor, file, p->type, p->meaning != IGNORED, &value));
    if (p->meaning == IGNORED)
      continue;
    bool parts = p->meaning == STRIP && value == -1;
    if (!parts && (!(value >= 0) || value >= (double)points || value != floor(value))) {
      snprintf(text, sizeof text,
               "a facet names vertex %.15g, but there are %zu vertices, numbered from 0", value,
               points);
      BW_TRY(fail_here(cursor, file, text));
    }
    file->list[i] = (int32_t)value;
  }
done:
  return status;
}

static bw_status add_strips(bwi_soup *soup, const ply *file) {
  size_t start = 0; /* of the present strip: every other triangle from there is reversed */
  for (size_t i = 0; i < file->list_count; i++) {
    const int32_t *v = file->list + i;
    if (v[0] < 0)
      start = i + 1;
    if (i + 1 < start + 3 || v[0] == v[-1] || v[0] == v[-2] || v[-1] == v[-2])
      continue;
    bool reversed = (i - start) % 2 == 1;
    bw_status status = bwi_soup_triangle(soup, v[reversed ? -1 : -2], v[reversed ? -2 : -1], v[0]);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

static bw_status add_face(bwi_cursor *cursor, const ply *file, bwi_soup *soup,
                          const int32_t *corner, size_t count) {
  char text[100];
  if (count > BWI_POLYGON_CORNERS) {
    snprintf(text, sizeof text, "a facet of more than %d corners", BWI_POLYGON_CORNERS);
    return fail_here(cursor, file, text);
  }
  if (count < 3) {
    soup->skipped++;
    return BW_OK;
  }
  return bwi_soup_polygon(soup, corner, count);
}

static bw_status read_one(bwi_cursor *cursor, ply *file, const element *e, bwi_soup *soup) {
  bw_status status = BW_OK;
  double x[3] = {0, 0, 0}, value, group = 0;
  bool grouped = false;
  size_t first = soup->triangle_count;
  for (int k = e->first; k < e->end; k++) {
    const property *p = &file->property[k];
    if (p->count == NONE) {
      BW_TRY(read_scalar(cursor, file, p->type, p->meaning != IGNORED, &value));
      if (p->meaning >= X && p->meaning <= Z)
        x[p->meaning - X] = value;
      if (p->meaning == GROUP) {
        grouped = fabs(value) <= INT32_MAX;
        group = value;
      }
      continue;
    }
    BW_TRY(read_list(cursor, file, p, soup->point_count));
    if (p->meaning == STRIP)
      BW_TRY(add_strips(soup, file));
    if (p->meaning == CORNERS)
      BW_TRY(add_face(cursor, file, soup, file->list, file->list_count));
  }
  if (grouped)
    bwi_soup_regroup(soup, first, (int32_t)group);
  if (e->role == VERTEX)
    BW_TRY(bwi_soup_point(soup, x));
done:
  return status;
}

static bw_status read_elements(bwi_cursor *cursor, ply *file, bwi_soup *soup) {
  bw_status status = BW_OK;
  for (int i = 0; i < file->element_count; i++) {
    const element *e = &file->element[i];
    if (e->first == e->end && e->count > 0 && e->role != OTHER)
      BW_TRY(bwi_fail_line(cursor, "the element '%s' has no properties", bwi_show(e->name)));
    for (int64_t j = 0; j < e->count && e->first < e->end; j++) {
      BW_TRY(read_one(cursor, file, e, soup));
      if (j % 65536 == 0)
        BW_TRY(bw_check_cancel(cursor->context));
    }
    if (e->role == OTHER)
      soup->skipped += e->count;
  }
done:
  return status;
}

static bool has_meaning(const ply *file, meaning wanted) {
  for (int i = 0; i < file->property_count; i++)
    if (file->property[i].meaning == wanted)
      return true;
  return false;
}

bw_status bwi_ply_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  static const char *const format[] = {"PLY ASCII", "PLY binary little endian",
                                       "PLY binary big endian"};
  bw_status status = BW_OK;
  ply file = {0};
  bwi_soup soup;
  bwi_soup_init(&soup, cursor->context, cursor->name);
  BW_TRY(read_header(cursor, &file));
  for (int k = X; k <= Z; k++)
    if (!has_meaning(&file, (meaning)k))
      BW_TRY(bwi_fail_line(cursor, "the header names no property %c of an element 'vertex'",
                           'x' + k - X));
  if (!has_meaning(&file, CORNERS) && !has_meaning(&file, STRIP))
    BW_TRY(bwi_fail_line(cursor, "the header names no list vertex_indices of an element 'face': "
                                 "only points, no surface"));
  BW_TRY(read_elements(cursor, &file, &soup));
  BW_TRY(bwi_soup_finish(&soup, format[file.encoding], false, surface, info));
done:
  bw_free(file.list);
  bwi_soup_clear(&soup);
  return status;
}

/* ---- writing ------------------------------------------------------------------------------- */

static void put_u32(bw_writer *writer, uint32_t value) {
  unsigned char bytes[4];
  for (int k = 0; k < 4; k++)
    bytes[k] = (unsigned char)(value >> 8 * k);
  bw_writer_bytes(writer, bytes, 4);
}

static void put_f64(bw_writer *writer, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  put_u32(writer, (uint32_t)bits);
  put_u32(writer, (uint32_t)(bits >> 32));
}

/* A field as a scalar property; its name is one word. */
static void put_property(bw_writer *writer, const bw_field *field) {
  char name[64];
  size_t length = 0;
  for (const char *c = field->name; *c && length + 1 < sizeof name; c++)
    name[length++] = *c > ' ' && *c < 127 ? *c : '_';
  name[length] = 0;
  bw_writer_print(writer, "property double %s\n", name);
}

/* The groups of facets, NULL where all are 0: these say nothing, and some readers know no facets
 * with numbers. */
static const int32_t *groups_of(const bw_surface *surface) {
  for (int32_t i = 0; surface->group && i < surface->triangle_count; i++)
    if (surface->group[i] != 0)
      return surface->group;
  return NULL;
}

static void put_header(bw_writer *writer, const bw_surface *surface, const int32_t *group,
                       const bw_surface_write_options *options) {
  static const char colours[] = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const bool coloured = options->colour != NULL;
  bw_writer_print(writer,
                  "ply\nformat %s 1.0\ncomment barwright\nelement vertex %d\nproperty double x\n"
                  "property double y\nproperty double z\n%s",
                  options->ascii ? "ascii" : "binary_little_endian", (int)surface->point_count,
                  coloured && !options->colour_on_facets ? colours : "");
  for (int k = 0; k < options->field_count; k++)
    if (options->fields[k].place == BW_ON_NODES)
      put_property(writer, &options->fields[k]);
  bw_writer_print(writer, "element face %d\n%s%s", (int)surface->triangle_count,
                  group ? "property int group\n" : "",
                  coloured && options->colour_on_facets ? colours : "");
  for (int k = 0; k < options->field_count; k++)
    if (options->fields[k].place == BW_ON_ELEMENTS)
      put_property(writer, &options->fields[k]);
  bw_writer_print(writer, "property list uchar int vertex_indices\nend_header\n");
}

/* A number of text, and the white space before it unless the line begins with it. */
static void put_text(bw_writer *writer, double value, bool *begun) {
  bw_writer_bytes(writer, " ", *begun);
  bw_writer_number(writer, value);
  *begun = true;
}

/* Colour and fields of a point or facet. *begun: the line has something. */
static void put_values(bw_writer *writer, const bw_surface_write_options *options,
                       bw_field_place place, int32_t i, bool *begun) {
  const unsigned char *colour = options->colour;
  if (colour && options->colour_on_facets == (place == BW_ON_ELEMENTS)) {
    colour += 3 * (size_t)i;
    for (int k = 0; options->ascii && k < 3; k++)
      put_text(writer, colour[k], begun);
    bw_writer_bytes(writer, colour, options->ascii ? 0 : 3);
  }
  for (int k = 0; k < options->field_count; k++) {
    if (options->fields[k].place != place)
      continue;
    double value = bw_array_get(options->fields[k].array, i, 0);
    if (options->ascii)
      put_text(writer, value, begun);
    else
      put_f64(writer, value);
  }
}

/* Scalars stand before the list of corners: some readers know no other order. */
bw_status bwi_ply_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options) {
  const bool ascii = options->ascii;
  const int32_t *group = groups_of(surface);
  put_header(writer, surface, group, options);
  for (int32_t i = 0; i < surface->point_count; i++) {
    bool begun = false;
    for (size_t k = 0; k < 3; k++) {
      double value = surface->point[3 * (size_t)i + k];
      if (ascii)
        put_text(writer, value, &begun);
      else
        put_f64(writer, value);
    }
    put_values(writer, options, BW_ON_NODES, i, &begun);
    bw_writer_bytes(writer, "\n", ascii);
  }
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    const int32_t *t = surface->triangle + 3 * (size_t)i;
    bool begun = false;
    if (group && ascii)
      put_text(writer, group[i], &begun);
    else if (group)
      put_u32(writer, (uint32_t)group[i]);
    put_values(writer, options, BW_ON_ELEMENTS, i, &begun);
    if (ascii) {
      bw_writer_print(writer, "%s3 %d %d %d\n", begun ? " " : "", (int)t[0], (int)t[1], (int)t[2]);
      continue;
    }
    bw_writer_bytes(writer, "\3", 1);
    for (int k = 0; k < 3; k++)
      put_u32(writer, (uint32_t)t[k]);
  }
  return bw_writer_bytes(writer, NULL, 0);
}
