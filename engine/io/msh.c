/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Gmsh files of versions 2.2 and 4.1, text and binary: the sections that both have. Unknown
 * sections are passed over. */
#include "io/msh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bw_status read_format(bwi_msh *msh, int *version) {
  bw_status status = BW_OK;
  bwi_cursor *cursor = msh->cursor;
  bwi_word word;
  int64_t type, size;
  bwi_next_word(cursor, &word);
  *version = bwi_word_is(word, "2.2") || bwi_word_is(word, "2.1") || bwi_word_is(word, "2") ? 2
             : bwi_word_is(word, "4.1")                                                     ? 4
                                                                                            : 0;
  if (*version == 0)
    BW_TRY(bwi_fail_word(cursor, word, "version 2.2 or 4.1 of the MSH format"));
  BW_TRY(bwi_read_integer(cursor, &type, "0 (text) or 1 (binary)"));
  BW_TRY(bwi_read_integer(cursor, &size, "the size of a number (8)"));
  if (type < 0 || type > 1 || (type == 1 && size != 8))
    BW_TRY(bwi_fail_line(cursor,
                         "file type %lld with numbers of %lld bytes: 0 (text), or 1 (binary) with "
                         "8 was expected",
                         (long long)type, (long long)size));
  msh->binary = type == 1;
  if (msh->binary) {
    const unsigned char *bytes;
    bwi_skip_line(cursor);
    BW_TRY(bwi_take(cursor, 4, &bytes, "the number 1 that shows the byte order"));
    cursor->swap = bwi_u32(bytes, false) != 1;
    if (bwi_u32(bytes, cursor->swap) != 1)
      BW_TRY(bwi_fail_byte(cursor, "found %u where the number 1 shows the byte order",
                           bwi_u32(bytes, false)));
  }
done:
  return status;
}

static bw_status read_physical_names(bwi_msh *msh) {
  bw_status status = BW_OK;
  bwi_cursor *cursor = msh->cursor, line;
  int64_t count, dimension, tag;
  BW_TRY(bwi_read_count(cursor, 6, &count, "the number of physical names"));
  bwi_skip_line(cursor);
  for (int64_t i = 0; i < count; i++) {
    if (!bwi_next_line(cursor, &line))
      BW_TRY(bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, "a physical name"));
    BW_TRY(bwi_read_integer(&line, &dimension, "the dimension of a physical name"));
    BW_TRY(bwi_read_integer(&line, &tag, "the number of a physical name"));
    const unsigned char *open = memchr(line.at, '"', bwi_left(&line));
    const unsigned char *close = open ? memchr(open + 1, '"', (size_t)(line.end - open - 1)) : NULL;
    if (!close)
      BW_TRY(bwi_fail_word(&line, bwi_peek_word(&line), "a name in quotation marks"));
    bwi_msh_group *group;
    BW_TRY(bwi_msh_find_group(msh, dimension, tag, &group));
    group->name = (bwi_word){open + 1, (size_t)(close - open - 1)};
  }
done:
  return status;
}

static bw_status read_value(bwi_msh *msh, double *value) {
  if (!msh->binary)
    return bwi_read_any_real(msh->cursor, value, "a value");
  const unsigned char *bytes;
  bw_status status = bwi_take(msh->cursor, 8, &bytes, "a value");
  if (status == BW_OK)
    *value = bwi_f64(bytes, msh->cursor->swap);
  return status;
}

/* $NodeData and $ElementData: name, components and rows in the header; the rows carry tags. A field
 * on fewer than half of the nodes or tetrahedra is passed over; what else is missing is NaN. */
static bw_status read_data(bwi_msh *msh, bool nodes) {
  bw_status status = BW_OK;
  bwi_cursor *cursor = msh->cursor, line;
  bwi_raw *raw = msh->raw;
  bwi_word name = {(const unsigned char *)"data", 4};
  bw_array *array = NULL;
  int64_t count, integer[3] = {0, 1, 0}, id;
  double unused;
  BW_TRY(bwi_read_count(cursor, 2, &count, "the number of string tags"));
  bwi_skip_line(cursor);
  for (int64_t i = 0; i < count; i++) {
    if (!bwi_next_line(cursor, &line))
      BW_TRY(bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, "a string tag"));
    bwi_skip_blank(&line);
    const unsigned char *end = line.end;
    while (end > line.at && end[-1] <= ' ')
      end--;
    bool quoted = end - line.at >= 2 && *line.at == '"' && end[-1] == '"';
    if (i == 0)
      name = (bwi_word){line.at + quoted, (size_t)(end - line.at) - (quoted ? 2 : 0)};
  }
  BW_TRY(bwi_read_count(cursor, 2, &count, "the number of real tags"));
  for (int64_t i = 0; i < count; i++)
    BW_TRY(bwi_read_real(cursor, &unused, "a real tag"));
  BW_TRY(bwi_read_count(cursor, 2, &count, "the number of integer tags"));
  for (int64_t i = 0; i < count; i++)
    BW_TRY(bwi_read_integer(cursor, i < 3 ? &integer[i] : &id, "an integer tag"));
  int64_t columns = integer[1], given = integer[2];
  if (columns < 1 || columns > 9 || given < 0)
    BW_TRY(bwi_fail_line(cursor, "%lld rows of %lld components: 1 to 9 were expected",
                         (long long)given, (long long)columns));
  if (msh->binary)
    bwi_skip_line(cursor);
  BW_TRY(bwi_msh_check(msh, given, 2 + 2 * (size_t)columns, 4 + 8 * (size_t)columns,
                       "the number of rows"));
  size_t rows = nodes ? raw->point_count : raw->tet_count;
  bool wanted = rows > 0 && (uint64_t)given >= rows / 2;
  if (!nodes && wanted && !msh->elements.id) {
    int64_t *copy = BW_NEW(raw->context, int64_t, raw->tet_count), twice;
    BW_TRY_MEMORY(copy);
    memcpy(copy, msh->tet_id, raw->tet_count * sizeof *copy);
    status = bwi_ids_build(raw->context, copy, raw->tet_count, &msh->elements, &twice);
    if (status == BW_FORMAT)
      bwi_msh_fail(msh, "element %lld is defined twice", (long long)twice);
    if (status != BW_OK)
      goto done;
  }
  if (wanted)
    BW_TRY(bw_array_create(raw->context, BW_F64, (int64_t)rows, columns, &array));
  for (size_t i = 0; wanted && i < rows * (size_t)columns; i++)
    ((double *)array->data)[i] = (double)NAN;
  for (int64_t i = 0; i < given; i++) {
    BW_TRY(bwi_msh_int(msh, &id, "the number of a node or element"));
    int32_t row = wanted ? bwi_ids_find(nodes ? &msh->nodes : &msh->elements, id) : -1;
    for (int64_t j = 0; j < columns; j++) {
      double value;
      BW_TRY(read_value(msh, &value));
      if (row >= 0)
        ((double *)array->data)[(int64_t)row * columns + j] = value;
    }
  }
  if (wanted) {
    status = bwi_raw_add_field(raw, name, nodes ? BW_ON_NODES : BW_ON_ELEMENTS, array);
    array = NULL;
  } else {
    raw->skipped++;
  }
done:
  bw_release(array);
  return status;
}

static bw_status end_section(bwi_cursor *cursor, const char *name) {
  char text[40];
  bwi_word word;
  snprintf(text, sizeof text, "$End%s", name);
  bwi_next_word(cursor, &word);
  return bwi_word_is(word, text) ? BW_OK : bwi_fail_word(cursor, word, text);
}

/* Past "$EndNAME"; a section that does not end is an error. */
static bw_status skip_section(bwi_cursor *cursor, bwi_word name) {
  char text[80];
  if (name.length < 2 || name.length > 60)
    return bwi_fail_word(cursor, name, "a section ('$Nodes', '$Elements', ...)");
  snprintf(text, sizeof text, "$End%.*s", (int)name.length - 1, (const char *)name.at + 1);
  const unsigned char *found = bwi_find(cursor, text);
  if (!found)
    return bwi_fail_line(cursor, "the section '%s' has no '%s'", bwi_show(name), text);
  for (; cursor->at < found; cursor->at++)
    cursor->line += *cursor->at == '\n';
  cursor->at += strlen(text);
  return BW_OK;
}

static bw_status read_section(bwi_msh *msh, int *version, bwi_word word) {
  static const struct {
    const char *name;
    bw_status (*read22)(bwi_msh *), (*read41)(bwi_msh *);
  } section[] = {{"PhysicalNames", read_physical_names, read_physical_names},
                 {"Entities", NULL, bwi_msh41_entities},
                 {"Nodes", bwi_msh22_nodes, bwi_msh41_nodes},
                 {"Elements", bwi_msh22_elements, bwi_msh41_elements}};
  bw_status status = BW_OK;
  bwi_word name = {word.at + 1, word.length - 1};
  if (bwi_word_is(name, "MeshFormat")) {
    BW_TRY(read_format(msh, version));
    return end_section(msh->cursor, "MeshFormat");
  }
  for (size_t i = 0; i < sizeof section / sizeof *section; i++) {
    bw_status (*read)(bwi_msh *) = *version == 2 ? section[i].read22 : section[i].read41;
    if (!bwi_word_is(name, section[i].name) || !read)
      continue;
    if (*version == 0)
      return bwi_fail_line(msh->cursor, "the section '%s' stands before $MeshFormat",
                           bwi_show(word));
    bwi_skip_line(msh->cursor);
    BW_TRY(read(msh));
    return end_section(msh->cursor, section[i].name);
  }
  bool nodes = bwi_word_is(name, "NodeData");
  if (*version && (nodes || bwi_word_is(name, "ElementData"))) {
    BW_TRY(read_data(msh, nodes));
    return end_section(msh->cursor, nodes ? "NodeData" : "ElementData");
  }
  return skip_section(msh->cursor, word);
done:
  return status;
}

bw_status bwi_msh_read(bwi_cursor *cursor, bwi_raw *raw, const char **format) {
  bw_status status = BW_OK;
  bwi_msh msh = {.cursor = cursor, .raw = raw};
  int version = 0;
  bwi_word word;
  while (bwi_next_word(cursor, &word)) {
    if (*word.at != '$')
      BW_TRY(bwi_fail_word(cursor, word, "a section ('$Nodes', '$Elements', ...)"));
    BW_TRY(read_section(&msh, &version, word));
    BW_TRY(bw_check_cancel(cursor->context));
  }
  for (size_t i = 0; i < msh.group_count; i++) {
    const bwi_msh_group *group = &msh.group[i];
    if (group->dimension == 3 && group->name.length > 0 && group->tag >= INT32_MIN &&
        group->tag <= INT32_MAX)
      BW_TRY(bwi_raw_name_region(raw, (int32_t)group->tag, group->name));
  }
  *format = version == 2 ? (msh.binary ? "MSH 2.2 binary" : "MSH 2.2")
                         : (msh.binary ? "MSH 4.1 binary" : "MSH 4.1");
done:
  bwi_ids_clear(&msh.nodes);
  bwi_ids_clear(&msh.elements);
  bw_free(msh.tet_id);
  bw_free(msh.group);
  bw_free(msh.entity);
  bw_free(msh.physical);
  return status;
}
