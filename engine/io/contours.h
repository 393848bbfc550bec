/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the readers of drawings share: lines and curves, closed ones and ones that only meet at
 * their ends, on the way to an outline. */
#ifndef BWI_IO_CONTOURS_H
#define BWI_IO_CONTOURS_H

#include "io/internal.h"
#include "outline/internal.h"

enum { BWI_REGION_BY_NESTING = -2 };

typedef struct bwi_contour_edge {
  bwi_outline_curve curve;
  int32_t tag;
} bwi_contour_edge;

/* A run of edges, each beginning where the one before ends. */
typedef struct bwi_contour_piece {
  size_t first, count; /* edges */
  bool closed;         /* said to be; its last edge is then a line back to the start */
  int32_t region;      /* -1: a hole, or BWI_REGION_BY_NESTING */
  int64_t line;        /* of the file, for messages */
  bw_name name;
} bwi_contour_piece;

/* The first failure of memory sticks in `status` and comes back from bwi_contours_finish. */
typedef struct bwi_contours {
  bw_context *context;
  const char *name; /* of the file */
  bwi_contour_edge *edge;
  bwi_contour_piece *piece;
  size_t edges, edge_capacity, pieces, piece_capacity;
  bwi_draft draft;  /* its tags */
  double matrix[6]; /* a c e; b d f as in SVG: x' = m0 x + m2 y + m4, y' = m1 x + m3 y + m5 */
  double start[2], at[2];
  int32_t tag;
  bw_status status;
} bwi_contours;

void bwi_contours_init(bwi_contours *contours, bw_context *context, const char *name);
void bwi_contours_clear(bwi_contours *contours);
/* A new piece beginning at a place; its edges have the contours' tag. */
void bwi_contours_begin(bwi_contours *contours, const double at[2], const bw_name *name,
                        int32_t region, int64_t line);
void bwi_contours_line(bwi_contours *contours, const double to[2]);
void bwi_contours_cubic(bwi_contours *contours, const double control1[2], const double control2[2],
                        const double to[2]);
void bwi_contours_quadratic(bwi_contours *contours, const double control[2], const double to[2]);
/* centre + cos a u + sin a v for a from `from` to `to`, by cubics of at most 45 degrees, which are
 * off by 4e-6 of the radius. */
void bwi_contours_arc(bwi_contours *contours, const double centre[2], const double u[2],
                      const double v[2], double from, double to);
/* The arc that goes on from here to `to` and turns by 4 atan(bulge). */
void bwi_contours_bulge(bwi_contours *contours, const double to[2], double bulge);
void bwi_contours_end(bwi_contours *contours, bool close);
/* Open pieces are put together where ends lie within `tolerance` (0: 1e-5 of the size) of each
 * other; loops inside an even number of others are material, the rest holes. */
bw_status bwi_contours_finish(bwi_contours *contours, double tolerance, bw_outline **outline);

/* ---- one reader and writer per format ------------------------------------------------------- */

/* `unit`: metres per unit of the file, 0: what the file says. */
bw_status bwi_svg_parse(bwi_cursor *cursor, double unit, bwi_contours *contours,
                        bw_read_info *info);
bw_status bwi_svg_write(bw_writer *writer, const bw_outline *outline);
bw_status bwi_dxf_parse(bwi_cursor *cursor, double unit, bwi_contours *contours,
                        bw_read_info *info);
bw_status bwi_dxf_write(bw_writer *writer, const bw_outline *outline);

/* SVG's path data: the "d" of a path (svg_path.c). The cursor ends with the value. */
bw_status bwi_svg_path(bwi_cursor *cursor, bwi_contours *contours, const bw_name *name,
                       int32_t region);
/* A list of numbers with optional commas: the next one; *any is false at the end. */
bw_status bwi_svg_number(bwi_cursor *cursor, double *value, bool *any);
/* matrix := matrix * transform (svg_transform.c) */
bw_status bwi_svg_transform(bwi_cursor *cursor, double matrix[6]);
void bwi_matrix_multiply(double matrix[6], const double right[6]);

/* A B-spline of degree 1 to 3 as lines and cubics from where the contours are; its first point is
 * put in *start before anything is added (dxf_spline.c). */
typedef struct bwi_spline {
  int degree;
  size_t knots, points;
  const double *knot, *point; /* points x 2 */
} bwi_spline;
/* Whether knots and points fit; else a sentence about what is wrong. */
const char *bwi_spline_wrong(const bwi_spline *spline);
void bwi_spline_start(const bwi_spline *spline, double at[2]);
void bwi_spline_add(const bwi_spline *spline, bwi_contours *contours);

#endif
