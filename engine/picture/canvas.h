/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a canvas keeps, shared by what records it (canvas.c) and what replays it (canvas_cairo.c,
 * canvas_svg.c). Every number kept is finite (but for breaks in lines) and within the reach of
 * Cairo's fixed point; every text is valid UTF-8 without control characters; every image is a PNG
 * that Cairo has read or written. So replaying fails by memory and files alone. */
#ifndef BW_PICTURE_CANVAS_H
#define BW_PICTURE_CANVAS_H

#include "picture/internal.h"

typedef enum bwi_ink_kind {
  BWI_LINE,
  BWI_RECTANGLE,
  BWI_MARKERS,
  BWI_TEXT,
  BWI_IMAGE,
  BWI_ENTER,
  BWI_LEAVE
} bwi_ink_kind;

typedef struct bwi_ink {
  bwi_ink_kind kind;
  bw_pen pen;
  bool closed;      /* line */
  bw_marker marker; /* markers */
  double size;      /* of markers; radius of a rectangle's corners */
  double box[4];    /* rectangle, image, enter */
  double view[4];   /* enter */
  bw_label label;   /* text */
  int64_t count;    /* of points */
  double *point;    /* owned, as all below: line, markers */
  char *text;       /* text; of markers the notes, one behind the other with their final zeros */
  unsigned char *png;
  size_t length;
} bwi_ink;

struct bw_canvas {
  bw_object object;
  double width, height;
  char *name;
  bwi_ink *ink;
  size_t count, capacity;
  int depth; /* boxes entered and not left */
};

/* ---- canvas_cairo.c -------------------------------------------------------------------------- */

/* BW_OK, or the failure that a Cairo status stands for; `what` is the file or the task. */
bw_status bwi_cairo_status(bw_context *context, cairo_status_t status, const char *what);
/* An image as PNG bytes, to be released with bw_free. */
bw_status bwi_png_encode(bw_context *context, cairo_surface_t *image, unsigned char **png,
                         size_t *length);
/* Bytes of a PNG file as an image; `name` stands for the file in messages. */
bw_status bwi_png_decode(bw_context *context, const char *name, const unsigned char *png,
                         size_t length, cairo_surface_t **image);
/* A Cairo context on a tiny image with the fonts' true proportions, for measuring. */
bw_status bwi_ruler_open(bw_context *context, cairo_t **ruler);
bw_status bwi_canvas_png(bw_context *context, const bw_canvas *canvas, double scale,
                         const char *path);
/* The corners of a marker of `size` about 0; returns their count, 0 for a disc. Crosses are pairs
 * of ends. */
enum { BWI_MARKER_CORNERS = 4 };
int bwi_marker_corners(bw_marker marker, double size, double corner[BWI_MARKER_CORNERS][2]);

#endif
