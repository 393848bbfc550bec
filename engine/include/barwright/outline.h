/* outline: shapes in the plane bounded by lines and Bézier curves, with holes and regions; their
 * handles, measures and edits. Users drag them, and plane meshes follow them. */
#ifndef BARWRIGHT_OUTLINE_H
#define BARWRIGHT_OUTLINE_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A segment runs from point[0] to point[3]; a line has control points -1. Segments of a loop follow
 * each other, each beginning at the point where the one before ends, the first where the last
 * ends. Every point is the start of one segment or one control point of one segment. `tag` groups
 * segments for conditions and handles. */
typedef struct bw_segment {
  int32_t point[4]; /* start, control, control, end */
  int32_t tag;      /* from 0; index into the outline's tag names */
} bw_segment;

/* What lies on a loop's inner side. Outer loops run counter-clockwise and hold a region; loops
 * inside a region are holes (region -1, stored clockwise) or hold another region: the boundary
 * between the two is then inside the material. */
typedef struct bw_loop {
  int32_t first, count; /* segments */
  int32_t region;       /* region number inside, -1: a hole */
  int32_t parent;       /* the loop directly around it, -1: none */
  bw_name name;         /* names of loops differ; "": "loop N" */
} bw_loop;

/* The least relative distance of segments that are no neighbours (see bw_outline). */
#define BW_OUTLINE_GAP 1e-9
/* A shape in the plane. Immutable; always valid: every loop closed and simple, loops disjoint and
 * properly nested. Segments that are not neighbours stay more than BW_OUTLINE_GAP times the size of
 * the outline (the diagonal of its box, or the largest coordinate if that is larger) apart.
 * Neighbours meet in their common end only, and not at an angle of zero. */
typedef struct bw_outline {
  bw_object object;
  const struct bw_outline *origin; /* retained: whose topology this is; NULL: its own */
  int32_t point_count, segment_count, loop_count, region_count, tag_count;
  double *point;       /* (m, point_count x 2) vertices and control points */
  bw_segment *segment; /* segment_count; this and the next two are shared within a topology */
  bw_loop *loop;       /* loop_count */
  bw_name *tag;        /* tag_count names */
} bw_outline;

/* From a description: point (m, points x 2), checked to be finite; `segments` segments loop by loop
 * in order; `loops` loops with `first`, `count`, `region` and `name` (direction and parent are
 * found). A loop that runs the wrong way is turned: it begins at the same point and runs backwards;
 * point numbers stay. Loops without a name are called "loop N" (N from 1); `tags` names of tags, or
 * 0 for one, "boundary". BW_GEOMETRY names loop, segment and place (segments counted from 1 through
 * all loops; details "segment", "other_segment", "x", "y") of a crossing, a doubled point, a loop
 * that lies outside of everything it should be in, or an empty area. */
BW_API bw_status bw_outline_create(bw_context *context, int32_t points, const double *point,
                                   int32_t segments, const bw_segment *segment, int32_t loops,
                                   const bw_loop *loop, int32_t tags, const bw_name *tag,
                                   bw_outline **outline);
/* The same topology with other points, point (m, point_count x 2): what dragging makes. BW_GEOMETRY
 * names a crossing with its place ("segment 4 of loop 'hole' crosses segment 1 of loop 'body' at
 * (0.1, 0.2)"). */
BW_API bw_status bw_outline_moved(bw_context *context, const bw_outline *outline,
                                  const double *point, bw_outline **moved);
/* Whether one was made from the other by moving points. */
BW_API bool bw_outline_same_topology(const bw_outline *a, const bw_outline *b);
/* The loop of a name; -1: none. */
BW_API int32_t bw_outline_find_loop(const bw_outline *outline, const char *name);
/* The tag of a name; -1: none. */
BW_API int32_t bw_outline_find_tag(const bw_outline *outline, const char *name);

/* What a handle moves. */
typedef enum bw_handle_kind {
  BW_HANDLE_VERTEX,  /* a point; the control points beside a vertex go with it */
  BW_HANDLE_SEGMENT, /* both ends and the controls of an edge, and the control points beside them */
  BW_HANDLE_LOOP,    /* a whole loop with the loops inside it */
  BW_HANDLE_POINT    /* a single point, vertex or control point, alone */
} bw_handle_kind;
/* Displacement of every outline point under a unit move of a handle, the index-th point, segment or
 * loop: weight (-, point_count) in 0..1, the same in x and y. */
BW_API bw_status bw_outline_handle(bw_context *context, const bw_outline *outline,
                                   bw_handle_kind kind, int32_t index, double *weight);

/* position (m), first derivative (m) and second (m) by t at parameter t (-) in 0..1 of a segment;
 * the derivatives may be NULL. */
BW_API void bw_outline_evaluate(const bw_outline *outline, int32_t segment, double t,
                                double position[2], double derivative[2], double second[2]);
/* d position / d points at t (-) of a segment: weight (-) of the (at most) four points, in the
 * order of bw_segment; lines have (1-t, 0, 0, t). */
BW_API void bw_outline_basis(const bw_outline *outline, int32_t segment, double t,
                             double weight[4]);

/* Integrals over the material of an outline. */
typedef struct bw_outline_measures {
  double area;             /* (m2) holes left out */
  double perimeter;        /* (m) inner boundaries not counted */
  double centroid[2];      /* (m) */
  double second_moment[3]; /* (m4) about the centroid: xx (integral of y^2), yy (of x^2), xy */
  double min[2], max[2];   /* (m) box of the curves */
} bw_outline_measures;
/* The measures of one region. Exact for lines and cubics (Green's theorem on polynomials); `region`
 * -1: all of them. */
BW_API bw_status bw_outline_measure(bw_context *context, const bw_outline *outline, int32_t region,
                                    bw_outline_measures *measures);
/* d area / d points of all regions: gradient (m, point_count x 2). */
BW_API bw_status bw_outline_area_gradient(bw_context *context, const bw_outline *outline,
                                          double *gradient);

/* Laplacian smoothing of a `loop`'s vertices and controls by a strength (-) in 0..1, `rounds` times
 * (to 100000); vertices at which the loop turns by more than corner (rad) are kept. BW_GEOMETRY
 * where the result crosses itself. */
BW_API bw_status bw_outline_smoothed(bw_context *context, const bw_outline *outline, int32_t loop,
                                     double strength, int rounds, double corner,
                                     bw_outline **smoothed);
/* A loop more (a hole or a region) of `points` points, point (m, points x 2), and `segments`
 * segments, numbered from 0, its tags those of the outline. BW_GEOMETRY where it does not fit,
 * BW_LIMIT for too many points. */
BW_API bw_status bw_outline_with_loop(bw_context *context, const bw_outline *outline,
                                      int32_t points, const double *point, int32_t segments,
                                      const bw_segment *segment, const bw_loop *loop,
                                      bw_outline **larger);
/* The outline without a `loop` and the loops inside it: points behind those that go move up, and
 * regions close up. BW_GEOMETRY for the last one, BW_LIMIT as above. */
BW_API bw_status bw_outline_without_loop(bw_context *context, const bw_outline *outline,
                                         int32_t loop, bw_outline **smaller);
/* Push-pin pulling of a curve: the `vertex` goes to `to` (m), and `pins` vertices, pin (index,
 * pins), stay. The points of the loop between follow as rigidly as possible, up to the first vertex
 * reach (m) away along the curve, 0: up to the pins. Without pins and reach the loop moves as a
 * whole; about a single pin it turns. BW_GEOMETRY where the result crosses itself. */
BW_API bw_status bw_outline_pulled(bw_context *context, const bw_outline *outline, int32_t vertex,
                                   const double to[2], int32_t pins, const int32_t *pin,
                                   double reach, bw_outline **pulled);
/* A segment cut in two at t (-) in (0, 1) by de Casteljau: the second half is the next segment, and
 * the new points are the last: first the vertex, then the second half's control points. */
BW_API bw_status bw_outline_split(bw_context *context, const bw_outline *outline, int32_t segment,
                                  double t, bw_outline **finer);
/* A `vertex` between two segments taken out: one segment remains of the two, with the tag of the
 * first; two lines give a line, else a cubic with the same directions at its ends, which undoes a
 * split exactly. Points behind those that go move up. BW_GEOMETRY where the result crosses
 * itself. */
BW_API bw_status bw_outline_joined(bw_context *context, const bw_outline *outline, int32_t vertex,
                                   bw_outline **coarser);

/* The same outline with another `tag` on `segments` segments, segment (index, segments); the tag is
 * added when it is new. */
BW_API bw_status bw_outline_tagged(bw_context *context, const bw_outline *outline, int32_t segments,
                                   const int32_t *segment, const char *tag, bw_outline **tagged);

/* The place on the outline nearest to a point: segment, parameter, distance. */
typedef struct bw_outline_place {
  int32_t segment; /* (index) */
  double t;        /* (-) parameter on it, 0 to 1 */
  double distance; /* (m) from the point */
} bw_outline_place;
/* The place nearest on the whole outline. */
BW_API bw_outline_place bw_outline_nearest(const bw_outline *outline, const double at[2]);
/* The same for one segment. */
BW_API bw_outline_place bw_segment_nearest(const bw_outline *outline, int32_t segment,
                                           const double at[2]);
/* The length (m) of a segment. */
BW_API double bw_segment_length(const bw_outline *outline, int32_t segment);
/* The box of a segment, that of its curve, not of its control points. */
BW_API void bw_segment_box(const bw_outline *outline, int32_t segment, double min[2],
                           double max[2]);
/* The loop that a segment belongs to. */
BW_API int32_t bw_segment_loop(const bw_outline *outline, int32_t segment);

/* Points along the curves, loop by loop (as polygons without the closing point): for pictures,
 * cutting files, tests. bw_polygons_clear releases them. */
typedef struct bw_polygons {
  int32_t loop_count;
  int32_t *start; /* (index, loop_count + 1) first point of each loop, and the end */
  double *point;  /* (m, start[loop_count] x 2) */
} bw_polygons;
/* The polygons no farther than tolerance (m) from the curves. BW_LIMIT for too many points. */
BW_API bw_status bw_outline_flatten(bw_context *context, const bw_outline *outline,
                                    double tolerance, bw_polygons *polygons);
BW_API void bw_polygons_clear(bw_polygons *polygons);

#ifdef __cplusplus
}
#endif
#endif
