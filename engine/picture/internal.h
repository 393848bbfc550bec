/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of the picture share. Pixels count from the top left corner, y downwards; depth is
 * in pixels too and grows towards the viewer. */
#ifndef BW_PICTURE_INTERNAL_H
#define BW_PICTURE_INTERNAL_H

#include <cairo.h>

#include "barwright/picture.h"

/* ---- camera.c -------------------------------------------------------------------------------- */

/* A view along parallel lines: no perspective, so that lengths compare. */
typedef struct bwi_view {
  double axis[3][3]; /* rows: to the right, upwards, towards the viewer */
  double scale;      /* pixels per metre */
  double centre[2];  /* along axis 0 and 1: what lies in the middle of the frame */
  double middle[2];  /* pixels of the middle of the frame */
} bwi_view;
/* BW_INVALID when the direction has no length; an up along it is replaced. */
bw_status bwi_view_axes(bw_context *context, const double direction[3], const double up[3],
                        bwi_view *view);
/* The usual direction (1, -1.4, 0.8 where z is up), rotated about `up` by `turn`, from below when
 * so asked. */
void bwi_view_usual(const double up[3], double turn, bool below, double direction[3]);
/* Grow bounds (low and high along axis 0 and 1) by points. */
void bwi_view_bound(const bwi_view *view, int64_t count, const double *point, double bounds[4]);
/* Fit bounds into the frame left, top, right, bottom (pixels). */
void bwi_view_fit(bwi_view *view, const double bounds[4], const double frame[4], double zoom);
void bwi_view_project(const bwi_view *view, const double x[3], double pixel[3]);

/* ---- solid.c: what is drawn ------------------------------------------------------------------ */

typedef enum bwi_finish { BWI_BODY, BWI_ARROW, BWI_GHOST, BWI_TUBE } bwi_finish;

typedef struct bwi_solid {
  bwi_finish finish;
  int32_t point_count, triangle_count;
  double *point; /* owned, as all below */
  int32_t *triangle;
  float *pixel;   /* point_count x 3 */
  float *normal;  /* triangle_count x 9: unit, at the corners, along the view's axes */
  uint8_t *lines; /* triangle_count: bit k set when the edge k, k + 1 is sharp or open */
  /* the body's colours */
  const double *value; /* NULL: plain */
  bool on_facets;
  double low, high;
  bool edges; /* every facet's edges are drawn */
  bool quads; /* facets 2 q and 2 q + 1 are halves of one: their common edge, from corner 2 to 0 of
                 the first, is not drawn */
  const int32_t *category; /* triangle_count, or NULL: colours of categories, without values */
  bool inverted;           /* a closed surface that faces inwards: its inside is what is seen */
} bwi_solid;
/* Normals averaged over the facets around each corner that make less than `crease` with its own,
 * sharp edges, and pixels. The view must be fitted. `push` is added to the depth. */
bw_status bwi_solid_prepare(bw_context *context, bwi_solid *solid, const bwi_view *view,
                            double crease, double push);
void bwi_solid_clear(bwi_solid *solid);
/* Moves a prepared solid behind others, whatever its true depth; `gap` in pixels. */
void bwi_solid_behind(bwi_solid *solid, int count, const bwi_solid *others, double gap);

/* ---- arrows.c -------------------------------------------------------------------------------- */

/* Arrows as one solid. Each touches the body with its tip when it pushes, with its tail when it
 * pulls (by the nearest point's normal). `size`: length of the longest. The tail or tip away from
 * the body is written to `end` (count x 3) for labels. */
/* How often a ray from x along a direction crosses the solid farther than `near` from x (in units
 * of the direction's length), and where first. */
int bwi_solid_crossings(const bwi_solid *solid, const double x[3], const double direction[3],
                        double near, double *first);
bw_status bwi_arrows_solid(bw_context *context, int count, const bw_arrow *arrow, double size,
                           const bwi_solid *body, const double *original, bwi_solid *solid,
                           double *end);

/* The point of the body nearest to x, by its undeformed positions. */
int32_t bwi_solid_nearest(const bwi_solid *body, const double *original, const double x[3]);

/* ---- lines.c --------------------------------------------------------------------------------- */

#define BWI_LINE_COLOUR 0.38, 0.08, 0.84
/* Lines as one solid of tubes of a radius, which go with the body's nearest points; `original`
 * is NULL where the body is not deformed. */
bw_status bwi_lines_solid(bw_context *context, int count, const bw_picture_line *line,
                          double radius, const bwi_solid *body, const double *original,
                          bwi_solid *solid);

/* ---- raster.c -------------------------------------------------------------------------------- */

/* Colours in sRGB bytes, and what lies under each pixel's middle. */
typedef struct bwi_image {
  int width, height;
  unsigned char *colour; /* height x width x 4: red, green, blue of what is there, and coverage */
  float *depth;          /* height x width; -HUGE_VALF where nothing is */
  float *normal;         /* height x width x 3 */
  uint8_t *finish;       /* height x width: bwi_finish */
} bwi_image;
bw_status bwi_render(bw_context *context, int solid_count, const bwi_solid *solid,
                     bwi_image *image);
/* Darken what is shut in by its surroundings within `radius` pixels. */
bw_status bwi_occlude(bw_context *context, bwi_image *image, double radius);
void bwi_image_clear(bwi_image *image);

/* ---- output.c -------------------------------------------------------------------------------- */

/* The image over a background, the ghost with an outline, onto a canvas of its size (RGB24). */
void bwi_compose(const bwi_image *image, cairo_surface_t *canvas);
bw_status bwi_write_png(bw_context *context, cairo_surface_t *canvas, const char *path);
/* BW_UNSUPPORTED where the name of a file does not end in .png or .apng. */
bw_status bwi_need_png(bw_context *context, const char *path);

/* ---- bar.c, annotate.c: Cairo ---------------------------------------------------------------- */

#define BWI_FONT "DejaVu Sans"
/* For the text that follows, and for measuring it: the same letters in every process. */
void bwi_choose_font(cairo_t *cairo, double size, bool bold);

/* Round numbers between low and high, at most `max`; returns their count and the number of
 * decimals that shows them. */
enum { BWI_TICKS = 12 };
int bwi_ticks(double low, double high, int max, double tick[BWI_TICKS], int *decimals);
/* A number with so many decimals, the point a '.' in any locale. */
void bwi_fixed(char *buffer, size_t size, double value, int decimals);

/* "x 10" with an exponent. */
void bwi_times_power(char *buffer, size_t size, int exponent);

typedef struct bwi_bar {
  double low, high;   /* of the bar's ends, already scaled for labels */
  double largest;     /* of the values, likewise; nan: not marked */
  const char *unit;   /* heading, may be NULL */
  bool missing;       /* some values are missing: grey is explained */
  bool below, beyond; /* values lie outside the range */
} bwi_bar;
/* Draws the bar into the rectangle right of x, from top to bottom; `u` is the size of a pixel of a
 * 1200 x 900 picture. */
void bwi_bar_draw(cairo_t *cairo, const bwi_bar *bar, double x, double top, double bottom,
                  double right, double u);

/* Text with a pale halo; x is the left, middle or right end for align 0, 0.5, 1; y the baseline. */
void bwi_draw_text(cairo_t *cairo, double x, double y, double align, double size, bool bold,
                   bool halo, const char *text);
/* Draws text cut or shrunk to `width`. */
void bwi_draw_title(cairo_t *cairo, double x, double y, double width, double size,
                    const char *text);
void bwi_draw_triad(cairo_t *cairo, const bwi_view *view, double x, double y, double length,
                    double u);
/* A piece of a line and what it stands for, x its left end. */
void bwi_draw_line_key(cairo_t *cairo, double x, double y, double u, const char *label);
/* A ring with a leader to a label, kept within the frame. */
void bwi_draw_mark(cairo_t *cairo, const double pixel[3], bool hidden, const double frame[4],
                   double u, const char *label);
/* Bytes that Cairo accepts: invalid UTF-8 becomes '?'. Release with bw_free; NULL: no memory. */
char *bwi_clean_text(bw_context *context, const char *text);

#endif
