/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* VTU files: the tags first, which say where each array is, then the arrays. Tetrahedra (10, 24)
 * make the mesh; triangles, quadrilaterals and polygons (5, 7, 8, 9, 22, 23) are kept for a
 * surface; other cells are counted. Several pieces are put one behind the other; their fields are
 * read only when there is one piece, since pieces need not agree on them. */
#include "io/vtu.h"

#include <math.h>
#include <string.h>

typedef enum section {
  ELSEWHERE,
  IN_POINTS,
  IN_CELLS,
  IN_POINT_DATA,
  IN_CELL_DATA,
  IN_FIELD_DATA
} section;

typedef struct piece {
  int64_t points, cells, line;
} piece;

typedef struct announced {
  bwi_vtu_array array;
  section section;
  size_t piece;
} announced;

typedef struct vtu {
  bwi_vtu_file file;
  piece *piece;
  announced *array;
  size_t piece_count, piece_capacity, array_count, array_capacity;
} vtu;

/* ---- tags ---------------------------------------------------------------------------------- */

static bwi_vtk_type type_of(bwi_word word) {
  static const char *const name[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                     "UInt32", "Int64", "UInt64", "Float32", "Float64"};
  for (size_t i = 0; i < sizeof name / sizeof *name; i++)
    if (bwi_word_is(word, name[i]))
      return (bwi_vtk_type)(i + 1);
  return BWI_VTK_NONE;
}

/* A count attribute; absent: `otherwise`, or refused when that is negative. */
static bw_status count_attribute(const bwi_cursor *cursor, const bwi_tag *tag, const char *key,
                                 int64_t otherwise, int64_t *value) {
  bwi_word word = bwi_xml_value(tag, key);
  const unsigned char *after;
  *value = otherwise;
  if (word.length == 0 && otherwise >= 0)
    return BW_OK;
  while (word.length && *word.at == ' ')
    word.at++, word.length--;
  if (!bwi_parse_integer(word.at, word.at + word.length, value, &after) || *value < 0)
    return bwi_fail_line(cursor, "found %s=\"%s\" in the tag %s where a count was expected", key,
                         bwi_show(word), bwi_show(tag->name));
  return BW_OK;
}

static bw_status start_file(bwi_cursor *cursor, const bwi_tag *tag, vtu *file) {
  bwi_word type = bwi_xml_value(tag, "type"), order = bwi_xml_value(tag, "byte_order");
  bwi_word header = bwi_xml_value(tag, "header_type"), pack = bwi_xml_value(tag, "compressor");
  if (!bwi_word_is(type, "UnstructuredGrid"))
    return bwi_fail_line(cursor,
                         "a VTK file of type '%s': only UnstructuredGrid (.vtu) is read; save it "
                         "as that",
                         bwi_show(type));
  if (order.length && !bwi_word_is(order, "LittleEndian") && !bwi_word_is(order, "BigEndian"))
    return bwi_fail_word(cursor, order, "byte_order LittleEndian or BigEndian");
  cursor->swap = bwi_word_is(order, "BigEndian") != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
  if (header.length && !bwi_word_is(header, "UInt32") && !bwi_word_is(header, "UInt64"))
    return bwi_fail_word(cursor, header, "header_type UInt32 or UInt64");
  file->file.wide = bwi_word_is(header, "UInt64");
  if (pack.length && !bwi_word_is(pack, "vtkZLibDataCompressor"))
    return bwi_fail_line(cursor, "compressed by %s: only vtkZLibDataCompressor is read",
                         bwi_show(pack));
  file->file.compressed = pack.length > 0;
  return BW_OK;
}

static bw_status start_piece(bwi_cursor *cursor, const bwi_tag *tag, vtu *file) {
  bw_status status = BW_OK;
  piece p = {0, 0, cursor->line};
  BW_TRY(count_attribute(cursor, tag, "NumberOfPoints", -1, &p.points));
  BW_TRY(count_attribute(cursor, tag, "NumberOfCells", -1, &p.cells));
  if (!bw_grow(cursor->context, (void **)&file->piece, &file->piece_capacity, file->piece_count, 1,
               sizeof *file->piece))
    return BW_MEMORY;
  file->piece[file->piece_count++] = p;
done:
  return status;
}

static bw_status start_array(bwi_cursor *cursor, const bwi_tag *tag, section where, vtu *file) {
  bw_status status = BW_OK;
  int64_t offset;
  bwi_word format = bwi_xml_value(tag, "format");
  announced a = {.section = where, .piece = file->piece_count - 1};
  a.array.name = bwi_xml_value(tag, "Name");
  a.array.type = type_of(bwi_xml_value(tag, "type"));
  a.array.text = cursor->at;
  a.array.line = cursor->line;
  if (where == IN_FIELD_DATA) {
    bool names = bwi_word_is(a.array.name, BWI_VTU_REGION_NAMES) &&
                 bwi_word_is(bwi_xml_value(tag, "type"), "String");
    if (names)
      a.array.type = BWI_VTK_U8; /* bytes, each string ends with 0 */
    else if (!bwi_word_is(a.array.name, BWI_VTU_REGION_TAGS) || bwi_vtk_is_real(a.array.type))
      return BW_OK;
  }
  if (a.array.type == BWI_VTK_NONE && where != IN_POINTS && where != IN_CELLS)
    return BW_OK; /* strings and bits */
  BW_TRY(count_attribute(cursor, tag, "NumberOfComponents", where == IN_POINTS ? 3 : 1,
                         &a.array.columns));
  BW_TRY(count_attribute(cursor, tag, "offset", 0, &offset));
  a.array.offset = (uint64_t)offset;
  if (bwi_word_is(format, "appended"))
    a.array.form = BWI_VTU_APPENDED;
  else if (bwi_word_is(format, "binary"))
    a.array.form = BWI_VTU_INLINE;
  else if (format.length && !bwi_word_is(format, "ascii"))
    BW_TRY(bwi_fail_word(cursor, format, "format ascii, binary or appended"));
  if (!bw_grow(cursor->context, (void **)&file->array, &file->array_capacity, file->array_count, 1,
               sizeof *file->array))
    return BW_MEMORY;
  file->array[file->array_count++] = a;
done:
  return status;
}

static bw_status start_appended(bwi_cursor *cursor, const bwi_tag *tag, vtu *file) {
  bwi_word encoding = bwi_xml_value(tag, "encoding");
  file->file.base64 = bwi_word_is(encoding, "base64");
  if (!file->file.base64 && !bwi_word_is(encoding, "raw"))
    return bwi_fail_word(cursor, encoding, "encoding raw or base64");
  if (!bwi_skip_space(cursor) || *cursor->at != '_')
    return bwi_fail_line(cursor, "the appended data do not begin with an underscore");
  file->file.appended = cursor->at + 1;
  return BW_OK;
}

static bw_status read_tags(bwi_cursor *cursor, vtu *file) {
  static const struct {
    const char *name;
    section section;
  } sections[] = {{"Points", IN_POINTS},
                  {"Cells", IN_CELLS},
                  {"PointData", IN_POINT_DATA},
                  {"CellData", IN_CELL_DATA},
                  {"FieldData", IN_FIELD_DATA}};
  bw_status status = BW_OK;
  section where = ELSEWHERE;
  bwi_tag tag;
  bool any, started = false;
  for (;;) {
    BW_TRY(bwi_xml_next(cursor, &tag, &any));
    if (!any)
      break;
    bool is_section = false;
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
      if (bwi_word_is(tag.name, sections[i].name)) {
        bool outside = file->piece_count == 0 && sections[i].section != IN_FIELD_DATA;
        where = tag.closing || tag.empty || outside ? ELSEWHERE : sections[i].section;
        is_section = true;
      }
    if (is_section || tag.closing)
      continue;
    if (bwi_word_is(tag.name, "VTKFile")) {
      BW_TRY(start_file(cursor, &tag, file));
      started = true;
    } else if (!started) {
      BW_TRY(bwi_fail_line(cursor, "found the XML tag '%s' where VTKFile was expected",
                           bwi_show(tag.name)));
    } else if (bwi_word_is(tag.name, "Piece")) {
      BW_TRY(start_piece(cursor, &tag, file));
      where = ELSEWHERE;
    } else if (bwi_word_is(tag.name, "DataArray") && where != ELSEWHERE) {
      BW_TRY(start_array(cursor, &tag, where, file));
    } else if (bwi_word_is(tag.name, "AppendedData")) {
      BW_TRY(start_appended(cursor, &tag, file));
      break;
    }
  }
  if (file->piece_count == 0)
    BW_TRY(bwi_fail_line(cursor, "the file holds no Piece of a VTK UnstructuredGrid"));
done:
  return status;
}

/* ---- arrays -------------------------------------------------------------------------------- */

/* Of a piece and section; `name` NULL: the first. */
static bw_status find_array(const bwi_cursor *cursor, const vtu *file, size_t number, section where,
                            const char *name, const bwi_vtu_array **array) {
  for (size_t i = 0; i < file->array_count; i++) {
    const announced *a = &file->array[i];
    if (a->piece == number && a->section == where && (!name || bwi_word_is(a->array.name, name))) {
      *array = &a->array;
      return BW_OK;
    }
  }
  bwi_cursor place = *cursor;
  place.line = file->piece[number].line;
  return bwi_fail_line(&place, "the piece that begins here has no array of %s",
                       name ? name : "points");
}

static bw_status read_points(const bwi_cursor *cursor, const vtu *file, size_t number,
                             bwi_raw *raw) {
  bw_status status = BW_OK;
  double *x = NULL;
  const bwi_vtu_array *array = NULL;
  const piece *p = &file->piece[number];
  bwi_cursor place = *cursor;
  place.line = p->line;
  if (p->points > INT32_MAX || p->cells > INT32_MAX)
    BW_TRY(bwi_fail_line(&place, "%lld points and %lld cells: at most 2147483647 of each",
                         (long long)p->points, (long long)p->cells));
  if (p->points == 0)
    return BW_OK;
  BW_TRY(find_array(cursor, file, number, IN_POINTS, NULL, &array));
  place.line = array->line;
  if (array->columns != 3 || !bwi_vtk_is_real(array->type))
    BW_TRY(bwi_fail_line(&place, "points must be Float32 or Float64 of 3 components"));
  BW_TRY(bwi_vtu_reals(cursor, &file->file, array, 3 * (uint64_t)p->points, true, &x));
  for (int64_t i = 0; i < p->points; i++)
    BW_TRY(bwi_raw_point(raw, x + 3 * i));
done:
  bw_free(x);
  return status;
}

/* The corners of a cell type that makes facets; 0: it makes none. */
static int64_t facet_corners(int64_t type, int64_t nodes) {
  switch (type) {
  case 5:
    return nodes == 3 ? 3 : 0;
  case 22:
    return nodes == 6 ? 3 : 0;
  case 8:
  case 9:
    return nodes == 4 ? 4 : 0;
  case 23:
    return nodes == 8 ? 4 : 0;
  case 7:
    return nodes >= 3 && nodes <= BWI_POLYGON_CORNERS ? nodes : 0;
  default:
    return 0;
  }
}

static bw_status add_cell(bwi_raw *raw, int64_t type, const int64_t *node, int64_t count,
                          int64_t first_point, int32_t group, int32_t *scratch) {
  bool tet = (type == 10 && count == 4) || (type == 24 && count == 10);
  int64_t corners = tet ? count : facet_corners(type, count);
  for (int64_t k = 0; k < corners; k++)
    scratch[k] = (int32_t)(first_point + node[k]);
  if (type == 8 && corners == 4) { /* a pixel's nodes go row by row */
    int32_t kept = scratch[2];
    scratch[2] = scratch[3];
    scratch[3] = kept;
  }
  if (tet)
    return bwi_raw_tet(raw, (int)count, scratch, 0);
  if (corners)
    return bwi_raw_facet(raw, (size_t)corners, scratch, group);
  raw->skipped++;
  raw->solids += (type >= 11 && type <= 14) || (type >= 25 && type <= 27) || type == 42;
  return BW_OK;
}

/* A cell array that numbers groups of facets. */
static bw_status read_groups(const bwi_cursor *cursor, const vtu *file, size_t number,
                             int64_t **group) {
  for (size_t i = 0; i < file->array_count; i++) {
    const announced *a = &file->array[i];
    bool named = bwi_word_is(a->array.name, "group") || bwi_word_is(a->array.name, "region");
    if (a->piece == number && a->section == IN_CELL_DATA && named && a->array.columns == 1 &&
        !bwi_vtk_is_real(a->array.type) && !*group)
      return bwi_vtu_integers(cursor, &file->file, &a->array, (uint64_t)file->piece[number].cells,
                              group);
  }
  return BW_OK;
}

/* `tet_cell` gets the cell numbers of the tetrahedra of this piece. */
static bw_status read_cells(const bwi_cursor *cursor, const vtu *file, size_t number, bwi_raw *raw,
                            int64_t first_point, int32_t *tet_cell) {
  bw_status status = BW_OK;
  const piece *p = &file->piece[number];
  const bwi_vtu_array *array = NULL;
  int64_t *end = NULL, *type = NULL, *node = NULL, *group = NULL;
  int32_t scratch_few[64], *scratch = scratch_few;
  bwi_cursor place = *cursor;
  size_t tets = 0;
  if (p->cells == 0)
    return BW_OK;
  BW_TRY(find_array(cursor, file, number, IN_CELLS, "types", &array));
  BW_TRY(bwi_vtu_integers(cursor, &file->file, array, (uint64_t)p->cells, &type));
  BW_TRY(find_array(cursor, file, number, IN_CELLS, "offsets", &array));
  BW_TRY(bwi_vtu_integers(cursor, &file->file, array, (uint64_t)p->cells, &end));
  int64_t longest = 0;
  place.line = array->line;
  for (int64_t i = 0; i < p->cells; i++) {
    int64_t start = i ? end[i - 1] : 0;
    if (end[i] < start)
      BW_TRY(bwi_fail_line(&place, "the offsets of cells must grow, but number %lld is %lld",
                           (long long)i + 1, (long long)end[i]));
    longest = end[i] - start > longest ? end[i] - start : longest;
  }
  BW_TRY(find_array(cursor, file, number, IN_CELLS, "connectivity", &array));
  BW_TRY(bwi_vtu_integers(cursor, &file->file, array, (uint64_t)end[p->cells - 1], &node));
  place.line = array->line;
  for (int64_t i = 0; i < end[p->cells - 1]; i++)
    if (node[i] < 0 || node[i] >= p->points)
      BW_TRY(bwi_fail_line(&place,
                           "number %lld of the connectivity is point %lld, but there are %lld "
                           "points, numbered from 0",
                           (long long)i, (long long)node[i], (long long)p->points));
  if (longest > 64) {
    scratch = BW_NEW(cursor->context, int32_t, longest);
    BW_TRY_MEMORY(scratch);
  }
  BW_TRY(read_groups(cursor, file, number, &group));
  for (int64_t i = 0; i < p->cells; i++) {
    int64_t start = i ? end[i - 1] : 0;
    size_t before = raw->tet_count;
    BW_TRY(add_cell(raw, type[i], node + start, end[i] - start, first_point,
                    group ? (int32_t)group[i] : 0, scratch));
    if (raw->tet_count > before)
      tet_cell[tets++] = (int32_t)i;
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  bw_free(end);
  bw_free(type);
  bw_free(node);
  bw_free(group);
  if (scratch != scratch_few)
    bw_free(scratch);
  return status;
}

/* ---- fields -------------------------------------------------------------------------------- */

static bw_type field_type(bwi_vtk_type type) {
  if (bwi_vtk_is_real(type))
    return BW_F64;
  if (type == BWI_VTK_U8)
    return BW_U8;
  return type >= BWI_VTK_U32 && type <= BWI_VTK_U64 && type != BWI_VTK_I32 ? BW_I64 : BW_I32;
}

static void put_integer(bw_array *array, int64_t at, int64_t value) {
  if (array->type == BW_U8)
    ((uint8_t *)array->data)[at] = (uint8_t)value;
  else if (array->type == BW_I32)
    ((int32_t *)array->data)[at] = (int32_t)value;
  else
    ((int64_t *)array->data)[at] = value;
}

/* Rows `row[i]` of the array as field; row NULL: all. Tensors from VTK's order to ours. */
static bw_status read_field(const bwi_cursor *cursor, const vtu *file, const announced *a,
                            const int32_t *row, int64_t rows, bwi_raw *raw) {
  static const int64_t tensor[6] = {0, 1, 2, 4, 5, 3};
  bw_status status = BW_OK;
  const piece *p = &file->piece[a->piece];
  bool points = a->section == IN_POINT_DATA;
  int64_t columns = a->array.columns;
  uint64_t all;
  double *real = NULL;
  int64_t *whole = NULL;
  bw_array *made = NULL;
  if (columns == 0 ||
      __builtin_mul_overflow((uint64_t)(points ? p->points : p->cells), (uint64_t)columns, &all))
    return BW_OK;
  if (bwi_vtk_is_real(a->array.type))
    BW_TRY(bwi_vtu_reals(cursor, &file->file, &a->array, all, false, &real));
  else
    BW_TRY(bwi_vtu_integers(cursor, &file->file, &a->array, all, &whole));
  BW_TRY(bw_array_create(cursor->context, field_type(a->array.type), rows, columns, &made));
  for (int64_t i = 0; i < rows; i++)
    for (int64_t j = 0; j < columns; j++) {
      int64_t from = (row ? row[i] : i) * columns + (real && columns == 6 ? tensor[j] : j);
      if (real)
        ((double *)made->data)[i * columns + j] = real[from];
      else
        put_integer(made, i * columns + j, whole[from]);
    }
  status = bwi_raw_add_field(raw, a->array.name, points ? BW_ON_NODES : BW_ON_ELEMENTS, made);
  made = NULL;
done:
  bw_release(made);
  bw_free(real);
  bw_free(whole);
  return status;
}

/* The names of regions, where the file has them beside their tags. */
static bw_status read_names(const bwi_cursor *cursor, const vtu *file, bwi_raw *raw) {
  bw_status status = BW_OK;
  const bwi_vtu_array *tags = NULL, *names = NULL;
  int64_t *tag = NULL, *byte = NULL;
  unsigned char *text = NULL;
  uint64_t tag_count, count, begin = 0, named = 0;
  bwi_cursor place = *cursor;
  for (size_t i = 0; i < file->array_count; i++)
    if (file->array[i].section == IN_FIELD_DATA)
      *(bwi_word_is(file->array[i].array.name, BWI_VTU_REGION_NAMES) ? &names : &tags) =
          &file->array[i].array;
  if (!tags || !names)
    return BW_OK;
  place.line = names->line;
  BW_TRY(bwi_vtu_count(cursor, &file->file, tags, &tag_count));
  BW_TRY(bwi_vtu_integers(cursor, &file->file, tags, tag_count, &tag));
  BW_TRY(bwi_vtu_count(cursor, &file->file, names, &count));
  BW_TRY(bwi_vtu_integers(cursor, &file->file, names, count, &byte));
  text = BW_NEW(cursor->context, unsigned char, count);
  BW_TRY_MEMORY(text);
  for (uint64_t i = 0; i < count; i++) {
    if (byte[i] < 0 || byte[i] > 255)
      BW_TRY(bwi_fail_line(&place,
                           "%lld in the names of regions, where bytes from 0 to 255 were "
                           "expected",
                           (long long)byte[i]));
    text[i] = (unsigned char)byte[i];
    if (text[i])
      continue;
    if (named < tag_count && tag[named] >= INT32_MIN && tag[named] <= INT32_MAX)
      BW_TRY(bwi_raw_name_region(raw, (int32_t)tag[named], (bwi_word){text + begin, i - begin}));
    named++;
    begin = i + 1;
  }
  if (named != tag_count)
    BW_TRY(bwi_fail_line(&place, "%llu names for the %llu tags of regions",
                         (unsigned long long)named, (unsigned long long)tag_count));
done:
  bw_free(tag);
  bw_free(byte);
  bw_free(text);
  return status;
}

bw_status bwi_vtu_read(bwi_cursor *cursor, bwi_raw *raw, const char **format) {
  bw_status status = BW_OK;
  vtu file = {0};
  int32_t *tet_cell = NULL;
  *format = "VTU";
  BW_TRY(read_tags(cursor, &file));
  BW_TRY(read_names(cursor, &file, raw));
  int64_t max = 0;
  for (size_t i = 0; i < file.piece_count; i++) {
    int64_t first_point = (int64_t)raw->point_count, cells = file.piece[i].cells;
    BW_TRY(read_points(cursor, &file, i, raw));
    /* a cell has at least a byte somewhere, but for what zlib can make of one */
    BW_TRY(
        bwi_check_count(&(bwi_cursor){cursor->context, cursor->name, cursor->begin, cursor->begin,
                                      cursor->end, file.piece[i].line, false, false},
                        (uint64_t)(cells / 1032), 1, "the number of cells"));
    if (cells > max || !tet_cell) {
      bw_free(tet_cell);
      tet_cell = BW_NEW(cursor->context, int32_t, cells);
      max = cells;
    }
    BW_TRY_MEMORY(tet_cell);
    BW_TRY(read_cells(cursor, &file, i, raw, first_point, tet_cell));
  }
  for (size_t i = 0; i < file.array_count && raw->tet_count > 0; i++) {
    const announced *a = &file.array[i];
    if (a->section != IN_POINT_DATA && a->section != IN_CELL_DATA)
      continue;
    if (file.piece_count > 1) {
      raw->skipped++;
      continue;
    }
    bool points = a->section == IN_POINT_DATA;
    size_t before = raw->field_count;
    BW_TRY(read_field(cursor, &file, a, points ? NULL : tet_cell,
                      (int64_t)(points ? raw->point_count : raw->tet_count), raw));
    if (raw->field_count > before)
      bwi_xml_decode(raw->field[before].name);
  }
done:
  bw_free(file.piece);
  bw_free(file.array);
  bw_free(tet_cell);
  return status;
}
