/* singular: places where linear elasticity has no finite stress, and how fast the stress grows
 * there. */
#ifndef BARWRIGHT_SINGULAR_H
#define BARWRIGHT_SINGULAR_H

#include "barwright/faces.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The two faces at an edge. */
typedef enum bw_corner {
  BW_CORNER_FREE,   /* both free */
  BW_CORNER_FIXED,  /* one free, one constrained in all directions */
  BW_CORNER_SLIDING /* one free, one constrained along its normal only */
} bw_corner;

/* Williams' exponent lambda (-) of an edge with the opening `angle` inside the material (rad), up
 * to 2 pi: displacements go like r^lambda and stresses like r^(lambda - 1) with the distance r. The
 * least real part in (0, 1) of the roots of plane strain, symmetric ones only where both faces are
 * free; 1 where stresses stay finite. `poisson` counts for a fixed face only. */
BW_API double bw_williams_exponent(bw_corner corner, double angle, double poisson);

/* What makes a place singular. */
typedef enum bw_singular_kind {
  BW_SINGULAR_EDGE,         /* re-entrant, without a fillet */
  BW_SINGULAR_SUPPORT,      /* border of a support */
  BW_SINGULAR_COUPLING,     /* border of a rigid coupling */
  BW_SINGULAR_BOND,         /* end of a bond, beyond which one of the bodies goes on */
  BW_SINGULAR_LINE_LOAD,    /* loads at nodes along a line */
  BW_SINGULAR_LINE_SUPPORT, /* supports at nodes along a line */
  BW_SINGULAR_POINT_LOAD,   /* a load at a single node */
  BW_SINGULAR_POINT_SUPPORT /* a support at a single node */
} bw_singular_kind;
BW_API const char *bw_singular_word(bw_singular_kind kind); /* "re-entrant edge", ... */

/* A singular place. */
typedef struct bw_singular_place {
  bw_singular_kind kind; /* what makes it singular */
  int32_t first, count;  /* its points: a polyline, or one point */
  double length;         /* (m) of the polyline; 0 for a point */
  double angle;          /* (rad) inside the material: mean along the edge; 0 for a point */
  double min_angle, largest_angle; /* (rad) along the edge */
  double exponent; /* (-) Williams' lambda at the mean angle; 0 for loads and supports at nodes */
} bw_singular_place;

/* Singular places with their points. */
typedef struct bw_singular_places {
  bw_object object;
  int32_t count;
  bw_singular_place *place; /* edges by descending length */
  int32_t point_count;
  double *point;  /* (m, point_count x 3) */
  double *inward; /* (-, point_count x 3) the bisector into the material, unit; on a sliding face,
                     along it */
} bw_singular_places;

/* The re-entrant edges of a closed surface: those where the angle inside the material exceeds 180
 * degrees by more than margin (rad), 0 for 10 degrees, between two recognised faces. Where one is
 * free form, it is more than 30 degrees (docs/theory/singular.md). `faces`: of this surface, or
 * NULL. BW_GEOMETRY for a surface that is open, or not turned outwards. */
BW_API bw_status bw_singular_edges(bw_context *context, const bw_surface *surface,
                                   const bw_faces *faces, double margin,
                                   bw_singular_places **edges);

#ifdef __cplusplus
}
#endif
#endif
