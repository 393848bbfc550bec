/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of repair share. */
#ifndef BWI_MESH_REPAIR_INTERNAL_H
#define BWI_MESH_REPAIR_INTERNAL_H

#include "barwright/shape.h"
#include "mesh/mesh_internal.h"
#include "shape/internal.h"

/* Some free nodes and every element around them, numbered within the patch. Nodes that stay where
 * they are have no number: their positions are read from `fixed`. */
typedef struct bwi_patch {
  int32_t free_count, element_count;
  double *x;           /* free_count x 3: to be improved */
  int32_t *corner;     /* element_count x 4: a free node, or -1 */
  double *fixed;       /* element_count x 12: the corners' positions; those of free ones unused */
  double *length;      /* element_count: edge of a regular element of the wanted volume, m */
  double worst;        /* smallest quality, updated by the functions below */
  int32_t worst_place; /* the element that has it */
  int iterations;
} bwi_patch;

/* The quality of the worst element; updates worst and worst_place. An element that bw_mesh_moved
 * would refuse counts as no better than 0. */
double bwi_patch_quality(bwi_patch *patch);
/* Move the free nodes until every element is the right way round, or no way is found: *done says
 * which. */
bw_status bwi_patch_untangle(bw_context *context, bwi_patch *patch, bool *done);
/* Move the free nodes of a patch without inverted elements to better shapes; x changes only where
 * the worst quality grows. */
bw_status bwi_patch_smooth(bw_context *context, bwi_patch *patch);

/* The quality of a tetrahedron, 0 at most where its volume is not positive beyond rounding (the
 * test of bw_mesh_moved), and -infinity where a coordinate is not finite. */
double bwi_checked_quality(const double *const x[4]);

/* A closed surface filled from within: the surface's points come first and none is added on it. */
typedef struct bwi_filled {
  int32_t node_count, element_count;
  double *node;
  int32_t *element; /* element_count x 4, positive volume */
} bwi_filled;
/* `surface` faces outwards, and need not be a manifold; its facets become faces of elements exactly
 * as they are. `sample_length`, at the points `sample` (sample_count x 3), is the wanted edge
 * length near there. BW_GEOMETRY where TetGen finds no such mesh. */
bw_status bwi_fill_exactly(bw_context *context, const bw_surface *surface, int64_t sample_count,
                           const double *sample, const double *sample_length, bwi_filled *filled);

/* The corners of a triangle in ascending order, as a key and its item, and part 0; *turned when
 * their cyclic order is the other one. */
bwi_keyed bwi_triangle_key(int32_t a, int32_t b, int32_t c, bool *turned);

/* ---- what refilling keeps while it works (refill.c, refill_join.c) */

/* One component: elements to be replaced that are connected through faces. */
typedef struct bwi_component {
  int32_t element_count, facet_count;
  int32_t first;   /* its elements in bwi_refiller.ordered */
  int32_t region;  /* that of most of its elements */
  int32_t corners; /* on its boundary */
  int32_t *corner; /* the old node of each point of its boundary, ascending */
  bwi_filled filled;
} bwi_component;

typedef struct bwi_refiller {
  bw_context *context;
  const bw_mesh *mesh;
  const double *node;
  int32_t components;
  bwi_component *component;
  int32_t *component_of; /* element_count: or -1, kept */
  int32_t *ordered;      /* elements to replace, by component */
  int32_t *number;       /* node_count: scratch, then the new number of an old node or -1 */
  int32_t kept;          /* elements */
  /* the new mesh */
  int64_t node_count, element_count;
  double *new_node;
  int32_t *element, *region, *node_from, *element_from;
} bwi_refiller;

/* Is this face of an element to be replaced one of its component's boundary? */
static inline bool bwi_on_component_boundary(const bwi_refiller *r, int32_t e, int face) {
  int32_t other = r->mesh->neighbour[4 * (size_t)e + (size_t)face];
  return other < 0 || r->component_of[other] != r->component_of[e];
}
/* Once every component is filled: nodes, elements and where they come from. */
bw_status bwi_refill_join(bwi_refiller *r);
/* Give the facets of a mesh that nobody has seen yet the order they had. */
bw_status bwi_refill_order_facets(bwi_refiller *r, bw_mesh *made);

#endif
