/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* MEDIT .mesh, text: keywords, each with a count and so many rows; the last number of a row is its
 * reference, which becomes the region of a tetrahedron or the group of a facet. Nodes are numbered
 * from 1. Keywords that are not used are passed over with their numbers. The format has no names:
 * those of regions are comments, "# region 3 insert". */
#include "io/raw.h"

#include <string.h>

/* The next word, of length 0 at the end; comments are read on the way. */
static bw_status next_keyword(bwi_cursor *cursor, bwi_raw *raw, bwi_word *word) {
  while (bwi_next_word(cursor, word)) {
    if (*word->at != '#')
      return BW_OK;
    cursor->at = word->at + 1;
    bwi_cursor line;
    bw_status status = bwi_next_line(cursor, &line) ? bwi_read_region_comment(&line, raw) : BW_OK;
    if (status != BW_OK)
      return status;
  }
  word->length = 0;
  return BW_OK;
}

static bw_status read_vertices(bwi_cursor *cursor, bwi_raw *raw, int64_t *skipped) {
  bw_status status = BW_OK;
  int64_t count, reference;
  (void)skipped;
  if (raw->point_count)
    return bwi_fail_line(cursor, "a second section of vertices");
  BW_TRY(bwi_read_count(cursor, 8, &count, "the number of vertices"));
  for (int64_t i = 0; i < count; i++) {
    double x[3];
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_read_real(cursor, &x[k], "a coordinate of a vertex"));
    BW_TRY(bwi_read_integer(cursor, &reference, "the reference of a vertex"));
    BW_TRY(bwi_raw_point(raw, x));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  return status;
}

typedef struct keyword {
  const char *name;
  int nodes, corners; /* corners: 10 or 4 of a tetrahedron, 3 or 4 of a facet, 0: passed over */
  bool tet;
} keyword;

/* The mid-edge nodes of TetrahedraP2 stand in the order of bw_mesh: 01 12 20 03 13 23. */
static const keyword keywords[] = {
    {"Tetrahedra", 4, 4, true},      {"TetrahedraP2", 10, 10, true},
    {"Triangles", 3, 3, false},      {"TrianglesP2", 6, 3, false},
    {"Quadrilaterals", 4, 4, false}, {"QuadrilateralsQ2", 9, 4, false},
    {"Edges", 2, 0, false},          {"EdgesP2", 3, 0, false},
    {"Hexahedra", 8, 0, false},      {"HexahedraQ2", 27, 0, false},
    {"Prisms", 6, 0, false},         {"Pyramids", 5, 0, false},
};

static bw_status read_cells(bwi_cursor *cursor, bwi_raw *raw, const keyword *kind) {
  bw_status status = BW_OK;
  int64_t count, value, reference;
  int32_t node[27];
  BW_TRY(bwi_read_count(cursor, 2 * (size_t)kind->nodes + 2, &count, "the number of elements"));
  for (int64_t i = 0; i < count; i++) {
    for (int k = 0; k < kind->nodes; k++) {
      BW_TRY(bwi_read_integer(cursor, &value, "a vertex of an element"));
      if (value < 1 || value > (int64_t)raw->point_count)
        BW_TRY(bwi_fail_line(cursor,
                             "an element of %s names vertex %lld, but there are %zu before it, "
                             "numbered from 1",
                             kind->name, (long long)value, raw->point_count));
      node[k] = (int32_t)(value - 1);
    }
    BW_TRY(bwi_read_integer(cursor, &reference, "the reference of an element"));
    if (reference < INT32_MIN || reference > INT32_MAX)
      BW_TRY(bwi_fail_line(cursor, "the reference %lld is beyond 32 bits", (long long)reference));
    if (kind->tet)
      BW_TRY(bwi_raw_tet(raw, kind->nodes, node, (int32_t)reference));
    else if (kind->corners)
      BW_TRY(bwi_raw_facet(raw, (size_t)kind->corners, node, (int32_t)reference));
    else
      raw->skipped++, raw->solids += kind->nodes > 3 && kind->name[0] != 'E';
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  return status;
}

static bool starts_number(const bwi_cursor *cursor) {
  bwi_word word = bwi_peek_word(cursor);
  return word.length && (memchr("+-.0123456789", *word.at, 13) != NULL);
}

bw_status bwi_medit_read(bwi_cursor *cursor, bwi_raw *raw, const char **format) {
  bw_status status = BW_OK;
  bwi_word word;
  int64_t number;
  *format = "MEDIT";
  for (;;) {
    const keyword *kind = NULL;
    BW_TRY(next_keyword(cursor, raw, &word));
    if (word.length == 0)
      break;
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
      if (bwi_word_is_nocase(word, keywords[i].name))
        kind = &keywords[i];
    if (bwi_word_is_nocase(word, "End"))
      break;
    if (bwi_word_is_nocase(word, "Dimension")) {
      BW_TRY(bwi_read_integer(cursor, &number, "the dimension"));
      if (number != 3)
        BW_TRY(
            bwi_fail_line(cursor, "a mesh in %lld dimensions: 3 were expected", (long long)number));
    } else if (bwi_word_is_nocase(word, "Vertices")) {
      BW_TRY(read_vertices(cursor, raw, &raw->skipped));
    } else if (kind) {
      BW_TRY(read_cells(cursor, raw, kind));
    } else if (word.length >= 8 &&
               bwi_word_is_nocase((bwi_word){word.at + word.length - 8, 8}, "Ordering")) {
      BW_TRY(bwi_fail_line(cursor, "%s: only the standard order of nodes is read", bwi_show(word)));
    } else if ((*word.at | 0x20) >= 'a' && (*word.at | 0x20) <= 'z') {
      while (starts_number(cursor))
        bwi_next_word(cursor, &word);
    } else {
      BW_TRY(bwi_fail_word(cursor, word, "a keyword (Vertices, Tetrahedra, ...)"));
    }
  }
done:
  return status;
}

bw_status bwi_medit_write(bw_writer *writer, const bw_mesh *mesh) {
  bw_writer_print(writer, "MeshVersionFormatted 2\nDimension 3\n");
  bwi_write_region_comments(writer, mesh);
  bw_writer_print(writer, "Vertices\n%d\n", (int)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    for (size_t k = 0; k < 3; k++) {
      bw_writer_number(writer, mesh->node[3 * (size_t)i + k]);
      bw_writer_bytes(writer, " ", 1);
    }
    bw_writer_bytes(writer, "0\n", 2);
  }
  bw_writer_print(writer, "%s\n%d\n", mesh->order == 2 ? "TetrahedraP2" : "Tetrahedra",
                  (int)mesh->element_count);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    for (int k = 0; k < mesh->nodes_per_element; k++) {
      bw_writer_integer(writer,
                        (int64_t)mesh->element[(int64_t)e * mesh->nodes_per_element + k] + 1);
      bw_writer_bytes(writer, " ", 1);
    }
    bw_writer_integer(writer, mesh->region ? mesh->regions[mesh->region[e]].tag : 0);
    bw_writer_bytes(writer, "\n", 1);
  }
  return bw_writer_print(writer, "End\n");
}
