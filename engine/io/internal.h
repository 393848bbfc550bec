/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the readers and writers of files share: a cursor over bytes, numbers as text, and the
 * collecting of points, facets and elements before they become a surface or a mesh.
 *
 * Rule for every reader: a count that a file claims is compared with the bytes that are there
 * before anything is allocated by it. */
#ifndef BWI_IO_INTERNAL_H
#define BWI_IO_INTERNAL_H

#include "barwright/io.h"

/* ---- cursor -------------------------------------------------------------------------------- */

/* begin <= at <= end. `line` is the number of the line that `at` stands on, counted from 1, as far
 * as the text functions moved it. Line ends: LF, CR LF, CR. Blanks: the other ASCII white space. */
typedef struct bwi_cursor {
  bw_context *context;
  const char *name; /* of the file, for messages */
  const unsigned char *begin, *at, *end;
  int64_t line;
  bool swap;    /* binary numbers are in the other byte order */
  bool is_line; /* end is that of a line, not of the file */
} bwi_cursor;

/* A piece of the file; not 0-terminated. */
typedef struct bwi_word {
  const unsigned char *at;
  size_t length;
} bwi_word;

/* Skips a UTF-8 byte order mark. */
void bwi_cursor_init(bwi_cursor *cursor, bw_context *context, const char *name,
                     const unsigned char *bytes, size_t count);
static inline size_t bwi_left(const bwi_cursor *cursor) {
  return (size_t)(cursor->end - cursor->at);
}
void bwi_skip_blank(bwi_cursor *cursor);                  /* within the line */
bool bwi_skip_space(bwi_cursor *cursor);                  /* also over lines; false: at the end */
void bwi_skip_line(bwi_cursor *cursor);                   /* past the end of this line */
bool bwi_next_line(bwi_cursor *cursor, bwi_cursor *line); /* the rest of this line as a cursor */
/* The next line that holds something, without its comment, which begins with '#'. */
bool bwi_next_record(bwi_cursor *cursor, bwi_cursor *line);
bool bwi_next_word(bwi_cursor *cursor, bwi_word *word); /* length 0 and false: none left */
bwi_word bwi_peek_word(const bwi_cursor *cursor);
bool bwi_word_is(bwi_word word, const char *text);        /* exactly */
bool bwi_word_is_nocase(bwi_word word, const char *text); /* ASCII letters of either case */
/* The first place of `text` at or after `at`, or NULL. */
const unsigned char *bwi_find(const bwi_cursor *cursor, const char *text);

/* Failures: "NAME:LINE: ..." and "NAME: byte N: ...", with details "file" and "line" or "byte". */
bw_status bwi_fail_line(const bwi_cursor *cursor, const char *format, ...) BW_PRINTF(2, 3);
bw_status bwi_fail_byte(const bwi_cursor *cursor, const char *format, ...) BW_PRINTF(2, 3);
/* "... found X, expected `expected`"; the word shortened and made printable. */
bw_status bwi_fail_word(const bwi_cursor *cursor, bwi_word found, const char *expected);
/* A word made printable, at most 40 characters, in one of four rotating buffers. */
const char *bwi_show(bwi_word word);

/* The next number on this or a later line; `what` it is, for the message. bwi_read_real accepts
 * finite values only. */
bw_status bwi_read_real(bwi_cursor *cursor, double *value, const char *what);
bw_status bwi_read_integer(bwi_cursor *cursor, int64_t *value, const char *what);
/* The same with NaN and infinities let through, which fields may hold. */
bw_status bwi_read_any_real(bwi_cursor *cursor, double *value, const char *what);
/* A count, which `min` bytes each of the rest of the file must be able to hold. */
bw_status bwi_read_count(bwi_cursor *cursor, size_t min, int64_t *value, const char *what);
/* The same test for a count that was read otherwise. */
bw_status bwi_check_count(const bwi_cursor *cursor, uint64_t count, size_t min, const char *what);

/* `count` bytes at the cursor, which moves past them. */
bw_status bwi_take(bwi_cursor *cursor, size_t count, const unsigned char **bytes, const char *what);
uint16_t bwi_u16(const unsigned char *bytes, bool swap);
uint32_t bwi_u32(const unsigned char *bytes, bool swap);
uint64_t bwi_u64(const unsigned char *bytes, bool swap);
float bwi_f32(const unsigned char *bytes, bool swap);
double bwi_f64(const unsigned char *bytes, bool swap);

/* ---- numbers as text (numbers.c) ------------------------------------------------------------ */

typedef enum bwi_number_kind { BWI_NOT_A_NUMBER, BWI_NUMBER, BWI_NOT_FINITE } bwi_number_kind;
/* Reads a decimal number at `at`, rounded correctly; *after is set behind it. NaN and infinities in
 * any of the usual spellings, and overflow, are BWI_NOT_FINITE. */
bwi_number_kind bwi_parse_real(const unsigned char *at, const unsigned char *end, double *value,
                               const unsigned char **after);
bool bwi_parse_integer(const unsigned char *at, const unsigned char *end, int64_t *value,
                       const unsigned char **after);

/* ---- collecting a surface (soup.c) ----------------------------------------------------------- */

typedef struct bwi_soup {
  bw_context *context;
  const char *name;
  double *point;
  int32_t *triangle, *group;
  size_t point_count, point_capacity;
  size_t triangle_count, triangle_capacity, group_capacity;
  int32_t current_group, group_count; /* groups that have a facet */
  bool group_used;                    /* the current one has one */
  bool numbered;                      /* groups have the numbers that the file gives */
  int64_t polygons, skipped;
} bwi_soup;

void bwi_soup_init(bwi_soup *soup, bw_context *context, const char *name);
void bwi_soup_clear(bwi_soup *soup);
bw_status bwi_soup_point(bwi_soup *soup, const double point[3]);
/* Corners must be valid numbers of points that are there. */
bw_status bwi_soup_triangle(bwi_soup *soup, int32_t a, int32_t b, int32_t c);
bw_status bwi_soup_polygon(bwi_soup *soup, const int32_t *corner, size_t count);
/* Facets from now on belong to a new group (unless the current one is still empty). */
void bwi_soup_next_group(bwi_soup *soup);
/* Facets from `first` on belong to the group of this number, which the file gives. */
void bwi_soup_regroup(bwi_soup *soup, size_t first, int32_t group);
/* Hands the arrays over; BW_FORMAT when there is no facet. `weld`: merge equal points. */
bw_status bwi_soup_finish(bwi_soup *soup, const char *format, bool weld, bw_surface **surface,
                          bw_read_info *info);

/* Cut a polygon (corner numbers into point) into count-2 triangles, which go to `triangle`, by ear
 * clipping in its best-fit plane. (triangulate.c) */
enum { BWI_POLYGON_CORNERS = 20000 };
bw_status bwi_triangulate(bw_context *context, const double *point, const int32_t *corner,
                          size_t count, int32_t *triangle);

bw_context *bwi_writer_context(const bw_writer *writer);

/* ---- one reader and writer per format ------------------------------------------------------ */

bool bwi_stl_is_binary(const unsigned char *bytes, size_t count); /* by size consistency */
bw_status bwi_stl_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info);
bw_status bwi_stl_write(bw_writer *writer, const bw_surface *surface, bool ascii);
bw_status bwi_obj_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info);
bw_status bwi_off_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info);
bw_status bwi_off_write(bw_writer *writer, const bw_surface *surface);
bw_status bwi_ply_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info);
bw_status bwi_3mf_parse(bwi_cursor *archive, bw_surface **surface, bw_read_info *info);
bw_status bwi_medit_write(bw_writer *writer, const bw_mesh *mesh);
bw_status bwi_inp_write_mesh(bw_writer *writer, const bw_mesh *mesh);

#endif
