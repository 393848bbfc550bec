/* plane: triangle meshes of outlines, and how they follow an outline that moves (responsive,
 * section 3). */
#ifndef BARWRIGHT_PLANE_H
#define BARWRIGHT_PLANE_H

#include "barwright/outline.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A plane mesh consists of three immutable objects, one for each level of reuse. Code that keeps
 * results compares pointers: with the same topology the pattern of A is valid, with the same nodes
 * preconditioner and solution too (responsive, table 1).
 *
 *   relocation      new bw_plane_mesh, same topology, same nodes
 *   reconnecting    new topology (edges flipped), same nodes
 *   reconstruction  all new
 *
 * Nodes: the first corner_count are corners, the rest mid-edge nodes (order 2). A flip removes one
 * edge and adds one, so that with order 2 the mid-edge node of the flipped edge becomes that of the
 * new one and keeps its number: the DOF map, and with it the preconditioner, stays valid after
 * reconnecting for tri6 as well. */

/* The nodes of a plane mesh, by their place on the outline. */
typedef struct bw_plane_nodes {
  bw_object object;
  int order; /* 1: tri3, 2: tri6 */
  int32_t node_count, corner_count;
  int32_t *segment;  /* (index, node_count) of the outline, on which the node lies, -1: inside. A
                      vertex of the outline belongs to the segment that begins there (parameter 0) */
  double *parameter; /* (-, node_count) t on that segment, fixed for the life of the nodes */
} bw_plane_nodes;

/* How nodes are connected. */
typedef struct bw_plane_topology {
  bw_object object;
  const bw_plane_nodes *nodes; /* retained */
  int32_t element_count;
  int32_t *element; /* (index, element_count x 3 or 6) corners counter-clockwise, then the mid-edge
                     nodes of 01, 12, 20 */
  int32_t *region;  /* (index, element_count) of the outline */
  int32_t *neighbour; /* (index, element_count x 3) across edges 01, 12, 20; -1 at the boundary */
  /* Edges that lie on segments, boundary and between regions, in the order of segments and along
     them: side k has the same nodes as long as the nodes live. Loops run so that material is on the
     left of the boundary; left of a boundary between regions is the inner one. */
  int32_t side_count;
  int32_t *side;         /* (index, side_count x 2 or 3) start, end, mid-edge node */
  int32_t *side_element; /* (index, side_count x 2) left, right (-1: none) */
  int32_t *side_segment; /* (index, side_count) of the outline */
} bw_plane_topology;

/* A triangle mesh of an outline. */
typedef struct bw_plane_mesh {
  bw_object object;
  const bw_plane_topology *topology; /* retained */
  const bw_outline *outline;         /* retained: the shape it fills */
  double *point;                     /* (m, node_count x 2) */
} bw_plane_mesh;

/* The wanted edge length (m) at a point. */
typedef double bw_size_function(void *data, const double at[2]);
/* How an outline is filled. */
typedef struct bw_plane_options {
  int order;        /* 1 or 2; default 1 */
  double size;      /* (m) wanted edge length, 0 or more; default 0: from `elements` */
  int32_t elements; /* wanted triangles (within 10 %) where size is 0; default 2000, 1 or more */
  double minimum_angle; /* (degrees) of an element; default 25, 0 to 30 */
  double curvature;     /* (degrees) largest turn of a boundary edge; default 20, above 0, to 90 */
  bw_size_function *field; /* may be NULL; the smaller of it and `size` counts (of it and 0: it) */
  void *field_data;        /* the first argument of `field` */
  int32_t limit;           /* of elements, BW_LIMIT beyond; default 5,000,000, 1 or more */
  double time_limit;       /* (s) of computing, BW_LIMIT beyond; default 300, > 0 */
  double memory_limit;     /* (bytes) BW_LIMIT beyond; default 6e9, > 0 */
} bw_plane_options;
BW_API void bw_plane_options_default(bw_plane_options *options);
/* Boundary nodes are placed along the segments first (vertices of the outline always are nodes),
 * then the inside is filled (CGAL: constrained Delaunay, refinement; then smoothing with flips).
 * Deterministic. BW_LIMIT where a limit is reached; the detail "limit" says which: "elements",
 * "time", "memory". BW_GEOMETRY where no element fits between two curves, or the outline has no
 * inside. bw_cancel ends it within a fraction of a second. `options` may be NULL. */
BW_API bw_status bw_plane_fill(bw_context *context, const bw_outline *outline,
                               const bw_plane_options *options, bw_plane_mesh **mesh);
/* From `nodes` nodes, point (m, nodes x 2), and `elements` elements, element (index, elements x 3
 * or 6), with their region (elements), NULL: all 0; for tests and bodies by formula. BW_GEOMETRY
 * where indices, the order of corners before mid-edge nodes, orientation or neighbours are wrong.
 * The outline is made of the boundary edges, one segment each (with mid-edge nodes off the chord:
 * the parabola through them), tag "boundary", region 0 inside. */
BW_API bw_status bw_plane_mesh_copy(bw_context *context, int order, int32_t nodes,
                                    const double *point, int32_t elements, const int32_t *element,
                                    const int32_t *region, bw_plane_mesh **mesh);
/* The same on an outline given, of `nodes` nodes, point (m, nodes x 2), each with its segment
 * (index, nodes), -1: inside, and parameter (-, nodes), 0 <= parameter < 1, and `elements`
 * elements, element (index, elements x 3 or 6) with region (elements) or NULL. Every vertex of the
 * outline must be a node. Those of bw_plane_mesh_copy; also for a node that is not at its place on
 * the outline: BW_GEOMETRY. */
BW_API bw_status bw_plane_mesh_on(bw_context *context, const bw_outline *outline, int order,
                                  int32_t nodes, const double *point, const int32_t *segment,
                                  const double *parameter, int32_t elements, const int32_t *element,
                                  const int32_t *region, bw_plane_mesh **mesh);
/* Which diagonal cuts a square. */
typedef enum bw_diagonal {
  BW_DIAGONAL_RIGHT,     /* from lower left to upper right */
  BW_DIAGONAL_LEFT,      /* from lower right to upper left */
  BW_DIAGONAL_UNION_JACK /* alternating: four squares make a star */
} bw_diagonal;
/* A rectangle of nx x ny squares (to 50 million) cut in two. Corners are numbered row by row from
 * below; the outline has four segments with the tags bottom, right, top, left. */
BW_API bw_status bw_plane_rectangle(bw_context *context, int order, const double min[2],
                                    const double max[2], int32_t nx, int32_t ny,
                                    bw_diagonal diagonal, bw_plane_mesh **mesh);
/* Other positions for the same topology, point (m, node_count x 2): those of boundary nodes must be
 * those of the outline. BW_GEOMETRY names an inverted element. */
BW_API bw_status bw_plane_mesh_moved(bw_context *context, const bw_plane_mesh *mesh,
                                     const bw_outline *outline, const double *point,
                                     bw_plane_mesh **moved);

/* Checks finite places, nodes on their segments, elements of positive area, mutual neighbours. */
BW_API bw_status bw_plane_mesh_check(bw_context *context, const bw_plane_mesh *mesh);

/* Measures of a plane mesh. */
typedef struct bw_plane_quality {
  double worst; /* (-) 2 sqrt(3) inradius / longest edge: 1 equilateral, 0 flat, < 0 inverted; with
                   order 2 also multiplied by the smallest Jacobian over the mean one */
  int32_t worst_element;                /* (index) of that quality */
  double mean;                          /* (-) of the quality */
  double smallest_angle, largest_angle; /* (degrees) between edges */
  double area;                          /* (m2) of all elements */
  int32_t inverted;                     /* how many elements */
} bw_plane_quality;
/* The quality of a mesh. */
BW_API void bw_plane_measure(const bw_plane_mesh *mesh, bw_plane_quality *quality);
/* The quality (-) of an element, as bw_plane_quality.worst. */
BW_API double bw_plane_element_quality(const bw_plane_mesh *mesh, int32_t element);

/* A search tree over the elements of a mesh, which it retains; bw_plane_locator_destroy releases
 * it. Used from any thread. */
typedef struct bw_plane_locator bw_plane_locator;
/* Builds the tree. */
BW_API bw_status bw_plane_locator_create(bw_context *context, const bw_plane_mesh *mesh,
                                         bw_plane_locator **locator);
BW_API void bw_plane_locator_destroy(bw_plane_locator *locator);
/* The element that holds a place, or the nearest one, with barycentric coordinates clipped to it;
 * *outside (m), which may be NULL, is its distance, 0 inside. */
BW_API int32_t bw_plane_locate(const bw_plane_locator *locator, const double at[2],
                               double barycentric[3], double *outside);
/* Values at the nodes of `from`, value (any, node_count x components), transferred to the nodes of
 * `to`, transferred (any, node_count x components). They are copied where the nodes are the same
 * (mid-edge nodes of flipped edges are read from the field as it was), interpolated at the nodes'
 * places otherwise (the nearest place of `from` where they lie outside). */
BW_API bw_status bw_plane_transfer(bw_context *context, const bw_plane_mesh *from,
                                   const bw_plane_mesh *to, int components, const double *value,
                                   double *transferred);

/* ---- a mesh that follows its outline (responsive, section 3.3) ------------------------------- */

/* What of a mesh is new, by increasing cost. */
typedef enum bw_level {
  BW_LEVEL_NONE,          /* nothing moved */
  BW_LEVEL_RELOCATION,    /* positions */
  BW_LEVEL_RECONNECTING,  /* positions and edges */
  BW_LEVEL_RECONSTRUCTION /* all */
} bw_level;
/* How inner nodes follow. */
typedef enum bw_relocation {
  BW_RELOCATE_HARMONIC, /* inner nodes take the harmonic extension of the boundary's displacement
                           since the topology was new, stiffer near the boundary (one factor per
                           topology; linear in the outline's points): the default */
  BW_RELOCATE_SPRINGS   /* the paper's: springs of rest length zero, `rounds` Jacobi rounds */
} bw_relocation;
/* How a mesh follows its outline. */
typedef struct bw_follow_options {
  bw_relocation relocation; /* default BW_RELOCATE_HARMONIC */
  int rounds;               /* of the springs; default 2, 0 to 10000 */
  double distorted;      /* (-) quality below which an element calls for reconnecting; default 0.35,
                            0 or more and below 1 */
  double rebuild;        /* (-) quality below which, after reconnecting, the mesh is reconstructed;
                            default 0.1, 0 to `distorted` */
  bw_level force;        /* at least this level each time (for tests, baselines); default NONE */
  bw_plane_options fill; /* of reconstructions; the order is the mesh's, elements 0 (the default):
                            as many as the mesh has */
} bw_follow_options;
BW_API void bw_follow_options_default(bw_follow_options *options);

/* What following did. */
typedef struct bw_follow_report {
  bw_level level;        /* reached */
  int32_t flips;         /* of edges */
  double worst;          /* (-) smallest quality after */
  int32_t worst_element; /* of the mesh after */
  bool restored;         /* relocation inverted an element and was undone before reconnecting */
  double seconds;
} bw_follow_report;

/* The current mesh and what relocation computes once per topology. Mutable. */
typedef struct bw_mesh_motion {
  bw_object object;
  const bw_plane_mesh *mesh; /* the current one; it lives until the next one replaces it */
  bw_follow_options options; /* as given, or the defaults */
  struct bwi_mesh_motion *inner;
} bw_mesh_motion;
/* Begins with a mesh. `options` may be NULL. */
BW_API bw_status bw_mesh_motion_create(bw_context *context, const bw_plane_mesh *mesh,
                                       const bw_follow_options *options, bw_mesh_motion **motion);
/* Take the mesh to an outline of the same topology (bw_outline_moved); an outline of another
 * topology means reconstruction. On failure the mesh motion is as it was: BW_GEOMETRY for a wall
 * thinner than any mesh, BW_LIMIT of the reconstruction, BW_SINGULAR where relocation has no
 * factor. `report` may be NULL. */
BW_API bw_status bw_mesh_motion_follow(bw_context *context, bw_mesh_motion *motion,
                                       const bw_outline *outline, bw_follow_report *report);
/* The state of a mesh motion, an immutable object. Returning to it restores the mesh and all that
 * following starts from, bit for bit (following the outline back may end elsewhere), and fails only
 * for the state of a mesh motion of another order. */
typedef struct bw_mesh_motion_state bw_mesh_motion_state;
/* The state of a mesh motion, one reference to be released. */
BW_API const bw_mesh_motion_state *bw_mesh_motion_keep(const bw_mesh_motion *motion);
/* Returns a mesh motion to a state. */
BW_API bw_status bw_mesh_motion_return(bw_context *context, bw_mesh_motion *motion,
                                       const bw_mesh_motion_state *state);
BW_API bw_status bw_mesh_motion_check(bw_context *context, const bw_mesh_motion *motion);
/* d J / d outline points, point_gradient (any, point_count of mesh->outline x 2), from d J / d
 * nodes, node_gradient (any, node_count x 2): the adjoint of harmonic relocation. For shape
 * optimisation. The mesh is the mesh motion's, or one that has its nodes; BW_INVALID otherwise.
 * BW_SINGULAR where relocation has no factor. */
BW_API bw_status bw_mesh_motion_pull_back(bw_context *context, bw_mesh_motion *motion,
                                          const bw_plane_mesh *mesh, const double *node_gradient,
                                          double *point_gradient);

#ifdef __cplusplus
}
#endif
#endif
