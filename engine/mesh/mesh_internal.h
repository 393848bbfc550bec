/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of tetrahedral meshes share. */
#ifndef BWI_MESH_INTERNAL_H
#define BWI_MESH_INTERNAL_H

#include "barwright/mesh.h"

/* Behind every bw_mesh. A mesh whose nodes were moved borrows the topology of another one and keeps
 * that one alive; one that has other regions borrows nodes and volumes too. All other meshes own
 * every array. Regions are always the mesh's own. */
typedef struct bwi_mesh {
  bw_mesh mesh;
  const bw_mesh *topology; /* retained; NULL: the arrays are our own */
  const bw_mesh *places;   /* retained, the owner of nodes and volumes; NULL: they are our own */
} bwi_mesh;

/* An empty mesh object with one reference, for the constructors. */
bw_mesh *bwi_mesh_create(bw_context *context);

/* As bw_mesh_adopt. With `flat`, elements whose corners lie in one plane to within rounding are
 * taken with a volume of 0: no such mesh leaves the engine. */
bw_status bwi_mesh_adopt(bw_context *context, int order, int64_t nodes, double *node,
                         int64_t elements, int32_t *element, const bw_mesh_regions *regions,
                         bool flat, bw_mesh **mesh);
/* Gives a mesh that has elements and no regions its regions, which may be NULL. */
bw_status bwi_mesh_set_regions(bw_context *context, bw_mesh *mesh, const bw_mesh_regions *regions);

/* A mesh just made takes over a block with the group of each boundary facet, and shares names. */
void bwi_mesh_adopt_groups(bw_mesh *mesh, int32_t *group, bw_face_names *names);
/* A mesh just made gets the groups and names of the facets of a surface that it was filled from,
 * where that has names. */
bw_status bwi_mesh_take_names(bw_context *context, const bw_surface *surface, bw_mesh *mesh);
/* ... or those of another mesh: element_from (index, element_count of the mesh just made) are the
 * elements there, -1 for none; NULL: its own numbers. Corners of an element have the same order. On
 * failure the mesh just made is released, and *mesh is NULL. */
bw_status bwi_mesh_keep_names(bw_context *context, const bw_mesh *from, const int32_t *element_from,
                              bw_mesh **mesh);

/* Six times the signed volume of the tetrahedron, and a bound on the rounding error in it that
 * covers the rounding of the coordinates themselves. */
double bwi_tet_determinant(const double *x0, const double *x1, const double *x2, const double *x3,
                           double *error);

/* Refuses a mesh whose bodies overlap in a large part of one of them, and warns of one whose bodies
 * overlap visibly: for the analyses that take a mesh (mesh_overlaps.c). */
bw_status bwi_mesh_check_overlaps(bw_context *context, const bw_mesh *mesh);

/* Sort items that carry a key and a tie-breaker: the order is total, so the result is unique. */
typedef struct bwi_keyed {
  uint64_t key;
  int32_t item, part;
} bwi_keyed;
void bwi_sort_keyed(bwi_keyed *list, int64_t count);

#endif
