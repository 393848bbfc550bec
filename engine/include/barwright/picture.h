/* picture: images of a result without a display. */
#ifndef BARWRIGHT_PICTURE_H
#define BARWRIGHT_PICTURE_H

#include "barwright/analysis.h"
#include "barwright/outline.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bw_picture_options {
  int width, height;   /* pixels, default 1200 x 900 */
  double direction[3]; /* from the object to the viewer; zero (default): from the front right and
                        * above, turned about `up` until the largest value and the arrows show */
  double up[3];        /* default (0, 0, 1) */
  double zoom;         /* default 1: the box fills the picture */
  const char *title;   /* may be NULL */
  const char *unit;    /* of the colour bar, with a name: "max principal stress, MPa" */
  double scale;        /* values are multiplied by this for the bar's labels; default 1 */
  double low, high;    /* colour range; both 0: from the values */
  bool edges;          /* draw facet edges */
  int arrow_count;
  const bw_arrow
      *arrow;         /* the longest is drawn a fifth of the box's diagonal; its force is written.
                         One that pushes ends on the body, one that pulls starts there */
  double deformation; /* factor on the displacement; 0 with a displacement: chosen so that the
                         largest is a twentieth of the box */
  const double *displacement; /* points x 3, or NULL */
  bool ghost;                 /* draw the undeformed outline behind in grey */
} bw_picture_options;
void bw_picture_options_default(bw_picture_options *options);
/* A shaded surface coloured by values at its points (or by facets when `on_facets`; NULL: plain),
 * with a colour bar, to a PNG file, written whole or not at all. The largest value is marked on the
 * body and on the bar; values that are not finite are grey. `options` may be NULL. The same input
 * gives the same bytes, for any number of threads. */
bw_status bw_picture_surface(bw_context *context, const bw_surface *surface, const double *value,
                             bool on_facets, const bw_picture_options *options, const char *path);
/* An outline, flat, to a PNG file: regions, edges coloured by their tags, with `numbers` those of
 * the edges (from 1). */
bw_status bw_picture_outline(bw_context *context, const bw_outline *outline, int width, int height,
                             bool numbers, const char *path);
/* The colour map (0..1 -> sRGB bytes; nan: grey), shared with the report: even in the OKLab space,
 * lightness falling from a pale blue to a dark red. */
void bw_colour(double t, unsigned char rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
