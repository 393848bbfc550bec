/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files about subdomains share. */
#ifndef BWI_SHAPE_SUBDOMAINS_H
#define BWI_SHAPE_SUBDOMAINS_H

#include "barwright/shape.h"
#include "base/union_find.h" /* the lowest number names a group */
#include "shape/internal.h"

/* What says which bone a part follows that touches no subdomain of type R: weights per node and
 * bone, or earlier subdomains of the same mesh, or (both NULL) the bones' distances. */
typedef struct bwi_guide {
  const double *weight;
  const bw_subdomains *before;
} bwi_guide;
/* Adds to score (bone_count entries) what speaks for each bone at element e. */
void bwi_guide_score(const bwi_guide *guide, const bw_mesh *mesh, const bw_skeleton *skeleton,
                     int32_t e, double *score);
int32_t bwi_highest(const double *score, int32_t count); /* the first of the highest, or -1 */

/* group[e]: the first element of the part that e belongs to among those with bone[e] < 0, joined
 * through faces and through nodes that no element with bone[e] >= 0 has; -1 for the others. */
bw_status bwi_flexible_groups(bw_context *context, const bw_mesh *mesh, const int32_t *bone,
                              int32_t *group);
/* The subdomains that bone[e] (-1: type F) describes, numbered by bone and then by first element.
 * The bones' elements must fulfil the invariants. */
bw_status bwi_subdomains_from_bones(bw_context *context, const bw_mesh *mesh,
                                    const bw_skeleton *skeleton, const int32_t *bone,
                                    const bwi_guide *guide, bw_subdomains **subdomains);
/* The same with all numbers given. */
bw_status bwi_subdomains_make(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton,
                              int32_t count, const int32_t *bone_of,
                              const int32_t *element_subdomain, const bwi_guide *guide,
                              bw_subdomains **subdomains);
/* Fills in the bones of each subdomain and what moves each corner node (blend.c). */
bw_status bwi_subdomains_blend(bw_context *context, bw_subdomains *subdomains,
                               const bwi_guide *guide);
/* Makes the stiffness subdomains, with all else given, in place of any there are
 * (stiffness_subdomains.c). */
bw_status bwi_stiffness_subdomains_create(bw_context *context, bw_subdomains *subdomains);
void bwi_stiffness_subdomains_clear(bw_subdomains *subdomains);
bw_status bwi_stiffness_subdomains_check(bw_context *context, const bw_subdomains *subdomains);

#endif
