/* picture: images of a result without a display. */
#ifndef BARWRIGHT_PICTURE_H
#define BARWRIGHT_PICTURE_H

#include "barwright/analysis.h"
#include "barwright/grid.h"
#include "barwright/outline.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A line over the surface: straight pieces between borrowed points. */
typedef struct bw_picture_line {
  int count;
  const double *point; /* (m, count x 3) */
} bw_picture_line;

/* A text at a place on the surface. */
typedef struct bw_picture_label {
  double at[3];
  const char *text; /* borrowed, UTF-8 */
} bw_picture_label;

/* How a surface is drawn; all pointers are borrowed. */
typedef struct bw_picture_options {
  int width, height;   /* pixels, default 1200 x 900, 64 to 16384 */
  double direction[3]; /* from the object to the viewer; zero (default): from the front right and
                        * above, turned about `up` until the largest value and the arrows show */
  double up[3];        /* (-) default (0, 0, 1) */
  double zoom;         /* (-) default 1: the box fills the picture; above 0, to 10000 */
  const char *title;   /* may be NULL */
  const char *unit;    /* of the colour bar, with a name: "max principal stress, MPa" */
  double scale;    /* (-) values are multiplied by this for the bar's labels; default 1, not 0 */
  double min, max; /* (any) colour range; default both 0: from the values */
  bool edges;      /* draw facet edges; default false */
  int arrow_count;
  const bw_arrow
      *arrow; /* the longest is drawn a fifth of the box's diagonal; its force is written.
                 One that pushes ends on the body, one that pulls starts there */
  int line_count;
  const bw_picture_line
      *line;             /* in violet, hidden where the body is in front; move with the body */
  const char *line_name; /* what they are, for the legend; may be NULL */
  int label_count;
  const bw_picture_label *label; /* left out where the body is in front, and over labels before */
  double deformation; /* (-) factor on the displacement, finite; default 0: so that the largest is a
                       twentieth of the box */
  const double *displacement; /* (m, point_count x 3) or NULL */
  bool ghost;                 /* draw the undeformed outline behind in grey; default false */
} bw_picture_options;
BW_API void bw_picture_options_default(bw_picture_options *options);
/* A shaded surface coloured by value (any, one per point, or per facet with `on_facets`; NULL:
 * plain), with a colour bar, to a PNG file, written whole or not at all. The largest value is
 * marked on the body and on the bar; values that are not finite are grey. `options` may be NULL.
 * The same input gives the same bytes, for any number of threads. BW_EMPTY for a surface without
 * facets, BW_GEOMETRY for one too large to draw, BW_LIMIT for too many pixels, BW_UNSUPPORTED where
 * `path` does not end in .png or .apng, as for all pictures. */
BW_API bw_status bw_picture_surface(bw_context *context, const bw_surface *surface,
                                    const double *value, bool on_facets,
                                    const bw_picture_options *options, const char *path);
/* From where bw_picture_surface with the same value (any, as there), on_facets and options sees the
 * body: the direction of the options, or the chosen one, unit. Those of bw_picture_surface. */
BW_API bw_status bw_picture_direction(bw_context *context, const bw_surface *surface,
                                      const double *value, bool on_facets,
                                      const bw_picture_options *options, double direction[3]);
/* An outline, flat, to a PNG file of width x height pixels (16 to 20000 each): regions, edges
 * coloured by their tags, with `numbers` those of the edges (from 1). */
BW_API bw_status bw_picture_outline(bw_context *context, const bw_outline *outline, int width,
                                    int height, bool numbers, const char *path);

/* ---- grids ----------------------------------------------------------------------------------- */

/* One of several pictures of grids side by side; all pointers are borrowed. */
typedef struct bw_grid_panel {
  const bw_grid *grid;
  const char *title;          /* may be NULL */
  const double *displacement; /* (m, node_count x 3) or NULL */
  const double *value;        /* (any, node_count) or NULL: coloured by material */
  bool on_elements;           /* `value` has element_count numbers, of elements */
  /* drawn in place of the elements: a surface whose points go with the grid; both or none */
  const bw_surface *surface;
  const bw_embedding *embedding;
} bw_grid_panel;
/* How grids are drawn; all pointers are borrowed. */
typedef struct bw_grid_picture_options {
  int width, height;          /* pixels of a panel, default 640 x 560, 64 or more */
  int columns;                /* panels in a row, 0 or more; 0 (default): all, four at most */
  double direction[3], up[3]; /* (-) and their defaults as in bw_picture_options */
  double zoom;                /* (-) default 1: the largest panel fills its frame; to 10000 */
  double view_min[3],
      view_max[3]; /* (m) the box that is to be seen, so that the pictures of a sequence fit
                  each other; default both zero: that of all panels' displaced elements */
  const char *title, *unit; /* may be NULL */
  double scale;             /* (-) factor on values for the bar's labels; default 1, not 0 */
  double min, max;          /* (any) colour range; default both 0: from all panels' values */
  double deformation;       /* (-) factor on displacements, finite; default 1 */
  bool edges;               /* of elements; default true */
  bool ghost;               /* the undeformed outline behind; default false */
  int name_count;           /* of materials, for the legend: name[m - 1], or NULL: its number */
  const char *const *name;  /* name_count names */
} bw_grid_picture_options;
BW_API void bw_grid_picture_options_default(bw_grid_picture_options *options);
/* `count` grids with the edges of their elements, deformed, coloured by material or by values, all
 * with the same camera, scale and colours, to one PNG file. `options` may be NULL. BW_LIMIT for too
 * many pixels. */
BW_API bw_status bw_picture_grids(bw_context *context, int count, const bw_grid_panel *panel,
                                  const bw_grid_picture_options *options, const char *path);
/* `count` files `png` of one size as an animated PNG, which browsers play and other programs show
 * the first picture of. `seconds` of each picture (0.001 to 60); it starts over again `rounds`
 * times (0: for ever). BW_FORMAT where a file is no PNG, BW_LIMIT where it is too large. */
BW_API bw_status bw_animation_write(bw_context *context, int count, const char *const *png,
                                    double seconds, int rounds, const char *path);
/* ---- drawings -------------------------------------------------------------------------------- */

/* A drawing of lines, markers, text and images: a mutable object with a list of what was drawn, to
 * be written as SVG or PNG. Lengths are in pixels from the top left corner, y downwards. What is
 * drawn later lies above. Coordinates are finite, and cut at a million pixels. What a function is
 * given is copied; one that fails draws nothing. */
typedef struct bw_canvas bw_canvas;

/* Colours are red, green, blue, opacity, from 0 to 1. What has no opacity is not drawn. */
typedef struct bw_pen {
  double fill[4], stroke[4]; /* (-) colours */
  double width;              /* (pixels) of the stroke */
  double dash[4];            /* (pixels) lengths on, off, on, off; all 0: a solid line */
  bool round;                /* ends and corners of the stroke */
} bw_pen;

/* The shape of markers. */
typedef enum bw_marker {
  BW_DISC,          /* a circle */
  BW_SQUARE,        /* a square on a side */
  BW_DIAMOND,       /* a square on a corner */
  BW_TRIANGLE,      /* a triangle that points up */
  BW_TRIANGLE_DOWN, /* a triangle that points down */
  BW_CROSS,         /* an x; this and the next are strokes alone */
  BW_PLUS,          /* a + */
  BW_MARKER_COUNT   /* how many there are */
} bw_marker;

/* How a text is drawn. */
typedef struct bw_label {
  double x, y;      /* (pixels) on the baseline */
  double size;      /* (pixels) of the font */
  double align;     /* (-) 0: (x, y) is the left end, 0.5: the middle, 1: the right end */
  double angle;     /* (degrees) counterclockwise about (x, y) */
  double colour[4]; /* (-) as in bw_pen */
  bool bold;        /* in a bold font */
  bool halo;        /* a pale rim, for text over lines */
} bw_label;

/* An empty drawing of width (pixels) and height (pixels), 1 to 20000 each. `name`: what it shows,
 * for those who cannot see it (SVG); may be NULL. */
BW_API bw_status bw_canvas_create(bw_context *context, double width, double height,
                                  const char *name, bw_canvas **canvas);
/* Its size (pixels): width, height. */
BW_API void bw_canvas_size(const bw_canvas *canvas, double size[2]);
/* A line through point (pixels, count x 2), or a `closed` one, filled by the even-odd rule. A point
 * that is not finite breaks it: what follows is a piece of its own. */
BW_API bw_status bw_canvas_line(bw_context *context, bw_canvas *canvas, const bw_pen *pen,
                                bool closed, int64_t count, const double *point);
/* A rectangle box (pixels): x, y, width, height, with corners rounded by radius (pixels). */
BW_API bw_status bw_canvas_rectangle(bw_context *context, bw_canvas *canvas, const bw_pen *pen,
                                     const double box[4], double radius);
/* Markers of a size (pixels) across at point (pixels, count x 2); points that are not finite are
 * passed over. `note`: what SVG
 * shows where the pointer rests, for each point, or NULL. */
BW_API bw_status bw_canvas_markers(bw_context *context, bw_canvas *canvas, const bw_pen *pen,
                                   bw_marker marker, double size, int64_t count,
                                   const double *point, const char *const *note);
/* A line of text. */
BW_API bw_status bw_canvas_text(bw_context *context, bw_canvas *canvas, const bw_label *label,
                                const char *text);
/* The *width (pixels) of a text in a font of size (pixels), bold or not. */
BW_API bw_status bw_canvas_text_width(bw_context *context, const bw_canvas *canvas, double size,
                                      bool bold, const char *text, double *width);
/* What is drawn until bw_canvas_leave is cut at box (pixels): x, y, width, height; there the part
 * view (any), likewise, of a drawing of its own is seen, centred and as large as fits. NULL: no
 * change of coordinates. At most 60 deep. */
BW_API bw_status bw_canvas_enter(bw_context *context, bw_canvas *canvas, const double box[4],
                                 const double view[4]);
/* Ends what bw_canvas_enter began last; BW_INVALID where nothing was. */
BW_API bw_status bw_canvas_leave(bw_context *context, bw_canvas *canvas);
/* An image of `rows` rows from the top of `columns` pixels of red, green, blue bytes, stretched to
 * box (pixels). */
BW_API bw_status bw_canvas_pixels(bw_context *context, bw_canvas *canvas, const double box[4],
                                  int columns, int rows, const unsigned char *rgb);
/* A PNG file, as large as fits in box (pixels), centred; one of more pixels than are seen is
 * reduced to twice the box. BW_FORMAT where it is no PNG, BW_LIMIT where it is too large. */
BW_API bw_status bw_canvas_image(bw_context *context, bw_canvas *canvas, const double box[4],
                                 const char *path);

/* The drawing as one <svg> element without ids, so that many can stand in one page. Text is text of
 * the width that it has here, whatever fonts there are; or, with `outlines`, paths. Release it
 * with bw_free; *length is without the final 0. The same drawing gives the same bytes. */
BW_API bw_status bw_canvas_svg(bw_context *context, const bw_canvas *canvas, bool outlines,
                               char **text, size_t *length);
/* By the ending: .svg, with `outlines` as bw_canvas_svg, or .png with scale (-) pixels for each of
 * the drawing's (0.1 to 8). BW_UNSUPPORTED for another ending. */
BW_API bw_status bw_canvas_write(bw_context *context, const bw_canvas *canvas, double scale,
                                 bool outlines, const char *path);

/* The index-th (from 0) of a dozen colours that differ clearly, sRGB bytes; then they repeat. */
BW_API void bw_category_colour(int64_t index, unsigned char rgb[3]);

/* The colour map: t (-), 0 to 1, to sRGB bytes; nan: grey. Shared with the report: even in the
 * OKLab space, lightness falling from a pale blue to a dark red. */
BW_API void bw_colour(double t, unsigned char rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
