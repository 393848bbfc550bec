/* mesh: triangle surfaces and tetrahedral meshes: topology, checks, repair, remeshing, filling,
 * quality, search, and shapes made by formula. */
#ifndef BARWRIGHT_MESH_H
#define BARWRIGHT_MESH_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- surfaces ------------------------------------------------------------------------- */

/* A triangle surface, as read or as made: it may be open, unwelded, wrongly oriented. */
typedef struct bw_surface {
  bw_object object;
  int32_t point_count, triangle_count;
  double *point;     /* point_count x 3 */
  int32_t *triangle; /* triangle_count x 3, counter-clockwise seen from outside */
  int32_t *group;    /* triangle_count, or NULL: the group, solid or region a facet came from */
} bw_surface;

/* Indices are checked to lie in range and coordinates to be finite (BW_GEOMETRY otherwise). */
BW_API bw_status bw_surface_copy(bw_context *context, int64_t points, const double *point,
                                 int64_t triangles, const int32_t *triangle, const int32_t *group,
                                 bw_surface **surface);
/* Takes the blocks over on success only. */
BW_API bw_status bw_surface_own(bw_context *context, int64_t points, double *point,
                                int64_t triangles, int32_t *triangle, int32_t *group,
                                bw_surface **surface);

/* Low and high corner; all zero for an empty surface. */
BW_API void bw_surface_box(const bw_surface *surface, double low[3], double high[3]);
BW_API double bw_surface_area(const bw_surface *surface);
BW_API double
bw_surface_volume(const bw_surface *surface); /* signed: negative when it faces inwards */
/* Points moved by x -> factor * x (unit conversion), or by a 3x4 matrix, rows of [A | b]. */
BW_API bw_status bw_surface_scale(bw_context *context, const bw_surface *surface, double factor,
                                  bw_surface **scaled);
BW_API bw_status bw_surface_transform(bw_context *context, const bw_surface *surface,
                                      const double matrix[12], bw_surface **moved);
/* Merge points closer than tolerance (0: exactly equal ones) and drop unused ones. Facets are kept
 * even when they collapse. */
BW_API bw_status bw_surface_weld(bw_context *context, const bw_surface *surface, double tolerance,
                                 bw_surface **welded);
/* Make neighbouring facets agree and every outermost shell face outwards, inner shells (cavities)
 * inwards. *flipped counts the facets that were turned. */
BW_API bw_status bw_surface_orient(bw_context *context, const bw_surface *surface,
                                   bw_surface **oriented, int64_t *flipped);

typedef enum bw_defect_kind {
  BW_DEFECT_OPEN_EDGE,         /* an edge with one facet; other = -1 */
  BW_DEFECT_NONMANIFOLD_EDGE,  /* an edge with three or more facets, two of them named */
  BW_DEFECT_NONMANIFOLD_POINT, /* the facets around a point do not form one fan */
  BW_DEFECT_MISORIENTED_EDGE,  /* two facets run along an edge in the same direction */
  BW_DEFECT_SELF_INTERSECTION, /* facet and other cut each other */
  BW_DEFECT_DUPLICATE_FACET,   /* facet has the same points as other */
  BW_DEFECT_ZERO_AREA,         /* repeated points or collinear ones */
  BW_DEFECT_FLIPPED_SHELL,     /* a closed shell whose volume has the wrong sign */
  BW_DEFECT_KINDS
} bw_defect_kind;
BW_API const char *bw_defect_word(bw_defect_kind kind); /* "open edge", ... */

typedef struct bw_defect {
  bw_defect_kind kind;
  int32_t facet; /* the offending facet */
  int32_t other; /* the second one of a pair, or -1 */
  double at[3];  /* where: the middle of the edge, facet or intersection */
} bw_defect;

typedef struct bw_surface_report {
  int64_t count[BW_DEFECT_KINDS]; /* how many of each kind */
  int64_t holes;                  /* closed loops of open edges */
  int64_t shells;                 /* edge-connected components after exact welding */
  bool closed;                    /* every edge has exactly two facets */
  bool oriented;                  /* neighbours agree and no shell is flipped */
  bool sound;                     /* closed, oriented, manifold, no intersection, no degenerate */
  double volume, area;
  double low[3], high[3];
  int64_t defect_count; /* listed below; at most `limit` of each kind */
  bw_defect *defect;
} bw_surface_report;

/* The surface is welded exactly for the check; facet numbers are those of the surface given.
 * `limit`: how many defects of each kind are listed (counts are always complete). */
BW_API bw_status bw_surface_check(bw_context *context, const bw_surface *surface, int64_t limit,
                                  bw_surface_report *report);
BW_API void bw_surface_report_clear(bw_surface_report *report);

/* What was done to a surface, step by step. */
typedef struct bw_shape_step {
  char name[24];  /* "weld", "fill holes", "orient", "wrap", "remesh", ... */
  int64_t count;  /* how many things it changed */
  double moved;   /* largest distance of the surface before to the surface after, or the reverse */
  char text[200]; /* a sentence */
} bw_shape_step;
enum { BW_SHAPE_STEPS = 24 };
typedef struct bw_shape_log {
  int count;
  bw_shape_step step[BW_SHAPE_STEPS];
  double moved; /* the sum of the steps' distances: a bound on the total */
} bw_shape_log;
BW_API void bw_shape_log_add(bw_shape_log *log, const char *name, int64_t count, double moved,
                             const char *format, ...) BW_PRINTF(5, 6);

typedef struct bw_repair_options {
  double weld;         /* tolerance in m; negative: 1e-6 of the box diagonal */
  bool fill_holes;     /* default true */
  bool intersections;  /* resolve self-intersections; default true */
  bool wrap;           /* alpha wrap as the last resort; default true */
  double wrap_alpha;   /* of the box diagonal; default 1/100 */
  double wrap_offset;  /* of the box diagonal; default 1/1000 */
  double time_limit;   /* seconds for the whole repair; default 120 */
  double memory_limit; /* bytes of one step; default 6e9 */
} bw_repair_options;
BW_API void bw_repair_options_default(bw_repair_options *options);
/* Weld, drop duplicates and degenerates, orient, fill holes, resolve intersections, wrap: each only
 * where the check calls for it; a sound surface comes back as it is with an empty log. The result
 * is sound, or BW_GEOMETRY says what could not be repaired. */
BW_API bw_status bw_surface_repair(bw_context *context, const bw_surface *surface,
                                   const bw_repair_options *options, bw_surface **repaired,
                                   bw_shape_log *log);

typedef struct bw_size_point {
  double at[3];
  double radius; /* within it the edge length is `length`, outside it grows by 0.3 per distance */
  double length;
} bw_size_point;

/* The wanted edge length at a place: the smallest of those that speak about it; 0: none does. */
typedef struct bw_size_field {
  int64_t point_count;
  const bw_size_point *point;
  double (*size)(void *data, const double at[3]); /* NULL: none; m, or 0 for no bound */
  void *data;
} bw_size_field;

typedef struct bw_remesh_options {
  double edge_length; /* wanted, m; 0: chosen from the box and the triangle budget */
  int64_t triangles;  /* wanted number, when edge_length is 0; 0: keep about as many as there are */
  double sharp_angle; /* radians between normals from which an edge is kept; default 40 degrees */
  int iterations;     /* default 5 */
  double tolerance;   /* largest distance allowed, m; 0: a quarter of edge_length */
  const bw_size_field *sizes; /* where edges are shorter; NULL: nowhere */
  double time_limit;          /* seconds of computing, BW_LIMIT beyond; default 300 */
  double memory_limit;        /* bytes, BW_LIMIT beyond; default 6e9 */
} bw_remesh_options;
BW_API void bw_remesh_options_default(bw_remesh_options *options);
/* Isotropic remeshing of a closed manifold surface. Sharp edges stay; where a feature is smaller
 * than the edge length, edges there are shorter (down to a twelfth of it), so that there may be
 * more facets than asked for. A sound surface gives a sound one. */
BW_API bw_status bw_surface_remesh(bw_context *context, const bw_surface *surface,
                                   const bw_remesh_options *options, bw_surface **remeshed,
                                   bw_shape_log *log);

typedef struct bw_wrap_options {
  double alpha;        /* m; 0: 1/50 of the box's diagonal */
  double offset;       /* m; 0: alpha / 12 */
  double time_limit;   /* seconds of computing, BW_LIMIT beyond; default 300 */
  double memory_limit; /* bytes, BW_LIMIT beyond; default 6e9 */
} bw_wrap_options;
BW_API void bw_wrap_options_default(bw_wrap_options *options);
/* Alpha wrap (CGAL, in a child process): a closed manifold around anything, holes up to alpha
 * bridged. */
BW_API bw_status bw_surface_wrap(bw_context *context, const bw_surface *surface,
                                 const bw_wrap_options *options, bw_surface **wrapped,
                                 bw_shape_log *log);
/* The larger of the two one-sided distances between surfaces, by sampling points, edge and facet
 * middles of both; 0 where it is rounding. */
BW_API bw_status bw_surface_distance(bw_context *context, const bw_surface *a, const bw_surface *b,
                                     double *distance);
/* How far points are from a surface: distance[count]. */
BW_API bw_status bw_surface_offsets(bw_context *context, const bw_surface *surface, int64_t count,
                                    const double *point, double *distance);
/* How thick the body is under `samples` places that have equal shares of the area: the way straight
 * in until the wall on the other side, INFINITY where there is none (an open surface, or one that
 * faces inwards). thickness[samples]; place[3 * samples] may be NULL. */
BW_API bw_status bw_surface_thickness(bw_context *context, const bw_surface *surface,
                                      int32_t samples, double *thickness, double *place);

/* ---- tetrahedral meshes ---------------------------------------------------------------- */

/* Node order of an element: corners 0 1 2 3 with positive volume det[x1-x0, x2-x0, x3-x0]; tet10
 * adds the middles of the edges 01 12 20 03 13 23 (the order of VTK and of CalculiX's C3D10). */
BW_API extern const int bw_tet_edge[6][2];
/* Faces, counter-clockwise seen from outside: opposite corner 3 2 0 1 for k = 0..3:
 * {0,2,1} {0,1,3} {1,2,3} {0,3,2}. */
BW_API extern const int bw_tet_face[4][3];
/* The mid-edge nodes (4..9) of a face's edges, in the order ab, bc, ca of bw_tet_face. */
BW_API extern const int bw_tet_face_mid_edge[4][3];

typedef struct bw_mesh {
  bw_object object;
  int order;             /* 1 or 2 */
  int nodes_per_element; /* 4 or 10 */
  int nodes_per_facet;   /* 3 or 6 */
  int32_t node_count, element_count;
  double *node;     /* node_count x 3 */
  int32_t *element; /* element_count x nodes_per_element */
  int32_t *region;  /* element_count: a tag from the file, or NULL */
  double *volume;   /* element_count: of the straight-edged element, all positive */

  /* the boundary: facets with one element, outwards; corners abc, then middles ab bc ca */
  int32_t facet_count;
  int32_t *facet;         /* facet_count x nodes_per_facet */
  int32_t *facet_element; /* facet_count: the element it bounds */
  int32_t boundary_node_count;
  int32_t *boundary_node; /* ascending; corners and middles */

  int32_t *neighbour; /* element_count x 4: the element across face k of bw_tet_face, or -1 */

  int32_t component_count; /* bodies: parts connected through shared nodes */
  int32_t *component;      /* node_count */

  double surface_moved; /* m, by filling; 0 of meshes that do not come from a surface */
} bw_mesh;

/* Checks indices, finiteness, and volume: an element of negative volume is renumbered to a positive
 * one, one of no volume is BW_GEOMETRY with its number. Nodes that no element uses are dropped. A
 * face shared by three elements is BW_GEOMETRY. `region` may be NULL. */
BW_API bw_status bw_mesh_copy(bw_context *context, int order, int64_t nodes, const double *node,
                              int64_t elements, const int32_t *element, const int32_t *region,
                              bw_mesh **mesh);
BW_API bw_status bw_mesh_own(bw_context *context, int order, int64_t nodes, double *node,
                             int64_t elements, int32_t *element, int32_t *region, bw_mesh **mesh);
/* Same topology, other node positions (node_count x 3): topology arrays are shared with `mesh`.
 * An inverted element is BW_GEOMETRY, the worst one named. */
BW_API bw_status bw_mesh_moved(bw_context *context, const bw_mesh *mesh, const double *node,
                               bw_mesh **moved);
/* tet4 -> tet10 with straight edges; tet10 -> tet4. The same order returns a new reference. */
BW_API bw_status bw_mesh_with_order(bw_context *context, const bw_mesh *mesh, int order,
                                    bw_mesh **out);
/* Nodes and elements along a curve that fills space, so that what is near in space is near in
 * memory: edits and their equations take less time than with a mesh generator's numbers
 * (docs/benchmarks.md). The old numbers, when asked for, are blocks of node_count and element_count
 * for the caller to bw_free. */
BW_API bw_status bw_mesh_renumbered(bw_context *context, const bw_mesh *mesh, int32_t **node_from,
                                    int32_t **element_from, bw_mesh **out);
/* The elements with keep[e] != 0 only, unused nodes dropped. */
BW_API bw_status bw_mesh_subset(bw_context *context, const bw_mesh *mesh, const uint8_t *keep,
                                bw_mesh **subset);
/* The boundary as a surface (corners only). *node_of_point, when asked for, is a block of
 * point_count mesh nodes for the caller to bw_free. */
BW_API bw_status bw_mesh_boundary(bw_context *context, const bw_mesh *mesh, bw_surface **surface,
                                  int32_t **node_of_point);
BW_API void bw_mesh_box(const bw_mesh *mesh, double low[3], double high[3]);
BW_API double bw_mesh_volume(const bw_mesh *mesh);

typedef struct bw_mesh_quality {
  double dihedral_low, dihedral_high; /* radians, over all elements */
  double radius_edge_high;            /* circumradius over shortest edge */
  double aspect_high;                 /* longest edge over smallest height */
  double volume_low, volume_high;
  int32_t worst; /* the element with the smallest dihedral angle */
} bw_mesh_quality;
BW_API void bw_mesh_quality_of(const bw_mesh *mesh, bw_mesh_quality *quality);

/* Which element holds a point (barycentric coordinates in weight), or the nearest one with clamped
 * weights (*inside false). Built once, used from any thread. */
typedef struct bw_locator bw_locator; /* reference-counted */
BW_API bw_status bw_locator_create(bw_context *context, const bw_mesh *mesh, bw_locator **locator);
BW_API int32_t bw_locator_find(const bw_locator *locator, const double point[3], double weight[4],
                               bool *inside);

/* ---- refining ---------------------------------------------------------------------------- */

/* A mesh refined by bisection, and where in the mesh before everything lies. */
typedef struct bw_refinement {
  const bw_mesh *mesh;
  int32_t *element_parent; /* element_count: the element before that holds the element */
  int32_t *facet_parent;   /* facet_count: the boundary facet before that holds the facet */
  int32_t *node_parent;    /* node_count: an element before that holds the node */
  double *node_weight;     /* node_count x 4: its barycentric coordinates there, exact */
} bw_refinement;
/* Bisect element e levels[e] times (three halve its edges), and neighbours so that the mesh
 * conforms: longest-edge bisection, so angles stay bounded however often it is done. Curved edges
 * stay the curves that they are. order: of the result, that of the mesh or 2. BW_LIMIT beyond
 * max_elements. */
BW_API bw_status bw_mesh_refine(bw_context *context, const bw_mesh *mesh, const uint8_t *levels,
                                int order, int64_t max_elements, bw_refinement *refinement);
BW_API void bw_refinement_clear(bw_refinement *refinement);

/* ---- filling ----------------------------------------------------------------------------- */

typedef struct bw_fill_options {
  int order;          /* 1 (default) or 2 */
  int64_t elements;   /* wanted number of elements; 0: what quality and volume ask for */
  double edge_length; /* m, of the surface, without a wanted number; 0: by quality and volume */
  double surface_tolerance; /* m that remeshing may leave the surface by; 0: by the edge length */
  double max_volume;        /* m3; 0: none */
  double radius_edge;       /* quality bound, circumradius over shortest edge; default 1.4 */
  double dihedral;          /* smallest dihedral angle asked for, radians; default 0 (none) */
  bool keep_surface;        /* no points added on the surface; default false */
  bool remesh;              /* remesh the surface to a fitting size first; default true */
  bool repair;              /* repair when the surface is not sound; default true */
  double sharp_angle;       /* for remeshing; default 40 degrees */
  /* sizes by distance to features, and a field */
  int64_t size_point_count;
  const bw_size_point *size_point;
  double (*size)(void *data, const double at[3]); /* edge length in m, or 0 for no bound */
  void *size_data;
  double time_limit;   /* seconds of one attempt; default 300 */
  double memory_limit; /* bytes of one attempt; default 6e9 */
  double tolerance;    /* on the wanted number of elements; default 0.15 */
} bw_fill_options;
BW_API void bw_fill_options_default(bw_fill_options *options);

typedef struct bw_fill_log {
  bw_shape_log shape;   /* repair, remesh, wrap */
  bool repaired;        /* the surface was not sound; `shape` says what was done */
  double surface_moved; /* m */
  double edge_length;   /* m: that the surface was remeshed to */
  int attempts;         /* runs of TetGen */
  double seconds_repair, seconds_remesh, seconds_fill;
} bw_fill_log;
/* Fill a surface with tetrahedra by TetGen, in a child process with limits on time and memory.
 * Where TetGen refuses, repair, remesh or wrap and try again; warnings and log say so. `log` may be
 * NULL. BW_GEOMETRY, BW_LIMIT or BW_CANCELLED otherwise. */
BW_API bw_status bw_mesh_fill(bw_context *context, const bw_surface *surface,
                              const bw_fill_options *options, bw_mesh **mesh, bw_fill_log *log);

/* ---- shapes by formula --------------------------------------------------------------------- */

/* A box of nx x ny x nz cells, each cut into six tetrahedra alike (Kuhn), between two corners. */
BW_API bw_status bw_mesh_box_grid(bw_context *context, const double low[3], const double high[3],
                                  const int cells[3], int order, bw_mesh **mesh);
/* The same topology with nodes sent through `map` (corners and middles alike: curved edges). */
BW_API bw_status bw_mesh_mapped_box(bw_context *context, const int cells[3], int order,
                                    void (*map)(void *data, const double unit[3], double out[3]),
                                    void *data, bw_mesh **mesh);
BW_API bw_status bw_surface_box_shape(bw_context *context, const double low[3],
                                      const double high[3], bw_surface **surface);
BW_API bw_status bw_surface_sphere_shape(bw_context *context, const double centre[3], double radius,
                                         int subdivisions, bw_surface **surface);
BW_API bw_status bw_surface_cylinder_shape(bw_context *context, const double base[3],
                                           const double axis[3], double radius, int segments,
                                           bw_surface **surface);
/* The zero set of f (negative inside) in a box, by marching tetrahedra on `cells` along the longest
 * side: closed and manifold as long as f is positive on the box's surface. */
BW_API bw_status bw_surface_implicit(bw_context *context, const double low[3], const double high[3],
                                     int cells, double (*f)(void *data, const double at[3]),
                                     void *data, bw_surface **surface);

#ifdef __cplusplus
}
#endif
#endif
