/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* STL. Binary: an 80-byte header of any content, the number of facets (uint32, little endian), then
 * 50 bytes a facet: normal, three corners (float32), an attribute of two bytes. Many binary files
 * begin with "solid", so the size decides: 84 + 50 n bytes is binary whatever stands at the start.
 * Text: solid, facet normal, outer loop, vertex, endloop, endfacet, endsolid; read word by word, in
 * either case. Normals and attributes are ignored: the winding says the same. Each solid block of a
 * text file is a group. */
#include "io/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_BYTES = 84, FACET_BYTES = 50 };

bool bwi_stl_is_binary(const unsigned char *bytes, size_t count) {
  const bool swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  return count >= HEADER_BYTES &&
         HEADER_BYTES + (uint64_t)FACET_BYTES * bwi_u32(bytes + 80, swap) == count;
}

/* Text has no byte 0; a binary file has one in its count of facets, unless they are 2^24. */
static bool is_text(const bwi_cursor *cursor) {
  size_t look = bwi_left(cursor) < 2048 ? bwi_left(cursor) : 2048;
  return look > 0 && !memchr(cursor->at, 0, look);
}

/* ---- binary -------------------------------------------------------------------------------- */

static bw_status parse_binary(bwi_cursor *cursor, bwi_soup *soup) {
  bw_status status = BW_OK;
  const unsigned char *bytes;
  const bool swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  cursor->at = cursor->begin; /* a byte order mark would be part of the header */
  BW_TRY(bwi_take(cursor, HEADER_BYTES, &bytes, "the header of a binary STL file"));
  uint32_t count = bwi_u32(bytes + 80, swap);
  if (count > bwi_left(cursor) / FACET_BYTES) {
    size_t whole = bwi_left(cursor) / FACET_BYTES, all = bwi_left(cursor) + HEADER_BYTES;
    cursor->at = cursor->begin + 80;
    status =
        bwi_fail_byte(cursor,
                      "the header of this binary STL file claims %u facets, which take %llu "
                      "bytes, but the file has %zu (%zu facets): it is cut short or the count "
                      "is wrong",
                      count, HEADER_BYTES + (unsigned long long)FACET_BYTES * count, all, whole);
    bw_detail_number(cursor->context, "claimed", count);
    bw_detail_number(cursor->context, "present", (double)whole);
    goto done;
  }
  for (uint32_t i = 0; i < count; i++) {
    BW_TRY(bwi_take(cursor, FACET_BYTES, &bytes, "a facet"));
    int32_t first = (int32_t)soup->point_count;
    for (int k = 0; k < 3; k++) {
      double x[3];
      for (int j = 0; j < 3; j++) {
        x[j] = (double)bwi_f32(bytes + 12 + 12 * k + 4 * j, swap);
        if (!isfinite(x[j])) {
          cursor->at = bytes + 12 + 12 * k + 4 * j;
          status = bwi_fail_byte(cursor,
                                 "corner %d of facet %u has the coordinate %g: a finite number was "
                                 "expected",
                                 k + 1, i + 1, x[j]);
          bw_detail_number(cursor->context, "facet", i + 1.0);
          goto done;
        }
      }
      BW_TRY(bwi_soup_point(soup, x));
    }
    BW_TRY(bwi_soup_triangle(soup, first, first + 1, first + 2));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
  if (bwi_left(cursor) > 0)
    bw_warn(cursor->context, "%s: %zu bytes after the last of %u facets were ignored", cursor->name,
            bwi_left(cursor), count);
done:
  return status;
}

/* ---- text ---------------------------------------------------------------------------------- */

/* Behind "facet": the corners, up to and with "endfacet" (or "endloop" where that is left out). */
static bw_status parse_facet(bwi_cursor *cursor, bwi_soup *soup) {
  bw_status status = BW_OK;
  int32_t corner[16], count = 0;
  int64_t line = cursor->line;
  bwi_word word;
  /* The normal is not needed, and is often nan for a facet without area. */
  do
    if (!bwi_next_word(cursor, &word)) {
      BW_TRY(bwi_fail_word(cursor, word, "'outer loop' of a facet"));
    }
  while (!bwi_word_is_nocase(word, "outer"));
  bwi_next_word(cursor, &word);
  if (!bwi_word_is_nocase(word, "loop"))
    BW_TRY(bwi_fail_word(cursor, word, "'loop' behind 'outer'"));
  for (;;) {
    if (!bwi_next_word(cursor, &word))
      BW_TRY(bwi_fail_line(cursor, "the file ends inside the facet that begins in line %lld",
                           (long long)line));
    if (bwi_word_is_nocase(word, "endloop"))
      break;
    if (!bwi_word_is_nocase(word, "vertex"))
      BW_TRY(bwi_fail_word(cursor, word, "'vertex' or 'endloop'"));
    if (count == (int32_t)(sizeof corner / sizeof *corner))
      BW_TRY(
          bwi_fail_line(cursor, "a facet with more than %d vertices: three were expected", count));
    double x[3];
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_read_real(cursor, &x[k], "a coordinate of a vertex"));
    corner[count++] = (int32_t)soup->point_count;
    BW_TRY(bwi_soup_point(soup, x));
  }
  if (count < 3)
    BW_TRY(bwi_fail_line(cursor, "a facet with %d vertices: three were expected", count));
  BW_TRY(bwi_soup_polygon(soup, corner, (size_t)count));
  if (bwi_word_is_nocase(bwi_peek_word(cursor), "endfacet"))
    bwi_next_word(cursor, &word);
done:
  return status;
}

static bw_status parse_text(bwi_cursor *cursor, bwi_soup *soup) {
  bw_status status = BW_OK;
  bwi_word word = bwi_peek_word(cursor);
  if (word.length < 5 || !bwi_word_is_nocase((bwi_word){word.at, 5}, "solid"))
    BW_TRY(bwi_fail_word(cursor, word,
                         "'solid', the first word of a text STL file (and its size is not that of "
                         "a binary one)"));
  for (int64_t i = 0; bwi_next_word(cursor, &word); i++) {
    if (bwi_word_is_nocase(word, "facet")) {
      BW_TRY(parse_facet(cursor, soup));
    } else if (i == 0 || bwi_word_is_nocase(word, "solid")) {
      bwi_soup_next_group(soup);
      bwi_skip_line(cursor); /* a name of any words */
    } else if (bwi_word_is_nocase(word, "endsolid") || bwi_word_is_nocase(word, "end")) {
      bwi_skip_line(cursor);
    } else {
      BW_TRY(bwi_fail_word(cursor, word, "'facet', 'endsolid' or 'solid'"));
    }
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(cursor->context));
  }
done:
  return status;
}

bw_status bwi_stl_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  size_t count = (size_t)(cursor->end - cursor->begin);
  bool binary = bwi_stl_is_binary(cursor->begin, count) || !is_text(cursor);
  bwi_soup soup;
  bwi_soup_init(&soup, cursor->context, cursor->name);
  bw_status status = binary ? parse_binary(cursor, &soup) : parse_text(cursor, &soup);
  if (status == BW_OK)
    status = bwi_soup_finish(&soup, binary ? "STL binary" : "STL ASCII", true, surface, info);
  bwi_soup_clear(&soup);
  return status;
}

/* ---- writing ------------------------------------------------------------------------------- */

static void facet_normal(const bw_surface *surface, int32_t i, double normal[3]) {
  const int32_t *t = surface->triangle + 3 * (size_t)i;
  double a[3], b[3];
  for (size_t k = 0; k < 3; k++) {
    double x = surface->point[3 * (size_t)t[0] + k];
    a[k] = surface->point[3 * (size_t)t[1] + k] - x;
    b[k] = surface->point[3 * (size_t)t[2] + k] - x;
  }
  bw_cross(a, b, normal);
  double length = bw_norm(normal);
  for (int k = 0; k < 3; k++)
    normal[k] = length > 0 && isfinite(length) ? normal[k] / length : 0;
}

static void put_f32(unsigned char *to, double value) {
  float small = (float)value;
  uint32_t bits;
  memcpy(&bits, &small, sizeof bits);
  for (int k = 0; k < 4; k++)
    to[k] = (unsigned char)(bits >> 8 * k);
}

static bw_status write_binary(bw_writer *writer, const bw_surface *surface) {
  unsigned char header[HEADER_BYTES] = "barwright binary STL"; /* must not begin with "solid" */
  for (int k = 0; k < 4; k++)
    header[80 + k] = (unsigned char)((uint32_t)surface->triangle_count >> 8 * k);
  bw_writer_bytes(writer, header, sizeof header);
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    unsigned char facet[FACET_BYTES] = {0};
    double normal[3];
    facet_normal(surface, i, normal);
    for (int k = 0; k < 3; k++) {
      const double *x = surface->point + 3 * (size_t)surface->triangle[3 * (size_t)i + (size_t)k];
      put_f32(facet + 4 * k, normal[k]);
      for (int j = 0; j < 3; j++)
        put_f32(facet + 12 + 12 * k + 4 * j, x[j]);
    }
    bw_writer_bytes(writer, facet, sizeof facet);
  }
  return bw_writer_bytes(writer, NULL, 0);
}

static void write_three(bw_writer *writer, const char *before, const double x[3]) {
  bw_writer_print(writer, "%s", before);
  for (int k = 0; k < 3; k++) {
    bw_writer_bytes(writer, " ", 1);
    bw_writer_number(writer, x[k]);
  }
  bw_writer_bytes(writer, "\n", 1);
}

static void write_solid(bw_writer *writer, const bw_surface *surface, int32_t group, bool all) {
  char name[32];
  snprintf(name, sizeof name, all ? "barwright" : "group_%d", (int)group);
  bw_writer_print(writer, "solid %s\n", name);
  for (int32_t i = 0; i < surface->triangle_count; i++) {
    if (!all && surface->group[i] != group)
      continue;
    double normal[3];
    facet_normal(surface, i, normal);
    write_three(writer, "facet normal", normal);
    bw_writer_print(writer, "outer loop\n");
    for (size_t k = 0; k < 3; k++)
      write_three(writer, "vertex",
                  surface->point + 3 * (size_t)surface->triangle[3 * (size_t)i + k]);
    bw_writer_print(writer, "endloop\nendfacet\n");
  }
  bw_writer_print(writer, "endsolid %s\n", name);
}

/* One solid per group where facets of a group stand together, as readers give them; facet order is
 * kept, so an interleaved group array gives one solid only. */
static bool groups_in_order(const bw_surface *surface) {
  if (!surface->group)
    return false;
  for (int32_t i = 1; i < surface->triangle_count; i++)
    if (surface->group[i] < surface->group[i - 1])
      return false;
  return true;
}

static void write_text(bw_writer *writer, const bw_surface *surface) {
  if (!groups_in_order(surface)) {
    write_solid(writer, surface, 0, true);
    return;
  }
  int32_t written = 0;
  for (int32_t i = 0; i < surface->triangle_count; i++)
    if (i == 0 || surface->group[i] != written) {
      written = surface->group[i];
      write_solid(writer, surface, written, false);
    }
}

bw_status bwi_stl_write(bw_writer *writer, const bw_surface *surface, bool ascii) {
  for (int64_t i = 0; !ascii && i < 3 * (int64_t)surface->point_count; i++)
    if (fabs(surface->point[i]) > 3.4e38)
      return bw_fail(bwi_writer_context(writer), BW_INVALID,
                     "point %lld has the coordinate %g: binary STL holds float32; write text",
                     (long long)(i / 3) + 1, surface->point[i]);
  if (ascii)
    write_text(writer, surface);
  else
    write_binary(writer, surface);
  return bw_writer_bytes(writer, NULL, 0);
}
