/* grid: hexahedral grids: boxes, voxels of closed surfaces, edits, what is embedded in them, and
 * their coarse counterparts. */
#ifndef BARWRIGHT_GRID_H
#define BARWRIGHT_GRID_H

#include "barwright/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A grid of equal boxes, of which some are elements. Lattice points (i, j, k) are numbered x
 * fastest, cells too. Nodes are the lattice points that some element has, elements the cells that
 * hold material; both are numbered compactly, in the lattice's order. Corner c of a cell is at
 * (c & 1, c >> 1 & 1, c >> 2 & 1). Does not change once built. */
typedef struct bw_grid {
  bw_object object;
  double origin[3];  /* (m) lattice point (0, 0, 0) */
  double spacing[3]; /* (m) sides of a cell */
  int32_t cells[3];  /* their number along x, y and z */
  int32_t element_count, node_count;
  int32_t *cell;     /* (index, element_count) its cell, ascending */
  int32_t *element;  /* (index, element_count x 8) its nodes, corner by corner */
  int32_t *node;     /* (index, node_count) its lattice point, ascending */
  int32_t *material; /* (element_count) 1 and above, a row of a material table */
  double *fraction;  /* (-, element_count) the part of the cell that is inside the body, (0, 1];
                        NULL:  every cell is full */
  int32_t *at;       /* (index, cells) the element of each cell, or -1: void */
  const struct bw_grid *lists; /* retained: all lists but `material` are this grid's; NULL: own */
} bw_grid;

/* A grid of cells[0] x cells[1] x cells[2] boxes, of which those with a material are elements.
 * material (one per cell; 0: void; NULL: all 1) and fraction (-, one per cell; NULL: full) are
 * copied. BW_INVALID names the cell of a fraction or material that is none; BW_EMPTY without any
 * element; BW_LIMIT where lattice points pass 2^31. */
BW_API bw_status bw_grid_create(bw_context *context, const double origin[3],
                                const double spacing[3], const int32_t cells[3],
                                const int32_t *material, const double *fraction, bw_grid **grid);

/* How a surface becomes a grid. */
typedef struct bw_voxel_options {
  double spacing; /* (m) side of the cubes, 0 or more; default 0: from `cells` */
  int32_t cells;  /* along the longest side, when spacing is 0 (rounded up to a multiple); default
                     32, 1 or more */
  double min_fraction; /* (-) cells with a smaller part inside are void; default 0.05, 0 to 1 */
  bool whole;       /* cells count as full or void, by min_fraction: no fractions. Default false */
  int32_t material; /* of all elements, 1 or more; default 1 */
  int32_t multiple; /* cells in each direction are a multiple of this, so that so many cells
                       become one; default 1, 1 or more */
} bw_voxel_options;
BW_API void bw_voxel_options_default(bw_voxel_options *options);
/* The cells that a closed surface cuts or holds, with the fraction of each inside it. BW_GEOMETRY
 * for a surface that is not closed or encloses nothing, BW_EMPTY where no cell has min_fraction
 * inside, BW_LIMIT beyond 2^31 lattice points. `options` may be NULL. The lattice begins at the min
 * corner of the surface's box (or half the slack before it, where cells do not fit the box). A
 * warning says when the grid falls into parts. */
BW_API bw_status bw_grid_of_surface(bw_context *context, const bw_surface *surface,
                                    const bw_voxel_options *options, bw_grid **grid);
/* The part of each cell of a lattice of cells[0] x cells[1] x cells[2] that a closed surface holds,
 * fraction (-, one per cell), exact but for rounding; what lies outside the lattice does not
 * matter. BW_GEOMETRY for a surface that is not closed or has no facets. Facets that disagree or
 * face inwards are turned as bw_surface_orient does; a warning says where shells overlap. */
BW_API bw_status bw_grid_fractions(bw_context *context, const bw_surface *surface,
                                   const double origin[3], const double spacing[3],
                                   const int32_t cells[3], double *fraction);
/* The grid with other materials, material (count), in cells, cell (index, count): 0 takes the
 * element away, another adds it, full; everything else stays, a cut cell keeps its fraction. Of a
 * cell named twice the last counts. The same object, retained, where nothing changes; shared lists
 * where no element comes or goes. BW_EMPTY where no element is left. */
BW_API bw_status bw_grid_edited(bw_context *context, const bw_grid *grid, int64_t count,
                                const int32_t *cell, const int32_t *material, bw_grid **edited);
/* The grid with other materials, material (element_count), 1 and above; it shares all other
 * lists. */
BW_API bw_status bw_grid_with_materials(bw_context *context, const bw_grid *grid,
                                        const int32_t *material, bw_grid **out);
/* The same elements on the same nodes: graph and order of one serve the other. */
BW_API bool bw_grid_same_elements(const bw_grid *a, const bw_grid *b);
/* Where a node is at rest. */
BW_API void bw_grid_position(const bw_grid *grid, int32_t node, double at[3]);
/* The smallest and the largest coordinates of the elements. */
BW_API void bw_grid_box(const bw_grid *grid, double min[3], double max[3]);
/* The volume (m3) of the elements, cut cells by their fraction. */
BW_API double bw_grid_volume(const bw_grid *grid);
/* Groups of elements connected by nodes: their count, and group (index, element_count), which may
 * be NULL. */
BW_API bw_status bw_grid_components(bw_context *context, const bw_grid *grid, int32_t *group,
                                    int32_t *count);

/* A face of an element without a neighbour. */
typedef struct bw_grid_face {
  int32_t element;
  int32_t side;    /* 0 to 5: min x, max x, min y, ... */
  int32_t node[4]; /* counter-clockwise seen from outside */
} bw_grid_face;
/* All such faces, in the order of elements; release the block with bw_free. */
BW_API bw_status bw_grid_boundary(bw_context *context, const bw_grid *grid, bw_grid_face **face,
                                  int64_t *count);
/* The boundary as a surface (two triangles a face) whose points are nodes: node (index,
 * point_count), which may be NULL, says which; release it with bw_free. For pictures. */
BW_API bw_status bw_grid_surface(bw_context *context, const bw_grid *grid, bw_surface **surface,
                                 int32_t **node);

/* ---- choosing by geometry -------------------------------------------------------------------
 *
 * A region is given in metres, not in cells, so that the same one serves a fine grid and a coarse
 * one. */
/* The conditions of a region, to be combined by |. */
enum bw_region_part {
  BW_IN_BOX = 1,       /* between min and max */
  BW_IN_BALL = 2,      /* within radius of centre */
  BW_ON_PLANE = 4,     /* on the plane through plane_point */
  BW_BEYOND = 8,       /* on the side of beyond_point that beyond_normal points to */
  BW_ON_SIDE = 16,     /* the outermost nodes, or cells, of the grid on a side */
  BW_ON_BOUNDARY = 32, /* nodes and elements with a free face */
  BW_IN_SURFACE = 64,  /* inside a closed surface, up to half a cell */
  BW_WHERE = 128       /* where(data, at) is neither 0 nor nan */
};
/* A region of space; only fields of its parts are read. Borrows surface and where_data. */
typedef struct bw_region {
  unsigned parts;           /* bw_region_part: all of these must hold; 0: everywhere */
  double min[3], max[3];    /* (m) */
  double centre[3], radius; /* (m) */
  double plane_point[3];    /* (m) */
  double plane_normal[3];   /* (-) */
  double beyond_point[3];   /* (m) */
  double beyond_normal[3];  /* (-) */
  int side;                 /* 0 to 5: min x, max x, min y, ... */
  const bw_surface *surface;
  double (*where)(void *data, const double at[3]); /* (-) not 0 inside */
  void *where_data;                                /* its first argument */
  double within; /* (m) what lies less outside box, ball, planes, side counts too; 0: 1e-6 cells */
} bw_region;
/* The nodes in a region, node (index, count), ascending; release with bw_free. BW_EMPTY without
 * any: the message has the box of the elements and the node nearest to the region. BW_GEOMETRY for
 * a surface that is not closed. */
BW_API bw_status bw_grid_nodes(bw_context *context, const bw_grid *grid, const bw_region *region,
                               int32_t **node, int32_t *count);
/* The elements' cells whose middle is in a region, cell (index, count), ascending; with `voids` the
 * others' too. Release with bw_free. BW_EMPTY and BW_GEOMETRY as bw_grid_nodes. */
BW_API bw_status bw_grid_cells(bw_context *context, const bw_grid *grid, const bw_region *region,
                               bool voids, int32_t **cell, int32_t *count);
/* Materials by place: material (count), the value of `at` in the middle of cells, cell (index,
 * count), NULL for the first ones, of a lattice of `cells` along each side. A value that is no
 * whole number from 0 is BW_INVALID with its place. */
BW_API bw_status bw_cell_materials(bw_context *context, const double origin[3],
                                   const double spacing[3], const int32_t cells[3], int64_t count,
                                   const int32_t *cell,
                                   double (*at)(void *data, const double at[3]), void *data,
                                   int32_t *material);

/* ---- what is embedded ------------------------------------------------------------------------ */

/* Points that go with a grid's elements by trilinear interpolation. A point outside every element
 * takes the nearest one (the first of several) and is extrapolated, up to `reach` cells in each
 * direction; beyond it creation is BW_GEOMETRY and names the point. */
typedef struct bw_embedding {
  bw_object object;
  const bw_grid *grid; /* retained */
  int64_t point_count;
  int32_t *element; /* (index, point_count) */
  double *local;    /* (-, point_count x 3) 0..1 in the element (beyond where extrapolated) */
  double *weight;   /* (-, point_count x 8) of its corners */
} bw_embedding;
/* Embeds `points` points, point (m, points x 3), in a grid, with the reach (-) in cells, 0 or more.
 * BW_GEOMETRY for a point beyond it. */
BW_API bw_status bw_embedding_create(bw_context *context, const bw_grid *grid, int64_t points,
                                     const double *point, double reach, bw_embedding **embedding);
/* Interpolates values (any, node_count x components) to at_points (any, point_count x
 * components). */
BW_API void bw_embedding_values(const bw_embedding *embedding, int components, const double *values,
                                double *at_points);
/* The transpose: adds forces at_points (any, point_count x components) to those of nodes, values
 * (any, node_count x components). */
BW_API void bw_embedding_add(const bw_embedding *embedding, int components, const double *at_points,
                             double *values);

/* ---- two, four, ... cells become one --------------------------------------------------------- */

/* 2 x 2 x 2 cells become one, which is an element where one of them is. Cells beyond the max ends
 * of the lattice are void. The coarse grid has no fractions: what is void in a block, or cut, is a
 * matter of its material. */
typedef struct bw_coarsening {
  bw_object object;
  const bw_grid *fine, *coarse; /* retained; materials of the coarse grid are all 1 */
  int32_t *parent;              /* (index, fine element_count) coarse element */
  int32_t *child;   /* (index, coarse element_count x 8) fine element by corner, or -1 */
  int32_t *stencil; /* (index, fine node_count x 8) the coarse nodes whose mean is trilinear
                       interpolation at the fine node; those count repeatedly that have a larger
                       weight */
} bw_coarsening;
/* Coarsens a grid. BW_LIMIT where lattice points pass 2^31. */
BW_API bw_status bw_coarsening_create(bw_context *context, const bw_grid *fine,
                                      bw_coarsening **coarsening);
/* Trilinear interpolation of values with `components` per node from coarse nodes, coarse (any,
 * node_count x components), to fine (any, node_count x components). */
BW_API void bw_coarsening_prolong(const bw_coarsening *coarsening, int components,
                                  const double *coarse, double *fine);
/* The transpose of bw_coarsening_prolong: from fine (any, node_count x components) to coarse (any,
 * node_count x components), which is overwritten. */
BW_API void bw_coarsening_restrict(const bw_coarsening *coarsening, int components,
                                   const double *fine, double *coarse);
/* Mean distance (-) of the nodes displaced by u and v (m, node_count x 3) over the longest side of
 * the elements' box: the error measure of data-driven, section 6.2. */
BW_API double bw_grid_difference(const bw_grid *grid, const double *u, const double *v);

/* ---- files ----------------------------------------------------------------------------------- */

/* .vtu with hexahedra; material and fraction are written too. */
BW_API bw_status bw_grid_write_vtu(bw_context *context, const bw_grid *grid, const char *path,
                                   int field_count, const bw_field *fields);

#ifdef __cplusplus
}
#endif
#endif
