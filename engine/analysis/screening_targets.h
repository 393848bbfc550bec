/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Targets of a screening: the mean stress of an element, or the bw_surface_mean of
 * bw_surface_stress around a boundary node, under each of K pressures whose displacements are
 * known. */
#ifndef BARWRIGHT_ANALYSIS_SCREENING_TARGETS_H
#define BARWRIGHT_ANALYSIS_SCREENING_TARGETS_H

#include "analysis/surface_patch.h"

typedef struct bwi_targets {
  const bw_mesh *mesh;
  const bw_material *material;
  int32_t pressures;      /* K */
  const double *response; /* degrees of freedom x K */
  const double *traction; /* facet_count x 3 x K; NULL where elements are targets */
  int32_t count;
  int32_t *node;             /* the middle of each patch; NULL: target i is element i */
  bwi_surface_patches patch; /* where targets are patches */
  double *at_corner;         /* facet_count x 3 x 6 x K: surface stress */
  int32_t *mark;             /* threads: of the last patch that was visited */
} bwi_targets;

/* `radius`: of patches around the corners of boundary facets; 0: all elements are targets. Keeps
 * what it is given. */
bw_status bwi_targets_begin(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const bw_dof_map *dof_map, int32_t pressures, const double *response,
                            const double *traction, double radius, bwi_targets *targets);
void bwi_targets_clear(bwi_targets *targets);

/* Mean stress of a target by pressure: out 6 x K. */
void bwi_target_stress(const bwi_targets *targets, int32_t target, int worker, double *out);

/* The first `wanted` targets of a list, in its order, that lie apart: no two patches with their
 * centres within a radius; all elements do. Moves them to the front, returns how many. */
int32_t bwi_targets_apart(const bwi_targets *targets, int32_t wanted, int32_t *list);

#endif
