/* singular: places where linear elasticity has no finite stress, and how fast the stress grows
 * there. */
#ifndef BARWRIGHT_SINGULAR_H
#define BARWRIGHT_SINGULAR_H

#include "barwright/faces.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The two faces at an edge: both free; one free and one held in all directions; one free and one
 * held along its normal only. */
typedef enum bw_corner { BW_CORNER_FREE, BW_CORNER_FIXED, BW_CORNER_SLIDING } bw_corner;

/* Williams' exponent lambda of an edge with the opening `angle` inside the material (radians, up to
 * 2 pi): displacements go like r^lambda and stresses like r^(lambda - 1) with the distance r. The
 * least real part in (0, 1) of the roots of plane strain, symmetric ones only where both faces are
 * free; 1 where stresses stay finite. `poisson` counts for a fixed face only. */
BW_API double bw_williams_exponent(bw_corner corner, double angle, double poisson);

typedef enum bw_singular_kind {
  BW_SINGULAR_EDGE,    /* re-entrant, without a fillet */
  BW_SINGULAR_SUPPORT, /* border of a support */
  BW_SINGULAR_LINE_LOAD,
  BW_SINGULAR_LINE_SUPPORT,
  BW_SINGULAR_POINT_LOAD,
  BW_SINGULAR_POINT_SUPPORT
} bw_singular_kind;
BW_API const char *bw_singular_word(bw_singular_kind kind); /* "re-entrant edge", ... */

typedef struct bw_singular_place {
  bw_singular_kind kind;
  int32_t first, count; /* its points: a polyline, or one point */
  double length;        /* m */
  double angle;         /* inside the material, radians: mean along the edge; 0 for a point */
  double min_angle, largest_angle;
  double exponent; /* lambda at the mean angle */
} bw_singular_place;

typedef struct bw_singular_places {
  bw_object object;
  int32_t count;
  bw_singular_place *place; /* edges by descending length */
  int32_t point_count;
  double *point; /* 3 per point */
  double
      *inward; /* 3 per point: the bisector into the material, unit; on a sliding face, along it */
} bw_singular_places;

/* The re-entrant edges of a closed surface: those where the angle inside the material exceeds 180
 * degrees by more than `margin` (radians; 0: 10 degrees) between two recognised faces, and by more
 * than 30 degrees where one is free form (docs/theory/singular.md). `faces`: of this surface, or
 * NULL. BW_GEOMETRY for a surface that is open, or not turned outwards. */
BW_API bw_status bw_singular_edges(bw_context *context, const bw_surface *surface,
                                   const bw_faces *faces, double margin,
                                   bw_singular_places **edges);

#ifdef __cplusplus
}
#endif
#endif
