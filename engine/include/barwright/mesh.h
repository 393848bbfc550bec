/* mesh: triangle surfaces and tetrahedral meshes: topology, checks, repair, remeshing, filling,
 * quality, search, and shapes made by formula. */
#ifndef BARWRIGHT_MESH_H
#define BARWRIGHT_MESH_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- surfaces ------------------------------------------------------------------------- */

/* Names of groups of facets: an object that surfaces and meshes share. */
typedef struct bw_face_names {
  bw_object object;
  int32_t count;
  bw_name *name;   /* (count) of groups 0 to count - 1; empty where a group has none */
  uint8_t *curved; /* (count) whether the group has facets that stand for a curved face */
} bw_face_names;
/* Names from a list, name (count), which may repeat a name, and whether these groups have facets
 * that stand for curved faces, curved (count), or NULL: none has. */
BW_API bw_status bw_face_names_create(bw_context *context, int32_t count, const bw_name *name,
                                      const uint8_t *curved, bw_face_names **names);
/* Whether a group has this name, which is not empty. */
BW_API bool bw_face_names_is(const bw_face_names *names, int32_t group, const char *name);

/* A triangle surface, as read or as made: it may be open, unwelded, wrongly oriented. Its faces
 * keep their names through moves, repair, remeshing and booleans. */
typedef struct bw_surface {
  bw_object object;
  int32_t point_count, triangle_count;
  double *point;        /* (m, point_count x 3) */
  int32_t *triangle;    /* (index, triangle_count x 3) counter-clockwise seen from outside */
  int32_t *group;       /* (triangle_count) or NULL: the group, solid or region a facet came from */
  bw_face_names *names; /* of its groups, or NULL; only with `group` */
} bw_surface;

/* A surface of `points` points, point (m, points x 3), and `triangles` facets, triangle (index,
 * triangles x 3), with their group (triangles), which may be NULL. BW_GEOMETRY for an index out of
 * range or a coordinate that is not finite, BW_LIMIT beyond 2^31 - 1 of either. */
BW_API bw_status bw_surface_copy(bw_context *context, int64_t points, const double *point,
                                 int64_t triangles, const int32_t *triangle, const int32_t *group,
                                 bw_surface **surface);
/* The same of blocks of `points` points, point (m, points x 3), and `triangles` facets, triangle
 * (index, triangles x 3), with group (triangles) or NULL; it takes them over on success only. Those
 * of bw_surface_copy. */
BW_API bw_status bw_surface_adopt(bw_context *context, int64_t points, double *point,
                                  int64_t triangles, int32_t *triangle, int32_t *group,
                                  bw_surface **surface);

/* The same facets with other groups, group (triangle_count; NULL: those that it has), and names for
 * them; NULL: none. BW_INVALID for names without groups. */
BW_API bw_status bw_surface_with_names(bw_context *context, const bw_surface *surface,
                                       const int32_t *group, const bw_face_names *names,
                                       bw_surface **named);

/* The smallest and the largest coordinates; all zero for an empty surface. */
BW_API void bw_surface_box(const bw_surface *surface, double min[3], double max[3]);
/* The area (m2) of its facets. */
BW_API double bw_surface_area(const bw_surface *surface);
/* The volume (m3), signed: negative when it faces inwards. */
BW_API double bw_surface_volume(const bw_surface *surface);
/* Points displaced by x -> factor (-) * x, for unit conversion; factor > 0. BW_GEOMETRY where a
 * coordinate overflows, BW_LIMIT as bw_surface_copy. */
BW_API bw_status bw_surface_scale(bw_context *context, const bw_surface *surface, double factor,
                                  bw_surface **scaled);
/* Points displaced by a 3x4 matrix (any), rows of [A | b]. Those of bw_surface_scale. */
BW_API bw_status bw_surface_transform(bw_context *context, const bw_surface *surface,
                                      const double matrix[12], bw_surface **moved);
/* Merge points closer than tolerance (m), 0 for exactly equal ones, and drop unused ones. Facets
 * are kept even when they collapse. */
BW_API bw_status bw_surface_weld(bw_context *context, const bw_surface *surface, double tolerance,
                                 bw_surface **welded);
/* Make neighbouring facets agree and every outermost shell face outwards, inner shells (cavities)
 * inwards. *flipped counts the facets that were turned. BW_GEOMETRY for a surface with one side
 * only. */
BW_API bw_status bw_surface_orient(bw_context *context, const bw_surface *surface,
                                   bw_surface **oriented, int64_t *flipped);

/* What can be wrong with a surface. */
typedef enum bw_defect_kind {
  BW_DEFECT_OPEN_EDGE,         /* an edge with one facet; other = -1 */
  BW_DEFECT_NONMANIFOLD_EDGE,  /* an edge with three or more facets, two of them named */
  BW_DEFECT_NONMANIFOLD_POINT, /* the facets around a point do not form one fan */
  BW_DEFECT_MISORIENTED_EDGE,  /* two facets run along an edge in the same direction */
  BW_DEFECT_SELF_INTERSECTION, /* facet and other cut each other */
  BW_DEFECT_DUPLICATE_FACET,   /* facet has the same points as other */
  BW_DEFECT_ZERO_AREA,         /* repeated points or collinear ones */
  BW_DEFECT_FLIPPED_SHELL,     /* a closed shell whose volume has the wrong sign */
  BW_DEFECT_KINDS              /* how many there are */
} bw_defect_kind;
BW_API const char *bw_defect_word(bw_defect_kind kind); /* "open edge", ... */

/* A defect and its place. */
typedef struct bw_defect {
  bw_defect_kind kind; /* what is wrong */
  int32_t facet;       /* the offending facet */
  int32_t other;       /* the second one of a pair, or -1 */
  double at[3];        /* where: the middle of the edge, facet or intersection */
} bw_defect;

/* What bw_surface_check found; bw_surface_report_clear releases the list. */
typedef struct bw_surface_report {
  int64_t count[BW_DEFECT_KINDS]; /* how many of each kind */
  int64_t holes;                  /* closed loops of open edges */
  int64_t shells;                 /* edge-connected components after exact welding */
  bool closed;                    /* every edge has exactly two facets */
  bool oriented;                  /* neighbours agree and no shell is flipped */
  bool sound;                     /* closed, oriented, manifold, no intersection, no degenerate */
  double volume;                  /* (m3) signed */
  double area;                    /* (m2) */
  double min[3], max[3];
  int64_t defect_count; /* listed below; at most `limit` of each kind */
  bw_defect *defect;    /* defect_count defects */
} bw_surface_report;

/* Checks a surface. It is welded exactly for the check; facet numbers are those of the surface
 * given. `limit`: how many defects of each kind are listed (counts are always complete). BW_LIMIT
 * for a surface with too many facets to number their sides. */
BW_API bw_status bw_surface_check(bw_context *context, const bw_surface *surface, int64_t limit,
                                  bw_surface_report *report);
BW_API void bw_surface_report_clear(bw_surface_report *report);

/* What was done to a surface, step by step. */
typedef struct bw_shape_step {
  char name[24]; /* "weld", "fill holes", "orient", "wrap", "remesh", ... */
  int64_t count; /* how many things it changed */
  double
      moved; /* (m) largest distance of the surface before to the surface after, or the reverse */
  char text[200]; /* a sentence */
} bw_shape_step;
enum { BW_SHAPE_STEPS = 24 /* the most that a log holds */ };
/* The steps of a change of shape; start from all zeros. */
typedef struct bw_shape_log {
  int count;
  bw_shape_step step[BW_SHAPE_STEPS]; /* the first `count` are in use */
  double moved; /* (m) the sum of the steps' distances: a bound on the total */
} bw_shape_log;
/* Appends a step, with its text by the printf `format`, that displaced the surface by moved (m). */
BW_API void bw_shape_log_add(bw_shape_log *log, const char *name, int64_t count, double moved,
                             const char *format, ...) BW_PRINTF(5, 6);

/* What a repair may do. */
typedef struct bw_repair_options {
  double weld;         /* (m) tolerance; default negative: 1e-6 of the box diagonal */
  bool fill_holes;     /* default true */
  bool intersections;  /* resolve self-intersections; default true */
  bool wrap;           /* alpha wrap as the last resort; default true */
  double wrap_alpha;   /* (-) of the box diagonal; default 1/100, > 0 */
  double wrap_offset;  /* (-) of the box diagonal; default 1/1000, > 0 */
  double time_limit;   /* (s) of computing, for the whole repair; default 120, > 0 */
  double memory_limit; /* (bytes) of one step; default 6e9, > 0 */
} bw_repair_options;
BW_API void bw_repair_options_default(bw_repair_options *options);
/* Welds, drops duplicates and degenerates, orients, fills holes, resolves intersections, wraps:
 * each only where the check shows a defect; a sound surface is returned unchanged with an empty
 * log. The result is sound, or BW_GEOMETRY says what could not be repaired. BW_LIMIT where time or
 * memory run out. `options` and `log` may be NULL. Starts processes. */
BW_API bw_status bw_surface_repair(bw_context *context, const bw_surface *surface,
                                   const bw_repair_options *options, bw_surface **repaired,
                                   bw_shape_log *log);

/* A wanted edge length around a place. */
typedef struct bw_size_point {
  double at[3];
  double radius; /* within it the edge length is `length`, outside it grows by 0.3 per distance */
  double length; /* (m) > 0 */
} bw_size_point;

/* The wanted edge length at a place: the smallest of those that points and function give; 0: none
 * does. All is borrowed. */
typedef struct bw_size_field {
  int64_t point_count;
  const bw_size_point *point;                     /* point_count of them */
  double (*size)(void *data, const double at[3]); /* (m) or 0 for no bound; NULL: none */
  void *data;                                     /* the first argument of `size` */
} bw_size_field;

/* How a surface is remeshed. */
typedef struct bw_remesh_options {
  double edge_length; /* (m) wanted, 0 or more; default 0: from the number of triangles */
  int64_t triangles; /* wanted number, 0 or more, when edge_length is 0; default 0: about as many as
                        before */
  double sharp_angle; /* (rad) between normals: sharper edges are kept; default 40 degrees, > 0 */
  int iterations;     /* rounds of collapses, splits, flips and relaxation; default 5, 1 to 100 */
  double tolerance;   /* (m) largest distance, 0 or more; default 0: a quarter of edge_length */
  const bw_size_field *sizes; /* where edges are shorter; NULL: nowhere */
  double time_limit;          /* (s) of computing, BW_LIMIT beyond; default 300, > 0 */
  double memory_limit;        /* (bytes) BW_LIMIT beyond; default 6e9, > 0 */
} bw_remesh_options;
BW_API void bw_remesh_options_default(bw_remesh_options *options);
/* Isotropic remeshing of a closed manifold surface. Sharp edges stay; where a feature is smaller
 * than the edge length, edges there are shorter (down to a twelfth of it), so that there may be
 * more facets than wanted. A sound surface gives a sound one. BW_GEOMETRY for a
 * surface that is not closed and manifold, or where edges are too long for its shape; BW_LIMIT
 * where time, memory or steps run out. `options` and `log` may be NULL. */
BW_API bw_status bw_surface_remesh(bw_context *context, const bw_surface *surface,
                                   const bw_remesh_options *options, bw_surface **remeshed,
                                   bw_shape_log *log);

/* How a surface is wrapped. */
typedef struct bw_wrap_options {
  double alpha;  /* (m) largest hole that is bridged, 0 or more; default 0: 1/50 of the diagonal */
  double offset; /* (m) of the wrap from the surface, 0 or more; default 0: alpha / 12 */
  double time_limit;   /* (s) of computing, BW_LIMIT beyond; default 300, > 0 */
  double memory_limit; /* (bytes) BW_LIMIT beyond; default 6e9, > 0 */
} bw_wrap_options;
BW_API void bw_wrap_options_default(bw_wrap_options *options);
/* Alpha wrap (CGAL, in a child process): a closed manifold around anything, holes up to alpha
 * bridged. BW_EMPTY without facets, BW_GEOMETRY for a surface without size or a wrap that fails,
 * BW_LIMIT where time or memory run out or alpha is too small. `options` and `log` may be NULL. */
BW_API bw_status bw_surface_wrap(bw_context *context, const bw_surface *surface,
                                 const bw_wrap_options *options, bw_surface **wrapped,
                                 bw_shape_log *log);
/* The larger *distance (m) of the two one-sided ones between surfaces, by sampling points, edge and
 * facet centroids of both; 0 where it is rounding. BW_EMPTY where one has no facets. */
BW_API bw_status bw_surface_distance(bw_context *context, const bw_surface *a, const bw_surface *b,
                                     double *distance);
/* How far points, point (m, count x 3), are from a surface: distance (m, count). BW_GEOMETRY where
 * it has no facets. */
BW_API bw_status bw_surface_offsets(bw_context *context, const bw_surface *surface, int64_t count,
                                    const double *point, double *distance);
/* How thick the body is under `samples` places that have equal shares of the area, place (m,
 * samples x 3), which may be NULL. thickness (m, samples) is the distance along the inward normal
 * to the wall on the other side, INFINITY where there is none (an open surface, or one that faces
 * inwards). BW_GEOMETRY for a surface without area. */
BW_API bw_status bw_surface_thickness(bw_context *context, const bw_surface *surface,
                                      int32_t samples, double *thickness, double *place);

/* ---- tetrahedral meshes ---------------------------------------------------------------- */

/* Node order of an element: corners 0 1 2 3 with positive volume det[x1-x0, x2-x0, x3-x0]; tet10
 * adds the mid-edge nodes of the edges 01 12 20 03 13 23 (the order of VTK and of CalculiX's
 * C3D10). */
BW_API extern const int bw_tet_edge[6][2];
/* Faces, counter-clockwise seen from outside: opposite corner 3 2 0 1 for k = 0..3:
 * {0,2,1} {0,1,3} {1,2,3} {0,3,2}. */
BW_API extern const int bw_tet_face[4][3];
/* The mid-edge nodes (4..9) of a face's edges, in the order ab, bc, ca of bw_tet_face. */
BW_API extern const int bw_tet_face_mid_edge[4][3];

/* A region: a named domain of a mesh, such as one part of an assembly or one material. */
typedef struct bw_mesh_region {
  int32_t tag;           /* its number in files; any */
  int32_t element_count; /* of its elements, at least one */
  bw_name name;          /* "insert"; never empty: without a given name "region TAG" */
} bw_mesh_region;

/* The regions of a mesh as its makers take them; all pointers are borrowed. Tags differ, and so do
 * names. An empty name becomes "region TAG". element_count is not read. Regions without an element
 * are left out. */
typedef struct bw_mesh_regions {
  int32_t count;                /* 0: the mesh has no regions */
  const bw_mesh_region *region; /* `count` of them, in any order */
  const int32_t *of_element;    /* (index into `region`, one per element) */
} bw_mesh_regions;

/* A tetrahedral mesh with its boundary. */
typedef struct bw_mesh {
  bw_object object;
  int order;             /* 1 or 2 */
  int nodes_per_element; /* 4 or 10 */
  int nodes_per_facet;   /* 3 or 6 */
  int32_t node_count, element_count;
  double *node;     /* (m, node_count x 3) */
  int32_t *element; /* (index, element_count x nodes_per_element) */
  double *volume;   /* (m3, element_count) of the straight-edged element, all positive */

  int32_t region_count;    /* 0: the elements are not divided into regions */
  bw_mesh_region *regions; /* region_count, ascending by tag; NULL without */
  int32_t *region;         /* (index into `regions`, element_count), or NULL without */

  /* the boundary: facets with one element, outwards; corners abc, then mid-edge nodes ab bc ca */
  int32_t facet_count;
  int32_t *facet;         /* (index, facet_count x nodes_per_facet) */
  int32_t *facet_element; /* (index, facet_count) the element it bounds */
  int32_t *facet_group;   /* (facet_count) the group of its surface that a facet lies on, -1 for
                             none; NULL where no face has a name */
  bw_face_names *names;   /* of these groups, or NULL; only with `facet_group` */
  int32_t boundary_node_count;
  int32_t *boundary_node; /* (index, boundary_node_count) ascending; corners and mid-edge nodes */

  int32_t *neighbour; /* (index, element_count x 4) across face k of bw_tet_face, or -1 */

  int32_t component_count; /* bodies: parts connected through shared nodes */
  int32_t *component;      /* (index, node_count) the body of each node */

  double surface_moved; /* (m) by filling; 0 of meshes that do not come from a surface */
} bw_mesh;

/* A mesh of `nodes` nodes, node (m, nodes x 3), and `elements` elements, element (index, elements x
 * 4 or 10). Checks indices, finiteness, and volume: an element of negative volume is renumbered to
 * a positive one, one of no volume is BW_GEOMETRY with its number. Nodes that no element uses are
 * dropped. A face shared by three elements is BW_GEOMETRY, and so is a mesh without elements; more
 * than 2^31 - 1 nodes or elements are BW_LIMIT. `regions` may be NULL; two of one name or one tag
 * are BW_INVALID, and so is an element whose region is none of them. */
BW_API bw_status bw_mesh_copy(bw_context *context, int order, int64_t nodes, const double *node,
                              int64_t elements, const int32_t *element,
                              const bw_mesh_regions *regions, bw_mesh **mesh);
/* The same of blocks node (m, nodes x 3) and element (index, elements x 4 or 10) for `nodes` nodes
 * and `elements` elements, which it takes over on success only. Those of bw_mesh_copy. */
BW_API bw_status bw_mesh_adopt(bw_context *context, int order, int64_t nodes, double *node,
                               int64_t elements, int32_t *element, const bw_mesh_regions *regions,
                               bw_mesh **mesh);
/* The same nodes and elements with other regions, which may be NULL for none: all other arrays are
 * shared with `mesh`. BW_INVALID as bw_mesh_copy. */
BW_API bw_status bw_mesh_with_regions(bw_context *context, const bw_mesh *mesh,
                                      const bw_mesh_regions *regions, bw_mesh **out);
/* The regions of a mesh, for a maker; they live as long as it. */
BW_API bw_mesh_regions bw_mesh_regions_of(const bw_mesh *mesh);
/* Regions by a tag for each element, tag (elements): those among `named` (named_count) have its
 * names. Release the two blocks with bw_mesh_regions_clear. */
BW_API bw_status bw_mesh_regions_by_tag(bw_context *context, int64_t elements, const int32_t *tag,
                                        int32_t named_count, const bw_mesh_region *named,
                                        bw_mesh_regions *regions);
BW_API void bw_mesh_regions_clear(bw_mesh_regions *regions);
/* The tag of each element's region: tag (element_count), a block for the caller to bw_free. NULL
 * without regions. */
BW_API bw_status bw_mesh_element_tags(bw_context *context, const bw_mesh *mesh, int32_t **tag);
/* The region of a name, as an index; -1: there is none. */
BW_API int32_t bw_mesh_find_region(const bw_mesh *mesh, const char *name);
/* The volume (m3, region_count) of each region, of straight-edged elements. */
BW_API void bw_mesh_region_volumes(const bw_mesh *mesh, double *volume);
/* Same topology, other node positions, node (m, node_count x 3): topology arrays are shared with
 * `mesh`. An inverted element is BW_GEOMETRY, the worst one named, and so is a place that is not
 * finite. */
BW_API bw_status bw_mesh_moved(bw_context *context, const bw_mesh *mesh, const double *node,
                               bw_mesh **moved);
/* tet4 -> tet10 with straight edges; tet10 -> tet4. The same order returns a new reference.
 * BW_LIMIT beyond 2^31 - 1 nodes. */
BW_API bw_status bw_mesh_with_order(bw_context *context, const bw_mesh *mesh, int order,
                                    bw_mesh **out);
/* Nodes and elements in the order of a space-filling curve, so that neighbours in space are near in
 * memory: edits and their equations take less time than with a mesh generator's numbers
 * (docs/benchmarks.md). The old numbers, node_from (index, node_count) and element_from (index,
 * element_count), either of which may be NULL, are blocks for the caller to bw_free. */
BW_API bw_status bw_mesh_renumbered(bw_context *context, const bw_mesh *mesh, int32_t **node_from,
                                    int32_t **element_from, bw_mesh **out);
/* The elements in the order of that curve, by their middles: element_from (index, element_count), a
 * block for the caller to bw_free. BW_CANCELLED leaves none. */
BW_API bw_status bw_mesh_curve_order(bw_context *context, const bw_mesh *mesh,
                                     int32_t **element_from);
/* The elements with keep (element_count) not 0 only, unused nodes dropped. BW_EMPTY without any. */
BW_API bw_status bw_mesh_subset(bw_context *context, const bw_mesh *mesh, const uint8_t *keep,
                                bw_mesh **subset);
/* The boundary as a surface (corners only), with the names of its faces. node_of_point (index,
 * point_count), which may be NULL, is a block of mesh nodes for the caller to bw_free. */
BW_API bw_status bw_mesh_boundary(bw_context *context, const bw_mesh *mesh, bw_surface **surface,
                                  int32_t **node_of_point);
/* The smallest and the largest coordinates of the nodes. */
BW_API void bw_mesh_box(const bw_mesh *mesh, double min[3], double max[3]);
/* The volume (m3) of the straight-edged elements. */
BW_API double bw_mesh_volume(const bw_mesh *mesh);

/* The facets between two regions. Those of (a, b) and (b, a) are the same, turned round. */
typedef struct bw_mesh_interface {
  int32_t count;    /* of facets; 0: the regions do not touch */
  int32_t *facet;   /* (index, count x nodes_per_facet) counter-clockwise seen from region b */
  int32_t *element; /* (index, count x 2) of region a and of region b */
  double area;      /* (m2) of the straight-edged facets */
} bw_mesh_interface;
/* The facets between the regions a and b, which are indices into mesh->regions, in the order of the
 * elements of the lower one. Release them with bw_mesh_interface_clear. BW_LIMIT beyond 2^31 - 1
 * facets. */
BW_API bw_status bw_mesh_interface_find(bw_context *context, const bw_mesh *mesh, int32_t a,
                                        int32_t b, bw_mesh_interface *interface);
BW_API void bw_mesh_interface_clear(bw_mesh_interface *interface);

/* Two bodies of a mesh that overlap: elements of both take up the same space. */
typedef struct bw_mesh_overlap {
  int32_t body[2];    /* (index) as in mesh->component, the lower one first */
  int32_t element[2]; /* (index) one of each body, where the overlap is deepest */
  double at[3];       /* (m) a place there */
  double depth;       /* (m) a lower bound of the motion that takes the bodies apart */
  double edge;        /* (m) of the regular tetrahedron of the volume of the smaller one of these */
  double volume;      /* (m3) that both take up, of straight-edged elements */
  double fraction;    /* (-) of the volume of the smaller body */
} bw_mesh_overlap;
/* The pairs of bodies that overlap. */
typedef struct bw_mesh_overlaps {
  int32_t count;            /* of pairs, at most BW_MESH_OVERLAPS */
  bool more;                /* others were not looked for */
  bw_mesh_overlap *overlap; /* count of them, ascending by their bodies */
} bw_mesh_overlaps;
enum { BW_MESH_OVERLAPS = 100 /* the most that are listed */ };
/* Which bodies of a mesh overlap by more than a millionth of the diagonal of its box; those that
 * touch do not. Elements count as straight-edged. Release the list with bw_mesh_overlaps_clear. */
BW_API bw_status bw_mesh_overlaps_find(bw_context *context, const bw_mesh *mesh,
                                       bw_mesh_overlaps *overlaps);
BW_API void bw_mesh_overlaps_clear(bw_mesh_overlaps *overlaps);

/* Which of `count` points, at (m, count x 3), are inside: inside (count) gets 0 or 1. */
typedef bw_status bw_inside(void *data, int64_t count, const double *at, uint8_t *inside);
/* How well elements follow the surface that a mesh was split at. */
typedef struct bw_split_log {
  double volume;    /* (m3) of the new region */
  double misplaced; /* (m3) parts of elements on the other side of the surface than their centroid,
                       by 64 samples of each element that the surface seems to cut */
  int32_t cut;      /* elements that the surface cuts */
} bw_split_log;
/* Elements whose centroid is inside become a new region of this name; others keep their region, and
 * without one are in the region "rest". Its border follows the facets of elements. BW_EMPTY where
 * no centroid or every one is inside, BW_INVALID for a name that is there, BW_LIMIT where the
 * largest tag is in use, or the status of `inside`. `log` may be NULL. */
BW_API bw_status bw_mesh_split(bw_context *context, const bw_mesh *mesh, const char *name,
                               bw_inside *inside, void *data, bw_mesh **split, bw_split_log *log);
/* The same mesh whose region (an index into mesh->regions) has nodes of its own: those that it
 * shares with others are doubled, so that it is a body of its own that touches them. BW_INVALID for
 * a region that is not there, BW_LIMIT for more than 2^31 - 1 nodes. */
BW_API bw_status bw_mesh_separate(bw_context *context, const bw_mesh *mesh, int32_t region,
                                  bw_mesh **separated);
/* Which of `count` points, at (m, count x 3), a closed surface holds: inside (count) gets 0 or 1.
 * Points on it count as inside. BW_GEOMETRY for a surface that is not closed. */
BW_API bw_status bw_surface_contains(bw_context *context, const bw_surface *surface, int64_t count,
                                     const double *at, uint8_t *inside);

/* Measures over all elements, taken as straight-edged. */
typedef struct bw_mesh_quality {
  double dihedral_min, dihedral_max; /* (rad) smallest and largest dihedral angle */
  double radius_edge_max;            /* (-) largest circumradius over shortest edge */
  double aspect_max;                 /* (-) largest longest edge over smallest height */
  double volume_min, volume_max;     /* (m3) smallest and largest */
  int32_t worst;                     /* (index) the element with the smallest dihedral angle */
} bw_mesh_quality;
/* The quality of a mesh. */
BW_API void bw_mesh_quality_of(const bw_mesh *mesh, bw_mesh_quality *quality);

/* A search tree over the elements of a mesh, which it retains: an object, used from any thread. */
typedef struct bw_locator bw_locator;
/* Builds the tree. */
BW_API bw_status bw_locator_create(bw_context *context, const bw_mesh *mesh, bw_locator **locator);
/* The element that holds a point, with its barycentric coordinates as weight (-), or the nearest
 * one with those of its nearest place (*inside false). Elements count as straight-edged. `inside`
 * may be NULL. */
BW_API int32_t bw_locator_find(const bw_locator *locator, const double point[3], double weight[4],
                               bool *inside);

/* ---- refining ---------------------------------------------------------------------------- */

/* A mesh refined by bisection, and where in the mesh before everything lies. */
typedef struct bw_refinement {
  const bw_mesh *mesh;
  int32_t *element_parent; /* (index, element_count) the element before that holds the element */
  int32_t *facet_parent;   /* (index, facet_count) the boundary facet before that holds the facet */
  int32_t *node_parent;    /* (index, node_count) an element before that holds the node */
  double *node_weight;     /* (-, node_count x 4) its barycentric coordinates there, exact */
} bw_refinement;
/* Bisect elements levels (element_count) times (three halve their edges), and neighbours so that
 * the mesh conforms: longest-edge bisection, so angles stay bounded however often it is done.
 * Curved edges stay the curves that they are. order: of the result, that of the mesh or 2. BW_LIMIT
 * beyond max_elements, BW_GEOMETRY where a part of a curved element has no volume. Release the
 * result with bw_refinement_clear. */
BW_API bw_status bw_mesh_refine(bw_context *context, const bw_mesh *mesh, const uint8_t *levels,
                                int order, int64_t max_elements, bw_refinement *refinement);
BW_API void bw_refinement_clear(bw_refinement *refinement);

/* ---- filling ----------------------------------------------------------------------------- */

/* How a surface is filled; all pointers are borrowed. */
typedef struct bw_fill_options {
  int order;          /* 1 (default) or 2 */
  int64_t elements;   /* wanted number; default 0: what quality and volume ask for; to 2^29 - 1 */
  double edge_length; /* (m) of the surface, 0 or more, without a wanted number; default 0: by
                         quality, volume */
  double surface_tolerance; /* (m) that remeshing may leave the surface by, 0 or more; default 0: by
                               edge length */
  double max_volume;        /* (m3) of an element, 0 or more; default 0: none */
  double radius_edge; /* (-) largest circumradius over shortest edge; default 1.4, 1 or more; 0:
                         none */
  double dihedral;    /* (rad) smallest dihedral angle asked for; default 0 (none), to 0.35 */
  bool keep_surface;  /* no points added on the surface; default false */
  bool remesh;        /* remesh the surface to a fitting size first; default true */
  bool repair;        /* repair when the surface is not sound; default true */
  double sharp_angle; /* (rad) for remeshing, > 0; default 40 degrees */
  int64_t size_point_count;
  const bw_size_point *size_point; /* size_point_count of them: sizes by distance to features */
  double (*size)(void *data, const double at[3]); /* (m) edge length, or 0 for no bound; NULL: none.
                                                     Also called in child processes */
  void *size_data;                                /* the first argument of `size` */
  double time_limit;                              /* (s) of one attempt; default 300, > 0 */
  double memory_limit;                            /* (bytes) of one attempt; default 6e9, > 0 */
  double tolerance; /* (-) on the wanted number of elements, relative; default 0.15, 0 to 1 */
} bw_fill_options;
BW_API void bw_fill_options_default(bw_fill_options *options);

/* How a mesh came about. */
typedef struct bw_fill_log {
  bw_shape_log shape;   /* repair, remesh, wrap */
  bool repaired;        /* the surface was not sound; `shape` says what was done */
  double surface_moved; /* (m) largest distance of the mesh's boundary from the surface given */
  double edge_length;   /* (m) that the surface was remeshed to */
  int attempts;         /* runs of TetGen */
  double seconds_repair, seconds_remesh, seconds_fill; /* (s) of the parts */
} bw_fill_log;
/* Fill a surface with tetrahedra by TetGen, in a child process with limits on time and memory.
 * Facets of the boundary get the names of the surface's faces. Where TetGen refuses, repair, remesh
 * or wrap and try again; warnings and log say so. `log` may be NULL. BW_GEOMETRY where none of this
 * helps, BW_LIMIT where time or memory run out. */
BW_API bw_status bw_mesh_fill(bw_context *context, const bw_surface *surface,
                              const bw_fill_options *options, bw_mesh **mesh, bw_fill_log *log);

/* One of several bodies that become the regions of one mesh. */
typedef struct bw_fill_part {
  bw_name name;              /* of its region */
  const bw_surface *surface; /* sound, outwards; borrowed */
} bw_fill_part;
/* Fill several closed surfaces with one conforming mesh, a region for each, tags 1 to `count`. A
 * part may lie inside another one, which then is what surrounds it; it may touch others; or be
 * apart. Points of parts that are nearer than tolerance (m, 0 or more; 0: 1e-9 of the diagonal) are
 * one; touching faces get the same facets on both sides. The surfaces are not remeshed: of
 * `options`, order, max_volume, radius_edge, dihedral, edge_length, sizes and limits count.
 * BW_INVALID for two parts of one name, BW_GEOMETRY for parts that overlap or a surface that is not
 * sound, both named; BW_UNSUPPORTED with a wanted number of elements; BW_LIMIT where time or memory
 * run out. */
BW_API bw_status bw_mesh_fill_parts(bw_context *context, int32_t count, const bw_fill_part *part,
                                    double tolerance, const bw_fill_options *options,
                                    bw_mesh **mesh);

/* ---- shapes by formula --------------------------------------------------------------------- */

/* A box of cells[0] x cells[1] x cells[2] cells, each cut into six tetrahedra alike (Kuhn), between
 * two corners, with the face names of bw_surface_box_shape. BW_LIMIT beyond 2^31 - 1 elements. */
BW_API bw_status bw_mesh_box_grid(bw_context *context, const double min[3], const double max[3],
                                  const int cells[3], int order, bw_mesh **mesh);
/* The same `cells` in the unit cube with nodes displaced by `map` (mid-edge nodes too: curved
 * edges). BW_GEOMETRY where an element is flat, BW_LIMIT as bw_mesh_box_grid. */
BW_API bw_status bw_mesh_mapped_box(bw_context *context, const int cells[3], int order,
                                    void (*map)(void *data, const double unit[3], double out[3]),
                                    void *data, bw_mesh **mesh);
/* The region of the plane that lies inside an odd number of closed polygons, cut into triangles
 * between their corners only. Polygon i has the points start[i] to start[i + 1] - 1 of point (m, x
 * 2); start (polygons + 1). *triangle (index, *count x 3), counter-clockwise, is a block for the
 * caller to bw_free. BW_GEOMETRY where polygons cross or touch, or have no area. */
BW_API bw_status bw_polygons_triangles(bw_context *context, int32_t polygons, const int32_t *start,
                                       const double *point, int32_t **triangle, int64_t *count);
/* A box of twelve facets between two corners: "left" and "right" along x, "front" and "back" along
 * y, "bottom" and "top" along z. */
BW_API bw_status bw_surface_box_shape(bw_context *context, const double min[3], const double max[3],
                                      bw_surface **surface);
/* An icosahedron with edges halved 0 to 9 times (`subdivisions`), points on the sphere, which is
 * one face "sphere". */
BW_API bw_status bw_surface_sphere_shape(bw_context *context, const double centre[3], double radius,
                                         int subdivisions, bw_surface **surface);
/* A closed cylinder from the middle of its base (m) along axis (m), which has the length of its
 * height, of 3 to 1000000 `segments` around: "bottom", "top" and "side". */
BW_API bw_status bw_surface_cylinder_shape(bw_context *context, const double base[3],
                                           const double axis[3], double radius, int segments,
                                           bw_surface **surface);
/* The zero set of f (negative inside) in a box, by marching tetrahedra on `cells` (1 to 4000) along
 * the longest side: closed and manifold as long as f is positive on the box's surface; else, or
 * where f is not a number, BW_GEOMETRY. BW_EMPTY where f is nowhere negative, BW_LIMIT beyond 2^31
 * - 1 points or facets. */
BW_API bw_status bw_surface_implicit(bw_context *context, const double min[3], const double max[3],
                                     int cells, double (*f)(void *data, const double at[3]),
                                     void *data, bw_surface **surface);

#ifdef __cplusplus
}
#endif
#endif
