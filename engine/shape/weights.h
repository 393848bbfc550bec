/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the two files of skinning weights share. */
#ifndef BWI_SHAPE_WEIGHTS_H
#define BWI_SHAPE_WEIGHTS_H

#include "barwright/shape.h"
#include "mesh/surface_tree.h"

typedef struct bwi_skinning {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_skeleton *skeleton;
  double heat, size;       /* size: the diagonal of mesh and skeleton */
  int32_t corners, points; /* corner nodes; those of them on the surface come first */
  int32_t *number;         /* node_count: among the corners, -1 for mid-edge nodes */
  int32_t *node;           /* corners: the node */
  int32_t *triangle;       /* facet_count x 3, of points */
  double *at;              /* points x 3 */
  double *normal;   /* points x 3: sum of the normals of the facets around, twice the areas long */
  double *area;     /* points: a third of the facets around */
  double *edge;     /* points: shortest edge */
  double *source;   /* points: M H */
  int32_t *near;    /* points: number of nearest bones */
  uint8_t *is_near; /* points x bones */
  double *gap;      /* threads x bones */
  bwi_tree *tree;
} bwi_skinning;

/* Fill source, near and is_near: which bones warm which points (weights_sources.c). */
bw_status bwi_find_sources(bwi_skinning *s);
/* The point of a bone that is nearest to x; returns the distance. */
double bwi_nearest_on_bone(const bw_skeleton *s, int32_t bone, const double *x, double *place);

#endif
