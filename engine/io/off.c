/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* OFF: an optional word OFF with prefixes that say what a vertex line carries beyond x y z (C
 * colour, N normal, ST texture), the numbers of vertices, facets and edges, then the vertices one
 * per line, then the facets "n i0 ... [colour]" one per line. '#' begins a comment. A facet of one
 * or two corners is a point or line and skipped. The prefix 4 and the word BINARY are refused. */
#include "io/internal.h"

#include <string.h>

/* The header word, if there is one. Behind it on the same line the counts may follow. */
static bw_status read_header(bwi_cursor *cursor, bwi_cursor *line) {
  if (!bwi_next_record(cursor, line))
    return bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, "'OFF' or the number of vertices");
  bwi_word word = bwi_peek_word(line);
  if (word.length < 3 || memcmp(word.at + word.length - 3, "OFF", 3) != 0)
    return BW_OK; /* without the word: the line holds the counts */
  for (size_t i = 0; i + 3 < word.length; i++)
    if (!strchr("STCN", word.at[i]))
      return bwi_fail_line(line,
                           "'%s': OFF, or with the prefixes ST, C, N, was expected (not 4 or n: "
                           "points must have three coordinates)",
                           bwi_show(word));
  bwi_next_word(line, &word);
  if (bwi_word_is_nocase(bwi_peek_word(line), "BINARY"))
    return bwi_fail_line(line, "binary OFF is not read: save it as text, or as binary STL or PLY");
  bwi_skip_blank(line);
  if (line->at == line->end && !bwi_next_record(cursor, line))
    return bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, "the number of vertices");
  return BW_OK;
}

static bw_status read_vertices(bwi_cursor *cursor, int64_t count, bwi_soup *soup) {
  bw_status status = BW_OK;
  bwi_cursor line;
  for (int64_t i = 0; i < count; i++) {
    if (!bwi_next_record(cursor, &line))
      BW_TRY(bwi_fail_line(cursor, "the file ends after %lld of %lld vertices", (long long)i,
                           (long long)count));
    double x[3];
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_read_real(&line, &x[k], "a coordinate of a vertex"));
    BW_TRY(bwi_soup_point(soup, x));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  return status;
}

static bw_status read_facets(bwi_cursor *cursor, int64_t count, bwi_soup *soup) {
  bw_status status = BW_OK;
  bwi_cursor line;
  int32_t *corner = NULL;
  size_t capacity = 0;
  for (int64_t i = 0; i < count; i++) {
    if (!bwi_next_record(cursor, &line))
      BW_TRY(bwi_fail_line(cursor, "the file ends after %lld of %lld facets", (long long)i,
                           (long long)count));
    int64_t corners, vertex;
    BW_TRY(bwi_read_count(&line, 2, &corners, "the number of corners of a facet"));
    if (corners > BWI_POLYGON_CORNERS)
      BW_TRY(bwi_fail_line(&line, "a facet of more than %d corners", BWI_POLYGON_CORNERS));
    BW_TRY_MEMORY(bw_grow(cursor->context, (void **)&corner, &capacity, 0, (size_t)corners + 1,
                          sizeof *corner));
    for (int64_t k = 0; k < corners; k++) {
      BW_TRY(bwi_read_integer(&line, &vertex, "a corner of a facet"));
      if (vertex < 0 || vertex >= (int64_t)soup->point_count)
        BW_TRY(bwi_fail_line(&line,
                             "facet %lld names vertex %lld, but there are %zu vertices, numbered "
                             "from 0",
                             (long long)i + 1, (long long)vertex, soup->point_count));
      corner[k] = (int32_t)vertex;
    }
    if (corners >= 3)
      BW_TRY(bwi_soup_polygon(soup, corner, (size_t)corners));
    else
      soup->skipped++;
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  bw_free(corner);
  return status;
}

bw_status bwi_off_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bwi_soup soup;
  bwi_soup_init(&soup, cursor->context, cursor->name);
  int64_t vertices, facets;
  BW_TRY(read_header(cursor, &line));
  BW_TRY(bwi_read_integer(&line, &vertices, "the number of vertices"));
  BW_TRY(bwi_read_integer(&line, &facets, "the number of facets"));
  if (vertices < 0 || facets < 0)
    BW_TRY(bwi_fail_line(&line, "%lld vertices and %lld facets: a count cannot be negative",
                         (long long)vertices, (long long)facets));
  /* the number of edges may be missing, and means nothing */
  line.end = cursor->end;
  line.at = cursor->at;
  BW_TRY(bwi_check_count(&line, (uint64_t)vertices, 6, "the number of vertices"));
  BW_TRY(bwi_check_count(&line, (uint64_t)facets, 2, "the number of facets"));
  BW_TRY(read_vertices(cursor, vertices, &soup));
  BW_TRY(read_facets(cursor, facets, &soup));
  if (bwi_next_record(cursor, &line))
    bw_warn(cursor->context, "%s:%lld: what follows the last of %lld facets was ignored",
            cursor->name, (long long)line.line, (long long)facets);
  BW_TRY(bwi_soup_finish(&soup, "OFF", false, surface, info));
done:
  bwi_soup_clear(&soup);
  return status;
}

bw_status bwi_off_write(bw_writer *writer, const bw_surface *surface) {
  bw_writer_print(writer, "OFF\n%d %d 0\n", (int)surface->point_count,
                  (int)surface->triangle_count);
  for (int32_t i = 0; i < surface->point_count; i++)
    for (size_t k = 0; k < 3; k++) {
      bw_writer_number(writer, surface->point[3 * (size_t)i + k]);
      bw_writer_bytes(writer, k == 2 ? "\n" : " ", 1);
    }
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    bw_writer_bytes(writer, "3", 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_integer(writer, surface->triangle[3 * (size_t)i + k]);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  return bw_writer_bytes(writer, NULL, 0);
}
