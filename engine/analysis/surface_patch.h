/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Patches of the boundary: what connected facets reach within a radius of a boundary node, so the
 * other side of a thin wall is not part of it. Facets that a support constrains in all directions
 * are no part of it either: their traction is not known (surface_stress.h). Facets are sampled at
 * the centroids of 16 equal subtriangles of the flat triangle of their corners. A sample at
 * distance d counts by its area times 1 - (d / radius)^2: a smooth weight converges with the mesh
 * faster than a cut disc. Fields are linear between the corners of a facet. */
#ifndef BARWRIGHT_ANALYSIS_SURFACE_PATCH_H
#define BARWRIGHT_ANALYSIS_SURFACE_PATCH_H

#include "assemble/internal.h"

#include "barwright/model.h"

enum { BWI_PATCH_CUTS = 4, BWI_PATCH_SAMPLES = BWI_PATCH_CUTS * BWI_PATCH_CUTS };

typedef struct bwi_surface_patches {
  const bw_mesh *mesh;
  double radius;
  double at[BWI_PATCH_SAMPLES][3]; /* barycentric coordinates of the samples */
  bwi_incidence around;            /* facets around every node */
  double *area;                    /* facet_count: of the flat triangles; 0: constrained */
  double *sample;                  /* facet_count x BWI_PATCH_SAMPLES x 3 */
  int32_t *seen;  /* threads x facet_count: the mark of the last patch that met the facet */
  int32_t *queue; /* threads x facet_count */
} bwi_surface_patches;

/* dof_map: NULL where nothing is constrained. */
bw_status bwi_surface_patches_begin(bw_context *context, const bw_mesh *mesh,
                                    const bw_dof_map *dof_map, double radius,
                                    bwi_surface_patches *patches);
void bwi_surface_patches_clear(bwi_surface_patches *patches);

/* The weights (m2) of a facet's samples in the patch around a node: 0 beyond the radius. Returns
 * whether one is not 0. */
bool bwi_surface_patch_weights(const bwi_surface_patches *patches, int32_t facet, int32_t node,
                               double weight[BWI_PATCH_SAMPLES]);

/* Of the flat triangle of a facet's corners, m2. */
double bwi_facet_area(const bw_mesh *mesh, int32_t facet);

/* Whether a node is the centre of a patch: on the boundary, and not in the inside of a support. */
bool bwi_surface_patch_exists(const bwi_surface_patches *patches, int32_t node);

/* Calls `add` for each facet of the patch around a boundary node with the weights (m2) of its
 * corners, which are not divided by their sum. Where no sample lies within the radius, the weight
 * is the area of the facets around the node at that corner, or half of it at both ends of a
 * mid-edge node's edge. So the sum of the weights is 0 where there is no patch only. `mark`:
 * greater than 0, another one for each patch of a worker. */
void bwi_surface_patch_visit(const bwi_surface_patches *patches, int32_t node, int32_t mark,
                             int worker,
                             void (*add)(void *data, int32_t facet, const double weight[3]),
                             void *data);

#endif
