/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Patches of the boundary: what connected facets reach within a radius of a boundary node, so the
 * other side of a thin wall is not part of it. Facets are sampled at the centroids of 16 equal
 * subtriangles. A sample at distance d counts by its area times 1 - (d / radius)^2: a smooth weight
 * converges with the mesh faster than a cut disc. */
#ifndef BARWRIGHT_ANALYSIS_SURFACE_PATCH_H
#define BARWRIGHT_ANALYSIS_SURFACE_PATCH_H

#include "assemble/internal.h"

enum { BWI_PATCH_CUTS = 4, BWI_PATCH_SAMPLES = BWI_PATCH_CUTS * BWI_PATCH_CUTS };

typedef struct bwi_surface_patches {
  const bw_mesh *mesh;
  double radius;
  double weight[BWI_PATCH_SAMPLES][6]; /* of the facet's nodes, at every sample */
  bwi_incidence around;                /* facets around every node */
  double *area;                        /* facet_count */
  double *sample;                      /* facet_count x BWI_PATCH_SAMPLES x 3 */
  int32_t *seen;  /* threads x facet_count: the mark of the last patch that met the facet */
  int32_t *queue; /* threads x facet_count */
} bwi_surface_patches;

bw_status bwi_surface_patches_begin(bw_context *context, const bw_mesh *mesh, double radius,
                                    bwi_surface_patches *patches);
void bwi_surface_patches_clear(bwi_surface_patches *patches);

/* Calls `add` for each facet of the patch around a node with the shares of its samples: 0 beyond
 * the radius. `mark`: greater than 0, another one for each patch of a worker. */
void bwi_surface_patch_visit(
    const bwi_surface_patches *patches, int32_t node, int32_t mark, int worker,
    void (*add)(void *data, int32_t facet, const double share[BWI_PATCH_SAMPLES]), void *data);

#endif
