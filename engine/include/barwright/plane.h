/* plane: triangle meshes of outlines, and how they follow an outline that moves (responsive,
 * section 3). */
#ifndef BARWRIGHT_PLANE_H
#define BARWRIGHT_PLANE_H

#include "barwright/outline.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A plane mesh stands on three immutable objects, one for each level of reuse. Who holds results
 * compares pointers: same topology: the pattern of A holds; same nodes: preconditioner and
 * solution hold (responsive, table 1).
 *
 *   relocation      new bw_plane_mesh, same topology, same nodes
 *   reconnecting    new topology (edges flipped), same nodes
 *   reconstruction  all new
 *
 * Nodes: the first corner_count are corners, the rest mid-edge nodes (order 2). A flip takes one
 * edge away and adds one, so that with order 2 the mid-edge node of the flipped edge becomes the
 * middle of the new one and keeps its number: the DOF map, and with it the preconditioner,
 * survives reconnecting for tri6 as well. */
typedef struct bw_plane_nodes {
  bw_object object;
  int order; /* 1: tri3, 2: tri6 */
  int32_t node_count, corner_count;
  int32_t *segment;  /* of the outline that the node lies on, -1: inside. A vertex of the outline
                        belongs to the segment that begins there (parameter 0) */
  double *parameter; /* t on that segment, fixed for the life of the nodes */
} bw_plane_nodes;

typedef struct bw_plane_topology {
  bw_object object;
  const bw_plane_nodes *nodes; /* retained */
  int32_t element_count;
  int32_t *element;   /* x 3 or 6: corners counter-clockwise, then middles of 01, 12, 20 */
  int32_t *region;    /* element_count */
  int32_t *neighbour; /* element_count x 3: across edges 01, 12, 20; -1 at the boundary */
  /* Edges that lie on segments, boundary and between regions, in the order of segments and along
     them: side k has the same nodes as long as the nodes live. Loops run so that material is on the
     left of the boundary; left of a boundary between regions is the inner one. */
  int32_t side_count;
  int32_t *side;         /* x 2 or 3: start, end, middle */
  int32_t *side_element; /* x 2: left, right (-1: none) */
  int32_t *side_segment;
} bw_plane_topology;

typedef struct bw_plane_mesh {
  bw_object object;
  const bw_plane_topology *topology; /* retained */
  const bw_outline *outline;         /* retained: the shape it fills */
  double *point;                     /* node_count x 2 */
} bw_plane_mesh;

/* The wanted edge length at a point, m. */
typedef double bw_size_function(void *data, const double at[2]);
typedef struct bw_plane_options {
  int order;            /* 1 or 2; default 1 */
  double size;          /* wanted edge length, m; 0: from `elements` */
  int32_t elements;     /* wanted number of triangles (within 10 %) where size is 0; default 2000 */
  double minimum_angle; /* degrees; default 25, at most 30 */
  double curvature;     /* largest turn of a boundary edge, degrees; default 20 */
  bw_size_function *field; /* may be NULL; the smaller of it and `size` counts (of it and 0: it) */
  void *field_data;
  int32_t limit;       /* of elements, BW_LIMIT beyond; default 5,000,000 */
  double time_limit;   /* seconds of computing, BW_LIMIT beyond; default 300 */
  double memory_limit; /* bytes, BW_LIMIT beyond; default 6e9 */
} bw_plane_options;
BW_API void bw_plane_options_default(bw_plane_options *options);
/* Boundary nodes are placed along the segments first (vertices of the outline always are nodes),
 * then the inside is filled (CGAL: constrained Delaunay, refinement; then smoothing with flips).
 * Deterministic. Where a limit is reached, the detail "limit" says which: "elements", "time",
 * "memory". bw_cancel ends it within a fraction of a second. */
BW_API bw_status bw_plane_fill(bw_context *context, const bw_outline *outline,
                               const bw_plane_options *options, bw_plane_mesh **mesh);
/* From arrays (checked: indices, corners first, orientation, neighbours), for tests and bodies by
 * formula; region NULL: all 0. The outline is made of the boundary edges, one segment each (with
 * middles off the chord: the parabola through them), tag "boundary", region 0 inside. */
BW_API bw_status bw_plane_mesh_copy(bw_context *context, int order, int32_t nodes,
                                    const double *point, int32_t elements, const int32_t *element,
                                    const int32_t *region, bw_plane_mesh **mesh);
/* The same on an outline given: each node's segment (-1: inside) and parameter, 0 <= parameter < 1.
 * Every vertex of the outline must be a node. */
BW_API bw_status bw_plane_mesh_on(bw_context *context, const bw_outline *outline, int order,
                                  int32_t nodes, const double *point, const int32_t *segment,
                                  const double *parameter, int32_t elements, const int32_t *element,
                                  const int32_t *region, bw_plane_mesh **mesh);
typedef enum bw_diagonal {
  BW_DIAGONAL_RIGHT, /* from lower left to upper right */
  BW_DIAGONAL_LEFT,
  BW_DIAGONAL_UNION_JACK /* alternating: four squares make a star */
} bw_diagonal;
/* A rectangle of nx x ny squares cut in two. Corners are numbered row by row from below; the
 * outline has four segments with the tags bottom, right, top, left. */
BW_API bw_status bw_plane_rectangle(bw_context *context, int order, const double low[2],
                                    const double high[2], int32_t nx, int32_t ny,
                                    bw_diagonal diagonal, bw_plane_mesh **mesh);
/* Other positions for the same topology: those of boundary nodes must be those of the outline.
 * BW_GEOMETRY names an inverted element. */
BW_API bw_status bw_plane_mesh_moved(bw_context *context, const bw_plane_mesh *mesh,
                                     const bw_outline *outline, const double *point,
                                     bw_plane_mesh **moved);

/* Whether all that a mesh is made of belongs together: finite places, nodes on their segments,
 * sound elements, neighbours that know each other. For tests and debuggers, like all checks of
 * objects. */
BW_API bw_status bw_plane_mesh_check(bw_context *context, const bw_plane_mesh *mesh);

typedef struct bw_plane_quality {
  double worst; /* 2 sqrt(3) inradius / longest edge: 1 equilateral, 0 flat, < 0 inverted; with
                   order 2 also multiplied by the smallest Jacobian over the mean one */
  int32_t worst_element;
  double mean, smallest_angle, largest_angle; /* degrees */
  double area;
  int32_t inverted; /* elements */
} bw_plane_quality;
BW_API void bw_plane_measure(const bw_plane_mesh *mesh, bw_plane_quality *quality);
BW_API double bw_plane_element_quality(const bw_plane_mesh *mesh, int32_t element);

/* Point location: the element that holds `at` (or the nearest one, then *outside is its distance)
 * and barycentric coordinates clipped to it. Built once per mesh. */
typedef struct bw_plane_locator bw_plane_locator;
BW_API bw_status bw_plane_locator_create(bw_context *context, const bw_plane_mesh *mesh,
                                         bw_plane_locator **locator);
BW_API void bw_plane_locator_free(bw_plane_locator *locator);
BW_API int32_t bw_plane_locate(const bw_plane_locator *locator, const double at[2],
                               double barycentric[3], double *outside);
/* Values at the nodes of `from` (x components) carried to the nodes of `to`: copied where the nodes
 * are the same (middles of flipped edges are read from the field as it was), interpolated at the
 * nodes' places otherwise (the nearest place of `from` where they lie outside). */
BW_API bw_status bw_plane_transfer(bw_context *context, const bw_plane_mesh *from,
                                   const bw_plane_mesh *to, int components, const double *value,
                                   double *carried);

/* ---- a mesh that follows its outline (responsive, section 3.3) ---------------------------------
 */

typedef enum bw_level {
  BW_LEVEL_NONE, /* nothing moved */
  BW_LEVEL_RELOCATION,
  BW_LEVEL_RECONNECTING,
  BW_LEVEL_RECONSTRUCTION
} bw_level;
typedef enum bw_relocation {
  BW_RELOCATE_HARMONIC, /* inner nodes take the harmonic extension of the boundary's displacement
                           since the topology was new, stiffer near the boundary (one factor per
                           topology; linear in the outline's points): the default */
  BW_RELOCATE_SPRINGS   /* the paper's: springs of rest length zero, `sweeps` Jacobi rounds */
} bw_relocation;
typedef struct bw_follow_options {
  bw_relocation relocation;
  int sweeps;            /* even; default 2 */
  double distorted;      /* quality below which an element calls for reconnecting; default 0.35 */
  double rebuild;        /* quality below which, after reconnecting, everything is made anew; 0.1 */
  bw_level force;        /* at least this level each time (for tests, baselines); default NONE */
  bw_plane_options fill; /* of reconstructions; the order is the mesh's, elements 0 (the default):
                            as many as the mesh has */
} bw_follow_options;
BW_API void bw_follow_options_default(bw_follow_options *options);

typedef struct bw_follow_report {
  bw_level level;
  int32_t flips;
  double worst;          /* quality after */
  int32_t worst_element; /* of the mesh after */
  bool restored;         /* relocation inverted an element and was taken back before reconnecting */
  double seconds;
} bw_follow_report;

/* Holds the current mesh and what relocation computes once per topology. */
typedef struct bw_mesh_motion {
  bw_object object;
  const bw_plane_mesh *mesh; /* the current one, which lives as long as it is that */
  bw_follow_options options;
  struct bwi_mesh_motion *inner;
} bw_mesh_motion;
BW_API bw_status bw_mesh_motion_create(bw_context *context, const bw_plane_mesh *mesh,
                                       const bw_follow_options *options, bw_mesh_motion **motion);
/* Take the mesh to an outline of the same topology (bw_outline_moved); an outline of another
 * topology means reconstruction. On failure (a wall thinner than any mesh, no memory, cancelled)
 * the mesh motion is as it was. */
BW_API bw_status bw_mesh_motion_follow(bw_context *context, bw_mesh_motion *motion,
                                       const bw_outline *outline, bw_follow_report *report);
/* What a mesh motion stands at, an immutable object: bw_release gives it up. Keeping it copies
 * nothing; returning to it brings back its mesh and all that following starts from, bit for bit
 * (following the outline back may end elsewhere), and fails only for the state of a mesh motion of
 * another order. */
typedef struct bw_mesh_motion_state bw_mesh_motion_state;
BW_API const bw_mesh_motion_state *bw_mesh_motion_keep(const bw_mesh_motion *motion);
BW_API bw_status bw_mesh_motion_return(bw_context *context, bw_mesh_motion *motion,
                                       const bw_mesh_motion_state *state);
BW_API bw_status bw_mesh_motion_check(bw_context *context, const bw_mesh_motion *motion);
/* d J / d outline points (of mesh->outline, point_count x 2) from d J / d nodes (node_count x 2):
 * the adjoint of harmonic relocation. For shape optimisation. The mesh is the mesh motion's, or one
 * that has its nodes; BW_INVALID otherwise. */
BW_API bw_status bw_mesh_motion_pull_back(bw_context *context, bw_mesh_motion *motion,
                                          const bw_plane_mesh *mesh, const double *node_gradient,
                                          double *point_gradient);

#ifdef __cplusplus
}
#endif
#endif
